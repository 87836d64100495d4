/* Sources look at the vein nodes of a step. Each is on its own, so threads can't change the outcome. */
#include "sim/state.h"

/* ---- one source ---- */

/* Carries the masks over to the new members. A tag is passed by a node to its descendants, not beyond the one that arrived. */
static void carry_masks(const Simulation *s, uint32_t k, const Source *old)
{
    Source *src = &s->source[k];
    src->tagged = src->spent = 0;
    for (uint32_t i = 0; i < src->hood.n; i++)
        for (uint32_t j = 0; j < old->hood.n; j++) {
            uint32_t v = src->hood.m[i], u = old->hood.m[j];
            if (v == u) {
                src->tagged |= (uint8_t)((old->tagged >> j & 1) << i);
                src->spent |= (uint8_t)((old->spent >> j & 1) << i);
            } else if (s->veins.parent[v] == u && vec_dist2(s->place[k], s->veins.pos[u]) >= kill2(s)) {
                src->tagged |= (uint8_t)((old->tagged >> j & 1) << i);
            }
        }
}

/* A zone costs more than a look, so it is worked out when a look was in vain. */
void source_look_closed(Simulation *s, uint32_t k)
{
    source_set_apart(s, k);
    Source *src = &s->source[k], old = *src;
    Eye eye;
    Field f = source_field(s, k, &eye);
    bool relative = s->def.neighbourhood == NEIGHBOURHOOD_RELATIVE;
    bool changed = relative ? hood_update(&src->hood, &f, s->place[k], &s->fresh_tree)
                            : urquhart_update(&src->hood, &s->cell[k], &f, s->place[k], &s->fresh_tree);
    if (!changed) {
        s->mark[k] |= MARK_ZONED;
        s->zone[k] = zone_box(relative ? hood_zone(&src->hood, &f, s->place[k]) : urquhart_zone(&s->cell[k], &f, s->place[k]));
        return;
    }
    if (old.tagged | old.spent)
        carry_masks(s, k, &old);
    s->mark[k] &= (uint8_t)~MARK_ZONED;
    source_weigh(s, k);
}

void source_look_open(Simulation *s, uint32_t k)
{
    Eye eye;
    Field f = source_field(s, k, &eye);
    double before = s->near2[k];
    fresh_nearest(s, &f, s->place[k], &s->near[k], &s->near2[k]);
    if (s->near2[k] == before)
        return;
    s->mark[k] &= (uint8_t)~MARK_IDLE;
    source_weigh(s, k);
}

static void look_alone(Simulation *s, uint32_t k)
{
    if (s->def.pattern == PATTERN_OPEN)
        source_look_open(s, k);
    else
        source_look_closed(s, k);
}

/* ---- those apart ---- */

/* Sources of the crowd that are apart. */
static uint32_t list_apart(const Simulation *s, const Crowd *c, uint32_t *slot, uint32_t cap)
{
    uint32_t n = 0;
    for (uint32_t r = 0; r < CROWD_SIDE; r++)
        for (uint32_t k = c->first[r]; k < c->last[r]; k++)
            if ((s->mark[k] & MARK_APART) && n++ < cap)
                slot[n - 1] = k;
    return n;
}

static bool concerned(const Simulation *s, uint32_t k)
{
    return !(s->mark[k] & MARK_ZONED) || boxtree_any_in(&s->fresh_tree, s->veins.pos, zone_as_box(s->zone[k]));
}

static uint32_t look_each(Simulation *s, const Crowd *c, const uint32_t *slot, uint32_t n, const Draw *draw)
{
    uint32_t seen = 0, r = 0;
    for (uint32_t i = 0; i < n; i++)
        if (concerned(s, slot[i])) {
            source_look_closed(s, slot[i]);
            while (slot[i] >= c->last[r])
                r++;
            pulls_draw(s, slot[i], slot[i] + 1, &draw[r]);
            seen++;
        }
    return seen;
}

/* ---- all of them ---- */

static uint32_t look_all_alone(Simulation *s, const Crowd *c, const Draw *draw)
{
    uint32_t seen = 0;
    for (uint32_t r = 0; r < CROWD_SIDE; r++) {
        for (uint32_t k = c->first[r]; k < c->last[r]; k++)
            if (s->near2[k] >= 0.0) {
                look_alone(s, k);
                seen++;
            }
        pulls_draw(s, c->first[r], c->last[r], &draw[r]);
    }
    return seen;
}

enum { CROWD_LEAST = 4 }; /* fewer are better off alone */

/* Asks for what the crowd's sources are, while it is found out what they look at. */
static void crowd_fetch(const Simulation *s, const Crowd *c)
{
    enum { LINE = 64 };
    for (uint32_t r = 0; r < CROWD_SIDE; r++)
        for (uint32_t k = c->first[r]; k < c->last[r]; k += LINE / sizeof *s->place) {
            __builtin_prefetch(s->place + k);
            __builtin_prefetch(s->near2 + k, 1);
            __builtin_prefetch(s->near + k, 1);
        }
}

/* Those that pull one node each. `parted`: one of a closed pattern may no longer be like that. */
static uint32_t look_together(Simulation *s, Crowd *c, Square *q, Sight *sight, const Draw *draw, bool *parted)
{
    if (c->most2 < 0.0)
        return 0;
    bool open = s->def.pattern == PATTERN_OPEN, lone = c->lone != NO_POINT;
    uint32_t sole = lone ? crowd_sole(s, c, q) : NO_POINT;
    if (sole != NO_POINT && crowd_turns(s, c, sole) && (open || !crowd_has_rivals(s, c, q, sole, sight))) {
        c->lone = sole; /* most2 is renewed as they pull */
        return c->plain;
    }
    if (!lone)
        crowd_fetch(s, c);
    bool few = c->plain >= CROWD_LEAST && crowd_sight(s, c, q, sight);
    crowd_wake(s, c);
    if (open && few && sight->nearest.n == 0) {
        pulls_draw(s, c->first[0], c->last[0], &draw[0]); /* its cells are not in several runs */
        return 0;
    }
    if (!few || sight->nearest.n == 0) {
        if (!open)
            *parted = true;
        return look_all_alone(s, c, draw);
    }
    bool together = sight->nearest.n == 1 && sight->rival.n == 0 && !s->reach && draw[0].x;
    uint32_t seen = 0;
    double most2 = -1.0;
    for (uint32_t r = 0; r < CROWD_SIDE; r++) {
        uint32_t first = c->first[r], last = c->last[r];
        double run2 = open ? look_open_run(s, first, last, sight, &draw[r], &together)
                           : look_closed_run(s, first, last, sight, &draw[r], &together, parted);
        most2 = MAX(most2, run2);
        seen += last - first;
    }
    c->most2 = most2;
    if (together) {
        crowd_measure(s, c);
        crowd_rest(s, c, sight->nearest.v[0]);
    }
    return seen;
}

uint32_t crowd_look(Simulation *s, Crowd *c, Square *q, Sight *sight, const Draw *draw)
{
    enum { SOME = 128 };
    if (s->def.pattern == PATTERN_OPEN)
        return look_together(s, c, q, sight, draw, NULL);
    uint32_t some[SOME], *apart = some, n = 0;
    bool any = c->restless || c->zone.x0 <= c->zone.x1;
    if (any && (c->restless || boxtree_any_in(&s->fresh_tree, s->veins.pos, zone_as_box(c->zone)))) {
        n = list_apart(s, c, some, SOME);
        if (n > SOME)
            list_apart(s, c, apart = g_new(uint32_t, n), n);
    }
    bool parted = false;
    uint32_t seen = look_together(s, c, q, sight, draw, &parted);
    seen += look_each(s, c, apart, n, draw);
    if (apart != some)
        g_free(apart);
    if ((any || parted) && c->lone == NO_POINT)
        crowd_measure(s, c);
    return seen;
}
