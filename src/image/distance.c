/* Distances to veins and to the margin, and what padding takes from there. */
#include <glib.h>

#include "image/painter.h"

static const Capsule *stroke_shape(uint32_t i, const void *user)
{
    return &((const Strokes *)user)->v[i].shape;
}

void painter_away_ready(Painter *p)
{
    const Strokes *s = painter_strokes(p);
    if (p->to_vein == NULL)
        p->to_vein = nearest_new(&p->bins, s->n, stroke_shape, s, 4.0 * (p->width + p->rows));
}

const float *painter_away(Painter *p)
{
    painter_blade(p);
    uint32_t from = field_begin(p, &p->away);
    if (from < p->bottom) {
        painter_away_ready(p);
        nearest_fill(p->to_vein, p->pool, from, p->bottom, field_row(p, &p->blade, from), field_row(p, &p->away, from), NULL);
    }
    return p->away.px;
}

static const Capsule *edge_shape(uint32_t i, const void *user)
{
    return &((const Capsule *)user)[i];
}

/* With some breadth, as a line between two tiles would lie in neither. */
static Capsule edge_area(uint32_t i, const void *user)
{
    const Capsule *k = (const Capsule *)user + i;
    return capsule_new(k->a, 0.5, k->b, 0.5);
}

const float *painter_inset(Painter *p)
{
    painter_blade(p);
    uint32_t from = field_begin(p, &p->inset);
    field_begin(p, &p->side);
    if (from < p->bottom) {
        if (p->to_edge == NULL) {
            bins_init(&p->edge_bins, p->width, p->rows, p->n_edges, edge_area, p->edge);
            p->to_edge = nearest_new(&p->edge_bins, p->n_edges, edge_shape, p->edge, MAX(MAX(p->rim, LINE_REACH), p->padding));
        }
        nearest_fill(p->to_edge, p->pool, from, p->bottom, NULL, field_row(p, &p->inset, from), label_row(p, &p->side, from));
    }
    return p->inset.px;
}

bool painter_padded(const Painter *p, uint32_t x, uint32_t y, Vec2 *at)
{
    uint32_t side = label_row(p, &p->side, y)[x];
    if (field_row(p, &p->blade, y)[x] > 0.0f || side == OWNER_NONE || (double)field_row(p, &p->inset, y)[x] > p->padding)
        return false;
    double t;
    capsule_distance(&p->edge[side], vec2(x + 0.5, y + 0.5), &t);
    *at = vec_lerp(p->edge[side].a, p->edge[side].b, t);
    return true;
}
