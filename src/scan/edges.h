/* Edge maps of grey images by the operators that Fang & Shen 2013 (section 3.2) compare: differences (Roberts, Sobel, Prewitt), Laplacian
 * of Gaussian, Canny. Grey values are of any scale; x runs to the right, y down the rows, and beyond the image every border pixel goes
 * on for ever (replicated), so that the border itself is no edge. Uses + − × ÷ √ only: the same bits everywhere. */
#ifndef SCAN_EDGES_H
#define SCAN_EDGES_H

#include "scan/mask.h"

/* Pixel (i, j) is the square [i, i+1] × [j, j+1] of the image plane; its value stands for its centre. */
typedef struct {
    uint32_t width, height;
    float *px; /* [height][width], rows from the top */
} GreyImage;

GreyImage *grey_image_new(uint32_t width, uint32_t height); /* zeros */
void grey_image_free(GreyImage *g);

typedef enum {
    EDGES_ROBERTS,   /* 2×2 cross, the paper's choice; speaks of the point where four pixels meet, the lower right corner of its pixel */
    EDGES_SOBEL,     /* [-1 0 1]/2 along, [1 2 1]/4 across */
    EDGES_PREWITT,   /* [-1 0 1]/2 along, [1 1 1]/3 across */
    EDGES_LAPLACIAN, /* zero crossings of the Laplacian of the image smoothed by a Gaussian (Marr & Hildreth 1980) */
    EDGES_CANNY,     /* ridges of Sobel's magnitude on the smoothed image, followed by hysteresis (Canny 1986) */
} EdgesOperator;

typedef enum {
    EDGES_ERROR_IMAGE,    /* empty, or a pixel that is no number */
    EDGES_ERROR_SETTINGS, /* a parameter out of its range */
} EdgesError;
#define EDGES_ERROR edges_error_quark()
GQuark edges_error_quark(void);

typedef struct {
    EdgesOperator op;
    double sigma;   /* Gaussian smoothing before the operator, pixels, 0 … 100; 0 is none. EDGES_LAPLACIAN wants 0.5 or more */
    bool automatic; /* choose high and low by edges_otsu */
    double high;    /* a response above it is an edge … */
    double low;     /* … and so is one above this, 0 … high, that is connected (8 neighbours) to an edge; low = high: no hysteresis */
} EdgesDef;

/* The paper's: Roberts without smoothing, thresholds chosen automatically. */
EdgesDef edges_def_default(void);

/* The image smoothed by a Gaussian cut off at 4 sigma; a copy for sigma 0. NULL and `error` for an unusable image or sigma. */
GreyImage *edges_smooth(const GreyImage *in, double sigma, GError **error);

/* Derivatives along x and y in grey per pixel; op is one of Roberts, Sobel, Prewitt. Kernels are scaled so that a ramp gives its slope. */
void edges_gradient(const GreyImage *in, EdgesOperator op, GreyImage **gx, GreyImage **gy);

/* How much of an edge each pixel is. Roberts, Sobel, Prewitt: length of the gradient, grey per pixel. Canny: that length (Sobel) where it
 * is largest along the gradient, else 0; of two equal neighbours the darker one keeps it. Laplacian: the steepest step of the Laplacian,
 * grey per pixel³, between the pixel and one of its four neighbours of the other sign when the pixel is the one nearer to 0 (of equals the
 * left or upper one), else 0. O(pixels · sigma). */
GreyImage *edges_response(const GreyImage *in, EdgesOperator op, double sigma, GError **error);

/* Pixels beyond which nothing has any say in a response: a part of an image with so much around it responds as the whole does. */
uint32_t edges_reach(EdgesOperator op, double sigma);

/* Whether edges_response takes that sigma, and edges_map those thresholds; false and `error` where not. */
bool edges_check(const EdgesDef *def, GError **error);

/* The threshold that parts the responses, zeros too, into two classes of greatest variance between them (Otsu 1979), over 256 classes of
 * size from 0 to the greatest response; the middle of several equally good. 0 when all are 0. */
double edges_otsu(const GreyImage *response);

/* Thins what has the bit, row by row, to lines one pixel wide, 8-connected. */
void edges_thin(const Mask *m, uint8_t bit);

/* The edge map: 1 on edges, 0 elsewhere. Canny's is thinned to lines one pixel wide, 8-connected. Automatic thresholds are high = Otsu's,
 * but no less than a millionth of the image's grey range (Laplacian: over sigma²), which is rounding noise; low = high, for Canny 0.4
 * high. Those used go to used[2] = {high, low} unless it is NULL. */
GreyImage *edges_map(const GreyImage *in, const EdgesDef *def, double used[2], GError **error);

#endif
