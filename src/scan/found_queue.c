#include "scan/found_queue.h"

void found_queue_init(FoundQueue *q) { *q = (FoundQueue){.n = 0}; }

void found_queue_clear(FoundQueue *q)
{
    for (uint32_t b = 0; b < G_N_ELEMENTS(q->bucket); b++)
        g_free(q->bucket[b].e);
}

void found_queue_restart(FoundQueue *q)
{
    for (uint32_t b = 0; b < G_N_ELEMENTS(q->bucket); b++)
        q->bucket[b].n = 0;
    q->last = 0;
    q->n = 0;
}

static inline void place(FoundQueue *q, FoundEntry e)
{
    uint32_t x = e.key ^ q->last, b = x ? 32 - (uint32_t)__builtin_clz(x) : 0;
    if (q->bucket[b].n == q->bucket[b].room) {
        q->bucket[b].room = MAX(64, 2 * q->bucket[b].room);
        q->bucket[b].e = g_renew(FoundEntry, q->bucket[b].e, q->bucket[b].room);
    }
    q->bucket[b].e[q->bucket[b].n++] = e;
}

void found_queue_put(FoundQueue *q, uint32_t key, uint32_t value)
{
    g_assert(key >= q->last);
    place(q, (FoundEntry){key, value});
    q->n++;
}

bool found_queue_take(FoundQueue *q, FoundEntry *out)
{
    if (q->n == 0)
        return false;
    if (q->bucket[0].n == 0) {
        uint32_t b = 1;
        while (q->bucket[b].n == 0)
            b++;
        const FoundEntry *from = q->bucket[b].e;
        gsize n = q->bucket[b].n;
        q->last = from[0].key;
        for (gsize i = 1; i < n; i++)
            q->last = MIN(q->last, from[i].key);
        q->bucket[b].n = 0;
        for (gsize i = 0; i < n; i++) /* all go to lower buckets */
            place(q, from[i]);
    }
    *out = q->bucket[0].e[--q->bucket[0].n];
    q->n--;
    return true;
}
