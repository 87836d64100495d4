/* The faces of a planar graph, by walks around them. */
#ifndef SIM_FACES_H
#define SIM_FACES_H

#include "sim/edge_order.h"

enum { FACE_NONE = 0xFFFFFFFFu, FACE_BRIDGE = 0xFFFFFFFEu };

/* A way around a face, the face to the left: it begins at the place `start` of nodes tail[first] … tail[first + n - 1] and comes back to it. */
typedef struct {
    uint32_t first, n, start;
    uint32_t number; /* of its half-edges */
    uint64_t rank;   /* of the half-edge it begins with: by its tail, then its head, as they were numbered before they were put in order */
    double area;     /* positive: it goes around its face; negative: it goes around what lies in its face */
} Walk;

/* Each edge twice, once each way: 2e from its first node on, 2e + 1 back. */
typedef struct {
    const EdgeOrder *order;
    uint32_t *tail; /* nodes on the walks */
    uint32_t *mark; /* [half-edges] number of the walk it is of; FACE_BRIDGE: it is let go */
    uint32_t n_walks;
    Walk *walk;     /* in order of their ranks */
    uint32_t *rank; /* [n_walks] by their numbers, their place in `walk` */
} Faces;

/* Of what is left of a planar graph's edges without those that have one face on both sides; `order` outlives it. O(edges log edges). */
void faces_init(Faces *f, const EdgeOrder *order);
void faces_clear(Faces *f);

/* Node i of a walk, 0 … n - 1, from its start on. */
static inline uint32_t face_node(const Faces *f, const Walk *w, uint32_t i)
{
    uint32_t at = w->start + i;
    return f->tail[w->first + (at < w->n ? at : at - w->n)];
}

#endif
