/* The leaf at working resolution: averaged down, illumination evened. */
#include <math.h>
#include <string.h>

#include "scan/convolve.h"
#include "scan/found_parts.h"
#include "scan/mask.h"
#include "scan/openings.h"

static const double shortest_side = 800.0; /* the same, of small leaves, as far as pixels of half the size allow: the filter's least width is two */
static const double least_step = 0.5;
static const double padding = 0.06;        /* of that: what the filter reaches beyond the blade */
static const double border = 0.006;        /* of the leaf's length: so near the outline ridges are the margin's own */
static const double evening = 0.025;       /* of the length: sigma of what counts as illumination */
static const double hole_radius = 0.007;   /* of the length: what is clearly ground over so much is a hole, but … */
static const double thick_radius = 0.1;    /* … so near to the base, where veins and petiole are thick and pale */
static const double shadow_share = 0.2;    /* of a petiole's width */
enum { COARSE = 4 };                       /* illumination is found on blocks of so many pixels a side */

/* --- averaging down --- */

/* Weights with which pixels of a line of `n` take part in [from, from + step); those beyond it count as its ends. */
static uint32_t overlap(double from, double step, uint32_t n, uint32_t *at, double *weight)
{
    uint32_t m = 0;
    for (int64_t i = (int64_t)floor(from); (double)i < from + step && m < 64; i++) {
        double a = MAX((double)i, from), b = MIN((double)i + 1.0, from + step);
        if (b > a) {
            at[m] = (uint32_t)CLAMP(i, 0, (int64_t)n - 1);
            weight[m++] = (b - a) / step;
        }
    }
    return m;
}

typedef struct {
    uint32_t first, n;
} Run;

static void average_row(const FoundLeaf *l, uint32_t y, double weight, const Run *run, const uint32_t *at, const double *w, double *sum)
{
    const Scan *s = l->scan;
    for (uint32_t x = 0; x < l->width; x++)
        for (uint32_t k = run[x].first; k < run[x].first + run[x].n; k++)
            for (uint32_t c = 0; c < l->n_planes; c++)
                sum[x * l->n_planes + c] += weight * w[k] * scan_sample(s, at[k], y, c);
}

/* Planes as shares of the whole scale. */
static void average(FoundLeaf *l)
{
    double full = l->scan->depth == 8 ? 255.0 : 65535.0;
    Run *run = g_new(Run, l->width);
    GArray *at = g_array_new(FALSE, FALSE, sizeof(uint32_t)), *w = g_array_new(FALSE, FALSE, sizeof(double));
    uint32_t a[64];
    double b[64], *sum = g_new(double, (gsize)l->width * l->n_planes);
    for (uint32_t x = 0; x < l->width; x++) {
        run[x].first = at->len;
        run[x].n = overlap(l->x0 + x * l->step, l->step, l->scan->width, a, b);
        g_array_append_vals(at, a, run[x].n);
        g_array_append_vals(w, b, run[x].n);
    }
    for (uint32_t y = 0; y < l->height; y++) {
        memset(sum, 0, (gsize)l->width * l->n_planes * sizeof *sum);
        uint32_t rows = overlap(l->y0 + y * l->step, l->step, l->scan->height, a, b);
        for (uint32_t k = 0; k < rows; k++)
            average_row(l, a[k], b[k], run, (const uint32_t *)at->data, (const double *)w->data, sum);
        for (uint32_t x = 0; x < l->width; x++)
            for (uint32_t c = 0; c < l->n_planes; c++)
                l->plane[c]->px[(gsize)y * l->width + x] = (float)(sum[x * l->n_planes + c] / full);
    }
    g_free(sum);
    g_free(run);
    g_array_free(at, TRUE);
    g_array_free(w, TRUE);
}

/* --- the blade --- */

static void erode(const FoundLeaf *l, const uint8_t *from, double r, uint8_t *to)
{
    gsize n = (gsize)l->width * l->height;
    Mask m = {l->width, l->height, l->width, to};
    for (gsize i = 0; i < n; i++)
        to[i] = from[i] ? MASK_LEAF : 0;
    mask_erode(&m, MASK_LEAF, MASK_LEAF, r);
    for (gsize i = 0; i < n; i++)
        to[i] = (to[i] & MASK_LEAF) != 0;
}

static void mean_colour(const FoundLeaf *l, const uint8_t *of, uint8_t want, double mean[3])
{
    gsize n = (gsize)l->width * l->height;
    double count = 0.0;
    memset(mean, 0, 3 * sizeof *mean);
    for (gsize i = 0; i < n; i++)
        if (of[i] == want) {
            count += 1.0;
            for (uint32_t c = 0; c < l->n_planes; c++)
                mean[c] += (double)l->plane[c]->px[i];
        }
    for (uint32_t c = 0; c < l->n_planes; c++)
        mean[c] /= MAX(count, 1.0);
}

/* Holes that the outline doesn't know of show the ground: where it shows clearly over some width, and around that where it shows
 * more than the blade does. */
static void take_out_holes(FoundLeaf *l, const Vec2 *base)
{
    gsize n = (gsize)l->width * l->height;
    double blade[3], ground[3], far = 0.0;
    mean_colour(l, l->inside, 1, blade);
    mean_colour(l, l->inside, 0, ground);
    for (uint32_t c = 0; c < l->n_planes; c++)
        far += (ground[c] - blade[c]) * (ground[c] - blade[c]);
    if (far < 0.01)
        return;
    uint8_t *hole = g_new0(uint8_t, n);
    for (gsize i = 0; i < n; i++) {
        double t = 0.0;
        for (uint32_t c = 0; c < l->n_planes; c++)
            t += ((double)l->plane[c]->px[i] - blade[c]) * (ground[c] - blade[c]);
        double x = l->x0 + ((double)(i % l->width) + 0.5) * l->step, y = l->scan->height - l->y0 - ((double)(i / l->width) + 0.5) * l->step;
        bool thick = base && vec_dist(vec2(x, y), *base) < thick_radius * l->length * l->step;
        if (l->inside[i] && !thick)
            hole[i] = (uint8_t)((t > 0.7 * far ? MASK_LEAF : 0) | (t > 0.45 * far ? MASK_HOLE : 0));
    }
    Mask m = {l->width, l->height, l->width, hole};
    mask_dilate(&m, MASK_LEAF, MASK_LEAF, 0.003 * l->length); /* lines on the paper */
    mask_erode(&m, MASK_LEAF, MASK_LEAF, 0.003 * l->length);
    mask_erode(&m, MASK_LEAF, MASK_CORE, hole_radius * l->length); /* veins and where they meet are thinner */
    mask_dilate(&m, MASK_CORE, MASK_CORE, 3.0 * hole_radius * l->length);
    for (gsize i = 0; i < n; i++)
        if ((hole[i] & (MASK_CORE | MASK_HOLE)) == (MASK_CORE | MASK_HOLE))
            hole[i] |= MASK_WORK;
    mask_dilate(&m, MASK_WORK, MASK_WORK, 2.0);
    for (gsize i = 0; i < n; i++)
        if (l->inside[i] && (hole[i] & MASK_WORK)) {
            l->inside[i] = 0;
            l->hole[i] = 1;
        }
    g_free(hole);
}

/* A petiole over the blade hides it, and so does its shadow. */
static void take_out_stalk(FoundLeaf *l, const Polygon *outline, const Threshold *t, Vec2 base)
{
    l->over = stalk_over_find(l->scan, outline, t, base);
    for (uint32_t y = 0; l->over && y < l->height; y++)
        for (uint32_t x = 0; x < l->width; x++) {
            gsize i = (gsize)y * l->width + x;
            double shadow = shadow_share * l->over->width;
            Vec2 q = vec2(l->x0 + (x + 0.5) * l->step, l->scan->height - l->y0 - (y + 0.5) * l->step);
            bool thick = vec_dist(q, base) < 2.0 * l->over->width; /* veins run together there, and it is one of them */
            if (l->inside[i] && !thick && box_has(box_grow(l->over->box, shadow), q) && stalk_over_distance(l->over, q, NULL) <= shadow) {
                l->inside[i] = 0;
                l->hole[i] = 1;
            }
        }
}

/* What of the blade isn't deep around holes goes with them. */
static void add_rims(FoundLeaf *l, double r)
{
    gsize n = (gsize)l->width * l->height;
    uint8_t *wide = g_new(uint8_t, n);
    for (gsize i = 0; i < n; i++)
        wide[i] = l->hole[i] ? MASK_LEAF : 0;
    Mask m = {l->width, l->height, l->width, wide};
    mask_dilate(&m, MASK_LEAF, MASK_LEAF, r + 1.0);
    for (gsize i = 0; i < n; i++)
        l->hole[i] = wide[i] && (l->hole[i] || (l->inside[i] && !l->deep[i]));
    g_free(wide);
}

static void mark_blade(FoundLeaf *l, const Polygon *outline, const Vec2 *base)
{
    gsize n = (gsize)l->width * l->height;
    l->inside = g_new0(uint8_t, n);
    l->deep = g_new0(uint8_t, n);
    l->hole = g_new0(uint8_t, n);
    for (uint32_t y = 0; y < l->height; y++)
        for (uint32_t x = 0; x < l->width; x++) {
            double sx = l->x0 + (x + 0.5) * l->step, sy = l->y0 + (y + 0.5) * l->step;
            bool seen = sx > 0.0 && sy > 0.0 && sx < l->scan->width && sy < l->scan->height;
            l->inside[(gsize)y * l->width + x] = seen && polygon_contains(outline, vec2(sx, l->scan->height - sy));
        }
    take_out_holes(l, base);
    Threshold t;
    bool parted = openings_threshold(l->scan, outline, &(ThresholdDef){CHANNEL_BEST, LEAF_BY_FRAME, -1.0}, &t);
    if (parted)
        found_open_holes(l, &t, base, thick_radius * l->length * l->step);
    if (parted && base)
        take_out_stalk(l, outline, &t, *base);
    erode(l, l->inside, MAX(border * l->length, 2.0), l->deep);
    add_rims(l, MAX(border * l->length, 2.0));
}

/* --- illumination --- */

static double bilinear(const GreyImage *g, double x, double y)
{
    int64_t i = (int64_t)floor(x), j = (int64_t)floor(y);
    double fx = x - (double)i, fy = y - (double)j;
    double a = (double)g->px[grey_index(g, i, j)], b = (double)g->px[grey_index(g, i + 1, j)];
    double c = (double)g->px[grey_index(g, i, j + 1)], d = (double)g->px[grey_index(g, i + 1, j + 1)];
    return (a + (b - a) * fx) * (1.0 - fy) + (c + (d - c) * fx) * fy;
}

/* Takes the local mean of the blade off; what lies beyond it, and its very border, becomes 0. */
static void even(const FoundLeaf *l, const uint8_t *of, GreyImage *g)
{
    uint32_t w = (l->width + COARSE - 1) / COARSE, h = (l->height + COARSE - 1) / COARSE;
    GreyImage *sum = grey_image_new(w, h), *count = grey_image_new(w, h);
    for (uint32_t y = 0; y < l->height; y++)
        for (uint32_t x = 0; x < l->width; x++)
            if (of[(gsize)y * l->width + x]) {
                gsize i = (gsize)(y / COARSE) * w + x / COARSE;
                sum->px[i] += g->px[(gsize)y * l->width + x];
                count->px[i] += 1.0f;
            }
    Kernel k = kernel_gaussian(MAX(evening * l->length / COARSE, 0.5), 3.0);
    GreyImage *wide = convolve(sum, k, k), *share = convolve(count, k, k);
    for (gsize i = 0; i < (gsize)w * h; i++)
        wide->px[i] = share->px[i] > 1e-3f ? wide->px[i] / share->px[i] : 0.0f;
    for (uint32_t y = 0; y < l->height; y++)
        for (uint32_t x = 0; x < l->width; x++) {
            gsize i = (gsize)y * l->width + x;
            double mean = of[i] ? bilinear(wide, (x + 0.5) / COARSE - 0.5, (y + 0.5) / COARSE - 0.5) : 0.0;
            g->px[i] = of[i] ? (float)((double)g->px[i] - mean) : 0.0f;
        }
    kernel_clear(&k);
    grey_image_free(sum);
    grey_image_free(count);
    grey_image_free(wide);
    grey_image_free(share);
}

/* Glare and spots beyond four times the usual deviation say no more than that. */
static void clip(const FoundLeaf *l, GreyImage *g)
{
    gsize n = (gsize)l->width * l->height;
    double sum = 0.0, count = 0.0;
    for (gsize i = 0; i < n; i++)
        if (l->deep[i]) {
            sum += (double)g->px[i] * (double)g->px[i];
            count += 1.0;
        }
    float most = (float)(4.0 * sqrt(sum / MAX(count, 1.0)));
    for (gsize i = 0; i < n; i++)
        g->px[i] = CLAMP(g->px[i], -most, most);
}

bool found_leaf_init(FoundLeaf *l, const Scan *s, const Polygon *outline, const Vec2 *base, double longest, GError **error)
{
    Box2 b = outline->box;
    double longer = MAX(b.x1 - b.x0, b.y1 - b.y0);
    *l = (FoundLeaf){.scan = s, .n_planes = s->channels < 3 ? 1 : 3};
    if (!(longer >= FOUND_SHORTEST) || b.x0 >= s->width || b.y0 >= s->height || b.x1 <= 0.0 || b.y1 <= 0.0) {
        g_set_error(error, SCAN_ERROR, SCAN_ERROR_SIZE,
                    "no veins can be found: the outline reaches from %g,%g to %g,%g (x,y from the upper left corner) in an image of %u × %u pixels; it must "
                    "be %d pixels long at least",
                    b.x0, s->height - b.y1, b.x1, s->height - b.y0, s->width, s->height, FOUND_SHORTEST);
        return false;
    }
    l->step = MAX(longer / longest, CLAMP(longer / shortest_side, least_step, 1.0));
    l->length = longer / l->step;
    l->pad = (uint32_t)ceil(padding * l->length) + 8;
    l->width = (uint32_t)ceil((b.x1 - b.x0) / l->step) + 2 * l->pad;
    l->height = (uint32_t)ceil((b.y1 - b.y0) / l->step) + 2 * l->pad;
    l->x0 = b.x0 - l->pad * l->step;
    l->y0 = s->height - b.y1 - l->pad * l->step;
    for (uint32_t c = 0; c < l->n_planes; c++)
        l->plane[c] = grey_image_new(l->width, l->height);
    average(l);
    mark_blade(l, outline, base);
    uint8_t *clean = g_new(uint8_t, (gsize)l->width * l->height);
    erode(l, l->inside, 2.0, clean);
    for (uint32_t c = 0; c < l->n_planes; c++) {
        even(l, clean, l->plane[c]);
        clip(l, l->plane[c]);
    }
    g_free(clean);
    return true;
}

void found_leaf_clear(FoundLeaf *l)
{
    for (uint32_t c = 0; c < 3; c++)
        grey_image_free(l->plane[c]);
    g_free(l->inside);
    g_free(l->deep);
    g_free(l->hole);
    stalk_over_free(l->over);
}
