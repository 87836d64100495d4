/* A walk through the elements of an SVG file, as a drawing program saves it. The drawing's viewBox is ignored; rules of style sheets are
 * followed as far as geom/svgstyle.h reads them. */
#ifndef GEOM_SVGWALK_H
#define GEOM_SVGWALK_H

#include "geom/affine.h"
#include "geom/outline.h"
#include "geom/svgpath.h"

typedef struct SvgElement SvgElement;
struct SvgElement {
    const SvgElement *above;      /* NULL: it is the first, svg */
    const char *name;             /* without the prefix of SVG's namespace */
    const char *id, *label;       /* inkscape:label; NULL: none */
    Affine map;                   /* from its user units to the drawing's, y turned up */
    bool defined;                 /* it, or one above it, only defines things (defs, clipPath, …) */
    bool hidden;                  /* gone or unseen */
    bool gone;                    /* it, or one above it, has display:none */
    bool unseen;                  /* visibility:hidden, its own or inherited */
    double stroke;                /* stroke-width, its own or inherited, in its user units; 0: none is set */
    const char **names, **values; /* attributes, NULL at the end; while it is seen */
};

/* Called for each element of the SVG namespace in order; false, with an error, ends the walk. */
typedef bool (*SvgSeen)(const SvgElement *e, void *user, GError **error);

/* False with G_FILE_ERROR, or OUTLINE_ERROR_SYNTAX; the latter, from `see` too, get file and line in front. */
bool svgwalk_file(const char *file, SvgSeen see, void *user, GError **error);

/* NULL: not set. While it is seen. */
const char *svgelement_attribute(const SvgElement *e, const char *name);

/* A length with or without a unit in user units (CSS pixels); % are of `whole`, if that is above 0. False for what isn't one, or NULL. */
bool svgwalk_length(const char *text, double whole, double *length);

/* A viewBox: x, y, width, height. False for what isn't one, or NULL. */
bool svgwalk_box(const char *text, double box[4]);

/* From the units of a viewBox to those around it, where it fills a port (x, y, width, height) as preserveAspectRatio (NULL: xMidYMid meet)
 * says (SVG 1.1, 7.8). */
Affine svgwalk_viewport(const double port[4], const double box[4], const char *ratio);

/* A group or layer, or the drawing itself. */
bool svgelement_is_group(const SvgElement *e);

/* A path, polygon, polyline, line, rect, circle or ellipse as a path of the drawing, y up. NULL with OUTLINE_ERROR_SYNTAX, which does not
 * name the element. */
bool svgelement_is_shape(const SvgElement *e);
SvgPath *svgelement_path(const SvgElement *e, GError **error);

/* The centre of a circle or ellipse; false with OUTLINE_ERROR_SYNTAX. */
bool svgelement_is_round(const SvgElement *e);
bool svgelement_centre(const SvgElement *e, Vec2 *centre, GError **error);

#endif
