/* Posing against hand-computed places, one hinge at a time, circles, and its invariants. */
#include <glib.h>
#include <math.h>
#include <string.h>

#include "geom/random.h"
#include "hand_skeleton.h"
#include "shape/pose.h"

static double uniform(uint64_t i, double low, double high)
{
    double u[2];
    random_pair(7, 2002, 0, i, u);
    return low + u[0] * (high - low);
}

static void near(double got, double want, double tolerance)
{
    if (!(fabs(got - want) <= tolerance))
        g_error("%.17g instead of %.17g: off by %g", got, want, fabs(got - want));
}

static void near3(Vec3 got, Vec3 want, double tolerance)
{
    if (!(vec3_dist(got, want) <= tolerance))
        g_error("(%.17g, %.17g, %.17g) instead of (%.17g, %.17g, %.17g): off by %g", got.x, got.y, got.z, want.x, want.y, want.z,
                vec3_dist(got, want));
}

static Skeleton *leaf(int which, uint32_t cut) { return which == 0 ? hand_pinnate(9, cut) : which == 1 ? hand_palmate(cut) : hand_parallel(cut); }

static uint32_t find(const Skeleton *s, const char *name)
{
    for (uint32_t q = 0; q < s->n_sequences; q++)
        if (strcmp(s->sequence[q].name, name) == 0)
            return q;
    g_error("no vein %s", name);
}

static uint32_t node_of(const Skeleton *s, const char *name, uint32_t k)
{
    const Sequence *q = &s->sequence[find(s, name)];
    return s->at[q->first + (k < q->n ? k : q->n - 1)];
}

static uint32_t tip_of(const Skeleton *s, const char *name) { return node_of(s, name, UINT32_MAX); }

static bool descends(const Skeleton *s, uint32_t i, uint32_t from)
{
    while (i != from && s->hinge[i] != NO_PARENT)
        i = s->hinge[i];
    return i == from;
}

/* Veins don't twist: against its hinge an edge of a straight vein goes round an axis across it. */
static void check_untwisted(const Pose *p, uint32_t q, double tolerance)
{
    const Skeleton *s = p->skeleton;
    const uint32_t *node = s->at + s->sequence[q].first;
    for (uint32_t k = 2; k < s->sequence[q].n; k++) {
        Mat3 b = mat3_mul(mat3_transpose(p->turn[node[k - 1]]), p->turn[node[k]]);
        Vec3 axis = vec3(b.y.z - b.z.y, b.z.x - b.x.z, b.x.y - b.y.x), edge = vec3_flat(vec_sub(s->rest[node[k]], s->rest[node[k - 1]]));
        near(vec3_dot(axis, vec3_unit(edge, edge)), 0.0, tolerance);
    }
}

/* Lengths kept, turns orthonormal, place and turn in agreement, roots where they were. */
static void check_pose(const Pose *p)
{
    const Skeleton *s = p->skeleton;
    for (uint32_t i = 0; i < s->n_nodes; i++) {
        Mat3 t = p->turn[i], unit = mat3_mul(mat3_transpose(t), t), one = mat3_identity();
        near3(unit.x, one.x, 1e-13);
        near3(unit.y, one.y, 1e-13);
        near3(unit.z, one.z, 1e-13);
        near(vec3_dot(vec3_cross(t.x, t.y), t.z), 1.0, 1e-13);
        uint32_t hinge = s->hinge[i];
        if (hinge == NO_PARENT) {
            near3(p->place[i], vec3_flat(s->rest[i]), 0.0);
            continue;
        }
        near(vec3_dist(p->place[i], p->place[hinge]), vec_dist(s->rest[i], s->rest[hinge]), 1e-12);
        Vec3 edge = mat3_apply(t, vec3_flat(vec_sub(s->rest[i], s->rest[hinge])));
        near3(p->place[i], vec3_add(p->place[hinge], edge), 1e-12);
    }
}

static bool is_flat(const Pose *p)
{
    for (uint32_t i = 0; i < p->skeleton->n_nodes; i++) {
        Vec3 a = p->place[i];
        if (a.x != p->skeleton->rest[i].x || a.y != p->skeleton->rest[i].y || a.z != 0.0)
            return false;
    }
    return true;
}

static double farthest(const Pose *a, const Pose *b)
{
    double worst = 0.0;
    for (uint32_t i = 0; i < a->skeleton->n_nodes; i++)
        worst = MAX(worst, vec3_dist(a->place[i], b->place[i]));
    return worst;
}

static Pose *posed(const Skeleton *s, PoseDef def)
{
    GError *error = NULL;
    Pose *p = pose_new(s);
    g_assert_true(pose_apply(p, &def, &error));
    g_assert_no_error(error);
    return p;
}

static Pose *ruled(const Skeleton *s, const char *rules)
{
    PoseDef def = pose_def_default();
    def.rules = rules;
    return posed(s, def);
}

/* --- rotations --- */

static void test_rotation(void)
{
    Mat3 x = pose_rotation(vec3(3, 0, 0), DTRIG_PI / 2), y = pose_rotation(vec3(0, 0.1, 0), DTRIG_PI / 2),
         z = pose_rotation(vec3(0, 0, 7), DTRIG_PI / 2);
    near3(mat3_apply(x, vec3(1, 2, 3)), vec3(1, -3, 2), 1e-15);
    near3(mat3_apply(y, vec3(1, 2, 3)), vec3(3, 2, -1), 1e-15);
    near3(mat3_apply(z, vec3(1, 2, 3)), vec3(-2, 1, 3), 1e-15);
    for (uint64_t i = 0; i < 2000; i++) { /* Rodrigues' formula, vector by vector */
        Vec3 k = vec3(uniform(8 * i, -1, 1), uniform(8 * i + 1, -1, 1), uniform(8 * i + 2, -1, 1));
        Vec3 v = vec3(uniform(8 * i + 3, -1, 1), uniform(8 * i + 4, -1, 1), uniform(8 * i + 5, -1, 1)), u = vec3_unit(k, k);
        double a = uniform(8 * i + 6, -10, 10);
        Vec3 want = vec3_add(vec3_add(vec3_scale(v, cos(a)), vec3_scale(vec3_cross(u, v), sin(a))), vec3_scale(u, vec3_dot(u, v) * (1 - cos(a))));
        near3(mat3_apply(pose_rotation(k, a), v), want, 1e-14);
    }
    Mat3 none = pose_rotation(vec3(0, 0, 0), 1.0), still = pose_rotation(vec3(1, 2, 3), 0.0), one = mat3_identity();
    for (int k = 0; k < 3; k++) {
        const Vec3 *a = &none.x + k, *b = &still.x + k, *c = &one.x + k;
        g_assert_true(a->x == c->x && a->y == c->y && a->z == c->z && b->x == c->x && b->y == c->y && b->z == c->z);
    }
}

/* In the three coordinate planes (the windows of § 7.1). The midrib is cut at every 100/22; L3 leaves its node 5. */
static void test_rotate_planes(void)
{
    Skeleton *s = hand_pinnate(9, 1);
    const double a = 0.4, step = 100.0 / 22;
    const struct {
        Vec3 axis, tip;
    } plane[] = {
        {{1, 0, 0}, {0, 5 * step + 17 * step * cos(a), 17 * step * sin(a)}}, /* side view: Y-Z */
        {{0, 0, 1}, {-17 * step * sin(a), 5 * step + 17 * step * cos(a), 0}}, /* front view: X-Y */
        {{0, 1, 0}, {0, 100, 0}},                                           /* bottom view: Z-X: the midrib only spins */
    };
    for (int k = 0; k < 3; k++) {
        Pose *p = pose_new(s);
        pose_rotate(p, node_of(s, "midrib", 6), plane[k].axis, a);
        check_pose(p);
        near3(p->place[tip_of(s, "midrib")], plane[k].tip, 1e-12);
        near3(p->place[tip_of(s, "L3")], vec3_flat(s->rest[tip_of(s, "L3")]), 0.0); /* leaves the hinge: stays */
        Vec2 l4 = s->rest[tip_of(s, "L4")];
        Vec3 moved = k == 0   ? vec3(l4.x, 5 * step + (l4.y - 5 * step) * cos(a), (l4.y - 5 * step) * sin(a))
                     : k == 1 ? vec3(l4.x * cos(a) - (l4.y - 5 * step) * sin(a), 5 * step + l4.x * sin(a) + (l4.y - 5 * step) * cos(a), 0)
                              : vec3(l4.x * cos(a), l4.y, -l4.x * sin(a));
        near3(p->place[tip_of(s, "L4")], moved, 1e-12);
        pose_free(p);
    }
    /* A branch leaves the target itself: it goes along. */
    Pose *p = pose_new(s);
    pose_rotate(p, node_of(s, "midrib", 5), vec3(1, 0, 0), a);
    g_assert_cmpfloat(p->place[tip_of(s, "L3")].z, >, 1.0);
    g_assert_cmpfloat(p->place[tip_of(s, "L2")].z, ==, 0.0);
    pose_free(p);
    p = pose_new(s); /* the first edge of a vein: the vein and its twigs, nothing else */
    pose_rotate(p, node_of(s, "R1", 1), vec3(0, 1, 0), a);
    for (uint32_t i = 0; i < s->n_nodes; i++)
        g_assert_cmpint(p->place[i].z != 0.0, ==, descends(s, i, node_of(s, "R1", 1)));
    pose_free(p);
    p = pose_new(s); /* a root: everything, about it */
    pose_rotate(p, 0, vec3(1, 0, 0), a);
    near3(p->place[tip_of(s, "midrib")], vec3(0, 100 * cos(a), 100 * sin(a)), 1e-12);
    pose_free(p);
    hand_free(s);
}

static void random_rotation(const Skeleton *s, uint64_t i, uint32_t *node, Vec3 *axis, double *angle)
{
    RandomBlock b = random_block(7, 2003, 0, i);
    do
        *node = b.w[0]++ % s->n_nodes;
    while (s->hinge[*node] == NO_PARENT);
    *axis = vec3(uniform(4 * i, -1, 1), uniform(4 * i + 1, -1, 1), uniform(4 * i + 2, -1, 1));
    *angle = uniform(4 * i + 3, -3, 3);
}

/* What descends moves as one body, what doesn't stays to the last bit. */
static void test_rigid(void)
{
    for (int which = 0; which < 3; which++) {
        Skeleton *s = leaf(which, 1);
        Pose *p = pose_new(s);
        for (uint64_t i = 0; i < 150; i++) {
            uint32_t node;
            Vec3 axis;
            double angle;
            random_rotation(s, i, &node, &axis, &angle);
            Pose *before = pose_copy(p);
            pose_rotate(p, node, axis, angle);
            for (uint32_t a = 0; a < s->n_nodes; a++) {
                bool along = descends(s, a, node);
                if (!along) {
                    g_assert_true(memcmp(&p->place[a], &before->place[a], sizeof(Vec3)) == 0);
                    continue;
                }
                near(vec3_dist(p->place[a], p->place[s->hinge[node]]), vec3_dist(before->place[a], before->place[s->hinge[node]]), 1e-12);
                near(vec3_dist(p->place[a], p->place[node]), vec3_dist(before->place[a], before->place[node]), 1e-12);
                for (uint32_t b = node; b < a; b += 7)
                    if (descends(s, b, node))
                        near(vec3_dist(p->place[a], p->place[b]), vec3_dist(before->place[a], before->place[b]), 1e-12);
            }
            pose_free(before);
        }
        check_pose(p);
        pose_free(p);
        hand_free(s);
    }
}

static void test_inverse(void)
{
    Skeleton *s = hand_pinnate(9, 2);
    Pose *p = pose_new(s), *flat = pose_new(s);
    uint32_t node;
    Vec3 axis;
    double angle;
    for (uint64_t i = 0; i < 60; i++) {
        random_rotation(s, i, &node, &axis, &angle);
        pose_rotate(p, node, axis, angle);
    }
    g_assert_cmpfloat(farthest(p, flat), >, 10.0);
    for (uint64_t i = 60; i-- > 0;) {
        random_rotation(s, i, &node, &axis, &angle);
        pose_rotate(p, node, axis, -angle);
    }
    g_assert_cmpfloat(farthest(p, flat), <, 1e-12 * 100);
    for (uint64_t i = 0; i < 20000; i++) { /* rounding doesn't pile up in lengths and turns */
        random_rotation(s, i % 5000, &node, &axis, &angle);
        pose_rotate(p, node, axis, angle);
    }
    check_pose(p);
    pose_free(p);
    pose_free(flat);
    pose_free(NULL);
    hand_free(s);
}

static void test_many(void)
{
    Hand h = hand_start(1);
    const Vec2 line[3] = {{0, 0}, {0, 1}, {0, 2}};
    hand_vein(&h, NO_PARENT, 0, NO_PARENT, 1, "midrib", line, 3, 1, 1);
    Skeleton *s = hand_finish(&h, NULL, 0);
    Pose *p = pose_new(s);
    for (uint64_t i = 0; i < 300000; i++)
        pose_rotate(p, 1, vec3(uniform(i, -1, 1), uniform(i + 1, -1, 1), uniform(i + 2, -1, 1)), 0.3);
    Mat3 t = p->turn[2], unit = mat3_mul(mat3_transpose(t), t), one = mat3_identity();
    near3(unit.x, one.x, 2e-15);
    near3(unit.y, one.y, 2e-15);
    near3(unit.z, one.z, 2e-15);
    pose_free(p);
    hand_free(s);
}

/* --- ready-made poses --- */

/* The same pose made by one hinge rotation after the other, tips first: tests the single pass. */
static void test_by_hinges(void)
{
    for (int which = 0; which < 3; which++) {
        Skeleton *s = leaf(which, 2);
        PoseDef def = pose_def_default();
        def.kind = POSE_WITHERED;
        def.variation = 1.0;
        def.rules = "all turn 3; order 2 fold -5";
        if (which == 2)
            def.rules = "all turn 3";
        Pose *once = posed(s, def), *slow = pose_new(s);
        for (uint32_t i = s->n_nodes; i-- > 0;) {
            if (s->hinge[i] == NO_PARENT)
                continue;
            /* What the hinge does beyond what its own hinge did, in the flat frame, for everything beyond is still flat. */
            Mat3 b = mat3_mul(mat3_transpose(once->turn[s->hinge[i]]), once->turn[i]);
            Vec3 axis = vec3(b.y.z - b.z.y, b.z.x - b.x.z, b.x.y - b.y.x);
            pose_rotate(slow, i, axis, atan2(vec3_norm(axis), b.x.x + b.y.y + b.z.z - 1.0));
        }
        g_assert_cmpfloat(farthest(once, slow), <, 1e-9);
        check_pose(once);
        pose_free(once);
        pose_free(slow);
        hand_free(s);
    }
}

static const PoseKind kinds[] = {POSE_FLAT, POSE_CUPPED, POSE_FOLDED, POSE_DROOPING, POSE_CURLED_TIP, POSE_WAVY, POSE_WITHERED};

static void test_invariants(void)
{
    for (int which = 0; which < 3; which++) {
        Skeleton *s = leaf(which, 2);
        for (guint k = 0; k < G_N_ELEMENTS(kinds); k++) {
            PoseDef def = pose_def_default();
            def.kind = kinds[k];
            def.variation = 1.0;
            def.strength = 1.3;
            def.age = 1.0;
            Pose *p = posed(s, def), *again = posed(s, def);
            check_pose(p);
            g_assert_true(memcmp(p->place, again->place, s->n_nodes * sizeof(Vec3)) == 0);
            g_assert_cmpint(is_flat(p), ==, def.kind == POSE_FLAT);
            def.seed++;
            Pose *other = posed(s, def);
            g_assert_cmpint(farthest(p, other) > 0.05, ==, def.kind != POSE_FLAT);
            def.strength = 0.0;
            Pose *none = posed(s, def);
            g_assert_true(is_flat(none));
            pose_free(p);
            pose_free(again);
            pose_free(other);
            pose_free(none);
        }
        hand_free(s);
    }
}

static void test_untwisted(void)
{
    Skeleton *s = leaf(1, 16);
    for (guint k = 1; k < G_N_ELEMENTS(kinds); k++) {
        PoseDef def = pose_def_default();
        def.kind = kinds[k];
        def.age = 1.0;
        for (int uneven = 0; uneven < 2; uneven++) {
            def.variation = uneven;
            Pose *p = posed(s, def);
            /* Two bends about different axes across an edge make a very little turn about it, less by four when edges are halved. */
            check_untwisted(p, 0, uneven ? 1e-4 : 1e-13);
            check_untwisted(p, 1, uneven ? 1e-4 : 1e-13);
            pose_free(p);
        }
    }
    hand_free(s);
}

/* Blend 0 is flat to the last bit, rules or not; and small steps of it move the leaf little. */
static void test_blend(void)
{
    const char *rules[3] = {"midrib lift 40; all turn 5; order 2 fold 9; L2 rotate 1,2,3 50 at 0.5; midrib spline 0.5,0,0.4,0.2 1,0.1,0.7,-0.2", NULL,
                            "P2 rotate x 90; P3 spline 1,0.4,0.6,0.3"};
    for (int which = 0; which < 3; which++) {
        Skeleton *s = leaf(which, 2);
        for (uint32_t i = 0; i < s->n_nodes; i++) /* places whose differences round */
            s->rest[i] = vec2(1.1 * s->rest[i].x + 0.037, 1.07 * s->rest[i].y + 0.0013);
        for (guint k = 1; k < G_N_ELEMENTS(kinds); k++) {
            PoseDef def = pose_def_default();
            def.kind = kinds[k];
            def.variation = 0.7;
            def.rules = rules[which];
            def.blend = 0.0;
            Pose *last = posed(s, def);
            g_assert_true(is_flat(last));
            double longest = 0.0;
            enum { STEPS = 400 };
            for (int i = 1; i <= STEPS; i++) {
                def.blend = (double)i / STEPS;
                Pose *next = posed(s, def);
                longest = MAX(longest, farthest(last, next));
                pose_free(last);
                last = next;
            }
            g_assert_cmpfloat(longest, <, 2.0); /* of 100 segments */
            pose_free(last);
        }
        hand_free(s);
    }
}

/* The finer the veins are cut, the nearer the poses come to each other; by four for each halving. */
static void test_convergence(void)
{
    for (int which = 0; which < 3; which++) {
        Skeleton *finest = leaf(which, 16);
        for (guint k = 1; k < G_N_ELEMENTS(kinds); k++) {
            PoseDef def = pose_def_default();
            def.kind = kinds[k];
            def.variation = 0.6;
            def.age = 1.0;
            Pose *truth = posed(finest, def);
            double off[3];
            for (int level = 0; level < 3; level++) {
                uint32_t cut = 1u << level;
                Skeleton *s = leaf(which, cut);
                Pose *p = posed(s, def);
                off[level] = hand_difference(s, p->place, finest, truth->place, 16 / cut);
                pose_free(p);
                hand_free(s);
            }
            g_test_message("leaf %d pose %u: %.3f %.3f %.3f segments", which, k, off[0], off[1], off[2]);
            g_assert_cmpfloat(off[2], <, 0.6);
            g_assert_true(off[2] < 0.35 * off[1] || off[2] < 1e-9);
            pose_free(truth);
        }
        hand_free(finest);
    }
}

/* Mirror images for a symmetric leaf without variation; not with it. */
static void test_symmetry(void)
{
    for (int which = 0; which < 3; which++) {
        Skeleton *s = leaf(which, 2);
        uint32_t *twin = g_new(uint32_t, s->n_nodes);
        for (uint32_t i = 0; i < s->n_nodes; i++) {
            twin[i] = NO_PARENT;
            for (uint32_t j = 0; j < s->n_nodes; j++)
                if (fabs(s->rest[i].x + s->rest[j].x) < 1e-9 && fabs(s->rest[i].y - s->rest[j].y) < 1e-9)
                    twin[i] = j;
            g_assert_cmpuint(twin[i], !=, NO_PARENT);
        }
        for (guint k = 1; k < G_N_ELEMENTS(kinds); k++)
            for (int uneven = 0; uneven < 2; uneven++) {
                PoseDef def = pose_def_default();
                def.kind = kinds[k];
                def.variation = uneven ? 0.5 : 0.0;
                Pose *p = posed(s, def);
                double worst = 0.0;
                for (uint32_t i = 0; i < s->n_nodes; i++) {
                    Vec3 t = p->place[twin[i]];
                    worst = MAX(worst, vec3_dist(p->place[i], vec3(-t.x, t.y, t.z)));
                }
                g_assert_true(uneven ? worst > 0.1 : worst < 1e-9);
                pose_free(p);
            }
        g_free(twin);
        hand_free(s);
    }
}

/* What each pose is called for. */
static void test_meaning(void)
{
    PoseDef def = pose_def_default();
    def.variation = 0.0;
    for (int which = 0; which < 3; which++) {
        Skeleton *s = leaf(which, 4);
        const char *left = which == 0 ? "L4" : "P2", *midrib = "midrib";
        uint32_t edge = which == 2 ? node_of(s, "P6", 24) : tip_of(s, left), tip = tip_of(s, midrib);
        uint32_t early = node_of(s, midrib, s->sequence[0].n / 5);
        def.kind = POSE_CUPPED;
        Pose *p = posed(s, def);
        g_assert_cmpfloat(p->place[edge].z, >, 2.0);
        g_assert_cmpfloat(p->place[tip].z, >, 1.0);
        pose_free(p);
        def.kind = POSE_FOLDED;
        p = posed(s, def);
        g_assert_cmpfloat(p->place[edge].z, >, 2.0);
        g_assert_cmpfloat(p->place[tip].z, ==, 0.0);
        if (which == 0) { /* a V: every vein in a plane through the midrib */
            double slope = p->place[edge].z / fabs(p->place[edge].x);
            for (uint32_t i = 0; i < s->n_nodes; i++)
                near(p->place[i].z, slope * fabs(p->place[i].x), 1e-9);
        }
        pose_free(p);
        def.kind = POSE_DROOPING;
        p = posed(s, def);
        g_assert_cmpfloat(p->place[tip].z, <, -5.0);
        g_assert_cmpfloat(p->place[early].z, >, 0.5);
        pose_free(p);
        def.kind = POSE_CURLED_TIP;
        p = posed(s, def);
        g_assert_cmpfloat(p->place[tip].z, <, -3.0);
        g_assert_cmpfloat(p->place[node_of(s, midrib, (uint32_t)(0.69 * s->sequence[0].n))].z, ==, 0.0);
        pose_free(p);
        def.kind = POSE_WAVY;
        p = posed(s, def);
        double low = 0.0, high = 0.0;
        for (uint32_t i = 0; i < s->n_nodes; i++) {
            low = MIN(low, p->place[i].z);
            high = MAX(high, p->place[i].z);
        }
        g_assert_cmpfloat(low, <, -1.0);
        g_assert_cmpfloat(high, >, 1.0);
        pose_free(p);
        hand_free(s);
    }
}

/* Older leaves are bent more and take less room; a fresh one is flat. */
static void test_withered(void)
{
    for (int which = 0; which < 2; which++) {
        Skeleton *s = leaf(which, 3);
        PoseDef def = pose_def_default();
        def.kind = POSE_WITHERED;
        double last = HUGE_VAL;
        for (int k = 0; k <= 5; k++) {
            def.age = k / 5.0;
            Pose *p = posed(s, def);
            double width = 0.0;
            for (uint32_t i = 0; i < s->n_nodes; i++)
                width += fabs(p->place[i].x);
            g_assert_cmpint(is_flat(p), ==, k == 0);
            g_assert_cmpfloat(width, <, last);
            last = width;
            pose_free(p);
        }
        hand_free(s);
    }
}

/* Drying up lifts both sides of the blade at once where the side veins leave: V-shaped, towards the sunny side, more with age. */
static void test_withered_fold(void)
{
    Skeleton *s = hand_pinnate(9, 3);
    PoseDef def = pose_def_default();
    def.kind = POSE_WITHERED;
    def.variation = 0.0;
    for (uint32_t k = 1; k <= 5; k++) {
        def.age = k / 5.0;
        Pose *p = posed(s, def);
        uint32_t seen = 0;
        for (uint32_t q = 1; q < s->n_sequences; q++) {
            const uint32_t *at = s->at + s->sequence[q].first;
            if (s->sequence[q].parent != 0)
                continue;
            Vec3 d = vec3_unit(vec3_sub(p->place[at[1]], p->place[at[0]]), vec3(0, 0, 0));
            double rise = asin(vec3_dot(d, p->turn[at[0]].z)) / DTRIG_DEGREE;
            g_assert_cmpfloat(rise, >, 8.0 * def.age); /* 18°, but the veins leave askew */
            g_assert_cmpfloat(rise, <, 18.0 * def.age + 8.0);
            seen++;
        }
        g_assert_cmpuint(seen, >, 5);
        pose_free(p);
    }
    hand_free(s);
}

/* On the way between two poses veins keep their lengths, the ends are the poses, and the turns along it come to what pose_apart says. */
static void test_between(void)
{
    for (int which = 0; which < 3; which++)
        for (int k = 0; k < 4; k++) {
            Skeleton *s = leaf(which, 3);
            PoseDef from = pose_def_default(), to = pose_def_default();
            from.kind = k == 0 ? POSE_FLAT : POSE_CUPPED;
            to.kind = k == 3 ? POSE_CURLED_TIP : POSE_WITHERED;
            to.age = 1.0;
            if (k == 2)
                to.rules = "midrib rotate x 180 at 0.5";
            Pose *a = posed(s, from), *b = posed(s, to);
            double apart = pose_apart(a, b), sum = 0.0;
            g_assert_cmpfloat(pose_apart(a, a), <, 1e-6);
            g_assert_cmpfloat(apart, >, 0.3);
            g_assert_cmpfloat_with_epsilon(pose_apart(b, a), apart, 1e-6);
            Pose *last = pose_copy(a);
            for (int i = 0; i <= 10; i++) {
                Pose *p = pose_between(a, b, i / 10.0);
                for (uint32_t n = 0; n < s->n_nodes; n++) {
                    uint32_t h = s->hinge[n];
                    if (h != NO_PARENT)
                        g_assert_cmpfloat_with_epsilon(vec3_dist(p->place[n], p->place[h]), vec_dist(s->rest[n], s->rest[h]), 1e-9);
                    if (i == 0 || i == 10)
                        g_assert_cmpfloat(vec3_dist(p->place[n], (i ? b : a)->place[n]), <, 1e-6);
                }
                double step = pose_apart(last, p);
                sum += step;
                if (i > 0)
                    g_assert_cmpfloat_with_epsilon(step, apart / 10, 1e-6);
                pose_free(last);
                last = p;
            }
            g_assert_cmpfloat_with_epsilon(sum, apart, 1e-5);
            pose_free(last);
            pose_free(a);
            pose_free(b);
            hand_free(s);
        }
}

static void test_def_between(void)
{
    PoseDef flat = pose_def_default(), old = pose_def_default(), rules = pose_def_default(), out;
    old.kind = POSE_WITHERED;
    old.age = 1.0;
    old.strength = 2.0;
    rules.kind = POSE_WITHERED;
    rules.rules = "midrib lift 10";
    g_assert_true(pose_def_between(&flat, &old, 0.25, &out)); /* flat is the other pose not yet begun */
    g_assert_true(out.kind == POSE_WITHERED && out.blend == 0.25 && out.age == 1.0 && out.strength == 2.0);
    g_assert_true(pose_def_between(&old, &flat, 0.25, &out));
    g_assert_true(out.kind == POSE_WITHERED && out.blend == 0.75 && out.age == 1.0);
    PoseDef young = old;
    young.age = 0.2;
    young.blend = 0.5;
    g_assert_true(pose_def_between(&young, &old, 0.5, &out));
    g_assert_cmpfloat_with_epsilon(out.age, 0.6, 1e-12);
    g_assert_cmpfloat_with_epsilon(out.blend, 0.75, 1e-12);
    g_assert_false(pose_def_between(&rules, &old, 0.5, &out));
    PoseDef cupped = old;
    cupped.kind = POSE_CUPPED;
    g_assert_false(pose_def_between(&cupped, &old, 0.5, &out));
    cupped.blend = 0.0;
    g_assert_true(pose_def_between(&cupped, &old, 0.5, &out));
    g_assert_true(out.kind == POSE_WITHERED && out.blend == 0.5);
}

/* A vein's unevenness is its own: it doesn't change when another, shorter vein is taken off the leaf. */
static void test_stable_seed(void)
{
    Skeleton *s = hand_pinnate(9, 2), *less = hand_pinnate(9, 2);
    uint32_t gone = find(less, "L1.L1");
    memmove(&less->sequence[gone], &less->sequence[gone + 1], (--less->n_sequences - gone) * sizeof *less->sequence);
    for (uint32_t q = 0; q < less->n_sequences; q++)
        less->sequence[q].parent -= less->sequence[q].parent != NO_PARENT && less->sequence[q].parent > gone;
    PoseDef def = pose_def_default();
    def.kind = POSE_CUPPED;
    def.variation = 1.0;
    Pose *a = posed(s, def), *b = posed(less, def);
    for (uint32_t q = 0; q < less->n_sequences; q++)
        for (uint32_t k = 0; k < less->sequence[q].n; k++) {
            uint32_t i = less->at[less->sequence[q].first + k];
            near3(a->place[i], b->place[i], 0.0);
        }
    pose_free(a);
    pose_free(b);
    hand_free(s);
    hand_free(less);
}

/* --- rules --- */

/* Even bends make circles. */
static void test_lift_turn_fold(void)
{
    Skeleton *s = hand_pinnate(9, 8);
    const double a = 80 * DTRIG_DEGREE, l = 100.0;
    Pose *p = ruled(s, "midrib lift 80");
    check_pose(p);
    near3(p->place[tip_of(s, "midrib")], vec3(0, l / a * sin(a), l / a * (1 - cos(a))), 1e-3);
    near3(p->place[node_of(s, "midrib", 88)], vec3(0, l / a * sin(a / 2), l / a * (1 - cos(a / 2))), 1e-3);
    pose_free(p);
    p = ruled(s, "midrib turn 80");
    near3(p->place[tip_of(s, "midrib")], vec3(-l / a * (1 - cos(a)), l / a * sin(a), 0), 1e-3);
    pose_free(p);
    p = ruled(s, "L2 fold 30; R2 fold 30; L3 fold -30");
    check_pose(p);
    Vec2 l2 = s->rest[tip_of(s, "L2")], l3 = s->rest[tip_of(s, "L3")];
    near3(p->place[tip_of(s, "L2")], vec3(l2.x * cos(a * 3 / 8), l2.y, -l2.x * sin(a * 3 / 8)), 1e-12);
    near3(p->place[tip_of(s, "R2")], vec3(-l2.x * cos(a * 3 / 8), l2.y, -l2.x * sin(a * 3 / 8)), 1e-12);
    near3(p->place[tip_of(s, "L3")], vec3(l3.x * cos(a * 3 / 8), l3.y, l3.x * sin(a * 3 / 8)), 1e-12);
    near3(p->place[tip_of(s, "L4")], vec3_flat(s->rest[tip_of(s, "L4")]), 0.0);
    pose_free(p);
    /* Bends add up and carry what hangs on them: lifts of 30 and 50 are one of 80. */
    Pose *two = ruled(s, "midrib lift 30;midrib turn 5;midrib lift 50; L5 fold 3; midrib turn 6; L5 fold 4;"),
         *one = ruled(s, " midrib  lift\t80 ; midrib turn 11; L5 fold 7");
    g_assert_cmpfloat(farthest(two, one), <, 1e-11);
    g_assert_cmpfloat(one->place[tip_of(s, "R5")].z, >, 20.0);
    pose_free(two);
    pose_free(one);
    hand_free(s);
    s = hand_palmate(2); /* another primary folds about the midrib */
    p = ruled(s, "P2 fold 30");
    Vec2 p2 = s->rest[tip_of(s, "P2")];
    near3(p->place[tip_of(s, "P2")], vec3(p2.x * cos(a * 3 / 8), p2.y, -p2.x * sin(a * 3 / 8)), 1e-12);
    pose_free(p);
    hand_free(s);
}

static void test_rotate_rule(void)
{
    Skeleton *s = hand_pinnate(9, 1);
    Pose *want = pose_new(s), *got = ruled(s, "midrib rotate x 20 at 0.5; L6 rotate 0,-2,0 30; R6 rotate z 10 at 1");
    pose_rotate(want, node_of(s, "midrib", 12), vec3(1, 0, 0), 20 * DTRIG_DEGREE);
    pose_rotate(want, node_of(s, "L6", 1), vec3(0, -1, 0), 30 * DTRIG_DEGREE);
    pose_rotate(want, node_of(s, "R6", 6), vec3(0, 0, 1), 10 * DTRIG_DEGREE);
    g_assert_cmpfloat(farthest(want, got), <, 1e-12);
    pose_free(want);
    pose_free(got);
    hand_free(s);
}

/* Which veins a rule takes. */
static void test_veins(void)
{
    Skeleton *s = hand_pinnate(9, 1);
    s->sequence[find(s, "R9")].fictitious = true;
    static const struct {
        const char *veins;
        const char *moved; /* names parted by blanks, '*' at the end for any */
    } cases[] = {
        {"all", "* "}, {"order 1", "* "}, {"order 3", "L1.L1 L1.L2 R1.R1 R1.R2 L2.L1 L2.L2 R2.R1 R2.R2 "}, {"side left", "L* "},
        {"side right", "R* "}, {"fictitious", "R9 "}, {"R1", "R1 R1.* "}, {"L1*", "L1 L1.* "}, {"L1.L2", "L1.L2 "}, {"*", "* "},
        {"L2.*", "L2.* "},
    };
    for (gsize i = 0; i < G_N_ELEMENTS(cases); i++) {
        char *rule = g_strdup_printf("%s turn 50", cases[i].veins);
        Pose *p = ruled(s, rule);
        for (uint32_t q = 0; q < s->n_sequences; q++) {
            const Sequence *seq = &s->sequence[q];
            uint32_t tip = s->at[seq->first + seq->n - 1], base = s->at[seq->first];
            /* By the rule itself, or carried by a parent that was. */
            Vec3 moved = vec3_sub(p->place[tip], p->place[base]), rest = vec3_flat(vec_sub(s->rest[tip], s->rest[base]));
            bool bent = vec3_dist(moved, rest) > 1e-6, wanted = false;
            char **names = g_strsplit(cases[i].moved, " ", -1);
            for (char **n = names; **n; n++)
                wanted |= g_pattern_match_simple(*n, seq->name);
            g_strfreev(names);
            g_assert_cmpint(bent, ==, wanted);
        }
        pose_free(p);
        g_free(rule);
    }
    hand_free(s);
    s = hand_palmate(1); /* what leaves a primary on the left is on the left, wherever it goes */
    Pose *p = ruled(s, "side left turn 50");
    for (uint32_t q = 0; q < s->n_sequences; q++) {
        const char *name = s->sequence[q].name;
        uint32_t tip = s->at[s->sequence[q].first + s->sequence[q].n - 1];
        bool left = name[0] == 'L' || strncmp(name, "P2", 2) == 0 || strncmp(name, "P4", 2) == 0;
        g_assert_cmpint(vec3_dist(p->place[tip], vec3_flat(s->rest[tip])) > 1.0, ==, left);
        if (strcmp(name, "P2.R2") == 0) { /* bent by itself too, not only carried */
            const uint32_t *node = s->at + s->sequence[q].first;
            Vec3 a = vec3_sub(p->place[node[1]], p->place[node[0]]), b = vec3_sub(p->place[node[4]], p->place[node[3]]);
            Vec2 c = vec_sub(s->rest[node[1]], s->rest[node[0]]), d = vec_sub(s->rest[node[4]], s->rest[node[3]]);
            near(atan2(a.x * b.y - a.y * b.x, vec3_dot(a, b)) - atan2(vec_cross(c, d), vec_dot(c, d)), 0.75 * 50 * DTRIG_DEGREE, 0.05);
        }
    }
    pose_free(p);
    hand_free(s);
}

static void test_bad_rules(void)
{
    Skeleton *s = hand_pinnate(9, 1);
    static const struct {
        const char *rules;
        PoseError code;
        const char *says[4];
    } bad[] = {
        {"midrib", POSE_ERROR_SYNTAX, {"rule 1", "nothing", "lift, turn, fold, rotate and spline"}},
        {"midrib lfit 20", POSE_ERROR_SYNTAX, {"'midrib lfit 20'", "'lfit'", "lift, turn"}},
        {"midrib lift 1; L1 lift", POSE_ERROR_SYNTAX, {"rule 2", "'L1 lift'", "nothing", "-3600"}},
        {"midrib lift x", POSE_ERROR_SYNTAX, {"'x'", "degrees"}},
        {"midrib lift 0x10", POSE_ERROR_SYNTAX, {"'0x10'"}},
        {"midrib lift nan", POSE_ERROR_SYNTAX, {"'nan'"}},
        {"midrib lift 1e999", POSE_ERROR_SYNTAX, {"'1e999'"}},
        {"midrib lift 3601", POSE_ERROR_SYNTAX, {"'3601'", "3600"}},
        {"midrib lift 20 30", POSE_ERROR_SYNTAX, {"'30'", "end"}},
        {"midrib lift 20 L1 fold 3", POSE_ERROR_SYNTAX, {"'L1'", "';'"}},
        {"midrib rotate", POSE_ERROR_SYNTAX, {"nothing", "axis", "X,Y,Z"}},
        {"midrib rotate w 20", POSE_ERROR_SYNTAX, {"'w'", "x, y, z"}},
        {"midrib rotate 0,0,0 20", POSE_ERROR_SYNTAX, {"'0,0,0'", "not all 0"}},
        {"midrib rotate 1,2 20", POSE_ERROR_SYNTAX, {"'1,2'"}},
        {"midrib rotate x 20 to 1", POSE_ERROR_SYNTAX, {"'to'", "at T"}},
        {"midrib rotate x 20 at", POSE_ERROR_SYNTAX, {"nothing", "0 … 1"}},
        {"midrib rotate x 20 at 1.5", POSE_ERROR_SYNTAX, {"'1.5'", "0 … 1"}},
        {"midrib rotate x 20 at 0.5 0.6", POSE_ERROR_SYNTAX, {"'0.6'"}},
        {"midrib spline", POSE_ERROR_SYNTAX, {"no points", "T = 1"}},
        {"midrib spline 0.5,0,0,0", POSE_ERROR_SYNTAX, {"tip", "T = 1"}},
        {"midrib spline 1,0,1", POSE_ERROR_SYNTAX, {"'1,0,1'", "four"}},
        {"midrib spline 1,0,1,0,0", POSE_ERROR_SYNTAX, {"'1,0,1,0,0'", "four"}},
        {"midrib spline 0.5,0,0,0 0.5,0,0,1 1,0,1,0", POSE_ERROR_SYNTAX, {"'0.5,0,0,1'", "greater"}},
        {"midrib spline 0.5,0,0,0 1.1,0,0,1", POSE_ERROR_SYNTAX, {"'1.1,0,0,1'", "0 … 1"}},
        {"midrib spline -0.5,0,0,0 1,0,0,1", POSE_ERROR_SYNTAX, {"'-0.5,0,0,0'"}},
        {"midrib spline 1,0,1e9,0", POSE_ERROR_SYNTAX, {"1000"}},
        {"order lift 3", POSE_ERROR_SYNTAX, {"'lift'", "whole number"}},
        {"order", POSE_ERROR_SYNTAX, {"nothing"}},
        {"order 1.5 lift 3", POSE_ERROR_SYNTAX, {"'1.5'"}},
        {"side up lift 3", POSE_ERROR_SYNTAX, {"'up'", "left or right"}},
        {"L*1 lift 3", POSE_ERROR_SYNTAX, {"'L*1'", "end"}},
        {"L99 lift 3", POSE_ERROR_VEIN, {"no vein 'L99'", "midrib, L1, L1.L1", "…", "fictitious"}},
        {"Q* lift 3", POSE_ERROR_VEIN, {"'Q*'"}},
        {"order 7 lift 3", POSE_ERROR_VEIN, {"order 7", "1, 2, 3"}},
        {"fictitious lift 3", POSE_ERROR_VEIN, {"no fictitious"}},
        {"midrib fold 3", POSE_ERROR_VEIN, {"nothing to fold"}},
    };
    Pose *p = pose_new(s), *before = NULL;
    pose_rotate(p, 3, vec3(1, 1, 0), 0.3);
    before = pose_copy(p);
    for (gsize i = 0; i < G_N_ELEMENTS(bad); i++) {
        PoseDef def = pose_def_default();
        GError *error = NULL;
        def.kind = POSE_CUPPED;
        def.rules = bad[i].rules;
        if (pose_apply(p, &def, &error))
            g_error("'%s' was taken", bad[i].rules);
        g_assert_error(error, POSE_ERROR, (int)bad[i].code);
        for (int k = 0; k < 4 && bad[i].says[k]; k++)
            if (!strstr(error->message, bad[i].says[k]))
                g_error("'%s' not in \"%s\"", bad[i].says[k], error->message);
        g_clear_error(&error);
        g_assert_true(memcmp(p->place, before->place, s->n_nodes * sizeof(Vec3)) == 0);
    }
    PoseDef def = pose_def_default();
    const char *nothing[] = {"", " ", ";", " ; ;; "};
    for (gsize i = 0; i < G_N_ELEMENTS(nothing); i++) {
        def.rules = nothing[i];
        g_assert_true(pose_apply(p, &def, NULL));
        g_assert_true(is_flat(p)); /* from flat, whatever it was */
    }
    pose_free(p);
    pose_free(before);
    hand_free(s);
}

/* --- splines --- */

static Vec3 on_circle(double arc, double radius) { return vec3(0, radius * sin(arc / radius), radius * (1 - cos(arc / radius))); }

/* Targets on a circle as long as the vein: every node comes to lie near its place there, much nearer than an edge is long. */
static void test_spline_circle(void)
{
    for (uint32_t cut = 1; cut <= 4; cut *= 2) {
        Skeleton *s = hand_pinnate(9, cut);
        uint32_t midrib = find(s, "midrib"), n = s->sequence[midrib].n, control[5];
        double radius = 60.0, edge = 100.0 / (n - 1), worst = 0.0, rough = 0.0;
        Vec3 target[5];
        for (uint32_t k = 0; k < 5; k++) {
            control[k] = (n - 1) * k / 4;
            target[k] = on_circle(control[k] * edge, radius);
        }
        Pose *p = pose_new(s), *before = pose_new(s);
        pose_spline(p, midrib, control, target, 5);
        check_pose(p);
        for (uint32_t k = 0; k < n; k++)
            worst = MAX(worst, vec3_dist(p->place[s->at[k]], on_circle(k * edge, radius)));
        for (uint32_t k = 0; k < 5; k++)
            rough = MAX(rough, vec3_dist(p->place[s->at[control[k]]], target[k]));
        g_test_message("%u nodes: off the circle by %.4f, off the targets by %.4f segments; an edge is %.2f", n, worst, rough, edge);
        g_assert_cmpfloat(worst, <, MIN(edge, 0.6));
        g_assert_cmpfloat(rough, <, 0.25 * edge);
        for (uint32_t i = 0; i < s->n_nodes; i++) /* veins on it are carried unbent */
            for (uint32_t j = s->sequence[midrib].n; j < i; j += 5)
                if (descends(s, i, j))
                    near(vec3_dist(p->place[i], p->place[j]), vec3_dist(before->place[i], before->place[j]), 1e-12);
        pose_free(p);
        pose_free(before);
        hand_free(s);
    }
}

/* Splines of another length are followed in shape; the vein never folds back. */
static void test_spline_lengths(void)
{
    Skeleton *s = hand_pinnate(9, 4);
    uint32_t midrib = find(s, "midrib"), n = s->sequence[midrib].n, control[4] = {0, 20, 60, n - 1};
    for (double scale = 0.1; scale < 10.0; scale *= 1.7) {
        Vec3 target[4] = {{5, 5, 5}, vec3_scale(vec3(5, 20, 10), scale), vec3_scale(vec3(-5, 60, 20), scale), vec3_scale(vec3(0, 90, -10), scale)};
        Pose *p = pose_new(s);
        pose_spline(p, midrib, control, target, 4);
        check_pose(p);
        near3(p->place[0], vec3(0, 0, 0), 0.0);
        for (uint32_t k = 1; k + 1 < n; k++) {
            Vec3 a = vec3_sub(p->place[s->at[k]], p->place[s->at[k - 1]]), b = vec3_sub(p->place[s->at[k + 1]], p->place[s->at[k]]);
            g_assert_cmpfloat(vec3_dot(a, b), >, 0.9 * vec3_norm(a) * vec3_norm(b));
        }
        Vec3 tip = p->place[tip_of(s, "midrib")], want = vec3(0, 90, -10);
        g_assert_cmpfloat(vec3_dot(vec3_unit(tip, tip), vec3_unit(want, want)), >, 0.98);
        pose_free(p);
    }
    hand_free(s);
}

static void test_spline_odd(void)
{
    Skeleton *s = hand_pinnate(9, 2);
    uint32_t midrib = find(s, "midrib"), n = s->sequence[midrib].n, control[3] = {0, n / 2, n - 1};
    Pose *p = pose_new(s);
    const Vec3 same[3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, back[3] = {{0, 0, 0}, {0, -50, 0}, {0, -100, 0}},
               twice[3] = {{0, 0, 0}, {0, 0, 50}, {0, 0, 50}};
    pose_spline(p, midrib, control, same, 3); /* no direction: stays */
    g_assert_true(is_flat(p));
    pose_spline(p, midrib, control, back, 3); /* right about, over the sunny side's normal */
    check_pose(p);
    near3(p->place[tip_of(s, "midrib")], vec3(0, -100, 0), 1e-9);
    near(p->place[tip_of(s, "L4")].z, 0.0, 1e-9);
    pose_spline(p, midrib, control, twice, 3);
    check_pose(p);
    pose_free(p);
    const uint32_t two[2] = {0, n - 1};
    const Vec3 line[2] = {{0, 0, 0}, {30, 0, 40}};
    p = pose_new(s); /* from a bent pose too; straight lines exactly */
    pose_rotate(p, node_of(s, "midrib", 7), vec3(1, 0, 1), 0.7);
    pose_spline(p, midrib, two, line, 2);
    check_pose(p);
    near3(p->place[tip_of(s, "midrib")], vec3(60, 0, 80), 1e-9);
    Pose *rule = ruled(s, "midrib rotate x 20 at 0.3; midrib spline 1,0.3,0,0.4"), *given = ruled(s, "midrib spline 0,9,9,9 1,0.3,0,0.4");
    near3(rule->place[tip_of(s, "midrib")], vec3(60, 0, 80), 1e-9);
    near3(given->place[tip_of(s, "midrib")], vec3(60, 0, 80), 1e-9);
    pose_free(rule);
    pose_free(given);
    pose_free(p);
    /* A side vein that was carried somewhere first: its own nodes alone move. */
    p = ruled(s, "midrib lift 60; L3 spline 0.5,-0.2,0.4,0.4 1,-0.3,0.5,0.6");
    Pose *before = ruled(s, "midrib lift 60");
    check_pose(p);
    for (uint32_t i = 0; i < s->n_nodes; i++)
        g_assert_cmpint(vec3_dist(p->place[i], before->place[i]) > 0.0, ==, descends(s, i, node_of(s, "L3", 1)));
    pose_free(p);
    pose_free(before);
    hand_free(s);
}

/* A few places to the last bit: what every compiler and machine must give. */
static void test_bits(void)
{
    Skeleton *s = hand_pinnate(9, 2);
    PoseDef def = pose_def_default();
    def.kind = POSE_WITHERED;
    def.age = 0.8;
    def.rules = "midrib turn 10; L2 spline 0.5,-0.1,0.2,0.3 1,-0.2,0.4,0.3";
    Pose *p = posed(s, def);
    static const struct {
        const char *vein;
        Vec3 place;
    } want[] = {
        {"midrib", {-0x1.3b1021a568b62p+1, 0x1.6af02ec74bf0cp+6, 0x1.a38497f8ac5c7p+4}},
        {"L2", {-0x1.0f9dbde2d625cp+4, 0x1.326fd15ce5d95p+5, 0x1.4dae88316f066p+4}},
        {"R5", {0x1.683da75d41e44p+0, 0x1.7d69009dfaed8p+5, 0x1.336cf7acd9475p+4}},
    };
    for (gsize i = 0; i < G_N_ELEMENTS(want); i++) {
        Vec3 got = p->place[tip_of(s, want[i].vein)];
        g_test_message("{\"%s\", {%a, %a, %a}},", want[i].vein, got.x, got.y, got.z);
        near3(got, want[i].place, 0.0);
    }
    pose_free(p);
    hand_free(s);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/pose/rotation", test_rotation);
    g_test_add_func("/pose/rotate/planes", test_rotate_planes);
    g_test_add_func("/pose/rotate/rigid", test_rigid);
    g_test_add_func("/pose/rotate/inverse", test_inverse);
    g_test_add_func("/pose/rotate/many", test_many);
    g_test_add_func("/pose/ready/by-hinges", test_by_hinges);
    g_test_add_func("/pose/ready/invariants", test_invariants);
    g_test_add_func("/pose/ready/untwisted", test_untwisted);
    g_test_add_func("/pose/ready/blend", test_blend);
    g_test_add_func("/pose/ready/convergence", test_convergence);
    g_test_add_func("/pose/ready/symmetry", test_symmetry);
    g_test_add_func("/pose/ready/meaning", test_meaning);
    g_test_add_func("/pose/ready/withered", test_withered);
    g_test_add_func("/pose/ready/withered/fold", test_withered_fold);
    g_test_add_func("/pose/between", test_between);
    g_test_add_func("/pose/between/def", test_def_between);
    g_test_add_func("/pose/ready/stable-seed", test_stable_seed);
    g_test_add_func("/pose/rules/bends", test_lift_turn_fold);
    g_test_add_func("/pose/rules/rotate", test_rotate_rule);
    g_test_add_func("/pose/rules/veins", test_veins);
    g_test_add_func("/pose/rules/bad", test_bad_rules);
    g_test_add_func("/pose/spline/circle", test_spline_circle);
    g_test_add_func("/pose/spline/lengths", test_spline_lengths);
    g_test_add_func("/pose/spline/odd", test_spline_odd);
    g_test_add_func("/pose/bits", test_bits);
    return g_test_run();
}
