/* What is pulled in a step: the sums of all threads, joined, and sorted by node. */
#include <string.h>

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

/* ---- lists of numbers ---- */

void numbers_add(Numbers *l, uint32_t number)
{
    if (l->n == l->cap) {
        l->cap = MAX(l->cap * 2, 64);
        l->v = g_renew(uint32_t, l->v, l->cap);
    }
    l->v[l->n++] = number;
}

/* One digit, stably. */
static void sort_digit(const Numbers *l, uint32_t shift, uint32_t *sorted)
{
    uint32_t start[256] = {0};
    for (uint32_t i = 0; i < l->n; i++)
        start[l->v[i] >> shift & 255]++;
    for (uint32_t d = 0, sum = 0; d < 256; d++) {
        uint32_t count = start[d];
        start[d] = sum;
        sum += count;
    }
    for (uint32_t i = 0; i < l->n; i++)
        sorted[start[l->v[i] >> shift & 255]++] = l->v[i];
}

void numbers_sort(Numbers *l)
{
    uint32_t all = 0;
    for (uint32_t i = 0; i < l->n; i++)
        all |= l->v[i];
    if (l->cap_room < l->n) {
        l->cap_room = l->cap;
        l->room = g_renew(uint32_t, l->room, l->cap_room);
    }
    for (uint32_t shift = 0; shift < 32 && all >> shift; shift += 8) {
        sort_digit(l, shift, l->room);
        memcpy(l->v, l->room, sizeof *l->v * l->n);
    }
}

void numbers_clear(Numbers *l)
{
    g_free(l->v);
    g_free(l->room);
    *l = (Numbers){0};
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
        if (k < s->nodes.n && s->nodes.v[k] == v)
            continue;
        s->veins.pull[v] = s->nodes.n;
        numbers_add(&s->nodes, v);
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
    s->nodes.n = 0;
    for (uint32_t i = 0; i < n; i++)
        list_nodes(s, tally[i]);
    numbers_sort(&s->nodes);
    s->n_pulled = s->nodes.n;
    reserve_pulled(s, s->n_pulled);
    for (uint32_t k = 0; k < s->n_pulled; k++) {
        s->veins.pull[s->nodes.v[k]] = k;
        s->pulled[k] = (Pulled){.node = s->nodes.v[k], .first = UINT32_MAX};
    }
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < tally[i]->n; j++)
            add_entry(&s->pulled[s->veins.pull[tally[i]->pulled[j].node]], &tally[i]->pulled[j]);
}
