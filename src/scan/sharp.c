#include "scan/sharp.h"

#include <math.h>

/* Pixels, unless said otherwise. */
static const double arm = 5.0;          /* ways from an end along both sides … */
static const double most_open = 1.4;  /* … between whose ends, as share of one, a sharp end has no more: it opens by 90 degrees or less */
static const double from = 3.0, to = 8.0; /* ways from the end that tell its axis and its taper */
static const double step = 0.25;        /* between sections */
static const double most_way = 24.0;    /* that it goes on for */
static const double half = 2.0;         /* of a section's width, in which the leaf is; it lies within a pixel of where it heads */
static const double flank = 3.25;       /* to the ends of a section, which are ground */
static const double fine = 0.25;        /* between samples of a section */
static const double least_width = 0.12; /* less is no leaf … */
static const double over_noise = 6.5;   /* … nor is less than so many times the ground's deviation: some three of a sum over a section; */
static const double most_noise = 0.5;   /* where that is more, thin tips can't be told */
static const double swell = 0.2;        /* that a section may be wider than one before */
static const double off_trace = 1.0;    /* that sums at the end may be off the outline's width */
static const double beside = 0.15;      /* share of leaf at a section's ends, at most */
static const double most_beyond = 2.5;  /* from the last section that shows leaf to the end */
static const double over_from = 2.0, over_to = 4.5; /* beyond that: where there must be hardly any */
static const double cut = 1.0;          /* before the traced end; there the half-grey line is still that of a strip */
static const double spacing = 1.0;      /* of new vertices */
enum { AROUND = 12, FAR = 48, LEAST_LEAF = 4, LEAST_GROUND = 40, MOST_SECTIONS = 104, MOST_NEW = 26 };

typedef struct {
    const Polygon *outline;
    const Scan *scan;
    const Threshold *threshold;
    const Mask *mask;
    uint8_t off; /* bits of what was cut off */
} Sharp;

/* One end: `count` vertices from `first` on, around the end of the array, too, give way to these. */
typedef struct {
    uint32_t first, count;
    Vec2 side[2][MOST_NEW], apex; /* to the right of the axis and to the left, outward */
    uint32_t n;
} End;

typedef struct {
    double ground, to_leaf, least; /* level of the ground; 1 / difference of the leaf's; least width */
} Scale;

/* ---- the outline about a vertex ---- */

/* Point of the outline a way after (dir 1) or before (dir -1) a vertex; *steps: whole edges on the way. */
static Vec2 along(const Polygon *p, uint32_t i, int dir, double way, uint32_t *steps)
{
    for (uint32_t k = 0;; k++) {
        uint32_t next = dir > 0 ? (i + 1 < p->n ? i + 1 : 0) : i > 0 ? i - 1 : p->n - 1;
        double d = vec_dist(p->v[i], p->v[next]);
        if (d >= way || k >= p->n) {
            if (steps)
                *steps = k;
            return d > 0.0 ? vec_lerp(p->v[i], p->v[next], CLAMP(way / d, 0.0, 1.0)) : p->v[i];
        }
        way -= d;
        i = next;
    }
}

/* Across an end, `way` back on both sides; HUGE_VAL where the outline turns the other way. */
static double open_at(const Polygon *p, uint32_t i, double way)
{
    Vec2 a = along(p, i, -1, way, NULL), b = along(p, i, 1, way, NULL);
    return vec_cross(vec_sub(p->v[i], a), vec_sub(b, p->v[i])) > 0.0 ? vec_dist(a, b) : HUGE_VAL;
}

/* ---- levels ---- */

static bool pixel_of(const Sharp *s, Vec2 q, int64_t *x, int64_t *y)
{
    *x = (int64_t)floor(q.x);
    *y = (int64_t)floor(s->scan->height - q.y);
    return *x >= 0 && *y >= 0 && *x < s->scan->width && *y < s->scan->height;
}

static double level(const Sharp *s, int64_t x, int64_t y) { return channel_value(s->scan, s->threshold->channel, (uint32_t)x, (uint32_t)y); }

/* How many of the pixels within r of one, in rows and columns, have one of the bits; those beyond the image have none. */
static uint32_t near_ones(const Sharp *s, int64_t x, int64_t y, int64_t r, uint8_t bits)
{
    uint32_t n = 0;
    for (int64_t j = MAX(y - r, 0); j <= MIN(y + r, s->mask->height - 1); j++)
        for (int64_t i = MAX(x - r, 0); i <= MIN(x + r, s->mask->width - 1); i++)
            n += (*mask_at(s->mask, (uint32_t)i, (uint32_t)j) & bits) != 0;
    return n;
}

/* Sums of levels, less the threshold. */
typedef struct {
    double n, sum, sum2;
} Tally;

/* Of pixels about one that are leaf with all their neighbours, or ground with those next to them. */
static Tally tally(const Sharp *s, int64_t cx, int64_t cy, int64_t reach, bool leaf)
{
    Tally t = {0};
    for (int64_t y = MAX(cy - reach, 0); y <= MIN(cy + reach, s->scan->height - 1); y++)
        for (int64_t x = MAX(cx - reach, 0); x <= MIN(cx + reach, s->scan->width - 1); x++) {
            bool in = *mask_at(s->mask, (uint32_t)x, (uint32_t)y) & MASK_THIS;
            if (in != leaf || (leaf ? near_ones(s, x, y, 1, MASK_THIS) < 9 : near_ones(s, x, y, 2, MASK_THIS | MASK_LEAF | MASK_STALK) > 0))
                continue;
            double v = level(s, x, y) - s->threshold->level;
            t.n += 1.0;
            t.sum += v;
            t.sum2 += v * v;
        }
    return t;
}

/* Levels of leaf and ground around an end; the leaf's from as near as it is wide enough. False when there is too little of either, or the noise is as much
 * as a thin tip. */
static bool scale_init(Scale *k, const Sharp *s, Vec2 at)
{
    int64_t x, y;
    if (!pixel_of(s, at, &x, &y))
        return false;
    Tally ground = tally(s, x, y, AROUND, false), leaf = {0};
    for (int64_t reach = AROUND; reach <= FAR && leaf.n < LEAST_LEAF; reach *= 2)
        leaf = tally(s, x, y, reach, true);
    if (leaf.n < LEAST_LEAF || ground.n < LEAST_GROUND || leaf.sum * ground.sum >= 0.0)
        return false;
    double mean = ground.sum / ground.n, noise = sqrt(MAX(ground.sum2 / ground.n - mean * mean, 0.0));
    *k = (Scale){mean + s->threshold->level, 1.0 / (leaf.sum / leaf.n - mean), 0.0};
    k->least = MAX(least_width, over_noise * fabs(k->to_leaf) * noise);
    return k->least <= most_noise;
}

/* Share of leaf, bilinear between the middles of pixels. False beyond the image and on what was cut off. */
static bool share_at(const Sharp *s, const Scale *k, Vec2 q, double *share)
{
    int64_t x, y, x1, y1;
    if (!pixel_of(s, vec2(q.x - 0.5, q.y + 0.5), &x, &y) || !pixel_of(s, vec2(q.x + 0.5, q.y - 0.5), &x1, &y1))
        return false;
    if ((*mask_at(s->mask, (uint32_t)x, (uint32_t)y) | *mask_at(s->mask, (uint32_t)x1, (uint32_t)y1)) & s->off)
        return false;
    double fx = q.x - 0.5 - (double)x, fy = s->scan->height - q.y - 0.5 - (double)y;
    double above = level(s, x, y) * (1.0 - fx) + level(s, x1, y) * fx, below = level(s, x, y1) * (1.0 - fx) + level(s, x1, y1) * fx;
    *share = (above * (1.0 - fy) + below * fy - k->ground) * k->to_leaf;
    return true;
}

/* A section: its width, and how far to the left its middle lies. False when there is something beside it. */
static bool section(const Sharp *s, const Scale *k, Vec2 at, Vec2 axis, double *width, double *off)
{
    Vec2 left = vec2(-axis.y, axis.x);
    double sum = 0.0, moment = 0.0, v, side[2] = {0.0, 0.0}, sides[2] = {0.0, 0.0};
    for (double u = -flank; u <= flank; u += fine) {
        if (!share_at(s, k, vec_add(at, vec_scale(left, u)), &v))
            return false;
        if (fabs(u) <= half) {
            sum += v * (fabs(u) == half ? 0.5 * fine : fine);
            moment += v * u * fine;
        } else if (fabs(u) > flank - 0.5) {
            side[u > 0.0] += v;
            sides[u > 0.0] += 1.0;
        }
    }
    *width = sum;
    *off = sum > 0.0 ? moment / sum : 0.0;
    return side[0] <= beside * sides[0] && side[1] <= beside * sides[1];
}

/* ---- an end ---- */

typedef struct {
    Vec2 p, axis;
    double width;
} Section;

/* Whether beyond the last section, a little and some more on, hardly anything follows. */
static bool is_over(const Sharp *s, const Scale *k, Vec2 at, Vec2 axis)
{
    double sum = 0.0, n = 0.0, width, off;
    for (double t = over_from; t <= over_to; t += step, n += 1.0) {
        if (!section(s, k, vec_add(at, vec_scale(axis, t)), axis, &width, &off))
            return false;
        sum += width;
    }
    return sum < 0.5 * k->least * n;
}

/* Sections from the traced end on while they show leaf; 0 when it is none to go on with. */
static uint32_t follow(const Sharp *s, const Scale *k, Vec2 at, Vec2 axis, double traced, Section *found)
{
    double width, off, least = HUGE_VAL;
    uint32_t n = 0;
    for (;;) {
        if (n >= MOST_SECTIONS || n * step > most_way || !section(s, k, at, axis, &width, &off))
            return 0;
        if (n == 0 && fabs(width - traced) > off_trace)
            return 0;
        if (width < k->least)
            return is_over(s, k, at, axis) ? n : 0;
        if (width > least + swell || fabs(off) > 1.0)
            return 0;
        least = MIN(width, least);
        Vec2 left = vec2(-axis.y, axis.x);
        found[n++] = (Section){vec_add(at, vec_scale(left, off)), axis, least};
        at = vec_add(vec_add(at, vec_scale(left, 0.5 * off)), vec_scale(axis, step));
        if (n >= 9) {
            Vec2 run = vec_sub(found[n - 1].p, found[n - 9].p);
            axis = vec_add(vec_scale(axis, 0.75), vec_scale(run, 0.25 / sqrt(vec_norm2(run))));
            axis = vec_scale(axis, 1.0 / sqrt(vec_norm2(axis)));
        }
    }
}

/* Where the line through the last widths ends, beyond the last section. */
static double beyond(const Section *found, uint32_t n)
{
    double st = 0.0, sw = 0.0, stt = 0.0, stw = 0.0, m = 0.0;
    for (uint32_t i = n > 9 ? n - 9 : 0; i < n; i++, m += 1.0) {
        double t = step * ((double)i - (double)(n - 1)), w = found[i].width;
        st += t;
        sw += w;
        stt += t * t;
        stw += t * w;
    }
    double det = m * stt - st * st, slope = det > 0.0 ? (m * stw - st * sw) / det : 0.0, there = det > 0.0 ? (sw - slope * st) / m : 0.0;
    return slope < 0.0 ? CLAMP(-there / slope, 0.0, most_beyond) : 0.0;
}

/* The axis of an end by the middles between its sides. *near: the middle nearer to it. False when it has none, or doesn't taper. */
static bool axis_at(const Polygon *p, uint32_t i, Vec2 *near, Vec2 *axis)
{
    Vec2 far = vec_lerp(along(p, i, -1, to, NULL), along(p, i, 1, to, NULL), 0.5);
    *near = vec_lerp(along(p, i, -1, from, NULL), along(p, i, 1, from, NULL), 0.5);
    *axis = vec_sub(*near, far);
    double length = sqrt(vec_norm2(*axis)), narrow = open_at(p, i, from), wide = open_at(p, i, to);
    if (!(length > 0.5 * (to - from)) || !(wide < HUGE_VAL && wide > narrow))
        return false;
    *axis = vec_scale(*axis, 1.0 / length);
    return true;
}

/* The vertices about vertex i beyond `cut` before the end, and how far before it along the axis that is from `near`. */
static bool take_off(const Polygon *p, uint32_t i, Vec2 near, Vec2 axis, End *e, double *there, double *width)
{
    uint32_t before, after, a = i, b = i;
    along(p, i, -1, to, &before);
    along(p, i, 1, to, &after);
    double last = -HUGE_VAL;
    for (uint32_t k = 0; k <= before + after; k++)
        last = MAX(last, vec_dot(vec_sub(p->v[(i + p->n - before + k) % p->n], near), axis));
    *there = last - cut;
    for (uint32_t k = 0; k <= before && vec_dot(vec_sub(p->v[a], near), axis) > *there; k++)
        a = a > 0 ? a - 1 : p->n - 1;
    for (uint32_t k = 0; k <= after && vec_dot(vec_sub(p->v[b], near), axis) > *there; k++)
        b = b + 1 < p->n ? b + 1 : 0;
    e->first = a + 1 < p->n ? a + 1 : 0;
    e->count = (b + p->n - a) % p->n - 1;
    *width = vec_dist(p->v[a], p->v[b]);
    return a != b && e->count > 0 && e->count < before + after;
}

static bool end_at(const Sharp *s, uint32_t i, End *e)
{
    const uint32_t stride = (uint32_t)(spacing / step);
    Vec2 near, axis;
    Scale k;
    double there, traced;
    Section found[MOST_SECTIONS];
    if (!axis_at(s->outline, i, &near, &axis) || !scale_init(&k, s, s->outline->v[i]) || !take_off(s->outline, i, near, axis, e, &there, &traced))
        return false;
    uint32_t n = follow(s, &k, vec_add(near, vec_scale(axis, there)), axis, traced, found);
    double past = n > 0 ? beyond(found, n) : 0.0;
    if (n == 0 || (n - 1) * step + past <= cut)
        return false;
    e->n = 0;
    for (uint32_t q = stride; q < n && e->n < MOST_NEW; q += stride) {
        Vec2 left = vec2(-found[q].axis.y, found[q].axis.x);
        e->side[0][e->n] = vec_add(found[q].p, vec_scale(left, -0.5 * found[q].width));
        e->side[1][e->n++] = vec_add(found[q].p, vec_scale(left, 0.5 * found[q].width));
    }
    e->apex = vec_add(found[n - 1].p, vec_scale(found[n - 1].axis, past));
    return true;
}

/* ---- all ends ---- */

static bool overlaps(const GArray *ends, const End *e, uint32_t n)
{
    for (guint k = 0; k < ends->len; k++) {
        const End *o = &g_array_index(ends, End, k);
        if ((e->first + n - o->first) % n < o->count || (o->first + n - e->first) % n < e->count)
            return true;
    }
    return false;
}

/* Ends that don't overlap, in the order of their vertices. */
static GArray *find_ends(const Sharp *s)
{
    const Polygon *p = s->outline;
    GArray *ends = g_array_new(FALSE, FALSE, sizeof(End));
    double *open = g_new(double, p->n);
    for (uint32_t i = 0; i < p->n; i++)
        open[i] = open_at(p, i, arm);
    for (uint32_t i = 0; i < p->n; i++) {
        uint32_t before, after;
        if (!(open[i] <= most_open * arm))
            continue;
        along(p, i, -1, arm, &before);
        along(p, i, 1, arm, &after);
        bool best = true;
        for (uint32_t k = 1; k <= before; k++)
            best = best && open[(i + p->n - k) % p->n] > open[i];
        for (uint32_t k = 1; k <= after; k++)
            best = best && open[(i + k) % p->n] >= open[i];
        End e;
        if (best && end_at(s, i, &e) && !overlaps(ends, &e, p->n))
            g_array_append_val(ends, e);
    }
    g_free(open);
    return ends;
}

/* `at`, unless NULL: where vertices are now; those that went are the end's apex. Vertex 0 stays first, or its apex is. */
static Polygon *with_ends(const Polygon *p, const GArray *ends, const bool *skip, uint32_t *at)
{
    uint32_t *end = g_new0(uint32_t, p->n), *now = at ? at : g_new(uint32_t, p->n), n = 0, most = p->n; /* end: 1 + that by which it goes */
    for (guint k = 0; k < ends->len; k++) {
        const End *e = &g_array_index(ends, End, k);
        for (uint32_t j = 0; j < e->count && !skip[k]; j++)
            end[(e->first + j) % p->n] = k + 1;
        most += 2 * e->n + 1;
    }
    Vec2 *v = g_new(Vec2, most), *turned;
    uint32_t start = 0; /* no end lies around the array's */
    while (end[start] && end[start] == end[start > 0 ? start - 1 : p->n - 1])
        start++;
    for (uint32_t c = 0, i = start; c < p->n; c++, i = i + 1 < p->n ? i + 1 : 0) {
        const End *e = end[i] ? &g_array_index(ends, End, end[i] - 1) : NULL;
        if (!e)
            v[n++] = p->v[i];
        else if (i == e->first) {
            for (uint32_t k = 0; k < e->n; k++)
                v[n++] = e->side[0][k];
            v[n++] = e->apex;
            for (uint32_t k = e->n; k-- > 0;)
                v[n++] = e->side[1][k];
        }
        now[i] = e ? n - 1 - e->n : n - 1;
    }
    const uint32_t zero = now[0];
    for (uint32_t i = 0; i < p->n; i++)
        now[i] = (now[i] + n - zero) % n;
    turned = g_new(Vec2, n);
    for (uint32_t i = 0; i < n; i++)
        turned[i] = v[(i + zero) % n];
    Polygon *out = polygon_new(turned, n);
    g_free(turned);
    g_free(v);
    g_free(end);
    if (!at)
        g_free(now);
    return out;
}

Polygon *sharp_ends(const Polygon *outline, const Scan *scan, const Threshold *t, const Mask *m, uint8_t off, uint32_t *at)
{
    Sharp s = {outline, scan, t, m, off};
    GArray *ends = find_ends(&s);
    bool *skip = g_new0(bool, ends->len + 1);
    Polygon *out = ends->len > 0 ? with_ends(outline, ends, skip, at) : NULL;
    uint32_t i, j;
    if (out && polygon_crossing(out, &i, &j)) { /* one by one, those that cross nothing */
        for (guint k = 0; k < ends->len; k++)
            skip[k] = true;
        for (guint k = 0; k < ends->len; k++) {
            polygon_free(out);
            skip[k] = false;
            out = with_ends(outline, ends, skip, NULL);
            skip[k] = polygon_crossing(out, &i, &j);
        }
        polygon_free(out);
        out = with_ends(outline, ends, skip, at);
    }
    g_free(skip);
    g_array_unref(ends);
    return out;
}
