#include "sim/edge_order.h"

#include <glib.h>

#include "geom/hilbert.h"

enum { AHEAD = 16 }; /* nodes that memory is asked for before it is their turn */

/* By counting twice: by the lower half of the key's upper bits, then, keeping the order, by their upper half. */
uint32_t *edge_order_nodes(const Vec2 *node, uint32_t n)
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

void edge_order_init(EdgeOrder *o, const uint32_t *was, uint32_t n, const Vec2 *node, uint32_t n_nodes, const uint32_t (*edge)[2], uint32_t n_edges)
{
    uint32_t *number = g_new(uint32_t, (gsize)n_nodes + 1), *first = g_new(uint32_t, (gsize)n_nodes + 1), to = 0;
    *o = (EdgeOrder){n, n_edges, g_new(Vec2, (gsize)n + 1), was, NULL, g_new(uint32_t, (gsize)n_edges + 1)};
    o->edge = g_malloc_n((gsize)n_edges + 1, sizeof *o->edge);
    for (uint32_t i = 0; i < n; i++) {
        o->node[i] = node[was[i]];
        number[was[i]] = i;
    }
    for (uint32_t v = 0, e = 0; v <= n_nodes; v++) {
        first[v] = e;
        while (e < n_edges && edge[e][0] == v)
            e++;
    }
    for (uint32_t i = 0; i < n; i++) {
        if (n - i > 2 * AHEAD) { /* nodes lie all over memory */
            __builtin_prefetch(&first[was[i + 2 * AHEAD]]);
            __builtin_prefetch(&edge[first[was[i + AHEAD]]]);
        }
        for (uint32_t e = first[was[i]]; e < first[was[i] + 1]; e++) {
            o->edge[to][0] = i;
            o->edge[to][1] = edge[e][1];
            o->was_edge[to++] = e;
        }
    }
    for (uint32_t e = 0; e < n_edges; e++)
        o->edge[e][1] = number[o->edge[e][1]];
    g_free(number);
    g_free(first);
}

void edge_order_clear(EdgeOrder *o)
{
    g_free(o->node);
    g_free(o->edge);
    g_free(o->was_edge);
}
