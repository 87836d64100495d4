/* Veins found in the image of a leaf: a ridge filter, and the best paths from the base (what Hong 2005, § 5.4 leaves to the hand). */
#ifndef SCAN_FOUND_H
#define SCAN_FOUND_H

#include "geom/polygon.h"
#include "scan/scan.h"
#include "scan/edges.h"
#include "sim/drawing.h"

typedef struct {
    double least_width, most_width; /* of veins looked for, pixels; 0: by the leaf's size */
    unsigned orders;                /* 1: primaries only, 2: and secondaries, 3: … */
    double sensitivity;             /* 0 … 1: how faint a ridge still is a vein */
} FoundDef;
FoundDef found_def_default(void); /* by size, 2, 0.5 */

enum { FOUND_SHORTEST = 16 }; /* pixels: the longer side of an outline in which veins can be found */

/* Images of the box around the leaf at a working resolution: its longer side is no longer than 1200 working pixels. Working pixel (i, j) is the square
 * of the scan from corner + step (i, -j) to corner + step (i+1, -j-1), y up. All are 0 outside the outline, and strength is along it. */
typedef struct {
    Vec2 corner;           /* upper left, y-up pixels of the scan */
    double step;           /* pixels of the scan to one working pixel, >= 0.5 */
    bool bright;           /* veins are lighter than the blade around them, else darker; of colours, in grey */
    double noise;          /* typical contrast of lines of the other polarity, which are no veins, as `contrast` is */
    GreyImage *light;      /* the image the filter saw: colours mixed so that veins stand out, illumination evened, veins bright */
    GreyImage *strength;   /* how much of a ridge, 0 … 1; 0.5 where a line stands out as clearly as the strongest of pure noise do, about */
    GreyImage *cosine, *sine; /* of twice the angle along the ridge, anticlockwise from x */
    GreyImage *width;      /* diameter of the best scale's ridge, pixels of the scan */
    GreyImage *along[8];   /* strength by direction, for paths: 0, 26.6, 45, 63.4, 90 … degrees anticlockwise from x */
} FoundRidges;

/* Lines that are lighter than what lies on both sides of them, or darker, whichever the leaf has: contrast to the lesser side, averaged along the line
 * over a few widths, the best of several widths and 16 directions, compared with what lines of the other polarity reach. */
FoundRidges *found_ridges(const Scan *s, const Polygon *outline, const FoundDef *def, GError **error);
void found_ridges_free(FoundRidges *r);

/* Primaries, secondaries … of the leaf whose outline (y-up pixels, scan/profile.h) is given, as a first draft to be corrected by hand: orders are set, widths
 * measured. The midvein first: the cheapest path from base to tip, as far as there is evidence; then, one by one, the paths that leave veins already
 * found and gather most evidence. Long prominent ones from near the base are primaries too. Veins start at the parent. EMPTY drawing (not NULL) when nothing stands out. Memory: about 30 float images of
 * at most 1.9 million pixels, and half as much again at worst, whatever the scan's size. SCAN_ERROR_VALUE for settings that can't be used, SCAN_ERROR_SIZE for
 * an outline shorter than FOUND_SHORTEST or off the image. */
Drawing *found_veins(const Scan *s, const Polygon *outline, Vec2 base, Vec2 tip, const FoundDef *def, GError **error);

/* How well a drawing agrees with another taken as true: shares of the length of lines within `reach`. */
typedef struct {
    double precision; /* of the found ones' length, the share near a true one */
    double recall;    /* of the true ones' length, the share near a found one */
} FoundScore;
FoundScore found_score(const Drawing *found, const Drawing *truth, double reach);

#endif
