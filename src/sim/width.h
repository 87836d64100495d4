/* Vein widths by Murray's law and vein orders (Runions 2005, section 3.5; Hong 2005, § 6.1.1; Hickey 1979). */
#ifndef SIM_WIDTH_H
#define SIM_WIDTH_H

#include "sim/network.h"

typedef struct {
    double exponent;   /* n of r^n = r1^n + r2^n */
    double minimum;    /* width of a veinlet, segments */
    double thickening; /* extra r^n, in veinlets, gained at each node of primary and secondary veins */
    double rank_ratio; /* a branch that begins narrower than this part of its parent is of a lower rank */
} WidthDef;

WidthDef width_def_default(void);

/* Sets flow, width, vein, order and rank of every edge.
 *
 * Flow is r^n in units of a veinlet's. It starts at the free ends (1 for each vein that ends there) and is handed down towards the base;
 * where several veins lead to a node each takes an equal share of what leaves it, so Σ r^n over the veins that enter a
 * junction equals Σ r^n over those that leave it (plus the thickening).
 *
 * Order: at every branching the widest child continues the vein (ties: the older child), the others begin veins of the next order;
 * wide veins that leave the main one near the base are primaries as well (actinodromous venation). An anastomosis is a vein of its own, of the
 * higher of the two orders it joins. Rank: by the width at a vein's origin, in classes of ratio `rank_ratio` from
 * the widest primary down; a fork of nearly equal veins keeps the rank; classes without a vein are passed over. O(nodes + edges). */
void network_assign_widths(Network *net, const WidthDef *def);

/* After that: edges that were drawn (given[n] is the number of each of its nodes in `net`, UINT32_MAX for none) get the orders, veins and, where
 * they are above 0, the widths of the drawing back. What grew on from the end of a drawn vein continues it; what grew out of its side is of
 * the next order; nothing that grew is wider than the vein it left. Murray's law no longer holds where drawn and grown veins meet. O(nodes +
 * edges). */
void network_keep_drawn(Network *net, const WidthDef *def, const Network *drawn, const uint32_t *given);

/* The ranks alone, by the widths as they are. */
void network_assign_ranks(Network *net, const WidthDef *def);

#endif
