#include "scan/gather.h"

#include <math.h>

#include "geom/dtrig.h"
#include "scan/found_parts.h"

static const double side = 500.0;                   /* working pixels of the leaf's longer side: larger veins show, and it takes little time */
static const double half[] = {0.0025, 0.005, 0.01}; /* of lines looked for, of the leaf's length */
static const double least_half = 0.9;               /* working pixels */
static const double line_reach = 0.02;              /* sigma along them, of the length */
static const double near_end = 0.03, far_end = 0.3; /* distances from an end at which lines head for it, of that between the ends */
static const double noise_quantile = 0.85;          /* of lines of the other polarity */
static const double least_noise = 0.25 / 255;       /* of the whole scale: what rounding to 8 bits leaves in a flat image */
static const double even_odds = 2.2;                /* contrast over noise of what may be a line; only what is beyond counts, */
static const double doubt = 0.1;                    /* beside so much a pixel that says nothing */
static const double aside = 0.03;                   /* of the same: nearer to the axis is the midvein, which doesn't lean */

/* Sums over pixels: cosine or sine of twice an angle, weighed by contrast and width, and the weights. */
typedef struct {
    double sum, all;
} Tally;

typedef struct {
    Vec2 a, b, axis;
    double n2; /* square of the axis' length */
    Tally head_a, head_b, lean;
} Sides;

static double share(Tally t) { return t.all > 0.0 ? t.sum / t.all : 0.0; }

static void tally(Tally *t, double width, double weight, double value)
{
    t->sum += width * weight * value;
    t->all += width * (weight + doubt);
}

/* 1 where the line points at an end, -1 where it runs across the way there. */
static void head(const Sides *s, Vec2 end, Vec2 q, Vec2 along, double width, double weight, Tally *t)
{
    Vec2 d = vec_sub(q, end);
    double r2 = vec_norm2(d), c = vec_dot(d, along);
    if (r2 > near_end * near_end * s->n2 && r2 <= far_end * far_end * s->n2)
        tally(t, width, weight, 2.0 * c * c / r2 - 1.0);
}

static void count(const FoundLeaf *l, const FoundLines *f, double width, Sides *s)
{
    double noise = found_quantile(l, f->other, noise_quantile);
    noise = MAX(noise, least_noise);
    Vec2 unit[FOUND_DIRECTIONS];
    for (uint32_t d = 0; d < FOUND_DIRECTIONS; d++) {
        double sine, cosine;
        dtrig_sin_cos(d * DTRIG_PI / FOUND_DIRECTIONS, &sine, &cosine);
        unit[d] = vec2(cosine, -sine); /* rows run down, angles anticlockwise */
    }
    for (uint32_t y = 0; y < l->height; y++)
        for (uint32_t x = 0; x < l->width; x++) {
            gsize i = (gsize)y * l->width + x;
            if (!l->deep[i])
                continue;
            Vec2 q = vec2(x + 0.5, y + 0.5), along = unit[f->direction[i]];
            double weight = MAX((double)f->best->px[i] / noise - even_odds, 0.0), off = vec_cross(s->axis, vec_sub(q, s->a));
            head(s, s->a, q, along, width, weight, &s->head_a);
            head(s, s->b, q, along, width, weight, &s->head_b);
            if (fabs(off) > aside * s->n2)
                tally(&s->lean, width, weight, (off > 0.0 ? 2.0 : -2.0) * vec_cross(s->axis, along) * vec_dot(s->axis, along) / s->n2);
        }
}

static Vec2 to_working(const FoundLeaf *l, Vec2 q) { return vec2((q.x - l->x0) / l->step, (l->scan->height - q.y - l->y0) / l->step); }

double gather_compare(const Scan *scan, const Polygon *outline, Vec2 a, Vec2 b)
{
    FoundLeaf l;
    if (!found_leaf_init(&l, scan, outline, NULL, side, NULL)) /* too small to show any */
        return 0.0;
    bool bright;
    GreyImage *light = found_mix(&l, &bright);
    Sides s = {.a = to_working(&l, a), .b = to_working(&l, b)};
    s.axis = vec_sub(s.b, s.a);
    s.n2 = vec_norm2(s.axis);
    for (uint32_t k = 0; s.n2 > 0.0 && k < G_N_ELEMENTS(half); k++) {
        FoundLines f;
        found_lines(&l, light, MAX(half[k] * l.length, least_half), line_reach * l.length, false, &f);
        count(&l, &f, half[k], &s);
        found_lines_clear(&f);
    }
    grey_image_free(light);
    found_leaf_clear(&l);
    Tally both = {s.head_a.sum - s.head_b.sum, s.head_a.all + s.head_b.all};
    return 0.5 * (share(both) + share(s.lean));
}
