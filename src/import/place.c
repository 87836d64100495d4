/* Where a leaf stands: its base found and moved to 0,0, its tip turned up. */
#include <string.h>

#include "import/draft.h"

/* How far a node may lie outside the margin, leaf lengths. The last step of a growing vein may end outside, which is more in a leaf of a
 * few segments. */
static const double most_outside = 0.02, most_of_small = 0.1;
/* Shortest leaf, segments: a thousand times what a file rounds to. */
static const double shortest_leaf = 1e-3;
/* Cosine of 10°: a vertex of the margin that lies so nearly where the midvein points is the tip. */
static const double cos_of_tip = 0.98480775301220802;

/* ---- base ---- */

/* What speaks for a node as the leaf base. */
typedef struct {
    double width;  /* of its widest edge, where widths tell edges apart, else 0 */
    uint32_t part; /* nodes of its connected part */
    bool beside;   /* at the margin; where widths tell edges apart: an end of the widest edge is the base, the other one is not */
    double away2;  /* from the first point of the margin, squared */
    uint32_t node;
} Claim;

static bool better(const Claim *a, const Claim *b)
{
    if (a->width != b->width)
        return a->width > b->width;
    if (a->part != b->part)
        return a->part > b->part;
    if (a->beside != b->beside)
        return a->beside;
    return a->away2 != b->away2 ? a->away2 < b->away2 : a->node < b->node;
}

static uint32_t part_of(uint32_t *up, uint32_t v)
{
    while (up[v] != v)
        v = up[v] = up[up[v]];
    return v;
}

/* The part of each node (anastomoses do not connect), by one of its nodes, and size[part]. */
static void find_parts(const Network *net, uint32_t *part, uint32_t *size)
{
    for (uint32_t v = 0; v < net->n_nodes; v++)
        part[v] = v;
    for (uint32_t e = 0; e < net->n_edges; e++) {
        uint32_t a = part_of(part, net->tail[e]), b = part_of(part, net->head[e]);
        if (net->kind[e] != EDGE_ANASTOMOSIS)
            part[MAX(a, b)] = MIN(a, b);
    }
    for (uint32_t v = 0; v < net->n_nodes; v++) {
        part[v] = part_of(part, v);
        size[part[v]]++;
    }
}

/* The widest edge at each node; all 0 unless all edges have widths and not all the same. */
static double *widest_edges(const Draft *d)
{
    const Network *net = d->net;
    double *widest = g_new0(double, net->n_nodes);
    bool differ = false;
    for (uint32_t e = 0; e < net->n_edges; e++)
        differ |= net->width[e] != net->width[0];
    if (!differ || d->given[FIELD_WIDTH] != net->n_edges)
        return widest;
    for (uint32_t e = 0; e < net->n_edges; e++) {
        widest[net->tail[e]] = MAX(widest[net->tail[e]], net->width[e]);
        widest[net->head[e]] = MAX(widest[net->head[e]], net->width[e]);
    }
    return widest;
}

/* Is the node at the margin, as nearly as veins outside it may be? */
static bool is_beside(const Polygon *margin, Vec2 p)
{
    double size = MAX(margin->box.x1 - margin->box.x0, margin->box.y1 - margin->box.y0);
    return vec_dist(p, polygon_nearest(margin, p, NULL)) <= most_outside * size;
}

static Vec2 derive_base(const Draft *d)
{
    const Network *net = d->net;
    uint32_t *part = g_new(uint32_t, net->n_nodes), *size = g_new0(uint32_t, net->n_nodes);
    double *widest = widest_edges(d);
    bool *entered = g_new0(bool, net->n_nodes), any = false;
    Claim best = {.node = 0};
    find_parts(net, part, size);
    for (uint32_t e = 0; e < net->n_edges && draft_as_given(d); e++)
        entered[net->head[e]] |= net->kind[e] == EDGE_VEIN;
    for (uint32_t v = 0; v < net->n_nodes; v++) {
        Claim claim = {widest[v], size[part[v]], false, vec_dist2(net->node[v], net->margin->v[0]), v};
        if (any && claim.width < best.width)
            continue;
        claim.beside = claim.width > 0.0 && is_beside(net->margin, net->node[v]);
        if (!entered[v] && (!any || better(&claim, &best))) {
            best = claim;
            any = true;
        }
    }
    g_free(part);
    g_free(size);
    g_free(widest);
    g_free(entered);
    return net->node[best.node];
}

void draft_find_base(Draft *d)
{
    if (d->given[FIELD_BASE] == 0)
        d->base = d->net->margin != NULL ? derive_base(d) : vec2(0.0, 0.0);
}

/* ---- tip ---- */

/* The first node nearest to the base. */
static uint32_t find_root(const Draft *d)
{
    const Network *net = d->net;
    bool *entered = g_new0(bool, net->n_nodes);
    uint32_t best = NONE;
    for (uint32_t e = 0; e < net->n_edges; e++)
        entered[net->head[e]] |= net->kind[e] == EDGE_VEIN;
    for (uint32_t v = 0; v < net->n_nodes; v++)
        if (!entered[v] && (best == NONE || vec_dist2(net->node[v], d->base) < vec_dist2(net->node[best], d->base)))
            best = v;
    g_free(entered);
    return best;
}

/* How straight edge `e` goes on from edge `entry`: the cosine between them; from the beginning all go straight on. */
static double straightness(const Network *net, uint32_t entry, uint32_t e)
{
    if (entry == NONE)
        return 1.0;
    Vec2 a = vec_sub(net->node[net->head[entry]], net->node[net->tail[entry]]), b = vec_sub(net->node[net->head[e]], net->node[net->tail[e]]);
    return vec_dot(a, b) / sqrt(vec_norm2(a) * vec_norm2(b));
}

/* From the base to the end of its midvein, which goes on in the widest edge, of several in the straightest; 0,0 if no vein begins there. */
static Vec2 midvein(const Draft *d)
{
    const Network *net = d->net;
    uint32_t *first = g_new(uint32_t, net->n_nodes), *next = g_new(uint32_t, net->n_edges); /* vein edges by tail */
    uint32_t at = find_root(d), entry = NONE;
    for (uint32_t v = 0; v < net->n_nodes; v++)
        first[v] = NONE;
    for (uint32_t e = net->n_edges; e-- > 0;)
        if (net->kind[e] == EDGE_VEIN) {
            next[e] = first[net->tail[e]];
            first[net->tail[e]] = e;
        }
    bool begins = first[at] != NONE;
    while (first[at] != NONE) {
        uint32_t best = first[at];
        for (uint32_t e = next[best]; e != NONE; e = next[e])
            if (net->width[e] > net->width[best] ||
                (net->width[e] == net->width[best] && straightness(net, entry, e) > straightness(net, entry, best)))
                best = e;
        entry = best;
        at = net->head[best];
    }
    g_free(first);
    g_free(next);
    return begins ? vec_sub(net->node[at], d->base) : vec2(0.0, 0.0);
}

/* The vector from the base, along `m`, to where it first leaves the margin at its end or later; else `m` itself. */
static Vec2 prolonged(const Polygon *margin, Vec2 base, Vec2 m)
{
    const double touch = 1.0 - 1e-9; /* a vein that ends on the margin */
    double best = HUGE_VAL;
    for (uint32_t i = 0; i < margin->n; i++) {
        Vec2 p = vec_sub(margin->v[i], base), q = vec_sub(margin->v[(i + 1) % margin->n], base);
        double a = vec_cross(m, p), b = vec_cross(m, q);
        if ((a < 0.0 && b < 0.0) || (a > 0.0 && b > 0.0) || a == b)
            continue;
        double t = vec_dot(vec_lerp(p, q, a / (a - b)), m) / vec_norm2(m);
        if (t >= touch && t < best)
            best = t;
    }
    return best < HUGE_VAL ? vec_scale(m, best) : m;
}

static Vec2 derive_tip(const Draft *d)
{
    const Polygon *margin = d->net->margin;
    Vec2 m = midvein(d), tip = vec2(0.0, 0.0);
    bool led = vec_norm2(m) > 0.0;
    if (led)
        tip = prolonged(margin, d->base, m);
    for (uint32_t i = 0; i < margin->n; i++) {
        Vec2 p = vec_sub(margin->v[i], d->base);
        bool ahead = !led || vec_dot(p, m) >= cos_of_tip * sqrt(vec_norm2(p)) * sqrt(vec_norm2(m));
        if (ahead && vec_norm2(p) > vec_norm2(tip))
            tip = p;
    }
    return vec_add(d->base, tip);
}

/* ---- placing ---- */

typedef struct {
    Vec2 base, up; /* up: unit vector */
} Place;

static Vec2 placed(const Place *place, Vec2 p)
{
    Vec2 q = vec_sub(p, place->base);
    if (place->up.x == 0.0 && place->up.y == 1.0) /* to the bit, so that what is in its place stays as it was */
        return q;
    return vec2(vec_cross(q, place->up), vec_dot(q, place->up));
}

static gboolean check_size(const Draft *d, GError **error)
{
    const Network *net = d->net;
    for (uint32_t v = 0; v < net->n_nodes; v++) {
        Vec2 p = net->node[v];
        if (MAX(fabs(p.x), fabs(p.y)) <= FIELD_LARGEST)
            continue;
        char *text = draft_node_text(d, v);
        draft_fail(d, d->node_line[v], IMPORT_ERROR_GRAPH, error, "%s lies at %.7g,%.7g seen from the leaf base; it must lie within %g", text,
                   p.x, p.y, FIELD_LARGEST);
        g_free(text);
        return FALSE;
    }
    return TRUE;
}

static gboolean move(Draft *d, const Place *place, GError **error)
{
    Network *net = d->net;
    if (place->base.x == 0.0 && place->base.y == 0.0 && place->up.x == 0.0 && place->up.y == 1.0)
        return TRUE;
    for (uint32_t v = 0; v < net->n_nodes; v++)
        net->node[v] = placed(place, net->node[v]);
    for (uint32_t i = 0; net->holes != NULL && i < net->holes->start[net->holes->n]; i++)
        net->holes->p[i] = placed(place, net->holes->p[i]);
    if (net->margin != NULL) {
        GArray *points = g_array_new(FALSE, FALSE, sizeof(Vec2));
        for (uint32_t i = 0; i < net->margin->n; i++) {
            Vec2 p = placed(place, net->margin->v[i]);
            g_array_append_val(points, p);
        }
        GError *cause = NULL;
        polygon_free(net->margin);
        net->margin = field_outline(points, &cause);
        if (cause != NULL) {
            draft_fail(d, 0, (ImportErrorCode)cause->code, error, "moved to the leaf base: %s", cause->message);
            g_error_free(cause);
            return FALSE;
        }
    }
    return check_size(d, error);
}

static double allowed_outside(double length) { return MAX(most_outside * length, MIN(1.0, most_of_small * length)); }

/* The first node that lies too far outside; NONE if all is well. `by`: how far, segments. */
static uint32_t find_outside(const Network *net, double *by)
{
    for (uint32_t v = 0; v < net->n_nodes; v++)
        if (!polygon_contains(net->margin, net->node[v])) {
            *by = -polygon_depth(net->margin, net->node[v]);
            if (*by > allowed_outside(net->length))
                return v;
        }
    return NONE;
}

static char *outside_text(const Network *net, double by)
{
    return g_strdup_printf("%.4g segments outside the margin; in a leaf %.6g segments long it must be at most %.4g (a petiole is not drawn: "
                           "mesh.petiole_length makes one)",
                           by, net->length, allowed_outside(net->length));
}

static gboolean check_inside(const Draft *d, GError **error)
{
    double by;
    uint32_t v = find_outside(d->net, &by);
    if (v == NONE)
        return TRUE;
    char *node = draft_node_text(d, v), *how = outside_text(d->net, by);
    draft_fail(d, d->node_line[v], IMPORT_ERROR_GRAPH, error, "%s lies %s", node, how);
    g_free(node);
    g_free(how);
    return FALSE;
}

gboolean import_check_inside(const Network *net, const char *name, GError **error)
{
    double by;
    uint32_t v = find_outside(net, &by);
    if (v == NONE)
        return TRUE;
    char *how = outside_text(net, by);
    g_set_error(error, IMPORT_ERROR, IMPORT_ERROR_GRAPH, "%s: the node at %.7g,%.7g lies %s", name, net->node[v].x, net->node[v].y, how);
    g_free(how);
    return FALSE;
}

gboolean draft_place(Draft *d, GError **error)
{
    Network *net = d->net;
    Place place = {d->base, vec2(0.0, 1.0)};
    if (d->given[FIELD_TIP] == 0 && net->margin == NULL)
        return move(d, &place, error);
    if (d->given[FIELD_TIP] == 0)
        d->tip = derive_tip(d);
    Vec2 axis = vec_sub(d->tip, d->base);
    net->length = axis.x == 0.0 ? fabs(axis.y) : sqrt(vec_norm2(axis));
    if (!(net->length >= shortest_leaf))
        return draft_fail(d, 0, IMPORT_ERROR_GRAPH, error,
                          "the leaf is %.3g segments long, from its base at %.7g,%.7g to its tip at %.7g,%.7g; it must be at least %g",
                          net->length, d->base.x, d->base.y, d->tip.x, d->tip.y, shortest_leaf);
    place.up = vec_scale(axis, 1.0 / net->length);
    if (axis.x == 0.0)
        place.up = vec2(0.0, axis.y > 0.0 ? 1.0 : -1.0);
    return move(d, &place, error) && (net->margin == NULL || check_inside(d, error));
}
