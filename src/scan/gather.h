/* Which way up a leaf is by its veins: the base of one that shows no petiole. */
#ifndef SCAN_GATHER_H
#define SCAN_GATHER_H

#include "geom/polygon.h"
#include "scan/scan.h"

/* Whether the leaf's lines say that a is the base and b the tip (above 0) or the other way round; both are points of the outline, y-up pixels
 * (scan/profile.h). From -1 to 1; 0 when they don't say. Two things count, of all that is seen of lines by contrast and width: that lines head for the base
 * rather than for the tip, as primaries run together there and are widest; and that they lean away from the axis on their way to the
 * tip, as secondaries do. About 0.1 s; holds some float images of a quarter of a million pixels, whatever the scan's size. */
double gather_compare(const Scan *s, const Polygon *outline, Vec2 a, Vec2 b);

#endif
