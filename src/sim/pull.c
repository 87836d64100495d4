/* S(v): who pulls whom (Runions 2005, eq. 1). */
#include <string.h>

#include "sim/pull.h"
#include "sim/state.h"

/* Members that a source apart pulls now. A reached source of a closed pattern waits for its tagged veins alone, and not for those that
 * have arrived. */
static uint8_t pulling(const Simulation *s, uint32_t k)
{
    const Source *src = &s->source[k];
    double kill = kill2(s), past = past2(s);
    uint8_t mask = 0;
    for (uint32_t i = 0; i < src->hood.n; i++) {
        uint8_t bit = (uint8_t)(1u << i);
        double d2 = vec_dist2(s->place[k], s->veins.pos[src->hood.m[i]]);
        if ((src->spent & bit) || d2 <= past)
            continue;
        if ((s->mark[k] & MARK_REACHED) && (!(src->tagged & bit) || d2 < kill))
            continue;
        mask |= bit;
    }
    return mask;
}

/* ---- sums under way ---- */

/* Line i makes way. */
static void sums_put(const Sums *sums, uint32_t i)
{
    if (sums->node[2 * i] == NO_POINT)
        return;
    Pulled *p = tally_entry(sums->tally, sums->node[2 * i]);
    p->sum = vec_add(p->sum, vec2(sums->x[i], sums->y[i]));
    p->count += sums->count[2 * i];
    p->first = MIN(p->first, sums->first[i]);
    p->last = MAX(p->last, sums->last[i]);
}

void sums_init(Sums *sums, Tally *tally)
{
    *sums = (Sums){.node = EIGHT_NODES(NO_POINT), .run_first = UINT32_MAX, .tally = tally};
    memset(sums->line, 0xff, sizeof sums->line); /* NO_POINT */
}

void sums_end(const Sums *sums)
{
    for (uint32_t i = 0; i < 4; i++)
        sums_put(sums, i);
}

/* A line for node v. */
static __attribute__((noinline)) uint32_t sums_turn(Sums *sums, uint32_t v)
{
    uint32_t i = sums->next++ % 4;
    sums_put(sums, i);
    sums->node[2 * i] = sums->node[2 * i + 1] = v;
    sums->count[2 * i] = sums->count[2 * i + 1] = 0;
    sums->line[i] = FOUR_NODES(v);
    sums->x[i] = sums->y[i] = 0.0;
    sums->first[i] = sums->run_first;
    sums->last[i] = sums->run_last;
    return i;
}

/* From now on slots first … last-1 may pull any of those under way. */
static void sums_begin(Sums *sums, uint32_t first, uint32_t last)
{
    sums->run_first = first;
    sums->run_last = last;
    for (uint32_t i = 0; i < 4; i++) {
        sums->first[i] = MIN(sums->first[i], first);
        sums->last[i] = MAX(sums->last[i], last);
    }
}

static inline uint32_t sums_find(const Sums *sums, uint32_t v)
{
    uint32_t i = 0;
    while (i < 4 && sums->node[2 * i] != v)
        i++;
    return i;
}

/* Adds `count` pulls by slots first … last-1, or some of them. */
static void sums_add(Sums *sums, uint32_t v, uint32_t first, uint32_t last, Vec2 pull, uint32_t count)
{
    uint32_t i = sums_find(sums, v);
    if (i == 4)
        i = sums_turn(sums, v);
    sums->x[i] += pull.x;
    sums->y[i] += pull.y;
    sums->count[2 * i] += count;
    sums->count[2 * i + 1] += count;
    sums->first[i] = MIN(sums->first[i], first);
    sums->last[i] = MAX(sums->last[i], last);
}

/* ---- what sources pull ---- */

WIDE void pulls_draw(const Simulation *s, uint32_t first, uint32_t last, const Draw *draw)
{
    if (!draw->x)
        return;
    const Vec2 *place = s->place, *pos = s->veins.pos;
    const uint32_t *near = s->near;
    double *restrict x = draw->x + (first - draw->first), *restrict y = draw->y + (first - draw->first);
    uint32_t k = first;
    for (; k + 4 <= last; k += 4, x += 4, y += 4) {
        Four dx, dy, d2, pull_x, pull_y;
        for (uint32_t l = 0; l < 4; l++) {
            uint32_t v = near[k + l];
            Vec2 towards = vec_sub(place[k + l], pos[v < NEAR_APART ? v : 0]);
            dx[l] = towards.x;
            dy[l] = towards.y;
        }
        memcpy(&d2, s->near2 + k, sizeof d2);
        four_pulls(&dx, &dy, &d2, &pull_x, &pull_y);
        memcpy(x, &pull_x, sizeof pull_x);
        memcpy(y, &pull_y, sizeof pull_y);
    }
    for (; k < last; k++, x++, y++) {
        uint32_t v = near[k];
        Vec2 pull = pull_towards(vec_sub(place[k], pos[v < NEAR_APART ? v : 0]));
        *x = pull.x;
        *y = pull.y;
    }
}

void source_pull(Simulation *s, uint32_t k, Sums *sums)
{
    if (s->mark[k] & MARK_IDLE)
        return;
    if (!source_is_apart(s, k)) {
        uint32_t v = s->near[k];
        if (v == NO_POINT || s->near2[k] <= past2(s))
            return;
        sums_add(sums, v, k, k + 1, pull_towards(vec_sub(s->place[k], s->veins.pos[v])), 1);
        sums->live++;
        return;
    }
    uint8_t mask = pulling(s, k);
    sums->live += mask != 0;
    for (uint8_t i = 0; mask; i++, mask >>= 1)
        if (mask & 1) {
            uint32_t v = s->source[k].hood.m[i];
            sums_add(sums, v, k, k + 1, pull_towards(vec_sub(s->place[k], s->veins.pos[v])), 1);
        }
}

/* ---- crowds ---- */

/* Does one of four slots pull none of the nodes under way? */
static inline __attribute__((always_inline)) bool any_new(const FourNodes *line, FourNodes near)
{
    TwoMask two = (TwoMask) ~((near == line[0]) | (near == line[1]) | (near == line[2]) | (near == line[3]));
    return (two[0] | two[1]) != 0;
}

/* Makes room for all that slots k … k + 3 pull: four lines suffice, the last four that came. */
static __attribute__((noinline)) void sums_make_room(const Simulation *s, Sums *sums, uint32_t k)
{
    for (uint32_t l = 0; l < 4;) {
        uint32_t v = s->near[k + l];
        l++;
        if (sums_find(sums, v) == 4) {
            sums_turn(sums, v);
            l = 0;
        }
    }
}

/* Slots that are not plain, and the last few. */
static __attribute__((noinline)) void sums_add_each(Simulation *s, Sums *sums, uint32_t first, uint32_t last, const Draw *draw, GArray *late)
{
    for (uint32_t k = first; k < last; k++) {
        if (s->mark[k] == 0) {
            sums_add(sums, s->near[k], k, k + 1, vec2(draw->x[k - draw->first], draw->y[k - draw->first]), 1);
            sums->live++;
        } else if (late && source_is_late(s, k)) {
            g_array_append_val(late, k);
        } else {
            source_pull(s, k, sums);
        }
    }
}

/* Slots first … last-1, each with what it pulls. The nothing that pulls of other nodes add to a sum changes no bit. */
static WIDE void sum_run(Simulation *s, Sums *sums, uint32_t first, uint32_t last, const Draw *draw, GArray *late)
{
    const uint8_t *mark = s->mark;
    const uint32_t *near = s->near;
    const double *x = draw->x, *y = draw->y;
    sums_begin(sums, first, last);
    Four sum_x = sums->x, sum_y = sums->y; /* in registers, and in memory where others change them */
    EightNodes node = sums->node, count = sums->count;
    uint32_t live = 0;
    for (uint32_t k = first; k < last; k += 4, x += 4, y += 4) {
        uint32_t marks = 1;
        FourNodes four = {0};
        if (k + 4 <= last) {
            memcpy(&marks, mark + k, sizeof marks);
            memcpy(&four, near + k, sizeof four);
        }
        if (marks || any_new(sums->line, four)) {
            sums->x = sum_x, sums->y = sum_y, sums->count = count;
            if (marks)
                sums_add_each(s, sums, k, MIN(k + 4, last), draw, late);
            else
                sums_make_room(s, sums, k);
            sum_x = sums->x, sum_y = sums->y, node = sums->node, count = sums->count;
            if (marks)
                continue;
        }
        for (uint32_t l = 0; l < 4; l++) {
            EightNodes mine = (EightNodes)(EIGHT_NODES(four[l]) == node);
            sum_x += (Four)((FourMask)FOUR(x[l]) & (FourMask)mine);
            sum_y += (Four)((FourMask)FOUR(y[l]) & (FourMask)mine);
            count -= mine;
        }
        live += 4;
    }
    sums->x = sum_x, sums->y = sum_y, sums->count = count;
    sums->live += live;
}

/* All of them pull one node. */
static void pull_lone(const Simulation *s, Crowd *c, Sums *sums)
{
    Vec2 p = s->veins.pos[c->lone], sum = vec2(0.0, 0.0);
    uint32_t first = UINT32_MAX, last = 0, n = 0;
    c->most2 = -1.0;
    for (uint32_t r = 0; r < CROWD_SIDE; r++) {
        uint32_t count = c->last[r] - c->first[r];
        if (count == 0)
            continue;
        double most2 = lone_sum(s->place + c->first[r], count, p, &sum);
        c->most2 = MAX(c->most2, most2);
        first = MIN(first, c->first[r]);
        last = MAX(last, c->last[r]);
        n += count;
    }
    sums_add(sums, c->lone, first, last, sum, n);
    sums->live += n;
}

void crowd_pull(Simulation *s, Crowd *c, Sums *sums, const Draw *draw, GArray *late)
{
    if (c->lone != NO_POINT) {
        pull_lone(s, c, sums);
        return;
    }
    for (uint32_t r = 0; r < CROWD_SIDE; r++)
        if (c->first[r] < c->last[r])
            sum_run(s, sums, c->first[r], c->last[r], &draw[r], late);
}

bool pulls_next(const Simulation *s, const Pulled *p, uint32_t from, Pull *pull)
{
    for (uint32_t k = from; k < p->last; k++) {
        if (s->near[k] == p->node && !(s->mark[k] & MARK_IDLE) && s->near2[k] > past2(s)) {
            *pull = (Pull){k, 0};
            return true;
        }
        if (s->near[k] != NEAR_APART || (s->mark[k] & MARK_IDLE))
            continue;
        const Hood *h = &s->source[k].hood;
        for (uint8_t i = 0; i < h->n; i++)
            if (h->m[i] == p->node && (pulling(s, k) >> i & 1)) {
                *pull = (Pull){k, i};
                return true;
            }
    }
    return false;
}
