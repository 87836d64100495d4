/* POV-Ray 3.7: an include file in the layout of Hong 2005, fig. C.6, and a scene that frames the leaf and lights it. */
#include <string.h>

#include "export/export.h"
#include "export/model_file.h"

/* POV-Ray is left-handed. Turning the sunny side to -z, where its default camera stands, and keeping x and y, gives leaf space without
 * mirroring it. Adding 0 makes no number -0. */
static Vec3 pov_axes(Vec3 p) { return vec3(p.x + 0.0, p.y + 0.0, 0.0 - p.z); }

static void put_vector(GString *s, Vec3 p)
{
    g_string_append_c(s, '<');
    sink_millionths(s, p.x);
    g_string_append(s, ", ");
    sink_millionths(s, p.y);
    g_string_append(s, ", ");
    sink_millionths(s, p.z);
    g_string_append_c(s, '>');
}

static void put_comment(GString *s, const char *text)
{
    if (text == NULL || text[0] == '\0')
        return;
    g_string_append(s, "// ");
    model_put_line(s, text);
    g_string_append_c(s, '\n');
}

/* A quoted string of the scene language. */
static void put_string(GString *s, const char *text)
{
    g_string_append_c(s, '"');
    for (const char *c = text; *c != '\0'; c++) {
        if (*c == '"' || *c == '\\')
            g_string_append_c(s, '\\');
        g_string_append_c(s, *c);
    }
    g_string_append_c(s, '"');
}

/* Which vein it is: "// vein4: L2, order 2, leaves midrib". */
static void put_vein_comment(const Model *m, const Tube *t, uint32_t index, GString *s)
{
    const Skeleton *sk = m->skeleton;
    g_string_append_printf(s, "// vein%u: ", index);
    if (sk == NULL || t->sequence >= sk->n_sequences) {
        g_string_append(s, "petiole\n");
        return;
    }
    const Sequence *q = &sk->sequence[t->sequence];
    model_put_line(s, q->name);
    g_string_append_printf(s, ", order %u", q->order);
    if (q->parent != NO_PARENT) {
        g_string_append(s, ", leaves ");
        model_put_line(s, sk->sequence[q->parent].name);
    }
    g_string_append(s, t->petiole > 0 ? ", with the petiole\n" : "\n");
}

static void put_sweep(const Tube *t, uint32_t index, Sink *out)
{
    g_string_append_printf(out->text, "#declare vein%u = sphere_sweep {\n    linear_spline,\n    %u,\n", index, t->n);
    for (uint32_t i = 0; i < t->n; i++) {
        g_string_append(out->text, "    ");
        put_vector(out->text, pov_axes(t->centre[i]));
        g_string_append(out->text, ", ");
        sink_millionths(out->text, t->radius[i]);
        g_string_append(out->text, i + 1 < t->n ? ",\n" : "\n");
        sink_drain(out);
    }
    g_string_append(out->text, "}\n\n");
}

/* Balls in one place or tubes of one ball are nothing that can be swept. */
static gboolean is_sweep(const Tube *t)
{
    for (uint32_t i = 1; i < t->n; i++)
        if (vec3_dist(t->centre[i], t->centre[0]) > 0.0)
            return TRUE;
    return FALSE;
}

static uint32_t put_veins(const Model *m, Sink *out)
{
    uint32_t n = 0;
    for (uint32_t q = 0; q < m->n_tubes; q++)
        if (is_sweep(&m->tubes[q])) {
            put_vein_comment(m, &m->tubes[q], n, out->text);
            put_sweep(&m->tubes[q], n++, out);
        }
    if (n == 0)
        return 0;
    g_string_append(out->text, "#declare vein = union {\n");
    for (uint32_t i = 0; i < n; i++)
        g_string_append_printf(out->text, "    object { vein%u }\n", i);
    g_string_append(out->text, "}\n\n");
    return n;
}

static void put_vectors(const char *name, const Vec3 *v, uint32_t n, gboolean normal, Sink *out)
{
    g_string_append_printf(out->text, "    %s {\n        %u", name, n);
    for (uint32_t i = 0; i < n; i++) {
        g_string_append(out->text, ",\n        ");
        put_vector(out->text, pov_axes(normal ? vec3_unit(v[i], vec3(0.0, 0.0, 1.0)) : v[i]));
        sink_drain(out);
    }
    g_string_append(out->text, "\n    }\n");
}

static void put_mesh(const char *name, const Surface *f, Sink *out)
{
    g_string_append_printf(out->text, "#declare %s = mesh2 {\n", name);
    put_vectors("vertex_vectors", f->place, f->n_vertices, FALSE, out);
    put_vectors("normal_vectors", f->normal, f->n_vertices, TRUE, out);
    g_string_append_printf(out->text, "    uv_vectors {\n        %u", f->n_vertices);
    for (uint32_t i = 0; i < f->n_vertices; i++) {
        g_string_append(out->text, ",\n        <");
        sink_millionths(out->text, f->uv[i].x);
        g_string_append(out->text, ", ");
        sink_millionths(out->text, f->uv[i].y);
        g_string_append_c(out->text, '>');
        sink_drain(out);
    }
    g_string_append_printf(out->text, "\n    }\n    face_indices {\n        %u", f->n_triangles);
    for (uint32_t t = 0; t < f->n_triangles; t++) {
        g_string_append_printf(out->text, ",\n        <%u, %u, %u>", f->triangle[t][0], f->triangle[t][1], f->triangle[t][2]);
        sink_drain(out);
    }
    g_string_append(out->text, "\n    }\n}\n\n");
}

/* What one side of the blade looks like. */
typedef struct {
    const char *name, *colour, *plain, *gloss;
    double bump; /* of the height map, in which veins are raised */
} Side;

/* `back`: part of the light from the other side that comes through. The maps of the blade are not colours, hence linear. */
static void put_look(GString *s, const Model *m, const Side *side, const char *back)
{
    g_string_append(s, "pigment { uv_mapping ");
    if (side->colour != NULL) {
        g_string_append(s, "image_map { png ");
        put_string(s, side->colour);
        g_string_append(s, " interpolate 2 } }");
    } else {
        g_string_append_printf(s, "rgb %s }", side->plain);
    }
    if (m->height_file != NULL) {
        g_string_append(s, " normal { uv_mapping bump_map { png ");
        put_string(s, m->height_file);
        g_string_append(s, " gamma 1.0 interpolate 2 bump_size ");
        export_number(s, side->bump);
        g_string_append(s, " } }");
    }
    g_string_append_printf(s, " finish { ambient 0 diffuse 0.75, %s %s }", back, side->gloss);
}

static void put_side(GString *s, const Model *m, const Side *side)
{
    bool cut = m->holes && m->opacity_file != NULL;
    g_string_append_printf(s, "#ifndef (%s)\n#declare %s = texture {\n    ", side->name, side->name);
    if (cut) {
        g_string_append(s, "uv_mapping image_pattern { png ");
        put_string(s, m->opacity_file);
        g_string_append(s, " gamma 1.0 interpolate 2 }\n    texture_map {\n        [0.5 pigment { rgbt 1 } finish { ambient 0 diffuse 0 }]\n        [0.5 ");
    }
    if (m->translucency_file != NULL) {
        g_string_append(s, "uv_mapping image_pattern { png ");
        put_string(s, m->translucency_file);
        g_string_append(s, " gamma 1.0 interpolate 2 }\n    texture_map {\n        [0 ");
        put_look(s, m, side, "0");
        g_string_append(s, "]\n        [1 ");
        put_look(s, m, side, "1");
        g_string_append(s, "]\n    }");
    } else {
        put_look(s, m, side, "0.45");
    }
    if (cut)
        g_string_append(s, "]\n    }");
    g_string_append(s, "\n}\n#end\n\n");
}

/* Sweeps have no uv. */
static void put_vein_texture(GString *s, const char *name, const char *colour)
{
    static const char plain[] = "rgb <0.57, 0.62, 0.34>";
    g_string_append_printf(s, "#ifndef (%s)\n#declare %s = texture {\n    pigment { ", name, name);
    if (colour != NULL) {
        g_string_append(s, "uv_mapping image_map { png ");
        put_string(s, colour);
        g_string_append(s, " interpolate 2 }");
    } else {
        g_string_append(s, plain);
    }
    g_string_append(s, " }\n    finish { ambient 0 diffuse 0.75 specular 0.1 roughness 0.05 }\n}\n#end\n\n");
}

/* A ray tries all balls of a sweep that it comes near, so the mesh is several times faster and is what is shown, unless round_veins is
 * declared. */
static void put_textures(const Model *m, uint32_t n_veins, GString *s)
{
    const char *shadow = m->abaxial_base_color_file != NULL ? m->abaxial_base_color_file : m->base_color_file;
    put_side(s, m, &(Side){"leaf_sunny_side", m->base_color_file, "<0.08, 0.19, 0.03>", "specular 0.14 roughness 0.03", -2.0});
    put_side(s, m, &(Side){"leaf_shadow_side", shadow, "<0.24, 0.35, 0.15>", "specular 0.04 roughness 0.1", 2.0});
    if (n_veins > 0)
        put_vein_texture(s, "vein_texture", NULL);
    if (m->veins != NULL)
        put_vein_texture(s, "vein_mesh_texture", shadow);
    g_string_append(s, "#declare leaf_with_veins = union {\n"
                       "    object { leaf texture { leaf_sunny_side } interior_texture { leaf_shadow_side } }\n");
    if (n_veins > 0 && m->veins != NULL)
        g_string_append(s, "    #ifdef (round_veins)\n    object { vein texture { vein_texture } }\n    #else\n"
                           "    object { vein_mesh texture { vein_mesh_texture } }\n    #end\n");
    else if (n_veins > 0)
        g_string_append(s, "    object { vein texture { vein_texture } }\n");
    else if (m->veins != NULL)
        g_string_append(s, "    object { vein_mesh texture { vein_mesh_texture } }\n");
    g_string_append(s, "}\n");
}

static void put_include(const Model *m, Sink *out)
{
    put_comment(out->text, m->title);
    put_comment(out->text, m->generator);
    g_string_append(out->text, "// One unit is a vein segment; x to the leaf's right, y to its tip, the sunny side towards -z, uv as in the maps.\n"
                               "// leaf, vein and vein_mesh are bare shapes, leaf_with_veins has textures, which may be declared beforehand.\n"
                               "// It shows vein_mesh, or, slower, vein when round_veins is declared beforehand.\n"
                               "#version 3.7;\n\n#declare leaf_metres = ");
    export_number(out->text, m->unit);
    g_string_append(out->text, "; // a unit\n\n");
    uint32_t n_veins = put_veins(m, out);
    put_mesh("leaf", m->blade, out);
    if (m->veins != NULL)
        put_mesh("vein_mesh", m->veins, out);
    put_textures(m, n_veins, out->text);
}

/* The scene: leaf space turned so that the leaf lies, x to the right, y up, z away from the viewer. */
static Vec3 scene_axes(Vec3 p) { return vec3(p.x + 0.0, p.z + 0.0, p.y + 0.0); }

/* A camera far off, with the half widths and heights of its picture at distance 1. */
typedef struct {
    Vec3 place, ahead, right, up;
    Vec3 low, high; /* the leaf's box */
    double size;    /* the box's diagonal */
    double half_width, half_height;
} View;

/* What the picture must hold: blade, and veins with their thickness. */
typedef void Visit(View *v, Vec3 p, double radius, double bound[4]);

static void visit_all(const Model *m, Visit *visit, View *v, double bound[4])
{
    for (uint32_t i = 0; i < m->blade->n_vertices; i++)
        visit(v, scene_axes(m->blade->place[i]), 0.0, bound);
    for (uint32_t q = 0; q < m->n_tubes; q++)
        for (uint32_t i = 0; i < m->tubes[q].n; i++)
            visit(v, scene_axes(m->tubes[q].centre[i]), m->tubes[q].radius[i], bound);
}

static void grow_box(View *v, Vec3 p, double radius, double bound[4])
{
    v->low = vec3(MIN(v->low.x, p.x - radius), MIN(v->low.y, p.y - radius), MIN(v->low.z, p.z - radius));
    v->high = vec3(MAX(v->high.x, p.x + radius), MAX(v->high.y, p.y + radius), MAX(v->high.z, p.z + radius));
}

/* Where the point lies in the picture. */
static void grow_picture(View *v, Vec3 p, double radius, double bound[4])
{
    Vec3 d = vec3_sub(p, v->place);
    double depth = vec3_dot(d, v->ahead), x = vec3_dot(d, v->right) / depth, y = vec3_dot(d, v->up) / depth, r = radius / depth;
    bound[0] = MIN(bound[0], x - r);
    bound[1] = MAX(bound[1], x + r);
    bound[2] = MIN(bound[2], y - r);
    bound[3] = MAX(bound[3], y + r);
}

static void aim(View *v, Vec3 ahead)
{
    v->ahead = vec3_unit(ahead, vec3(0.0, 0.0, 1.0));
    v->right = vec3_unit(vec3(v->ahead.z, 0.0, -v->ahead.x), vec3(1.0, 0.0, 0.0)); /* level */
    v->up = vec3_cross(v->ahead, v->right);
}

/* From the front, above and a little to the right, at three times the leaf's size; turned until the leaf is in the middle. */
static View frame_leaf(const Model *m)
{
    View v = {.low = vec3(HUGE_VAL, HUGE_VAL, HUGE_VAL), .high = vec3(-HUGE_VAL, -HUGE_VAL, -HUGE_VAL)};
    visit_all(m, grow_box, &v, NULL);
    Vec3 middle = vec3_lerp(v.low, v.high, 0.5);
    v.size = vec3_dist(v.low, v.high);
    if (!(v.size > 0.0))
        v.size = 1.0;
    v.place = vec3_add(middle, vec3_scale(vec3_unit(vec3(0.28, 1.0, -0.62), middle), 3.0 * v.size));
    aim(&v, vec3_sub(middle, v.place));
    for (int round = 0; round < 4; round++) {
        double bound[4] = {HUGE_VAL, -HUGE_VAL, HUGE_VAL, -HUGE_VAL};
        visit_all(m, grow_picture, &v, bound);
        v.half_width = MAX(bound[1], -bound[0]);
        v.half_height = MAX(bound[3], -bound[2]);
        if (round == 3)
            break;
        aim(&v, vec3_add(v.ahead, vec3_add(vec3_scale(v.right, 0.5 * (bound[0] + bound[1])), vec3_scale(v.up, 0.5 * (bound[2] + bound[3])))));
    }
    return v;
}

/* Exactly, as a camera's directions must be square to each other. */
static void put_exactly(GString *s, Vec3 p)
{
    const double v[3] = {p.x, p.y, p.z};
    for (int k = 0; k < 3; k++) {
        g_string_append(s, k > 0 ? ", " : "<");
        export_number(s, v[k]);
    }
    g_string_append_c(s, '>');
}

static void put_value(GString *s, const char *name, double value)
{
    g_string_append_printf(s, "#declare %s = ", name);
    export_number(s, value);
    g_string_append(s, ";\n");
}

static void put_scene(const Model *m, const char *include, GString *s)
{
    View v = frame_leaf(m);
    put_comment(s, m->title);
    put_comment(s, m->generator);
    g_string_append(s, "// povray +A +W1200 +H900 with this file's name makes a picture; any shape of picture holds the whole leaf.\n#version 3.7;\n"
                       "global_settings {\n    assumed_gamma 1.0\n    radiosity { pretrace_start 0.08 pretrace_end 0.01 count 40 error_bound 0.8 "
                       "recursion_limit 1 nearest_count 6 }\n}\n\n#include ");
    put_string(s, include);
    g_string_append(s, "\n\n");
    put_value(s, "Size", v.size);
    put_value(s, "Half_width", v.half_width);
    put_value(s, "Half_height", v.half_height);
    g_string_append(s, "#declare Aspect = image_width / image_height;\n#declare Half = 1.1 * max(Half_height, Half_width / Aspect);\n"
                       "camera {\n    location ");
    put_exactly(s, v.place);
    g_string_append(s, "\n    direction ");
    put_exactly(s, v.ahead);
    g_string_append(s, "\n    up 2 * Half * ");
    put_exactly(s, v.up);
    g_string_append(s, "\n    right 2 * Half * Aspect * ");
    put_exactly(s, v.right);
    Vec3 middle = vec3_lerp(v.low, v.high, 0.5);
    g_string_append(s, "\n}\n\n// A soft sun from the left behind the leaf, and a pale sky.\nlight_source {\n    ");
    put_vector(s, vec3_add(middle, vec3_scale(vec3(-0.7, 1.6, 0.45), 4.0 * v.size)));
    g_string_append(s, "\n    rgb 0.95 * <1, 0.97, 0.92>\n    area_light Size * x, Size * z, 7, 7\n    adaptive 1 jitter circular orient\n}\n"
                       "sky_sphere { pigment { gradient y color_map { [0 rgb 0.5] [1 rgb <0.5, 0.55, 0.62>] } } }\n\n"
                       "plane {\n    y, ");
    sink_millionths(s, v.low.y - 0.01 * v.size);
    g_string_append(s, "\n    pigment { rgb 0.5 }\n    finish { ambient 0 diffuse 0.8 }\n}\n\n"
                       "object { leaf_with_veins rotate 90 * x } // lies with its sunny side up\n");
}

gboolean export_pov(const Model *m, const char *inc_path, const char *scene_path, GError **error)
{
    Sink *inc = sink_open(inc_path, error), *scene = inc != NULL ? sink_open(scene_path, error) : NULL;
    if (scene == NULL) {
        if (inc != NULL)
            model_abandon(inc);
        return FALSE;
    }
    char *name = g_path_get_basename(inc_path);
    put_include(m, inc);
    put_scene(m, name, scene->text);
    g_free(name);
    return model_close_pair(inc, scene, error);
}
