#include "geom/grid.h"

#include <glib.h>

void grid_init(Grid *g, Box2 field, double cell)
{
    *g = (Grid){.field = field};
    double w = field.x1 - field.x0, h = field.y1 - field.y0, most = w > h ? w : h;
    g->cell = cell > most / 256.0 ? cell : most / 256.0;
    g->nx = (uint32_t)(w / g->cell) + 1;
    g->ny = (uint32_t)(h / g->cell) + 1;
    g->head = g_new(uint32_t, (gsize)g->nx * g->ny);
    grid_reset(g);
}

void grid_clear(Grid *g)
{
    g_free(g->head);
    g_free(g->next);
    *g = (Grid){0};
}

void grid_reset(Grid *g)
{
    for (gsize i = 0; i < grid_cells(g); i++)
        g->head[i] = UINT32_MAX;
    g->n = 0;
}

static uint32_t column(double v, double from, double cell, uint32_t n)
{
    double u = (v - from) / cell;
    return u <= 0.0 ? 0 : u >= (double)n - 1.0 ? n - 1 : (uint32_t)u;
}

uint32_t grid_cell(const Grid *g, Vec2 p)
{
    return column(p.y, g->field.y0, g->cell, g->ny) * g->nx + column(p.x, g->field.x0, g->cell, g->nx);
}

void grid_add(Grid *g, Vec2 p)
{
    if (g->n == g->cap) {
        g->cap = MAX(g->cap * 2, 256);
        g->next = g_renew(uint32_t, g->next, g->cap);
    }
    uint32_t cell = grid_cell(g, p);
    g->next[g->n] = g->head[cell];
    g->head[cell] = g->n++;
}

bool grid_any_within(const Grid *g, const Vec2 *place, Vec2 p, double r)
{
    double r2 = r * r;
    uint32_t x0 = column(p.x - r, g->field.x0, g->cell, g->nx), x1 = column(p.x + r, g->field.x0, g->cell, g->nx);
    uint32_t y0 = column(p.y - r, g->field.y0, g->cell, g->ny), y1 = column(p.y + r, g->field.y0, g->cell, g->ny);
    for (uint32_t y = y0; y <= y1; y++)
        for (uint32_t x = x0; x <= x1; x++)
            for (uint32_t i = g->head[(gsize)y * g->nx + x]; i != UINT32_MAX; i = g->next[i])
                if (vec_dist2(place[i], p) < r2)
                    return true;
    return false;
}
