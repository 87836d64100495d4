/* Triangles in space: their normals, and tubes as closed surfaces. */
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

/* ---- tubes ---- */

static uint32_t tube_sides(const Tube *t, const SolidDef *def) { return t->sides ? MIN(t->sides, 64) : def->sides; }

/* Rings of a round end, between the outermost full ring and the pole; none where nobody sees it. */
static uint32_t tip_rings(const Tube *t, const SolidDef *def) { return tube_sides(t, def) / 5; }

static uint32_t base_rings(const Tube *t, const SolidDef *def) { return t->inside ? 0 : tip_rings(t, def); }

static uint32_t tube_vertices(const Tube *t, const SolidDef *def)
{
    return (t->n + base_rings(t, def) + tip_rings(t, def)) * tube_sides(t, def) + 2;
}

/* A closed surface of Euler characteristic 2: triangles = 2 (vertices − 2). */
uint32_t solid_tube_triangles(const Tube *t, const SolidDef *def) { return 2 * (tube_vertices(t, def) - 2); }

static Vec3 tangent_at(const Tube *t, uint32_t i, Vec3 otherwise)
{
    Vec3 none = vec3(0.0, 0.0, 0.0);
    Vec3 before = i > 0 ? vec3_unit(vec3_sub(t->centre[i], t->centre[i - 1]), none) : none;
    Vec3 after = i + 1 < t->n ? vec3_unit(vec3_sub(t->centre[i + 1], t->centre[i]), none) : none;
    Vec3 sum = vec3_add(before, after);
    return vec3_dot(sum, sum) > 1e-12 ? vec3_unit(sum, otherwise) : otherwise; /* right about: as it came */
}

static Vec3 perpendicular(Vec3 a, Vec3 tangent)
{
    Vec3 axis = fabs(tangent.x) < 0.6 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0);
    Vec3 flat = vec3_sub(a, vec3_scale(tangent, vec3_dot(a, tangent)));
    if (vec3_dot(flat, flat) > 1e-12)
        return vec3_unit(flat, axis);
    return vec3_unit(vec3_cross(tangent, axis), axis);
}

static Vec3 reflect(Vec3 a, Vec3 mirror, double square) { return vec3_sub(a, vec3_scale(mirror, 2.0 * vec3_dot(a, mirror) / square)); }

/* Carries the frame's `up` on without twist: two reflections (Wang, Jüttler, Zheng and Liu 2008, Computation of rotation minimizing frames). */
static Vec3 carry_up(Vec3 up, Vec3 from, Vec3 to, Vec3 t0, Vec3 t1)
{
    Vec3 step = vec3_sub(to, from);
    double square = vec3_dot(step, step);
    if (square > 0.0) {
        up = reflect(up, step, square);
        t0 = reflect(t0, step, square);
    }
    Vec3 rest = vec3_sub(t1, t0);
    square = vec3_dot(rest, rest);
    return perpendicular(square > 0.0 ? reflect(up, rest, square) : up, t1);
}

/* Writes vertices and triangles; `circle` holds cosine and sine of each side. */
typedef struct {
    Surface *s;
    Vec2 circle[64];
    uint32_t sides, n_vertices, n_triangles;
} Writer;

static void put_triangle(Writer *w, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *t = w->s->triangle[w->n_triangles++];
    t[0] = a;
    t[1] = b;
    t[2] = c;
}

static void add_vertex(Writer *w, Vec3 place, Vec2 uv)
{
    w->s->place[w->n_vertices] = place;
    w->s->uv[w->n_vertices++] = uv;
}

/* The ring, and its triangles to the one before, or to the pole before. */
static void add_ring(Writer *w, Vec3 centre, Vec3 u, Vec3 tangent, double radius, Vec2 uv, bool after_pole)
{
    Vec3 v = vec3_cross(tangent, u);
    uint32_t first = w->n_vertices, before = first - (after_pole ? 1 : w->sides);
    for (uint32_t j = 0; j < w->sides; j++) {
        Vec3 out = vec3_add(vec3_scale(u, w->circle[j].x), vec3_scale(v, w->circle[j].y));
        uint32_t k = j + 1 < w->sides ? j + 1 : 0;
        add_vertex(w, vec3_add(centre, vec3_scale(out, radius)), uv);
        if (after_pole) {
            put_triangle(w, before, first + k, first + j);
        } else {
            put_triangle(w, before + j, before + k, first + j);
            put_triangle(w, before + k, first + k, first + j);
        }
    }
}

static void add_tube(Writer *w, const Tube *t, const SolidDef *def)
{
    uint32_t ends = base_rings(t, def), last = t->n - 1;
    Vec3 tangent = tangent_at(t, 0, vec3(0.0, 1.0, 0.0)), up = perpendicular(t->up, tangent);
    add_vertex(w, vec3_sub(t->centre[0], vec3_scale(tangent, t->radius[0])), t->rest[0]);
    for (uint32_t k = ends; k >= 1; k--) {
        double s, c;
        dtrig_sin_cos(0.5 * DTRIG_PI * k / (ends + 1), &s, &c);
        add_ring(w, vec3_sub(t->centre[0], vec3_scale(tangent, s * t->radius[0])), up, tangent, c * t->radius[0], t->rest[0], k == ends);
    }
    add_ring(w, t->centre[0], up, tangent, t->radius[0], t->rest[0], ends == 0);
    ends = tip_rings(t, def);
    for (uint32_t i = 1; i < t->n; i++) {
        Vec3 next = tangent_at(t, i, tangent);
        up = carry_up(up, t->centre[i - 1], t->centre[i], tangent, next);
        tangent = next;
        add_ring(w, t->centre[i], up, tangent, t->radius[i], t->rest[i], false);
    }
    for (uint32_t k = 1; k <= ends; k++) {
        double s, c;
        dtrig_sin_cos(0.5 * DTRIG_PI * k / (ends + 1), &s, &c);
        add_ring(w, vec3_add(t->centre[last], vec3_scale(tangent, s * t->radius[last])), up, tangent, c * t->radius[last], t->rest[last], false);
    }
    add_vertex(w, vec3_add(t->centre[last], vec3_scale(tangent, t->radius[last])), t->rest[last]);
    uint32_t pole = w->n_vertices - 1, ring = pole - w->sides;
    for (uint32_t j = 0; j < w->sides; j++)
        put_triangle(w, pole, ring + j, ring + (j + 1 < w->sides ? j + 1 : 0));
}

Surface *solid_surface(const Tube *t, uint32_t n_tubes, const SolidDef *def)
{
    g_assert(def->sides >= 3 && def->sides <= 64);
    uint32_t vertices = 0;
    for (uint32_t i = 0; i < n_tubes; i++)
        vertices += tube_vertices(&t[i], def);
    Writer w = {.s = surface_new(vertices, 2 * (vertices - 2 * n_tubes))};
    for (uint32_t i = 0; i < n_tubes; i++) {
        w.sides = tube_sides(&t[i], def);
        for (uint32_t j = 0; j < w.sides; j++)
            dtrig_sin_cos(2.0 * DTRIG_PI * j / w.sides, &w.circle[j].y, &w.circle[j].x);
        add_tube(&w, &t[i], def);
    }
    g_assert(w.n_vertices == vertices && w.n_triangles == w.s->n_triangles);
    surface_normals(w.s);
    return w.s;
}

void solid_vertex_nodes(const Tube *t, uint32_t n_tubes, const SolidDef *def, uint32_t *node)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < n_tubes; i++) {
        uint32_t sides = tube_sides(&t[i], def);
        for (uint32_t k = 0; k < 1 + base_rings(&t[i], def) * sides; k++)
            node[n++] = t[i].node[0];
        for (uint32_t k = 0; k < t[i].n * sides; k++)
            node[n++] = t[i].node[k / sides];
        for (uint32_t k = 0; k < 1 + tip_rings(&t[i], def) * sides; k++)
            node[n++] = t[i].node[t[i].n - 1];
    }
}
