/* Relative neighbourhoods (Runions 2005, eq. 2). */
#include <glib.h>
#include <string.h>

#include "geom/nearby.h"

/* A hood with what it points to. */
typedef struct {
    Vec2 s;
    uint32_t n, n_witnesses;
    Neighbour m[HOOD_MAX], w[HOOD_WITNESSES];
} View;

static void view_init(View *v, const Hood *h, const Vec2 *pos, Vec2 s)
{
    v->s = s;
    v->n = h->n;
    v->n_witnesses = h->n_witnesses;
    for (uint32_t i = 0; i < v->n; i++)
        v->m[i] = neighbour(pos, s, h->m[i]);
    for (uint32_t i = 0; i < v->n_witnesses; i++)
        v->w[i] = neighbour(pos, s, h->w[i]);
}

static void hood_store(Hood *h, const View *v)
{
    h->n = (uint8_t)v->n;
    h->n_witnesses = (uint8_t)v->n_witnesses;
    for (uint32_t i = 0; i < v->n; i++)
        h->m[i] = v->m[i].v;
    for (uint32_t i = 0; i < v->n_witnesses; i++)
        h->w[i] = v->w[i].v;
}

static void member_add(View *v, const Neighbour *x)
{
    g_assert(v->n < HOOD_MAX);
    v->m[v->n++] = *x;
}

/* Keeps a node as a witness; when there are too many, the farthest goes. What witnesses are kept decides speed alone. */
static void witness_add(View *v, const Neighbour *x)
{
    uint32_t at = v->n_witnesses;
    if (at < HOOD_WITNESSES) {
        v->n_witnesses++;
    } else {
        at = 0;
        for (uint32_t i = 1; i < HOOD_WITNESSES; i++)
            if (v->w[i].d2 > v->w[at].d2)
                at = i;
        if (v->w[at].d2 <= x->d2)
            return;
    }
    v->w[at] = *x;
}

static bool excluded_by_any(const Neighbour *list, uint32_t n, const Neighbour *x)
{
    for (uint32_t i = 0; i < n; i++)
        if (excludes(&list[i], x))
            return true;
    return false;
}

static bool view_excludes(const View *v, const Neighbour *x)
{
    return excluded_by_any(v->m, v->n, x) || excluded_by_any(v->w, v->n_witnesses, x);
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

/* The part of the plane that a node does not shut off: its own half-plane's other side is cut from the polygon, but what lies there nearer
 * to s than the node stays in, within the lune. */
static uint32_t zone_cut(Box2 *z, Vec2 *corner, uint32_t n, Vec2 s, const Neighbour *x)
{
    double d = sqrt(x->d2), mx = (s.x + x->p.x) * 0.5, my = (s.y + x->p.y) * 0.5;
    double hx = d - fabs(x->p.x - s.x) * 0.5, hy = d - fabs(x->p.y - s.y) * 0.5;
    *z = box_union(*z, (Box2){mx - hx, my - hy, mx + hx, my + hy});
    return cut(corner, n, vec_sub(x->p, s));
}

/* A new node changes the hood only if no neighbour or witness excludes it (then it may be a neighbour itself) or if it lies in the
 * lune of s and a neighbour (then it excludes that one). */
Box2 hood_zone(const Hood *h, const Field *f, Vec2 s)
{
    View v;
    view_init(&v, h, f->pos, s);
    Box2 z = box_empty(), field = f->field;
    Vec2 c[ZONE_CORNERS + 1] = {vec_sub(vec2(field.x0, field.y0), s), vec_sub(vec2(field.x1, field.y0), s),
                                vec_sub(vec2(field.x1, field.y1), s), vec_sub(vec2(field.x0, field.y1), s)};
    uint32_t n = 4;
    for (uint32_t i = 0; i < v.n; i++)
        n = zone_cut(&z, c, n, s, &v.m[i]);
    for (uint32_t i = 0; i < v.n_witnesses; i++)
        n = zone_cut(&z, c, n, s, &v.w[i]);
    for (uint32_t i = 0; i < n; i++)
        z = box_add(z, vec_add(c[i], s));
    double slack = 1e-9 * (fabs(field.x0) + fabs(field.x1) + fabs(field.y0) + fabs(field.y1));
    return box_grow(z, slack);
}

/* ---- from scratch ---- */

/* Does a node exclude all points of the box, whose squared distance from s is near2? All of it is farther from s than the node and
 * nearer to the node than to s. The slack leaves borderline points to the predicate. */
static inline bool shuts(const Neighbour *x, Vec2 s, Box2 b, double near2)
{
    Vec2 u = vec_sub(x->p, s);
    double least = ((u.x > 0 ? b.x0 : b.x1) - s.x) * u.x + ((u.y > 0 ? b.y0 : b.y1) - s.y) * u.y;
    return near2 > x->d2 && 2.0 * least > x->d2 * (1.0 + 1e-9) + 1e-9 * fabs(least);
}

/* Might a point of the box, whose squared distance from s is near2, be a neighbour? */
static bool view_open(const View *v, Box2 b, double near2)
{
    for (uint32_t i = 0; i < v->n; i++)
        if (shuts(&v->m[i], v->s, b, near2))
            return false;
    for (uint32_t i = 0; i < v->n_witnesses; i++)
        if (shuts(&v->w[i], v->s, b, near2))
            return false;
    return true;
}

/* Which of four squares does a node shut? */
static inline __attribute__((always_inline)) void four_shut(const Neighbour *x, Vec2 s, const FourSquares *q, FourMask *shut)
{
    Vec2 u = vec_sub(x->p, s);
    Four ex = u.x > 0 ? -q->reach : q->reach, ey = u.y > 0 ? -q->reach : q->reach;
    Four least = (q->x + ex - FOUR(s.x)) * FOUR(u.x) + (q->y + ey - FOUR(s.y)) * FOUR(u.y);
    *shut |= (q->near2 > FOUR(x->d2)) & (FOUR(2.0) * least > FOUR(x->d2 * (1.0 + 1e-9)) + FOUR(1e-9) * FOUR_ABS(least));
}

/* Pushes the quadrants that the nodes found so far do not shut. */
static WIDE void open_quadrants(Heap *heap, const Field *f, const View *v, QuadSquare q)
{
    FourSquares c = {0};
    FourMask shut = FOUR_MASK(0);
    four_quadrants(q, &c);
    Four dx = FOUR_GAP(c.x - FOUR(v->s.x), c.reach), dy = FOUR_GAP(c.y - FOUR(v->s.y), c.reach);
    c.near2 = dx * dx + dy * dy;
    for (uint32_t i = 0; i < v->n; i++)
        four_shut(&v->m[i], v->s, &c, &shut);
    for (uint32_t i = 0; i < v->n_witnesses; i++)
        four_shut(&v->w[i], v->s, &c, &shut);
    for (unsigned k = 0; k < 4; k++)
        if (!shut[k])
            push_square(heap, quadtree_quadrant(f->tree, q, k), c.near2[k]);
}

/* Pushes what a square holds and what the nodes found so far do not exclude. */
static void open_square(Heap *heap, const Field *f, const View *v, QuadSquare q)
{
    const QuadNode *n = &f->tree->node[q.node];
    if (n->child) {
        open_quadrants(heap, f, v, q);
        return;
    }
    for (uint32_t b = n->bucket; b != NO_POINT; b = f->tree->bucket[b].next) {
        const QuadBucket *k = &f->tree->bucket[b];
        for (uint32_t j = 0; j < k->count; j++) {
            Neighbour x = {k->p[j], vec_dist2(v->s, k->p[j]), k->i[j]};
            if (!view_excludes(v, &x))
                push_point(heap, x);
        }
    }
}

void hood_find(Hood *h, const Field *f, Vec2 s)
{
    View v;
    v.s = s;
    v.n = v.n_witnesses = 0;
    Heap heap;
    heap_init(&heap);
    push_square(&heap, quadtree_root(f->tree), 0.0);
    while (heap.n) {
        Item it = heap_pop(&heap);
        if (it.point == NO_POINT) {
            if (view_open(&v, square_box(it.square), it.d2))
                open_square(&heap, f, &v, it.square);
            continue;
        }
        Neighbour x = {it.square.centre, it.d2, it.point};
        if (view_excludes(&v, &x) || (f->sees && !f->sees(f->user, x.v)))
            continue;
        Neighbour other;
        if (v.n && lune_search(f, s, &x, NULL, &other)) /* the nearest is a neighbour anyway */
            witness_add(&v, &x);
        else
            member_add(&v, &x);
    }
    heap_clear(&heap);
    hood_store(h, &v);
}

/* ---- update ---- */

/* Nodes that might be neighbours or exclude one, nearest first. */
typedef struct {
    Neighbour x;
    bool barred; /* can't be a neighbour itself */
} Candidate;

typedef struct {
    Candidate local[48], *at;
    uint32_t n, cap;
    unsigned gone; /* mask of the old neighbours that a candidate excludes */
} Candidates;

static void candidates_init(Candidates *c)
{
    c->n = c->gone = 0;
    c->cap = G_N_ELEMENTS(c->local);
    c->at = c->local;
}

static void candidates_clear(Candidates *c)
{
    if (c->at != c->local)
        g_free(c->at);
}

static void candidate_add(Candidates *c, Neighbour x, bool barred)
{
    if (c->n == c->cap) {
        c->cap *= 2;
        c->at = c->at == c->local ? memcpy(g_new(Candidate, c->cap), c->local, sizeof c->local) : g_renew(Candidate, c->at, c->cap);
    }
    c->at[c->n++] = (Candidate){x, barred};
    if (precedes(&x, &c->at[0].x)) { /* the nearest first; the rest is sorted later */
        c->at[c->n - 1] = c->at[0];
        c->at[0] = (Candidate){x, barred};
    }
}

static int by_nearness(gconstpointer a, gconstpointer b, gpointer unused)
{
    const Neighbour *x = &((const Candidate *)a)->x, *y = &((const Candidate *)b)->x;
    return precedes(x, y) ? -1 : precedes(y, x);
}

static void candidates_sort(Candidates *c)
{
    enum { FEW = 12 };
    if (c->n > FEW) {
        g_qsort_with_data(c->at, (gint)c->n, sizeof *c->at, by_nearness, NULL);
        return;
    }
    for (uint32_t k = 1; k < c->n; k++) {
        Candidate x = c->at[k];
        uint32_t i = k;
        for (; i && precedes(&x.x, &c->at[i - 1].x); i--)
            c->at[i] = c->at[i - 1];
        c->at[i] = x;
    }
}

/* Does one of the first k candidates exclude candidate k? */
static bool outdone(const Candidates *c, uint32_t k)
{
    for (uint32_t i = 0; i < k; i++)
        if (excludes(&c->at[i].x, &c->at[k].x))
            return true;
    return false;
}

enum { GUARDS = 8 };

/* Does one of some candidates so far, the nearest among them, exclude x? Mostly one of these does if any, and the list stays short. */
static bool outdone_by_few(const Candidates *c, const Neighbour *x)
{
    for (uint32_t i = 0; i < MIN(c->n, GUARDS); i++)
        if (excludes(&c->at[i].x, x))
            return true;
    return false;
}

/* Sorts out one new node. */
static void consider(const View *h, const Field *f, uint32_t v, Candidates *c)
{
    Neighbour x = neighbour(f->pos, h->s, v);
    unsigned hits = 0;
    bool out = false;
    for (uint32_t i = 0; i < h->n; i++) {
        double between = vec_dist2(x.p, h->m[i].p);
        if (precedes(&h->m[i], &x))
            out |= between <= x.d2;
        else if (between <= h->m[i].d2)
            hits |= 1u << i;
    }
    out = out || excluded_by_any(h->w, h->n_witnesses, &x);
    if (!hits && (out || outdone_by_few(c, &x))) /* one that lies in no lune excludes none that the others don't */
        return;
    if (f->sees && !f->sees(f->user, v))
        return;
    c->gone |= hits;
    candidate_add(c, x, out);
}

/* Might a point of the box, whose squared distance from s is near2, be a neighbour, or, lying in a lune, exclude one? */
static bool box_matters(const View *h, const Candidates *c, Box2 b, double near2)
{
    for (uint32_t i = 0; i < h->n; i++)
        if (near2 <= h->m[i].d2 && box_dist2(b, h->m[i].p) <= h->m[i].d2)
            return true;
    for (uint32_t i = 0; i < MIN(c->n, GUARDS); i++)
        if (shuts(&c->at[i].x, h->s, b, near2))
            return false;
    return view_open(h, b, near2);
}

static void look_at_fresh(const View *h, const Field *f, const Boxtree *fresh, Candidates *c)
{
    struct {
        uint32_t node;
        double near2;
    } stack[BOXTREE_DEPTH];
    uint32_t depth = 0;
    stack[depth].near2 = box_dist2(fresh->node[0].box, h->s);
    stack[depth++].node = 0;
    while (depth) {
        uint32_t k = stack[--depth].node;
        const BoxNode *n = &fresh->node[k];
        if (!box_matters(h, c, n->box, stack[depth].near2))
            continue;
        if (n->right) { /* the nearer one first: what it holds may exclude all of the other */
            double left2 = box_dist2(fresh->node[k + 1].box, h->s), right2 = box_dist2(fresh->node[n->right].box, h->s);
            uint32_t left_at = depth + (left2 <= right2), right_at = depth + (left2 > right2);
            stack[left_at].node = k + 1;
            stack[left_at].near2 = left2;
            stack[right_at].node = n->right;
            stack[right_at].near2 = right2;
            depth += 2;
            continue;
        }
        for (uint32_t i = n->first; i < n->first + n->count; i++)
            consider(h, f, fresh->item[i], c);
    }
}

/* Finds a node that excludes candidate k, which no other candidate does. Among the new nodes only candidates can, and old ones can't from
 * within the lune of an old neighbour, which was empty. */
static bool candidate_taken(const View *h, const Field *f, const Candidates *c, uint32_t k, Neighbour *other)
{
    const Neighbour *x = &c->at[k].x, *clear = NULL;
    double near2 = HUGE_VAL;
    for (uint32_t i = 0; i < h->n; i++)
        near2 = MIN(near2, h->m[i].d2);
    if (k == 0 && x->d2 < near2)
        return false; /* the nearest of all */
    near2 = MIN(near2, c->at[0].x.d2);
    for (uint32_t i = 0; i < h->n; i++) {
        if (h->m[i].d2 <= x->d2)
            continue;
        if (lune_inherited(h->s, x, &h->m[i], near2))
            return false;
        if (!clear || vec_dist2(h->m[i].p, x->p) < vec_dist2(clear->p, x->p))
            clear = &h->m[i];
    }
    return lune_search(f, h->s, x, clear, other);
}

bool hood_update(Hood *h, const Field *f, Vec2 s, const Boxtree *fresh)
{
    View old, v;
    view_init(&old, h, f->pos, s);
    Candidates c;
    candidates_init(&c);
    look_at_fresh(&old, f, fresh, &c);
    if (c.n == 0)
        return false;
    candidates_sort(&c);
    v.s = s;
    v.n = 0;
    v.n_witnesses = old.n_witnesses;
    for (uint32_t i = 0; i < old.n_witnesses; i++)
        v.w[i] = old.w[i];
    for (uint32_t i = 0; i < old.n; i++)
        if (!(c.gone >> i & 1))
            member_add(&v, &old.m[i]);
    for (uint32_t k = 0; k < c.n; k++) {
        if (c.at[k].barred || outdone(&c, k))
            continue;
        Neighbour other;
        if (candidate_taken(&old, f, &c, k, &other))
            witness_add(&v, &other);
        else
            member_add(&v, &c.at[k].x);
    }
    candidates_clear(&c);
    hood_store(h, &v);
    return true;
}
