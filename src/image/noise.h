/* Smooth noise over the plane (gradient noise; Perlin 1985, 2002). A value depends on seed, field and place alone, so
 * pictures of any size and frame show the same pattern. */
#ifndef IMAGE_NOISE_H
#define IMAGE_NOISE_H

#include "geom/vec.h"

typedef struct {
    double wavelength, weight; /* segments; 0: finer than the image can show */
    int64_t x0, y0;            /* first lattice point */
    uint32_t nx, ny;
    float *gradient; /* [ny][nx][2] */
} Noise;

/* Field number `field` of `seed`, ready for points of `region`. It fades out as its wavelength nears two pixels. */
void noise_init(Noise *n, uint64_t seed, uint32_t field, double wavelength, Box2 region, double pixels_per_segment);
void noise_clear(Noise *n);

/* About -1 … 1, 0 on average. */
double noise_at(const Noise *n, Vec2 p);

/* The same at start + (i step, 0) for i from first to last-1, into out[i]. */
void noise_row(const Noise *n, Vec2 start, double step, uint32_t first, uint32_t last, float *out);

#endif
