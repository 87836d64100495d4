/* Rigs: which joints, weights against a plain twin, linear blend skinning. The leaf is a grid, its veins run along grid lines. */
#include <glib.h>
#include <string.h>

#include "shape/rig.h"

enum { WIDE = 13, HIGH = 16 };

/* A hand-made leaf: midrib up the middle, laterals along rows, a vein of third order down from one of them. */
typedef struct {
    Skeleton skeleton;
    Mesh mesh;
    Membrane *membrane;
    uint32_t *fixed, *fixed_node, n_fixed;
} Leaf;

static void make_mesh(Mesh *m)
{
    *m = (Mesh){.n_vertices = WIDE * HIGH, .n_triangles = 2 * (WIDE - 1) * (HIGH - 1), .n_boundary = 2 * (WIDE + HIGH - 2)};
    m->vertex = g_new(Vec2, m->n_vertices);
    m->triangle = g_malloc_n(m->n_triangles, sizeof *m->triangle);
    for (uint32_t i = 0; i < m->n_vertices; i++)
        m->vertex[i] = vec2((double)(i % WIDE) - WIDE / 2, i / WIDE);
    uint32_t t = 0;
    for (uint32_t y = 0; y + 1 < HIGH; y++)
        for (uint32_t x = 0; x + 1 < WIDE; x++) {
            uint32_t a = y * WIDE + x, b = a + 1, c = a + WIDE, d = c + 1;
            memcpy(m->triangle[t++], (uint32_t[3]){a, b, d}, 12);
            memcpy(m->triangle[t++], (uint32_t[3]){a, d, c}, 12);
        }
    m->boundary = g_malloc_n(m->n_boundary, sizeof *m->boundary);
    m->boundary_input = g_new0(uint32_t, m->n_boundary);
    uint32_t at = 0, n = 0;
    const int step[4] = {1, WIDE, -1, -WIDE}, length[4] = {WIDE - 1, HIGH - 1, WIDE - 1, HIGH - 1};
    for (int side = 0; side < 4; side++)
        for (int k = 0; k < length[side]; k++, at += (uint32_t)step[side]) {
            m->boundary[n][0] = at;
            m->boundary[n++][1] = at + (uint32_t)step[side];
        }
}

/* Sequence as grid vertices; its first one may be a node already. */
static void add_sequence(Leaf *l, const char *name, uint32_t parent, uint8_t order, uint32_t x, uint32_t y, int dx, int dy, uint32_t n)
{
    Skeleton *s = &l->skeleton;
    Sequence q = {.parent = parent, .first = s->n_at, .n = n, .order = order, .vein = s->n_sequences, .length = n - 1};
    g_strlcpy(q.name, name, sizeof q.name);
    for (uint32_t k = 0, last = NO_PARENT; k < n; k++) {
        uint32_t vertex = (uint32_t)((int)y + dy * (int)k) * WIDE + (uint32_t)((int)x + dx * (int)k), node = NO_PARENT;
        for (uint32_t i = 0; i < s->n_nodes; i++)
            if (s->vertex[i] == vertex)
                node = i;
        if (node == NO_PARENT) {
            node = s->n_nodes++;
            s->vertex[node] = vertex;
            s->rest[node] = l->mesh.vertex[vertex];
            s->hinge[node] = last;
        }
        g_assert_true(k == 0 || s->hinge[node] == last);
        s->at[s->n_at++] = last = node;
    }
    s->sequence[s->n_sequences++] = q;
}

static void leaf_begin(Leaf *l)
{
    *l = (Leaf){0};
    make_mesh(&l->mesh);
    l->skeleton.rest = g_new0(Vec2, l->mesh.n_vertices);
    l->skeleton.hinge = g_new0(uint32_t, l->mesh.n_vertices);
    l->skeleton.vertex = g_new0(uint32_t, l->mesh.n_vertices);
    l->skeleton.at = g_new0(uint32_t, 2 * l->mesh.n_vertices);
    l->skeleton.sequence = g_new0(Sequence, 16);
}

/* The fixed vertices in an order of their own. */
static void leaf_end(Leaf *l)
{
    l->n_fixed = l->skeleton.n_nodes;
    l->fixed = g_new(uint32_t, l->n_fixed);
    l->fixed_node = g_new(uint32_t, l->n_fixed);
    for (uint32_t i = 0; i < l->n_fixed; i++) {
        l->fixed_node[i] = l->n_fixed - 1 - i;
        l->fixed[i] = l->skeleton.vertex[l->fixed_node[i]];
    }
    GError *error = NULL;
    l->membrane = membrane_new(&l->mesh, l->fixed, l->n_fixed, MEMBRANE_LAPLACE, &error);
    g_assert_no_error(error);
}

static void leaf_full(Leaf *l)
{
    leaf_begin(l);
    add_sequence(l, "midrib", NO_PARENT, 1, 6, 0, 0, 1, 15);
    add_sequence(l, "R1", 0, 2, 6, 4, 1, 0, 6);
    add_sequence(l, "L1", 0, 2, 6, 5, -1, 0, 5);
    add_sequence(l, "L2", 0, 2, 6, 10, -1, 0, 4);
    add_sequence(l, "R1.R1", 1, 3, 9, 4, 0, 1, 5);
    leaf_end(l);
}

static void leaf_clear(Leaf *l)
{
    membrane_free(l->membrane);
    g_free(l->mesh.vertex);
    g_free(l->mesh.triangle);
    g_free(l->mesh.boundary);
    g_free(l->mesh.boundary_input);
    g_free(l->skeleton.rest);
    g_free(l->skeleton.hinge);
    g_free(l->skeleton.vertex);
    g_free(l->skeleton.at);
    g_free(l->skeleton.sequence);
    g_free(l->fixed);
    g_free(l->fixed_node);
}

/* A vein vertex at each node, and one of the petiole. */
static Rig *leaf_rig(Leaf *l, uint32_t per_sequence, uint32_t per_vertex)
{
    uint32_t n = l->skeleton.n_nodes, *node = g_new(uint32_t, n + 1);
    for (uint32_t i = 0; i < n; i++)
        node[i] = i;
    node[n] = NO_PARENT;
    GError *error = NULL;
    Rig *r = rig_new(&l->skeleton, &l->mesh, l->membrane, l->fixed_node, l->n_fixed, node, n + 1, per_sequence, per_vertex, &error);
    g_assert_no_error(error);
    g_free(node);
    return r;
}

static uint32_t find_joint(const Rig *r, const char *name)
{
    for (uint32_t j = 0; j < r->n_joints; j++)
        if (strcmp(r->joint[j].name, name) == 0)
            return j;
    g_error("no joint '%s'", name);
}

static void assert_joint(const Rig *r, const char *name, const char *parent, double x, double y)
{
    const Joint *j = &r->joint[find_joint(r, name)];
    g_assert_cmpfloat(j->place.x, ==, x);
    g_assert_cmpfloat(j->place.y, ==, y);
    g_assert_cmpfloat(j->place.z, ==, 0.0);
    g_assert_cmpuint(j->parent, ==, parent != NULL ? find_joint(r, parent) : NO_PARENT);
}

static void test_joints(void)
{
    Leaf l;
    leaf_full(&l);
    Rig *r = leaf_rig(&l, 0, 4);
    g_assert_cmpuint(r->n_joints, ==, 5 + 3 + 2 + 2 + 2); /* ends and forks alone */
    assert_joint(r, "midrib_0", NULL, 0, 0);
    assert_joint(r, "midrib_1", "midrib_0", 0, 4);
    assert_joint(r, "midrib_2", "midrib_1", 0, 5);
    assert_joint(r, "midrib_3", "midrib_2", 0, 10);
    assert_joint(r, "midrib_4", "midrib_3", 0, 14);
    assert_joint(r, "R1_0", "midrib_1", 0, 4);
    assert_joint(r, "R1_1", "R1_0", 3, 4);
    assert_joint(r, "R1_2", "R1_1", 5, 4);
    assert_joint(r, "L1_0", "midrib_2", 0, 5);
    assert_joint(r, "L1_1", "L1_0", -4, 5);
    assert_joint(r, "R1.R1_0", "R1_1", 3, 4);
    assert_joint(r, "R1.R1_1", "R1.R1_0", 3, 8);
    rig_free(r);
    /* Lengths 14, 5, 4, 3, 4: median 4, so joints are at most 2 apart, and closer where a vein is shorter. */
    r = leaf_rig(&l, 1, 4);
    assert_joint(r, "midrib_1", "midrib_0", 0, 2);
    assert_joint(r, "midrib_2", "midrib_1", 0, 4);
    assert_joint(r, "midrib_3", "midrib_2", 0, 5);
    assert_joint(r, "midrib_6", "midrib_5", 0, 10);
    assert_joint(r, "midrib_7", "midrib_6", 0, 12);
    assert_joint(r, "midrib_8", "midrib_7", 0, 14);
    assert_joint(r, "L1_1", "L1_0", -2, 5);
    assert_joint(r, "L1_2", "L1_1", -4, 5);
    assert_joint(r, "L2_2", "L2_1", -3, 10);
    for (uint32_t j = 0; j < r->n_joints; j++)
        g_assert_true(r->joint[j].parent == NO_PARENT || r->joint[j].parent < j);
    rig_free(r);
    leaf_clear(&l);
}

/* More joints than nodes can't be: each node has one at most in its sequence. */
static void test_many_per_sequence(void)
{
    Leaf l;
    leaf_full(&l);
    Rig *r = leaf_rig(&l, 1000, 8);
    g_assert_cmpuint(r->n_joints, ==, l.skeleton.n_at);
    rig_free(r);
    leaf_clear(&l);
}

static void test_too_many(void)
{
    enum { N = RIG_MAX_JOINTS + 2 };
    Skeleton s = {.n_nodes = N, .n_at = N, .n_sequences = 1, .rest = g_new(Vec2, N), .at = g_new(uint32_t, N), .sequence = g_new0(Sequence, 1)};
    for (uint32_t i = 0; i < N; i++) {
        s.rest[i] = vec2(0.0, i);
        s.at[i] = i;
    }
    s.sequence[0] = (Sequence){.parent = NO_PARENT, .n = N, .order = 1, .length = N - 1, .name = "midrib"};
    Mesh mesh = {0};
    GError *error = NULL;
    g_assert_null(rig_new(&s, &mesh, NULL, NULL, 0, NULL, 0, N, 4, &error));
    g_assert_error(error, RIG_ERROR, RIG_ERROR_JOINTS);
    g_assert_nonnull(strstr(error->message, "65537"));
    g_error_free(error);
    g_free(s.rest);
    g_free(s.at);
    g_free(s.sequence);
}

/* Two primaries from one base: the second hangs on the first. */
static void test_palmate(void)
{
    Leaf l;
    leaf_begin(&l);
    add_sequence(&l, "midrib", NO_PARENT, 1, 6, 0, 0, 1, 10);
    add_sequence(&l, "P2", NO_PARENT, 1, 6, 0, 1, 0, 5);
    add_sequence(&l, "P3", NO_PARENT, 1, 2, 3, 0, 1, 5);
    leaf_end(&l);
    Rig *r = leaf_rig(&l, 0, 4);
    assert_joint(r, "midrib_0", NULL, 0, 0);
    assert_joint(r, "P2_0", "midrib_0", 0, 0);
    assert_joint(r, "P3_0", NULL, -4, 3);
    rig_free(r);
    leaf_clear(&l);
}

/* Part of joint j at a node, from the joints' names and places alone: along the sequence that owns the node the hat falls from 1 to 0 between
 * neighbouring joints. */
static double plain_hat(const Leaf *l, const Rig *r, uint32_t joint, uint32_t node)
{
    const Skeleton *s = &l->skeleton;
    uint32_t q = 0, i = 0;
    for (bool found = false; !found; q++)
        for (i = 0; i < s->sequence[q].n && !found; i++)
            found = s->at[s->sequence[q].first + i] == node;
    q--;
    i--;
    char prefix[32];
    g_snprintf(prefix, sizeof prefix, "%s_", s->sequence[q].name);
    if (!g_str_has_prefix(r->joint[joint].name, prefix))
        return 0.0;
    double here = i, mine = -1.0, below = -1.0, above = 1e9; /* edges are 1 long, so arc length is the index */
    for (uint32_t k = 0; k < s->sequence[q].n; k++)
        for (uint32_t j = 0; j < r->n_joints; j++)
            if (g_str_has_prefix(r->joint[j].name, prefix) && r->joint[j].node == s->at[s->sequence[q].first + k]) {
                if (j == joint)
                    mine = k;
                else if (j < joint)
                    below = MAX(below, (double)k);
                else
                    above = MIN(above, (double)k);
            }
    if (here == mine)
        return 1.0;
    return here < mine ? MAX(0.0, (here - below) / (mine - below)) : MAX(0.0, (above - here) / (above - mine));
}

/* All weights of all joints in double: value[joint][vertex]. */
static double *plain_weights(const Leaf *l, const Rig *r)
{
    uint32_t n = l->mesh.n_vertices;
    double *all = g_new(double, (gsize)n * r->n_joints), *fixed = g_new(double, l->n_fixed);
    for (uint32_t j = 0; j < r->n_joints; j++) {
        for (uint32_t i = 0; i < l->n_fixed; i++)
            fixed[i] = plain_hat(l, r, j, l->fixed_node[i]);
        membrane_harmonic(l->membrane, fixed, all + (gsize)j * n);
    }
    g_free(fixed);
    return all;
}

static double weight_of(const Rig *r, uint32_t vertex, uint32_t joint)
{
    double sum = 0.0;
    for (uint32_t k = 0; k < r->per_vertex; k++)
        if (r->blade_joint[vertex * r->per_vertex + k] == joint)
            sum += (double)r->blade_weight[vertex * r->per_vertex + k];
    return sum;
}

/* Before anything is cut off the weights are a partition of unity; the kept ones are the largest, and what is reported lost is lost. */
static void check_weights(uint32_t per_sequence, uint32_t per_vertex)
{
    Leaf l;
    leaf_full(&l);
    Rig *r = leaf_rig(&l, per_sequence, per_vertex);
    double *all = plain_weights(&l, r), worst = 0.0, mean = 0.0;
    uint32_t n = l.mesh.n_vertices, order[64];
    g_assert_cmpuint(r->n_joints, <=, 64);
    for (uint32_t v = 0; v < n; v++) {
        double unity = 0.0, kept = 0.0;
        for (uint32_t j = 0; j < r->n_joints; j++) {
            double w = all[(gsize)j * n + v];
            g_assert_cmpfloat(w, >=, -1e-12);
            unity += w;
            uint32_t k = j;
            for (; k > 0 && w > all[(gsize)order[k - 1] * n + v]; k--)
                order[k] = order[k - 1];
            order[k] = j;
        }
        g_assert_cmpfloat_with_epsilon(unity, 1.0, 1e-10);
        for (uint32_t k = 0; k < MIN(per_vertex, r->n_joints); k++)
            kept += all[(gsize)order[k] * n + v] >= 1e-6 ? all[(gsize)order[k] * n + v] : 0.0;
        for (uint32_t k = 0; k < MIN(per_vertex, r->n_joints); k++)
            if (all[(gsize)order[k] * n + v] >= 1e-5 &&
                (k + 1 >= r->n_joints || all[(gsize)order[k] * n + v] > all[(gsize)order[MIN(per_vertex, r->n_joints - 1)] * n + v] + 1e-12))
                g_assert_cmpfloat_with_epsilon(weight_of(r, v, order[k]), all[(gsize)order[k] * n + v] / kept, 1e-6);
        worst = MAX(worst, unity - kept);
        mean += (unity - kept) / n;
    }
    g_assert_cmpfloat_with_epsilon(r->worst_loss, worst, 1e-9);
    g_assert_cmpfloat_with_epsilon(r->mean_loss, mean, 1e-9);
    g_test_message("%u joints, %u a vertex: worst loss %.4f, mean %.4f", r->n_joints, per_vertex, r->worst_loss, r->mean_loss);
    g_assert_true(per_vertex == 8 || r->worst_loss > 0.001);
    g_free(all);
    rig_free(r);
    leaf_clear(&l);
}

static void test_weights(void)
{
    check_weights(0, 4);
    check_weights(0, 8);
    check_weights(1, 4);
    check_weights(2, 8);
}

/* What the header promises of every row of weights. */
static void check_rows(const uint16_t *joint, const float *weight, uint32_t n, const Rig *r)
{
    for (uint32_t v = 0; v < n; v++) {
        double sum = 0.0;
        for (uint32_t k = 0; k < r->per_vertex; k++) {
            gsize at = (gsize)v * r->per_vertex + k;
            sum += (double)weight[at];
            g_assert_cmpuint(joint[at], <, r->n_joints);
            g_assert_cmpfloat((double)weight[at], >=, 0.0);
            if (k > 0)
                g_assert_cmpfloat((double)weight[at], <=, (double)weight[at - 1]);
            if (weight[at] <= 0.0f)
                g_assert_cmpuint(joint[at], ==, 0);
            for (uint32_t i = 0; i < k; i++)
                g_assert_true(weight[at] <= 0.0f || joint[at] != joint[at - k + i]);
        }
        g_assert_cmpfloat_with_epsilon(sum, 1.0, 1.2e-7);
    }
}

/* Moves each joint by its own rotation about its place, on top of its parent's. */
typedef struct {
    Mat3 turn;
    Vec3 shift;
} Motion;

static Motion *motions(const Rig *r, const Mat3 *local)
{
    Motion *m = g_new(Motion, r->n_joints);
    for (uint32_t j = 0; j < r->n_joints; j++) {
        uint32_t p = r->joint[j].parent;
        Motion up = p != NO_PARENT ? m[p] : (Motion){mat3_identity(), vec3(0, 0, 0)};
        Vec3 at = r->joint[j].place;
        m[j].turn = mat3_mul(up.turn, local[j]);
        /* x -> up(at + local (x - at)) */
        m[j].shift = vec3_add(up.shift, vec3_sub(mat3_apply(up.turn, at), mat3_apply(m[j].turn, at)));
    }
    return m;
}

static Vec3 skin(const Motion *m, const uint16_t *joint, const float *weight, uint32_t per_vertex, Vec3 p)
{
    Vec3 sum = vec3(0, 0, 0);
    for (uint32_t k = 0; k < per_vertex; k++)
        sum = vec3_add(sum, vec3_scale(vec3_add(mat3_apply(m[joint[k]].turn, p), m[joint[k]].shift), (double)weight[k]));
    return sum;
}

static Mat3 *still(const Rig *r)
{
    Mat3 *local = g_new(Mat3, r->n_joints);
    for (uint32_t j = 0; j < r->n_joints; j++)
        local[j] = mat3_identity();
    return local;
}

static void test_rest(void)
{
    const uint32_t per_vertex[] = {4, 8};
    for (int k = 0; k < 2; k++) {
        Leaf l;
        leaf_full(&l);
        Rig *r = leaf_rig(&l, 1, per_vertex[k]);
        check_rows(r->blade_joint, r->blade_weight, r->n_blade, r);
        check_rows(r->vein_joint, r->vein_weight, r->n_veins, r);
        Mat3 *local = still(r);
        Motion *m = motions(r, local);
        for (uint32_t v = 0; v < r->n_blade; v++) {
            Vec3 p = vec3_flat(l.mesh.vertex[v]);
            gsize at = (gsize)v * r->per_vertex;
            g_assert_cmpfloat(vec3_dist(skin(m, r->blade_joint + at, r->blade_weight + at, r->per_vertex, p), p), <, 2e-6);
        }
        g_free(m);
        /* a leaf turned as a whole stays rigid */
        local[0] = (Mat3){{0.6, 0.0, 0.8}, {0.0, 1.0, 0.0}, {-0.8, 0.0, 0.6}};
        m = motions(r, local);
        for (uint32_t v = 0; v < r->n_blade; v++) {
            Vec3 p = vec3_flat(l.mesh.vertex[v]);
            gsize at = (gsize)v * r->per_vertex;
            g_assert_cmpfloat(vec3_dist(skin(m, r->blade_joint + at, r->blade_weight + at, r->per_vertex, p), mat3_apply(local[0], p)), <, 2e-6);
        }
        g_free(m);
        g_free(local);
        rig_free(r);
        leaf_clear(&l);
    }
}

/* Where each node goes, by the weights of its vein vertex. */
static Vec3 *moved_nodes(const Leaf *l, const Rig *r, const Mat3 *local)
{
    Motion *m = motions(r, local);
    Vec3 *place = g_new(Vec3, l->skeleton.n_nodes);
    for (uint32_t i = 0; i < l->skeleton.n_nodes; i++) {
        gsize at = (gsize)i * r->per_vertex;
        place[i] = skin(m, r->vein_joint + at, r->vein_weight + at, r->per_vertex, vec3_flat(l->skeleton.rest[i]));
    }
    g_free(m);
    return place;
}

/* A lateral's first joint turns the lateral and what grows on it about its base, and nothing else; the midrib's joint in the same place takes
 * the midrib beyond along. No vein comes off another: edges keep their length, or, where two joints share them, nearly so. */
static void test_bends(void)
{
    Leaf l;
    leaf_full(&l);
    Rig *r = leaf_rig(&l, 1, 4);
    Mat3 up = {{0.96, 0.0, 0.28}, {0.0, 1.0, 0.0}, {-0.28, 0.0, 0.96}}; /* about y */
    Mat3 *local = still(r);
    local[find_joint(r, "R1_0")] = up;
    Vec3 *place = moved_nodes(&l, r, local);
    const Skeleton *s = &l.skeleton;
    for (uint32_t i = 0; i < s->n_nodes; i++) {
        Vec3 rest = vec3_flat(s->rest[i]);
        bool turns = s->rest[i].x > 0.0;
        g_assert_cmpfloat(vec3_dist(place[i], turns ? mat3_apply(up, rest) : rest), <, 1e-6);
    }
    g_free(place);
    g_free(local);
    local = still(r);
    local[find_joint(r, "midrib_3")] = (Mat3){{1, 0, 0}, {0, 0.96, 0.28}, {0, -0.28, 0.96}}; /* about x, at y = 5 */
    place = moved_nodes(&l, r, local);
    for (uint32_t i = 0; i < s->n_nodes; i++) {
        if (s->hinge[i] == NO_PARENT)
            continue;
        double edge = vec3_dist(place[i], place[s->hinge[i]]);
        g_assert_cmpfloat(edge, >, 0.9);
        g_assert_cmpfloat(edge, <, 1.0 + 1e-6);
        if (s->rest[i].x > 0.0)
            g_assert_cmpfloat(vec3_dist(place[i], vec3_flat(s->rest[i])), <, 1e-6);
        if (s->rest[i].y > 7.0 && s->rest[i].x <= 0.0)
            g_assert_cmpfloat(place[i].z, >, 0.5);
    }
    g_free(place);
    g_free(local);
    rig_free(r);
    leaf_clear(&l);
}

/* On the veins blade and solids have the same weights, so they don't part. */
static void test_veins_go_with_blade(void)
{
    Leaf l;
    leaf_full(&l);
    Rig *r = leaf_rig(&l, 2, 8);
    for (uint32_t i = 0; i < l.skeleton.n_nodes; i++) {
        gsize vein = (gsize)i * r->per_vertex, blade = (gsize)l.skeleton.vertex[i] * r->per_vertex;
        for (uint32_t k = 0; k < r->per_vertex; k++) {
            g_assert_cmpuint(r->vein_joint[vein + k], ==, r->blade_joint[blade + k]);
            g_assert_cmpfloat((double)r->vein_weight[vein + k], ==, (double)r->blade_weight[blade + k]);
        }
    }
    gsize petiole = (gsize)l.skeleton.n_nodes * r->per_vertex;
    g_assert_cmpuint(r->vein_joint[petiole], ==, 0);
    g_assert_cmpfloat((double)r->vein_weight[petiole], ==, 1.0);
    rig_free(r);
    leaf_clear(&l);
}

static void test_same_twice(void)
{
    Leaf a, b;
    leaf_full(&a);
    leaf_full(&b);
    Rig *r = leaf_rig(&a, 1, 4), *q = leaf_rig(&b, 1, 4);
    g_assert_cmpuint(r->n_joints, ==, q->n_joints);
    gsize cells = (gsize)r->n_blade * r->per_vertex;
    g_assert_cmpint(memcmp(r->joint, q->joint, r->n_joints * sizeof *r->joint), ==, 0);
    g_assert_cmpint(memcmp(r->blade_joint, q->blade_joint, cells * sizeof *r->blade_joint), ==, 0);
    g_assert_cmpint(memcmp(r->blade_weight, q->blade_weight, cells * sizeof *r->blade_weight), ==, 0);
    rig_free(r);
    rig_free(q);
    rig_free(NULL);
    leaf_clear(&a);
    leaf_clear(&b);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/rig/joints", test_joints);
    g_test_add_func("/rig/many-per-sequence", test_many_per_sequence);
    g_test_add_func("/rig/too-many", test_too_many);
    g_test_add_func("/rig/palmate", test_palmate);
    g_test_add_func("/rig/weights", test_weights);
    g_test_add_func("/rig/rest", test_rest);
    g_test_add_func("/rig/bends", test_bends);
    g_test_add_func("/rig/veins-go-with-blade", test_veins_go_with_blade);
    g_test_add_func("/rig/same-twice", test_same_twice);
    return g_test_run();
}
