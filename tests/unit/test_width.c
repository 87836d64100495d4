/* Vein widths, orders and ranks: small networks by hand, and random ones against the rules. */
#include <glib.h>
#include <math.h>

#include "geom/random.h"
#include "sim/width.h"

enum { NONE = UINT32_MAX };

static void near(double got, double want)
{
    if (!(fabs(got - want) <= 1e-9 * (1.0 + fabs(want))))
        g_error("%.17g instead of %.17g", got, want);
}

typedef struct {
    uint32_t tail, head;
    EdgeKind kind;
} Link;

/* A network of nodes on a curve, and a blade 100 segments long around it. */
static Network *network(uint32_t nodes, const Link *link, uint32_t edges)
{
    const Vec2 square[4] = {{-50, 0}, {50, 0}, {50, 100}, {-50, 100}};
    Network *net = network_new(nodes, edges);
    net->margin = polygon_new(square, 4);
    for (uint32_t v = 0; v < nodes; v++)
        net->node[v] = vec2(v % 2 ? 1.0 : -1.0, 3.0 * v);
    for (uint32_t e = 0; e < edges; e++) {
        net->tail[e] = link[e].tail;
        net->head[e] = link[e].head;
        net->kind[e] = (uint8_t)link[e].kind;
    }
    return net;
}

/* ---- by hand ---- */

/*      4   6
 *      |   |
 *  5 - 3   2 - ...   0-1-2-3-4 is the main vein, 5 leaves it at 3, 6 and 7 leave at 2 */
static void test_pinnate(void)
{
    const Link link[] = {{0, 1, EDGE_VEIN}, {1, 2, EDGE_VEIN}, {2, 3, EDGE_VEIN}, {3, 4, EDGE_VEIN},
                         {3, 5, EDGE_VEIN}, {2, 6, EDGE_VEIN}, {6, 7, EDGE_VEIN}, {6, 8, EDGE_VEIN}};
    const double flow[] = {4, 4, 2, 1, 1, 2, 1, 1};
    const uint8_t order[] = {1, 1, 1, 1, 2, 2, 2, 3};
    Network *net = network(9, link, 8);
    net->node[2] = vec2(0, 40); /* far from the base */
    WidthDef def = {.exponent = 2, .minimum = 0.5, .thickening = 0, .rank_ratio = 0.6};
    network_assign_widths(net, &def);
    for (uint32_t e = 0; e < 8; e++) {
        near(net->flow[e], flow[e]);
        near(net->width[e], 0.5 * sqrt(flow[e]));
        g_assert_cmpuint(net->order[e], ==, order[e]);
    }
    g_assert_cmpuint(net->n_veins, ==, 4);
    /* ranks: 6 begins at 1.41 of 2 (0.71): no lower rank; 5 begins as wide as what it leaves, 1 of 1.41 of its entry
     * (0.71) */
    const uint8_t rank[] = {1, 1, 1, 1, 1, 1, 1, 1};
    g_assert_cmpmem(net->rank, 8, rank, 8);
    def.rank_ratio = 0.8;
    network_assign_widths(net, &def);
    g_assert_cmpuint(net->rank[4], >, 1);
    g_assert_cmpuint(net->rank[5], ==, 2);
    g_assert_cmpuint(net->rank[6], ==, 2);
    g_assert_cmpuint(net->rank[7], >, 2);
    network_free(net);
}

/* Murray's law in widths, exponent 3: r³ adds up. */
static void test_exponent(void)
{
    const Link link[] = {{0, 1, EDGE_VEIN}, {1, 2, EDGE_VEIN}, {1, 3, EDGE_VEIN}, {3, 4, EDGE_VEIN}, {3, 5, EDGE_VEIN}};
    Network *net = network(6, link, 5);
    WidthDef def = {.exponent = 3, .minimum = 0.2, .thickening = 0, .rank_ratio = 0.6};
    network_assign_widths(net, &def);
    near(pow(net->width[0], 3), pow(net->width[1], 3) + pow(net->width[2], 3));
    near(pow(net->width[2], 3), pow(net->width[3], 3) + pow(net->width[4], 3));
    near(net->width[1], 0.2);
    near(net->width[0], 0.2 * cbrt(3));
    network_free(net);
}

/* A loop: 3 has two parents, which share what leaves it; 4 is an end that two veins reach, and counts twice. */
static void test_loop(void)
{
    const Link link[] = {{0, 1, EDGE_VEIN}, {0, 2, EDGE_VEIN},        {1, 3, EDGE_VEIN},       {3, 4, EDGE_VEIN},
                         {3, 5, EDGE_VEIN}, {2, 3, EDGE_ANASTOMOSIS}, {2, 4, EDGE_ANASTOMOSIS}};
    const double flow[] = {1, 2, 1, 1, 1, 1, 1};
    Network *net = network(6, link, 7);
    WidthDef def = width_def_default();
    network_assign_widths(net, &def);
    for (uint32_t e = 0; e < 7; e++)
        near(net->flow[e], flow[e]);
    g_assert_cmpuint(net->vein[5], !=, net->vein[6]);
    g_assert_cmpuint(net->vein[5], !=, net->vein[1]);
    network_free(net);
}

/* Actinodromous: wide veins from the base are primaries, a narrow one is not. */
static void test_primaries(void)
{
    enum { ENDS = 10 };
    Link link[4 + 3 * ENDS];
    uint32_t n = 0, v = 5;
    for (uint32_t k = 1; k <= 4; k++)
        link[n++] = (Link){0, k, EDGE_VEIN};
    for (uint32_t k = 1; k <= 3; k++)
        for (uint32_t i = 0; i < ENDS; i++)
            link[n++] = (Link){k, v++, EDGE_VEIN};
    Network *net = network(v, link, n);
    WidthDef def = width_def_default();
    network_assign_widths(net, &def);
    for (uint32_t k = 0; k < 3; k++)
        g_assert_cmpuint(net->order[k], ==, 1);
    g_assert_cmpuint(net->order[3], ==, 2);
    network_free(net);
}

/* Extra width for veinlets that are not modelled goes to primaries and secondaries at each node. */
static void test_thickening(void)
{
    const Link link[] = {{0, 1, EDGE_VEIN}, {1, 2, EDGE_VEIN}, {2, 3, EDGE_VEIN}, {2, 4, EDGE_VEIN}, {4, 5, EDGE_VEIN},
                         {4, 6, EDGE_VEIN}, {3, 7, EDGE_VEIN}, {3, 8, EDGE_VEIN}, {3, 9, EDGE_VEIN}};
    Network *net = network(10, link, 9);
    net->node[2] = vec2(0, 40);
    WidthDef def = {.exponent = 2, .minimum = 1, .thickening = 0.25, .rank_ratio = 0.6};
    network_assign_widths(net, &def);
    g_assert_cmpuint(net->order[3], ==, 2);
    g_assert_cmpuint(net->order[5], ==, 3);
    near(net->flow[5], 1);    /* tertiary: none */
    near(net->flow[4], 1.25); /* secondary's end */
    near(net->flow[3], 2.5);  /* 1.25 + 1 + 0.25 */
    near(net->flow[6], 1.25); /* the main vein's end */
    near(net->flow[2], 4);    /* that, two secondaries of 1.25, and 0.25 */
    near(net->flow[1], 6.75); /* 4 + 2.5 + 0.25 */
    network_free(net);
}

/* ---- random networks ---- */

static Network *random_network(uint64_t seed, uint32_t nodes, uint32_t seeds, uint32_t joins)
{
    Link *link = g_new(Link, nodes + joins);
    uint32_t n = 0;
    for (uint32_t v = seeds; v < nodes; v++) {
        double u[2];
        random_pair(seed, 4000, 0, v, u);
        uint32_t back = 1 + (uint32_t)(u[0] * u[0] * u[0] * 30); /* mostly chains */
        link[n++] = (Link){v > back ? v - back : (uint32_t)(u[1] * MIN(v, seeds)), v, EDGE_VEIN};
    }
    for (uint32_t j = 0; j < joins; j++) {
        double u[2];
        random_pair(seed, 4001, 0, j, u);
        uint32_t a = (uint32_t)(u[0] * nodes), b = (uint32_t)(u[1] * nodes);
        if (a != b)
            link[n++] = (Link){MIN(a, b), MAX(a, b), EDGE_ANASTOMOSIS};
    }
    Network *net = network(nodes, link, n);
    for (uint32_t v = 0; v < nodes; v++) {
        double u[2];
        random_pair(seed, 4002, 0, v, u);
        net->node[v] = vec2((u[0] - 0.5) * 100, v < seeds ? 0.0 : u[1] * 100);
    }
    g_free(link);
    return net;
}

/* Flow by sending every end's veinlets up on their own: at each node what arrives is shared among the veins that enter
 * it. */
static double *plain_flow(const Network *net)
{
    double *flow = g_new0(double, net->n_edges), *mass = g_new0(double, net->n_nodes);
    for (uint32_t end = 0; end < net->n_nodes; end++) {
        uint32_t in = 0, out = 0;
        for (uint32_t e = 0; e < net->n_edges; e++) {
            in += net->head[e] == end;
            out += net->tail[e] == end;
        }
        if (out || !in)
            continue;
        for (uint32_t v = 0; v < net->n_nodes; v++)
            mass[v] = v == end ? in : 0.0;
        for (uint32_t v = end + 1; v-- > 0;) {
            uint32_t parents = 0;
            for (uint32_t e = 0; mass[v] > 0.0 && e < net->n_edges; e++)
                parents += net->head[e] == v;
            for (uint32_t e = 0; parents && e < net->n_edges; e++)
                if (net->head[e] == v) {
                    flow[e] += mass[v] / parents;
                    mass[net->tail[e]] += mass[v] / parents;
                }
        }
    }
    g_free(mass);
    return flow;
}

/* The vein edge that enters a node, NONE for a first node. */
static uint32_t entry_of(const Network *net, uint32_t v)
{
    for (uint32_t e = 0; e < net->n_edges; e++)
        if (net->head[e] == v && net->kind[e] == EDGE_VEIN)
            return e;
    return NONE;
}

static uint32_t widest_child(const Network *net, uint32_t v)
{
    uint32_t best = NONE;
    for (uint32_t e = 0; e < net->n_edges; e++)
        if (net->tail[e] == v && net->kind[e] == EDGE_VEIN && (best == NONE || net->flow[e] > net->flow[best]))
            best = e;
    return best;
}

static void check_orders(const Network *net, double ratio)
{
    for (uint32_t e = 0; e < net->n_edges; e++) {
        g_assert_cmpuint(net->order[e], >=, 1);
        g_assert_cmpuint(net->rank[e], >=, 1);
        g_assert_cmpuint(net->vein[e], <, net->n_veins);
        if (net->kind[e] != EDGE_VEIN)
            continue;
        uint32_t entry = entry_of(net, net->tail[e]), main = widest_child(net, net->tail[e]);
        if (entry == NONE) {
            g_assert_cmpuint(net->order[e], <=, 2);
            g_assert_cmpuint(net->rank[e], ==, 1);
            if (e == main)
                g_assert_cmpuint(net->order[e], ==, 1);
        } else if (e == main) { /* goes on */
            g_assert_cmpuint(net->vein[e], ==, net->vein[entry]);
            g_assert_cmpuint(net->order[e], ==, net->order[entry]);
            g_assert_cmpuint(net->rank[e], ==, net->rank[entry]);
        } else {
            g_assert_cmpuint(net->vein[e], !=, net->vein[entry]);
            bool primary = net->order[entry] == 1 && net->order[e] == 1; /* near the base only */
            if (!primary)
                g_assert_cmpuint(net->order[e], ==, net->order[entry] + 1);
            g_assert_cmpuint(net->rank[e], >=, net->rank[entry]);
            if (!primary && net->width[e] < ratio * net->width[entry] * 0.999999)
                g_assert_cmpuint(net->rank[e], >, net->rank[entry]);
            if (net->width[e] > ratio * net->width[entry] * 1.000001)
                g_assert_cmpuint(net->rank[e], ==, net->rank[entry]);
        }
    }
    bool used[256] = {false};
    uint8_t deepest = 0;
    for (uint32_t e = 0; e < net->n_edges; e++) {
        used[net->rank[e]] = true;
        deepest = MAX(deepest, net->rank[e]);
    }
    for (uint32_t k = 1; k <= deepest; k++)
        g_assert_true(used[k]); /* no rank is passed over */
}

/* A vein is one run of edges of one order and rank; every number is used. */
static void check_veins(const Network *net)
{
    uint32_t *last = g_new(uint32_t, net->n_veins), used = 0;
    for (uint32_t k = 0; k < net->n_veins; k++)
        last[k] = NONE;
    for (uint32_t v = 0; v < net->n_nodes; v++) /* edges by tail: the order in which a vein runs */
        for (uint32_t e = 0; e < net->n_edges; e++) {
            if (net->tail[e] != v)
                continue;
            uint32_t *at = &last[net->vein[e]];
            if (*at == NONE) {
                used++;
            } else {
                g_assert_cmpuint(net->kind[e], ==, EDGE_VEIN);
                g_assert_cmpuint(net->head[*at], ==, net->tail[e]);
                g_assert_cmpuint(net->order[*at], ==, net->order[e]);
                g_assert_cmpuint(net->rank[*at], ==, net->rank[e]);
            }
            *at = e;
        }
    g_assert_cmpuint(used, ==, net->n_veins);
    g_free(last);
}

static void check_anastomoses(const Network *net)
{
    for (uint32_t e = 0; e < net->n_edges; e++) {
        if (net->kind[e] != EDGE_ANASTOMOSIS)
            continue;
        uint32_t a = entry_of(net, net->tail[e]), b = entry_of(net, net->head[e]);
        uint32_t first = a == NONE ? 1 : net->order[a], second = b == NONE ? 1 : net->order[b];
        g_assert_cmpuint(net->order[e], ==, MAX(first, second));
    }
}

static void test_random(void)
{
    for (uint64_t seed = 0; seed < 40; seed++) {
        Network *net =
            random_network(seed, 40 + 5 * (uint32_t)seed, 1 + (uint32_t)(seed % 4), (uint32_t)(seed % 5) * 8);
        WidthDef def = {.exponent = 1.5 + 0.1 * (double)seed, .minimum = 0.3, .thickening = 0, .rank_ratio = 0.6};
        network_assign_widths(net, &def);
        double *want = plain_flow(net);
        for (uint32_t e = 0; e < net->n_edges; e++) {
            near(net->flow[e], want[e]);
            near(net->width[e], 0.3 * pow(want[e], 1.0 / def.exponent));
        }
        g_free(want);
        check_orders(net, def.rank_ratio);
        check_veins(net);
        check_anastomoses(net);
        network_free(net);
    }
}

/* Nodes without edges, no edges at all. */
static void test_bare(void)
{
    Network *net = network(3, NULL, 0);
    WidthDef def = width_def_default();
    network_assign_widths(net, &def);
    g_assert_cmpuint(net->n_veins, ==, 0);
    network_free(net);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/width/pinnate", test_pinnate);
    g_test_add_func("/width/exponent", test_exponent);
    g_test_add_func("/width/loop", test_loop);
    g_test_add_func("/width/primaries", test_primaries);
    g_test_add_func("/width/thickening", test_thickening);
    g_test_add_func("/width/random", test_random);
    g_test_add_func("/width/bare", test_bare);
    return g_test_run();
}
