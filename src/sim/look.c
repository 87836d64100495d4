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
static void look_closed(Simulation *s, uint32_t k)
{
    Source *src = &s->source[k], old = *src;
    Eye eye;
    Field f = source_field(s, k, &eye);
    bool changed = s->def.neighbourhood == NEIGHBOURHOOD_RELATIVE
                       ? hood_update(&src->hood, &f, s->place[k], &s->fresh_tree)
                       : urquhart_update(&src->hood, &s->cell[k], &f, s->place[k], &s->fresh_tree);
    if (!changed) {
        s->mark[k] |= MARK_ZONED;
        zones_set(&s->zones, k, source_zone(s, k));
        return;
    }
    if (old.tagged | old.spent)
        carry_masks(s, k, &old);
    source_weigh(s, k);
    if (s->mark[k] & MARK_ZONED) {
        s->mark[k] = (uint8_t)((s->mark[k] & ~MARK_ZONED) | MARK_GROWN);
        zones_set(&s->zones, k, f.field);
        g_atomic_int_set(&s->grown, 1);
    }
}

static bool concerned(const Simulation *s, uint32_t k)
{
    if (s->def.pattern == PATTERN_OPEN || !(s->mark[k] & MARK_ZONED))
        return true;
    return boxtree_any_in(&s->fresh_tree, s->veins.pos, zones_get(&s->zones, k));
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

/* ---- a crowd of sources ---- */

/* Sources beside each other that have one neighbour each: those of an open pattern always, those of a closed one while they are ahead of
 * the veins, as nearly all are where many are placed at once. Their neighbours move at every step, each to the nearest new node; which few
 * that can be, and which others need not be excluded by it, is found for all of them together. */
enum { FEW = 128, CROWD_LEAST = 4, CROWD_MOST = 128 };
typedef struct {
    uint32_t n, slot[CROWD_MOST];
    Box2 place;   /* of all of them */
    double most2; /* squared distance of the farthest neighbour */
} Crowd;

typedef double Pair __attribute__((vector_size(16)));
typedef int64_t PairMask __attribute__((vector_size(16)));

/* New nodes, beside each other in memory. */
typedef struct {
    uint32_t n;
    uint32_t v[FEW];
    union {
        double at[FEW + 2];
        Pair pair[FEW / 2 + 1];
    } x, y; /* an odd number of nodes is followed by a place out of sight */
} Few;

/* What a crowd looks at. */
typedef struct {
    Few nearest; /* the nodes that may be nearest to a source; ascending */
    Few open;    /* closed: those that may be nearer to a source than to its nearest */
} Sight;

/* Is slot k, a living one, like those of a crowd? */
static bool crowds(const Simulation *s, uint32_t k)
{
    return s->def.pattern == PATTERN_OPEN ||
           (s->def.neighbourhood == NEIGHBOURHOOD_RELATIVE && s->source[k].hood.n == 1 && !(s->mark[k] & MARK_ZONED));
}

static void crowd_start(Crowd *c)
{
    c->n = 0;
    c->place = box_empty();
    c->most2 = -1.0;
}

static void crowd_add(const Simulation *s, Crowd *c, uint32_t k)
{
    Vec2 p = s->place[k];
    double d2 = HUGE_VAL;
    c->slot[c->n++] = k;
    c->place = box_add(c->place, p);
    if (source_members(s, k))
        d2 = vec_dist2(p, s->veins.pos[source_member(s, k, 0)]);
    c->most2 = MAX(c->most2, d2);
}

static void few_fill(Few *few, const Vec2 *pos)
{
    for (uint32_t j = 0; j < few->n; j++) {
        few->x.at[j] = pos[few->v[j]].x;
        few->y.at[j] = pos[few->v[j]].y;
    }
    few->x.at[few->n] = few->y.at[few->n] = HUGE_VAL;
}

/* FALSE when there are too many, and each source must look for itself. */
static bool sight_find(const Simulation *s, const Crowd *c, Sight *sight)
{
    const Vec2 *pos = s->veins.pos;
    Few *nearest = &sight->nearest, *open = &sight->open;
    if (c->n < CROWD_LEAST)
        return false;
    nearest->n = boxtree_nearest_to(&s->fresh_tree, pos, c->place, c->most2, nearest->v, FEW);
    if (nearest->n > FEW)
        return false;
    few_fill(nearest, pos);
    if (s->def.pattern == PATTERN_OPEN)
        return true;
    Box2 near = box_empty();
    for (uint32_t j = 0; j < nearest->n; j++)
        near = box_add(near, pos[nearest->v[j]]);
    open->n = boxtree_nearer(&s->fresh_tree, pos, c->place, near, open->v, FEW);
    if (open->n > FEW)
        return false;
    few_fill(open, pos);
    return true;
}

/* The nearest of the few to p, if it is nearer than *d2; of equally near ones the smallest. */
static uint32_t few_nearest(const Few *few, Vec2 p, double *d2)
{
    const Pair px = {p.x, p.x}, py = {p.y, p.y};
    Pair least = {HUGE_VAL, HUGE_VAL};
    for (uint32_t j = 0; j < (few->n + 1) / 2; j++) { /* without branches and two at a time: nearly all lie farther off */
        Pair dx = few->x.pair[j] - px, dy = few->y.pair[j] - py, e2 = dx * dx + dy * dy;
        PairMask nearer = e2 < least;
        least = (Pair)(((PairMask)e2 & nearer) | ((PairMask)least & ~nearer));
    }
    double best2 = MIN(least[0], least[1]);
    if (best2 >= *d2)
        return NO_POINT;
    *d2 = best2;
    uint32_t j = 0;
    while (vec_dist2(vec2(few->x.at[j], few->y.at[j]), p) != best2)
        j++;
    return few->v[j];
}

/* Does a node at u, nearer to p than all of the few, exclude them? */
static bool few_excluded(const Few *few, Vec2 p, Vec2 u)
{
    const Pair px = {p.x, p.x}, py = {p.y, p.y}, ux = {u.x, u.x}, uy = {u.y, u.y};
    PairMask out = {0, 0};
    for (uint32_t j = 0; j < (few->n + 1) / 2; j++) {
        Pair x = few->x.pair[j], y = few->y.pair[j];
        out |= (x - ux) * (x - ux) + (y - uy) * (y - uy) > (x - px) * (x - px) + (y - py) * (y - py);
    }
    return !(out[0] | out[1]);
}

/* Moves one source of the crowd to its nearest new node. FALSE when it must look for itself: when it can't see that node, or (closed) when
 * that node is not all its neighbourhood by now. */
static bool sight_show(Simulation *s, uint32_t k, const Sight *sight)
{
    bool open = s->def.pattern == PATTERN_OPEN;
    Source *src = open ? NULL : &s->source[k];
    const Vec2 *pos = s->veins.pos;
    Vec2 p = s->place[k];
    double old2 = open ? s->near2[k] : vec_dist2(p, pos[src->hood.m[0]]), d2 = old2;
    uint32_t v = few_nearest(&sight->nearest, p, &d2);
    if (v == NO_POINT)
        return open; /* in vain: a closed one will want its zone */
    if (!open && (vec_dist2(pos[v], pos[src->hood.m[0]]) > old2 || !few_excluded(&sight->open, p, pos[v])))
        return false;
    if (s->reach && !source_sees(s, k, v))
        return false;
    if (open) {
        s->near[k] = v;
        s->near2[k] = d2;
        s->mark[k] &= (uint8_t)~MARK_IDLE;
    } else if (src->tagged | src->spent) {
        Source old = *src;
        src->hood.m[0] = v;
        carry_masks(s, k, &old);
    } else {
        src->hood.m[0] = v;
    }
    if (d2 < kill2(s))
        s->mark[k] |= MARK_WITHIN;
    return true;
}

/* ---- squares of cells ---- */

static void look_alone(Simulation *s, uint32_t k)
{
    if (s->def.pattern == PATTERN_OPEN)
        look_open(s, k);
    else
        look_closed(s, k);
}

static void look_together(Simulation *s, Crowd *crowd)
{
    Sight sight;
    bool few = sight_find(s, crowd, &sight);
    for (uint32_t i = 0; i < crowd->n; i++)
        if (!few || !sight_show(s, crowd->slot[i], &sight))
            look_alone(s, crowd->slot[i]);
    crowd_start(crowd);
}

static uint32_t look_from_cell(Simulation *s, uint32_t cell, Crowd *crowd)
{
    uint32_t seen = 0;
    for (uint32_t k = s->zones.head[cell]; k != NO_POINT; k = s->zones.next[k]) {
        if (!source_is_alive(s, k) || !concerned(s, k))
            continue;
        seen++;
        if (!crowds(s, k))
            look_alone(s, k);
        else
            crowd_add(s, crowd, k);
        if (crowd->n == CROWD_MOST)
            look_together(s, crowd);
    }
    return seen;
}

/* Shows the new nodes to the sources of a square. Returns how many looked. */
static uint32_t look_from_square(Simulation *s, uint32_t level, uint32_t square)
{
    const Zones *z = &s->zones;
    uint32_t x0 = square % z->nx[level] << level, y0 = square / z->nx[level] << level, seen = 0;
    Crowd crowd;
    crowd_start(&crowd);
    for (uint32_t y = y0; y < MIN(y0 + (1u << level), z->ny[0]); y++)
        for (uint32_t x = x0; x < MIN(x0 + (1u << level), z->nx[0]); x++)
            seen += look_from_cell(s, y * z->nx[0] + x, &crowd);
    look_together(s, &crowd);
    return seen;
}

/* An open pattern's cells are as large as 4 x 4 of a closed one. */
static uint32_t square_level(const Simulation *s) { return s->def.pattern == PATTERN_OPEN ? 0 : MIN(2, s->zones.levels - 1); }

static void look_from_squares(uint32_t first, uint32_t last, void *user)
{
    Simulation *s = user;
    uint32_t seen = 0, level = square_level(s);
    for (uint32_t i = first; i < last; i++)
        seen += look_from_square(s, level, s->touched[i]);
    g_atomic_int_add(&s->seen, (gint)seen); /* a sum: the order of the threads doesn't matter */
}

/* Brings the boxes above the zones up to date now and then: too large they are still right. */
static void raise_zones(Simulation *s)
{
    bool open = s->def.pattern == PATTERN_OPEN;
    if (s->blade->step % (open ? 1 + s->n_sources / 8192 : 16) != 0)
        return;
    for (uint32_t k = 0; open && k < s->n_sources; k++)
        if (source_is_alive(s, k))
            zones_set(&s->zones, k, source_zone(s, k));
    zones_raise(&s->zones);
}

/* Too small they would be wrong. */
static void lift_zones(Simulation *s)
{
    for (uint32_t k = 0; s->grown && k < s->n_sources; k++)
        if (s->mark[k] & MARK_GROWN) {
            zones_lift(&s->zones, k, s->place[k]);
            s->mark[k] &= (uint8_t)~MARK_GROWN;
        }
    s->grown = 0;
}

void sources_update(Simulation *s)
{
    enum { GRAIN = 4 };
    raise_zones(s);
    boxtree_build(&s->fresh_tree, s->veins.pos, s->fresh, s->n_fresh);
    s->n_touched = zones_visit(&s->zones, square_level(s), &s->fresh_tree, s->veins.pos, s->touched);
    s->seen = 0;
    pool_for(s->pool, s->n_touched, GRAIN, look_from_squares, s);
    lift_zones(s);
    s->counts.updates += (uint64_t)s->seen;
}
