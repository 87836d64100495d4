/* A square of pixels chooses the strokes that may be nearest to one of its pixels: those whose distance to its centre exceeds
 * the least one by no more than the square's diameter. A tile chooses among the strokes of the tiles around it, as far out as there
 * may be such; its quarters choose among those, and so on. Most choices are made between discs around the strokes, which are quick
 * to compare. */
#include "image/nearest.h"

#include <glib.h>
#include <stdbool.h>
#include <string.h>

#include "geom/wide.h"

enum { LEAF = 8 };  /* side of squares that are no longer quartered */

/* Strokes, each as its middle and how far from there it reaches for certain and at most, side by side for vector instructions. */
typedef struct {
    float *x, *y, *inner, *outer; /* pixels */
    float *distance, *most;       /* scratch: how far from the centre of a square they are, at least and at most */
    uint32_t *i;
    uint32_t n, cap;
} List;

/* More than single precision loses on images of the largest size, and then some. */
static const float slack = 0.02f;

/* Half the diagonal of a square of side 1. */
static const float half_diagonal = 0.7072f;

typedef struct {
    uint32_t x, y, side;
} Square;

/* A stroke as lists have it. */
typedef struct {
    float x, y, inner, outer;
} Near;

struct Nearest {
    const Bins *bins;
    Near *near; /* each stroke */
    StrokeFn shape;
    const void *user;
    double limit;
};

static void list_room(List *l, uint32_t n)
{
    if (n <= l->cap)
        return;
    l->cap = MAX(n, 2 * l->cap);
    gsize room = (gsize)l->cap + 1; /* list_filter writes one more than it keeps */
    float **column[] = {&l->x, &l->y, &l->inner, &l->outer, &l->distance, &l->most};
    for (gsize k = 0; k < G_N_ELEMENTS(column); k++)
        *column[k] = g_renew(float, *column[k], room);
    l->i = g_renew(uint32_t, l->i, room);
}

static void list_clear(List *l)
{
    g_free(l->x);
    g_free(l->y);
    g_free(l->inner);
    g_free(l->outer);
    g_free(l->distance);
    g_free(l->most);
    g_free(l->i);
}

Nearest *nearest_new(const Bins *bins, uint32_t n, StrokeFn shape, const void *user, double limit)
{
    Nearest *f = g_new0(Nearest, 1);
    *f = (Nearest){.bins = bins, .shape = shape, .user = user, .limit = limit};
    f->near = g_new(Near, MAX(n, 1));
    for (uint32_t i = 0; i < n; i++) {
        const Capsule *k = shape(i, user);
        Vec2 m = vec_lerp(k->a, k->b, 0.5);
        f->near[i] = (Near){(float)m.x, (float)m.y, (float)(0.5 * (k->ra + k->rb)), (float)(0.5 * k->length + MAX(k->ra, k->rb))};
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

/* Puts into the list's `distance` how far strokes are from x, y at least; returns how far the nearest one is at most. */
WIDE static float list_measure(List *l, float x, float y)
{
    const float *restrict lx = l->x, *restrict ly = l->y, *restrict inner = l->inner, *restrict outer = l->outer;
    float *restrict distance = l->distance, *restrict most = l->most;
    for (uint32_t i = 0; i < l->n; i++) {
        float dx = lx[i] - x, dy = ly[i] - y, d = sqrtf(dx * dx + dy * dy);
        most[i] = d - inner[i];
        distance[i] = d - outer[i];
    }
    /* the least by halves, which is done for many at a time */
    uint32_t n = l->n;
    for (; n > 1; n = (n + 1) / 2) {
        float *restrict other = most + (n + 1) / 2;
        for (uint32_t i = 0; i < n / 2; i++)
            most[i] = other[i] < most[i] ? other[i] : most[i];
    }
    return n > 0 ? most[0] : (float)INFINITY;
}

/* Keeps in `to`, which may be the list itself, what is within `most`. */
static void list_filter(const List *from, float most, List *to)
{
    uint32_t n = 0;
    for (uint32_t k = 0; k < from->n; k++) {
        to->x[n] = from->x[k];
        to->y[n] = from->y[k];
        to->inner[n] = from->inner[k];
        to->outer[n] = from->outer[k];
        to->i[n] = from->i[k];
        n += from->distance[k] <= most;
    }
    to->n = n;
}

/* How far a stroke may be from a square's centre to be worth a look, when the nearest one is no farther than `least` from there. */
static float worth(const Nearest *f, float least, float side)
{
    float reach = half_diagonal * side;
    return MIN(least + 2.0f * reach, (float)f->limit + reach) + slack;
}

/* The same by true distances, worth it for strokes longer than the square. */
static void choose_well(const Nearest *f, const Square *q, List *l)
{
    double half = 0.5 * q->side, reach = 0.7072 * q->side, least = (double)INFINITY, t;
    Vec2 centre = vec2(q->x + half, q->y + half);
    for (uint32_t i = 0; i < l->n; i++) {
        double d = capsule_distance(f->shape(l->i[i], f->user), centre, &t);
        l->distance[i] = (float)d;
        least = MIN(least, d);
    }
    list_filter(l, (float)MIN(least + 2.0 * reach, f->limit + reach) + slack, l);
}

/* Fills `to` with what of `from` a square needs. */
static void choose(const Nearest *f, const Square *q, List *from, List *to)
{
    float half = 0.5f * (float)q->side, spare = 0.0f, least = list_measure(from, (float)q->x + half, (float)q->y + half);
    list_room(to, from->n);
    list_filter(from, worth(f, least, (float)q->side), to);
    for (uint32_t i = 0; i < to->n; i++)
        spare += to->outer[i] - to->inner[i];
    if (to->n > 2 && spare > 0.25f * (float)q->side * (float)to->n)
        choose_well(f, q, to);
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

/* Strokes of one thread: around a tile, and what is chosen for a tile, a quarter of it, and so on. */
enum { LEVELS = 4 };
typedef struct {
    List list[LEVELS];
} Scratch;

static void gather(const Nearest *f, Block k, List *l)
{
    uint32_t n = 0;
    list_room(l, block_count(f->bins, k));
    for (uint32_t y = k.y0; y < k.y1; y++) {
        uint32_t to = f->bins->start[y * f->bins->nx + k.x1];
        for (uint32_t at = f->bins->start[y * f->bins->nx + k.x0]; at < to; at++) {
            bins_ahead(f->bins, at, to, f->near, sizeof *f->near);
            Near s = f->near[l->i[n] = f->bins->item[at]];
            l->x[n] = s.x;
            l->y[n] = s.y;
            l->inner[n] = s.inner;
            l->outer[n++] = s.outer;
        }
    }
    l->n = n;
}

/* Chooses for a tile from all strokes. A stroke beyond k tiles is more than k TILE from the tile, so from its centre half a tile
 * more: once that exceeds what the nearest one allows there is nothing more to find. */
static void choose_tile(const Nearest *f, const Square *q, Scratch *s)
{
    const Bins *b = f->bins;
    uint32_t tx = q->x / TILE, ty = q->y / TILE, k = 0, far = MAX(b->nx, b->ny);
    far = (uint32_t)MIN((double)far, f->limit / TILE + 1.0);
    while (k < far && block_count(b, block_around(b, tx, ty, k)) == 0)
        k = k < 4 ? k + 1 : k + k / 4;
    for (;;) {
        gather(f, block_around(b, tx, ty, k), &s->list[0]);
        float least = list_measure(&s->list[0], (float)q->x + 0.5f * TILE, (float)q->y + 0.5f * TILE);
        float need = MIN(least, (float)f->limit) + 2.0f * half_diagonal * TILE + slack - 0.5f * TILE;
        uint32_t wanted = need > 0.0f ? (uint32_t)(need / TILE) + 1 : 0;
        if (wanted <= k || k >= far) {
            choose(f, q, &s->list[0], &s->list[1]);
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

/* The pixels of a square, quarter by quarter, side by side for vector instructions. */
enum { QUARTER = LEAF * LEAF / 4 };
typedef struct {
    float least[LEAF * LEAF];
    uint32_t which[LEAF * LEAF];
} Leaf;

/* Column and row of each of them. */
#define LOW 0.0f, 1.0f, 2.0f, 3.0f
#define HIGH 4.0f, 5.0f, 6.0f, 7.0f
#define FOUR(v) v, v, v, v
#define LOW_ROWS FOUR(0.0f), FOUR(1.0f), FOUR(2.0f), FOUR(3.0f)
#define HIGH_ROWS FOUR(4.0f), FOUR(5.0f), FOUR(6.0f), FOUR(7.0f)
static const float column[LEAF * LEAF] = {LOW, LOW, LOW, LOW, HIGH, HIGH, HIGH, HIGH, LOW, LOW, LOW, LOW, HIGH, HIGH, HIGH, HIGH};
static const float row[LEAF * LEAF] = {LOW_ROWS, LOW_ROWS, HIGH_ROWS, HIGH_ROWS};

static inline uint32_t place_of(uint32_t u, uint32_t v)
{
    return v / 4 * (2 * QUARTER) + u / 4 * QUARTER + v % 4 * 4 + u % 4;
}

/* capsule_distance for those quarters, a bit each, of the square whose first pixel's centre is at `corner`, without branches: the distance is that to
 * the disc within the stroke whose centre lies across the sides' direction from the pixel, or at an end. Coordinates along and across
 * the stroke start at the corner in double precision, so that those of pixels near it are exact to some 1e-7 of their distance. */
WIDE static void leaf_add(Leaf *restrict b, const Capsule *k, uint32_t i, Vec2 corner, uint32_t quarters)
{
    Vec2 q = vec_sub(corner, k->a);
    float x0 = (float)vec_dot(q, k->d), y0 = (float)vec_cross(k->d, q), dx = (float)k->d.x, dy = (float)k->d.y;
    float s = (float)k->s, lean = (float)(k->s / k->c), ra = (float)k->ra, length = (float)k->length;
    for (uint32_t from = 0, to; quarters >> from != 0; from = to) {
        to = from + 1;
        if ((quarters >> from & 1) == 0)
            continue;
        while ((quarters >> to & 1) != 0)
            to++;
        for (uint32_t p = from * QUARTER; p < to * QUARTER; p++) {
            float x = x0 + row[p] * dy + column[p] * dx, y = fabsf(y0 + row[p] * dx - column[p] * dy), at = x - y * lean;
            at = at > 0.0f ? at : 0.0f;
            at = at < length ? at : length;
            float d = sqrtf((x - at) * (x - at) + y * y) - (ra - s * at), least = b->least[p];
            uint32_t nearer = -(uint32_t)(d < least); /* a mask */
            b->which[p] = (i & nearer) | (b->which[p] & ~nearer);
            b->least[p] = d < least ? d : least;
        }
    }
}

/* Each quarter's pixels from the strokes that may be nearest to one of them. */
static void leaf_fill(const Nearest *f, const Square *q, List *l, Leaf *b, uint8_t *quarters)
{
    float side = 0.5f * LEAF;
    for (uint32_t i = 0; i < LEAF * LEAF; i++) {
        b->least[i] = (float)f->limit;
        b->which[i] = 0xFFFFFFFFu;
    }
    for (uint32_t i = 0; i < l->n; i++)
        quarters[i] = 0;
    for (uint32_t k = 0; k < 4; k++) {
        float least = list_measure(l, (float)q->x + ((float)(k & 1) + 0.5f) * side, (float)q->y + ((float)(k >> 1) + 0.5f) * side);
        float most = worth(f, least, side);
        for (uint32_t i = 0; i < l->n; i++)
            quarters[i] |= (uint8_t)((l->distance[i] <= most) << k);
    }
    for (uint32_t i = 0; i < l->n; i++)
        if (quarters[i] != 0)
            leaf_add(b, f->shape(l->i[i], f->user), l->i[i], vec2(q->x + 0.5, q->y + 0.5), quarters[i]);
}

static void fill_leaf(const Fill *l, const Square *q, List *list, uint8_t *quarters)
{
    const Nearest *f = l->f;
    Leaf b;
    leaf_fill(f, q, list, &b, quarters);
    uint32_t w = MIN(f->bins->width - q->x, (uint32_t)LEAF), h = MIN(l->y1 - q->y, (uint32_t)LEAF);
    for (uint32_t v = 0; v < h; v++)
        for (uint32_t u = 0; u < w; u++) {
            gsize at = (gsize)(q->y - l->y0 + v) * f->bins->width + q->x + u;
            if (l->where != NULL && !(l->where[at] > 0.0f))
                continue;
            l->distance[at] = b.least[place_of(u, v)];
            if (l->which != NULL)
                l->which[at] = b.which[place_of(u, v)];
        }
}

/* From the strokes of list[level]; lists of smaller squares follow. */
static void fill_square(const Fill *l, const Square *q, Scratch *s, uint32_t level)
{
    if (q->side <= LEAF) {
        fill_leaf(l, q, &s->list[level], (uint8_t *)s->list[0].distance);
        return;
    }
    for (uint32_t i = 0; i < 4; i++) {
        uint32_t h = q->side / 2;
        Square part = {q->x + (i & 1) * h, q->y + (i >> 1) * h, h};
        if (!wanted(l, &part))
            continue;
        choose(l->f, &part, &s->list[level], &s->list[level + 1]);
        fill_square(l, &part, s, level + 1);
    }
}

/* What is not wanted stays 0. */
static void clear_tile(const Fill *l, TileBox box)
{
    for (uint32_t y = MAX(box.y0, l->y0); y < MIN(box.y1, l->y1); y++) {
        gsize at = (gsize)(y - l->y0) * l->f->bins->width + box.x0;
        memset(l->distance + at, 0, (box.x1 - box.x0) * sizeof *l->distance);
        if (l->which != NULL)
            memset(l->which + at, 0, (box.x1 - box.x0) * sizeof *l->which);
    }
}

static void fill_tiles(uint32_t first, uint32_t last, void *user)
{
    const Fill *l = user;
    const Bins *b = l->f->bins;
    Scratch s = {0};
    for (uint32_t i = first; i < last; i++) {
        TileBox box = bins_tile(b, l->y0 / TILE * b->nx + i);
        Square q = {box.x0, box.y0, TILE};
        if (l->where != NULL)
            clear_tile(l, box);
        if (!wanted(l, &q))
            continue;
        choose_tile(l->f, &q, &s);
        fill_square(l, &q, &s, 1);
    }
    for (int k = 0; k < LEVELS; k++)
        list_clear(&s.list[k]);
}

void nearest_fill(const Nearest *f, Pool *pool, uint32_t y0, uint32_t y1, const float *where, float *distance, uint32_t *which)
{
    Fill l = {f, y0, y1, where, distance, which};
    pool_for(pool, (y1 - y0 + TILE - 1) / TILE * f->bins->nx, 8, fill_tiles, &l);
}
