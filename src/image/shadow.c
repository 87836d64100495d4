#include "image/shadow.h"

#include <glib.h>

#include "image/blur.h"

enum { HALF = 2, PASSES = 2, BORDER = 2 * HALF * PASSES + 2, CELLS = 2048, ONE = 1 << 24 };

struct Shadow {
    uint32_t nx, ny;
    double step; /* side of a cell, pixels */
    int32_t *px; /* coverage, of ONE */
};

Shadow *shadow_new(const Painter *p, double sigma)
{
    /* each pass is two boxes of 2 HALF + 1 cells, whose variances add up */
    const double cells = sqrt(2.0 * PASSES * ((2.0 * HALF + 1.0) * (2.0 * HALF + 1.0) - 1.0) / 12.0);
    Shadow *s = g_new0(Shadow, 1);
    s->step = MAX(sigma / cells, MAX(0.5, MAX(p->width, p->rows) / (double)CELLS));
    s->nx = (uint32_t)ceil(p->width / s->step) + 2 * BORDER;
    s->ny = (uint32_t)ceil(p->rows / s->step) + 2 * BORDER;
    double scale = p->frame.scale / s->step, border = BORDER / scale;
    Frame frame = {s->nx, s->ny, scale, vec2(p->frame.corner.x - border, p->frame.corner.y + border)};
    Painter *coarse = painter_new(p->net, &frame, &p->style);
    const float *blade = painter_blade(coarse);
    gsize n = (gsize)s->nx * s->ny;
    s->px = g_new(int32_t, n);
    for (gsize i = 0; i < n; i++)
        s->px[i] = (int32_t)((double)blade[i] * ONE);
    for (int i = 0; i < PASSES; i++)
        image_blur(p->pool, s->px, s->nx, s->ny, HALF);
    painter_free(coarse);
    return s;
}

void shadow_free(Shadow *s)
{
    if (s == NULL)
        return;
    g_free(s->px);
    g_free(s);
}

double shadow_at(const Shadow *s, Vec2 at)
{
    double x = CLAMP(at.x / s->step + BORDER - 0.5, 0.0, s->nx - 1.001), y = CLAMP(at.y / s->step + BORDER - 0.5, 0.0, s->ny - 1.001);
    uint32_t ix = (uint32_t)x, iy = (uint32_t)y;
    const int32_t *row = s->px + (gsize)iy * s->nx + ix, *below = row + s->nx;
    x -= ix;
    y -= iy;
    double up = row[0] + (double)(row[1] - row[0]) * x, low = below[0] + (double)(below[1] - below[0]) * x;
    return (up + (low - up) * y) / ONE;
}
