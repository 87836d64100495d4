#include <stdlib.h>

#include "geom/segment.h"
#include "geom/turn.h"
#include "geom/winding_private.h"

enum { ROUNDS = 64, MAX_SLABS = 1 << 16, PER_EDGE = 8, SPARE = 4096, PAIRS = 500 };

/* An edge is divided at a node; where along it, from a to b. */
typedef struct {
    uint32_t edge, node;
    double at;
} Cut;

typedef struct {
    WindLines *w;
    GArray *cut;
    double near2;  /* squared; nearer to an edge a node lies on it */
    gsize most;    /* cuts; more are a tangle */
    guint64 pairs; /* that may still be looked at */
} Cutter;

static inline Vec2 node_at(const Cutter *c, uint32_t i) { return g_array_index(c->w->node, Vec2, i); }
static inline const WindEdge *edge_at(const Cutter *c, uint32_t i) { return &g_array_index(c->w->edge, WindEdge, i); }

/* ---- two edges ---- */

static void add_cut(Cutter *c, uint32_t edge, uint32_t node)
{
    Vec2 a = node_at(c, edge_at(c, edge)->a), b = node_at(c, edge_at(c, edge)->b);
    Cut cut = {edge, node, vec_dot(vec_sub(node_at(c, node), a), vec_sub(b, a))};
    g_array_append_val(c->cut, cut);
}

static bool cut_where_near(Cutter *c, uint32_t edge, uint32_t node)
{
    const WindEdge *e = edge_at(c, edge);
    if (node == e->a || node == e->b)
        return false;
    Vec2 a = node_at(c, e->a), b = node_at(c, e->b), q = node_at(c, node);
    double t = segment_nearest(a, b, q);
    if (!(t > 0.0 && t < 1.0 && segment_dist2(a, b, q) < c->near2))
        return false;
    add_cut(c, edge, node);
    return true;
}

static double to_unit(const WindLines *w, double x) { return floor(x / w->unit + 0.5) * w->unit; }

static void cut_pair(Cutter *c, uint32_t i, uint32_t j)
{
    WindEdge e = *edge_at(c, i), f = *edge_at(c, j);
    bool met = cut_where_near(c, i, f.a);
    met |= cut_where_near(c, i, f.b);
    met |= cut_where_near(c, j, e.a);
    met |= cut_where_near(c, j, e.b);
    if (met || e.a == f.a || e.a == f.b || e.b == f.a || e.b == f.b)
        return;
    Vec2 a = node_at(c, e.a), b = node_at(c, e.b), p = node_at(c, f.a), q = node_at(c, f.b);
    if (turn_sign(a, b, p) * turn_sign(a, b, q) >= 0 || turn_sign(p, q, a) * turn_sign(p, q, b) >= 0)
        return;
    Vec2 ab = vec_sub(b, a), pq = vec_sub(q, p);
    double t = vec_cross(vec_sub(p, a), pq) / vec_cross(ab, pq);
    Vec2 at = vec_lerp(a, b, t >= 0.0 && t <= 1.0 ? t : 0.5); /* nearly parallel lines' rounding */
    at = vec2(to_unit(c->w, at.x), to_unit(c->w, at.y));
    uint32_t k = c->w->node->len, from = MIN(MIN(g_array_index(c->w->source, uint32_t, e.a), g_array_index(c->w->source, uint32_t, e.b)),
                                             MIN(g_array_index(c->w->source, uint32_t, f.a), g_array_index(c->w->source, uint32_t, f.b)));
    g_array_append_val(c->w->node, at);
    g_array_append_val(c->w->source, from);
    add_cut(c, i, k);
    add_cut(c, j, k);
}

/* ---- all pairs: a sweep from left to right in each of many slabs ---- */

typedef struct {
    double x0, x1, y0, y1;
    uint32_t edge;
} Span;

typedef struct {
    Box2 box;
    double scale; /* slabs per unit of y */
    uint32_t n, *start, *item;
} Slabs;

static uint32_t slab_of(const Slabs *s, double y)
{
    double t = (y - s->box.y0) * s->scale;
    return !(t > 0.0) ? 0 : t >= s->n ? s->n - 1 : (uint32_t)t;
}

static Span span_of(const Cutter *c, uint32_t edge)
{
    const WindEdge *e = edge_at(c, edge);
    Box2 b = box_grow(box_add(box_add(box_empty(), node_at(c, e->a)), node_at(c, e->b)), c->w->unit);
    return (Span){b.x0, b.x1, b.y0, b.y1, edge};
}

static guint64 count_items(const Slabs *s, const Span *span, uint32_t n)
{
    guint64 total = 0;
    for (uint32_t i = 0; i < n; i++)
        total += 1 + slab_of(s, span[i].y1) - slab_of(s, span[i].y0);
    return total;
}

/* As many slabs as keep the lists short, but no more than tall edges allow. */
static void slabs_init(Slabs *s, const Span *span, uint32_t n)
{
    *s = (Slabs){.box = box_empty(), .n = CLAMP(n / 2, 1, MAX_SLABS)};
    for (uint32_t i = 0; i < n; i++)
        s->box = box_add(box_add(s->box, vec2(span[i].x0, span[i].y0)), vec2(span[i].x1, span[i].y1));
    s->scale = s->n / (s->box.y1 - s->box.y0);
    while (s->n > 1 && count_items(s, span, n) > 8 * (guint64)n + 64) {
        s->n /= 2;
        s->scale = s->n / (s->box.y1 - s->box.y0);
    }
    s->start = g_new0(uint32_t, (gsize)s->n + 2);
    s->item = g_new(uint32_t, count_items(s, span, n));
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = slab_of(s, span[i].y0); k <= slab_of(s, span[i].y1); k++)
            s->start[k + 2]++;
    for (uint32_t k = 0; k <= s->n; k++)
        s->start[k + 1] += s->start[k];
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = slab_of(s, span[i].y0); k <= slab_of(s, span[i].y1); k++)
            s->item[s->start[k + 1]++] = i;
}

static int by_left(const void *a, const void *b)
{
    const Span *s = a, *t = b;
    return s->x0 != t->x0 ? (s->x0 < t->x0 ? -1 : 1) : (s->edge > t->edge) - (s->edge < t->edge);
}

/* A pair is looked at in the slab where the upper one begins. */
static bool sweep_slab(Cutter *c, const Slabs *s, uint32_t slab, Span *here, uint32_t n)
{
    if (n > 1) /* of none there is no array */
        qsort(here, n, sizeof *here, by_left);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = i + 1; k < n && here[k].x0 <= here[i].x1; k++) {
            const Span *a = &here[i], *b = &here[k];
            if (a->y0 > b->y1 || b->y0 > a->y1 || slab_of(s, MAX(a->y0, b->y0)) != slab)
                continue;
            cut_pair(c, MIN(a->edge, b->edge), MAX(a->edge, b->edge));
            if (c->cut->len > c->most || c->pairs-- == 0)
                return false;
        }
    return true;
}

static bool find_cuts(Cutter *c)
{
    uint32_t n = c->w->edge->len;
    Span *span = g_new(Span, n), *here = g_new(Span, n);
    for (uint32_t i = 0; i < n; i++)
        span[i] = span_of(c, i);
    Slabs s;
    slabs_init(&s, span, n);
    bool ok = true;
    for (uint32_t k = 0; ok && k < s.n; k++) {
        for (uint32_t i = s.start[k]; i < s.start[k + 1]; i++)
            here[i - s.start[k]] = span[s.item[i]];
        ok = sweep_slab(c, &s, k, here, s.start[k + 1] - s.start[k]);
    }
    g_free(s.start);
    g_free(s.item);
    g_free(span);
    g_free(here);
    return ok;
}

/* ---- dividing ---- */

static int by_edge(const void *a, const void *b)
{
    const Cut *s = a, *t = b;
    if (s->edge != t->edge)
        return s->edge < t->edge ? -1 : 1;
    return s->at != t->at ? (s->at < t->at ? -1 : 1) : (s->node > t->node) - (s->node < t->node);
}

static void put_edge(GArray *edges, uint32_t from, uint32_t to, int32_t turns)
{
    WindEdge e = {MIN(from, to), MAX(from, to), from < to ? turns : -turns};
    if (from != to)
        g_array_append_val(edges, e);
}

static void divide(Cutter *c)
{
    GArray *edges = g_array_sized_new(FALSE, FALSE, sizeof(WindEdge), c->w->edge->len + c->cut->len);
    if (c->cut->len > 1)
        qsort(c->cut->data, c->cut->len, sizeof(Cut), by_edge);
    for (uint32_t i = 0, k = 0; i < c->w->edge->len; i++) {
        const WindEdge *e = edge_at(c, i);
        uint32_t last = e->a;
        for (; k < c->cut->len && g_array_index(c->cut, Cut, k).edge == i; k++) {
            put_edge(edges, last, g_array_index(c->cut, Cut, k).node, e->turns);
            last = g_array_index(c->cut, Cut, k).node;
        }
        put_edge(edges, last, e->b, e->turns);
    }
    g_array_unref(c->w->edge);
    c->w->edge = edges;
}

/* ---- joining what is in one place ---- */

static int by_place(const void *a, const void *b, void *nodes)
{
    uint32_t i = *(const uint32_t *)a, j = *(const uint32_t *)b;
    Vec2 p = ((const Vec2 *)nodes)[i], q = ((const Vec2 *)nodes)[j];
    if (p.x != q.x)
        return p.x < q.x ? -1 : 1;
    return p.y != q.y ? (p.y < q.y ? -1 : 1) : (i > j) - (i < j);
}

/* Nodes in one place become the first of them; the others stay, without edges. */
static bool join_nodes(WindLines *w)
{
    uint32_t n = w->node->len, *order = g_new(uint32_t, n), *now = g_new(uint32_t, n);
    Vec2 *p = (Vec2 *)(void *)w->node->data;
    bool any = false;
    for (uint32_t i = 0; i < n; i++)
        order[i] = i;
    g_qsort_with_data(order, (gint)n, sizeof *order, by_place, p);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t *source = &g_array_index(w->source, uint32_t, order[i]), before = i ? order[i - 1] : order[i];
        bool same = i > 0 && p[before].x == p[order[i]].x && p[before].y == p[order[i]].y;
        now[order[i]] = same ? now[before] : order[i];
        any |= same;
        uint32_t *kept = &g_array_index(w->source, uint32_t, now[order[i]]);
        *kept = MIN(*kept, *source);
    }
    GArray *edges = g_array_sized_new(FALSE, FALSE, sizeof(WindEdge), w->edge->len);
    for (uint32_t i = 0; i < w->edge->len; i++) {
        WindEdge e = g_array_index(w->edge, WindEdge, i);
        put_edge(edges, now[e.a], now[e.b], e.turns);
    }
    g_array_unref(w->edge);
    w->edge = edges;
    g_free(order);
    g_free(now);
    return any;
}

static int by_ends(const void *a, const void *b)
{
    const WindEdge *e = a, *f = b;
    return e->a != f->a ? (e->a < f->a ? -1 : 1) : e->b != f->b ? (e->b < f->b ? -1 : 1) : 0; /* equals are summed, in whatever order */
}

static bool join_edges(WindLines *w)
{
    WindEdge *e = (WindEdge *)(void *)w->edge->data;
    uint32_t n = w->edge->len, kept = 0;
    if (n > 1)
        qsort(e, n, sizeof *e, by_ends);
    for (uint32_t i = 0, k; i < n; i = k) {
        WindEdge sum = e[i];
        for (k = i + 1; k < n && e[k].a == e[i].a && e[k].b == e[i].b; k++)
            sum.turns += e[k].turns;
        if (sum.turns != 0)
            e[kept++] = sum;
    }
    g_array_set_size(w->edge, kept);
    return kept != n;
}

bool winding_split(WindLines *w, bool *clean)
{
    bool joined = join_nodes(w);
    *clean = !join_edges(w) && !joined;
    Cutter c = {.w = w, .cut = g_array_new(FALSE, FALSE, sizeof(Cut)), .near2 = 0.5625 * w->unit * w->unit};
    c.most = PER_EDGE * (gsize)w->edge->len + SPARE;
    c.pairs = PAIRS * (guint64)c.most;
    bool ok = true, going = w->edge->len > 0;
    for (int round = 0; ok && going; round++) {
        g_array_set_size(c.cut, 0);
        ok = find_cuts(&c) && round < ROUNDS && w->edge->len <= c.most;
        going = ok && c.cut->len > 0;
        if (going) {
            *clean = false;
            divide(&c);
            join_nodes(w);
            join_edges(w);
        }
    }
    g_array_unref(c.cut);
    return ok;
}
