/* What is on a picture of a leaf, for training: annotations in COCO's terms. */
#ifndef BATCH_LABELS_H
#define BATCH_LABELS_H

#include "lib/leaf.h"

/* Categories, by number; label_category names them. */
enum { LABEL_LAMINA = 1, LABEL_AREOLE, LABEL_VEIN, LABEL_LAST = LABEL_VEIN };
const char *label_category(int id);

/* Areoles of fewer pixels are left out: they are too small to be told from noise, and some have no pixel at all. */
enum { LABEL_LEAST_AREOLE = 16 };

/* Writes the annotations of the leaf's maps, one JSON object a line, without numbers of image and annotation: the lamina as a polygon, in pixels from the
 * top left corner, simplified within a quarter of a pixel, or run-length encoded where the blade has holes, of the pixels it covers by half or more; each areole run-length encoded, of the pixels that hold its number ("label") in the map of
 * areoles; all veins as one, run-length encoded, of all pixels that have an order in the map of orders. None is without a pixel. */
gboolean labels_write(const VenLeaf *leaf, const char *path, GError **error);

#endif
