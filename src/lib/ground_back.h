/* Laying the back of a leaf onto its front: iterated closest points (Besl & McKay 1992) between their outlines, one of them mirrored. */
#ifndef LIB_GROUND_BACK_H
#define LIB_GROUND_BACK_H

#include "geom/affine.h"
#include "scan/profile.h"

/* Mean distance of the outlines of two sides of a leaf, leaf lengths: beyond which it is odd, and beyond which it is another leaf. A leaf scanned once and
 * mirrored is off by 0.001, one turned over by less than 0.01 as it lies flat, the leaf next to it on the same vine 0.03, another species 0.055 and more. */
#define BACK_ODD 0.01
#define BACK_WRONG 0.05

typedef struct {
    Vec2 base, tip; /* of the leaf on the back's scan, y-up pixels */
    Affine map;     /* leaf coordinates to leaf coordinates there */
    double off;     /* mean distance of the outlines, there or back, whichever is more, in lengths of the front */
    bool same_side; /* without mirroring they fit much better; asked only where they are odd */
} BackLaid;

/* Of the leaves on the back's scan (Profile; they need not lie there in the same order) the one that fits best. Its base and tip may have been found the
 * other way round. About 30 ms a leaf of a thousand points, three times that where they don't fit. */
BackLaid ground_lay_back(const Polygon *outline, const GPtrArray *all);

#endif
