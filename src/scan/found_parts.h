/* Parts of the search for veins (found.h); private to found_*.c. Everything here is in working pixels, y down, pixel centres at halves. */
#ifndef SCAN_FOUND_PARTS_H
#define SCAN_FOUND_PARTS_H

#include "scan/found.h"
#include "scan/stalk_over.h"

/* The leaf at working resolution. */
typedef struct {
    const Scan *scan;
    uint32_t width, height;
    double x0, y0;       /* upper left corner in the scan, pixels, y down */
    double step;         /* pixels of the scan to one of these */
    double length;       /* longer side of the outline's box */
    uint32_t pad;        /* pixels around the outline's box */
    uint8_t *inside;     /* [height][width] 1 in the blade */
    uint8_t *deep;       /* 1 where a ridge is none of the border's */
    uint8_t *hole;       /* 1 in holes that the outline doesn't know of, and around them where the blade isn't deep */
    StalkOver *over;     /* a petiole that lies over the blade, a hole, too; NULL when there is none, or the base isn't known */
    uint32_t n_planes;   /* 1 or 3 */
    GreyImage *plane[3]; /* illumination evened, 0 outside, veins of either polarity */
} FoundLeaf;

enum { FOUND_SIDE = 1200 }; /* working pixels */

/* base: where veins run together, y-up pixels of the scan; NULL: not known. longest: the longer side has no more working pixels. */
bool found_leaf_init(FoundLeaf *l, const Scan *s, const Polygon *outline, const Vec2 *base, double longest, GError **error);
void found_leaf_clear(FoundLeaf *l);

/* Marks holes by the threshold, besides those known, but none so near to the base, pixels of the scan, where veins are thick and pale. */
void found_open_holes(FoundLeaf *l, const Threshold *t, const Vec2 *base, double thick);

/* One pass of the filter over an image at one width. */
typedef struct {
    GreyImage *best;     /* contrast of the best direction, 0 where negative */
    GreyImage *other;    /* the same for the other polarity */
    uint8_t *direction;  /* 0 … 15, of the best */
    GreyImage *along[8]; /* NULL: not wanted */
} FoundLines;

enum { FOUND_DIRECTIONS = 16, FOUND_MOVES = 8 };

/* half: half the ridge's width; reach: sigma of the average along the line. */
void found_lines(const FoundLeaf *l, const GreyImage *in, double half, double reach, bool along, FoundLines *out);
void found_lines_clear(FoundLines *f);

/* The value below which `share` of the pixels in the blade's depth lie. */
double found_quantile(const FoundLeaf *l, const GreyImage *g, double share);

/* Mixes the planes into one in which veins are bright and stand out most. *bright: whether they are lighter in grey. */
GreyImage *found_mix(const FoundLeaf *l, bool *bright);

bool found_def_check(const FoundDef *def, GError **error);
FoundRidges *found_ridges_of(const FoundLeaf *l, const FoundDef *def);

/* --- paths --- */

typedef struct {
    Vec2 *p;
    double *width;
    uint32_t n;
    uint32_t parent;  /* index of the vein it leaves; its own: none */
    uint8_t order;
    bool ghost;       /* looked at and dismissed; keeps others off its place */
    double gain, contrast; /* evidence; mean contrast over noise */
    uint32_t *pixel, n_pixels;
} FoundVein;

typedef struct FoundPaths FoundPaths;

/* base, in working pixels: around it steps cost little, as veins run together there. */
FoundPaths *found_paths_new(const FoundLeaf *l, const FoundRidges *r, double threshold, Vec2 base);
void found_paths_free(FoundPaths *p);

/* Cheapest path between two points, from the first on as far as there is evidence for it; *gain is that evidence, working pixels. Before any other. */
uint32_t *found_paths_between(FoundPaths *p, Vec2 from, Vec2 to, uint32_t *n, double *gain);

/* Makes pixels those of a vein, which no path crosses. From the first open_n paths may set out: in any direction from the first free_n, from others
 * not back along it. A band around it counts for no other. */
void found_paths_add(FoundPaths *p, uint32_t id, const uint32_t *pixel, uint32_t n, double band, uint32_t open_n, uint32_t free_n);

/* The path with most evidence that leaves a vein, *id; from the vein on. NULL when none gathers more than `least`. */
uint32_t *found_paths_best(FoundPaths *p, double least, uint32_t *n, uint32_t *id, double *gain);

/* Smooth points at even steps along the ridge, widths measured. */
void found_trace(const FoundLeaf *l, const FoundRidges *r, FoundVein *v);

/* The primary that a petiole lies over goes on below it to the margin, and isn't what turns aside from it before. */
void found_under(const FoundLeaf *l, const FoundRidges *r, GArray *vein);

/* Another beginning: the n points of `lead`, as wide as the vein is at its point `keep`, instead of those before that. */
void found_lead(FoundVein *v, uint32_t keep, const Vec2 *lead, uint32_t n);

/* Appends the primaries of a parallel-veined leaf, from base to tip, their pixels only; false, and nothing appended, when the leaf is none. Threshold: strength
 * that makes a ridge. */
bool found_parallel(const FoundLeaf *l, const FoundRidges *r, Vec2 base, Vec2 tip, double threshold, GArray *vein);

/* Veins begin on the lines of those they leave, and are no wider than those are there. */
void found_join(FoundVein *vein, uint32_t n);

/* Primaries that run together at the base begin at one node on the midvein, which is the first of the veins and begins at the base itself. */
void found_hub(const FoundLeaf *l, FoundVein *vein, uint32_t n, Vec2 base);

#endif
