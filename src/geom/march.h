/* Outlines of a region of pixels by marching squares (Hong 2005, § 5.2.2 and 5.2.3). */
#ifndef GEOM_MARCH_H
#define GEOM_MARCH_H

#include "geom/vec.h"

/* The pixels, rows from the top; one is leaf when its bits `test` are `want`, and beyond the image there is none. */
typedef struct {
    const uint8_t *px; /* [height][width] */
    uint32_t width, height;
    uint8_t test, want;
    uint32_t x0, y0, x1, y1; /* columns and rows, last ones included, that hold all of the leaf */
    /* Grey levels that the pixels were parted by, at `threshold`; NULL: none. */
    double (*level)(const void *user, uint32_t x, uint32_t y);
    const void *user;
    double threshold;
} MarchField;

/* Closed curves, one after the other. Loop k has points start[k] … start[k + 1] - 1 and encloses area[k]: positive, counter-clockwise
 * around leaf; negative, clockwise around a hole. */
typedef struct {
    uint32_t n;
    uint32_t *start; /* [n + 1] */
    double *area;    /* [n] */
    Vec2 *p;         /* pixels, y up: the image is the box from (0, 0) to (width, height), pixel centres are at halves */
} MarchLoops;

/* Walks a square of `square` >= 1 pixels a side along the region's boundary, leaf on the left, its corners at the centres of the pixels whose
 * column and row are multiples of `square`, and notes a point wherever the boundary crosses one of the square's edges: without
 * levels halfway between the corners (at the image's own border where that is nearer); with levels where, going from the leaf corner,
 * the first pixel is not leaf, and between that pixel and the one before where the level interpolated linearly is the threshold.
 *
 * Corners are numbered 1 top left, 2 bottom left, 4 top right, 8 bottom right, and their sum is the thesis' squareIndex, less 1 than
 * its pattern number. In the two ambiguous patterns, (7) and (10), the two leaf corners are connected and the others parted, as in its
 * look-up table: leaf pixels hang together over corners, background only over edges. The choice is the same in every square, so the
 * curves close, and as no crossing lies on a corner, they never touch themselves or each other.
 *
 * Loops are in the order in which scanning line by line meets them. O(corners in the box + points). */
MarchLoops *march_loops(const MarchField *f, uint32_t square);
void march_loops_free(MarchLoops *l);

/* Index of the loop with the greatest area, of equals the first; l->n when there is no leaf. */
uint32_t march_largest(const MarchLoops *l);

#endif
