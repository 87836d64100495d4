/* How the membrane's factor and its poses scale, beside conjugate gradients with Jacobi's preconditioner.
 *
 *     bench_membrane [--quick]
 *
 * A lens-shaped leaf of jittered equilateral triangles, numbered at random, with a midrib and twelve side veins on either side, which
 * stay the same as the mesh gets finer. A pose is three right-hand sides; conjugate gradients start from 0 and end at a residual of 1e-8.
 * One thread. Ends with 1 when the two disagree. The aim: 60 poses a second at 20 000 vertices. */
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>

#include "geom/random.h"
#include "shape/membrane.h"
#include "shape/voronoi.h"

#define NONE UINT32_MAX

enum { SIDE_VEINS = 12 };

typedef struct {
    Mesh mesh;
    uint32_t n_fixed, *fixed;
    Vec3 *posed;
} Leaf;

static double now(void) { return (double)g_get_monotonic_time() * 1e-6; }

/* ---- the leaf ---- */

/* Lattice point (i, j) of side h lies at ((i + j / 2) h, j h √3/4); the leaf is |y| <= 0.4 (1 - x²). */
typedef struct {
    double h;
    int reach_i, reach_j; /* greatest |i|, |j| */
    uint32_t *vertex;     /* by lattice point, NONE outside */
} Lattice;

static Vec2 lattice_point(const Lattice *l, int i, int j) { return vec2((i + 0.5 * j) * l->h, j * l->h * sqrt(0.75)); }

static bool in_leaf(Vec2 p) { return fabs(p.y) <= 0.4 * (1.0 - p.x * p.x); }

static uint32_t *lattice_at(const Lattice *l, int i, int j)
{
    return &l->vertex[(gsize)(j + l->reach_j) * (2 * (gsize)l->reach_i + 1) + (gsize)(i + l->reach_i)];
}

/* Veins are the lattice's own lines: the midrib and, at 60° to it, every so many. */
static bool on_vein(const Lattice *l, int i, int j)
{
    int every = MAX(1, (int)(2.0 / (l->h * (SIDE_VEINS + 1))));
    return j == 0 || (j > 0 ? i : i + j) % every == 0;
}

/* n numbers 0 … n - 1 in an order that memory knows nothing of. */
static uint32_t *shuffled(uint32_t n)
{
    uint32_t *order = g_new(uint32_t, n);
    for (uint32_t i = 0; i < n; i++) {
        double u[2];
        random_pair(5, 1, 0, i, u);
        uint32_t k = (uint32_t)(u[0] * (i + 1));
        order[i] = order[k];
        order[k] = i;
    }
    return order;
}

static void add_triangle(Mesh *m, uint32_t a, uint32_t b, uint32_t c)
{
    if (a == NONE || b == NONE || c == NONE)
        return;
    uint32_t *at = m->triangle[m->n_triangles++];
    at[0] = a, at[1] = b, at[2] = c;
}

static uint32_t count_points(const Lattice *l)
{
    uint32_t n = 0;
    for (int j = -l->reach_j; j <= l->reach_j; j++)
        for (int i = -l->reach_i; i <= l->reach_i; i++)
            n += in_leaf(lattice_point(l, i, j));
    return n;
}

/* Places, numbers and, on the veins, a pose: the blade folded along the midrib and waving along it. */
static void leaf_points(Leaf *leaf, Lattice *l)
{
    uint32_t k = 0, *order = shuffled(leaf->mesh.n_vertices);
    for (int j = -l->reach_j; j <= l->reach_j; j++)
        for (int i = -l->reach_i; i <= l->reach_i; i++) {
            Vec2 p = lattice_point(l, i, j);
            double u[2];
            *lattice_at(l, i, j) = NONE;
            if (!in_leaf(p))
                continue;
            uint32_t v = *lattice_at(l, i, j) = order[k++];
            random_pair(5, 2, 0, v, u);
            leaf->mesh.vertex[v] = p = vec_add(p, vec_scale(vec2(u[0] - 0.5, u[1] - 0.5), 0.2 * l->h));
            if (on_vein(l, i, j)) {
                leaf->posed[leaf->n_fixed] = vec3(p.x, 0.9 * p.y, 0.5 * fabs(p.y) + 0.3 * p.x * p.x * (1.0 + p.y));
                leaf->fixed[leaf->n_fixed++] = v;
            }
        }
    g_free(order);
}

static Leaf *leaf_new(uint32_t triangles)
{
    Leaf *leaf = g_new0(Leaf, 1);
    Mesh *m = &leaf->mesh;
    Lattice l = {.h = sqrt(0.8 * 4.0 / 3.0 / (triangles * sqrt(3.0) / 4.0))};
    l.reach_j = (int)(0.4 / (l.h * sqrt(0.75))) + 1;
    l.reach_i = (int)(1.0 / l.h) + l.reach_j + 1;
    l.vertex = g_new(uint32_t, (2 * (gsize)l.reach_i + 1) * (2 * (gsize)l.reach_j + 1));
    m->n_vertices = count_points(&l);
    m->vertex = g_new(Vec2, m->n_vertices);
    m->triangle = g_malloc_n(2 * (gsize)m->n_vertices, sizeof *m->triangle);
    leaf->fixed = g_new(uint32_t, m->n_vertices);
    leaf->posed = g_new(Vec3, m->n_vertices);
    leaf_points(leaf, &l);
    for (int j = -l.reach_j; j < l.reach_j; j++)
        for (int i = -l.reach_i; i < l.reach_i; i++) {
            uint32_t a = *lattice_at(&l, i, j), b = *lattice_at(&l, i + 1, j);
            uint32_t c = *lattice_at(&l, i, j + 1), d = *lattice_at(&l, i + 1, j + 1);
            add_triangle(m, a, b, c);
            add_triangle(m, b, d, c);
        }
    g_free(l.vertex);
    return leaf;
}

static void leaf_free(Leaf *leaf)
{
    g_free(leaf->mesh.vertex);
    g_free(leaf->mesh.triangle);
    g_free(leaf->fixed);
    g_free(leaf->posed);
    g_free(leaf);
}

/* ---- the plain way ---- */

typedef struct {
    uint32_t n;
    double *x, *r, *z, *p, *q, *inverse; /* [n_vertices]; 0 at fixed vertices but for x */
    bool *held;
} Gradients;

/* out = -L in at free vertices. */
static void multiply(const Voronoi *v, const Gradients *g, const double *in, double *out)
{
    for (uint32_t i = 0; i < g->n; i++) {
        double sum = 0.0;
        if (!g->held[i])
            for (uint32_t k = v->start[i]; k < v->start[i + 1]; k++)
                sum += v->weight[k] * (in[i] - in[v->neighbour[k]]);
        out[i] = sum;
    }
}

static double dot(const Gradients *g, const double *a, const double *b)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < g->n; i++)
        sum += a[i] * b[i];
    return sum;
}

/* g->x holds the fixed values, 0 elsewhere; returns the number of iterations. */
static uint32_t gradients_solve(const Voronoi *v, Gradients *g)
{
    multiply(v, g, g->x, g->q);
    for (uint32_t i = 0; i < g->n; i++) {
        g->r[i] = -g->q[i];
        g->p[i] = g->z[i] = g->inverse[i] * g->r[i];
    }
    double rz = dot(g, g->r, g->z), end = 1e-16 * dot(g, g->r, g->r);
    uint32_t round = 0;
    for (; round < 100000 && dot(g, g->r, g->r) > end; round++) {
        multiply(v, g, g->p, g->q);
        double step = rz / dot(g, g->p, g->q), before = rz;
        for (uint32_t i = 0; i < g->n; i++) {
            g->x[i] += step * g->p[i];
            g->r[i] -= step * g->q[i];
            g->z[i] = g->inverse[i] * g->r[i];
        }
        rz = dot(g, g->r, g->z);
        for (uint32_t i = 0; i < g->n; i++)
            g->p[i] = g->z[i] + rz / before * g->p[i];
    }
    return round;
}

static Gradients gradients_new(const Voronoi *v, const Leaf *leaf)
{
    uint32_t n = v->n;
    Gradients g = {n, g_new(double, n), g_new(double, n), g_new(double, n), g_new(double, n), g_new(double, n), g_new(double, n),
                   g_new0(bool, n)};
    for (uint32_t f = 0; f < leaf->n_fixed; f++)
        g.held[leaf->fixed[f]] = true;
    for (uint32_t i = 0; i < n; i++) {
        double sum = 0.0;
        for (uint32_t k = v->start[i]; k < v->start[i + 1]; k++)
            sum += v->weight[k];
        g.inverse[i] = g.held[i] ? 0.0 : 1.0 / sum;
    }
    return g;
}

static void gradients_clear(Gradients *g)
{
    g_free(g->x);
    g_free(g->r);
    g_free(g->z);
    g_free(g->p);
    g_free(g->q);
    g_free(g->inverse);
    g_free(g->held);
}

static double axis_of(Vec3 p, int axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }

/* Three right-hand sides; *rounds of all, and the greatest difference from `place`. */
static double plain(const Leaf *leaf, const Vec3 *place, uint32_t *rounds)
{
    Voronoi *v = voronoi_new(&leaf->mesh);
    Gradients g = gradients_new(v, leaf);
    double worst = 0.0;
    *rounds = 0;
    for (int axis = 0; axis < 3; axis++) {
        memset(g.x, 0, g.n * sizeof *g.x);
        for (uint32_t f = 0; f < leaf->n_fixed; f++)
            g.x[leaf->fixed[f]] = axis_of(leaf->posed[f], axis);
        *rounds += gradients_solve(v, &g);
        for (uint32_t i = 0; i < g.n; i++)
            worst = MAX(worst, fabs(g.x[i] - axis_of(place[i], axis)));
    }
    gradients_clear(&g);
    voronoi_free(v);
    return worst;
}

/* ---- the table ---- */

/* Seconds a pose, over at least a third of a second. */
static double time_poses(Membrane *m, const Leaf *leaf, Vec3 *place, const Mat3 *turn)
{
    uint32_t rounds = 0;
    double start = now();
    do {
        if (turn)
            membrane_interpolate_turned(m, leaf->posed, turn, place);
        else
            membrane_interpolate(m, leaf->posed, place);
        rounds++;
    } while (now() - start < 0.3);
    return (now() - start) / rounds;
}

static gboolean row(uint32_t triangles, MembraneKind kind)
{
    Leaf *leaf = leaf_new(triangles);
    GError *error = NULL;
    double start = now(), made, pose, turned, cg = 0.0, apart = 0.0;
    Membrane *m = membrane_new(&leaf->mesh, leaf->fixed, leaf->n_fixed, kind, &error);
    made = now() - start;
    if (!m)
        g_error("%s", error->message);
    Vec3 *place = g_new(Vec3, leaf->mesh.n_vertices);
    Mat3 *turn = g_new(Mat3, leaf->n_fixed);
    for (uint32_t f = 0; f < leaf->n_fixed; f++)
        turn[f] = mat3_identity();
    turned = time_poses(m, leaf, place, turn);
    pose = time_poses(m, leaf, place, NULL);
    printf("| %9u | %8u | %9s | %8.3f | %8.2f | %8.0f | %8.0f | %8.1e |", leaf->mesh.n_triangles, leaf->mesh.n_vertices,
           kind == MEMBRANE_LAPLACE ? "laplace" : "bilaplace", made, pose * 1e3, 1.0 / pose, 1.0 / turned, membrane_residual(m, place));
    fflush(stdout);
    if (kind == MEMBRANE_LAPLACE) {
        uint32_t rounds;
        start = now();
        apart = plain(leaf, place, &rounds);
        cg = now() - start;
        printf(" %8.3f | %6u | %8.1e | %7.1f | %7.0f |\n", cg, rounds, apart, cg / (made + pose), cg / pose);
    } else {
        printf(" %8s | %6s | %8s | %7s | %7s |\n", "", "", "", "", "");
    }
    fflush(stdout);
    g_free(place);
    g_free(turn);
    membrane_free(m);
    leaf_free(leaf);
    return apart < 1e-5;
}

int main(int argc, char **argv)
{
    const uint32_t size[] = {5000, 20000, 39400, 200000, 1000000};
    gboolean quick = argc > 1 && strcmp(argv[1], "--quick") == 0, ok = TRUE;
    struct rusage usage;
    printf("| %9s | %8s | %9s | %8s | %8s | %8s | %8s | %8s | %8s | %6s | %8s | %7s | %7s |\n", "triangles", "vertices", "kind", "new s",
           "pose ms", "poses/s", "turned/s", "residual", "CG s", "rounds", "apart", "CG/first", "CG/next");
    printf("| --------: | -------: | --------- | -------: | -------: | -------: | -------: | -------: | -------: | -----: | -------: | "
           "-------: | ------: |\n");
    for (int kind = 0; kind < 2; kind++)
        for (uint32_t k = 0; k < (quick ? 3 : 5) - (uint32_t)(kind && !quick); k++)
            ok &= row(size[k], (MembraneKind)kind);
    getrusage(RUSAGE_SELF, &usage);
    printf("\npeak memory %ld MB\n", usage.ru_maxrss / 1024);
    if (!ok)
        fprintf(stderr, "bench_membrane: conjugate gradients come to another surface\n");
    return ok ? 0 : 1;
}
