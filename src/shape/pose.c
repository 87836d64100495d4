#include "shape/pose.h"

#include <string.h>

#include "geom/dtrig.h"
#include "shape/bend.h"

G_DEFINE_QUARK(pose-error-quark, pose_error)

enum { STEPS = 64 }; /* chords that measure the spline between two controls */

Pose *pose_new(const Skeleton *s)
{
    Pose *p = g_new0(Pose, 1);
    uint32_t n = s->n_nodes;
    *p = (Pose){s, g_new(Vec3, n), g_new(Mat3, n), g_new(uint32_t, n), g_new(uint32_t, n)};
    for (uint32_t i = 0; i < n; i++) {
        p->place[i] = vec3_flat(s->rest[i]);
        p->turn[i] = mat3_identity();
        p->child[i] = p->sibling[i] = NO_PARENT;
    }
    for (uint32_t i = n; i-- > 0;) { /* backwards, so that a chain runs forwards */
        uint32_t hinge = s->hinge[i];
        if (hinge == NO_PARENT)
            continue;
        g_assert(hinge < i);
        p->sibling[i] = p->child[hinge];
        p->child[hinge] = i;
    }
    return p;
}

Pose *pose_copy(const Pose *p)
{
    Pose *copy = g_new0(Pose, 1);
    gsize n = p->skeleton->n_nodes;
    *copy = (Pose){p->skeleton, g_memdup2(p->place, n * sizeof *p->place), g_memdup2(p->turn, n * sizeof *p->turn),
                   g_memdup2(p->child, n * sizeof *p->child), g_memdup2(p->sibling, n * sizeof *p->sibling)};
    return copy;
}

void pose_free(Pose *p)
{
    if (!p)
        return;
    g_free(p->place);
    g_free(p->turn);
    g_free(p->child);
    g_free(p->sibling);
    g_free(p);
}

Mat3 pose_rotation(Vec3 axis, double angle)
{
    Vec3 a = vec3_unit(axis, vec3(0.0, 0.0, 0.0));
    if (vec3_dot(a, a) == 0.0)
        return mat3_identity();
    double s, c;
    dtrig_sin_cos(angle, &s, &c);
    double k = 1.0 - c;
    return (Mat3){vec3(c + a.x * a.x * k, a.x * a.y * k + a.z * s, a.x * a.z * k - a.y * s),
                  vec3(a.x * a.y * k - a.z * s, c + a.y * a.y * k, a.y * a.z * k + a.x * s),
                  vec3(a.x * a.z * k + a.y * s, a.y * a.z * k - a.x * s, c + a.z * a.z * k)};
}

Mat3 rotation_by(Vec3 v) { return pose_rotation(v, vec3_norm(v)); }

Mat3 rotation_compose(Mat3 a, Mat3 b)
{
    Mat3 m = mat3_mul(a, b);
    m.x = vec3_unit(m.x, vec3(1.0, 0.0, 0.0));
    m.y = vec3_sub(m.y, vec3_scale(m.x, vec3_dot(m.x, m.y)));
    m.y = vec3_unit(m.y, vec3(0.0, 1.0, 0.0));
    m.z = vec3_cross(m.x, m.y);
    return m;
}

static bool is_identity(const Mat3 *m)
{
    return m->x.x == 1.0 && m->y.y == 1.0 && m->z.z == 1.0 && m->x.y == 0.0 && m->x.z == 0.0 && m->y.x == 0.0 && m->y.z == 0.0 &&
           m->z.x == 0.0 && m->z.y == 0.0;
}

void pose_place(Pose *p, uint32_t node)
{
    const Skeleton *s = p->skeleton;
    uint32_t hinge = s->hinge[node];
    Vec3 rest = vec3_flat(s->rest[node]), from = vec3_flat(s->rest[hinge]), now = p->place[hinge];
    bool flat = now.x == from.x && now.y == from.y && now.z == 0.0 && is_identity(&p->turn[node]);
    p->place[node] = flat ? rest : vec3_add(now, mat3_apply(p->turn[node], vec3_sub(rest, from)));
}

void pose_rotate(Pose *p, uint32_t node, Vec3 axis, double angle)
{
    Mat3 r = pose_rotation(axis, angle);
    uint32_t i = node;
    for (;;) { /* preorder, so that a hinge has its place before its nodes */
        p->turn[i] = rotation_compose(r, p->turn[i]);
        if (p->skeleton->hinge[i] != NO_PARENT)
            pose_place(p, i);
        if (p->child[i] != NO_PARENT) {
            i = p->child[i];
            continue;
        }
        while (i != node && p->sibling[i] == NO_PARENT)
            i = p->skeleton->hinge[i];
        if (i == node)
            return;
        i = p->sibling[i];
    }
}

/* ---- between poses ---- */

/* Rotation vector of the turn of an edge against the one before it in b, seen from that in a. */
static Vec3 turn_between(const Pose *a, const Pose *b, uint32_t node)
{
    uint32_t hinge = a->skeleton->hinge[node];
    Mat3 from = a->turn[node], to = b->turn[node];
    if (hinge != NO_PARENT) {
        from = mat3_mul(mat3_transpose(a->turn[hinge]), from);
        to = mat3_mul(mat3_transpose(b->turn[hinge]), to);
    }
    Mat3 m = mat3_mul(mat3_transpose(from), to);
    Vec3 axis = vec3(m.y.z - m.z.y, m.z.x - m.x.z, m.x.y - m.y.x); /* times 2 sin of the angle */
    double sine = 0.5 * vec3_norm(axis), cosine = 0.5 * (m.x.x + m.y.y + m.z.z - 1.0);
    if (sine < 1e-12 && cosine < 0.0) { /* half a turn: the axis is the longest column of m + 1 */
        Vec3 c[3] = {m.x, m.y, m.z};
        c[0].x += 1.0, c[1].y += 1.0, c[2].z += 1.0;
        axis = c[0];
        for (int k = 1; k < 3; k++)
            if (vec3_dot(c[k], c[k]) > vec3_dot(axis, axis))
                axis = c[k];
    }
    return vec3_scale(vec3_unit(axis, vec3(0.0, 0.0, 0.0)), dtrig_atan2(sine, cosine));
}

Pose *pose_between(const Pose *a, const Pose *b, double part)
{
    const Skeleton *s = a->skeleton;
    Pose *p = pose_copy(a);
    for (uint32_t i = 0; i < s->n_nodes; i++) { /* hinges come first */
        uint32_t hinge = s->hinge[i];
        Mat3 local = hinge == NO_PARENT ? a->turn[i] : mat3_mul(mat3_transpose(a->turn[hinge]), a->turn[i]);
        local = rotation_compose(local, rotation_by(vec3_scale(turn_between(a, b, i), part)));
        p->turn[i] = hinge == NO_PARENT ? local : rotation_compose(p->turn[hinge], local);
        if (hinge == NO_PARENT)
            p->place[i] = vec3_lerp(a->place[i], b->place[i], part);
        else
            pose_place(p, i);
    }
    return p;
}

double pose_apart(const Pose *a, const Pose *b)
{
    const Skeleton *s = a->skeleton;
    double *sum = g_new(double, (gsize)s->n_nodes + 1), most = 0.0;
    for (uint32_t i = 0; i < s->n_nodes; i++) {
        sum[i] = vec3_norm(turn_between(a, b, i)) + (s->hinge[i] == NO_PARENT ? 0.0 : sum[s->hinge[i]]);
        most = sum[i] > most ? sum[i] : most;
    }
    g_free(sum);
    return most;
}

static bool is_flat(const PoseDef *d) { return d->blend == 0.0 || (d->kind == POSE_FLAT && !(d->rules && *d->rules)); }

bool pose_def_between(const PoseDef *a, const PoseDef *b, double part, PoseDef *between)
{
    PoseDef from = *a, to = *b;
    if (is_flat(a)) {
        from = *b;
        from.blend = 0.0;
    } else if (is_flat(b)) {
        to = *a;
        to.blend = 0.0;
    }
    if (from.kind != to.kind || from.seed != to.seed || g_strcmp0(from.rules, to.rules) != 0)
        return false;
    *between = from;
    between->strength += part * (to.strength - from.strength);
    between->age += part * (to.age - from.age);
    between->variation += part * (to.variation - from.variation);
    between->blend += part * (to.blend - from.blend);
    return true;
}

/* ---- splines ---- */

/* A natural cubic spline through `point`, by chord length, and the arc length from its start to STEPS places in each piece. */
typedef struct {
    uint32_t n;
    Vec3 *point, *bend; /* [n] places, second derivatives */
    double *step;       /* [n - 1] knot distances */
    double *arc;        /* [(n - 1) · STEPS + 1] */
} Spline;

static Vec3 spline_at(const Spline *s, uint32_t piece, double t)
{
    double u = 1.0 - t, k = s->step[piece] * s->step[piece] / 6.0;
    Vec3 straight = vec3_lerp(s->point[piece], s->point[piece + 1], t);
    Vec3 curved = vec3_add(vec3_scale(s->bend[piece], (u * u * u - u) * k), vec3_scale(s->bend[piece + 1], (t * t * t - t) * k));
    return vec3_add(straight, curved);
}

static void spline_measure(Spline *s)
{
    s->arc[0] = 0.0;
    Vec3 last = s->point[0];
    for (uint32_t i = 0; i + 1 < s->n; i++)
        for (uint32_t k = 1; k <= STEPS; k++) {
            Vec3 next = spline_at(s, i, (double)k / STEPS);
            s->arc[i * STEPS + k] = s->arc[i * STEPS + k - 1] + vec3_dist(last, next);
            last = next;
        }
}

/* Takes `point`. FALSE when all points are one. */
static bool spline_init(Spline *s, Vec3 *point, uint32_t n)
{
    double total = 0.0;
    *s = (Spline){n, point, g_new0(Vec3, n), g_new(double, n - 1), g_new(double, (gsize)(n - 1) * STEPS + 1)};
    for (uint32_t i = 0; i + 1 < n; i++)
        total += s->step[i] = vec3_dist(point[i], point[i + 1]);
    for (uint32_t i = 0; i + 1 < n; i++)
        s->step[i] = s->step[i] > 1e-9 * total ? s->step[i] : 1e-9 * total; /* points that coincide */
    if (!(total > 0.0))
        return false;
    /* Continuous curvature: a tridiagonal system for the second derivatives, by elimination; none at the ends. */
    double *above = g_new0(double, n);
    for (uint32_t i = 1; i + 1 < n; i++) {
        double h0 = s->step[i - 1], h1 = s->step[i];
        Vec3 jump = vec3_sub(vec3_scale(vec3_sub(point[i + 1], point[i]), 6.0 / h1), vec3_scale(vec3_sub(point[i], point[i - 1]), 6.0 / h0));
        double pivot = 2.0 * (h0 + h1) - h0 * above[i - 1];
        above[i] = h1 / pivot;
        s->bend[i] = vec3_scale(vec3_sub(jump, vec3_scale(s->bend[i - 1], h0)), 1.0 / pivot);
    }
    for (uint32_t i = n - 1; i-- > 1;)
        s->bend[i] = vec3_sub(s->bend[i], vec3_scale(s->bend[i + 1], above[i]));
    g_free(above);
    spline_measure(s);
    return true;
}

static void spline_clear(Spline *s)
{
    g_free(s->point);
    g_free(s->bend);
    g_free(s->step);
    g_free(s->arc);
}

/* The place at part t of the arc length of a piece. */
static Vec3 spline_mark(const Spline *s, uint32_t piece, double t)
{
    const double *arc = s->arc + (gsize)piece * STEPS;
    double want = arc[0] + t * (arc[STEPS] - arc[0]);
    uint32_t k = 0;
    while (k + 1 < STEPS && arc[k + 1] < want)
        k++;
    double chord = arc[k + 1] - arc[k], rest = chord > 0.0 ? (want - arc[k]) / chord : 0.0;
    return spline_at(s, piece, ((double)k + rest) / STEPS);
}

/* The smallest rotation that takes direction a to b, as axis times angle; `side` is perpendicular to a, for a turn right about. */
static Vec3 rotation_between(Vec3 a, Vec3 b, Vec3 side)
{
    Vec3 axis = vec3_cross(a, b);
    double angle = dtrig_atan2(vec3_norm(axis), vec3_dot(a, b));
    return vec3_scale(vec3_unit(axis, side), angle);
}

/* turned[node] = how much the subtree of each node of q goes round, from the base on. `now` is the vein as it is; a hinge rotation found
 * for the whole way is made `part` of the way, in the frame that its hinge carries. */
static void spline_turns(const Pose *p, const Sequence *q, const uint32_t *node, const double *at, const Spline *spline, double part,
                         Mat3 *turned)
{
    Mat3 whole = mat3_identity(), made = whole;
    double s = 0.0;
    uint32_t piece = 0;
    Vec3 mark = spline->point[0];
    for (uint32_t k = 1; k < q->n; k++) {
        Vec3 edge = vec3_sub(p->place[node[k]], p->place[node[k - 1]]);
        s += vec3_norm(edge);
        while (piece + 2 < spline->n && s > at[piece + 1])
            piece++;
        double t = k + 1 < q->n ? (s - at[piece]) / (at[piece + 1] - at[piece]) : 1.0;
        Vec3 next = spline_mark(spline, piece, t < 1.0 ? t : 1.0), aim = vec3_sub(next, mark);
        if (vec3_dot(aim, aim) > 0.0) {
            Vec3 wanted = mat3_apply(mat3_transpose(whole), aim); /* in the frame before the spline */
            Vec3 v = rotation_between(edge, wanted, p->turn[node[k]].z);
            whole = rotation_compose(whole, rotation_by(v));
            made = rotation_compose(made, rotation_by(vec3_scale(v, part)));
        }
        turned[node[k]] = made;
        mark = next;
    }
}

void pose_spline_at(Pose *p, uint32_t q, const double *at, const Vec3 *target, uint32_t n, double part)
{
    const Skeleton *s = p->skeleton;
    const Sequence *seq = &s->sequence[q];
    const uint32_t *node = s->at + seq->first;
    Spline spline;
    Vec3 *point = g_memdup2(target, n * sizeof *target);
    point[0] = p->place[node[0]];
    if (spline_init(&spline, point, n)) {
        bool *on_vein = g_new0(bool, s->n_nodes), *moved = g_new0(bool, s->n_nodes);
        Mat3 *turned = g_new(Mat3, s->n_nodes);
        spline_turns(p, seq, node, at, &spline, part, turned);
        for (uint32_t k = 1; k < seq->n; k++)
            on_vein[node[k]] = true;
        for (uint32_t i = node[1]; i < s->n_nodes; i++) {
            if (!on_vein[i]) {
                if (s->hinge[i] == NO_PARENT || !moved[s->hinge[i]])
                    continue;
                turned[i] = turned[s->hinge[i]];
            }
            moved[i] = true;
            p->turn[i] = rotation_compose(turned[i], p->turn[i]);
            pose_place(p, i);
        }
        g_free(turned);
        g_free(moved);
        g_free(on_vein);
    }
    spline_clear(&spline);
}

void pose_spline(Pose *p, uint32_t q, const uint32_t *control, const Vec3 *target, uint32_t n)
{
    const Sequence *seq = &p->skeleton->sequence[q];
    const uint32_t *node = p->skeleton->at + seq->first;
    g_assert(n >= 2 && control[0] == 0 && control[n - 1] == seq->n - 1);
    double *at = g_new(double, n), s = 0.0;
    at[0] = 0.0;
    for (uint32_t k = 1, c = 1; k < seq->n; k++) {
        s += vec_dist(p->skeleton->rest[node[k - 1]], p->skeleton->rest[node[k]]);
        if (k == control[c])
            at[c++] = s;
    }
    pose_spline_at(p, q, at, target, n, 1.0);
    g_free(at);
}
