#include "shape/skeleton_lay.h"

#include "geom/simplify.h"

/* Shortest edge of a simplified vein; as part of the clearance. */
static const double short_part = 0.5;
/* An end that turns aside is a hook when it is at most this long; as part of the clearance. */
static const double hook_part = 5.0;
/* How far a tip may be led on to the margin; as part of the clearance. */
static const double tip_part = 2.0;
/* How far a tip may turn aside to end at a vertex of the outline; as part of its last edge. */
static const double tip_bend = 0.3;

/* A point of the simplified trail. */
typedef struct {
    Vec2 at;
    double along, width;
} Mark;

void laying_init(Laying *l, Ground *ground, const Trails *trails, const bool *must, const SkeletonDef *def)
{
    double clear = ground->limits.clear, shortest = short_part * clear;
    *l = (Laying){.ground = ground, .trails = trails, .must = must, .tolerance = def->tolerance, .shortest = shortest, .hook = hook_part * clear};
    l->spacing = def->spacing > 0.0 ? MAX(def->spacing, 2.0 * shortest) : 0.0;
    l->knot = g_array_new(FALSE, FALSE, sizeof(Knot));
    l->mark = g_array_new(FALSE, FALSE, sizeof(Mark));
    l->raw = g_array_new(FALSE, FALSE, sizeof(Vec2));
    l->flag = g_array_new(FALSE, FALSE, sizeof(bool));
    l->keep = g_array_new(FALSE, FALSE, sizeof(uint32_t));
}

void laying_clear(Laying *l)
{
    g_array_free(l->knot, TRUE);
    g_array_free(l->mark, TRUE);
    g_array_free(l->raw, TRUE);
    g_array_free(l->flag, TRUE);
    g_array_free(l->keep, TRUE);
}

/* ---- simplifying a trail ---- */

/* The start and the trail's points from `from` on. */
static void take_raw(Laying *l, const Trail *t, Vec2 start, uint32_t from, bool fixed)
{
    const bool no = false;
    g_array_set_size(l->raw, 0);
    g_array_set_size(l->flag, 0);
    g_array_append_val(l->raw, start);
    g_array_append_val(l->flag, no);
    g_array_append_vals(l->raw, l->trails->point + t->first + from, t->n - from);
    g_array_append_vals(l->flag, l->must + t->first + from, t->n - from);
    g_array_index(l->flag, bool, 1) |= fixed;
    g_array_set_size(l->keep, l->raw->len);
}

/* Leaves out kept points that are nearer than `shortest` to the one before, a branch node rather last. keep[kept]; returns how many stay. */
static uint32_t thin(const Laying *l, uint32_t *keep, uint32_t kept)
{
    const Vec2 *p = (const Vec2 *)(void *)l->raw->data;
    const bool *must = (const bool *)(void *)l->flag->data;
    double least2 = l->shortest * l->shortest;
    uint32_t n = 1;
    for (uint32_t k = 1; k < kept; k++) {
        bool worth_more = must[keep[k]] || k + 1 == kept; /* a branch node or the tip */
        if (vec_dist2(p[keep[k]], p[keep[n - 1]]) >= least2)
            keep[n++] = keep[k];
        else if (n > 1 && worth_more && !must[keep[n - 1]] && vec_dist2(p[keep[k]], p[keep[n - 2]]) >= least2)
            keep[n - 1] = keep[k];
    }
    return n;
}

/* Leaves off a hook: a short end that turns aside by more than 45°, as veins grow that chase the last auxin sources. Not where a branch
 * leaves it. */
static uint32_t unhook(const Laying *l, const uint32_t *keep, uint32_t n)
{
    const Vec2 *p = (const Vec2 *)(void *)l->raw->data;
    uint32_t end = n - 1;
    for (uint32_t k = end; k-- > 1 && vec_dist(p[keep[k]], p[keep[n - 1]]) <= l->hook;) {
        if (g_array_index(l->flag, bool, keep[k + 1]))
            break;
        Vec2 before = vec_sub(p[keep[k]], p[keep[k - 1]]), after = vec_sub(p[keep[end]], p[keep[k]]);
        if (vec_dot(before, after) < fabs(vec_cross(before, after)))
            end = k;
    }
    return end + 1;
}

static Mark between(Mark a, Mark b, double t)
{
    return (Mark){vec_lerp(a.at, b.at, t), a.along + (b.along - a.along) * t, a.width + (b.width - a.width) * t};
}

/* How many edges an edge is cut into to keep to the spacing. */
static uint32_t parts_of(const Laying *l, double length)
{
    return l->spacing > 0.0 && length > l->spacing ? (uint32_t)MIN(ceil(length / l->spacing), 1e6) : 1;
}

static void add_mark(Laying *l, Mark m)
{
    Mark last = g_array_index(l->mark, Mark, l->mark->len - 1);
    uint32_t parts = parts_of(l, vec_dist(last.at, m.at));
    for (uint32_t i = 1; i <= parts; i++) {
        Mark next = i == parts ? m : between(last, m, (double)i / (double)parts);
        g_array_append_val(l->mark, next);
    }
}

static void make_marks(Laying *l, const Trail *t, Vec2 start, uint32_t from, bool fixed)
{
    take_raw(l, t, start, from, fixed);
    const Vec2 *raw = (const Vec2 *)(void *)l->raw->data, *point = l->trails->point + t->first;
    const double *along = l->trails->along + t->first, *width = l->trails->width + t->first;
    uint32_t *keep = (uint32_t *)(void *)l->keep->data;
    uint32_t kept = simplify_polyline(raw, l->raw->len, l->tolerance, (const bool *)(void *)l->flag->data, keep);
    kept = thin(l, keep, kept);
    uint32_t n = unhook(l, keep, kept);
    l->left_off = along[from + keep[kept - 1] - 1] - along[from + keep[n - 1] - 1];
    Mark first = {start, MAX(0.0, along[from] - vec_dist(start, point[from])), width[from]};
    g_array_set_size(l->mark, 0);
    g_array_append_val(l->mark, first);
    for (uint32_t k = 1; k < n; k++) {
        uint32_t i = from + keep[k] - 1;
        add_mark(l, (Mark){point[i], along[i], width[i]});
    }
}

/* ---- laying edges ---- */

static void lay(Laying *l, Mark m, const Anchor *tip)
{
    Ground *g = l->ground;
    ground_lay(g, m.at, tip);
    Knot k = {g_array_index(g->node, uint32_t, g->node->len - 1), m.along, m.width};
    g_array_append_val(l->knot, k);
}

static void take_back(Laying *l)
{
    ground_take_back(l->ground);
    g_array_set_size(l->knot, l->knot->len - 1);
}

static Mark last_mark(const Laying *l)
{
    Knot k = g_array_index(l->knot, Knot, l->knot->len - 1);
    return (Mark){ground_end(l->ground), k.along, k.width};
}

void laying_begin(Laying *l, uint32_t owner, Anchor start, Knot first)
{
    l->tied = false;
    g_array_set_size(l->knot, 0);
    ground_begin(l->ground, owner, start);
    first.node = g_array_index(l->ground->node, uint32_t, 0);
    g_array_append_val(l->knot, first);
}

/* ---- tips ---- */

/* Where the ray from u through v meets the margin first, within `reach` of u. */
static bool meet_margin(Ground *g, Vec2 u, Vec2 v, double reach, Anchor *at)
{
    double length = vec_dist(u, v), first = HUGE_VAL;
    if (!(length > 0.0))
        return false;
    Vec2 d = vec_scale(vec_sub(v, u), reach / length);
    uint32_t n;
    const uint32_t *near = field_near(&g->field, u, vec_add(u, d), 0.0, &n);
    for (uint32_t k = 0; k < n; k++) {
        FieldEdge e = field_edge(&g->field, near[k]);
        Vec2 a = ground_at(g, e.a), b = ground_at(g, e.b), w = vec_sub(b, a);
        double c = vec_cross(d, w);
        if (e.owner != MARGIN || c == 0.0)
            continue;
        double t = vec_cross(vec_sub(a, u), w) / c, s = vec_cross(vec_sub(a, u), d) / c;
        if (t > 0.0 && t <= 1.0 && s >= 0.0 && s <= 1.0 && (t < first || (t == first && near[k] < at->edge))) {
            first = t;
            *at = (Anchor){vec_lerp(a, b, s), NONE, near[k]};
        }
    }
    return first < HUGE_VAL;
}

Anchor anchor_to_vertex(const Ground *g, Anchor place, double reach)
{
    FieldEdge e = field_edge(&g->field, place.edge);
    uint32_t best = vec_dist2(ground_at(g, e.b), place.at) < vec_dist2(ground_at(g, e.a), place.at) ? e.b : e.a;
    if (vec_dist2(ground_at(g, best), place.at) < reach * reach)
        return (Anchor){ground_at(g, best), best, NONE};
    return place;
}

/* Lays the last edge to a place on the margin, in parts as others are, if that and its parts keep clear. */
static bool lay_tip(Laying *l, Mark m, Anchor tip)
{
    Mark from = last_mark(l);
    m.at = tip.at;
    uint32_t parts = parts_of(l, vec_dist(from.at, m.at));
    if (ground_clash(l->ground, tip.at, &tip) != HIT_NOTHING)
        return false;
    for (uint32_t i = 1; i < parts; i++)
        if (!ground_free(l->ground, between(from, m, (double)i / (double)parts).at, l->ground->limits.least))
            return false;
    for (uint32_t i = 1; i < parts; i++)
        lay(l, between(from, m, (double)i / (double)parts), NULL);
    l->tip = tip;
    l->tied = true;
    lay(l, m, &l->tip);
    return true;
}

/* Ends the vein on the margin where it heads for, towards mark m, if that is near to `stop`, where it would have to end else, or to where it ends in
 * the network. */
static bool tie_tip(Laying *l, Mark m, Vec2 stop)
{
    Ground *g = l->ground;
    Anchor at = {.edge = NONE};
    double near = tip_part * g->limits.clear, reach = near + MIN(l->left_off, l->hook);
    Mark from = last_mark(l);
    Vec2 u = from.at, end = g_array_index(l->raw, Vec2, l->raw->len - 1);
    if (!meet_margin(g, u, m.at, vec_dist(u, stop) + 3.0 * reach, &at) || (vec_dist(at.at, stop) > reach && vec_dist(at.at, end) > near))
        return false;
    const Anchor choice[3] = {anchor_to_vertex(g, at, MIN(near, tip_bend * vec_dist(u, at.at))), anchor_to_vertex(g, at, 0.25 * near), at};
    for (int back = 0; back < 2; back++) { /* from the last node, or when that stands in the way from the one before */
        for (int k = 0; k < 3; k++)
            if (lay_tip(l, m, choice[k]))
                return true;
        if (back == 1) {
            lay(l, from, NULL);
        } else if (l->knot->len < 3) {
            break;
        } else {
            take_back(l);
        }
    }
    return false;
}

/* The edge to the mark won't do: lays as much of it as will, or ends on the margin if that is what is met. Tells what was met. */
static Hit lay_part(Laying *l, Mark m)
{
    Ground *g = l->ground;
    Mark from = last_mark(l);
    double lo = 0.0, hi = 1.0;
    Hit hit = ground_clash(g, m.at, NULL);
    for (int i = 0; i < 13; i++) {
        double mid = 0.5 * (lo + hi);
        Hit there = ground_clash(g, vec_lerp(from.at, m.at, mid), NULL);
        if (there == HIT_NOTHING) {
            lo = mid;
        } else {
            hi = mid;
            hit = there;
        }
    }
    Mark end = between(from, m, lo);
    if (hit == HIT_MARGIN && tie_tip(l, m, end.at))
        return hit;
    if (lo > 0.0 && vec_dist(from.at, end.at) >= l->shortest)
        lay(l, end, NULL);
    return hit;
}

Hit lay_trail(Laying *l, uint32_t owner, uint32_t trail, Anchor start, uint32_t from, bool fixed)
{
    make_marks(l, &l->trails->trail[trail], start.at, from, fixed);
    Mark first = g_array_index(l->mark, Mark, 0);
    laying_begin(l, owner, start, (Knot){.along = first.along, .width = first.width});
    for (uint32_t i = 1; i < l->mark->len; i++) {
        Mark m = g_array_index(l->mark, Mark, i);
        if (ground_clash(l->ground, m.at, NULL) != HIT_NOTHING)
            return lay_part(l, m);
        lay(l, m, NULL);
    }
    if (l->left_off > 0.0 && l->mark->len > 1) { /* straight on instead of the hook, if that leads to the margin */
        Mark end = g_array_index(l->mark, Mark, l->mark->len - 1), before = g_array_index(l->mark, Mark, l->mark->len - 2);
        Mark on = between(before, end, 2.0);
        on.width = end.width;
        tie_tip(l, on, end.at);
    }
    return HIT_NOTHING;
}
