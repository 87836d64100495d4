/* The label map of areoles. */
#include "sim/areole.h"

#include <glib.h>
#include <string.h>

#include "image/painter.h"

/* Where the centre line of a row of pixels enters an areole or leaves it: pixels from `at` / TILE on, in row `at` % TILE of a block of TILE rows, have
 * `change` more, up or down, as their label. */
typedef struct {
    uint32_t at, change;
} Step;

struct AreoleMap {
    uint32_t n, n_blocks;
    uint32_t *start; /* [n_blocks + 1] into step */
    Step *step;
};

/* ---- from rings to steps ---- */

/* Rows whose centre lines lie between two heights, the upper one included; of sides that follow one another each line is cut by exactly one. */
static void rows_cut(const Painter *p, double ya, double yb, uint32_t *y0, uint32_t *y1)
{
    *y0 = (uint32_t)clamped(ceil(MIN(ya, yb) - 0.5), 0.0, (double)p->rows);
    *y1 = (uint32_t)clamped(ceil(MAX(ya, yb) - 0.5), 0.0, (double)p->rows);
}

/* What pixels hold are sums along the row, in which the order of steps at one place does not matter. A side, from place a to b with the areole to the left,
 * has a neighbour on the other side of the vein that is the same line, so both are cut from the same end: `turned` is whether that is b. */
static void add_side(const Painter *p, AreoleMap *m, Vec2 a, Vec2 b, bool turned, uint32_t label, uint32_t y0, uint32_t y1)
{
    uint32_t change = a.y < b.y ? label : 0u - label; /* down in the image: the areole is to the right */
    Vec2 from = turned ? b : a, to = turned ? a : b;
    for (uint32_t y = y0; y < y1; y++) {
        double x = from.x + (to.x - from.x) * ((y + 0.5 - from.y) / (to.y - from.y));
        uint32_t at = (uint32_t)clamped(ceil(x - 0.5), 0.0, (double)p->width);
        m->step[--m->start[y / TILE]] = (Step){at * TILE + y % TILE, change};
    }
}

static void enter_ring(const Painter *p, const Areoles *a, uint32_t label, uint32_t first, uint32_t last, bool fill, AreoleMap *m)
{
    Vec2 from = painter_to_image(p, a->at[last - 1]);
    uint32_t tail = a->node[last - 1], y0, y1;
    for (uint32_t i = first; i < last; i++) {
        uint32_t head = a->node[i];
        Vec2 to = painter_to_image(p, a->at[i]);
        rows_cut(p, from.y, to.y, &y0, &y1);
        if (fill)
            add_side(p, m, from, to, head < tail, label, y0, y1);
        else
            for (uint32_t y = y0; y < y1; y++)
                m->start[y / TILE]++;
        from = to;
        tail = head;
    }
}

static void enter_all(const Painter *p, const Areoles *a, bool fill, AreoleMap *m)
{
    for (uint32_t k = 0; k < a->n; k++)
        for (uint32_t r = a->first[k]; r < a->first[k + 1]; r++)
            enter_ring(p, a, k + 1, a->ring[r], a->ring[r + 1], fill, m);
}

void areole_map_ready(Painter *p)
{
    if (p->areoles != NULL)
        return;
    AreoleMap *m = p->areoles = g_new0(AreoleMap, 1);
    Areoles *areoles = network_areoles(p->net);
    m->n = areoles->n;
    m->n_blocks = (p->rows + TILE - 1) / TILE;
    m->start = g_new0(uint32_t, (gsize)m->n_blocks + 1);
    enter_all(p, areoles, false, m);
    for (uint32_t i = 0; i < m->n_blocks; i++)
        m->start[i + 1] += m->start[i];
    m->step = g_new(Step, (gsize)m->start[m->n_blocks] + 1);
    enter_all(p, areoles, true, m);
    areoles_free(areoles);
}

void areole_map_free(AreoleMap *m)
{
    if (m == NULL)
        return;
    g_free(m->start);
    g_free(m->step);
    g_free(m);
}

/* ---- from steps to pixels ---- */

typedef struct {
    const Painter *p;
    Plane *plane;
    uint32_t first; /* block */
} Labels;

static void label_pixels(const Labels *l, uint32_t y, const uint32_t *change)
{
    const Painter *p = l->p;
    const float *cover = field_row(p, &p->cover, y), *blade = p->net->margin != NULL ? field_row(p, &p->blade, y) : NULL;
    float *out = plane_row(p, l->plane, y);
    uint32_t label = 0, n = p->areoles->n;
    for (uint32_t x = 0; x < p->width; x++) {
        label += change[x];
        bool of_areole = label > 0 && label <= n && cover[x] < 0.5f && (blade == NULL || blade[x] >= 0.5f);
        out[x] = of_areole ? (float)label : 0.0f;
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
        if (m->start[block] == m->start[block + 1]) {
            memset(plane_row(p, l->plane, y0), 0, (gsize)(y1 - y0) * p->width * sizeof(float));
            continue;
        }
        memset(change, 0, row * TILE * sizeof *change);
        for (uint32_t i = m->start[block]; i < m->start[block + 1]; i++)
            change[m->step[i].at % TILE * row + m->step[i].at / TILE] += m->step[i].change;
        for (uint32_t y = y0; y < y1; y++)
            label_pixels(l, y, change + row * (y - block * TILE));
    }
    g_free(change);
}

Plane *paint_areole(Painter *p)
{
    areole_map_ready(p);
    const AreoleMap *m = p->areoles;
    Labels l = {p, painter_plane(p, MAP_AREOLE), p->y0 / TILE};
    l.plane->high = MAX(m->n, 1);
    painter_cover(p);
    if (p->net->margin != NULL)
        painter_blade(p);
    if (p->y1 > p->y0)
        pool_for(p->pool, (p->y1 - 1) / TILE + 1 - l.first, 1, label_blocks, &l);
    return l.plane;
}
