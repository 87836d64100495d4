/* A binary tree of tight bounding boxes over a set of points that is known at once: this step's new vein nodes. */
#ifndef GEOM_BOXTREE_H
#define GEOM_BOXTREE_H

#include "geom/vec.h"

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

/* Points that may be the nearest one to some place in the box and are nearer to it than sqrt(bound2), and some more. Returns how many; more
 * than `cap` when they did not fit, and then `out` is of no use. */
uint32_t boxtree_near(const Boxtree *t, const Vec2 *pos, Box2 box, double bound2, uint32_t *out, uint32_t cap);

/* Leaves out those of up to POINTS_MOST points that can't be the nearest one to any place in the box or are not nearer to it than
 * sqrt(bound2); the others stay in order. `out` may be `item`. O(n). */
enum { POINTS_MOST = 256 };
uint32_t points_nearest_to(const Vec2 *pos, const uint32_t *item, uint32_t n, Box2 box, double bound2, uint32_t *out);

/* With points near[0 … n_near-1], n_near > 0, the nearest one to any place in the box among them: all points but such as the nearest one,
 * or (unless nearest_alone) another, excludes from the relative neighbourhood of any place in the box (neighbours.h), and some more. Returns
 * how many; more than `cap` when they did not fit. */
uint32_t boxtree_rivals(const Boxtree *t, const Vec2 *pos, Box2 box, const uint32_t *near, uint32_t n_near, bool nearest_alone, uint32_t *out,
                        uint32_t cap);
/* The same of n points; `out` may be `item`. */
uint32_t points_rivals(const Vec2 *pos, const uint32_t *item, uint32_t n, Box2 box, const uint32_t *near, uint32_t n_near, bool nearest_alone,
                       uint32_t *out);

static inline bool box_meets(Box2 a, Box2 b) { return a.x0 <= b.x1 && b.x0 <= a.x1 && a.y0 <= b.y1 && b.y0 <= a.y1; }

#endif
