#include "scan/axis_base.h"

#include <math.h>

#include "scan/gather.h"

enum { STEPS = 6, PLACES = 2 * STEPS + 1 };

#define STEP 0.02     /* of the axis, along the outline */
#define LOPSIDED 0.95 /* symmetry below which the middle of the area may lie off the midvein */
/* In symmetry: where the base is right, teeth and the points that it is counted by make up to half of that, a lobe on one side twice to four times as
 * much. */
#define GAIN 0.012

/* The point that lies some way along the outline from a point of the edge given, either way round. */
static Vec2 along(const Polygon *p, Vec2 from, uint32_t edge, double way)
{
    bool ahead = way >= 0.0;
    double left = fabs(way);
    uint32_t at = ahead ? edge + 1 : edge;
    for (uint32_t k = 0; k <= p->n; k++) {
        Vec2 to = p->v[at % p->n];
        double d = vec_dist(from, to);
        if (d > 0.0 && d >= left)
            return vec_lerp(from, to, left / d);
        left -= d;
        from = to;
        at = ahead ? at % p->n + 1 : (at % p->n + p->n - 1) % p->n;
    }
    return from;
}

/* Where the parabola through three values at -1, 0, 1 has its top; the middle one is the largest. */
static double top(double before, double here, double after)
{
    double bend = 2.0 * here - before - after;
    return bend > 0.0 ? 0.5 * (after - before) / bend : 0.0;
}

Vec2 axis_base(const Axis *a, const Scan *scan, Vec2 base, Vec2 tip)
{
    uint32_t edge;
    Vec2 start = polygon_nearest(a->outline, base, &edge);
    double step = STEP * vec_dist(start, tip), even[PLACES], said[PLACES], most = 0.0;
    if (axis_symmetry(a, start, tip) > LOPSIDED)
        return base;
    for (int k = 0; k < PLACES; k++) {
        even[k] = axis_symmetry(a, along(a->outline, start, edge, (k - STEPS) * step), tip);
        most = MAX(most, even[k]);
    }
    if (most < even[STEPS] + GAIN)
        return base;
    int best = STEPS;
    for (int k = 0; k < PLACES; k++)
        said[k] = -1.0; /* stays where the base can't be: it isn't worth the time */
    for (int k = 0; k < PLACES; k++) {
        if (even[k] < even[STEPS] - GAIN)
            continue;
        said[k] = gather_compare(scan, a->outline, along(a->outline, start, edge, (k - STEPS) * step), tip);
        best = even[k] + said[k] > even[best] + said[best] ? k : best;
    }
    if (even[best] < even[STEPS] || said[best] < said[STEPS])
        return base;
    bool inside = best > 0 && best < PLACES - 1 && said[best - 1] > -1.0 && said[best + 1] > -1.0;
    double off = inside ? top(even[best - 1] + said[best - 1], even[best] + said[best], even[best + 1] + said[best + 1]) : 0.0;
    return along(a->outline, start, edge, (best - STEPS + off) * step);
}
