/* Veins as a person draws them or a program finds them in an image: lines, before they are a network. */
#ifndef SIM_DRAWING_H
#define SIM_DRAWING_H

#include <glib.h>

#include "sim/network.h"
#include "sim/width.h"

typedef struct {
    Vec2 *point;   /* [n], n >= 2, from either end */
    double *width; /* [n] diameter, in the unit of the points; 0 where unknown */
    uint32_t n;
    uint8_t order; /* 1 primary, 2 secondary, …; 0: not said */
    char *name;    /* as messages call it: "path 'midrib'"; or NULL */
} DrawnVein;

/* y runs up. The unit is the source's (pixels, leaf lengths) until drawing_to_leaf brings it to leaf coordinates. */
typedef struct {
    DrawnVein *vein;
    uint32_t n;
} Drawing;

Drawing *drawing_new(void);
void drawing_free(Drawing *d);

/* Adds a vein; copies points, and widths when they are not NULL. */
DrawnVein *drawing_add(Drawing *d, const Vec2 *point, const double *width, uint32_t n, uint8_t order, const char *name);

/* Moves all by the similarity that takes `base` to 0,0 and `tip` to 0,1; widths are scaled along. */
void drawing_to_leaf(Drawing *d, Vec2 base, Vec2 tip);

#define DRAWING_ERROR drawing_error_quark()
GQuark drawing_error_quark(void);
typedef enum {
    DRAWING_ERROR_EMPTY,   /* no vein is drawn */
    DRAWING_ERROR_OUTSIDE, /* a vein lies outside the blade */
    DRAWING_ERROR_VALUE,   /* a setting that can't be used */
} DrawingErrorCode;

typedef struct {
    double length;     /* segments, base to tip; > 0. Edges are no longer than a segment */
    double snap;       /* an end, or a start, no farther than this from another vein joins it there, leaf lengths */
    double gap;        /* what is not joined to the rest so is joined over gaps up to this at its end that is nearest to the rest; beyond
                        * it, it is a tree of its own with a first node of its own. Leaf lengths */
    const char *where; /* names the origin in messages */
    WidthDef widths;   /* for what the drawing doesn't say */
} DrawingDef;

DrawingDef drawing_def_default(void); /* 100 segments, 0.015, 0.05, "drawing" */

/* The network of drawn veins in a blade; leaf coordinates in, segments out, as a grown one: nodes in order from the base, tails before heads,
 * the margin set. Veins that touch, end on or cross one another share a node there; one way to each node is a vein, what closes a loop
 * an anastomosis. What sticks out of the blade by no more than `snap` is cut off at the margin, a vein that lies farther outside is an
 * error. What is drawn twice, or runs along another vein nearer than a quarter of `snap`, is taken once. Drawn orders and widths stay; where
 * there are none network_assign_widths gives them, but a vein drawn in one stroke keeps one order, and one narrower than what it leaves stays
 * so. A Network.vein is a run of edges of one drawn vein, or of several that continue one another. Births are depths. O(n log n) expected. */
Network *drawing_network(const Drawing *d, const Polygon *leaf, const DrawingDef *def, GError **error);

#endif
