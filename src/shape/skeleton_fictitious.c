/* Fictitious veins: they shape a part of the blade that no vein reaches, and are not drawn (Hong 2005, § 7.2). */
#include <string.h>

#include "shape/skeleton_private.h"

typedef struct {
    Ground ground;
    GArray *rest, *hinge, *at, *sequence; /* of the skeleton that is made: Vec2, uint32_t, uint32_t, Sequence */
    GArray *spot;                         /* uint32_t: of each node, the ground's node */
    double spacing;                       /* longest edge, segments */
    double unit;                          /* of messages, segments */
    uint32_t number;                      /* 1, 2, … of the vein that is laid */
} Adding;

static void adding_init(Adding *a, const Skeleton *s)
{
    uint32_t *point = g_new(uint32_t, s->n_nodes);
    Pslg *g = skeleton_pslg(s, point);
    double least = s->least * (1.0 + 1e-9); /* for those who measure the same distance another way */
    *a = (Adding){.spacing = 0.0};
    ground_init(&a->ground, s->outline, (Limits){.clear = least, .least = least, .slope = 0.0});
    a->rest = g_array_new(FALSE, FALSE, sizeof(Vec2));
    a->hinge = g_array_new(FALSE, FALSE, sizeof(uint32_t));
    a->at = g_array_new(FALSE, FALSE, sizeof(uint32_t));
    a->sequence = g_array_new(FALSE, FALSE, sizeof(Sequence));
    a->spot = g_array_new(FALSE, FALSE, sizeof(uint32_t));
    g_array_append_vals(a->rest, s->rest, s->n_nodes);
    g_array_append_vals(a->hinge, s->hinge, s->n_nodes);
    g_array_append_vals(a->at, s->at, s->n_at);
    g_array_append_vals(a->sequence, s->sequence, s->n_sequences);
    g_array_append_vals(a->spot, point, s->n_nodes);
    for (uint32_t i = g->n_outline; i < g->n_points; i++)
        field_add_node(&a->ground.field, g->point[i], false);
    for (uint32_t i = 0; i < g->n_segments; i++) {
        a->spacing = MAX(a->spacing, vec_dist(g->point[g->segment[i][0]], g->point[g->segment[i][1]]));
        field_add_edge(&a->ground.field, g->segment[i][0], g->segment[i][1], 0);
    }
    a->ground.n_nodes = a->ground.field.node->len;
    a->ground.n_edges = a->ground.field.edge->len;
    pslg_free(g);
    g_free(point);
}

static void adding_clear(Adding *a)
{
    ground_clear(&a->ground);
    g_array_free(a->rest, TRUE);
    g_array_free(a->hinge, TRUE);
    g_array_free(a->at, TRUE);
    g_array_free(a->sequence, TRUE);
    g_array_free(a->spot, TRUE);
}

static uint32_t nearest_node(const Adding *a, Vec2 p)
{
    const Vec2 *rest = (const Vec2 *)(void *)a->rest->data;
    uint32_t best = 0;
    for (uint32_t i = 1; i < a->rest->len; i++)
        if (vec_dist2(rest[i], p) < vec_dist2(rest[best], p))
            best = i;
    return best;
}

/* The sequence a node belongs to and its place there: the first one that has it, as parents come before their children. */
static uint32_t sequence_of(const Adding *a, uint32_t node, uint32_t *place)
{
    for (uint32_t q = 0; q < a->sequence->len; q++) {
        const Sequence *s = &g_array_index(a->sequence, Sequence, q);
        for (uint32_t i = 0; i < s->n; i++)
            if (g_array_index(a->at, uint32_t, s->first + i) == node) {
                *place = i;
                return q;
            }
    }
    g_assert_not_reached(); /* every node is of a sequence */
}

/* Lays an edge in parts no longer than the spacing. */
static bool lay_to(Adding *a, Vec2 to, GError **error)
{
    Ground *g = &a->ground;
    Vec2 from = ground_end(g);
    uint32_t parts = (uint32_t)CLAMP(ceil(vec_dist(from, to) / a->spacing), 1.0, 1e6);
    for (uint32_t i = 1; i <= parts; i++) {
        Vec2 v = i == parts ? to : vec_lerp(from, to, (double)i / (double)parts);
        Hit hit = ground_clash(g, v, NULL);
        if (hit != HIT_NOTHING) {
            const char *fault = hit == HIT_MARGIN ? "comes too near to the margin, or leaves the blade," : "comes too near to another vein or to itself";
            double u = a->unit;
            g_set_error(error, SKELETON_ERROR, SKELETON_ERROR_GRAPH, "fictitious vein F%u %s between %.4g,%.4g and %.4g,%.4g; it must keep %.2g away",
                        a->number, fault, from.x / u, from.y / u, to.x / u, to.y / u, g->limits.least / u);
            return false;
        }
        ground_lay(g, v, NULL);
    }
    return true;
}

/* What was laid becomes a sequence. */
static void add_sequence(Adding *a, uint32_t start)
{
    const Ground *g = &a->ground;
    Sequence q = {.first = a->at->len, .n = g->node->len, .fictitious = true, .vein = NO_PARENT, .length = ground_length(g)};
    uint32_t hinge = start;
    q.parent = sequence_of(a, start, &q.start);
    q.order = (uint8_t)MIN(g_array_index(a->sequence, Sequence, q.parent).order + 1, 250);
    g_array_append_val(a->at, start);
    for (uint32_t i = 1; i < g->node->len; i++) {
        uint32_t node = a->rest->len, spot = g_array_index(g->node, uint32_t, i);
        Vec2 p = ground_at(g, spot);
        g_array_append_val(a->rest, p);
        g_array_append_val(a->hinge, hinge);
        g_array_append_val(a->at, node);
        g_array_append_val(a->spot, spot);
        hinge = node;
    }
    g_array_append_val(a->sequence, q);
}

static bool add_vein(Adding *a, const Vec2 *p, uint32_t n, GError **error)
{
    if (n < 2) {
        g_set_error(error, SKELETON_ERROR, SKELETON_ERROR_GRAPH, "fictitious vein F%u has %u points; at least 2 are needed", a->number, n);
        return false;
    }
    for (uint32_t i = 0; i < n; i++)
        if (!isfinite(p[i].x) || !isfinite(p[i].y)) {
            g_set_error(error, SKELETON_ERROR, SKELETON_ERROR_GRAPH, "point %u of fictitious vein F%u is %g,%g; positions must be finite", i + 1, a->number,
                        p[i].x, p[i].y);
            return false;
        }
    uint32_t start = nearest_node(a, p[0]), spot = g_array_index(a->spot, uint32_t, start);
    ground_begin(&a->ground, a->sequence->len, (Anchor){ground_at(&a->ground, spot), spot, NONE});
    for (uint32_t i = 1; i < n; i++)
        if (!lay_to(a, p[i], error))
            return false;
    add_sequence(a, start);
    ground_commit(&a->ground, NULL);
    return true;
}

static Skeleton *finish(const Adding *a, const Skeleton *from)
{
    Skeleton *s = skeleton_alloc(a->rest->len, a->sequence->len, a->at->len);
    memcpy(s->rest, a->rest->data, s->n_nodes * sizeof *s->rest);
    memcpy(s->hinge, a->hinge->data, s->n_nodes * sizeof *s->hinge);
    memcpy(s->at, a->at->data, s->n_at * sizeof *s->at);
    memcpy(s->sequence, a->sequence->data, s->n_sequences * sizeof *s->sequence);
    memcpy(s->radius, from->radius, from->n_nodes * sizeof *s->radius);
    s->outline = polygon_new(from->outline->v, from->outline->n);
    s->length = from->length;
    s->least = from->least;
    skeleton_name(s);
    return s;
}

Skeleton *skeleton_add_fictitious(const Skeleton *s, const Vec2 *point, const uint32_t *count, uint32_t n_veins, double unit, GError **error)
{
    Adding a;
    Skeleton *out = NULL;
    bool ok = true;
    adding_init(&a, s);
    a.unit = unit;
    for (uint32_t i = 0; i < s->n_sequences; i++)
        a.number += s->sequence[i].fictitious;
    for (uint32_t k = 0, first = 0; k < n_veins && ok; first += count[k++]) {
        a.number++;
        ok = add_vein(&a, point + first, count[k], error);
    }
    if (ok)
        out = finish(&a, s);
    adding_clear(&a);
    return out;
}
