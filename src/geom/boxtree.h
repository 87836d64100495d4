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

static inline bool box_meets(Box2 a, Box2 b) { return a.x0 <= b.x1 && b.x0 <= a.x1 && a.y0 <= b.y1 && b.y0 <= a.y1; }

#endif
