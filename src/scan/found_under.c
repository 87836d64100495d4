/* Where a petiole that is bent over the blade hides a primary: botanists draw it on below it, and so does this. */
#include <math.h>

#include "scan/found_parts.h"

static const double near = 2.0;     /* widths of the petiole, from its border: so near a primary that goes below it may be lost */
static const double least_along = 0.85; /* cosine between them there: less goes across, and is seen beyond */
static const double ease = 5.0;     /* widths, along which it comes to lie in its middle */
static const uint32_t run = 24;     /* pixels that tell where it heads */

static Vec2 to_scan(const FoundLeaf *l, uint32_t pixel)
{
    return vec2(l->x0 + (pixel % l->width + 0.5) * l->step, l->scan->height - l->y0 - (pixel / l->width + 0.5) * l->step);
}

/* False off the blade. */
static bool to_pixel(const FoundLeaf *l, Vec2 q, uint32_t *pixel)
{
    double x = (q.x - l->x0) / l->step, y = (l->scan->height - l->y0 - q.y) / l->step;
    if (!(x >= 0.0 && y >= 0.0 && x < l->width && y < l->height))
        return false;
    *pixel = (uint32_t)y * l->width + (uint32_t)x;
    return l->inside[*pixel] || l->hole[*pixel];
}

/* A primary, or a vein that leaves one, which heads along the petiole beside it. */
typedef struct {
    uint32_t vein, pixel; /* its index, and that of the last of its pixels that is seen */
    uint32_t at;          /* point of the petiole there */
} Hidden;

/* Whether a vein heads along the petiole at a pixel that is seen beside it. */
static bool is_beside(const FoundLeaf *l, const FoundVein *v, uint32_t i, uint32_t *at)
{
    const StalkOver *o = l->over;
    Vec2 q = to_scan(l, v->pixel[i]), heading = vec_sub(q, to_scan(l, v->pixel[i - run]));
    double off = stalk_over_distance(o, q, at);
    if (off > near * o->width || l->hole[v->pixel[i]] || *at <= o->first || !o->point[*at].over)
        return false;
    Vec2 out = vec_sub(o->point[*at - 1].p, o->point[*at].p);
    return vec_dot(out, heading) > least_along * sqrt(vec_norm2(out) * vec_norm2(heading));
}

static bool is_near(const FoundLeaf *l, uint32_t pixel) { return stalk_over_distance(l->over, to_scan(l, pixel), NULL) <= 0.5 * l->over->width; }

/* The one that is seen farthest out along the petiole. */
static bool find_hidden(const FoundLeaf *l, const GArray *vein, Hidden *best)
{
    bool any = false;
    *best = (Hidden){0};
    for (uint32_t k = 0; k < vein->len; k++) {
        const FoundVein *v = &g_array_index(vein, FoundVein, k), *parent = &g_array_index(vein, FoundVein, v->parent);
        if (v->ghost || v->order > 2 || parent->ghost || parent->order != 1)
            continue;
        for (uint32_t i = run, at; i < v->n_pixels && !(l->hole[v->pixel[i]] && is_near(l, v->pixel[i])); i++) /* what crosses it is no longer hidden */
            if (is_beside(l, v, i, &at) && (!any || at < best->at)) {
                any = true;
                *best = (Hidden){k, i, at};
            }
    }
    return any;
}

static uint32_t nearest_pixel(const FoundLeaf *l, const FoundVein *v, uint32_t pixel)
{
    uint32_t best = 0;
    for (uint32_t i = 1; i < v->n_pixels; i++)
        if (vec_dist2(to_scan(l, v->pixel[i]), to_scan(l, pixel)) < vec_dist2(to_scan(l, v->pixel[best]), to_scan(l, pixel)))
            best = i;
    return best;
}

/* Ends a vein at a pixel; what is beyond, and what leaves that, is a vein by itself that leaves `to`. */
static void cut_at(const FoundLeaf *l, const FoundRidges *r, GArray *vein, uint32_t k, uint32_t at, uint32_t to)
{
    FoundVein *v = &g_array_index(vein, FoundVein, k), rest = {.parent = to, .order = 2, .gain = v->gain, .ghost = v->n_pixels - at < run};
    uint32_t id = vein->len;
    for (uint32_t j = 0; j < vein->len; j++) {
        FoundVein *child = &g_array_index(vein, FoundVein, j);
        if (j == k || child->parent != k)
            continue;
        bool beyond = nearest_pixel(l, v, child->pixel[0]) > at;
        child->parent = beyond ? id : to;
        child->order = beyond ? 3 : child->order;
    }
    rest.n_pixels = v->n_pixels - at;
    rest.pixel = g_memdup2(v->pixel + at, rest.n_pixels * sizeof *rest.pixel);
    v->n_pixels = at + 1;
    if (rest.n_pixels >= 2)
        found_trace(l, r, &rest);
    else
        rest.ghost = true;
    g_array_append_val(vein, rest);
}

/* Pixels below the petiole from a point of it outward, as far as it has blade on both sides. */
static void go_on(const FoundLeaf *l, uint32_t at, GArray *pixels)
{
    const StalkOver *o = l->over;
    Vec2 off = vec_sub(to_scan(l, g_array_index(pixels, uint32_t, pixels->len - 1)), o->point[at].p);
    double gone = 0.0;
    for (uint32_t i = at; i > o->first; i--) {
        Vec2 a = o->point[i].p, b = o->point[i - 1].p;
        double length = vec_dist(a, b);
        for (double t = 0.0; t < length; t += 0.5 * l->step) {
            double left = MAX(0.0, 1.0 - (gone + t) / (ease * o->width));
            uint32_t pixel;
            if (to_pixel(l, vec_add(vec_lerp(a, b, t / length), vec_scale(off, left * left)), &pixel) &&
                pixel != g_array_index(pixels, uint32_t, pixels->len - 1))
                g_array_append_val(pixels, pixel);
        }
        gone += length;
    }
}

void found_under(const FoundLeaf *l, const FoundRidges *r, GArray *vein)
{
    Hidden h;
    if (!l->over || !find_hidden(l, vein, &h))
        return;
    uint32_t leaves = g_array_index(vein, FoundVein, h.vein).parent; /* the midvein is its own, and no petiole lies along it */
    FoundVein *v = &g_array_index(vein, FoundVein, h.vein);
    bool own = v->order == 1;
    uint32_t primary = own ? h.vein : leaves;
    if (!own)
        cut_at(l, r, vein, primary, nearest_pixel(l, &g_array_index(vein, FoundVein, primary), v->pixel[0]), primary);
    cut_at(l, r, vein, h.vein, h.pixel, primary);
    FoundVein *p = &g_array_index(vein, FoundVein, primary);
    v = &g_array_index(vein, FoundVein, h.vein);
    GArray *pixels = g_array_new(FALSE, FALSE, sizeof(uint32_t));
    g_array_append_vals(pixels, p->pixel, p->n_pixels);
    if (!own)
        g_array_append_vals(pixels, v->pixel, v->n_pixels);
    v->ghost = !own;
    go_on(l, h.at, pixels);
    g_free(p->pixel);
    g_free(p->p);
    g_free(p->width);
    p->n_pixels = pixels->len;
    p->pixel = (uint32_t *)(void *)g_array_free(pixels, FALSE);
    found_trace(l, r, p);
}
