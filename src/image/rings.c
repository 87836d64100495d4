#include "image/rings.h"

void rings_clear(Rings *r)
{
    g_free(r->v);
    g_free(r->end);
}

void rings_grow(Rings *r, uint32_t points)
{
    r->cap_v = MAX(MAX(r->cap_v * 2, r->n_v + points), 64);
    r->v = g_renew(Vec2, r->v, r->cap_v);
}

void rings_add(Rings *r)
{
    if (r->n == r->cap) {
        r->cap = MAX(r->cap * 2, 16);
        r->end = g_renew(uint32_t, r->end, r->cap);
    }
    r->end[r->n++] = r->n_v;
}

static inline void clip_known(const Vec2 *v, uint32_t n, const double *beyond, Rings *out)
{
    rings_room(out, 2 * n); /* a polygon that is not convex may be cut at every edge */
    Vec2 *first = out->v + out->n_v, *to = first, p = v[n - 1];
    double dp = beyond[n - 1];
    for (uint32_t i = 0; i < n; i++) {
        Vec2 q = v[i];
        double dq = beyond[i];
        if ((dp > 0.0) != (dq > 0.0))
            to = put_point(first, to, vec_lerp(p, q, dp / (dp - dq)));
        if (!(dq > 0.0))
            to = put_point(first, to, q);
        p = q;
        dp = dq;
    }
    out->n_v = (uint32_t)(to - out->v);
    rings_close(out);
}

void ring_clip(const Vec2 *v, uint32_t n, Vec2 normal, double bound, Rings *out)
{
    enum { FEW = 64 };
    if (n == 0)
        return;
    double few[FEW], *beyond = n <= FEW ? few : g_new(double, n);
    for (uint32_t i = 0; i < n; i++)
        beyond[i] = vec_dot(v[i], normal) - bound;
    clip_known(v, n, beyond, out);
    if (beyond != few)
        g_free(beyond);
}

/* Where the edge from point i to the next one meets the line. */
static inline Vec2 crossing(const Vec2 *v, const double *beyond, uint32_t i, uint32_t next)
{
    return vec_lerp(v[i], v[next], beyond[i] / (beyond[i] - beyond[next]));
}

/* Points i … end - 1 after what there is: only the first ones may coincide with the last point there. */
static inline Vec2 *put_points(const Vec2 *first, Vec2 *to, const Vec2 *v, uint32_t i, uint32_t end)
{
    while (to > first && i < end && rings_same(to[-1], v[i]))
        i++;
    for (; i < end; i++)
        *to++ = v[i];
    return to;
}

/* Points in the order that ring_clip has them, so that areas are the same to the last bit. */
void ring_cut_known(const Vec2 *v, uint32_t n, const double *beyond, uint32_t mask, Rings *out)
{
    uint32_t before = mask << 1 | mask >> (n - 1), all = n < 32 ? (1u << n) - 1 : ~0u; /* before: each bit is that of the point before */
    uint32_t leave = mask & ~before & all, enter = ~mask & before & all;              /* points with the line between them and the point before */
    if ((leave & (leave - 1)) != 0) { /* rounding made it not convex */
        clip_known(v, n, beyond, out);
        return;
    }
    uint32_t l = (uint32_t)__builtin_ctz(leave), e = (uint32_t)__builtin_ctz(enter);
    rings_room(out, n + 2);
    Vec2 *first = out->v + out->n_v, *to = first, leaving = crossing(v, beyond, l > 0 ? l - 1 : n - 1, l);
    Vec2 entering = crossing(v, beyond, e > 0 ? e - 1 : n - 1, e);
    if (l < e) {
        to = put_points(first, to, v, 0, l);
        to = put_point(first, to, leaving);
        to = put_point(first, to, entering);
        to = put_points(first, to, v, e, n);
    } else {
        *to++ = entering;
        to = put_points(first, to, v, e, l);
        to = put_point(first, to, leaving);
    }
    out->n_v = (uint32_t)(to - out->v);
    rings_close(out);
}

void ring_within(const Vec2 *v, uint32_t n, Box2 box, Rings *out, Rings *spare)
{
    const Vec2 normal[4] = {{-1.0, 0.0}, {0.0, -1.0}, {1.0, 0.0}, {0.0, 1.0}};
    const double bound[4] = {-box.x0, -box.y0, box.x1, box.y1};
    rings_reset(out);
    rings_copy(out, v, n);
    for (int i = 0; i < 4 && out->n > 0; i++) {
        Rings swap = *spare;
        *spare = *out;
        *out = swap;
        rings_reset(out);
        ring_clip(spare->v, spare->n_v, normal[i], bound[i], out);
    }
}
