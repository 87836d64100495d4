/* Openings in a scanned leaf: where what lay behind it shows within an outline that was traced, drawn, or fitted to edges. */
#ifndef SCAN_OPENINGS_H
#define SCAN_OPENINGS_H

#include "geom/holes.h"
#include "geom/polygon.h"
#include "scan/mask.h"
#include "scan/threshold.h"

/* All outlines are in y-up pixels of the scan. */

/* The threshold for a leaf whose outline is known. False when none parts the leaf from what lies behind it: less than three quarters of what lies in
 * the outline would be leaf (a background of two shades, a leaf that was outlined by hand because no threshold finds it). Without a side given,
 * most of what is in the outline is leaf. */
bool openings_threshold(const Scan *s, const Polygon *outline, const ThresholdDef *def, Threshold *out);

/* Of a mask that is the box of a scan, all bits clear: sets MASK_THIS on pixels in the outline, MASK_HOLE on those of openings that the leaf
 * encloses, MASK_OUT on those of openings that reach the outline, and MASK_LEAF on the rest in the outline. What is on the other side of the
 * threshold but so thin that no disc of radius `least` has room in it, or in its middle less than half as far off the threshold as what lies around the
 * leaf, is a colour of the leaf (a pale vein, glare, a speck). `t` NULL: no openings.
 * O(pixels of the box), besides what many openings that touch the outline take. */
void openings_mark(const Scan *s, const Polygon *outline, const Threshold *t, double least, const Mask *m, MaskBox box);

/* The disc's radius for a leaf of that area. */
double openings_least(double area);

/* The enclosed openings as curves, between pixels by their levels, simplified within `tolerance` pixels. */
Holes *openings_trace(const Scan *s, const Polygon *outline, const Threshold *t, double least, double tolerance);

/* The part of the scan that holds the outline and `around` pixels more. False when none does. */
bool openings_box(const Scan *s, const Polygon *outline, double around, MaskBox *box);

#endif
