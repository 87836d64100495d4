/* Spurs taken off a network. */
#include <glib.h>

#include "sim/network.h"

/* A stem of ten nodes upwards; from node 4 a spur of 2 to the right, from node 7 a branch of 5 to the left, and at node 9 a fork into two short ends near
 * the margin. */
static Network *tree(void)
{
    static const Vec2 square[] = {{-20, -1}, {20, -1}, {20, 11}, {-20, 11}};
    Network *net = network_new(10 + 2 + 5 + 2, 18);
    uint32_t e = 0, v = 0;
    for (; v < 10; v++) {
        net->node[v] = vec2(0, v);
        if (v)
            net->tail[e] = v - 1, net->head[e++] = v;
    }
    for (uint32_t k = 0; k < 2; k++, v++) {
        net->node[v] = vec2(1.0 + k, 4);
        net->tail[e] = k ? v - 1 : 4, net->head[e++] = v;
    }
    for (uint32_t k = 0; k < 5; k++, v++) {
        net->node[v] = vec2(-1.0 - k, 7);
        net->tail[e] = k ? v - 1 : 7, net->head[e++] = v;
    }
    for (uint32_t k = 0; k < 2; k++, v++) {
        net->node[v] = vec2(k ? 0.5 : -0.5, 9.8);
        net->tail[e] = 9, net->head[e++] = v;
    }
    net->margin = polygon_new(square, 4);
    for (uint32_t i = 0; i < e; i++)
        net->birth[i] = i;
    return net;
}

static uint32_t ends(const Network *net)
{
    uint32_t n = 0;
    for (uint32_t v = 0; v < net->n_nodes; v++) {
        bool leaves = false;
        for (uint32_t e = 0; e < net->n_edges; e++)
            leaves |= net->tail[e] == v;
        n += !leaves;
    }
    return n;
}

static void check(double shortest, uint32_t nodes, uint32_t free_ends)
{
    Network *net = network_prune(tree(), shortest);
    g_assert_cmpuint(net->n_nodes, ==, nodes);
    g_assert_cmpuint(net->n_edges, ==, nodes - 1);
    g_assert_cmpuint(ends(net), ==, free_ends);
    for (uint32_t e = 0; e < net->n_edges; e++) {
        g_assert_cmpuint(net->tail[e], <, net->head[e]);
        g_assert_cmpuint(net->head[e], <, net->n_nodes);
        g_assert_cmpfloat(vec_dist(net->node[net->tail[e]], net->node[net->head[e]]), <, 1.01);
    }
    network_free(net);
}

static void test_tree(void)
{
    check(0.5, 19, 4);
    check(2.5, 17, 3); /* the spur of 2 goes; the fork at the margin and the branch of 5 stay */
    check(1.0, 18, 3); /* of the fork one goes, its older vein stays */
}

/* A spur that was joined to another vein is none; a leaf of one vein stays. */
static void test_kept(void)
{
    Network *net = tree(), *all = network_new(19, 19);
    for (uint32_t v = 0; v < 19; v++)
        all->node[v] = net->node[v];
    for (uint32_t e = 0; e < 18; e++)
        all->tail[e] = net->tail[e], all->head[e] = net->head[e];
    all->tail[18] = 5, all->head[18] = 11, all->kind[18] = EDGE_ANASTOMOSIS;
    all->margin = polygon_new(net->margin->v, net->margin->n);
    network_free(net);
    all = network_prune(all, 2.5);
    g_assert_cmpuint(all->n_nodes, ==, 19);
    g_assert_cmpuint(all->n_edges, ==, 19);
    network_free(all);
    Network *one = network_new(2, 1);
    one->node[1] = vec2(0, 1);
    one->head[0] = 1;
    one->margin = polygon_new((const Vec2[]){{-90, -90}, {90, -90}, {0, 90}}, 3);
    one = network_prune(one, 50);
    g_assert_cmpuint(one->n_nodes, ==, 2);
    network_free(one);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/prune/tree", test_tree);
    g_test_add_func("/prune/kept", test_kept);
    return g_test_run();
}
