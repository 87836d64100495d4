/* Teeth of a leaf margin: the sum of triangular waveforms (Runions 2005, section 3.2). */
#ifndef GEOM_TEETH_H
#define GEOM_TEETH_H

#include <glib.h>

#include "geom/outline.h"

/* Lifts one side of a margin, `side` with n >= 2 points from base to tip, along its normal: to the right of the walk
 * when `outward` is 1, to the left when -1. Heights and lengths in leaf lengths. Between tooth_from and tooth_to (parts
 * of the arc length) each waveform runs through `count` periods; a last period that is not whole bears no tooth. Every
 * peak and valley becomes a vertex, so teeth are sharp. Returns the points (Vec2), the ends included. O((n + teeth) log
 * (n + teeth)). */
GArray *teeth_apply(const OutlineDef *def, const Vec2 *side, uint32_t n, double outward);

#endif
