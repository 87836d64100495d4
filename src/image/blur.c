#include "image/blur.h"

#include <glib.h>
#include <string.h>

#include "geom/wide.h"

enum { COLUMNS = 16 }; /* blurred together, as they share cache lines */

typedef struct {
    int32_t *px;
    uint32_t width, height, half;
} Blur;

/* One box filter over n values, `lanes` of them side by side. Sums are of whole numbers below 2^53, so that they are exact. */
WIDE static void box(const int32_t *restrict in, int32_t *restrict out, uint32_t n, uint32_t half, uint32_t lanes)
{
    double sum[COLUMNS] = {0}, gain = 1.0 / (2.0 * half + 1.0);
    for (uint32_t i = 0; i < MIN(half, n); i++)
        for (uint32_t k = 0; k < lanes; k++)
            sum[k] += (double)in[(gsize)i * lanes + k];
    for (uint32_t i = 0; i < n; i++) {
        gsize enters = (gsize)(i + half) * lanes, here = (gsize)i * lanes, leaves = i >= half ? here - (gsize)half * lanes : 0;
        for (uint32_t k = 0; n - i > half && k < lanes; k++)
            sum[k] += (double)in[enters + k];
        for (uint32_t k = 0; k < lanes; k++)
            out[here + k] = (int32_t)(sum[k] * gain + 0.5);
        for (uint32_t k = 0; i >= half && k < lanes; k++)
            sum[k] -= (double)in[leaves + k];
    }
}

/* The same of a few pixels, each sum anew, for many pixels at a time; on either side of `in` there are `half` zeros. */
enum { FEW = 4, STRETCH = 256 };

WIDE static void narrow_box(const int32_t *restrict in, int32_t *restrict out, uint32_t n, uint32_t half)
{
    double sum[STRETCH], gain = 1.0 / (2.0 * half + 1.0);
    for (uint32_t first = 0; first < n; first += STRETCH) {
        uint32_t count = MIN(n - first, (uint32_t)STRETCH);
        for (uint32_t i = 0; i < count; i++)
            sum[i] = (double)in[first + i];
        for (uint32_t off = 1; off <= half; off++) {
            const int32_t *left = in + first - off, *right = in + first + off;
            for (uint32_t i = 0; i < count; i++)
                sum[i] += (double)left[i] + (double)right[i];
        }
        for (uint32_t i = 0; i < count; i++)
            out[first + i] = (int32_t)(sum[i] * gain + 0.5);
    }
}

static void blur_rows(uint32_t first, uint32_t last, void *user)
{
    const Blur *b = user;
    int32_t *line = g_new0(int32_t, 2 * ((gsize)b->width + 2 * FEW)) + FEW, *other = line + b->width + 2 * FEW;
    for (uint32_t y = first; y < last; y++) {
        int32_t *row = b->px + (gsize)y * b->width;
        if (b->half <= FEW) { /* zeros stay on either side */
            memcpy(line, row, b->width * sizeof *row);
            narrow_box(line, other, b->width, b->half);
            narrow_box(other, row, b->width, b->half);
        } else {
            box(row, line, b->width, b->half, 1);
            box(line, row, b->width, b->half, 1);
        }
    }
    g_free(line - FEW);
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
