/* Which pieces between junctions are one vein. */
#include "scan/centre_private.h"

#define STRAIGHT 0.5 /* least cosine of the turn that a vein takes at a junction: 60° */

/* Which halves are at each node, and what each goes on in. */
typedef struct {
    const CentreGraph *g;
    uint32_t *start, *at; /* those at node i: at[start[i]] … at[start[i + 1] - 1] */
    uint32_t *partner;    /* the half that a half goes on in beyond its node, or CENTRE_NONE */
    GArray *pairs;
} Joining;

/* The first point of an edge outside the disc of the node it comes from; the edge's n when there is none. */
static uint32_t half_exit(const CentreGraph *g, uint32_t half)
{
    const CentreNode *node = centre_node(g, centre_half_node(g, half));
    uint32_t k = 0, n = centre_edge(g, half / 2)->n;
    while (k < n && vec_dist(centre_half_point(g, half, k)->p, node->p) <= node->r)
        k++;
    return k;
}

/* How wide an edge is halfway. */
static double edge_radius(const CentreGraph *g, uint32_t edge)
{
    const CentreEdge *e = centre_edge(g, edge);
    return e->n > 0 ? centre_point(g, e->first + e->n / 2)->r : fmin(centre_node(g, e->node[0])->r, centre_node(g, e->node[1])->r);
}

/* A point that an edge leads to at least so far from `from`: of its own, or of the widest other edge at its other end, or that end. */
static Vec2 point_ahead(const Joining *j, uint32_t half, uint32_t k, Vec2 from, double far)
{
    uint32_t node = centre_half_node(j->g, half ^ 1), widest = CENTRE_NONE;
    for (; k < centre_edge(j->g, half / 2)->n; k++)
        if (vec_dist(centre_half_point(j->g, half, k)->p, from) > far)
            return centre_half_point(j->g, half, k)->p;
    if (vec_dist(centre_node(j->g, node)->p, from) > far)
        return centre_node(j->g, node)->p;
    for (uint32_t i = j->start[node]; i < j->start[node + 1]; i++)
        if (j->at[i] / 2 != half / 2 && (widest == CENTRE_NONE || edge_radius(j->g, j->at[i] / 2) > edge_radius(j->g, widest / 2)))
            widest = j->at[i];
    for (k = widest != CENTRE_NONE ? half_exit(j->g, widest) : 0; widest != CENTRE_NONE && k < centre_edge(j->g, widest / 2)->n; k++)
        if (vec_dist(centre_half_point(j->g, widest, k)->p, from) > far)
            return centre_half_point(j->g, widest, k)->p;
    return centre_node(j->g, node)->p;
}

/* Where an edge goes once it has left its node's disc, over about the disc's radius; unit length. */
static Vec2 half_direction(const Joining *j, uint32_t half)
{
    const CentreNode *node = centre_node(j->g, centre_half_node(j->g, half));
    uint32_t k = half_exit(j->g, half);
    Vec2 from = k < centre_edge(j->g, half / 2)->n ? centre_half_point(j->g, half, k)->p : node->p;
    Vec2 d = vec_sub(point_ahead(j, half, k, from, node->r + 3.0), from);
    double length = sqrt(vec_norm2(d));
    return length > 0.0 ? vec_scale(d, 1.0 / length) : d;
}

typedef struct {
    uint32_t a, b; /* halves */
    double straight; /* cosine of the turn */
} Pair;

static gint straightest_first(gconstpointer a, gconstpointer b, gpointer user)
{
    const Pair *p = a, *q = b;
    return (p->straight < q->straight) - (p->straight > q->straight); /* equal ones stay in the order of the edges */
}

/* Joins, of the halves at one node, the two that go on straightest, then of the others, and so on. */
static void join_at(Joining *j, const uint32_t *half, uint32_t n)
{
    if (n == 2) { /* what was a junction, or a ring's first pixel */
        j->partner[half[0]] = half[1];
        j->partner[half[1]] = half[0];
        return;
    }
    g_array_set_size(j->pairs, 0);
    for (uint32_t a = 0; a < n; a++)
        for (uint32_t b = a + 1; b < n; b++) {
            Pair p = {half[a], half[b], -vec_dot(half_direction(j, half[a]), half_direction(j, half[b]))};
            if (p.straight >= STRAIGHT && half[a] / 2 != half[b] / 2)
                g_array_append_val(j->pairs, p);
        }
    if (j->pairs->len > 1)
        g_qsort_with_data(j->pairs->data, (gint)j->pairs->len, sizeof(Pair), straightest_first, NULL);
    for (guint k = 0; k < j->pairs->len; k++) {
        Pair p = g_array_index(j->pairs, Pair, k);
        if (j->partner[p.a] == CENTRE_NONE && j->partner[p.b] == CENTRE_NONE) {
            j->partner[p.a] = p.b;
            j->partner[p.b] = p.a;
        }
    }
}

uint32_t *centre_join(const CentreGraph *g)
{
    uint32_t halves = 2 * g->edge->len, nodes = g->node->len;
    Joining j = {g, g_new0(uint32_t, nodes + 2), g_new(uint32_t, halves + 1), g_new(uint32_t, halves + 1), g_array_new(FALSE, FALSE, sizeof(Pair))};
    for (uint32_t h = 0; h < halves; h++) {
        j.partner[h] = CENTRE_NONE;
        j.start[centre_half_node(g, h) + 2] += !centre_edge(g, h / 2)->gone;
    }
    for (uint32_t i = 0; i < nodes; i++)
        j.start[i + 2] += j.start[i + 1];
    for (uint32_t h = 0; h < halves; h++)
        if (!centre_edge(g, h / 2)->gone)
            j.at[j.start[centre_half_node(g, h) + 1]++] = h;
    for (uint32_t i = 0; i < nodes; i++)
        if (j.start[i + 1] - j.start[i] > 1)
            join_at(&j, j.at + j.start[i], j.start[i + 1] - j.start[i]);
    g_array_free(j.pairs, TRUE);
    g_free(j.start);
    g_free(j.at);
    return j.partner;
}
