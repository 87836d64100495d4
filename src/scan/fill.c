#include "scan/fill.h"

#include "scan/fill_grain.h"
#include "scan/fill_pyramid.h"
#include "scan/openings.h"
#include "scan/stalk_over.h"

#define INSET 0.008     /* share of the root of the leaf's area: shadows at the rims of leaves that don't lie quite flat */
#define LEAST_INSET 3.0 /* pixels: what scanners and JPEG blur */
#define BESIDE 0.3      /* widths of a petiole that lies over the blade: its shadow reaches so far */
#define LONG 12.0       /* area of a part that is thinner than the inset but no tip, in squares of the inset */

double scan_fill_inset(double area) { return MAX(INSET * sqrt(area), LEAST_INSET); }

typedef struct {
    Scan *scan;
    Mask mask;
    MaskBox box;
    FillPyramid means;
    FillGrain grain;
} Fill;

/* ---- what is surely leaf ---- */

static bool any(const Mask *m, uint8_t bit)
{
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++)
            if (*mask_at(m, x, y) & bit)
                return true;
    return false;
}

/* MASK_STALK on long parts that the inset wiped out. */
static void find_thin(const Mask *m, double inset)
{
    static const Flood count = {MASK_WORK | MASK_SEEN, MASK_WORK, MASK_SEEN, true};
    static const Flood take = {MASK_WORK | MASK_SEEN | MASK_STALK, MASK_WORK | MASK_SEEN, MASK_STALK, true};
    mask_dilate(m, MASK_CORE, MASK_WORK, inset + 1.0);
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++) {
            uint8_t *px = mask_at(m, x, y);
            bool rest = (*px & (MASK_LEAF | MASK_WORK)) == MASK_LEAF;
            *px = (uint8_t)((*px & ~MASK_WORK) | (rest ? MASK_WORK : 0));
        }
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++)
            if ((*mask_at(m, x, y) & count.test) == count.want && (double)mask_flood(m, &count, x, y, NULL) >= LONG * inset * inset)
                mask_flood(m, &take, x, y, NULL);
}

/* Takes a petiole that lies over the blade, and its shadow, out of the leaf. */
static void take_out_stalk(const Fill *f, const Polygon *outline, const Threshold *t)
{
    StalkOver *over = t ? stalk_over_find(f->scan, outline, t, outline->v[0]) : NULL;
    for (uint32_t y = 0; over && y < f->mask.height; y++)
        for (uint32_t x = 0; x < f->mask.width; x++) {
            Vec2 q = vec2(f->box.x0 + x + 0.5, f->scan->height - (f->box.y0 + y + 0.5));
            if (box_has(box_grow(over->box, BESIDE * over->width), q) && stalk_over_distance(over, q, NULL) <= BESIDE * over->width)
                *mask_at(&f->mask, x, y) &= (uint8_t)~MASK_LEAF;
        }
    stalk_over_free(over);
}

/* MASK_CORE: what lies `inset` within the leaf, and of long parts that are thinner what lies half as deep. */
static bool mark_core(const Mask *m, double inset)
{
    do
        mask_erode(m, MASK_LEAF, MASK_CORE, inset);
    while (!any(m, MASK_CORE) && (inset *= 0.5) >= 0.5);
    find_thin(m, inset);
    mask_erode(m, MASK_LEAF, MASK_WORK, 0.5 * inset);
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++) {
            uint8_t *px = mask_at(m, x, y);
            if ((*px & (MASK_WORK | MASK_STALK)) == (MASK_WORK | MASK_STALK))
                *px |= MASK_CORE;
        }
    mask_clear(m, MASK_WORK | MASK_SEEN | MASK_STALK);
    return any(m, MASK_CORE);
}

/* ---- what takes the place of the rest ---- */

enum { GRAIN_LEVEL = 2 }; /* grain is what means over 8 pixels don't have */

static void put_sample(Scan *s, uint32_t x, uint32_t y, uint32_t channel, double value)
{
    gsize i = ((gsize)y * s->width + x) * s->channels + channel;
    double most = s->depth == 8 ? 255.0 : 65535.0, v = CLAMP(value + 0.5, 0.0, most);
    if (s->depth == 8)
        ((uint8_t *)s->px)[i] = (uint8_t)v;
    else
        ((uint16_t *)s->px)[i] = (uint16_t)v;
}

static double grain_at(const Fill *f, const GrainSource *from, uint32_t x, uint32_t y, uint32_t channel)
{
    uint32_t i = x % GRAIN_CELL, j = y % GRAIN_CELL;
    i = from->x * GRAIN_CELL + (from->flip_x ? GRAIN_CELL - 1 - i : i);
    j = from->y * GRAIN_CELL + (from->flip_y ? GRAIN_CELL - 1 - j : j);
    return scan_sample(f->scan, f->box.x0 + i, f->box.y0 + j, channel) - fill_pyramid_at(&f->means, GRAIN_LEVEL, i + 0.5, j + 0.5);
}

static void fill_cell(const Fill *f, uint32_t cx, uint32_t cy, uint32_t channel)
{
    GrainSource from;
    int lent = -1; /* not asked for yet */
    for (uint32_t y = cy * GRAIN_CELL; y < MIN((cy + 1) * GRAIN_CELL, f->mask.height); y++)
        for (uint32_t x = cx * GRAIN_CELL; x < MIN((cx + 1) * GRAIN_CELL, f->mask.width); x++) {
            uint8_t px = *mask_at(&f->mask, x, y);
            if ((px & (MASK_SEEN | MASK_CORE)) != MASK_SEEN)
                continue;
            double v = fill_pyramid_at(&f->means, 0, x + 0.5, y + 0.5);
            if ((px & MASK_THIS) && lent < 0)
                lent = f->means.n > GRAIN_LEVEL && fill_grain_source(&f->grain, cx, cy, &from);
            if ((px & MASK_THIS) && lent > 0)
                v += grain_at(f, &from, x, y, channel);
            put_sample(f->scan, f->box.x0 + x, f->box.y0 + y, channel, v);
        }
}

static void fill_all(Fill *f)
{
    fill_grain_init(&f->grain, f->scan, &f->mask, f->box);
    fill_pyramid_init(&f->means, &f->mask, f->scan->depth);
    for (uint32_t c = 0; c < f->scan->channels; c++) {
        fill_pyramid_take(&f->means, f->scan, c, &f->mask, f->box);
        for (uint32_t y = 0; y < f->grain.height; y++)
            for (uint32_t x = 0; x < f->grain.width; x++)
                fill_cell(f, x, y, c);
    }
    fill_pyramid_clear(&f->means);
    fill_grain_clear(&f->grain);
}

void scan_fill(Scan *s, const Polygon *outline, const Threshold *t, double inset, uint32_t around)
{
    Fill f = {.scan = s};
    if (!openings_box(s, outline, around, &f.box))
        return;
    f.mask = (Mask){f.box.x1 - f.box.x0 + 1, f.box.y1 - f.box.y0 + 1, f.box.x1 - f.box.x0 + 1, NULL};
    f.mask.px = g_malloc0((gsize)f.mask.width * f.mask.height);
    openings_mark(s, outline, t, openings_least(outline->area), &f.mask, f.box);
    take_out_stalk(&f, outline, t);
    if (mark_core(&f.mask, inset)) {
        mask_dilate(&f.mask, MASK_THIS, MASK_SEEN, around);
        fill_all(&f);
    }
    g_free(f.mask.px);
}
