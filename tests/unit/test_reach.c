/* The sight test against the true distance, sampled densely along the segment, away from the borderline. */
#include <glib.h>

#include "geom/random.h"
#include "geom/reach.h"

/* The least signed distance along ab, by dense sampling. */
static double lowest(const Polygon *p, Vec2 a, Vec2 b)
{
    double least = HUGE_VAL;
    for (int k = 0; k <= 400; k++) {
        double d = polygon_depth(p, vec_lerp(a, b, k / 400.0));
        least = d < least ? d : least;
    }
    return least;
}

static Vec2 point_inside(const Polygon *p, uint32_t stream, uint64_t *index)
{
    for (;;) {
        double u[2];
        random_pair(1, stream, 0, (*index)++, u);
        Vec2 q = vec2(p->box.x0 + u[0] * (p->box.x1 - p->box.x0), p->box.y0 + u[1] * (p->box.y1 - p->box.y0));
        if (polygon_contains(p, q))
            return q;
    }
}

static void check_shape(const Vec2 *v, uint32_t n, double depth, uint32_t pairs)
{
    Polygon *p = polygon_new(v, n);
    Reach *r = reach_new(p, depth);
    g_assert_false(reach_is_trivial(r));
    double w = p->box.x1 - p->box.x0, h = p->box.y1 - p->box.y0, doubt = 0.75 * MAX(w, h) / 256.0;
    uint32_t seen = 0, hidden = 0;
    uint64_t index = 0;
    for (uint32_t k = 0; k < pairs; k++) {
        Vec2 a = point_inside(p, n, &index), b = point_inside(p, n, &index);
        double least = lowest(p, a, b);
        bool sees = reach_sees(r, a, b);
        g_assert_cmpint(sees, ==, reach_sees(r, b, a));
        if (fabs(least + depth) < doubt)
            continue;
        if (sees != (least > -depth))
            g_test_message("%g,%g to %g,%g: lowest %g", a.x, a.y, b.x, b.y, least);
        g_assert_cmpint(sees, ==, least > -depth);
        *(sees ? &seen : &hidden) += 1;
    }
    g_assert_cmpuint(seen, >, pairs / 20);
    g_assert_cmpuint(hidden, >, pairs / 20);
    reach_free(r);
    polygon_free(p);
}

static void test_u(void)
{
    const Vec2 u[8] = {{-0.5, 0}, {0.5, 0}, {0.5, 1}, {0.3, 1}, {0.3, 0.2}, {-0.3, 0.2}, {-0.3, 1}, {-0.5, 1}};
    check_shape(u, 8, 0.02, 1500);
    check_shape(u, 8, 0.1, 1500);
    check_shape(u, 8, 0.0, 1500);
}

/* A star of ten points, five out and five in, on the unit circle's regular decagon. */
static void test_star(void)
{
    static const Vec2 decagon[10] = {{1, 0},
                                     {0.80901699437494745, 0.58778525229247314},
                                     {0.30901699437494745, 0.95105651629515353},
                                     {-0.30901699437494745, 0.95105651629515353},
                                     {-0.80901699437494745, 0.58778525229247314},
                                     {-1, 0},
                                     {-0.80901699437494745, -0.58778525229247314},
                                     {-0.30901699437494745, -0.95105651629515353},
                                     {0.30901699437494745, -0.95105651629515353},
                                     {0.80901699437494745, -0.58778525229247314}};
    Vec2 v[10];
    for (int i = 0; i < 10; i++)
        v[i] = vec_scale(decagon[i], i % 2 ? 0.4 : 1.0);
    check_shape(v, 10, 0.02, 1500);
}

/* An oak-like leaf: lobes along both sides with rounded outlines of many vertices. */
static void test_lobed(void)
{
    enum { N = 300 };
    Vec2 v[2 * N];
    for (int i = 0; i < N; i++) {
        double y = (i + 0.5) / N, lobe = 4.0 * y - floor(4.0 * y);
        double half = 4.0 * y * (1.0 - y) * (0.08 + 1.1 * lobe * (1.0 - lobe));
        v[i] = vec2(half, y);
        v[2 * N - 1 - i] = vec2(-half, y);
    }
    check_shape(v, 2 * N, 0.02, 1500);
    check_shape(v, 2 * N, 0.005, 1500);
}

static void test_trivial(void)
{
    const Vec2 square[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, notched[5] = {{0, 0}, {1, 0}, {1, 1}, {0.5, 0.9}, {0, 1}};
    /* A thin crescent: nowhere far from its hull's boundary, yet its horns are hidden from each other. */
    const Vec2 crescent[6] = {{-1, 1}, {-0.6, 0.2}, {0, 0}, {0.6, 0.2}, {1, 1}, {0, 0.01}};
    const struct {
        const Vec2 *v;
        uint32_t n;
        double depth;
        bool trivial;
    } cases[] = {{square, 4, 0.0, true},    {notched, 5, 0.05, false}, {notched, 5, 0.099, false},
                 {notched, 5, 0.101, true}, {crescent, 6, 0.3, false}, {crescent, 6, 10.0, true}};
    for (uint32_t k = 0; k < G_N_ELEMENTS(cases); k++) {
        Polygon *p = polygon_new(cases[k].v, cases[k].n);
        Reach *r = reach_new(p, cases[k].depth);
        g_assert_cmpint(reach_is_trivial(r), ==, cases[k].trivial);
        if (cases[k].trivial)
            g_assert_true(reach_sees(r, cases[k].v[2], cases[k].v[cases[k].n - 1]));
        reach_free(r);
        polygon_free(p);
    }
    reach_free(NULL);
}

/* Where every notch is shallow no segment between inside points can leave by more: the claim behind the short cut. */
static void test_trivial_is_sound(void)
{
    uint32_t trivial = 0;
    for (uint32_t k = 0; k < 40; k++) {
        Vec2 v[40];
        for (uint32_t i = 0; i < 40; i++) {
            double t = i / 10.0, s = t - floor(t), u[2];
            random_pair(2, 3, k, i, u);
            const Vec2 diamond[4] = {{1 - s, s}, {-s, 1 - s}, {s - 1, -s}, {s, s - 1}};
            v[i] = vec_scale(diamond[(int)t], 1.0 - 0.1 * u[0]);
        }
        Polygon *p = polygon_new(v, 40);
        double depth = 0.03 + 0.002 * k;
        Reach *r = reach_new(p, depth);
        uint64_t index = 0;
        for (uint32_t i = 0; reach_is_trivial(r) && i < 50; i++) {
            Vec2 a = point_inside(p, k, &index), b = point_inside(p, k, &index);
            g_assert_cmpfloat(lowest(p, a, b), >=, -depth);
        }
        trivial += reach_is_trivial(r);
        reach_free(r);
        polygon_free(p);
    }
    g_assert_cmpuint(trivial, >, 5);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/reach/u", test_u);
    g_test_add_func("/reach/star", test_star);
    g_test_add_func("/reach/lobed", test_lobed);
    g_test_add_func("/reach/trivial", test_trivial);
    g_test_add_func("/reach/trivial-is-sound", test_trivial_is_sound);
    return g_test_run();
}
