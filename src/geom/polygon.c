#include "geom/polygon.h"

#include "geom/segment.h"

#include <glib.h>
#include <stdlib.h>
#include <string.h>

enum { MASK = 128, MAX_SLABS = 1 << 16 };
enum { CELL_OUTSIDE, CELL_INSIDE, CELL_BOUNDARY };

/* An edge ordered upwards, so that both polygons that share it compute with the same numbers. */
typedef struct {
    Vec2 lo, hi;
} Edge;

static inline Edge edge_up(const Polygon *p, uint32_t i)
{
    Vec2 a = p->v[i], b = p->v[i + 1 < p->n ? i + 1 : 0];
    return a.y <= b.y ? (Edge){a, b} : (Edge){b, a};
}

/* floor(t) held within 0 … n-1. Grows with t, which is all that slabs and cells rely on. */
static inline uint32_t bin(double t, uint32_t n) { return !(t > 0.0) ? 0 : t >= (double)n ? n - 1 : (uint32_t)t; }

static inline uint32_t slab_of(const Polygon *p, double y)
{
    return bin((y - p->box.y0) * p->slab_scale, p->n_slabs);
}

static double signed_area(const Vec2 *v, uint32_t n)
{
    double twice = 0.0;
    for (uint32_t i = 1; i + 1 < n; i++)
        twice += vec_cross(vec_sub(v[i], v[0]), vec_sub(v[i + 1], v[0]));
    return 0.5 * twice;
}

static uint64_t slab_entries(const Polygon *p)
{
    uint64_t total = 0;
    for (uint32_t i = 0; i < p->n; i++) {
        Edge e = edge_up(p, i);
        total += 1 + slab_of(p, e.hi.y) - slab_of(p, e.lo.y);
    }
    return total;
}

static void set_slabs(Polygon *p, uint32_t n)
{
    double height = p->box.y1 - p->box.y0;
    p->n_slabs = n;
    p->slab_scale = height > 0.0 ? (double)n / height : 0.0;
}

/* As many slabs as keep the lists short, but never so many that tall edges blow up the memory. */
static void build_slabs(Polygon *p)
{
    uint32_t n = p->n / 2 > MAX_SLABS ? MAX_SLABS : p->n / 2;
    set_slabs(p, n ? n : 1);
    uint64_t total;
    while ((total = slab_entries(p)) > 8 * (uint64_t)p->n + 64 && p->n_slabs > 1)
        set_slabs(p, p->n_slabs / 2);

    p->slab_start = g_new0(uint32_t, (gsize)p->n_slabs + 1);
    p->slab_edge = g_new(uint32_t, total);
    for (uint32_t i = 0; i < p->n; i++) {
        Edge e = edge_up(p, i);
        for (uint32_t s = slab_of(p, e.lo.y); s <= slab_of(p, e.hi.y); s++)
            p->slab_start[s + 1]++;
    }
    for (uint32_t s = 0; s < p->n_slabs; s++)
        p->slab_start[s + 1] += p->slab_start[s];
    for (uint32_t i = p->n; i-- > 0;) { /* backwards, filling each list from its end */
        Edge e = edge_up(p, i);
        for (uint32_t s = slab_of(p, e.lo.y); s <= slab_of(p, e.hi.y); s++)
            p->slab_edge[--p->slab_start[s + 1]] = i;
    }
    /* Each start has slid to the start of its own list, one place too far right in the array. */
    for (uint32_t s = 0; s < p->n_slabs; s++)
        p->slab_start[s] = p->slab_start[s + 1];
    p->slab_start[p->n_slabs] = (uint32_t)total;
}

/* Counts the edges to the right of q; an edge owns its lower end but not its upper one. */
static bool slab_contains(const Polygon *p, Vec2 q)
{
    uint32_t s = slab_of(p, q.y);
    bool inside = false;
    for (uint32_t k = p->slab_start[s]; k < p->slab_start[s + 1]; k++) {
        Edge e = edge_up(p, p->slab_edge[k]);
        if (e.lo.y <= q.y && q.y < e.hi.y && vec_cross(vec_sub(e.hi, e.lo), vec_sub(q, e.lo)) > 0.0)
            inside = !inside;
    }
    return inside;
}

static void mask_span(Polygon *p, uint32_t row, double x0, double x1)
{
    uint32_t from = bin((x0 - p->mask_corner.x) * p->mask_scale.x, MASK);
    uint32_t to = bin((x1 - p->mask_corner.x) * p->mask_scale.x, MASK);
    memset(p->mask + row * MASK + from, CELL_BOUNDARY, to - from + 1);
}

/* Marks every cell nearer to the edge than `reach`. */
static void mask_edge(Polygon *p, Edge e, double reach)
{
    uint32_t j0 = bin((e.lo.y - reach - p->mask_corner.y) * p->mask_scale.y, MASK);
    uint32_t j1 = bin((e.hi.y + reach - p->mask_corner.y) * p->mask_scale.y, MASK);
    double dy = e.hi.y - e.lo.y;
    for (uint32_t j = j0; j <= j1; j++) {
        double t0 = 0.0, t1 = 1.0;
        if (j1 > j0 && dy > 0.0) {
            double y0 = p->mask_corner.y + (double)j / p->mask_scale.y;
            double y1 = p->mask_corner.y + (double)(j + 1) / p->mask_scale.y;
            t0 = (y0 - reach - e.lo.y) / dy;
            t1 = (y1 + reach - e.lo.y) / dy;
            t0 = t0 > 0.0 ? t0 : 0.0;
            t1 = t1 < 1.0 ? t1 : 1.0;
        }
        double xa = e.lo.x + (e.hi.x - e.lo.x) * t0, xb = e.lo.x + (e.hi.x - e.lo.x) * t1;
        mask_span(p, j, (xa < xb ? xa : xb) - reach, (xa < xb ? xb : xa) + reach);
    }
}

/* Cells free of edges lie on one side of the boundary, so one point of each run of them speaks for the run. */
static void mask_fill(Polygon *p)
{
    for (uint32_t j = 0; j < MASK; j++) {
        uint8_t *row = p->mask + j * MASK, known = CELL_BOUNDARY;
        double y = p->mask_corner.y + ((double)j + 0.5) / p->mask_scale.y;
        for (uint32_t i = 0; i < MASK; i++) {
            if (row[i] == CELL_BOUNDARY) {
                known = CELL_BOUNDARY;
                continue;
            }
            if (known == CELL_BOUNDARY) {
                double x = p->mask_corner.x + ((double)i + 0.5) / p->mask_scale.x;
                known = slab_contains(p, vec2(x, y)) ? CELL_INSIDE : CELL_OUTSIDE;
            }
            row[i] = known;
        }
    }
}

static void build_mask(Polygon *p)
{
    double w = p->box.x1 - p->box.x0, h = p->box.y1 - p->box.y0, far = 0.0;
    double corner[4] = {p->box.x0, p->box.y0, p->box.x1, p->box.y1};
    for (int k = 0; k < 4; k++)
        far = fabs(corner[k]) > far ? fabs(corner[k]) : far;
    /* Far above the rounding of the edge test, so that cells off the boundary agree with it bit for bit. */
    double reach = 1e-6 * (w > h ? w : h) + 1e-14 * far;
    p->mask = g_malloc0(MASK * MASK);
    p->mask_corner = vec2(p->box.x0 - 4.0 * reach, p->box.y0 - 4.0 * reach);
    p->mask_scale = vec2(MASK / (w + 8.0 * reach), MASK / (h + 8.0 * reach));
    for (uint32_t i = 0; i < p->n; i++)
        mask_edge(p, edge_up(p, i), reach);
    mask_fill(p);
}

Polygon *polygon_new(const Vec2 *v, uint32_t n)
{
    Polygon *p = g_new0(Polygon, 1);
    p->n = n;
    p->v = g_new(Vec2, n);
    p->box = box_empty();
    p->area = signed_area(v, n);
    for (uint32_t i = 0; i < n; i++) {
        p->v[i] = p->area < 0.0 && i > 0 ? v[n - i] : v[i];
        p->box = box_add(p->box, v[i]);
    }
    p->area = fabs(p->area);
    build_slabs(p);
    build_mask(p);
    return p;
}

Polygon *polygon_scaled(const Polygon *p, double by)
{
    Vec2 *v = g_new(Vec2, p->n);
    for (uint32_t i = 0; i < p->n; i++)
        v[i] = vec_scale(p->v[i], by);
    Polygon *scaled = polygon_new(v, p->n);
    g_free(v);
    return scaled;
}

void polygon_free(Polygon *p)
{
    if (!p)
        return;
    g_free(p->v);
    g_free(p->slab_start);
    g_free(p->slab_edge);
    g_free(p->mask);
    g_free(p);
}

bool polygon_contains(const Polygon *p, Vec2 q)
{
    double x = (q.x - p->mask_corner.x) * p->mask_scale.x, y = (q.y - p->mask_corner.y) * p->mask_scale.y;
    if (!(x >= 0.0 && x < MASK && y >= 0.0 && y < MASK))
        return false;
    uint8_t cell = p->mask[(uint32_t)y * MASK + (uint32_t)x];
    return cell == CELL_BOUNDARY ? slab_contains(p, q) : cell == CELL_INSIDE;
}

Vec2 polygon_nearest(const Polygon *p, Vec2 q, uint32_t *edge)
{
    double least = HUGE_VAL;
    Vec2 nearest = p->v[0];
    for (uint32_t i = 0; i < p->n; i++) {
        Vec2 a = p->v[i], b = p->v[i + 1 < p->n ? i + 1 : 0];
        Vec2 c = vec_lerp(a, b, segment_nearest(a, b, q));
        double d = vec_dist2(c, q);
        if (!(d < least))
            continue;
        least = d;
        nearest = c;
        if (edge)
            *edge = i;
    }
    return nearest;
}

double polygon_depth(const Polygon *p, Vec2 q)
{
    double d = vec_dist(polygon_nearest(p, q, NULL), q);
    return polygon_contains(p, q) ? d : -d;
}

Vec2 polygon_centroid(const Polygon *p)
{
    Vec2 sum = vec2(0.0, 0.0);
    double twice = 0.0;
    for (uint32_t i = 1; i + 1 < p->n; i++) {
        Vec2 a = vec_sub(p->v[i], p->v[0]), b = vec_sub(p->v[i + 1], p->v[0]);
        double k = vec_cross(a, b);
        sum = vec_add(sum, vec_scale(vec_add(a, b), k));
        twice += k;
    }
    if (!(twice > 0.0))
        return p->v[0];
    return vec_add(p->v[0], vec_scale(sum, 1.0 / (3.0 * twice)));
}

static int side(Vec2 a, Vec2 b, Vec2 c)
{
    double k = vec_cross(vec_sub(b, a), vec_sub(c, a));
    return (k > 0.0) - (k < 0.0);
}

static bool in_box(Vec2 a, Vec2 b, Vec2 c) { return box_has(box_add(box_add(box_empty(), a), b), c); }

/* Whether the closed segments ab and cd share a point. */
static bool segments_meet(Vec2 a, Vec2 b, Vec2 c, Vec2 d)
{
    int sc = side(a, b, c), sd = side(a, b, d), sa = side(c, d, a), sb = side(c, d, b);
    if (sc * sd < 0 && sa * sb < 0)
        return true;
    return (sc == 0 && in_box(a, b, c)) || (sd == 0 && in_box(a, b, d)) || (sa == 0 && in_box(c, d, a)) ||
           (sb == 0 && in_box(c, d, b));
}

/* Whether bc runs back over ab. */
static bool folds_back(Vec2 a, Vec2 b, Vec2 c)
{
    return side(b, a, c) == 0 && vec_dot(vec_sub(a, b), vec_sub(c, b)) >= 0.0;
}

static bool edges_clash(const Polygon *p, uint32_t i, uint32_t j)
{
    uint32_t n = p->n, i1 = i + 1 < n ? i + 1 : 0, j1 = j + 1 < n ? j + 1 : 0;
    if (i1 == j)
        return folds_back(p->v[i], p->v[j], p->v[j1]) || (n == 3 && j1 == i && folds_back(p->v[j], p->v[i], p->v[i1]));
    if (j1 == i)
        return folds_back(p->v[j], p->v[i], p->v[i1]);
    return segments_meet(p->v[i], p->v[i1], p->v[j], p->v[j1]);
}

typedef struct {
    double x0, x1;
    uint32_t edge;
} Span;

static int span_compare(const void *a, const void *b)
{
    const Span *s = a, *t = b;
    if (s->x0 != t->x0)
        return s->x0 < t->x0 ? -1 : 1;
    return (s->edge > t->edge) - (s->edge < t->edge);
}

/* Sweeps the edges of one slab from left to right. */
static bool slab_crossing(const Polygon *p, uint32_t slab, Span *span, uint32_t *i, uint32_t *j)
{
    uint32_t n = p->slab_start[slab + 1] - p->slab_start[slab];
    for (uint32_t k = 0; k < n; k++) {
        Edge e = edge_up(p, p->slab_edge[p->slab_start[slab] + k]);
        span[k].edge = p->slab_edge[p->slab_start[slab] + k];
        span[k].x0 = e.lo.x < e.hi.x ? e.lo.x : e.hi.x;
        span[k].x1 = e.lo.x < e.hi.x ? e.hi.x : e.lo.x;
    }
    qsort(span, n, sizeof *span, span_compare);
    for (uint32_t a = 0; a < n; a++) {
        for (uint32_t b = a + 1; b < n && span[b].x0 <= span[a].x1; b++) {
            uint32_t lo = span[a].edge < span[b].edge ? span[a].edge : span[b].edge;
            uint32_t hi = span[a].edge < span[b].edge ? span[b].edge : span[a].edge;
            if (edges_clash(p, lo, hi)) {
                *i = lo;
                *j = hi;
                return true;
            }
        }
    }
    return false;
}

/* Two edges that meet are both listed in the slab of the point where they do. */
bool polygon_crossing(const Polygon *p, uint32_t *i, uint32_t *j)
{
    Span *span = g_new(Span, p->n);
    bool found = false;
    for (uint32_t s = 0; s < p->n_slabs && !found; s++)
        found = slab_crossing(p, s, span, i, j);
    g_free(span);
    return found;
}
