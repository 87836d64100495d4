/* Memory of the rows at hand: planes, and what maps share. */
#include <glib.h>
#include <string.h>

#include "image/painter.h"

/* ---- planes ---- */

/* The last one with room enough; NULL: there is none. */
static Plane *take_spare(Painter *p, uint32_t channels)
{
    for (guint i = p->spare->len; i-- > 0;) {
        Plane *plane = g_ptr_array_index(p->spare, i);
        if (plane->channels == channels && plane->height >= p->y1 - p->y0)
            return g_ptr_array_steal_index(p->spare, i);
    }
    return NULL;
}

Plane *painter_sheet(Painter *p, uint32_t channels, PlaneKind kind)
{
    Plane *plane = take_spare(p, channels);
    if (plane == NULL)
        return plane_new(p->width, p->y1 - p->y0, channels, kind);
    *plane = (Plane){p->width, p->y1 - p->y0, channels, kind, 0.0, 1.0, "", plane->px};
    return plane;
}

Plane *painter_plane(Painter *p, MapId id)
{
    Plane *plane = painter_sheet(p, paint_map_info(id)->channels, paint_map_info(id)->kind);
    plane->unit = paint_map_info(id)->unit;
    return plane;
}

void painter_give_back(Painter *p, Plane *plane)
{
    if (plane != NULL)
        g_ptr_array_add(p->spare, plane);
}

static void drop_kept(Painter *p)
{
    for (int i = 0; i < MAP_COUNT; i++) {
        painter_give_back(p, p->kept[i]);
        p->kept[i] = NULL;
    }
}

/* ---- fields ---- */

/* All fields, for what is done with each alike. */
enum { N_FIELDS = 10 + N_NOISE };

static void list_fields(Painter *p, Field *list[N_FIELDS])
{
    Field *all[] = {&p->cover, &p->blade, &p->owner, &p->away, &p->inset, &p->side, &p->bulge, &p->crease, &p->nearness, &p->arch};
    memcpy(list, all, sizeof all);
    for (int i = 0; i < N_NOISE; i++)
        list[N_FIELDS - N_NOISE + i] = &p->grain[i];
}

typedef struct {
    const Painter *p;
    Field *field[N_FIELDS];
    uint32_t top, bottom; /* the rows at hand from now on */
} Move;

static void move_fields(uint32_t first, uint32_t last, void *user)
{
    const Move *m = user;
    gsize row = (gsize)m->p->width * sizeof(float);
    for (uint32_t i = first; i < last; i++) {
        Field *f = m->field[i];
        if (f->px == NULL)
            continue;
        bool keep = m->top >= m->p->top && f->done > m->top;
        f->done = keep ? MIN(f->done, m->bottom) : m->top;
        if (keep)
            memmove(f->px, (char *)f->px + (m->top - m->p->top) * row, (f->done - m->top) * row);
        f->px = g_realloc(f->px, (m->bottom - m->top) * row);
    }
}

void painter_band(Painter *p, uint32_t y0, uint32_t y1)
{
    uint32_t reach = arch_reach(p) + 1 + p->surround; /* normals look one row further */
    Move m = {.p = p, .top = (y0 > reach ? y0 - reach : 0) / TILE * TILE, .bottom = MIN((y1 + reach + TILE - 1) / TILE * TILE, p->rows)};
    drop_kept(p);
    list_fields(p, m.field);
    p->arch.done = p->top; /* it has no rows to spare */
    pool_for(p->pool, N_FIELDS, 1, move_fields, &m);
    p->y0 = y0;
    p->y1 = y1;
    p->top = m.top;
    p->bottom = m.bottom;
}

uint32_t field_begin(const Painter *p, Field *f)
{
    if (f->px == NULL) {
        f->px = g_new(float, (gsize)(p->bottom - p->top) * p->width);
        f->done = p->top;
    }
    uint32_t from = f->done;
    f->done = p->bottom;
    return from;
}

void field_clear_tile(const Painter *p, const Field *f, TileBox box)
{
    for (uint32_t y = box.y0; y < box.y1; y++)
        memset(field_row(p, f, y) + box.x0, 0, (box.x1 - box.x0) * sizeof(float));
}

void painter_drop(Painter *p)
{
    Field *field[N_FIELDS];
    drop_kept(p);
    g_ptr_array_free(p->spare, TRUE);
    list_fields(p, field);
    for (int i = 0; i < N_FIELDS; i++)
        g_free(field[i]->px);
}
