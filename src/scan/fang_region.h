/* From a leaf's rough region and the edges around its border to the region that the edges enclose. */
#ifndef SCAN_FANG_REGION_H
#define SCAN_FANG_REGION_H

#include "scan/fang_tiles.h"

/* How well edges and rough region agree. */
typedef struct {
    double rough, area; /* pixels of the rough region, and of the one that the edges enclose; petioles included, holes filled */
    double continuity;  /* share of the margin that has an edge within 1.5 pixels; what lies on the image's frame is not counted */
    double gap;         /* the longest stretch without, pixels. 0: the edges alone are a closed contour */
} FangMatch;

/* Half the width of the band in which edges are looked for, pixels: a level's border is off the margin by the scanner's blur, and
 * smoothing moves edges by about sigma where the margin is bent. */
double fang_band(double sigma);

/* Moves the border of the region marked by MASK_LEAF to the edges within fang_band of it: the band is flooded from both sides, lowest
 * response first, edges last and the weaker of them first (watershed, Meyer 1991). So the border runs along the strongest of
 * the edges that part inside from outside, and where they have gaps, along the strongest response there. Veins and lines that end in the band
 * part nothing; those outside it do not count. Neither a wide edge nor a soft shadow beside the margin moves the border.
 * `used` are an operator and thresholds that edges_check takes, none of them automatic; the mask is of the image's size and has no other bits, before and
 * after. Where the response is nothing all over, the region stays as it is. O(pixels), and 16 bytes for each in the band. */
FangMatch fang_region(const FangGrey *grey, const EdgesDef *used, const Mask *m);

/* The operator whose response tells how far a place is from an edge, too: Sobel's for those that respond on lines only. */
EdgesOperator fang_broad(EdgesOperator op);

#endif
