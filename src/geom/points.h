/* A few points beside each other in memory, and which of them can concern places in a box: from those of a step to those of a part of the
 * blade, and from these to those of a small part. */
#ifndef GEOM_POINTS_H
#define GEOM_POINTS_H

#include <glib.h>

#include "geom/vec.h"
#include "geom/vectors.h"

/* Points, ascending. The arrays are held elsewhere, with room for some more (points_room); the last point fills it up. */
typedef struct {
    uint32_t n, *v; /* what they are called */
    double *x, *y;
} Points;

enum { POINTS_MOST = 256 };

static inline uint32_t points_room(uint32_t n) { return n + 4; }

/* Places of points v[0 … n-1]. */
void points_fill(Points *p, const Vec2 *pos);

/* Leaves out those that can't be the nearest one to any place in the box or are not nearer to it than sqrt(bound2). Returns how many are left in
 * `out`, which may be `p`; more than POINTS_MOST: they did not fit, and it is of no use. Depends on the points alone. O(n). */
uint32_t points_nearest_to(const Points *p, Box2 box, double bound2, Points *out);

/* The only one that is nearest to any place in the box; UINT32_MAX: there are several, as far as this tells. O(n). */
uint32_t points_sole(const Points *p, Box2 box);

/* Moves *best and *best2 to the point nearest to `at`, if one is nearer than sqrt(*best2): of equally near ones the first. O(n). */
void points_nearest(const Points *p, Vec2 at, uint32_t *best, double *best2);

/* With near->n > 0 points, the nearest one to any place in the box among them: all of p but such as the nearest one, or (unless nearest_alone)
 * another, excludes from the relative neighbourhood of any place in the box (neighbours.h), and some more. Returns how many; more than `cap`
 * when they did not fit. `out` may be `p`. */
uint32_t points_rivals(const Points *p, Box2 box, const Points *near, bool nearest_alone, Points *out, uint32_t cap);

/* ---- how a few points keep others out ---- */

/* Squared distances are rounded: what is farther by less than this counts as near. */
#define POINTS_SLACK (1.0 + 1e-9)

/* Squared distance between two boxes. */
static inline double box_gap2(Box2 a, Box2 b)
{
    double dx = MAX(MAX(a.x0 - b.x1, b.x0 - a.x1), 0.0), dy = MAX(MAX(a.y0 - b.y1, b.y0 - a.y1), 0.0);
    return dx * dx + dy * dy;
}

/* Largest squared distance between points of the two. */
static inline double box_far2(Box2 a, Box2 b)
{
    double dx = MAX(a.x1 - b.x0, b.x1 - a.x0), dy = MAX(a.y1 - b.y0, b.y1 - a.y0);
    return dx * dx + dy * dy;
}

static inline Box2 point_box(Vec2 p) { return (Box2){p.x, p.y, p.x, p.y}; }

/* Points near a box, one of which is nearest to any place in it. */
typedef struct {
    Box2 box, hull;      /* hull: of the points */
    double x[4], y[4];   /* all of them, or those nearest to the corners */
    double corner2[4][4]; /* [c][i]: the squared distance of i from corner c, a little farther */
    bool all, nearest_alone;
} Guard;

void guard_make(Guard *g, Box2 box, const Points *near, bool nearest_alone);

/* Is whatever lies in `b` excluded (neighbours.h) from every place in the box by the point nearest to it? */
static inline bool guard_shuts_out(const Guard *g, Box2 b) { return box_far2(g->hull, b) * POINTS_SLACK <= box_gap2(g->box, b); }

/* Those that the guard excludes from all over its box go. `out` may be `p`. Returns how many are left; more than `cap` when they did not fit. */
uint32_t guard_pass(const Guard *g, const Points *p, Points *out, uint32_t cap);

/* Rivals that are nearest to a corner exclude others from all over the box. */
uint32_t points_thin_out(Box2 box, Points *p);

#endif
