/* What the handle VenShape holds: everything on the way from a venation graph to a bent leaf. */
#ifndef LIB_SHAPE_H
#define LIB_SHAPE_H

#include "image/paint.h"
#include "lib/leaf.h"
#include "shape/membrane.h"
#include "shape/pose.h"
#include "shape/rig.h"
#include "shape/solid.h"

/* A pose of the whole leaf: veins, blade, vein solids. Vertex i of a surface is the same material point in every pose. */
typedef struct {
    Pose *pose;
    Surface *blade;
    Tube *tubes;
    uint32_t n_tubes;
    Surface *veins; /* NULL: none are wanted */
} Bent;

/* A coarser mesh of the same leaf: its vertices lie in triangles of the full one. */
typedef struct {
    Mesh *mesh;
    Skeleton *skeleton;    /* what is left of the veins, refined; names as in the full leaf */
    uint32_t *triangle;    /* [mesh->n_vertices] of the full mesh */
    double (*weight)[3];   /* [mesh->n_vertices] barycentric */
} Level;

struct VenShape {
    const VenLeaf *leaf; /* borrowed */
    Network *carries;    /* what the blade bends about where that is not just the leaf's network: a midrib for a leaf without veins, or its
                            veins, tied across holes; else NULL */
    Skeleton *skeleton;  /* refined: every node is a mesh vertex */
    Mesh *mesh;
    uint32_t n_fixed, *fixed, *fixed_node; /* mesh vertices on veins and the skeleton node at each */
    Membrane *membrane;
    SolidDef solid;
    Frame frame;         /* of the maps: uv */
    double unit;         /* metres a segment */
    PoseDef bent_as;     /* what [pose] asks; its rules are `rules` */
    char *rules;
    Bent bent;           /* so */
    uint32_t n_levels;   /* coarser ones; fewer than were asked for when the leaf can't be made coarser */
    Level *level;
    Rig *rig;            /* joints where the pose has them; NULL: none is asked for */
};

/* What mesh.membrane may be, in the table's order. */
enum { MEMBRANE_CHOICE_LAPLACE, MEMBRANE_CHOICE_NATURAL, MEMBRANE_CHOICE_BILAPLACE };

/* Poses the leaf; `pose` is taken over. */
Bent shape_bend(const VenShape *s, Pose *pose);
void bent_clear(Bent *b);

/* A coarser level (1, 2, …) in that pose. Veins that would take the whole above a quarter of the triangles of the level before are left out,
 * the thinnest first. Its `pose` knows places alone. */
Bent shape_level_bend(const VenShape *s, uint32_t level, const Bent *bent);

/* Makes the coarser levels that mesh.levels asks for. */
void shape_add_levels(VenShape *s);
void shape_level_clear(Level *l);

/* The petiole as the scan shows it, leaf lengths; width 0: it does not tell. False where there is none, or the parameters say how long it is. */
bool shape_real_petiole(const VenLeaf *leaf, double *length, double *width);

/* What vein solids are like, with the petiole of the scan where there is one; `coarser` as below. */
SolidDef shape_solids(const VenLeaf *leaf, double coarser);

/* A blade with triangles and uv, not yet placed. */
Surface *shape_flat_blade(const VenShape *s, const Mesh *mesh);

/* The tubes of `b` as a surface with uv. */
void shape_dress_veins(const VenShape *s, Bent *b, const SolidDef *def);

/* The mesh that conforms to a skeleton. */
Mesh *shape_mesh(const Skeleton *sk, const MeshDef *def, GError **error);

/* A midrib in the middle of a leaf that has no vein, as thin as its thinnest would be; straight where the blade lets it. */
Network *shape_lay_midrib(const VenLeaf *leaf);

/* The skeleton of the veins, and of mesh.fictitious_veins. */
Skeleton *shape_skeleton(const VenShape *s, GError **error);

/* Of the veins alone. Where what carries all the others runs through a part of the blade that is narrower than the clearance (the stub of a petiole, beside
 * a deep notch), veins are cleared by less of it rather than none left. */
Skeleton *shape_skeleton_by(const VenShape *s, SkeletonDef def, GError **error);

/* uv of a point of the flat blade, v up. */
Vec2 shape_uv(const VenShape *s, Vec2 rest);

/* From the parameter table. `length` is the leaf's, segments; `coarser` 1 is the finest, 2 has edges twice as long. */
SkeletonDef settings_skeleton(const Params *p, double length, double coarser);
MeshDef settings_mesh(const Params *p, double length, double coarser);
PoseDef settings_pose(const Params *p, uint64_t seed);
SolidDef settings_solids(const Params *p, double length, double coarser);

/* Puts the place where the parameter was given before the error's message; always FALSE. */
gboolean settings_prefix(const Params *p, ParamId id, GError **error);

/* Which models are wanted, from export.models; an unknown name is an error. */
typedef enum { MODEL_GLB, MODEL_OBJ, MODEL_PLY, MODEL_POV, MODEL_COUNT } ModelFormat;
gboolean settings_models(const Params *p, gboolean wanted[MODEL_COUNT], GError **error);

/* One keyframe of pose.keyframes: the parameters with its keys set over them. */
typedef struct {
    double time; /* seconds, ascending */
    Params *params;
} Keyframe;
gboolean settings_keyframes(const Params *p, Keyframe **frame, uint32_t *n, GError **error);
void keyframes_free(Keyframe *frame, uint32_t n);

/* Polylines of mesh.fictitious_veins in segments: point[sum of count], count[n]. */
gboolean settings_fictitious(const Params *p, double length, Vec2 **point, uint32_t **count, uint32_t *n, GError **error);

#endif
