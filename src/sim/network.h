/* The venation graph: what a simulation grows, what a person may draw, and all that texture, measure and shape see.
 * Flat arrays; edges are oriented from the leaf base to the extremities and the tail is always the older node (smaller
 * index), so the graph is acyclic and index order is a topological order. */
#ifndef SIM_NETWORK_H
#define SIM_NETWORK_H

#include "geom/holes.h"
#include "geom/polygon.h"
#include "geom/vec.h"

typedef enum {
    EDGE_VEIN = 0,        /* grown: head was born from tail */
    EDGE_ANASTOMOSIS = 1, /* two veins that met at one auxin source */
} EdgeKind;

typedef struct Network Network;
struct Network {
    uint32_t n_nodes, n_edges, n_veins;
    uint32_t n_steps;     /* steps of the run; births lie in 0 … n_steps */
    Vec2 *node;           /* [n_nodes] position at the end of the run, segments */
    uint32_t *node_birth; /* [n_nodes] step of birth; seeds 0 */
    uint32_t *tail, *head; /* [n_edges] */
    uint32_t *birth;      /* [n_edges] step of birth */
    uint8_t *kind;        /* [n_edges] EdgeKind */
    double *flow;         /* [n_edges] r^n in units of a veinlet's (Murray); 1 for a veinlet */
    double *width;        /* [n_edges] diameter, segments */
    uint8_t *order;       /* [n_edges] 1 primary, 2 secondary, … by hierarchy (Hong 2005, § 6.1.1) */
    uint8_t *rank;        /* [n_edges] 1, 2, … by width at the vein's origin (Hickey 1979) */
    uint32_t *vein;       /* [n_edges] the vein (run of edges of one order) it belongs to, 0 … n_veins-1 */
    Polygon *margin;      /* outline at the end of the run, segments; owned */
    Holes *holes;         /* of the blade, in segments as the margin is; NULL: none; owned. What lay in them is no part of the network (torn.h). */
    double length;        /* base (0,0) to tip (0,length), segments; 0: unknown */
};

Network *network_new(uint32_t n_nodes, uint32_t n_edges);
void network_free(Network *n);

/* Without its spurs: runs of veins from a branching to a free end that are shorter than `shortest` and end farther than that from the margin, as an open
 * pattern has where a source let go of a vein that had just set out for it. The longest vein of a fork stays. Takes `net`; returns the rest, widths and orders not
 * set. O(nodes + edges + free ends · margin). */
Network *network_prune(Network *net, double shortest);

#endif
