/* Bézier fits of contours: curves that are known cubics, circles, teeth, and what every fit promises. */
#include <glib.h>

#include "geom/bezierfit.h"
#include "geom/cubicfit.h"
#include "geom/dtrig.h"
#include "geom/outline.h"
#include "geom/random.h"
#include "geom/segment.h"
#include "geom/svgpath.h"

#define CLOSE(a, b, e) g_assert_cmpfloat_with_epsilon(a, b, e)

static double uniform(uint32_t stream, uint64_t index)
{
    double u[2];
    random_pair(17, stream, 0, index, u);
    return u[0];
}

static Vec2 *contour(GArray *points) { return &g_array_index(points, Vec2, 0); }

/* The sides of a polygon cut into pieces of `step` or less; corner k becomes vertex at[k]. */
static GArray *dense(const Vec2 *v, uint32_t n, double step, uint32_t *at)
{
    GArray *points = g_array_new(FALSE, FALSE, sizeof(Vec2));
    for (uint32_t i = 0; i < n; i++) {
        int pieces = MAX((int)ceil(vec_dist(v[i], v[(i + 1) % n]) / step), 1);
        if (at)
            at[i] = points->len;
        for (int k = 0; k < pieces; k++) {
            Vec2 p = vec_lerp(v[i], v[(i + 1) % n], (double)k / pieces);
            g_array_append_val(points, p);
        }
    }
    return points;
}

/* Largest distance both ways, and the mean, by plain search over 4000 chords of the curve. */
static void plain_deviation(const Vec2 q[4], const Vec2 *p, uint32_t n, double *largest, double *mean)
{
    enum { CHORDS = 4000 };
    double sum = 0.0, whole = 0.0;
    *largest = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        double least = HUGE_VAL, w = (i ? vec_dist(p[i - 1], p[i]) : 0.0) + (i + 1 < n ? vec_dist(p[i], p[i + 1]) : 0.0);
        for (int k = 0; k < CHORDS; k++)
            least = MIN(least, segment_dist2(cubic_at(q, (double)k / CHORDS), cubic_at(q, (k + 1.0) / CHORDS), p[i]));
        *largest = MAX(*largest, sqrt(least));
        sum += w * sqrt(least);
        whole += w;
    }
    *mean = sum / whole;
    for (int k = 0; k <= 64; k++) {
        double least = HUGE_VAL;
        for (uint32_t i = 0; i + 1 < n; i++)
            least = MIN(least, segment_dist2(p[i], p[i + 1], cubic_at(q, k / 64.0)));
        *largest = MAX(*largest, sqrt(least));
    }
}

/* A chain from base to tip and back, through the characteristic points, G1 but at cusps. */
static void check_promises(const BezierFit *fit, const Vec2 *v, uint32_t n, const uint32_t *at, uint32_t n_at, uint32_t base, uint32_t tip)
{
    double largest = 0.0;
    g_assert_cmpuint(fit->piece[0].from, ==, base);
    g_assert_cmpuint(fit->n_right, >, 0);
    g_assert_cmpuint(fit->n_right, <, fit->n);
    g_assert_cmpuint(fit->piece[fit->n_right].from, ==, tip);
    g_assert_true(fit->piece[0].cusp && fit->piece[fit->n_right].cusp);
    uint32_t walked = 0;
    for (uint32_t k = 0; k < fit->n; k++) {
        const BezierPiece *c = &fit->piece[k], *d = &fit->piece[(k + 1) % fit->n];
        g_assert_cmpuint(c->to, ==, d->from);
        walked += (c->to + n - c->from - 1) % n + 1;
        g_assert_true(c->p[0].x == v[c->from].x && c->p[0].y == v[c->from].y && c->p[3].x == v[c->to].x && c->p[3].y == v[c->to].y);
        Vec2 in = vec_sub(c->p[3], c->p[2]), out = vec_sub(d->p[1], d->p[0]);
        if (!d->cusp) {
            CLOSE(vec_cross(in, out) / sqrt(vec_norm2(in) * vec_norm2(out)), 0.0, 1e-9);
            g_assert_cmpfloat(vec_dot(in, out), >, 0.0);
        }
        g_assert_cmpfloat(c->mean, <=, c->largest);
        largest = MAX(largest, c->largest);
    }
    g_assert_cmpuint(walked, ==, n);
    g_assert_cmpfloat(largest, ==, fit->largest);
    for (uint32_t i = 0; i < n_at; i++) {
        bool found = false;
        for (uint32_t k = 0; k < fit->n; k++)
            found |= fit->piece[k].from == at[i];
        g_assert_true(found);
    }
}

static BezierFit *make(GArray *points, const uint32_t *at, uint32_t n_at, uint32_t base, uint32_t tip, BezierFitDef def)
{
    GError *error = NULL;
    BezierFit *fit = bezierfit_new(contour(points), points->len, at, n_at, base, tip, &def, &error);
    g_assert_no_error(error);
    check_promises(fit, contour(points), points->len, at, n_at, base, tip);
    return fit;
}

static BezierFitDef contour_rule(void)
{
    BezierFitDef def = bezierfit_def_default();
    def.rule = BEZIERFIT_CONTOUR;
    return def;
}

/* --- one cubic --- */

/* A few random cubics have twins so near that the fit may end at one: a least place of its own. */
static void test_cubic_recovered(void)
{
    uint32_t exact[2] = {0, 0};
    for (uint32_t k = 0; k < 300; k++) {
        Vec2 q[4] = {{0, 0}, {0.1 + 0.5 * uniform(1, k), uniform(2, k) - 0.5}, {0.9 - 0.5 * uniform(3, k), uniform(4, k) - 0.5}, {1, 0}},
             p[301];
        for (int i = 0; i <= 300; i++)
            p[i] = cubic_at(q, i / 300.0);
        Vec2 got[2][4] = {{q[0], {0.33, 0}, {0.67, 0}, q[3]}, {q[0], vec_scale(q[1], 0.7), vec_lerp(q[3], q[2], 1.2), q[3]}};
        for (int known = 0; known < 2; known++) { /* the second with the directions known */
            double misfit = sqrt(cubic_fit(got[known], p, 301, known));
            g_assert_cmpfloat(misfit, <, 5e-4);
            g_assert_cmpfloat(cubic_deviation(got[known], p, 301).largest, <, 2e-3);
            if (misfit > 1e-9)
                continue;
            exact[known]++;
            CLOSE(vec_dist(got[known][1], q[1]), 0.0, 1e-6);
            CLOSE(vec_dist(got[known][2], q[2]), 0.0, 1e-6);
        }
    }
    g_assert_cmpfloat(exact[0], >=, 280);
    g_assert_cmpfloat(exact[1], >=, 280);
}

/* Noisy points on a line: without a limit handles grow until the curve runs to and fro along it. */
static void test_cubic_straight(void)
{
    for (uint32_t k = 0; k < 200; k++) {
        Vec2 p[14];
        for (int i = 0; i < 14; i++)
            p[i] = vec2(i, i % 13 ? 0.7 * uniform(40, 14 * k + (uint32_t)i) - 0.35 : 0.0);
        Vec2 q[4] = {p[0], {4, 1 - 2 * uniform(41, k)}, {9, 1 - 2 * uniform(42, k)}, p[13]};
        cubic_fit(q, p, 14, true);
        for (int i = 0; i < 200; i++)
            g_assert_cmpfloat(cubic_at(q, (i + 1) / 200.0).x, >, cubic_at(q, i / 200.0).x - 1e-12);
    }
}

/* Of points that lie on no cubic: no nearby curve is better. */
static void test_cubic_least(void)
{
    for (uint32_t k = 0; k < 50; k++) {
        Vec2 p[60];
        for (int i = 0; i < 60; i++)
            p[i] = vec2(i / 59.0, 0.3 * dtrig_sin(0.05 * i * (1.0 + uniform(5, k))) + 0.02 * uniform(6, 60 * k + (uint32_t)i));
        Vec2 q[4] = {p[0], vec_lerp(p[0], p[59], 0.3), vec_lerp(p[0], p[59], 0.7), p[59]};
        double best = cubic_fit(q, p, 60, false);
        for (int j = 0; j < 8; j++) {
            Vec2 r[4] = {q[0], q[1], q[2], q[3]};
            (j < 4 ? &r[1] : &r[2])->x += j % 4 == 0 ? 0.01 : j % 4 == 1 ? -0.01 : 0.0;
            (j < 4 ? &r[1] : &r[2])->y += j % 4 == 2 ? 0.01 : j % 4 == 3 ? -0.01 : 0.0;
            double sum = 0.0, whole = 0.0; /* the mean square of that one, plainly */
            for (int i = 0; i < 60; i++) {
                double least = HUGE_VAL, w = (i ? vec_dist(p[i - 1], p[i]) : 0.0) + (i < 59 ? vec_dist(p[i], p[i + 1]) : 0.0);
                for (int c = 0; c < 400; c++)
                    least = MIN(least, segment_dist2(cubic_at(r, c / 400.0), cubic_at(r, (c + 1) / 400.0), p[i]));
                sum += w * least;
                whole += w;
            }
            g_assert_cmpfloat(sum / whole, >, best * (1.0 - 1e-4));
        }
    }
}

static void test_deviation(void)
{
    for (uint32_t k = 0; k < 40; k++) {
        Vec2 q[4] = {{0, 0}, {uniform(7, k), 2 * uniform(8, k) - 1}, {uniform(9, k), 2 * uniform(10, k) - 1}, {1, 0}}, p[80];
        for (int i = 0; i < 80; i++)
            p[i] = vec_add(cubic_at(q, i / 79.0), vec2(0, i % 79 ? 0.1 * uniform(11, 100 * k + (uint32_t)i) : 0.0));
        double largest, mean;
        plain_deviation(q, p, 80, &largest, &mean);
        CubicDeviation d = cubic_deviation(q, p, 80);
        CLOSE(d.largest, largest, 1e-5);
        CLOSE(d.mean, mean, 1e-5);
    }
    /* a curve that runs beyond the ends of the line it covers: only its own places tell */
    const Vec2 q[4] = {{0, 0}, {-1, 0}, {2, 0}, {1, 0}};
    Vec2 p[11];
    for (int i = 0; i <= 10; i++)
        p[i] = vec2(0.1 * i, 0.0);
    double largest, mean;
    plain_deviation(q, p, 11, &largest, &mean);
    g_assert_cmpfloat(largest, >, 0.1);
    CubicDeviation d = cubic_deviation(q, p, 11);
    CLOSE(d.largest, largest, 1e-12);
    CLOSE(d.mean, 0.0, 1e-12);
    g_assert_true(d.farthest == 0 || d.farthest == 10);
}

/* --- known curves --- */

/* Cubics end to end, each sampled at `n` even parameters, the joints' vertices in at[]. */
static GArray *sampled(const Vec2 (*q)[4], uint32_t pieces, uint32_t n, uint32_t *at)
{
    GArray *points = g_array_new(FALSE, FALSE, sizeof(Vec2));
    for (uint32_t k = 0; k < pieces; k++) {
        at[k] = points->len;
        for (uint32_t i = 0; i < n; i++) {
            Vec2 p = cubic_at(q[k], (double)i / n);
            g_array_append_val(points, p);
        }
    }
    return points;
}

/* The default outline, which is eight cubics joined smoothly but for base and tip, comes back control point by control point. */
static void test_recovered_outline(void)
{
    SvgPath *path = svgpath_parse(outline_def_default().path, NULL);
    g_assert_cmpuint(path->curves->len, ==, 4);
    Vec2 q[8][4];
    for (uint32_t k = 0; k < 4; k++) {
        for (int i = 0; i < 4; i++)
            q[k][i] = vec_scale(g_array_index(path->curves, Curve, k).p[i], 100.0);
        if (k > 0) { /* the drawing's joints are smooth to a fiftieth of a degree; make it rounding */
            Vec2 in = vec_sub(q[k - 1][3], q[k - 1][2]);
            q[k][1] = vec_add(q[k][0], vec_scale(in, vec_dist(q[k][0], q[k][1]) / sqrt(vec_norm2(in))));
        }
    }
    for (uint32_t k = 0; k < 4; k++)
        for (int i = 0; i < 4; i++)
            q[7 - k][3 - i] = vec2(-q[k][i].x, q[k][i].y);
    uint32_t at[8];
    GArray *points = sampled(q, 8, 500, at);
    BezierFit *fit = make(points, at, 8, at[0], at[4], contour_rule());
    g_assert_cmpuint(fit->n, ==, 8);
    g_assert_cmpuint(fit->n_right, ==, 4);
    for (uint32_t k = 0; k < 8; k++) {
        g_assert_cmpint(fit->piece[k].cusp, ==, k % 4 == 0);
        for (int i = 0; i < 4; i++)
            CLOSE(vec_dist(fit->piece[k].p[i], q[k][i]), 0.0, 1e-3);
    }
    g_assert_cmpfloat(fit->largest, <, 1e-3);
    bezierfit_free(fit);

    fit = make(points, NULL, 0, at[0], at[4], bezierfit_def_default()); /* without its joints the paper's rule gives the chord */
    g_assert_cmpuint(fit->n, ==, 2);
    CLOSE(fit->largest, 28.0, 1.0);
    bezierfit_free(fit);
    g_array_unref(points);
    svgpath_free(path);
}

/* Rings of random cubics that all meet in corners; a few flat ones have twins, see above. */
static void test_recovered_corners(void)
{
    uint32_t exact = 0;
    for (uint32_t k = 0; k < 20; k++) {
        enum { N = 7 };
        Vec2 q[N][4];
        for (int i = 0; i < N; i++)
            q[i][0] = vec2(50 * dtrig_cos(2 * DTRIG_PI * i / N), 50 * dtrig_sin(2 * DTRIG_PI * i / N));
        for (int i = 0; i < N; i++) {
            q[i][3] = q[(i + 1) % N][0];
            Vec2 chord = vec_sub(q[i][3], q[i][0]), across = vec2(chord.y, -chord.x);
            /* both bulge out by 15° or more: corners of the ring are too sharp for smooth joints */
            q[i][1] = vec_add(vec_lerp(q[i][0], q[i][3], 0.2 + 0.2 * uniform(20, 10 * k + (uint32_t)i)), vec_scale(across, -0.1));
            q[i][2] = vec_add(vec_lerp(q[i][0], q[i][3], 0.6 + 0.2 * uniform(21, 10 * k + (uint32_t)i)),
                              vec_scale(across, -0.2 * uniform(22, 10 * k + (uint32_t)i)));
        }
        uint32_t at[N];
        GArray *points = sampled(q, N, 300, at);
        BezierFit *fit = make(points, at, N, at[2], at[5], contour_rule());
        for (int i = 0; i < N; i++) {
            const BezierPiece *c = &fit->piece[(i + N - 2) % N];
            g_assert_true(c->cusp);
            g_assert_cmpfloat(c->largest, <, 0.02);
            exact += vec_dist(c->p[1], q[i][1]) < 1e-3 && vec_dist(c->p[2], q[i][2]) < 1e-3;
        }
        bezierfit_free(fit);
        g_array_unref(points);
    }
    g_assert_cmpuint(exact, >=, 130);
}

static GArray *circle(uint32_t n, double r)
{
    GArray *points = g_array_new(FALSE, FALSE, sizeof(Vec2));
    for (uint32_t i = 0; i < n; i++) {
        Vec2 p;
        dtrig_sin_cos(2.0 * DTRIG_PI * i / n, &p.y, &p.x);
        p = vec_scale(p, r);
        g_array_append_val(points, p);
    }
    return points;
}

static double circle_deviation(uint32_t pieces, BezierFitDef def)
{
    enum { N = 17280 };
    GArray *points = circle(N, 10.0);
    uint32_t at[64];
    for (uint32_t k = 0; k < pieces; k++)
        at[k] = k * N / pieces;
    BezierFit *fit = make(points, at, pieces, 0, N / 2, def);
    g_assert_cmpuint(fit->n, ==, pieces);
    for (uint32_t k = 0; k < pieces; k++)
        g_assert_cmpint(fit->piece[k].cusp, ==, k == 0 || k == pieces / 2);
    double largest = fit->largest;
    bezierfit_free(fit);
    g_array_unref(points);
    return largest;
}

/* The paper's rule leaves r θ⁴/128 of an arc of angle θ, least squares a part that falls with θ⁶ (less than the 2.7e-4 r of the quarter
 * circle drawn with the usual constant). */
static void test_circle(void)
{
    for (uint32_t pieces = 6; pieces <= 48; pieces *= 2) {
        double angle = 2.0 * DTRIG_PI / pieces, want = 10.0 * angle * angle * angle * angle / 128.0;
        CLOSE(circle_deviation(pieces, bezierfit_def_default()) / want, 1.0, 0.15 * angle * angle + 1e-3);
    }
    double sixth = circle_deviation(6, contour_rule()), eighth = circle_deviation(8, contour_rule()),
           twelfth = circle_deviation(12, contour_rule());
    g_assert_cmpfloat(circle_deviation(4, contour_rule()), <, 2.7e-3);
    CLOSE(sixth / twelfth, 64.0, 4.0);
    CLOSE(eighth / twelfth, 11.39, 0.6);
}

/* The paper's tangent is at right angles to the radius of the circle through a point and its neighbours, control points a third of a chord
 * away; at a cusp it leans as far to one side of the chord as at the other end to the other. */
static void test_paper_rule(void)
{
    const Vec2 corner[8] = {{0, 0}, {30, 8}, {52, 31}, {40, 70}, {0, 100}, {-37, 66}, {-50, 40}, {-26, 5}};
    uint32_t at[8];
    GArray *points = dense(corner, 8, 0.5, at);
    BezierFitDef def = bezierfit_def_default();
    def.cusp_angle = 175.0;
    def.tension = 0.8;
    BezierFit *fit = make(points, at, 8, at[0], at[4], def);
    g_assert_cmpuint(fit->n, ==, 8);
    for (uint32_t k = 0; k < 8; k++) {
        const BezierPiece *c = &fit->piece[k];
        Vec2 chord = vec_sub(corner[(k + 1) % 8], corner[k]), m = vec_sub(c->p[1], c->p[0]), e = vec_sub(c->p[3], c->p[2]);
        double h = sqrt(vec_norm2(chord));
        CLOSE(sqrt(vec_norm2(m)), 0.8 * h / 3.0, 1e-9);
        CLOSE(sqrt(vec_norm2(e)), 0.8 * h / 3.0, 1e-9);
        if (k % 4 == 0 || k % 4 == 3) { /* next to base or tip */
            CLOSE(vec_dot(m, chord), vec_dot(e, chord), 1e-9);
            CLOSE(vec_cross(m, chord), -vec_cross(e, chord), 1e-9);
        }
        if (k % 4 != 0) {
            Vec2 p = corner[k - 1], q = corner[k], r = corner[(k + 1) % 8], a = vec_sub(p, q), b = vec_sub(r, q);
            double twice = 2.0 * vec_cross(a, b);
            Vec2 centre =
                vec2((b.y * vec_norm2(a) - a.y * vec_norm2(b)) / twice, (a.x * vec_norm2(b) - b.x * vec_norm2(a)) / twice); /* from q */
            CLOSE(vec_dot(centre, m) / sqrt(vec_norm2(centre) * vec_norm2(m)), 0.0, 1e-9);
        }
    }
    bezierfit_free(fit);
    g_array_unref(points);
}

/* --- teeth --- */

/* Teeth of a straight-sided leaf are cusps, peaks and valleys, and the fit is the polygon; joints on the straight sides are smooth. */
static void test_teeth(void)
{
    const OutlineWave wave = {0.02, 9};
    OutlineDef outline = outline_def_default();
    outline.path = "M0 0L.2 .1V.9L0 1-.2 .9V.1z";
    outline.mirror = false;
    outline.waves = &wave;
    outline.n_waves = 1;
    outline.tooth_skew = 0.7;
    Polygon *leaf = outline_new(&outline, NULL);
    g_assert_nonnull(leaf);
    uint32_t *at = g_new(uint32_t, leaf->n + 1), tip = 0;
    GArray *points = dense(leaf->v, leaf->n, 0.001, at);
    for (uint32_t i = 0; i < leaf->n; i++)
        if (leaf->v[i].y == 1.0)
            tip = i;
    at[leaf->n] = (at[1] + at[0]) / 2; /* half way up an edge */
    for (int rule = BEZIERFIT_CHORDS; rule <= BEZIERFIT_CONTOUR; rule++) {
        BezierFitDef def = bezierfit_def_default();
        def.rule = (BezierFitRule)rule;
        def.cusp_angle = 10.0;
        BezierFit *fit = make(points, at, leaf->n + 1, at[0], at[tip], def);
        g_assert_cmpuint(fit->n, ==, leaf->n + 1);
        uint32_t cusps = 0;
        for (uint32_t k = 0; k < fit->n; k++) {
            g_assert_true(!fit->piece[k].cusp || fit->piece[k].from != at[leaf->n]);
            cusps += fit->piece[k].cusp;
            Vec2 before = vec_sub(fit->piece[k].p[0], fit->piece[(k + fit->n - 1) % fit->n].p[0]),
                 after = vec_sub(fit->piece[k].p[3], fit->piece[k].p[0]);
            double cosine = vec_dot(before, after) / sqrt(vec_norm2(before) * vec_norm2(after));
            if (fit->piece[k].from != at[0] && fit->piece[k].from != at[tip])
                g_assert_cmpint(fit->piece[k].cusp, ==, cosine < 0.98480775);
        }
        g_assert_cmpuint(cusps, >=, 2 * 18);
        g_assert_cmpfloat(fit->largest, <, 1e-9);
        bezierfit_free(fit);
    }
    g_array_unref(points);
    g_free(at);
    polygon_free(leaf);
}

/* Told of base and tip alone, the fit finds the corners of a lobed shape where it is parted, and makes cusps of them. */
static void test_corners_found(void)
{
    const Vec2 corner[8] = {{0, 0}, {40, 10}, {22, 35}, {60, 60}, {0, 100}, {-60, 60}, {-22, 35}, {-40, 10}};
    uint32_t at[8];
    GArray *points = dense(corner, 8, 0.5, at);
    for (int rule = BEZIERFIT_CHORDS; rule <= BEZIERFIT_CONTOUR; rule++) {
        BezierFitDef def = bezierfit_def_default();
        def.rule = (BezierFitRule)rule;
        def.tolerance = 0.5;
        BezierFit *fit = make(points, NULL, 0, at[0], at[4], def);
        uint32_t found = 0;
        for (uint32_t k = 0; k < fit->n; k++)
            for (int i = 0; i < 8; i++)
                found += fit->piece[k].from == at[i] && fit->piece[k].cusp;
        g_assert_cmpuint(found, ==, 8);
        g_assert_cmpfloat(fit->largest, <=, 0.5);
        bezierfit_free(fit);
    }
    g_array_unref(points);
}

/* The same on a ring of curved sides, where the farthest vertex is beside the corner. */
static void test_curved_corners_found(void)
{
    enum { N = 8 };
    Vec2 q[N][4];
    for (int i = 0; i < N; i++) {
        double r = i % 2 ? 45.0 : 100.0;
        q[i][0] = vec2(r * dtrig_sin(-2 * DTRIG_PI * i / N), r * dtrig_cos(2 * DTRIG_PI * i / N));
    }
    for (int i = 0; i < N; i++) {
        q[i][3] = q[(i + 1) % N][0];
        Vec2 chord = vec_sub(q[i][3], q[i][0]), across = vec2(chord.y, -chord.x);
        q[i][1] = vec_add(vec_lerp(q[i][0], q[i][3], 0.3), vec_scale(across, 0.16));
        q[i][2] = vec_add(vec_lerp(q[i][0], q[i][3], 0.7), vec_scale(across, i % 2 ? -0.1 : 0.13));
    }
    uint32_t at[N];
    GArray *points = sampled(q, N, 200, at);
    for (int rule = BEZIERFIT_CHORDS; rule <= BEZIERFIT_CONTOUR; rule++) {
        BezierFitDef def = bezierfit_def_default();
        def.rule = (BezierFitRule)rule;
        def.tolerance = 0.2;
        BezierFit *fit = make(points, NULL, 0, at[0], at[4], def);
        uint32_t found = 0;
        for (uint32_t k = 0; k < fit->n; k++)
            for (int i = 0; i < N; i++)
                found += fit->piece[k].from == at[i] && fit->piece[k].cusp;
        g_assert_cmpuint(found, ==, N);
        g_assert_cmpfloat(fit->largest, <=, 0.2);
        bezierfit_free(fit);
    }
    g_array_unref(points);
}

/* --- leaves --- */

static GArray *leaf_contour(const char *file, double teeth, double size, uint32_t *base, uint32_t *tip)
{
    const OutlineWave wave = {0.012, teeth};
    OutlineDef def = outline_def_default();
    def.waves = &wave;
    def.n_waves = 1;
    def.tooth_skew = 0.72;
    char *path = g_build_filename(g_test_get_dir(G_TEST_DIST), "..", "..", "params", "outlines", file, NULL);
    def.path = NULL;
    def.mirror = false;
    def.file = def.where = path;
    GError *error = NULL;
    Polygon *leaf = outline_new(&def, &error);
    g_assert_no_error(error);
    Vec2 *v = g_new(Vec2, leaf->n);
    for (uint32_t i = 0; i < leaf->n; i++)
        v[i] = vec_scale(leaf->v[i], size);
    GArray *points = dense(v, leaf->n, 0.7, NULL);
    *base = *tip = 0;
    for (uint32_t i = 0; i < points->len; i++) {
        if (vec_dist2(contour(points)[i], vec2(0, 0)) < vec_dist2(contour(points)[*base], vec2(0, 0)))
            *base = i;
        if (vec_dist2(contour(points)[i], vec2(0, size)) < vec_dist2(contour(points)[*tip], vec2(0, size)))
            *tip = i;
    }
    g_free(v);
    g_free(path);
    polygon_free(leaf);
    return points;
}

/* The boundary of the squares of a grid of size 1 whose middles the polygon holds, counter-clockwise, vertices 1 apart. */
static GArray *staircase(const Vec2 *v, uint32_t n)
{
    static const int dx[4] = {1, 0, -1, 0}, dy[4] = {0, 1, 0, -1};
    Polygon *p = polygon_new(v, n);
    int x = (int)floor(p->box.x0) - 1, y = (int)floor(0.5 * (p->box.y0 + p->box.y1)), way = 3;
    while (!polygon_contains(p, vec2(x + 0.5, y + 0.5)))
        x++;
    y++; /* down the left side of that square, which is on the left of the walk */
    const int x0 = x, y0 = y;
    GArray *points = g_array_new(FALSE, FALSE, sizeof(Vec2));
    do {
        Vec2 here = vec2(x, y);
        g_array_append_val(points, here);
        x += dx[way];
        y += dy[way];
        Vec2 ahead = vec2(x + 0.5 * dx[way], y + 0.5 * dy[way]), left = vec2(-0.5 * dy[way], 0.5 * dx[way]);
        if (polygon_contains(p, vec_sub(ahead, left)))
            way = (way + 3) % 4;
        else if (!polygon_contains(p, vec_add(ahead, left)))
            way = (way + 1) % 4;
    } while (x != x0 || y != y0);
    polygon_free(p);
    return points;
}

static uint32_t nearest(GArray *points, Vec2 q)
{
    uint32_t best = 0;
    for (uint32_t i = 1; i < points->len; i++)
        if (vec_dist2(contour(points)[i], q) < vec_dist2(contour(points)[best], q))
            best = i;
    return best;
}

/* The path data of a fit read as an outline, which must be simple, have base and tip in place and enclose the contour's area. */
static void check_round_trip(const BezierFit *fit, GArray *points, uint32_t base, uint32_t tip)
{
    char *path = bezierfit_path(fit, 3);
    OutlineDef def = outline_def_default();
    def.path = path;
    def.mirror = false;
    def.has_tip = true;
    def.tip = contour(points)[tip];
    GError *error = NULL;
    Polygon *leaf = outline_new(&def, &error);
    g_assert_no_error(error);
    double twice = 0.0, scale = vec_dist2(contour(points)[base], contour(points)[tip]);
    for (uint32_t k = 0; k < points->len; k++)
        twice += vec_cross(contour(points)[k], contour(points)[(k + 1) % points->len]);
    CLOSE(leaf->area * scale / (0.5 * twice), 1.0, 0.01);
    polygon_free(leaf);
    g_free(path);
}

/* Every piece is within the tolerance, or too short to be parted once more: twice the default of `shortest`, four times eight mean edges. At
 * most one in ten is that. */
static void check_tolerance(const BezierFit *fit, GArray *points, double tolerance)
{
    uint32_t excused = 0;
    double whole = 0.0;
    for (uint32_t k = 0; k < points->len; k++)
        whole += vec_dist(contour(points)[k], contour(points)[(k + 1) % points->len]);
    for (uint32_t i = 0; i < fit->n; i++) {
        const BezierPiece *p = &fit->piece[i];
        double length = 0.0;
        for (uint32_t k = p->from; k != p->to; k = (k + 1) % points->len)
            length += vec_dist(contour(points)[k], contour(points)[(k + 1) % points->len]);
        if (p->largest > tolerance) {
            g_assert_cmpfloat(length, <=, 32.0 * 1.05 * whole / points->len);
            g_assert_cmpfloat(p->largest, <=, 2.0 * tolerance);
            excused++;
        }
    }
    g_assert_cmpuint(10 * excused, <=, fit->n);
}

/* Whole leaves within a tolerance, from smooth contours and from pixels'; finer tolerances take more pieces. */
static void test_leaves(void)
{
    static const char *const files[] = {"ovate.svg", "sweetgum.svg", "toothed.svg", "alchemilla.svg"};
    for (uint32_t i = 0; i < 4 * G_N_ELEMENTS(files); i++) {
        uint32_t base, tip, fewest = 0;
        bool stairs = i % 2;
        GArray *points = leaf_contour(files[i / 4], 0.0, 300.0, &base, &tip);
        if (stairs) {
            GArray *smooth = points;
            points = staircase(contour(smooth), smooth->len);
            base = nearest(points, vec2(0.0, 0.0));
            tip = nearest(points, vec2(0.0, 300.0));
            g_array_unref(smooth);
        }
        for (double tolerance = stairs ? 2.0 : 1.0; tolerance < 9.0; tolerance *= 2.0) {
            BezierFitDef def = bezierfit_def_default();
            def.rule = i / 2 % 2 ? BEZIERFIT_CONTOUR : BEZIERFIT_CHORDS;
            def.tolerance = tolerance;
            BezierFit *fit = make(points, NULL, 0, base, tip, def);
            check_tolerance(fit, points, tolerance);
            g_assert_true(fewest == 0 || fit->n <= fewest);
            fewest = fit->n;
            if (tolerance == 2.0)
                check_round_trip(fit, points, base, tip);
            bezierfit_free(fit);
        }
        g_array_unref(points);
    }
}

/* Teeth of a few pixels, from the boundary of pixels: short pieces through noise, which must not run to and fro. */
static void test_small_teeth(void)
{
    static const char *const files[] = {"toothed.svg", "poplar.svg", "sweetgum.svg"};
    for (uint32_t i = 0; i < 12; i++) {
        uint32_t base, tip;
        GArray *smooth = leaf_contour(files[i / 4], i % 2 ? 15.0 : 30.0, 400.0, &base, &tip),
               *points = staircase(contour(smooth), smooth->len);
        BezierFitDef def = bezierfit_def_default();
        def.rule = i / 2 % 2 ? BEZIERFIT_CONTOUR : BEZIERFIT_CHORDS;
        def.tolerance = 2.0;
        def.shortest = 6.0;
        base = nearest(points, vec2(0.0, 0.0));
        tip = nearest(points, vec2(0.0, 400.0));
        BezierFit *fit = make(points, NULL, 0, base, tip, def);
        g_assert_cmpfloat(fit->largest, <, 4.0);
        check_round_trip(fit, points, base, tip);
        bezierfit_free(fit);
        g_array_unref(smooth);
        g_array_unref(points);
    }
}

/* What is reported of each piece is what a plain search finds. */
static void test_report(void)
{
    uint32_t base, tip;
    GArray *points = leaf_contour("sweetgum.svg", 0.0, 150.0, &base, &tip);
    BezierFitDef def = contour_rule();
    def.tolerance = 2.0;
    BezierFit *fit = make(points, NULL, 0, base, tip, def);
    double sum = 0.0, whole = 0.0;
    for (uint32_t k = 0; k < fit->n; k++) {
        const BezierPiece *c = &fit->piece[k];
        GArray *run = g_array_new(FALSE, FALSE, sizeof(Vec2));
        for (uint32_t i = c->from;; i = (i + 1) % points->len) {
            g_array_append_val(run, contour(points)[i]);
            if (i == c->to)
                break;
        }
        double largest, mean, length = 0.0;
        plain_deviation(c->p, contour(run), run->len, &largest, &mean);
        CLOSE(c->largest, largest, 1e-3);
        CLOSE(c->mean, mean, 1e-3);
        for (guint i = 1; i < run->len; i++)
            length += vec_dist(contour(run)[i - 1], contour(run)[i]);
        sum += mean * length;
        whole += length;
        g_array_unref(run);
    }
    CLOSE(fit->mean, sum / whole, 1e-3);
    bezierfit_free(fit);
    g_array_unref(points);
}

/* The fit does not depend on which vertex comes first. */
static void test_turned(void)
{
    uint32_t base, tip;
    GArray *points = leaf_contour("toothed.svg", 0.0, 200.0, &base, &tip), *turned = g_array_new(FALSE, FALSE, sizeof(Vec2));
    const uint32_t n = points->len, by = n / 3, at[3] = {(base + 100) % n, (tip + 60) % n, base};
    g_array_append_vals(turned, contour(points) + by, n - by);
    g_array_append_vals(turned, contour(points), by);
    uint32_t moved[3];
    for (int i = 0; i < 3; i++)
        moved[i] = (at[2 - i] + n - by) % n;
    BezierFitDef def = contour_rule();
    def.tolerance = 1.0;
    BezierFit *a = make(points, at, 3, base, tip, def), *b = make(turned, moved, 3, (base + n - by) % n, (tip + n - by) % n, def);
    g_assert_cmpuint(a->n, ==, b->n);
    for (uint32_t k = 0; k < a->n; k++) {
        g_assert_cmpuint((a->piece[k].from + n - by) % n, ==, b->piece[k].from);
        g_assert_cmpuint((a->piece[k].farthest + n - by) % n, ==, b->piece[k].farthest);
        g_assert_cmpmem(a->piece[k].p, sizeof a->piece[k].p, b->piece[k].p, sizeof b->piece[k].p);
    }
    bezierfit_free(a);
    bezierfit_free(b);
    g_array_unref(points);
    g_array_unref(turned);
}

/* --- path data --- */

static void test_path(void)
{
    const Vec2 corner[4] = {{0, 0}, {1, 1.5}, {-0.00001, 3}, {-1, 1.5}};
    GArray *points = g_array_new(FALSE, FALSE, sizeof(Vec2));
    g_array_append_vals(points, corner, 4);
    const uint32_t at[2] = {1, 3};
    BezierFitDef def = bezierfit_def_default();
    def.cusp_angle = 0.0; /* all corners are cusps: straight pieces */
    BezierFit *fit = make(points, at, 2, 0, 2, def);
    char *path = bezierfit_path(fit, 3);
    g_assert_cmpstr(path, ==, "M0,0C0.333,0.5 0.667,1 1,1.5C0.667,2 0.333,2.5 0,3C-0.333,2.5 -0.667,2 -1,1.5C-0.667,1 -0.333,0.5 0,0Z");
    g_free(path);
    path = bezierfit_path(fit, 0);
    g_assert_cmpstr(path, ==, "M0,0C0,0 1,1 1,2C1,2 0,2 0,3C0,2 -1,2 -1,2C-1,1 0,0 0,0Z");
    g_free(path);
    path = bezierfit_path(fit, 15);
    SvgPath *read = svgpath_parse(path, NULL);
    g_assert_cmpuint(read->curves->len, ==, 4);
    for (guint k = 0; k < 4; k++)
        for (int i = 0; i < 4; i++)
            CLOSE(vec_dist(g_array_index(read->curves, Curve, k).p[i], fit->piece[k].p[i]), 0.0, 1e-14);
    g_assert_true(g_array_index(read->subpaths, Subpath, 0).closed);
    svgpath_free(read);
    g_free(path);
    bezierfit_free(fit);
    g_array_unref(points);
}

/* --- bad and degenerate input --- */

static void refuse(const Vec2 *v, uint32_t n, const uint32_t *at, uint32_t n_at, uint32_t base, uint32_t tip, BezierFitDef def,
                   BezierFitError code, const char *part)
{
    GError *error = NULL;
    g_assert_null(bezierfit_new(v, n, at, n_at, base, tip, &def, &error));
    g_assert_error(error, BEZIERFIT_ERROR, (int)code);
    if (!strstr(error->message, part))
        g_error("'%s' does not say '%s'", error->message, part);
    g_error_free(error);
}

static void test_refused(void)
{
    const BezierFitDef good = bezierfit_def_default();
    Vec2 v[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const uint32_t at[2] = {3, 4};
    refuse(v, 2, NULL, 0, 0, 1, good, BEZIERFIT_ERROR_CONTOUR, "2 points");
    refuse(v, 4, NULL, 0, 0, 0, good, BEZIERFIT_ERROR_CONTOUR, "points 0 and 0");
    refuse(v, 4, NULL, 0, 4, 0, good, BEZIERFIT_ERROR_CONTOUR, "points 4 and 0");
    refuse(v, 4, at, 2, 0, 2, good, BEZIERFIT_ERROR_CONTOUR, "point 4");
    const struct {
        double *value;
        double bad;
        const char *part;
    } cases[] = {{&(double){0}, -1.0, "tension"},
                 {&(double){0}, 181.0, "cusp angle"},
                 {&(double){0}, -1.0, "reach"},
                 {&(double){0}, (double)NAN, "tolerance"},
                 {&(double){0}, (double)INFINITY, "shortest"}};
    for (uint32_t k = 0; k < G_N_ELEMENTS(cases); k++) {
        BezierFitDef def = good;
        double *field[5] = {&def.tension, &def.cusp_angle, &def.reach, &def.tolerance, &def.shortest};
        *field[k] = cases[k].bad;
        refuse(v, 4, NULL, 0, 0, 2, def, BEZIERFIT_ERROR_SETTINGS, cases[k].part);
    }
    v[2].x = (double)NAN;
    refuse(v, 4, NULL, 0, 0, 2, good, BEZIERFIT_ERROR_CONTOUR, "point 2");
    v[0] = v[1] = v[2] = v[3] = vec2(5, 5);
    refuse(v, 4, NULL, 0, 0, 2, good, BEZIERFIT_ERROR_CONTOUR, "single point");
    bezierfit_free(NULL);
}

/* Few points, repeated points, points that run to and fro: a fit of finite numbers, whatever the rule. */
static void test_degenerate(void)
{
    for (uint32_t k = 0; k < 600; k++) {
        uint32_t n = 3 + random_block(3, 1, k, 0).w[0] % 40, at[5];
        GArray *points = g_array_new(FALSE, FALSE, sizeof(Vec2));
        for (uint32_t i = 0; i < n; i++) {
            Vec2 p = vec2(floor(4.0 * uniform(30, 64 * k + i)), k % 3 ? floor(4.0 * uniform(31, 64 * k + i)) : 0.0);
            if (i == n - 1)
                p = vec2(9, k % 2 ? 0.0 : 9.0); /* not all in one place */
            g_array_append_val(points, p);
        }
        for (uint32_t i = 0; i < 5; i++)
            at[i] = random_block(3, 2, k, i).w[0] % n;
        uint32_t base = random_block(3, 3, k, 0).w[0] % n, tip = (base + 1 + random_block(3, 3, k, 1).w[0] % (n - 1)) % n;
        BezierFitDef def = bezierfit_def_default();
        def.rule = k % 2 ? BEZIERFIT_CONTOUR : BEZIERFIT_CHORDS;
        def.tolerance = k % 5 ? 0.3 : 0.0;
        def.shortest = 0.1;
        BezierFit *fit = bezierfit_new(contour(points), n, at, 5, base, tip, &def, NULL);
        g_assert_nonnull(fit);
        g_assert_cmpuint(fit->n, <=, n);
        for (uint32_t i = 0; i < fit->n; i++)
            for (int j = 0; j < 4; j++)
                g_assert_true(fabs(fit->piece[i].p[j].x) < 1000.0 && fabs(fit->piece[i].p[j].y) < 1000.0);
        g_assert_true(fit->largest < 1000.0 && fit->mean <= fit->largest);
        bezierfit_free(fit);
        g_array_unref(points);
    }
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/bezierfit/cubic/recovered", test_cubic_recovered);
    g_test_add_func("/bezierfit/cubic/straight", test_cubic_straight);
    g_test_add_func("/bezierfit/cubic/least", test_cubic_least);
    g_test_add_func("/bezierfit/cubic/deviation", test_deviation);
    g_test_add_func("/bezierfit/recovered/outline", test_recovered_outline);
    g_test_add_func("/bezierfit/recovered/corners", test_recovered_corners);
    g_test_add_func("/bezierfit/circle", test_circle);
    g_test_add_func("/bezierfit/paper-rule", test_paper_rule);
    g_test_add_func("/bezierfit/teeth", test_teeth);
    g_test_add_func("/bezierfit/corners-found", test_corners_found);
    g_test_add_func("/bezierfit/corners-found/curved", test_curved_corners_found);
    g_test_add_func("/bezierfit/leaves", test_leaves);
    g_test_add_func("/bezierfit/small-teeth", test_small_teeth);
    g_test_add_func("/bezierfit/report", test_report);
    g_test_add_func("/bezierfit/turned", test_turned);
    g_test_add_func("/bezierfit/path", test_path);
    g_test_add_func("/bezierfit/refused", test_refused);
    g_test_add_func("/bezierfit/degenerate", test_degenerate);
    return g_test_run();
}
