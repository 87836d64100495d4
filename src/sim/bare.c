#include "sim/bare.h"

#include "geom/boxtree.h"

/* Squares of a side, by their centres; split as long as they may hold a larger disc than the best that is known. */
typedef struct {
    const Network *net;
    Boxtree veins;
    double best;
    Vec2 centre;
} Search;

/* Radius of the disc around `at`; below 0 outside the blade. */
static double radius(const Search *s, Vec2 at)
{
    double depth = polygon_depth(s->net->margin, at), near2 = depth * depth;
    uint32_t node = UINT32_MAX;
    if (depth <= 0.0)
        return depth;
    boxtree_nearest(&s->veins, s->net->node, at, NULL, NULL, &node, &near2);
    return sqrt(near2);
}

/* Those of squares with sides of 2 `half` that may hold a disc larger by `least` than the best, each split in four. */
static GArray *split(Search *s, const GArray *square, double half, double least)
{
    GArray *next = g_array_new(FALSE, FALSE, sizeof(Vec2)), *in = g_array_new(FALSE, FALSE, sizeof(double));
    for (guint i = 0; i < square->len; i++) {
        Vec2 at = g_array_index(square, Vec2, i);
        double r = radius(s, at);
        g_array_append_val(in, r);
        if (r > s->best) {
            s->best = r;
            s->centre = at;
        }
    }
    for (guint i = 0; i < square->len; i++)
        for (int k = 0; k < 4 && g_array_index(in, double, i) + half * G_SQRT2 > s->best + least; k++) {
            Vec2 at = vec_add(g_array_index(square, Vec2, i), vec2(k & 1 ? 0.5 * half : -0.5 * half, k & 2 ? 0.5 * half : -0.5 * half));
            g_array_append_val(next, at);
        }
    g_array_unref(in);
    return next;
}

double bare_disc(const Network *net, Vec2 *centre)
{
    const Box2 *b = &net->margin->box;
    double width = b->x1 - b->x0, height = b->y1 - b->y0, half = MAX(0.5 * MIN(width, height), 0.01 * MAX(width, height));
    Search s = {.net = net, .centre = vec2(0.5 * (b->x0 + b->x1), 0.5 * (b->y0 + b->y1))};
    uint32_t *item = g_new(uint32_t, net->n_nodes);
    for (uint32_t i = 0; i < net->n_nodes; i++)
        item[i] = i;
    boxtree_build(&s.veins, net->node, item, net->n_nodes);
    g_free(item);
    GArray *square = g_array_new(FALSE, FALSE, sizeof(Vec2));
    for (int j = 0; (2 * j) * half < height; j++)
        for (int i = 0; (2 * i) * half < width; i++) {
            Vec2 at = vec2(b->x0 + (2 * i + 1) * half, b->y0 + (2 * j + 1) * half);
            g_array_append_val(square, at);
        }
    for (; square->len > 0; half *= 0.5) {
        GArray *next = split(&s, square, half, 0.005 * width);
        g_array_unref(square);
        square = next;
    }
    g_array_unref(square);
    boxtree_clear(&s.veins);
    if (centre)
        *centre = s.centre;
    return 2.0 * s.best / width;
}
