#include "import/draft.h"

/* So that half-edges can be counted in 32 bits. */
enum { MOST = 1000000000 };

/* Edges shorter than this could vanish when they are written in millionths, segments. */
static const double shortest = 2e-6;

void draft_init(Draft *d, const char *file)
{
    *d = (Draft){.file = file, .net = network_new(0, 0)};
    names_init(&d->names);
}

void draft_clear(Draft *d)
{
    names_clear(&d->names);
    network_free(d->net);
    g_free(d->name);
    g_free(d->node_line);
    g_free(d->edge_line);
}

gboolean draft_fail(const Draft *d, uint32_t line, ImportErrorCode code, GError **error, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    char *what = g_strdup_vprintf(format, args);
    va_end(args);
    if (line > 0)
        g_set_error(error, IMPORT_ERROR, code, "%s:%u: %s", d->file, line, what);
    else
        g_set_error(error, IMPORT_ERROR, code, "%s: %s", d->file, what);
    g_free(what);
    return FALSE;
}

static char *pair_text(const Draft *d, uint32_t a, uint32_t b)
{
    char *from = names_quoted(&d->names, a), *to = names_quoted(&d->names, b), *text = g_strdup_printf("edge %s – %s", from, to);
    g_free(from);
    g_free(to);
    return text;
}

char *draft_node_text(const Draft *d, uint32_t node)
{
    char *name = names_quoted(&d->names, d->name[node]), *text = g_strconcat("node ", name, NULL);
    g_free(name);
    return text;
}

char *draft_edge_text(const Draft *d, uint32_t edge)
{
    return pair_text(d, d->name[d->net->tail[edge]], d->name[d->net->head[edge]]);
}

gboolean draft_fail_ring(const Draft *d, uint32_t edge, GArray *ring, GError **error)
{
    enum { SHOWN = 8 };
    GString *nodes = g_string_new(NULL);
    for (guint k = 0; k < ring->len && k < SHOWN; k++) {
        char *name = names_quoted(&d->names, d->name[g_array_index(ring, uint32_t, k)]);
        g_string_append_printf(nodes, "%s%s", k > 0 ? ", " : "", name);
        g_free(name);
    }
    if (ring->len > SHOWN)
        g_string_append_printf(nodes, " and %u more", ring->len - SHOWN);
    char *text = draft_edge_text(d, edge);
    draft_fail(d, d->edge_line[edge], IMPORT_ERROR_GRAPH, error,
               "%s: edges of kind vein run in a circle through the nodes %s; one of them must be an anastomosis", text, nodes->str);
    g_free(text);
    g_string_free(nodes, TRUE);
    g_array_unref(ring);
    return FALSE;
}

/* ---- reading ---- */

static void node_room(Draft *d)
{
    if (d->net->n_nodes < d->node_room)
        return;
    uint32_t room = d->node_room = MAX(d->node_room + d->node_room / 2, 256);
    d->net->node = g_renew(Vec2, d->net->node, room);
    d->net->node_birth = g_renew(uint32_t, d->net->node_birth, room);
    d->name = g_renew(uint32_t, d->name, room);
    d->node_line = g_renew(uint32_t, d->node_line, room);
}

static void edge_arrays(Draft *d, uint32_t room)
{
    Network *net = d->net;
    net->tail = g_renew(uint32_t, net->tail, room);
    net->head = g_renew(uint32_t, net->head, room);
    net->birth = g_renew(uint32_t, net->birth, room);
    net->kind = g_renew(uint8_t, net->kind, room);
    net->flow = g_renew(double, net->flow, room);
    net->width = g_renew(double, net->width, room);
    net->order = g_renew(uint8_t, net->order, room);
    net->rank = g_renew(uint8_t, net->rank, room);
    net->vein = g_renew(uint32_t, net->vein, room);
}

static void edge_room(Draft *d)
{
    if (d->net->n_edges < d->edge_room)
        return;
    d->edge_room = MAX(d->edge_room + d->edge_room / 2, 256);
    edge_arrays(d, d->edge_room);
    d->edge_line = g_renew(uint32_t, d->edge_line, d->edge_room);
}

static void count_given(Draft *d, unsigned given)
{
    for (int f = 0; given != 0; f++, given >>= 1)
        d->given[f] += given & 1;
}

gboolean draft_add_node(Draft *d, const Item *item, GError **error)
{
    uint32_t former = d->names.node[item->name], v = d->net->n_nodes;
    if (former != NONE) {
        char *name = names_quoted(&d->names, item->name);
        draft_fail(d, item->line, IMPORT_ERROR_GRAPH, error, "a second node %s; the first is in line %u", name, d->node_line[former]);
        g_free(name);
        return FALSE;
    }
    if (v == MOST)
        return draft_fail(d, item->line, IMPORT_ERROR_GRAPH, error, "more than %d nodes", MOST);
    node_room(d);
    d->net->n_nodes++;
    d->net->node[v] = vec2(item->value[FIELD_X], item->value[FIELD_Y]);
    d->net->node_birth[v] = item->given & FIELD_BIT(FIELD_NODE_BIRTH) ? (uint32_t)item->value[FIELD_NODE_BIRTH] : 0;
    d->name[v] = item->name;
    d->node_line[v] = item->line;
    d->names.node[item->name] = v;
    count_given(d, item->given);
    return TRUE;
}

gboolean draft_add_edge(Draft *d, const Item *item, GError **error)
{
    Network *net = d->net;
    uint32_t e = net->n_edges;
    if (item->source == item->target) {
        char *text = pair_text(d, item->source, item->target);
        draft_fail(d, item->line, IMPORT_ERROR_GRAPH, error, "%s leads back to its own node; it must join two", text);
        g_free(text);
        return FALSE;
    }
    if (e == MOST)
        return draft_fail(d, item->line, IMPORT_ERROR_GRAPH, error, "more than %d edges", MOST);
    edge_room(d);
    net->n_edges++;
    net->tail[e] = item->source;
    net->head[e] = item->target;
    net->kind[e] = item->given & FIELD_BIT(FIELD_KIND) ? (uint8_t)item->value[FIELD_KIND] : KIND_UNKNOWN;
    net->birth[e] = item->given & FIELD_BIT(FIELD_BIRTH) ? (uint32_t)item->value[FIELD_BIRTH] : NONE;
    net->order[e] = item->given & FIELD_BIT(FIELD_ORDER) ? (uint8_t)item->value[FIELD_ORDER] : 0;
    net->rank[e] = item->given & FIELD_BIT(FIELD_RANK) ? (uint8_t)item->value[FIELD_RANK] : 0;
    net->vein[e] = item->given & FIELD_BIT(FIELD_VEIN) ? (uint32_t)item->value[FIELD_VEIN] : 0;
    net->width[e] = item->given & FIELD_BIT(FIELD_WIDTH) ? item->value[FIELD_WIDTH] : 0.0;
    net->flow[e] = item->given & FIELD_BIT(FIELD_FLOW) ? item->value[FIELD_FLOW] : 0.0;
    d->edge_line[e] = item->line;
    d->undirected |= !item->directed;
    count_given(d, item->given);
    return TRUE;
}

/* Edges from names to nodes; gives back what was allocated ahead. */
static gboolean resolve(Draft *d, GError **error)
{
    Network *net = d->net;
    for (uint32_t e = 0; e < net->n_edges; e++) {
        uint32_t tail = d->names.node[net->tail[e]], head = d->names.node[net->head[e]];
        if (tail == NONE || head == NONE) {
            char *text = pair_text(d, net->tail[e], net->head[e]);
            char *missing = names_quoted(&d->names, tail == NONE ? net->tail[e] : net->head[e]);
            draft_fail(d, d->edge_line[e], IMPORT_ERROR_GRAPH, error, "%s: there is no node %s", text, missing);
            g_free(missing);
            g_free(text);
            return FALSE;
        }
        net->tail[e] = tail;
        net->head[e] = head;
    }
    net->node = g_renew(Vec2, net->node, net->n_nodes);
    net->node_birth = g_renew(uint32_t, net->node_birth, net->n_nodes);
    edge_arrays(d, net->n_edges);
    return TRUE;
}

/* ---- checks ---- */

static gboolean check_lengths(const Draft *d, GError **error)
{
    const Network *net = d->net;
    for (uint32_t e = 0; e < net->n_edges; e++) {
        Vec2 a = net->node[net->tail[e]], b = net->node[net->head[e]];
        if (vec_dist2(a, b) >= shortest * shortest)
            continue;
        char *text = draft_edge_text(d, e);
        draft_fail(d, d->edge_line[e], IMPORT_ERROR_GRAPH, error,
                   "%s has no length: both its nodes lie at %.7g,%.7g; they must lie at least %g segments apart", text, a.x, a.y, shortest);
        g_free(text);
        return FALSE;
    }
    return TRUE;
}

static gboolean fail_twice(const Draft *d, uint32_t former, uint32_t e, GError **error)
{
    char *text = draft_edge_text(d, e);
    draft_fail(d, d->edge_line[e], IMPORT_ERROR_GRAPH, error, "%s joins the same nodes as the edge in line %u; one of them must go", text,
               d->edge_line[former]);
    g_free(text);
    return FALSE;
}

/* Looks for two edges between the same nodes. Two anastomoses may be: veins that meet at two auxin sources are joined twice. */
static gboolean check_doubles(const Draft *d, GError **error)
{
    const Network *net = d->net;
    uint32_t *first = g_new(uint32_t, net->n_nodes), *next = g_new(uint32_t, net->n_edges);
    uint32_t *seen = g_new(uint32_t, net->n_nodes), former = NONE, twin = NONE; /* seen[w]: last edge to w from a node before w */
    for (uint32_t v = 0; v < net->n_nodes; v++)
        first[v] = seen[v] = NONE;
    for (uint32_t e = net->n_edges; e-- > 0;) { /* backwards, so that a chain runs forwards */
        uint32_t v = MIN(net->tail[e], net->head[e]);
        next[e] = first[v];
        first[v] = e;
    }
    for (uint32_t v = 0; v < net->n_nodes && twin == NONE; v++)
        for (uint32_t e = first[v]; e != NONE && twin == NONE; e = next[e]) {
            uint32_t w = MAX(net->tail[e], net->head[e]);
            former = seen[w];
            if (former != NONE && MIN(net->tail[former], net->head[former]) == v &&
                !(net->kind[e] == EDGE_ANASTOMOSIS && net->kind[former] == EDGE_ANASTOMOSIS))
                twin = e;
            seen[w] = e;
        }
    g_free(first);
    g_free(next);
    g_free(seen);
    return twin == NONE || fail_twice(d, former, twin, error);
}

Network *draft_finish(Draft *d, const WidthDef *widths, GError **error)
{
    bool bare = d->net->n_nodes == 1 && d->net->n_edges == 0 && d->net->margin != NULL; /* a blade without veins, as a scan may give */
    if (!bare && (d->net->n_nodes == 0 || d->net->n_edges == 0)) {
        draft_fail(d, 0, IMPORT_ERROR_GRAPH, error, "the graph has no %s; a venation has at least two nodes and an edge, a leaf without veins one node and a margin",
                   d->net->n_nodes == 0 ? "nodes" : "edges");
        return NULL;
    }
    if (!resolve(d, error) || !check_lengths(d, error) || !check_doubles(d, error))
        return NULL;
    draft_find_base(d);
    if (!draft_orient(d, error) || !draft_complete(d, widths, error) || !draft_place(d, error))
        return NULL;
    return g_steal_pointer(&d->net);
}
