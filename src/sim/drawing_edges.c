/* Lines become edges: nodes where lines meet, and so many between that no edge is longer than a segment. */
#include "sim/drawing_private.h"

/* Nodes nearer to one another than this are one (an edge needs a length that survives being written), segments. */
static const double shortest = 1e-5;

uint32_t part_of(uint32_t *part, uint32_t v)
{
    while (part[v] != v)
        v = part[v] = part[part[v]];
    return v;
}

static void unite(uint32_t *part, uint32_t a, uint32_t b)
{
    a = part_of(part, a);
    b = part_of(part, b);
    part[MAX(a, b)] = MIN(a, b);
}

static uint32_t *identity(uint32_t n)
{
    uint32_t *part = g_new(uint32_t, n);
    for (uint32_t v = 0; v < n; v++)
        part[v] = v;
    return part;
}

/* ---- adding ---- */

static void add_edge(Sketch *s, uint32_t a, uint32_t b, uint32_t line, double width)
{
    SketchEdge e = {a, b, line, width};
    g_array_append_val(s->edge, e);
}

static uint32_t add_node(Sketch *s, Vec2 p)
{
    g_array_append_val(s->node, p);
    return s->node->len - 1;
}

/* ---- from cut to cut ---- */

static int by_place(gconstpointer x, gconstpointer y, gpointer user)
{
    const Cut *a = x, *b = y;
    if (a->line != b->line)
        return a->line < b->line ? -1 : 1;
    if (a->along != b->along)
        return a->along < b->along ? -1 : 1;
    return (a->node > b->node) - (a->node < b->node);
}

/* A line has a node at either end. */
static void cut_ends(Sketch *s)
{
    guint n = s->cut->len;
    bool *has = g_new0(bool, 2 * (gsize)s->line->len);
    for (guint c = 0; c < n; c++) {
        const Cut *cut = &g_array_index(s->cut, Cut, c);
        const Line *line = LINE(s, cut->line);
        has[2 * cut->line] |= line->extra[0] > 0.0 || cut->along <= line->end[0];
        has[2 * cut->line + 1] |= line->extra[1] > 0.0 || cut->along >= line->end[1];
    }
    for (uint32_t k = 0; k < s->line->len; k++)
        for (int end = 0; end < 2; end++)
            if (!has[2 * k + end]) {
                double along = LINE(s, k)->end[end];
                Cut cut = {k, s->node->len, NONE, along};
                add_node(s, line_spot(s, LINE(s, k), along).p);
                g_array_append_val(s->cut, cut);
            }
    g_free(has);
    if (s->cut->len > 1)
        g_qsort_with_data(s->cut->data, (gint)s->cut->len, sizeof(Cut), by_place, NULL);
}

/* Cuts that follow closely on a line are one node: nodes of crossings, which are the first, prevail over free ends. */
static void merge_cuts(Sketch *s)
{
    uint32_t *part = identity(s->node->len);
    Cut *cut = &g_array_index(s->cut, Cut, 0);
    for (guint c = 1; c < s->cut->len; c++)
        if (cut[c].line == cut[c - 1].line && cut[c].along - cut[c - 1].along < drawing_least)
            unite(part, cut[c].node, cut[c - 1].node);
    for (guint c = 0; c < s->cut->len; c++)
        cut[c].node = part_of(part, cut[c].node);
    g_free(part);
}

static void divide_piece(Sketch *s, const Cut *from, const Cut *to)
{
    const Line *line = LINE(s, from->line);
    double length = to->along - from->along;
    if (from->node == to->node && length <= 2.0)
        return; /* it leads out and back at once */
    uint32_t n = (uint32_t)MAX(ceil(length - 1e-9), 1.0), last = from->node;
    Spot a = line_spot(s, line, from->along);
    for (uint32_t k = 1; k <= n; k++) {
        Spot b = line_spot(s, line, k < n ? from->along + length * (double)k / (double)n : to->along);
        uint32_t node = k < n ? add_node(s, b.p) : to->node;
        add_edge(s, last, node, from->line, 0.5 * (a.width + b.width));
        last = node;
        a = b;
    }
}

/* ---- cleaning ---- */

/* Ends of edges without length become one node; whether there were such. */
static bool contract(Sketch *s)
{
    uint32_t *part = identity(s->node->len);
    for (guint e = 0; e < s->edge->len; e++)
        if (vec_dist2(NODE(s, EDGE(s, e)->a), NODE(s, EDGE(s, e)->b)) < shortest * shortest)
            unite(part, EDGE(s, e)->a, EDGE(s, e)->b);
    guint n = 0;
    for (guint e = 0; e < s->edge->len; e++) {
        SketchEdge edge = *EDGE(s, e);
        edge.a = part_of(part, edge.a);
        edge.b = part_of(part, edge.b);
        if (edge.a != edge.b)
            *EDGE(s, n++) = edge;
    }
    bool any = n < s->edge->len;
    g_array_set_size(s->edge, n);
    g_free(part);
    return any;
}

/* Of edges that join the same nodes the one of the coarsest line stays. */
static void drop_doubles(Sketch *s)
{
    uint32_t n_nodes = s->node->len, n = s->edge->len;
    uint32_t *start = g_new0(uint32_t, (gsize)n_nodes + 1), *far_end = g_new(uint32_t, n), kept = 0;
    for (uint32_t e = 0; e < n; e++)
        start[MIN(EDGE(s, e)->a, EDGE(s, e)->b) + 1]++;
    for (uint32_t v = 0; v < n_nodes; v++)
        start[v + 1] += start[v];
    uint32_t *end = g_memdup2(start, ((gsize)n_nodes + 1) * sizeof *start);
    for (uint32_t e = 0; e < n; e++) {
        SketchEdge edge = *EDGE(s, e);
        uint32_t near = MIN(edge.a, edge.b), far = MAX(edge.a, edge.b);
        bool twice = false;
        for (uint32_t k = start[near]; k < end[near] && !twice; k++)
            twice = far_end[k] == far;
        if (twice)
            continue;
        far_end[end[near]++] = far;
        *EDGE(s, kept++) = edge;
    }
    g_array_set_size(s->edge, kept);
    g_free(start);
    g_free(end);
    g_free(far_end);
}

/* Nodes without an edge go. */
static void drop_bare_nodes(Sketch *s)
{
    uint32_t *number = g_new0(uint32_t, s->node->len), n = 0;
    for (guint e = 0; e < s->edge->len; e++)
        number[EDGE(s, e)->a] = number[EDGE(s, e)->b] = 1;
    for (uint32_t v = 0; v < s->node->len; v++)
        if (number[v]) {
            NODE(s, n) = NODE(s, v);
            number[v] = n++;
        }
    g_array_set_size(s->node, n);
    for (guint e = 0; e < s->edge->len; e++) {
        EDGE(s, e)->a = number[EDGE(s, e)->a];
        EDGE(s, e)->b = number[EDGE(s, e)->b];
    }
    g_free(number);
}

/* Edges that merging has stretched beyond a segment are divided. */
static void divide_long(Sketch *s)
{
    GArray *old = s->edge;
    s->edge = g_array_sized_new(FALSE, FALSE, sizeof(SketchEdge), old->len);
    for (guint e = 0; e < old->len; e++) {
        SketchEdge edge = g_array_index(old, SketchEdge, e);
        Vec2 a = NODE(s, edge.a), b = NODE(s, edge.b);
        uint32_t n = (uint32_t)MAX(ceil(vec_dist(a, b) - 1e-9), 1.0), last = edge.a;
        for (uint32_t k = 1; k <= n; k++) {
            uint32_t node = k < n ? add_node(s, vec_lerp(a, b, (double)k / (double)n)) : edge.b;
            add_edge(s, last, node, edge.line, edge.width);
            last = node;
        }
    }
    g_array_unref(old);
}

void sketch_divide(Sketch *s)
{
    cut_ends(s);
    merge_cuts(s);
    for (guint c = 1; c < s->cut->len; c++) {
        const Cut *cut = &g_array_index(s->cut, Cut, c);
        if (cut->line == cut[-1].line)
            divide_piece(s, &cut[-1], cut);
    }
    while (contract(s))
        ;
    drop_doubles(s);
    divide_long(s);
    drop_bare_nodes(s);
}

uint32_t *sketch_parts(const Sketch *s)
{
    uint32_t *part = identity(s->node->len);
    for (guint e = 0; e < s->edge->len; e++)
        unite(part, EDGE(s, e)->a, EDGE(s, e)->b);
    return part;
}
