/* A petiole that is bent back and lies over the blade: neither margin nor vein, and none of the blade's colours. */
#ifndef SCAN_STALK_OVER_H
#define SCAN_STALK_OVER_H

#include "geom/polygon.h"
#include "scan/mask.h"
#include "scan/scan.h"
#include "scan/threshold.h"

/* From its free end to where it was followed near the base, y-up pixels of the scan. */
typedef struct {
    Vec2 p;      /* on its middle line */
    double half; /* half its width */
    bool over;   /* blade on both sides, but for gaps shorter than its width */
    bool out;    /* ground on both sides */
} StalkPoint;

typedef struct {
    StalkPoint *point;
    uint32_t n;
    double width; /* as usual along it */
    double length;
    Box2 box;  /* of all of it */
    uint32_t first; /* point that has blade on both sides */
} StalkOver;

/* Looks for a strip of even width and a colour of its own that begins near the base, has blade on both sides for some of its widths, and goes on beyond the
 * blade, which no vein does. NULL when there is none. What it wholly
 * parts from the blade is not put back to it. The petiole must look out of the blade farther from the base than usual petioles do. `t` NULL: a
 * threshold is looked for. Some 10⁶ operations, besides that. */
StalkOver *stalk_over_find(const Scan *s, const Polygon *outline, const Threshold *t, Vec2 base);
void stalk_over_free(StalkOver *o);

/* How far a point lies outside of it, negative inside. *at, unless NULL, receives the index of the point before the nearest place. O(points). */
double stalk_over_distance(const StalkOver *o, Vec2 q, uint32_t *at);

/* Makes its pixels those of the blade (MASK_THIS) where that lies on both sides of it, and beyond that as far as a disc shows how the blade goes on below it;
 * what looks out of the blade becomes MASK_STALK. `corner`: the middle of the window's upper left pixel. Scan/stalk_mend.c. */
void stalk_over_mend(const StalkOver *o, const Mask *w, Vec2 corner);

#endif
