#include "image/noise.h"

#include <glib.h>

#include "geom/random.h"

void noise_init(Noise *n, uint64_t seed, uint32_t field, double wavelength, Box2 region, double pixels_per_segment)
{
    *n = (Noise){.wavelength = wavelength, .weight = CLAMP(0.5 * wavelength * pixels_per_segment - 1.0, 0.0, 1.0)};
    if (!(n->weight > 0.0))
        return;
    n->x0 = (int64_t)floor(region.x0 / wavelength) - 1;
    n->y0 = (int64_t)floor(region.y0 / wavelength) - 1;
    n->nx = (uint32_t)((region.x1 - region.x0) / wavelength) + 4;
    n->ny = (uint32_t)((region.y1 - region.y0) / wavelength) + 4;
    n->gradient = g_new(float, (gsize)n->nx * n->ny * 2);
    for (uint32_t y = 0; y < n->ny; y++)
        for (uint32_t x = 0; x < n->nx; x++) {
            uint64_t index = (uint64_t)(n->y0 + y) << 32 ^ (uint32_t)(n->x0 + x);
            RandomBlock b = random_block(seed, RANDOM_TEXTURE, field, index);
            float *g = n->gradient + 2 * ((gsize)y * n->nx + x);
            g[0] = (float)(b.w[0] * 0x1p-31 - 1.0);
            g[1] = (float)(b.w[1] * 0x1p-31 - 1.0);
        }
}

void noise_clear(Noise *n)
{
    g_free(n->gradient);
}

static double fade(double t)
{
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

double noise_at(const Noise *n, Vec2 p)
{
    if (!(n->weight > 0.0))
        return 0.0;
    double x = p.x / n->wavelength - (double)n->x0, y = p.y / n->wavelength - (double)n->y0;
    double fx = floor(x), fy = floor(y);
    uint32_t ix = (uint32_t)CLAMP(fx, 0.0, n->nx - 2.0), iy = (uint32_t)CLAMP(fy, 0.0, n->ny - 2.0);
    x -= ix;
    y -= iy;
    const float *g = n->gradient + 2 * ((gsize)iy * n->nx + ix), *h = g + 2 * (gsize)n->nx;
    double a = (double)g[0] * x + (double)g[1] * y, b = (double)g[2] * (x - 1.0) + (double)g[3] * y;
    double c = (double)h[0] * x + (double)h[1] * (y - 1.0), d = (double)h[2] * (x - 1.0) + (double)h[3] * (y - 1.0);
    double u = fade(x), v = fade(y);
    double low = a + (b - a) * u, high = c + (d - c) * u;
    return 1.6 * n->weight * (low + (high - low) * v);
}
