/* From a venation graph to a bent leaf: skeleton, mesh, pose, membrane, vein solids (Hong 2005, chapters 6 and 7). */
#include "lib/shape.h"

#include <math.h>

#include "lib/settings.h"
#include "shape/solid_cut.h"
#include "sim/torn.h"

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

/* The tubes, but for what a hole took, as a surface with uv. */
static void dress_veins(const VenShape *s, Bent *b, const SolidDef *def)
{
    if (b->n_tubes == 0)
        return;
    b->veins = solid_surface(b->tubes, b->n_tubes, def);
    for (uint32_t i = 0; i < b->veins->n_vertices; i++)
        b->veins->uv[i] = shape_uv(s, b->veins->uv[i]);
}

static void add_veins(const VenShape *s, Bent *b)
{
    Vec3 *normal = g_new(Vec3, s->skeleton->n_nodes);
    for (uint32_t i = 0; i < s->skeleton->n_nodes; i++)
        normal[i] = b->pose->turn[i].z; /* the vein's own, which no crumpled triangle at the margin can flip */
    b->tubes = solid_tubes(b->pose, normal, &s->solid, &b->n_tubes);
    b->tubes = solid_cut(b->tubes, &b->n_tubes, normal, s->leaf->net->holes);
    dress_veins(s, b, &s->solid);
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

/* The petiole of a real leaf is as long and as wide as the scan shows it. The stub of one that was cut off tells neither: it gets enough length to look
 * like a stalk, and the width that the veins ask for. */
static void real_petiole(const VenLeaf *leaf, SolidDef *def)
{
    const double least = 6.0; /* widths */
    const Profile *f = leaf->ground ? leaf->ground->profile : NULL;
    if (!f || !f->has_stalk || params_is_given(leaf->params, PARAM_MESH_PETIOLE_LENGTH))
        return;
    double segments = leaf->length / vec_dist(leaf->ground->base, leaf->ground->tip); /* a pixel */
    bool stub = f->stalk_length < least * f->stalk_width;
    def->petiole_length = MAX(f->stalk_length, least * f->stalk_width) * segments;
    def->petiole_radius = stub ? 0.0 : 0.5 * f->stalk_width * segments;
}

/* ---- levels of detail ---- */

/* A level has about a quarter of the triangles of the one before, at least half of them must go, and the leaf must stay a leaf. */
static const double wanted_part = 0.25, most_part = 0.5;
enum { LEVEL_TRIES = 6, LEAST_TRIANGLES = 24 };

/* The same points of the blade in both meshes, so that a coarse leaf lies where the fine one does. */
static Level level_of(const VenShape *s, Mesh *mesh, Skeleton *skeleton)
{
    Level l = {mesh, skeleton, g_new(uint32_t, mesh->n_vertices), g_malloc_n(mesh->n_vertices, sizeof(double[3]))};
    MeshLocator *locator = mesh_locator_new(s->mesh);
    for (uint32_t i = 0; i < mesh->n_vertices; i++)
        l.triangle[i] = mesh_locate(locator, mesh->vertex[i], l.weight[i]);
    mesh_locator_free(locator);
    return l;
}

static void level_clear(Level *l)
{
    mesh_free(l->mesh);
    skeleton_free(l->skeleton);
    g_free(l->triangle);
    g_free(l->weight);
}

static Surface *level_blade(const VenShape *s, const Level *level, const Bent *bent)
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

static uint32_t count_triangles(const Bent *b) { return b->blade->n_triangles + (b->veins ? b->veins->n_triangles : 0); }

/* The thinnest tube that no other leaves; not the first, which is the midrib's. */
static uint32_t thinnest(const Bent *b, const uint32_t *branches)
{
    uint32_t best = 0;
    double least = HUGE_VAL;
    for (uint32_t i = 1; i < b->n_tubes; i++) {
        double r = b->tubes[i].radius[b->tubes[i].n / 2];
        if (r <= least && branches[b->tubes[i].sequence] == 0) { /* of equals the last */
            least = r;
            best = i;
        }
    }
    return best;
}

/* Leaves out tubes until at most so many triangles are left. */
static void thin_veins(Bent *b, const SolidDef *def, double most)
{
    const Sequence *sequence = b->pose->skeleton->sequence;
    uint32_t *branches = g_new0(uint32_t, b->pose->skeleton->n_sequences), i;
    double have = 0.0;
    for (i = 0; i < b->n_tubes; i++) {
        uint32_t parent = sequence[b->tubes[i].sequence].parent;
        have += solid_tube_triangles(&b->tubes[i], def);
        if (parent != NO_PARENT)
            branches[parent]++;
    }
    while (have > most && (i = thinnest(b, branches)) > 0) {
        uint32_t parent = sequence[b->tubes[i].sequence].parent;
        have -= solid_tube_triangles(&b->tubes[i], def);
        if (parent != NO_PARENT)
            branches[parent]--;
        solid_tube_clear(&b->tubes[i]);
        for (b->n_tubes--; i < b->n_tubes; i++)
            b->tubes[i] = b->tubes[i + 1];
    }
    g_free(branches);
}

Bent shape_level_bend(const VenShape *s, uint32_t level, const Bent *bent)
{
    const Level *l = &s->level[level - 1];
    double quarter = 1.0;
    Bent b = {.blade = level_blade(s, l, bent), .pose = pose_new(l->skeleton)};
    Vec3 *normal = g_new(Vec3, l->skeleton->n_nodes);
    for (uint32_t i = 0; i < l->skeleton->n_nodes; i++) {
        b.pose->place[i] = b.blade->place[l->skeleton->vertex[i]];
        normal[i] = b.blade->normal[l->skeleton->vertex[i]];
    }
    for (uint32_t i = 0; i < level; i++)
        quarter *= wanted_part;
    if (bent->veins) {
        SolidDef def = settings_solids(s->leaf->params, s->leaf->length, sqrt(1.0 / quarter));
        real_petiole(s->leaf, &def);
        b.tubes = solid_tubes(b.pose, normal, &def, &b.n_tubes);
        b.tubes = solid_cut(b.tubes, &b.n_tubes, normal, s->leaf->net->holes);
        thin_veins(&b, &def, quarter * count_triangles(bent) - b.blade->n_triangles);
        dress_veins(s, &b, &def);
    }
    g_free(normal);
    return b;
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

/* Veins are called what they are called in the full leaf. FALSE: the midrib is none of them. */
static gboolean borrow_names(Skeleton *coarse, const Skeleton *full)
{
    gboolean midrib = FALSE;
    for (uint32_t q = 0; q < coarse->n_sequences; q++) {
        Sequence *c = &coarse->sequence[q];
        uint32_t k = 0;
        while (k < full->n_sequences && (full->sequence[k].fictitious || full->sequence[k].vein != c->vein))
            k++;
        if (k < full->n_sequences)
            g_strlcpy(c->name, full->sequence[k].name, sizeof c->name);
        else
            g_snprintf(c->name, sizeof c->name, "V%u", q); /* was no part of the full skeleton */
        midrib |= k == 0;
    }
    return midrib;
}

/* A coarser leaf, NULL when that can't be. Short veins go, but the midrib stays. */
static Mesh *coarse_mesh(const VenShape *s, double coarser, Skeleton **skeleton)
{
    const VenLeaf *leaf = s->leaf;
    const Skeleton *full = s->skeleton;
    SkeletonDef def = settings_skeleton(leaf->params, leaf->length, coarser);
    MeshDef mesh_def = settings_mesh(leaf->params, leaf->length, coarser);
    def.min_length = MIN(def.min_length, 0.7 * full->sequence[0].length);
    Skeleton *sk = shape_skeleton_by(s, def, NULL);
    Mesh *mesh = sk && borrow_names(sk, full) ? mesh_skeleton(sk, &mesh_def, NULL) : NULL;
    *skeleton = mesh ? skeleton_refine(sk, mesh) : NULL;
    skeleton_free(sk);
    return mesh;
}

/* The coarse mesh that has nearest to `wanted` triangles, or, if none has few enough, the fewest. */
static Mesh *find_level(const VenShape *s, double wanted, double *coarser, Skeleton **skeleton)
{
    Mesh *best = NULL;
    double low = *coarser, at = 2.0 * low, high = 0.0;
    *skeleton = NULL;
    for (int i = 0; i < LEVEL_TRIES; i++) {
        Skeleton *sk;
        Mesh *mesh = coarse_mesh(s, at, &sk);
        double n = mesh ? mesh->n_triangles : 0.0, before = best ? best->n_triangles : HUGE_VAL;
        if (mesh && n >= LEAST_TRIANGLES && fabs(n - wanted) < fabs(before - wanted)) {
            mesh_free(best);
            skeleton_free(*skeleton);
            best = mesh;
            *skeleton = sk;
            *coarser = at;
        } else {
            mesh_free(mesh);
            skeleton_free(sk);
        }
        if (best && fabs(best->n_triangles - wanted) < 0.15 * wanted)
            break;
        if (n > wanted)
            low = at;
        else
            high = at;
        at = high > 0.0 ? sqrt(low * high) : 1.6 * at;
    }
    return best;
}

static void add_levels(VenShape *s)
{
    uint32_t wanted = (uint32_t)params_integer(s->leaf->params, PARAM_MESH_LEVELS) - 1;
    double coarser = 1.0, triangles = s->mesh->n_triangles;
    s->level = g_new0(Level, MAX(wanted, 1));
    while (s->n_levels < wanted) {
        Skeleton *skeleton;
        uint32_t before = s->n_levels ? s->level[s->n_levels - 1].mesh->n_triangles : s->mesh->n_triangles;
        triangles *= wanted_part;
        Mesh *mesh = find_level(s, triangles, &coarser, &skeleton);
        if (!mesh || mesh->n_triangles > most_part * before) { /* the leaf is as simple as it can be */
            mesh_free(mesh);
            skeleton_free(skeleton);
            return;
        }
        s->level[s->n_levels++] = level_of(s, mesh, skeleton);
    }
}

/* ---- the way there ---- */

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
    s->mesh = mesh_skeleton(coarse, &def, error);
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
    add_levels(s);
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
    s->solid = settings_solids(p, leaf->length, 1.0);
    real_petiole(leaf, &s->solid);
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
        level_clear(&s->level[i]);
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
