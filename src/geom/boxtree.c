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
