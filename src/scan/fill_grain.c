#include "scan/fill_grain.h"

#include "geom/random.h"

enum { CHOICE = 12, MOST = 256, REACH = 64 };

typedef struct {
    double unrest;
    uint32_t x, y, turn;
} Candidate;

/* Of the cell at column x0 and row y0 of the box; -1 when it is not wholly leaf. */
static double unrest_of(const Scan *s, const Mask *m, MaskBox box, uint32_t x0, uint32_t y0)
{
    if (x0 + GRAIN_CELL > m->width || y0 + GRAIN_CELL > m->height)
        return -1.0;
    for (uint32_t y = y0; y < y0 + GRAIN_CELL; y++)
        for (uint32_t x = x0; x < x0 + GRAIN_CELL; x++)
            if (!(*mask_at(m, x, y) & MASK_CORE))
                return -1.0;
    const double n = GRAIN_CELL * GRAIN_CELL;
    double all = 0.0;
    for (uint32_t c = 0; c < s->channels; c++) {
        double sum = 0.0, square = 0.0;
        for (uint32_t y = y0; y < y0 + GRAIN_CELL; y++)
            for (uint32_t x = x0; x < x0 + GRAIN_CELL; x++) {
                double v = scan_sample(s, box.x0 + x, box.y0 + y, c);
                sum += v;
                square += v * v;
            }
        all += square / n - sum / n * (sum / n);
    }
    return MAX(all, 0.0);
}

void fill_grain_init(FillGrain *g, const Scan *s, const Mask *mask, MaskBox box)
{
    g->width = (mask->width + GRAIN_CELL - 1) / GRAIN_CELL;
    g->height = (mask->height + GRAIN_CELL - 1) / GRAIN_CELL;
    g->unrest = g_new(float, (gsize)g->width * g->height);
    for (uint32_t y = 0; y < g->height; y++)
        for (uint32_t x = 0; x < g->width; x++)
            g->unrest[(gsize)y * g->width + x] = (float)unrest_of(s, mask, box, x * GRAIN_CELL, y * GRAIN_CELL);
}

void fill_grain_clear(FillGrain *g) { g_free(g->unrest); }

static void ask(const FillGrain *g, int64_t x, int64_t y, Candidate *list, uint32_t *n)
{
    if (x < 0 || y < 0 || x >= g->width || y >= g->height || *n >= MOST || !(g->unrest[(gsize)y * g->width + (gsize)x] >= 0.0f))
        return;
    list[*n] = (Candidate){(double)g->unrest[(gsize)y * g->width + (gsize)x], (uint32_t)x, (uint32_t)y, *n};
    (*n)++;
}

static gint calmer_first(gconstpointer a, gconstpointer b, gpointer user)
{
    const Candidate *c = a, *d = b;
    return c->unrest != d->unrest ? (c->unrest < d->unrest ? -1 : 1) : (c->turn > d->turn) - (c->turn < d->turn);
}

bool fill_grain_source(const FillGrain *g, uint32_t x, uint32_t y, GrainSource *out)
{
    Candidate list[MOST];
    uint32_t n = 0;
    for (int64_t r = 0; r <= REACH && n < CHOICE; r++) /* squares around the cell, one after the other, each to its end */
        for (int64_t k = -r; k <= r; k++) {
            ask(g, x + k, y - r, list, &n);
            if (r == 0)
                break;
            ask(g, x + k, y + r, list, &n);
            if (k > -r && k < r) {
                ask(g, x - r, y + k, list, &n);
                ask(g, x + r, y + k, list, &n);
            }
        }
    if (n == 0)
        return false;
    g_qsort_with_data(list, (gint)n, sizeof *list, calmer_first, NULL);
    RandomBlock lot = random_block(0, RANDOM_GRAIN, 0, (uint64_t)y << 32 | x);
    const Candidate *c = &list[lot.w[0] % ((n + 1) / 2)];
    *out = (GrainSource){c->x, c->y, lot.w[1] & 1, lot.w[1] & 2};
    return true;
}
