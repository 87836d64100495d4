/* Exact distance fields. A square of pixels keeps the strokes that may be nearest to one of its pixels: those whose
 * distance to its centre exceeds the least one by no more than the square's diameter. Its quarters choose among these.
 * Most choices are made between discs around the strokes, which are quick to compare. */
#include <glib.h>

#include "geom/parallel.h"
#include "image/painter.h"

enum { LEAF = 4, PART = 256 }; /* sides of squares: no longer quartered; done by one thread */

/* A stroke as its middle, and how far from there it reaches for certain and at most. */
typedef struct {
    float x, y, inner, outer; /* pixels */
    uint32_t i;
} Near;

/* More than single precision loses on images of the largest size, and then some. */
static const float slack = 0.02f;

typedef struct {
    uint32_t x, y, side;
    Near *item;
    uint32_t n;
} Square;

typedef struct {
    uint32_t width, height;
    unsigned threads;
    const Capsule *(*shape)(uint32_t i, const void *user);
    const void *user;
    const float *where;
    double limit;
    float *out;
    GArray *parents, *squares; /* of one level, in a fixed order */
} Field;

/* Does the blade reach into the square? */
static bool wanted(const Field *f, const Square *q)
{
    uint32_t x1 = MIN(q->x + q->side, f->width), y1 = MIN(q->y + q->side, f->height);
    for (uint32_t y = q->y; y < y1; y++)
        for (uint32_t x = q->x; x < x1; x++)
            if (f->where[(gsize)y * f->width + x] > 0.0f)
                return true;
    return false;
}

/* Fills q->item from `from`; `distance` has room for n numbers. */
static void choose_rough(const Field *f, Square *q, const Near *from, uint32_t n, float *distance)
{
    float half = 0.5f * (float)q->side, reach = 0.7072f * (float)q->side, least = (float)INFINITY;
    float x = (float)q->x + half, y = (float)q->y + half;
    for (uint32_t i = 0; i < n; i++) {
        float dx = from[i].x - x, dy = from[i].y - y, d = sqrtf(dx * dx + dy * dy);
        least = MIN(least, d - from[i].inner);
        distance[i] = d - from[i].outer;
    }
    float most = MIN(least + 2.0f * reach, (float)f->limit + reach) + slack;
    q->n = 0;
    for (uint32_t i = 0; i < n; i++)
        if (distance[i] <= most)
            q->item[q->n++] = from[i];
}

/* The same by true distances, worth it for strokes longer than the square. */
static void choose_well(const Field *f, Square *q, float *distance)
{
    double half = 0.5 * q->side, reach = 0.7072 * q->side, least = (double)INFINITY, t;
    Vec2 centre = vec2(q->x + half, q->y + half);
    for (uint32_t i = 0; i < q->n; i++) {
        double d = capsule_distance(f->shape(q->item[i].i, f->user), centre, &t);
        distance[i] = (float)d;
        least = MIN(least, d);
    }
    float most = (float)MIN(least + 2.0 * reach, f->limit + reach) + slack;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < q->n; i++)
        if (distance[i] <= most)
            q->item[kept++] = q->item[i];
    q->n = kept;
}

static void choose(const Field *f, Square *q, const Near *from, uint32_t n, float *distance)
{
    choose_rough(f, q, from, n, distance);
    float spare = 0.0f;
    for (uint32_t i = 0; i < q->n; i++)
        spare += q->item[i].outer - q->item[i].inner;
    if (q->n > 2 && spare > 0.25f * (float)q->side * (float)q->n)
        choose_well(f, q, distance);
}

static void fill_pixels(const Field *f, const Square *q)
{
    uint32_t x1 = MIN(q->x + q->side, f->width), y1 = MIN(q->y + q->side, f->height);
    for (uint32_t y = q->y; y < y1; y++)
        for (uint32_t x = q->x; x < x1; x++) {
            gsize at = (gsize)y * f->width + x;
            if (!(f->where[at] > 0.0f))
                continue;
            double least = f->limit, t;
            for (uint32_t i = 0; i < q->n; i++) {
                const Near *k = &q->item[i];
                double dx = x + 0.5 - (double)k->x, dy = y + 0.5 - (double)k->y, far = least + (double)(k->outer + slack);
                if (far > 0.0 && dx * dx + dy * dy <= far * far)
                    least = MIN(least, capsule_distance(f->shape(k->i, f->user), vec2(x + 0.5, y + 0.5), &t));
            }
            f->out[at] = (float)least;
        }
}

/* `distance` has room for as many numbers as the list of q: the lists of smaller squares are no longer. */
static void fill_square(const Field *f, const Square *q, float *distance)
{
    if (q->side <= LEAF || q->n <= 2) {
        fill_pixels(f, q);
        return;
    }
    Near *item = g_new(Near, q->n + 1);
    for (uint32_t i = 0; i < 4; i++) {
        uint32_t h = q->side / 2;
        Square part = {q->x + (i & 1) * h, q->y + (i >> 1) * h, h, item, 0};
        if (part.x >= f->width || part.y >= f->height || !wanted(f, &part))
            continue;
        choose(f, &part, q->item, q->n, distance);
        fill_square(f, &part, distance);
    }
    g_free(item);
}

static void fill_squares(uint32_t first, uint32_t last, void *user)
{
    const Field *f = user;
    for (uint32_t i = first; i < last; i++) {
        const Square *q = &g_array_index(f->squares, Square, i);
        float *distance = g_new(float, q->n + 1);
        fill_square(f, q, distance);
        g_free(distance);
    }
}

/* Chooses for the squares first … last-1; square i is the quarter i % 4 of parent i / 4. */
static void choose_squares(uint32_t first, uint32_t last, void *user)
{
    const Field *f = user;
    for (uint32_t i = first; i < last; i++) {
        Square *q = &g_array_index(f->squares, Square, i);
        const Square *parent = &g_array_index(f->parents, Square, i / 4);
        if (q->x >= f->width || q->y >= f->height || !wanted(f, q))
            continue;
        float *distance = g_new(float, parent->n + 1);
        Near *item = g_new(Near, parent->n + 1);
        q->item = item;
        choose(f, q, parent->item, parent->n, distance);
        q->item = g_memdup2(item, (q->n + 1) * sizeof *item);
        g_free(item);
        g_free(distance);
    }
}

static void free_squares(GArray *squares)
{
    for (guint i = 0; i < squares->len; i++)
        g_free(g_array_index(squares, Square, i).item);
    g_array_free(squares, TRUE);
}

/* Quarters all squares of a level; those without pixels to fill have no list and vanish. */
static void descend(Field *f)
{
    f->parents = f->squares;
    f->squares = g_array_new(FALSE, TRUE, sizeof(Square));
    for (guint i = 0; i < f->parents->len; i++) {
        const Square *q = &g_array_index(f->parents, Square, i);
        uint32_t h = q->side / 2;
        for (uint32_t k = 0; k < 4; k++) {
            Square part = {q->x + (k & 1) * h, q->y + (k >> 1) * h, h, NULL, 0};
            g_array_append_val(f->squares, part);
        }
    }
    parallel_for(f->threads, f->squares->len, 1, choose_squares, f);
    free_squares(f->parents);
    guint kept = 0;
    for (guint i = 0; i < f->squares->len; i++) {
        Square q = g_array_index(f->squares, Square, i);
        if (q.item != NULL)
            g_array_index(f->squares, Square, kept++) = q;
    }
    g_array_set_size(f->squares, kept);
}

float *distance_field(const Painter *p, const Capsule *(*shape)(uint32_t i, const void *user), const void *user,
                      uint32_t n, const float *where, double limit)
{
    Field f = {p->width, p->rows, p->style.threads, shape, user, where, limit, NULL, NULL, NULL};
    f.out = g_new0(float, (gsize)p->width * p->rows);
    Square root = {0, 0, PART, g_new(Near, n + 1), n};
    while (root.side < MAX(p->width, p->rows))
        root.side *= 2;
    for (uint32_t i = 0; i < n; i++) {
        const Capsule *k = shape(i, user);
        Vec2 m = vec_lerp(k->a, k->b, 0.5);
        root.item[i] = (Near){(float)m.x, (float)m.y, (float)(0.5 * (k->ra + k->rb)),
                              (float)(0.5 * k->length + MAX(k->ra, k->rb)), i};
    }
    f.squares = g_array_new(FALSE, TRUE, sizeof(Square));
    g_array_append_val(f.squares, root);
    while (f.squares->len > 0 && g_array_index(f.squares, Square, 0).side > PART)
        descend(&f);
    parallel_for(p->style.threads, f.squares->len, 1, fill_squares, &f);
    free_squares(f.squares);
    return f.out;
}

/* ---- the two fields in use ---- */

static const Capsule *stroke_shape(uint32_t i, const void *user)
{
    return &((const Strokes *)user)->v[i].shape;
}

const float *painter_away(Painter *p)
{
    if (p->away == NULL) {
        const Strokes *s = painter_strokes(p);
        p->away = distance_field(p, stroke_shape, s, s->n, painter_blade(p), 4.0 * (p->width + p->rows));
    }
    return p->away;
}

static const Capsule *margin_shape(uint32_t i, const void *user)
{
    return &((const Capsule *)user)[i];
}

const float *painter_inset(Painter *p)
{
    if (p->inset != NULL)
        return p->inset;
    const Polygon *m = p->net->margin;
    uint32_t n = m != NULL ? m->n : 0;
    Capsule *edge = g_new(Capsule, n + 1);
    for (uint32_t i = 0; i < n; i++) {
        Vec2 a = m->v[i], b = m->v[i + 1 < n ? i + 1 : 0];
        double s = p->frame.scale;
        edge[i] = capsule_new(vec2((a.x - p->frame.corner.x) * s, (p->frame.corner.y - a.y) * s), 0.0,
                              vec2((b.x - p->frame.corner.x) * s, (p->frame.corner.y - b.y) * s), 0.0);
    }
    p->inset = distance_field(p, margin_shape, edge, n, painter_blade(p), MAX(p->band, LINE_REACH));
    g_free(edge);
    return p->inset;
}
