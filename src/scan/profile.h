/* From a scan to the outlines of the leaves on it (Hong 2005, chapter 5; process A of the paper). */
#ifndef SCAN_PROFILE_H
#define SCAN_PROFILE_H

#include "geom/polygon.h"
#include "scan/mask.h"
#include "scan/threshold.h"

/* All lengths are in pixels and all points in y-up pixel units: the image is the box from (0, 0) to (width, height). */
typedef struct {
    ThresholdDef threshold;
    double close, open;  /* radii of discs by which gaps are closed, then thin and small things removed; 0: not done */
    bool each;           /* every leaf, not just the largest */
    double least_area;   /* of a leaf, share of the largest; what is smaller is a speck */
    bool keep_stalk;     /* the outline is that of all that is leaf; else the petiole is cut off where it meets the blade, and where it lies over the blade it is no margin */
    bool has_base, has_tip; /* given by hand; not with `each` */
    Vec2 base, tip;
    uint32_t square;     /* side of the marching square */
    bool subpixel;       /* outline between pixels by their levels */
    double tolerance;    /* of the outline's simplification; 0: none */
} ProfileDef;

/* Otsu on the best channel, the largest leaf, petiole cut off, square 1, levels, tolerance 1. */
ProfileDef profile_def_default(void);

/* How the base was found. */
typedef enum {
    BASE_GIVEN,
    BASE_STALK, /* where the petiole meets the blade */
    BASE_AXIS,  /* an end of the line of best symmetry: there is no petiole, or it lies far from any such line (bent over the blade) */
} ProfileBase;

typedef struct {
    Polygon *outline;     /* counter-clockwise, never self-crossing; vertex 0 is the base, or the nearest to it, or the petiole's end when kept */
    Vec2 base, tip;       /* on the outline, unless given elsewhere or the petiole was kept; both vertices then, if square and tolerance allow */
    ProfileBase base_from;
    double symmetry;      /* of the line from base to tip: share of the blade that is blade again when mirrored about it */
    double mm_per_pixel;  /* 0: unknown */
    double area;          /* of the outline as traced, before simplification; pixels² */
    double beyond;        /* of what in it lies on the other side of the threshold: holes (scan/openings.h), but pale veins and glare, too; pixels² */
    double perimeter;     /* of the outline as traced, without holes */
    uint32_t nodes;       /* of the outline as traced */
    bool has_stalk;
    Vec2 stalk_end;       /* its free end */
    double stalk_width, stalk_length;
} Profile;

/* The leaves of a scan, largest first; *used (unless NULL) receives the threshold. SCAN_ERROR_NO_LEAF when there is none, SCAN_ERROR_VALUE for settings
 * that can't be used. Holds one byte a pixel besides the scan, and some more along outlines. About 0.1 s per 10⁷ pixels and channel tried. */
GPtrArray *profile_capture(const Scan *s, const ProfileDef *def, Threshold *used, GError **error);

/* The same where the leaf's pixels are marked already, by MASK_LEAF and no other bit in a mask of the scan's size, which is changed. The
 * threshold and `subpixel` are not used, but for a petiole over the blade one is looked for. */
GPtrArray *profile_capture_mask(const Scan *s, const Mask *m, const ProfileDef *def, GError **error);
void profile_free(Profile *p);

#endif
