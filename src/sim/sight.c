/* Which of a step's nodes can concern a crowd of sources: from all nodes to those of a square of crowds, from these to those of a crowd. */
#include <string.h>

#include "sim/state.h"

/* As many are gone through one after the other; of more, the tree says which. */
enum { FRESH_LIST = 1024 };

void fresh_prepare(Simulation *s)
{
    Points *p = &s->fresh_points;
    bool listed = s->n_fresh <= FRESH_LIST;
    p->n = listed ? s->n_fresh : 0;
    if (!listed || s->def.pattern == PATTERN_CLOSED) /* whose sources look at them in many ways */
        boxtree_build(&s->fresh_tree, s->veins.pos, s->fresh, s->n_fresh);
    if (!p->v) {
        p->v = g_new(uint32_t, points_room(FRESH_LIST));
        p->x = g_new(double, points_room(FRESH_LIST));
        p->y = g_new(double, points_room(FRESH_LIST));
    }
    memcpy(p->v, s->fresh, sizeof *p->v * p->n);
    points_fill(p, s->veins.pos);
}

/* Fresh nodes that may be nearest to a place in the box: most of those that are not are gone. More than POINTS_MOST: too many. */
static uint32_t nearest_to(const Simulation *s, Box2 box, double bound2, Points *out)
{
    if (s->n_fresh <= FRESH_LIST)
        return points_nearest_to(&s->fresh_points, box, bound2, out);
    uint32_t n = boxtree_near(&s->fresh_tree, s->veins.pos, box, bound2, out->v, POINTS_MOST);
    if (n > POINTS_MOST)
        return n;
    out->n = n;
    boxtree_sort(out->v, n);
    points_fill(out, s->veins.pos);
    return points_nearest_to(out, box, bound2, out);
}

void fresh_nearest(const Simulation *s, const Field *f, Vec2 p, uint32_t *near, double *near2)
{
    const Points *fresh = &s->fresh_points;
    if (s->n_fresh > FRESH_LIST) {
        boxtree_nearest(&s->fresh_tree, f->pos, p, f->sees, f->user, near, near2);
    } else if (!f->sees) {
        points_nearest(fresh, p, near, near2);
    } else {
        for (uint32_t i = 0; i < fresh->n; i++) {
            double d2 = vec_dist2(p, vec2(fresh->x[i], fresh->y[i]));
            if (d2 < *near2 && f->sees(f->user, fresh->v[i])) {
                *near = fresh->v[i];
                *near2 = d2;
            }
        }
    }
}

/* With some of them the nearest: those of the others that may matter all the same. */
static uint32_t rivals(const Simulation *s, Box2 box, const Points *near, Points *out, uint32_t cap)
{
    bool nearest_alone = s->reach != NULL;
    if (s->n_fresh <= FRESH_LIST)
        return points_rivals(&s->fresh_points, box, near, nearest_alone, out, cap);
    return boxtree_rivals(&s->fresh_tree, s->veins.pos, box, near, nearest_alone, out, cap);
}

/* ---- squares ---- */

static Points few_points(Few *f) { return (Points){f->n, f->v, f->x, f->y}; }

void square_prepare(const Simulation *s, const Unit *u, Square *q)
{
    enum { FEWER = 32 };
    Box2 place = box_empty();
    double most2 = -1.0;
    uint32_t plain = 0;
    for (uint32_t i = u->first_crowd; i < u->last_crowd; i++) {
        const Crowd *c = &s->crowds.crowd[i];
        if (c->most2 < 0.0)
            continue;
        place = box_union(place, c->place);
        most2 = MAX(most2, c->most2);
        plain += c->plain;
    }
    q->n_rivals = 0;
    q->n_nearest = POINTS_MOST + 1; /* each crowd for itself */
    if (plain < FEWER)
        return;
    Points near = {0, q->nearest.v, q->nearest.x, q->nearest.y}, rival = {0, q->rival.v, q->rival.x, q->rival.y};
    q->n_nearest = nearest_to(s, place, most2, &near);
    if (s->def.pattern == PATTERN_CLOSED && q->n_nearest && q->n_nearest <= POINTS_MOST)
        q->n_rivals = rivals(s, place, &near, &rival, POINTS_MOST);
}

/* ---- crowds ---- */

/* The nearest once more, as a closed pattern compares them with what its sources have. */
static void sight_kin(const Simulation *s, Sight *sight)
{
    const Few *nearest = &sight->nearest;
    const Vec2 *pos = s->veins.pos;
    bool open = s->def.pattern == PATTERN_OPEN;
    for (uint32_t j = 0; j < nearest->n; j++) {
        uint32_t v = nearest->v[j], parent = s->veins.parent[v];
        sight->kin[j] = v;
        if (open)
            continue;
        sight->stride2[j] = parent == NO_POINT ? HUGE_VAL : vec_dist2(pos[v], pos[parent]);
        sight->kin[j] |= (int64_t)(parent == NO_POINT ? 0 : parent) << 32;
    }
}

uint32_t crowd_sole(const Simulation *s, const Crowd *c, Square *q)
{
    if (!q || q->n_nearest > POINTS_MOST)
        return s->n_fresh <= FRESH_LIST ? points_sole(&s->fresh_points, c->place) : NO_POINT;
    Points listed = {q->n_nearest, q->nearest.v, q->nearest.x, q->nearest.y};
    return points_sole(&listed, c->place);
}

/* Rivals of the nearest ones in sight; more than FEW: too many. */
static uint32_t sight_rivals(const Simulation *s, const Crowd *c, Square *q, Sight *sight)
{
    Points near = few_points(&sight->nearest), far = few_points(&sight->rival);
    if (!q || q->n_nearest > POINTS_MOST || q->n_rivals > POINTS_MOST)
        return rivals(s, c->place, &near, &far, FEW);
    Points listed = {q->n_rivals, q->rival.v, q->rival.x, q->rival.y};
    return points_rivals(&listed, c->place, &near, s->reach != NULL, &far, FEW);
}

bool crowd_has_rivals(const Simulation *s, const Crowd *c, Square *q, uint32_t node, Sight *sight)
{
    Few *nearest = &sight->nearest;
    nearest->n = 1;
    nearest->v[0] = node;
    nearest->x[0] = s->veins.pos[node].x;
    nearest->y[0] = s->veins.pos[node].y;
    return sight_rivals(s, c, q, sight) > 0;
}

bool crowd_sight(const Simulation *s, const Crowd *c, Square *q, Sight *sight)
{
    Few *nearest = &sight->nearest, *rival = &sight->rival;
    nearest->n = rival->n = 0;
    Points near = few_points(nearest);
    bool listed = q && q->n_nearest <= POINTS_MOST;
    Points listed_near = listed ? (Points){q->n_nearest, q->nearest.v, q->nearest.x, q->nearest.y} : near;
    uint32_t n = listed ? points_nearest_to(&listed_near, c->place, c->most2, &near) : nearest_to(s, c->place, c->most2, &near);
    if (n > POINTS_MOST)
        return false;
    nearest->n = n;
    sight_kin(s, sight);
    if (s->def.pattern == PATTERN_OPEN || n == 0)
        return true;
    n = sight_rivals(s, c, q, sight);
    if (n > FEW)
        return false;
    rival->n = n;
    for (uint32_t j = 0; j < rival->n; j++)
        for (uint32_t i = 0; i < MIN(nearest->n, SIGHT_GUARDS); i++)
            sight->apart2[j][i] = vec_dist2(vec2(nearest->x[i], nearest->y[i]), vec2(rival->x[j], rival->y[j]));
    return true;
}
