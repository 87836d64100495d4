/* Holes eaten into a leaf: what is left of its veins, in the network, the files, the areoles, the skeleton and the vein solids. */
#include <glib.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#include "export/export.h"
#include "geom/dtrig.h"
#include "geom/random.h"
#include "import/import.h"
#include "lib/leaf.h"
#include "lib/settings.h"
#include "lib/shape.h"
#include "shape/solid_cut.h"
#include "sim/areole.h"
#include "sim/torn.h"

static void set(VenParams *p, const char *key, const char *value)
{
    GError *error = NULL;
    ven_params_set(p, key, value, &error);
    g_assert_no_error(error);
}

static double chance(uint32_t test, uint32_t i)
{
    double u[2];
    random_pair(test, 0, i, 0, u);
    return u[0];
}

/* A star around a point, neither convex nor round. */
static void add_star(Holes *h, Vec2 at, double radius, uint32_t seed)
{
    enum { N = 24 };
    Vec2 p[N];
    for (uint32_t i = 0; i < N; i++) {
        double s, c, r = radius * (0.5 + 0.5 * chance(seed, i));
        dtrig_sin_cos(DTRIG_PI * 2.0 * i / N, &s, &c);
        p[i] = vec2(at.x + r * c, at.y + r * s);
    }
    holes_add(h, p, N);
}

/* A small net-veined leaf, 120 segments long. */
static VenParams *leaf_params(void)
{
    VenParams *p = ven_params_new();
    set(p, "veins.pattern", "closed");
    set(p, "growth.kind", "isogonic");
    set(p, "growth.initial_length", "20");
    set(p, "growth.final_length", "120");
    set(p, "growth.step", "2");
    set(p, "sources.density", "0.01");
    set(p, "sources.birth_distance_sources", "4");
    set(p, "sources.birth_distance_veins", "4");
    set(p, "veins.kill_distance", "2");
    return p;
}

static VenLeaf *grow(void)
{
    GError *error = NULL;
    VenParams *p = leaf_params();
    VenLeaf *leaf = ven_grow(p, 5, NULL, &error);
    g_assert_no_error(error);
    ven_params_free(p);
    return leaf;
}

static Holes *some_holes(uint32_t seed)
{
    Holes *h = holes_new();
    add_star(h, vec2(0.0, 55.0), 9.0, seed); /* through the midrib */
    add_star(h, vec2(-16.0, 40.0), 7.0, seed + 1);
    add_star(h, vec2(15.0, 62.0), 2.5, seed + 2);
    return h;
}

/* By the sides alone, none of polygon.c's short cuts. */
static bool in_hole(const Holes *h, Vec2 p)
{
    bool in = false;
    for (uint32_t k = 0; k < h->n; k++)
        for (uint32_t i = h->start[k]; i < h->start[k + 1]; i++) {
            Vec2 a = h->p[i], b = h->p[i + 1 < h->start[k + 1] ? i + 1 : h->start[k]];
            if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * ((p.y - a.y) / (b.y - a.y)))
                in = !in;
        }
    return in;
}

/* ---- lines ---- */

/* Against points strewn along them. */
static void test_lines(void)
{
    enum { LINES = 4000, POINTS = 200 };
    Holes *h = some_holes(11);
    HoleRings rings;
    hole_rings_init(&rings, h);
    GArray *out = g_array_new(FALSE, FALSE, sizeof(Stretch));
    uint32_t cut = 0, wrong = 0;
    for (uint32_t k = 0; k < LINES; k++) {
        Vec2 a = vec2(-30.0 + 60.0 * chance(1, k), 20.0 + 60.0 * chance(2, k)), b = vec2(-30.0 + 60.0 * chance(3, k), 20.0 + 60.0 * chance(4, k));
        g_array_set_size(out, 0);
        hole_rings_outside(&rings, a, b, 0.0, out);
        double last = -1.0;
        for (guint i = 0; i < out->len; i++) {
            Stretch s = g_array_index(out, Stretch, i);
            g_assert_cmpfloat(s.from, >, last);
            g_assert_cmpfloat(s.to, >, s.from);
            last = s.to;
        }
        cut += out->len != 1 || last < 1.0;
        for (uint32_t i = 0; i <= POINTS; i++) {
            double t = (i + 0.5) / (POINTS + 1.0);
            bool left = false;
            for (guint j = 0; j < out->len; j++)
                left |= t > g_array_index(out, Stretch, j).from && t < g_array_index(out, Stretch, j).to;
            wrong += left == in_hole(h, vec_lerp(a, b, t));
        }
    }
    g_test_message("%u of %u lines are cut", cut, LINES);
    g_assert_cmpuint(cut, >, LINES / 4);
    g_assert_cmpuint(wrong, ==, 0);
    g_array_unref(out);
    hole_rings_clear(&rings);
    holes_free(h);
}

/* Slivers count for what they lie beside; a line wholly in a hole, or wholly out, stays what it is however short it is. */
static void test_slivers(void)
{
    const Vec2 square[4] = {{0, 0}, {10, 0}, {10, 10}, {0, 10}};
    const struct {
        Vec2 a, b;
        uint32_t n;
        double from, to;
    } row[] = {{{-5, 5}, {5, 5}, 1, 0.0, 0.5},      {{5, 5}, {15, 5}, 1, 0.5, 1.0},        {{-5, 5}, {0.0005, 5}, 1, 0.0, 1.0},
               {{0.0005, 5}, {-5, 5}, 1, 0.0, 1.0}, {{-0.0005, 5}, {5, 5}, 0, 0.0, 0.0},    {{5, 5}, {5.0001, 5}, 0, 0.0, 0.0},
               {{-1, 5}, {-1.0001, 5}, 1, 0.0, 1.0}, {{-10, 5}, {20, 5}, 2, 0.0, 1.0 / 3.0}, {{-5, 10.5}, {15, 10.5}, 1, 0.0, 1.0},
               {{-5, -5}, {15, 15}, 2, 0.0, 0.25},  {{3, 3}, {7, 7}, 0, 0.0, 0.0}};
    Holes *h = holes_new();
    holes_add(h, square, 4);
    HoleRings rings;
    hole_rings_init(&rings, h);
    GArray *out = g_array_new(FALSE, FALSE, sizeof(Stretch));
    for (gsize i = 0; i < G_N_ELEMENTS(row); i++) {
        g_array_set_size(out, 0);
        hole_rings_outside(&rings, row[i].a, row[i].b, 1e-3, out);
        g_test_message("line %u: %u parts", (unsigned)i, out->len);
        g_assert_cmpuint(out->len, ==, row[i].n);
        if (row[i].n == 0)
            continue;
        g_assert_cmpfloat(fabs(g_array_index(out, Stretch, 0).from - row[i].from), <, 1e-12);
        g_assert_cmpfloat(fabs(g_array_index(out, Stretch, 0).to - row[i].to), <, 1e-12);
    }
    g_array_unref(out);
    hole_rings_clear(&rings);
    holes_free(h);
}

/* ---- networks ---- */

static double total(const Network *net)
{
    double sum = 0.0;
    for (uint32_t e = 0; e < net->n_edges; e++)
        sum += vec_dist(net->node[net->tail[e]], net->node[net->head[e]]);
    return sum;
}

/* Length out of holes, by points along the edges. */
static double total_outside(const Network *net, const Holes *h)
{
    enum { POINTS = 400 };
    double sum = 0.0;
    for (uint32_t e = 0; e < net->n_edges; e++) {
        Vec2 a = net->node[net->tail[e]], b = net->node[net->head[e]];
        uint32_t n = 0;
        for (uint32_t i = 0; i < POINTS; i++)
            n += !in_hole(h, vec_lerp(a, b, (i + 0.5) / POINTS));
        sum += vec_dist(a, b) * n / POINTS;
    }
    return sum;
}

static void check_torn(const Network *net, const Holes *h)
{
    bool *seen = g_new0(bool, net->n_veins);
    uint32_t veins = 0, lone = 0;
    bool *used = g_new0(bool, net->n_nodes);
    for (uint32_t e = 0; e < net->n_edges; e++) {
        uint32_t a = net->tail[e], b = net->head[e];
        g_assert_cmpuint(a, <, b);
        g_assert_cmpuint(b, <, net->n_nodes);
        g_assert_cmpuint(net->vein[e], <, net->n_veins);
        g_assert_cmpfloat(net->width[e], >, 0.0);
        g_assert_cmpuint(net->order[e], >, 0);
        g_assert_cmpuint(net->node_birth[a], <=, net->node_birth[b]);
        g_assert_false(in_hole(h, vec_lerp(net->node[a], net->node[b], 0.5)));
        veins += !seen[net->vein[e]];
        seen[net->vein[e]] = used[a] = used[b] = true;
    }
    for (uint32_t v = 0; v < net->n_nodes; v++)
        lone += !used[v];
    g_assert_cmpuint(veins, ==, net->n_veins);
    g_assert_cmpuint(lone, ==, 0);
    g_free(seen);
    g_free(used);
}

static void test_network(void)
{
    for (uint32_t seed = 21; seed < 24; seed++) {
        VenLeaf *leaf = grow();
        Holes *h = some_holes(seed);
        double whole = total(leaf->net), want = total_outside(leaf->net, h);
        uint32_t nodes = leaf->net->n_nodes;
        leaf->net = network_tear(leaf->net, h);
        double have = total(leaf->net);
        g_test_message("%u nodes, %.1f segments; torn %u nodes, %.1f segments", nodes, whole, leaf->net->n_nodes, have);
        g_assert_cmpfloat(have, <, 0.97 * whole);
        g_assert_cmpfloat(fabs(have - want), <, 0.002 * whole);
        g_assert_true(leaf->net->holes == h);
        check_torn(leaf->net, h);
        uint64_t hash = leaf_hash(leaf->net);
        leaf->net = network_tear(leaf->net, holes_copy(h)); /* once more takes nothing */
        g_assert_true(leaf_hash(leaf->net) == hash);
        ven_leaf_free(leaf);
    }
}

/* All of it, none of it, and holes that are none. */
static void test_extremes(void)
{
    VenLeaf *leaf = grow();
    uint64_t hash = leaf_hash(leaf->net);
    leaf->net = network_tear(leaf->net, holes_new());
    g_assert_null(leaf->net->holes);
    g_assert_true(leaf_hash(leaf->net) == hash);
    g_assert_null(network_tied(leaf->net));
    Holes *far = holes_new(), *all = holes_new();
    add_star(far, vec2(500.0, 500.0), 9.0, 1);
    leaf->net = network_tear(leaf->net, far);
    g_assert_cmpuint(leaf->net->n_nodes, ==, leaf->counts.nodes);
    g_assert_null(network_tied(leaf->net));
    add_star(all, vec2(0.0, 60.0), 1000.0, 1);
    leaf->net = network_tear(leaf->net, all);
    g_assert_cmpuint(leaf->net->n_nodes, ==, 1);
    g_assert_cmpuint(leaf->net->n_edges, ==, 0);
    ven_leaf_free(leaf);
}

/* ---- files ---- */

/* What is written reads back, holes and all, and writes the same bytes again. */
static void test_file(void)
{
    GError *error = NULL;
    char *dir = g_dir_make_tmp("venation-torn-XXXXXX", &error), *path = g_build_filename(dir, "a.graphml", NULL), *again = g_build_filename(dir, "b.graphml", NULL);
    VenLeaf *leaf = grow();
    leaf->net = network_tear(leaf->net, some_holes(31));
    g_assert_true(export_graphml(leaf->net, path, &error));
    VenParams *p = leaf_params();
    VenLeaf *read = ven_leaf_load(p, path, 5, &error);
    g_assert_no_error(error);
    g_assert_cmpuint(read->net->n_nodes, ==, leaf->net->n_nodes);
    g_assert_cmpuint(read->net->holes->n, ==, 3);
    g_assert_cmpfloat(fabs(read->net->holes->area - leaf->net->holes->area), <, 1e-3);
    g_assert_true(export_graphml(read->net, again, &error));
    char *one, *two;
    g_assert_true(g_file_get_contents(path, &one, NULL, &error));
    g_assert_true(g_file_get_contents(again, &two, NULL, &error));
    g_assert_cmpstr(one, ==, two);
    g_assert_nonnull(strstr(one, "attr.name=\"holes\""));
    ven_leaf_free(read);
    ven_leaf_free(leaf);
    ven_params_free(p);
    g_unlink(path);
    g_unlink(again);
    g_rmdir(dir);
    g_free(one);
    g_free(two);
    g_free(path);
    g_free(again);
    g_free(dir);
}

static void expect_bad(const char *holes, const char *what)
{
    GError *error = NULL;
    WidthDef widths = width_def_default();
    char *text = g_strdup_printf("<graphml><key id='x' for='node' attr.name='x'/><key id='y' for='node' attr.name='y'/>"
                                 "<key id='h' for='graph' attr.name='holes'/><graph edgedefault='directed'><data key='h'>%s</data>"
                                 "<node id='a'><data key='x'>0</data><data key='y'>0</data></node></graph></graphml>", holes);
    g_assert_null(import_graphml_text(text, strlen(text), "bad", &widths, &error));
    g_assert_nonnull(error);
    g_test_message("%s", error->message);
    g_assert_nonnull(strstr(error->message, what));
    g_clear_error(&error);
    g_free(text);
}

static void test_bad_file(void)
{
    expect_bad("0,0 1,0 1,1; 3,3 4", "holes has the point '4'");
    expect_bad("0,0 1,0 1,1; 3,3 4,4", "hole 2 of holes has 2 different points");
    expect_bad("0,0 1,0 1,1; ", "hole 2 of holes has 0 different points");
    expect_bad("0,0 0,0 1,1", "hole 1 of holes has 2 different points");
}

/* ---- areoles ---- */

/* A hole makes no areole, nor does what it opens belong to one; the others are what they were. */
static void test_areoles(void)
{
    VenLeaf *leaf = grow();
    Areoles *before = network_areoles(leaf->net);
    Holes *h = some_holes(41);
    leaf->net = network_tear(leaf->net, h);
    Areoles *after = network_areoles(leaf->net);
    double sum = 0.0, lost = 0.0;
    uint32_t torn = 0;
    for (uint32_t i = 0; i < after->n; i++)
        sum += after->area[i];
    for (uint32_t i = 0; i < before->n; i++) { /* an areole that a side of a hole runs through or beside which it lies whole */
        bool hit = false;
        for (uint32_t r = before->first[i]; r < before->first[i + 1]; r++)
            for (uint32_t j = before->ring[r]; j < before->ring[r + 1] && !hit; j++) {
                Vec2 a = before->place[before->node[j]], b = before->place[before->node[j + 1 < before->ring[r + 1] ? j + 1 : before->ring[r]]];
                for (int k = 0; k <= 100 && !hit; k++)
                    hit = in_hole(h, vec_lerp(a, b, k / 100.0));
            }
        torn += hit;
        lost += hit ? before->area[i] : 0.0;
    }
    double whole = 0.0;
    for (uint32_t i = 0; i < before->n; i++)
        whole += before->area[i];
    g_test_message("%u areoles of %.1f before; %u of %.1f torn; %u of %.1f after", before->n, whole, torn, lost, after->n, sum);
    g_assert_cmpuint(torn, >, 5);
    g_assert_cmpuint(after->n, ==, before->n - torn);
    g_assert_cmpfloat(fabs(sum - (whole - lost)), <, 1e-6 * whole);
    areoles_free(before);
    areoles_free(after);
    ven_leaf_free(leaf);
}

/* A net of squares: a hole over a crossing opens four into one, which is none; a hole within a square takes that; one outside takes nothing. */
static void test_squares(void)
{
    enum { N = 10 };
    static const struct {
        Vec2 at;
        double radius;
        uint32_t torn;
    } row[] = {{{40, 40}, 3, 4}, {{75, 75}, 2, 1}, {{40, 45}, 3, 2}, {{150, 50}, 3, 0}, {{0, 0}, 3, 1}};
    for (gsize i = 0; i < G_N_ELEMENTS(row); i++) {
        Network *net = network_new(N * N, 2 * N * (N - 1));
        net->margin = polygon_new((Vec2[]){{-50, -50}, {200, -50}, {200, 200}, {-50, 200}}, 4);
        net->n_veins = 1;
        uint32_t e = 0;
        for (uint32_t v = 0; v < N * N; v++) {
            net->node[v] = vec2(10.0 * (v % N), 10.0 * (v / N));
            if (v % N + 1 < N)
                net->tail[e] = v, net->head[e++] = v + 1;
            if (v / N + 1 < N)
                net->tail[e] = v, net->head[e++] = v + N;
        }
        for (e = 0; e < net->n_edges; e++)
            net->width[e] = net->order[e] = net->rank[e] = 1;
        Holes *h = holes_new();
        add_star(h, row[i].at, row[i].radius, 71);
        net = network_tear(net, h);
        Areoles *a = network_areoles(net);
        g_test_message("a hole at %g,%g: %u areoles", row[i].at.x, row[i].at.y, a->n);
        g_assert_cmpuint(a->n, ==, (N - 1) * (N - 1) - row[i].torn);
        for (uint32_t k = 0; k < a->n; k++) {
            g_assert_cmpfloat(fabs(a->area[k] - 100.0), <, 1e-9);
            g_assert_cmpuint(a->ring[a->first[k] + 1] - a->ring[a->first[k]], ==, 4);
        }
        areoles_free(a);
        network_free(net);
    }
}

/* ---- shapes ---- */

static uint32_t roots(const Skeleton *s)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < s->n_nodes; i++)
        n += s->hinge[i] == NO_PARENT;
    return n;
}

/* The blade is carried as if it were whole, but vein solids end at the rims. */
static void test_shape(void)
{
    GError *error = NULL;
    VenLeaf *leaf = grow();
    VenShape *whole = ven_shape(leaf, &error);
    g_assert_no_error(error);
    Holes *h = some_holes(51);
    leaf->net = network_tear(leaf->net, h);
    VenShape *torn = ven_shape(leaf, &error);
    g_assert_no_error(error);
    g_test_message("%u veins in %u trees and %u tubes; torn: %u in %u and %u", whole->skeleton->n_sequences, roots(whole->skeleton), whole->bent.n_tubes,
                   torn->skeleton->n_sequences, roots(torn->skeleton), torn->bent.n_tubes);
    g_assert_cmpuint(roots(torn->skeleton), ==, roots(whole->skeleton));
    g_assert_cmpuint(torn->skeleton->n_sequences, >=, whole->skeleton->n_sequences - 2);
    g_assert_cmpuint(torn->bent.n_tubes, >, torn->skeleton->n_sequences);
    g_assert_cmpuint(torn->bent.tubes[0].petiole, >, 0);
    for (uint32_t i = 0; i < torn->bent.n_tubes; i++) {
        const Tube *t = &torn->bent.tubes[i];
        g_assert_cmpuint(t->n, >=, 2);
        for (uint32_t k = t->petiole; k + 1 < t->n; k++)
            for (int j = 1; j < 50; j++) {
                Vec2 p = vec_lerp(t->rest[k], t->rest[k + 1], j / 50.0);
                if (in_hole(h, p)) { /* slivers may stay */
                    HoleRings rings;
                    hole_rings_init(&rings, h);
                    for (uint32_t r = 0; r < rings.n; r++)
                        g_assert_cmpfloat(polygon_depth(rings.ring[r], p), <, 2e-3);
                    hole_rings_clear(&rings);
                }
            }
    }
    ven_shape_free(torn);
    ven_shape_free(whole);
    ven_leaf_free(leaf);
}

/* A hole at the base: what hangs on nothing bends all the same, with a petiole or without. */
static void test_base(void)
{
    GError *error = NULL;
    VenLeaf *leaf = grow();
    Holes *h = holes_new();
    add_star(h, vec2(0.0, 2.0), 12.0, 61);
    leaf->net = network_tear(leaf->net, h);
    check_torn(leaf->net, h);
    VenShape *torn = ven_shape(leaf, &error);
    g_assert_no_error(error);
    ven_shape_free(torn);
    ven_leaf_free(leaf);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/torn/lines", test_lines);
    g_test_add_func("/torn/slivers", test_slivers);
    g_test_add_func("/torn/network", test_network);
    g_test_add_func("/torn/extremes", test_extremes);
    g_test_add_func("/torn/file", test_file);
    g_test_add_func("/torn/bad-file", test_bad_file);
    g_test_add_func("/torn/areoles", test_areoles);
    g_test_add_func("/torn/squares", test_squares);
    g_test_add_func("/torn/shape", test_shape);
    g_test_add_func("/torn/base", test_base);
    return g_test_run();
}
