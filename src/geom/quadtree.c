#include "geom/quadtree.h"

#include <glib.h>

static uint32_t new_nodes(Quadtree *t, uint32_t count)
{
    if (t->n_nodes + count > t->cap_nodes) {
        t->cap_nodes = MAX(t->cap_nodes * 2, 64);
        t->node = g_renew(QuadNode, t->node, t->cap_nodes);
    }
    uint32_t first = t->n_nodes;
    for (uint32_t i = 0; i < count; i++)
        t->node[first + i] = (QuadNode){0, NO_POINT};
    t->n_nodes += count;
    return first;
}

static uint32_t new_bucket(Quadtree *t, uint32_t next)
{
    if (t->n_buckets == t->cap_buckets) {
        t->cap_buckets = MAX(t->cap_buckets + t->cap_buckets / 2, 64);
        t->bucket = g_renew(QuadBucket, t->bucket, t->cap_buckets);
    }
    t->bucket[t->n_buckets].count = 0;
    t->bucket[t->n_buckets].next = next;
    return t->n_buckets++;
}

void quadtree_reset(Quadtree *t, Box2 box)
{
    double w = box.x1 - box.x0, h = box.y1 - box.y0;
    t->centre = vec2(box.x0 + w * 0.5, box.y0 + h * 0.5);
    t->half = (w > h ? w : h) * 0.5 * (1.0 + 1e-9);
    t->n_nodes = t->n_buckets = 0;
    new_nodes(t, 1);
}

void quadtree_init(Quadtree *t, Box2 box)
{
    *t = (Quadtree){0};
    quadtree_reset(t, box);
}

void quadtree_clear(Quadtree *t)
{
    g_free(t->node);
    g_free(t->bucket);
    *t = (Quadtree){0};
}

static unsigned quadrant_of(QuadSquare q, Vec2 p)
{
    return (p.x >= q.centre.x ? 1u : 0u) | (p.y >= q.centre.y ? 2u : 0u);
}

static void put(Quadtree *t, uint32_t node, Vec2 p, uint32_t i)
{
    uint32_t b = t->node[node].bucket;
    if (b == NO_POINT || t->bucket[b].count == QUAD_BUCKET)
        t->node[node].bucket = b = new_bucket(t, b);
    QuadBucket *k = &t->bucket[b];
    k->p[k->count] = p;
    k->i[k->count++] = i;
}

/* Makes an inner square of a full leaf; its bucket goes on with its first point's quadrant. */
static void split(Quadtree *t, QuadSquare q)
{
    uint32_t b = t->node[q.node].bucket;
    QuadBucket full = t->bucket[b];
    uint32_t child = new_nodes(t, 4);
    t->node[q.node] = (QuadNode){child, NO_POINT};
    t->bucket[b].count = 0;
    t->node[child + quadrant_of(q, full.p[0])].bucket = b;
    for (uint32_t k = 0; k < full.count; k++)
        put(t, child + quadrant_of(q, full.p[k]), full.p[k], full.i[k]);
}

void quadtree_add(Quadtree *t, Vec2 p, uint32_t i)
{
    g_assert(fabs(p.x - t->centre.x) <= t->half && fabs(p.y - t->centre.y) <= t->half);
    const double least = t->half * 0x1p-38; /* coincident points share a leaf of this size */
    QuadSquare q = quadtree_root(t);
    for (;;) {
        while (t->node[q.node].child)
            q = quadtree_quadrant(t, q, quadrant_of(q, p));
        uint32_t b = t->node[q.node].bucket;
        if (b == NO_POINT || t->bucket[b].count < QUAD_BUCKET || q.half <= least)
            break;
        split(t, q);
    }
    put(t, q.node, p, i);
}

QuadSquare quadtree_around(const Quadtree *t, Box2 b)
{
    QuadSquare q = quadtree_root(t);
    b = box_grow(b, 1e-12 * (t->half + fabs(t->centre.x) + fabs(t->centre.y))); /* its sides are rounded */
    while (t->node[q.node].child) {
        bool right = b.x0 >= q.centre.x, above = b.y0 >= q.centre.y;
        if ((!right && b.x1 >= q.centre.x) || (!above && b.y1 >= q.centre.y))
            break;
        q = quadtree_quadrant(t, q, (right ? 1u : 0u) | (above ? 2u : 0u));
    }
    return q;
}

uint32_t quadtree_nearest(const Quadtree *t, Vec2 p, double bound2, PointFilter filter, const void *user, double *d2)
{
    uint32_t best = NO_POINT;
    double best2 = bound2;
    QuadSquare stack[QUAD_STACK];
    unsigned depth = 0;
    stack[depth++] = quadtree_root(t);
    while (depth) {
        QuadSquare q = stack[--depth];
        if (quadtree_square_dist2(q, p) > best2)
            continue;
        if (t->node[q.node].child) {
            unsigned near = quadrant_of(q, p);
            for (unsigned k = 4; k-- > 0;)
                stack[depth++] = quadtree_quadrant(t, q, near ^ k); /* nearest on top */
            continue;
        }
        for (uint32_t b = t->node[q.node].bucket; b != NO_POINT; b = t->bucket[b].next) {
            const QuadBucket *n = &t->bucket[b];
            for (uint32_t k = 0; k < n->count; k++) {
                double d = vec_dist2(n->p[k], p);
                if (d < best2 || (d == best2 && best != NO_POINT && n->i[k] < best)) {
                    if (filter && !filter(user, n->i[k]))
                        continue;
                    best2 = d;
                    best = n->i[k];
                }
            }
        }
    }
    if (best != NO_POINT)
        *d2 = best2;
    return best;
}

bool quadtree_any_within(const Quadtree *t, Vec2 p, double r)
{
    double r2 = r * r, wide = r * (1.0 + 1e-9);
    QuadSquare stack[QUAD_STACK];
    unsigned depth = 0;
    stack[depth++] = quadtree_around(t, (Box2){p.x - wide, p.y - wide, p.x + wide, p.y + wide});
    while (depth) {
        QuadSquare q = stack[--depth];
        if (t->node[q.node].child) {
            unsigned near = quadrant_of(q, p);
            for (unsigned k = 4; k-- > 0;) {
                QuadSquare c = quadtree_quadrant(t, q, near ^ k);
                if (quadtree_square_dist2(c, p) < r2)
                    stack[depth++] = c;
            }
            continue;
        }
        for (uint32_t b = t->node[q.node].bucket; b != NO_POINT; b = t->bucket[b].next)
            for (uint32_t k = 0; k < t->bucket[b].count; k++)
                if (vec_dist2(t->bucket[b].p[k], p) < r2)
                    return true;
    }
    return false;
}
