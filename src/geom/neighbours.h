/* Which vein nodes an auxin source s influences: relative neighbourhood (Runions 2005, eq. 2; Toussaint 1980) and Urquhart's
 * approximation (Urquhart 1980), kept up to date as nodes come.
 *
 * A node u excludes v from the neighbourhood of s when u is nearer to s than v is and v is not nearer to s than to u. Eq. 2 leaves both of
 * two equally near nodes out; here the one with the smaller index counts as nearer, so that a source always has a neighbour.
 * Any two neighbours are seen from s more than 60° apart, so there are at most five.
 *
 * Points never move and never go (where they do, the neighbourhood is found anew), so a node once excluded stays excluded and an
 * update looks at new nodes alone. Each hood has a zone: a box outside which no new node can change it. */
#ifndef GEOM_NEIGHBOURS_H
#define GEOM_NEIGHBOURS_H

#include "geom/boxtree.h"
#include "geom/quadtree.h"
#include "geom/vec.h"

enum { HOOD_MAX = 6, HOOD_WITNESSES = 7 };

/* Neighbours of one source: indices alone, since places and distances are had from the field and s. */
typedef struct {
    uint32_t m[HOOD_MAX];       /* [n] the neighbours */
    uint32_t w[HOOD_WITNESSES]; /* [n_witnesses] other nodes near s: excluded themselves, they exclude what lies behind them */
    uint8_t n, n_witnesses;
} Hood;

/* The points: positions, their index, which of them s may see (NULL: all), and a box that holds all that ever come. */
typedef struct {
    const Vec2 *pos;
    const Quadtree *tree;
    Box2 field;
    PointFilter sees;
    const void *user; /* for sees */
} Field;

/* Relative neighbourhood of s from scratch, nearest first. Exact. O(log n) expected. */
void hood_find(Hood *h, const Field *field, Vec2 s);

/* Takes in new nodes, all of them in field->tree already; prunes whole boxes of them by what the neighbours exclude. Returns whether the
 * neighbourhood changed; old neighbours come before new ones. Exact: the neighbours are those of hood_find. */
bool hood_update(Hood *h, const Field *field, Vec2 s, const Boxtree *fresh);

Box2 hood_zone(const Hood *h, const Field *field, Vec2 s);

/* Voronoi cell of s among the nodes: its edges' owners are the Delaunay neighbours of s in V ∪ {s}. */
typedef struct {
    Vec2 *corner; /* [n] relative to s: edge i runs from corner i to corner i + 1 */
    uint32_t *v;  /* [n] owner of edge i, NO_POINT for the border of a huge box; in the same block of memory */
    uint32_t n, cap;
} Cell;

void cell_clear(Cell *c);

/* Urquhart neighbourhood of s from scratch; fills the cell too. O(log n) expected. */
void urquhart_find(Hood *h, Cell *c, const Field *field, Vec2 s);

/* Takes in new nodes as hood_update does. */
bool urquhart_update(Hood *h, Cell *c, const Field *field, Vec2 s, const Boxtree *fresh);

Box2 urquhart_zone(const Cell *c, const Field *field, Vec2 s);

#endif
