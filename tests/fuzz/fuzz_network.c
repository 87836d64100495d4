/* Fuzzes the reader of networks: whatever the bytes, it returns a sound network that writes and reads back alike, or an error with a
 * message that is valid UTF-8.
 *
 *     clang -fsanitize=fuzzer,address,undefined -DFUZZ …    libFuzzer
 *     fuzz_network [-n MUTATIONS] FILE …                    each as it is, then that many mutations of it */
#include <glib.h>
#include <glib/gstdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "export/export.h"
#include "import/import.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static Network *read_network(const char *text, gsize length)
{
    WidthDef widths = width_def_default();
    GError *error = NULL;
    Network *net = import_graphml_text(text, length, "fuzz.graphml", &widths, &error);
    if ((net == NULL) != (error != NULL))
        abort();
    if (error && (error->domain != IMPORT_ERROR || !g_utf8_validate(error->message, -1, NULL)))
        abort();
    g_clear_error(&error);
    return net;
}

static void require(bool condition)
{
    if (!condition)
        abort();
}

/* What the rest of the library relies on. */
static void check(const Network *net)
{
    bool *grown = g_new0(bool, net->n_nodes), *used = g_new0(bool, net->n_veins);
    for (uint32_t v = 0; v < net->n_nodes; v++)
        require(isfinite(net->node[v].x) && isfinite(net->node[v].y) && net->node_birth[v] <= net->n_steps);
    for (uint32_t e = 0; e < net->n_edges; e++) {
        require(net->tail[e] < net->head[e] && net->head[e] < net->n_nodes);
        require(net->kind[e] == EDGE_ANASTOMOSIS || (net->kind[e] == EDGE_VEIN && !grown[net->head[e]]));
        require(net->birth[e] <= net->n_steps && net->order[e] > 0 && net->rank[e] > 0 && net->vein[e] < net->n_veins);
        require(net->width[e] > 0.0 && net->flow[e] > 0.0 && isfinite(net->width[e]) && isfinite(net->flow[e]));
        require(vec_dist2(net->node[net->tail[e]], net->node[net->head[e]]) > 0.0);
        grown[net->head[e]] |= net->kind[e] == EDGE_VEIN;
        used[net->vein[e]] = true;
    }
    for (uint32_t k = 0; k < net->n_veins; k++)
        require(used[k]);
    uint32_t i, j;
    require(!net->margin || (net->margin->n >= 3 && !polygon_crossing(net->margin, &i, &j)));
    g_free(grown);
    g_free(used);
}

static char *write_network(const Network *net)
{
    char *path = g_strdup_printf("%s/fuzz-network-%d.graphml", g_get_tmp_dir(), (int)getpid()), *text = NULL;
    require(export_graphml(net, path, NULL) && g_file_get_contents(path, &text, NULL, NULL));
    g_unlink(path);
    g_free(path);
    return text;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    Network *net = read_network((const char *)data, size);
    if (!net)
        return 0;
    check(net);
    char *once = write_network(net);
    Network *back = read_network(once, strlen(once));
    require(back != NULL || net->margin != NULL); /* a margin may come to meet itself when it is rounded */
    if (back) {
        check(back);
        char *twice = write_network(back);
        require(strcmp(once, twice) == 0);
        g_free(twice);
    }
    network_free(back);
    g_free(once);
    network_free(net);
    return 0;
}

#ifndef FUZZ

#include <stdio.h>

#include "geom/random.h"

/* Overwrites, deletes, doubles or inserts something at a random place, up to eight times. */
static void mutate(GByteArray *bytes, uint64_t index)
{
    static const char *const pieces[] = {"<",         ">",           "\"",     "&amp;",       "&",       "]]>",   "<!--",      "-->",
                                         "<data key=\"x\">", "</data>", "</node>", "</edge>", "<node id=\"1\">", "-", "0", "1",
                                         "nan",       "1e999",       "0.0000001", "\xff",     "4294967295", ",",   " ",         "\n",
                                         "vein",      "anastomosis", "undirected", "<graph>", "<default>0</default>", "key", "x", "y"};
    uint32_t times = 1 + random_block(1, 0, 0, index).w[0] % 8;
    for (uint32_t i = 1; i <= times; i++) {
        RandomBlock r = random_block(1, 0, i, index);
        guint at = bytes->len ? r.w[0] % bytes->len : 0, rest = bytes->len - at, run = rest ? 1 + r.w[1] % MIN(rest, 200) : 0;
        if (r.w[2] % 4 == 0 && rest) { /* mostly a digit for a digit, which leaves a file that can be read */
            bool digit = g_ascii_isdigit(bytes->data[at]);
            bytes->data[at] = digit ? (guint8)('0' + r.w[3] % 10) : (guint8)r.w[3];
        } else if (r.w[2] % 4 == 1 && run) {
            g_byte_array_remove_range(bytes, at, run);
        } else if (r.w[2] % 4 == 2 && run) {
            guint8 copy[200];
            guint to = r.w[3] % bytes->len;
            memcpy(copy, bytes->data + at, run);
            g_byte_array_set_size(bytes, bytes->len + run);
            memmove(bytes->data + to + run, bytes->data + to, bytes->len - run - to);
            memcpy(bytes->data + to, copy, run);
        } else {
            const char *piece = pieces[r.w[3] % G_N_ELEMENTS(pieces)];
            guint length = (guint)strlen(piece);
            g_byte_array_set_size(bytes, bytes->len + length);
            memmove(bytes->data + at + length, bytes->data + at, rest);
            memcpy(bytes->data + at, piece, length);
        }
    }
}

/* Drops, doubles and swaps whole lines, and changes digits: what comes out is mostly well-formed. */
static void mutate_lines(GByteArray *bytes, uint64_t index)
{
    char *text = bytes->len ? g_strndup((const char *)bytes->data, bytes->len) : g_strdup(""), **line = g_strsplit(text, "\n", -1);
    guint n = g_strv_length(line);
    uint32_t times = n ? random_block(2, 0, 0, index).w[0] % 4 : 0;
    for (uint32_t i = 1; i <= times; i++) {
        RandomBlock r = random_block(2, 0, i, index);
        guint a = r.w[0] % n, b = r.w[1] % n;
        if (r.w[2] % 3 == 2) {
            char *swap = line[a];
            line[a] = line[b];
            line[b] = swap;
        } else {
            char *other = g_strdup(r.w[2] % 3 == 0 ? "" : line[b]);
            g_free(line[a]);
            line[a] = other;
        }
    }
    g_free(text);
    text = g_strjoinv("\n", line);
    g_strfreev(line);
    for (uint32_t i = 0; i < random_block(2, 1, 0, index).w[0] % 6 && *text; i++) {
        RandomBlock r = random_block(2, 1, i, index);
        char *at = text + r.w[0] % strlen(text), *digit = strpbrk(at, "0123456789");
        if (digit)
            *digit = (char)('0' + r.w[1] % 10);
    }
    g_byte_array_set_size(bytes, 0);
    g_byte_array_append(bytes, (const guint8 *)text, (guint)strlen(text));
    g_free(text);
}

static void feed(const char *data, gsize size, uint64_t mutations)
{
    LLVMFuzzerTestOneInput((const uint8_t *)data, size);
    for (uint64_t i = 0; i < mutations; i++) {
        GByteArray *bytes = g_byte_array_new();
        g_byte_array_append(bytes, (const guint8 *)data, (guint)size);
        if (i % 2)
            mutate_lines(bytes, i);
        else
            mutate(bytes, i);
        LLVMFuzzerTestOneInput(bytes->data ? bytes->data : (const uint8_t *)"", bytes->len);
        g_byte_array_unref(bytes);
    }
}

int main(int argc, char **argv)
{
    uint64_t mutations = 2000;
    int first = 1;
    if (argc > 2 && strcmp(argv[1], "-n") == 0) {
        mutations = g_ascii_strtoull(argv[2], NULL, 10);
        first = 3;
    }
    feed("", 0, 10);
    for (int i = first; i < argc; i++) {
        char *data;
        gsize size;
        GError *error = NULL;
        if (!g_file_get_contents(argv[i], &data, &size, &error)) {
            fprintf(stderr, "%s\n", error->message);
            return 1;
        }
        feed(data, size, mutations);
        g_free(data);
    }
    return 0;
}

#endif
