#include "sim/areole.h"

#include <glib.h>
#include <string.h>

#include "geom/turn.h"
#include "sim/edge_grid.h"
#include "sim/edge_order.h"
#include "sim/planar.h"

enum { NONE = 0xFFFFFFFFu, BRIDGE = 0xFFFFFFFEu };

/* Each edge twice, once each way: 2e from its first node on, 2e + 1 back. The walk with the face to the left goes on from the head of a half-edge
 * with the next one clockwise from the way back. */
typedef struct {
    const Vec2 *node;
    const uint32_t (*edge)[2];
    uint32_t n_nodes, n_edges;
    const uint32_t *was; /* [nodes] a node's number in the planar graph */
    uint32_t *first;  /* [nodes + 1] into out and around: half-edges that leave a node */
    uint32_t *out;
    uint32_t *around; /* counter-clockwise */
    uint32_t *spot;   /* [half-edges] place in around */
    uint32_t *walk;   /* [half-edges] the walk it is of; BRIDGE: it is let go */
    uint32_t n_walks;
    uint32_t *start;  /* [walks] first half-edge in order of tail and head */
    double *area;     /* [walks] positive: it goes around its face; negative: it goes around what lies in its face */
} Faces;

static uint32_t tail_of(const Faces *f, uint32_t h) { return f->edge[h / 2][h % 2]; }
static uint32_t head_of(const Faces *f, uint32_t h) { return f->edge[h / 2][1 - h % 2]; }

/* A half-edge's rank: by its tail, then its head, as the planar graph numbers them. */
static uint64_t rank_of(const Faces *f, uint32_t h) { return (uint64_t)f->was[tail_of(f, h)] << 32 | f->was[head_of(f, h)]; }

/* ---- tracing ---- */

static void list_out(Faces *f)
{
    uint32_t *first = f->first = g_new0(uint32_t, (gsize)f->n_nodes + 2);
    f->out = g_new(uint32_t, 2 * (gsize)f->n_edges + 1);
    first++; /* moves on while nodes fill, and then is what it should be */
    for (uint32_t h = 0; h < 2 * f->n_edges; h++)
        first[tail_of(f, h) + 1]++;
    for (uint32_t v = 0; v < f->n_nodes; v++)
        first[v + 1] += first[v];
    for (uint32_t h = 0; h < 2 * f->n_edges; h++)
        f->out[first[tail_of(f, h)]++] = h;
}

static int by_angle(gconstpointer x, gconstpointer y, gpointer user)
{
    const Faces *f = user;
    uint32_t h = *(const uint32_t *)x, k = *(const uint32_t *)y;
    Vec2 q = f->node[tail_of(f, h)], a = f->node[head_of(f, h)], b = f->node[head_of(f, k)];
    return turn_before(q, a, b) ? -1 : turn_before(q, b, a) ? 1 : (h > k) - (h < k);
}

/* Nearly all nodes have two or three edges; around two, either order is the same. */
static void sort_around(Faces *f, uint32_t *h, uint32_t n)
{
    enum { FEW = 8 };
    if (n > FEW)
        g_qsort_with_data(h, (gint)n, sizeof *h, by_angle, f);
    else if (n > 2)
        for (uint32_t i = 1; i < n; i++)
            for (uint32_t j = i; j > 0 && by_angle(&h[j - 1], &h[j], f) > 0; j--) {
                uint32_t swap = h[j];
                h[j] = h[j - 1];
                h[j - 1] = swap;
            }
}

static void turn_around(Faces *f)
{
    f->around = g_memdup2(f->out, (2 * (gsize)f->n_edges + 1) * sizeof *f->out);
    f->spot = g_new(uint32_t, 2 * (gsize)f->n_edges + 1);
    for (uint32_t v = 0; v < f->n_nodes; v++)
        sort_around(f, f->around + f->first[v], f->first[v + 1] - f->first[v]);
    for (uint32_t i = 0; i < 2 * f->n_edges; i++)
        f->spot[f->around[i]] = i;
}

static uint32_t next_of(const Faces *f, uint32_t h)
{
    uint32_t back = h ^ 1u, v = tail_of(f, back), i = f->spot[back];
    do
        i = i > f->first[v] ? i - 1 : f->first[v + 1] - 1;
    while (f->walk[f->around[i]] == BRIDGE);
    return f->around[i];
}

/* A walk by its first half-edge. */
typedef struct {
    uint64_t rank;
    uint32_t start, number;
    double area;
} Walk;

static int by_rank(gconstpointer x, gconstpointer y, gpointer user)
{
    const Walk *a = x, *b = y;
    return (a->rank > b->rank) - (a->rank < b->rank);
}

/* The area by the way's turns about its first node. */
static double area_of(const Faces *f, uint32_t start)
{
    Vec2 o = f->node[tail_of(f, start)];
    uint32_t h = start;
    double sum = 0.0;
    do {
        sum += vec_cross(vec_sub(f->node[tail_of(f, h)], o), vec_sub(f->node[head_of(f, h)], o));
        h = next_of(f, h);
    } while (h != start);
    return 0.5 * sum;
}

static Walk trace(Faces *f, uint32_t from, uint32_t number)
{
    Walk w = {rank_of(f, from), from, number, 0.0};
    uint32_t h = from;
    do {
        uint64_t rank = rank_of(f, h);
        f->walk[h] = number;
        if (rank < w.rank) {
            w.rank = rank;
            w.start = h;
        }
        h = next_of(f, h);
    } while (h != from);
    w.area = area_of(f, w.start);
    return w;
}

/* Walks are traced in the order that nodes have here, and numbered in that of the planar graph. */
static void trace_all(Faces *f)
{
    GArray *all = g_array_new(FALSE, FALSE, sizeof(Walk));
    for (uint32_t i = 0; i < 2 * f->n_edges; i++) {
        if (f->walk[f->out[i]] != NONE)
            continue;
        Walk w = trace(f, f->out[i], all->len);
        g_array_append_val(all, w);
    }
    if (all->len > 0)
        g_qsort_with_data(all->data, (gint)all->len, sizeof(Walk), by_rank, NULL);
    f->n_walks = all->len;
    f->start = g_new(uint32_t, (gsize)f->n_walks + 1);
    f->area = g_new(double, (gsize)f->n_walks + 1);
    uint32_t *number = g_new(uint32_t, (gsize)f->n_walks + 1);
    for (uint32_t k = 0; k < f->n_walks; k++) {
        const Walk *w = &g_array_index(all, Walk, k);
        number[w->number] = k;
        f->start[k] = w->start;
        f->area[k] = w->area;
    }
    for (uint32_t h = 0; h < 2 * f->n_edges; h++)
        if (f->walk[h] != BRIDGE)
            f->walk[h] = number[f->walk[h]];
    g_free(number);
    g_array_free(all, TRUE);
}

/* Takes away the edges that have one face on both sides; whether there were such. */
static bool drop_bridges(Faces *f)
{
    uint32_t e = 0;
    while (e < f->n_edges && f->walk[2 * e] != f->walk[2 * e + 1])
        e++;
    bool any = e < f->n_edges;
    for (e = 0; any && e < f->n_edges; e++)
        f->walk[2 * e] = f->walk[2 * e + 1] = f->walk[2 * e] == f->walk[2 * e + 1] ? BRIDGE : NONE;
    return any;
}

static void faces_init(Faces *f, const EdgeOrder *o)
{
    *f = (Faces){.node = o->node, .n_nodes = o->n_nodes, .edge = (const uint32_t (*)[2])o->edge, .n_edges = o->n_edges, .was = o->was};
    list_out(f);
    turn_around(f);
    f->walk = g_malloc(2 * (gsize)f->n_edges * sizeof *f->walk + 1);
    memset(f->walk, 0xFF, 2 * (gsize)f->n_edges * sizeof *f->walk);
    trace_all(f);
    if (drop_bridges(f)) {
        g_free(f->start);
        g_free(f->area);
        trace_all(f);
    }
}

static void faces_clear(Faces *f)
{
    g_free(f->first);
    g_free(f->out);
    g_free(f->around);
    g_free(f->spot);
    g_free(f->walk);
    g_free(f->start);
    g_free(f->area);
}

/* ---- islands ---- */

/* A walk around a separate net, and the net's node farthest to the left, which is on it. */
typedef struct {
    uint32_t walk;
    Vec2 left;
} Net;

static int from_left(gconstpointer x, gconstpointer y, gpointer user)
{
    const Net *a = x, *b = y;
    if (a->left.x != b->left.x)
        return a->left.x < b->left.x ? -1 : 1;
    return (a->walk > b->walk) - (a->walk < b->walk);
}

static Net net_of(const Faces *f, uint32_t walk)
{
    Net net = {walk, f->node[tail_of(f, f->start[walk])]};
    uint32_t h = f->start[walk];
    do {
        Vec2 p = f->node[tail_of(f, h)];
        if (p.x < net.left.x || (p.x == net.left.x && p.y < net.left.y))
            net.left = p;
        h = next_of(f, h);
    } while (h != f->start[walk]);
    return net;
}

/* An edge that a level line cuts: at x, and where two begin there, just above it. */
typedef struct {
    uint32_t down; /* its half-edge that goes down, NONE: no edge */
    Vec2 low, high;
    double x;
} Hit;

static void hit(const Faces *f, uint32_t e, Vec2 p, Hit *best)
{
    Vec2 a = f->node[f->edge[e][0]], b = f->node[f->edge[e][1]];
    bool up = a.y < b.y;
    Hit h = {2 * e + up, up ? a : b, up ? b : a, 0.0};
    if (f->walk[h.down] == BRIDGE || !(h.low.y <= p.y && p.y < h.high.y))
        return;
    h.x = h.low.x + (h.high.x - h.low.x) * ((p.y - h.low.y) / (h.high.y - h.low.y));
    if (!(h.x < p.x)) /* edges that begin at p among them */
        return;
    bool nearer = best->down == NONE || h.x > best->x;
    if (best->down != NONE && h.low.x == best->low.x && h.low.y == best->low.y)
        nearer = turn_sign(best->low, best->high, h.high) < 0;
    if (nearer)
        *best = h;
}

/* The walk to the right of the first edge to the left of p; NONE: there is no edge. */
static uint32_t walk_left_of(const Faces *f, const EdgeGrid *g, Vec2 p)
{
    Hit best = {.down = NONE};
    uint32_t row = edge_grid_row(g, p.y);
    for (uint32_t x = edge_grid_column(g, p.x) + 1; x-- > 0 && !(best.down != NONE && best.x > g->corner.x + (x + 1) * g->cell);)
        for (uint32_t i = g->start[row * g->nx + x]; i < g->start[row * g->nx + x + 1]; i++)
            hit(f, g->item[i], p, &best);
    return best.down == NONE ? NONE : f->walk[best.down];
}

/* For each walk around a net the walk around the face that the net lies in, NONE: none does. Walks around faces stand for themselves. */
static uint32_t *containers(const Faces *f)
{
    uint32_t *in = g_new(uint32_t, (gsize)f->n_walks + 1);
    GArray *net = g_array_new(FALSE, FALSE, sizeof(Net));
    for (uint32_t w = 0; w < f->n_walks; w++) {
        in[w] = f->area[w] > 0.0 ? w : NONE;
        if (f->area[w] > 0.0)
            continue;
        Net one = net_of(f, w);
        g_array_append_val(net, one);
    }
    if (net->len > 1) {
        EdgeGrid g;
        edge_grid_init(&g, f->node, f->edge, f->n_edges, 0.0);
        /* what lies to the left of a net's leftmost node is of nets further to the left, whose own place is known by then */
        g_qsort_with_data(net->data, (gint)net->len, sizeof(Net), from_left, NULL);
        for (guint i = 0; i < net->len; i++) {
            const Net *one = &g_array_index(net, Net, i);
            uint32_t w = walk_left_of(f, &g, one->left);
            in[one->walk] = w == NONE || w == one->walk ? NONE : in[w];
        }
        edge_grid_clear(&g);
    }
    g_array_free(net, TRUE);
    return in;
}

/* ---- the result ---- */

static void write_ring(const Faces *f, Areoles *a, uint32_t walk, uint32_t ring)
{
    uint32_t h = f->start[walk], n = a->ring[ring];
    do {
        a->node[n++] = f->was[tail_of(f, h)];
        h = next_of(f, h);
    } while (h != f->start[walk]);
    a->ring[ring + 1] = n;
}

static void collect(const Faces *f, Areoles *a)
{
    uint32_t *in = containers(f), *number = g_new(uint32_t, (gsize)f->n_walks + 1);
    for (uint32_t w = 0; w < f->n_walks; w++)
        number[w] = f->area[w] > 0.0 ? a->n++ : NONE;
    a->first = g_new0(uint32_t, (gsize)a->n + 2);
    for (uint32_t w = 0; w < f->n_walks; w++)
        if (in[w] != NONE)
            a->first[number[in[w]] + 2]++;
    for (uint32_t i = 0; i < a->n; i++)
        a->first[i + 2] += a->first[i + 1];
    a->n_rings = a->first[a->n + 1];
    uint32_t *walk = g_new(uint32_t, (gsize)a->n_rings + 1); /* of each ring: the face's own first, then islands in order */
    for (int own = 1; own >= 0; own--)
        for (uint32_t w = 0; w < f->n_walks; w++)
            if (in[w] != NONE && (in[w] == w) == (own == 1))
                walk[a->first[number[in[w]] + 1]++] = w;
    a->ring = g_new0(uint32_t, (gsize)a->n_rings + 1);
    a->node = g_new(uint32_t, 2 * (gsize)f->n_edges + 1);
    a->area = g_new0(double, (gsize)a->n + 1);
    for (uint32_t r = 0; r < a->n_rings; r++) {
        write_ring(f, a, walk[r], r);
        a->area[number[in[walk[r]]]] += f->area[walk[r]];
    }
    g_free(walk);
    g_free(number);
    g_free(in);
}

/* ---- holes ---- */

/* Is p in the areole: within an odd number of its rings? */
static bool encloses(const Areoles *a, const Vec2 *place, uint32_t k, Vec2 p)
{
    bool in = false;
    for (uint32_t r = a->first[k]; r < a->first[k + 1]; r++)
        for (uint32_t i = a->ring[r]; i < a->ring[r + 1]; i++) {
            Vec2 u = place[a->node[i]], v = place[a->node[i + 1 < a->ring[r + 1] ? i + 1 : a->ring[r]]];
            if ((u.y > p.y) != (v.y > p.y) && p.x < u.x + (v.x - u.x) * ((p.y - u.y) / (v.y - u.y)))
                in = !in;
        }
    return in;
}

/* The areoles that hold no hole. No vein crosses one, so each hole lies in one areole, or in none. O(holes · edges). */
static void drop_torn(Areoles *a, const Vec2 *place, const Holes *holes)
{
    bool *torn = g_new0(bool, (gsize)a->n + 1);
    for (uint32_t k = 0; k < holes->n; k++) {
        Vec2 p = holes_point(holes, k);
        for (uint32_t i = 0; i < a->n; i++)
            torn[i] = torn[i] || encloses(a, place, i, p);
    }
    uint32_t n = 0, rings = 0, nodes = 0;
    for (uint32_t i = 0; i < a->n; i++) {
        uint32_t from = a->first[i], to = a->first[i + 1]; /* what is written lies before what is read */
        if (torn[i])
            continue;
        a->area[n] = a->area[i];
        a->first[n++] = rings;
        for (uint32_t r = from; r < to; r++) {
            uint32_t first = a->ring[r], last = a->ring[r + 1];
            a->ring[rings++] = nodes;
            for (uint32_t j = first; j < last; j++)
                a->node[nodes++] = a->node[j];
        }
    }
    a->n = n;
    a->first[n] = a->n_rings = rings;
    a->ring[rings] = nodes;
    g_free(torn);
}

Areoles *network_areoles(const Network *net)
{
    Areoles *a = g_new0(Areoles, 1);
    Planar *p = planar_new(net);
    if (!p) {
        a->first = g_new0(uint32_t, 1);
        a->ring = g_new0(uint32_t, 1);
        return a;
    }
    EdgeOrder o;
    Faces f;
    edge_order_init(&o, p->node, p->n_nodes, (const uint32_t (*)[2])p->edge, p->n_edges);
    faces_init(&f, &o);
    collect(&f, a);
    faces_clear(&f);
    edge_order_clear(&o);
    a->n_places = p->n_nodes;
    a->place = g_steal_pointer(&p->node);
    if (net->holes)
        drop_torn(a, a->place, net->holes);
    planar_free(p);
    return a;
}

void areoles_free(Areoles *a)
{
    if (!a)
        return;
    g_free(a->first);
    g_free(a->ring);
    g_free(a->node);
    g_free(a->place);
    g_free(a->area);
    g_free(a);
}
