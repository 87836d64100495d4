/* Conforming Delaunay triangulation of a leaf blade with its veins (Hong 2005, § 6.2.1): Ruppert's refinement on GTS's objects and exact
 * predicates. */
#ifndef GEOM_MESH_H
#define GEOM_MESH_H

#include <glib.h>

#include "geom/polygon.h"
#include "geom/vec.h"

#define MESH_ERROR mesh_error_quark()
GQuark mesh_error_quark(void);
typedef enum {
    MESH_ERROR_INPUT, /* crossing or repeated parts, parts too near to each other, a vein outside the outline; numbers out of range */
    MESH_ERROR_SIZE,  /* more triangles than max_triangles would be needed */
} MeshError;

/* A planar straight-line graph: points, and segments that meet at common points only. The first n_outline points are the outline,
 * counter-clockwise; outline segment i runs from point i to point i + 1 (the last to the first) and is not listed in `segment`. */
typedef struct {
    uint32_t n_points, n_outline, n_segments;
    Vec2 *point;            /* [n_points] */
    uint32_t (*segment)[2]; /* [n_segments] vein segments, by point; a point may be on none */
} Pslg;

Pslg *pslg_new(uint32_t n_points, uint32_t n_outline, uint32_t n_segments);
void pslg_free(Pslg *g);

/* What a mesher needs: finite points (up to 1e50), a counter-clockwise outline, no two points nearer than `least` to each other, no point
 * nearer than that to a segment it is no end of, no two segments that cross, no segment twice, none outside the outline. The error names
 * the points. O(n log n) expected. */
gboolean pslg_check(const Pslg *g, double least, GError **error);

typedef struct {
    double min_angle;       /* degrees, 0 … 33; see mesh_new for where it can't be had */
    double max_area;        /* of a triangle, units² of the points; 0: no limit */
    double floor;           /* triangles with an edge shorter than this are not refined for their angles; 0: see mesh_new */
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

/* Meshes the inside of the outline. What holds always, at small angles of the input too:
 * - the triangles fill the outline, and every segment of the graph is a run of mesh edges;
 * - conforming Delaunay: no vertex lies within the circle through a triangle's corners (veins do not count as walls; vertices that are
 *   hidden behind the margin, across a sinus, do not count), nor within the circle over an edge on a vein or the margin. So no weight of
 *   finite volumes is negative, at the margin neither;
 * - no triangle is larger than max_area.
 *
 * No angle is less than min_angle, but
 * - where two segments of the graph meet at less;
 * - in triangles whose shortest edge spans two segments that meet at less than 60°, at equal distance from their common point (angles of
 *   about half of that at least);
 * - in triangles with an edge shorter than `floor`, or than 1/64 of the distance between features near by. That does not occur up to 30°,
 *   and beyond in a triangle of ten thousand: it is there to end what might not end.
 *
 * Narrow places between segments are filled with triangles of their width, so they may take many: set max_triangles.
 *
 * Deterministic. For any thread, but GTS keeps process-wide state, so calls wait for each other. Expected linear time in the result: 4 µs
 * and 400 bytes a triangle. NULL with an error for a definition out of range, for a graph that pslg_check refuses at a billionth of the
 * largest coordinate (MESH_ERROR_INPUT), and where max_triangles do not suffice (MESH_ERROR_SIZE). */
Mesh *mesh_new(const Pslg *g, const MeshDef *def, GError **error);
void mesh_free(Mesh *m);

/* Finds the triangle that holds p, or the one nearest to it (of equals the first), and the barycentric coordinates of p, or of the
 * triangle's point nearest to it: never negative, 1 in sum. O(log n) expected. The mesh must outlive the locator, which any threads may
 * share. Of points that are not finite nothing is asked: triangle 0. */
typedef struct MeshLocator MeshLocator;
MeshLocator *mesh_locator_new(const Mesh *m);
void mesh_locator_free(MeshLocator *l);
uint32_t mesh_locate(const MeshLocator *l, Vec2 p, double weight[3]);

#endif
