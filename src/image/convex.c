#include "image/convex.h"

#include <glib.h>
#include <string.h>

enum {
    CROWD = 12, /* polygons in a square from which it is quartered */
    MAX_DEPTH = 6
};

static const double speck = 1e-6;  /* leftovers below this area are dropped */
static const double nearby = 1e-9; /* pixels */

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

/* ---- lists of polygons ---- */

static bool same(Vec2 a, Vec2 b)
{
    return fabs(a.x - b.x) < nearby && fabs(a.y - b.y) < nearby;
}

static uint32_t ring_start(const Rings *r, uint32_t i)
{
    return i > 0 ? r->end[i - 1] : 0;
}

static void rings_room(Rings *r, uint32_t points)
{
    if (r->n_v + points <= r->cap_v)
        return;
    r->cap_v = MAX(r->cap_v * 2, r->n_v + points);
    r->v = g_renew(Vec2, r->v, r->cap_v);
}

/* Points that all but coincide become one: the direction of an edge between them would be noise. There must be room. */
static inline Vec2 *put_point(const Vec2 *first, Vec2 *to, Vec2 p)
{
    if (to == first || !same(to[-1], p))
        *to++ = p;
    return to;
}

/* Closes the polygon made of the points since the last one; a polygon without area is dropped. */
static void rings_close(Rings *r)
{
    uint32_t start = ring_start(r, r->n);
    while (r->n_v > start + 1 && same(r->v[r->n_v - 1], r->v[start]))
        r->n_v--;
    if (r->n_v < start + 3) {
        r->n_v = start;
        return;
    }
    if (r->n == r->cap) {
        r->cap = r->cap > 0 ? r->cap * 2 : 16;
        r->end = g_renew(uint32_t, r->end, r->cap);
    }
    r->end[r->n++] = r->n_v;
}

static void rings_reset(Rings *r)
{
    r->n = r->n_v = 0;
}

void rings_clear(Rings *r)
{
    g_free(r->v);
    g_free(r->end);
}

static void rings_copy(Rings *to, const Vec2 *v, uint32_t n)
{
    rings_room(to, n);
    memcpy(to->v + to->n_v, v, n * sizeof *v);
    to->n_v += n;
    rings_close(to);
}

static double ring_area(const Vec2 *v, uint32_t n)
{
    double sum = 0.0;
    for (uint32_t i = 1; i + 1 < n; i++)
        sum += vec_cross(vec_sub(v[i], v[0]), vec_sub(v[i + 1], v[0]));
    return 0.5 * fabs(sum);
}

/* The part of a polygon where p · normal <= bound; `known`, unless it is NULL, has what p · normal - bound is at its points. */
static inline void clip_known(const Vec2 *v, uint32_t n, Vec2 normal, double bound, const double *known, Rings *out)
{
    rings_room(out, 2 * n); /* a polygon that is not convex may be cut at every edge */
    Vec2 *first = out->v + out->n_v, *to = first, p = v[n - 1];
    double dp = known != NULL ? known[n - 1] : vec_dot(p, normal) - bound;
    for (uint32_t i = 0; i < n; i++) {
        Vec2 q = v[i];
        double dq = known != NULL ? known[i] : vec_dot(q, normal) - bound;
        if ((dp > 0.0) != (dq > 0.0))
            to = put_point(first, to, vec_lerp(p, q, dp / (dp - dq)));
        if (!(dq > 0.0))
            to = put_point(first, to, q);
        p = q;
        dp = dq;
    }
    out->n_v = (uint32_t)(to - out->v);
    rings_close(out);
}

static void clip(const Vec2 *v, uint32_t n, Vec2 normal, double bound, Rings *out)
{
    clip_known(v, n, normal, bound, NULL, out);
}

void ring_within(const Vec2 *v, uint32_t n, Box2 box, Rings *out, Rings *spare)
{
    const Vec2 normal[4] = {{-1.0, 0.0}, {0.0, -1.0}, {1.0, 0.0}, {0.0, 1.0}};
    const double bound[4] = {-box.x0, -box.y0, box.x1, box.y1};
    rings_reset(out);
    rings_copy(out, v, n);
    for (int i = 0; i < 4 && out->n > 0; i++) {
        Rings swap = *spare;
        *spare = *out;
        *out = swap;
        rings_reset(out);
        clip(spare->v, spare->n_v, normal[i], bound[i], out);
    }
}

/* ---- a stroke within a pixel ---- */

void union_init(Union *u, const Circle *circle)
{
    *u = (Union){.circle = circle, .rest = &u->scratch[0], .next = &u->scratch[1], .ping = &u->scratch[2], .pong = &u->scratch[3]};
}

void union_clear(Union *u)
{
    rings_clear(&u->part);
    for (int i = 0; i < 4; i++)
        rings_clear(&u->scratch[i]);
    rings_clear(&u->mask);
    g_free(u->rank);
    g_free(u->size);
}

void union_reset(Union *u)
{
    rings_reset(&u->part);
}

/* Cuts the polygon in `ping`, which lies in the pixel 0 … 1, if the half-plane cuts it at all. FALSE when nothing is left. Many half-planes have all of the
 * pixel on one side. */
static bool cut(Union *u, Vec2 normal, double bound)
{
    enum { FEW = 32 };
    if (MAX(normal.x, 0.0) + MAX(normal.y, 0.0) < bound - nearby)
        return true;
    if (MIN(normal.x, 0.0) + MIN(normal.y, 0.0) > bound + nearby) {
        rings_reset(u->ping);
        return false;
    }
    double beyond[FEW];
    uint32_t n = u->ping->n_v, outside = 0;
    for (uint32_t i = 0; i < n; i++) {
        double d = vec_dot(u->ping->v[i], normal) - bound;
        outside += d > 0.0;
        if (i < FEW)
            beyond[i] = d;
    }
    if (outside == 0)
        return true;
    rings_reset(u->pong);
    if (outside == n) {
        rings_reset(u->ping);
        return false;
    }
    clip_known(u->ping->v, n, normal, bound, n <= FEW ? beyond : NULL, u->pong);
    Rings *swap = u->ping;
    u->ping = u->pong;
    u->pong = swap;
    return u->ping->n > 0;
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

/* Index of the direction nearest to d, by bisection on the side of it that d lies on. */
static uint32_t nearest_direction(const Circle *c, Vec2 d)
{
    uint32_t q = CIRCLE / 4, lo = d.y >= 0.0 ? (d.x > 0.0 ? 0 : q) : (d.x < 0.0 ? 2 * q : 3 * q);
    for (uint32_t step = q / 2; step > 0; step /= 2)
        if (vec_cross(c->dir[lo + step], d) >= 0.0)
            lo += step;
    return lo;
}

/* Cuts with the sides, of a polygon around the stroke, that may reach the pixel and bound the stroke's disc at `own`.
 * The polygon has the disc's area: its sides lie a little inside the disc, its corners a little outside. */
static bool cut_disc(Union *u, const Capsule *k, Vec2 own, double r, Vec2 other, double other_r)
{
    uint32_t n = disc_sides(r), step = CIRCLE / n;
    const Vec2 *dir = u->circle->dir;
    Vec2 half = dir[step / 2];                                       /* cosine and sine of half a side */
    double dent = 1.0 - (half.y * half.y / (half.x * half.x)) / 6.0; /* sqrt(x / tan x) for small x = pi/n */
    Vec2 left = capsule_normal(k, 1.0), right = capsule_normal(k, -1.0);
    Vec2 to = vec_sub(vec2(0.5, 0.5), own);
    double far = sqrt(vec_norm2(to)), turn = dir[step].x;
    uint32_t mid = far > 0.0 ? (nearest_direction(u->circle, to) + step / 2) / step : 0;
    for (uint32_t i = 0, missed = 0; i < n; i++) {
        /* from the middle to both sides in turn */
        uint32_t at = (mid + (i % 2 != 0 ? n - (i + 1) / 2 : i / 2)) & (n - 1);
        Vec2 normal = dir[at * step];
        if (vec_dot(to, normal) + 0.7072 < r * dent) {
            if (++missed == 2)
                break;
            continue;
        }
        /* Next to the straight sides the polygon keeps clear of them. */
        bool beside = k->length > 0.0 && (vec_dot(normal, left) > turn || vec_dot(normal, right) > turn);
        double reach = vec_dot(own, normal) + r * (beside ? 1.0 : dent);
        double bound = MAX(reach, vec_dot(other, normal) + other_r);
        if (!cut(u, normal, bound))
            return false;
    }
    return true;
}

static bool cut_stroke(Union *u, const Capsule *k, StrokeCut ends, Vec2 corner)
{
    Vec2 a = vec_sub(k->a, corner), b = vec_sub(k->b, corner);
    if ((ends & CUT_A) != 0 && !cut(u, vec2(-k->d.x, -k->d.y), -vec_dot(a, k->d)))
        return false;
    if ((ends & CUT_B) != 0 && !cut(u, k->d, vec_dot(b, k->d)))
        return false;
    if (k->length > 0.0)
        for (double sign = -1.0; sign <= 1.0; sign += 2.0) {
            Vec2 normal = capsule_normal(k, sign);
            if (!cut(u, normal, vec_dot(a, normal) + k->ra))
                return false;
        }
    /* Beyond the chord through the tangent points the disc bounds the stroke. */
    bool at_a = k->length == 0.0, at_b = false;
    for (uint32_t i = 0; i < u->ping->n_v && k->length > 0.0; i++) {
        double along = vec_dot(vec_sub(u->ping->v[i], a), k->d);
        at_a = at_a || along < k->ra * k->s;
        at_b = at_b || along > k->length + k->rb * k->s;
    }
    return (!at_a || cut_disc(u, k, a, k->ra, b, k->rb)) && (!at_b || cut_disc(u, k, b, k->rb, a, k->ra));
}

static const Vec2 pixel[4] = {{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}};

void union_add(Union *u, const Capsule *k, StrokeCut ends, Vec2 corner)
{
    rings_reset(u->ping);
    rings_copy(u->ping, pixel, 4);
    if (cut_stroke(u, k, ends, corner))
        rings_copy(&u->part, u->ping->v, u->ping->n_v);
}

void union_add_wedge(Union *u, Vec2 centre, double radius, Vec2 d0, Vec2 d1, Vec2 corner)
{
    Capsule disc = capsule_new(centre, radius, centre, radius);
    Vec2 c = vec_sub(centre, corner);
    rings_reset(u->ping);
    rings_copy(u->ping, pixel, 4);
    if (cut(u, d1, vec_dot(c, d1)) && cut(u, vec2(-d0.x, -d0.y), -vec_dot(c, d0)) &&
        cut_stroke(u, &disc, CUT_NONE, corner))
        rings_copy(&u->part, u->ping->v, u->ping->n_v);
}

/* ---- union ---- */

/* Does an edge of `knife` have all of v on its outer side? */
static bool apart(const Vec2 *v, uint32_t n, const Vec2 *knife, uint32_t m)
{
    for (uint32_t i = 0; i < m; i++) {
        Vec2 o = knife[i], e = vec_sub(knife[i + 1 < m ? i + 1 : 0], o);
        bool all = true;
        for (uint32_t j = 0; j < n && all; j++)
            all = vec_cross(e, vec_sub(v[j], o)) <= 0.0;
        if (all)
            return true;
    }
    return false;
}

/* Adds to `out` what of polygon v lies outside the convex polygon `knife`, in convex pieces. */
static void subtract(Union *u, const Vec2 *v, uint32_t n, const Vec2 *knife, uint32_t m, Rings *out)
{
    if (apart(v, n, knife, m)) {
        rings_copy(out, v, n);
        return;
    }
    rings_reset(u->ping);
    rings_copy(u->ping, v, n);
    for (uint32_t i = 0; i < m && u->ping->n > 0; i++) {
        Vec2 o = knife[i], e = vec_sub(knife[i + 1 < m ? i + 1 : 0], o);
        Vec2 outer = vec2(e.y, -e.x);
        double bound = vec_dot(o, outer);
        bool cuts = false;
        for (uint32_t j = 0; j < u->ping->n_v && !cuts; j++)
            cuts = vec_dot(u->ping->v[j], outer) > bound;
        if (!cuts)
            continue;
        uint32_t from = out->n_v;
        clip(u->ping->v, u->ping->n_v, vec2(-outer.x, -outer.y), -bound, out);
        if (out->n_v > from && ring_area(out->v + from, out->n_v - from) < speck) {
            out->n--;
            out->n_v = from;
        }
        cut(u, outer, bound);
    }
}

/* Ranks the parts first … last-1, the largest first: it hides most of the others. */
static void rank_parts(Union *u, uint32_t first, uint32_t last)
{
    uint32_t n = last - first;
    if (n > u->cap) {
        u->cap = MAX(n, 2 * u->cap);
        u->rank = g_renew(uint32_t, u->rank, u->cap);
        u->size = g_renew(double, u->size, u->cap);
    }
    for (uint32_t i = 0; i < n; i++) {
        uint32_t s = ring_start(&u->part, first + i), at = i;
        double size = ring_area(u->part.v + s, u->part.end[first + i] - s);
        for (; at > 0 && u->size[at - 1] < size; at--) {
            u->size[at] = u->size[at - 1];
            u->rank[at] = u->rank[at - 1];
        }
        u->size[at] = size;
        u->rank[at] = first + i;
    }
}

/* Area of what two parts have in common. */
static double shared(Union *u, uint32_t i, uint32_t j)
{
    uint32_t s = ring_start(&u->part, i), k = ring_start(&u->part, j), m = u->part.end[j] - k;
    const Vec2 *knife = u->part.v + k;
    if (apart(u->part.v + s, u->part.end[i] - s, knife, m))
        return 0.0;
    rings_reset(u->ping);
    rings_copy(u->ping, u->part.v + s, u->part.end[i] - s);
    for (uint32_t e = 0; e < m; e++) {
        Vec2 along = vec_sub(knife[e + 1 < m ? e + 1 : 0], knife[e]), outer = vec2(along.y, -along.x);
        if (!cut(u, outer, vec_dot(knife[e], outer)))
            return 0.0;
    }
    return ring_area(u->ping->v, u->ping->n_v);
}

/* What of part i no part ranked before it hides. */
static double unhidden(Union *u, uint32_t place)
{
    uint32_t i = u->rank[place], s = ring_start(&u->part, i);
    if (place == 1) {
        double own = u->size[1] - shared(u, i, u->rank[0]);
        return MAX(own, 0.0);
    }
    rings_reset(u->rest);
    rings_copy(u->rest, u->part.v + s, u->part.end[i] - s);
    for (uint32_t j = 0; j < place && u->rest->n > 0; j++) {
        uint32_t knife = u->rank[j], k = ring_start(&u->part, knife);
        rings_reset(u->next);
        for (uint32_t f = 0; f < u->rest->n; f++) {
            uint32_t t = ring_start(u->rest, f);
            subtract(u, u->rest->v + t, u->rest->end[f] - t, u->part.v + k, u->part.end[knife] - k, u->next);
        }
        Rings *swap = u->rest;
        u->rest = u->next;
        u->next = swap;
    }
    double sum = 0.0;
    for (uint32_t f = 0; f < u->rest->n; f++) {
        uint32_t t = ring_start(u->rest, f);
        sum += ring_area(u->rest->v + t, u->rest->end[f] - t);
    }
    return sum;
}

/* Area of the union of the parts first … last-1, which lie in a square of area `whole`. */
static double flat_area(Union *u, uint32_t first, uint32_t last, double whole)
{
    if (first == last)
        return 0.0;
    rank_parts(u, first, last);
    double sum = u->size[0];
    for (uint32_t i = 1; i < last - first && sum < whole - speck; i++)
        if (u->size[i] > speck)
            sum += unhidden(u, i);
    return sum;
}

/* The same within a square of side `size` that holds them all; crowds are quartered, as pairs cost more than pieces. */
static double square_area(Union *u, uint32_t first, uint32_t last, Vec2 corner, double size, int depth)
{
    if (last - first <= CROWD || depth == MAX_DEPTH)
        return flat_area(u, first, last, size * size);
    double sum = 0.0, h = 0.5 * size;
    for (int q = 0; q < 4; q++) {
        Vec2 c = vec2(corner.x + (q & 1) * h, corner.y + (q >> 1) * h);
        uint32_t n = u->part.n, n_v = u->part.n_v;
        bool full = false;
        for (uint32_t i = first; i < last && !full; i++) {
            uint32_t s = ring_start(&u->part, i), from = u->part.n_v;
            rings_reset(u->ping);
            rings_copy(u->ping, u->part.v + s, u->part.end[i] - s);
            if (cut(u, vec2(1.0, 0.0), c.x + h) && cut(u, vec2(-1.0, 0.0), -c.x) && cut(u, vec2(0.0, 1.0), c.y + h) &&
                cut(u, vec2(0.0, -1.0), -c.y))
                rings_copy(&u->part, u->ping->v, u->ping->n_v);
            full = ring_area(u->part.v + from, u->part.n_v - from) >= h * h * (1.0 - 1e-12);
        }
        sum += full ? h * h : square_area(u, n, u->part.n, c, h, depth + 1);
        u->part.n = n;
        u->part.n_v = n_v;
    }
    return sum;
}

double union_area(Union *u)
{
    return square_area(u, 0, u->part.n, vec2(0.0, 0.0), 1.0, 0);
}

/* Area of the union of the parts within a triangle that turns left. */
static double triangle_area(Union *u, const Vec2 *t)
{
    uint32_t n = u->part.n, n_v = u->part.n_v;
    for (uint32_t i = 0; i < n; i++) {
        uint32_t s = ring_start(&u->part, i);
        rings_reset(u->ping);
        rings_copy(u->ping, u->part.v + s, u->part.end[i] - s);
        bool left = u->ping->n > 0;
        for (int k = 0; k < 3 && left; k++) {
            Vec2 e = vec_sub(t[(k + 1) % 3], t[k]), outer = vec2(e.y, -e.x);
            left = cut(u, outer, vec_dot(t[k], outer));
        }
        if (left)
            rings_copy(&u->part, u->ping->v, u->ping->n_v);
    }
    double area = square_area(u, n, u->part.n, vec2(0.0, 0.0), 1.0, 0);
    u->part.n = n;
    u->part.n_v = n_v;
    return area;
}

/* The polygon is a sum of triangles, those that turn right taken away. */
double union_area_within(Union *u, const Vec2 *v, uint32_t n, Vec2 corner)
{
    ring_within(v, n, (Box2){corner.x, corner.y, corner.x + 1.0, corner.y + 1.0}, &u->mask, u->ping);
    double sum = 0.0;
    for (uint32_t i = 1; i + 1 < u->mask.n_v; i++) {
        Vec2 o = vec_sub(u->mask.v[0], corner), a = vec_sub(u->mask.v[i], corner), b = vec_sub(u->mask.v[i + 1], corner);
        double turn = vec_cross(vec_sub(a, o), vec_sub(b, o));
        Vec2 t[3] = {o, turn > 0.0 ? a : b, turn > 0.0 ? b : a};
        if (fabs(turn) > speck)
            sum += turn > 0.0 ? triangle_area(u, t) : -triangle_area(u, t);
    }
    return fabs(sum);
}
