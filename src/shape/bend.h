/* What the parts of posing share: the lie of the veins at rest, and bends along them that are put together from the roots in one pass. */
#ifndef SHAPE_BEND_H
#define SHAPE_BEND_H

#include "shape/pose.h"

/* Where each sequence lies in the flat leaf. */
typedef struct {
    uint32_t midrib;     /* sequence */
    Vec2 base, along;    /* the midrib's first node, unit vector from there to its tip */
    double chord;        /* between them, segments */
    double half_width;   /* farthest node from that line, segments */
    double leaf_length;  /* segments */
    double *length;      /* [n_sequences] segments */
    double *at;          /* [n_sequences] where on the parent it starts, part of the parent's length */
    Vec2 *axis;          /* [n_sequences] the parent's direction there, or the midrib's; (0, 0): nothing to fold about */
    int8_t *fold_side;   /* [n_sequences] 1: leaves to the left of the axis, -1 right, 0 neither */
    int8_t *side;        /* [n_sequences] of the midrib that it or its ancestor lies on: 1 left, -1 right, 0 the midrib itself */
} Layout;

Layout *layout_new(const Skeleton *s);
void layout_free(Layout *l);

/* Bends of one sequence, radians: how far it has bent at part t, less how far at its first node. Lift is out of
 * the blade towards the sunny side, turn within the blade to the left; t is the part of the length. For a vein on the sheet all from course
 * on go by the part of the midrib's chord instead, and lift across that. */
typedef struct {
    double fold;                /* at the first edge, about the parent's direction, towards the sunny side */
    double lift, turn;          /* even, over the whole length */
    double course[4];           /* lift Σ course[k] · t^(k+1) */
    double curl, curl_from;     /* lift curl · u² with u = 0 … 1 from curl_from to the tip */
    double sway;                /* turn sway · t */
    double ripple[2], phase[2]; /* lift and turn ripple · sin(2π · 1.25 t + phase) */
    bool on_sheet;
} Bend;

/* Veins that run side by side can't be bent one by one: their blade is bent as a sheet, a height over the flat leaf. Angles of slope at the
 * margin, radians. Height is 0 at the base, where the veins are rooted. */
typedef struct {
    double fold, cup[2];        /* V; round, left and right of the midrib */
    double wave, waves, phase;  /* along the margin, number over the length, radians */
} Sheet;

/* Poses p from flat by bend[n_sequences]; every angle is multiplied by `part`. O(n_nodes). */
void bend_apply(Pose *p, const Layout *l, const Bend *bend, const Sheet *sheet, double part);

/* The ready-made pose as bends, into bend[n_sequences], which is all 0, and *sheet. (pose_ready.c) */
void bend_ready(const Skeleton *s, const Layout *l, const PoseDef *def, Bend *bend, Sheet *sheet);

/* a then b in a's frame, orthonormal again: rounding doesn't pile up. */
Mat3 rotation_compose(Mat3 a, Mat3 b);

/* Rotation by the vector's length about its direction. */
Mat3 rotation_by(Vec3 v);

/* place[node] from its hinge's; a flat edge gives the rest place exactly. */
void pose_place(Pose *p, uint32_t node);

/* pose_spline with controls by arc length at[n] of the rest vein (the first 0) and every angle times `part`. */
void pose_spline_at(Pose *p, uint32_t q, const double *at, const Vec3 *target, uint32_t n, double part);

#endif
