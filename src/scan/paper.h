/* A sheet of paper that lies in an image: a convex polygon of straight sides. */
#ifndef SCAN_PAPER_H
#define SCAN_PAPER_H

#include "geom/vec.h"
#include "scan/mask.h"

enum { PAPER_SIDES = 4, PAPER_CORNERS = 2 * PAPER_SIDES }; /* the image's edges may cut off all four corners */

/* Pixels, y down, the image's upper left corner at 0,0; clockwise as seen. No corners: there is no sheet, and the whole image is meant. */
typedef struct {
    uint32_t n;
    Vec2 corner[PAPER_CORNERS];
} Paper;

/* Fits a sheet to the region of a bit in a mask, on which nothing is but a leaf or two. False where the region is none: has more than four straight sides besides
 * those along the mask's edge, or none, or doesn't fill them. O(pixels). */
bool paper_fit(const Mask *m, uint8_t bit, Paper *out);

/* Its sides but those along the edges of that mask moved inward by `inset` of its pixels; then in pixels `scale` times as small. */
Paper paper_scaled(const Paper *p, uint32_t width, uint32_t height, double scale, double inset);

/* Columns *from … *to - 1 of row y have their centres on the sheet; false where none do. */
bool paper_span(const Paper *p, uint32_t width, uint32_t y, uint32_t *from, uint32_t *to);

double paper_area(const Paper *p);

#endif
