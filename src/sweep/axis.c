/* The values of a key: lists, ranges, distributions. */
#include <math.h>
#include <string.h>

#include "geom/dmath.h"
#include "param/private.h"
#include "param/suggest.h"
#include "sweep/private.h"

void sweep_axis_clear(SweepAxis *axis)
{
    for (uint64_t i = 0; axis->cell && i < axis->levels * axis->fields; i++)
        g_free(axis->cell[i]);
    for (uint64_t i = 0; axis->label && i < axis->levels; i++)
        g_free(axis->label[i]);
    for (uint32_t i = 0; i < axis->fields; i++)
        g_free(axis->field[i].key);
    g_free(axis->digit);
    g_free(axis->cell);
    g_free(axis->label);
    g_free(axis->field);
    *axis = (SweepAxis){0};
}

bool sweep_axis_varies(const SweepAxis *axis)
{
    return axis->levels != 1;
}

/* Whether a value of this type may hold a ';', so that '|' parts values. */
static bool holds_semicolons(const SweepField *f)
{
    return (f->info->type == TYPE_TEXT && f->id != FIELD_NAME) || f->info->type == TYPE_NUMBERS || f->info->type == TYPE_POINTS;
}

static gboolean read_list(SweepAxis *axis, const char *text, const Spot *spot, GError **error)
{
    const SweepField *f = axis->field;
    bool may_be_empty = holds_semicolons(f), bars = may_be_empty || strchr(text, '|'); /* '|' is right everywhere */
    char **items = g_strsplit(text, bars ? "|" : ";", -1);
    guint n = g_strv_length(items);
    for (guint i = 0; i < n; i++)
        g_strstrip(items[i]);
    if (n > 1 && !bars && !*items[n - 1])
        n--; /* a ';' after the last */
    gboolean good = n > 0 && (n > 1 || *items[0]);
    if (!good)
        sweep_fail(spot, f->key, PARAM_ERROR_VALUE, error, ": an empty list; give one value or more");
    axis->kind = AXIS_LIST;
    axis->cell = g_new0(char *, n + 1);
    for (axis->levels = 0; axis->levels < n && good; axis->levels += good) {
        const char *item = items[axis->levels];
        if (!*item && !may_be_empty)
            good = sweep_fail(spot, f->key, PARAM_ERROR_VALUE, error, ": an empty value between two '%s'", bars ? "|" : ";");
        else
            good = (axis->cell[axis->levels] = sweep_value(spot, f, item, error)) != NULL;
    }
    g_strfreev(items);
    return good;
}

static bool begins_range(const char *text)
{
    return g_str_has_prefix(text, "from ") || g_str_has_prefix(text, "from\t");
}

gboolean sweep_axis_read(SweepAxis *axis, const char *text, const Spot *spot, GError **error)
{
    const SweepField *f = axis->field;
    axis->whole = sweep_field_is_whole(f);
    if (f->id == FIELD_SEED && strcmp(text, "each") == 0) {
        axis->kind = AXIS_EACH;
        return TRUE;
    }
    if (sweep_field_is_number(f) && begins_range(text))
        return sweep_axis_read_range(axis, text, spot, error);
    bool is_distribution;
    gboolean good = sweep_axis_read_distribution(axis, text, &is_distribution, spot, error);
    return is_distribution ? good : read_list(axis, text, spot, error);
}

typedef struct {
    const char *name;
    SweepAxisKind kind;
    guint least, most; /* numbers in brackets */
} Distribution;

static const Distribution distributions[] = {
    {"uniform", AXIS_UNIFORM, 2, 3},
    {"log-uniform", AXIS_LOG_UNIFORM, 2, 2},
    {"normal", AXIS_NORMAL, 2, 2},
    {"choice", AXIS_LIST, 0, 0},
};

/* Whole steps from low to high; the last may fall short of it. */
static gboolean set_steps(SweepAxis *axis, double step, const char *found, const Spot *spot, GError **error)
{
    const SweepField *f = axis->field;
    double most = MAX(fabs(axis->low), fabs(axis->high)), n = floor(fabs(axis->high - axis->low) / step + 1e-9) + 1.0;
    if (!(step > 0.0) || (axis->whole && step != floor(step)))
        return sweep_fail(spot, f->key, PARAM_ERROR_VALUE, error, " = %s: the step must be %s", found,
                          axis->whole ? "a whole number above 0" : "above 0");
    axis->digits = axis->whole ? 17 : sweep_digits(most, step, 12);
    if (!axis->digits || n > 0x1p52)
        return sweep_fail(spot, f->key, PARAM_ERROR_VALUE, error, " = %s: too many values to tell apart", found);
    axis->kind = AXIS_STEPS;
    axis->levels = (uint64_t)n;
    axis->step = axis->high < axis->low ? -step : step;
    return TRUE;
}

static gboolean check_ends(const SweepAxis *axis, const char *found, const Spot *spot, GError **error)
{
    const SweepField *f = axis->field;
    if (sweep_field_allows(f, axis->low) && sweep_field_allows(f, axis->high))
        return TRUE;
    char *allowed = sweep_field_allowed(f);
    sweep_fail(spot, f->key, PARAM_ERROR_VALUE, error, " = %s: %s must be %s", found, "both ends", allowed);
    g_free(allowed);
    return FALSE;
}

static gboolean set_normal(SweepAxis *axis, const char *found, const Spot *spot, GError **error)
{
    const SweepField *f = axis->field;
    double mean = axis->low, deviation = axis->high;
    if (!(deviation > 0.0))
        return sweep_fail(spot, f->key, PARAM_ERROR_VALUE, error, " = %s: the standard deviation must be above 0", found);
    SweepField any = *f;
    ParamInfo as_number = *f->info;
    as_number.type = TYPE_NUMBER; /* the mean of whole numbers need not be one */
    any.info = &as_number;
    if (!sweep_field_allows(&any, mean)) {
        char *allowed = sweep_field_allowed(f);
        sweep_fail(spot, f->key, PARAM_ERROR_VALUE, error, " = %s: the mean must be %s", found, allowed);
        g_free(allowed);
        return FALSE;
    }
    axis->digits = sweep_digits(fabs(mean) + deviation, deviation * 1e-3, 6);
    if (!axis->digits && !axis->whole)
        return sweep_fail(spot, f->key, PARAM_ERROR_VALUE, error, " = %s: too narrow to tell values apart", found);
    return TRUE;
}

/* low < high, and numbers between that can be told apart. */
static gboolean set_continuous(SweepAxis *axis, const double *number, guint n, const char *found, const Spot *spot, GError **error)
{
    const SweepField *f = axis->field;
    if (!(axis->low < axis->high))
        return sweep_fail(spot, f->key, PARAM_ERROR_VALUE, error, " = %s: the first number must be below the second", found);
    if (!check_ends(axis, found, spot, error))
        return FALSE;
    if (axis->kind == AXIS_LOG_UNIFORM && !(axis->low > 0.0))
        return sweep_fail(spot, f->key, PARAM_ERROR_VALUE, error, " = %s: both ends must be above 0", found);
    if (n == 3 || (axis->whole && axis->kind == AXIS_UNIFORM))
        return set_steps(axis, n == 3 ? number[2] : 1.0, found, spot, error);
    double most = MAX(fabs(axis->low), fabs(axis->high));
    axis->digits = axis->kind == AXIS_UNIFORM ? sweep_digits(most, (axis->high - axis->low) * 1e-3, 6)
                                              : sweep_digits(1.0, (1.0 - axis->low / axis->high) * 1e-3, 6);
    if (!axis->digits && !axis->whole)
        return sweep_fail(spot, f->key, PARAM_ERROR_VALUE, error, " = %s: too narrow to tell values apart", found);
    return TRUE;
}

static gboolean read_numbers(SweepAxis *axis, const Distribution *d, const char *inside, const char *found, const Spot *spot, GError **error)
{
    const SweepField *f = axis->field;
    if (!sweep_field_is_number(f))
        return sweep_fail(spot, f->key, PARAM_ERROR_VALUE, error, " = %s: no number; of values like these choice(…) draws", found);
    char **part = g_strsplit(inside, ",", -1);
    guint n = g_strv_length(part);
    double number[3] = {0};
    gboolean good = n >= d->least && n <= d->most;
    for (guint i = 0; i < n && good; i++)
        good = sweep_number(part[i], &number[i]);
    g_strfreev(part);
    if (!good)
        return sweep_fail(spot, f->key, PARAM_ERROR_VALUE, error, " = %s: must be %s", found,
                          d->kind == AXIS_NORMAL    ? "normal(mean, standard deviation)"
                          : d->kind == AXIS_UNIFORM ? "uniform(a, b) or uniform(a, b, step)"
                                                    : "log-uniform(a, b)");
    axis->kind = d->kind;
    axis->low = number[0];
    axis->high = number[1];
    return d->kind == AXIS_NORMAL ? set_normal(axis, found, spot, error) : set_continuous(axis, number, n, found, spot, error);
}

static gboolean refuse_word(const SweepAxis *axis, const char *word, const char *found, const Spot *spot, GError **error)
{
    const char *known[G_N_ELEMENTS(distributions)];
    for (gsize i = 0; i < G_N_ELEMENTS(distributions); i++)
        known[i] = distributions[i].name;
    const char *near = suggest_nearest(word, known, G_N_ELEMENTS(distributions));
    return sweep_fail(spot, axis->field->key, PARAM_ERROR_VALUE, error, " = %s: %s%s%s", found,
                      near ? "did you mean " : "distributions are uniform(a, b), log-uniform(a, b), normal(m, s) and choice(a; b; c)",
                      near ? near : "", near ? "(…)?" : "");
}

/* `is_one`: the text is a distribution, good or bad, and no list. */
gboolean sweep_axis_read_distribution(SweepAxis *axis, const char *text, bool *is_one, const Spot *spot, GError **error)
{
    gsize length = strlen(text), word = strspn(text, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ-_");
    *is_one = false;
    if (!word || text[word + strspn(text + word, " \t")] != '(' || text[length - 1] != ')')
        return FALSE;
    const char *open = strchr(text, '(');
    char *name = g_strndup(text, word), *inside = g_strndup(open + 1, length - 1 - (gsize)(open + 1 - text));
    char *found = param_quote(text);
    gboolean good = FALSE;
    for (gsize i = 0; i < G_N_ELEMENTS(distributions) && !*is_one; i++) {
        *is_one = strcmp(name, distributions[i].name) == 0;
        if (*is_one && distributions[i].kind == AXIS_LIST)
            good = read_list(axis, inside, spot, error);
        else if (*is_one)
            good = read_numbers(axis, &distributions[i], inside, found, spot, error);
    }
    axis->drawn = *is_one && axis->levels != 1;
    if (!*is_one && sweep_field_is_number(axis->field)) { /* texts and files may well look so */
        *is_one = true;
        refuse_word(axis, name, found, spot, error);
    }
    g_free(found);
    g_free(inside);
    g_free(name);
    return good;
}

/* Whether a logarithmic range gives whole numbers none of which are alike. */
static bool whole_log_differ(const SweepAxis *axis)
{
    SweepAxis up = *axis;
    up.low = MIN(axis->low, axis->high);
    up.high = MAX(axis->low, axis->high);
    double ratio = dmath_exp2(dmath_log2(up.high / up.low) / (double)(up.levels - 1)), before = up.low, exact = up.low;
    for (uint64_t k = 1; k < up.levels && exact * (ratio - 1.0) < 1.001; k++) {
        exact = up.low * dmath_exp2(dmath_log2(up.high / up.low) * ((double)k / (double)(up.levels - 1)));
        double value = floor(exact + 0.5);
        if (value <= before)
            return false;
        before = value;
    }
    return true;
}

static gboolean set_spaced(SweepAxis *axis, double n, bool logarithmic, const char *found, const Spot *spot, GError **error)
{
    const char *key = axis->field->key;
    double span = fabs(axis->high - axis->low), least = MIN(axis->low, axis->high), most = MAX(fabs(axis->low), fabs(axis->high));
    if (n != floor(n) || n < 2.0 || n > 0x1p40)
        return sweep_fail(spot, key, PARAM_ERROR_VALUE, error, " = %s: the number of values must be a whole one, 2 or more", found);
    if (logarithmic && !(least > 0.0))
        return sweep_fail(spot, key, PARAM_ERROR_VALUE, error, " = %s: both ends must be above 0", found);
    axis->kind = logarithmic ? AXIS_LOG : AXIS_EVEN;
    axis->levels = (uint64_t)n;
    double gap = logarithmic ? 1.0 - dmath_exp2(-dmath_log2(most / least) / (n - 1.0)) : span / (n - 1.0);
    axis->digits = sweep_digits(logarithmic ? 1.0 : most, gap, 6);
    bool differ = !axis->whole ? axis->digits != 0 : logarithmic ? whole_log_differ(axis) : gap >= 1.0;
    if (!differ)
        return sweep_fail(spot, key, PARAM_ERROR_VALUE, error, " = %s: too many values to tell apart", found);
    return TRUE;
}

/* from A to B by STEP, from A to B in N, from A to B in N log. */
gboolean sweep_axis_read_range(SweepAxis *axis, const char *text, const Spot *spot, GError **error)
{
    char *plain = g_strdelimit(g_strdup(text), "\t", ' '), *found = param_quote(text);
    char **split = g_strsplit(plain, " ", -1), *word[9] = {NULL};
    guint n = 0;
    for (guint i = 0; split[i] && n < 8; i++)
        if (*split[i])
            word[n++] = split[i];
    double last = 0.0;
    bool log = n == 7 && strcmp(word[6], "log") == 0;
    bool by = n == 6 && strcmp(word[4], "by") == 0, in = (n == 6 || log) && strcmp(word[4], "in") == 0;
    gboolean good = (by || in) && strcmp(word[2], "to") == 0 && sweep_number(word[1], &axis->low) && sweep_number(word[3], &axis->high) &&
                    sweep_number(word[5], &last);
    if (!good)
        sweep_fail(spot, axis->field->key, PARAM_ERROR_VALUE, error,
                   " = %s: a range is 'from A to B by STEP', 'from A to B in N' or 'from A to B in N log'", found);
    else if (axis->low == axis->high)
        good = sweep_fail(spot, axis->field->key, PARAM_ERROR_VALUE, error, " = %s: both ends are the same", found);
    else
        good = check_ends(axis, found, spot, error) &&
               (by ? set_steps(axis, last, found, spot, error) : set_spaced(axis, last, log, found, spot, error));
    g_strfreev(split);
    g_free(found);
    g_free(plain);
    return good;
}
