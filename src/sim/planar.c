#include "sim/planar.h"

#include <glib.h>
#include <string.h>

#include "geom/segment.h"
#include "geom/turn.h"
#include "sim/edge_grid.h"
#include "sim/edge_order.h"

enum { ROUNDS = 16, TANGLE = 8 };

/* A node on an edge. */
typedef struct {
    uint32_t edge, node;
    double along; /* 0 … 1 */
} Split;

typedef struct {
    uint32_t i, j; /* edges, i < j */
} Crossing;

typedef struct {
    GArray *node;      /* Vec2 */
    uint32_t *order;   /* [nodes] */
    uint32_t *same;    /* [nodes] a node of lower index in the same place, or the node itself; roots are lowest */
    uint32_t (*edge)[2];
    uint32_t n_edges;
    double near2;      /* squared distance at which a node lies on an edge */
    GArray *split, *crossing;
    GArray *fresh;     /* [nodes] uint8_t: has it, or what runs into it, changed since it was looked at? */
    gsize most;        /* crossings */
    bool changed;
} Cutter;

static Vec2 place(const Cutter *c, uint32_t v) { return ((const Vec2 *)(const void *)c->node->data)[v]; }

static uint32_t root(uint32_t *same, uint32_t v)
{
    while (same[v] != v)
        v = same[v] = same[same[v]];
    return v;
}

static void unite(Cutter *c, uint32_t a, uint32_t b)
{
    a = root(c->same, a);
    b = root(c->same, b);
    c->same[MAX(a, b)] = MIN(a, b);
    ((uint8_t *)c->fresh->data)[MIN(a, b)] = TRUE;
    c->changed = true;
}

/* ---- what is near what ---- */

/* Whether node v lies on edge i, which it is no end of, both numbered as in `o`; notes what to do about it. */
static bool touch(Cutter *c, const EdgeOrder *o, uint32_t i, uint32_t v)
{
    uint32_t a = o->edge[i][0], b = o->edge[i][1];
    Vec2 pa = o->node[a], pb = o->node[b], p = o->node[v];
    if (segment_dist2(pa, pb, p) > c->near2)
        return false;
    if (vec_dist2(p, pa) <= c->near2) {
        unite(c, o->was[v], o->was[a]);
    } else if (vec_dist2(p, pb) <= c->near2) {
        unite(c, o->was[v], o->was[b]);
    } else {
        Split s = {o->was_edge[i], o->was[v], segment_nearest(pa, pb, p)};
        g_array_append_val(c->split, s);
        ((uint8_t *)c->fresh->data)[s.node] = TRUE;
        c->changed = true;
    }
    return true;
}

static bool apart(const Cutter *c, Vec2 a, Vec2 b, Vec2 p, Vec2 q)
{
    double near = sqrt(c->near2);
    return MAX(a.x, b.x) + near < MIN(p.x, q.x) || MAX(p.x, q.x) + near < MIN(a.x, b.x) || MAX(a.y, b.y) + near < MIN(p.y, q.y) ||
           MAX(p.y, q.y) + near < MIN(a.y, b.y);
}

static void meet(Cutter *c, const EdgeOrder *o, uint32_t i, uint32_t j)
{
    const uint32_t *e = o->edge[i], *f = o->edge[j];
    Vec2 a = o->node[e[0]], b = o->node[e[1]], p = o->node[f[0]], q = o->node[f[1]];
    bool shared = e[0] == f[0] || e[0] == f[1] || e[1] == f[0] || e[1] == f[1], touched = false;
    if (apart(c, a, b, p, q))
        return;
    for (int k = 0; k < 2; k++) {
        touched |= f[k] != e[0] && f[k] != e[1] && touch(c, o, i, f[k]);
        touched |= e[k] != f[0] && e[k] != f[1] && touch(c, o, j, e[k]);
    }
    if (touched || shared || turn_sign(a, b, p) * turn_sign(a, b, q) >= 0 || turn_sign(p, q, a) * turn_sign(p, q, b) >= 0)
        return;
    uint32_t one = o->was_edge[i], other = o->was_edge[j];
    Crossing x = {MIN(one, other), MAX(one, other)};
    g_array_append_val(c->crossing, x);
    c->changed = true;
}

/* Does an edge of the grid run near the box of edge ab? Those of a row of cells follow one another. */
static bool beside(const EdgeGrid *g, Vec2 a, Vec2 b, double pad)
{
    uint32_t x0 = edge_grid_column(g, MIN(a.x, b.x) - pad), x1 = edge_grid_column(g, MAX(a.x, b.x) + pad);
    uint32_t y0 = edge_grid_row(g, MIN(a.y, b.y) - pad), y1 = edge_grid_row(g, MAX(a.y, b.y) + pad);
    for (uint32_t y = y0; y <= y1; y++)
        if (g->start[(gsize)y * g->nx + x0] < g->start[(gsize)y * g->nx + x1 + 1])
            return true;
    return false;
}

/* Puts aside which edges are worth a look: fresh ones and what is beside them. Returns how many there are; list[i] is c->edge[was[i]]. */
static uint32_t choose(const Cutter *c, uint32_t (*list)[2], uint32_t *was)
{
    const Vec2 *node = (const Vec2 *)(const void *)c->node->data;
    const uint8_t *fresh = (const uint8_t *)c->fresh->data;
    uint32_t n = 0;
    EdgeGrid g;
    for (uint32_t e = 0; e < c->n_edges; e++)
        if (fresh[c->edge[e][0]] || fresh[c->edge[e][1]])
            memcpy(list[n++], c->edge[e], sizeof *list);
    edge_grid_init(&g, node, (const uint32_t (*)[2])list, n, sqrt(c->near2));
    n = 0;
    for (uint32_t e = 0; e < c->n_edges; e++)
        if (beside(&g, node[c->edge[e][0]], node[c->edge[e][1]], sqrt(c->near2) + 1e-9 * g.cell)) {
            was[n] = e;
            memcpy(list[n++], c->edge[e], sizeof *list);
        }
    edge_grid_clear(&g);
    return n;
}

static int by_number(gconstpointer x, gconstpointer y, gpointer user)
{
    uint32_t a = *(const uint32_t *)x, b = *(const uint32_t *)y;
    return (a > b) - (a < b);
}

/* The nodes of n edges, each once. */
static uint32_t *list_ends(const uint32_t (*edge)[2], uint32_t n, uint32_t *n_ends)
{
    uint32_t *end = g_new(uint32_t, 2 * (gsize)n + 1), count = 0;
    memcpy(end, edge, n * sizeof *edge);
    if (n > 0)
        g_qsort_with_data(end, (gint)(2 * n), sizeof *end, by_number, NULL);
    for (uint32_t i = 0; i < 2 * n; i++)
        if (count == 0 || end[i] != end[count - 1])
            end[count++] = end[i];
    *n_ends = count;
    return end;
}

static void look_around(Cutter *c, const EdgeOrder *o)
{
    EdgeGrid g;
    edge_grid_init(&g, o->node, (const uint32_t (*)[2])o->edge, o->n_edges, sqrt(c->near2));
    gsize cells = (gsize)g.nx * g.ny;
    for (gsize k = 0; k < cells && c->crossing->len <= c->most; k++)
        for (uint32_t i = g.start[k]; i < g.start[k + 1] && c->crossing->len <= c->most; i++)
            for (uint32_t j = i + 1; j < g.start[k + 1]; j++)
                meet(c, o, g.item[i], g.item[j]);
    edge_grid_clear(&g);
}

/* At all edges, or at what has changed. FALSE for a tangle. */
static bool look(Cutter *c, bool all)
{
    const Vec2 *node = (const Vec2 *)(const void *)c->node->data;
    uint32_t *end = NULL;
    EdgeOrder o;
    if (all) {
        edge_order_init(&o, c->order, c->node->len, node, c->node->len, (const uint32_t (*)[2])c->edge, c->n_edges);
    } else {
        uint32_t (*list)[2] = g_malloc_n((gsize)c->n_edges + 1, sizeof *list), *was = g_new(uint32_t, (gsize)c->n_edges + 1), n_ends;
        uint32_t n = choose(c, list, was);
        end = list_ends((const uint32_t (*)[2])list, n, &n_ends);
        edge_order_init(&o, end, n_ends, node, c->node->len, (const uint32_t (*)[2])list, n);
        for (uint32_t i = 0; i < n; i++)
            o.was_edge[i] = was[o.was_edge[i]];
        g_free(list);
        g_free(was);
    }
    c->changed = false;
    if (c->fresh->len > 0)
        memset(c->fresh->data, FALSE, c->fresh->len);
    look_around(c, &o);
    edge_order_clear(&o);
    g_free(end);
    return c->crossing->len <= c->most;
}

/* ---- cutting ---- */

static int by_edges(gconstpointer x, gconstpointer y, gpointer user)
{
    const Crossing *a = x, *b = y;
    return a->i != b->i ? (a->i > b->i) - (a->i < b->i) : (a->j > b->j) - (a->j < b->j);
}

static int by_place(gconstpointer x, gconstpointer y, gpointer user)
{
    const Split *a = x, *b = y;
    if (a->edge != b->edge)
        return a->edge < b->edge ? -1 : 1;
    if (a->along != b->along)
        return a->along < b->along ? -1 : 1;
    return (a->node > b->node) - (a->node < b->node);
}

static void add_crossing(Cutter *c, Crossing x)
{
    Vec2 a = place(c, c->edge[x.i][0]), p = place(c, c->edge[x.j][0]);
    Vec2 d = vec_sub(place(c, c->edge[x.i][1]), a), e = vec_sub(place(c, c->edge[x.j][1]), p), ap = vec_sub(p, a);
    double across = vec_cross(d, e);
    if (across == 0.0)
        return;
    double s = CLAMP(vec_cross(ap, e) / across, 0.0, 1.0), t = CLAMP(vec_cross(ap, d) / across, 0.0, 1.0);
    Vec2 at = vec_add(a, vec_scale(d, s));
    Split one = {x.i, c->node->len, s}, two = {x.j, c->node->len, t};
    g_array_append_val(c->node, at);
    g_array_append_val(c->split, one);
    g_array_append_val(c->split, two);
}

static void add_crossings(Cutter *c)
{
    GArray *all = c->crossing;
    uint32_t before = c->node->len;
    if (all->len > 0)
        g_qsort_with_data(all->data, (gint)all->len, sizeof(Crossing), by_edges, NULL);
    for (guint k = 0; k < all->len; k++) /* edges may meet in several cells */
        if (k == 0 || by_edges(&g_array_index(all, Crossing, k - 1), &g_array_index(all, Crossing, k), NULL) != 0)
            add_crossing(c, g_array_index(all, Crossing, k));
    c->same = g_renew(uint32_t, c->same, (gsize)c->node->len + 1);
    c->order = g_renew(uint32_t, c->order, (gsize)c->node->len + 1);
    g_array_set_size(c->fresh, c->node->len);
    for (uint32_t v = before; v < c->node->len; v++) {
        c->same[v] = c->order[v] = v;
        ((uint8_t *)c->fresh->data)[v] = TRUE;
    }
    g_array_set_size(all, 0);
}

static void divide(Cutter *c)
{
    GArray *all = c->split;
    uint32_t (*edge)[2] = g_malloc_n((gsize)c->n_edges + all->len + 1, sizeof *edge), n = 0;
    guint k = 0;
    if (all->len > 0)
        g_qsort_with_data(all->data, (gint)all->len, sizeof(Split), by_place, NULL);
    for (uint32_t e = 0; e < c->n_edges; e++) {
        uint32_t from = c->edge[e][0];
        for (; k < all->len && g_array_index(all, Split, k).edge == e; k++) {
            edge[n][0] = from;
            edge[n++][1] = from = g_array_index(all, Split, k).node;
        }
        edge[n][0] = from;
        edge[n++][1] = c->edge[e][1];
    }
    g_array_set_size(all, 0);
    g_free(c->edge);
    c->edge = edge;
    c->n_edges = n;
}

/* ---- order ---- */

/* Sorts edges by one of their ends, otherwise leaving their order. */
static void sort_by_end(Cutter *c, int end)
{
    uint32_t *start = g_new0(uint32_t, (gsize)c->node->len + 1), (*edge)[2] = g_malloc_n((gsize)c->n_edges + 1, sizeof *edge);
    for (uint32_t e = 0; e < c->n_edges; e++)
        start[c->edge[e][end] + 1]++;
    for (guint v = 0; v < c->node->len; v++)
        start[v + 1] += start[v];
    for (uint32_t e = 0; e < c->n_edges; e++)
        memcpy(edge[start[c->edge[e][end]]++], c->edge[e], sizeof *edge);
    g_free(start);
    g_free(c->edge);
    c->edge = edge;
}

/* Ends become the nodes that stand for them. Edges without length or that are there already go. */
static void tidy(Cutter *c)
{
    uint32_t n = 0;
    for (guint v = 0; v < c->fresh->len; v++)
        if (c->fresh->data[v])
            c->fresh->data[root(c->same, v)] = TRUE;
    for (uint32_t e = 0; e < c->n_edges; e++) {
        uint32_t a = root(c->same, c->edge[e][0]), b = root(c->same, c->edge[e][1]);
        if (a == b)
            continue;
        c->edge[n][0] = MIN(a, b);
        c->edge[n++][1] = MAX(a, b);
    }
    c->n_edges = n;
    sort_by_end(c, 1);
    sort_by_end(c, 0);
    n = 0;
    for (uint32_t e = 0; e < c->n_edges; e++)
        if (n == 0 || memcmp(c->edge[n - 1], c->edge[e], sizeof *c->edge) != 0)
            memmove(c->edge[n++], c->edge[e], sizeof *c->edge);
    c->n_edges = n;
}

static void cutter_init(Cutter *c, const Network *net)
{
    Box2 box = box_empty();
    *c = (Cutter){.n_edges = net->n_edges, .most = (gsize)TANGLE * net->n_edges + 64};
    c->node = g_array_sized_new(FALSE, FALSE, sizeof(Vec2), net->n_nodes);
    g_array_append_vals(c->node, net->node, net->n_nodes);
    c->split = g_array_new(FALSE, FALSE, sizeof(Split));
    c->crossing = g_array_new(FALSE, FALSE, sizeof(Crossing));
    c->fresh = g_array_sized_new(FALSE, TRUE, 1, net->n_nodes);
    g_array_set_size(c->fresh, net->n_nodes);
    c->order = edge_order_nodes(net->node, net->n_nodes);
    c->same = g_new(uint32_t, (gsize)net->n_nodes + 1);
    for (uint32_t v = 0; v < net->n_nodes; v++) {
        c->same[v] = v;
        box = box_add(box, net->node[v]);
    }
    double near = net->n_nodes > 0 ? 1e-10 * MAX(box.x1 - box.x0, box.y1 - box.y0) : 0.0;
    c->near2 = near * near;
    c->edge = g_malloc_n((gsize)net->n_edges + 1, sizeof *c->edge);
    for (uint32_t e = 0; e < net->n_edges; e++) {
        c->edge[e][0] = net->tail[e];
        c->edge[e][1] = net->head[e];
    }
}

Planar *planar_new(const Network *net)
{
    Cutter c;
    cutter_init(&c, net);
    tidy(&c);
    bool fine = true;
    /* new nodes are rounded, and where many edges cross that may make them cross anew */
    for (int round = 0; (fine = look(&c, round == 0)) && c.changed && round < ROUNDS; round++) {
        add_crossings(&c);
        divide(&c);
        tidy(&c);
    }
    Planar *p = NULL;
    if (fine) {
        p = g_new0(Planar, 1);
        p->n_nodes = c.node->len;
        p->n_edges = c.n_edges;
        p->edge = g_steal_pointer(&c.edge);
        p->order = g_steal_pointer(&c.order);
        p->node = (Vec2 *)(void *)g_array_free(g_steal_pointer(&c.node), FALSE);
    }
    if (c.node)
        g_array_free(c.node, TRUE);
    g_array_free(c.split, TRUE);
    g_array_free(c.crossing, TRUE);
    g_array_free(c.fresh, TRUE);
    g_free(c.edge);
    g_free(c.same);
    g_free(c.order);
    return p;
}

void planar_free(Planar *p)
{
    if (!p)
        return;
    g_free(p->node);
    g_free(p->edge);
    g_free(p->order);
    g_free(p);
}
