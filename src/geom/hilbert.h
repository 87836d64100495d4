/* Place along Hilbert's curve: points that are near to each other on it are near in the plane, so arrays sorted by it are kind to caches
 * and give boxes that overlap little. */
#ifndef GEOM_HILBERT_H
#define GEOM_HILBERT_H

#include <glib.h>

#include "geom/vec.h"

enum { HILBERT_BITS = 16 }; /* of each coordinate */

/* Maps points of `box` to keys. */
typedef struct {
    Vec2 corner;
    double scale; /* cells per unit, the same along x and y */
} Hilbert;

static inline Hilbert hilbert_over(Box2 box)
{
    double w = box.x1 - box.x0, h = box.y1 - box.y0, side = w > h ? w : h;
    return (Hilbert){vec2(box.x0, box.y0), side > 0.0 ? ((1 << HILBERT_BITS) - 1) / side : 0.0};
}

/* The classic walk from the largest quarter down: each step reads which quarter (x, y) lies in and turns the rest upright. */
static inline uint32_t hilbert_key(Hilbert h, Vec2 p)
{
    const uint32_t all = (1u << HILBERT_BITS) - 1;
    uint32_t x = (uint32_t)((p.x - h.corner.x) * h.scale), y = (uint32_t)((p.y - h.corner.y) * h.scale), key = 0;
    for (uint32_t s = 1u << (HILBERT_BITS - 1); s; s >>= 1) {
        uint32_t right = (x & s) != 0, up = (y & s) != 0;
        key = key * 4 + ((3 * right) ^ up);
        if (!up) {
            uint32_t t = right ? all - x : x;
            x = right ? all - y : y;
            y = t;
        }
    }
    return key;
}

/* For sorting: a point's key, and its number to break ties. */
static inline uint64_t hilbert_place(Hilbert h, Vec2 p, uint32_t number) { return (uint64_t)hilbert_key(h, p) << 32 | number; }

static inline int hilbert_compare(gconstpointer a, gconstpointer b, gpointer unused)
{
    uint64_t p = *(const uint64_t *)a, q = *(const uint64_t *)b;
    return (p > q) - (p < q);
}

#endif
