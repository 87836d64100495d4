/* Reading a sweep file. Lines are as in parameter files. */
#include <glib/gstdio.h>
#include <string.h>
#include <unistd.h>

#include "geom/textfile.h"
#include "param/private.h"
#include "param/suggest.h"
#include "sweep/private.h"

enum { LARGEST_FILE = 64 << 20 }; /* bytes */

typedef struct {
    Sweep *sweep;
    Spot spot;
    bool begun; /* [sweep] was there */
    GHashTable *seen; /* key to line */
    bool has_seed; /* sample_seed */
    unsigned mode_line, count_line, params_line;
} Reader;

static gboolean read_word(const Reader *r, const char *key, const char *value, const char *const *words, guint n, guint *out, GError **error)
{
    for (*out = 0; *out < n; ++*out)
        if (strcmp(words[*out], value) == 0)
            return TRUE;
    char *quoted = param_quote(value);
    const char *near = suggest_nearest(value, words, n);
    GString *s = g_string_new(n > 2 ? "one of " : "");
    for (guint i = 0; i < n; i++)
        g_string_append_printf(s, "%s%s", !i ? "" : i + 1 == n ? " or " : ", ", words[i]);
    sweep_fail(&r->spot, key, PARAM_ERROR_VALUE, error, " = %s: must be %s%s%s%s", quoted, s->str, near ? "; did you mean '" : "",
               near ? near : "", near ? "'?" : "");
    g_string_free(s, TRUE);
    g_free(quoted);
    return FALSE;
}

static gboolean read_number(const Reader *r, const char *key, const char *value, uint64_t least, uint64_t most, uint64_t *out,
                            GError **error)
{
    gint64 whole = 0;
    if (g_ascii_string_to_signed(value, 10, (gint64)least, (gint64)most, &whole, NULL)) {
        *out = (uint64_t)whole;
        return TRUE;
    }
    char *quoted = param_quote(value);
    sweep_fail(&r->spot, key, PARAM_ERROR_VALUE, error, " = %s: must be a whole number from %" G_GUINT64_FORMAT " to %" G_GUINT64_FORMAT,
               quoted, least, most);
    g_free(quoted);
    return FALSE;
}

static char *in_folder(const Sweep *s, const char *file)
{
    return g_path_is_absolute(file) || strcmp(s->folder, ".") == 0 ? g_strdup(file) : g_build_filename(s->folder, file, NULL);
}

/* Says which line names the file that an error is of. Returns FALSE. */
static gboolean name_line(const Reader *r, const char *key, GError **error)
{
    char *name = g_filename_display_name(r->spot.path);
    g_prefix_error(error, "%s:%u: [sweep] %s: ", name, r->spot.line, key);
    g_free(name);
    return FALSE;
}

static gboolean read_params(Reader *r, const char *value, GError **error)
{
    Sweep *s = r->sweep;
    s->params_path = in_folder(s, value);
    s->params = params_load(s->params_path, error);
    return s->params || name_line(r, "params", error);
}

/* A column's or line's key, which stands in the file for the first time. */
static gboolean note_key(Reader *r, const char *key, const Spot *spot, GError **error)
{
    unsigned before = GPOINTER_TO_UINT(g_hash_table_lookup(r->seen, key));
    if (before)
        return sweep_fail(spot, key, PARAM_ERROR_FILE, error, ": already given in line %u of the sweep file", before);
    g_hash_table_insert(r->seen, g_strdup(key), GUINT_TO_POINTER(r->spot.line));
    return TRUE;
}

static gboolean read_table(Reader *r, const char *value, GError **error)
{
    SweepAxis axis = {.line = r->spot.line};
    char *path = in_folder(r->sweep, value);
    Spot spot = {path, 0, true};
    gboolean good = sweep_axis_read_table(&axis, path, error);
    if (!good && (g_access(path, R_OK) != 0 || g_file_test(path, G_FILE_TEST_IS_DIR))) /* else the error names a line of its own */
        name_line(r, "table", error);
    for (uint32_t f = 0; f < axis.fields && good; f++)
        good = note_key(r, axis.field[f].key, &spot, error);
    g_free(path);
    g_array_append_val(r->sweep->axis, axis);
    return good;
}

static gboolean read_axis(Reader *r, const char *key, const char *value, GError **error)
{
    SweepAxis axis = {.line = r->spot.line, .field = g_new0(SweepField, 1)};
    gboolean good = sweep_field(&r->spot, key, axis.field, error);
    axis.fields = 1;
    if (good)
        axis.named = axis.field->id == FIELD_NAME;
    good = good && sweep_axis_read(&axis, value, &r->spot, error);
    if (good)
        axis.field->varies = sweep_axis_varies(&axis);
    g_array_append_val(r->sweep->axis, axis);
    return good;
}

static gboolean read_value(Reader *r, const char *key, const char *value, GError **error)
{
    static const char *const modes[] = {"grid", "zip", "sample"}, *const sequences[] = {"random", "halton"};
    Sweep *s = r->sweep;
    guint word = 0;
    gboolean good;
    if (!r->begun)
        return sweep_fail(&r->spot, key, PARAM_ERROR_FILE, error, ": [sweep] must come before the first key");
    if (!note_key(r, key, &r->spot, error))
        return FALSE;
    if (strcmp(key, "params") == 0)
        return read_params(r, value, error);
    if (strcmp(key, "table") == 0)
        return read_table(r, value, error);
    if (strcmp(key, "mode") == 0) {
        r->mode_line = r->spot.line;
        good = read_word(r, key, value, modes, 3, &word, error);
        s->mode = (SweepMode)word;
        return good;
    }
    if (strcmp(key, "sequence") == 0) {
        good = read_word(r, key, value, sequences, 2, &word, error);
        s->halton = word == 1;
        return good;
    }
    if (strcmp(key, "count") == 0) {
        r->count_line = r->spot.line;
        return read_number(r, key, value, 1, SWEEP_MOST, &s->count, error);
    }
    if (strcmp(key, "sample_seed") == 0) {
        r->has_seed = true;
        return read_number(r, key, value, 0, MOST_SEED, &s->sample_seed, error);
    }
    return read_axis(r, key, value, error);
}

static gboolean read_section(Reader *r, char *line, GError **error)
{
    gsize length = strlen(line);
    char *name = length > 1 && line[length - 1] == ']' ? g_strstrip(g_strndup(line + 1, length - 2)) : NULL;
    bool sweep = name && strcmp(name, "sweep") == 0;
    g_free(name);
    if (sweep) {
        r->begun = true;
        return TRUE;
    }
    char *quoted = param_quote(line), *origin = g_filename_display_name(r->spot.path);
    g_set_error(error, PARAM_ERROR, PARAM_ERROR_UNKNOWN,
                "%s:%u: %s: a sweep file has one section, [sweep]; keys stand there as veins.kill_distance",
                origin, r->spot.line, quoted);
    g_free(origin);
    g_free(quoted);
    return FALSE;
}

static gboolean read_line(Reader *r, char *line, GError **error)
{
    g_strstrip(line);
    if (!*line || *line == '#' || *line == ';')
        return TRUE;
    if (*line == '[')
        return read_section(r, line, error);
    char *equals = strchr(line, '=');
    if (!equals || equals == line) {
        char *quoted = param_quote(line);
        sweep_fail(&r->spot, NULL, PARAM_ERROR_FILE, error, "'%s': must be key = value, [sweep], or a comment after # or ;", quoted);
        g_free(quoted);
        return FALSE;
    }
    *equals = '\0';
    return read_value(r, g_strchomp(line), g_strchug(equals + 1), error);
}

/* Whether chance is all there is: what is one for all aside. */
static bool only_chance(const Sweep *s)
{
    bool chance = false, lists = false;
    for (guint i = 0; i < s->axis->len; i++) {
        const SweepAxis *axis = &g_array_index(s->axis, SweepAxis, i);
        chance |= axis->drawn || !axis->levels;
        lists |= axis->levels > 1 && !axis->drawn;
    }
    return chance && !lists;
}

/* `axis`: the longest, the one to shorten. */
static gboolean too_many(const Reader *r, const SweepAxis *axis, double count, GError **error)
{
    Spot spot = {r->spot.path, axis->line, false};
    return sweep_fail(&spot, axis->table ? "table" : axis->field->key, PARAM_ERROR_VALUE, error,
                      ": has %" G_GUINT64_FORMAT " values, and %.10g variants are too many; there may be up to %d", axis->levels, count, SWEEP_MOST);
}

static gboolean count_grid(Reader *r, GError **error)
{
    Sweep *s = r->sweep;
    const SweepAxis *longest = NULL;
    double all = 1.0;
    for (guint i = 0; i < s->axis->len; i++) {
        const SweepAxis *axis = &g_array_index(s->axis, SweepAxis, i);
        if (!axis->levels || axis->drawn)
            continue;
        all *= (double)axis->levels;
        longest = longest && longest->levels >= axis->levels ? longest : axis;
    }
    if (all > SWEEP_MOST)
        return too_many(r, longest, all, error);
    s->count = 1;
    for (guint i = s->axis->len; i-- > 0;) { /* the last key changes fastest */
        SweepAxis *axis = &g_array_index(s->axis, SweepAxis, i);
        if (!axis->levels || axis->drawn)
            continue;
        axis->stride = s->count;
        s->count *= axis->levels;
    }
    return TRUE;
}

static gboolean count_zip(Reader *r, GError **error)
{
    Sweep *s = r->sweep;
    const SweepAxis *first = NULL;
    for (guint i = 0; i < s->axis->len; i++) {
        const SweepAxis *axis = &g_array_index(s->axis, SweepAxis, i);
        if ((axis->levels < 2 && !axis->named) || axis->drawn)
            continue;
        Spot spot = {r->spot.path, axis->line, false};
        if (axis->levels > SWEEP_MOST)
            return too_many(r, axis, (double)axis->levels, error);
        if (first && axis->levels != first->levels)
            return sweep_fail(&spot, axis->table ? "table" : axis->field->key, PARAM_ERROR_VALUE, error,
                              ": has %" G_GUINT64_FORMAT " values, and %s of line %u has %" G_GUINT64_FORMAT
                              "; in mode zip there must be as many (or one for all)",
                              axis->levels, first->table ? "the table" : first->field->key, first->line, first->levels);
        first = first ? first : axis;
    }
    s->count = first ? first->levels : 1;
    return TRUE;
}

/* What equal values and names mean differs with the mode. */
static gboolean check_axis(const Reader *r, const SweepAxis *axis, GError **error)
{
    const Sweep *s = r->sweep;
    Spot spot = {r->spot.path, axis->line, false};
    const char *key = axis->table ? "table" : axis->field->key;
    if (axis->named && !axis->table && (s->mode != SWEEP_ZIP || axis->kind != AXIS_LIST || axis->drawn))
        return sweep_fail(&spot, key, PARAM_ERROR_VALUE, error, ": names are a list of mode zip, or a column of the table");
    if (axis->alike && axis->named && !axis->drawn)
        return sweep_fail(&spot, key, PARAM_ERROR_VALUE, error, ": two variants of the same name (upper and lower case are one)");
    if (axis->alike && s->mode == SWEEP_GRID && !axis->drawn)
        return sweep_fail(&spot, key, PARAM_ERROR_VALUE, error, ": two values are the same");
    return TRUE;
}

static gboolean count_variants(Reader *r, GError **error)
{
    Sweep *s = r->sweep;
    Spot spot = {r->spot.path, r->count_line ? r->count_line : r->mode_line, false};
    for (guint i = 0; i < s->axis->len; i++)
        if (!check_axis(r, &g_array_index(s->axis, SweepAxis, i), error))
            return FALSE;
    if (s->mode == SWEEP_SAMPLE && !r->count_line)
        return sweep_fail(&spot, "count", PARAM_ERROR_VALUE, error,
                          ": missing; mode sample needs the number of variants, 1 to %d", SWEEP_MOST);
    if (s->mode == SWEEP_SAMPLE)
        return TRUE;
    if (r->count_line)
        return sweep_fail(&spot, "count", PARAM_ERROR_VALUE, error, ": is of mode sample; in the others the lists give the number");
    if (only_chance(s))
        return sweep_fail(&spot, "mode", PARAM_ERROR_VALUE, error,
                          ": nothing to combine, all that varies is drawn by chance; that is mode = sample, with a count");
    return s->mode == SWEEP_GRID ? count_grid(r, error) : count_zip(r, error);
}

/* Seeds that follow each other end where single ones do. */
static gboolean check_seeds(const Reader *r, GError **error)
{
    const Sweep *s = r->sweep;
    for (guint i = 0; i < s->axis->len; i++) {
        const SweepAxis *axis = &g_array_index(s->axis, SweepAxis, i);
        Spot spot = {r->spot.path, axis->line, false};
        if (axis->kind == AXIS_EACH && s->sample_seed + (s->count - 1) > MOST_SEED)
            return sweep_fail(&spot, "seed", PARAM_ERROR_VALUE, error,
                              " = each: the last would be beyond 2^53; sample_seed may be up to %" G_GUINT64_FORMAT, MOST_SEED - (s->count - 1));
    }
    return TRUE;
}

static unsigned next_prime(unsigned n)
{
    for (bool prime = false; !prime;) {
        n++;
        prime = true;
        for (unsigned d = 2; d * d <= n && prime; d++)
            prime = n % d != 0;
    }
    return n;
}

/* Chance goes by the key's name, so that a key more or less, or another order, changes no other's draws; Halton's by what is drawn, in
 * the file's order, since low bases are the most even. */
static void seat_chance(Sweep *s)
{
    unsigned prime = 1;
    for (guint i = 0; i < s->axis->len; i++) {
        SweepAxis *axis = &g_array_index(s->axis, SweepAxis, i);
        axis->key = 0x811c9dc5u; /* FNV-1a */
        for (const char *c = axis->table ? "table" : axis->field->key; *c; c++)
            axis->key = (axis->key ^ (unsigned char)*c) * 0x01000193u;
        if (axis->kind != AXIS_EACH && axis->levels != 1 && (s->mode == SWEEP_SAMPLE || axis->drawn || !axis->levels))
            axis->base = prime = next_prime(prime);
        if (axis->base && s->halton)
            sweep_seat_digits(s, axis);
    }
}

/* Keys by themselves where no two are alike, and none like the run's seed. */
static void label_fields(Sweep *s)
{
    GHashTable *count = g_hash_table_new(g_str_hash, g_str_equal);
    for (int round = 0; round < 2; round++)
        for (guint i = 0; i < s->axis->len; i++) {
            const SweepAxis *axis = &g_array_index(s->axis, SweepAxis, i);
            for (uint32_t k = 0; k < axis->fields; k++) {
                SweepField *f = &axis->field[k];
                guint n = GPOINTER_TO_UINT(g_hash_table_lookup(count, f->info->key));
                if (round == 0)
                    g_hash_table_insert(count, (gpointer)f->info->key, GUINT_TO_POINTER(n + 1));
                else if (n > 1)
                    f->label = f->key;
            }
        }
    g_hash_table_destroy(count);
}

static gboolean finish(Reader *r, GError **error)
{
    Sweep *s = r->sweep;
    r->spot.line = 0;
    if (!r->begun)
        return sweep_fail(&r->spot, NULL, PARAM_ERROR_FILE, error, "missing; a sweep file begins with this section");
    if (!s->params)
        return sweep_fail(&r->spot, "params", PARAM_ERROR_FILE, error,
                          ": missing; it names the parameter file that all variants begin with");
    label_fields(s);
    for (guint i = 0; i < s->axis->len; i++) {
        SweepAxis *axis = &g_array_index(s->axis, SweepAxis, i);
        sweep_axis_label(axis);
        if (axis->field->id == FIELD_SEED && !axis->table && axis->kind == AXIS_LIST && axis->levels == 1 && !r->has_seed)
            s->sample_seed = (uint64_t)g_ascii_strtoull(axis->cell[0], NULL, 10);
    }
    if (!count_variants(r, error) || !check_seeds(r, error))
        return FALSE;
    seat_chance(s);
    sweep_plan_names(s);
    return TRUE;
}

static gboolean is_text(Spot spot, const char *text, gsize length, GError **error)
{
    if (length <= LARGEST_FILE && !memchr(text, 0, length) && g_utf8_validate(text, (gssize)length, NULL))
        return TRUE;
    spot.table = true; /* no section to name */
    return sweep_fail(&spot, NULL, PARAM_ERROR_FILE, error, length > LARGEST_FILE ? "larger than any sweep file" : "not UTF-8 text");
}

Sweep *sweep_parse(const char *text, gsize length, const char *path, GError **error)
{
    Sweep *s = g_new0(Sweep, 1);
    Reader r = {.sweep = s, .spot = {path, 0, false}};
    s->path = g_strdup(path);
    s->folder = g_path_get_dirname(path);
    s->axis = g_array_new(FALSE, TRUE, sizeof(SweepAxis));
    s->sample_seed = 1;
    r.seen = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
    gboolean good = is_text(r.spot, text, length, error);
    if (good) {
        bool marked = length >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0;
        char *body = g_strndup(text + (marked ? 3 : 0), length - (marked ? 3 : 0));
        for (char *line = body, *end; line && good; line = end) {
            end = strchr(line, '\n');
            if (end)
                *end++ = '\0';
            r.spot.line++;
            good = read_line(&r, line, error);
        }
        good = good && finish(&r, error);
        g_free(body);
    }
    g_hash_table_destroy(r.seen);
    if (good)
        return s;
    sweep_free(s);
    return NULL;
}

Sweep *sweep_load(const char *path, GError **error)
{
    char *text;
    gsize length;
    GError *problem = NULL;
    if (!textfile_read(path, LARGEST_FILE, &text, &length, &problem)) {
        Spot spot = {path, 0, true};
        sweep_fail(&spot, NULL, PARAM_ERROR_FILE, error, "%s", problem->message);
        g_error_free(problem);
        return NULL;
    }
    Sweep *s = sweep_parse(text, length, path, error);
    g_free(text);
    return s;
}
