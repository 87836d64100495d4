/* Networks read back: our own files to the byte, drawn ones against plain searches, bad ones by their messages. */
#include <glib.h>
#include <glib/gstdio.h>
#include <locale.h>
#include <string.h>

#include "export/export.h"
#include "geom/outline.h"
#include "geom/random.h"
#include "import/import.h"
#include "sim/simulation.h"

enum { NONE = UINT32_MAX };

static char *folder;

/* ---- texts and networks ---- */

static const WidthDef widths = {.exponent = 2.0, .minimum = 0.5, .rank_ratio = 0.6};

#define KEYS                                                                                                                               \
    "<graphml><key id='x' for='node' attr.name='x'/><key id='y' for='node' attr.name='y'/><key id='t' for='node' attr.name='birth'/>"     \
    "<key id='k' for='edge' attr.name='kind'/><key id='o' for='edge' attr.name='order'/><key id='r' for='edge' attr.name='rank'/>"        \
    "<key id='v' for='edge' attr.name='vein'/><key id='w' for='edge' attr.name='width'/><key id='f' for='edge' attr.name='flow'/>"        \
    "<key id='b' for='edge' attr.name='birth'/><key id='m' for='graph' attr.name='margin'/><key id='s' for='graph' attr.name='steps'/>"     \
    "<key id='base' for='graph' attr.name='base'/><key id='tip' for='graph' attr.name='tip'/>"
#define DIRECTED KEYS "<graph edgedefault='directed'>"
#define UNDIRECTED KEYS "<graph edgedefault='undirected'>"
#define END "</graph></graphml>"
#define NODE(id, x, y) "<node id='" id "'><data key='x'>" x "</data><data key='y'>" y "</data></node>"
#define EDGE(a, b) "<edge source='" a "' target='" b "'/>"
#define EDGE_OF(a, b, data) "<edge source='" a "' target='" b "'>" data "</edge>"
#define DATA(key, value) "<data key='" key "'>" value "</data>"

static Network *read_text(const char *text)
{
    GError *error = NULL;
    Network *net = import_graphml_text(text, strlen(text), "leaf.graphml", &widths, &error);
    g_assert_no_error(error);
    g_assert_nonnull(net);
    return net;
}

static char *in_folder(const char *name) { return g_build_filename(folder, name, NULL); }

/* The network as export_graphml writes it. */
static char *written(const Network *net)
{
    char *path = in_folder("written.graphml"), *text = NULL;
    GError *error = NULL;
    export_graphml(net, path, &error);
    g_assert_no_error(error);
    g_file_get_contents(path, &text, NULL, &error);
    g_assert_no_error(error);
    g_unlink(path);
    g_free(path);
    return text;
}

#define ASSERT_ARRAY(a, b, n) g_assert_cmpmem(a, (int)((n) * sizeof *(a)), b, (int)((n) * sizeof *(b)))

static void assert_near(const double *a, const double *b, gsize n, double most)
{
    for (gsize i = 0; i < n; i++)
        g_assert_cmpfloat(fabs(a[i] - b[i]), <=, most + 1e-15 * fabs(a[i]));
}

/* Equal but for what a file rounds. */
static void assert_equal(const Network *a, const Network *b)
{
    const double half = 0.5000001e-6;
    g_assert_cmpuint(a->n_nodes, ==, b->n_nodes);
    g_assert_cmpuint(a->n_edges, ==, b->n_edges);
    g_assert_cmpuint(a->n_veins, ==, b->n_veins);
    g_assert_cmpuint(a->n_steps, ==, b->n_steps);
    assert_near(&a->node[0].x, &b->node[0].x, 2 * (gsize)a->n_nodes, half);
    ASSERT_ARRAY(a->node_birth, b->node_birth, a->n_nodes);
    ASSERT_ARRAY(a->tail, b->tail, a->n_edges);
    ASSERT_ARRAY(a->head, b->head, a->n_edges);
    ASSERT_ARRAY(a->birth, b->birth, a->n_edges);
    ASSERT_ARRAY(a->kind, b->kind, a->n_edges);
    ASSERT_ARRAY(a->order, b->order, a->n_edges);
    ASSERT_ARRAY(a->rank, b->rank, a->n_edges);
    ASSERT_ARRAY(a->vein, b->vein, a->n_edges);
    assert_near(a->width, b->width, a->n_edges, half);
    assert_near(a->flow, b->flow, a->n_edges, half);
    g_assert_cmpfloat(fabs(a->length - b->length), <=, half);
    g_assert_cmpint(a->margin != NULL, ==, b->margin != NULL);
    if (a->margin != NULL) {
        g_assert_cmpuint(a->margin->n, ==, b->margin->n);
        assert_near(&a->margin->v[0].x, &b->margin->v[0].x, 2 * (gsize)a->margin->n, half);
    }
}

/* What every network must be, whatever was read. */
static void assert_sound(const Network *net)
{
    uint32_t *parent = g_new(uint32_t, net->n_nodes);
    bool *used = g_new0(bool, net->n_veins);
    for (uint32_t v = 0; v < net->n_nodes; v++) {
        parent[v] = NONE;
        g_assert_cmpuint(net->node_birth[v], <=, net->n_steps);
    }
    for (uint32_t e = 0; e < net->n_edges; e++) {
        g_assert_cmpuint(net->tail[e], <, net->head[e]);
        g_assert_cmpuint(net->head[e], <, net->n_nodes);
        g_assert_cmpuint(net->kind[e], <=, EDGE_ANASTOMOSIS);
        g_assert_cmpuint(net->birth[e], <=, net->n_steps);
        g_assert_cmpuint(net->order[e], >=, 1);
        g_assert_cmpuint(net->rank[e], >=, 1);
        g_assert_cmpfloat(net->width[e], >, 0.0);
        g_assert_cmpfloat(net->flow[e], >, 0.0);
        g_assert_cmpuint(net->vein[e], <, net->n_veins);
        used[net->vein[e]] = true;
        if (net->kind[e] == EDGE_VEIN) {
            g_assert_cmpuint(parent[net->head[e]], ==, NONE);
            parent[net->head[e]] = net->tail[e];
        }
    }
    for (uint32_t k = 0; k < net->n_veins; k++)
        g_assert_true(used[k]);
    g_free(parent);
    g_free(used);
}

static Network *grown_in(const char *path, Pattern pattern, uint64_t seed)
{
    OutlineDef def = outline_def_default();
    if (path != NULL)
        def = (OutlineDef){.path = path, .where = "test", .has_base = true, .has_tip = true, .base = vec2(0, 0), .tip = vec2(0, 10), .flatness = 1e-3};
    Polygon *leaf = outline_new(&def, NULL);
    SimulationDef d = simulation_def_default();
    d.leaf = leaf;
    d.growth.kind = GROWTH_ISOGONIC;
    d.growth.initial_length = 12;
    d.growth.final_length = 60;
    d.growth.step = 0.7;
    d.density = 0.02;
    d.birth_distance_sources = d.birth_distance_veins = 3;
    d.pattern = pattern;
    d.seed = seed;
    d.threads = 1;
    Simulation *s = simulation_new(&d, NULL);
    while (simulation_step(s))
        ;
    Network *net = simulation_network(s);
    network_assign_widths(net, &widths);
    net->length = simulation_blade(s)->length;
    simulation_free(s);
    polygon_free(leaf);
    return net;
}

static Network *grown(Pattern pattern, uint64_t seed) { return grown_in(NULL, pattern, seed); }

/* Numbers for an index; streams 100 … are this test's. */
static uint32_t number(uint32_t stream, uint32_t step, uint32_t index, uint32_t below)
{
    return random_block(5, 100 + stream, step, index).w[0] % below;
}

static Vec2 place(uint32_t stream, uint32_t step, uint32_t index)
{
    double u[2];
    random_pair(5, 100 + stream, step, index, u);
    return vec2(200.0 * u[0] - 100.0, 200.0 * u[1]);
}

/* Any forest with anastomoses, some of them doubled, and values of all sizes. */
static Network *random_network(uint32_t step)
{
    uint32_t n = 2 + number(0, step, 0, 60), m = 0;
    Network *net = network_new(n, 2 * n);
    for (uint32_t v = 0; v < n; v++) {
        net->node[v] = place(1, step, v);
        if (number(2, step, v, 3) == 0) /* on and beside halves of a millionth */
            net->node[v].x = nextafter(((double)number(3, step, v, 2000000000) + 0.5) * 1e-6, number(4, step, v, 2) ? 1e9 : -1e9);
        net->node_birth[v] = v;
        if (v > 0 && (v == 1 || number(5, step, v, 9) > 0)) {
            net->tail[m] = number(6, step, v, v);
            net->head[m++] = v;
        }
    }
    uint32_t tree = m;
    for (uint32_t v = 1; v < n && m < 2 * n - 1; v++)
        if (number(7, step, v, 4) == 0) {
            net->tail[m] = number(8, step, v, v);
            net->head[m] = v;
            bool vein = false;
            for (uint32_t e = 0; e < tree; e++)
                vein |= net->tail[e] == net->tail[m] && net->head[e] == v;
            net->kind[m] = EDGE_ANASTOMOSIS;
            m += vein ? 0 : 1 + (v % 5 == 0);
            if (!vein && v % 5 == 0) { /* joined twice */
                net->tail[m - 1] = net->tail[m - 2];
                net->head[m - 1] = v;
                net->kind[m - 1] = EDGE_ANASTOMOSIS;
            }
        }
    net->n_edges = net->n_veins = m;
    net->n_steps = n + number(9, step, 0, 3);
    for (uint32_t e = 0; e < m; e++) {
        double u[2];
        random_pair(5, 110, step, e, u);
        net->birth[e] = net->head[e];
        net->order[e] = (uint8_t)(1 + number(11, step, e, 255));
        net->rank[e] = (uint8_t)(1 + number(12, step, e, 255));
        net->vein[e] = m - 1 - e;
        net->width[e] = e % 3 == 0 ? 1e-8 + 1e-5 * u[0] : e % 3 == 1 ? 0.0099 + 0.0002 * u[0] : 1e6 * u[0] + 0.01;
        net->flow[e] = e % 2 == 0 ? 1e-7 + 0.02 * u[1] : 1.0 / (u[1] + 1e-15);
    }
    if (step % 3 != 0) {
        Vec2 margin[] = {vec2(place(13, step, 0).x, -7.7), vec2(5000, -5), vec2(1.0 / 3, 9000), vec2(-5000, 1e-7)}; /* around all */
        net->margin = polygon_new(margin, 4);
        net->length = place(14, step, 0).y + 100.0;
    }
    return net;
}

/* ---- our own files ---- */

static void check_round_trip(Network *net)
{
    char *first = written(net);
    Network *back = read_text(first);
    assert_equal(net, back);
    assert_sound(back);
    char *second = written(back);
    g_assert_cmpstr(first, ==, second);
    g_free(first);
    g_free(second);
    network_free(back);
    network_free(net);
}

/* Blades that are higher than the tip, or go below the base. */
static const char fan[] = "M 0,0 L 8,9 L 5,13 L 1,12 L 0,10 L -1,12 L -5,13 L -8,9 Z";
static const char kidney[] = "M 0,0 L 5,-4 L 10,3 L 7,11 L 0,10 L -7,11 L -10,3 L -5,-4 Z";
static const char peltate[] = "M 0,-6 L 7,-3 L 8,4 L 0,10 L -8,4 L -7,-3 Z";

static void test_grown(void)
{
    for (uint64_t seed = 1; seed <= 4; seed++)
        check_round_trip(grown(seed % 2 ? PATTERN_CLOSED : PATTERN_OPEN, seed));
    check_round_trip(grown_in(fan, PATTERN_OPEN, 5));
    check_round_trip(grown_in(kidney, PATTERN_CLOSED, 6));
    check_round_trip(grown_in(peltate, PATTERN_CLOSED, 7));
}

static void test_random(void)
{
    for (uint32_t step = 0; step < 600; step++) {
        Network *net = random_network(step);
        bool close = false; /* nodes that a file could not tell apart are another test's */
        for (uint32_t e = 0; e < net->n_edges; e++)
            close |= vec_dist2(net->node[net->tail[e]], net->node[net->head[e]]) < 1e-9;
        if (close)
            network_free(net);
        else
            check_round_trip(net);
    }
}

/* Pieces of the file end anywhere: the same text behind comments of all lengths, and more than one piece of it. */
static void test_pieces(void)
{
    enum { PIECE = 1 << 16 };
    Network *net = grown(PATTERN_CLOSED, 9);
    char *text = written(net), *path = in_folder("pieces.graphml"), *root = strstr(text, "<graphml");
    for (guint pad = 0; pad < 400; pad++) {
        GString *s = g_string_new_len(text, root - text);
        g_string_append(s, "<!--");
        guint fill = pad < 200 ? pad : PIECE - 400 + pad; /* the first piece ends in data, or in the head of the file */
        for (guint i = 0; i < fill; i++)
            g_string_append(s, (i + pad) % 7 == 0 ? "ä" : "a");
        g_string_append(s, "-->");
        g_string_append(s, root);
        g_assert_cmpuint(s->len, >, PIECE);
        GError *error = NULL;
        g_file_set_contents(path, s->str, (gssize)s->len, &error);
        g_assert_no_error(error);
        Network *back = import_graphml(path, &widths, &error);
        g_assert_no_error(error);
        assert_equal(net, back);
        network_free(back);
        g_string_free(s, TRUE);
    }
    g_unlink(path);
    g_free(path);
    g_free(text);
    network_free(net);
}

/* Lines are counted over pieces, wherever those end. */
static void test_lines(void)
{
    char *path = in_folder("lines.graphml");
    for (guint blank = 1; blank < 60; blank++) {
        GString *s = g_string_new(UNDIRECTED);
        guint lines = 1;
        while (s->len < 400000) {
            for (guint i = 0; i < blank; i++, lines++)
                g_string_append_c(s, '\n');
            g_string_append(s, "<desc/>");
        }
        g_string_append(s, "<node/>");
        g_file_set_contents(path, s->str, (gssize)s->len, NULL);
        GError *error = NULL;
        g_assert_null(import_graphml(path, &widths, &error));
        char *message = g_strdup_printf("%s:%u: a <node> without id", path, lines);
        g_assert_cmpstr(error->message, ==, message);
        g_free(message);
        g_error_free(error);
        g_string_free(s, TRUE);
    }
    g_unlink(path);
    g_free(path);
}

/* A locale with a comma for the point changes nothing. */
static void test_locale(void)
{
    if (setlocale(LC_ALL, "de_DE.UTF-8") == NULL)
        setlocale(LC_ALL, "");
    check_round_trip(grown(PATTERN_CLOSED, 3));
    setlocale(LC_ALL, "C");
}

/* Through NetworkX, which renames keys, writes 3 as 3.0 and sorts edges by their sources. */
static void test_networkx(void)
{
    Network *net = grown(PATTERN_CLOSED, 5);
    char *from = in_folder("from.graphml"), *to = in_folder("to.graphml");
    g_assert_true(export_graphml(net, from, NULL));
    const char *program = "import sys\n"
                          "try:\n    import networkx\nexcept ImportError:\n    sys.exit(77)\n"
                          "networkx.write_graphml(networkx.read_graphml(sys.argv[1]), sys.argv[2])";
    const char *argv[] = {"/usr/bin/python3", "-c", program, from, to, NULL};
    int status = 0;
    if (!g_spawn_sync(NULL, (char **)argv, NULL, 0, NULL, NULL, NULL, NULL, &status, NULL) || status == 77 << 8) {
        g_assert_cmpstr(g_getenv("VENATION_REQUIRE"), !=, "all");
        g_test_skip("no NetworkX");
    } else {
        g_assert_cmpint(status, ==, 0);
        GError *error = NULL;
        Network *back = import_graphml(to, &widths, &error);
        g_assert_no_error(error);
        g_assert_cmpuint(back->n_edges, ==, net->n_edges);
        uint32_t *seen = g_new0(uint32_t, net->n_edges);
        for (uint32_t k = 0; k < net->n_edges; k++) { /* edges in their first order */
            uint32_t e = 0;
            while (back->tail[e] != net->tail[k] || back->head[e] != net->head[k])
                e++;
            g_assert_cmpuint(seen[e]++, ==, 0);
            g_assert_cmpuint(back->kind[e], ==, net->kind[k]);
            g_assert_cmpuint(back->order[e], ==, net->order[k]);
            g_assert_cmpuint(back->rank[e], ==, net->rank[k]);
            g_assert_cmpuint(back->vein[e], ==, net->vein[k]);
            g_assert_cmpuint(back->birth[e], ==, net->birth[k]);
            g_assert_cmpfloat(fabs(back->width[e] - net->width[k]), <=, 0.500001e-6);
        }
        g_assert_cmpuint(back->n_steps, ==, net->n_steps);
        g_assert_cmpuint(back->margin->n, ==, net->margin->n);
        g_free(seen);
        network_free(back);
        g_unlink(to);
    }
    g_unlink(from);
    g_free(from);
    g_free(to);
    network_free(net);
}

/* ---- drawn by hand ---- */

/* A midvein with a loop at its end and a second vein beside it, every edge drawn the wrong way round or in the wrong place. */
static void test_drawn(void)
{
    Network *net = read_text(UNDIRECTED NODE("tip", "0", "30") EDGE("side", "stalk") NODE("side", "10", "12") EDGE("tip", "stalk")
                                 EDGE("stalk", "base") EDGE("tip", "side") NODE("stalk", "0", "10") NODE("base", "0", "0.5")
                                     NODE("other tip", "3", "9") EDGE("other tip", "other base") NODE("other base", "3", "1") END);
    assert_sound(net);
    static const Vec2 node[] = {{0, 0.5}, {3, 1}, {0, 10}, {3, 9}, {0, 30}, {10, 12}}; /* by depth, then as in the file */
    static const uint32_t tail[] = {0, 1, 2, 2, 4}, head[] = {2, 3, 4, 5, 5}, birth[] = {0, 0, 1, 1, 2, 2};
    static const uint32_t edge_birth[] = {1, 1, 2, 2, 2};
    static const uint8_t kind[] = {EDGE_VEIN, EDGE_VEIN, EDGE_VEIN, EDGE_VEIN, EDGE_ANASTOMOSIS};
    g_assert_cmpuint(net->n_nodes, ==, 6);
    g_assert_cmpuint(net->n_edges, ==, 5);
    ASSERT_ARRAY(net->node, node, 6);
    ASSERT_ARRAY(net->tail, tail, 5);
    ASSERT_ARRAY(net->head, head, 5);
    ASSERT_ARRAY(net->node_birth, birth, 6);
    ASSERT_ARRAY(net->birth, edge_birth, 5);
    ASSERT_ARRAY(net->kind, kind, 5);
    g_assert_cmpuint(net->n_steps, ==, 2);
    g_assert_null(net->margin);
    Network *twin = network_new(6, 5);
    memcpy(twin->node, node, sizeof node);
    memcpy(twin->tail, tail, sizeof tail);
    memcpy(twin->head, head, sizeof head);
    memcpy(twin->kind, kind, sizeof kind);
    network_assign_widths(twin, &widths);
    ASSERT_ARRAY(net->width, twin->width, 5);
    ASSERT_ARRAY(net->flow, twin->flow, 5);
    ASSERT_ARRAY(net->order, twin->order, 5);
    ASSERT_ARRAY(net->rank, twin->rank, 5);
    ASSERT_ARRAY(net->vein, twin->vein, 5);
    network_free(twin);
    network_free(net);
}

/* Of two ways of one length the first in the file, of two nodes equally near the base too; the widest edge before the shortest way. */
static void test_ties(void)
{
    static const char *const square = NODE("a", "-1", "1") NODE("b", "1", "1") NODE("c", "1", "3") NODE("d", "-1", "3");
    static const struct {
        const char *edges;
        double x, y; /* the middle of the edge that is left over */
    } cases[] = {
        {EDGE("d", "c") EDGE("c", "b") EDGE("b", "a") EDGE("d", "a"), 1, 2},
        {EDGE("a", "d") EDGE("b", "c") EDGE("d", "c") EDGE("a", "b"), 0, 3},
        {EDGE_OF("d", "c", DATA("w", "2")) EDGE_OF("c", "b", DATA("w", "3")) EDGE_OF("b", "a", DATA("w", "1"))
             EDGE_OF("d", "a", DATA("w", "2")),
         0, 1},
        /* widths on some edges only are none */
        {EDGE_OF("d", "c", DATA("w", "2")) EDGE_OF("c", "b", DATA("w", "3")) EDGE("b", "a") EDGE_OF("d", "a", DATA("w", "2")), 1, 2},
    };
    for (gsize i = 0; i < G_N_ELEMENTS(cases); i++) {
        char *text = g_strconcat(UNDIRECTED, square, cases[i].edges, END, NULL);
        Network *net = read_text(text);
        assert_sound(net);
        g_assert_cmpfloat(net->node[0].x, ==, -1.0); /* a, not b */
        g_assert_cmpuint(net->kind[0] + net->kind[1] + net->kind[2] + net->kind[3], ==, 1);
        uint32_t join = 0;
        while (net->kind[join] != EDGE_ANASTOMOSIS)
            join++;
        Vec2 p = net->node[net->tail[join]], q = net->node[net->head[join]];
        g_assert_cmpfloat((p.x + q.x) / 2, ==, cases[i].x);
        g_assert_cmpfloat((p.y + q.y) / 2, ==, cases[i].y);
        network_free(net);
        g_free(text);
    }
}

/* ---- searches against plain ones ---- */

enum { MOST_NODES = 24, MOST_EDGES = 60 };

/* A drawing: any graph, some kinds known. */
typedef struct {
    uint32_t n, m;
    Vec2 node[MOST_NODES];
    uint32_t end[MOST_EDGES][2];
    int kind[MOST_EDGES]; /* -1: not said */
    double width[MOST_EDGES]; /* 0: none said on any */
} Drawing;

static uint32_t part_of(const uint32_t *part, uint32_t v)
{
    while (part[v] != v)
        v = part[v];
    return v;
}

static Drawing random_drawing(uint32_t step)
{
    Drawing d = {.n = 2 + number(20, step, 0, MOST_NODES - 1)};
    uint32_t tries = 1 + number(21, step, 0, MOST_EDGES - 1), veins[MOST_NODES];
    bool wide = step % 2 == 0, kinds = step % 3 != 0;
    for (uint32_t v = 0; v < d.n; v++) {
        d.node[v] = place(22, step, v);
        veins[v] = v;
    }
    for (uint32_t t = 0; t < tries; t++) {
        uint32_t a = number(23, step, t, d.n), b = number(24, step, t, d.n);
        bool there = a == b;
        for (uint32_t e = 0; e < d.m; e++)
            there |= (d.end[e][0] == a && d.end[e][1] == b) || (d.end[e][0] == b && d.end[e][1] == a);
        if (there)
            continue;
        uint32_t e = d.m++, say = number(25, step, t, 4);
        d.end[e][0] = a;
        d.end[e][1] = b;
        d.width[e] = wide ? 0.5 + (double)number(26, step, t, 1000000) * 1e-3 : 0.0;
        d.kind[e] = -1;
        if (kinds && say == 0)
            d.kind[e] = EDGE_ANASTOMOSIS;
        if (kinds && say == 1 && part_of(veins, a) != part_of(veins, b)) { /* known veins never close a ring */
            d.kind[e] = EDGE_VEIN;
            veins[part_of(veins, a)] = part_of(veins, b);
        }
    }
    if (d.m == 0) {
        d.end[0][1] = d.m = 1;
        d.kind[0] = -1;
        d.width[0] = wide ? 1.0 : 0.0;
    }
    return d;
}

/* The drawing as a file, nodes and edges shuffled, edges either way round. Node v is called "n" and v; its y tells it apart. */
static char *drawing_text(const Drawing *d, uint32_t step, uint32_t shuffle)
{
    static const char *const names[] = {"vein", "anastomosis"};
    GPtrArray *lines = g_ptr_array_new_with_free_func(g_free);
    for (uint32_t v = 0; v < d->n; v++) {
        GString *s = g_string_new(NULL);
        g_string_printf(s, "<node id='n%u'><data key='x'>", v);
        export_number(s, d->node[v].x);
        g_string_append(s, "</data><data key='y'>");
        export_number(s, d->node[v].y);
        g_string_append(s, "</data></node>\n");
        g_ptr_array_add(lines, g_string_free(s, FALSE));
    }
    for (uint32_t e = 0; e < d->m; e++) {
        uint32_t turn = shuffle ? number(27, step * 7 + shuffle, e, 2) : 0;
        GString *s = g_string_new(NULL);
        g_string_printf(s, "<edge source='n%u' target='n%u'>", d->end[e][turn], d->end[e][1 - turn]);
        if (d->kind[e] >= 0)
            g_string_append_printf(s, "<data key='k'>%s</data>", names[d->kind[e]]);
        if (d->width[e] > 0.0) {
            g_string_append(s, "<data key='w'>");
            export_number(s, d->width[e]);
            g_string_append(s, "</data>");
        }
        g_string_append(s, "</edge>\n");
        g_ptr_array_add(lines, g_string_free(s, FALSE));
    }
    GString *text = g_string_new(UNDIRECTED);
    for (uint32_t i = 0; lines->len > 0; i++) {
        guint k = shuffle ? number(28, step * 7 + shuffle, i, lines->len) : 0;
        g_string_append(text, g_ptr_array_index(lines, k));
        g_ptr_array_remove_index(lines, k);
    }
    g_ptr_array_unref(lines);
    g_string_append(text, END);
    return g_string_free(text, FALSE);
}

static uint32_t node_at(const Drawing *d, Vec2 p)
{
    uint32_t v = 0;
    while (d->node[v].x != p.x || d->node[v].y != p.y)
        v++;
    return v;
}

static uint32_t edge_between(const Drawing *d, uint32_t a, uint32_t b)
{
    uint32_t e = 0;
    while (!(d->end[e][0] == a && d->end[e][1] == b) && !(d->end[e][0] == b && d->end[e][1] == a))
        e++;
    return e;
}

/* What the search must come to, found without one: best[v] is the shortest way to v from `root` (Bellman-Ford), or the width of the
 * narrowest edge, negated, on the way where that is widest. */
static void best_ways(const Drawing *d, uint32_t root, bool wide, double *best)
{
    for (uint32_t v = 0; v < d->n; v++)
        best[v] = v == root ? (wide ? -HUGE_VAL : 0.0) : HUGE_VAL;
    for (uint32_t turn = 0; turn < d->n; turn++)
        for (uint32_t k = 0; k < 2 * d->m; k++) {
            uint32_t e = k / 2, a = d->end[e][k % 2], b = d->end[e][1 - k % 2];
            double way = wide ? MAX(best[a], -d->width[e]) : best[a] + vec_dist(d->node[a], d->node[b]);
            if (d->kind[e] != EDGE_ANASTOMOSIS && best[a] < HUGE_VAL && way < best[b])
                best[b] = way;
        }
}

/* The node of the part of v (anastomoses don't connect) nearest to 0,0. */
static uint32_t first_of(const Drawing *d, uint32_t v)
{
    double way[MOST_NODES];
    best_ways(d, v, false, way);
    uint32_t best = v;
    for (uint32_t u = 0; u < d->n; u++)
        if (way[u] < HUGE_VAL && vec_norm2(d->node[u]) < vec_norm2(d->node[best]))
            best = u;
    return best;
}

static void check_drawing(const Drawing *d, const Network *net, bool optimal)
{
    double way[MOST_NODES], best[MOST_NODES];
    uint32_t root[MOST_NODES], of[MOST_NODES];
    assert_sound(net);
    g_assert_cmpuint(net->n_nodes, ==, d->n);
    g_assert_cmpuint(net->n_edges, ==, d->m);
    bool wide = d->width[0] > 0.0;
    for (uint32_t v = 0; v < d->n; v++) {
        of[v] = node_at(d, net->node[v]);
        root[v] = v;
        way[v] = wide ? -HUGE_VAL : 0.0;
    }
    for (uint32_t v = 0; v < d->n; v++) /* nodes come in topological order */
        for (uint32_t e = 0; e < d->m; e++)
            if (net->head[e] == v && net->kind[e] == EDGE_VEIN) {
                uint32_t u = net->tail[e], k = edge_between(d, of[u], of[v]);
                way[v] = wide ? MAX(way[u], -d->width[k]) : way[u] + vec_dist(net->node[u], net->node[v]);
                root[v] = root[u];
                g_assert_cmpuint(net->node_birth[v], ==, net->node_birth[u] + 1);
            }
    for (uint32_t v = 0; v < d->n; v++) {
        uint32_t base = first_of(d, of[v]);
        g_assert_cmpuint(of[root[v]], ==, base);
        best_ways(d, base, wide, best);
        if (optimal && way[v] != best[of[v]]) /* first nodes: both may be infinite */
            g_assert_cmpfloat(fabs(way[v] - best[of[v]]), <=, 1e-9);
    }
    for (uint32_t e = 0; e < d->m; e++) {
        uint32_t k = edge_between(d, of[net->tail[e]], of[net->head[e]]);
        if (d->kind[k] >= 0)
            g_assert_cmpint(net->kind[e], ==, d->kind[k]);
        if (wide)
            g_assert_cmpfloat(net->width[e], ==, d->width[k]);
    }
}

static void test_search(void)
{
    for (uint32_t step = 0; step < 1500; step++) {
        Drawing d = random_drawing(step);
        bool known = false;
        for (uint32_t e = 0; e < d.m; e++)
            known |= d.kind[e] == EDGE_VEIN;
        uint32_t veins = 0;
        for (uint32_t shuffle = 0; shuffle < 3; shuffle++) {
            char *text = drawing_text(&d, step, shuffle);
            Network *net = read_text(text);
            check_drawing(&d, net, !known);
            uint32_t now = 0; /* the same veins however it was drawn: lengths and widths differ, so there are no ties */
            for (uint32_t e = 0; e < d.m; e++)
                if (net->kind[e] == EDGE_VEIN)
                    now += 1u << edge_between(&d, node_at(&d, net->node[net->tail[e]]), node_at(&d, net->node[net->head[e]])) % 31;
            if (shuffle == 0)
                veins = now;
            g_assert_cmpuint(veins, ==, now);
            char *first = written(net);
            Network *back = read_text(first);
            assert_equal(net, back);
            g_free(first);
            network_free(back);
            network_free(net);
            g_free(text);
        }
    }
}

/* A grown leaf without its directions: they are found again. */
static void test_undirected(void)
{
    Network *net = grown(PATTERN_CLOSED, 11);
    char *text = written(net);
    char **part = g_strsplit(text, "<edge source=\"", -1);
    GString *s = g_string_new(part[0]);
    g_string_replace(s, "edgedefault=\"directed\"", "edgedefault=\"undirected\"", 1);
    for (guint k = 1; part[k] != NULL; k++) {
        char *target = strstr(part[k], "\" target=\"");
        g_assert_nonnull(target);
        *target = '\0';
        target += strlen("\" target=\"");
        char *rest = strchr(target, '"');
        *rest = '\0';
        bool turn = k % 3 == 0;
        g_string_append_printf(s, "<edge source=\"%s\" target=\"%s\"%s", turn ? target : part[k], turn ? part[k] : target, rest + 1);
    }
    Network *back = read_text(s->str);
    assert_equal(net, back);
    network_free(back);
    /* As directed, the turned ones make no sense. */
    g_string_replace(s, "edgedefault=\"undirected\"", "edgedefault=\"directed\"", 1);
    GError *error = NULL;
    g_assert_null(import_graphml_text(s->str, s->len, "leaf", &widths, &error));
    g_assert_error(error, IMPORT_ERROR, IMPORT_ERROR_GRAPH);
    g_error_free(error);
    g_strfreev(part);
    g_string_free(s, TRUE);
    g_free(text);
    network_free(net);
}

/* ---- files that say less ---- */

/* The text without the data of one key: everywhere, or (once) in the last place. */
static char *without(const char *text, char key, bool once)
{
    char *open = g_strdup_printf("<data key=\"%c\">", key);
    GString *s = g_string_new(NULL);
    const char *at = text, *found, *last = g_strrstr(text, open);
    while ((found = once ? (at <= last ? last : NULL) : strstr(at, open)) != NULL) {
        g_string_append_len(s, at, found - at);
        at = strstr(found, "</data>") + strlen("</data>");
    }
    g_string_append(s, at);
    g_free(open);
    return g_string_free(s, FALSE);
}

/* Every set of missing values, on all edges and on one. */
static void test_missing(void)
{
    static const char key[] = "orvwf";
    enum { ORDER = 1, RANK = 2, VEIN = 4, WIDTH = 8, FLOW = 16 };
    static const WidthDef other = {.exponent = 3.0, .minimum = 0.2, .rank_ratio = 0.4};
    Network *net = grown(PATTERN_CLOSED, 21);
    network_assign_widths(net, &other);
    for (uint32_t e = 0; e < net->n_edges; e++) { /* unlike what widths would make of it */
        net->order[e]++;
        net->rank[e] = (uint8_t)(net->rank[e] + 2);
    }
    char *whole = written(net);
    Network *plain = read_text(whole), *made = read_text(whole); /* both rounded as the file is */
    network_assign_widths(made, &widths);
    for (unsigned set = 0; set < 64; set++) {
        char *text = g_strdup(whole);
        for (int k = 0; k < 5; k++)
            if (set & 1u << k) {
                char *less = without(text, key[k], set >= 32);
                g_free(text);
                text = less;
            }
        Network *back = read_text(text);
        const bool order = set & ORDER, width = set & WIDTH;
        assert_sound(back);
        ASSERT_ARRAY(back->order, order ? made->order : plain->order, net->n_edges);
        ASSERT_ARRAY(back->rank, order || set & RANK ? made->rank : plain->rank, net->n_edges);
        ASSERT_ARRAY(back->vein, order ? made->vein : plain->vein, net->n_edges); /* orders tell the veins */
        g_assert_cmpuint(back->n_veins, ==, order ? made->n_veins : plain->n_veins);
        ASSERT_ARRAY(back->width, width ? made->width : plain->width, net->n_edges);
        for (uint32_t e = 0; e < net->n_edges; e++) {
            double flow = width ? made->flow[e] : set & FLOW ? 4.0 * plain->width[e] * plain->width[e] : plain->flow[e];
            g_assert_cmpfloat(fabs(back->flow[e] - flow), <=, 1e-12 * flow);
        }
        network_free(back);
        g_free(text);
    }
    network_free(plain);
    network_free(made);
    g_free(whole);
    network_free(net);
}

static void test_births(void)
{
#define CHAIN(steps, a, b, c, ab, bc)                                                                                                      \
    DIRECTED steps "<node id='a'><data key='x'>0</data><data key='y'>0</data>" a "</node><node id='b'><data key='x'>0</data>"              \
                   "<data key='y'>1</data>" b "</node><node id='c'><data key='x'>0</data><data key='y'>2</data>" c "</node>"                \
                   EDGE_OF("a", "b", DATA("k", "vein") ab) EDGE_OF("b", "c", DATA("k", "vein") bc) END
    static const struct {
        const char *text;
        uint32_t node[3], edge[2], steps;
    } cases[] = {
        {CHAIN("", "", "", "", "", ""), {0, 1, 2}, {1, 2}, 2},
        {CHAIN("", DATA("t", "3"), DATA("t", "5"), DATA("t", "9"), "", ""), {3, 5, 9}, {5, 9}, 9},
        {CHAIN("", DATA("t", "3"), DATA("t", "5"), DATA("t", "9"), DATA("b", "7"), DATA("b", "11")), {3, 5, 9}, {7, 11}, 11},
        {CHAIN(DATA("s", "20"), DATA("t", "3"), DATA("t", "5"), DATA("t", "9"), "", DATA("b", "10")), {3, 5, 9}, {5, 10}, 20},
        {CHAIN(DATA("s", "20"), DATA("t", "3"), "", DATA("t", "9"), "", DATA("b", "10")), {0, 1, 2}, {1, 2}, 2},   /* b has none */
        {CHAIN("", DATA("t", "3"), DATA("t", "2"), DATA("t", "9"), "", DATA("b", "10")), {0, 1, 2}, {1, 2}, 2}, /* b before a */
    };
    for (gsize i = 0; i < G_N_ELEMENTS(cases); i++) {
        Network *net = read_text(cases[i].text);
        ASSERT_ARRAY(net->node_birth, cases[i].node, 3);
        ASSERT_ARRAY(net->birth, cases[i].edge, 2);
        g_assert_cmpuint(net->n_steps, ==, cases[i].steps);
        network_free(net);
    }
}

/* Vein numbers with gaps, or so large that no array should be made for them. */
static void test_vein_numbers(void)
{
#define VEINS(a, b, c)                                                                                                                     \
    DIRECTED NODE("0", "0", "0") NODE("1", "0", "1") NODE("2", "0", "2") NODE("3", "1", "2") EDGE_OF("0", "1", DATA("k", "vein")          \
        DATA("o", "1") DATA("v", a)) EDGE_OF("1", "2", DATA("k", "vein") DATA("o", "1") DATA("v", b))                                      \
        EDGE_OF("1", "3", DATA("k", "vein") DATA("o", "2") DATA("v", c)) END
    static const struct {
        const char *text;
        uint32_t n, vein[3];
    } cases[] = {
        {VEINS("0", "0", "1"), 2, {0, 0, 1}}, {VEINS("2", "1", "0"), 3, {2, 1, 0}},
        {VEINS("2", "2", "0"), 2, {1, 1, 0}}, {VEINS("7", "7", "2147483647"), 2, {0, 0, 1}},
        {VEINS("9", "4", "4"), 2, {1, 0, 0}}, {VEINS("1", "1", "1"), 1, {0, 0, 0}},
        {VEINS("0", "1", "3"), 3, {0, 1, 2}},
    };
    for (gsize i = 0; i < G_N_ELEMENTS(cases); i++) {
        Network *net = read_text(cases[i].text);
        g_assert_cmpuint(net->n_veins, ==, cases[i].n);
        ASSERT_ARRAY(net->vein, cases[i].vein, 3);
        network_free(net);
    }
}

/* Where orders are given a vein goes on in the widest edge of its own order, of equals the first; others begin veins. */
static void test_vein_runs(void)
{
#define FORK(order1, width1, order2, width2)                                                                                               \
    DIRECTED NODE("0", "0", "0") NODE("1", "0", "1") NODE("2", "0", "2") NODE("3", "1", "2")                                               \
        EDGE_OF("0", "1", DATA("k", "vein") DATA("o", "2") DATA("w", "3"))                                                                 \
        EDGE_OF("1", "2", DATA("k", "vein") DATA("o", order1) DATA("w", width1))                                                           \
        EDGE_OF("1", "3", DATA("k", "vein") DATA("o", order2) DATA("w", width2))                                                           \
        EDGE_OF("2", "3", DATA("k", "anastomosis") DATA("o", "2") DATA("w", "9")) END
    static const struct {
        const char *text;
        uint32_t vein[4];
    } cases[] = {
        {FORK("2", "1", "2", "1"), {0, 0, 1, 2}}, {FORK("2", "1", "2", "1.5"), {0, 1, 0, 2}},
        {FORK("2", "1", "3", "1.5"), {0, 0, 1, 2}}, {FORK("3", "1", "1", "1.5"), {0, 1, 2, 3}},
    };
    for (gsize i = 0; i < G_N_ELEMENTS(cases); i++) {
        Network *net = read_text(cases[i].text);
        assert_sound(net);
        ASSERT_ARRAY(net->vein, cases[i].vein, 4);
        network_free(net);
    }
}

/* Directed edges of known kinds in any order of nodes: sorted by depth, anastomoses turned towards the younger end. */
static void test_sorted(void)
{
    Network *net = read_text(DIRECTED EDGE_OF("5", "4", DATA("k", "anastomosis") DATA("w", "0.5"))
                                 EDGE_OF("2", "5", DATA("k", "vein") DATA("w", "1.5")) EDGE_OF("7", "2", DATA("k", "vein") DATA("w", "2.5"))
                                     EDGE_OF("2", "4", DATA("k", "vein") DATA("w", "3.5")) NODE("4", "1", "2") NODE("5", "-1", "2")
                                         NODE("7", "0", "50") NODE("2", "0", "1") END);
    static const Vec2 node[] = {{0, 50}, {0, 1}, {1, 2}, {-1, 2}}; /* 7 is the first, far from the base as it is */
    static const uint32_t tail[] = {0, 1, 1, 2}, head[] = {1, 2, 3, 3}, birth[] = {0, 1, 2, 2};
    static const double width[] = {2.5, 3.5, 1.5, 0.5};
    assert_sound(net);
    ASSERT_ARRAY(net->node, node, 4);
    ASSERT_ARRAY(net->tail, tail, 4);
    ASSERT_ARRAY(net->head, head, 4);
    ASSERT_ARRAY(net->node_birth, birth, 4);
    ASSERT_ARRAY(net->width, width, 4);
    network_free(net);
}

/* ---- where the leaf stands ---- */

/* What a file does not say. */
enum { NO_BASE = 1, NO_TIP = 2, NO_WIDTHS = 4, NO_KINDS = 8, ALL_SETS = 16 };

static void put_point(GString *s, const double m[6], Vec2 p)
{
    export_number(s, m[0] * p.x + m[1] * p.y + m[4]);
    g_string_append_c(s, ',');
    export_number(s, m[2] * p.x + m[3] * p.y + m[5]);
}

/* The network with its points through x' = m0 x + m1 y + m4, y' = m2 x + m3 y + m5, to the bit. */
static char *moved_text(const Network *net, const double m[6], unsigned less)
{
    GString *s = g_string_new(less & NO_KINDS ? UNDIRECTED : DIRECTED);
    g_string_append(s, "<data key='m'>");
    for (uint32_t i = 0; i < net->margin->n; i++) {
        put_point(s, m, net->margin->v[i]);
        g_string_append_c(s, ' ');
    }
    g_string_append(s, "</data>");
    for (unsigned k = 0; k < 2; k++)
        if (!(less & (k ? NO_TIP : NO_BASE))) {
            g_string_append_printf(s, "<data key='%s'>", k ? "tip" : "base");
            put_point(s, m, vec2(0.0, k * net->length));
            g_string_append(s, "</data>");
        }
    for (uint32_t v = 0; v < net->n_nodes; v++) {
        GString *at = g_string_new(NULL);
        put_point(at, m, net->node[v]);
        char *comma = strchr(at->str, ',');
        *comma = '\0';
        g_string_append_printf(s, "<node id='%u'><data key='x'>%s</data><data key='y'>%s</data></node>\n", v, at->str, comma + 1);
        g_string_free(at, TRUE);
    }
    for (uint32_t e = 0; e < net->n_edges; e++) {
        g_string_append_printf(s, "<edge source='%u' target='%u'>", net->tail[e], net->head[e]);
        if (!(less & NO_KINDS))
            g_string_append_printf(s, "<data key='k'>%s</data>", net->kind[e] == EDGE_VEIN ? "vein" : "anastomosis");
        if (!(less & NO_WIDTHS)) {
            g_string_append(s, "<data key='w'>");
            export_number(s, net->width[e]);
            g_string_append(s, "</data>");
        }
        g_string_append(s, "</edge>\n");
    }
    g_string_append(s, END);
    return g_string_free(s, FALSE);
}

static void assert_same_leaf(const Network *a, const Network *b, double flip)
{
    const double most = 1e-9;
    g_assert_cmpuint(a->n_nodes, ==, b->n_nodes);
    g_assert_cmpuint(a->n_edges, ==, b->n_edges);
    g_assert_cmpfloat(fabs(a->length - b->length), <=, most);
    for (uint32_t v = 0; v < a->n_nodes; v++)
        g_assert_cmpfloat(vec_dist(a->node[v], vec2(flip * b->node[v].x, b->node[v].y)), <=, most);
    ASSERT_ARRAY(a->tail, b->tail, a->n_edges);
    ASSERT_ARRAY(a->head, b->head, a->n_edges);
    ASSERT_ARRAY(a->kind, b->kind, a->n_edges);
    ASSERT_ARRAY(a->order, b->order, a->n_edges);
    ASSERT_ARRAY(a->vein, b->vein, a->n_edges);
    ASSERT_ARRAY(a->width, b->width, a->n_edges);
    g_assert_cmpuint(a->margin->n, ==, b->margin->n);
    for (uint32_t i = 0; i < a->margin->n; i++) { /* mirrored, the other way round from the same first point */
        Vec2 p = b->margin->v[flip < 0.0 ? (a->margin->n - i) % a->margin->n : i];
        g_assert_cmpfloat(vec_dist(a->margin->v[i], vec2(flip * p.x, p.y)), <=, most);
    }
}

/* One leaf drawn anywhere, any way round and with y down is one leaf, whatever its file says. */
static void test_moved(void)
{
    static const double way[][6] = {
        {1, 0, 0, 1, 300, -500},        {1, 0, 0, 1, -300, 500},     {0, 1, -1, 0, 0, 0},            {0, -1, 1, 0, 300, -500},
        {-1, 0, 0, -1, 17, 4},          {0.6, 0.8, -0.8, 0.6, 0, 0}, {-0.28, 0.96, -0.96, -0.28, 1e5, 3}, /* turned */
        {1, 0, 0, -1, 0, 0},            {1, 0, 0, -1, -300, -500},   {-1, 0, 0, 1, 2, 2},            {0, 1, 1, 0, 9, 9},
        {0.8, 0.6, 0.6, -0.8, 300, -500}, /* mirrored */
    };
    const char *const blades[] = {NULL, fan, kidney};
    for (gsize b = 0; b < G_N_ELEMENTS(blades); b++) {
        Network *net = grown_in(blades[b], PATTERN_CLOSED, 31 + b);
        for (unsigned less = 0; less < ALL_SETS; less++) {
            static const double still[6] = {1, 0, 0, 1, 0, 0};
            char *text = moved_text(net, still, less);
            Network *first = read_text(text);
            assert_sound(first);
            g_assert_cmpfloat(first->length, >, 0.0);
            if (!(less & (NO_BASE | NO_TIP)))
                g_assert_cmpfloat(first->length, ==, net->length);
            g_free(text);
            for (gsize k = 0; k < G_N_ELEMENTS(way); k++) {
                text = moved_text(net, way[k], less);
                Network *back = read_text(text);
                assert_same_leaf(first, back, way[k][0] * way[k][3] - way[k][1] * way[k][2]);
                g_free(text);
                text = written(back); /* and stays where it is */
                Network *again = read_text(text);
                char *twice = written(again);
                g_assert_cmpstr(text, ==, twice);
                network_free(again);
                network_free(back);
                g_free(text);
                g_free(twice);
            }
            network_free(first);
        }
        network_free(net);
    }
}

/* What is found where base and tip are not said: in file coordinates, by where the first node comes to lie. */
static void test_found(void)
{
#define BLADE "<data key='m'>0,0 4,3 3,9 0,12 -3,9 -4,3</data>"
#define PIN NODE("a", "0", "0") NODE("b", "0", "5") NODE("c", "0", "11") NODE("d", "2", "7") EDGE("b", "d")
    static const struct {
        const char *text;
        double length;
        Vec2 node; /* the first in the network, and where the node of the file's first name comes to lie */
        uint32_t n;
    } cases[] = {
        {UNDIRECTED BLADE PIN EDGE("a", "b") EDGE("b", "c") END, 12, {0, 0}, 4},
        /* The margin begins elsewhere: the widest edge tells the base, where there are widths, and they differ. */
        {UNDIRECTED "<data key='m'>4,3 3,9 0,12 -3,9 -4,3 0,0</data>" NODE("a", "0", "0") NODE("b", "0", "5") NODE("c", "0", "11")
             EDGE_OF("a", "b", DATA("w", "3")) EDGE_OF("b", "c", DATA("w", "2")) END, 12, {0, 0}, 3},
        /* The vein ends off the tip, and then so far off that the blade ends where it points. */
        {UNDIRECTED BLADE NODE("a", "0", "0") NODE("b", "1", "9") EDGE("a", "b") END, 12, {0, 0}, 2},
        {UNDIRECTED "<data key='m'>0,0 5,-5 10,0 10,5 -10,5 -10,0 -5,-5</data>" NODE("a", "0", "0") NODE("b", "0", "4") EDGE("a", "b") END, 5, {0, 0}, 2},
        /* Of two first nodes the one with the wider vein; a vein that ends on the margin. */
        {DIRECTED BLADE NODE("a", "0", "0") NODE("b", "0", "12") NODE("c", "1", "1") NODE("d", "1", "5")
             EDGE_OF("c", "d", DATA("k", "vein") DATA("w", "2")) EDGE_OF("a", "b", DATA("k", "vein") DATA("w", "3")) END, 12, {0, 0}, 4},
        /* No vein begins at the base. */
        {DIRECTED BLADE "<data key='base'>0,0</data>" NODE("a", "0", "0") NODE("b", "0", "5") EDGE_OF("a", "b", DATA("k", "anastomosis")) END, 12, {0, 0}, 2},
        /* No margin: as it stands, or from the base, or all the way. */
        {UNDIRECTED NODE("a", "3", "4") NODE("b", "3", "9") EDGE("a", "b") END, 0, {3, 4}, 2},
        {UNDIRECTED "<data key='base'>2,3</data>" NODE("a", "3", "4") NODE("b", "3", "9") EDGE("a", "b") END, 0, {1, 1}, 2},
        {UNDIRECTED "<data key='base'> 2,3\n</data><data key='tip'>-8,3</data>" NODE("a", "1", "3") NODE("b", "-5", "4") EDGE("a", "b") END, 10, {0, 1}, 2},
    };
    for (gsize i = 0; i < G_N_ELEMENTS(cases); i++) {
        Network *net = read_text(cases[i].text);
        assert_sound(net);
        g_test_message("case %zu", i);
        g_assert_cmpuint(net->n_nodes, ==, cases[i].n);
        g_assert_cmpfloat(fabs(net->length - cases[i].length), <=, 1e-12);
        g_assert_cmpfloat(vec_dist(net->node[0], cases[i].node), <=, 1e-12);
        network_free(net);
    }
}

/* The example that documents what a person may write. */
static void test_hand(void)
{
    char *path = g_test_build_filename(G_TEST_DIST, "..", "fuzz", "corpus", "network", "hand.graphml", NULL);
    GError *error = NULL;
    Network *net = import_graphml(path, &widths, &error);
    g_assert_no_error(error);
    assert_sound(net);
    g_assert_cmpuint(net->n_edges, ==, 3);
    g_assert_cmpfloat(net->length, ==, 900.0);
    g_assert_cmpuint(net->kind[0] + net->kind[1] + net->kind[2], ==, 0);
    g_assert_cmpfloat(net->width[0], ==, 12.0);
    g_assert_cmpuint(net->vein[0], ==, net->vein[1]);
    network_free(net);
    g_free(path);
}

/* A margin that the file does not have. */
static void test_inside(void)
{
    static const Vec2 square[] = {{-100, 0}, {100, 0}, {100, 200}, {-100, 200}};
    Network *net = read_text(UNDIRECTED NODE("a", "0", "0") NODE("b", "0", "203.9") EDGE("a", "b") END);
    GError *error = NULL;
    net->margin = polygon_new(square, 4);
    net->length = 200.0;
    g_assert_true(import_check_inside(net, "leaf", &error));
    net->node[1].y = 204.1;
    g_assert_false(import_check_inside(net, "leaf", &error));
    g_assert_error(error, IMPORT_ERROR, IMPORT_ERROR_GRAPH);
    g_assert_cmpstr(error->message, ==, "leaf: the node at 0,204.1 lies 4.1 segments outside the margin; in a leaf 200 segments long it must be at most 4 "
                                        "(a petiole is not drawn: mesh.petiole_length makes one)");
    g_error_free(error);
    network_free(net);
}

/* ---- ways to write ---- */

static void test_writing(void)
{
#define PAIR NODE("a", "0", "0") NODE("b", "0.5", "-2e1") EDGE("a", "b")
    static const char *const texts[] = {
        UNDIRECTED PAIR END,
        "\xEF\xBB\xBF" UNDIRECTED PAIR END,
        "<?xml version='1.0'?>\n<!DOCTYPE graphml>\n<!-- a leaf -->\n" UNDIRECTED PAIR END "\n<!-- end -->\n",
        /* a prefix; a key for all; other ids; a default; other vocabularies; blanks, CDATA and comments in values */
        "<g:graphml xmlns:g='http://graphml.graphdrawing.org/xmlns' xmlns:y='yed'><g:desc>a <g:node/></g:desc>"
        "<g:key id='d0' for='all' attr.name='y'><g:desc/><g:default>-20</g:default></g:key><g:key id='d1' attr.name='x' attr.type='string'/>"
        "<g:key id='d2' for='node' attr.name='colour'/><g:key id='d3' for='edge' yfiles.type='edgegraphics'/>"
        "<g:key id='d4' for='edge' attr.name='x'/><g:key id='d5' for='port' attr.name='width'/><g:data key='d2'>not ours</g:data>"
        "<g:graph edgedefault='undirected'><g:desc/><y:node id='a'/><g:data key='d1'>the graph's own</g:data>"
        "<g:node id='a'><g:data key='d1'> 0 </g:data><g:data key='d0'>\n<!-- here -->0<y:more>7</y:more></g:data></g:node>"
        "<g:node id='b'><g:port name='p'><g:data key='d9'>1</g:data></g:port><g:data key='d2'>NaN</g:data>"
        "<g:data key='d1'><![CDATA[0]]>.5</g:data></g:node><g:edge source='a' target='b'><g:data key='d4'>w</g:data>"
        "<g:data key='d3'><y:Edge><y:data key='none'/></y:Edge></g:data></g:edge></g:graph><g:parseinfo/></g:graphml>",
        /* numeric names in no order, as text, with zeros, too long, and as entities */
        UNDIRECTED EDGE("01", "1") NODE("1", "0", "0") NODE("01", "0.5", "-20") END,
        UNDIRECTED EDGE("4294967295", "4294967296") NODE("4294967295", "0", "0") NODE("4294967296", "0.5", "-20") END,
        UNDIRECTED EDGE("1", "0") NODE("1", "0", "0") NODE("0", "0.5", "-20") END,
        UNDIRECTED NODE("Bl&#xe4;tt&lt;", "0", "0") NODE("", "0.5", "-20") EDGE("", "Blätt&lt;") END,
        UNDIRECTED NODE("a", "+0e9", ".0") NODE("b", "00.5", "-20.") EDGE("a", "b") END,
        UNDIRECTED NODE("a", "-0", "0.000000000000000000000000") NODE("b", "5E-1", "-200000000000000000000e-19") EDGE("a", "b") END,
    };
    for (gsize i = 0; i < G_N_ELEMENTS(texts); i++) {
        g_test_message("text %zu", i);
        Network *net = read_text(texts[i]);
        g_assert_cmpuint(net->n_nodes, ==, 2);
        g_assert_cmpuint(net->n_edges, ==, 1);
        g_assert_cmpfloat(net->node[0].x, ==, 0.0);
        g_assert_cmpfloat(net->node[0].y, ==, 0.0);
        g_assert_cmpfloat(net->node[1].x, ==, 0.5);
        g_assert_cmpfloat(net->node[1].y, ==, -20.0);
        g_assert_cmpuint(net->kind[0], ==, EDGE_VEIN);
        network_free(net);
    }
}

/* Every number that a double may be prints and reads alike. */
static void test_numbers(void)
{
    for (uint32_t i = 0; i < 20000; i++) {
        RandomBlock b = random_block(8, 130, 0, i);
        static const char *const format[] = {"%.17g", "%.15g", "%.6f", "%.1f", "%.12e"};
        double value = (double)(int32_t)b.w[0] * (1.0 + b.w[1] * 0x1p-32) / (double)(UINT64_C(1) << b.w[2] % 60);
        char number_text[400], *text;
        g_ascii_formatd(number_text, sizeof number_text, format[b.w[3] % 5], value);
        value = g_ascii_strtod(number_text, NULL);
        if (fabs(value) > 9.9e8)
            continue;
        text = g_strdup_printf(UNDIRECTED "<node id='a'><data key='x'>%s</data><data key='y'>0</data></node>" NODE("b", "1e9", "0")
                                   EDGE("a", "b") END,
                               number_text);
        Network *net = read_text(text);
        g_assert_cmpfloat(net->node[0].x, ==, value);
        network_free(net);
        g_free(text);
    }
}

static void test_margins(void)
{
#define LEAF(points) DIRECTED "<data key='m'>" points "</data>" NODE("a", "0", "0") NODE("b", "0", "1") EDGE("a", "b") END
    static const Vec2 square[] = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};
    static const char *const texts[] = {
        LEAF("0,0 2,0 2,2 0,2"),
        LEAF("\n0,0\t0,2.0 2e0,2  2,0\n"),                /* the other way round */
        LEAF("0,0 0,0 2,0 2,2 2,2 2,2.0000001 0,2 -0,0 0,0"), /* closed, points doubled */
    };
    for (gsize i = 0; i < G_N_ELEMENTS(texts); i++) {
        Network *net = read_text(texts[i]);
        g_assert_cmpuint(net->margin->n, ==, 4);
        for (int k = 0; k < 4; k++) {
            g_assert_cmpfloat(net->margin->v[k].x, ==, square[k].x);
            g_assert_cmpfloat(net->margin->v[k].y, ==, square[k].y);
        }
        g_assert_cmpfloat(net->margin->area, ==, 4.0);
        network_free(net);
    }
}

/* ---- what is wrong, and where ---- */

static void test_errors(void)
{
#define LINES "\n\n" /* so that elements after it are in line 3 */
#define TWO NODE("a", "0", "0") NODE("b", "0", "1")
#define THREE TWO NODE("c", "0", "2")
#define VEIN(a, b) EDGE_OF(a, b, DATA("k", "vein"))
    static const struct {
        const char *text;
        ImportErrorCode code;
        const char *message;
    } cases[] = {
        {"", IMPORT_ERROR_SYNTAX, "leaf.graphml:1: not well-formed XML: Document was empty or contained only whitespace"},
        {"veins", IMPORT_ERROR_SYNTAX, "leaf.graphml:1: not well-formed XML: *"},
        {" \n<svg/>", IMPORT_ERROR_SYNTAX, "leaf.graphml:2: not GraphML: it begins with the element 'svg', not 'graphml'"},
        {UNDIRECTED LINES TWO, IMPORT_ERROR_SYNTAX, "leaf.graphml:3: not well-formed XML: *"},
        {UNDIRECTED LINES "</graphml>", IMPORT_ERROR_SYNTAX, "leaf.graphml:3: not well-formed XML: *"},
        {UNDIRECTED LINES "<node id='\xff'/>", IMPORT_ERROR_SYNTAX, "leaf.graphml:3: not UTF-8 text, as GraphML must be"},
        {UNDIRECTED LINES "<![CDATA[\xff]]><node/>", IMPORT_ERROR_SYNTAX, "leaf.graphml:3: not UTF-8 text, as GraphML must be"},
        {UNDIRECTED LINES "<no\xC3\xA4" "de/><1/>", IMPORT_ERROR_SYNTAX, "leaf.graphml:3: not well-formed XML: *"},
        {"<graphml/>", IMPORT_ERROR_GRAPH, "leaf.graphml:1: there is no <graph>"},
        {"<graphml><graph/>\n<graph/></graphml>", IMPORT_ERROR_SYNTAX, "leaf.graphml:2: a second <graph>; a venation is a single one"},
        {UNDIRECTED LINES "<node id='a'><graph/></node>" END, IMPORT_ERROR_SYNTAX, "leaf.graphml:3: a <graph>; a venation is *"},
        {UNDIRECTED LINES "<hyperedge/>" END, IMPORT_ERROR_SYNTAX, "leaf.graphml:3: a <hyperedge>; a venation is *"},
        {UNDIRECTED END, IMPORT_ERROR_GRAPH, "leaf.graphml: the graph has no nodes; a venation has at least two nodes and an edge, a leaf without veins one node and a margin"},
        {UNDIRECTED TWO END, IMPORT_ERROR_GRAPH, "leaf.graphml: the graph has no edges; a venation has at least two nodes and an edge, a leaf without veins one node and a margin"},
        {UNDIRECTED EDGE("a", "b") END, IMPORT_ERROR_GRAPH, "leaf.graphml: the graph has no nodes;*"},
        {UNDIRECTED TWO LINES EDGE("a", "c") END, IMPORT_ERROR_GRAPH, "leaf.graphml:3: edge 'a' – 'c': there is no node 'c'"},
        {UNDIRECTED EDGE("a", "b") LINES EDGE("c", "a") TWO END, IMPORT_ERROR_GRAPH, "leaf.graphml:3: edge 'c' – 'a': there is no node 'c'"},
        {UNDIRECTED TWO LINES NODE("b", "5", "5") EDGE("a", "b") END, IMPORT_ERROR_GRAPH,
         "leaf.graphml:3: a second node 'b'; the first is in line 1"},
        {UNDIRECTED NODE("0", "5", "5") LINES NODE("0", "5", "6") EDGE("a", "b") END, IMPORT_ERROR_GRAPH,
         "leaf.graphml:3: a second node '0'; the first is in line 1"},
        {UNDIRECTED TWO LINES "<node id='c'><data key='y'>1</data></node>" EDGE("a", "b") END, IMPORT_ERROR_SYNTAX,
         "leaf.graphml:3: node 'c' has no x; every node needs x and y, in segments"},
        {"<graphml><key id='x' for='edge' attr.name='x'/><graph>\n<node id='c'/></graph></graphml>", IMPORT_ERROR_SYNTAX,
         "leaf.graphml:2: node 'c' has no x; every node needs x and y, in segments, and there is no <key> for nodes with that attr.name"},
        {UNDIRECTED LINES "<node/>", IMPORT_ERROR_SYNTAX, "leaf.graphml:3: a <node> without id"},
        {UNDIRECTED LINES "<edge source='a'/>", IMPORT_ERROR_SYNTAX, "leaf.graphml:3: an <edge> without target"},
        {UNDIRECTED LINES "<edge target='a'/>", IMPORT_ERROR_SYNTAX, "leaf.graphml:3: an <edge> without source"},
        {UNDIRECTED LINES "<data/>", IMPORT_ERROR_SYNTAX, "leaf.graphml:3: a <data> without key"},
        {UNDIRECTED LINES "<data key='q'/>", IMPORT_ERROR_SYNTAX, "leaf.graphml:3: data of the key 'q', but there is no <key> with that id *"},
        {KEYS LINES "<key id='x'/>", IMPORT_ERROR_SYNTAX, "leaf.graphml:3: a second <key> with the id 'x'"},
        {KEYS LINES "<key for='node'/>", IMPORT_ERROR_SYNTAX, "leaf.graphml:3: a <key> without id"},
        {UNDIRECTED LINES NODE("a", "NaN", "0") END, IMPORT_ERROR_SYNTAX,
         "leaf.graphml:3: node 'a': x is 'NaN'; it must be a number from -1e9 to 1e9, in segments"},
        {UNDIRECTED LINES NODE("a", "0", "inf") END, IMPORT_ERROR_SYNTAX, "leaf.graphml:3: node 'a': y is 'inf'; it must be *"},
        {UNDIRECTED LINES NODE("a", "1,5", "0") END, IMPORT_ERROR_SYNTAX, "leaf.graphml:3: node 'a': x is '1,5'; it must be *"},
        {UNDIRECTED LINES NODE("a", "", "0") END, IMPORT_ERROR_SYNTAX, "leaf.graphml:3: node 'a': x is ''; it must be *"},
        {UNDIRECTED LINES NODE("a", "0x10", "0") END, IMPORT_ERROR_SYNTAX, "leaf.graphml:3: node 'a': x is '0x10'; it must be *"},
        {UNDIRECTED LINES NODE("a", "1 2", "0") END, IMPORT_ERROR_SYNTAX, "leaf.graphml:3: node 'a': x is '1 2'; it must be *"},
        {UNDIRECTED LINES NODE("a", "1e999", "0") END, IMPORT_ERROR_SYNTAX, "leaf.graphml:3: node 'a': x is '1e999'; it must be *"},
        {UNDIRECTED LINES NODE("a", "1e10", "0") END, IMPORT_ERROR_SYNTAX, "leaf.graphml:3: node 'a': x is '1e10'; it must be *"},
        {UNDIRECTED LINES NODE("a", ".", "0") END, IMPORT_ERROR_SYNTAX, "leaf.graphml:3: node 'a': x is '.'; it must be *"},
        {UNDIRECTED LINES NODE("a", "-", "0") END, IMPORT_ERROR_SYNTAX, "leaf.graphml:3: node 'a': x is '-'; it must be *"},
        {UNDIRECTED LINES NODE("a", "1.2.3", "0") END, IMPORT_ERROR_SYNTAX, "leaf.graphml:3: node 'a': x is '1.2.3'; it must be *"},
        {UNDIRECTED LINES "<node id='a'><data key='x'>1</data><data key='x'>1</data></node>" END, IMPORT_ERROR_SYNTAX,
         "leaf.graphml:3: node 'a': x is given a second time"},
        {UNDIRECTED LINES EDGE_OF("a", "b", DATA("o", "0")) END, IMPORT_ERROR_SYNTAX,
         "leaf.graphml:3: edge 'a' – 'b': order is '0'; it must be a whole number from 1 to 255"},
        {UNDIRECTED LINES EDGE_OF("a", "b", DATA("o", "256")) END, IMPORT_ERROR_SYNTAX, "leaf.graphml:3: edge 'a' – 'b': order is '256'; *"},
        {UNDIRECTED LINES EDGE_OF("a", "b", DATA("r", "1.5")) END, IMPORT_ERROR_SYNTAX, "leaf.graphml:3: edge 'a' – 'b': rank is '1.5'; *"},
        {UNDIRECTED LINES EDGE_OF("a", "b", DATA("v", "-1")) END, IMPORT_ERROR_SYNTAX, "leaf.graphml:3: edge 'a' – 'b': vein is '-1'; *"},
        {UNDIRECTED LINES EDGE_OF("a", "b", DATA("v", "2147483648")) END, IMPORT_ERROR_SYNTAX, "*: vein is '2147483648'; it must be *"},
        {UNDIRECTED LINES EDGE_OF("a", "b", DATA("w", "0")) END, IMPORT_ERROR_SYNTAX,
         "leaf.graphml:3: edge 'a' – 'b': width is '0'; it must be a number above 0, from 1e-24 to 1e24, in segments"},
        {UNDIRECTED LINES EDGE_OF("a", "b", DATA("w", "-1")) END, IMPORT_ERROR_SYNTAX, "leaf.graphml:3: edge 'a' – 'b': width is '-1'; *"},
        {UNDIRECTED LINES EDGE_OF("a", "b", DATA("f", "0")) END, IMPORT_ERROR_SYNTAX, "leaf.graphml:3: edge 'a' – 'b': flow is '0'; *"},
        {UNDIRECTED LINES EDGE_OF("a", "b", DATA("b", "x")) END, IMPORT_ERROR_SYNTAX, "leaf.graphml:3: edge 'a' – 'b': birth is 'x'; *"},
        {UNDIRECTED LINES EDGE_OF("a", "b", DATA("k", "veins")) END, IMPORT_ERROR_SYNTAX,
         "leaf.graphml:3: edge 'a' – 'b': kind is 'veins'; it must be vein or anastomosis"},
        {"<graphml><key id='k' for='edge' attr.name='kind'><default>bone</default></key><graph>\n" EDGE("a", "b") "</graph></graphml>",
         IMPORT_ERROR_SYNTAX, "leaf.graphml:2: edge 'a' – 'b': kind is 'bone'; it must be vein or anastomosis"},
        {"<graphml><key id='y' attr.name='y'><default>high</default></key><graph>\n<node id='a'/></graph></graphml>",
         IMPORT_ERROR_SYNTAX, "leaf.graphml:2: node 'a': y is 'high'; it must be *"},
        {"<graphml><key id='s' attr.name='steps'><default>-1</default></key>\n<graph/></graphml>",
         IMPORT_ERROR_SYNTAX, "leaf.graphml:2: the graph: steps is '-1'; it must be *"},
        {UNDIRECTED LINES "<data key='s'>many</data>" END, IMPORT_ERROR_SYNTAX, "leaf.graphml:3: the graph: steps is 'many'; it must be *"},
        {UNDIRECTED LINES "<data key='m'>0,0 1,0 1;1</data>" END, IMPORT_ERROR_SYNTAX,
         "leaf.graphml:3: the graph: margin has the point '1;1'; it must be points x,y x,y … of numbers from -1e9 to 1e9, in segments"},
        {UNDIRECTED LINES "<data key='m'>0,0 1,0, 1,1</data>" END, IMPORT_ERROR_SYNTAX, "*: margin has the point '1,0,'; it must be *"},
        {UNDIRECTED LINES "<data key='m'>0,0 1,nan</data>" END, IMPORT_ERROR_SYNTAX, "*: margin has the point '1,nan'; it must be *"},
        {UNDIRECTED LINES "<data key='m'/>" END, IMPORT_ERROR_GRAPH,
         "leaf.graphml:3: the graph: margin has 0 different points; an outline needs at least 3"},
        {UNDIRECTED LINES "<data key='m'>0,0 1,1 1,1 0,0</data>" END, IMPORT_ERROR_GRAPH, "*: margin has 2 different points; *"},
        {UNDIRECTED LINES "<data key='m'>0,0 2,2 2,0 0,2</data>" END, IMPORT_ERROR_GRAPH,
         "leaf.graphml:3: the graph: margin meets itself: its edges 0,0 – 2,2 and 2,0 – 0,2 touch or cross; an outline must not"},
        {UNDIRECTED LINES "<data key='m'>0,0 1,0 2,0</data>" END, IMPORT_ERROR_GRAPH, "*: margin meets itself: *"},
        {UNDIRECTED TWO LINES EDGE("a", "a") END, IMPORT_ERROR_GRAPH, "leaf.graphml:3: edge 'a' – 'a' leads back to its own node; *"},
        {UNDIRECTED TWO NODE("c", "0", "1.0000001") LINES EDGE("c", "b") END, IMPORT_ERROR_GRAPH,
         "leaf.graphml:3: edge 'c' – 'b' has no length: both its nodes lie at 0,1; they must lie at least 2e-06 segments apart"},
        {UNDIRECTED TWO EDGE("a", "b") LINES EDGE("b", "a") END, IMPORT_ERROR_GRAPH,
         "leaf.graphml:3: edge 'b' – 'a' joins the same nodes as the edge in line 1; one of them must go"},
        {DIRECTED THREE VEIN("a", "c") LINES EDGE_OF("a", "c", DATA("k", "anastomosis")) END, IMPORT_ERROR_GRAPH,
         "leaf.graphml:3: edge 'a' – 'c' joins the same nodes as the edge in line 1; *"},
        {DIRECTED THREE VEIN("a", "c") LINES VEIN("b", "c") END, IMPORT_ERROR_GRAPH,
         "leaf.graphml:3: node 'c' grows from node 'b' as well as from node 'a' (line 1); veins lead away from the leaf base, *"},
        {DIRECTED THREE VEIN("a", "b") VEIN("b", "c") LINES VEIN("c", "a") END, IMPORT_ERROR_GRAPH,
         "leaf.graphml:3: edge 'c' – 'a': edges of kind vein run in a circle through the nodes 'a', 'c', 'b'; one of them must be an *"},
        {UNDIRECTED THREE VEIN("a", "b") LINES VEIN("b", "c") VEIN("c", "a") END, IMPORT_ERROR_GRAPH,
         "leaf.graphml:3: edge 'c' – 'a': edges of kind vein run in a circle through the nodes 'c', 'b', 'a'; one of them must be an *"},
        {UNDIRECTED LINES "<data key='base'>1</data>" END, IMPORT_ERROR_SYNTAX,
         "leaf.graphml:3: the graph: base is '1'; it must be a point x,y of numbers from -1e9 to 1e9, in segments"},
        {UNDIRECTED LINES "<data key='tip'>1,2 3,4</data>" END, IMPORT_ERROR_SYNTAX, "leaf.graphml:3: the graph: tip is '1,2 3,4'; *"},
        {UNDIRECTED LINES "<data key='tip'>1,2</data><data key='tip'>1,2</data>" END, IMPORT_ERROR_SYNTAX, "*: tip is given a second time"},
        {UNDIRECTED "<data key='base'>1,2</data><data key='tip'>1,2</data>" TWO EDGE("a", "b") END, IMPORT_ERROR_GRAPH,
         "leaf.graphml: the leaf is 0 segments long, from its base at 1,2 to its tip at 1,2; it must be at least 0.001"},
        {UNDIRECTED "<data key='base'>1e9,2</data>" LINES NODE("a", "-1e9", "0") NODE("b", "1e9", "0") EDGE("a", "b") END, IMPORT_ERROR_GRAPH,
         "leaf.graphml:3: node 'a' lies at -2e+09,-2 seen from the leaf base; it must lie within 1e+09"},
        {UNDIRECTED "<data key='m'>0,0 1e-4,2e-4 0,3e-4</data>" NODE("a", "0", "0") NODE("b", "0", "1e-4") EDGE("a", "b") END, IMPORT_ERROR_GRAPH,
         "leaf.graphml: the leaf is 0.0003 segments long, *"},
        {UNDIRECTED "<data key='m'>0,0 50,50 0,100 -50,50</data>" TWO EDGE("a", "b") NODE("c", "0", "60") EDGE("b", "c") LINES NODE("d", "0", "-30")
             EDGE("d", "a") END, IMPORT_ERROR_GRAPH,
         "leaf.graphml:3: node 'd' lies 30 segments outside the margin; in a leaf 100 segments long it must be at most 2 (a petiole is not *"},
        {UNDIRECTED "<data key='m'>0,0 50,50 0,100 -50,50</data>" TWO EDGE("a", "b") LINES NODE("c", "90", "60") NODE("d", "90", "70") EDGE("c", "d")
             END, IMPORT_ERROR_GRAPH, "leaf.graphml:3: node 'c' lies * outside the margin; *"},
        {DIRECTED DATA("s", "4") LINES "<node id='a'><data key='x'>0</data><data key='y'>0</data><data key='t'>0</data></node><node id='b'>"
                                       "<data key='x'>0</data><data key='y'>1</data><data key='t'>5</data></node>" VEIN("a", "b") END,
         IMPORT_ERROR_GRAPH, "leaf.graphml: steps is 4, but the last birth is in step 5; steps must be at least that"},
    };
    for (gsize i = 0; i < G_N_ELEMENTS(cases); i++) {
        GError *error = NULL;
        Network *net = import_graphml_text(cases[i].text, strlen(cases[i].text), "leaf.graphml", &widths, &error);
        g_assert_null(net);
        g_assert_nonnull(error);
        if (error->domain != IMPORT_ERROR || error->code != (int)cases[i].code || !g_pattern_match_simple(cases[i].message, error->message))
            g_error("case %zu: %s\nwanted: %s", i, error->message, cases[i].message);
        g_error_free(error);
        g_assert_null(import_graphml_text(cases[i].text, strlen(cases[i].text), "leaf.graphml", &widths, NULL));
    }
}

/* A ring of veins is told as a walk round it, cut after eight nodes, whether its directions are given or not. */
static void test_rings(void)
{
    enum { N = 13, SHOWN = 8 };
    for (uint32_t step = 0; step < 40; step++) {
        bool directed = step % 2;
        GString *s = g_string_new(directed ? DIRECTED : UNDIRECTED);
        for (uint32_t v = 0; v < N; v++) {
            Vec2 p = place(40, step, v);
            g_string_append_printf(s, "<node id='r%u'><data key='x'>%d</data><data key='y'>%d</data></node>", v, (int)(p.x * 1000),
                                   (int)(p.y * 1000));
        }
        for (uint32_t v = 0; v < N; v++) {
            uint32_t w = (v + 1) % N, turn = !directed && number(41, step, v, 2);
            g_string_append_printf(s, "<edge source='r%u' target='r%u'><data key='k'>vein</data></edge>", turn ? w : v, turn ? v : w);
        }
        g_string_append(s, END);
        GError *error = NULL;
        g_assert_null(import_graphml_text(s->str, s->len, "leaf", &widths, &error));
        g_assert_error(error, IMPORT_ERROR, IMPORT_ERROR_GRAPH);
        const char *at = strstr(error->message, "through the nodes ");
        g_assert_nonnull(at);
        uint32_t walk[SHOWN];
        for (int k = 0; k < SHOWN; k++) {
            at = strstr(at, "'r") + 2;
            walk[k] = (uint32_t)g_ascii_strtoull(at, NULL, 10);
            uint32_t turn = k > 1 ? (walk[1] + N - walk[0]) % N : 0; /* once forwards, always forwards */
            if (k == 1)
                g_assert_true(walk[1] == (walk[0] + 1) % N || walk[0] == (walk[1] + 1) % N);
            if (k > 1)
                g_assert_cmpuint(walk[k], ==, (walk[k - 1] + turn) % N);
        }
        g_assert_nonnull(strstr(at, " and 5 more; one of them must be an anastomosis"));
        g_error_free(error);
        g_string_free(s, TRUE);
    }
}

static void test_long_names(void)
{
    char *name = g_strnfill(500, 'n');
    char *text = g_strdup_printf(UNDIRECTED "<node id='%s&#10;'/>" END, name);
    GError *error = NULL;
    g_assert_null(import_graphml_text(text, strlen(text), "leaf", &widths, &error));
    g_assert_nonnull(strstr(error->message, "node 'nnnnn"));
    g_assert_nonnull(strstr(error->message, "nnn…' has no x"));
    g_assert_cmpuint(strlen(error->message), <, 200);
    g_error_free(error);
    g_free(text);
    g_free(name);
}

static void test_files(void)
{
    GError *error = NULL;
    char *path = in_folder("none.graphml");
    g_assert_null(import_graphml(path, &widths, &error));
    g_assert_error(error, G_FILE_ERROR, G_FILE_ERROR_NOENT);
    g_assert_nonnull(strstr(error->message, path));
    g_clear_error(&error);
    g_assert_null(import_graphml(folder, &widths, &error));
    g_assert_error(error, G_FILE_ERROR, G_FILE_ERROR_ISDIR);
    g_clear_error(&error);
    g_file_set_contents(path, "", 0, NULL);
    g_assert_null(import_graphml(path, &widths, &error));
    g_assert_error(error, IMPORT_ERROR, IMPORT_ERROR_SYNTAX);
    g_clear_error(&error);
    g_file_set_contents(path, KEYS "\n<oops", -1, NULL);
    g_assert_null(import_graphml(path, &widths, &error));
    g_assert_error(error, IMPORT_ERROR, IMPORT_ERROR_SYNTAX);
    char *place = g_strconcat(path, ":2: not well-formed XML: ", NULL);
    g_assert_true(g_str_has_prefix(error->message, place));
    g_free(place);
    g_clear_error(&error);
    g_unlink(path);
    g_free(path);
}

/* A chain of a million nodes, drawn: no recursion, and no more than n log n. Only with -m perf. */
static void test_speed(void)
{
    enum { N = 1000000 };
    for (int drawn = 0; drawn < 2; drawn++) { /* drawn: no kinds */
        Network *net = network_new(N, N - 1);
        for (uint32_t v = 0; v < N; v++) {
            net->node[v] = vec2(v % 1000, v / 1000.0);
            net->node_birth[v] = v;
            if (v > 0) {
                net->tail[v - 1] = v - 1;
                net->head[v - 1] = net->birth[v - 1] = v;
            }
        }
        network_assign_widths(net, &widths);
        net->n_steps = N;
        char *text = written(net);
        char *kind = strstr(text, "attr.name=\"kind\"");
        if (drawn)
            memcpy(kind, "attr.name=\"none\"", strlen("attr.name=\"none\""));
        g_test_timer_start();
        GError *error = NULL;
        Network *back = import_graphml_text(text, strlen(text), "leaf", &widths, &error);
        double seconds = g_test_timer_elapsed();
        g_assert_no_error(error);
        g_test_minimized_result(seconds, "%s: %.2f s, %.0f MB", drawn ? "drawn" : "grown", seconds, (double)strlen(text) / 1e6);
        network_free(back);
        network_free(net);
        g_free(text);
    }
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    folder = g_dir_make_tmp("venation-import-XXXXXX", NULL);
    g_test_add_func("/import/grown", test_grown);
    g_test_add_func("/import/random", test_random);
    g_test_add_func("/import/pieces", test_pieces);
    g_test_add_func("/import/lines", test_lines);
    g_test_add_func("/import/locale", test_locale);
    g_test_add_func("/import/networkx", test_networkx);
    g_test_add_func("/import/drawn", test_drawn);
    g_test_add_func("/import/ties", test_ties);
    g_test_add_func("/import/search", test_search);
    g_test_add_func("/import/undirected", test_undirected);
    g_test_add_func("/import/missing", test_missing);
    g_test_add_func("/import/births", test_births);
    g_test_add_func("/import/vein-numbers", test_vein_numbers);
    g_test_add_func("/import/vein-runs", test_vein_runs);
    g_test_add_func("/import/sorted", test_sorted);
    g_test_add_func("/import/moved", test_moved);
    g_test_add_func("/import/found", test_found);
    g_test_add_func("/import/hand", test_hand);
    g_test_add_func("/import/inside", test_inside);
    g_test_add_func("/import/writing", test_writing);
    g_test_add_func("/import/numbers", test_numbers);
    g_test_add_func("/import/margins", test_margins);
    g_test_add_func("/import/errors", test_errors);
    g_test_add_func("/import/rings", test_rings);
    g_test_add_func("/import/long-names", test_long_names);
    g_test_add_func("/import/files", test_files);
    if (g_test_perf())
        g_test_add_func("/import/speed", test_speed);
    int result = g_test_run();
    g_rmdir(folder);
    g_free(folder);
    return result;
}
