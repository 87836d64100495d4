/* What a leaf starts from: its outline, from curves, a drawing or a scan; veins that were drawn or found; and the scan's colours. */
#ifndef LIB_GROUND_H
#define LIB_GROUND_H

#include "geom/affine.h"
#include "geom/holes.h"
#include "param/params.h"
#include "scan/fang.h"
#include "scan/profile.h"
#include "sim/drawing.h"

typedef struct {
    Polygon *outline;  /* leaf coordinates */
    Vec2 base, tip;    /* where 0,0 and 0,1 lie in the units of the outline's source (pixels of a scan), y up */
    Drawing *drawing;  /* leaf coordinates; NULL: no veins are drawn or found */
    bool found;        /* they were found in the scan */
    /* of a scan, else NULL */
    Scan *scan, *back;       /* with scan.texture the leaf's colours go on beyond its border and over its holes (scan/fill.h) */
    Affine to_scan, to_back; /* leaf coordinates to columns and rows, the image's upper left corner at 0,0 */
    Profile *profile;        /* by threshold; NULL when [outline] gave the margin */
    Threshold threshold;     /* that parts it from the background */
    bool has_threshold;      /* there is such a one */
    Holes *holes;            /* leaf coordinates: openings of the blade that stay open; NULL: none are kept */
    double back_off;         /* mean distance of the outlines of both sides, leaf lengths; 0 without a back */
    FangProfile *fang;       /* by edges */
    char *outline_lies, *drawing_lies; /* how the drawn outline and veins came to lie on it, in words (geom/svgplace.h); or NULL */
    const char *lsystem;     /* the preset by which an L-system drew the veins last, "pinnate" or "palmate"; NULL: none did, or one of its own rules */
    GString *note;           /* what a person should know of it, a line each */
    double cut_off;          /* part of the outline that runs along the edge of the image, where the leaf goes on */
} Ground;

/* Counted references, as the frames of a run share it. `veins`: drawn ones are read, others looked for in the scan. NULL with an error that names
 * file or parameter. */
Ground *ground_new(const Params *p, bool veins, GError **error);

/* A scan of several leaves, read and searched once for all of them. */
typedef struct GroundScan GroundScan;
GroundScan *ground_scan_new(const Params *p, GError **error);
uint32_t ground_scan_leaves(const GroundScan *sheet); /* scan.leaf counts them; at least 1 */
void ground_scan_free(GroundScan *sheet);

/* The same as ground_new for parameters that differ from the sheet's in scan.leaf alone, but each leaf only once without a new search. */
Ground *ground_new_on(GroundScan *sheet, const Params *p, bool veins, GError **error);
Ground *ground_ref(Ground *g);

/* Veins by [lsystem] in the outline, of `length` segments; what a person should know of them is noted. */
Network *ground_lsystem(Ground *g, const Params *p, double length, uint64_t seed, GError **error);
void ground_unref(Ground *g);

/* Colours of blade and larger veins, linear light, as drawings show them: the scan's, where it has the leaf's colours and [texture] gives none; veins
 * stand out at least as much as lines must. Else they stay. `g` may be NULL. */
void ground_colours(const Ground *g, const Params *p, float lamina[3], float vein[3]);

#endif
