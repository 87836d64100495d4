#include "sim/network.h"

#include <glib.h>

Network *network_new(uint32_t n_nodes, uint32_t n_edges)
{
    Network *n = g_new0(Network, 1);
    n->n_nodes = n_nodes;
    n->n_edges = n_edges;
    n->node = g_new0(Vec2, n_nodes);
    n->node_birth = g_new0(uint32_t, n_nodes);
    n->tail = g_new0(uint32_t, n_edges);
    n->head = g_new0(uint32_t, n_edges);
    n->birth = g_new0(uint32_t, n_edges);
    n->kind = g_new0(uint8_t, n_edges);
    n->flow = g_new0(double, n_edges);
    n->width = g_new0(double, n_edges);
    n->order = g_new0(uint8_t, n_edges);
    n->rank = g_new0(uint8_t, n_edges);
    n->vein = g_new0(uint32_t, n_edges);
    return n;
}

void network_free(Network *n)
{
    if (!n)
        return;
    g_free(n->node);
    g_free(n->node_birth);
    g_free(n->tail);
    g_free(n->head);
    g_free(n->birth);
    g_free(n->kind);
    g_free(n->flow);
    g_free(n->width);
    g_free(n->order);
    g_free(n->rank);
    g_free(n->vein);
    polygon_free(n->margin);
    holes_free(n->holes);
    g_free(n);
}
