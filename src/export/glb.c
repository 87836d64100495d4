/* glTF 2.0 binary (Khronos, glTF 2.0 specification): one file with geometry, maps, rig and animation, for Blender, engines and the web. */
#include <math.h>
#include <string.h>

#include "export/export.h"
#include "export/glb_buffer.h"
#include "export/glb_material.h"
#include "export/glb_mesh.h"
#include "export/model_file.h"

/* Nodes in their order: blade, veins, the leaf, joints. */
typedef struct {
    GString *json; /* array elements */
    uint32_t n;
} Nodes;

static void put_name(GString *s, const char *name, const char *end)
{
    g_string_append(s, "\"name\":");
    char *full = g_strconcat(name != NULL && name[0] != '\0' ? name : "leaf", end, NULL);
    export_json_string(s, full);
    g_free(full);
}

static void put_mesh_node(Nodes *nodes, const Model *m, const char *end)
{
    g_string_append(nodes->json, nodes->n > 0 ? ",{" : "{");
    put_name(nodes->json, m->name, end);
    g_string_append_printf(nodes->json, ",\"mesh\":%u%s}", nodes->n, m->rig != NULL ? ",\"skin\":0" : "");
    nodes->n++;
}

static void put_children(GString *s, const uint32_t *child, uint32_t n)
{
    if (n == 0)
        return;
    g_string_append(s, ",\"children\":[");
    for (uint32_t i = 0; i < n; i++)
        g_string_append_printf(s, "%s%u", i > 0 ? "," : "", child[i]);
    g_string_append_c(s, ']');
}

static void put_joint(GString *s, const Model *m, uint32_t j)
{
    const Joint *joint = &m->rig->joint[j];
    Vec3 from = joint->parent != NO_PARENT ? m->rig->joint[joint->parent].place : vec3(0.0, 0.0, 0.0);
    Vec3 by = model_metres(m, vec3_sub(joint->place, from));
    g_string_append(s, ",{");
    export_json_string(s, "name");
    g_string_append_c(s, ':');
    export_json_string(s, joint->name);
    g_string_append(s, ",\"translation\":[");
    export_number(s, (double)(float)by.x);
    g_string_append_c(s, ',');
    export_number(s, (double)(float)by.y);
    g_string_append_c(s, ',');
    export_number(s, (double)(float)by.z);
    g_string_append_c(s, ']');
}

/* The leaf's node holds the roots among the joints, and each joint those that hang on it. */
static void put_joints(Nodes *nodes, const Model *m)
{
    const Rig *r = m->rig;
    uint32_t first = nodes->n + 1, *start = g_new0(uint32_t, (gsize)r->n_joints + 3), *child = g_new(uint32_t, (gsize)r->n_joints + 1);
    for (uint32_t j = 0; j < r->n_joints; j++) /* parent + 1: slot 0 for the roots */
        start[r->joint[j].parent + 2]++;
    for (uint32_t j = 0; j <= r->n_joints; j++)
        start[j + 1] += start[j];
    for (uint32_t j = 0; j < r->n_joints; j++)
        child[start[r->joint[j].parent + 1]++] = first + j; /* after this start[p] is the end of slot p */
    g_string_append(nodes->json, ",{");
    put_name(nodes->json, m->name, "");
    put_children(nodes->json, child, start[0]);
    g_string_append_c(nodes->json, '}');
    for (uint32_t j = 0; j < r->n_joints; j++) {
        put_joint(nodes->json, m, j);
        put_children(nodes->json, child + start[j], start[j + 1] - start[j]);
        g_string_append_c(nodes->json, '}');
    }
    nodes->n += 1 + r->n_joints;
    g_free(start);
    g_free(child);
}

/* A skinned mesh must hang on no other node, so with a rig the leaf's node holds the joints alone, else the meshes. */
static Nodes put_nodes(const Model *m)
{
    const uint32_t meshes[] = {0, 1};
    Nodes nodes = {.json = g_string_new(NULL)};
    put_mesh_node(&nodes, m, "_blade");
    if (m->veins != NULL)
        put_mesh_node(&nodes, m, "_veins");
    if (m->rig != NULL) {
        put_joints(&nodes, m);
    } else {
        g_string_append(nodes.json, ",{");
        put_name(nodes.json, m->name, "");
        put_children(nodes.json, meshes, nodes.n);
        g_string_append_c(nodes.json, '}');
        nodes.n++;
    }
    return nodes;
}

/* Joints only move at rest, so their inverses only move back; in the floats that the sums of the nodes' translations come to. */
static void put_skin(GString *s, const Model *m, GlbBuffer *b)
{
    const Rig *r = m->rig;
    uint32_t first = (m->veins != NULL ? 2 : 1) + 1;
    float *matrix = g_new0(float, (gsize)r->n_joints * 16 + 1);
    for (gsize j = 0; j < r->n_joints; j++) {
        Vec3 p = model_metres(m, r->joint[j].place);
        float *a = matrix + j * 16;
        a[0] = a[5] = a[10] = a[15] = 1.0f;
        a[12] = (float)(0.0 - p.x);
        a[13] = (float)(0.0 - p.y);
        a[14] = (float)(0.0 - p.z);
    }
    g_string_append(s, ",\"skins\":[{");
    put_name(s, m->name, "");
    g_string_append_printf(s, ",\"inverseBindMatrices\":%u,\"skeleton\":%u,\"joints\":[",
                           glb_add_floats(b, matrix, r->n_joints, 16, FALSE, GLB_NO_TARGET), first - 1);
    for (uint32_t j = 0; j < r->n_joints; j++)
        g_string_append_printf(s, "%s%u", j > 0 ? "," : "", first + j);
    g_string_append(s, "],\"extras\":{\"worst_loss\":"); /* of the weights, for want of room: see shape/rig.h */
    export_number(s, r->worst_loss);
    g_string_append(s, ",\"mean_loss\":");
    export_number(s, r->mean_loss);
    g_string_append(s, "}}]");
    g_free(matrix);
}

/* From rest through one target after the other, each fully on at its time; straight between. */
static void put_animation(GString *s, const Model *m, GlbBuffer *b)
{
    uint32_t n = m->n_morphs, rest = m->morph[0].time > 0.0 ? 1 : 0;
    float *time = g_new0(float, (gsize)n + 1), *weight = g_new0(float, ((gsize)n + 1) * n);
    for (uint32_t k = 0; k < n; k++) {
        time[k + rest] = (float)m->morph[k].time;
        if (k + rest > 0 && !(time[k + rest] > time[k + rest - 1])) /* must ascend; at once is a jump */
            time[k + rest] = nextafterf(time[k + rest - 1], HUGE_VALF);
        weight[(gsize)(k + rest) * n + k] = 1.0f;
    }
    uint32_t input = glb_add_floats(b, time, n + rest, 1, TRUE, GLB_NO_TARGET);
    uint32_t output = glb_add_floats(b, weight, (n + rest) * n, 1, FALSE, GLB_NO_TARGET);
    g_string_append(s, ",\"animations\":[{");
    put_name(s, m->name, "");
    g_string_append_printf(s, ",\"samplers\":[{\"input\":%u,\"interpolation\":\"LINEAR\",\"output\":%u}],\"channels\":[", input, output);
    for (uint32_t node = 0; node < (m->veins != NULL ? 2u : 1u); node++)
        g_string_append_printf(s, "%s{\"sampler\":0,\"target\":{\"node\":%u,\"path\":\"weights\"}}", node > 0 ? "," : "", node);
    g_string_append(s, "]}]");
    g_free(time);
    g_free(weight);
}

static void put_asset(GString *s, const Model *m)
{
    g_string_append(s, "{\"asset\":{\"version\":\"2.0\",\"generator\":");
    export_json_string(s, m->generator != NULL ? m->generator : "Venation");
    g_string_append(s, ",\"extras\":{\"title\":");
    export_json_string(s, m->title != NULL ? m->title : "");
    if (m->extras != NULL)
        g_string_append_printf(s, ",\"record\":%s", m->extras);
    g_string_append(s, "}}");
}

static void put_extensions(GString *s, const GlbMaterials *g)
{
    gboolean variants = g->shadow_side != UINT32_MAX;
    if (g->transmits || variants)
        g_string_append_printf(s, ",\"extensionsUsed\":[%s%s%s]", g->transmits ? "\"KHR_materials_diffuse_transmission\"" : "",
                               g->transmits && variants ? "," : "", variants ? "\"KHR_materials_variants\"" : "");
    if (variants)
        g_string_append(s, ",\"extensions\":{\"KHR_materials_variants\":{\"variants\":[{\"name\":\"sunny side\"},{\"name\":\"shadow side\"}]}}");
}

static void put_meshes(GString *s, const Model *m, const GlbMaterials *g, GlbBuffer *b)
{
    GlbPart blade = {"blade", m->blade, TRUE, g->bumpy, g->blade, g->shadow_side};
    GlbPart veins = {"veins", m->veins, FALSE, FALSE, g->veins, UINT32_MAX};
    g_string_append(s, ",\"meshes\":[");
    glb_put_mesh(s, m, &blade, b);
    if (m->veins != NULL) {
        g_string_append_c(s, ',');
        glb_put_mesh(s, m, &veins, b);
    }
    g_string_append_printf(s, "],\"materials\":[%s]", g->materials->str);
    if (g->n_textures > 0) /* smooth, with mipmaps, not repeated */
        g_string_append_printf(s, ",\"textures\":[%s],\"images\":[%s],"
                                  "\"samplers\":[{\"magFilter\":9729,\"minFilter\":9987,\"wrapS\":33071,\"wrapT\":33071}]",
                               g->textures->str, g->images->str);
}

static GString *make_json(const Model *m, GlbBuffer *b)
{
    GString *s = g_string_new(NULL);
    GlbMaterials materials;
    glb_materials_init(&materials, m, b);
    put_asset(s, m);
    put_extensions(s, &materials);
    Nodes nodes = put_nodes(m);
    uint32_t leaf = m->veins != NULL ? 2 : 1;
    g_string_append(s, ",\"scene\":0,\"scenes\":[{");
    put_name(s, m->name, "");
    g_string_append(s, ",\"nodes\":[");
    for (uint32_t node = m->rig != NULL ? 0 : leaf; node <= leaf; node++)
        g_string_append_printf(s, "%u%s", node, node < leaf ? "," : "");
    g_string_append_printf(s, "]}],\"nodes\":[%s]", nodes.json->str);
    put_meshes(s, m, &materials, b);
    if (m->rig != NULL)
        put_skin(s, m, b);
    if (m->n_morphs > 0)
        put_animation(s, m, b);
    g_string_append_printf(s, ",\"accessors\":[%s],\"bufferViews\":[%s],\"buffers\":[{\"byteLength\":%u}]}", b->accessors->str, b->views->str,
                           b->bytes->len);
    while (s->len % 4 != 0)
        g_string_append_c(s, ' ');
    g_string_free(nodes.json, TRUE);
    glb_materials_clear(&materials);
    return s;
}

/* No fewer bytes than the file will have. */
static double upper_size(const Model *m)
{
    const ModelImages *i = &m->images;
    GBytes *const image[] = {i->base_color, i->abaxial_base_color, i->normal, i->abaxial_normal, i->surface, i->transmission};
    double vertices = m->blade->n_vertices, triangles = m->blade->n_triangles, size = 1e6;
    if (m->veins != NULL) {
        vertices += m->veins->n_vertices;
        triangles += m->veins->n_triangles;
    }
    for (guint k = 0; k < G_N_ELEMENTS(image); k++)
        size += image[k] != NULL ? (double)g_bytes_get_size(image[k]) : 0.0;
    size += vertices * (48.0 + (m->rig != NULL ? 6.0 * m->rig->per_vertex : 0.0) + 36.0 * m->n_morphs) + triangles * 12.0;
    size += 4.0 * (m->n_morphs + 1.0) * (m->n_morphs + 1.0) + 2000.0 * m->n_morphs + (m->rig != NULL ? 264.0 * m->rig->n_joints : 0.0);
    return size + (m->extras != NULL ? (double)strlen(m->extras) : 0.0);
}

static void put_u32(GString *s, uint32_t v)
{
    v = GUINT32_TO_LE(v);
    g_string_append_len(s, (const char *)&v, sizeof v);
}

static void put_chunks(Sink *out, const GString *json, const GByteArray *bytes)
{
    enum { SLICE = 1 << 20 };
    g_string_append_len(out->text, "glTF", 4);
    put_u32(out->text, 2);
    put_u32(out->text, 12 + 8 + (uint32_t)json->len + 8 + bytes->len);
    put_u32(out->text, (uint32_t)json->len);
    g_string_append_len(out->text, "JSON", 4);
    g_string_append_len(out->text, json->str, (gssize)json->len);
    put_u32(out->text, bytes->len);
    g_string_append_len(out->text, "BIN", 4); /* and a zero byte */
    for (gsize at = 0; at < bytes->len; at += SLICE) {
        g_string_append_len(out->text, (const char *)bytes->data + at, (gssize)MIN((gsize)SLICE, bytes->len - at));
        sink_drain(out);
    }
}

gboolean export_glb(const Model *m, const char *path, GError **error)
{
    if (upper_size(m) > (double)UINT32_MAX) {
        char *name = g_filename_display_name(path);
        g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_FAILED, "%s: the leaf is too large for glTF's binary format, which ends at 4 GiB: "
                    "export fewer triangles, keyframes or smaller maps", name);
        g_free(name);
        return FALSE;
    }
    Sink *out = sink_open(path, error);
    if (out == NULL)
        return FALSE;
    GlbBuffer buffer;
    glb_buffer_init(&buffer);
    GString *text = make_json(m, &buffer);
    put_chunks(out, text, buffer.bytes);
    g_string_free(text, TRUE);
    glb_buffer_clear(&buffer);
    return sink_close(out, error);
}
