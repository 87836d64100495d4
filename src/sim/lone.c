/* Crowds whose sources all pull one node, as most that are far ahead of the veins do, one step after the other: as long as the same can be
 * shown of that node's child for all their places together, nothing needs to be kept of each. */
#include <string.h>

#include "sim/pull.h"
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

/* Pulls of four sources on a node at p, in an order of their own: first, third, second, fourth. */
static inline __attribute__((always_inline)) void pull_four(const Vec2 *place, Vec2 p, Four *d2, Four *x, Four *y)
{
    Four low, high;
    memcpy(&low, place, sizeof low);
    memcpy(&high, place + 2, sizeof high);
    Four dx = __builtin_shufflevector(low, high, 0, 4, 2, 6) - FOUR(p.x), dy = __builtin_shufflevector(low, high, 1, 5, 3, 7) - FOUR(p.y);
    *d2 = dx * dx + dy * dy;
    four_pulls(&dx, &dy, d2, x, y);
}

WIDE double lone_sum(const Vec2 *place, uint32_t n, Vec2 p, Vec2 *sum)
{
    Four most2 = FOUR(-1.0), d2, x, y, all_x = FOUR(0.0), all_y = FOUR(0.0);
    uint32_t k = 0;
    for (; k + 4 <= n; k += 4) {
        pull_four(place + k, p, &d2, &x, &y);
        most2 = FOUR_PICK(d2 > most2, d2, most2);
        all_x += x;
        all_y += y;
    }
    if (k < n) { /* and slots behind the last one, which don't count */
        FourMask mine = FOUR_MASK((int64_t)(n - k)) > (FourMask){0, 2, 1, 3};
        pull_four(place + k, p, &d2, &x, &y);
        most2 = FOUR_PICK((d2 > most2) & mine, d2, most2);
        all_x += (Four)((FourMask)x & mine);
        all_y += (Four)((FourMask)y & mine);
    }
    *sum = vec_add(*sum, vec2((all_x[0] + all_x[1]) + (all_x[2] + all_x[3]), (all_y[0] + all_y[1]) + (all_y[2] + all_y[3])));
    return MAX(MAX(most2[0], most2[1]), MAX(most2[2], most2[3]));
}
