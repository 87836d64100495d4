#include "cached.h"

typedef struct {
    Vec2 p;
    double d2;
    uint32_t near;
} Auxin;

typedef struct {
    Vec2 p, sum;
    uint32_t pulls, child; /* child: the last one, 0 for none */
} Node;

static void pull(const Auxin *auxin, uint32_t n, Node *node)
{
    for (uint32_t k = 0; k < n; k++) {
        Node *v = &node[auxin[k].near];
        Vec2 d = vec_sub(auxin[k].p, v->p);
        v->sum = vec_add(v->sum, vec_scale(d, 1.0 / sqrt(vec_norm2(d))));
        v->pulls++;
    }
}

static bool grows(const Node *node, Node *v, Vec2 *p)
{
    double length = sqrt(vec_norm2(v->sum));
    if (v->pulls == 0 || length < 1e-6 * v->pulls)
        return false;
    *p = vec_add(v->p, vec_scale(v->sum, 1.0 / length));
    return v->child == 0 || vec_dist2(*p, node[v->child].p) >= 0.01;
}

static void look(Auxin *auxin, uint32_t n, const Node *node, uint32_t first, uint32_t last)
{
    for (uint32_t k = 0; k < n; k++)
        for (uint32_t i = first; i < last; i++) {
            double d2 = vec_dist2(auxin[k].p, node[i].p);
            if (d2 < auxin[k].d2) {
                auxin[k].d2 = d2;
                auxin[k].near = i;
            }
        }
}

void cached_grow(const SimulationDef *def, SimulationCounts *counts)
{
    uint32_t n = def->n_list, n_nodes = 1, cap = 1024, first = 0;
    double kill2 = def->kill_distance * def->kill_distance;
    Auxin *auxin = g_new(Auxin, n);
    Node *node = g_new0(Node, cap);
    *counts = (SimulationCounts){0};
    for (uint32_t k = 0; k < n; k++)
        auxin[k] = (Auxin){def->list[k].pos, vec_norm2(def->list[k].pos), 0};
    while (first < n_nodes) {
        counts->step++;
        pull(auxin, n, node);
        first = n_nodes;
        for (uint32_t v = 0; v < first; v++) {
            Vec2 p;
            bool child = grows(node, &node[v], &p);
            node[v].sum = vec2(0.0, 0.0);
            node[v].pulls = 0;
            if (!child)
                continue;
            if (n_nodes == cap)
                node = g_renew(Node, node, cap *= 2);
            node[v].child = n_nodes;
            node[n_nodes++] = (Node){.p = p};
        }
        look(auxin, n, node, first, n_nodes);
        for (uint32_t k = 0; k < n;)
            if (auxin[k].d2 < kill2)
                auxin[k] = auxin[--n];
            else
                k++;
    }
    counts->nodes = n_nodes;
    counts->sources = n;
    g_free(auxin);
    g_free(node);
}
