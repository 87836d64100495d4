#include "scan/fang_draw.h"

#include <math.h>

#define REACH 1.5 /* pixels */
enum {
    SPAN = 4,      /* vertices to either side that a normal and a shift are taken from */
    PATIENCE = 32, /* rounds after which more is taken back at once */
};

/* Bilinear between the places that the responses speak of, at p, y up. */
static double strength_at(const Strength *s, Vec2 p)
{
    double middle = s->op == EDGES_ROBERTS ? 1.0 : 0.5;
    double x = p.x - s->corner.x - middle, y = s->height - p.y - s->corner.y - middle, i = floor(x), j = floor(y), sum = 0.0;
    for (int k = 0; k < 4; k++) {
        double cx = i + (k & 1), cy = j + (k >> 1), share = (1.0 - fabs(x - cx)) * (1.0 - fabs(y - cy));
        if (cx >= 0.0 && cy >= 0.0 && cx < (double)s->response->width && cy < (double)s->response->height)
            sum += share * (double)fang_sparse_at(s->response, (uint32_t)cx, (uint32_t)cy);
    }
    return sum;
}

/* Where the response is greatest, along the inward normal; false at the frame and where there is no edge. */
static bool find_shift(const Polygon *p, uint32_t i, const Strength *s, Vec2 inward, double *shift)
{
    Vec2 v = p->v[i];
    if (!(v.x > 1.0 && v.y > 1.0 && v.x < s->width - 1.0 && v.y < s->height - 1.0))
        return false;
    double most = 0.0;
    bool found = false;
    for (double d = -REACH; d <= REACH; d += 0.25) {
        double here = strength_at(s, vec_add(v, vec_scale(inward, d)));
        if (here > most) {
            most = here;
            *shift = d;
            found = true;
        }
    }
    return found;
}

static double median(double *v, int n)
{
    for (int i = 1; i < n; i++) {
        double x = v[i];
        int k = i;
        for (; k > 0 && v[k - 1] > x; k--)
            v[k] = v[k - 1];
        v[k] = x;
    }
    return 0.5 * (v[(n - 1) / 2] + v[n / 2]);
}

/* Of the shifts known around each vertex. Unknown are those that are NAN. */
static void smooth_shifts(const double *in, double *out, uint32_t n, bool mean)
{
    for (uint32_t i = 0; i < n; i++) {
        double v[2 * SPAN + 1], sum = 0.0;
        int m = 0;
        for (uint32_t k = 0; k < 2 * SPAN + 1; k++) {
            double x = in[(i + n * SPAN + k - SPAN) % n];
            if (isnan(x))
                continue;
            sum += x;
            v[m++] = x;
        }
        out[i] = isnan(in[i]) ? in[i] : mean ? sum / m : median(v, m);
    }
}

static double signed_area(const Vec2 *v, uint32_t n)
{
    double twice = 0.0;
    for (uint32_t i = 1; i + 1 < n; i++)
        twice += vec_cross(vec_sub(v[i], v[0]), vec_sub(v[i + 1], v[0]));
    return 0.5 * twice;
}

/* Takes shifts back around places where the moved border touches itself, until nowhere; ever more of them, so that it ends soon. */
static Polygon *move(const Polygon *p, const Vec2 *inward, double *shift)
{
    uint32_t n = p->n;
    Vec2 *v = g_new(Vec2, n);
    for (uint64_t round = 1;; round++) {
        for (uint32_t k = 0; k < n; k++)
            v[k] = vec_add(p->v[k], vec_scale(inward[k], shift[k]));
        Polygon *q = polygon_new(v, n);
        uint32_t i = 0, j = 0, wide = (uint32_t)MIN((uint64_t)n, (uint64_t)SPAN << MIN(round / PATIENCE, 32));
        bool turned = !(signed_area(v, n) > 0.0);
        if (!turned && !polygon_crossing(q, &i, &j)) {
            g_free(v);
            return q;
        }
        polygon_free(q);
        wide = turned ? n : wide;
        for (uint32_t k = 0; k < wide; k++)
            shift[(i + n - wide / 2 + k) % n] = shift[(j + n - wide / 2 + k) % n] = 0.0;
    }
}

Polygon *fang_draw(const Polygon *border, const Strength *s)
{
    uint32_t n = border->n;
    double *raw = g_new(double, n), *shift = g_new(double, n);
    Vec2 *inward = g_new(Vec2, n);
    for (uint32_t i = 0; i < n; i++) {
        Vec2 d = vec_sub(border->v[(i + SPAN) % n], border->v[(i + n * SPAN - SPAN) % n]);
        double size = sqrt(vec_norm2(d));
        inward[i] = size > 0.0 ? vec2(-d.y / size, d.x / size) : vec2(0.0, 0.0);
        raw[i] = (double)NAN;
        find_shift(border, i, s, inward[i], &raw[i]);
    }
    smooth_shifts(raw, shift, n, false);
    smooth_shifts(shift, raw, n, true);
    for (uint32_t i = 0; i < n; i++)
        shift[i] = isnan(raw[i]) ? 0.0 : raw[i];
    Polygon *out = move(border, inward, shift);
    g_free(raw);
    g_free(shift);
    g_free(inward);
    return out;
}
