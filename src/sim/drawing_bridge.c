/* Parts of a drawing that do not touch are joined over gaps. */
#include "geom/quadtree.h"
#include "sim/drawing_private.h"

typedef struct {
    uint32_t end, to; /* nodes */
    uint32_t line;
    double width; /* of the line at its end */
    double dist2;
    bool found;
} Bridge;

typedef struct {
    const uint32_t *part;
    uint32_t own;
} Elsewhere;

static bool is_elsewhere(const void *user, uint32_t v)
{
    const Elsewhere *x = user;
    return x->part[v] != x->own;
}

/* Does the straight way between two places stay in the blade? */
static bool is_inside(const Sketch *s, Vec2 a, Vec2 b)
{
    uint32_t n = 2 + (uint32_t)ceil(2.0 * vec_dist(a, b));
    bool inside = true;
    for (uint32_t k = 1; k < n && inside; k++) {
        Vec2 p = vec_lerp(a, b, (double)k / (double)n);
        inside = polygon_contains(s->blade, p) || vec_dist(polygon_nearest(s->blade, p, NULL), p) <= 1e-6;
    }
    return inside;
}

/* Ends of lines: the first and the last node of each run of edges. */
static GArray *find_ends(const Sketch *s)
{
    GArray *ends = g_array_new(FALSE, FALSE, sizeof(Bridge));
    for (guint e = 0; e < s->edge->len; e++) {
        const SketchEdge *edge = EDGE(s, e);
        Bridge begins = {.end = edge->a, .line = edge->line, .width = edge->width}, ends_here = begins;
        ends_here.end = edge->b;
        if (e == 0 || edge[-1].line != edge->line || edge[-1].b != edge->a)
            g_array_append_val(ends, begins);
        if (e + 1 == s->edge->len || edge[1].line != edge->line || edge[1].a != edge->b)
            g_array_append_val(ends, ends_here);
    }
    return ends;
}

static uint32_t nearest_base(const Sketch *s)
{
    uint32_t best = 0;
    for (uint32_t v = 1; v < s->node->len; v++)
        if (vec_norm2(NODE(s, v)) < vec_norm2(NODE(s, best)))
            best = v;
    return best;
}

/* For each part but that of the base its end that is nearest to another part; nothing is found before. */
static void find_bridges(const Sketch *s, const Quadtree *tree, const uint32_t *part, uint32_t base, GArray *ends, Bridge *best)
{
    for (guint k = 0; k < ends->len; k++) {
        Bridge *b = &g_array_index(ends, Bridge, k);
        Elsewhere x = {part, part[b->end]};
        if (x.own == part[base])
            continue;
        b->to = quadtree_nearest(tree, NODE(s, b->end), s->gap * s->gap, is_elsewhere, &x, &b->dist2);
        b->found = b->to != NO_POINT && is_inside(s, NODE(s, b->end), NODE(s, b->to));
        if (b->found && (!best[x.own].found || b->dist2 < best[x.own].dist2))
            best[x.own] = *b;
    }
}

static int by_distance(gconstpointer x, gconstpointer y, gpointer user)
{
    const Bridge *a = x, *b = y;
    if (a->dist2 != b->dist2)
        return a->dist2 < b->dist2 ? -1 : 1;
    return a->end < b->end ? -1 : a->end > b->end;
}

static void build(Sketch *s, const Bridge *b)
{
    Vec2 from = NODE(s, b->end), to = NODE(s, b->to);
    uint32_t n = (uint32_t)MAX(ceil(sqrt(b->dist2) - 1e-9), 1.0), last = b->end;
    for (uint32_t k = 1; k <= n; k++) {
        SketchEdge edge = {last, b->to, b->line, b->width};
        if (k < n) {
            Vec2 p = vec_lerp(from, to, (double)k / (double)n);
            edge.b = s->node->len;
            g_array_append_val(s->node, p);
        }
        last = edge.b;
        g_array_append_val(s->edge, edge);
    }
}

/* One round: the shortest bridges first, unless others have joined their parts. */
static bool build_bridges(Sketch *s, uint32_t *part, const Bridge *best, uint32_t n)
{
    GArray *bridges = g_array_new(FALSE, FALSE, sizeof(Bridge));
    for (uint32_t v = 0; v < n; v++)
        if (best[v].found)
            g_array_append_val(bridges, best[v]);
    if (bridges->len > 1)
        g_qsort_with_data(bridges->data, (gint)bridges->len, sizeof(Bridge), by_distance, NULL);
    for (guint k = 0; k < bridges->len; k++) {
        const Bridge *b = &g_array_index(bridges, Bridge, k);
        uint32_t p = part_of(part, b->end), q = part_of(part, b->to);
        if (p == q)
            continue;
        part[MAX(p, q)] = MIN(p, q);
        build(s, b);
    }
    bool any = bridges->len > 0;
    g_array_unref(bridges);
    return any;
}

void sketch_bridge(Sketch *s)
{
    uint32_t n = s->node->len;
    if (n == 0)
        return;
    uint32_t *part = sketch_parts(s), base = nearest_base(s);
    Bridge *best = g_new0(Bridge, n);
    GArray *ends = find_ends(s);
    Box2 box = box_empty();
    Quadtree tree;
    for (uint32_t v = 0; v < n; v++)
        box = box_add(box, NODE(s, v));
    quadtree_init(&tree, box);
    for (uint32_t v = 0; v < n; v++)
        quadtree_add(&tree, NODE(s, v), v);
    do { /* bridges' own nodes stay out of it */
        for (uint32_t v = 0; v < n; v++) {
            part[v] = part_of(part, v);
            best[v].found = false;
        }
        find_bridges(s, &tree, part, base, ends, best);
    } while (build_bridges(s, part, best, n));
    quadtree_clear(&tree);
    g_array_unref(ends);
    g_free(best);
    g_free(part);
}
