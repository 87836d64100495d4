/* A turn of all sources: band by band they look at the fresh nodes, each on its own and on any thread; then, in the order of the slots and by one
 * thread after the other, they go when they are reached, and pull. What one thread writes and another reads costs more than all the rest where
 * their caches are far from each other: so a thread that draws a band sums it up, too, when its turn comes, and has the same bands step by step. */
#include <string.h>

#include "sim/state.h"

enum { RING = 3 * CROWD_SIDE, LANES_MOST = 64 };

typedef struct {
    Simulation *s;
    bool look, remove, pull;
    uint32_t lanes; /* threads that may come; each has every lanes-th group, as long as it can keep up */
    uint32_t ring;  /* bands that may wait, drawn */
    uint32_t rooms; /* for their pulls; one where none has to wait */
    gint settled __attribute__((aligned(64))); /* bands that no longer do; atomic */
} Turn;

/* A thread's part. */
typedef struct {
    Turn *t;
    uint32_t next; /* group, unless another has taken it */
    uint32_t seen; /* sources that the fresh nodes may concern */
    uint32_t n_waiting;
    bool waiting[RING * LANES_MOST]; /* drawn, not settled: band b at b % ring */
    Sight sight;
} Lane;

static void remove_all(Simulation *s, uint32_t first, uint32_t last)
{
    for (uint32_t k = first; k < last; k++)
        if (s->mark[k])
            source_remove_reached(s, k);
}

static void settle(Turn *t, uint32_t b)
{
    Simulation *s = t->s;
    const Band *band = &s->crowds.band[b];
    gsize at = (gsize)(b % t->rooms) * s->crowds.longest;
    if (t->pull)
        pulls_sum(s, band, t->remove, s->pull_x + at, s->pull_y + at);
    else
        remove_all(s, band->first, band->last);
}

/* Settles the lane's bands whose turn it is. */
static void settle_waiting(Lane *l)
{
    Turn *t = l->t;
    while (l->n_waiting) {
        uint32_t b = (uint32_t)g_atomic_int_get(&t->settled);
        if (!l->waiting[b % t->ring])
            return;
        settle(t, b);
        l->waiting[b % t->ring] = false;
        l->n_waiting--;
        g_atomic_int_set(&t->settled, (gint)b + 1);
    }
}

static void take_band(Lane *l, uint32_t b)
{
    Turn *t = l->t;
    Simulation *s = t->s;
    const Band *band = &s->crowds.band[b];
    gsize at = (gsize)(b % t->rooms) * s->crowds.longest;
    bool wanted = t->pull && s->veins.n;
    Draw draw = {wanted ? s->pull_x + at : NULL, wanted ? s->pull_y + at : NULL, band->first};
    for (uint32_t c = band->first_crowd; t->look && c < band->last_crowd; c++)
        l->seen += crowd_look(s, &s->crowds.crowd[c], &l->sight, &draw);
    if (!t->look)
        pulls_draw(s, band->first, band->last, &draw);
    l->waiting[b % t->ring] = true;
    l->n_waiting++;
    settle_waiting(l);
}

static void take_group(Lane *l, uint32_t g)
{
    const Group *group = &l->t->s->crowds.group[g];
    if (l->t->look)
        squares_prepare(l->t->s, group);
    for (uint32_t b = group->first_band; b < group->last_band; b++)
        take_band(l, b);
}

/* The next group of a lane, or, when that is too far ahead or there is none, the last one free of those whose bands may wait. n_groups: none. */
static uint32_t next_group(Lane *l)
{
    const Turn *t = l->t;
    const Crowds *c = &t->s->crowds;
    gint *taken = t->s->taken;
    uint32_t end = (uint32_t)g_atomic_int_get(&t->settled) + t->ring, last = c->n_groups;
    while (l->next < c->n_groups && g_atomic_int_get(&taken[l->next]))
        l->next += t->lanes;
    if (l->next < c->n_groups && c->group[l->next].last_band <= end)
        return l->next;
    while (last-- > 0)
        if (c->group[last].last_band <= end && !g_atomic_int_get(&taken[last]))
            return last;
    return c->n_groups;
}

static bool all_taken(const Turn *t)
{
    for (uint32_t g = t->s->crowds.n_groups; g-- > 0;)
        if (!g_atomic_int_get(&t->s->taken[g]))
            return false;
    return true;
}

static void take_lane(uint32_t first, uint32_t last, void *user)
{
    enum { PATIENCE = 20000 };
    Turn *t = user;
    Lane l;
    l.t = t;
    l.next = first;
    l.seen = l.n_waiting = 0;
    memset(l.waiting, 0, t->ring);
    for (uint32_t i = 1; l.n_waiting || !all_taken(t); i++) {
        uint32_t g = next_group(&l);
        if (g < t->s->crowds.n_groups) {
            if (g_atomic_int_compare_and_exchange(&t->s->taken[g], 0, 1))
                take_group(&l, g);
            continue;
        }
        settle_waiting(&l);
        if (i % PATIENCE == 0)
            g_usleep(50); /* the one whose turn it is has no processor */
    }
    g_atomic_int_add(&t->s->seen, (gint)l.seen); /* a sum: the order of the threads doesn't matter */
}

/* So few sources take less than a tenth of a millisecond, and one thread is as fast as two. */
static bool are_few(const Simulation *s)
{
    enum { OPEN = 8192, CLOSED = 4096 };
    return sources_alive(s) < (s->def.pattern == PATTERN_OPEN ? OPEN : CLOSED);
}

static void make_room(Simulation *s, uint32_t bands)
{
    const Crowds *c = &s->crowds;
    gsize wanted = (gsize)bands * c->longest;
    if (s->cap_pull < wanted) {
        s->cap_pull = wanted + wanted / 2;
        s->pull_x = g_renew(double, s->pull_x, s->cap_pull);
        s->pull_y = g_renew(double, s->pull_y, s->cap_pull);
    }
    if (s->cap_taken < c->n_groups) {
        s->cap_taken = 2 * c->n_groups;
        s->taken = g_renew(gint, s->taken, s->cap_taken);
    }
    for (uint32_t g = 0; g < c->n_groups; g++)
        s->taken[g] = 0;
}

void sources_turn(Simulation *s, bool look, bool remove, bool pull)
{
    Turn t = {.s = s, .look = look, .remove = remove, .pull = pull};
    t.lanes = are_few(s) ? 1 : MIN(pool_threads(s->pool), LANES_MOST);
    t.ring = RING * t.lanes;
    t.rooms = t.lanes == 1 ? 1 : t.ring;
    if (!look || !pull)
        crowds_wake(s, NO_POINT);
    if (look) {
        boxtree_build(&s->fresh_tree, s->veins.pos, s->fresh, s->n_fresh);
        fresh_prepare(s);
    }
    make_room(s, t.rooms);
    if (pull) {
        s->n_pulled = s->n_live = 0;
        s->drawn = true;
    }
    s->seen = 0;
    pool_for(s->pool, t.lanes, 1, take_lane, &t);
    s->counts.updates += (uint64_t)s->seen;
}
