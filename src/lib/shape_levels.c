/* Levels of detail: coarser meshes of the same leaf, and their veins. */
#include "lib/shape.h"

#include <math.h>

#include "lib/settings.h"
#include "shape/solid_cut.h"

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

void shape_level_clear(Level *l)
{
    mesh_free(l->mesh);
    skeleton_free(l->skeleton);
    g_free(l->triangle);
    g_free(l->weight);
}

static Surface *level_blade(const VenShape *s, const Level *level, const Bent *bent)
{
    Surface *blade = shape_flat_blade(s, level->mesh);
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
        SolidDef def = shape_solids(s->leaf, sqrt(1.0 / quarter));
        b.tubes = solid_tubes(b.pose, normal, &def, &b.n_tubes);
        b.tubes = solid_cut(b.tubes, &b.n_tubes, normal, s->leaf->net->holes);
        thin_veins(&b, &def, quarter * count_triangles(bent) - b.blade->n_triangles);
        shape_dress_veins(s, &b, &def);
    }
    g_free(normal);
    return b;
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
    Mesh *mesh = sk && borrow_names(sk, full) ? shape_mesh(sk, &mesh_def, NULL) : NULL;
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

void shape_add_levels(VenShape *s)
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
