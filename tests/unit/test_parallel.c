/* Parallel loops: every index once, whatever the sizes; threads that sleep and wake. */
#include <glib.h>
#include <string.h>

#include "geom/parallel.h"

typedef struct {
    uint32_t n, grain;
    uint8_t *seen;
    gint calls;
    uint32_t work; /* to make parts last */
} Count;

static void count_range(uint32_t first, uint32_t last, void *user)
{
    Count *c = user;
    g_assert_cmpuint(first % c->grain, ==, 0);
    g_assert_cmpuint(last - first, <=, c->grain);
    g_assert_cmpuint(last, <=, c->n);
    for (uint32_t i = first; i < last; i++) {
        c->seen[i]++;
        for (uint32_t k = 0; k < c->work; k++)
            g_atomic_int_get(&c->calls);
    }
    g_atomic_int_inc(&c->calls);
}

static void check_loop(Pool *pool, unsigned threads, uint32_t n, uint32_t grain, uint32_t work)
{
    Count c = {n, grain, g_new0(uint8_t, n + 1), 0, work};
    if (pool)
        pool_for(pool, n, grain, count_range, &c);
    else
        parallel_for(threads, n, grain, count_range, &c);
    for (uint32_t i = 0; i < n; i++)
        g_assert_cmpuint(c.seen[i], ==, 1);
    g_assert_cmpuint(c.seen[n], ==, 0);
    g_assert_cmpint(c.calls, ==, (gint)((n + grain - 1) / grain));
    g_free(c.seen);
}

/* More threads than processors too, and loops that follow each other without a pause: a worker that comes late from one must not take
 * part in the next. */
static void test_pool(void)
{
    static const unsigned threads[] = {1, 2, 3, 7, 0};
    for (uint32_t t = 0; t < G_N_ELEMENTS(threads); t++) {
        Pool *pool = pool_new(threads[t]);
        for (uint32_t round = 0; round < 3000; round++)
            check_loop(pool, 0, round * 7 % 90, 1 + round % 11, round % 40);
        check_loop(pool, 0, 100000, 1, 0);
        pool_free(pool);
    }
}

static void test_sleep(void)
{
    Pool *pool = pool_new(3);
    for (uint32_t round = 0; round < 60; round++) {
        check_loop(pool, 0, 64, 2, 200);
        g_usleep(round % 3 * 700); /* long enough to fall asleep, or just about to */
    }
    pool_free(pool);
    pool_free(pool_new(5)); /* never used */
    pool_free(NULL);
}

static void test_one_off(void)
{
    for (uint32_t n = 0; n < 40; n++)
        for (uint32_t grain = 1; grain < 9; grain += 3)
            check_loop(NULL, n % 4, n, grain, 0);
}

/* Do two threads work at the same time? Each part waits until the other has begun. */
typedef struct {
    gint begun;
} Meeting;

static void meet(uint32_t first, uint32_t last, void *user)
{
    Meeting *m = user;
    g_atomic_int_inc(&m->begun);
    while (g_atomic_int_get(&m->begun) < 2)
        g_thread_yield();
}

static void test_together(void)
{
    Pool *pool = pool_new(2);
    for (int k = 0; k < 20; k++) {
        Meeting m = {0};
        pool_for(pool, 2, 1, meet, &m);
    }
    pool_free(pool);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/parallel/pool", test_pool);
    g_test_add_func("/parallel/sleep", test_sleep);
    g_test_add_func("/parallel/one-off", test_one_off);
    g_test_add_func("/parallel/together", test_together);
    return g_test_run();
}
