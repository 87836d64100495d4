#include "geom/boxtree.h"

#include <glib.h>
#include <string.h>

void boxtree_clear(Boxtree *t)
{
    g_free(t->node);
    g_free(t->item);
    *t = (Boxtree){0};
}

/* Partial sort: item[k] gets the element that belongs there by coordinate (ties by index), smaller ones before it (Hoare). */
static void select_nth(uint32_t *item, uint32_t n, uint32_t k, const Vec2 *pos, bool by_y)
{
#define LESS(a, b) (by_y ? (pos[a].y < pos[b].y || (pos[a].y == pos[b].y && (a) < (b))) \
                         : (pos[a].x < pos[b].x || (pos[a].x == pos[b].x && (a) < (b))))
    uint32_t lo = 0, hi = n - 1;
    while (lo < hi) {
        uint32_t pivot = item[lo + (hi - lo) / 2], i = lo, j = hi;
        for (;;) {
            while (LESS(item[i], pivot))
                i++;
            while (LESS(pivot, item[j]))
                j--;
            if (i >= j)
                break;
            uint32_t swap = item[i];
            item[i++] = item[j];
            item[j--] = swap;
        }
        /* item[lo … j] <= pivot <= item[j + 1 … hi], whichever way the scan ended */
        if (k <= j)
            hi = j;
        else
            lo = j + 1;
    }
#undef LESS
}

static uint32_t build(Boxtree *t, const Vec2 *pos, uint32_t first, uint32_t count)
{
    Box2 box = box_empty();
    for (uint32_t i = first; i < first + count; i++)
        box = box_add(box, pos[t->item[i]]);
    uint32_t me = t->n_nodes++;
    t->node[me] = (BoxNode){box, first, count, 0};
    if (count > BOXTREE_LEAF) {
        uint32_t half = count / 2;
        select_nth(t->item + first, count, half, pos, box.y1 - box.y0 > box.x1 - box.x0);
        build(t, pos, first, half);
        uint32_t right = build(t, pos, first + half, count - half);
        t->node[me].right = right;
    }
    return me;
}

void boxtree_build(Boxtree *t, const Vec2 *pos, const uint32_t *item, uint32_t n)
{
    if (n > t->cap_items) {
        t->cap_items = n * 2;
        t->cap_nodes = t->cap_items + 1; /* leaves hold at least two points each when there is more than one leaf */
        t->item = g_renew(uint32_t, t->item, t->cap_items);
        t->node = g_renew(BoxNode, t->node, t->cap_nodes);
    }
    t->n_items = n;
    t->n_nodes = 0;
    if (n) {
        memcpy(t->item, item, sizeof *item * n);
        build(t, pos, 0, n);
    }
}

bool boxtree_any_in(const Boxtree *t, const Vec2 *pos, Box2 box)
{
    uint32_t stack[BOXTREE_DEPTH], depth = 0;
    if (t->n_nodes)
        stack[depth++] = 0;
    while (depth) {
        uint32_t k = stack[--depth];
        const BoxNode *n = &t->node[k];
        if (!box_meets(n->box, box))
            continue;
        if (n->box.x0 >= box.x0 && n->box.x1 <= box.x1 && n->box.y0 >= box.y0 && n->box.y1 <= box.y1)
            return true;
        if (n->right) {
            stack[depth++] = n->right;
            stack[depth++] = k + 1;
            continue;
        }
        for (uint32_t i = n->first; i < n->first + n->count; i++)
            if (box_has(box, pos[t->item[i]]))
                return true;
    }
    return false;
}

void boxtree_nearest(const Boxtree *t, const Vec2 *pos, Vec2 p, bool (*filter)(const void *user, uint32_t i), const void *user,
                     uint32_t *best, double *best2)
{
    uint32_t stack[BOXTREE_DEPTH], depth = 0;
    bool mine = false; /* *best is one of these points */
    if (t->n_nodes)
        stack[depth++] = 0;
    while (depth) {
        uint32_t k = stack[--depth];
        const BoxNode *n = &t->node[k];
        if (box_dist2(n->box, p) > *best2)
            continue;
        if (n->right) {
            stack[depth++] = n->right;
            stack[depth++] = k + 1;
            continue;
        }
        for (uint32_t i = n->first; i < n->first + n->count; i++) {
            double d2 = vec_dist2(p, pos[t->item[i]]);
            if ((d2 < *best2 || (mine && d2 == *best2 && t->item[i] < *best)) && (!filter || filter(user, t->item[i]))) {
                *best = t->item[i];
                *best2 = d2;
                mine = true;
            }
        }
    }
}

/* Squared distance from p to the farthest point of the box. */
static double box_far2(Box2 b, Vec2 p)
{
    double dx = p.x - b.x0 > b.x1 - p.x ? p.x - b.x0 : b.x1 - p.x, dy = p.y - b.y0 > b.y1 - p.y ? p.y - b.y0 : b.y1 - p.y;
    return dx * dx + dy * dy;
}

static double box_gap2(Box2 a, Box2 b)
{
    double dx = MAX(MAX(a.x0 - b.x1, b.x0 - a.x1), 0.0), dy = MAX(MAX(a.y0 - b.y1, b.y0 - a.y1), 0.0);
    return dx * dx + dy * dy;
}

uint32_t boxtree_nearest_to(const Boxtree *t, const Vec2 *pos, Box2 box, double bound2, uint32_t *out, uint32_t cap)
{
    const double slack = 1.0 + 1e-9;
    uint32_t stack[BOXTREE_DEPTH], depth = 0, n_out = 0;
    if (t->n_nodes)
        stack[depth++] = 0;
    while (depth) {
        uint32_t k = stack[--depth];
        const BoxNode *n = &t->node[k];
        if (box_gap2(n->box, box) > bound2 * slack)
            continue;
        if (n->right) {
            bool left_first = box_gap2(t->node[k + 1].box, box) <= box_gap2(t->node[n->right].box, box);
            stack[depth++] = left_first ? n->right : k + 1;
            stack[depth++] = left_first ? k + 1 : n->right;
            continue;
        }
        for (uint32_t i = n->first; i < n->first + n->count; i++) {
            if (box_dist2(box, pos[t->item[i]]) > bound2 * slack)
                continue;
            bound2 = MIN(bound2, box_far2(box, pos[t->item[i]]));
            if (n_out == cap)
                return cap + 1;
            out[n_out++] = t->item[i];
        }
    }
    uint32_t kept = 0;
    for (uint32_t i = 0; i < n_out; i++) { /* those that a later rival beat go; the rest is sorted by insertion */
        uint32_t v = out[i], j = kept;
        if (box_dist2(box, pos[v]) > bound2 * slack)
            continue;
        for (; j && out[j - 1] > v; j--)
            out[j] = out[j - 1];
        out[j] = v;
        kept++;
    }
    return kept;
}
