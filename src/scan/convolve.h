/* Separable convolution of grey images with even kernels. Sums run in double, in a fixed order. */
#ifndef SCAN_CONVOLVE_H
#define SCAN_CONVOLVE_H

#include "scan/edges.h"

/* w[0] is the middle, w[r] the end on both sides. */
typedef struct {
    double *w;
    uint32_t r;
} Kernel;

/* A Gaussian of sum 1, and its second derivative, scaled so that a constant gives 0 and x² gives 2; both cut off at `reach` sigmas. */
Kernel kernel_gaussian(double sigma, double reach);
Kernel kernel_gaussian_second(double sigma, double reach);
void kernel_clear(Kernel *k);

/* The image with the border replicated, as edges.h says. O(pixels · r). */
GreyImage *convolve(const GreyImage *in, Kernel along_x, Kernel along_y);

/* Where in px[] the pixel (x, y) is, or that of the border nearest to it. */
static inline gsize grey_index(const GreyImage *g, int64_t x, int64_t y)
{
    int64_t i = CLAMP(x, 0, (int64_t)g->width - 1), j = CLAMP(y, 0, (int64_t)g->height - 1);
    return (gsize)j * g->width + (gsize)i;
}

#endif
