#include "geom/mesh_gts.h"

/* Of the distance between features near by: the shortest edge that is still refined. */
static const double floor_part = 1.0 / 64.0;

/* --- splitting pieces --- */

/* Two input segments that meet at less than a right angle would split each other for ever. So they are cut where circles about their common
 * point cross them, of radius a power of two: the pieces come out equally long and leave each other alone (Ruppert 1995, § 5.1). */
static bool *find_acute(const Pslg *g)
{
    uint32_t n = g->n_outline + g->n_segments, *start = g_new0(uint32_t, (gsize)g->n_points + 2);
    Vec2 *away = g_new(Vec2, 2 * (gsize)n);
    bool *acute = g_new0(bool, g->n_points);
    for (uint32_t s = 0; s < n; s++)
        for (int k = 0; k < 2; k++)
            start[mesh_input_end(g, s, k) + 2]++;
    for (uint32_t i = 0; i < g->n_points; i++)
        start[i + 2] += start[i + 1];
    for (uint32_t s = 0; s < n; s++)
        for (int k = 0; k < 2; k++) {
            uint32_t from = mesh_input_end(g, s, k), to = mesh_input_end(g, s, 1 - k);
            away[start[from + 1]++] = vec_sub(g->point[to], g->point[from]);
        }
    for (uint32_t i = 0; i < g->n_points; i++) {
        acute[i] = start[i + 1] - start[i] > 4; /* five directions can't all be a right angle apart */
        for (uint32_t a = start[i]; a < start[i + 1] && !acute[i]; a++)
            for (uint32_t b = a + 1; b < start[i + 1]; b++)
                acute[i] |= vec_dot(away[a], away[b]) > 0.0;
    }
    g_free(start);
    g_free(away);
    return acute;
}

static bool is_acute(const Mesher *m, const GtsVertex *v)
{
    uint32_t i = ((const MeshVertex *)v)->index;
    return i < m->graph->n_points && m->acute[i];
}

/* Where to split: a circle about the one end that needs it, else the middle. */
static Vec2 split_place(const Mesher *m, const MeshPiece *e)
{
    const GtsVertex *from = e->gts.segment.v1, *to = e->gts.segment.v2;
    bool a = is_acute(m, from), b = is_acute(m, to);
    if (a == b)
        return vec_lerp(mesh_place(from), mesh_place(to), 0.5);
    if (b) {
        const GtsVertex *other = from;
        from = to;
        to = other;
    }
    double length = vec_dist(mesh_place(from), mesh_place(to));
    int exponent;
    double part = frexp(length, &exponent); /* the radius is 0.35 … 0.71 of the length */
    double radius = ldexp(part < M_SQRT1_2 ? 0.25 : 0.5, exponent);
    return vec_lerp(mesh_place(from), mesh_place(to), radius / length);
}

static double size_from(const GtsVertex *v, Vec2 p) { return ((const MeshVertex *)v)->size + vec_dist(mesh_place(v), p); }

static MeshPiece *half_new(const MeshPiece *e, GtsVertex *a, GtsVertex *b)
{
    MeshPiece *half = (MeshPiece *)gts_object_clone((GtsObject *)e);
    half->waiting = false;
    half->gts.segment.v1 = a;
    half->gts.segment.v2 = b;
    a->segments = g_slist_prepend(a->segments, half);
    b->segments = g_slist_prepend(b->segments, half);
    return half;
}

static void check_piece(Mesher *m, MeshPiece *e);
static void check_around(Mesher *m, GtsVertex *v);

static void split(Mesher *m, MeshPiece *e)
{
    GtsVertex *a = e->gts.segment.v1, *b = e->gts.segment.v2;
    Vec2 p = split_place(m, e);
    MeshVertex *v = mesh_vertex_new(m, p, e->input);
    v->size = fmin(size_from(a, p), size_from(b, p));
    MeshPiece *first = half_new(e, a, &v->gts), *second = half_new(e, &v->gts, b);
    mesh_find_cavity(m, NULL, e, &v->gts);
    mesh_fill_cavity(m, &v->gts, e);
    check_around(m, &v->gts);
    check_piece(m, first);
    check_piece(m, second);
}

static bool too_many(const Mesher *m) { return m->n_faces > m->limit; }

static bool split_encroached(Mesher *m)
{
    while (m->served < m->encroached->len) {
        if (too_many(m))
            return false;
        split(m, m->encroached->pdata[m->served++]);
    }
    g_ptr_array_set_size(m->encroached, 0);
    m->served = 0;
    return !too_many(m);
}

/* --- encroached pieces: those with a vertex in the circle over them, which is seen from there under more than a right angle --- */

static bool is_long(const Mesher *m, const GtsEdge *e)
{
    return vec_dist2(mesh_place(e->segment.v1), mesh_place(e->segment.v2)) > m->tiny2;
}

static bool encroaches(const Mesher *m, const GtsVertex *v, const GtsEdge *e)
{
    Vec2 p = mesh_place(v), a = mesh_place(e->segment.v1), b = mesh_place(e->segment.v2);
    return vec_dot(vec_sub(a, p), vec_sub(b, p)) < 0.0 && is_long(m, e);
}

static void enlist(Mesher *m, MeshPiece *e)
{
    if (e->waiting)
        return;
    e->waiting = true;
    g_ptr_array_add(m->encroached, e);
}

static void check_piece(Mesher *m, MeshPiece *e)
{
    for (GSList *t = e->gts.triangles; t; t = t->next)
        if (encroaches(m, mesh_opposite(t->data, &e->gts), &e->gts))
            enlist(m, e);
}

/* Enlists the pieces that a new vertex encroaches upon. */
static void check_around(Mesher *m, GtsVertex *v)
{
    for (GSList *s = v->segments; s; s = s->next)
        for (GSList *t = ((GtsEdge *)s->data)->triangles; t; t = t->next) {
            const GtsTriangle *f = t->data;
            GtsEdge *const edge[3] = {f->e1, f->e2, f->e3};
            for (int k = 0; k < 3; k++)
                if (mesh_is_piece(m, edge[k]) && edge[k]->segment.v1 != v && edge[k]->segment.v2 != v &&
                    encroaches(m, v, edge[k]))
                    enlist(m, (MeshPiece *)edge[k]);
        }
}

/* What lies near is resolved: the shortest edge at each vertex is in proportion to the distances between features. */
static void measure_sizes(Mesher *m)
{
    for (uint32_t i = 0; i < m->vertex->len; i++) {
        MeshVertex *v = m->vertex->pdata[i];
        double least2 = HUGE_VAL;
        for (GSList *s = v->gts.segments; s; s = s->next) {
            const GtsSegment *e = s->data;
            least2 = fmin(least2, vec_dist2(mesh_place(e->v1), mesh_place(e->v2)));
        }
        v->size = sqrt(least2);
    }
}

bool mesh_conform(Mesher *m)
{
    m->acute = find_acute(m->graph);
    for (uint32_t s = 0; s < m->n_pieces; s++)
        check_piece(m, m->piece[s]);
    bool good = split_encroached(m);
    if (good)
        measure_sizes(m);
    return good;
}

/* --- refining faces --- */

/* Whether p and q lie on two input segments that meet at less than 60°, equally far from where they do: the distance between them comes
 * from the angle there, and no refinement can help it (Miller, Pav and Walkington 2003). */
static bool is_across_angle(const Mesher *m, const GtsVertex *p, const GtsVertex *q)
{
    uint32_t s = ((const MeshVertex *)p)->input, t = ((const MeshVertex *)q)->input;
    if (s == MESH_NONE || t == MESH_NONE || s == t)
        return false;
    for (int k = 0; k < 4; k++) {
        uint32_t o = mesh_input_end(m->graph, s, k & 1);
        if (o != mesh_input_end(m->graph, t, k >> 1))
            continue;
        double a = vec_dist2(m->graph->point[o], mesh_place(p)), b = vec_dist2(m->graph->point[o], mesh_place(q));
        return fabs(a - b) <= 1e-4 * a && vec_dist2(mesh_place(p), mesh_place(q)) < a;
    }
    return false;
}

/* An edge that is shorter than this is not made shorter for the sake of an angle. Refinement ends well above for angles up to 28°;
 * beyond, where no proof says that it ends, this is the end. */
static double floor_at(const Mesher *m, const MeshVertex *p, const MeshVertex *q)
{
    return fmax(m->def->floor, floor_part * fmin(fmin(p->size, q->size), m->side));
}

uint32_t mesh_urgency(const Mesher *m, const GtsTriangle *f)
{
    GtsVertex *corner[3];
    GtsEdge *edge[3];
    mesh_corners(f, corner, edge);
    Vec2 p[3] = {mesh_place(corner[0]), mesh_place(corner[1]), mesh_place(corner[2])};
    double twice_area = vec_cross(vec_sub(p[1], p[0]), vec_sub(p[2], p[0]));
    if (m->def->max_area > 0.0 && twice_area > 2.0 * m->def->max_area) {
        int exponent;
        frexp(0.5 * twice_area / m->def->max_area, &exponent);
        return MESH_BUCKETS / 2 + (uint32_t)(exponent < MESH_BUCKETS / 2 ? exponent : MESH_BUCKETS / 2 - 1);
    }
    double length2[3] = {vec_dist2(p[0], p[1]), vec_dist2(p[1], p[2]), vec_dist2(p[2], p[0])};
    int k = length2[1] < length2[0] ? 1 : 0;
    k = length2[2] < length2[k] ? 2 : k;
    int other = (k + 1) % 3, another = (k + 2) % 3;
    /* sin² of the least angle, which is opposite the shortest edge, over what is asked for */
    double quality = twice_area * twice_area / (length2[other] * length2[another] * m->sine2);
    if (!(quality < 1.0))
        return 0;
    double floor = floor_at(m, (MeshVertex *)corner[k], (MeshVertex *)corner[other]);
    if (length2[k] < floor * floor || (mesh_is_piece(m, edge[other]) && mesh_is_piece(m, edge[another])) ||
        is_across_angle(m, corner[k], corner[other]))
        return 0;
    return 1 + (uint32_t)((1.0 - quality) * (MESH_BUCKETS / 2 - 2));
}

static Vec2 circumcentre(const GtsTriangle *f)
{
    GtsVertex *corner[3];
    GtsEdge *edge[3];
    mesh_corners(f, corner, edge);
    Vec2 o = mesh_place(corner[0]), a = vec_sub(mesh_place(corner[1]), o), b = vec_sub(mesh_place(corner[2]), o);
    double k = 0.5 / vec_cross(a, b), aa = vec_norm2(a), bb = vec_norm2(b);
    return vec2(o.x + (b.y * aa - a.y * bb) * k, o.y + (a.x * bb - b.x * aa) * k);
}

/* Enlists the pieces that p would encroach upon: they bound its cavity. */
static bool check_cavity(Mesher *m, GtsVertex *p)
{
    for (uint32_t i = 0; i < m->cavity->len; i++) {
        const GtsTriangle *t = m->cavity->pdata[i];
        GtsEdge *const edge[3] = {t->e1, t->e2, t->e3};
        for (int k = 0; k < 3; k++)
            if (mesh_is_piece(m, edge[k]) && encroaches(m, p, edge[k]))
                enlist(m, (MeshPiece *)edge[k]);
    }
    return m->encroached->len > 0;
}

/* Adds the circumcentre, or splits the pieces that it would encroach upon. */
static bool improve(Mesher *m, GtsTriangle *f)
{
    GtsVertex *corner[3];
    GtsEdge *edge[3];
    mesh_corners(f, corner, edge);
    Vec2 p = circumcentre(f);
    if (!(isfinite(p.x) && isfinite(p.y)))
        return true;
    MeshVertex *v = mesh_vertex_new(m, p, MESH_NONE);
    v->size = fmin(fmin(size_from(corner[0], p), size_from(corner[1], p)), size_from(corner[2], p));
    MeshPiece *wall = NULL;
    GtsTriangle *at = mesh_walk(m, f, &v->gts, &wall);
    if (at) {
        mesh_find_cavity(m, at, NULL, &v->gts);
        if (!check_cavity(m, &v->gts)) {
            mesh_fill_cavity(m, &v->gts, NULL);
            return !too_many(m);
        }
    }
    mesh_destroy(v);
    g_ptr_array_set_size(m->vertex, (gint)m->vertex->len - 1);
    if (wall && is_long(m, &wall->gts))
        enlist(m, wall); /* rounding put the circumcentre beyond it */
    if (m->encroached->len)
        mesh_queue_add(m, f);
    return split_encroached(m);
}

static void queue_all(Mesher *m)
{
    for (uint32_t i = 0; i < m->vertex->len; i++) {
        GtsVertex *v = m->vertex->pdata[i];
        for (GSList *s = v->segments; s; s = s->next)
            for (GSList *t = ((GtsEdge *)s->data)->triangles; t; t = t->next)
                if (((GtsTriangle *)t->data)->e1 == s->data && ((GtsSegment *)s->data)->v1 == v)
                    mesh_queue_add(m, t->data);
    }
}

bool mesh_refine(Mesher *m)
{
    m->refining = true;
    queue_all(m);
    GtsTriangle *f;
    bool good = true;
    while (good && (f = mesh_queue_take(m)))
        good = improve(m, f);
    return good;
}
