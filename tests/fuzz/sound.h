/* What the rest of the library relies on in a network or an outline, whoever made it. */
#ifndef TESTS_SOUND_H
#define TESTS_SOUND_H

#include <math.h>

#include "fuzz.h"
#include "geom/polygon.h"
#include "sim/network.h"

static inline void sound_polygon(const Polygon *p)
{
    uint32_t i, j;
    require(p->n >= 3 && isfinite(p->area) && p->area > 0.0);
    for (i = 0; i < p->n; i++)
        require(isfinite(p->v[i].x) && isfinite(p->v[i].y));
    require(!polygon_crossing(p, &i, &j));
}

static inline void sound_network(const Network *net)
{
    bool *grown = g_new0(bool, net->n_nodes), *used = g_new0(bool, net->n_veins);
    for (uint32_t v = 0; v < net->n_nodes; v++)
        require(isfinite(net->node[v].x) && isfinite(net->node[v].y) && net->node_birth[v] <= net->n_steps);
    for (uint32_t e = 0; e < net->n_edges; e++) {
        require(net->tail[e] < net->head[e] && net->head[e] < net->n_nodes);
        require(net->kind[e] == EDGE_ANASTOMOSIS || (net->kind[e] == EDGE_VEIN && !grown[net->head[e]]));
        require(net->birth[e] <= net->n_steps && net->order[e] > 0 && net->rank[e] > 0 && net->vein[e] < net->n_veins);
        require(net->width[e] > 0.0 && net->flow[e] > 0.0 && isfinite(net->width[e]) && isfinite(net->flow[e]));
        require(vec_dist2(net->node[net->tail[e]], net->node[net->head[e]]) > 0.0);
        grown[net->head[e]] |= net->kind[e] == EDGE_VEIN;
        used[net->vein[e]] = true;
    }
    for (uint32_t k = 0; k < net->n_veins; k++)
        require(used[k]);
    if (net->margin)
        sound_polygon(net->margin);
    g_free(grown);
    g_free(used);
}

#endif
