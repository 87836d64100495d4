#include "geom/parallel.h"

#include <glib.h>

enum { MAX_THREADS = 256 };

typedef struct {
    void (*fn)(uint32_t first, uint32_t last, void *user);
    void *user;
    uint32_t n, grain, n_parts;
    gint next; /* first part not taken yet; atomic */
} Loop;

static gpointer loop_run(gpointer data)
{
    Loop *loop = data;
    for (;;) {
        uint32_t part = (uint32_t)g_atomic_int_add(&loop->next, 1);
        if (part >= loop->n_parts)
            return NULL;
        uint32_t first = part * loop->grain;
        uint32_t last = loop->n - first > loop->grain ? first + loop->grain : loop->n;
        loop->fn(first, last, loop->user);
    }
}

void parallel_for(unsigned threads, uint32_t n, uint32_t grain, void (*fn)(uint32_t first, uint32_t last, void *user),
                  void *user)
{
    if (n == 0)
        return;
    /* Few enough parts that the counter can't overflow; more than anyone needs. */
    uint32_t least = n / (1u << 24) + 1;
    if (grain < least)
        grain = least;
    Loop loop = {fn, user, n, grain, (n - 1) / grain + 1, 0};
    if (threads == 0)
        threads = g_get_num_processors();
    threads = MIN(MIN(threads, loop.n_parts), MAX_THREADS);
    GThread *helper[MAX_THREADS];
    unsigned started = 0;
    while (started + 1 < threads) {
        /* A system that gives no more threads only makes the loop slower. */
        GThread *t = g_thread_try_new("parallel", loop_run, &loop, NULL);
        if (t == NULL)
            break;
        helper[started++] = t;
    }
    loop_run(&loop);
    for (unsigned i = 0; i < started; i++)
        g_thread_join(helper[i]);
}
