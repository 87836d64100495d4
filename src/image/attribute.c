/* Maps of data and labels: what is where, no shading. */
#include <glib.h>
#include <string.h>

#include "image/painter.h"

typedef struct {
    const Painter *p;
    MapId id;
    Plane *plane;
} Attribute;

static double value_at(const Attribute *a, uint32_t owner, uint32_t x, uint32_t y)
{
    const Stroke *s = &a->p->strokes->v[owner];
    if (a->id == MAP_VEIN_ORDER)
        return s->order;
    if (a->id == MAP_VEIN_ID)
        return 1.0 + s->vein;
    double t;
    capsule_distance(&s->shape, vec2(x + 0.5, y + 0.5), &t);
    if (a->id == MAP_VEIN_WIDTH)
        return 2.0 * capsule_radius(&s->shape, t) / a->p->frame.scale;
    return floor((double)s->birth0 + (double)(s->birth1 - s->birth0) * t + 0.5);
}

static void owner_row(uint32_t y, void *user)
{
    const Attribute *a = user;
    const uint32_t *owner = label_row(a->p, &a->p->owner, y);
    const float *blade = a->p->net->margin != NULL ? field_row(a->p, &a->p->blade, y) : NULL;
    float *out = plane_row(a->p, a->plane, y);
    for (uint32_t x = 0; x < a->p->width; x++) { /* veins end at the margin */
        bool of_vein = (owner[x] & OWNER_BESIDE) == 0 && (blade == NULL || blade[x] >= 0.5f);
        out[x] = of_vein ? (float)value_at(a, owner[x], x, y) : 0.0f;
    }
}

static void distance_row(uint32_t y, void *user)
{
    const Attribute *a = user;
    const float *away = field_row(a->p, &a->p->away, y);
    float *out = plane_row(a->p, a->plane, y);
    for (uint32_t x = 0; x < a->p->width; x++)
        out[x] = (float)((double)MAX(away[x], 0.0f) / a->p->frame.scale);
}

/* What white stands for; of labels the largest there can be. */
static double white(const Painter *p, MapId id)
{
    double top = 1.0;
    if (id == MAP_VEIN_ID)
        top = p->net->n_veins;
    else if (id == MAP_VEIN_ORDER)
        top = 255.0;
    else if (id == MAP_VEIN_WIDTH)
        top = p->widest;
    else if (id == MAP_AGE)
        top = p->steps;
    else if (id == MAP_DISTANCE && p->net->margin != NULL)
        top = painter_round_up(4.0 * p->spacing);
    return top > 0.0 ? top : 1.0;
}

Plane *paint_attribute(Painter *p, MapId id)
{
    Plane *plane = painter_plane(p, id);
    gsize n = (gsize)p->width * (p->y1 - p->y0);
    Attribute a = {p, id, plane};
    plane->high = white(p, id);
    if (id == MAP_OPACITY) {
        painter_blade(p);
        memcpy(plane->px, field_row(p, &p->blade, p->y0), n * sizeof(float));
    } else if (id == MAP_VEIN_MASK) {
        painter_cover(p);
        memcpy(plane->px, field_row(p, &p->cover, p->y0), n * sizeof(float));
    } else if (id == MAP_DISTANCE) {
        painter_away(p);
        if (p->net->n_edges > 0)
            painter_rows(p, p->y0, p->y1, distance_row, &a);
        else
            memset(plane->px, 0, n * sizeof(float));
    } else {
        painter_owner(p);
        if (p->net->margin != NULL)
            painter_blade(p);
        painter_rows(p, p->y0, p->y1, owner_row, &a);
    }
    return plane;
}
