/* Vein development: which nodes are pulled, where their children are born, what becomes of the sources (Runions 2005, sections 3.3 and 4). */
#include "geom/parallel.h"
#include "sim/state.h"

/* A node born nearer than this to another one would only double it. Segments. */
static const double crowding = 0.1;

/* ---- S(v): who pulls whom ---- */

static void pull_add(Simulation *s, uint32_t source, uint8_t member, uint32_t v, Vec2 towards)
{
    Veins *veins = &s->veins;
    uint32_t k = veins->pull[v];
    if (k >= s->n_pulled || s->pulled[k].node != v) {
        if (s->n_pulled == s->cap_pulled) {
            s->cap_pulled = MAX(s->cap_pulled * 2, 1024);
            s->pulled = g_renew(Pulled, s->pulled, s->cap_pulled);
        }
        k = veins->pull[v] = s->n_pulled++;
        s->pulled[k] = (Pulled){.node = v, .first = NO_POINT, .last = NO_POINT};
    }
    if (s->n_pull == s->cap_pull) {
        s->cap_pull = MAX(s->cap_pull * 2, 1024);
        s->pull = g_renew(Pull, s->pull, s->cap_pull);
    }
    Pulled *p = &s->pulled[k];
    s->pull[s->n_pull] = (Pull){source, member, NO_POINT};
    if (p->last == NO_POINT)
        p->first = s->n_pull;
    else
        s->pull[p->last].next = s->n_pull;
    p->last = s->n_pull++;
    p->count++;
    p->sum = vec_add(p->sum, towards);
}

/* A node nearer than this to a source can't get nearer by a step of D = 1, only past it: the source lets go of it. Segments². */
static const double overshoot2 = 0.25;

/* Members that the source pulls now. A reached source of a closed pattern waits for its tagged veins alone, and not for those that
 * have arrived. */
static uint8_t pulling(const Simulation *s, const Source *src)
{
    double kill = s->def.kill_distance * s->blade->unit;
    uint8_t mask = 0;
    for (uint32_t i = 0; i < src->hood.n; i++) {
        uint8_t bit = (uint8_t)(1u << i);
        if ((src->spent & bit) || src->hood.m[i].d2 <= overshoot2 * s->blade->unit * s->blade->unit)
            continue;
        if (src->reached && (!(src->tagged & bit) || src->hood.m[i].d2 < kill * kill))
            continue;
        mask |= bit;
    }
    return mask;
}

/* Fills pulled[] with every S(v) and the sums of eq. 1. Returns the number of sources that pull at all. */
static uint32_t gather_pulls(Simulation *s)
{
    uint32_t live = 0;
    bool open = s->def.pattern == PATTERN_OPEN;
    double past = overshoot2 * s->blade->unit * s->blade->unit;
    s->n_pull = s->n_pulled = 0;
    for (uint32_t k = 0; k < s->n_sources; k++) {
        if (s->idle[k])
            continue;
        uint8_t mask = open ? s->near[k] != NO_POINT && s->near2[k] > past : pulling(s, &s->source[k]);
        live += mask != 0;
        for (uint8_t i = 0; mask; i++, mask >>= 1) {
            if (!(mask & 1))
                continue;
            Neighbour m = source_member(s, k, i);
            pull_add(s, k, i, m.v, vec_scale(vec_sub(s->place[k], m.p), 1.0 / sqrt(m.d2)));
        }
    }
    return live;
}

/* ---- new vein nodes ---- */

static void fresh_add(Simulation *s, uint32_t v)
{
    if (s->n_fresh == s->cap_fresh) {
        s->cap_fresh = MAX(s->cap_fresh * 2, 1024);
        s->fresh = g_renew(uint32_t, s->fresh, s->cap_fresh);
    }
    s->fresh[s->n_fresh++] = v;
}

/* Grows a child of v in a direction (any length) unless it would lie on top of another node or out of the blade. */
static bool grow(Simulation *s, uint32_t v, Vec2 direction)
{
    double norm = sqrt(vec_norm2(direction)), unit = s->blade->unit;
    Vec2 p = vec_add(s->veins.pos[v], vec_scale(direction, unit / norm)); /* eq. 1, D = 1 */
    if (quadtree_any_within(&s->veins.tree, p, crowding * unit) || !blade_admits(s->blade, p))
        return false;
    uint32_t child = veins_add(&s->veins, p, v, s->blade->step);
    if (s->blade->moving)
        s->veins.material[child] = blade_material(s->blade, p);
    fresh_add(s, child);
    return true;
}

/* The rule for pulls that would come to nothing, because they cancel or because the same child was born before: the vein turns
 * to one source, the nearest that still makes a difference (a bifurcation, over some steps). A source for which no child is possible
 * lets go of this node. */
static void grow_single(Simulation *s, const Pulled *p)
{
    for (;;) {
        uint32_t best = NO_POINT;
        double best2 = HUGE_VAL;
        for (uint32_t k = p->first; k != NO_POINT; k = s->pull[k].next) {
            uint32_t slot = s->pull[k].source;
            double d2 = source_member(s, slot, s->pull[k].member).d2;
            if (!s->idle[slot] && !(s->source[slot].spent >> s->pull[k].member & 1) && d2 < best2) {
                best2 = d2;
                best = k;
            }
        }
        if (best == NO_POINT)
            return;
        uint32_t slot = s->pull[best].source;
        uint8_t i = s->pull[best].member;
        if (grow(s, p->node, vec_sub(s->place[slot], s->veins.pos[p->node])))
            return;
        if (s->def.pattern == PATTERN_OPEN)
            s->idle[slot] = 1;
        else
            s->source[slot].spent |= (uint8_t)(1u << i);
    }
}

static void grow_pulled(Simulation *s)
{
    s->n_fresh = 0;
    for (uint32_t k = 0; k < s->n_pulled; k++) {
        const Pulled *p = &s->pulled[k];
        bool cancelled = vec_norm2(p->sum) < 1e-12 * (double)p->count * (double)p->count;
        if (cancelled || !grow(s, p->node, p->sum))
            grow_single(s, p);
    }
}

/* ---- neighbourhoods ---- */

/* What the members were before an update. */
typedef struct {
    uint32_t n, v[HOOD_MAX];
    double d2[HOOD_MAX];
    uint8_t tagged, spent;
} Members;

static Members members_of(const Source *src)
{
    Members m = {.n = src->hood.n, .tagged = src->tagged, .spent = src->spent};
    for (uint32_t i = 0; i < m.n; i++) {
        m.v[i] = src->hood.m[i].v;
        m.d2[i] = src->hood.m[i].d2;
    }
    return m;
}

/* Carries the masks over to the new members. A tag is passed by a node to its descendants, not beyond the one that arrived. */
static void carry_masks(const Simulation *s, Source *src, const Members *old)
{
    double kill = s->def.kill_distance * s->blade->unit;
    src->tagged = src->spent = 0;
    for (uint32_t i = 0; i < src->hood.n; i++)
        for (uint32_t j = 0; j < old->n; j++) {
            if (src->hood.m[i].v == old->v[j]) {
                src->tagged |= (uint8_t)((old->tagged >> j & 1) << i);
                src->spent |= (uint8_t)((old->spent >> j & 1) << i);
            } else if (s->veins.parent[src->hood.m[i].v] == old->v[j] && old->d2[j] >= kill * kill) {
                src->tagged |= (uint8_t)((old->tagged >> j & 1) << i);
            }
        }
}

static void source_update(Simulation *s, uint32_t k)
{
    Source *src = &s->source[k];
    Eye eye;
    Field f = source_field(s, src, &eye);
    bool marked = src->tagged | src->spent;
    Members old;
    if (marked)
        old = members_of(src);
    bool changed = s->def.neighbourhood == NEIGHBOURHOOD_RELATIVE ? hood_update(&src->hood, &f, &s->fresh_tree)
                                                                  : urquhart_update(&src->hood, &src->cell, &f, &s->fresh_tree);
    if (!changed)
        return;
    if (marked)
        carry_masks(s, src, &old);
    zones_set(&s->zones, k, src->hood.zone);
}

static void update_sources(uint32_t first, uint32_t last, void *user)
{
    enum { AHEAD = 6, LINE = 64 };
    Simulation *s = user;
    for (uint32_t k = first; k < last; k++) {
        if (k + AHEAD < last) { /* most of the time would go to waiting for memory */
            const char *next = (const char *)&s->source[s->touched[k + AHEAD]];
            for (int line = 0; line < 9; line++)
                __builtin_prefetch(next + line * LINE);
        }
        source_update(s, s->touched[k]);
    }
}

/* New nodes that a cell of sources looks at, beside each other in memory. */
enum { FEW = 256 };
typedef double Pair __attribute__((vector_size(16)));
typedef int64_t PairMask __attribute__((vector_size(16)));
typedef struct {
    uint32_t n;
    uint32_t v[FEW]; /* ascending */
    union {
        double at[FEW + 2];
        Pair pair[FEW / 2 + 1];
    } x, y; /* an odd number of nodes is followed by a place out of sight */
} Few;

/* Moves slot k to the nearest of a few new nodes if that is nearer than its old one (which wins a tie, as the older). */
static void few_nearest(Simulation *s, uint32_t k, const Few *few)
{
    Vec2 p = s->place[k];
    const Pair px = {p.x, p.x}, py = {p.y, p.y};
    Pair least = {HUGE_VAL, HUGE_VAL};
    for (uint32_t j = 0; j < (few->n + 1) / 2; j++) { /* without branches and two at a time: nearly all lie farther off */
        Pair dx = few->x.pair[j] - px, dy = few->y.pair[j] - py, d2 = dx * dx + dy * dy;
        PairMask nearer = d2 < least;
        least = (Pair)(((PairMask)d2 & nearer) | ((PairMask)least & ~nearer));
    }
    double best2 = MIN(least[0], least[1]);
    if (best2 >= s->near2[k])
        return;
    for (uint32_t j = 0; j < few->n; j++) {
        double d2 = vec_dist2(vec2(few->x.at[j], few->y.at[j]), p);
        if (d2 == best2) {
            s->near2[k] = d2;
            s->near[k] = few->v[j];
            return;
        }
    }
}

/* Open patterns: shows the sources of one cell the new nodes that may be nearest to one of them. Returns how many sources looked. */
static uint32_t cell_update(Simulation *s, uint32_t cell)
{
    double most2 = -1.0;
    uint32_t seen = 0;
    for (uint32_t k = s->zones.head[cell]; k != NO_POINT; k = s->zones.next[k])
        most2 = MAX(most2, s->near2[k]);
    Few few;
    few.n = s->reach ? FEW + 1 : boxtree_nearest_to(&s->fresh_tree, s->veins.pos, zones_cell_box(&s->zones, cell), most2, few.v, FEW);
    for (uint32_t j = 0; few.n <= FEW && j < few.n; j++) {
        few.x.at[j] = s->veins.pos[few.v[j]].x;
        few.y.at[j] = s->veins.pos[few.v[j]].y;
    }
    if (few.n <= FEW)
        few.x.at[few.n] = few.y.at[few.n] = HUGE_VAL;
    for (uint32_t k = s->zones.head[cell]; k != NO_POINT; k = s->zones.next[k]) {
        double before = s->near2[k];
        if (before < 0.0)
            continue;
        seen++;
        if (few.n <= FEW) {
            few_nearest(s, k, &few);
        } else { /* too many, or which of them a source may see is its own affair */
            Eye eye;
            Field f = source_field(s, &s->source[k], &eye);
            boxtree_nearest(&s->fresh_tree, s->veins.pos, s->place[k], f.sees, f.user, &s->near[k], &s->near2[k]);
        }
        if (s->near2[k] < before) {
            s->idle[k] = 0;
            zones_set(&s->zones, k, disc_box(s->place[k], s->near2[k]));
        }
    }
    return seen;
}

static void update_cells(uint32_t first, uint32_t last, void *user)
{
    Simulation *s = user;
    uint32_t seen = 0;
    for (uint32_t k = first; k < last; k++)
        seen += cell_update(s, s->touched[k]);
    g_atomic_int_add(&s->seen, (gint)seen); /* a sum: the order of the threads doesn't matter */
}

/* Shows this step's nodes to the sources that they may concern. Each source is on its own, so threads can't change the outcome. */
static void update_neighbourhoods(Simulation *s)
{
    enum { GRAIN = 512 };
    bool open = s->def.pattern == PATTERN_OPEN;
    /* Discs only shrink, so boxes that are not raised stay right, if larger than need be; other zones may shift. */
    if (!open || s->blade->step % (1 + s->n_sources / 8192) == 0)
        zones_raise(&s->zones);
    boxtree_build(&s->fresh_tree, s->veins.pos, s->fresh, s->n_fresh);
    uint32_t room = MAX(s->n_sources, zones_cells(&s->zones));
    if (room > s->cap_touched) {
        s->cap_touched = room * 2;
        s->touched = g_renew(uint32_t, s->touched, s->cap_touched);
    }
    s->n_touched = (open ? zones_visit_cells : zones_visit)(&s->zones, &s->fresh_tree, s->veins.pos, s->touched);
    s->seen = open ? 0 : (gint)s->n_touched;
    parallel_for(s->n_touched > 2 * GRAIN ? s->def.threads : 1, s->n_touched, GRAIN, open ? update_cells : update_sources, s);
    s->counts.updates += (uint64_t)s->seen;
}

uint32_t veins_develop(Simulation *s)
{
    uint32_t live = gather_pulls(s);
    grow_pulled(s);
    if (s->n_fresh)
        update_neighbourhoods(s);
    return live;
}

/* ---- removal and anastomosis ---- */

/* Do two nodes descend from one ancestor a few nodes back? Then joining them would close no areole but a speck. */
static bool close_kin(const Veins *v, uint32_t a, uint32_t b)
{
    enum { GENERATIONS = 4 };
    uint32_t x = a;
    for (int i = 0; i <= GENERATIONS && x != NO_POINT; i++, x = v->parent[x]) {
        uint32_t y = b;
        for (int j = 0; j <= GENERATIONS && y != NO_POINT; j++, y = v->parent[y])
            if (x == y)
                return true;
    }
    return false;
}

/* Joins the veins that arrived at a source: each to the first of them, as the anastomosis that loops are made of. */
static void join_arrived(Simulation *s, const Source *src)
{
    double most = s->def.join_distance * s->blade->unit;
    for (uint32_t i = 1; i < src->n_arrived; i++) {
        uint32_t a = src->arrived[0], b = src->arrived[i];
        if (vec_dist2(s->veins.pos[a], s->veins.pos[b]) <= most * most && !close_kin(&s->veins, a, b))
            veins_join(&s->veins, a, b, s->blade->step);
    }
}

/* Closed patterns: notes arrivals; returns whether all tagged veins have reached the source or left its zone of influence. */
static bool all_arrived(Simulation *s, Source *src)
{
    double kill2 = s->def.kill_distance * s->blade->unit * s->def.kill_distance * s->blade->unit;
    bool within = false;
    for (uint32_t i = 0; i < src->hood.n; i++)
        within |= src->hood.m[i].d2 < kill2;
    if (!src->reached && within) {
        src->reached = true;
        src->tagged = (uint8_t)((1u << src->hood.n) - 1); /* V(s) is tagged */
    }
    if (!src->reached)
        return false;
    bool waiting = false;
    for (uint32_t i = 0; i < src->hood.n; i++) {
        uint8_t bit = (uint8_t)(1u << i);
        if (!(src->tagged & bit))
            continue;
        if (src->hood.m[i].d2 < kill2) {
            src->tagged &= (uint8_t)~bit;
            if (src->n_arrived < HOOD_MAX)
                src->arrived[src->n_arrived++] = src->hood.m[i].v;
        } else if (!(src->spent & bit) && src->hood.m[i].d2 > overshoot2 * s->blade->unit * s->blade->unit) {
            waiting = true;
        }
    }
    return !waiting;
}

static bool finished(Simulation *s, uint32_t k)
{
    if (s->def.pattern == PATTERN_OPEN) {
        double kill = s->def.kill_distance * s->blade->unit;
        return s->near2[k] < kill * kill;
    }
    if (!all_arrived(s, &s->source[k]))
        return false;
    join_arrived(s, &s->source[k]);
    return true;
}

void sources_remove(Simulation *s)
{
    for (uint32_t k = 0; k < s->n_sources; k++) {
        if (!source_is_alive(s, k) || !finished(s, k))
            continue;
        s->counts.reached++;
        source_remove(s, k);
    }
    if (s->n_removed + s->n_unsorted > 64 + s->n_sources / 4)
        sources_sort(s);
}
