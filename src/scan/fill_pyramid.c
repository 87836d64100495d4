#include "scan/fill_pyramid.h"

enum { UNKNOWN, WANTED, KNOWN };
enum { SWEEPS = 12 }; /* each brings the edge nearer; what is left to do after the coarser level is local */

static FillLevel level_new(uint32_t width, uint32_t height)
{
    gsize n = (gsize)width * height;
    return (FillLevel){width, height, g_new0(uint8_t, n), g_new0(uint16_t, n)};
}

static void states_of_mask(FillLevel *l, const Mask *m)
{
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++) {
            uint8_t px = *mask_at(m, x, y), *state = &l->state[(gsize)(y / 2) * l->width + x / 2];
            if (px & MASK_CORE)
                *state = KNOWN;
            else if ((px & MASK_SEEN) && *state == UNKNOWN)
                *state = WANTED;
        }
}

static void states_of_level(FillLevel *l, const FillLevel *fine)
{
    for (uint32_t y = 0; y < fine->height; y++)
        for (uint32_t x = 0; x < fine->width; x++) {
            uint8_t *state = &l->state[(gsize)(y / 2) * l->width + x / 2];
            *state = MAX(*state, fine->state[(gsize)y * fine->width + x]);
        }
}

void fill_pyramid_init(FillPyramid *p, const Mask *mask, uint32_t depth)
{
    uint32_t w = mask->width, h = mask->height;
    *p = (FillPyramid){.parts = depth == 8 ? 256.0 : 1.0};
    do {
        w = (w + 1) / 2;
        h = (h + 1) / 2;
        FillLevel *l = &p->level[p->n];
        *l = level_new(w, h);
        if (p->n == 0)
            states_of_mask(l, mask);
        else
            states_of_level(l, l - 1);
        p->n++;
    } while (w > 1 || h > 1);
}

void fill_pyramid_clear(FillPyramid *p)
{
    for (uint32_t k = 0; k < p->n; k++) {
        g_free(p->level[k].state);
        g_free(p->level[k].value);
    }
}

/* ---- means ---- */

static uint16_t rounded(double v) { return (uint16_t)(v + 0.5); }

static void means_of_scan(FillLevel *l, double parts, const Scan *s, uint32_t channel, const Mask *m, MaskBox box)
{
    for (uint32_t y = 0; y < l->height; y++)
        for (uint32_t x = 0; x < l->width; x++) {
            double sum = 0.0;
            uint32_t n = 0;
            for (uint32_t j = 2 * y; j < MIN(2 * y + 2, m->height); j++)
                for (uint32_t i = 2 * x; i < MIN(2 * x + 2, m->width); i++)
                    if (*mask_at(m, i, j) & MASK_CORE) {
                        sum += scan_sample(s, box.x0 + i, box.y0 + j, channel);
                        n++;
                    }
            l->value[(gsize)y * l->width + x] = n > 0 ? rounded(parts * sum / n) : 0;
        }
}

static void means_of_level(FillLevel *l, const FillLevel *fine)
{
    for (uint32_t y = 0; y < l->height; y++)
        for (uint32_t x = 0; x < l->width; x++) {
            double sum = 0.0;
            uint32_t n = 0;
            for (uint32_t j = 2 * y; j < MIN(2 * y + 2, fine->height); j++)
                for (uint32_t i = 2 * x; i < MIN(2 * x + 2, fine->width); i++)
                    if (fine->state[(gsize)j * fine->width + i] == KNOWN) {
                        sum += fine->value[(gsize)j * fine->width + i];
                        n++;
                    }
            l->value[(gsize)y * l->width + x] = n > 0 ? rounded(sum / n) : 0;
        }
}

/* ---- between them ---- */

static double between(const FillLevel *l, double x, double y)
{
    x = CLAMP(x - 0.5, 0.0, l->width - 1.0);
    y = CLAMP(y - 0.5, 0.0, l->height - 1.0);
    uint32_t i = (uint32_t)x, j = (uint32_t)y, i1 = MIN(i + 1, l->width - 1), j1 = MIN(j + 1, l->height - 1);
    double fx = x - i, fy = y - j;
    const uint16_t *top = l->value + (gsize)j * l->width, *low = l->value + (gsize)j1 * l->width;
    return (top[i] * (1.0 - fx) + top[i1] * fx) * (1.0 - fy) + (low[i] * (1.0 - fx) + low[i1] * fx) * fy;
}

double fill_pyramid_at(const FillPyramid *p, uint32_t level, double x, double y)
{
    double by = 1.0 / (double)(2u << level);
    return between(&p->level[level], x * by, y * by) / p->parts;
}

static void relax(FillLevel *l, uint32_t x, uint32_t y)
{
    gsize i = (gsize)y * l->width + x;
    if (l->state[i] != WANTED)
        return;
    double sum = 0.0;
    uint32_t n = 0;
    if (x > 0 && l->state[i - 1] != UNKNOWN)
        sum += l->value[i - 1], n++;
    if (x + 1 < l->width && l->state[i + 1] != UNKNOWN)
        sum += l->value[i + 1], n++;
    if (y > 0 && l->state[i - l->width] != UNKNOWN)
        sum += l->value[i - l->width], n++;
    if (y + 1 < l->height && l->state[i + l->width] != UNKNOWN)
        sum += l->value[i + l->width], n++;
    if (n > 0)
        l->value[i] = rounded(sum / n);
}

/* There and back by turns, so that nothing leans to one side. */
static void solve(FillLevel *l)
{
    for (int k = 0; k < SWEEPS; k += 2) {
        for (uint32_t y = 0; y < l->height; y++)
            for (uint32_t x = 0; x < l->width; x++)
                relax(l, x, y);
        for (uint32_t y = l->height; y-- > 0;)
            for (uint32_t x = l->width; x-- > 0;)
                relax(l, x, y);
    }
}

void fill_pyramid_take(FillPyramid *p, const Scan *s, uint32_t channel, const Mask *mask, MaskBox box)
{
    means_of_scan(&p->level[0], p->parts, s, channel, mask, box);
    for (uint32_t k = 1; k < p->n; k++)
        means_of_level(&p->level[k], &p->level[k - 1]);
    for (uint32_t k = p->n - 1; k-- > 0;) { /* the last one is a single cell, and known */
        FillLevel *l = &p->level[k];
        for (uint32_t y = 0; y < l->height; y++)
            for (uint32_t x = 0; x < l->width; x++)
                if (l->state[(gsize)y * l->width + x] != KNOWN)
                    l->value[(gsize)y * l->width + x] = rounded(between(&p->level[k + 1], 0.5 * (x + 0.5), 0.5 * (y + 0.5)));
        solve(l);
    }
}
