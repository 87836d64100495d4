/* Materials of a leaf in glTF 2.0. */
#ifndef EXPORT_GLB_MATERIAL_H
#define EXPORT_GLB_MATERIAL_H

#include "export/glb_buffer.h"
#include "export/model.h"

typedef struct {
    GString *images, *textures, *materials; /* JSON objects with commas between */
    uint32_t n_textures, n_materials;
    uint32_t blade, shadow_side, veins; /* materials; UINT32_MAX: not there */
    gboolean bumpy;                     /* the blade's materials have normal maps, so it needs tangents */
    gboolean transmits;                 /* KHR_materials_diffuse_transmission is used */
} GlbMaterials;

/* Puts the maps into the buffer. The blade's material shows the sunny side's maps from both sides; glTF has no material with two faces, so
 * the shadow side's maps make a second material, which viewers offer as a variant. The vein solids stand out on the shadow side and
 * take its colour. */
void glb_materials_init(GlbMaterials *g, const Model *m, GlbBuffer *b);
void glb_materials_clear(GlbMaterials *g);

#endif
