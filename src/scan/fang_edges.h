/* How strong an edge must be to be the leaf's. */
#ifndef SCAN_FANG_EDGES_H
#define SCAN_FANG_EDGES_H

#include "scan/edges.h"
#include "scan/threshold.h"

/* Chooses smoothing and thresholds for a channel's grey values (0 … 255) where def->automatic, by how strong the operator's response to
 * the margin is: M, the median of the greatest within a pixel of where the level crosses the threshold. Edges are responses above M/2,
 * and those above M/4 that are connected with them. The image is smoothed by the least of 0, 1, 1.5, 2, 3 and 4 pixels, but no less than
 * def->sigma, with which M/4 is above 2.5 times the usual response of the whole image: noise, texture, a grid. Otsu's threshold on the
 * responses, edges_map's own, serves where nothing but the margin responds; where a scan's noise fills half of it, it lies in the noise.
 * False and `error` for unusable settings. */
bool fang_choose_edges(const Scan *s, const Threshold *t, const GreyImage *grey, EdgesDef *def, GError **error);

#endif
