/* A parallel loop. Which thread runs which part is open, so `fn` must write each result where no other part does; then
 * the outcome is the same for every number of threads. */
#ifndef GEOM_PARALLEL_H
#define GEOM_PARALLEL_H

#include <stdint.h>

/* Calls fn(first, last, user) on ranges first … last-1 of at most `grain` indices that together make 0 … n-1, from
 * `threads` threads (0: all processors), the caller's among them. Returns when all are done. Ranges begin at multiples
 * of grain. */
void parallel_for(unsigned threads, uint32_t n, uint32_t grain, void (*fn)(uint32_t first, uint32_t last, void *user),
                  void *user);

#endif
