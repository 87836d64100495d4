#include "sim/areole.h"

#include <glib.h>
#include <string.h>

#include "geom/turn.h"
#include "sim/edge_grid.h"
#include "sim/faces.h"
#include "sim/planar.h"

enum { NONE = FACE_NONE };

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
    const Walk *w = &f->walk[walk];
    const Vec2 *node = f->order->node;
    Net net = {walk, node[f->tail[w->first]]};
    for (uint32_t i = 1; i < w->n; i++) {
        Vec2 p = node[f->tail[w->first + i]];
        if (p.x < net.left.x || (p.x == net.left.x && p.y < net.left.y))
            net.left = p;
    }
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
    const EdgeOrder *o = f->order;
    Vec2 a = o->node[o->edge[e][0]], b = o->node[o->edge[e][1]];
    bool up = a.y < b.y;
    Hit h = {2 * e + up, up ? a : b, up ? b : a, 0.0};
    if (f->mark[h.down] == FACE_BRIDGE || !(h.low.y <= p.y && p.y < h.high.y))
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
    return best.down == NONE ? NONE : f->rank[f->mark[best.down]];
}

/* For each walk around a net the walk around the face that the net lies in, NONE: none does. Walks around faces stand for themselves. */
static uint32_t *containers(const Faces *f)
{
    uint32_t *in = g_new(uint32_t, (gsize)f->n_walks + 1);
    GArray *net = g_array_new(FALSE, FALSE, sizeof(Net));
    for (uint32_t w = 0; w < f->n_walks; w++) {
        in[w] = f->walk[w].area > 0.0 ? w : NONE;
        if (f->walk[w].area > 0.0)
            continue;
        Net one = net_of(f, w);
        g_array_append_val(net, one);
    }
    if (net->len > 1) {
        EdgeGrid g;
        edge_grid_init(&g, f->order->node, (const uint32_t (*)[2])f->order->edge, f->order->n_edges, 0.0);
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

static void write_ring(const Faces *f, Areoles *a, const Walk *w, uint32_t ring)
{
    uint32_t n = a->ring[ring];
    for (uint32_t i = 0; i < w->n; i++) {
        uint32_t v = face_node(f, w, i);
        a->node[n] = f->order->was[v];
        a->at[n++] = f->order->node[v];
    }
    a->ring[ring + 1] = n;
}

static void collect(const Faces *f, Areoles *a)
{
    uint32_t *in = containers(f), *number = g_new(uint32_t, (gsize)f->n_walks + 1);
    gsize n = 0; /* nodes of all rings */
    for (uint32_t w = 0; w < f->n_walks; w++)
        number[w] = f->walk[w].area > 0.0 ? a->n++ : NONE;
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
    for (uint32_t r = 0; r < a->n_rings; r++)
        n += f->walk[walk[r]].n;
    a->node = g_new(uint32_t, n + 1);
    a->at = g_new(Vec2, n + 1);
    a->area = g_new0(double, (gsize)a->n + 1);
    for (uint32_t r = 0; r < a->n_rings; r++) {
        write_ring(f, a, &f->walk[walk[r]], r);
        a->area[number[in[walk[r]]]] += f->walk[walk[r]].area;
    }
    g_free(walk);
    g_free(number);
    g_free(in);
}

/* ---- holes ---- */

/* Is p in the areole: within an odd number of its rings? */
static bool encloses(const Areoles *a, uint32_t k, Vec2 p)
{
    bool in = false;
    for (uint32_t r = a->first[k]; r < a->first[k + 1]; r++)
        for (uint32_t i = a->ring[r]; i < a->ring[r + 1]; i++) {
            Vec2 u = a->at[i], v = a->at[i + 1 < a->ring[r + 1] ? i + 1 : a->ring[r]];
            if ((u.y > p.y) != (v.y > p.y) && p.x < u.x + (v.x - u.x) * ((p.y - u.y) / (v.y - u.y)))
                in = !in;
        }
    return in;
}

/* The areoles that hold no hole. No vein crosses one, so each hole lies in one areole, or in none. O(holes · edges). */
static void drop_torn(Areoles *a, const Holes *holes)
{
    bool *torn = g_new0(bool, (gsize)a->n + 1);
    for (uint32_t k = 0; k < holes->n; k++) {
        Vec2 p = holes_point(holes, k);
        for (uint32_t i = 0; i < a->n; i++)
            torn[i] = torn[i] || encloses(a, i, p);
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
            for (uint32_t j = first; j < last; j++, nodes++) {
                a->node[nodes] = a->node[j];
                a->at[nodes] = a->at[j];
            }
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
    edge_order_init(&o, p->order, p->n_nodes, p->node, p->n_nodes, (const uint32_t (*)[2])p->edge, p->n_edges);
    g_clear_pointer(&p->edge, g_free); /* of large networks it all takes much memory */
    g_clear_pointer(&o.was_edge, g_free);
    faces_init(&f, &o);
    collect(&f, a);
    faces_clear(&f);
    edge_order_clear(&o);
    a->n_places = p->n_nodes;
    a->place = g_steal_pointer(&p->node);
    if (net->holes)
        drop_torn(a, net->holes);
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
    g_free(a->at);
    g_free(a->area);
    g_free(a);
}
