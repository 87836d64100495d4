/* The binary chunk of a glTF file and the JSON that describes its parts. */
#ifndef EXPORT_GLB_BUFFER_H
#define EXPORT_GLB_BUFFER_H

#include <glib.h>
#include <stdint.h>

#include "geom/vec3.h"

/* Bytes in the order they are added; each part begins at a multiple of four. */
typedef struct {
    GByteArray *bytes;
    GString *views, *accessors; /* JSON objects with commas between */
    uint32_t n_views, n_accessors;
} GlbBuffer;

typedef enum { GLB_NO_TARGET = 0, GLB_VERTICES = 34962, GLB_INDICES = 34963 } GlbTarget;

void glb_buffer_init(GlbBuffer *b);
void glb_buffer_clear(GlbBuffer *b);

/* The bytes as they are; returns the view's index. */
uint32_t glb_add_bytes(GlbBuffer *b, const void *bytes, gsize n, GlbTarget target);

/* `count` elements of 1 (SCALAR), 2, 3, 4 or 16 (MAT4) floats; bounds: with min and max, as places and times must have. Returns the
 * accessor's index. */
uint32_t glb_add_floats(GlbBuffer *b, const float *value, uint32_t count, uint32_t parts, gboolean bounds, GlbTarget target);
uint32_t glb_add_vec3(GlbBuffer *b, const Vec3 *value, uint32_t count, gboolean bounds, GlbTarget target);

/* Four whole numbers a vertex. */
uint32_t glb_add_joints(GlbBuffer *b, const uint16_t *value, uint32_t count);

/* Corners of triangles, in two bytes where all of n_vertices fit. */
uint32_t glb_add_triangles(GlbBuffer *b, const uint32_t (*triangle)[3], uint32_t n_triangles, uint32_t n_vertices);

#endif
