/* A simple polygon with fast point tests. Vertices counter-clockwise, closed implicitly. */
#ifndef GEOM_POLYGON_H
#define GEOM_POLYGON_H

#include "geom/vec.h"

typedef struct Polygon Polygon;
struct Polygon {
    uint32_t n;
    Vec2 *v;
    Box2 box;
    double area; /* positive */
    /* private: horizontal slabs, each listing the edges that reach into it */
    uint32_t n_slabs;
    uint32_t *slab_start, *slab_edge;
    double slab_scale; /* slabs per unit of y */
    /* private: a coarse grid over the box; a cell is wholly inside, wholly outside, or the slabs must be asked */
    uint8_t *mask;
    Vec2 mask_corner, mask_scale;
};

/* Copies n >= 3 finite vertices; turns them counter-clockwise, the first one staying first. Never fails: whether it is
 * simple is the caller's to know (polygon_crossing). O(n) for outlines. */
Polygon *polygon_new(const Vec2 *v, uint32_t n);
void polygon_free(Polygon *p);

/* The same shape `by` times as large, from the origin; a new one. */
Polygon *polygon_scaled(const Polygon *p, double by);

/* Even-odd test, consistent on the boundary: of two polygons sharing an edge a point lies in exactly one.
 * One look-up away from the boundary, else a few edges. */
bool polygon_contains(const Polygon *p, Vec2 q);

/* Signed distance to the boundary, positive inside. O(n). */
double polygon_depth(const Polygon *p, Vec2 q);

/* The boundary point nearest to q (of several the one on the first edge); *edge, unless NULL, receives its edge. O(n). */
Vec2 polygon_nearest(const Polygon *p, Vec2 q, uint32_t *edge);

/* Finds two edges i < j (edge i runs from vertex i to the next) that touch or cross other than at a shared vertex.
 * O(n log n) expected. */
bool polygon_crossing(const Polygon *p, uint32_t *i, uint32_t *j);

/* Centroid of the area. */
Vec2 polygon_centroid(const Polygon *p);

#endif
