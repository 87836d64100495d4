#include "geom/svgscan.h"

#include <math.h>
#include <string.h>

void svgscan_space(SvgScan *s)
{
    while (*s->at == ' ' || (*s->at >= '\t' && *s->at <= '\r'))
        s->at++;
}

bool svgscan_comma(SvgScan *s)
{
    svgscan_space(s);
    if (*s->at != ',')
        return false;
    s->at++;
    svgscan_space(s);
    return true;
}

/* Characters, not bytes, before the place of reading, plus one. */
static glong position(const SvgScan *s)
{
    glong n = 1;
    for (const char *c = s->text; c < s->at; c++)
        n += ((guchar)*c & 0xC0) != 0x80;
    return n;
}

bool svgscan_fail(const SvgScan *s, const char *expected, GError **error)
{
    gunichar c = g_utf8_get_char_validated(s->at, -1);
    char found[16] = "";
    if (c == (gunichar)-1 || c == (gunichar)-2 || !g_unichar_isprint(c))
        g_snprintf(found, sizeof found, "byte 0x%02x", (guint)(guchar)*s->at);
    else
        g_snprintf(found, sizeof found, "'%.*s'", (int)(g_utf8_next_char(s->at) - s->at), s->at);
    g_set_error(error, OUTLINE_ERROR, OUTLINE_ERROR_SYNTAX, "at character %ld: expected %s, found %s", position(s),
                expected, *s->at ? found : "the end");
    return false;
}

/* The length of the number here, 0 for none. Not left to strtod, which takes hexadecimals, "inf" and "nan" as well. */
static gsize number_length(const char *c)
{
    const char *p = c + (*c == '+' || *c == '-');
    gsize digits = 0;
    for (; g_ascii_isdigit(*p); p++)
        digits++;
    if (*p == '.')
        for (p++; g_ascii_isdigit(*p); p++)
            digits++;
    if (!digits)
        return 0;
    if (*p == 'e' || *p == 'E') {
        const char *q = p + 1 + (p[1] == '+' || p[1] == '-');
        if (g_ascii_isdigit(*q))
            for (p = q; g_ascii_isdigit(*p);)
                p++;
    }
    return (gsize)(p - c);
}

bool svgscan_at_number(const SvgScan *s) { return number_length(s->at) > 0; }

bool svgscan_number(SvgScan *s, double *value, GError **error)
{
    gsize length = number_length(s->at);
    if (!length)
        return svgscan_fail(s, "a number", error);
    char *word = g_strndup(s->at, length);
    *value = g_ascii_strtod(word, NULL);
    g_free(word);
    if (!(fabs(*value) <= SVG_LARGEST)) {
        g_set_error(error, OUTLINE_ERROR, OUTLINE_ERROR_SYNTAX, "at character %ld: the number %.*s is too large",
                    position(s), (int)MIN(length, 40), s->at);
        return false;
    }
    s->at += length;
    return true;
}

bool svgscan_flag(SvgScan *s, double *value, GError **error)
{
    if (*s->at != '0' && *s->at != '1')
        return svgscan_fail(s, "a flag (0 or 1)", error);
    *value = *s->at++ == '1' ? 1.0 : 0.0;
    return true;
}
