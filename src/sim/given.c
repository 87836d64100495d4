/* Veins that are there before any grow: drawn by hand, or found in a scan. They grow with the blade like all veins. */
#include "sim/state.h"

enum { NONE = UINT32_MAX };

/* Step at which each node appears: with marginal growth, whose interior is at rest, when the margin has passed it and its parent is there; else
 * at once. */
static void find_steps(const Simulation *s, const Network *net, uint32_t *step)
{
    bool marginal = s->def.growth.kind == GROWTH_MARGINAL;
    for (uint32_t i = 0; i < net->n_nodes; i++)
        step[i] = marginal ? blade_step_passed(s->blade, s->given.place[i]) : 0;
    for (uint32_t e = 0; e < net->n_edges; e++) /* heads ascend along a vein, so one pass hands steps on */
        if (net->kind[e] == EDGE_VEIN)
            step[net->head[e]] = MAX(step[net->head[e]], step[net->tail[e]]);
}

static gint by_step(gconstpointer a, gconstpointer b, gpointer user)
{
    const uint32_t *step = user, i = *(const uint32_t *)a, j = *(const uint32_t *)b;
    return step[i] != step[j] ? (step[i] > step[j]) - (step[i] < step[j]) : (i > j) - (i < j);
}

void given_prepare(Simulation *s)
{
    const Network *net = s->def.given;
    Given *g = &s->given;
    const GrowthDef *growth = &s->def.growth;
    if (!net)
        return;
    double to_leaf = 1.0 / s->def.given_length;
    double length = growth->kind == GROWTH_MARGINAL ? growth->final_length : growth->initial_length;
    g->n = net->n_nodes;
    g->place = g_new(Vec2, MAX(g->n, 1));
    g->step = g_new(uint32_t, MAX(g->n, 1));
    g->turn = g_new(uint32_t, MAX(g->n, 1));
    g->node = g_new(uint32_t, MAX(g->n, 1));
    g->parent = g_new(uint32_t, MAX(g->n, 1));
    for (uint32_t i = 0; i < g->n; i++) {
        g->place[i] = vec_scale(net->node[i], to_leaf * length);
        g->turn[i] = i;
        g->node[i] = g->parent[i] = NONE;
    }
    for (uint32_t e = 0; e < net->n_edges; e++)
        if (net->kind[e] == EDGE_VEIN)
            g->parent[net->head[e]] = net->tail[e];
    find_steps(s, net, g->step);
    g_qsort_with_data(g->turn, (gint)g->n, sizeof *g->turn, by_step, g->step);
    if (growth->kind == GROWTH_MARGINAL)
        quadtree_init(&g->pending, box_grow(s->blade->widest, length));
}

void given_clear(Given *g)
{
    g_free(g->place);
    g_free(g->step);
    g_free(g->turn);
    g_free(g->node);
    g_free(g->parent);
    quadtree_clear(&g->pending);
}

static uint32_t appear(Simulation *s, uint32_t i)
{
    Given *g = &s->given;
    bool fixed = s->def.growth.kind == GROWTH_MARGINAL;
    uint32_t parent = g->parent[i] == NONE ? NO_POINT : g->node[g->parent[i]];
    uint32_t v = veins_add(&s->veins, fixed ? g->place[i] : blade_place(s->blade, g->place[i]), parent, s->blade->step);
    if (s->blade->moving)
        s->veins.material[v] = g->place[i];
    return g->node[i] = v;
}

/* Drawn loops close when the later end of the edge is there. */
static void join_given(Simulation *s)
{
    const Network *net = s->def.given;
    for (uint32_t e = 0; e < net->n_edges; e++)
        if (net->kind[e] == EDGE_ANASTOMOSIS)
            veins_join(&s->veins, s->given.node[net->tail[e]], s->given.node[net->head[e]], s->blade->step);
}

bool given_claims(const Simulation *s, Vec2 p)
{
    const double near = 1.5; /* segments: the tip of a drawn vein can't run ahead beside what will come of it */
    return s->given.next < s->given.n && quadtree_any_within(&s->given.pending, p, near);
}

static void renew_pending(Simulation *s)
{
    Given *g = &s->given;
    quadtree_reset(&g->pending, box_grow(s->blade->widest, s->blade->last_length));
    for (uint32_t k = g->next; k < g->n; k++)
        quadtree_add(&g->pending, g->place[g->turn[k]], g->turn[k]);
}

void given_appear(Simulation *s, void (*fresh)(Simulation *s, uint32_t node))
{
    Given *g = &s->given;
    uint32_t before = g->next;
    if (before == g->n)
        return;
    for (; g->next < g->n && g->step[g->turn[g->next]] <= s->blade->step; g->next++) {
        uint32_t v = appear(s, g->turn[g->next]);
        if (fresh)
            fresh(s, v);
    }
    if (g->next == g->n)
        join_given(s);
    else if (g->next > before || s->blade->step == 0)
        renew_pending(s);
}
