/* The pinned sines, cosines and arc tangents against the C library's long doubles, and the cases that must be exact. */
#include <glib.h>
#include <math.h>

#include "geom/dtrig.h"
#include "geom/random.h"

static double uniform(uint64_t i, double low, double high)
{
    double u[2];
    random_pair(6, 2001, 0, i, u);
    return low + u[0] * (high - low);
}

static void near(double got, long double want, double tolerance)
{
    if (!(fabsl((long double)got - want) <= (long double)tolerance))
        g_error("%.17g instead of %.17Lg: off by %Lg", got, want, fabsl((long double)got - want));
}

static void check_angle(double x)
{
    double s, c;
    dtrig_sin_cos(x, &s, &c);
    near(s, sinl((long double)x), 2.5e-16);
    near(c, cosl((long double)x), 2.5e-16);
    near(s * s + c * c, 1.0L, 5e-16);
    g_assert_cmpfloat(s, ==, dtrig_sin(x));
    g_assert_cmpfloat(c, ==, dtrig_cos(x));
}

static void test_sin_cos(void)
{
    for (uint64_t i = 0; i < 40000; i++) {
        check_angle(uniform(i, -4, 4));
        check_angle(uniform(i, -1e6, 1e6));
        check_angle(uniform(i, -1, 1) * exp2(uniform(i + 40000, -60, 0)));
    }
    for (int n = -20000; n <= 20000; n++) /* about multiples of π/4, where octants change */
        for (int k = -1; k <= 1; k++)
            check_angle((double)n * (DTRIG_PI / 4) + k * 1e-9);
    check_angle(1e6);
    check_angle(-1e6);
}

/* Small angles keep their digits: the relative error stays small too. */
static void test_small(void)
{
    for (uint64_t i = 0; i < 20000; i++) {
        double x = uniform(i, 0.5, 1) * exp2(uniform(i + 40000, -300, -1));
        near(dtrig_sin(x) / x, sinl((long double)x) / (long double)x, 5e-16);
        near(dtrig_atan2(x, 1) / x, atanl((long double)x) / (long double)x, 1e-15);
    }
}

static void test_exact(void)
{
    double s, c;
    dtrig_sin_cos(0.0, &s, &c);
    g_assert_true(s == 0.0 && c == 1.0);
    dtrig_sin_cos(-0.0, &s, &c);
    g_assert_true(s == 0.0 && c == 1.0);
    for (uint64_t i = 0; i < 1000; i++) {
        double x = uniform(i, 0, 100);
        g_assert_cmpfloat(dtrig_sin(-x), ==, -dtrig_sin(x));
        g_assert_cmpfloat(dtrig_cos(-x), ==, dtrig_cos(x));
    }
    const double bad[] = {(double)NAN, HUGE_VAL, -HUGE_VAL, 1.0000001e6, -2e6, 1e300};
    for (gsize i = 0; i < G_N_ELEMENTS(bad); i++) {
        dtrig_sin_cos(bad[i], &s, &c);
        g_assert_true(isnan(s) && isnan(c));
    }
}

static void test_atan2(void)
{
    for (uint64_t i = 0; i < 60000; i++) {
        double a = uniform(i, -4, 4), r = exp2(uniform(i + 60000, -100, 100)), x = r * cos(a), y = r * sin(a);
        long double want = atan2l((long double)y, (long double)x);
        near(dtrig_atan2(y, x), want, 1e-15 * fabs((double)want));
    }
    const double odd[] = {0.0, -0.0, 1.0, -1.0, HUGE_VAL, -HUGE_VAL, 0x1p-1074, -0x1p-1074, 1e308};
    for (gsize i = 0; i < G_N_ELEMENTS(odd); i++)
        for (gsize j = 0; j < G_N_ELEMENTS(odd); j++) {
            double got = dtrig_atan2(odd[i], odd[j]), want = atan2(odd[i], odd[j]);
            if (odd[i] == 0.0 && odd[j] == 0.0)
                want = signbit(odd[j]) ? copysign(DTRIG_PI, odd[i]) : odd[i];
            near(got, (long double)want, 1e-15 * fabs(want) + 0x1p-1074);
            g_assert_cmpint(signbit(got) != 0, ==, signbit(want) != 0);
        }
    g_assert_true(isnan(dtrig_atan2((double)NAN, 1.0)) && isnan(dtrig_atan2(1.0, (double)NAN)));
    g_assert_cmpfloat(dtrig_atan2(1, 1), ==, DTRIG_PI / 4);
    g_assert_cmpfloat(dtrig_atan2(1, 0), ==, DTRIG_PI / 2);
    g_assert_cmpfloat(dtrig_atan2(0, -1), ==, DTRIG_PI);
}

/* A few results to the last bit: what every compiler and machine must give. */
static void test_bits(void)
{
    static const struct {
        double x, sine, cosine, angle;
    } bits[] = {
        {0.10000000000000001, 0x1.98eaecb8bcb2cp-4, 0x1.fd712f9a817cp-1, 0x1.0f772d81fdc0cp-3},
        {-0.69999999999999996, -0x1.49d6e694619b8p-1, 0x1.87996529f9d93p-1, -0x1.8079c6293aedfp-1},
        {1.3, 0x1.ed577f9c51e4bp-1, 0x1.11eb3682a4c5fp-2, 0x1.0c2a23d3ff989p+0},
        {2.2000000000000002, 0x1.9df33d9aad708p-1, -0x1.2d5004b88ad7p-1, 0x1.3e03a5c1bed3ap+0},
        {-3, -0x1.210386db6d55bp-3, -0x1.fae04be85e5d2p-1, -0x1.5368c951e9cfcp+0},
        {17.5, -0x1.f385407539c8p-1, 0x1.c169bd4b6de5dp-3, 0x1.8728bd75310fdp+0},
        {1234.5678, 0x1.3fa00084ee3ddp-4, -0x1.fe7053dc31387p-1, 0x1.91f7e51bbc57dp+0},
        {-99999.25, -0x1.6a2b190117259p-1, -0x1.69e8b0c33e556p-1, -0x1.921f376fc3c32p+0},
    };
    for (gsize i = 0; i < G_N_ELEMENTS(bits); i++) {
        g_assert_cmpfloat(dtrig_sin(bits[i].x), ==, bits[i].sine);
        g_assert_cmpfloat(dtrig_cos(bits[i].x), ==, bits[i].cosine);
        g_assert_cmpfloat(dtrig_atan2(bits[i].x, 0.75), ==, bits[i].angle);
    }
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/dtrig/sin-cos", test_sin_cos);
    g_test_add_func("/dtrig/small", test_small);
    g_test_add_func("/dtrig/exact", test_exact);
    g_test_add_func("/dtrig/atan2", test_atan2);
    g_test_add_func("/dtrig/bits", test_bits);
    return g_test_run();
}
