/* What is to be cleared: which trails, in what order, from where, and with which nodes. */
#ifndef SHAPE_SKELETON_PLAN_H
#define SHAPE_SKELETON_PLAN_H

#include "shape/skeleton_private.h"

/* Where a trail without a parent begins in the blade. */
typedef struct {
    Vec2 at;
    uint32_t from; /* the trail's first point that is used after it */
    bool on_margin, outside;
} Root;

typedef struct {
    const Trails *trails;  /* borrowed */
    double merge;          /* branches nearer than this on a vein leave from one node, segments */
    uint32_t *rank;        /* [trails] the trails by importance, parents before children */
    Root *root;            /* [trails] */
    bool *wanted;          /* [trails] all, at first */
    uint32_t *host, *leaf; /* [trails] the trail it leaves, and the point there that is to be a node, if that can be */
    bool *must;            /* [points] which are nodes; see plan_branches */
} Plan;

void plan_init(Plan *p, const Trails *trails, const Polygon *margin, const Limits *limits);
void plan_clear(Plan *p);

/* Chooses the points where wanted branches leave, those that are too near to another excepted. */
void plan_branches(Plan *p);

/* Wanted roots on the margin, by importance, those left out that will share an earlier one's node; and in *base the first of all roots. Returns
 * Vec2. */
GArray *plan_roots(const Plan *p, Vec2 *base);

/* Wants only what was cleared, and branch nodes where the branches left. */
void plan_learn(Plan *p, const GArray *cleared);

#endif
