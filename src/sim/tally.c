/* What is pulled in a step: the sums of all threads, joined, and sorted by node. */
#include "sim/state.h"

Pulled *tally_entry(Tally *t, uint32_t node)
{
    uint32_t *way = &t->way[node % TALLY_WAYS];
    if (*way < t->n && t->pulled[*way].node == node)
        return &t->pulled[*way];
    if (t->n == t->cap) {
        t->cap = MAX(t->cap * 2, 64);
        t->pulled = g_renew(Pulled, t->pulled, t->cap);
    }
    *way = t->n;
    t->pulled[t->n] = (Pulled){.node = node, .first = UINT32_MAX};
    return &t->pulled[t->n++];
}

/* ---- joined ---- */

static void reserve_pulled(Simulation *s, uint32_t n)
{
    if (s->cap_pulled >= n)
        return;
    s->cap_pulled = n + n / 2;
    s->pulled = g_renew(Pulled, s->pulled, s->cap_pulled);
}

/* The first entry of each node. */
static void list_nodes(Simulation *s, const Tally *t)
{
    for (uint32_t i = 0; i < t->n; i++) {
        uint32_t v = t->pulled[i].node, k = s->veins.pull[v];
        if (k < s->nodes->len && g_array_index(s->nodes, uint32_t, k) == v)
            continue;
        s->veins.pull[v] = s->nodes->len;
        g_array_append_val(s->nodes, v);
    }
}

static void add_entry(Pulled *sum, const Pulled *p)
{
    sum->sum = vec_add(sum->sum, p->sum);
    sum->count += p->count;
    sum->first = MIN(sum->first, p->first);
    sum->last = MAX(sum->last, p->last);
}

void tallies_join(Simulation *s, const Tally *const *tally, uint32_t n)
{
    g_array_set_size(s->nodes, 0);
    for (uint32_t i = 0; i < n; i++)
        list_nodes(s, tally[i]);
    uint32_t *node = (uint32_t *)(void *)s->nodes->data;
    boxtree_sort(node, s->nodes->len);
    s->n_pulled = s->nodes->len;
    reserve_pulled(s, s->n_pulled);
    for (uint32_t k = 0; k < s->n_pulled; k++) {
        s->veins.pull[node[k]] = k;
        s->pulled[k] = (Pulled){.node = node[k], .first = UINT32_MAX};
    }
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < tally[i]->n; j++)
            add_entry(&s->pulled[s->veins.pull[tally[i]->pulled[j].node]], &tally[i]->pulled[j]);
}
