#include "shape/solid_cut.h"

#include <glib.h>

/* A part of a tube: from one ball to another, or to a place between two. */
typedef struct {
    double from, to; /* in balls: 1.5 lies in the middle between ball 1 and ball 2 */
} Run;

static const double least_part = 1e-3; /* segments */

/* What lies in no hole, of the tube between balls. */
static void find_runs(const Tube *t, const HoleRings *rings, GArray *run)
{
    GArray *part = g_array_new(FALSE, FALSE, sizeof(Stretch));
    for (uint32_t i = 0; i + 1 < t->n; i++) {
        g_array_set_size(part, 0);
        if (i < t->petiole)
            g_array_append_val(part, ((Stretch){0.0, 1.0}));
        else
            hole_rings_outside(rings, t->rest[i], t->rest[i + 1], least_part, part);
        for (guint k = 0; k < part->len; k++) {
            const Stretch *s = &g_array_index(part, Stretch, k);
            Run r = {i + s->from, i + s->to}, *last = run->len ? &g_array_index(run, Run, run->len - 1) : NULL;
            if (last && last->to == r.from)
                last->to = r.to;
            else
                g_array_append_val(run, r);
        }
    }
    g_array_unref(part);
}

static void set_ball(Tube *out, uint32_t i, const Tube *t, double at)
{
    uint32_t a = MIN((uint32_t)at, t->n - 1), b = MIN(a + 1, t->n - 1);
    double f = at - a;
    out->centre[i] = vec3_lerp(t->centre[a], t->centre[b], f);
    out->rest[i] = vec_lerp(t->rest[a], t->rest[b], f);
    out->radius[i] = t->radius[a] + f * (t->radius[b] - t->radius[a]);
    out->node[i] = t->node[f < 0.5 ? a : b];
}

static Tube take_run(const Tube *t, Run r, const Vec3 *normal)
{
    uint32_t first = (uint32_t)floor(r.from) + 1, end = (uint32_t)ceil(r.to), n = 2 + end - first; /* balls first … end - 1 lie between the ends */
    Tube out = {.sequence = t->sequence, .n = n, .centre = g_new(Vec3, n), .rest = g_new(Vec2, n), .radius = g_new(double, n), .node = g_new(uint32_t, n)};
    set_ball(&out, 0, t, r.from);
    for (uint32_t i = first; i < end; i++)
        set_ball(&out, 1 + i - first, t, i);
    set_ball(&out, n - 1, t, r.to);
    bool begins = r.from == 0.0;
    out.up = begins ? t->up : normal[out.node[0]];
    out.sides = t->sides;
    out.petiole = begins ? t->petiole : 0;
    out.inside = begins && t->inside;
    return out;
}

Tube *solid_cut(Tube *tubes, uint32_t *n_tubes, const Vec3 *normal, const Holes *holes)
{
    if (!holes)
        return tubes;
    GArray *out = g_array_new(FALSE, FALSE, sizeof(Tube)), *run = g_array_new(FALSE, FALSE, sizeof(Run));
    HoleRings rings;
    hole_rings_init(&rings, holes);
    for (uint32_t i = 0; i < *n_tubes; i++) {
        g_array_set_size(run, 0);
        find_runs(&tubes[i], &rings, run);
        for (guint k = 0; k < run->len; k++) {
            Tube t = take_run(&tubes[i], g_array_index(run, Run, k), normal);
            g_array_append_val(out, t);
        }
    }
    hole_rings_clear(&rings);
    solid_tubes_free(tubes, *n_tubes);
    g_array_unref(run);
    *n_tubes = out->len;
    return (Tube *)(void *)g_array_free(out, FALSE);
}
