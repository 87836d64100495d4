/* The picture of the leaf: exact where nothing is done to it, and each thing that is done as it is meant. */
#include <glib.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#include "geom/random.h"
#include "image/specimen.h"
#include "image/painter.h"
#include "venation.h"

static const Vec2 blade[6] = {{0.0, 0.0}, {12.0, 8.0}, {15.0, 22.0}, {0.0, 40.0}, {-15.0, 22.0}, {-12.0, 8.0}};

/* A midrib with branches. */
static Network *net_new(void)
{
    Network *net = network_new(49, 48);
    net->margin = polygon_new(blade, 6);
    net->n_steps = 40;
    for (uint32_t i = 1; i <= 48; i++) {
        uint32_t branch = i <= 36 ? 0 : 1 + (i - 37) / 6, k = (i - 37) % 6 + 1;
        net->node[i] = branch == 0 ? vec2(0.0, i) : vec2((branch == 1 ? 1.5 : -1.5) * k, 12.0 + k);
        net->tail[i - 1] = branch == 0 || k > 1 ? i - 1 : 12;
        net->head[i - 1] = i;
        net->width[i - 1] = branch == 0 ? 1.6 - 0.03 * i : 0.6;
        net->order[i - 1] = (uint8_t)(branch == 0 ? 1 : 2);
        net->vein[i - 1] = branch;
        net->birth[i - 1] = i / 2;
    }
    net->n_veins = 3;
    return net;
}

static Painter *painter_at(const Network *net, uint32_t size, unsigned threads)
{
    static Frame f; /* outlives the painter */
    PaintStyle style = paint_style_default();
    style.threads = threads;
    f = frame_fit((Box2){-15.0, 0.0, 15.0, 40.0}, size, true, 0.1);
    return painter_new(net, &f, &style);
}

static SpecimenDef nothing(void)
{
    SpecimenDef d = {.abaxial = false};
    paint_colour(0xc8b060, d.background);
    return d;
}

static Plane *picture(const Network *net, uint32_t size, const SpecimenDef *def)
{
    Painter *p = painter_at(net, size, 2);
    Specimen *s = specimen_new(p, def);
    Plane *plane = specimen_paint(s);
    specimen_free(s);
    painter_free(p);
    return plane;
}

static const float *pixel(const Plane *p, uint32_t x, uint32_t y) { return p->px + 3 * ((gsize)y * p->width + x); }

/* ---- plain ---- */

static void test_plain(void)
{
    Network *net = net_new();
    for (int side = 0; side < 2; side++) {
        SpecimenDef d = nothing();
        d.abaxial = side == 1;
        Painter *p = painter_at(net, 150, 2);
        Plane *base = painter_paint(p, side == 1 ? MAP_ABAXIAL_BASE_COLOR : MAP_BASE_COLOR), *opacity = painter_paint(p, MAP_OPACITY);
        Plane *got = picture(net, 150, &d);
        uint32_t partly = 0;
        g_assert_cmpint(got->kind, ==, PLANE_COLOUR);
        for (uint32_t i = 0; i < 150 * 150; i++)
            for (int k = 0; k < 3; k++) {
                double a = (double)opacity->px[i];
                partly += a > 0.0 && a < 1.0;
                g_assert_cmpfloat(got->px[3 * i + k], ==, (float)((double)base->px[3 * i + k] * a + (double)d.background[k] * (1.0 - a)));
            }
        g_assert_cmpuint(partly, >, 100);
        plane_free(base);
        plane_free(opacity);
        plane_free(got);
        painter_free(p);
    }
    network_free(net);
}

/* Everything that can be, by turns; each setting is one that draws. */
static SpecimenDef full(int k)
{
    SpecimenDef d = specimen_def_default();
    d.seed = 17;
    d.abaxial = k % 2 == 1;
    d.backlight = k == 2 ? 0.6 : 0.0;
    d.blur = k == 1 ? 3.7 : k == 2 ? 0.0 : 0.8;
    d.shadow_size = k == 1 ? 0.09 : 0.012;
    return d;
}

static void test_bands(void)
{
    static const uint32_t heights[] = {1, 13, 32, 64, 150};
    static const unsigned threads[] = {1, 2, 7, 3, 1};
    Network *net = net_new();
    for (int k = 0; k < 3; k++) {
        SpecimenDef d = full(k);
        Plane *want = picture(net, 150, &d);
        for (int h = 0; h < 5; h++) {
            Painter *p = painter_at(net, 150, threads[h]);
            Specimen *s = specimen_new(p, &d);
            for (uint32_t y = 0; y < 150; y += heights[h]) {
                uint32_t y1 = MIN(y + heights[h], 150);
                painter_band(p, y, y1);
                Plane *other = y % 2 == 0 ? painter_paint(p, MAP_HEIGHT) : NULL, *part = specimen_paint(s);
                g_assert_cmpuint(part->height, ==, y1 - y);
                g_assert_true(memcmp(part->px, pixel(want, 0, y), (y1 - y) * 450 * sizeof(float)) == 0);
                plane_free(part);
                plane_free(other);
            }
            specimen_free(s);
            painter_free(p);
        }
        plane_free(want);
    }
    network_free(net);
}

/* Other maps come out the same whether a specimen is painted or not. */
static void test_others(void)
{
    Network *net = net_new();
    SpecimenDef d = full(1);
    Painter *with = painter_at(net, 150, 2), *without = painter_at(net, 150, 2);
    Specimen *s = specimen_new(with, &d);
    for (uint32_t y = 0; y < 150; y += 50) {
        painter_band(with, y, y + 50);
        painter_band(without, y, y + 50);
        plane_free(specimen_paint(s));
        for (int i = 0; i < MAP_COUNT; i++) {
            Plane *a = painter_paint(with, (MapId)i), *b = painter_paint(without, (MapId)i);
            g_assert_true(memcmp(a->px, b->px, (gsize)a->width * a->height * a->channels * sizeof(float)) == 0);
            plane_free(a);
            plane_free(b);
        }
    }
    specimen_free(s);
    painter_free(with);
    painter_free(without);
    network_free(net);
}

/* ---- light ---- */

static void test_level(void)
{
    Network *net = net_new();
    SpecimenDef d = nothing();
    Plane *plain = picture(net, 101, &d);
    d.exposure = 1.0;
    Plane *bright = picture(net, 101, &d);
    d.exposure = 0.0;
    d.warmth = 1.0;
    Plane *warm = picture(net, 101, &d);
    d.warmth = 0.0;
    d.vignette = 1.0;
    Plane *dim = picture(net, 101, &d);
    d.vignette = 0.0;
    d.falloff = 0.5;
    d.light_angle = 90.0; /* from above */
    Plane *fallen = picture(net, 101, &d);
    for (gsize i = 0; i < 101 * 101 * 3; i++) {
        g_assert_cmpfloat(fabs((double)bright->px[i] / (double)plain->px[i] - 2.0), <, 1e-6);
        double want = i % 3 == 0 ? pow(2.0, 0.3) : i % 3 == 1 ? 1.0 : pow(2.0, -0.3);
        g_assert_cmpfloat(fabs((double)warm->px[i] / (double)plain->px[i] - want), <, 1e-6);
        double x = (double)(i / 3 % 101) - 50.0, y = (double)(i / 303) - 50.0, r2 = (x * x + y * y) / (50.5 * 50.5);
        g_assert_cmpfloat(fabs((double)dim->px[i] / (double)plain->px[i] - pow(1.0 + 0.5 * r2, -2.0)), <, 1e-6);
        g_assert_cmpfloat(fabs((double)fallen->px[i] / (double)plain->px[i] - (1.0 - 0.5 * ((double)(i / 303) + 0.5) / 101.0)), <, 1e-6);
    }
    plane_free(plain);
    plane_free(bright);
    plane_free(warm);
    plane_free(dim);
    plane_free(fallen);
    network_free(net);
}

/* A vein that stands out on the shadow side is lit on the side that the light comes from, and sunk on the sunny side the other way round;
 * all in all the leaf is about as bright as without. */
static void test_shading(void)
{
    Network *net = net_new();
    for (int k = 0; k < 4; k++) {
        SpecimenDef d = nothing();
        d.abaxial = k < 2;
        Plane *plain = picture(net, 400, &d);
        d.light = 1.0;
        d.light_angle = k % 2 == 0 ? 0.0 : 180.0;
        Plane *lit = picture(net, 400, &d);
        double left = 0.0, right = 0.0, mean = 0.0, radius = 0.5 * 1.1 * 8.0; /* of the midrib there, pixels */
        uint32_t n = 0;
        for (uint32_t y = 150; y < 250; y++)
            for (uint32_t x = 170; x < 230; x++) {
                double ratio = (double)pixel(lit, x, y)[1] / (double)pixel(plain, x, y)[1], aside = x + 0.5 - 200.0;
                mean += ratio;
                n++;
                if (fabs(aside) < radius)
                    *(aside < 0.0 ? &left : &right) += ratio;
            }
        g_assert_cmpfloat(fabs(mean / n - 1.0), <, 0.1);
        bool right_lit = (k % 2 == 0) == d.abaxial;
        g_assert_cmpfloat(right_lit ? right / left : left / right, >, 1.02);
        plane_free(plain);
        plane_free(lit);
    }
    network_free(net);
}

static void test_shadow(void)
{
    Network *net = net_new();
    SpecimenDef d = nothing();
    Plane *plain = picture(net, 200, &d);
    d.shadow = 0.8;
    d.shadow_size = 0.05;
    Plane *even = picture(net, 200, &d);
    Painter *p = painter_at(net, 200, 1);
    const float *opacity = painter_blade(p);
    double far = 0.0, near = 0.0;
    for (uint32_t y = 0; y < 200; y++)
        for (uint32_t x = 0; x < 200; x++) {
            double ratio = (double)pixel(even, x, y)[0] / (double)pixel(plain, x, y)[0];
            if (opacity[y * 200 + x] == 1.0f)
                g_assert_cmpfloat(ratio, ==, 1.0); /* nothing on the leaf itself */
            else
                g_assert_true(ratio <= 1.0 && ratio > 0.2);
        }
    for (uint32_t x = 0; x < 200; x++) { /* a row across: dark at the leaf, light again far away, never lighter on the way to it */
        double left = (double)pixel(even, x, 100)[0], next = (double)pixel(even, x + 1, 100)[0];
        if (opacity[100 * 200 + x + 1] > 0.0f) {
            near = left;
            break;
        }
        g_assert_cmpfloat(next, <=, left + 1e-7);
    }
    far = (double)pixel(even, 0, 100)[0];
    g_assert_cmpfloat(near / far, <, 0.85);
    g_assert_cmpfloat(far, >, 0.999 * (double)d.background[0]);
    d.light = 1e-9; /* too little to shade */
    Plane *same = picture(net, 200, &d);
    for (gsize i = 0; i < 200 * 200 * 3; i++)
        g_assert_cmpfloat(fabs((double)same->px[i] - (double)even->px[i]), <, 1e-5);
    d.light = 1.0;
    d.light_angle = 180.0;
    Plane *thrown = picture(net, 200, &d);
    double left = 0.0, right = 0.0;
    for (uint32_t y = 60; y < 140; y++)
        for (uint32_t x = 0; x < 100; x++) {
            if (opacity[y * 200 + x] == 0.0f && opacity[y * 200 + 199 - x] == 0.0f) {
                left += (double)pixel(thrown, x, y)[0];
                right += (double)pixel(thrown, 199 - x, y)[0];
            }
        }
    g_assert_cmpfloat(right, <, 0.98 * left); /* it falls away from the light */
    plane_free(plain);
    plane_free(even);
    plane_free(same);
    plane_free(thrown);
    painter_free(p);
    network_free(net);
}

static void test_backlight(void)
{
    Network *net = net_new();
    SpecimenDef d = nothing();
    Painter *p = painter_at(net, 120, 1);
    Plane *base = painter_paint(p, MAP_BASE_COLOR), *through = painter_paint(p, MAP_TRANSLUCENCY), *opacity = painter_paint(p, MAP_OPACITY);
    d.backlight = 1.0;
    d.shadow = 1.0; /* where light comes from below there is none */
    d.shadow_size = 0.1;
    Plane *got = picture(net, 120, &d);
    for (gsize i = 0; i < 120 * 120; i++)
        for (int k = 0; k < 3; k++) {
            double want = 3.2 * (double)through->px[i] * pow((double)base->px[3 * i + k], 1.5);
            if (opacity->px[i] == 1.0f)
                g_assert_cmpfloat(fabs((double)got->px[3 * i + k] - want), <, 1e-5);
            else if (opacity->px[i] == 0.0f)
                g_assert_cmpfloat(got->px[3 * i + k], ==, d.background[k]);
        }
    plane_free(base);
    plane_free(through);
    plane_free(opacity);
    plane_free(got);
    painter_free(p);
    network_free(net);
}

/* ---- camera ---- */

/* The plain definition of a Gaussian blur in two dimensions. */
static void test_blur(void)
{
    enum { SIZE = 60 };
    static const double sigma[] = {0.3, 1.0, 2.6};
    Network *net = net_new();
    SpecimenDef d = nothing();
    Plane *plain = picture(net, SIZE, &d);
    for (int k = 0; k < 3; k++) {
        d.blur = sigma[k];
        Plane *got = picture(net, SIZE, &d);
        int reach = (int)ceil(5.0 * sigma[k]);
        for (int y = 0; y < SIZE; y += 3)
            for (int x = 0; x < SIZE; x++) {
                double sum = 0.0, weights = 0.0;
                for (int j = -reach; j <= reach; j++)
                    for (int i = -reach; i <= reach; i++) {
                        double w = exp(-0.5 * (i * i + j * j) / (sigma[k] * sigma[k]));
                        sum += w * (double)pixel(plain, (uint32_t)CLAMP(x + i, 0, SIZE - 1), (uint32_t)CLAMP(y + j, 0, SIZE - 1))[1];
                        weights += w;
                    }
                g_assert_cmpfloat(fabs((double)pixel(got, (uint32_t)x, (uint32_t)y)[1] - sum / weights), <, 1e-3);
            }
        plane_free(got);
    }
    plane_free(plain);
    network_free(net);
}

static double encoded(double c) { return c <= 0.0031308 ? 12.92 * c : 1.055 * pow(c, 1.0 / 2.4) - 0.055; }

/* Of flat paper: the mean stays, the deviation is what was asked for, channels are as they should be to one another, and neighbours don't know of
 * each other. */
static void test_noise(void)
{
    Network *net = network_new(1, 0);
    const uint32_t size = 300;
    static const uint32_t colour[] = {0xe0e0e0, 0x808080, 0x303030};
    for (int k = 0; k < 6; k++) {
        SpecimenDef d = nothing();
        paint_colour(colour[k / 2], d.background);
        *(k % 2 == 0 ? &d.noise : &d.chroma_noise) = 0.02;
        d.seed = 3;
        Plane *got = picture(net, size, &d);
        double sum[3] = {0}, squares[3] = {0}, cross = 0.0, along = 0.0, n = size * size, want = encoded((double)d.background[0]);
        for (uint32_t i = 0; i < size * size; i++) {
            double v[3];
            for (int c = 0; c < 3; c++) {
                v[c] = encoded((double)got->px[3 * i + c]) - want;
                sum[c] += v[c];
                squares[c] += v[c] * v[c];
            }
            cross += v[0] * v[2];
            if (i % size > 0)
                along += v[0] * (encoded((double)got->px[3 * i - 3]) - want);
        }
        for (int c = 0; c < 3; c++) {
            g_assert_cmpfloat(fabs(sum[c] / n), <, 0.004);
            g_assert_cmpfloat(sqrt(squares[c] / n), >, 0.8 * 0.02);
            g_assert_cmpfloat(sqrt(squares[c] / n), <, 1.7 * 0.02);
        }
        if (k % 2 == 0)
            g_assert_cmpfloat(cross / squares[0], >, 0.99);
        else
            g_assert_cmpfloat(cross / squares[0], <, -0.4);
        g_assert_cmpfloat(fabs(along / squares[0]), <, 0.02);
        plane_free(got);
    }
    network_free(net);
}

/* Tones keep their order, and what is black, white or middle grey stays so. */
static void test_contrast(void)
{
    Network *net = network_new(1, 0);
    for (int k = -10; k <= 10; k++) {
        double before = -1.0;
        for (uint32_t v = 0; v <= 255; v += 5) {
            SpecimenDef d = nothing();
            d.background[0] = d.background[1] = d.background[2] = (float)v / 255.0f;
            d.contrast = k / 10.0;
            Plane *got = picture(net, 1, &d);
            double light = (double)got->px[0], own = (double)d.background[0];
            g_assert_cmpfloat(light, >, before - 1e-9);
            if (v == 0 || v == 255)
                g_assert_cmpfloat(fabs(light - own), <, 1e-7);
            else if (k > 0)
                g_assert_true(own < 0.25 ? light < own : light > own);
            else if (k < 0)
                g_assert_true(own < 0.25 ? light > own : light < own);
            before = light;
            plane_free(got);
        }
    }
    network_free(net);
}

/* ---- all of it ---- */

enum { KNOBS = 14 };

static double *knob(SpecimenDef *d, int k)
{
    double *all[KNOBS] = {&d->grain, &d->light, &d->light_angle, &d->backlight, &d->sheen, &d->falloff, &d->vignette, &d->shadow,
                          &d->shadow_size, &d->blur, &d->exposure, &d->contrast, &d->warmth, &d->noise};
    return all[k];
}

static const double low[KNOBS] = {0, 0, -360, 0, 0, 0, 0, 0, 0, 0, -3, -1, -1, 0}, high[KNOBS] = {1, 2, 360, 1, 1, 0.9, 1, 1, 0.2, 16, 3, 1, 1, 0.2};

static double greatest(const Plane *a, const Plane *b)
{
    double most = 0.0;
    for (gsize i = 0; i < (gsize)a->width * a->height * 3; i++) {
        g_assert_true(isfinite(a->px[i]) && isfinite(b->px[i]));
        most = MAX(most, fabs((double)a->px[i] - (double)b->px[i]));
    }
    return most;
}

/* Small steps of a parameter make small steps of the picture, all over its range, and from 0 on. */
static void test_continuous(void)
{
    Network *net = net_new();
    for (int k = 0; k < KNOBS; k++)
        for (int i = 0; i <= 6; i++) {
            SpecimenDef d = specimen_def_default();
            double step = 1e-5 * (high[k] - low[k]);
            *knob(&d, k) = low[k] + (high[k] - low[k]) * i / 6.0 - (i == 6 ? step : 0.0);
            Plane *a = picture(net, 64, &d);
            *knob(&d, k) += step;
            Plane *b = picture(net, 64, &d);
            g_assert_cmpfloat(greatest(a, b), <, k == 9 ? 5e-3 : 1e-3);
            plane_free(a);
            plane_free(b);
        }
    network_free(net);
}

/* No veins, no blade, one pixel, all at its ends. */
static void test_degenerate(void)
{
    for (int k = 0; k < 6; k++) {
        Network *net = k % 3 == 0 ? net_new() : network_new(1, 0);
        if (k % 3 == 1)
            net->margin = polygon_new(blade, 6);
        SpecimenDef d = specimen_def_default();
        for (int i = 0; i < KNOBS; i++)
            *knob(&d, i) = k < 3 ? high[i] : low[i];
        Plane *small = picture(net, 1, &d), *odd = picture(net, 37, &d), *again = picture(net, 37, &d);
        g_assert_true(isfinite(small->px[0]));
        g_assert_cmpfloat(greatest(odd, again), ==, 0.0);
        plane_free(small);
        plane_free(odd);
        plane_free(again);
        network_free(net);
    }
    specimen_free(NULL);
}

/* ---- files ---- */

static char *bytes_of(const char *dir, const char *name, gsize *length)
{
    char *path = g_build_filename(dir, name, NULL), *bytes = NULL;
    if (!g_file_get_contents(path, &bytes, length, NULL))
        *length = 0;
    g_remove(path);
    g_free(path);
    return bytes;
}

static VenLeaf *leaf_with(const char *specimen, const char *seed)
{
    const char *setting[][2] = {{"growth.kind", "isogonic"}, {"growth.initial_length", "15"}, {"growth.final_length", "50"},
                                {"growth.step", "1.5"}, {"sources.density", "0.01"}, {"texture.size", "64"}, {"texture.maps", "areole"},
                                {"texture.exr", "none"}, {"export.svg", "no"}, {"export.network", "no"}, {"export.veins_image", "no"},
                                {"export.specimen", specimen}, {"specimen.seed", seed}};
    VenParams *p = ven_params_new();
    GError *error = NULL;
    for (gsize i = 0; i < G_N_ELEMENTS(setting); i++)
        g_assert_true(ven_params_set(p, setting[i][0], setting[i][1], &error));
    VenLeaf *leaf = ven_grow(p, 1, NULL, &error);
    g_assert_no_error(error);
    ven_params_free(p);
    return leaf;
}

/* An 8-bit RGB file beside the maps when asked for, another one with another seed; label maps of areoles have 16 bits. */
static void test_file(void)
{
    static const char *const seed[] = {"0", "1", "5"}; /* the run's is 1 */
    char *dir = g_dir_make_tmp("venation-XXXXXX", NULL), *file[3];
    gsize length[3];
    for (int k = 0; k < 3; k++) {
        GError *error = NULL;
        VenLeaf *leaf = leaf_with("yes", seed[k]);
        g_assert_true(ven_write(leaf, dir, "a", &error));
        g_assert_no_error(error);
        file[k] = bytes_of(dir, "a_specimen.png", &length[k]);
        g_assert_cmpuint(length[k], >, 1000);
        g_assert_cmpint(file[k][24], ==, 8);
        g_assert_cmpint(file[k][25], ==, 2);
        gsize n;
        char *map = bytes_of(dir, "a_areole.png", &n);
        g_assert_cmpint(map[24], ==, 16);
        g_assert_cmpint(map[25], ==, 0);
        g_free(map);
        ven_leaf_free(leaf);
    }
    g_assert_false(length[0] == length[2] && memcmp(file[0], file[2], length[0]) == 0);
    VenLeaf *leaf = leaf_with("no", "0");
    g_assert_true(ven_write(leaf, dir, "b", NULL));
    gsize n;
    g_assert_null(bytes_of(dir, "b_specimen.png", &n));
    ven_leaf_free(leaf);
    g_free(bytes_of(dir, "b_areole.png", &n));
    g_free(bytes_of(dir, "a.json", &n));
    g_free(bytes_of(dir, "b.json", &n));
    g_assert_cmpint(g_rmdir(dir), ==, 0);
    for (int k = 0; k < 3; k++)
        g_free(file[k]);
    g_free(dir);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/specimen/plain", test_plain);
    g_test_add_func("/specimen/bands", test_bands);
    g_test_add_func("/specimen/others", test_others);
    g_test_add_func("/specimen/level", test_level);
    g_test_add_func("/specimen/shading", test_shading);
    g_test_add_func("/specimen/shadow", test_shadow);
    g_test_add_func("/specimen/backlight", test_backlight);
    g_test_add_func("/specimen/blur", test_blur);
    g_test_add_func("/specimen/noise", test_noise);
    g_test_add_func("/specimen/contrast", test_contrast);
    g_test_add_func("/specimen/continuous", test_continuous);
    g_test_add_func("/specimen/degenerate", test_degenerate);
    g_test_add_func("/specimen/file", test_file);
    return g_test_run();
}
