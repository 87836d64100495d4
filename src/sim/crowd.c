/* Sources in crowds. */
#include <string.h>

#include "sim/state.h"

void crowds_clear(Crowds *c)
{
    g_free(c->crowd);
    g_free(c->unit);
    *c = (Crowds){0};
}

/* ---- making them ---- */

static Crowd *new_crowd(Crowds *c)
{
    if (c->n_crowds == c->cap_crowds) {
        c->cap_crowds = MAX(c->cap_crowds * 2, 64);
        c->crowd = g_renew(Crowd, c->crowd, c->cap_crowds);
    }
    Crowd *crowd = &c->crowd[c->n_crowds++];
    *crowd = (Crowd){.place = box_empty(), .lone = NO_POINT};
    return crowd;
}

/* Of the crowds from first_crowd on. */
static void add_unit(Crowds *c, uint32_t first_crowd, bool square)
{
    if (first_crowd == c->n_crowds)
        return;
    if (c->n_units == c->cap_units) {
        c->cap_units = MAX(c->cap_units * 2, 64);
        c->unit = g_renew(Unit, c->unit, c->cap_units);
    }
    c->unit[c->n_units++] = (Unit){first_crowd, c->n_crowds, square};
}

void crowd_measure(const Simulation *s, Crowd *crowd)
{
    crowd->most2 = -1.0;
    crowd->zone = zone_empty();
    crowd->restless = false;
    crowd->plain = 0;
    for (uint32_t r = 0; r < CROWD_SIDE; r++)
        for (uint32_t k = crowd->first[r]; k < crowd->last[r]; k++) {
            crowd->most2 = MAX(crowd->most2, s->near2[k]);
            crowd->plain += s->near2[k] >= 0.0;
            if (!source_is_apart(s, k))
                continue;
            if (s->mark[k] & MARK_ZONED)
                crowd->zone = zone_join(crowd->zone, s->zone[k]);
            else
                crowd->restless = true;
        }
}

static void crowd_place(const Simulation *s, Crowd *crowd)
{
    for (uint32_t r = 0; r < CROWD_SIDE; r++)
        for (uint32_t k = crowd->first[r]; k < crowd->last[r]; k++)
            crowd->place = box_add(crowd->place, s->place[k]);
    crowd_measure(s, crowd);
}

/* That of the cells from x, y on, `side` of them each way. start: as in crowds_build. */
static void add_crowd(Simulation *s, const uint32_t *start, uint32_t x, uint32_t y, uint32_t side)
{
    uint32_t nx = s->grid.nx, xn = MIN(x + side, nx), yn = MIN(y + side, s->grid.ny), n = 0;
    Crowd crowd = {.place = box_empty(), .lone = NO_POINT};
    for (uint32_t r = 0; y + r < yn; r++) {
        const uint32_t *row = start + (gsize)(y + r) * nx;
        crowd.first[r] = row[x];
        crowd.last[r] = row[xn];
        n += crowd.last[r] - crowd.first[r];
    }
    if (n == 0)
        return;
    Crowd *new = new_crowd(&s->crowds);
    *new = crowd;
    crowd_place(s, new);
    s->crowds.longest = MAX(s->crowds.longest, n);
}

/* An open pattern's cells are as large as 4 x 4 of a closed one. */
void crowds_build(Simulation *s, const uint32_t *start)
{
    Crowds *c = &s->crowds;
    uint32_t side = s->def.pattern == PATTERN_OPEN ? 1 : CROWD_SIDE, square = CROWD_SIDE * side, nx = s->grid.nx, ny = s->grid.ny;
    c->n_crowds = c->n_units = c->longest = 0;
    c->n_slots = s->n_sources;
    for (uint32_t y0 = 0; y0 < ny; y0 += square)
        for (uint32_t x0 = 0; x0 < nx; x0 += square) {
            uint32_t first_crowd = c->n_crowds;
            for (uint32_t y = y0; y < MIN(y0 + square, ny); y += side)
                for (uint32_t x = x0; x < MIN(x0 + square, nx); x += side)
                    add_crowd(s, start, x, y, side);
            add_unit(c, first_crowd, true);
        }
}

void crowds_add(Simulation *s)
{
    enum { NEWCOMERS = 32, UNIT = 256 };
    Crowds *c = &s->crowds;
    c->longest = MAX(c->longest, NEWCOMERS);
    while (c->n_slots < s->n_sources) {
        uint32_t first = c->n_slots, last = MIN(first + UNIT, s->n_sources), first_crowd = c->n_crowds;
        for (uint32_t k = first; k < last; k += NEWCOMERS) {
            Crowd *crowd = new_crowd(c);
            crowd->first[0] = k;
            crowd->last[0] = MIN(k + NEWCOMERS, last);
            crowd_place(s, crowd);
        }
        add_unit(c, first_crowd, false);
        c->n_slots = last;
    }
}

void crowd_part(Simulation *s, uint32_t k)
{
    source_set_apart(s, k);
    for (Crowd *c = s->crowds.crowd;; c++)
        for (uint32_t r = 0; r < CROWD_SIDE; r++)
            if (k >= c->first[r] && k < c->last[r]) {
                c->restless = true;
                return;
            }
}
