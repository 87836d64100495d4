#include "geom/ring.h"

#include <glib.h>
#include <string.h>

#include "geom/segment.h"
#include "geom/simplify.h"

/* Vertices that were kept, as a mark on each vertex of the polygon and in order. Index n is vertex 0 again. */
typedef struct {
    const Polygon *p;
    bool *kept; /* [n] */
    uint32_t *index;
    uint32_t n;
} Ring;

static void ring_list(Ring *r)
{
    r->n = 0;
    for (uint32_t i = 0; i < r->p->n; i++)
        if (r->kept[i])
            r->index[r->n++] = i;
    r->index[r->n] = r->p->n;
}

/* Puts back the vertex farthest from edge k. False when the edge cuts nothing short. */
static bool split_edge(Ring *r, uint32_t k)
{
    const Polygon *p = r->p;
    uint32_t from = r->index[k], to = r->index[k + 1], far = from;
    double most = -1.0;
    for (uint32_t i = from + 1; i < to; i++) {
        double d = segment_dist2(p->v[from], p->v[to % p->n], p->v[i]);
        if (d > most) {
            most = d;
            far = i;
        }
    }
    if (far == from)
        return false;
    r->kept[far] = true;
    return true;
}

/* The edge that cuts most vertices short. */
static uint32_t longest_edge(const Ring *r)
{
    uint32_t best = 0;
    for (uint32_t k = 1; k < r->n; k++)
        if (r->index[k + 1] - r->index[k] > r->index[best + 1] - r->index[best])
            best = k;
    return best;
}

static Polygon *ring_polygon(const Ring *r)
{
    Vec2 *v = g_new(Vec2, r->n);
    for (uint32_t k = 0; k < r->n; k++)
        v[k] = r->p->v[r->index[k]];
    Polygon *p = polygon_new(v, r->n);
    g_free(v);
    return p;
}

/* Whether the kept vertices run the way the polygon does; polygon_new would turn them around. */
static bool runs_clockwise(const Ring *r)
{
    double twice = 0.0;
    const Vec2 *v = r->p->v;
    for (uint32_t k = 1; k + 1 < r->n; k++)
        twice += vec_cross(vec_sub(v[r->index[k]], v[0]), vec_sub(v[r->index[k + 1]], v[0]));
    return !(twice > 0.0);
}

/* Splits edges that clash. True when there were any that could be split. */
static bool repair(Ring *r)
{
    if (r->n < 3 || runs_clockwise(r))
        return split_edge(r, longest_edge(r));
    Polygon *p = ring_polygon(r);
    uint32_t i, j;
    bool split = false;
    if (polygon_crossing(p, &i, &j)) {
        split = split_edge(r, i);
        split = split_edge(r, j) || split;
    }
    polygon_free(p);
    return split;
}

Polygon *ring_simplify(const Polygon *p, double tolerance, const bool *must)
{
    uint32_t n = p->n;
    Vec2 *way = g_new(Vec2, (gsize)n + 1);
    bool *fixed = g_new0(bool, (gsize)n + 1);
    Ring r = {p, g_new0(bool, n), g_new(uint32_t, (gsize)n + 1), 0};
    memcpy(way, p->v, sizeof *way * n);
    way[n] = p->v[0];
    if (must)
        memcpy(fixed, must, sizeof *fixed * n);
    if (tolerance > 0.0) {
        uint32_t kept = simplify_polyline(way, n + 1, tolerance, fixed, r.index);
        for (uint32_t k = 0; k < kept; k++)
            r.kept[r.index[k] % n] = true;
    } else {
        memset(r.kept, true, sizeof *r.kept * n);
    }
    do
        ring_list(&r);
    while (repair(&r));
    Polygon *out = ring_polygon(&r);
    g_free(way);
    g_free(fixed);
    g_free(r.kept);
    g_free(r.index);
    return out;
}

double ring_length(const Polygon *p)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < p->n; i++)
        sum += vec_dist(p->v[i], p->v[i + 1 < p->n ? i + 1 : 0]);
    return sum;
}
