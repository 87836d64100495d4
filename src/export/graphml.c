/* GraphML (graphml.graphdrawing.org) with typed attributes, which NetworkX and igraph read as it is. */
#include "export/export.h"
#include "export/sink.h"

static const struct {
    const char *id, *domain, *name, *type;
} keys[] = {
    {"x", "node", "x", "double"},    {"y", "node", "y", "double"},      {"nb", "node", "birth", "int"},
    {"k", "edge", "kind", "string"}, {"o", "edge", "order", "int"},     {"r", "edge", "rank", "int"},
    {"v", "edge", "vein", "int"},    {"w", "edge", "width", "double"},  {"f", "edge", "flow", "double"},
    {"b", "edge", "birth", "int"},   {"l", "edge", "length", "double"},
};

static void put_number(GString *s, const char *key, double value)
{
    g_string_append(s, "<data key=\"");
    g_string_append(s, key);
    g_string_append(s, "\">");
    export_number(s, value);
    g_string_append(s, "</data>");
}

static void put_node(const Network *net, uint32_t i, GString *s)
{
    g_string_append(s, "<node id=\"n");
    sink_uint(s, i);
    g_string_append(s, "\">");
    put_number(s, "x", net->node[i].x);
    put_number(s, "y", net->node[i].y);
    put_number(s, "nb", net->node_birth[i]);
    g_string_append(s, "</node>\n");
}

static void put_edge(const Network *net, uint32_t e, GString *s)
{
    g_string_append(s, "<edge source=\"n");
    sink_uint(s, net->tail[e]);
    g_string_append(s, "\" target=\"n");
    sink_uint(s, net->head[e]);
    g_string_append(s, "\"><data key=\"k\">");
    g_string_append(s, net->kind[e] == EDGE_ANASTOMOSIS ? "anastomosis" : "vein");
    g_string_append(s, "</data>");
    put_number(s, "o", net->order[e]);
    put_number(s, "r", net->rank[e]);
    put_number(s, "v", net->vein[e]);
    put_number(s, "w", net->width[e]);
    put_number(s, "f", net->flow[e]);
    put_number(s, "b", net->birth[e]);
    put_number(s, "l", vec_dist(net->node[net->tail[e]], net->node[net->head[e]]));
    g_string_append(s, "</edge>\n");
}

gboolean export_graphml(const Network *net, const char *path, GError **error)
{
    Sink *out = sink_open(path, error);
    if (out == NULL)
        return FALSE;
    g_string_append(out->text, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                               "<graphml xmlns=\"http://graphml.graphdrawing.org/xmlns\" "
                               "xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\"\n "
                               "xsi:schemaLocation=\"http://graphml.graphdrawing.org/xmlns "
                               "http://graphml.graphdrawing.org/xmlns/1.0/graphml.xsd\">\n");
    for (gsize i = 0; i < G_N_ELEMENTS(keys); i++)
        g_string_append_printf(out->text, "<key id=\"%s\" for=\"%s\" attr.name=\"%s\" attr.type=\"%s\"/>\n", keys[i].id,
                               keys[i].domain, keys[i].name, keys[i].type);
    g_string_append(out->text, "<graph id=\"venation\" edgedefault=\"directed\">\n");
    for (uint32_t i = 0; i < net->n_nodes; i++) {
        put_node(net, i, out->text);
        sink_drain(out);
    }
    for (uint32_t e = 0; e < net->n_edges; e++) {
        put_edge(net, e, out->text);
        sink_drain(out);
    }
    g_string_append(out->text, "</graph>\n</graphml>\n");
    return sink_close(out, error);
}
