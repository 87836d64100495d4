/* Rows, written and read. */
#include "batch/rows.h"

#include <json-glib/json-glib.h>
#include <string.h>

#include "batch/private.h"
#include "export/export.h"

char *row_folder(const Sweep *s, const SweepVariant *v)
{
    uint64_t count = sweep_count(s);
    int digits = 3;
    for (uint64_t n = (count - 1) / FOLDER_LEAVES; n >= 1000; n /= 10)
        digits++;
    return count <= MOST_IN_ONE ? g_strdup_printf("leaves/%s", v->name)
                                : g_strdup_printf("leaves/%0*" G_GUINT64_FORMAT "/%s", digits, v->index / FOLDER_LEAVES, v->name);
}

char *row_failed(const SweepVariant *v) { return g_strdup_printf("failed/%s.json", v->name); }

/* ---- writing ---- */

static void begin_member(GString *s, const char *name)
{
    g_string_append(s, s->len > 1 ? ", " : "");
    export_json_string(s, name);
    g_string_append(s, ": ");
}

static void add_text(GString *s, const char *name, const char *text)
{
    begin_member(s, name);
    if (text)
        export_json_string(s, text);
    else
        g_string_append(s, "null");
}

static void add_count(GString *s, const char *name, uint64_t n)
{
    begin_member(s, name);
    g_string_append_printf(s, "%" G_GUINT64_FORMAT, n);
}

static void add_number(GString *s, const char *name, double value)
{
    begin_member(s, name);
    export_number(s, value);
}

/* Numbers as numbers; but not seeds that a double can't hold, which many a JSON reader would change. */
static bool is_number(const SweepKey *key, const char *text)
{
    enum { EXACT_DIGITS = 15 };
    if (key->id < 0)
        return strlen(text) <= EXACT_DIGITS;
    ParamType type = param_info((ParamId)key->id)->type;
    return type == TYPE_NUMBER || type == TYPE_INTEGER;
}

static void add_values(GString *row, const Sweep *s, const SweepVariant *v)
{
    bool seeded = false;
    for (uint32_t k = 0; k < sweep_keys(s); k++) {
        SweepKey key = sweep_key(s, k);
        seeded |= key.id < 0;
        if (v->value[k] && is_number(&key, v->value[k])) {
            begin_member(row, key.key);
            g_string_append(row, v->value[k]);
        } else {
            add_text(row, key.key, v->value[k]);
        }
    }
    if (!seeded)
        add_count(row, "seed", v->seed);
}

static GString *begin_row(const Sweep *s, const SweepVariant *v, const char *outcome, const char *error, const char *folder)
{
    GString *row = g_string_new("{");
    add_count(row, "index", v->index);
    add_text(row, "variant", v->name);
    add_text(row, "outcome", outcome);
    add_text(row, "error", error);
    add_text(row, "folder", folder);
    add_values(row, s, v);
    return row;
}

static char *end_row(GString *row)
{
    g_string_append_c(row, '}');
    return g_string_free(row, FALSE);
}

const char *const *row_counts(void)
{
    static const char *const name[] = {"nodes",     "edges",       "anastomoses",  "areoles", "veins",        "steps", "sources_reached", "sources_given_up", "end",
                                       "leaf_length", "blade_area", "vein_length", "vein_density", "widest_vein", "network_hash", "files", "bytes", "sha256", "key", NULL};
    return name;
}

/* Loops of the net: edges less those of a spanning forest. */
static uint32_t count_loops(const Network *net)
{
    uint32_t *up = g_new(uint32_t, net->n_nodes), loops = 0;
    for (uint32_t i = 0; i < net->n_nodes; i++)
        up[i] = i;
    for (uint32_t e = 0; e < net->n_edges; e++) {
        uint32_t a = net->tail[e], b = net->head[e];
        while (up[a] != a)
            a = up[a] = up[up[a]];
        while (up[b] != b)
            b = up[b] = up[up[b]];
        loops += a == b;
        up[MAX(a, b)] = MIN(a, b);
    }
    g_free(up);
    return loops;
}

static void add_counts(GString *row, const VenLeaf *leaf)
{
    const Network *net = leaf->net;
    double length = 0.0, widest = 0.0;
    for (uint32_t e = 0; e < net->n_edges; e++) {
        length += vec_dist(net->node[net->tail[e]], net->node[net->head[e]]);
        widest = MAX(widest, net->width[e]);
    }
    add_count(row, "nodes", net->n_nodes);
    add_count(row, "edges", net->n_edges);
    add_count(row, "anastomoses", leaf->counts.joins);
    add_count(row, "areoles", count_loops(net));
    add_count(row, "veins", net->n_veins);
    add_count(row, "steps", leaf->counts.step);
    add_count(row, "sources_reached", leaf->counts.reached);
    add_count(row, "sources_given_up", leaf->counts.given_up);
    add_text(row, "end", end_reason_text(leaf->counts.end));
    add_number(row, "leaf_length", leaf->length);
    add_number(row, "blade_area", net->margin->area);
    add_number(row, "vein_length", length);
    add_number(row, "vein_density", length / net->margin->area);
    add_number(row, "widest_vein", widest);
}

char *row_grown(const Sweep *s, const SweepVariant *v, const char *key, const VenLeaf *leaf, const FolderSum *sum)
{
    char *folder = row_folder(s, v), *hash = g_strdup_printf("%016" G_GINT64_MODIFIER "x", (guint64)leaf_hash(leaf->net));
    GString *row = begin_row(s, v, "grown", NULL, folder);
    add_counts(row, leaf);
    add_text(row, "network_hash", hash);
    add_count(row, "files", sum->files);
    add_count(row, "bytes", sum->bytes);
    add_text(row, "sha256", sum->sha256);
    add_text(row, "key", key);
    g_free(hash);
    g_free(folder);
    return end_row(row);
}

char *row_failure(const Sweep *s, const SweepVariant *v, const char *key, const GError *error)
{
    GString *row = begin_row(s, v, "failed", error->message, NULL);
    add_text(row, "key", key);
    return end_row(row);
}

char *row_missing(const Sweep *s, const SweepVariant *v) { return end_row(begin_row(s, v, "missing", NULL, NULL)); }

/* ---- reading ---- */

static char *read_text(const char *out, const char *relative)
{
    char *path = g_build_filename(out, relative, NULL), *text = NULL;
    if (!g_file_get_contents(path, &text, NULL, NULL))
        text = NULL;
    g_free(path);
    return text ? g_strchomp(text) : NULL;
}

/* The text of a member; NULL if there is no such text. Free it. */
static char *member(const char *json, const char *name)
{
    char *text = NULL;
    JsonNode *root = json_from_string(json, NULL);
    if (root && JSON_NODE_HOLDS_OBJECT(root)) {
        JsonNode *node = json_object_get_member(json_node_get_object(root), name);
        if (node && JSON_NODE_HOLDS_VALUE(node) && json_node_get_value_type(node) == G_TYPE_STRING)
            text = json_node_dup_string(node);
    }
    if (root)
        json_node_unref(root);
    return text;
}

/* Takes a row that is one of this variant. */
static bool take(Row *row, char *json, RowOutcome outcome)
{
    static const char *const word[] = {"grown", "failed"};
    char *name = json ? member(json, "variant") : NULL, *said = json ? member(json, "outcome") : NULL;
    char *begin = g_strdup_printf("{\"index\": %" G_GUINT64_FORMAT ",", row->index);
    bool good = name && said && strcmp(name, row->variant.name) == 0 && strcmp(said, word[outcome]) == 0 && g_str_has_prefix(json, begin);
    if (good) {
        row->outcome = outcome;
        row->json = json;
    } else {
        g_free(json);
    }
    g_free(begin);
    g_free(name);
    g_free(said);
    return good;
}

void row_read(const Sweep *s, const char *out, uint64_t index, Row *row)
{
    *row = (Row){.index = index, .outcome = ROW_MISSING};
    sweep_variant(s, index, &row->variant);
    row->folder = row_folder(s, &row->variant);
    char *grown = g_strconcat(row->folder, "/sweep.json", NULL), *picture = g_strconcat(row->folder, "/sweep.png", NULL),
         *failed = row_failed(&row->variant);
    if (take(row, read_text(out, grown), ROW_GROWN)) {
        char *path = g_build_filename(out, picture, NULL);
        if (g_file_test(path, G_FILE_TEST_IS_REGULAR))
            row->picture = g_steal_pointer(&picture);
        g_free(path);
    } else if (take(row, read_text(out, failed), ROW_FAILED)) {
        row->error = member(row->json, "error");
    } else {
        row->json = row_missing(s, &row->variant);
    }
    g_free(grown);
    g_free(picture);
    g_free(failed);
}

bool row_is_whole(const char *out, const Row *row, bool contents)
{
    FolderSum sum;
    char *folder = g_build_filename(out, row->folder, NULL), *wanted = member(row->json, "sha256");
    bool whole = contents ? batch_sum_folder(folder, &sum, NULL) && wanted && strcmp(wanted, sum.sha256) == 0 : batch_measure_folder(folder, &sum);
    char *files = g_strdup_printf("\"files\": %u, \"bytes\": %" G_GUINT64_FORMAT ", ", sum.files, sum.bytes);
    whole = whole && strstr(row->json, files);
    g_free(files);
    g_free(folder);
    g_free(wanted);
    return whole;
}

char *row_key(const Row *row) { return member(row->json, "key"); }

void row_clear(Row *row)
{
    sweep_variant_clear(&row->variant);
    g_free(row->folder);
    g_free(row->picture);
    g_free(row->error);
    g_free(row->json);
    *row = (Row){0};
}
