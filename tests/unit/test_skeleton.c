/* Skeletons: small drawn veins by hand, bad ones, random ones and grown leaves; all of them against a plain check of what a mesher needs. */
#include <glib.h>
#include <string.h>

#include "geom/random.h"
#include "geom/segment.h"
#include "lib/leaf.h"
#include "shape/skeleton.h"

static double uniform(uint32_t stream, uint32_t step, uint64_t index)
{
    double u[2];
    random_pair(23, stream, step, index, u);
    return u[0];
}

/* ---- what a mesher needs, by brute force over all pairs ---- */

static double side(Vec2 a, Vec2 b, Vec2 c) { return vec_cross(vec_sub(b, a), vec_sub(c, a)); }

static Box2 box_of(Vec2 a, Vec2 b) { return box_add(box_add(box_empty(), a), b); }

static bool cross(Vec2 a, Vec2 b, Vec2 c, Vec2 d)
{
    Box2 k = box_of(a, b), l = box_of(c, d);
    if (!(k.x0 <= l.x1 && l.x0 <= k.x1 && k.y0 <= l.y1 && l.y0 <= k.y1)) /* apart on one line: the signs below would be chance */
        return false;
    double p = side(a, b, c), q = side(a, b, d), r = side(c, d, a), s = side(c, d, b);
    return ((p < 0.0 && q > 0.0) || (p > 0.0 && q < 0.0)) && ((r < 0.0 && s > 0.0) || (r > 0.0 && s < 0.0));
}

static bool winds(const Pslg *g, Vec2 q)
{
    int winding = 0;
    for (uint32_t i = 0; i < g->n_outline; i++) {
        Vec2 a = g->point[i], b = g->point[(i + 1) % g->n_outline];
        double left = (b.x - a.x) * (q.y - a.y) - (q.x - a.x) * (b.y - a.y);
        winding += (a.y <= q.y && b.y > q.y && left > 0.0) - (a.y > q.y && b.y <= q.y && left < 0.0);
    }
    return winding == 1;
}

static void ends(const Pslg *g, uint32_t k, uint32_t *a, uint32_t *b)
{
    *a = k < g->n_outline ? k : g->segment[k - g->n_outline][0];
    *b = k < g->n_outline ? (k + 1) % g->n_outline : g->segment[k - g->n_outline][1];
}

/* What is wrong with the graph; NULL when nothing is. */
static char *fault_of(const Pslg *g, double least)
{
    uint32_t n = g->n_outline + g->n_segments, a, b, c, d;
    for (uint32_t i = 0; i < g->n_points; i++) {
        if (!isfinite(g->point[i].x) || !isfinite(g->point[i].y))
            return g_strdup_printf("point %u is not finite", i);
        for (uint32_t j = 0; j < i; j++)
            if (!(vec_dist(g->point[i], g->point[j]) >= least))
                return g_strdup_printf("points %u and %u are %g apart", i, j, vec_dist(g->point[i], g->point[j]));
    }
    for (uint32_t k = 0; k < n; k++) {
        ends(g, k, &a, &b);
        if (a >= g->n_points || b >= g->n_points || a == b)
            return g_strdup_printf("segment %u runs from %u to %u", k, a, b);
        for (uint32_t i = 0; i < g->n_points; i++)
            if (i != a && i != b && !(segment_dist2(g->point[a], g->point[b], g->point[i]) >= least * least))
                return g_strdup_printf("point %u is %g from segment %u – %u", i, sqrt(segment_dist2(g->point[a], g->point[b], g->point[i])), a, b);
        for (uint32_t l = 0; l < k; l++) {
            ends(g, l, &c, &d);
            if ((a == c && b == d) || (a == d && b == c))
                return g_strdup_printf("segment %u – %u is there twice", a, b);
            if (cross(g->point[a], g->point[b], g->point[c], g->point[d]))
                return g_strdup_printf("segments %u – %u and %u – %u cross", a, b, c, d);
        }
        if (k >= g->n_outline && !winds(g, vec_lerp(g->point[a], g->point[b], 0.5)))
            return g_strdup_printf("segment %u – %u is outside", a, b);
    }
    return NULL;
}

static void test_fault(void)
{
    const Vec2 p[7] = {{0, 0}, {10, 0}, {10, 10}, {0, 10}, {5, 0.5}, {5, 5}, {9, 9.5}};
    struct {
        uint32_t n, segment[3][2];
        double least;
        const char *fault;
    } t[] = {{1, {{0, 5}}, 0.4, NULL},
             {2, {{0, 5}, {5, 6}}, 0.4, NULL},
             {2, {{0, 5}, {5, 6}}, 0.55, "point 4 is 0.5 from segment 0 – 1"},
             {2, {{0, 5}, {5, 0}}, 0.4, "segment 5 – 0 is there twice"},
             {2, {{0, 6}, {4, 3}}, 0.1, "segments 4 – 3 and 0 – 6 cross"},
             {1, {{2, 0}}, 0.01, "point 5 is 0 from segment 2 – 0"},
             {1, {{0, 9}}, 0.01, "segment 4 runs from 0 to 9"}};
    for (uint32_t k = 0; k < G_N_ELEMENTS(t); k++) {
        Pslg *g = pslg_new(7, 4, t[k].n);
        memcpy(g->point, p, sizeof p);
        memcpy(g->segment, t[k].segment, t[k].n * sizeof t[k].segment[0]);
        char *fault = fault_of(g, t[k].least);
        g_assert_cmpstr(fault, ==, t[k].fault);
        g_free(fault);
        pslg_free(g);
    }
}

/* ---- what a skeleton promises ---- */

static void check_sequence(const Skeleton *s, uint32_t k, uint8_t *seen)
{
    const Sequence *q = &s->sequence[k];
    double length = 0.0;
    g_assert_cmpuint(q->n, >=, 2);
    g_assert_cmpuint(q->first + q->n, <=, s->n_at);
    for (uint32_t i = 1; i < q->n; i++) {
        uint32_t node = s->at[q->first + i];
        g_assert_cmpuint(node, <, s->n_nodes);
        g_assert_cmpuint(s->hinge[node], ==, s->at[q->first + i - 1]);
        g_assert_cmpuint(seen[node]++, ==, 0); /* a node beyond the first is of one sequence alone */
        length += vec_dist(s->rest[node], s->rest[s->hinge[node]]);
    }
    g_assert_cmpfloat_with_epsilon(q->length, length, 1e-9 * length);
    g_assert_cmpfloat(q->base_radius, >=, 0.0);
    g_assert_cmpfloat(q->tip_radius, >=, 0.0);
    if (k == 0)
        g_assert_cmpfloat(s->radius[s->at[q->first]], ==, q->base_radius);
    g_assert_cmpfloat(s->radius[s->at[q->first + q->n - 1]], ==, q->tip_radius); /* also where a wider vein leaves the tip */
    if (q->parent == NO_PARENT) {
        g_assert_cmpuint(s->hinge[s->at[q->first]], ==, NO_PARENT);
        g_assert_cmpuint(q->start, ==, 0);
    } else {
        const Sequence *p = &s->sequence[q->parent];
        g_assert_cmpuint(q->parent, <, k);
        g_assert_cmpuint(q->start, <, p->n);
        g_assert_cmpuint(s->at[p->first + q->start], ==, s->at[q->first]);
    }
    g_assert_cmpuint(strlen(q->name), >=, 2);
    g_assert_cmpuint(skeleton_find(s, q->name), ==, k); /* so no name is there twice */
}

static void check_skeleton(const Skeleton *s)
{
    uint8_t *seen = g_new0(uint8_t, s->n_nodes);
    uint32_t *point = g_new(uint32_t, s->n_nodes), a, b;
    g_assert_cmpuint(s->n_sequences, >, 0);
    g_assert_cmpstr(s->sequence[0].name, ==, "midrib");
    for (uint32_t k = 0; k < s->n_sequences; k++)
        check_sequence(s, k, seen);
    for (uint32_t i = 0; i < s->n_nodes; i++) {
        g_assert_true(s->hinge[i] == NO_PARENT || s->hinge[i] < i);
        g_assert_cmpuint(seen[i], ==, s->hinge[i] != NO_PARENT);
    }
    g_assert_false(polygon_crossing(s->outline, &a, &b));
    Pslg *g = skeleton_pslg(s, point);
    g_assert_cmpuint(g->n_outline, ==, s->outline->n);
    for (uint32_t i = 0; i < s->n_nodes; i++)
        g_assert_true(g->point[point[i]].x == s->rest[i].x && g->point[point[i]].y == s->rest[i].y);
    char *fault = fault_of(g, s->least);
    if (fault)
        g_error("%s", fault);
    GError *error = NULL;
    pslg_check(g, s->least, &error);
    g_assert_no_error(error);
    pslg_free(g);
    g_free(point);
    g_free(seen);
}

/* What the definition asks of a new skeleton. */
static void check_made(const Skeleton *s, const SkeletonDef *def)
{
    check_skeleton(s);
    g_assert_cmpfloat(s->least, >=, 0.25 * def->clearance);
    for (uint32_t k = 0; k < s->n_sequences; k++) {
        const Sequence *q = &s->sequence[k];
        g_assert_cmpuint(q->order, <=, def->max_order);
        g_assert_cmpfloat(q->length, >=, def->min_length);
        g_assert_false(q->fictitious);
    }
    for (uint32_t i = 0; i < s->n_nodes; i++) {
        g_assert_cmpuint(s->vertex[i], ==, NO_PARENT);
        if (s->hinge[i] != NO_PARENT && def->spacing > 0.0)
            g_assert_cmpfloat(vec_dist(s->rest[i], s->rest[s->hinge[i]]), <=, MAX(def->spacing, def->clearance) * (1.0 + 1e-9));
    }
    for (uint32_t k = 0; k < s->n_sequences; k++) /* but for tips on the margin no edge is short */
        for (uint32_t i = 1; i + 1 < s->sequence[k].n; i++) {
            uint32_t node = s->at[s->sequence[k].first + i];
            g_assert_cmpfloat(vec_dist(s->rest[node], s->rest[s->hinge[node]]), >=, 0.5 * def->clearance * (1.0 - 1e-9));
        }
}

static bool same(const Skeleton *a, const Skeleton *b)
{
    bool ok = a->n_nodes == b->n_nodes && a->n_sequences == b->n_sequences && a->n_at == b->n_at && a->outline->n == b->outline->n;
    ok = ok && memcmp(a->rest, b->rest, a->n_nodes * sizeof *a->rest) == 0 && memcmp(a->hinge, b->hinge, a->n_nodes * sizeof *a->hinge) == 0;
    ok = ok && memcmp(a->radius, b->radius, a->n_nodes * sizeof *a->radius) == 0 && memcmp(a->at, b->at, a->n_at * sizeof *a->at) == 0;
    ok = ok && memcmp(a->outline->v, b->outline->v, a->outline->n * sizeof(Vec2)) == 0;
    for (uint32_t i = 0; ok && i < a->n_sequences; i++)
        ok = strcmp(a->sequence[i].name, b->sequence[i].name) == 0 && a->sequence[i].parent == b->sequence[i].parent;
    return ok;
}

/* ---- drawing networks ---- */

typedef struct {
    GArray *node, *tail, *head, *kind, *width, *order, *vein;
    uint32_t n_veins;
} Sketch;

static Sketch sketch_new(void)
{
    return (Sketch){g_array_new(FALSE, FALSE, sizeof(Vec2)),     g_array_new(FALSE, FALSE, sizeof(uint32_t)),
                     g_array_new(FALSE, FALSE, sizeof(uint32_t)), g_array_new(FALSE, FALSE, sizeof(uint8_t)),
                     g_array_new(FALSE, FALSE, sizeof(double)),   g_array_new(FALSE, FALSE, sizeof(uint8_t)),
                     g_array_new(FALSE, FALSE, sizeof(uint32_t)), 0};
}

static uint32_t draw_node(Sketch *d, Vec2 p)
{
    g_array_append_val(d->node, p);
    return d->node->len - 1;
}

static uint32_t draw_edge(Sketch *d, uint32_t tail, uint32_t head, uint8_t kind, double width, uint8_t order, uint32_t vein)
{
    g_array_append_val(d->tail, tail);
    g_array_append_val(d->head, head);
    g_array_append_val(d->kind, kind);
    g_array_append_val(d->width, width);
    g_array_append_val(d->order, order);
    g_array_append_val(d->vein, vein);
    return d->tail->len - 1;
}

/* A vein from a node through the points, in edges about `step` long, its width falling from w0 to w1. Returns its last node; node k of
 * its edges is last - count + k. */
static uint32_t draw_vein(Sketch *d, uint32_t from, const Vec2 *p, uint32_t n, double step, uint8_t order, double w0, double w1)
{
    uint32_t first_edge = d->tail->len, node = from;
    for (uint32_t i = 0; i < n; i++) {
        Vec2 a = g_array_index(d->node, Vec2, node);
        uint32_t parts = step > 0.0 ? (uint32_t)ceil(vec_dist(a, p[i]) / step) : 1;
        for (uint32_t k = 1; k <= parts; k++) {
            uint32_t next = draw_node(d, vec_lerp(a, p[i], (double)k / (double)parts));
            draw_edge(d, node, next, EDGE_VEIN, w0, order, d->n_veins);
            node = next;
        }
    }
    for (uint32_t e = first_edge; e < d->tail->len; e++)
        g_array_index(d->width, double, e) = w0 + (w1 - w0) * (e - first_edge) / MAX(1.0, d->tail->len - first_edge - 1.0);
    d->n_veins++;
    return node;
}

static uint32_t draw_nearest(const Sketch *d, Vec2 p)
{
    uint32_t best = 0;
    for (uint32_t i = 1; i < d->node->len; i++)
        if (vec_dist2(g_array_index(d->node, Vec2, i), p) < vec_dist2(g_array_index(d->node, Vec2, best), p))
            best = i;
    return best;
}

static void move_out(GArray *from, void *to)
{
    memcpy(to, from->data, from->len * g_array_get_element_size(from));
    g_array_free(from, TRUE);
}

/* Eats the drawing. */
static Network *sketch_network(Sketch *d, const Vec2 *margin, uint32_t n_margin)
{
    Network *net = network_new(d->node->len, d->tail->len);
    net->n_veins = d->n_veins;
    move_out(d->node, net->node);
    move_out(d->tail, net->tail);
    move_out(d->head, net->head);
    move_out(d->kind, net->kind);
    move_out(d->width, net->width);
    move_out(d->order, net->order);
    move_out(d->vein, net->vein);
    if (n_margin > 0)
        net->margin = polygon_new(margin, n_margin);
    return net;
}

static const Vec2 square[4] = {{-50, 0}, {50, 0}, {50, 100}, {-50, 100}};
static const Vec2 diamond[5] = {{0, 0}, {40, 30}, {40, 60}, {0, 100}, {-45, 50}};

static SkeletonDef plain_def(void)
{
    return (SkeletonDef){.max_order = 3, .tolerance = 0.4, .spacing = 0.0, .clearance = 1.0, .min_angle = 15.0, .min_length = 8.0};
}

static Skeleton *make(Network *net, const SkeletonDef *def)
{
    GError *error = NULL;
    Skeleton *s = skeleton_new(net, def, &error);
    g_assert_no_error(error);
    g_assert_nonnull(s);
    check_made(s, def);
    network_free(net);
    return s;
}

static Vec2 node_at(const Skeleton *s, const char *name, uint32_t i)
{
    uint32_t q = skeleton_find(s, name);
    g_assert_cmpuint(q, !=, NO_PARENT);
    g_assert_cmpuint(i, <, s->sequence[q].n);
    return s->rest[s->at[s->sequence[q].first + i]];
}

static const Sequence *sequence(const Skeleton *s, const char *name)
{
    uint32_t q = skeleton_find(s, name);
    if (q == NO_PARENT)
        g_error("no sequence is called %s", name);
    return &s->sequence[q];
}

static Vec2 tip_of(const Skeleton *s, const char *name) { return node_at(s, name, sequence(s, name)->n - 1); }

static void at(Vec2 got, double x, double y)
{
    if (!(vec_dist(got, vec2(x, y)) < 1e-9))
        g_error("(%g, %g) instead of (%g, %g)", got.x, got.y, x, y);
}

static bool on_outline(const Skeleton *s, Vec2 p)
{
    for (uint32_t i = 0; i < s->outline->n; i++)
        if (s->outline->v[i].x == p.x && s->outline->v[i].y == p.y)
            return true;
    return false;
}

/* ---- by hand ---- */

/* A midrib with three branches, one of them branched, in unit steps: every number is known. */
static void test_pinnate(void)
{
    Sketch d = sketch_new();
    uint32_t base = draw_node(&d, vec2(0, 0));
    draw_vein(&d, base, (Vec2[]){{0, 90}}, 1, 1.0, 1, 4.0, 1.0);
    draw_vein(&d, draw_nearest(&d, vec2(0, 20)), (Vec2[]){{30, 50}}, 1, 1.0, 2, 2.0, 0.5);
    draw_vein(&d, draw_nearest(&d, vec2(0, 40)), (Vec2[]){{-30, 60}}, 1, 1.0, 2, 2.0, 0.5);
    draw_vein(&d, draw_nearest(&d, vec2(0, 60)), (Vec2[]){{30, 80}}, 1, 1.0, 2, 1.0, 0.5);
    draw_vein(&d, draw_nearest(&d, vec2(15, 35)), (Vec2[]){{15, 50}}, 1, 1.0, 3, 0.6, 0.2);
    draw_vein(&d, draw_nearest(&d, vec2(15, 45)), (Vec2[]){{25, 55}}, 1, 1.0, 4, 0.6, 0.2); /* order too high */
    draw_vein(&d, draw_nearest(&d, vec2(0, 80)), (Vec2[]){{5, 85}}, 1, 1.0, 2, 0.6, 0.2);   /* too short */
    SkeletonDef def = plain_def();
    Skeleton *s = make(sketch_network(&d, square, 4), &def);
    g_assert_cmpuint(s->n_sequences, ==, 5);
    g_assert_cmpuint(s->n_nodes, ==, 10);
    g_assert_cmpuint(s->outline->n, ==, 5); /* the base is a vertex */
    g_assert_true(on_outline(s, vec2(0, 0)));
    const Sequence *m = sequence(s, "midrib");
    g_assert_cmpuint(m->n, ==, 5);
    for (uint32_t i = 0; i < 5; i++)
        at(node_at(s, "midrib", i), 0, (double[]){0, 20, 40, 60, 90}[i]);
    g_assert_cmpfloat(m->base_radius, ==, 2.0);
    g_assert_cmpfloat(m->tip_radius, ==, 0.5);
    g_assert_cmpfloat_with_epsilon(m->length, 90.0, 1e-9);
    g_assert_cmpuint(m->vein, ==, 0);
    at(tip_of(s, "R1"), 30, 50);
    at(tip_of(s, "L1"), -30, 60);
    at(tip_of(s, "R2"), 30, 80);
    at(tip_of(s, "R1.L1"), 15, 50);
    g_assert_cmpuint(sequence(s, "R1")->start, ==, 1);
    g_assert_cmpuint(sequence(s, "L1")->start, ==, 2);
    g_assert_cmpuint(sequence(s, "R2")->start, ==, 3);
    g_assert_cmpuint(sequence(s, "R1.L1")->start, ==, 1);
    g_assert_cmpuint(sequence(s, "R1.L1")->parent, ==, skeleton_find(s, "R1"));
    g_assert_cmpuint(sequence(s, "R1.L1")->order, ==, 3);
    g_assert_cmpuint(sequence(s, "R1.L1")->vein, ==, 4);
    g_assert_cmpfloat_with_epsilon(sequence(s, "R1")->base_radius, 1.0, 1e-12);
    g_assert_cmpfloat_with_epsilon(sequence(s, "R1")->tip_radius, 0.25, 1e-12);
    g_assert_cmpfloat_with_epsilon(s->radius[s->at[sequence(s, "R2")->first]], 0.5 * (4.0 - 3.0 * 59.0 / 89.0), 1e-9); /* the midrib's */
    g_assert_cmpuint(skeleton_find(s, "R3"), ==, NO_PARENT);
    skeleton_free(s);
}

/* Long edges are cut evenly. */
static void test_spacing(void)
{
    Sketch d = sketch_new();
    draw_vein(&d, draw_node(&d, vec2(0, 0)), (Vec2[]){{0, 90}}, 1, 1.0, 1, 4.0, 1.0);
    draw_vein(&d, draw_nearest(&d, vec2(0, 30)), (Vec2[]){{30, 60}}, 1, 1.0, 2, 2.0, 0.5);
    SkeletonDef def = plain_def();
    def.spacing = 20.0;
    Skeleton *s = make(sketch_network(&d, square, 4), &def);
    const double want[] = {0, 15, 30, 50, 70, 90};
    g_assert_cmpuint(sequence(s, "midrib")->n, ==, 6);
    for (uint32_t i = 0; i < 6; i++)
        at(node_at(s, "midrib", i), 0, want[i]);
    g_assert_cmpuint(sequence(s, "R1")->n, ==, 4);
    g_assert_cmpuint(sequence(s, "R1")->start, ==, 2);
    skeleton_free(s);
}

/* Five primaries from one seed, and one that leaves the midrib a little higher; secondaries on both. The midrib is the one of greatest length
 * times width. */
static void test_palmate(void)
{
    Sketch d = sketch_new();
    uint32_t base = draw_node(&d, vec2(0, 0));
    draw_vein(&d, base, (Vec2[]){{-40, 20}}, 1, 1.0, 1, 2.0, 1.0);
    draw_vein(&d, base, (Vec2[]){{-45, 95}}, 1, 1.0, 1, 2.0, 1.0); /* the longest */
    draw_vein(&d, base, (Vec2[]){{0, 90}}, 1, 1.0, 1, 3.0, 1.0);
    draw_vein(&d, base, (Vec2[]){{40, 20}}, 1, 1.0, 1, 2.0, 1.0);
    draw_vein(&d, draw_nearest(&d, vec2(0, 5)), (Vec2[]){{35, 65}}, 1, 1.0, 1, 2.0, 1.0);
    draw_vein(&d, draw_nearest(&d, vec2(20, 40)), (Vec2[]){{40, 45}}, 1, 1.0, 2, 1.0, 0.5);
    draw_vein(&d, draw_nearest(&d, vec2(0, 50)), (Vec2[]){{-15, 70}}, 1, 1.0, 2, 1.0, 0.5);
    draw_vein(&d, base, (Vec2[]){{30, 30}}, 1, 1.0, 2, 1.0, 0.5); /* a secondary from the seed itself */
    SkeletonDef def = plain_def();
    Skeleton *s = make(sketch_network(&d, square, 4), &def);
    g_assert_cmpuint(s->n_sequences, ==, 8);
    at(tip_of(s, "midrib"), 0, 90);
    at(tip_of(s, "L1"), -15, 70);
    at(tip_of(s, "P2"), -45, 95);
    uint32_t with_parent = 0, primaries = 0;
    for (uint32_t i = 0; i < s->n_sequences; i++) {
        primaries += s->sequence[i].order == 1;
        with_parent += s->sequence[i].order == 1 && s->sequence[i].parent != NO_PARENT;
    }
    g_assert_cmpuint(primaries, ==, 5);
    g_assert_cmpuint(with_parent, ==, 1);
    /* the longest of the others is P2, and so on; the secondary at (40, 45) has the name of the one it leaves before its own */
    uint32_t n_named = 0;
    for (uint32_t i = 0; i < s->n_sequences; i++)
        n_named += s->sequence[i].name[0] == 'P' && strstr(s->sequence[i].name, ".R1") != NULL;
    g_assert_cmpuint(n_named, ==, 1);
    for (uint32_t i = 2; i < 5; i++) {
        char a[8], b[8];
        g_snprintf(a, sizeof a, "P%u", i);
        g_snprintf(b, sizeof b, "P%u", i + 1);
        g_assert_cmpfloat(sequence(s, a)->length, >=, sequence(s, b)->length - 1e-9);
    }
    at(tip_of(s, "R1"), 30, 30); /* of the primary that leads at the seed */
    g_assert_cmpuint(sequence(s, "R1")->start, ==, 0);
    skeleton_free(s);
}

/* A row of seeds on the margin: each first node is a vertex of the outline, exactly. */
static void test_row(void)
{
    Sketch d = sketch_new();
    for (int i = -4; i <= 4; i++)
        draw_vein(&d, draw_node(&d, vec2(10.0 * i + 0.3, 0)), (Vec2[]){{10.0 * i + 0.3, 95}}, 1, 1.0, 1, 1.0, 0.5);
    SkeletonDef def = plain_def();
    Skeleton *s = make(sketch_network(&d, square, 4), &def);
    g_assert_cmpuint(s->n_sequences, ==, 9);
    for (uint32_t i = 0; i < 9; i++) {
        g_assert_true(on_outline(s, s->rest[s->at[s->sequence[i].first]]));
        g_assert_cmpuint(s->sequence[i].parent, ==, NO_PARENT);
    }
    g_assert_cmpuint(s->outline->n, ==, 13);
    skeleton_free(s);

    /* a hundred seeds, too many to stand side by side: those that stay keep clear */
    d = sketch_new();
    for (int i = -49; i <= 49; i++)
        draw_vein(&d, draw_node(&d, vec2(i, 0)), (Vec2[]){{i, 95}}, 1, 1.0, 1, 1.0, 0.5);
    def.clearance = 2.5;
    s = make(sketch_network(&d, square, 4), &def);
    g_assert_cmpuint(s->n_sequences, >=, 25);
    g_assert_cmpuint(s->n_sequences, <=, 40);
    skeleton_free(s);
}

/* First nodes within the blade, a little way off the margin, and outside it. */
static void test_bases(void)
{
    const double y[] = {20.0, 0.5, 0.0, -0.5, -15.0};
    for (uint32_t k = 0; k < G_N_ELEMENTS(y); k++) {
        Sketch d = sketch_new();
        draw_vein(&d, draw_node(&d, vec2(3, y[k])), (Vec2[]){{3, 80}}, 1, 1.0, 1, 1.0, 0.5);
        SkeletonDef def = plain_def();
        Skeleton *s = make(sketch_network(&d, square, 4), &def);
        at(node_at(s, "midrib", 0), 3, y[k] > 1.0 ? y[k] : 0.0);
        g_assert_cmpint(on_outline(s, node_at(s, "midrib", 0)), ==, y[k] <= 1.0);
        g_assert_cmpuint(s->outline->n, ==, y[k] > 1.0 ? 4 : 5);
        at(tip_of(s, "midrib"), 3, 80);
        skeleton_free(s);
    }
    /* a point of the margin that is too near to the base goes, not the base */
    Sketch d = sketch_new();
    draw_vein(&d, draw_node(&d, vec2(0.1, 0)), (Vec2[]){{0, 80}}, 1, 1.0, 1, 1.0, 0.5);
    SkeletonDef def = plain_def();
    def.tolerance = 0.0;
    Skeleton *s = make(sketch_network(&d, (Vec2[]){{0, 0}, {0.3, 0}, {50, 1}, {50, 80}, {0, 100}, {-50, 80}, {-50, 1}, {-0.1, 0}}, 8), &def);
    at(node_at(s, "midrib", 0), 0.1, 0);
    g_assert_true(on_outline(s, vec2(0.1, 0)));
    g_assert_false(on_outline(s, vec2(0, 0)));
    g_assert_cmpuint(s->outline->n, ==, 6);
    skeleton_free(s);
}

/* ---- clearing ---- */

static void draw_midrib(Sketch *d)
{
    draw_vein(d, draw_node(d, vec2(0, 0)), (Vec2[]){{0, 90}}, 1, 1.0, 1, 4.0, 1.0);
}

static double steepest(const Skeleton *s, const char *name)
{
    const Sequence *q = sequence(s, name), *p = &s->sequence[q->parent];
    Vec2 a = vec_sub(node_at(s, name, 1), node_at(s, name, 0)), b = vec_sub(s->rest[s->at[p->first + q->start + 1]], node_at(s, name, 0));
    return vec_cross(b, a) / sqrt(vec_norm2(a) * vec_norm2(b)); /* sine of the angle, positive to the left */
}

/* A branch that runs along its parent before it leaves: its start moves up to where it does. */
static void test_hair_angle(void)
{
    Sketch d = sketch_new();
    draw_midrib(&d);
    draw_vein(&d, draw_nearest(&d, vec2(0, 20)), (Vec2[]){{0.4, 40}, {30, 70}}, 2, 1.0, 2, 2.0, 0.5);
    SkeletonDef def = plain_def();
    Skeleton *s = make(sketch_network(&d, square, 4), &def);
    g_assert_cmpuint(s->n_sequences, ==, 2);
    g_assert_cmpfloat(node_at(s, "R1", 0).y, >, 33.0);
    g_assert_cmpfloat(node_at(s, "R1", 0).y, <, 42.0);
    g_assert_cmpfloat(steepest(s, "R1"), <, -0.2588);
    at(tip_of(s, "R1"), 30, 70);
    skeleton_free(s);

    /* one that never leaves is dropped */
    d = sketch_new();
    draw_midrib(&d);
    draw_vein(&d, draw_nearest(&d, vec2(0, 20)), (Vec2[]){{0.8, 60}}, 1, 1.0, 2, 2.0, 0.5);
    s = make(sketch_network(&d, square, 4), &def);
    g_assert_cmpuint(s->n_sequences, ==, 1);
    g_assert_cmpuint(sequence(s, "midrib")->n, ==, 2); /* and leaves no branch node */
    skeleton_free(s);

    /* one that leaves at the least angle and a bit does so where it is drawn */
    d = sketch_new();
    draw_midrib(&d);
    draw_vein(&d, draw_nearest(&d, vec2(0, 20)), (Vec2[]){{20, 80}}, 1, 1.0, 2, 2.0, 0.5); /* 18° */
    s = make(sketch_network(&d, square, 4), &def);
    at(node_at(s, "R1", 0), 0, 20);
    skeleton_free(s);
}

/* Branches on both sides, a little apart, leave from one node. */
static void test_merge(void)
{
    Sketch d = sketch_new();
    draw_midrib(&d);
    draw_vein(&d, draw_nearest(&d, vec2(0, 40)), (Vec2[]){{30, 60}}, 1, 1.0, 2, 2.0, 0.5);
    draw_vein(&d, draw_nearest(&d, vec2(0, 41)), (Vec2[]){{-20, 60}}, 1, 1.0, 2, 2.0, 0.5);
    SkeletonDef def = plain_def();
    def.clearance = 2.0;
    Skeleton *s = make(sketch_network(&d, square, 4), &def);
    g_assert_cmpuint(s->n_sequences, ==, 3);
    at(node_at(s, "R1", 0), 0, 40);
    at(node_at(s, "L1", 0), 0, 40);
    g_assert_cmpuint(sequence(s, "midrib")->n, ==, 3);
    skeleton_free(s);
}

/* A vein that crosses a longer one ends where it comes near; so does one that closes in on it. */
static void test_crossing(void)
{
    Sketch d = sketch_new();
    draw_midrib(&d);
    draw_vein(&d, draw_nearest(&d, vec2(0, 10)), (Vec2[]){{40, 50}, {40, 90}}, 2, 1.0, 2, 2.0, 0.5);
    draw_vein(&d, draw_nearest(&d, vec2(0, 60)), (Vec2[]){{48, 60}}, 1, 1.0, 2, 2.0, 0.5);
    SkeletonDef def = plain_def();
    Skeleton *s = make(sketch_network(&d, square, 4), &def);
    g_assert_cmpuint(s->n_sequences, ==, 3);
    g_assert_cmpfloat_with_epsilon(tip_of(s, "R2").x, 39.0, 0.01);
    at(tip_of(s, "R1"), 40, 90);
    skeleton_free(s);

    /* of the higher order though longer */
    d = sketch_new();
    draw_midrib(&d);
    draw_vein(&d, draw_nearest(&d, vec2(0, 50)), (Vec2[]){{30, 50}}, 1, 1.0, 2, 2.0, 0.5);
    draw_vein(&d, draw_nearest(&d, vec2(0, 10)), (Vec2[]){{20, 30}, {20, 95}}, 2, 1.0, 3, 2.0, 0.5);
    s = make(sketch_network(&d, square, 4), &def);
    at(tip_of(s, "R2"), 30, 50);
    g_assert_cmpfloat_with_epsilon(tip_of(s, "R1").y, 49.0, 0.01);
    skeleton_free(s);
}

/* Of a vein that is cut off early nothing stays. */
static void test_stump(void)
{
    Sketch d = sketch_new();
    draw_midrib(&d);
    draw_vein(&d, draw_nearest(&d, vec2(0, 10)), (Vec2[]){{20, 14}, {20, 95}}, 2, 1.0, 2, 2.0, 0.5);
    draw_vein(&d, draw_nearest(&d, vec2(0, 50)), (Vec2[]){{45, 50}, {45, 85}}, 2, 1.0, 2, 2.0, 0.5); /* meets it after 19 of 80 */
    SkeletonDef def = plain_def();
    Skeleton *s = make(sketch_network(&d, square, 4), &def);
    g_assert_cmpuint(s->n_sequences, ==, 2);
    at(tip_of(s, "R1"), 20, 95);
    skeleton_free(s);
}

/* A short end that turns aside is left off, unless a branch leaves it. */
static void test_hook(void)
{
    for (int branch = 0; branch < 2; branch++) {
        Sketch d = sketch_new();
        draw_midrib(&d);
        uint32_t end = draw_vein(&d, draw_nearest(&d, vec2(0, 40)), (Vec2[]){{30, 60}, {29.29, 62.91}}, 2, 1.0, 2, 2.0, 0.5);
        if (branch)
            draw_vein(&d, end - 1, (Vec2[]){{45, 70}}, 1, 1.0, 3, 1.0, 0.5);
        SkeletonDef def = plain_def();
        Skeleton *s = make(sketch_network(&d, square, 4), &def);
        at(tip_of(s, "R1"), branch ? 29.29 : 30, branch ? 62.91 : 60);
        g_assert_cmpuint(s->n_sequences, ==, 2 + branch);
        skeleton_free(s);
    }
}

/* Tips a hair from the margin end on it; those that run along it stop; those that leave the blade end where they do. */
static void test_tips(void)
{
    Sketch d = sketch_new();
    draw_midrib(&d);
    draw_vein(&d, draw_nearest(&d, vec2(0, 40)), (Vec2[]){{49.5, 60}}, 1, 1.0, 2, 2.0, 0.5);
    draw_vein(&d, draw_nearest(&d, vec2(0, 30)), (Vec2[]){{-80, 50}}, 1, 1.0, 2, 2.0, 0.5);
    draw_vein(&d, draw_nearest(&d, vec2(0, 20)), (Vec2[]){{40, 20}, {49.4, 30}, {49.4, 55}}, 3, 1.0, 2, 2.0, 0.5);
    draw_vein(&d, draw_nearest(&d, vec2(0, 70)), (Vec2[]){{30, 85}}, 1, 1.0, 2, 2.0, 0.5);
    SkeletonDef def = plain_def();
    Skeleton *s = make(sketch_network(&d, square, 4), &def);
    g_assert_cmpuint(s->n_sequences, ==, 5);
    g_assert_true(on_outline(s, tip_of(s, "R2")));
    g_assert_cmpfloat_with_epsilon(tip_of(s, "R2").x, 50.0, 1e-12);
    g_assert_true(on_outline(s, tip_of(s, "L1")));
    g_assert_cmpfloat_with_epsilon(tip_of(s, "L1").x, -50.0, 1e-12);
    g_assert_cmpfloat_with_epsilon(tip_of(s, "L1").y, 42.5, 0.5);
    g_assert_cmpfloat(tip_of(s, "R1").y, <, 31.0);
    at(tip_of(s, "R3"), 30, 85);
    at(tip_of(s, "midrib"), 0, 90);
    skeleton_free(s);
}

/* A curl ends where it turns back. */
static void test_curl(void)
{
    Sketch d = sketch_new();
    draw_midrib(&d);
    draw_vein(&d, draw_nearest(&d, vec2(0, 30)), (Vec2[]){{30, 50}, {30, 70}, {12, 70}, {12, 55}, {20, 55}}, 5, 1.0, 2, 2.0, 0.5);
    SkeletonDef def = plain_def();
    Skeleton *s = make(sketch_network(&d, square, 4), &def);
    at(tip_of(s, "R1"), 30, 70);
    skeleton_free(s);
}

/* A vein that runs round its start comes back to itself; one that folds back sharply would lie on itself. */
static void test_itself(void)
{
    Sketch d = sketch_new();
    Vec2 round[26] = {{24, 50}};
    const double c = 0.96126169593831889, s1 = 0.27563735581699916; /* 16° */
    for (int i = 1; i < 26; i++) { /* 400° */
        Vec2 v = vec_sub(round[i - 1], vec2(0, 50));
        round[i] = vec_add(vec2(0, 50), vec2(c * v.x - s1 * v.y, s1 * v.x + c * v.y));
    }
    draw_vein(&d, draw_node(&d, vec2(0, 50)), round, 26, 1.0, 1, 2.0, 0.5);
    SkeletonDef def = plain_def();
    Skeleton *s = make(sketch_network(&d, square, 4), &def);
    g_assert_cmpfloat(sequence(s, "midrib")->length, >, 24.0 + 2.0 * G_PI * 23.0);
    g_assert_cmpfloat(tip_of(s, "midrib").y, <, 49.1);
    g_assert_cmpfloat(tip_of(s, "midrib").y, >, 48.0);
    skeleton_free(s);

    d = sketch_new();
    draw_vein(&d, draw_node(&d, vec2(0, 50)), (Vec2[]){{0, 60}, {0.15, 59.2}, {0.3, 70}}, 3, 0.0, 1, 2.0, 0.5);
    def.tolerance = 0.0;
    s = make(sketch_network(&d, square, 4), &def);
    at(tip_of(s, "midrib"), 0, 60);
    skeleton_free(s);

    d = sketch_new();
    draw_vein(&d, draw_node(&d, vec2(0, 50)), (Vec2[]){{0, 60}, {0.4, 59.15}, {0.6, 70}}, 3, 0.0, 1, 2.0, 0.5); /* by 25° */
    def.min_angle = 30.0;
    s = make(sketch_network(&d, square, 4), &def);
    at(tip_of(s, "midrib"), 0, 60);
    skeleton_free(s);
}

/* What leaves a vein where that ends on the margin goes. */
static void test_branch_at_tip(void)
{
    Sketch d = sketch_new();
    draw_midrib(&d);
    draw_vein(&d, draw_nearest(&d, vec2(0, 40)), (Vec2[]){{49.5, 60}}, 1, 1.0, 2, 2.0, 0.5);
    draw_vein(&d, draw_nearest(&d, vec2(49.2, 59.9)), (Vec2[]){{30, 90}}, 1, 1.0, 3, 2.0, 0.5);
    SkeletonDef def = plain_def();
    Skeleton *s = make(sketch_network(&d, square, 4), &def);
    g_assert_cmpuint(s->n_sequences, ==, 2);
    g_assert_true(on_outline(s, tip_of(s, "R1")));
    skeleton_free(s);
}

/* The part of a vein beyond one that can't be kept goes, with what leaves it there. */
static void test_orphans(void)
{
    Sketch d = sketch_new();
    draw_midrib(&d);
    draw_vein(&d, draw_nearest(&d, vec2(0, 20)), (Vec2[]){{-70, 50}}, 1, 1.0, 2, 2.0, 0.5);
    draw_vein(&d, draw_nearest(&d, vec2(-60, 45.7)), (Vec2[]){{-60, 70}, {-20, 70}}, 2, 1.0, 3, 2.0, 0.5);
    draw_vein(&d, draw_nearest(&d, vec2(-20, 28.6)), (Vec2[]){{-20, 50}}, 1, 1.0, 3, 2.0, 0.5);
    SkeletonDef def = plain_def();
    Skeleton *s = make(sketch_network(&d, square, 4), &def);
    g_assert_cmpuint(s->n_sequences, ==, 3);
    at(tip_of(s, "L1.R1"), -20, 50);
    skeleton_free(s);
}

/* ---- outlines ---- */

static Network *midrib_in(const Vec2 *margin, uint32_t n, double y0, double y1)
{
    Sketch d = sketch_new();
    draw_vein(&d, draw_node(&d, vec2(0, y0)), (Vec2[]){{0, y1}}, 1, 1.0, 1, 1.0, 0.5);
    return sketch_network(&d, margin, n);
}

/* Teeth higher than the tolerance stay, lower ones go; base, tip and size stay. */
static void test_teeth(void)
{
    enum { TEETH = 20 };
    Vec2 v[4 * TEETH + 1];
    uint32_t n = 0;
    v[n++] = vec2(0, 0);
    for (int side_ = 1; side_ >= -1; side_ -= 2)
        for (int i = 0; i < 2 * TEETH; i++) {
            int k = side_ > 0 ? i : 2 * TEETH - 1 - i;
            v[n++] = vec2(side_ * (30.0 + (k % 2 ? 2.0 : 0.0)), 5.0 + 2.0 * k);
        }
    SkeletonDef def = plain_def();
    Skeleton *s = make(midrib_in(v, n, 0, 60), &def);
    g_assert_cmpuint(s->outline->n, ==, n);
    skeleton_free(s);
    def.tolerance = 2.5;
    s = make(midrib_in(v, n, 0, 60), &def);
    g_assert_cmpuint(s->outline->n, <, 10);
    g_assert_cmpfloat(s->outline->box.x0, ==, -32.0);
    g_assert_cmpfloat(s->outline->box.x1, ==, 32.0);
    g_assert_cmpfloat(s->outline->box.y1, ==, 83.0);
    g_assert_true(on_outline(s, vec2(0, 0)));
    skeleton_free(s);
}

/* A slit narrower than the mesher can take is closed, a neck of that kind cut through; wider ones stay. */
static void test_slits(void)
{
    for (double gap = 0.11; gap < 3.0; gap *= 3.0) {
        const Vec2 slit[] = {{0, 0}, {50, 0}, {50, 80}, {20 + gap, 80}, {20 + gap / 2, 30}, {20, 80}, {-40, 80}, {-40, 0}};
        SkeletonDef def = plain_def();
        Skeleton *s = make(midrib_in(slit, 8, 0, 60), &def);
        double area = 90.0 * 80.0;
        g_assert_cmpfloat(s->outline->area, >=, area - 0.51 * gap * 50.0 - 1.0);
        g_assert_cmpfloat(s->outline->area, <=, area + 1.0);
        if (gap < 0.25)
            g_assert_cmpuint(s->outline->n, <, 8);
        else
            g_assert_cmpuint(s->outline->n, ==, 8);
        skeleton_free(s);
        const Vec2 neck[] = {{0, 0},     {40, 0},         {40, 80},        {gap / 2, 80}, {gap / 2, 85}, {20, 99},
                             {-20, 99},  {-gap / 2, 85}, {-gap / 2, 80}, {-40, 80},     {-40, 0}};
        s = make(midrib_in(neck, 11, 0, 60), &def);
        if (gap < 0.25)
            g_assert_cmpfloat_with_epsilon(s->outline->area, 80.0 * 80.0, 10.0);
        if (gap > 0.5)
            g_assert_cmpfloat_with_epsilon(s->outline->area, 80.0 * 80.0 + 5.0 * gap + 20.0 * 14.0 + 7.0 * gap, 10.0);
        skeleton_free(s);
    }
}

/* The base at the bottom of a narrow sinus stays, though the banks are too near to each other there. Two primaries near to it begin at it, one
 * of them along the bank. */
static void test_sinus(void)
{
    const Vec2 heart[] = {{0, 0}, {-0.1, -1}, {-2, -20}, {-40, -20}, {-40, 60}, {0, 80}, {40, 60}, {40, -20}, {2, -20}, {0.1, -1}};
    for (double tolerance = 0.0; tolerance < 0.5; tolerance += 0.4) {
        Sketch d = sketch_new();
        draw_vein(&d, draw_node(&d, vec2(0, 0.5)), (Vec2[]){{0, 70}}, 1, 1.0, 1, 2.0, 0.5);
        draw_vein(&d, draw_node(&d, vec2(0.3, -0.6)), (Vec2[]){{8, -18}}, 1, 1.0, 1, 1.0, 0.5);
        SkeletonDef def = plain_def();
        def.tolerance = tolerance;
        Skeleton *s = make(sketch_network(&d, heart, 10), &def);
        g_assert_true(on_outline(s, vec2(0, 0)));
        g_assert_cmpfloat(fabs(s->outline->area - 7160.0), <, 10.0);
        at(node_at(s, "midrib", 0), 0, 0);
        at(node_at(s, "P2", 0), 0, 0);
        at(tip_of(s, "P2"), 8, -18);
        g_assert_cmpuint(sequence(s, "P2")->parent, ==, NO_PARENT);
        skeleton_free(s);
    }
}

/* A winding channel, 3 wide, that comes in from the right: by a large tolerance its banks would cross each other. Where they would, they get points
 * back, and the channel stays. */
static void test_no_crossing(void)
{
    Vec2 v[400], bed[151];
    for (double tolerance = 0.5; tolerance < 40.0; tolerance *= 1.7) {
        uint32_t n = 0, open = 0;
        v[n++] = vec2(-40, 0);
        v[n++] = vec2(40, 0);
        for (int i = 0; i <= 150; i++)
            bed[i] = vec2(40.0 - 0.5 * i, 41.5 + 9.0 * ((i / 10) % 2 ? 1 : -1) * (1.0 - fabs((i % 10) / 5.0 - 1.0)));
        for (int i = 0; i <= 150; i++)
            v[n++] = vec_sub(bed[i], vec2(0, 1.5));
        for (int i = 150; i >= 0; i--)
            v[n++] = vec_add(bed[i], vec2(0, 1.5));
        v[n++] = vec2(40, 90);
        v[n++] = vec2(-40, 90);
        SkeletonDef def = plain_def();
        def.tolerance = tolerance;
        Sketch d = sketch_new();
        draw_vein(&d, draw_node(&d, vec2(0, 0)), (Vec2[]){{0, 25}}, 1, 1.0, 1, 1.0, 0.5);
        Skeleton *s = make(sketch_network(&d, v, n), &def);
        for (int i = 0; i <= 150; i++)
            open += !polygon_contains(s->outline, bed[i]);
        if (tolerance < 1.0 || (tolerance > 2.0 && tolerance < 5.0)) /* else the chords are apart but for pinches, which are closed */
            g_assert_cmpuint(open, >, 120);
        skeleton_free(s);
    }
}

/* ---- fictitious veins ---- */

static Skeleton *small_skeleton(void)
{
    Sketch d = sketch_new();
    draw_midrib(&d);
    draw_vein(&d, draw_nearest(&d, vec2(0, 20)), (Vec2[]){{30, 50}}, 1, 1.0, 2, 2.0, 0.5);
    draw_vein(&d, draw_nearest(&d, vec2(0, 50)), (Vec2[]){{-30, 80}}, 1, 1.0, 2, 2.0, 0.5);
    SkeletonDef def = plain_def();
    def.spacing = 12.0;
    return make(sketch_network(&d, diamond, 5), &def);
}

static double longest_edge(const Skeleton *s)
{
    double longest = 0.0;
    for (uint32_t i = 0; i < s->n_nodes; i++)
        longest = s->hinge[i] == NO_PARENT ? longest : MAX(longest, vec_dist(s->rest[i], s->rest[s->hinge[i]]));
    return longest;
}

static void test_fictitious(void)
{
    GError *error = NULL;
    Skeleton *s = small_skeleton();
    const Vec2 p[] = {{1, 33}, {-15, 45}, {-15, 49}, {30, 50}, {30, 60}, {-15, 48}, {-20, 45}};
    const uint32_t count[] = {3, 2, 2};
    Skeleton *t = skeleton_add_fictitious(s, p, count, 3, 1.0, &error);
    g_assert_no_error(error);
    check_skeleton(t);
    g_assert_cmpuint(t->n_sequences, ==, s->n_sequences + 3);
    g_assert_cmpstr(t->sequence[skeleton_find(t, "F1")].name, ==, "F1");
    g_assert_true(sequence(t, "F1")->fictitious);
    g_assert_cmpuint(sequence(t, "F1")->vein, ==, NO_PARENT);
    g_assert_cmpuint(sequence(t, "F1")->order, ==, 2);
    g_assert_cmpuint(sequence(t, "F2")->order, ==, 3);
    g_assert_cmpuint(sequence(t, "F1")->parent, ==, 0);
    g_assert_cmpuint(sequence(t, "F2")->parent, ==, skeleton_find(t, "R1"));
    g_assert_cmpuint(sequence(t, "F3")->parent, ==, skeleton_find(t, "F1")); /* they may branch */
    g_assert_cmpfloat(sequence(t, "F1")->base_radius, ==, 0.0);
    at(tip_of(t, "F1"), -15, 49);
    at(tip_of(t, "F2"), 30, 60);
    g_assert_cmpfloat(vec_dist(node_at(t, "F1", 0), vec2(1, 33)), <, 6.0);
    for (uint32_t i = 0; i < s->n_sequences; i++)
        g_assert_cmpstr(t->sequence[i].name, ==, s->sequence[i].name);
    g_assert_cmpfloat(longest_edge(t), <=, longest_edge(s) * (1.0 + 1e-9));
    skeleton_free(t);

    struct {
        Vec2 p[3];
        uint32_t n;
        const char *message;
    } bad[] = {{{{0, 30}, {0, 40}}, 1, "*F1 has 1 points*"},
               {{{0, 30}, {NAN, 40}}, 2, "*point 2 of fictitious vein F1 is nan,40*"},
               {{{0, 30}, {60, 40}}, 2, "*F1 comes too near to another vein*"},
               {{{0, 30}, {-60, 40}}, 2, "*F1 comes too near to the margin*"},
               {{{0, 30}, {20, 60}, {-20, 60}}, 3, "*too near to another vein*between 2,6 and -2,6; it must keep * away"},
               {{{0, 30}, {-10, 40}, {-5, 32}}, 3, NULL},
               {{{0, 30}, {0, 35}}, 2, "*too near to another vein*"}};
    for (uint32_t k = 0; k < G_N_ELEMENTS(bad); k++) {
        t = skeleton_add_fictitious(s, bad[k].p, &bad[k].n, 1, 10.0, &error);
        if (!bad[k].message) {
            g_assert_no_error(error);
            check_skeleton(t);
        } else {
            g_assert_null(t);
            g_assert_error(error, SKELETON_ERROR, SKELETON_ERROR_GRAPH);
            if (!g_pattern_match_simple(bad[k].message, error->message))
                g_error("'%s' instead of '%s'", error->message, bad[k].message);
            g_clear_error(&error);
        }
        skeleton_free(t);
    }
    t = skeleton_add_fictitious(s, NULL, NULL, 0, 1.0, &error);
    g_assert_no_error(error);
    g_assert_true(same(s, t));
    skeleton_free(t);
    skeleton_free(s);
}

/* ---- after meshing ---- */

/* What a mesher returns, as far as it matters: the graph with its segments cut into parts, segment k into 1 + k % 4. */
static Mesh *cut_graph(const Pslg *g)
{
    Mesh *m = g_new0(Mesh, 1);
    GArray *v = g_array_new(FALSE, FALSE, sizeof(Vec2));
    g_array_append_vals(v, g->point, g->n_points);
    m->vein = g_malloc_n((gsize)4 * g->n_segments, sizeof *m->vein);
    m->vein_input = g_new(uint32_t, 4 * g->n_segments);
    m->boundary = g_malloc_n((gsize)4 * g->n_outline, sizeof *m->boundary);
    m->boundary_input = g_new(uint32_t, 4 * g->n_outline);
    for (uint32_t k = 0; k < g->n_outline + g->n_segments; k++) {
        uint32_t a, b, parts = 1 + k % 4;
        ends(g, k, &a, &b);
        Vec2 from = g->point[a], to = g->point[b];
        for (uint32_t i = 1; i <= parts; i++) {
            Vec2 p = vec_lerp(from, to, (double)i / parts);
            uint32_t next = i == parts ? b : v->len;
            if (i < parts)
                g_array_append_val(v, p);
            uint32_t *edge = k < g->n_outline ? m->boundary[m->n_boundary] : m->vein[m->n_vein];
            edge[0] = a;
            edge[1] = a = next;
            if (k < g->n_outline)
                m->boundary_input[m->n_boundary++] = k;
            else
                m->vein_input[m->n_vein++] = k - g->n_outline;
        }
    }
    m->n_vertices = v->len;
    m->vertex = (Vec2 *)(void *)g_array_free(v, FALSE);
    return m;
}

static void cut_free(Mesh *m)
{
    g_free(m->vertex);
    g_free(m->vein);
    g_free(m->vein_input);
    g_free(m->boundary);
    g_free(m->boundary_input);
    g_free(m);
}

/* Between two old nodes of a sequence the radius goes evenly from one's to the other's; the first node's is the sequence's own, however
 * thick the parent is that owns the node. */
static void check_radii(const Skeleton *s, const Sequence *a, const Skeleton *t, const Sequence *b)
{
    g_assert_cmpfloat(a->base_radius, ==, b->base_radius);
    for (uint32_t i = 0, k = 1; i + 1 < a->n; i++) {
        Vec2 p = s->rest[s->at[a->first + i]], q = s->rest[s->at[a->first + i + 1]];
        double from = i == 0 ? a->base_radius : s->radius[s->at[a->first + i]], to = s->radius[s->at[a->first + i + 1]], part = 0.0;
        while (part < 1.0 - 1e-12) {
            uint32_t node = t->at[b->first + k++];
            part = vec_dist(p, t->rest[node]) / vec_dist(p, q);
            g_assert_cmpfloat_with_epsilon(t->radius[node], from + (to - from) * part, 1e-9);
        }
    }
}

static void check_refined(const Skeleton *s, const Pslg *g, const Mesh *mesh)
{
    Skeleton *t = skeleton_refine(s, mesh);
    t->least = 0.0; /* the mesher's nodes may be near to each other */
    check_skeleton(t);
    g_assert_cmpuint(t->n_sequences, ==, s->n_sequences);
    g_assert_cmpuint(t->n_nodes, ==, s->n_nodes + mesh->n_vein - g->n_segments);
    g_assert_cmpuint(t->outline->n, ==, mesh->n_boundary);
    uint32_t edges = 0, roots = 0;
    uint32_t *tail = g_new(uint32_t, mesh->n_vertices); /* of the mesh's vein edge that leads to a vertex */
    for (uint32_t e = 0; e < mesh->n_vein; e++)
        tail[mesh->vein[e][1]] = mesh->vein[e][0];
    for (uint32_t i = 0; i < t->n_nodes; i++) {
        g_assert_cmpuint(t->vertex[i], <, mesh->n_vertices);
        at(t->rest[i], mesh->vertex[t->vertex[i]].x, mesh->vertex[t->vertex[i]].y);
        roots += t->hinge[i] == NO_PARENT;
        edges += t->hinge[i] != NO_PARENT && tail[t->vertex[i]] == t->vertex[t->hinge[i]];
    }
    g_free(tail);
    g_assert_cmpuint(edges, ==, mesh->n_vein); /* every edge is a mesh edge, and all of them are there */
    g_assert_cmpuint(edges + roots, ==, t->n_nodes);
    for (uint32_t k = 0; k < s->n_sequences; k++) {
        const Sequence *a = &s->sequence[k], *b = &t->sequence[k];
        g_assert_cmpstr(a->name, ==, b->name);
        at(s->rest[s->at[a->first]], t->rest[t->at[b->first]].x, t->rest[t->at[b->first]].y);
        at(s->rest[s->at[a->first + a->n - 1]], t->rest[t->at[b->first + b->n - 1]].x, t->rest[t->at[b->first + b->n - 1]].y);
        g_assert_cmpfloat_with_epsilon(a->length, b->length, 1e-9);
        check_radii(s, a, t, b);
    }
    skeleton_free(t);
}

static void test_refine(void)
{
    Skeleton *s = small_skeleton();
    uint32_t *point = g_new(uint32_t, s->n_nodes);
    Pslg *g = skeleton_pslg(s, point);
    Mesh *mesh = cut_graph(g);
    check_refined(s, g, mesh);
    skeleton_free(s);
    cut_free(mesh);
    pslg_free(g);
    g_free(point);
}

/* Through the mesher itself. Returns the number of triangles. */
static uint32_t mesh_it(const Skeleton *s)
{
    GError *error = NULL;
    uint32_t *point = g_new(uint32_t, s->n_nodes);
    Pslg *g = skeleton_pslg(s, point);
    MeshDef def = {.min_angle = 20.0, .max_area = s->outline->area / 1000.0, .max_triangles = 200000};
    Mesh *mesh = mesh_new(g, &def, &error);
    g_assert_no_error(error);
    check_refined(s, g, mesh);
    uint32_t n = mesh->n_triangles;
    mesh_free(mesh);
    pslg_free(g);
    g_free(point);
    return n;
}

static void test_mesh(void)
{
    GError *error = NULL;
    Skeleton *s = small_skeleton();
    g_assert_cmpuint(mesh_it(s), >, 1000);
    const Vec2 p[] = {{1, 33}, {-15, 45}, {-15, 49}};
    Skeleton *t = skeleton_add_fictitious(s, p, (uint32_t[]){3}, 1, 1.0, &error);
    g_assert_no_error(error);
    mesh_it(t);
    skeleton_free(t);
    skeleton_free(s);
}

/* ---- bad input ---- */

static void refuse(Network *net, const char *pattern, SkeletonError code)
{
    GError *error = NULL;
    SkeletonDef def = plain_def();
    Skeleton *s = skeleton_new(net, &def, &error);
    g_assert_null(s);
    g_assert_error(error, SKELETON_ERROR, (int)code);
    if (!g_pattern_match_simple(pattern, error->message))
        g_error("'%s' instead of '%s'", error->message, pattern);
    g_clear_error(&error);
    network_free(net);
}

/* Node 0 at the base, 1 … 9 up the middle, each edge k from k to k + 1. */
static Network *ladder(void)
{
    Sketch d = sketch_new();
    draw_vein(&d, draw_node(&d, vec2(0, 0)), (Vec2[]){{0, 90}}, 1, 10.0, 1, 1.0, 1.0);
    return sketch_network(&d, square, 4);
}

static void test_bad(void)
{
    Network *net = ladder();
    net->node[4].y = NAN;
    refuse(net, "node 4 lies at (0, nan)*", SKELETON_ERROR_GRAPH);
    net = ladder();
    net->head[3] = 77;
    refuse(net, "edge 3 runs from node 3 to node 77; there are nodes 0 to 9 only", SKELETON_ERROR_GRAPH);
    net = ladder();
    net->node[5] = net->node[4];
    refuse(net, "edge 4 from node 4 to node 5 has no length*", SKELETON_ERROR_GRAPH);
    net = ladder();
    net->head[2] = net->tail[2];
    refuse(net, "edge 2 from node 2 to node 2 has no length*", SKELETON_ERROR_GRAPH);
    net = ladder();
    net->width[6] = -1.0;
    refuse(net, "edge 6 from node 6 to node 7 is -1 wide*", SKELETON_ERROR_GRAPH);
    net = ladder();
    net->width[6] = NAN;
    refuse(net, "edge 6*nan wide*", SKELETON_ERROR_GRAPH);
    net = ladder();
    net->order[1] = 0;
    refuse(net, "edge 1*order 0*", SKELETON_ERROR_GRAPH);
    net = ladder();
    net->head[8] = 3; /* 3 … 8 → 3 */
    refuse(net, "edge * closes a cycle*", SKELETON_ERROR_GRAPH);
    net = ladder();
    net->head[8] = 0; /* all of it one cycle, node 9 alone */
    refuse(net, "edge * closes a cycle*", SKELETON_ERROR_GRAPH);
    net = ladder();
    net->head[8] = 3;
    net->kind[8] = EDGE_ANASTOMOSIS; /* which may close one */
    SkeletonDef def = plain_def();
    skeleton_free(make(net, &def));
    net = ladder();
    g_clear_pointer(&net->margin, polygon_free);
    refuse(net, "the network has no margin*", SKELETON_ERROR_GRAPH);
    net = ladder();
    polygon_free(net->margin);
    net->margin = polygon_new((Vec2[]){{-50, 0}, {50, 100}, {50, 0}, {-50, 80}}, 4);
    refuse(net, "the margin crosses or touches itself: the edges from points 1 at (-50, 80) and 3 at (50, 100) meet", SKELETON_ERROR_GRAPH);
    net = ladder();
    polygon_free(net->margin);
    net->margin = polygon_new((Vec2[]){{0, 0}, {0, 50}, {0, 100}}, 3);
    refuse(net, "the margin encloses no area", SKELETON_ERROR_GRAPH);
    net = ladder();
    net->margin->v[2].x = INFINITY;
    refuse(net, "margin point 2 lies at (inf, 100)*", SKELETON_ERROR_GRAPH);
    net = ladder();
    for (uint32_t i = 0; i < net->n_nodes; i++)
        net->node[i].x += 200.0;
    refuse(net, "no vein is left*", SKELETON_ERROR_EMPTY);
    net = ladder();
    for (uint32_t i = 0; i < net->n_edges; i++)
        net->order[i] = 7;
    refuse(net, "no vein is left*of order up to 3*", SKELETON_ERROR_EMPTY);
    refuse(network_new(0, 0), "the network has no margin*", SKELETON_ERROR_GRAPH);
    net = network_new(1, 0);
    net->margin = polygon_new(square, 4);
    refuse(net, "the network has no veins", SKELETON_ERROR_EMPTY);
    net = ladder();
    polygon_free(net->margin); /* repeated points are no fault */
    net->margin = polygon_new((Vec2[]){{-50, 0}, {-50, 0}, {50, 0}, {50, 100}, {50, 100}, {50, 100}, {-50, 100}, {-50, 0}}, 8);
    skeleton_free(make(net, &def));
    net = ladder();
    polygon_free(net->margin);
    net->margin = polygon_new((Vec2[]){{-0.1, 0}, {0.1, 0}, {0.1, 100}, {-0.1, 100}}, 4); /* a thread */
    refuse(net, "*", SKELETON_ERROR_EMPTY);
}

/* A node that two edges lead to was grown by the wider one; the other ends before it. */
static void test_two_parents(void)
{
    for (int wide = 0; wide < 2; wide++) {
        Sketch d = sketch_new();
        draw_midrib(&d);
        uint32_t a = draw_vein(&d, draw_nearest(&d, vec2(0, 20)), (Vec2[]){{20, 40}}, 1, 1.0, 2, 2.0, 2.0);
        uint32_t b = draw_vein(&d, draw_nearest(&d, vec2(0, 60)), (Vec2[]){{20, 46}}, 1, 1.0, 2, 2.0, 2.0);
        uint32_t meet = draw_node(&d, vec2(21, 43));
        draw_edge(&d, a, meet, EDGE_VEIN, wide ? 1.0 : 3.0, 2, 1);
        draw_edge(&d, b, meet, EDGE_VEIN, 2.0, 2, 2);
        uint32_t end = draw_node(&d, vec2(40, 43));
        draw_edge(&d, meet, end, EDGE_VEIN, 2.0, 2, wide ? 2 : 1);
        SkeletonDef def = plain_def();
        Skeleton *s = make(sketch_network(&d, square, 4), &def);
        g_assert_cmpuint(s->n_sequences, ==, 3);
        at(tip_of(s, wide ? "R2" : "R1"), 40, 43);
        at(tip_of(s, wide ? "R1" : "R2"), 20, wide ? 40 : 46);
        skeleton_free(s);
    }
}

/* Edges of one vein that part: the widest goes on, the other begins a sequence. Node numbers need not rise along a vein. */
static void test_odd_veins(void)
{
    Sketch d = sketch_new();
    const Vec2 p[] = {{0, 90}, {0, 50}, {0, 0}, {30, 80}};
    for (int i = 0; i < 4; i++)
        draw_node(&d, p[i]);
    draw_edge(&d, 1, 0, EDGE_VEIN, 1.0, 1, 0);
    draw_edge(&d, 1, 3, EDGE_VEIN, 1.5, 1, 0);
    draw_edge(&d, 2, 1, EDGE_VEIN, 2.0, 1, 0);
    d.n_veins = 1;
    SkeletonDef def = plain_def();
    Skeleton *s = make(sketch_network(&d, square, 4), &def);
    g_assert_cmpuint(s->n_sequences, ==, 2);
    at(tip_of(s, "midrib"), 30, 80);
    at(tip_of(s, "P2"), 0, 90);
    g_assert_cmpuint(sequence(s, "P2")->parent, ==, 0);
    skeleton_free(s);
}

/* ---- random networks ---- */

static uint32_t star_blade(Vec2 *v, uint32_t run)
{
    uint32_t n = 4 + (uint32_t)(uniform(1, run, 0) * (run % 3 == 0 ? 12.0 : 200.0));
    double least = run % 4 == 0 ? 0.2 : run % 4 == 1 ? 0.6 : 0.9;
    for (uint32_t i = 0; i < n; i++) {
        double t = 4.0 * i / n, s = t - floor(t), r = least + (1.0 - least) * uniform(1, run, i + 1);
        const Vec2 walk[4] = {{1, 2 * s - 1}, {1 - 2 * s, 1}, {-1, 1 - 2 * s}, {2 * s - 1, -1}};
        v[i] = vec_add(vec2(0, 45), vec_scale(walk[(int)t], 50.0 * r));
    }
    return n;
}

/* Veins that wander, run into each other and out of the blade, and branch at every angle, hair's and backward ones too. */
static Network *random_network(uint32_t run)
{
    Vec2 blade[256];
    uint32_t n_blade = star_blade(blade, run), draw = 0;
    Sketch d = sketch_new();
    uint32_t primaries = 1 + run % 4, veins = primaries + (uint32_t)(uniform(2, run, draw++) * 60.0);
    double step = run % 5 == 0 ? 8.0 : 1.0, sway = run % 2 ? 0.1 : 0.5;
    for (uint32_t k = 0; k < veins; k++) {
        uint32_t from, order = 1;
        Vec2 way = vec2(uniform(2, run, draw) - 0.5, uniform(2, run, draw + 1) - (k < primaries ? 0.0 : 0.5));
        if (k < primaries) {
            Vec2 base = run % 3 == 0 ? blade[0] : vec2(30.0 * (uniform(2, run, draw + 2) - 0.5), 10.0 * uniform(2, run, draw + 3));
            from = draw_node(&d, base);
            way = vec_add(way, vec_scale(vec_sub(vec2(0, 45), base), 0.03)); /* mostly inwards */
        } else {
            uint32_t edge = (uint32_t)(uniform(2, run, draw + 2) * d.tail->len);
            from = g_array_index(d.head, uint32_t, edge);
            order = g_array_index(d.order, uint8_t, edge) + (uniform(2, run, draw + 3) < 0.8);
            if (uniform(2, run, draw + 4) < 0.3) { /* along the parent, or back, by a hair */
                Vec2 a = g_array_index(d.node, Vec2, g_array_index(d.tail, uint32_t, edge)), b = g_array_index(d.node, Vec2, from);
                way = vec_add(vec_scale(vec_sub(b, a), k % 2 ? 1.0 : -1.0), vec_scale(way, 0.02));
            }
        }
        draw += 5;
        uint32_t length = (uint32_t)(((k < primaries ? 40.0 : 0.0) + uniform(2, run, draw++) * 90.0) / step) + 1, node = from;
        for (uint32_t i = 0; i < length; i++, draw += 2) {
            way = vec_add(way, vec_scale(vec2(uniform(2, run, draw) - 0.5, uniform(2, run, draw + 1) - 0.5), sway * sqrt(vec_norm2(way))));
            way = vec_scale(way, step / sqrt(vec_norm2(way)));
            uint32_t next = draw_node(&d, vec_add(g_array_index(d.node, Vec2, node), way));
            draw_edge(&d, node, next, EDGE_VEIN, 3.0 / order, (uint8_t)order, k);
            node = next;
        }
        if (uniform(2, run, draw++) < 0.2 && d.node->len > 10)
            draw_edge(&d, (uint32_t)(uniform(2, run, draw) * d.node->len), node, EDGE_ANASTOMOSIS, 0.5, 4, k);
    }
    d.n_veins = veins;
    return sketch_network(&d, blade, n_blade);
}

static SkeletonDef random_def(uint32_t run)
{
    const double tolerance[] = {0.0, 0.1, 0.5, 3.0}, spacing[] = {0.0, 0.3, 5.0, 12.0}, clearance[] = {0.0, 0.05, 0.8, 1.0, 2.0, 6.0};
    const double angle[] = {0.0, 2.0, 15.0, 30.0, 60.0}, length[] = {0.0, 2.0, 8.0, 20.0};
    return (SkeletonDef){.max_order = run % 5 == 0 ? 9 : run % 5, .tolerance = tolerance[run % 4], .spacing = spacing[(run / 4) % 4],
                         .clearance = clearance[(run / 7) % 6], .min_angle = angle[(run / 3) % 5], .min_length = length[(run / 11) % 4]};
}

static void test_random(void)
{
    const uint32_t runs = g_test_thorough() ? 20000 : 1200;
    uint32_t made = 0, sequences = 0;
    for (uint32_t run = 0; run < runs; run++) {
        Network *net = random_network(run);
        SkeletonDef def = random_def(run);
        GError *error = NULL;
        Skeleton *s = skeleton_new(net, &def, &error), *again = s ? skeleton_new(net, &def, &error) : NULL;
        if (s) {
            g_assert_no_error(error);
            check_made(s, &def);
            g_assert_true(same(s, again));
            made++;
            sequences += s->n_sequences;
        } else {
            g_assert_error(error, SKELETON_ERROR, SKELETON_ERROR_EMPTY);
            g_clear_error(&error);
        }
        skeleton_free(s);
        skeleton_free(again);
        network_free(net);
    }
    g_test_message("%u of %u networks gave a skeleton, of %.1f sequences", made, runs, (double)sequences / made);
    g_assert_cmpuint(made, >, runs * 3 / 4);
    g_assert_cmpuint(sequences, >, 3 * made);
}

/* ---- grown leaves ---- */

typedef struct {
    const char *name, *set; /* "key=value …" */
    uint32_t least, most;   /* sequences */
    uint32_t primaries;     /* at least */
} Model;

static const Model models[] = {
    {"poplar", "growth.final_length=900", 20, 80, 1},
    {"sweetgum", "growth.initial_length=100 growth.final_length=700 growth.step=1.2 sources.density=0.05 veins.kill_distance=18", 15, 140, 5},
    {"ginkgo", "growth.final_length=900", 8, 80, 2},
    {"cherry", "growth.final_length=1200", 5, 80, 1},
    {"toothed", "growth.initial_length=127 growth.final_length=500", 10, 80, 1},
    {"reticulate", "growth.initial_length=150 growth.final_length=1500", 15, 80, 1},
    {"orchid", "growth.initial_length=1200", 8, 80, 1},
    {"grass", "growth.initial_length=2600 veins.seed_row=11", 5, 30, 5},
    {"trillium", "growth.initial_length=900", 10, 80, 3},
    {"alchemilla", "growth.initial_length=600 growth.final_length=900 growth.step=4 sources.density=0.0008", 10, 120, 5},
    {"tertiary", "growth.initial_length=100 growth.final_length=400", 5, 120, 1},
};

static Network *grow(const Model *model, VenLeaf **leaf)
{
    GError *error = NULL;
    char *file = g_strconcat(model->name, ".ini", NULL), *path = g_test_build_filename(G_TEST_DIST, "..", "..", "params", file, NULL);
    VenParams *params = ven_params_load(path, &error);
    g_assert_no_error(error);
    char **set = g_strsplit(model->set, " ", 0);
    for (char **s = set; *s; s++) {
        char **pair = g_strsplit(*s, "=", 2);
        ven_params_set(params, pair[0], pair[1], &error);
        g_assert_no_error(error);
        g_strfreev(pair);
    }
    *leaf = ven_grow(params, 1, NULL, &error);
    g_assert_no_error(error);
    ven_params_free(params);
    g_strfreev(set);
    g_free(file);
    g_free(path);
    return (*leaf)->net;
}

static void test_leaf(gconstpointer data)
{
    const Model *model = data;
    VenLeaf *leaf;
    GError *error = NULL;
    Network *net = grow(model, &leaf);
    double length = net->margin->box.y1 - net->margin->box.y0;
    SkeletonDef def = skeleton_def_default(length);
    gint64 start = g_get_monotonic_time();
    Skeleton *s = skeleton_new(net, &def, &error);
    double ms = (double)(g_get_monotonic_time() - start) / 1e3;
    g_assert_no_error(error);
    check_made(s, &def);
    uint32_t triangles = mesh_it(s);
    g_test_message("%s: %u network nodes in %.1f ms: %u sequences, %u nodes, %u outline points; %u triangles", model->name, net->n_nodes, ms,
                   s->n_sequences, s->n_nodes, s->outline->n, triangles);
    g_assert_cmpuint(s->n_sequences, >=, model->least);
    g_assert_cmpuint(s->n_sequences, <=, model->most);
    g_assert_cmpuint(s->n_nodes, <=, 1200);
    uint32_t primaries = 0;
    double raw = 0.0, kept = 0.0;
    for (uint32_t i = 0; i < s->n_sequences; i++) {
        primaries += s->sequence[i].order == 1;
        kept += s->sequence[i].order == 1 ? s->sequence[i].length : 0.0;
    }
    for (uint32_t e = 0; e < net->n_edges; e++)
        raw += net->order[e] == 1 && net->kind[e] == EDGE_VEIN ? vec_dist(net->node[net->tail[e]], net->node[net->head[e]]) : 0.0;
    g_assert_cmpuint(primaries, >=, model->primaries);
    g_assert_cmpfloat(kept, >, 0.65 * raw); /* major veins are not lost */
    g_assert_cmpfloat_with_epsilon(s->outline->area, net->margin->area, 0.03 * net->margin->area);
    g_assert_cmpfloat_with_epsilon(s->outline->box.y1, net->margin->box.y1, 1e-9 * length);
    for (double scale = 0.3; scale < 4.0; scale *= 1.6) { /* other settings of the same leaf */
        SkeletonDef other = {.max_order = 4, .tolerance = scale * def.tolerance, .spacing = scale * def.spacing, .clearance = scale * def.clearance,
                             .min_angle = 12.0 * scale, .min_length = 0.5 * scale * def.min_length};
        Skeleton *t = skeleton_new(net, &other, &error);
        g_assert_no_error(error);
        check_made(t, &other);
        skeleton_free(t);
    }
    skeleton_free(s);
    ven_leaf_free(leaf);
}

/* A million nodes: a midrib, combs of secondaries and tertiaries, twigs. */
static void test_large(void)
{
    Sketch d = sketch_new();
    uint32_t mid = draw_node(&d, vec2(0, 0));
    const Vec2 margin[4] = {{0, 0}, {2000, 2000}, {0, 4000}, {-2000, 2000}};
    GArray *spine = g_array_new(FALSE, FALSE, sizeof(uint32_t));
    for (int i = 0; i < 3800; i++) {
        uint32_t next = draw_node(&d, vec2(0.4 * uniform(3, 0, (uint64_t)i), i + 1.0));
        draw_edge(&d, mid, next, EDGE_VEIN, 30.0, 1, 0);
        mid = next;
        g_array_append_val(spine, mid);
    }
    d.n_veins = 1;
    for (uint32_t i = 5; i < spine->len && d.node->len < 1000000; i += 5) {
        double room = 0.9 * MIN(i, 4000.0 - i) - 2.0, side_ = i % 2 ? 1.0 : -1.0;
        Vec2 tip = vec2(side_ * 0.5 * room, i + 0.3 * room);
        uint32_t first = d.node->len, n;
        draw_vein(&d, g_array_index(spine, uint32_t, i), &tip, 1, 1.0, 2, 10.0, 1.0);
        n = d.node->len;
        for (uint32_t k = first; k < n && d.node->len < 1000000; k += 2) {
            Vec2 end = vec_add(g_array_index(d.node, Vec2, k), vec2(0.7 * uniform(4, i, k), 4.0));
            draw_vein(&d, k, &end, 1, 1.0, 3, 1.0, 0.5);
        }
    }
    g_array_free(spine, TRUE);
    Network *net = sketch_network(&d, margin, 4);
    SkeletonDef def = skeleton_def_default(4000.0);
    gint64 start = g_get_monotonic_time();
    GError *error = NULL;
    Skeleton *s = skeleton_new(net, &def, &error);
    double seconds = (double)(g_get_monotonic_time() - start) / 1e6;
    g_assert_no_error(error);
    check_made(s, &def);
    g_test_message("%u nodes in %.3f s: %u sequences, %u nodes", net->n_nodes, seconds, s->n_sequences, s->n_nodes);
    g_assert_cmpfloat(seconds, <, 20.0); /* far above what it takes, far below what a quadratic step would */
    skeleton_free(s);
    network_free(net);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/skeleton/fault", test_fault);
    g_test_add_func("/skeleton/pinnate", test_pinnate);
    g_test_add_func("/skeleton/spacing", test_spacing);
    g_test_add_func("/skeleton/palmate", test_palmate);
    g_test_add_func("/skeleton/row", test_row);
    g_test_add_func("/skeleton/bases", test_bases);
    g_test_add_func("/skeleton/hair-angle", test_hair_angle);
    g_test_add_func("/skeleton/merge", test_merge);
    g_test_add_func("/skeleton/crossing", test_crossing);
    g_test_add_func("/skeleton/stump", test_stump);
    g_test_add_func("/skeleton/hook", test_hook);
    g_test_add_func("/skeleton/tips", test_tips);
    g_test_add_func("/skeleton/curl", test_curl);
    g_test_add_func("/skeleton/itself", test_itself);
    g_test_add_func("/skeleton/branch-at-tip", test_branch_at_tip);
    g_test_add_func("/skeleton/orphans", test_orphans);
    g_test_add_func("/skeleton/teeth", test_teeth);
    g_test_add_func("/skeleton/slits", test_slits);
    g_test_add_func("/skeleton/sinus", test_sinus);
    g_test_add_func("/skeleton/no-crossing", test_no_crossing);
    g_test_add_func("/skeleton/fictitious", test_fictitious);
    g_test_add_func("/skeleton/refine", test_refine);
    g_test_add_func("/skeleton/mesh", test_mesh);
    g_test_add_func("/skeleton/bad", test_bad);
    g_test_add_func("/skeleton/two-parents", test_two_parents);
    g_test_add_func("/skeleton/odd-veins", test_odd_veins);
    g_test_add_func("/skeleton/random", test_random);
    for (uint32_t i = 0; i < G_N_ELEMENTS(models); i++) {
        char *path = g_strconcat("/skeleton/leaf/", models[i].name, NULL);
        g_test_add_data_func(path, &models[i], test_leaf);
        g_free(path);
    }
    g_test_add_func("/skeleton/large", test_large);
    return g_test_run();
}
