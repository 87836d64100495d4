/* Base and tip of painted leaves of many shapes, turned, with a petiole and with it cut off; what outlines and veins say, each for itself. */
#include <glib.h>
#include <math.h>
#include <string.h>

#include "geom/dtrig.h"
#include "geom/random.h"
#include "scan/axis.h"
#include "scan/gather.h"
#include "scan/profile.h"

enum { SIDE = 660, MOST = 200 };
static const double size = 300.0; /* pixels from base to tip */

typedef struct {
    Vec2 from, to;
    double begin, end; /* widths */
} Line;

/* The base is 0,0 and the tip 0,1. */
typedef struct {
    const char *name;
    Vec2 v[MOST], tip;
    uint32_t n, n_lines;
    Line line[64];
    double tip_reach; /* the tip is found so near to where it is */
} Leaf;

static Vec2 polar(double degrees, double r) /* from the tip's direction, to the right */
{
    double s, c;
    dtrig_sin_cos(degrees * DTRIG_PI / 180.0, &s, &c);
    return vec2(r * s, r * c);
}

static void line(Leaf *l, Vec2 from, Vec2 to, double begin, double end) { l->line[l->n_lines++] = (Line){from, to, begin, end}; }

/* --- shapes --- */

/* As a ginkgo's: the notch at the tip is no sinus at a base. */
static void fan(Leaf *l)
{
    *l = (Leaf){.name = "fan", .tip = vec2(0.0, 1.0), .tip_reach = 0.06};
    l->v[l->n++] = vec2(0.0, 0.0);
    for (int a = 60; a >= -60; a -= 2)
        l->v[l->n++] = polar(a, 1.0 + 0.1 * MIN(1.0, abs(a) / 8.0));
    for (int a = -55; a <= 55; a += 5)
        line(l, vec2(0.0, 0.0), polar(a, 0.98), 0.014, 0.008);
}

static void pinnate(Leaf *l)
{
    line(l, vec2(0.0, 0.0), vec2(0.0, 0.96), 0.025, 0.008);
    for (int k = 1; k < 8; k++)
        for (int side = -1; side <= 1; side += 2)
            line(l, vec2(0.0, 0.11 * k), vec2(side * 0.2, 0.11 * k + 0.13), 0.011, 0.006);
}

/* Broadest beyond the middle: the outline alone says the wrong end. */
static void obovate(Leaf *l)
{
    *l = (Leaf){.name = "obovate", .tip = vec2(0.0, 1.0), .tip_reach = 0.03};
    for (int side = 1; side >= -1; side -= 2)
        for (int k = 0; k < 40; k++) {
            double t = side > 0 ? k / 40.0 : 1.0 - k / 40.0;
            l->v[l->n++] = vec2(side * 0.75 * t * sqrt(1.0 - t), t);
        }
    pinnate(l);
}

static void ovate(Leaf *l)
{
    *l = (Leaf){.name = "ovate", .tip = vec2(0.0, 1.0), .tip_reach = 0.03};
    for (int side = 1; side >= -1; side -= 2)
        for (int k = 0; k < 40; k++) {
            double t = side > 0 ? k / 40.0 : 1.0 - k / 40.0;
            l->v[l->n++] = vec2(side * 0.75 * (1.0 - t) * sqrt(t), t);
        }
    pinnate(l);
}

static void lobed(Leaf *l)
{
    static const double at[] = {108, 55, 0, -55, -108}, reach[] = {0.6, 0.85, 1.0, 0.85, 0.6};
    *l = (Leaf){.name = "lobed", .tip = vec2(0.0, 1.0), .tip_reach = 0.03};
    l->v[l->n++] = vec2(0.0, 0.0);
    for (uint32_t k = 0; k < 5; k++) {
        l->v[l->n++] = polar(at[k] + 20.0, 0.42);
        l->v[l->n++] = polar(at[k] + 12.0, 0.75 * reach[k]);
        l->v[l->n++] = polar(at[k], reach[k]);
        l->v[l->n++] = polar(at[k] - 12.0, 0.75 * reach[k]);
        l->v[l->n++] = polar(at[k] - 20.0, 0.42);
        line(l, vec2(0.0, 0.0), polar(at[k], 0.9 * reach[k]), 0.022, 0.006);
        for (int side = -1; side <= 1; side += 2)
            line(l, polar(at[k], 0.45 * reach[k]), polar(at[k] + 9.0 * side, 0.7 * reach[k]), 0.008, 0.005);
    }
}

/* A heart. */
static void cordate(Leaf *l)
{
    *l = (Leaf){.name = "cordate", .tip = vec2(0.0, 1.0), .tip_reach = 0.03};
    l->v[l->n++] = vec2(0.0, 0.0);
    for (int a = 160; a >= -160; a -= 4) { /* far from the base where it is beside the tip, and where it is behind the base */
        double b = abs(a), r = b < 60 ? 1.0 - 0.4 * b / 60.0 : b < 140 ? 0.6 - 0.3 * (b - 60.0) / 80.0 : 0.3 - 0.15 * (b - 140.0) / 20.0;
        l->v[l->n++] = polar(a, r);
    }
    for (int a = -100; a <= 100; a += 25)
        line(l, vec2(0.0, 0.0), polar(a, a == 0 ? 0.9 : 0.43), a == 0 ? 0.022 : 0.014, 0.006);
}

/* Parallel veins: its ends are alike but that veins thin out. */
static void strip(Leaf *l)
{
    static const Vec2 v[] = {{0.0, 0.0}, {0.085, 0.0}, {0.085, 1.0}, {-0.085, 1.0}, {-0.085, 0.0}};
    *l = (Leaf){.name = "strip", .n = 5, .tip = vec2(0.0, 1.0), .tip_reach = 0.05};
    memcpy(l->v, v, sizeof v);
    for (int k = -1; k <= 1; k++)
        line(l, vec2(0.045 * k, 0.0), vec2(0.045 * k, 0.98), 0.014, 0.004);
}

/* An egg with a lobe on its right: the middle of its area is not on the midvein. */
static void lopsided(Leaf *l)
{
    static const Vec2 lobe[] = {{0.16, 0.02}, {0.28, 0.1}, {0.38, 0.25}, {0.42, 0.4}, {0.46, 0.57}, {0.37, 0.52}, {0.28, 0.51}};
    *l = (Leaf){.name = "lopsided", .tip = vec2(0.0, 1.0), .tip_reach = 0.03};
    l->v[l->n++] = vec2(0.0, 0.0);
    for (uint32_t k = 0; k < G_N_ELEMENTS(lobe); k++)
        l->v[l->n++] = lobe[k];
    for (int side = 1; side >= -1; side -= 2)
        for (int k = side > 0 ? 23 : 0; k < 40; k++) {
            double t = side > 0 ? k / 40.0 : 1.0 - k / 40.0;
            l->v[l->n++] = vec2(side * 0.85 * (1.0 - t) * sqrt(t), t);
        }
    line(l, vec2(0.0, 0.0), vec2(0.0, 0.96), 0.022, 0.006);
    for (int side = -1; side <= 1; side += 2)
        for (int k = 1; k <= 3; k++)
            line(l, vec2(0.0, 0.0), polar(side * 17.0 * k, 0.72 - 0.1 * k), 0.014, 0.005);
}

static void (*const shape[])(Leaf *) = {fan, obovate, ovate, lobed, cordate, strip, lopsided};

/* --- painting --- */

/* Where the leaf's points lie in an image: turned about its middle, which is the image's; y up. */
static Vec2 place(Vec2 q, double degrees)
{
    double s, c;
    dtrig_sin_cos(degrees * DTRIG_PI / 180.0, &s, &c);
    q = vec_scale(vec2(q.x, q.y - 0.4), size);
    return vec2(0.5 * SIDE + c * q.x - s * q.y, 0.5 * SIDE + s * q.x + c * q.y);
}

static double cover(const Leaf *l, const Vec2 (*at)[2], Vec2 q)
{
    double most = 0.0;
    for (uint32_t k = 0; k < l->n_lines; k++) {
        Vec2 d = vec_sub(at[k][1], at[k][0]);
        double t = CLAMP(vec_dot(vec_sub(q, at[k][0]), d) / vec_norm2(d), 0.0, 1.0);
        double half = 0.5 * size * (l->line[k].begin + (l->line[k].end - l->line[k].begin) * t);
        most = MAX(most, CLAMP(half + 0.5 - vec_dist(q, vec_add(at[k][0], vec_scale(d, t))), 0.0, 1.0));
    }
    return most;
}

static double noise(uint64_t i)
{
    double u[2];
    random_pair(5, 1, 0, i, u);
    return u[0] + u[1] - 1.0;
}

/* veins: how much lighter they are than the blade, levels. */
static Scan *painted(const Leaf *l, double degrees, bool petiole, double veins)
{
    static const double blade[3] = {70, 110, 60};
    Scan *s = scan_new(SIDE, SIDE, 3, 8);
    Vec2 v[MOST], at[64][2], foot[2] = {place(vec2(0.0, 0.02), degrees), place(vec2(0.0, -0.25), degrees)};
    for (uint32_t i = 0; i < l->n; i++)
        v[i] = place(l->v[i], degrees);
    for (uint32_t k = 0; k < l->n_lines; k++) {
        at[k][0] = place(l->line[k].from, degrees);
        at[k][1] = place(l->line[k].to, degrees);
    }
    Polygon *outline = polygon_new(v, l->n);
    for (uint32_t y = 0; y < SIDE; y++)
        for (uint32_t x = 0; x < SIDE; x++) {
            Vec2 q = vec2(x + 0.5, SIDE - y - 0.5), d = vec_sub(foot[1], foot[0]);
            double t = vec_dot(vec_sub(q, foot[0]), d) / vec_norm2(d), off = fabs(vec_cross(d, vec_sub(q, foot[0]))) / sqrt(vec_norm2(d));
            bool in = polygon_contains(outline, q), stalk = petiole && t >= 0.0 && t <= 1.0 && off < 0.012 * size;
            double c = in ? cover(l, (const Vec2(*)[2])at, q) : 0.0;
            for (uint32_t k = 0; k < 3; k++) {
                double level = in || stalk ? blade[k] + veins * c : 240.0;
                ((uint8_t *)s->px)[((gsize)y * SIDE + x) * 3 + k] = (uint8_t)(level + 4.0 * noise(((gsize)y * SIDE + x) * 3 + k) + 0.5);
            }
        }
    polygon_free(outline);
    return s;
}

static Profile *captured(const Scan *s, GPtrArray **all)
{
    GError *error = NULL;
    ProfileDef def = profile_def_default();
    *all = profile_capture(s, &def, NULL, &error);
    g_assert_no_error(error);
    return (*all)->pdata[0];
}

/* --- tests --- */

/* Every shape, with a petiole and without, light veins and dark. */
static void test_shapes(void)
{
    for (uint32_t k = 0; k < G_N_ELEMENTS(shape); k++)
        for (uint32_t i = 0; i < 6; i++) {
            Leaf l;
            shape[k](&l);
            double degrees = 77.0 * i + 13.0 * k;
            bool petiole = i % 2;
            GPtrArray *all;
            Scan *s = painted(&l, degrees, petiole, i % 3 == 2 ? -30.0 : 60.0);
            const Profile *p = captured(s, &all);
            Vec2 end[2] = {place(vec2(0.0, 0.0), degrees), place(l.tip, degrees)};
            bool other = k == 5 && !petiole && vec_dist(p->base, end[1]) < vec_dist(p->base, end[0]);
            double off = vec_dist(p->base, end[other]) / size, tip = vec_dist(p->tip, end[!other]) / size;
            g_test_message("%s at %g degrees, petiole %s: base by %s off by %.3f, tip by %.3f", l.name, degrees, petiole ? "kept" : "cut",
                           p->base_from == BASE_STALK ? "petiole" : "axis", off, tip);
            g_assert_cmpint(p->base_from, ==, petiole ? BASE_STALK : BASE_AXIS);
            g_assert_cmpfloat(off, <, 0.05);
            g_assert_cmpfloat(tip, <, l.tip_reach);
            g_ptr_array_free(all, TRUE);
            scan_free(s);
        }
}

/* What veins say turns round with the ends; where nothing is drawn they say nothing, and the outline decides as it did: the blunt end, the sinus. */
static void test_gather(void)
{
    for (uint32_t k = 0; k < G_N_ELEMENTS(shape); k++) {
        Leaf l;
        shape[k](&l);
        for (uint32_t veins = 0; veins < 2; veins++) {
            GPtrArray *all;
            Scan *s = painted(&l, 20.0, false, veins ? 50.0 : 0.0);
            const Profile *p = captured(s, &all);
            Vec2 base = place(vec2(0.0, 0.0), 20.0), tip = place(l.tip, 20.0);
            double there = gather_compare(s, p->outline, base, tip), back = gather_compare(s, p->outline, tip, base);
            g_test_message("%s: %.3f", l.name, there);
            g_assert_cmpfloat(fabs(there + back), <, 1e-9);
            g_assert_cmpfloat(there, <=, 1.0);
            if (veins)
                g_assert_cmpfloat(there, >, k == 5 ? 0.0 : 0.15);
            else
                g_assert_cmpfloat(fabs(there), <, 0.02);
            if (!veins && (k == 2 || k == 4))
                g_assert_cmpfloat(vec_dist(p->base, base), <, 0.05 * size);
            g_assert_cmpfloat(fabs(gather_compare(s, p->outline, base, base)), <, 1.0); /* no axis at all */
            g_ptr_array_free(all, TRUE);
            scan_free(s);
        }
    }
    Scan *s = scan_new(40, 40, 1, 8);
    Polygon *tiny = polygon_new((const Vec2[]){{3, 3}, {9, 3}, {6, 11}}, 3);
    g_assert_cmpfloat(fabs(gather_compare(s, tiny, vec2(6, 3), vec2(6, 11))), <=, 0.0);
    polygon_free(tiny);
    scan_free(s);
}

/* A slit beside the petiole that a vein makes, paler than the threshold but not as the ground is, is no part of the outline; one where ground shows is. */
static void test_pale_base(void)
{
    for (uint32_t ground = 0; ground < 2; ground++) {
        Leaf l;
        ovate(&l);
        GPtrArray *all;
        Scan *s = painted(&l, 33.0, true, 40.0);
        Vec2 a = place(vec2(0.02, -0.02), 33.0), b = place(vec2(0.02, 0.08), 33.0), d = vec_sub(b, a);
        for (uint32_t i = 0; i < SIDE * SIDE; i++) {
            Vec2 q = vec2(i % SIDE + 0.5, SIDE - i / SIDE - 0.5);
            double t = vec_dot(vec_sub(q, a), d) / vec_norm2(d);
            uint8_t *px = (uint8_t *)s->px + 3 * (gsize)i;
            if (t > 0.0 && t < 1.0 && fabs(vec_cross(d, vec_sub(q, a))) / sqrt(vec_norm2(d)) < 0.006 * size && px[0] < 200)
                memset(px, ground ? 240 : 190, 3);
        }
        const Profile *p = captured(s, &all);
        g_test_message("slit of %s: base off by %.3f", ground ? "ground" : "vein", vec_dist(p->base, place(vec2(0.0, 0.0), 33.0)) / size);
        g_assert_cmpint(polygon_contains(p->outline, place(vec2(0.02, 0.05), 33.0)), ==, !ground);
        g_assert_cmpfloat(vec_dist(p->base, place(vec2(0.0, 0.0), 33.0)), <, 0.05 * size);
        g_ptr_array_free(all, TRUE);
        scan_free(s);
    }
    char *path = g_test_build_filename(G_TEST_DIST, "..", "..", "params", "scans", "grape.jpg", NULL);
    Scan *s = scan_read(path, 0, NULL);
    g_assert_nonnull(s);
    GPtrArray *all;
    const Profile *p = captured(s, &all);
    static const Vec2 in[] = {{454, 436}, {444, 418}, {437, 424}}; /* where midvein and lateral veins are pale, rows from the top */
    for (uint32_t k = 0; k < G_N_ELEMENTS(in); k++)
        g_assert_true(polygon_contains(p->outline, vec2(in[k].x, s->height - in[k].y)));
    g_assert_false(polygon_contains(p->outline, vec2(440, s->height - 395.0)));
    g_assert_false(polygon_contains(p->outline, vec2(475, s->height - 395.0)));
    g_ptr_array_free(all, TRUE);
    scan_free(s);
    g_free(path);
}

/* Of an ellipse: the longer axis, its ends, and the far side of any point. */
static void test_ellipse(void)
{
    for (int k = 0; k < 8; k++) {
        Vec2 v[180];
        double s, c, sine, cosine;
        dtrig_sin_cos((22.5 * k + 5.0) * DTRIG_PI / 180.0, &sine, &cosine);
        for (uint32_t i = 0; i < 180; i++) {
            dtrig_sin_cos(2.0 * DTRIG_PI * i / 180, &s, &c);
            v[i] = vec2(30.0 + 90.0 * c * cosine - 50.0 * s * sine, -10.0 + 90.0 * c * sine + 50.0 * s * cosine);
        }
        Polygon *p = polygon_new(v, 180);
        Axis a;
        axis_init(&a, p);
        Vec2 base, tip, middle = vec2(30.0, -10.0), end = vec_add(middle, vec2(90.0 * cosine, 90.0 * sine));
        g_assert_cmpfloat(axis_find(&a, &base, &tip), >, 0.97);
        g_assert_cmpfloat(MIN(vec_dist(base, end), vec_dist(tip, end)), <, 3.0);
        g_assert_cmpfloat(fabs(vec_dist(base, tip) - 180.0), <, 1.0);
        for (uint32_t i = 0; i < 180; i += 7)
            g_assert_cmpfloat(vec_dist(axis_opposite(&a, v[i]), v[(i + 90) % 180]), <, 1e-6);
        g_assert_cmpfloat(vec_dist(axis_opposite(&a, vec_lerp(middle, v[3], 0.5)), v[93]), <, 1e-6);
        g_assert_cmpfloat(vec_dist(axis_opposite(&a, a.middle), a.middle), <=, 0.0);
        g_assert_cmpfloat(axis_symmetry(&a, middle, middle), <=, 0.0);
        axis_clear(&a);
        polygon_free(p);
    }
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/axis/ellipse", test_ellipse);
    g_test_add_func("/axis/shapes", test_shapes);
    g_test_add_func("/axis/gather", test_gather);
    g_test_add_func("/axis/pale-base", test_pale_base);
    return g_test_run();
}
