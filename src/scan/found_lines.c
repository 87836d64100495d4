/* Contrast of lines to both of their sides, averaged along them: at one width, in 16 directions. */
#include <math.h>
#include <string.h>

#include "geom/dtrig.h"
#include "scan/convolve.h"
#include "scan/found_parts.h"

static const double least_smoothing = 0.7; /* working pixels */
static const double smoothing = 0.6;       /* sigma before all, in half widths */
static const double line_reach = 2.0;      /* where averages along the line are cut off, sigmas */

/* Directions that a path's step 0, 26.6, 45, 63.4 … degrees agrees with. */
static const uint8_t step_directions[FOUND_MOVES][3] = {{15, 0, 1}, {2, 2, 3},   {3, 4, 5},    {5, 6, 6},
                                                         {7, 8, 9}, {10, 10, 11}, {11, 12, 13}, {13, 14, 14}};

/* Columns from lo to hi - 1 of each row. */
typedef struct {
    int32_t *lo, *hi;
} Spans;

/* Those within d of the blade's depth, along rows and columns. */
static Spans spans_new(const FoundLeaf *l, int32_t d)
{
    int32_t w = (int32_t)l->width, h = (int32_t)l->height;
    Spans one = {g_new(int32_t, l->height), g_new(int32_t, l->height)}, s = {g_new(int32_t, l->height), g_new(int32_t, l->height)};
    for (int32_t y = 0; y < h; y++) {
        const uint8_t *row = l->deep + (gsize)y * l->width;
        int32_t lo = 0, hi = w;
        while (lo < w && !row[lo])
            lo++;
        while (hi > lo && !row[hi - 1])
            hi--;
        one.lo[y] = lo;
        one.hi[y] = hi;
    }
    for (int32_t y = 0; y < h; y++) {
        s.lo[y] = w;
        s.hi[y] = 0;
        for (int32_t k = MAX(0, y - d); k <= MIN(h - 1, y + d); k++)
            if (one.hi[k] > one.lo[k]) {
                s.lo[y] = MIN(s.lo[y], one.lo[k]);
                s.hi[y] = MAX(s.hi[y], one.hi[k]);
            }
        s.lo[y] = MAX(0, s.lo[y] - d);
        s.hi[y] = MIN(w, s.hi[y] + d);
    }
    g_free(one.lo);
    g_free(one.hi);
    return s;
}

static void spans_clear(Spans *s)
{
    g_free(s->lo);
    g_free(s->hi);
}

static inline int32_t nearest(double v) { return (int32_t)floor(v + 0.5); }

/* Weighted mean along the line through each pixel; samples are taken at whole pixels, a symmetric set of them. What lies off the image
 * counts as 0. */
static void average_along(const GreyImage *in, const Spans *s, Vec2 along, double reach, double spacing, GreyImage *out)
{
    int32_t w = (int32_t)in->width, h = (int32_t)in->height, n = (int32_t)ceil(line_reach * reach / spacing);
    Kernel k = kernel_gaussian(reach / spacing, line_reach);
    n = MIN(n, (int32_t)k.r);
    for (int32_t y = 0; y < h; y++) {
        float *o = out->px + (gsize)y * in->width;
        memset(o, 0, in->width * sizeof *o);
        for (int32_t i = -n; i <= n; i++) {
            int32_t a = i < 0 ? -i : i, dx = nearest(a * spacing * along.x), dy = nearest(a * spacing * along.y);
            dx = i < 0 ? -dx : dx;
            dy = i < 0 ? -dy : dy;
            if (y + dy < 0 || y + dy >= h)
                continue;
            const float *r = in->px + (gsize)(y + dy) * in->width;
            float weight = (float)k.w[a];
            for (int32_t x = MAX(s->lo[y], -dx); x < MIN(s->hi[y], w - dx); x++)
                o[x] += weight * r[x + dx];
        }
    }
    kernel_clear(&k);
}

static void compare_sides(const FoundLeaf *l, const Spans *s, const GreyImage *mean, Vec2 across, uint8_t direction, FoundLines *f)
{
    int32_t dx = nearest(across.x), dy = nearest(across.y), w = (int32_t)l->width, h = (int32_t)l->height;
    bool wanted[FOUND_MOVES] = {false};
    for (uint32_t m = 0; f->along[0] && m < FOUND_MOVES; m++)
        wanted[m] = memchr(step_directions[m], direction, 3) != NULL;
    for (int32_t y = abs(dy); y < h - abs(dy); y++)
        for (int32_t x = MAX(s->lo[y], abs(dx)); x < MIN(s->hi[y], w - abs(dx)); x++) {
            gsize i = (gsize)y * l->width + (gsize)x;
            if (!l->deep[i])
                continue;
            ptrdiff_t off = (ptrdiff_t)dy * w + dx;
            float v = mean->px[i], a = v - mean->px[i + off], b = v - mean->px[i - off];
            float lesser = MIN(a, b), greater = MAX(a, b);
            if (lesser > f->best->px[i]) {
                f->best->px[i] = lesser;
                f->direction[i] = direction;
            }
            f->other->px[i] = MAX(f->other->px[i], -greater);
            for (uint32_t m = 0; m < FOUND_MOVES; m++)
                if (wanted[m])
                    f->along[m]->px[i] = MAX(f->along[m]->px[i], lesser);
        }
}

void found_lines(const FoundLeaf *l, const GreyImage *in, double half, double reach, bool along, FoundLines *out)
{
    Kernel k = kernel_gaussian(MAX(least_smoothing, smoothing * half), 3.0);
    GreyImage *smooth = convolve(in, k, k), *mean = grey_image_new(l->width, l->height);
    double side = 2.0 * half + 0.3;
    Spans spans = spans_new(l, 0), wide = spans_new(l, (int32_t)ceil(side) + 1);
    *out = (FoundLines){.best = grey_image_new(l->width, l->height), .other = grey_image_new(l->width, l->height)};
    out->direction = g_new0(uint8_t, (gsize)l->width * l->height);
    for (uint32_t m = 0; along && m < FOUND_MOVES; m++)
        out->along[m] = grey_image_new(l->width, l->height);
    for (uint32_t d = 0; d < FOUND_DIRECTIONS; d++) {
        double sine, cosine;
        dtrig_sin_cos(d * DTRIG_PI / FOUND_DIRECTIONS, &sine, &cosine);
        average_along(smooth, &wide, vec2(cosine, -sine), reach, MAX(1.0, half), mean); /* rows run down, angles anticlockwise */
        compare_sides(l, &spans, mean, vec2(side * sine, side * cosine), (uint8_t)d, out);
    }
    spans_clear(&spans);
    spans_clear(&wide);
    grey_image_free(smooth);
    grey_image_free(mean);
    kernel_clear(&k);
}

void found_lines_clear(FoundLines *f)
{
    grey_image_free(f->best);
    grey_image_free(f->other);
    g_free(f->direction);
    for (uint32_t m = 0; m < FOUND_MOVES; m++)
        grey_image_free(f->along[m]);
}

double found_quantile(const FoundLeaf *l, const GreyImage *g, double share)
{
    enum { BINS = 4096 };
    gsize n = (gsize)l->width * l->height, count[BINS] = {0}, total = 0, below = 0;
    float most = 0.0f;
    for (gsize i = 0; i < n; i++)
        most = l->deep[i] ? MAX(most, g->px[i]) : most;
    if (!(most > 0.0f))
        return 0.0;
    for (gsize i = 0; i < n; i++)
        if (l->deep[i]) {
            count[(uint32_t)MIN((double)(BINS - 1), (double)g->px[i] / (double)most * BINS)]++;
            total++;
        }
    for (uint32_t b = 0; b < BINS; b++) {
        below += count[b];
        if ((double)below >= share * (double)total)
            return (b + 1.0) / BINS * (double)most;
    }
    return (double)most;
}
