/* The blade between the posed veins: Laplace interpolation by finite volumes on the Voronoi diagram (Hong 2005, § 7.2 and appendix B). */
#ifndef SHAPE_MEMBRANE_H
#define SHAPE_MEMBRANE_H

#include <glib.h>

#include "geom/mesh.h"
#include "geom/vec3.h"

#define MEMBRANE_ERROR membrane_error_quark()
GQuark membrane_error_quark(void);
typedef enum {
    MEMBRANE_ERROR_BARE,   /* a part of the mesh has no fixed vertex */
    MEMBRANE_ERROR_FACTOR, /* no factor: hopelessly thin triangles, or too many of them */
} MembraneError;

typedef enum {
    MEMBRANE_LAPLACE, /* harmonic: the thesis' method. Creases at veins; the margin meets the blade without slope */
    /* Smoother across veins; not the thesis. Least Σ (Lf)²/A, Lf the finite-volume sum and A the Voronoi area, over all vertices but
     * fixed ones of the margin. So the surface has no crease at a vein inside the blade, and rests on a fixed margin without being
     * clamped there: affine maps are reproduced when the whole margin is fixed. A free margin is as in LAPLACE: no slope. Values can
     * overshoot those of the veins. Five times the factor, and the square of the condition number: at 125 000 vertices between veins
     * errors of 2e-11 where LAPLACE has 2e-14. */
    MEMBRANE_BILAPLACE
} MembraneKind;

/* The system with its factor; good for any pose for as long as mesh and fixed vertices stay. */
typedef struct Membrane Membrane;

/* fixed[n_fixed]: the vertices on veins (Dirichlet), no vertex twice. Weights are s_ij / h_ij, Voronoi edge over distance; at the margin
 * the part of the Voronoi edge inside the blade alone counts (natural Neumann). One Cholesky factorisation. The mesh must outlive it. */
Membrane *membrane_new(const Mesh *mesh, const uint32_t *fixed, uint32_t n_fixed, MembraneKind kind, GError **error);
void membrane_free(Membrane *m);

/* place[n_vertices] from posed[n_fixed], one solve a coordinate. No allocation; not to be called from two threads at once.
 * The margin meets the blade without slope in x and y too, so between vein ends it is drawn in, by 0.37 of their distance midway, even
 * when the veins lie flat. */
void membrane_interpolate(Membrane *m, const Vec3 *posed, Vec3 *place);

/* The same with a margin that keeps the shape of the flat blade (not in the thesis). turn[n_fixed] are the veins' rotations (struct
 * Pose); at the margin the normal derivative is T·n instead of 0, T being the turns' own interpolation. Rigid motions of all veins, and
 * so the flat pose, are reproduced everywhere. Nine solves. */
void membrane_interpolate_turned(Membrane *m, const Vec3 *posed, const Mat3 *turn, Vec3 *place);

/* One harmonic function: value[n_vertices] from at_fixed[n_fixed]. For harmonic coordinates (rigs). */
void membrane_harmonic(Membrane *m, const double *at_fixed, double *value);

/* Largest residual of the finite-volume equations (of membrane_interpolate) at the free vertices, relative to the sizes of their terms. */
double membrane_residual(const Membrane *m, const Vec3 *place);

/* Weight s_ij / h_ij of the mesh edge between two vertices; 0 when there is none. For tests. */
double membrane_weight(const Membrane *m, uint32_t i, uint32_t j);

#endif
