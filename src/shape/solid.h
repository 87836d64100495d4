/* Veins as solids: generalized cylinders along posed sequences (Hong 2005, § 8.2.1). */
#ifndef SHAPE_SOLID_H
#define SHAPE_SOLID_H

#include "geom/vec3.h"
#include "shape/pose.h"

/* Triangles in space with one normal and one uv a vertex. */
typedef struct {
    uint32_t n_vertices, n_triangles;
    Vec3 *place, *normal; /* [n_vertices] */
    Vec2 *uv;             /* [n_vertices] 0 … 1, v up */
    uint32_t (*triangle)[3];
} Surface;

Surface *surface_new(uint32_t n_vertices, uint32_t n_triangles);
void surface_free(Surface *s);

/* Normals by angle-weighted faces around each vertex. */
void surface_normals(Surface *s);

/* A vein as a chain of balls, smoothly joined: centre and radius. */
typedef struct {
    uint32_t sequence; /* of the skeleton, NO_PARENT: of none */
    uint32_t n;
    Vec3 *centre;      /* [n] */
    Vec2 *rest;        /* [n] where it lies in the flat blade, segments: there its colour is in the maps */
    double *radius;    /* [n] */
    uint32_t *node;    /* [n] nearest node of the skeleton on the sequence; of the petiole the midrib's first */
    Vec3 up;           /* the blade's normal at the first ball, where the rings' frames start */
    uint32_t sides;    /* of its cross-section, 0: the definition's */
    uint32_t petiole;  /* the first so many balls are the petiole's, far end first */
    bool inside;       /* begins within its parent's tube */
} Tube;

typedef struct {
    double scale;           /* of the vein radii, 1: the network's */
    double offset;          /* towards the abaxial side, in radii; 1: the vein touches the blade from below */
    double least_radius;    /* thinner veins are drawn this thick, segments */
    double petiole_length;  /* segments; 0: none */
    double petiole_radius;  /* where it meets the blade, segments; 0: by the primaries that come together there */
    double petiole_bend;    /* degrees over its length, away from the sunny side */
    uint32_t sides;         /* of the thickest cross-section, 3 … 64; thinner veins have fewer, down to 3 */
    double spacing;         /* farthest that two balls stand apart, segments; 0: any */
} SolidDef;

SolidDef solid_def_default(double leaf_length);

/* Tubes of all sequences that are drawn, the midrib's first, which begins with the petiole (if that has a length); `normal[n_nodes]` is the
 * blade's unit normal at each node. A branch begins inside its parent's tube, a little widened, so the two join without a gap. Balls stand
 * where branches leave, and between as the lie of the flat vein and its thickness ask for. How many a tube has depends on the skeleton and
 * `def` alone, so that poses of one leaf have the same tubes. *n_tubes receives their number. */
Tube *solid_tubes(const Pose *p, const Vec3 *normal, const SolidDef *def, uint32_t *n_tubes);
void solid_tubes_free(Tube *t, uint32_t n);
void solid_tube_clear(Tube *t);

/* Tubes as closed triangle surfaces with round ends, one after the other, with frames that don't twist. uv holds the rest place of the tube's
 * node in segments; whoever knows the maps' frame makes it a uv. */
Surface *solid_surface(const Tube *t, uint32_t n_tubes, const SolidDef *def);

/* How many triangles a tube has there. */
uint32_t solid_tube_triangles(const Tube *t, const SolidDef *def);

/* node[n_vertices] of solid_surface's result: the skeleton node that each vertex goes with. */
void solid_vertex_nodes(const Tube *t, uint32_t n_tubes, const SolidDef *def, uint32_t *node);

#endif
