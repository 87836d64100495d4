/* The leaf's colours carried on over its border and into its openings, so that no texture shows what lay behind it. */
#ifndef SCAN_FILL_H
#define SCAN_FILL_H

#include "geom/polygon.h"
#include "scan/scan.h"
#include "scan/threshold.h"

/* Replaces what in the outline (y-up pixels) and up to `around` pixels beyond it is not surely leaf: what lies within `inset` pixels of the outline or of an
 * opening (scan/openings.h; `t` NULL: none are looked for), where scanners blur and shadows fall. Parts of a leaf that are narrower throughout and long,
 * like petioles, keep their middle; a petiole that lies over the blade (scan/stalk_over.h; the outline begins at the base then) is taken out. What takes its place goes on smoothly from the leaf's own colours, as a membrane stretched between
 * them would (Laplace's equation, solved from coarse to fine on a pyramid of means; Gortler et al. 1996, push-pull), and within the outline has the grain
 * of the leaf near it. Some 30 operations a pixel of the box and channel; about 2 bytes a pixel of the box for the time. */
void scan_fill(Scan *s, const Polygon *outline, const Threshold *t, double inset, uint32_t around);

/* What is wise for a leaf of that area: 0.8 % of its root, 3 pixels at least. */
double scan_fill_inset(double area);

#endif
