/* Counter-based random numbers (Philox 4x32-10; Salmon et al. 2011). A number depends on seed, stream, step
 * and index alone, so it is the same whichever thread asks for it and whatever was asked for before. */
#ifndef GEOM_RANDOM_H
#define GEOM_RANDOM_H

#include <stdint.h>

/* One stream for each use, so that adding a use never shifts the numbers of another. */
typedef enum {
    RANDOM_DART = 1,      /* auxin source darts */
    RANDOM_MARGIN = 2,    /* precomputed source set for marginal growth */
    RANDOM_TEXTURE = 3,   /* colour variation of the blade */
    RANDOM_POSE = 64,     /* unevenness of poses */
    RANDOM_LSYSTEM = 80,  /* choice among productions */
    RANDOM_GRAIN = 90,    /* which part of a scanned leaf lends its grain to a hole */
    RANDOM_MESH = 100,    /* order in which a mesh's points are inserted */
    RANDOM_SWEEP = 120,   /* values that a sweep draws; 121: digits of its sequences */
} RandomStream;

/* Four independent 32-bit words. */
typedef struct {
    uint32_t w[4];
} RandomBlock;

RandomBlock random_block(uint64_t seed, uint32_t stream, uint32_t step, uint64_t index);

/* Two independent doubles, uniform in [0, 1), with 53 and 53 random bits. */
void random_pair(uint64_t seed, uint32_t stream, uint32_t step, uint64_t index, double out[2]);

#endif
