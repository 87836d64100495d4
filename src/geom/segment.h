/* Points and straight segments. */
#ifndef GEOM_SEGMENT_H
#define GEOM_SEGMENT_H

#include "geom/vec.h"

/* Where on ab (0 at a, 1 at b) the point nearest to q lies; 0 when a and b coincide. */
static inline double segment_nearest(Vec2 a, Vec2 b, Vec2 q)
{
    Vec2 d = vec_sub(b, a);
    double along = vec_dot(vec_sub(q, a), d), whole = vec_norm2(d);
    return !(along > 0.0) ? 0.0 : along >= whole ? 1.0 : along / whole;
}

static inline double segment_dist2(Vec2 a, Vec2 b, Vec2 q)
{
    double t = segment_nearest(a, b, q);
    return vec_dist2(t == 1.0 ? b : vec_lerp(a, b, t), q);
}

#endif
