#include "geom/teeth.h"

/* One side, measured along its arc. */
typedef struct {
    const OutlineDef *def;
    const Vec2 *v;
    double *arc; /* [n] arc length from the base to each vertex */
    uint32_t n;
    double window; /* half the stretch of margin whose chord gives the direction at a point */
} Side;

static double side_length(const Side *s) { return s->arc[s->n - 1]; }

/* The point at arc length a, which is held within the side. */
static Vec2 side_point(const Side *s, double a)
{
    uint32_t lo = 0, hi = s->n - 1;
    while (hi - lo > 1) {
        uint32_t m = lo + (hi - lo) / 2;
        *(s->arc[m] <= a ? &lo : &hi) = m;
    }
    double t = (a - s->arc[lo]) / (s->arc[hi] - s->arc[lo]);
    return t <= 0.0 ? s->v[lo] : t >= 1.0 ? s->v[hi] : vec_lerp(s->v[lo], s->v[hi], t);
}

/* Unit normal to the right of the walk. Taken across a stretch of margin, it turns smoothly at corners, so that teeth
 * on their two flanks do not run into each other. */
static Vec2 side_normal(const Side *s, double a)
{
    Vec2 d = vec_sub(side_point(s, a + s->window), side_point(s, a - s->window));
    double length = sqrt(vec_norm2(d));
    return length > 0.0 ? vec2(d.y / length, -d.x / length) : vec2(0.0, 0.0);
}

static bool wave_bears(const OutlineWave *w) { return w->amplitude > 0.0 && w->count >= 1.0; }

/* Summed height of the waveforms at arc length a. */
static double wave_height(const Side *s, double a)
{
    const OutlineDef *def = s->def;
    double along = (a / side_length(s) - def->tooth_from) / (def->tooth_to - def->tooth_from), height = 0.0;
    for (uint32_t k = 0; k < def->n_waves; k++) {
        double periods = along * def->waves[k].count, whole = floor(periods), phase = periods - whole;
        if (!wave_bears(&def->waves[k]) || periods < 0.0 || whole >= floor(def->waves[k].count))
            continue;
        double skew = def->tooth_skew;
        height += def->waves[k].amplitude * (phase < skew ? phase / skew : (1.0 - phase) / (1.0 - skew));
    }
    return height;
}

static int compare(gconstpointer a, gconstpointer b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Arc lengths of the valleys and peaks of one waveform. */
static void wave_stops(const Side *s, const OutlineWave *w, GArray *stops)
{
    const OutlineDef *def = s->def;
    double teeth = floor(w->count), length = side_length(s), range = def->tooth_to - def->tooth_from;
    for (double k = 0.0; k <= teeth; k += 1.0) {
        double valley = length * (def->tooth_from + range * k / w->count);
        double peak = length * (def->tooth_from + range * (k + def->tooth_skew) / w->count);
        g_array_append_val(stops, valley);
        if (k < teeth)
            g_array_append_val(stops, peak);
    }
}

/* All arc lengths at which the toothed margin has a vertex, in order. */
static GArray *side_stops(const Side *s)
{
    GArray *stops = g_array_new(FALSE, FALSE, sizeof(double));
    g_array_append_vals(stops, s->arc, s->n);
    for (uint32_t k = 0; k < s->def->n_waves; k++)
        if (wave_bears(&s->def->waves[k]))
            wave_stops(s, &s->def->waves[k], stops);
    g_array_sort(stops, compare);
    return stops;
}

/* A quarter of the shortest period, so that neighbouring teeth have normals of their own. */
static double side_window(const Side *s)
{
    double most = 1.0;
    for (uint32_t k = 0; k < s->def->n_waves; k++)
        if (wave_bears(&s->def->waves[k]) && s->def->waves[k].count > most)
            most = s->def->waves[k].count;
    double window = 0.25 * side_length(s) * (s->def->tooth_to - s->def->tooth_from) / most;
    return window < 0.02 ? window : 0.02;
}

GArray *teeth_apply(const OutlineDef *def, const Vec2 *side, uint32_t n, double outward)
{
    Side s = {.def = def, .v = side, .n = n, .arc = g_new(double, n)};
    s.arc[0] = 0.0;
    for (uint32_t i = 1; i < n; i++)
        s.arc[i] = s.arc[i - 1] + vec_dist(side[i - 1], side[i]);
    s.window = side_window(&s);

    GArray *stops = side_stops(&s), *points = g_array_new(FALSE, FALSE, sizeof(Vec2));
    double last = -1.0, nearest = 1e-9 * side_length(&s);
    for (guint k = 0; k < stops->len; k++) {
        double a = g_array_index(stops, double, k);
        if (a - last < nearest)
            continue;
        last = a;
        Vec2 lift = vec_scale(side_normal(&s, a), outward * wave_height(&s, a));
        Vec2 p = vec_add(side_point(&s, a), lift);
        g_array_append_val(points, p);
    }
    g_array_index(points, Vec2, 0) = side[0];
    g_array_index(points, Vec2, points->len - 1) = side[n - 1];
    g_array_unref(stops);
    g_free(s.arc);
    return points;
}
