/* A table of variants: CSV with a heading of keys, cells parted by commas, in quotes where they hold one. */
#include <string.h>

#include "geom/textfile.h"
#include "sweep/private.h"

enum { LARGEST_TABLE = 256 << 20 };

/* The cells of a line, which is cut up; NULL when quotes are wrong. Free the array. */
static GPtrArray *split(char *line)
{
    GPtrArray *cells = g_ptr_array_new();
    bool good = true;
    for (char *c = line; c && good;) {
        c += strspn(c, " \t");
        char *end;
        if (*c == '"') {
            char *from = ++c, *to = from;
            g_ptr_array_add(cells, to);
            for (; *from && !(from[0] == '"' && from[1] != '"'); from++) {
                from += from[0] == '"';
                *to++ = *from;
            }
            good = *from == '"';
            end = from + good;
            end += strspn(end, " \t");
            good = good && (!*end || *end == ',');
            bool more = *end == ',';
            *to = '\0';
            c = more ? end + 1 : NULL;
        } else {
            end = strchr(c, ',');
            g_ptr_array_add(cells, c);
            if (end)
                *end++ = '\0';
            g_strchomp(c);
            c = end;
        }
    }
    if (good)
        return cells;
    g_ptr_array_free(cells, TRUE);
    return NULL;
}

static gboolean read_heading(SweepAxis *axis, const GPtrArray *cells, const Spot *spot, GError **error)
{
    axis->field = g_new0(SweepField, cells->len);
    for (guint i = 0; i < cells->len; i++) {
        if (!sweep_field(spot, cells->pdata[i], &axis->field[i], error))
            return FALSE;
        axis->fields = i + 1;
        axis->named |= axis->field[i].id == FIELD_NAME;
        for (guint k = 0; k < i; k++)
            if (strcmp(axis->field[i].key, axis->field[k].key) == 0)
                return sweep_fail(spot, axis->field[i].key, PARAM_ERROR_FILE, error, ": two columns are called so");
    }
    return axis->fields > axis->named || sweep_fail(spot, NULL, PARAM_ERROR_FILE, error, "no column is a key");
}

static gboolean read_row(SweepAxis *axis, GPtrArray *out, const GPtrArray *cells, const Spot *spot, GError **error)
{
    if (cells->len != axis->fields)
        return sweep_fail(spot, NULL, PARAM_ERROR_FILE, error, "%u cell%s, and the heading has %u", cells->len, cells->len == 1 ? "" : "s",
                          axis->fields);
    for (guint i = 0; i < cells->len; i++) {
        const char *cell = cells->pdata[i];
        const SweepField *f = &axis->field[i];
        char *value = NULL;
        if (*cell || f->id == FIELD_NAME) {
            value = sweep_value(spot, f, cell, error);
            if (!value)
                return FALSE;
        }
        g_ptr_array_add(out, value);
    }
    axis->levels++;
    return TRUE;
}

static gboolean check_names(const SweepAxis *axis, const Spot *spot, GError **error)
{
    GHashTable *seen = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
    gboolean good = TRUE;
    for (uint32_t f = 0; f < axis->fields; f++)
        for (uint64_t i = 0; i < axis->levels && axis->field[f].id == FIELD_NAME && good; i++)
            if (!g_hash_table_add(seen, g_ascii_strdown(axis->cell[i * axis->fields + f], -1)))
                good = sweep_fail(spot, "name", PARAM_ERROR_VALUE, error, " = %s: there are two of this name (upper and lower case are one)",
                                  axis->cell[i * axis->fields + f]);
    g_hash_table_destroy(seen);
    return good;
}

static gboolean read_lines(SweepAxis *axis, char *text, GPtrArray *cells, Spot *spot, GError **error)
{
    gboolean good = TRUE;
    for (char *line = text, *end; line && good; line = end) {
        end = strchr(line, '\n');
        if (end)
            *end++ = '\0';
        spot->line++;
        g_strstrip(line);
        if (!*line || g_str_has_prefix(line, "# ") || strcmp(line, "#") == 0)
            continue;
        GPtrArray *row = split(line);
        if (!row)
            good = sweep_fail(spot, NULL, PARAM_ERROR_FILE, error, "quotes that do not close, or text after them");
        else
            good = axis->field ? read_row(axis, cells, row, spot, error) : read_heading(axis, row, spot, error);
        if (row)
            g_ptr_array_free(row, TRUE);
    }
    return good;
}

static void note_columns(SweepAxis *axis)
{
    for (uint32_t f = 0; f < axis->fields; f++)
        for (uint64_t i = 1; i < axis->levels && !axis->field[f].varies; i++)
            axis->field[f].varies = g_strcmp0(axis->cell[f], axis->cell[i * axis->fields + f]) != 0;
}

gboolean sweep_axis_read_table(SweepAxis *axis, const char *path, GError **error)
{
    Spot spot = {path, 0, true};
    char *text;
    gsize length;
    GError *problem = NULL;
    axis->table = true;
    if (!textfile_read(path, LARGEST_TABLE, &text, &length, &problem)) {
        sweep_fail(&spot, NULL, PARAM_ERROR_FILE, error, "%s", problem->message);
        g_error_free(problem);
        return FALSE;
    }
    GPtrArray *cells = g_ptr_array_new();
    gboolean good = !memchr(text, 0, length) && g_utf8_validate(text, (gssize)length, NULL);
    if (!good)
        sweep_fail(&spot, NULL, PARAM_ERROR_FILE, error, "not UTF-8 text");
    else
        good = read_lines(axis, text + (g_str_has_prefix(text, "\xEF\xBB\xBF") ? 3 : 0), cells, &spot, error);
    spot.line = 0;
    uint64_t whole = axis->levels * axis->fields;
    for (guint i = (guint)whole; i < cells->len; i++) /* of a row that is not whole */
        g_free(cells->pdata[i]);
    axis->cell = (char **)g_ptr_array_free(cells, FALSE);
    if (good && !axis->levels)
        good = sweep_fail(&spot, NULL, PARAM_ERROR_FILE, error, "no rows; a heading of keys comes first, then a row for each variant");
    good = good && check_names(axis, &spot, error);
    if (good)
        note_columns(axis);
    g_free(text);
    return good;
}
