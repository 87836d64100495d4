/* Veins that are there before any grow: where they appear, that they stay, and what grown veins make of them. */
#include <glib.h>
#include <math.h>
#include <string.h>

#include "geom/outline.h"
#include "sim/simulation.h"
#include "sim/width.h"

enum { LENGTH = 40, NONE = UINT32_MAX };

static Polygon *ovate(void)
{
    OutlineDef def = outline_def_default();
    def.flatness = 2e-3;
    return outline_new(&def, NULL);
}

static void add_edge(Network *net, uint32_t e, uint32_t tail, uint32_t head, uint8_t order, uint32_t vein, double width)
{
    net->tail[e] = tail;
    net->head[e] = head;
    net->order[e] = order;
    net->rank[e] = order;
    net->vein[e] = vein;
    net->width[e] = width;
}

/* A midvein up to three quarters, a secondary on each side, the right one back to the midvein in a loop. */
static Network *drawn(void)
{
    enum { MID = 31, SIDE = 8 };
    Network *net = network_new(MID + 2 * SIDE, MID - 1 + 2 * SIDE + 1);
    uint32_t e = 0;
    for (uint32_t i = 0; i < MID; i++) {
        net->node[i] = vec2(0.0, i);
        if (i)
            add_edge(net, e++, i - 1, i, 1, 0, 2.0);
    }
    for (uint32_t s = 0; s < 2; s++)
        for (uint32_t i = 0; i < SIDE; i++) {
            uint32_t v = MID + s * SIDE + i;
            net->node[v] = vec2((s ? 0.8 : -0.8) * (i + 1), 10.0 + 0.6 * (i + 1));
            add_edge(net, e++, i ? v - 1 : 10, v, 2, 1 + s, 1.0);
        }
    add_edge(net, e, 20, MID + 2 * SIDE - 1, 2, 3, 0.7);
    net->kind[e] = EDGE_ANASTOMOSIS;
    net->n_veins = 4;
    return net;
}

static SimulationDef with_drawn(const Polygon *leaf, GrowthKind kind, Pattern pattern, const Network *given)
{
    static const double fast[] = {0, 0.05, 1, 0.02}, slow[] = {0, 0.04, 1, 0.01};
    SimulationDef d = simulation_def_default();
    d.leaf = leaf;
    d.growth = (GrowthDef){.kind = kind, .initial_length = kind == GROWTH_NONE ? LENGTH : 12, .final_length = LENGTH, .step = 0.7, .steps = 30,
                           .rate_x = slow, .n_rate_x = 2, .rate_y = fast, .n_rate_y = 2};
    d.density = 0.02;
    d.birth_distance_sources = 3;
    d.birth_distance_veins = 3;
    d.pattern = pattern;
    d.n_seeds = 0;
    d.given = given;
    d.given_length = LENGTH;
    d.threads = 2;
    return d;
}

static double unit_of(GrowthKind kind, double length) { return kind == GROWTH_NONUNIFORM ? length / LENGTH : 1.0; }

/* At every step: those that are there lie within the blade (by the rules of growth), in the end all do, where they were drawn. */
static void test_stays(gconstpointer data)
{
    GrowthKind kind = (GrowthKind)(GPOINTER_TO_INT(data) / 2);
    Pattern pattern = (Pattern)(GPOINTER_TO_INT(data) % 2);
    Polygon *leaf = ovate();
    Network *given = drawn();
    SimulationDef d = with_drawn(leaf, kind, pattern, given);
    Simulation *s = simulation_new(&d, NULL);
    g_assert_nonnull(s);
    const uint32_t *node = simulation_given(s);
    uint32_t there = 0;
    do {
        Network *now = simulation_network(s);
        uint32_t n = 0;
        for (uint32_t i = 0; i < given->n_nodes; i++) {
            if (node[i] == NONE)
                continue;
            n++;
            g_assert_cmpuint(node[i], <, now->n_nodes);
            g_assert_cmpfloat(polygon_depth(now->margin, now->node[node[i]]), >, -1.0);
        }
        g_assert_cmpuint(n, >=, there);
        g_assert_true(kind == GROWTH_MARGINAL || n == given->n_nodes);
        there = n;
        network_free(now);
    } while (simulation_step(s));
    g_assert_cmpuint(there, ==, given->n_nodes);
    g_assert_cmpint(simulation_counts(s).end, !=, END_UNREACHED);
    Network *net = simulation_network(s);
    double by = unit_of(kind, simulation_blade(s)->length);
    if (kind != GROWTH_NONUNIFORM)
        for (uint32_t i = 0; i < given->n_nodes; i++)
            g_assert_cmpfloat(vec_dist(net->node[node[i]], vec_scale(given->node[i], by)), <, 1e-9);
    g_assert_cmpuint(net->n_nodes, >, given->n_nodes + 20); /* finer veins grew */
    uint32_t joined = 0;
    for (uint32_t e = 0; e < net->n_edges; e++)
        joined += net->kind[e] == EDGE_ANASTOMOSIS && MIN(net->tail[e], net->head[e]) == MIN(node[20], node[given->n_nodes - 1]) &&
                  MAX(net->tail[e], net->head[e]) == MAX(node[20], node[given->n_nodes - 1]);
    g_assert_cmpuint(joined, ==, 1);
    for (uint32_t e = 0; e < net->n_edges; e++)
        g_assert_cmpuint(net->tail[e], <, net->head[e]);
    network_free(net);
    simulation_free(s);
    network_free(given);
    polygon_free(leaf);
}

/* Marginal growth: nothing that grows runs ahead in the place of a drawn vein that is still to come. */
static void test_claims(void)
{
    Polygon *leaf = ovate();
    Network *given = drawn();
    SimulationDef d = with_drawn(leaf, GROWTH_MARGINAL, PATTERN_OPEN, given);
    Simulation *s = simulation_new(&d, NULL);
    const uint32_t *node = simulation_given(s);
    uint32_t before = simulation_counts(s).nodes;
    bool more = true;
    while (more) {
        bool *waits = g_new0(bool, given->n_nodes);
        for (uint32_t i = 0; i < given->n_nodes; i++)
            waits[i] = node[i] == NONE;
        more = simulation_step(s);
        Network *now = simulation_network(s);
        for (uint32_t v = before; v < now->n_nodes; v++) {
            bool is_given = false;
            for (uint32_t i = 0; i < given->n_nodes; i++)
                is_given |= node[i] == v;
            for (uint32_t i = 0; i < given->n_nodes && !is_given; i++)
                g_assert_true(!waits[i] || vec_dist(now->node[v], given->node[i]) > 1.4);
        }
        before = now->n_nodes;
        network_free(now);
        g_free(waits);
    }
    simulation_free(s);
    network_free(given);
    polygon_free(leaf);
}

/* Drawn orders, veins and widths come back; side branches are of the next order and no wider than what they left. */
static void test_orders(void)
{
    Polygon *leaf = ovate();
    Network *given = drawn();
    SimulationDef d = with_drawn(leaf, GROWTH_ISOGONIC, PATTERN_CLOSED, given);
    WidthDef widths = width_def_default();
    Simulation *s = simulation_new(&d, NULL);
    while (simulation_step(s))
        ;
    Network *net = simulation_network(s);
    const uint32_t *node = simulation_given(s);
    network_assign_widths(net, &widths);
    network_keep_drawn(net, &widths, given, node);
    uint32_t kept = 0, deepest = 0;
    uint32_t *entry = g_new(uint32_t, net->n_nodes);
    for (uint32_t v = 0; v < net->n_nodes; v++)
        entry[v] = NONE;
    for (uint32_t e = 0; e < net->n_edges; e++)
        if (net->kind[e] == EDGE_VEIN)
            entry[net->head[e]] = e;
    for (uint32_t e = 0; e < net->n_edges; e++) {
        uint32_t as = NONE;
        for (uint32_t k = 0; k < given->n_edges; k++) {
            uint32_t a = node[given->tail[k]], b = node[given->head[k]];
            if (given->kind[k] == net->kind[e] && MIN(a, b) == net->tail[e] && MAX(a, b) == net->head[e])
                as = k;
        }
        deepest = MAX(deepest, net->order[e]);
        g_assert_cmpuint(net->vein[e], <, net->n_veins);
        if (as != NONE) {
            kept++;
            g_assert_cmpuint(net->order[e], ==, given->order[as]);
            g_assert_cmpuint(net->vein[e], ==, given->vein[as]);
            g_assert_cmpfloat(net->width[e], ==, given->width[as]);
        } else if (net->kind[e] == EDGE_VEIN && entry[net->tail[e]] != NONE) {
            uint32_t from = entry[net->tail[e]];
            g_assert_cmpfloat(net->width[e], <=, net->width[from]);
            if (net->vein[e] == net->vein[from])
                g_assert_cmpuint(net->order[e], ==, net->order[from]);
            else
                g_assert_cmpuint(net->order[e], ==, net->order[from] + 1);
        }
    }
    g_assert_cmpuint(kept, ==, given->n_edges);
    g_assert_cmpuint(deepest, >=, 3);
    g_free(entry);
    network_free(net);
    simulation_free(s);
    network_free(given);
    polygon_free(leaf);
}

/* Equal bytes with any number of threads. */
static void test_threads(void)
{
    Polygon *leaf = ovate();
    Network *given = drawn(), *net[2];
    for (unsigned t = 0; t < 2; t++) {
        SimulationDef d = with_drawn(leaf, GROWTH_MARGINAL, PATTERN_CLOSED, given);
        d.threads = 1 + 2 * t;
        Simulation *s = simulation_new(&d, NULL);
        while (simulation_step(s))
            ;
        net[t] = simulation_network(s);
        simulation_free(s);
    }
    g_assert_cmpuint(net[0]->n_nodes, ==, net[1]->n_nodes);
    g_assert_true(memcmp(net[0]->node, net[1]->node, sizeof(Vec2) * net[0]->n_nodes) == 0);
    network_free(net[0]);
    network_free(net[1]);
    network_free(given);
    polygon_free(leaf);
}

int main(int argc, char **argv)
{
    static const char *const kind[] = {"marginal", "isogonic", "nonuniform", "none"}, *const pattern[] = {"open", "closed"};
    g_test_init(&argc, &argv, NULL);
    for (int k = 0; k < 4; k++)
        for (int p = 0; p < 2; p++) {
            char *path = g_strdup_printf("/given/stays/%s/%s", kind[k], pattern[p]);
            g_test_add_data_func(path, GINT_TO_POINTER(2 * k + p), test_stays);
            g_free(path);
        }
    g_test_add_func("/given/claims", test_claims);
    g_test_add_func("/given/orders", test_orders);
    g_test_add_func("/given/threads", test_threads);
    return g_test_run();
}
