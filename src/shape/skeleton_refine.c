/* The skeleton after meshing: the mesher's nodes on vein edges come into the sequences (Hong 2005, § 6.2.2). */
#include "shape/skeleton_private.h"

/* Mesh edges by vein segment: segment k has edges start[k] … start[k + 1] - 1. */
static uint32_t *edges_of_segments(const Mesh *mesh, uint32_t n_segments)
{
    uint32_t *start = g_new0(uint32_t, (gsize)n_segments + 2);
    for (uint32_t i = 0; i < mesh->n_vein; i++)
        start[mesh->vein_input[i] + 1]++;
    for (uint32_t k = 0; k < n_segments; k++)
        start[k + 1] += start[k];
    return start;
}

typedef struct {
    const Skeleton *s;
    const Mesh *mesh;
    Skeleton *to;
    uint32_t *point;   /* [nodes] each node's point in the graph, which is the mesh's vertex */
    uint32_t *segment; /* [nodes] the segment that leads to it */
    double *from;      /* [nodes] radius with which that segment begins: of its own sequence, not of the parent that it may leave */
    uint32_t *start;   /* [segments + 1] */
    uint32_t *first;   /* [nodes] in the new skeleton: the first node of the segment that leads to it, its hinge excepted */
    uint32_t *node_of; /* [nodes] in the new skeleton */
} Refining;

static void add_node(Refining *r, uint32_t node, uint32_t hinge, uint32_t vertex, double radius)
{
    r->to->rest[node] = r->mesh->vertex[vertex];
    r->to->hinge[node] = hinge;
    r->to->vertex[node] = vertex;
    r->to->radius[node] = radius;
}

/* The nodes of the segment that leads to node i, and i; returns how many nodes there are then. */
static uint32_t add_segment(Refining *r, uint32_t i, uint32_t n)
{
    const Skeleton *s = r->s;
    uint32_t hinge = s->hinge[i], last = r->node_of[hinge], k = r->segment[i];
    double length = vec_dist(s->rest[hinge], s->rest[i]);
    r->first[i] = n;
    for (uint32_t e = r->start[k]; e + 1 < r->start[k + 1]; e++) {
        uint32_t vertex = r->mesh->vein[e][1];
        double t = vec_dist(s->rest[hinge], r->mesh->vertex[vertex]) / length;
        add_node(r, n, last, vertex, r->from[i] + (s->radius[i] - r->from[i]) * t);
        last = n++;
    }
    add_node(r, n, last, r->point[i], s->radius[i]);
    r->node_of[i] = n;
    return n + 1;
}

static double *radii_at_hinges(const Skeleton *s)
{
    double *from = g_new0(double, s->n_nodes);
    for (uint32_t q = 0; q < s->n_sequences; q++)
        for (uint32_t k = 1; k < s->sequence[q].n; k++) {
            const uint32_t *at = s->at + s->sequence[q].first + k;
            from[at[0]] = k == 1 ? s->sequence[q].base_radius : s->radius[at[-1]];
        }
    return from;
}

static void add_sequences(Refining *r)
{
    const Skeleton *s = r->s;
    Skeleton *to = r->to;
    uint32_t n = 0;
    for (uint32_t q = 0; q < s->n_sequences; q++) {
        const Sequence *from = &s->sequence[q];
        to->sequence[q] = *from;
        to->sequence[q].first = n;
        to->at[n++] = r->node_of[s->at[from->first]];
        for (uint32_t k = 1; k < from->n; k++) {
            uint32_t i = s->at[from->first + k];
            for (uint32_t node = r->first[i]; node <= r->node_of[i]; node++)
                to->at[n++] = node;
        }
        to->sequence[q].n = n - to->sequence[q].first;
        if (from->parent != NO_PARENT)
            to->sequence[q].start = skeleton_place_in(to, from->parent, r->node_of[s->at[from->first]]);
    }
}

static Polygon *boundary_polygon(const Mesh *mesh)
{
    Vec2 *v = g_new(Vec2, mesh->n_boundary);
    for (uint32_t i = 0; i < mesh->n_boundary; i++)
        v[i] = mesh->vertex[mesh->boundary[i][0]];
    Polygon *p = polygon_new(v, mesh->n_boundary);
    g_free(v);
    return p;
}

Skeleton *skeleton_refine(const Skeleton *s, const Mesh *mesh)
{
    Refining r = {.s = s, .mesh = mesh, .point = g_new(uint32_t, s->n_nodes), .segment = g_new(uint32_t, s->n_nodes),
                  .from = radii_at_hinges(s), .first = g_new(uint32_t, s->n_nodes), .node_of = g_new(uint32_t, s->n_nodes)};
    Pslg *g = skeleton_pslg(s, r.point);
    uint32_t n = 0, segments = 0, n_more = mesh->n_vein - g->n_segments;
    r.start = edges_of_segments(mesh, g->n_segments);
    for (uint32_t i = 0; i < s->n_nodes; i++) /* as skeleton_pslg lists them */
        r.segment[i] = s->hinge[i] == NO_PARENT ? NONE : segments++;
    r.to = skeleton_alloc(s->n_nodes + n_more, s->n_sequences, s->n_at + n_more);
    for (uint32_t i = 0; i < s->n_nodes; i++)
        if (s->hinge[i] != NO_PARENT) {
            n = add_segment(&r, i, n);
        } else {
            r.first[i] = r.node_of[i] = n;
            add_node(&r, n++, NO_PARENT, r.point[i], s->radius[i]);
        }
    add_sequences(&r);
    r.to->outline = boundary_polygon(mesh);
    r.to->length = s->length;
    pslg_free(g);
    g_free(r.point);
    g_free(r.segment);
    g_free(r.from);
    g_free(r.start);
    g_free(r.first);
    g_free(r.node_of);
    return r.to;
}
