/* The part of a stroke in a pixel. */
#include "image/convex.h"
#include "geom/wide.h"

/* Bisection of the quadrants: square roots only. */
Circle *circle_new(void)
{
    Circle *c = g_new(Circle, 1);
    uint32_t q = CIRCLE / 4;
    c->dir[0] = vec2(1.0, 0.0);
    c->dir[q] = vec2(0.0, 1.0);
    for (uint32_t step = q; step > 1; step /= 2)
        for (uint32_t i = 0; i < q; i += step) {
            Vec2 m = vec_add(c->dir[i], c->dir[i + step]);
            c->dir[i + step / 2] = vec_scale(m, 1.0 / sqrt(vec_norm2(m)));
        }
    for (uint32_t i = 0; i < 3 * q; i++)
        c->dir[i + q] = vec2(-c->dir[i].y, c->dir[i].x);
    return c;
}

/* Sides, a power of two, of the regular polygon that stands for a disc: the area between it and the disc, along one pixel, stays below
 * about 1e-4; see also the radius in cut_disc. */
static uint32_t disc_sides(double r)
{
    uint32_t n = 8;
    while (n < CIRCLE / 2 && (double)n * n * n < 100000.0 * r * r)
        n *= 2;
    return n;
}

/* Which of the sides, `step` directions of the circle apart, faces d best, by bisection on the side of a direction that d lies on. */
static uint32_t facing_side(const Circle *c, Vec2 d, uint32_t step)
{
    uint32_t q = CIRCLE / 4, lo = d.y >= 0.0 ? (d.x > 0.0 ? 0 : q) : (d.x < 0.0 ? 2 * q : 3 * q);
    for (uint32_t part = q / 2; part >= step / 2; part /= 2)
        lo += vec_cross(c->dir[lo + part], d) >= 0.0 ? part : 0;
    return (lo + step / 2) / step;
}

/* Of some sides of the polygon around a stroke. */
enum { SIDES = 16 };
typedef struct {
    double x[SIDES], y[SIDES], bound[SIDES]; /* half-planes x, y · p <= bound */
    double facing[SIDES];                    /* from the disc's centre to the corner of the pixel that is farthest that way, at most */
    double farthest[SIDES];                  /* of the points of a polygon that is to be cut */
} Sides;

/* An end of a stroke, seen from the pixel's corner. */
typedef struct {
    Vec2 own, other; /* centres of its disc and of the other end's */
    double r, other_r, dent;
    uint32_t n, step, mid; /* sides, directions of the circle from one to the next, and the side that faces the pixel */
} End;

/* The sides from number i on, in order from the middle to both sides in turn; n <= SIDES of them. */
WIDE static void list_sides(const Union *u, const Capsule *k, const End *e, uint32_t i, uint32_t n, Sides *restrict s)
{
    const Vec2 *v = u->ping->v;
    Vec2 left = capsule_normal(k, 1.0), right = capsule_normal(k, -1.0), to = vec_sub(vec2(0.5, 0.5), e->own);
    /* Next to the straight sides the polygon keeps clear of them. */
    double turn = k->length > 0.0 ? u->circle->dir[e->step].x : 2.0, near = e->r * e->dent, far = e->r * 1.0;
    for (uint32_t j = 0; j < n; j++, i++) {
        uint32_t at = (e->mid + (i % 2 != 0 ? e->n - (i + 1) / 2 : i / 2)) & (e->n - 1);
        s->x[j] = u->circle->dir[at * e->step].x;
        s->y[j] = u->circle->dir[at * e->step].y;
        s->farthest[j] = -(double)INFINITY;
    }
    for (uint32_t j = 0; j < n; j++) {
        double x = s->x[j], y = s->y[j];
        double by = x * left.x + y * left.y > turn ? far : near, reach = e->own.x * x + e->own.y * y, other = e->other.x * x + e->other.y * y + e->other_r;
        reach += x * right.x + y * right.y > turn ? far : by;
        s->bound[j] = reach > other ? reach : other;
        s->facing[j] = to.x * x + to.y * y + 0.7072;
    }
    for (uint32_t m = 0; m < u->ping->n_v; m++)
        for (uint32_t j = 0; j < n; j++) {
            double d = v[m].x * s->x[j] + v[m].y * s->y[j];
            s->farthest[j] = d > s->farthest[j] ? d : s->farthest[j];
        }
}

/* Cuts with the sides, of a polygon around the stroke, that may reach the pixel and bound the stroke's disc at `own`.
 * The polygon has the disc's area: its sides lie a little inside the disc, its corners a little outside. */
static bool cut_disc(Union *u, const Capsule *k, Vec2 own, double r, Vec2 other, double other_r)
{
    uint32_t n = disc_sides(r), step = CIRCLE / n, missed = 0;
    Vec2 half = u->circle->dir[step / 2];                            /* cosine and sine of half a side */
    double dent = 1.0 - (half.y * half.y / (half.x * half.x)) / 6.0; /* sqrt(x / tan x) for small x = pi/n */
    Vec2 to = vec_sub(vec2(0.5, 0.5), own);
    End e = {own, other, r, other_r, dent, n, step, vec_norm2(to) > 0.0 ? facing_side(u->circle, to, step) : 0};
    for (uint32_t first = 0; first < n; first += SIDES) {
        Sides s;
        uint32_t count = MIN(n - first, (uint32_t)SIDES);
        list_sides(u, k, &e, first, count, &s);
        for (uint32_t j = 0; j < count; j++) {
            if (s.facing[j] < r * dent) {
                if (++missed == 2)
                    return true;
                continue;
            }
            /* cuts only take away, but for rounding */
            if (s.farthest[j] > s.bound[j] - RINGS_NEARBY && !union_cut(u, vec2(s.x[j], s.y[j]), s.bound[j]))
                return false;
        }
    }
    return true;
}

/* union_cut, after a look at the whole pixel. */
static inline bool cut_pixel(Union *u, Vec2 normal, double bound)
{
    double reach = 0.5 * (fabs(normal.x) + fabs(normal.y)), beyond = 0.5 * (normal.x + normal.y) - bound;
    if (beyond <= -reach)
        return true;
    return beyond < reach && union_cut(u, normal, bound);
}

static bool is_none(Vec2 v)
{
    return v.x == 0.0 && v.y == 0.0;
}

/* Where sides and disc touch, between the disc's centre and there, the disc is within the sides: by little where they run all but along each other. */
static bool is_slim(double radius, double taper)
{
    return radius * radius * fabs(taper * taper * taper) < 3e-5;
}

static bool cut_stroke(Union *u, const Capsule *k, const StrokeEnds *ends, Vec2 corner)
{
    Vec2 a = vec_sub(k->a, corner), b = vec_sub(k->b, corner);
    if ((ends->cut & ~ends->mitre & CUT_A) != 0 && !cut_pixel(u, vec2(-k->d.x, -k->d.y), -vec_dot(a, k->d)))
        return false;
    if ((ends->cut & ~ends->mitre & CUT_B) != 0 && !cut_pixel(u, k->d, vec_dot(b, k->d)))
        return false;
    if (!is_none(ends->side[0]) && !cut_pixel(u, ends->side[0], vec_dot(a, ends->side[0])))
        return false;
    if (!is_none(ends->side[1]) && !cut_pixel(u, ends->side[1], vec_dot(b, ends->side[1])))
        return false;
    if (k->length > 0.0)
        for (double sign = -1.0; sign <= 1.0; sign += 2.0) {
            Vec2 normal = capsule_normal(k, sign);
            if (!cut_pixel(u, normal, vec_dot(a, normal) + k->ra))
                return false;
        }
    /* Beyond the chord through the tangent points the disc bounds the stroke. */
    bool at_a = k->length == 0.0, at_b = false, may_a = (ends->cut & CUT_A) == 0 || !is_slim(k->ra, k->s), may_b = (ends->cut & CUT_B) == 0 || !is_slim(k->rb, k->s);
    for (uint32_t i = 0; i < u->ping->n_v && k->length > 0.0 && (may_a || may_b); i++) {
        double along = vec_dot(vec_sub(u->ping->v[i], a), k->d);
        at_a = at_a || (may_a && along < k->ra * k->s);
        at_b = at_b || (may_b && along > k->length + k->rb * k->s);
    }
    return (!at_a || cut_disc(u, k, a, k->ra, b, k->rb)) && (!at_b || cut_disc(u, k, b, k->rb, a, k->ra));
}

static const Vec2 pixel[4] = {{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}};

void union_add(Union *u, const Capsule *k, const StrokeEnds *ends, Vec2 corner, uint32_t place)
{
    rings_reset(u->ping);
    rings_copy(u->ping, pixel, 4);
    if (cut_stroke(u, k, ends, corner))
        union_put(u, place);
}

static Vec2 unit(Vec2 v)
{
    return vec_scale(v, 1.0 / sqrt(vec_norm2(v)));
}

/* Directions around the arc from n0 to n1, of which `middle` is the middle one: by halves, until there are so many chords that the area between one and the arc
 * stays below about 2e-4. Returns the number of chords. */
enum { MOST_CHORDS = 64 };
static uint32_t spread(Vec2 n0, Vec2 n1, Vec2 middle, double radius, Vec2 *to)
{
    double chord = sqrt(vec_norm2(vec_sub(n1, n0)));
    uint32_t chords = 1;
    while (chords < MOST_CHORDS && (chord > 0.7 * chords || chord * chord * chord * radius * radius > 0.0024 * chords * chords * chords))
        chords *= 2;
    to[0] = n0;
    to[chords] = n1;
    for (uint32_t step = chords; step > 1; step /= 2)
        for (uint32_t i = 0; i < chords; i += step)
            to[i + step / 2] = step == chords ? middle : unit(vec_add(to[i], to[i + step]));
    return chords;
}

void union_add_wedge(Union *u, Vec2 centre, double radius, Vec2 d0, Vec2 d1, Vec2 corner, uint32_t place)
{
    Vec2 arc[MOST_CHORDS + 1], c = vec_sub(centre, corner);
    bool left = vec_cross(d0, d1) > 0.0; /* then the wedge is to the right */
    Vec2 n0 = left ? vec2(d0.y, -d0.x) : vec2(-d0.y, d0.x), n1 = left ? vec2(d1.y, -d1.x) : vec2(-d1.y, d1.x);
    uint32_t n = spread(n0, n1, unit(vec_sub(d0, d1)), radius, arc);
    /* Chords so far out that the area is the arc's: by the root of x / sin x. */
    double s = vec_cross(arc[0], arc[1]), s2 = s * s, r = radius * sqrt(1.0 + s2 * (1.0 / 6.0 + s2 * (3.0 / 40.0)));
    rings_reset(u->ping);
    rings_room(u->ping, n + 2);
    Vec2 *v = u->ping->v, *to = v;
    to = put_point(v, to, c);
    for (uint32_t i = 0; i <= n; i++)
        to = put_point(v, to, vec_add(c, vec_scale(arc[left ? i : n - i], r)));
    u->ping->n_v = (uint32_t)(to - v);
    rings_close(u->ping);
    if (u->ping->n > 0 && union_cut(u, vec2(1.0, 0.0), 1.0) && union_cut(u, vec2(-1.0, 0.0), 0.0) && union_cut(u, vec2(0.0, 1.0), 1.0) &&
        union_cut(u, vec2(0.0, -1.0), 0.0))
        union_put(u, place);
}
