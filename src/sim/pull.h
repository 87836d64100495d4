/* The pull of a source on a vein node: the unit vector of eq. 1 (Runions 2005), to within 2^-29. On that grid the sum of all pulls that there may be
 * is exact, so it is the same whichever comes first, and threads sum up on their own. Private to src/sim. */
#ifndef SIM_PULL_H
#define SIM_PULL_H

#include "geom/vec.h"
#include "geom/vectors.h"

/* 1.5 * 2^23: added to a number far below it leaves no bits under 2^-29. Sums stay below 2^24 (MOST_SOURCES). */
#define PULL_GRID 0x1.8p+23

/* By a source that lies at `towards`, as seen from the node; not 0. */
static inline Vec2 pull_towards(Vec2 towards)
{
    double scale = 1.0 / sqrt(vec_norm2(towards));
    return vec2((towards.x * scale + PULL_GRID) - PULL_GRID, (towards.y * scale + PULL_GRID) - PULL_GRID);
}

/* The same of four, whose squared distances are d2. */
static inline __attribute__((always_inline)) void four_pulls(const Four *dx, const Four *dy, const Four *d2, Four *x, Four *y)
{
    Four scale;
    four_inverse_root(d2, &scale);
    *x = (*dx * scale + FOUR(PULL_GRID)) - FOUR(PULL_GRID);
    *y = (*dy * scale + FOUR(PULL_GRID)) - FOUR(PULL_GRID);
}

#endif
