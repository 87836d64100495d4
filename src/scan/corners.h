/* Characteristic points of a leaf's contour: Harris corners on it, with tip and base (Fang & Shen 2013, section 3.2; Harris & Stephens
 * 1988). */
#ifndef SCAN_CORNERS_H
#define SCAN_CORNERS_H

#include "geom/vec.h"
#include "scan/edges.h"

typedef struct {
    double smoothing; /* sigma of the Gaussian before the derivatives, pixels, 0 … 100 */
    double window;    /* sigma of the Gaussian window in which gradients are compared, pixels, 0.5 … 100 */
    double k;         /* weight of trace² in the response, 0 … 0.25. No corners are bends of a radius above window / √k, about, and
                       * those that turn by less than 2 √k radians */
    double threshold; /* least response of a corner, as part of the greatest on the contour, 0 … 1 */
    double spacing;   /* least way along the contour from one characteristic point to the next, pixels */
    double size;      /* extent (diagonal of its box) of a contour, pixels, beyond which smoothing, window and spacing grow in proportion: the teeth of a
                       * leaf scanned twice as finely are as blunt for twice as many pixels. 0: they stay */
} CornersDef;

/* 1, 2, 0.04, 0.02, 8, 1200: bends of a radius above 10 pixels, or 1/120 of a larger contour's extent, or of less than 23° are smooth. */
CornersDef corners_def_default(void);

typedef enum {
    CORNERS_ERROR_SETTINGS, /* a parameter out of its range */
    CORNERS_ERROR_CONTOUR,  /* too short, no numbers, base or tip not on it */
} CornersError;
#define CORNERS_ERROR corners_error_quark()
GQuark corners_error_quark(void);

/* Whether they can be used; false and CORNERS_ERROR_SETTINGS where not. */
bool corners_check(const CornersDef *def, GError **error);

/* The same with lengths for the extent of that contour, and size 0. */
CornersDef corners_scaled(const CornersDef *def, const Vec2 *v, uint32_t n);

/* det M - k trace² M at every pixel, M the windowed sum of products of Sobel derivatives of the image, whose grey range counts as 1:
 * positive at corners, negative on straight edges, 0 on plain ground; pixels⁻⁴. EDGES_ERROR for an unusable image. O(pixels · (smoothing +
 * window)). */
GreyImage *corners_response(const GreyImage *in, const CornersDef *def, GError **error);

/* The same of a part of an image whose grey values lie between `least` and `most`: what is 4 (smoothing + window) + 3 or more pixels within it responds as in
 * the whole. */
GreyImage *corners_response_in(const GreyImage *part, double least, double most, const CornersDef *def, GError **error);

typedef struct {
    uint32_t at;     /* vertex of the contour */
    double response; /* Harris; any value at base and tip */
} Corner;

/* The characteristic points among the vertices v[n] of a closed contour, which is given densely (a vertex a pixel or more) in the image
 * plane (edges.h: the middle of the upper left pixel is 0.5,0.5), smoothly or as the boundary of pixels. Base and tip, two of its
 * vertices, are always among them. The others are local maxima along the contour of the response (read between pixels, at the mean place
 * of the vertices within `window` along the contour), positive and no less than the threshold. As the maximum sits a little beside a
 * corner, each is moved to the vertex within 3 (smoothing + window), but no more than `spacing`, along the contour that is farthest from
 * the chord of that stretch: the corner itself where two straight sides meet. Stronger ones (of equals the first) keep weaker ones nearer
 * than `spacing` away. Returns Corner in the order of the contour. */
GArray *corners_find(const GreyImage *in, const Vec2 *v, uint32_t n, uint32_t base, uint32_t tip, const CornersDef *def, GError **error);

/* The response in an image of that size; no others than its pixels are asked for. */
typedef struct {
    uint32_t width, height;
    float (*read)(const void *user, uint32_t x, uint32_t y);
    const void *user;
} CornersField;

/* The same by a response that is known within `window` + 2 of the contour, for corners_scaled settings. */
GArray *corners_choose(const CornersField *response, const Vec2 *v, uint32_t n, uint32_t base, uint32_t tip, const CornersDef *def, GError **error);

#endif
