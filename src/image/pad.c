/* Padding: each pixel beyond the margin takes its colour from the nearest pixel of the blade, exactly (the lower
 * envelope of parabolas of Felzenszwalb and Huttenlocher 2012: along rows first, then along columns). */
#include <glib.h>
#include <string.h>

#include "geom/parallel.h"
#include "image/painter.h"

enum { COLUMNS = 16 }; /* of one part */

typedef struct {
    Painter *p;
    const float *blade;
} Pad;

/* Nearest pixel of the blade in the same row, as its x; of two the left one. */
static void nearest_in_row(uint32_t y, void *user)
{
    const Pad *pad = user;
    uint32_t w = pad->p->width, *row = pad->p->source + (gsize)y * w;
    const float *blade = pad->blade + (gsize)y * w;
    uint32_t last = OWNER_NONE;
    for (uint32_t x = 0; x < w; x++) {
        if (blade[x] > 0.0f)
            last = x;
        row[x] = last;
    }
    last = OWNER_NONE;
    for (uint32_t x = w; x-- > 0;) {
        if (blade[x] > 0.0f)
            last = x;
        if (last != OWNER_NONE && (row[x] == OWNER_NONE || last - x < x - row[x]))
            row[x] = last;
    }
}

/* One parabola of the lower envelope: rows below `from` belong to those before it. */
typedef struct {
    uint32_t y, x;  /* the blade's pixel */
    int64_t height; /* its squared distance within its row */
    double from;
} Arch;

/* Where the parabola of b begins to be lower than that of a, a.y < b.y. */
static double meet(const Arch *a, const Arch *b)
{
    int64_t ya = a->y, yb = b->y;
    return (double)(b->height + yb * yb - a->height - ya * ya) / (double)(2 * (yb - ya));
}

static void pad_column(Painter *p, uint32_t x, Arch *arch, double reach2)
{
    uint32_t n = 0;
    for (uint32_t y = 0; y < p->rows; y++) {
        uint32_t at = p->source[(gsize)y * p->width + x];
        if (at == OWNER_NONE)
            continue;
        int64_t dx = (int64_t)at - x;
        Arch a = {y, at, dx * dx, -1.0};
        while (n > 0 && (a.from = meet(&arch[n - 1], &a)) <= arch[n - 1].from)
            n--;
        if (n == 0)
            a.from = -1.0;
        arch[n++] = a;
    }
    for (uint32_t y = 0, k = 0; y < p->rows; y++) {
        uint32_t *out = &p->source[(gsize)y * p->width + x];
        *out = OWNER_NONE;
        if (n == 0)
            continue;
        while (k + 1 < n && arch[k + 1].from < y)
            k++;
        double dy = (double)y - arch[k].y;
        if ((double)arch[k].height + dy * dy <= reach2)
            *out = arch[k].y * p->width + arch[k].x;
    }
}

static void pad_columns(uint32_t first, uint32_t last, void *user)
{
    Painter *p = user;
    double reach = p->style.padding;
    Arch *arch = g_new(Arch, p->rows);
    for (uint32_t x = first; x < last; x++)
        pad_column(p, x, arch, reach * reach);
    g_free(arch);
}

const uint32_t *painter_source(Painter *p)
{
    if (p->source == NULL) {
        Pad pad = {p, painter_blade(p)};
        p->source = g_new(uint32_t, (gsize)p->width * p->rows);
        painter_rows(p, nearest_in_row, &pad);
        parallel_for(p->style.threads, p->width, COLUMNS, pad_columns, p);
    }
    return p->source;
}

typedef struct {
    const Painter *p;
    Plane *plane;
} Fill;

static void fill_row(uint32_t y, void *user)
{
    const Fill *f = user;
    uint32_t w = f->p->width, nc = f->plane->channels;
    for (uint32_t x = 0; x < w; x++) {
        gsize at = (gsize)y * w + x, from = f->p->source[at];
        if (from != OWNER_NONE && from != at)
            memcpy(f->plane->px + at * nc, f->plane->px + from * nc, nc * sizeof(float));
    }
}

void painter_pad(Painter *p, Plane *plane)
{
    painter_source(p);
    Fill f = {p, plane};
    painter_rows(p, fill_row, &f);
}
