/* The finite volumes of a triangulated blade: Voronoi cells and the weights between them (Hong 2005, appendix B). */
#ifndef SHAPE_VORONOI_H
#define SHAPE_VORONOI_H

#include "geom/mesh.h"

/* Vertex i's neighbours are neighbour[start[i] … start[i + 1] - 1], in the order of the triangles.
 *
 * weight is s_ij / h_ij, Voronoi edge over distance, which is half the sum of the cotangents of the angles opposite the mesh edge i – j.
 * It is the same number, to the bit, for i – j and j – i. An edge of the margin has one such angle: its Voronoi edge runs from the
 * circumcentre inside to the margin (Hong et al. 2005, § 5: the edge's midpoint stands in for the missing centre). Lengths have a sign:
 * where a margin edge faces an obtuse angle the circumcentre lies outside the blade and the weight is below 0. It is kept so, because
 * with it the equations still reproduce affine maps and stay positive definite; a conforming Delaunay mesh has none. A weight smaller
 * than its own rounding error is 0, whatever its sign, and its edge is left out (right-angled grids: the diagonals). */
typedef struct {
    uint32_t n;          /* vertices */
    uint32_t *start;     /* [n + 1] */
    uint32_t *neighbour; /* [start[n]] */
    double *weight;      /* [start[n]] */
    double *area;        /* [n] of the Voronoi cell inside the blade, see voronoi.c; > 0, but 0 for a vertex of no triangle */
    bool *margin;        /* [n] on an edge that one triangle alone has */
} Voronoi;

/* O(triangles). Triangles must be counter-clockwise and have an area. */
Voronoi *voronoi_new(const Mesh *mesh);
void voronoi_free(Voronoi *v);

#endif
