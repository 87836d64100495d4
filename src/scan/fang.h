/* A leaf's profile as Fang & Shen 2013 rebuild it: edges, contour, characteristic points, two sides of Bézier curves (sections 3 and
 * 4.1). */
#ifndef SCAN_FANG_H
#define SCAN_FANG_H

#include "geom/bezierfit.h"
#include "geom/polygon.h"
#include "scan/corners.h"
#include "scan/edges.h"
#include "scan/fang_region.h"
#include "scan/scan.h"
#include "scan/threshold.h"

typedef struct {
    ThresholdDef threshold; /* of the rough region (scan/fang_rough.h); edges are looked for in its channel */
    double close, open;     /* of the rough region, as in ProfileDef, pixels */
    double least_area;      /* of a leaf, share of the largest */
    uint32_t leaf;          /* which: 1 the largest, 2 the next */
    EdgesDef edges;         /* grey values are 0 … 255 whatever the depth. Automatic: thresholds by the strength of the leaf's margin, and when
                             * sigma is 0 as much smoothing as noise asks for (scan/fang_edges.h); any other sigma is kept to */
    CornersDef corners;
    BezierFitDef fit;
    bool keep_stalk;
    bool has_base, has_tip;
    Vec2 base, tip;         /* y-up pixels, given by hand */
} FangDef;

/* The paper's: Roberts, Harris, chords. Chords leave real leaves by up to hundreds of pixels where a lobe has few corners;
 * BEZIERFIT_CONTOUR with a tolerance of 1.5 follows them to 2. */
FangDef fang_def_default(void);

typedef struct {
    Threshold threshold;
    EdgesDef used;      /* sigma and thresholds that were used */
    FangMatch region;     /* how well edges and rough region agree */
    Polygon *border;    /* of the leaf by its edges, y-up pixels, counter-clockwise */
    Polygon *contour;   /* the same, each vertex moved to where the edge is strongest, drawn-out tips gone on with (scan/sharp.h); vertex 0 is the base, or the petiole's end when it is kept */
    uint32_t base, tip; /* vertices of the contour */
    GArray *corners;    /* Corner: the characteristic points, along the contour */
    BezierFit *fit;
    Polygon *outline;   /* the fit, flattened to a tenth of a pixel; simple; vertex 0 as in the contour */
    double mm_per_pixel;
} FangProfile;

/* One leaf of a scan. The paper takes the operator's edges as the contour, from pictures where these are closed and nothing else is
 * there. On scans they have gaps, and veins, grids and shadows are edges too. So here the level says about where the leaf is, and the
 * edges within a band around that region's border say where its contour runs (scan/fang_region.h); it is then drawn in to the middle of
 * the edges. When the fit crosses itself (deep teeth, few points) pieces are parted until it doesn't; that always ends, at the contour
 * itself.
 * NULL and SCAN_ERROR_NO_LEAF when there is no leaf, there are edges along less than half of its margin, or they enclose more than
 * 2 % more or less than is leaf by its level; SCAN_ERROR_SIZE when there is no memory; SCAN_ERROR_VALUE, EDGES_ERROR, CORNERS_ERROR or BEZIERFIT_ERROR
 * for settings that can't be used. Holds one byte a pixel besides the scan, some more along outlines, and some megabytes (scan/fang_tiles.h). */
FangProfile *fang_capture(const Scan *s, const FangDef *def, GError **error);
void fang_profile_free(FangProfile *p);

#endif
