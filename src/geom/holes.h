/* Holes in a shape: closed curves within its outline. */
#ifndef GEOM_HOLES_H
#define GEOM_HOLES_H

#include <stdint.h>

#include "geom/affine.h"

/* Clockwise around the hole where the outline is counter-clockwise: hole k has points start[k] … start[k + 1] - 1. */
typedef struct {
    uint32_t n, *start; /* [n + 1] */
    Vec2 *p;
    double area; /* of all, positive */
} Holes;

/* No holes; holes_add copies n >= 3 points and turns them clockwise. */
Holes *holes_new(void);
void holes_add(Holes *h, const Vec2 *p, uint32_t n);
void holes_free(Holes *h);

/* The same holes elsewhere; by a map that does not mirror. A new one; NULL for NULL. */
Holes *holes_mapped(const Holes *h, const Affine *map);

#endif
