#include "shape/voronoi.h"

enum { NONE = UINT32_MAX };

/* Half the cotangents of an edge add up from at most two triangles. */
typedef struct {
    uint32_t to, triangles;
    double sum, noise; /* of the cotangents; bound of the sum's rounding error */
} Spoke;

/* Triangles by vertex: corner[start[i] … start[i + 1] - 1] is 3 · triangle + corner. */
typedef struct {
    uint32_t *start, *corner;
} Fans;

static Fans fans_new(const Mesh *mesh)
{
    Fans f = {g_new0(uint32_t, (gsize)mesh->n_vertices + 1), g_new(uint32_t, 3 * (gsize)mesh->n_triangles)};
    const uint32_t *at = &mesh->triangle[0][0], n = 3 * mesh->n_triangles;
    for (uint32_t c = 0; c < n; c++)
        f.start[at[c]]++;
    for (uint32_t i = 0, sum = 0; i <= mesh->n_vertices; i++)
        f.start[i] = sum += f.start[i]; /* the end of i's list */
    for (uint32_t c = n; c-- > 0;)      /* backwards, so that lists run forwards */
        f.corner[--f.start[at[c]]] = c;
    return f;
}

static void fans_clear(Fans f)
{
    g_free(f.start);
    g_free(f.corner);
}

/* Of the angle at corner k of triangle t. Seen from either end of the edge opposite, the same operations in the same order. */
static double cotangent(const Mesh *mesh, uint32_t t, uint32_t k)
{
    const uint32_t *at = mesh->triangle[t];
    Vec2 apex = mesh->vertex[at[k]];
    Vec2 a = vec_sub(mesh->vertex[at[(k + 1) % 3]], apex), b = vec_sub(mesh->vertex[at[(k + 2) % 3]], apex);
    double twice = vec_cross(a, b);
    g_assert(twice > 0.0);
    return vec_dot(a, b) / twice;
}

static uint32_t spoke_to(Spoke *spoke, uint32_t *n, uint32_t *seen, uint32_t to)
{
    if (seen[to] == NONE) {
        seen[to] = *n;
        spoke[(*n)++] = (Spoke){.to = to};
    }
    return seen[to];
}

/* Rounding changes dot and cross product by a few units of |a||b|·2^-53, hence the cotangent by a few of 1 / sin² = 1 + cot². */
static void spoke_add(Spoke *s, double cot)
{
    s->triangles++;
    s->sum += cot;
    s->noise += 1e-15 * (1.0 + cot * cot);
}

/* All spokes of vertex i. seen[n] is NONE everywhere before and after. */
static uint32_t gather(const Mesh *mesh, Fans f, uint32_t i, Spoke *spoke, uint32_t *seen)
{
    uint32_t n = 0;
    for (uint32_t p = f.start[i]; p < f.start[i + 1]; p++) {
        uint32_t t = f.corner[p] / 3, k = f.corner[p] % 3, left = (k + 1) % 3, right = (k + 2) % 3;
        spoke_add(&spoke[spoke_to(spoke, &n, seen, mesh->triangle[t][left])], cotangent(mesh, t, right));
        spoke_add(&spoke[spoke_to(spoke, &n, seen, mesh->triangle[t][right])], cotangent(mesh, t, left));
    }
    for (uint32_t s = 0; s < n; s++)
        seen[spoke[s].to] = NONE;
    return n;
}

/* A Voronoi cell is made of two right triangles, s_ij and h_ij / 2, to each neighbour. Obtuse angles at the margin can make that small or
 * negative; a cell below a tenth of the third of the triangles around it gets that third. */
static double cell_area(const Voronoi *v, const Mesh *mesh, Fans f, uint32_t i)
{
    double area = 0.0, third = 0.0;
    for (uint32_t p = v->start[i]; p < v->start[i + 1]; p++)
        area += 0.25 * v->weight[p] * vec_dist2(mesh->vertex[i], mesh->vertex[v->neighbour[p]]);
    for (uint32_t p = f.start[i]; p < f.start[i + 1]; p++) {
        const uint32_t *at = mesh->triangle[f.corner[p] / 3];
        Vec2 a = mesh->vertex[at[0]];
        third += vec_cross(vec_sub(mesh->vertex[at[1]], a), vec_sub(mesh->vertex[at[2]], a)) / 6.0;
    }
    return area > 0.1 * third ? area : third;
}

static uint32_t widest_fan(const Mesh *mesh, Fans f)
{
    uint32_t most = 0;
    for (uint32_t i = 0; i < mesh->n_vertices; i++)
        most = MAX(most, f.start[i + 1] - f.start[i]);
    return most;
}

Voronoi *voronoi_new(const Mesh *mesh)
{
    uint32_t n = mesh->n_vertices;
    g_assert(mesh->n_triangles < UINT32_MAX / 6);
    gsize room = 6 * (gsize)mesh->n_triangles; /* twice what a mesh can need; given back below */
    Voronoi *v = g_new(Voronoi, 1);
    *v = (Voronoi){.n = n,
                   .start = g_new(uint32_t, (gsize)n + 1),
                   .neighbour = g_new(uint32_t, room),
                   .weight = g_new(double, room),
                   .area = g_new(double, n),
                   .margin = g_new0(bool, n)};
    Fans f = fans_new(mesh);
    Spoke *spoke = g_new(Spoke, 2 * (gsize)widest_fan(mesh, f));
    uint32_t *seen = g_new(uint32_t, n), end = 0;
    for (uint32_t i = 0; i < n; i++)
        seen[i] = NONE;
    for (uint32_t i = 0; i < n; i++) {
        v->start[i] = end;
        uint32_t spokes = gather(mesh, f, i, spoke, seen);
        for (uint32_t s = 0; s < spokes; s++) {
            g_assert(spoke[s].triangles <= 2);
            v->margin[i] |= spoke[s].triangles == 1;
            if (fabs(spoke[s].sum) <= spoke[s].noise)
                continue;
            v->neighbour[end] = spoke[s].to;
            v->weight[end++] = 0.5 * spoke[s].sum;
        }
    }
    v->start[n] = end;
    v->neighbour = g_renew(uint32_t, v->neighbour, end);
    v->weight = g_renew(double, v->weight, end);
    for (uint32_t i = 0; i < n; i++)
        v->area[i] = cell_area(v, mesh, f, i);
    g_free(seen);
    g_free(spoke);
    fans_clear(f);
    return v;
}

void voronoi_free(Voronoi *v)
{
    if (!v)
        return;
    g_free(v->start);
    g_free(v->neighbour);
    g_free(v->weight);
    g_free(v->area);
    g_free(v->margin);
    g_free(v);
}
