/* The edge map of part of a scan as a bit of a mask, made tile by tile. */
#ifndef SCAN_FANG_MAP_H
#define SCAN_FANG_MAP_H

#include "scan/fang_tiles.h"

/* Sets MASK_SEEN where edges_map has 1, of a mask of the image's size that has no bits but MASK_LEAF. `used`: as edges_check takes them, no automatic ones. */
void fang_mark_edges(const FangGrey *grey, const EdgesDef *used, const Mask *m);

#endif
