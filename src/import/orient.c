/* Which edges are veins, which way they lead, and an order of nodes in which every edge leads forwards. */
#include <string.h>

#include "import/draft.h"

/* Sets the vein edge that leads to each node, NONE for a first node. */
static gboolean find_entries(const Draft *d, uint32_t *entry, GError **error)
{
    const Network *net = d->net;
    for (uint32_t v = 0; v < net->n_nodes; v++)
        entry[v] = NONE;
    for (uint32_t e = 0; e < net->n_edges; e++) {
        uint32_t v = net->head[e], other = entry[v];
        if (net->kind[e] != EDGE_VEIN)
            continue;
        entry[v] = e;
        if (other == NONE)
            continue;
        char *node = draft_node_text(d, v), *a = draft_node_text(d, net->tail[other]), *b = draft_node_text(d, net->tail[e]);
        draft_fail(d, d->edge_line[e], IMPORT_ERROR_GRAPH, error,
                   "%s grows from %s as well as from %s (line %u); veins lead away from the leaf base, and where two meet one is an "
                   "anastomosis (in an undirected graph, or without kinds, directions are found)",
                   node, b, a, d->edge_line[other]);
        g_free(node);
        g_free(a);
        g_free(b);
        return FALSE;
    }
    return TRUE;
}

static gboolean fail_circle(const Draft *d, const uint32_t *entry, uint32_t v, GError **error)
{
    GArray *ring = g_array_new(FALSE, FALSE, sizeof v);
    uint32_t u = v;
    do {
        g_array_append_val(ring, u);
        u = d->net->tail[entry[u]];
    } while (u != v);
    return draft_fail_ring(d, entry[v], ring, error);
}

/* Depths by following veins back to their first nodes. */
static gboolean measure_depths(const Draft *d, const uint32_t *entry, uint32_t *depth, GError **error)
{
    enum { OPEN = NONE - 1 };
    const Network *net = d->net;
    uint32_t *way = g_new(uint32_t, net->n_nodes), circle = NONE;
    for (uint32_t v = 0; v < net->n_nodes; v++)
        depth[v] = NONE;
    for (uint32_t v = 0; v < net->n_nodes && circle == NONE; v++) {
        uint32_t n = 0, u = v;
        for (; depth[u] == NONE && entry[u] != NONE; u = net->tail[entry[u]]) {
            depth[u] = OPEN;
            way[n++] = u;
        }
        if (depth[u] == NONE)
            depth[u] = 0;
        else if (depth[u] == OPEN)
            circle = u;
        for (uint32_t k = n; k-- > 0 && circle == NONE;)
            depth[way[k]] = depth[net->tail[entry[way[k]]]] + 1;
    }
    g_free(way);
    return circle == NONE || fail_circle(d, entry, circle, error);
}

/* ---- order ---- */

static bool in_order(const Network *net)
{
    bool good = true;
    for (uint32_t e = 0; e < net->n_edges && good; e++)
        good = net->kind[e] != EDGE_VEIN || net->tail[e] < net->head[e];
    return good;
}

/* The elements of an array in a new order. */
static gpointer sorted(gpointer array, gsize size, const uint32_t *order, uint32_t n)
{
    char *out = g_malloc_n(n, size);
    for (uint32_t k = 0; k < n; k++)
        memcpy(out + k * size, (const char *)array + order[k] * size, size);
    g_free(array);
    return out;
}

#define SORT(array, order, n) ((array) = sorted((array), sizeof *(array), order, n))

/* Nodes by depth, those of one depth as in the file. */
static uint32_t *nodes_by_depth(const Network *net, const uint32_t *depth)
{
    uint32_t *start = g_new0(uint32_t, (gsize)net->n_nodes + 1), *order = g_new(uint32_t, net->n_nodes);
    for (uint32_t v = 0; v < net->n_nodes; v++)
        start[depth[v] + 1]++;
    for (uint32_t k = 0; k < net->n_nodes; k++)
        start[k + 1] += start[k];
    for (uint32_t v = 0; v < net->n_nodes; v++)
        order[start[depth[v]]++] = v;
    g_free(start);
    return order;
}

static void sort_edges(Draft *d, const uint32_t *order)
{
    Network *net = d->net;
    uint32_t n = net->n_edges;
    SORT(net->tail, order, n);
    SORT(net->head, order, n);
    SORT(net->birth, order, n);
    SORT(net->kind, order, n);
    SORT(net->flow, order, n);
    SORT(net->width, order, n);
    SORT(net->order, order, n);
    SORT(net->rank, order, n);
    SORT(net->vein, order, n);
    SORT(d->edge_line, order, n);
}

/* Nodes by depth, veins by their heads, anastomoses last, as a simulation leaves them. */
static void sort_network(Draft *d, const uint32_t *entry, const uint32_t *depth)
{
    Network *net = d->net;
    uint32_t *order = nodes_by_depth(net, depth), *place = g_new(uint32_t, net->n_nodes), *edges = g_new(uint32_t, net->n_edges), n = 0;
    for (uint32_t k = 0; k < net->n_nodes; k++) {
        place[order[k]] = k;
        if (entry[order[k]] != NONE)
            edges[n++] = entry[order[k]];
    }
    for (uint32_t e = 0; e < net->n_edges; e++)
        if (net->kind[e] != EDGE_VEIN)
            edges[n++] = e;
    sort_edges(d, edges);
    for (uint32_t e = 0; e < net->n_edges; e++) {
        net->tail[e] = place[net->tail[e]];
        net->head[e] = place[net->head[e]];
    }
    SORT(net->node, order, net->n_nodes);
    SORT(net->node_birth, order, net->n_nodes);
    SORT(d->name, order, net->n_nodes);
    SORT(d->node_line, order, net->n_nodes);
    g_free(order);
    g_free(place);
    g_free(edges);
}

bool draft_as_given(const Draft *d) { return !d->undirected && d->given[FIELD_KIND] == d->net->n_edges; }

gboolean draft_orient(Draft *d, GError **error)
{
    Network *net = d->net;
    uint32_t *entry = g_new(uint32_t, net->n_nodes), *depth = g_new(uint32_t, net->n_nodes);
    gboolean good;
    if (draft_as_given(d))
        good = find_entries(d, entry, error) && (in_order(net) || measure_depths(d, entry, depth, error));
    else
        good = draft_search(d, entry, depth, error);
    if (good && !in_order(net))
        sort_network(d, entry, depth);
    for (uint32_t e = 0; good && e < net->n_edges; e++) {
        uint32_t older = MIN(net->tail[e], net->head[e]), younger = MAX(net->tail[e], net->head[e]);
        net->tail[e] = older; /* an anastomosis leads to its younger end, whichever way it stood */
        net->head[e] = younger;
    }
    g_free(entry);
    g_free(depth);
    return good;
}
