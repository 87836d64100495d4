/* Nodes and edges as they follow one another in the plane. Nodes of a network are born all over the leaf, so that what walks from one to the next, or looks
 * at what is near, would wait for memory at each step. */
#ifndef SIM_EDGE_ORDER_H
#define SIM_EDGE_ORDER_H

#include "geom/vec.h"

typedef struct {
    uint32_t n_nodes, n_edges;
    Vec2 *node;           /* [n_nodes] along Hilbert's curve */
    uint32_t *was;        /* [n_nodes] their numbers before */
    uint32_t (*edge)[2];  /* [n_edges] by the first node */
    uint32_t *was_edge;   /* [n_edges] */
} EdgeOrder;

/* Edges come in order of their first nodes, which stay the first ones. O(nodes + edges). */
void edge_order_init(EdgeOrder *o, const Vec2 *node, uint32_t n_nodes, const uint32_t (*edge)[2], uint32_t n_edges);
void edge_order_clear(EdgeOrder *o);

#endif
