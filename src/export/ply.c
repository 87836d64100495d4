/* PLY, binary little endian: the model for MeshLab, Open3D and other people's scripts, with what is known of each vertex. */
#include <string.h>

#include "export/model_file.h"

/* What a vertex has beside place, normal and uv. */
typedef struct {
    uint8_t order, margin;
    uint32_t sequence;
    double radius; /* segments */
} Extra;

static void put_u32(GString *s, uint32_t v)
{
    v = GUINT32_TO_LE(v);
    g_string_append_len(s, (const char *)&v, sizeof v);
}

static void put_float(GString *s, double value)
{
    float f = (float)value;
    uint32_t bits;
    memcpy(&bits, &f, sizeof bits);
    put_u32(s, bits);
}

static Extra blade_extra(const Model *m, uint32_t i)
{
    return (Extra){.order = m->vein_order != NULL ? m->vein_order[i] : 0,
                   .margin = m->on_margin != NULL && m->on_margin[i],
                   .sequence = m->vein_id != NULL ? m->vein_id[i] : 0,
                   .radius = m->vein_radius != NULL ? m->vein_radius[i] : 0.0};
}

/* The tube of each vertex of the vein solids, which are one closed surface a tube in the tubes' order, so the parts that hang together, counted by
 * their first vertices; NULL when there aren't as many parts as tubes. */
static uint32_t *find_tubes(const Model *m)
{
    const Surface *f = m->veins;
    uint32_t *first = g_new(uint32_t, (gsize)f->n_vertices + 1), n = 0;
    for (uint32_t i = 0; i < f->n_vertices; i++)
        first[i] = i;
    for (uint32_t t = 0; t < f->n_triangles; t++)
        for (int k = 0; k < 3; k++) {
            uint32_t a = f->triangle[t][k], b = f->triangle[t][(k + 1) % 3];
            while (first[a] != a)
                a = first[a] = first[first[a]];
            while (first[b] != b)
                b = first[b] = first[first[b]];
            first[MAX(a, b)] = MIN(a, b);
        }
    for (uint32_t i = 0; i < f->n_vertices; i++) /* what is before i holds tubes already */
        first[i] = first[i] == i ? n++ : first[first[i]];
    if (n == m->n_tubes)
        return first;
    g_free(first);
    return NULL;
}

/* Radius of the tube's ball nearest to a point. */
static double radius_at(const Tube *t, Vec3 p)
{
    double best = HUGE_VAL, radius = 0.0;
    for (uint32_t k = 0; k < t->n; k++) {
        Vec3 d = vec3_sub(p, t->centre[k]);
        double d2 = vec3_dot(d, d);
        if (d2 < best) {
            best = d2;
            radius = t->radius[k];
        }
    }
    return radius;
}

/* A tube of no sequence is a petiole and counts as order 1. */
static Extra vein_extra(const Model *m, const uint32_t *tube, uint32_t i)
{
    if (tube == NULL)
        return (Extra){0};
    const Tube *t = &m->tubes[tube[i]];
    Extra e = {.order = 1, .radius = radius_at(t, m->veins->place[i])};
    if (t->sequence != NO_PARENT) {
        e.order = m->skeleton->sequence[t->sequence].order;
        e.sequence = t->sequence + 1;
    }
    return e;
}

static void put_vertices(const Model *m, const Surface *f, gboolean blade, Sink *out)
{
    uint32_t *tube = blade ? NULL : find_tubes(m);
    for (uint32_t i = 0; i < f->n_vertices; i++) {
        Vec3 p = model_metres(m, f->place[i]), n = model_normal(f->normal[i]);
        Extra e = blade ? blade_extra(m, i) : vein_extra(m, tube, i);
        const double v[8] = {p.x, p.y, p.z, n.x, n.y, n.z, f->uv[i].x, f->uv[i].y};
        for (int k = 0; k < 8; k++)
            put_float(out->text, v[k]);
        g_string_append_c(out->text, (char)e.order);
        put_float(out->text, e.radius * m->unit);
        put_u32(out->text, e.sequence);
        g_string_append_c(out->text, (char)e.margin);
        sink_drain(out);
    }
    g_free(tube);
}

static void put_faces(const Surface *f, uint32_t base, Sink *out)
{
    for (uint32_t t = 0; t < f->n_triangles; t++) {
        g_string_append_c(out->text, 3);
        for (int k = 0; k < 3; k++)
            put_u32(out->text, base + f->triangle[t][k]);
        sink_drain(out);
    }
}

static void put_comment(GString *s, const char *lead, const char *text)
{
    if (text == NULL || text[0] == '\0')
        return;
    g_string_append_printf(s, "comment %s", lead);
    model_put_line(s, text);
    g_string_append_c(s, '\n');
}

static void put_head(const Model *m, uint32_t n_vertices, uint32_t n_triangles, GString *s)
{
    static const char *const property[] = {"float x",  "float y", "float z",     "float nx",     "float ny",      "float nz",
                                           "float s",  "float t", "uchar order", "float radius", "uint sequence", "uchar margin"};
    g_string_append(s, "ply\nformat binary_little_endian 1.0\n");
    put_comment(s, "", m->title);
    put_comment(s, "", m->generator);
    put_comment(s, "", "metres; the sunny side is up (+y), the tip points to -z; t runs up");
    put_comment(s, "", "order, radius (metres), sequence (from 1) of the vein at the vertex, 0 none; margin 1 on the margin");
    g_string_append_printf(s, "comment blade: the first %u vertices and %u faces\n", m->blade->n_vertices, m->blade->n_triangles);
    put_comment(s, "TextureFile ", m->base_color_file);
    g_string_append_printf(s, "element vertex %u\n", n_vertices);
    for (guint i = 0; i < G_N_ELEMENTS(property); i++)
        g_string_append_printf(s, "property %s\n", property[i]);
    g_string_append_printf(s, "element face %u\nproperty list uchar int vertex_indices\nend_header\n", n_triangles);
}

gboolean export_ply(const Model *m, const char *path, GError **error)
{
    Sink *out = sink_open(path, error);
    if (out == NULL)
        return FALSE;
    const Surface *veins = m->veins;
    put_head(m, m->blade->n_vertices + (veins != NULL ? veins->n_vertices : 0),
             m->blade->n_triangles + (veins != NULL ? veins->n_triangles : 0), out->text);
    put_vertices(m, m->blade, TRUE, out);
    if (veins != NULL)
        put_vertices(m, veins, FALSE, out);
    put_faces(m->blade, 0, out);
    if (veins != NULL)
        put_faces(veins, m->blade->n_vertices, out);
    return sink_close(out, error);
}
