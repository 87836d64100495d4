/* Made-up leaves for the mesher's tests: outlines of several kinds with branching veins that keep clear of all else. Plain O(n²). */
#ifndef TESTS_PLAIN_LEAF_H
#define TESTS_PLAIN_LEAF_H

#include <glib.h>
#include <string.h>

#include "geom/dtrig.h"
#include "geom/mesh.h"
#include "geom/random.h"
#include "geom/segment.h"

enum { LEAF_ELLIPSE, LEAF_LOBED, LEAF_SERRATE, LEAF_SINUSES, LEAF_JAGGED, LEAF_FINGERS, LEAF_KINDS };

typedef struct {
    GArray *point, *segment; /* Vec2, uint32_t[2] */
    uint32_t n_outline;
    Polygon *outline;
    double clear;   /* of vein segments from all that they do not meet */
    double branch;  /* angle of branches, radians */
    uint64_t draws; /* random numbers used */
    uint64_t seed;
} PlainLeaf;

static inline double plain_uniform(uint64_t seed, uint32_t stream, uint64_t index)
{
    double u[2];
    random_pair(seed, stream, 0, index, u);
    return u[0];
}

static inline double plain_radius(int kind, uint32_t i, double t, uint64_t seed)
{
    double s = dtrig_sin(2.5 * t);
    switch (kind) {
    case LEAF_LOBED:
        return 1.0 + 0.3 * dtrig_cos((double)(3 + seed % 5) * t);
    case LEAF_SERRATE:
        return i % 2 ? 1.0 : 0.85 + 0.1 * (double)(seed % 2);
    case LEAF_SINUSES:
        return 1.0 + 0.9 * dtrig_cos((double)(2 + seed % 4) * t + 1.0);
    case LEAF_JAGGED:
        return 0.5 + 0.5 * plain_uniform(seed, 1, i);
    case LEAF_FINGERS:
        return 1.0 - 0.85 * s * s * s * s;
    default:
        return 1.0;
    }
}

static inline void plain_leaf_init(PlainLeaf *l, int kind, uint32_t n, uint64_t seed)
{
    *l = (PlainLeaf){.n_outline = n, .seed = seed};
    l->point = g_array_new(FALSE, FALSE, sizeof(Vec2));
    l->segment = g_array_new(FALSE, FALSE, 2 * sizeof(uint32_t));
    for (uint32_t i = 0; i < n; i++) {
        double t = 2.0 * DTRIG_PI * i / n - 0.5 * DTRIG_PI, r = plain_radius(kind, i, t, seed);
        Vec2 p = vec2((seed % 2 ? 0.6 : 0.9) * r * dtrig_cos(t), r * dtrig_sin(t));
        g_array_append_val(l->point, p);
    }
    l->outline = polygon_new((Vec2 *)l->point->data, n);
}

static inline void plain_leaf_clear(PlainLeaf *l)
{
    g_array_free(l->point, TRUE);
    g_array_free(l->segment, TRUE);
    polygon_free(l->outline);
}

static inline Vec2 plain_point(const PlainLeaf *l, uint32_t i) { return g_array_index(l->point, Vec2, i); }

static inline uint32_t plain_add_point(PlainLeaf *l, Vec2 p)
{
    g_array_append_val(l->point, p);
    return l->point->len - 1;
}

static inline void plain_add_segment(PlainLeaf *l, uint32_t a, uint32_t b)
{
    const uint32_t s[2] = {a, b};
    g_array_append_val(l->segment, s);
}

static inline bool plain_apart(Vec2 a, Vec2 b, Vec2 c, Vec2 d, double least)
{
    Vec2 ab = vec_sub(b, a), cd = vec_sub(d, c);
    if (vec_cross(ab, vec_sub(c, a)) * vec_cross(ab, vec_sub(d, a)) < 0.0 &&
        vec_cross(cd, vec_sub(a, c)) * vec_cross(cd, vec_sub(b, c)) < 0.0)
        return false;
    return fmin(fmin(segment_dist2(a, b, c), segment_dist2(a, b, d)), fmin(segment_dist2(c, d, a), segment_dist2(c, d, b))) >=
           least * least;
}

/* Whether a segment from point `from` to p keeps clear; of those that it meets at `from` only its and their ends count. */
static inline bool plain_is_free(const PlainLeaf *l, uint32_t from, Vec2 p)
{
    if (!polygon_contains(l->outline, p))
        return false;
    for (uint32_t i = 0; i < l->n_outline + l->segment->len; i++) {
        const uint32_t *s = i < l->n_outline ? NULL : &g_array_index(l->segment, uint32_t, 2 * (i - l->n_outline));
        uint32_t u = s ? s[0] : i, v = s ? s[1] : (i + 1) % l->n_outline;
        Vec2 a = plain_point(l, from), c = plain_point(l, u), d = plain_point(l, v);
        if (u != from && v != from) {
            if (!plain_apart(a, p, c, d, l->clear))
                return false;
        } else if (segment_dist2(a, p, u == from ? d : c) < l->clear * l->clear || segment_dist2(c, d, p) < l->clear * l->clear) {
            return false;
        }
    }
    return true;
}

/* A vein of up to n steps from a point, with two branches at each node. */
static inline void plain_grow(PlainLeaf *l, uint32_t from, double angle, double step, int n, int depth)
{
    for (int i = 0; i < n; i++) {
        angle += 0.3 * (plain_uniform(l->seed, 2, l->draws++) - 0.5);
        Vec2 p = vec_add(plain_point(l, from), vec2(step * dtrig_cos(angle), step * dtrig_sin(angle)));
        if (!plain_is_free(l, from, p))
            return;
        uint32_t to = plain_add_point(l, p);
        plain_add_segment(l, from, to);
        from = to;
        if (depth == 0 || i == 0)
            continue;
        double turn = l->branch * (0.7 + 0.6 * plain_uniform(l->seed, 2, l->draws++));
        plain_grow(l, from, angle + turn, 0.8 * step, n, depth - 1);
        plain_grow(l, from, angle - turn, 0.8 * step, n, depth - 1);
    }
}

static inline Pslg *plain_graph(const PlainLeaf *l)
{
    Pslg *g = pslg_new(l->point->len, l->n_outline, l->segment->len);
    memcpy(g->point, l->point->data, l->point->len * sizeof(Vec2));
    if (l->segment->len)
        memcpy(g->segment, l->segment->data, l->segment->len * sizeof *g->segment);
    return g;
}

/* An outline of n points with veins in steps of `step`, branching at about `branch` degrees, `clear` from each other. */
static inline Pslg *plain_leaf(int kind, uint32_t n, uint64_t seed, double step, double branch, double clear)
{
    PlainLeaf l;
    plain_leaf_init(&l, kind, n, seed);
    l.branch = branch * DTRIG_DEGREE;
    l.clear = clear;
    plain_grow(&l, 0, 0.5 * DTRIG_PI, step, (int)(1.8 / step), 2);
    Pslg *g = plain_graph(&l);
    plain_leaf_clear(&l);
    return g;
}

#endif
