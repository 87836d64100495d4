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

static double box_gap2(Box2 a, Box2 b)
{
    double dx = MAX(MAX(a.x0 - b.x1, b.x0 - a.x1), 0.0), dy = MAX(MAX(a.y0 - b.y1, b.y0 - a.y1), 0.0);
    return dx * dx + dy * dy;
}

/* The corners of a box and, for each, the point nearest to it: its squared distances to all four. A point that one of these beats at every
 * corner is beaten in all of the box, as the difference of two squared distances is linear. */
typedef struct {
    Vec2 corner[4];
    double rival[4][4];
} Contest;

static Contest contest(Box2 b)
{
    Contest c = {{{b.x0, b.y0}, {b.x1, b.y0}, {b.x0, b.y1}, {b.x1, b.y1}}, {{0}}};
    for (int k = 0; k < 4; k++)
        for (int j = 0; j < 4; j++)
            c.rival[k][j] = HUGE_VAL;
    return c;
}

static bool beaten(const Contest *c, const double d2[4])
{
    const double slack = 1.0 - 1e-9;
    for (int k = 0; k < 4; k++) {
        const double *r = c->rival[k];
        if (r[0] < d2[0] * slack && r[1] < d2[1] * slack && r[2] < d2[2] * slack && r[3] < d2[3] * slack)
            return true;
    }
    return false;
}

static bool box_beaten(const Contest *c, Box2 b)
{
    double d2[4];
    for (int k = 0; k < 4; k++)
        d2[k] = box_dist2(b, c->corner[k]);
    return beaten(c, d2);
}

/* Whether p stands against the rivals so far; then it may become one. */
static bool enter(Contest *c, Vec2 p)
{
    double d2[4];
    for (int k = 0; k < 4; k++)
        d2[k] = vec_dist2(p, c->corner[k]);
    if (beaten(c, d2))
        return false;
    for (int k = 0; k < 4; k++)
        if (d2[k] < c->rival[k][k])
            memcpy(c->rival[k], d2, sizeof d2);
    return true;
}

uint32_t boxtree_nearest_to(const Boxtree *t, const Vec2 *pos, Box2 box, double bound2, uint32_t *out, uint32_t cap)
{
    const double slack = 1.0 + 1e-9;
    Contest c = contest(box);
    Vec2 centre = vec_lerp(c.corner[0], c.corner[3], 0.5);
    uint32_t stack[BOXTREE_DEPTH], depth = 0, n_out = 0;
    if (t->n_nodes)
        stack[depth++] = 0;
    while (depth) {
        uint32_t k = stack[--depth];
        const BoxNode *n = &t->node[k];
        if (box_gap2(n->box, box) > bound2 * slack || box_beaten(&c, n->box))
            continue;
        if (n->right) {
            bool left_first = box_dist2(t->node[k + 1].box, centre) <= box_dist2(t->node[n->right].box, centre);
            stack[depth++] = left_first ? n->right : k + 1;
            stack[depth++] = left_first ? k + 1 : n->right;
            continue;
        }
        for (uint32_t i = n->first; i < n->first + n->count; i++) {
            if (box_dist2(box, pos[t->item[i]]) > bound2 * slack || !enter(&c, pos[t->item[i]]))
                continue;
            if (n_out == cap)
                return cap + 1;
            out[n_out++] = t->item[i];
        }
    }
    uint32_t kept = 0;
    for (uint32_t i = 0; i < n_out; i++) { /* those that a later rival beat go; the rest is sorted by insertion */
        uint32_t v = out[i], j = kept;
        Vec2 p = pos[v];
        if (box_beaten(&c, (Box2){p.x, p.y, p.x, p.y}))
            continue;
        for (; j && out[j - 1] > v; j--)
            out[j] = out[j - 1];
        out[j] = v;
        kept++;
    }
    return kept;
}

/* Largest squared distance between points of the two. */
static double box_far2(Box2 a, Box2 b)
{
    double dx = MAX(a.x1 - b.x0, b.x1 - a.x0), dy = MAX(a.y1 - b.y0, b.y1 - a.y0);
    return dx * dx + dy * dy;
}

uint32_t boxtree_nearer(const Boxtree *t, const Vec2 *pos, Box2 a, Box2 b, uint32_t *out, uint32_t cap)
{
    const double slack = 1.0 + 1e-9;
    uint32_t stack[BOXTREE_DEPTH], depth = 0, n_out = 0;
    if (t->n_nodes)
        stack[depth++] = 0;
    while (depth) {
        uint32_t k = stack[--depth];
        const BoxNode *n = &t->node[k];
        if (box_far2(b, n->box) * slack <= box_gap2(a, n->box))
            continue;
        if (n->right) {
            stack[depth++] = n->right;
            stack[depth++] = k + 1;
            continue;
        }
        for (uint32_t i = n->first; i < n->first + n->count; i++) {
            Vec2 p = pos[t->item[i]];
            Box2 point = {p.x, p.y, p.x, p.y};
            if (box_far2(b, point) * slack <= box_gap2(a, point))
                continue;
            if (n_out == cap)
                return cap + 1;
            out[n_out++] = t->item[i];
        }
    }
    return n_out;
}
