#include "batch/sheet_label.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static const char *last_part(const char *key)
{
    const char *dot = strrchr(key, '.');
    return dot ? dot + 1 : key;
}

/* One word alone, as minimum or density, says too little. */
char *label_key(const Sweep *s, uint32_t key)
{
    SweepKey mine = sweep_key(s, key);
    bool alike = !strchr(last_part(mine.key), '_');
    for (uint32_t k = 0; k < sweep_keys(s); k++)
        alike |= k != key && strcmp(last_part(sweep_key(s, k).key), last_part(mine.key)) == 0;
    return g_strdelimit(g_strdup(alike ? mine.key : last_part(mine.key)), "_.", ' ');
}

const char *label_unit(const SweepKey *key)
{
    if (key->id < 0 || param_info((ParamId)key->id)->type == TYPE_COLOUR)
        return "";
    return param_info((ParamId)key->id)->unit;
}

int label_colour(const SweepKey *key, const char *text)
{
    if (key->id < 0 || !text || param_info((ParamId)key->id)->type != TYPE_COLOUR || *text != '#')
        return -1;
    return (int)strtoul(text + 1, NULL, 16) & 0xffffff;
}

/* ---- numbers ---- */

/* "1.5e-05" without its exponent, if that makes it no longer than a dozen letters; else with a raised one. */
static void put_exponent(GString *out, const char *number, const char *e)
{
    static const char *const raised[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    enum { MOST_ZEROS = 6 };
    int power = atoi(e + 1);
    GString *digits = g_string_new(NULL);
    for (const char *c = number; c < e; c++)
        if (g_ascii_isdigit(*c))
            g_string_append_c(digits, *c);
    if (power < 0 && -power <= MOST_ZEROS) {
        g_string_append(out, "0.");
        for (int i = 1; i < -power; i++)
            g_string_append_c(out, '0');
        g_string_append(out, digits->str);
    } else {
        g_string_append_len(out, number, e - number);
        g_string_append(out, power < 0 ? " × 10⁻" : " × 10");
        char *n = g_strdup_printf("%d", abs(power));
        for (const char *c = n; *c; c++)
            g_string_append(out, raised[*c - '0']);
        g_free(n);
    }
    g_string_free(digits, TRUE);
}

static bool is_number(const char *text)
{
    char *end;
    if (!*text || text[strspn(text, "0123456789+-.eE")])
        return false;
    g_ascii_strtod(text, &end);
    return !*end;
}

static char *short_number(const char *text, int digits)
{
    char rounded[G_ASCII_DTOSTR_BUF_SIZE], format[8];
    int found = 0;
    bool point = strpbrk(text, ".eE") != NULL;
    for (const char *c = text; *c && *c != 'e' && *c != 'E'; c++)
        found += g_ascii_isdigit(*c) && (found || *c != '0');
    if (point && found > digits) { /* whole numbers stay whole */
        g_snprintf(format, sizeof format, "%%.%dg", digits);
        text = g_ascii_formatd(rounded, sizeof rounded, format, g_ascii_strtod(text, NULL));
    }
    GString *s = g_string_new(NULL);
    if (*text == '-') {
        g_string_append(s, "−");
        text++;
    }
    const char *e = strpbrk(text, "eE");
    if (e)
        put_exponent(s, text, e);
    else
        g_string_append(s, text);
    return g_string_free(s, FALSE);
}

char *label_value(const Sweep *s, const SweepKey *key, const char *text, int digits)
{
    char *own = !text && key->id >= 0 ? params_format(sweep_params(s), (ParamId)key->id) : g_strdup(text ? text : "1");
    ParamType type = key->id < 0 ? TYPE_INTEGER : param_info((ParamId)key->id)->type;
    char *shown = NULL;
    if (!*own) {
        shown = g_strdup("none");
    } else if (type == TYPE_FILE) {
        shown = g_path_get_basename(own);
        char *dot = strrchr(shown, '.');
        if (dot && dot != shown)
            *dot = '\0';
    } else if (type != TYPE_TEXT && is_number(own)) {
        shown = short_number(own, digits);
    } else {
        shown = g_steal_pointer(&own);
    }
    g_free(own);
    return shown;
}

/* ---- widths ---- */

/* Hundredths of an em. Bold is wider; letters we don't know are taken as wide ones. */
static const uint8_t ascii_width[95] = {
    32, 40, 46, 84, 64, 95, 78, 28, 39, 39, 50, 84, 32, 36, 32, 34, 64, 64, 64, 64, 64, 64, 64, 64, 64, 64, 34, 34, 84, 84, 84, 53,
    100, 68, 69, 70, 77, 63, 58, 78, 75, 30, 30, 66, 56, 86, 75, 79, 60, 79, 70, 64, 61, 73, 68, 99, 68, 61, 68, 39, 34, 39, 84, 50,
    50, 61, 64, 55, 64, 62, 35, 64, 63, 28, 28, 58, 28, 97, 63, 61, 64, 64, 41, 52, 39, 63, 59, 82, 59, 59, 52, 64, 34, 64, 84};

static double letter_width(gunichar c)
{
    if (c >= 32 && c < 127)
        return ascii_width[c - 32] / 100.0;
    if (g_unichar_iszerowidth(c))
        return 0.0;
    return g_unichar_iswide(c) || c == 0x2026 ? 1.05 : c < 0x250 ? 0.8 : c == 0x2212 || c >= 0x2000 ? 0.84 : 0.9;
}

double label_width(const char *text)
{
    double width = 0.0;
    for (const char *c = text; *c; c = g_utf8_next_char(c))
        width += letter_width(g_utf8_get_char(c));
    return width;
}

/* Bytes of the text that are no wider, but one letter at least. */
static gsize fitting(const char *text, double em)
{
    const char *c = text;
    for (double width = 0.0; *c; c = g_utf8_next_char(c)) {
        width += letter_width(g_utf8_get_char(c));
        if (width > em && c != text)
            break;
    }
    return (gsize)(c - text);
}

char *label_fit(const char *text, double em)
{
    char *valid = g_utf8_make_valid(text, -1);
    if (label_width(valid) > em) {
        gsize n = fitting(valid, em - letter_width(0x2026));
        while (n > 1 && valid[n - 1] == ' ')
            n--;
        char *cut = g_strdup_printf("%.*s…", (int)n, valid);
        g_free(valid);
        return cut;
    }
    return valid;
}

/* Where to break a line that would be too long: after a space, or after a mark within words. */
static gsize break_at(const char *text, gsize n)
{
    if (!text[n])
        return n;
    for (gsize i = text[n] == ' ' ? n : n - 1; i > 0; i--)
        if (text[i] == ' ' || (i > n / 2 && strchr("/_,;=-", text[i - 1])))
            return i;
    return n;
}

char **label_wrap(const char *text, double em, uint32_t most)
{
    GPtrArray *lines = g_ptr_array_new();
    char *valid = g_utf8_make_valid(text, -1);
    for (char *c = valid; *c; c++)
        if ((unsigned char)*c < 0x20)
            *c = ' ';
    for (const char *c = valid + strspn(valid, " "); *c && lines->len < most; c += strspn(c, " ")) {
        if (lines->len + 1 == most) {
            g_ptr_array_add(lines, label_fit(c, em));
            break;
        }
        gsize n = break_at(c, fitting(c, em));
        g_ptr_array_add(lines, g_strndup(c, n));
        c += n;
    }
    g_free(valid);
    g_ptr_array_add(lines, NULL);
    return (char **)g_ptr_array_free(lines, FALSE);
}

void label_xml(GString *s, const char *text)
{
    char *valid = g_utf8_make_valid(text, -1);
    for (const char *c = valid; *c; c = g_utf8_next_char(c)) {
        gunichar u = g_utf8_get_char(c);
        if (u == '<')
            g_string_append(s, "&lt;");
        else if (u == '>')
            g_string_append(s, "&gt;");
        else if (u == '&')
            g_string_append(s, "&amp;");
        else if (u == '"')
            g_string_append(s, "&quot;");
        else if (u < 0x20 || (u >= 0x7f && u < 0xa0) || u == 0xfffe || u == 0xffff)
            g_string_append_c(s, ' ');
        else
            g_string_append_unichar(s, u);
    }
    g_free(valid);
}
