#include "shape/solid.h"

#include "geom/dtrig.h"
#include "shape/bend.h"

enum { FLARE_BALLS = 4, PETIOLE_BALLS = 24 };

static const double flare = 0.6;         /* a branch widens by this part of its radius towards its parent … */
static const double flare_reach = 3.0;   /* … from this many radii outside the parent's tube */
static const double within = 0.92;       /* of the parent's radius: the widest a branch may be where it begins */
static const double petiole_widening = 0.3, petiole_widest = 1.6, petiole_gather = 0.06;

SolidDef solid_def_default(double leaf_length)
{
    return (SolidDef){.scale = 1.0, .offset = 0.85, .least_radius = 0.0008 * leaf_length, .petiole_length = 0.35 * leaf_length,
                      .petiole_bend = 25.0, .sides = 10};
}

/* A ball of some sequence at a node: what a branch from there must begin within. */
typedef struct {
    double radius, depth; /* 0, 0: no tube there */
} Ball;

static Tube tube_new(uint32_t sequence, uint32_t n)
{
    return (Tube){sequence, n, g_new(Vec3, n), g_new(Vec2, n), g_new(double, n), g_new(uint32_t, n), vec3(0.0, 0.0, 1.0)};
}

void solid_tubes_free(Tube *t, uint32_t n)
{
    for (uint32_t i = 0; t && i < n; i++) {
        g_free(t[i].centre);
        g_free(t[i].rest);
        g_free(t[i].radius);
        g_free(t[i].node);
    }
    g_free(t);
}

static double node_radius(const Skeleton *s, const Sequence *q, uint32_t k, const SolidDef *def)
{
    double r = def->scale * (k == 0 ? q->base_radius : s->radius[s->at[q->first + k]]);
    return r > def->least_radius ? r : def->least_radius;
}

/* How a branch widens and sinks towards where it begins: what is added there, and how far out it is felt. */
typedef struct {
    double reach, radius, depth;
} Junction;

static Junction junction(Ball parent, double radius, double length, const SolidDef *def)
{
    if (!(parent.radius > 0.0))
        return (Junction){0.0, 0.0, 0.0};
    /* The parent's tube has flat sides: nearer to its axis than its radius. */
    double room = parent.radius * dtrig_cos(DTRIG_PI / def->sides);
    double first = MIN((1.0 + flare) * radius, within * room), slack = room - first;
    double depth = CLAMP(def->offset * first, parent.depth - slack, parent.depth + slack);
    double reach = MIN(parent.radius + flare_reach * radius, 0.5 * length);
    return (Junction){reach, first - radius, depth - def->offset * first};
}

/* Arc lengths of a tube's balls: the nodes, and some more near the junction, where it is curved. stop[] ascends; edge[] is the node before, or at,
 * each. Returns how many there are. */
static uint32_t place_balls(const double *arc, uint32_t n, Junction j, double *stop, uint32_t *edge)
{
    uint32_t count = 0, next = 1;
    for (uint32_t k = 0; k < n; k++) {
        for (; next <= FLARE_BALLS && j.reach > 0.0; next++) {
            double s = j.reach * next / FLARE_BALLS, apart = 0.3 * j.reach / FLARE_BALLS;
            if (k == 0 || s >= arc[k])
                break;
            if (s - stop[count - 1] > apart && arc[k] - s > apart) {
                edge[count] = k - 1;
                stop[count++] = s;
            }
        }
        edge[count] = k;
        stop[count++] = arc[k];
    }
    return count;
}

static void set_ball(Tube *t, uint32_t i, const Pose *p, const Vec3 *normal, const SolidDef *def, const double *arc, double stop, uint32_t k,
                     Junction j, Ball *ball)
{
    const Skeleton *s = p->skeleton;
    const Sequence *q = &s->sequence[t->sequence];
    const uint32_t *node = s->at + q->first;
    uint32_t m = k + 1 < q->n ? k + 1 : k;
    double f = m > k && arc[m] > arc[k] ? (stop - arc[k]) / (arc[m] - arc[k]) : 0.0;
    double own = node_radius(s, q, k, def) + f * (node_radius(s, q, m, def) - node_radius(s, q, k, def));
    double near = stop < j.reach ? 1.0 - stop / j.reach : 0.0;
    double radius = own + near * near * j.radius, depth = def->offset * radius + near * near * j.depth;
    Vec3 up = vec3_unit(vec3_lerp(normal[node[k]], normal[node[m]], f), normal[node[k]]);
    t->centre[i] = vec3_sub(vec3_lerp(p->place[node[k]], p->place[node[m]], f), vec3_scale(up, depth));
    t->rest[i] = vec_lerp(s->rest[node[k]], s->rest[node[m]], f);
    t->radius[i] = radius;
    t->node[i] = f < 0.5 ? node[k] : node[m];
    if (f == 0.0 && !(ball[node[k]].radius > 0.0))
        ball[node[k]] = (Ball){radius, depth};
}

static Tube sequence_tube(const Pose *p, const Vec3 *normal, const SolidDef *def, uint32_t q, Ball *ball)
{
    const Skeleton *s = p->skeleton;
    const Sequence *seq = &s->sequence[q];
    const uint32_t *node = s->at + seq->first;
    double *arc = g_new(double, seq->n), *stop = g_new(double, seq->n + FLARE_BALLS);
    uint32_t *edge = g_new(uint32_t, seq->n + FLARE_BALLS);
    arc[0] = 0.0;
    for (uint32_t k = 1; k < seq->n; k++)
        arc[k] = arc[k - 1] + vec_dist(s->rest[node[k - 1]], s->rest[node[k]]);
    Junction j = junction(ball[node[0]], node_radius(s, seq, 0, def), arc[seq->n - 1], def);
    Tube t = tube_new(q, place_balls(arc, seq->n, j, stop, edge));
    t.up = normal[node[0]];
    for (uint32_t i = 0; i < t.n; i++)
        set_ball(&t, i, p, normal, def, arc, stop[i], edge[i], j, ball);
    g_free(arc);
    g_free(stop);
    g_free(edge);
    return t;
}

static double smooth(double t)
{
    t = CLAMP(t, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

/* Where primaries come together the petiole has room for all of them: equal cross-sections (Murray's law with exponent 2). */
static double gathered_radius(const Skeleton *s, const SolidDef *def, uint32_t midrib)
{
    uint32_t root = s->at[s->sequence[midrib].first];
    double sum = 0.0, r = node_radius(s, &s->sequence[midrib], 0, def);
    for (uint32_t q = 0; q < s->n_sequences; q++) {
        const Sequence *seq = &s->sequence[q];
        if (seq->parent != NO_PARENT || s->at[seq->first] != root || seq->fictitious)
            continue;
        double one = node_radius(s, seq, 0, def);
        sum += one * one;
    }
    double all = sqrt(sum);
    return CLAMP(all, r, petiole_widest * r);
}

/* Goes on from the midrib backwards, and bends down evenly. */
static Tube petiole_tube(const Tube *midrib, const SolidDef *def, double gathered)
{
    Tube t = tube_new(NO_PARENT, PETIOLE_BALLS + 1);
    Vec3 base = midrib->centre[0], back = vec3_unit(vec3_sub(base, midrib->centre[1]), vec3(0.0, -1.0, 0.0));
    Vec3 up = vec3_sub(midrib->up, vec3_scale(back, vec3_dot(midrib->up, back)));
    up = vec3_unit(up, vec3_cross(back, vec3(1.0, 0.0, 0.0)));
    double radius = midrib->radius[0], step = def->petiole_length / (PETIOLE_BALLS - 1);
    t.up = up;
    t.centre[0] = vec3_sub(base, vec3_scale(back, radius));
    t.radius[0] = within * radius;
    Vec3 at = base;
    for (uint32_t i = 1; i <= PETIOLE_BALLS; i++) {
        double part = (double)(i - 1) / (PETIOLE_BALLS - 1), s, c;
        t.centre[i] = at;
        t.radius[i] = (radius + (gathered - radius) * smooth(part / petiole_gather)) * (1.0 + petiole_widening * part * part * part);
        dtrig_sin_cos(def->petiole_bend * DTRIG_DEGREE * (part + 0.5 / (PETIOLE_BALLS - 1)), &s, &c);
        at = vec3_add(at, vec3_scale(vec3_sub(vec3_scale(back, c), vec3_scale(up, s)), step));
    }
    for (uint32_t i = 0; i < t.n; i++) {
        t.rest[i] = midrib->rest[MIN(1, midrib->n - 1)]; /* at the base itself the map may already show what is beside the leaf */
        t.node[i] = midrib->node[0];
    }
    return t;
}

/* The one called so, else the longest. */
static uint32_t find_midrib(const Skeleton *s)
{
    Layout *l = layout_new(s);
    uint32_t q = l->midrib;
    layout_free(l);
    return q;
}

Tube *solid_tubes(const Pose *p, const Vec3 *normal, const SolidDef *def, uint32_t *n_tubes)
{
    const Skeleton *s = p->skeleton;
    Tube *tubes = g_new0(Tube, (gsize)s->n_sequences + 1);
    Ball *ball = g_new0(Ball, s->n_nodes);
    uint32_t midrib = find_midrib(s), n = def->petiole_length > 0.0 ? 1 : 0, midrib_tube = NO_PARENT;
    for (uint32_t pass = 0; pass < 2; pass++) /* the midrib first: other primaries may leave its first node */
        for (uint32_t q = 0; q < s->n_sequences; q++) {
            if (s->sequence[q].fictitious || (q == midrib) != (pass == 0))
                continue;
            if (q == midrib)
                midrib_tube = n;
            tubes[n++] = sequence_tube(p, normal, def, q, ball);
        }
    if (def->petiole_length > 0.0) {
        if (midrib_tube != NO_PARENT) {
            tubes[0] = petiole_tube(&tubes[midrib_tube], def, gathered_radius(s, def, midrib));
        } else { /* nothing drawn to go on from */
            for (uint32_t i = 1; i < n; i++)
                tubes[i - 1] = tubes[i];
            n--;
        }
    }
    g_free(ball);
    *n_tubes = n;
    return tubes;
}

/* Rings of a round end, between the outermost full ring and the pole. */
static uint32_t end_rings(const SolidDef *def) { return MAX(1, def->sides / 5); }

static uint32_t tube_rings(const Tube *t, const SolidDef *def) { return t->n + 2 * end_rings(def); }

static uint32_t tube_vertices(const Tube *t, const SolidDef *def) { return tube_rings(t, def) * def->sides + 2; }

static Vec3 tangent_at(const Tube *t, uint32_t i, Vec3 otherwise)
{
    Vec3 none = vec3(0.0, 0.0, 0.0);
    Vec3 before = i > 0 ? vec3_unit(vec3_sub(t->centre[i], t->centre[i - 1]), none) : none;
    Vec3 after = i + 1 < t->n ? vec3_unit(vec3_sub(t->centre[i + 1], t->centre[i]), none) : none;
    Vec3 sum = vec3_add(before, after);
    return vec3_dot(sum, sum) > 1e-12 ? vec3_unit(sum, otherwise) : otherwise; /* right about: as it came */
}

static Vec3 perpendicular(Vec3 a, Vec3 tangent)
{
    Vec3 axis = fabs(tangent.x) < 0.6 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0);
    Vec3 flat = vec3_sub(a, vec3_scale(tangent, vec3_dot(a, tangent)));
    if (vec3_dot(flat, flat) > 1e-12)
        return vec3_unit(flat, axis);
    return vec3_unit(vec3_cross(tangent, axis), axis);
}

static Vec3 reflect(Vec3 a, Vec3 mirror, double square) { return vec3_sub(a, vec3_scale(mirror, 2.0 * vec3_dot(a, mirror) / square)); }

/* Carries the frame's `up` on without twist: two reflections (Wang, Jüttler, Zheng and Liu 2008, Computation of rotation minimizing frames). */
static Vec3 carry_up(Vec3 up, Vec3 from, Vec3 to, Vec3 t0, Vec3 t1)
{
    Vec3 step = vec3_sub(to, from);
    double square = vec3_dot(step, step);
    if (square > 0.0) {
        up = reflect(up, step, square);
        t0 = reflect(t0, step, square);
    }
    Vec3 rest = vec3_sub(t1, t0);
    square = vec3_dot(rest, rest);
    return perpendicular(square > 0.0 ? reflect(up, rest, square) : up, t1);
}

/* Writes vertices and triangles; `circle` holds cosine and sine of each side. */
typedef struct {
    Surface *s;
    const Vec2 *circle;
    uint32_t sides, n_vertices, n_triangles;
} Writer;

static void add_triangle(Writer *w, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *t = w->s->triangle[w->n_triangles++];
    t[0] = a;
    t[1] = b;
    t[2] = c;
}

static void add_vertex(Writer *w, Vec3 place, Vec2 uv)
{
    w->s->place[w->n_vertices] = place;
    w->s->uv[w->n_vertices++] = uv;
}

/* The ring, and its triangles to the one before, or to the pole before. */
static void add_ring(Writer *w, Vec3 centre, Vec3 u, Vec3 tangent, double radius, Vec2 uv, bool after_pole)
{
    Vec3 v = vec3_cross(tangent, u);
    uint32_t first = w->n_vertices, before = first - (after_pole ? 1 : w->sides);
    for (uint32_t j = 0; j < w->sides; j++) {
        Vec3 out = vec3_add(vec3_scale(u, w->circle[j].x), vec3_scale(v, w->circle[j].y));
        uint32_t k = j + 1 < w->sides ? j + 1 : 0;
        add_vertex(w, vec3_add(centre, vec3_scale(out, radius)), uv);
        if (after_pole) {
            add_triangle(w, before, first + k, first + j);
        } else {
            add_triangle(w, before + j, before + k, first + j);
            add_triangle(w, before + k, first + k, first + j);
        }
    }
}

static void add_tube(Writer *w, const Tube *t, const SolidDef *def)
{
    uint32_t ends = end_rings(def), last = t->n - 1;
    Vec3 tangent = tangent_at(t, 0, vec3(0.0, 1.0, 0.0)), up = perpendicular(t->up, tangent);
    add_vertex(w, vec3_sub(t->centre[0], vec3_scale(tangent, t->radius[0])), t->rest[0]);
    for (uint32_t k = ends; k >= 1; k--) {
        double s, c;
        dtrig_sin_cos(0.5 * DTRIG_PI * k / (ends + 1), &s, &c);
        add_ring(w, vec3_sub(t->centre[0], vec3_scale(tangent, s * t->radius[0])), up, tangent, c * t->radius[0], t->rest[0], k == ends);
    }
    add_ring(w, t->centre[0], up, tangent, t->radius[0], t->rest[0], false);
    for (uint32_t i = 1; i < t->n; i++) {
        Vec3 next = tangent_at(t, i, tangent);
        up = carry_up(up, t->centre[i - 1], t->centre[i], tangent, next);
        tangent = next;
        add_ring(w, t->centre[i], up, tangent, t->radius[i], t->rest[i], false);
    }
    for (uint32_t k = 1; k <= ends; k++) {
        double s, c;
        dtrig_sin_cos(0.5 * DTRIG_PI * k / (ends + 1), &s, &c);
        add_ring(w, vec3_add(t->centre[last], vec3_scale(tangent, s * t->radius[last])), up, tangent, c * t->radius[last], t->rest[last], false);
    }
    add_vertex(w, vec3_add(t->centre[last], vec3_scale(tangent, t->radius[last])), t->rest[last]);
    uint32_t pole = w->n_vertices - 1, ring = pole - w->sides;
    for (uint32_t j = 0; j < w->sides; j++)
        add_triangle(w, pole, ring + j, ring + (j + 1 < w->sides ? j + 1 : 0));
}

Surface *solid_surface(const Tube *t, uint32_t n_tubes, const SolidDef *def)
{
    g_assert(def->sides >= 3 && def->sides <= 64);
    uint32_t vertices = 0;
    for (uint32_t i = 0; i < n_tubes; i++)
        vertices += tube_vertices(&t[i], def);
    Vec2 circle[64];
    for (uint32_t j = 0; j < def->sides; j++)
        dtrig_sin_cos(2.0 * DTRIG_PI * j / def->sides, &circle[j].y, &circle[j].x);
    /* A closed surface of Euler characteristic 2: triangles = 2 (vertices − 2). */
    Writer w = {surface_new(vertices, 2 * (vertices - 2 * n_tubes)), circle, def->sides, 0, 0};
    for (uint32_t i = 0; i < n_tubes; i++)
        add_tube(&w, &t[i], def);
    g_assert(w.n_vertices == vertices && w.n_triangles == w.s->n_triangles);
    surface_normals(w.s);
    return w.s;
}

void solid_vertex_nodes(const Tube *t, uint32_t n_tubes, const SolidDef *def, uint32_t *node)
{
    uint32_t n = 0, ends = end_rings(def);
    for (uint32_t i = 0; i < n_tubes; i++) {
        for (uint32_t k = 0; k < 1 + ends * def->sides; k++)
            node[n++] = t[i].node[0];
        for (uint32_t k = 0; k < t[i].n * def->sides; k++)
            node[n++] = t[i].node[k / def->sides];
        for (uint32_t k = 0; k < 1 + ends * def->sides; k++)
            node[n++] = t[i].node[t[i].n - 1];
    }
}
