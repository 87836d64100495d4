/* S(v): who pulls whom (Runions 2005, eq. 1). */
#include <string.h>

#include "geom/vectors.h"
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

/* The entry of node v, which slot k is the next to pull. */
static uint32_t pulled_entry(Simulation *s, uint32_t v, uint32_t k)
{
    uint32_t i = s->veins.pull[v];
    if (i < s->n_pulled && s->pulled[i].node == v)
        return i;
    if (s->n_pulled == s->cap_pulled) {
        s->cap_pulled = MAX(s->cap_pulled * 2, 1024);
        s->pulled = g_renew(Pulled, s->pulled, s->cap_pulled);
    }
    s->pulled[s->n_pulled] = (Pulled){.node = v, .first = k};
    return s->veins.pull[v] = s->n_pulled++;
}

/* The sums of four nodes under way: sources beside each other mostly pull the same few. Each sum is that of its pulls one after the other,
 * in the order of the slots; the nothing that other pulls add to it changes no bit. */
typedef struct {
    Four x, y;
    EightNodes node, count; /* in two halves of a lane of x each; node NO_POINT: none */
    FourNodes line[4];      /* node i, to compare four slots with */
    uint32_t entry[4], next; /* in pulled[]; the one to go next */
    uint32_t live;           /* sources that pull */
} Sums;

static void sums_put(Simulation *s, const Sums *sums, uint32_t i, uint32_t k)
{
    if (sums->node[2 * i] == NO_POINT)
        return;
    Pulled *p = &s->pulled[sums->entry[i]];
    p->sum = vec2(sums->x[i], sums->y[i]);
    p->count = sums->count[2 * i];
    p->last = k;
}

/* Makes room for node v. */
static __attribute__((noinline)) void sums_turn(Simulation *s, Sums *sums, uint32_t v, uint32_t k)
{
    uint32_t i = sums->next++ % 4;
    sums_put(s, sums, i, k);
    sums->entry[i] = pulled_entry(s, v, k);
    const Pulled *p = &s->pulled[sums->entry[i]];
    sums->node[2 * i] = sums->node[2 * i + 1] = v;
    sums->line[i] = (FourNodes){v, v, v, v};
    sums->count[2 * i] = sums->count[2 * i + 1] = p->count;
    sums->x[i] = p->sum.x;
    sums->y[i] = p->sum.y;
}

/* Where node v is; 4: nowhere. */
static inline uint32_t sums_find(const Sums *sums, uint32_t v)
{
    uint32_t i = 0;
    while (i < 4 && sums->node[2 * i] != v)
        i++;
    return i;
}

static void sums_add(Simulation *s, Sums *sums, uint32_t v, uint32_t k, double x, double y)
{
    uint32_t i = sums_find(sums, v);
    if (i == 4) {
        i = sums->next % 4;
        sums_turn(s, sums, v, k);
    }
    sums->x[i] += x;
    sums->y[i] += y;
    sums->count[2 * i]++;
    sums->count[2 * i + 1]++;
}

WIDE void pulls_draw(const Simulation *s, uint32_t first, uint32_t last, const Draw *draw)
{
    if (!draw->x)
        return;
    const Vec2 *place = s->place, *pos = s->veins.pos;
    const uint32_t *near = s->near;
    const double *near2 = s->near2;
    double *restrict x = draw->x + (first - draw->first), *restrict y = draw->y + (first - draw->first);
    uint32_t k = first;
    for (; k + 4 <= last; k += 4, x += 4, y += 4) {
        Four dx, dy, d2;
        for (uint32_t l = 0; l < 4; l++) {
            uint32_t v = near[k + l];
            Vec2 towards = vec_sub(place[k + l], pos[v < NEAR_APART ? v : 0]);
            dx[l] = towards.x;
            dy[l] = towards.y;
        }
        memcpy(&d2, near2 + k, sizeof d2);
        four_inverse_root(&d2, &d2);
        dx *= d2;
        dy *= d2;
        memcpy(x, &dx, sizeof dx);
        memcpy(y, &dy, sizeof dy);
    }
    for (; k < last; k++, x++, y++) {
        uint32_t v = near[k];
        Vec2 towards = vec_sub(place[k], pos[v < NEAR_APART ? v : 0]);
        double scale = 1.0 / sqrt(near2[k]);
        *x = towards.x * scale;
        *y = towards.y * scale;
    }
}

/* Pulls of a source that is not plain. */
static void pull_apart(Simulation *s, Sums *sums, uint32_t k, double x, double y)
{
    if (s->mark[k] & MARK_IDLE)
        return;
    if (!source_is_apart(s, k)) {
        if (s->near[k] == NO_POINT || s->near2[k] <= past2(s))
            return;
        sums_add(s, sums, s->near[k], k, x, y);
        sums->live++;
        return;
    }
    uint8_t mask = pulling(s, k);
    sums->live += mask != 0;
    for (uint8_t i = 0; mask; i++, mask >>= 1)
        if (mask & 1) {
            uint32_t v = s->source[k].hood.m[i];
            Vec2 towards = vec_sub(s->place[k], s->veins.pos[v]);
            towards = vec_scale(towards, 1.0 / sqrt(vec_norm2(towards)));
            sums_add(s, sums, v, k, towards.x, towards.y);
        }
}

/* Does one of four slots pull none of the nodes under way? */
static inline __attribute__((always_inline)) bool any_new(const Sums *sums, FourNodes near)
{
    const FourNodes *n = sums->line;
    TwoMask two = (TwoMask) ~((near == n[0]) | (near == n[1]) | (near == n[2]) | (near == n[3]));
    return (two[0] | two[1]) != 0;
}

/* Makes room for all that slots k … k + 3 pull: four lines suffice, the last four that came. */
static __attribute__((noinline)) void sums_make_room(Simulation *s, Sums *sums, uint32_t k)
{
    for (uint32_t l = 0; l < 4;) {
        uint32_t v = s->near[k + l];
        l++;
        if (sums_find(sums, v) == 4) {
            sums_turn(s, sums, v, k);
            l = 0;
        }
    }
}

/* Slots that are not plain, and the last few. */
static __attribute__((noinline)) void sums_add_each(Simulation *s, Sums *sums, uint32_t first, uint32_t last, bool remove, const double *x,
                                                    const double *y)
{
    for (uint32_t k = first; k < last; k++, x++, y++) {
        if (s->mark[k] == 0) {
            sums_add(s, sums, s->near[k], k, *x, *y);
            sums->live++;
        } else if (!remove || !source_remove_reached(s, k)) {
            pull_apart(s, sums, k, *x, *y);
        }
    }
}

/* Slots first … last-1, each with what it pulls; x and y are those of the band. */
static WIDE void sum_run(Simulation *s, Sums *sums, uint32_t first, uint32_t last, bool remove, const double *x, const double *y)
{
    const uint8_t *mark = s->mark;
    const uint32_t *near = s->near;
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
        if (marks || any_new(sums, four)) {
            sums->x = sum_x, sums->y = sum_y, sums->count = count;
            if (marks)
                sums_add_each(s, sums, k, MIN(k + 4, last), remove, x, y);
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

/* Those of a crowd that pull one node, from slot first to last - 1. */
static void sum_lone(Simulation *s, Sums *sums, Crowd *crowd, uint32_t first, uint32_t last, const double *x, const double *y)
{
    uint32_t v = crowd->lone, i = sums_find(sums, v), n = last - first;
    if (i == 4) {
        i = sums->next % 4;
        sums_turn(s, sums, v, first);
    }
    Vec2 sum = vec2(sums->x[i], sums->y[i]);
    if (crowd->undrawn)
        crowd->most2 = lone_sum(s->place + first, n, s->veins.pos[v], &sum, crowd->most2);
    for (uint32_t k = 0; k < n && !crowd->undrawn; k++) {
        sum.x += x[k];
        sum.y += y[k];
    }
    sums->x[i] = sum.x;
    sums->y[i] = sum.y;
    sums->count[2 * i] += n;
    sums->count[2 * i + 1] += n;
    sums->live += n;
}

void pulls_sum(Simulation *s, const Band *band, bool remove, const double *x, const double *y)
{
    Crowd *crowd = s->crowds.crowd;
    Sums sums = {.node = EIGHT_NODES(NO_POINT)};
    uint32_t done = band->first;
    memset(sums.line, 0xff, sizeof sums.line); /* NO_POINT */
    for (uint32_t r = 0; r < CROWD_SIDE; r++) /* that is the order of the slots */
        for (uint32_t c = band->first_crowd; c < band->last_crowd; c++) {
            uint32_t first = crowd[c].first[r], last = crowd[c].last[r];
            if (crowd[c].lone == NO_POINT || first == last)
                continue;
            sum_run(s, &sums, done, first, remove, x + (done - band->first), y + (done - band->first));
            sum_lone(s, &sums, &crowd[c], first, last, x + (first - band->first), y + (first - band->first));
            done = last;
        }
    sum_run(s, &sums, done, band->last, remove, x + (done - band->first), y + (done - band->first));
    for (uint32_t i = 0; i < 4; i++)
        sums_put(s, &sums, i, band->last - 1);
    for (uint32_t c = band->first_crowd; c < band->last_crowd; c++)
        crowd[c].undrawn = false;
    s->n_live += sums.live;
}

bool pulls_next(const Simulation *s, const Pulled *p, uint32_t from, Pull *pull)
{
    for (uint32_t k = from; k <= p->last; k++) {
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
