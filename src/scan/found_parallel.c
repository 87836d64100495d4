/* Parallel-veined leaves (grasses, orchids, lilies): their primaries run side by side from end to end, many from the width of the base rather than from a
 * point, so that paths that leave veins already found would step from one to the next. Here each is followed both ways from where rows across
 * the blade meet it. */
#include <math.h>

#include "scan/found_parts.h"

static const double row_from = 0.25, row_to = 0.75; /* of the axis: where lines must agree with it */
static const double least_parallel = 0.75;          /* mean cosine of twice their angle to it, by strength */
static const double rows[] = {0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8};
static const double step = 2.0;                     /* working pixels */
static const double look = 1.5;                     /* to each side, for the ridge's top */
static const double turning = 0.25;                 /* share of the ridge's own direction in the next step's */
static const double most_slant = 0.5;               /* cosine to the axis: beyond 60° a line is no primary */
static const double kept_share = 0.6;               /* of the strength asked for at the start: enough to go on */
static const double longest_gap = 0.05;             /* of the axis: unseen for so long, a vein has ended */
static const double least_length = 0.3;             /* of the axis */
static const double primary_start = 0.08;           /* of the axis: what leaves another vein farther from the base is a secondary */
static const double lane = 3.0;                     /* working pixels: no vein runs nearer to another */
enum { LEAST_VEINS = 5, MOST_STEPS = 4000 };

typedef struct {
    const FoundLeaf *l;
    const FoundRidges *r;
    Vec2 base, along; /* unit */
    double length, threshold;
    uint16_t *taken; /* 1 + the vein already followed that runs there; 0 none */
} Field;

static bool pixel_of(const FoundLeaf *l, Vec2 q, gsize *i)
{
    if (!(q.x >= 0.0 && q.y >= 0.0 && q.x < l->width && q.y < l->height))
        return false;
    *i = (gsize)q.y * l->width + (gsize)q.x;
    return l->deep[*i] != 0;
}

/* Unit vector along the ridge, rows down, in the sense of `way`. */
static Vec2 ridge_way(const FoundRidges *r, gsize i, Vec2 way)
{
    double c2 = (double)r->cosine->px[i], s2 = (double)r->sine->px[i];
    double c = sqrt(MAX(0.0, 0.5 * (1.0 + c2))), s = sqrt(MAX(0.0, 0.5 * (1.0 - c2)));
    Vec2 u = vec2(c, s2 >= 0.0 ? -s : s);
    return vec_dot(u, way) < 0.0 ? vec_scale(u, -1.0) : u;
}

/* Strength of a ridge that heads in a way, 0 off the blade. */
static double strength_at(const Field *f, Vec2 q, Vec2 way)
{
    gsize i;
    if (!pixel_of(f->l, q, &i))
        return 0.0;
    double c = vec_dot(ridge_way(f->r, i, way), way);
    return (double)f->r->strength->px[i] * MAX(0.0, 2.0 * c * c - 1.0);
}

static bool is_parallel(const Field *f)
{
    double sum = 0.0, all = 0.0;
    for (uint32_t y = 0; y < f->l->height; y++)
        for (uint32_t x = 0; x < f->l->width; x++) {
            gsize i = (gsize)y * f->l->width + x;
            double s = (double)f->r->strength->px[i], at = vec_dot(vec_sub(vec2(x + 0.5, y + 0.5), f->base), f->along) / f->length;
            if (!f->l->deep[i] || s < f->threshold || at < row_from || at > row_to)
                continue;
            double c = vec_dot(ridge_way(f->r, i, f->along), f->along);
            sum += s * (2.0 * c * c - 1.0);
            all += s;
        }
    return sum > least_parallel * all;
}

/* Onto the top of the ridge beside a point. */
static Vec2 centred(const Field *f, Vec2 q, Vec2 way)
{
    Vec2 normal = vec2(-way.y, way.x);
    double sum = 0.0, all = 0.0;
    for (double off = -look; off <= look; off += 0.5) {
        double s = strength_at(f, vec_add(q, vec_scale(normal, off)), way);
        sum += s * s * off;
        all += s * s;
    }
    return all > 0.0 ? vec_add(q, vec_scale(normal, sum / all)) : q;
}

/* Follows a ridge from q; points after q are appended. As far as it is seen, or to another vein: then 1 + its index, else 0. */
static uint32_t follow(const Field *f, Vec2 q, Vec2 sense, GArray *points)
{
    Vec2 way = sense;
    guint seen = points->len;
    double gap = 0.0;
    gsize i;
    for (uint32_t k = 0; k < MOST_STEPS && gap <= longest_gap * f->length; k++) {
        q = centred(f, vec_add(q, vec_scale(way, step)), way);
        if (!pixel_of(f->l, q, &i) || vec_dot(way, sense) < most_slant)
            break;
        g_array_append_val(points, q);
        bool strong = strength_at(f, q, way) >= kept_share * f->threshold;
        gap = strong ? 0.0 : gap + step;
        seen = strong ? points->len : seen;
        if (f->taken[i]) {
            g_array_set_size(points, seen);
            return gap > 0.0 ? 0 : f->taken[i];
        }
        Vec2 u = strong ? vec_add(vec_scale(way, 1.0 - turning), vec_scale(ridge_way(f->r, i, way), turning)) : way;
        way = vec_scale(u, 1.0 / sqrt(vec_norm2(u)));
    }
    g_array_set_size(points, seen);
    return 0;
}

/* The pixels of a line of points, each once in a row. */
static uint32_t *chain(const FoundLeaf *l, const GArray *points, uint32_t *n)
{
    GArray *a = g_array_new(FALSE, FALSE, sizeof(uint32_t));
    for (guint k = 0; k < points->len; k++) {
        Vec2 q = g_array_index(points, Vec2, k);
        uint32_t i = (uint32_t)q.y * l->width + (uint32_t)q.x;
        if (a->len == 0 || g_array_index(a, uint32_t, a->len - 1) != i)
            g_array_append_val(a, i);
    }
    *n = a->len;
    return (uint32_t *)g_array_free(a, FALSE);
}

static void take(const Field *f, const uint32_t *pixel, uint32_t n, uint32_t id)
{
    int32_t r = (int32_t)ceil(lane), w = (int32_t)f->l->width, h = (int32_t)f->l->height;
    for (uint32_t k = 0; k < n; k++) {
        int32_t x = (int32_t)(pixel[k] % f->l->width), y = (int32_t)(pixel[k] / f->l->width);
        for (int32_t j = MAX(0, y - r); j <= MIN(h - 1, y + r); j++)
            for (int32_t i = MAX(0, x - r); i <= MIN(w - 1, x + r); i++)
                if ((i - x) * (i - x) + (j - y) * (j - y) <= lane * lane)
                    f->taken[(gsize)j * f->l->width + (gsize)i] = (uint16_t)(id + 1);
    }
}

/* The vein through a point of a row, from the base on. A secondary where it leaves another at some way from the base. */
static bool try_vein(const Field *f, Vec2 q, GArray *vein)
{
    GArray *back = g_array_new(FALSE, FALSE, sizeof(Vec2)), *line = g_array_new(FALSE, FALSE, sizeof(Vec2));
    uint32_t from = follow(f, q, vec_scale(f->along, -1.0), back);
    for (guint k = back->len; k-- > 0;)
        g_array_append_val(line, g_array_index(back, Vec2, k));
    g_array_append_val(line, q);
    follow(f, q, f->along, line);
    FoundVein v = {.order = 1, .parent = from ? from - 1 : vein->len};
    if (from && vec_dist(g_array_index(line, Vec2, 0), f->base) > primary_start * f->length)
        v.order = 2;
    v.pixel = chain(f->l, line, &v.n_pixels);
    bool good = line->len * step >= least_length * f->length && v.n_pixels >= 4 && vein->len < UINT16_MAX;
    if (good) {
        take(f, v.pixel, v.n_pixels, vein->len);
        g_array_append_val(vein, v);
    } else {
        g_free(v.pixel);
    }
    g_array_free(back, TRUE);
    g_array_free(line, TRUE);
    return good;
}

/* The vein whose ridge has its top at a place in a row across the blade, `off` from the axis. */
static bool search_at(const Field *f, double at, double off, GArray *vein)
{
    Vec2 across = vec2(-f->along.y, f->along.x), q = vec_add(vec_add(f->base, vec_scale(f->along, at * f->length)), vec_scale(across, off));
    gsize i;
    if (!pixel_of(f->l, q, &i) || f->taken[i])
        return false;
    double s = strength_at(f, q, f->along);
    bool top = s >= f->threshold && s >= strength_at(f, vec_sub(q, across), f->along) && s > strength_at(f, vec_add(q, across), f->along);
    return top && try_vein(f, q, vein);
}

bool found_parallel(const FoundLeaf *l, const FoundRidges *r, Vec2 base, Vec2 tip, double threshold, GArray *vein)
{
    Vec2 axis = vec_sub(tip, base);
    Field f = {.l = l, .r = r, .base = base, .length = sqrt(vec_norm2(axis)), .threshold = threshold};
    if (!(f.length > 0.0))
        return false;
    f.along = vec_scale(axis, 1.0 / f.length);
    if (!is_parallel(&f))
        return false;
    f.taken = g_new0(uint16_t, (gsize)l->width * l->height);
    double half = ceil(l->length);
    for (double off = 0.0; off <= half && vein->len == 0; off += 1.0) /* the midvein, which others may leave */
        if (!search_at(&f, rows[0], off, vein))
            search_at(&f, rows[0], -off, vein);
    for (uint32_t k = 0; k < G_N_ELEMENTS(rows); k++)
        for (double off = -half; off <= half; off += 1.0)
            search_at(&f, rows[k], off, vein);
    g_free(f.taken);
    if (vein->len < LEAST_VEINS)
        g_array_set_size(vein, 0);
    return vein->len > 0;
}
