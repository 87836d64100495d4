/* Closed lines that may cross themselves and one another: the margin of the area that they wind around. */
#ifndef GEOM_WINDING_H
#define GEOM_WINDING_H

#include <glib.h>

#include "geom/vec.h"

typedef enum {
    WINDING_SIMPLE, /* one line that neither crosses nor touches itself: it is its own margin */
    WINDING_UNITED,
    WINDING_EMPTY,  /* no area */
    WINDING_APART,  /* several areas, or some that share points alone */
    WINDING_TANGLE, /* more crossings than a drawing has */
} WindingKind;

typedef struct {
    WindingKind kind;
    GArray *margin;   /* Vec2, counter-clockwise, simple; empty but for the first two kinds */
    bool first_in;    /* the very first point lies within the area; else the margin begins with it */
    uint32_t part[2]; /* of areas apart, a point of each of the largest two */
    double area[2];
} Winding;

/* Line k is p[start[k]] … p[start[k + 1] - 1] and closed by its last side; finite points. The area is what any line winds around, whichever way it runs as
 * a whole (the non-zero rule): lobes that overlap are one area, as seen from above. What the area encloses is part of it; a part that hangs on at a
 * point or lies apart, and has less than a hundredth of the largest part's area, is left out. Corners of the margin are points of the lines and crossings,
 * these moved by less than a fifty-millionth of the extent, so that no corner lies on another side. O(n log n) expected for n lines that are short. */
void winding_find(const Vec2 *p, const uint32_t *start, uint32_t n_lines, Winding *out);
void winding_clear(Winding *w);

#endif
