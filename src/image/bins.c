#include "image/bins.h"

#include <glib.h>

#include "image/pixels.h"

TileBox bins_tile(const Bins *b, uint32_t tile)
{
    uint32_t x = tile % b->nx * TILE, y = tile / b->nx * TILE;
    return (TileBox){x, y, MIN(x + TILE, b->width), MIN(y + TILE, b->height)};
}

/* Counts (item NULL) or lists stroke i in the tiles it touches. */
static void enter(Bins *b, const Capsule *k, uint32_t i)
{
    Box2 box = capsule_box(k);
    uint32_t x0, x1, y0, y1;
    pixels_touched((Span){box.x0 / TILE, box.x1 / TILE}, 0, b->nx, &x0, &x1);
    pixels_touched((Span){box.y0 / TILE, box.y1 / TILE}, 0, b->ny, &y0, &y1);
    for (uint32_t y = y0; y < y1; y++) {
        uint32_t from = x0, to = x1;
        if (x1 - x0 > 1 && y1 - y0 > 1) {
            double top = (double)y * TILE, bottom = top + TILE;
            Span s = capsule_reach(k, top, bottom, capsule_chord(k, top), capsule_chord(k, bottom));
            pixels_touched((Span){s.lo / TILE, s.hi / TILE}, x0, x1, &from, &to);
        }
        for (uint32_t x = from; x < to; x++) {
            uint32_t tile = y * b->nx + x;
            if (b->item == NULL)
                b->start[tile + 1]++;
            else
                b->item[b->start[tile]++] = i;
        }
    }
}

void bins_init(Bins *b, uint32_t width, uint32_t height, uint32_t n, Capsule (*shape)(uint32_t i, const void *user),
               const void *user)
{
    *b = (Bins){.width = width, .height = height, .nx = (width + TILE - 1) / TILE, .ny = (height + TILE - 1) / TILE};
    uint32_t tiles = b->nx * b->ny;
    b->start = g_new0(uint32_t, tiles + 1);
    for (uint32_t i = 0; i < n; i++) {
        Capsule k = shape(i, user);
        enter(b, &k, i);
    }
    for (uint32_t t = 0; t < tiles; t++)
        b->start[t + 1] += b->start[t];
    b->item = g_new(uint32_t, b->start[tiles] + 1);
    for (uint32_t i = 0; i < n; i++) {
        Capsule k = shape(i, user);
        enter(b, &k, i);
    }
    for (uint32_t t = tiles; t > 0; t--) /* filling moved each start to its end */
        b->start[t] = b->start[t - 1];
    b->start[0] = 0;
}

void bins_clear(Bins *b)
{
    g_free(b->start);
    g_free(b->item);
}
