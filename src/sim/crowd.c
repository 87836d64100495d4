/* Sources in crowds. */
#include <string.h>

#include "sim/state.h"

void crowds_clear(Crowds *c)
{
    g_free(c->crowd);
    g_free(c->band);
    g_free(c->group);
    g_free(c->square);
    *c = (Crowds){0};
}

/* ---- making them ---- */

static Crowd *new_crowd(Crowds *c, uint32_t square)
{
    if (c->n_crowds == c->cap_crowds) {
        c->cap_crowds = MAX(c->cap_crowds * 2, 64);
        c->crowd = g_renew(Crowd, c->crowd, c->cap_crowds);
    }
    Crowd *crowd = &c->crowd[c->n_crowds++];
    *crowd = (Crowd){.square = square, .place = box_empty(), .lone = NO_POINT};
    return crowd;
}

static void add_band(Crowds *c, uint32_t first, uint32_t last, uint32_t first_crowd)
{
    if (first == last)
        return;
    if (c->n_bands == c->cap_bands) {
        c->cap_bands = MAX(c->cap_bands * 2, 64);
        c->band = g_renew(Band, c->band, c->cap_bands);
    }
    c->band[c->n_bands++] = (Band){first, last, first_crowd, c->n_crowds};
    c->longest = MAX(c->longest, last - first);
}

/* Of the bands from first_band on. */
static void add_group(Crowds *c, uint32_t first_band, uint32_t first_square, uint32_t last_square)
{
    if (first_band == c->n_bands)
        return;
    if (c->n_groups == c->cap_groups) {
        c->cap_groups = MAX(c->cap_groups * 2, 64);
        c->group = g_renew(Group, c->group, c->cap_groups);
    }
    c->group[c->n_groups++] = (Group){first_band, c->n_bands, first_square, last_square};
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

/* An open pattern's cells are as large as 4 x 4 of a closed one. */
void crowds_build(Simulation *s, const uint32_t *start)
{
    Crowds *c = &s->crowds;
    uint32_t side = s->def.pattern == PATTERN_OPEN ? 1 : CROWD_SIDE, nx = s->grid.nx, ny = s->grid.ny;
    uint32_t sx = nx / (side * CROWD_SIDE) + 1, sy = ny / (side * CROWD_SIDE) + 1;
    c->n_crowds = c->n_bands = c->n_groups = c->longest = 0;
    uint32_t first_band = 0;
    c->n_slots = s->n_sources;
    if (c->n_squares != sx * sy) {
        c->n_squares = sx * sy;
        c->square = g_renew(Square, c->square, c->n_squares);
    }
    for (uint32_t y = 0; y < ny; y += side) {
        uint32_t first_crowd = c->n_crowds, yn = MIN(y + side, ny);
        for (uint32_t x = 0; x < nx; x += side) {
            uint32_t n = 0;
            Crowd crowd = {0};
            for (uint32_t r = 0; y + r < yn; r++) {
                const uint32_t *row = start + (gsize)(y + r) * nx;
                crowd.first[r] = row[x];
                crowd.last[r] = row[MIN(x + side, nx)];
                n += crowd.last[r] - crowd.first[r];
            }
            if (n == 0)
                continue;
            Crowd *new = new_crowd(c, y / (side * CROWD_SIDE) * sx + x / (side * CROWD_SIDE));
            memcpy(new->first, crowd.first, sizeof crowd.first);
            memcpy(new->last, crowd.last, sizeof crowd.last);
            crowd_place(s, new);
        }
        add_band(c, start[(gsize)y * nx], start[(gsize)yn * nx], first_crowd);
        uint32_t row = y / (side * CROWD_SIDE);
        if (yn == ny || yn % (side * CROWD_SIDE) == 0) {
            add_group(c, first_band, row * sx, (row + 1) * sx);
            first_band = c->n_bands;
        }
    }
}

void crowds_add(Simulation *s)
{
    enum { NEWCOMERS = 32, BAND = 256 };
    Crowds *c = &s->crowds;
    while (c->n_slots < s->n_sources) {
        uint32_t first = c->n_slots, last = MIN(first + BAND, s->n_sources), first_crowd = c->n_crowds;
        for (uint32_t k = first; k < last; k += NEWCOMERS) {
            Crowd *crowd = new_crowd(c, NO_POINT);
            crowd->first[0] = k;
            crowd->last[0] = MIN(k + NEWCOMERS, last);
            crowd_place(s, crowd);
        }
        add_band(c, first, last, first_crowd);
        add_group(c, c->n_bands - 1, 0, 0);
        c->n_slots = last;
    }
}

void crowd_part(Simulation *s, uint32_t k)
{
    const Crowds *c = &s->crowds;
    source_set_apart(s, k);
    uint32_t b = 0;
    while (k >= c->band[b].last)
        b++;
    for (uint32_t i = c->band[b].first_crowd;; i++) {
        Crowd *crowd = &c->crowd[i];
        for (uint32_t r = 0; r < CROWD_SIDE; r++)
            if (k >= crowd->first[r] && k < crowd->last[r]) {
                crowd->restless = true;
                return;
            }
    }
}
