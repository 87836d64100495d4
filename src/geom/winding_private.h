/* Lines divided where they meet. Private to src/geom/winding*.c. */
#ifndef GEOM_WINDING_PRIVATE_H
#define GEOM_WINDING_PRIVATE_H

#include <glib.h>

#include "geom/vec.h"

/* From the lower of two nodes to the higher; `turns` lines run that way, less those that run back. */
typedef struct {
    uint32_t a, b;
    int32_t turns;
} WindEdge;

typedef struct {
    GArray *node;   /* Vec2, no two in one place */
    GArray *source; /* uint32_t, [node] the input's point that a node is, or after which its line has the node; the lowest */
    GArray *edge;   /* WindEdge, ordered by a and b, none twice */
    uint32_t n_points; /* of the input; they are the first nodes, further ones are crossings */
    double unit;    /* nodes are whole numbers of it, a power of two */
} WindLines;

/* Divides the lines until they share nodes alone, and no node lies nearer to an edge than 0.75 units. The edges come from the lines' sides; those that are
 * run as often either way are gone. *clean: nothing was divided, joined or gone. False for a tangle. */
bool winding_split(WindLines *w, bool *clean);

#endif
