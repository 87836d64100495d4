/* What the handles of the public header hold. */
#ifndef LIB_LEAF_H
#define LIB_LEAF_H

#include "image/paint.h"
#include "lib/ground.h"
#include "param/params.h"
#include "sim/network.h"
#include "sim/simulation.h"
#include "venation.h"

/* Choices of veins.origin. */
enum { ORIGIN_GROWN, ORIGIN_DRAWN, ORIGIN_LSYSTEM };

struct VenParams {
    Params *values;
};

struct VenLeaf {
    Params *params;
    uint64_t seed;
    unsigned threads;
    Ground *ground; /* NULL for a network that was read without a scan */
    Network *net;
    SimulationCounts counts;
    double length;  /* segments, base to tip, at this step */
    uint32_t growth_steps;
    const Network *reference; /* of a snapshot: the finished network, whose scale all frames share; borrowed, else NULL */
    Box2 stage;     /* holds the leaf at every step of its run, segments: frames share its scale */
};

/* FNV-1a over the network's bytes: nodes, edges, widths, orders. One number that changes when anything does. */
uint64_t leaf_hash(const Network *net);

/* Where `box` lies in maps of the size and shape that [texture] asks for. */
Frame leaf_frame(const VenLeaf *leaf, Box2 box);

#endif
