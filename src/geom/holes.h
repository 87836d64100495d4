/* Holes in a shape: closed curves within its outline. */
#ifndef GEOM_HOLES_H
#define GEOM_HOLES_H

#include "geom/affine.h"
#include "geom/polygon.h"

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
Holes *holes_copy(const Holes *h);

/* A point well within hole k: in the middle of its first stretch at half its height. */
Vec2 holes_point(const Holes *h, uint32_t k);

/* Holes made ready for many questions; NULL holes: none. */
typedef struct {
    uint32_t n;
    Polygon **ring;
} HoleRings;
void hole_rings_init(HoleRings *r, const Holes *h);
void hole_rings_clear(HoleRings *r);
bool hole_rings_contain(const HoleRings *r, Vec2 p);

/* A part of a line from its beginning, 0, to its end, 1. */
typedef struct {
    double from, to;
} Stretch;

/* Appends to `out` (Stretch) what of the line from a to b lies in no hole, in order. Parts shorter than `least` that lie in a hole, then those that
 * lie in none, are taken for what they lie beside; so a line that was cut once is not cut again. O(sides of the holes whose boxes it meets). */
void hole_rings_outside(const HoleRings *r, Vec2 a, Vec2 b, double least, GArray *out);

#endif
