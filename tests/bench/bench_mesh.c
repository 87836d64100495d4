/* How meshing scales: time and memory a triangle for growing meshes, and the order of insertion beside the naive ones.
 *
 *     bench_mesh [--quick]
 *
 * Times are CPU time of mesh_new, all in: check, triangulation, refinement, copying out and freeing; those in input order are of GTS's
 * plain insertion of the points alone. Each run is a process of its own, so that its peak memory is its own. */
#include <gts.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "geom/dtrig.h"
#include "geom/mesh.h"

typedef struct {
    double seconds;
    uint32_t points, triangles;
    long peak; /* growth of the process's peak memory, bytes */
} Result;

static double cpu_seconds(void)
{
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) + 1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

static long peak_memory(void)
{
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss * 1024L;
}

/* ---- a leaf: an ellipse, a midrib from its first point, and secondary veins to both sides up to the margin ---- */

static bool is_within(Vec2 p) { return 4.0 * p.x * p.x + p.y * p.y < 0.94; }

static void add(Pslg *g, uint32_t from, Vec2 p)
{
    g->segment[g->n_segments][0] = from;
    g->segment[g->n_segments++][1] = g->n_points;
    g->point[g->n_points++] = p;
}

/* About n_veins points on veins. */
static Pslg *leaf(uint32_t n_outline, uint32_t n_veins)
{
    Pslg *g = pslg_new(n_outline + 2 * n_veins + 100, n_outline, 2 * n_veins + 100);
    for (uint32_t i = 0; i < n_outline; i++) {
        double t = 2.0 * DTRIG_PI * i / n_outline - 0.5 * DTRIG_PI;
        g->point[i] = vec2(0.5 * dtrig_cos(t), dtrig_sin(t));
    }
    g->n_points = n_outline;
    g->n_segments = 0;
    double step = n_veins ? sqrt(2.1 / n_veins) : 10.0;
    uint32_t rib = 0;
    for (Vec2 p = vec2(0.0, step - 1.0); p.y < 0.9; p.y += step) {
        add(g, rib, p);
        rib = g->n_points - 1;
        for (int side = -1; side <= 1; side += 2) {
            uint32_t from = rib;
            for (Vec2 q = vec2(p.x + 0.7 * step * side, p.y + 0.4 * step); is_within(q) && g->n_segments < 2 * n_veins;
                 q = vec2(q.x + 0.7 * step * side, q.y + 0.4 * step)) {
                add(g, from, q);
                from = g->n_points - 1;
            }
        }
    }
    return g;
}

/* ---- runs ---- */

typedef enum { OURS, INPUT_ORDER, INPUT_ORDER_LAST_FACE } How;

typedef struct {
    uint32_t n_outline, n_veins;
    MeshDef def;
    How how;
} Run;

static GtsFace *face_at(const GtsVertex *v)
{
    for (GSList *s = v->segments; s; s = s->next)
        if (((GtsEdge *)s->data)->triangles)
            return ((GtsEdge *)s->data)->triangles->data;
    return NULL;
}

/* GTS's plain triangulation of the points alone. */
static uint32_t insert_naively(const Pslg *g, bool last_face)
{
    GtsSurface *s = gts_surface_new(gts_surface_class(), gts_face_class(), gts_edge_class(), gts_vertex_class());
    GtsVertex *a = gts_vertex_new(gts_vertex_class(), -40, -20, 0), *b = gts_vertex_new(gts_vertex_class(), 40, -20, 0);
    GtsVertex *c = gts_vertex_new(gts_vertex_class(), 0, 40, 0);
    GtsEdge *ab = gts_edge_new(gts_edge_class(), a, b), *bc = gts_edge_new(gts_edge_class(), b, c);
    gts_surface_add_face(s, gts_face_new(gts_face_class(), ab, bc, gts_edge_new(gts_edge_class(), c, a)));
    GtsVertex *last = NULL;
    for (uint32_t i = 0; i < g->n_points; i++) {
        GtsVertex *v = gts_vertex_new(gts_vertex_class(), g->point[i].x, g->point[i].y, 0);
        gts_delaunay_add_vertex(s, v, last && last_face ? face_at(last) : NULL);
        last = v;
    }
    return gts_surface_face_number(s);
}

static Result measure(const Run *run)
{
    Result r = {0};
    Pslg *g = leaf(run->n_outline, run->n_veins);
    r.points = g->n_points;
    long before = peak_memory();
    double start = cpu_seconds();
    if (run->how == OURS) {
        GError *error = NULL;
        Mesh *m = mesh_new(g, &run->def, &error);
        if (!m) {
            fprintf(stderr, "%s\n", error->message);
            _exit(1);
        }
        r.triangles = m->n_triangles;
    } else {
        r.triangles = insert_naively(g, run->how == INPUT_ORDER_LAST_FACE);
    }
    r.seconds = cpu_seconds() - start;
    r.peak = peak_memory() - before;
    return r;
}

static Result run_apart(const Run *run)
{
    Result r;
    int channel[2];
    fflush(stdout);
    if (pipe(channel) != 0)
        g_error("no pipe");
    pid_t child = fork();
    if (child == 0) {
        r = measure(run);
        gssize n = write(channel[1], &r, sizeof r);
        _exit(n == (gssize)sizeof r ? 0 : 1);
    }
    close(channel[1]);
    gssize n = read(channel[0], &r, sizeof r);
    close(channel[0]);
    waitpid(child, NULL, 0);
    if (n != (gssize)sizeof r)
        g_error("a run failed");
    return r;
}

/* ---- tables ---- */

static void heading(const char *title)
{
    printf("\n%s\n\n| %-34s | %8s | %9s | %8s | %8s | %8s |\n", title, "case", "points", "triangles", "seconds", "us/tri", "bytes/t");
    printf("| ---------------------------------- | -------: | --------: | -------: | -------: | -------: |\n");
}

static void row(const char *name, const Result *r)
{
    printf("| %-34s | %8u | %9u | %8.3f | %8.2f | %8.0f |\n", name, r->points, r->triangles, r->seconds,
           r->seconds * 1e6 / r->triangles, (double)r->peak / r->triangles);
    fflush(stdout);
}

/* The leaf's area is π/2; meshes of a greatest area have about 1.7 times as many triangles as fit. */
static void bench_sizes(const char *title, uint32_t n_outline, uint32_t n_veins, double min_angle, double from, double to)
{
    heading(title);
    for (double wanted = from; wanted <= to; wanted *= 10.0) {
        Run run = {n_outline, n_veins, {.min_angle = min_angle, .max_area = 2.7 / wanted}, OURS};
        Result r = run_apart(&run);
        char *name = g_strdup_printf("%g wanted, %g degrees", wanted, min_angle);
        row(name, &r);
        g_free(name);
    }
}

static void bench_order(uint32_t most)
{
    static const char *const words[] = {"ours", "input order", "input order, last face"};
    heading("Order: ours, beside points in input order");
    for (uint32_t n = 1000; n <= most; n *= 4)
        for (int veins = 0; veins < 2; veins++)
            for (int how = OURS; how <= (n > 4000 ? OURS : INPUT_ORDER_LAST_FACE); how++) { /* a curve of 16 000 points: minutes */
                Run run = {veins ? n / 10 : n, veins ? n - n / 10 : 0, {.min_angle = 0.0}, (How)how};
                Result r = run_apart(&run);
                char *name = g_strdup_printf("%s: %s", veins ? "veins" : "curve", words[how]);
                row(name, &r);
                g_free(name);
            }
}

int main(int argc, char **argv)
{
    bool quick = argc > 1 && strcmp(argv[1], "--quick") == 0;
    double to = quick ? 1e4 : 1e6;
    bench_sizes("A leaf of 1 000 points on the margin and 1 000 on veins", 1000, 1000, 20.0, 1e4, to);
    bench_sizes("The same, 28 degrees", 1000, 1000, 28.0, 1e4, to);
    if (!quick)
        bench_sizes("10 000 points on the margin and 100 000 on veins", 10000, 100000, 20.0, 1e6, 1e6);
    bench_order(quick ? 1000 : 256000);
    return 0;
}
