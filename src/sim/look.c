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

/* Four sources, and which of the nearest few is the new nearest node of each. */
typedef struct {
    Four x, y, d2;
    FourMask which; /* -1: none is nearer than the node that it has */
} Block;

/* Of equally near nodes the smallest, and the one before over all. Removed sources and those apart are nearer than anything to theirs. */
static inline __attribute__((always_inline)) void block_look(const Simulation *s, uint32_t k, uint32_t n, const Few *few, Block *b)
{
    double x[4], y[4], d2[4] = {-1.0, -1.0, -1.0, -1.0};
    for (uint32_t l = 0; l < 4; l++) {
        uint32_t i = l < n ? k + l : k;
        x[l] = s->place[i].x;
        y[l] = s->place[i].y;
        if (l < n)
            d2[l] = s->near2[i];
    }
    Four px = {x[0], x[1], x[2], x[3]}, py = {y[0], y[1], y[2], y[3]}, least = {d2[0], d2[1], d2[2], d2[3]};
    FourMask which = {-1, -1, -1, -1};
    for (uint32_t j = 0; j < few->n; j++) {
        Four dx = px - FOUR(few->x[j]), dy = py - FOUR(few->y[j]), e2 = dx * dx + dy * dy;
        FourMask nearer = e2 < least, number = {j, j, j, j};
        least = FOUR_PICK(nearer, e2, least);
        which = (number & nearer) | (which & ~nearer);
    }
    b->x = px;
    b->y = py;
    b->d2 = least;
    b->which = which;
}

/* A source of an open pattern. When it can't see the node it looks for itself. */
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

static inline double four_most(const Four *v) { return MAX(MAX((*v)[0], (*v)[1]), MAX((*v)[2], (*v)[3])); }

/* Most often those of the four that are plain turn to new nodes and stay plain; the others are no matter. FALSE: see for each. */
static inline __attribute__((always_inline)) bool all_move_on(Simulation *s, uint32_t k, const Block *b, const FourMask *trouble_of,
                                                              double within2, const Few *few)
{
    FourMask plain = b->d2 >= FOUR(0.0);
    FourMask trouble = (*trouble_of | (b->which < (FourMask){0, 0, 0, 0}) | (b->d2 < FOUR(within2))) & plain;
    uint32_t marks;
    memcpy(&marks, s->mark + k, sizeof marks);
    if (s->reach || FOUR_ANY(trouble))
        return false;
    for (uint32_t l = 0; marks && l < 4; l++)
        if (plain[l] && s->mark[k + l])
            return false;
    for (uint32_t l = 0; l < 4; l++)
        if (plain[l])
            s->near[k + l] = few->v[b->which[l]];
    memcpy(s->near2 + k, &b->d2, sizeof b->d2);
    return true;
}

static FOUR_WIDE double look_open_run(Simulation *s, uint32_t first, uint32_t last, const Few *few)
{
    double within2 = MAX(kill2(s), past2(s));
    Four most2 = FOUR(-1.0);
    const FourMask none = {0, 0, 0, 0};
    for (uint32_t k = first; k < last; k += 4) {
        uint32_t n = MIN(4, last - k);
        Block b;
        if (n == 4)
            block_look(s, k, 4, few, &b);
        else
            block_look(s, k, n, few, &b);
        if (n == 4 && all_move_on(s, k, &b, &none, within2, few)) {
            most2 = FOUR_PICK(b.d2 > most2, b.d2, most2);
            continue;
        }
        for (uint32_t l = 0; l < n; l++)
            if (b.which[l] >= 0)
                show_open(s, k + l, few->v[b.which[l]], b.d2[l], within2);
        for (uint32_t l = 0; s->reach && l < n; l++)
            b.d2[l] = s->near2[k + l]; /* that of a node it sees */
        most2 = FOUR_PICK(b.d2 > most2, b.d2, most2);
    }
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

/* Which of the four keep their old node beside the new nearest one? It excludes the old one when it is its child and near by, as it mostly is. */
static inline __attribute__((always_inline)) void block_stays(const Simulation *s, uint32_t k, uint32_t n, const Block *b,
                                                              const Sight *sight, FourMask *out)
{
    const Veins *veins = &s->veins;
    const Few *few = &sight->nearest;
    FourMask stays = {0, 0, 0, 0};
    for (uint32_t l = 0; l < n; l++) {
        uint32_t old = s->near[k + l];
        int64_t j = b->which[l];
        if (j < 0 || (veins->parent[few->v[j]] == old && sight->stride2[j] <= s->near2[k + l]))
            continue;
        Vec2 v = vec2(few->x[j], few->y[j]);
        stays[l] = vec_dist2(v, veins->pos[old]) > s->near2[k + l] ? -1 : 0;
    }
    *out = stays;
}

/* For which of them are there rivals that neither the new nearest node nor another of the few excludes? */
static inline __attribute__((always_inline)) void block_rivals(const Simulation *s, const Block *b, const Sight *sight, FourMask *out)
{
    const Few *few = &sight->nearest, *rival = &sight->rival;
    uint32_t at[4];
    for (uint32_t l = 0; l < 4; l++)
        at[l] = b->which[l] < 0 ? 0 : (uint32_t)b->which[l];
    Four vx = {few->x[at[0]], few->x[at[1]], few->x[at[2]], few->x[at[3]]};
    Four vy = {few->y[at[0]], few->y[at[1]], few->y[at[2]], few->y[at[3]]};
    FourMask more = {0, 0, 0, 0};
    for (uint32_t j = 0; j < rival->n; j++) {
        Vec2 r = vec2(rival->x[j], rival->y[j]);
        Four rx = FOUR(r.x), ry = FOUR(r.y), d2 = (rx - b->x) * (rx - b->x) + (ry - b->y) * (ry - b->y);
        FourMask open = (rx - vx) * (rx - vx) + (ry - vy) * (ry - vy) > d2;
        for (uint32_t i = 0; i < few->n && !s->reach && FOUR_ANY(open); i++) {
            Vec2 u = vec2(few->x[i], few->y[i]);
            Four dx = FOUR(u.x) - b->x, dy = FOUR(u.y) - b->y;
            open &= ~((dx * dx + dy * dy < d2) & (FOUR(vec_dist2(u, r)) <= d2));
        }
        more |= open;
    }
    *out = more;
}

static FOUR_WIDE double look_closed_run(Simulation *s, uint32_t first, uint32_t last, const Sight *sight, bool *parted)
{
    const Few *few = &sight->nearest;
    double most2 = -1.0, within2 = MAX(kill2(s), past2(s));
    Four far2 = FOUR(-1.0);
    for (uint32_t k = first; k < last; k += 4) {
        uint32_t n = MIN(4, last - k);
        Block b;
        FourMask more = {0, 0, 0, 0}, stays;
        if (n == 4) {
            block_look(s, k, 4, few, &b);
            block_stays(s, k, 4, &b, sight, &stays);
        } else {
            block_look(s, k, n, few, &b);
            block_stays(s, k, n, &b, sight, &stays);
        }
        if (sight->rival.n)
            block_rivals(s, &b, sight, &more);
        FourMask trouble = stays | more;
        if (n == 4 && all_move_on(s, k, &b, &trouble, within2, few)) {
            far2 = FOUR_PICK(b.d2 > far2, b.d2, far2);
            continue;
        }
        for (uint32_t l = 0; l < n; l++) {
            if (s->near2[k + l] < 0.0)
                continue;
            int64_t j = b.which[l];
            if (j < 0 || stays[l] || !show_closed(s, k + l, few->v[j], b.d2[l], !more[l], sight))
                look_closed(s, k + l);
            *parted |= (s->mark[k + l] & MARK_APART) != 0;
            most2 = MAX(most2, s->near2[k + l]);
        }
    }
    return MAX(most2, four_most(&far2));
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

/* Those that pull one node each. `parted`: one of a closed pattern may no longer be like that. */
static uint32_t look_together(Simulation *s, Crowd *c, Sight *sight, bool *parted)
{
    if (c->most2 < 0.0)
        return 0;
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
        double run2 = open ? look_open_run(s, first, last, &sight->nearest) : look_closed_run(s, first, last, sight, parted);
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
