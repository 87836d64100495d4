/* The label map of areoles. */
#include "sim/areole.h"

#include <glib.h>
#include <string.h>

#include "image/painter.h"

/* A side of an areole's ring whose pixel rows' centre lines it cuts, from place a to b with the areole to the left. */
typedef struct {
    uint32_t a, b, label;
} Side;

/* Sides by the blocks of TILE rows they reach into. */
struct AreoleMap {
    Areoles *areoles;
    uint32_t n_blocks;
    uint32_t *start; /* [n_blocks + 1] into side */
    Side *side;
};

/* ---- from rings to blocks ---- */

/* Rows whose centre lines lie between two heights, the upper one included; of sides that follow one another each line is cut by exactly one. */
static void rows_cut(const Painter *p, double ya, double yb, uint32_t *y0, uint32_t *y1)
{
    *y0 = (uint32_t)CLAMP(ceil(MIN(ya, yb) - 0.5), 0.0, (double)p->rows);
    *y1 = (uint32_t)CLAMP(ceil(MAX(ya, yb) - 0.5), 0.0, (double)p->rows);
}

static void enter(const Painter *p, AreoleMap *m, Side s, bool fill)
{
    uint32_t y0, y1;
    rows_cut(p, painter_to_image(p, m->areoles->place[s.a]).y, painter_to_image(p, m->areoles->place[s.b]).y, &y0, &y1);
    if (y0 >= y1)
        return;
    for (uint32_t block = y0 / TILE; block <= (y1 - 1) / TILE; block++) {
        if (fill)
            m->side[--m->start[block]] = s;
        else
            m->start[block]++;
    }
}

static void enter_all(const Painter *p, AreoleMap *m, bool fill)
{
    const Areoles *a = m->areoles;
    for (uint32_t k = 0; k < a->n; k++)
        for (uint32_t r = a->first[k]; r < a->first[k + 1]; r++)
            for (uint32_t i = a->ring[r]; i < a->ring[r + 1]; i++)
                enter(p, m, (Side){a->node[i], a->node[i + 1 < a->ring[r + 1] ? i + 1 : a->ring[r]], k + 1}, fill);
}

void areole_map_ready(Painter *p)
{
    if (p->areoles != NULL)
        return;
    AreoleMap *m = p->areoles = g_new0(AreoleMap, 1);
    m->areoles = network_areoles(p->net);
    m->n_blocks = (p->rows + TILE - 1) / TILE;
    m->start = g_new0(uint32_t, (gsize)m->n_blocks + 1);
    enter_all(p, m, false);
    for (uint32_t i = 0; i < m->n_blocks; i++)
        m->start[i + 1] += m->start[i];
    m->side = g_new(Side, (gsize)m->start[m->n_blocks] + 1);
    enter_all(p, m, true);
}

void areole_map_free(AreoleMap *m)
{
    if (m == NULL)
        return;
    areoles_free(m->areoles);
    g_free(m->start);
    g_free(m->side);
    g_free(m);
}

/* ---- from blocks to pixels ---- */

typedef struct {
    const Painter *p;
    Plane *plane;
    uint32_t first; /* block */
} Labels;

/* Where a side cuts a row the label changes by the areole's number, up or down: what pixels hold are sums along the row, in which the order of
 * sides that cut it at one place does not matter. A side has a neighbour on the other side of the vein that is the same line, so both are
 * cut at the same place: the end of the lower index comes first. */
static void add_side(const Labels *l, const Side *s, uint32_t y0, uint32_t y1, uint32_t *change)
{
    const Painter *p = l->p;
    const Vec2 *place = p->areoles->areoles->place;
    Vec2 a = painter_to_image(p, place[MIN(s->a, s->b)]), b = painter_to_image(p, place[MAX(s->a, s->b)]);
    bool down = (a.y < b.y) == (s->a < s->b); /* in the image: the areole is to the right */
    uint32_t from, to;
    rows_cut(p, a.y, b.y, &from, &to);
    for (uint32_t y = MAX(from, y0); y < MIN(to, y1); y++) {
        double x = a.x + (b.x - a.x) * ((y + 0.5 - a.y) / (b.y - a.y));
        uint32_t at = (uint32_t)CLAMP(ceil(x - 0.5), 0.0, (double)p->width);
        change[(gsize)(y - y0) * (p->width + 1) + at] += down ? s->label : 0u - s->label;
    }
}

static void label_pixels(const Labels *l, uint32_t y, const uint32_t *change)
{
    const Painter *p = l->p;
    const float *cover = field_row(p, &p->cover, y), *blade = p->net->margin != NULL ? field_row(p, &p->blade, y) : NULL;
    float *out = plane_row(p, l->plane, y);
    uint32_t label = 0, n = p->areoles->areoles->n;
    for (uint32_t x = 0; x < p->width; x++) {
        label += change[x];
        if (label > 0 && label <= n && cover[x] < 0.5f && (blade == NULL || blade[x] >= 0.5f))
            out[x] = (float)label;
    }
}

static void label_blocks(uint32_t first, uint32_t last, void *user)
{
    const Labels *l = user;
    const Painter *p = l->p;
    const AreoleMap *m = p->areoles;
    gsize row = (gsize)p->width + 1;
    uint32_t *change = g_new(uint32_t, row * TILE);
    for (uint32_t block = l->first + first; block < l->first + last; block++) {
        uint32_t y0 = MAX(block * TILE, p->y0), y1 = MIN((block + 1) * TILE, p->y1);
        if (m->start[block] == m->start[block + 1])
            continue;
        memset(change, 0, row * TILE * sizeof *change);
        for (uint32_t i = m->start[block]; i < m->start[block + 1]; i++)
            add_side(l, &m->side[i], y0, y1, change);
        for (uint32_t y = y0; y < y1; y++)
            label_pixels(l, y, change + row * (y - y0));
    }
    g_free(change);
}

Plane *paint_areole(Painter *p)
{
    areole_map_ready(p);
    const AreoleMap *m = p->areoles;
    Labels l = {p, painter_plane(p, MAP_AREOLE), p->y0 / TILE};
    l.plane->high = MAX(m->areoles->n, 1);
    painter_cover(p);
    if (p->net->margin != NULL)
        painter_blade(p);
    if (p->y1 > p->y0)
        pool_for(p->pool, (p->y1 - 1) / TILE + 1 - l.first, 1, label_blocks, &l);
    return l.plane;
}
