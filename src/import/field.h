/* What a file may say of nodes, edges and the whole network, and how such values are written. Private to src/import. */
#ifndef IMPORT_FIELD_H
#define IMPORT_FIELD_H

#include <glib.h>

#include "geom/holes.h"
#include "geom/polygon.h"

typedef enum { DOMAIN_NODE, DOMAIN_EDGE, DOMAIN_GRAPH, DOMAIN_COUNT } Domain;

typedef enum {
    FIELD_X,
    FIELD_Y,
    FIELD_NODE_BIRTH,
    FIELD_KIND,
    FIELD_ORDER,
    FIELD_RANK,
    FIELD_VEIN,
    FIELD_WIDTH,
    FIELD_FLOW,
    FIELD_BIRTH,
    FIELD_MARGIN,
    FIELD_HOLES,
    FIELD_BASE,
    FIELD_TIP,
    FIELD_STEPS,
    FIELD_COUNT,
} FieldId;

/* Largest coordinate, segments: products of them stay exact enough, and finite. */
#define FIELD_LARGEST 1e9

#define FIELD_BIT(field) (1u << (field))

Domain field_domain(FieldId field);
const char *field_name(FieldId field);

/* The field of that name, FIELD_COUNT if there is none. */
FieldId field_find(Domain domain, const char *name);

/* The value of any field but margin, holes, base and tip; a kind is its EdgeKind. Whole numbers may be written as 3.0, as programs do that know but one
 * kind of number. On failure the error (in IMPORT_ERROR, as all of src/import) says what was found and what may be. */
gboolean field_value(FieldId field, const char *text, gsize length, double *out, GError **error);

/* Base or tip: x,y. */
gboolean field_point(FieldId field, const char *text, gsize length, Vec2 *out, GError **error);

/* The margin: points that repeat the one before, to a millionth of a segment, are left out, and last ones that repeat the first. */
Polygon *field_margin(const char *text, gsize length, GError **error);

/* The same of points (Vec2), which it frees. */
Polygon *field_outline(GArray *points, GError **error);

/* Holes of the blade: the points of one after those of another, with ';' between. */
Holes *field_holes(const char *text, gsize length, GError **error);

#endif
