/* The whole way from a parameter file to a bent leaf, on every model of the paper and several hard leaves, made small. */
#include <math.h>
#include <string.h>

#include "geom/polygon.h"
#include "lib/leaf.h"
#include "lib/shape.h"
#include "venation.h"

static const char *const models[][10] = {
    {"alchemilla", "growth.initial_length", "160", "growth.final_length", "225", "sources.density", "0.002"},
    {"cherry", "growth.initial_length", "60", "growth.final_length", "275", "sources.density", "0.001", "veins.kill_distance", "20"},
    {"dart-density", "growth.final_length", "400"},
    {"developmental"},
    {"ginkgo", "growth.final_length", "200"},
    {"grass", "growth.initial_length", "600", "sources.density", "0.0004"},
    {"kill-distance", "growth.final_length", "500", "growth.step", "4"},
    {"orchid", "growth.initial_length", "300", "sources.density", "0.001"},
    {"poplar", "growth.initial_length", "40", "growth.final_length", "500", "sources.density", "0.001"},
    {"reticulate", "growth.initial_length", "50", "growth.final_length", "400", "sources.density", "0.001"},
    {"slow-marginal", "growth.initial_length", "40", "growth.final_length", "160"},
    {"sweetgum", "growth.initial_length", "60", "growth.final_length", "400", "growth.step", "4", "sources.density", "0.002"},
    {"tertiary", "growth.initial_length", "40", "growth.final_length", "200", "sources.density", "0.002"},
    {"toothed", "growth.initial_length", "40", "growth.final_length", "200", "sources.density", "0.002"},
    {"trillium", "growth.initial_length", "300", "sources.density", "0.001"},
};

static VenParams *load(const char *model, const char *const *setting)
{
    GError *error = NULL;
    char *file = g_strconcat(model, ".ini", NULL), *path = g_test_build_filename(G_TEST_DIST, "..", "..", "params", file, NULL);
    VenParams *p = ven_params_load(path, &error);
    g_assert_no_error(error);
    for (; setting && *setting; setting += 2) {
        ven_params_set(p, setting[0], setting[1], &error);
        g_assert_no_error(error);
    }
    g_free(path);
    g_free(file);
    return p;
}

static VenLeaf *grow(const VenParams *p)
{
    GError *error = NULL;
    VenLeaf *leaf = ven_grow(p, 1, NULL, &error);
    g_assert_no_error(error);
    return leaf;
}

static VenShape *shape_of(const VenLeaf *leaf)
{
    GError *error = NULL;
    VenShape *s = ven_shape(leaf, &error);
    g_assert_no_error(error);
    g_assert_nonnull(s);
    return s;
}

/* Finite, of one piece with the skeleton, each triangle of some size, normals of length 1. */
static void check_bent(const VenShape *s)
{
    const Surface *f = s->bent.blade;
    for (uint32_t i = 0; i < f->n_vertices; i++) {
        g_assert_true(isfinite(f->place[i].x) && isfinite(f->place[i].y) && isfinite(f->place[i].z));
        g_assert_cmpfloat(fabs(vec3_norm(f->normal[i]) - 1.0), <, 1e-9);
        g_assert_cmpfloat(f->uv[i].x, >=, 0.0);
        g_assert_cmpfloat(f->uv[i].y, <=, 1.0);
    }
    for (uint32_t i = 0; i < s->n_fixed; i++)
        g_assert_cmpfloat(vec3_dist(f->place[s->fixed[i]], s->bent.pose->place[s->fixed_node[i]]), ==, 0.0);
    for (uint32_t i = 0; i < s->skeleton->n_nodes; i++) {
        uint32_t h = s->skeleton->hinge[i];
        if (h != NO_PARENT) /* veins keep their lengths */
            g_assert_cmpfloat(fabs(vec3_dist(s->bent.pose->place[i], s->bent.pose->place[h]) - vec_dist(s->skeleton->rest[i], s->skeleton->rest[h])), <,
                              1e-9 * s->leaf->length);
    }
}

static void test_model(gconstpointer data)
{
    const char *const *m = data;
    static const char *const preset[] = {"flat", "cupped", "folded", "drooping", "curled_tip", "wavy", "withered"};
    VenParams *p = load(m[0], m + 1);
    VenLeaf *leaf = grow(p);
    for (gsize k = 0; k < G_N_ELEMENTS(preset); k++) {
        GError *error = NULL;
        g_assert_true(params_override(leaf->params, "mesh.levels=3", &error));
        char *setting = g_strdup_printf("pose.preset=%s", preset[k]);
        g_assert_true(params_override(leaf->params, setting, &error));
        g_free(setting);
        VenShape *s = shape_of(leaf), *again = shape_of(leaf);
        check_bent(s);
        g_assert_cmpuint(s->mesh->n_triangles, >, 100);
        for (uint32_t i = 0; k == 0 && i < s->mesh->n_vertices; i++) /* flat is flat, margin and all */
            g_assert_cmpfloat(vec3_dist(s->bent.blade->place[i], vec3_flat(s->mesh->vertex[i])), <, 1e-7 * leaf->length);
        uint32_t before = s->mesh->n_triangles;
        for (uint32_t i = 0; i < s->n_levels; i++) {
            g_assert_cmpuint(s->level[i].mesh->n_triangles, <, before);
            before = s->level[i].mesh->n_triangles;
        }
        g_assert_cmpuint(s->mesh->n_vertices, ==, again->mesh->n_vertices);
        g_assert_true(memcmp(s->bent.blade->place, again->bent.blade->place, sizeof(Vec3) * s->mesh->n_vertices) == 0);
        ven_shape_free(s);
        ven_shape_free(again);
    }
    ven_leaf_free(leaf);
    ven_params_free(p);
}

/* A leaf posed anew is the leaf that was posed so at once; a pose that can't be leaves the old one. */
static void test_repose(void)
{
    VenParams *p = load("poplar", models[8] + 1);
    VenLeaf *leaf = grow(p);
    VenShape *s = shape_of(leaf);
    GError *error = NULL;
    g_assert_true(ven_params_set(p, "pose.preset", "withered", &error));
    g_assert_true(ven_shape_pose(s, p, 1, &error));
    g_assert_true(params_override(leaf->params, "pose.preset=withered", &error));
    VenShape *once = shape_of(leaf);
    gsize size = sizeof(Vec3) * s->mesh->n_vertices;
    g_assert_true(memcmp(s->bent.blade->place, once->bent.blade->place, size) == 0);
    g_assert_true(ven_params_set(p, "pose.rules", "L999 lift 10", &error));
    g_assert_false(ven_shape_pose(s, p, 1, &error));
    g_assert_error(error, POSE_ERROR, POSE_ERROR_VEIN);
    g_clear_error(&error);
    g_assert_true(memcmp(s->bent.blade->place, once->bent.blade->place, size) == 0);
    ven_shape_free(once);
    ven_shape_free(s);
    ven_leaf_free(leaf);
    ven_params_free(p);
}

/* A blend between flat and posed moves every vertex without a jump. */
static void test_blend(void)
{
    VenParams *p = load("poplar", (const char *const[]){"growth.initial_length", "40", "growth.final_length", "400", "sources.density", "0.001", NULL});
    VenLeaf *leaf = grow(p);
    Vec3 *before = NULL;
    for (int i = 0; i <= 20; i++) {
        GError *error = NULL;
        char *blend = g_strdup_printf("pose.blend=%.2f", i / 20.0);
        g_assert_true(params_override(leaf->params, blend, &error));
        g_assert_true(params_override(leaf->params, "pose.preset=drooping", &error));
        g_free(blend);
        VenShape *s = shape_of(leaf);
        for (uint32_t v = 0; before && v < s->mesh->n_vertices; v++)
            g_assert_cmpfloat(vec3_dist(before[v], s->bent.blade->place[v]), <, 0.12 * leaf->length);
        g_free(before);
        before = g_memdup2(s->bent.blade->place, sizeof(Vec3) * s->mesh->n_vertices);
        ven_shape_free(s);
    }
    g_free(before);
    ven_leaf_free(leaf);
    ven_params_free(p);
}

/* A point of the blade off vein node `node`: a vertex of one of its triangles that no vein fixes. */
static bool free_neighbour(const VenShape *s, uint32_t node, Vec2 *at)
{
    for (uint32_t t = 0; t < s->mesh->n_triangles; t++) {
        const uint32_t *v = s->mesh->triangle[t];
        bool here = v[0] == s->skeleton->vertex[node] || v[1] == s->skeleton->vertex[node] || v[2] == s->skeleton->vertex[node];
        for (int k = 0; here && k < 3; k++) {
            bool fixed = false;
            for (uint32_t i = 0; i < s->n_fixed; i++)
                fixed |= s->fixed[i] == v[k];
            *at = s->mesh->vertex[v[k]];
            if (!fixed)
                return true;
        }
    }
    return false;
}

/* A fictitious vein shapes and is not drawn. */
static void test_fictitious(void)
{
    VenParams *p = load("cherry", models[1] + 1);
    VenLeaf *leaf = grow(p);
    VenShape *s = shape_of(leaf);
    uint32_t midrib = skeleton_find(s->skeleton, "midrib"), found = 0;
    const Sequence *q = &s->skeleton->sequence[midrib];
    uint32_t node = s->skeleton->at[q->first + q->n / 2];
    Vec2 from = s->skeleton->rest[node], to = from;
    g_assert_true(free_neighbour(s, node, &to));
    char *setting = g_strdup_printf("mesh.fictitious_veins=%.12g,%.12g %.12g,%.12g", from.x / leaf->length, from.y / leaf->length,
                                    to.x / leaf->length, to.y / leaf->length);
    ven_shape_free(s);
    GError *error = NULL;
    g_assert_true(params_override(leaf->params, setting, &error));
    s = shape_of(leaf);
    for (uint32_t k = 0; k < s->skeleton->n_sequences; k++) {
        found += s->skeleton->sequence[k].fictitious;
        for (uint32_t t = 0; s->skeleton->sequence[k].fictitious && t < s->bent.n_tubes; t++)
            g_assert_cmpuint(s->bent.tubes[t].sequence, !=, k);
    }
    g_assert_cmpuint(found, ==, 1);
    g_free(setting);
    ven_shape_free(s);
    ven_leaf_free(leaf);
    ven_params_free(p);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    for (size_t i = 0; i < G_N_ELEMENTS(models); i++) {
        char *name = g_strdup_printf("/shape/model/%s", models[i][0]);
        g_test_add_data_func(name, models[i], test_model);
        g_free(name);
    }
    g_test_add_func("/shape/repose", test_repose);
    g_test_add_func("/shape/blend", test_blend);
    g_test_add_func("/shape/fictitious", test_fictitious);
    return g_test_run();
}
