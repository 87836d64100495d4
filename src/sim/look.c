/* Sources look at the vein nodes of a step. Each is on its own, so threads can't change the outcome. */
#include <string.h>

#include "geom/vectors.h"
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
static void look_closed(Simulation *s, uint32_t k)
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

static void look_open(Simulation *s, uint32_t k)
{
    Eye eye;
    Field f = source_field(s, k, &eye);
    double before = s->near2[k];
    boxtree_nearest(&s->fresh_tree, s->veins.pos, s->place[k], f.sees, f.user, &s->near[k], &s->near2[k]);
    if (s->near2[k] == before)
        return;
    s->mark[k] &= (uint8_t)~MARK_IDLE;
    source_weigh(s, k);
}

static void look_alone(Simulation *s, uint32_t k)
{
    if (s->def.pattern == PATTERN_OPEN)
        look_open(s, k);
    else
        look_closed(s, k);
}

/* ---- a crowd ---- */

/* Four sources, and the nearest of the few as each of them sees it. */
typedef struct {
    Four x, y;
    Four near2, d2;   /* before and now; -1: not plain, so nearer than anything to its node */
    FourMask kin;     /* of the new nearest node (Sight); -1: none is nearer than the node that it has */
    FourMask old;     /* the node that it has */
    Four stride2;     /* closed: as in Sight */
} Block;

/* Of equally near nodes the smallest, and the one before over all. With n < 4 the last ones are nothing. */
static inline __attribute__((always_inline)) void block_look(const Simulation *s, uint32_t k, uint32_t n, const Sight *sight, bool open, Block *b)
{
    const Few *few = &sight->nearest;
    if (n == 4) {
        Four low, high;
        FourNodes near;
        memcpy(&low, s->place + k, sizeof low);
        memcpy(&high, s->place + k + 2, sizeof high);
        memcpy(&b->near2, s->near2 + k, sizeof b->near2);
        memcpy(&near, s->near + k, sizeof near);
        b->x = __builtin_shufflevector(low, high, 0, 2, 4, 6);
        b->y = __builtin_shufflevector(low, high, 1, 3, 5, 7);
        b->old = __builtin_convertvector(near, FourMask);
    } else {
        for (uint32_t l = 0; l < 4; l++) {
            uint32_t i = l < n ? k + l : k;
            b->x[l] = s->place[i].x;
            b->y[l] = s->place[i].y;
            b->near2[l] = l < n ? s->near2[i] : -1.0;
            b->old[l] = s->near[i];
        }
    }
    Four px = b->x, py = b->y, least = b->near2, stride2 = FOUR(0.0);
    FourMask kin = {-1, -1, -1, -1};
    for (uint32_t j = 0; j < few->n; j++) {
        Four dx = px - FOUR(few->x[j]), dy = py - FOUR(few->y[j]), e2 = dx * dx + dy * dy;
        FourMask nearer = e2 < least, mine = FOUR_MASK(sight->kin[j]);
        least = FOUR_PICK(nearer, e2, least);
        kin = (mine & nearer) | (kin & ~nearer);
        if (!open)
            stride2 = FOUR_PICK(nearer, FOUR(sight->stride2[j]), stride2);
    }
    b->d2 = least;
    b->kin = kin;
    b->stride2 = stride2;
}

/* Turns those in the mask to their new nodes. */
static inline __attribute__((always_inline)) void block_move(Simulation *s, uint32_t k, uint32_t n, const Block *b, const FourMask *moved)
{
    FourNodes near = __builtin_convertvector((b->kin & *moved) | (b->old & ~*moved), FourNodes);
    if (n == 4) {
        memcpy(s->near + k, &near, sizeof near);
        memcpy(s->near2 + k, &b->d2, sizeof b->d2);
        return;
    }
    for (uint32_t l = 0; l < n; l++) {
        s->near[k + l] = near[l];
        s->near2[k + l] = b->d2[l];
    }
}

static inline double four_most(const Four *v) { return MAX(MAX((*v)[0], (*v)[1]), MAX((*v)[2], (*v)[3])); }

/* ---- a crowd of an open pattern ---- */

/* When the source can't see the node it looks for itself. */
static void show_open(Simulation *s, uint32_t k, uint32_t v, double d2, double within2)
{
    if (s->reach && !source_sees(s, k, v)) {
        look_open(s, k);
        return;
    }
    s->near[k] = v;
    s->near2[k] = d2;
    s->mark[k] = d2 < within2 ? MARK_WITHIN : 0;
}

/* Has one of n sources a mark? */
static inline __attribute__((always_inline)) bool any_marked(const Simulation *s, uint32_t k, uint32_t n)
{
    uint32_t marks = 0;
    memcpy(&marks, s->mark + k, n == 4 ? 4 : n);
    return marks != 0;
}

static inline __attribute__((always_inline)) void show_block_open(Simulation *s, uint32_t k, uint32_t n, const Sight *sight, double within2,
                                                                  Four *most2)
{
    Block b;
    block_look(s, k, n, sight, true, &b);
    FourMask moved = b.kin >= FOUR_MASK(0), within = (b.d2 < FOUR(within2)) & moved;
    if (!s->reach && !FOUR_ANY(within) && !any_marked(s, k, n)) {
        block_move(s, k, n, &b, &moved);
    } else {
        for (uint32_t l = 0; l < n; l++) {
            if (moved[l])
                show_open(s, k + l, (uint32_t)b.kin[l], b.d2[l], within2);
            b.d2[l] = s->near2[k + l]; /* that of a node it sees */
        }
    }
    *most2 = FOUR_PICK(b.d2 > *most2, b.d2, *most2);
}

static FOUR_WIDE double look_open_run(Simulation *s, uint32_t first, uint32_t last, const Sight *sight)
{
    double within2 = MAX(kill2(s), past2(s));
    Four most2 = FOUR(-1.0);
    uint32_t k = first;
    for (; k + 4 <= last; k += 4)
        show_block_open(s, k, 4, sight, within2, &most2);
    if (k < last)
        show_block_open(s, k, last - k, sight, within2, &most2);
    return four_most(&most2);
}

/* ---- a crowd of a closed pattern ---- */

/* Is a node at x excluded from the neighbourhood of k by the one at u, which is another? */
static bool excludes_node(const Simulation *s, uint32_t k, uint32_t node, Vec2 u, Vec2 x, double d2)
{
    return vec_dist2(s->place[k], u) < d2 && vec_dist2(u, x) <= d2 && (!s->reach || source_sees(s, k, node));
}

/* The same by one of the few, or by a witness. */
static bool excluded(const Simulation *s, uint32_t k, Vec2 x, const Few *few)
{
    const Hood *h = &s->source[k].hood;
    double d2 = vec_dist2(s->place[k], x);
    for (uint32_t j = 0; j < few->n; j++)
        if (excludes_node(s, k, few->v[j], vec2(few->x[j], few->y[j]), x, d2))
            return true;
    for (uint32_t j = 0; j < h->n_witnesses; j++)
        if (excludes_node(s, k, h->w[j], s->veins.pos[h->w[j]], x, d2))
            return true;
    return false;
}

/* Node v, which is nearer to k than any other, does not exclude all rivals. Do others? */
static bool all_excluded(const Simulation *s, uint32_t k, uint32_t v, const Sight *sight)
{
    Vec2 p = s->place[k], u = s->veins.pos[v];
    for (uint32_t j = 0; j < sight->rival.n; j++) {
        Vec2 x = vec2(sight->rival.x[j], sight->rival.y[j]);
        if (vec_dist2(u, x) > vec_dist2(p, x) && !excluded(s, k, x, &sight->nearest))
            return false;
    }
    return true;
}

/* Moves one source to its new nearest node, which excludes the old one. FALSE when it must look for itself: when it can't see the node, or
 * when that may not be all its neighbourhood by now. */
static bool show_closed(Simulation *s, uint32_t k, uint32_t v, double d2, bool alone, const Sight *sight)
{
    if ((!alone && !all_excluded(s, k, v, sight)) || (s->reach && !source_sees(s, k, v)))
        return false;
    s->near[k] = v;
    s->near2[k] = d2;
    if (d2 < MAX(kill2(s), past2(s))) {
        source_set_apart(s, k);
        s->mark[k] |= MARK_WITHIN;
    }
    return true;
}

/* For which of them are there rivals that neither the new nearest node nor another of the first few excludes? */
static inline __attribute__((always_inline)) void block_rivals(const Simulation *s, const Block *b, const Sight *sight, const FourMask *plain,
                                                               FourMask *more)
{
    const Few *few = &sight->nearest, *rival = &sight->rival;
    uint32_t n = s->reach ? 0 : MIN(few->n, SIGHT_GUARDS);
    Four vx, vy, e2[SIGHT_GUARDS];
    for (uint32_t l = 0; l < 4; l++) {
        Vec2 v = b->kin[l] < 0 ? vec2(0.0, 0.0) : s->veins.pos[(uint32_t)b->kin[l]];
        vx[l] = v.x;
        vy[l] = v.y;
    }
    for (uint32_t i = 0; i < n; i++) {
        Four dx = FOUR(few->x[i]) - b->x, dy = FOUR(few->y[i]) - b->y;
        e2[i] = dx * dx + dy * dy;
    }
    for (uint32_t j = 0; j < rival->n; j++) {
        Four rx = FOUR(rival->x[j]), ry = FOUR(rival->y[j]), d2 = (rx - b->x) * (rx - b->x) + (ry - b->y) * (ry - b->y);
        FourMask open = ((rx - vx) * (rx - vx) + (ry - vy) * (ry - vy) > d2) & *plain;
        if (!FOUR_ANY(open))
            continue;
        const double *apart2 = sight->apart2[j];
        for (uint32_t i = 0; i < n; i++)
            open &= ~((e2[i] < d2) & (FOUR(apart2[i]) <= d2));
        *more |= open;
    }
}

/* One source of a block that did not move on as a whole. */
static void show_one_closed(Simulation *s, uint32_t k, int64_t kin, double d2, bool child, bool alone, const Sight *sight)
{
    uint32_t v = (uint32_t)kin;
    bool stays = kin >= 0 && !child && vec_dist2(s->veins.pos[v], s->veins.pos[s->near[k]]) > s->near2[k];
    if (kin < 0 || stays || !show_closed(s, k, v, d2, alone, sight))
        look_closed(s, k);
}

/* Most often all that are plain turn to new nodes and stay plain: the new node is a child of the old one and near by, and so excludes it. */
static inline __attribute__((always_inline)) void show_block_closed(Simulation *s, uint32_t k, uint32_t n, const Sight *sight, double within2,
                                                                    bool *parted, Four *most2)
{
    Block b;
    block_look(s, k, n, sight, false, &b);
    FourMask plain = b.near2 >= FOUR(0.0), child = ((b.kin >> 32) == b.old) & (b.stride2 <= b.near2), more = FOUR_MASK(0);
    if (sight->rival.n)
        block_rivals(s, &b, sight, &plain, &more);
    FourMask trouble = (~child | (b.d2 < FOUR(within2)) | more) & plain;
    if (!s->reach && !FOUR_ANY(trouble)) {
        block_move(s, k, n, &b, &plain);
    } else {
        for (uint32_t l = 0; l < n; l++) {
            if (!plain[l])
                continue;
            show_one_closed(s, k + l, b.kin[l], b.d2[l], child[l], !more[l], sight);
            *parted |= (s->mark[k + l] & MARK_APART) != 0;
            b.d2[l] = s->near2[k + l];
        }
    }
    *most2 = FOUR_PICK(b.d2 > *most2, b.d2, *most2);
}

static FOUR_WIDE double look_closed_run(Simulation *s, uint32_t first, uint32_t last, const Sight *sight, bool *parted)
{
    double within2 = MAX(kill2(s), past2(s));
    Four most2 = FOUR(-1.0);
    uint32_t k = first;
    for (; k + 4 <= last; k += 4)
        show_block_closed(s, k, 4, sight, within2, parted, &most2);
    if (k < last)
        show_block_closed(s, k, last - k, sight, within2, parted, &most2);
    return four_most(&most2);
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

static uint32_t look_each(Simulation *s, const uint32_t *slot, uint32_t n)
{
    uint32_t seen = 0;
    for (uint32_t i = 0; i < n; i++)
        if (concerned(s, slot[i])) {
            look_closed(s, slot[i]);
            seen++;
        }
    return seen;
}

/* ---- all of them ---- */

static uint32_t look_all_alone(Simulation *s, const Crowd *c)
{
    uint32_t seen = 0;
    for (uint32_t r = 0; r < CROWD_SIDE; r++)
        for (uint32_t k = c->first[r]; k < c->last[r]; k++)
            if (s->near2[k] >= 0.0) {
                look_alone(s, k);
                seen++;
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
static uint32_t look_together(Simulation *s, Crowd *c, Sight *sight, bool *parted)
{
    if (c->most2 < 0.0)
        return 0;
    crowd_fetch(s, c);
    bool open = s->def.pattern == PATTERN_OPEN, few = c->plain >= CROWD_LEAST && crowd_sight(s, c, sight);
    if (open && few && sight->nearest.n == 0)
        return 0;
    if (!few || sight->nearest.n == 0) {
        if (!open)
            *parted = true;
        return look_all_alone(s, c);
    }
    uint32_t seen = 0;
    double most2 = -1.0;
    for (uint32_t r = 0; r < CROWD_SIDE; r++) {
        uint32_t first = c->first[r], last = c->last[r];
        double run2 = open ? look_open_run(s, first, last, sight) : look_closed_run(s, first, last, sight, parted);
        most2 = MAX(most2, run2);
        seen += last - first;
    }
    c->most2 = most2;
    return seen;
}

uint32_t crowd_look(Simulation *s, Crowd *c, Sight *sight)
{
    enum { SOME = 128 };
    if (s->def.pattern == PATTERN_OPEN)
        return look_together(s, c, sight, NULL);
    uint32_t some[SOME], *apart = some, n = 0;
    bool any = c->restless || c->zone.x0 <= c->zone.x1;
    if (any && (c->restless || boxtree_any_in(&s->fresh_tree, s->veins.pos, zone_as_box(c->zone)))) {
        n = list_apart(s, c, some, SOME);
        if (n > SOME)
            list_apart(s, c, apart = g_new(uint32_t, n), n);
    }
    bool parted = false;
    uint32_t seen = look_together(s, c, sight, &parted) + look_each(s, apart, n);
    if (apart != some)
        g_free(apart);
    if (any || parted)
        crowd_measure(s, c);
    return seen;
}
