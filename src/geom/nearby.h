/* What relative and Urquhart neighbourhoods share, private to the two: the rule, and the walk through the nodes from near to far. */
#ifndef GEOM_NEARBY_H
#define GEOM_NEARBY_H

#include <glib.h>
#include <math.h>
#include <string.h>

#include "geom/neighbours.h"
#include "geom/vectors.h"

/* A node as seen from s. */
typedef struct {
    Vec2 p;
    double d2; /* squared distance from s */
    uint32_t v;
} Neighbour;

static inline Neighbour neighbour(const Vec2 *pos, Vec2 s, uint32_t v) { return (Neighbour){pos[v], vec_dist2(s, pos[v]), v}; }

/* Is u nearer to s than v? Ties go to the smaller index. */
static inline bool precedes(const Neighbour *u, const Neighbour *v) { return u->d2 < v->d2 || (u->d2 == v->d2 && u->v < v->v); }

/* Does u exclude v from the neighbourhood of s? The one predicate that everything here decides by. */
static inline bool excludes(const Neighbour *u, const Neighbour *v) { return precedes(u, v) && vec_dist2(u->p, v->p) <= v->d2; }

static inline Box2 square_box(QuadSquare q)
{
    double half = quadtree_reach(q);
    return (Box2){q.centre.x - half, q.centre.y - half, q.centre.x + half, q.centre.y + half};
}

/* ---- four squares at a time ---- */

#define FOUR_GAP(from, reach) FOUR_PICK(FOUR_ABS(from) > (reach), FOUR_ABS(from) - (reach), FOUR(0.0))

/* Squares beside each other: the quadrants of one. */
typedef struct {
    Four x, y, reach, near2; /* centres; quadtree_reach; squared distances from s */
} FourSquares;

static inline __attribute__((always_inline)) void four_quadrants(QuadSquare q, FourSquares *c)
{
    double h = q.half * 0.5;
    c->x = FOUR(q.centre.x) + (Four){-h, h, -h, h};
    c->y = FOUR(q.centre.y) + (Four){-h, -h, h, h};
    c->reach = FOUR(quadtree_reach((QuadSquare){.half = h}));
}

/* ---- lune.c ---- */

/* A node that excludes x, so one in the lune of s and x; FALSE when there is none. With `clear` given, nothing nearer to s than x lies within
 * the disc around clear->p through s, and what lies wholly in there need not be searched: mostly the crowded part, around x itself. */
bool lune_search(const Field *f, Vec2 s, const Neighbour *x, const Neighbour *clear, Neighbour *found);

/* Must all that excludes x lie in the lune of s and its old neighbour m, which is farther off? FALSE: perhaps not. Nothing is nearer to s than
 * near2 (squared). */
bool lune_inherited(Vec2 s, const Neighbour *x, const Neighbour *m, double near2);

/* ---- the walk: squares and points in order of (distance from s, squares first, index) ---- */

typedef struct {
    double d2;
    uint32_t point;    /* NO_POINT: a square */
    QuadSquare square; /* of a point its centre is the place: pos[] would be another wait for memory */
} Item;

typedef struct {
    Item *item;
    uint32_t n, cap;
    Item local[96];
} Heap;

static inline void heap_init(Heap *h)
{
    h->n = 0;
    h->cap = G_N_ELEMENTS(h->local);
    h->item = h->local;
}

static inline void heap_clear(Heap *h)
{
    if (h->item != h->local)
        g_free(h->item);
}

static inline bool before(const Item *a, const Item *b)
{
    if (a->d2 != b->d2)
        return a->d2 < b->d2;
    if ((a->point == NO_POINT) != (b->point == NO_POINT))
        return a->point == NO_POINT;
    return a->point < b->point;
}

static inline void heap_push(Heap *h, Item it)
{
    if (h->n == h->cap) {
        h->cap *= 2;
        h->item = h->item == h->local ? memcpy(g_new(Item, h->cap), h->local, sizeof h->local) : g_renew(Item, h->item, h->cap);
    }
    uint32_t i = h->n++;
    while (i && before(&it, &h->item[(i - 1) / 2])) {
        h->item[i] = h->item[(i - 1) / 2];
        i = (i - 1) / 2;
    }
    h->item[i] = it;
}

static inline Item heap_pop(Heap *h)
{
    Item top = h->item[0], last = h->item[--h->n];
    uint32_t i = 0;
    for (;;) {
        uint32_t c = 2 * i + 1;
        if (c >= h->n)
            break;
        if (c + 1 < h->n && before(&h->item[c + 1], &h->item[c]))
            c++;
        if (!before(&h->item[c], &last))
            break;
        h->item[i] = h->item[c];
        i = c;
    }
    h->item[i] = last;
    return top;
}

static inline void push_square(Heap *h, QuadSquare q, double d2) { heap_push(h, (Item){d2, NO_POINT, q}); }
static inline void push_point(Heap *h, Neighbour x) { heap_push(h, (Item){x.d2, x.v, {.centre = x.p}}); }

#endif
