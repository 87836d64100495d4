/* What the drawing does not say is made: orders, widths, veins, ranks. */
#include "geom/dmath.h"
#include "sim/drawing_private.h"

/* Where a drawn vein ends another one of its order continues it that turns by less than 60°. */
static const double straight = 0.5; /* cosine */

typedef struct {
    const Sketch *s;
    Network *net;
    const uint32_t *line;
    const double *drawn;   /* [n_edges] widths */
    uint32_t *entry;       /* [n_nodes] vein edge that leads there, or NONE */
    uint32_t *first, *next; /* vein edges by tail */
    uint32_t *made_vein;   /* [n_edges] as network_assign_widths has it */
    uint8_t *made_order;
} Completing;

static uint8_t drawn_order(const Completing *c, uint32_t e) { return LINE(c->s, c->line[e])->order; }

/* The vein edge that e comes from; NONE at a first node. */
static uint32_t parent(const Completing *c, uint32_t e) { return c->entry[c->net->tail[e]]; }

static void chain_edges(Completing *c)
{
    const Network *net = c->net;
    for (uint32_t v = 0; v < net->n_nodes; v++)
        c->first[v] = c->entry[v] = NONE;
    for (uint32_t e = net->n_edges; e-- > 0;)
        if (net->kind[e] == EDGE_VEIN) {
            c->next[e] = c->first[net->tail[e]];
            c->first[net->tail[e]] = e;
            c->entry[net->head[e]] = e;
        }
}

/* ---- orders ---- */

static bool line_goes_on(const Completing *c, uint32_t e)
{
    for (uint32_t k = c->first[c->net->head[e]]; k != NONE; k = c->next[k])
        if (c->line[k] == c->line[e])
            return true;
    return false;
}

/* Drawn orders stay, and what is drawn in one stroke is of one order. What else leaves such a vein is a branch, unless network_assign_widths
 * takes it for another primary; where the stroke ends, the order changes as it has it. */
static uint8_t vein_order(const Completing *c, uint32_t e)
{
    uint32_t p = parent(c, e);
    if (drawn_order(c, e))
        return drawn_order(c, e);
    if (p == NONE)
        return c->made_order[e];
    uint8_t order = c->net->order[p];
    if (c->line[e] == c->line[p])
        return order;
    bool primary = order == 1 && c->made_order[e] == 1 && c->made_vein[e] != c->made_vein[p];
    int step = line_goes_on(c, p) ? !primary : MAX(c->made_order[e] - c->made_order[p], 0);
    return (uint8_t)MIN(order + step, 250);
}

/* That of the finer of the veins it joins. */
static uint8_t anastomosis_order(const Completing *c, uint32_t e)
{
    uint32_t a = c->entry[c->net->tail[e]], b = c->entry[c->net->head[e]];
    if (drawn_order(c, e))
        return drawn_order(c, e);
    uint8_t first = a == NONE ? 1 : c->net->order[a], last = b == NONE ? 1 : c->net->order[b];
    return MAX(first, last);
}

/* ---- widths ---- */

/* Drawn widths stay; a vein of unknown width is no wider than the one it leaves. */
static void set_widths(Completing *c)
{
    Network *net = c->net;
    const WidthDef *def = &c->s->def->widths;
    for (uint32_t e = 0; e < net->n_edges; e++) {
        uint32_t p = parent(c, e);
        double width = c->drawn[e] > 0.0 ? c->drawn[e] : p != NONE ? MIN(net->width[e], net->width[p]) : net->width[e];
        if (width == net->width[e])
            continue;
        net->width[e] = width;
        net->flow[e] = dmath_pow(width / def->minimum, def->exponent);
    }
}

/* ---- veins ---- */

static double cosine(const Network *net, uint32_t e, uint32_t k)
{
    Vec2 u = vec_sub(net->node[net->head[e]], net->node[net->tail[e]]), v = vec_sub(net->node[net->head[k]], net->node[net->tail[k]]);
    return vec_dot(u, v) / sqrt(vec_norm2(u) * vec_norm2(v));
}

/* The edge of e's order that continues its vein: of its line; else, where orders are made, of the vein that was made with it; else the
 * straightest. */
static uint32_t continuation(const Completing *c, uint32_t e)
{
    const Network *net = c->net;
    uint32_t best = NONE, made = NONE, own = NONE;
    double most = straight;
    for (uint32_t k = c->first[net->head[e]]; k != NONE; k = c->next[k]) {
        if (net->order[k] != net->order[e])
            continue;
        if (own == NONE && c->line[k] == c->line[e])
            own = k;
        if (made == NONE && !drawn_order(c, e) && !drawn_order(c, k) && c->made_vein[k] == c->made_vein[e])
            made = k;
        double straightness = cosine(net, e, k);
        if (straightness > most) {
            most = straightness;
            best = k;
        }
    }
    return own != NONE ? own : made != NONE ? made : best;
}

/* Nodes in order, so that a vein's number is known before its next edge's. */
static void number_veins(Completing *c)
{
    Network *net = c->net;
    net->n_veins = 0;
    for (uint32_t v = 0; v < net->n_nodes; v++) {
        uint32_t main = c->entry[v] == NONE ? NONE : continuation(c, c->entry[v]);
        for (uint32_t e = c->first[v]; e != NONE; e = c->next[e])
            net->vein[e] = e == main ? net->vein[c->entry[v]] : net->n_veins++;
    }
    for (uint32_t e = 0; e < net->n_edges; e++)
        if (net->kind[e] != EDGE_VEIN)
            net->vein[e] = net->n_veins++;
}

void sketch_complete(const Sketch *s, Network *net, const uint32_t *line, const double *width)
{
    uint32_t n = net->n_nodes, m = net->n_edges;
    network_assign_widths(net, &s->def->widths);
    Completing c = {.s = s, .net = net, .line = line, .drawn = width};
    c.entry = g_new(uint32_t, n);
    c.first = g_new(uint32_t, n);
    c.next = g_new(uint32_t, m);
    c.made_vein = g_memdup2(net->vein, m * sizeof *net->vein);
    c.made_order = g_memdup2(net->order, m);
    chain_edges(&c);
    for (uint32_t e = 0; e < m; e++) /* veins come first, each after the one it leaves */
        net->order[e] = net->kind[e] == EDGE_VEIN ? vein_order(&c, e) : anastomosis_order(&c, e);
    set_widths(&c);
    number_veins(&c);
    network_assign_ranks(net, &s->def->widths);
    g_free(c.entry);
    g_free(c.first);
    g_free(c.next);
    g_free(c.made_vein);
    g_free(c.made_order);
}
