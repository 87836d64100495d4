/* What the files of the skeleton share. From a network to a skeleton: skeleton_open.c follows the veins, _outline.c simplifies the margin, _clear.c
 * lays veins on it as _plan.c says and _lay.c and _ground.c allow, skeleton.c copies what lies, _name.c names it. */
#ifndef SHAPE_SKELETON_PRIVATE_H
#define SHAPE_SKELETON_PRIVATE_H

#include "shape/skeleton.h"
#include "shape/skeleton_ground.h"

/* ---- skeleton_open.c: the network as a tree ---- */

/* A vein sequence as it is in the network. */
typedef struct {
    uint32_t parent;   /* trail, NONE */
    uint32_t leaves;   /* the point of the parent it leaves from, counted from the parent's first */
    uint32_t first, n; /* its points: point[first … first + n - 1], the first one on the parent */
    uint32_t vein;
    uint8_t order;
    double length;     /* along the points */
} Trail;

typedef struct {
    uint32_t n;
    Trail *trail;  /* parents before children */
    Vec2 *point;
    double *along; /* of each point: way from the trail's first one */
    double *width; /* of the edge that leads to the point; at a first point, of the edge that leaves it */
} Trails;

/* Checks the network and follows its veins: orders up to max_order, at least min_length long, with all their ancestors. A vein that curls, coming
 * nearer to its start again by `turn`, ends where it turned back. */
Trails *trails_new(const Network *net, uint32_t max_order, double min_length, double turn, GError **error);
void trails_free(Trails *t);

/* ---- skeleton_outline.c ---- */

/* The network's margin without repeated points. The error names the edges where it is unfit. */
Polygon *outline_checked(const Network *net, GError **error);

/* Place on the polygon nearest to p; *edge receives its edge. O(n). */
Vec2 outline_nearest(const Polygon *margin, Vec2 p, uint32_t *edge);

/* The margin simplified; points of `keep` (on the margin) become vertices unless one is there or too near; no two parts of the
 * result are nearer than `least`. The first vertex is the one nearest to `base`. */
Polygon *outline_simplify(const Polygon *margin, Vec2 base, const Vec2 *keep, uint32_t n_keep, double tolerance, double least, GError **error);

/* ---- skeleton_clear.c ---- */

/* A point of a cleared sequence. */
typedef struct {
    uint32_t node; /* of the ground */
    double along;  /* where on the trail */
    double width;  /* there */
} Knot;

typedef struct {
    uint32_t trail;
    uint32_t parent; /* cleared sequence, NONE */
    GArray *knot;    /* Knot, the first one at a node of the parent */
} Cleared;

typedef struct {
    Ground ground;
    Polygon *outline; /* simplified, without the ends of veins */
    GArray *cleared;  /* Cleared; parents before children */
} Clearing;

/* Simplifies the margin and lays the trails on it, the more important first, each as far as it keeps clear. */
Clearing *clearing_new(const Trails *trails, const Polygon *margin, const SkeletonDef *def, GError **error);
void clearing_free(Clearing *c);

/* ---- skeleton.c ---- */

/* Nodes without hinges and vertices; no outline. */
Skeleton *skeleton_alloc(uint32_t n_nodes, uint32_t n_sequences, uint32_t n_at);

/* Where in the sequence a node of it is. */
uint32_t skeleton_place_in(const Skeleton *s, uint32_t sequence, uint32_t node);

/* ---- skeleton_name.c ---- */

/* Names every sequence; sequence 0 is the midrib. */
void skeleton_name(Skeleton *s);

#endif
