/* What else is in the output folder: other runs at work, leaves of former sweep files and of other parameters. */
#include <json-glib/json-glib.h>
#include <stdio.h>
#include <string.h>

#include "batch/private.h"

/* What runs write into until it is whole (cli/output.h). */
#define HIDDEN ".venation-"

static GDir *open_in(const BatchDef *def, const char *relative)
{
    char *path = g_build_filename(def->out, relative, NULL);
    GDir *dir = g_dir_open(path, 0, NULL);
    g_free(path);
    return dir;
}

const char *batch_next_hidden(const BatchDef *def, GDir *dir)
{
    const char *name, *own = def->staging ? strrchr(def->staging, '/') : NULL;
    while (dir && (name = g_dir_read_name(dir)))
        if (g_str_has_prefix(name, HIDDEN) && !(own && strcmp(own + 1, name) == 0))
            return name;
    return NULL;
}

bool batch_in_hand(const BatchDef *def, const char *variant)
{
    GDir *dir = g_dir_open(def->out, 0, NULL);
    const char *name;
    bool found = false;
    while (!found && (name = batch_next_hidden(def, dir))) {
        char *path = g_build_filename(def->out, name, variant, NULL);
        found = g_file_test(path, G_FILE_TEST_IS_DIR);
        g_free(path);
    }
    if (dir)
        g_dir_close(dir);
    return found;
}

/* ---- leaves of no variant ---- */

static void add(BatchNames *n, char *path)
{
    n->count++;
    for (gsize i = 0; i < BATCH_TOLD; i++)
        if (!n->first[i] || strcmp(path, n->first[i]) < 0) {
            char *later = n->first[i];
            n->first[i] = path;
            path = later;
            if (!path)
                return;
        }
    g_free(path);
}

/* Whether the row in this file is of a variant of the sweep whose place this is: rows begin with their index. */
static bool is_named(const BatchDef *def, const char *relative, const char *row)
{
    char *path = g_build_filename(def->out, row, NULL), head[64];
    FILE *file = fopen(path, "re");
    unsigned long long index = 0;
    bool named = file && fgets(head, sizeof head, file) && sscanf(head, "{\"index\": %18llu,", &index) == 1 && index < sweep_count(def->sweep);
    if (named) {
        SweepVariant v;
        sweep_variant(def->sweep, index, &v);
        char *folder = row_folder(def->sweep, &v), *failed = row_failed(&v);
        named = strcmp(relative, folder) == 0 || strcmp(relative, failed) == 0;
        g_free(folder);
        g_free(failed);
        sweep_variant_clear(&v);
    }
    if (file)
        fclose(file);
    g_free(path);
    return named;
}

/* Folders that have a row, in this one and those below it; of a thousand leaves each in large sweeps. */
static void find_leaves(const BatchDef *def, const char *relative, int depth, BatchNames *n)
{
    GDir *dir = open_in(def, relative);
    const char *name;
    while (dir && (name = g_dir_read_name(dir))) {
        char *folder = g_strconcat(relative, "/", name, NULL), *row = g_strconcat(folder, "/sweep.json", NULL), *path = g_build_filename(def->out, row, NULL);
        bool leaf = g_file_test(path, G_FILE_TEST_IS_REGULAR);
        if (leaf && !is_named(def, folder, row))
            add(n, g_strdup(folder));
        else if (!leaf && depth > 0)
            find_leaves(def, folder, depth - 1, n);
        g_free(path);
        g_free(row);
        g_free(folder);
    }
    if (dir)
        g_dir_close(dir);
}

void batch_unnamed(const BatchDef *def, BatchNames *out)
{
    *out = (BatchNames){0};
    find_leaves(def, "leaves", 1, out);
    GDir *dir = open_in(def, "failed");
    const char *name;
    while (dir && (name = g_dir_read_name(dir))) {
        char *row = g_strconcat("failed/", name, NULL);
        if (g_str_has_suffix(name, ".json") && !is_named(def, row, row))
            add(out, g_strdup(row));
        g_free(row);
    }
    if (dir)
        g_dir_close(dir);
}

/* ---- leaves of other parameters ---- */

static bool same_list(JsonArray *found, const double *wanted, guint n, guint each)
{
    if (json_array_get_length(found) != n)
        return false;
    for (guint i = 0; i < n * each; i++) {
        JsonNode *node = json_array_get_element(found, i / each);
        JsonArray *point = each > 1 && JSON_NODE_HOLDS_ARRAY(node) ? json_node_get_array(node) : NULL;
        if (each > 1 && !(point && json_array_get_length(point) == each))
            return false;
        if ((point ? json_array_get_double_element(point, i % each) : json_node_get_double(node)) != wanted[i])
            return false;
    }
    return true;
}

/* Whether a leaf's record has this value of the parameter. */
static bool same_value(JsonNode *found, const Params *p, ParamId id)
{
    ParamType type = param_info(id)->type;
    if (type == TYPE_NUMBERS || type == TYPE_POINTS) {
        uint32_t n;
        const double *list = params_list(p, id, &n);
        return JSON_NODE_HOLDS_ARRAY(found) && same_list(json_node_get_array(found), list, n, type == TYPE_POINTS ? 2 : 1);
    }
    if (!JSON_NODE_HOLDS_VALUE(found))
        return false;
    if (type == TYPE_NUMBER || type == TYPE_INTEGER)
        return json_node_get_double(found) == (type == TYPE_NUMBER ? params_number(p, id) : (double)params_integer(p, id));
    if (type == TYPE_SWITCH)
        return !json_node_get_boolean(found) == !params_switch(p, id);
    char *text = params_format(p, id);
    bool same = g_strcmp0(text, json_node_get_string(found)) == 0;
    g_free(text);
    return same;
}

static void list_differing(JsonObject *sections, const Params *p, GString *out)
{
    for (int i = 0; i < PARAM_COUNT; i++) {
        const ParamInfo *info = param_info((ParamId)i);
        JsonNode *section = json_object_get_member(sections, info->section);
        JsonNode *found = section && JSON_NODE_HOLDS_OBJECT(section) ? json_object_get_member(json_node_get_object(section), info->key) : NULL;
        if (found && !same_value(found, p, (ParamId)i))
            g_string_append_printf(out, "%s%s.%s", out->len ? ", " : "", info->section, info->key);
    }
}

char *batch_differing(const BatchDef *def, uint64_t index)
{
    GString *names = g_string_new(NULL);
    Row row;
    row_read(def->sweep, def->out, index, &row);
    char *path = g_strdup_printf("%s/%s/%s.json", def->out, row.folder, row.variant.name), *text = NULL;
    JsonNode *root = g_file_get_contents(path, &text, NULL, NULL) ? json_from_string(text, NULL) : NULL;
    JsonNode *found = root && JSON_NODE_HOLDS_OBJECT(root) ? json_object_get_member(json_node_get_object(root), "parameters") : NULL;
    Params *p = batch_params(def, &row.variant, NULL);
    if (p && found && JSON_NODE_HOLDS_OBJECT(found))
        list_differing(json_node_get_object(found), p, names);
    params_free(p);
    if (root)
        json_node_unref(root);
    g_free(text);
    g_free(path);
    row_clear(&row);
    return g_string_free(names, FALSE);
}

void batch_hidden(const BatchDef *def, BatchNames *out)
{
    *out = (BatchNames){0};
    GDir *dir = g_dir_open(def->out, 0, NULL);
    const char *name;
    while ((name = batch_next_hidden(def, dir)))
        add(out, g_strdup(name));
    if (dir)
        g_dir_close(dir);
}

void batch_names_clear(BatchNames *n)
{
    for (gsize i = 0; i < BATCH_TOLD; i++)
        g_free(n->first[i]);
    *n = (BatchNames){0};
}
