/* Drawn-out tips of a traced outline: where a blade is thinner than about half a pixel no pixel of it is beyond the threshold, and the outline ends early. */
#ifndef SCAN_SHARP_H
#define SCAN_SHARP_H

#include "geom/polygon.h"
#include "scan/mask.h"
#include "scan/scan.h"
#include "scan/threshold.h"

/* The outline, traced between pixels by their levels (march.h, square 1; y-up pixels), with its sharp ends going on along their axes as far as the levels
 * summed across show leaf: such a sum is the local width, however thin. `m` has MASK_THIS where the outline lies around, and the bits `off` on a petiole that was
 * cut off (0: none was); no end goes on into that, into leaf that lies before it, or out of the image. An end that does not taper, is lost in noise, or whose sums swell or go
 * on for long, as along hairs and printed lines, stays as it was; on scans whose ground is noisy that is every one. The result is simple when the outline is and begins where
 * that does; a new one, NULL when nothing changed. at[], unless NULL, receives where each vertex is in it; those beyond which an end went on became its
 * apex. O(vertices), and some thousand pixels a sharp end. */
Polygon *sharp_ends(const Polygon *outline, const Scan *s, const Threshold *t, const Mask *m, uint8_t off, uint32_t *at);

#endif
