#include "geom/hilbert.h"
#include "geom/mesh_gts.h"
#include "geom/random.h"

#include <string.h>

enum { ROUNDS = 32, RANDOM_MESH = 100 };

/* --- classes --- */

typedef struct {
    GtsSurface gts;
    Mesher *mesher;
} MeshSurface;

/* GTS keeps a surface's faces in a hash table by address, whose order differs from run to run, and which takes time and memory. All that we do
 * goes from vertices to edges to faces, and a face knows its surface, so the table is left empty. */
static void add_face(GtsSurface *s, GtsFace *f)
{
    Mesher *m = ((MeshSurface *)s)->mesher;
    g_hash_table_remove(s->faces, f);
    m->n_faces++;
    if (m->refining)
        mesh_queue_add(m, f);
}

static void remove_face(GtsSurface *s, GtsFace *f)
{
    Mesher *m = ((MeshSurface *)s)->mesher;
    m->n_faces--;
    mesh_queue_remove(m, f);
}

static void surface_class_init(GtsObjectClass *klass)
{
    ((GtsSurfaceClass *)klass)->add_face = add_face;
    ((GtsSurfaceClass *)klass)->remove_face = remove_face;
}

static GtsObjectClass *derive(gpointer parent, const char *name, gsize object_size, GtsObjectClassInitFunc init)
{
    const GtsObjectClass *p = parent;
    GtsObjectClassInfo info = {.object_size = (guint)object_size, .class_size = p->info.class_size, .class_init_func = init};
    g_strlcpy(info.name, name, sizeof info.name);
    return gts_object_class_new(parent, &info);
}

static struct {
    GtsObjectClass *vertex, *piece, *surface;
} classes; /* GTS keeps classes for good, by name: they are made once, under the lock of mesh.c */

static void make_classes(void)
{
    if (classes.surface)
        return;
    const GtsObjectClass *constraint = (gpointer)gts_constraint_class();
    g_assert(constraint->info.object_size <= offsetof(MeshPiece, input));
    classes.vertex = derive(gts_vertex_class(), "VenationVertex", sizeof(MeshVertex), NULL);
    classes.piece = derive(gts_constraint_class(), "VenationPiece", sizeof(MeshPiece), NULL);
    classes.surface = derive(gts_surface_class(), "VenationSurface", sizeof(MeshSurface), surface_class_init);
}

MeshVertex *mesh_vertex_new(Mesher *m, Vec2 p, uint32_t input)
{
    MeshVertex *v = (MeshVertex *)gts_vertex_new((GtsVertexClass *)m->vertex_class, p.x, p.y, 0.0);
    v->index = m->vertex->len;
    v->input = input;
    g_ptr_array_add(m->vertex, v);
    return v;
}

static MeshPiece *piece_new(Mesher *m, uint32_t input)
{
    GtsVertex *a = m->vertex->pdata[mesh_input_end(m->graph, input, 0)];
    GtsVertex *b = m->vertex->pdata[mesh_input_end(m->graph, input, 1)];
    MeshPiece *e = (MeshPiece *)gts_edge_new((GtsEdgeClass *)m->piece_class, a, b);
    e->input = input;
    return e;
}

/* --- finding the face that holds a point --- */

/* From face to face across an edge that has p on its other side, the first of them found; a coin says where to begin, as in a constrained
 * triangulation a fixed order could go round in circles. */
GtsFace *mesh_walk(Mesher *m, GtsFace *from, GtsVertex *p, MeshPiece **wall)
{
    GtsEdge *entered = NULL;
    for (;;) {
        GtsVertex *corner[3];
        GtsEdge *edge[3], *out = NULL;
        mesh_corners(from, corner, edge);
        m->coin = m->coin * 1664525u + 1013904223u;
        uint32_t start = (m->coin >> 16) % 3;
        for (uint32_t k = start; k < start + 3 && !out; k++)
            if (edge[k % 3] != entered &&
                gts_point_orientation(&corner[k % 3]->p, &corner[(k + 1) % 3]->p, &p->p) < 0.0)
                out = edge[k % 3];
        if (!out)
            return from;
        if (wall && mesh_is_piece(m, out)) {
            *wall = (MeshPiece *)out;
            return NULL;
        }
        from = mesh_neighbour(from, out);
        g_assert(from); /* only pieces bound the blade, and the hull holds all points */
        entered = out;
    }
}

/* --- the order of insertion --- */

/* Points go in in rounds of doubling size, each sorted along Hilbert's curve (biased randomised insertion order; Amenta, Choi and Rote
 * 2003): random enough to keep faces few at any vertex, orderly enough to find each face by a short walk. Long segments are put
 * in as soon as faces shrink to their length, or they would have to cut through all the small ones. */
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

static void random_rounds(const Pslg *g, uint8_t *round, uint32_t last)
{
    for (uint32_t i = 0; i < g->n_points; i++) {
        uint32_t bits = random_block(0, RANDOM_MESH, 0, i).w[0], r = last;
        for (; r > 0 && bits & 1; bits >>= 1)
            r--;
        round[i] = (uint8_t)r;
    }
}

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

static Turn *turns_new(const Pslg *g, uint32_t *last)
{
    uint8_t *round = g_malloc(g->n_points);
    Box2 box = box_empty();
    *last = 0;
    while (*last < ROUNDS - 1 && g->n_points >> *last > 1)
        ++*last;
    random_rounds(g, round, *last);
    early_rounds(g, round, *last);
    for (uint32_t i = 0; i < g->n_points; i++)
        box = box_add(box, g->point[i]);
    Hilbert curve = hilbert_over(box);
    Turn *turn = g_new(Turn, g->n_points);
    for (uint32_t i = 0; i < g->n_points; i++)
        turn[i] = (Turn){round[i], i, hilbert_place(curve, g->point[i], i)};
    g_qsort_with_data(turn, (gint)g->n_points, sizeof *turn, turn_compare, NULL);
    g_free(round);
    return turn;
}

/* --- triangulation --- */

/* A triangle well round all points. Its corners are not numbered; they go with the outside. */
static GtsFace *hull_new(Mesher *m)
{
    Box2 box = box_empty();
    for (uint32_t i = 0; i < m->graph->n_points; i++)
        box = box_add(box, m->graph->point[i]);
    Vec2 centre = vec2(0.5 * (box.x0 + box.x1), 0.5 * (box.y0 + box.y1));
    double w = box.x1 - box.x0, h = box.y1 - box.y0, r = w > h ? w : h;
    const Vec2 corner[3] = {vec2(centre.x - 20.0 * r, centre.y - 10.0 * r), vec2(centre.x + 20.0 * r, centre.y - 10.0 * r),
                            vec2(centre.x, centre.y + 20.0 * r)};
    GtsVertex *v[3];
    GtsEdge *e[3];
    for (int k = 0; k < 3; k++) {
        v[k] = gts_vertex_new((GtsVertexClass *)m->vertex_class, corner[k].x, corner[k].y, 0.0);
        ((MeshVertex *)v[k])->index = MESH_NONE;
    }
    for (int k = 0; k < 3; k++)
        e[k] = gts_edge_new(gts_edge_class(), v[k], v[(k + 1) % 3]);
    GtsFace *f = gts_face_new(gts_face_class(), e[0], e[1], e[2]);
    gts_surface_add_face(m->surface, f);
    memcpy(m->hull, v, sizeof v);
    return f;
}

static GtsFace *face_at(const GtsVertex *v)
{
    for (GSList *s = v->segments; s; s = s->next)
        if (((GtsEdge *)s->data)->triangles)
            return ((GtsEdge *)s->data)->triangles->data;
    return NULL;
}

/* Segments by the round that their later end is in. */
static uint32_t *segments_by_round(const Pslg *g, const Turn *turn, uint32_t *start)
{
    uint32_t n = g->n_outline + g->n_segments, *order = g_new(uint32_t, n);
    uint8_t *round = g_malloc(g->n_points), *when = g_malloc(n);
    for (uint32_t i = 0; i < g->n_points; i++)
        round[turn[i].point] = (uint8_t)turn[i].round;
    memset(start, 0, (ROUNDS + 1) * sizeof *start);
    for (uint32_t s = 0; s < n; s++) {
        uint8_t a = round[mesh_input_end(g, s, 0)], b = round[mesh_input_end(g, s, 1)];
        when[s] = a > b ? a : b;
        start[when[s] + 1]++;
    }
    for (uint32_t r = 0; r < ROUNDS; r++)
        start[r + 1] += start[r];
    uint32_t at[ROUNDS];
    memcpy(at, start, sizeof at);
    for (uint32_t s = 0; s < n; s++)
        order[at[when[s]]++] = s;
    g_free(round);
    g_free(when);
    return order;
}

/* Makes the face a b c, on edges that there are or new ones. */
static void add_face_of(Mesher *m, GtsVertex *a, GtsVertex *b, GtsVertex *c)
{
    GtsVertex *const v[3] = {a, b, c};
    GtsEdge *e[3];
    for (int k = 0; k < 3; k++) {
        e[k] = (GtsEdge *)gts_vertices_are_connected(v[k], v[(k + 1) % 3]);
        if (!e[k])
            e[k] = gts_edge_new(gts_edge_class(), v[k], v[(k + 1) % 3]);
    }
    gts_surface_add_face(m->surface, gts_face_new(gts_face_class(), e[0], e[1], e[2]));
}

/* The constrained Delaunay triangulation of what lies between a b and a chain of vertices to its left, from b round to a (Anglada 1997). */
static void fill(Mesher *m, GtsVertex *a, GtsVertex *b, GtsVertex **chain, uint32_t n)
{
    if (!n)
        return;
    uint32_t apex = 0;
    for (uint32_t i = 1; i < n; i++)
        if (gts_point_in_circle(&chain[i]->p, &a->p, &b->p, &chain[apex]->p) > 0.0)
            apex = i;
    add_face_of(m, a, b, chain[apex]);
    fill(m, chain[apex], b, chain, apex);
    fill(m, a, chain[apex], chain + apex + 1, n - apex - 1);
}

/* What a piece cuts through: faces, and the vertices to its left and right, from its first end on. */
typedef struct {
    GPtrArray *face, *left, *right;
} Cut;

/* The face at a whose opposite edge lies across a b; its ends to the left and right. */
static GtsFace *first_cut(GtsVertex *a, GtsVertex *b, GtsVertex **left, GtsVertex **right)
{
    for (GSList *s = a->segments; s; s = s->next)
        for (GSList *t = ((GtsEdge *)s->data)->triangles; t; t = t->next) {
            GtsVertex *corner[3];
            GtsEdge *edge[3];
            mesh_corners(t->data, corner, edge);
            int k = corner[0] == a ? 0 : corner[1] == a ? 1 : 2;
            *right = corner[(k + 1) % 3];
            *left = corner[(k + 2) % 3];
            if (gts_point_orientation(&a->p, &b->p, &(*right)->p) < 0.0 && gts_point_orientation(&a->p, &b->p, &(*left)->p) > 0.0)
                return t->data;
        }
    return NULL;
}

/* FALSE when another piece or a vertex is in the way. */
static bool find_cut(Mesher *m, GtsVertex *a, GtsVertex *b, Cut *cut)
{
    GtsVertex *left, *right;
    GtsFace *f = first_cut(a, b, &left, &right);
    if (!f)
        return false;
    g_ptr_array_add(cut->left, left);
    g_ptr_array_add(cut->right, right);
    for (;;) {
        g_ptr_array_add(cut->face, f);
        GtsEdge *crossed = (GtsEdge *)gts_vertices_are_connected(left, right);
        if (mesh_is_piece(m, crossed))
            return false;
        f = mesh_neighbour(f, crossed);
        GtsVertex *apex = mesh_opposite(f, crossed);
        double side = gts_point_orientation(&a->p, &b->p, &apex->p);
        if (apex == b)
            break;
        if (side == 0.0)
            return false;
        g_ptr_array_add(side > 0.0 ? cut->left : cut->right, apex);
        *(side > 0.0 ? &left : &right) = apex;
    }
    g_ptr_array_add(cut->face, f);
    return true;
}

static void reverse(GPtrArray *a)
{
    for (uint32_t i = 0, j = a->len - 1; i < j; i++, j--) {
        gpointer kept = a->pdata[i];
        a->pdata[i] = a->pdata[j];
        a->pdata[j] = kept;
    }
}

/* A piece that was made beforehand becomes an edge by itself if its ends come to be joined; else it is cut in. (GTS can do that, but asserts
 * that no vertex lies on the line of an edge that ends there.) New faces come before old ones go, so that edges of both stay. */
static bool put_in(Mesher *m, MeshPiece *e)
{
    if (e->gts.triangles)
        return true;
    GtsVertex *a = e->gts.segment.v1, *b = e->gts.segment.v2;
    Cut cut = {g_ptr_array_new(), g_ptr_array_new(), g_ptr_array_new()};
    bool good = find_cut(m, a, b, &cut);
    if (good) {
        reverse(cut.left);
        fill(m, a, b, (GtsVertex **)cut.left->pdata, cut.left->len);
        fill(m, b, a, (GtsVertex **)cut.right->pdata, cut.right->len);
        for (uint32_t i = 0; i < cut.face->len; i++)
            gts_surface_remove_face(m->surface, cut.face->pdata[i]);
    }
    g_ptr_array_free(cut.face, TRUE);
    g_ptr_array_free(cut.left, TRUE);
    g_ptr_array_free(cut.right, TRUE);
    return good;
}

static bool put_in_all(Mesher *m)
{
    const Pslg *g = m->graph;
    uint32_t last, start[ROUNDS + 1];
    Turn *turn = turns_new(g, &last);
    uint32_t *by_round = segments_by_round(g, turn, start);
    GtsFace *f = hull_new(m);
    bool good = true;
    for (uint32_t r = 0, i = 0; r <= last && good; r++) {
        for (; i < g->n_points && turn[i].round == r && good; i++) {
            GtsVertex *v = m->vertex->pdata[turn[i].point];
            good = !gts_delaunay_add_vertex_to_face(m->surface, v, mesh_walk(m, f, v, NULL));
            f = face_at(v);
        }
        for (uint32_t k = start[r]; k < start[r + 1] && good; k++)
            good = put_in(m, m->piece[by_round[k]]);
        if (i > 0 && good)
            f = face_at(m->vertex->pdata[turn[i - 1].point]); /* pieces may have cut through the last one */
    }
    g_free(turn);
    g_free(by_round);
    return good;
}

/* The faces that can be reached from the first outline segment's outer side without crossing a piece. */
static GPtrArray *find_outside(Mesher *m)
{
    const guint32 seen = 1u << MESH_SEEN_SHIFT;
    GPtrArray *outside = g_ptr_array_new();
    GtsEdge *e = &m->piece[0]->gts;
    for (GSList *t = e->triangles; t; t = t->next) {
        GtsVertex *apex = mesh_opposite(t->data, e);
        if (gts_point_orientation(&e->segment.v1->p, &e->segment.v2->p, &apex->p) < 0.0)
            g_ptr_array_add(outside, t->data);
    }
    for (uint32_t i = 0; i < outside->len; i++) {
        GtsFace *f = outside->pdata[i];
        GtsEdge *const edge[3] = {f->triangle.e1, f->triangle.e2, f->triangle.e3};
        f->triangle.object.flags |= seen;
        for (int k = 0; k < 3; k++) {
            GtsFace *next = mesh_is_piece(m, edge[k]) ? NULL : mesh_neighbour(f, edge[k]);
            if (next && !(next->triangle.object.flags & seen)) {
                next->triangle.object.flags |= seen;
                g_ptr_array_add(outside, next);
            }
        }
    }
    return outside;
}

/* Takes the outside away. By hand: GTS would look for each edge in the lists of the hull's corners, which may hold one for each point. */
static bool carve(Mesher *m)
{
    GPtrArray *face = find_outside(m), *edge = g_ptr_array_new();
    for (uint32_t i = 0; i < face->len; i++) {
        GtsFace *f = face->pdata[i];
        GtsEdge *const its[3] = {f->triangle.e1, f->triangle.e2, f->triangle.e3};
        for (int k = 0; k < 3; k++) {
            its[k]->triangles = g_slist_remove(its[k]->triangles, f);
            if (!its[k]->triangles)
                g_ptr_array_add(edge, its[k]);
        }
        g_slist_free(f->surfaces);
        mesh_destroy(f);
    }
    for (uint32_t i = 0; i < edge->len; i++) {
        GtsSegment *s = edge->pdata[i];
        GtsVertex *const end[2] = {s->v1, s->v2};
        for (int k = 0; k < 2; k++)
            if (((MeshVertex *)end[k])->index != MESH_NONE)
                end[k]->segments = g_slist_remove(end[k]->segments, s);
        mesh_destroy(s);
    }
    for (int k = 0; k < 3; k++) {
        g_slist_free(m->hull[k]->segments);
        mesh_destroy(m->hull[k]);
        m->hull[k] = NULL;
    }
    m->n_faces -= face->len;
    g_ptr_array_free(face, TRUE);
    g_ptr_array_free(edge, TRUE);
    return m->n_faces > 0;
}

bool mesh_triangulate(Mesher *m)
{
    make_classes();
    m->vertex_class = classes.vertex;
    m->piece_class = classes.piece;
    m->surface = gts_surface_new((GtsSurfaceClass *)classes.surface, gts_face_class(), gts_edge_class(),
                                 (GtsVertexClass *)classes.vertex);
    ((MeshSurface *)m->surface)->mesher = m;
    for (uint32_t i = 0; i < m->graph->n_points; i++)
        mesh_vertex_new(m, m->graph->point[i], MESH_NONE);
    for (uint32_t s = 0; s < m->n_pieces; s++)
        m->piece[s] = piece_new(m, s);
    return put_in_all(m) && carve(m);
}
