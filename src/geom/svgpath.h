/* SVG path data (SVG 1.1, 8.3), in whatever direction its y axis runs: an arc's sweep flag means from x towards y, so a
 * path that is mirrored to have y up has its sweep flags turned as well. */
#ifndef GEOM_SVGPATH_H
#define GEOM_SVGPATH_H

#include <glib.h>

#include "geom/bezier.h"

typedef struct {
    guint first; /* curve */
    bool closed; /* ends with Z; the closing line is no curve of its own */
} Subpath;

typedef struct {
    GArray *curves;   /* Curve */
    GArray *subpaths; /* Subpath; those without a curve are left out */
} SvgPath;

/* Reads commands M L H V C S Q T A Z, absolute and relative. Returns NULL with OUTLINE_ERROR_SYNTAX, naming the
 * character, for anything else; blank text gives a path without curves. */
SvgPath *svgpath_parse(const char *data, GError **error);
void svgpath_free(SvgPath *path);

/* The other shapes of SVG 1.1, 9, as paths. An ellipse begins and ends at its point of largest y, a drawing's lowest,
 * rather than to the right as SVG has it: a leaf drawn upright is attached there. Of a rectangle that is not rounded rx
 * or ry is 0. Points are read from "x,y x,y …"; NULL with OUTLINE_ERROR_SYNTAX for anything else. */
SvgPath *svgpath_ellipse(Vec2 centre, double rx, double ry);
SvgPath *svgpath_rectangle(Vec2 corner, double width, double height, double rx, double ry);
SvgPath *svgpath_points(const char *data, bool closed, GError **error);

/* A box that holds all curves of one subpath: that of its control points. */
Box2 svgpath_box(const SvgPath *path, guint subpath);

/* The corners of one subpath, from its first point to its last; Vec2. */
GArray *svgpath_flatten(const SvgPath *path, guint subpath, double flatness);

#endif
