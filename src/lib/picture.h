/* A small picture of a leaf, for contact sheets. */
#ifndef LIB_PICTURE_H
#define LIB_PICTURE_H

#include "lib/leaf.h"

/* Writes a PNG cropped to the blade, its longer side of `pixels`: the veins black on white, or the leaf as a scanner sees it. */
gboolean leaf_picture(const VenLeaf *leaf, const char *path, uint32_t pixels, gboolean specimen, GError **error);

#endif
