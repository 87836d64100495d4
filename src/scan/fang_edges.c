#include "scan/fang_edges.h"

#include "scan/fang_region.h"

enum { SAMPLES = 1 << 18 };
static const double SIGMA[] = {0.0, 1.0, 1.5, 2.0, 3.0, 4.0};
#define HIGH 0.5 /* of the margin's median response */
#define LOW 0.25
#define LINES 0.92
#define CLEAR 2.5 /* what is no edge is at least so much weaker, in its median, than what is one */

#define LEAST_OF_LINES 1.0 /* sigma of operators that are defined with a Gaussian */

/* Operators that respond on lines a pixel wide. */
static bool lines_only(EdgesOperator op) { return op == EDGES_CANNY || op == EDGES_LAPLACIAN; }

static int smaller_first(gconstpointer a, gconstpointer b, gpointer user)
{
    const float *p = a, *q = b;
    return (*p > *q) - (*p < *q);
}

/* Of floats, which get sorted; of no more than SAMPLES of them, taken evenly. */
static double quantile(GArray *v, double share)
{
    guint step = v->len / SAMPLES + 1, n = 0;
    float *px = (float *)(void *)v->data;
    for (guint i = 0; i < v->len; i += step)
        px[n++] = px[i];
    g_qsort_with_data(px, (gint)n, sizeof *px, smaller_first, NULL);
    return n > 0 ? (double)px[(guint)(share * n)] : 0.0;
}

/* A response and where in the image it was read: tile by tile they come in another order than rows have. */
typedef struct {
    gsize at;
    float value;
} Reading;

static int by_place(gconstpointer a, gconstpointer b, gpointer user)
{
    const Reading *p = a, *q = b;
    return (p->at > q->at) - (p->at < q->at);
}

/* Of readings, which are freed. */
static double quantile_of(GArray *reading, double share)
{
    GArray *v = g_array_sized_new(FALSE, FALSE, sizeof(float), reading->len);
    if (reading->len > 0)
        g_qsort_with_data(reading->data, (gint)reading->len, sizeof(Reading), by_place, NULL);
    for (guint i = 0; i < reading->len; i++)
        g_array_append_val(v, g_array_index(reading, Reading, i).value);
    g_array_free(reading, TRUE);
    double at = quantile(v, share);
    g_array_free(v, TRUE);
    return at;
}

/* --- readings of a tile --- */

typedef struct {
    const FangGrey *grey;
    const Mask *m;
    float level;
    GArray *ground, *margin; /* Reading */
} Readings;

/* Around the leaf, out of its margin's reach: the noise, texture or grid of the ground; the leaf's own veins don't matter, as they lie out of the band in
 * which edges are looked for. */
static void read_ground(const Readings *r, const FangTile *t, const GreyImage *response)
{
    gsize w = r->grey->width, step = w * r->grey->height / SAMPLES | 1; /* odd: not in step with rows */
    for (uint32_t y = t->core.y0; y <= t->core.y1; y++)
        for (gsize i = (y * w + t->core.x0 + step - 1) / step * step; i <= y * w + t->core.x1; i += step) {
            uint32_t x = (uint32_t)(i - y * w);
            if (*mask_at(r->m, x, y))
                continue;
            Reading here = {i, fang_tile_at(response, t, x, y)};
            g_array_append_val(r->ground, here);
        }
}

static float greatest_near(const GreyImage *r, uint32_t x, uint32_t y)
{
    float most = 0.0f;
    for (uint32_t j = y > 0 ? y - 1 : 0; j <= MIN(y + 1, r->height - 1); j++)
        for (uint32_t i = x > 0 ? x - 1 : 0; i <= MIN(x + 1, r->width - 1); i++)
            most = MAX(most, r->px[(gsize)j * r->width + i]);
    return most;
}

/* In the band, where the level crosses the threshold. */
static void read_margin(const Readings *r, const FangTile *t, const GreyImage *soft, const GreyImage *response)
{
    for (uint32_t y = t->core.y0; y <= t->core.y1; y++)
        for (uint32_t x = t->core.x0; x <= t->core.x1; x++) {
            if (!(*mask_at(r->m, x, y) & MASK_WORK))
                continue;
            uint32_t i = x - t->all.x0, j = y - t->all.y0;
            const float *px = soft->px + (gsize)j * soft->width + i;
            bool here = px[0] < r->level, crosses = (i + 1 < soft->width && (px[1] < r->level) != here) ||
                                                    (j + 1 < soft->height && (px[soft->width] < r->level) != here);
            if (!crosses)
                continue;
            Reading most = {(gsize)y * r->grey->width + x, greatest_near(response, i, j)};
            g_array_append_val(r->margin, most);
        }
}

static bool has_band(const Mask *m, const MaskBox *b)
{
    for (uint32_t y = b->y0; y <= b->y1; y++)
        for (uint32_t x = b->x0; x <= b->x1; x++)
            if (*mask_at(m, x, y) & MASK_WORK)
                return true;
    return false;
}

static void read_tile(const Readings *r, const FangTile *t, const EdgesDef *def)
{
    GreyImage *grey = fang_tile_grey(r->grey, t), *response = edges_response(grey, def->op, def->sigma, NULL);
    g_assert(response);
    read_ground(r, t, response);
    if (has_band(r->m, &t->core)) {
        GreyImage *soft = edges_smooth(grey, def->sigma, NULL);
        read_margin(r, t, soft, response);
        grey_image_free(soft);
    }
    grey_image_free(grey);
    grey_image_free(response);
}

/* --- thresholds --- */

/* Thresholds for def->sigma. False, unless they are wanted `anyway`, when noise would pass them. The Laplacian's and Canny's response is 0 but on lines, some
 * tenth of the pixels where all is noise. */
static bool set_thresholds(const FangGrey *grey, float level, const Mask *m, bool anyway, EdgesDef *def)
{
    Readings r = {grey, m, level, g_array_new(FALSE, FALSE, sizeof(Reading)), g_array_new(FALSE, FALSE, sizeof(Reading))};
    uint32_t reach = edges_reach(def->op, def->sigma) + 1; /* and the neighbours of each pixel */
    for (uint32_t k = 0; k < fang_tile_count(grey, reach); k++) {
        FangTile t = fang_tile(grey, reach, k);
        read_tile(&r, &t, def);
    }
    double usual = quantile_of(r.ground, lines_only(def->op) ? LINES : 0.5), margin = quantile_of(r.margin, 0.5);
    bool fine = anyway || LOW * margin > CLEAR * usual;
    if (fine) {
        def->automatic = false;
        def->high = HIGH * margin;
        def->low = LOW * margin;
    }
    return fine;
}

/* Marks what is within `reach` of the region's border by MASK_WORK; what has no bit is around both. */
static void mark_band(const Mask *m, double reach)
{
    mask_erode(m, MASK_LEAF, MASK_CORE, reach);
    mask_dilate(m, MASK_LEAF, MASK_WORK, reach);
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++)
            *mask_at(m, x, y) &= *mask_at(m, x, y) & MASK_CORE ? (uint8_t)~MASK_WORK : 0xff;
}

bool fang_choose_edges(const FangGrey *grey, double level, const Mask *m, EdgesDef *def, GError **error)
{
    if (!def->automatic)
        return true;
    bool given = def->sigma != 0.0;
    guint k = 0, last = G_N_ELEMENTS(SIGMA) - 1;
    while (!given && lines_only(def->op) && SIGMA[k] < LEAST_OF_LINES)
        k++;
    EdgesDef tried = *def;
    tried.sigma = given ? def->sigma : SIGMA[k];
    if (!edges_check(&tried, error))
        return false;
    mark_band(m, fang_band(tried.sigma));
    while (!set_thresholds(grey, (float)level, m, given || k == last, &tried))
        tried.sigma = SIGMA[++k];
    mask_clear(m, MASK_CORE | MASK_WORK);
    *def = tried;
    return true;
}
