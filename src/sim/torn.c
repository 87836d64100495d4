#include "sim/torn.h"

#include <glib.h>
#include <string.h>

enum { NONE = UINT32_MAX };

/* Segments: shorter pieces are not worth a node, and would fall together when a file rounds them. */
static const double least_piece = 1e-3;
/* Segments: so near the rim of a hole an end was made by it. */
static const double at_rim = 1e-2;

/* ---- tearing ---- */

/* What is left of an edge, part by part. */
typedef struct {
    uint32_t edge;
    Stretch part;
} Piece;

typedef struct {
    const Network *net;
    GArray *piece;    /* Piece, in the order of edges */
    bool *stays;      /* [nodes] */
    uint32_t *before; /* [nodes] new nodes that stand just before it: after the tails of the edges that lead to it, so that index order holds */
    uint32_t *name;   /* [nodes] its number in the result */
    uint32_t *next;   /* [nodes] number of the next of those before it */
} Tearing;

static void find_pieces(Tearing *t, const HoleRings *rings)
{
    const Network *net = t->net;
    GArray *part = g_array_new(FALSE, FALSE, sizeof(Stretch));
    bool *bare = g_new(bool, net->n_nodes + 1);
    memset(bare, true, net->n_nodes);
    for (uint32_t e = 0; e < net->n_edges; e++) {
        bare[net->tail[e]] = bare[net->head[e]] = false;
        g_array_set_size(part, 0);
        hole_rings_outside(rings, net->node[net->tail[e]], net->node[net->head[e]], least_piece, part);
        for (guint i = 0; i < part->len; i++) {
            Piece p = {e, g_array_index(part, Stretch, i)};
            g_array_append_val(t->piece, p);
            bool begins = p.part.from == 0.0, ends = p.part.to == 1.0;
            t->stays[net->tail[e]] |= begins;
            t->stays[net->head[e]] |= ends;
            t->before[net->head[e]] += !begins + !ends;
        }
    }
    for (uint32_t v = 0; v < net->n_nodes; v++)
        t->stays[v] |= bare[v];
    g_array_unref(part);
    g_free(bare);
}

/* Returns how many nodes there are. */
static uint32_t number_nodes(Tearing *t)
{
    uint32_t n = 0;
    for (uint32_t v = 0; v < t->net->n_nodes; v++) {
        t->next[v] = n;
        n += t->before[v];
        t->name[v] = t->stays[v] ? n++ : NONE;
    }
    return n;
}

/* The node where a piece of an edge begins or ends. */
static uint32_t node_at(Tearing *t, Network *out, uint32_t e, double part)
{
    const Network *net = t->net;
    if (part == 0.0 || part == 1.0)
        return t->name[part == 0.0 ? net->tail[e] : net->head[e]];
    uint32_t v = t->next[net->head[e]]++;
    out->node[v] = vec_lerp(net->node[net->tail[e]], net->node[net->head[e]], part);
    out->node_birth[v] = net->node_birth[net->head[e]];
    return v;
}

/* Numbers of veins without gaps, in their order. */
static void close_gaps(Network *net, uint32_t n_before)
{
    uint32_t *number = g_new0(uint32_t, (gsize)n_before + 1);
    for (uint32_t e = 0; e < net->n_edges; e++)
        number[net->vein[e]] = 1;
    for (uint32_t k = 0, n = 0; k < n_before; k++) {
        n += number[k];
        number[k] = n - 1; /* of those that are not there it is not asked */
        net->n_veins = n;
    }
    for (uint32_t e = 0; e < net->n_edges; e++)
        net->vein[e] = number[net->vein[e]];
    g_free(number);
}

static Network *build(Tearing *t)
{
    const Network *net = t->net;
    Network *out = network_new(number_nodes(t), t->piece->len);
    out->n_steps = net->n_steps;
    out->length = net->length;
    out->margin = polygon_new(net->margin->v, net->margin->n);
    for (uint32_t v = 0; v < net->n_nodes; v++)
        if (t->stays[v]) {
            out->node[t->name[v]] = net->node[v];
            out->node_birth[t->name[v]] = net->node_birth[v];
        }
    for (uint32_t k = 0; k < out->n_edges; k++) {
        const Piece *p = &g_array_index(t->piece, Piece, k);
        uint32_t e = p->edge;
        out->tail[k] = node_at(t, out, e, p->part.from);
        out->head[k] = node_at(t, out, e, p->part.to);
        out->birth[k] = net->birth[e];
        out->kind[k] = net->kind[e];
        out->flow[k] = net->flow[e];
        out->width[k] = net->width[e];
        out->order[k] = net->order[e];
        out->rank[k] = net->rank[e];
        out->vein[k] = net->vein[e];
    }
    close_gaps(out, net->n_veins);
    return out;
}

static bool whole(const Tearing *t)
{
    bool all = t->piece->len == t->net->n_edges;
    for (guint i = 0; i < t->piece->len && all; i++) {
        const Piece *p = &g_array_index(t->piece, Piece, i);
        all = p->part.from == 0.0 && p->part.to == 1.0;
    }
    return all;
}

Network *network_tear(Network *net, Holes *holes)
{
    uint32_t n = net->n_nodes + 1;
    Tearing t = {net, g_array_new(FALSE, FALSE, sizeof(Piece)), g_new0(bool, n), g_new0(uint32_t, n), g_new(uint32_t, n), g_new(uint32_t, n)};
    HoleRings rings;
    hole_rings_init(&rings, holes);
    find_pieces(&t, &rings);
    hole_rings_clear(&rings);
    Network *out = net;
    if (t.piece->len == 0 && net->n_edges > 0) { /* no vein is left: a bare blade has one node */
        out = network_new(1, 0);
        out->n_steps = net->n_steps;
        out->length = net->length;
        out->margin = polygon_new(net->margin->v, net->margin->n);
    } else if (!whole(&t)) {
        out = build(&t);
    }
    if (out != net)
        network_free(net);
    holes_free(out->holes);
    out->holes = holes->n > 0 ? holes : NULL;
    if (holes->n == 0)
        holes_free(holes);
    g_array_unref(t.piece);
    g_free(t.stays);
    g_free(t.before);
    g_free(t.name);
    g_free(t.next);
    return out;
}

/* ---- tying ---- */

/* An end of veins at the rim of a hole. */
typedef struct {
    uint32_t node, hole;
    uint32_t edge; /* of a beginning the widest that leaves it, of an end the one that leads there */
} End;

static uint32_t hole_at(const HoleRings *rings, Vec2 p)
{
    for (uint32_t k = 0; k < rings->n; k++)
        if (box_has(box_grow(rings->ring[k]->box, at_rim), p) && vec_dist(polygon_nearest(rings->ring[k], p, NULL), p) <= at_rim)
            return k;
    return NONE;
}

/* Ends and beginnings, each in index order. */
static void find_ends(const Network *net, GArray *end, GArray *begin)
{
    uint32_t *entry = g_new(uint32_t, net->n_nodes + 1), *way_on = g_new(uint32_t, net->n_nodes + 1);
    HoleRings rings;
    hole_rings_init(&rings, net->holes);
    for (uint32_t v = 0; v < net->n_nodes; v++)
        entry[v] = way_on[v] = NONE;
    for (uint32_t e = 0; e < net->n_edges; e++) {
        uint32_t *on = &way_on[net->tail[e]];
        if (net->kind[e] != EDGE_VEIN)
            continue;
        entry[net->head[e]] = e;
        if (*on == NONE || net->width[e] > net->width[*on])
            *on = e;
    }
    for (uint32_t v = 0; v < net->n_nodes; v++) {
        bool ends = entry[v] != NONE && way_on[v] == NONE, begins = entry[v] == NONE && way_on[v] != NONE;
        End here = {v, ends || begins ? hole_at(&rings, net->node[v]) : NONE, ends ? entry[v] : way_on[v]};
        if (here.hole != NONE)
            g_array_append_val(ends ? end : begin, here);
    }
    hole_rings_clear(&rings);
    g_free(entry);
    g_free(way_on);
}

/* The end that a beginning hangs on; NULL: there is none. */
static const End *end_for(const Network *net, const GArray *end, const End *begin)
{
    const End *best = NULL;
    bool own = false;
    for (guint i = 0; i < end->len; i++) {
        const End *e = &g_array_index(end, End, i);
        if (e->hole != begin->hole || e->node >= begin->node || !(vec_dist2(net->node[e->node], net->node[begin->node]) > 0.0))
            continue;
        bool same = net->vein[e->edge] == net->vein[begin->edge];
        bool nearer = !best || vec_dist2(net->node[e->node], net->node[begin->node]) < vec_dist2(net->node[best->node], net->node[begin->node]);
        if (same == own ? nearer : same) {
            best = e;
            own = same;
        }
    }
    return best;
}

#define COPY(to, from, array, n) memcpy((to)->array, (from)->array, (n) * sizeof *(from)->array)

static Network *with_room(const Network *net, uint32_t more)
{
    Network *out = network_new(net->n_nodes, net->n_edges + more);
    out->n_veins = net->n_veins;
    out->n_steps = net->n_steps;
    out->length = net->length;
    out->margin = polygon_new(net->margin->v, net->margin->n);
    COPY(out, net, node, net->n_nodes);
    COPY(out, net, node_birth, net->n_nodes);
    COPY(out, net, tail, net->n_edges);
    COPY(out, net, head, net->n_edges);
    COPY(out, net, birth, net->n_edges);
    COPY(out, net, kind, net->n_edges);
    COPY(out, net, flow, net->n_edges);
    COPY(out, net, width, net->n_edges);
    COPY(out, net, order, net->n_edges);
    COPY(out, net, rank, net->n_edges);
    COPY(out, net, vein, net->n_edges);
    out->n_edges = net->n_edges;
    return out;
}

Network *network_tied(const Network *net)
{
    if (!net->holes)
        return NULL;
    GArray *end = g_array_new(FALSE, FALSE, sizeof(End)), *begin = g_array_new(FALSE, FALSE, sizeof(End));
    find_ends(net, end, begin);
    Network *out = with_room(net, begin->len);
    for (guint i = 0; i < begin->len; i++) {
        const End *b = &g_array_index(begin, End, i), *from = end_for(net, end, b);
        if (!from)
            continue;
        uint32_t e = out->n_edges++, as = b->edge;
        out->tail[e] = from->node;
        out->head[e] = b->node;
        out->birth[e] = net->birth[as];
        out->kind[e] = EDGE_VEIN;
        out->flow[e] = net->flow[as];
        out->width[e] = net->width[as];
        out->order[e] = net->order[as];
        out->rank[e] = net->rank[as];
        out->vein[e] = net->vein[as];
    }
    g_array_unref(end);
    g_array_unref(begin);
    if (out->n_edges > net->n_edges)
        return out;
    network_free(out);
    return NULL;
}
