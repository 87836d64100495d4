/* One cubic Bézier curve along a run of points p[0 … n-1], from the first to the last. */
#ifndef GEOM_CUBICFIT_H
#define GEOM_CUBICFIT_H

#include "geom/vec.h"

/* q[0] and q[3] are the ends, q[1] and q[2] the control points; u in 0 … 1. */
Vec2 cubic_at(const Vec2 q[4], double u);

/* Moves the control points, or with `directions` only their distances from the ends, so that the mean of the squared distances of the
 * points from the curve, weighted by the length of polyline that each stands for, becomes least; starts from the control points given and
 * returns that mean. Distances from the ends stay between 1/50 of the polyline's length and all of it; with
 * `directions` no handle passes the other end, measured along the chord, so that the curve can't run back over itself. Levenberg's method
 * (with Marquardt's scale) on the distances along the curve's normals: to rounding in a few steps where the points lie on a cubic, unless
 * there is another one so near (some 3e-4 of its length) that it ends there; never worse than at the start. O(n) a step. */
double cubic_fit(Vec2 q[4], const Vec2 *p, uint32_t n, bool directions);

typedef struct {
    double largest;    /* distance of a point from the curve or of one of 63 places on the curve from the polyline */
    double mean;       /* distance of the points from the curve, weighted as above */
    uint32_t farthest; /* the point at the largest or nearest to that place; the first of several */
} CubicDeviation;

/* Distances from the curve are to its nearest place, found from 65 places by Newton's method. O(65 n). n >= 2. */
CubicDeviation cubic_deviation(const Vec2 q[4], const Vec2 *p, uint32_t n);

#endif
