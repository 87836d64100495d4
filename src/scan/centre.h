/* Centre lines of thin regions: from a mask of veins to lines with widths. */
#ifndef SCAN_CENTRE_H
#define SCAN_CENTRE_H

#include "scan/mask.h"
#include "sim/drawing.h"

/* Thins the region of bit `from` to lines one pixel wide (8-connected, topology kept: parts and holes stay as many) and writes it to bit `to`.
 * O(pixels); a byte a pixel of the region's box, eight a pixel of the region. */
void centre_thin(const Mask *m, uint8_t from, uint8_t to);

typedef struct {
    double hole;      /* holes of fewer pixels than this are filled first: noise, not what veins run around */
    double spur;      /* ends shorter than this times the width where they leave are no veins but bumps of the border */
    double tolerance; /* of the lines' simplification, pixels */
    double least;     /* parts whose lines are shorter than this altogether are specks, pixels */
} CentreDef;
CentreDef centre_def_default(void);

/* The centre lines of a region as veins: pieces from junction to junction or end, joined through junctions where they go on straightest; y up,
 * pixel units (pixel (i, j) from the top is [i, i+1] × [height-j-1, height-j]); widths are twice the distance to the region's border.
 * Pixels of clusters at junctions count as one. O(pixels). */
Drawing *centre_lines(const Mask *m, uint8_t bit, const CentreDef *def);

#endif
