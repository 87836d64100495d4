#include "lib/ground_back.h"

#include "lib/ground_private.h"

/* The affine map that takes points `from` to points `to` best, by least squares. */
static Affine fit_affine(const Vec2 *from, const Vec2 *to, uint32_t n)
{
    Vec2 f0 = vec2(0, 0), t0 = vec2(0, 0);
    for (uint32_t i = 0; i < n; i++) {
        f0 = vec_add(f0, vec_scale(from[i], 1.0 / n));
        t0 = vec_add(t0, vec_scale(to[i], 1.0 / n));
    }
    double xx = 0, xy = 0, yy = 0, xu = 0, xv = 0, yu = 0, yv = 0;
    for (uint32_t i = 0; i < n; i++) {
        Vec2 f = vec_sub(from[i], f0), t = vec_sub(to[i], t0);
        xx += f.x * f.x, xy += f.x * f.y, yy += f.y * f.y;
        xu += f.x * t.x, yu += f.y * t.x, xv += f.x * t.y, yv += f.y * t.y;
    }
    double det = xx * yy - xy * xy;
    Affine m = {.a = (yy * xu - xy * yu) / det, .c = (xx * yu - xy * xu) / det, .b = (yy * xv - xy * yv) / det, .d = (xx * yv - xy * xv) / det};
    m.e = t0.x - m.a * f0.x - m.c * f0.y;
    m.f = t0.y - m.b * f0.x - m.d * f0.y;
    return m;
}

/* n points evenly along the margin. */
static void sample_margin(const Polygon *p, Vec2 *out, uint32_t n)
{
    double whole = 0.0, gone = 0.0;
    for (uint32_t k = 0; k < p->n; k++)
        whole += vec_dist(p->v[k], p->v[(k + 1) % p->n]);
    for (uint32_t i = 0, k = 0; i < n; i++) {
        double want = whole * i / n, length;
        while (gone + (length = vec_dist(p->v[k], p->v[(k + 1) % p->n])) < want && k + 1 < p->n) {
            gone += length;
            k++;
        }
        out[i] = vec_lerp(p->v[k], p->v[(k + 1) % p->n], length > 0.0 ? CLAMP((want - gone) / length, 0.0, 1.0) : 0.0);
    }
}

enum { ROUNDS = 40, SAMPLES = 720 };

/* Mean distance of points on one margin, mapped, from the other margin. */
static double mean_distance(const Vec2 *from, const Affine *map, const Polygon *to)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < SAMPLES; i++) {
        Vec2 p = affine_apply(map, from[i]);
        sum += vec_dist(p, polygon_nearest(to, p, NULL));
    }
    return sum / SAMPLES;
}

/* Both ways, as a map that draws the leaf together onto a piece of the other margin would look good from one side. In lengths of the front. */
static double apart(const Vec2 *front, const Vec2 *back, const Affine *m, const Polygon *outline, const Polygon *seen)
{
    double det = m->a * m->d - m->b * m->c, size = sqrt(fabs(det));
    if (!(size > 1e-3 && size < 1e3))
        return HUGE_VAL;
    Affine inverse = {.a = m->d / det, .b = -m->b / det, .c = -m->c / det, .d = m->a / det};
    inverse.e = -(inverse.a * m->e + inverse.c * m->f);
    inverse.f = -(inverse.b * m->e + inverse.d * m->f);
    double there = mean_distance(front, m, seen) / size, and_back = mean_distance(back, &inverse, outline);
    return MAX(there, and_back);
}

static double align(const Polygon *outline, const Polygon *seen, Affine *m)
{
    Vec2 *front = g_new(Vec2, SAMPLES), *back = g_new(Vec2, SAMPLES), *to = g_new(Vec2, SAMPLES);
    sample_margin(outline, front, SAMPLES);
    sample_margin(seen, back, SAMPLES);
    for (int round = 0; round < ROUNDS; round++) {
        for (uint32_t i = 0; i < SAMPLES; i++)
            to[i] = polygon_nearest(seen, affine_apply(m, front[i]), NULL);
        *m = fit_affine(front, to, SAMPLES);
    }
    double off = apart(front, back, m, outline, seen);
    g_free(front);
    g_free(back);
    g_free(to);
    return off;
}

/* An outline in pixels as it lies between its base and tip. */
static Polygon *between_ends(const Profile *p)
{
    Vec2 axis = vec_sub(p->tip, p->base), *v = g_new(Vec2, p->outline->n);
    double by = 1.0 / vec_norm2(axis);
    for (uint32_t i = 0; i < p->outline->n; i++) {
        Vec2 q = vec_sub(p->outline->v[i], p->base);
        v[i] = vec2(vec_cross(q, axis) * by, vec_dot(q, axis) * by);
    }
    Polygon *out = polygon_new(v, p->outline->n);
    g_free(v);
    return out;
}

/* Mirrored; and mirrored where the base was taken for the tip. */
static void lay(const Polygon *outline, const Profile *back, BackLaid *best)
{
    Polygon *seen = between_ends(back);
    for (int turned = 0; turned < 2; turned++) {
        Affine m = turned ? (Affine){.a = 1.0, .d = -1.0, .f = 1.0} : (Affine){.a = -1.0, .d = 1.0};
        double off = align(outline, seen, &m);
        if (off < best->off)
            *best = (BackLaid){.base = back->base, .tip = back->tip, .map = m, .off = off};
        if (off <= BACK_ODD)
            break;
    }
    polygon_free(seen);
}

BackLaid ground_lay_back(const Polygon *outline, const GPtrArray *all)
{
    BackLaid best = {.off = HUGE_VAL};
    for (guint i = 0; i < all->len; i++)
        lay(outline, all->pdata[i], &best);
    for (guint i = 0; best.off > BACK_ODD && i < all->len; i++) {
        Polygon *seen = between_ends(all->pdata[i]);
        Affine m = {.a = 1.0, .d = 1.0};
        best.same_side = best.same_side || align(outline, seen, &m) < 0.5 * best.off;
        polygon_free(seen);
    }
    return best;
}

/* ---- in the scan ---- */

gboolean ground_find_back(Ground *g, const Params *p, const GPtrArray *all, GError **error)
{
    const char *front = params_text(p, PARAM_SCAN_FILE), *back = params_text(p, PARAM_SCAN_BACK);
    BackLaid laid = ground_lay_back(g->outline, all);
    g->back_off = laid.off;
    if (!(laid.off <= BACK_WRONG)) {
        g_set_error(error, SCAN_ERROR, SCAN_ERROR_VALUE,
                    "%s is no back of %s: laid onto each other as well as they go, their outlines lie %.1f %% of the leaf's length apart on average; "
                    "%g %% are allowed", back, front, 100.0 * laid.off, 100.0 * BACK_WRONG);
        return FALSE;
    }
    Affine pixels = ground_to_pixels(laid.base, laid.tip, g->back->height);
    g->to_back = affine_multiply(&pixels, &laid.map);
    if (laid.off > BACK_ODD && laid.same_side)
        g_string_append_printf(g->note, "%s: its leaf lies the same way round as that of %s; does it show the same side?\n", back, front);
    else if (laid.off > BACK_ODD)
        g_string_append_printf(g->note, "%s: its outline lies %.1f %% of the leaf's length off that of %s on average; is it the same leaf, turned over?\n", back,
                               100.0 * laid.off, front);
    return TRUE;
}
