#include "sim/lturtle_axis.h"

#include <string.h>

#include <glib.h>

#include "sim/lobes.h"

enum { TERMS = 3, LEVELS = 128, ROUNDS = 3 };

/* Steepest dx/dy; beyond it x isn't well told by y. */
static const double steepest = 2.5;

/* --- asking --- */

/* Cubic between two samples: x, and dx/dy where it is asked for. */
static double at(const LAxis *a, double y, double *slope)
{
    double in = CLAMP(y, 0.0, 1.0) * LAXIS_PARTS, h = 1.0 / LAXIS_PARTS;
    int i = MIN((int)in, LAXIS_PARTS - 1);
    double t = in - i, s0 = h * a->slope[i], s1 = h * a->slope[i + 1], d = a->x[i + 1] - a->x[i];
    double c = 3.0 * d - 2.0 * s0 - s1, e = s0 + s1 - 2.0 * d;
    double here = (s0 + t * (2.0 * c + 3.0 * e * t)) / h;
    if (slope)
        *slope = here;
    return a->x[i] + t * (s0 + t * (c + t * e)) + here * (y - CLAMP(y, 0.0, 1.0));
}

double laxis_x(const LAxis *a, double y) { return a->curved ? at(a, y, NULL) : 0.0; }

Vec2 laxis_way(const LAxis *a, double y)
{
    double slope = 0.0;
    if (a->curved)
        at(a, y, &slope);
    double norm = sqrt(1.0 + slope * slope);
    return vec2(slope / norm, 1.0 / norm);
}

static void measure(LAxis *a)
{
    a->length = 0.0;
    for (int i = 0; i < 4 * LAXIS_PARTS; i++)
        a->length += 1.0 / laxis_way(a, (i + 0.5) / (4 * LAXIS_PARTS)).y / (4 * LAXIS_PARTS);
}

/* --- the middle of a blade --- */

/* Sums of least squares for the terms' factors. */
typedef struct {
    double m[TERMS][TERMS], r[TERMS], widest;
    uint32_t n;
} Fit;

/* Terms and their derivatives: y (1 - y) (y - 1/2)^k. */
static void terms(double y, double f[TERMS], double slope[TERMS])
{
    double power = 1.0, below = 0.0, u = y - 0.5;
    for (int k = 0; k < TERMS; k++) {
        f[k] = y * (1.0 - y) * power;
        slope[k] = (1.0 - 2.0 * y) * power + y * (1.0 - y) * k * below;
        below = power;
        power *= u;
    }
}

static void add(Fit *fit, Vec2 p, double weight)
{
    double f[TERMS], slope[TERMS];
    if (!(p.y > 0.0 && p.y < 1.0))
        return;
    terms(p.y, f, slope);
    for (int i = 0; i < TERMS; i++) {
        for (int j = 0; j < TERMS; j++)
            fit->m[i][j] += weight * f[i] * f[j];
        fit->r[i] += weight * f[i] * p.x;
    }
    fit->n++;
}

/* By elimination: the matrix is positive definite when there are enough levels. */
static bool solve(Fit *fit, double factor[TERMS])
{
    if (fit->n < LEVELS / 4)
        return false;
    for (int i = 0; i < TERMS; i++) {
        if (!(fit->m[i][i] > 1e-14 * fit->m[0][0]))
            return false;
        for (int j = i + 1; j < TERMS; j++) {
            double by = fit->m[j][i] / fit->m[i][i];
            for (int k = i; k < TERMS; k++)
                fit->m[j][k] -= by * fit->m[i][k];
            fit->r[j] -= by * fit->r[i];
        }
    }
    for (int i = TERMS - 1; i >= 0; i--) {
        factor[i] = fit->r[i];
        for (int k = i + 1; k < TERMS; k++)
            factor[i] -= fit->m[i][k] * factor[k];
        factor[i] /= fit->m[i][i];
    }
    return true;
}

static void sample(const double factor[TERMS], LAxis *a)
{
    a->curved = true;
    for (int i = 0; i <= LAXIS_PARTS; i++) {
        double f[TERMS], slope[TERMS];
        terms((double)i / LAXIS_PARTS, f, slope);
        a->x[i] = a->slope[i] = 0.0;
        for (int k = 0; k < TERMS; k++) {
            a->x[i] += factor[k] * f[k];
            a->slope[i] += factor[k] * slope[k];
        }
    }
}

/* Where the level y crosses the blade, from left to right. */
static GArray *crossings(const Polygon *leaf, double y)
{
    GArray *x = g_array_new(FALSE, FALSE, sizeof(double));
    for (uint32_t i = 0; i < leaf->n; i++) {
        Vec2 p = leaf->v[i], q = leaf->v[i + 1 < leaf->n ? i + 1 : 0];
        if ((p.y <= y) == (q.y <= y))
            continue;
        double here = p.x + (q.x - p.x) * (y - p.y) / (q.y - p.y);
        guint k = x->len;
        while (k > 0 && g_array_index(x, double, k - 1) > here)
            k--;
        g_array_insert_val(x, k, here);
    }
    return x;
}

/* First guess: level by level from the base, the part of the blade that is nearest to the one below. */
static void fit_levels(const Polygon *leaf, Fit *fit)
{
    double last = 0.0;
    for (int i = 0; i < LEVELS; i++) {
        double y = (i + 0.5) / LEVELS, nearest = HUGE_VAL, middle = last, width = 0.0;
        GArray *x = crossings(leaf, y);
        for (guint k = 0; k + 1 < x->len; k += 2) {
            double left = g_array_index(x, double, k), right = g_array_index(x, double, k + 1);
            double off = last < left ? left - last : last > right ? last - right : 0.0;
            if (off < nearest) {
                nearest = off;
                middle = 0.5 * (left + right);
                width = right - left;
            }
        }
        g_array_unref(x);
        if (width > 0.0)
            add(fit, vec2(middle, y), width * width);
        last = middle;
    }
}

/* How far it is to a ray from the hub; no more than `most`. */
static double way_to_ray(Vec2 from, Vec2 direction, Vec2 hub, Vec2 ray, double most)
{
    double across = vec_cross(direction, ray);
    if (across == 0.0)
        return most;
    double way = vec_cross(vec_sub(hub, from), ray) / across;
    bool ahead = vec_dot(vec_sub(vec_add(from, vec_scale(direction, way)), hub), ray) > 0.0;
    return ahead && way > 0.0 ? MIN(way, most) : most;
}

/* To the margin, or to the sinus beside the middle lobe. */
static double way_across(const Polygon *leaf, const Lobes *lobes, Vec2 from, Vec2 direction)
{
    const Lobe *middle = &lobes->lobe[lobes->middle];
    double way = lobes_way(leaf, from, direction, 4.0);
    if (lobes->found == 0)
        return way;
    if (!middle->open_left)
        way = way_to_ray(from, direction, lobes->hub, middle->left, way);
    return middle->open_right ? way : way_to_ray(from, direction, lobes->hub, middle->right, way);
}

/* Half way between the margins, square to the line so far. */
static void fit_across(const Polygon *leaf, const Lobes *lobes, const LAxis *line, Fit *fit)
{
    for (int i = 0; i < LEVELS; i++) {
        double y = (i + 0.5) / LEVELS;
        Vec2 from = vec2(laxis_x(line, y), y), way = laxis_way(line, y), right = vec2(way.y, -way.x);
        if ((lobes->found > 0 && y <= lobes->hub.y) || !polygon_contains(leaf, from))
            continue;
        double r = way_across(leaf, lobes, from, right), l = way_across(leaf, lobes, from, vec_scale(right, -1.0));
        if (r > 0.0 && l > 0.0)
            add(fit, vec_add(from, vec_scale(right, 0.5 * (r - l))), (r + l) * (r + l));
        fit->widest = MAX(fit->widest, r + l);
    }
}

/* How many of its points lie in the blade. */
static uint32_t count_inside(const Polygon *leaf, const LAxis *a)
{
    uint32_t n = 0;
    for (int i = 0; i < LEVELS; i++)
        n += polygon_contains(leaf, vec2(laxis_x(a, (i + 0.5) / LEVELS), (i + 0.5) / LEVELS));
    return n;
}

static bool is_usable(const Polygon *leaf, const LAxis *a, double widest)
{
    const LAxis straight = {.curved = false};
    double most = 0.0, slope = 0.0;
    for (int i = 0; i <= LAXIS_PARTS; i++) {
        most = MAX(most, fabs(a->x[i]));
        slope = MAX(slope, fabs(a->slope[i]));
    }
    return most >= MAX(LAXIS_LEAST, LAXIS_LEAST_WIDTHS * widest) && slope <= steepest && count_inside(leaf, a) >= count_inside(leaf, &straight);
}

void laxis_of_blade(const Polygon *leaf, LAxis *out)
{
    Lobes lobes;
    LAxis line = {.curved = false};
    double widest = 0.0;
    lobes_find(leaf, &lobes);
    for (int round = 0; round <= ROUNDS; round++) {
        Fit fit = {.n = 0};
        double factor[TERMS];
        if (round > 0)
            fit_across(leaf, &lobes, &line, &fit);
        else if (lobes.found == 0)
            fit_levels(leaf, &fit);
        else
            continue; /* levels of a lobed blade go through its other lobes */
        if (!solve(&fit, factor)) {
            line.curved = false;
            break;
        }
        sample(factor, &line);
        widest = fit.widest;
    }
    if (line.curved && is_usable(leaf, &line, widest))
        measure(&line);
    else
        line.curved = false;
    *out = line;
}

/* --- along a midrib --- */

/* x at a level of a line that rises from point to point. */
static double level(const Vec2 *p, uint32_t n, double y)
{
    uint32_t i = 1;
    while (i + 1 < n && p[i].y < y)
        i++;
    return p[i - 1].x + (p[i].x - p[i - 1].x) * (y - p[i - 1].y) / (p[i].y - p[i - 1].y);
}

/* The midrib's points that lie above all before them, from the base to the tip; NULL when it turns back or lies too far from either. */
static GArray *rising(const Vec2 *point, uint32_t n)
{
    const double back = 0.01, low = 0.2, high = 0.7;
    const Vec2 base = vec2(0.0, 0.0), tip = vec2(0.0, 1.0);
    bool turned = n > 0 && point[n - 1].y < point[0].y, good = n >= 2;
    GArray *up = g_array_new(FALSE, FALSE, sizeof(Vec2));
    g_array_append_val(up, base);
    for (uint32_t i = 0; i < n && good; i++) {
        Vec2 p = point[turned ? n - 1 - i : i], last = g_array_index(up, Vec2, up->len - 1);
        good = p.y > last.y - back && isfinite(p.x) && (up->len > 1 || p.y < low);
        if (p.y > last.y + 1e-4 && p.y < 1.0 - 1e-4)
            g_array_append_val(up, p);
    }
    if (!good || g_array_index(up, Vec2, up->len - 1).y < high) {
        g_array_unref(up);
        return NULL;
    }
    g_array_append_val(up, tip);
    return up;
}

bool laxis_of_midrib(const Vec2 *point, uint32_t n, LAxis *out)
{
    enum { SMOOTHED = 4 }; /* times: over some 4 % of the length, as what is found goes from pixel to pixel */
    GArray *up = rising(point, n);
    if (!up)
        return false;
    LAxis a = {.curved = true};
    for (int i = 0; i <= LAXIS_PARTS; i++)
        a.x[i] = level((const Vec2 *)(gpointer)up->data, up->len, (double)i / LAXIS_PARTS);
    g_array_unref(up);
    for (int k = 0; k < SMOOTHED; k++) {
        double before = a.x[0];
        for (int i = 1; i < LAXIS_PARTS; i++) {
            double here = a.x[i];
            a.x[i] = 0.25 * (before + 2.0 * here + a.x[i + 1]);
            before = here;
        }
    }
    for (int i = 0; i <= LAXIS_PARTS; i++) {
        int below = MAX(i - 1, 0), above = MIN(i + 1, LAXIS_PARTS);
        a.slope[i] = (a.x[above] - a.x[below]) / (above - below) * LAXIS_PARTS;
        if (!(fabs(a.slope[i]) <= steepest))
            return false;
    }
    measure(&a);
    *out = a;
    return true;
}
