/* Closed curves: fewer points within a tolerance (Hong 2005, § 5.3), without ever crossing themselves. */
#ifndef GEOM_RING_H
#define GEOM_RING_H

#include "geom/polygon.h"

/* The polygon's vertices, n >= 3, that simplify_polyline keeps on the way from vertex 0 around and back to it, and so vertex 0 and every vertex i
 * with must[i] (NULL: none). Where edges of the result touch or cross, the vertex farthest from each of them on the way it cuts short
 * is put back, until none do; so it is simple when the polygon is. A tolerance of 0 keeps all. A triangle is the least. */
Polygon *ring_simplify(const Polygon *p, double tolerance, const bool *must);

double ring_length(const Polygon *p);

#endif
