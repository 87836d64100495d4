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

/* Reads the path with id "outline", else the closed path of largest area outside of definitions (the first of equals),
 * and the centres of the circles or ellipses with ids "base" and "tip". viewBox, units and styles are ignored; elements
 * of other namespaces are skipped. False with OUTLINE_ERROR_READ or _SYNTAX, naming file, line and element. */
bool svgfile_read(const char *file, SvgShape *out, GError **error);
void svgshape_clear(SvgShape *shape);

#endif
