/* From the border of a region of pixels to where its edges are strongest. */
#ifndef SCAN_FANG_DRAW_H
#define SCAN_FANG_DRAW_H

#include "geom/polygon.h"
#include "scan/fang_tiles.h"

#define FANG_DRAW_REACH 4.0 /* pixels: what is looked at, half a pixel to either side of it, and one for the neighbours */

/* Edge strength in a part of the image. */
typedef struct {
    const FangSparse *response; /* edges_response, within FANG_DRAW_REACH of the border */
    EdgesOperator op;
    Vec2 corner;                /* of the part, in the image plane, y down */
    double width, height;       /* of the whole image, pixels */
} Strength;

/* Moves every vertex of a region's border (y-up pixels, a vertex a pixel or more) along its normal to the strongest response within 1.5
 * pixels, smoothed along the border (median, then mean, of 9). Stays simple: where it would cross itself, vertices stay where they are.
 * So do those at the image's frame and where the response is nothing. */
Polygon *fang_draw(const Polygon *border, const Strength *s);

#endif
