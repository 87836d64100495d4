/* Surfaces as glTF meshes, with skin weights and morph targets. */
#ifndef EXPORT_GLB_MESH_H
#define EXPORT_GLB_MESH_H

#include "export/glb_buffer.h"
#include "export/model.h"

typedef struct {
    const char *name;
    const Surface *surface;
    gboolean blade;             /* else the vein solids: which arrays of rig and morph targets are its own */
    gboolean tangents;
    uint32_t material, variant; /* variant: shown as the second variant, UINT32_MAX none */
} GlbPart;

/* Appends the mesh's JSON object; its numbers go into the buffer. */
void glb_put_mesh(GString *s, const Model *m, const GlbPart *part, GlbBuffer *b);

/* Unit tangents along growing u, square to the normals, in leaf space; sign[n_vertices]: +1, or -1 where the map lies mirrored. */
Vec3 *glb_tangents(const Surface *f, const Vec3 *place, const Vec3 *normal, double *sign);

#endif
