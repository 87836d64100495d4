/* How well found lines agree with true ones. */
#include <math.h>

#include "scan/found.h"

/* Segments in square cells of side `reach`; cells are hashed into lists. */
typedef struct {
    const Drawing *d;
    double cell;
    uint32_t n, *head; /* [n], n a power of two */
    GArray *item;
} Grid;

typedef struct {
    Vec2 a, b;
    uint32_t next;
} Item;

static uint32_t slot(const Grid *g, int64_t i, int64_t j)
{
    uint64_t h = (uint64_t)i * 0x9E3779B97F4A7C15u ^ (uint64_t)j * 0xC2B2AE3D27D4EB4Fu;
    return (uint32_t)(h >> 32) & (g->n - 1);
}

/* Cut into pieces no longer than a cell, each listed by its middle. */
static void grid_init(Grid *g, const Drawing *d, double reach)
{
    *g = (Grid){d, reach, 1u << 14, NULL, g_array_new(FALSE, FALSE, sizeof(Item))};
    g->head = g_new(uint32_t, g->n);
    for (uint32_t k = 0; k < g->n; k++)
        g->head[k] = UINT32_MAX;
    for (uint32_t v = 0; v < d->n; v++)
        for (uint32_t i = 1; i < d->vein[v].n; i++) {
            Vec2 a = d->vein[v].point[i - 1], b = d->vein[v].point[i];
            uint32_t pieces = (uint32_t)MIN(1e6, ceil(vec_dist(a, b) / reach)) + 1;
            for (uint32_t k = 0; k < pieces; k++) {
                Item it = {vec_lerp(a, b, (double)k / pieces), vec_lerp(a, b, (k + 1.0) / pieces), 0};
                Vec2 m = vec_lerp(it.a, it.b, 0.5);
                uint32_t *head = &g->head[slot(g, (int64_t)floor(m.x / reach), (int64_t)floor(m.y / reach))];
                it.next = *head;
                *head = g->item->len;
                g_array_append_val(g->item, it);
            }
        }
}

static void grid_clear(Grid *g)
{
    g_free(g->head);
    g_array_free(g->item, TRUE);
}

static double segment_dist2(Vec2 a, Vec2 b, Vec2 q)
{
    Vec2 d = vec_sub(b, a);
    double n = vec_norm2(d), t = n > 0.0 ? vec_dot(vec_sub(q, a), d) / n : 0.0;
    return vec_dist2(q, vec_lerp(a, b, CLAMP(t, 0.0, 1.0)));
}

static bool near(const Grid *g, Vec2 q)
{
    int64_t i = (int64_t)floor(q.x / g->cell), j = (int64_t)floor(q.y / g->cell);
    for (int64_t dj = -2; dj <= 2; dj++) /* a piece's middle lies within 1.5 cells of what is near it */
        for (int64_t di = -2; di <= 2; di++)
            for (uint32_t k = g->head[slot(g, i + di, j + dj)]; k != UINT32_MAX; k = g_array_index(g->item, Item, k).next) {
                const Item *it = &g_array_index(g->item, Item, k);
                if (segment_dist2(it->a, it->b, q) <= g->cell * g->cell)
                    return true;
            }
    return false;
}

/* Share of d's length that is near, by points every eighth of the reach. */
static double share(const Drawing *d, const Grid *g)
{
    double length = 0.0, hit = 0.0;
    for (uint32_t v = 0; v < d->n; v++)
        for (uint32_t i = 1; i < d->vein[v].n; i++) {
            Vec2 a = d->vein[v].point[i - 1], b = d->vein[v].point[i];
            double len = vec_dist(a, b);
            uint32_t pieces = (uint32_t)MIN(1e6, ceil(8.0 * len / g->cell)) + 1;
            for (uint32_t k = 0; k < pieces; k++)
                hit += near(g, vec_lerp(a, b, (k + 0.5) / pieces)) ? len / pieces : 0.0;
            length += len;
        }
    return length > 0.0 ? hit / length : 0.0;
}

FoundScore found_score(const Drawing *found, const Drawing *truth, double reach)
{
    Grid f, t;
    grid_init(&f, found, reach);
    grid_init(&t, truth, reach);
    FoundScore s = {share(found, &t), share(truth, &f)};
    grid_clear(&f);
    grid_clear(&t);
    return s;
}
