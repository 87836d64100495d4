#include "export/glb_mesh.h"

#include "export/export.h"
#include "export/model_file.h"

/* Adds a triangle's directions of growing u and v to its corners; they are as long as the triangle's area in the map demands, so that
 * large triangles count more. */
static void add_directions(const Surface *f, uint32_t t, const Vec3 *place, Vec3 *along_u, Vec3 *along_v)
{
    const uint32_t *c = f->triangle[t];
    Vec3 e1 = vec3_sub(place[c[1]], place[c[0]]), e2 = vec3_sub(place[c[2]], place[c[0]]);
    Vec2 d1 = vec_sub(f->uv[c[1]], f->uv[c[0]]), d2 = vec_sub(f->uv[c[2]], f->uv[c[0]]);
    double turn = vec_cross(d1, d2) < 0.0 ? -1.0 : 1.0;
    Vec3 du = vec3_scale(vec3_sub(vec3_scale(e1, d2.y), vec3_scale(e2, d1.y)), turn);
    Vec3 dv = vec3_scale(vec3_sub(vec3_scale(e2, d1.x), vec3_scale(e1, d2.x)), turn);
    for (int k = 0; k < 3; k++) {
        along_u[c[k]] = vec3_add(along_u[c[k]], du);
        along_v[c[k]] = vec3_add(along_v[c[k]], dv);
    }
}

Vec3 *glb_tangents(const Surface *f, const Vec3 *place, const Vec3 *normal, double *sign)
{
    Vec3 *u = g_new0(Vec3, (gsize)f->n_vertices + 1), *v = g_new0(Vec3, (gsize)f->n_vertices + 1);
    for (uint32_t t = 0; t < f->n_triangles; t++)
        add_directions(f, t, place, u, v);
    for (uint32_t i = 0; i < f->n_vertices; i++) {
        Vec3 n = vec3_unit(normal[i], vec3(0.0, 0.0, 1.0));
        Vec3 any = fabs(n.x) < 0.9 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0);
        Vec3 square = vec3_unit(vec3_sub(any, vec3_scale(n, vec3_dot(n, any))), any);
        u[i] = vec3_unit(vec3_sub(u[i], vec3_scale(n, vec3_dot(n, u[i]))), square);
        sign[i] = vec3_dot(vec3_cross(n, u[i]), v[i]) < 0.0 ? -1.0 : 1.0;
    }
    g_free(v);
    return u;
}

/* Places, normals and tangents of a pose, in glTF's axes and metres. */
typedef struct {
    Vec3 *place, *normal, *tangent;
    double *sign;
} PoseData;

static PoseData pose_data(const Model *m, const GlbPart *part, const Vec3 *place, const Vec3 *normal)
{
    uint32_t n = part->surface->n_vertices;
    PoseData d = {.place = g_new(Vec3, (gsize)n + 1), .normal = g_new(Vec3, (gsize)n + 1)};
    for (uint32_t i = 0; i < n; i++) {
        d.place[i] = model_metres(m, place[i]);
        d.normal[i] = model_normal(normal[i]);
    }
    if (part->tangents) {
        d.sign = g_new(double, (gsize)n + 1);
        d.tangent = glb_tangents(part->surface, place, normal, d.sign);
        for (uint32_t i = 0; i < n; i++)
            d.tangent[i] = model_axes(d.tangent[i]);
    }
    return d;
}

static void pose_data_clear(PoseData *d)
{
    g_free(d->place);
    g_free(d->normal);
    g_free(d->tangent);
    g_free(d->sign);
}

static void put_tangents(GString *s, const PoseData *d, uint32_t n, GlbBuffer *b)
{
    float *t = g_new(float, (gsize)n * 4 + 1);
    for (gsize i = 0; i < n; i++) {
        t[i * 4] = (float)d->tangent[i].x;
        t[i * 4 + 1] = (float)d->tangent[i].y;
        t[i * 4 + 2] = (float)d->tangent[i].z;
        t[i * 4 + 3] = (float)d->sign[i];
    }
    g_string_append_printf(s, ",\"TANGENT\":%u", glb_add_floats(b, t, n, 4, FALSE, GLB_VERTICES));
    g_free(t);
}

static void put_uv(GString *s, const Surface *f, GlbBuffer *b)
{
    float *uv = g_new(float, (gsize)f->n_vertices * 2 + 1);
    for (gsize i = 0; i < f->n_vertices; i++) {
        uv[i * 2] = (float)f->uv[i].x;
        uv[i * 2 + 1] = (float)(1.0 - f->uv[i].y); /* glTF's v runs down */
    }
    g_string_append_printf(s, ",\"TEXCOORD_0\":%u", glb_add_floats(b, uv, f->n_vertices, 2, FALSE, GLB_VERTICES));
    g_free(uv);
}

/* Joints and weights in sets of four. */
static void put_weights(GString *s, const Rig *r, const GlbPart *part, GlbBuffer *b)
{
    const uint16_t *joint = part->blade ? r->blade_joint : r->vein_joint;
    const float *weight = part->blade ? r->blade_weight : r->vein_weight;
    uint32_t n = part->surface->n_vertices;
    uint16_t *j = g_new(uint16_t, (gsize)n * 4 + 1);
    float *w = g_new(float, (gsize)n * 4 + 1);
    for (uint32_t set = 0; set < r->per_vertex / 4; set++) {
        for (gsize i = 0; i < n; i++)
            for (gsize k = 0; k < 4; k++) {
                gsize from = i * r->per_vertex + set * 4 + k;
                w[i * 4 + k] = weight[from];
                j[i * 4 + k] = weight[from] > 0.0f ? joint[from] : 0; /* as the format asks for */
            }
        g_string_append_printf(s, ",\"JOINTS_%u\":%u", set, glb_add_joints(b, j, n));
        g_string_append_printf(s, ",\"WEIGHTS_%u\":%u", set, glb_add_floats(b, w, n, 4, FALSE, GLB_VERTICES));
    }
    g_free(j);
    g_free(w);
}

static void put_difference(GString *s, const char *key, const Vec3 *to, const Vec3 *from, uint32_t n, gboolean bounds, GlbBuffer *b)
{
    Vec3 *d = g_new(Vec3, (gsize)n + 1);
    for (uint32_t i = 0; i < n; i++)
        d[i] = vec3_sub(to[i], from[i]);
    g_string_append_printf(s, "\"%s\":%u", key, glb_add_vec3(b, d, n, bounds, GLB_VERTICES));
    g_free(d);
}

static void put_targets(GString *s, const Model *m, const GlbPart *part, const PoseData *rest, GlbBuffer *b)
{
    uint32_t n = part->surface->n_vertices;
    g_string_append(s, ",\"targets\":[");
    for (uint32_t k = 0; k < m->n_morphs; k++) {
        const ModelMorph *t = &m->morph[k];
        PoseData d = pose_data(m, part, part->blade ? t->blade : t->veins, part->blade ? t->blade_normal : t->vein_normal);
        g_string_append(s, k > 0 ? ",{" : "{");
        put_difference(s, "POSITION", d.place, rest->place, n, TRUE, b);
        g_string_append_c(s, ',');
        put_difference(s, "NORMAL", d.normal, rest->normal, n, FALSE, b);
        if (part->tangents) {
            g_string_append_c(s, ',');
            put_difference(s, "TANGENT", d.tangent, rest->tangent, n, FALSE, b);
        }
        g_string_append_c(s, '}');
        pose_data_clear(&d);
    }
    g_string_append_c(s, ']');
}

/* Weights of the targets at rest, and their names where Blender and three.js look for them. */
static void put_target_names(GString *s, const Model *m)
{
    g_string_append(s, ",\"weights\":[");
    for (uint32_t k = 0; k < m->n_morphs; k++)
        g_string_append(s, k > 0 ? ",0" : "0");
    g_string_append(s, "],\"extras\":{\"targetNames\":[");
    for (uint32_t k = 0; k < m->n_morphs; k++) {
        g_string_append(s, k > 0 ? "," : "");
        export_json_string(s, m->morph[k].name != NULL ? m->morph[k].name : "");
    }
    g_string_append(s, "]}");
}

void glb_put_mesh(GString *s, const Model *m, const GlbPart *part, GlbBuffer *b)
{
    const Surface *f = part->surface;
    PoseData rest = pose_data(m, part, f->place, f->normal);
    g_string_append(s, "{\"name\":");
    export_json_string(s, part->name);
    g_string_append_printf(s, ",\"primitives\":[{\"attributes\":{\"POSITION\":%u", glb_add_vec3(b, rest.place, f->n_vertices, TRUE, GLB_VERTICES));
    g_string_append_printf(s, ",\"NORMAL\":%u", glb_add_vec3(b, rest.normal, f->n_vertices, FALSE, GLB_VERTICES));
    if (part->tangents)
        put_tangents(s, &rest, f->n_vertices, b);
    put_uv(s, f, b);
    if (m->rig != NULL)
        put_weights(s, m->rig, part, b);
    g_string_append_printf(s, "},\"indices\":%u,\"material\":%u",
                           glb_add_triangles(b, (const uint32_t (*)[3])f->triangle, f->n_triangles, f->n_vertices), part->material);
    if (m->n_morphs > 0)
        put_targets(s, m, part, &rest, b);
    if (part->variant != UINT32_MAX)
        g_string_append_printf(s, ",\"extensions\":{\"KHR_materials_variants\":{\"mappings\":[{\"material\":%u,\"variants\":[0]},"
                                  "{\"material\":%u,\"variants\":[1]}]}}", part->material, part->variant);
    g_string_append(s, "}]");
    if (m->n_morphs > 0)
        put_target_names(s, m);
    g_string_append_c(s, '}');
    pose_data_clear(&rest);
}
