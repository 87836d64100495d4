#include "scan/mask.h"

#include <string.h>

#define EDGING 0.02 /* of the shorter side */

/* A run of pixels that were taken, whose neighbours above and below are to be looked at. */
typedef struct {
    uint32_t x0, x1, y;
} Run;

static inline bool open_to(const Mask *m, const Flood *f, uint32_t x, uint32_t y) { return (*mask_at(m, x, y) & f->test) == f->want; }

/* Takes the run of row y around (x, y). */
static Run take_run(const Mask *m, const Flood *f, uint32_t x, uint32_t y)
{
    Run run = {x, x, y};
    while (run.x0 > 0 && open_to(m, f, run.x0 - 1, y))
        run.x0--;
    while (run.x1 + 1 < m->width && open_to(m, f, run.x1 + 1, y))
        run.x1++;
    for (uint32_t i = run.x0; i <= run.x1; i++)
        *mask_at(m, i, y) |= f->set;
    return run;
}

static void take_beside(const Mask *m, const Flood *f, const Run *run, uint32_t y, GArray *runs)
{
    uint32_t x = run->x0 - (f->corners && run->x0 > 0), last = run->x1 + (f->corners && run->x1 + 1 < m->width);
    for (; x <= last; x++) {
        if (!open_to(m, f, x, y))
            continue;
        Run next = take_run(m, f, x, y);
        g_array_append_val(runs, next);
        x = next.x1;
    }
}

uint64_t mask_flood(const Mask *m, const Flood *flood, uint32_t x, uint32_t y, MaskBox *box)
{
    GArray *runs = g_array_new(FALSE, FALSE, sizeof(Run));
    MaskBox b = {x, y, x, y};
    uint64_t n = 0;
    Run run = take_run(m, flood, x, y);
    g_array_append_val(runs, run);
    while (runs->len > 0) {
        run = g_array_index(runs, Run, runs->len - 1);
        g_array_set_size(runs, runs->len - 1);
        n += run.x1 - run.x0 + 1;
        b = (MaskBox){MIN(b.x0, run.x0), MIN(b.y0, run.y), MAX(b.x1, run.x1), MAX(b.y1, run.y)};
        if (run.y > 0)
            take_beside(m, flood, &run, run.y - 1, runs);
        if (run.y + 1 < m->height)
            take_beside(m, flood, &run, run.y + 1, runs);
    }
    g_array_free(runs, TRUE);
    if (box)
        *box = b;
    return n;
}

/* How many of a component's pixels are in the mask's outermost rows and columns. A few of others in the same box do no harm. */
static uint64_t border_pixels(const Mask *m, const Component *c)
{
    uint64_t n = 0;
    for (uint32_t x = c->box.x0; x <= c->box.x1; x++) {
        n += c->box.y0 == 0 && (*mask_at(m, x, 0) & MASK_SEEN);
        n += c->box.y1 == m->height - 1 && (*mask_at(m, x, m->height - 1) & MASK_SEEN);
    }
    for (uint32_t y = c->box.y0; y <= c->box.y1; y++) {
        n += c->box.x0 == 0 && (*mask_at(m, 0, y) & MASK_SEEN);
        n += c->box.x1 == m->width - 1 && (*mask_at(m, m->width - 1, y) & MASK_SEEN);
    }
    return n;
}

static bool is_edging(const Mask *m, const Component *c)
{
    uint64_t n = border_pixels(m, c);
    double side = MIN(m->width, m->height);
    return (double)n > 0.5 * side && (double)c->area < EDGING * side * (double)n;
}

static gint larger_first(gconstpointer a, gconstpointer b, gpointer user)
{
    const Component *c = a, *d = b;
    return c->area != d->area ? (c->area > d->area ? -1 : 1) : c->y != d->y ? (c->y < d->y ? -1 : 1) : (c->x > d->x) - (c->x < d->x);
}

GArray *mask_components(const Mask *m, double share)
{
    static const Flood flood = {MASK_LEAF | MASK_SEEN, MASK_LEAF, MASK_SEEN, true};
    GArray *all = g_array_new(FALSE, FALSE, sizeof(Component));
    uint64_t largest = 0;
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++) {
            if (!open_to(m, &flood, x, y))
                continue;
            Component c = {.x = x, .y = y};
            c.area = mask_flood(m, &flood, x, y, &c.box);
            if ((double)c.area < share * (double)largest || is_edging(m, &c))
                continue;
            largest = MAX(largest, c.area);
            g_array_append_val(all, c);
        }
    if (all->len > 0)
        g_qsort_with_data(all->data, (gint)all->len, sizeof(Component), larger_first, NULL);
    while (all->len > 0 && (double)g_array_index(all, Component, all->len - 1).area < share * (double)largest)
        g_array_set_size(all, all->len - 1);
    return all;
}

/* Floods what lies around the leaf from the window's border; background hangs together over edges only. */
static void flood_outside(const Mask *w)
{
    static const Flood around = {MASK_THIS | MASK_OUT, 0, MASK_OUT, false};
    for (uint32_t x = 0; x < w->width; x++)
        for (uint32_t k = 0; k < 2; k++)
            if (open_to(w, &around, x, k ? w->height - 1 : 0))
                mask_flood(w, &around, x, k ? w->height - 1 : 0, NULL);
    for (uint32_t y = 0; y < w->height; y++)
        for (uint32_t k = 0; k < 2; k++)
            if (open_to(w, &around, k ? w->width - 1 : 0, y))
                mask_flood(w, &around, k ? w->width - 1 : 0, y, NULL);
}

void mask_take(const Mask *m, const Component *c)
{
    static const Flood flood = {MASK_LEAF | MASK_THIS, MASK_LEAF, MASK_THIS, true};
    mask_flood(m, &flood, c->x, c->y, NULL);
    Mask w = mask_window(m, c->box);
    flood_outside(&w);
    for (uint32_t y = 0; y < w.height; y++)
        for (uint32_t x = 0; x < w.width; x++) {
            uint8_t *px = mask_at(&w, x, y);
            *px |= *px & (MASK_THIS | MASK_OUT) ? 0 : MASK_THIS | MASK_HOLE;
        }
}

void mask_clear(const Mask *m, uint8_t bits)
{
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++)
            *mask_at(m, x, y) &= (uint8_t)~bits;
}
