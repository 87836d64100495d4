/* Powers and logarithms with pinned rounding: built from IEEE + − × ÷ √ alone, so that every compiler, C library and
 * machine gives the same bits, which libm does not promise. Relative error below 1e-14 over the range Venation
 * uses (positive arguments, exponents within ±1000). */
#ifndef GEOM_DMATH_H
#define GEOM_DMATH_H

/* Base-2 logarithm of x > 0; -inf at 0, NaN below. */
double dmath_log2(double x);

/* 2 to the power x; 0 below -1074, inf from 1024 on. */
double dmath_exp2(double x);

/* x to the power y for x >= 0. Exact for y = 1, 2, 3 and 1/2. */
double dmath_pow(double x, double y);

#endif
