/* Which vein nodes an auxin source s influences: relative neighbourhood (Runions 2005, eq. 2; Toussaint 1980) and Urquhart's
 * approximation (Urquhart 1980), kept up to date as nodes come.
 *
 * A node u excludes v from the neighbourhood of s when u is nearer to s than v is and v is not nearer to s than to u. Eq. 2 leaves both of
 * two equally near nodes out; here the one with the smaller index counts as nearer, so that a source always has a neighbour.
 * Any two neighbours are seen from s more than 60° apart, so there are at most five.
 *
 * Points never move and never go (where they do, the neighbourhood is found anew), so a node once excluded stays excluded and an
 * update looks at new nodes alone. Each hood keeps a zone: a box outside which no new node can change it. */
#ifndef GEOM_NEIGHBOURS_H
#define GEOM_NEIGHBOURS_H

#include "geom/boxtree.h"
#include "geom/quadtree.h"
#include "geom/vec.h"

enum { HOOD_MAX = 6, HOOD_WITNESSES = 8 };

typedef struct {
    Vec2 p;
    double d2; /* squared distance from s */
    uint32_t v;
} Neighbour;

/* Neighbours of one source. */
typedef struct {
    Vec2 s;
    uint32_t n, n_witnesses;
    Neighbour m[HOOD_MAX]; /* [n] the neighbours */
    Neighbour w[HOOD_WITNESSES]; /* [n_witnesses] other nodes near s: excluded themselves, they exclude what lies behind them */
    Box2 zone;
} Hood;

/* The points: positions, their index, which of them s may see (NULL: all), and a box that holds all that ever come. */
typedef struct {
    const Vec2 *pos;
    const Quadtree *tree;
    Box2 field;
    PointFilter sees;
    const void *user; /* for sees */
} Field;

/* Relative neighbourhood of s from scratch. Exact. O(log n) expected. */
void hood_find(Hood *h, const Field *field, Vec2 s);

/* Takes in new nodes, all of them in field->tree already; prunes whole boxes of them by what the neighbours exclude. Returns whether the
 * neighbourhood changed. Exact: the result is that of hood_find. */
bool hood_update(Hood *h, const Field *field, const Boxtree *fresh);

/* Voronoi cell of s among the nodes: its edges' owners are the Delaunay neighbours of s in V ∪ {s}. */
typedef struct {
    uint32_t n, cap;
    uint32_t *v;  /* [n] owner of edge i, NO_POINT for the border of a huge box */
    Vec2 *p;      /* [n] its position relative to s */
    Vec2 *corner; /* [n] relative to s: edge i runs from corner i to corner i + 1 */
} Cell;

void cell_clear(Cell *c);

/* Urquhart neighbourhood of s from scratch; fills the cell too. O(log n) expected. */
void urquhart_find(Hood *h, Cell *c, const Field *field, Vec2 s);

/* Takes in new nodes as hood_update does. */
bool urquhart_update(Hood *h, Cell *c, const Field *field, const Boxtree *fresh);

#endif
