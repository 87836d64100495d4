/* The drawing over a scan: what was captured, for Inkscape to correct. */
#ifndef EXPORT_DRAWING_H
#define EXPORT_DRAWING_H

#include <glib.h>

#include "geom/affine.h"
#include "geom/holes.h"
#include "sim/drawing.h"

typedef struct {
    const char *title;
    uint32_t width, height; /* of the scan, pixels */
    double mm_per_pixel;    /* 0: unknown */
    const char *image;      /* where the scan lies, seen from the file: a relative path or a URI */
    const Polygon *outline; /* leaf coordinates, base 0,0, tip 0,1 */
    const char *curves;     /* SVG path data of the outline in pixels, y down, as curves; or NULL: the polygon */
    const Holes *holes;     /* leaf coordinates; or NULL: none */
    const Drawing *veins;   /* leaf coordinates; or NULL */
    const uint8_t *order;   /* [veins->n] under which each is drawn; or NULL: as it says itself */
    Affine to_scan;         /* leaf coordinates to columns and rows */
} DrawingSheet;

/* SVG in pixels of the scan with four layers or five: "scan" (the image, locked), "outline" (the path called so), "holes" if there are any (locked: they are the scan's), "marks" (circles base and tip) and "veins", in which
 * a group an order holds a path a vein, its stroke as wide as the vein on average. svgfile_read and drawing_read_svg read it back. */
gboolean export_drawing_svg(const DrawingSheet *sheet, const char *path, GError **error);

#endif
