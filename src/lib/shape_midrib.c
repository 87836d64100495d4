/* A leaf without veins bends about a midrib all the same: one is laid from base to tip. */
#include "lib/settings.h"
#include "lib/shape.h"

static const double away = 0.3, most = 0.03; /* of the blade's width there, but no more than this of its length: so far it keeps from the margin */
static const double aside = 0.6;             /* a step aside for a step up, at most, so long as that stays in the blade */
static const double reach = 0.97;            /* of the way to the tip: from there a skeleton goes on to the margin by itself */
enum { LEAST_NODES = 16, MOST_NODES = 4096 };

/* The part of the blade at height y that holds x, or lies nearest to it; false when the blade is nowhere so high. */
static bool blade_at(const Polygon *margin, double x, double y, double *lo, double *hi)
{
    GArray *cut = g_array_new(FALSE, FALSE, sizeof(double));
    for (uint32_t i = 0; i < margin->n; i++) {
        Vec2 a = margin->v[i], b = margin->v[(i + 1) % margin->n];
        if ((a.y <= y) == (b.y <= y))
            continue;
        double at = a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y));
        guint k = cut->len;
        while (k > 0 && g_array_index(cut, double, k - 1) > at)
            k--;
        g_array_insert_val(cut, k, at);
    }
    double best = HUGE_VAL;
    for (guint k = 0; k + 1 < cut->len; k += 2) {
        double from = g_array_index(cut, double, k), to = g_array_index(cut, double, k + 1), far = fmax(fmax(from - x, x - to), 0.0);
        if (far >= best)
            continue;
        best = far;
        *lo = from;
        *hi = to;
    }
    g_array_unref(cut);
    return best < HUGE_VAL;
}

Network *shape_lay_midrib(const VenLeaf *leaf)
{
    const Polygon *margin = leaf->net->margin;
    uint32_t n = (uint32_t)CLAMP(ceil(leaf->length), LEAST_NODES, MOST_NODES), last = 0;
    Vec2 *at = g_new(Vec2, n);
    at[0] = vec2(0.0, 0.0);
    for (uint32_t i = 1; i < n; i++) {
        double y = reach * leaf->length * i / (n - 1), lo = 0.0, hi = 0.0;
        if (!blade_at(margin, at[last].x, y, &lo, &hi))
            continue;
        double room = fmin(away * (hi - lo), most * leaf->length), x = at[last].x, turn = aside * (y - at[last].y);
        x += CLAMP(CLAMP(0.0, lo + room, hi - room) - x, -turn, turn);
        room *= 0.2;
        at[++last] = vec2(CLAMP(x, lo + room, hi - room), y);
    }
    Network *net = network_new(last + 1, last);
    for (uint32_t i = 0; i <= last; i++) {
        net->node[i] = at[i];
        if (i == 0)
            continue;
        net->tail[i - 1] = i - 1;
        net->head[i - 1] = i;
    }
    g_free(at);
    net->margin = polygon_scaled(margin, 1.0);
    net->length = leaf->length;
    WidthDef widths = settings_widths(leaf->params);
    network_assign_widths(net, &widths);
    return net;
}
