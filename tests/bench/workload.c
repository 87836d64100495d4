#include "workload.h"

#include "lib/settings.h"

/* splitmix64, 53 bits of it. */
static double next(uint64_t *state)
{
    uint64_t z = *state += 0x9E3779B97F4A7C15u;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

/* The file format of the workload has six decimals. */
static double six_decimals(double x)
{
    return rint(x * 1e6) / 1e6;
}

/* Dart throwing over the ellipse with half axes b and a = 2 b, base at the origin. A grid finds the neighbours. */
static void throw_darts(Workload *w, uint64_t seed, double b)
{
    const double nearest = 3.5, cell = nearest / sqrt(2.0), a = 2.0 * b;
    uint32_t nx = (uint32_t)(2.0 * b / cell) + 5, ny = (uint32_t)(2.0 * a / cell) + 5;
    uint32_t *grid = g_new0(uint32_t, (gsize)nx * ny);
    Vec2 *exact = g_new(Vec2, w->n);
    for (uint32_t count = 0; count < w->n;) {
        double x = (2.0 * next(&seed) - 1.0) * b;
        double y = 2.0 * a * next(&seed);
        if (x / b * (x / b) + (y - a) / a * ((y - a) / a) > 1.0)
            continue;
        uint32_t cx = (uint32_t)((x + b) / cell) + 2, cy = (uint32_t)(y / cell) + 2;
        gboolean free = TRUE;
        for (uint32_t i = cx - 2; i <= cx + 2 && free; i++)
            for (uint32_t j = cy - 2; j <= cy + 2 && free; j++) {
                uint32_t k = grid[(gsize)j * nx + i];
                free = !k || !(vec_dist2(exact[k - 1], vec2(x, y)) < nearest * nearest);
            }
        if (!free)
            continue;
        exact[count] = vec2(x, y);
        w->source[count] = (ListedSource){{six_decimals(x), six_decimals(y)}, 0};
        grid[(gsize)cy * nx + cx] = ++count;
    }
    g_free(exact);
    g_free(grid);
}

/* An ellipse of height 1, its base a hair below the origin, as a polygon around it. */
static Polygon *ellipse(void)
{
    enum { N = 720 };
    Vec2 v[N];
    double out = 1.0 / cos(G_PI / N);
    for (uint32_t i = 0; i < N; i++) {
        double t = 2.0 * G_PI * i / N;
        v[i] = vec2(0.25 * out * cos(t), 0.5 + 0.5 * out * sin(t));
    }
    return polygon_new(v, N);
}

/* Half of the shorter axis of the ellipse that n sources fill. */
static double half_width(uint32_t n)
{
    const double spacing = 5.0;
    return sqrt(n * spacing * spacing / (2.0 * G_PI));
}

static void define(Workload *w, Pattern pattern, double b)
{
    w->leaf = ellipse();
    w->def = simulation_def_default();
    w->def.leaf = w->leaf;
    w->def.growth.kind = GROWTH_NONE;
    w->def.growth.initial_length = 4.0 * b;
    w->def.placement = PLACEMENT_LIST;
    w->def.list = w->source;
    w->def.n_list = w->n;
    w->def.pattern = pattern;
    w->def.kill_distance = 2.0;
    w->def.sinus_depth = 10.0;
}

Workload *workload_new(uint32_t n, uint64_t seed, Pattern pattern)
{
    Workload *w = g_new0(Workload, 1);
    w->n = n;
    w->source = g_new(ListedSource, n);
    throw_darts(w, seed, half_width(n));
    define(w, pattern, half_width(n));
    return w;
}

Workload *workload_read(const char *path, GError **error)
{
    Workload *w = g_new0(Workload, 1);
    if (!source_list_read(path, &w->source, &w->n, error)) {
        g_free(w);
        return NULL;
    }
    double b = half_width(MAX(w->n, 1)), most = 1e3 * b;
    for (uint32_t i = 0; i < w->n && b < most; i++) { /* wide enough for all */
        Vec2 p = w->source[i].pos;
        w->source[i].step = 0;
        while (b < most && p.x * p.x / (b * b) + (p.y / (2.0 * b) - 1.0) * (p.y / (2.0 * b) - 1.0) > 1.000001)
            b *= 1.05;
        if (b >= most)
            g_set_error(error, SIMULATION_ERROR, SIMULATION_ERROR_SOURCES,
                        "%s: source %u at %g,%g lies in no ellipse that stands on the base at 0,0, tip along +y", path, i + 1, p.x, p.y);
    }
    if (w->n == 0)
        g_set_error(error, SIMULATION_ERROR, SIMULATION_ERROR_SOURCES, "%s: holds no source", path);
    if (w->n == 0 || b >= most) {
        g_free(w->source);
        g_free(w);
        return NULL;
    }
    define(w, PATTERN_OPEN, b);
    return w;
}

void workload_free(Workload *w)
{
    polygon_free(w->leaf);
    g_free(w->source);
    g_free(w);
}
