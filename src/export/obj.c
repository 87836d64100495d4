/* Wavefront OBJ with its MTL: what nearly every modeller reads. */
#include <math.h>
#include <string.h>

#include "export/export.h"
#include "export/model_file.h"

/* A length in metres, to nanometres and without needless zeros. */
static void put_metres(GString *s, double value)
{
    double size = floor(fabs(value) * 1e9 + 0.5);
    if (!(size < 9e15)) { /* also NaN */
        export_number(s, value);
        return;
    }
    uint64_t n = (uint64_t)size, whole = n / 1000000000u, part = n % 1000000000u;
    if (value < 0.0 && n > 0)
        g_string_append_c(s, '-');
    sink_uint(s, whole);
    if (part == 0)
        return;
    char digit[10] = ".";
    int places = 9;
    for (; part % 10 == 0; part /= 10)
        places--;
    for (int i = places; i > 0; i--, part /= 10)
        digit[i] = (char)('0' + part % 10);
    g_string_append_len(s, digit, 1 + places);
}

static void put_vertices(const Model *m, const Surface *f, Sink *out)
{
    for (uint32_t i = 0; i < f->n_vertices; i++) {
        Vec3 p = model_metres(m, f->place[i]);
        const double v[3] = {p.x, p.y, p.z};
        g_string_append_c(out->text, 'v');
        for (int k = 0; k < 3; k++) {
            g_string_append_c(out->text, ' ');
            put_metres(out->text, v[k]);
        }
        g_string_append_c(out->text, '\n');
        sink_drain(out);
    }
    for (uint32_t i = 0; i < f->n_vertices; i++) {
        g_string_append(out->text, "vt ");
        sink_millionths(out->text, f->uv[i].x);
        g_string_append_c(out->text, ' ');
        sink_millionths(out->text, f->uv[i].y);
        g_string_append_c(out->text, '\n');
        sink_drain(out);
    }
    for (uint32_t i = 0; i < f->n_vertices; i++) {
        Vec3 p = model_normal(f->normal[i]);
        const double v[3] = {p.x, p.y, p.z};
        g_string_append(out->text, "vn");
        for (int k = 0; k < 3; k++) {
            g_string_append_c(out->text, ' ');
            sink_millionths(out->text, v[k]);
        }
        g_string_append_c(out->text, '\n');
        sink_drain(out);
    }
}

/* Vertices are numbered from 1 through all groups; place, uv and normal alike. */
static void put_faces(const Surface *f, uint32_t base, Sink *out)
{
    for (uint32_t t = 0; t < f->n_triangles; t++) {
        g_string_append_c(out->text, 'f');
        for (int k = 0; k < 3; k++) {
            uint64_t v = (uint64_t)base + f->triangle[t][k] + 1;
            g_string_append_c(out->text, ' ');
            for (int i = 0; i < 3; i++) {
                sink_uint(out->text, v);
                if (i < 2)
                    g_string_append_c(out->text, '/');
            }
        }
        g_string_append_c(out->text, '\n');
        sink_drain(out);
    }
}

static void put_group(const Model *m, const Surface *f, const char *name, uint32_t base, Sink *out)
{
    g_string_append_printf(out->text, "g %s\n", name);
    put_vertices(m, f, out);
    g_string_append_printf(out->text, "usemtl %s\ns 1\n", name);
    put_faces(f, base, out);
}

static void put_map(GString *s, const char *key, const char *file)
{
    if (file == NULL)
        return;
    g_string_append_printf(s, "%s ", key);
    model_put_line(s, file);
    g_string_append_c(s, '\n');
}

/* A dielectric with the gloss of a leaf. `norm` is the key for tangent-space normals; programs that don't know it, Blender among them, look
 * for them under map_Bump. Pr and map_Pr: roughness. */
static void put_material(const Model *m, const char *name, const char *colour, gboolean blade, GString *s)
{
    g_string_append_printf(s, "newmtl %s\nKa 0 0 0\n", name);
    g_string_append(s, colour != NULL ? "Kd 1 1 1\n" : blade ? "Kd 0.08 0.19 0.03\n" : "Kd 0.55 0.62 0.24\n");
    g_string_append(s, "Ks 0.04 0.04 0.04\nNs 40\nNi 1.45\nd 1\nPr 0.55\nPm 0\nillum 2\n");
    put_map(s, "map_Kd", colour);
    if (blade) {
        put_map(s, "map_d", m->opacity_file);
        put_map(s, "norm", m->normal_file);
        put_map(s, "map_Bump -bm 1", m->normal_file);
    }
    put_map(s, "map_Pr", m->roughness_file);
}

static void put_head(const Model *m, GString *s)
{
    const char *const line[] = {m->title, m->generator};
    for (int i = 0; i < 2; i++) {
        if (line[i] == NULL || line[i][0] == '\0')
            continue;
        g_string_append(s, "# ");
        model_put_line(s, line[i]);
        g_string_append_c(s, '\n');
    }
}

/* leaf.obj -> leaf.mtl, in the same folder. */
static char *mtl_path(const char *path)
{
    gsize n = strlen(path);
    if (n > 4 && g_ascii_strcasecmp(path + n - 4, ".obj") == 0)
        n -= 4;
    char *stem = g_strndup(path, n), *mtl = g_strconcat(stem, ".mtl", NULL);
    g_free(stem);
    return mtl;
}

static void put_object(const Model *m, const char *mtl, Sink *out)
{
    char *library = g_path_get_basename(mtl), *word = model_word(m);
    put_head(m, out->text);
    g_string_append(out->text, "# Metres. The sunny side is up (+y), the tip points to -z, v runs up.\nmtllib ");
    model_put_line(out->text, library);
    g_string_append_printf(out->text, "\no %s\n", word);
    put_group(m, m->blade, "blade", 0, out);
    if (m->veins != NULL)
        put_group(m, m->veins, "veins", m->blade->n_vertices, out);
    g_free(library);
    g_free(word);
}

gboolean export_obj(const Model *m, const char *path, GError **error)
{
    char *mtl = mtl_path(path);
    Sink *object = sink_open(path, error), *material = object != NULL ? sink_open(mtl, error) : NULL;
    gboolean ok = material != NULL;
    if (ok) {
        put_object(m, mtl, object);
        put_head(m, material->text);
        put_material(m, "blade", m->base_color_file, TRUE, material->text);
        if (m->veins != NULL) {
            g_string_append_c(material->text, '\n');
            put_material(m, "veins", m->abaxial_base_color_file != NULL ? m->abaxial_base_color_file : m->base_color_file, FALSE, material->text);
        }
        ok = model_close_pair(object, material, error);
    } else if (object != NULL) {
        model_abandon(object);
    }
    g_free(mtl);
    return ok;
}
