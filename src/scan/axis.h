/* The line about which a leaf's outline is most nearly symmetric: where base and tip may lie when no petiole shows them. */
#ifndef SCAN_AXIS_H
#define SCAN_AXIS_H

#include "geom/polygon.h"

/* Points spread over a blade, to weigh lines by. */
typedef struct {
    const Polygon *outline;
    Vec2 middle; /* of the area */
    Vec2 *p;
    uint32_t n;
} Axis;

void axis_init(Axis *a, const Polygon *outline);
void axis_clear(Axis *a);

/* Share of the blade that is blade again when mirrored about the line through two points; 0 when they coincide. */
double axis_symmetry(const Axis *a, Vec2 from, Vec2 to);

/* Where the line from a point through the middle of the area first meets the outline beyond the middle; the middle when it doesn't, or when the point is the middle. */
Vec2 axis_opposite(const Axis *a, Vec2 from);

/* The ends of the best line through the middle of the area: where, going from there, it first meets the outline. The base is the end that the
 * blade reaches farther past (lobes beside a sinus); when neither by much, the end nearer to the middle. Returns the line's symmetry. O(vertices). */
double axis_find(const Axis *a, Vec2 *base, Vec2 *tip);

#endif
