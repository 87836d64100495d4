#include "image/convex.h"

enum {
    CROWD = 12, /* polygons in a square from which it is quartered */
    MAX_DEPTH = 6
};

static const double speck = 1e-6; /* leftovers below this area are dropped */

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
    g_free(u->place);
    g_free(u->rank);
    g_free(u->size);
}

void union_reset(Union *u)
{
    rings_reset(&u->part);
}

void union_put(Union *u, uint32_t place)
{
    uint32_t i = u->part.n;
    rings_copy(&u->part, u->ping->v, u->ping->n_v);
    if (i == u->part.n)
        return;
    if (i == u->cap_place) {
        u->cap_place = MAX(2 * u->cap_place, 16u);
        u->place = g_renew(uint32_t, u->place, u->cap_place);
    }
    u->place[i] = place;
}

static void take_turns(Union *u)
{
    Rings *swap = u->ping;
    u->ping = u->pong;
    u->pong = swap;
}

/* A polygon of more points than a mask has bits. */
static bool cut_large(Union *u, Vec2 normal, double bound)
{
    uint32_t n = u->ping->n_v, outside = 0;
    for (uint32_t i = 0; i < n; i++)
        outside += vec_dot(u->ping->v[i], normal) - bound > 0.0;
    if (outside == 0)
        return true;
    rings_reset(u->pong);
    if (outside < n)
        ring_clip(u->ping->v, n, normal, bound, u->pong);
    take_turns(u);
    return u->ping->n > 0;
}

bool union_cut(Union *u, Vec2 normal, double bound)
{
    enum { FEW = 32 };
    uint32_t n = u->ping->n_v, mask = 0;
    const Vec2 *v = u->ping->v;
    double beyond[FEW];
    if (n > FEW)
        return cut_large(u, normal, bound);
    for (uint32_t i = 0; i < n; i++) {
        beyond[i] = vec_dot(v[i], normal) - bound;
        mask |= (uint32_t)(beyond[i] > 0.0) << i;
    }
    if (mask == 0)
        return true;
    rings_reset(u->pong);
    if (mask != 0xFFFFFFFFu >> (32 - n))
        ring_cut_known(v, n, beyond, mask, u->pong);
    take_turns(u);
    return u->ping->n > 0;
}

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
        ring_clip(u->ping->v, u->ping->n_v, vec2(-outer.x, -outer.y), -bound, out);
        if (out->n_v > from && ring_area(out->v + from, out->n_v - from) < speck) {
            out->n--;
            out->n_v = from;
        }
        union_cut(u, outer, bound);
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

/* Do two parts overlap? Neighbours along a vein don't; others may all the same not where it says they do. */
static bool meet(const Union *u, uint32_t i, uint32_t j)
{
    uint32_t p = u->place[i], q = u->place[j], far = p > q ? p - q : q - p;
    if (far == 1 || (far == 2 && p % 2 == 0))
        return false;
    uint32_t s = ring_start(&u->part, i), k = ring_start(&u->part, j);
    return !apart(u->part.v + s, u->part.end[i] - s, u->part.v + k, u->part.end[j] - k);
}

/* Area of what two parts have in common. */
static double shared(Union *u, uint32_t i, uint32_t j)
{
    uint32_t s = ring_start(&u->part, i), k = ring_start(&u->part, j), m = u->part.end[j] - k;
    const Vec2 *knife = u->part.v + k;
    rings_reset(u->ping);
    rings_copy(u->ping, u->part.v + s, u->part.end[i] - s);
    for (uint32_t e = 0; e < m; e++) {
        Vec2 along = vec_sub(knife[e + 1 < m ? e + 1 : 0], knife[e]), outer = vec2(along.y, -along.x);
        if (!union_cut(u, outer, vec_dot(knife[e], outer)))
            return 0.0;
    }
    return ring_area(u->ping->v, u->ping->n_v);
}

/* What of a part no part ranked before it hides. Where those that hide some of it don't overlap, what each hides is taken away. */
static double unhidden(Union *u, uint32_t place)
{
    enum { FEW = 6 };
    uint32_t i = u->rank[place], knife[FEW], n = 0, s = ring_start(&u->part, i);
    bool parted = true;
    for (uint32_t j = 0; j < place && parted; j++) {
        if (!meet(u, i, u->rank[j]))
            continue;
        for (uint32_t k = 0; k < n && parted; k++)
            parted = !meet(u, u->rank[j], knife[k]);
        if (n == FEW)
            parted = false;
        else
            knife[n++] = u->rank[j];
    }
    if (parted) {
        double own = u->size[place];
        for (uint32_t k = 0; k < n; k++)
            own -= shared(u, i, knife[k]);
        return MAX(own, 0.0);
    }
    rings_reset(u->rest);
    rings_copy(u->rest, u->part.v + s, u->part.end[i] - s);
    for (uint32_t j = 0; j < place && u->rest->n > 0; j++) {
        uint32_t other = u->rank[j], k = ring_start(&u->part, other);
        if (!meet(u, i, other))
            continue;
        rings_reset(u->next);
        for (uint32_t f = 0; f < u->rest->n; f++) {
            uint32_t t = ring_start(u->rest, f);
            subtract(u, u->rest->v + t, u->rest->end[f] - t, u->part.v + k, u->part.end[other] - k, u->next);
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
            if (union_cut(u, vec2(1.0, 0.0), c.x + h) && union_cut(u, vec2(-1.0, 0.0), -c.x) && union_cut(u, vec2(0.0, 1.0), c.y + h) &&
                union_cut(u, vec2(0.0, -1.0), -c.y))
                union_put(u, u->place[i]);
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
    if (u->part.n == 1)
        return ring_area(u->part.v, u->part.n_v);
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
            left = union_cut(u, outer, vec_dot(t[k], outer));
        }
        if (left)
            union_put(u, u->place[i]);
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
