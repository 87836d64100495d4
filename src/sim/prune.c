/* Spurs: veins that had hardly set out. */
#include <glib.h>

#include "sim/network.h"

enum { NONE = UINT32_MAX };

typedef struct {
    const Network *net;
    uint32_t *entry;  /* [nodes] the vein edge that leads there */
    uint32_t *leaves; /* [nodes] edges that leave it or join it to another vein */
    bool *drop;       /* [nodes] */
} Pruning;

/* The free end's run back to the branching it leaves; 0 when it is a whole tree. */
static double run_length(const Pruning *p, uint32_t end, uint32_t *branching)
{
    double length = 0.0;
    uint32_t v = end;
    for (;;) {
        uint32_t e = p->entry[v];
        if (e == NONE)
            return 0.0;
        length += vec_dist(p->net->node[p->net->tail[e]], p->net->node[v]);
        v = p->net->tail[e];
        if (p->leaves[v] > 1)
            break;
    }
    *branching = v;
    return length;
}

static void drop_run(Pruning *p, uint32_t end, uint32_t branching)
{
    for (uint32_t v = end; v != branching; v = p->net->tail[p->entry[v]])
        p->drop[v] = true;
    p->leaves[branching]--;
}

/* Shortest runs first would need sorting; youngest ends first does as well: what is left of a fork is its older vein. */
static void find_spurs(Pruning *p, double shortest)
{
    for (uint32_t v = p->net->n_nodes; v-- > 0;) {
        uint32_t branching;
        if (p->leaves[v] > 0)
            continue;
        double length = run_length(p, v, &branching);
        if (length > 0.0 && length < shortest && polygon_depth(p->net->margin, p->net->node[v]) > shortest)
            drop_run(p, v, branching);
    }
}

static Network *without(const Network *net, const bool *drop)
{
    uint32_t *name = g_new(uint32_t, MAX(net->n_nodes, 1)), nodes = 0, edges = 0;
    for (uint32_t v = 0; v < net->n_nodes; v++)
        name[v] = drop[v] ? NONE : nodes++;
    for (uint32_t e = 0; e < net->n_edges; e++)
        edges += !drop[net->head[e]];
    Network *out = network_new(nodes, edges);
    out->n_steps = net->n_steps;
    out->length = net->length;
    out->margin = polygon_new(net->margin->v, net->margin->n);
    for (uint32_t v = 0; v < net->n_nodes; v++)
        if (!drop[v]) {
            out->node[name[v]] = net->node[v];
            out->node_birth[name[v]] = net->node_birth[v];
        }
    for (uint32_t e = 0, k = 0; e < net->n_edges; e++)
        if (!drop[net->head[e]]) {
            out->tail[k] = name[net->tail[e]];
            out->head[k] = name[net->head[e]];
            out->birth[k] = net->birth[e];
            out->kind[k++] = net->kind[e];
        }
    g_free(name);
    return out;
}

Network *network_prune(Network *net, double shortest)
{
    Pruning p = {net, g_new(uint32_t, MAX(net->n_nodes, 1)), g_new0(uint32_t, MAX(net->n_nodes, 1)), g_new0(bool, MAX(net->n_nodes, 1))};
    for (uint32_t v = 0; v < net->n_nodes; v++)
        p.entry[v] = NONE;
    for (uint32_t e = 0; e < net->n_edges; e++) {
        p.leaves[net->tail[e]]++;
        if (net->kind[e] == EDGE_VEIN)
            p.entry[net->head[e]] = e;
        else
            p.leaves[net->head[e]]++; /* where veins meet no vein ends */
    }
    find_spurs(&p, shortest);
    Network *out = without(net, p.drop);
    g_free(p.entry);
    g_free(p.leaves);
    g_free(p.drop);
    network_free(net);
    return out;
}
