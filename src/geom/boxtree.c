#include "geom/boxtree.h"

#include <glib.h>
#include <string.h>

#include "geom/vectors.h"

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

/* What is farther from all of the box than one point is from its farthest corner is nearest to no place in it. */
uint32_t boxtree_near(const Boxtree *t, const Vec2 *pos, Box2 box, double bound2, uint32_t *out, uint32_t cap)
{
    Vec2 centre = vec2((box.x0 + box.x1) * 0.5, (box.y0 + box.y1) * 0.5);
    uint32_t stack[BOXTREE_DEPTH], depth = 0, n_out = 0;
    if (t->n_nodes)
        stack[depth++] = 0;
    while (depth) {
        uint32_t k = stack[--depth];
        const BoxNode *n = &t->node[k];
        if (box_gap2(n->box, box) > bound2 * POINTS_SLACK)
            continue;
        if (n->right) {
            bool left_first = box_dist2(t->node[k + 1].box, centre) <= box_dist2(t->node[n->right].box, centre);
            stack[depth++] = left_first ? n->right : k + 1;
            stack[depth++] = left_first ? k + 1 : n->right;
            continue;
        }
        for (uint32_t i = n->first; i < n->first + n->count; i++) {
            Vec2 p = pos[t->item[i]];
            double far2 = box_far2(box, point_box(p));
            bound2 = far2 < bound2 ? far2 : bound2;
            if (box_dist2(box, p) > bound2 * POINTS_SLACK)
                continue;
            if (n_out == cap)
                return cap + 1;
            out[n_out++] = t->item[i];
        }
    }
    return n_out;
}

/* By one digit, stably. */
static void sort_digit(const uint32_t *item, uint32_t n, uint32_t shift, uint32_t *sorted)
{
    uint32_t start[256] = {0};
    for (uint32_t i = 0; i < n; i++)
        start[item[i] >> shift & 255]++;
    for (uint32_t d = 0, sum = 0; d < 256; d++) {
        uint32_t count = start[d];
        start[d] = sum;
        sum += count;
    }
    for (uint32_t i = 0; i < n; i++)
        sorted[start[item[i] >> shift & 255]++] = item[i];
}

/* Digit by digit, the lowest first: as many rounds as the largest has. */
void boxtree_sort(uint32_t *item, uint32_t n)
{
    uint32_t few[1024], *room = n <= G_N_ELEMENTS(few) ? few : g_new(uint32_t, n), all = 0;
    for (uint32_t i = 0; i < n; i++)
        all |= item[i];
    for (uint32_t shift = 0; n > 1 && shift < 32 && all >> shift; shift += 8) {
        sort_digit(item, n, shift, room);
        memcpy(item, room, sizeof *item * n);
    }
    if (room != few)
        g_free(room);
}

uint32_t boxtree_rivals(const Boxtree *t, const Vec2 *pos, Box2 box, const Points *near, bool nearest_alone, Points *out, uint32_t cap)
{
    Guard g;
    guard_make(&g, box, near, nearest_alone);
    uint32_t stack[BOXTREE_DEPTH], depth = 0, name[BOXTREE_LEAF + 4];
    double x[BOXTREE_LEAF + 4], y[BOXTREE_LEAF + 4];
    out->n = 0;
    if (t->n_nodes)
        stack[depth++] = 0;
    while (depth) {
        uint32_t k = stack[--depth];
        const BoxNode *n = &t->node[k];
        if (guard_shuts_out(&g, n->box))
            continue;
        if (n->right) {
            stack[depth++] = n->right;
            stack[depth++] = k + 1;
            continue;
        }
        Points leaf = {n->count, name, x, y};
        memcpy(name, t->item + n->first, sizeof *name * n->count);
        points_fill(&leaf, pos);
        guard_pass(&g, &leaf, &leaf, BOXTREE_LEAF);
        if (out->n + leaf.n > cap)
            return cap + 1;
        memcpy(out->v + out->n, name, sizeof *name * leaf.n);
        out->n += leaf.n;
    }
    boxtree_sort(out->v, out->n);
    points_fill(out, pos);
    return nearest_alone ? out->n : points_thin_out(box, out);
}
