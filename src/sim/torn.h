/* What holes take from a network, and what still hangs together across them. */
#ifndef SIM_TORN_H
#define SIM_TORN_H

#include "sim/network.h"

/* A leaf in which holes were eaten after it had grown: what of its veins lies in a hole is gone; where a vein runs into one it ends in a new node at its
 * rim, and where it comes out it begins with one, as the same vein. Widths stay what they were. Takes `net` and `holes`, which the result has
 * as its own; ends are as old as the node that their edge led to. O(edges · holes), besides edges near holes. */
Network *network_tear(Network *net, Holes *holes);

/* The network with what comes out of a hole tied to what went in, by straight lines: to the end of the same vein at the rim, else to the nearest older
 * end there. So what lies behind a hole moves with the leaf. A new network, without holes; NULL when nothing is to be tied. */
Network *network_tied(const Network *net);

#endif
