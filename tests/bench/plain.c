#include "plain.h"

#include <stdlib.h>

#include "geom/random.h"
#include "geom/reach.h"

enum { NONE = UINT32_MAX, MOST = 8 };

typedef struct {
    uint32_t node;
    bool tagged, spent;
} Member;

typedef struct {
    Vec2 p, material;
    uint32_t birth, n, n_arrived;
    Member member[MOST];
    bool reached;
    uint32_t arrived[MOST];
} Auxin;

typedef struct {
    const SimulationDef *def;
    Blade *blade;
    Reach *reach;
    /* nodes */
    Vec2 *pos, *material;
    uint32_t n, cap, *parent, *birth;
    uint32_t *join; /* [3 n_joins] two nodes, step */
    uint32_t n_joins;
    Auxin *auxin;
    uint32_t n_auxin, n_fresh, live;
    double carry;
    ListedSource *waiting;
    bool *gone; /* [n_waiting] placed or dropped */
    uint32_t n_waiting;
    SimulationCounts counts;
} Plain;

static double far2(Vec2 a, Vec2 b)
{
    return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
}

static uint32_t add_node(Plain *w, Vec2 p, Vec2 material, uint32_t parent)
{
    if (w->n == w->cap) {
        w->cap = MAX(2 * w->cap, 256);
        w->pos = g_renew(Vec2, w->pos, w->cap);
        w->material = g_renew(Vec2, w->material, w->cap);
        w->parent = g_renew(uint32_t, w->parent, w->cap);
        w->birth = g_renew(uint32_t, w->birth, w->cap);
    }
    w->pos[w->n] = p;
    w->material[w->n] = material;
    w->parent[w->n] = parent;
    w->birth[w->n] = w->blade->step;
    return w->n++;
}

static bool node_within(const Plain *w, Vec2 p, double r)
{
    for (uint32_t v = 0; v < w->n; v++)
        if (far2(w->pos[v], p) < r * r)
            return true;
    return false;
}

/* ---- neighbourhoods ---- */

/* Sight is judged in the leaf as it was when the younger of the two was born. */
static bool sees(const Plain *w, const Auxin *a, uint32_t v)
{
    if (!w->reach)
        return true;
    if (w->blade->moving) {
        double k = 1.0 / w->def->growth.initial_length;
        return reach_sees(w->reach, vec_scale(a->material, k), vec_scale(w->material[v], k));
    }
    double k = 1.0 / blade_scale_at(w->blade, MAX(a->birth, w->birth[v]));
    return reach_sees(w->reach, vec_scale(a->p, k), vec_scale(w->pos[v], k));
}

/* A node as a source sees it. */
typedef struct {
    double d2;
    uint32_t v;
} Look;

/* By nearness; the older of two equally near nodes comes first. */
static int by_nearness(const void *a, const void *b)
{
    const Look *x = a, *y = b;
    return x->d2 != y->d2 ? (x->d2 > y->d2) - (x->d2 < y->d2) : (x->v > y->v) - (x->v < y->v);
}

/* Eq. 2: of all nodes by nearness, those that none of the nearer ones shuts out by being nearer to it than the source
 * is. */
static uint32_t relative(const Plain *w, Look *node, uint32_t n, uint32_t out[MOST])
{
    uint32_t found = 0;
    qsort(node, n, sizeof *node, by_nearness);
    for (uint32_t i = 0; i < n; i++) {
        bool in = true;
        for (uint32_t j = 0; j < i && in; j++)
            in = far2(w->pos[node[j].v], w->pos[node[i].v]) > node[i].d2;
        if (in && found < MOST)
            out[found++] = node[i].v;
    }
    return found;
}

/* Nodes that the source may pull at all. */
static uint32_t look(const Plain *w, const Auxin *a, uint32_t out[MOST])
{
    Look *node = g_new(Look, w->n);
    uint32_t n = 0, found = 1;
    for (uint32_t v = 0; v < w->n; v++)
        if (sees(w, a, v))
            node[n++] = (Look){far2(w->pos[v], a->p), v};
    if (w->def->pattern == PATTERN_CLOSED) {
        found = relative(w, node, n, out);
    } else if (n == 0) {
        found = 0;
    } else {
        uint32_t best = 0;
        for (uint32_t i = 1; i < n; i++)
            if (node[i].d2 < node[best].d2)
                best = i;
        out[0] = node[best].v;
    }
    g_free(node);
    return found;
}

static double kill_of(const Plain *w)
{
    return w->def->kill_distance * w->blade->unit;
}

static bool killed(const Plain *w, const Auxin *a, uint32_t v)
{
    return far2(w->pos[v], a->p) < kill_of(w) * kill_of(w);
}

/* New neighbours of a source. Members that stay keep their marks and places in the list; newcomers follow by nearness,
 * and have the tag if their parent had it and has not arrived. `anew`: the whole list by nearness, tags alone kept
 * (after the blade has moved). */
static void renew(const Plain *w, Auxin *a, bool anew)
{
    Auxin old = *a;
    uint32_t list[MOST], n = look(w, a, list), kept = 0;
    a->n = 0;
    for (uint32_t i = 0; i < old.n && !anew; i++)
        for (uint32_t j = 0; j < n; j++)
            if (old.member[i].node == list[j])
                a->member[kept++] = old.member[i];
    a->n = kept;
    for (uint32_t j = 0; j < n; j++) {
        Member m = {list[j], false, false};
        bool stays = false;
        for (uint32_t i = 0; i < kept; i++)
            stays |= a->member[i].node == list[j];
        if (stays)
            continue;
        for (uint32_t i = 0; i < old.n; i++) {
            uint32_t v = old.member[i].node;
            bool same = v == m.node, child = !anew && w->parent[m.node] == v && !killed(w, a, v);
            m.tagged |= old.member[i].tagged && (same || child);
        }
        a->member[a->n++] = m;
    }
}

/* ---- section 3.3: grow the blade, place the sources ---- */

static void grow_blade(Plain *w)
{
    bool grows = w->blade->step < w->blade->last_step;
    blade_advance(w->blade);
    if (!grows || !w->blade->moving)
        return;
    for (uint32_t v = 0; v < w->n; v++)
        w->pos[v] = blade_place(w->blade, w->material[v]);
    for (uint32_t k = 0; k < w->n_auxin; k++) {
        w->auxin[k].p = blade_place(w->blade, w->auxin[k].material);
        renew(w, &w->auxin[k], true);
    }
}

static void add_auxin(Plain *w, Vec2 p)
{
    w->auxin = g_renew(Auxin, w->auxin, w->n_auxin + 1);
    Auxin *a = &w->auxin[w->n_auxin++];
    *a = (Auxin){.p = p, .material = w->blade->moving ? blade_material(w->blade, p) : p, .birth = w->blade->step};
    renew(w, a, true);
    w->counts.placed++;
}

static bool auxin_within(const Plain *w, Vec2 p, double r)
{
    for (uint32_t k = 0; k < w->n_auxin; k++)
        if (far2(w->auxin[k].p, p) < r * r)
            return true;
    return false;
}

static double clearance(const Plain *w)
{
    return MAX(w->def->birth_distance_veins, w->def->kill_distance) * w->blade->unit;
}

static void throw_darts(Plain *w)
{
    if (w->def->only_while_growing && w->blade->step > MAX(w->blade->last_step, 1))
        return;
    w->carry += w->def->density * w->blade->area;
    uint64_t n = (uint64_t)w->carry;
    w->carry -= (double)n;
    w->counts.darts += n;
    for (uint64_t i = 0; i < n; i++)
        for (uint64_t try = 0; try < 256; try++) {
            double u[2];
            Box2 b = w->blade->box;
            random_pair(w->def->seed, RANDOM_DART, w->blade->step, i * 256 + try, u);
            Vec2 p = vec2(b.x0 + u[0] * (b.x1 - b.x0), b.y0 + u[1] * (b.y1 - b.y0));
            if (!blade_contains(w->blade, p))
                continue;
            if (!auxin_within(w, p, w->def->birth_distance_sources * w->blade->unit) &&
                !node_within(w, p, clearance(w)))
                add_auxin(w, p);
            break;
        }
}

static void place_waiting(Plain *w)
{
    bool list = w->def->placement == PLACEMENT_LIST;
    for (uint32_t i = 0; i < w->n_waiting; i++) {
        if (w->gone[i] || w->waiting[i].step > w->blade->step)
            continue;
        Vec2 p = w->waiting[i].pos;
        if (list && !w->blade->moving)
            p = vec_scale(p, w->blade->unit);
        if (!blade_contains(w->blade, p) && w->blade->step < w->blade->last_step)
            continue;
        w->gone[i] = true;
        if (list || !node_within(w, p, clearance(w)))
            add_auxin(w, p);
    }
}

/* ---- develop the veins ---- */

static bool try_child(Plain *w, uint32_t v, Vec2 towards)
{
    double unit = w->blade->unit;
    Vec2 p = vec_add(w->pos[v], vec_scale(towards, unit / sqrt(vec_norm2(towards))));
    if (node_within(w, p, 0.1 * unit) || !blade_admits(w->blade, p))
        return false;
    add_node(w, p, w->blade->moving ? blade_material(w->blade, p) : p, v);
    w->n_fresh++;
    return true;
}

static bool pulls(const Plain *w, const Auxin *a, const Member *m)
{
    return !m->spent && !(a->reached && (!m->tagged || killed(w, a, m->node)));
}

/* So that the order of the pulls does not matter. */
static double on_grid(double x)
{
    const double parts = 536870912.0; /* 2^29 */
    return rint(x * parts) / parts;
}

/* One pull: who at which member. */
typedef struct {
    uint32_t auxin, member, node;
} Tug;

static void grow_towards_one(Plain *w, const Tug *tug, uint32_t n, uint32_t v)
{
    for (;;) {
        Member *best = NULL;
        const Auxin *by = NULL;
        for (uint32_t k = 0; k < n; k++) {
            Auxin *a = &w->auxin[tug[k].auxin];
            Member *m = &a->member[tug[k].member];
            if (tug[k].node == v && !m->spent && (!best || far2(w->pos[v], a->p) < far2(w->pos[v], by->p))) {
                best = m;
                by = a;
            }
        }
        if (!best || try_child(w, v, vec_sub(by->p, w->pos[v])))
            return;
        best->spent = true;
    }
}

static void develop(Plain *w)
{
    Tug *tug = g_new(Tug, w->n_auxin * MOST + 1);
    uint32_t n = 0, old_nodes = w->n;
    w->live = w->n_fresh = 0;
    for (uint32_t k = 0; k < w->n_auxin; k++) {
        const Auxin *a = &w->auxin[k];
        bool any = false;
        for (uint32_t i = 0; i < a->n; i++) {
            if (!pulls(w, a, &a->member[i]))
                continue;
            any = true;
            if (far2(a->p, w->pos[a->member[i].node]) > 0.0)
                tug[n++] = (Tug){k, i, a->member[i].node};
        }
        w->live += any;
    }
    for (uint32_t v = 0; v < old_nodes; v++) {
        uint32_t count = 0;
        Vec2 sum = vec2(0, 0);
        for (uint32_t j = 0; j < n; j++)
            if (tug[j].node == v) {
                Vec2 d = vec_sub(w->auxin[tug[j].auxin].p, w->pos[v]);
                double scale = 1.0 / sqrt(vec_norm2(d));
                sum = vec_add(sum, vec2(on_grid(d.x * scale), on_grid(d.y * scale)));
                count++;
            }
        bool cancelled = vec_norm2(sum) < 1e-12 * (double)count * (double)count;
        if (count && (cancelled || !try_child(w, v, sum)))
            grow_towards_one(w, tug, n, v);
    }
    g_free(tug);
    for (uint32_t k = 0; w->n > old_nodes && k < w->n_auxin; k++)
        renew(w, &w->auxin[k], false);
}

/* ---- remove the sources ---- */

static bool parent_and_child(const Plain *w, uint32_t a, uint32_t b) { return w->parent[a] == b || w->parent[b] == a || a == b; }

static void join_arrived(Plain *w, const Auxin *a)
{
    double most = w->def->join_distance * w->blade->unit;
    for (uint32_t i = 1; i < a->n_arrived; i++) {
        uint32_t u = a->arrived[0], v = a->arrived[i];
        if (far2(w->pos[u], w->pos[v]) > most * most || parent_and_child(w, u, v))
            continue;
        bool joined = false;
        for (uint32_t j = 0; j < w->n_joins; j++)
            joined |= w->join[3 * j] == MIN(u, v) && w->join[3 * j + 1] == MAX(u, v);
        if (joined)
            continue;
        w->join = g_renew(uint32_t, w->join, 3 * (w->n_joins + 1));
        w->join[3 * w->n_joins] = MIN(u, v);
        w->join[3 * w->n_joins + 1] = MAX(u, v);
        w->join[3 * w->n_joins++ + 2] = w->blade->step;
    }
}

static bool finished(Plain *w, Auxin *a)
{
    bool within = false, waiting = false;
    for (uint32_t i = 0; i < a->n; i++)
        within |= killed(w, a, a->member[i].node);
    if (w->def->pattern == PATTERN_OPEN)
        return within;
    if (!a->reached && !within)
        return false;
    for (uint32_t i = 0; i < a->n && !a->reached; i++)
        a->member[i].tagged = true;
    a->reached = true;
    for (uint32_t i = 0; i < a->n; i++) {
        Member *m = &a->member[i];
        if (m->tagged && killed(w, a, m->node)) {
            m->tagged = false;
            if (a->n_arrived < 6)
                a->arrived[a->n_arrived++] = m->node;
        } else {
            waiting |= m->tagged && !m->spent;
        }
    }
    if (!waiting)
        join_arrived(w, a);
    return !waiting;
}

static void remove_auxins(Plain *w)
{
    for (uint32_t k = 0; k < w->n_auxin;) {
        if (!finished(w, &w->auxin[k])) {
            k++;
            continue;
        }
        w->counts.reached++;
        w->auxin[k] = w->auxin[--w->n_auxin];
    }
}

/* ---- the run ---- */

static bool any_waiting(const Plain *w)
{
    for (uint32_t i = 0; i < w->n_waiting; i++)
        if (!w->gone[i])
            return true;
    return false;
}

static EndReason judge(const Plain *w)
{
    if (w->def->max_steps && w->blade->step >= w->def->max_steps)
        return END_MAX_STEPS;
    if (w->blade->step < w->blade->last_step || any_waiting(w))
        return END_RUNNING;
    if (w->n_auxin == 0)
        return END_NO_SOURCES;
    return w->live == 0 && w->n_fresh == 0 ? END_UNREACHED : END_RUNNING;
}

/* The set for a growing margin: kept apart by b_s, each with the first step at which the blade holds it. */
static void prepare_margin(Plain *w)
{
    Box2 b = w->blade->widest;
    double final = blade_scale_at(w->blade, w->blade->last_step);
    w->counts.darts = (uint64_t)(w->def->density * (b.x1 - b.x0) * (b.y1 - b.y0));
    w->waiting = g_new(ListedSource, w->counts.darts + 1);
    for (uint64_t i = 0; i < w->counts.darts; i++) {
        double u[2], r = w->def->birth_distance_sources;
        random_pair(w->def->seed, RANDOM_MARGIN, 0, i, u);
        ListedSource s = {{b.x0 + u[0] * (b.x1 - b.x0), b.y0 + u[1] * (b.y1 - b.y0)}, 0};
        bool free = polygon_contains(w->def->leaf, vec_scale(s.pos, 1.0 / final));
        for (uint32_t k = 0; k < w->n_waiting && free; k++)
            free = !(far2(w->waiting[k].pos, s.pos) < r * r);
        if (!free)
            continue;
        while (s.step < w->blade->last_step &&
               !polygon_contains(w->def->leaf, vec_scale(s.pos, 1.0 / blade_scale_at(w->blade, s.step))))
            s.step++;
        w->waiting[w->n_waiting++] = s;
    }
}

/* Stable, by step. */
static void sort_waiting(Plain *w)
{
    for (uint32_t i = 1; i < w->n_waiting; i++) {
        ListedSource s = w->waiting[i];
        uint32_t j = i;
        for (; j && s.step < w->waiting[j - 1].step; j--)
            w->waiting[j] = w->waiting[j - 1];
        w->waiting[j] = s;
    }
}

static void set_up(Plain *w, const SimulationDef *def)
{
    *w = (Plain){
        .def = def, .blade = blade_new(def->leaf, &def->growth, NULL), .reach = reach_new(def->leaf, def->sinus_depth)};
    if (reach_is_trivial(w->reach)) {
        reach_free(w->reach);
        w->reach = NULL;
    }
    for (uint32_t i = 0; i < def->n_seeds; i++) {
        Vec2 m = vec_scale(def->seeds[i], def->growth.initial_length);
        add_node(w, blade_place(w->blade, m), m, NONE);
    }
    if (def->placement == PLACEMENT_LIST) {
        w->waiting = g_memdup2(def->list, sizeof *def->list * def->n_list);
        w->n_waiting = def->n_list;
    } else if (def->placement == PLACEMENT_MARGIN) {
        prepare_margin(w);
    }
    sort_waiting(w);
    w->gone = g_new0(bool, w->n_waiting + 1);
}

static Network *graph(const Plain *w)
{
    uint32_t e = 0;
    for (uint32_t v = 0; v < w->n; v++)
        e += w->parent[v] != NONE;
    Network *net = network_new(w->n, e + w->n_joins);
    double k = w->blade->moving ? 1.0 : 1.0 / w->blade->unit;
    e = 0;
    for (uint32_t v = 0; v < w->n; v++) {
        net->node[v] = vec_scale(w->pos[v], k);
        net->node_birth[v] = w->birth[v];
        if (w->parent[v] != NONE) {
            net->tail[e] = w->parent[v];
            net->head[e] = v;
            net->kind[e] = EDGE_VEIN;
            net->birth[e++] = w->birth[v];
        }
    }
    for (uint32_t j = 0; j < w->n_joins; j++, e++) {
        net->tail[e] = w->join[3 * j];
        net->head[e] = w->join[3 * j + 1];
        net->kind[e] = EDGE_ANASTOMOSIS;
        net->birth[e] = w->join[3 * j + 2];
    }
    Polygon *outline = blade_outline(w->blade);
    for (uint32_t i = 0; i < outline->n; i++)
        outline->v[i] = vec_scale(outline->v[i], k);
    net->margin = polygon_new(outline->v, outline->n);
    polygon_free(outline);
    net->n_steps = w->blade->step;
    return net;
}

Network *plain_grow(const SimulationDef *def, SimulationCounts *counts)
{
    Plain w;
    set_up(&w, def);
    do {
        grow_blade(&w);
        if (def->placement == PLACEMENT_DARTS)
            throw_darts(&w);
        else
            place_waiting(&w);
        w.counts.most_sources = MAX(w.counts.most_sources, w.n_auxin);
        develop(&w);
        remove_auxins(&w);
        w.counts.end = judge(&w);
        w.counts.updates += (uint64_t)w.n_auxin * w.n;
    } while (w.counts.end == END_RUNNING);
    w.counts.step = w.blade->step;
    w.counts.nodes = w.n;
    w.counts.joins = w.n_joins;
    w.counts.sources = w.n_auxin;
    w.counts.given_up = w.n_auxin;
    *counts = w.counts;
    Network *net = graph(&w);
    reach_free(w.reach);
    blade_free(w.blade);
    g_free(w.pos);
    g_free(w.material);
    g_free(w.parent);
    g_free(w.birth);
    g_free(w.join);
    g_free(w.auxin);
    g_free(w.waiting);
    g_free(w.gone);
    return net;
}
