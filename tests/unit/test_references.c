/* Captures of real scans against another program's areas and perimeters (references.csv, made by references.py), at all squares and
 * tolerances. Scans that are not here are skipped (real_scan.h). */
#include <glib.h>
#include <math.h>
#include <string.h>

#include "geom/march.h"
#include "geom/ring.h"
#include "real_scan.h"
#include "scan/mask.h"
#include "scan/profile.h"

typedef struct {
    const char *file;
    Channel channel;
    Vec2 base, tip;      /* read off the picture; y-up pixels */
    double mm_per_pixel; /* 0: the file doesn't say */
} Leaf;

static const Leaf LEAVES[] = {
    {"grape.jpg", CHANNEL_RED, {460, 690}, {512, 82}, 25.4 / 150.0},
    {"grape_301.jpg", CHANNEL_RED, {1690, 1530}, {1794, 289}, 25.4 / 300.0},
    {"grape_303.jpg", CHANNEL_RED, {1677, 1555}, {1723, 617}, 25.4 / 300.0},
    {"zelkova.jpg", CHANNEL_GREY, {1228, 1845}, {3249, 286}, 0.0},
};

typedef struct {
    double threshold, kept, filled, binary, levels; /* level; areas; perimeters */
} Reference;

static Reference reference_of(const char *file)
{
    char *path = g_test_build_filename(G_TEST_DIST, "references.csv", NULL), *text;
    GError *error = NULL;
    g_file_get_contents(path, &text, NULL, &error);
    g_assert_no_error(error);
    Reference r = {0};
    char **line = g_strsplit(text, "\n", -1);
    for (guint i = 0; line[i]; i++) {
        char **cell = g_strsplit(line[i], ",", -1);
        if (g_strv_length(cell) == 7 && g_str_equal(cell[0], file)) {
            double *const to[] = {&r.threshold, &r.kept, &r.filled, &r.binary, &r.levels};
            for (guint k = 0; k < G_N_ELEMENTS(to); k++)
                *to[k] = g_ascii_strtod(cell[2 + k], NULL);
        }
        g_strfreev(cell);
    }
    g_strfreev(line);
    g_free(text);
    g_free(path);
    g_assert_cmpfloat(r.levels, >, 0.0);
    return r;
}

static void assert_close(Vec2 a, Vec2 b, double within)
{
    if (!(vec_dist(a, b) <= within))
        g_error("%g,%g is %g away from %g,%g", a.x, a.y, vec_dist(a, b), b.x, b.y);
}

/* The leaf's profile, whose outline is simple and within the image. The array is to be unreffed. */
static GPtrArray *capture_ok(const Scan *s, const ProfileDef *def, const Profile **leaf)
{
    GError *error = NULL;
    GPtrArray *a = profile_capture(s, def, NULL, &error);
    g_assert_no_error(error);
    const Profile *p = *leaf = a->pdata[0];
    uint32_t i, j;
    g_assert_false(polygon_crossing(p->outline, &i, &j));
    g_assert_true(p->outline->box.x0 >= 0.0 && p->outline->box.y0 >= 0.0 && p->outline->box.x1 <= s->width && p->outline->box.y1 <= s->height);
    return a;
}

/* --- area and perimeter --- */

static void test_reference(gconstpointer user)
{
    const Leaf *leaf = user;
    const Reference r = reference_of(leaf->file);
    Scan *s = real_scan(leaf->file);
    for (int levels = 0; s && levels < 2; levels++) {
        ProfileDef def = profile_def_default();
        def.threshold.channel = leaf->channel;
        def.keep_stalk = true;
        def.subpixel = levels;
        const Profile *p;
        GPtrArray *a = capture_ok(s, &def, &p);
        double kept = p->area - p->beyond, length = levels ? r.levels : r.binary;
        g_test_message("%s %s: area %.0f (%+.3f %%), without what is beyond the threshold %.0f (%+.3f %%), perimeter %.0f (%+.2f %%), %u to %u nodes",
                       leaf->file, levels ? "levels" : "binary", p->area, 100.0 * (p->area / r.filled - 1.0), kept, 100.0 * (kept / r.kept - 1.0), p->perimeter,
                       100.0 * (p->perimeter / length - 1.0), p->nodes, p->outline->n);
        g_assert_cmpfloat(fabs(p->area / r.filled - 1.0), <=, 0.005);
        g_assert_cmpfloat(fabs(kept / r.kept - 1.0), <=, 0.005);
        g_assert_cmpfloat(fabs(p->perimeter / length - 1.0), <=, 0.03);
        assert_close(p->base, leaf->base, 40.0);
        assert_close(p->tip, leaf->tip, 25.0);
        g_ptr_array_free(a, TRUE);
    }
    scan_free(s);
}

/* By default: the red channel is chosen on red millimetre paper, its threshold is the other program's, and the petiole is cut off. */
static void test_defaults(gconstpointer user)
{
    const Leaf *leaf = user;
    const Reference r = reference_of(leaf->file);
    Scan *s = real_scan(leaf->file);
    if (!s)
        return;
    ProfileDef def = profile_def_default();
    Threshold t;
    GPtrArray *a = profile_capture(s, &def, &t, NULL);
    g_assert_nonnull(a);
    const Profile *p = a->pdata[0];
    if (leaf->channel == CHANNEL_RED) {
        g_assert_cmpint(t.channel, ==, CHANNEL_RED);
        g_assert_cmpfloat(fabs(t.level - r.threshold), <=, 1.0);
    }
    g_assert_true(t.dark);
    g_assert_cmpfloat(fabs(p->mm_per_pixel - leaf->mm_per_pixel), <=, 1e-9);
    assert_close(p->base, leaf->base, 40.0);
    assert_close(p->tip, leaf->tip, 25.0);
    g_assert_cmpfloat(fabs(p->area / r.filled - 1.0), <=, 0.02);
    g_ptr_array_free(a, TRUE);
    scan_free(s);
}

/* --- squares and tolerances --- */

/* The one channel of it that matters, of the leaf and some pixels around it, and where its upper left corner was. */
static Scan *cut_out(const Scan *s, const Leaf *leaf, double level, uint32_t *x0, uint32_t *y0)
{
    enum { AROUND = 40 };
    ThresholdDef by = {leaf->channel, LEAF_BY_FRAME, level};
    Threshold t;
    g_assert_true(threshold_find(s, &by, &t, NULL));
    Mask m = {s->width, s->height, s->width, g_new(uint8_t, (gsize)s->width * s->height)};
    threshold_apply(s, &t, m.px);
    GArray *parts = mask_components(&m, 0.5);
    MaskBox b = g_array_index(parts, Component, 0).box;
    g_array_free(parts, TRUE);
    g_free(m.px);
    *x0 = b.x0 > AROUND ? b.x0 - AROUND : 0;
    *y0 = b.y0 > AROUND ? b.y0 - AROUND : 0;
    Scan *out = scan_new(MIN(b.x1 + 1 + AROUND, s->width) - *x0, MIN(b.y1 + 1 + AROUND, s->height) - *y0, 1, 8);
    for (uint32_t y = 0; y < out->height; y++)
        for (uint32_t x = 0; x < out->width; x++)
            ((uint8_t *)out->px)[(gsize)y * out->width + x] = (uint8_t)channel_value(s, leaf->channel, *x0 + x, *y0 + y);
    return out;
}

/* Every square from 1 to 16 pixels with every tolerance from 0.5 to 16, the whole way: the outline never crosses itself (capture_ok), keeps its ends, and
 * encloses the area that it did, to what a tolerance can take along the margin. Of large scans each tolerance has one square, 1, 4, 7 …; all have
 * all, by levels and between pixels, with -m slow: two minutes. */
static void test_grid(gconstpointer user)
{
    static const double tolerance[] = {0.5, 1, 2, 4, 8, 16};
    const Leaf *leaf = user;
    const Reference r = reference_of(leaf->file);
    Scan *whole = real_scan(leaf->file);
    if (!whole)
        return;
    bool large = whole->width > 2000, all = g_test_slow() || !large;
    uint32_t x0, y0, captures = 0;
    Scan *s = cut_out(whole, leaf, r.threshold, &x0, &y0);
    Vec2 from = vec2(x0, (double)whole->height - y0 - s->height), base = vec_sub(leaf->base, from), tip = vec_sub(leaf->tip, from);
    scan_free(whole);
    double worst = 0.0;
    for (uint32_t square = 1; square <= 16; square++)
        for (uint32_t k = 0; k < G_N_ELEMENTS(tolerance); k++)
            for (int levels = g_test_slow() ? 0 : 1; (all || square == 1 + 3 * k) && levels < 2; levels++) {
                ProfileDef def = profile_def_default();
                def.threshold = (ThresholdDef){CHANNEL_GREY, LEAF_DARK, r.threshold};
                def.square = square;
                def.tolerance = tolerance[k];
                def.subpixel = levels;
                const Profile *p;
                GPtrArray *a = capture_ok(s, &def, &p);
                assert_close(p->base, base, 40.0 + square);
                assert_close(p->tip, tip, 25.0 + square);
                worst = MAX(worst, fabs(p->area / r.filled - 1.0));
                g_assert_cmpfloat(fabs(p->outline->area - p->area), <=, 0.5 * tolerance[k] * p->perimeter);
                g_ptr_array_free(a, TRUE);
                captures++;
            }
    g_test_message("%s: %u captures, none crosses itself; areas as traced, petiole cut off, within %.2f %%", leaf->file, captures, 100.0 * worst);
    g_assert_cmpfloat(worst, <=, 0.02);
    scan_free(s);
}

/* --- tables --- */

typedef struct {
    const Scan *scan;
    Channel channel;
} Levels;

static double scan_level(const void *user, uint32_t x, uint32_t y)
{
    const Levels *l = user;
    return channel_value(l->scan, l->channel, x, y);
}

/* One row for a square size; outlines by pixels or by levels. */
static void node_counts(const MarchField *f, uint32_t square)
{
    static const double tolerances[] = {16, 8, 5, 3, 2, 1, 0.5};
    MarchLoops *l = march_loops(f, square);
    uint32_t best = march_largest(l), i, j, before = 0;
    Polygon *p = polygon_new(l->p + l->start[best], l->start[best + 1] - l->start[best]);
    g_assert_false(polygon_crossing(p, &i, &j));
    GString *row = g_string_new(f->level ? "levels" : "pixels");
    g_string_append_printf(row, " %4u %7u", square, p->n);
    for (uint32_t n = 0; n < G_N_ELEMENTS(tolerances); n++) {
        Polygon *q = ring_simplify(p, tolerances[n], NULL);
        g_assert_false(polygon_crossing(q, &i, &j));
        g_assert_cmpuint(q->n, >=, before);
        before = q->n;
        g_string_append_printf(row, " %5u", q->n);
        polygon_free(q);
    }
    g_test_message("%s", row->str);
    g_string_free(row, TRUE);
    polygon_free(p);
    march_loops_free(l);
}

/* Nodes against square size and tolerance, as Hong's tables 5.1 and 5.2: the finer the tolerance, the more; none of the outlines, petiole and all,
 * crosses itself. */
static void test_tables(gconstpointer user)
{
    const Leaf *leaf = user;
    Scan *s = real_scan(leaf->file);
    if (!s)
        return;
    ThresholdDef by = {leaf->channel, LEAF_BY_FRAME, -1.0};
    Threshold t;
    g_assert_true(threshold_find(s, &by, &t, NULL));
    Mask m = {s->width, s->height, s->width, g_new(uint8_t, (gsize)s->width * s->height)};
    threshold_apply(s, &t, m.px);
    GArray *parts = mask_components(&m, 0.5);
    const Component *c = &g_array_index(parts, Component, 0);
    mask_take(&m, c);
    g_test_message("%s: nodes by square (rows) and tolerance: none 16 8 5 3 2 1 0.5", leaf->file);
    Levels levels = {s, t.channel};
    MarchField f = {.px = m.px, .width = m.width, .height = m.height, .test = MASK_THIS, .want = MASK_THIS,
                    .x0 = c->box.x0, .y0 = c->box.y0, .x1 = c->box.x1, .y1 = c->box.y1, .user = &levels, .threshold = t.level};
    for (uint32_t square = 1; square <= 16; square++)
        for (int by_level = 0; by_level < 2; by_level++) {
            f.level = by_level ? scan_level : NULL;
            node_counts(&f, square);
        }
    g_array_free(parts, TRUE);
    g_free(m.px);
    scan_free(s);
}

int main(int argc, char **argv)
{
    static const struct {
        const char *name;
        GTestDataFunc run;
    } test[] = {{"reference", test_reference}, {"defaults", test_defaults}, {"squares", test_grid}, {"tables", test_tables}};
    g_test_init(&argc, &argv, NULL);
    for (guint k = 0; k < G_N_ELEMENTS(test); k++)
        for (guint i = 0; i < G_N_ELEMENTS(LEAVES); i++) {
            char *path = g_strdup_printf("/scans/%s/%.*s", test[k].name, (int)(strchr(LEAVES[i].file, '.') - LEAVES[i].file), LEAVES[i].file);
            g_test_add_data_func(path, &LEAVES[i], test[k].run);
            g_free(path);
        }
    return g_test_run();
}
