/* A binary tree of tight bounding boxes over a set of points that is known at once: this step's new vein nodes. */
#ifndef GEOM_BOXTREE_H
#define GEOM_BOXTREE_H

#include "geom/points.h"

enum { BOXTREE_LEAF = 4, BOXTREE_DEPTH = 40 };

typedef struct {
    Box2 box;
    uint32_t first, count; /* points, a part of item[] */
    uint32_t right;        /* second child (the first follows its parent); 0 for a leaf */
} BoxNode;

typedef struct {
    BoxNode *node;
    uint32_t *item;
    uint32_t n_nodes, n_items, cap_nodes, cap_items;
} Boxtree;

void boxtree_clear(Boxtree *t);

/* Builds the tree over points item[0 … n-1] at pos[item]; depends on their order and places alone. O(n log n). */
void boxtree_build(Boxtree *t, const Vec2 *pos, const uint32_t *item, uint32_t n);

/* Whether a box holds any of the points. */
bool boxtree_any_in(const Boxtree *t, const Vec2 *pos, Box2 box);

/* Moves *best and *best2 to the point nearest to p when one is nearer than sqrt(*best2) that the filter (NULL: any) lets pass. Of equally near
 * points the smallest wins, and what was in *best before wins over all. */
void boxtree_nearest(const Boxtree *t, const Vec2 *pos, Vec2 p, bool (*filter)(const void *user, uint32_t i), const void *user,
                     uint32_t *best, double *best2);

/* Points that may be the nearest one to some place in the box and are nearer to it than sqrt(bound2), and some more, in no order. Returns how
 * many; more than `cap` when they did not fit, and then `out` is of no use. */
uint32_t boxtree_near(const Boxtree *t, const Vec2 *pos, Box2 box, double bound2, uint32_t *out, uint32_t cap);

/* What points_rivals would leave of all points. */
uint32_t boxtree_rivals(const Boxtree *t, const Vec2 *pos, Box2 box, const Points *near, bool nearest_alone, Points *out, uint32_t cap);

void boxtree_sort(uint32_t *item, uint32_t n); /* ascending */

static inline bool box_meets(Box2 a, Box2 b) { return a.x0 <= b.x1 && b.x0 <= a.x1 && a.y0 <= b.y1 && b.y0 <= a.y1; }

#endif
