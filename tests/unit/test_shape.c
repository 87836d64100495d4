/* The whole way from a parameter file to a bent leaf, on every model of the paper and several hard leaves, made small. */
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#include "geom/polygon.h"
#include "lib/leaf.h"
#include "lib/shape.h"
#include "plain_json.h"
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

static uint32_t count_triangles(const Bent *b) { return b->blade->n_triangles + b->veins->n_triangles; }

/* Blade and vein solids of a level together: each has about a quarter of the one before, however many are asked for, to the end of the chain,
 * which is a leaf yet: the midrib is left. Veins of a level lie at its blade and bear the names of the full leaf's. */
static void test_levels(gconstpointer data)
{
    const char *const *m = data;
    VenParams *p = load(m[0], m + 1);
    VenLeaf *leaf = grow(p);
    for (int n = 1; n <= 8; n++) {
        GError *error = NULL;
        char *setting = g_strdup_printf("mesh.levels=%d", n);
        g_assert_true(params_override(leaf->params, setting, &error));
        g_free(setting);
        VenShape *s = shape_of(leaf);
        g_assert_cmpuint(ven_shape_levels(s), <=, (uint32_t)n);
        g_assert_cmpuint(ven_shape_levels(s), >=, (uint32_t)MIN(n, 2));
        uint32_t before = count_triangles(&s->bent), full = before;
        g_assert_cmpuint(s->bent.veins->n_triangles, <, 3 * s->bent.blade->n_triangles);
        for (uint32_t i = 1; i < ven_shape_levels(s); i++) {
            Bent b = shape_level_bend(s, i, &s->bent);
            uint32_t now = count_triangles(&b);
            g_test_message("%s level %u of %d: %u (blade %u)", m[0], i, n, now, b.blade->n_triangles);
            g_assert_cmpfloat(now, <, before * (i == ven_shape_levels(s) - 1 ? 0.65 : 0.45));
            g_assert_cmpfloat(now, <, 1.5 * full / pow(4.0, i) + 60);
            const Skeleton *sk = s->level[i - 1].skeleton;
            g_assert_cmpuint(b.tubes[0].sequence, ==, skeleton_find(sk, "midrib"));
            g_assert_cmpuint(sk->sequence[b.tubes[0].sequence].vein, ==, s->skeleton->sequence[0].vein);
            for (uint32_t q = 0; q < sk->n_sequences; q++) {
                uint32_t same = skeleton_find(s->skeleton, sk->sequence[q].name);
                g_assert_true(same == NO_PARENT || s->skeleton->sequence[same].vein == sk->sequence[q].vein);
            }
            for (uint32_t k = 0; k < b.n_tubes; k++)
                for (uint32_t j = b.tubes[k].petiole; j < b.tubes[k].n; j++)
                    g_assert_cmpfloat(vec3_dist(b.tubes[k].centre[j], b.pose->place[b.tubes[k].node[j]]), <, 0.2 * leaf->length);
            before = now;
            bent_clear(&b);
        }
        if (n == 8)
            g_assert_cmpuint(before, <, 700);
        ven_shape_free(s);
    }
    ven_leaf_free(leaf);
    ven_params_free(p);
}

static gboolean has_faces(const char *dir, const char *name, uint32_t *n)
{
    char *path = g_build_filename(dir, name, NULL), *text = NULL;
    gboolean there = g_file_get_contents(path, &text, NULL, NULL);
    if (there)
        *n = (uint32_t)g_ascii_strtoull(strstr(text, "element face ") + 13, NULL, 10);
    if (there)
        g_remove(path);
    g_free(path);
    g_free(text);
    return there;
}

/* The files hold what the levels have. */
static void test_level_files(void)
{
    VenParams *p = load("cherry", models[1] + 1);
    VenLeaf *leaf = grow(p);
    GError *error = NULL;
    g_assert_true(params_override(leaf->params, "mesh.levels=8", &error));
    g_assert_true(params_override(leaf->params, "export.models=ply", &error));
    VenShape *s = shape_of(leaf);
    char *dir = g_dir_make_tmp("venation-shape-XXXXXX", &error);
    g_assert_true(ven_shape_write(s, dir, "leaf", &error));
    g_assert_no_error(error);
    uint32_t n = 0;
    g_assert_true(has_faces(dir, "leaf.ply", &n));
    g_assert_cmpuint(n, ==, count_triangles(&s->bent));
    for (uint32_t i = 1; i <= 8; i++) {
        char *name = g_strdup_printf("leaf_lod%u.ply", i);
        gboolean there = has_faces(dir, name, &n);
        g_assert_cmpint(there, ==, i < ven_shape_levels(s));
        if (there) {
            Bent b = shape_level_bend(s, i, &s->bent);
            g_assert_cmpuint(n, ==, count_triangles(&b));
            bent_clear(&b);
        }
        g_free(name);
    }
    char *json = g_build_filename(dir, "leaf.json", NULL);
    g_remove(json);
    g_assert_cmpint(g_rmdir(dir), ==, 0);
    g_free(json);
    g_free(dir);
    ven_shape_free(s);
    ven_leaf_free(leaf);
    ven_params_free(p);
}

/* mesh.membrane is what interpolates the blade: the three differ in a bent leaf, each is the membrane's own answer. */
static void test_membranes(void)
{
    static const char *const choice[] = {"mesh.membrane=laplace", "mesh.membrane=natural", "mesh.membrane=bilaplace"};
    VenParams *p = load("cherry", models[1] + 1);
    VenLeaf *leaf = grow(p);
    VenShape *shape[3];
    GError *error = NULL;
    g_assert_true(params_override(leaf->params, "pose.preset=cupped", &error));
    for (int k = 0; k < 3; k++) {
        g_assert_true(params_override(leaf->params, choice[k], &error));
        VenShape *s = shape[k] = shape_of(leaf);
        Membrane *own = membrane_new(s->mesh, s->fixed, s->n_fixed, k == 2 ? MEMBRANE_BILAPLACE : MEMBRANE_LAPLACE, &error);
        Vec3 *posed = g_new(Vec3, s->n_fixed), *place = g_new(Vec3, s->mesh->n_vertices);
        Mat3 *turn = g_new(Mat3, s->n_fixed);
        for (uint32_t i = 0; i < s->n_fixed; i++) {
            posed[i] = s->bent.pose->place[s->fixed_node[i]];
            turn[i] = s->bent.pose->turn[s->fixed_node[i]];
        }
        if (k == 1)
            membrane_interpolate(own, posed, place);
        else
            membrane_interpolate_turned(own, posed, turn, place);
        for (uint32_t i = 0; i < s->mesh->n_vertices; i++)
            g_assert_cmpfloat(vec3_dist(place[i], s->bent.blade->place[i]), <, 1e-9 * leaf->length);
        membrane_free(own);
        g_free(posed);
        g_free(place);
        g_free(turn);
    }
    for (int a = 0; a < 3; a++)
        for (int b = a + 1; b < 3; b++) {
            double most = 0.0;
            for (uint32_t i = 0; i < shape[a]->mesh->n_vertices; i++)
                most = fmax(most, vec3_dist(shape[a]->bent.blade->place[i], shape[b]->bent.blade->place[i]));
            g_assert_cmpfloat(most, >, 0.003 * leaf->length);
        }
    for (int k = 0; k < 3; k++)
        ven_shape_free(shape[k]);
    ven_leaf_free(leaf);
    ven_params_free(p);
}

/* The record and whoever asks are told what the rig could not hold. */
static void test_rig_loss(void)
{
    VenParams *p = load("cherry", models[1] + 1);
    VenLeaf *leaf = grow(p);
    GError *error = NULL;
    uint32_t joints[2];
    double worst[2], mean[2];
    VenShape *bare = shape_of(leaf);
    g_assert_false(ven_shape_rig(bare, &joints[0], &worst[0], &mean[0]));
    char *record = ven_shape_record(bare);
    g_assert_null(strstr(record, "worst_loss"));
    g_assert_nonnull(strstr(record, "{\"name\": \"L1\", \"order\": 2, \"parent\": \"midrib\", \"length\": "));
    g_assert_nonnull(strstr(record, "{\"name\": \"midrib\", \"order\": 1, \"parent\": null, \"length\": "));
    g_free(record);
    ven_shape_free(bare);
    for (int k = 0; k < 2; k++) {
        g_assert_true(params_override(leaf->params, k ? "export.rig=8" : "export.rig=4", &error));
        VenShape *s = shape_of(leaf);
        g_assert_true(ven_shape_rig(s, &joints[k], &worst[k], &mean[k]));
        for (uint32_t j = 0; j < joints[k]; j++)
            g_assert_cmpfloat(vec3_dist(s->rig->joint[j].place, s->bent.pose->place[s->rig->joint[j].node]), ==, 0.0);
        record = ven_shape_record(s);
        g_assert_nonnull(strstr(record, "\"worst_loss\": 0."));
        g_free(record);
        ven_shape_free(s);
    }
    g_assert_cmpuint(joints[0], ==, joints[1]);
    g_assert_cmpfloat(worst[0], >, worst[1]);
    g_assert_cmpfloat(worst[1], >, mean[1]);
    g_assert_cmpfloat(mean[0], >, mean[1]);
    ven_leaf_free(leaf);
    ven_params_free(p);
}

/* ---- the animated file ---- */

/* Three floats a vertex of an accessor. */
static const float *vectors(const Json *json, const char *bin, guint accessor, uint32_t n)
{
    const Json *a = at(get(json, "accessors"), accessor), *v = at(get(json, "bufferViews"), whole(get(a, "bufferView")));
    g_assert_cmpuint(whole(get(a, "count")), ==, n);
    return (const float *)(const void *)(bin + whole(get(v, "byteOffset")));
}

/* A surface as written: rest and target together, in leaf space and segments. */
static void read_target(const Json *mesh, const Json *json, const char *bin, guint target, double unit, Surface *out)
{
    const Json *primitive = at(get(mesh, "primitives"), 0), *t = at(get(primitive, "targets"), target);
    uint32_t n = out->n_vertices;
    const float *p = vectors(json, bin, whole(get(get(primitive, "attributes"), "POSITION")), n), *dp = vectors(json, bin, whole(get(t, "POSITION")), n);
    const float *q = vectors(json, bin, whole(get(get(primitive, "attributes"), "NORMAL")), n), *dq = vectors(json, bin, whole(get(t, "NORMAL")), n);
    for (uint32_t i = 0; i < n; i++, p += 3, dp += 3, q += 3, dq += 3) {
        out->place[i] = vec3_scale(vec3((double)(p[0] + dp[0]), (double)-(p[2] + dp[2]), (double)(p[1] + dp[1])), 1.0 / unit);
        out->normal[i] = vec3((double)(q[0] + dq[0]), (double)-(q[2] + dq[2]), (double)(q[1] + dq[1]));
    }
}

static double area(const Surface *f, const uint32_t (*triangle)[3], const Vec3 *p, const Vec3 *q)
{
    double sum = 0.0;
    for (uint32_t t = 0; t < f->n_triangles; t++) {
        Vec3 v[3];
        for (int k = 0; k < 3; k++)
            v[k] = vec3_lerp(p[triangle[t][k]], q[triangle[t][k]], 0.5);
        sum += 0.5 * vec3_norm(vec3_cross(vec3_sub(v[1], v[0]), vec3_sub(v[2], v[0])));
    }
    return sum;
}

static void check_target(const Surface *got, const Surface *want, double length)
{
    for (uint32_t i = 0; i < want->n_vertices; i++) {
        g_assert_cmpfloat(vec3_dist(got->place[i], want->place[i]), <, 1e-5 * length);
        g_assert_cmpfloat(vec3_dist(got->normal[i], want->normal[i]), <, 1e-5);
    }
}

/* Keyframes are the poses they name, normals and vein solids too; between far ones there are others, so that half way from one to the next,
 * where a viewer draws the mean of the two, the blade has not shrunk. Targets are called by their times. */
static void test_animated(gconstpointer data)
{
    const char *const *m = data;
    VenParams *p = load(m[0], m + 1);
    VenLeaf *leaf = grow(p);
    GError *error = NULL;
    g_assert_true(params_override(leaf->params, "pose.preset=flat", &error));
    g_assert_true(params_override(leaf->params, "texture.size=64", &error));
    g_assert_true(params_override(leaf->params, "export.models=glb", &error));
    g_assert_true(params_override(leaf->params, "pose.keyframes=1.5 preset=withered age=1; 2.25 preset=cupped", &error));
    VenShape *s = shape_of(leaf);
    char *dir = g_dir_make_tmp("venation-shape-XXXXXX", &error), *file = g_build_filename(dir, "leaf_animated.glb", NULL), *text;
    g_assert_true(ven_shape_write(s, dir, "leaf", &error));
    g_assert_no_error(error);
    g_assert_true(g_file_get_contents(file, &text, NULL, &error));
    const char *at_json = text + 20, *bin = text + 20 + *(const uint32_t *)(const void *)(text + 12) + 8;
    Json *json = json_read(&at_json);
    const Json *blade = at(get(json, "meshes"), 0), *veins = at(get(json, "meshes"), 1), *names = get(get(blade, "extras"), "targetNames");
    guint n = length(names), found = 0;
    g_assert_cmpuint(n, >, 12);
    g_assert_cmpuint(n, <, 50);
    Surface *got = surface_new(s->mesh->n_vertices, s->mesh->n_triangles), *tubes = surface_new(s->bent.veins->n_vertices, s->bent.veins->n_triangles);
    Vec3 *last = g_memdup2(s->bent.blade->place, sizeof(Vec3) * got->n_vertices);
    double before = 0.0;
    for (guint k = 0; k < n; k++) {
        double time = g_ascii_strtod(at(names, k)->text, NULL);
        g_assert_true(g_str_has_suffix(at(names, k)->text, " s"));
        g_assert_cmpfloat(time, >, before);
        before = time;
        read_target(blade, json, bin, k, s->unit, got);
        read_target(veins, json, bin, k, s->unit, tubes);
        const uint32_t(*triangle)[3] = (const uint32_t(*)[3])s->mesh->triangle;
        double half = area(got, triangle, last, got->place), whole_way = 0.5 * (area(got, triangle, last, last) + area(got, triangle, got->place, got->place));
        g_assert_cmpfloat(half, >, 0.97 * whole_way);
        memcpy(last, got->place, sizeof(Vec3) * got->n_vertices);
        if (time != 1.5 && time != 2.25)
            continue;
        assert_text(at(names, k), time < 2 ? "1.5 s" : "2.25 s");
        VenParams *key = load(m[0], m + 1);
        g_assert_true(ven_params_set(key, "pose.preset", time < 2 ? "withered" : "cupped", &error));
        g_assert_true(ven_params_set(key, "pose.age", "1", &error));
        g_assert_true(ven_shape_pose(s, key, leaf->seed, &error));
        check_target(got, s->bent.blade, leaf->length);
        check_target(tubes, s->bent.veins, leaf->length);
        ven_params_free(key);
        found++;
    }
    g_assert_cmpuint(found, ==, 2);
    static const char *const written[] = {"leaf_animated.glb", "leaf.glb", "leaf.json"};
    for (gsize i = 0; i < G_N_ELEMENTS(written); i++) {
        char *path = g_build_filename(dir, written[i], NULL);
        g_remove(path);
        g_free(path);
    }
    g_assert_cmpint(g_rmdir(dir), ==, 0);
    surface_free(got);
    surface_free(tubes);
    json_free(json);
    g_free(last);
    g_free(text);
    g_free(file);
    g_free(dir);
    ven_shape_free(s);
    ven_leaf_free(leaf);
    ven_params_free(p);
}

/* Errors name the place and what was written there. */
static void test_messages(void)
{
    static const struct {
        const char *setting, *message;
    } bad[] = {{"pose.rules=midrib lift 10; L1 lift x", "--set pose.rules: pose rule 2, 'L1 lift x': found 'x'*"},
               {"mesh.fictitious_veins=0,0.5 9,0.5", "--set mesh.fictitious_veins: fictitious vein F1 *0.5; it must keep 0.00* away"},
               {"mesh.fictitious_veins=0,0.5", "--set mesh.fictitious_veins: '0,0.5' needs two points*"}};
    VenParams *p = load("cherry", models[1] + 1);
    VenLeaf *leaf = grow(p);
    for (gsize i = 0; i < G_N_ELEMENTS(bad); i++) {
        GError *error = NULL;
        Params *good = params_copy(leaf->params);
        g_assert_true(params_override(leaf->params, bad[i].setting, &error));
        g_assert_null(ven_shape(leaf, &error));
        if (!g_pattern_match_simple(bad[i].message, error->message))
            g_error("'%s' instead of '%s'", error->message, bad[i].message);
        g_clear_error(&error);
        params_free(leaf->params);
        leaf->params = good;
    }
    ven_leaf_free(leaf);
    ven_params_free(p);
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

/* ---- narrow places ---- */

/* The midrib passes a notch, nearer than mesh.clearance, before it is as long as mesh.min_length: the leaf bends all the same. */
static void test_notch(void)
{
    GError *error = NULL;
    const Vec2 margin[] = {{-5, 0}, {5, 0}, {20, 5}, {0.2, 8}, {20, 11}, {40, 50}, {0, 100}, {-40, 50}};
    VenParams *p = ven_params_new();
    Network *net = network_new(101, 100);
    net->margin = polygon_new(margin, G_N_ELEMENTS(margin));
    net->length = 100.0;
    net->n_veins = 1;
    for (uint32_t v = 0; v <= 100; v++)
        net->node[v] = vec2(0.0, v);
    for (uint32_t e = 0; e < 100; e++) {
        net->tail[e] = e;
        net->head[e] = e + 1;
        net->width[e] = net->flow[e] = net->order[e] = net->rank[e] = 1;
    }
    VenLeaf leaf = {.params = p->values, .net = net, .length = 100.0, .stage = net->margin->box};
    SkeletonDef def = settings_skeleton(p->values, 100.0, 1.0);
    g_assert_null(skeleton_new(net, &def, &error)); /* as it is asked for */
    g_assert_error(error, SKELETON_ERROR, SKELETON_ERROR_EMPTY);
    g_clear_error(&error);
    VenShape *s = shape_of(&leaf);
    g_assert_cmpuint(s->skeleton->n_sequences, ==, 1);
    g_assert_cmpfloat(s->skeleton->sequence[0].length, >, 90.0);
    ven_shape_free(s);
    ven_params_set(p, "mesh.max_order", "1", &error);
    for (uint32_t e = 0; e < 100; e++)
        net->order[e] = 2;
    g_assert_null(ven_shape(&leaf, &error)); /* what was asked for is named, not what was tried */
    g_assert_error(error, SKELETON_ERROR, SKELETON_ERROR_EMPTY);
    g_assert_nonnull(strstr(error->message, "of order up to 1, at least 12 segments long"));
    g_clear_error(&error);
    network_free(net);
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
    static const int levelled[] = {0, 1, 4, 5, 8, 11, 13};
    for (size_t i = 0; i < G_N_ELEMENTS(levelled); i++) {
        char *name = g_strdup_printf("/shape/levels/%s", models[levelled[i]][0]);
        g_test_add_data_func(name, models[levelled[i]], test_levels);
        g_free(name);
    }
    g_test_add_func("/shape/levels/files", test_level_files);
    g_test_add_func("/shape/membranes", test_membranes);
    g_test_add_func("/shape/rig", test_rig_loss);
    g_test_add_func("/shape/messages", test_messages);
    static const int animated[] = {1, 4, 5};
    for (size_t i = 0; i < G_N_ELEMENTS(animated); i++) {
        char *name = g_strdup_printf("/shape/animated/%s", models[animated[i]][0]);
        g_test_add_data_func(name, models[animated[i]], test_animated);
        g_free(name);
    }
    g_test_add_func("/shape/repose", test_repose);
    g_test_add_func("/shape/blend", test_blend);
    g_test_add_func("/shape/fictitious", test_fictitious);
    g_test_add_func("/shape/notch", test_notch);
    return g_test_run();
}
