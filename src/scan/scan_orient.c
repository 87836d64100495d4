/* Turning an image upright, as Exif and TIFF number the ways it can lie (TIFF 6.0, Orientation). */
#include <string.h>

#include "scan/scan_file.h"

enum { TILE = 64 };

static gsize pixel_bytes(const Scan *s) { return (gsize)s->channels * s->depth / 8; }

static void mirror_rows(Scan *s)
{
    gsize k = pixel_bytes(s);
    for (uint32_t y = 0; y < s->height; y++) {
        uint8_t *a = (uint8_t *)s->px + (gsize)y * s->width * k, *b = a + ((gsize)s->width - 1) * k, hold[8];
        for (; a < b; a += k, b -= k) {
            memcpy(hold, a, k);
            memcpy(a, b, k);
            memcpy(b, hold, k);
        }
    }
}

static void swap_bytes(uint8_t *a, uint8_t *b, gsize n)
{
    uint8_t hold[4096];
    for (gsize i = 0, part; i < n; i += part) {
        part = MIN(n - i, sizeof hold);
        memcpy(hold, a + i, part);
        memcpy(a + i, b + i, part);
        memcpy(b + i, hold, part);
    }
}

static void turn_upside_down(Scan *s)
{
    gsize row = (gsize)s->width * pixel_bytes(s);
    uint8_t *px = s->px;
    for (uint32_t y = 0; y < s->height / 2; y++)
        swap_bytes(px + (gsize)y * row, px + (gsize)(s->height - 1 - y) * row, row);
}

/* Rows become columns; in tiles, so that both sides stay in the cache. */
static bool transpose(Scan *s)
{
    Scan *t = scan_new(s->height, s->width, s->channels, s->depth);
    if (!t)
        return false;
    gsize k = pixel_bytes(s);
    for (uint32_t y0 = 0; y0 < s->height; y0 += TILE) {
        for (uint32_t x0 = 0; x0 < s->width; x0 += TILE) {
            uint32_t y1 = MIN(s->height - y0, TILE) + y0, x1 = MIN(s->width - x0, TILE) + x0;
            for (uint32_t x = x0; x < x1; x++)
                for (uint32_t y = y0; y < y1; y++)
                    memcpy((uint8_t *)t->px + ((gsize)x * t->width + y) * k, (uint8_t *)s->px + ((gsize)y * s->width + x) * k, k);
        }
    }
    g_free(s->px);
    *s = *t;
    g_free(t);
    return true;
}

bool scan_orient(Scan *s, unsigned orientation)
{
    if (orientation < 2 || orientation > 8)
        return true;
    if (orientation >= 5) { /* 5 … 8 are 1 … 4 with rows for columns */
        if (!transpose(s))
            return false;
        orientation -= 4;
    }
    if (orientation == 2 || orientation == 3)
        mirror_rows(s);
    if (orientation == 3 || orientation == 4)
        turn_upside_down(s);
    return true;
}
