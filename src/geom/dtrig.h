/* Angles with pinned rounding: built from IEEE + − × ÷ √ alone, like dmath.h, so that every compiler, C library and machine gives the
 * same bits. Angles are in radians. */
#ifndef GEOM_DTRIG_H
#define GEOM_DTRIG_H

#define DTRIG_PI 3.14159265358979323846
#define DTRIG_DEGREE (DTRIG_PI / 180.0)

/* Sine and cosine of x; absolute error below 1e-15 for |x| <= 1e6, NaN beyond that and for NaN. x = 0 gives exactly 0 and 1. */
void dtrig_sin_cos(double x, double *sine, double *cosine);
double dtrig_sin(double x);
double dtrig_cos(double x);

/* Angle of the point (x, y) seen from the origin, in [-π, π]; relative error below 1e-14 while the angle is a normal number. The origin,
 * signs of zero and infinities as for atan2 of the C library. */
double dtrig_atan2(double y, double x);

#endif
