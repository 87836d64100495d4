#include "geom/dtrig.h"
#include "shape/solid.h"

Surface *surface_new(uint32_t n_vertices, uint32_t n_triangles)
{
    Surface *s = g_new0(Surface, 1);
    s->n_vertices = n_vertices;
    s->n_triangles = n_triangles;
    s->place = g_new0(Vec3, n_vertices);
    s->normal = g_new0(Vec3, n_vertices);
    s->uv = g_new0(Vec2, n_vertices);
    s->triangle = g_malloc0_n(n_triangles, sizeof *s->triangle);
    return s;
}

void surface_free(Surface *s)
{
    if (!s)
        return;
    g_free(s->place);
    g_free(s->normal);
    g_free(s->uv);
    g_free(s->triangle);
    g_free(s);
}

/* Adds the triangle's unit normal to those of its vertices, times its angle there. */
static void add_triangle(Surface *s, const uint32_t v[3])
{
    Vec3 a = s->place[v[0]], b = s->place[v[1]], c = s->place[v[2]];
    Vec3 ab = vec3_sub(b, a), ac = vec3_sub(c, a), bc = vec3_sub(c, b), area = vec3_cross(ab, ac);
    double twice = vec3_norm(area);
    if (!(twice > 0.0))
        return; /* a line or a point faces nowhere */
    double at_a = dtrig_atan2(twice, vec3_dot(ab, ac)), at_b = dtrig_atan2(twice, -vec3_dot(ab, bc));
    double angle[3] = {at_a, at_b, DTRIG_PI - at_a - at_b};
    for (int k = 0; k < 3; k++)
        s->normal[v[k]] = vec3_add(s->normal[v[k]], vec3_scale(area, angle[k] / twice));
}

void surface_normals(Surface *s)
{
    for (uint32_t v = 0; v < s->n_vertices; v++)
        s->normal[v] = vec3(0.0, 0.0, 0.0);
    for (uint32_t t = 0; t < s->n_triangles; t++)
        add_triangle(s, s->triangle[t]);
    for (uint32_t v = 0; v < s->n_vertices; v++)
        s->normal[v] = vec3_unit(s->normal[v], vec3(0.0, 0.0, 1.0));
}
