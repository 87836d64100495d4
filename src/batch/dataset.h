/* The leaves of a sweep as pairs of image and label, in a layout that segmentation tools read.
 *
 *     OUT/dataset/images/train/NAME.png    the specimen; val: for validation
 *                 lamina/train/NAME.png    part of the pixel that the blade covers, 0 … 255
 *                 vein/train/NAME.png      the same of the veins
 *                 order/train/NAME.png     order of the vein at the pixel; 0 none
 *                 areole/train/NAME.png    number of the areole at the pixel, 16 bits; 0 none
 *                 annotations/train.json   COCO: lamina, areoles, veins
 *                 README.txt               this, and how many there are */
#ifndef BATCH_DATASET_H
#define BATCH_DATASET_H

#include "batch/batch.h"

/* Sets what such leaves are written as: maps, specimen, and nothing else. */
gboolean dataset_params(Params *p, const char *origin, GError **error);

/* FALSE with an error where a folder of that name is in the way that is no data set of ours. */
gboolean dataset_check_place(const char *out, GError **error);

/* Lays the data set out from the leaves that are there. Files are linked, or copied where that can't be. A part `validation` (0 … 1) of the
 * leaves is for validation: chosen by the seed, so that leaves of one seed are on one side; by the variant where seeds don't vary. An old data set there is
 * replaced when the new one is complete. Memory does not go with the number of variants. */
gboolean dataset_write(const BatchDef *def, double validation, GError **error);

#endif
