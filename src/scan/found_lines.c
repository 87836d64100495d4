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

/* A sample on the line through a pixel, by how far it lies off, and its weight. */
typedef struct {
    int32_t dx, dy;
    float weight;
} Tap;

/* A sample of a row of pixels. */
typedef struct {
    const float *px; /* for the row's first pixel; to be read from lo to hi - 1 only */
    int32_t lo, hi;
    float weight;
} TapRow;

/* Adds four samples at once, one after the other, so that sums are what they are when each is added alone. */
static void add_four(const TapRow *t, float *restrict o, int32_t lo, int32_t hi)
{
    const float *a = t[0].px, *b = t[1].px, *c = t[2].px, *d = t[3].px;
    float u = t[0].weight, v = t[1].weight, w = t[2].weight, z = t[3].weight;
    for (int32_t x = lo; x < hi; x++)
        o[x] = o[x] + u * a[x] + v * b[x] + w * c[x] + z * d[x];
}

static void add_one(const TapRow *t, float *restrict o, int32_t lo, int32_t hi)
{
    const float *a = t->px, u = t->weight;
    for (int32_t x = lo; x < hi; x++)
        o[x] += u * a[x];
}

/* All samples of a row, in order: together where all four lie in the image, else one by one. */
static void add_row(const TapRow *t, uint32_t n, float *o, int32_t from, int32_t to)
{
    for (uint32_t k = 0; k < n; k += 4) {
        uint32_t m = MIN(n - k, 4);
        int32_t lo = from, hi = to;
        for (uint32_t i = k; i < k + m; i++) {
            lo = MAX(lo, t[i].lo);
            hi = MIN(hi, t[i].hi);
        }
        bool together = m == 4 && lo < hi;
        if (together)
            add_four(t + k, o, lo, hi);
        for (uint32_t i = k; i < k + m; i++) {
            int32_t a = MAX(from, t[i].lo), b = MIN(to, t[i].hi);
            if (together) {
                add_one(&t[i], o, a, MIN(b, lo));
                add_one(&t[i], o, MAX(a, hi), b);
            } else {
                add_one(&t[i], o, a, b);
            }
        }
    }
}

/* Samples along a line, from one end to the other; returns how many. */
static uint32_t lay_taps(const Kernel *k, int32_t n, double spacing, Vec2 along, Tap *tap)
{
    for (int32_t i = -n; i <= n; i++) {
        int32_t a = i < 0 ? -i : i, dx = nearest(a * spacing * along.x), dy = nearest(a * spacing * along.y);
        tap[i + n] = (Tap){i < 0 ? -dx : dx, i < 0 ? -dy : dy, (float)k->w[a]};
    }
    return (uint32_t)(2 * n + 1);
}

/* Weighted mean along the line through each pixel; samples are taken at whole pixels, a symmetric set of them. What lies off the image
 * counts as 0. */
static void average_along(const GreyImage *in, const Spans *s, Vec2 along, double reach, double spacing, GreyImage *out)
{
    int32_t w = (int32_t)in->width, h = (int32_t)in->height, n = (int32_t)ceil(line_reach * reach / spacing);
    Kernel k = kernel_gaussian(reach / spacing, line_reach);
    n = MIN(n, (int32_t)k.r);
    Tap *tap = g_new(Tap, 2 * n + 1);
    TapRow *row = g_new(TapRow, 2 * n + 1);
    uint32_t n_taps = lay_taps(&k, n, spacing, along, tap);
    for (int32_t y = 0; y < h; y++) {
        float *o = out->px + (gsize)y * in->width;
        uint32_t m = 0;
        memset(o, 0, in->width * sizeof *o);
        for (uint32_t i = 0; i < n_taps; i++) {
            int32_t dx = tap[i].dx, dy = tap[i].dy;
            if (y + dy >= 0 && y + dy < h)
                row[m++] = (TapRow){in->px + (ptrdiff_t)(y + dy) * w + dx, MAX(0, -dx), MIN(w, w - dx), tap[i].weight};
        }
        add_row(row, m, o, s->lo[y], s->hi[y]);
    }
    g_free(tap);
    g_free(row);
    kernel_clear(&k);
}

static void compare_sides(const FoundLeaf *l, const Spans *s, const GreyImage *mean, Vec2 across, uint8_t direction, FoundLines *f)
{
    int32_t dx = nearest(across.x), dy = nearest(across.y), w = (int32_t)l->width, h = (int32_t)l->height;
    float *wanted[FOUND_MOVES];
    uint32_t n_wanted = 0;
    for (uint32_t m = 0; f->along[0] && m < FOUND_MOVES; m++)
        if (memchr(step_directions[m], direction, 3))
            wanted[n_wanted++] = f->along[m]->px;
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
            for (uint32_t m = 0; m < n_wanted; m++)
                wanted[m][i] = MAX(wanted[m][i], lesser);
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
