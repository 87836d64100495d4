#include "scan/openings.h"

#include "geom/march.h"
#include "geom/ring.h"

#define LEAST_LEAF 0.75  /* of what is in the outline */
#define LEAST_SIZE 0.003 /* share of the root of the leaf's area */

double openings_least(double area) { return MAX(LEAST_SIZE * sqrt(area), 1.0); }

bool openings_box(const Scan *s, const Polygon *outline, double around, MaskBox *box)
{
    double x0 = outline->box.x0 - around, x1 = outline->box.x1 + around, y0 = s->height - outline->box.y1 - around, y1 = s->height - outline->box.y0 + around;
    if (x1 <= 0.0 || y1 <= 0.0 || x0 >= s->width || y0 >= s->height)
        return false;
    *box = (MaskBox){(uint32_t)MAX(x0, 0.0), (uint32_t)MAX(y0, 0.0), (uint32_t)MIN(x1, s->width - 1.0), (uint32_t)MIN(y1, s->height - 1.0)};
    return true;
}

static bool is_leaf(const Scan *s, const Threshold *t, uint32_t x, uint32_t y) { return ((double)channel_value(s, t->channel, x, y) < t->level) == t->dark; }

static bool is_in(const Scan *s, const Polygon *outline, uint32_t x, uint32_t y) { return polygon_contains(outline, vec2(x + 0.5, s->height - (y + 0.5))); }

bool openings_threshold(const Scan *s, const Polygon *outline, const ThresholdDef *def, Threshold *out)
{
    enum { LINES = 512 };
    MaskBox b;
    if (!openings_box(s, outline, 0.0, &b) || !threshold_find(s, def, out, NULL))
        return false;
    uint32_t step = MAX(b.x1 - b.x0, b.y1 - b.y0) / LINES + 1;
    uint64_t in = 0, leaf = 0;
    for (uint32_t y = b.y0; y <= b.y1; y += step)
        for (uint32_t x = b.x0; x <= b.x1; x += step)
            if (is_in(s, outline, x, y)) {
                in++;
                leaf += is_leaf(s, out, x, y);
            }
    if (def->side == LEAF_BY_FRAME && 2 * leaf < in) {
        out->dark = !out->dark;
        leaf = in - leaf;
    }
    return in > 0 && (double)leaf >= LEAST_LEAF * (double)in;
}

/* ---- marking ---- */

static bool touches_outside(const Mask *m, uint32_t x, uint32_t y)
{
    return x == 0 || y == 0 || x + 1 == m->width || y + 1 == m->height || !(*mask_at(m, x - 1, y) & MASK_THIS) || !(*mask_at(m, x + 1, y) & MASK_THIS) ||
           !(*mask_at(m, x, y - 1) & MASK_THIS) || !(*mask_at(m, x, y + 1) & MASK_THIS);
}

typedef struct {
    const Scan *scan;
    const Threshold *threshold;
    const Mask *mask;
    MaskBox box;
    double behind; /* how far off the threshold, on the background's side, an opening is; below that it is a pale spot */
} Marking;

static double beyond(const Marking *k, uint32_t x, uint32_t y)
{
    double v = channel_value(k->scan, k->threshold->channel, k->box.x0 + x, k->box.y0 + y) - k->threshold->level;
    return k->threshold->dark ? v : -v;
}

/* Half of what the background around the leaf is off. */
static double half_background(const Marking *k)
{
    double sum = 0.0;
    uint64_t n = 0;
    for (uint32_t y = 0; y < k->mask->height; y++)
        for (uint32_t x = 0; x < k->mask->width; x++) {
            double v = *mask_at(k->mask, x, y) & MASK_THIS ? -1.0 : beyond(k, x, y);
            if (v < 0.0)
                continue;
            sum += v;
            n++;
        }
    return n > 0 ? 0.5 * sum / (double)n : 0.0;
}

/* One opening, just flooded with MASK_HOLE, becomes MASK_OUT when it reaches the outline, and leaf when its middle is only pale. MASK_SEEN is on those
 * before it. */
static void settle(const Marking *k, MaskBox box)
{
    Mask w = mask_window(k->mask, box);
    bool out = false;
    double sum = 0.0;
    uint64_t n = 0;
    for (uint32_t y = 0; y < w.height; y++)
        for (uint32_t x = 0; x < w.width; x++) {
            uint8_t px = *mask_at(&w, x, y);
            if ((px & (MASK_HOLE | MASK_SEEN)) != MASK_HOLE)
                continue;
            out = out || touches_outside(k->mask, box.x0 + x, box.y0 + y);
            if (px & MASK_CORE) {
                sum += beyond(k, box.x0 + x, box.y0 + y);
                n++;
            }
        }
    uint8_t is = sum < k->behind * (double)n ? 0 : out ? MASK_OUT : MASK_HOLE;
    for (uint32_t y = 0; y < w.height; y++)
        for (uint32_t x = 0; x < w.width; x++) {
            uint8_t *px = mask_at(&w, x, y);
            if ((*px & (MASK_HOLE | MASK_SEEN)) == MASK_HOLE)
                *px = (uint8_t)((*px & ~(MASK_HOLE | MASK_CORE | MASK_WORK)) | is | MASK_SEEN);
        }
}

void openings_mark(const Scan *s, const Polygon *outline, const Threshold *t, double least, const Mask *m, MaskBox box)
{
    static const Flood flood = {MASK_WORK | MASK_HOLE, MASK_WORK, MASK_HOLE, false};
    bool any = false;
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++) {
            if (!is_in(s, outline, box.x0 + x, box.y0 + y))
                continue;
            bool leaf = !t || is_leaf(s, t, box.x0 + x, box.y0 + y);
            *mask_at(m, x, y) = (uint8_t)(MASK_THIS | (leaf ? 0 : MASK_WORK));
            any |= !leaf;
        }
    Marking k = {s, t, m, box, any ? half_background(&(Marking){s, t, m, box, 0.0}) : 0.0};
    if (any)
        mask_erode(m, MASK_WORK, MASK_CORE, least);
    for (uint32_t y = 0; any && y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++) {
            MaskBox found;
            if (!(*mask_at(m, x, y) & MASK_CORE)) /* settled ones have none any more */
                continue;
            mask_flood(m, &flood, x, y, &found);
            settle(&k, found);
        }
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++) {
            uint8_t *px = mask_at(m, x, y);
            bool leaf = (*px & (MASK_THIS | MASK_HOLE | MASK_OUT)) == MASK_THIS;
            *px = (uint8_t)((*px & (MASK_THIS | MASK_HOLE | MASK_OUT)) | (leaf ? MASK_LEAF : 0));
        }
}

/* ---- curves ---- */

typedef struct {
    const Scan *scan;
    const Threshold *threshold;
    MaskBox box;
} Levels;

static double level_of(const void *user, uint32_t x, uint32_t y)
{
    const Levels *l = user;
    return channel_value(l->scan, l->threshold->channel, l->box.x0 + x, l->box.y0 + y);
}

/* From y-up pixels of the box to those of the scan, with fewer points. */
static void add_curve(Holes *h, const Vec2 *p, uint32_t n, const Affine *place, double tolerance)
{
    Polygon *traced = polygon_new(p, n), *fewer = ring_simplify(traced, tolerance, NULL);
    for (uint32_t i = 0; i < fewer->n; i++)
        fewer->v[i] = affine_apply(place, fewer->v[i]);
    holes_add(h, fewer->v, fewer->n);
    polygon_free(traced);
    polygon_free(fewer);
}

Holes *openings_trace(const Scan *s, const Polygon *outline, const Threshold *t, double least, double tolerance)
{
    Holes *h = holes_new();
    Levels levels = {.scan = s, .threshold = t};
    MaskBox *b = &levels.box;
    if (!openings_box(s, outline, 1.0, b))
        return h;
    Mask m = {b->x1 - b->x0 + 1, b->y1 - b->y0 + 1, b->x1 - b->x0 + 1, NULL};
    m.px = g_malloc0((gsize)m.width * m.height);
    openings_mark(s, outline, t, least, &m, *b);
    MarchField f = {.px = m.px, .width = m.width, .height = m.height, .test = MASK_HOLE, .want = 0, .x1 = m.width - 1, .y1 = m.height - 1,
                    .level = level_of, .user = &levels, .threshold = t->level};
    MarchLoops *loops = march_loops(&f, 1);
    Affine place = {.a = 1.0, .d = 1.0, .e = b->x0, .f = (double)s->height - b->y1 - 1.0};
    for (uint32_t k = 0; k < loops->n; k++)
        if (loops->area[k] < 0.0)
            add_curve(h, loops->p + loops->start[k], loops->start[k + 1] - loops->start[k], &place, tolerance);
    march_loops_free(loops);
    g_free(m.px);
    return h;
}
