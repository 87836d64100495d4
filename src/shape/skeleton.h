/* The skeleton of a leaf blade: its structural veins as a tree of vein sequences (Hong 2005, § 6.1.2), made from a venation graph, grown
 * or drawn. */
#ifndef SHAPE_SKELETON_H
#define SHAPE_SKELETON_H

#include <glib.h>

#include "geom/mesh.h"
#include "geom/polygon.h"
#include "sim/network.h"

#define NO_PARENT UINT32_MAX

#define SKELETON_ERROR skeleton_error_quark()
GQuark skeleton_error_quark(void);
typedef enum {
    SKELETON_ERROR_GRAPH, /* the network can't be opened into a tree, has dangling or zero-length edges, … */
    SKELETON_ERROR_EMPTY, /* no vein is left that could carry the blade */
} SkeletonError;

/* A vein sequence: a polyline from where it leaves its parent sequence to its tip. */
typedef struct {
    uint32_t parent;       /* sequence it leaves, NO_PARENT for a primary at the base */
    uint32_t start;        /* index among the parent's nodes of the node it shares with it (its first node); 0 for a primary */
    uint32_t first, n;     /* its nodes: Skeleton.at[first … first + n - 1], n >= 2 */
    uint8_t order;         /* 1 primary, 2 secondary, … */
    bool fictitious;       /* shapes the blade, is not drawn (Hong 2005, § 7.2) */
    uint32_t vein;         /* of the network, NO_PARENT for a fictitious one */
    double base_radius, tip_radius; /* its own at its first node and its tip, segments */
    double length;         /* at rest, segments */
    char name[24];         /* midrib (sequence 0); P2 … other primaries; F1 … fictitious; else side and number from the base: L1, R2 …, with its
                              parent's before it when that is not the midrib: R2.L1, P2.R3 */
} Sequence;

/* Nodes form a forest: hinge[i] < i is the node nearer to the root (Hong's hinge of the edge hinge[i] – i), NO_PARENT for a root. Primaries that
 * begin in one place share that node. */
typedef struct {
    uint32_t n_nodes, n_sequences, n_at;
    Vec2 *rest;       /* [n_nodes] position in the flat blade, segments */
    uint32_t *hinge;  /* [n_nodes] */
    double *radius;   /* [n_nodes] of the first sequence that has the node, segments: at a branch's first node of its parent */
    uint32_t *vertex; /* [n_nodes] the mesh's vertex at the node; set by skeleton_refine, else NO_PARENT */
    uint32_t *at;     /* [n_at] nodes of the sequences, one sequence after the other */
    Sequence *sequence; /* [n_sequences] parents before children */
    Polygon *outline; /* the blade, simplified, vein ends on it inserted; owned */
    double length;    /* of the leaf, base to tip, segments; 0: unknown */
    double least;     /* skeleton_pslg passes pslg_check with this, segments; 0 (not known) after skeleton_refine */
} Skeleton;

typedef struct {
    uint32_t max_order;      /* veins up to this order (network order) */
    double tolerance;        /* of the simplification of veins and outline, segments */
    double spacing;          /* longest vein edge, segments (a long edge can't bend), not below the clearance; 0: no limit */
    double clearance;        /* veins nearer than this to others, and tips nearer to the margin, are cleared, segments */
    double min_angle;        /* a sequence that leaves its parent at less than this is moved up or dropped, degrees, 0 … 60 */
    double min_length;       /* shorter sequences are dropped, segments */
} SkeletonDef;

/* Defaults in proportion to a leaf `length` segments long. */
SkeletonDef skeleton_def_default(double length);

/* Opens the network along its growth parents (anastomoses are left out), keeps the structural veins, simplifies them and the outline (Hong 2005,
 * § 5.3) and clears what a mesher can't take, so that skeleton_pslg passes pslg_check with a quarter of the clearance. Lower orders, and of one
 * order longer veins, are laid first; others end, or begin farther up their parent, where they would come too near, and go when a third or
 * less of them could stay. Curls and hooks are cut off; tips near the margin are led on to it. A node that two edges lead to was grown by the
 * wider one (of equals the first); the other ends before it. Deterministic. O(n log n) expected. */
Skeleton *skeleton_new(const Network *net, const SkeletonDef *def, GError **error);
void skeleton_free(Skeleton *s);

/* Adds fictitious veins as drawn by hand: vein k is a polyline of count[k] >= 2 of the points, from the first one (snapped to the nearest node) to
 * a tip inside the blade. Returns a new skeleton, whose other nodes and sequences keep their numbers; long edges are cut. The error names
 * the vein (F1, F2 …) and where it comes nearer than `least` to what is there, in parts of `unit` segments: the leaf's length if the points
 * were given so, or 1. */
Skeleton *skeleton_add_fictitious(const Skeleton *s, const Vec2 *point, const uint32_t *count, uint32_t n_veins, double unit, GError **error);

/* Outline and veins as a planar straight-line graph. node_point[n_nodes] receives each node's point. */
Pslg *skeleton_pslg(const Skeleton *s, uint32_t *node_point);

/* Puts the mesh's new nodes on vein edges back into the sequences (§ 6.2.2): a new skeleton whose every node knows its mesh vertex and
 * whose every edge is a mesh edge. `mesh` was made from skeleton_pslg(s). */
Skeleton *skeleton_refine(const Skeleton *s, const Mesh *mesh);

/* Sequence by name; NO_PARENT if there is none. */
uint32_t skeleton_find(const Skeleton *s, const char *name);

#endif
