/* A tapered stroke with round ends: the convex hull of two discs. Image coordinates, pixels, y down. */
#ifndef IMAGE_CAPSULE_H
#define IMAGE_CAPSULE_H

#include "geom/vec.h"

typedef struct {
    Vec2 a, b;     /* centres of the end discs */
    double ra, rb; /* their radii */
    Vec2 d;        /* unit vector from a to b */
    double length; /* |ab|; 0 when one disc holds the other, then a = b */
    double s, c;   /* sine and cosine of the taper: the sides' outer normals are d s ± (d turned left) c */
} Capsule;

static inline Capsule capsule_new(Vec2 a, double ra, Vec2 b, double rb)
{
    Capsule k = {a, b, ra, rb, {1.0, 0.0}, vec_dist(a, b), 0.0, 1.0};
    double taper = ra - rb;
    if (k.length <= (taper < 0.0 ? -taper : taper) || k.length == 0.0) {
        if (ra >= rb) {
            k.b = a;
            k.rb = ra;
        } else {
            k.a = b;
            k.ra = rb;
        }
        k.length = 0.0;
        return k;
    }
    k.d = vec_scale(vec_sub(b, a), 1.0 / k.length);
    k.s = taper / k.length;
    k.c = sqrt(1.0 - k.s * k.s);
    return k;
}

/* Outer normal of the left (sign +1) or right (-1) side. */
static inline Vec2 capsule_normal(const Capsule *k, double sign)
{
    double c = sign * k->c;
    return vec2(k->d.x * k->s - k->d.y * c, k->d.y * k->s + k->d.x * c);
}

/* Signed distance of p to the surface, negative inside; *t is where along the axis the nearest cross-section lies, 0
 * … 1. */
static inline double capsule_distance(const Capsule *k, Vec2 p, double *t)
{
    Vec2 q = vec_sub(p, k->a);
    double x = vec_dot(q, k->d), y = vec_cross(k->d, q);
    y = y < 0.0 ? -y : y;
    double along = x * k->c - y * k->s, side = k->length * k->c;
    if (!(along > 0.0)) {
        *t = 0.0;
        return sqrt(vec_norm2(q)) - k->ra;
    }
    if (along >= side) {
        *t = 1.0;
        return vec_dist(p, k->b) - k->rb;
    }
    *t = along / side;
    return x * k->s + y * k->c - k->ra;
}

static inline double capsule_radius(const Capsule *k, double t)
{
    return k->ra + (k->rb - k->ra) * t;
}

static inline Box2 capsule_box(const Capsule *k)
{
    return box_union(box_grow((Box2){k->a.x, k->a.y, k->a.x, k->a.y}, k->ra),
                     box_grow((Box2){k->b.x, k->b.y, k->b.x, k->b.y}, k->rb));
}

/* An interval on a line; lo > hi when empty. */
typedef struct {
    double lo, hi;
} Span;

static inline void span_add(Span *s, double lo, double hi)
{
    s->lo = lo < s->lo ? lo : s->lo;
    s->hi = hi > s->hi ? hi : s->hi;
}

/* Where the horizontal line at y meets the stroke. */
static inline Span capsule_chord(const Capsule *k, double y)
{
    Span s = {(double)INFINITY, -(double)INFINITY};
    double da = y - k->a.y, ha = k->ra * k->ra - da * da;
    if (ha >= 0.0) {
        ha = sqrt(ha);
        span_add(&s, k->a.x - ha, k->a.x + ha);
    }
    if (k->length == 0.0)
        return s;
    double db = y - k->b.y, hb = k->rb * k->rb - db * db;
    if (hb >= 0.0) {
        hb = sqrt(hb);
        span_add(&s, k->b.x - hb, k->b.x + hb);
    }
    for (double sign = -1.0; sign <= 1.0; sign += 2.0) {
        Vec2 n = capsule_normal(k, sign);
        Vec2 p = vec_add(k->a, vec_scale(n, k->ra)), q = vec_add(k->b, vec_scale(n, k->rb));
        if ((p.y <= y) == (q.y <= y))
            continue;
        double x = p.x + (q.x - p.x) * ((y - p.y) / (q.y - p.y));
        span_add(&s, x, x);
    }
    return s;
}

/* Where the strip y0 … y1 meets the stroke, given its chords at y0 and y1. */
static inline Span capsule_reach(const Capsule *k, double y0, double y1, Span at0, Span at1)
{
    Span s = at0;
    span_add(&s, at1.lo, at1.hi);
    if (k->a.y > y0 && k->a.y < y1)
        span_add(&s, k->a.x - k->ra, k->a.x + k->ra);
    if (k->b.y > y0 && k->b.y < y1)
        span_add(&s, k->b.x - k->rb, k->b.x + k->rb);
    return s;
}

#endif
