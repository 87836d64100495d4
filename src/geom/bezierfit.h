/* A leaf's contour as piecewise cubic Bézier curves through its characteristic points, in two sides parted at base and tip (Fang & Shen
 * 2013, section 4.1). Lengths are in the contour's own unit; y runs up. */
#ifndef GEOM_BEZIERFIT_H
#define GEOM_BEZIERFIT_H

#include <glib.h>

#include "geom/vec.h"

/* How tangents and handles (the distances of control points from ends) are found where two pieces join smoothly. At a cusp each side has a
 * tangent of its own; cusps are base, tip and every point where the contour itself turns by more than `cusp_angle`. */
typedef enum {
    /* The paper's: the tangent at Q_i is m = α_i (Q_i - Q_{i-1}) + α_{i+1} (Q_{i+1} - Q_i), control points lie at Q_i ± |chord| m / 3. The
     * α are those of the circle through the three points, 1/chord² up to a common factor that makes |m| = `tension`: m has no unit. At a
     * cusp m is the tangent of the piece's other end mirrored in the chord, as on a circle; a piece between two cusps is straight. (The
     * paper prints the chord between base and tip there, which suits neither round bases nor lobes.) On an arc of angle θ and radius r the
     * deviation is r θ⁴/128. */
    BEZIERFIT_CHORDS,
    /* Those that fit the contour best: each piece's cubic of least squares gives the directions at its ends, at a smooth join the mean of
     * both pieces' (weighted by how well they fit), and then the handles of least squares. On an arc the deviation falls with θ⁶. */
    BEZIERFIT_CONTOUR,
} BezierFitRule;

typedef struct {
    BezierFitRule rule;
    double tension;    /* length of the paper's tangents m, above 0 to 3; rule CHORDS */
    double cusp_angle; /* degrees, 0 … 180 */
    double reach;      /* way along the contour over which its direction is read, several of its points; 0: eight mean edges */
    double tolerance;  /* a piece farther than this from the contour is parted where it is farthest; 0: pieces stay as they are. Less than
                        * the contour's own noise (a pixel and a half where it is the boundary of pixels) makes a chain of short pieces */
    double shortest;   /* pieces are parted into pieces no shorter than this, along the contour; 0: twice the reach */
} BezierFitDef;

/* The paper's rule with tension 1; cusps from 30°; no parting. */
BezierFitDef bezierfit_def_default(void);

typedef enum {
    BEZIERFIT_ERROR_SETTINGS, /* a parameter out of its range */
    BEZIERFIT_ERROR_CONTOUR,  /* too short, no numbers, base or tip not on it */
} BezierFitError;
#define BEZIERFIT_ERROR bezierfit_error_quark()
GQuark bezierfit_error_quark(void);

typedef struct {
    Vec2 p[4];         /* ends p[0], p[3]; control points p[1], p[2] */
    uint32_t from, to; /* the ends' vertices of the contour */
    bool cusp;         /* it starts at a cusp */
    double largest;    /* distance of the contour's vertices from … to from the piece, and of places on the piece from the contour */
    double mean;       /* of the former, by length of contour */
    uint32_t farthest; /* the vertex at the largest */
} BezierPiece;

typedef struct {
    BezierPiece *piece;  /* [n] along the contour from the base on, each starting where the one before ends, the last ending at the base */
    uint32_t n, n_right; /* piece[0 … n_right-1] run from base to tip: the right side */
    double largest, mean; /* of all */
} BezierFit;

/* Fits the closed contour v[n], counter-clockwise, which is given densely (the deviation is measured at its vertices, the direction within
 * `reach`). at[n_at], in any order, are the characteristic points' vertices; base and tip are taken whether among them or not. O(n · log
 * n) for usual contours. NULL and `error` for unusable input. */
BezierFit *bezierfit_new(const Vec2 *v, uint32_t n, const uint32_t *at, uint32_t n_at, uint32_t base, uint32_t tip,
                         const BezierFitDef *def, GError **error);
void bezierfit_free(BezierFit *fit);

/* SVG path data "M… C… Z", y up, as [outline] path takes it: it starts at the base. Coordinates are rounded to `decimals`, 0 … 15. */
char *bezierfit_path(const BezierFit *fit, int decimals);

#endif
