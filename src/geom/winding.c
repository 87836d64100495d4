#include "geom/winding.h"

#include <string.h>

#include "geom/turn.h"
#include "geom/winding_private.h"

enum { NONE = UINT32_MAX };

/* A part smaller than this share of the largest is a slip of the pen: the tip of a tooth with its sides crossed. */
static const double slip = 0.01;

/* Edges from either end: 2 i runs along edge i, 2 i + 1 back. */
typedef struct {
    const WindLines *w;
    uint32_t n;          /* half-edges */
    uint32_t *out, *at;  /* [n] by the node they leave, counter-clockwise from +x; and where there a half-edge is */
    uint32_t *first;     /* [nodes + 1] a node's part of `out` */
    uint32_t *component; /* [nodes] NONE: has no edge */
    int32_t *left;       /* [n] how often the lines wind around what lies to the left */
    uint8_t *known;      /* [nodes] `left` is, of the half-edges that leave it */
} Graph;

static inline Vec2 place(const Graph *g, uint32_t node) { return g_array_index(g->w->node, Vec2, node); }
static inline const WindEdge *edge_of(const Graph *g, uint32_t h) { return &g_array_index(g->w->edge, WindEdge, h >> 1); }
static inline uint32_t from(const Graph *g, uint32_t h) { return h & 1 ? edge_of(g, h)->b : edge_of(g, h)->a; }
static inline uint32_t to(const Graph *g, uint32_t h) { return from(g, h ^ 1); }
static inline int32_t turns(const Graph *g, uint32_t h) { return h & 1 ? -edge_of(g, h)->turns : edge_of(g, h)->turns; }

/* ---- the plane graph ---- */

static int around(const void *a, const void *b, void *graph)
{
    const Graph *g = graph;
    uint32_t h = *(const uint32_t *)a, k = *(const uint32_t *)b, v = from(g, h), w = from(g, k);
    if (v != w)
        return v < w ? -1 : 1;
    if (h == k)
        return 0;
    return turn_before(place(g, v), place(g, to(g, h)), place(g, to(g, k))) ? -1 : 1; /* no two in one direction */
}

static void graph_init(Graph *g, const WindLines *w)
{
    uint32_t nodes = w->node->len, n = 2 * w->edge->len;
    *g = (Graph){.w = w, .n = n, .out = g_new(uint32_t, n), .at = g_new(uint32_t, n), .first = g_new0(uint32_t, (gsize)nodes + 1),
                 .component = g_new(uint32_t, nodes), .left = g_new0(int32_t, n), .known = g_new0(uint8_t, nodes)};
    for (uint32_t h = 0; h < n; h++) {
        g->out[h] = h;
        g->first[from(g, h) + 1]++;
    }
    for (uint32_t v = 0; v < nodes; v++) {
        g->first[v + 1] += g->first[v];
        g->component[v] = NONE;
    }
    g_qsort_with_data(g->out, (gint)n, sizeof *g->out, around, g);
    for (uint32_t i = 0; i < n; i++)
        g->at[g->out[i]] = i;
}

static void graph_clear(Graph *g)
{
    g_free(g->out);
    g_free(g->at);
    g_free(g->first);
    g_free(g->component);
    g_free(g->left);
    g_free(g->known);
}

/* Marks all nodes that hang together with v; the lowest of them, leftmost of equals. */
static uint32_t mark_component(Graph *g, uint32_t v, uint32_t number, GArray *stack)
{
    uint32_t low = v;
    g->component[v] = number;
    g_array_append_val(stack, v);
    while (stack->len > 0) {
        v = g_array_index(stack, uint32_t, stack->len - 1);
        g_array_set_size(stack, stack->len - 1);
        Vec2 p = place(g, v), q = place(g, low);
        low = p.y < q.y || (p.y == q.y && p.x < q.x) ? v : low;
        for (uint32_t i = g->first[v]; i < g->first[v + 1]; i++) {
            uint32_t next = to(g, g->out[i]);
            if (g->component[next] == NONE) {
                g->component[next] = number;
                g_array_append_val(stack, next);
            }
        }
    }
    return low;
}

/* ---- how often the lines wind around ---- */

/* Around a node, by the lines that do not hang together with it. */
static int32_t others_around(const Graph *g, uint32_t v)
{
    Vec2 p = place(g, v);
    int32_t sum = 0;
    for (uint32_t h = 0; h < g->n; h += 2) {
        Vec2 a = place(g, from(g, h)), b = place(g, to(g, h));
        if ((a.y <= p.y) == (b.y <= p.y) || g->component[from(g, h)] == g->component[v])
            continue;
        if (a.y <= p.y)
            sum += turn_sign(a, b, p) > 0 ? turns(g, h) : 0;
        else
            sum -= turn_sign(a, b, p) < 0 ? turns(g, h) : 0;
    }
    return sum;
}

/* From one half-edge of v whose right side is known, to all that hang together with it. */
static void spread(Graph *g, uint32_t v, uint32_t h, int32_t right, GArray *stack)
{
    for (;;) {
        uint32_t n = g->first[v + 1] - g->first[v], begin = g->at[h] - g->first[v];
        for (uint32_t i = 0; i < n; i++) {
            h = g->out[g->first[v] + (begin + i) % n];
            g->left[h ^ 1] = right;
            g->left[h] = right += turns(g, h);
            g_array_append_val(stack, h);
        }
        g->known[v] = 1;
        do {
            if (stack->len == 0)
                return;
            h = g_array_index(stack, uint32_t, stack->len - 1) ^ 1;
            g_array_set_size(stack, stack->len - 1);
            v = from(g, h);
        } while (g->known[v]);
        right = g->left[h ^ 1];
    }
}

static void wind(Graph *g)
{
    GArray *stack = g_array_new(FALSE, FALSE, sizeof(uint32_t)), *low = g_array_new(FALSE, FALSE, sizeof(uint32_t));
    for (uint32_t h = 0; h < g->n; h += 2) {
        uint32_t v = from(g, h);
        if (g->component[v] != NONE)
            continue;
        v = mark_component(g, v, low->len, stack);
        g_array_append_val(low, v);
    }
    for (uint32_t i = 0; i < low->len; i++) { /* to the right of a lowest node's first edge lies what is around them all */
        uint32_t v = g_array_index(low, uint32_t, i);
        spread(g, v, g->out[g->first[v]], others_around(g, v), stack);
    }
    g_array_unref(stack);
    g_array_unref(low);
}

/* ---- margins ---- */

static inline bool within(const Graph *g, uint32_t h) { return g->left[h] != 0; }
static inline bool is_margin(const Graph *g, uint32_t h) { return within(g, h) && !within(g, h ^ 1); }

/* The margin goes on with the next one clockwise from where it came from. */
static uint32_t next_margin(const Graph *g, uint32_t h)
{
    uint32_t v = to(g, h), n = g->first[v + 1] - g->first[v], k = g->at[h ^ 1] - g->first[v];
    do {
        k = k ? k - 1 : n - 1;
        h = g->out[g->first[v] + k];
    } while (within(g, h) == within(g, h ^ 1));
    return h;
}

/* The largest part, and what of the second is to be told. */
typedef struct {
    GArray *ring; /* nodes */
    double area, second;
    uint32_t begin, other; /* their first points */
} Largest;

static double ring_area(const Graph *g, const uint32_t *v, uint32_t n)
{
    double twice = 0.0;
    Vec2 o = place(g, v[0]);
    for (uint32_t i = 1; i + 1 < n; i++)
        twice += vec_cross(vec_sub(place(g, v[i]), o), vec_sub(place(g, v[i + 1]), o));
    return 0.5 * twice;
}

/* The input's first point on a ring; of one that has crossings alone, before them. */
static uint32_t ring_begin(const Graph *g, const uint32_t *v, uint32_t n)
{
    uint32_t first = NONE, before = NONE;
    for (uint32_t i = 0; i < n; i++) {
        uint32_t source = g_array_index(g->w->source, uint32_t, v[i]);
        before = MIN(before, source);
        first = v[i] < g->w->n_points ? MIN(first, source) : first;
    }
    return first != NONE ? first : before;
}

/* What runs clockwise encloses a gap, which is filled. */
static void take_ring(const Graph *g, const uint32_t *v, uint32_t n, Largest *best)
{
    double area = ring_area(g, v, n);
    if (area > best->area) {
        best->second = best->area;
        best->other = best->begin;
        best->area = area;
        best->begin = ring_begin(g, v, n);
        g_array_set_size(best->ring, 0);
        g_array_append_vals(best->ring, v, n);
    } else if (area > best->second) {
        best->second = area;
        best->other = ring_begin(g, v, n);
    }
}

/* Rings that touch no node twice: whenever the margin comes back to a node, what lay between is a ring of its own. */
static void find_rings(const Graph *g, Largest *best)
{
    uint8_t *used = g_new0(uint8_t, g->n);
    uint32_t *where = g_new(uint32_t, g->w->node->len);
    memset(where, 0xFF, sizeof *where * g->w->node->len);
    GArray *way = g_array_new(FALSE, FALSE, sizeof(uint32_t));
    for (uint32_t h = 0; h < g->n; h++) {
        for (uint32_t k = h; !used[k] && is_margin(g, k); k = next_margin(g, k)) {
            uint32_t v = from(g, k), end = to(g, k);
            used[k] = 1;
            where[v] = way->len;
            g_array_append_val(way, v);
            if (where[end] == NONE)
                continue;
            uint32_t begin = where[end];
            take_ring(g, &g_array_index(way, uint32_t, begin), way->len - begin, best);
            for (uint32_t i = begin; i < way->len; i++)
                where[g_array_index(way, uint32_t, i)] = NONE;
            g_array_set_size(way, begin);
        }
    }
    g_array_unref(way);
    g_free(where);
    g_free(used);
}

/* ---- all of it ---- */

/* From the sides of the lines; each is turned to wind around more to its left than to its right. */
static void lines_init(WindLines *w, const Vec2 *p, const uint32_t *start, uint32_t n_lines, double unit)
{
    *w = (WindLines){g_array_new(FALSE, FALSE, sizeof(Vec2)), g_array_new(FALSE, FALSE, sizeof(uint32_t)), g_array_new(FALSE, FALSE, sizeof(WindEdge)), start[n_lines], unit};
    for (uint32_t i = 0; i < start[n_lines]; i++) {
        Vec2 q = vec2(floor(p[i].x / unit + 0.5) * unit, floor(p[i].y / unit + 0.5) * unit);
        g_array_append_val(w->node, q);
        g_array_append_val(w->source, i);
    }
    for (uint32_t k = 0; k < n_lines; k++) {
        double twice = 0.0;
        for (uint32_t i = start[k] + 1; i + 1 < start[k + 1]; i++)
            twice += vec_cross(vec_sub(p[i], p[start[k]]), vec_sub(p[i + 1], p[start[k]]));
        for (uint32_t i = start[k]; i < start[k + 1]; i++) {
            uint32_t j = i + 1 < start[k + 1] ? i + 1 : start[k];
            WindEdge e = {MIN(i, j), MAX(i, j), (i < j) == (twice >= 0.0) ? 1 : -1};
            if (i != j)
                g_array_append_val(w->edge, e);
        }
    }
}

static void lines_clear(WindLines *w)
{
    g_array_unref(w->node);
    g_array_unref(w->source);
    g_array_unref(w->edge);
}

/* A power of two, 2^-27 to 2^-26 of the extent; pixels stay whole. */
static double choose_unit(const Vec2 *p, uint32_t n)
{
    Box2 box = box_empty();
    for (uint32_t i = 0; i < n; i++)
        box = box_add(box, p[i]);
    double far = MAX(MAX(fabs(box.x0), fabs(box.x1)), MAX(fabs(box.y0), fabs(box.y1))), size = MAX(box.x1 - box.x0, box.y1 - box.y0);
    int power;
    frexp(MAX(MAX(size, 1e-16 * far), 1e-20), &power);
    return ldexp(1.0, power - 27);
}

/* Begins with the first node if it is there. */
static void take_margin(const WindLines *w, const GArray *ring, Winding *out)
{
    uint32_t begin = 0;
    out->first_in = true;
    for (uint32_t i = 0; i < ring->len && out->first_in; i++)
        if (g_array_index(ring, uint32_t, i) == 0) {
            begin = i;
            out->first_in = false;
        }
    for (uint32_t i = 0; i < ring->len; i++)
        g_array_append_val(out->margin, g_array_index(w->node, Vec2, g_array_index(ring, uint32_t, (begin + i) % ring->len)));
}

static void unite(const WindLines *w, Winding *out)
{
    Graph g;
    Largest best = {.ring = g_array_new(FALSE, FALSE, sizeof(uint32_t)), .begin = NONE, .other = NONE};
    graph_init(&g, w);
    wind(&g);
    find_rings(&g, &best);
    graph_clear(&g);
    out->kind = best.ring->len == 0 ? WINDING_EMPTY : best.second > slip * best.area ? WINDING_APART : WINDING_UNITED;
    if (out->kind == WINDING_UNITED)
        take_margin(w, best.ring, out);
    if (out->kind == WINDING_APART) {
        out->part[0] = best.begin;
        out->part[1] = best.other;
        out->area[0] = best.area;
        out->area[1] = best.second;
    }
    g_array_unref(best.ring);
}

void winding_find(const Vec2 *p, const uint32_t *start, uint32_t n_lines, Winding *out)
{
    *out = (Winding){.kind = WINDING_TANGLE, .margin = g_array_new(FALSE, FALSE, sizeof(Vec2))};
    WindLines w;
    bool clean;
    lines_init(&w, p, start, n_lines, choose_unit(p, start[n_lines]));
    if (winding_split(&w, &clean)) {
        if (clean && n_lines == 1 && start[1] > 2) {
            out->kind = WINDING_SIMPLE;
            g_array_append_vals(out->margin, p, start[1]);
        } else {
            unite(&w, out);
        }
    }
    lines_clear(&w);
}

void winding_clear(Winding *w) { g_array_unref(w->margin); }
