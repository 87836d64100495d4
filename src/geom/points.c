#include "geom/points.h"

#include <float.h>
#include <glib.h>
#include <string.h>

#define POINTS_INLINE static inline __attribute__((always_inline))

/* What four at a time read beyond the last: points out of sight. */
static inline void pad(Points *p)
{
    for (uint32_t i = p->n; i < p->n + 3; i++)
        p->x[i] = p->y[i] = HUGE_VAL;
}

void points_fill(Points *p, const Vec2 *pos)
{
    for (uint32_t i = 0; i < p->n; i++) {
        p->x[i] = pos[p->v[i]].x;
        p->y[i] = pos[p->v[i]].y;
    }
    pad(p);
}

/* Makes points i … i + 3 of `p` with a lane in the mask those from m on of `out`. Returns the new m. */
POINTS_INLINE uint32_t append(const Points *p, uint32_t i, const FourMask *mask, Points *out, uint32_t m)
{
    for (uint32_t l = 0; l < 4; l++) {
        out->v[m] = p->v[i + l];
        out->x[m] = p->x[i + l];
        out->y[m] = p->y[i + l];
        m -= (uint32_t)(*mask)[l];
    }
    return m;
}

#define FOUR_AT(from)                    \
    ({                                   \
        Four at_;                        \
        memcpy(&at_, (from), sizeof at_); \
        at_;                             \
    })
#define FOUR_MAX(a, b) FOUR_PICK((a) > (b), a, b)

/* Distances of four points from a box. */
typedef struct {
    Four gap2, far2; /* squared, from the nearest and from the farthest corner */
} Reaches;

POINTS_INLINE void box_reaches(Box2 b, const Four *x, const Four *y, Reaches *r)
{
    Four x0 = *x - FOUR(b.x0), x1 = *x - FOUR(b.x1), y0 = *y - FOUR(b.y0), y1 = *y - FOUR(b.y1);
    Four gap_x = FOUR_MAX(FOUR_MAX(-x0, x1), FOUR(0.0)), gap_y = FOUR_MAX(FOUR_MAX(-y0, y1), FOUR(0.0));
    Four far_x = FOUR_MAX(x0, -x1), far_y = FOUR_MAX(y0, -y1);
    r->gap2 = gap_x * gap_x + gap_y * gap_y;
    r->far2 = far_x * far_x + far_y * far_y;
}

/* Squared distances of four points from the corners of a box. */
POINTS_INLINE void corners(Box2 b, const Four *x, const Four *y, Four *d2)
{
    Four x0 = *x - FOUR(b.x0), x1 = *x - FOUR(b.x1), y0 = *y - FOUR(b.y0), y1 = *y - FOUR(b.y1);
    x0 *= x0, x1 *= x1, y0 *= y0, y1 *= y1;
    d2[0] = x0 + y0, d2[1] = x1 + y0, d2[2] = x0 + y1, d2[3] = x1 + y1;
}

/* ---- those nearest to a box ---- */

/* A point that another one beats at every corner is beaten in all of the box, as the difference of two squared distances is linear; those to
 * beat are the ones nearest to a corner. */
POINTS_INLINE uint32_t leave_out_beaten(const Points *p, Box2 box, Points *out)
{
    const Four cx = {box.x0, box.x1, box.x0, box.x1}, cy = {box.y0, box.y0, box.y1, box.y1};
    Four d2[POINTS_MOST], least = FOUR(HUGE_VAL), rival[4]; /* squared distances from the corners; rivals': a little farther */
    FourMask nearest = {0, 0, 0, 0};
    for (uint32_t i = 0; i < p->n; i++) {
        Four dx = cx - FOUR(p->x[i]), dy = cy - FOUR(p->y[i]), d = dx * dx + dy * dy;
        FourMask nearer = d < least, number = {i, i, i, i};
        d2[i] = d;
        least = FOUR_PICK(nearer, d, least);
        nearest = (number & nearer) | (nearest & ~nearer);
    }
    uint32_t rivals = 0, m = 0;
    for (uint32_t c = 0; c < 4; c++) {
        bool twice = false;
        for (uint32_t e = 0; e < c; e++)
            twice |= nearest[e] == nearest[c];
        rival[rivals] = d2[nearest[c]] * FOUR(POINTS_SLACK);
        rivals += !twice;
    }
    for (uint32_t i = 0; i < p->n; i++) {
        bool beaten = false;
        for (uint32_t r = 0; r < rivals; r++)
            beaten |= !FOUR_ANY(rival[r] >= d2[i]);
        out->v[m] = p->v[i];
        out->x[m] = p->x[i];
        out->y[m] = p->y[i];
        m += !beaten;
    }
    return m;
}

/* The point nearest to the middle of the box. */
POINTS_INLINE uint32_t middle_one(const Points *p, Box2 box)
{
    Four cx = FOUR((box.x0 + box.x1) * 0.5), cy = FOUR((box.y0 + box.y1) * 0.5), least = FOUR(HUGE_VAL);
    FourMask best = FOUR_MASK(0), number = {0, 1, 2, 3};
    for (uint32_t i = 0; i < p->n; i += 4, number += FOUR_MASK(4)) {
        Four dx = FOUR_AT(p->x + i) - cx, dy = FOUR_AT(p->y + i) - cy, d2 = dx * dx + dy * dy;
        FourMask nearer = d2 < least;
        least = FOUR_PICK(nearer, d2, least);
        best = (number & nearer) | (best & ~nearer);
    }
    uint32_t l = 0;
    for (uint32_t k = 1; k < 4; k++)
        l = least[k] < least[l] ? k : l;
    return (uint32_t)best[l];
}

/* Those that the middle one does not beat. Returns how many. */
POINTS_INLINE uint32_t leave_out_far(const Points *p, Box2 box, Points *out)
{
    uint32_t middle = middle_one(p, box), m = 0;
    Four x = FOUR(p->x[middle]), y = FOUR(p->y[middle]), limit[4];
    corners(box, &x, &y, limit);
    for (uint32_t c = 0; c < 4; c++)
        limit[c] *= FOUR(POINTS_SLACK);
    for (uint32_t i = 0; i < p->n; i += 4) {
        Four d2[4];
        x = FOUR_AT(p->x + i), y = FOUR_AT(p->y + i);
        corners(box, &x, &y, d2);
        FourMask in = (d2[0] <= limit[0]) | (d2[1] <= limit[1]) | (d2[2] <= limit[2]) | (d2[3] <= limit[3]);
        if (!FOUR_ANY(in))
            continue;
        m = append(p, i, &in, out, m);
        if (m > POINTS_MOST)
            break;
    }
    return m;
}

WIDE uint32_t points_nearest_to(const Points *p, Box2 box, double bound2, Points *out)
{
    enum { SOME = 4 };
    uint32_t n = p->n, m = 0;
    if (n > SOME) {
        n = leave_out_far(p, box, out);
        if (n > POINTS_MOST)
            return n;
        p = out;
        out->n = n;
    }
    n = leave_out_beaten(p, box, out); /* copies a single one */
    for (uint32_t i = 0; i < n; i++) {
        out->v[m] = out->v[i];
        out->x[m] = out->x[i];
        out->y[m] = out->y[i];
        m += box_dist2(box, vec2(out->x[i], out->y[i])) <= bound2 * POINTS_SLACK;
    }
    out->n = m;
    pad(out);
    return m;
}

/* ---- the nearest one ---- */

/* Which lane has the least squared distance; of equally near ones that of the first number. */
POINTS_INLINE uint32_t lane_of_least(const Four *least, const FourMask *number)
{
    uint32_t l = 0;
    for (uint32_t k = 1; k < 4; k++)
        if ((*least)[k] < (*least)[l] || ((*least)[k] == (*least)[l] && (*number)[k] < (*number)[l]))
            l = k;
    return l;
}

/* Finds the point nearest to a place, if one is nearer than sqrt(*d2); UINT32_MAX: none. */
POINTS_INLINE uint32_t nearest_one(const Points *p, Vec2 at, double *d2)
{
    Four x = FOUR(at.x), y = FOUR(at.y), least = FOUR(*d2);
    FourMask best = FOUR_MASK(UINT32_MAX), number = {0, 1, 2, 3};
    for (uint32_t i = 0; i < p->n; i += 4, number += FOUR_MASK(4)) {
        Four dx = FOUR_AT(p->x + i) - x, dy = FOUR_AT(p->y + i) - y, e2 = dx * dx + dy * dy;
        FourMask nearer = e2 < least;
        least = FOUR_PICK(nearer, e2, least);
        best = (number & nearer) | (best & ~nearer);
    }
    uint32_t l = lane_of_least(&least, &best);
    *d2 = least[l];
    return (uint32_t)best[l];
}

WIDE void points_nearest(const Points *p, Vec2 at, uint32_t *best, double *best2)
{
    uint32_t i = nearest_one(p, at, best2);
    if (i != UINT32_MAX)
        *best = p->v[i];
}

/* How much farther off than the one nearest to the middle another one is, squared, changes linearly over the box, so it is least in a corner: by
 * 2 (|dx| half_x + |dy| half_y) less than in the middle. The slack is that of all distances there may be. */
WIDE uint32_t points_sole(const Points *p, Box2 box)
{
    const double slack = POINTS_SLACK - 1.0;
    Vec2 mid = vec2((box.x0 + box.x1) * 0.5, (box.y0 + box.y1) * 0.5); /* rounded: so half a side is what it takes from there */
    double half_x = MAX(box.x1 - mid.x, mid.x - box.x0), half_y = MAX(box.y1 - mid.y, mid.y - box.y0), near2 = HUGE_VAL;
    uint32_t sole = nearest_one(p, mid, &near2);
    if (sole == UINT32_MAX)
        return sole;
    Four limit = FOUR(near2 * POINTS_SLACK + 4.0 * slack * (half_x * half_x + half_y * half_y));
    Four x = FOUR(p->x[sole]), y = FOUR(p->y[sole]), two_x = FOUR(2.0 * half_x), two_y = FOUR(2.0 * half_y);
    FourMask others = FOUR_MASK(0), number = {0, 1, 2, 3};
    for (uint32_t i = 0; i < p->n; i += 4, number += FOUR_MASK(4)) {
        Four px = FOUR_AT(p->x + i), py = FOUR_AT(p->y + i), dx = px - FOUR(mid.x), dy = py - FOUR(mid.y);
        Four least = (dx * dx + dy * dy) * FOUR(1.0 - slack) - (FOUR_ABS(px - x) * two_x + FOUR_ABS(py - y) * two_y);
        others |= (least <= limit) & (number != FOUR_MASK(sole)); /* never one beyond the last, which is out of sight */
    }
    return FOUR_ANY(others) ? UINT32_MAX : p->v[sole];
}

/* ---- rivals ---- */

WIDE void guard_make(Guard *g, Box2 box, const Points *near, bool nearest_alone)
{
    const Four cx = {box.x0, box.x1, box.x0, box.x1}, cy = {box.y0, box.y0, box.y1, box.y1};
    Four best2 = FOUR(HUGE_VAL);
    FourMask best = {0, 0, 0, 0};
    g->box = box;
    g->hull = box_empty();
    g->all = near->n <= 4;
    g->nearest_alone = nearest_alone;
    for (uint32_t i = 0; i < near->n; i++)
        g->hull = box_add(g->hull, vec2(near->x[i], near->y[i]));
    for (uint32_t i = 0; i < near->n && !g->all; i++) {
        Four dx = FOUR(near->x[i]) - cx, dy = FOUR(near->y[i]) - cy, d2 = dx * dx + dy * dy;
        FourMask nearer = d2 < best2, number = {i, i, i, i};
        best2 = FOUR_PICK(nearer, d2, best2);
        best = (number & nearer) | (best & ~nearer);
    }
    for (uint32_t k = 0; k < 4; k++) {
        uint32_t i = g->all ? MIN(k, near->n - 1) : (uint32_t)best[k];
        g->x[k] = near->x[i];
        g->y[k] = near->y[i];
    }
    for (int c = 0; c < 4; c++) {
        Four dx = FOUR_AT(g->x) - FOUR(cx[c]), dy = FOUR_AT(g->y) - FOUR(cy[c]), d2 = (dx * dx + dy * dy) * FOUR(POINTS_SLACK);
        memcpy(g->corner2[c], &d2, sizeof d2);
    }
}

/* Which of four points, not shut out, are excluded all the same, by whichever of the guard's points is nearest, or by one that is nearer all
 * over the box? gap2: their squared distances from the box. */
POINTS_INLINE void guard_excludes(const Guard *g, const Four *px, const Four *py, const Four *gap2, FourMask *out)
{
    Four corner[4];
    corners(g->box, px, py, corner);
    FourMask some_apart = FOUR_MASK(0), by_one = FOUR_MASK(0);
    for (uint32_t i = 0; i < 4; i++) {
        Four dx = FOUR(g->x[i]) - *px, dy = FOUR(g->y[i]) - *py;
        FourMask apart = (dx * dx + dy * dy) * FOUR(POINTS_SLACK) > *gap2, nearer = ~apart;
        for (uint32_t c = 0; c < 4; c++)
            nearer &= FOUR(g->corner2[c][i]) < corner[c];
        some_apart |= apart;
        by_one |= nearer;
    }
    *out = (g->all ? ~some_apart : FOUR_MASK(0)) | (g->nearest_alone ? FOUR_MASK(0) : by_one);
}

WIDE uint32_t guard_pass(const Guard *g, const Points *p, Points *out, uint32_t cap)
{
    uint32_t m = 0;
    for (uint32_t i = 0; i < p->n; i += 4) {
        Four x = FOUR_AT(p->x + i), y = FOUR_AT(p->y + i);
        Reaches of_box, of_hull;
        FourMask excluded;
        box_reaches(g->box, &x, &y, &of_box);
        box_reaches(g->hull, &x, &y, &of_hull);
        FourMask in = of_hull.far2 * FOUR(POINTS_SLACK) > of_box.gap2;
        if (!FOUR_ANY(in))
            continue;
        guard_excludes(g, &x, &y, &of_box.gap2, &excluded);
        in &= ~excluded;
        if (!FOUR_ANY(in))
            continue;
        m = append(p, i, &in, out, m);
        if (m > cap)
            return m;
    }
    out->n = m;
    pad(out);
    return m;
}

uint32_t points_thin_out(Box2 box, Points *p)
{
    enum { SOME = 4 };
    if (p->n <= SOME)
        return p->n;
    Guard g;
    guard_make(&g, box, p, false);
    return guard_pass(&g, p, p, p->n);
}

uint32_t points_rivals(const Points *p, Box2 box, const Points *near, bool nearest_alone, Points *out, uint32_t cap)
{
    if (p->n == 0)
        return out->n = 0;
    Guard g;
    guard_make(&g, box, near, nearest_alone);
    uint32_t n = guard_pass(&g, p, out, cap);
    return n > cap || nearest_alone ? n : points_thin_out(box, out);
}
