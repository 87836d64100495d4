/* The membrane against analytic solutions, against Voronoi diagrams made another way, and against its own invariants. */
#include <glib.h>
#include <stdlib.h>
#include <string.h>

#include "geom/random.h"
#include "shape/membrane.h"
#include "shape/voronoi.h"

#define NONE UINT32_MAX

static double uniform(uint32_t stream, uint64_t index)
{
    double u[2];
    random_pair(19, stream, 0, index, u);
    return u[0];
}

/* ---- meshes by hand ---- */

static Mesh *mesh_alloc(uint32_t n_vertices, uint32_t n_triangles)
{
    Mesh *m = g_new0(Mesh, 1);
    m->n_vertices = n_vertices;
    m->n_triangles = n_triangles;
    m->vertex = g_new0(Vec2, n_vertices);
    m->triangle = g_malloc0_n(n_triangles, sizeof *m->triangle);
    return m;
}

static void mesh_drop(Mesh *m)
{
    g_free(m->vertex);
    g_free(m->triangle);
    g_free(m);
}

static void set_triangle(Mesh *m, uint32_t t, uint32_t a, uint32_t b, uint32_t c)
{
    m->triangle[t][0] = a;
    m->triangle[t][1] = b;
    m->triangle[t][2] = c;
}

/* (columns + 1) × (rows + 1) vertices one row after the other; every cell is cut by the diagonal from lower left to upper right. */
static Mesh *grid(uint32_t columns, uint32_t rows)
{
    Mesh *m = mesh_alloc((columns + 1) * (rows + 1), 2 * columns * rows);
    uint32_t t = 0;
    for (uint32_t j = 0; j <= rows; j++)
        for (uint32_t i = 0; i <= columns; i++)
            m->vertex[j * (columns + 1) + i] = vec2(i, j);
    for (uint32_t j = 0; j < rows; j++)
        for (uint32_t i = 0; i < columns; i++) {
            uint32_t a = j * (columns + 1) + i, b = a + columns + 1;
            set_triangle(m, t++, a, a + 1, b + 1);
            set_triangle(m, t++, a, b + 1, b);
        }
    return m;
}

static Mesh *grid_scaled(uint32_t columns, uint32_t rows, double dx, double dy)
{
    Mesh *m = grid(columns, rows);
    for (uint32_t i = 0; i < m->n_vertices; i++)
        m->vertex[i] = vec2(m->vertex[i].x * dx, m->vertex[i].y * dy);
    return m;
}

/* Rows leaning to the left so that the diagonals close equilateral triangles of side 1. */
static Mesh *grid_equilateral(uint32_t columns, uint32_t rows)
{
    Mesh *m = grid(columns, rows);
    for (uint32_t i = 0; i < m->n_vertices; i++)
        m->vertex[i] = vec2(m->vertex[i].x - 0.5 * m->vertex[i].y, m->vertex[i].y * sqrt(0.75));
    return m;
}

/* Unit disc: ring k of `rings` has 6 k vertices. */
static Mesh *disc(uint32_t rings)
{
    Mesh *m = mesh_alloc(1 + 3 * rings * (rings + 1), 6 * rings * rings);
    uint32_t t = 0;
    for (uint32_t k = 1, v = 1; k <= rings; k++)
        for (uint32_t j = 0; j < 6 * k; j++, v++)
            m->vertex[v] = vec_scale(vec2(cos(G_PI * j / (3.0 * k)), sin(G_PI * j / (3.0 * k))), (double)k / rings);
    for (uint32_t k = 0; k < rings; k++) {
        uint32_t in = k ? 1 + 3 * k * (k - 1) : 0, out = 1 + 3 * k * (k + 1), n_in = k ? 6 * k : 1, n_out = 6 * (k + 1);
        for (uint32_t s = 0; s < 6; s++)
            for (uint32_t j = 0; j <= k; j++) {
                uint32_t a = in + (s * k + j) % n_in, p = out + (s * (k + 1) + j) % n_out, q = out + (s * (k + 1) + j + 1) % n_out;
                set_triangle(m, t++, a, p, q);
                if (j < k)
                    set_triangle(m, t++, a, q, in + (s * k + j + 1) % n_in);
            }
    }
    g_assert_cmpuint(t, ==, m->n_triangles);
    return m;
}

static bool circumcentre(Vec2 a, Vec2 b, Vec2 c, Vec2 *centre)
{
    Vec2 u = vec_sub(b, a), v = vec_sub(c, a);
    double d = 2.0 * vec_cross(u, v), uu = vec_norm2(u), vv = vec_norm2(v);
    if (fabs(d) < 1e-9)
        return false;
    *centre = vec_add(a, vec2((v.y * uu - u.y * vv) / d, (u.x * vv - v.x * uu) / d));
    return true;
}

/* Delaunay's triangulation by its definition: every triple with an empty circle. */
static Mesh *delaunay(const Vec2 *p, uint32_t n)
{
    Mesh *m = mesh_alloc(n, 2 * n);
    uint32_t t = 0;
    memcpy(m->vertex, p, n * sizeof *p);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = i + 1; j < n; j++)
            for (uint32_t k = j + 1; k < n; k++) {
                Vec2 c;
                if (!circumcentre(p[i], p[j], p[k], &c))
                    continue;
                double r2 = vec_dist2(p[i], c);
                bool empty = true;
                for (uint32_t q = 0; q < n && empty; q++)
                    empty = q == i || q == j || q == k || vec_dist2(p[q], c) > r2;
                if (empty && vec_cross(vec_sub(p[j], p[i]), vec_sub(p[k], p[i])) > 0.0)
                    set_triangle(m, t++, i, j, k);
                else if (empty)
                    set_triangle(m, t++, i, k, j);
            }
    m->n_triangles = t;
    return m;
}

/* side × side points about whole numbers; those of the square's sides move along them alone. */
static Mesh *jittered(uint32_t side, uint32_t stream, double jitter)
{
    Vec2 *p = g_new(Vec2, side * side);
    for (uint32_t i = 0; i < side * side; i++) {
        uint32_t x = i % side, y = i / side;
        bool tight_x = x == 0 || x == side - 1, tight_y = y == 0 || y == side - 1;
        p[i] = vec2(x + (tight_x ? 0.0 : jitter * (2.0 * uniform(stream, 2 * i) - 1.0)),
                    y + (tight_y ? 0.0 : jitter * (2.0 * uniform(stream, 2 * i + 1) - 1.0)));
    }
    Mesh *m = delaunay(p, side * side);
    g_assert_cmpuint(m->n_triangles, ==, 2 * (side - 1) * (side - 1));
    g_free(p);
    return m;
}

/* Points anywhere: the hull has thin triangles with obtuse angles against the margin. */
static Mesh *scattered(uint32_t n, uint32_t stream)
{
    Vec2 *p = g_new(Vec2, n);
    for (uint32_t i = 0; i < n; i++)
        p[i] = vec2(10.0 * uniform(stream, 2 * i), 10.0 * uniform(stream, 2 * i + 1));
    Mesh *m = delaunay(p, n);
    g_free(p);
    return m;
}

/* The triangles that have the edge i – j: how many, and their third vertices. */
static uint32_t across(const Mesh *m, uint32_t i, uint32_t j, uint32_t apex[2])
{
    uint32_t n = 0;
    for (uint32_t t = 0; t < m->n_triangles; t++)
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t a = m->triangle[t][k], b = m->triangle[t][(k + 1) % 3];
            if ((a == i && b == j) || (a == j && b == i)) {
                g_assert_cmpuint(n, <, 2);
                apex[n++] = m->triangle[t][(k + 2) % 3];
            }
        }
    return n;
}

/* ---- choosing and solving ---- */

typedef struct {
    uint32_t n, *at;
} Fixed;

static Fixed fixed_new(const Mesh *m) { return (Fixed){0, g_new(uint32_t, m->n_vertices)}; }

static Fixed fix_margin(const Mesh *m)
{
    Fixed f = fixed_new(m);
    bool *margin = g_new0(bool, m->n_vertices);
    for (uint32_t t = 0; t < m->n_triangles; t++)
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t apex[2], a = m->triangle[t][k], b = m->triangle[t][(k + 1) % 3];
            if (!(margin[a] && margin[b]) && across(m, a, b, apex) == 1)
                margin[a] = margin[b] = true;
        }
    for (uint32_t i = 0; i < m->n_vertices; i++)
        if (margin[i])
            f.at[f.n++] = i;
    g_free(margin);
    return f;
}

/* Vertices for which `which` says so. */
static Fixed fix_where(const Mesh *m, bool (*which)(Vec2))
{
    Fixed f = fixed_new(m);
    for (uint32_t i = 0; i < m->n_vertices; i++)
        if (which(m->vertex[i]))
            f.at[f.n++] = i;
    return f;
}

static Membrane *make(const Mesh *m, Fixed f, MembraneKind kind)
{
    GError *error = NULL;
    Membrane *membrane = membrane_new(m, f.at, f.n, kind, &error);
    g_assert_no_error(error);
    g_assert_nonnull(membrane);
    return membrane;
}

/* Solves with values of `exact` at the fixed vertices; the greatest distance from it elsewhere. */
static double solve_error(const Mesh *m, Fixed f, MembraneKind kind, double (*exact)(Vec2))
{
    Membrane *membrane = make(m, f, kind);
    double *value = g_new(double, m->n_vertices), *at = g_new(double, f.n), worst = 0.0;
    for (uint32_t i = 0; i < f.n; i++)
        at[i] = exact(m->vertex[f.at[i]]);
    membrane_harmonic(membrane, at, value);
    for (uint32_t i = 0; i < m->n_vertices; i++)
        worst = MAX(worst, fabs(value[i] - exact(m->vertex[i])));
    g_free(value);
    g_free(at);
    membrane_free(membrane);
    return worst;
}

static Vec3 random_point(uint32_t stream, uint32_t i)
{
    return vec3(uniform(stream, 3 * i) - 0.5, uniform(stream, 3 * i + 1) - 0.5, uniform(stream, 3 * i + 2) - 0.5);
}

/* Random positions for the fixed vertices. */
static Vec3 *random_pose(Fixed f, uint32_t stream)
{
    Vec3 *posed = g_new(Vec3, f.n);
    for (uint32_t i = 0; i < f.n; i++)
        posed[i] = random_point(stream, i);
    return posed;
}

/* A rotation about no axis in particular, of whole-number ratios. */
static Mat3 some_rotation(void)
{
    Mat3 a = {{0.6, 0.8, 0}, {-0.8, 0.6, 0}, {0, 0, 1}}, b = {{1, 0, 0}, {0, 5.0 / 13, 12.0 / 13}, {0, -12.0 / 13, 5.0 / 13}};
    return mat3_mul(b, a);
}

/* ---- weights ---- */

static void test_weights_grids(void)
{
    Mesh *right = grid(4, 4), *even = grid_equilateral(4, 4);
    Fixed f = {1, (uint32_t[]){0}};
    Membrane *a = make(right, f, MEMBRANE_LAPLACE), *b = make(even, f, MEMBRANE_LAPLACE);
    g_assert_cmpfloat(membrane_weight(a, 6, 7), ==, 1.0);
    g_assert_cmpfloat(membrane_weight(a, 6, 11), ==, 1.0);
    g_assert_cmpfloat(membrane_weight(a, 1, 2), ==, 0.5); /* margin: half a Voronoi edge */
    g_assert_cmpfloat(membrane_weight(a, 6, 12), ==, 0.0); /* the diagonal: a Voronoi edge of no length */
    g_assert_cmpfloat(membrane_weight(a, 6, 10), ==, 0.0); /* no edge */
    g_assert_cmpfloat(membrane_weight(a, 6, 6), ==, 0.0);
    g_assert_cmpfloat(fabs(membrane_weight(b, 6, 7) - (1.0 / sqrt(3.0))), <, 1e-15);
    g_assert_cmpfloat(fabs(membrane_weight(b, 6, 12) - (1.0 / sqrt(3.0))), <, 1e-15);
    g_assert_cmpfloat(fabs(membrane_weight(b, 1, 2) - (0.5 / sqrt(3.0))), <, 1e-15);
    membrane_free(a);
    membrane_free(b);
    mesh_drop(right);
    mesh_drop(even);
}

static gint by_bearing(gconstpointer a, gconstpointer b)
{
    const Vec2 *p = a, *q = b;
    return (atan2(p->y, p->x) > atan2(q->y, q->x)) - (atan2(p->y, p->x) < atan2(q->y, q->x));
}

/* Whole-number points on one circle: all share one Voronoi vertex, so no diagonal has a weight, whichever way the polygon is cut. They are
 * multiples of a number so great that products are rounded, and thin triangles magnify that. */
static void test_weights_rounding(void)
{
    Vec2 p[64];
    uint32_t n = 0;
    for (int x = -75; x <= 75; x++)
        for (int y = -75; y <= 75; y++)
            if (x * x + y * y == 5525)
                p[n++] = vec2(x, y);
    g_assert_cmpuint(n, ==, 48);
    qsort(p, n, sizeof *p, by_bearing);
    for (uint32_t tip = 0; tip < n; tip++) {
        Mesh *m = mesh_alloc(n, n - 2);
        for (uint32_t i = 0; i < n; i++)
            m->vertex[i] = vec_scale(p[(tip + i) % n], 35184372088833.0);
        for (uint32_t t = 0; t < n - 2; t++)
            set_triangle(m, t, 0, t + 1, t + 2);
        Membrane *a = make(m, (Fixed){1, (uint32_t[]){0}}, MEMBRANE_LAPLACE);
        for (uint32_t i = 2; i < n - 1; i++)
            g_assert_cmpfloat(membrane_weight(a, 0, i), ==, 0.0);
        for (uint32_t i = 0; i < n; i++)
            g_assert_cmpfloat(membrane_weight(a, i, (i + 1) % n), >, 0.0);
        membrane_free(a);
        mesh_drop(m);
    }
}

/* Voronoi edge over distance, from circumcentres; both have a sign: the Voronoi edge against the side of the apex. */
static double voronoi_weight(const Mesh *m, uint32_t i, uint32_t j)
{
    uint32_t apex[2], n = across(m, i, j, apex);
    Vec2 a = m->vertex[i], b = m->vertex[j], middle = vec_lerp(a, b, 0.5), along = vec_sub(b, a);
    double h = sqrt(vec_norm2(along)), length = 0.0;
    for (uint32_t k = 0; k < n; k++) {
        Vec2 centre = middle, inward = vec_scale(vec2(-along.y, along.x), 1.0 / h);
        if (vec_dot(inward, vec_sub(m->vertex[apex[k]], middle)) < 0.0)
            inward = vec_scale(inward, -1.0);
        g_assert_true(circumcentre(a, b, m->vertex[apex[k]], &centre));
        length += vec_dot(inward, vec_sub(centre, middle));
    }
    return length / h;
}

static void check_weights(Mesh *m, uint32_t *negative)
{
    Fixed f = {1, (uint32_t[]){0}};
    Membrane *a = make(m, f, MEMBRANE_LAPLACE);
    *negative = 0;
    for (uint32_t i = 0; i < m->n_vertices; i++)
        for (uint32_t j = 0; j < m->n_vertices; j++) {
            double w = membrane_weight(a, i, j), v;
            uint32_t apex[2];
            g_assert_cmpfloat(w, ==, membrane_weight(a, j, i));
            if (i == j)
                continue;
            v = voronoi_weight(m, i, j);
            g_assert_cmpfloat(fabs(w - v), <=, 1e-9 * (1.0 + fabs(v)));
            if (w < 0.0) {
                ++*negative;
                g_assert_cmpuint(across(m, i, j, apex), ==, 1);
            }
        }
    membrane_free(a);
    mesh_drop(m);
}

static void test_weights_voronoi(void)
{
    uint32_t negative, obtuse = 0;
    for (uint32_t s = 0; s < 3; s++) {
        check_weights(jittered(9, 40 + s, 0.25), &negative);
        check_weights(scattered(60, 50 + s), &negative);
        obtuse += negative;
    }
    g_assert_cmpuint(obtuse, >, 0); /* the rule of signs was put to the test */
}

/* Cells of a grid are its rectangles; cells of any mesh cover it once; obtuse margins leave none without area. */
static void test_areas(void)
{
    Mesh *right = grid_scaled(4, 3, 0.5, 2.0), *any = jittered(9, 45, 0.2), *obtuse = scattered(60, 50);
    Voronoi *v = voronoi_new(right), *w = voronoi_new(any), *x = voronoi_new(obtuse);
    double sum = 0.0;
    for (uint32_t i = 0; i < right->n_vertices; i++) {
        bool left_right = i % 5 == 0 || i % 5 == 4, top_bottom = i / 5 == 0 || i / 5 == 3;
        g_assert_cmpfloat(v->area[i], ==, (left_right ? 0.5 : 1.0) * (top_bottom ? 0.5 : 1.0));
        g_assert_true(v->margin[i] == (left_right || top_bottom));
    }
    for (uint32_t i = 0; i < any->n_vertices; i++)
        sum += w->area[i];
    g_assert_cmpfloat(fabs(sum - 64.0), <, 1e-12);
    for (uint32_t i = 0; i < obtuse->n_vertices; i++)
        g_assert_cmpfloat(x->area[i], >, 0.0);
    voronoi_free(v);
    voronoi_free(w);
    voronoi_free(x);
    voronoi_free(NULL);
    mesh_drop(right);
    mesh_drop(any);
    mesh_drop(obtuse);
}

/* ---- linear precision ---- */

static Vec3 affine(Vec2 p) { return vec3(0.3 * p.x - 0.2 * p.y + 1.0, 0.7 * p.x + 0.4 * p.y - 2.0, 0.5 * p.y - 0.1 * p.x + 0.25); }

static void check_affine(Mesh *m, MembraneKind kind, bool inner, double tolerance)
{
    Fixed f = fix_margin(m);
    for (uint32_t i = 0; inner && i < m->n_vertices; i += 7) { /* and some inside */
        bool there = false;
        for (uint32_t k = 0; k < f.n; k++)
            there |= f.at[k] == i;
        if (!there)
            f.at[f.n++] = i;
    }
    Membrane *membrane = make(m, f, kind);
    Vec3 *posed = g_new(Vec3, f.n), *place = g_new(Vec3, m->n_vertices);
    for (uint32_t i = 0; i < f.n; i++)
        posed[i] = affine(m->vertex[f.at[i]]);
    membrane_interpolate(membrane, posed, place);
    double size = 0.0;
    for (uint32_t i = 0; i < m->n_vertices; i++)
        size = MAX(size, vec3_norm(place[i]));
    for (uint32_t i = 0; i < m->n_vertices; i++)
        g_assert_cmpfloat(vec3_dist(place[i], affine(m->vertex[i])), <=, tolerance * size);
    g_assert_cmpfloat(membrane_residual(membrane, place), <, 1e-10);
    g_free(posed);
    g_free(place);
    g_free(f.at);
    membrane_free(membrane);
    mesh_drop(m);
}

static void test_affine(void)
{
    for (int inner = 0; inner < 2; inner++) {
        check_affine(grid(20, 30), MEMBRANE_LAPLACE, inner, 1e-12);
        check_affine(grid_scaled(25, 25, 0.3, 1.7), MEMBRANE_LAPLACE, inner, 1e-12);
        check_affine(grid_equilateral(25, 12), MEMBRANE_LAPLACE, inner, 1e-12);
        check_affine(disc(20), MEMBRANE_LAPLACE, inner, 1e-12);
        check_affine(jittered(11, 60, 0.3), MEMBRANE_LAPLACE, inner, 1e-12);
        check_affine(scattered(90, 61), MEMBRANE_LAPLACE, inner, 1e-12);
    }
}

static void test_bilaplace_affine(void)
{
    for (int inner = 0; inner < 2; inner++) {
        check_affine(grid(20, 30), MEMBRANE_BILAPLACE, inner, 1e-10);
        check_affine(grid_equilateral(25, 12), MEMBRANE_BILAPLACE, inner, 1e-10);
        check_affine(disc(20), MEMBRANE_BILAPLACE, inner, 1e-10);
        check_affine(jittered(11, 60, 0.3), MEMBRANE_BILAPLACE, inner, 1e-10);
        check_affine(scattered(90, 61), MEMBRANE_BILAPLACE, inner, 1e-10);
    }
}

/* ---- harmonic functions ---- */

static double cubic(Vec2 p) { return p.x * p.x * p.x - 3.0 * p.x * p.y * p.y; }
static double standing(Vec2 p) { return cosh(G_PI * p.x) * cos(G_PI * p.y) / cosh(G_PI); }
static double logarithm(Vec2 p) { return 0.5 * log(vec_norm2(p)); }
static double bearing(Vec2 p) { return atan2(p.y, p.x); }

static void check_order(const double error[3], double least)
{
    g_test_message("errors %g %g %g: orders %.2f %.2f", error[0], error[1], error[2], log2(error[0] / error[1]),
                   log2(error[1] / error[2]));
    g_assert_cmpfloat(error[0] / error[1], >, least);
    g_assert_cmpfloat(error[1] / error[2], >, least);
}

/* Re z³ on a disc, given at the rim. Second order: half the spacing, a quarter of the error. */
static void test_disc(void)
{
    double error[3];
    for (uint32_t k = 0; k < 3; k++) {
        Mesh *m = disc(8u << k);
        Fixed f = fixed_new(m);
        for (uint32_t i = m->n_vertices - 6 * (8u << k); i < m->n_vertices; i++)
            f.at[f.n++] = i;
        error[k] = solve_error(m, f, MEMBRANE_LAPLACE, cubic);
        g_free(f.at);
        mesh_drop(m);
    }
    check_order(error, 3.5);
    g_assert_cmpfloat(error[2], <, 2e-3);
}

static bool at_ends_x(Vec2 p) { return p.x <= 0.0 || p.x >= 1.0; }

/* cosh πx cos πy on a square given at x = 0 and 1; its normal derivative is 0 at y = 0 and 1, which the margin gives by itself. */
static void test_strip(void)
{
    double error[3];
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t n = 8u << k;
        Mesh *m = grid_scaled(n, n, 1.0 / n, 1.0 / n);
        Fixed f = fix_where(m, at_ends_x);
        error[k] = solve_error(m, f, MEMBRANE_LAPLACE, standing);
        g_free(f.at);
        mesh_drop(m);
    }
    check_order(error, 3.5);
}

/* A quarter of the ring 1 <= r <= 2 on a polar grid. Cells are isosceles trapezia, whose corners lie on one circle. */
static Mesh *ring_quarter(uint32_t n)
{
    Mesh *m = grid(n, 2 * n);
    for (uint32_t i = 0; i < m->n_vertices; i++) {
        double r = 1.0 + m->vertex[i].x / n, t = m->vertex[i].y * G_PI / (4.0 * n);
        m->vertex[i] = vec2(r * cos(t), r * sin(t));
    }
    return m;
}

static bool at_arcs(Vec2 p) { return sqrt(vec_norm2(p)) < 1.0 + 1e-9 || sqrt(vec_norm2(p)) > 2.0 - 1e-9; }
static bool at_sides(Vec2 p) { return p.y < 1e-9 || p.x < 1e-9; }

/* log r given at the arcs and free at the straight sides; the bearing the other way round: a curved free margin. */
static void test_ring(void)
{
    double radial[3], around[3];
    for (uint32_t k = 0; k < 3; k++) {
        Mesh *m = ring_quarter(8u << k);
        Fixed arcs = fix_where(m, at_arcs), sides = fix_where(m, at_sides);
        radial[k] = solve_error(m, arcs, MEMBRANE_LAPLACE, logarithm);
        around[k] = solve_error(m, sides, MEMBRANE_LAPLACE, bearing);
        g_free(arcs.at);
        g_free(sides.at);
        mesh_drop(m);
    }
    check_order(radial, 3.5);
    g_assert_cmpfloat(radial[2], >, 0.0);
    /* Every ring's vertices are spaced evenly, so the bearing solves the equations on the grid exactly. */
    for (uint32_t k = 0; k < 3; k++)
        g_assert_cmpfloat(around[k], <, 1e-12);
}

static bool on_cross(Vec2 p) { return fabs(p.x) < 1e-9 || fabs(p.y) < 1e-9; }

/* Im z² vanishes on the axes, which are fixed as veins inside the blade: the same answer on both sides of a vein. The rim is given too. */
static double twice_xy(Vec2 p) { return 2.0 * p.x * p.y; }

static bool on_cross_or_rim(Vec2 p) { return on_cross(p) || vec_norm2(p) > 1.0 - 1e-9; }

static void test_veins_inside(void)
{
    double error[3];
    for (uint32_t k = 0; k < 3; k++) {
        Mesh *m = disc(8u << k);
        Fixed f = fix_where(m, on_cross_or_rim);
        error[k] = solve_error(m, f, MEMBRANE_LAPLACE, twice_xy);
        g_free(f.at);
        mesh_drop(m);
    }
    check_order(error, 3.0);
}

/* ---- invariants ---- */

/* With no weight below 0, every value lies between the least and the greatest of the fixed ones, however few they are. */
static void test_maximum_principle(void)
{
    for (uint32_t trial = 0; trial < 12; trial++) {
        Mesh *m = trial % 4 == 0 ? disc(12) : trial % 4 == 1 ? jittered(10, 70 + trial, 0.15) : NULL;
        if (!m)
            m = trial % 4 == 2 ? grid_equilateral(14, 9) : grid(9, 14);
        Fixed f = fixed_new(m);
        double at[8], low = HUGE_VAL, high = -HUGE_VAL, *value = g_new(double, m->n_vertices);
        for (uint32_t k = 0; k < 8; k++) {
            f.at[f.n++] = (k * m->n_vertices + trial) / 8;
            at[k] = uniform(80 + trial, k);
            low = MIN(low, at[k]);
            high = MAX(high, at[k]);
        }
        Membrane *membrane = make(m, f, MEMBRANE_LAPLACE);
        for (uint32_t t = 0; t < m->n_triangles; t++)
            for (uint32_t k = 0; k < 3; k++)
                g_assert_cmpfloat(membrane_weight(membrane, m->triangle[t][k], m->triangle[t][(k + 1) % 3]), >=, 0.0);
        membrane_harmonic(membrane, at, value);
        for (uint32_t i = 0; i < m->n_vertices; i++) {
            g_assert_cmpfloat(value[i], >=, low - 1e-13);
            g_assert_cmpfloat(value[i], <=, high + 1e-13);
        }
        g_free(value);
        g_free(f.at);
        membrane_free(membrane);
        mesh_drop(m);
    }
}

/* The residual by its definition, all weights asked for one at a time. */
static double plain_residual(const Membrane *membrane, const Mesh *m, Fixed f, const Vec3 *place)
{
    double worst = 0.0;
    for (uint32_t i = 0; i < m->n_vertices; i++) {
        Vec3 sum = vec3(0, 0, 0);
        bool is_fixed = false;
        for (uint32_t k = 0; k < f.n; k++)
            is_fixed |= f.at[k] == i;
        for (uint32_t j = 0; j < m->n_vertices && !is_fixed; j++)
            sum = vec3_add(sum, vec3_scale(vec3_sub(place[j], place[i]), membrane_weight(membrane, i, j)));
        worst = MAX(worst, vec3_norm(sum));
    }
    return worst;
}

static void test_residual(void)
{
    for (int kind = 0; kind < 2; kind++) {
        Mesh *m = jittered(12, 90, 0.3);
        Fixed f = {5, (uint32_t[]){3, 77, 40, 143, 100}};
        Membrane *membrane = make(m, f, (MembraneKind)kind);
        Vec3 *posed = random_pose(f, 91), *place = g_new(Vec3, m->n_vertices);
        membrane_interpolate(membrane, posed, place);
        g_assert_cmpfloat(membrane_residual(membrane, place), <, 1e-12);
        if (kind == MEMBRANE_LAPLACE)
            g_assert_cmpfloat(plain_residual(membrane, m, f, place), <, 1e-13);
        for (uint32_t i = 0; i < f.n; i++)
            g_assert_true(memcmp(&place[f.at[i]], &posed[i], sizeof(Vec3)) == 0);
        place[50].z += 1e-4;
        g_assert_cmpfloat(membrane_residual(membrane, place), >, 1e-6);
        place[50].z -= 1e-4;
        place[143].x += 1e-4; /* a fixed one: its neighbours notice */
        g_assert_cmpfloat(membrane_residual(membrane, place), >, 1e-6);
        g_free(posed);
        g_free(place);
        membrane_free(membrane);
        mesh_drop(m);
    }
}

static void test_harmonic_is_interpolate(void)
{
    for (int kind = 0; kind < 2; kind++) {
        Mesh *m = disc(15);
        Fixed f = fix_where(m, on_cross);
        Membrane *membrane = make(m, f, (MembraneKind)kind);
        Vec3 *posed = random_pose(f, 95), *place = g_new(Vec3, m->n_vertices);
        double *at = g_new(double, f.n), *value = g_new(double, m->n_vertices);
        membrane_interpolate(membrane, posed, place);
        for (int axis = 0; axis < 3; axis++) {
            for (uint32_t i = 0; i < f.n; i++)
                at[i] = axis == 0 ? posed[i].x : axis == 1 ? posed[i].y : posed[i].z;
            membrane_harmonic(membrane, at, value);
            for (uint32_t i = 0; i < m->n_vertices; i++)
                g_assert_cmpfloat(value[i], ==, axis == 0 ? place[i].x : axis == 1 ? place[i].y : place[i].z);
        }
        g_free(at);
        g_free(value);
        g_free(posed);
        g_free(place);
        g_free(f.at);
        membrane_free(membrane);
        mesh_drop(m);
    }
}

/* Harmonic coordinates: not negative, sum 1, and together they give what interpolate gives. */
static void test_coordinates(void)
{
    Mesh *m = jittered(10, 97, 0.15);
    Fixed f = {6, (uint32_t[]){0, 22, 45, 56, 89, 98}};
    Membrane *membrane = make(m, f, MEMBRANE_LAPLACE);
    Vec3 *posed = random_pose(f, 98), *place = g_new(Vec3, m->n_vertices), *mixed = g_new0(Vec3, m->n_vertices);
    double *sum = g_new0(double, m->n_vertices), *value = g_new(double, m->n_vertices);
    membrane_interpolate(membrane, posed, place);
    for (uint32_t k = 0; k < f.n; k++) {
        double at[6] = {0};
        at[k] = 1.0;
        membrane_harmonic(membrane, at, value);
        for (uint32_t i = 0; i < m->n_vertices; i++) {
            g_assert_cmpfloat(value[i], >=, -1e-15);
            sum[i] += value[i];
            mixed[i] = vec3_add(mixed[i], vec3_scale(posed[k], value[i]));
        }
    }
    for (uint32_t i = 0; i < m->n_vertices; i++) {
        g_assert_cmpfloat(fabs(sum[i] - 1.0), <, 1e-12);
        g_assert_cmpfloat(vec3_dist(mixed[i], place[i]), <, 1e-12);
    }
    g_free(sum);
    g_free(value);
    g_free(posed);
    g_free(place);
    g_free(mixed);
    membrane_free(membrane);
    mesh_drop(m);
}

/* Nothing of one pose is left in the next. */
static void test_kept_factor(void)
{
    for (int kind = 0; kind < 2; kind++) {
        Mesh *m = jittered(12, 99, 0.3);
        Fixed f = {5, (uint32_t[]){8, 70, 41, 143, 101}};
        Membrane *kept = make(m, f, (MembraneKind)kind);
        Vec3 *a = g_new(Vec3, m->n_vertices), *b = g_new(Vec3, m->n_vertices);
        double *value = g_new(double, m->n_vertices), at[5] = {1, 2, 3, 4, 5};
        Mat3 turn[5];
        for (int i = 0; i < 5; i++)
            turn[i] = some_rotation();
        for (uint32_t pose = 0; pose < 6; pose++) {
            Vec3 *posed = random_pose(f, 100 + pose);
            Membrane *fresh = make(m, f, (MembraneKind)kind);
            membrane_interpolate(kept, posed, a);
            membrane_interpolate(fresh, posed, b);
            g_assert_true(memcmp(a, b, m->n_vertices * sizeof *a) == 0);
            membrane_harmonic(kept, at, value);
            membrane_interpolate_turned(kept, posed, turn, a);
            membrane_interpolate_turned(fresh, posed, turn, b);
            g_assert_true(memcmp(a, b, m->n_vertices * sizeof *a) == 0);
            membrane_free(fresh);
            g_free(posed);
        }
        g_free(a);
        g_free(b);
        g_free(value);
        membrane_free(kept);
        mesh_drop(m);
    }
}

/* Other numbers for the vertices and another order of triangles and fixed vertices: the same surface. */
static void test_numbering(void)
{
    Mesh *m = disc(14), *other = mesh_alloc(m->n_vertices, m->n_triangles);
    uint32_t n = m->n_vertices, *to = g_new(uint32_t, n);
    for (uint32_t i = 0; i < n; i++) {
        to[i] = (uint32_t)((i * 257ull + 11) % n);
        other->vertex[to[i]] = m->vertex[i];
    }
    for (uint32_t t = 0; t < m->n_triangles; t++) {
        const uint32_t *at = m->triangle[m->n_triangles - 1 - t];
        set_triangle(other, t, to[at[1]], to[at[2]], to[at[0]]);
    }
    for (int kind = 0; kind < 2; kind++) {
        Fixed f = fix_where(m, on_cross), g = fix_where(other, on_cross);
        Membrane *a = make(m, f, (MembraneKind)kind), *b = make(other, g, (MembraneKind)kind);
        Vec3 *posed_a = g_new(Vec3, f.n), *posed_b = g_new(Vec3, g.n), *place_a = g_new(Vec3, n), *place_b = g_new(Vec3, n);
        g_assert_cmpuint(f.n, ==, g.n);
        for (uint32_t i = 0; i < f.n; i++) {
            posed_a[i] = vec3(m->vertex[f.at[i]].x, cos(9.0 * m->vertex[f.at[i]].y), m->vertex[f.at[i]].x * m->vertex[f.at[i]].x);
            for (uint32_t k = 0; k < g.n; k++)
                if (g.at[k] == to[f.at[i]])
                    posed_b[k] = posed_a[i];
        }
        membrane_interpolate(a, posed_a, place_a);
        membrane_interpolate(b, posed_b, place_b);
        for (uint32_t i = 0; i < n; i++)
            g_assert_cmpfloat(vec3_dist(place_a[i], place_b[to[i]]), <, kind == MEMBRANE_LAPLACE ? 1e-13 : 1e-11);
        g_free(posed_a);
        g_free(posed_b);
        g_free(place_a);
        g_free(place_b);
        g_free(f.at);
        g_free(g.at);
        membrane_free(a);
        membrane_free(b);
    }
    g_free(to);
    mesh_drop(m);
    mesh_drop(other);
}

/* ---- the margin ---- */

static bool at_left_x(Vec2 p) { return p.x <= 0.0; }

/* One vein along the left side, moved but not bent: free of slope, the blade follows it as a constant. */
static void test_margin_without_slope(void)
{
    for (int kind = 0; kind < 2; kind++) {
        Mesh *m = grid_scaled(10, 10, 0.1, 0.1);
        Fixed f = fix_where(m, at_left_x);
        Membrane *membrane = make(m, f, (MembraneKind)kind);
        Vec3 *posed = g_new(Vec3, f.n), *place = g_new(Vec3, m->n_vertices);
        for (uint32_t i = 0; i < f.n; i++)
            posed[i] = vec3(0.0, 5.0, 2.0);
        membrane_interpolate(membrane, posed, place);
        for (uint32_t i = 0; i < m->n_vertices; i++)
            g_assert_cmpfloat(vec3_dist(place[i], posed[0]), <, 1e-8);
        g_free(posed);
        g_free(place);
        g_free(f.at);
        membrane_free(membrane);
        mesh_drop(m);
    }
}

static bool at_comb(Vec2 p) { return p.x <= 0.0 || p.y <= 0.0 || p.y >= 1.0; }

/* Two side veins 1 apart, flat: x at the margin between them is drawn in by 4/π² · Σ ±1/n² = 0.371 (Catalan's constant), which the
 * header warns of. The turned interpolation leaves the flat blade flat. */
static void test_margin_drawn_in(void)
{
    uint32_t n = 64, middle;
    Mesh *m = grid_scaled(2 * n, n, 1.0 / n, 1.0 / n);
    Fixed f = fix_where(m, at_comb);
    Membrane *membrane = make(m, f, MEMBRANE_LAPLACE);
    Vec3 *posed = g_new(Vec3, f.n), *place = g_new(Vec3, m->n_vertices);
    Mat3 *turn = g_new(Mat3, f.n);
    for (uint32_t i = 0; i < f.n; i++) {
        posed[i] = vec3_flat(m->vertex[f.at[i]]);
        turn[i] = mat3_identity();
    }
    membrane_interpolate(membrane, posed, place);
    middle = (n / 2) * (2 * n + 1) + 2 * n;
    g_assert_cmpfloat(m->vertex[middle].x, ==, 2.0);
    g_assert_cmpfloat(fabs(place[middle].x - (2.0 - 4.0 / (G_PI * G_PI) * 0.915965594177219)), <, 2e-3);
    membrane_interpolate_turned(membrane, posed, turn, place);
    for (uint32_t i = 0; i < m->n_vertices; i++)
        g_assert_cmpfloat(vec3_dist(place[i], vec3_flat(m->vertex[i])), <, 1e-12);
    g_free(turn);
    g_free(posed);
    g_free(place);
    g_free(f.at);
    membrane_free(membrane);
    mesh_drop(m);
}

/* A rigid motion of few veins carries the whole blade, free margin and obtuse corners included. */
static void check_rigid(Mesh *m, MembraneKind kind, double tolerance)
{
    Fixed f = fixed_new(m);
    Mat3 r = some_rotation(), *turn = g_new(Mat3, m->n_vertices);
    Vec3 *posed = g_new(Vec3, m->n_vertices), *place = g_new(Vec3, m->n_vertices), shift = vec3(4, 5, -6);
    for (uint32_t i = 2; i < m->n_vertices; i += m->n_vertices / 5) {
        turn[f.n] = r;
        posed[f.n] = vec3_add(mat3_apply(r, vec3_flat(m->vertex[i])), shift);
        f.at[f.n++] = i;
    }
    Membrane *membrane = make(m, f, kind);
    membrane_interpolate_turned(membrane, posed, turn, place);
    for (uint32_t i = 0; i < m->n_vertices; i++)
        g_assert_cmpfloat(vec3_dist(place[i], vec3_add(mat3_apply(r, vec3_flat(m->vertex[i])), shift)), <, tolerance);
    g_free(turn);
    g_free(posed);
    g_free(place);
    g_free(f.at);
    membrane_free(membrane);
    mesh_drop(m);
}

static void test_turned_rigid(void)
{
    for (int kind = 0; kind < 2; kind++) {
        double tolerance = kind == MEMBRANE_LAPLACE ? 1e-12 : 1e-9;
        check_rigid(disc(12), (MembraneKind)kind, tolerance);
        check_rigid(jittered(10, 120, 0.3), (MembraneKind)kind, tolerance);
        check_rigid(scattered(80, 121), (MembraneKind)kind, tolerance);
    }
}

/* ---- the smoother kind ---- */

static bool at_thirds(Vec2 p) { return p.x <= 0.0 || fabs(p.x - 0.5) < 1e-9 || p.x >= 1.0; }
static bool at_two(Vec2 p) { return p.x <= 0.0 || fabs(p.x - 0.5) < 1e-9; }

/* Veins at x = 0, 1/2, 1 of heights 0, 1, 0: the natural cubic spline, 3x - 4x³ as far as the middle. */
static double spline(Vec2 p)
{
    double x = p.x > 0.5 ? 1.0 - p.x : p.x;
    return 3.0 * x - 4.0 * x * x * x;
}

/* Veins at 0 and 1/2 of heights 0 and 1, free on the right: no slope and no third derivative at the margin, free to turn at x = 0. */
static double half_spline(Vec2 p)
{
    double r = 1.0 - p.x;
    return p.x <= 0.5 ? 2.25 * p.x - p.x * p.x * p.x : 1.0 - 1.5 * (r * r - 0.25);
}

static double tent(Vec2 p) { return 1.0 - 2.0 * fabs(p.x - 0.5); }

/* Columns of uneven width too, so that cells differ in area. */
static void test_bilaplace_spline(void)
{
    for (int uneven = 0; uneven < 2; uneven++) {
        double both[3], free_end[3];
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t n = 16u << k;
            Mesh *m = grid_scaled(n, n / 4, 1.0 / n, 1.0 / n);
            for (uint32_t i = 0; uneven && i < m->n_vertices; i++)
                m->vertex[i].x += at_thirds(m->vertex[i]) ? 0.0 : 0.05 * sin(4.0 * G_PI * m->vertex[i].x);
            Fixed thirds = fix_where(m, at_thirds), two = fix_where(m, at_two);
            g_assert_cmpfloat(solve_error(m, thirds, MEMBRANE_LAPLACE, tent), <, 1e-12);
            both[k] = solve_error(m, thirds, MEMBRANE_BILAPLACE, spline);
            free_end[k] = solve_error(m, two, MEMBRANE_BILAPLACE, half_spline);
            g_free(thirds.at);
            g_free(two.at);
            mesh_drop(m);
        }
        check_order(both, 3.0);
        check_order(free_end, 3.0);
        g_assert_cmpfloat(both[2], <, 5e-3);
    }
}

/* With nothing but the margin fixed, the harmonic function has no energy: both kinds agree. */
static void test_bilaplace_rim(void)
{
    Mesh *m = disc(16);
    Fixed f = fix_margin(m);
    Membrane *a = make(m, f, MEMBRANE_LAPLACE), *b = make(m, f, MEMBRANE_BILAPLACE);
    Vec3 *posed = random_pose(f, 130), *place_a = g_new(Vec3, m->n_vertices), *place_b = g_new(Vec3, m->n_vertices);
    membrane_interpolate(a, posed, place_a);
    membrane_interpolate(b, posed, place_b);
    for (uint32_t i = 0; i < m->n_vertices; i++)
        g_assert_cmpfloat(vec3_dist(place_a[i], place_b[i]), <, 1e-10);
    g_free(posed);
    g_free(place_a);
    g_free(place_b);
    g_free(f.at);
    membrane_free(a);
    membrane_free(b);
    mesh_drop(m);
}

/* ---- odd and bad input ---- */

static void expect_bare(const Mesh *m, const uint32_t *fixed, uint32_t n, const char *words)
{
    for (int kind = 0; kind < 2; kind++) {
        GError *error = NULL;
        g_assert_null(membrane_new(m, fixed, n, (MembraneKind)kind, &error));
        g_assert_error(error, MEMBRANE_ERROR, MEMBRANE_ERROR_BARE);
        g_test_message("%s", error->message);
        g_assert_nonnull(strstr(error->message, words));
        g_clear_error(&error);
        g_assert_null(membrane_new(m, fixed, n, (MembraneKind)kind, NULL));
    }
}

static Mesh *two_triangles(bool joined)
{
    Mesh *m = mesh_alloc(joined ? 5 : 6, 2);
    const Vec2 p[6] = {{0, 0}, {1, 0}, {0, 1}, {-1, 2}, {-2, 1}, {-2.5, 3}};
    memcpy(m->vertex, p, m->n_vertices * sizeof *p);
    set_triangle(m, 0, 0, 1, 2);
    if (joined)
        set_triangle(m, 1, 2, 3, 4);
    else
        set_triangle(m, 1, 3, 5, 4);
    return m;
}

static void test_bare(void)
{
    Mesh *apart = two_triangles(false), *joined = two_triangles(true), *lone = two_triangles(true);
    expect_bare(apart, (uint32_t[]){1}, 1, "(-1, 2): of its 3 vertices (3 is one)");
    expect_bare(apart, (uint32_t[]){5, 4, 3}, 3, "(0, 0): of its 3 vertices (0 is one)");
    expect_bare(joined, NULL, 0, "of its 5 vertices");
    lone->n_triangles = 1; /* vertices 3 and 4 are in no triangle */
    expect_bare(lone, (uint32_t[]){0, 3}, 2, "(-2, 1): of its 1 vertices (4 is one)");
    for (int kind = 0; kind < 2; kind++) {
        Vec3 posed[3] = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}, place[6];
        Membrane *m = make(apart, (Fixed){2, (uint32_t[]){1, 3}}, (MembraneKind)kind);
        membrane_interpolate(m, posed, place);
        for (int i = 0; i < 6; i++)
            g_assert_cmpfloat(vec3_dist(place[i], posed[i / 3]), <, 1e-13);
        membrane_free(m);
        m = make(joined, (Fixed){1, (uint32_t[]){4}}, (MembraneKind)kind); /* one vertex joins them */
        membrane_interpolate(m, posed, place);
        for (int i = 0; i < 5; i++)
            g_assert_cmpfloat(vec3_dist(place[i], posed[0]), <, 1e-12);
        membrane_free(m);
        m = make(lone, (Fixed){3, (uint32_t[]){4, 3, 0}}, (MembraneKind)kind);
        membrane_interpolate(m, posed, place);
        g_assert_cmpfloat(vec3_dist(place[1], posed[2]), <, 1e-13);
        g_assert_cmpfloat(vec3_dist(place[4], posed[0]), ==, 0.0);
        membrane_free(m);
    }
    mesh_drop(apart);
    mesh_drop(joined);
    mesh_drop(lone);
}

static void test_all_fixed(void)
{
    Mesh *m = two_triangles(true);
    Fixed f = {5, (uint32_t[]){4, 2, 0, 1, 3}};
    for (int kind = 0; kind < 2; kind++) {
        Membrane *membrane = make(m, f, (MembraneKind)kind);
        Vec3 *posed = random_pose(f, 140), place[5];
        Mat3 turn[5] = {some_rotation(), some_rotation(), some_rotation(), some_rotation(), some_rotation()};
        membrane_interpolate(membrane, posed, place);
        membrane_interpolate_turned(membrane, posed, turn, place);
        for (uint32_t i = 0; i < 5; i++)
            g_assert_cmpfloat(vec3_dist(place[f.at[i]], posed[i]), ==, 0.0);
        g_assert_cmpfloat(membrane_residual(membrane, place), ==, 0.0);
        g_free(posed);
        membrane_free(membrane);
    }
    membrane_free(NULL);
    mesh_drop(m);
}

/* Triangles some 1e-12 thin: an answer or an error, never numbers that aren't. */
static void test_thin(void)
{
    int refused = 0;
    for (int kind = 0; kind < 2; kind++)
        for (double thin = 1e-3; thin > 1e-13; thin *= 0.1) {
            Mesh *m = grid_scaled(6, 6, 1.0, thin);
            GError *error = NULL;
            Vec3 posed[2] = {{0, 0, 0}, {1, 1, 1}}, place[49];
            Membrane *membrane = membrane_new(m, (uint32_t[]){0, 48}, 2, (MembraneKind)kind, &error);
            if (membrane) {
                membrane_interpolate(membrane, posed, place);
                for (int i = 0; i < 49; i++)
                    g_assert_true(isfinite(place[i].x));
            } else {
                g_assert_error(error, MEMBRANE_ERROR, MEMBRANE_ERROR_FACTOR);
                g_clear_error(&error);
                refused++;
            }
            membrane_free(membrane);
            mesh_drop(m);
        }
    g_assert_cmpint(refused, >, 0);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/membrane/weights/grids", test_weights_grids);
    g_test_add_func("/membrane/weights/rounding", test_weights_rounding);
    g_test_add_func("/membrane/weights/voronoi", test_weights_voronoi);
    g_test_add_func("/membrane/areas", test_areas);
    g_test_add_func("/membrane/affine", test_affine);
    g_test_add_func("/membrane/disc", test_disc);
    g_test_add_func("/membrane/strip", test_strip);
    g_test_add_func("/membrane/ring", test_ring);
    g_test_add_func("/membrane/veins-inside", test_veins_inside);
    g_test_add_func("/membrane/maximum-principle", test_maximum_principle);
    g_test_add_func("/membrane/residual", test_residual);
    g_test_add_func("/membrane/harmonic-is-interpolate", test_harmonic_is_interpolate);
    g_test_add_func("/membrane/coordinates", test_coordinates);
    g_test_add_func("/membrane/kept-factor", test_kept_factor);
    g_test_add_func("/membrane/numbering", test_numbering);
    g_test_add_func("/membrane/margin/without-slope", test_margin_without_slope);
    g_test_add_func("/membrane/margin/drawn-in", test_margin_drawn_in);
    g_test_add_func("/membrane/margin/turned-rigid", test_turned_rigid);
    g_test_add_func("/membrane/bilaplace/affine", test_bilaplace_affine);
    g_test_add_func("/membrane/bilaplace/spline", test_bilaplace_spline);
    g_test_add_func("/membrane/bilaplace/rim", test_bilaplace_rim);
    g_test_add_func("/membrane/bare", test_bare);
    g_test_add_func("/membrane/all-fixed", test_all_fixed);
    g_test_add_func("/membrane/thin", test_thin);
    return g_test_run();
}
