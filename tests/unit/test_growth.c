/* Blade growth against its formulas (Runions 2005, sections 2.2 and 3.3), eq. 4 integrated independently. */
#include <glib.h>
#include <math.h>
#include <string.h>

#include "geom/outline.h"
#include "geom/random.h"
#include "sim/growth.h"

static void near(double got, double want, double tolerance)
{
    if (!(fabs(got - want) <= tolerance))
        g_error("%.17g instead of %.17g", got, want);
}

static Polygon *leaf_outline(void)
{
    OutlineDef def = outline_def_default();
    GError *error = NULL;
    Polygon *p = outline_new(&def, &error);
    g_assert_no_error(error);
    return p;
}

static Blade *blade(const Polygon *leaf, const GrowthDef *def)
{
    GError *error = NULL;
    Blade *b = blade_new(leaf, def, &error);
    g_assert_no_error(error);
    g_assert_nonnull(b);
    return b;
}

static Vec2 point(const Box2 *box, uint64_t i)
{
    double u[2];
    random_pair(9, 3000, 0, i, u);
    return vec2(box->x0 + u[0] * (box->x1 - box->x0), box->y0 + u[1] * (box->y1 - box->y0));
}

/* blade_material and blade_place undo each other. */
static void check_inverse(const Blade *b)
{
    for (uint64_t i = 0; i < 300; i++) {
        Vec2 p = point(&b->box, i), q = blade_place(b, blade_material(b, p));
        near(q.x, p.x, 1e-9 * b->scale);
        near(q.y, p.y, 1e-9 * b->scale);
        Vec2 m = vec_scale(point(&b->leaf->box, i), b->def.initial_length), n = blade_material(b, blade_place(b, m));
        near(n.x, m.x, 1e-9 * b->def.initial_length);
        near(n.y, m.y, 1e-9 * b->def.initial_length);
    }
}

/* The blade is the outline scaled to `length`, seen in a frame of `scale` to a leaf length. */
static void check_scaled(const Blade *b, double length, double scale)
{
    near(b->length, length, 1e-9 * length);
    near(b->scale, scale, 1e-9 * scale);
    near(b->unit, scale / length, 1e-12 * b->unit);
    near(b->area, b->leaf->area * length * length, 1e-9 * b->area);
    Polygon *p = blade_outline(b);
    for (uint32_t i = 0; i < p->n; i++) {
        near(p->v[i].x, b->leaf->v[i].x * scale, 1e-9 * scale);
        near(p->v[i].y, b->leaf->v[i].y * scale, 1e-9 * scale);
    }
    near(b->box.x0, p->box.x0, 1e-9 * scale);
    near(b->box.y1, p->box.y1, 1e-9 * scale);
    g_assert_cmpfloat(b->box.x0, >=, b->widest.x0);
    g_assert_cmpfloat(b->box.y0, >=, b->widest.y0);
    g_assert_cmpfloat(b->box.x1, <=, b->widest.x1);
    g_assert_cmpfloat(b->box.y1, <=, b->widest.y1);
    for (uint64_t i = 0; i < 200; i++) {
        Vec2 q = point(&b->widest, i);
        double depth = polygon_depth(p, q);
        if (fabs(depth) > 1e-6) {
            g_assert_cmpint(blade_contains(b, q), ==, depth > 0);
            if (fabs(depth + 1.0) > 1e-6)
                g_assert_cmpint(blade_admits(b, q), ==, depth > -1.0);
        }
    }
    polygon_free(p);
}

/* An outline that the base doesn't see the whole of: basal lobes behind sinuses, hooked teeth. A point is in the blade from the step on after
 * which it lies within the margin for good; a node admitted at one step never is more than a segment outside. */
static void test_swept_twice(void)
{
    static const Vec2 right[] = {{0, 0}, {0.1, 0.1}, {0.3, -0.25}, {0.5, -0.05}, {0.45, 0.3}, {0.7, 0.25}, {0.55, 0.45}, {0.3, 0.4}, {0.35, 0.7}, {0, 1}};
    enum { N = G_N_ELEMENTS(right) };
    Vec2 v[2 * N - 2];
    for (uint32_t i = 0; i < N; i++) {
        v[i] = right[i];
        if (i && i < N - 1)
            v[2 * N - 2 - i] = vec2(-right[i].x, right[i].y);
    }
    Polygon *leaf = polygon_new(v, 2 * N - 2);
    GrowthDef d = growth_def_default();
    d.kind = GROWTH_MARGINAL;
    d.initial_length = 40;
    d.final_length = 100;
    d.step = 0.5;
    Blade *b = blade(leaf, &d);
    uint32_t late = 0, early = 0, swept = 0, admitted = 0;
    for (uint64_t i = 0; i < 3000; i++) {
        Vec2 q = point(&b->widest, i);
        uint32_t first = 0, passed = blade_step_passed(b, q); /* first: after the last step with q outside */
        double off = 0.0; /* farthest outside from step 0 on */
        Blade *now = blade(leaf, &d);
        bool admits = blade_admits(now, q), inside_once = false;
        for (uint32_t t = 0; t <= b->last_step; t++, blade_advance(now)) {
            double length = blade_length_at(now, t);
            Vec2 u = vec_scale(q, 1.0 / length);
            bool in = polygon_contains(leaf, u);
            if (!in) {
                first = t + 1;
                swept += inside_once;
                inside_once = false;
                off = MAX(off, -polygon_depth(leaf, u) * length);
            }
            inside_once |= in;
            if (t % 40 == 7)
                g_assert_cmpint(blade_contains(now, q), ==, t >= passed && in);
        }
        blade_free(now);
        if (first <= b->last_step) {
            bool between = false; /* the tip of a sinus may pass between two steps */
            g_assert_cmpuint(passed, >=, first);
            for (uint32_t k = 0; passed > first && !between && k < 20000; k++) {
                double length = blade_length_at(b, passed - 1) + d.step * k / 20000.0;
                between = !polygon_contains(leaf, vec_scale(q, 1.0 / length));
            }
            g_assert_true(passed == first || between);
            late += passed > first;
            early += first == 0;
        }
        if (admits)
            g_assert_cmpfloat(off, <=, 1.0 + 1e-9);
        admitted += admits && off > 0.0;
    }
    g_assert_cmpuint(late, <, 60);
    g_assert_cmpuint(early, >, 100);
    g_assert_cmpuint(swept, >, 20);
    g_assert_cmpuint(admitted, >, 0);
    blade_free(b);
    polygon_free(leaf);
}

/* sigma(t) linear: length grows by `step` until it is final. */
static void check_linear(GrowthKind kind, double initial, double final, double step)
{
    Polygon *leaf = leaf_outline();
    GrowthDef def = growth_def_default();
    def.kind = kind;
    def.initial_length = initial;
    def.final_length = final;
    def.step = step;
    Blade *b = blade(leaf, &def);
    g_assert_cmpuint(b->step, ==, 0);
    g_assert_false(b->moving);
    g_assert_cmpuint(b->last_step, ==, (uint32_t)ceil((final - initial) / step));
    for (uint32_t k = 0; k <= b->last_step + 3; k++) {
        g_assert_cmpuint(b->step, ==, k);
        double length = MIN(initial + k * step, final);
        check_scaled(b, length, kind == GROWTH_ISOGONIC ? final : length);
        near(blade_length_at(b, k), length, 1e-9 * length);
        near(blade_scale_at(b, k), b->scale, 1e-9 * length);
        if (k < b->last_step)
            g_assert_cmpfloat(b->length, <, final);
        check_inverse(b);
        /* a material point: at rest in the frame */
        Vec2 m = vec2(0.1 * initial, 0.4 * initial), p = blade_place(b, m);
        double to_frame = kind == GROWTH_ISOGONIC ? final / initial : 1.0;
        near(p.x, m.x * to_frame, 1e-9 * final);
        near(p.y, m.y * to_frame, 1e-9 * final);
        blade_advance(b);
    }
    near(b->length, final, 1e-12 * final);
    blade_free(b);
    polygon_free(leaf);
}

static void test_marginal(void)
{
    check_linear(GROWTH_MARGINAL, 20, 100, 8);
    check_linear(GROWTH_MARGINAL, 20, 101.5, 7);
    check_linear(GROWTH_MARGINAL, 50, 50, 3);
    check_linear(GROWTH_MARGINAL, 30, 31, 100);
}

/* In segments, every distance between material points grows as the leaf does. */
static void test_isogonic(void)
{
    check_linear(GROWTH_ISOGONIC, 20, 100, 8);
    check_linear(GROWTH_ISOGONIC, 10, 350, 33.3);
}

static void test_none(void)
{
    Polygon *leaf = leaf_outline();
    GrowthDef def = growth_def_default();
    def.kind = GROWTH_NONE;
    def.initial_length = 77;
    def.final_length = 5; /* of no concern */
    Blade *b = blade(leaf, &def);
    g_assert_cmpuint(b->last_step, ==, 0);
    for (int k = 0; k < 4; k++) {
        check_scaled(b, 77, 77);
        check_inverse(b);
        blade_advance(b);
    }
    g_assert_cmpuint(b->step, ==, 4);
    blade_free(b);
    polygon_free(leaf);
}

/* ---- nonuniform ---- */

/* Straight lines between (y, g) pairs, constant beyond. */
static long double rate(const double *r, uint32_t n, long double y)
{
    for (uint32_t i = 0; i + 1 < n; i++) {
        long double y0 = (long double)r[2 * i], y1 = (long double)r[2 * i + 2];
        if (y >= y0 && y <= y1)
            return (long double)r[2 * i + 1] +
                   ((long double)r[2 * i + 3] - (long double)r[2 * i + 1]) * (y - y0) / (y1 - y0);
    }
    return (long double)(y < (long double)r[0] ? r[1] : r[2 * n - 1]);
}

static long double stretch(const double *r, uint32_t n, long double y, uint32_t t)
{
    return powl(1 + rate(r, n, y), (long double)t);
}

/* Simpson's rule on one piece. */
static long double simpson(const double *r, uint32_t n, uint32_t t, long double a, long double b)
{
    enum { PARTS = 200 };
    long double h = (b - a) / PARTS, sum = 0;
    for (int i = 0; i < PARTS; i++)
        sum +=
            stretch(r, n, a + i * h, t) + 4 * stretch(r, n, a + (i + 0.5L) * h, t) + stretch(r, n, a + (i + 1) * h, t);
    return sum * h / 6;
}

/* Eq. 4: the integral of (1 + g)^t from 0 to y, piece by piece between the corners of g; leaf lengths. */
static long double height(const double *r, uint32_t n, uint32_t t, long double y)
{
    long double lo = MIN(0, y), hi = MAX(0, y), at = lo, sum = 0;
    for (uint32_t i = 0; i <= n; i++) {
        long double to = i < n ? (long double)r[2 * i] : hi;
        to = CLAMP(to, at, hi);
        if (to > at)
            sum += simpson(r, n, t, at, to);
        at = to;
    }
    return y < 0 ? -sum : sum;
}

static void check_nonuniform(const double *rx, uint32_t nx, const double *ry, uint32_t ny, uint32_t steps)
{
    Polygon *leaf = leaf_outline();
    GrowthDef def = growth_def_default();
    def.kind = GROWTH_NONUNIFORM;
    def.initial_length = 40;
    def.steps = steps;
    def.rate_x = rx;
    def.n_rate_x = nx;
    def.rate_y = ry;
    def.n_rate_y = ny;
    Blade *b = blade(leaf, &def);
    g_assert_true(b->moving);
    g_assert_cmpuint(b->last_step, ==, steps);
    for (uint32_t t = 0; t <= steps + 2; t++, blade_advance(b)) {
        uint32_t age = MIN(t, steps);
        if (t % 7 && t < steps)
            continue;
        g_assert_cmpuint(b->step, ==, t);
        near(b->unit, 1.0, 0.0);
        near(b->length, (double)(40 * height(ry, ny, age, 1)), 2e-6 * b->length);
        near(b->scale, b->length, 1e-12 * b->length);
        for (uint64_t i = 0; i < 60; i++) {
            Vec2 u = point(&leaf->box, i), p = blade_place(b, vec_scale(u, 40));
            long double y = (long double)u.y;
            near(p.y, (double)(40 * height(ry, ny, age, y)), 2e-6 * b->length);
            near(p.x, 40 * u.x * (double)stretch(rx, nx, y, age), 2e-6 * b->length);
        }
        Vec2 base = blade_place(b, vec2(0, 0));
        near(base.x, 0, 0);
        near(base.y, 0, 1e-12 * b->length);
        check_inverse(b);
        Polygon *p = blade_outline(b);
        near(b->area, p->area, 1e-9 * p->area);
        g_assert_cmpmem(&b->box, sizeof b->box, &p->box, sizeof p->box);
        Box2 both = box_union(b->widest, b->box);
        near(both.x0, b->widest.x0, 1e-6);
        near(both.y0, b->widest.y0, 1e-6);
        near(both.x1, b->widest.x1, 1e-6);
        near(both.y1, b->widest.y1, 1e-6);
        for (uint64_t i = 0; i < 200; i++) {
            Vec2 q = point(&b->widest, i);
            double depth = polygon_depth(p, q);
            if (fabs(depth) > 1e-6)
                g_assert_cmpint(blade_contains(b, q), ==, depth > 0);
        }
        polygon_free(p);
    }
    blade_free(b);
    polygon_free(leaf);
}

static void test_nonuniform(void)
{
    /* like fig. 5c, d: fast at the base, slow at the tip; then the reverse; then parts that shrink; a single pair */
    static const double down[] = {0, 0.03, 0.5, 0.02, 1, 0.001}, up[] = {0, 0.0, 0.3, 0.01, 0.9, 0.03};
    static const double mixed[] = {-0.02, -0.01, 0.2, 0.02, 0.6, -0.005, 0.8, 0.01}, one[] = {0.5, 0.02};
    check_nonuniform(down, 3, down, 3, 100);
    check_nonuniform(up, 3, down, 3, 70);
    check_nonuniform(down, 3, up, 3, 40);
    check_nonuniform(mixed, 4, mixed, 4, 60);
    check_nonuniform(one, 1, up, 3, 30);
    check_nonuniform(down, 3, up, 3, 0);
}

/* Equal rates everywhere are isogonic growth. */
static void test_uniform_rates(void)
{
    static const double g[] = {0, 0.02, 1, 0.02};
    Polygon *leaf = leaf_outline();
    GrowthDef def = growth_def_default();
    def.kind = GROWTH_NONUNIFORM;
    def.initial_length = 30;
    def.steps = 90;
    def.rate_x = def.rate_y = g;
    def.n_rate_x = def.n_rate_y = 2;
    Blade *b = blade(leaf, &def);
    for (uint32_t t = 0; t <= 90; t += 1, blade_advance(b)) {
        double k = pow(1.02, t), length = 30 * k;
        near(b->length, length, 1e-9 * length);
        near(b->area, leaf->area * length * length, 1e-9 * b->area);
        for (uint64_t i = 0; i < 20; i++) {
            Vec2 m = vec_scale(point(&leaf->box, i), 30), p = blade_place(b, m);
            near(p.x, m.x * k, 1e-9 * length);
            near(p.y, m.y * k, 1e-9 * length);
        }
    }
    blade_free(b);
    polygon_free(leaf);
}

/* ---- errors ---- */

static void refused(const Polygon *leaf, GrowthDef def, const char *word)
{
    GError *error = NULL;
    g_assert_null(blade_new(leaf, &def, &error));
    g_assert_error(error, GROWTH_ERROR, GROWTH_ERROR_VALUE);
    if (!strstr(error->message, word))
        g_error("'%s' does not name %s", error->message, word);
    g_clear_error(&error);
}

static void test_errors(void)
{
    static const double backwards[] = {0.5, 0.1, 0.2, 0.1}, twice[] = {0.5, 0.1, 0.5, 0.2}, gone[] = {0, -1},
                        wild[] = {0, 11};
    static const double fine[] = {0, 0};
    Polygon *leaf = leaf_outline();
    GrowthDef d = growth_def_default();
    d.final_length = d.initial_length - 1;
    refused(leaf, d, "final_length");
    d.kind = GROWTH_ISOGONIC;
    refused(leaf, d, "final_length");
    d.final_length = 1e6;
    d.step = 1e-6;
    refused(leaf, d, "step");
    d.kind = GROWTH_NONUNIFORM;
    d.rate_y = fine;
    d.n_rate_y = 1;
    const double *bad[] = {backwards, twice, gone, wild};
    for (gsize i = 0; i < G_N_ELEMENTS(bad); i++) {
        d.rate_x = bad[i];
        d.n_rate_x = i < 2 ? 2 : 1;
        refused(leaf, d, "rate_x");
    }
    d.n_rate_x = 0;
    refused(leaf, d, "rate_x");
    d.rate_x = fine;
    d.n_rate_x = 1;
    d.rate_y = gone;
    refused(leaf, d, "rate_y");
    polygon_free(leaf);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/growth/swept-twice", test_swept_twice);
    g_test_add_func("/growth/marginal", test_marginal);
    g_test_add_func("/growth/isogonic", test_isogonic);
    g_test_add_func("/growth/none", test_none);
    g_test_add_func("/growth/nonuniform", test_nonuniform);
    g_test_add_func("/growth/uniform-rates", test_uniform_rates);
    g_test_add_func("/growth/errors", test_errors);
    return g_test_run();
}
