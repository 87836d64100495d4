#include "scan/fang_edges.h"

enum { SAMPLES = 1 << 18 };
static const double SIGMA[] = {0.0, 1.0, 1.5, 2.0, 3.0, 4.0};
#define HIGH 0.5 /* of the margin's median response */
#define LOW 0.25
#define LINES 0.92
#define CLEAR 2.5 /* what is no edge is at least so much weaker, in its median, than what is one */

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

/* The response that is usual in the whole image. The Laplacian's and Canny's is 0 but on lines, some tenth of the pixels where all is
 * noise. */
static double usual_response(const GreyImage *r, EdgesOperator op)
{
    GArray *v = g_array_new(FALSE, FALSE, sizeof(float));
    gsize n = (gsize)r->width * r->height, step = n / SAMPLES | 1; /* odd: not in step with rows */
    for (gsize i = 0; i < n; i += step)
        g_array_append_val(v, r->px[i]);
    double usual = quantile(v, op == EDGES_CANNY || op == EDGES_LAPLACIAN ? LINES : 0.5);
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

/* M for a smoothed image; 0 when the level never crosses the threshold, which is in grey values. */
static double margin_response(const GreyImage *soft, float level, const GreyImage *r)
{
    GArray *v = g_array_new(FALSE, FALSE, sizeof(float));
    for (uint32_t y = 0; y < soft->height; y++)
        for (uint32_t x = 0; x < soft->width; x++) {
            const float *px = soft->px + (gsize)y * soft->width + x;
            bool here = px[0] < level, crosses = (x + 1 < soft->width && (px[1] < level) != here) ||
                                                 (y + 1 < soft->height && (px[soft->width] < level) != here);
            if (!crosses)
                continue;
            float most = greatest_near(r, x, y);
            g_array_append_val(v, most);
        }
    double m = quantile(v, 0.5);
    g_array_free(v, TRUE);
    return m;
}

/* Thresholds for def->sigma. False, unless they are wanted `anyway`, when noise would pass them. */
static bool set_thresholds(const GreyImage *grey, float level, bool anyway, EdgesDef *def)
{
    GreyImage *response = edges_response(grey, def->op, def->sigma, NULL), *soft = edges_smooth(grey, def->sigma, NULL);
    double margin = margin_response(soft, level, response);
    bool fine = anyway || LOW * margin > CLEAR * usual_response(response, def->op);
    if (fine) {
        def->automatic = false;
        def->high = HIGH * margin;
        def->low = LOW * margin;
    }
    grey_image_free(response);
    grey_image_free(soft);
    return fine;
}

bool fang_choose_edges(const Scan *s, const Threshold *t, const GreyImage *grey, EdgesDef *def, GError **error)
{
    if (!def->automatic)
        return true;
    double least = def->op == EDGES_LAPLACIAN ? MAX(def->sigma, 1.0) : def->sigma;
    GreyImage *checked = edges_smooth(grey, least, error);
    if (!checked)
        return false;
    grey_image_free(checked);
    float level = (float)(s->depth == 8 ? t->level : t->level / 257.0);
    guint k = 0, last = G_N_ELEMENTS(SIGMA) - 1;
    def->sigma = least;
    while (!set_thresholds(grey, level, def->sigma >= SIGMA[last], def)) {
        while (SIGMA[k] <= def->sigma)
            k++;
        def->sigma = SIGMA[k];
    }
    return true;
}
