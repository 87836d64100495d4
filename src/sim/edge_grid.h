/* Which edges run near a place: a grid of square cells, each with the edges that run through it. */
#ifndef SIM_EDGE_GRID_H
#define SIM_EDGE_GRID_H

#include "geom/vec.h"

typedef struct {
    Vec2 corner;
    double cell; /* side, as long as the mean edge or longer */
    double per_cell; /* 1 / cell */
    uint32_t nx, ny;
    uint32_t *start; /* [nx * ny + 1] into item */
    uint32_t *item;  /* edges, ascending within a cell */
} EdgeGrid;

/* Edges are pairs of nodes. Within `pad` of an edge all cells list it. O(edges + nodes), room for a few times as many entries as there are edges. */
void edge_grid_init(EdgeGrid *g, const Vec2 *node, const uint32_t (*edge)[2], uint32_t n_edges, double pad);
void edge_grid_clear(EdgeGrid *g);

/* Column or row of a coordinate, the nearest one for those beyond the grid. */
uint32_t edge_grid_column(const EdgeGrid *g, double x);
uint32_t edge_grid_row(const EdgeGrid *g, double y);

#endif
