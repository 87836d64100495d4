/* A network as a planar graph: edges that meet in common nodes alone. */
#ifndef SIM_PLANAR_H
#define SIM_PLANAR_H

#include "sim/network.h"

typedef struct {
    uint32_t n_nodes, n_edges;
    Vec2 *node;          /* [n_nodes] those of the network, then those where edges cross */
    uint32_t (*edge)[2]; /* [n_edges] the lower node first; in order of both, none twice */
    uint32_t *order;     /* [n_nodes] nodes as they follow one another in the plane, but for those where edges cross, which come last */
} Planar;

/* Nodes in one place become the one of the lowest index, edges that are there twice one, edges without length none. An edge that runs
 * through a node, or past it within a ten-billionth of the network's extent, is divided there; where two edges cross they get a node. NULL for
 * a tangle of more than 8 crossings an edge. O(edges log edges) expected; a grown net, in which hardly anything crosses, is looked through once. */
Planar *planar_new(const Network *net);
void planar_free(Planar *p);

#endif
