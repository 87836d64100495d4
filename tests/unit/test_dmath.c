/* The pinned powers and logarithms against the C library, and the cases that must be exact. */
#include <glib.h>
#include <math.h>

#include "geom/dmath.h"
#include "geom/random.h"

static double uniform(uint64_t i, double low, double high)
{
    double u[2];
    random_pair(5, 2000, 0, i, u);
    return low + u[0] * (high - low);
}

static void near(double got, double want, double relative)
{
    if (!(fabs(got - want) <= relative * fabs(want)))
        g_error("%.17g instead of %.17g: off by %g of it", got, want, fabs(got - want) / fabs(want));
}

/* Long double has 11 bits more: its rounding does not matter here. */
static void test_log2(void)
{
    for (uint64_t i = 0; i < 20000; i++) {
        double wide = exp2(uniform(i, -1022, 1023.9)),
               one = 1.0 + uniform(i, -0.5, 1) * exp2(uniform(i + 20000, -50, 0));
        near(dmath_log2(wide), (double)log2l((long double)wide), 1e-14);
        near(dmath_log2(one), (double)log2l((long double)one), 1e-14);
    }
    for (int e = -1074; e <= 1023; e++)
        g_assert_cmpfloat(dmath_log2(ldexp(1.0, e)), ==, e);
    near(dmath_log2(3e-320), (double)log2l(3e-320L), 1e-4); /* subnormal: few bits */
    g_assert_cmpfloat(dmath_log2(0.0), ==, -HUGE_VAL);
    g_assert_cmpfloat(dmath_log2(HUGE_VAL), ==, HUGE_VAL);
    g_assert_true(isnan(dmath_log2(-1.0)));
    g_assert_true(isnan(dmath_log2((double)NAN)));
}

static void test_exp2(void)
{
    for (uint64_t i = 0; i < 20000; i++) {
        double wide = uniform(i, -1021, 1023.99), small = uniform(i, -1, 1) * exp2(uniform(i + 20000, -60, 0));
        near(dmath_exp2(wide), (double)exp2l((long double)wide), 1e-14);
        near(dmath_exp2(small), (double)exp2l((long double)small), 1e-14);
    }
    for (int e = -1074; e <= 1023; e++)
        g_assert_cmpfloat(dmath_exp2(e), ==, ldexp(1.0, e));
    g_assert_cmpfloat(dmath_exp2(1024), ==, HUGE_VAL);
    g_assert_cmpfloat(dmath_exp2(HUGE_VAL), ==, HUGE_VAL);
    g_assert_cmpfloat(dmath_exp2(-1075), ==, 0.0);
    g_assert_cmpfloat(dmath_exp2(-HUGE_VAL), ==, 0.0);
    g_assert_true(isfinite(dmath_exp2(1023.9999999)));
    g_assert_true(isnan(dmath_exp2((double)NAN)));
}

static void test_pow(void)
{
    for (uint64_t i = 0; i < 40000; i++) {
        double x = exp2(uniform(i, -40, 40)), y = uniform(i + 40000, -20, 20);
        near(dmath_pow(x, y), (double)powl((long double)x, (long double)y), 1e-13);
        /* growth rates over many steps, and roots of flows, as the program uses it */
        double rate = 1.0 + uniform(i, -0.2, 0.2), steps = floor(uniform(i + 80000, 0, 1000));
        near(dmath_pow(rate, steps), (double)powl((long double)rate, (long double)steps), 1e-13);
        double flow = floor(uniform(i, 1, 1e6)), n = uniform(i + 120000, 0.5, 10);
        near(dmath_pow(flow, 1.0 / n), (double)powl((long double)flow, (long double)(1.0 / n)), 1e-14);
    }
}

static void test_pow_exact(void)
{
    for (uint64_t i = 0; i < 2000; i++) {
        double x = exp2(uniform(i, -100, 100));
        g_assert_cmpfloat(dmath_pow(x, 0.0), ==, 1.0);
        g_assert_cmpfloat(dmath_pow(x, 1.0), ==, x);
        g_assert_cmpfloat(dmath_pow(x, 2.0), ==, x * x);
        g_assert_cmpfloat(dmath_pow(x, 3.0), ==, x * x * x);
        g_assert_cmpfloat(dmath_pow(x, 0.5), ==, sqrt(x));
        g_assert_cmpfloat(dmath_pow(1.0, uniform(i, -1000, 1000)), ==, 1.0);
    }
    g_assert_cmpfloat(dmath_pow(0.0, 0.7), ==, 0.0);
    g_assert_cmpfloat(dmath_pow(0.0, -0.7), ==, HUGE_VAL);
    g_assert_cmpfloat(dmath_pow(0.0, 0.0), ==, 1.0);
    g_assert_cmpfloat(dmath_pow(8.0, 4.0), ==, 4096.0);
    g_assert_cmpfloat(dmath_pow(1e300, 2.5), ==, HUGE_VAL);
    g_assert_cmpfloat(dmath_pow(1e-300, 2.5), ==, 0.0);
    g_assert_true(isnan(dmath_pow(-1.0, 0.3)));
}

/* A few results to the last bit: what every compiler and machine must give. */
static void test_bits(void)
{
    static const struct {
        double x, y, want;
    } bits[] = {
        {1.02, 100, 0x1.cfa848313f2e1p+2},
        {0.96999999999999997, 250, 0x1.02868af8100bap-11},
        {7, 0.33333333333333331, 0x1.e9b5dba58189ep+0},
        {12345, 0.40000000000000002, 0x1.5a7c90d70a8dp+5},
        {2.5, -3.7000000000000002, 0x1.1410bb40d75d3p-5},
        {1.0000000000000001e-05, 0.90000000000000002, 0x1.09456549be1bap-15},
        {37, 0.45454545454545453, 0x1.4a5e655ec9fb2p+2},
        {1.0000001000000001, 900, 0x1.0005e6046ec3ep+0},
    };
    for (gsize i = 0; i < G_N_ELEMENTS(bits); i++)
        g_assert_cmpfloat(dmath_pow(bits[i].x, bits[i].y), ==, bits[i].want);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/dmath/log2", test_log2);
    g_test_add_func("/dmath/exp2", test_exp2);
    g_test_add_func("/dmath/pow", test_pow);
    g_test_add_func("/dmath/pow/exact", test_pow_exact);
    g_test_add_func("/dmath/bits", test_bits);
    return g_test_run();
}
