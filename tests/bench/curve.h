/* What one source update, one new node and one dart cost. */
#ifndef BENCH_CURVE_H
#define BENCH_CURVE_H

#include "sim/simulation.h"

typedef struct {
    double update, node, dart; /* seconds each */
    double seconds;            /* of the whole run */
    SimulationCounts counts;
} Costs;

/* Grows a static workload step by step with a clock at each part of it: what the sources do at each other (looking at new nodes and pulling)
 * by the number of updates, births by the number of nodes. Then throws as many darts as there were sources into the grown leaf, which find
 * veins and each other. */
Costs curve_costs(const SimulationDef *def);

#endif
