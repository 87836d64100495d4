/* GraphML (graphml.graphdrawing.org) with typed attributes, which NetworkX and igraph read as it is. */
#include <math.h>

#include "export/export.h"
#include "export/sink.h"

static const struct {
    const char *id, *domain, *name, *type;
} keys[] = {
    {"x", "node", "x", "double"},    {"y", "node", "y", "double"},      {"t", "node", "birth", "int"},
    {"k", "edge", "kind", "string"}, {"o", "edge", "order", "int"},     {"r", "edge", "rank", "int"},
    {"v", "edge", "vein", "int"},    {"w", "edge", "width", "double"},  {"f", "edge", "flow", "double"},
    {"b", "edge", "birth", "int"},   {"l", "edge", "length", "double"},
    {"m", "graph", "margin", "string"}, {"base", "graph", "base", "string"},
    {"tip", "graph", "tip", "string"}, {"s", "graph", "steps", "int"},
};

/* Strings of known length: a leaf may have a million edges. */
#define PUT(s, text) g_string_append_len(s, text, sizeof(text) - 1)
#define NEXT(key) "</data><data key=\"" key "\">"

/* The number that sink_millionths writes, up to 4e9: so that a length is that between the nodes as they stand in the file, and the file
 * is the same again when it is read and written. */
static double rounded(double value)
{
    double scaled = value * 1e6, whole = rint(scaled), over = scaled - whole;
    if (fabs(over) == 0.5) { /* the exact product may lie on the other side of the half */
        double rest = fma(value, 1e6, -scaled);
        if (over > 0.0 ? rest > 0.0 : rest < 0.0)
            whole += over > 0.0 ? 1.0 : -1.0;
    }
    return whole / 1e6;
}

static double edge_length(const Network *net, uint32_t e)
{
    Vec2 a = net->node[net->tail[e]], b = net->node[net->head[e]];
    return vec_dist(vec2(rounded(a.x), rounded(a.y)), vec2(rounded(b.x), rounded(b.y)));
}

static void put_points(GString *s, const Vec2 *p, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++) {
        if (i > 0)
            g_string_append_c(s, ' ');
        sink_millionths(s, p[i].x);
        g_string_append_c(s, ',');
        sink_millionths(s, p[i].y);
    }
}

static void put_graph(const Network *net, GString *s)
{
    if (net->margin != NULL) {
        PUT(s, "<data key=\"m\">");
        put_points(s, net->margin->v, net->margin->n);
        PUT(s, "</data>\n");
    }
    if (net->holes != NULL) {
        PUT(s, "<data key=\"h\">");
        for (uint32_t k = 0; k < net->holes->n; k++) {
            if (k > 0)
                PUT(s, "; ");
            put_points(s, net->holes->p + net->holes->start[k], net->holes->start[k + 1] - net->holes->start[k]);
        }
        PUT(s, "</data>\n");
    }
    if (net->length > 0.0) {
        PUT(s, "<data key=\"base\">0,0</data>\n<data key=\"tip\">0,");
        sink_millionths(s, net->length);
        PUT(s, "</data>\n");
    }
    PUT(s, "<data key=\"s\">");
    sink_uint(s, net->n_steps);
    PUT(s, "</data>\n");
}

static void put_node(const Network *net, uint32_t i, GString *s)
{
    PUT(s, "<node id=\"");
    sink_uint(s, i);
    PUT(s, "\"><data key=\"x\">");
    sink_millionths(s, net->node[i].x);
    PUT(s, NEXT("y"));
    sink_millionths(s, net->node[i].y);
    PUT(s, NEXT("t"));
    sink_uint(s, net->node_birth[i]);
    PUT(s, "</data></node>\n");
}

static void put_edge(const Network *net, uint32_t e, GString *s)
{
    PUT(s, "<edge source=\"");
    sink_uint(s, net->tail[e]);
    PUT(s, "\" target=\"");
    sink_uint(s, net->head[e]);
    PUT(s, "\"><data key=\"k\">");
    if (net->kind[e] == EDGE_ANASTOMOSIS)
        PUT(s, "anastomosis");
    else
        PUT(s, "vein");
    PUT(s, NEXT("o"));
    sink_uint(s, net->order[e]);
    PUT(s, NEXT("r"));
    sink_uint(s, net->rank[e]);
    PUT(s, NEXT("v"));
    sink_uint(s, net->vein[e]);
    PUT(s, NEXT("w"));
    sink_size(s, net->width[e]);
    PUT(s, NEXT("f"));
    sink_size(s, net->flow[e]);
    PUT(s, NEXT("b"));
    sink_uint(s, net->birth[e]);
    PUT(s, NEXT("l"));
    sink_size(s, edge_length(net, e));
    PUT(s, "</data></edge>\n");
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
    if (net->holes != NULL)
        g_string_append(out->text, "<key id=\"h\" for=\"graph\" attr.name=\"holes\" attr.type=\"string\"/>\n");
    g_string_append(out->text, "<graph id=\"venation\" edgedefault=\"directed\">\n");
    put_graph(net, out->text);
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
