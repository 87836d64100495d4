#include <math.h>
#include <string.h>

#include "export/export.h"
#include "export/sink.h"

gboolean export_text(const char *text, gsize length, const char *path, GError **error)
{
    Sink *s = sink_open(path, error);
    if (s == NULL)
        return FALSE;
    g_string_append_len(s->text, text, (gssize)length);
    return sink_close(s, error);
}

/* %.15g gives back every decimal of up to 15 digits, and 17 always suffice, so the first of 15, 16 and 17 digits that
 * reads back is the shortest (but for subnormal numbers, where it is merely exact). */
static void append_shortest(GString *s, double value)
{
    static const char *const format[] = {"%.15g", "%.16g", "%.17g"};
    char text[G_ASCII_DTOSTR_BUF_SIZE];
    for (int i = 0; i < 3; i++) {
        g_ascii_formatd(text, sizeof text, format[i], value);
        if (i == 2 || g_ascii_strtod(text, NULL) == value)
            break;
    }
    g_string_append(s, text);
}

void export_number(GString *s, double value)
{
    if (!isfinite(value)) {
        g_string_append(s, isnan(value) ? "NaN" : value > 0.0 ? "INF" : "-INF");
        return;
    }
    double size = fabs(value);
    if (size < 1e15 && floor(size) == size) {
        if (signbit(value))
            g_string_append_c(s, '-');
        sink_uint(s, (uint64_t)size);
        return;
    }
    append_shortest(s, value);
}

static void append_json_char(GString *s, char c)
{
    static const char plain[] = "\"\\\b\f\n\r\t", letter[] = "\"\\bfnrt";
    const char *at = c != '\0' ? strchr(plain, c) : NULL;
    if (at != NULL) {
        g_string_append_c(s, '\\');
        g_string_append_c(s, letter[at - plain]);
    } else if ((unsigned char)c < 0x20) {
        g_string_append_printf(s, "\\u%04x", (unsigned)c);
    } else {
        g_string_append_c(s, c);
    }
}

void export_json_string(GString *s, const char *text)
{
    if (text == NULL) {
        g_string_append(s, "null");
        return;
    }
    char *valid = g_utf8_make_valid(text, -1); /* JSON is UTF-8 */
    g_string_append_c(s, '"');
    for (const char *c = valid; *c != '\0'; c++)
        append_json_char(s, *c);
    g_string_append_c(s, '"');
    g_free(valid);
}
