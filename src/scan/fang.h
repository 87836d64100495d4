/* A leaf's profile as Fang & Shen 2013 rebuild it: edges, contour, characteristic points, two sides of Bézier curves (sections 3 and
 * 4.1). */
#ifndef SCAN_FANG_H
#define SCAN_FANG_H

#include "geom/bezierfit.h"
#include "geom/polygon.h"
#include "scan/corners.h"
#include "scan/edges.h"
#include "scan/scan.h"
#include "scan/threshold.h"

typedef struct {
    Channel channel;       /* that edges are looked for in; CHANNEL_BEST: as profile_capture chooses */
    EdgesDef edges;        /* grey values are 0 … 255 whatever the depth. Automatic: thresholds by the strength of the leaf's margin, and more
                            * smoothing than `sigma` where noise would be edges (scan/fang_edges.h) */
    CornersDef corners;
    BezierFitDef fit;
    bool keep_stalk;
    bool has_base, has_tip;
    Vec2 base, tip;        /* y-up pixels, given by hand */
} FangDef;

/* The paper's: Roberts, Harris, chords. Chords leave real leaves by up to hundreds of pixels where a lobe has few corners;
 * BEZIERFIT_CONTOUR with a tolerance of 1.5 follows them to 2. */
FangDef fang_def_default(void);

typedef struct {
    GreyImage *edges;   /* the edge map, 1 on edges */
    Channel channel;
    EdgesDef used;      /* sigma and thresholds that were used */
    double closed;      /* gaps in the edges of up to twice this were closed, pixels */
    Polygon *border;    /* of what the edges enclose, y-up pixels, counter-clockwise */
    Polygon *contour;   /* the same, each vertex moved to where the edge is strongest; vertex 0 is the base, or the petiole's end when it is kept */
    uint32_t base, tip; /* vertices of the contour */
    GArray *corners;    /* Corner: the characteristic points, along the contour */
    BezierFit *fit;
    Polygon *outline;   /* the fit, flattened to a tenth of a pixel; simple; vertex 0 as in the contour */
    double mm_per_pixel;
} FangProfile;

/* Pixels of a scan that fang_capture takes. Besides the scan it holds 24 to 35 bytes a pixel at its peak, up to 60 where all is noise. */
#define FANG_MAX_PIXELS ((uint64_t)1 << 27)

/* The largest leaf of a scan. The contour is the outer border of what the edges enclose, gaps in the edges of up to 8 pixels closed,
 * drawn in to the middle of the edges (scan/fang_region.h). When the fit crosses itself (deep teeth, few points) pieces are parted until
 * it doesn't; that always ends, at the contour itself. NULL and SCAN_ERROR_NO_LEAF when the edges enclose nothing, or much less or more
 * than is leaf by its level, SCAN_ERROR_SIZE beyond FANG_MAX_PIXELS, SCAN_ERROR_VALUE, EDGES_ERROR, CORNERS_ERROR or BEZIERFIT_ERROR for
 * settings that can't be used. */
FangProfile *fang_capture(const Scan *s, const FangDef *def, GError **error);
void fang_profile_free(FangProfile *p);

#endif
