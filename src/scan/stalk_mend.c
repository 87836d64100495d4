/* The blade below a petiole that lies over it. */
#include <math.h>

#include "scan/stalk_over.h"

static const double disc = 1.25;  /* its widths: radius of the disc that closes the blade across it */
static const double at_end = 1.5; /* widths from the blade: its end that looks out is none of it */

/* MASK_THIS on the blade, MASK_STALK on pixels of the petiole that may be blade below. Both are of one window, but `m` has a border. */
static void lay_out(const StalkOver *o, const Mask *w, Vec2 corner, uint32_t x0, uint32_t y0, uint32_t border, const Mask *m)
{
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++) {
            int64_t i = (int64_t)x0 + x - border, j = (int64_t)y0 + y - border;
            if (i < 0 || j < 0 || i >= w->width || j >= w->height)
                continue;
            uint8_t px = *mask_at(w, (uint32_t)i, (uint32_t)j);
            Vec2 q = vec2(corner.x + (double)i, corner.y - (double)j);
            uint32_t at = 0;
            bool on = stalk_over_distance(o, q, &at) <= 1.0, blade = (px & (MASK_THIS | MASK_STALK)) == MASK_THIS;
            if (on && o->point[at].over && o->point[MIN(at + 1, o->n - 1)].over)
                blade = true;
            else if (on && at < o->first)
                blade = false;
            bool may = on && (at >= o->first || vec_dist(q, o->point[o->first].p) <= at_end * o->width);
            *mask_at(m, x, y) = (uint8_t)((blade ? MASK_THIS : 0) | (on ? MASK_CORE : 0) | (may ? MASK_STALK : 0));
        }
}

void stalk_over_mend(const StalkOver *o, const Mask *w, Vec2 corner)
{
    const double r = disc * o->width, around = 2.0 * r + 2.0;
    const uint32_t border = (uint32_t)ceil(around);
    MaskBox b = {(uint32_t)CLAMP(o->box.x0 - around - corner.x, 0.0, w->width - 1.0), (uint32_t)CLAMP(corner.y - o->box.y1 - around, 0.0, w->height - 1.0),
                 (uint32_t)CLAMP(o->box.x1 + around - corner.x, 0.0, w->width - 1.0), (uint32_t)CLAMP(corner.y - o->box.y0 + around, 0.0, w->height - 1.0)};
    Mask m = {b.x1 - b.x0 + 1 + 2 * border, b.y1 - b.y0 + 1 + 2 * border, b.x1 - b.x0 + 1 + 2 * border, NULL};
    m.px = g_malloc0((gsize)m.width * m.height);
    lay_out(o, w, corner, b.x0, b.y0, border, &m);
    mask_dilate(&m, MASK_THIS, MASK_WORK, r);
    mask_erode(&m, MASK_WORK, MASK_WORK, r);
    for (uint32_t y = b.y0; y <= b.y1; y++)
        for (uint32_t x = b.x0; x <= b.x1; x++) {
            uint8_t is = *mask_at(&m, x - b.x0 + border, y - b.y0 + border), *px = mask_at(w, x, y);
            bool blade = (is & MASK_THIS) || (is & (MASK_WORK | MASK_STALK)) == (MASK_WORK | MASK_STALK);
            if (is & MASK_CORE)
                *px = blade ? (uint8_t)((*px | MASK_THIS) & ~MASK_STALK) : (uint8_t)(*px & MASK_THIS ? *px | MASK_STALK : *px);
        }
    g_free(m.px);
}
