/* The simulation written down a second time, from the rules alone: no indices, no neighbourhood kept from step to step, every source looks at
 * every node, and for closed patterns at every pair. Slow and simple, so that it can be believed; what src/sim does must come out the
 * same to the last bit. Relative neighbourhoods and nearest nodes; not Urquhart's. */
#ifndef BENCH_PLAIN_H
#define BENCH_PLAIN_H

#include "sim/simulation.h"

/* Runs to the end. Sets of `counts` what a network and a record tell: all but `updates`, which is k n here. */
Network *plain_grow(const SimulationDef *def, SimulationCounts *counts);

#endif
