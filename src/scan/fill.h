/* The leaf's colours carried on over its border and into its holes, so that no texture shows what lay behind it. */
#ifndef SCAN_FILL_H
#define SCAN_FILL_H

#include "geom/polygon.h"
#include "scan/scan.h"
#include "scan/threshold.h"

/* Replaces every pixel of the leaf's box, `around` pixels wider, that does not lie at least `inset` pixels within the outline (y-up pixels) by the nearest
 * one that does; with a threshold (NULL: none) also those on its other side, which are holes. O(pixels of the box); 5 bytes each for the time. */
void scan_fill(Scan *s, const Polygon *outline, const Threshold *t, double inset, uint32_t around);

#endif
