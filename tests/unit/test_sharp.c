/* Drawn-out tips: wedges painted by exact coverage get their apex back, and nothing else is taken for a tip. */
#include <glib.h>
#include <math.h>

#include "geom/dtrig.h"
#include "geom/random.h"
#include "scan/profile.h"
#include "scan/sharp.h"

enum { SIZE = 160, GROUND = 245, LEAF = 70, SUB = 16 };

static double uniform(uint32_t stream, uint64_t index)
{
    double u[2];
    random_pair(17, stream, 0, index, u);
    return u[0];
}

static Vec2 polar(Vec2 c, double r, double degrees)
{
    double sine, cosine;
    dtrig_sin_cos(degrees * DTRIG_PI / 180.0, &sine, &cosine);
    return vec2(c.x + r * cosine, c.y + r * sine);
}

/* Mixes the leaf's grey in where the polygon covers a pixel, to `darkness`. */
static void paint(Scan *s, const Polygon *p, double darkness)
{
    for (uint32_t y = 0; y < s->height; y++)
        for (uint32_t x = 0; x < s->width; x++) {
            uint32_t n = 0;
            if (x + 1.0 < p->box.x0 || x > p->box.x1 || s->height - (double)y < p->box.y0 || s->height - (y + 1.0) > p->box.y1)
                continue;
            for (uint32_t k = 0; k < SUB * SUB; k++)
                n += polygon_contains(p, vec2(x + (k % SUB + 0.5) / SUB, s->height - y - (k / SUB + 0.5) / SUB));
            uint8_t *px = (uint8_t *)s->px + (gsize)y * s->width + x;
            *px = (uint8_t)(*px + (LEAF - *px) * darkness * n / (SUB * SUB) + 0.5);
        }
}

static Scan *sheet(void)
{
    Scan *s = scan_new(SIZE, SIZE, 1, 8);
    for (gsize i = 0; i < (gsize)SIZE * SIZE; i++)
        ((uint8_t *)s->px)[i] = GROUND;
    return s;
}

/* A round blade with one tip that opens by `opening` degrees, its apex at `apex` and its axis that way. */
static Polygon *drop(Vec2 apex, double degrees, double opening, double r)
{
    enum { N = 180 };
    double half = 0.5 * opening, sine, cosine;
    dtrig_sin_cos(half * DTRIG_PI / 180.0, &sine, &cosine);
    Vec2 v[N + 1], c = polar(apex, MIN(r / sine, 90.0), degrees + 180.0);
    double reach = vec_dist(apex, c), radius = reach * sine;
    v[0] = apex;
    for (uint32_t k = 0; k < N; k++)
        v[k + 1] = polar(c, radius, degrees + (90.0 - half) + (180.0 + opening) * k / (N - 1));
    return polygon_new(v, N + 1);
}

static void line(Scan *s, Vec2 a, Vec2 b, double width, double darkness)
{
    Vec2 d = vec_sub(b, a), n = vec_scale(vec2(-d.y, d.x), 0.5 * width / sqrt(vec_norm2(d)));
    const Vec2 v[4] = {vec_sub(a, n), vec_sub(b, n), vec_add(b, n), vec_add(a, n)};
    Polygon *p = polygon_new(v, 4);
    paint(s, p, darkness);
    polygon_free(p);
}

static const Threshold HALF = {.channel = CHANNEL_GREY, .dark = true, .level = 0.5 * (GROUND + LEAF)};

static Polygon *captured(const Scan *s, double open)
{
    GError *error = NULL;
    ProfileDef def = profile_def_default();
    def.threshold = (ThresholdDef){CHANNEL_GREY, LEAF_DARK, 0.5 * (GROUND + LEAF)};
    def.tolerance = 0.0;
    def.open = open;
    def.keep_stalk = true; /* needles are much like petioles */
    GPtrArray *all = profile_capture(s, &def, NULL, &error);
    g_assert_no_error(error);
    const Profile *p = all->pdata[0];
    Polygon *out = polygon_new(p->outline->v, p->outline->n);
    uint32_t i, j;
    g_assert_false(polygon_crossing(out, &i, &j));
    g_ptr_array_free(all, TRUE);
    return out;
}

/* How far an outline reaches beyond what is so. */
static double most_out(const Polygon *p, const Polygon *truth)
{
    double most = 0.0;
    for (uint32_t i = 0; i < p->n; i++)
        most = MAX(most, -polygon_depth(truth, p->v[i]));
    return most;
}

static double short_by(const Polygon *p, Vec2 apex) { return fabs(polygon_depth(p, apex)); }

/* The k-th of drops that lie this way and that. */
static Polygon *some_drop(uint32_t k, double opening, Vec2 *apex, Vec2 *axis)
{
    double degrees = 360.0 * uniform(3, k), turn = 40.0 * uniform(4, k) - 20.0;
    *apex = polar(vec2(80.0 + uniform(1, k), 80.0 + uniform(2, k)), 55.0, degrees);
    *axis = polar(vec2(0.0, 0.0), 1.0, degrees + turn);
    return drop(*apex, degrees + turn, opening, 25.0);
}

/* A needle that opens by 3 degrees loses 16 pixels without; what is thinner than an eighth of a pixel is but told by how it tapers. */
static void test_wedges(void)
{
    static const double opening[] = {3.0, 6.0, 10.0, 16.0, 25.0, 40.0, 60.0, 80.0};
    double worst[G_N_ELEMENTS(opening)] = {0}, out = 0.0;
    for (uint32_t k = 0; k < 6 * G_N_ELEMENTS(opening); k++) {
        uint32_t i = k % G_N_ELEMENTS(opening);
        Vec2 apex, axis;
        Polygon *truth = some_drop(k, opening[i], &apex, &axis);
        Scan *s = sheet();
        paint(s, truth, 1.0);
        Polygon *p = captured(s, 0.0);
        worst[i] = MAX(worst[i], short_by(p, apex));
        out = MAX(out, most_out(p, truth));
        polygon_free(p);
        polygon_free(truth);
        scan_free(s);
    }
    for (guint i = 0; i < G_N_ELEMENTS(opening); i++) {
        g_test_message("opening by %g degrees: apex within %.2f pixels", opening[i], worst[i]);
        g_assert_cmpfloat(worst[i], <, i == 0 ? 4.0 : 0.75);
    }
    g_test_message("outlines reach out by %.2f at most", out);
    g_assert_cmpfloat(out, <, 1.0);
}

static void add_noise(Scan *s, double sigma, uint32_t stream)
{
    for (gsize i = 0; i < (gsize)SIZE * SIZE; i++) {
        double v = -6.0;
        for (uint32_t k = 0; k < 12; k++)
            v += uniform(stream, 12 * i + k);
        uint8_t *px = (uint8_t *)s->px + i;
        *px = (uint8_t)CLAMP(*px + sigma * v + 0.5, 0.0, 255.0);
    }
}

/* The more noise the less is gained, but a tip is never longer than it is. */
static void test_noise(void)
{
    static const double sigma[] = {0.5, 1.0, 2.0, 4.0, 8.0, 16.0};
    for (guint i = 0; i < G_N_ELEMENTS(sigma); i++) {
        double lost = 0.0, plain = 0.0, out = 0.0;
        for (uint32_t k = 0; k < 8; k++) {
            Vec2 apex, axis;
            Polygon *truth = some_drop(50 + k, 6.0 + 6.0 * (k % 3), &apex, &axis);
            Scan *s = sheet();
            paint(s, truth, 1.0);
            add_noise(s, sigma[i], 20 + k);
            Polygon *p = captured(s, 0.0), *cut = captured(s, 0.1); /* an opening that takes off nothing */
            lost += short_by(p, apex) / 8.0;
            plain += short_by(cut, apex) / 8.0;
            out = MAX(out, vec_dot(vec_sub(polygon_nearest(p, vec_add(apex, vec_scale(axis, 30.0)), NULL), apex), axis));
            polygon_free(p);
            polygon_free(cut);
            polygon_free(truth);
            scan_free(s);
        }
        g_test_message("noise %g of %d: apex off by %.2f, without going on %.2f; beyond it %.2f at most", sigma[i], GROUND - LEAF, lost, plain, out);
        g_assert_cmpfloat(lost, <=, i < 3 ? 1.0 : plain + 0.01);
        g_assert_cmpfloat(out, <, 2.5);
    }
}

/* How far what is captured goes on beyond the apex. Frees the scan. */
static double beyond(Scan *s, Vec2 apex, Vec2 axis)
{
    Polygon *p = captured(s, 0.0);
    Vec2 far = vec_add(apex, vec_scale(axis, 30.0));
    double by = vec_dot(vec_sub(polygon_nearest(p, far, NULL), apex), axis);
    polygon_free(p);
    scan_free(s);
    return by;
}

static Scan *drop_on_sheet(const Polygon *truth)
{
    Scan *s = sheet();
    paint(s, truth, 1.0);
    return s;
}

/* Lines that go on where a tip ends, lines across it, and specks. */
static void test_clutter(void)
{
    double hair = 0.0, grid = 0.0, speck = 0.0;
    for (uint32_t k = 0; k < 12; k++) {
        Vec2 apex, axis;
        Polygon *truth = some_drop(100 + k, 6.0 + 4.0 * (k % 4), &apex, &axis);
        Scan *s = drop_on_sheet(truth);
        line(s, vec_sub(apex, vec_scale(axis, 8.0)), vec_add(apex, vec_scale(axis, 60.0)), 0.4, 1.0);
        hair = MAX(hair, beyond(s, apex, axis));
        s = drop_on_sheet(truth);
        for (double x = 4.3; x < SIZE; x += 12.0) {
            line(s, vec2(x, 0.0), vec2(x, SIZE), 1.0, 0.35);
            line(s, vec2(0.0, x), vec2(SIZE, x), 1.0, 0.35);
        }
        grid = MAX(grid, beyond(s, apex, axis));
        s = drop_on_sheet(truth);
        Vec2 side = vec_scale(vec2(-axis.y, axis.x), 3.0 * uniform(9, k) - 1.5);
        line(s, vec_add(vec_add(apex, side), vec_scale(axis, 1.0 + 3.0 * uniform(8, k))), vec_add(vec_add(apex, side), vec_scale(axis, 6.0)), 2.0, 0.9);
        speck = MAX(speck, beyond(s, apex, axis));
        polygon_free(truth);
    }
    g_test_message("beyond the apex: on along a hair %.2f, over a grid %.2f, to a speck %.2f", hair, grid, speck);
    g_assert_cmpfloat(hair, <, 0.5);
    g_assert_cmpfloat(grid, <, 1.0);
    g_assert_cmpfloat(speck, <, 1.0);
}

/* A blade that ends in a needle: what of it is petiole is not gone on into, and what an opening took off stays off. Vertices are found again. */
static void test_cut(void)
{
    Vec2 apex, axis;
    Polygon *truth = some_drop(200, 8.0, &apex, &axis);
    Scan *s = sheet();
    paint(s, truth, 1.0);
    Polygon *plain = captured(s, 0.1), *wide = captured(s, 2.0);
    uint8_t *px = g_new0(uint8_t, SIZE * SIZE);
    Mask m = {SIZE, SIZE, SIZE, px};
    uint32_t *at = g_new(uint32_t, plain->n), kept = 0;
    for (uint32_t i = 0; i < SIZE * SIZE; i++)
        px[i] = ((uint8_t *)s->px)[i] < HALF.level ? MASK_LEAF | MASK_THIS : 0;
    Polygon *p = sharp_ends(plain, s, &HALF, &m, MASK_STALK, at);
    g_assert_nonnull(p);
    g_assert_cmpfloat(short_by(plain, apex), >, 2.0);
    g_assert_cmpfloat(short_by(p, apex), <, 0.75);
    g_assert_cmpfloat(short_by(wide, apex), >, 8.0);
    g_assert_cmpuint(at[0], ==, 0);
    for (uint32_t i = 0; i < plain->n; i++) {
        g_assert_cmpuint(at[i], <, p->n);
        double moved = vec_dist(plain->v[i], p->v[at[i]]);
        g_assert_true(moved == 0.0 || vec_dist(p->v[at[i]], apex) < 0.75);
        kept += moved == 0.0;
    }
    g_assert_cmpuint(kept, >=, plain->n - 12);
    polygon_free(p);
    for (uint32_t i = 0; i < SIZE * SIZE; i++) { /* the same with its end for a petiole */
        Vec2 q = vec2(i % SIZE + 0.5, SIZE - i / SIZE - 0.5);
        px[i] |= vec_dist(q, apex) < short_by(plain, apex) ? MASK_STALK : 0;
    }
    g_assert_null(sharp_ends(plain, s, &HALF, &m, MASK_STALK, NULL));
    g_free(px);
    g_free(at);
    polygon_free(plain);
    polygon_free(wide);
    polygon_free(truth);
    scan_free(s);
}

/* Stars whose points lie close together, and blades that reach out of the image: nothing crosses. */
static void test_crowded(void)
{
    for (uint32_t k = 0; k < 24; k++) {
        enum { MOST = 120 };
        uint32_t n = 20 + 4 * k;
        Vec2 v[MOST], c = vec2(80.0 + 40.0 * (k % 3), 80.0);
        for (uint32_t i = 0; i < n; i++)
            v[i] = polar(c, i % 2 ? 35.0 : 60.0 + 12.0 * uniform(30 + k, i), 360.0 * (i + 0.4 * uniform(60 + k, i)) / n);
        Polygon *truth = polygon_new(v, n);
        Scan *s = sheet();
        paint(s, truth, 1.0);
        Polygon *p = captured(s, 0.0); /* asserts so */
        g_assert_cmpfloat(most_out(p, truth), <, 2.0);
        polygon_free(p);
        polygon_free(truth);
        scan_free(s);
    }
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/sharp/wedges", test_wedges);
    g_test_add_func("/sharp/noise", test_noise);
    g_test_add_func("/sharp/clutter", test_clutter);
    g_test_add_func("/sharp/cut", test_cut);
    g_test_add_func("/sharp/crowded", test_crowded);
    return g_test_run();
}
