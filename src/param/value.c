#include "param/value.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "param/suggest.h"

enum { LONGEST_VALUE = 1 << 20 };

static bool read_number(const char *token, double low, double high, double *out)
{
    /* Digits, signs, point and exponent only: strtod would take inf, nan and hexadecimal too. */
    if (!*token || token[strspn(token, "0123456789+-.eE")])
        return false;
    char *end;
    double value = g_ascii_strtod(token, &end);
    if (*end || !isfinite(value) || (low < high && (value < low || value > high)))
        return false;
    *out = value + 0.0; /* -0 becomes 0 */
    return true;
}

static bool read_integer(const char *token, double low, double high, int64_t *out)
{
    const char *digits = *token == '-' || *token == '+' ? token + 1 : token;
    if (!*digits || digits[strspn(digits, "0123456789")])
        return false;
    errno = 0;
    int64_t value = g_ascii_strtoll(token, NULL, 10);
    if (errno || (double)value < low || (double)value > high)
        return false;
    *out = value;
    return true;
}

static bool read_switch(const char *token, int64_t *out)
{
    static const char *const words[2][4] = {{"no", "false", "off", "0"}, {"yes", "true", "on", "1"}};
    for (int i = 0; i < 8; i++) {
        if (g_ascii_strcasecmp(token, words[i / 4][i % 4]) == 0) {
            *out = i / 4;
            return true;
        }
    }
    return false;
}

static bool read_choice(const char *token, const char *choices, int64_t *out)
{
    char **words = g_strsplit(choices, "|", -1);
    int64_t found = -1;
    for (int i = 0; words[i]; i++)
        if (strcmp(words[i], token) == 0)
            found = i;
    g_strfreev(words);
    *out = found;
    return found >= 0;
}

static bool read_colour(const char *token, int64_t *out)
{
    if (token[0] != '#' || strlen(token) != 7)
        return false;
    int64_t colour = 0;
    for (int i = 1; i < 7; i++) {
        int digit = g_ascii_xdigit_value(token[i]);
        if (digit < 0)
            return false;
        colour = colour * 16 + digit;
    }
    *out = colour;
    return true;
}

/* One line of text that XML and JSON can hold: no control characters but tabs, no U+FFFE and U+FFFF. */
static bool is_text(const char *token)
{
    if (!g_utf8_validate(token, -1, NULL))
        return false;
    for (const char *c = token; *c; c = g_utf8_next_char(c)) {
        gunichar u = g_utf8_get_char(c);
        if ((g_unichar_iscntrl(u) && u != '\t') || (u & 0xFFFE) == 0xFFFE)
            return false;
    }
    return true;
}

/* Reads "1; 2; 3", or with `width` 2 "1,2; 3,4". Nothing at all is an empty list. */
static bool read_list(const ParamInfo *info, const char *token, uint32_t width, Value *out)
{
    if (!*token)
        return true;
    char **items = g_strsplit(token, ";", -1);
    uint32_t n = g_strv_length(items);
    if (n > 1 && !*g_strstrip(items[n - 1]))
        n--; /* a ';' after the last */
    out->list = g_new(double, (gsize)n *width);
    bool good = true;
    for (uint32_t i = 0; i < n && good; i++) {
        char **parts = g_strsplit(items[i], ",", -1);
        good = g_strv_length(parts) == width;
        for (uint32_t k = 0; k < width && good; k++)
            good = read_number(g_strstrip(parts[k]), info->low, info->high, &out->list[(gsize)i * width + k]);
        g_strfreev(parts);
    }
    g_strfreev(items);
    out->n = n;
    return good;
}

static bool read_value(const ParamInfo *info, const char *token, Value *out)
{
    switch (info->type) {
    case TYPE_NUMBER:
        return read_number(token, info->low, info->high, &out->number);
    case TYPE_INTEGER:
        return read_integer(token, info->low, info->high, &out->integer);
    case TYPE_SWITCH:
        return read_switch(token, &out->integer);
    case TYPE_CHOICE:
        return read_choice(token, info->choices, &out->integer);
    case TYPE_COLOUR:
        return read_colour(token, &out->integer);
    case TYPE_NUMBERS:
        return read_list(info, token, 1, out);
    case TYPE_POINTS:
        return read_list(info, token, 2, out);
    case TYPE_TEXT:
    case TYPE_FILE:
        out->text = g_strdup(token);
        return is_text(token);
    }
    g_assert_not_reached();
}

bool value_parse(const ParamInfo *info, const char *text, Value *out)
{
    *out = (Value){0};
    if (strlen(text) > LONGEST_VALUE)
        return false;
    char *token = g_strstrip(g_strdup(text));
    bool good = read_value(info, token, out);
    g_free(token);
    if (!good)
        value_clear(out);
    return good;
}

void value_clear(Value *v)
{
    g_free(v->text);
    g_free(v->list);
    *v = (Value){0};
}

static gsize list_bytes(const Value *v, const ParamInfo *info)
{
    return sizeof(double) * v->n * (info->type == TYPE_POINTS ? 2u : 1u);
}

Value value_copy(const ParamInfo *info, const Value *v)
{
    Value copy = *v;
    copy.text = g_strdup(v->text);
    copy.list = v->list ? g_memdup2(v->list, list_bytes(v, info)) : NULL;
    return copy;
}

/* The shortest decimal of at least 15 digits' precision that reads back to the same double; 17 always do. */
static void append_number(GString *s, double value)
{
    char text[G_ASCII_DTOSTR_BUF_SIZE];
    static const char *const formats[] = {"%.15g", "%.16g", "%.17g"};
    for (int i = 0; i < 3; i++) {
        g_ascii_formatd(text, sizeof text, formats[i], value);
        if (g_ascii_strtod(text, NULL) == value)
            break;
    }
    g_string_append(s, text);
}

static void append_list(GString *s, const ParamInfo *info, const Value *v)
{
    for (uint32_t i = 0; i < v->n; i++) {
        if (i)
            g_string_append(s, "; ");
        if (info->type == TYPE_NUMBERS) {
            append_number(s, v->list[i]);
            continue;
        }
        append_number(s, v->list[2 * (gsize)i]);
        g_string_append_c(s, ',');
        append_number(s, v->list[2 * (gsize)i + 1]);
    }
}

char *value_format(const ParamInfo *info, const Value *v)
{
    GString *s = g_string_new(NULL);
    char **words;
    switch (info->type) {
    case TYPE_NUMBER:
        append_number(s, v->number);
        break;
    case TYPE_INTEGER:
        g_string_append_printf(s, "%" G_GINT64_FORMAT, v->integer);
        break;
    case TYPE_SWITCH:
        g_string_append(s, v->integer ? "yes" : "no");
        break;
    case TYPE_CHOICE:
        words = g_strsplit(info->choices, "|", -1);
        g_string_append(s, words[v->integer]);
        g_strfreev(words);
        break;
    case TYPE_COLOUR:
        g_string_append_printf(s, "#%06x", (unsigned)v->integer);
        break;
    case TYPE_NUMBERS:
    case TYPE_POINTS:
        append_list(s, info, v);
        break;
    case TYPE_TEXT:
    case TYPE_FILE:
        g_string_append(s, v->text);
        break;
    }
    return g_string_free(s, FALSE);
}

/* A bound for people: 0.0002, 1600, 1e6. */
static void append_bound(GString *s, double value, bool integer)
{
    char text[G_ASCII_DTOSTR_BUF_SIZE];
    if (integer) {
        g_string_append_printf(s, "%" G_GINT64_FORMAT, (int64_t)value);
        return;
    }
    g_ascii_formatd(text, sizeof text, value >= 1e5 ? "%.0e" : "%.15g", value);
    if (g_ascii_strtod(text, NULL) != value)
        g_ascii_formatd(text, sizeof text, "%.15g", value);
    char *exponent = strchr(text, 'e');
    if (!exponent) {
        g_string_append(s, text);
        return;
    }
    g_string_append_len(s, text, exponent - text);
    g_string_append_printf(s, "e%d", (int)g_ascii_strtoll(exponent + 1, NULL, 10));
}

static void append_range(GString *s, const ParamInfo *info)
{
    if (info->low < info->high) {
        g_string_append(s, " from ");
        append_bound(s, info->low, info->type == TYPE_INTEGER);
        g_string_append(s, " to ");
        append_bound(s, info->high, info->type == TYPE_INTEGER);
    }
    if (*info->unit)
        g_string_append_printf(s, " (%s)", info->unit);
}

static void append_choices(GString *s, const char *choices)
{
    char **words = g_strsplit(choices, "|", -1);
    guint n = g_strv_length(words);
    g_string_append(s, n > 2 ? "one of " : "");
    for (guint i = 0; i < n; i++)
        g_string_append_printf(s, "%s%s", i == 0 ? "" : i + 1 == n ? " or " : ", ", words[i]);
    g_strfreev(words);
}

char *param_allowed(ParamId id)
{
    const ParamInfo *info = param_info(id);
    GString *s = g_string_new(NULL);
    switch (info->type) {
    case TYPE_NUMBER:
        g_string_append(s, "a number");
        append_range(s, info);
        break;
    case TYPE_INTEGER:
        g_string_append(s, "a whole number");
        append_range(s, info);
        break;
    case TYPE_SWITCH:
        g_string_append(s, "yes or no");
        break;
    case TYPE_CHOICE:
        append_choices(s, info->choices);
        break;
    case TYPE_COLOUR:
        g_string_append(s, "a colour #rrggbb");
        break;
    case TYPE_NUMBERS:
        g_string_append(s, "numbers");
        append_range(s, info);
        g_string_append(s, ", separated by ';'");
        break;
    case TYPE_POINTS:
        g_string_append(s, "points x,y; x,y; …");
        append_range(s, info);
        break;
    case TYPE_TEXT:
        g_string_append(s, "text on one line");
        break;
    case TYPE_FILE:
        g_string_append(s, "the path of a file");
        break;
    }
    return g_string_free(s, FALSE);
}

char *value_hint(const ParamInfo *info, const char *text)
{
    if (info->type == TYPE_CHOICE) {
        char **words = g_strsplit(info->choices, "|", -1);
        const char *near = suggest_nearest(text, (const char *const *)words, g_strv_length(words));
        char *hint = near ? g_strdup_printf("did you mean '%s'?", near) : NULL;
        g_strfreev(words);
        if (hint)
            return hint;
    }
    if (strstr(text, " #") || strstr(text, " ;"))
        return g_strdup("a comment stands on a line of its own");
    return NULL;
}
