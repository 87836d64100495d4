#include "image/blur.h"

#include <glib.h>
#include <string.h>

#include "geom/parallel.h"

enum { COLUMNS = 16 }; /* blurred together, as they share cache lines */

typedef struct {
    float *px;
    uint32_t width, height, half; /* boxes of 2 half + 1 pixels */
} Blur;

/* One box filter over n values, `lanes` of them side by side. */
static void box(const float *in, float *out, uint32_t n, uint32_t half, uint32_t lanes)
{
    double sum[COLUMNS] = {0.0}, gain = 1.0 / (2.0 * half + 1.0);
    for (uint32_t i = 0; i < MIN(half, n); i++)
        for (uint32_t k = 0; k < lanes; k++)
            sum[k] += (double)in[(gsize)i * lanes + k];
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = 0; k < lanes; k++) {
            if (n - i > half)
                sum[k] += (double)in[(gsize)(i + half) * lanes + k];
            out[(gsize)i * lanes + k] = (float)(sum[k] * gain);
            if (i >= half)
                sum[k] -= (double)in[(gsize)(i - half) * lanes + k];
        }
}

static void blur_rows(uint32_t first, uint32_t last, void *user)
{
    const Blur *b = user;
    float *line = g_new(float, b->width);
    for (uint32_t y = first; y < last; y++) {
        float *row = b->px + (gsize)y * b->width;
        box(row, line, b->width, b->half, 1);
        box(line, row, b->width, b->half, 1);
    }
    g_free(line);
}

static void blur_columns(uint32_t first, uint32_t last, void *user)
{
    const Blur *b = user;
    uint32_t lanes = last - first;
    float *line = g_new(float, 2 * (gsize)b->height * lanes), *other = line + (gsize)b->height * lanes;
    for (uint32_t y = 0; y < b->height; y++)
        memcpy(line + (gsize)y * lanes, b->px + (gsize)y * b->width + first, lanes * sizeof(float));
    box(line, other, b->height, b->half, lanes);
    box(other, line, b->height, b->half, lanes);
    for (uint32_t y = 0; y < b->height; y++)
        memcpy(b->px + (gsize)y * b->width + first, line + (gsize)y * lanes, lanes * sizeof(float));
    g_free(line);
}

void image_blur(float *px, uint32_t width, uint32_t height, double radius, unsigned threads)
{
    Blur b = {px, width, height, (uint32_t)CLAMP(0.5 * radius + 0.5, 0.0, 1e6)};
    if (b.half == 0)
        return;
    parallel_for(threads, height, 16, blur_rows, &b);
    parallel_for(threads, width, COLUMNS, blur_columns, &b);
}
