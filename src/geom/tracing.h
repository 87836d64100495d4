/* The margin of a leaf as a tracing tool writes it: plain text, a point a line. */
#ifndef GEOM_TRACING_H
#define GEOM_TRACING_H

#include "geom/svgfile.h"

/* Whether a file begins with a number, as no SVG file does. False for one that can't be read. */
bool tracing_is(const char *file);

/* x y a line (blanks, commas or tabs between them), y down as in images; closed by its last side. The same as a polygon of SVG with these points. Blank
 * lines part lines that are closed each; these, and one that crosses itself, are drawn over lobes that overlap: the blade is all they wind around, gaps
 * between lobes filled (geom/winding.h), and begins with the first point, which is marked as the base when others lie over it. A `half`, to be mirrored, is
 * one open line. No tip is marked. False with OUTLINE_ERROR_READ, _SYNTAX or _SHAPE, naming file and line. */
bool tracing_read(const char *file, bool half, SvgShape *out, GError **error);

/* What both kinds of tracings, margins and veins (import/drawing_file.h), have in common: what parts numbers, and how large they may be, pixels. */
static inline bool tracing_is_gap(char c) { return c == ' ' || c == '\t' || c == ',' || c == ';' || c == '\r'; }
#define TRACING_FARTHEST 1e6

#endif
