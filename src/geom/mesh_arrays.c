#include "geom/hilbert.h"
#include "geom/mesh_gts.h"
#include "geom/random.h"

#include <string.h>

/* --- the order of insertion --- */

typedef struct {
    uint32_t round, point;
    uint64_t place; /* on the curve, ties broken */
} Turn;

static int turn_compare(gconstpointer a, gconstpointer b, gpointer unused)
{
    const Turn *s = a, *t = b;
    if (s->round != t->round)
        return s->round < t->round ? -1 : 1;
    return (s->place > t->place) - (s->place < t->place);
}

static double input_length(const Pslg *g, uint32_t input)
{
    return vec_dist(g->point[mesh_input_end(g, input, 0)], g->point[mesh_input_end(g, input, 1)]);
}

/* Half of the points in the last round, a quarter in the one before, … */
static void random_rounds(const Pslg *g, uint8_t *round, uint32_t last)
{
    for (uint32_t i = 0; i < g->n_points; i++) {
        uint32_t bits = random_block(0, RANDOM_MESH, 0, i).w[0], r = last;
        for (; r > 0 && bits & 1; bits >>= 1)
            r--;
        round[i] = (uint8_t)r;
    }
}

/* Long segments go in as soon as faces shrink to their length, or they would have to cut through all the small ones. */
static void early_rounds(const Pslg *g, uint8_t *round, uint32_t last)
{
    double total = 0.0;
    for (uint32_t s = 0; s < g->n_outline + g->n_segments; s++)
        total += input_length(g, s);
    for (uint32_t s = 0; s < g->n_outline + g->n_segments; s++) {
        double length = input_length(g, s), spacing = total;
        uint32_t r = 1;
        for (; r < last && spacing > length; r++)
            spacing *= 0.5;
        for (int k = 0; k < 2; k++) {
            uint8_t *its = &round[mesh_input_end(g, s, k)];
            *its = r < *its ? (uint8_t)r : *its;
        }
    }
}

static void sort_points(MeshOrder *o, const Pslg *g, const uint8_t *round)
{
    Box2 box = box_empty();
    for (uint32_t i = 0; i < g->n_points; i++)
        box = box_add(box, g->point[i]);
    Hilbert curve = hilbert_over(box);
    Turn *turn = g_new(Turn, g->n_points);
    for (uint32_t i = 0; i < g->n_points; i++)
        turn[i] = (Turn){round[i], i, hilbert_place(curve, g->point[i], i)};
    g_qsort_with_data(turn, (gint)g->n_points, sizeof *turn, turn_compare, NULL);
    o->point = g_new(uint32_t, g->n_points);
    for (uint32_t i = 0; i < g->n_points; i++) {
        o->point[i] = turn[i].point;
        o->point_start[turn[i].round + 1]++;
    }
    for (uint32_t r = 0; r < o->n_rounds; r++)
        o->point_start[r + 1] += o->point_start[r];
    g_free(turn);
}

/* By the round that their later end is in. */
static void sort_segments(MeshOrder *o, const Pslg *g, const uint8_t *round)
{
    uint32_t n = g->n_outline + g->n_segments, at[MESH_ROUNDS];
    uint8_t *when = g_malloc(n);
    for (uint32_t s = 0; s < n; s++) {
        uint8_t a = round[mesh_input_end(g, s, 0)], b = round[mesh_input_end(g, s, 1)];
        when[s] = a > b ? a : b;
        o->segment_start[when[s] + 1]++;
    }
    for (uint32_t r = 0; r < o->n_rounds; r++)
        o->segment_start[r + 1] += o->segment_start[r];
    memcpy(at, o->segment_start, sizeof at);
    o->segment = g_new(uint32_t, n);
    for (uint32_t s = 0; s < n; s++)
        o->segment[at[when[s]]++] = s;
    g_free(when);
}

void mesh_order_init(MeshOrder *o, const Pslg *g)
{
    *o = (MeshOrder){.n_rounds = 1};
    while (o->n_rounds < MESH_ROUNDS && g->n_points >> o->n_rounds)
        o->n_rounds++;
    uint8_t *round = g_malloc(g->n_points);
    random_rounds(g, round, o->n_rounds - 1);
    early_rounds(g, round, o->n_rounds - 1);
    sort_points(o, g, round);
    sort_segments(o, g, round);
    g_free(round);
}

void mesh_order_clear(MeshOrder *o)
{
    g_free(o->point);
    g_free(o->segment);
}

/* --- out of GTS --- */

static uint32_t index_of(const GtsVertex *v) { return ((const MeshVertex *)v)->index; }

static void copy_face(const GtsTriangle *f, uint32_t triangle[3])
{
    GtsVertex *corner[3];
    GtsEdge *edge[3];
    mesh_corners(f, corner, edge);
    for (int k = 0; k < 3; k++)
        triangle[k] = index_of(corner[k]);
}

/* Faces by the edge that they list first, edges by their first vertex: each once. */
static void copy_at(const Mesher *m, Mesh *mesh, const GtsVertex *v, GArray *pieces)
{
    for (GSList *s = v->segments; s; s = s->next) {
        const GtsEdge *e = s->data;
        if (e->segment.v1 != v)
            continue;
        if (mesh_is_piece(m, e)) {
            uint32_t input = ((const MeshPiece *)e)->input;
            Vec2 start = m->graph->point[mesh_input_end(m->graph, input, 0)];
            MeshPart p = {input, {index_of(v), index_of(e->segment.v2)}, vec_dist2(start, mesh_place(v))};
            g_array_append_val(pieces, p);
        }
        for (GSList *t = e->triangles; t; t = t->next)
            if (((GtsTriangle *)t->data)->e1 == e)
                copy_face(t->data, mesh->triangle[mesh->n_triangles++]);
    }
}

Mesh *mesh_copy(const Mesher *m, GArray *pieces)
{
    Mesh *mesh = g_new0(Mesh, 1);
    mesh->n_vertices = m->vertex->len;
    mesh->vertex = g_new(Vec2, mesh->n_vertices);
    mesh->triangle = g_malloc_n(m->n_faces, sizeof *mesh->triangle);
    for (uint32_t i = 0; i < mesh->n_vertices; i++) {
        mesh->vertex[i] = mesh_place(m->vertex->pdata[i]);
        copy_at(m, mesh, m->vertex->pdata[i], pieces);
    }
    g_assert(mesh->n_triangles == m->n_faces);
    return mesh;
}

/* GTS's own way would unlink each object from all others first. Here an edge is met twice, at its ends, and a face three times, at the
 * first visits of its edges: the last time it goes. */
static void visit_face(GtsTriangle *f)
{
    guint32 *flags = &f->object.flags, visits = *flags >> MESH_VISITS_SHIFT;
    if (visits < 2) {
        *flags += 1u << MESH_VISITS_SHIFT;
        return;
    }
    mesh_destroy(f);
}

static void visit_edge(GtsEdge *e)
{
    guint32 *flags = &e->segment.object.flags;
    if (*flags >> MESH_VISITS_SHIFT) {
        mesh_destroy(e);
        return;
    }
    *flags += 1u << MESH_VISITS_SHIFT;
    for (GSList *t = e->triangles; t; t = t->next)
        visit_face(t->data);
    g_slist_free(e->triangles);
}

void mesh_free_gts(Mesher *m)
{
    for (int k = 0; k < 3; k++)
        if (m->hull[k])
            g_ptr_array_add(m->vertex, m->hull[k]);
    for (uint32_t i = 0; i < m->vertex->len; i++) {
        GtsVertex *v = m->vertex->pdata[i];
        for (GSList *s = v->segments; s; s = s->next)
            visit_edge(s->data);
        g_slist_free(v->segments);
        mesh_destroy(v);
    }
}

/* --- in order: vertices and triangles along Hilbert's curve, as near in the plane is then near in memory --- */

/* Points of the graph stay. Returns the new number of each vertex. */
static uint32_t *sort_vertices(Mesh *mesh, uint32_t n_points, Hilbert curve)
{
    uint32_t n = mesh->n_vertices;
    uint64_t *place = g_new(uint64_t, n);
    uint32_t *number = g_new(uint32_t, n);
    Vec2 *sorted = g_new(Vec2, n);
    for (uint32_t i = 0; i < n; i++)
        place[i] = hilbert_place(curve, mesh->vertex[i], i);
    g_qsort_with_data(place + n_points, (gint)(n - n_points), sizeof *place, hilbert_compare, NULL);
    for (uint32_t i = 0; i < n; i++) {
        number[(uint32_t)place[i]] = i;
        sorted[i] = mesh->vertex[(uint32_t)place[i]];
    }
    g_free(place);
    g_free(mesh->vertex);
    mesh->vertex = sorted;
    return number;
}

/* Each from the corner of the smallest number. */
static void sort_triangles(Mesh *mesh, const uint32_t *number, Hilbert curve)
{
    uint32_t n = mesh->n_triangles, (*sorted)[3] = g_malloc_n(n, sizeof *sorted);
    uint64_t *place = g_new(uint64_t, n);
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t c[3] = {number[mesh->triangle[i][0]], number[mesh->triangle[i][1]], number[mesh->triangle[i][2]]};
        uint32_t first = c[1] < c[0] ? 1 : 0;
        first = c[2] < c[first] ? 2 : first;
        Vec2 sum = vec2(0.0, 0.0);
        for (uint32_t k = 0; k < 3; k++) {
            mesh->triangle[i][k] = c[(first + k) % 3];
            sum = vec_add(sum, mesh->vertex[mesh->triangle[i][k]]);
        }
        place[i] = hilbert_place(curve, vec_scale(sum, 1.0 / 3.0), i);
    }
    g_qsort_with_data(place, (gint)n, sizeof *place, hilbert_compare, NULL);
    for (uint32_t i = 0; i < n; i++)
        memcpy(sorted[i], mesh->triangle[(uint32_t)place[i]], sizeof *sorted);
    g_free(place);
    g_free(mesh->triangle);
    mesh->triangle = sorted;
}

static int part_compare(gconstpointer a, gconstpointer b, gpointer unused)
{
    const MeshPart *p = a, *q = b;
    if (p->input != q->input)
        return p->input < q->input ? -1 : 1;
    return (p->along2 > q->along2) - (p->along2 < q->along2);
}

static void sort_pieces(Mesh *mesh, const uint32_t *number, const Pslg *g, GArray *pieces)
{
    g_array_sort_with_data(pieces, part_compare, NULL);
    const MeshPart *part = (const MeshPart *)pieces->data;
    while (mesh->n_boundary < pieces->len && part[mesh->n_boundary].input < g->n_outline)
        mesh->n_boundary++;
    mesh->n_vein = pieces->len - mesh->n_boundary;
    mesh->boundary = g_malloc_n(mesh->n_boundary, sizeof *mesh->boundary);
    mesh->boundary_input = g_new(uint32_t, mesh->n_boundary);
    mesh->vein = g_malloc_n(mesh->n_vein, sizeof *mesh->vein);
    mesh->vein_input = g_new(uint32_t, mesh->n_vein);
    for (uint32_t i = 0; i < pieces->len; i++) {
        bool vein = i >= mesh->n_boundary;
        uint32_t k = vein ? i - mesh->n_boundary : i, *edge = vein ? mesh->vein[k] : mesh->boundary[k];
        edge[0] = number[part[i].edge[0]];
        edge[1] = number[part[i].edge[1]];
        (vein ? mesh->vein_input : mesh->boundary_input)[k] = vein ? part[i].input - g->n_outline : part[i].input;
    }
}

void mesh_arrange(Mesh *mesh, const Pslg *g, GArray *pieces)
{
    Box2 box = box_empty();
    for (uint32_t i = 0; i < mesh->n_vertices; i++)
        box = box_add(box, mesh->vertex[i]);
    Hilbert curve = hilbert_over(box);
    uint32_t *number = sort_vertices(mesh, g->n_points, curve);
    sort_triangles(mesh, number, curve);
    sort_pieces(mesh, number, g, pieces);
    g_free(number);
}
