/* A square of pixels chooses the strokes that may be nearest to one of its pixels: those whose distance to its centre exceeds
 * the least one by no more than the square's diameter. A tile chooses among the strokes of the tiles around it, as far out as there
 * may be such; its quarters choose among those, and so on. Most choices are made between discs around the strokes, which are quick
 * to compare. */
#include "image/nearest.h"

#include <glib.h>
#include <stdbool.h>

enum { LEAF = 8 }; /* side of squares that are no longer quartered */

/* A stroke as its middle, and how far from there it reaches for certain and at most. */
typedef struct {
    float x, y, inner, outer; /* pixels */
    uint32_t i;
} Near;

/* More than single precision loses on images of the largest size, and then some. */
static const float slack = 0.02f;

/* Half the diagonal of a square of side 1. */
static const float half_diagonal = 0.7072f;

typedef struct {
    uint32_t x, y, side;
    Near *item;
    uint32_t n;
} Square;

struct Nearest {
    const Bins *bins;
    Near *near; /* of each stroke */
    StrokeFn shape;
    const void *user;
    double limit;
};

Nearest *nearest_new(const Bins *bins, uint32_t n, StrokeFn shape, const void *user, double limit)
{
    Nearest *f = g_new(Nearest, 1);
    *f = (Nearest){bins, g_new(Near, n + 1), shape, user, limit};
    for (uint32_t i = 0; i < n; i++) {
        const Capsule *k = shape(i, user);
        Vec2 m = vec_lerp(k->a, k->b, 0.5);
        f->near[i] = (Near){(float)m.x, (float)m.y, (float)(0.5 * (k->ra + k->rb)),
                            (float)(0.5 * k->length + MAX(k->ra, k->rb)), i};
    }
    return f;
}

void nearest_free(Nearest *f)
{
    if (f == NULL)
        return;
    g_free(f->near);
    g_free(f);
}

/* ---- choices ---- */

/* Fills q->item from `from`; `distance` has room for n numbers. */
static void choose_rough(const Nearest *f, Square *q, const Near *from, uint32_t n, float *distance)
{
    float half = 0.5f * (float)q->side, reach = half_diagonal * (float)q->side, least = (float)INFINITY;
    float x = (float)q->x + half, y = (float)q->y + half;
    for (uint32_t i = 0; i < n; i++) {
        float dx = from[i].x - x, dy = from[i].y - y, d = sqrtf(dx * dx + dy * dy);
        least = MIN(least, d - from[i].inner);
        distance[i] = d - from[i].outer;
    }
    float most = MIN(least + 2.0f * reach, (float)f->limit + reach) + slack;
    q->n = 0;
    for (uint32_t i = 0; i < n; i++)
        if (distance[i] <= most)
            q->item[q->n++] = from[i];
}

/* The same by true distances, worth it for strokes longer than the square. */
static void choose_well(const Nearest *f, Square *q, float *distance)
{
    double half = 0.5 * q->side, reach = 0.7072 * q->side, least = (double)INFINITY, t;
    Vec2 centre = vec2(q->x + half, q->y + half);
    for (uint32_t i = 0; i < q->n; i++) {
        double d = capsule_distance(f->shape(q->item[i].i, f->user), centre, &t);
        distance[i] = (float)d;
        least = MIN(least, d);
    }
    float most = (float)MIN(least + 2.0 * reach, f->limit + reach) + slack;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < q->n; i++)
        if (distance[i] <= most)
            q->item[kept++] = q->item[i];
    q->n = kept;
}

static void choose(const Nearest *f, Square *q, const Near *from, uint32_t n, float *distance)
{
    choose_rough(f, q, from, n, distance);
    float spare = 0.0f;
    for (uint32_t i = 0; i < q->n; i++)
        spare += q->item[i].outer - q->item[i].inner;
    if (q->n > 2 && spare > 0.25f * (float)q->side * (float)q->n)
        choose_well(f, q, distance);
}

/* The strokes of the tiles up to k tiles away from tile tx, ty. In a row of tiles they follow one another. */
typedef struct {
    uint32_t x0, x1, y0, y1; /* tiles */
} Block;

static Block block_around(const Bins *b, uint32_t tx, uint32_t ty, uint32_t k)
{
    return (Block){tx > k ? tx - k : 0, MIN(b->nx, tx + k + 1), ty > k ? ty - k : 0, MIN(b->ny, ty + k + 1)};
}

static uint32_t block_count(const Bins *b, Block k)
{
    uint32_t n = 0;
    for (uint32_t y = k.y0; y < k.y1; y++)
        n += b->start[y * b->nx + k.x1] - b->start[y * b->nx + k.x0];
    return n;
}

/* Scratch of one thread. */
typedef struct {
    Near *item;
    float *distance;
    uint32_t cap;
} Scratch;

static uint32_t gather(const Nearest *f, Block k, Scratch *s)
{
    uint32_t n = 0, count = block_count(f->bins, k);
    if (count > s->cap) {
        s->cap = 2 * count;
        s->item = g_renew(Near, s->item, s->cap);
        s->distance = g_renew(float, s->distance, s->cap);
    }
    for (uint32_t y = k.y0; y < k.y1; y++)
        for (uint32_t i = f->bins->start[y * f->bins->nx + k.x0]; i < f->bins->start[y * f->bins->nx + k.x1]; i++)
            s->item[n++] = f->near[f->bins->item[i]];
    return n;
}

/* Chooses for a tile from all strokes. A stroke beyond k tiles is more than k TILE from the tile, so from its centre half a tile
 * more: once that exceeds what the nearest one allows there is nothing more to find. */
static void choose_tile(const Nearest *f, Square *q, Scratch *s)
{
    const Bins *b = f->bins;
    uint32_t tx = q->x / TILE, ty = q->y / TILE, k = 0, far = MAX(b->nx, b->ny);
    far = (uint32_t)MIN((double)far, f->limit / TILE + 1.0);
    while (k < far && block_count(b, block_around(b, tx, ty, k)) == 0)
        k = k < 4 ? k + 1 : k + k / 4;
    q->item = s->item;
    for (q->n = 0;;) {
        uint32_t n = gather(f, block_around(b, tx, ty, k), s);
        float x = (float)q->x + 0.5f * TILE, y = (float)q->y + 0.5f * TILE, least = (float)f->limit;
        for (uint32_t i = 0; i < n; i++) {
            float dx = s->item[i].x - x, dy = s->item[i].y - y;
            least = MIN(least, sqrtf(dx * dx + dy * dy) - s->item[i].inner);
        }
        float need = least + 2.0f * half_diagonal * TILE + slack - 0.5f * TILE;
        uint32_t wanted = need > 0.0f ? (uint32_t)(need / TILE) + 1 : 0;
        q->item = s->item;
        if (wanted <= k || k >= far) {
            choose(f, q, s->item, n, s->distance);
            return;
        }
        k = MIN(wanted, far);
    }
}

/* ---- pixels ---- */

/* What nearest_fill works on. */
typedef struct {
    const Nearest *f;
    uint32_t y0, y1;
    const float *where;
    float *distance;
    uint32_t *which;
} Fill;

/* Is there a pixel to fill in the square? */
static bool wanted(const Fill *l, const Square *q)
{
    uint32_t x1 = MIN(q->x + q->side, l->f->bins->width), y0 = MAX(q->y, l->y0), y1 = MIN(q->y + q->side, l->y1);
    if (q->x >= x1 || y0 >= y1 || l->where == NULL)
        return q->x < x1 && y0 < y1;
    for (uint32_t y = y0; y < y1; y++)
        for (uint32_t x = q->x; x < x1; x++)
            if (l->where[(gsize)(y - l->y0) * l->f->bins->width + x] > 0.0f)
                return true;
    return false;
}

/* The pixels of a square, side by side for vector instructions. */
typedef struct {
    float least[LEAF * LEAF];
    uint32_t which[LEAF * LEAF];
} Leaf;

/* capsule_distance for all pixels of the square whose first pixel's centre is at `corner`, without branches: the distance is that to
 * the disc within the stroke whose centre lies across the sides' direction from the pixel, or at an end. Coordinates along and across
 * the stroke start at the corner in double precision, so that those of pixels near it are exact to some 1e-7 of their distance. */
static void leaf_add(Leaf *b, const Capsule *k, uint32_t i, Vec2 corner)
{
    Vec2 q = vec_sub(corner, k->a);
    float x0 = (float)vec_dot(q, k->d), y0 = (float)vec_cross(k->d, q), dx = (float)k->d.x, dy = (float)k->d.y;
    float s = (float)k->s, lean = (float)(k->s / k->c), ra = (float)k->ra, length = (float)k->length;
    for (uint32_t v = 0; v < LEAF; v++) {
        float xv = x0 + (float)v * dy, yv = y0 + (float)v * dx, d[LEAF];
        for (int u = 0; u < LEAF; u++) {
            float x = xv + (float)u * dx, y = fabsf(yv - (float)u * dy), at = x - y * lean;
            at = at > 0.0f ? at : 0.0f;
            at = at < length ? at : length;
            d[u] = sqrtf((x - at) * (x - at) + y * y) - (ra - s * at);
        }
        float *least = b->least + v * LEAF;
        uint32_t *which = b->which + v * LEAF;
        for (int u = 0; u < LEAF; u++) {
            uint32_t nearer = -(uint32_t)(d[u] < least[u]); /* a mask */
            which[u] = (i & nearer) | (which[u] & ~nearer);
            least[u] = d[u] < least[u] ? d[u] : least[u];
        }
    }
}

static void fill_leaf(const Fill *l, uint32_t x0, uint32_t y0, const Near *item, uint32_t n)
{
    const Nearest *f = l->f;
    Leaf b;
    for (uint32_t i = 0; i < LEAF * LEAF; i++) {
        b.least[i] = (float)f->limit;
        b.which[i] = 0xFFFFFFFFu;
    }
    for (uint32_t i = 0; i < n; i++)
        leaf_add(&b, f->shape(item[i].i, f->user), item[i].i, vec2(x0 + 0.5, y0 + 0.5));
    uint32_t w = MIN(f->bins->width - x0, (uint32_t)LEAF), h = MIN(l->y1 - y0, (uint32_t)LEAF);
    for (uint32_t v = 0; v < h; v++)
        for (uint32_t u = 0; u < w; u++) {
            gsize at = (gsize)(y0 - l->y0 + v) * f->bins->width + x0 + u;
            if (l->where != NULL && !(l->where[at] > 0.0f))
                continue;
            l->distance[at] = b.least[v * LEAF + u];
            if (l->which != NULL)
                l->which[at] = b.which[v * LEAF + u];
        }
}

/* `distance` has room for as many numbers as the list of q: the lists of smaller squares are no longer. */
static void fill_square(const Fill *l, const Square *q, float *distance)
{
    if (q->side <= LEAF) {
        fill_leaf(l, q->x, q->y, q->item, q->n);
        return;
    }
    Near *item = g_new(Near, q->n + 1);
    for (uint32_t i = 0; i < 4; i++) {
        uint32_t h = q->side / 2;
        Square part = {q->x + (i & 1) * h, q->y + (i >> 1) * h, h, item, 0};
        if (!wanted(l, &part))
            continue;
        choose(l->f, &part, q->item, q->n, distance);
        fill_square(l, &part, distance);
    }
    g_free(item);
}

static void fill_tiles(uint32_t first, uint32_t last, void *user)
{
    const Fill *l = user;
    const Bins *b = l->f->bins;
    Scratch s = {0};
    for (uint32_t i = first; i < last; i++) {
        TileBox box = bins_tile(b, l->y0 / TILE * b->nx + i);
        Square q = {box.x0, box.y0, TILE, NULL, 0};
        if (!wanted(l, &q))
            continue;
        choose_tile(l->f, &q, &s);
        fill_square(l, &q, s.distance);
    }
    g_free(s.item);
    g_free(s.distance);
}

void nearest_fill(const Nearest *f, Pool *pool, uint32_t y0, uint32_t y1, const float *where, float *distance, uint32_t *which)
{
    Fill l = {f, y0, y1, where, distance, which};
    pool_for(pool, (y1 - y0 + TILE - 1) / TILE * f->bins->nx, 8, fill_tiles, &l);
}
