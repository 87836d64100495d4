#include "sim/width.h"

#include <glib.h>

#include "geom/dmath.h"

enum { NONE = UINT32_MAX, RANKS = 250 };

/* A branch is a primary too when it leaves within this part of the leaf length from a first node … */
static const double primary_reach = 0.06;
/* … and begins at least this wide, as part of the vein it leaves. */
static const double primary_width = 0.45;

WidthDef width_def_default(void)
{
    return (WidthDef){.exponent = 2.0, .minimum = 0.5, .thickening = 0.0, .rank_ratio = 0.6};
}

/* Edges by node, as chains through `next`. */
typedef struct {
    uint32_t *first, *next; /* [nodes], [edges] */
} Chains;

static Chains chains_new(const Network *net, const uint32_t *by)
{
    Chains c = {g_new(uint32_t, net->n_nodes), g_new(uint32_t, net->n_edges)};
    for (uint32_t v = 0; v < net->n_nodes; v++)
        c.first[v] = NONE;
    for (uint32_t e = net->n_edges; e-- > 0;) { /* backwards, so that a chain runs forwards */
        c.next[e] = c.first[by[e]];
        c.first[by[e]] = e;
    }
    return c;
}

static void chains_free(Chains c)
{
    g_free(c.first);
    g_free(c.next);
}

/* Index order is a topological order, so one pass from the youngest node to the oldest hands every flow down. With `extra` > 0
 * veins of order 1 and 2 gain that much at each node. */
static void assign_flow(Network *net, Chains in, Chains out, double extra)
{
    for (uint32_t v = net->n_nodes; v-- > 0;) {
        uint32_t parents = 0;
        double sum = 0.0;
        for (uint32_t e = in.first[v]; e != NONE; e = in.next[e])
            parents++;
        for (uint32_t e = out.first[v]; e != NONE; e = out.next[e])
            sum += net->flow[e];
        if (out.first[v] == NONE)
            sum = (double)parents; /* a free end: every vein that comes here ends as a veinlet */
        for (uint32_t e = in.first[v]; e != NONE; e = in.next[e])
            net->flow[e] = sum / (double)parents + (net->order[e] == 1 || net->order[e] == 2 ? extra : 0.0);
    }
}

static void assign_width(Network *net, const WidthDef *def)
{
    double last_flow = -1.0, last_width = 0.0; /* neighbours on a vein mostly share their flow: one power for a run */
    for (uint32_t e = 0; e < net->n_edges; e++) {
        if (net->flow[e] != last_flow) {
            last_flow = net->flow[e];
            last_width = def->minimum * dmath_pow(last_flow, 1.0 / def->exponent);
        }
        net->width[e] = last_width;
    }
}

/* The child that continues a vein: the one of greatest flow, the oldest of equals. */
static uint32_t continuation(const Network *net, Chains out, uint32_t v)
{
    uint32_t best = NONE;
    for (uint32_t e = out.first[v]; e != NONE; e = out.next[e])
        if (net->kind[e] == EDGE_VEIN && (best == NONE || net->flow[e] > net->flow[best]))
            best = e;
    return best;
}

/* The edge that a node was born at the end of; NONE for a first node. */
static uint32_t grown_from(const Network *net, Chains in, uint32_t v)
{
    uint32_t e = in.first[v];
    while (e != NONE && net->kind[e] != EDGE_VEIN)
        e = in.next[e];
    return e;
}

static void start_vein(Network *net, uint32_t e, uint8_t order)
{
    net->vein[e] = net->n_veins++;
    net->order[e] = order;
}

/* Veins and orders by hierarchy. root[v] is the first node of v's tree while it is near enough for primaries, else NONE. */
static void assign_orders(Network *net, Chains in, Chains out, const uint32_t *root, double exponent)
{
    double least = dmath_pow(primary_width, exponent);
    net->n_veins = 0;
    for (uint32_t v = 0; v < net->n_nodes; v++) {
        uint32_t main = continuation(net, out, v), entry = grown_from(net, in, v);
        for (uint32_t e = out.first[v]; e != NONE; e = out.next[e]) {
            if (net->kind[e] != EDGE_VEIN)
                continue;
            if (entry == NONE) {
                bool primary = e == main || net->flow[e] >= least * net->flow[main];
                start_vein(net, e, primary ? 1 : 2);
            } else if (e == main) {
                net->vein[e] = net->vein[entry];
                net->order[e] = net->order[entry];
            } else if (net->order[entry] == 1 && root[v] != NONE && net->flow[e] >= least * net->flow[entry]) {
                start_vein(net, e, 1);
            } else {
                start_vein(net, e, (uint8_t)MIN(net->order[entry] + 1, 250));
            }
        }
    }
}

/* What an anastomosis takes from its ends: the higher (finer) of what the veins that lead there have. */
static uint8_t of_ends(const Network *net, Chains in, uint32_t e, const uint8_t *what)
{
    const uint32_t end[2] = {net->tail[e], net->head[e]};
    uint8_t most = 1;
    for (int i = 0; i < 2; i++)
        for (uint32_t k = in.first[end[i]]; k != NONE; k = in.next[k])
            if (net->kind[k] == EDGE_VEIN)
                most = MAX(most, what[k]);
    return most;
}

/* Orders of anastomoses; `of`: not of those that were drawn. */
static void assign_anastomoses(Network *net, Chains in, const uint32_t *of)
{
    for (uint32_t e = 0; e < net->n_edges; e++)
        if (net->kind[e] == EDGE_ANASTOMOSIS && !(of && of[e] != NONE))
            start_vein(net, e, of_ends(net, in, e, net->order));
}

/* Renumbers ranks so that none between 1 and the greatest is without an edge. */
static void close_ranks(Network *net)
{
    uint8_t name[RANKS + 1] = {0}, next = 1;
    for (uint32_t e = 0; e < net->n_edges; e++)
        name[net->rank[e]] = 1;
    for (uint32_t k = 0; k <= RANKS; k++)
        if (name[k])
            name[k] = next++;
    for (uint32_t e = 0; e < net->n_edges; e++)
        net->rank[e] = name[net->rank[e]];
}

static void rank_veins(Network *net, Chains in, Chains out, double ratio)
{
    double widest = 0.0;
    for (uint32_t e = 0; e < net->n_edges; e++)
        widest = MAX(widest, net->width[e]);
    for (uint32_t v = 0; v < net->n_nodes; v++) {
        uint32_t entry = grown_from(net, in, v);
        for (uint32_t e = out.first[v]; e != NONE; e = out.next[e]) {
            if (net->kind[e] != EDGE_VEIN)
                continue;
            if (entry == NONE) {
                net->rank[e] = 1;
            } else if (net->vein[e] == net->vein[entry] || net->order[e] == 1 || net->width[e] >= ratio * net->width[entry]) {
                net->rank[e] = net->rank[entry];
            } else {
                uint8_t class = 1;
                for (double w = widest * ratio; net->width[e] < w && class < RANKS; w *= ratio)
                    class++;
                uint8_t lower = (uint8_t)MIN(net->rank[entry] + 1, RANKS);
                net->rank[e] = class > lower ? class : lower;
            }
        }
    }
}

static void assign_ranks(Network *net, Chains in, Chains out, double ratio)
{
    rank_veins(net, in, out, ratio);
    for (uint32_t e = 0; e < net->n_edges; e++)
        if (net->kind[e] == EDGE_ANASTOMOSIS)
            net->rank[e] = of_ends(net, in, e, net->rank);
    close_ranks(net);
}

void network_assign_ranks(Network *net, const WidthDef *def)
{
    Chains in = chains_new(net, net->head), out = chains_new(net, net->tail);
    assign_ranks(net, in, out, def->rank_ratio);
    chains_free(in);
    chains_free(out);
}

/* First node of each node's tree, or NONE once farther from it than `reach`. */
static uint32_t *roots_near(const Network *net, Chains in, double reach)
{
    uint32_t *root = g_new(uint32_t, net->n_nodes);
    for (uint32_t v = 0; v < net->n_nodes; v++) {
        root[v] = in.first[v] == NONE ? v : NONE;
        for (uint32_t e = in.first[v]; e != NONE; e = in.next[e])
            if (net->kind[e] == EDGE_VEIN && root[net->tail[e]] != NONE &&
                vec_dist2(net->node[v], net->node[root[net->tail[e]]]) <= reach * reach)
                root[v] = root[net->tail[e]];
    }
    return root;
}

void network_assign_widths(Network *net, const WidthDef *def)
{
    Chains in = chains_new(net, net->head), out = chains_new(net, net->tail);
    double length = net->margin ? net->margin->box.y1 - net->margin->box.y0 : 0.0;
    uint32_t *root = roots_near(net, in, primary_reach * length);
    for (uint32_t e = 0; e < net->n_edges; e++)
        net->order[e] = 0;
    assign_flow(net, in, out, 0.0);
    assign_orders(net, in, out, root, def->exponent);
    if (def->thickening > 0.0)
        assign_flow(net, in, out, def->thickening);
    assign_width(net, def);
    assign_ranks(net, in, out, def->rank_ratio);
    assign_anastomoses(net, in, NULL);
    g_free(root);
    chains_free(in);
    chains_free(out);
}

/* ---- drawn veins ---- */

/* The drawn edge that each edge of net is, NONE for those that grew. */
static uint32_t *drawn_edges(const Network *net, const Network *drawn, const uint32_t *given)
{
    uint32_t *of = g_new(uint32_t, MAX(net->n_edges, 1)), *name = g_new(uint32_t, MAX(net->n_nodes, 1));
    Chains in = chains_new(drawn, drawn->head);
    for (uint32_t v = 0; v < net->n_nodes; v++)
        name[v] = NONE;
    for (uint32_t v = 0; v < drawn->n_nodes; v++)
        if (given[v] != NONE)
            name[given[v]] = v;
    for (uint32_t e = 0; e < net->n_edges; e++) {
        uint32_t a = name[net->tail[e]], b = name[net->head[e]];
        of[e] = NONE;
        for (int way = 0; way < 2 && a != NONE && b != NONE; way++) /* an anastomosis may have been turned round */
            for (uint32_t d = in.first[way ? a : b]; d != NONE && of[e] == NONE; d = in.next[d])
                if (drawn->tail[d] == (way ? b : a) && drawn->kind[d] == net->kind[e])
                    of[e] = d;
    }
    chains_free(in);
    g_free(name);
    return of;
}

/* Orders and veins of what grew, from those of what was drawn. */
static void derive_orders(Network *net, Chains in, Chains out, const uint32_t *of, const uint32_t *flow_vein)
{
    for (uint32_t v = 0; v < net->n_nodes; v++) {
        uint32_t entry = grown_from(net, in, v);
        bool goes_on = false; /* the vein that led here is drawn beyond, too */
        for (uint32_t e = out.first[v]; e != NONE && entry != NONE; e = out.next[e])
            goes_on |= of[e] != NONE && net->kind[e] == EDGE_VEIN && net->vein[e] == net->vein[entry];
        for (uint32_t e = out.first[v]; e != NONE; e = out.next[e]) {
            if (of[e] != NONE || net->kind[e] != EDGE_VEIN)
                continue;
            if (entry == NONE) {
                start_vein(net, e, net->order[e]);
            } else if (!goes_on && flow_vein[e] == flow_vein[entry]) {
                net->vein[e] = net->vein[entry];
                net->order[e] = net->order[entry];
            } else {
                start_vein(net, e, (uint8_t)MIN(net->order[entry] + 1, 250));
            }
        }
    }
}

/* Along each vein from its base, widths of what grew stay within that of what it grew from. */
static void limit_widths(Network *net, Chains in, Chains out, const uint32_t *of)
{
    for (uint32_t v = 0; v < net->n_nodes; v++) {
        uint32_t entry = grown_from(net, in, v);
        for (uint32_t e = out.first[v]; e != NONE && entry != NONE; e = out.next[e])
            if (of[e] == NONE)
                net->width[e] = MIN(net->width[e], net->width[entry]);
    }
}

void network_keep_drawn(Network *net, const WidthDef *def, const Network *drawn, const uint32_t *given)
{
    Chains in = chains_new(net, net->head), out = chains_new(net, net->tail);
    uint32_t *of = drawn_edges(net, drawn, given), *flow_vein = g_memdup2(net->vein, sizeof *net->vein * net->n_edges);
    net->n_veins = drawn->n_veins;
    for (uint32_t e = 0; e < net->n_edges; e++) {
        if (of[e] == NONE)
            continue;
        net->order[e] = drawn->order[of[e]];
        net->vein[e] = drawn->vein[of[e]];
        if (drawn->width[of[e]] > 0.0)
            net->width[e] = drawn->width[of[e]];
    }
    derive_orders(net, in, out, of, flow_vein);
    limit_widths(net, in, out, of);
    assign_anastomoses(net, in, of);
    assign_ranks(net, in, out, def->rank_ratio);
    g_free(of);
    g_free(flow_vein);
    chains_free(in);
    chains_free(out);
}
