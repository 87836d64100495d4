#include "geom/neighbours.h"

#include <glib.h>
#include <string.h>

/* Is u (at squared distance du2 from s) nearer to s than v (dv2)? Ties go to the smaller index. */
static inline bool precedes(uint32_t u, double du2, uint32_t v, double dv2) { return du2 < dv2 || (du2 == dv2 && u < v); }

/* Does u exclude v from the neighbourhood of s? The one predicate that everything here decides by. */
static inline bool excludes(uint32_t u, Vec2 pu, double du2, uint32_t v, Vec2 pv, double dv2)
{
    return precedes(u, du2, v, dv2) && vec_dist2(pu, pv) <= dv2;
}

/* Squared distance from p to the farthest point of the square. */
static inline double square_far2(QuadSquare q, Vec2 p)
{
    double half = quadtree_reach(q), dx = fabs(p.x - q.centre.x) + half, dy = fabs(p.y - q.centre.y) + half;
    return dx * dx + dy * dy;
}

/* Does any node exclude x: does one lie in the lune of s and x? With `clear` given, nothing nearer to s than x lies within the disc around
 * clear->p through s, and what lies wholly in there need not be searched: mostly the crowded part, around x itself. */
static bool lune_taken(const Field *f, Vec2 s, const Neighbour *x, const Neighbour *clear)
{
    QuadSquare stack[QUAD_STACK];
    unsigned depth = 0;
    stack[depth++] = quadtree_root(f->tree);
    while (depth) {
        QuadSquare q = stack[--depth];
        const QuadNode *n = &f->tree->node[q.node];
        if (n->child) {
            for (unsigned k = 0; k < 4; k++) {
                QuadSquare c = quadtree_quadrant(f->tree, q, k);
                if (quadtree_square_dist2(c, x->p) <= x->d2 && quadtree_square_dist2(c, s) <= x->d2 &&
                    !(clear && square_far2(c, clear->p) < clear->d2 * (1.0 - 1e-9)))
                    stack[depth++] = c;
            }
            continue;
        }
        for (uint32_t b = n->bucket; b != NO_POINT; b = f->tree->bucket[b].next) {
            const QuadBucket *k = &f->tree->bucket[b];
            for (uint32_t j = 0; j < k->count; j++)
                if (k->i[j] != x->v && excludes(k->i[j], k->p[j], vec_dist2(s, k->p[j]), x->v, x->p, x->d2) &&
                    (!f->sees || f->sees(f->user, k->i[j])))
                    return true;
        }
    }
    return false;
}

/* The same among the new nodes alone. */
static bool lune_taken_by_fresh(const Field *f, const Boxtree *fresh, Vec2 s, const Neighbour *x)
{
    uint32_t stack[BOXTREE_DEPTH], depth = 0;
    stack[depth++] = 0;
    while (depth) {
        uint32_t k = stack[--depth];
        const BoxNode *n = &fresh->node[k];
        if (box_dist2(n->box, s) > x->d2 || box_dist2(n->box, x->p) > x->d2)
            continue;
        if (n->right) {
            stack[depth++] = n->right;
            stack[depth++] = k + 1;
            continue;
        }
        for (uint32_t i = n->first; i < n->first + n->count; i++) {
            uint32_t u = fresh->item[i];
            if (u != x->v && excludes(u, f->pos[u], vec_dist2(s, f->pos[u]), x->v, x->p, x->d2) && (!f->sees || f->sees(f->user, u)))
                return true;
        }
    }
    return false;
}

static void member_add(Hood *h, Neighbour x)
{
    g_assert(h->n < HOOD_MAX);
    h->m[h->n++] = x;
}

/* Keeps a node as a witness; when there are too many, the farthest goes. What witnesses are kept decides speed alone. */
static void witness_add(Hood *h, Neighbour x)
{
    uint32_t at = h->n_witnesses;
    if (at < HOOD_WITNESSES) {
        h->n_witnesses++;
    } else {
        at = 0;
        for (uint32_t i = 1; i < HOOD_WITNESSES; i++)
            if (h->w[i].d2 > h->w[at].d2)
                at = i;
        if (h->w[at].d2 <= x.d2)
            return;
    }
    h->w[at] = x;
}

static bool excluded_by_any(const Neighbour *list, uint32_t n, const Neighbour *x)
{
    for (uint32_t i = 0; i < n; i++)
        if (excludes(list[i].v, list[i].p, list[i].d2, x->v, x->p, x->d2))
            return true;
    return false;
}

/* ---- the zone ---- */

enum { ZONE_CORNERS = 4 + HOOD_MAX + HOOD_WITNESSES };

/* Cuts a convex polygon (relative to s) by the half-plane nearer to s than to p. Returns the corner count. */
static uint32_t cut(Vec2 *corner, uint32_t n, Vec2 p)
{
    Vec2 out[ZONE_CORNERS + 1];
    uint32_t m = 0;
    double limit = vec_norm2(p) * 0.5;
    for (uint32_t i = 0; i < n; i++) {
        Vec2 a = corner[i], b = corner[i + 1 < n ? i + 1 : 0];
        double fa = vec_dot(a, p) - limit, fb = vec_dot(b, p) - limit;
        if (fa <= 0.0)
            out[m++] = a;
        if ((fa < 0.0 && fb > 0.0) || (fa > 0.0 && fb < 0.0))
            out[m++] = vec_lerp(a, b, fa / (fa - fb));
    }
    if (m > ZONE_CORNERS)
        return n; /* cannot happen in exact arithmetic; an uncut zone is merely larger */
    for (uint32_t i = 0; i < m; i++)
        corner[i] = out[i];
    return m;
}

/* The part of the plane that node p, at distance d from s, does not shut off: its own half-plane's other side is cut from the
 * polygon, but what lies there nearer to s than p stays in, within the lune. */
static uint32_t zone_cut(Box2 *z, Vec2 *corner, uint32_t n, Vec2 s, const Neighbour *x)
{
    double d = sqrt(x->d2), mx = (s.x + x->p.x) * 0.5, my = (s.y + x->p.y) * 0.5;
    double hx = d - fabs(x->p.x - s.x) * 0.5, hy = d - fabs(x->p.y - s.y) * 0.5;
    *z = box_union(*z, (Box2){mx - hx, my - hy, mx + hx, my + hy});
    return cut(corner, n, vec_sub(x->p, s));
}

/* A new node changes the hood only if no neighbour or witness excludes it (then it may be a neighbour itself) or if it lies in the
 * lune of s and a neighbour (then it excludes that one). */
static void zone_update(Hood *h, Box2 field)
{
    Box2 z = box_empty();
    Vec2 c[ZONE_CORNERS + 1] = {vec_sub(vec2(field.x0, field.y0), h->s), vec_sub(vec2(field.x1, field.y0), h->s),
                                vec_sub(vec2(field.x1, field.y1), h->s), vec_sub(vec2(field.x0, field.y1), h->s)};
    uint32_t n = 4;
    for (uint32_t i = 0; i < h->n; i++)
        n = zone_cut(&z, c, n, h->s, &h->m[i]);
    for (uint32_t i = 0; i < h->n_witnesses; i++)
        n = zone_cut(&z, c, n, h->s, &h->w[i]);
    for (uint32_t i = 0; i < n; i++)
        z = box_add(z, vec_add(c[i], h->s));
    double slack = 1e-9 * (fabs(field.x0) + fabs(field.x1) + fabs(field.y0) + fabs(field.y1));
    h->zone = box_grow(z, slack);
}

/* ---- from scratch ---- */

/* Walks squares and points in order of (distance from s, squares first, index). */
typedef struct {
    double d2;
    uint32_t point; /* NO_POINT: a square */
    QuadSquare square;
} Item;

typedef struct {
    Item *item;
    uint32_t n, cap;
    Item local[96];
} Heap;

static inline bool before(const Item *a, const Item *b)
{
    if (a->d2 != b->d2)
        return a->d2 < b->d2;
    if ((a->point == NO_POINT) != (b->point == NO_POINT))
        return a->point == NO_POINT;
    return a->point < b->point;
}

static void heap_push(Heap *h, Item it)
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

static Item heap_pop(Heap *h)
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

/* Does a node exclude all points of the box, whose squared distance from s is near2? All of it is farther from s than the node and
 * nearer to the node than to s. The slack leaves borderline points to the predicate. */
static inline bool shuts(const Neighbour *x, Vec2 s, Box2 b, double near2)
{
    Vec2 u = vec_sub(x->p, s);
    double least = ((u.x > 0 ? b.x0 : b.x1) - s.x) * u.x + ((u.y > 0 ? b.y0 : b.y1) - s.y) * u.y;
    return near2 > x->d2 && 2.0 * least > x->d2 * (1.0 + 1e-9) + 1e-9 * fabs(least);
}

/* Might a point of the box be a neighbour? */
static bool box_open(const Hood *h, Box2 b, double near2)
{
    for (uint32_t i = 0; i < h->n; i++)
        if (shuts(&h->m[i], h->s, b, near2))
            return false;
    for (uint32_t i = 0; i < h->n_witnesses; i++)
        if (shuts(&h->w[i], h->s, b, near2))
            return false;
    return true;
}

static Box2 square_box(QuadSquare q)
{
    double half = quadtree_reach(q);
    return (Box2){q.centre.x - half, q.centre.y - half, q.centre.x + half, q.centre.y + half};
}

static void push_square(Heap *heap, QuadSquare q, Vec2 s)
{
    heap_push(heap, (Item){quadtree_square_dist2(q, s), NO_POINT, q});
}

static void open_square(Heap *heap, const Field *f, QuadSquare q, Vec2 s)
{
    const QuadNode *n = &f->tree->node[q.node];
    if (n->child) {
        for (unsigned k = 0; k < 4; k++)
            push_square(heap, quadtree_quadrant(f->tree, q, k), s);
        return;
    }
    for (uint32_t b = n->bucket; b != NO_POINT; b = f->tree->bucket[b].next) {
        const QuadBucket *k = &f->tree->bucket[b];
        for (uint32_t j = 0; j < k->count; j++)
            if (!f->sees || f->sees(f->user, k->i[j]))
                heap_push(heap, (Item){vec_dist2(s, k->p[j]), k->i[j], {0}});
    }
}

void hood_find(Hood *h, const Field *f, Vec2 s)
{
    *h = (Hood){.s = s};
    Heap heap;
    heap.n = 0;
    heap.cap = G_N_ELEMENTS(heap.local);
    heap.item = heap.local;
    push_square(&heap, quadtree_root(f->tree), s);
    while (heap.n) {
        Item it = heap_pop(&heap);
        if (it.point == NO_POINT) {
            if (box_open(h, square_box(it.square), it.d2))
                open_square(&heap, f, it.square, s);
            continue;
        }
        Neighbour x = {f->pos[it.point], it.d2, it.point};
        if (excluded_by_any(h->m, h->n, &x) || excluded_by_any(h->w, h->n_witnesses, &x))
            continue;
        if (lune_taken(f, s, &x, NULL))
            witness_add(h, x);
        else
            member_add(h, x);
    }
    if (heap.item != heap.local)
        g_free(heap.item);
    zone_update(h, f->field);
}

/* ---- update ---- */

/* New nodes that no old member or witness excludes, nearest first. */
typedef struct {
    Neighbour local[64], *comer;
    uint32_t n, cap;
    unsigned gone; /* mask of the members that a new node excludes */
} Comers;

static void comer_add(Comers *c, Neighbour x)
{
    if (c->n == c->cap) {
        c->cap *= 2;
        c->comer = c->comer == c->local ? memcpy(g_new(Neighbour, c->cap), c->local, sizeof c->local)
                                        : g_renew(Neighbour, c->comer, c->cap);
    }
    uint32_t i = c->n++;
    for (; i && precedes(x.v, x.d2, c->comer[i - 1].v, c->comer[i - 1].d2); i--)
        c->comer[i] = c->comer[i - 1];
    c->comer[i] = x;
}

/* Sorts out one new node. */
static void consider(const Hood *h, const Field *f, uint32_t v, Comers *c)
{
    Neighbour x = {f->pos[v], vec_dist2(h->s, f->pos[v]), v};
    unsigned hits = 0;
    bool out = false;
    for (uint32_t i = 0; i < h->n; i++) {
        double between = vec_dist2(x.p, h->m[i].p);
        if (precedes(h->m[i].v, h->m[i].d2, v, x.d2))
            out |= between <= x.d2;
        else if (between <= h->m[i].d2)
            hits |= 1u << i;
    }
    if ((out && !hits) || (f->sees && !f->sees(f->user, v)))
        return;
    c->gone |= hits;
    if (!out && !excluded_by_any(h->w, h->n_witnesses, &x))
        comer_add(c, x);
}

/* Might a point of the box be a neighbour, or, lying in a lune, exclude one? */
static bool box_matters(const Hood *h, Box2 b)
{
    double near2 = box_dist2(b, h->s);
    for (uint32_t i = 0; i < h->n; i++)
        if (near2 <= h->m[i].d2 && box_dist2(b, h->m[i].p) <= h->m[i].d2)
            return true;
    return box_open(h, b, near2);
}

static void sort_out(const Hood *h, const Field *f, const Boxtree *fresh, Comers *c)
{
    uint32_t stack[BOXTREE_DEPTH], depth = 0;
    stack[depth++] = 0;
    while (depth) {
        uint32_t k = stack[--depth];
        const BoxNode *n = &fresh->node[k];
        if (!box_matters(h, n->box))
            continue;
        if (n->right) {
            stack[depth++] = n->right;
            stack[depth++] = k + 1;
            continue;
        }
        for (uint32_t i = n->first; i < n->first + n->count; i++)
            consider(h, f, fresh->item[i], c);
    }
}

/* An old neighbour that helps to clear a newcomer: its lune was empty before this step, so among old nodes only those in the part of x's
 * lune that sticks out of its own can exclude x. Nearest to x is best: x is mostly its child. NULL when none is farther from s. */
static const Neighbour *cleared(const Neighbour *old, uint32_t n, const Neighbour *x)
{
    const Neighbour *best = NULL;
    for (uint32_t i = 0; i < n; i++)
        if (old[i].d2 > x->d2 && (!best || vec_dist2(old[i].p, x->p) < vec_dist2(best->p, x->p)))
            best = &old[i];
    return best;
}

bool hood_update(Hood *h, const Field *f, const Boxtree *fresh)
{
    Comers c;
    c.n = c.gone = 0;
    c.cap = G_N_ELEMENTS(c.local);
    c.comer = c.local;
    sort_out(h, f, fresh, &c);
    if (!c.gone && !c.n)
        return false;
    Neighbour old[HOOD_MAX];
    uint32_t n_old = h->n;
    memcpy(old, h->m, sizeof *old * n_old);
    h->n = 0;
    for (uint32_t i = 0; i < n_old; i++)
        if (!(c.gone >> i & 1))
            member_add(h, old[i]);
    for (uint32_t k = 0; k < c.n; k++) {
        const Neighbour *x = &c.comer[k];
        if (excluded_by_any(c.comer, k, x)) /* most are, by another newcomer, before the tree is asked */
            continue;
        const Neighbour *clear = cleared(old, n_old, x);
        if ((clear && lune_taken_by_fresh(f, fresh, h->s, x)) || lune_taken(f, h->s, x, clear))
            witness_add(h, *x);
        else
            member_add(h, *x);
    }
    if (c.comer != c.local)
        g_free(c.comer);
    zone_update(h, f->field);
    return true;
}

/* ---- Urquhart ---- */

void cell_clear(Cell *c)
{
    g_free(c->v);
    g_free(c->p);
    g_free(c->corner);
    *c = (Cell){0};
}

static void cell_reserve(Cell *c, uint32_t n)
{
    if (n <= c->cap)
        return;
    c->cap = MAX(n, c->cap * 2);
    c->v = g_renew(uint32_t, c->v, c->cap);
    c->p = g_renew(Vec2, c->p, c->cap);
    c->corner = g_renew(Vec2, c->corner, c->cap);
}

/* The cell before any node: a box so large that it stands for the plane. */
static void cell_start(Cell *c, const Field *f)
{
    double w = f->field.x1 - f->field.x0, h = f->field.y1 - f->field.y0, r = 1e4 * (w > h ? w : h);
    const Vec2 box[4] = {{-r, -r}, {r, -r}, {r, r}, {-r, r}};
    cell_reserve(c, 12);
    c->n = 4;
    for (uint32_t i = 0; i < 4; i++) {
        c->corner[i] = box[i];
        c->v[i] = NO_POINT;
        c->p[i] = vec2(0, 0);
    }
}

/* Does the bisector of s and p (relative) cut the cell? */
static bool cell_cuts(const Cell *c, Vec2 p)
{
    double limit = vec_norm2(p) * 0.5;
    for (uint32_t i = 0; i < c->n; i++)
        if (vec_dot(c->corner[i], p) > limit)
            return true;
    return false;
}

/* Might the bisector of s and some point of the box cut the cell? A point x (relative to s) cuts off corner q when x·q > |x|² / 2. */
static bool box_cuts(const Cell *c, Box2 b, Vec2 s)
{
    double d2 = box_dist2(b, s);
    for (uint32_t i = 0; i < c->n; i++) {
        Vec2 q = c->corner[i];
        double most = ((q.x > 0 ? b.x1 : b.x0) - s.x) * q.x + ((q.y > 0 ? b.y1 : b.y0) - s.y) * q.y;
        if (most + 1e-9 * fabs(most) + 1e-9 > d2 * 0.5)
            return true;
    }
    return false;
}

/* Cuts the cell by the bisector of s and node v at p (relative). A cell is convex, so what goes is one run of corners. */
static void cell_cut(Cell *c, uint32_t v, Vec2 p)
{
    double limit = vec_norm2(p) * 0.5;
    uint32_t n = c->n, first = n, count = 0;
    for (uint32_t i = 0; i < n; i++) /* first cut corner after a kept one */
        if (vec_dot(c->corner[i], p) > limit && vec_dot(c->corner[(i + n - 1) % n], p) <= limit)
            first = i;
    if (first == n)
        return; /* nothing cut, or all of it: p coincides with s */
    while (count < n && vec_dot(c->corner[(first + count) % n], p) > limit)
        count++;
    uint32_t prev = (first + n - 1) % n, last = (first + count - 1) % n, next = (last + 1) % n;
    Vec2 a = c->corner[prev], b = c->corner[first], d = c->corner[last], e = c->corner[next];
    double fa = vec_dot(a, p) - limit, fb = vec_dot(b, p) - limit, fd = vec_dot(d, p) - limit, fe = vec_dot(e, p) - limit;
    Vec2 in = vec_lerp(a, b, fa / (fa - fb)), out = vec_lerp(d, e, fd / (fd - fe));
    /* corners first … last become in (start of v's edge) and out (start of what is left of last's edge) */
    cell_reserve(c, n + 2);
    Cell old = *c;
    uint32_t kept = n - count;
    uint32_t *ov = g_newa(uint32_t, kept + 2);
    Vec2 *op = g_newa(Vec2, kept + 2), *oc = g_newa(Vec2, kept + 2);
    for (uint32_t i = 0; i < kept; i++) {
        uint32_t j = (next + i) % n;
        ov[i] = old.v[j];
        op[i] = old.p[j];
        oc[i] = old.corner[j];
    }
    ov[kept] = v;
    op[kept] = p;
    oc[kept] = in;
    ov[kept + 1] = old.v[last];
    op[kept + 1] = old.p[last];
    oc[kept + 1] = out;
    c->n = kept + 2;
    memcpy(c->v, ov, sizeof *ov * c->n);
    memcpy(c->p, op, sizeof *op * c->n);
    memcpy(c->corner, oc, sizeof *oc * c->n);
}

/* Neighbours: Delaunay neighbours that no other Delaunay neighbour excludes. Zone: the discs around the corners through s. */
static void urquhart_members(Hood *h, const Cell *c, const Field *f)
{
    h->n = 0;
    Box2 z = box_empty();
    for (uint32_t i = 0; i < c->n; i++) {
        double r = sqrt(vec_norm2(c->corner[i]));
        z = box_union(z, (Box2){c->corner[i].x - r, c->corner[i].y - r, c->corner[i].x + r, c->corner[i].y + r});
        if (c->v[i] == NO_POINT)
            continue;
        Vec2 pv = f->pos[c->v[i]];
        double dv2 = vec_dist2(h->s, pv);
        bool out = false;
        for (uint32_t j = 0; j < c->n && !out; j++)
            out = c->v[j] != NO_POINT && c->v[j] != c->v[i] &&
                  excludes(c->v[j], f->pos[c->v[j]], vec_dist2(h->s, f->pos[c->v[j]]), c->v[i], pv, dv2);
        if (!out)
            member_add(h, (Neighbour){pv, dv2, c->v[i]});
    }
    double slack = 1e-9 * (f->field.x1 - f->field.x0 + f->field.y1 - f->field.y0);
    h->zone = box_grow((Box2){z.x0 + h->s.x, z.y0 + h->s.y, z.x1 + h->s.x, z.y1 + h->s.y}, slack);
}

/* A node right on s has no bisector with it; it excludes every other node, for good. */
static void urquhart_collapse(Hood *h, Cell *c, uint32_t v)
{
    c->n = 0;
    h->n = 1;
    h->m[0] = (Neighbour){h->s, 0.0, v};
    h->zone = box_empty();
}

void urquhart_find(Hood *h, Cell *c, const Field *f, Vec2 s)
{
    *h = (Hood){.s = s};
    cell_start(c, f);
    Heap heap;
    heap.n = 0;
    heap.cap = G_N_ELEMENTS(heap.local);
    heap.item = heap.local;
    push_square(&heap, quadtree_root(f->tree), s);
    while (heap.n) {
        Item it = heap_pop(&heap);
        if (it.point != NO_POINT && it.d2 == 0.0) {
            urquhart_collapse(h, c, it.point);
            break;
        }
        if (it.point != NO_POINT)
            cell_cut(c, it.point, vec_sub(f->pos[it.point], s));
        else if (box_cuts(c, square_box(it.square), s))
            open_square(&heap, f, it.square, s);
    }
    if (heap.item != heap.local)
        g_free(heap.item);
    if (c->n)
        urquhart_members(h, c, f);
}

bool urquhart_update(Hood *h, Cell *c, const Field *f, const Boxtree *fresh)
{
    bool changed = false;
    uint32_t stack[BOXTREE_DEPTH], depth = 0;
    stack[depth++] = 0;
    while (depth) {
        uint32_t k = stack[--depth];
        const BoxNode *n = &fresh->node[k];
        if (!box_cuts(c, n->box, h->s))
            continue;
        if (n->right) {
            stack[depth++] = n->right;
            stack[depth++] = k + 1;
            continue;
        }
        for (uint32_t i = n->first; i < n->first + n->count; i++) {
            uint32_t v = fresh->item[i];
            Vec2 p = vec_sub(f->pos[v], h->s);
            if (c->n && vec_norm2(p) == 0.0 && (!f->sees || f->sees(f->user, v))) {
                urquhart_collapse(h, c, v);
                return true;
            }
            if (!cell_cuts(c, p) || (f->sees && !f->sees(f->user, v)))
                continue;
            cell_cut(c, v, p);
            changed = true;
        }
    }
    if (changed)
        urquhart_members(h, c, f);
    return changed;
}
