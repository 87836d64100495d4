/* The static workload that public implementations were timed on: auxin sources spread over a 2:1 ellipse, about 5
 * segments apart, none nearer than 3.5 to another; one first vein node at the base, kill distance 2, no growth. The
 * same points for a seed everywhere. */
#ifndef BENCH_WORKLOAD_H
#define BENCH_WORKLOAD_H

#include "sim/simulation.h"

typedef struct {
    ListedSource *source; /* [n] */
    uint32_t n;
    Polygon *leaf;
    SimulationDef def; /* points into the above */
} Workload;

Workload *workload_new(uint32_t n, uint64_t seed, Pattern pattern);
/* The same from points of a file: lines x,y in segments from the base, the tip along +y. NULL and the error when it can't be read or the
 * points lie in no 2:1 ellipse that stands on the base. */
Workload *workload_read(const char *path, GError **error);
void workload_free(Workload *w);

#endif
