/* Laying a trail: simplified, cut where it comes too near to what lies already, its tip tied to the margin when it ends there. */
#ifndef SHAPE_SKELETON_LAY_H
#define SHAPE_SKELETON_LAY_H

#include "shape/skeleton_private.h"

typedef struct {
    Ground *ground;        /* borrowed, as all of these */
    const Trails *trails;
    const bool *must;      /* [points] where branches leave */
    double tolerance;      /* segments, as all of these */
    double spacing;        /* longest edge, 0: any */
    double shortest;       /* shortest edge */
    double hook;           /* longest end that counts as a hook */
    /* what was laid last */
    GArray *knot;          /* Knot */
    bool tied;             /* its tip to the margin, at `tip` */
    Anchor tip;
    /* private: the trail simplified, and what was left off its end */
    GArray *mark, *raw, *flag, *keep;
    double left_off;
} Laying;

void laying_init(Laying *l, Ground *ground, const Trails *trails, const bool *must, const SkeletonDef *def);
void laying_clear(Laying *l);

/* Begins a sequence with nothing but its start. */
void laying_begin(Laying *l, uint32_t owner, Anchor start, Knot first);

/* Lays the trail from its point `from` on, led to from `start`, as far as it keeps clear; tells what it met. fixed: point `from` becomes a node. */
Hit lay_trail(Laying *l, uint32_t owner, uint32_t trail, Anchor start, uint32_t from, bool fixed);

/* The outline's vertex next to a place on its edge when that is nearer than `reach`, else the place. */
Anchor anchor_to_vertex(const Ground *g, Anchor place, double reach);

#endif
