/* The base of a leaf that is lopsided: the middle of its area lies off the midvein, and so does every line through it. */
#ifndef SCAN_AXIS_BASE_H
#define SCAN_AXIS_BASE_H

#include "scan/axis.h"
#include "scan/scan.h"

/* A base moved along the outline, by up to an eighth of the way to the tip, to where the line to the tip parts the blade most evenly and veins
 * gather, if evenness gains clearly by that and the veins say nothing against it. Otherwise the base as it was, which is soon told; where to takes
 * about a second. */
Vec2 axis_base(const Axis *a, const Scan *scan, Vec2 base, Vec2 tip);

#endif
