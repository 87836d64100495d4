/* Conforming Delaunay triangulation of a leaf blade with its veins (Hong 2005, § 6.2.1; Ruppert's refinement on GTS). */
#ifndef GEOM_MESH_H
#define GEOM_MESH_H

#include <glib.h>

#include "geom/polygon.h"
#include "geom/vec.h"

#define MESH_ERROR mesh_error_quark()
GQuark mesh_error_quark(void);
typedef enum {
    MESH_ERROR_INPUT,   /* crossing, repeated or dangling parts; a vein outside the outline */
    MESH_ERROR_SIZE,    /* more triangles than max_triangles would be needed */
} MeshError;

/* A planar straight-line graph: points, and segments that meet at common points only. The first n_outline points are the outline,
 * counter-clockwise; outline segment i runs from point i to point i + 1 (the last to the first) and is not listed in `segment`. */
typedef struct {
    uint32_t n_points, n_outline, n_segments;
    Vec2 *point;           /* [n_points] */
    uint32_t (*segment)[2]; /* [n_segments] vein segments, by point */
} Pslg;

Pslg *pslg_new(uint32_t n_points, uint32_t n_outline, uint32_t n_segments);
void pslg_free(Pslg *g);

/* What a mesher needs: finite points, no two points nearer than `least` to each other, no point nearer than that to a segment it is no
 * end of, no two segments that cross, no segment twice, none outside the outline. The error names the points. O(n log n) expected. */
gboolean pslg_check(const Pslg *g, double least, GError **error);

typedef struct {
    double min_angle;      /* degrees, 0 … 33; except where the input's own angles are smaller */
    double max_area;       /* of a triangle, units² of the points; 0: no limit */
    double floor;          /* no edge is split that is shorter than this; 0: chosen from the input */
    uint32_t max_triangles; /* refuse above; 0: no limit */
} MeshDef;

/* Flat arrays; triangles counter-clockwise. Point i of the graph is vertex i. */
typedef struct {
    uint32_t n_vertices, n_triangles, n_boundary, n_vein;
    Vec2 *vertex;            /* [n_vertices] */
    uint32_t (*triangle)[3]; /* [n_triangles] */
    /* Mesh edges on the outline and on veins, in order along each input segment and of the segments: edge = from, to; input = the
     * outline or vein segment of the graph that it is part of. */
    uint32_t (*boundary)[2], *boundary_input; /* [n_boundary] */
    uint32_t (*vein)[2], *vein_input;         /* [n_vein] */
} Mesh;

/* Meshes the inside of the outline. Every triangle is Delaunay (no vertex inside a circumcircle, the constrained edges included: conforming), no
 * angle below min_angle but beside smaller input angles, no area above max_area. Deterministic. GTS keeps process-wide state, so calls
 * wait for each other. Expected linear time in the result: 8 µs and 400 bytes a triangle. NULL with an error for a graph that
 * pslg_check refuses. */
Mesh *mesh_new(const Pslg *g, const MeshDef *def, GError **error);
void mesh_free(Mesh *m);

/* Finds the triangle that holds p, or the one nearest to it, and p's barycentric coordinates in it (clamped to it when outside). */
typedef struct MeshLocator MeshLocator;
MeshLocator *mesh_locator_new(const Mesh *m);
void mesh_locator_free(MeshLocator *l);
uint32_t mesh_locate(const MeshLocator *l, Vec2 p, double weight[3]);

#endif
