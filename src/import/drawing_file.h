/* Drawn veins read from files. */
#ifndef IMPORT_DRAWING_FILE_H
#define IMPORT_DRAWING_FILE_H

#include "geom/affine.h"
#include "import/import.h"
#include "sim/drawing.h"

/* Of an SVG file, as Inkscape saves it: the open paths (lines, polylines) of the layer or group whose label or id is "veins", else all open
 * paths of the file; never the one called "outline". Curves are flattened to `flatness` user units. In user units of the document with y
 * turned up (as geom/svgfile.h gives the outline of the same file, so that both fit together), or of `place`, that of the image below it, unless
 * that is NULL; `flatness` is then in its units.
 *   width  stroke-width (attribute or style, of the path or inherited), times the transform's scale; 0 when none is set
 *   order  of the nearest of path, group and groups above whose label or id says it, in any case: "primary", "secondary", "tertiary",
 *          "quaternary" (or their plurals), "midrib", "order-2", "order 2", "2nd"; else, when no name among the veins says any, by nesting, if there
 *          is any: path in "veins" is 1, in a group in it 2 …; else not said
 * What is hidden (display:none, visibility:hidden; by attribute, style or style sheet) is left out; clip-path and mask are not looked at. A clone
 * (<use>) among the veins is IMPORT_ERROR_SYNTAX. A layer "veins" in which nothing is drawn gives an empty drawing; else SVG without an open path
 * is IMPORT_ERROR_GRAPH. */
Drawing *drawing_read_svg(const char *path, double flatness, const Affine *place, GError **error);

/* Plain text polylines: x y a line (blanks, commas or tabs), pixels of an image `height` high with y down; a blank line or a line of letters parts
 * veins. A single polyline that ends where it begins, to a few pixels, or encloses an area as veins do is the outline of a whole vein system as a
 * tracing tool writes it: it is filled and its centre lines are taken (scan/centre.h), with their widths. */
Drawing *drawing_read_tracing(const char *path, double height, GError **error);

#endif
