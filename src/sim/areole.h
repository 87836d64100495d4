/* Areoles: the meshes of a network, the parts of the blade that veins enclose all around. */
#ifndef SIM_AREOLE_H
#define SIM_AREOLE_H

#include "sim/network.h"

/* Veins count as lines along their axes. An areole is a bounded face of the planar graph of the edges (planar.h) after all edges that have the same
 * face on either side are taken away: free ends, trees, and lines that merely join one net to another part no areoles. What is left of separate
 * nets that lie within an areole are its islands: they are not of it. So every place that the outermost veins enclose lies in exactly one areole.
 * What a hole of the blade has torn open, or lies in, is no areole any more: its place lies in none.
 *
 * Areole a has rings first[a] … first[a + 1] - 1: its outer boundary, counter-clockwise, then its islands, clockwise. Ring r has nodes
 * node[ring[r]] … node[ring[r + 1] - 1], from its lowest one on, the areole to the left of the way; a ring may pass a node more than once, as
 * where an island touches the boundary, but no edge. Areoles follow one another by the lowest node of their outer boundary, then by the
 * node next on it; islands likewise. */
typedef struct {
    uint32_t n, n_rings, n_places;
    uint32_t *first; /* [n + 1] */
    uint32_t *ring;  /* [n_rings + 1] */
    uint32_t *node;  /* [ring[n_rings]] nodes of the network, or from its n_nodes on places where edges cross */
    Vec2 *place;     /* [n_places] of both */
    Vec2 *at;        /* [ring[n_rings]] the places of `node`, one after the other */
    double *area;    /* [n] without islands, segments² */
} Areoles;

/* A tangle (planar.h) has no areoles. O(edges log edges) expected. */
Areoles *network_areoles(const Network *net);
void areoles_free(Areoles *a);

#endif
