/* The outline of a skeleton: the margin with fewer points (Hong 2005, § 5.3) and no two parts of it so near that a mesher would choke. */
#include <string.h>

#include "geom/segment.h"
#include "geom/simplify.h"
#include "shape/skeleton_field.h"
#include "shape/skeleton_private.h"

/* ---- the network's margin ---- */

static uint32_t copy_distinct(const Polygon *p, Vec2 *v)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < p->n; i++)
        if (n == 0 || vec_dist2(p->v[i], v[n - 1]) > 0.0)
            v[n++] = p->v[i];
    while (n > 1 && !(vec_dist2(v[n - 1], v[0]) > 0.0))
        n--;
    return n;
}

Polygon *outline_checked(const Network *net, GError **error)
{
    uint32_t i, j;
    const Polygon *m = net->margin;
    if (!m || m->n < 3) {
        g_set_error(error, SKELETON_ERROR, SKELETON_ERROR_GRAPH, "the network has no margin: its outline has %u points, and at least 3 are needed",
                    m ? m->n : 0);
        return NULL;
    }
    for (i = 0; i < m->n; i++)
        if (!isfinite(m->v[i].x) || !isfinite(m->v[i].y)) {
            g_set_error(error, SKELETON_ERROR, SKELETON_ERROR_GRAPH, "margin point %u lies at (%g, %g); positions must be finite", i, m->v[i].x,
                        m->v[i].y);
            return NULL;
        }
    Vec2 *v = g_new(Vec2, m->n);
    uint32_t n = copy_distinct(m, v);
    Polygon *p = n >= 3 ? polygon_new(v, n) : NULL;
    g_free(v);
    if (!p || !(p->area > 0.0)) {
        g_set_error_literal(error, SKELETON_ERROR, SKELETON_ERROR_GRAPH, "the margin encloses no area");
        g_clear_pointer(&p, polygon_free);
    } else if (polygon_crossing(p, &i, &j)) {
        Vec2 a = p->v[i], b = p->v[j];
        g_set_error(error, SKELETON_ERROR, SKELETON_ERROR_GRAPH,
                    "the margin crosses or touches itself: the edges from points %u at (%g, %g) and %u at (%g, %g) meet", i, a.x, a.y, j, b.x, b.y);
        g_clear_pointer(&p, polygon_free);
    }
    return p;
}

Vec2 outline_nearest(const Polygon *p, Vec2 q, uint32_t *edge)
{
    double least = HUGE_VAL;
    Vec2 best = p->v[0];
    *edge = 0;
    for (uint32_t i = 0; i < p->n; i++) {
        Vec2 a = p->v[i], b = p->v[i + 1 < p->n ? i + 1 : 0];
        double t = segment_nearest(a, b, q);
        Vec2 at = t == 1.0 ? b : vec_lerp(a, b, t);
        double d = vec_dist2(at, q);
        if (d < least) {
            least = d;
            best = at;
            *edge = i;
        }
    }
    return best;
}

/* ---- a ring of points that are worth more or less ---- */

enum { PLAIN, EXTREME, WANTED, BASE };

typedef struct {
    uint32_t n;
    Vec2 *p;
    uint8_t *rank;
} Ring;

static void ring_clear(Ring *r)
{
    g_free(r->p);
    g_free(r->rank);
}

static void ring_raise(Ring *r, uint32_t i, uint8_t rank) { r->rank[i] = MAX(r->rank[i], rank); }

static void ring_insert(Ring *r, uint32_t at, Vec2 p, uint8_t rank)
{
    memmove(r->p + at + 1, r->p + at, (r->n - at) * sizeof *r->p);
    memmove(r->rank + at + 1, r->rank + at, r->n - at);
    r->p[at] = p;
    r->rank[at] = rank;
    r->n++;
}

static uint32_t ring_nearest_vertex(const Ring *r, Vec2 q)
{
    uint32_t best = 0;
    for (uint32_t i = 1; i < r->n; i++)
        if (vec_dist2(r->p[i], q) < vec_dist2(r->p[best], q))
            best = i;
    return best;
}

/* A vertex at q, which lies on the ring; none when a wanted one is nearer than `least` already. */
static void ring_want(Ring *r, Vec2 q, double least)
{
    uint32_t best = 0, v = ring_nearest_vertex(r, q);
    double nearest = HUGE_VAL;
    for (uint32_t i = 0; i < r->n; i++) {
        if (r->rank[i] >= WANTED && vec_dist2(r->p[i], q) < least * least)
            return;
        double d = segment_dist2(r->p[i], r->p[i + 1 < r->n ? i + 1 : 0], q);
        if (d < nearest) {
            nearest = d;
            best = i;
        }
    }
    if (!(vec_dist2(r->p[v], q) > 0.0))
        ring_raise(r, v, WANTED);
    else
        ring_insert(r, best + 1, q, WANTED);
}

/* The ring begins at its vertex nearest to `base`. The tip, as the vertex farthest from there, and the extremes keep the leaf its size. */
static Ring ring_new(const Polygon *margin, Vec2 base, const Vec2 *keep, uint32_t n_keep, double least)
{
    Ring all = {margin->n, g_new(Vec2, margin->n + n_keep), g_new0(uint8_t, margin->n + n_keep)};
    memcpy(all.p, margin->v, margin->n * sizeof *all.p);
    for (uint32_t k = 0; k < n_keep; k++)
        ring_want(&all, keep[k], least);
    uint32_t first = ring_nearest_vertex(&all, base), most[5] = {first, first, first, first, first};
    ring_raise(&all, first, BASE);
    for (uint32_t i = 0; i < all.n; i++) {
        const Vec2 p = all.p[i], b = all.p[first];
        most[0] = vec_dist2(p, b) > vec_dist2(all.p[most[0]], b) ? i : most[0];
        most[1] = p.x < all.p[most[1]].x ? i : most[1];
        most[2] = p.x > all.p[most[2]].x ? i : most[2];
        most[3] = p.y < all.p[most[3]].y ? i : most[3];
        most[4] = p.y > all.p[most[4]].y ? i : most[4];
    }
    for (int k = 0; k < 5; k++)
        ring_raise(&all, most[k], EXTREME);
    Ring r = {all.n, g_new(Vec2, all.n + 1), g_new(uint8_t, all.n + 1)};
    for (uint32_t i = 0; i < all.n; i++) {
        r.p[i] = all.p[(first + i) % all.n];
        r.rank[i] = all.rank[(first + i) % all.n];
    }
    r.p[r.n] = r.p[0]; /* closes the polyline that is simplified */
    r.rank[r.n] = BASE;
    ring_clear(&all);
    return r;
}

/* ---- simplification ---- */

static Polygon *ring_polygon(const Ring *r, const uint32_t *keep, uint32_t n)
{
    Vec2 *v = g_new(Vec2, n);
    for (uint32_t i = 0; i < n; i++)
        v[i] = r->p[keep[i]];
    Polygon *p = polygon_new(v, n);
    g_free(v);
    return p;
}

/* The point that strays farthest from the chord between two kept ones; NONE when there is none between. */
static uint32_t farthest(const Ring *r, uint32_t from, uint32_t to)
{
    uint32_t best = NONE;
    double most = -1.0;
    for (uint32_t k = from + 1; k < to; k++) {
        double d = segment_dist2(r->p[from], r->p[to], r->p[k]);
        if (d > most) {
            most = d;
            best = k;
        }
    }
    return best;
}

/* Takes the point that strays most from chord i back in. keep[n] is the end of the ring. */
static bool refine_chord(const Ring *r, uint32_t *keep, uint32_t *n, uint32_t i)
{
    uint32_t k = farthest(r, keep[i], keep[i + 1]);
    if (k == NONE)
        return false;
    memmove(keep + i + 2, keep + i + 1, (*n - i) * sizeof *keep);
    keep[i + 1] = k;
    ++*n;
    return true;
}

/* Where the simplified ring crosses itself both chords get points back until it doesn't: the margin itself does not cross. */
static uint32_t uncross(const Ring *r, uint32_t *keep, uint32_t n)
{
    for (bool more = true; more;) {
        uint32_t i, j;
        Polygon *p = n >= 3 ? ring_polygon(r, keep, n) : NULL;
        if (!p) { /* all within the tolerance of one chord: two points enclose nothing */
            more = refine_chord(r, keep, &n, 0) || (n > 1 && refine_chord(r, keep, &n, 1));
        } else if (!polygon_crossing(p, &i, &j)) {
            more = false;
        } else { /* a polygon that came out clockwise was turned round, its first point kept */
            bool turned = p->v[1].x != r->p[keep[1]].x || p->v[1].y != r->p[keep[1]].y;
            if (turned) {
                uint32_t t = n - 1 - j;
                j = n - 1 - i;
                i = t;
            }
            bool later = refine_chord(r, keep, &n, j);
            more = refine_chord(r, keep, &n, i) || later;
        }
        polygon_free(p);
    }
    return n;
}

/* Leaves out points nearer than `least` to the one before, the lesser of the two. */
static void thin(Ring *r, double least)
{
    uint32_t n = 1;
    double least2 = least * least;
    for (uint32_t i = 1; i < r->n; i++) {
        if (vec_dist2(r->p[i], r->p[n - 1]) >= least2)
            n++;
        else if (n < 2 || r->rank[i] <= r->rank[n - 1] || vec_dist2(r->p[i], r->p[n - 2]) < least2)
            continue;
        r->p[n - 1] = r->p[i];
        r->rank[n - 1] = r->rank[i];
    }
    while (n > 1 && vec_dist2(r->p[n - 1], r->p[0]) < least2)
        n--;
    r->n = n;
}

/* ---- pinches ---- */

static void fill_field(Field *f, const Ring *r)
{
    Box2 box = box_empty();
    for (uint32_t i = 0; i < r->n; i++)
        box = box_add(box, r->p[i]);
    field_init(f, box);
    for (uint32_t i = 0; i < r->n; i++)
        field_add_node(f, r->p[i], true);
    for (uint32_t i = 0; i < r->n; i++)
        field_add_edge(f, i, (i + 1) % r->n, 0);
}

/* Two parts of the ring too near to each other, to be joined: cutting out the points from + 1 … to. Edge i crosses edge j, or point i is nearer
 * than `least` to edge j. */
typedef struct {
    uint32_t i, j;
    bool cross;
} Pinch;

static bool find_pinch(Field *f, const Ring *r, double least, uint32_t i, Pinch *pinch)
{
    uint32_t n, next = (i + 1) % r->n;
    const uint32_t *near = field_near(f, r->p[i], r->p[next], least, &n);
    *pinch = (Pinch){i, NONE, false};
    for (uint32_t k = 0; k < n; k++) {
        FieldEdge e = field_edge(f, near[k]);
        if (e.a == i || e.b == i || near[k] > pinch->j)
            continue;
        bool cross = e.a != next && e.b != next && field_cross(r->p[i], r->p[next], r->p[e.a], r->p[e.b]);
        if (cross || segment_dist2(r->p[e.a], r->p[e.b], r->p[i]) < least * least)
            *pinch = (Pinch){i, near[k], cross};
    }
    return pinch->j != NONE;
}

/* What is lost by cutting the points from + 1 … to: the best rank among them, and the area between them and the shortcut. */
static double loop_loss(const Ring *r, uint32_t from, uint32_t to, uint8_t *rank)
{
    double twice = 0.0;
    *rank = PLAIN;
    Vec2 o = r->p[from];
    for (uint32_t k = (from + 1) % r->n;; k = (k + 1) % r->n) {
        *rank = MAX(*rank, r->rank[k]);
        twice += vec_cross(vec_sub(r->p[k], o), vec_sub(r->p[(k + 1) % r->n], o));
        if (k == to)
            return fabs(twice);
    }
}

static void cut_loop(Ring *r, uint32_t from, uint32_t to)
{
    uint32_t n = 0, drop = (to + r->n - from) % r->n;
    for (uint32_t i = 0; i < r->n; i++) {
        if ((i + r->n - from - 1) % r->n < drop)
            continue;
        r->p[n] = r->p[i];
        r->rank[n] = r->rank[i];
        n++;
    }
    r->n = n;
}

/* Of the two loops that the ring falls into at a pinch the smaller is cut off: a slit is closed, a neck with what it holds goes. When that would cost
 * a point where a vein begins, as at the bottom of a narrow sinus, the lesser of the points that are too near goes instead. */
static void mend(Ring *r, Pinch c)
{
    uint32_t next = (c.j + 1) % r->n, a0 = c.i, a1 = c.j, b0 = c.j, b1 = c.cross ? c.i : (c.i + r->n - 1) % r->n;
    uint8_t rank_a, rank_b;
    double a = loop_loss(r, a0, a1, &rank_a), b = loop_loss(r, b0, b1, &rank_b);
    uint32_t least = r->rank[c.j] < r->rank[c.i] ? c.j : c.i;
    least = r->rank[next] < r->rank[least] ? next : least;
    if ((a <= b ? rank_a : rank_b) >= WANTED && r->rank[least] < WANTED)
        cut_loop(r, (least + r->n - 1) % r->n, least);
    else if (a <= b)
        cut_loop(r, a0, a1);
    else
        cut_loop(r, b0, b1);
}

static void unpinch(Ring *r, double least)
{
    for (uint32_t i = 0; r->n >= 3;) {
        Field f;
        Pinch pinch;
        bool found = false;
        fill_field(&f, r);
        for (i = 0; i < r->n && !found; i++)
            found = find_pinch(&f, r, least, i, &pinch);
        field_clear(&f);
        if (!found)
            return;
        mend(r, pinch);
    }
}

Polygon *outline_simplify(const Polygon *margin, Vec2 base, const Vec2 *wanted, uint32_t n_wanted, double tolerance, double least, GError **error)
{
    Ring r = ring_new(margin, base, wanted, n_wanted, least);
    bool *must = g_new(bool, r.n + 1);
    uint32_t *keep = g_new(uint32_t, r.n + 2);
    for (uint32_t i = 0; i <= r.n; i++)
        must[i] = r.rank[i] > PLAIN;
    uint32_t n = uncross(&r, keep, simplify_polyline(r.p, r.n + 1, tolerance, must, keep) - 1);
    for (uint32_t i = 0; i < n; i++) { /* keep[i] >= i */
        r.p[i] = r.p[keep[i]];
        r.rank[i] = r.rank[keep[i]];
    }
    r.n = n;
    thin(&r, least);
    unpinch(&r, least);
    Polygon *p = r.n >= 3 ? polygon_new(r.p, r.n) : NULL;
    if (!p)
        g_set_error(error, SKELETON_ERROR, SKELETON_ERROR_EMPTY, "the blade is nowhere wider than %g segments, too narrow to be meshed", least);
    g_free(must);
    g_free(keep);
    ring_clear(&r);
    return p;
}
