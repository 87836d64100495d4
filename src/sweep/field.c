/* What a value of a sweep is for, and whether it is allowed. */
#include <math.h>
#include <string.h>

#include "param/private.h"
#include "param/suggest.h"
#include "param/value.h"
#include "sweep/private.h"

static const ParamInfo seed_info = {"", "seed", TYPE_INTEGER, "", "1", 0, MOST_SEED, "", ""};
static const ParamInfo name_info = {"", "name", TYPE_TEXT, "", "", 0, 0, "", ""};

gboolean sweep_fail(const Spot *spot, const char *key, ParamErrorCode code, GError **error, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    char *what = g_strdup_vprintf(format, args), *origin = g_filename_display_name(spot->path);
    va_end(args);
    GString *s = g_string_new(origin);
    if (spot->line)
        g_string_append_printf(s, ":%u", spot->line);
    g_string_append(s, spot->table ? ": " : ": [sweep] ");
    if (key) {
        char *quoted = param_quote(key);
        g_string_append(s, quoted);
        g_free(quoted);
    }
    g_string_append(s, what);
    g_set_error_literal(error, PARAM_ERROR, code, s->str);
    g_string_free(s, TRUE);
    g_free(origin);
    g_free(what);
    return FALSE;
}

char *sweep_field_allowed(const SweepField *f)
{
    if (f->id == FIELD_SEED)
        return g_strdup("a whole number from 0 to 2^53, or each");
    if (f->id == FIELD_NAME)
        return g_strdup("a name for files");
    return param_allowed((ParamId)f->id);
}

gboolean sweep_refuse(const Spot *spot, const SweepField *f, const char *found, GError **error)
{
    char *quoted = param_quote(found), *allowed = sweep_field_allowed(f), *hint = value_hint(f->info, found);
    sweep_fail(spot, f->key, PARAM_ERROR_VALUE, error, " = %s: must be %s%s%s", quoted, allowed, hint ? "; " : "",
               hint ? hint : "");
    g_free(hint);
    g_free(allowed);
    g_free(quoted);
    return FALSE;
}

char *sweep_unknown(const char *key)
{
    static const char *const own[] = {"params", "mode", "count", "seed", "sample_seed", "sequence", "table", "name"};
    const char *near = strchr(key, '.') ? NULL : suggest_nearest(key, own, G_N_ELEMENTS(own));
    if (near)
        return g_strdup_printf("did you mean '%s'?", near);
    char *hint = suggest_dotted(key);
    if (strchr(key, '.') || g_str_has_prefix(hint, "did"))
        return hint;
    g_free(hint);
    return g_strdup("keys are params, mode, count, seed, sample_seed, sequence, table, name, and those of parameters, as veins.kill_distance");
}

gboolean sweep_field(const Spot *spot, const char *key, SweepField *out, GError **error)
{
    *out = (SweepField){.id = param_find(key)};
    if (out->id >= 0) {
        out->info = param_info((ParamId)out->id);
        out->label = out->info->key;
    } else if (strcmp(key, "seed") == 0) {
        out->id = FIELD_SEED;
        out->info = &seed_info;
    } else if (strcmp(key, "name") == 0) {
        out->id = FIELD_NAME;
        out->info = &name_info;
    } else {
        char *hint = sweep_unknown(key);
        sweep_fail(spot, key, PARAM_ERROR_UNKNOWN, error, ": no such key; %s", hint);
        g_free(hint);
        return FALSE;
    }
    out->key = g_strdup(key);
    if (!out->label)
        out->label = out->key;
    return TRUE;
}

char *sweep_value(const Spot *spot, const SweepField *f, const char *text, GError **error)
{
    Value v;
    guint64 seed; /* the digits themselves: 2^53 + 1 would be read as 2^53 */
    bool beyond = f->id == FIELD_SEED && g_ascii_string_to_unsigned(text, 10, 0, G_MAXUINT64, &seed, NULL) && seed > MOST_SEED;
    if (beyond || !value_parse(f->info, text, &v)) {
        sweep_refuse(spot, f, text, error);
        return NULL;
    }
    char *plain = value_format(f->info, &v);
    value_clear(&v);
    if (f->id == FIELD_NAME && !sweep_check_name(spot, plain, error))
        g_clear_pointer(&plain, g_free);
    return plain;
}

bool sweep_field_is_number(const SweepField *f)
{
    return f->info->type == TYPE_NUMBER || f->info->type == TYPE_INTEGER || f->info->type == TYPE_NUMBERS;
}

bool sweep_field_is_whole(const SweepField *f)
{
    return f->info->type == TYPE_INTEGER;
}

bool sweep_field_allows(const SweepField *f, double value)
{
    if (sweep_field_is_whole(f) && (value != floor(value) || fabs(value) > 0x1p53))
        return false;
    return !(f->info->low < f->info->high) || (value >= f->info->low && value <= f->info->high);
}

bool sweep_number(const char *text, double *out)
{
    static const ParamInfo any = {"", "", TYPE_NUMBER, "", "", 0, 0, "", ""};
    Value v;
    if (!value_parse(&any, text, &v))
        return false;
    *out = v.number;
    return true;
}

int sweep_digits(double largest, double gap, int least)
{
    static const int digits[] = {6, 9, 12, 15};
    double unit = 1e-5; /* a unit of the last digit, at most, for numbers up to 1 */
    for (int i = 0; i < 4; i++, unit *= 1e-3)
        if (digits[i] >= least && unit * largest <= gap * 0.25)
            return digits[i];
    return 0;
}

char *sweep_number_text(double value, int digits, bool whole)
{
    char text[G_ASCII_DTOSTR_BUF_SIZE];
    if (whole) { /* from 2^52 on every number is, and half of one more would be lost */
        double nearest = fabs(value) < 0x1p52 ? floor(value + 0.5) : value;
        return g_strdup_printf("%" G_GINT64_FORMAT, (int64_t)nearest);
    }
    char format[8] = {'%', '.', (char)('0' + digits / 10), (char)('0' + digits % 10), 'g', '\0'};
    g_ascii_formatd(text, sizeof text, format, value + 0.0);
    /* As the parameter table writes numbers, so that there is one text for one number. */
    static const ParamInfo any = {"", "", TYPE_NUMBER, "", "", 0, 0, "", ""};
    Value v;
    bool good = value_parse(&any, text, &v);
    g_assert(good);
    return value_format(&any, &v);
}
