/* Drawn veins as networks: made drawings whose networks are known, and random ones against invariants and a brute-force twin. */
#include <glib.h>
#include <string.h>

#include "geom/random.h"
#include "geom/segment.h"
#include "sim/drawing.h"

enum { NONE = UINT32_MAX };

/* A lens from 0,0 to 0,1, 0.6 wide. */
static Polygon *blade(void)
{
    enum { N = 60 };
    Vec2 v[2 * N];
    for (int i = 0; i < N; i++) {
        double t = (double)i / N;
        v[i] = vec2(1.2 * t * (1.0 - t), t);
        v[N + i] = vec2(-1.2 * t * (1.0 - t), 1.0 - t);
    }
    return polygon_new(v, 2 * N);
}

static double uniform(uint32_t a, uint32_t b)
{
    double u[2];
    random_pair(5, a, 0, b, u);
    return u[0];
}

#define ADD(d, order, name, ...) \
    drawing_add(d, (const Vec2[]){__VA_ARGS__}, NULL, sizeof((Vec2[]){__VA_ARGS__}) / sizeof(Vec2), order, name)

/* ---- what holds for every network ---- */

typedef struct {
    uint32_t *entry; /* [n_nodes] */
    uint32_t first, anastomoses;
} Facts;

static uint32_t out_degree(const Network *n, uint32_t v)
{
    uint32_t k = 0;
    for (uint32_t e = 0; e < n->n_edges; e++)
        k += n->tail[e] == v && n->kind[e] == EDGE_VEIN;
    return k;
}

static uint32_t degree(const Network *n, uint32_t v)
{
    uint32_t k = 0;
    for (uint32_t e = 0; e < n->n_edges; e++)
        k += n->tail[e] == v || n->head[e] == v;
    return k;
}

static uint32_t count_ends(const Network *n)
{
    uint32_t k = 0;
    for (uint32_t v = 0; v < n->n_nodes; v++)
        k += degree(n, v) == 1;
    return k;
}

static uint32_t nearest_node(const Network *n, Vec2 p)
{
    uint32_t best = 0;
    for (uint32_t v = 1; v < n->n_nodes; v++)
        if (vec_dist2(n->node[v], p) < vec_dist2(n->node[best], p))
            best = v;
    return best;
}

static void check_veins(const Network *n, const uint32_t *entry)
{
    uint32_t *edges = g_new0(uint32_t, n->n_veins), *starts = g_new0(uint32_t, n->n_veins);
    for (uint32_t e = 0; e < n->n_edges; e++) {
        uint32_t vein = n->vein[e], before = entry[n->tail[e]];
        g_assert_cmpuint(vein, <, n->n_veins);
        edges[vein]++;
        bool goes_on = before != NONE && n->vein[before] == vein && n->kind[e] == EDGE_VEIN;
        starts[vein] += !goes_on;
        if (goes_on)
            g_assert_cmpuint(n->order[e], ==, n->order[before]);
    }
    for (uint32_t k = 0; k < n->n_veins; k++) {
        g_assert_cmpuint(edges[k], >, 0);
        g_assert_cmpuint(starts[k], ==, 1); /* one run */
    }
    g_free(edges);
    g_free(starts);
}

static Facts check(const Network *n)
{
    Facts f = {.entry = g_new(uint32_t, n->n_nodes)};
    for (uint32_t v = 0; v < n->n_nodes; v++)
        f.entry[v] = NONE;
    GHashTable *pairs = g_hash_table_new_full(g_int64_hash, g_int64_equal, g_free, NULL);
    for (uint32_t e = 0; e < n->n_edges; e++) {
        g_assert_cmpuint(n->tail[e], <, n->head[e]);
        g_assert_cmpuint(n->head[e], <, n->n_nodes);
        double length = vec_dist(n->node[n->tail[e]], n->node[n->head[e]]);
        g_assert_cmpfloat(length, <=, 1.0 + 1e-8);
        g_assert_cmpfloat(length, >=, 2e-6);
        g_assert_true(n->order[e] >= 1 && n->rank[e] >= 1 && n->width[e] > 0.0 && n->flow[e] > 0.0);
        g_assert_cmpuint(n->birth[e], ==, MAX(n->node_birth[n->head[e]], n->node_birth[n->tail[e]]));
        g_assert_cmpuint(n->birth[e], <=, n->n_steps);
        gint64 *pair = g_new(gint64, 1);
        *pair = (gint64)n->tail[e] << 32 | n->head[e];
        g_assert_true(g_hash_table_add(pairs, pair));
        if (n->kind[e] != EDGE_VEIN) {
            f.anastomoses++;
            continue;
        }
        g_assert_cmpuint(f.anastomoses, ==, 0); /* these come last */
        g_assert_cmpuint(f.entry[n->head[e]], ==, NONE);
        f.entry[n->head[e]] = e;
        g_assert_cmpuint(n->node_birth[n->head[e]], ==, n->node_birth[n->tail[e]] + 1);
    }
    g_hash_table_unref(pairs);
    for (uint32_t v = 0; v < n->n_nodes; v++) {
        f.first += f.entry[v] == NONE;
        g_assert_cmpuint(degree(n, v), >, 0);
        g_assert_true(f.entry[v] != NONE || n->node_birth[v] == 0);
        g_assert_cmpfloat(polygon_depth(n->margin, n->node[v]), >=, -1.0);
    }
    check_veins(n, f.entry);
    return f;
}

static Network *make(const Drawing *d, const DrawingDef *def)
{
    GError *error = NULL;
    DrawingDef plain = drawing_def_default();
    Polygon *leaf = blade();
    Network *n = drawing_network(d, leaf, def ? def : &plain, &error);
    g_assert_no_error(error);
    polygon_free(leaf);
    g_free(check(n).entry);
    return n;
}

static uint32_t parts(const Network *n)
{
    Facts f = check(n);
    g_free(f.entry);
    return f.first;
}

static uint32_t loops(const Network *n)
{
    Facts f = check(n);
    g_free(f.entry);
    g_assert_cmpuint(f.anastomoses, ==, n->n_edges + f.first - n->n_nodes);
    return f.anastomoses;
}

/* Both lead from the base in whatever order: the same places. */
static void assert_same_places(const Network *a, const Network *b)
{
    g_assert_cmpuint(a->n_nodes, ==, b->n_nodes);
    g_assert_cmpuint(a->n_edges, ==, b->n_edges);
    for (uint32_t v = 0; v < a->n_nodes; v++)
        g_assert_cmpfloat(vec_dist(a->node[v], b->node[nearest_node(b, a->node[v])]), <, 1e-6);
}

static void assert_equal(const Network *a, const Network *b)
{
    g_assert_cmpuint(a->n_nodes, ==, b->n_nodes);
    g_assert_cmpuint(a->n_edges, ==, b->n_edges);
    g_assert_true(!memcmp(a->node, b->node, a->n_nodes * sizeof *a->node));
    g_assert_true(!memcmp(a->tail, b->tail, a->n_edges * sizeof *a->tail));
    g_assert_true(!memcmp(a->head, b->head, a->n_edges * sizeof *a->head));
    g_assert_true(!memcmp(a->vein, b->vein, a->n_edges * sizeof *a->vein));
    g_assert_true(!memcmp(a->order, b->order, a->n_edges * sizeof *a->order));
    g_assert_true(!memcmp(a->width, b->width, a->n_edges * sizeof *a->width));
}

/* ---- made drawings ---- */

static void test_midrib(void)
{
    Drawing *d = drawing_new();
    ADD(d, 1, NULL, {0, 0}, {0, 0.995});
    Network *n = make(d, NULL);
    g_assert_cmpuint(n->n_nodes, ==, 101);
    g_assert_cmpuint(n->n_veins, ==, 1);
    for (uint32_t v = 0; v < n->n_nodes; v++) {
        g_assert_cmpfloat_with_epsilon(n->node[v].x, 0.0, 1e-9);
        g_assert_cmpfloat_with_epsilon(n->node[v].y, 0.995 * v, 1e-9);
    }
    g_assert_cmpfloat_with_epsilon(n->margin->box.y1, 100.0, 1e-9);
    g_assert_cmpuint(n->n_steps, ==, 100);
    network_free(n);
    drawing_free(d);
}

static void add_reversed(Drawing *d, const Drawing *of, bool (*reverse)(uint32_t))
{
    for (uint32_t k = 0; k < of->n; k++) {
        DrawnVein *v = drawing_add(d, of->vein[k].point, of->vein[k].width, of->vein[k].n, of->vein[k].order, of->vein[k].name);
        for (uint32_t i = 0; i < v->n && reverse(k); i++) {
            v->point[i] = of->vein[k].point[v->n - 1 - i];
            v->width[i] = of->vein[k].width[v->n - 1 - i];
        }
    }
}

static bool every(uint32_t k) { return true; }
static bool odd(uint32_t k) { return k % 2; }

/* A midrib from below the base; secondaries that miss it by 4 pixels of a thousand, touch it, and overshoot it by as much. */
static Drawing *pinnate(uint8_t primary, uint8_t secondary)
{
    Drawing *d = drawing_new();
    ADD(d, primary, "path 'midrib'", {0, -0.01}, {0, 0.5}, {0, 0.96});
    for (int i = 0; i < 9; i++) {
        double y = 0.1 + 0.08 * i, reach = 0.5 * 1.2 * y * (1 - y), start = 0.004 * (i % 3 - 1);
        ADD(d, secondary, NULL, {start, y + start}, {0.5 * reach, y + 0.5 * reach}, {reach, y + 0.9 * reach});
        ADD(d, secondary, NULL, {-reach, y + 0.04 + 0.9 * reach}, {-0.5 * reach, y + 0.04 + 0.5 * reach}, {-start, y + 0.04 + start});
    }
    return d;
}

static void test_pinnate(void)
{
    Drawing *d = pinnate(1, 2);
    Network *n = make(d, NULL);
    g_assert_cmpuint(parts(n), ==, 1);
    g_assert_cmpuint(loops(n), ==, 0);
    g_assert_cmpuint(count_ends(n), ==, 20); /* no stubs */
    g_assert_cmpuint(n->n_veins, ==, 19);
    g_assert_cmpfloat(vec_dist(n->node[0], vec2(0, 0)), <, 1e-6); /* cut off at the margin */
    uint32_t branchings = 0;
    for (uint32_t v = 0; v < n->n_nodes; v++)
        if (out_degree(n, v) == 2) {
            branchings++;
            g_assert_cmpfloat_with_epsilon(n->node[v].x, 0.0, 1e-6);
        }
    g_assert_cmpuint(branchings, ==, 18);
    for (uint32_t e = 0; e < n->n_edges; e++)
        g_assert_cmpuint(n->order[e], ==, fabs(n->node[n->head[e]].x) < 1e-6 ? 1 : 2);
    network_free(n);
    drawing_free(d);
}

static void test_directions(void)
{
    bool (*const reverse[])(uint32_t) = {every, odd};
    for (int k = 0; k < 2; k++)
        for (int o = 0; o < 2; o++) {
            Drawing *d = pinnate(o ? 1 : 0, o ? 2 : 0), *r = drawing_new();
            add_reversed(r, d, reverse[k]);
            Network *a = make(d, NULL), *b = make(r, NULL);
            assert_same_places(a, b);
            g_assert_cmpuint(a->n_veins, ==, b->n_veins);
            network_free(a);
            network_free(b);
            drawing_free(d);
            drawing_free(r);
        }
}

/* Without orders they are made: the midrib is the primary, what leaves it secondary. */
static void test_orders_made(void)
{
    Drawing *d = pinnate(0, 0);
    Network *n = make(d, NULL);
    for (uint32_t e = 0; e < n->n_edges; e++)
        g_assert_cmpuint(n->order[e], ==, fabs(n->node[n->head[e]].x) < 1e-6 ? 1 : 2);
    g_assert_cmpuint(n->n_veins, ==, 19);
    network_free(n);
    drawing_free(d);
}

/* A vein drawn in one stroke is of one order, though a branch of it may branch more than what follows. */
static void test_orders_stroke(void)
{
    Drawing *d = drawing_new();
    ADD(d, 0, NULL, {0, 0}, {0, 0.9});
    ADD(d, 0, NULL, {0, 0.3}, {0.2, 0.4});
    ADD(d, 0, NULL, {0.06, 0.33}, {0.1, 0.55});
    for (int i = 0; i < 3; i++)
        ADD(d, 0, NULL, {0.08, 0.44 + 0.02 * i}, {0.03, 0.47 + 0.02 * i});
    Network *n = make(d, NULL);
    const struct {
        Vec2 at;
        uint8_t order;
    } is[] = {{{0, 0.85}, 1}, {{0.03, 0.315}, 2}, {{0.19, 0.395}, 2}, {{0.0636, 0.35}, 3}, {{0.098, 0.54}, 3}, {{0.034, 0.466}, 4}};
    Facts f = check(n);
    for (gsize k = 0; k < G_N_ELEMENTS(is); k++)
        g_assert_cmpuint(n->order[f.entry[nearest_node(n, vec_scale(is[k].at, 100))]], ==, is[k].order);
    g_assert_cmpuint(n->n_veins, ==, 6);
    g_free(f.entry);
    network_free(n);
    drawing_free(d);
}

/* What is labelled stays, what leaves it is one order higher; and a label that no rule would give stays too. */
static void test_orders_partly(void)
{
    Drawing *d = drawing_new();
    ADD(d, 1, NULL, {0, 0}, {0, 0.5}); /* short: by branches the other would be the primary */
    ADD(d, 0, NULL, {0, 0.2}, {0.15, 0.6});
    ADD(d, 0, NULL, {0.075, 0.4}, {0.14, 0.45});
    ADD(d, 0, NULL, {0.1125, 0.5}, {0.07, 0.6});
    ADD(d, 4, NULL, {0, 0.3}, {-0.15, 0.5});
    ADD(d, 0, NULL, {-0.075, 0.4}, {-0.15, 0.41});
    Network *n = make(d, NULL);
    const struct {
        Vec2 at;
        uint8_t order;
    } is[] = {{{0, 0.1}, 1}, {{0, 0.45}, 1}, {{0.0375, 0.3}, 2}, {{0.14, 0.573}, 2}, {{0.11, 0.428}, 3}, {{0.09, 0.5535}, 3}, {{-0.03, 0.34}, 4},
              {{-0.13, 0.473}, 4}, {{-0.12, 0.406}, 5}};
    Facts f = check(n);
    for (gsize k = 0; k < G_N_ELEMENTS(is); k++) {
        uint32_t v = nearest_node(n, vec_scale(is[k].at, 100));
        g_assert_cmpfloat(vec_dist(n->node[v], vec_scale(is[k].at, 100)), <, 1.0);
        g_assert_cmpuint(n->order[f.entry[v]], ==, is[k].order);
    }
    g_free(f.entry);
    network_free(n);
    drawing_free(d);
}

static void test_widths(void)
{
    Drawing *d = drawing_new();
    const Vec2 mid[] = {{0, 0}, {0, 0.3}, {0, 0.9}}, side[] = {{0.2, 0.5}, {0, 0.3}};
    const double taper[] = {0.04, 0.0, 0.01}, even[] = {0.008, 0.008};
    drawing_add(d, mid, taper, 3, 1, NULL);
    drawing_add(d, side, even, 2, 2, NULL);
    ADD(d, 2, NULL, {0, 0.5}, {-0.2, 0.6});
    Network *n = make(d, NULL);
    for (uint32_t e = 0; e < n->n_edges; e++) {
        Vec2 m = vec_lerp(n->node[n->tail[e]], n->node[n->head[e]], 0.5);
        if (fabs(m.x) < 1e-6) /* the middle one is unknown, and filled in between the pieces that it parts */
            g_assert_cmpfloat_with_epsilon(n->width[e], 4.0 - 3.0 * m.y / 90.0, 1e-6);
        else if (m.x > 0.0)
            g_assert_cmpfloat_with_epsilon(n->width[e], 0.8, 1e-9);
        else
            g_assert_cmpfloat_with_epsilon(n->width[e], 0.5, 1e-9); /* made: a veinlet */
        g_assert_cmpuint(n->rank[e], ==, fabs(m.x) < 1e-6 ? 1 : n->rank[e]);
        g_assert_cmpuint(n->rank[e], >=, fabs(m.x) < 1e-6 ? 1 : 2);
    }
    network_free(n);
    drawing_free(d);
}

/* What is not drawn is no wider than what it leaves. */
static void test_thin(void)
{
    Drawing *d = drawing_new();
    const Vec2 mid[] = {{0, 0}, {0, 0.9}};
    const double thin[] = {0.001, 0.001};
    drawing_add(d, mid, thin, 2, 0, NULL);
    ADD(d, 0, NULL, {0, 0.3}, {-0.2, 0.4});
    Network *n = make(d, NULL);
    for (uint32_t e = 0; e < n->n_edges; e++)
        g_assert_cmpfloat(fabs(n->width[e] - 0.1), <, 1e-9);
    network_free(n);
    drawing_free(d);
}

/* An arch joins two secondaries: a loop, closed by an edge of the arch, the finer vein. */
static void test_loop(void)
{
    for (uint8_t named = 0; named < 2; named++) {
        Drawing *d = drawing_new();
        ADD(d, named ? 3 : 0, NULL, {0.1, 0.301}, {0.14, 0.38}, {0.1, 0.499});
        ADD(d, named ? 1 : 0, NULL, {0, 0.9}, {0, 0.0});
        ADD(d, named ? 2 : 0, NULL, {0, 0.3}, {0.2, 0.3});
        ADD(d, named ? 2 : 0, NULL, {0, 0.5}, {0.2, 0.5});
        Network *n = make(d, NULL);
        g_assert_cmpuint(parts(n), ==, 1);
        g_assert_cmpuint(loops(n), ==, 1);
        g_assert_cmpuint(count_ends(n), ==, 4);
        uint32_t e = n->n_edges - 1;
        double y = 0.5 * (n->node[n->tail[e]].y + n->node[n->head[e]].y);
        g_assert_true(n->kind[e] == EDGE_ANASTOMOSIS && y > 30.0 && y < 50.0);
        g_assert_cmpfloat(fabs(y - 40.0), >, 8.0); /* its end, not its middle */
        if (named)
            g_assert_cmpuint(n->order[e], ==, 3);
        network_free(n);
        drawing_free(d);
    }
}

/* A secondary that bends up and ends on the next one: that one still comes from the midrib, whole. */
static void test_arcs(void)
{
    Drawing *d = drawing_new();
    ADD(d, 0, NULL, {0, 0.0}, {0, 0.9});
    ADD(d, 0, NULL, {0, 0.2}, {0.15, 0.3}, {0.16, 0.42}, {0.1, 0.52});
    ADD(d, 0, NULL, {0, 0.4}, {0.2, 0.64});
    Network *n = make(d, NULL);
    Facts f = check(n);
    g_assert_cmpuint(f.anastomoses, ==, 1);
    uint32_t out = nearest_node(n, vec2(18, 61.6)), in = nearest_node(n, vec2(5, 46));
    g_assert_cmpuint(n->vein[f.entry[out]], ==, n->vein[f.entry[in]]);
    uint32_t e = n->n_edges - 1;
    g_assert_cmpfloat(vec_dist(vec_lerp(n->node[n->tail[e]], n->node[n->head[e]], 0.5), vec2(10, 52)), <, 1.0);
    g_free(f.entry);
    network_free(n);
    drawing_free(d);
}

static void test_crossing(void)
{
    Drawing *d = drawing_new();
    ADD(d, 1, NULL, {0, 0}, {0, 0.9});
    ADD(d, 2, NULL, {-0.173, 0.41}, {0.19, 0.537});
    Network *n = make(d, NULL);
    double y = 100 * (0.41 + (0.537 - 0.41) * 0.173 / 0.363);
    uint32_t v = nearest_node(n, vec2(0, y));
    g_assert_cmpfloat(vec_dist(n->node[v], vec2(0, y)), <, 1e-9);
    g_assert_cmpuint(degree(n, v), ==, 4);
    g_assert_cmpuint(loops(n), ==, 0);
    g_assert_cmpuint(n->n_veins, ==, 3); /* it leaves the midrib to both sides */
    network_free(n);
    drawing_free(d);
}

static void test_snap(void)
{
    const double miss[] = {0.0, 0.003, 0.014, 0.016};
    for (gsize k = 0; k < G_N_ELEMENTS(miss); k++)
        for (int way = 0; way < 2; way++) {
            DrawingDef def = drawing_def_default();
            def.gap = 0.0;
            Drawing *d = drawing_new();
            Vec2 a = vec2(miss[k], 0.4), b = vec2(0.15, 0.5);
            ADD(d, 0, NULL, {0, 0.1}, {0, 0.9});
            ADD(d, 0, NULL, way ? a : b, way ? b : a);
            Network *n = make(d, &def);
            g_assert_cmpuint(parts(n), ==, miss[k] > def.snap ? 2 : 1);
            g_assert_cmpuint(degree(n, nearest_node(n, vec2(0, 40))), ==, miss[k] > def.snap ? 2 : 3);
            if (miss[k] <= def.snap)
                g_assert_cmpfloat(vec_dist(n->node[nearest_node(n, vec2(0, 40))], vec2(0, 40)), <, 1e-6);
            network_free(n);
            drawing_free(d);
        }
}

/* A midrib in two parts, with a gap between them, or overlapping: one vein, no stubs. */
static void test_two_parts(void)
{
    const double start[] = {0.41, 0.4, 0.396, 0.393};
    for (gsize k = 0; k < G_N_ELEMENTS(start); k++)
        for (int side = 0; side < 2; side++) {
            Drawing *d = drawing_new();
            ADD(d, 1, NULL, {0, 0}, {0, 0.4});
            ADD(d, 1, NULL, {0.006 * side, start[k]}, {0, 0.9});
            Network *n = make(d, NULL);
            g_assert_cmpuint(parts(n), ==, 1);
            g_assert_cmpuint(loops(n), ==, 0);
            g_assert_cmpuint(count_ends(n), ==, 2);
            g_assert_cmpuint(n->n_veins, ==, 1);
            network_free(n);
            drawing_free(d);
        }
}

/* Overlapping by so much that a stub stays: it closes no loop. */
static void test_overlap(void)
{
    Drawing *d = drawing_new();
    ADD(d, 1, NULL, {0, 0}, {0, 0.4});
    ADD(d, 1, NULL, {0.006, 0.388}, {0.006, 0.9});
    Network *n = make(d, NULL);
    g_assert_cmpuint(parts(n), ==, 1);
    g_assert_cmpuint(loops(n), ==, 0);
    network_free(n);
    drawing_free(d);
}

/* Opposite secondaries that leave the midrib within a hair leave it at one node. */
static void test_opposite(void)
{
    Drawing *d = drawing_new();
    ADD(d, 1, NULL, {0, 0}, {0, 0.9});
    ADD(d, 2, NULL, {0, 0.4}, {0.2, 0.5});
    ADD(d, 2, NULL, {0.003, 0.399}, {-0.2, 0.5});
    Network *n = make(d, NULL);
    g_assert_cmpuint(degree(n, nearest_node(n, vec2(0, 40))), ==, 4);
    network_free(n);
    drawing_free(d);
}

/* The midrib's beginning lies a little farther from the base than what follows. */
static void test_hook(void)
{
    Drawing *d = drawing_new();
    ADD(d, 1, NULL, {0, 0.9}, {0, 0.0145}, {0.009, 0.015});
    Network *n = make(d, NULL);
    g_assert_cmpfloat(vec_dist(n->node[0], vec2(0.9, 1.5)), <, 1e-6);
    g_assert_cmpuint(parts(n), ==, 1);
    g_assert_cmpuint(n->n_veins, ==, 1);
    network_free(n);
    drawing_free(d);
}

static void test_gap(void)
{
    const double gap[] = {0.02, 0.048, 0.056};
    for (gsize k = 0; k < G_N_ELEMENTS(gap); k++) {
        Drawing *d = drawing_new();
        ADD(d, 1, NULL, {0, 0}, {0, 0.9});
        ADD(d, 2, NULL, {gap[k], 0.4}, {0.18, 0.5});
        ADD(d, 3, NULL, {0.1, 0.4556}, {0.18, 0.42}); /* hangs on to it */
        ADD(d, 2, NULL, {-0.15, 0.5}, {-0.1, 0.45}, {-gap[k] - 0.02, 0.5}); /* with a bend */
        Network *n = make(d, NULL);
        g_assert_cmpuint(parts(n), ==, k == 0 ? 1 : k == 1 ? 2 : 3);
        g_assert_cmpuint(loops(n), ==, 0);
        network_free(n);
        drawing_free(d);
    }
}

/* A detached vein reaches the midrib through another one; no bridge leads over the outside. */
static void test_gap_chain(void)
{
    Drawing *d = drawing_new();
    ADD(d, 1, NULL, {0, 0}, {0, 0.9});
    ADD(d, 2, NULL, {0.04, 0.5}, {0.1, 0.5});
    ADD(d, 2, NULL, {0.14, 0.5}, {0.2, 0.5});
    Network *n = make(d, NULL);
    g_assert_cmpuint(parts(n), ==, 1);
    network_free(n);
    drawing_free(d);

    /* two lobes with a notch of 0.04 between them */
    const Vec2 lobes[] = {{0, 0}, {0.3, 0}, {0.3, 1}, {0.02, 1}, {0, 0.3}, {-0.02, 1}, {-0.3, 1}, {-0.3, 0}};
    Polygon *leaf = polygon_new(lobes, G_N_ELEMENTS(lobes));
    d = drawing_new();
    DrawingDef def = drawing_def_default();
    ADD(d, 1, NULL, {0.1, 0.01}, {0.1, 0.9});
    ADD(d, 1, NULL, {0.1, 0.8}, {0.025, 0.9});
    ADD(d, 1, NULL, {-0.023, 0.9}, {-0.1, 0.8});
    n = drawing_network(d, leaf, &def, NULL);
    g_assert_cmpuint(parts(n), ==, 2);
    network_free(n);
    drawing_free(d);
    polygon_free(leaf);
}

static void test_duplicates(void)
{
    Drawing *d = pinnate(1, 2), *twice = drawing_new();
    add_reversed(twice, d, odd);
    Network *plain = make(twice, NULL);
    add_reversed(twice, d, odd);
    Network *n = make(twice, NULL);
    assert_equal(plain, n);
    network_free(n);
    drawing_free(twice);

    twice = drawing_new(); /* not quite on top of one another, and a part of the midrib once more */
    add_reversed(twice, d, odd);
    for (uint32_t k = 0; k < d->n; k++) {
        DrawnVein *v = drawing_add(twice, d->vein[k].point, NULL, d->vein[k].n, d->vein[k].order, NULL);
        for (uint32_t i = 0; i < v->n; i++)
            v->point[i].x += 0.002;
    }
    ADD(twice, 2, NULL, {0.001, 0.3}, {-0.001, 0.4}, {0.001, 0.5}, {0.1, 0.6});
    n = make(twice, NULL);
    g_assert_cmpuint(parts(n), ==, 1);
    g_assert_cmpuint(loops(n), <=, 1); /* the last one may close one with the secondaries it crosses */
    g_assert_cmpuint(n->n_nodes, <, plain->n_nodes + 25);
    network_free(n);
    network_free(plain);
    drawing_free(twice);
    drawing_free(d);
}

static void test_ring(void)
{
    Drawing *d = drawing_new();
    ADD(d, 1, NULL, {0, 0}, {0, 0.9});
    ADD(d, 2, NULL, {0, 0.4}, {0.06, 0.45}, {0.12, 0.4}, {0.06, 0.35}, {0, 0.4});
    ADD(d, 2, NULL, {0, 0.7}, {-0.06, 0.75}, {-0.12, 0.7}, {-0.06, 0.65}, {-0.06, 0.752}); /* crosses itself */
    Network *n = make(d, NULL);
    g_assert_cmpuint(parts(n), ==, 1);
    g_assert_cmpuint(loops(n), ==, 2);
    g_assert_cmpuint(count_ends(n), ==, 2);
    network_free(n);
    drawing_free(d);
}

static void test_nothings(void)
{
    Drawing *d = pinnate(1, 2);
    Network *plain = make(d, NULL);
    ADD(d, 2, NULL, {0.1, 0.5}, {0.1, 0.5});
    ADD(d, 2, NULL, {0.1, 0.6}, {0.1, 0.6}, {0.1, 0.6}, {0.1, 0.6});
    ADD(d, 2, NULL, {0.1, 0.55}, {0.1005, 0.55});
    ADD(d, 2, NULL, {0.001, 0.475}, {0.001, 0.485}); /* a dash on the midrib */
    Network *n = make(d, NULL);
    assert_equal(plain, n);
    network_free(n);
    network_free(plain);
    drawing_free(d);
}

static char *failure(const Drawing *d, const DrawingDef *def, DrawingErrorCode code)
{
    GError *error = NULL;
    Polygon *leaf = blade();
    g_assert_null(drawing_network(d, leaf, def, &error));
    g_assert_error(error, DRAWING_ERROR, (int)code);
    char *message = g_strdup(error->message);
    g_error_free(error);
    polygon_free(leaf);
    return message;
}

static void assert_in(char *message, const char *const *words)
{
    for (; *words; words++)
        if (!strstr(message, *words))
            g_error("'%s' does not say '%s'", message, *words);
    g_free(message);
}

#define SAYS(message, ...) assert_in(message, (const char *const[]){__VA_ARGS__, NULL})

static void test_outside(void)
{
    DrawingDef def = drawing_def_default();
    def.where = "leaf.svg";
    Drawing *d = pinnate(1, 2);
    DrawnVein *v = ADD(d, 2, "path 'far'", {0, 0.5}, {0.35, 0.5});
    SAYS(failure(d, &def, DRAWING_ERROR_OUTSIDE), "leaf.svg", "path 'far'", "0.05 leaf", "at 0.35,0.5", "0.015");
    g_free(v->name);
    v->name = NULL;
    SAYS(failure(d, &def, DRAWING_ERROR_OUTSIDE), "vein 20");
    v->point[1].x = NAN;
    SAYS(failure(d, &def, DRAWING_ERROR_OUTSIDE), "vein 20", "point 2");
    v->point[1].x = 0.312; /* sticks out a little */
    Network *n = make(d, NULL);
    double most = 0.0;
    for (uint32_t i = 0; i < n->n_nodes; i++)
        most = MAX(most, n->node[i].x);
    g_assert_cmpfloat_with_epsilon(most, 30.0, 1e-6);
    network_free(n);
    drawing_free(d);

    /* across a bay, its vertices inside */
    const Vec2 bay[] = {{0, 0}, {0.3, 0}, {0.3, 0.2}, {0.05, 0.25}, {0.3, 0.3}, {0.3, 1}, {-0.3, 1}, {-0.3, 0}};
    Polygon *leaf = polygon_new(bay, G_N_ELEMENTS(bay));
    d = drawing_new();
    ADD(d, 0, NULL, {0.25, 0.1}, {0.25, 0.4});
    GError *error = NULL;
    g_assert_null(drawing_network(d, leaf, &def, &error));
    g_assert_error(error, DRAWING_ERROR, DRAWING_ERROR_OUTSIDE);
    g_error_free(error);
    polygon_free(leaf);
    drawing_free(d);
}

/* A vein drawn along the margin, now on this side, now on that, stays one vein. */
static void test_along_margin(void)
{
    Drawing *d = drawing_new();
    Vec2 p[81];
    for (int i = 0; i <= 80; i++) {
        double t = 0.1 + 0.01 * i;
        p[i] = vec2(1.2 * t * (1 - t) + (i % 20 < 10 ? 0.008 : -0.004), t);
    }
    drawing_add(d, p, NULL, 81, 2, NULL);
    ADD(d, 1, NULL, {0, 0}, {0, 0.98});
    ADD(d, 2, NULL, {0, 0.4}, {0.31, 0.45});
    Network *n = make(d, NULL);
    g_assert_cmpuint(parts(n), ==, 1);
    g_assert_cmpuint(count_ends(n), ==, 4);
    Vec2 start = polygon_nearest(n->margin, vec_scale(p[0], 100), NULL); /* the long piece outside is not cut off */
    g_assert_cmpfloat(vec_dist(n->node[nearest_node(n, start)], start), <, 0.5);
    network_free(n);
    drawing_free(d);
}

static void test_bad(void)
{
    Drawing *d = drawing_new();
    DrawingDef def = drawing_def_default();
    SAYS(failure(d, &def, DRAWING_ERROR_EMPTY), "drawing", "no vein");
    ADD(d, 1, NULL, {0, 0.5}, {0, 0.5});
    SAYS(failure(d, &def, DRAWING_ERROR_EMPTY), "no vein");
    ADD(d, 1, NULL, {0, 0.1}, {0, 0.9});
    const struct {
        double length, snap, gap;
        const char *name;
    } bad[] = {{0, 0, 0, "length"}, {-1, 0, 0, "length"}, {NAN, 0, 0, "length"}, {100, -0.1, 0, "snap"}, {100, NAN, 0, "snap"},
               {100, 0, -1, "gap"}, {100, 0, INFINITY, "gap"}, {1e9, 0, 0, "length"}};
    for (gsize k = 0; k < G_N_ELEMENTS(bad); k++) {
        def.length = bad[k].length;
        def.snap = bad[k].snap;
        def.gap = bad[k].gap;
        SAYS(failure(d, &def, DRAWING_ERROR_VALUE), bad[k].name);
    }
    def = drawing_def_default(); /* none, and enormous: odd, but allowed */
    def.snap = def.gap = 0.0;
    Network *n = make(d, &def);
    network_free(n);
    ADD(d, 1, NULL, {0.1, 0.3}, {0.1, 0.4});
    def.snap = def.gap = 10.0;
    n = make(d, &def);
    network_free(n);
    def.length = 0.01; /* all of it shorter than the least */
    SAYS(failure(d, &def, DRAWING_ERROR_EMPTY), "no vein");
    drawing_free(d);
}

static void test_to_leaf(void)
{
    Drawing *d = drawing_new();
    const Vec2 p[] = {{10, 20}, {30, 20}, {20, 30}};
    const double w[] = {2, 4, 6};
    drawing_add(d, p, w, 3, 0, "x");
    drawing_to_leaf(d, vec2(10, 20), vec2(30, 20)); /* the tip to the right: turns a quarter left */
    const Vec2 is[] = {{0, 0}, {0, 1}, {-0.5, 0.5}};
    for (int i = 0; i < 3; i++) {
        g_assert_cmpfloat_with_epsilon(d->vein[0].point[i].x, is[i].x, 1e-15);
        g_assert_cmpfloat_with_epsilon(d->vein[0].point[i].y, is[i].y, 1e-15);
        g_assert_cmpfloat_with_epsilon(d->vein[0].width[i], w[i] / 20, 1e-15);
    }
    drawing_free(d);
    drawing_free(NULL);
}

/* ---- random drawings ---- */

static Vec2 random_place(uint32_t seed, uint32_t k)
{
    double y = 0.05 + 0.9 * uniform(seed, 2 * k), x = 1.2 * y * (1 - y) * (2 * uniform(seed, 2 * k + 1) - 1);
    return vec2(0.98 * x, y);
}

/* Nothing that a person would draw. */
static void test_random(void)
{
    for (uint32_t seed = 1000; seed < 1400; seed++) {
        Drawing *d = drawing_new();
        uint32_t n_veins = 1 + (uint32_t)(12 * uniform(seed, 900)), k = 0;
        DrawingDef def = drawing_def_default();
        def.length = seed % 5 ? 10 + 100 * uniform(seed, 901) : 3.0;
        def.snap = seed % 3 ? 0.03 * uniform(seed, 902) : 0.0;
        def.gap = seed % 7 ? 0.1 * uniform(seed, 903) : 0.0;
        for (uint32_t i = 0; i < n_veins; i++) {
            Vec2 p[12];
            double w[12];
            uint32_t n = 2 + (uint32_t)(10 * uniform(seed, 904 + i));
            for (uint32_t j = 0; j < n; j++, k++) {
                bool again = k > 5 && uniform(seed, 2000 + k) < 0.3;
                p[j] = random_place(seed, again ? k / 3 : k); /* places that were there before */
                w[j] = uniform(seed, 3000 + k) < 0.5 ? 0.0 : 0.02 * uniform(seed, 4000 + k);
            }
            drawing_add(d, p, i % 2 ? w : NULL, n, (uint8_t)(seed % 2 ? 0 : 4 * uniform(seed, 5000 + i)), NULL);
        }
        Network *a = make(d, &def), *b = make(d, &def);
        assert_equal(a, b);
        loops(a);
        network_free(a);
        network_free(b);
        drawing_free(d);
    }
}

static bool lines_cross(Vec2 a, Vec2 b, Vec2 c, Vec2 d)
{
    double p = vec_cross(vec_sub(b, a), vec_sub(c, a)), q = vec_cross(vec_sub(b, a), vec_sub(d, a));
    double r = vec_cross(vec_sub(d, c), vec_sub(a, c)), s = vec_cross(vec_sub(d, c), vec_sub(b, c));
    return (p < 0) != (q < 0) && (r < 0) != (s < 0);
}

/* Straight veins: how many parts there are, by trying all pairs. False where a hair would decide. */
static bool count_parts(const Drawing *d, double snap, uint32_t *count)
{
    uint32_t part[40];
    for (uint32_t i = 0; i < d->n; i++)
        part[i] = i;
    *count = d->n;
    for (uint32_t i = 0; i < d->n; i++)
        for (uint32_t j = 0; j < d->n; j++) {
            if (i == j)
                continue;
            Vec2 a = d->vein[i].point[0], b = d->vein[i].point[1], c = d->vein[j].point[0], e = d->vein[j].point[1];
            double near = sqrt(MIN(segment_dist2(c, e, a), segment_dist2(c, e, b)));
            bool joined = near < snap, cross = lines_cross(a, b, c, e);
            if (fabs(near - snap) < 0.05 * snap || (cross && near < 4.0 * snap))
                return false; /* stubs go, and with them what they met */
            uint32_t from = part[i], to = part[j];
            if ((!joined && !cross) || from == to)
                continue;
            --*count;
            for (uint32_t k = 0; k < d->n; k++)
                part[k] = part[k] == from ? to : part[k];
        }
    return true;
}

static void test_connectivity(void)
{
    uint32_t tried = 0, joined = 0;
    for (uint32_t seed = 2000; seed < 2800; seed++) {
        Drawing *d = drawing_new();
        uint32_t n_veins = 2 + (uint32_t)(16 * uniform(seed, 900)), count;
        for (uint32_t i = 0; i < n_veins; i++) {
            Vec2 a = random_place(seed, 2 * i), b = vec_lerp(a, random_place(seed, 2 * i + 1), 0.6);
            ADD(d, 0, NULL, a, b);
        }
        DrawingDef def = drawing_def_default();
        def.gap = 0.0;
        def.snap = 0.006;
        if (count_parts(d, def.snap, &count)) {
            tried++;
            joined += count < d->n;
            Network *n = make(d, &def);
            g_assert_cmpuint(parts(n), ==, count);
            network_free(n);
        }
        drawing_free(d);
    }
    g_assert_cmpuint(tried, >, 100);
    g_assert_cmpuint(joined, >, 80);
}

/* Every drawn place is near the network, and every node near what is drawn: by all pairs. */
static void test_places(void)
{
    Drawing *d = pinnate(0, 0);
    for (uint32_t i = 0; i < 8; i++)
        ADD(d, 0, NULL, random_place(77, 2 * i), random_place(77, 2 * i + 1));
    DrawingDef def = drawing_def_default();
    Network *n = make(d, &def);
    for (uint32_t v = 0; v < n->n_nodes; v++) {
        double best = HUGE_VAL;
        for (uint32_t k = 0; k < d->n; k++)
            for (uint32_t i = 1; i < d->vein[k].n; i++)
                best = MIN(best, segment_dist2(vec_scale(d->vein[k].point[i - 1], 100), vec_scale(d->vein[k].point[i], 100), n->node[v]));
        g_assert_cmpfloat(sqrt(best), <, v == 0 ? 0.01 : 0.5 * def.snap * 100);
    }
    for (uint32_t k = 0; k < d->n; k++)
        for (uint32_t i = 1; i < d->vein[k].n; i++)
            for (double t = 0.0; t <= 1.0; t += 0.01) {
                Vec2 p = vec_scale(vec_lerp(d->vein[k].point[i - 1], d->vein[k].point[i], t), 100);
                double best = HUGE_VAL;
                for (uint32_t e = 0; e < n->n_edges; e++)
                    best = MIN(best, segment_dist2(n->node[n->tail[e]], n->node[n->head[e]], p));
                g_assert_cmpfloat(sqrt(best), <, 1.0 + def.snap * 100); /* stubs go */
            }
    network_free(n);
    drawing_free(d);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/drawing/midrib", test_midrib);
    g_test_add_func("/drawing/pinnate", test_pinnate);
    g_test_add_func("/drawing/directions", test_directions);
    g_test_add_func("/drawing/orders/made", test_orders_made);
    g_test_add_func("/drawing/orders/stroke", test_orders_stroke);
    g_test_add_func("/drawing/orders/partly", test_orders_partly);
    g_test_add_func("/drawing/widths", test_widths);
    g_test_add_func("/drawing/thin", test_thin);
    g_test_add_func("/drawing/loop", test_loop);
    g_test_add_func("/drawing/arcs", test_arcs);
    g_test_add_func("/drawing/crossing", test_crossing);
    g_test_add_func("/drawing/snap", test_snap);
    g_test_add_func("/drawing/two-parts", test_two_parts);
    g_test_add_func("/drawing/overlap", test_overlap);
    g_test_add_func("/drawing/opposite", test_opposite);
    g_test_add_func("/drawing/hook", test_hook);
    g_test_add_func("/drawing/gap", test_gap);
    g_test_add_func("/drawing/gap/chain", test_gap_chain);
    g_test_add_func("/drawing/duplicates", test_duplicates);
    g_test_add_func("/drawing/ring", test_ring);
    g_test_add_func("/drawing/nothings", test_nothings);
    g_test_add_func("/drawing/outside", test_outside);
    g_test_add_func("/drawing/along-margin", test_along_margin);
    g_test_add_func("/drawing/bad", test_bad);
    g_test_add_func("/drawing/to-leaf", test_to_leaf);
    g_test_add_func("/drawing/random", test_random);
    g_test_add_func("/drawing/connectivity", test_connectivity);
    g_test_add_func("/drawing/places", test_places);
    return g_test_run();
}
