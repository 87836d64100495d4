/* A bucket quadtree over points that only ever come: the index of the vein nodes. It holds indices into an array of positions
 * that the caller keeps (and passes to each query), 4 bytes a point and about 6 for the tree. */
#ifndef GEOM_QUADTREE_H
#define GEOM_QUADTREE_H

#include "geom/vec.h"

#define NO_POINT UINT32_MAX

typedef struct {
    uint32_t child; /* first of four, 0 for a leaf */
    uint32_t head;  /* leaf: first point of its chain */
    uint32_t count; /* leaf: points in the chain */
} QuadNode;

typedef struct {
    Vec2 centre;
    double half; /* of the root square's side */
    QuadNode *node;
    uint32_t n_nodes, cap_nodes;
    uint32_t *next; /* [cap] chain of a leaf's points */
    uint32_t n, cap;
} Quadtree;

/* A square of the tree during a walk. */
typedef struct {
    uint32_t node;
    Vec2 centre;
    double half;
} QuadSquare;

void quadtree_init(Quadtree *t, Box2 box); /* all points must lie in the square around box */
void quadtree_clear(Quadtree *t);          /* frees */
void quadtree_reset(Quadtree *t, Box2 box); /* empties, keeping the memory */

/* Adds point `i`; pos[i] is its place. O(log n). */
void quadtree_add(Quadtree *t, const Vec2 *pos, uint32_t i);

static inline QuadSquare quadtree_root(const Quadtree *t) { return (QuadSquare){0, t->centre, t->half}; }

/* Quadrant k (0 … 3: bit 0 right, bit 1 upper) of an inner square. */
static inline QuadSquare quadtree_quadrant(const Quadtree *t, QuadSquare q, unsigned k)
{
    double h = q.half * 0.5;
    Vec2 c = vec2(q.centre.x + (k & 1 ? h : -h), q.centre.y + (k & 2 ? h : -h));
    return (QuadSquare){t->node[q.node].child + k, c, h};
}

static inline double quadtree_square_dist2(QuadSquare q, Vec2 p)
{
    double dx = fabs(p.x - q.centre.x) - q.half, dy = fabs(p.y - q.centre.y) - q.half;
    dx = dx > 0.0 ? dx : 0.0;
    dy = dy > 0.0 ? dy : 0.0;
    return dx * dx + dy * dy;
}

/* Says whether point i may be seen; NULL means all may. */
typedef bool (*PointFilter)(const void *user, uint32_t i);

/* Nearest point to p that passes the filter and is nearer than sqrt(bound2); of equally near ones the smallest index.
 * Returns NO_POINT when there is none, else sets *d2. O(log n) expected. */
uint32_t quadtree_nearest(const Quadtree *t, const Vec2 *pos, Vec2 p, double bound2, PointFilter filter, const void *user,
                          double *d2);

/* Whether a point lies nearer to p than r. */
bool quadtree_any_within(const Quadtree *t, const Vec2 *pos, Vec2 p, double r);

#endif
