/* Names of variants, from what varies: kill_distance-40_minimum-2; 000017_kill_distance-3.20518 where values are drawn; 000017 where there
 * is too much to tell. Letters that any file system takes. A label holds no '_', and keys come in one order, so that different labels make
 * different names. */
#include <string.h>

#include "sweep/private.h"

enum { LONGEST_NAME = 100, LONGEST_LABEL = 40, LONGEST_GIVEN = 100, MOST_DRAWN = 3, INDEX_DIGITS = 6 };

char *sweep_label(const SweepField *f, const char *text)
{
    char *base = f && f->info->type == TYPE_FILE && *text ? g_path_get_basename(text) : g_strdup(text);
    char *dot = f && f->info->type == TYPE_FILE ? strrchr(base, '.') : NULL;
    if (dot && dot != base)
        *dot = '\0';
    GString *s = g_string_new(NULL);
    for (const char *c = base; *c && s->len < LONGEST_LABEL; c++) {
        bool inside = s->len && g_ascii_isalnum(s->str[s->len - 1]); /* a word */
        if (g_ascii_isalnum(*c) || (*c == '.' && inside) || *c == '+' || (*c == '-' && c == base))
            g_string_append_c(s, *c);
        else if (inside)
            g_string_append_c(s, '-');
    }
    while (s->len > 1 && (s->str[s->len - 1] == '-' || s->str[s->len - 1] == '.'))
        g_string_truncate(s, s->len - 1);
    if (!s->len)
        g_string_append(s, "none");
    g_free(base);
    return g_string_free(s, FALSE);
}

/* How many of the words differ, on a file system that minds no case too. */
static uint64_t count_different(char *const *word, uint64_t n)
{
    GHashTable *seen = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
    for (uint64_t i = 0; i < n; i++)
        g_hash_table_add(seen, g_ascii_strdown(word[i], -1));
    uint64_t different = g_hash_table_size(seen);
    g_hash_table_destroy(seen);
    return different;
}

static bool all_cells_differ(const SweepAxis *axis)
{
    GHashTable *seen = g_hash_table_new(g_str_hash, g_str_equal);
    bool differ = true;
    for (uint64_t i = 0; i < axis->levels && differ; i++)
        differ = g_hash_table_add(seen, axis->cell[i]);
    g_hash_table_destroy(seen);
    return differ;
}

/* The columns of a table that vary, as in a name. */
static char *row_label(const SweepAxis *axis, uint64_t row)
{
    GString *s = g_string_new(NULL);
    for (uint32_t f = 0; f < axis->fields; f++) {
        const char *cell = axis->cell[row * axis->fields + f];
        if (axis->field[f].id == FIELD_NAME) {
            g_string_assign(s, cell);
            break;
        }
        if (!axis->field[f].varies)
            continue;
        char *part = sweep_label(&axis->field[f], cell ? cell : "");
        g_string_append_printf(s, "%s%s-%s", s->len ? "_" : "", axis->field[f].label, part);
        g_free(part);
    }
    return g_string_free(s, FALSE);
}

/* Numbers instead of labels that are alike or too long. */
static void number_labels(SweepAxis *axis, const char *what)
{
    for (uint64_t i = 0; i < axis->levels; i++) {
        g_free(axis->label[i]);
        axis->label[i] = g_strdup_printf("%s%" G_GUINT64_FORMAT, what, i + 1);
    }
}

void sweep_axis_label(SweepAxis *axis)
{
    if (axis->kind != AXIS_LIST) {
        axis->longest = 26; /* "-1.2345678901234567e-308" */
        return;
    }
    axis->label = g_new0(char *, axis->levels + 1);
    for (uint64_t i = 0; i < axis->levels; i++) {
        axis->label[i] = axis->table ? row_label(axis, i) : axis->named ? g_strdup(axis->cell[i]) : sweep_label(axis->field, axis->cell[i]);
        axis->longest = MAX(axis->longest, (uint32_t)strlen(axis->label[i]));
    }
    axis->alike = count_different(axis->label, axis->levels) < axis->levels;
    if (!axis->named && ((axis->table && (axis->alike || axis->longest > LONGEST_NAME)) || (axis->alike && all_cells_differ(axis)))) {
        number_labels(axis, axis->table ? "row-" : "");
        axis->alike = false;
        axis->longest = 24;
    }
}

/* Devices on Windows, whatever comes after a point: no file can be called so there. */
static bool is_device(const char *name)
{
    static const char *const device[] = {"con", "prn", "aux", "nul"};
    gsize stem = strcspn(name, ".");
    for (gsize i = 0; i < G_N_ELEMENTS(device); i++)
        if (stem == 3 && g_ascii_strncasecmp(name, device[i], 3) == 0)
            return true;
    return stem == 4 && g_ascii_isdigit(name[3]) && (g_ascii_strncasecmp(name, "com", 3) == 0 || g_ascii_strncasecmp(name, "lpt", 3) == 0);
}

gboolean sweep_check_name(const Spot *spot, const char *name, GError **error)
{
    const char *wrong = NULL;
    gsize length = strlen(name);
    if (!length || length > LONGEST_GIVEN)
        wrong = "must have 1 to 100 letters";
    else if (strchr(name, '/') || strchr(name, '\\') || *name == '.')
        wrong = "would leave the folder or hide; a name holds no / and \\ and begins with no point";
    else if (name[strspn(name, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.+-")] ||
             name[length - 1] == '.' || *name == '-')
        wrong = "must be of the letters A to Z, digits, and _ . + -, begin with no - and end with no point";
    else if (g_ascii_strcasecmp(name, "sweep") == 0)
        wrong = "is what a sweep calls files of its own";
    else if (is_device(name))
        wrong = "is a device on Windows, which has no files called so";
    if (!wrong)
        return TRUE;
    SweepField f = {.key = (char *)"name"};
    return sweep_fail(spot, f.key, PARAM_ERROR_VALUE, error, " = %s: %s", name, wrong);
}

/* Whether an axis has its part in names. */
static bool is_told(const Sweep *s, const SweepAxis *axis)
{
    return sweep_axis_varies(axis) && axis->kind != AXIS_EACH && (s->mode == SWEEP_SAMPLE || !axis->drawn);
}

void sweep_plan_names(Sweep *s)
{
    guint told = 0, length = INDEX_DIGITS + 4;
    bool apart = false; /* one of the axes of a zip tells all variants apart */
    for (guint i = 0; i < s->axis->len; i++) {
        const SweepAxis *axis = &g_array_index(s->axis, SweepAxis, i);
        if (!is_told(s, axis))
            continue;
        told++;
        length += axis->longest + (guint)strlen(axis->field[0].label) + 2;
        apart |= !axis->alike;
    }
    s->by_label = told && length <= LONGEST_NAME + INDEX_DIGITS + 4 && (s->mode != SWEEP_SAMPLE || told <= MOST_DRAWN);
    s->by_index = !s->by_label || s->mode == SWEEP_SAMPLE || (s->mode == SWEEP_ZIP && !apart);
}

/* What gives the names of a zip, if anything does. */
static const SweepAxis *only_named(const Sweep *s)
{
    for (guint i = 0; i < s->axis->len; i++) {
        const SweepAxis *axis = &g_array_index(s->axis, SweepAxis, i);
        if (s->mode == SWEEP_ZIP && axis->named)
            return axis;
    }
    return NULL;
}

char *sweep_name(const Sweep *s, const SweepVariant *v)
{
    const SweepAxis *named = only_named(s);
    if (named)
        return g_strdup(named->label[v->index]);
    GString *name = g_string_new(NULL);
    if (s->by_index)
        g_string_append_printf(name, "%0*" G_GUINT64_FORMAT, INDEX_DIGITS, v->index);
    for (guint i = 0, key = 0; i < s->axis->len && s->by_label; i++) {
        const SweepAxis *axis = &g_array_index(s->axis, SweepAxis, i);
        guint first = key;
        for (uint32_t f = 0; f < axis->fields; f++)
            key += axis->field[f].id != FIELD_NAME;
        if (!is_told(s, axis))
            continue;
        const char *before = name->len ? "_" : "";
        char *made = axis->label ? NULL : sweep_label(NULL, v->value[first]);
        const char *label = made ? made : axis->label[v->level[first]];
        if (axis->table)
            g_string_append_printf(name, "%s%s", before, label);
        else
            g_string_append_printf(name, "%s%s-%s", before, axis->field[0].label, label);
        g_free(made);
    }
    return g_string_free(name, FALSE);
}
