/* A bucket quadtree over points that only ever come: the index of the vein nodes. Leaves keep their points' places beside each other,
 * because a query that chased indices through the whole array would mostly wait for memory. About 40 bytes a point. */
#ifndef GEOM_QUADTREE_H
#define GEOM_QUADTREE_H

#include "geom/vec.h"

#define NO_POINT UINT32_MAX

enum { QUAD_BUCKET = 8 };

typedef struct {
    Vec2 p[QUAD_BUCKET];
    uint32_t i[QUAD_BUCKET]; /* what the points are called */
    uint32_t count;
    uint32_t next; /* overflow of a leaf of coincident points, else NO_POINT */
} QuadBucket;

typedef struct {
    uint32_t child;  /* first of four, 0 for a leaf */
    uint32_t bucket; /* leaf: its points, NO_POINT when there are none */
} QuadNode;

typedef struct {
    Vec2 centre;
    double half; /* of the root square's side */
    QuadNode *node;
    uint32_t n_nodes, cap_nodes;
    QuadBucket *bucket;
    uint32_t n_buckets, cap_buckets;
} Quadtree;

/* A square of the tree during a walk. */
typedef struct {
    uint32_t node;
    Vec2 centre;
    double half;
} QuadSquare;

enum { QUAD_DEPTH = 40, QUAD_STACK = 3 * QUAD_DEPTH + 4 };

void quadtree_init(Quadtree *t, Box2 box); /* all points must lie in the square around box */
void quadtree_clear(Quadtree *t);          /* frees */
void quadtree_reset(Quadtree *t, Box2 box); /* empties, keeping the memory */

/* Adds point `i` at p. O(log n). */
void quadtree_add(Quadtree *t, Vec2 p, uint32_t i);

static inline QuadSquare quadtree_root(const Quadtree *t) { return (QuadSquare){0, t->centre, t->half}; }

/* Quadrant k (0 … 3: bit 0 right, bit 1 upper) of an inner square. */
static inline QuadSquare quadtree_quadrant(const Quadtree *t, QuadSquare q, unsigned k)
{
    double h = q.half * 0.5;
    Vec2 c = vec2(q.centre.x + (k & 1 ? h : -h), q.centre.y + (k & 2 ? h : -h));
    return (QuadSquare){t->node[q.node].child + k, c, h};
}

/* Half a side, a little more: a point may lie outside its square by the rounding of the centres, which is up to 2^-10 of the smallest
 * squares' sides. */
static inline double quadtree_reach(QuadSquare q) { return q.half * (1.0 + 0x1p-8); }

static inline double quadtree_square_dist2(QuadSquare q, Vec2 p)
{
    double half = quadtree_reach(q), dx = fabs(p.x - q.centre.x) - half, dy = fabs(p.y - q.centre.y) - half;
    dx = dx > 0.0 ? dx : 0.0;
    dy = dy > 0.0 ? dy : 0.0;
    return dx * dx + dy * dy;
}

/* A small square that holds all points in the box. O(log n). */
QuadSquare quadtree_around(const Quadtree *t, Box2 box);

/* Says whether point i may be seen; NULL means all may. */
typedef bool (*PointFilter)(const void *user, uint32_t i);

/* Nearest point to p that passes the filter and is nearer than sqrt(bound2); of equally near ones the smallest index.
 * Returns NO_POINT when there is none, else sets *d2. O(log n) expected. */
uint32_t quadtree_nearest(const Quadtree *t, Vec2 p, double bound2, PointFilter filter, const void *user, double *d2);

/* Whether a point lies nearer to p than r. */
bool quadtree_any_within(const Quadtree *t, Vec2 p, double r);

#endif
