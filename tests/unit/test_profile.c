/* From images to outlines: masks against brute force, and drawn leaves whose answers are known. Real scans are in test_references.c. */
#include <glib.h>
#include <math.h>
#include <string.h>

#include "geom/random.h"
#include "geom/ring.h"
#include "scan/axis.h"
#include "scan/mask.h"
#include "scan/fill.h"
#include "scan/profile.h"
#include "scan/stalk.h"

#define PI 3.14159265358979

static double uniform(uint32_t stream, uint64_t index)
{
    double u[2];
    random_pair(13, stream, 0, index, u);
    return u[0];
}

/* Masks */

enum { W = 41, H = 33 };

static Mask noise_mask(uint8_t *px, uint32_t stream, double share)
{
    for (uint32_t i = 0; i < W * H; i++)
        px[i] = (uint8_t)((uniform(stream, i) < share ? MASK_LEAF : 0) | MASK_OUT);
    return (Mask){W, H, W, px};
}

static void test_morphology(void)
{
    uint8_t px[W * H], eroded[W * H], dilated[W * H];
    for (uint32_t k = 0; k < 24; k++) {
        double r = 0.5 * k, r2 = r * r;
        Mask m = noise_mask(px, 100 + k, k < 8 ? 0.9 : 0.98);
        memset(eroded, 0, sizeof eroded);
        memset(dilated, 0, sizeof dilated);
        for (int i = 0; i < W * H; i++) {
            bool in = true, out = false;
            for (int j = 0; j < W * H; j++) {
                double dx = i % W - j % W, dy = i / W - j / W;
                in &= dx * dx + dy * dy > r2 || (px[j] & MASK_LEAF);
                out |= dx * dx + dy * dy <= r2 && !(px[j] & MASK_LEAF);
            }
            eroded[i] = in;
            dilated[i] = out; /* of the background */
        }
        mask_erode(&m, MASK_LEAF, MASK_CORE, r);
        for (int i = 0; i < W * H; i++) {
            g_assert_cmpint((px[i] & MASK_CORE) != 0, ==, eroded[i]);
            g_assert_true(px[i] & MASK_OUT);
            px[i] ^= MASK_LEAF;
        }
        mask_dilate(&m, MASK_LEAF, MASK_LEAF, r); /* in place */
        for (int i = 0; i < W * H; i++)
            g_assert_cmpint((px[i] & MASK_LEAF) != 0, ==, dilated[i]);
    }
}

/* Component of every pixel by repeated relabelling. */
static void label_parts(const uint8_t *px, uint32_t *label)
{
    for (uint32_t i = 0; i < W * H; i++)
        label[i] = px[i] & MASK_LEAF ? i : UINT32_MAX;
    for (bool changed = true; changed;) {
        changed = false;
        for (int i = 0; i < W * H; i++)
            for (int k = 0; k < 9 && label[i] != UINT32_MAX; k++) {
                int x = i % W + k % 3 - 1, y = i / W + k / 3 - 1, j = y * W + x;
                if (x >= 0 && y >= 0 && x < W && y < H && label[j] < label[i]) {
                    label[i] = label[j];
                    changed = true;
                }
            }
    }
}

static void test_components(void)
{
    uint8_t px[W * H];
    uint32_t label[W * H];
    for (uint32_t k = 0; k < 20; k++) {
        Mask m = noise_mask(px, 200 + k, 0.15 + 0.015 * k);
        label_parts(px, label);
        GArray *parts = mask_components(&m, 0.0);
        uint64_t total = 0;
        for (guint c = 0; c < parts->len; c++) {
            Component *p = &g_array_index(parts, Component, c);
            uint64_t n = 0;
            MaskBox b = {W, H, 0, 0};
            for (uint32_t i = 0; i < W * H; i++)
                if (label[i] == p->y * W + p->x) {
                    n++;
                    b = (MaskBox){MIN(b.x0, i % W), MIN(b.y0, i / W), MAX(b.x1, i % W), MAX(b.y1, i / W)};
                }
            g_assert_cmpuint(p->area, ==, n);
            g_assert_true(!memcmp(&b, &p->box, sizeof b));
            g_assert_true(c == 0 || p->area <= g_array_index(parts, Component, c - 1).area);
            total += n;
        }
        uint64_t leaf = 0;
        for (uint32_t i = 0; i < W * H; i++)
            leaf += label[i] != UINT32_MAX;
        g_assert_cmpuint(total, ==, leaf);
        g_array_free(parts, TRUE);
    }
}

static void test_share_and_edging(void)
{
    uint8_t px[W * H] = {0};
    Mask m = {W, H, W, px};
    for (uint32_t i = 0; i < 20; i++)
        px[(5 + i / 5) * W + 5 + i % 5] = px[(15 + i / 10) * W + 20 + i % 10] = MASK_LEAF; /* 20 pixels each */
    px[30 * W + 30] = MASK_LEAF;
    GArray *parts = mask_components(&m, 0.06);
    g_assert_cmpuint(parts->len, ==, 2);
    g_assert_cmpuint(g_array_index(parts, Component, 0).y, ==, 5); /* of equals the upper */
    g_array_free(parts, TRUE);
    enum { S = 200 };
    uint8_t *big = g_new0(uint8_t, S * S);
    Mask n = {S, S, S, big};
    for (uint32_t i = 0; i < S; i++)
        for (uint32_t t = 0; t < 3; t++)
            big[i * S + t] = big[(S - 1 - t) * S + i] = MASK_LEAF; /* an edging of 1200 pixels */
    for (uint32_t i = 0; i < 400; i++)
        big[(50 + i / 20) * S + 50 + i % 20] = MASK_LEAF;
    parts = mask_components(&n, 0.05);
    g_assert_cmpuint(parts->len, ==, 1);
    g_assert_cmpuint(g_array_index(parts, Component, 0).area, ==, 400);
    g_array_free(parts, TRUE);
    g_free(big);
}

static void test_widest(void)
{
    for (uint32_t n = 20; n <= 2000; n = n * 3 / 2) {
        uint8_t *px = g_new0(uint8_t, (gsize)n * n);
        Mask m = {n, n, n, px};
        double r = 0.4 * n;
        for (uint32_t i = 0; i < n * n; i++)
            px[i] = hypot(i % n - 0.5 * n, (double)(i / n) - 0.5 * n) <= r ? MASK_THIS : 0;
        g_assert_cmpfloat(fabs(mask_widest(&m, MASK_THIS) - r), <=, 0.08 * r + 2.0);
        g_free(px);
    }
}

/* Simplification of closed curves */

/* A comb, a zigzag and a spiral: narrow gaps that simplification would close. Vertices close together, as a trace has them. */
static Polygon *narrow_shape(uint32_t kind, uint32_t n)
{
    GArray *v = g_array_new(FALSE, FALSE, sizeof(Vec2));
    if (kind == 0) { /* teeth 2 wide, 2 apart, on a ridge */
        for (uint32_t i = 0; i < n; i++) {
            const Vec2 tooth[] = {{4.0 * i, 20.0}, {4.0 * i, 0.7 * (i % 5)}, {4.0 * i + 2, 0.5 * (i % 3)}, {4.0 * i + 2, 20.0}};
            g_array_append_vals(v, tooth, 4);
        }
        const Vec2 ridge[] = {{4.0 * n, 25.0}, {0.0, 25.0}};
        g_array_append_vals(v, ridge, 2);
    } else { /* two arms of a spiral, 3 wide, 3 apart */
        for (uint32_t side = 0; side < 2; side++)
            for (uint32_t i = 0; i <= n; i++) {
                double t = 0.2 * (side ? n - i : i), r = 4.0 + 6.0 * t / (2.0 * PI) + (side ? 0.0 : 3.0) + 0.5 * uniform(kind, i + 1000 * side);
                Vec2 p = vec2(r * cos(t), r * sin(t));
                g_array_append_val(v, p);
            }
    }
    GArray *fine = g_array_new(FALSE, FALSE, sizeof(Vec2));
    for (guint i = 0; i < v->len; i++) {
        Vec2 a = g_array_index(v, Vec2, i), b = g_array_index(v, Vec2, (i + 1) % v->len);
        int steps = 1 + (int)vec_dist(a, b);
        for (int k = 0; k < steps; k++) {
            Vec2 p = vec_lerp(a, b, (double)k / steps);
            g_array_append_val(fine, p);
        }
    }
    Polygon *p = polygon_new((Vec2 *)(void *)fine->data, fine->len);
    g_array_free(fine, TRUE);
    g_array_free(v, TRUE);
    return p;
}

static void check_ring(const Polygon *p, double tolerance, uint32_t fixed)
{
    bool *must = g_new0(bool, p->n);
    must[fixed] = true;
    Polygon *q = ring_simplify(p, tolerance, must);
    uint32_t i, j, at = 0;
    bool has_fixed = false;
    g_assert_cmpuint(q->n, >=, 3);
    g_assert_false(polygon_crossing(q, &i, &j));
    for (uint32_t k = 0; k < q->n; k++) { /* a part of its vertices, in order, from the same first one */
        while (at < p->n && vec_dist2(p->v[at], q->v[k]) > 0.0)
            at++;
        g_assert_cmpuint(at, <, p->n);
        g_assert_true(k > 0 || at == 0);
        has_fixed |= at == fixed;
    }
    g_assert_true(has_fixed);
    if (tolerance == 0.0)
        g_assert_cmpuint(q->n, ==, p->n);
    polygon_free(q);
    g_free(must);
}

static void test_ring(void)
{
    static const double tolerances[] = {0.0, 0.01, 0.5, 1.0, 2.0, 3.5, 8.0, 30.0, 1000.0};
    for (uint32_t kind = 0; kind < 5; kind++)
        for (uint32_t k = 0; k < G_N_ELEMENTS(tolerances); k++) {
            Polygon *p = narrow_shape(kind, 60);
            uint32_t i, j;
            g_assert_false(polygon_crossing(p, &i, &j));
            check_ring(p, tolerances[k], p->n / 3);
            polygon_free(p);
        }
    const Vec2 triangle[] = {{0, 0}, {5, 0}, {0, 5}};
    Polygon *t = polygon_new(triangle, 3);
    check_ring(t, 100.0, 1);
    g_assert_cmpfloat(fabs(ring_length(t) - 10.0 - sqrt(50.0)), <=, 1e-12);
    polygon_free(t);
}

/* Within the tolerance where nothing had to be put back. */
static void test_ring_tolerance(void)
{
    enum { N = 500 };
    Vec2 v[N];
    for (uint32_t i = 0; i < N; i++) {
        double r = 100.0 + 4.0 * uniform(50, i) + 20.0 * sin(5 * 2.0 * PI * i / N);
        v[i] = vec2(r * cos(2.0 * PI * i / N), r * sin(2.0 * PI * i / N));
    }
    Polygon *p = polygon_new(v, N);
    uint32_t before = N;
    for (double tolerance = 0.5; tolerance <= 16.0; tolerance *= 2.0) {
        Polygon *q = ring_simplify(p, tolerance, NULL);
        for (uint32_t i = 0; i < N; i++)
            g_assert_cmpfloat(vec_dist(polygon_nearest(q, v[i], NULL), v[i]), <, tolerance * 1.5); /* chords' lines, not the chords */
        g_assert_cmpuint(q->n, <=, before);
        before = q->n;
        polygon_free(q);
    }
    g_assert_cmpuint(before, <, 30);
    polygon_free(p);
}

/* Drawn leaves */

static const uint8_t GREEN[3] = {62, 108, 48}, WHITE[3] = {246, 245, 242};

static Scan *paper(uint32_t w, uint32_t h)
{
    Scan *s = scan_new(w, h, 3, 8);
    g_assert_nonnull(s);
    for (gsize i = 0; i < (gsize)w * h * 3; i++)
        ((uint8_t *)s->px)[i] = WHITE[i % 3];
    return s;
}

static void blend(Scan *s, uint32_t x, uint32_t y, const uint8_t *colour, double share)
{
    uint8_t *px = (uint8_t *)s->px + ((gsize)y * s->width + x) * 3;
    for (int c = 0; c < 3; c++)
        px[c] = (uint8_t)(px[c] + (colour[c] - px[c]) * share + 0.5);
}

/* Fills a polygon given in y-up pixel units, soft at its edge. */
static void fill(Scan *s, const Vec2 *v, uint32_t n, const uint8_t *colour)
{
    enum { FINE = 4 };
    Polygon *p = polygon_new(v, n);
    for (uint32_t y = 0; y < s->height; y++)
        for (uint32_t x = 0; x < s->width; x++) {
            if (!box_has(box_grow(p->box, 1.0), vec2(x + 0.5, s->height - y - 0.5)))
                continue;
            int in = 0;
            for (int k = 0; k < FINE * FINE; k++)
                in += polygon_contains(p, vec2(x + (k % FINE + 0.5) / FINE, s->height - y - (k / FINE + 0.5) / FINE));
            blend(s, x, y, colour, (double)in / (FINE * FINE));
        }
    polygon_free(p);
}

static void fill_ellipse(Scan *s, Vec2 c, double a, double b, const uint8_t *colour)
{
    enum { N = 256 };
    Vec2 v[N];
    for (int i = 0; i < N; i++)
        v[i] = vec2(c.x + a * cos(2.0 * PI * i / N), c.y + b * sin(2.0 * PI * i / N));
    fill(s, v, N, colour);
}

static GPtrArray *capture_ok(const Scan *s, const ProfileDef *def)
{
    GError *error = NULL;
    GPtrArray *a = profile_capture(s, def, NULL, &error);
    g_assert_no_error(error);
    g_assert_nonnull(a);
    for (guint i = 0; i < a->len; i++) {
        const Profile *p = a->pdata[i];
        uint32_t k, m;
        g_assert_false(polygon_crossing(p->outline, &k, &m));
        g_assert_true(p->outline->box.x0 >= 0.0 && p->outline->box.y0 >= 0.0 && p->outline->box.x1 <= s->width && p->outline->box.y1 <= s->height);
        double twice = 0.0;
        for (k = 0; k < p->outline->n; k++)
            twice += vec_cross(p->outline->v[k], p->outline->v[(k + 1) % p->outline->n]);
        g_assert_cmpfloat(twice, >, 0.0);
        g_assert_true(p->beyond >= 0.0 && p->beyond <= p->area + p->perimeter);
    }
    return a;
}

static void capture_fails(const Scan *s, const ProfileDef *def, int code, const char *says)
{
    GError *error = NULL;
    g_assert_null(profile_capture(s, def, NULL, &error));
    g_assert_error(error, SCAN_ERROR, code);
    if (!strstr(error->message, says))
        g_error("'%s' is not in '%s'", says, error->message);
    g_error_free(error);
}

static void assert_close(Vec2 a, Vec2 b, double within)
{
    if (!(vec_dist(a, b) <= within))
        g_error("(%g, %g) is %g from (%g, %g)", a.x, a.y, vec_dist(a, b), b.x, b.y);
}

/* A leaf along +y from (0, 0) to (0, 1): round at its base, pointed at its tip, with teeth. */
static uint32_t ovate(Vec2 *v, uint32_t n, double width, double teeth)
{
    for (uint32_t i = 0; i < n; i++) {
        double t = (double)i / n, x = 1.3 * width * sqrt(t) * (1.0 - t) + (i % 8 < 6 ? i % 8 : 0) * teeth * t * (1.0 - t);
        v[i] = vec2(x, t);
        v[2 * n - i] = vec2(-x, t);
    }
    v[n] = vec2(0.0, 1.0);
    return 2 * n - 1; /* v[0] is the base; v[2 n] would be it again */
}

/* Turns by the angle, enlarges and moves. */
static void place(Vec2 *v, uint32_t n, double degrees, double size, Vec2 to)
{
    double c = cos(degrees * PI / 180.0), s = sin(degrees * PI / 180.0);
    for (uint32_t i = 0; i < n; i++)
        v[i] = vec_add(to, vec_scale(vec2(c * v[i].x - s * v[i].y, s * v[i].x + c * v[i].y), size));
}

/* Leaves in all directions, with a petiole that is straight, or bent, or ends in a knob: found, cut where the blade begins; and kept. */
static void test_stalk(void)
{
    enum { N = 64 };
    for (int k = 0; k < 30; k++) {
        double degrees = 12.0 * k, half = 0.008 + 0.004 * (k % 4), length = 0.15 + 0.07 * (k % 6), size = 300.0;
        bool bent = k % 3 == 1, knob = k % 3 == 2;
        Scan *s = paper(800, 800);
        Vec2 v[2 * N + 1], to = vec2(400.0 + 150.0 * sin(degrees * PI / 180.0), 400.0 - 150.0 * cos(degrees * PI / 180.0));
        Vec2 stalk[] = {{-half, 0.02}, {-half, -0.5 * length}, {bent ? 0.06 : -half, -length}, {bent ? 0.06 + 2.0 * half : half, -length},
                        {half, -0.5 * length}, {half, 0.02}};
        Vec2 end = vec2(bent ? 0.06 + half : 0.0, -length), base = vec2(0.0, 0.0);
        uint32_t n = ovate(v, N, 0.6, k % 2 ? 0.02 : 0.0);
        place(v, 2 * N, degrees, size, to);
        place(stalk, 6, degrees, size, to);
        place(&end, 1, degrees, size, to);
        place(&base, 1, degrees, size, to);
        fill(s, v, n, GREEN);
        Polygon *blade = polygon_new(v, n);
        fill(s, stalk, 6, GREEN);
        if (knob)
            fill_ellipse(s, end, 1.8 * half * size, 1.8 * half * size, GREEN);
        ProfileDef def = profile_def_default();
        GPtrArray *a = capture_ok(s, &def);
        const Profile *p = a->pdata[0];
        g_assert_true(p->has_stalk);
        g_assert_cmpint(p->base_from, ==, BASE_STALK);
        assert_close(p->base, base, 4.0 + 2.0 * half * size);
        assert_close(p->base, p->outline->v[0], 1e-9);
        assert_close(p->tip, v[N], 5.0);
        assert_close(p->stalk_end, end, 4.0 + (knob ? 4.0 : 2.0) * half * size);
        g_assert_cmpfloat(fabs(p->stalk_width - 2.0 * half * size), <=, 1.0 + 0.2 * 2.0 * half * size);
        g_assert_cmpfloat(fabs(p->stalk_length - length * size), <=, 4.0 + 0.12 * length * size);
        g_assert_cmpfloat(fabs(p->area / blade->area - 1.0), <=, 0.01);
        g_assert_cmpfloat(p->symmetry, >, 0.9);
        def.keep_stalk = true;
        GPtrArray *b = capture_ok(s, &def);
        const Profile *q = b->pdata[0];
        g_assert_cmpfloat(q->area, >, p->area + 0.7 * length * 2.0 * half * size * size);
        assert_close(q->outline->v[0], end, 3.0 + (knob ? 4.0 : 2.0) * half * size);
        assert_close(q->base, base, 4.0 + 2.0 * half * size);
        assert_close(q->tip, p->tip, 1e-9);
        polygon_free(blade);
        g_ptr_array_free(a, TRUE);
        g_ptr_array_free(b, TRUE);
        scan_free(s);
    }
}

/* No petiole: the round end is the base, teeth and tips are no stalks. */
static void test_no_stalk(void)
{
    enum { N = 64 };
    for (int k = 0; k < 12; k++) {
        Scan *s = paper(500, 500);
        Vec2 v[2 * N + 1], to = vec2(250.0 + 180.0 * sin(30.0 * k * PI / 180.0), 250.0 - 180.0 * cos(30.0 * k * PI / 180.0));
        uint32_t n = ovate(v, N, 0.5, k % 2 ? 0.025 : 0.0);
        place(v, 2 * N, 30.0 * k, 360.0, to);
        fill(s, v, n, GREEN);
        ProfileDef def = profile_def_default();
        GPtrArray *a = capture_ok(s, &def);
        const Profile *p = a->pdata[0];
        g_assert_false(p->has_stalk);
        g_assert_cmpint(p->base_from, ==, BASE_AXIS);
        assert_close(p->base, v[0], 12.0);
        assert_close(p->tip, v[N], 5.0);
        g_ptr_array_free(a, TRUE);
        scan_free(s);
    }
}

/* A petiole bent over the blade, whose end looks out at a side: cut off, but no base. */
static void test_bent_stalk(void)
{
    enum { N = 64 };
    Scan *s = paper(400, 400);
    Vec2 v[2 * N + 1], stub[4] = {{0.2, 0.38}, {0.55, 0.38}, {0.55, 0.42}, {0.2, 0.42}};
    uint32_t n = ovate(v, N, 0.7, 0.0);
    place(v, 2 * N, 0.0, 300.0, vec2(200, 50));
    place(stub, 4, 0.0, 300.0, vec2(200, 50));
    fill(s, v, n, GREEN);
    fill(s, stub, 4, GREEN);
    ProfileDef def = profile_def_default();
    GPtrArray *a = capture_ok(s, &def);
    const Profile *p = a->pdata[0];
    g_assert_true(p->has_stalk);
    assert_close(p->stalk_end, vec2(365, 170), 8.0);
    g_assert_cmpfloat(p->outline->box.x1, <, 330.0);
    g_assert_cmpint(p->base_from, ==, BASE_AXIS);
    assert_close(p->base, v[0], 8.0);
    assert_close(p->tip, v[N], 5.0);
    g_ptr_array_free(a, TRUE);
    scan_free(s);
}

/* A petiole of which the threshold has but one side: the base is where its middle meets the blade all the same. */
static void test_pale_side(void)
{
    enum { N = 64 };
    static const uint8_t PALE[3] = {190, 170, 160};
    for (int side = -1; side <= 1; side += 2) {
        Scan *s = paper(500, 500);
        Vec2 v[2 * N + 1], petiole[] = {{-0.024, 0.03}, {-0.024, -0.25}, {0.024, -0.25}, {0.024, 0.03}};
        Vec2 dark[] = {{side * 0.008, 0.03}, {side * 0.008, -0.25}, {side * 0.024, -0.25}, {side * 0.024, 0.03}};
        uint32_t n = ovate(v, N, 0.7, 0.0);
        place(v, 2 * N, 0.0, 350.0, vec2(250, 120));
        place(petiole, 4, 0.0, 350.0, vec2(250, 120));
        place(dark, 4, 0.0, 350.0, vec2(250, 120));
        fill(s, petiole, 4, PALE);
        fill(s, dark, 4, GREEN);
        fill(s, v, n, GREEN);
        ProfileDef def = profile_def_default();
        def.threshold.channel = CHANNEL_RED;
        GPtrArray *a = capture_ok(s, &def);
        const Profile *p = a->pdata[0];
        g_assert_true(p->has_stalk);
        g_assert_cmpint(p->base_from, ==, BASE_STALK);
        g_assert_cmpfloat(fabs(p->base.x - 250.0), <, 2.0); /* the dark side's middle is 5.6 pixels off */
        g_ptr_array_free(a, TRUE);
        scan_free(s);
    }
}

/* A petiole bent over the blade, as pale as paper there: the outline is that of the blade without it, by a twin; its colour is nothing that is left by scan_fill. */
static void test_over(void)
{
    enum { N = 64 };
    static const uint8_t PINK[3] = {190, 160, 140}, BROWN[3] = {150, 125, 105}; /* the blade hangs together below its end, which is darker */
    Profile *of[2];
    GPtrArray *all[2];
    for (int k = 0; k < 2; k++) {
        Scan *s = paper(500, 500);
        Vec2 v[2 * N + 1], stick[] = {{-0.02, 0.0}, {0.02, 0.07}, {0.55, 0.30}, {0.535, 0.335}, {-0.01, 0.105}, {-0.045, 0.02}};
        Vec2 end[] = {{0.25, 0.17}, {0.55, 0.30}, {0.535, 0.335}, {0.235, 0.208}};
        uint32_t n = ovate(v, N, 0.7, 0.0);
        place(v, 2 * N, 0.0, 400.0, vec2(230, 50));
        place(stick, 6, 0.0, 400.0, vec2(230, 50));
        place(end, 4, 0.0, 400.0, vec2(230, 50));
        fill(s, v, n, GREEN);
        if (k == 1) {
            fill(s, stick, 6, PINK);
            fill(s, end, 4, BROWN);
        }
        ProfileDef def = profile_def_default();
        def.has_base = true; /* with the slit it is no symmetric leaf, and veins that would tell it has none */
        def.base = v[0];
        all[k] = capture_ok(s, &def);
        of[k] = all[k]->pdata[0];
        if (k == 1) {
            Threshold t;
            g_assert_true(threshold_find(s, &def.threshold, &t, NULL));
            scan_fill(s, of[k]->outline, &t, 3.0, 4);
            for (uint32_t i = 0; i < 20; i++) {
                Vec2 q = vec_lerp(vec2(270, 92), vec2(350, 127), i / 19.0);
                uint32_t y = (uint32_t)(s->height - q.y);
                if (!polygon_contains(of[k]->outline, q))
                    continue;
                g_assert_cmpfloat(fabs((double)scan_sample(s, (uint32_t)q.x, y, 0) - GREEN[0]), <, 12.0);
                g_assert_cmpfloat(fabs((double)scan_sample(s, (uint32_t)q.x, y, 2) - GREEN[2]), <, 12.0);
            }
        }
        scan_free(s);
    }
    g_assert_false(of[0]->has_stalk);
    g_assert_true(of[1]->has_stalk);
    g_assert_cmpfloat(fabs(of[1]->area / of[0]->area - 1.0), <, 0.01);
    g_assert_cmpfloat(fabs(of[1]->perimeter / of[0]->perimeter - 1.0), <, 0.03);
    assert_close(of[1]->base, of[0]->base, 8.0);
    assert_close(of[1]->stalk_end, vec2(447, 177), 12.0);
    g_ptr_array_free(all[0], TRUE);
    g_ptr_array_free(all[1], TRUE);
}

/* Two round lobes beside a notch: the notch is the base. */
static void test_sinus(void)
{
    for (int k = 0; k < 8; k++) {
        Scan *s = paper(400, 400);
        double degrees = 45.0 * k;
        Vec2 c[3] = {{-0.45, 0.0}, {0.45, 0.0}, {0.0, 0.0}}, v[3] = {{-0.93, 0.15}, {0.93, 0.15}, {0.0, 1.3}};
        place(c, 3, degrees, 120.0, vec2(200, 200));
        place(v, 3, degrees, 120.0, vec2(200, 200));
        Vec2 notch = vec2(0.0, -0.218), tip = v[2];
        place(&notch, 1, degrees, 120.0, vec2(200, 200));
        fill_ellipse(s, c[0], 60.0, 60.0, GREEN);
        fill_ellipse(s, c[1], 60.0, 60.0, GREEN);
        fill(s, v, 3, GREEN);
        ProfileDef def = profile_def_default();
        GPtrArray *a = capture_ok(s, &def);
        const Profile *p = a->pdata[0];
        g_assert_cmpint(p->base_from, ==, BASE_AXIS);
        assert_close(p->base, notch, 25.0);
        assert_close(p->tip, tip, 6.0);
        g_ptr_array_free(a, TRUE);
        scan_free(s);
    }
}

static void test_several(void)
{
    Scan *s = paper(600, 300);
    fill_ellipse(s, vec2(120, 150), 80, 50, GREEN);
    fill_ellipse(s, vec2(300, 220), 60, 40, GREEN);
    fill_ellipse(s, vec2(480, 100), 90, 60, GREEN);
    for (int i = 0; i < 40; i++)
        fill_ellipse(s, vec2(15.0 * i + 4.0, i % 2 ? 290.0 : 12.0), 2.0 + i % 3, 2.0, GREEN);
    s->mm_per_pixel = 0.1;
    ProfileDef def = profile_def_default();
    GPtrArray *a = capture_ok(s, &def);
    g_assert_cmpuint(a->len, ==, 1);
    assert_close(polygon_centroid(((Profile *)a->pdata[0])->outline), vec2(480, 100), 0.5);
    g_ptr_array_free(a, TRUE);
    def.each = true;
    a = capture_ok(s, &def);
    g_assert_cmpuint(a->len, ==, 3);
    const double area[] = {PI * 90 * 60, PI * 80 * 50, PI * 60 * 40}, x[] = {480, 120, 300}, y[] = {100, 150, 220};
    for (guint i = 0; i < 3; i++) {
        const Profile *p = a->pdata[i];
        g_assert_cmpfloat(fabs(p->area / area[i] - 1.0), <=, 0.002);
        assert_close(polygon_centroid(p->outline), vec2(x[i], y[i]), 0.5);
        g_assert_cmpfloat(p->mm_per_pixel, ==, 0.1);
    }
    g_ptr_array_free(a, TRUE);
    def.least_area = 0.0;
    a = capture_ok(s, &def);
    g_assert_cmpuint(a->len, ==, 43);
    g_ptr_array_free(a, TRUE);
    def.square = 16; /* steps over many specks */
    a = capture_ok(s, &def);
    g_assert_cmpuint(a->len, >=, 3);
    g_assert_cmpuint(a->len, <, 43);
    g_ptr_array_free(a, TRUE);
    def.has_base = true;
    capture_fails(s, &def, SCAN_ERROR_VALUE, "not when each leaf is captured");
    scan_free(s);
}

/* A disc cut by the frame at a side and at a corner. */
static void test_frame(void)
{
    for (int corner = 0; corner < 2; corner++)
        for (uint32_t square = 1; square <= 16; square += 5) {
            Scan *s = paper(301, 203);
            fill_ellipse(s, vec2(0, corner ? 0 : 100), 80, 80, GREEN);
            ProfileDef def = profile_def_default();
            def.square = square;
            def.tolerance = 0.0;
            GPtrArray *a = capture_ok(s, &def);
            const Profile *p = a->pdata[0];
            double area = PI * 80 * 80 / (corner ? 4 : 2);
            g_assert_cmpfloat(fabs(p->area / area - 1.0), <=, 0.002 + 0.003 * square);
            g_assert_cmpfloat(p->outline->box.x0, ==, 0.0);
            g_ptr_array_free(a, TRUE);
            scan_free(s);
        }
}

static void test_nothing(void)
{
    ProfileDef def = profile_def_default();
    static const uint8_t shades[] = {0, 255, 128};
    for (uint32_t k = 0; k < 3; k++)
        for (uint32_t size = 1; size <= 50; size += 49) {
            Scan *s = scan_new(size, size, 3, 8);
            memset(s->px, shades[k], (gsize)size * size * 3);
            capture_fails(s, &def, SCAN_ERROR_NO_LEAF, "no leaf");
            def.threshold.level = 100.0;
            capture_fails(s, &def, SCAN_ERROR_NO_LEAF, "no leaf");
            def.threshold.level = -1.0;
            scan_free(s);
        }
    Scan *s = scan_new(30, 20, 1, 8); /* all leaf, if one insists */
    def.threshold = (ThresholdDef){CHANNEL_GREY, LEAF_DARK, 100.0};
    GPtrArray *a = capture_ok(s, &def);
    g_assert_cmpfloat(((Profile *)a->pdata[0])->area, ==, 30 * 20 - 0.5);
    g_ptr_array_free(a, TRUE);
    scan_free(s);
    for (uint32_t n = 1; n <= 6; n++) { /* leaves of few pixels */
        s = paper(9, 9);
        for (uint32_t i = 0; i < n; i++)
            blend(s, 3 + i % 3, 4 + i / 3, GREEN, 1.0);
        def = profile_def_default();
        def.tolerance = 0.25 * n;
        a = capture_ok(s, &def);
        g_assert_cmpfloat(((Profile *)a->pdata[0])->area, >, 0.0);
        g_ptr_array_free(a, TRUE);
        def.square = 8;
        capture_fails(s, &def, SCAN_ERROR_NO_LEAF, "squares of 8 pixels step over");
        scan_free(s);
    }
}

static void test_settings_refused(void)
{
    Scan *s = paper(60, 60);
    fill_ellipse(s, vec2(30, 30), 20, 15, GREEN);
    struct {
        ProfileDef def;
        const char *says;
    } bad[7];
    for (int i = 0; i < 7; i++)
        bad[i].def = profile_def_default();
    bad[0].def.square = 0, bad[0].says = "square size 0: allowed are 1";
    bad[1].def.tolerance = -1.0, bad[1].says = "tolerance -1";
    bad[2].def.close = (double)NAN, bad[2].says = "closing radius nan";
    bad[3].def.open = -0.5, bad[3].says = "opening radius -0.5";
    bad[4].def.least_area = 2.0, bad[4].says = "least area 2: allowed are 0 … 1";
    bad[5].def.has_base = true, bad[5].def.base = vec2(200, 30), bad[5].says = "scan.base 200,30 lies 150 pixels outside the leaf, which spans x 10 … 50, y 15";
    bad[6].def.has_tip = true, bad[6].def.tip = vec2(30, -70), bad[6].says = "scan.tip 30,130 lies 85 pixels outside";
    for (int i = 0; i < 7; i++)
        capture_fails(s, &bad[i].def, SCAN_ERROR_VALUE, bad[i].says);
    ProfileDef same = profile_def_default();
    same.has_base = same.has_tip = true;
    same.base = same.tip = vec2(50, 30);
    capture_fails(s, &same, SCAN_ERROR_VALUE, "base and tip are the same point");
    scan_free(s);
}

static void test_given_ends(void)
{
    Scan *s = paper(200, 200);
    fill_ellipse(s, vec2(100, 110), 70, 40, GREEN);
    ProfileDef def = profile_def_default();
    def.has_base = def.has_tip = true;
    def.base = vec2(100.0, 69.0);
    def.tip = vec2(101.0, 151.5);
    GPtrArray *a = capture_ok(s, &def);
    const Profile *p = a->pdata[0];
    g_assert_cmpint(p->base_from, ==, BASE_GIVEN);
    assert_close(p->base, vec2(100, 70), 0.3);
    assert_close(p->outline->v[0], p->base, 1e-9);
    assert_close(p->tip, vec2(101, 150), 0.3);
    bool found = false;
    for (uint32_t i = 0; i < p->outline->n; i++)
        found |= vec_dist(p->outline->v[i], p->tip) < 0.06;
    g_assert_true(found);
    g_ptr_array_free(a, TRUE);
    def.base = vec2(80, 110); /* where a peltate leaf has it */
    a = capture_ok(s, &def);
    assert_close(((Profile *)a->pdata[0])->base, def.base, 0.0);
    g_ptr_array_free(a, TRUE);
    scan_free(s);
}

/* A ring with an island: outline, and what it encloses; by pixels and by levels. */
static void test_holes(void)
{
    Scan *s = paper(300, 300);
    fill_ellipse(s, vec2(150, 150), 120, 100, GREEN);
    fill_ellipse(s, vec2(170, 150), 50, 40, WHITE);
    fill_ellipse(s, vec2(170, 150), 20, 15, GREEN);
    fill_ellipse(s, vec2(70, 150), 15, 15, WHITE);
    for (int levels = 0; levels < 2; levels++) {
        ProfileDef def = profile_def_default();
        def.subpixel = levels;
        def.tolerance = 0.0;
        GPtrArray *a = capture_ok(s, &def);
        const Profile *p = a->pdata[0];
        g_assert_cmpfloat(fabs(p->area / (PI * 120 * 100) - 1.0), <=, 0.002);
        g_assert_cmpfloat(fabs(p->perimeter / 692.6 - 1.0), <=, levels ? 0.005 : 0.08);
        g_assert_cmpfloat(fabs((p->area - p->beyond) / (PI * (120 * 100 - 50 * 40 - 15 * 15)) - 1.0), <=, 0.002);
        g_assert_cmpuint(p->outline->n, <=, p->nodes + 2);
        g_ptr_array_free(a, TRUE);
    }
    scan_free(s);
}

/* Grid lines on the paper that end at the leaf, a crack in the leaf, dust. */
static void test_open_close(void)
{
    Scan *s = paper(400, 400);
    fill_ellipse(s, vec2(200, 200), 120, 90, GREEN);
    for (uint32_t i = 0; i < 400; i++) {
        blend(s, i, 60, GREEN, 1.0);
        blend(s, i, 200, GREEN, 1.0);
        blend(s, 200, i, GREEN, 1.0);
        if (i > 100)
            blend(s, i, 120 + i / 4, WHITE, 1.0);
    }
    ProfileDef def = profile_def_default();
    def.close = 1.5;
    def.open = 2.5;
    GPtrArray *a = capture_ok(s, &def);
    const Profile *p = a->pdata[0];
    g_assert_cmpfloat(fabs(p->area / (PI * 120 * 90) - 1.0), <=, 0.005);
    g_assert_true(p->outline->box.x0 > 75.0 && p->outline->box.x1 < 325.0);
    g_ptr_array_free(a, TRUE);
    def.open = 0.0;
    a = capture_ok(s, &def);
    g_assert_true(((Profile *)a->pdata[0])->outline->box.x0 < 10.0);
    g_ptr_array_free(a, TRUE);
    scan_free(s);
}

/* A light leaf on black, a leaf on a gradient and with its own soft shadow, a transparent background. */
static void test_backgrounds(void)
{
    for (int kind = 0; kind < 4; kind++) {
        Scan *s = paper(300, 300);
        static const uint8_t pale[3] = {200, 210, 160};
        for (uint32_t i = 0; i < 300 * 300; i++) {
            uint8_t *px = (uint8_t *)s->px + 3 * i;
            double shade = kind == 1 ? 1.0 - 0.25 * (i % 300) / 300.0 : kind == 2 ? 1.0 - 0.3 * exp(-pow(hypot(i % 300 - 160.0, i / 300 - 160.0) / 100.0, 4.0)) : 1.0;
            for (int c = 0; c < 3; c++)
                px[c] = (uint8_t)(kind == 0 ? 12 + 10.0 * uniform(60, 3 * i + c) : px[c] * shade - 6.0 * uniform(61, 3 * i + c));
        }
        fill_ellipse(s, vec2(150, 150), 90, 60, kind == 0 ? pale : GREEN);
        if (kind == 3) {
            Scan *t = scan_new(300, 300, 4, 8);
            for (uint32_t i = 0; i < 300 * 300; i++) {
                memcpy((uint8_t *)t->px + 4 * i, (uint8_t *)s->px + 3 * i, 3);
                bool in = hypot((i % 300 + 0.5 - 150.0) / 90.0, ((double)(i / 300) + 0.5 - 150.0) / 60.0) <= 1.0;
                ((uint8_t *)t->px)[4 * i + 3] = in ? 255 : 0;
            }
            scan_free(s);
            s = t;
        }
        ProfileDef def = profile_def_default();
        GPtrArray *a = capture_ok(s, &def);
        const Profile *p = a->pdata[0];
        g_assert_cmpfloat(fabs(p->area / (PI * 90 * 60) - 1.0), <=, 0.01);
        g_ptr_array_free(a, TRUE);
        scan_free(s);
    }
}

/* 16 bits tell what 8 do; y is up; vertices are the thesis' for a square of 1. */
static void test_depth(void)
{
    Scan *s = paper(200, 120), *t = scan_new(200, 120, 3, 16);
    fill_ellipse(s, vec2(80, 90), 40, 20, GREEN);
    for (gsize i = 0; i < 200 * 120 * 3; i++)
        ((uint16_t *)t->px)[i] = (uint16_t)(((uint8_t *)s->px)[i] * 257);
    ProfileDef def = profile_def_default();
    GPtrArray *a = capture_ok(s, &def), *b = capture_ok(t, &def);
    const Profile *p = a->pdata[0], *q = b->pdata[0];
    g_assert_cmpuint(p->outline->n, ==, q->outline->n);
    g_assert_cmpfloat(fabs(p->area - q->area), <=, 0.01 * p->perimeter);
    assert_close(polygon_centroid(p->outline), vec2(80, 90), 0.2);
    g_ptr_array_free(a, TRUE);
    g_ptr_array_free(b, TRUE);
    scan_free(s);
    scan_free(t);
}

/* A toothed leaf on noisy paper: every square and tolerance gives a simple outline near the true one. */
static void test_squares_and_tolerances(void)
{
    enum { N = 128 };
    Scan *s = paper(400, 400);
    Vec2 v[2 * N + 1];
    uint32_t n = ovate(v, N, 0.7, 0.03);
    place(v, 2 * N, 25.0, 330.0, vec2(270, 45));
    fill(s, v, n, GREEN);
    Polygon *truth = polygon_new(v, n);
    for (gsize i = 0; i < 400 * 400 * 3; i++)
        ((uint8_t *)s->px)[i] = (uint8_t)(((uint8_t *)s->px)[i] * 0.8 + 50.0 * uniform(70, i));
    for (uint32_t square = 1; square <= 16; square++)
        for (double tolerance = 0.5; tolerance <= 16.0; tolerance *= 2.0)
            for (int levels = 0; levels < 2; levels++) {
                ProfileDef def = profile_def_default();
                def.square = square;
                def.tolerance = tolerance;
                def.subpixel = levels;
                GPtrArray *a = capture_ok(s, &def);
                const Profile *p = a->pdata[0];
                g_assert_cmpfloat(fabs(p->outline->area / truth->area - 1.0), <=, 0.02 + 0.008 * tolerance + 0.004 * square);
                for (uint32_t i = 0; i < p->outline->n; i++)
                    g_assert_cmpfloat(vec_dist(polygon_nearest(truth, p->outline->v[i], NULL), p->outline->v[i]), <=, 3.0 + square);
                g_ptr_array_free(a, TRUE);
            }
    polygon_free(truth);
    scan_free(s);
}

/* Small pictures of blots and noise under all settings: simple outlines within the image, or an error that says what is wrong. */
static void test_anything(void)
{
    uint32_t captured = 0;
    for (uint32_t k = 0; k < 240; k++) {
        uint32_t w = 1 + (uint32_t)(30 * uniform(80, 16 * k)), h = 1 + (uint32_t)(30 * uniform(80, 16 * k + 1)), channels = 1 + k % 4, depth = k % 3 ? 8 : 16;
        Scan *s = scan_new(w, h, channels, depth);
        double share = uniform(80, 16 * k + 2), cx = w * uniform(80, 16 * k + 3), cy = h * uniform(80, 16 * k + 4);
        for (uint32_t i = 0; i < w * h * channels; i++) {
            bool blot = hypot(i / channels % w - cx, (double)(i / channels / w) - cy) < 0.4 * w;
            uint32_t v = (uint32_t)(255 * (uniform(81, i + 5000 * k) < share ? uniform(82, i + 5000 * k) : blot));
            if (depth == 8)
                ((uint8_t *)s->px)[i] = (uint8_t)v;
            else
                ((uint16_t *)s->px)[i] = (uint16_t)(v * 257);
        }
        ProfileDef def = profile_def_default();
        def.threshold.side = k % 5 ? LEAF_BY_FRAME : LEAF_LIGHT;
        def.threshold.level = k % 7 ? -1.0 : 250.0 * uniform(80, 16 * k + 5);
        def.close = k % 11 ? 0.0 : 3.0 * uniform(80, 16 * k + 6);
        def.open = k % 13 ? 0.0 : 2.0 * uniform(80, 16 * k + 7);
        def.each = k & 1;
        def.least_area = uniform(80, 16 * k + 8);
        def.keep_stalk = k & 4;
        def.square = 1 + k % 6;
        def.subpixel = k & 8;
        def.tolerance = k % 9 ? 4.0 * uniform(80, 16 * k + 9) : 0.0;
        GError *error = NULL;
        GPtrArray *a = profile_capture(s, &def, NULL, &error);
        g_assert_true((a == NULL) == (error != NULL));
        if (error)
            g_assert_error(error, SCAN_ERROR, SCAN_ERROR_NO_LEAF);
        g_clear_error(&error);
        if (a) {
            g_ptr_array_free(a, TRUE);
            g_ptr_array_free(capture_ok(s, &def), TRUE);
            captured++;
        }
        scan_free(s);
    }
    g_assert_cmpuint(captured, >, 120);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/mask/morphology", test_morphology);
    g_test_add_func("/mask/components", test_components);
    g_test_add_func("/mask/share_and_edging", test_share_and_edging);
    g_test_add_func("/mask/widest", test_widest);
    g_test_add_func("/ring/narrow", test_ring);
    g_test_add_func("/ring/tolerance", test_ring_tolerance);
    g_test_add_func("/profile/stalk", test_stalk);
    g_test_add_func("/profile/no_stalk", test_no_stalk);
    g_test_add_func("/profile/bent_stalk", test_bent_stalk);
    g_test_add_func("/profile/pale_side", test_pale_side);
    g_test_add_func("/profile/over", test_over);
    g_test_add_func("/profile/sinus", test_sinus);
    g_test_add_func("/profile/several", test_several);
    g_test_add_func("/profile/frame", test_frame);
    g_test_add_func("/profile/nothing", test_nothing);
    g_test_add_func("/profile/settings_refused", test_settings_refused);
    g_test_add_func("/profile/given_ends", test_given_ends);
    g_test_add_func("/profile/holes", test_holes);
    g_test_add_func("/profile/open_close", test_open_close);
    g_test_add_func("/profile/backgrounds", test_backgrounds);
    g_test_add_func("/profile/depth", test_depth);
    g_test_add_func("/profile/squares_and_tolerances", test_squares_and_tolerances);
    g_test_add_func("/profile/anything", test_anything);
    return g_test_run();
}
