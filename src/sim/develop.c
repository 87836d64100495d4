/* Vein development: which nodes are pulled, where their children are born, what becomes of the sources (Runions 2005, sections 3.3 and 4). */
#include "sim/state.h"

/* A node born nearer than this to another one would only double it. Segments. */
static const double crowding = 0.1;

/* ---- new vein nodes ---- */

static void fresh_add(Simulation *s, uint32_t v)
{
    if (s->n_fresh == s->cap_fresh) {
        s->cap_fresh = MAX(s->cap_fresh * 2, 1024);
        s->fresh = g_renew(uint32_t, s->fresh, s->cap_fresh);
    }
    s->fresh[s->n_fresh++] = v;
}

/* Where a child of v would be born in a direction (any length): eq. 1, D = 1. */
static Vec2 child_place(const Simulation *s, uint32_t v, Vec2 direction)
{
    double norm = sqrt(vec_norm2(direction));
    return vec_add(s->veins.pos[v], vec_scale(direction, s->blade->unit / norm));
}

/* Not on top of another node, nor out of the blade, nor where a drawn vein is going to be. */
static bool has_room(const Simulation *s, Vec2 p)
{
    return !quadtree_any_within(&s->veins.tree, p, crowding * s->blade->unit) && blade_admits(s->blade, p) && !given_claims(s, p);
}

/* Grows a child of v in a direction if there is room for it. `looked`: there was before this step. */
static bool grow(Simulation *s, uint32_t v, Vec2 direction, bool looked)
{
    Vec2 p = child_place(s, v, direction);
    if (looked ? quadtree_any_within(&s->young, p, crowding * s->blade->unit) : !has_room(s, p))
        return false;
    uint32_t child = veins_add(&s->veins, p, v, s->blade->step);
    if (s->blade->moving)
        s->veins.material[child] = blade_material(s->blade, p);
    if (s->looked)
        quadtree_add(&s->young, p, child);
    fresh_add(s, child);
    return true;
}

/* The rule for pulls that would come to nothing, because they cancel or because the same child was born before: the vein turns
 * to one source, the nearest that still makes a difference (a bifurcation, over some steps). A source for which no child is possible
 * lets go of this node. */
static void grow_single(Simulation *s, const Pulled *p)
{
    crowds_wake(s, p->node);
    for (;;) {
        Pull pull, best = {NO_POINT, 0};
        double best2 = HUGE_VAL;
        for (uint32_t k = p->first; pulls_next(s, p, k, &pull); k = pull.slot + 1) {
            double d2 = vec_dist2(s->place[pull.slot], s->veins.pos[p->node]);
            if (d2 < best2) {
                best2 = d2;
                best = pull;
            }
        }
        if (best.slot == NO_POINT || grow(s, p->node, vec_sub(s->place[best.slot], s->veins.pos[p->node]), false))
            return;
        if (s->def.pattern == PATTERN_OPEN) {
            s->mark[best.slot] |= MARK_IDLE;
        } else {
            crowd_part(s, best.slot);
            s->source[best.slot].spent |= (uint8_t)(1u << best.member);
        }
    }
}

/* Where there is no room before anything has grown, no child is born where the sum points to. */
static void bar_pulled(uint32_t first, uint32_t last, void *user)
{
    Simulation *s = user;
    for (uint32_t k = first; k < last; k++) {
        Pulled *p = &s->pulled[k];
        p->barred = !has_room(s, child_place(s, p->node, p->sum));
    }
}

/* Children are born one after the other, as each takes up room; but threads look first how much there is. */
static void grow_pulled(Simulation *s)
{
    enum { GRAIN = 128 }; /* some ten microseconds */
    bool looked = s->looked = pool_threads(s->pool) > 1 && s->n_pulled > 16 * GRAIN;
    s->n_fresh = 0;
    quadtree_reset(&s->young, field_box(s));
    if (looked)
        pool_for(s->pool, s->n_pulled, GRAIN, bar_pulled, s);
    for (uint32_t k = 0; k < s->n_pulled; k++) {
        const Pulled *p = &s->pulled[k];
        bool cancelled = vec_norm2(p->sum) < 1e-12 * (double)p->count * (double)p->count;
        if (cancelled || p->barred || !grow(s, p->node, p->sum, looked))
            grow_single(s, p);
    }
}

/* ---- removal and anastomosis ---- */

/* A vein node and its child are joined already. */
static bool parent_and_child(const Veins *v, uint32_t a, uint32_t b) { return v->parent[a] == b || v->parent[b] == a || a == b; }

static uint32_t new_arrival(Simulation *s)
{
    uint32_t i = s->unused_arrival;
    if (i != NO_POINT) {
        s->unused_arrival = s->arrival[i].next;
        return i;
    }
    if (s->n_arrivals == s->cap_arrivals) {
        s->cap_arrivals = MAX(s->cap_arrivals * 2, 64);
        s->arrival = g_renew(Arrival, s->arrival, s->cap_arrivals);
    }
    return s->n_arrivals++;
}

/* Appends to the arrivals of slot k; HOOD_MAX are noted. */
static void note_arrival(Simulation *s, uint32_t k, uint32_t node)
{
    uint32_t i = new_arrival(s), *end = &s->source[k].arrived, n = 0;
    for (; *end != NO_POINT; end = &s->arrival[*end].next)
        n++;
    bool full = n == HOOD_MAX;
    s->arrival[i] = (Arrival){node, full ? s->unused_arrival : NO_POINT};
    *(full ? &s->unused_arrival : end) = i;
}

/* Joins the veins that arrived at a source: each to the first of them, as the anastomosis that loops are made of. */
static void join_arrived(Simulation *s, uint32_t k)
{
    double most = s->def.join_distance * s->blade->unit;
    const Arrival *first = &s->arrival[s->source[k].arrived];
    for (uint32_t i = first->next; i != NO_POINT; i = s->arrival[i].next) {
        uint32_t a = first->node, b = s->arrival[i].node;
        if (vec_dist2(s->veins.pos[a], s->veins.pos[b]) <= most * most && !parent_and_child(&s->veins, a, b))
            veins_join(&s->veins, a, b, s->blade->step);
    }
}

/* Closed patterns: notes arrivals; returns whether all tagged veins have reached the source or left its zone of influence. */
static bool all_arrived(Simulation *s, uint32_t k)
{
    Source *src = &s->source[k];
    if (!(s->mark[k] & MARK_REACHED)) {
        s->mark[k] |= MARK_REACHED;
        src->tagged = (uint8_t)((1u << src->hood.n) - 1); /* V(s) is tagged */
    }
    bool waiting = false;
    for (uint32_t i = 0; i < src->hood.n; i++) {
        uint8_t bit = (uint8_t)(1u << i);
        double d2 = vec_dist2(s->place[k], s->veins.pos[src->hood.m[i]]);
        if (!(src->tagged & bit))
            continue;
        if (d2 < kill2(s)) {
            src->tagged &= (uint8_t)~bit;
            note_arrival(s, k, src->hood.m[i]);
        } else if (!(src->spent & bit) && d2 > past2(s)) {
            waiting = true;
        }
    }
    return !waiting;
}

static bool finished(Simulation *s, uint32_t k)
{
    bool within = false;
    for (uint32_t i = 0; i < source_members(s, k); i++)
        within |= vec_dist2(s->place[k], s->veins.pos[source_member(s, k, i)]) < kill2(s);
    if (s->def.pattern == PATTERN_OPEN)
        return within;
    if ((!within && !(s->mark[k] & MARK_REACHED)) || !all_arrived(s, k))
        return false;
    join_arrived(s, k);
    return true;
}

/* Whether source_remove_reached does anything. */
bool source_is_late(const Simulation *s, uint32_t k)
{
    if (!(s->mark[k] & (MARK_WITHIN | MARK_REACHED)))
        return false;
    const Source *src = s->def.pattern == PATTERN_OPEN ? NULL : &s->source[k];
    bool within = false, waiting = false, reached = s->mark[k] & MARK_REACHED;
    for (uint32_t i = 0; i < source_members(s, k); i++) {
        double d2 = vec_dist2(s->place[k], s->veins.pos[source_member(s, k, i)]);
        bool counts = !reached || (src->tagged >> i & 1);
        within |= counts && d2 < kill2(s);
        waiting |= reached && counts && !(src->spent >> i & 1) && d2 > past2(s);
    }
    return within || (reached && !waiting);
}

bool source_remove_reached(Simulation *s, uint32_t k)
{
    if (!(s->mark[k] & (MARK_WITHIN | MARK_REACHED)) || !finished(s, k))
        return false;
    s->counts.reached++;
    source_remove(s, k);
    return true;
}

/* ---- the step ---- */

/* From now on only veins change, so that the next step's pulls are known when this one's nodes have been looked at. */
static bool quiet(const Simulation *s)
{
    bool darts = s->def.placement == PLACEMENT_DARTS && !(s->def.only_while_growing && s->blade->step >= MAX(s->blade->last_step, 1));
    return s->blade->step >= s->blade->last_step && !darts && !sources_waiting(s);
}

uint32_t veins_develop(Simulation *s)
{
    if (!s->drawn)
        sources_turn(s, false, false, true);
    s->drawn = false;
    uint32_t live = s->n_live;
    grow_pulled(s);
    given_appear(s, fresh_add);
    return live;
}

void sources_remove(Simulation *s)
{
    bool still = quiet(s);
    sources_turn(s, s->n_fresh > 0, true, still);
    /* without newcomers the order stays what it is, and closing the gaps soon is only a matter of speed */
    if (s->n_removed + s->n_unsorted > 64 + s->n_sources / 4 || (still && s->n_unsorted == 0 && s->n_removed > 32 + s->n_sources / 16))
        sources_sort(s);
}
