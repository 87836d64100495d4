#include "geom/cubicfit.h"

#include <glib.h>

#include "geom/segment.h"

enum { PLACES = 64, MAX_STEPS = 40, NEWTON_STEPS = 8, HALVINGS = 6 };

static const double shortest_handle = 0.02, longest_handle = 1.0; /* of the polyline's length */

Vec2 cubic_at(const Vec2 q[4], double u)
{
    double v = 1.0 - u;
    Vec2 a = vec_add(vec_scale(q[0], v * v * v), vec_scale(q[3], u * u * u));
    return vec_add(a, vec_add(vec_scale(q[1], 3.0 * u * v * v), vec_scale(q[2], 3.0 * u * u * v)));
}

static Vec2 slope(const Vec2 q[4], double u)
{
    double v = 1.0 - u;
    Vec2 a = vec_sub(q[1], q[0]), b = vec_sub(q[2], q[1]), c = vec_sub(q[3], q[2]);
    return vec_scale(vec_add(vec_add(vec_scale(a, v * v), vec_scale(b, 2.0 * u * v)), vec_scale(c, u * u)), 3.0);
}

static Vec2 bend(const Vec2 q[4], double u)
{
    Vec2 a = vec_sub(vec_sub(q[2], q[1]), vec_sub(q[1], q[0])), b = vec_sub(vec_sub(q[3], q[2]), vec_sub(q[2], q[1]));
    return vec_scale(vec_lerp(a, b, u), 6.0);
}

/* Newton's method for the foot of p on the curve from u on, with shorter steps where the distance would rise. Returns the squared
 * distance. */
static double foot(const Vec2 q[4], Vec2 p, double *u)
{
    Vec2 off = vec_sub(cubic_at(q, *u), p);
    double least = vec_norm2(off);
    for (int k = 0; k < NEWTON_STEPS; k++) {
        Vec2 d = slope(q, *u);
        double down = vec_dot(off, d), plain = vec_norm2(d), curved = plain + vec_dot(off, bend(q, *u));
        if (!(plain > 0.0) || down == 0.0)
            break;
        double step = -down / (curved > 0.1 * plain ? curved : plain), before = least;
        for (int half = 0; half < HALVINGS && !(least < before); half++, step *= 0.5) {
            double next = *u + step;
            next = next < 0.0 ? 0.0 : next > 1.0 ? 1.0 : next;
            Vec2 there = vec_sub(cubic_at(q, next), p);
            if (!(vec_norm2(there) < before))
                continue;
            *u = next;
            off = there;
            least = vec_norm2(off);
        }
        if (!(least < before))
            break;
    }
    return least;
}

/* Length of polyline that point i stands for. */
static double share(const Vec2 *p, uint32_t n, uint32_t i)
{
    return 0.5 * ((i > 0 ? vec_dist(p[i - 1], p[i]) : 0.0) + (i + 1 < n ? vec_dist(p[i], p[i + 1]) : 0.0));
}

/* Distance of the points from the curve; their mean too. */
static CubicDeviation from_points(const Vec2 q[4], const Vec2 place[PLACES + 1], const Vec2 *p, uint32_t n)
{
    CubicDeviation d = {0.0, 0.0, 0};
    double whole = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        int best = 0;
        for (int k = 1; k <= PLACES; k++)
            if (vec_dist2(place[k], p[i]) < vec_dist2(place[best], p[i]))
                best = k;
        double u = (double)best / PLACES, off = sqrt(foot(q, p[i], &u)), w = share(p, n, i);
        d.mean += w * off;
        whole += w;
        if (off > d.largest) {
            d.largest = off;
            d.farthest = i;
        }
    }
    d.mean = whole > 0.0 ? d.mean / whole : 0.0;
    return d;
}

CubicDeviation cubic_deviation(const Vec2 q[4], const Vec2 *p, uint32_t n)
{
    Vec2 place[PLACES + 1];
    for (int k = 0; k <= PLACES; k++)
        place[k] = cubic_at(q, (double)k / PLACES);
    CubicDeviation d = from_points(q, place, p, n);
    for (int k = 1; k < PLACES; k++) {
        uint32_t nearest = 0;
        double least = HUGE_VAL;
        for (uint32_t i = 0; i + 1 < n; i++) {
            double off = segment_dist2(p[i], p[i + 1], place[k]);
            if (off < least) {
                least = off;
                nearest = vec_dist2(p[i], place[k]) <= vec_dist2(p[i + 1], place[k]) ? i : i + 1;
            }
        }
        if (sqrt(least) > d.largest) {
            d.largest = sqrt(least);
            d.farthest = nearest;
        }
    }
    return d;
}

/* --- fitting --- */

typedef struct {
    const Vec2 *p;
    uint32_t n;
    double *u, *weight; /* [n] foot on the curve; weights of sum 1 */
    double length;      /* of the polyline */
} Run;

static double run_feet(const Run *r, const Vec2 q[4], double *u)
{
    double sum = 0.0;
    for (uint32_t i = 1; i + 1 < r->n; i++)
        sum += r->weight[i] * foot(q, r->p[i], &u[i]);
    return sum;
}

static Run run_new(const Vec2 *p, uint32_t n)
{
    Run r = {p, n, g_new(double, n), g_new(double, n), 0.0};
    for (uint32_t i = 0; i < n; i++) {
        r.length += i > 0 ? vec_dist(p[i - 1], p[i]) : 0.0;
        r.u[i] = r.length;
        r.weight[i] = share(p, n, i);
    }
    for (uint32_t i = 0; i < n && r.length > 0.0; i++) {
        r.u[i] /= r.length;
        r.weight[i] /= r.length;
    }
    return r;
}

static void run_clear(Run *r)
{
    g_free(r->u);
    g_free(r->weight);
}

/* One unknown: how far control point 1 or 2 moves in a direction. */
typedef struct {
    int point;
    Vec2 way;
} Unknown;

/* Normal equations a x = b of the distances along the normals, to first order in the unknowns. */
static void normal_equations(const Run *r, const Vec2 q[4], const Unknown *unknown, int n, double a[4][4], double b[4])
{
    for (int i = 0; i < n; i++) {
        b[i] = 0.0;
        for (int j = 0; j < n; j++)
            a[i][j] = 0.0;
    }
    for (uint32_t k = 1; k + 1 < r->n; k++) {
        double u = r->u[k], v = 1.0 - u, size, row[4];
        Vec2 d = slope(q, u);
        size = sqrt(vec_norm2(d));
        if (!(size > 0.0))
            continue;
        Vec2 normal = vec2(-d.y / size, d.x / size);
        double off = vec_dot(normal, vec_sub(r->p[k], cubic_at(q, u)));
        for (int i = 0; i < n; i++)
            row[i] = vec_dot(normal, unknown[i].way) * 3.0 * u * v * (unknown[i].point == 1 ? v : u);
        for (int i = 0; i < n; i++) {
            b[i] += r->weight[k] * row[i] * off;
            for (int j = 0; j <= i; j++)
                a[i][j] += r->weight[k] * row[i] * row[j];
        }
    }
}

/* Solves (a + damping of its diagonal) x = b by Cholesky's method; a holds its lower half. */
static void solve(double a[4][4], const double b[4], double damping, int n, double x[4])
{
    double l[4][4];
    for (int i = 0; i < n; i++)
        for (int j = 0; j <= i; j++) {
            double s = a[i][j] * (i == j ? 1.0 + damping : 1.0);
            for (int k = 0; k < j; k++)
                s -= l[i][k] * l[j][k];
            l[i][j] = i == j ? sqrt(s > 0.0 ? s : 1e-300) : s / l[j][j];
        }
    for (int i = 0; i < n; i++) {
        double s = b[i];
        for (int k = 0; k < i; k++)
            s -= l[i][k] * x[k];
        x[i] = s / l[i][i];
    }
    for (int i = n; i-- > 0;) {
        for (int k = i + 1; k < n; k++)
            x[i] -= l[k][i] * x[k];
        x[i] /= l[i][i];
    }
}

/* How long a handle may be that goes the way u, a unit vector, from one end of a chord: until it passes the other end. When both handles
 * go forwards and keep to this the curve never runs back along the chord, as it would over noisy points on a line. */
static double handle_limit(Vec2 chord, Vec2 u, double length)
{
    double along = vec_dot(chord, u), most = longest_handle * length;
    return along > 0.0 ? MIN(vec_norm2(chord) / along, most) : most;
}

/* Holds a control point's distance from its end within bounds. */
static Vec2 held(Vec2 end, Vec2 control, Vec2 way, double least, double most)
{
    Vec2 d = vec_sub(control, end);
    double size = sqrt(vec_norm2(d));
    if (vec_norm2(way) > 0.0) /* a direction is given: behind the end counts as too short */
        size = vec_dot(d, way);
    else if (size > 0.0)
        way = vec_scale(d, 1.0 / size);
    size = size < least ? least : size;
    size = size < most ? size : most;
    return vec_add(end, vec_scale(way, size));
}

static Vec2 unit(Vec2 d)
{
    double size = sqrt(vec_norm2(d));
    return size > 0.0 ? vec_scale(d, 1.0 / size) : vec2(0.0, 0.0);
}

double cubic_fit(Vec2 q[4], const Vec2 *p, uint32_t n, bool directions)
{
    Run r = run_new(p, n);
    Vec2 way[2] = {unit(vec_sub(q[1], q[0])), unit(vec_sub(q[2], q[3]))};
    Unknown unknown[4] = {{1, way[0]}, {2, way[1]}};
    double most[2] = {longest_handle * r.length, longest_handle * r.length};
    int m = 2;
    if (directions) {
        most[0] = handle_limit(vec_sub(q[3], q[0]), way[0], r.length);
        most[1] = handle_limit(vec_sub(q[0], q[3]), way[1], r.length);
    } else {
        const Unknown any[4] = {{1, {1.0, 0.0}}, {1, {0.0, 1.0}}, {2, {1.0, 0.0}}, {2, {0.0, 1.0}}};
        for (m = 0; m < 4; m++)
            unknown[m] = any[m];
        way[0] = way[1] = vec2(0.0, 0.0);
    }
    q[1] = held(q[0], q[1], way[0], shortest_handle * r.length, most[0]);
    q[2] = held(q[3], q[2], way[1], shortest_handle * r.length, most[1]);
    double cost = run_feet(&r, q, r.u), damping = 1e-3, *trial = g_new(double, n);
    for (int step = 0; step < MAX_STEPS && damping < 1e6 && cost > 1e-28 * r.length * r.length; step++) {
        double a[4][4], b[4], x[4];
        normal_equations(&r, q, unknown, m, a, b);
        solve(a, b, damping, m, x);
        Vec2 next[4] = {q[0], q[1], q[2], q[3]};
        for (int i = 0; i < m; i++)
            next[unknown[i].point] = vec_add(next[unknown[i].point], vec_scale(unknown[i].way, x[i]));
        next[1] = held(q[0], next[1], way[0], shortest_handle * r.length, most[0]);
        next[2] = held(q[3], next[2], way[1], shortest_handle * r.length, most[1]);
        for (uint32_t i = 0; i < n; i++)
            trial[i] = r.u[i];
        double there = run_feet(&r, next, trial);
        if (!(there < cost)) {
            damping *= 10.0;
            continue;
        }
        bool done = cost - there < 1e-9 * cost;
        double *spare = r.u;
        r.u = trial;
        trial = spare;
        q[1] = next[1];
        q[2] = next[2];
        cost = there;
        damping *= 0.1;
        if (done)
            break;
    }
    g_free(trial);
    run_clear(&r);
    return cost;
}
