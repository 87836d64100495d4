#include "scan/fang_region.h"

#include <math.h>

#include "scan/fang_map.h"

#define BAND 4.0
#define BAND_GROWS 2.0 /* pixels by pixel of sigma */
#define NEAR 1.5       /* what an edge may be off the border, pixels */

double fang_band(double sigma) { return BAND + BAND_GROWS * sigma; }

EdgesOperator fang_broad(EdgesOperator op) { return op == EDGES_CANNY || op == EDGES_LAPLACIAN ? EDGES_SOBEL : op; }

/* --- watershed --- */

/* Pixels to be flooded, by strength of the response; in each class first in, first out. */
enum { CLASSES = 1024 };
typedef struct {
    uint32_t x, y;
    uint8_t side; /* from which it is reached: MASK_CORE or MASK_OUT */
} Front;

typedef struct {
    const Mask *m;
    const FangSparse *response; /* in the band */
    double scale;           /* classes per unit of response */
    GArray *class[CLASSES]; /* Front */
    int lowest;
} Basins;

static const int8_t BESIDE[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};

/* By response, in the upper half of the classes on edges, in the lower half elsewhere. */
static int class_of(const Basins *b, uint32_t x, uint32_t y)
{
    int c = (int)((double)fang_sparse_at(b->response, x, y) * b->scale);
    return MIN(c, CLASSES / 2 - 1) + (*mask_at(b->m, x, y) & MASK_SEEN ? CLASSES / 2 : 0);
}

/* Puts the neighbours of a pixel that belong to no side yet into the queue. */
static void push_around(Basins *b, uint32_t x, uint32_t y, uint8_t side)
{
    for (int k = 0; k < 4; k++) {
        int64_t i = (int64_t)x + BESIDE[k][0], j = (int64_t)y + BESIDE[k][1];
        if (i < 0 || j < 0 || i >= b->m->width || j >= b->m->height)
            continue;
        Front f = {(uint32_t)i, (uint32_t)j, side};
        if (!(*mask_at(b->m, f.x, f.y) & (MASK_CORE | MASK_OUT)))
            g_array_append_val(b->class[MAX(class_of(b, f.x, f.y), b->lowest)], f);
    }
}

static void flood_band(Basins *b)
{
    for (b->lowest = 0; b->lowest < CLASSES; b->lowest++) {
        GArray *class = b->class[b->lowest];
        for (guint k = 0; k < class->len; k++) { /* it grows meanwhile */
            Front f = g_array_index(class, Front, k);
            uint8_t *px = mask_at(b->m, f.x, f.y);
            if (*px & (MASK_CORE | MASK_OUT))
                continue;
            *px |= f.side;
            push_around(b, f.x, f.y, f.side);
        }
        g_array_free(class, TRUE);
    }
}

/* Marks what is surely inside and what is surely outside. A narrow leaf has its middle for an inside. */
static void mark_sides(const Mask *m, double band)
{
    double widest = mask_widest(m, MASK_LEAF);
    mask_erode(m, MASK_LEAF, MASK_CORE, MIN(band, 0.5 * widest));
    mask_dilate(m, MASK_LEAF, MASK_OUT, band);
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++)
            *mask_at(m, x, y) ^= MASK_OUT;
}

static void part_band(Basins *b, double most)
{
    const Mask *m = b->m;
    b->scale = (CLASSES / 2 - 1) / most;
    for (int k = 0; k < CLASSES; k++)
        b->class[k] = g_array_new(FALSE, FALSE, sizeof(Front));
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++)
            if (*mask_at(m, x, y) & (MASK_OUT | MASK_CORE))
                push_around(b, x, y, *mask_at(m, x, y) & (MASK_OUT | MASK_CORE));
    flood_band(b);
}

/* The response in the band. */
static FangSparse *respond(const FangGrey *grey, const EdgesDef *used, const Mask *m, double *most)
{
    FangSparse *r = fang_sparse_new(grey->width, grey->height);
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++)
            if (!(*mask_at(m, x, y) & (MASK_CORE | MASK_OUT)))
                fang_sparse_want(r, x, y);
    fang_sparse_respond(r, grey, fang_broad(used->op), used->sigma);
    *most = 0.0;
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++)
            if (!(*mask_at(m, x, y) & (MASK_CORE | MASK_OUT)))
                *most = MAX(*most, (double)fang_sparse_at(r, x, y));
    return r;
}

/* --- how well they agree --- */

static bool is_margin(const Mask *m, uint32_t x, uint32_t y)
{
    if (!(*mask_at(m, x, y) & MASK_LEAF))
        return false;
    for (int k = 0; k < 4; k++) {
        int64_t i = (int64_t)x + BESIDE[k][0], j = (int64_t)y + BESIDE[k][1];
        if (i >= 0 && j >= 0 && i < m->width && j < m->height && !(*mask_at(m, (uint32_t)i, (uint32_t)j) & MASK_LEAF))
            return true;
    }
    return false;
}

static void measure(const Mask *m, FangMatch *fit)
{
    static const Flood gap = {MASK_WORK | MASK_HOLE, MASK_WORK, MASK_HOLE, true};
    uint64_t margin = 0, bare = 0, longest = 0;
    mask_dilate(m, MASK_SEEN, MASK_SEEN, NEAR);
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++) {
            if (!is_margin(m, x, y))
                continue;
            margin++;
            bare += !(*mask_at(m, x, y) & MASK_SEEN);
            *mask_at(m, x, y) |= *mask_at(m, x, y) & MASK_SEEN ? 0 : MASK_WORK;
        }
    for (uint32_t y = 0; bare > 0 && y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++) {
            uint64_t n = (*mask_at(m, x, y) & gap.test) == gap.want ? mask_flood(m, &gap, x, y, NULL) : 0;
            longest = MAX(longest, n);
        }
    fit->continuity = margin > 0 ? 1.0 - (double)bare / (double)margin : 1.0;
    fit->gap = (double)longest;
}

/* --- together --- */

/* Leaves `which` as MASK_LEAF and besides it the bits `others`; returns how many pixels. */
static double keep(const Mask *m, uint8_t which, uint8_t others)
{
    uint64_t n = 0;
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++) {
            uint8_t *px = mask_at(m, x, y);
            bool in = (*px & which) != 0;
            *px = (uint8_t)((in ? MASK_LEAF : 0) | (*px & others));
            n += in;
        }
    return (double)n;
}

FangMatch fang_region(const FangGrey *grey, const EdgesDef *used, const Mask *m)
{
    FangMatch fit = {.rough = keep(m, MASK_LEAF, 0)};
    double most;
    fang_mark_edges(grey, used, m);
    mark_sides(m, fang_band(used->sigma));
    FangSparse *response = respond(grey, used, m, &most);
    if (most > 0.0) {
        Basins b = {.m = m, .response = response};
        part_band(&b, most);
    }
    fang_sparse_free(response);
    fit.area = keep(m, most > 0.0 ? MASK_CORE : MASK_LEAF, MASK_SEEN);
    measure(m, &fit);
    keep(m, MASK_LEAF, 0);
    return fit;
}
