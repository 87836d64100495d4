/* From a venation graph to a bent leaf: skeleton, mesh, pose, membrane, vein solids (Hong 2005, chapters 6 and 7). */
#include "lib/shape.h"

#include <math.h>

#include "lib/settings.h"
#include "sim/torn.h"

Mesh *shape_mesh(const Skeleton *sk, const MeshDef *def, GError **error)
{
    uint32_t *node_point = g_new(uint32_t, sk->n_nodes);
    Pslg *graph = skeleton_pslg(sk, node_point);
    Mesh *mesh = mesh_new(graph, def, error);
    pslg_free(graph);
    g_free(node_point);
    return mesh;
}

/* Mesh vertices on veins: a vertex that several nodes share is fixed by the first. */
static void find_fixed(VenShape *s)
{
    const Skeleton *sk = s->skeleton;
    bool *seen = g_new0(bool, s->mesh->n_vertices);
    s->fixed = g_new(uint32_t, sk->n_nodes);
    s->fixed_node = g_new(uint32_t, sk->n_nodes);
    for (uint32_t i = 0; i < sk->n_nodes; i++) {
        if (seen[sk->vertex[i]])
            continue;
        seen[sk->vertex[i]] = true;
        s->fixed[s->n_fixed] = sk->vertex[i];
        s->fixed_node[s->n_fixed++] = i;
    }
    g_free(seen);
}

static gboolean build(VenShape *s, GError **error)
{
    const VenLeaf *leaf = s->leaf;
    Skeleton *coarse = shape_skeleton(s, error);
    if (!coarse)
        return FALSE;
    MeshDef def = settings_mesh(leaf->params, leaf->length, 1.0);
    s->mesh = shape_mesh(coarse, &def, error);
    if (s->mesh)
        s->skeleton = skeleton_refine(coarse, s->mesh);
    skeleton_free(coarse);
    if (!s->mesh)
        return error && g_error_matches(*error, MESH_ERROR, MESH_ERROR_SIZE) ? settings_prefix(leaf->params, PARAM_MESH_MAX_AREA, error) : FALSE;
    find_fixed(s);
    int choice = params_choice(leaf->params, PARAM_MESH_MEMBRANE);
    s->membrane = membrane_new(s->mesh, s->fixed, s->n_fixed, choice == MEMBRANE_CHOICE_BILAPLACE ? MEMBRANE_BILAPLACE : MEMBRANE_LAPLACE, error);
    if (!s->membrane)
        return FALSE;
    shape_add_levels(s);
    return TRUE;
}

/* A rig of the pose, so that it opens as it looks. */
static Rig *make_rig(const VenShape *s, const Bent *bent, GError **error)
{
    static const uint32_t per_vertex[] = {0, 4, 8};
    const Params *p = s->leaf->params;
    uint32_t n = bent->veins ? bent->veins->n_vertices : 0;
    uint32_t *node = g_new(uint32_t, MAX(n, 1));
    if (n)
        solid_vertex_nodes(bent->tubes, bent->n_tubes, &s->solid, node);
    Rig *rig = rig_new(s->skeleton, s->mesh, s->membrane, s->fixed_node, s->n_fixed, node, n,
                       (uint32_t)params_integer(p, PARAM_EXPORT_RIG_JOINTS), per_vertex[params_choice(p, PARAM_EXPORT_RIG)], error);
    g_free(node);
    return rig;
}

static void place_joints(Rig *rig, const Pose *pose)
{
    for (uint32_t j = 0; j < rig->n_joints; j++)
        rig->joint[j].place = pose->place[rig->joint[j].node];
}

static gboolean bend_as_asked(VenShape *s, const Params *p, uint64_t seed, GError **error)
{
    PoseDef def = settings_pose(p, seed);
    Pose *pose = pose_new(s->skeleton);
    if (!pose_apply(pose, &def, error)) {
        pose_free(pose);
        return settings_prefix(p, PARAM_POSE_RULES, error);
    }
    char *rules = g_strdup(def.rules);
    g_free(s->rules);
    s->bent_as = def;
    s->bent_as.rules = s->rules = rules;
    bent_clear(&s->bent);
    s->bent = shape_bend(s, pose);
    if (params_choice(s->leaf->params, PARAM_EXPORT_RIG) != 0 && !s->rig && !(s->rig = make_rig(s, &s->bent, error)))
        return FALSE; /* for the first pose alone: weights go by the flat leaf */
    if (s->rig)
        place_joints(s->rig, pose);
    return TRUE;
}

gboolean ven_shape_pose(VenShape *shape, const VenParams *params, uint64_t seed, GError **error)
{
    return bend_as_asked(shape, params->values, seed, error);
}

/* Length of the model: as given, else that of the real leaf where a scan says it. */
static double leaf_metres(const VenLeaf *leaf)
{
    const Ground *g = leaf->ground;
    if (!g || !g->scan || !(g->scan->mm_per_pixel > 0.0) || params_is_given(leaf->params, PARAM_EXPORT_LEAF_LENGTH))
        return params_number(leaf->params, PARAM_EXPORT_LEAF_LENGTH);
    return 1e-3 * g->scan->mm_per_pixel * sqrt(g->to_scan.c * g->to_scan.c + g->to_scan.d * g->to_scan.d);
}

/* What would be found only when it is written, told before the work. */
static gboolean check_writing(const VenShape *s, GError **error)
{
    const double bytes = 144.0, most = (double)((uint64_t)12 << 30); /* a pixel of the nine maps of a model, all at hand at once */
    const Params *p = s->leaf->params;
    gboolean wanted[MODEL_COUNT];
    Keyframe *frame;
    uint32_t n;
    if (!settings_models(p, wanted, error) || !settings_keyframes(p, &frame, &n, error))
        return FALSE;
    keyframes_free(frame, n);
    double needed = bytes * s->frame.width * s->frame.height;
    if (needed <= most || !(wanted[MODEL_GLB] || wanted[MODEL_OBJ] || wanted[MODEL_POV]))
        return TRUE;
    g_set_error(error, SETTINGS_ERROR, SETTINGS_ERROR_CONFLICT,
                " = %" G_GINT64_FORMAT ": the maps of models would take %.0f GiB of memory; at most %.0f are allowed, enough for %.0f pixels",
                params_integer(p, PARAM_TEXTURE_SIZE), needed / (double)(1 << 30), most / (double)(1 << 30), floor(sqrt(most / bytes)));
    char *place = params_place(p, PARAM_TEXTURE_SIZE);
    g_prefix_error(error, "%s", place);
    g_free(place);
    return FALSE;
}

VenShape *ven_shape(const VenLeaf *leaf, GError **error)
{
    const Params *p = leaf->params;
    VenShape *s = g_new0(VenShape, 1);
    s->leaf = leaf;
    s->carries = leaf->net->n_edges ? network_tied(leaf->net) : shape_lay_midrib(leaf);
    s->solid = shape_solids(leaf, 1.0);
    s->unit = leaf_metres(leaf) / leaf->length;
    s->frame = leaf_frame(leaf, leaf->net->margin->box);
    if (check_writing(s, error) && build(s, error) && bend_as_asked(s, p, leaf->seed, error))
        return s;
    ven_shape_free(s);
    return NULL;
}

void ven_shape_free(VenShape *s)
{
    if (!s)
        return;
    network_free(s->carries);
    bent_clear(&s->bent);
    for (uint32_t i = 0; i < s->n_levels; i++)
        shape_level_clear(&s->level[i]);
    g_free(s->level);
    rig_free(s->rig);
    g_free(s->rules);
    membrane_free(s->membrane);
    g_free(s->fixed);
    g_free(s->fixed_node);
    skeleton_free(s->skeleton);
    mesh_free(s->mesh);
    g_free(s);
}

uint32_t ven_shape_veins(const VenShape *s) { return s->skeleton->n_sequences; }

uint32_t ven_shape_vertices(const VenShape *s) { return s->mesh->n_vertices; }

uint32_t ven_shape_triangles(const VenShape *s) { return s->mesh->n_triangles; }

void ven_shape_vertex(const VenShape *s, uint32_t vertex, double place[3], double normal[3])
{
    g_return_if_fail(vertex < s->mesh->n_vertices);
    Vec3 p = vec3_scale(s->bent.blade->place[vertex], s->unit), n = s->bent.blade->normal[vertex];
    place[0] = p.x, place[1] = p.y, place[2] = p.z;
    if (normal)
        normal[0] = n.x, normal[1] = n.y, normal[2] = n.z;
}

void ven_shape_triangle(const VenShape *s, uint32_t triangle, uint32_t vertex[3])
{
    g_return_if_fail(triangle < s->mesh->n_triangles);
    for (int k = 0; k < 3; k++)
        vertex[k] = s->mesh->triangle[triangle][k];
}

uint32_t ven_shape_levels(const VenShape *s) { return 1 + s->n_levels; }

gboolean ven_shape_rig(const VenShape *s, uint32_t *joints, double *worst_loss, double *mean_loss)
{
    if (!s->rig)
        return FALSE;
    *joints = s->rig->n_joints;
    *worst_loss = s->rig->worst_loss;
    *mean_loss = s->rig->mean_loss;
    return TRUE;
}
