/* Thinning. The border is peeled off by Euclidean distance, half a pixel at a time, so that it comes from all sides at the same speed whatever
 * their direction; within such a layer as by Rosenfeld (1975): from each of the four sides in turn, all pixels at once that are simple
 * and no ends. That keeps the topology and, unlike one pixel after the other, doesn't eat lines up from their ends. */
#include <string.h>

#include "scan/centre_private.h"

enum {
    REACHED = 4, /* may go: its distance is no more than the layer's */
    QUEUED = 8,
    AROUND = 16, /* background that was looked at */
    SMALL = 32,  /* of a small hole */
};

/* Exact squared distances from pixels of a row to the nearest background pixel, centre to centre (Meijster, Roerdink & Hesselink 2000). The
 * nearest is never beyond the first background pixel of the row itself, so each run of the row is done alone. */
typedef struct {
    const Thinned *t;
    uint32_t *above;     /* [stride] rows to the nearest background above or here */
    uint32_t *clear;     /* [stride] row up to which, from this one on, there is none */
    int64_t *g;          /* [stride] square of the distance within the column */
    uint32_t *low, *from; /* [stride] columns of the lower envelope's parabolas, and where each begins */
} Distances;

static void distances_init(Distances *d, const Thinned *t)
{
    uint32_t n = t->stride;
    *d = (Distances){t, g_new0(uint32_t, n), g_new0(uint32_t, n), g_new(int64_t, n), g_new(uint32_t, n), g_new(uint32_t, n)};
}

static void distances_clear(Distances *d)
{
    g_free(d->above);
    g_free(d->clear);
    g_free(d->g);
    g_free(d->low);
    g_free(d->from);
}

/* For row y, and the rows in order. */
static void distances_columns(Distances *d, uint32_t y)
{
    const uint8_t *row = d->t->px + (size_t)y * d->t->stride;
    for (uint32_t x = 0; x < d->t->stride; x++) {
        if (!(row[x] & THIN_IN)) {
            d->above[x] = 0;
            d->g[x] = 0;
            continue;
        }
        d->above[x]++;
        uint32_t c = MAX(d->clear[x], y);
        while (d->t->px[(size_t)c * d->t->stride + x] & THIN_IN) /* the rim ends it */
            c++;
        d->clear[x] = c;
        int64_t nearest = MIN(d->above[x], c - y);
        d->g[x] = nearest * nearest;
    }
}

/* First column where the parabola at u is below that at i < u. */
static int64_t crossing(const Distances *d, int64_t i, int64_t u)
{
    int64_t a = u * u - i * i + d->g[u] - d->g[i], b = 2 * (u - i);
    return a < 0 ? 0 : a / b + 1;
}

/* Squares for the columns x0 … x1 of a run, to out. */
static void distances_run(Distances *d, uint32_t x0, uint32_t x1, uint32_t *out)
{
    uint32_t n = 1, k = 0;
    d->low[0] = x0 - 1;
    d->from[0] = 0;
    for (uint32_t u = x0; u <= x1 + 1; u++) {
        int64_t start = crossing(d, d->low[n - 1], u);
        while (n > 1 && start <= d->from[n - 1]) {
            n--;
            start = crossing(d, d->low[n - 1], u);
        }
        if (start > (int64_t)x1)
            continue;
        d->low[n] = u;
        d->from[n++] = (uint32_t)start;
    }
    for (uint32_t x = x0; x <= x1; x++) {
        while (k + 1 < n && d->from[k + 1] <= x)
            k++;
        int64_t dx = (int64_t)x - d->low[k];
        out[x - x0] = (uint32_t)MIN(dx * dx + d->g[d->low[k]], (int64_t)UINT32_MAX);
    }
}

/* For all pixels of the region, row by row. */
static uint32_t *region_distances(const Thinned *t, uint32_t rows, uint32_t area)
{
    uint32_t *out = g_new(uint32_t, area), n = 0;
    Distances d;
    distances_init(&d, t);
    for (uint32_t y = 1; y + 1 < rows; y++) {
        const uint8_t *row = t->px + (size_t)y * t->stride;
        distances_columns(&d, y);
        for (uint32_t x = 1; x + 1 < t->stride; x++) {
            if (!(row[x] & THIN_IN))
                continue;
            uint32_t first = x;
            while (row[x + 1] & THIN_IN)
                x++;
            distances_run(&d, first, x, out + n);
            n += x - first + 1;
        }
    }
    distances_clear(&d);
    return out;
}

static uint32_t layer_of(uint32_t square) { return (uint32_t)floor(2.0 * sqrt((double)square)); }

/* Pixels of the region by layer, each in the order of rows; *end[k] is where layer k ends. */
static uint32_t *layers(const Thinned *t, uint32_t rows, const uint32_t *square, uint32_t area, uint32_t *n_layers, uint32_t **end)
{
    uint32_t most = 0, *order = g_new(uint32_t, area), k = 0;
    for (uint32_t i = 0; i < area; i++)
        most = MAX(most, square[i]);
    *n_layers = layer_of(most) + 1;
    uint32_t *e = *end = g_new0(uint32_t, *n_layers + 1);
    for (uint32_t i = 0; i < area; i++)
        e[layer_of(square[i]) + 1]++;
    for (uint32_t i = 0; i < *n_layers; i++)
        e[i + 1] += e[i];
    for (size_t at = 0; at < (size_t)rows * t->stride; at++)
        if (t->px[at] & THIN_IN)
            order[e[layer_of(square[k++])]++] = (uint32_t)at; /* moves each start to its end */
    return order;
}

/* Offsets of the neighbours, clockwise from the one above. */
static void neighbour_offsets(const Thinned *t, ptrdiff_t at[8])
{
    ptrdiff_t s = t->stride;
    memcpy(at, (const ptrdiff_t[8]){-s, 1 - s, 1, 1 + s, s, s - 1, -1, -s - 1}, 8 * sizeof *at);
}

/* For each set of neighbours whether a pixel with them is simple (Yokoi's number is 1) and no end. */
static void fill_table(bool goes[256])
{
    for (unsigned set = 0; set < 256; set++) {
        unsigned number = 0, count = 0;
        for (unsigned k = 0; k < 8; k++)
            count += set >> k & 1;
        for (unsigned k = 0; k < 8; k += 2) {
            bool a = set >> k & 1, b = set >> (k + 1) & 1, c = set >> ((k + 2) & 7) & 1;
            number += !a && (b || c);
        }
        goes[set] = number == 1 && count > 1;
    }
}

typedef struct {
    uint8_t *px;
    ptrdiff_t step[8];
    bool goes[256];
    GArray *now, *next, *going; /* uint32_t */
} Peeling;

static bool may_go(const Peeling *p, uint32_t at, unsigned side)
{
    const uint8_t *c = p->px + at;
    if (!(*c & THIN_LINE) || (c[p->step[side]] & THIN_LINE))
        return false;
    unsigned set = 0;
    for (unsigned k = 0; k < 8; k++)
        set |= (unsigned)(c[p->step[k]] & THIN_LINE ? 1 : 0) << k;
    return p->goes[set];
}

static void peel_side(Peeling *p, unsigned side)
{
    g_array_set_size(p->going, 0);
    for (guint i = 0; i < p->now->len; i++) {
        uint32_t at = g_array_index(p->now, uint32_t, i);
        if (may_go(p, at, side))
            g_array_append_val(p->going, at);
    }
    for (guint i = 0; i < p->going->len; i++)
        p->px[g_array_index(p->going, uint32_t, i)] &= (uint8_t)~THIN_LINE;
    for (guint i = 0; i < p->going->len; i++)
        for (unsigned k = 0; k < 8; k++) {
            uint32_t at = (uint32_t)(g_array_index(p->going, uint32_t, i) + p->step[k]);
            if ((p->px[at] & (THIN_LINE | REACHED | QUEUED)) == (THIN_LINE | REACHED)) {
                p->px[at] |= QUEUED;
                g_array_append_val(p->next, at);
            }
        }
}

/* Only pixels whose neighbours changed are looked at again. */
static void peel_layer(Peeling *p, const uint32_t *at, uint32_t n)
{
    g_array_set_size(p->now, 0);
    g_array_append_vals(p->now, at, n);
    for (uint32_t i = 0; i < n; i++)
        p->px[at[i]] |= REACHED;
    while (p->now->len > 0) {
        for (unsigned side = 0; side < 4; side++)
            peel_side(p, (const unsigned[]){0, 4, 2, 6}[side]);
        for (guint i = 0; i < p->next->len; i++)
            p->px[g_array_index(p->next, uint32_t, i)] &= (uint8_t)~QUEUED;
        GArray *empty = p->now;
        p->now = p->next;
        p->next = empty;
        g_array_set_size(p->next, 0);
    }
}

static void peel(Thinned *t, const uint32_t *order, const uint32_t *end, uint32_t n_layers)
{
    Peeling p = {.px = t->px, .now = g_array_new(FALSE, FALSE, 4), .next = g_array_new(FALSE, FALSE, 4), .going = g_array_new(FALSE, FALSE, 4)};
    neighbour_offsets(t, p.step);
    fill_table(p.goes);
    for (uint32_t k = 0; k < n_layers; k++)
        peel_layer(&p, order + (k ? end[k - 1] : 0), end[k] - (k ? end[k - 1] : 0));
    g_array_free(p.now, TRUE);
    g_array_free(p.next, TRUE);
    g_array_free(p.going, TRUE);
}

/* The extent of a bit; false when no pixel has it. */
static bool extent(const Mask *m, uint8_t bit, MaskBox *b, uint32_t *area)
{
    *b = (MaskBox){UINT32_MAX, UINT32_MAX, 0, 0};
    uint64_t n = 0;
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++)
            if (*mask_at(m, x, y) & bit) {
                *b = (MaskBox){MIN(b->x0, x), MIN(b->y0, y), MAX(b->x1, x), y};
                n++;
            }
    g_assert(n < UINT32_MAX);
    *area = (uint32_t)n;
    return n > 0;
}

static void keep_lines(Thinned *t, uint32_t rows, const uint32_t *square)
{
    size_t all = (size_t)rows * t->stride;
    for (size_t at = 0; at < all; at++)
        t->n += (t->px[at] & THIN_LINE) != 0;
    t->at = g_new(uint32_t, t->n);
    t->radius = g_new(double, t->n);
    uint32_t n = 0, k = 0;
    for (size_t at = 0; at < all; at++) {
        if (t->px[at] & THIN_LINE) {
            t->at[n] = (uint32_t)at;
            t->radius[n++] = sqrt((double)square[k]) - 0.5; /* the border is halfway to that pixel */
        }
        k += t->px[at] & THIN_IN;
    }
}

/* Returns how many pixels were added to the region. */
static uint32_t fill_holes(Thinned *t, uint32_t rows, double hole)
{
    static const Flood look = {THIN_IN | AROUND, 0, AROUND, false}, take = {THIN_IN | SMALL, 0, SMALL, false};
    Mask all = {t->stride, rows, t->stride, t->px};
    uint32_t filled = 0;
    for (uint32_t y = 0; y < rows; y++)
        for (uint32_t x = 0; x < t->stride; x++) {
            if (*mask_at(&all, x, y) & (THIN_IN | AROUND))
                continue;
            bool outside = x == 0 && y == 0;
            uint64_t n = mask_flood(&all, &look, x, y, NULL);
            if (!outside && (double)n < hole)
                filled += (uint32_t)mask_flood(&all, &take, x, y, NULL);
        }
    for (size_t at = 0; at < (size_t)rows * t->stride; at++)
        t->px[at] = t->px[at] & (THIN_IN | SMALL) ? THIN_IN | THIN_LINE : 0;
    return filled;
}

bool thinned_init(Thinned *t, const Mask *m, uint8_t bit, double hole)
{
    *t = (Thinned){.px = NULL};
    uint32_t area, n_layers, *end;
    if (!extent(m, bit, &t->box, &area))
        return false;
    t->stride = t->box.x1 - t->box.x0 + 3;
    uint32_t rows = t->box.y1 - t->box.y0 + 3;
    g_assert((uint64_t)rows * t->stride <= UINT32_MAX); /* eight times what a scan may have */
    t->px = g_new0(uint8_t, (size_t)rows * t->stride);
    for (uint32_t y = 1; y + 1 < rows; y++)
        for (uint32_t x = 1; x + 1 < t->stride; x++)
            if (*mask_at(m, t->box.x0 + x - 1, t->box.y0 + y - 1) & bit)
                t->px[(size_t)y * t->stride + x] = THIN_IN | THIN_LINE;
    if (hole > 1.0)
        area += fill_holes(t, rows, hole);
    uint32_t *square = region_distances(t, rows, area), *order = layers(t, rows, square, area, &n_layers, &end);
    peel(t, order, end, n_layers);
    g_free(order);
    g_free(end);
    keep_lines(t, rows, square);
    g_free(square);
    return true;
}

void thinned_clear(Thinned *t)
{
    g_free(t->px);
    g_free(t->at);
    g_free(t->radius);
}

void centre_thin(const Mask *m, uint8_t from, uint8_t to)
{
    Thinned t;
    bool any = thinned_init(&t, m, from, 0.0);
    mask_clear(m, to);
    for (uint32_t i = 0; any && i < t.n; i++)
        *mask_at(m, t.box.x0 + t.at[i] % t.stride - 1, t.box.y0 + t.at[i] / t.stride - 1) |= to;
    thinned_clear(&t);
}
