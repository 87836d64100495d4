#include "scan/axis.h"

#include <glib.h>

enum { GRID = 48, DIRECTIONS = 180 };

#define OVERHANG 0.05 /* of the axis: a sinus deeper than that marks the base */
#define PEAK 0.03 /* in symmetry, of the part of a peak from the top that its middle is taken of */
#define LENGTH_BONUS 0.05 /* in symmetry, of an axis along the leaf's whole extent: an ellipse has two */

void axis_init(Axis *a, const Polygon *outline)
{
    *a = (Axis){.outline = outline, .middle = polygon_centroid(outline), .p = g_new(Vec2, GRID * GRID)};
    Box2 b = outline->box;
    for (int j = 0; j < GRID; j++)
        for (int i = 0; i < GRID; i++) {
            Vec2 p = vec2(b.x0 + (b.x1 - b.x0) * (i + 0.5) / GRID, b.y0 + (b.y1 - b.y0) * (j + 0.5) / GRID);
            if (polygon_contains(outline, p))
                a->p[a->n++] = p;
        }
}

void axis_clear(Axis *a) { g_free(a->p); }

double axis_symmetry(const Axis *a, Vec2 from, Vec2 to)
{
    Vec2 d = vec_sub(to, from);
    double n2 = vec_norm2(d);
    if (!(n2 > 0.0) || a->n == 0)
        return 0.0;
    uint32_t same = 0;
    for (uint32_t k = 0; k < a->n; k++) {
        double off = vec_cross(d, vec_sub(a->p[k], from)) / n2;
        same += polygon_contains(a->outline, vec_add(a->p[k], vec_scale(vec2(d.y, -d.x), 2.0 * off)));
    }
    return (double)same / a->n;
}

/* Distance from the middle along u, in its length, to where the ray first meets the outline; 0 when it doesn't. */
static double first_crossing(const Axis *a, Vec2 u)
{
    const Polygon *p = a->outline;
    double best = 0.0;
    for (uint32_t i = 0; i < p->n; i++) {
        Vec2 v = vec_sub(p->v[i], a->middle), w = vec_sub(p->v[i + 1 < p->n ? i + 1 : 0], a->middle);
        double s = vec_cross(u, v), t = vec_cross(u, w);
        if ((s < 0.0) == (t < 0.0))
            continue;
        double at = vec_dot(u, vec_lerp(v, w, s / (s - t))) / vec_norm2(u);
        if (at > 0.0 && (best == 0.0 || at < best))
            best = at;
    }
    return best;
}

Vec2 axis_opposite(const Axis *a, Vec2 from)
{
    Vec2 u = vec_sub(a->middle, from);
    return vec_norm2(u) > 0.0 ? vec_add(a->middle, vec_scale(u, first_crossing(a, u))) : a->middle;
}

/* How far along u the outline reaches from the middle. */
static double reach(const Axis *a, Vec2 u)
{
    double most = 0.0;
    for (uint32_t i = 0; i < a->outline->n; i++)
        most = fmax(most, vec_dot(u, vec_sub(a->outline->v[i], a->middle)));
    return most;
}

/* The k-th direction, -90° … 90°; of fractions in between, too. */
static Vec2 direction(double k)
{
    double t = -1.0 + 2.0 * k / DIRECTIONS; /* tangent of half the angle */
    return vec2((1.0 - t * t) / (1.0 + t * t), 2.0 * t / (1.0 + t * t));
}

/* Where the peak of scores around the best one has its middle: points are too few for more than the foot of it to be sure. */
static double peak_middle(const double *score, int best)
{
    double least = score[best] - PEAK, sum = 0.0, all = 0.0;
    for (int way = -1; way <= 1; way += 2)
        for (int k = way > 0 ? 0 : 1; k < DIRECTIONS / 4; k++) {
            double above = score[(best + way * k + DIRECTIONS) % DIRECTIONS] - least;
            if (above <= 0.0)
                break;
            sum += above * way * k;
            all += above;
        }
    return best + sum / all;
}

double axis_find(const Axis *a, Vec2 *base, Vec2 *tip)
{
    Vec2 c = a->middle;
    Box2 b = a->outline->box;
    double score[DIRECTIONS], extent = vec_dist(vec2(b.x0, b.y0), vec2(b.x1, b.y1));
    int most = 0;
    for (int k = 0; k < DIRECTIONS; k++) {
        Vec2 u = direction(k);
        score[k] = axis_symmetry(a, c, vec_add(c, u)) + LENGTH_BONUS * (reach(a, u) + reach(a, vec_scale(u, -1.0))) / extent;
        most = score[k] > score[most] ? k : most;
    }
    Vec2 best = direction(peak_middle(score, most));
    double symmetry = axis_symmetry(a, c, vec_add(c, best));
    Vec2 back = vec_scale(best, -1.0);
    double ahead = first_crossing(a, best), behind = first_crossing(a, back);
    double past = (reach(a, best) - ahead) - (reach(a, back) - behind);
    bool base_ahead = fabs(past) > OVERHANG * (ahead + behind) ? past > 0.0 : ahead < behind;
    *base = vec_add(c, vec_scale(best, base_ahead ? ahead : -behind));
    *tip = vec_add(c, vec_scale(best, base_ahead ? -behind : ahead));
    return symmetry;
}
