/* How a drawing that was made over an image lies on that image's pixels. */
#ifndef GEOM_SVGPLACE_H
#define GEOM_SVGPLACE_H

#include "geom/affine.h"

typedef struct {
    const char *file;       /* its path or name */
    uint32_t width, height; /* pixels, as seen: turned upright */
} SvgUnder;

typedef struct {
    Affine map;     /* from the drawing's user units, y turned up, to columns and negative rows: the image's upper left corner is 0,0 */
    Affine inverse;
    char *how;      /* in words, to go on after "the drawing was laid on the scan by" */
} SvgPlace;

/* By the drawing's <image> outside of definitions, hidden or not: the one whose address ends in the file's name, else the largest; with x, y, width,
 * height, preserveAspectRatio and all transforms. Any copy of the scan will do, of whatever resolution, linked or embedded, so long as it
 * shows all of it. Without an image by the page, when its viewBox, else its width and height, has the shape of the scan to 1 %; else units are
 * pixels. Errors as svgwalk_file's. */
bool svgplace_find(const char *drawing, const SvgUnder *under, SvgPlace *out, GError **error);
void svgplace_clear(SvgPlace *place);

#endif
