/* Opens a network from the leaf base: which edges are veins, and which way they lead. */
#include "import/draft.h"

/* An edge that leads out of what was reached. */
typedef struct {
    double rank;  /* lowest first: length of the way to its far end, or minus its width */
    uint32_t edge;
    uint32_t node; /* its far end */
    bool vein;    /* known to be one: these go first, so that all of them are followed unless they run in a circle */
} Way;

typedef struct {
    Draft *draft;
    bool by_width;
    uint32_t *start, *half;   /* edges of each node, those known to be anastomoses left out: half[start[v] … start[v + 1] - 1] */
    uint32_t *entry, *depth;  /* depth NONE: not reached */
    double *length;           /* of the way from the first node, segments */
    uint32_t *part;           /* nodes of one connected part */
    bool *seen;               /* in some part */
    Way *heap;
    uint32_t n_heap;
} Search;

static bool goes_before(const Way *a, const Way *b)
{
    if (a->vein != b->vein)
        return a->vein;
    return a->rank != b->rank ? a->rank < b->rank : a->edge < b->edge;
}

static void heap_push(Search *s, Way way)
{
    uint32_t i = s->n_heap++;
    for (; i > 0 && goes_before(&way, &s->heap[(i - 1) / 2]); i = (i - 1) / 2)
        s->heap[i] = s->heap[(i - 1) / 2];
    s->heap[i] = way;
}

static Way heap_pop(Search *s)
{
    Way top = s->heap[0], last = s->heap[--s->n_heap];
    uint32_t i = 0;
    for (uint32_t k; (k = 2 * i + 1) < s->n_heap; i = k) {
        if (k + 1 < s->n_heap && goes_before(&s->heap[k + 1], &s->heap[k]))
            k++;
        if (!goes_before(&s->heap[k], &last))
            break;
        s->heap[i] = s->heap[k];
    }
    s->heap[i] = last;
    return top;
}

static uint32_t far_end(const Network *net, uint32_t e, uint32_t v) { return net->tail[e] == v ? net->head[e] : net->tail[e]; }

static void search_init(Search *s, Draft *d, uint32_t *entry, uint32_t *depth)
{
    const Network *net = d->net;
    gsize n = net->n_nodes, m = net->n_edges;
    *s = (Search){.draft = d, .by_width = d->given[FIELD_WIDTH] == m, .entry = entry, .depth = depth};
    s->start = g_new0(uint32_t, n + 2);
    s->half = g_new(uint32_t, 2 * m);
    s->length = g_new(double, n);
    s->part = g_new(uint32_t, n);
    s->seen = g_new0(bool, n);
    s->heap = g_new(Way, m);
    for (uint32_t e = 0; e < m; e++)
        if (net->kind[e] != EDGE_ANASTOMOSIS) {
            s->start[net->tail[e] + 2]++;
            s->start[net->head[e] + 2]++;
        }
    for (uint32_t v = 0; v < n; v++)
        s->start[v + 2] += s->start[v + 1];
    for (uint32_t e = 0; e < m; e++)
        if (net->kind[e] != EDGE_ANASTOMOSIS) {
            s->half[s->start[net->tail[e] + 1]++] = e;
            s->half[s->start[net->head[e] + 1]++] = e;
        }
    for (uint32_t v = 0; v < n; v++)
        entry[v] = depth[v] = NONE;
}

static void search_clear(Search *s)
{
    g_free(s->start);
    g_free(s->half);
    g_free(s->length);
    g_free(s->part);
    g_free(s->seen);
    g_free(s->heap);
}

/* The node of v's part that lies nearest to the leaf base, of several the first in the file. */
static uint32_t nearest_to_base(Search *s, uint32_t v)
{
    const Network *net = s->draft->net;
    uint32_t n = 0, best = v;
    Vec2 base = s->draft->base;
    double best2 = vec_dist2(net->node[v], base);
    s->part[n++] = v;
    s->seen[v] = true;
    for (uint32_t k = 0; k < n; k++) {
        uint32_t u = s->part[k];
        double d2 = vec_dist2(net->node[u], base);
        if (d2 < best2 || (d2 == best2 && u < best)) {
            best2 = d2;
            best = u;
        }
        for (uint32_t h = s->start[u]; h < s->start[u + 1]; h++) {
            uint32_t w = far_end(net, s->half[h], u);
            if (!s->seen[w]) {
                s->seen[w] = true;
                s->part[n++] = w;
            }
        }
    }
    return best;
}

static void reach(Search *s, uint32_t v, uint32_t entry, double length)
{
    const Network *net = s->draft->net;
    s->entry[v] = entry;
    s->depth[v] = entry == NONE ? 0 : s->depth[far_end(net, entry, v)] + 1;
    s->length[v] = length;
    for (uint32_t h = s->start[v]; h < s->start[v + 1]; h++) {
        uint32_t e = s->half[h], w = far_end(net, e, v);
        double rank = s->by_width ? -net->width[e] : length + vec_dist(net->node[v], net->node[w]);
        if (s->depth[w] == NONE)
            heap_push(s, (Way){rank, e, w, net->kind[e] == EDGE_VEIN});
    }
}

/* Opens one connected part; each edge enters the heap once at most. */
static void open_part(Search *s, uint32_t root)
{
    const Network *net = s->draft->net;
    reach(s, root, NONE, 0.0);
    while (s->n_heap > 0) {
        Way way = heap_pop(s);
        if (s->depth[way.node] != NONE)
            continue;
        uint32_t from = far_end(net, way.edge, way.node);
        reach(s, way.node, way.edge, s->length[from] + vec_dist(net->node[from], net->node[way.node]));
    }
}

/* An edge of kind vein was not followed, because it closes a circle. */
static gboolean fail_ring(const Search *s, uint32_t e, GError **error)
{
    const Network *net = s->draft->net;
    uint32_t a = net->tail[e], b = net->head[e];
    GArray *ring = g_array_new(FALSE, FALSE, sizeof a), *back = g_array_new(FALSE, FALSE, sizeof b);
    while (a != b) {
        bool from_a = s->depth[a] >= s->depth[b];
        g_array_append_val(from_a ? ring : back, *(from_a ? &a : &b));
        if (from_a)
            a = far_end(net, s->entry[a], a);
        else
            b = far_end(net, s->entry[b], b);
    }
    g_array_append_val(ring, a);
    for (guint k = back->len; k-- > 0;)
        g_array_append_val(ring, g_array_index(back, uint32_t, k));
    g_array_unref(back);
    return draft_fail_ring(s->draft, e, ring, error);
}

/* Sets kinds, and the directions of veins. */
static gboolean take_search(Search *s, GError **error)
{
    Network *net = s->draft->net;
    for (uint32_t e = 0; e < net->n_edges; e++) {
        bool from_tail = s->entry[net->head[e]] == e, from_head = s->entry[net->tail[e]] == e;
        if (net->kind[e] == EDGE_VEIN && !from_tail && !from_head)
            return fail_ring(s, e, error);
    }
    for (uint32_t v = 0; v < net->n_nodes; v++) {
        uint32_t e = s->entry[v];
        if (e == NONE)
            continue;
        uint32_t from = far_end(net, e, v);
        net->tail[e] = from;
        net->head[e] = v;
        net->kind[e] = EDGE_VEIN;
    }
    for (uint32_t e = 0; e < net->n_edges; e++)
        if (net->kind[e] == KIND_UNKNOWN)
            net->kind[e] = EDGE_ANASTOMOSIS;
    return TRUE;
}

gboolean draft_search(Draft *d, uint32_t *entry, uint32_t *depth, GError **error)
{
    Search s;
    search_init(&s, d, entry, depth);
    for (uint32_t v = 0; v < d->net->n_nodes; v++)
        if (!s.seen[v])
            open_part(&s, nearest_to_base(&s, v));
    gboolean good = take_search(&s, error);
    search_clear(&s);
    return good;
}
