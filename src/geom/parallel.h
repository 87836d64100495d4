/* Parallel loops. Which thread runs which part is open, so `fn` must write each result where no other part does; then
 * the outcome is the same for every number of threads. */
#ifndef GEOM_PARALLEL_H
#define GEOM_PARALLEL_H

#include <stdint.h>

typedef void (*LoopFn)(uint32_t first, uint32_t last, void *user);

/* Threads kept ready for one loop after another. They start with the first loop that has work for them, and sleep when none has come
 * for some microseconds: fewer where more threads are at work than there are processors. */
typedef struct Pool Pool;

/* `threads` of them (0: all processors), the caller's among them. */
Pool *pool_new(unsigned threads);
void pool_free(Pool *pool);

/* How many threads share a loop, at most. */
unsigned pool_threads(const Pool *pool);

/* Calls fn(first, last, user) on ranges first … last-1 of at most `grain` indices that together make 0 … n-1. Returns when all are
 * done. Ranges begin at multiples of grain. One loop at a time: a pool belongs to one thread, and fn must not call pool_for on it.
 * Starting a loop costs about a microsecond. */
void pool_for(Pool *pool, uint32_t n, uint32_t grain, LoopFn fn, void *user);

/* The same with threads that start for this loop and end with it. */
void parallel_for(unsigned threads, uint32_t n, uint32_t grain, LoopFn fn, void *user);

#endif
