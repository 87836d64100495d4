/* The veins of a network as strokes in image coordinates. */
#ifndef IMAGE_STROKE_H
#define IMAGE_STROKE_H

#include "image/convex.h"
#include "image/paint.h"
#include "sim/network.h"

/* A piece of a vein. */
typedef struct {
    Capsule shape; /* pixels */
    uint32_t vein;
    float birth0, birth1; /* step of birth at its ends */
    uint8_t order;
    uint8_t cut; /* StrokeCut: ends at which it may be cut straight, as the next piece, which is its neighbour in the list, and a wedge cover the rest */
} Stroke;

typedef struct {
    uint32_t n, cap;
    Stroke *v; /* along each vein from its origin on, vein by vein */
} Strokes;

/* How far strokes may lie from the veins they stand for. */
typedef struct {
    double position; /* pixels */
    double radius; /* part of the radius, by which position may be off as well when that is more; above 0 age is let go
                      too */
} StrokeTolerance;

/* Each vein, the run of edges that share its number, becomes a smooth curve through its nodes (Catmull-Rom), as wide at
 * a node as the edges that meet there on average, cut into as few straight pieces as the tolerance allows. O(n log n).
 */
Strokes *strokes_new(const Network *net, const Frame *frame, StrokeTolerance tol);

/* The same for each of n tolerances at once: the network is walked along but once, which is most of the work. */
void strokes_make(const Network *net, const Frame *frame, uint32_t n, const StrokeTolerance *tol, Strokes **out);
void strokes_free(Strokes *s);

#endif
