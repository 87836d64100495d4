/* A thousand rows as columns, for the page. A column is [values], or {"c": value} where all are equal, or {"d": [values], "i": [which]} where few differ, so
 * that 100 000 rows of thirty columns load in a moment. Columns whose names begin with '@' are the page's own. */
#include <json-glib/json-glib.h>
#include <string.h>

#include "batch/page_private.h"
#include "export/export.h"

enum { MOST_FILES = 200 };

typedef struct {
    char *name;
    GHashTable *known; /* text as JSON → which of `different` + 1 */
    GPtrArray *different;
    uint32_t *at; /* by row */
} Column;

typedef struct {
    uint64_t n;
    GPtrArray *column;
    GHashTable *by_name;
} Table;

static void column_free(gpointer column)
{
    Column *c = column;
    g_hash_table_destroy(c->known);
    g_ptr_array_free(c->different, TRUE);
    g_free(c->at);
    g_free(c->name);
    g_free(c);
}

static uint32_t intern(Column *c, const char *json)
{
    gpointer found = g_hash_table_lookup(c->known, json);
    if (found)
        return GPOINTER_TO_UINT(found) - 1;
    char *own = g_strdup(json);
    g_ptr_array_add(c->different, own);
    g_hash_table_insert(c->known, own, GUINT_TO_POINTER(c->different->len));
    return c->different->len - 1;
}

static Column *column_of(Table *t, const char *name)
{
    Column *c = g_hash_table_lookup(t->by_name, name);
    if (c)
        return c;
    c = g_new0(Column, 1);
    c->name = g_strdup(name);
    c->known = g_hash_table_new(g_str_hash, g_str_equal);
    c->different = g_ptr_array_new_with_free_func(g_free);
    c->at = g_new0(uint32_t, t->n); /* rows that don't have it: null */
    intern(c, "null");
    g_ptr_array_add(t->column, c);
    g_hash_table_insert(t->by_name, c->name, c);
    return c;
}

static void set(Table *t, const char *name, uint64_t row, const char *json)
{
    Column *c = column_of(t, name);
    c->at[row] = intern(c, json);
}

static void set_text(Table *t, const char *name, uint64_t row, const char *text)
{
    GString *s = g_string_new(NULL);
    page_string(s, text);
    set(t, name, row, s->str);
    g_string_free(s, TRUE);
}

/* ---- what a row holds ---- */

static gint by_text(gconstpointer a, gconstpointer b) { return strcmp(*(char *const *)a, *(char *const *)b); }

/* Names of the files in the variant's folder, between '/', which none of them holds; '*' for the variant's name, so that all variants' lists are alike. */
static char *list_files(const char *out, const Row *row)
{
    char *path = g_build_filename(out, row->folder, NULL);
    GDir *dir = g_dir_open(path, 0, NULL);
    GPtrArray *names = g_ptr_array_new_with_free_func(g_free);
    gsize length = strlen(row->variant.name);
    const char *name;
    while (dir && (name = g_dir_read_name(dir)) && names->len < MOST_FILES) {
        if (*name == '.')
            continue;
        bool own = strncmp(name, row->variant.name, length) == 0 && (name[length] == '.' || name[length] == '_');
        g_ptr_array_add(names, own ? g_strconcat("*", name + length, NULL) : g_strdup(name));
    }
    if (dir)
        g_dir_close(dir);
    g_ptr_array_sort(names, by_text);
    g_ptr_array_add(names, NULL);
    char *list = g_strjoinv("/", (char **)names->pdata);
    g_ptr_array_free(names, TRUE);
    g_free(path);
    return list;
}

/* As JSON writes numbers. */
static bool is_number(const char *text)
{
    const char *c = text + (*text == '-');
    gsize whole = strspn(c, "0123456789");
    if (!whole || (*c == '0' && whole > 1) || whole > 15)
        return false;
    c += whole;
    if (*c == '.') {
        gsize part = strspn(++c, "0123456789");
        if (!part)
            return false;
        c += part;
    }
    if (*c == 'e' || *c == 'E') {
        c += 1 + (c[1] == '-' || c[1] == '+');
        gsize power = strspn(c, "0123456789");
        if (!power)
            return false;
        c += power;
    }
    return !*c;
}

static void set_values(Table *t, const Sweep *s, uint64_t at, const SweepVariant *v)
{
    char *seed = g_strdup_printf("%" G_GUINT64_FORMAT, v->seed);
    (is_number(seed) ? set : set_text)(t, "seed", at, seed); /* also where no key gives it */
    g_free(seed);
    for (uint32_t k = 0; k < sweep_keys(s); k++) {
        SweepKey key = sweep_key(s, k);
        if (key.id < 0)
            continue;
        ParamType type = param_info((ParamId)key.id)->type;
        bool number = type == TYPE_NUMBER || type == TYPE_INTEGER || type == TYPE_NUMBERS;
        if (v->value[k] && number && is_number(v->value[k]))
            set(t, key.key, at, v->value[k]);
        else
            set_text(t, key.key, at, v->value[k]);
    }
}

static char *number_or_text(JsonNode *node)
{
    if (!JSON_NODE_HOLDS_VALUE(node) || json_node_get_value_type(node) != G_TYPE_DOUBLE)
        return json_to_string(node, FALSE);
    GString *s = g_string_new(NULL);
    export_number(s, json_node_get_double(node)); /* the shortest form, which JSON-GLib's is not */
    return g_string_free(s, FALSE);
}

/* The rest of the row as it stands in its file: counts and hashes. */
static void set_counts(Table *t, const Sweep *s, uint64_t at, const char *json)
{
    static const char *const known[] = {"index", "variant", "outcome", "error", "folder", "seed", NULL};
    JsonNode *root = json ? json_from_string(json, NULL) : NULL;
    JsonObjectIter each;
    const char *name;
    JsonNode *node;
    if (root && JSON_NODE_HOLDS_OBJECT(root)) {
        json_object_iter_init_ordered(&each, json_node_get_object(root));
        while (json_object_iter_next_ordered(&each, &name, &node)) {
            bool skip = *name == '@' || g_strv_contains(known, name);
            for (uint32_t k = 0; k < sweep_keys(s) && !skip; k++)
                skip = strcmp(sweep_key(s, k).key, name) == 0;
            if (skip)
                continue;
            char *text = number_or_text(node);
            if (JSON_NODE_HOLDS_VALUE(node) && json_node_get_value_type(node) == G_TYPE_STRING)
                set_text(t, name, at, json_node_get_string(node));
            else if (is_number(text))
                set(t, name, at, text);
            else if (!JSON_NODE_HOLDS_NULL(node))
                set_text(t, name, at, text);
            g_free(text);
        }
    }
    if (root)
        json_node_unref(root);
}

static void set_row(Table *t, const Sweep *s, const char *out, uint64_t at, const Row *row)
{
    static const char *const outcome[] = {"0", "1", "2"};
    set_text(t, "@name", at, row->variant.name);
    set(t, "@outcome", at, outcome[row->outcome]);
    if (row->error)
        set_text(t, "@error", at, row->error);
    if (row->outcome == ROW_GROWN && row->folder) {
        char *parent = g_path_get_dirname(row->folder), *files = list_files(out, row);
        char *base = g_path_get_basename(row->folder);
        set_text(t, "@folder", at, strcmp(base, row->variant.name) == 0 ? parent : row->folder);
        set(t, "@own", at, strcmp(base, row->variant.name) == 0 ? "1" : "0"); /* the folder's name is the variant's */
        set_text(t, "@files", at, files);
        g_free(base);
        g_free(parent);
        g_free(files);
    }
    if (row->picture)
        set_text(t, "@picture", at, strrchr(row->picture, '/') ? strrchr(row->picture, '/') + 1 : row->picture);
    set_values(t, s, at, &row->variant);
    set_counts(t, s, at, row->json);
}

/* ---- as text ---- */

static void put_column(const Table *t, const Column *c, GString *text)
{
    gpointer *value = c->different->pdata;
    uint64_t used = 0, equal = 0;
    for (uint64_t i = 0; i < t->n; i++) {
        equal += c->at[i] == c->at[0];
        used = MAX(used, c->at[i] + 1u);
    }
    page_string(text, c->name);
    if (equal == t->n) {
        g_string_append_printf(text, ":{\"c\":%s}", (char *)value[c->at[0]]);
    } else if (used <= t->n / 3) {
        g_string_append(text, ":{\"d\":[");
        for (uint64_t i = 0; i < used; i++)
            g_string_append_printf(text, "%s%s", i ? "," : "", (char *)value[i]);
        g_string_append(text, "],\"i\":[");
        for (uint64_t i = 0; i < t->n; i++)
            g_string_append_printf(text, "%s%u", i ? "," : "", c->at[i]);
        g_string_append(text, "]}");
    } else {
        g_string_append(text, ":[");
        for (uint64_t i = 0; i < t->n; i++)
            g_string_append_printf(text, "%s%s", i ? "," : "", (char *)value[c->at[i]]);
        g_string_append(text, "]");
    }
}

void page_rows(const Sweep *s, const char *out, uint64_t first, uint64_t n, GString *text)
{
    Table t = {.n = n, .column = g_ptr_array_new_with_free_func(column_free), .by_name = g_hash_table_new(g_str_hash, g_str_equal)};
    for (uint64_t i = 0; i < n; i++) {
        Row row;
        row_read(s, out, first + i, &row);
        set_row(&t, s, out, i, &row);
        row_clear(&row);
    }
    g_string_append_printf(text, "venationRows(%" G_GUINT64_FORMAT ",%" G_GUINT64_FORMAT ",{\n", first, n);
    for (guint i = 0; i < t.column->len; i++) {
        g_string_append(text, i ? ",\n" : "");
        put_column(&t, t.column->pdata[i], text);
    }
    g_string_append(text, "\n});\n");
    g_hash_table_destroy(t.by_name);
    g_ptr_array_free(t.column, TRUE);
}
