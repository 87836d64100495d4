/* Bézier pieces along a contour whose outline never crosses itself. */
#ifndef SCAN_FANG_OUTLINE_H
#define SCAN_FANG_OUTLINE_H

#include "geom/bezierfit.h"
#include "geom/polygon.h"

/* bezierfit_new on a simple contour, and the fit flattened to a tenth of a pixel, which starts at the base. Pieces that cross or touch
 * others are parted in about the middle until none do. A piece along a single edge of the contour is made straight, so that at the end
 * there is the contour itself. at[] is of uint32_t: the characteristic points. */
BezierFit *fang_fit(const Polygon *contour, const GArray *at, uint32_t base, uint32_t tip, const BezierFitDef *def, Polygon **outline,
                    GError **error);

#endif
