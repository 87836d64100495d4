/* Areoles against hand-made nets, Euler's formula, brute force and painted pixels. */
#include <glib.h>
#include <math.h>
#include <string.h>

#include "geom/random.h"
#include "geom/turn.h"
#include "image/painter.h"
#include "lib/leaf.h"
#include "sim/areole.h"
#include "sim/planar.h"

static double uniform(uint64_t *counter)
{
    double v[2];
    random_pair(7, 0, 0, (*counter)++, v);
    return v[0];
}

/* ---- turns ---- */

/* In whole numbers nothing is rounded. */
static int whole_turn(const int64_t v[6])
{
    __extension__ typedef __int128 Wide;
    Wide det = (Wide)(v[2] - v[0]) * (v[5] - v[1]) - (Wide)(v[3] - v[1]) * (v[4] - v[0]);
    return (det > 0) - (det < 0);
}

static void test_turn(void)
{
    static const int64_t spread[] = {2, 100, INT64_C(1) << 52};
    uint64_t c = 0;
    int flat = 0, doubtful = 0;
    for (int i = 0; i < 60000; i++) {
        int64_t v[6], range = spread[i % 3];
        for (int k = 0; k < 6; k++)
            v[k] = (int64_t)(uniform(&c) * (double)range);
        if (i % 2 != 0) /* c near the line through a and b, far from both */
            for (int k = 4; k < 6; k++)
                v[k] = (v[k - 4] + v[k - 2]) / 2 + (uniform(&c) < 0.1 ? 1 : 0);
        if (i % 6 == 0) /* b so far away that its distance to c is rounded, and a as good as on the way there */
            for (int k = 0; k < 2; k++) {
                int64_t d = 1 + (int64_t)(uniform(&c) * 100.0);
                v[k + 4] = (int64_t)(uniform(&c) * 100.0);
                v[k] = v[k + 4] + d;
                v[k + 2] = d * (INT64_C(1) << 53);
            }
        Vec2 a = vec2((double)v[0], (double)v[1]), b = vec2((double)v[2], (double)v[3]), p = vec2((double)v[4], (double)v[5]);
        int want = whole_turn(v);
        g_assert_cmpint(turn_sign(a, b, p), ==, want);
        g_assert_cmpint(turn_sign(b, a, p), ==, -want);
        g_assert_cmpint(turn_sign(vec_scale(a, 0x1p-60), vec_scale(b, 0x1p-60), vec_scale(p, 0x1p-60)), ==, want);
        flat += want == 0;
        double plain = (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
        doubtful += (plain > 0.0) - (plain < 0.0) != want;
    }
    g_assert_cmpint(flat, >, 1000);
    g_assert_cmpint(doubtful, >, 10); /* what plain arithmetic gets wrong */
}

static double angle(Vec2 d)
{
    double a = atan2(d.y, d.x);
    return a < 0.0 ? a + 2.0 * acos(-1.0) : a;
}

static void test_order(void)
{
    uint64_t c = 0;
    static const Vec2 way[] = {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};
    for (int i = 0; i < 8; i++)
        for (int j = 0; j < 8; j++)
            g_assert_cmpint(turn_before(vec2(3, 4), vec_add(vec2(3, 4), way[i]), vec_add(vec2(3, 4), vec_scale(way[j], 2))), ==, i < j);
    for (int i = 0; i < 5000; i++) {
        Vec2 q = vec2(uniform(&c), uniform(&c)), a = vec2(uniform(&c), uniform(&c)), b = vec2(uniform(&c), uniform(&c));
        g_assert_cmpint(turn_before(q, a, b), ==, angle(vec_sub(a, q)) < angle(vec_sub(b, q)));
    }
}

/* ---- nets ---- */

static Network *net_of(const Vec2 *node, uint32_t n_nodes, const uint32_t (*edge)[2], uint32_t n_edges)
{
    Network *net = network_new(n_nodes, n_edges);
    memcpy(net->node, node, n_nodes * sizeof *node);
    for (uint32_t e = 0; e < n_edges; e++) {
        net->tail[e] = edge[e][0];
        net->head[e] = edge[e][1];
        net->width[e] = 1e-3;
        net->order[e] = 1;
        net->vein[e] = e;
    }
    net->n_veins = n_edges;
    return net;
}

/* Random lines across a square: everything crosses. */
static Network *straws(uint32_t n, double length, uint64_t seed)
{
    Network *net = network_new(2 * n, n);
    uint64_t c = seed * 1000000;
    for (uint32_t e = 0; e < n; e++) {
        Vec2 a = vec2(uniform(&c), uniform(&c)), d = vec2(uniform(&c) - 0.5, uniform(&c) - 0.5);
        net->node[2 * e] = vec_scale(a, 40.0);
        net->node[2 * e + 1] = vec_add(net->node[2 * e], vec_scale(d, length));
        net->tail[e] = 2 * e;
        net->head[e] = 2 * e + 1;
        net->width[e] = 1e-3;
        net->order[e] = 1;
        net->vein[e] = e;
    }
    net->n_veins = n;
    return net;
}

/* A jittered grid that misses many edges, and has some twice or in two pieces over one another. */
static Network *lattice(uint32_t side, double keep, uint64_t seed)
{
    GArray *edge = g_array_new(FALSE, FALSE, 2 * sizeof(uint32_t));
    Vec2 *node = g_new(Vec2, side * side);
    uint64_t c = seed * 1000000;
    for (uint32_t i = 0; i < side * side; i++)
        node[i] = vec2(i % side + 0.6 * uniform(&c), i / side + 0.6 * uniform(&c));
    for (uint32_t i = 0; i < side * side; i++)
        for (uint32_t k = 0; k < 2; k++) {
            uint32_t two[2] = {i, k == 0 ? i + 1 : i + side};
            if ((k == 0 ? i % side + 1 : i / side + 1) >= side || uniform(&c) > keep)
                continue;
            g_array_append_val(edge, two);
            if (uniform(&c) < 0.05)
                g_array_append_val(edge, two);
        }
    Network *net = net_of(node, side * side, (const uint32_t (*)[2])(const void *)edge->data, edge->len);
    g_array_free(edge, TRUE);
    g_free(node);
    return net;
}

/* ---- brute force ---- */

static uint32_t component(const Planar *g, uint32_t without, uint32_t *part)
{
    uint32_t n = g->n_nodes;
    for (uint32_t v = 0; v < g->n_nodes; v++)
        part[v] = v;
    for (uint32_t e = 0; e < g->n_edges; e++) {
        uint32_t a = g->edge[e][0], b = g->edge[e][1];
        if (e == without)
            continue;
        while (part[a] != a)
            a = part[a] = part[part[a]];
        while (part[b] != b)
            b = part[b] = part[part[b]];
        n -= a != b;
        part[MAX(a, b)] = MIN(a, b);
    }
    return n;
}

/* Faces by Euler's formula: bounded ones = edges - nodes + components. */
static uint32_t faces(const Planar *g)
{
    uint32_t *part = g_new(uint32_t, g->n_nodes + 1), n = component(g, 0xFFFFFFFFu, part);
    g_free(part);
    return g->n_edges + n - g->n_nodes;
}

/* Whether the way from p to q crosses an edge; exact. Places are such that none runs through a node. */
static uint32_t crossed(const Network *net, Vec2 p, Vec2 q)
{
    uint32_t n = 0;
    for (uint32_t e = 0; e < net->n_edges; e++) {
        Vec2 a = net->node[net->tail[e]], b = net->node[net->head[e]];
        n += turn_sign(a, b, p) * turn_sign(a, b, q) < 0 && turn_sign(p, q, a) * turn_sign(p, q, b) < 0;
    }
    return n;
}

/* Areole at p by the even-odd rule over each one's rings, 0: none; an areole that overlaps another fails. */
static uint32_t areole_at(const Areoles *a, Vec2 p)
{
    uint32_t found = 0;
    for (uint32_t k = 0; k < a->n; k++) {
        bool in = false;
        for (uint32_t r = a->first[k]; r < a->first[k + 1]; r++)
            for (uint32_t i = a->ring[r], j = a->ring[r + 1] - 1; i < a->ring[r + 1]; j = i++) {
                Vec2 u = a->place[a->node[i]], v = a->place[a->node[j]];
                if ((u.y > p.y) != (v.y > p.y) && p.x < u.x + (v.x - u.x) * (p.y - u.y) / (v.y - u.y))
                    in = !in;
            }
        g_assert_true(!in || found == 0);
        if (in)
            found = k + 1;
    }
    return found;
}

/* What holds of any areoles. */
static void check_rings(const Network *net, const Areoles *a)
{
    uint32_t before[2] = {0, 0};
    g_assert_cmpuint(a->first[0], ==, 0);
    g_assert_cmpuint(a->first[a->n], ==, a->n_rings);
    for (uint32_t k = 0; k < a->n; k++) {
        double area = 0.0;
        g_assert_cmpuint(a->first[k], <, a->first[k + 1]);
        for (uint32_t r = a->first[k]; r < a->first[k + 1]; r++) {
            const uint32_t *ring = a->node + a->ring[r];
            uint32_t n = a->ring[r + 1] - a->ring[r];
            double sum = 0.0;
            g_assert_cmpuint(n, >=, 3);
            for (uint32_t i = 0; i < n; i++) {
                g_assert_cmpuint(ring[i], <, a->n_places);
                g_assert_cmpuint(ring[0], <=, ring[i]);
                g_assert_cmpuint(ring[i], !=, ring[(i + 1) % n]);
                if (ring[i] < net->n_nodes)
                    g_assert_true(memcmp(&a->place[ring[i]], &net->node[ring[i]], sizeof(Vec2)) == 0);
                sum += 0.5 * vec_cross(a->place[ring[i]], a->place[ring[(i + 1) % n]]);
            }
            g_assert_true(r == a->first[k] ? sum > 0.0 : sum < 0.0);
            area += sum;
            if (r == a->first[k]) {
                g_assert_true(k == 0 || ring[0] > before[0] || (ring[0] == before[0] && ring[1] > before[1]));
                memcpy(before, ring, sizeof before);
            }
        }
        g_assert_cmpfloat(fabs(a->area[k] - area), <, 1e-9 * (1.0 + area) * 1000.0);
        g_assert_cmpfloat(a->area[k], >, 0.0);
    }
}

/* Pixel centres of a grid, joined where no edge lies between them: what is joined is of one areole, what is joined to the outside of none; and areas by
 * counting. */
static void check_flood(const Network *net, const Areoles *a, double size, uint32_t side)
{
    uint32_t *label = g_new(uint32_t, side * side), *count = g_new0(uint32_t, a->n + 1), ways = 0;
    double step = size / side;
    for (uint32_t i = 0; i < side * side; i++) {
        label[i] = areole_at(a, vec2((i % side + 0.5013) * step, (i / side + 0.4979) * step));
        count[label[i]]++;
    }
    for (uint32_t i = 0; i < side * side; i++)
        for (uint32_t k = 0; k < 2; k++) {
            uint32_t j = k == 0 ? i + 1 : i + side;
            if ((k == 0 ? i % side + 1 : i / side + 1) >= side)
                continue;
            Vec2 p = vec2((i % side + 0.5013) * step, (i / side + 0.4979) * step), q = vec2((j % side + 0.5013) * step, (j / side + 0.4979) * step);
            if (crossed(net, p, q) == 0) {
                g_assert_cmpuint(label[i], ==, label[j]);
                ways++;
            }
        }
    g_assert_cmpuint(ways, >, side);
    for (uint32_t k = 0; k < a->n; k++) {
        double want = a->area[k] / (step * step);
        Box2 box = box_empty();
        for (uint32_t i = a->ring[a->first[k]]; i < a->ring[a->first[k] + 1]; i++)
            box = box_add(box, a->place[a->node[i]]);
        if (box.x0 > 0.0 && box.y0 > 0.0 && box.x1 < size && box.y1 < size)
            g_assert_cmpfloat(fabs(count[k + 1] - want), <, 3.0 + 4.0 * sqrt(want));
    }
    g_free(label);
    g_free(count);
}

/* ---- hand-made ---- */

typedef struct {
    uint32_t areoles, rings;
    double area[8];
} Want;

static void check_hand(const Vec2 *node, uint32_t n_nodes, const uint32_t (*edge)[2], uint32_t n_edges, const Want *want)
{
    Network *net = net_of(node, n_nodes, edge, n_edges);
    Areoles *a = network_areoles(net);
    check_rings(net, a);
    g_assert_cmpuint(a->n, ==, want->areoles);
    g_assert_cmpuint(a->n_rings, ==, want->rings);
    for (uint32_t k = 0; k < a->n; k++)
        g_assert_cmpfloat(fabs(a->area[k] - want->area[k]), <, 1e-9);
    areoles_free(a);
    network_free(net);
}

#define HAND(node, edge, ...) check_hand(node, G_N_ELEMENTS(node), edge, G_N_ELEMENTS(edge), &(Want)__VA_ARGS__)

static void test_hand(void)
{
    static const Vec2 square[] = {{0, 0}, {10, 0}, {10, 10}, {0, 10}, {4, 3}, {6, 3}, {6, 5}, {4, 5}, {5, 8}, {12, 4}};
    static const uint32_t ring[][2] = {{0, 1}, {1, 2}, {2, 3}, {0, 3}};
    HAND(square, ring, {1, 1, {100}});
    static const uint32_t twice[][2] = {{0, 1}, {1, 2}, {1, 2}, {2, 3}, {0, 3}, {0, 1}, {3, 3}};
    HAND(square, twice, {1, 1, {100}});
    static const uint32_t cut[][2] = {{0, 1}, {1, 2}, {2, 3}, {0, 3}, {0, 2}};
    HAND(square, cut, {2, 2, {50, 50}});
    static const uint32_t crossed_twice[][2] = {{0, 1}, {1, 2}, {2, 3}, {0, 3}, {0, 2}, {1, 3}};
    HAND(square, crossed_twice, {4, 4, {25, 25, 25, 25}});
    static const uint32_t spurs[][2] = {{0, 1}, {1, 2}, {2, 3}, {0, 3}, {0, 4}, {4, 8}, {1, 9}, {5, 6}};
    HAND(square, spurs, {1, 1, {100}});
    static const uint32_t island[][2] = {{0, 1}, {1, 2}, {2, 3}, {0, 3}, {4, 5}, {5, 6}, {6, 7}, {4, 7}, {6, 8}};
    HAND(square, island, {2, 3, {96, 4}});
    static const uint32_t bridged[][2] = {{0, 1}, {1, 2}, {2, 3}, {0, 3}, {4, 5}, {5, 6}, {6, 7}, {4, 7}, {0, 4}};
    HAND(square, bridged, {2, 3, {96, 4}});
    static const uint32_t open[][2] = {{0, 1}, {1, 2}, {2, 3}, {4, 5}};
    HAND(square, open, {0, 0, {0}});
}

/* Islands in islands, islands side by side, some that touch the boundary or each other in a node. */
static void test_islands(void)
{
    static const Vec2 node[] = {{0, 0}, {20, 0}, {20, 20}, {0, 20}, {2, 2}, {18, 2}, {18, 18}, {2, 18}, {4, 4}, {8, 4}, {8, 8}, {4, 8},
                                {12, 4}, {16, 4}, {16, 8}, {12, 8}, {30, 0}, {40, 0}, {40, 10}};
    static const uint32_t edge[][2] = {{0, 1}, {1, 2}, {2, 3}, {0, 3}, {4, 5}, {5, 6}, {6, 7}, {4, 7}, {8, 9}, {9, 10}, {10, 11}, {8, 11},
                                       {12, 13}, {13, 14}, {14, 15}, {12, 15}, {16, 17}, {17, 18}, {16, 18}};
    HAND(node, edge, {5, 8, {400 - 256, 256 - 32, 16, 16, 50}});
    static const Vec2 touching[] = {{0, 0}, {10, 0}, {10, 10}, {0, 10}, {4, 1}, {1, 4}, {5, 10}, {4, 8}, {6, 8}, {6, 6}};
    static const uint32_t loops[][2] = {{0, 1}, {1, 2}, {2, 6}, {3, 6}, {0, 3}, {0, 4}, {4, 5}, {0, 5}, {6, 7}, {7, 8}, {6, 8}, {8, 9}};
    HAND(touching, loops, {3, 3, {100 - 7.5 - 2, 7.5, 2}}); /* in the order of the nodes next on them */
}

/* Edges over one another in part, through nodes, nodes in one place. */
static void test_touching(void)
{
    static const Vec2 node[] = {{0, 0}, {10, 0}, {10, 10}, {0, 10}, {5, 0}, {5, 10}, {10, 0}, {3, 0}, {8, 0}};
    static const uint32_t through[][2] = {{0, 1}, {1, 2}, {2, 3}, {0, 3}, {4, 5}};
    HAND(node, through, {2, 2, {50, 50}});
    static const uint32_t same[][2] = {{0, 1}, {2, 6}, {2, 3}, {0, 3}, {7, 8}, {4, 8}, {5, 4}};
    HAND(node, same, {2, 2, {50, 50}});
    static const Vec2 heap[] = {{1, 1}, {1, 1}, {1, 1}};
    static const uint32_t nothing[][2] = {{0, 1}, {1, 2}, {0, 2}};
    HAND(heap, nothing, {0, 0, {0}});
    Network *none = network_new(0, 0);
    Areoles *a = network_areoles(none);
    g_assert_cmpuint(a->n, ==, 0);
    areoles_free(a);
    areoles_free(NULL);
    network_free(none);
}

/* Lines that all but meet in one point, for which it takes several looks; far from there lies a net where nothing crosses. */
static void test_star(void)
{
    enum { MOST = 9 };
    uint64_t c = 5000000;
    for (uint32_t n = 2; n <= MOST; n++)
        for (int times = 0; times < 20; times++) {
            Vec2 middle = vec2(3.0 + uniform(&c), 3.0 + uniform(&c)), node[2 * MOST + 3] = {{20.0, 0.0}, {30.0, 1.0}, {25.0, 9.0}};
            uint32_t edge[3 * MOST + 3][2] = {{0, 1}, {1, 2}, {2, 0}}, m = 3;
            for (uint32_t i = 0; i < 2 * n; i++) {
                double turn = acos(-1.0) * (i % n + 0.8 * uniform(&c)) / n, reach = (i < n ? 1.0 : -1.0) * (1.0 + 0.3 * uniform(&c));
                Vec2 way = vec2(cos(turn), sin(turn));
                if (i >= n)
                    way = vec_scale(vec_sub(node[3 + i - n], middle), 1.0 / vec_dist(node[3 + i - n], middle));
                node[3 + i] = vec_add(middle, vec_scale(way, reach));
                edge[m][0] = 3 + i;
                edge[m++][1] = 3 + (i + 1) % (2 * n);
            }
            for (uint32_t i = 0; i < n; i++) {
                edge[m][0] = 3 + i;
                edge[m++][1] = 3 + i + n;
            }
            Network *net = net_of(node, 2 * n + 3, (const uint32_t (*)[2])edge, m);
            Areoles *a = network_areoles(net);
            check_rings(net, a);
            g_assert_cmpuint(a->n, ==, 2 * n + 1);
            areoles_free(a);
            network_free(net);
        }
}

/* ---- random ---- */

static void check_net(Network *net, double size, uint32_t side)
{
    Planar *g = planar_new(net);
    Areoles *a = network_areoles(net);
    g_assert_nonnull(g);
    for (uint32_t e = 1; e < g->n_edges; e++)
        g_assert_true(g->edge[e - 1][0] < g->edge[e][0] || (g->edge[e - 1][0] == g->edge[e][0] && g->edge[e - 1][1] < g->edge[e][1]));
    for (uint32_t e = 0; e < g->n_edges; e++) /* nothing crosses any more */
        for (uint32_t f = 0; f < e; f++) {
            Vec2 a0 = g->node[g->edge[e][0]], a1 = g->node[g->edge[e][1]], b0 = g->node[g->edge[f][0]], b1 = g->node[g->edge[f][1]];
            g_assert_false(turn_sign(a0, a1, b0) * turn_sign(a0, a1, b1) < 0 && turn_sign(b0, b1, a0) * turn_sign(b0, b1, a1) < 0);
        }
    g_assert_cmpuint(a->n, ==, faces(g));
    check_rings(net, a);
    check_flood(net, a, size, side);
    areoles_free(a);
    planar_free(g);
    network_free(net);
}

static void test_random(void)
{
    for (uint64_t seed = 0; seed < 6; seed++) {
        check_net(straws(60, 20.0, seed), 40.0, 60);
        check_net(straws(25, 90.0, seed), 40.0, 60);
        check_net(lattice(12, 0.55 + 0.08 * (double)seed, seed), 12.0, 60);
    }
}

/* A tangle is given up, not waited for. */
static void test_tangle(void)
{
    Network *net = straws(400, 400.0, 1);
    g_assert_null(planar_new(net));
    Areoles *a = network_areoles(net);
    g_assert_cmpuint(a->n, ==, 0);
    g_assert_cmpuint(a->n_rings, ==, 0);
    areoles_free(a);
    network_free(net);
}

/* ---- grown ---- */

static VenLeaf *grown(const char *neighbourhood, uint64_t seed)
{
    static const char *const setting[][2] = {{"growth.kind", "isogonic"}, {"growth.initial_length", "15"}, {"growth.final_length", "90"},
                                             {"growth.step", "1.5"}, {"sources.density", "0.01"}, {"sources.birth_distance_sources", "3"},
                                             {"sources.birth_distance_veins", "3"}, {"width.minimum", "0.15"}};
    VenParams *p = ven_params_new();
    VenOptions options = {.threads = 2};
    GError *error = NULL;
    for (gsize i = 0; i < G_N_ELEMENTS(setting); i++)
        ven_params_set(p, setting[i][0], setting[i][1], &error);
    ven_params_set(p, "veins.neighbourhood", neighbourhood, &error);
    VenLeaf *leaf = ven_grow(p, seed, &options, &error);
    g_assert_no_error(error);
    ven_params_free(p);
    return leaf;
}

/* Area within the outermost walks: what a painter who fills all areoles has filled. */
static void test_grown(void)
{
    for (uint64_t seed = 1; seed < 4; seed++) {
        VenLeaf *leaf = grown(seed % 2 != 0 ? "relative" : "urquhart", seed);
        Planar *g = planar_new(leaf->net);
        Areoles *a = network_areoles(leaf->net);
        g_assert_cmpuint(a->n, >, 40);
        g_assert_cmpuint(a->n, ==, faces(g));
        check_rings(leaf->net, a);
        double sum = 0.0, around = 0.0;
        for (uint32_t k = 0; k < a->n; k++)
            sum += a->area[k];
        /* sides that only one areole has are the outer cycles' */
        GHashTable *sides = g_hash_table_new_full(g_int64_hash, g_int64_equal, g_free, NULL);
        for (int pass = 0; pass < 2; pass++)
            for (uint32_t r = 0; r < a->n_rings; r++)
                for (uint32_t i = a->ring[r]; i < a->ring[r + 1]; i++) {
                    uint32_t u = a->node[i], v = a->node[i + 1 < a->ring[r + 1] ? i + 1 : a->ring[r]];
                    gint64 there = (gint64)u << 32 | v, back = (gint64)v << 32 | u;
                    if (pass == 0)
                        g_assert_true(g_hash_table_add(sides, g_memdup2(&there, sizeof there))); /* each side once */
                    else if (!g_hash_table_contains(sides, &back))
                        around += 0.5 * vec_cross(a->place[u], a->place[v]);
                }
        g_hash_table_unref(sides);
        g_assert_cmpfloat(fabs(sum / around - 1.0), <, 1e-9);
        g_assert_cmpfloat(sum, <, leaf->net->margin->area);
        g_assert_cmpfloat(sum, >, 0.5 * leaf->net->margin->area);
        areoles_free(a);
        planar_free(g);
        ven_leaf_free(leaf);
    }
}

/* ---- the map ---- */

static Painter *painter_at(const Network *net, const Frame *frame, unsigned threads)
{
    PaintStyle style = paint_style_default();
    style.threads = threads;
    return painter_new(net, frame, &style);
}

/* Pixels hold the areole around their centres but where there is a vein or no blade. */
static void test_map(void)
{
    VenLeaf *leaf = grown("relative", 5);
    static const uint32_t size[] = {64, 300};
    for (int k = 0; k < 2; k++) {
        Frame f = frame_fit(leaf->net->margin->box, size[k], true, 0.02);
        if (k == 1)
            f.corner.x += 7.3; /* part of the leaf lies beyond the image */
        Painter *p = painter_at(leaf->net, &f, 2);
        Plane *map = painter_paint(p, MAP_AREOLE), *cover = painter_paint(p, MAP_VEIN_MASK), *blade = painter_paint(p, MAP_OPACITY);
        Areoles *a = network_areoles(leaf->net);
        uint32_t filled = 0, veins = 0;
        g_assert_cmpfloat(map->high, ==, a->n);
        g_assert_cmpint(map->kind, ==, PLANE_LABEL);
        for (uint32_t i = 0; i < f.width * f.height; i++) {
            Vec2 at = vec2(f.corner.x + (i % f.width + 0.5) / f.scale, f.corner.y - (i / f.width + 0.5) / f.scale);
            uint32_t want = areole_at(a, at);
            veins += want > 0 && cover->px[i] >= 0.5f;
            if (cover->px[i] >= 0.5f || blade->px[i] < 0.5f)
                want = 0;
            g_assert_cmpfloat(map->px[i], ==, want);
            filled += want > 0;
        }
        g_assert_cmpuint(filled, >, f.width * f.height / 8);
        g_assert_cmpuint(veins, >, 10);
        areoles_free(a);
        plane_free(map);
        plane_free(cover);
        plane_free(blade);
        painter_free(p);
    }
    ven_leaf_free(leaf);
}

/* Edges that lie on the lines of pixel centres, level, upright and sloping, and corners on pixel centres: each pixel has one label. */
static void test_lines(void)
{
    enum { SIDE = 9 };
    Vec2 node[SIDE * SIDE];
    GArray *edge = g_array_new(FALSE, FALSE, 2 * sizeof(uint32_t));
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        node[i] = vec2(4.0 * (i % SIDE) + 0.5, 4.0 * (i / SIDE) + 0.5);
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t two[2] = {i, k == 0 ? i + 1 : k == 1 ? i + SIDE : i + SIDE + 1};
            if ((k == 1 || i % SIDE + 1 < SIDE) && (k == 0 || i / SIDE + 1 < SIDE))
                g_array_append_val(edge, two);
        }
    }
    Network *net = net_of(node, SIDE * SIDE, (const uint32_t (*)[2])(const void *)edge->data, edge->len);
    Frame f = {40, 40, 1.0, {-2.0, 38.0}};
    Painter *p = painter_at(net, &f, 1);
    Plane *map = painter_paint(p, MAP_AREOLE);
    uint32_t *count = g_new0(uint32_t, 2 * 64 + 1), n = 0;
    g_assert_cmpfloat(map->high, ==, 128.0);
    for (uint32_t i = 0; i < 1600; i++) {
        g_assert_cmpfloat(map->px[i], <=, 128.0f);
        count[(uint32_t)map->px[i]]++;
        n += map->px[i] > 0.0f;
    }
    g_assert_cmpuint(n, ==, 32 * 32); /* no pixel on the common line of two areoles is of neither */
    for (int k = 1; k <= 128; k++)
        g_assert_true(count[k] == 6 || count[k] == 10); /* of 16 in each square the diagonal falls to one side */
    g_free(count);
    g_array_free(edge, TRUE);
    plane_free(map);
    painter_free(p);
    network_free(net);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/areole/turn", test_turn);
    g_test_add_func("/areole/order", test_order);
    g_test_add_func("/areole/hand", test_hand);
    g_test_add_func("/areole/islands", test_islands);
    g_test_add_func("/areole/touching", test_touching);
    g_test_add_func("/areole/star", test_star);
    g_test_add_func("/areole/random", test_random);
    g_test_add_func("/areole/tangle", test_tangle);
    g_test_add_func("/areole/grown", test_grown);
    g_test_add_func("/areole/map", test_map);
    g_test_add_func("/areole/lines", test_lines);
    return g_test_run();
}
