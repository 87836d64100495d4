/* Polygons against brute force and against shapes whose answers are known. */
#include <glib.h>

#include "geom/polygon.h"
#include "geom/random.h"

static double uniform(uint32_t stream, uint64_t index)
{
    double u[2];
    random_pair(7, stream, 0, index, u);
    return u[0];
}

/* A star-shaped, hence simple, polygon of n vertices about (0.3, -0.2): the square's boundary walked at even steps,
 * with random radii. */
static Polygon *random_star(uint32_t n, uint32_t stream, double least)
{
    Vec2 *v = g_new(Vec2, n);
    for (uint32_t i = 0; i < n; i++) {
        double t = 4.0 * i / n, s = t - floor(t), r = least + (1.0 - least) * uniform(stream, i);
        const Vec2 square[4] = {{1, 2 * s - 1}, {1 - 2 * s, 1}, {-1, 1 - 2 * s}, {2 * s - 1, -1}};
        v[i] = vec_add(vec2(0.3, -0.2), vec_scale(square[(int)t], r));
    }
    Polygon *p = polygon_new(v, n);
    g_free(v);
    return p;
}

/* Winding number by signed crossings of the ray to the right (D. Sunday), nothing shared with the code under test. */
static bool winds(const Polygon *p, Vec2 q)
{
    int winding = 0;
    for (uint32_t i = 0; i < p->n; i++) {
        Vec2 a = p->v[i], b = p->v[(i + 1) % p->n];
        double left = (b.x - a.x) * (q.y - a.y) - (q.x - a.x) * (b.y - a.y);
        if (a.y <= q.y && b.y > q.y && left > 0.0)
            winding++;
        if (a.y > q.y && b.y <= q.y && left < 0.0)
            winding--;
    }
    return winding != 0;
}

static void test_contains_winding(void)
{
    const uint32_t sizes[] = {3, 4, 7, 50, 333, 5000};
    for (uint32_t k = 0; k < G_N_ELEMENTS(sizes); k++) {
        Polygon *p = random_star(sizes[k], 100 + k, 0.2);
        for (uint32_t i = 0; i < 4000; i++) {
            double u[2];
            random_pair(11, k, 1, i, u);
            Vec2 q = vec2(-1.0 + 2.6 * u[0], -1.5 + 2.6 * u[1]);
            g_assert_cmpint(polygon_contains(p, q), ==, winds(p, q));
        }
        polygon_free(p);
    }
}

/* Cells of the grid and slabs must not show: points right at vertices and edges, and a hair beside them. */
static void test_contains_near_edges(void)
{
    Polygon *p = random_star(200, 120, 0.5);
    for (uint32_t i = 0; i < p->n; i++) {
        Vec2 a = p->v[i], b = p->v[(i + 1) % p->n], d = vec_sub(b, a);
        Vec2 inward = vec_scale(vec2(-d.y, d.x), 1.0 / sqrt(vec_norm2(d)));
        for (int e = 4; e <= 11; e++) {
            double hair = 1.0;
            for (int k = 0; k < e; k++)
                hair *= 0.1;
            Vec2 m = vec_lerp(a, b, 0.5);
            g_assert_true(polygon_contains(p, vec_add(m, vec_scale(inward, hair))));
            g_assert_false(polygon_contains(p, vec_add(m, vec_scale(inward, -hair))));
        }
    }
    polygon_free(p);
}

static void test_contains_disc(void)
{
    enum { N = 720 };
    Vec2 v[N] = {{1.0, 0.0}};
    const double c = 0.99996192306417131, s = 0.0087265354983739347; /* half a degree */
    for (int i = 1; i < N; i++)
        v[i] = vec2(c * v[i - 1].x - s * v[i - 1].y, s * v[i - 1].x + c * v[i - 1].y);
    Polygon *p = polygon_new(v, N);
    for (uint32_t i = 0; i < 20000; i++) {
        double u[2];
        random_pair(3, 1, 2, i, u);
        Vec2 q = vec2(2.2 * u[0] - 1.1, 2.2 * u[1] - 1.1);
        double r = sqrt(vec_norm2(q));
        if (fabs(r - 1.0) > 2e-5)
            g_assert_cmpint(polygon_contains(p, q), ==, r < 1.0);
        g_assert_cmpfloat_with_epsilon(polygon_depth(p, q), 1.0 - r, 2e-5);
    }
    g_assert_cmpfloat_with_epsilon(p->area, 3.14159265, 1e-4);
    polygon_free(p);
}

/* A square cut by a jagged line in two: each point, those on the cut and its vertices too, lies in exactly one part. */
static void test_shared_boundary(void)
{
    enum { CUT = 33 };
    Vec2 cut[CUT];
    for (int i = 0; i < CUT; i++)
        cut[i] = vec2(floor(16.0 * (0.3 + 0.4 * uniform(5, (uint64_t)i))) / 16.0 + (i % 3 == 0 ? 0.01 : 0.0),
                      i / (CUT - 1.0));
    Vec2 left[CUT + 2] = {{0, 0}}, right[CUT + 2];
    for (int i = 0; i < CUT; i++) {
        left[i + 1] = cut[i];
        right[i] = cut[CUT - 1 - i];
    }
    left[CUT + 1] = vec2(0, 1);
    right[CUT] = vec2(1, 0);
    right[CUT + 1] = vec2(1, 1);
    Polygon *a = polygon_new(left, CUT + 2), *b = polygon_new(right, CUT + 2);
    for (uint32_t i = 0; i < CUT - 1; i++) {
        for (uint32_t k = 0; k < 1000; k++) {
            double t = k < 3 ? 0.5 * k : uniform(6, k);
            Vec2 q = vec_lerp(cut[i], cut[i + 1], t);
            if (q.y < 1.0)
                g_assert_cmpint(polygon_contains(a, q) + polygon_contains(b, q), ==, 1);
        }
    }
    for (uint32_t k = 0; k < 10000; k++) {
        Vec2 q = vec2(floor(64.0 * uniform(8, k)) / 64.0, floor(64.0 * uniform(9, k)) / 64.0);
        g_assert_cmpint(polygon_contains(a, q) + polygon_contains(b, q), ==, 1);
    }
    polygon_free(a);
    polygon_free(b);
}

static void test_far_away_and_odd(void)
{
    const Vec2 square[4] = {{0, 0}, {0, 1}, {1, 1}, {1, 0}}; /* clockwise */
    Polygon *p = polygon_new(square, 4);
    g_assert_cmpfloat(p->area, ==, 1.0);
    g_assert_true(p->v[0].x == 0.0 && p->v[0].y == 0.0 && p->v[1].x == 1.0 && p->v[1].y == 0.0);
    g_assert_false(polygon_contains(p, vec2(NAN, 0.5)));
    g_assert_false(polygon_contains(p, vec2(0.5, NAN)));
    g_assert_false(polygon_contains(p, vec2(1e300, 0.5)));
    g_assert_false(polygon_contains(p, vec2(-INFINITY, INFINITY)));
    g_assert_true(polygon_contains(p, vec2(1e-12, 1.0 - 1e-12)));
    g_assert_cmpfloat(polygon_depth(p, vec2(0.25, 0.5)), ==, 0.25);
    g_assert_cmpfloat(polygon_depth(p, vec2(1.0 + 3.0, 1.0 + 4.0)), ==, -5.0);
    polygon_free(p);

    const Vec2 flat[4] = {{0, 0}, {1, 0}, {2, 0}, {3, 0}}, point[3] = {{0, 0}, {0, 0}, {0, 0}};
    p = polygon_new(flat, 4);
    g_assert_false(polygon_contains(p, vec2(0.5, 0.0)));
    polygon_free(p);
    p = polygon_new(point, 3);
    g_assert_false(polygon_contains(p, vec2(0.0, 0.0)));
    polygon_free(p);
    polygon_free(NULL);

    const Vec2 distant[4] = {{1e9, 1e9}, {1e9 + 1, 1e9}, {1e9 + 1, 1e9 + 1}, {1e9, 1e9 + 1}};
    p = polygon_new(distant, 4);
    g_assert_true(polygon_contains(p, vec2(1e9 + 0.5, 1e9 + 0.001)));
    g_assert_false(polygon_contains(p, vec2(1e9 + 0.5, 1e9 - 0.001)));
    polygon_free(p);
}

static void test_centroid(void)
{
    const Vec2 ell[6] = {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}}; /* 3x1 and 1x2 */
    Polygon *p = polygon_new(ell, 6);
    Vec2 c = polygon_centroid(p);
    g_assert_cmpfloat(p->area, ==, 5.0);
    g_assert_cmpfloat_with_epsilon(c.x, (3 * 1.5 + 2 * 0.5) / 5.0, 1e-14);
    g_assert_cmpfloat_with_epsilon(c.y, (3 * 0.5 + 2 * 2.0) / 5.0, 1e-14);
    polygon_free(p);
}

/* --- crossings, in whole numbers, where orientation is exact --- */

typedef struct {
    int64_t x, y;
} Whole;

static int turn(Whole a, Whole b, Whole c)
{
    int64_t k = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    return (k > 0) - (k < 0);
}

static bool on_segment(Whole a, Whole b, Whole c)
{
    return turn(a, b, c) == 0 && MIN(a.x, b.x) <= c.x && c.x <= MAX(a.x, b.x) && MIN(a.y, b.y) <= c.y &&
           c.y <= MAX(a.y, b.y);
}

static bool clash(const Whole *v, uint32_t n, uint32_t i, uint32_t j)
{
    Whole a = v[i], b = v[(i + 1) % n], c = v[j], d = v[(j + 1) % n];
    if ((i + 1) % n == j)
        return on_segment(a, b, d) || on_segment(c, d, a);
    if ((j + 1) % n == i)
        return on_segment(c, d, b) || on_segment(a, b, c);
    if (turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0)
        return true;
    return on_segment(a, b, c) || on_segment(a, b, d) || on_segment(c, d, a) || on_segment(c, d, b);
}

static void check_crossing(const Whole *v, uint32_t n, uint32_t *crossed)
{
    Vec2 *w = g_new(Vec2, n);
    for (uint32_t i = 0; i < n; i++)
        w[i] = vec2((double)v[i].x, (double)v[i].y);
    Polygon *p = polygon_new(w, n);
    Whole *turned = g_new(Whole, n); /* as polygon_new may have turned it */
    for (uint32_t i = 0; i < n; i++)
        turned[i] = (Whole){(int64_t)p->v[i].x, (int64_t)p->v[i].y};
    bool expected = false;
    for (uint32_t i = 0; i < n && !expected; i++)
        for (uint32_t j = i + 1; j < n && !expected; j++)
            expected = clash(turned, n, i, j);
    uint32_t i = 0, j = 0;
    g_assert_cmpint(polygon_crossing(p, &i, &j), ==, expected);
    if (expected) {
        g_assert_cmpuint(i, <, j);
        g_assert_cmpuint(j, <, n);
        g_assert_true(clash(turned, n, i, j));
    }
    *crossed += expected;
    g_free(turned);
    g_free(w);
    polygon_free(p);
}

static void test_crossing_random(void)
{
    uint32_t crossed = 0, tried = 0;
    for (uint32_t k = 0; k < 6000; k++, tried++) { /* few points on small and large grids: touching and not */
        Whole v[8];
        uint32_t n = 3 + k % 6;
        int64_t grid = k % 2 ? 6 : 1000;
        for (uint32_t i = 0; i < n; i++) {
            RandomBlock b = random_block(5, 20, k, i);
            v[i] = (Whole){b.w[0] % grid, b.w[1] % grid};
        }
        check_crossing(v, n, &crossed);
    }
    g_assert_cmpuint(crossed, >, tried / 10);
    g_assert_cmpuint(crossed, <, tried - tried / 10);
}

/* Large stars, simple unless one vertex is thrown over the others. */
static void test_crossing_large(void)
{
    uint32_t crossed = 0;
    for (uint32_t k = 0; k < 60; k++) {
        Polygon *p = random_star(300, 200 + k, 0.6);
        Whole v[300];
        for (uint32_t i = 0; i < 300; i++)
            v[i] = (Whole){(int64_t)floor(p->v[i].x * 1e6), (int64_t)floor(p->v[i].y * 1e6)};
        if (k % 2)
            v[k] = v[150 + k / 2];
        uint32_t before = crossed;
        check_crossing(v, 300, &crossed);
        g_assert_cmpuint(crossed - before, ==, k % 2);
        polygon_free(p);
    }
}

static void test_crossing_kinds(void)
{
    const Vec2 bow[4] = {{0, 0}, {1, 1}, {1, 0}, {0, 1}}, spike[4] = {{0, 0}, {2, 0}, {1, 0}, {1, 1}};
    const Vec2 pinch[6] = {{0, 0}, {1, 1}, {2, 0}, {2, 2}, {1, 1}, {0, 2}}, flat[3] = {{0, 0}, {1, 0}, {2, 0}};
    const struct {
        const Vec2 *v;
        uint32_t n;
    } bad[] = {{bow, 4}, {spike, 4}, {pinch, 6}, {flat, 3}};
    for (uint32_t k = 0; k < G_N_ELEMENTS(bad); k++) {
        Polygon *p = polygon_new(bad[k].v, bad[k].n);
        uint32_t i, j;
        g_assert_true(polygon_crossing(p, &i, &j));
        polygon_free(p);
    }
}

/* Tall edges are listed in many slabs; the lists must not grow without bound. */
static void test_comb(void)
{
    enum { N = 20000 };
    Vec2 *v = g_new(Vec2, N + 2);
    for (uint32_t i = 0; i < N; i++)
        v[i] = vec2(i, i % 2 ? 1000.0 : 1.0);
    v[N] = vec2(N, -1);
    v[N + 1] = vec2(-1, -1);
    Polygon *p = polygon_new(v, N + 2);
    g_assert_cmpuint(p->slab_start[p->n_slabs], <, 9 * (N + 2));
    uint32_t i, j;
    g_assert_false(polygon_crossing(p, &i, &j));
    g_assert_true(polygon_contains(p, vec2(777.0, 500.0)));
    g_assert_false(polygon_contains(p, vec2(778.0, 500.0)));
    polygon_free(p);
    g_free(v);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/polygon/contains/winding", test_contains_winding);
    g_test_add_func("/polygon/contains/near-edges", test_contains_near_edges);
    g_test_add_func("/polygon/contains/disc", test_contains_disc);
    g_test_add_func("/polygon/contains/shared-boundary", test_shared_boundary);
    g_test_add_func("/polygon/contains/odd", test_far_away_and_odd);
    g_test_add_func("/polygon/centroid", test_centroid);
    g_test_add_func("/polygon/crossing/random", test_crossing_random);
    g_test_add_func("/polygon/crossing/large", test_crossing_large);
    g_test_add_func("/polygon/crossing/kinds", test_crossing_kinds);
    g_test_add_func("/polygon/comb", test_comb);
    return g_test_run();
}
