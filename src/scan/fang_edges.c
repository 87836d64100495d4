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

/* The response that is usual around the leaf, out of its margin's reach: the noise, texture or grid of the ground; the leaf's own veins
 * don't matter, as they lie out of the band in which edges are looked for. The Laplacian's and Canny's is 0 but on lines, some tenth of the pixels where all is
 * noise. */
static double usual_response(const GreyImage *r, EdgesOperator op, const Mask *m)
{
    GArray *v = g_array_new(FALSE, FALSE, sizeof(float));
    gsize n = (gsize)r->width * r->height, step = n / SAMPLES | 1; /* odd: not in step with rows */
    for (gsize i = 0; i < n; i += step)
        if (!*mask_at(m, (uint32_t)(i % r->width), (uint32_t)(i / r->width)))
            g_array_append_val(v, r->px[i]);
    double usual = quantile(v, lines_only(op) ? LINES : 0.5);
    g_array_free(v, TRUE);
    return usual;
}

static float greatest_near(const GreyImage *r, uint32_t x, uint32_t y)
{
    float most = 0.0f;
    for (uint32_t j = y > 0 ? y - 1 : 0; j <= MIN(y + 1, r->height - 1); j++)
        for (uint32_t i = x > 0 ? x - 1 : 0; i <= MIN(x + 1, r->width - 1); i++)
            most = MAX(most, r->px[(gsize)j * r->width + i]);
    return most;
}

/* M for a smoothed image; 0 when the level never crosses the threshold, which is in grey values, in the band. */
static double margin_response(const GreyImage *soft, float level, const GreyImage *r, const Mask *m)
{
    GArray *v = g_array_new(FALSE, FALSE, sizeof(float));
    for (uint32_t y = 0; y < soft->height; y++)
        for (uint32_t x = 0; x < soft->width; x++) {
            const float *px = soft->px + (gsize)y * soft->width + x;
            bool here = px[0] < level, crosses = (x + 1 < soft->width && (px[1] < level) != here) ||
                                                 (y + 1 < soft->height && (px[soft->width] < level) != here);
            if (!crosses || !(*mask_at(m, x, y) & MASK_WORK))
                continue;
            float most = greatest_near(r, x, y);
            g_array_append_val(v, most);
        }
    double margin = quantile(v, 0.5);
    g_array_free(v, TRUE);
    return margin;
}

/* Thresholds for def->sigma. False, unless they are wanted `anyway`, when noise would pass them. */
static bool set_thresholds(const GreyImage *grey, float level, const Mask *m, bool anyway, EdgesDef *def)
{
    GreyImage *response = edges_response(grey, def->op, def->sigma, NULL), *soft = edges_smooth(grey, def->sigma, NULL);
    double margin = margin_response(soft, level, response, m);
    bool fine = anyway || LOW * margin > CLEAR * usual_response(response, def->op, m);
    if (fine) {
        def->automatic = false;
        def->high = HIGH * margin;
        def->low = LOW * margin;
    }
    grey_image_free(response);
    grey_image_free(soft);
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

bool fang_choose_edges(const GreyImage *grey, double level, const Mask *m, EdgesDef *def, GError **error)
{
    if (!def->automatic)
        return true;
    bool given = def->sigma != 0.0;
    guint k = 0, last = G_N_ELEMENTS(SIGMA) - 1;
    while (!given && lines_only(def->op) && SIGMA[k] < LEAST_OF_LINES)
        k++;
    EdgesDef tried = *def;
    tried.sigma = given ? def->sigma : SIGMA[k];
    GreyImage *checked = edges_response(grey, def->op, tried.sigma, error);
    if (!checked)
        return false;
    grey_image_free(checked);
    mark_band(m, fang_band(tried.sigma));
    while (!set_thresholds(grey, (float)level, m, given || k == last, &tried))
        tried.sigma = SIGMA[++k];
    mask_clear(m, MASK_CORE | MASK_WORK);
    *def = tried;
    return true;
}
