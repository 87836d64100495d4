/* Opens a venation graph along its growth parents into a forest of vein sequences (Hong 2005, § 6.1). */
#include "shape/skeleton_private.h"

/* The edges that grew a node, by node: `up` the one that leads to it, `first` and `next` those that leave it. */
typedef struct {
    uint32_t *up;          /* [nodes] NONE: a first node */
    uint32_t *first;       /* [nodes] */
    uint32_t *next;        /* [edges] */
} Tree;

static void tree_clear(Tree *t)
{
    g_free(t->up);
    g_free(t->first);
    g_free(t->next);
}

/* ---- checks ---- */

static gboolean check_nodes(const Network *net, GError **error)
{
    for (uint32_t v = 0; v < net->n_nodes; v++)
        if (!isfinite(net->node[v].x) || !isfinite(net->node[v].y)) {
            g_set_error(error, SKELETON_ERROR, SKELETON_ERROR_GRAPH, "node %u lies at (%g, %g); positions must be finite", v, net->node[v].x,
                        net->node[v].y);
            return FALSE;
        }
    return TRUE;
}

static gboolean check_edge(const Network *net, uint32_t e, GError **error)
{
    uint32_t t = net->tail[e], h = net->head[e];
    if (t >= net->n_nodes || h >= net->n_nodes) {
        g_set_error(error, SKELETON_ERROR, SKELETON_ERROR_GRAPH, "edge %u runs from node %u to node %u; there are nodes 0 to %u only", e, t, h,
                    net->n_nodes - 1);
        return FALSE;
    }
    if (net->kind[e] == EDGE_ANASTOMOSIS)
        return TRUE;
    if (!(vec_dist2(net->node[t], net->node[h]) > 0.0)) {
        g_set_error(error, SKELETON_ERROR, SKELETON_ERROR_GRAPH, "edge %u from node %u to node %u has no length; both lie at (%g, %g)", e, t, h,
                    net->node[t].x, net->node[t].y);
        return FALSE;
    }
    if (net->order[e] == 0) {
        g_set_error(error, SKELETON_ERROR, SKELETON_ERROR_GRAPH, "edge %u from node %u to node %u has order 0; orders begin with 1, a primary", e, t,
                    h);
        return FALSE;
    }
    if (!(net->width[e] >= 0.0 && net->width[e] < HUGE_VAL)) {
        g_set_error(error, SKELETON_ERROR, SKELETON_ERROR_GRAPH, "edge %u from node %u to node %u is %g wide; widths are finite and not below 0", e,
                    t, h, net->width[e]);
        return FALSE;
    }
    return TRUE;
}

static gboolean cycle_error(const Network *net, const uint32_t *waits, GError **error)
{
    uint32_t v = 0;
    while (waits[v] == 0)
        v++;
    /* Of a node that waits one edge at least comes from a node that waits: so many steps back lead into a cycle. */
    uint32_t *from = g_new(uint32_t, net->n_nodes);
    for (uint32_t e = net->n_edges; e-- > 0;)
        if (net->kind[e] != EDGE_ANASTOMOSIS && waits[net->tail[e]] > 0)
            from[net->head[e]] = e;
    for (uint32_t k = 0; k < net->n_nodes; k++)
        v = net->tail[from[v]];
    uint32_t e = from[v];
    g_set_error(error, SKELETON_ERROR, SKELETON_ERROR_GRAPH,
                "edge %u from node %u to node %u closes a cycle; veins must branch like a tree, with edges where they meet marked as anastomoses", e,
                net->tail[e], net->head[e]);
    g_free(from);
    return FALSE;
}

/* Takes nodes away whose edges all come from nodes taken away already; a cycle stays. */
static gboolean check_cycles(const Network *net, const Tree *out, GError **error)
{
    bool sorted = true; /* as every grown network is */
    for (uint32_t e = 0; e < net->n_edges && sorted; e++)
        sorted = net->kind[e] == EDGE_ANASTOMOSIS || net->tail[e] < net->head[e];
    if (sorted)
        return TRUE;
    uint32_t *waits = g_new0(uint32_t, net->n_nodes), *queue = g_new(uint32_t, net->n_nodes), n = 0;
    for (uint32_t e = 0; e < net->n_edges; e++)
        if (net->kind[e] != EDGE_ANASTOMOSIS)
            waits[net->head[e]]++;
    for (uint32_t v = 0; v < net->n_nodes; v++)
        if (waits[v] == 0)
            queue[n++] = v;
    for (uint32_t k = 0; k < n; k++)
        for (uint32_t e = out->first[queue[k]]; e != NONE; e = out->next[e])
            if (--waits[net->head[e]] == 0)
                queue[n++] = net->head[e];
    gboolean ok = n == net->n_nodes || cycle_error(net, waits, error);
    g_free(waits);
    g_free(queue);
    return ok;
}

/* Edge lists by tail, and of the edges that lead to a node the widest (of equals the first) as the one that grew it: the others end at their
 * tails, as anastomoses do. */
static gboolean tree_open(Tree *t, const Network *net, GError **error)
{
    t->up = g_new(uint32_t, net->n_nodes);
    t->first = g_new(uint32_t, net->n_nodes);
    t->next = g_new(uint32_t, net->n_edges);
    for (uint32_t v = 0; v < net->n_nodes; v++)
        t->up[v] = t->first[v] = NONE;
    for (uint32_t e = net->n_edges; e-- > 0;) { /* backwards, so that lists run forwards */
        if (net->kind[e] == EDGE_ANASTOMOSIS)
            continue;
        uint32_t *up = &t->up[net->head[e]];
        if (*up == NONE || net->width[e] >= net->width[*up])
            *up = e;
        t->next[e] = t->first[net->tail[e]];
        t->first[net->tail[e]] = e;
    }
    return check_cycles(net, t, error);
}

/* ---- following veins ---- */

/* A vein that begins: with its first edge, at a point of a trail. */
typedef struct {
    uint32_t edge, parent, leaves;
} Bud;

typedef struct {
    const Network *net;
    Tree tree;
    uint32_t max_order;
    double min_length, turn;
    GArray *trail, *point, *along, *width, *bud; /* Trail, Vec2, double, double, Bud */
    GArray *edge; /* uint32_t, of the trail that is being followed */
} Opening;

static bool grew(const Opening *o, uint32_t e) { return o->tree.up[o->net->head[e]] == e; }

/* The edge that goes on with the vein of edge e: the widest of its vein that leaves e's head, of equals the first. */
static uint32_t next_of_vein(const Opening *o, uint32_t e)
{
    uint32_t best = NONE;
    for (uint32_t k = o->tree.first[o->net->head[e]]; k != NONE; k = o->tree.next[k])
        if (o->net->vein[k] == o->net->vein[e] && grew(o, k) && (best == NONE || o->net->width[k] > o->net->width[best]))
            best = k;
    return best;
}

static void add_point(Opening *o, Vec2 p, double along, double width)
{
    g_array_append_val(o->point, p);
    g_array_append_val(o->along, along);
    g_array_append_val(o->width, width);
}

/* Buds at the points of the trail that was followed last, but for its first. */
static void add_buds(Opening *o, uint32_t trail)
{
    for (uint32_t i = 0; i < o->edge->len; i++) {
        uint32_t e = g_array_index(o->edge, uint32_t, i), on = i + 1 < o->edge->len ? g_array_index(o->edge, uint32_t, i + 1) : NONE;
        for (uint32_t k = o->tree.first[o->net->head[e]]; k != NONE; k = o->tree.next[k])
            if (k != on && grew(o, k) && o->net->order[k] <= o->max_order)
                g_array_append_val(o->bud, ((Bud){k, trail, i + 1}));
    }
}

/* The edges of a vein from its first one on, up to where it is farthest from its start when it turns back from there; returns their length. */
static double list_edges(Opening *o, uint32_t first)
{
    const Network *net = o->net;
    Vec2 start = net->node[net->tail[first]];
    double length = 0.0, there = 0.0, far = 0.0;
    uint32_t n = 0;
    g_array_set_size(o->edge, 0);
    for (uint32_t e = first; e != NONE; e = next_of_vein(o, e)) {
        Vec2 p = net->node[net->head[e]];
        double d = vec_dist(start, p);
        g_array_append_val(o->edge, e);
        length += vec_dist(net->node[net->tail[e]], p);
        if (d >= far) {
            far = d;
            there = length;
            n = o->edge->len;
        } else if (d < far - o->turn) {
            g_array_set_size(o->edge, n);
            return there;
        }
    }
    return length;
}

/* Follows a vein from its first edge; false when it is too short. */
static bool follow(Opening *o, Bud bud)
{
    const Network *net = o->net;
    double length = list_edges(o, bud.edge);
    if (!(length >= o->min_length))
        return false;
    Trail t = {.parent = bud.parent, .leaves = bud.leaves, .first = o->point->len, .n = o->edge->len + 1, .vein = net->vein[bud.edge],
               .order = net->order[bud.edge], .length = length};
    add_point(o, net->node[net->tail[bud.edge]], 0.0, net->width[bud.edge]);
    length = 0.0;
    for (uint32_t i = 0; i < o->edge->len; i++) {
        uint32_t e = g_array_index(o->edge, uint32_t, i);
        length += vec_dist(net->node[net->tail[e]], net->node[net->head[e]]);
        add_point(o, net->node[net->head[e]], length, net->width[e]);
    }
    add_buds(o, o->trail->len);
    g_array_append_val(o->trail, t);
    return true;
}

static gint by_order_and_width(gconstpointer a, gconstpointer b, gpointer user)
{
    const Network *net = user;
    uint32_t e = *(const uint32_t *)a, f = *(const uint32_t *)b;
    if (net->order[e] != net->order[f])
        return net->order[e] < net->order[f] ? -1 : 1;
    if (net->width[e] != net->width[f])
        return net->width[e] > net->width[f] ? -1 : 1;
    return (e > f) - (e < f);
}

/* Veins that begin at a first node: the primaries stand for themselves; the others, when there is a primary or one that takes its
 * place, leave it at its first point. */
static void follow_first(Opening *o, uint32_t v, GArray *edge)
{
    uint32_t lead = NONE;
    g_array_set_size(edge, 0);
    for (uint32_t e = o->tree.first[v]; e != NONE; e = o->tree.next[e])
        if (grew(o, e) && o->net->order[e] <= o->max_order)
            g_array_append_val(edge, e);
    g_array_sort_with_data(edge, by_order_and_width, (gpointer)o->net);
    for (uint32_t i = 0; i < edge->len; i++) {
        uint32_t e = g_array_index(edge, uint32_t, i), index = o->trail->len;
        bool kept = follow(o, (Bud){e, o->net->order[e] == 1 ? NONE : lead, 0});
        if (kept && lead == NONE)
            lead = index;
    }
}

static Trails *finish(Opening *o)
{
    Trails *t = g_new0(Trails, 1);
    t->n = o->trail->len;
    t->trail = (Trail *)(void *)g_array_free(o->trail, FALSE);
    t->point = (Vec2 *)(void *)g_array_free(o->point, FALSE);
    t->along = (double *)(void *)g_array_free(o->along, FALSE);
    t->width = (double *)(void *)g_array_free(o->width, FALSE);
    g_array_free(o->bud, TRUE);
    g_array_free(o->edge, TRUE);
    return t;
}

static gboolean check_network(const Network *net, GError **error)
{
    if (net->n_nodes == 0 || net->n_edges == 0) {
        g_set_error_literal(error, SKELETON_ERROR, SKELETON_ERROR_EMPTY, "the network has no veins");
        return FALSE;
    }
    if (!check_nodes(net, error))
        return FALSE;
    for (uint32_t e = 0; e < net->n_edges; e++)
        if (!check_edge(net, e, error))
            return FALSE;
    return TRUE;
}

Trails *trails_new(const Network *net, uint32_t max_order, double min_length, double turn, GError **error)
{
    if (!check_network(net, error))
        return NULL;
    Opening o = {.net = net, .max_order = max_order, .min_length = min_length, .turn = turn};
    if (!tree_open(&o.tree, net, error)) {
        tree_clear(&o.tree);
        return NULL;
    }
    o.trail = g_array_new(FALSE, FALSE, sizeof(Trail));
    o.point = g_array_new(FALSE, FALSE, sizeof(Vec2));
    o.along = g_array_new(FALSE, FALSE, sizeof(double));
    o.width = g_array_new(FALSE, FALSE, sizeof(double));
    o.bud = g_array_new(FALSE, FALSE, sizeof(Bud));
    o.edge = g_array_new(FALSE, FALSE, sizeof(uint32_t));
    GArray *spare = g_array_new(FALSE, FALSE, sizeof(uint32_t));
    for (uint32_t v = 0; v < net->n_nodes; v++)
        if (o.tree.up[v] == NONE && o.tree.first[v] != NONE)
            follow_first(&o, v, spare);
    g_array_free(spare, TRUE);
    for (uint32_t i = 0; i < o.bud->len; i++)
        follow(&o, g_array_index(o.bud, Bud, i));
    tree_clear(&o.tree);
    return finish(&o);
}

void trails_free(Trails *t)
{
    if (!t)
        return;
    g_free(t->trail);
    g_free(t->point);
    g_free(t->along);
    g_free(t->width);
    g_free(t);
}
