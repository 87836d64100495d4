/* Bending the skeleton (Hong 2005, § 7.1): veins neither stretch nor twist; an edge turns about its hinge node and carries the subtree
 * beyond it as a rigid body. */
#ifndef SHAPE_POSE_H
#define SHAPE_POSE_H

#include <glib.h>

#include "geom/vec3.h"
#include "shape/skeleton.h"

#define POSE_ERROR pose_error_quark()
GQuark pose_error_quark(void);
typedef enum {
    POSE_ERROR_SYNTAX, /* a rule that can't be read */
    POSE_ERROR_VEIN,   /* a rule that names no vein */
} PoseError;

/* Where the nodes are. turn[i] is the rotation of node i's subtree against the flat leaf, so place[i] = place[hinge] + turn[i]·(rest[i] –
 * rest[hinge]): lengths are kept to rounding however many rotations were made. */
typedef struct {
    const Skeleton *skeleton; /* borrowed */
    Vec3 *place;  /* [n_nodes] */
    Mat3 *turn;   /* [n_nodes] orthonormal to 1e-15 */
    uint32_t *child, *sibling; /* [n_nodes] chains: the first node that hangs on a node, and the next on the same hinge; NO_PARENT: none */
} Pose;

Pose *pose_new(const Skeleton *s); /* flat */
Pose *pose_copy(const Pose *p);
void pose_free(Pose *p);

/* Rotation about an axis (need not be of unit length) by an angle in radians. Pinned rounding: see src/geom/dmath.h. */
Mat3 pose_rotation(Vec3 axis, double angle);

/* First method (§ 7.1.1): turns the edge hinge[node] – node about its hinge, around an axis in space as it is now; everything that descends
 * from `node` goes along, what else leaves the hinge stays. A root has no hinge: its whole tree turns about it. O(subtree). */
void pose_rotate(Pose *p, uint32_t node, Vec3 axis, double angle);

/* A pose on the way from a to b, part 0 … 1, of the same skeleton: every edge turns against the one before evenly about one axis, so veins keep
 * their lengths on the way. O(n_nodes). */
Pose *pose_between(const Pose *a, const Pose *b, double part);

/* How far the farthest turning edge turns on that way, radians: the turns from the root to it in sum. O(n_nodes). */
double pose_apart(const Pose *a, const Pose *b);

/* Second method (§ 7.1.2): control[0 … n-1] are indices of nodes of sequence `q`, ascending, the first 0 and the last its tip, n >= 2;
 * target[n] where they are wanted, but that the first node stays where it is whatever target[0] says. A natural cubic spline by chord
 * length goes through the targets; between two controls the sequence's nodes are mapped onto it in proportion to arc length, and one hinge
 * rotation after the other from the base gives each edge the direction from its hinge's mark to its node's. So the nodes come to lie on a
 * spline as long as the vein; one of another length is followed in shape, larger or smaller. (To aim at marks from where the hinges really are
 * would fold the vein back and forth on a spline that is too short.) Descendants are carried along. O(n_nodes). */
void pose_spline(Pose *p, uint32_t q, const uint32_t *control, const Vec3 *target, uint32_t n);

/* What a leaf does: ready-made poses. */
typedef enum {
    POSE_FLAT, POSE_CUPPED, POSE_FOLDED, POSE_DROOPING, POSE_CURLED_TIP, POSE_WAVY, POSE_WITHERED
} PoseKind;

typedef struct {
    PoseKind kind;
    double strength;  /* 1: as designed; scales every angle of the ready-made pose */
    double age;       /* withered: 0 fresh … 1 dried up; the six stages of figs. 8.5 and 8.9 are 0, 0.2, … 1 */
    double variation; /* natural unevenness, 0 … 1; 0 keeps a symmetric leaf symmetric */
    uint64_t seed;    /* of the unevenness; a vein's depends on this and its name, not on the other veins */
    double blend;     /* 0 flat … 1 posed: every rotation's angle is scaled, the rules' too */
    const char *rules; /* own rules on top, see pose_apply; may be NULL */
} PoseDef;

PoseDef pose_def_default(void);

/* The definition on the way from a to b, if they differ in strength, age, variation and blend alone, or if one of them is flat; else false. */
bool pose_def_between(const PoseDef *a, const PoseDef *b, double part, PoseDef *between);

/* Poses the skeleton from flat. Ready-made poses are bends per unit length, so they don't depend on how finely veins are cut.
 * Rules are parted by ';', each "VEINS ACTION"; lift, turn and fold are added to the bends of the ready-made pose, then rotate and spline follow
 * in the order they are written. On an error the pose is left as it was. O(n_nodes) and two rotations a node.
 *   VEINS   all | order N | side left | side right | a name (midrib, L1, R2.L1, P2; '*' at the end stands for any) | fictitious
 *   ACTION  lift DEG         bends the vein evenly along its length, out of the blade towards the sunny side, DEG in all
 *           turn DEG         the same within the blade, positive towards the left
 *           fold DEG         turns the whole vein at its first edge about its parent's direction (a primary without parent: the
 *                            midrib's), towards the sunny side on both sides
 *           rotate x|y|z DEG [at T]     one hinge rotation at the node nearest to part T (0 base … 1 tip, default 0) of the vein, about an
 *                                       axis of space
 *           rotate X,Y,Z DEG [at T]     the same about any axis
 *           spline T,X,Y,Z T,X,Y,Z …    control vein: nodes at parts T go to X,Y,Z (leaf lengths, leaf space), T ascends and ends at 1; the
 *                                       base stays where it is and need not be given
 * DEG is -3600 … 3600. The leaf length is the height of the outline's box. The error names the rule and what is allowed. */
gboolean pose_apply(Pose *p, const PoseDef *def, GError **error);

#endif
