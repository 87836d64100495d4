/* Maps of data and labels: what is where, no shading. */
#include <glib.h>
#include <string.h>

#include "image/painter.h"

/* Maps of what the stroke at a pixel has. They are painted together, as looking at the strokes is most of the work. */
static const MapId of_strokes[] = {MAP_VEIN_ORDER, MAP_VEIN_ID, MAP_VEIN_WIDTH, MAP_AGE};
enum { OF_ORDER, OF_ID, OF_WIDTH, OF_AGE, N_OF_STROKES };

typedef struct {
    const Painter *p;
    Plane *plane;                   /* of others */
    const Field *field;             /* that it shows as it is */
    Plane *of_stroke[N_OF_STROKES]; /* NULL: not wanted */
} Attribute;

static void stroke_values(const Stroke *s, double unit, Vec2 at, float value[N_OF_STROKES])
{
    double t;
    capsule_distance(&s->shape, at, &t);
    value[OF_ORDER] = (float)s->order;
    value[OF_ID] = (float)(1.0 + s->vein);
    value[OF_WIDTH] = (float)(2.0 * capsule_radius(&s->shape, t) / unit);
    value[OF_AGE] = (float)floor((double)s->birth0 + (double)(s->birth1 - s->birth0) * t + 0.5);
}

static void owner_row(uint32_t y, void *user)
{
    const Attribute *a = user;
    const Painter *p = a->p;
    const uint32_t *owner = label_row(p, &p->owner, y);
    const float *blade = p->net->margin != NULL ? field_row(p, &p->blade, y) : NULL;
    float *out[N_OF_STROKES];
    for (int k = 0; k < N_OF_STROKES; k++) {
        out[k] = a->of_stroke[k] != NULL ? plane_row(p, a->of_stroke[k], y) : NULL;
        if (out[k] != NULL)
            memset(out[k], 0, p->width * sizeof(float));
    }
    for (uint32_t x = 0; x < p->width; x++) { /* veins end at the margin */
        float value[N_OF_STROKES];
        if ((owner[x] & OWNER_BESIDE) != 0 || (blade != NULL && blade[x] < 0.5f))
            continue;
        stroke_values(&p->strokes->v[owner[x]], p->frame.scale, vec2(x + 0.5, y + 0.5), value);
        for (int k = 0; k < N_OF_STROKES; k++)
            if (out[k] != NULL)
                out[k][x] = value[k];
    }
}

static void field_to_row(uint32_t y, void *user)
{
    const Attribute *a = user;
    memcpy(plane_row(a->p, a->plane, y), field_row(a->p, a->field, y), a->p->width * sizeof(float));
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

/* Along with those of the others that are wanted, which are kept until they are asked for. */
static Plane *paint_of_strokes(Painter *p, MapId id)
{
    if (p->kept[id] != NULL)
        return g_steal_pointer(&p->kept[id]);
    Attribute a = {.p = p};
    Plane *asked = NULL;
    for (int k = 0; k < N_OF_STROKES; k++) {
        MapId one = of_strokes[k];
        if (one != id && (!p->expected[one] || p->kept[one] != NULL))
            continue;
        a.of_stroke[k] = painter_plane(p, one);
        a.of_stroke[k]->high = white(p, one);
        if (one == id)
            asked = a.of_stroke[k];
        else
            p->kept[one] = a.of_stroke[k];
    }
    painter_owner(p);
    if (p->net->margin != NULL)
        painter_blade(p);
    painter_rows(p, p->y0, p->y1, owner_row, &a);
    return asked;
}

Plane *paint_attribute(Painter *p, MapId id)
{
    if (id != MAP_OPACITY && id != MAP_VEIN_MASK && id != MAP_DISTANCE)
        return paint_of_strokes(p, id);
    Attribute a = {.p = p, .plane = painter_plane(p, id)};
    a.plane->high = white(p, id);
    if (id == MAP_OPACITY) {
        painter_blade(p);
        a.field = &p->blade;
        painter_rows(p, p->y0, p->y1, field_to_row, &a);
    } else if (id == MAP_VEIN_MASK) {
        painter_cover(p);
        a.field = &p->cover;
        painter_rows(p, p->y0, p->y1, field_to_row, &a);
    } else {
        painter_away(p);
        if (p->net->n_edges > 0)
            painter_rows(p, p->y0, p->y1, distance_row, &a);
        else
            memset(a.plane->px, 0, (gsize)p->width * (p->y1 - p->y0) * sizeof(float));
    }
    return a.plane;
}
