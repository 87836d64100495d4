/* The simulation written down a second time, from the rules alone: no indices, no neighbourhood kept from step to step.
 * In every step every source looks at every node, and in closed patterns sorts them all and compares them with each
 * other. Slow and simple, so that it can be believed; what src/sim does must come out the same but for rounding and the
 * order of anastomoses within a step. Relative neighbourhoods and nearest nodes; not Urquhart's. */
#ifndef BENCH_PLAIN_H
#define BENCH_PLAIN_H

#include "sim/simulation.h"

/* Runs to the end. Sets of `counts` what a network and a record tell: all but `updates`, which is k n here. */
Network *plain_grow(const SimulationDef *def, SimulationCounts *counts);

#endif
