#include "geom/quadtree.h"

#include <glib.h>

enum { BUCKET = 8, DEPTH = 40, STACK = 3 * DEPTH + 4 };

static uint32_t new_nodes(Quadtree *t, uint32_t count)
{
    if (t->n_nodes + count > t->cap_nodes) {
        t->cap_nodes = MAX(t->cap_nodes * 2, 64);
        t->node = g_renew(QuadNode, t->node, t->cap_nodes);
    }
    uint32_t first = t->n_nodes;
    for (uint32_t i = 0; i < count; i++)
        t->node[first + i] = (QuadNode){0, NO_POINT, 0};
    t->n_nodes += count;
    return first;
}

void quadtree_reset(Quadtree *t, Box2 box)
{
    double w = box.x1 - box.x0, h = box.y1 - box.y0;
    t->centre = vec2(box.x0 + w * 0.5, box.y0 + h * 0.5);
    t->half = (w > h ? w : h) * 0.5 * (1.0 + 1e-9);
    t->n_nodes = t->n = 0;
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
    g_free(t->next);
    *t = (Quadtree){0};
}

static unsigned quadrant_of(QuadSquare q, Vec2 p)
{
    return (p.x >= q.centre.x ? 1u : 0u) | (p.y >= q.centre.y ? 2u : 0u);
}

static void chain(Quadtree *t, uint32_t node, uint32_t i)
{
    t->next[i] = t->node[node].head;
    t->node[node].head = i;
    t->node[node].count++;
}

static void split(Quadtree *t, const Vec2 *pos, QuadSquare q)
{
    uint32_t child = new_nodes(t, 4);
    uint32_t i = t->node[q.node].head;
    t->node[q.node] = (QuadNode){child, NO_POINT, 0};
    while (i != NO_POINT) {
        uint32_t next = t->next[i];
        chain(t, child + quadrant_of(q, pos[i]), i);
        i = next;
    }
}

void quadtree_add(Quadtree *t, const Vec2 *pos, uint32_t i)
{
    g_assert(fabs(pos[i].x - t->centre.x) <= t->half && fabs(pos[i].y - t->centre.y) <= t->half);
    if (i >= t->cap) {
        t->cap = MAX(t->cap * 2, i + 1024);
        t->next = g_renew(uint32_t, t->next, t->cap);
    }
    QuadSquare q = quadtree_root(t);
    for (int depth = 0;; depth++) {
        while (t->node[q.node].child) {
            q = quadtree_quadrant(t, q, quadrant_of(q, pos[i]));
            depth++;
        }
        if (t->node[q.node].count < BUCKET || depth >= DEPTH) /* deep: coincident points share a leaf */
            break;
        split(t, pos, q);
    }
    chain(t, q.node, i);
    t->n++;
}

uint32_t quadtree_nearest(const Quadtree *t, const Vec2 *pos, Vec2 p, double bound2, PointFilter filter, const void *user,
                          double *d2)
{
    uint32_t best = NO_POINT;
    double best2 = bound2;
    QuadSquare stack[STACK];
    unsigned depth = 0;
    stack[depth++] = quadtree_root(t);
    while (depth) {
        QuadSquare q = stack[--depth];
        if (quadtree_square_dist2(q, p) > best2)
            continue;
        const QuadNode *n = &t->node[q.node];
        if (n->child) {
            unsigned near = quadrant_of(q, p);
            for (unsigned k = 4; k-- > 0;)
                stack[depth++] = quadtree_quadrant(t, q, near ^ k); /* nearest on top */
            continue;
        }
        for (uint32_t i = n->head; i != NO_POINT; i = t->next[i]) {
            double d = vec_dist2(pos[i], p);
            if (d < best2 || (d == best2 && best != NO_POINT && i < best)) {
                if (filter && !filter(user, i))
                    continue;
                best2 = d;
                best = i;
            }
        }
    }
    if (best != NO_POINT)
        *d2 = best2;
    return best;
}

bool quadtree_any_within(const Quadtree *t, const Vec2 *pos, Vec2 p, double r)
{
    double r2 = r * r;
    QuadSquare stack[STACK];
    unsigned depth = 0;
    stack[depth++] = quadtree_root(t);
    while (depth) {
        QuadSquare q = stack[--depth];
        if (quadtree_square_dist2(q, p) >= r2)
            continue;
        const QuadNode *n = &t->node[q.node];
        if (n->child) {
            unsigned near = quadrant_of(q, p);
            for (unsigned k = 4; k-- > 0;)
                stack[depth++] = quadtree_quadrant(t, q, near ^ k);
            continue;
        }
        for (uint32_t i = n->head; i != NO_POINT; i = t->next[i])
            if (vec_dist2(pos[i], p) < r2)
                return true;
    }
    return false;
}
