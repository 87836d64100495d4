/* Blurring of one-channel images. */
#ifndef IMAGE_BLUR_H
#define IMAGE_BLUR_H

#include <stdint.h>

#include "geom/parallel.h"

/* Two box filters of 2 half + 1 pixels in a row along each axis, a tent; beyond the image lies 0. Whole numbers, 0 … 2^30, as
 * their sums don't depend on where they begin: parts of an image come out as the whole does, but for 2 half rows at cut edges. */
void image_blur(Pool *pool, int32_t *px, uint32_t width, uint32_t height, uint32_t half);

#endif
