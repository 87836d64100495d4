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
bool crowd_turns(const Simulation *s, const Crowd *c, const Sight *sight)
{
    const Veins *v = &s->veins;
    if (sight->nearest.n != 1)
        return false;
    uint32_t node = sight->nearest.v[0];
    Vec2 p = v->pos[node], old = v->pos[c->lone];
    if (!nearer_all_over(c->place, p, old) || box_dist2(c->place, p) <= MAX(kill2(s), past2(s)) * POINTS_SLACK)
        return false;
    return s->def.pattern == PATTERN_OPEN ||
           (sight->rival.n == 0 && v->parent[node] == c->lone && sight->stride2[0] * POINTS_SLACK <= box_dist2(c->place, old));
}

/* Draws slots first … last-1 to p; returns the largest squared distance. */
static WIDE double draw_run(const Vec2 *place, uint32_t n, Vec2 p, double *x, double *y)
{
    Four px = FOUR(p.x), py = FOUR(p.y), most2 = FOUR(-1.0);
    for (uint32_t k = 0; k < n; k += 4) {
        Four low, high, scale;
        uint32_t m = MIN(n - k, 4);
        if (m == 4) {
            memcpy(&low, place + k, sizeof low);
            memcpy(&high, place + k + 2, sizeof high);
        } else {
            low = (Four){place[k].x, place[k].y, place[k + (m > 1)].x, place[k + (m > 1)].y};
            high = (Four){place[k + m - 1].x, place[k + m - 1].y, place[k].x, place[k].y};
        }
        Four dx = __builtin_shufflevector(low, high, 0, 2, 4, 6) - px, dy = __builtin_shufflevector(low, high, 1, 3, 5, 7) - py;
        Four d2 = dx * dx + dy * dy;
        most2 = FOUR_PICK(d2 > most2, d2, most2);
        four_inverse_root(&d2, &scale);
        dx *= scale;
        dy *= scale;
        if (m == 4) {
            memcpy(x + k, &dx, sizeof dx);
            memcpy(y + k, &dy, sizeof dy);
        } else {
            memcpy(x + k, &dx, sizeof *x * m);
            memcpy(y + k, &dy, sizeof *y * m);
        }
    }
    return MAX(MAX(most2[0], most2[1]), MAX(most2[2], most2[3]));
}

uint32_t crowd_draw_lone(const Simulation *s, Crowd *c, const Draw *draw)
{
    Vec2 p = s->veins.pos[c->lone];
    uint32_t n = 0;
    c->most2 = -1.0;
    for (uint32_t r = 0; r < CROWD_SIDE; r++) {
        uint32_t first = c->first[r], count = c->last[r] - first;
        if (count == 0)
            continue;
        double most2 = draw_run(s->place + first, count, p, draw->x + (first - draw->first), draw->y + (first - draw->first));
        c->most2 = MAX(c->most2, most2);
        n += count;
    }
    return n;
}
