/* Which way three points turn, exactly. */
#ifndef GEOM_TURN_H
#define GEOM_TURN_H

#include "geom/vec.h"

/* 1 when c lies to the left of the way from a to b, -1 to the right, 0 on their line; exact for coordinates between 1e-70 and 1e70. */
int turn_sign(Vec2 a, Vec2 b, Vec2 c);

/* Whether seen from q the direction of a comes before that of b, counter-clockwise from that of +x; exact. Neither lies at q. */
bool turn_before(Vec2 q, Vec2 a, Vec2 b);

#endif
