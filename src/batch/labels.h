/* What is on a picture of a leaf, for training: annotations in COCO's terms. */
#ifndef BATCH_LABELS_H
#define BATCH_LABELS_H

#include "lib/leaf.h"

/* Categories, by number; label_category names them. */
enum { LABEL_LAMINA = 1, LABEL_AREOLE, LABEL_VEIN, LABEL_LAST = LABEL_VEIN };
const char *label_category(int id);

/* Writes the annotations of the leaf's maps, one JSON object a line, without numbers of image and annotation: the lamina and each areole as a polygon, in
 * pixels from the top left corner, simplified within a quarter of a pixel (an areole that holds islands by its outer boundary); all veins as one run-length
 * encoded crowd, of pixels that veins cover by half or more. */
gboolean labels_write(const VenLeaf *leaf, const char *path, GError **error);

#endif
