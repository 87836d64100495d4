#include "sim/edge_order.h"

#include <glib.h>

#include "geom/hilbert.h"

/* By counting twice: by the lower half of the key's upper bits, then, keeping the order, by their upper half. */
static uint32_t *along_curve(const Vec2 *node, uint32_t n)
{
    enum { HALF = 11, VALUES = 1 << HALF };
    uint32_t *key = g_new(uint32_t, (gsize)n + 1), *order[2] = {g_new(uint32_t, (gsize)n + 1), g_new(uint32_t, (gsize)n + 1)};
    Box2 box = box_empty();
    for (uint32_t v = 0; v < n; v++)
        box = box_add(box, node[v]);
    Hilbert curve = hilbert_over(box);
    for (uint32_t v = 0; v < n; v++) {
        key[v] = hilbert_key(curve, node[v]) >> (2 * HILBERT_BITS - 2 * HALF);
        order[1][v] = v;
    }
    for (int pass = 0; pass < 2; pass++) {
        const uint32_t *from = order[1 - pass];
        uint32_t *to = order[pass], start[VALUES + 1] = {0};
        for (uint32_t v = 0; v < n; v++)
            start[(key[v] >> pass * HALF) % VALUES + 1]++;
        for (int k = 0; k < VALUES; k++)
            start[k + 1] += start[k];
        for (uint32_t i = 0; i < n; i++)
            to[start[(key[from[i]] >> pass * HALF) % VALUES]++] = from[i];
    }
    g_free(key);
    g_free(order[0]);
    return order[1];
}

void edge_order_init(EdgeOrder *o, const Vec2 *node, uint32_t n_nodes, const uint32_t (*edge)[2], uint32_t n_edges)
{
    uint32_t *number = g_new(uint32_t, (gsize)n_nodes + 1), *first = g_new(uint32_t, (gsize)n_nodes + 1), n = 0;
    *o = (EdgeOrder){n_nodes, n_edges, g_new(Vec2, (gsize)n_nodes + 1), along_curve(node, n_nodes), NULL, g_new(uint32_t, (gsize)n_edges + 1)};
    o->edge = g_malloc_n((gsize)n_edges + 1, sizeof *o->edge);
    for (uint32_t i = 0; i < n_nodes; i++) {
        o->node[i] = node[o->was[i]];
        number[o->was[i]] = i;
    }
    for (uint32_t v = 0, e = 0; v <= n_nodes; v++) {
        first[v] = e;
        while (e < n_edges && edge[e][0] == v)
            e++;
    }
    for (uint32_t i = 0; i < n_nodes; i++)
        for (uint32_t e = first[o->was[i]]; e < first[o->was[i] + 1]; e++) {
            o->edge[n][0] = i;
            o->edge[n][1] = number[edge[e][1]];
            o->was_edge[n++] = e;
        }
    g_free(number);
    g_free(first);
}

void edge_order_clear(EdgeOrder *o)
{
    g_free(o->node);
    g_free(o->was);
    g_free(o->edge);
    g_free(o->was_edge);
}
