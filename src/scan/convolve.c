#include "scan/convolve.h"

#include <math.h>

#include "geom/dmath.h"

/* e^(-k² / 2σ²), not scaled. */
static double *bell(double sigma, uint32_t r)
{
    double *w = g_new(double, (gsize)r + 1);
    for (uint32_t k = 0; k <= r; k++)
        w[k] = dmath_exp2(-0.72134752044448170368 * ((double)k / sigma) * ((double)k / sigma)); /* 1 / (2 ln 2) */
    return w;
}

/* Sum of w[k] k^p over the whole kernel, p = 0 or 2. */
static double moment(Kernel k, int p)
{
    double sum = p ? 0.0 : k.w[0];
    for (uint32_t i = 1; i <= k.r; i++)
        sum += 2.0 * k.w[i] * (p ? (double)i * (double)i : 1.0);
    return sum;
}

Kernel kernel_gaussian(double sigma, double reach)
{
    Kernel k = {.r = (uint32_t)ceil(reach * sigma)};
    k.w = bell(sigma, k.r);
    double sum = moment(k, 0);
    for (uint32_t i = 0; i <= k.r; i++)
        k.w[i] /= sum;
    return k;
}

/* The sampled bell's own variance stands in place of sigma². */
Kernel kernel_gaussian_second(double sigma, double reach)
{
    Kernel k = kernel_gaussian(sigma, reach);
    double variance = moment(k, 2);
    for (uint32_t i = 0; i <= k.r; i++)
        k.w[i] *= (double)i * (double)i - variance;
    double scale = 2.0 / moment(k, 2);
    for (uint32_t i = 0; i <= k.r; i++)
        k.w[i] *= scale;
    return k;
}

void kernel_clear(Kernel *k)
{
    g_free(k->w);
    k->w = NULL;
}

static void convolve_rows(const GreyImage *in, Kernel k, GreyImage *out)
{
    double *line = g_new(double, (gsize)in->width + 2 * (gsize)k.r);
    for (uint32_t y = 0; y < in->height; y++) {
        for (gsize i = 0; i < (gsize)in->width + 2 * (gsize)k.r; i++)
            line[i] = (double)in->px[grey_index(in, (int64_t)i - k.r, y)];
        for (uint32_t x = 0; x < in->width; x++) {
            const double *c = line + x + k.r;
            double sum = k.w[0] * c[0];
            for (uint32_t i = 1; i <= k.r; i++)
                sum += k.w[i] * (c[-(int64_t)i] + c[i]);
            out->px[(gsize)y * in->width + x] = (float)sum;
        }
    }
    g_free(line);
}

static void convolve_columns(const GreyImage *in, Kernel k, GreyImage *out)
{
    double *sum = g_new(double, in->width);
    for (uint32_t y = 0; y < in->height; y++) {
        const float *c = in->px + (gsize)y * in->width;
        for (uint32_t x = 0; x < in->width; x++)
            sum[x] = k.w[0] * (double)c[x];
        for (uint32_t i = 1; i <= k.r; i++) {
            const float *up = in->px + grey_index(in, 0, (int64_t)y - i);
            const float *down = in->px + grey_index(in, 0, (int64_t)y + i);
            for (uint32_t x = 0; x < in->width; x++)
                sum[x] += k.w[i] * ((double)up[x] + (double)down[x]);
        }
        for (uint32_t x = 0; x < in->width; x++)
            out->px[(gsize)y * in->width + x] = (float)sum[x];
    }
    g_free(sum);
}

GreyImage *convolve(const GreyImage *in, Kernel along_x, Kernel along_y)
{
    GreyImage *rows = grey_image_new(in->width, in->height), *out = grey_image_new(in->width, in->height);
    convolve_rows(in, along_x, rows);
    convolve_columns(rows, along_y, out);
    grey_image_free(rows);
    return out;
}
