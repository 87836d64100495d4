/* The open static workload as anyone would write it in an afternoon: each source keeps its nearest node and looks at every new one; there is
 * no index. What times are read against, since it slows down and speeds up with the machine. It has the paper's rules and nothing besides: a
 * node that would grow the same child again doesn't, and sources that only such nodes are nearest to are never reached. */
#ifndef BENCH_CACHED_H
#define BENCH_CACHED_H

#include "sim/simulation.h"

/* Grows def->list from one seed at the base to the end; sets steps, nodes and sources left. */
void cached_grow(const SimulationDef *def, SimulationCounts *counts);

#endif
