#include "scan/fang_map.h"

enum { WEAK = MASK_WORK, STRONG = MASK_HOLE };

static void mark_responses(const FangGrey *grey, const EdgesDef *used, const Mask *m)
{
    uint32_t reach = edges_reach(used->op, used->sigma);
    for (uint32_t k = 0; k < fang_tile_count(grey, reach); k++) {
        FangTile t = fang_tile(grey, reach, k);
        GreyImage *in = fang_tile_grey(grey, &t), *response = edges_response(in, used->op, used->sigma, NULL);
        g_assert(response);
        for (uint32_t y = t.core.y0; y <= t.core.y1; y++)
            for (uint32_t x = t.core.x0; x <= t.core.x1; x++) {
                double r = (double)fang_tile_at(response, &t, x, y);
                *mask_at(m, x, y) |= (uint8_t)((r > used->low ? WEAK : 0) | (r > used->high ? STRONG : 0));
            }
        grey_image_free(in);
        grey_image_free(response);
    }
}

/* Weak ones that hang together with strong ones are edges. */
static void flood(const Mask *m)
{
    static const Flood edge = {WEAK | MASK_SEEN, WEAK, MASK_SEEN, true};
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++)
            if ((*mask_at(m, x, y) & (STRONG | MASK_SEEN)) == STRONG)
                mask_flood(m, &edge, x, y, NULL);
}

void fang_mark_edges(const FangGrey *grey, const EdgesDef *used, const Mask *m)
{
    mark_responses(grey, used, m);
    flood(m);
    mask_clear(m, WEAK | STRONG);
    if (used->op == EDGES_CANNY)
        edges_thin(m, MASK_SEEN);
}
