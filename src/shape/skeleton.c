#include "shape/skeleton.h"

#include <string.h>

#include "shape/skeleton_private.h"

G_DEFINE_QUARK(venation-skeleton-error, skeleton_error)

SkeletonDef skeleton_def_default(double length)
{
    return (SkeletonDef){
        .max_order = 3,
        .tolerance = 0.004 * length,
        .spacing = 0.05 * length,
        .clearance = 0.01 * length,
        .min_angle = 15.0,
        .min_length = 0.13 * length,
    };
}

void skeleton_free(Skeleton *s)
{
    if (!s)
        return;
    g_free(s->rest);
    g_free(s->hinge);
    g_free(s->radius);
    g_free(s->vertex);
    g_free(s->at);
    g_free(s->sequence);
    polygon_free(s->outline);
    g_free(s);
}

Skeleton *skeleton_alloc(uint32_t n_nodes, uint32_t n_sequences, uint32_t n_at)
{
    Skeleton *s = g_new0(Skeleton, 1);
    s->n_nodes = n_nodes;
    s->n_sequences = n_sequences;
    s->n_at = n_at;
    s->rest = g_new0(Vec2, n_nodes);
    s->hinge = g_new(uint32_t, n_nodes);
    s->radius = g_new0(double, n_nodes);
    s->vertex = g_new(uint32_t, n_nodes);
    s->at = g_new0(uint32_t, n_at);
    s->sequence = g_new0(Sequence, n_sequences);
    for (uint32_t i = 0; i < n_nodes; i++)
        s->hinge[i] = s->vertex[i] = NO_PARENT;
    return s;
}

/* ---- from what was cleared ---- */

/* The outline with the ends of veins on it: its edges have been cut at them. */
static Polygon *outline_with_ends(const Clearing *c)
{
    const Field *f = &c->ground.field;
    uint32_t *next = g_new(uint32_t, f->node->len), n = 0;
    for (uint32_t e = 0; e < f->edge->len; e++)
        if (field_edge(f, e).owner == MARGIN)
            next[field_edge(f, e).a] = field_edge(f, e).b;
    Vec2 *v = g_new(Vec2, f->node->len);
    uint32_t at = 0;
    do {
        v[n++] = field_at(f, at);
        at = next[at];
    } while (at != 0);
    Polygon *p = polygon_new(v, n);
    g_free(next);
    g_free(v);
    return p;
}

/* The primary that is the midrib: of those at the base the one of greatest length times width. */
static uint32_t find_midrib(const Clearing *c, const Trails *trails)
{
    uint32_t best = 0;
    double most = -1.0;
    for (uint32_t i = 0; i < c->cleared->len; i++) {
        const Cleared *s = &g_array_index(c->cleared, Cleared, i);
        const Trail *t = &trails->trail[s->trail];
        double size = t->length * trails->width[t->first];
        if (s->parent == NONE && size > most) {
            most = size;
            best = i;
        }
    }
    return best;
}

typedef struct {
    const Clearing *c;
    const Trails *trails;
    Skeleton *s;
    uint32_t *node_of; /* of the skeleton, by the ground's; NONE as yet */
    uint32_t *sequence_of; /* of the skeleton, by cleared sequence */
    uint32_t n_nodes, n_sequences, n_at;
} Copy;

static void copy_nodes(Copy *x, const Cleared *from, Sequence *q)
{
    Skeleton *s = x->s;
    for (uint32_t k = 0; k < from->knot->len; k++) {
        Knot knot = g_array_index(from->knot, Knot, k);
        uint32_t *node = &x->node_of[knot.node];
        if (*node == NONE) { /* parents come first: a node where a branch leaves is as wide as they are */
            *node = x->n_nodes++;
            s->rest[*node] = ground_at(&x->c->ground, knot.node);
            s->radius[*node] = 0.5 * knot.width;
            s->hinge[*node] = k > 0 ? s->at[x->n_at - 1] : NO_PARENT;
        }
        if (k > 0)
            q->length += vec_dist(s->rest[s->at[x->n_at - 1]], s->rest[*node]);
        s->at[x->n_at++] = *node;
    }
}

static void copy_sequence(Copy *x, uint32_t index)
{
    const Cleared *from = &g_array_index(x->c->cleared, Cleared, index);
    const Trail *t = &x->trails->trail[from->trail];
    uint32_t n = from->knot->len, parent = from->parent == NONE ? NO_PARENT : x->sequence_of[from->parent];
    Sequence *q = &x->s->sequence[x->n_sequences];
    *q = (Sequence){.parent = parent, .first = x->n_at, .n = n, .order = t->order, .vein = t->vein};
    q->base_radius = 0.5 * g_array_index(from->knot, Knot, 0).width;
    q->tip_radius = 0.5 * g_array_index(from->knot, Knot, n - 1).width;
    copy_nodes(x, from, q);
    if (parent != NO_PARENT)
        q->start = skeleton_place_in(x->s, parent, x->s->at[q->first]);
    x->sequence_of[index] = x->n_sequences++;
}

/* The midrib first, the others by importance, parents before children. */
static Skeleton *skeleton_copy_cleared(const Clearing *c, const Trails *trails)
{
    uint32_t n = c->cleared->len, n_at = 0, n_ground = c->ground.field.node->len, n_nodes = 0, midrib = find_midrib(c, trails);
    Copy x = {.c = c, .trails = trails, .node_of = g_new(uint32_t, n_ground), .sequence_of = g_new(uint32_t, n)};
    for (uint32_t i = 0; i < n_ground; i++)
        x.node_of[i] = NONE;
    for (uint32_t i = 0; i < n; i++) {
        const GArray *knot = g_array_index(c->cleared, Cleared, i).knot;
        n_at += knot->len;
        for (uint32_t k = 0; k < knot->len; k++) {
            uint32_t *seen = &x.node_of[g_array_index(knot, Knot, k).node];
            n_nodes += *seen == NONE;
            *seen = 0;
        }
    }
    for (uint32_t i = 0; i < n_ground; i++)
        x.node_of[i] = NONE;
    x.s = skeleton_alloc(n_nodes, n, n_at);
    copy_sequence(&x, midrib);
    for (uint32_t i = 0; i < n; i++)
        if (i != midrib)
            copy_sequence(&x, i);
    x.s->outline = outline_with_ends(c);
    x.s->least = 0.25 * c->ground.limits.clear;
    g_free(x.node_of);
    g_free(x.sequence_of);
    return x.s;
}

Skeleton *skeleton_new(const Network *net, const SkeletonDef *def, GError **error)
{
    Polygon *margin = outline_checked(net, error);
    Trails *trails = margin ? trails_new(net, def->max_order, def->min_length, def->clearance, error) : NULL;
    Clearing *c = trails ? clearing_new(trails, margin, def, error) : NULL;
    Skeleton *s = NULL;
    if (c && c->cleared->len > 0) {
        s = skeleton_copy_cleared(c, trails);
        s->length = net->length;
        skeleton_name(s);
    } else if (c) {
        g_set_error(error, SKELETON_ERROR, SKELETON_ERROR_EMPTY,
                    "no vein is left that could carry the blade: of order up to %u, at least %g segments long and within the margin", def->max_order,
                    def->min_length);
    }
    clearing_free(c);
    trails_free(trails);
    polygon_free(margin);
    return s;
}

/* ---- looking things up ---- */

uint32_t skeleton_place_in(const Skeleton *s, uint32_t sequence, uint32_t node)
{
    const Sequence *q = &s->sequence[sequence];
    uint32_t i = 0;
    while (i + 1 < q->n && s->at[q->first + i] != node)
        i++;
    return i;
}

uint32_t skeleton_find(const Skeleton *s, const char *name)
{
    for (uint32_t i = 0; i < s->n_sequences; i++)
        if (strcmp(s->sequence[i].name, name) == 0)
            return i;
    return NO_PARENT;
}

/* ---- the graph for the mesher ---- */

typedef struct {
    Vec2 p;
    uint32_t index;
} Place;

static gint by_place(gconstpointer a, gconstpointer b, gpointer user)
{
    const Place *p = a, *q = b;
    if (p->p.x != q->p.x)
        return p->p.x < q->p.x ? -1 : 1;
    if (p->p.y != q->p.y)
        return p->p.y < q->p.y ? -1 : 1;
    return (p->index > q->index) - (p->index < q->index);
}

/* A node on the outline is at one of its vertices, to the bit. */
static uint32_t vertex_at(const Place *place, uint32_t n, Vec2 p)
{
    uint32_t lo = 0, hi = n;
    while (lo < hi) {
        uint32_t mid = lo + (hi - lo) / 2;
        if (place[mid].p.x < p.x || (place[mid].p.x == p.x && place[mid].p.y < p.y))
            lo = mid + 1;
        else
            hi = mid;
    }
    return lo < n && place[lo].p.x == p.x && place[lo].p.y == p.y ? place[lo].index : NONE;
}

Pslg *skeleton_pslg(const Skeleton *s, uint32_t *node_point)
{
    const Polygon *o = s->outline;
    Place *place = g_new(Place, o->n);
    for (uint32_t i = 0; i < o->n; i++)
        place[i] = (Place){o->v[i], i};
    g_qsort_with_data(place, (gint)o->n, sizeof *place, by_place, NULL);
    uint32_t n_points = o->n, n_segments = 0;
    for (uint32_t i = 0; i < s->n_nodes; i++) {
        uint32_t v = vertex_at(place, o->n, s->rest[i]);
        node_point[i] = v == NONE ? n_points++ : v;
        n_segments += s->hinge[i] != NO_PARENT;
    }
    Pslg *g = pslg_new(n_points, o->n, n_segments);
    memcpy(g->point, o->v, o->n * sizeof *o->v);
    n_segments = 0;
    for (uint32_t i = 0; i < s->n_nodes; i++) {
        g->point[node_point[i]] = s->rest[i];
        if (s->hinge[i] == NO_PARENT)
            continue;
        g->segment[n_segments][0] = node_point[s->hinge[i]];
        g->segment[n_segments++][1] = node_point[i];
    }
    g_free(place);
    return g;
}
