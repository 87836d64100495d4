#include "scan/threshold_sheet.h"

#define COARSE 400     /* cells along the longer side that the image is looked at in */
#define CLOSE 2.0      /* cells: lines on paper */
#define OPEN 0.015     /* of the longer side: stalks, cables, lettering */
#define LEAST_SHEET 0.08 /* of the image */
#define MOST_FRAME 0.98 /* of the frame is sheet: a table shows there */
#define ASTRAY 0.1     /* of what would be the leaf: so much of it lies beyond the sheet, as a table does */
#define INSET 2.5      /* cells: the sheet's edge, its shadow, unevenness */
/* A leaf on a sheet: */
#define LEAST_LEAF 0.01 /* of the sheet: what is smaller is print or dirt, */
#define MOST_LEAF 0.8   /* what is larger isn't on it; */
#define LEAST_PARTED 0.5
#define LEAST_CONTRAST 0.08
#define LEAST_FRAME 0.8
#define MOST_CHROMA 0.35 /* of the sheet, as yellowed or brown paper has it … */
#define MOST_GREEN 0.04  /* … and greenness: else it is a leaf itself */
/* A leaf that fills the image: */
#define FULL_FRAME 0.9   /* of the frame: not on paper that shows so much of itself there */
#define PALER 0.1        /* of the scale: than a leaf is paper, … */
#define GREYER 0.05      /* … by so much chroma, … */
#define LESS_GREEN 0.03  /* … or greenness */

/* The image as cells of step × step pixels. */
typedef struct {
    const Scan *scan;
    uint32_t step, width, height;
} Cells;

static Cells cells_of(const Scan *s)
{
    Cells c = {.scan = s, .step = (MAX(s->width, s->height) + COARSE - 1) / COARSE};
    c.width = (s->width + c.step - 1) / c.step;
    c.height = (s->height + c.step - 1) / c.step;
    return c;
}

/* Samples along a side of a cell, and where in the image the i-th of n of them lies. */
static uint32_t samples(const Cells *c) { return MIN(c->step, 3); }
static uint32_t sample_at(uint32_t cell, uint32_t step, uint32_t i, uint32_t n, uint32_t size) { return MIN(cell * step + (2 * i + 1) * step / (2 * n), size - 1); }

static Mask cells_mask(const Cells *c) { return (Mask){c->width, c->height, c->width, g_malloc0((gsize)c->width * c->height)}; }

/* MASK_LEAF on cells of which most is leaf by a threshold, on its sheet. */
static Mask cells_leaf(const Cells *c, const Threshold *t)
{
    const Scan *s = c->scan;
    uint32_t across = samples(c);
    Mask m = cells_mask(c);
    for (uint32_t y = 0; y < m.height; y++) {
        uint32_t from = 0, to = s->width;
        if (t->sheet.n > 0 && !paper_span(&t->sheet, s->width, sample_at(y, c->step, 0, 1, s->height), &from, &to))
            continue;
        for (uint32_t x = from / c->step; x < m.width && x * c->step < to; x++) {
            uint32_t n = 0;
            for (uint32_t k = 0; k < across * across; k++)
                n += ((double)channel_value(s, t->channel, sample_at(x, c->step, k % across, across, s->width),
                                            sample_at(y, c->step, k / across, across, s->height)) < t->level) == t->dark;
            *mask_at(&m, x, y) = 2 * n > across * across ? MASK_LEAF : 0;
        }
    }
    return m;
}

/* ---- colours ---- */

/* Means of a class, shares of the scale. */
typedef struct {
    double n, colour[3];
} Tone;

static double chroma(const Tone *t)
{
    const double *c = t->colour;
    return (MAX(MAX(c[0], c[1]), c[2]) - MIN(MIN(c[0], c[1]), c[2]));
}

static double greenness(const Tone *t) { return (2.0 * t->colour[1] - t->colour[0] - t->colour[2]) / 4.0; }
static double brightness(const Tone *t) { return (t->colour[0] + t->colour[1] + t->colour[2]) / 3.0; }

/* Of cells that are leaf, tone[1], and that are not, tone[0]; on the sheet if there is one. */
static void find_tones(const Cells *c, const Mask *m, const Paper *sheet, Tone tone[2])
{
    const Scan *s = c->scan;
    double most = s->depth == 8 ? 255.0 : 65535.0;
    tone[0] = tone[1] = (Tone){0};
    for (uint32_t y = 0; y < m->height; y++) {
        uint32_t from = 0, to = s->width, py = sample_at(y, c->step, 0, 1, s->height);
        if (sheet->n > 0 && !paper_span(sheet, s->width, py, &from, &to))
            continue;
        for (uint32_t x = from / c->step; x < m->width && x * c->step < to; x++) {
            Tone *t = &tone[(*mask_at(m, x, y) & MASK_LEAF) != 0];
            t->n += 1.0;
            for (uint32_t k = 0; k < 3; k++)
                t->colour[k] += channel_value(s, s->channels < 3 ? CHANNEL_GREY : (Channel)(CHANNEL_RED + k), sample_at(x, c->step, 0, 1, s->width), py) / most;
        }
    }
    for (uint32_t i = 0; i < 6; i++)
        tone[i / 3].colour[i % 3] /= MAX(tone[i / 3].n, 1.0);
}

/* ---- sheets ---- */

/* The largest part of one class as a sheet, pixels of the mask. */
static bool fit_part(const Mask *m, Paper *out)
{
    mask_dilate(m, MASK_LEAF, MASK_LEAF, CLOSE);
    mask_erode(m, MASK_LEAF, MASK_LEAF, CLOSE);
    GArray *parts = mask_components(m, 1.0);
    bool found = parts->len > 0;
    if (found) {
        double open = OPEN * MAX(m->width, m->height);
        mask_take(m, &g_array_index(parts, Component, 0));
        mask_erode(m, MASK_THIS, MASK_CORE, open);
        mask_dilate(m, MASK_CORE, MASK_CORE, open);
        found = paper_fit(m, MASK_CORE, out) && paper_area(out) >= LEAST_SHEET * m->width * m->height;
    }
    g_array_free(parts, TRUE);
    return found;
}

/* Whether the largest leaf is none, as much of it lies beyond the sheet. */
static bool goes_astray(const Mask *leaf, const Paper *sheet)
{
    static const Flood flood = {MASK_LEAF | MASK_THIS, MASK_LEAF, MASK_THIS, true};
    GArray *parts = mask_components(leaf, 1.0);
    uint64_t all = 0, on = 0;
    if (parts->len > 0) {
        const Component *c = &g_array_index(parts, Component, 0);
        all = mask_flood(leaf, &flood, c->x, c->y, NULL);
        for (uint32_t y = 0; y < leaf->height; y++) {
            uint32_t from, to;
            for (uint32_t x = paper_span(sheet, leaf->width, y, &from, &to) ? from : (to = 0); x < to; x++)
                on += (*mask_at(leaf, x, y) & MASK_THIS) != 0;
        }
    }
    g_array_free(parts, TRUE);
    return (double)(all - on) > ASTRAY * (double)all;
}

/* The sheet that is taken for the leaf, or, of what `t` takes for its ground, one beyond which most of that leaf lies, a table. */
static bool find_sheet(const Cells *c, const Threshold *t, bool ground, Paper *out)
{
    Mask m = cells_leaf(c, t);
    for (gsize i = 0; ground && i < (gsize)m.width * m.height; i++)
        m.px[i] ^= MASK_LEAF;
    bool found = fit_part(&m, out);
    g_free(m.px);
    if (found && ground) {
        m = cells_leaf(c, t);
        found = goes_astray(&m, out);
        g_free(m.px);
    }
    if (found)
        *out = paper_scaled(out, c->width, c->height, c->step, INSET);
    return found;
}

/* How many of the sheet's sides a part of the leaf reaches. A leaf reaches over one at most; a vein, if the sheet is a piece of a broad leaf, runs from side to
 * side. */
static uint32_t sides_reached(const Mask *m, const Paper *sheet, uint32_t step)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < sheet->n; i++) {
        Vec2 a = vec_scale(sheet->corner[i], 1.0 / step), d = vec_sub(vec_scale(sheet->corner[(i + 1) % sheet->n], 1.0 / step), a);
        double length = sqrt(vec_norm2(d));
        bool reached = false;
        for (double t = 3.0; t < length - 3.0 && !reached; t += 0.5) {
            Vec2 q = vec_add(vec_add(a, vec_scale(d, t / length)), vec_scale(vec2(-d.y, d.x), 1.5 / length));
            reached = q.x >= 0.0 && q.y >= 0.0 && q.x < m->width && q.y < m->height && (*mask_at(m, (uint32_t)q.x, (uint32_t)q.y) & MASK_THIS);
        }
        n += reached;
    }
    return n;
}

static bool holds_leaf(const Cells *c, const Threshold *t)
{
    if (t->separability < LEAST_PARTED || t->contrast < LEAST_CONTRAST || t->frame < LEAST_FRAME)
        return false;
    Mask m = cells_leaf(c, t);
    Tone tone[2];
    find_tones(c, &m, &t->sheet, tone);
    GArray *parts = mask_components(&m, 1.0);
    bool ok = parts->len > 0 && chroma(&tone[0]) <= MOST_CHROMA && greenness(&tone[0]) <= MOST_GREEN;
    if (ok) {
        const Component *leaf = &g_array_index(parts, Component, 0);
        double share = (double)leaf->area / MAX(tone[0].n + tone[1].n, 1.0);
        mask_take(&m, leaf);
        ok = share >= LEAST_LEAF && share <= MOST_LEAF && sides_reached(&m, &t->sheet, c->step) <= 1;
    }
    g_array_free(parts, TRUE);
    g_free(m.px);
    return ok;
}

bool threshold_look_for_sheet(const Scan *s, const ThresholdDef *def, Threshold *t)
{
    Cells c = cells_of(s);
    for (uint32_t k = 0; k < 2; k++) {
        Paper sheet;
        Threshold on = {0};
        if (k == 0 ? t->leaf < LEAST_SHEET * (1.0 - MOST_LEAF) : t->frame > MOST_FRAME)
            continue;
        if (!find_sheet(&c, t, k == 1, &sheet))
            continue;
        threshold_find_on(s, def, &sheet, &on);
        if (!holds_leaf(&c, &on))
            continue;
        *t = on;
        return true;
    }
    return false;
}

/* ---- sides ---- */

void threshold_look_at_sides(const Scan *s, Threshold *t)
{
    Cells c = cells_of(s);
    Mask m = cells_leaf(&c, t);
    Tone tone[2];
    find_tones(&c, &m, &t->sheet, tone);
    g_free(m.px);
    bool greener = greenness(&tone[0]) >= greenness(&tone[1]) + LESS_GREEN;
    bool paler = brightness(&tone[1]) >= brightness(&tone[0]) + PALER && chroma(&tone[1]) + GREYER <= chroma(&tone[0]);
    if (t->frame < FULL_FRAME && t->leaf < 0.5 && (paler || greener)) {
        t->turned = true;
        t->dark = !t->dark;
        t->frame = 1.0 - t->frame;
        t->leaf = 1.0 - t->leaf;
    }
    t->pale = !t->turned && paler && greener;
}
