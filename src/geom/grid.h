/* A grid over the sources' places: "is another source nearer than b_s?", and the order in which they lie in memory. */
#ifndef GEOM_GRID_H
#define GEOM_GRID_H

#include "geom/vec.h"

typedef struct {
    Box2 field;
    double cell;
    uint32_t nx, ny;
    uint32_t *head; /* [nx * ny] first item of a cell */
    uint32_t *next; /* [cap] */
    uint32_t n, cap;
} Grid;

/* A grid for items within `field`; cells of about the size `cell` (made larger when there would be too many). */
void grid_init(Grid *g, Box2 field, double cell);
void grid_clear(Grid *g);

/* Empties the grid, keeping its memory. O(cells). */
void grid_reset(Grid *g);

/* Number of the cell that p lies in, row by row from 0 to grid_cells - 1. */
uint32_t grid_cell(const Grid *g, Vec2 p);
static inline uint32_t grid_cells(const Grid *g) { return g->nx * g->ny; }

/* Adds item number g->n (items are numbered as they are added) at place p. */
void grid_add(Grid *g, Vec2 p);

/* Whether an item lies nearer to p than r; place[i] is where item i lies. */
bool grid_any_within(const Grid *g, const Vec2 *place, Vec2 p, double r);

/* A box in single precision, which halves the memory walked; rounding outward by a few ulps keeps it a superset. */
typedef struct {
    float x0, y0, x1, y1;
} ZoneBox;

static inline ZoneBox zone_box(Box2 b)
{
    const double up = 1.0 + 0x1p-22, down = 1.0 - 0x1p-22;
    return (ZoneBox){(float)(b.x0 * (b.x0 > 0 ? down : up)), (float)(b.y0 * (b.y0 > 0 ? down : up)),
                     (float)(b.x1 * (b.x1 > 0 ? up : down)), (float)(b.y1 * (b.y1 > 0 ? up : down))};
}

static inline Box2 zone_as_box(ZoneBox b) { return (Box2){(double)b.x0, (double)b.y0, (double)b.x1, (double)b.y1}; }
static inline ZoneBox zone_empty(void) { return (ZoneBox){HUGE_VALF, HUGE_VALF, -HUGE_VALF, -HUGE_VALF}; }

static inline ZoneBox zone_join(ZoneBox a, ZoneBox b)
{
    return (ZoneBox){a.x0 < b.x0 ? a.x0 : b.x0, a.y0 < b.y0 ? a.y0 : b.y0, a.x1 > b.x1 ? a.x1 : b.x1, a.y1 > b.y1 ? a.y1 : b.y1};
}

#endif
