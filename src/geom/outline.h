/* The margin of a leaf blade as one closed polygon in leaf coordinates: base (petiole attachment) at (0,0), tip at
 * (0,1), so a length of 1 is the leaf's length, base to tip. Counter-clockwise, no repeated vertices, never
 * self-crossing. */
#ifndef GEOM_OUTLINE_H
#define GEOM_OUTLINE_H

#include <glib.h>

#include "geom/polygon.h"
#include "geom/svgplace.h"
#include "geom/vec.h"

typedef enum {
    OUTLINE_ERROR_READ,      /* the file can't be read */
    OUTLINE_ERROR_SYNTAX,    /* not a path, not SVG */
    OUTLINE_ERROR_SHAPE,     /* self-crossing, empty, a sliver, base and tip coincide, … */
} OutlineError;
#define OUTLINE_ERROR outline_error_quark()
GQuark outline_error_quark(void);

/* One triangular waveform along the margin (Runions 2005, section 3.2): teeth are the sum of several. */
typedef struct {
    double amplitude; /* height of a tooth above the smooth margin, leaf lengths */
    double count;     /* teeth on each side, base to tip */
} OutlineWave;

/* Where an outline comes from and what is done to it. outline_def_default() gives a plain ovate leaf. */
typedef struct {
    const char *path;       /* SVG path data, x right and y UP, or NULL */
    const char *file;       /* SVG file, or a tracing (geom/tracing.h), y down; or NULL; exactly one of path and file is set */
    const char *where;      /* names the origin in error messages, e.g. "params/poplar.ini, [outline] path" */
    const SvgPlace *place;  /* of the file on an image, whose units (geom/svgplace.h) base and tip are returned in; NULL: the file's own */
    bool has_base, has_tip; /* given by hand, in the units of path or file; else by rule, see outline_new */
    Vec2 base, tip;
    bool mirror;            /* path is the right half from base to tip, its last point: reflect it about the axis */
    double flatness;        /* largest distance of a flattened curve from the polygon, leaf lengths */
    const OutlineWave *waves;
    uint32_t n_waves;
    double tooth_skew;      /* where a tooth peaks in its period: 0.5 even, towards 1 it points at the tip */
    double tooth_from, tooth_to; /* part of each side (0 base … 1 tip, by arc length) that bears teeth */
} OutlineDef;

OutlineDef outline_def_default(void);

/* Reads the path (or the file, as svgfile_read does: the shape called "outline", else the largest closed path; circles or
 * ellipses called "base" and "tip" mark those points), flattens the curves, adds the teeth and moves the result to leaf
 * coordinates. Without marks the base is the first point of the path and the tip the vertex farthest from it (of a half
 * that is mirrored, its last point). The base may lie on the margin or inside the blade (peltate); nearer to the margin
 * than `flatness` or 1e-6 it is on it and becomes vertex 0, and so does a tip there become a vertex. Several subpaths
 * are an error. Returns NULL and sets `error`, which names `where`, for a shape that is empty, crosses itself (it says
 * where), is a sliver (its mean width below a thousandth of its size) or has base = tip. Uses + − × ÷ √ only, so the
 * polygon has the same bits everywhere. O(n log n) expected. */
Polygon *outline_new(const OutlineDef *def, GError **error);

/* The same; *base and *tip receive where 0,0 and 0,1 were in the units of path or file, or of the image it was placed on, y up. */
Polygon *outline_new_from(const OutlineDef *def, Vec2 *base, Vec2 *tip, GError **error);

#endif
