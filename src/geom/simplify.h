/* Fewer points on a polyline within a tolerance (Hong 2005, § 5.3). */
#ifndef GEOM_SIMPLIFY_H
#define GEOM_SIMPLIFY_H

#include "geom/vec.h"

/* The steps of § 5.3 on an open polyline: from a kept point the chord is stretched point by point for as long as every point between lies
 * nearer than `tolerance` to the line through the chord's ends (a chord whose ends coincide: to the point); the last point before
 * that fails is kept next. The first and the last point are always kept, and every point i with must[i] (NULL: none). Writes
 * indices of kept points, ascending, to keep[n] and returns how many. O(n · longest run). */
uint32_t simplify_polyline(const Vec2 *p, uint32_t n, double tolerance, const bool *must, uint32_t *keep);

#endif
