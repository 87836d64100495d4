/* Affine maps of the plane, as SVG writes them. */
#ifndef GEOM_AFFINE_H
#define GEOM_AFFINE_H

#include <glib.h>

#include "geom/vec.h"

/* x' = a x + c y + e, y' = b x + d y + f. */
typedef struct {
    double a, b, c, d, e, f;
} Affine;

static inline Vec2 affine_apply(const Affine *m, Vec2 p)
{
    return vec2(m->a * p.x + m->c * p.y + m->e, m->b * p.x + m->d * p.y + m->f);
}

/* The map that does `inner` first, then `outer`. */
Affine affine_multiply(const Affine *outer, const Affine *inner);

/* Reads an SVG transform list: matrix, translate, scale, rotate, skewX, skewY. False with OUTLINE_ERROR_SYNTAX, naming
 * the character, for anything else. */
bool affine_parse(const char *text, Affine *out, GError **error);

#endif
