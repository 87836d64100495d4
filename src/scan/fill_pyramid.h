/* Means of a part of an image over ever larger squares, carried on to where there is nothing to take them of. Private to fill. */
#ifndef SCAN_FILL_PYRAMID_H
#define SCAN_FILL_PYRAMID_H

#include "scan/mask.h"
#include "scan/scan.h"

typedef struct {
    uint32_t width, height;
    uint8_t *state;
    uint16_t *value; /* one channel's, in parts of a grey value */
} FillLevel;

enum { FILL_LEVELS = 32 };

/* A cell of level k is a square of 2 << k pixels. */
typedef struct {
    uint32_t n;
    double parts; /* of a grey value: 256 of 8 bits, 1 of 16; a float would take the memory of another image */
    FillLevel level[FILL_LEVELS];
} FillPyramid;

/* `mask` is of a box of a scan of `depth` bits: MASK_CORE is what is known, MASK_SEEN what is wanted. At least one pixel is known. */
void fill_pyramid_init(FillPyramid *p, const Mask *mask, uint32_t depth);
void fill_pyramid_clear(FillPyramid *p);

/* Takes one channel of the scan: means of what is known, and between them, where values are wanted, the solution of Laplace's equation, nearly. */
void fill_pyramid_take(FillPyramid *p, const Scan *s, uint32_t channel, const Mask *mask, MaskBox box);

/* The value at a place of the box, columns and rows, bilinear between centres of cells. */
double fill_pyramid_at(const FillPyramid *p, uint32_t level, double x, double y);

#endif
