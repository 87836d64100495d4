#include "scan/fang_tiles.h"

#include <math.h>

/* Side of a tile's core, pixels: what is looked at twice, around it, stays below a fifth for small reaches, and below one and a quarter for any. */
enum { SIDE = 512, REACHES = 4 };

static float grey_of(const Scan *s, uint32_t value) { return (float)(value * (s->depth == 8 ? 1.0 : 1.0 / 257.0)); }

FangGrey fang_grey(const Scan *s, Channel channel, MaskBox box)
{
    return (FangGrey){s, channel, box, box.x1 - box.x0 + 1, box.y1 - box.y0 + 1};
}

void fang_grey_range(const FangGrey *g, double *least, double *most)
{
    uint32_t low = UINT32_MAX, high = 0;
    for (uint32_t y = g->box.y0; y <= g->box.y1; y++)
        for (uint32_t x = g->box.x0; x <= g->box.x1; x++) {
            uint32_t v = channel_value(g->scan, g->channel, x, y);
            low = MIN(low, v);
            high = MAX(high, v);
        }
    *least = (double)grey_of(g->scan, low);
    *most = (double)grey_of(g->scan, high);
}

/* Of whole blocks, so that no block lies in two tiles. */
static uint32_t tile_side(uint32_t reach)
{
    uint32_t side = MAX((uint32_t)SIDE, REACHES * reach);
    return (side + FANG_BLOCK - 1) / FANG_BLOCK * FANG_BLOCK;
}

static uint32_t tiles_along(uint32_t length, uint32_t reach) { return (length - 1) / tile_side(reach) + 1; }

uint32_t fang_tile_count(const FangGrey *g, uint32_t reach) { return tiles_along(g->width, reach) * tiles_along(g->height, reach); }

FangTile fang_tile(const FangGrey *g, uint32_t reach, uint32_t k)
{
    uint32_t across = tiles_along(g->width, reach), side = tile_side(reach), x = k % across * side, y = k / across * side;
    MaskBox core = {x, y, MIN(side, g->width - x) + x - 1, MIN(side, g->height - y) + y - 1};
    MaskBox all = {x - MIN(x, reach), y - MIN(y, reach), core.x1 + MIN(g->width - 1 - core.x1, reach), core.y1 + MIN(g->height - 1 - core.y1, reach)};
    return (FangTile){core, all};
}

GreyImage *fang_tile_grey(const FangGrey *g, const FangTile *t)
{
    GreyImage *out = grey_image_new(t->all.x1 - t->all.x0 + 1, t->all.y1 - t->all.y0 + 1);
    uint32_t x0 = g->box.x0 + t->all.x0, y0 = g->box.y0 + t->all.y0;
    for (uint32_t y = 0; y < out->height; y++)
        for (uint32_t x = 0; x < out->width; x++)
            out->px[(gsize)y * out->width + x] = grey_of(g->scan, channel_value(g->scan, g->channel, x0 + x, y0 + y));
    return out;
}

/* --- wanted here and there --- */

FangSparse *fang_sparse_new(uint32_t width, uint32_t height)
{
    FangSparse *s = g_new0(FangSparse, 1);
    uint32_t across = (width - 1) / FANG_BLOCK + 1, down = (height - 1) / FANG_BLOCK + 1;
    *s = (FangSparse){width, height, across, g_new0(float *, (gsize)across * down)};
    return s;
}

void fang_sparse_free(FangSparse *s)
{
    if (!s)
        return;
    gsize n = (gsize)s->across * ((s->height - 1) / FANG_BLOCK + 1);
    for (gsize i = 0; i < n; i++)
        g_free(s->block[i]);
    g_free(s->block);
    g_free(s);
}

void fang_sparse_want(FangSparse *s, uint32_t x, uint32_t y)
{
    float **block = &s->block[(gsize)(y / FANG_BLOCK) * s->across + x / FANG_BLOCK];
    if (!*block)
        *block = g_new0(float, FANG_BLOCK * FANG_BLOCK);
}

void fang_sparse_want_around(FangSparse *s, double x, double y, double r)
{
    double right = s->width - 1.0, bottom = s->height - 1.0;
    uint32_t x0 = (uint32_t)CLAMP(x - r, 0.0, right), x1 = (uint32_t)CLAMP(x + r, 0.0, right);
    uint32_t y0 = (uint32_t)CLAMP(y - r, 0.0, bottom), y1 = (uint32_t)CLAMP(y + r, 0.0, bottom);
    for (uint32_t j = y0 / FANG_BLOCK; j <= y1 / FANG_BLOCK; j++)
        for (uint32_t i = x0 / FANG_BLOCK; i <= x1 / FANG_BLOCK; i++)
            fang_sparse_want(s, i * FANG_BLOCK, j * FANG_BLOCK);
}

static bool any_wanted(const FangSparse *s, const MaskBox *b)
{
    for (uint32_t j = b->y0 / FANG_BLOCK; j <= b->y1 / FANG_BLOCK; j++)
        for (uint32_t i = b->x0 / FANG_BLOCK; i <= b->x1 / FANG_BLOCK; i++)
            if (s->block[(gsize)j * s->across + i])
                return true;
    return false;
}

static void keep_wanted(FangSparse *s, const GreyImage *filtered, const FangTile *t)
{
    for (uint32_t y = t->core.y0; y <= t->core.y1; y++)
        for (uint32_t x = t->core.x0; x <= t->core.x1; x++) {
            float *block = s->block[(gsize)(y / FANG_BLOCK) * s->across + x / FANG_BLOCK];
            if (block)
                block[y % FANG_BLOCK * FANG_BLOCK + x % FANG_BLOCK] = fang_tile_at(filtered, t, x, y);
        }
}

void fang_sparse_fill(FangSparse *s, const FangGrey *g, uint32_t reach, FangFilter filter, const void *user)
{
    g_assert(s->width == g->width && s->height == g->height);
    for (uint32_t k = 0; k < fang_tile_count(g, reach); k++) {
        FangTile t = fang_tile(g, reach, k);
        if (!any_wanted(s, &t.core))
            continue;
        GreyImage *grey = fang_tile_grey(g, &t), *filtered = filter(grey, user);
        grey_image_free(grey);
        keep_wanted(s, filtered, &t);
        grey_image_free(filtered);
    }
}

typedef struct {
    EdgesOperator op;
    double sigma;
} Operator;

static GreyImage *respond(const GreyImage *in, const void *user)
{
    const Operator *o = user;
    GreyImage *out = edges_response(in, o->op, o->sigma, NULL);
    g_assert(out);
    return out;
}

void fang_sparse_respond(FangSparse *s, const FangGrey *g, EdgesOperator op, double sigma)
{
    Operator o = {op, sigma};
    fang_sparse_fill(s, g, edges_reach(op, sigma), respond, &o);
}
