/* Exact area of the union of strokes within one pixel. The parts of strokes in the pixel are convex polygons; a
 * stroke's area is what is left of it after cutting away the strokes before it. Only half-plane cuts are made, so
 * touching and coincident edges need no special cases. Most parts are neighbours along a vein, which are cut where they meet: those don't overlap. */
#ifndef IMAGE_CONVEX_H
#define IMAGE_CONVEX_H

#include "image/capsule.h"
#include "image/rings.h"

/* Unit vectors, CIRCLE of them, evenly around the circle. */
enum { CIRCLE = 4096 };

typedef struct {
    Vec2 dir[CIRCLE];
} Circle;

Circle *circle_new(void);

typedef struct {
    const Circle *circle;
    Rings part;       /* the strokes within the pixel */
    Rings mask;       /* the polygon that they are seen through */
    Rings scratch[4]; /* of the following, which take turns */
    Rings *rest, *next; /* what is left of one of them */
    Rings *ping, *pong; /* polygons being cut */
    uint32_t *place;  /* of each part, see union_add */
    uint32_t cap_place;
    uint32_t *rank;   /* parts by size */
    double *size;
    uint32_t cap;
} Union;

void union_init(Union *u, const Circle *circle);
void union_clear(Union *u);

/* Begins a pixel. */
void union_reset(Union *u);

/* Half-planes through the end discs' centres across the axis that a stroke may be cut with. */
typedef enum { CUT_NONE = 0, CUT_A = 1, CUT_B = 2 } StrokeCut;

/* How a stroke ends: cut or not, and half-planes through the discs' centres at a and b, beyond which the next stroke has the rest; (0, 0): none. */
typedef struct {
    unsigned cut;   /* StrokeCut: the end has no disc */
    unsigned mitre; /* StrokeCut: such that the next stroke has all of the rest, so that this one is cut there alone, not across its axis */
    Vec2 side[2];
} StrokeEnds;

/* Adds the part of a stroke in the pixel whose top left corner is `corner`. Parts whose places differ by 1 don't overlap, nor do such as differ by 2 and are
 * even. */
void union_add(Union *u, const Capsule *k, const StrokeEnds *ends, Vec2 corner, uint32_t place);

/* Adds the wedge between two strokes that are both cut at their joint: the part of the disc that lies beyond the first,
 * which runs along d0, and before the second, which runs along d1. They aren't parallel. */
void union_add_wedge(Union *u, Vec2 centre, double radius, Vec2 d0, Vec2 d1, Vec2 corner, uint32_t place);

/* Area covered, 0 … 1. About 1e-4 exact. */
double union_area(Union *u);

/* The same of what lies within a polygon, convex or not, of n points in image coordinates; `corner` is the pixel's. */
double union_area_within(Union *u, const Vec2 *v, uint32_t n, Vec2 corner);

/* Adds the polygon in `ping` to the parts. */
void union_put(Union *u, uint32_t place);

/* Cuts the polygon in `ping`, which lies in the pixel 0 … 1, with the half-plane p · normal <= bound. FALSE when nothing is left. */
bool union_cut(Union *u, Vec2 normal, double bound);

#endif
