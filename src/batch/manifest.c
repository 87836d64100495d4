/* All rows in one file, as JSON lines and as a table. */
#include <errno.h>
#include <json-glib/json-glib.h>
#include <string.h>

#include "batch/private.h"
#include "export/export.h"
#include "export/sink.h"

typedef struct {
    const BatchDef *def;
    Keys *keys;
    Sink *lines, *table;
    BatchCheck check;
} Manifest;

/* A row of another run's parameters is none of ours. */
static bool is_current(const Manifest *m, const Row *row)
{
    Params *p = batch_params(m->def, &row->variant, NULL);
    char *wanted = keys_of(m->keys, p ? p : m->def->params, row->variant.seed), *found = row_key(row);
    bool current = found && strcmp(wanted, found) == 0;
    g_free(wanted);
    g_free(found);
    params_free(p);
    return current;
}

/* ---- the table ---- */

static void add_cell(GString *s, const char *text)
{
    bool plain = !text[strcspn(text, "\",;\n\r")] && *text != ' ' && *text != '#';
    if (plain) {
        g_string_append(s, text);
        return;
    }
    g_string_append_c(s, '"');
    for (const char *c = text; *c; c++)
        g_string_append(s, *c == '"' ? "\"\"" : (char[]){*c, '\0'});
    g_string_append_c(s, '"');
}

static void add_value(GString *s, JsonObject *row, const char *name)
{
    JsonNode *node = json_object_get_member(row, name);
    if (!node || JSON_NODE_HOLDS_NULL(node))
        return;
    if (json_node_get_value_type(node) == G_TYPE_STRING)
        add_cell(s, json_node_get_string(node));
    else if (json_node_get_value_type(node) == G_TYPE_INT64)
        g_string_append_printf(s, "%" G_GINT64_FORMAT, json_node_get_int(node));
    else
        export_number(s, json_node_get_double(node));
}

/* Calls `each` for every column; the seed is one even where the sweep has no key of that name. */
static void each_column(const Sweep *s, void (*each)(GString *out, JsonObject *row, const char *name), GString *out, JsonObject *row)
{
    static const char *const first[] = {"index", "variant", "outcome", "error", "folder"};
    bool seeded = false;
    for (gsize i = 0; i < G_N_ELEMENTS(first); i++) {
        g_string_append(out, i ? "," : "");
        each(out, row, first[i]);
    }
    for (uint32_t k = 0; k < sweep_keys(s); k++) {
        seeded |= sweep_key(s, k).id < 0;
        g_string_append_c(out, ',');
        each(out, row, sweep_key(s, k).key);
    }
    if (!seeded) {
        g_string_append_c(out, ',');
        each(out, row, "seed");
    }
    for (const char *const *c = row_counts(); *c; c++) {
        g_string_append_c(out, ',');
        each(out, row, *c);
    }
    g_string_append_c(out, '\n');
}

static void add_heading(GString *s, JsonObject *row, const char *name) { g_string_append(s, name); }

/* ---- both ---- */

static void add_row(Manifest *m, const char *json)
{
    g_string_append(m->lines->text, json);
    g_string_append_c(m->lines->text, '\n');
    sink_drain(m->lines);
    JsonNode *root = json_from_string(json, NULL);
    each_column(m->def->sweep, add_value, m->table->text, json_node_get_object(root));
    json_node_unref(root);
    sink_drain(m->table);
}

static void note(uint64_t *count, uint64_t *first, bool found, uint64_t index)
{
    *count += found;
    if (found)
        *first = MIN(*first, index);
}

static gboolean fill(Manifest *m, BatchCount *count, GError **error)
{
    const Sweep *s = m->def->sweep;
    gboolean ok = TRUE;
    *count = (BatchCount){.first_stale = UINT64_MAX, .first_damaged = UINT64_MAX};
    if (m->table)
        each_column(s, add_heading, m->table->text, NULL);
    for (uint64_t i = m->def->shard; i < sweep_count(s) && ok; i += m->def->shards) {
        Row row;
        row_read(s, m->def->out, i, &row);
        bool current = row.outcome != ROW_MISSING && is_current(m, &row), grown = row.outcome == ROW_GROWN;
        bool damaged = current && grown && m->check != BATCH_ROWS && !row_is_whole(m->def->out, &row, m->check == BATCH_CONTENTS), there = current && !damaged;
        char *missing = there ? NULL : row_missing(s, &row.variant);
        if (m->table)
            add_row(m, there ? row.json : missing);
        count->grown += there && grown;
        count->failed += there && !grown;
        count->missing += !there;
        note(&count->stale, &count->first_stale, grown && !current, i);
        note(&count->damaged, &count->first_damaged, damaged, i);
        g_free(missing);
        row_clear(&row);
        ok = watch_tick(&m->def->watch, (double)(i + 1) / (double)sweep_count(s), error);
    }
    return ok;
}

gboolean batch_count(const BatchDef *def, BatchCheck check, BatchCount *count, GError **error)
{
    Manifest m = {.def = def, .keys = keys_new(def), .check = check};
    gboolean ok = fill(&m, count, error);
    keys_free(m.keys);
    return ok;
}

/* A file that isn't whole goes. */
static gboolean end(Sink *s, gboolean ok, GError **error)
{
    if (!s)
        return FALSE;
    if (!ok)
        s->error = ECANCELED;
    return sink_close(s, ok ? error : NULL) && ok;
}

gboolean manifest_write(const BatchDef *def, BatchCount *count, GError **error)
{
    const char *in = def->staging ? def->staging : def->out;
    char *lines = g_build_filename(in, "manifest.jsonl", NULL), *table = g_build_filename(in, "manifest.csv", NULL);
    Manifest m = {.def = def, .keys = keys_new(def), .check = BATCH_SIZES};
    m.lines = sink_open(lines, error);
    m.table = m.lines ? sink_open(table, error) : NULL;
    gboolean ok = m.table && fill(&m, count, error);
    ok = end(m.lines, ok, error);
    ok = end(m.table, ok, error);
    if (ok && def->staging)
        ok = batch_place_file(in, def->out, "manifest.jsonl", error) && batch_place_file(in, def->out, "manifest.csv", error);
    keys_free(m.keys);
    g_free(lines);
    g_free(table);
    return ok;
}
