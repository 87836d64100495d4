/* How strong an edge must be to be the leaf's. */
#ifndef SCAN_FANG_EDGES_H
#define SCAN_FANG_EDGES_H

#include "scan/fang_tiles.h"

/* Chooses thresholds where def->automatic, and smoothing where def->sigma is 0 as well, for grey values 0 … 255 of which `level` parts leaf
 * and background and a mask of the same size that marks the rough region by MASK_LEAF and no other bit. M is the median of the operator's
 * greatest responses within a pixel of where the level is crossed near the region's border. Edges are responses above M/2, and those
 * above M/4 that are connected with them. The image is smoothed by the least of 0, 1, 1.5, 2, 3 and 4 pixels, for Canny's operator and the
 * Laplacian no less than 1, with which M/4 is above 2.5 times the usual response of the ground: noise, texture, a grid; a sigma that is given
 * is kept to. Otsu's threshold on the responses, edges_map's own, serves where nothing but the margin responds; where a scan's
 * noise fills half of it, it lies in the noise. False and `error` for unusable settings. */
bool fang_choose_edges(const FangGrey *grey, double level, const Mask *m, EdgesDef *def, GError **error);

#endif
