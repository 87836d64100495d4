#include "shape/solid.h"

#include "geom/dtrig.h"
#include "geom/segment.h"
#include "shape/bend.h"

enum { FLARE_BALLS = 4, PETIOLE_LEAST = 3, PETIOLE_MOST = 24, LEAST_SIDES = 3 };

static const double flare = 0.6;         /* a branch widens by this part of its radius towards its parent … */
static const double flare_reach = 3.0;   /* … from this many radii outside the parent's tube */
static const double within = 0.92;       /* of the parent's radius: the widest a branch may be where it begins */
static const double petiole_widening = 0.3, petiole_widest = 2.2, petiole_gather = 0.08;
static const double petiole_primaries = 0.08; /* of the leaf length: as far from the base primaries may begin */
static const double petiole_aim = 0.1;    /* it takes the direction of this part of the midrib, whose first edge may lie askew … */
static const double petiole_swing = 0.25; /* … within this part of its length */
static const double lateral = 0.3, thickness = 0.06; /* a ball may be left out when the vein is off by no more than this, in its radii */

SolidDef solid_def_default(double leaf_length)
{
    return (SolidDef){.scale = 1.0, .offset = 0.85, .least_radius = 0.0008 * leaf_length, .petiole_length = 0.35 * leaf_length,
                      .petiole_bend = 25.0, .sides = 10, .spacing = 0.05 * leaf_length};
}

/* A ball of some sequence at a node: what a branch from there must begin within. */
typedef struct {
    double radius, depth; /* 0, 0: no tube there */
    uint32_t sides;
} Ball;

/* What the tubes of a leaf have in common. */
typedef struct {
    const Pose *p;
    const Vec3 *normal;
    const SolidDef *def;
    uint32_t midrib; /* sequence */
    double stoutest; /* radius that a vein begins with, segments */
    Ball *ball;      /* [n_nodes] */
    bool *fork;      /* [n_nodes] a drawn branch leaves here */
} Maker;

static Tube tube_new(uint32_t sequence, uint32_t n)
{
    return (Tube){sequence, n, g_new(Vec3, n), g_new(Vec2, n), g_new(double, n), g_new(uint32_t, n), vec3(0.0, 0.0, 1.0), 0, 0, false};
}

void solid_tube_clear(Tube *t)
{
    g_free(t->centre);
    g_free(t->rest);
    g_free(t->radius);
    g_free(t->node);
}

void solid_tubes_free(Tube *t, uint32_t n)
{
    for (uint32_t i = 0; t && i < n; i++)
        solid_tube_clear(&t[i]);
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
    double room = parent.radius * dtrig_cos(DTRIG_PI / parent.sides);
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

/* What a tube is like at one stop. */
typedef struct {
    Vec2 rest;
    double arc, radius, depth;
    uint32_t from, to; /* nodes that it lies between … */
    double part;       /* … and where */
} Stop;

static Stop stop_at(const Maker *m, const Sequence *q, const double *arc, double at, uint32_t k, Junction j)
{
    const Skeleton *s = m->p->skeleton;
    const uint32_t *node = s->at + q->first;
    uint32_t next = k + 1 < q->n ? k + 1 : k;
    double f = next > k && arc[next] > arc[k] ? (at - arc[k]) / (arc[next] - arc[k]) : 0.0;
    double a = node_radius(s, q, k, m->def), b = node_radius(s, q, next, m->def), near = at < j.reach ? 1.0 - at / j.reach : 0.0;
    Stop t = {.rest = vec_lerp(s->rest[node[k]], s->rest[node[next]], f), .arc = at, .from = node[k], .to = node[next], .part = f};
    t.radius = a + f * (b - a) + near * near * j.radius;
    t.depth = m->def->offset * t.radius + near * near * j.depth;
    return t;
}

/* Whether the tube is much the same without the stops between a and b. */
static bool can_skip(const Maker *m, const Stop *stop, uint32_t a, uint32_t b)
{
    const Stop *from = &stop[a], *to = &stop[b];
    double way = to->arc - from->arc;
    if (m->def->spacing > 0.0 && way > m->def->spacing)
        return false;
    for (uint32_t i = a + 1; i < b; i++) {
        double f = (stop[i].arc - from->arc) / way, r = stop[i].radius;
        if (m->fork[stop[i].from] && stop[i].part == 0.0)
            return false;
        if (segment_dist2(from->rest, to->rest, stop[i].rest) > lateral * lateral * r * r)
            return false;
        if (fabs(from->radius + f * (to->radius - from->radius) - r) > thickness * r ||
            fabs(from->depth + f * (to->depth - from->depth) - stop[i].depth) > thickness * r)
            return false;
    }
    return true;
}

/* Keeps the stops that the tube needs, from each as far on as can be; returns how many they are. By the flat leaf, so that all poses agree. */
static uint32_t thin_stops(const Maker *m, Stop *stop, uint32_t n)
{
    uint32_t kept = 1, last = 0;
    while (last + 1 < n) {
        uint32_t next = last + 1;
        while (next + 1 < n && can_skip(m, stop, last, next + 1))
            next++;
        stop[kept++] = stop[next];
        last = next;
    }
    return kept;
}

static void set_ball(const Maker *m, Tube *t, uint32_t i, const Stop *s)
{
    Vec3 up = vec3_unit(vec3_lerp(m->normal[s->from], m->normal[s->to], s->part), m->normal[s->from]);
    t->centre[i] = vec3_sub(vec3_lerp(m->p->place[s->from], m->p->place[s->to], s->part), vec3_scale(up, s->depth));
    t->rest[i] = s->rest;
    t->radius[i] = s->radius;
    t->node[i] = s->part < 0.5 ? s->from : s->to;
}

/* Thinner tubes have fewer sides: a polygon of n sides misses its circle by about 5 r / n². */
static uint32_t sides_of(const Maker *m, const Sequence *q)
{
    if (q == &m->p->skeleton->sequence[m->midrib])
        return m->def->sides;
    double r = node_radius(m->p->skeleton, q, q->n / 2, m->def), n = floor(m->def->sides * sqrt(r / m->stoutest) + 0.5);
    return MIN(m->def->sides, MAX(LEAST_SIDES, (uint32_t)n));
}

static Tube sequence_tube(const Maker *m, uint32_t q)
{
    const Skeleton *s = m->p->skeleton;
    const Sequence *seq = &s->sequence[q];
    const uint32_t *node = s->at + seq->first;
    double *arc = g_new(double, seq->n), *at = g_new(double, seq->n + FLARE_BALLS);
    uint32_t *edge = g_new(uint32_t, seq->n + FLARE_BALLS), sides = sides_of(m, seq);
    arc[0] = 0.0;
    for (uint32_t k = 1; k < seq->n; k++)
        arc[k] = arc[k - 1] + vec_dist(s->rest[node[k - 1]], s->rest[node[k]]);
    Junction j = junction(m->ball[node[0]], node_radius(s, seq, 0, m->def), arc[seq->n - 1], m->def);
    uint32_t n = place_balls(arc, seq->n, j, at, edge);
    Stop *stop = g_new(Stop, n);
    for (uint32_t i = 0; i < n; i++) {
        stop[i] = stop_at(m, seq, arc, at[i], edge[i], j);
        Ball *b = &m->ball[stop[i].from];
        if (stop[i].part == 0.0 && !(b->radius > 0.0))
            *b = (Ball){stop[i].radius, stop[i].depth, sides};
    }
    n = thin_stops(m, stop, n);
    Tube t = tube_new(q, n);
    t.up = m->normal[node[0]];
    t.sides = sides;
    t.inside = j.reach > 0.0;
    for (uint32_t i = 0; i < n; i++)
        set_ball(m, &t, i, &stop[i]);
    g_free(arc);
    g_free(at);
    g_free(edge);
    g_free(stop);
    return t;
}

static double smooth(double t)
{
    t = CLAMP(t, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

/* Where primaries come together the petiole has room for all of them: equal cross-sections (Murray's law with exponent 2). They begin where the
 * midrib does, or leave it near there. */
static double gathered_radius(const Skeleton *s, const SolidDef *def, uint32_t midrib)
{
    uint32_t root = s->at[s->sequence[midrib].first];
    double sum = 0.0, r = node_radius(s, &s->sequence[midrib], 0, def), near = petiole_primaries * s->length;
    if (def->petiole_radius > 0.0)
        return MAX(def->petiole_radius, r);
    for (uint32_t q = 0; q < s->n_sequences; q++) {
        const Sequence *seq = &s->sequence[q];
        uint32_t first = s->at[seq->first];
        bool primary = seq->order == s->sequence[midrib].order && vec_dist2(s->rest[first], s->rest[root]) <= near * near;
        if (seq->fictitious || (first != root && !primary))
            continue;
        double one = node_radius(s, seq, 0, def);
        sum += one * one;
    }
    double all = sqrt(sum);
    return CLAMP(all, r, petiole_widest * r);
}

/* How the petiole goes on from the midrib: first, and a little farther on as the midrib lies by and large; and what is up there. */
static void petiole_frame(const Tube *midrib, Vec3 *first, Vec3 *back, Vec3 *up)
{
    double whole = 0.0, way = 0.0;
    uint32_t i = 0;
    for (uint32_t k = 1; k < midrib->n; k++)
        whole += vec_dist(midrib->rest[k - 1], midrib->rest[k]);
    do {
        i++;
        way += vec_dist(midrib->rest[i - 1], midrib->rest[i]);
    } while (i + 1 < midrib->n && way < petiole_aim * whole);
    *first = vec3_unit(vec3_sub(midrib->centre[0], midrib->centre[1]), vec3(0.0, -1.0, 0.0));
    *back = vec3_unit(vec3_sub(midrib->centre[0], midrib->centre[i]), *first);
    if (vec3_dot(*back, *first) < 0.5) /* the midrib is rolled up */
        *back = *first;
    *up = vec3_sub(midrib->up, vec3_scale(*back, vec3_dot(midrib->up, *back)));
    *up = vec3_unit(*up, vec3_cross(*back, vec3(1.0, 0.0, 0.0)));
}

/* The midrib with the petiole before it, one tube from the petiole's far end to the leaf's tip. The petiole bends down evenly; its balls
 * stand closer near the blade, where it gathers the veins. */
static Tube with_petiole(Tube midrib, const SolidDef *def, double gathered)
{
    double wanted = def->spacing > 0.0 ? ceil(1.4 * def->petiole_length / def->spacing) : PETIOLE_MOST, before = 0.0;
    uint32_t n = (uint32_t)CLAMP(wanted, PETIOLE_LEAST, PETIOLE_MOST);
    Tube t = tube_new(midrib.sequence, n + midrib.n);
    Vec3 at = midrib.centre[0], first, back, up;
    petiole_frame(&midrib, &first, &back, &up);
    for (uint32_t i = 1; i <= n; i++) {
        double x = (double)i / n, part = x * (0.4 + 0.6 * x), s, c;
        dtrig_sin_cos(def->petiole_bend * DTRIG_DEGREE * 0.5 * (before + part), &s, &c);
        Vec3 straight = vec3_unit(vec3_lerp(first, back, smooth(0.5 * (before + part) / petiole_swing)), back);
        at = vec3_add(at, vec3_scale(vec3_sub(vec3_scale(straight, c), vec3_scale(up, s)), def->petiole_length * (part - before)));
        before = part;
        t.centre[n - i] = at;
        t.radius[n - i] = (midrib.radius[0] + (gathered - midrib.radius[0]) * smooth(part / petiole_gather)) *
                          (1.0 + petiole_widening * part * part * part);
        t.rest[n - i] = midrib.rest[1]; /* at the base itself the map may already show what is beside the leaf */
        t.node[n - i] = midrib.node[0];
        if (i == n)
            t.up = vec3_add(vec3_scale(up, c), vec3_scale(back, s));
    }
    for (uint32_t i = 0; i < midrib.n; i++) {
        t.centre[n + i] = midrib.centre[i];
        t.radius[n + i] = midrib.radius[i];
        t.rest[n + i] = midrib.rest[i];
        t.node[n + i] = midrib.node[i];
    }
    t.petiole = n;
    t.sides = midrib.sides;
    solid_tube_clear(&midrib);
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

static Maker maker(const Pose *p, const Vec3 *normal, const SolidDef *def)
{
    const Skeleton *s = p->skeleton;
    Maker m = {p, normal, def, find_midrib(s), 0.0, g_new0(Ball, s->n_nodes), g_new0(bool, s->n_nodes)};
    for (uint32_t q = 0; q < s->n_sequences; q++) {
        if (s->sequence[q].fictitious)
            continue;
        m.fork[s->at[s->sequence[q].first]] = true;
        m.stoutest = fmax(m.stoutest, node_radius(s, &s->sequence[q], 0, def));
    }
    return m;
}

Tube *solid_tubes(const Pose *p, const Vec3 *normal, const SolidDef *def, uint32_t *n_tubes)
{
    const Skeleton *s = p->skeleton;
    Tube *tubes = g_new0(Tube, (gsize)s->n_sequences + 1);
    Maker m = maker(p, normal, def);
    uint32_t midrib = m.midrib, n = 0;
    for (uint32_t pass = 0; pass < 2; pass++) /* the midrib first: other primaries may leave its first node */
        for (uint32_t q = 0; q < s->n_sequences; q++)
            if (!s->sequence[q].fictitious && (q == midrib) == (pass == 0))
                tubes[n++] = sequence_tube(&m, q);
    if (def->petiole_length > 0.0 && n > 0 && tubes[0].sequence == midrib)
        tubes[0] = with_petiole(tubes[0], def, gathered_radius(s, def, midrib));
    g_free(m.ball);
    g_free(m.fork);
    *n_tubes = n;
    return tubes;
}
