/* From a leaf to its picture and back: a grown leaf is painted, captured again, and held against what it was. */
#include <glib.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#include "export/drawing.h"
#include "geom/dtrig.h"
#include "image/file.h"
#include "image/paint.h"
#include "image/photo.h"
#include "lib/ground.h"
#include "lib/leaf.h"
#include "lib/settings.h"
#include "scan/found.h"

/* ---- a picture of a leaf ---- */

typedef struct {
    char *dir;
    VenLeaf *leaf;
    Frame frame;
    char *front;
} Picture;

static void set(VenParams *p, const char *key, const char *value)
{
    GError *error = NULL;
    ven_params_set(p, key, value, &error);
    g_assert_no_error(error);
}

/* The base colour on white. */
static void paint_on_white(const Picture *pic, const char *path)
{
    PaintStyle style = paint_style_default();
    style.padding = 4;
    Painter *painter = painter_new(pic->leaf->net, &pic->frame, &style);
    Plane *colour = painter_paint(painter, MAP_BASE_COLOR), *opacity = painter_paint(painter, MAP_OPACITY);
    for (gsize i = 0; i < (gsize)colour->width * colour->height; i++)
        for (int c = 0; c < 3; c++)
            colour->px[3 * i + c] = colour->px[3 * i + c] * opacity->px[i] + (1.0f - opacity->px[i]);
    GError *error = NULL;
    image_write_png(colour, path, 8, NULL, &error);
    g_assert_no_error(error);
    plane_free(colour);
    plane_free(opacity);
    painter_free(painter);
}

static void picture_init(Picture *pic, uint32_t size)
{
    GError *error = NULL;
    VenParams *p = ven_params_new();
    set(p, "growth.kind", "isogonic");
    set(p, "growth.initial_length", "30");
    set(p, "growth.final_length", "160");
    set(p, "growth.step", "2");
    set(p, "sources.density", "0.004");
    set(p, "sources.birth_distance_sources", "8");
    set(p, "sources.birth_distance_veins", "8");
    set(p, "veins.kill_distance", "2");
    pic->dir = g_dir_make_tmp("venation-capture-XXXXXX", &error);
    pic->leaf = ven_grow(p, 3, NULL, &error);
    g_assert_no_error(error);
    ven_params_free(p);
    pic->frame = frame_fit(pic->leaf->net->margin->box, size, true, 0.08);
    pic->front = g_build_filename(pic->dir, "front.png", NULL);
    paint_on_white(pic, pic->front);
}

static void picture_clear(Picture *pic)
{
    GDir *dir = g_dir_open(pic->dir, 0, NULL);
    const char *name;
    while (dir && (name = g_dir_read_name(dir))) {
        char *path = g_build_filename(pic->dir, name, NULL);
        g_unlink(path);
        g_free(path);
    }
    if (dir)
        g_dir_close(dir);
    g_rmdir(pic->dir);
    g_free(pic->dir);
    g_free(pic->front);
    ven_leaf_free(pic->leaf);
}

static Vec2 to_pixel(const Picture *pic, Vec2 segment)
{
    const Frame *f = &pic->frame;
    return vec2((segment.x - f->corner.x) * f->scale, (f->corner.y - segment.y) * f->scale);
}

static VenParams *scan_params(const char *image)
{
    GError *error = NULL;
    VenParams *p = ven_params_new();
    ven_params_use_scan(p, image, &error);
    g_assert_no_error(error);
    return p;
}

/* ---- the way round ---- */

static Polygon *in_pixels(const Vec2 *v, uint32_t n, Vec2 (*place)(Vec2 p, gconstpointer user), gconstpointer user)
{
    Vec2 *q = g_new(Vec2, n);
    for (uint32_t i = 0; i < n; i++)
        q[i] = place(v[i], user);
    Polygon *p = polygon_new(q, n);
    g_free(q);
    return p;
}

static Vec2 of_picture(Vec2 p, gconstpointer user) { return to_pixel(user, p); }
static Vec2 of_ground(Vec2 p, gconstpointer user) { return affine_apply(&((const Ground *)user)->to_scan, p); }

/* How far vertices of one outline lie from the other, pixels. */
static double farthest(const Polygon *from, const Polygon *to)
{
    double far = 0.0;
    for (uint32_t i = 0; i < from->n; i++)
        far = MAX(far, fabs(polygon_depth(to, from->v[i])));
    return far;
}

/* Within a pixel both ways, the pointed tip included. */
static void check_outline(const Picture *pic, const Ground *g, const char *method)
{
    const Polygon *margin = pic->leaf->net->margin;
    Polygon *truth = in_pixels(margin->v, margin->n, of_picture, pic), *found = in_pixels(g->outline->v, g->outline->n, of_ground, g);
    Vec2 tip = to_pixel(pic, vec2(0, pic->leaf->length));
    double there = farthest(found, truth), back = farthest(truth, found), lost = fabs(polygon_depth(found, tip));
    g_test_message("%s: outline within %.2f, margin within %.2f of it, tip within %.2f pixels", method, there, back, lost);
    g_assert_cmpfloat(there, <, 1.0);
    g_assert_cmpfloat(back, <, 1.0);
    g_assert_cmpfloat(lost, <, 0.5);
    polygon_free(truth);
    polygon_free(found);
}

static void test_outline(void)
{
    static const char *const method[] = {"contour", "fang"};
    Picture pic;
    picture_init(&pic, 900);
    for (int k = 0; k < 2; k++) {
        GError *error = NULL;
        VenParams *p = scan_params(pic.front);
        set(p, "scan.method", method[k]);
        set(p, "scan.tolerance", "0.3");
        if (k == 1) { /* which method fang does not use, and says so */
            g_assert_null(ground_new(p->values, false, &error));
            g_assert_error(error, SETTINGS_ERROR, SETTINGS_ERROR_CONFLICT);
            g_clear_error(&error);
            set(p, "scan.tolerance", "1");
        }
        Ground *g = ground_new(p->values, false, &error);
        g_assert_no_error(error);
        check_outline(&pic, g, method[k]);
        g_assert_cmpfloat(vec_dist(affine_apply(&g->to_scan, vec2(0, 0)), to_pixel(&pic, vec2(0, 0))), <, 6.0);
        g_assert_cmpfloat(vec_dist(affine_apply(&g->to_scan, vec2(0, 1)), to_pixel(&pic, vec2(0, pic.leaf->length))), <, 6.0);
        ground_unref(g);
        ven_params_free(p);
    }
    picture_clear(&pic);
}

/* Veins of the first orders as lines in leaf coordinates. */
static Drawing *true_veins(const Network *net, double length, uint32_t orders)
{
    Drawing *d = drawing_new();
    for (uint32_t e = 0; e < net->n_edges; e++) {
        Vec2 p[2] = {vec_scale(net->node[net->tail[e]], 1.0 / length), vec_scale(net->node[net->head[e]], 1.0 / length)};
        if (net->order[e] <= orders)
            drawing_add(d, p, NULL, 2, net->order[e], NULL);
    }
    return d;
}

static void test_veins(void)
{
    Picture pic;
    GError *error = NULL;
    picture_init(&pic, 1200);
    VenParams *p = scan_params(pic.front);
    Ground *g = ground_new(p->values, true, &error);
    g_assert_no_error(error);
    g_assert_true(g->found);
    Drawing *larger = true_veins(pic.leaf->net, pic.leaf->length, 2), *all = true_veins(pic.leaf->net, pic.leaf->length, 255);
    double precision = found_score(g->drawing, all, 0.01).precision, recall = found_score(g->drawing, larger, 0.01).recall;
    g_test_message("%u veins found: precision %.3f, recall of primaries and secondaries %.3f", g->drawing->n, precision, recall);
    g_assert_cmpfloat(precision, >, 0.95);
    g_assert_cmpfloat(recall, >, 0.85);
    drawing_free(larger);
    drawing_free(all);
    ground_unref(g);
    ven_params_free(p);
    picture_clear(&pic);
}

/* What capture writes reads back: outline, ends and veins are where they were. */
static void test_drawing(void)
{
    Picture pic;
    GError *error = NULL;
    picture_init(&pic, 900);
    VenParams *p = scan_params(pic.front);
    set(p, "veins.origin", "drawn");
    VenLeaf *leaf = ven_grow(p, 1, NULL, &error);
    g_assert_no_error(error);
    g_assert_true(ven_write_capture(leaf, pic.dir, "again", &error));
    g_assert_no_error(error);
    char *ini = g_build_filename(pic.dir, "again.ini", NULL);
    VenParams *q = ven_params_load(ini, &error);
    g_assert_no_error(error);
    Ground *g = ground_new(q->values, true, &error);
    g_assert_no_error(error);
    double pixel = 1.0 / vec_dist(g->base, g->tip);
    g_assert_false(g->found);
    g_assert_cmpuint(g->outline->n, ==, leaf->ground->outline->n);
    for (uint32_t i = 0; i < g->outline->n; i++)
        g_assert_cmpfloat(vec_dist(affine_apply(&g->to_scan, g->outline->v[i]), affine_apply(&leaf->ground->to_scan, leaf->ground->outline->v[i])), <,
                          0.05);
    g_assert_cmpuint(g->drawing->n, ==, leaf->ground->drawing->n);
    FoundScore score = found_score(g->drawing, leaf->ground->drawing, 0.1 * pixel);
    g_assert_cmpfloat(score.precision, >, 0.9999);
    g_assert_cmpfloat(score.recall, >, 0.9999);
    for (uint32_t i = 0; i < g->drawing->n; i++)
        g_assert_cmpuint(g->drawing->vein[i].order, >=, 1);
    ground_unref(g);
    ven_params_free(q);
    ven_params_free(p);
    ven_leaf_free(leaf);
    g_free(ini);
    picture_clear(&pic);
}

/* A margin traced by hand, as a text file in pixels of the scan, is taken as it is. */
static void test_traced(void)
{
    Picture pic;
    GError *error = NULL;
    picture_init(&pic, 400);
    const Polygon *margin = pic.leaf->net->margin;
    Polygon *truth = in_pixels(margin->v, margin->n, of_picture, &pic);
    GString *text = g_string_new(NULL);
    for (uint32_t i = 0; i < truth->n; i++)
        g_string_append_printf(text, "%.3f\t%.3f\n", truth->v[i].x, truth->v[i].y);
    char *file = g_build_filename(pic.dir, "blade.txt", NULL);
    g_assert_true(g_file_set_contents(file, text->str, -1, NULL));
    VenParams *p = scan_params(pic.front);
    set(p, "outline.file", file);
    Ground *g = ground_new(p->values, false, &error);
    g_assert_no_error(error);
    Polygon *found = in_pixels(g->outline->v, g->outline->n, of_ground, g);
    g_assert_cmpfloat(farthest(found, truth), <, 0.01);
    g_assert_cmpfloat(farthest(truth, found), <, 0.01);
    g_assert_cmpfloat(vec_dist(affine_apply(&g->to_scan, vec2(0, 1)), to_pixel(&pic, vec2(0, pic.leaf->length))), <, 0.01);
    polygon_free(truth);
    polygon_free(found);
    g_string_free(text, TRUE);
    g_free(file);
    ground_unref(g);
    ven_params_free(p);
    picture_clear(&pic);
}

/* ---- the other side ---- */

/* The picture mirrored, turned by `angle` and moved, as when the leaf is turned over on the scanner; *map receives front to back pixels. */
static void write_back(const char *front, const char *path, double angle, Affine *map)
{
    GError *error = NULL;
    Scan *s = scan_read(front, 0, &error);
    g_assert_no_error(error);
    double c = dtrig_cos(angle), sn = dtrig_sin(angle), w = s->width, h = s->height;
    *map = (Affine){.a = -c, .b = -sn, .c = -sn, .d = c, .e = 0.5 * w + 0.5 * w * c + 0.5 * h * sn, .f = 0.5 * h + 0.5 * w * sn - 0.5 * h * c};
    Plane *out = plane_new(s->width, s->height, 3, PLANE_DATA);
    out->low = 0.0;
    out->high = 255.0;
    for (uint32_t y = 0; y < s->height; y++)
        for (uint32_t x = 0; x < s->width; x++) {
            Vec2 q = vec2(x + 0.5 - map->e, y + 0.5 - map->f); /* the linear part is its own inverse */
            Vec2 at = vec2(map->a * q.x + map->c * q.y, map->b * q.x + map->d * q.y);
            bool in = at.x >= 0.0 && at.y >= 0.0 && at.x < w && at.y < h;
            for (uint32_t k = 0; k < 3; k++)
                out->px[3 * ((gsize)y * s->width + x) + k] = in ? (float)scan_sample(s, (uint32_t)at.x, (uint32_t)at.y, k) : 255.0f;
        }
    image_write_png(out, path, 8, NULL, &error);
    g_assert_no_error(error);
    plane_free(out);
    scan_free(s);
}

static void test_back(void)
{
    Picture pic;
    GError *error = NULL;
    Affine map;
    picture_init(&pic, 900);
    char *back = g_build_filename(pic.dir, "back.png", NULL);
    write_back(pic.front, back, 0.3, &map);
    VenParams *p = scan_params(pic.front);
    set(p, "scan.back", back);
    Ground *g = ground_new(p->values, false, &error);
    g_assert_no_error(error);
    double far = 0.0;
    for (uint32_t i = 0; i < g->outline->n; i++) {
        Vec2 inner = vec_lerp(vec2(0.0, 0.5), g->outline->v[i], 0.7);
        Vec2 there = affine_apply(&map, affine_apply(&g->to_scan, inner));
        far = MAX(far, vec_dist(affine_apply(&g->to_back, inner), there));
    }
    g_test_message("back laid onto front within %.2f pixels", far);
    g_assert_cmpfloat(far, <, 2.0);
    ground_unref(g);
    ven_params_free(p);
    g_free(back);
    picture_clear(&pic);
}

/* ---- colours ---- */

/* A linear ramp is read as it is between pixels, and its mean over any square is its middle. */
static void test_photo(void)
{
    enum { W = 64, H = 48 };
    Scan *s = scan_new(W, H, 3, 16);
    for (uint32_t y = 0; y < H; y++)
        for (uint32_t x = 0; x < W; x++)
            for (uint32_t c = 0; c < 3; c++)
                ((uint16_t *)s->px)[3 * (y * W + x) + c] = (uint16_t)(20000 + 100 * x + 50 * y * c);
    const float plain[3] = {1.0f, 1.0f, 1.0f}, half[3] = {0.5f, 0.5f, 0.5f};
    Affine to_scan = {.a = 2.0, .d = -2.0, .e = 5.0, .f = 40.0};
    Photo *p = photo_new(s, &to_scan, plain), *q = photo_new(s, &to_scan, half);
    g_assert_cmpfloat(fabs(photo_scale(p) - 2.0), <, 1e-12);
    for (int k = 0; k < 50; k++) {
        Vec2 at = vec2(1.0 + 0.5 * k, 3.0 + 0.25 * k), px = affine_apply(&to_scan, at);
        float fine[3], wide[3], dim[3];
        photo_colour(p, at, 0.1, fine);
        photo_colour(p, at, 3.0, wide);
        photo_colour(q, at, 0.1, dim);
        for (int c = 0; c < 3; c++) {
            double code = (20000.0 + 100.0 * (px.x - 0.5) + 50.0 * (px.y - 0.5) * c) / 65535.0;
            double linear = pow((code + 0.055) / 1.055, 2.4);
            g_assert_cmpfloat(fabs((double)fine[c] - linear), <, 1e-4);
            g_assert_cmpfloat(fabs((double)wide[c] - linear), <, 2e-3);
            g_assert_cmpfloat(fabs((double)dim[c] - 0.5 * linear), <, 1e-4);
        }
    }
    photo_free(p);
    photo_free(q);
    scan_free(s);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/capture/outline", test_outline);
    g_test_add_func("/capture/veins", test_veins);
    g_test_add_func("/capture/drawing", test_drawing);
    g_test_add_func("/capture/traced", test_traced);
    g_test_add_func("/capture/back", test_back);
    g_test_add_func("/capture/photo", test_photo);
    return g_test_run();
}
