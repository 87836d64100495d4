/* The margin of a leaf in an SVG file, as a drawing program saves it. */
#ifndef GEOM_SVGFILE_H
#define GEOM_SVGFILE_H

#include <glib.h>

#include "geom/svgpath.h"

/* In the user units of the drawing with all transforms applied, y turned up. */
typedef struct {
    SvgPath *path;
    bool has_base, has_tip;
    Vec2 base, tip;
} SvgShape;

/* Reads the shape that is called "outline", by its id or its label in Inkscape; else the closed path or polygon of largest
 * area outside of definitions (the first of equals), and without any the largest rectangle, circle or ellipse, which may
 * be a page's background; hidden ones count only when they are called so. Also the centres of the circles or ellipses that are called "base" and "tip". viewBox, units
 * and other styles are ignored; elements of other namespaces are skipped, and so are labels of groups and layers. False with
 * OUTLINE_ERROR_READ or _SYNTAX, naming file, line and element. */
bool svgfile_read(const char *file, SvgShape *out, GError **error);
void svgshape_clear(SvgShape *shape);

#endif
