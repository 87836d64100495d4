/* Urquhart's approximation of the relative neighbourhood (Urquhart 1980): the same rule among the Delaunay neighbours of s alone, which are
 * the owners of the edges of its Voronoi cell. */
#include <glib.h>
#include <string.h>

#include "geom/nearby.h"

/* ---- the cell ---- */

void cell_clear(Cell *c)
{
    g_free(c->corner);
    *c = (Cell){0};
}

/* Room for n edges. What the cell held is lost. */
static void cell_reserve(Cell *c, uint32_t n)
{
    if (n <= c->cap)
        return;
    g_free(c->corner);
    c->cap = n + 2;
    c->corner = g_malloc((sizeof *c->corner + sizeof *c->v) * c->cap);
    c->v = (uint32_t *)(c->corner + c->cap);
}

/* The cell before any node: a box so large that it stands for the plane. */
static void cell_start(Cell *c, const Field *f)
{
    double w = f->field.x1 - f->field.x0, h = f->field.y1 - f->field.y0, r = 1e4 * (w > h ? w : h);
    const Vec2 box[4] = {{-r, -r}, {r, -r}, {r, r}, {-r, r}};
    cell_reserve(c, 8);
    c->n = 4;
    for (uint32_t i = 0; i < 4; i++) {
        c->corner[i] = box[i];
        c->v[i] = NO_POINT;
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
    uint32_t kept = n - count;
    uint32_t *ov = g_newa(uint32_t, kept + 2);
    Vec2 *oc = g_newa(Vec2, kept + 2);
    for (uint32_t i = 0; i < kept; i++) {
        uint32_t j = (next + i) % n;
        ov[i] = c->v[j];
        oc[i] = c->corner[j];
    }
    ov[kept] = v;
    oc[kept] = in;
    ov[kept + 1] = c->v[last];
    oc[kept + 1] = out;
    cell_reserve(c, kept + 2);
    c->n = kept + 2;
    memcpy(c->v, ov, sizeof *ov * c->n);
    memcpy(c->corner, oc, sizeof *oc * c->n);
}

/* The discs around the corners through s. A node right on s has no bisector with it; it excludes every other node, for good. */
Box2 urquhart_zone(const Cell *c, const Field *f, Vec2 s)
{
    Box2 z = box_empty();
    for (uint32_t i = 0; i < c->n; i++) {
        double r = sqrt(vec_norm2(c->corner[i]));
        z = box_union(z, (Box2){c->corner[i].x - r, c->corner[i].y - r, c->corner[i].x + r, c->corner[i].y + r});
    }
    double slack = 1e-9 * (f->field.x1 - f->field.x0 + f->field.y1 - f->field.y0);
    return c->n ? box_grow((Box2){z.x0 + s.x, z.y0 + s.y, z.x1 + s.x, z.y1 + s.y}, slack) : z;
}

/* ---- members ---- */

/* Delaunay neighbours that no other Delaunay neighbour excludes. */
static void choose_members(Hood *h, const Cell *c, const Field *f, Vec2 s)
{
    Neighbour *x = g_newa(Neighbour, c->n);
    uint32_t n = 0;
    for (uint32_t i = 0; i < c->n; i++)
        if (c->v[i] != NO_POINT)
            x[n++] = neighbour(f->pos, s, c->v[i]);
    h->n = 0;
    for (uint32_t i = 0; i < n; i++) {
        bool out = false;
        for (uint32_t j = 0; j < n && !out; j++)
            out = excludes(&x[j], &x[i]);
        if (out)
            continue;
        g_assert(h->n < HOOD_MAX);
        h->m[h->n++] = x[i].v;
    }
}

static void collapse(Hood *h, Cell *c, uint32_t v)
{
    c->n = 0;
    h->n = 1;
    h->m[0] = v;
}

/* Pushes what a square holds and what may cut the cell as it is by now. */
static void open_square(Heap *heap, const Field *f, const Cell *c, QuadSquare q, Vec2 s)
{
    const QuadNode *n = &f->tree->node[q.node];
    if (n->child) {
        for (unsigned k = 0; k < 4; k++) {
            QuadSquare child = quadtree_quadrant(f->tree, q, k);
            if (box_cuts(c, square_box(child), s))
                push_square(heap, child, quadtree_square_dist2(child, s));
        }
        return;
    }
    for (uint32_t b = n->bucket; b != NO_POINT; b = f->tree->bucket[b].next) {
        const QuadBucket *k = &f->tree->bucket[b];
        for (uint32_t j = 0; j < k->count; j++)
            push_point(heap, (Neighbour){k->p[j], vec_dist2(s, k->p[j]), k->i[j]});
    }
}

void urquhart_find(Hood *h, Cell *c, const Field *f, Vec2 s)
{
    h->n = h->n_witnesses = 0;
    cell_start(c, f);
    Heap heap;
    heap_init(&heap);
    push_square(&heap, quadtree_root(f->tree), 0.0);
    while (heap.n) {
        Item it = heap_pop(&heap);
        if (it.point == NO_POINT) {
            if (box_cuts(c, square_box(it.square), s))
                open_square(&heap, f, c, it.square, s);
            continue;
        }
        Vec2 p = vec_sub(it.square.centre, s);
        if ((it.d2 != 0.0 && !cell_cuts(c, p)) || (f->sees && !f->sees(f->user, it.point)))
            continue;
        if (it.d2 == 0.0) {
            collapse(h, c, it.point);
            break;
        }
        cell_cut(c, it.point, p);
    }
    heap_clear(&heap);
    if (c->n)
        choose_members(h, c, f, s);
}

bool urquhart_update(Hood *h, Cell *c, const Field *f, Vec2 s, const Boxtree *fresh)
{
    bool changed = false;
    uint32_t stack[BOXTREE_DEPTH], depth = 0;
    stack[depth++] = 0;
    while (depth) {
        uint32_t k = stack[--depth];
        const BoxNode *n = &fresh->node[k];
        if (!box_cuts(c, n->box, s))
            continue;
        if (n->right) {
            stack[depth++] = n->right;
            stack[depth++] = k + 1;
            continue;
        }
        for (uint32_t i = n->first; i < n->first + n->count; i++) {
            uint32_t v = fresh->item[i];
            Vec2 p = vec_sub(f->pos[v], s);
            if (c->n && vec_norm2(p) == 0.0 && (!f->sees || f->sees(f->user, v))) {
                collapse(h, c, v);
                return true;
            }
            if (!cell_cuts(c, p) || (f->sees && !f->sees(f->user, v)))
                continue;
            cell_cut(c, v, p);
            changed = true;
        }
    }
    if (changed)
        choose_members(h, c, f, s);
    return changed;
}
