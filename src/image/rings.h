/* Lists of polygons, and cutting them with half-planes. */
#ifndef IMAGE_RINGS_H
#define IMAGE_RINGS_H

#include <glib.h>
#include <string.h>

#include "geom/vec.h"

/* Polygons, one after the other. Of points that follow one another in a polygon no two all but coincide, as the direction of an edge between
 * them would be noise; nor do its last one and its first. */
typedef struct {
    Vec2 *v;
    uint32_t *end; /* of each polygon in v */
    uint32_t n_v, cap_v, n, cap;
} Rings;

#define RINGS_NEARBY 1e-9 /* pixels */

void rings_clear(Rings *r);
void rings_grow(Rings *r, uint32_t points); /* use rings_room */
void rings_add(Rings *r);                   /* use rings_close */

static inline bool rings_same(Vec2 a, Vec2 b)
{
    return fabs(a.x - b.x) < RINGS_NEARBY && fabs(a.y - b.y) < RINGS_NEARBY;
}

static inline uint32_t ring_start(const Rings *r, uint32_t i)
{
    return i > 0 ? r->end[i - 1] : 0;
}

static inline void rings_reset(Rings *r)
{
    r->n = r->n_v = 0;
}

static inline void rings_room(Rings *r, uint32_t points)
{
    if (r->n_v + points > r->cap_v)
        rings_grow(r, points);
}

/* Points that all but coincide become one. There must be room. */
static inline Vec2 *put_point(const Vec2 *first, Vec2 *to, Vec2 p)
{
    if (to == first || !rings_same(to[-1], p))
        *to++ = p;
    return to;
}

/* Closes the polygon made of the points since the last one; a polygon without area is dropped. */
static inline void rings_close(Rings *r)
{
    uint32_t start = ring_start(r, r->n);
    while (r->n_v > start + 1 && rings_same(r->v[r->n_v - 1], r->v[start]))
        r->n_v--;
    if (r->n_v < start + 3)
        r->n_v = start;
    else if (r->n < r->cap)
        r->end[r->n++] = r->n_v;
    else
        rings_add(r);
}

static inline void rings_copy(Rings *to, const Vec2 *v, uint32_t n)
{
    rings_room(to, n);
    memcpy(to->v + to->n_v, v, n * sizeof *v);
    to->n_v += n;
    rings_close(to);
}

static inline double ring_area(const Vec2 *v, uint32_t n)
{
    double sum = 0.0;
    for (uint32_t i = 1; i + 1 < n; i++)
        sum += vec_cross(vec_sub(v[i], v[0]), vec_sub(v[i + 1], v[0]));
    return 0.5 * fabs(sum);
}

/* Adds to `out` the part of a polygon, convex or not, where p · normal <= bound. */
void ring_clip(const Vec2 *v, uint32_t n, Vec2 normal, double bound, Rings *out);

/* The same for a convex polygon of a list: `mask` has a bit for each of its n points, no more than 32, that is beyond, some but not all of them,
 * and `beyond` how far each is, negative when it is not. */
void ring_cut_known(const Vec2 *v, uint32_t n, const double *beyond, uint32_t mask, Rings *out);

/* Puts into `out` the part of a polygon, convex or not, within a box: out->n is 0 when there is none. Where it leaves the
 * box it runs along its sides, so that turns around points within stay what they are. `spare` is scratch. */
void ring_within(const Vec2 *v, uint32_t n, Box2 box, Rings *out, Rings *spare);

#endif
