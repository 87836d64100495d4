#include "scan/stalk_over.h"

#include <math.h>

#include "geom/dtrig.h"
#include "scan/openings.h"

static const double rings[] = {0.25, 0.18, 0.33}; /* of the outline's extent: distances from the base where it is looked for */
static const double least_run = 0.006, most_run = 0.06; /* of the extent: how much of a ring it may cover */
static const double odd = 0.12;            /* of the scale: how far off the blade's colour it is */
static const double most_slant = 50.0, slant_step = 10.0; /* degrees from the ray through the base, there */
static const double step = 0.33;           /* of its width, between points */
static const double reach = 1.9;           /* widths to each side that are looked at */
static const double least_width = 0.6, most_width = 1.5; /* of what is usual for it */
static const double adapts = 0.15;         /* so much of what it is wider or narrower than usual is usual at the next point */
static const double most_shift = 0.4;      /* widths, from where it heads */
static const double least_contrast = 0.25; /* to each side, of the difference of its colour and the blade's */
static const double most_gap = 2.5;        /* widths */
static const double ends_near = 3.0;       /* widths: as far from the base it may get lost, where it bends steeply and veins set out */
static const double least_over = 4.0;      /* widths with blade on both sides */
static const double least_out = 1.5;       /* widths with ground on both sides at its end */
enum { SAMPLES = 24, MOST_POINTS = 4000, GRID = 64 };

/* What colours mean: 0 the blade's, 1 the petiole's, 0 the ground's too. */
typedef struct {
    const Scan *scan;
    const Threshold *threshold;
    uint32_t channels;
    double zero[3], to_one[3];
    double paler; /* beyond the threshold: surely ground */
    double full;
} Shade;

static double beyond(const Shade *k, int64_t x, int64_t y)
{
    double v = (double)channel_value(k->scan, k->threshold->channel, (uint32_t)x, (uint32_t)y) - k->threshold->level;
    return k->threshold->dark ? v : -v;
}

static bool pixel_of(const Scan *s, Vec2 q, int64_t *x, int64_t *y)
{
    *x = (int64_t)floor(q.x);
    *y = (int64_t)floor(s->height - q.y);
    return *x >= 0 && *y >= 0 && *x < s->width && *y < s->height;
}

static bool is_blade(const Shade *k, Vec2 q)
{
    int64_t x, y;
    return pixel_of(k->scan, q, &x, &y) && beyond(k, x, y) < 0.0;
}

static double shade_at(const Shade *k, Vec2 q)
{
    int64_t x, y;
    if (!pixel_of(k->scan, q, &x, &y) || beyond(k, x, y) > k->paler)
        return 0.0;
    double v = 0.0;
    for (uint32_t c = 0; c < k->channels; c++)
        v += k->to_one[c] * (scan_sample(k->scan, (uint32_t)x, (uint32_t)y, c) - k->zero[c]);
    return v;
}

/* Means over a grid: of the blade, and how far the ground is off the threshold. */
static bool shade_init(Shade *k, const Scan *s, const Threshold *t, const Polygon *outline)
{
    double n = 0.0, ground = 0.0, grounds = 0.0;
    Box2 b = outline->box;
    *k = (Shade){.scan = s, .threshold = t, .channels = s->channels < 3 ? 1 : 3, .full = s->depth == 8 ? 255.0 : 65535.0};
    for (uint32_t i = 0; i < GRID * GRID; i++) {
        Vec2 q = vec2(b.x0 + (b.x1 - b.x0) * (i % GRID + 0.5) / GRID, b.y0 + (b.y1 - b.y0) * (i / GRID + 0.5) / GRID);
        int64_t x, y;
        if (!pixel_of(s, q, &x, &y))
            continue;
        double v = beyond(k, x, y);
        if (v >= 0.0) {
            ground += v;
            grounds += 1.0;
        } else if (polygon_contains(outline, q)) {
            for (uint32_t c = 0; c < k->channels; c++)
                k->zero[c] += scan_sample(s, (uint32_t)x, (uint32_t)y, c);
            n += 1.0;
        }
    }
    for (uint32_t c = 0; c < k->channels && n > 0.0; c++)
        k->zero[c] /= n;
    k->paler = grounds > 0.0 ? 0.5 * ground / grounds : k->full;
    return n > 0.0;
}

/* 1 becomes the colour about a place. False when it is the blade's. */
static bool shade_take(Shade *k, Vec2 at, double radius)
{
    double one[3] = {0}, n = 0.0, far2 = 0.0;
    for (int32_t i = -2; i <= 2; i++)
        for (int32_t j = -2; j <= 2; j++) {
            int64_t x, y;
            if (!pixel_of(k->scan, vec_add(at, vec2(0.5 * radius * i, 0.5 * radius * j)), &x, &y))
                continue;
            for (uint32_t c = 0; c < k->channels; c++)
                one[c] += scan_sample(k->scan, (uint32_t)x, (uint32_t)y, c);
            n += 1.0;
        }
    for (uint32_t c = 0; c < k->channels && n > 0.0; c++) {
        k->to_one[c] = one[c] / n - k->zero[c];
        far2 += k->to_one[c] * k->to_one[c];
    }
    for (uint32_t c = 0; c < k->channels && far2 > 0.0; c++)
        k->to_one[c] /= far2;
    return far2 > odd * odd * k->full * k->full;
}

/* ---- following ---- */

typedef struct {
    double v[2 * SAMPLES + 1];
} Across;

static double mean_of(const Across *a, double from, double to)
{
    double sum = 0.0, n = 0.0;
    for (int32_t i = -SAMPLES; i <= SAMPLES; i++) {
        double off = reach * i / SAMPLES;
        if (off >= from && off <= to) {
            sum += a->v[i + SAMPLES];
            n += 1.0;
        }
    }
    return n > 0.0 ? sum / n : 0.0;
}

/* Where it falls to `level`, from its middle outward, in widths. */
static double edge(const Across *a, int32_t way, double level)
{
    for (int32_t i = 1; i <= SAMPLES; i++) {
        double here = a->v[SAMPLES + way * i], before = a->v[SAMPLES + way * (i - 1)];
        if (here < level)
            return reach / SAMPLES * (i - 1 + (before > here ? CLAMP((before - level) / (before - here), 0.0, 1.0) : 0.0));
    }
    return reach;
}

/* Its section about a place where it is expected. *off: how far its middle lies to the left; *wide: its width; both in widths. */
static bool section(const Shade *k, Vec2 at, Vec2 along, double width, double *off, double *wide)
{
    enum { LONG = 5 };
    Across a = {{0}};
    Vec2 left = vec2(-along.y, along.x);
    for (int32_t i = -SAMPLES; i <= SAMPLES; i++)
        for (int32_t j = 0; j < LONG; j++) {
            Vec2 q = vec_add(at, vec_add(vec_scale(left, width * reach * i / SAMPLES), vec_scale(along, 0.12 * width * (j - LONG / 2))));
            a.v[i + SAMPLES] += shade_at(k, q) / LONG;
        }
    double in = mean_of(&a, -0.2, 0.2), l = mean_of(&a, 0.8, 1.4), r = mean_of(&a, -1.4, -0.8);
    if (in - l < least_contrast || in - r < least_contrast)
        return false;
    double to_left = edge(&a, 1, 0.5 * (in + l)), to_right = edge(&a, -1, 0.5 * (in + r));
    *off = 0.5 * (to_left - to_right);
    *wide = to_left + to_right;
    return fabs(*off) <= most_shift && *wide >= least_width && *wide <= most_width;
}

/* Points from a place on, until it is lost. */
static GArray *follow(const Shade *k, Vec2 at, Vec2 along, double width)
{
    GArray *points = g_array_new(FALSE, FALSE, sizeof(StalkPoint));
    guint seen = 0;
    const double least = least_width * width, most = most_width * width;
    for (uint32_t i = 0; i < MOST_POINTS && (points->len - seen) * step <= most_gap; i++) {
        double off = 0.0, wide = 1.0;
        bool good = section(k, at, along, width, &off, &wide);
        Vec2 left = vec2(-along.y, along.x);
        if (good)
            at = vec_add(at, vec_scale(left, off * width));
        StalkPoint q = {.p = at, .half = 0.5 * (good ? wide : 1.0) * width};
        double to_side = q.half + 0.3 * width;
        bool a = is_blade(k, vec_add(at, vec_scale(left, to_side))), b = is_blade(k, vec_add(at, vec_scale(left, -to_side)));
        q.over = a && b;
        q.out = !a && !b;
        g_array_append_val(points, q);
        seen = good ? points->len : seen;
        if (good)
            width *= CLAMP(1.0 + adapts * (wide - 1.0), least / width, most / width);
        if (good && points->len >= 5) {
            Vec2 run = vec_sub(at, g_array_index(points, StalkPoint, points->len - 5).p);
            along = vec_add(vec_scale(along, 0.5), vec_scale(run, 0.5 / sqrt(vec_norm2(run))));
            along = vec_scale(along, 1.0 / sqrt(vec_norm2(along)));
        }
        at = vec_add(at, vec_scale(along, step * width));
    }
    g_array_set_size(points, seen);
    return points;
}

/* Half widths as means of neighbours, and where blade is on both sides. */
static void settle(StalkOver *o)
{
    const uint32_t short_gap = (uint32_t)(1.0 / step);
    double *half = g_new(double, o->n);
    for (uint32_t i = 0, gap = short_gap + 1; i < o->n; i++) { /* none before the first */
        for (uint32_t j = 1; o->point[i].over && gap <= short_gap && j <= gap; j++)
            o->point[i - j].over = true;
        gap = o->point[i].over ? 0 : gap + 1;
    }
    for (uint32_t i = 0; i < o->n; i++) {
        uint32_t a = i >= 3 ? i - 3 : 0, b = MIN(i + 3, o->n - 1);
        double sum = 0.0;
        for (uint32_t j = a; j <= b; j++)
            sum += o->point[j].half;
        half[i] = sum / (b - a + 1);
    }
    o->first = o->n;
    o->box = box_empty();
    o->length = 0.0;
    for (uint32_t i = 1; i < o->n; i++)
        o->length += vec_dist(o->point[i - 1].p, o->point[i].p);
    for (uint32_t i = 0; i < o->n; i++) {
        StalkPoint *q = &o->point[i];
        q->half = half[i];
        Vec2 r = vec2(q->half, q->half);
        o->box = box_add(box_add(o->box, vec_sub(q->p, r)), vec_add(q->p, r));
        o->first = q->over ? MIN(o->first, i) : o->first;
    }
    g_free(half);
}

static uint32_t count_out(const StalkOver *o)
{
    uint32_t n = 0;
    while (n < o->n && o->point[n].out)
        n++;
    return n;
}

/* Both ways from a place, where it heads outward along `away`; NULL when it is no petiole. */
static StalkOver *try_along(const Shade *k, Vec2 at, Vec2 away, double width, Vec2 base)
{
    GArray *out = follow(k, at, away, width), *in = follow(k, at, vec_scale(away, -1.0), width);
    StalkOver *o = g_new0(StalkOver, 1);
    uint32_t over = 0;
    o->point = g_new(StalkPoint, out->len + in->len + 1);
    for (guint i = out->len; i-- > 0;)
        o->point[o->n++] = g_array_index(out, StalkPoint, i);
    for (guint i = out->len > 0; i < in->len; i++) /* the first is the other's, too */
        o->point[o->n++] = g_array_index(in, StalkPoint, i);
    g_array_free(out, TRUE);
    g_array_free(in, TRUE);
    o->width = width;
    uint32_t nearest = 0; /* veins that go on where it ends are none of it */
    for (uint32_t i = 1; i < o->n; i++)
        nearest = vec_dist2(o->point[i].p, base) < vec_dist2(o->point[nearest].p, base) ? i : nearest;
    o->n = MIN(o->n, nearest + 1);
    if (o->n < 2) {
        stalk_over_free(o);
        return NULL;
    }
    settle(o);
    for (uint32_t i = 0; i < o->n; i++)
        over += o->point[i].over;
    bool good = over * step >= least_over && count_out(o) * step >= least_out && vec_dist(o->point[o->n - 1].p, base) <= ends_near * width;
    if (good)
        return o;
    stalk_over_free(o);
    return NULL;
}

/* At a place of a ring, where it covers `run`: the way in which it is narrowest. */
static StalkOver *try_at(Shade *k, Vec2 at, double run, Vec2 base)
{
    Vec2 ray = vec_scale(vec_sub(at, base), 1.0 / vec_dist(at, base)), best = ray;
    double least = HUGE_VAL, off, wide;
    if (!shade_take(k, at, 0.2 * run))
        return NULL;
    for (double slant = -most_slant; slant <= most_slant; slant += slant_step) {
        double s, c;
        dtrig_sin_cos(slant * DTRIG_PI / 180.0, &s, &c);
        Vec2 along = vec2(c * ray.x - s * ray.y, s * ray.x + c * ray.y);
        if (section(k, at, along, c * run, &off, &wide) && wide * c * run < least) {
            least = wide * c * run;
            best = along;
        }
    }
    return least >= 3.0 && least < HUGE_VAL ? try_along(k, at, best, least, base) : NULL;
}

static bool is_odd(const Shade *k, Vec2 q)
{
    int64_t x, y;
    double far2 = 0.0;
    if (!pixel_of(k->scan, q, &x, &y) || beyond(k, x, y) > k->paler)
        return false;
    for (uint32_t c = 0; c < k->channels; c++) {
        double d = scan_sample(k->scan, (uint32_t)x, (uint32_t)y, c) - k->zero[c];
        far2 += d * d;
    }
    return far2 > odd * odd * k->full * k->full;
}

static StalkOver *search_ring(Shade *k, Vec2 base, double radius, double size)
{
    uint32_t n = (uint32_t)(2.0 * DTRIG_PI * radius) + 8, run = 0;
    StalkOver *o = NULL;
    for (uint32_t i = 0; i <= n && !o; i++) {
        double s, c, pixels = 2.0 * DTRIG_PI * radius / n;
        dtrig_sin_cos(2.0 * DTRIG_PI * i / n, &s, &c);
        if (i < n && is_odd(k, vec2(base.x + radius * c, base.y + radius * s))) {
            run++;
            continue;
        }
        if (run * pixels >= least_run * size && run * pixels <= most_run * size) {
            dtrig_sin_cos(2.0 * DTRIG_PI * (i - 0.5 * (run + 1)) / n, &s, &c);
            o = try_at(k, vec2(base.x + radius * c, base.y + radius * s), run * pixels, base);
        }
        run = 0;
    }
    return o;
}

StalkOver *stalk_over_find(const Scan *s, const Polygon *outline, const Threshold *t, Vec2 base)
{
    Threshold own;
    Shade k;
    StalkOver *o = NULL;
    double size = vec_dist(vec2(outline->box.x0, outline->box.y0), vec2(outline->box.x1, outline->box.y1));
    if (!t && openings_threshold(s, outline, &(ThresholdDef){CHANNEL_BEST, LEAF_BY_FRAME, -1.0}, &own))
        t = &own;
    if (!t || !shade_init(&k, s, t, outline))
        return NULL;
    for (uint32_t i = 0; i < G_N_ELEMENTS(rings) && !o; i++)
        o = search_ring(&k, base, rings[i] * size, size);
    return o;
}

void stalk_over_free(StalkOver *o)
{
    if (!o)
        return;
    g_free(o->point);
    g_free(o);
}

double stalk_over_distance(const StalkOver *o, Vec2 q, uint32_t *at)
{
    double best = HUGE_VAL;
    for (uint32_t i = 0; i < o->n; i++) {
        const StalkPoint *a = &o->point[i], *b = &o->point[MIN(i + 1, o->n - 1)];
        Vec2 d = vec_sub(b->p, a->p);
        double n = vec_norm2(d), u = n > 0.0 ? CLAMP(vec_dot(vec_sub(q, a->p), d) / n, 0.0, 1.0) : 0.0;
        double off = vec_dist(q, vec_lerp(a->p, b->p, u)) - (a->half + (b->half - a->half) * u);
        if (off < best) {
            best = off;
            if (at)
                *at = i;
        }
    }
    return best;
}
