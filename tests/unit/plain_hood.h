/* Neighbourhoods by plain search, from the definitions: the truth that the indexed ones are held against. */
#ifndef TEST_PLAIN_HOOD_H
#define TEST_PLAIN_HOOD_H

#include <glib.h>

#include "geom/neighbours.h"

static inline bool plain_sees(PointFilter sees, const void *user, uint32_t v)
{
    return !sees || sees(user, v);
}

static inline double plain_dist2(Vec2 a, Vec2 b)
{
    return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
}

/* Nearer to s than v: of two equally near ones the smaller index. */
static inline bool plain_nearer(const Vec2 *pos, Vec2 s, uint32_t u, uint32_t v)
{
    double du = plain_dist2(pos[u], s), dv = plain_dist2(pos[v], s);
    return du < dv || (du == dv && u < v);
}

/* Eq. 2 with that rule: u shuts v out when it is nearer to s and v is not nearer to s than to u. */
static inline bool plain_shuts(const Vec2 *pos, Vec2 s, uint32_t u, uint32_t v)
{
    return u != v && plain_nearer(pos, s, u, v) && plain_dist2(pos[u], pos[v]) <= plain_dist2(pos[v], s);
}

static inline uint32_t plain_relative(const Vec2 *pos, uint32_t n, Vec2 s, PointFilter sees, const void *user,
                                      uint32_t *out)
{
    uint32_t m = 0;
    for (uint32_t v = 0; v < n; v++) {
        bool in = plain_sees(sees, user, v);
        for (uint32_t u = 0; u < n && in; u++)
            in = !(plain_shuts(pos, s, u, v) && plain_sees(sees, user, u));
        if (in)
            out[m++] = v;
    }
    return m;
}

static inline uint32_t plain_nearest(const Vec2 *pos, uint32_t n, Vec2 s, PointFilter sees, const void *user)
{
    uint32_t best = NO_POINT;
    for (uint32_t v = 0; v < n; v++)
        if (plain_sees(sees, user, v) && (best == NO_POINT || plain_nearer(pos, s, v, best)))
            best = v;
    return best;
}

typedef enum { NO, PERHAPS, YES } Answer;

/* Is v a Delaunay neighbour of s: is there a disc with both on its rim and no other node inside? Its centre is m + t n,
 * with m half way and n across; every other node u allows a half-line of t. PERHAPS when what is left is too short to
 * trust. */
static inline Answer plain_delaunay(const Vec2 *pos, uint32_t n, Vec2 s, uint32_t v, PointFilter sees, const void *user)
{
    long double px = (long double)pos[v].x - (long double)s.x, py = (long double)pos[v].y - (long double)s.y;
    long double p2 = px * px + py * py, lo = -1e9L, hi = 1e9L, doubt = 1e-6L;
    bool shared = false;
    if (p2 < 1e-12L)
        return PERHAPS;
    for (uint32_t u = 0; u < n; u++) {
        if (u == v || !plain_sees(sees, user, u))
            continue;
        if (plain_dist2(pos[u], pos[v]) < 1e-12) {
            shared = true; /* of nodes at one place rounding chooses */
            continue;
        }
        /* |c - u| >= |c - s| with c = p / 2 + t (-py, px), all relative to s: 2 c·q <= q² */
        long double qx = (long double)pos[u].x - (long double)s.x, qy = (long double)pos[u].y - (long double)s.y;
        long double room = qx * qx + qy * qy - (px * qx + py * qy), slope = 2 * (px * qy - py * qx);
        if (fabsl(slope) < 1e-14L * p2) {
            if (room < -1e-9L)
                return NO;
            if (room < 1e-9L)
                return PERHAPS;
        } else if (slope > 0) {
            hi = MIN(hi, room / slope);
        } else {
            lo = MAX(lo, room / slope);
        }
    }
    /* as long as it is far from s its ends are badly known: scale the doubt */
    long double end = MIN(fabsl(lo), fabsl(hi)), length = hi - lo;
    doubt *= 1 + end * end;
    return length > doubt ? shared ? PERHAPS : YES : length < -doubt ? NO : PERHAPS;
}

/* Urquhart: Delaunay neighbours that no other Delaunay neighbour shuts out. */
static inline void plain_urquhart(const Vec2 *pos, uint32_t n, Vec2 s, PointFilter sees, const void *user, Answer *out)
{
    Answer *delaunay = g_new(Answer, n);
    for (uint32_t v = 0; v < n; v++)
        delaunay[v] = plain_sees(sees, user, v) ? plain_delaunay(pos, n, s, v, sees, user) : NO;
    for (uint32_t v = 0; v < n; v++) {
        out[v] = delaunay[v];
        for (uint32_t u = 0; u < n && out[v] != NO; u++)
            if (delaunay[u] != NO && plain_shuts(pos, s, u, v))
                out[v] = delaunay[u] == YES ? NO : PERHAPS;
    }
    g_free(delaunay);
}

#endif
