/* Blurring of one-channel images. */
#ifndef IMAGE_BLUR_H
#define IMAGE_BLUR_H

#include <stdint.h>

/* Two box filters in a row along each axis, a tent of the given radius (pixels) each way; beyond the image lies 0. The
 * sums of a row or column run from its start whatever the threads, so results don't depend on them. */
void image_blur(float *px, uint32_t width, uint32_t height, double radius, unsigned threads);

#endif
