#include "image/blur.h"

#include <glib.h>
#include <string.h>

enum { COLUMNS = 16 }; /* blurred together, as they share cache lines */

typedef struct {
    int32_t *px;
    uint32_t width, height, half;
} Blur;

/* One box filter over n values, `lanes` of them side by side. */
static void box(const int32_t *in, int32_t *out, uint32_t n, uint32_t half, uint32_t lanes)
{
    int64_t sum[COLUMNS] = {0};
    double gain = 1.0 / (2.0 * half + 1.0);
    for (uint32_t i = 0; i < MIN(half, n); i++)
        for (uint32_t k = 0; k < lanes; k++)
            sum[k] += in[(gsize)i * lanes + k];
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = 0; k < lanes; k++) {
            if (n - i > half)
                sum[k] += in[(gsize)(i + half) * lanes + k];
            out[(gsize)i * lanes + k] = (int32_t)((double)sum[k] * gain + 0.5);
            if (i >= half)
                sum[k] -= in[(gsize)(i - half) * lanes + k];
        }
}

static void blur_rows(uint32_t first, uint32_t last, void *user)
{
    const Blur *b = user;
    int32_t *line = g_new(int32_t, b->width);
    for (uint32_t y = first; y < last; y++) {
        int32_t *row = b->px + (gsize)y * b->width;
        box(row, line, b->width, b->half, 1);
        box(line, row, b->width, b->half, 1);
    }
    g_free(line);
}

static void blur_columns(uint32_t first, uint32_t last, void *user)
{
    const Blur *b = user;
    uint32_t lanes = last - first;
    int32_t *line = g_new(int32_t, 2 * (gsize)b->height * lanes), *other = line + (gsize)b->height * lanes;
    for (uint32_t y = 0; y < b->height; y++)
        memcpy(line + (gsize)y * lanes, b->px + (gsize)y * b->width + first, lanes * sizeof *line);
    box(line, other, b->height, b->half, lanes);
    box(other, line, b->height, b->half, lanes);
    for (uint32_t y = 0; y < b->height; y++)
        memcpy(b->px + (gsize)y * b->width + first, line + (gsize)y * lanes, lanes * sizeof *line);
    g_free(line);
}

void image_blur(Pool *pool, int32_t *px, uint32_t width, uint32_t height, uint32_t half)
{
    Blur b = {px, width, height, half};
    if (half == 0)
        return;
    pool_for(pool, height, 16, blur_rows, &b);
    pool_for(pool, width, COLUMNS, blur_columns, &b);
}
