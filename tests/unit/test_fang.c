/* Profiles by edges: drawn leaves whose answers are known, bad pictures, every operator; and real scans (real_scan.h). */
#include <glib.h>
#include <math.h>
#include <string.h>

#include "geom/random.h"
#include "real_scan.h"
#include "scan/fang.h"
#include "scan/fang_outline.h"
#include "scan/profile.h"

#define PI 3.14159265358979

static const uint8_t GREEN[3] = {62, 108, 48}, WHITE[3] = {246, 245, 242};
static const char *const OPERATORS[] = {"Roberts", "Sobel", "Prewitt", "Laplacian", "Canny"};

static double uniform(uint32_t stream, uint64_t index)
{
    double u[2];
    random_pair(17, stream, 0, index, u);
    return u[0];
}

/* --- drawing --- */

static Scan *paper(uint32_t w, uint32_t h)
{
    Scan *s = scan_new(w, h, 3, 8);
    g_assert_nonnull(s);
    for (gsize i = 0; i < (gsize)w * h * 3; i++)
        ((uint8_t *)s->px)[i] = WHITE[i % 3];
    return s;
}

/* Fills a polygon given in y-up pixel units, soft at its edge. */
static void fill(Scan *s, const Vec2 *v, uint32_t n)
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
            uint8_t *px = (uint8_t *)s->px + ((gsize)y * s->width + x) * 3;
            for (int c = 0; c < 3; c++)
                px[c] = (uint8_t)(px[c] + (GREEN[c] - px[c]) * ((double)in / (FINE * FINE)) + 0.5);
        }
    polygon_free(p);
}

/* A closed curve from radii r(angle), the base at the bottom. */
static uint32_t star(Vec2 *v, uint32_t n, Vec2 c, double radius, double depth, uint32_t points)
{
    for (uint32_t i = 0; i < n; i++) {
        double a = 2.0 * PI * i / n, phase = (double)(i * points % n) / n; /* a point where it is 0 */
        double r = radius * (1.0 - depth * (phase < 0.5 ? 2.0 * phase : 2.0 - 2.0 * phase));
        v[i] = vec2(c.x + r * sin(a), c.y + r * cos(a));
    }
    return n;
}

static void add_noise(Scan *s, double size)
{
    for (gsize i = 0; i < (gsize)s->width * s->height; i++)
        for (uint32_t c = 0; c < 3; c++) {
            uint8_t *px = (uint8_t *)s->px + 3 * i + c;
            double v = *px + size * (uniform(1, 2 * (3 * i + c)) + uniform(2, 2 * (3 * i + c)) - 1.0);
            *px = (uint8_t)CLAMP(v, 0.0, 255.0);
        }
}

/* --- checks --- */

static FangProfile *check(FangProfile *p, const Scan *s)
{
    uint32_t i, j;
    g_assert_nonnull(p);
    g_assert_false(polygon_crossing(p->contour, &i, &j));
    g_assert_false(polygon_crossing(p->outline, &i, &j));
    g_assert_cmpuint(p->base, ==, 0);
    g_assert_cmpuint(p->tip, <, p->contour->n);
    g_assert_cmpuint(p->tip, !=, 0);
    g_assert_cmpuint(p->contour->n, >=, p->border->n - p->border->n / 50); /* but for tips that go on */
    g_assert_cmpfloat(vec_dist(p->outline->v[0], p->contour->v[0]), ==, 0.0);
    bool base = false, tip = false;
    for (guint k = 0; k < p->corners->len; k++) {
        base |= g_array_index(p->corners, Corner, k).at == p->base;
        tip |= g_array_index(p->corners, Corner, k).at == p->tip;
    }
    g_assert_true(base && tip);
    g_assert_cmpuint(p->fit->piece[p->fit->n_right - 1].to, ==, p->tip);
    for (uint32_t k = 0; k < p->contour->n; k++) {
        Vec2 v = p->contour->v[k];
        g_assert_true(v.x >= -1.5 && v.y >= -1.5 && v.x <= s->width + 1.5 && v.y <= s->height + 1.5);
    }
    return p;
}

static FangProfile *capture_ok(const Scan *s, const FangDef *def)
{
    GError *error = NULL;
    FangProfile *p = fang_capture(s, def, &error);
    g_assert_no_error(error);
    return check(p, s);
}

static void capture_fails(const Scan *s, const FangDef *def, GQuark domain, int code)
{
    GError *error = NULL;
    g_assert_null(fang_capture(s, def, &error));
    g_assert_error(error, domain, code);
    g_error_free(error);
}

/* Mean and greatest distance of a polygon's vertices from another. */
static double deviation(const Polygon *p, const Polygon *from, double *most)
{
    double sum = 0.0;
    *most = 0.0;
    for (uint32_t i = 0; i < p->n; i++) {
        double d = vec_dist(polygon_nearest(from, p->v[i], NULL), p->v[i]);
        sum += d;
        *most = MAX(*most, d);
    }
    return sum / p->n;
}

/* Whether a characteristic point lies near q. */
static bool has_corner(const FangProfile *p, Vec2 q, double within)
{
    for (guint k = 0; k < p->corners->len; k++)
        if (vec_dist(p->contour->v[g_array_index(p->corners, Corner, k).at], q) <= within)
            return true;
    return false;
}

/* --- drawn leaves --- */

/* Leaves with teeth (24 small) and lobes (5 deep ones), by every operator, clean and with noise: the contour within a pixel, every tip and notch
 * a characteristic point. */
static void test_drawn(void)
{
    enum { N = 240 };
    static const struct {
        double depth;
        uint32_t points;
    } kind[] = {{0.16, 12}, {0.6, 5}};
    for (uint32_t k = 0; k < 4; k++)
        for (int op = 0; op < 5; op++) {
            Scan *s = paper(420, 420);
            Vec2 v[N];
            uint32_t points = kind[k % 2].points;
            fill(s, v, star(v, N, vec2(208.3, 211.7), 180.0, kind[k % 2].depth, points));
            if (k >= 2)
                add_noise(s, 40.0);
            FangDef def = fang_def_default();
            def.edges.op = (EdgesOperator)op;
            FangProfile *p = capture_ok(s, &def);
            Polygon *truth = polygon_new(v, N);
            double most, mean = deviation(p->contour, truth, &most), back;
            deviation(truth, p->contour, &back);
            g_test_message("%u points, noise %d, %s: sigma %g, contour off by %.3f, at most %.2f, tips and notches by %.2f; %u corners, %u pieces, off by %.2f, at most %.2f", points,
                           k >= 2, OPERATORS[op], p->used.sigma, mean, most, back, p->corners->len, p->fit->n, p->fit->mean, p->fit->largest);
            g_assert_cmpfloat(mean, <=, 0.25);
            g_assert_cmpfloat(back, <=, k % 2 ? 2.5 : 1.2); /* the notches between lobes are sharp, 45°, and fill */
            g_assert_cmpfloat(fabs(p->contour->area / truth->area - 1.0), <=, 0.012);
            for (uint32_t i = 0; i < 2 * points; i++)
                g_assert_true(has_corner(p, v[i * N / 2 / points], 4.0));
            polygon_free(truth);
            fang_profile_free(p);
            scan_free(s);
        }
}

/* A disc has no corners but base and tip; its contour and area are known. The rule for contours fits it closely. */
static void test_disc(void)
{
    enum { N = 512 };
    Scan *s = paper(300, 300);
    Vec2 v[N];
    fill(s, v, star(v, N, vec2(150, 150), 100.0, 0.0, 4));
    for (int op = 0; op < 5; op++) {
        FangDef def = fang_def_default();
        def.edges.op = (EdgesOperator)op;
        def.fit.rule = BEZIERFIT_CONTOUR;
        def.fit.tolerance = 1.0;
        def.has_base = def.has_tip = true;
        def.base = vec2(150, 50);
        def.tip = vec2(150, 250);
        FangProfile *p = capture_ok(s, &def);
        for (uint32_t i = 0; i < p->contour->n; i++)
            g_assert_cmpfloat(fabs(vec_dist(p->contour->v[i], vec2(150, 150)) - 100.0), <=, 1.2);
        g_assert_cmpfloat(fabs(p->contour->area / (PI * 1e4) - 1.0), <=, 0.01);
        g_assert_cmpfloat(fabs(p->outline->area / (PI * 1e4) - 1.0), <=, 0.01);
        g_assert_cmpfloat(vec_dist(p->contour->v[0], def.base), <=, 2.0);
        g_assert_cmpfloat(vec_dist(p->contour->v[p->tip], def.tip), <=, 2.0);
        g_assert_cmpfloat(p->fit->largest, <=, 1.2);
        fang_profile_free(p);
    }
    scan_free(s);
}

/* Cut by the frame at a side and at a corner. */
static void test_frame(void)
{
    enum { N = 256 };
    for (int corner = 0; corner < 2; corner++)
        for (int op = 0; op < 5; op++) {
            Scan *s = paper(301, 263);
            Vec2 v[N];
            fill(s, v, star(v, N, vec2(0, corner ? 0 : 130), 100.0, 0.0, 4));
            FangDef def = fang_def_default();
            def.edges.op = (EdgesOperator)op;
            FangProfile *p = capture_ok(s, &def);
            g_assert_cmpfloat(fabs(p->contour->area / (PI * 1e4 / (corner ? 4 : 2)) - 1.0), <=, 0.03);
            g_assert_cmpfloat(p->contour->box.x0, ==, 0.0);
            fang_profile_free(p);
            scan_free(s);
        }
}

/* The petiole is cut off, or kept. */
static void test_stalk(void)
{
    enum { N = 256 };
    Scan *s = paper(320, 400);
    Vec2 v[N], stalk[] = {{155, 20}, {165, 20}, {165, 180}, {155, 180}};
    fill(s, v, star(v, N, vec2(160, 250), 110.0, 0.0, 4));
    fill(s, stalk, 4);
    FangDef def = fang_def_default();
    FangProfile *p = capture_ok(s, &def);
    g_assert_cmpfloat(vec_dist(p->contour->v[0], vec2(160, 140)), <=, 6.0);
    g_assert_cmpfloat(vec_dist(p->contour->v[p->tip], vec2(160, 360)), <=, 16.0);
    g_assert_cmpfloat(fabs(p->contour->area / (PI * 12100) - 1.0), <=, 0.01);
    fang_profile_free(p);
    def.keep_stalk = true;
    p = capture_ok(s, &def);
    g_assert_cmpfloat(vec_dist(p->contour->v[0], vec2(160, 20)), <=, 8.0);
    g_assert_cmpfloat(p->contour->area, >, PI * 12100 + 900.0);
    fang_profile_free(p);
    scan_free(s);
}

/* Gaps in the edges: the margin fades for some pixels. */
static void test_gaps(void)
{
    enum { N = 256 };
    for (int gap = 0; gap <= 6; gap += 2) {
        Scan *s = paper(300, 300);
        Vec2 v[N];
        fill(s, v, star(v, N, vec2(150, 150), 100.0, 0.0, 4));
        for (int x = 150; x < 150 + gap; x++) /* a ramp across the margin at the top: too weak an edge */
            for (int y = 10; y < 90; y++)
                for (int c = 0; c < 3; c++)
                    ((uint8_t *)s->px)[(y * 300 + x) * 3 + c] = (uint8_t)(WHITE[c] + (GREEN[c] - WHITE[c]) * (y - 10) / 80.0);
        FangDef def = fang_def_default();
        def.edges.automatic = false;
        def.edges.high = def.edges.low = 30.0;
        FangProfile *p = capture_ok(s, &def);
        g_assert_cmpfloat(fabs(p->contour->area / (PI * 1e4) - 1.0), <=, 0.03);
        fang_profile_free(p);
        scan_free(s);
    }
}

/* A soft shadow beside the margin is among the edges, but the contour stays at the margin. */
static void test_shadow(void)
{
    enum { N = 256, REACH = 14 };
    Scan *s = paper(300, 300);
    for (uint32_t i = 0; i < 300 * 300; i++) {
        double d = hypot(i % 300 + 0.5 - 150.0, (double)(i / 300) + 0.5 - 150.0) - 100.0;
        for (int c = 0; c < 3 && d < REACH; c++)
            ((uint8_t *)s->px)[3 * i + c] = (uint8_t)(WHITE[c] - 70.0 * (1.0 - MAX(d, 0.0) / REACH));
    }
    Vec2 v[N];
    fill(s, v, star(v, N, vec2(150, 150), 100.0, 0.0, 4));
    FangDef def = fang_def_default();
    def.threshold.channel = CHANNEL_RED;
    def.edges = (EdgesDef){.op = EDGES_ROBERTS, .high = 30.0, .low = 3.0};
    FangProfile *p = capture_ok(s, &def);
    GreyImage *red = grey_image_new(300, 300), *edges;
    for (uint32_t i = 0; i < 300 * 300; i++)
        red->px[i] = ((uint8_t *)s->px)[3 * i];
    edges = edges_map(red, &def.edges, NULL, NULL);
    g_assert_cmpfloat(edges->px[150 * 300 + 150 + 100 + REACH / 2], >, 0.0);
    grey_image_free(edges);
    grey_image_free(red);
    for (uint32_t i = 0; i < p->contour->n; i++)
        g_assert_cmpfloat(fabs(vec_dist(p->contour->v[i], vec2(150, 150)) - 100.0), <=, 1.2);
    fang_profile_free(p);
    scan_free(s);
}

static void test_nothing(void)
{
    FangDef def = fang_def_default();
    static const uint8_t shades[] = {0, 255, 128};
    for (uint32_t k = 0; k < 3; k++)
        for (uint32_t size = 1; size <= 50; size += 49) {
            Scan *s = scan_new(size, size, 3, 8);
            memset(s->px, shades[k], (gsize)size * size * 3);
            for (int op = 0; op < 5; op++) {
                def.edges.op = (EdgesOperator)op;
                capture_fails(s, &def, SCAN_ERROR, SCAN_ERROR_NO_LEAF);
            }
            scan_free(s);
        }
    Scan *s = paper(100, 100); /* a ramp has no edges strong enough to enclose anything */
    for (uint32_t i = 0; i < 100 * 100 * 3; i++)
        ((uint8_t *)s->px)[i] = (uint8_t)(2 * (i / 3 % 100));
    def = fang_def_default();
    def.edges.automatic = false;
    def.edges.high = def.edges.low = 20.0;
    capture_fails(s, &def, SCAN_ERROR, SCAN_ERROR_NO_LEAF);
    scan_free(s);
}

static void test_refused(void)
{
    enum { N = 64 };
    Scan *s = paper(100, 100);
    Vec2 v[N];
    fill(s, v, star(v, N, vec2(50, 50), 30.0, 0.0, 4));
    FangDef def = fang_def_default();
    def.edges.sigma = -1.0;
    capture_fails(s, &def, EDGES_ERROR, EDGES_ERROR_SETTINGS);
    def.edges.sigma = (double)NAN;
    capture_fails(s, &def, EDGES_ERROR, EDGES_ERROR_SETTINGS);
    def = fang_def_default();
    def.corners.k = 1.0;
    capture_fails(s, &def, CORNERS_ERROR, CORNERS_ERROR_SETTINGS);
    def = fang_def_default();
    def.fit.tension = 0.0;
    capture_fails(s, &def, BEZIERFIT_ERROR, BEZIERFIT_ERROR_SETTINGS);
    def = fang_def_default();
    def.has_base = true;
    def.base = vec2(500, 20);
    capture_fails(s, &def, SCAN_ERROR, SCAN_ERROR_VALUE);
    def = fang_def_default();
    def.threshold.channel = CHANNEL_ALPHA;
    capture_fails(s, &def, SCAN_ERROR, SCAN_ERROR_VALUE);
    scan_free(s);
}

/* Pictures of blots and noise under all settings: simple outlines, or no leaf; and the same again gives the same. */
static void test_anything(void)
{
    uint32_t captured = 0;
    for (uint32_t k = 0; k < 150; k++) {
        uint32_t w = 1 + (uint32_t)(60 * uniform(80, 16 * k)), h = 1 + (uint32_t)(60 * uniform(80, 16 * k + 1)), channels = 1 + k % 4, depth = k % 3 ? 8 : 16;
        Scan *s = scan_new(w, h, channels, depth);
        double share = uniform(80, 16 * k + 2) * (k % 2), cx = w * uniform(80, 16 * k + 3), cy = h * uniform(80, 16 * k + 4);
        for (uint32_t i = 0; i < w * h * channels; i++) {
            bool blot = hypot(i / channels % w - cx, (double)(i / channels / w) - cy) < 0.4 * w;
            uint32_t v = (uint32_t)(255 * (uniform(81, i + 50000 * k) < share ? uniform(82, i + 50000 * k) : blot));
            if (depth == 8)
                ((uint8_t *)s->px)[i] = (uint8_t)v;
            else
                ((uint16_t *)s->px)[i] = (uint16_t)(v * 257);
        }
        FangDef def = fang_def_default();
        def.edges.op = (EdgesOperator)(k % 5);
        def.edges.sigma = k % 7 ? 0.0 : 1.3;
        if (k % 11 == 0)
            def.edges.automatic = false, def.edges.high = 40.0, def.edges.low = 10.0, def.edges.sigma = 1.0;
        def.keep_stalk = k & 4;
        def.fit.rule = k & 1 ? BEZIERFIT_CHORDS : BEZIERFIT_CONTOUR;
        def.fit.tolerance = k & 2 ? 1.0 : 0.0;
        def.fit.tension = k & 8 ? 3.0 : 1.0;
        def.corners.spacing = k & 16 ? 1.0 : 8.0;
        GError *error = NULL;
        FangProfile *p = fang_capture(s, &def, &error);
        g_assert_true((p == NULL) == (error != NULL));
        if (error)
            g_assert_error(error, SCAN_ERROR, SCAN_ERROR_NO_LEAF);
        g_clear_error(&error);
        if (p) {
            FangProfile *q = capture_ok(s, &def);
            g_assert_cmpuint(p->outline->n, ==, q->outline->n);
            g_assert_true(!memcmp(p->outline->v, q->outline->v, p->outline->n * sizeof(Vec2)));
            fang_profile_free(q);
            fang_profile_free(p);
            captured++;
        }
        scan_free(s);
    }
    g_test_message("%u of 150 captured", captured);
    g_assert_cmpuint(captured, >, 50);
}

/* Deep teeth with few points: fits that cross are parted until they don't; at the hardest the contour itself is left. */
static void test_parting(void)
{
    uint32_t parted = 0;
    for (uint32_t k = 0; k < 60; k++) {
        enum { MAX = 600 };
        uint32_t n = 12 + (uint32_t)(uniform(90, k) * (MAX - 12)), spikes = 3 + k % 9;
        Vec2 v[MAX];
        for (uint32_t i = 0; i < n; i++) {
            double a = 2.0 * PI * i / n, r = 100.0 * (1.0 + 0.9 * sin(spikes * a)) + 8.0 + 4.0 * uniform(91, 1000 * k + i);
            v[i] = vec2(r * cos(a + 0.3 * sin(3.0 * a)), r * sin(a + 0.3 * sin(3.0 * a)));
        }
        Polygon *contour = polygon_new(v, n);
        uint32_t i, j, tip = 1 + (uint32_t)(uniform(92, k) * (n - 2));
        if (!polygon_crossing(contour, &i, &j)) {
            GArray *at = g_array_new(FALSE, FALSE, sizeof(uint32_t));
            for (uint32_t m = 0; m < k % 20; m++) {
                uint32_t x = (uint32_t)(uniform(93, 100 * k + m) * n);
                g_array_append_val(at, x);
            }
            BezierFitDef def = bezierfit_def_default();
            def.tension = k % 2 ? 3.0 : 1.0;
            def.cusp_angle = k % 3 ? 30.0 : 180.0;
            def.rule = k % 5 ? BEZIERFIT_CHORDS : BEZIERFIT_CONTOUR;
            Polygon *outline;
            BezierFit *fit = fang_fit(contour, at, 0, tip, &def, &outline, NULL);
            g_assert_nonnull(fit);
            g_assert_false(polygon_crossing(outline, &i, &j));
            double largest = 0.0;
            for (uint32_t m = 0; m < fit->n; m++) {
                g_assert_cmpfloat(vec_dist(fit->piece[m].p[0], contour->v[fit->piece[m].from]), ==, 0.0);
                g_assert_cmpuint(fit->piece[m].to, ==, fit->piece[(m + 1) % fit->n].from);
                largest = fmax(largest, fit->piece[m].largest);
            }
            g_assert_cmpfloat(largest, ==, fit->largest);
            parted += fit->n > at->len + 2;
            bezierfit_free(fit);
            polygon_free(outline);
            g_array_unref(at);
        }
        polygon_free(contour);
    }
    g_assert_cmpuint(parted, >, 10);
}

/* --- real scans --- */

static const struct {
    const char *file;
    double filled;
    Vec2 base, tip;
    double most; /* deviation of the curves */
} SCANS[] = {
    {"grape_301.jpg", 1574874, {1690, 1530}, {1794, 289}, 3.0},
    {"grape_303.jpg", 922952, {1677, 1555}, {1723, 617}, 4.5}, /* across the petiole there is no edge of the blade */
    {"zelkova.jpg", 1548147, {1228, 1845}, {3249, 286}, 3.0},
};

/* What a capture of a real scan must be, by any operator. */
static void check_scan(const FangProfile *p, const char *file, int op, double area, Vec2 base, Vec2 tip, double off, double off_base)
{
    g_test_message("%s, %s: sigma %g, edges on %.1f %%, gap %.0f; %u corners, %u pieces, off by %.2f, at most %.1f; area %.0f (%+.2f %%)", file,
                   OPERATORS[op], p->used.sigma, 100.0 * p->region.continuity, p->region.gap, p->corners->len, p->fit->n, p->fit->mean, p->fit->largest,
                   p->contour->area, 100.0 * (p->contour->area / area - 1.0));
    g_assert_cmpfloat(fabs(p->contour->area / area - 1.0), <=, off);
    g_assert_cmpfloat(fabs(p->region.area / p->region.rough - 1.0), <=, 0.01);
    g_assert_cmpfloat(p->region.continuity, >=, 0.8);
    g_assert_cmpfloat(vec_dist(p->contour->v[0], base), <=, off_base);
    g_assert_cmpfloat(vec_dist(p->contour->v[p->tip], tip), <=, 25.0);
}

/* Every operator finds each leaf; all but the paper's and Canny's only with -m slow. */
static void test_scans(void)
{
    for (uint32_t k = 0; k < G_N_ELEMENTS(SCANS); k++)
        for (int op = 0; op < 5; op += g_test_slow() ? 1 : 4) {
            Scan *s = real_scan(SCANS[k].file);
            if (!s)
                return;
            FangDef def = fang_def_default();
            def.edges.op = (EdgesOperator)op;
            def.fit.rule = BEZIERFIT_CONTOUR; /* as a capture does by default */
            def.fit.tolerance = 1.5;
            FangProfile *p = capture_ok(s, &def);
            check_scan(p, SCANS[k].file, op, SCANS[k].filled, SCANS[k].base, SCANS[k].tip, 0.02, 40.0);
            g_assert_cmpfloat(p->fit->mean, <, 0.5);
            g_assert_cmpfloat(p->fit->largest, <, SCANS[k].most);
            fang_profile_free(p);
            scan_free(s);
        }
}

/* The grape leaf that comes with the sources, on a printed grid: all operators, with chosen smoothing and with given, agree with the level's
 * outline and with each other. */
static void test_grape(void)
{
    char *path = g_test_build_filename(G_TEST_DIST, "..", "..", "params", "scans", "grape.jpg", NULL);
    GError *error = NULL;
    Scan *s = scan_read(path, 0, &error);
    g_assert_no_error(error);
    ProfileDef by_level = profile_def_default();
    by_level.tolerance = 0.0;
    GPtrArray *known = profile_capture(s, &by_level, NULL, &error);
    g_assert_no_error(error);
    const Profile *leaf = known->pdata[0];
    for (int op = 0; op < 5; op++)
        for (int given = 0; given < 2; given++) {
            FangDef def = fang_def_default();
            def.edges.op = (EdgesOperator)op;
            def.edges.sigma = given ? 2.5 : 0.0;
            def.fit.rule = BEZIERFIT_CONTOUR;
            def.fit.tolerance = 1.5;
            FangProfile *p = capture_ok(s, &def);
            if (given)
                g_assert_cmpfloat(p->used.sigma, ==, 2.5);
            check_scan(p, "grape.jpg", op, leaf->area, leaf->base, leaf->tip, 0.01, 15.0);
            g_assert_cmpfloat(p->fit->mean, <=, 0.5);
            g_assert_cmpfloat(p->fit->largest, <=, 4.0);
            fang_profile_free(p);
        }
    g_ptr_array_free(known, TRUE);
    scan_free(s);
    g_free(path);
}

/* Several leaves: each by its number, counted from the largest; the rest refused. A threshold of one's own and the side count, too. */
static void test_each(void)
{
    enum { N = 128 };
    static const Vec2 at[3] = {{80, 150}, {260, 200}, {360, 60}};
    static const double radius[3] = {40, 70, 28};
    static const uint32_t largest[3] = {1, 0, 2};
    Scan *s = paper(420, 300);
    for (uint32_t k = 0; k < 3; k++) {
        Vec2 v[N];
        fill(s, v, star(v, N, at[k], radius[k], 0.0, 4));
    }
    for (uint32_t k = 0; k < 3; k++)
        for (int op = 0; op < 5; op++) {
            FangDef def = fang_def_default();
            def.edges.op = (EdgesOperator)op;
            def.leaf = k + 1;
            FangProfile *p = capture_ok(s, &def);
            double r = radius[largest[k]];
            g_assert_cmpfloat(fabs(p->contour->area / (PI * r * r) - 1.0), <=, 0.02);
            g_assert_cmpfloat(vec_dist(vec2(0.5 * (p->contour->box.x0 + p->contour->box.x1), 0.5 * (p->contour->box.y0 + p->contour->box.y1)), at[largest[k]]), <=,
                              1.0);
            fang_profile_free(p);
        }
    FangDef def = fang_def_default();
    def.leaf = 4;
    capture_fails(s, &def, SCAN_ERROR, SCAN_ERROR_VALUE);
    def.leaf = 3;
    def.least_area = 0.3; /* now the third is a speck */
    capture_fails(s, &def, SCAN_ERROR, SCAN_ERROR_VALUE);
    def = fang_def_default();
    def.open = 50.0; /* which only the largest has room for */
    fang_profile_free(capture_ok(s, &def));
    def.leaf = 2;
    capture_fails(s, &def, SCAN_ERROR, SCAN_ERROR_VALUE);
    def = fang_def_default();
    def.threshold = (ThresholdDef){CHANNEL_RED, LEAF_BY_FRAME, 20.0}; /* darker than the leaves */
    capture_fails(s, &def, SCAN_ERROR, SCAN_ERROR_NO_LEAF);
    def = fang_def_default();
    def.close = -1.0;
    capture_fails(s, &def, SCAN_ERROR, SCAN_ERROR_VALUE);
    scan_free(s);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/fang/drawn", test_drawn);
    g_test_add_func("/fang/disc", test_disc);
    g_test_add_func("/fang/frame", test_frame);
    g_test_add_func("/fang/stalk", test_stalk);
    g_test_add_func("/fang/gaps", test_gaps);
    g_test_add_func("/fang/shadow", test_shadow);
    g_test_add_func("/fang/nothing", test_nothing);
    g_test_add_func("/fang/refused", test_refused);
    g_test_add_func("/fang/anything", test_anything);
    g_test_add_func("/fang/parting", test_parting);
    g_test_add_func("/fang/each", test_each);
    g_test_add_func("/fang/grape", test_grape);
    g_test_add_func("/fang/scans", test_scans);
    return g_test_run();
}
