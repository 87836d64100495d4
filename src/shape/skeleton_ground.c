#include "shape/skeleton_ground.h"

#include "geom/segment.h"

/* Sine of the least angle between a vein and the margin at a corner: 6 degrees. */
static const double corner = 0.1045;

void ground_init(Ground *g, const Polygon *outline, Limits limits)
{
    *g = (Ground){.limits = limits, .outline = outline};
    field_init(&g->field, outline->box);
    for (uint32_t i = 0; i < outline->n; i++)
        field_add_node(&g->field, outline->v[i], true);
    for (uint32_t i = 0; i < outline->n; i++)
        field_add_edge(&g->field, i, i + 1 < outline->n ? i + 1 : 0, MARGIN);
    g->node = g_array_new(FALSE, FALSE, sizeof(uint32_t));
    g->way = g_array_new(FALSE, FALSE, sizeof(double));
    g->n_nodes = g->field.node->len;
    g->n_edges = g->field.edge->len;
}

void ground_clear(Ground *g)
{
    field_clear(&g->field);
    g_array_free(g->node, TRUE);
    g_array_free(g->way, TRUE);
}

/* ---- laying ---- */

static bool anchor_on_margin(const Ground *g, const Anchor *a)
{
    return a && ((a->node != NONE && ground_on_margin(g, a->node)) || (a->edge != NONE && field_edge(&g->field, a->edge).owner == MARGIN));
}

static uint32_t anchor_node(Ground *g, Vec2 at, const Anchor *a)
{
    return a && a->node != NONE ? a->node : field_add_node(&g->field, at, anchor_on_margin(g, a));
}

static void push(Ground *g, uint32_t node, double way)
{
    g_array_append_val(g->node, node);
    g_array_append_val(g->way, way);
}

void ground_begin(Ground *g, uint32_t owner, Anchor start)
{
    field_undo(&g->field, g->n_nodes, g->n_edges);
    g_array_set_size(g->node, 0);
    g_array_set_size(g->way, 0);
    g->owner = owner;
    g->start = start;
    push(g, anchor_node(g, start.at, &start), 0.0);
}

void ground_lay(Ground *g, Vec2 v, const Anchor *tip)
{
    uint32_t from = g_array_index(g->node, uint32_t, g->node->len - 1), to = anchor_node(g, v, tip);
    double way = ground_length(g) + vec_dist(ground_at(g, from), v);
    field_add_edge(&g->field, from, to, g->owner);
    push(g, to, way);
}

void ground_take_back(Ground *g)
{
    uint32_t last = g_array_index(g->node, uint32_t, g->node->len - 1);
    field_undo(&g->field, last >= g->n_nodes ? last : g->field.node->len, g->field.edge->len - 1);
    g_array_set_size(g->node, g->node->len - 1);
    g_array_set_size(g->way, g->way->len - 1);
}

void ground_commit(Ground *g, const Anchor *tip)
{
    if (g->start.node == NONE && g->start.edge != NONE)
        field_split(&g->field, g->start.edge, g_array_index(g->node, uint32_t, 0));
    if (tip && tip->node == NONE)
        field_split(&g->field, tip->edge, g_array_index(g->node, uint32_t, g->node->len - 1));
    g->n_nodes = g->field.node->len;
    g->n_edges = g->field.edge->len;
}

/* ---- clashes ---- */

/* An edge that is thought of, and where it is tied. */
typedef struct {
    Vec2 u, v;
    const Anchor *start, *tip; /* at u, at v; NULL */
    Vec2 cone[2];              /* round these places things may be nearer */
} Trial;

static bool nearer(Vec2 p, Vec2 a, Vec2 b, double reach) { return segment_dist2(a, b, p) < reach * reach; }

static double held(const Limits *l, double d) { return CLAMP(d, l->least, MAX(l->least, l->clear)); }

/* How fast a vein must part from an edge. In the corner of a narrow blade's base or tip it can't part faster than the margin lets it. */
static double slope_from(const Ground *g, FieldEdge e) { return e.owner == MARGIN ? MIN(corner, g->limits.slope) : g->limits.slope; }

/* How far from p others must be. */
static double room(const Ground *g, const Trial *t, double slope, Vec2 p)
{
    double d2 = MIN(vec_dist2(p, t->cone[0]), vec_dist2(p, t->cone[1]));
    return held(&g->limits, slope * sqrt(d2));
}

static bool touches(const Anchor *a, uint32_t edge, FieldEdge e)
{
    return a && (a->edge == edge || (a->node != NONE && (e.a == a->node || e.b == a->node)));
}

/* Whether two directions differ by less than the angle of that sine. */
static bool too_sharp(Vec2 d, Vec2 e, double sine)
{
    double cross = vec_cross(d, e);
    return vec_dot(d, e) > 0.0 && cross * cross < sine * sine * vec_norm2(d) * vec_norm2(e);
}

/* An edge from p to q against one that it is tied to at p: at its end, or between its ends. */
static bool joins_badly(const Ground *g, Vec2 p, Vec2 q, const Anchor *at, FieldEdge e)
{
    const Limits *l = &g->limits;
    const uint32_t end[2] = {e.a, e.b};
    double slope = at->node == NONE ? l->slope : slope_from(g, e);
    for (int i = 0; i < 2; i++) {
        if (end[i] == at->node)
            continue;
        Vec2 w = ground_at(g, end[i]);
        if (too_sharp(vec_sub(q, p), vec_sub(w, p), slope) || nearer(w, p, q, l->least))
            return true;
    }
    return nearer(q, ground_at(g, e.a), ground_at(g, e.b), l->least);
}

/* Against an edge that it is not tied to. */
static bool too_near(const Ground *g, const Trial *t, FieldEdge e)
{
    Vec2 a = ground_at(g, e.a), b = ground_at(g, e.b);
    double slope = slope_from(g, e);
    return field_cross(t->u, t->v, a, b) || nearer(t->u, a, b, room(g, t, slope, t->u)) || nearer(t->v, a, b, room(g, t, slope, t->v)) ||
           nearer(a, t->u, t->v, room(g, t, slope, a)) || nearer(b, t->u, t->v, room(g, t, slope, b));
}

/* Against an edge of the same vein: the one before must not be folded back on, others kept from by the slope of the way between. */
static bool meets_itself(const Ground *g, const Trial *t, uint32_t edge, FieldEdge e)
{
    Vec2 a = ground_at(g, e.a), b = ground_at(g, e.b);
    uint32_t k = edge - g->n_edges + 1; /* the edge's second node is the vein's k-th */
    if (k + 1 == g->node->len)
        return too_sharp(vec_sub(a, b), vec_sub(t->v, t->u), g->limits.slope) || nearer(a, t->u, t->v, g->limits.least) ||
               nearer(t->v, a, b, g->limits.least);
    double least = held(&g->limits, g->limits.slope * (ground_length(g) - g_array_index(g->way, double, k)));
    return field_cross(t->u, t->v, a, b) || nearer(t->u, a, b, least) || nearer(t->v, a, b, least) || nearer(a, t->u, t->v, least) ||
           nearer(b, t->u, t->v, least);
}

static bool clashes(const Ground *g, const Trial *t, uint32_t edge)
{
    FieldEdge e = field_edge(&g->field, edge);
    if (e.owner == g->owner)
        return meets_itself(g, t, edge, e);
    bool first = touches(t->start, edge, e), last = touches(t->tip, edge, e);
    if (first && last)
        return true;
    if (first)
        return joins_badly(g, t->u, t->v, t->start, e);
    if (last) /* a tip may be tied to the margin alone: no two veins end in one node */
        return e.owner != MARGIN || joins_badly(g, t->v, t->u, t->tip, e);
    return too_near(g, t, e);
}

Hit ground_clash(Ground *g, Vec2 v, const Anchor *tip)
{
    Trial t = {.u = ground_end(g), .v = v, .start = g->node->len == 1 ? &g->start : NULL, .tip = tip, .cone = {g->start.at, tip ? v : g->start.at}};
    uint32_t n;
    Hit hit = HIT_NOTHING;
    if (nearer(t.u, v, v, g->limits.least))
        return HIT_VEIN;
    const uint32_t *near = field_near(&g->field, t.u, v, g->limits.clear, &n);
    for (uint32_t k = 0; k < n; k++) {
        if (!clashes(g, &t, near[k]))
            continue;
        if (field_edge(&g->field, near[k]).owner != MARGIN)
            return HIT_VEIN;
        hit = HIT_MARGIN;
    }
    /* An edge that is tied to the margin crosses it nowhere, but may lie outside wholly. */
    if (hit == HIT_NOTHING && (anchor_on_margin(g, t.start) || anchor_on_margin(g, tip)) &&
        !polygon_contains(g->outline, vec_lerp(t.u, v, 0.5)))
        hit = HIT_MARGIN;
    return hit;
}

bool ground_free(Ground *g, Vec2 p, double reach)
{
    uint32_t n;
    const uint32_t *near = field_near(&g->field, p, p, reach, &n);
    for (uint32_t k = 0; k < n; k++) {
        FieldEdge e = field_edge(&g->field, near[k]);
        if (e.owner != g->owner && nearer(p, ground_at(g, e.a), ground_at(g, e.b), reach))
            return false;
    }
    return true;
}
