/* Lays vein sequences one after the other, lower orders and longer veins first, and leaves out what comes too near to what lies already:
 * so whatever the network is like, what is left can be meshed. */
#include "geom/dtrig.h"
#include "geom/segment.h"
#include "shape/skeleton_lay.h"
#include "shape/skeleton_plan.h"

/* A branch that can't be laid from where it leaves is tried again at steps of this up its parent, as part of the clearance … */
static const double step_part = 0.5;
/* … at most so many … */
enum { MAX_STEPS = 40 };
/* … with its first node at one of so many places, a step apart, the farthest that will do. */
enum { MAX_TARGETS = 10 };
/* A stretch of a network's vein counts as free when it keeps this part of the clearance from others: simplifying moves it a little. */
static const double free_part = 0.7;
/* A branch so moved is taken when it is this much longer than unmoved. */
static const double worth_moving = 1.5;

/* A sequence that other veins cut off is kept when so much of it is left. */
static const double stump_part = 1.0 / 3.0;

typedef struct {
    Clearing *c;
    Plan plan;
    Laying laying;
    const Trails *trails;
    double min_length, merge, shortest, step;
    uint32_t *cleared_of; /* [trails] index of the cleared sequence, NONE */
} Job;

/* Lengths by which veins are kept apart in a blade of that size. */
static Limits limits_of(const SkeletonDef *def, double size)
{
    double clear = MAX(def->clearance, 1e-6 * size);
    return (Limits){.clear = clear, .least = 0.3 * clear, .slope = dtrig_sin(CLAMP(def->min_angle, 0.0, 60.0) * DTRIG_DEGREE)};
}

static Cleared *cleared_at(const Job *j, uint32_t i) { return &g_array_index(j->c->cleared, Cleared, i); }

static Knot *knot_at(const Cleared *c, uint32_t i) { return &g_array_index(c->knot, Knot, i); }

/* ---- keeping what was laid ---- */

/* A node that was put on an edge of a cleared vein becomes one of its nodes. */
static void insert_knot(Job *j, Cleared *host, uint32_t node)
{
    const Ground *g = &j->c->ground;
    Vec2 p = ground_at(g, node);
    uint32_t best = 0;
    double nearest = HUGE_VAL, part = 0.0;
    for (uint32_t i = 0; i + 1 < host->knot->len; i++) {
        Vec2 a = ground_at(g, knot_at(host, i)->node), b = ground_at(g, knot_at(host, i + 1)->node);
        double d = segment_dist2(a, b, p);
        if (d < nearest) {
            nearest = d;
            best = i;
            part = segment_nearest(a, b, p);
        }
    }
    Knot a = *knot_at(host, best), b = *knot_at(host, best + 1);
    Knot k = {node, a.along + (b.along - a.along) * part, a.width + (b.width - a.width) * part};
    g_array_insert_val(host->knot, best + 1, k);
}

/* Makes what was laid last a cleared sequence. */
static void commit(Job *j, uint32_t trail, uint32_t parent)
{
    Ground *g = &j->c->ground;
    const GArray *knot = j->laying.knot;
    Cleared c = {trail, parent, g_array_sized_new(FALSE, FALSE, sizeof(Knot), knot->len)};
    bool split = g->start.edge != NONE && parent != NONE;
    g_array_append_vals(c.knot, knot->data, knot->len);
    ground_commit(g, j->laying.tied ? &j->laying.tip : NULL);
    if (split)
        insert_knot(j, cleared_at(j, parent), knot_at(&c, 0)->node);
    j->cleared_of[trail] = j->c->cleared->len;
    g_array_append_val(j->c->cleared, c);
}

/* ---- where sequences begin ---- */

/* The place on a cleared vein that stands for its trail's point p at `along`; false where it was cut off. */
static bool anchor_on(Job *j, const Cleared *host, double along, Vec2 p, Anchor *at)
{
    Ground *g = &j->c->ground;
    uint32_t i = 0, n = host->knot->len, count;
    if (along > knot_at(host, n - 1)->along + j->merge)
        return false;
    while (i + 2 < n && knot_at(host, i + 1)->along <= along)
        i++;
    uint32_t a = knot_at(host, i)->node, b = knot_at(host, i + 1)->node;
    Vec2 u = ground_at(g, a), v = ground_at(g, b), q = vec_lerp(u, v, segment_nearest(u, v, p));
    uint32_t end = vec_dist2(u, q) <= vec_dist2(v, q) ? a : b;
    *at = (Anchor){ground_at(g, end), end, NONE};
    if (vec_dist2(q, at->at) < j->merge * j->merge)
        return end == a || !ground_on_margin(g, b); /* not from a tip on the margin */
    const uint32_t *near = field_near(&g->field, q, q, g->limits.least, &count);
    for (uint32_t k = 0; k < count; k++) {
        FieldEdge e = field_edge(&g->field, near[k]);
        if (e.owner != MARGIN && e.a == a && e.b == b) {
            *at = (Anchor){q, NONE, near[k]};
            return true;
        }
    }
    return false;
}

/* The first cleared sequence whose first node is near to where a primary begins; NONE. */
static uint32_t neighbour_of_root(const Job *j, Vec2 root)
{
    for (uint32_t i = 0; i < j->c->cleared->len; i++) {
        const Cleared *c = cleared_at(j, i);
        if (c->parent == NONE && vec_dist2(ground_at(&j->c->ground, knot_at(c, 0)->node), root) < j->merge * j->merge)
            return i;
    }
    return NONE;
}

/* The first node of a primary: that of another primary that is near, or a place on the outline, or free within the blade. */
static bool anchor_root(Job *j, const Root *r, uint32_t neighbour, Anchor *at)
{
    Ground *g = &j->c->ground;
    double nearest = HUGE_VAL;
    uint32_t n;
    *at = (Anchor){r->at, NONE, NONE};
    if (neighbour != NONE) {
        uint32_t node = knot_at(cleared_at(j, neighbour), 0)->node;
        *at = (Anchor){ground_at(g, node), node, NONE};
        return true;
    }
    if (!r->on_margin)
        return polygon_contains(j->c->outline, r->at);
    const uint32_t *near = field_near(&g->field, r->at, r->at, 2.0 * g->limits.clear, &n);
    for (uint32_t k = 0; k < n; k++) {
        FieldEdge e = field_edge(&g->field, near[k]);
        Vec2 a = ground_at(g, e.a), b = ground_at(g, e.b);
        double t = segment_nearest(a, b, r->at);
        Vec2 q = t == 1.0 ? b : vec_lerp(a, b, t);
        double d = vec_dist2(q, r->at);
        if (e.owner == MARGIN && (d < nearest || (d == nearest && near[k] < at->edge))) {
            nearest = d;
            *at = (Anchor){q, NONE, near[k]};
        }
    }
    if (at->edge == NONE)
        return false;
    *at = anchor_to_vertex(g, *at, g->limits.least);
    return true;
}

/* First point of the trail from `from` on that is farther from p than the shortest edge. */
static uint32_t first_beyond(const Job *j, const Trail *t, uint32_t from, Vec2 p)
{
    uint32_t i = from;
    while (i + 1 < t->n && vec_dist2(j->trails->point[t->first + i], p) < j->shortest * j->shortest)
        i++;
    return i;
}

/* ---- moving a branch up its parent ---- */

/* A way from b to a point of the trail that keeps clear: of the points up to MAX_TARGETS steps beyond the one nearest to b (from *near on), the last
 * that will do; NONE. */
static uint32_t find_target(Job *j, const Trail *t, Anchor b, uint32_t *near)
{
    const Vec2 *p = j->trails->point + t->first;
    const double *along = j->trails->along + t->first;
    double start = along[*near];
    for (uint32_t i = *near; i < t->n && along[i] < start + 8.0 * j->step; i++)
        if (vec_dist2(p[i], b.at) < vec_dist2(p[*near], b.at))
            *near = i;
    uint32_t target[MAX_TARGETS], n = 0;
    for (uint32_t i = *near; i < t->n && n < MAX_TARGETS; i++)
        if (along[i] >= along[*near] + (double)n * j->step)
            target[n++] = i;
    laying_begin(&j->laying, j->c->cleared->len, b, (Knot){.node = NONE});
    while (n-- > 0)
        if (vec_dist(p[target[n]], b.at) >= j->shortest && ground_clash(&j->c->ground, p[target[n]], NULL) == HIT_NOTHING)
            return target[n];
    return NONE;
}

/* The trail's first stretch that is clear of what lies already and at least as long as a sequence: whether there is one, and its first point. */
static bool free_stretch(Job *j, const Trail *t, uint32_t from, uint32_t *first)
{
    const Vec2 *p = j->trails->point + t->first;
    const double *along = j->trails->along + t->first;
    double reach = free_part * j->c->ground.limits.clear, next = along[from];
    *first = from;
    for (uint32_t i = from; i < t->n; i++) {
        if (along[i] < next)
            continue;
        next = along[i] + j->step;
        if (!ground_free(&j->c->ground, p[i], reach))
            *first = i + 1;
        else if (along[i] - along[*first] >= j->min_length)
            return true;
    }
    return false;
}

static bool same_anchor(Anchor a, Anchor b) { return a.node == b.node && a.edge == b.edge && a.at.x == b.at.x && a.at.y == b.at.y; }

/* Tries to lay the trail from places up its host, from `along` of the host's trail on; it must become at least `least` long. */
static bool lay_moved(Job *j, uint32_t trail, const Cleared *host, double along, uint32_t from, double least)
{
    const Trail *t = &j->trails->trail[trail], *h = &j->trails->trail[host->trail];
    const double *way = j->trails->along + h->first;
    Anchor before = {.node = NONE, .edge = NONE}, at;
    uint32_t point = 0, near = from, stretch;
    if (!free_stretch(j, t, from, &stretch))
        return false;
    Vec2 aim = j->trails->point[t->first + stretch];
    for (uint32_t s = 1; s <= MAX_STEPS && (double)s * j->step < 0.5 * t->length; s++) {
        double here = along + (double)s * j->step;
        while (point + 1 < h->n && way[point] < here)
            point++;
        if (way[point] < here || !anchor_on(j, host, here, j->trails->point[h->first + point], &at))
            return false;
        if (same_anchor(at, before) || vec_dist(at.at, aim) > (MAX_TARGETS + 2) * j->step)
            continue;
        before = at;
        uint32_t target = find_target(j, t, at, &near);
        if (target == NONE)
            continue;
        lay_trail(&j->laying, j->c->cleared->len, trail, at, target, true);
        if (ground_length(&j->c->ground) >= least)
            return true;
    }
    return false;
}

static void clear_trail(Job *j, uint32_t trail)
{
    const Trail *t = &j->trails->trail[trail];
    uint32_t parent = NONE, host, from = 1, owner = j->c->cleared->len;
    double along = 0.0;
    Anchor start;
    if (t->parent != NONE) {
        const Trail *p = &j->trails->trail[t->parent];
        host = parent = j->cleared_of[t->parent];
        along = j->trails->along[p->first + t->leaves];
        if (parent == NONE || !anchor_on(j, cleared_at(j, parent), along, j->trails->point[p->first + t->leaves], &start))
            return;
    } else { /* a primary that can't stand beside another may leave that */
        const Root *r = &j->plan.root[trail];
        from = r->from;
        host = neighbour_of_root(j, r->at);
        if (r->outside || !anchor_root(j, r, host, &start))
            return;
    }
    uint32_t first = first_beyond(j, t, from, start.at);
    Hit hit = lay_trail(&j->laying, owner, trail, start, first, false);
    double length = ground_length(&j->c->ground), enough = j->min_length;
    if (hit == HIT_VEIN) {
        enough = MAX(enough, stump_part * t->length);
        if (host != NONE && lay_moved(j, trail, cleared_at(j, host), along, from, MAX(enough, worth_moving * length)))
            parent = host;
        else
            lay_trail(&j->laying, owner, trail, start, first, false);
    }
    if (j->laying.knot->len >= 2 && ground_length(&j->c->ground) >= enough)
        commit(j, trail, parent);
}

/* ---- the whole ---- */

static void clearing_reset(Clearing *c)
{
    for (uint32_t i = 0; i < c->cleared->len; i++)
        g_array_free(g_array_index(c->cleared, Cleared, i).knot, TRUE);
    g_array_set_size(c->cleared, 0);
    if (c->outline)
        ground_clear(&c->ground);
    g_clear_pointer(&c->outline, polygon_free);
}

void clearing_free(Clearing *c)
{
    if (!c)
        return;
    clearing_reset(c);
    g_array_free(c->cleared, TRUE);
    g_free(c);
}

static bool clear_round(Job *j, const Polygon *margin, const SkeletonDef *def, Limits limits, GError **error)
{
    Clearing *c = j->c;
    Vec2 base = margin->v[0];
    clearing_reset(c);
    GArray *root = plan_roots(&j->plan, &base);
    c->outline = outline_simplify(margin, base, (const Vec2 *)(void *)root->data, root->len, def->tolerance, limits.least, error);
    g_array_free(root, TRUE);
    if (!c->outline)
        return false;
    ground_init(&c->ground, c->outline, limits);
    plan_branches(&j->plan);
    laying_init(&j->laying, &c->ground, j->trails, j->plan.must, def);
    j->shortest = j->laying.shortest;
    for (uint32_t i = 0; i < j->trails->n; i++)
        j->cleared_of[i] = NONE;
    for (uint32_t k = 0; k < j->trails->n; k++)
        if (j->plan.wanted[j->plan.rank[k]])
            clear_trail(j, j->plan.rank[k]);
    ground_begin(&c->ground, 0, (Anchor){.node = 0, .edge = NONE}); /* takes back what did not come to stay */
    laying_clear(&j->laying);
    return true;
}

Clearing *clearing_new(const Trails *trails, const Polygon *margin, const SkeletonDef *def, GError **error)
{
    Limits limits = limits_of(def, MAX(margin->box.x1 - margin->box.x0, margin->box.y1 - margin->box.y0));
    Clearing *c = g_new0(Clearing, 1);
    c->cleared = g_array_new(FALSE, FALSE, sizeof(Cleared));
    Job j = {.c = c, .trails = trails, .min_length = def->min_length, .merge = limits.clear, .step = step_part * limits.clear,
             .cleared_of = g_new(uint32_t, trails->n)};
    plan_init(&j.plan, trails, margin, &limits);
    bool ok = clear_round(&j, margin, def, limits, error);
    if (ok) { /* once more, with nodes only where there are branches */
        plan_learn(&j.plan, c->cleared);
        ok = clear_round(&j, margin, def, limits, error);
    }
    plan_clear(&j.plan);
    g_free(j.cleared_of);
    if (!ok)
        g_clear_pointer(&c, clearing_free);
    return c;
}
