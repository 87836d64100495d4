#include "geom/holes.h"

#include <glib.h>
#include <string.h>

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
