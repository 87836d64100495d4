/* Opens the drawing from the base: which edges are veins, and which way they lead. Drawn veins are followed whole, coarser ones before
 * finer ones, so that what closes a loop is the last edge of the finer vein. */
#include "sim/drawing_private.h"

/* An edge that may lead to a node that is not reached yet. */
typedef struct {
    uint32_t level;        /* of the edge's line: its order, or one more than that of the line it leaves */
    bool late;             /* it ends a line on the course of another line, which should be reached from elsewhere */
    double width, length;  /* of the edge; of the way to it */
    uint32_t edge, node;   /* node: its far end */
} Way;

typedef struct {
    const Sketch *s;
    uint32_t n_nodes, n_edges;
    uint32_t *start, *half; /* edges of each node: half[start[v] … start[v + 1] - 1] */
    uint32_t *entry;        /* edge that leads to a node; NONE for first nodes */
    uint32_t *depth;        /* NONE: not reached */
    uint32_t *order, n_order; /* nodes as they are reached */
    double *length;
    GArray *heap;           /* Way */
} Opening;

static bool goes_before(const Way *a, const Way *b)
{
    if (a->level != b->level)
        return a->level < b->level;
    if (a->late != b->late)
        return b->late;
    if (a->width != b->width)
        return a->width > b->width;
    if (a->length != b->length)
        return a->length < b->length;
    return a->edge < b->edge;
}

static void heap_push(GArray *heap, Way way)
{
    g_array_append_val(heap, way);
    Way *h = &g_array_index(heap, Way, 0);
    guint i = heap->len - 1;
    for (; i > 0 && goes_before(&way, &h[(i - 1) / 2]); i = (i - 1) / 2)
        h[i] = h[(i - 1) / 2];
    h[i] = way;
}

static Way heap_pop(GArray *heap)
{
    Way *h = &g_array_index(heap, Way, 0), top = h[0], last = h[heap->len - 1];
    g_array_set_size(heap, heap->len - 1);
    guint i = 0;
    for (guint k; (k = 2 * i + 1) < heap->len; i = k) {
        if (k + 1 < heap->len && goes_before(&h[k + 1], &h[k]))
            k++;
        if (!goes_before(&h[k], &last))
            break;
        h[i] = h[k];
    }
    if (heap->len > 0)
        h[i] = last;
    return top;
}

static void opening_init(Opening *o, const Sketch *s)
{
    uint32_t n = s->node->len, m = s->edge->len;
    *o = (Opening){.s = s, .n_nodes = n, .n_edges = m, .heap = g_array_new(FALSE, FALSE, sizeof(Way))};
    o->start = g_new0(uint32_t, (gsize)n + 2);
    o->half = g_new(uint32_t, 2 * (gsize)m);
    o->entry = g_new(uint32_t, n);
    o->depth = g_new(uint32_t, n);
    o->order = g_new(uint32_t, n);
    o->length = g_new0(double, n);
    for (uint32_t e = 0; e < m; e++) {
        o->start[EDGE(s, e)->a + 2]++;
        o->start[EDGE(s, e)->b + 2]++;
    }
    for (uint32_t v = 0; v < n; v++)
        o->start[v + 2] += o->start[v + 1];
    for (uint32_t e = 0; e < m; e++) {
        o->half[o->start[EDGE(s, e)->a + 1]++] = e;
        o->half[o->start[EDGE(s, e)->b + 1]++] = e;
    }
    for (uint32_t v = 0; v < n; v++)
        o->entry[v] = o->depth[v] = NONE;
}

static void opening_clear(Opening *o)
{
    g_free(o->start);
    g_free(o->half);
    g_free(o->entry);
    g_free(o->depth);
    g_free(o->order);
    g_free(o->length);
    g_array_unref(o->heap);
}

static uint32_t far_end(const Sketch *s, uint32_t e, uint32_t v) { return EDGE(s, e)->a == v ? EDGE(s, e)->b : EDGE(s, e)->a; }
static uint32_t degree(const Opening *o, uint32_t v) { return o->start[v + 1] - o->start[v]; }

/* The edge that follows e at v on the same line; NONE where the line ends. */
static uint32_t following(const Opening *o, uint32_t e, uint32_t v)
{
    const SketchEdge *edge = EDGE(o->s, e);
    if (edge->b == v)
        return e + 1 < o->n_edges && edge[1].line == edge->line && edge[1].a == v ? e + 1 : NONE;
    return e > 0 && edge[-1].line == edge->line && edge[-1].b == v ? e - 1 : NONE;
}

/* Does a line pass through v? */
static bool is_on_course(const Opening *o, uint32_t v)
{
    for (uint32_t h = o->start[v]; h < o->start[v + 1]; h++)
        if (following(o, o->half[h], v) != NONE)
            return true;
    return false;
}

static uint32_t level_of(const Opening *o, uint32_t e, uint32_t from_line, uint32_t level)
{
    uint32_t line = EDGE(o->s, e)->line, order = LINE(o->s, line)->order;
    return order ? order : line == from_line ? level : level + 1;
}

/* Reaches v and looks at the ways on from there but for `next`, which is taken at once. */
static void reach(Opening *o, uint32_t v, uint32_t entry, uint32_t next, uint32_t level)
{
    const Sketch *s = o->s;
    uint32_t before = entry == NONE ? NONE : far_end(s, entry, v), line = entry == NONE ? NONE : EDGE(s, entry)->line;
    o->entry[v] = entry;
    o->depth[v] = entry == NONE ? 0 : o->depth[before] + 1;
    o->length[v] = entry == NONE ? 0.0 : o->length[before] + vec_dist(NODE(s, before), NODE(s, v));
    o->order[o->n_order++] = v;
    for (uint32_t h = o->start[v]; h < o->start[v + 1]; h++) {
        uint32_t e = o->half[h], w = far_end(s, e, v);
        if (e != next && o->depth[w] == NONE)
            heap_push(o->heap, (Way){level_of(o, e, line, level), false, EDGE(s, e)->width, o->length[v], e, w});
    }
}

/* Follows a line from one of its nodes until it ends or meets what is reached. */
static void follow(Opening *o, Way way)
{
    uint32_t e = way.edge, v = way.node;
    while (e != NONE && o->depth[v] == NONE) {
        uint32_t next = following(o, e, v);
        if (next == NONE && !way.late && is_on_course(o, v)) {
            way = (Way){way.level, true, way.width, way.length, e, v};
            heap_push(o->heap, way);
            return;
        }
        way.late = false;
        reach(o, v, e, next, way.level);
        if (next != NONE)
            v = far_end(o->s, next, v);
        e = next;
    }
}

/* ---- first nodes ---- */

typedef struct {
    uint32_t node, end;
    double dist2, end_dist2; /* from the base */
} Root;

static int by_distance(gconstpointer x, gconstpointer y, gpointer user)
{
    const Root *a = x, *b = y;
    if (a->dist2 != b->dist2)
        return a->dist2 < b->dist2 ? -1 : 1;
    return a->node < b->node ? -1 : a->node > b->node;
}

/* The first node of each part: the one nearest to the base, but a free end that is hardly farther is better. */
static GArray *find_roots(const Opening *o)
{
    const Sketch *s = o->s;
    uint32_t *part = sketch_parts(s);
    Root *root = g_new(Root, o->n_nodes);
    for (uint32_t v = 0; v < o->n_nodes; v++)
        root[v] = (Root){NONE, NONE, HUGE_VAL, HUGE_VAL};
    for (uint32_t v = 0; v < o->n_nodes; v++) {
        Root *r = &root[part_of(part, v)];
        double d2 = vec_norm2(NODE(s, v));
        if (r->node == NONE || d2 < r->dist2) {
            r->node = v;
            r->dist2 = d2;
        }
        if (degree(o, v) == 1 && (r->end == NONE || d2 < r->end_dist2)) {
            r->end = v;
            r->end_dist2 = d2;
        }
    }
    GArray *roots = g_array_new(FALSE, FALSE, sizeof(Root));
    for (uint32_t v = 0; v < o->n_nodes; v++)
        if (root[v].node != NONE) {
            if (root[v].end != NONE && sqrt(root[v].end_dist2) <= sqrt(root[v].dist2) + MAX(s->snap, 1.0))
                root[v].node = root[v].end;
            g_array_append_val(roots, root[v]);
        }
    g_qsort_with_data(roots->data, (gint)roots->len, sizeof(Root), by_distance, NULL);
    g_free(root);
    g_free(part);
    return roots;
}

/* ---- the network ---- */

/* Nodes by depth, those of one depth as they were reached. */
static uint32_t *number_nodes(const Opening *o)
{
    uint32_t *start = g_new0(uint32_t, (gsize)o->n_nodes + 1), *place = g_new(uint32_t, o->n_nodes);
    for (uint32_t v = 0; v < o->n_nodes; v++)
        start[o->depth[v] + 1]++;
    for (uint32_t k = 0; k < o->n_nodes; k++)
        start[k + 1] += start[k];
    for (uint32_t k = 0; k < o->n_nodes; k++)
        place[o->order[k]] = start[o->depth[o->order[k]]]++;
    g_free(start);
    return place;
}

/* Veins by their heads, anastomoses last, as a simulation leaves them. */
static Network *make_network(const Opening *o, uint32_t **line, double **width)
{
    const Sketch *s = o->s;
    Network *net = network_new(o->n_nodes, o->n_edges);
    uint32_t *place = number_nodes(o), *entry = g_new(uint32_t, o->n_nodes), n = 0;
    for (uint32_t v = 0; v < o->n_nodes; v++) {
        net->node[place[v]] = NODE(s, v);
        net->node_birth[place[v]] = o->depth[v];
        entry[place[v]] = o->entry[v];
    }
    *line = g_new(uint32_t, o->n_edges);
    *width = g_new(double, o->n_edges);
    for (uint32_t k = 0; k < o->n_nodes + o->n_edges; k++) {
        uint32_t e = k < o->n_nodes ? entry[k] : k - o->n_nodes;
        if (e == NONE)
            continue;
        uint32_t a = place[EDGE(s, e)->a], b = place[EDGE(s, e)->b];
        if (k >= o->n_nodes && (entry[a] == e || entry[b] == e))
            continue;
        net->tail[n] = MIN(a, b);
        net->head[n] = MAX(a, b);
        net->kind[n] = k < o->n_nodes ? EDGE_VEIN : EDGE_ANASTOMOSIS;
        net->birth[n] = MAX(net->node_birth[a], net->node_birth[b]);
        net->n_steps = MAX(net->n_steps, net->birth[n]);
        (*line)[n] = EDGE(s, e)->line;
        (*width)[n++] = EDGE(s, e)->width;
    }
    g_free(place);
    g_free(entry);
    return net;
}

Network *sketch_open(const Sketch *s, uint32_t **line, double **width)
{
    Opening o;
    opening_init(&o, s);
    GArray *roots = find_roots(&o);
    for (guint k = 0; k < roots->len; k++) {
        reach(&o, g_array_index(roots, Root, k).node, NONE, NONE, 0);
        while (o.heap->len > 0)
            follow(&o, heap_pop(o.heap));
    }
    g_array_unref(roots);
    Network *net = make_network(&o, line, width);
    opening_clear(&o);
    return net;
}
