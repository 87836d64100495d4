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

static double box_gap2(Box2 a, Box2 b)
{
    double dx = MAX(MAX(a.x0 - b.x1, b.x0 - a.x1), 0.0), dy = MAX(MAX(a.y0 - b.y1, b.y0 - a.y1), 0.0);
    return dx * dx + dy * dy;
}

/* Squared distances are rounded: what is farther by less than this counts as near. */
static const double slack = 1.0 + 1e-9;

static Box2 point_box(Vec2 p) { return (Box2){p.x, p.y, p.x, p.y}; }

/* Largest squared distance between points of the two. */
static double box_far2(Box2 a, Box2 b)
{
    double dx = MAX(a.x1 - b.x0, b.x1 - a.x0), dy = MAX(a.y1 - b.y0, b.y1 - a.y0);
    return dx * dx + dy * dy;
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
        if (box_gap2(n->box, box) > bound2 * slack)
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
            if (box_dist2(box, p) > bound2 * slack)
                continue;
            if (n_out == cap)
                return cap + 1;
            out[n_out++] = t->item[i];
        }
    }
    return n_out;
}

/* A point that another one beats at every corner is beaten in all of the box, as the difference of two squared distances is linear; those to
 * beat are the ones nearest to a corner. */
FOUR_WIDE uint32_t points_nearest_to(const Vec2 *pos, const uint32_t *item, uint32_t n, Box2 box, double bound2, uint32_t *out)
{
    const Four cx = {box.x0, box.x1, box.x0, box.x1}, cy = {box.y0, box.y0, box.y1, box.y1};
    union {
        Four all;
        double at[4];
    } d2[POINTS_MOST]; /* from the corners */
    Four least = FOUR(HUGE_VAL), rival[4];
    FourMask nearest = {0, 0, 0, 0};
    g_assert(n <= POINTS_MOST);
    for (uint32_t i = 0; i < n; i++) {
        Vec2 p = pos[item[i]];
        Four dx = cx - FOUR(p.x), dy = cy - FOUR(p.y), d = dx * dx + dy * dy;
        FourMask nearer = d < least, number = {i, i, i, i};
        d2[i].all = d;
        least = FOUR_PICK(nearer, d, least);
        nearest = (number & nearer) | (nearest & ~nearer);
    }
    for (int c = 0; n > 1 && c < 4; c++) /* from corner c: the rivals, a little farther */
        rival[c] = (Four){d2[nearest[0]].at[c], d2[nearest[1]].at[c], d2[nearest[2]].at[c], d2[nearest[3]].at[c]} * FOUR(slack);
    uint32_t n_out = 0;
    for (uint32_t i = 0; i < n; i++) {
        FourMask beaten = {0, 0, 0, 0};
        if (n > 1)
            beaten = (rival[0] < FOUR(d2[i].at[0])) & (rival[1] < FOUR(d2[i].at[1])) & (rival[2] < FOUR(d2[i].at[2])) &
                     (rival[3] < FOUR(d2[i].at[3]));
        if (!FOUR_ANY(beaten) && box_dist2(box, pos[item[i]]) <= bound2 * slack)
            out[n_out++] = item[i];
    }
    return n_out;
}

/* The points near[] to a box, one of which is nearest to any place in it, as they keep others out. */
typedef struct {
    Box2 box, hull;  /* hull: of the points */
    Four x, y;       /* all of them, or those nearest to the corners */
    Four corner2[4]; /* their squared distances from corner c, a little farther */
    bool all, nearest_alone;
} Guard;

static inline void guard_make(Guard *g, Box2 box, const Vec2 *pos, const uint32_t *near, uint32_t n, bool nearest_alone)
{
    const double cx[4] = {box.x0, box.x1, box.x0, box.x1}, cy[4] = {box.y0, box.y0, box.y1, box.y1};
    Vec2 u[4];
    g->box = box;
    g->hull = box_empty();
    g->all = n <= 4;
    g->nearest_alone = nearest_alone;
    for (uint32_t i = 0; i < n; i++)
        g->hull = box_add(g->hull, pos[near[i]]);
    for (uint32_t k = 0; k < 4; k++) {
        uint32_t best = near[MIN(k, n - 1)];
        double best2 = vec_dist2(pos[best], vec2(cx[k], cy[k]));
        for (uint32_t i = 0; i < n && !g->all; i++) {
            double d2 = vec_dist2(pos[near[i]], vec2(cx[k], cy[k]));
            if (d2 < best2 || (d2 == best2 && near[i] < best)) {
                best = near[i];
                best2 = d2;
            }
        }
        u[k] = pos[best];
    }
    g->x = (Four){u[0].x, u[1].x, u[2].x, u[3].x};
    g->y = (Four){u[0].y, u[1].y, u[2].y, u[3].y};
    for (int c = 0; c < 4; c++) {
        Four dx = g->x - FOUR(cx[c]), dy = g->y - FOUR(cy[c]);
        g->corner2[c] = (dx * dx + dy * dy) * FOUR(slack);
    }
}

/* Is whatever lies in `b` excluded (neighbours.h) from every place in the box by the point nearest to it? */
static bool shuts_out(const Guard *g, Box2 b) { return box_far2(g->hull, b) * slack <= box_gap2(g->box, b); }

/* The same of one point, by whichever of the others is nearest, or by one that is nearer all over the box. */
static inline bool excludes_point(const Guard *g, Vec2 p)
{
    double x0 = p.x - g->box.x0, x1 = p.x - g->box.x1, y0 = p.y - g->box.y0, y1 = p.y - g->box.y1, gap2 = box_dist2(g->box, p);
    x0 *= x0, x1 *= x1, y0 *= y0, y1 *= y1;
    Four dx = g->x - FOUR(p.x), dy = g->y - FOUR(p.y);
    FourMask apart = (dx * dx + dy * dy) * FOUR(slack) > FOUR(gap2);
    if (g->all && !FOUR_ANY(apart))
        return true;
    if (g->nearest_alone)
        return false;
    FourMask nearer = (g->corner2[0] < FOUR(x0 + y0)) & (g->corner2[1] < FOUR(x1 + y0)) & (g->corner2[2] < FOUR(x0 + y1)) &
                      (g->corner2[3] < FOUR(x1 + y1)) & ~apart;
    return FOUR_ANY(nearer);
}

/* Rivals that are nearest to a corner exclude others from all over the box. */
static inline uint32_t thin_out(Box2 box, const Vec2 *pos, uint32_t *out, uint32_t n)
{
    enum { SOME = 4 };
    if (n <= SOME)
        return n;
    Guard g;
    guard_make(&g, box, pos, out, n, false);
    uint32_t kept = 0;
    for (uint32_t i = 0; i < n; i++)
        if (!excludes_point(&g, pos[out[i]]))
            out[kept++] = out[i];
    return kept;
}

FOUR_WIDE uint32_t boxtree_rivals(const Boxtree *t, const Vec2 *pos, Box2 box, const uint32_t *near, uint32_t n_near,
                                  bool nearest_alone, uint32_t *out, uint32_t cap)
{
    Guard g;
    guard_make(&g, box, pos, near, n_near, nearest_alone);
    uint32_t stack[BOXTREE_DEPTH], depth = 0, n_out = 0;
    if (t->n_nodes)
        stack[depth++] = 0;
    while (depth) {
        uint32_t k = stack[--depth];
        const BoxNode *n = &t->node[k];
        if (shuts_out(&g, n->box))
            continue;
        if (n->right) {
            stack[depth++] = n->right;
            stack[depth++] = k + 1;
            continue;
        }
        for (uint32_t i = n->first; i < n->first + n->count; i++) {
            if (shuts_out(&g, point_box(pos[t->item[i]])) || excludes_point(&g, pos[t->item[i]]))
                continue;
            if (n_out == cap)
                return cap + 1;
            out[n_out++] = t->item[i];
        }
    }
    return nearest_alone ? n_out : thin_out(box, pos, out, n_out);
}

FOUR_WIDE uint32_t points_rivals(const Vec2 *pos, const uint32_t *item, uint32_t n, Box2 box, const uint32_t *near, uint32_t n_near,
                                 bool nearest_alone, uint32_t *out)
{
    uint32_t n_out = 0;
    if (n == 0)
        return 0;
    Guard g;
    guard_make(&g, box, pos, near, n_near, nearest_alone);
    for (uint32_t i = 0; i < n; i++)
        if (!shuts_out(&g, point_box(pos[item[i]])) && !excludes_point(&g, pos[item[i]]))
            out[n_out++] = item[i];
    return nearest_alone ? n_out : thin_out(box, pos, out, n_out);
}
