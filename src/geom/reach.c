#include "geom/reach.h"

#include "geom/segment.h"

#include <glib.h>
#include <stdlib.h>

enum { CELLS = 256, LEAF_NODES = 4 };

struct Reach {
    bool trivial;
    double depth;
    Vec2 corner;
    double cell, scale; /* size of a cell, and cells per unit */
    uint32_t nx, ny;    /* nodes */
    float *distance;    /* [ny][nx] signed, positive inside */
};

/* --- the convex hull --- */

static int compare_xy(gconstpointer a, gconstpointer b, gpointer user)
{
    const Vec2 *v = user, p = v[*(const uint32_t *)a], q = v[*(const uint32_t *)b];
    if (p.x != q.x)
        return p.x < q.x ? -1 : 1;
    return (p.y > q.y) - (p.y < q.y);
}

/* Marks the corners of the lower hull of the points, taken in the given order (A. M. Andrew's monotone chain). */
static void mark_chain(const Polygon *p, const uint32_t *order, uint32_t *stack, bool *on_hull)
{
    uint32_t n = 0;
    for (uint32_t k = 0; k < p->n; k++) {
        Vec2 q = p->v[order[k]];
        while (n >= 2 &&
               vec_cross(vec_sub(p->v[stack[n - 1]], p->v[stack[n - 2]]), vec_sub(q, p->v[stack[n - 2]])) <= 0.0)
            n--;
        stack[n++] = order[k];
    }
    for (uint32_t k = 0; k < n; k++)
        on_hull[stack[k]] = true;
}

static bool *hull_corners(const Polygon *p)
{
    bool *on_hull = g_new0(bool, p->n);
    uint32_t *order = g_new(uint32_t, p->n), *stack = g_new(uint32_t, p->n);
    for (uint32_t i = 0; i < p->n; i++)
        order[i] = i;
    g_qsort_with_data(order, (gint)p->n, sizeof *order, compare_xy, p->v);
    mark_chain(p, order, stack, on_hull);
    for (uint32_t i = 0; i < p->n / 2; i++) {
        uint32_t t = order[i];
        order[i] = order[p->n - 1 - i];
        order[p->n - 1 - i] = t;
    }
    mark_chain(p, order, stack, on_hull);
    g_free(order);
    g_free(stack);
    return on_hull;
}

/* The corners of the hull of a simple polygon follow each other as on the polygon; the vertices between two of them
 * bound a notch under one side of the hull. Measured from that side, not from the hull as a whole: a thin crescent is
 * near its hull everywhere, and yet its horns do not see each other. */
static bool notches_are_shallow(const Polygon *p, double depth)
{
    bool *on_hull = hull_corners(p), shallow = true;
    uint32_t first = 0;
    while (!on_hull[first])
        first++;
    for (uint32_t k = 0, from = first; k < p->n && shallow;) {
        uint32_t span = 1;
        while (!on_hull[(from + span) % p->n])
            span++;
        uint32_t to = (from + span) % p->n;
        for (uint32_t i = 1; i < span && shallow; i++)
            shallow = segment_dist2(p->v[from], p->v[to], p->v[(from + i) % p->n]) <= depth * depth;
        k += span;
        from = to;
    }
    g_free(on_hull);
    return shallow;
}

/* --- the distance field --- */

static Vec2 node_at(const Reach *r, uint32_t i, uint32_t j)
{
    return vec2(r->corner.x + r->cell * (double)i, r->corner.y + r->cell * (double)j);
}

static double edge_dist2(const Polygon *p, uint32_t e, Vec2 q)
{
    return segment_dist2(p->v[e], p->v[e + 1 < p->n ? e + 1 : 0], q);
}

/* A block of nodes i0 <= i < i1, j0 <= j < j1. */
typedef struct {
    uint32_t i0, j0, i1, j1;
} Block;

/* Keeps those edges that can be nearest to some node of the block: no farther from its middle than the nearest edge
 * plus twice the block's half diagonal. The list is written behind the old one. */
static uint32_t near_edges(const Reach *r, const Polygon *p, Block b, const uint32_t *edge, uint32_t n, uint32_t *kept,
                           double *dist)
{
    Vec2 lo = node_at(r, b.i0, b.j0), hi = node_at(r, b.i1 - 1, b.j1 - 1), middle = vec_lerp(lo, hi, 0.5);
    double least = HUGE_VAL;
    for (uint32_t k = 0; k < n; k++) {
        dist[k] = edge_dist2(p, edge[k], middle);
        least = dist[k] < least ? dist[k] : least;
    }
    double limit = sqrt(least) + 1.0001 * vec_dist(lo, hi);
    uint32_t m = 0;
    for (uint32_t k = 0; k < n; k++)
        if (dist[k] <= limit * limit)
            kept[m++] = edge[k];
    return m;
}

static void fill_nodes(Reach *r, const Polygon *p, Block b, const uint32_t *edge, uint32_t n)
{
    for (uint32_t j = b.j0; j < b.j1; j++) {
        for (uint32_t i = b.i0; i < b.i1; i++) {
            Vec2 q = node_at(r, i, j);
            double least = HUGE_VAL;
            for (uint32_t k = 0; k < n; k++) {
                double d = edge_dist2(p, edge[k], q);
                least = d < least ? d : least;
            }
            r->distance[j * r->nx + i] = (float)(polygon_contains(p, q) ? sqrt(least) : -sqrt(least));
        }
    }
}

/* `edge` has room for another n behind its n entries at each of the levels below. */
static void fill_block(Reach *r, const Polygon *p, Block b, const uint32_t *edge, uint32_t n, uint32_t *room,
                       double *dist)
{
    uint32_t w = b.i1 - b.i0, h = b.j1 - b.j0;
    if (w == 0 || h == 0)
        return;
    uint32_t m = near_edges(r, p, b, edge, n, room, dist);
    if (w <= LEAF_NODES && h <= LEAF_NODES) {
        fill_nodes(r, p, b, room, m);
        return;
    }
    uint32_t i = b.i0 + (w + 1) / 2, j = b.j0 + (h + 1) / 2;
    const Block part[4] = {{b.i0, b.j0, i, j}, {i, b.j0, b.i1, j}, {b.i0, j, i, b.j1}, {i, j, b.i1, b.j1}};
    for (int k = 0; k < 4; k++)
        fill_block(r, p, part[k], room, m, room + m, dist);
}

static void fill_field(Reach *r, const Polygon *p)
{
    uint32_t levels = 2;
    for (uint32_t w = r->nx > r->ny ? r->nx : r->ny; w > 1; w = (w + 1) / 2)
        levels++;
    uint32_t *edge = g_new(uint32_t, (gsize)p->n * levels);
    double *dist = g_new(double, p->n);
    for (uint32_t e = 0; e < p->n; e++)
        edge[e] = e;
    fill_block(r, p, (Block){0, 0, r->nx, r->ny}, edge, p->n, edge + p->n, dist);
    g_free(edge);
    g_free(dist);
}

/* --- the test --- */

Reach *reach_new(const Polygon *p, double depth)
{
    Reach *r = g_new0(Reach, 1);
    r->depth = depth;
    r->trivial = notches_are_shallow(p, depth);
    if (r->trivial)
        return r;
    double w = p->box.x1 - p->box.x0, h = p->box.y1 - p->box.y0;
    r->cell = (w > h ? w : h) / CELLS;
    r->scale = 1.0 / r->cell;
    r->corner = vec2(p->box.x0 - r->cell, p->box.y0 - r->cell);
    r->nx = (uint32_t)(w * r->scale) + 4;
    r->ny = (uint32_t)(h * r->scale) + 4;
    r->distance = g_new(float, (gsize)r->nx *r->ny);
    fill_field(r, p);
    return r;
}

void reach_free(Reach *r)
{
    if (!r)
        return;
    g_free(r->distance);
    g_free(r);
}

bool reach_is_trivial(const Reach *r) { return r->trivial; }

static inline uint32_t cell_of(double t, uint32_t nodes)
{
    return !(t > 0.0) ? 0 : t >= (double)(nodes - 1) ? nodes - 2 : (uint32_t)t;
}

static inline double field(const Reach *r, Vec2 q)
{
    double x = (q.x - r->corner.x) * r->scale, y = (q.y - r->corner.y) * r->scale;
    uint32_t i = cell_of(x, r->nx), j = cell_of(y, r->ny);
    const float *d = r->distance + (gsize)j * r->nx + i;
    double s = x - (double)i, t = y - (double)j;
    double lower = (double)d[0] + s * (double)(d[1] - d[0]);
    double upper = (double)d[r->nx] + s * (double)(d[r->nx + 1] - d[r->nx]);
    return lower + t * (upper - lower);
}

static inline bool before(Vec2 a, Vec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); }

/* Sphere tracing (Hart 1996): what is left above the tolerance is a step that cannot cross it. Steps are at least half
 * a cell, which settles grazing lines within the error of the field. */
bool reach_sees(const Reach *r, Vec2 a, Vec2 b)
{
    if (r->trivial)
        return true;
    double length = vec_dist(a, b), at_a = field(r, a) + r->depth, at_b = field(r, b) + r->depth;
    if (at_a < 0.0 || at_b < 0.0)
        return false;
    if (at_a + at_b >= length)
        return true;
    Vec2 from = before(a, b) ? a : b, to = before(a, b) ? b : a;
    double least = 0.5 * r->cell;
    double end = length - (before(a, b) ? at_b : at_a);
    for (double t = before(a, b) ? at_a : at_b; t < end;) {
        double free = field(r, vec_lerp(from, to, t / length)) + r->depth;
        if (free < 0.0)
            return false;
        t += free > least ? free : least;
    }
    return true;
}
