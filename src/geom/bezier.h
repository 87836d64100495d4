/* Cubic Bézier curves, and what is turned into them: lines, quadratic curves, elliptical arcs. */
#ifndef GEOM_BEZIER_H
#define GEOM_BEZIER_H

#include <glib.h>

#include "geom/vec.h"

/* p[0] and p[3] are the ends, p[1] and p[2] the control points (on the line's thirds when `line`). */
typedef struct {
    Vec2 p[4];
    bool line;
} Curve;

Curve curve_line(Vec2 a, Vec2 b);
Curve curve_quadratic(Vec2 a, Vec2 control, Vec2 b);

/* Appends to `curves` the arc of an SVG path from a to b: radii rx and ry, the first turned by `degrees` from the x
 * axis; the longer way when `large`; from x towards y when `sweep`. Each piece spans less than 24°, off the true
 * ellipse by below 1e-7 of its radius. Radii that are too small are enlarged and a radius of 0 gives a line, as
 * SVG 1.1, F.6 asks. */
void curve_arc(GArray *curves, Vec2 a, Vec2 b, double rx, double ry, double degrees, bool large, bool sweep);

/* Appends to `points` (of Vec2) the corners of a chain of chords nowhere farther than `flatness` from the curve,
 * without its first point and with its last. A curve run backwards gives the same chain backwards. */
void curve_flatten(const Curve *curve, double flatness, GArray *points);

/* Sine and cosine with + − × ÷ alone, to about 1e-16; exact at multiples of 90°. Angles beyond 1e12 have no meaning
 * left and count as 0. */
void degrees_sincos(double degrees, double *sine, double *cosine);

#endif
