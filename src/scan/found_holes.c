/* Holes by the threshold that parts the leaf from its ground: where they lie in shadow their colour alone doesn't tell them from the blade. */
#include "scan/found_parts.h"
#include "scan/mask.h"

static const double hole_radius = 0.004; /* of the leaf's length: veins and glare are thinner, most of them, and what is smaller isn't seen by the filter */
static const double known_share = 0.5;   /* of its middle: a hole that is marked already stays as it is */
static const double rim = 2.0;           /* working pixels, which are of both */

/* How far a working pixel is on the ground's side of the threshold. */
static double beyond(const FoundLeaf *l, const Threshold *t, uint32_t x, uint32_t y)
{
    double sx = l->x0 + (x + 0.5) * l->step, sy = l->y0 + (y + 0.5) * l->step;
    if (!(sx >= 0.0 && sy >= 0.0 && sx < l->scan->width && sy < l->scan->height))
        return -1.0;
    double v = channel_value(l->scan, t->channel, (uint32_t)sx, (uint32_t)sy) - t->level;
    return t->dark ? v : -v;
}

/* Half of what the ground around the leaf is off, as in scan/openings.h. */
static double half_ground(const FoundLeaf *l, const Threshold *t)
{
    double sum = 0.0, n = 0.0;
    for (uint32_t y = 0; y < l->height; y++)
        for (uint32_t x = 0; x < l->width; x++) {
            double v = l->inside[(gsize)y * l->width + x] || l->hole[(gsize)y * l->width + x] ? -1.0 : beyond(l, t, x, y);
            sum += MAX(v, 0.0);
            n += v >= 0.0;
        }
    return n > 0.0 ? 0.5 * sum / n : HUGE_VAL;
}

/* One part, just flooded with MASK_HOLE: MASK_WORK where it is a hole, nothing where it is but pale or was known. */
static void settle(const FoundLeaf *l, const Threshold *t, double least, const Mask *m, MaskBox box)
{
    double sum = 0.0, n = 0.0, known = 0.0;
    for (uint32_t pass = 0; pass < 2; pass++)
        for (uint32_t y = box.y0; y <= box.y1; y++)
            for (uint32_t x = box.x0; x <= box.x1; x++) {
                uint8_t *px = mask_at(m, x, y);
                if ((*px & (MASK_HOLE | MASK_SEEN)) != MASK_HOLE)
                    continue;
                if (pass == 1) {
                    *px = (uint8_t)(MASK_SEEN | MASK_HOLE | (sum >= least * n && known < known_share * n ? MASK_WORK : 0));
                } else if (*px & MASK_CORE) {
                    sum += beyond(l, t, x, y);
                    n += 1.0;
                    known += l->hole[(gsize)y * l->width + x];
                }
            }
}

void found_open_holes(FoundLeaf *l, const Threshold *t, const Vec2 *base, double thick)
{
    static const Flood flood = {MASK_LEAF | MASK_HOLE, MASK_LEAF, MASK_HOLE, false};
    gsize n = (gsize)l->width * l->height;
    Mask m = {l->width, l->height, l->width, g_new0(uint8_t, n)};
    for (gsize i = 0; i < n; i++) {
        uint32_t x = (uint32_t)(i % l->width), y = (uint32_t)(i / l->width);
        Vec2 at = vec2(l->x0 + (x + 0.5) * l->step, l->scan->height - l->y0 - (y + 0.5) * l->step);
        if ((l->inside[i] || l->hole[i]) && !(base && vec_dist(at, *base) < thick) && beyond(l, t, x, y) > 0.0)
            m.px[i] = MASK_LEAF;
    }
    mask_erode(&m, MASK_LEAF, MASK_CORE, hole_radius * l->length);
    double least = half_ground(l, t);
    for (uint32_t y = 0; y < m.height; y++)
        for (uint32_t x = 0; x < m.width; x++) {
            MaskBox box;
            if (!(*mask_at(&m, x, y) & MASK_CORE)) /* settled ones have none any more */
                continue;
            mask_flood(&m, &flood, x, y, &box);
            settle(l, t, least, &m, box);
        }
    mask_dilate(&m, MASK_WORK, MASK_WORK, rim);
    for (gsize i = 0; i < n; i++)
        if (l->inside[i] && (m.px[i] & MASK_WORK)) {
            l->inside[i] = 0;
            l->hole[i] = 1;
        }
    g_free(m.px);
}
