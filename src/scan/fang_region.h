/* From a map of edges to the region that they enclose. */
#ifndef SCAN_FANG_REGION_H
#define SCAN_FANG_REGION_H

#include "scan/edges.h"
#include "scan/mask.h"
#include "scan/threshold.h"

/* Marks what the edges enclose by MASK_LEAF in a mask of the scan's size, and returns the edge map; *closed is the radius by which gaps
 * were closed.
 *
 * What lies around is what the background's part of the image's frame is connected with: stretches of the frame between edges are leaf
 * when their mean level is on the leaf's side of the threshold, so a leaf may be cut by the frame. Gaps in the edges are closed by discs
 * of up to 4 pixels, and when `lower` also by thresholds as low as 2/3 and 4/9 of def->low, which is changed accordingly: by the first
 * of the choices, from strict to lax, that encloses 0.985 of the strict edges that any of them does (an outline with too wide a gap
 * leaves the edges of a lobe outside). Threads, loose edges, are taken off. The band of edge pixels itself is parted where the response
 * is greatest, by flooding it from both sides, lowest first (watershed, Meyer 1991): so neither a wide band nor a soft shadow beside the
 * margin moves the border.
 *
 * Plain parts between edges are leaf or around it by their mean level, like the frame.
 *
 * `response` is one that is not just lines. NULL and SCAN_ERROR_NO_LEAF when much less or more is enclosed than there is leaf by its
 * level, or `error` for unusable settings. O(pixels), and 16 bytes for each edge pixel. */
GreyImage *fang_region(const Scan *s, const Threshold *t, const GreyImage *grey, const GreyImage *response, bool lower, EdgesDef *def,
                       const Mask *m, double *closed, GError **error);

#endif
