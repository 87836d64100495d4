#include "scan/paper.h"

#include <string.h>

#define BEND 0.002  /* of the area: a side that takes less than that from the polygon is none */
#define FILLED 0.75 /* of the polygon: a leaf may lie over the edge and take a bite */
#define ALONG 0.8   /* of the length of its sides the region reaches them, as no round shape does, … */
#define REACH 2.0   /* … to so many pixels */

/* ---- hull ---- */

static gint by_place(gconstpointer a, gconstpointer b, gpointer user)
{
    const Vec2 *p = a, *q = b;
    return p->x != q->x ? (p->x < q->x ? -1 : 1) : (p->y > q->y) - (p->y < q->y);
}

/* Corners of the outermost pixels of each row. */
static GArray *row_ends(const Mask *m, uint8_t bit)
{
    GArray *p = g_array_new(FALSE, FALSE, sizeof(Vec2));
    for (uint32_t y = 0; y < m->height; y++) {
        uint32_t x0 = 0, x1 = m->width;
        while (x0 < x1 && !(*mask_at(m, x0, y) & bit))
            x0++;
        while (x1 > x0 && !(*mask_at(m, x1 - 1, y) & bit))
            x1--;
        for (uint32_t k = 0; x0 < x1 && k < 4; k++) {
            Vec2 q = vec2(k & 1 ? x1 : x0, y + k / 2);
            g_array_append_val(p, q);
        }
    }
    return p;
}

/* Andrew's monotone chain; clockwise as seen with y down. Whole numbers, so exact. */
static GArray *hull_of(const Mask *m, uint8_t bit)
{
    GArray *p = row_ends(m, bit), *h = g_array_new(FALSE, FALSE, sizeof(Vec2));
    if (p->len > 0)
        g_qsort_with_data(p->data, (gint)p->len, sizeof(Vec2), by_place, NULL);
    const Vec2 *v = (const Vec2 *)p->data;
    for (guint pass = 0, least = 2; pass < 2; pass++, least = h->len + 1)
        for (guint i = 0; i < p->len; i++) {
            Vec2 q = v[pass ? p->len - 1 - i : i];
            while (h->len >= least && vec_cross(vec_sub(g_array_index(h, Vec2, h->len - 1), g_array_index(h, Vec2, h->len - 2)),
                                                vec_sub(q, g_array_index(h, Vec2, h->len - 1))) <= 0.0)
                g_array_set_size(h, h->len - 1);
            g_array_append_val(h, q);
        }
    if (h->len > 1)
        g_array_set_size(h, h->len - 1); /* the first once more */
    g_array_free(p, TRUE);
    return h;
}

/* ---- sides ---- */

static double ring_area(const Vec2 *v, uint32_t n)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < n; i++)
        sum += vec_cross(v[i], v[(i + 1) % n]);
    return 0.5 * sum;
}

double paper_area(const Paper *p) { return ring_area(p->corner, p->n); }

static bool on_edge(Vec2 a, Vec2 b, double w, double h)
{
    const double near = 1e-6;
    return MAX(a.x, b.x) <= near || MAX(a.y, b.y) <= near || MIN(a.x, b.x) >= w - near || MIN(a.y, b.y) >= h - near;
}

/* Where the lines of the sides before and after side i meet beyond it; false where they don't. */
static bool beyond(const Vec2 *v, uint32_t n, uint32_t i, Vec2 *at)
{
    Vec2 a = v[(i + n - 1) % n], b = v[i], c = v[(i + 1) % n], d = v[(i + 2) % n], ab = vec_sub(b, a), dc = vec_sub(c, d);
    double turn = vec_cross(dc, ab);
    if (!(turn > 0.0))
        return false;
    *at = vec_add(b, vec_scale(ab, vec_cross(vec_sub(b, c), dc) / turn));
    return true;
}

/* Leaves out, one by one, sides of the hull that cut off least, until as few are left as a sheet has, and as long as that changes next to nothing.
 * Returns how many there are besides those along the edge of the image. */
static uint32_t reduce(GArray *hull, double w, double h)
{
    double area = ring_area((const Vec2 *)hull->data, hull->len);
    for (;;) {
        Vec2 *v = (Vec2 *)hull->data, best_at = {0}, at;
        uint32_t n = hull->len, sides = 0, best = n;
        double least = 0.0;
        for (uint32_t i = 0; i < n; i++) {
            if (on_edge(v[i], v[(i + 1) % n], w, h))
                continue;
            sides++;
            if (n <= 3 || !beyond(v, n, i, &at))
                continue;
            double gain = 0.5 * fabs(vec_cross(vec_sub(at, v[i]), vec_sub(v[(i + 1) % n], v[i])));
            if (best == n || gain < least) {
                best = i;
                best_at = at;
                least = gain;
            }
        }
        if (best == n || (sides <= PAPER_SIDES && n <= PAPER_CORNERS && least > BEND * area))
            return sides;
        v[best] = best_at;
        g_array_remove_index(hull, (best + 1) % n);
    }
}

/* Share of the length of its sides, other than those along the edge of the image, that the region comes near. */
static double share_along(const Mask *m, uint8_t bit, const Vec2 *v, uint32_t n)
{
    double all = 0.0, near = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        Vec2 a = v[i], d = vec_sub(v[(i + 1) % n], a);
        double length = sqrt(vec_norm2(d));
        if (on_edge(a, v[(i + 1) % n], m->width, m->height) || !(length > 0.0))
            continue;
        for (double t = 0.5; t < length; t += 1.0) {
            Vec2 q = vec_add(vec_add(a, vec_scale(d, t / length)), vec_scale(vec2(-d.y, d.x), REACH / length));
            all += 1.0;
            near += q.x >= 0.0 && q.y >= 0.0 && q.x < m->width && q.y < m->height && (*mask_at(m, (uint32_t)q.x, (uint32_t)q.y) & bit);
        }
    }
    return all > 0.0 ? near / all : 0.0;
}

bool paper_fit(const Mask *m, uint8_t bit, Paper *out)
{
    *out = (Paper){0};
    GArray *hull = hull_of(m, bit);
    uint32_t sides = hull->len >= 3 ? reduce(hull, m->width, m->height) : 0;
    const Vec2 *v = (const Vec2 *)hull->data;
    if (sides > 0 && sides <= PAPER_SIDES && hull->len <= PAPER_CORNERS) {
        double area = 0.0;
        for (uint32_t y = 0; y < m->height; y++)
            for (uint32_t x = 0; x < m->width; x++)
                area += (*mask_at(m, x, y) & bit) != 0;
        if (area >= FILLED * ring_area(v, hull->len) && share_along(m, bit, v, hull->len) >= ALONG) {
            out->n = hull->len;
            memcpy(out->corner, v, hull->len * sizeof *v);
        }
    }
    g_array_free(hull, TRUE);
    return out->n > 0;
}

/* ---- use ---- */

/* Of two lines, each through a corner along a side, moved inward. Sides that run on nearly straight never come to be (reduce). */
static Vec2 meet(Vec2 a, Vec2 along_a, double in_a, Vec2 b, Vec2 along_b, double in_b)
{
    Vec2 p = vec_add(a, vec_scale(vec2(-along_a.y, along_a.x), in_a / sqrt(vec_norm2(along_a))));
    Vec2 q = vec_add(b, vec_scale(vec2(-along_b.y, along_b.x), in_b / sqrt(vec_norm2(along_b))));
    double turn = vec_cross(along_a, along_b);
    return turn != 0.0 ? vec_add(p, vec_scale(along_a, vec_cross(vec_sub(q, p), along_b) / turn)) : q;
}

Paper paper_scaled(const Paper *p, uint32_t width, uint32_t height, double scale, double inset)
{
    Paper out = {.n = p->n};
    for (uint32_t i = 0; i < p->n; i++) {
        Vec2 a = p->corner[(i + p->n - 1) % p->n], b = p->corner[i], c = p->corner[(i + 1) % p->n];
        double in[2] = {on_edge(a, b, width, height) ? 0.0 : inset, on_edge(b, c, width, height) ? 0.0 : inset};
        out.corner[i] = vec_scale(meet(b, vec_sub(b, a), in[0], b, vec_sub(c, b), in[1]), scale);
    }
    return out;
}

bool paper_span(const Paper *p, uint32_t width, uint32_t y, uint32_t *from, uint32_t *to)
{
    double at = y + 0.5, left = 0.0, right = width;
    for (uint32_t i = 0; i < p->n; i++) {
        Vec2 a = p->corner[i], d = vec_sub(p->corner[(i + 1) % p->n], a);
        /* inside where d.x (y - a.y) - d.y (x - a.x) >= 0 */
        double rest = d.x * (at - a.y);
        if (d.y > 0.0)
            right = MIN(right, a.x + rest / d.y);
        else if (d.y < 0.0)
            left = MAX(left, a.x + rest / d.y);
        else if (rest < 0.0)
            return false;
    }
    if (!(right - left > 0.0))
        return false;
    *from = (uint32_t)ceil(MAX(left - 0.5, 0.0));
    *to = (uint32_t)MIN(ceil(MAX(right - 0.5, 0.0)), (double)width);
    return *from < *to;
}
