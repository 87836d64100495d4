/* Exact distances from pixels to the nearest of many strokes. */
#ifndef IMAGE_NEAREST_H
#define IMAGE_NEAREST_H

#include "geom/parallel.h"
#include "image/bins.h"

typedef struct Nearest Nearest;

typedef const Capsule *(*StrokeFn)(uint32_t i, const void *user);

/* Strokes shape(0 … n-1, user), which must outlive it as must the bins they lie in, each in one at least; distances matter up to
 * `limit`, pixels. */
Nearest *nearest_new(const Bins *bins, uint32_t n, StrokeFn shape, const void *user, double limit);
void nearest_free(Nearest *q);

/* For each pixel of rows y0 … y1-1, multiples of TILE but for the image's last, the distance from its centre to the nearest
 * stroke, negative inside, and at most `limit`; and which stroke it is, all bits set for none within the limit. Pixels where
 * `where` is 0 are given 0. Arrays begin at row y0; `where` and `which` may be NULL. */
void nearest_fill(const Nearest *q, Pool *pool, uint32_t y0, uint32_t y1, const float *where, float *distance, uint32_t *which);

#endif
