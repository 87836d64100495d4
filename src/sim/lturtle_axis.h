/* The line that a blade's midvein follows, and by which the turtle of sim/lsystem.h tells which way is up. */
#ifndef SIM_LTURTLE_AXIS_H
#define SIM_LTURTLE_AXIS_H

#include "geom/polygon.h"

enum { LAXIS_PARTS = 64 };

/* x and dx/dy at y = i / LAXIS_PARTS, leaf lengths; smooth between, straight on below the base and above the tip. */
typedef struct LAxis {
    bool curved; /* false: x = 0 everywhere, and the rest is not set */
    double x[LAXIS_PARTS + 1], slope[LAXIS_PARTS + 1];
    double length; /* from y = 0 to 1, leaf lengths */
} LAxis;

/* The middle of a blade in leaf coordinates: half way between its margins, square to the line itself; in a lobed one between the sinuses beside
 * the middle lobe. Teeth and dents are evened out, as it bends no more than x = y (1 - y) (a + b y + c y²). Straight where it is off the
 * straight one by less than LAXIS_LEAST, or than LAXIS_LEAST_WIDTHS of the greatest width, so that leaves that are only a little uneven have a
 * straight midvein; and where no such line lies in the blade. O(vertices) for each of some 2700 rays. */
#define LAXIS_LEAST 0.01
#define LAXIS_LEAST_WIDTHS 0.04
void laxis_of_blade(const Polygon *leaf, LAxis *out);

/* Along a midrib, from either end; leaf coordinates. Below its first point from the base, above its last to the tip. False, and nothing is set,
 * when it is no midrib from near the base to near the tip: shorter than half the leaf, turning back, or steeper than 68° from the axis. */
bool laxis_of_midrib(const Vec2 *point, uint32_t n, LAxis *out);

double laxis_x(const LAxis *a, double y);

/* Unit vector along the line, towards the tip. */
Vec2 laxis_way(const LAxis *a, double y);

#endif
