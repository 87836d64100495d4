#include "geom/mesh_gts.h"

#include <string.h>

MeshVertex *mesh_vertex_new(Mesher *m, Vec2 p, uint32_t input)
{
    MeshVertex *v = (MeshVertex *)gts_vertex_new((GtsVertexClass *)m->vertex_class, p.x, p.y, 0.0);
    v->index = m->vertex->len;
    v->input = input;
    g_ptr_array_add(m->vertex, v);
    return v;
}

/* --- finding the face that holds a point --- */

/* From face to face across an edge that has p on its other side, the first of them found; a coin says where to begin, as in a constrained
 * triangulation a fixed order could go round in circles. */
GtsTriangle *mesh_walk(Mesher *m, GtsTriangle *from, GtsVertex *p, MeshPiece **wall)
{
    const GtsEdge *entered = NULL;
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

/* --- making and removing faces --- */

void mesh_add_face(Mesher *m, GtsEdge *e1, GtsEdge *e2, GtsEdge *e3)
{
    GtsTriangle *f = gts_triangle_new(gts_triangle_class(), e1, e2, e3);
    m->n_faces++;
    if (m->refining)
        mesh_queue_add(m, f);
}

/* Takes the marked edges out of a vertex's list. */
static void unlink_marked(GtsVertex *v)
{
    GSList **at = &v->segments;
    while (*at) {
        GSList *s = *at;
        if (((GtsObject *)s->data)->flags & MESH_MARK) {
            *at = s->next;
            g_slist_free_1(s);
        } else {
            at = &s->next;
        }
    }
}

static void remove_edges(Mesher *m)
{
    g_ptr_array_set_size(m->touched, 0);
    for (uint32_t i = 0; i < m->dead->len; i++) {
        const GtsSegment *s = m->dead->pdata[i];
        GtsVertex *const end[2] = {s->v1, s->v2};
        for (int k = 0; k < 2; k++)
            if (!(end[k]->p.object.flags & MESH_MARK)) {
                end[k]->p.object.flags |= MESH_MARK;
                g_ptr_array_add(m->touched, end[k]);
            }
    }
    for (uint32_t i = 0; i < m->touched->len; i++) {
        unlink_marked(m->touched->pdata[i]);
        ((GtsObject *)m->touched->pdata[i])->flags &= ~(guint32)MESH_MARK;
    }
    for (uint32_t i = 0; i < m->dead->len; i++)
        mesh_destroy(m->dead->pdata[i]);
}

/* By hand: GTS would look through the lists of both ends for each edge that goes, and a vertex may have as many as there are faces. Here
 * each list is gone through once. */
void mesh_remove_faces(Mesher *m, const GPtrArray *face)
{
    g_ptr_array_set_size(m->dead, 0);
    for (uint32_t i = 0; i < face->len; i++) {
        GtsTriangle *f = face->pdata[i];
        GtsEdge *const edge[3] = {f->e1, f->e2, f->e3};
        mesh_queue_remove(m, f);
        for (int k = 0; k < 3; k++) {
            edge[k]->triangles = g_slist_remove(edge[k]->triangles, f);
            if (edge[k]->triangles)
                continue;
            edge[k]->segment.object.flags |= MESH_MARK;
            g_ptr_array_add(m->dead, edge[k]);
        }
        mesh_destroy(f);
    }
    m->n_faces -= face->len;
    remove_edges(m);
}

/* --- insertion (Bowyer and Watson 1981) --- */

static void add_to_cavity(Mesher *m, GtsTriangle *f)
{
    f->object.flags |= MESH_MARK;
    g_ptr_array_add(m->cavity, f);
}

/* Faces whose circumcircle holds p, as far as pieces let it see. */
void mesh_find_cavity(Mesher *m, GtsTriangle *at, const MeshPiece *on, GtsVertex *p)
{
    g_ptr_array_set_size(m->cavity, 0);
    if (at)
        add_to_cavity(m, at);
    for (GSList *t = on ? on->gts.triangles : NULL; t; t = t->next)
        add_to_cavity(m, t->data);
    for (uint32_t i = 0; i < m->cavity->len; i++) {
        GtsTriangle *f = m->cavity->pdata[i];
        GtsVertex *corner[3];
        GtsEdge *edge[3];
        mesh_corners(f, corner, edge);
        for (int k = 0; k < 3; k++) {
            GtsTriangle *next = mesh_is_piece(m, edge[k]) ? NULL : mesh_neighbour(f, edge[k]);
            if (next && !(next->object.flags & MESH_MARK) &&
                gts_point_in_circle(&p->p, &corner[(k + 1) % 3]->p, &corner[k]->p, &mesh_opposite(next, edge[k])->p) > 0.0)
                add_to_cavity(m, next);
        }
    }
    for (uint32_t i = 0; i < m->cavity->len; i++)
        ((GtsTriangle *)m->cavity->pdata[i])->object.flags &= ~(guint32)MESH_MARK;
}

/* The edge from v to w, which w keeps in its spare field meanwhile. */
static GtsEdge *spoke(GtsVertex *v, GtsVertex *w)
{
    if (!w->p.object.reserved)
        w->p.object.reserved = gts_edge_new(gts_edge_class(), v, w);
    return w->p.object.reserved;
}

/* Joins v to every edge round the cavity but the piece that it splits. Pieces that v has already are taken for spokes. */
void mesh_fill_cavity(Mesher *m, GtsVertex *v, const MeshPiece *on)
{
    for (uint32_t i = 0; i < m->cavity->len; i++)
        ((GtsTriangle *)m->cavity->pdata[i])->object.flags |= MESH_MARK;
    for (GSList *s = v->segments; s; s = s->next)
        mesh_other_end(s->data, v)->p.object.reserved = s->data;
    for (uint32_t i = 0; i < m->cavity->len; i++) {
        GtsTriangle *f = m->cavity->pdata[i];
        GtsVertex *corner[3];
        GtsEdge *edge[3];
        mesh_corners(f, corner, edge);
        for (int k = 0; k < 3; k++) {
            const GtsTriangle *next = mesh_neighbour(f, edge[k]);
            if ((on && edge[k] == &on->gts) || (next && next->object.flags & MESH_MARK))
                continue;
            GtsEdge *out = spoke(v, corner[(k + 1) % 3]), *back = spoke(v, corner[k]);
            mesh_add_face(m, edge[k], out, back);
        }
    }
    for (GSList *s = v->segments; s; s = s->next)
        mesh_other_end(s->data, v)->p.object.reserved = NULL;
    mesh_remove_faces(m, m->cavity);
}

/* --- all points and segments --- */

static MeshPiece *piece_new(Mesher *m, uint32_t input)
{
    GtsVertex *a = m->vertex->pdata[mesh_input_end(m->graph, input, 0)];
    GtsVertex *b = m->vertex->pdata[mesh_input_end(m->graph, input, 1)];
    MeshPiece *e = (MeshPiece *)gts_edge_new((GtsEdgeClass *)m->piece_class, a, b);
    e->input = input;
    return e;
}

/* A triangle well round all points. Its corners are not numbered; they go with the outside. */
static GtsTriangle *hull_new(Mesher *m)
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
    mesh_add_face(m, e[0], e[1], e[2]);
    memcpy(m->hull, v, sizeof v);
    return e[0]->triangles->data;
}

static GtsTriangle *face_at(const GtsVertex *v)
{
    for (GSList *s = v->segments; s; s = s->next)
        if (((GtsEdge *)s->data)->triangles)
            return ((GtsEdge *)s->data)->triangles->data;
    return NULL;
}

/* The edge that there is, or a new one. */
static GtsEdge *edge_between(GtsVertex *a, GtsVertex *b)
{
    GtsEdge *e = (GtsEdge *)gts_vertices_are_connected(a, b);
    return e ? e : gts_edge_new(gts_edge_class(), a, b);
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
    GtsEdge *base = edge_between(a, b), *up = edge_between(b, chain[apex]), *down = edge_between(chain[apex], a);
    mesh_add_face(m, base, up, down);
    fill(m, chain[apex], b, chain, apex);
    fill(m, a, chain[apex], chain + apex + 1, n - apex - 1);
}

/* What a piece cuts through: faces, and the vertices to its left and right, from its first end on. */
typedef struct {
    GPtrArray *face, *left, *right;
} Cut;

/* The face at a whose opposite edge lies across a b; its ends to the left and right. */
static GtsTriangle *first_cut(GtsVertex *a, GtsVertex *b, GtsVertex **left, GtsVertex **right)
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

static GtsEdge *edge_of(const GtsTriangle *f, const GtsVertex *a, const GtsVertex *b)
{
    GtsEdge *const edge[3] = {f->e1, f->e2, f->e3};
    for (int k = 0; k < 2; k++)
        if ((edge[k]->segment.v1 == a && edge[k]->segment.v2 == b) || (edge[k]->segment.v1 == b && edge[k]->segment.v2 == a))
            return edge[k];
    return edge[2];
}

/* FALSE when another piece or a vertex is in the way. */
static bool find_cut(Mesher *m, GtsVertex *a, GtsVertex *b, Cut *cut)
{
    GtsVertex *left, *right;
    GtsTriangle *f = first_cut(a, b, &left, &right);
    if (!f)
        return false;
    g_ptr_array_add(cut->left, left);
    g_ptr_array_add(cut->right, right);
    for (;;) {
        g_ptr_array_add(cut->face, f);
        GtsEdge *crossed = edge_of(f, left, right);
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

/* A piece that was made beforehand becomes an edge by itself if its ends come to be joined; else it is cut in. New faces come before old
 * ones go, so that edges of both stay. */
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
        mesh_remove_faces(m, cut.face);
    }
    g_ptr_array_free(cut.face, TRUE);
    g_ptr_array_free(cut.left, TRUE);
    g_ptr_array_free(cut.right, TRUE);
    return good;
}

static bool put_in_all(Mesher *m)
{
    MeshOrder o;
    mesh_order_init(&o, m->graph);
    GtsTriangle *f = hull_new(m);
    GtsVertex *v = m->hull[0];
    bool good = true;
    for (uint32_t r = 0; r < o.n_rounds && good; r++) {
        for (uint32_t i = o.point_start[r]; i < o.point_start[r + 1]; i++) {
            v = m->vertex->pdata[o.point[i]];
            f = mesh_walk(m, f, v, NULL);
            mesh_find_cavity(m, f, NULL, v);
            mesh_fill_cavity(m, v, NULL);
            f = face_at(v);
        }
        for (uint32_t k = o.segment_start[r]; k < o.segment_start[r + 1] && good; k++)
            good = put_in(m, m->piece[o.segment[k]]);
        f = face_at(v); /* pieces may have cut through the last one */
    }
    mesh_order_clear(&o);
    return good;
}

/* The faces that can be reached from the first outline segment's outer side without crossing a piece. */
static GPtrArray *find_outside(Mesher *m)
{
    GPtrArray *outside = g_ptr_array_new();
    GtsEdge *e = &m->piece[0]->gts;
    for (GSList *t = e->triangles; t; t = t->next) {
        GtsVertex *apex = mesh_opposite(t->data, e);
        if (gts_point_orientation(&e->segment.v1->p, &e->segment.v2->p, &apex->p) < 0.0)
            g_ptr_array_add(outside, t->data);
    }
    for (uint32_t i = 0; i < outside->len; i++) {
        GtsTriangle *f = outside->pdata[i];
        GtsEdge *const edge[3] = {f->e1, f->e2, f->e3};
        f->object.flags |= MESH_MARK;
        for (int k = 0; k < 3; k++) {
            GtsTriangle *next = mesh_is_piece(m, edge[k]) ? NULL : mesh_neighbour(f, edge[k]);
            if (next && !(next->object.flags & MESH_MARK)) {
                next->object.flags |= MESH_MARK;
                g_ptr_array_add(outside, next);
            }
        }
    }
    return outside;
}

static bool carve(Mesher *m)
{
    GPtrArray *face = find_outside(m);
    mesh_remove_faces(m, face);
    g_ptr_array_free(face, TRUE);
    for (int k = 0; k < 3; k++) {
        mesh_destroy(m->hull[k]);
        m->hull[k] = NULL;
    }
    return m->n_faces > 0;
}

bool mesh_triangulate(Mesher *m)
{
    for (uint32_t i = 0; i < m->graph->n_points; i++)
        mesh_vertex_new(m, m->graph->point[i], MESH_NONE);
    for (uint32_t s = 0; s < m->n_pieces; s++)
        m->piece[s] = piece_new(m, s);
    return put_in_all(m) && carve(m);
}
