/* From a venation graph to a bent leaf: skeleton, mesh, pose, membrane, vein solids (Hong 2005, chapters 6 and 7). */
#include "lib/shape.h"

#include "lib/settings.h"

/* What mesh.membrane may be, in the table's order. */
enum { MEMBRANE_CHOICE_LAPLACE, MEMBRANE_CHOICE_NATURAL, MEMBRANE_CHOICE_BILAPLACE };

/* ---- posing ---- */

Vec2 shape_uv(const VenShape *s, Vec2 rest)
{
    const Frame *f = &s->frame;
    return vec2((rest.x - f->corner.x) * f->scale / f->width, 1.0 - (f->corner.y - rest.y) * f->scale / f->height);
}

static Surface *flat_blade(const VenShape *s, const Mesh *mesh)
{
    Surface *blade = surface_new(mesh->n_vertices, mesh->n_triangles);
    for (uint32_t i = 0; i < mesh->n_vertices; i++)
        blade->uv[i] = shape_uv(s, mesh->vertex[i]);
    for (uint32_t t = 0; t < mesh->n_triangles; t++)
        for (int k = 0; k < 3; k++)
            blade->triangle[t][k] = mesh->triangle[t][k];
    return blade;
}

static void add_veins(const VenShape *s, Bent *b)
{
    Vec3 *normal = g_new(Vec3, s->skeleton->n_nodes);
    for (uint32_t i = 0; i < s->skeleton->n_nodes; i++)
        normal[i] = b->pose->turn[i].z; /* the vein's own, which no crumpled triangle at the margin can flip */
    b->tubes = solid_tubes(b->pose, normal, &s->solid, &b->n_tubes);
    b->veins = solid_surface(b->tubes, b->n_tubes, &s->solid);
    for (uint32_t i = 0; i < b->veins->n_vertices; i++)
        b->veins->uv[i] = shape_uv(s, b->veins->uv[i]);
    g_free(normal);
}

Bent shape_bend(const VenShape *s, Pose *pose)
{
    Bent b = {.pose = pose, .blade = flat_blade(s, s->mesh)};
    Vec3 *posed = g_new(Vec3, s->n_fixed);
    Mat3 *turn = g_new(Mat3, s->n_fixed);
    for (uint32_t i = 0; i < s->n_fixed; i++) {
        posed[i] = pose->place[s->fixed_node[i]];
        turn[i] = pose->turn[s->fixed_node[i]];
    }
    if (params_choice(s->leaf->params, PARAM_MESH_MEMBRANE) == MEMBRANE_CHOICE_NATURAL)
        membrane_interpolate(s->membrane, posed, b.blade->place);
    else
        membrane_interpolate_turned(s->membrane, posed, turn, b.blade->place);
    g_free(posed);
    g_free(turn);
    surface_normals(b.blade);
    if (params_switch(s->leaf->params, PARAM_MESH_VEINS))
        add_veins(s, &b);
    return b;
}

void bent_clear(Bent *b)
{
    pose_free(b->pose);
    surface_free(b->blade);
    surface_free(b->veins);
    solid_tubes_free(b->tubes, b->n_tubes);
    *b = (Bent){0};
}

/* ---- levels of detail ---- */

/* The same points of the blade in both meshes, so that a coarse leaf lies where the fine one does. */
static Level level_of(const VenShape *s, Mesh *coarse)
{
    Level l = {coarse, g_new(uint32_t, coarse->n_vertices), g_malloc_n(coarse->n_vertices, sizeof(double[3]))};
    MeshLocator *locator = mesh_locator_new(s->mesh);
    for (uint32_t i = 0; i < coarse->n_vertices; i++)
        l.triangle[i] = mesh_locate(locator, coarse->vertex[i], l.weight[i]);
    mesh_locator_free(locator);
    return l;
}

Surface *shape_level_blade(const VenShape *s, const Level *level, const Bent *bent)
{
    Surface *blade = flat_blade(s, level->mesh);
    for (uint32_t i = 0; i < blade->n_vertices; i++) {
        Vec3 sum = vec3(0, 0, 0);
        for (int k = 0; k < 3; k++)
            sum = vec3_add(sum, vec3_scale(bent->blade->place[s->mesh->triangle[level->triangle[i]][k]], level->weight[i][k]));
        blade->place[i] = sum;
    }
    surface_normals(blade);
    return blade;
}

static Mesh *mesh_skeleton(const Skeleton *sk, const MeshDef *def, GError **error)
{
    uint32_t *node_point = g_new(uint32_t, sk->n_nodes);
    Pslg *graph = skeleton_pslg(sk, node_point);
    Mesh *mesh = mesh_new(graph, def, error);
    pslg_free(graph);
    g_free(node_point);
    return mesh;
}

static gboolean add_levels(VenShape *s, GError **error)
{
    const Params *p = s->leaf->params;
    uint32_t wanted = (uint32_t)params_integer(p, PARAM_MESH_LEVELS) - 1;
    s->level = g_new0(Level, MAX(wanted, 1));
    for (uint32_t i = 1; i <= wanted; i++) {
        SkeletonDef def = settings_skeleton(p, s->leaf->length, i);
        MeshDef mesh_def = settings_mesh(p, s->leaf->length, i);
        Skeleton *sk = skeleton_new(s->leaf->net, &def, error);
        Mesh *coarse = sk ? mesh_skeleton(sk, &mesh_def, error) : NULL;
        skeleton_free(sk);
        if (!coarse)
            return FALSE;
        s->level[s->n_levels++] = level_of(s, coarse);
    }
    return TRUE;
}

/* ---- the way there ---- */

static Skeleton *make_skeleton(const VenLeaf *leaf, GError **error)
{
    SkeletonDef def = settings_skeleton(leaf->params, leaf->length, 0);
    Vec2 *point = NULL;
    uint32_t *count = NULL, n;
    Skeleton *sk = skeleton_new(leaf->net, &def, error);
    if (sk && !settings_fictitious(leaf->params, leaf->length, &point, &count, &n, error)) {
        skeleton_free(sk);
        sk = NULL;
    }
    if (sk && n) {
        Skeleton *with = skeleton_add_fictitious(sk, point, count, n, error);
        skeleton_free(sk);
        sk = with;
    }
    g_free(point);
    g_free(count);
    return sk;
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
    Skeleton *coarse = make_skeleton(leaf, error);
    if (!coarse)
        return FALSE;
    MeshDef def = settings_mesh(leaf->params, leaf->length, 0);
    s->mesh = mesh_skeleton(coarse, &def, error);
    if (s->mesh)
        s->skeleton = skeleton_refine(coarse, s->mesh);
    skeleton_free(coarse);
    if (!s->mesh)
        return FALSE;
    find_fixed(s);
    int choice = params_choice(leaf->params, PARAM_MESH_MEMBRANE);
    s->membrane = membrane_new(s->mesh, s->fixed, s->n_fixed, choice == MEMBRANE_CHOICE_BILAPLACE ? MEMBRANE_BILAPLACE : MEMBRANE_LAPLACE, error);
    return s->membrane && add_levels(s, error);
}

static gboolean bend_as_asked(VenShape *s, const Params *p, uint64_t seed, GError **error)
{
    PoseDef def = settings_pose(p, seed);
    Pose *pose = pose_new(s->skeleton);
    if (!pose_apply(pose, &def, error)) {
        pose_free(pose);
        return FALSE;
    }
    bent_clear(&s->bent);
    s->bent = shape_bend(s, pose);
    return TRUE;
}

gboolean ven_shape_pose(VenShape *shape, const VenParams *params, uint64_t seed, GError **error)
{
    return bend_as_asked(shape, params->values, seed, error);
}

VenShape *ven_shape(const VenLeaf *leaf, GError **error)
{
    const Params *p = leaf->params;
    VenShape *s = g_new0(VenShape, 1);
    s->leaf = leaf;
    s->solid = settings_solids(p, leaf->length);
    s->unit = params_number(p, PARAM_EXPORT_LEAF_LENGTH) / leaf->length;
    s->frame = leaf_frame(leaf, leaf->net->margin->box);
    if (build(s, error) && bend_as_asked(s, p, leaf->seed, error))
        return s;
    ven_shape_free(s);
    return NULL;
}

void ven_shape_free(VenShape *s)
{
    if (!s)
        return;
    bent_clear(&s->bent);
    for (uint32_t i = 0; i < s->n_levels; i++) {
        mesh_free(s->level[i].mesh);
        g_free(s->level[i].triangle);
        g_free(s->level[i].weight);
    }
    g_free(s->level);
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
