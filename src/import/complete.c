/* What a file leaves out is made: births, widths, orders, ranks, veins. */
#include <string.h>

#include "geom/dmath.h"
#include "import/draft.h"

static bool all_edges(const Draft *d, FieldId field) { return d->given[field] == d->net->n_edges; }

/* Are the births of the file to be had, and no node older than the one its vein comes from? */
static bool births_hold(const Draft *d)
{
    const Network *net = d->net;
    bool hold = d->given[FIELD_NODE_BIRTH] == net->n_nodes;
    for (uint32_t e = 0; hold && e < net->n_edges; e++)
        hold = net->kind[e] != EDGE_VEIN || net->node_birth[net->tail[e]] <= net->node_birth[net->head[e]];
    return hold;
}

/* Births by depth, in edges. */
static void count_births(Network *net)
{
    uint32_t *parent = g_new(uint32_t, net->n_nodes);
    for (uint32_t v = 0; v < net->n_nodes; v++)
        parent[v] = NONE;
    for (uint32_t e = 0; e < net->n_edges; e++)
        if (net->kind[e] == EDGE_VEIN)
            parent[net->head[e]] = net->tail[e];
    for (uint32_t v = 0; v < net->n_nodes; v++)
        net->node_birth[v] = parent[v] == NONE ? 0 : net->node_birth[parent[v]] + 1;
    g_free(parent);
}

static gboolean complete_births(Draft *d, GError **error)
{
    Network *net = d->net;
    bool hold = births_hold(d);
    uint32_t last = 0;
    if (!hold)
        count_births(net);
    for (uint32_t v = 0; v < net->n_nodes; v++)
        last = MAX(last, net->node_birth[v]);
    for (uint32_t e = 0; e < net->n_edges; e++) {
        if (!hold || net->birth[e] == NONE)
            net->birth[e] = MAX(net->node_birth[net->tail[e]], net->node_birth[net->head[e]]);
        last = MAX(last, net->birth[e]);
    }
    if (hold && d->given[FIELD_STEPS] && net->n_steps < last)
        return draft_fail(d, 0, IMPORT_ERROR_GRAPH, error, "steps is %u, but the last birth is in step %u; steps must be at least that",
                          net->n_steps, last);
    if (!hold || !d->given[FIELD_STEPS])
        net->n_steps = last;
    return TRUE;
}

/* The edge that continues the vein of `entry` at its head: the widest of its order, the first of equals. */
static uint32_t continuation(const Network *net, const uint32_t *first, const uint32_t *next, uint32_t entry)
{
    uint32_t best = NONE;
    for (uint32_t e = first[net->head[entry]]; e != NONE; e = next[e])
        if (net->order[e] == net->order[entry] && (best == NONE || net->width[e] > net->width[best]))
            best = e;
    return best;
}

/* Veins by the orders: runs of edges of one order; an anastomosis is one of its own. */
static void follow_veins(Network *net)
{
    uint32_t *first = g_new(uint32_t, net->n_nodes), *next = g_new(uint32_t, net->n_edges); /* vein edges by tail */
    uint32_t *entry = g_new(uint32_t, net->n_nodes);
    for (uint32_t v = 0; v < net->n_nodes; v++)
        first[v] = entry[v] = NONE;
    for (uint32_t e = net->n_edges; e-- > 0;)
        if (net->kind[e] == EDGE_VEIN) {
            next[e] = first[net->tail[e]];
            first[net->tail[e]] = e;
            entry[net->head[e]] = e;
        }
    net->n_veins = 0;
    for (uint32_t v = 0; v < net->n_nodes; v++) {
        uint32_t main = entry[v] == NONE ? NONE : continuation(net, first, next, entry[v]);
        for (uint32_t e = first[v]; e != NONE; e = next[e])
            net->vein[e] = e == main ? net->vein[entry[v]] : net->n_veins++;
    }
    for (uint32_t e = 0; e < net->n_edges; e++)
        if (net->kind[e] != EDGE_VEIN)
            net->vein[e] = net->n_veins++;
    g_free(first);
    g_free(next);
    g_free(entry);
}

static int by_number(gconstpointer a, gconstpointer b, gpointer vein)
{
    uint32_t x = ((const uint32_t *)vein)[*(const uint32_t *)a], y = ((const uint32_t *)vein)[*(const uint32_t *)b];
    return (x > y) - (x < y);
}

/* Numbers the file's veins 0 … n_veins - 1, in their order, without gaps. */
static void close_gaps(Network *net)
{
    uint32_t *edge = g_new(uint32_t, net->n_edges), last = NONE;
    bool *used = g_new0(bool, net->n_edges), dense = true;
    for (uint32_t e = 0; e < net->n_edges; e++) {
        dense &= net->vein[e] < net->n_edges;
        if (dense)
            used[net->vein[e]] = true;
        edge[e] = e;
    }
    net->n_veins = 0;
    for (uint32_t k = 0; k < net->n_edges && dense; k++) {
        dense = !used[k] || k == net->n_veins;
        net->n_veins += used[k];
    }
    if (!dense) {
        g_qsort_with_data(edge, (gint)net->n_edges, sizeof *edge, by_number, net->vein);
        net->n_veins = 0;
        for (uint32_t k = 0; k < net->n_edges; k++) {
            uint32_t number = net->vein[edge[k]];
            net->n_veins += number != last;
            last = number;
            net->vein[edge[k]] = net->n_veins - 1;
        }
    }
    g_free(edge);
    g_free(used);
}

/* network_assign_widths makes everything anew; what `keep` points to stays as it was, if `kept`. */
static gpointer set_aside(bool kept, gconstpointer array, gsize size) { return kept ? g_memdup2(array, size) : NULL; }

static void put_back(gpointer kept, gpointer array, gsize size)
{
    if (kept != NULL)
        memcpy(array, kept, size);
    g_free(kept);
}

static void complete_sizes(Draft *d, const WidthDef *def)
{
    Network *net = d->net;
    uint32_t n = net->n_edges;
    bool widths = all_edges(d, FIELD_WIDTH), flows = widths && all_edges(d, FIELD_FLOW), orders = all_edges(d, FIELD_ORDER);
    bool ranks = orders && all_edges(d, FIELD_RANK), veins = orders && all_edges(d, FIELD_VEIN);
    if (!widths || !orders || !ranks) {
        gpointer width = set_aside(widths, net->width, n * sizeof *net->width), flow = set_aside(flows, net->flow, n * sizeof *net->flow);
        gpointer order = set_aside(orders, net->order, n), rank = set_aside(ranks, net->rank, n);
        gpointer vein = set_aside(veins, net->vein, n * sizeof *net->vein);
        network_assign_widths(net, def);
        put_back(width, net->width, n * sizeof *net->width);
        put_back(flow, net->flow, n * sizeof *net->flow);
        put_back(order, net->order, n);
        put_back(rank, net->rank, n);
        put_back(vein, net->vein, n * sizeof *net->vein);
    }
    if (widths && !flows)
        for (uint32_t e = 0; e < n; e++)
            net->flow[e] = dmath_pow(net->width[e] / def->minimum, def->exponent);
    if (veins)
        close_gaps(net);
    else if (orders)
        follow_veins(net);
}

gboolean draft_complete(Draft *d, const WidthDef *widths, GError **error)
{
    if (!complete_births(d, error))
        return FALSE;
    complete_sizes(d, widths);
    return TRUE;
}
