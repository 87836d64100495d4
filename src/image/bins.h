/* Which strokes reach which tile of an image. */
#ifndef IMAGE_BINS_H
#define IMAGE_BINS_H

#include "image/capsule.h"

enum { TILE = 32 }; /* pixels */

typedef struct {
    uint32_t width, height; /* pixels */
    uint32_t nx, ny;        /* tiles */
    uint32_t *start;        /* [nx * ny + 1] into item */
    uint32_t *item;         /* indices, ascending within a tile */
} Bins;

/* shape(i, user) for i < n gives the area in which stroke i matters. */
void bins_init(Bins *b, uint32_t width, uint32_t height, uint32_t n, Capsule (*shape)(uint32_t i, const void *user),
               const void *user);
void bins_clear(Bins *b);

/* Asks memory for what some turns later comes up of a tile's strokes, items i … to - 1, which lie far apart: `size` bytes each from `at` on. */
static inline void bins_ahead(const Bins *b, uint32_t i, uint32_t to, const void *at, uint32_t size)
{
    enum { AHEAD = 6, LINE = 64 };
    if (to - i <= AHEAD)
        return;
    const char *stroke = (const char *)at + (uint64_t)b->item[i + AHEAD] * size;
    for (uint32_t k = 0; k < size; k += LINE)
        __builtin_prefetch(stroke + k);
}

/* Pixel bounds of a tile. */
typedef struct {
    uint32_t x0, y0, x1, y1;
} TileBox;

TileBox bins_tile(const Bins *b, uint32_t tile);

#endif
