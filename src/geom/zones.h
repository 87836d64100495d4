/* Index of the sources' zones: which sources may a set of new nodes concern? A grid over the sources' places with a pyramid of
 * bounding boxes of their zones above it. The same grid answers "is another source nearer than b_s?". */
#ifndef GEOM_ZONES_H
#define GEOM_ZONES_H

#include "geom/boxtree.h"

typedef struct {
    float x0, y0, x1, y1; /* rounded outward */
} ZoneBox;

typedef struct {
    Box2 field;
    double cell;
    uint32_t levels; /* level 0 is the grid of cells, each next one halves it, the last is one box */
    uint32_t nx[16], ny[16];
    ZoneBox *box[16];
    uint32_t *head; /* [nx[0] * ny[0]] first item of a cell */
    uint32_t *next; /* [cap] */
    ZoneBox *zone;  /* [cap] */
    uint32_t n, cap;
} Zones;

/* An index for items within `field`; cells of about the size `cell` (made larger when there would be too many). */
void zones_init(Zones *z, Box2 field, double cell);
void zones_clear(Zones *z);

/* Empties the index, keeping its memory. O(cells). */
void zones_reset(Zones *z);

/* Number of the cell that p lies in, from 0 to zones_cells - 1. */
uint32_t zones_cell(const Zones *z, Vec2 p);
static inline uint32_t zones_cells(const Zones *z) { return z->nx[0] * z->ny[0]; }

/* Adds item number z->n (items are numbered as they are added) at place p. */
void zones_add(Zones *z, Vec2 p, Box2 zone);

/* Gives an item another zone. The boxes above it stay what they are until zones_raise or, if the zone has grown, zones_lift. */
void zones_set(Zones *z, uint32_t item, Box2 zone);

/* Widens the boxes above the item, which lies at p, to hold its zone. */
void zones_lift(Zones *z, uint32_t item, Vec2 p);

/* Recomputes all boxes from the items' zones. O(items + cells). */
void zones_raise(Zones *z);

/* The item's zone, rounded outward. */
static inline Box2 zones_get(const Zones *z, uint32_t item)
{
    ZoneBox b = z->zone[item];
    return (Box2){(double)b.x0, (double)b.y0, (double)b.x1, (double)b.y1};
}

/* Writes to `out` the squares of a level whose box may hold one of the points, numbered row by row; returns how many. A square of level l
 * has 2^l cells a side. */
uint32_t zones_visit(const Zones *z, uint32_t level, const Boxtree *points, const Vec2 *pos, uint32_t *out);

/* Whether an item lies nearer to p than r; place[i] is where item i lies. */
bool zones_any_within(const Zones *z, const Vec2 *place, Vec2 p, double r);

#endif
