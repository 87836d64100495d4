#include "image/noise.h"

#include <glib.h>

#include "geom/random.h"
#include "geom/wide.h"

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

static inline double fade(double t)
{
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

/* Along a row through a cell the mix of its corners' slopes is a straight line beside either upright side. */
typedef struct {
    double at0, slope0, at1, slope1; /* of the left side's, at it; of the right side's, at it */
} Cut;

static inline Cut cut_at(const Noise *n, uint32_t ix, uint32_t iy, double y)
{
    const float *g = n->gradient + 2 * ((gsize)iy * n->nx + ix), *h = g + 2 * (gsize)n->nx;
    double v = fade(y), low0 = (double)g[1] * y, high0 = (double)h[1] * (y - 1.0), low1 = (double)g[3] * y, high1 = (double)h[3] * (y - 1.0);
    return (Cut){low0 + (high0 - low0) * v, (double)g[0] + (double)(h[0] - g[0]) * v, low1 + (high1 - low1) * v,
                 (double)g[2] + (double)(h[2] - g[2]) * v};
}

static inline double across(const Cut *c, double x)
{
    double left = c->at0 + c->slope0 * x, right = c->at1 + c->slope1 * (x - 1.0);
    return left + (right - left) * fade(x);
}

/* Cell of a lattice with n points a side, and the place in it. */
static uint32_t cell(double *x, uint32_t n)
{
    uint32_t i = (uint32_t)CLAMP(*x, 0.0, n - 2.0);
    *x -= i;
    return i;
}

double noise_at(const Noise *n, Vec2 p)
{
    if (!(n->weight > 0.0))
        return 0.0;
    double x = p.x / n->wavelength - (double)n->x0, y = p.y / n->wavelength - (double)n->y0;
    uint32_t ix = cell(&x, n->nx), iy = cell(&y, n->ny);
    Cut c = cut_at(n, ix, iy, y);
    return 1.6 * n->weight * across(&c, x);
}

/* The first pixel after i, and at most `last`, that lies in another cell than i, which lies in cell ix; x of pixel k is x0 + k step. */
static uint32_t cell_end(const Noise *n, double x0, double step, uint32_t i, uint32_t ix, uint32_t last)
{
    double rest = (ix + 1.0 - (x0 + i * step)) / step, x;
    uint32_t end = i + 1 + (uint32_t)CLAMP(rest, 0.0, (double)(last - i - 1)); /* but for rounding */
    while (end > i + 1 && (x = x0 + (end - 1) * step, cell(&x, n->nx) != ix))
        end--;
    while (end < last && (x = x0 + end * step, cell(&x, n->nx) == ix))
        end++;
    return end;
}

WIDE void noise_row(const Noise *n, Vec2 start, double step, uint32_t first, uint32_t last, float *out)
{
    if (!(n->weight > 0.0))
        return;
    double x0 = start.x / n->wavelength - (double)n->x0, y = start.y / n->wavelength - (double)n->y0, gain = 1.6 * n->weight;
    uint32_t iy = cell(&y, n->ny);
    step /= n->wavelength;
    for (uint32_t i = first, end; i < last; i = end) {
        double x = x0 + i * step;
        uint32_t ix = cell(&x, n->nx);
        Cut c = cut_at(n, ix, iy, y);
        end = cell_end(n, x0, step, i, ix, last);
        for (uint32_t k = i; k < end; k++)
            out[k] = (float)(gain * across(&c, x0 + k * step - ix));
    }
}
