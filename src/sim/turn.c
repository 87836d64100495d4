/* A turn of all sources: band by band they look at the fresh nodes, each on its own and on any thread; then, in the order of the slots and by one
 * thread after the other, they go when they are reached, and pull. What one thread writes and another reads costs more than all the rest where
 * their caches are far from each other: so a thread that draws a band sums it up, too, when its turn comes, and has the same bands step by step. */
#include <string.h>

#include "sim/state.h"

enum { RING = 3 * CROWD_SIDE, ROOMS = RING + CROWD_SIDE, LANES_MOST = 64 };

typedef struct {
    Simulation *s;
    bool look, remove, pull;
    uint32_t lanes; /* threads that may come */
    uint32_t ring;  /* bands that may wait, drawn */
    uint32_t rooms; /* a lane's, for their pulls; one where none has to wait */
    gint settled __attribute__((aligned(64))); /* bands that no longer do; atomic */
} Turn;

enum { NO_ROOM = UINT8_MAX };

/* A thread's part. */
typedef struct {
    Turn *t;
    uint32_t lane;
    uint32_t next; /* no group of the lane's own before it is free */
    uint32_t seen; /* sources that the fresh nodes may concern */
    uint32_t n_waiting;
    uint8_t waiting[RING * LANES_MOST]; /* the room of band b at b % ring, if it is drawn and not settled, else NO_ROOM */
    uint8_t room[ROOMS];                /* those from n_waiting on are free; the last one that became so comes first, while it is in the cache */
    Sight sight;
} Lane;

static void remove_all(Simulation *s, uint32_t first, uint32_t last)
{
    for (uint32_t k = first; k < last; k++)
        if (s->mark[k])
            source_remove_reached(s, k);
}

static gsize room_at(const Lane *l, uint32_t room) { return ((gsize)l->lane * l->t->rooms + room) * l->t->s->crowds.longest; }

static void settle(const Lane *l, uint32_t b, uint32_t room)
{
    Simulation *s = l->t->s;
    const Band *band = &s->crowds.band[b];
    if (l->t->pull)
        pulls_sum(s, band, l->t->remove, s->pull_x + room_at(l, room), s->pull_y + room_at(l, room));
    else
        remove_all(s, band->first, band->last);
}

/* Settles the lane's bands whose turn it is. */
static void settle_waiting(Lane *l)
{
    Turn *t = l->t;
    while (l->n_waiting) {
        uint32_t b = (uint32_t)g_atomic_int_get(&t->settled);
        uint8_t *waiting = &l->waiting[b % t->ring];
        if (*waiting == NO_ROOM)
            return;
        settle(l, b, *waiting);
        l->room[--l->n_waiting] = *waiting;
        *waiting = NO_ROOM;
        g_atomic_int_set(&t->settled, (gint)b + 1);
    }
}

static void take_band(Lane *l, uint32_t b)
{
    Turn *t = l->t;
    Simulation *s = t->s;
    const Band *band = &s->crowds.band[b];
    uint8_t room = l->room[l->n_waiting++];
    bool wanted = t->pull && s->veins.n;
    Draw draw = {wanted ? s->pull_x + room_at(l, room) : NULL, wanted ? s->pull_y + room_at(l, room) : NULL, band->first, false};
    draw.at_once = wanted && (uint32_t)g_atomic_int_get(&t->settled) == b;
    for (uint32_t c = band->first_crowd; t->look && c < band->last_crowd; c++)
        l->seen += crowd_look(s, &s->crowds.crowd[c], &l->sight, &draw);
    if (!t->look)
        pulls_draw(s, band->first, band->last, &draw);
    l->waiting[b % t->ring] = room;
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

/* What taken[] says of a group: whether a thread is at work at it, or has been in this turn; and whose it is (mod the number of lanes). It is its
 * taker's in the next turn, too, so that sources are mostly in the cache of the one who looks at them. */
enum { TAKEN = 1 << 30 };

static bool is_free(const Turn *t, uint32_t g) { return !(g_atomic_int_get(&t->s->taken[g]) & TAKEN); }

static bool take(const Lane *l, uint32_t g)
{
    gint *taken = &l->t->s->taken[g], was = g_atomic_int_get(taken);
    return !(was & TAKEN) && g_atomic_int_compare_and_exchange(taken, was, (gint)l->lane | TAKEN);
}

/* A lane's next group, or, when that is too far ahead or there is none, the last one free of those whose bands may wait. n_groups: none. With RING
 * bands waiting a lane takes no other; when all do, one of theirs is the next to be settled. */
static uint32_t next_group(Lane *l)
{
    const Turn *t = l->t;
    const Crowds *c = &t->s->crowds;
    uint32_t end = (uint32_t)g_atomic_int_get(&t->settled) + t->ring, last = c->n_groups;
    if (l->n_waiting >= RING)
        return c->n_groups;
    while (l->next < c->n_groups && (!is_free(t, l->next) || (uint32_t)g_atomic_int_get(&t->s->taken[l->next]) % t->lanes != l->lane))
        l->next++;
    if (l->next < c->n_groups && c->group[l->next].last_band <= end)
        return l->next;
    while (last-- > 0)
        if (c->group[last].last_band <= end && is_free(t, last))
            return last;
    return c->n_groups;
}

static bool all_taken(const Turn *t)
{
    for (uint32_t g = t->s->crowds.n_groups; g-- > 0;)
        if (is_free(t, g))
            return false;
    return true;
}

static void take_lane(uint32_t first, uint32_t last, void *user)
{
    enum { POLITENESS = 256, PATIENCE = 4096 };
    Turn *t = user;
    Lane l;
    l.t = t;
    l.lane = first;
    l.next = l.seen = l.n_waiting = 0;
    memset(l.waiting, NO_ROOM, t->ring);
    for (uint8_t i = 0; i < ROOMS; i++)
        l.room[i] = i;
    for (uint32_t i = 1; l.n_waiting || !all_taken(t); i++) {
        uint32_t g = next_group(&l);
        if (g < t->s->crowds.n_groups) {
            if (take(&l, g))
                take_group(&l, g);
            continue;
        }
        settle_waiting(&l);
        if (i % PATIENCE == 0) /* the one whose turn it is may have no processor */
            g_usleep(50);
        else if (i % POLITENESS == 0)
            g_thread_yield();
    }
    g_atomic_int_add(&t->s->seen, (gint)l.seen); /* a sum: the order of the threads doesn't matter */
}

/* So few sources take less than some tens of microseconds, and one thread is as fast as two. */
static bool are_few(const Simulation *s)
{
    enum { OPEN = 4096, CLOSED = 2048 };
    return sources_alive(s) < (s->def.pattern == PATTERN_OPEN ? OPEN : CLOSED);
}

/* Whether more threads are faster than one depends on how far from each other their caches are, and on what else the machine is at: where one is kept
 * from going on, all wait for it. So one does some turns alone every so often; if it is faster, then some more, and ever more as long as it is.
 * This tells how long a turn takes, not what comes of it. */
static void pace_note(Pace *p, gint64 time, uint32_t sources)
{
    enum { TRIAL = 8, NEW = 2 /* not counted: until all are awake */, SHARED_MOST = 256, SHARED_LEAST = 32, ALONE_LEAST = 32, ALONE_MOST = 1024 };
    if (p->shared == 0) {
        p->shared = SHARED_MOST;
        p->alone = ALONE_LEAST;
    }
    if (++p->turns > NEW) {
        p->time += (double)time;
        p->sources += sources;
    }
    if (p->turns < (p->kind == PACE_SHARED ? p->shared : p->kind == PACE_TRIAL ? TRIAL : p->alone))
        return;
    double cost = p->time / p->sources;
    if (p->kind == PACE_SHARED) {
        p->cost = cost;
        p->kind = PACE_TRIAL;
    } else if (p->kind == PACE_TRIAL && cost < p->cost) {
        p->shared = SHARED_LEAST;
        p->alone = MIN(2 * p->alone, ALONE_MOST);
        p->kind = PACE_ALONE;
    } else {
        if (p->kind == PACE_TRIAL) {
            p->shared = SHARED_MOST;
            p->alone = ALONE_LEAST;
        }
        p->kind = PACE_SHARED;
    }
    p->turns = 0;
    p->time = p->sources = 0.0;
}

static void make_room(const Turn *t)
{
    Simulation *s = t->s;
    const Crowds *c = &s->crowds;
    gsize wanted = (gsize)t->lanes * t->rooms * c->longest;
    if (s->cap_pull < wanted) {
        s->cap_pull = wanted + wanted / 2;
        s->pull_x = g_renew(double, s->pull_x, s->cap_pull);
        s->pull_y = g_renew(double, s->pull_y, s->cap_pull);
    }
    if (s->cap_taken < c->n_groups) {
        s->cap_taken = 2 * c->n_groups;
        s->taken = g_renew(gint, s->taken, s->cap_taken);
    }
    for (; s->n_taken < c->n_groups; s->n_taken++)
        s->taken[s->n_taken] = (gint)s->n_taken;
    for (uint32_t g = 0; g < c->n_groups; g++)
        s->taken[g] &= ~TAKEN;
}

void sources_turn(Simulation *s, bool look, bool remove, bool pull)
{
    Turn t = {.s = s, .look = look, .remove = remove, .pull = pull};
    bool many = pool_threads(s->pool) > 1 && !are_few(s);
    gint64 start = many ? g_get_monotonic_time() : 0;
    t.lanes = !many || s->pace.kind != PACE_SHARED ? 1 : MIN(pool_threads(s->pool), LANES_MOST);
    t.ring = RING * t.lanes;
    t.rooms = t.lanes == 1 ? 1 : ROOMS;
    if (!look || !pull)
        crowds_wake(s, NO_POINT);
    if (look)
        fresh_prepare(s);
    make_room(&t);
    if (pull) {
        s->n_pulled = s->n_live = 0;
        s->drawn = true;
    }
    s->seen = 0;
    pool_for(s->pool, t.lanes, 1, take_lane, &t);
    s->counts.updates += (uint64_t)s->seen;
    if (many && look)
        pace_note(&s->pace, g_get_monotonic_time() - start, sources_alive(s));
}
