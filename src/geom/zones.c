#include "geom/zones.h"

#include <glib.h>

static const ZoneBox nothing = {HUGE_VALF, HUGE_VALF, -HUGE_VALF, -HUGE_VALF};

static ZoneBox join(ZoneBox a, ZoneBox b)
{
    return (ZoneBox){a.x0 < b.x0 ? a.x0 : b.x0, a.y0 < b.y0 ? a.y0 : b.y0, a.x1 > b.x1 ? a.x1 : b.x1, a.y1 > b.y1 ? a.y1 : b.y1};
}

/* Single precision halves the memory walked; rounding outward by a few ulps keeps the box a superset. */
static ZoneBox widen(Box2 b)
{
    const double up = 1.0 + 0x1p-22, down = 1.0 - 0x1p-22;
    return (ZoneBox){(float)(b.x0 * (b.x0 > 0 ? down : up)), (float)(b.y0 * (b.y0 > 0 ? down : up)),
                     (float)(b.x1 * (b.x1 > 0 ? up : down)), (float)(b.y1 * (b.y1 > 0 ? up : down))};
}

static inline Box2 as_box(ZoneBox b) { return (Box2){(double)b.x0, (double)b.y0, (double)b.x1, (double)b.y1}; }

void zones_init(Zones *z, Box2 field, double cell)
{
    *z = (Zones){.field = field};
    double w = field.x1 - field.x0, h = field.y1 - field.y0, most = w > h ? w : h;
    z->cell = cell > most / 256.0 ? cell : most / 256.0;
    z->nx[0] = (uint32_t)(w / z->cell) + 1;
    z->ny[0] = (uint32_t)(h / z->cell) + 1;
    z->levels = 1;
    while (z->nx[z->levels - 1] > 1 || z->ny[z->levels - 1] > 1) {
        z->nx[z->levels] = (z->nx[z->levels - 1] + 1) / 2;
        z->ny[z->levels] = (z->ny[z->levels - 1] + 1) / 2;
        z->levels++;
    }
    for (uint32_t l = 0; l < z->levels; l++)
        z->box[l] = g_new(ZoneBox, (gsize)z->nx[l] * z->ny[l]);
    z->head = g_new(uint32_t, (gsize)z->nx[0] * z->ny[0]);
    zones_reset(z);
}

void zones_clear(Zones *z)
{
    for (uint32_t l = 0; l < z->levels; l++)
        g_free(z->box[l]);
    g_free(z->head);
    g_free(z->next);
    g_free(z->zone);
    *z = (Zones){0};
}

void zones_reset(Zones *z)
{
    for (gsize i = 0; i < zones_cells(z); i++)
        z->head[i] = UINT32_MAX;
    for (uint32_t l = 0; l < z->levels; l++)
        for (gsize i = 0; i < (gsize)z->nx[l] * z->ny[l]; i++)
            z->box[l][i] = nothing;
    z->n = 0;
}

static uint32_t column(double v, double from, double cell, uint32_t n)
{
    double u = (v - from) / cell;
    return u <= 0.0 ? 0 : u >= (double)n - 1.0 ? n - 1 : (uint32_t)u;
}

uint32_t zones_cell(const Zones *z, Vec2 p)
{
    return column(p.y, z->field.y0, z->cell, z->ny[0]) * z->nx[0] + column(p.x, z->field.x0, z->cell, z->nx[0]);
}

void zones_set(Zones *z, uint32_t item, Box2 zone) { z->zone[item] = widen(zone); }

void zones_lift(Zones *z, uint32_t item, Vec2 p)
{
    uint32_t cell = zones_cell(z, p), x = cell % z->nx[0], y = cell / z->nx[0];
    for (uint32_t l = 0; l < z->levels; l++, x /= 2, y /= 2) {
        ZoneBox *b = &z->box[l][(gsize)y * z->nx[l] + x];
        *b = join(*b, z->zone[item]);
    }
}

void zones_add(Zones *z, Vec2 p, Box2 zone)
{
    if (z->n == z->cap) {
        z->cap = MAX(z->cap * 2, 256);
        z->next = g_renew(uint32_t, z->next, z->cap);
        z->zone = g_renew(ZoneBox, z->zone, z->cap);
    }
    uint32_t cell = zones_cell(z, p);
    z->next[z->n] = z->head[cell];
    z->zone[z->n] = widen(zone);
    z->head[cell] = z->n;
    zones_lift(z, z->n++, p);
}

void zones_raise(Zones *z)
{
    for (gsize c = 0; c < (gsize)z->nx[0] * z->ny[0]; c++) {
        ZoneBox b = nothing;
        for (uint32_t i = z->head[c]; i != UINT32_MAX; i = z->next[i])
            b = join(b, z->zone[i]);
        z->box[0][c] = b;
    }
    for (uint32_t l = 1; l < z->levels; l++)
        for (uint32_t y = 0; y < z->ny[l]; y++)
            for (uint32_t x = 0; x < z->nx[l]; x++) {
                uint32_t x1 = MIN(2 * x + 1, z->nx[l - 1] - 1), y1 = MIN(2 * y + 1, z->ny[l - 1] - 1);
                const ZoneBox *lower = z->box[l - 1], *row0 = lower + (gsize)2 * y * z->nx[l - 1], *row1 = lower + (gsize)y1 * z->nx[l - 1];
                z->box[l][(gsize)y * z->nx[l] + x] = join(join(row0[2 * x], row0[x1]), join(row1[2 * x], row1[x1]));
            }
}

typedef struct {
    uint32_t level, x, y;
} Square;

uint32_t zones_visit(const Zones *z, uint32_t level, const Boxtree *points, const Vec2 *pos, uint32_t *out)
{
    Square stack[64];
    uint32_t depth = 0, n = 0;
    stack[depth++] = (Square){z->levels - 1, 0, 0};
    while (depth) {
        Square q = stack[--depth];
        uint32_t c = q.y * z->nx[q.level] + q.x;
        Box2 box = as_box(z->box[q.level][c]);
        if (box_is_empty(box) || !boxtree_any_in(points, pos, box))
            continue;
        if (q.level == level) {
            out[n++] = c;
            continue;
        }
        uint32_t l = q.level - 1;
        for (uint32_t y = 2 * q.y; y <= 2 * q.y + 1 && y < z->ny[l]; y++)
            for (uint32_t x = 2 * q.x; x <= 2 * q.x + 1 && x < z->nx[l]; x++)
                stack[depth++] = (Square){l, x, y};
    }
    return n;
}

bool zones_any_within(const Zones *z, const Vec2 *place, Vec2 p, double r)
{
    double r2 = r * r;
    uint32_t x0 = column(p.x - r, z->field.x0, z->cell, z->nx[0]), x1 = column(p.x + r, z->field.x0, z->cell, z->nx[0]);
    uint32_t y0 = column(p.y - r, z->field.y0, z->cell, z->ny[0]), y1 = column(p.y + r, z->field.y0, z->cell, z->ny[0]);
    for (uint32_t y = y0; y <= y1; y++)
        for (uint32_t x = x0; x <= x1; x++)
            for (uint32_t i = z->head[(gsize)y * z->nx[0] + x]; i != UINT32_MAX; i = z->next[i])
                if (vec_dist2(place[i], p) < r2)
                    return true;
    return false;
}
