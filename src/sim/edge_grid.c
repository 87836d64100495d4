#include "sim/edge_grid.h"

#include <glib.h>

static inline uint32_t index_of(double v, double from, double per_cell, uint32_t n)
{
    double i = (v - from) * per_cell;
    return i > 0.0 ? (uint32_t)MIN(i, (double)n - 1.0) : 0;
}

static inline uint32_t column_of(const EdgeGrid *g, double x) { return index_of(x, g->corner.x, g->per_cell, g->nx); }
static inline uint32_t row_of(const EdgeGrid *g, double y) { return index_of(y, g->corner.y, g->per_cell, g->ny); }

uint32_t edge_grid_column(const EdgeGrid *g, double x) { return column_of(g, x); }
uint32_t edge_grid_row(const EdgeGrid *g, double y) { return row_of(g, y); }

static void lay_out(EdgeGrid *g, const Vec2 *node, const uint32_t (*edge)[2], uint32_t n, double pad)
{
    Box2 box = box_empty();
    double length = 0.0;
    for (uint32_t e = 0; e < n; e++) {
        box = box_add(box_add(box, node[edge[e][0]]), node[edge[e][1]]);
        length += vec_dist(node[edge[e][0]], node[edge[e][1]]);
    }
    if (n == 0)
        box = (Box2){0.0, 0.0, 0.0, 0.0};
    box = box_grow(box, pad);
    double w = box.x1 - box.x0, h = box.y1 - box.y0, most = 2.0 * n + 16.0;
    /* cells of the mean length take about as many entries as edges; no more cells than `most` */
    g->cell = MAX(MAX(n > 0 ? length / n : 1.0, sqrt(w * h / most)), MAX(MAX(w, h) / most, 1e-300));
    g->per_cell = MIN(1.0 / g->cell, 1e300);
    g->corner = vec2(box.x0, box.y0);
    g->nx = (uint32_t)(w / g->cell) + 1;
    g->ny = (uint32_t)(h / g->cell) + 1;
}

/* Columns [*x0, *x1] of the part of ab that lies in a row. */
static void columns_in_row(const EdgeGrid *g, Vec2 a, Vec2 b, uint32_t row, double pad, uint32_t *x0, uint32_t *x1)
{
    double low = g->corner.y + row * g->cell - pad, high = low + g->cell + 2.0 * pad, left = MIN(a.x, b.x), right = MAX(a.x, b.x);
    if (a.y != b.y) {
        double k = (b.x - a.x) / (b.y - a.y), p = a.x + (CLAMP(low, MIN(a.y, b.y), MAX(a.y, b.y)) - a.y) * k;
        double q = a.x + (CLAMP(high, MIN(a.y, b.y), MAX(a.y, b.y)) - a.y) * k;
        left = MAX(left, MIN(p, q));
        right = MIN(right, MAX(p, q));
    }
    *x0 = column_of(g, left - pad);
    *x1 = column_of(g, right + pad);
}

/* Counts an edge in each of its cells, or enters it there. */
static void enter(EdgeGrid *g, Vec2 a, Vec2 b, uint32_t edge, double pad, bool fill)
{
    uint32_t y0 = row_of(g, MIN(a.y, b.y) - pad), y1 = row_of(g, MAX(a.y, b.y) + pad);
    uint32_t left = column_of(g, MIN(a.x, b.x) - pad), right = column_of(g, MAX(a.x, b.x) + pad);
    for (uint32_t y = y0; y <= y1; y++) {
        uint32_t x0 = left, x1 = right;
        if (y0 < y1 && left < right)
            columns_in_row(g, a, b, y, pad, &x0, &x1);
        for (uint32_t x = x0; x <= x1; x++) {
            uint32_t *at = &g->start[(gsize)y * g->nx + x];
            if (fill)
                g->item[--*at] = edge;
            else
                ++*at;
        }
    }
}

void edge_grid_init(EdgeGrid *g, const Vec2 *node, const uint32_t (*edge)[2], uint32_t n, double pad)
{
    lay_out(g, node, edge, n, pad);
    gsize cells = (gsize)g->nx * g->ny;
    pad += 1e-9 * g->cell; /* for rounding */
    g->start = g_new0(uint32_t, cells + 1);
    for (uint32_t e = 0; e < n; e++)
        enter(g, node[edge[e][0]], node[edge[e][1]], e, pad, false);
    for (gsize i = 0; i < cells; i++)
        g->start[i + 1] += g->start[i];
    g->item = g_new(uint32_t, g->start[cells]);
    for (uint32_t e = n; e-- > 0;)
        enter(g, node[edge[e][0]], node[edge[e][1]], e, pad, true);
}

void edge_grid_clear(EdgeGrid *g)
{
    g_free(g->start);
    g_free(g->item);
}
