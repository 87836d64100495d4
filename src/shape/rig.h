/* A rig that bends the leaf by its veins: control nodes are joints, harmonic coordinates of the blade are their skin weights. */
#ifndef SHAPE_RIG_H
#define SHAPE_RIG_H

#include <glib.h>

#include "shape/membrane.h"
#include "shape/solid.h"

#define RIG_ERROR rig_error_quark()
GQuark rig_error_quark(void);
typedef enum { RIG_ERROR_JOINTS /* more joints than RIG_MAX_JOINTS */ } RigError;

enum { RIG_MAX_JOINTS = 65535 };

typedef struct {
    uint32_t node;    /* of the skeleton */
    uint32_t parent;  /* joint, NO_PARENT for a root */
    char name[32];    /* midrib_0, L1_2, … */
    Vec3 place;       /* at rest, segments; in the flat leaf, whoever rigs a bent one moves the joints to where the nodes are */
} Joint;

typedef struct {
    uint32_t n_joints, per_vertex; /* 4 or 8 */
    Joint *joint;                  /* parents before children */
    uint32_t n_blade, n_veins;     /* vertices of the two surfaces */
    uint16_t *blade_joint, *vein_joint;  /* [n · per_vertex] */
    float *blade_weight, *vein_weight;   /* [n · per_vertex], sum 1, descending */
    double worst_loss, mean_loss;  /* part of a vertex's harmonic weight that did not fit into per_vertex, before renormalising */
} Rig;

/* Chooses joints (each sequence's first node, its tip, every node where another sequence leaves it, and `per_sequence` between, evenly by
 * length; sequences longer than the median get more) and solves one harmonic function a joint: on the veins the weights are hats by arc
 * length between neighbouring joints, in the blade their harmonic extension. A sequence's first joint is a child of its parent's joint at
 * the same node: it turns the sequence alone, the parent's turns what lies beyond it as well. The node itself goes with the parent's joint.
 * vein_vertex_node[veins->n_vertices]: the skeleton node each vein-solid vertex belongs to, NO_PARENT for the first joint.
 * n_joints solves. */
Rig *rig_new(const Skeleton *s, const Mesh *mesh, Membrane *membrane, const uint32_t *fixed_node, uint32_t n_fixed,
             const uint32_t *vein_vertex_node, uint32_t n_vein_vertices, uint32_t per_sequence, uint32_t per_vertex, GError **error);
void rig_free(Rig *r);

#endif
