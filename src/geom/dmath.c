#include "geom/dmath.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

static const double ln2 = 0.693147180559945309417;

/* ldexp for normal results, by building the exponent: exact and free of libm. */
static double scale2(double x, int e)
{
    while (e > 1000) {
        x *= 0x1p1000;
        e -= 1000;
    }
    while (e < -1000) {
        x *= 0x1p-1000;
        e += 1000;
    }
    uint64_t bits = (uint64_t)(e + 1023) << 52;
    double f;
    memcpy(&f, &bits, sizeof f);
    return x * f;
}

double dmath_log2(double x)
{
    if (!(x > 0.0))
        return x == 0.0 ? -HUGE_VAL : (double)NAN;
    if (!(x < HUGE_VAL))
        return HUGE_VAL;
    int e = 0;
    if (x < 0x1p-1000) {
        x *= 0x1p200;
        e = -200;
    }
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    e += (int)(bits >> 52) - 1023;
    bits = (bits & 0x000FFFFFFFFFFFFFu) | 0x3FF0000000000000u;
    double m;
    memcpy(&m, &bits, sizeof m);
    if (m > 1.4142135623730951) {
        m *= 0.5;
        e++;
    }
    /* ln m = 2 artanh(z), z = (m-1)/(m+1), |z| < 0.1716: the odd series to z^23 is below 1e-17. */
    double z = (m - 1.0) / (m + 1.0), z2 = z * z, s = 0.0;
    for (int k = 23; k >= 1; k -= 2)
        s = s * z2 + 1.0 / (double)k;
    return (double)e + 2.0 * z * s / ln2;
}

double dmath_exp2(double x)
{
    if (x != x)
        return x;
    if (x >= 1024.0)
        return HUGE_VAL;
    if (x < -1074.0)
        return 0.0;
    double n = floor(x + 0.5);
    double r = (x - n) * ln2, s = 1.0; /* |r| < 0.347: the Taylor series to r^17 is below 1e-17 */
    for (int k = 17; k >= 1; k--)
        s = 1.0 + s * r / (double)k;
    return scale2(s, (int)n);
}

double dmath_pow(double x, double y)
{
    if (y == 0.0)
        return 1.0;
    if (y == 1.0)
        return x;
    if (y == 2.0)
        return x * x;
    if (y == 3.0)
        return x * x * x;
    if (y == 0.5)
        return sqrt(x);
    if (x == 0.0)
        return y > 0.0 ? 0.0 : HUGE_VAL;
    return dmath_exp2(y * dmath_log2(x));
}
