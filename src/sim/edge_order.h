/* Nodes and edges as they follow one another in the plane. Nodes of a network are born all over the leaf, so that what walks from one to the next, or looks
 * at what is near, would wait for memory at each step. */
#ifndef SIM_EDGE_ORDER_H
#define SIM_EDGE_ORDER_H

#include "geom/vec.h"

typedef struct {
    uint32_t n_nodes, n_edges;
    Vec2 *node;           /* [n_nodes] */
    const uint32_t *was;  /* [n_nodes] their numbers before; not owned */
    uint32_t (*edge)[2];  /* [n_edges] by the first node */
    uint32_t *was_edge;   /* [n_edges] */
} EdgeOrder;

/* Nodes along Hilbert's curve. O(nodes). */
uint32_t *edge_order_nodes(const Vec2 *node, uint32_t n);

/* Of `n` of the nodes, those that edges have and maybe more, in the order `was`, which outlives it; edges, which are in order of their first nodes, come in
 * that one, and their first nodes stay the first ones. O(n_nodes + n_edges). */
void edge_order_init(EdgeOrder *o, const uint32_t *was, uint32_t n, const Vec2 *node, uint32_t n_nodes, const uint32_t (*edge)[2], uint32_t n_edges);
void edge_order_clear(EdgeOrder *o);

#endif
