/* Crowds whose sources all pull one node, as most that are far ahead of the veins do, one step after the other: as long as the same can be
 * shown of that node's child for all their places together, nothing needs to be kept of each. */
#include <string.h>

#include "geom/vectors.h"
#include "sim/state.h"

void crowd_rest(Simulation *s, Crowd *c, uint32_t node)
{
    c->lone = node;
    for (uint32_t r = 0; r < CROWD_SIDE; r++)
        if (c->first[r] < c->last[r]) /* out of date: found by nobody */
            memset(s->near + c->first[r], 0xff, sizeof *s->near * (c->last[r] - c->first[r]));
}

void crowd_wake(Simulation *s, Crowd *c)
{
    if (c->lone == NO_POINT)
        return;
    Vec2 p = s->veins.pos[c->lone];
    for (uint32_t r = 0; r < CROWD_SIDE; r++)
        for (uint32_t k = c->first[r]; k < c->last[r]; k++) {
            s->near[k] = c->lone;
            s->near2[k] = vec_dist2(s->place[k], p);
        }
    c->lone = NO_POINT;
}

void crowds_wake(Simulation *s, uint32_t node)
{
    for (uint32_t i = 0; i < s->crowds.n_crowds; i++)
        if (node == NO_POINT || s->crowds.crowd[i].lone == node)
            crowd_wake(s, &s->crowds.crowd[i]);
}

/* Is u nearer than v to any place in the box? */
static bool nearer_all_over(Box2 b, Vec2 u, Vec2 v)
{
    const Vec2 corner[4] = {{b.x0, b.y0}, {b.x1, b.y0}, {b.x0, b.y1}, {b.x1, b.y1}};
    bool nearer = true;
    for (uint32_t c = 0; c < 4; c++)
        nearer &= vec_dist2(u, corner[c]) * POINTS_SLACK < vec_dist2(v, corner[c]);
    return nearer;
}

/* As show_block, for all of the crowd at once (look_open.c, look_closed.c). */
bool crowd_turns(const Simulation *s, const Crowd *c, uint32_t node)
{
    const Veins *v = &s->veins;
    Vec2 p = v->pos[node], old = v->pos[c->lone];
    if (!nearer_all_over(c->place, p, old) || box_dist2(c->place, p) <= MAX(kill2(s), past2(s)) * POINTS_SLACK)
        return false;
    return s->def.pattern == PATTERN_OPEN ||
           (v->parent[node] == c->lone && vec_dist2(p, old) * POINTS_SLACK <= box_dist2(c->place, old));
}

/* Pulls of m sources, 1 to 4, towards p; the last lanes repeat one of them. */
static inline __attribute__((always_inline)) void draw_four(const Vec2 *place, uint32_t m, Vec2 p, Four *x, Four *y, Four *most2)
{
    Four low, high, scale;
    if (m == 4) {
        memcpy(&low, place, sizeof low);
        memcpy(&high, place + 2, sizeof high);
    } else {
        low = (Four){place[0].x, place[0].y, place[m > 1].x, place[m > 1].y};
        high = (Four){place[m - 1].x, place[m - 1].y, place[0].x, place[0].y};
    }
    Four dx = __builtin_shufflevector(low, high, 0, 2, 4, 6) - FOUR(p.x), dy = __builtin_shufflevector(low, high, 1, 3, 5, 7) - FOUR(p.y);
    Four d2 = dx * dx + dy * dy;
    *most2 = FOUR_PICK(d2 > *most2, d2, *most2);
    four_inverse_root(&d2, &scale);
    *x = dx * scale;
    *y = dy * scale;
}

static inline double most_of(const Four *v) { return MAX(MAX((*v)[0], (*v)[1]), MAX((*v)[2], (*v)[3])); }

/* Draws n sources to p; returns the largest squared distance. */
static WIDE double draw_run(const Vec2 *place, uint32_t n, Vec2 p, double *x, double *y)
{
    Four most2 = FOUR(-1.0), dx, dy;
    for (uint32_t k = 0; k < n; k += 4) {
        uint32_t m = MIN(n - k, 4);
        draw_four(place + k, m, p, &dx, &dy, &most2);
        if (m == 4) {
            memcpy(x + k, &dx, sizeof dx);
            memcpy(y + k, &dy, sizeof dy);
        } else {
            memcpy(x + k, &dx, sizeof *x * m);
            memcpy(y + k, &dy, sizeof *y * m);
        }
    }
    return most_of(&most2);
}

/* The sum waits for one addition after the other, and the roots for the divider: they wait at the same time. */
WIDE double lone_sum(const Vec2 *place, uint32_t n, Vec2 p, Vec2 *sum, double least2)
{
    Four most2 = FOUR(least2), x, y;
    Two xy = {sum->x, sum->y};
    for (uint32_t k = 0; k < n; k += 4) {
        uint32_t m = MIN(n - k, 4);
        draw_four(place + k, m, p, &x, &y, &most2);
        Four even = __builtin_shufflevector(x, y, 0, 4, 2, 6), odd = __builtin_shufflevector(x, y, 1, 5, 3, 7);
        xy += __builtin_shufflevector(even, even, 0, 1);
        if (m > 1)
            xy += __builtin_shufflevector(odd, odd, 0, 1);
        if (m > 2)
            xy += __builtin_shufflevector(even, even, 2, 3);
        if (m > 3)
            xy += __builtin_shufflevector(odd, odd, 2, 3);
    }
    *sum = vec2(xy[0], xy[1]);
    return most_of(&most2);
}

uint32_t crowd_draw_lone(const Simulation *s, Crowd *c, const Draw *draw)
{
    Vec2 p = s->veins.pos[c->lone];
    uint32_t n = 0;
    c->most2 = -1.0;
    c->undrawn = draw->at_once;
    for (uint32_t r = 0; r < CROWD_SIDE; r++) {
        uint32_t first = c->first[r], count = c->last[r] - first;
        n += count;
        if (count == 0 || draw->at_once)
            continue;
        double most2 = draw_run(s->place + first, count, p, draw->x + (first - draw->first), draw->y + (first - draw->first));
        c->most2 = MAX(c->most2, most2);
    }
    return n;
}
