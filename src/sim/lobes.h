/* The lobes of a blade as seen from its base, for veins that run into them. */
#ifndef SIM_LOBES_H
#define SIM_LOBES_H

#include "geom/polygon.h"

enum { LOBES_MOST = 9 }; /* four on either side of the middle one */

typedef struct {
    Vec2 tip;          /* on the margin, or for the middle lobe the leaf's tip */
    Vec2 left, right;  /* unit vectors from the hub along the ends of its field: the sinuses */
    bool open_left, open_right; /* there is none on that side: the outermost lobe's field goes round to the petiole */
} Lobe;

typedef struct {
    Vec2 hub;            /* on the axis: where primaries part */
    uint32_t n, middle;  /* from left to right; lobe[middle] has the leaf's tip */
    uint32_t found;      /* how many were seen in the outline on the side that shows fewer; others are mirrored, or fill gaps */
    Lobe lobe[LOBES_MOST];
} Lobes;

/* Of a leaf in leaf coordinates (base 0,0, tip 0,1). The hub is the lowest place on the axis, no higher than 0.12, from which nearly as
 * much of the blade is seen as from any: a stump of petiole or a dent at the base hides it. A lobe is a maximum of the way from the hub to the
 * margin that stands out by 15 % from the sinuses beside it (teeth stand out by less; lobes of pinnate leaves lie ever farther from the base
 * and are none). Primaries come in pairs: what is seen on one side alone gets a partner where there is blade. Where none is seen, or
 * more than 75° would have no primary, they are spread evenly. O(vertices) for each of some 1900 rays. */
void lobes_find(const Polygon *leaf, Lobes *out);

/* How far from `at` the margin is first crossed in a direction (unit vector), no more than `most`; 0 when the blade is left at once. O(n). */
double lobes_way(const Polygon *p, Vec2 at, Vec2 direction, double most);

#endif
