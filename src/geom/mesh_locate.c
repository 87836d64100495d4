#include "geom/mesh.h"
#include "geom/segment.h"

enum { LEAF = 4 };

/* A tree of boxes over the triangles as they stand, which is along Hilbert's curve in a mesh of mesh_new: node k has the children 2k and
 * 2k + 1, the last n_leaves nodes hold LEAF triangles each. */
struct MeshLocator {
    const Mesh *mesh;
    uint32_t n_leaves;
    Box2 *node; /* [2 n_leaves], from 1 */
};

MeshLocator *mesh_locator_new(const Mesh *m)
{
    MeshLocator *l = g_new(MeshLocator, 1);
    *l = (MeshLocator){.mesh = m, .n_leaves = 1};
    while (l->n_leaves < (m->n_triangles + LEAF - 1) / LEAF)
        l->n_leaves *= 2;
    l->node = g_new(Box2, 2 * (gsize)l->n_leaves);
    for (uint32_t k = 1; k < 2 * l->n_leaves; k++)
        l->node[k] = box_empty();
    for (uint32_t i = 0; i < m->n_triangles; i++)
        for (int k = 0; k < 3; k++) {
            Box2 *leaf = &l->node[l->n_leaves + i / LEAF];
            *leaf = box_add(*leaf, m->vertex[m->triangle[i][k]]);
        }
    for (uint32_t k = l->n_leaves; k-- > 1;)
        l->node[k] = box_union(l->node[2 * k], l->node[2 * k + 1]);
    return l;
}

void mesh_locator_free(MeshLocator *l)
{
    if (!l)
        return;
    g_free(l->node);
    g_free(l);
}

/* Squared distance of p from the triangle, and the weights of the point of it that is nearest. */
static double measure(const Vec2 v[3], Vec2 p, double weight[3])
{
    double part[3], sum = 0.0;
    bool within = true;
    for (int k = 0; k < 3; k++) {
        part[k] = vec_cross(vec_sub(v[(k + 1) % 3], p), vec_sub(v[(k + 2) % 3], p));
        within = within && part[k] >= 0.0;
        sum += part[k];
    }
    if (within && sum > 0.0) {
        for (int k = 0; k < 3; k++)
            weight[k] = part[k] / sum;
        return 0.0;
    }
    double least = HUGE_VAL;
    weight[0] = 1.0;
    weight[1] = weight[2] = 0.0;
    for (int k = 0; k < 3; k++) {
        Vec2 a = v[k], b = v[(k + 1) % 3];
        double t = segment_nearest(a, b, p), d2 = segment_dist2(a, b, p);
        if (d2 < least) {
            least = d2;
            weight[k] = 1.0 - t;
            weight[(k + 1) % 3] = t;
            weight[(k + 2) % 3] = 0.0;
        }
    }
    return least;
}

/* Keeps the nearest triangle of a leaf, of equals the first. */
static void search_leaf(const MeshLocator *l, uint32_t leaf, Vec2 p, uint32_t *best, double *best2, double weight[3])
{
    const Mesh *m = l->mesh;
    for (uint32_t i = leaf * LEAF; i < leaf * LEAF + LEAF && i < m->n_triangles; i++) {
        const uint32_t *t = m->triangle[i];
        const Vec2 v[3] = {m->vertex[t[0]], m->vertex[t[1]], m->vertex[t[2]]};
        double w[3], d2 = measure(v, p, w);
        if (d2 < *best2 || (d2 == *best2 && i < *best)) {
            *best2 = d2;
            *best = i;
            for (int k = 0; k < 3; k++)
                weight[k] = w[k];
        }
    }
}

uint32_t mesh_locate(const MeshLocator *l, Vec2 p, double weight[3])
{
    uint32_t best = 0, stack[64], depth = 0;
    double best2 = HUGE_VAL;
    weight[0] = 1.0;
    weight[1] = weight[2] = 0.0;
    if (!(isfinite(p.x) && isfinite(p.y)))
        return 0;
    stack[depth++] = 1;
    while (depth) {
        uint32_t k = stack[--depth];
        if (box_dist2(l->node[k], p) > best2)
            continue;
        if (k >= l->n_leaves) {
            search_leaf(l, k - l->n_leaves, p, &best, &best2, weight);
            continue;
        }
        bool left_first = box_dist2(l->node[2 * k], p) <= box_dist2(l->node[2 * k + 1], p);
        stack[depth++] = left_first ? 2 * k + 1 : 2 * k;
        stack[depth++] = left_first ? 2 * k : 2 * k + 1;
    }
    return best;
}
