/* Simplification against the steps of Hong 2005, § 5.3 written out plainly, and against lines whose answers are known. */
#include <glib.h>

#include "geom/random.h"
#include "geom/segment.h"
#include "geom/simplify.h"

static double uniform(uint32_t stream, uint64_t index)
{
    double u[2];
    random_pair(5, stream, 0, index, u);
    return u[0];
}

static double distance_to_line(Vec2 a, Vec2 b, Vec2 q)
{
    double length = vec_dist(a, b);
    return length > 0.0 ? fabs(vec_cross(vec_sub(b, a), vec_sub(q, a))) / length : vec_dist(a, q);
}

/* The steps of § 5.3, every distance measured every time. */
static uint32_t plain(const Vec2 *p, uint32_t n, double tolerance, const bool *must, uint32_t *keep)
{
    uint32_t kept = 0, i = 0;
    keep[kept++] = 0;
    for (uint32_t j = 1; j < n; j++) {
        double most = -1.0;
        bool passed = false;
        for (uint32_t k = i + 1; k < j; k++) {
            double d = distance_to_line(p[i], p[j], p[k]);
            most = d > most ? d : most;
            passed |= must && must[k];
        }
        if (j > i + 1 && (passed || !(most < tolerance))) {
            keep[kept++] = i = j - 1;
        }
    }
    if (n > 1)
        keep[kept++] = n - 1;
    return kept;
}

static void compare(const Vec2 *p, uint32_t n, double tolerance, const bool *must)
{
    uint32_t *got = g_new(uint32_t, n), *want = g_new(uint32_t, n);
    uint32_t n_got = simplify_polyline(p, n, tolerance, must, got), n_want = plain(p, n, tolerance, must, want);
    g_assert_cmpuint(n_got, ==, n_want);
    for (uint32_t k = 0; k < n_got; k++)
        g_assert_cmpuint(got[k], ==, want[k]);
    for (uint32_t k = 0; k + 1 < n_got; k++)
        for (uint32_t i = got[k] + 1; i < got[k + 1]; i++) {
            g_assert_cmpfloat(distance_to_line(p[got[k]], p[got[k + 1]], p[i]), <=, tolerance * (1.0 + 1e-12));
            g_assert_false(must && must[i]);
        }
    g_free(got);
    g_free(want);
}

/* Walks that wander, turn round, jump and stand still. */
static void test_twin(void)
{
    enum { N = 400 };
    Vec2 p[N];
    bool must[N];
    for (uint32_t run = 0; run < 300; run++) {
        Vec2 at = vec2(10.0 * uniform(1, run), 0.0), way = vec2(1.0, 0.0);
        double wild = run % 3 == 0 ? 0.1 : run % 3 == 1 ? 0.6 : 2.0;
        for (uint32_t i = 0; i < N; i++) {
            uint64_t r = (uint64_t)run * N + i;
            p[i] = at;
            must[i] = uniform(2, r) < 0.02;
            way = vec_add(way, vec_scale(vec2(uniform(3, r) - 0.5, uniform(4, r) - 0.5), wild));
            way = vec_scale(way, 1.0 / (0.1 + sqrt(vec_norm2(way))));
            if (run % 5 == 0 && uniform(6, r) < 0.05)
                way = vec_scale(way, -1.0);
            if (!(run % 7 == 0 && uniform(7, r) < 0.1))
                at = vec_add(at, way);
        }
        const double tolerance[] = {0.0, 0.01, 0.3, 1.0, 4.0, 50.0, 1e4};
        for (uint32_t k = 0; k < G_N_ELEMENTS(tolerance); k++) {
            compare(p, N, tolerance[k], NULL);
            compare(p, N, tolerance[k], must);
        }
    }
}

static void test_straight(void)
{
    enum { N = 1000 };
    Vec2 p[N];
    bool must[N] = {false};
    uint32_t keep[N];
    for (int i = 0; i < N; i++)
        p[i] = vec2(3.0 * i, 4.0 * i);
    g_assert_cmpuint(simplify_polyline(p, N, 0.5, NULL, keep), ==, 2);
    g_assert_cmpuint(keep[1], ==, N - 1);
    g_assert_cmpuint(simplify_polyline(p, N, 0.0, NULL, keep), ==, N); /* nothing is nearer than nothing */
    must[17] = must[18] = must[998] = true;
    const uint32_t want[] = {0, 17, 18, 998, 999};
    g_assert_cmpuint(simplify_polyline(p, N, 0.5, must, keep), ==, 5);
    for (int k = 0; k < 5; k++)
        g_assert_cmpuint(keep[k], ==, want[k]);
}

/* A saw of height 1 and pitch 2: below a tolerance that just takes the teeth in everything stays, above it two points are left. */
static void test_saw(void)
{
    enum { N = 101 };
    Vec2 p[N];
    uint32_t keep[N];
    for (int i = 0; i < N; i++)
        p[i] = vec2(i, i % 2);
    g_assert_cmpuint(simplify_polyline(p, N, 1.0 + 1e-9, NULL, keep), ==, 2);
    g_assert_cmpuint(simplify_polyline(p, N, 0.7, NULL, keep), ==, N); /* over two points: 1/√2 from the line to the third */
}

/* On a circle of radius r a chord's sagitta s is r(1 - cos(a/2)): chords of the tolerance's angle, so about 2π/(2√(2s/r)) points. */
static void test_circle(void)
{
    enum { N = 7201 };
    Vec2 *p = g_new(Vec2, N);
    uint32_t *keep = g_new(uint32_t, N);
    const double c = 0.99999961922824, s = 0.00087266451523515; /* a twentieth of a degree */
    p[0] = vec2(100.0, 0.0);
    for (int i = 1; i < N; i++)
        p[i] = vec2(c * p[i - 1].x - s * p[i - 1].y, s * p[i - 1].x + c * p[i - 1].y);
    for (double tolerance = 0.01; tolerance < 3.0; tolerance *= 2.0) {
        double want = G_PI / sqrt(2.0 * tolerance / 100.0);
        uint32_t n = simplify_polyline(p, N, tolerance, NULL, keep);
        g_assert_cmpfloat(n, >, 0.97 * want);
        g_assert_cmpfloat(n, <, 1.06 * want + 2.0);
    }
    g_free(p);
    g_free(keep);
}

static void test_small(void)
{
    const Vec2 p[4] = {{1, 1}, {1, 1}, {5, 5}, {1, 1}};
    const bool must[4] = {true, true, true, true};
    uint32_t keep[4] = {9, 9, 9, 9};
    g_assert_cmpuint(simplify_polyline(p, 0, 1.0, NULL, keep), ==, 0);
    g_assert_cmpuint(keep[0], ==, 9);
    g_assert_cmpuint(simplify_polyline(p, 1, 1.0, must, keep), ==, 1);
    g_assert_cmpuint(simplify_polyline(p, 2, 1.0, NULL, keep), ==, 2);
    g_assert_cmpuint(keep[1], ==, 1);
    g_assert_cmpuint(simplify_polyline(p, 4, 1.0, NULL, keep), ==, 3); /* 5, 5 is 5.66 from the point where the chord begins and ends */
    g_assert_cmpuint(simplify_polyline(p, 4, 6.0, NULL, keep), ==, 2);
    g_assert_cmpuint(simplify_polyline(p, 4, 6.0, must, keep), ==, 4);
    const Vec2 bad[4] = {{0, 0}, {1, 0}, {NAN, 0}, {2, 0}};
    g_assert_cmpuint(simplify_polyline(bad, 4, 6.0, NULL, keep), ==, 4); /* what can't be compared is kept */
}

/* A smooth line of 300 000 points within one tolerance: the plain steps would take 4e10 distances. */
static void test_long(void)
{
    const uint32_t n = 300000;
    Vec2 *p = g_new(Vec2, n);
    uint32_t *keep = g_new(uint32_t, n);
    for (uint32_t i = 0; i < n; i++)
        p[i] = vec2(i, 0.5 * uniform(9, i));
    gint64 start = g_get_monotonic_time();
    g_assert_cmpuint(simplify_polyline(p, n, 2.0, NULL, keep), ==, 2);
    g_assert_cmpint(g_get_monotonic_time() - start, <, 10 * G_USEC_PER_SEC);
    g_free(p);
    g_free(keep);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/simplify/twin", test_twin);
    g_test_add_func("/simplify/straight", test_straight);
    g_test_add_func("/simplify/saw", test_saw);
    g_test_add_func("/simplify/circle", test_circle);
    g_test_add_func("/simplify/small", test_small);
    g_test_add_func("/simplify/long", test_long);
    return g_test_run();
}
