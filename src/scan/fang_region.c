#include "scan/fang_region.h"


/* How gaps in the edges are closed: by lower thresholds and by discs, in the order in which they are tried. */
static const double LOWER[] = {1.0, 2.0 / 3.0, 4.0 / 9.0};
#define MOST_CLOSED 4.0
static const struct {
    int map; /* of LOWER */
    double closed;
} TRIED[] = {{0, 0.0}, {0, 1.0}, {1, 0.0}, {1, 1.0}, {2, 0.0}, {2, 1.0}, {0, 2.0}, {1, 2.0}, {2, 2.0}, {0, MOST_CLOSED}, {1, MOST_CLOSED}, {2, MOST_CLOSED}};
enum { N_LOWER = 3 };
#define ENOUGH 0.985
#define PLAUSIBLE 1.3 /* times more or less than the leaf has by its level; holes, shadows and overlaps make some difference */
/* Radius of the disc that threads have no room for, grows with the smoothing that makes them broad. What is nearer than STUB such radii
 * to what is wider stays: tips of teeth. */
#define THREAD 2.5
#define THREAD_GROWS 1.5 /* pixels by pixel of sigma */
#define STUB 2.0
#define POCKET 3.0 /* plain parts with no room for a disc of this radius are pockets */

/* --- the region --- */

static bool is_open(const Mask *m, uint32_t x, uint32_t y) { return !(*mask_at(m, x, y) & (MASK_LEAF | MASK_OUT)); }

/* The frame of an image as one row of pixels, clockwise from the upper left. */
static void frame_pixel(const Mask *m, uint64_t i, uint32_t *x, uint32_t *y)
{
    uint64_t w = m->width, h = m->height;
    *x = (uint32_t)(i < w ? i : i < w + h ? w - 1 : i < 2 * w + h ? 2 * w + h - 1 - i : 0);
    *y = (uint32_t)(i < w ? 0 : i < w + h ? i - w : i < 2 * w + h ? h - 1 : 2 * (w + h) - 1 - i);
}

static void flood_from(const Mask *m, uint64_t from, uint64_t to)
{
    static const Flood around = {MASK_LEAF | MASK_OUT, 0, MASK_OUT, false};
    for (uint64_t i = from; i < to; i++) {
        uint32_t x, y;
        frame_pixel(m, i, &x, &y);
        if (is_open(m, x, y))
            mask_flood(m, &around, x, y, NULL);
    }
}

/* Floods from the stretches of the frame that are background. Each is looked at before any is flooded from, as a flood may reach others. */
static void flood_around(const Scan *s, const Threshold *t, const Mask *m)
{
    uint64_t n = 2 * ((uint64_t)m->width + m->height), start = 0;
    GArray *stretch = g_array_new(FALSE, FALSE, sizeof(uint64_t)); /* from, to, from, to … */
    double sum = 0.0;
    for (uint64_t i = 0; i <= n; i++) {
        uint32_t x = 0, y = 0;
        frame_pixel(m, MIN(i, n - 1), &x, &y);
        if (i < n && is_open(m, x, y)) {
            sum += channel_value(s, t->channel, x, y);
            continue;
        }
        double mean = i > start ? sum / (double)(i - start) : t->level;
        if (i > start && (mean < t->level) != t->dark) {
            g_array_append_val(stretch, start);
            g_array_append_val(stretch, i);
        }
        start = i + 1;
        sum = 0.0;
    }
    for (guint k = 0; k < stretch->len; k += 2)
        flood_from(m, g_array_index(stretch, uint64_t, k), g_array_index(stretch, uint64_t, k + 1));
    g_array_free(stretch, TRUE);
}

static void take_off_threads(const Mask *m, double r)
{
    mask_erode(m, MASK_LEAF, MASK_CORE, r);
    mask_dilate(m, MASK_CORE, MASK_CORE, (1.0 + STUB) * r);
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++) {
            uint8_t *px = mask_at(m, x, y);
            *px = (*px & (MASK_LEAF | MASK_CORE)) == (MASK_LEAF | MASK_CORE) ? MASK_LEAF : 0;
        }
}

/* Marks the largest of what edges enclose when they are made wider by r, less that widening, by MASK_LEAF and MASK_THIS, the rest by
 * nothing. Returns how many pixels of strict edges it has. */
static uint64_t enclose(const Scan *s, const Threshold *t, const GreyImage *edges, const GreyImage *strict, double sigma, const Mask *m, double r)
{
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++)
            *mask_at(m, x, y) = edges->px[(size_t)y * edges->width + x] > 0.0f ? MASK_LEAF : 0;
    if (r > 0.0)
        mask_dilate(m, MASK_LEAF, MASK_LEAF, r);
    flood_around(s, t, m);
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++)
            *mask_at(m, x, y) = *mask_at(m, x, y) & MASK_OUT ? 0 : MASK_LEAF;
    if (r > 0.0)
        mask_erode(m, MASK_LEAF, MASK_LEAF, r);
    take_off_threads(m, THREAD + THREAD_GROWS * sigma);
    GArray *parts = mask_components(m, 1.0);
    if (parts->len > 0)
        mask_take(m, &g_array_index(parts, Component, 0));
    g_array_free(parts, TRUE);
    uint64_t strong = 0;
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++) {
            uint8_t *px = mask_at(m, x, y);
            *px = *px & MASK_THIS ? MASK_LEAF | MASK_THIS : 0;
            strong += *px != 0 && strict->px[(size_t)y * strict->width + x] > 0.0f;
        }
    return strong;
}

/* --- the middle of the edges --- */

/* Pixels to be flooded, by strength of the response; in each class first in, first out. */
enum { CLASSES = 1024 };
typedef struct {
    uint32_t x, y;
    uint8_t side; /* from which it is reached: MASK_CORE or MASK_OUT */
} Front;

typedef struct {
    const Mask *m;
    const GreyImage *response;
    double scale;          /* classes per unit of response */
    GArray *class[CLASSES]; /* Front */
    int lowest;
} Basins;

static const int8_t BESIDE[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};

/* Mean level of the pixels with MASK_WORK in a box, which lose it. */
static double take_mean(const Scan *s, const Threshold *t, const Mask *m, MaskBox b)
{
    double sum = 0.0, n = 0.0;
    for (uint32_t y = b.y0; y <= b.y1; y++)
        for (uint32_t x = b.x0; x <= b.x1; x++) {
            uint8_t *px = mask_at(m, x, y);
            if (!(*px & MASK_WORK))
                continue;
            *px &= (uint8_t)~MASK_WORK;
            sum += channel_value(s, t->channel, x, y);
            n += 1.0;
        }
    return sum / n;
}

/* Whether a level is nearer to the background's mean than to the threshold, from which both classes' means are about as far. Veins that let
 * light through are lighter than the threshold, but not by so much. */
static bool is_ground(const Scan *s, const Threshold *t, double level)
{
    double beyond = 0.25 * t->contrast * (s->depth == 8 ? 255.0 : 65535.0);
    return t->dark ? level > t->level + beyond : level < t->level - beyond;
}

/* Plain parts of the region, where there is no edge, are its inside, unless their mean level is the background's; then they are around
 * it (when they are holes nevertheless, they are filled later). Pockets between edges may lie on either side. */
static void mark_plain(const Scan *s, const Threshold *t, const Mask *m, const GreyImage *edges)
{
    static const Flood seek = {MASK_HOLE | MASK_CORE | MASK_OUT | MASK_WORK, MASK_HOLE, MASK_WORK, false},
                       in = {MASK_HOLE | MASK_CORE, MASK_HOLE, MASK_CORE, false}, out = {MASK_HOLE | MASK_OUT, MASK_HOLE, MASK_OUT, false};
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++)
            *mask_at(m, x, y) |= *mask_at(m, x, y) & MASK_LEAF && !(edges->px[(size_t)y * edges->width + x] > 0.0f) ? MASK_HOLE : 0;
    mask_erode(m, MASK_HOLE, MASK_SEEN, POCKET);
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++) {
            if ((*mask_at(m, x, y) & (MASK_SEEN | MASK_CORE | MASK_OUT)) != MASK_SEEN)
                continue;
            MaskBox box;
            mask_flood(m, &seek, x, y, &box);
            mask_flood(m, is_ground(s, t, take_mean(s, t, m, box)) ? &out : &in, x, y, NULL);
        }
}

/* Puts the neighbours of a pixel that belong to no side yet into the queue. */
static void push_around(Basins *b, uint32_t x, uint32_t y, uint8_t side)
{
    for (int k = 0; k < 4; k++) {
        int64_t i = (int64_t)x + BESIDE[k][0], j = (int64_t)y + BESIDE[k][1];
        if (i < 0 || j < 0 || i >= b->m->width || j >= b->m->height)
            continue;
        Front f = {(uint32_t)i, (uint32_t)j, side};
        if (*mask_at(b->m, f.x, f.y) & (MASK_CORE | MASK_OUT))
            continue;
        double r = (double)b->response->px[(size_t)j * b->response->width + (size_t)i] * b->scale;
        int c = MAX(r < CLASSES - 1 ? (int)r : CLASSES - 1, b->lowest);
        g_array_append_val(b->class[c], f);
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
        g_array_set_size(class, 0);
    }
}

/* Parts the region's edge pixels into those nearer the inside and those nearer what lies around. Nothing is done where it has no inside. */
static void part_band(const Scan *s, const Threshold *t, const Mask *m, const GreyImage *edges, const GreyImage *response)
{
    Basins b = {.m = m, .response = response};
    double most = 0.0;
    bool has_inside = false;
    mark_plain(s, t, m, edges);
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++) {
            uint8_t *px = mask_at(m, x, y);
            *px |= *px & MASK_LEAF ? 0 : MASK_OUT;
            has_inside |= (*px & MASK_CORE) != 0;
            if (!(*px & (MASK_OUT | MASK_CORE)))
                most = MAX(most, (double)response->px[(size_t)y * response->width + x]);
        }
    b.scale = most > 0.0 ? (CLASSES - 1) / most : 0.0;
    for (int k = 0; k < CLASSES; k++)
        b.class[k] = g_array_new(FALSE, FALSE, sizeof(Front));
    for (uint32_t y = 0; has_inside && y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++)
            if (*mask_at(m, x, y) & (MASK_OUT | MASK_CORE))
                push_around(&b, x, y, *mask_at(m, x, y) & (MASK_OUT | MASK_CORE));
    flood_band(&b);
    for (int k = 0; k < CLASSES; k++)
        g_array_free(b.class[k], TRUE);
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++) {
            uint8_t *px = mask_at(m, x, y);
            *px = *px & (has_inside ? MASK_CORE : MASK_LEAF) ? MASK_LEAF : 0;
        }
}

/* --- together --- */

static GreyImage *map_with(const GreyImage *grey, const EdgesDef *def, double lower, GError **error)
{
    EdgesDef d = *def;
    d.low *= lower;
    return edges_map(grey, &d, NULL, error);
}

/* Whether about as much is enclosed as there is leaf by its level. The level decides nothing else. */
static bool check_area(const Scan *s, const Threshold *t, const Mask *m, GError **error)
{
    Mask level = {m->width, m->height, m->width, g_try_malloc((gsize)m->width * m->height)};
    if (!level.px) {
        g_set_error(error, SCAN_ERROR, SCAN_ERROR_SIZE, "no memory to mark %u × %u pixels", m->width, m->height);
        return false;
    }
    threshold_apply(s, t, level.px);
    GArray *leaf = mask_components(&level, 1.0), *found = mask_components(m, 1.0);
    double expected = leaf->len > 0 ? (double)g_array_index(leaf, Component, 0).area : 0.0;
    double area = found->len > 0 ? (double)g_array_index(found, Component, 0).area : 0.0;
    g_array_free(leaf, TRUE);
    g_array_free(found, TRUE);
    g_free(level.px);
    mask_clear(m, (uint8_t)~MASK_LEAF);
    if (area >= expected / PLAUSIBLE && area <= expected * PLAUSIBLE)
        return true;
    g_set_error(error, SCAN_ERROR, SCAN_ERROR_NO_LEAF,
                "no leaf: the edges in the %s channel enclose %.0f pixels where about %.0f are leaf; try another operator, smoothing or thresholds",
                channel_name(t->channel), area, expected);
    return false;
}

GreyImage *fang_region(const Scan *s, const Threshold *t, const GreyImage *grey, const GreyImage *response, bool lower, EdgesDef *def,
                       const Mask *m, double *closed, GError **error)
{
    GreyImage *map[N_LOWER];
    int n = lower ? N_LOWER : 1;
    uint64_t most = 0;
    for (int k = 0; k < n; k++) {
        map[k] = map_with(grey, def, LOWER[k], error);
        if (!map[k]) /* the first, then: they differ in the threshold alone */
            return NULL;
        uint64_t strong = enclose(s, t, map[k], map[0], def->sigma, m, MOST_CLOSED);
        most = MAX(most, strong);
    }
    int k = 0;
    while ((LOWER[TRIED[k].map] < 1.0 && !lower) ||
           (double)enclose(s, t, map[TRIED[k].map], map[0], def->sigma, m, TRIED[k].closed) < ENOUGH * (double)most)
        k++; /* the last one of each map encloses what counted for `most` */
    int best = TRIED[k].map;
    part_band(s, t, m, map[best], response);
    if (!check_area(s, t, m, error)) {
        for (int i = 0; i < n; i++)
            grey_image_free(map[i]);
        return NULL;
    }
    *closed = TRIED[k].closed;
    def->low *= LOWER[best];
    for (int i = 0; i < n; i++)
        if (i != best)
            grey_image_free(map[i]);
    return map[best];
}
