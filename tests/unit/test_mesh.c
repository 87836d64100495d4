/* The mesher against what a conforming Delaunay mesh must be, checked anew by brute force; the graph check and the locator against plain
 * twins. */
#include <glib.h>
#include <time.h>

#include "geom/outline.h"
#include "plain_leaf.h"

/* --- what holds for every mesh --- */

static double twice_area(Vec2 a, Vec2 b, Vec2 c) { return vec_cross(vec_sub(b, a), vec_sub(c, a)); }

/* Cotangent of the angle at o. */
static double cotangent(Vec2 o, Vec2 a, Vec2 b)
{
    return vec_dot(vec_sub(a, o), vec_sub(b, o)) / vec_cross(vec_sub(a, o), vec_sub(b, o));
}

static double degrees_at(Vec2 o, Vec2 a, Vec2 b)
{
    Vec2 u = vec_sub(a, o), v = vec_sub(b, o);
    return dtrig_atan2(fabs(vec_cross(u, v)), vec_dot(u, v)) / DTRIG_DEGREE;
}

static uint32_t input_end(const Pslg *g, uint32_t input, uint32_t k)
{
    return input < g->n_outline ? (input + k) % g->n_outline : g->segment[input - g->n_outline][k];
}

/* Directed edges of the triangles: key from << 32 | to, the opposite vertex, and the input segment that the edge is part of. */
typedef struct {
    guint64 key;
    uint32_t opposite;
} Half;

static gint half_compare(gconstpointer a, gconstpointer b)
{
    const Half *s = a, *t = b;
    return (s->key > t->key) - (s->key < t->key);
}

typedef struct {
    const Pslg *g;
    const Mesh *m;
    Half *half; /* [3 n_triangles] sorted */
    GHashTable *input; /* undirected edges on input segments: key with the smaller vertex first -> input + 1 */
} Checked;

static guint64 key_of(uint32_t from, uint32_t to) { return (guint64)from << 32 | to; }

static const Half *half_find(const Checked *c, uint32_t from, uint32_t to)
{
    Half wanted = {key_of(from, to), 0};
    uint32_t lo = 0, hi = 3 * c->m->n_triangles;
    while (lo < hi) {
        uint32_t mid = lo + (hi - lo) / 2;
        if (half_compare(&c->half[mid], &wanted) < 0)
            lo = mid + 1;
        else
            hi = mid;
    }
    return lo < 3 * c->m->n_triangles && c->half[lo].key == wanted.key ? &c->half[lo] : NULL;
}

static uint32_t input_of(const Checked *c, uint32_t a, uint32_t b)
{
    guint64 key = a < b ? key_of(a, b) : key_of(b, a);
    return GPOINTER_TO_UINT(g_hash_table_lookup(c->input, &key)) - 1; /* UINT32_MAX: none */
}

/* Counter-clockwise triangles that fill the outline, each edge shared by two or on the margin: a disc. */
static void check_topology(const Checked *c)
{
    const Mesh *m = c->m;
    double area = 0.0;
    uint8_t *used = g_malloc0(m->n_vertices);
    for (uint32_t i = 0; i < m->n_triangles; i++) {
        const uint32_t *t = m->triangle[i];
        double a = twice_area(m->vertex[t[0]], m->vertex[t[1]], m->vertex[t[2]]);
        g_assert_cmpfloat(a, >, 0.0);
        area += 0.5 * a;
        used[t[0]] = used[t[1]] = used[t[2]] = 1;
    }
    uint32_t alone = 0;
    for (uint32_t i = 0; i < 3 * m->n_triangles; i++) {
        g_assert_true(i == 0 || c->half[i].key != c->half[i - 1].key);
        alone += !half_find(c, (uint32_t)c->half[i].key, (uint32_t)(c->half[i].key >> 32));
    }
    for (uint32_t i = 0; i < m->n_vertices; i++)
        g_assert_true(used[i]);
    g_free(used);
    g_assert_cmpuint(alone, ==, m->n_boundary);
    /* V - E + F = 1, where each triangle has three half edges and a margin edge but one half */
    int64_t edges = (3 * (int64_t)m->n_triangles + m->n_boundary) / 2;
    g_assert_cmpint((int64_t)m->n_vertices - edges + m->n_triangles, ==, 1);
    Polygon *outline = polygon_new(c->g->point, c->g->n_outline);
    g_assert_cmpfloat(fabs(area - outline->area), <=, 1e-9 * outline->area);
    polygon_free(outline);
}

/* Runs of edges, one run an input segment in order, each from its start to its end along it. */
static void check_run(Checked *c, uint32_t (*edge)[2], const uint32_t *input, uint32_t n, uint32_t first, uint32_t count)
{
    const Pslg *g = c->g;
    uint32_t at = 0;
    for (uint32_t s = 0; s < count; s++) {
        uint32_t a = input_end(g, first + s, 0), b = input_end(g, first + s, 1), v = a;
        Vec2 d = vec_sub(g->point[b], g->point[a]);
        double along = 0.0, length = sqrt(vec_norm2(d)), reach = fmax(fabs(g->point[a].x) + fabs(g->point[a].y), length);
        do {
            g_assert_cmpuint(at, <, n);
            g_assert_cmpuint(input[at], ==, s);
            g_assert_cmpuint(edge[at][0], ==, v);
            v = edge[at][1];
            Vec2 away = vec_sub(c->m->vertex[v], g->point[a]);
            g_assert_cmpfloat(vec_dot(away, d), >, along);
            g_assert_cmpfloat(fabs(vec_cross(away, d)) / length, <=, 1e-13 * reach);
            along = vec_dot(away, d);
            guint64 *key = g_new(guint64, 1);
            *key = edge[at][0] < v ? key_of(edge[at][0], v) : key_of(v, edge[at][0]);
            g_hash_table_insert(c->input, key, GUINT_TO_POINTER(first + s + 1));
            /* an outline edge has the blade on its left alone, a vein edge on both sides */
            g_assert_true(half_find(c, edge[at][0], v));
            g_assert_cmpint(half_find(c, v, edge[at][0]) != NULL, ==, first > 0);
            at++;
        } while (v != b);
    }
    g_assert_cmpuint(at, ==, n);
}

/* Weights of finite volumes: no Voronoi edge, cut off at the margin, has a negative length. */
static void check_delaunay(const Checked *c)
{
    const Vec2 *v = c->m->vertex;
    for (uint32_t i = 0; i < 3 * c->m->n_triangles; i++) {
        uint32_t a = (uint32_t)(c->half[i].key >> 32), b = (uint32_t)c->half[i].key;
        const Half *twin = half_find(c, b, a);
        double here = cotangent(v[c->half[i].opposite], v[a], v[b]);
        if (input_of(c, a, b) != UINT32_MAX)
            g_assert_cmpfloat(here, >=, -1e-9); /* nothing in the circle over a constrained edge */
        if (twin)
            g_assert_cmpfloat(here + cotangent(v[twin->opposite], v[b], v[a]), >=, -1e-9 * (1.0 + fabs(here)));
    }
}

/* Whether the least angle of a triangle, at corner o, may be small: it is an angle of the input, or its opposite side p q joins points
 * equally far from the corner of the input where their segments meet at less than 60°. */
static bool is_excused(const Checked *c, const uint32_t *segment_of, uint32_t o, uint32_t p, uint32_t q)
{
    const Pslg *g = c->g;
    if (input_of(c, o, p) != UINT32_MAX && input_of(c, o, q) != UINT32_MAX)
        return true;
    uint32_t s = segment_of[p], t = segment_of[q];
    if (s == UINT32_MAX || t == UINT32_MAX)
        return false;
    for (uint32_t k = 0; k < 4; k++) {
        uint32_t corner = input_end(g, s, k & 1);
        if (corner != input_end(g, t, k >> 1))
            continue;
        Vec2 at = g->point[corner];
        double far = vec_dist(at, c->m->vertex[p]);
        return fabs(far - vec_dist(at, c->m->vertex[q])) <= 1e-3 * far &&
               degrees_at(at, g->point[input_end(g, s, 1 - (k & 1))], g->point[input_end(g, t, 1 - (k >> 1))]) < 60.0;
    }
    return false;
}

/* Returns how many triangles have a lesser angle with an excuse; *none without. */
static uint32_t count_small(const Checked *c, double min_angle, uint32_t *none)
{
    const Mesh *m = c->m;
    uint32_t excused = 0, *segment_of = g_new(uint32_t, m->n_vertices);
    memset(segment_of, 0xff, m->n_vertices * sizeof *segment_of);
    for (uint32_t i = 0; i < m->n_boundary + m->n_vein; i++) {
        bool vein = i >= m->n_boundary;
        uint32_t k = vein ? i - m->n_boundary : i, v = vein ? m->vein[k][1] : m->boundary[k][1];
        if (v >= c->g->n_points)
            segment_of[v] = vein ? c->g->n_outline + m->vein_input[k] : m->boundary_input[k];
    }
    for (uint32_t i = 0; i < m->n_triangles; i++) {
        const uint32_t *t = m->triangle[i];
        double least = 180.0;
        uint32_t at = 0;
        for (uint32_t k = 0; k < 3; k++) {
            double angle = degrees_at(m->vertex[t[k]], m->vertex[t[(k + 1) % 3]], m->vertex[t[(k + 2) % 3]]);
            if (angle < least) {
                least = angle;
                at = k;
            }
        }
        if (least >= min_angle - 1e-6)
            continue;
        bool excuse = is_excused(c, segment_of, t[at], t[(at + 1) % 3], t[(at + 2) % 3]);
        excused += excuse;
        *none += !excuse;
    }
    g_free(segment_of);
    return excused;
}

static bool crosses(Vec2 a, Vec2 b, Vec2 c, Vec2 d)
{
    return twice_area(a, b, c) * twice_area(a, b, d) < 0.0 && twice_area(c, d, a) * twice_area(c, d, b) < 0.0;
}

/* The definition: no vertex within the circle through a triangle's corners, but those that the triangle can't see for the margin. */
static void check_circles(const Checked *c)
{
    const Mesh *m = c->m;
    for (uint32_t i = 0; i < m->n_triangles; i++) {
        const uint32_t *t = m->triangle[i];
        Vec2 o = m->vertex[t[0]], a = vec_sub(m->vertex[t[1]], o), b = vec_sub(m->vertex[t[2]], o);
        double k = 0.5 / vec_cross(a, b), aa = vec_norm2(a), bb = vec_norm2(b);
        Vec2 centre = vec2((b.y * aa - a.y * bb) * k, (a.x * bb - b.x * aa) * k);
        double radius = sqrt(vec_norm2(centre));
        for (uint32_t v = 0; v < m->n_vertices; v++) {
            Vec2 p = vec_sub(m->vertex[v], o);
            if (v == t[0] || v == t[1] || v == t[2] || vec_dist(p, centre) >= radius * (1.0 - 1e-9))
                continue;
            Vec2 middle = vec_add(o, vec_scale(vec_add(a, b), 1.0 / 3.0));
            bool hidden = false;
            for (uint32_t e = 0; e < m->n_boundary && !hidden; e++)
                hidden = crosses(middle, m->vertex[v], m->vertex[m->boundary[e][0]], m->vertex[m->boundary[e][1]]);
            g_assert_true(hidden);
        }
    }
}

typedef struct {
    uint32_t excused, none; /* triangles of a lesser angle, with an excuse and without */
} Small;

/* All of the above; the circles when there are few triangles. */
static Small check_mesh(const Pslg *g, const MeshDef *def, const Mesh *m)
{
    Checked c = {.g = g, .m = m, .half = g_new(Half, 3 * (gsize)m->n_triangles)};
    c.input = g_hash_table_new_full(g_int64_hash, g_int64_equal, g_free, NULL);
    for (uint32_t i = 0; i < 3 * m->n_triangles; i++) {
        const uint32_t *t = m->triangle[i / 3];
        c.half[i] = (Half){key_of(t[i % 3], t[(i + 1) % 3]), t[(i + 2) % 3]};
    }
    qsort(c.half, 3 * (gsize)m->n_triangles, sizeof *c.half, half_compare);
    g_assert_cmpuint(m->n_vertices, >=, g->n_points);
    g_assert_true(memcmp(m->vertex, g->point, g->n_points * sizeof(Vec2)) == 0);
    check_topology(&c);
    check_run(&c, m->boundary, m->boundary_input, m->n_boundary, 0, g->n_outline);
    check_run(&c, m->vein, m->vein_input, m->n_vein, g->n_outline, g->n_segments);
    check_delaunay(&c);
    if (m->n_triangles < 700)
        check_circles(&c);
    for (uint32_t i = 0; i < m->n_triangles && def->max_area > 0.0; i++) {
        const uint32_t *t = m->triangle[i];
        g_assert_cmpfloat(0.5 * twice_area(m->vertex[t[0]], m->vertex[t[1]], m->vertex[t[2]]), <=, def->max_area * (1.0 + 1e-12));
    }
    Small small = {0, 0};
    small.excused = count_small(&c, def->min_angle, &small.none);
    g_hash_table_destroy(c.input);
    g_free(c.half);
    return small;
}

static Mesh *mesh_or_fail(const Pslg *g, const MeshDef *def)
{
    GError *error = NULL;
    Mesh *m = mesh_new(g, def, &error);
    g_assert_no_error(error);
    g_assert_nonnull(m);
    return m;
}

/* Meshes, checks and frees; a lesser angle must have its excuse. Returns how many triangles have one. */
static uint32_t mesh_well(const Pslg *g, MeshDef def, uint32_t *triangles)
{
    Mesh *m = mesh_or_fail(g, &def);
    Small small = check_mesh(g, &def, m);
    g_assert_cmpuint(small.none, ==, 0);
    if (triangles)
        *triangles = m->n_triangles;
    mesh_free(m);
    return small.excused;
}

static Pslg *graph_of(const Vec2 *point, uint32_t n_points, uint32_t n_outline, const uint32_t (*segment)[2], uint32_t n_segments)
{
    Pslg *g = pslg_new(n_points, n_outline, n_segments);
    memcpy(g->point, point, n_points * sizeof *point);
    if (n_segments)
        memcpy(g->segment, segment, n_segments * sizeof *segment);
    return g;
}

/* --- meshes --- */

static void test_square(void)
{
    const Vec2 corner[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    Pslg *g = graph_of(corner, 4, 4, NULL, 0);
    uint32_t n;
    g_assert_cmpuint(mesh_well(g, (MeshDef){0}, &n), ==, 0);
    g_assert_cmpuint(n, ==, 2);
    g_assert_cmpuint(mesh_well(g, (MeshDef){.min_angle = 33.0}, &n), ==, 0);
    g_assert_cmpuint(n, ==, 2);
    for (uint32_t k = 1; k < 5; k++) { /* exact midpoints and circumcentres on edges, all cocircular */
        double area = 0.5;
        for (uint32_t i = 0; i < 2 * k; i++)
            area *= 0.5;
        g_assert_cmpuint(mesh_well(g, (MeshDef){.min_angle = 20.0, .max_area = area}, &n), ==, 0);
        g_assert_cmpuint(n, >=, 1u << (2 * k + 1));
        g_assert_cmpuint(n, <, 4u << (2 * k + 1));
    }
    pslg_free(g);
}

/* A regular grid of free points: everything on circles with everything. */
static void test_lattice(void)
{
    enum { SIDE = 12 };
    Pslg *g = pslg_new(4 + SIDE * SIDE, 4, 0);
    const Vec2 corner[4] = {{-1, -1}, {SIDE, -1}, {SIDE, SIDE}, {-1, SIDE}};
    memcpy(g->point, corner, sizeof corner);
    for (uint32_t i = 0; i < SIDE * SIDE; i++)
        g->point[4 + i] = vec2(i % SIDE, i / SIDE);
    uint32_t n;
    mesh_well(g, (MeshDef){0}, &n);
    g_assert_cmpuint(mesh_well(g, (MeshDef){.min_angle = 30.0}, &n), ==, 0);
    g_assert_cmpuint(mesh_well(g, (MeshDef){.min_angle = 30.0, .max_area = 0.1}, &n), ==, 0);
    pslg_free(g);
}

/* Fifty outlines of six kinds with veins that branch at 40°, and at several least angles. */
static void test_leaves(void)
{
    const double angle[] = {0.0, 15.0, 20.0, 25.0, 28.0};
    uint32_t excused = 0, veins = 0;
    for (uint32_t k = 0; k < 54; k++) {
        Pslg *g = plain_leaf((int)(k % LEAF_KINDS), 20 + 40 * (k % 5), k, 0.1, 40.0, 0.02);
        for (uint32_t i = 0; i < G_N_ELEMENTS(angle); i++)
            excused += mesh_well(g, (MeshDef){.min_angle = angle[i], .max_area = i == 2 ? 0.001 : 0.0}, NULL);
        veins += g->n_segments;
        pslg_free(g);
    }
    g_assert_cmpuint(veins, >, 54 * 50);
    g_test_message("%u segments of veins, %u triangles beside small angles", veins, excused);
}

/* Two degrees between veins: nothing may run away, and beyond the angles of the input all is well up to 30°, and but for one in a thousand
 * at 33°. */
static void test_small_angles(void)
{
    const double angle[] = {20.0, 28.0, 30.0, 33.0};
    for (uint32_t k = 0; k < 12; k++) {
        Pslg *g = plain_leaf((int)(k % LEAF_KINDS), 80, k, 0.15, k % 4 ? 2.0 : 15.0, 0.0005);
        for (uint32_t i = 0; i < G_N_ELEMENTS(angle); i++) {
            MeshDef def = {.min_angle = angle[i]};
            Mesh *m = mesh_or_fail(g, &def);
            Small small = check_mesh(g, &def, m);
            g_assert_cmpuint(small.none, <=, angle[i] > 30.0 ? m->n_triangles / 1000 : 0);
            g_assert_cmpuint(m->n_triangles, <, (angle[i] > 30.0 ? 1000 : 200) * g->n_points);
            mesh_free(m);
        }
        pslg_free(g);
    }
}

/* Triangles beside an angle of the input may be as narrow as about half of it. */
static void test_wedges(void)
{
    const double angle[] = {0.5, 2.0, 5.0, 10.0, 20.0, 30.0, 45.0, 59.0};
    for (uint32_t k = 0; k < G_N_ELEMENTS(angle) * 6; k++) {
        PlainLeaf l;
        plain_leaf_init(&l, LEAF_ELLIPSE, 40, 0);
        uint32_t hub = plain_add_point(&l, vec2(0.05, 0.02));
        double wedge = angle[k / 6] * DTRIG_DEGREE, bound = k % 2 ? 20.0 : 30.0;
        for (uint32_t i = 0; i < 2; i++) {
            double t = 0.3 * k + i * wedge, r = i ? 0.3 + 0.05 * (k % 6) : 0.5;
            plain_add_segment(&l, hub, plain_add_point(&l, vec_add(plain_point(&l, hub), vec2(r * dtrig_cos(t), r * dtrig_sin(t)))));
        }
        Pslg *g = plain_graph(&l);
        plain_leaf_clear(&l);
        MeshDef def = {.min_angle = bound};
        Mesh *m = mesh_or_fail(g, &def);
        g_assert_cmpuint(check_mesh(g, &def, m).none, ==, 0);
        for (uint32_t i = 0; i < 3 * m->n_triangles; i++) {
            const uint32_t *t = m->triangle[i / 3];
            double at = degrees_at(m->vertex[t[i % 3]], m->vertex[t[(i + 1) % 3]], m->vertex[t[(i + 2) % 3]]);
            g_assert_cmpfloat(at, >=, fmin(bound - 1e-6, 0.5 * angle[k / 6]));
        }
        mesh_free(m);
        pslg_free(g);
    }
}

/* A fan of segments from one point, as close as a tenth of a degree, of lengths at random; and as many as a thousand. */
static void test_fans(void)
{
    for (uint32_t k = 0; k < 12; k++) {
        PlainLeaf l;
        plain_leaf_init(&l, LEAF_ELLIPSE, 40, 0);
        uint32_t hub = k % 2 ? 0 : plain_add_point(&l, vec2(0.1, -0.2)), n = k < 10 ? 2 + k : 150 * (k - 9);
        double apart = k < 10 ? (k % 3 == 0 ? 0.1 : k % 3 == 1 ? 2.0 : 9.0) * DTRIG_DEGREE : 0.6 * DTRIG_PI / (n + 1);
        for (uint32_t i = 0; i < n; i++) {
            double t = (k < 10 ? 0.4 : 0.2) * DTRIG_PI + apart * (i + 1), r = 0.3 + 0.2 * plain_uniform(k, 3, i);
            uint32_t tip = plain_add_point(&l, vec_add(plain_point(&l, hub), vec2(r * dtrig_cos(t), r * dtrig_sin(t))));
            plain_add_segment(&l, hub, tip);
        }
        Pslg *g = plain_graph(&l);
        plain_leaf_clear(&l);
        uint32_t triangles;
        g_assert_cmpuint(mesh_well(g, (MeshDef){.min_angle = 25.0}, &triangles), >, 0);
        g_assert_cmpuint(triangles, <, 100 * (g->n_points + 20 * n));
        pslg_free(g);
    }
}

static Pslg *curve(uint32_t n, bool chord)
{
    PlainLeaf l;
    plain_leaf_init(&l, LEAF_ELLIPSE, n, 0);
    if (chord)
        plain_add_segment(&l, 0, n / 2);
    Pslg *g = plain_graph(&l);
    plain_leaf_clear(&l);
    return g;
}

static double seconds_of(const Pslg *g, MeshDef def)
{
    clock_t start = clock();
    mesh_free(mesh_or_fail(g, &def));
    return (double)(clock() - start) / CLOCKS_PER_SEC;
}

/* A curve of many points with nothing inside, and one with a segment along it that all faces lie across: fans of thousands of triangles,
 * which must not take time in their square. */
static void test_large_holes(void)
{
    Pslg *hole = curve(10000, false), *halves = curve(10000, true);
    g_assert_cmpuint(mesh_well(hole, (MeshDef){.min_angle = 20.0}, NULL), ==, 0);
    g_assert_cmpuint(mesh_well(halves, (MeshDef){.min_angle = 20.0}, NULL), ==, 0);
    pslg_free(hole);
    pslg_free(halves);
    hole = curve(30000, false);
    halves = curve(30000, true);
    double alone = seconds_of(hole, (MeshDef){0});
    g_assert_cmpfloat(alone, <, 15.0);
    g_assert_cmpfloat(seconds_of(halves, (MeshDef){0}), <, 4.0 * alone + 0.2);
    pslg_free(hole);
    pslg_free(halves);
}

/* A vein whose tip is on the margin, one that runs up to the margin as near as may be, and one along it. */
static void test_at_margin(void)
{
    for (int e = 1; e <= 9; e++) {
        double gap = 2.1e-9; /* mesh_new asks for a billionth of the largest coordinate, 2 here */
        for (int k = e; k < 9; k++)
            gap *= 10.0;
        const Vec2 point[] = {{0, 0}, {2, 0}, {2, 2}, {1, 2}, {0, 2}, {1, 1}, {2.0 - gap, 1}, {0.5, gap}, {0.5, 0.5}};
        const uint32_t segment[][2] = {{5, 3}, {5, 6}, {8, 7}, {8, 5}};
        Pslg *g = graph_of(point, G_N_ELEMENTS(point), 5, segment, G_N_ELEMENTS(segment));
        uint32_t n;
        mesh_well(g, (MeshDef){.min_angle = 25.0, .max_area = 0.1}, &n);
        g_assert_cmpuint(n, <, 2000);
        g->point[6].x = 2.0 - 0.4e-9;
        GError *error = NULL;
        g_assert_null(mesh_new(g, &(MeshDef){.min_angle = 25.0}, &error));
        g_assert_error(error, MESH_ERROR, MESH_ERROR_INPUT);
        g_error_free(error);
        pslg_free(g);
    }
    const Vec2 along[] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0.1, 1e-3}, {0.9, 1e-3}}; /* a strip 800 times as long as wide */
    const uint32_t vein[][2] = {{4, 5}};
    Pslg *g = graph_of(along, 6, 4, vein, 1);
    uint32_t fine, coarse;
    mesh_well(g, (MeshDef){.min_angle = 20.0}, &fine);
    g_assert_cmpuint(fine, <, 10000);
    MeshDef def = {.min_angle = 20.0, .floor = 0.02};
    Mesh *m = mesh_or_fail(g, &def); /* the floor gives up angles, not conformity */
    g_assert_cmpuint(check_mesh(g, &def, m).none, >, 0);
    coarse = m->n_triangles;
    mesh_free(m);
    g_assert_cmpuint(coarse, <, fine);
    pslg_free(g);
}

/* The outlines of the models, with veins. */
static void test_outlines(void)
{
    char *folder = g_test_build_filename(G_TEST_DIST, "..", "..", "params", "outlines", NULL);
    GDir *dir = g_dir_open(folder, 0, NULL);
    g_assert_nonnull(dir);
    const char *name;
    uint32_t found = 0;
    while ((name = g_dir_read_name(dir))) {
        if (!g_str_has_suffix(name, ".svg"))
            continue;
        OutlineDef def = outline_def_default();
        char *file = g_build_filename(folder, name, NULL);
        def.path = NULL;
        def.mirror = false;
        def.file = def.where = file;
        GError *error = NULL;
        PlainLeaf l = {.seed = 5, .clear = 0.01, .branch = 50.0 * DTRIG_DEGREE};
        l.outline = outline_new(&def, &error);
        g_assert_no_error(error);
        l.n_outline = l.outline->n;
        l.point = g_array_new(FALSE, FALSE, sizeof(Vec2));
        l.segment = g_array_new(FALSE, FALSE, 2 * sizeof(uint32_t));
        g_array_append_vals(l.point, l.outline->v, l.n_outline);
        plain_grow(&l, 0, 0.5 * DTRIG_PI, 0.06, 14, 2);
        Pslg *g = plain_graph(&l);
        mesh_well(g, (MeshDef){.min_angle = 20.0}, NULL);
        mesh_well(g, (MeshDef){.min_angle = 28.0, .max_area = 2e-4}, NULL);
        pslg_free(g);
        plain_leaf_clear(&l);
        g_free(file);
        found++;
    }
    g_assert_cmpuint(found, >=, 14);
    g_dir_close(dir);
    g_free(folder);
}

/* Star-shaped polygons and segments on small grids of whole numbers, whatever passes the check: collinear and cocircular points abound. */
static void test_whole_numbers(void)
{
    uint32_t meshed = 0, segments = 0;
    for (uint32_t k = 0; k < 300; k++) {
        uint32_t n = 4 + k % 9, grid = k % 2 ? 6 : 16, wanted = 12;
        Pslg *g = pslg_new(n + wanted, n, 0);
        g->segment = g_malloc0_n(wanted, sizeof *g->segment);
        for (uint32_t i = 0; i < n; i++) {
            double t = 2.0 * DTRIG_PI * i / n, r = grid * (0.4 + 0.6 * plain_uniform(k, 4, i));
            g->point[i] = vec2(floor(r * dtrig_cos(t)), floor(r * dtrig_sin(t)));
        }
        g->n_points = n;
        for (uint32_t i = 0; i < 60 && g->n_points < n + wanted && g->n_segments < wanted; i++) {
            RandomBlock b = random_block(k, 5, 0, i);
            uint32_t to = i % 3 ? g->n_points : 1 + b.w[3] % (g->n_points - 1);
            if (to == g->n_points)
                g->point[g->n_points++] = vec2((double)(b.w[0] % (2 * grid)) - grid, (double)(b.w[1] % (2 * grid)) - grid);
            g->segment[g->n_segments][0] = b.w[2] % to;
            g->segment[g->n_segments++][1] = to;
            if (!pslg_check(g, 1e-6, NULL)) {
                g->n_segments--;
                g->n_points -= to + 1 == g->n_points && i % 3;
            }
        }
        if (pslg_check(g, 1e-6, NULL)) {
            for (int i = 0; i < 3; i++)
                mesh_well(g, (MeshDef){.min_angle = 13.0 * i, .max_area = i == 1 ? 0.7 : 0.0}, NULL);
            meshed++;
            segments += g->n_segments;
        }
        pslg_free(g);
    }
    g_test_message("%u graphs, %u segments", meshed, segments);
    g_assert_cmpuint(meshed, >, 120);
    g_assert_cmpuint(segments, >, 400);
}

/* Scale, and a place far from the origin. */
static void test_far_and_small(void)
{
    const double scale[] = {1e-20, 1e-3, 1e6, 1e20};
    for (uint32_t k = 0; k < 8; k++) {
        Pslg *g = plain_leaf((int)(k % LEAF_KINDS), 60, k, 0.15, 40.0, 0.02);
        double s = scale[k % 4], away = k < 4 ? 0.0 : 1e5 * s;
        for (uint32_t i = 0; i < g->n_points; i++)
            g->point[i] = vec2(away + s * g->point[i].x, s * g->point[i].y - away);
        MeshDef def = {.min_angle = 25.0, .max_area = 0.01 * s * s};
        Mesh *m = mesh_or_fail(g, &def);
        if (k < 4)
            g_assert_cmpuint(check_mesh(g, &def, m).none, ==, 0);
        mesh_free(m);
        pslg_free(g);
    }
}

/* --- sameness --- */

static bool same_mesh(const Mesh *a, const Mesh *b)
{
    return a->n_vertices == b->n_vertices && a->n_triangles == b->n_triangles && a->n_boundary == b->n_boundary &&
           a->n_vein == b->n_vein && !memcmp(a->vertex, b->vertex, a->n_vertices * sizeof *a->vertex) &&
           !memcmp(a->triangle, b->triangle, a->n_triangles * sizeof *a->triangle) &&
           !memcmp(a->boundary, b->boundary, a->n_boundary * sizeof *a->boundary) &&
           !memcmp(a->boundary_input, b->boundary_input, a->n_boundary * sizeof *a->boundary_input) &&
           !memcmp(a->vein, b->vein, a->n_vein * sizeof *a->vein) &&
           !memcmp(a->vein_input, b->vein_input, a->n_vein * sizeof *a->vein_input);
}

typedef struct {
    Pslg *g;
    Mesh *first;
    uint32_t different;
} Again;

static gpointer mesh_again(gpointer data)
{
    Again *a = data;
    gpointer litter[500];
    for (uint32_t i = 0; i < G_N_ELEMENTS(litter); i++) /* other addresses */
        litter[i] = g_malloc(16 + i % 7 * 24);
    for (uint32_t i = 0; i < G_N_ELEMENTS(litter); i += 2)
        g_free(litter[i]);
    for (int k = 0; k < 4; k++) {
        Mesh *m = mesh_or_fail(a->g, &(MeshDef){.min_angle = 28.0, .max_area = 1e-3});
        a->different += !same_mesh(m, a->first);
        mesh_free(m);
    }
    for (uint32_t i = 1; i < G_N_ELEMENTS(litter); i += 2)
        g_free(litter[i]);
    return NULL;
}

static void test_same_bytes(void)
{
    Again a = {.g = plain_leaf(LEAF_LOBED, 150, 6, 0.1, 15.0, 0.01)};
    a.first = mesh_or_fail(a.g, &(MeshDef){.min_angle = 28.0, .max_area = 1e-3});
    g_assert_cmpuint(a.g->n_segments, >, 30);
    mesh_again(&a);
    GThread *thread[3]; /* at the same time */
    Again other[3];
    for (int k = 0; k < 3; k++) {
        other[k] = a;
        thread[k] = g_thread_new("mesh", mesh_again, &other[k]);
    }
    for (int k = 0; k < 3; k++) {
        g_thread_join(thread[k]);
        a.different += other[k].different;
    }
    g_assert_cmpuint(a.different, ==, 0);
    mesh_free(a.first);
    pslg_free(a.g);
}

static guint64 hash(guint64 h, gconstpointer data, gsize n)
{
    const uint8_t *byte = data;
    for (gsize i = 0; i < n; i++)
        h = (h ^ byte[i]) * 1099511628211u; /* FNV */
    return h;
}

/* On every compiler and machine. The numbers change when the mesher does, and not else. */
static void test_pinned_bytes(void)
{
    guint64 h = 14695981039346656037u;
    for (uint32_t k = 0; k < 12; k++) {
        Pslg *g = plain_leaf((int)(k % LEAF_KINDS), 80, k, 0.1, k % 2 ? 5.0 : 40.0, 0.005);
        Mesh *m = mesh_or_fail(g, &(MeshDef){.min_angle = 20.0 + k, .max_area = k % 3 ? 0.0 : 0.001});
        h = hash(h, m->vertex, m->n_vertices * sizeof *m->vertex);
        h = hash(h, m->triangle, m->n_triangles * sizeof *m->triangle);
        h = hash(h, m->boundary, m->n_boundary * sizeof *m->boundary);
        h = hash(h, m->vein, m->n_vein * sizeof *m->vein);
        mesh_free(m);
        pslg_free(g);
    }
    g_assert_cmphex(h, ==, 0x7cfcfa96813705b6u);
}

/* --- limits --- */

static void expect_error(const Pslg *g, MeshDef def, int code)
{
    GError *error = NULL;
    gint64 start = g_get_monotonic_time();
    g_assert_null(mesh_new(g, &def, &error));
    g_assert_error(error, MESH_ERROR, code);
    g_assert_cmpint(g_get_monotonic_time() - start, <, 20 * G_USEC_PER_SEC);
    g_test_message("%s", error->message);
    g_error_free(error);
}

static void test_limits(void)
{
    Pslg *g = plain_leaf(LEAF_ELLIPSE, 100, 1, 0.1, 40.0, 0.02);
    expect_error(g, (MeshDef){.max_area = 1e-30}, MESH_ERROR_SIZE);
    expect_error(g, (MeshDef){.max_area = 1e-30, .max_triangles = 1000}, MESH_ERROR_SIZE);
    expect_error(g, (MeshDef){.max_area = 1e-4, .max_triangles = 20000}, MESH_ERROR_SIZE);
    expect_error(g, (MeshDef){.max_triangles = 50}, MESH_ERROR_SIZE);
    expect_error(g, (MeshDef){.min_angle = 34.0}, MESH_ERROR_INPUT);
    expect_error(g, (MeshDef){.min_angle = NAN}, MESH_ERROR_INPUT);
    expect_error(g, (MeshDef){.max_area = -1.0}, MESH_ERROR_INPUT);
    expect_error(g, (MeshDef){.floor = NAN}, MESH_ERROR_INPUT);
    uint32_t n;
    mesh_well(g, (MeshDef){.min_angle = 20.0}, &n);
    mesh_well(g, (MeshDef){.min_angle = 20.0, .max_triangles = n}, NULL);
    expect_error(g, (MeshDef){.min_angle = 20.0, .max_triangles = n - 1}, MESH_ERROR_SIZE);
    pslg_free(g);
    /* a strip a hundred million times as long as wide */
    const Vec2 along[] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0.1, 1e-8}, {0.9, 1e-8}};
    const uint32_t vein[][2] = {{4, 5}};
    g = graph_of(along, 6, 4, vein, 1);
    expect_error(g, (MeshDef){.min_angle = 20.0, .max_triangles = 100000}, MESH_ERROR_SIZE);
    expect_error(g, (MeshDef){.floor = 1e-3, .max_triangles = 100000}, MESH_ERROR_SIZE);
    pslg_free(g);
    mesh_free(NULL);
    pslg_free(NULL);
    mesh_locator_free(NULL);
}

/* --- the check of graphs --- */

typedef struct {
    int64_t x, y;
} Whole;

static int turn(Whole a, Whole b, Whole c)
{
    int64_t k = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    return (k > 0) - (k < 0);
}

static bool on_segment(Whole a, Whole b, Whole c)
{
    return turn(a, b, c) == 0 && MIN(a.x, b.x) <= c.x && c.x <= MAX(a.x, b.x) && MIN(a.y, b.y) <= c.y && c.y <= MAX(a.y, b.y);
}

static bool winds(const Whole *v, uint32_t n, double x, double y)
{
    int winding = 0;
    for (uint32_t i = 0; i < n; i++) {
        Whole a = v[i], b = v[(i + 1) % n];
        double left = (double)(b.x - a.x) * (y - (double)a.y) - (x - (double)a.x) * (double)(b.y - a.y);
        winding += ((double)a.y <= y && (double)b.y > y && left > 0.0) - ((double)a.y > y && (double)b.y <= y && left < 0.0);
    }
    return winding != 0;
}

/* The rules one by one, exactly, in whole numbers. */
static bool is_clean(const Pslg *g)
{
    Whole v[64];
    uint32_t n = g->n_outline + g->n_segments;
    int64_t twice = 0;
    for (uint32_t i = 0; i < g->n_points; i++)
        v[i] = (Whole){(int64_t)g->point[i].x, (int64_t)g->point[i].y};
    for (uint32_t i = 0; i < g->n_outline; i++) {
        Whole a = v[i], b = v[(i + 1) % g->n_outline];
        twice += a.x * b.y - a.y * b.x;
    }
    for (uint32_t i = 0; i < g->n_points; i++)
        for (uint32_t j = 0; j < i; j++)
            if (v[i].x == v[j].x && v[i].y == v[j].y)
                return false;
    for (uint32_t s = 0; s < n; s++) {
        uint32_t a = input_end(g, s, 0), b = input_end(g, s, 1);
        if (a == b)
            return false;
        for (uint32_t i = 0; i < g->n_points; i++)
            if (i != a && i != b && on_segment(v[a], v[b], v[i]))
                return false;
        for (uint32_t t = 0; t < s; t++) {
            uint32_t c = input_end(g, t, 0), d = input_end(g, t, 1);
            if ((a == c && b == d) || (a == d && b == c))
                return false;
            if (turn(v[a], v[b], v[c]) * turn(v[a], v[b], v[d]) < 0 && turn(v[c], v[d], v[a]) * turn(v[c], v[d], v[b]) < 0)
                return false;
        }
        double x = 0.5 * (double)(v[a].x + v[b].x), y = 0.5 * (double)(v[a].y + v[b].y);
        if (s >= g->n_outline && !winds(v, g->n_outline, x, y))
            return false;
    }
    for (uint32_t i = g->n_outline; i < g->n_points; i++)
        if (!winds(v, g->n_outline, (double)v[i].x, (double)v[i].y))
            return false;
    return twice > 0;
}

static void test_check_twin(void)
{
    uint32_t clean = 0, tried = 0;
    for (uint32_t k = 0; k < 30000; k++, tried++) {
        uint32_t n_outline = 3 + k % 4, inner = k % 5, grid = k % 3 ? 40 : 9;
        Pslg *g = pslg_new(n_outline + inner, n_outline, inner);
        for (uint32_t i = 0; i < g->n_points; i++) {
            RandomBlock b = random_block(k, 6, 0, i);
            /* outlines mostly from the four corners inwards, so that many enclose the rest */
            const Vec2 corner[6] = {{0, 0}, {1, 0}, {1, 0.5}, {1, 1}, {0, 1}, {0, 0.5}};
            double wide = i < n_outline ? 0.4 : 1.0, from = 0.5 * (1.0 - wide) * grid;
            Vec2 c = i < n_outline ? vec_scale(vec_sub(corner[i * 6 / n_outline], vec2(0.5, 0.5)), grid) : vec2(0, 0);
            g->point[i] = vec2(floor(from + c.x + wide * (b.w[0] % grid)), floor(from + c.y + wide * (b.w[1] % grid)));
        }
        for (uint32_t i = 0; i < inner; i++) {
            RandomBlock b = random_block(k, 7, 0, i);
            g->segment[i][0] = b.w[0] % g->n_points;
            g->segment[i][1] = k % 2 ? n_outline + i : b.w[1] % g->n_points;
        }
        GError *error = NULL;
        bool good = pslg_check(g, 1e-6, &error), want = is_clean(g);
        g_assert_cmpint(good, ==, want);
        g_assert_cmpint(good, ==, error == NULL);
        clean += good;
        g_clear_error(&error);
        pslg_free(g);
    }
    g_test_message("%u of %u clean", clean, tried);
    g_assert_cmpuint(clean, >, tried / 20);
    g_assert_cmpuint(clean, <, tried - tried / 20);
}

/* Every pair of segments, and the places of points. */
static bool is_clear(const Pslg *g, double least)
{
    uint32_t n = g->n_outline + g->n_segments;
    bool clear = true;
    for (uint32_t s = 0; s < n && clear; s++) {
        uint32_t a = input_end(g, s, 0), b = input_end(g, s, 1);
        clear = vec_dist(g->point[a], g->point[b]) >= least;
        for (uint32_t i = 0; i < g->n_points && clear; i++)
            clear = i == a || i == b || segment_dist2(g->point[a], g->point[b], g->point[i]) >= least * least;
        for (uint32_t t = 0; t < s && clear; t++) {
            uint32_t c = input_end(g, t, 0), d = input_end(g, t, 1);
            if (a != c && a != d && b != c && b != d)
                clear = plain_apart(g->point[a], g->point[b], g->point[c], g->point[d], least);
        }
    }
    Polygon *outline = polygon_new(g->point, g->n_outline);
    for (uint32_t i = g->n_outline; i < g->n_points && clear; i++)
        clear = polygon_contains(outline, g->point[i]);
    polygon_free(outline);
    return clear;
}

/* Large graphs with one point moved, a little or onto another. */
static void test_check_large(void)
{
    uint32_t clear = 0, tried = 0;
    for (uint32_t k = 0; k < 240; k++, tried++) {
        Pslg *g = plain_leaf((int)(k % 3), 60, k / 40, 0.08, 50.0, 0.02);
        uint32_t i = random_block(1, 8, k, 0).w[0] % g->n_points, j = random_block(1, 8, k, 1).w[0] % g->n_points;
        double reach = k % 2 ? 0.05 : 0.03, u[2];
        random_pair(1, 8, k, 2, u);
        g->point[i] = vec_add(g->point[k % 4 ? i : j], vec2(reach * (u[0] - 0.5), reach * (u[1] - 0.5)));
        bool want = is_clear(g, 0.01);
        g_assert_cmpint(pslg_check(g, 0.01, NULL), ==, want);
        clear += want;
        pslg_free(g);
    }
    g_test_message("%u of %u clear", clear, tried);
    g_assert_cmpuint(clear, >, tried / 5);
    g_assert_cmpuint(clear, <, tried - tried / 5);
}

static void expect_refused(const Pslg *g, double least, const char *const *words)
{
    GError *error = NULL;
    g_assert_false(pslg_check(g, least, &error));
    g_assert_error(error, MESH_ERROR, MESH_ERROR_INPUT);
    g_test_message("%s", error->message);
    for (; *words; words++)
        if (!strstr(error->message, *words))
            g_error("«%s» lacks «%s»", error->message, *words);
    g_clear_error(&error);
    if (least > 1e-6)
        return;
    g_assert_null(mesh_new(g, &(MeshDef){.min_angle = 20.0}, &error));
    g_assert_error(error, MESH_ERROR, MESH_ERROR_INPUT);
    g_error_free(error);
}

#define REFUSED(g, least, ...) expect_refused(g, least, (const char *const[]){__VA_ARGS__, NULL})

/* A sound graph, spoilt in one way after another. */
static void test_check_words(void)
{
    const Vec2 point[] = {{0, 0}, {4, 0}, {4, 4}, {2, 1}, {0, 4}, {1, 1}, {1, 2}, {3, 1}};
    const uint32_t segment[][2] = {{0, 5}, {5, 6}, {2, 7}};
    Pslg *good = graph_of(point, 8, 5, segment, 3), *g;
    g_assert_true(pslg_check(good, 0.25, NULL));
    REFUSED(good, 1.1, "apart", "at least 1.1");
#define SPOILT(change, least, ...)                                                                                                         \
    do {                                                                                                                                   \
        g = graph_of(point, 8, 5, segment, 3);                                                                                             \
        change;                                                                                                                            \
        REFUSED(g, least, __VA_ARGS__);                                                                                                    \
        pslg_free(g);                                                                                                                      \
    } while (0)
    SPOILT(g->point[6] = vec2(NAN, 1), 1e-6, "vein point 6 (nan, 1)", "finite");
    SPOILT(g->point[0] = vec2(0, -INFINITY), 1e-6, "outline point 0 (0, -inf)", "finite");
    SPOILT(g->point[0] = vec2(0, -1e60), 1e-6, "outline point 0", "1e50");
    SPOILT(g->point[6] = vec2(1, 1), 0.0, "vein point 6 (1, 1)", "vein point 5 (1, 1)", "0 apart");
    SPOILT(g->point[7] = vec2(1.25, 0.75), 0.2, "vein point 7", "crosses");
    SPOILT(g->point[6] = vec2(1, 1.125), 0.2, "vein point 6", "vein point 5 (1, 1)", "0.125 apart", "at least 0.2");
    SPOILT(g->point[6] = vec2(3.0, 2.5), 1e-6, "0 away from", "outline segment", "outline point 2 (4, 4)", "vein point 6");
    SPOILT(g->point[6] = vec2(3.5, 1.25), 1e-6, "crosses", "the vein segment from vein point 5", "outline");
    SPOILT(g->point[7] = vec2(5, 1), 1e-6, "vein point 7 (5, 1) lies outside the outline");
    SPOILT(g->point[6] = vec2(0.5, 0.5), 1e-6, "vein point 6 (0.5, 0.5)", "0 away from the vein segment");
    SPOILT(g->point[5] = vec2(-1, -1), 1e-6, "crosses");
    SPOILT((g->point[5] = vec2(-2, 1), g->point[6] = vec2(-2, 2)), 1e-6, "vein point 5 (-2, 1) lies outside");
    SPOILT(g->segment[2][0] = 6, 1e-6, "crosses the vein segment from vein point 6 (1, 2) to vein point 7");
    SPOILT((g->segment[2][0] = 2, g->segment[2][1] = 4), 1e-6, "outline point 2 (4, 4) to outline point 4 (0, 4) runs outside");
    SPOILT((g->segment[2][0] = 6, g->segment[2][1] = 5), 1e-6, "vein segment", "is there twice");
    SPOILT((g->segment[2][0] = 4, g->segment[2][1] = 0), 1e-6, "outline segment", "is there twice");
    SPOILT(g->segment[1][1] = 5, 1e-6, "vein segment 1 goes from point 5 to itself");
    SPOILT(g->segment[1][1] = 8, 1e-6, "vein segment 1", "point 8", "there are 8 points");
    SPOILT(g->n_outline = 2, 1e-6, "3 at least");
    SPOILT(g->n_outline = 9, 1e-6, "9 of the 8 points");
    SPOILT((g->point[0] = point[4], g->point[1] = point[3], g->point[2] = point[2], g->point[3] = point[1], g->point[4] = point[0],
            g->n_segments = 0),
           1e-6, "clockwise");
    const Vec2 flat[] = {{0, 0}, {1, 0}, {2, 0}}, bow[] = {{0, 0}, {2, 2}, {2, 0}, {0, 2}};
    g = graph_of(flat, 3, 3, NULL, 0);
    REFUSED(g, 1e-6, "enclose an area");
    pslg_free(g);
    g = graph_of(bow, 4, 4, NULL, 0);
    REFUSED(g, 1e-6, "crosses");
    pslg_free(g);
    g = pslg_new(0, 0, 0);
    REFUSED(g, 1e-6, "3 at least");
    pslg_free(g);
    pslg_free(good);
}

/* --- the locator --- */

static double distance_to(const Mesh *m, uint32_t t, Vec2 p)
{
    const uint32_t *c = m->triangle[t];
    Vec2 v[3] = {m->vertex[c[0]], m->vertex[c[1]], m->vertex[c[2]]};
    double least2 = HUGE_VAL;
    bool inside = true;
    for (int k = 0; k < 3; k++) {
        inside &= twice_area(v[k], v[(k + 1) % 3], p) >= 0.0;
        least2 = fmin(least2, segment_dist2(v[k], v[(k + 1) % 3], p));
    }
    return inside ? 0.0 : sqrt(least2);
}

static void check_locate(const Mesh *m, const MeshLocator *l, Vec2 p)
{
    double w[3], least = HUGE_VAL;
    uint32_t t = mesh_locate(l, p, w);
    g_assert_cmpuint(t, <, m->n_triangles);
    for (uint32_t i = 0; i < m->n_triangles; i++)
        least = fmin(least, distance_to(m, i, p));
    g_assert_cmpfloat_with_epsilon(distance_to(m, t, p), least, 1e-14);
    Vec2 q = vec2(0, 0);
    double sum = 0.0;
    for (int k = 0; k < 3; k++) {
        g_assert_cmpfloat(w[k], >=, 0.0);
        sum += w[k];
        q = vec_add(q, vec_scale(m->vertex[m->triangle[t][k]], w[k]));
    }
    g_assert_cmpfloat_with_epsilon(sum, 1.0, 1e-14);
    g_assert_cmpfloat_with_epsilon(vec_dist(p, q), least, 1e-13);
}

static void test_locate(void)
{
    for (uint32_t k = 0; k < LEAF_KINDS; k++) {
        Pslg *g = plain_leaf((int)k, 60, k, 0.1, 40.0, 0.01);
        Mesh *m = mesh_or_fail(g, &(MeshDef){.min_angle = 20.0, .max_area = 0.01});
        MeshLocator *l = mesh_locator_new(m);
        for (uint32_t i = 0; i < 1500; i++) {
            double u[2];
            random_pair(k, 9, 0, i, u);
            check_locate(m, l, vec2(4.0 * u[0] - 2.0, 5.0 * u[1] - 2.5));
        }
        for (uint32_t i = 0; i < m->n_vertices; i++)
            check_locate(m, l, m->vertex[i]);
        for (uint32_t i = 0; i < m->n_triangles; i++) {
            const uint32_t *t = m->triangle[i];
            Vec2 a = m->vertex[t[0]], b = m->vertex[t[1]], c = m->vertex[t[2]];
            double w[3];
            g_assert_cmpuint(mesh_locate(l, vec_scale(vec_add(vec_add(a, b), c), 1.0 / 3.0), w), ==, i);
            g_assert_cmpfloat_with_epsilon(w[0], 1.0 / 3.0, 1e-9);
            g_assert_cmpfloat_with_epsilon(w[1], 1.0 / 3.0, 1e-9);
            check_locate(m, l, vec_lerp(a, b, 0.5));
        }
        double w[3];
        g_assert_cmpuint(mesh_locate(l, vec2(NAN, 0), w), ==, 0);
        g_assert_cmpfloat(w[0] + w[1] + w[2], ==, 1.0);
        mesh_locate(l, vec2(1e300, -1e300), w);
        g_assert_cmpfloat(w[0] + w[1] + w[2], ==, 1.0);
        mesh_locator_free(l);
        mesh_free(m);
        pslg_free(g);
    }
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/mesh/square", test_square);
    g_test_add_func("/mesh/lattice", test_lattice);
    g_test_add_func("/mesh/leaves", test_leaves);
    g_test_add_func("/mesh/small-angles", test_small_angles);
    g_test_add_func("/mesh/wedges", test_wedges);
    g_test_add_func("/mesh/fans", test_fans);
    g_test_add_func("/mesh/large-holes", test_large_holes);
    g_test_add_func("/mesh/margin", test_at_margin);
    g_test_add_func("/mesh/outlines", test_outlines);
    g_test_add_func("/mesh/whole-numbers", test_whole_numbers);
    g_test_add_func("/mesh/far-and-small", test_far_and_small);
    g_test_add_func("/mesh/same-bytes", test_same_bytes);
    g_test_add_func("/mesh/pinned-bytes", test_pinned_bytes);
    g_test_add_func("/mesh/limits", test_limits);
    g_test_add_func("/mesh/check/twin", test_check_twin);
    g_test_add_func("/mesh/check/large", test_check_large);
    g_test_add_func("/mesh/check/words", test_check_words);
    g_test_add_func("/mesh/locate", test_locate);
    return g_test_run();
}
