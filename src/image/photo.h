/* The colours of a scan as those of the blade. */
#ifndef IMAGE_PHOTO_H
#define IMAGE_PHOTO_H

#include "geom/affine.h"
#include "scan/scan.h"

typedef struct {
    const Scan *scan;
    Affine to_scan; /* segments to columns and rows, the image's upper left corner at 0,0 */
    float tint[3];  /* multiplies linear light */
    float *linear;  /* [256] or [65536] linear light of a sample */
} Photo;

/* The scan is borrowed. */
Photo *photo_new(const Scan *scan, const Affine *to_scan, const float tint[3]);
void photo_free(Photo *p);

/* Mean colour, in linear light, of a square of side `size` segments around `at`; beyond the image its border goes on. O(scan pixels in it). */
void photo_colour(const Photo *p, Vec2 at, double size, float out[3]);

/* Scan pixels a segment. */
double photo_scale(const Photo *p);

#endif
