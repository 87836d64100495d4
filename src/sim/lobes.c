#include "sim/lobes.h"

#include <string.h>

#include "geom/bezier.h"

enum {
    PER_DEGREE = 2,
    HALF = 180 * PER_DEGREE, /* ray HALF runs along the axis, 0 and RAYS - 1 back along the petiole; from right to left */
    RAYS = 2 * HALF + 1,
    WINDOW = 5,              /* rays either side that are averaged: 2.5° */
    SIDE = LOBES_MOST / 2
};

/* Least prominence of a lobe, of one that has a partner, and of teeth; parts of the way to the tip. */
static const double prominent = 0.15, partner = 0.05;
/* A lobe's tip is no nearer than that, parts of the way to the leaf's: a petiole's stump is no lobe. */
static const double least_way = 0.25;
/* Degrees: least angle between primaries, largest without one, and how far partners may differ. */
static const double least_apart = 15.0, most_apart = 75.0, alike = 25.0;

/* What is seen from a point: the way to the margin by direction. */
typedef struct {
    double way[RAYS], mean[RAYS];
} View;

static double degrees_of(int ray) { return (double)(ray - HALF) / PER_DEGREE; }

static int ray_of(double degrees) { return CLAMP((int)floor(degrees * PER_DEGREE + 0.5) + HALF, 0, RAYS - 1); }

static Vec2 direction_of(double degrees)
{
    double sine, cosine;
    degrees_sincos(90.0 + degrees, &sine, &cosine);
    return vec2(cosine, sine);
}

double lobes_way(const Polygon *p, Vec2 at, Vec2 direction, double most)
{
    double first = most;
    for (uint32_t i = 0; i < p->n; i++) {
        Vec2 c = vec_sub(p->v[i], at), d = vec_sub(p->v[i + 1 < p->n ? i + 1 : 0], at);
        double a = vec_cross(direction, c), b = vec_cross(direction, d);
        if ((a > 0.0 && b > 0.0) || (a < 0.0 && b < 0.0) || a == b)
            continue;
        double t = vec_dot(direction, vec_lerp(c, d, a / (a - b)));
        if (t > 1e-9 * most && t < first)
            first = t;
    }
    return polygon_contains(p, vec_add(at, vec_scale(direction, 0.5 * first))) ? first : 0.0;
}

/* --- the hub --- */

static double farthest(const Polygon *p)
{
    return sqrt(vec_norm2(vec2(MAX(-p->box.x0, p->box.x1), MAX(-p->box.y0, p->box.y1)))) + 1.0;
}

static Vec2 find_hub(const Polygon *leaf)
{
    enum { HEIGHTS = 13 };
    double seen[HEIGHTS], most = 0.0, far = farthest(leaf);
    for (int k = 0; k < HEIGHTS; k++) {
        seen[k] = 0.0;
        for (int degrees = -179; degrees <= 179; degrees += 2) {
            double way = lobes_way(leaf, vec2(0.0, 0.01 * k), direction_of(degrees), far);
            seen[k] += way * way;
        }
        most = MAX(most, seen[k]);
    }
    int k = 0;
    while (seen[k] < 0.93 * most)
        k++;
    return vec2(0.0, 0.01 * k);
}

static View *look(const Polygon *leaf, Vec2 hub)
{
    View *v = g_new0(View, 1);
    double far = farthest(leaf);
    for (int k = 1; k < RAYS - 1; k++)
        v->way[k] = lobes_way(leaf, hub, direction_of(degrees_of(k)), far);
    for (int k = WINDOW; k < RAYS - WINDOW; k++) {
        for (int j = -WINDOW; j <= WINDOW; j++)
            v->mean[k] += v->way[k + j];
        v->mean[k] /= 2 * WINDOW + 1;
    }
    return v;
}

/* --- maxima --- */

/* The lowest mean between ray k and the first higher one in a direction; of equals the one on the right is the higher. */
static double saddle(const View *v, int k, int by)
{
    double least = v->mean[k];
    for (int j = k + by; j >= 0 && j < RAYS; j += by) {
        if (v->mean[j] > v->mean[k] || (v->mean[j] == v->mean[k] && by < 0))
            break;
        least = MIN(least, v->mean[j]);
    }
    return least;
}

/* How much a maximum stands out, as part of the way to it; 0 for other rays. */
static double prominence(const View *v, int k)
{
    if (k < 1 || k > RAYS - 2 || !(v->mean[k] > v->mean[k - 1] && v->mean[k] >= v->mean[k + 1]))
        return 0.0;
    return 1.0 - MAX(saddle(v, k, -1), saddle(v, k, 1)) / v->mean[k];
}

/* The longest ray near a maximum that does not graze the margin. */
static int sharpen(const View *v, int peak)
{
    int best = peak;
    for (int k = MAX(peak - WINDOW, 2); k <= MIN(peak + WINDOW, RAYS - 3); k++) {
        double least = v->way[k];
        for (int j = -2; j <= 2; j++)
            least = MIN(least, v->way[k + j]);
        if (v->way[k] > v->way[best] && least > 0.8 * v->way[k])
            best = k;
    }
    return best;
}

/* --- primaries of each side --- */

/* Rays of one side's primaries, outwards. */
typedef struct {
    int n, ray[SIDE];
} Side;

static double off_axis(int ray) { return fabs(degrees_of(ray)); }

static bool has_room(const View *v, const Side *s, int ray)
{
    bool room = s->n < SIDE && off_axis(ray) >= least_apart && v->way[ray] >= least_way * v->way[HALF];
    for (int i = 0; i < s->n; i++)
        room &= fabs(degrees_of(ray) - degrees_of(s->ray[i])) >= least_apart;
    return room;
}

static void insert(Side *s, int ray)
{
    int i = s->n++;
    for (; i > 0 && off_axis(s->ray[i - 1]) > off_axis(ray); i--)
        s->ray[i] = s->ray[i - 1];
    s->ray[i] = ray;
}

/* Maxima on one side (+1 left) that stand out enough, the most prominent first. */
static void see(const View *v, int side, Side *s)
{
    double last = HUGE_VAL;
    for (;;) {
        int best = -1;
        double most = 0.0;
        for (int k = 0; k <= HALF; k++) {
            double p = prominence(v, HALF + side * k);
            if (p >= prominent && p < last && p > most) {
                most = p;
                best = HALF + side * k;
            }
        }
        if (best < 0)
            return;
        last = most;
        best = sharpen(v, best);
        if (has_room(v, s, best))
            insert(s, best);
    }
}

static bool has_partner(const Side *s, int ray)
{
    for (int i = 0; i < s->n; i++)
        if (fabs(off_axis(s->ray[i]) - off_axis(ray)) <= alike)
            return true;
    return false;
}

/* For each primary of one side that has none on the other: the best maximum there, however low, or its mirror image. */
static void pair(const View *v, const Side *from, Side *to)
{
    Side had = *to;
    for (int i = 0; i < from->n; i++) {
        int mirror = 2 * HALF - from->ray[i], best = mirror;
        if (has_partner(&had, mirror))
            continue;
        double most = partner;
        for (int k = MAX(mirror - 20 * PER_DEGREE, 0); k <= MIN(mirror + 20 * PER_DEGREE, RAYS - 1); k++)
            if (prominence(v, k) > most) {
                most = prominence(v, k);
                best = sharpen(v, k);
            }
        if (has_room(v, to, best) && v->way[best] >= 0.5 * v->way[from->ray[i]])
            insert(to, best);
    }
}

/* Degrees from the axis to where one side of the blade ends. */
static double aperture(const View *v, int side)
{
    double longest = v->mean[HALF];
    int k = HALF;
    while (k > 0 && k < RAYS - 1 && v->mean[k] >= 0.2 * longest) {
        longest = MAX(longest, v->mean[k]);
        k += side;
    }
    return off_axis(k);
}

/* Primaries where too wide an angle has none. */
static void fill(const View *v, int side, Side *s)
{
    double end = aperture(v, side), start = s->n ? off_axis(s->ray[s->n - 1]) : 0.0;
    for (int i = 0; i < s->n && s->n < SIDE; i++) {
        double inner = i ? off_axis(s->ray[i - 1]) : 0.0, outer = off_axis(s->ray[i]);
        int between = ray_of(side * 0.5 * (inner + outer));
        if (outer - inner > most_apart && has_room(v, s, between))
            insert(s, between);
    }
    if (end - start <= (s->n ? most_apart : least_apart))
        return;
    int more = MIN(1 + (end - start > 70.0) + (end - start > 120.0) - (s->n > 0), SIDE - s->n);
    for (int i = 1; i <= more; i++) {
        int ray = ray_of(side * (start + (end - start) * i / (more + 0.5)));
        if (has_room(v, s, ray))
            insert(s, ray);
    }
}

/* --- lobes --- */

/* Degrees of the sinus between two primaries, within the middle part of the angle. */
static double sinus(const View *v, int right, int left)
{
    int from = right + (3 * (left - right)) / 10, to = left - (3 * (left - right)) / 10, best = (right + left) / 2;
    for (int k = from; k <= to; k++)
        if (v->mean[k] < v->mean[best])
            best = k;
    return degrees_of(best);
}

static void take(const View *v, const int *ray, Lobes *out)
{
    for (uint32_t i = 0; i < out->n; i++) {
        Lobe *lobe = &out->lobe[i];
        *lobe = (Lobe){.open_left = i == 0, .open_right = i + 1 == out->n};
        lobe->tip = i == out->middle ? vec2(0.0, 1.0)
                                     : vec_add(out->hub, vec_scale(direction_of(degrees_of(ray[i])), v->way[ray[i]]));
        if (!lobe->open_left)
            lobe->left = direction_of(sinus(v, ray[i], ray[i - 1]));
        if (!lobe->open_right)
            lobe->right = direction_of(sinus(v, ray[i + 1], ray[i]));
    }
}

void lobes_find(const Polygon *leaf, Lobes *out)
{
    Side left = {0}, right = {0};
    *out = (Lobes){.hub = find_hub(leaf)};
    View *v = look(leaf, out->hub);
    see(v, 1, &left);
    see(v, -1, &right);
    out->found = (uint32_t)MIN(left.n, right.n);
    Side seen = left;
    pair(v, &right, &left);
    pair(v, &seen, &right);
    fill(v, 1, &left);
    fill(v, -1, &right);
    int ray[LOBES_MOST], n = 0;
    for (int i = left.n - 1; i >= 0; i--)
        ray[n++] = left.ray[i];
    out->middle = (uint32_t)n;
    ray[n++] = HALF;
    for (int i = 0; i < right.n; i++)
        ray[n++] = right.ray[i];
    out->n = (uint32_t)n;
    take(v, ray, out);
    g_free(v);
}
