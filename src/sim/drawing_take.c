/* Drawn veins as lines of short pieces that lie inside the blade. */
#include <string.h>

#include "sim/drawing_private.h"

/* As much work as one may ask for. */
static const double longest = 5e7; /* all veins, segments */

static Spot between(const Spot *a, const Spot *b, double t)
{
    return (Spot){.p = vec_lerp(a->p, b->p, t), .width = a->width + (b->width - a->width) * t};
}

/* Adds the way to `next` in pieces no longer than a segment. */
static void go_to(GArray *spots, Spot next)
{
    if (spots->len > 0) {
        Spot last = g_array_index(spots, Spot, spots->len - 1);
        double d = vec_dist(last.p, next.p);
        if (!(d > 1e-9))
            return;
        uint32_t pieces = (uint32_t)ceil(d - 1e-9);
        for (uint32_t k = 1; k < pieces; k++) {
            Spot s = between(&last, &next, (double)k / (double)pieces);
            g_array_append_val(spots, s);
        }
    }
    g_array_append_val(spots, next);
}

static bool fail_outside(const Sketch *s, uint32_t vein, Vec2 p, double by, GError **error)
{
    char *name = drawing_vein_text(s->drawing, vein);
    double scale = 1.0 / s->def->length;
    g_set_error(error, DRAWING_ERROR, DRAWING_ERROR_OUTSIDE,
                "%s: %s lies outside the blade by %.3g leaf lengths at %.4g,%.4g (the base is 0,0, the tip 0,1); up to %g may stick out",
                s->def->where, name, by * scale, p.x * scale, p.y * scale, s->def->snap);
    g_free(name);
    return false;
}

static bool fail_point(const Sketch *s, uint32_t vein, uint32_t i, GError **error)
{
    char *name = drawing_vein_text(s->drawing, vein);
    Vec2 p = s->drawing->vein[vein].point[i];
    g_set_error(error, DRAWING_ERROR, DRAWING_ERROR_OUTSIDE, "%s: %s lies outside the blade: its point %u is %g,%g", s->def->where, name, i + 1,
                p.x, p.y);
    g_free(name);
    return false;
}

static double total_length(const GArray *spots)
{
    double sum = 0.0;
    for (guint i = 1; i < spots->len; i++)
        sum += vec_dist(g_array_index(spots, Spot, i - 1).p, g_array_index(spots, Spot, i).p);
    return sum;
}

static bool fail_long(const Sketch *s, GError **error)
{
    g_set_error(error, DRAWING_ERROR, DRAWING_ERROR_VALUE, "%s: at a length of %g the veins are longer than %g segments altogether; they may not",
                s->def->where, s->def->length, longest);
    return false;
}

/* Unknown widths between known ones change evenly along the vein, beyond them they stay as they are there. */
static void fill_widths(Spot *spot, uint32_t n)
{
    uint32_t last = NONE;
    for (uint32_t i = 0; i < n; i++) {
        if (spot[i].width <= 0.0)
            continue;
        for (uint32_t k = last == NONE ? 0 : last + 1; k < i; k++) {
            double way = last == NONE ? 0.0 : spot[i].along - spot[last].along;
            spot[k].width = way > 0.0 ? between(&spot[last], &spot[i], (spot[k].along - spot[last].along) / way).width : spot[i].width;
        }
        last = i;
    }
    for (uint32_t k = last; last != NONE && ++k < n;)
        spot[k].width = spot[last].width;
}

/* A vein in segments, in short pieces, with a width everywhere or nowhere. */
static bool take_points(const Sketch *s, uint32_t vein, GArray *spots, double *room, GError **error)
{
    const DrawnVein *v = &s->drawing->vein[vein];
    double scale = s->def->length;
    Spot *spot = g_new0(Spot, v->n);
    bool good = true;
    for (uint32_t i = 0; i < v->n && good; i++) {
        double w = v->width[i] * scale;
        spot[i] = (Spot){.p = vec_scale(v->point[i], scale), .width = w > 0.0 && w < 1e12 ? w : 0.0};
        good = (fabs(spot[i].p.x) < 1e12 && fabs(spot[i].p.y) < 1e12) || fail_point(s, vein, i, error);
        spot[i].along = i ? spot[i - 1].along + vec_dist(spot[i - 1].p, spot[i].p) : 0.0;
        good = good && (spot[i].along <= *room || fail_long(s, error));
    }
    if (good) {
        *room -= spot[v->n - 1].along;
        fill_widths(spot, v->n);
        for (uint32_t i = 0; i < v->n; i++)
            go_to(spots, spot[i]);
    }
    g_free(spot);
    return good;
}

/* ---- the margin ---- */

/* Where the way from `in` to `out` leaves the blade: a place still inside, as near to the margin as doubles tell. */
static Spot at_margin(const Polygon *blade, Spot in, Spot out)
{
    double lo = 0.0, hi = 1.0;
    for (int k = 0; k < 52; k++) {
        double t = 0.5 * (lo + hi);
        if (polygon_contains(blade, vec_lerp(in.p, out.p, t)))
            lo = t;
        else
            hi = t;
    }
    return between(&in, &out, lo);
}

/* What is outside is no farther than `snap`, and comes to lie on the margin. */
static bool to_margin(const Sketch *s, uint32_t vein, GArray *spots, const bool *in, Vec2 *on, GError **error)
{
    Vec2 worst = {0};
    double most = 0.0;
    for (guint i = 0; i < spots->len; i++) {
        Vec2 p = on[i] = g_array_index(spots, Spot, i).p;
        if (in[i])
            continue;
        on[i] = polygon_nearest(s->blade, p, NULL);
        double by = vec_dist(p, on[i]);
        if (by > most) {
            most = by;
            worst = p;
        }
    }
    return most <= s->snap + 1e-9 * s->def->length || fail_outside(s, vein, worst, most, error);
}

/* How many spots at an end (step 1: the beginning, -1: the end) lie outside, when they are to be cut off: what is longer runs along the
 * margin rather than across it. */
static guint outside_end(const Sketch *s, const GArray *spots, const bool *in, bool from_end)
{
    const Spot *spot = &g_array_index(spots, Spot, 0);
    guint n = spots->len, k = 0;
    double length = 0.0;
    for (; k < n && !in[from_end ? n - 1 - k : k]; k++) {
        guint i = from_end ? n - 1 - k : k;
        if (k + 1 < n)
            length += vec_dist(spot[i].p, spot[from_end ? i - 1 : i + 1].p);
    }
    return length <= 2.0 * s->snap + 1.0 ? k : 0;
}

/* Ends that stick out are cut off, what else is outside is moved to the margin. */
static bool clip(const Sketch *s, uint32_t vein, GArray **spots, GError **error)
{
    guint n = (*spots)->len, n_in = 0;
    const Spot *spot = &g_array_index(*spots, Spot, 0);
    bool *in = g_new(bool, n);
    Vec2 *on = g_new(Vec2, n);
    for (guint i = 0; i < n; i++)
        n_in += in[i] = polygon_contains(s->blade, spot[i].p);
    bool good = n_in == n || to_margin(s, vein, *spots, in, on, error);
    if (good && n_in < n) {
        guint first = outside_end(s, *spots, in, false), last = n - outside_end(s, *spots, in, true);
        GArray *kept = g_array_new(FALSE, FALSE, sizeof(Spot));
        if (first > 0 && first < last)
            go_to(kept, at_margin(s->blade, spot[first], spot[first - 1]));
        for (guint i = first; i < last; i++)
            go_to(kept, (Spot){.p = on[i], .width = spot[i].width});
        if (last < n && first < last)
            go_to(kept, at_margin(s->blade, spot[last - 1], spot[last]));
        g_array_unref(*spots);
        *spots = kept;
    }
    g_free(in);
    g_free(on);
    return good;
}

/* ---- all of them ---- */

typedef struct {
    GArray *spots;
    double length, width; /* width: the mean */
    uint32_t vein;
    uint8_t order;
} Taken;

static void taken_clear(gpointer taken) { g_array_unref(((Taken *)taken)->spots); }

static int by_rank(gconstpointer x, gconstpointer y, gpointer user)
{
    const Taken *a = x, *b = y;
    uint8_t i = (uint8_t)(a->order - 1), j = (uint8_t)(b->order - 1); /* 0, not said, comes last */
    if (i != j)
        return i < j ? -1 : 1;
    if (a->width != b->width)
        return a->width > b->width ? -1 : 1;
    if (a->length != b->length)
        return a->length > b->length ? -1 : 1;
    return a->vein < b->vein ? -1 : 1;
}

static void measure(Taken *t)
{
    t->length = total_length(t->spots);
    for (guint i = 0; i < t->spots->len; i++)
        t->width += g_array_index(t->spots, Spot, i).width / (double)t->spots->len;
}

static void lay_down(Sketch *s, GArray *taken)
{
    gsize n = 0;
    for (guint k = 0; k < taken->len; k++)
        n += g_array_index(taken, Taken, k).spots->len;
    s->spot = g_new(Spot, n);
    s->line_of = g_new(uint32_t, n);
    for (guint k = 0; k < taken->len; k++) {
        const Taken *t = &g_array_index(taken, Taken, k);
        Line line = {.first = s->n_spots, .vein = t->vein, .order = t->order};
        memcpy(s->spot + s->n_spots, t->spots->data, t->spots->len * sizeof(Spot));
        s->n_spots += t->spots->len;
        line.last = s->n_spots - 1;
        double along = 0.0;
        for (uint32_t i = line.first; i <= line.last; i++) {
            along += i > line.first ? vec_dist(s->spot[i - 1].p, s->spot[i].p) : 0.0;
            s->spot[i].along = along;
            s->line_of[i] = i < line.last ? k : NONE;
        }
        line.end[1] = along;
        g_array_append_val(s->line, line);
    }
}

bool sketch_take(Sketch *s, GError **error)
{
    GArray *taken = g_array_new(FALSE, FALSE, sizeof(Taken));
    g_array_set_clear_func(taken, taken_clear);
    double room = longest;
    bool good = true;
    for (uint32_t k = 0; k < s->drawing->n && good; k++) {
        Taken t = {.spots = g_array_new(FALSE, FALSE, sizeof(Spot)), .vein = k, .order = s->drawing->vein[k].order};
        good = take_points(s, k, t.spots, &room, error) && clip(s, k, &t.spots, error);
        measure(&t);
        if (good && t.length > drawing_least)
            g_array_append_val(taken, t);
        else
            g_array_unref(t.spots);
    }
    if (good && taken->len == 0) {
        if (s->drawing->n == 0)
            g_set_error(error, DRAWING_ERROR, DRAWING_ERROR_EMPTY, "%s: no vein is drawn", s->def->where);
        else
            g_set_error(error, DRAWING_ERROR, DRAWING_ERROR_EMPTY,
                        "%s: no vein is drawn that is longer than %g of the leaf's length inside the blade", s->def->where,
                        drawing_least / s->def->length);
        good = false;
    }
    if (good) {
        if (taken->len > 1)
            g_qsort_with_data(taken->data, (gint)taken->len, sizeof(Taken), by_rank, NULL);
        lay_down(s, taken);
    }
    g_array_unref(taken);
    return good;
}
