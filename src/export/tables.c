/* Plain CSV tables for spreadsheets, R and pandas; a node's number is its line after the header, from 0. Lengths are
 * rounded to millionths of a segment. */
#include "export/export.h"
#include "export/sink.h"

gboolean export_nodes_csv(const Network *net, const char *path, GError **error)
{
    Sink *out = sink_open(path, error);
    if (out == NULL)
        return FALSE;
    GString *s = out->text;
    g_string_append(s, "node,x,y,birth\n");
    for (uint32_t i = 0; i < net->n_nodes; i++) {
        sink_uint(s, i);
        g_string_append_c(s, ',');
        sink_millionths(s, net->node[i].x);
        g_string_append_c(s, ',');
        sink_millionths(s, net->node[i].y);
        g_string_append_c(s, ',');
        sink_uint(s, net->node_birth[i]);
        g_string_append_c(s, '\n');
        sink_drain(out);
    }
    return sink_close(out, error);
}

static void put_edge(const Network *net, uint32_t e, GString *s)
{
    sink_uint(s, net->tail[e]);
    g_string_append_c(s, ',');
    sink_uint(s, net->head[e]);
    g_string_append(s, net->kind[e] == EDGE_ANASTOMOSIS ? ",anastomosis," : ",vein,");
    sink_uint(s, net->order[e]);
    g_string_append_c(s, ',');
    sink_uint(s, net->rank[e]);
    g_string_append_c(s, ',');
    sink_uint(s, net->vein[e]);
    g_string_append_c(s, ',');
    sink_size(s, net->width[e]);
    g_string_append_c(s, ',');
    sink_size(s, net->flow[e]);
    g_string_append_c(s, ',');
    sink_uint(s, net->birth[e]);
    g_string_append_c(s, ',');
    sink_size(s, vec_dist(net->node[net->tail[e]], net->node[net->head[e]]));
    g_string_append_c(s, '\n');
}

gboolean export_edges_csv(const Network *net, const char *path, GError **error)
{
    Sink *out = sink_open(path, error);
    if (out == NULL)
        return FALSE;
    g_string_append(out->text, "tail,head,kind,order,rank,vein,width,flow,birth,length\n");
    for (uint32_t e = 0; e < net->n_edges; e++) {
        put_edge(net, e, out->text);
        sink_drain(out);
    }
    return sink_close(out, error);
}
