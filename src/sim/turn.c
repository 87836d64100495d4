/* A turn of all sources: they look at the fresh nodes, go when they are reached, and pull. Threads take up the crowds' units, each source looks and pulls
 * on its own, and sums of pulls are the same in any order (pull.h); what one source does to others comes last, slot by slot and by one thread.
 * What one thread writes and another reads costs more than all the rest where their caches are far from each other: so each has a part of the blade,
 * the same from turn to turn but for what it takes over from one that is late. */
#include <stdatomic.h>
#include <string.h>

#include "sim/state.h"

enum { LANES_MOST = 64, CACHE_LINES = 128 };

/* What a thread has to itself. */
struct Lane {
    _Atomic uint64_t free; /* its units that nobody has taken, from the lower half to, not included, the upper one */
    uint32_t taken, share; /* units it took up, its own and others; the same, when it last was not alone */
    uint32_t seen;         /* sources that the fresh nodes may concern */
    Tally tally;
    Sums sums;
    GArray *late; /* uint32_t: slots where something happens first (develop.c) */
    double *x, *y; /* [cap] pulls of a crowd */
    uint32_t cap;
    Sight sight;
    Square square;
};

typedef struct {
    Simulation *s;
    bool look, remove, pull;
    uint32_t lanes; /* at work */
} Turn;

/* ---- units ---- */

static bool take(Lane *l, bool from_behind, uint32_t *unit)
{
    uint64_t was = atomic_load(&l->free);
    for (;;) {
        uint32_t first = (uint32_t)was, last = (uint32_t)(was >> 32);
        if (first >= last)
            return false;
        *unit = from_behind ? last - 1 : first;
        if (atomic_compare_exchange_weak(&l->free, &was, from_behind ? was - ((uint64_t)1 << 32) : was + 1))
            return true;
    }
}

/* Where the pulls of a crowd go, run by run. */
static void draw_to(const Lane *l, const Crowd *c, bool wanted, Draw *draw)
{
    uint32_t n = 0;
    for (uint32_t r = 0; r < CROWD_SIDE; r++) {
        draw[r] = (Draw){wanted ? l->x + n : NULL, wanted ? l->y + n : NULL, c->first[r]};
        n += c->last[r] - c->first[r];
    }
}

static void list_late(const Simulation *s, const Crowd *c, GArray *late)
{
    for (uint32_t r = 0; r < CROWD_SIDE; r++)
        for (uint32_t k = c->first[r]; k < c->last[r]; k++)
            if (source_is_late(s, k))
                g_array_append_val(late, k);
}

static void take_unit(const Turn *t, Lane *l, const Unit *u)
{
    Simulation *s = t->s;
    bool wanted = t->pull && s->veins.n;
    if (t->look && u->square)
        square_prepare(s, u, &l->square);
    for (uint32_t i = u->first_crowd; i < u->last_crowd; i++) {
        Crowd *c = &s->crowds.crowd[i];
        Draw draw[CROWD_SIDE];
        draw_to(l, c, wanted, draw);
        if (t->look)
            l->seen += crowd_look(s, c, u->square ? &l->square : NULL, &l->sight, draw);
        else
            for (uint32_t r = 0; r < CROWD_SIDE; r++)
                pulls_draw(s, c->first[r], c->last[r], &draw[r]);
        if (t->pull)
            crowd_pull(s, c, &l->sums, draw, t->remove ? l->late : NULL);
        else if (t->remove)
            list_late(s, c, l->late);
    }
}

static void take_lane(uint32_t first, uint32_t last, void *user)
{
    const Turn *t = user;
    Lane *own = t->s->lane[first];
    for (uint32_t i = 0, unit; i < t->lanes; i++) /* its own units, then those of others */
        while (take(t->s->lane[(first + i) % t->lanes], i > 0, &unit)) {
            take_unit(t, own, &t->s->crowds.unit[unit]);
            own->taken++;
        }
    sums_end(&own->sums);
}

/* ---- lanes ---- */

static void lane_reset(Lane *l, uint32_t longest)
{
    l->seen = l->taken = l->tally.n = 0;
    g_array_set_size(l->late, 0);
    sums_init(&l->sums, &l->tally);
    if (l->cap >= longest)
        return;
    l->cap = longest + longest / 2;
    l->x = g_renew(double, l->x, l->cap);
    l->y = g_renew(double, l->y, l->cap);
}

static void make_lanes(Simulation *s, uint32_t lanes)
{
    while (s->n_lanes < lanes) {
        s->lane = g_renew(Lane *, s->lane, s->n_lanes + 1);
        s->lane[s->n_lanes] = g_aligned_alloc0(1, sizeof(Lane), CACHE_LINES);
        s->lane[s->n_lanes]->late = g_array_new(FALSE, FALSE, sizeof(uint32_t));
        s->lane[s->n_lanes++]->share = 1;
    }
}

/* Each gets as large a share of the units as it took up the last time. */
static void share_out(Simulation *s, uint32_t lanes)
{
    uint32_t n = s->crowds.n_units, first = 0;
    uint64_t all = 0, sum = 0;
    make_lanes(s, lanes);
    for (uint32_t i = 0; i < lanes; i++)
        all += s->lane[i]->share;
    for (uint32_t i = 0; i < lanes; i++) {
        Lane *l = s->lane[i];
        sum += l->share;
        uint32_t last = lanes > 1 && all ? (uint32_t)(sum * n / all) : n;
        atomic_store(&l->free, (uint64_t)last << 32 | first);
        lane_reset(l, s->crowds.longest);
        first = last;
    }
}

/* ---- fast enough? ---- */

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

/* ---- all of it ---- */

/* Sources at which something happens go, or pull after all. */
static void settle_late(Simulation *s, uint32_t lanes, bool pull)
{
    GArray *late = s->lane[0]->late;
    Sums *sums = &s->lane[0]->sums;
    for (uint32_t i = 1; i < lanes; i++)
        if (s->lane[i]->late->len)
            g_array_append_vals(late, s->lane[i]->late->data, s->lane[i]->late->len);
    uint32_t *slot = (uint32_t *)(void *)late->data;
    boxtree_sort(slot, late->len);
    sums_init(sums, &s->lane[0]->tally);
    for (uint32_t i = 0; i < late->len; i++)
        if (!source_remove_reached(s, slot[i]) && pull)
            source_pull(s, slot[i], sums);
    s->n_live += sums->live;
    sums_end(sums);
}

void sources_turn(Simulation *s, bool look, bool remove, bool pull)
{
    bool many = pool_threads(s->pool) > 1 && !are_few(s);
    Turn t = {s, look, remove, pull, !many || s->pace.kind != PACE_SHARED ? 1 : MIN(pool_threads(s->pool), LANES_MOST)};
    gint64 start = many ? g_get_monotonic_time() : 0;
    if (!look || !pull)
        crowds_wake(s, NO_POINT);
    if (look)
        fresh_prepare(s);
    share_out(s, t.lanes);
    pool_for(s->pool, t.lanes, 1, take_lane, &t);
    s->n_live = 0;
    for (uint32_t i = 0; i < t.lanes; i++) {
        s->counts.updates += s->lane[i]->seen;
        s->n_live += s->lane[i]->sums.live;
        if (t.lanes > 1)
            s->lane[i]->share = s->lane[i]->taken;
    }
    settle_late(s, t.lanes, pull);
    if (pull) {
        const Tally *tally[LANES_MOST];
        for (uint32_t i = 0; i < t.lanes; i++)
            tally[i] = &s->lane[i]->tally;
        tallies_join(s, tally, t.lanes);
        s->drawn = true;
    }
    if (many && look)
        pace_note(&s->pace, g_get_monotonic_time() - start, sources_alive(s));
}

void lanes_free(Simulation *s)
{
    for (uint32_t i = 0; i < s->n_lanes; i++) {
        Lane *l = s->lane[i];
        g_free(l->tally.pulled);
        g_array_unref(l->late);
        g_free(l->x);
        g_free(l->y);
        g_aligned_free(l);
    }
    g_free(s->lane);
}
