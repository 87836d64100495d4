/* A bent leaf for other people's programs. One writer a format; as in export.h each writes beside its target and renames, sets a GError in
 * G_FILE_ERROR, and gives equal bytes for equal input. Of two files that belong together both appear or neither.
 *
 * glTF, OBJ and PLY: metres; right-handed with y up, as glTF has it: leaf space (x, y, z) is written (x, z, -y), so the leaf lies with its
 * sunny side up, its tip away from the viewer and its right side to the right. Blender turns glTF and OBJ back into leaf space.
 * POV-Ray: segments; left-handed: (x, y, z) is written (x, y, -z), so the sunny side faces the default camera; the scene lays it down. */
#ifndef EXPORT_MODEL_H
#define EXPORT_MODEL_H

#include <glib.h>

#include "shape/rig.h"
#include "shape/solid.h"

/* Maps as PNG files in memory, for formats that embed them; NULL: not there. */
typedef struct {
    GBytes *base_color;         /* RGBA, alpha from the opacity map */
    GBytes *abaxial_base_color; /* RGBA; glTF has no material with two faces: the vein solids take it, and it is a variant of the blade's */
    GBytes *normal;             /* of the side that base_color shows */
    GBytes *abaxial_normal;
    GBytes *surface;            /* R ambient occlusion, G roughness, B metal (0): glTF's packing */
    GBytes *transmission;       /* RGBA, alpha: part of the light that passes, and its colour */
} ModelImages;

/* A pose of the blade and veins as a morph target: places and normals, in the order of the surfaces' vertices. */
typedef struct {
    const char *name;
    const Vec3 *blade, *blade_normal, *veins, *vein_normal;
    double time; /* seconds at which the target is fully on, ascending; 0 for the first: else the animation begins with the rest pose */
} ModelMorph;

typedef struct {
    const char *name;          /* what files and objects are called */
    const char *title, *generator, *extras; /* for people; extras: JSON text (the run record) or NULL */
    double unit;               /* metres a segment */
    const Surface *blade;      /* uv 0 … 1, v up; segments */
    const Surface *veins;      /* vein solids with uv 0 … 1, or NULL */
    const Tube *tubes;         /* the same as balls, for sphere_sweep */
    uint32_t n_tubes;
    const Skeleton *skeleton;
    const uint8_t *vein_order; /* [blade->n_vertices] order of the vein at the vertex, 0 none */
    const double *vein_radius; /* [blade->n_vertices] segments, 0 none */
    const uint32_t *vein_id;   /* [blade->n_vertices] 1 + sequence, 0 none */
    const uint8_t *on_margin;  /* [blade->n_vertices] */
    /* file names of maps beside the model, for formats that refer to them; NULL: not there */
    const char *base_color_file, *abaxial_base_color_file, *opacity_file, *normal_file, *roughness_file, *height_file, *translucency_file;
    gboolean holes; /* the blade has holes, which are in the opacity map and not in the mesh */
    ModelImages images;
    const Rig *rig;            /* NULL: not rigged */
    const ModelMorph *morph;   /* keyframes */
    uint32_t n_morphs;
} Model;

/* Wavefront OBJ and its MTL beside it (leaf.obj, leaf.mtl): groups and materials blade and veins. Lengths to a nanometre. */
gboolean export_obj(const Model *m, const char *path, GError **error);

/* PLY, binary little endian: blade and veins with normals, uv and vein attributes (order, radius, sequence, margin) per vertex. Those of the
 * vein solids are found by their parts, which are the tubes in their order; 0 when there aren't as many. */
gboolean export_ply(const Model *m, const char *path, GError **error);

/* POV-Ray 3.7 include file in the layout of Hong 2005, fig. C.6 (declares veins and leaf), with textures, and a scene beside it that renders as
 * it is. Sweeps are linear: POV-Ray renders cubic ones five times slower, and between the nodes the blade is straight too. */
gboolean export_pov(const Model *m, const char *inc_path, const char *scene_path, GError **error);

/* glTF 2.0 binary, maps embedded; a skin when there is a rig; morph targets and an animation when there are keyframes. The extras are the
 * asset's, under "record". */
gboolean export_glb(const Model *m, const char *path, GError **error);

#endif
