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
    FourMask node, count; /* node -1: none */
    Four x, y;
    uint32_t entry[4], next; /* in pulled[]; the one to go next */
} Sums;

static void sums_put(Simulation *s, const Sums *sums, uint32_t i, uint32_t k)
{
    if (sums->node[i] < 0)
        return;
    Pulled *p = &s->pulled[sums->entry[i]];
    p->sum = vec2(sums->x[i], sums->y[i]);
    p->count = (uint32_t)sums->count[i];
    p->last = k;
}

/* Makes room for node v. */
static __attribute__((noinline)) void sums_turn(Simulation *s, Sums *sums, uint32_t v, uint32_t k)
{
    uint32_t i = sums->next++ % 4;
    sums_put(s, sums, i, k);
    sums->entry[i] = pulled_entry(s, v, k);
    const Pulled *p = &s->pulled[sums->entry[i]];
    sums->node[i] = v;
    sums->count[i] = p->count;
    sums->x[i] = p->sum.x;
    sums->y[i] = p->sum.y;
}

static void sums_add(Simulation *s, Sums *sums, uint32_t v, uint32_t k, double x, double y)
{
    FourMask mine = sums->node == (FourMask){v, v, v, v};
    if (!FOUR_ANY(mine)) {
        sums_turn(s, sums, v, k);
        mine = sums->node == (FourMask){v, v, v, v};
    }
    sums->x += (Four)((FourMask)FOUR(x) & mine);
    sums->y += (Four)((FourMask)FOUR(y) & mine);
    sums->count -= mine;
}

FOUR_WIDE void pulls_draw(const Simulation *s, uint32_t first, uint32_t last, double *restrict x, double *restrict y)
{
    enum { SOME = 64 };
    double d2[SOME];
    for (; first < last; first += SOME, x += SOME, y += SOME) {
        gsize n = MIN(SOME, last - first);
        const Vec2 *place = s->place + first, *pos = s->veins.pos;
        const uint32_t *near = s->near + first;
        for (gsize i = 0; i < n; i++) {
            Vec2 towards = vec_sub(place[i], pos[near[i] < NEAR_APART ? near[i] : 0]);
            x[i] = towards.x;
            y[i] = towards.y;
        }
        memcpy(d2, s->near2 + first, sizeof *d2 * n);
        for (gsize i = 0; i < n; i++)
            d2[i] = 1.0 / sqrt(d2[i]);
        for (gsize i = 0; i < n; i++) {
            x[i] *= d2[i];
            y[i] *= d2[i];
        }
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
        s->n_live++;
        return;
    }
    uint8_t mask = pulling(s, k);
    s->n_live += mask != 0;
    for (uint8_t i = 0; mask; i++, mask >>= 1)
        if (mask & 1) {
            uint32_t v = s->source[k].hood.m[i];
            Vec2 towards = vec_sub(s->place[k], s->veins.pos[v]);
            towards = vec_scale(towards, 1.0 / sqrt(vec_norm2(towards)));
            sums_add(s, sums, v, k, towards.x, towards.y);
        }
}

FOUR_WIDE void pulls_sum(Simulation *s, uint32_t first, uint32_t last, bool remove, const double *x, const double *y)
{
    const uint8_t *mark = s->mark;
    const uint32_t *near = s->near;
    uint32_t live = 0;
    Sums sums = {.node = {-1, -1, -1, -1}};
    FourMask node = sums.node, count = sums.count;
    Four sum_x = sums.x, sum_y = sums.y; /* in registers, and in memory where others change them */
    for (uint32_t k = first; k < last; k++, x++, y++) {
        bool apart = mark[k] != 0;
        FourMask v = {near[k], near[k], near[k], near[k]}, mine = node == v;
        if (apart || !FOUR_ANY(mine)) {
            sums.count = count, sums.x = sum_x, sums.y = sum_y;
            if (apart && (!remove || !source_remove_reached(s, k)))
                pull_apart(s, &sums, k, *x, *y);
            else if (!apart)
                sums_turn(s, &sums, near[k], k);
            node = sums.node, count = sums.count, sum_x = sums.x, sum_y = sums.y;
            if (apart)
                continue;
            mine = node == v;
        }
        sum_x += (Four)((FourMask)FOUR(*x) & mine);
        sum_y += (Four)((FourMask)FOUR(*y) & mine);
        count -= mine;
        live++;
    }
    sums.count = count, sums.x = sum_x, sums.y = sum_y;
    for (uint32_t i = 0; i < 4; i++)
        sums_put(s, &sums, i, last - 1);
    s->n_live += live;
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
