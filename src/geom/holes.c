#include "geom/holes.h"

#include <glib.h>

Holes *holes_new(void)
{
    Holes *h = g_new0(Holes, 1);
    h->start = g_new0(uint32_t, 1);
    return h;
}

void holes_free(Holes *h)
{
    if (!h)
        return;
    g_free(h->start);
    g_free(h->p);
    g_free(h);
}

static double twice_area(const Vec2 *p, uint32_t n)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < n; i++)
        sum += vec_cross(vec_sub(p[i], p[0]), vec_sub(p[i + 1 < n ? i + 1 : 0], p[0]));
    return sum;
}

void holes_add(Holes *h, const Vec2 *p, uint32_t n)
{
    double twice = twice_area(p, n);
    uint32_t at = h->start[h->n];
    h->p = g_renew(Vec2, h->p, at + n);
    h->start = g_renew(uint32_t, h->start, (gsize)h->n + 2);
    for (uint32_t i = 0; i < n; i++)
        h->p[at + i] = p[twice > 0.0 ? n - 1 - i : i];
    h->start[++h->n] = at + n;
    h->area += 0.5 * fabs(twice);
}

Holes *holes_mapped(const Holes *h, const Affine *map)
{
    if (!h)
        return NULL;
    uint32_t n = h->start[h->n];
    Holes *out = g_new0(Holes, 1);
    out->n = h->n;
    out->start = g_memdup2(h->start, sizeof *h->start * ((gsize)h->n + 1));
    out->p = g_new(Vec2, n);
    for (uint32_t i = 0; i < n; i++)
        out->p[i] = affine_apply(map, h->p[i]);
    out->area = h->area * fabs(map->a * map->d - map->b * map->c);
    return out;
}

Holes *holes_copy(const Holes *h)
{
    const Affine same = {.a = 1.0, .d = 1.0};
    return holes_mapped(h, &same);
}

/* ---- what lies in them ---- */

static gint by_value(gconstpointer x, gconstpointer y)
{
    double a = *(const double *)x, b = *(const double *)y;
    return (a > b) - (a < b);
}

Vec2 holes_point(const Holes *h, uint32_t k)
{
    uint32_t first = h->start[k], n = h->start[k + 1] - first;
    const Vec2 *p = h->p + first;
    double low = p[0].y, high = p[0].y;
    for (uint32_t i = 1; i < n; i++) {
        low = MIN(low, p[i].y);
        high = MAX(high, p[i].y);
    }
    double y = 0.5 * (low + high);
    GArray *x = g_array_new(FALSE, FALSE, sizeof(double));
    for (uint32_t i = 0; i < n; i++) {
        Vec2 a = p[i], b = p[i + 1 < n ? i + 1 : 0];
        if ((a.y > y) == (b.y > y))
            continue;
        double at = a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y));
        g_array_append_val(x, at);
    }
    g_array_sort(x, by_value);
    Vec2 middle = x->len >= 2 ? vec2(0.5 * (g_array_index(x, double, 0) + g_array_index(x, double, 1)), y) : p[0];
    g_array_unref(x);
    return middle;
}

void hole_rings_init(HoleRings *r, const Holes *h)
{
    r->n = h ? h->n : 0;
    r->ring = g_new(Polygon *, r->n + 1);
    for (uint32_t k = 0; k < r->n; k++)
        r->ring[k] = polygon_new(h->p + h->start[k], h->start[k + 1] - h->start[k]);
}

void hole_rings_clear(HoleRings *r)
{
    for (uint32_t k = 0; k < r->n; k++)
        polygon_free(r->ring[k]);
    g_free(r->ring);
}

bool hole_rings_contain(const HoleRings *r, Vec2 p)
{
    bool in = false;
    for (uint32_t k = 0; k < r->n && !in; k++)
        in = box_has(r->ring[k]->box, p) && polygon_contains(r->ring[k], p);
    return in;
}

/* Where the line from a to b crosses the sides of a ring, as parts of it; of two sides that meet on it just one counts. */
static void find_crossings(const Polygon *ring, Vec2 a, Vec2 b, GArray *at)
{
    Vec2 way = vec_sub(b, a);
    for (uint32_t i = 0; i < ring->n; i++) {
        Vec2 p = ring->v[i], q = ring->v[i + 1 < ring->n ? i + 1 : 0], side = vec_sub(q, p);
        if ((vec_cross(way, vec_sub(p, a)) > 0.0) == (vec_cross(way, vec_sub(q, a)) > 0.0))
            continue;
        double da = vec_cross(side, vec_sub(a, p)), db = vec_cross(side, vec_sub(b, p));
        if ((da > 0.0) == (db > 0.0))
            continue;
        double t = CLAMP(da / (da - db), 0.0, 1.0);
        g_array_append_val(at, t);
    }
}

typedef struct {
    double from, to;
    bool out;
} Part;

static bool meet(const Box2 *box, Vec2 a, Vec2 b)
{
    return MAX(a.x, b.x) >= box->x0 && MIN(a.x, b.x) <= box->x1 && MAX(a.y, b.y) >= box->y0 && MIN(a.y, b.y) <= box->y1;
}

/* Parts between crossings, each by its middle. */
static GArray *part_line(const HoleRings *r, Vec2 a, Vec2 b)
{
    GArray *part = g_array_new(FALSE, FALSE, sizeof(Part)), *at = g_array_new(FALSE, FALSE, sizeof(double));
    const double end = 1.0;
    for (uint32_t k = 0; k < r->n; k++)
        if (meet(&r->ring[k]->box, a, b))
            find_crossings(r->ring[k], a, b, at);
    g_array_sort(at, by_value);
    g_array_append_val(at, end);
    double from = 0.0;
    for (guint i = 0; i < at->len; i++) {
        double to = g_array_index(at, double, i);
        Part p = {from, to, !hole_rings_contain(r, vec_lerp(a, b, 0.5 * (from + to)))};
        if (to > from || at->len == 1)
            g_array_append_val(part, p);
        from = to;
    }
    g_array_unref(at);
    return part;
}

/* Short parts of one kind become the other kind, unless they are all there is; then neighbours of a kind are one. */
static void drop_short(GArray *part, bool out, double least)
{
    guint n = 0;
    Part *p = (Part *)(void *)part->data;
    for (guint i = 0; i < part->len && part->len > 1; i++)
        if (p[i].out == out && p[i].to - p[i].from < least)
            p[i].out = !out;
    for (guint i = 0; i < part->len; i++) {
        if (n > 0 && p[n - 1].out == p[i].out)
            p[n - 1].to = p[i].to;
        else
            p[n++] = p[i];
    }
    g_array_set_size(part, n);
}

void hole_rings_outside(const HoleRings *r, Vec2 a, Vec2 b, double least, GArray *out)
{
    bool near = false;
    for (uint32_t k = 0; k < r->n && !near; k++)
        near = meet(&r->ring[k]->box, a, b);
    if (!near) {
        g_array_append_val(out, ((Stretch){0.0, 1.0}));
        return;
    }
    double length = vec_dist(a, b), share = length > 0.0 ? least / length : 0.0;
    GArray *part = part_line(r, a, b);
    for (int i = 0; i < 3; i++) /* merging first; then what is short in holes, then outside */
        drop_short(part, i == 2, i == 0 ? 0.0 : share);
    for (guint i = 0; i < part->len; i++) {
        const Part *p = &g_array_index(part, Part, i);
        if (p->out)
            g_array_append_val(out, ((Stretch){p->from, p->to}));
    }
    g_array_unref(part);
}
