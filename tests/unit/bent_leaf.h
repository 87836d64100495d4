/* A small bent leaf with maps, rig and keyframes, made by hand, for tests of what is written of it. */
#ifndef BENT_LEAF_H
#define BENT_LEAF_H

#include <glib.h>
#include <glib/gstdio.h>
#include <string.h>

#include "export/model.h"
#include "geom/random.h"
#include "image/file.h"

static char *folder;

static char *in_folder(const char *name) { return g_build_filename(folder, name, NULL); }

static G_GNUC_NO_INLINE char *contents(const char *path, gsize *length)
{
    char *text;
    GError *error = NULL;
    g_file_get_contents(path, &text, length, &error);
    g_assert_no_error(error);
    return text;
}

/* Broader on its right than on its left, folded along the midrib, and drooping. */
enum { SIDES = 8, BALLS = 9, TUBES = 2 };

typedef struct {
    Model m;
    uint32_t columns, rows;
    Surface blade, veins;
    Tube tube[TUBES];
    Sequence sequence[1];
    Skeleton skeleton;
    Rig rig;
    ModelMorph morph[2];
} Leaf;

static double uniform(uint32_t stream, uint64_t index)
{
    double u[2];
    random_pair(21, stream, 0, index, u);
    return u[0];
}

static void surface_alloc(Surface *s, uint32_t n_vertices, uint32_t n_triangles)
{
    *s = (Surface){.n_vertices = n_vertices, .n_triangles = n_triangles, .place = g_new0(Vec3, n_vertices), .normal = g_new0(Vec3, n_vertices),
                   .uv = g_new0(Vec2, n_vertices), .triangle = g_malloc0_n(n_triangles, sizeof *s->triangle)};
}

static void surface_clear(Surface *s)
{
    g_free(s->place);
    g_free(s->normal);
    g_free(s->uv);
    g_free(s->triangle);
}

/* From -4 … 6 across and 0 … 16 along the leaf; `fold` 0 is flat. */
static Vec3 bend(double x, double y, double fold)
{
    double droop = y / 16.0;
    return vec3(x, y, fold * (0.35 * sqrt(x * x + 0.5) - 3.0 * droop * droop));
}

static Vec3 bend_normal(double x, double y, double fold)
{
    return vec3_unit(vec3(-fold * 0.35 * x / sqrt(x * x + 0.5), fold * 6.0 * y / 256.0, 1.0), vec3(0, 0, 1));
}

static void make_blade(Leaf *l, double fold)
{
    uint32_t w = l->columns, h = l->rows, t = 0;
    surface_alloc(&l->blade, w * h, 2 * (w - 1) * (h - 1));
    for (uint32_t i = 0; i < w * h; i++) {
        double v = (double)(i / w) / (h - 1), u = (double)(i % w) / (w - 1), wide = 0.2 + 3.2 * v * (1.0 - v);
        double x = (-4.0 + 10.0 * u) * wide, y = 16.0 * v;
        l->blade.place[i] = bend(x, y, fold);
        l->blade.normal[i] = bend_normal(x, y, fold);
        l->blade.uv[i] = vec2((x + 8.0) / 16.0, y / 16.0); /* the maps show -8 … 8, 0 … 16 */
    }
    for (uint32_t y = 0; y + 1 < h; y++)
        for (uint32_t x = 0; x + 1 < w; x++) {
            uint32_t a = y * w + x, b = a + 1, c = a + w, d = c + 1;
            memcpy(l->blade.triangle[t++], (uint32_t[3]){a, b, d}, 12);
            memcpy(l->blade.triangle[t++], (uint32_t[3]){a, d, c}, 12);
        }
}

/* A petiole and a midrib. */
static void make_tubes(Leaf *l, double fold)
{
    for (uint32_t q = 0; q < TUBES; q++) {
        Tube *t = &l->tube[q];
        *t = (Tube){.sequence = q == 0 ? NO_PARENT : 0, .n = BALLS, .centre = g_new(Vec3, BALLS), .rest = g_new(Vec2, BALLS),
                    .radius = g_new(double, BALLS)};
        for (uint32_t i = 0; i < BALLS; i++) {
            double y = q == 0 ? -0.5 * i : 15.0 * i / (BALLS - 1);
            t->radius[i] = q == 0 ? 0.3 + 0.01 * i : 0.3 - 0.03 * i;
            t->rest[i] = vec2(0.0, MAX(y, 0.0));
            t->centre[i] = vec3_sub(bend(0.0, y, fold), vec3(0.0, 0.0, 0.8 * t->radius[i]));
        }
    }
}

static void add_end(Surface *s, uint32_t *t, uint32_t base, gboolean back)
{
    for (uint32_t j = 1; j + 1 < SIDES; j++)
        memcpy(s->triangle[(*t)++], (uint32_t[3]){base, base + (back ? j + 1 : j), base + (back ? j : j + 1)}, 12);
}

/* Rings square to y. */
static void make_solids(Leaf *l)
{
    static const double side[SIDES][2] = {{1, 0}, {0.7071, 0.7071}, {0, 1}, {-0.7071, 0.7071},
                                          {-1, 0}, {-0.7071, -0.7071}, {0, -1}, {0.7071, -0.7071}};
    Surface *s = &l->veins;
    surface_alloc(s, TUBES * BALLS * SIDES, TUBES * (2 * (BALLS - 1) * SIDES + 2 * (SIDES - 2)));
    uint32_t n = 0, t = 0;
    for (uint32_t q = 0; q < TUBES; q++) {
        uint32_t base = n;
        for (uint32_t i = 0; i < BALLS; i++)
            for (uint32_t j = 0; j < SIDES; j++, n++) {
                s->normal[n] = vec3_unit(vec3(side[j][0], 0.0, side[j][1]), vec3(0, 0, 1));
                s->place[n] = vec3_add(l->tube[q].centre[i], vec3_scale(s->normal[n], l->tube[q].radius[i]));
                s->uv[n] = vec2((l->tube[q].rest[i].x + 8.0) / 16.0, l->tube[q].rest[i].y / 16.0);
            }
        for (uint32_t i = 0; i + 1 < BALLS; i++)
            for (uint32_t j = 0; j < SIDES; j++) {
                uint32_t a = base + i * SIDES + j, b = base + i * SIDES + (j + 1) % SIDES;
                memcpy(s->triangle[t++], (uint32_t[3]){a, a + SIDES, b}, 12);
                memcpy(s->triangle[t++], (uint32_t[3]){b, a + SIDES, b + SIDES}, 12);
            }
        add_end(s, &t, base, FALSE);
        add_end(s, &t, base + (BALLS - 1) * SIDES, TRUE);
    }
}

static void make_attributes(Leaf *l)
{
    uint32_t n = l->blade.n_vertices, *id = g_new0(uint32_t, n);
    uint8_t *order = g_new0(uint8_t, n), *margin = g_new0(uint8_t, n);
    double *radius = g_new0(double, n);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t x = i % l->columns, y = i / l->columns;
        margin[i] = x == 0 || y == 0 || x + 1 == l->columns || y + 1 == l->rows;
        order[i] = (uint8_t)(x % 5 == 2 ? 1 + x % 3 : 0);
        id[i] = order[i] ? 1 + x : 0;
        radius[i] = order[i] ? 0.1 + 0.01 * x : 0.0;
    }
    l->m.vein_order = order;
    l->m.vein_id = id;
    l->m.vein_radius = radius;
    l->m.on_margin = margin;
}

/* Fields that files refer to; the maps have the left half of the leaf in one colour and the right in another, the sides too. */
static void leaf_init(Leaf *l, uint32_t columns, uint32_t rows, double fold)
{
    *l = (Leaf){.columns = columns, .rows = rows};
    make_blade(l, fold);
    make_tubes(l, fold);
    make_solids(l);
    l->sequence[0] = (Sequence){.parent = NO_PARENT, .n = BALLS, .order = 1, .name = "midrib"};
    l->skeleton = (Skeleton){.n_sequences = 1, .sequence = l->sequence};
    l->m = (Model){.name = "oak", .title = "Quercus, a leaf", .generator = "Venation 0", .extras = "{\"seed\": 7, \"list\": [1, 2]}", .unit = 0.005,
                   .blade = &l->blade, .veins = &l->veins, .tubes = l->tube, .n_tubes = TUBES, .skeleton = &l->skeleton,
                   .base_color_file = "oak_base_color.png", .abaxial_base_color_file = "oak_abaxial_base_color.png",
                   .opacity_file = "oak_opacity.png", .normal_file = "oak_normal.png", .roughness_file = "oak_roughness.png",
                   .height_file = "oak_height.png", .translucency_file = "oak_translucency.png"};
    make_attributes(l);
}

static void leaf_clear(Leaf *l)
{
    surface_clear(&l->blade);
    surface_clear(&l->veins);
    for (int q = 0; q < TUBES; q++) {
        g_free(l->tube[q].centre);
        g_free(l->tube[q].rest);
        g_free(l->tube[q].radius);
    }
    g_free((void *)l->m.vein_order);
    g_free((void *)l->m.vein_id);
    g_free((void *)l->m.vein_radius);
    g_free((void *)l->m.on_margin);
    GBytes **image[] = {&l->m.images.base_color, &l->m.images.abaxial_base_color, &l->m.images.normal, &l->m.images.abaxial_normal,
                        &l->m.images.surface, &l->m.images.transmission};
    for (guint i = 0; i < G_N_ELEMENTS(image); i++)
        g_clear_pointer(image[i], g_bytes_unref);
    g_free(l->rig.joint);
    g_free(l->rig.blade_joint);
    g_free(l->rig.blade_weight);
    g_free(l->rig.vein_joint);
    g_free(l->rig.vein_weight);
    for (int k = 0; k < 2; k++) {
        g_free((void *)l->morph[k].blade);
        g_free((void *)l->morph[k].blade_normal);
        g_free((void *)l->morph[k].veins);
        g_free((void *)l->morph[k].vein_normal);
    }
}

/* A picture of two halves, written as `file` in the folder (and kept there when asked for). */
static GBytes *picture(const char *file, uint32_t channels, PlaneKind kind, const float left[4], const float right[4], gboolean keep)
{
    Plane *p = plane_new(16, 16, channels, kind);
    p->low = 0.0;
    p->high = 1.0;
    for (uint32_t i = 0; i < 256; i++)
        for (uint32_t c = 0; c < channels; c++)
            p->px[i * channels + c] = i % 16 < 8 ? left[c] : right[c];
    char *path = in_folder(file);
    Metadata none = {0, NULL, NULL};
    GError *error = NULL;
    image_write_png(p, path, 8, &none, &error);
    g_assert_no_error(error);
    gsize n;
    char *bytes = contents(path, &n);
    if (!keep)
        g_unlink(path);
    g_free(path);
    plane_free(p);
    return g_bytes_new_take(bytes, n);
}

/* Sunny side: red left, blue right; shadow side: yellow left, cyan right (of the leaf, seen from the sunny side). */
static void add_pictures(Leaf *l, gboolean keep)
{
    static const float red[] = {0.8f, 0.02f, 0.02f, 1}, blue[] = {0.02f, 0.02f, 0.8f, 1}, yellow[] = {0.7f, 0.7f, 0.02f, 1},
                       cyan[] = {0.02f, 0.7f, 0.7f, 1}, level[] = {0.5f, 0.5f, 1, 1}, surface[] = {1, 0.6f, 0, 1},
                       pass[] = {1, 1, 1, 0.4f}, solid[4] = {1}, dull[4] = {0.6f}, thin[4] = {0.4f};
    ModelImages *i = &l->m.images;
    i->base_color = picture("oak_base_color.png", 4, PLANE_COLOUR, red, blue, keep);
    i->abaxial_base_color = picture("oak_abaxial_base_color.png", 4, PLANE_COLOUR, yellow, cyan, keep);
    i->normal = picture("oak_normal.png", 3, PLANE_DATA, level, level, keep);
    i->abaxial_normal = picture("oak_abaxial_normal.png", 3, PLANE_DATA, level, level, FALSE);
    i->surface = picture("surface.png", 3, PLANE_DATA, surface, surface, FALSE);
    i->transmission = picture("transmission.png", 4, PLANE_DATA, pass, pass, FALSE);
    if (keep) {
        g_bytes_unref(picture("oak_opacity.png", 1, PLANE_DATA, solid, solid, TRUE));
        g_bytes_unref(picture("oak_roughness.png", 1, PLANE_DATA, dull, dull, TRUE));
        g_bytes_unref(picture("oak_height.png", 1, PLANE_DATA, level, level, TRUE));
        g_bytes_unref(picture("oak_translucency.png", 1, PLANE_DATA, thin, thin, TRUE));
    }
}

/* A chain of joints up the midrib and one to the right of its middle; random weights. */
static void add_rig(Leaf *l, uint32_t per_vertex)
{
    enum { JOINTS = 6 };
    uint32_t n[2] = {l->blade.n_vertices, l->veins.n_vertices};
    uint16_t *joint[2];
    float *weight[2];
    for (int k = 0; k < 2; k++) {
        joint[k] = g_new0(uint16_t, (gsize)n[k] * per_vertex);
        weight[k] = g_new0(float, (gsize)n[k] * per_vertex);
        for (gsize i = 0; i < n[k]; i++) {
            double left = 1.0, last = 1.0;
            uint32_t used = 1 + (uint32_t)(i % MIN(per_vertex, JOINTS));
            for (gsize c = 0; c < used; c++) {
                double w = c + 1 < used ? left * (0.5 + 0.4 * uniform(2, i * 8 + c)) : left;
                last = MIN(last, w);
                weight[k][i * per_vertex + c] = (float)last;
                joint[k][i * per_vertex + c] = (uint16_t)((i + c) % JOINTS);
                left -= last;
            }
            weight[k][i * per_vertex] += (float)left;
            for (gsize c = used; c < per_vertex; c++)
                joint[k][i * per_vertex + c] = 3; /* weighs nothing */
        }
    }
    l->rig = (Rig){.n_joints = JOINTS, .per_vertex = per_vertex, .joint = g_new0(Joint, JOINTS), .n_blade = n[0], .n_veins = n[1],
                   .blade_joint = joint[0], .blade_weight = weight[0], .vein_joint = joint[1], .vein_weight = weight[1]};
    for (uint32_t j = 0; j < JOINTS; j++) {
        Joint *q = &l->rig.joint[j];
        *q = (Joint){.node = j, .parent = j == 0 || j == 5 ? NO_PARENT : j == 4 ? 1 : j - 1, .place = j == 4 ? bend(3, 6, 1) : bend(0, 4.0 * j, 1)};
        g_snprintf(q->name, sizeof q->name, "midrib_%u", j);
    }
    l->m.rig = &l->rig;
}

/* Two keyframes: flat, and folded more. */
static void add_morphs(Leaf *l)
{
    for (int k = 0; k < 2; k++) {
        Leaf other;
        leaf_init(&other, l->columns, l->rows, k == 0 ? 0.0 : 1.6);
        l->morph[k] = (ModelMorph){k == 0 ? "flat" : "folded", other.blade.place, other.blade.normal, other.veins.place, other.veins.normal, 0.5 + k};
        other.blade.place = other.blade.normal = other.veins.place = other.veins.normal = NULL;
        leaf_clear(&other);
    }
    l->m.morph = l->morph;
    l->m.n_morphs = 2;
}

/* glTF's axes, written out once more. */
static Vec3 lying(const Leaf *l, Vec3 p) { return vec3(p.x * l->m.unit, p.z * l->m.unit, -p.y * l->m.unit); }

/* Little-endian numbers of a file. */
static uint32_t u32(const char *p)
{
    const uint8_t *b = (const uint8_t *)p;
    return b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static float f32(const char *p)
{
    uint32_t bits = u32(p);
    float f;
    memcpy(&f, &bits, sizeof f);
    return f;
}

static void assert_near(const double *v, Vec3 p, double within)
{
    g_assert_cmpfloat(fabs(v[0] - p.x), <=, within);
    g_assert_cmpfloat(fabs(v[1] - p.y), <=, within);
    g_assert_cmpfloat(fabs(v[2] - p.z), <=, within);
}

#endif
