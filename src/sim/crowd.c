/* Sources in crowds, and which of a step's nodes can concern one: from all nodes to those of a square of crowds, from these to those of a
 * crowd. */
#include <string.h>

#include "sim/state.h"

void crowds_clear(Crowds *c)
{
    g_free(c->crowd);
    g_free(c->band);
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
    *crowd = (Crowd){.square = square, .place = box_empty()};
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
    c->n_crowds = c->n_bands = c->longest = 0;
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

/* ---- what they look at ---- */

static int ascending(gconstpointer a, gconstpointer b, gpointer unused)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

/* Fresh nodes that may be nearest to a place in the box, ascending: most of those that are not are gone. More than POINTS_MOST: too many. */
static uint32_t nearest_to(const Simulation *s, Box2 box, double bound2, uint32_t *out)
{
    uint32_t n = boxtree_near(&s->fresh_tree, s->veins.pos, box, bound2, out, POINTS_MOST);
    if (n > POINTS_MOST)
        return n;
    n = points_nearest_to(s->veins.pos, out, n, box, bound2, out);
    g_qsort_with_data(out, (gint)n, sizeof *out, ascending, NULL);
    return n;
}

enum { FEWER = 32 };

static void prepare_some(uint32_t first, uint32_t last, void *user)
{
    const Simulation *s = user;
    const Vec2 *pos = s->veins.pos;
    for (uint32_t i = first; i < last; i++) {
        Square *q = &s->crowds.square[i];
        if (q->plain < FEWER) {
            q->n_nearest = POINTS_MOST + 1; /* each crowd for itself */
            continue;
        }
        q->n_nearest = nearest_to(s, q->place, q->most2, q->nearest);
        q->n_rivals = 0;
        if (s->def.pattern == PATTERN_CLOSED && q->n_nearest && q->n_nearest <= POINTS_MOST)
            q->n_rivals = boxtree_rivals(&s->fresh_tree, pos, q->place, q->nearest, q->n_nearest, s->reach != NULL, q->rival, SQUARE_RIVALS);
    }
}

void crowds_prepare(Simulation *s)
{
    enum { GRAIN = 2 };
    Crowds *c = &s->crowds;
    for (uint32_t i = 0; i < c->n_squares; i++) {
        c->square[i].place = box_empty();
        c->square[i].most2 = -1.0;
        c->square[i].plain = 0;
    }
    for (uint32_t i = 0; i < c->n_crowds; i++) {
        const Crowd *crowd = &c->crowd[i];
        if (crowd->square == NO_POINT || crowd->most2 < 0.0)
            continue;
        Square *q = &c->square[crowd->square];
        q->place = box_union(q->place, crowd->place);
        q->most2 = MAX(q->most2, crowd->most2);
        q->plain += crowd->plain;
    }
    pool_for(s->pool, c->n_squares, GRAIN, prepare_some, s);
}

static void few_fill(Few *few, const Vec2 *pos)
{
    for (uint32_t j = 0; j < few->n; j++) {
        few->x[j] = pos[few->v[j]].x;
        few->y[j] = pos[few->v[j]].y;
    }
}

/* The few of a square as they are, but for those that are too far off. */
static uint32_t those_near(const Vec2 *pos, const Square *q, const Crowd *c, uint32_t *out)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < q->n_nearest; i++)
        if (box_dist2(c->place, pos[q->nearest[i]]) <= c->most2 * (1.0 + 1e-9))
            out[n++] = q->nearest[i];
    return n;
}

bool crowd_sight(const Simulation *s, const Crowd *c, Sight *sight)
{
    const Vec2 *pos = s->veins.pos;
    const Square *q = c->square == NO_POINT ? NULL : &s->crowds.square[c->square];
    Few *nearest = &sight->nearest, *rival = &sight->rival;
    rival->n = 0;
    if (q && q->n_nearest <= 2)
        nearest->n = those_near(pos, q, c, nearest->v);
    else if (q && q->n_nearest <= POINTS_MOST)
        nearest->n = points_nearest_to(pos, q->nearest, q->n_nearest, c->place, c->most2, nearest->v);
    else
        nearest->n = nearest_to(s, c->place, c->most2, nearest->v);
    if (nearest->n > POINTS_MOST)
        return false;
    few_fill(nearest, pos);
    for (uint32_t j = 0; j < nearest->n; j++)
        sight->kin[j] = nearest->v[j];
    if (s->def.pattern == PATTERN_OPEN || nearest->n == 0)
        return true;
    for (uint32_t j = 0; j < nearest->n; j++) {
        uint32_t v = nearest->v[j], parent = s->veins.parent[v];
        sight->stride2[j] = parent == NO_POINT ? HUGE_VAL : vec_dist2(pos[v], pos[parent]);
        sight->kin[j] |= (int64_t)(parent == NO_POINT ? 0 : parent) << 32;
    }
    if (q && q->n_nearest <= POINTS_MOST && q->n_rivals <= SQUARE_RIVALS)
        rival->n = points_rivals(pos, q->rival, q->n_rivals, c->place, nearest->v, nearest->n, s->reach != NULL, rival->v);
    else
        rival->n = boxtree_rivals(&s->fresh_tree, pos, c->place, nearest->v, nearest->n, s->reach != NULL, rival->v, FEW);
    if (rival->n > FEW)
        return false;
    few_fill(rival, pos);
    for (uint32_t j = 0; j < rival->n; j++)
        for (uint32_t i = 0; i < MIN(nearest->n, SIGHT_GUARDS); i++)
            sight->apart2[j][i] = vec_dist2(vec2(nearest->x[i], nearest->y[i]), vec2(rival->x[j], rival->y[j]));
    return true;
}
