#include "geom/parallel.h"

#include <glib.h>
#include <stdatomic.h>
#include <stdbool.h>

enum { MAX_THREADS = 256 };

/* One that waits looks some times before it sleeps, at most for about what waking it costs twice over; where that was in vain because the wait
 * was long, as it is where others want the processors, it looks less often the next time. */
enum { PATIENCE_LEAST = 64, PATIENCE_MOST = 4096, PATIENCE_SHORT = 300 /* a wait in microseconds that is better looked through */ };

static const unsigned open_bit = 1u << 31;

struct Pool {
    /* the loop; written by the caller while the gate is shut and nobody is inside */
    LoopFn fn;
    void *user;
    uint32_t n, grain, n_parts;
    atomic_uint next; /* first part not taken yet */
    atomic_uint gate; /* open_bit while there are parts to take, plus the number of workers inside */
    atomic_uint turn; /* counts the loops: a worker enters each one once at most */
    atomic_bool quit;
    /* sleep */
    atomic_uint asleep;
    atomic_bool caller_asleep;
    GMutex mutex;
    GCond wake, empty; /* empty: nobody is inside any more */
    GThread *worker[MAX_THREADS];
    unsigned n_workers, most_workers;
    unsigned most_patience, patience; /* patience: the caller's */
};

static inline void breathe(void)
{
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#elif defined(__aarch64__)
    __asm__ volatile("yield");
#endif
}

static void run_parts(Pool *p)
{
    for (;;) {
        uint32_t part = atomic_fetch_add(&p->next, 1);
        if (part >= p->n_parts)
            return;
        uint32_t first = part * p->grain;
        uint32_t last = p->n - first > p->grain ? first + p->grain : p->n;
        p->fn(first, last, p->user);
    }
}

/* ---- workers ---- */

static inline bool has_loop(Pool *p, unsigned done)
{
    return (atomic_load(&p->gate) & open_bit) && atomic_load(&p->turn) != done;
}

/* After a sleep since `start`. */
static void learn(const Pool *p, gint64 start, unsigned *patience)
{
    if (g_get_monotonic_time() - start < PATIENCE_SHORT)
        *patience = p->most_patience;
    else
        *patience = MIN(MAX(*patience / 2, PATIENCE_LEAST), p->most_patience);
}

/* Waits for a loop other than number `done`; FALSE when the pool ends. */
static bool wait_for_loop(Pool *p, unsigned done, unsigned *patience)
{
    for (unsigned i = 0; i < *patience; i++) {
        if (atomic_load(&p->quit))
            return false;
        if (has_loop(p, done))
            return true;
        breathe();
    }
    gint64 start = g_get_monotonic_time();
    g_mutex_lock(&p->mutex);
    atomic_fetch_add(&p->asleep, 1); /* before the last look: pool_for opens the gate, then looks for sleepers */
    while (!atomic_load(&p->quit) && !has_loop(p, done))
        g_cond_wait(&p->wake, &p->mutex);
    atomic_fetch_sub(&p->asleep, 1);
    g_mutex_unlock(&p->mutex);
    learn(p, start, patience);
    return !atomic_load(&p->quit);
}

/* The last one out wakes the caller, who has shut the gate. */
static void leave(Pool *p)
{
    if (atomic_fetch_sub(&p->gate, 1) != 1 || !atomic_load(&p->caller_asleep))
        return;
    g_mutex_lock(&p->mutex);
    g_cond_signal(&p->empty);
    g_mutex_unlock(&p->mutex);
}

static gpointer work(gpointer data)
{
    Pool *p = data;
    unsigned done = 0, patience = p->most_patience;
    while (wait_for_loop(p, done, &patience)) {
        unsigned gate = atomic_load(&p->gate);
        while ((gate & open_bit) && !atomic_compare_exchange_weak(&p->gate, &gate, gate + 1))
            ;
        if (!(gate & open_bit))
            continue; /* too late: it has been shut meanwhile */
        done = atomic_load(&p->turn);
        run_parts(p);
        leave(p);
    }
    return NULL;
}

/* ---- the caller's side ---- */

Pool *pool_new(unsigned threads)
{
    Pool *p = g_new0(Pool, 1);
    unsigned processors = g_get_num_processors();
    threads = MIN(threads ? threads : processors, MAX_THREADS);
    p->most_workers = threads - 1;
    p->most_patience = p->patience = threads <= processors ? PATIENCE_MOST : 0; /* else the one that looks keeps out the one that works */
    g_mutex_init(&p->mutex);
    g_cond_init(&p->wake);
    g_cond_init(&p->empty);
    return p;
}

void pool_free(Pool *p)
{
    if (!p)
        return;
    g_mutex_lock(&p->mutex);
    atomic_store(&p->quit, true);
    g_cond_broadcast(&p->wake);
    g_mutex_unlock(&p->mutex);
    for (unsigned i = 0; i < p->n_workers; i++)
        g_thread_join(p->worker[i]);
    g_mutex_clear(&p->mutex);
    g_cond_clear(&p->wake);
    g_cond_clear(&p->empty);
    g_free(p);
}

unsigned pool_threads(const Pool *p) { return p->most_workers + 1; }

static void start_workers(Pool *p, unsigned count)
{
    while (p->n_workers < MIN(count, p->most_workers)) {
        GThread *t = g_thread_try_new("parallel", work, p, NULL);
        if (!t) {
            p->most_workers = p->n_workers; /* a system that gives no more threads only makes the loops slower */
            break;
        }
        p->worker[p->n_workers++] = t;
    }
}

static void open_gate(Pool *p)
{
    atomic_fetch_add(&p->turn, 1);
    atomic_store(&p->gate, open_bit);
    if (atomic_load(&p->asleep) == 0)
        return;
    g_mutex_lock(&p->mutex);
    g_cond_broadcast(&p->wake);
    g_mutex_unlock(&p->mutex);
}

/* Waits for those inside. */
static void shut_gate(Pool *p)
{
    atomic_fetch_and(&p->gate, ~open_bit);
    for (unsigned i = 0; i < p->patience; i++) {
        if (atomic_load(&p->gate) == 0)
            return;
        breathe();
    }
    gint64 start = g_get_monotonic_time();
    g_mutex_lock(&p->mutex);
    atomic_store(&p->caller_asleep, true); /* before the last look: the last one out counts itself out, then looks for a sleeper */
    while (atomic_load(&p->gate) != 0)
        g_cond_wait(&p->empty, &p->mutex);
    atomic_store(&p->caller_asleep, false);
    g_mutex_unlock(&p->mutex);
    learn(p, start, &p->patience);
}

void pool_for(Pool *p, uint32_t n, uint32_t grain, LoopFn fn, void *user)
{
    if (n == 0)
        return;
    /* Few enough parts that the counter can't overflow; more than anyone needs. */
    uint32_t least = n / (1u << 24) + 1;
    p->fn = fn;
    p->user = user;
    p->n = n;
    p->grain = MAX(grain, least);
    p->n_parts = (n - 1) / p->grain + 1;
    atomic_store(&p->next, 0);
    start_workers(p, p->n_parts - 1);
    bool shared = p->n_workers && p->n_parts > 1;
    if (shared)
        open_gate(p);
    run_parts(p);
    if (shared)
        shut_gate(p);
}

void parallel_for(unsigned threads, uint32_t n, uint32_t grain, LoopFn fn, void *user)
{
    Pool *p = pool_new(threads);
    pool_for(p, n, grain, fn, user);
    pool_free(p);
}
