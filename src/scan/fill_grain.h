/* The grain of a leaf: what its colours have beyond their means, lent to places that have none of their own. Private to fill. */
#ifndef SCAN_FILL_GRAIN_H
#define SCAN_FILL_GRAIN_H

#include "scan/mask.h"
#include "scan/scan.h"

enum { GRAIN_CELL = 16 }; /* pixels a side */

typedef struct {
    uint32_t width, height; /* cells; those of the last column and row may stick out of the box */
    float *unrest;          /* mean square that pixels are off their cell's mean, all channels; negative: not wholly of the leaf */
} FillGrain;

/* `mask` is of a box of the scan; MASK_CORE is what is surely leaf. */
void fill_grain_init(FillGrain *g, const Scan *s, const Mask *mask, MaskBox box);
void fill_grain_clear(FillGrain *g);

/* Which cell lends cell x, y its grain, and how it is turned over. */
typedef struct {
    uint32_t x, y;
    bool flip_x, flip_y;
} GrainSource;

/* One of the calmer half (without veins) of the nearest cells that are wholly leaf, by lot. False when there is none within 64 cells. */
bool fill_grain_source(const FillGrain *g, uint32_t x, uint32_t y, GrainSource *out);

#endif
