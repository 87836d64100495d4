/* Grey values and edge responses of a scan part by part, so that no image of floats is ever as large as the scan. */
#ifndef SCAN_FANG_TILES_H
#define SCAN_FANG_TILES_H

#include "scan/edges.h"
#include "scan/mask.h"
#include "scan/threshold.h"

/* A channel of a part of a scan in grey values 0 … 255, whatever the depth. To all that follows that part is the whole image: columns and rows count from
 * its corner, and beyond its border every border pixel goes on for ever (scan/edges.h). */
typedef struct {
    const Scan *scan;
    Channel channel;
    MaskBox box;
    uint32_t width, height;
} FangGrey;

FangGrey fang_grey(const Scan *s, Channel channel, MaskBox box);

/* Its least and greatest value. */
void fang_grey_range(const FangGrey *g, double *least, double *most);

/* Tiles side by side, row after row; a filter that looks no farther than `reach` pixels gives in `core` what it would give on the whole. */
typedef struct {
    MaskBox core, all; /* all: with what is within reach around it */
} FangTile;

uint32_t fang_tile_count(const FangGrey *g, uint32_t reach);
FangTile fang_tile(const FangGrey *g, uint32_t reach, uint32_t k);

/* The image t->all. */
GreyImage *fang_tile_grey(const FangGrey *g, const FangTile *t);

/* A value of the core in a filtered t->all; x, y of the whole. */
static inline float fang_tile_at(const GreyImage *filtered, const FangTile *t, uint32_t x, uint32_t y)
{
    return filtered->px[(gsize)(y - t->all.y0) * filtered->width + (x - t->all.x0)];
}

/* --- wanted here and there --- */

/* An image of which only the surroundings of some places are kept. */
typedef struct {
    uint32_t width, height;
    uint32_t across; /* blocks side by side */
    float **block;   /* NULL: nothing there is wanted */
} FangSparse;

enum { FANG_BLOCK = 16 }; /* pixels a side */

FangSparse *fang_sparse_new(uint32_t width, uint32_t height);
void fang_sparse_free(FangSparse *s);

/* Wants the pixel, or all of those within r columns and rows of a point that may lie beyond the image. */
void fang_sparse_want(FangSparse *s, uint32_t x, uint32_t y);
void fang_sparse_want_around(FangSparse *s, double x, double y, double r);

/* Filters an image; what comes out is of the same size. */
typedef GreyImage *(*FangFilter)(const GreyImage *in, const void *user);

/* Fills in all that is wanted. A tile without anything that is takes no time. */
void fang_sparse_fill(FangSparse *s, const FangGrey *g, uint32_t reach, FangFilter filter, const void *user);

/* The same by edges_response, whose settings must be ones that it takes. */
void fang_sparse_respond(FangSparse *s, const FangGrey *g, EdgesOperator op, double sigma);

/* Of a wanted pixel. */
static inline float fang_sparse_at(const FangSparse *s, uint32_t x, uint32_t y)
{
    const float *block = s->block[(gsize)(y / FANG_BLOCK) * s->across + x / FANG_BLOCK];
    g_assert(block);
    return block[y % FANG_BLOCK * FANG_BLOCK + x % FANG_BLOCK];
}

#endif
