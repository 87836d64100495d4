/* Exact coverage of pixels by the veins and by the blade. */
#include <glib.h>
#include <string.h>

#include "geom/parallel.h"
#include "image/painter.h"

/* ---- veins ---- */

enum { NONE = 0xFFFFFFFFu };

typedef struct {
    uint32_t next, stroke;
} Link;

/* Scratch for one tile: the strokes that cut each pixel, as chains. */
typedef struct {
    const Painter *p;
    Union area;
    bool full[TILE * TILE];
    uint32_t head[TILE * TILE];
    Link *link;
    uint32_t n_links, cap_links;
    Rings blade, spare; /* the margin within the tile, pixels */
    bool has_blade;
} Tile;

static void tile_link(Tile *t, uint32_t pixel, uint32_t stroke)
{
    if (t->n_links == t->cap_links) {
        t->cap_links = t->cap_links > 0 ? t->cap_links * 2 : 4096;
        t->link = g_renew(Link, t->link, t->cap_links);
    }
    t->link[t->n_links] = (Link){t->head[pixel], stroke};
    t->head[pixel] = t->n_links++;
}

static void tile_enter(Tile *t, TileBox box, uint32_t stroke)
{
    const Capsule *k = &t->p->strokes->v[stroke].shape;
    uint32_t y0, y1;
    pixel_rows(k, box.y0, box.y1, &y0, &y1);
    Span top = y0 < y1 ? capsule_chord(k, y0) : (Span){0.0, 0.0};
    for (uint32_t y = y0; y < y1; y++) {
        Span bottom = capsule_chord(k, y + 1.0), reach = capsule_reach(k, y, y + 1.0, top, bottom);
        Span inside = {MAX(top.lo, bottom.lo), MIN(top.hi, bottom.hi)};
        uint32_t x0, x1, in0, in1, row = (y - box.y0) * TILE - box.x0;
        pixels_touched(reach, box.x0, box.x1, &x0, &x1);
        pixels_inside(inside, box.x0, box.x1, &in0, &in1);
        for (uint32_t x = x0; x < x1; x++) {
            if (x >= in0 && x < in1)
                t->full[row + x] = true;
            else if (!t->full[row + x])
                tile_link(t, row + x, stroke);
        }
        top = bottom;
    }
}

static void add_wedge(Union *u, const Stroke *s, Vec2 corner)
{
    const Capsule *k = &s->shape;
    double reach = k->ra + 0.7072, turn = fabs(vec_cross(s->before, k->d)), wedge_area = 0.5 * k->ra * k->ra * turn;
    if ((wedge_area > 1e-6 || vec_dot(s->before, k->d) < 0.0) &&
        vec_dist2(k->a, vec2(corner.x + 0.5, corner.y + 0.5)) < reach * reach)
        union_add_wedge(u, k->a, k->ra, s->before, k->d, corner);
}

static Vec2 to_image(const Painter *p, Vec2 v)
{
    return vec2((v.x - p->frame.corner.x) * p->frame.scale, (p->frame.corner.y - v.y) * p->frame.scale);
}

static void tile_blade(Tile *t, TileBox box)
{
    const Polygon *m = t->p->net->margin;
    Vec2 *v = g_new(Vec2, m->n);
    for (uint32_t i = 0; i < m->n; i++)
        v[i] = to_image(t->p, m->v[i]);
    ring_within(v, m->n, (Box2){box.x0, box.y0, box.x1, box.y1}, &t->blade, &t->spare);
    t->has_blade = true;
    g_free(v);
}

/* Veins end at the margin: what a first node on it or a wide vein in a narrow base has beyond is of the petiole. */
static float pixel_cover(Tile *t, TileBox box, uint32_t pixel, Vec2 corner)
{
    float blade = t->p->net->margin != NULL ? t->p->blade[(gsize)corner.y * t->p->width + (gsize)corner.x] : 1.0f;
    if (blade == 0.0f || t->full[pixel])
        return blade;
    if (t->head[pixel] == NONE)
        return 0.0f;
    union_reset(&t->area);
    for (uint32_t l = t->head[pixel]; l != NONE; l = t->link[l].next) {
        const Stroke *s = &t->p->strokes->v[t->link[l].stroke];
        union_add(&t->area, &s->shape, s->cut, corner);
        if ((s->cut & CUT_A) != 0)
            add_wedge(&t->area, s, corner);
    }
    if (blade == 1.0f)
        return (float)MIN(union_area(&t->area), 1.0);
    if (!t->has_blade)
        tile_blade(t, box);
    double area = union_area_within(&t->area, t->blade.v, t->blade.n_v, corner);
    return (float)MIN(area, (double)blade);
}

static void cover_tiles(uint32_t first, uint32_t last, void *user)
{
    const Painter *p = user;
    Tile *t = g_new0(Tile, 1);
    t->p = p;
    union_init(&t->area, p->circle);
    for (uint32_t tile = first; tile < last; tile++) {
        uint32_t from = p->bins.start[tile], to = p->bins.start[tile + 1];
        if (from == to)
            continue;
        TileBox box = bins_tile(&p->bins, tile);
        memset(t->full, 0, sizeof t->full);
        memset(t->head, 0xFF, sizeof t->head);
        t->n_links = 0;
        t->has_blade = false;
        for (uint32_t i = from; i < to; i++)
            tile_enter(t, box, p->bins.item[i]);
        for (uint32_t y = box.y0; y < box.y1; y++)
            for (uint32_t x = box.x0; x < box.x1; x++)
                p->cover[(gsize)y * p->width + x] = pixel_cover(t, box, (y - box.y0) * TILE + x - box.x0, vec2(x, y));
    }
    union_clear(&t->area);
    rings_clear(&t->blade);
    rings_clear(&t->spare);
    g_free(t->link);
    g_free(t);
}

const float *painter_cover(Painter *p)
{
    if (p->cover == NULL) {
        painter_strokes(p);
        if (p->net->margin != NULL)
            painter_blade(p);
        p->cover = g_new0(float, (gsize)p->width * p->rows);
        parallel_for(p->style.threads, p->bins.nx * p->bins.ny, 16, cover_tiles, p);
    }
    return p->cover;
}

/* ---- blade ---- */

enum { BAND = 64 }; /* rows per part */

/* Adds the signed area to the right of the part of a segment within row y (0 <= its y <= 1) to the sums of its pixels.
 * sum[x] gathers what pixel x gets beyond what all pixels right of an edge get, so that prefix sums give areas. */
static void add_segment(double *sum, uint32_t width, Vec2 a, Vec2 b)
{
    double dy = b.y - a.y;
    if (dy == 0.0)
        return;
    if (a.x > b.x) {
        Vec2 swap = a;
        a = b;
        b = swap;
    }
    double x = a.x, y = a.y;
    while (x < b.x || y != b.y) {
        double next = floor(x) + 1.0, part_y;
        if (next >= b.x) {
            next = b.x;
            part_y = b.y;
        } else {
            part_y = a.y + (b.y - a.y) * ((next - a.x) / (b.x - a.x));
        }
        double h = dy > 0.0 ? fabs(part_y - y) : -fabs(part_y - y);
        double cell = floor(x), mid = 0.5 * (x + next) - cell;
        if (cell < 0.0) {
            sum[0] += h;
        } else if (cell < width) {
            uint32_t i = (uint32_t)cell;
            sum[i] += h * (1.0 - mid);
            sum[i + 1] += h * mid;
        }
        x = next;
        y = part_y;
    }
}

/* One edge's share of rows y0 … y1-1. */
static void add_edge(double *sum, uint32_t width, uint32_t y0, uint32_t y1, Vec2 a, Vec2 b)
{
    double low = MIN(a.y, b.y), high = MAX(a.y, b.y);
    if (high <= y0 || low >= y1 || low == high)
        return;
    uint32_t first, last;
    pixels_touched((Span){low, high}, y0, y1, &first, &last);
    for (uint32_t y = first; y < last; y++) {
        double t0 = MAX(low, (double)y), t1 = MIN(high, y + 1.0);
        if (!(t1 > t0))
            continue;
        double from = a.y < b.y ? t0 : t1, to = a.y < b.y ? t1 : t0, k = (b.x - a.x) / (b.y - a.y);
        Vec2 p = {from == a.y ? a.x : a.x + (from - a.y) * k, from}, q = {to == b.y ? b.x : a.x + (to - a.y) * k, to};
        /* parts left of the image count in full, parts right of it not at all */
        if (MAX(p.x, q.x) <= 0.0)
            sum[(gsize)(y - y0) * (width + 2)] += to - from;
        else
            add_segment(sum + (gsize)(y - y0) * (width + 2), width, p, q);
    }
}

static void blade_band(uint32_t first, uint32_t last, void *user)
{
    const Painter *p = user;
    const Polygon *m = p->net->margin;
    gsize stride = (gsize)p->width + 2;
    double *sum = g_new0(double, stride *(last - first));
    for (uint32_t i = 0; i < m->n; i++) {
        Vec2 a = m->v[i], b = m->v[i + 1 < m->n ? i + 1 : 0];
        add_edge(sum, p->width, first, last, to_image(p, a), to_image(p, b));
    }
    for (uint32_t y = first; y < last; y++) {
        double area = 0.0;
        for (uint32_t x = 0; x < p->width; x++) {
            area += sum[(y - first) * stride + x];
            double part = fabs(area);
            /* what rounding leaves of sums that cancel */
            p->blade[(gsize)y * p->width + x] = part < 1e-7 ? 0.0f : part > 1.0 - 1e-7 ? 1.0f : (float)part;
        }
    }
    g_free(sum);
}

const float *painter_blade(Painter *p)
{
    if (p->blade != NULL)
        return p->blade;
    gsize n = (gsize)p->width * p->rows;
    if (p->net->margin == NULL) { /* veins without a blade */
        p->blade = g_memdup2(painter_cover(p), n * sizeof(float));
        return p->blade;
    }
    p->blade = g_new0(float, n);
    parallel_for(p->style.threads, p->rows, BAND, blade_band, p);
    return p->blade;
}
