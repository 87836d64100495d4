/* Where a thin stalk meets the blade: the petiole in a leaf's silhouette. */
#ifndef SCAN_STALK_H
#define SCAN_STALK_H

#include "geom/vec.h"
#include "scan/mask.h"

/* Points in columns and rows of the window, pixel centres at whole numbers. */
typedef struct {
    Vec2 base;     /* middle of where it meets the blade */
    Vec2 end;      /* middle of its free end */
    double width;  /* pixels; as usual along it: the mean of its middle half when sorted */
    double length; /* pixels */
    uint64_t area; /* pixels */
} Stalk;

/* Looks for a stalk in the region MASK_THIS of a window that is just its box, and marks it MASK_STALK.
 *
 * What an opening by a disc of 0.17 of the blade's greatest half width takes away is what is thin: tips of teeth and lobes, and stalks. A
 * stalk hangs on the blade by one side, is at least as long as wide, keeps its width to its end where tips taper, and of several parts
 * that are like that it is the largest. An opening by a disc just wider than it then shows where it widens into the blade. False,
 * and nothing marked, when there is none. Uses MASK_CORE and MASK_WORK. */
bool stalk_find(const Mask *w, Stalk *out);

/* The base moved to the middle of the petiole as it is seen, for of a pale or shaded one the mask may have one side only: `plant` says whether a pixel of the
 * window is clearly none of the ground. Needs the marks of stalk_find. */
Vec2 stalk_middle(const Mask *w, const Stalk *s, bool (*plant)(const void *user, uint32_t x, uint32_t y), const void *user);

#endif
