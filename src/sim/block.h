/* Four sources of a crowd at a time: the nearest of the few nodes they look at, and the pulls that come of it. Private to look_open.c and
 * look_closed.c. */
#ifndef SIM_BLOCK_H
#define SIM_BLOCK_H

#include <string.h>

#include "sim/pull.h"
#include "sim/state.h"

#define BLOCK_INLINE static inline __attribute__((always_inline))

/* What a run of slots is read from and written to, in registers. */
typedef struct {
    const Vec2 *place;
    const uint8_t *mark;
    uint32_t *near;
    double *near2;
    Draw draw;
} Columns;

BLOCK_INLINE Columns columns(const Simulation *s, const Draw *draw) { return (Columns){s->place, s->mark, s->near, s->near2, *draw}; }

typedef struct {
    Four x, y;
    Four near2, d2;   /* before and now; -1: not plain, so nearer than anything to its node */
    Four dx, dy;      /* from the new nearest node; of no use where none is nearer */
    FourMask kin;     /* of the new nearest node (Sight); -1: none is nearer than the node that it has */
    Four stride2;     /* closed: as in Sight */
} Block;

BLOCK_INLINE void block_load(const Columns *c, uint32_t k, uint32_t n, Block *b)
{
    if (n == 4) {
        Four low, high;
        memcpy(&low, c->place + k, sizeof low);
        memcpy(&high, c->place + k + 2, sizeof high);
        memcpy(&b->near2, c->near2 + k, sizeof b->near2);
        b->x = __builtin_shufflevector(low, high, 0, 2, 4, 6);
        b->y = __builtin_shufflevector(low, high, 1, 3, 5, 7);
        return;
    }
    for (uint32_t l = 0; l < 4; l++) {
        uint32_t i = l < n ? k + l : k;
        b->x[l] = c->place[i].x;
        b->y[l] = c->place[i].y;
        b->near2[l] = c->near2[i];
    }
}

/* Of equally near nodes the smallest, and the one before over all. With n < 4 the last ones are the first once more. `few`: sight->nearest.n,
 * which the compiler may know. */
BLOCK_INLINE void block_look(const Columns *c, uint32_t k, uint32_t n, const Sight *sight, uint32_t few, bool open, Block *b)
{
    block_load(c, k, n, b);
    Four px = b->x, py = b->y, least = b->near2, stride2 = FOUR(0.0), to_x = FOUR(0.0), to_y = FOUR(0.0);
    FourMask kin = {-1, -1, -1, -1};
    for (uint32_t j = 0; j < few; j++) {
        Four dx = px - FOUR(sight->nearest.x[j]), dy = py - FOUR(sight->nearest.y[j]), e2 = dx * dx + dy * dy;
        FourMask nearer = e2 < least, mine = FOUR_MASK(sight->kin[j]);
        least = FOUR_PICK(nearer, e2, least);
        to_x = FOUR_PICK(nearer, dx, to_x);
        to_y = FOUR_PICK(nearer, dy, to_y);
        kin = (mine & nearer) | (kin & ~nearer);
        if (!open)
            stride2 = FOUR_PICK(nearer, FOUR(sight->stride2[j]), stride2);
    }
    b->d2 = least;
    b->dx = to_x;
    b->dy = to_y;
    b->kin = kin;
    b->stride2 = stride2;
}

/* The nodes that they have. */
BLOCK_INLINE FourNodes block_old(const Columns *c, uint32_t k, uint32_t n)
{
    FourNodes old;
    if (n == 4)
        memcpy(&old, c->near + k, sizeof old);
    else
        for (uint32_t l = 0; l < 4; l++)
            old[l] = c->near[l < n ? k + l : k];
    return old;
}

/* Turns those in the mask to their new nodes; draws the others to the ones they have. */
BLOCK_INLINE void block_keep(const Columns *c, uint32_t k, uint32_t n, const Vec2 *pos, const FourMask *moved, Block *b)
{
    FourNodes old = block_old(c, k, n);
    for (uint32_t l = 0; l < n; l++) {
        if ((*moved)[l])
            continue;
        b->kin[l] = old[l];
        if (old[l] < NEAR_APART) {
            b->dx[l] = b->x[l] - pos[old[l]].x;
            b->dy[l] = b->y[l] - pos[old[l]].y;
        }
    }
}

/* Turns all of them to their nodes, and draws them as pulls_draw would. */
BLOCK_INLINE void block_store(const Columns *c, uint32_t k, uint32_t n, const Block *b)
{
    FourNodes near = __builtin_convertvector(b->kin, FourNodes);
    memcpy(c->near + k, &near, sizeof *c->near * n);
    memcpy(c->near2 + k, &b->d2, sizeof *c->near2 * n);
    if (!c->draw.x)
        return;
    Four x, y;
    four_pulls(&b->dx, &b->dy, &b->d2, &x, &y);
    memcpy(c->draw.x + (k - c->draw.first), &x, sizeof(double) * n);
    memcpy(c->draw.y + (k - c->draw.first), &y, sizeof(double) * n);
}

BLOCK_INLINE double four_most(const Four *v) { return MAX(MAX((*v)[0], (*v)[1]), MAX((*v)[2], (*v)[3])); }

#endif
