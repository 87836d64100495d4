/* Vein solids: closed, outward, of the right volume, joined, untwisted; and normals of surfaces. */
#include <glib.h>
#include <math.h>
#include <string.h>

#include "geom/random.h"
#include "geom/segment.h"
#include "hand_skeleton.h"
#include "shape/pose.h"
#include "shape/solid.h"

static void near(double got, double want, double tolerance)
{
    if (!(fabs(got - want) <= tolerance))
        g_error("%.17g instead of %.17g: off by %g", got, want, fabs(got - want));
}

static Pose *posed(const Skeleton *s, PoseKind kind, double age)
{
    PoseDef def = pose_def_default();
    def.kind = kind;
    def.age = age;
    Pose *p = pose_new(s);
    g_assert_true(pose_apply(p, &def, NULL));
    return p;
}

/* The blade's normal beside the veins is not known here: what the veins carry stands for it. */
static Vec3 *carried_normals(const Pose *p)
{
    Vec3 *normal = g_new(Vec3, p->skeleton->n_nodes);
    for (uint32_t i = 0; i < p->skeleton->n_nodes; i++)
        normal[i] = p->turn[i].z;
    return normal;
}

static int compare_edges(gconstpointer a, gconstpointer b, gpointer unused)
{
    const uint32_t *x = a, *y = b;
    return x[0] != y[0] ? (x[0] < y[0] ? -1 : 1) : (x[1] > y[1]) - (x[1] < y[1]);
}

/* Every edge is used once in each direction, so the surface is closed and faces one way; every vertex is used. */
static void check_closed(const Surface *s)
{
    uint32_t n = 3 * s->n_triangles;
    uint32_t(*edge)[2] = g_malloc_n(n, sizeof *edge), (*back)[2] = g_malloc_n(n, sizeof *back);
    bool *used = g_new0(bool, s->n_vertices);
    for (uint32_t t = 0; t < s->n_triangles; t++)
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t a = s->triangle[t][k], b = s->triangle[t][(k + 1) % 3];
            g_assert_cmpuint(a, <, s->n_vertices);
            g_assert_cmpuint(a, !=, b);
            used[a] = true;
            edge[3 * t + k][0] = back[3 * t + k][1] = a;
            edge[3 * t + k][1] = back[3 * t + k][0] = b;
        }
    g_qsort_with_data(edge, (gint)n, sizeof *edge, compare_edges, NULL);
    g_qsort_with_data(back, (gint)n, sizeof *back, compare_edges, NULL);
    g_assert_true(memcmp(edge, back, n * sizeof *edge) == 0);
    for (uint32_t i = 1; i < n; i++)
        g_assert_true(compare_edges(edge[i - 1], edge[i], NULL) < 0);
    for (uint32_t v = 0; v < s->n_vertices; v++)
        g_assert_true(used[v]);
    g_free(edge);
    g_free(back);
    g_free(used);
}

static double volume(const Surface *s)
{
    double six = 0.0;
    for (uint32_t t = 0; t < s->n_triangles; t++) {
        Vec3 a = s->place[s->triangle[t][0]], b = s->place[s->triangle[t][1]], c = s->place[s->triangle[t][2]];
        six += vec3_dot(a, vec3_cross(b, c));
    }
    return six / 6.0;
}

static Tube straight(uint32_t n, double length, double from, double to)
{
    Tube t = {0, n, g_new(Vec3, n), g_new0(Vec2, n), g_new(double, n), g_new0(uint32_t, n), {0, 0, 1}, 0, 0, false};
    for (uint32_t i = 0; i < n; i++) {
        double part = (double)i / (n - 1);
        t.centre[i] = vec3(1.0, 2.0 + length * part, 3.0);
        t.radius[i] = from + (to - from) * part;
        t.rest[i] = vec2(1.0, 2.0 + length * part);
        t.node[i] = i;
    }
    return t;
}

static Tube *one(Tube t)
{
    Tube *list = g_new(Tube, 1);
    list[0] = t;
    return list;
}

/* A cone between half balls. */
static void test_cone(void)
{
    for (uint32_t sides = 3; sides <= 64; sides++) {
        SolidDef def = solid_def_default(100);
        def.sides = sides;
        Tube *t = one(straight(5, 40, 3, 1));
        Surface *s = solid_surface(t, 1, &def);
        check_closed(s);
        double polygon = sides * sin(2 * DTRIG_PI / sides) / 2, cone = polygon * 40 * (9 + 3 + 1) / 3;
        double balls = 2.0 / 3.0 * DTRIG_PI * (27 + 1);
        g_assert_cmpfloat(volume(s), >, cone);
        g_assert_cmpfloat(volume(s), <, cone + balls);
        if (sides == 64)
            near(volume(s), DTRIG_PI * 40 * 13 / 3 + balls, 0.01 * DTRIG_PI * 40 * 13 / 3);
        for (uint32_t v = 0; v < s->n_vertices; v++) { /* outward, and of unit length */
            Vec3 p = s->place[v], axis = vec3(1, p.y < 2 ? 2 : p.y > 42 ? 42 : p.y, 3);
            near(vec3_norm(s->normal[v]), 1.0, 1e-14);
            g_assert_cmpfloat(vec3_dot(s->normal[v], vec3_sub(p, axis)), >, 0.0);
            g_assert_true(s->uv[v].x == 1.0 && s->uv[v].y >= 2.0 && s->uv[v].y <= 42.0);
        }
        surface_free(s);
        solid_tubes_free(t, 1);
    }
}

static uint32_t sides_of(const Tube *t, const SolidDef *def) { return t->sides ? t->sides : def->sides; }

/* How many rings lie before the first ball's: half of those that are no ball's, none where the tube begins within another. */
static uint32_t end_rings(const Tube *t, const SolidDef *def)
{
    Surface *s = solid_surface(t, 1, def);
    uint32_t ends = (s->n_vertices - 2) / sides_of(t, def) - t->n;
    g_assert_cmpuint(s->n_triangles, ==, solid_tube_triangles(t, def));
    surface_free(s);
    return t->inside ? 0 : ends / 2;
}

/* From the ball's centre to side 0 of its ring. */
static Vec3 spoke(const Surface *s, const Tube *t, uint32_t ends, uint32_t i, const SolidDef *def)
{
    return vec3_sub(s->place[1 + (ends + i) * sides_of(t, def)], t->centre[i]);
}

/* On an arc in a plane a spoke in the plane stays in it and one across stays across; over an S too, and right through a kink. */
static void test_frames_plane(void)
{
    SolidDef def = solid_def_default(100);
    for (int way = 0; way < 2; way++) {
        Tube *t = one(straight(60, 40, 1, 0.5));
        double heading = 0.0;
        t->up = way ? vec3(0, 0, 1) : vec3(1, 0, 0);
        t->centre[0] = vec3(0, 0, 0);
        for (uint32_t i = 1; i < t->n; i++) {
            heading += i < 25 ? 0.1 : i == 40 ? 1.8 : -0.13;
            t->centre[i] = vec3_add(t->centre[i - 1], vec3(sin(heading), cos(heading), 0));
        }
        Surface *s = solid_surface(t, 1, &def);
        check_closed(s);
        uint32_t ends = end_rings(t, &def);
        for (uint32_t i = 0; i < t->n; i++) {
            Vec3 u = vec3_scale(spoke(s, t, ends, i, &def), 1.0 / t->radius[i]);
            near(vec3_norm(u), 1.0, 1e-12);
            near(way ? u.z : u.z + 1.0, 1.0, 1e-10);
            if (i > 0 && !way) { /* on the same side all along: no flip */
                Vec3 step = vec3_sub(t->centre[i], t->centre[i - 1]);
                g_assert_cmpfloat(vec3_cross(u, step).z, >, 0.5);
            }
        }
        surface_free(s);
        solid_tubes_free(t, 1);
    }
}

/* Along a helix against parallel transport by a thousand times smaller steps. */
static void test_frames_helix(void)
{
    enum { N = 200, FINE = 1000 };
    SolidDef def = solid_def_default(100);
    Tube *t = one(straight(N, 40, 0.2, 0.1));
    for (uint32_t i = 0; i < N; i++) {
        double a = 0.08 * i;
        t->centre[i] = vec3(5 * cos(a), 5 * sin(a), 2 * a);
    }
    t->up = vec3(1, 0, 0);
    Surface *s = solid_surface(t, 1, &def);
    uint32_t ends = end_rings(t, &def);
    Vec3 u = vec3_unit(spoke(s, t, ends, 1, &def), vec3(1, 0, 0));
    for (uint32_t i = 1; i + 2 < N; i++) {
        Vec3 got = vec3_unit(spoke(s, t, ends, i, &def), vec3(1, 0, 0));
        near(vec3_norm(vec3_cross(got, u)), 0.0, 5e-4);
        for (uint32_t k = 0; k < FINE; k++) {
            double a = 0.08 * (i + (k + 1.0) / FINE);
            Vec3 tangent = vec3_unit(vec3(-5 * sin(a), 5 * cos(a), 2), u);
            u = vec3_unit(vec3_sub(u, vec3_scale(tangent, vec3_dot(u, tangent))), u);
        }
    }
    surface_free(s);
    solid_tubes_free(t, 1);
}

static const Tube *tube_of(const Tube *t, uint32_t n, uint32_t sequence)
{
    for (uint32_t i = 0; i < n; i++)
        if (t[i].sequence == sequence)
            return &t[i];
    return NULL;
}

/* How deep p lies within the flat-sided tube, in radii of it; below 0 outside. */
static double depth_within(const Tube *t, Vec3 p, uint32_t sides)
{
    double deepest = -HUGE_VAL;
    for (uint32_t i = 0; i + 1 < t->n; i++) {
        Vec3 d = vec3_sub(t->centre[i + 1], t->centre[i]);
        double part = vec3_dot(vec3_sub(p, t->centre[i]), d) / vec3_dot(d, d);
        part = CLAMP(part, 0.0, 1.0);
        double r = (t->radius[i] + part * (t->radius[i + 1] - t->radius[i])) * cos(DTRIG_PI / sides);
        deepest = MAX(deepest, 1.0 - vec3_dist(p, vec3_add(t->centre[i], vec3_scale(d, part))) / r);
    }
    return deepest;
}

static Skeleton *leaf(int which, uint32_t cut) { return which == 0 ? hand_pinnate(9, cut) : which == 1 ? hand_palmate(cut) : hand_parallel(cut); }

/* Whole leaves, bent: closed, every branch begins within its parent. */
static void test_leaves(void)
{
    for (int which = 0; which < 3; which++) {
        Skeleton *s = leaf(which, 2);
        for (int k = 0; k < 4; k++) {
            Pose *p = posed(s, k == 0 ? POSE_FLAT : k == 1 ? POSE_CUPPED : POSE_WITHERED, k == 2 ? 0.5 : 1.0);
            Vec3 *normal = carried_normals(p);
            SolidDef def = solid_def_default(100);
            def.offset = k == 0 ? 1.0 : k == 1 ? 0.0 : 0.85;
            def.sides = k == 3 ? 6 : 12;
            uint32_t n;
            Tube *t = solid_tubes(p, normal, &def, &n);
            g_assert_cmpuint(n, ==, s->n_sequences);
            g_assert_cmpuint(t[0].sequence, ==, 0);
            g_assert_cmpuint(t[0].sides, ==, def.sides);
            Surface *surface = solid_surface(t, n, &def);
            check_closed(surface);
            g_assert_cmpfloat(volume(surface), >, 0.0);
            surface_free(surface);
            for (uint32_t i = 0; i < n; i++) {
                Surface *alone = solid_surface(&t[i], 1, &def);
                double tube = 0.0;
                for (uint32_t j = 0; j + 1 < t[i].n; j++) {
                    double a = t[i].radius[j], b = t[i].radius[j + 1];
                    tube += vec3_dist(t[i].centre[j], t[i].centre[j + 1]) * DTRIG_PI / 3 * (a * a + a * b + b * b);
                    g_assert_cmpfloat(a, >, 0.0);
                }
                double polygon = sin(2 * DTRIG_PI / t[i].sides) * t[i].sides / (2 * DTRIG_PI); /* of a circle's area */
                g_assert_cmpfloat(volume(alone), >, 0.78 * polygon * tube);
                g_assert_cmpfloat(volume(alone), <, 1.6 * tube);
                g_assert_cmpuint(t[i].sides, >=, 3);
                g_assert_cmpuint(t[i].sides, <=, def.sides);
                uint32_t parent = s->sequence[t[i].sequence].parent;
                if (parent == NO_PARENT && which == 1 && i > 0)
                    parent = 0; /* primaries that leave the midrib's first node */
                g_assert_cmpint(t[i].inside, ==, parent != NO_PARENT);
                if (parent != NO_PARENT) {
                    const Tube *from = tube_of(t, n, parent);
                    uint32_t first = 1 + end_rings(&t[i], &def) * t[i].sides;
                    g_assert_cmpfloat(depth_within(from, t[i].centre[0], from->sides), >, 0.0);
                    if (parent != 0 || which != 1) /* at the end of a tube the ring may look out of it, into the petiole */
                        for (uint32_t j = 0; j < t[i].sides; j++)
                            g_assert_cmpfloat(depth_within(from, alone->place[first + j], from->sides), >, 0.0);
                }
                surface_free(alone);
            }
            solid_tubes_free(t, n);
            g_free(normal);
            pose_free(p);
        }
        hand_free(s);
    }
}

/* Away from junctions a vein lies `offset` radii below the blade and is as thick as the network's; a branch is wider where it begins. */
static void test_offset(void)
{
    Skeleton *s = hand_pinnate(9, 3);
    Pose *p = posed(s, POSE_CUPPED, 0);
    Vec3 *normal = carried_normals(p);
    SolidDef def = solid_def_default(100);
    uint32_t n, wider = 0;
    def.offset = 0.7;
    def.scale = 1.5;
    def.least_radius = 0.2;
    Tube *t = solid_tubes(p, normal, &def, &n);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = t[i].petiole; j < t[i].n; j++) {
            uint32_t node = t[i].node[j];
            if (t[i].rest[j].x != s->rest[node].x || t[i].rest[j].y != s->rest[node].y)
                continue; /* between nodes */
            double own = MAX(0.2, 1.5 * (j == 0 ? s->sequence[t[i].sequence].base_radius : s->radius[node]));
            if (t[i].sequence == 0 || vec_dist(t[i].rest[j], t[i].rest[0]) > 5.0) {
                near(t[i].radius[j], own, 1e-12);
                near(vec3_dot(vec3_sub(p->place[node], t[i].centre[j]), normal[node]), 0.7 * own, 1e-12);
            } else if (j == 0) {
                wider += t[i].radius[j] > 1.2 * own;
            }
        }
    g_assert_cmpuint(wider, >=, 14); /* but those nearly as thick as their parent: the upper ones, twigs */
    solid_tubes_free(t, n);
    g_free(normal);
    pose_free(p);
    hand_free(s);
}

/* Tubes follow their veins with few balls: the nodes between are within a third of a radius, the branch nodes have balls, no two balls stand
 * farther apart than asked for, and thin veins have few sides. */
static void test_thinning(void)
{
    static const double spacing[] = {3.0, 8.0, 0.0};
    uint32_t balls[3] = {0}, nodes = 0;
    for (int k = 0; k < 3; k++) {
        Skeleton *s = hand_pinnate(9, 10);
        Pose *p = posed(s, POSE_FLAT, 0);
        Vec3 *normal = carried_normals(p);
        SolidDef def = solid_def_default(100);
        uint32_t n;
        def.spacing = spacing[k];
        def.offset = def.petiole_length = 0.0;
        Tube *t = solid_tubes(p, normal, &def, &n);
        nodes = 0;
        for (uint32_t i = 0; i < n; i++) {
            const Sequence *q = &s->sequence[t[i].sequence];
            balls[k] += t[i].n;
            nodes += q->n;
            for (uint32_t j = 0; j < q->n; j++) {
                uint32_t node = s->at[q->first + j];
                double own = fmax(def.least_radius, j ? s->radius[node] : q->base_radius), nearest = HUGE_VAL;
                bool ball = false;
                for (uint32_t b = 0; b < t[i].n; b++) {
                    if (b + 1 < t[i].n)
                        nearest = fmin(nearest, sqrt(segment_dist2(t[i].rest[b], t[i].rest[b + 1], s->rest[node])));
                    ball |= t[i].rest[b].x == s->rest[node].x && t[i].rest[b].y == s->rest[node].y;
                }
                g_assert_cmpfloat(nearest, <=, 0.31 * 1.6 * own);
                for (uint32_t c = 0; c < s->n_sequences; c++)
                    g_assert_true(ball || s->at[s->sequence[c].first] != node);
            }
            for (uint32_t b = 1; b < t[i].n && spacing[k] > 0.0; b++)
                g_assert_cmpfloat(vec_dist(t[i].rest[b - 1], t[i].rest[b]), <=, spacing[k] + 1e-9);
            if (s->sequence[t[i].sequence].base_radius < 0.2 * s->sequence[0].base_radius)
                g_assert_cmpuint(t[i].sides, <=, def.sides / 2);
        }
        solid_tubes_free(t, n);
        g_free(normal);
        pose_free(p);
        hand_free(s);
    }
    g_assert_cmpuint(2 * balls[0], <, nodes);
    g_assert_cmpuint(balls[1], <, balls[0]);
    g_assert_cmpuint(balls[2], <=, balls[1]);
}

static void test_petiole(void)
{
    for (int which = 0; which < 3; which++) {
        Skeleton *s = leaf(which, 2);
        Pose *p = posed(s, POSE_DROOPING, 0);
        Vec3 *normal = carried_normals(p);
        SolidDef def = solid_def_default(100);
        def.petiole_length = 30;
        def.petiole_bend = 40;
        uint32_t n, m;
        Tube *t = solid_tubes(p, normal, &def, &n);
        SolidDef none = def;
        none.petiole_length = 0;
        Tube *bare = solid_tubes(p, normal, &none, &m);
        g_assert_cmpuint(m, ==, n);
        g_assert_cmpuint(bare[0].petiole, ==, 0);
        const Tube *tube = &t[0];
        uint32_t first = tube->petiole; /* the midrib's first ball */
        g_assert_cmpuint(first, >=, 3);
        g_assert_cmpuint(tube->n, ==, first + bare[0].n);
        for (uint32_t i = 0; i < bare[0].n; i++) { /* then the midrib as it is without */
            near(vec3_dist(tube->centre[first + i], bare[0].centre[i]), 0.0, 0.0);
            near(tube->radius[first + i], bare[0].radius[i], 0.0);
        }
        /* On from its direction, without a knee. */
        Vec3 in = vec3_unit(vec3_sub(tube->centre[first], tube->centre[first + 1]), normal[0]), last = in;
        double length = 0.0, turned = 0.0;
        for (uint32_t i = first; i-- > 0;) {
            Vec3 step = vec3_sub(tube->centre[i], tube->centre[i + 1]), d = vec3_unit(step, in);
            double bend = acos(MIN(1.0, vec3_dot(d, last)));
            g_assert_cmpfloat(bend, <, 0.15);
            g_assert_cmpfloat(tube->radius[i], >=, tube->radius[i + 1]);
            g_assert_cmpuint(tube->node[i], ==, tube->node[first]);
            turned += bend;
            length += vec3_norm(step);
            last = d;
        }
        near(length, 30, 0.5);
        near(turned, 40 * DTRIG_DEGREE, 0.15); /* the midrib droops, whose course it takes: a little more */
        g_assert_cmpfloat(vec3_dot(last, normal[0]), <, -0.4); /* away from the sunny side */
        g_assert_cmpfloat(tube->radius[0], >, 1.2 * tube->radius[first]);
        g_assert_cmpfloat(tube->radius[0], <, 2.9 * tube->radius[first]);
        /* Where it meets the midrib the surface is smooth: normals of the rings before, at and after agree. */
        Surface *surface = solid_surface(t, 1, &def);
        uint32_t ends = end_rings(t, &def);
        for (uint32_t k = 0; k < def.sides; k++) {
            Vec3 a = surface->normal[1 + (ends + first - 1) * def.sides + k], b = surface->normal[1 + (ends + first) * def.sides + k];
            g_assert_cmpfloat(vec3_dot(a, b), >, 0.97);
        }
        surface_free(surface);
        solid_tubes_free(bare, m);
        solid_tubes_free(t, n);
        g_free(normal);
        pose_free(p);
        hand_free(s);
    }
    solid_tubes_free(NULL, 0);
    surface_free(NULL);
}

static void test_fictitious(void)
{
    Skeleton *s = hand_pinnate(9, 1);
    Pose *p = posed(s, POSE_FLAT, 0);
    Vec3 *normal = carried_normals(p);
    SolidDef def = solid_def_default(100);
    uint32_t n;
    s->sequence[3].fictitious = true;
    Tube *t = solid_tubes(p, normal, &def, &n);
    g_assert_cmpuint(n, ==, s->n_sequences - 1);
    g_assert_null(tube_of(t, n, 3));
    solid_tubes_free(t, n);
    for (uint32_t q = 0; q < s->n_sequences; q++)
        s->sequence[q].fictitious = true;
    t = solid_tubes(p, normal, &def, &n);
    g_assert_cmpuint(n, ==, 0);
    Surface *none = solid_surface(t, n, &def);
    g_assert_cmpuint(none->n_vertices, ==, 0);
    g_assert_cmpuint(none->n_triangles, ==, 0);
    surface_free(none);
    solid_tubes_free(t, n);
    g_free(normal);
    pose_free(p);
    hand_free(s);
}

/* Poses of one leaf have the same vertices and triangles, so that one can be made of the other; small bends move them little. */
static void test_topology(void)
{
    Skeleton *s = hand_pinnate(9, 2);
    SolidDef def = solid_def_default(100);
    Surface *last = NULL;
    Tube *last_tubes = NULL;
    uint32_t n = 0;
    for (int step = 0; step <= 20; step++) {
        PoseDef pose = pose_def_default();
        pose.kind = POSE_WITHERED;
        pose.age = 1.0;
        pose.blend = step < 20 ? step / 200.0 : 1.0;
        Pose *p = pose_new(s);
        g_assert_true(pose_apply(p, &pose, NULL));
        Vec3 *normal = carried_normals(p);
        Tube *t = solid_tubes(p, normal, &def, &n);
        Surface *now = solid_surface(t, n, &def);
        uint32_t *node = g_new(uint32_t, now->n_vertices);
        memset(node, 0xff, now->n_vertices * sizeof *node);
        solid_vertex_nodes(t, n, &def, node);
        uint32_t petiole_end = 1 + (end_rings(t, &def) + t[0].petiole) * t[0].sides;
        for (uint32_t v = 0; v < now->n_vertices; v++) {
            g_assert_cmpuint(node[v], <, s->n_nodes);
            if (v >= petiole_end) /* an edge is at most some 5 long */
                g_assert_cmpfloat(vec3_dist(now->place[v], p->place[node[v]]), <, 5.0);
        }
        if (last) {
            g_assert_cmpuint(now->n_vertices, ==, last->n_vertices);
            g_assert_cmpuint(now->n_triangles, ==, last->n_triangles);
            g_assert_true(memcmp(now->triangle, last->triangle, now->n_triangles * sizeof *now->triangle) == 0);
            for (uint32_t i = 0, first = 0; i < n && step < 20; i++) {
                g_assert_cmpuint(t[i].n, ==, last_tubes[i].n);
                for (uint32_t k = 0; k < t[i].n; k++) { /* rings keep their vertices where they were on them */
                    uint32_t v = first + 1 + (end_rings(&t[i], &def) + k) * t[i].sides;
                    Vec3 a = vec3_sub(now->place[v], t[i].centre[k]), b = vec3_sub(last->place[v], last_tubes[i].centre[k]);
                    g_assert_cmpfloat(vec3_dist(a, b), <, 0.15 * t[i].radius[k]);
                }
                first += solid_tube_triangles(&t[i], &def) / 2 + 2;
            }
        }
        g_free(node);
        surface_free(last);
        last = now;
        solid_tubes_free(last_tubes, n);
        last_tubes = t;
        g_free(normal);
        pose_free(p);
    }
    surface_free(last);
    solid_tubes_free(last_tubes, n);
    hand_free(s);
}

/* Balls that coincide and tubes that turn right about stay closed and finite. */
static void test_degenerate(void)
{
    SolidDef def = solid_def_default(100);
    Tube *t = one(straight(6, 10, 1, 1));
    t->centre[2] = t->centre[1];
    t->centre[4] = t->centre[2];
    t->centre[5] = t->centre[0];
    t->up = vec3(0, 1, 0); /* along the tube */
    Surface *s = solid_surface(t, 1, &def);
    check_closed(s);
    for (uint32_t v = 0; v < s->n_vertices; v++) {
        g_assert_true(isfinite(s->place[v].x + s->place[v].y + s->place[v].z));
        near(vec3_norm(s->normal[v]), 1.0, 1e-12);
    }
    surface_free(s);
    for (uint32_t i = 0; i < t->n; i++)
        t->centre[i] = vec3(1, 1, 1);
    s = solid_surface(t, 1, &def);
    check_closed(s);
    for (uint32_t v = 0; v < s->n_vertices; v++)
        g_assert_true(isfinite(s->place[v].x + s->normal[v].x));
    surface_free(s);
    solid_tubes_free(t, 1);
}

/* At a box's corner three faces meet at equal angles, however large they are and however they are cut into
 * triangles: the normal is the diagonal. */
static void test_normals(void)
{
    static const uint32_t face[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (uint32_t cut = 0; cut < 64; cut++) {
        Surface *s = surface_new(9, 13);
        for (uint32_t v = 0; v < 8; v++)
            s->place[v] = vec3(v & 1 ? 1 : -1, v & 2 ? 2 : -2, v & 4 ? 3 : -3);
        for (uint32_t f = 0; f < 6; f++) {
            uint32_t turn = cut >> f & 1;
            for (uint32_t k = 0; k < 2; k++) {
                uint32_t *t = s->triangle[2 * f + k];
                t[0] = face[f][turn];
                t[1] = face[f][(turn + 1 + k) % 4];
                t[2] = face[f][(turn + 2 + k) % 4];
            }
        }
        s->triangle[12][0] = 0; /* without area: no say */
        s->triangle[12][1] = s->triangle[12][2] = 7;
        surface_normals(s);
        for (uint32_t v = 0; v < 8; v++)
            near(vec3_dist(s->normal[v], vec3_scale(vec3(v & 1 ? 1 : -1, v & 2 ? 1 : -1, v & 4 ? 1 : -1), 1 / sqrt(3.0))), 0.0, 1e-14);
        g_assert_true(s->normal[8].x == 0.0 && s->normal[8].y == 0.0 && s->normal[8].z == 1.0); /* on no triangle */
        surface_free(s);
    }
}

/* A mirrored leaf has mirrored veins. */
static void test_mirror(void)
{
    Skeleton *s = hand_pinnate(9, 2);
    PoseDef pose = pose_def_default();
    pose.kind = POSE_WITHERED;
    pose.age = 0.8;
    pose.variation = 0.0;
    Pose *p = pose_new(s);
    g_assert_true(pose_apply(p, &pose, NULL));
    Vec3 *normal = carried_normals(p);
    SolidDef def = solid_def_default(100);
    uint32_t n, pairs = 0;
    Tube *t = solid_tubes(p, normal, &def, &n);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++) {
            const char *a = s->sequence[t[i].sequence].name, *b = s->sequence[t[j].sequence].name;
            if (*a != 'L' || *b != 'R' || strlen(a) != strlen(b) || a[1] != b[1] || (a[2] && a[4] != b[4]))
                continue;
            pairs++;
            g_assert_cmpuint(t[i].n, ==, t[j].n);
            for (uint32_t k = 0; k < t[i].n; k++) {
                near(t[i].radius[k], t[j].radius[k], 1e-12);
                near(vec3_dist(t[i].centre[k], vec3(-t[j].centre[k].x, t[j].centre[k].y, t[j].centre[k].z)), 0.0, 1e-9);
            }
        }
    g_assert_cmpuint(pairs, ==, 13);
    solid_tubes_free(t, n);
    g_free(normal);
    pose_free(p);
    hand_free(s);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/solid/cone", test_cone);
    g_test_add_func("/solid/frames/plane", test_frames_plane);
    g_test_add_func("/solid/frames/helix", test_frames_helix);
    g_test_add_func("/solid/leaves", test_leaves);
    g_test_add_func("/solid/offset", test_offset);
    g_test_add_func("/solid/thinning", test_thinning);
    g_test_add_func("/solid/petiole", test_petiole);
    g_test_add_func("/solid/fictitious", test_fictitious);
    g_test_add_func("/solid/topology", test_topology);
    g_test_add_func("/solid/degenerate", test_degenerate);
    g_test_add_func("/solid/mirror", test_mirror);
    g_test_add_func("/solid/normals", test_normals);
    return g_test_run();
}
