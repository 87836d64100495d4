/* A leaf with holes, and both its sides, from the scan to the maps: the grapevine leaf of params, whose lobes close into two holes. */
#include <glib.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#include "image/file.h"
#include "image/paint.h"
#include "lib/ground.h"
#include "lib/leaf.h"

static char *grape(void) { return g_test_build_filename(G_TEST_DIST, "..", "..", "params", "scans", "grape.jpg", NULL); }

static void set(VenParams *p, const char *key, const char *value)
{
    GError *error = NULL;
    ven_params_set(p, key, value, &error);
    g_assert_no_error(error);
}

static VenParams *scan_params(const char *image)
{
    GError *error = NULL;
    VenParams *p = ven_params_new();
    ven_params_use_scan(p, image, &error);
    g_assert_no_error(error);
    set(p, "scan.veins", "none");
    set(p, "veins.origin", "drawn");
    return p;
}

static Ground *ground(const VenParams *p)
{
    GError *error = NULL;
    Ground *g = ground_new(p->values, false, &error);
    g_assert_no_error(error);
    return g;
}

/* A folder for a test's files; emptied and removed by leave. */
static char *enter(void)
{
    GError *error = NULL;
    char *dir = g_dir_make_tmp("venation-holes-XXXXXX", &error);
    g_assert_no_error(error);
    return dir;
}

static void leave(char *dir)
{
    GDir *d = g_dir_open(dir, 0, NULL);
    const char *name;
    while (d && (name = g_dir_read_name(d))) {
        char *path = g_build_filename(dir, name, NULL);
        g_unlink(path);
        g_free(path);
    }
    if (d)
        g_dir_close(d);
    g_rmdir(dir);
    g_free(dir);
}

static void write_scan(const Scan *s, const char *path)
{
    GError *error = NULL;
    Plane *out = plane_new(s->width, s->height, 3, PLANE_DATA);
    out->high = s->depth == 8 ? 255.0 : 65535.0;
    for (gsize i = 0; i < 3 * (gsize)s->width * s->height; i++)
        out->px[i] = s->depth == 8 ? ((const uint8_t *)s->px)[i] : ((const uint16_t *)s->px)[i];
    image_write_png(out, path, (int)s->depth, NULL, &error);
    g_assert_no_error(error);
    plane_free(out);
}

static Scan *read_scan(const char *path)
{
    GError *error = NULL;
    Scan *s = scan_read(path, 0, &error);
    g_assert_no_error(error);
    return s;
}

/* Turned over: columns from the right to the left. */
static void write_mirrored(const char *image, const char *path)
{
    Scan *s = read_scan(image);
    uint8_t *px = s->px;
    for (uint32_t y = 0; y < s->height; y++)
        for (uint32_t x = 0; x < s->width / 2; x++)
            for (uint32_t c = 0; c < 3; c++) {
                uint8_t *a = px + 3 * ((gsize)y * s->width + x) + c, *b = px + 3 * ((gsize)y * s->width + s->width - 1 - x) + c, hold = *a;
                *a = *b;
                *b = hold;
            }
    write_scan(s, path);
    scan_free(s);
}

/* Pixels in the outline, a few within it, that are as light as paper: no part of this leaf is. */
static uint32_t paper(const Ground *g, const Scan *s, const Affine *to_scan)
{
    uint32_t n = 0;
    Vec2 *v = g_new(Vec2, g->outline->n);
    for (uint32_t i = 0; i < g->outline->n; i++)
        v[i] = affine_apply(to_scan, g->outline->v[i]);
    Polygon *p = polygon_new(v, g->outline->n);
    for (uint32_t y = 0; y < s->height; y++)
        for (uint32_t x = 0; x < s->width; x++)
            n += polygon_contains(p, vec2(x + 0.5, y + 0.5)) && scan_sample(s, x, y, 0) > 200 && scan_sample(s, x, y, 1) > 150;
    polygon_free(p);
    g_free(v);
    return n;
}

/* ---- colours ---- */

/* The parameter file that capture writes for that image. */
static VenParams *captured(const char *image, const char *dir)
{
    GError *error = NULL;
    VenParams *p = scan_params(image);
    VenLeaf *leaf = ven_grow(p, 1, NULL, &error);
    g_assert_no_error(error);
    g_assert_true(ven_write_capture(leaf, dir, "x", &error));
    g_assert_no_error(error);
    ven_leaf_free(leaf);
    ven_params_free(p);
    char *ini = g_build_filename(dir, "x.ini", NULL);
    VenParams *q = ven_params_load(ini, &error);
    g_assert_no_error(error);
    g_free(ini);
    return q;
}

static void check_colours(VenParams *p, const char *how)
{
    set(p, "scan.veins", "none");
    set(p, "scan.texture", "no");
    Ground *plain = ground(p);
    set(p, "scan.texture", "yes");
    Ground *g = ground(p);
    uint32_t before = paper(plain, plain->scan, &plain->to_scan), after = paper(g, g->scan, &g->to_scan);
    g_test_message("%s: %u pixels of paper in the leaf before, %u after; %u holes of %.4f in all", how, before, after, g->holes->n, g->holes->area);
    g_assert_cmpuint(before, >, 4000);
    g_assert_cmpuint(after, ==, 0);
    if (g->back) {
        g_assert_cmpuint(paper(plain, plain->back, &plain->to_back), >, 4000);
        g_assert_cmpuint(paper(g, g->back, &g->to_back), ==, 0);
    }
    g_assert_cmpuint(g->holes->n, ==, 2);
    g_assert_cmpfloat(fabs(g->holes->area - 0.0129), <, 0.0004); /* 5000 of 390 000 pixels² */
    ground_unref(plain);
    ground_unref(g);
}

/* By threshold, by edges, from the drawing; and the other side each time. */
static void test_colours(void)
{
    char *dir = enter(), *image = grape(), *back = g_build_filename(dir, "back.png", NULL);
    write_mirrored(image, back);
    for (int k = 0; k < 3; k++) {
        VenParams *p = k < 2 ? scan_params(image) : captured(image, dir);
        set(p, "scan.back", back);
        if (k == 1)
            set(p, "scan.method", "fang");
        check_colours(p, k == 0 ? "contour" : k == 1 ? "fang" : "drawing");
        ven_params_free(p);
    }
    g_free(back);
    g_free(image);
    leave(dir);
}

/* ---- maps ---- */

/* Integral of a map over the leaf, segments², and the sum of its pixels that lie clear of the rims of holes. */
static double integral(const VenLeaf *leaf, Holes *holes, MapId id, double *in_holes)
{
    PaintStyle style = paint_style_default();
    Frame frame = frame_fit(leaf->net->margin->box, 700, true, 0.02);
    leaf->net->holes = holes;
    style.padding = 0;
    Painter *painter = painter_new(leaf->net, &frame, &style);
    Plane *plane = painter_paint(painter, id);
    const Holes *h = leaf->ground->holes;
    Polygon *ring[2];
    for (uint32_t k = 0; k < 2; k++) {
        Polygon *small = polygon_new(h->p + h->start[k], h->start[k + 1] - h->start[k]);
        ring[k] = polygon_scaled(small, leaf->length);
        polygon_free(small);
    }
    double sum = 0.0;
    *in_holes = 0.0;
    for (uint32_t y = 0; y < plane->height; y++)
        for (uint32_t x = 0; x < plane->width; x++) {
            double v = (double)plane->px[((gsize)y * plane->width + x) * plane->channels];
            Vec2 at = vec2(frame.corner.x + (x + 0.5) / frame.scale, frame.corner.y - (y + 0.5) / frame.scale);
            sum += v;
            for (uint32_t k = 0; k < 2; k++)
                if (box_has(ring[k]->box, at) && polygon_depth(ring[k], at) > 1.0 / frame.scale)
                    *in_holes += v;
        }
    polygon_free(ring[0]);
    polygon_free(ring[1]);
    plane_free(plane);
    painter_free(painter);
    return sum / (frame.scale * frame.scale);
}

/* Opacity loses just the holes' area, exactly; and no map is painted in them. */
static void test_maps(void)
{
    GError *error = NULL;
    char *image = grape();
    VenParams *p = scan_params(image);
    VenLeaf *leaf = ven_grow(p, 1, NULL, &error);
    g_assert_no_error(error);
    Holes *holes = leaf->net->holes;
    g_assert_cmpuint(holes->n, ==, 2);
    double in, whole = integral(leaf, NULL, MAP_OPACITY, &in), open;
    g_assert_cmpfloat(in, >, 1000.0);
    g_assert_cmpfloat(fabs(whole - leaf->net->margin->area), <, 1e-3);
    open = integral(leaf, holes, MAP_OPACITY, &in);
    g_assert_cmpfloat(in, ==, 0.0);
    g_assert_cmpfloat(fabs(open - (leaf->net->margin->area - holes->area)), <, 1e-3);
    static const MapId others[] = {MAP_BASE_COLOR, MAP_TRANSLUCENCY, MAP_THICKNESS};
    for (gsize i = 0; i < G_N_ELEMENTS(others); i++) {
        integral(leaf, holes, others[i], &in);
        g_assert_cmpfloat(in, ==, 0.0);
    }
    ven_leaf_free(leaf);
    ven_params_free(p);
    g_free(image);
}

/* The drawing has them as curves of the blade. */
static void test_svg(void)
{
    GError *error = NULL;
    char *dir = enter(), *image = grape(), *path = g_build_filename(dir, "x.svg", NULL), *text;
    for (int keep = 0; keep < 2; keep++) {
        VenParams *p = scan_params(image);
        set(p, "scan.holes", keep ? "keep" : "fill");
        set(p, "texture.maps", "none");
        set(p, "export.veins_image", "no");
        set(p, "export.network", "no");
        VenLeaf *leaf = ven_grow(p, 1, NULL, &error);
        g_assert_no_error(error);
        g_assert_true(ven_write(leaf, dir, "x", &error));
        g_assert_true(g_file_get_contents(path, &text, NULL, &error));
        char *blade = strstr(text, " d=\"M"), *end = strchr(blade + 6, '"');
        uint32_t curves = 0;
        for (char *c = blade; c < end; c++)
            curves += *c == 'M';
        g_assert_cmpuint(curves, ==, keep ? 3 : 1);
        g_free(text);
        ven_leaf_free(leaf);
        ven_params_free(p);
    }
    g_free(path);
    g_free(image);
    leave(dir);
}

/* Across the margin there is nothing to take away. */
static void test_across(void)
{
    Network *net = network_new(1, 0);
    Vec2 square[4] = {{0, 0}, {40, 0}, {40, 40}, {0, 40}}, hole[4] = {{30.25, 10}, {50, 10}, {50, 20}, {30.25, 20}};
    net->margin = polygon_new(square, 4);
    Holes *h = holes_new();
    holes_add(h, hole, 4);
    g_assert_cmpfloat(fabs(h->area - 197.5), <, 1e-9);
    PaintStyle style = paint_style_default();
    net->holes = h;
    Frame frame = frame_fit((Box2){0, 0, 60, 40}, 120, false, 0.0);
    Painter *painter = painter_new(net, &frame, &style);
    Plane *plane = painter_paint(painter, MAP_OPACITY);
    double sum = 0.0;
    for (gsize i = 0; i < (gsize)plane->width * plane->height; i++)
        sum += (double)plane->px[i];
    g_assert_cmpfloat(fabs(sum / (frame.scale * frame.scale) - (1600.0 - 97.5)), <, 1e-2);
    plane_free(plane);
    painter_free(painter);
    network_free(net);
}

/* ---- the other side ---- */

static void expect_wrong(VenParams *p, const char *front, const char *back)
{
    GError *error = NULL;
    set(p, "scan.back", back);
    Ground *g = ground_new(p->values, false, &error);
    g_assert_null(g);
    g_assert_error(error, SCAN_ERROR, SCAN_ERROR_VALUE);
    g_test_message("%s", error->message);
    g_assert_nonnull(strstr(error->message, front));
    g_assert_nonnull(strstr(error->message, back));
    g_assert_nonnull(strstr(error->message, "%"));
    g_clear_error(&error);
}

/* An ellipse on white, `n` of them one beside the other. */
static void write_ellipses(const char *path, uint32_t n)
{
    Scan *s = scan_new(300 * n, 500, 3, 8);
    for (uint32_t y = 0; y < s->height; y++)
        for (uint32_t x = 0; x < s->width; x++) {
            double u = (x % 300 - 150.0) / 60.0, v = (y - 250.0) / 200.0;
            memset((uint8_t *)s->px + 3 * ((gsize)y * s->width + x), u * u + v * v < 1.0 ? 60 : 250, 3);
        }
    write_scan(s, path);
    scan_free(s);
}

static void test_wrong_back(void)
{
    char *dir = enter(), *image = grape(), *good = g_build_filename(dir, "good.png", NULL), *bad = g_build_filename(dir, "bad.png", NULL);
    write_mirrored(image, good);
    write_ellipses(bad, 1);
    VenParams *p = scan_params(image);
    set(p, "scan.back", good);
    Ground *g = ground(p);
    g_test_message("the right back is off by %.3f %%", 100.0 * g->back_off);
    g_assert_cmpfloat(g->back_off, <, 0.002);
    g_assert_cmpfloat(g->back_off, >, 0.0);
    g_assert_cmpstr(g->note->str, ==, "");
    ground_unref(g);
    expect_wrong(p, image, bad);
    set(p, "scan.back", image); /* the same side again */
    g = ground(p);
    g_assert_nonnull(strstr(g->note->str, "same side"));
    ground_unref(g);
    ven_params_free(p);
    g_free(good);
    g_free(bad);
    g_free(image);
    leave(dir);
}

/* Two leaves on a sheet, an ellipse and one with a broad base, in the other order and other sizes on the back. */
static void write_pair(const char *path, bool turned)
{
    Scan *s = scan_new(700, 500, 3, 8);
    for (uint32_t y = 0; y < s->height; y++)
        for (uint32_t x = 0; x < s->width; x++) {
            double by = turned ? 0.8 : 1.0, mx = turned ? 699.0 - x : x;
            double u = (mx - 170.0) / 70.0, v = (y - 250.0) / 200.0, w = (mx - 500.0) / (150.0 * by), z = (y - 60.0) / (380.0 * by);
            bool ellipse = u * u + v * v < 1.0, wedge = z > 0.0 && z < 1.0 && fabs(w + 0.2 * z * z) < 0.9 * (1.0 - z) * (0.4 + z);
            memset((uint8_t *)s->px + 3 * ((gsize)y * s->width + x), ellipse || wedge ? 60 : 250, 3);
        }
    write_scan(s, path);
    scan_free(s);
}

static void test_second_leaf(void)
{
    char *dir = enter(), *front = g_build_filename(dir, "front.png", NULL), *back = g_build_filename(dir, "back.png", NULL);
    write_pair(front, false);
    write_pair(back, true);
    for (int leaf = 1; leaf <= 2; leaf++) {
        VenParams *p = scan_params(front);
        set(p, "scan.leaf", leaf == 1 ? "1" : "2");
        set(p, "scan.back", back);
        Ground *g = ground(p);
        Vec2 middle = affine_apply(&g->to_scan, polygon_centroid(g->outline)), there = affine_apply(&g->to_back, polygon_centroid(g->outline));
        g_test_message("leaf %d: off by %.2f %%, at %.0f, on the back at %.0f", leaf, 100.0 * g->back_off, middle.x, there.x);
        g_assert_cmpfloat(g->back_off, <, 0.01);
        g_assert_true((middle.x < 350.0) == (there.x > 350.0));
        ground_unref(g);
        ven_params_free(p);
    }
    g_free(front);
    g_free(back);
    leave(dir);
}

/* Both sides of a sheet are searched once. A leaf that takes up most of it keeps its scan, which is read anew for the next leaf: it must be the same. */
static void test_sheet(void)
{
    GError *error = NULL;
    char *dir = enter(), *front = g_build_filename(dir, "front.png", NULL), *back = g_build_filename(dir, "back.png", NULL);
    write_pair(front, false);
    write_pair(back, true);
    VenParams *p = scan_params(front);
    set(p, "scan.back", back);
    GroundScan *sheet = ground_scan_new(p->values, &error);
    g_assert_no_error(error);
    g_assert_cmpuint(ground_scan_leaves(sheet), ==, 2);
    double side[2];
    for (int leaf = 0; leaf < 2; leaf++) {
        set(p, "scan.leaf", leaf ? "2" : "1");
        Ground *g = ground_new_on(sheet, p->values, false, &error);
        g_assert_no_error(error);
        g_assert_cmpfloat(g->back_off, <, 0.01);
        side[leaf] = affine_apply(&g->to_back, polygon_centroid(g->outline)).x;
        ground_unref(g);
    }
    g_assert_cmpfloat(fabs(side[0] - side[1]), >, 200.0);
    g_unlink(front);
    g_assert_null(ground_new_on(sheet, p->values, false, &error));
    g_assert_nonnull(strstr(error->message, "front.png: No such file"));
    g_clear_error(&error);
    Scan *other = scan_new(600, 500, 3, 8);
    memset(other->px, 250, 3 * 600 * 500);
    write_scan(other, front);
    scan_free(other);
    g_assert_null(ground_new_on(sheet, p->values, false, &error));
    g_assert_nonnull(strstr(error->message, "is 600 × 500 pixels now, and was 700 × 500"));
    g_clear_error(&error);
    ground_scan_free(sheet);
    ven_params_free(p);
    g_free(front);
    g_free(back);
    leave(dir);
}

/* ---- the record ---- */

static double fact(const char *record, const char *name)
{
    char *key = g_strdup_printf("\"%s\": ", name);
    const char *at = strstr(strstr(record, "\"scan\": {\n    \"width\""), key);
    g_assert_nonnull(at);
    double v = g_ascii_strtod(at + strlen(key), NULL);
    g_free(key);
    return v;
}

static char *record_of(const char *image, const char *threshold)
{
    GError *error = NULL;
    VenParams *p = scan_params(image);
    if (threshold)
        set(p, "scan.threshold", threshold);
    VenLeaf *leaf = ven_grow(p, 1, NULL, &error);
    g_assert_no_error(error);
    char *record = ven_leaf_record(leaf);
    ven_leaf_free(leaf);
    ven_params_free(p);
    return record;
}

static void test_record(void)
{
    char *image = grape(), *record = record_of(image, NULL);
    double mm = fact(record, "mm_per_pixel"), area = fact(record, "area"), holes = fact(record, "holes_area");
    g_assert_cmpfloat(fabs(mm - 25.4 / 150.0), <, 1e-6);
    g_assert_cmpfloat(fabs(fact(record, "length_mm") - 105.3), <, 0.3); /* by hand: 622 pixels from base to tip at 150 dpi */
    g_assert_cmpfloat(fabs(fact(record, "width_mm") - 141.5), <, 0.3);
    g_assert_cmpfloat(fabs(fact(record, "area_mm2") - mm * mm * (area - holes)), <, 1e-6 * area);
    g_assert_cmpfloat(fabs(fact(record, "perimeter_mm") - mm * fact(record, "perimeter")), <, 1e-6);
    g_assert_cmpfloat(fact(record, "holes"), ==, 2.0);
    g_free(record);
    g_free(image);
}

/* Where outline and veins come from, and how a drawing came to lie on the scan. */
static void test_origins(void)
{
    GError *error = NULL;
    char *dir = enter(), *image = grape(), *record = record_of(image, NULL);
    g_assert_nonnull(strstr(record, "\"outline_from\": \"threshold\""));
    g_assert_nonnull(strstr(record, "\"veins_from\": \"none\""));
    g_assert_nonnull(strstr(record, "\"base_from\": \"petiole\""));
    g_assert_null(strstr(record, "laid_by"));
    g_assert_cmpfloat(fact(record, "beyond_threshold"), >=, fact(record, "holes_area"));
    g_free(record);
    VenParams *p = captured(image, dir);
    VenLeaf *leaf = ven_grow(p, 1, NULL, &error);
    g_assert_no_error(error);
    record = ven_leaf_record(leaf);
    g_assert_nonnull(strstr(record, "\"outline_from\": \"drawing\""));
    g_assert_nonnull(strstr(record, "\"outline_laid_by\": \"its image 'x_scan.jpg', 930 × 1110 units with a corner at 0,0\""));
    g_assert_nonnull(strstr(record, "\"channel\": \"red\""));
    ven_leaf_free(leaf);
    ven_params_free(p);
    g_free(record);
    p = scan_params(image);
    set(p, "outline.path", "M 300,-700 L 900,-650 L 500,-80 Z");
    leaf = ven_grow(p, 1, NULL, &error);
    g_assert_no_error(error);
    record = ven_leaf_record(leaf);
    g_assert_nonnull(strstr(record, "\"outline_from\": \"path\""));
    ven_leaf_free(leaf);
    ven_params_free(p);
    g_free(record);
    g_free(image);
    leave(dir);
}

/* The threshold of a 16-bit image is written as scan.threshold takes it. */
static void test_deep(void)
{
    char *dir = enter(), *image = grape(), *deep = g_build_filename(dir, "deep.png", NULL), level[G_ASCII_DTOSTR_BUF_SIZE];
    Scan *s = read_scan(image), *t = scan_new(s->width, s->height, 3, 16);
    for (gsize i = 0; i < 3 * (gsize)s->width * s->height; i++)
        ((uint16_t *)t->px)[i] = (uint16_t)(257 * ((uint8_t *)s->px)[i]);
    write_scan(t, deep);
    char *record = record_of(deep, NULL);
    double found = fact(record, "threshold");
    g_assert_cmpfloat(fabs(found - 169.5), <, 2.0);
    char *again = record_of(deep, g_ascii_dtostr(level, sizeof level, found));
    g_assert_cmpfloat(fact(record, "area"), ==, fact(again, "area"));
    g_assert_cmpfloat(fact(record, "threshold"), ==, fact(again, "threshold"));
    g_free(record);
    g_free(again);
    scan_free(s);
    scan_free(t);
    g_free(image);
    g_free(deep);
    leave(dir);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/holes/colours", test_colours);
    g_test_add_func("/holes/maps", test_maps);
    g_test_add_func("/holes/svg", test_svg);
    g_test_add_func("/holes/across", test_across);
    g_test_add_func("/holes/wrong-back", test_wrong_back);
    g_test_add_func("/holes/second-leaf", test_second_leaf);
    g_test_add_func("/holes/sheet", test_sheet);
    g_test_add_func("/holes/record", test_record);
    g_test_add_func("/holes/origins", test_origins);
    g_test_add_func("/holes/deep", test_deep);
    return g_test_run();
}
