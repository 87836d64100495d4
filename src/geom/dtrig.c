#include "geom/dtrig.h"

#include <math.h>
#include <stdint.h>

enum { SIN_TERMS = 8, COS_TERMS = 8, ATAN_TERMS = 12 };

/* π/2 in three parts. The first two have 33 bits, so that their products with whole numbers below 2^20 are exact. */
static const double half_pi_1 = 0x1.921fb544p+0, half_pi_2 = 0x1.0b4611a6p-34, half_pi_3 = 0x1.3198a2e037073p-69;
static const double two_over_pi = 0x1.45f306dc9c883p-1;
static const double largest = 1e6;

/* Taylor series for |r| <= π/4, where the first term left out is below 1e-19. */
static double sin_near_0(double r)
{
    double z = r * r, s = 0.0;
    for (int k = SIN_TERMS; k >= 1; k--)
        s = -(1.0 + s) * z / (double)(2 * k * (2 * k + 1));
    return r + r * s;
}

static double cos_near_0(double r)
{
    double z = r * r, s = 0.0;
    for (int k = COS_TERMS; k >= 2; k--)
        s = -(1.0 + s) * z / (double)(2 * k * (2 * k - 1));
    return 1.0 - 0.5 * z * (1.0 + s);
}

void dtrig_sin_cos(double x, double *sine, double *cosine)
{
    if (!(x >= -largest && x <= largest)) {
        *sine = *cosine = (double)NAN;
        return;
    }
    double n = floor(x * two_over_pi + 0.5);
    double r = ((x - n * half_pi_1) - n * half_pi_2) - n * half_pi_3;
    double s = sin_near_0(r), c = cos_near_0(r);
    switch ((int64_t)n & 3) {
    case 0:
        *sine = s;
        *cosine = c;
        break;
    case 1:
        *sine = c;
        *cosine = -s;
        break;
    case 2:
        *sine = -s;
        *cosine = -c;
        break;
    default:
        *sine = -c;
        *cosine = s;
    }
}

double dtrig_sin(double x)
{
    double s, c;
    dtrig_sin_cos(x, &s, &c);
    return s;
}

double dtrig_cos(double x)
{
    double s, c;
    dtrig_sin_cos(x, &s, &c);
    return c;
}

/* Arc tangent of t in 0 … 1: π/4 is taken off a large one, then the angle is halved, so that |u| < 0.2, where the first term left out is
 * below 1e-19. */
static double atan_to_1(double t)
{
    double start = 0.0;
    if (t > 0.41421356237309503) { /* tan π/8 */
        start = 0.25 * DTRIG_PI;
        t = (t - 1.0) / (t + 1.0);
    }
    double u = t / (1.0 + sqrt(1.0 + t * t)), z = u * u, s = 0.0;
    for (int k = ATAN_TERMS; k >= 1; k--)
        s = z * (1.0 / (double)(2 * k + 1) - s);
    return start + 2.0 * (u - u * s);
}

double dtrig_atan2(double y, double x)
{
    if (x != x || y != y)
        return (double)NAN;
    double ax = fabs(x), ay = fabs(y), a;
    if (ax == ay)
        a = ax > 0.0 ? 0.25 * DTRIG_PI : 0.0;
    else
        a = ay < ax ? atan_to_1(ay / ax) : 0.5 * DTRIG_PI - atan_to_1(ax / ay);
    if (signbit(x))
        a = DTRIG_PI - a;
    return copysign(a, y);
}
