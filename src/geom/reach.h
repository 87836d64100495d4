/* Which points of a blade can see each other: the test behind the sinus rule, by which a source does not pull a vein
 * across a deep sinus between two lobes. */
#ifndef GEOM_REACH_H
#define GEOM_REACH_H

#include "geom/polygon.h"

typedef struct Reach Reach;

/* Prepares the test for segments that may leave the polygon by `depth` >= 0, in the polygon's unit (leaf lengths). The
 * answers are those of a distance field: the exact signed distance at the nodes of a grid of 256 cells along the longer
 * side of the box, bilinear between. It is off by up to half a cell, 1/512 of the leaf or so, at corners. O(cells)
 * expected. */
Reach *reach_new(const Polygon *p, double depth);
void reach_free(Reach *r);

/* Whether the straight line from a to b stays in the polygon but for excursions no deeper than `depth`. a and b lie in
 * the polygon's box. The same whichever way round a and b are given. A few look-ups for most pairs. */
bool reach_sees(const Reach *r, Vec2 a, Vec2 b);

/* Whether the polygon is so nearly convex that all its points see each other: no notch is deeper than `depth` below the
 * side of the convex hull that spans it. Then there is no grid and reach_sees is always true. */
bool reach_is_trivial(const Reach *r);

#endif
