/* Erosion and dilation by discs, and the widest place of a region. */
#include <math.h>
#include <string.h>

#include "scan/mask.h"

/* Pixels of the region that counts: those with `bit` set, or those without. */
typedef struct {
    const Mask *m;
    uint8_t bit;
    bool set;
    uint32_t r;      /* whole part of the radius */
    int64_t *half;   /* [r + 1] half the width of the disc that many rows from its centre */
    uint32_t *above; /* [width] rows to the nearest one in this column above, r + 1 when there is none that near */
    uint32_t *clear; /* [width] row up to which, from this one on, there is none */
    int64_t *reach;  /* [width] half the width of the disc around the nearest one in this column that lies in this row, -1: nothing */
    bool *near;      /* [width] */
} Sweep;

static void sweep_init(Sweep *s, const Mask *m, uint8_t bit, bool set, double r)
{
    *s = (Sweep){.m = m, .bit = bit, .set = set};
    double most = (double)m->width + (double)m->height;
    r = r > most ? most : r;
    s->r = (uint32_t)r;
    s->half = g_new(int64_t, (gsize)s->r + 1);
    for (uint32_t k = 0; k <= s->r; k++)
        s->half[k] = (int64_t)floor(sqrt(r * r - (double)k * k));
    s->above = g_new(uint32_t, m->width);
    s->clear = g_new0(uint32_t, m->width);
    s->reach = g_new(int64_t, m->width);
    s->near = g_new(bool, m->width);
    for (uint32_t x = 0; x < m->width; x++)
        s->above[x] = s->r + 1;
}

static void sweep_clear(Sweep *s)
{
    g_free(s->half);
    g_free(s->above);
    g_free(s->clear);
    g_free(s->reach);
    g_free(s->near);
}

static inline bool counts(const Sweep *s, uint8_t px) { return ((px & s->bit) != 0) == s->set; }

/* For row y, and the rows in order: how wide the discs of radius r around the pixels of each column are there. Looks r rows ahead, so this row and
 * those below must still be as they were. */
static void sweep_columns(Sweep *s, uint32_t y)
{
    const Mask *m = s->m;
    uint32_t end = m->height - y > s->r ? y + s->r + 1 : m->height;
    for (uint32_t x = 0; x < m->width; x++) {
        uint32_t c = MAX(s->clear[x], y);
        while (c < end && !counts(s, *mask_at(m, x, c)))
            c++;
        s->clear[x] = c;
        uint32_t below = c < end ? c - y : s->r + 1;
        s->above[x] = below == 0 ? 0 : MIN(s->above[x] + 1, s->r + 1);
        uint32_t nearest = MIN(below, s->above[x]);
        s->reach[x] = nearest <= s->r ? s->half[nearest] : -1;
    }
}

/* Which pixels of row y have one that counts within the radius. */
static void sweep_row(Sweep *s, uint32_t y)
{
    sweep_columns(s, y);
    int64_t n = s->m->width, edge = -1;
    for (int64_t x = 0; x < n; x++) {
        edge = MAX(edge, s->reach[x] < 0 ? -1 : x + s->reach[x]);
        s->near[x] = edge >= x;
    }
    edge = n;
    for (int64_t x = n - 1; x >= 0; x--) {
        edge = MIN(edge, s->reach[x] < 0 ? n : x - s->reach[x]);
        s->near[x] |= edge <= x;
    }
}

static void move_border(const Mask *m, uint8_t from, uint8_t to, double r, bool outward)
{
    Sweep s;
    sweep_init(&s, m, from, outward, r);
    for (uint32_t y = 0; y < m->height; y++) {
        sweep_row(&s, y);
        for (uint32_t x = 0; x < m->width; x++) {
            uint8_t *px = mask_at(m, x, y);
            *px = (uint8_t)((*px & ~to) | (s.near[x] == outward ? to : 0));
        }
    }
    sweep_clear(&s);
}

void mask_erode(const Mask *m, uint8_t from, uint8_t to, double r) { move_border(m, from, to, r, false); }
void mask_dilate(const Mask *m, uint8_t from, uint8_t to, double r) { move_border(m, from, to, r, true); }

/* On a coarse grid, by the 3-4 chamfer distance (Borgefors 1986). */
double mask_widest(const Mask *m, uint8_t bit)
{
    enum { FINEST = 768 };
    uint32_t step = MAX(m->width, m->height) / FINEST + 1, w = (m->width - 1) / step + 1, h = (m->height - 1) / step + 1;
    size_t stride = (size_t)w + 2;
    uint32_t *d = g_new0(uint32_t, stride * ((size_t)h + 2)), most = 0;
    for (uint32_t y = 0; y < h; y++)
        for (uint32_t x = 0; x < w; x++) {
            uint32_t *p = d + (y + 1) * stride + x + 1;
            uint32_t side = MIN(p[-1], p[-(ptrdiff_t)stride]) + 3, corner = MIN(p[-(ptrdiff_t)stride - 1], p[-(ptrdiff_t)stride + 1]) + 4;
            *p = *mask_at(m, x * step, y * step) & bit ? MIN(side, corner) : 0;
        }
    for (uint32_t y = h; y-- > 0;)
        for (uint32_t x = w; x-- > 0;) {
            uint32_t *p = d + (y + 1) * stride + x + 1;
            *p = MIN(*p, MIN(MIN(p[1], p[stride]) + 3, MIN(p[stride + 1], p[stride - 1]) + 4));
            most = MAX(most, *p);
        }
    g_free(d);
    return most / 3.0 * step;
}
