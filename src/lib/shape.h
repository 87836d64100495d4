/* What the handle VenShape holds: everything on the way from a venation graph to a bent leaf. */
#ifndef LIB_SHAPE_H
#define LIB_SHAPE_H

#include "image/paint.h"
#include "lib/leaf.h"
#include "shape/membrane.h"
#include "shape/pose.h"
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
    uint32_t *triangle;    /* [mesh->n_vertices] of the full mesh */
    double (*weight)[3];   /* [mesh->n_vertices] barycentric */
} Level;

struct VenShape {
    const VenLeaf *leaf; /* borrowed */
    Skeleton *skeleton;  /* refined: every node is a mesh vertex */
    Mesh *mesh;
    uint32_t n_fixed, *fixed, *fixed_node; /* mesh vertices on veins and the skeleton node at each */
    Membrane *membrane;
    SolidDef solid;
    Frame frame;         /* of the maps: uv */
    double unit;         /* metres a segment */
    Bent bent;           /* as [pose] asks */
    uint32_t n_levels;   /* coarser ones */
    Level *level;
};

/* Poses the leaf; `pose` is taken over. */
Bent shape_bend(const VenShape *s, Pose *pose);
void bent_clear(Bent *b);

/* The blade of a coarser level in that pose. */
Surface *shape_level_blade(const VenShape *s, const Level *level, const Bent *bent);

/* uv of a point of the flat blade, v up. */
Vec2 shape_uv(const VenShape *s, Vec2 rest);

/* From the parameter table. `length` is the leaf's, segments; `level` 0 is the finest. */
SkeletonDef settings_skeleton(const Params *p, double length, uint32_t level);
MeshDef settings_mesh(const Params *p, double length, uint32_t level);
PoseDef settings_pose(const Params *p, uint64_t seed);
SolidDef settings_solids(const Params *p, double length);

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
