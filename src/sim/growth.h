/* Growth of the leaf blade (Runions 2005, sections 2.2, 3.3 and appendix A).
 *
 * Positions live in a frame in which most growth models leave material points at rest:
 *   marginal, none   the frame is the leaf in segments; only the margin moves
 *   isogonic         the frame is the final leaf; the unit distance shrinks to 1 instead (the paper's trick)
 *   nonuniform       the frame is the current leaf; material points are moved at every step
 * At the end of growth the frame is the leaf in segments in every model. */
#ifndef SIM_GROWTH_H
#define SIM_GROWTH_H

#include <glib.h>

#include "geom/polygon.h"
#include "geom/vec.h"

typedef enum { GROWTH_MARGINAL, GROWTH_ISOGONIC, GROWTH_NONUNIFORM, GROWTH_NONE } GrowthKind;

typedef struct {
    GrowthKind kind;
    double initial_length, final_length, step; /* segments */
    uint32_t steps;                            /* nonuniform: steps of growth */
    /* nonuniform: (y, g) pairs, y ascending in initial leaf lengths; RERG = 1 + g, straight between, constant beyond */
    const double *rate_x, *rate_y;
    uint32_t n_rate_x, n_rate_y;
} GrowthDef;

GrowthDef growth_def_default(void);

typedef enum { GROWTH_ERROR_VALUE } GrowthErrorCode;
#define GROWTH_ERROR growth_error_quark()
GQuark growth_error_quark(void);

/* The blade at one step. Read the fields; change them through blade_advance alone. */
typedef struct Blade Blade;
struct Blade {
    uint32_t step, last_step; /* now; the step at which growth ends */
    double length, last_length; /* leaf length now and at the end, segments */
    double scale;             /* leaf lengths to frame */
    double unit;              /* one segment in the frame */
    double area;              /* segments² */
    Box2 box, widest;         /* of the blade in the frame, now and over the whole growth */
    bool moving;              /* material points move in the frame (nonuniform) */
    const Polygon *leaf;      /* the outline in leaf coordinates; borrowed, but `fine` for nonuniform growth */
    Polygon *fine;            /* the outline with long edges cut up, as growth bends them */
    Polygon *shape, *last_shape; /* nonuniform: the outline in the frame, now and at the end */
    struct GrowthTable *table;
    Vec2 (*back)[2]; /* marginal: edges of the outline that turn their back on the base, [n_back]; see blade_contains */
    uint32_t n_back;
    GrowthDef def;
};

/* The blade at step 0. NULL and GROWTH_ERROR when the lengths or rates contradict each other. The rate arrays are copied. */
Blade *blade_new(const Polygon *leaf, const GrowthDef *def, GError **error);
void blade_free(Blade *b);

/* One step of growth; does nothing but count once growth has ended. */
void blade_advance(Blade *b);

/* Whether p lies in the blade and stays there. Where the base doesn't see the whole outline (a basal lobe behind a sinus, a hooked tooth), the
 * margin of marginal growth sweeps over some points twice; such a point belongs to the blade once the margin has passed it for good. So a
 * point that is in the blade at one step is in it at all later ones. */
bool blade_contains(const Blade *b, Vec2 p);

/* Whether a vein node may be born at p: in the blade, or so little off it that it never is more than a segment outside. */
bool blade_admits(const Blade *b, Vec2 p);

/* Leaf lengths to frame at an earlier step (not for nonuniform growth). */
double blade_scale_at(const Blade *b, uint32_t step);

/* Marginal growth and none: the first step at which blade_contains(p), or last_step when it never does. */
uint32_t blade_step_passed(const Blade *b, Vec2 p);

/* Leaf length at a step, segments. */
double blade_length_at(const Blade *b, uint32_t step);

/* Frame position now <-> material coordinates: where the point is, or would have been, at step 0, in initial segments.
 * Inverse to each other to rounding (Runions 2005, eq. 4 by lookup table). */
Vec2 blade_material(const Blade *b, Vec2 p);
Vec2 blade_place(const Blade *b, Vec2 material);

/* The outline now in the frame, as a polygon of its own. */
Polygon *blade_outline(const Blade *b);

#endif
