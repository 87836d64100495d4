/* Thinned pixels as a graph of junctions, ends and the pieces between them; and what of it is no vein. */
#include "scan/centre_private.h"

typedef struct {
    const Thinned *t;
    CentreGraph *g;
    ptrdiff_t step[8];
    uint32_t *node;      /* [n] of a pixel, CENTRE_NONE on pieces */
    uint8_t *neighbours; /* [n] how many */
    bool *seen;          /* [n] pieces' pixels */
    uint32_t *row;       /* where each row's pixels begin */
} Tracing;

/* Number of the line pixel at a place. */
static uint32_t number_at(const Tracing *w, size_t at)
{
    uint32_t y = (uint32_t)(at / w->t->stride), low = w->row[y], high = w->row[y + 1];
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        if (w->t->at[middle] <= at)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* The numbers of a pixel's neighbours, clockwise. */
static uint32_t neighbours_of(const Tracing *w, uint32_t i, uint32_t out[8])
{
    uint32_t n = 0;
    for (unsigned k = 0; k < 8; k++) {
        size_t at = w->t->at[i] + (size_t)w->step[k];
        if (w->t->px[at] & THIN_LINE)
            out[n++] = number_at(w, at);
    }
    return n;
}

static void tracing_init(Tracing *w, CentreGraph *g, const Thinned *t)
{
    ptrdiff_t s = t->stride;
    *w = (Tracing){t, g, {-s, 1 - s, 1, 1 + s, s, s - 1, -1, -s - 1}, g_new(uint32_t, t->n), g_new(uint8_t, t->n), g_new0(bool, t->n), NULL};
    uint32_t rows = t->box.y1 - t->box.y0 + 3, near[8];
    w->row = g_new0(uint32_t, rows + 1);
    for (uint32_t i = 0; i < t->n; i++)
        w->row[t->at[i] / t->stride + 1]++;
    for (uint32_t y = 0; y < rows; y++)
        w->row[y + 1] += w->row[y];
    for (uint32_t i = 0; i < t->n; i++) {
        w->node[i] = CENTRE_NONE;
        w->neighbours[i] = (uint8_t)neighbours_of(w, i, near);
    }
}

static void tracing_clear(Tracing *w)
{
    g_free(w->node);
    g_free(w->neighbours);
    g_free(w->seen);
    g_free(w->row);
}

/* A node of the pixel i and, of a junction, of all that touch it and are as much one. */
static void add_node(Tracing *w, uint32_t i, GArray *stack)
{
    uint32_t number = w->g->node->len, n = 0, near[8];
    CentreNode node = {.r = 0.0};
    g_array_set_size(stack, 0);
    g_array_append_val(stack, i);
    w->node[i] = number;
    while (stack->len > 0) {
        uint32_t j = g_array_index(stack, uint32_t, stack->len - 1);
        g_array_set_size(stack, stack->len - 1);
        node.p = vec_add(node.p, thinned_place(w->t, w->t->at[j]));
        node.r = fmax(node.r, w->t->radius[j]);
        n++;
        uint32_t count = w->neighbours[j] > 2 ? neighbours_of(w, j, near) : 0;
        for (uint32_t k = 0; k < count; k++)
            if (w->neighbours[near[k]] > 2 && w->node[near[k]] == CENTRE_NONE) {
                w->node[near[k]] = number;
                g_array_append_val(stack, near[k]);
            }
    }
    node.p = vec_scale(node.p, 1.0 / n);
    g_array_append_val(w->g->node, node);
}

static void add_edge(CentreGraph *g, uint32_t a, uint32_t b, uint32_t first)
{
    CentreEdge e = {.node = {a, b}, .first = first, .n = g->point->len - first};
    Vec2 last = centre_node(g, a)->p;
    for (uint32_t i = 0; i < e.n; i++) {
        e.length += vec_dist(last, centre_point(g, first + i)->p);
        last = centre_point(g, first + i)->p;
    }
    e.length += vec_dist(last, centre_node(g, b)->p);
    centre_node(g, a)->degree++;
    centre_node(g, b)->degree++;
    g_array_append_val(g->edge, e);
}

/* Follows a piece from the pixel `from` of a node over `i`, which has two neighbours, to the next node. */
static void follow(Tracing *w, uint32_t from, uint32_t i)
{
    uint32_t start = w->node[from], first = w->g->point->len, near[8];
    while (w->node[i] == CENTRE_NONE) {
        CentrePoint p = {thinned_place(w->t, w->t->at[i]), w->t->radius[i]};
        g_array_append_val(w->g->point, p);
        w->seen[i] = true;
        neighbours_of(w, i, near);
        uint32_t next = near[0] == from ? near[1] : near[0];
        from = i;
        i = next;
    }
    add_edge(w->g, start, w->node[i], first);
}

static void follow_all(Tracing *w, uint32_t i)
{
    uint32_t near[8], n = neighbours_of(w, i, near);
    for (uint32_t k = 0; k < n; k++) {
        if (w->node[near[k]] == CENTRE_NONE && !w->seen[near[k]])
            follow(w, i, near[k]);
        else if (w->node[near[k]] != CENTRE_NONE && w->node[near[k]] != w->node[i] && i < near[k])
            add_edge(w->g, w->node[i], w->node[near[k]], w->g->point->len); /* an end beside a junction, or two ends */
    }
}

void centre_graph_init(CentreGraph *g, const Thinned *t)
{
    g->node = g_array_new(FALSE, FALSE, sizeof(CentreNode));
    g->edge = g_array_new(FALSE, FALSE, sizeof(CentreEdge));
    g->point = g_array_new(FALSE, FALSE, sizeof(CentrePoint));
    Tracing w;
    tracing_init(&w, g, t);
    GArray *stack = g_array_new(FALSE, FALSE, sizeof(uint32_t));
    for (uint32_t i = 0; i < t->n; i++)
        if (w.neighbours[i] != 2 && w.node[i] == CENTRE_NONE)
            add_node(&w, i, stack);
    for (uint32_t i = 0; i < t->n; i++)
        if (w.neighbours[i] != 2)
            follow_all(&w, i);
    for (uint32_t i = 0; i < t->n; i++)
        if (w.node[i] == CENTRE_NONE && !w.seen[i]) { /* of a ring */
            add_node(&w, i, stack);
            follow_all(&w, i);
        }
    g_array_free(stack, TRUE);
    tracing_clear(&w);
}

void centre_graph_clear(CentreGraph *g)
{
    g_array_free(g->node, TRUE);
    g_array_free(g->edge, TRUE);
    g_array_free(g->point, TRUE);
}

/* ---- pruning ---- */

/* The edges at each node: those of node i are edge[start[i]] … edge[start[i + 1] - 1]. */
typedef struct {
    uint32_t *start, *edge;
} Stars;

static void stars_init(Stars *s, const CentreGraph *g)
{
    s->start = g_new0(uint32_t, g->node->len + 2);
    s->edge = g_new(uint32_t, 2 * g->edge->len + 1);
    for (uint32_t i = 0; i < g->edge->len; i++)
        for (uint32_t k = 0; k < 2; k++)
            s->start[centre_edge(g, i)->node[k] + 2]++;
    for (uint32_t i = 0; i < g->node->len; i++)
        s->start[i + 2] += s->start[i + 1];
    for (uint32_t i = 0; i < g->edge->len; i++)
        for (uint32_t k = 0; k < 2; k++)
            s->edge[s->start[centre_edge(g, i)->node[k] + 1]++] = i;
}

static void stars_clear(Stars *s)
{
    g_free(s->start);
    g_free(s->edge);
}

static void remove_edge(CentreGraph *g, uint32_t i)
{
    CentreEdge *e = centre_edge(g, i);
    e->gone = true;
    centre_node(g, e->node[0])->degree--;
    centre_node(g, e->node[1])->degree--;
}

/* The edge at a node that is there yet, other than `but`; of several the first. */
static uint32_t other_edge(const CentreGraph *g, const Stars *s, uint32_t node, uint32_t but)
{
    for (uint32_t k = s->start[node]; k < s->start[node + 1]; k++)
        if (s->edge[k] != but && !centre_edge(g, s->edge[k])->gone)
            return s->edge[k];
    return CENTRE_NONE;
}

typedef struct {
    uint32_t end, last, junction; /* the free end, and the edge that reaches the junction */
    double length;
} Spur;

/* The way from a free end to the first junction, over what joins only two; false when there is none. */
static bool walk_in(const CentreGraph *g, const Stars *s, uint32_t end, Spur *out)
{
    *out = (Spur){end, other_edge(g, s, end, CENTRE_NONE), end, 0.0};
    for (;;) {
        const CentreEdge *e = centre_edge(g, out->last);
        out->length += e->length;
        out->junction = e->node[0] == out->junction ? e->node[1] : e->node[0];
        uint32_t degree = centre_node(g, out->junction)->degree;
        if (degree != 2)
            return degree > 2;
        out->last = other_edge(g, s, out->junction, out->last);
    }
}

static void remove_spur(CentreGraph *g, const Stars *s, const Spur *spur)
{
    uint32_t node = spur->end;
    for (uint32_t i = CENTRE_NONE; i != spur->last;) {
        i = other_edge(g, s, node, CENTRE_NONE); /* what led here is gone */
        const CentreEdge *e = centre_edge(g, i);
        node = e->node[0] == node ? e->node[1] : e->node[0];
        remove_edge(g, i);
    }
}

/* By junction, there longest first, of equals as they were found. */
static gint by_junction(gconstpointer a, gconstpointer b, gpointer user)
{
    const Spur *s = a, *t = b;
    return s->junction != t->junction ? (s->junction < t->junction ? -1 : 1) : (s->length < t->length) - (s->length > t->length);
}

/* One round: what is too short to be a vein goes, all at a junction at once, so that of the two hairs in the corners of a blunt end neither stays
 * and bends it. Where nothing else would remain the two longest stay. Returns whether any went. */
static bool prune_spurs(CentreGraph *g, const Stars *s, double spur)
{
    GArray *spurs = g_array_new(FALSE, FALSE, sizeof(Spur));
    for (uint32_t i = 0; i < g->node->len; i++) {
        Spur found;
        if (centre_node(g, i)->degree == 1 && walk_in(g, s, i, &found) &&
            found.length + centre_node(g, i)->r < spur * 2.0 * centre_node(g, found.junction)->r)
            g_array_append_val(spurs, found);
    }
    if (spurs->len > 0)
        g_qsort_with_data(spurs->data, (gint)spurs->len, sizeof(Spur), by_junction, NULL);
    bool any = false;
    for (guint i = 0, end; i < spurs->len; i = end) {
        uint32_t junction = g_array_index(spurs, Spur, i).junction;
        for (end = i + 1; end < spurs->len && g_array_index(spurs, Spur, end).junction == junction;)
            end++;
        for (guint k = centre_node(g, junction)->degree == end - i ? i + 2 : i; k < end; k++) {
            remove_spur(g, s, &g_array_index(spurs, Spur, k));
            any = true;
        }
    }
    g_array_free(spurs, TRUE);
    return any;
}

static uint32_t root_of(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i)
        i = parent[i] = parent[parent[i]];
    return i;
}

static gint shorter_first(gconstpointer a, gconstpointer b, gpointer user)
{
    const CentreGraph *g = user;
    double d = centre_edge(g, *(const uint32_t *)a)->length - centre_edge(g, *(const uint32_t *)b)->length;
    return (d > 0.0) - (d < 0.0);
}

#define NEAR 2.0 /* pixels by which thinning may part them farther */

/* Lines that cross, or leave a wide vein opposite one another, seldom meet in one pixel: a junction in another's disc is the same. */
static void merge_junctions(CentreGraph *g)
{
    uint32_t *parent = g_new(uint32_t, g->node->len + 1), n = 0, *order = g_new(uint32_t, g->edge->len + 1);
    for (uint32_t i = 0; i < g->node->len; i++)
        parent[i] = i;
    for (uint32_t i = 0; i < g->edge->len; i++) {
        const CentreEdge *e = centre_edge(g, i);
        const CentreNode *a = centre_node(g, e->node[0]), *b = centre_node(g, e->node[1]);
        if (!e->gone && a != b && a->degree > 2 && b->degree > 2 && e->length <= MIN(a->r, b->r) + NEAR)
            order[n++] = i;
    }
    if (n > 0)
        g_qsort_with_data(order, (gint)n, sizeof *order, shorter_first, g);
    for (uint32_t k = 0; k < n; k++) {
        CentreEdge *e = centre_edge(g, order[k]);
        uint32_t i = root_of(parent, e->node[0]), j = root_of(parent, e->node[1]);
        CentreNode *a = centre_node(g, MIN(i, j)), *b = centre_node(g, MAX(i, j));
        if (i == j || !(vec_dist(a->p, b->p) <= MIN(a->r, b->r) + NEAR))
            continue;
        parent[MAX(i, j)] = MIN(i, j);
        e->gone = true;
        *a = (CentreNode){vec_lerp(a->p, b->p, 0.5), MAX(a->r, b->r), a->degree + b->degree - 2};
        b->degree = 0;
    }
    for (uint32_t i = 0; i < g->edge->len; i++)
        for (uint32_t k = 0; k < 2; k++)
            centre_edge(g, i)->node[k] = root_of(parent, centre_edge(g, i)->node[k]);
    g_free(order);
    g_free(parent);
}

static void drop_specks(CentreGraph *g, double least)
{
    uint32_t *parent = g_new(uint32_t, g->node->len + 1);
    double *length = g_new0(double, g->node->len + 1);
    for (uint32_t i = 0; i < g->node->len; i++)
        parent[i] = i;
    for (uint32_t i = 0; i < g->edge->len; i++) {
        const CentreEdge *e = centre_edge(g, i);
        uint32_t a = root_of(parent, e->node[0]), b = root_of(parent, e->node[1]);
        if (!e->gone)
            parent[MAX(a, b)] = MIN(a, b);
    }
    for (uint32_t i = 0; i < g->edge->len; i++)
        if (!centre_edge(g, i)->gone)
            length[root_of(parent, centre_edge(g, i)->node[0])] += centre_edge(g, i)->length;
    for (uint32_t i = 0; i < g->node->len; i++)
        if (centre_node(g, i)->degree == 1)
            length[root_of(parent, i)] += centre_node(g, i)->r; /* to the border */
    for (uint32_t i = 0; i < g->edge->len; i++)
        if (!centre_edge(g, i)->gone && length[root_of(parent, centre_edge(g, i)->node[0])] < least)
            remove_edge(g, i);
    g_free(length);
    g_free(parent);
}

void centre_graph_prune(CentreGraph *g, const CentreDef *def)
{
    Stars s;
    stars_init(&s, g);
    while (prune_spurs(g, &s, def->spur))
        ;
    stars_clear(&s);
    merge_junctions(g);
    drop_specks(g, def->least);
}
