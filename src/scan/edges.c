#include "scan/edges.h"

#include <math.h>
#include <string.h>

#include "scan/convolve.h"

G_DEFINE_QUARK(venation-edges-error-quark, edges_error)

static const double largest_sigma = 100.0, smallest_laplacian = 0.5;
/* Where kernels are cut off, in sigmas: what is left out is below 1e-4 of the whole. */
static const double gaussian_reach = 4.0, laplacian_reach = 5.0;
static const double noise_floor = 1e-6; /* of the grey range; rounding of floats is some 1e-7 */
static const double canny_low = 0.4;    /* of the high threshold; Canny 1986 found 1/3 to 1/2 good */
enum { BINS = 256 };

GreyImage *grey_image_new(uint32_t width, uint32_t height)
{
    GreyImage *g = g_new0(GreyImage, 1);
    *g = (GreyImage){width, height, g_new0(float, (gsize)width *height)};
    return g;
}

void grey_image_free(GreyImage *g)
{
    if (!g)
        return;
    g_free(g->px);
    g_free(g);
}

EdgesDef edges_def_default(void) { return (EdgesDef){.op = EDGES_ROBERTS, .automatic = true}; }

static gsize pixel_count(const GreyImage *g) { return (gsize)g->width * g->height; }
/* With the border replicated. */
static double at(const GreyImage *g, int64_t x, int64_t y) { return (double)g->px[grey_index(g, x, y)]; }

/* --- checks --- */

static bool check_image(const GreyImage *in, GError **error)
{
    if (in->width == 0 || in->height == 0) {
        g_set_error(error, EDGES_ERROR, EDGES_ERROR_IMAGE, "the image is empty: %u × %u pixels", in->width, in->height);
        return false;
    }
    for (gsize i = 0; i < pixel_count(in); i++)
        if (!(fabsf(in->px[i]) <= 1e30f)) {
            g_set_error(error, EDGES_ERROR, EDGES_ERROR_IMAGE, "the pixel in column %u, row %u is no number between -1e30 and 1e30",
                        (guint)(i % in->width), (guint)(i / in->width));
            return false;
        }
    return true;
}

static bool check_sigma(double sigma, double least, GError **error)
{
    if (sigma >= least && sigma <= largest_sigma)
        return true;
    g_set_error(error, EDGES_ERROR, EDGES_ERROR_SETTINGS, "sigma is %g; it must lie between %g and %g pixels", sigma, least,
                largest_sigma);
    return false;
}

static bool check_sigma_of(EdgesOperator op, double sigma, GError **error)
{
    return check_sigma(sigma, op == EDGES_LAPLACIAN ? smallest_laplacian : 0.0, error);
}

static bool check_thresholds(const EdgesDef *def, GError **error)
{
    if (def->automatic || (def->low >= 0.0 && def->low <= def->high && def->high < HUGE_VAL))
        return true;
    g_set_error(error, EDGES_ERROR, EDGES_ERROR_SETTINGS,
                "the low threshold is %g and the high one %g; the low one must lie between 0 and the high one", def->low, def->high);
    return false;
}

bool edges_check(const EdgesDef *def, GError **error) { return check_thresholds(def, error) && check_sigma_of(def->op, def->sigma, error); }

/* Smoothing, differences of neighbours, and once more neighbours for the ridges and crossings of these. */
uint32_t edges_reach(EdgesOperator op, double sigma) { return (uint32_t)ceil((op == EDGES_LAPLACIAN ? laplacian_reach : gaussian_reach) * sigma) + 2; }

/* --- smoothing --- */

static GreyImage *smooth(const GreyImage *in, double sigma)
{
    if (sigma == 0.0) {
        GreyImage *copy = grey_image_new(in->width, in->height);
        memcpy(copy->px, in->px, pixel_count(in) * sizeof(float));
        return copy;
    }
    Kernel k = kernel_gaussian(sigma, gaussian_reach);
    GreyImage *out = convolve(in, k, k);
    kernel_clear(&k);
    return out;
}

GreyImage *edges_smooth(const GreyImage *in, double sigma, GError **error)
{
    return check_image(in, error) && check_sigma(sigma, 0.0, error) ? smooth(in, sigma) : NULL;
}

/* --- differences --- */

/* The diagonal differences of Roberts' cross are the gradient turned by 45° and lengthened by √2; turned back it reads: */
static void roberts(const GreyImage *in, int64_t x, int64_t y, double g[2])
{
    double a = at(in, x, y), b = at(in, x + 1, y), c = at(in, x, y + 1), d = at(in, x + 1, y + 1);
    g[0] = 0.5 * ((d - a) + (b - c));
    g[1] = 0.5 * ((d - a) - (b - c));
}

/* Central differences of three rows or columns, the middle one with weight `middle`. */
static void square3(const GreyImage *in, int64_t x, int64_t y, double middle, double g[2])
{
    double nw = at(in, x - 1, y - 1), ne = at(in, x + 1, y - 1), sw = at(in, x - 1, y + 1), se = at(in, x + 1, y + 1);
    double across = at(in, x + 1, y) - at(in, x - 1, y), down = at(in, x, y + 1) - at(in, x, y - 1);
    double scale = 0.5 / (2.0 + middle);
    g[0] = scale * ((ne - nw) + middle * across + (se - sw));
    g[1] = scale * ((sw - nw) + middle * down + (se - ne));
}

void edges_gradient(const GreyImage *in, EdgesOperator op, GreyImage **gx, GreyImage **gy)
{
    g_assert(op == EDGES_ROBERTS || op == EDGES_SOBEL || op == EDGES_PREWITT);
    *gx = grey_image_new(in->width, in->height);
    *gy = grey_image_new(in->width, in->height);
    for (uint32_t y = 0; y < in->height; y++)
        for (uint32_t x = 0; x < in->width; x++) {
            gsize i = (gsize)y * in->width + x;
            double g[2];
            if (op == EDGES_ROBERTS)
                roberts(in, x, y, g);
            else
                square3(in, x, y, op == EDGES_SOBEL ? 2.0 : 1.0, g);
            (*gx)->px[i] = (float)g[0];
            (*gy)->px[i] = (float)g[1];
        }
}

static GreyImage *magnitude(const GreyImage *gx, const GreyImage *gy)
{
    GreyImage *m = grey_image_new(gx->width, gx->height);
    for (gsize i = 0; i < pixel_count(m); i++)
        m->px[i] = (float)sqrt((double)gx->px[i] * (double)gx->px[i] + (double)gy->px[i] * (double)gy->px[i]);
    return m;
}

/* --- Canny --- */

/* Keeps magnitudes that are largest among the two points one pixel (along x or y, whichever the gradient follows more) up and down the
 * gradient, where the magnitude is read between pixels. */
static GreyImage *ridges(const GreyImage *gx, const GreyImage *gy, const GreyImage *m)
{
    GreyImage *out = grey_image_new(m->width, m->height);
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++) {
            gsize i = (gsize)y * m->width + x;
            double dx = (double)gx->px[i], dy = (double)gy->px[i], here = (double)m->px[i];
            if (!(here > 0.0))
                continue;
            bool flat = fabs(dx) >= fabs(dy);
            double part = flat ? fabs(dy) / fabs(dx) : fabs(dx) / fabs(dy);
            int64_t sx = dx < 0.0 ? -1 : 1, sy = dy < 0.0 ? -1 : 1, ax = flat ? sx : 0, ay = flat ? 0 : sy;
            double up = (1.0 - part) * at(m, x + ax, y + ay) + part * at(m, x + sx, y + sy);
            double down = (1.0 - part) * at(m, x - ax, y - ay) + part * at(m, x - sx, y - sy);
            if (here > down && here >= up)
                out->px[i] = (float)here;
        }
    return out;
}

/* Eight neighbours, once around. */
static const int around_x[8] = {1, 1, 0, -1, -1, -1, 0, 1}, around_y[8] = {0, 1, 1, 1, 0, -1, -1, -1};

/* Whether an edge pixel can go: it has two neighbours or more, and those hang together without it, so it is the inside of a bend. */
static bool is_spare(const Mask *m, uint8_t bit, uint32_t x, uint32_t y)
{
    bool on[8];
    int count = 0, parts = 0;
    for (int k = 0; k < 8; k++) {
        int64_t nx = (int64_t)x + around_x[k], ny = (int64_t)y + around_y[k];
        on[k] = nx >= 0 && ny >= 0 && nx < m->width && ny < m->height && (*mask_at(m, (uint32_t)nx, (uint32_t)ny) & bit);
        count += on[k];
    }
    /* Walked round by sides; a corner between two sides that are both off stands alone. (8-connectivity number of Yokoi et al. 1975.) */
    for (int k = 0; k < 8; k += 2)
        parts += !on[k] && (on[k + 1] || on[(k + 2) % 8]);
    return count >= 2 && parts == 1;
}

void edges_thin(const Mask *m, uint8_t bit)
{
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++)
            if ((*mask_at(m, x, y) & bit) && is_spare(m, bit, x, y))
                *mask_at(m, x, y) &= (uint8_t)~bit;
}

static void thin(GreyImage *map)
{
    Mask m = {map->width, map->height, map->width, g_new(uint8_t, pixel_count(map))};
    for (gsize i = 0; i < pixel_count(map); i++)
        m.px[i] = map->px[i] > 0.0f;
    edges_thin(&m, 1);
    for (gsize i = 0; i < pixel_count(map); i++)
        map->px[i] = m.px[i];
    g_free(m.px);
}

/* --- Laplacian of Gaussian --- */

static GreyImage *laplacian(const GreyImage *in, double sigma)
{
    Kernel g = kernel_gaussian(sigma, laplacian_reach), g2 = kernel_gaussian_second(sigma, laplacian_reach);
    GreyImage *xx = convolve(in, g2, g), *yy = convolve(in, g, g2);
    for (gsize i = 0; i < pixel_count(xx); i++)
        xx->px[i] += yy->px[i];
    grey_image_free(yy);
    kernel_clear(&g);
    kernel_clear(&g2);
    return xx;
}

/* Strength of the zero crossing at a pixel of value v, given the values before and after it along a row or column. A pixel that is 0
 * itself is the crossing when its neighbours differ in sign; their step spans two pixels. */
static double crossing(double before, double v, double after)
{
    if (v == 0.0)
        return before * after < 0.0 ? 0.5 * fabs(after - before) : 0.0;
    double a = v * after < 0.0 && fabs(v) <= fabs(after) ? fabs(after - v) : 0.0;
    double b = v * before < 0.0 && fabs(v) < fabs(before) ? fabs(before - v) : 0.0;
    return MAX(a, b);
}

static GreyImage *zero_crossings(const GreyImage *l)
{
    GreyImage *out = grey_image_new(l->width, l->height);
    for (uint32_t y = 0; y < l->height; y++)
        for (uint32_t x = 0; x < l->width; x++) {
            int64_t i = x, j = y;
            double v = at(l, i, j), across = crossing(at(l, i - 1, j), v, at(l, i + 1, j)),
                   down = crossing(at(l, i, j - 1), v, at(l, i, j + 1));
            out->px[(gsize)y * l->width + x] = (float)MAX(across, down);
        }
    return out;
}

/* --- responses and maps --- */

static GreyImage *gradient_response(const GreyImage *in, EdgesOperator op, double sigma)
{
    GreyImage *soft = smooth(in, sigma), *gx, *gy;
    edges_gradient(soft, op == EDGES_CANNY ? EDGES_SOBEL : op, &gx, &gy);
    grey_image_free(soft);
    GreyImage *out = magnitude(gx, gy);
    if (op == EDGES_CANNY) {
        GreyImage *m = out;
        out = ridges(gx, gy, m);
        grey_image_free(m);
    }
    grey_image_free(gx);
    grey_image_free(gy);
    return out;
}

GreyImage *edges_response(const GreyImage *in, EdgesOperator op, double sigma, GError **error)
{
    if (!check_image(in, error) || !check_sigma_of(op, sigma, error))
        return NULL;
    if (op != EDGES_LAPLACIAN)
        return gradient_response(in, op, sigma);
    GreyImage *l = laplacian(in, sigma), *out = zero_crossings(l);
    grey_image_free(l);
    return out;
}

double edges_otsu(const GreyImage *response)
{
    double most = 0.0, count[BINS] = {0.0}, all = (double)pixel_count(response), sum = 0.0;
    for (gsize i = 0; i < pixel_count(response); i++)
        most = MAX(most, (double)response->px[i]);
    if (!(most > 0.0))
        return 0.0;
    for (gsize i = 0; i < pixel_count(response); i++)
        count[MIN((uint32_t)((double)response->px[i] / most * BINS), BINS - 1)] += 1.0;
    for (int k = 0; k < BINS; k++)
        sum += count[k] * k;
    double best = -1.0, below = 0.0, part = 0.0; /* classes 0 … k: how many, and the sum of their numbers */
    int first = 0, last = 0;
    for (int k = 0; k + 1 < BINS; k++) {
        below += count[k];
        part += count[k] * k;
        double apart = sum * below - part * all; /* difference of the means, times below, times all - below */
        double between = below > 0.0 && below < all ? apart * apart / (below * (all - below)) : 0.0;
        if (between > best) {
            best = between;
            first = k;
        }
        if (between == best)
            last = k;
    }
    return most * (0.5 * (first + last) + 1.0) / BINS;
}

/* Floods from responses above `high` through those above `low`. */
static GreyImage *hysteresis(const GreyImage *response, double high, double low)
{
    GreyImage *map = grey_image_new(response->width, response->height);
    GArray *open = g_array_new(FALSE, FALSE, sizeof(gsize));
    for (gsize i = 0; i < pixel_count(map); i++)
        if ((double)response->px[i] > high) {
            map->px[i] = 1.0f;
            g_array_append_val(open, i);
        }
    while (low < high && open->len > 0) {
        gsize i = g_array_index(open, gsize, open->len - 1);
        g_array_set_size(open, open->len - 1);
        for (int k = 0; k < 8; k++) {
            int64_t x = (int64_t)(i % map->width) + around_x[k], y = (int64_t)(i / map->width) + around_y[k];
            if (x < 0 || y < 0 || x >= map->width || y >= map->height)
                continue;
            gsize j = (gsize)y * map->width + (gsize)x;
            if (map->px[j] > 0.0f || !((double)response->px[j] > low))
                continue;
            map->px[j] = 1.0f;
            g_array_append_val(open, j);
        }
    }
    g_array_unref(open);
    return map;
}

static double grey_range(const GreyImage *in)
{
    float least = in->px[0], most = least;
    for (gsize i = 1; i < pixel_count(in); i++) {
        least = MIN(least, in->px[i]);
        most = MAX(most, in->px[i]);
    }
    return (double)most - (double)least;
}

GreyImage *edges_map(const GreyImage *in, const EdgesDef *def, double used[2], GError **error)
{
    if (!check_thresholds(def, error))
        return NULL;
    GreyImage *response = edges_response(in, def->op, def->sigma, error);
    if (!response)
        return NULL;
    double high = def->high, low = def->low;
    if (def->automatic) {
        double scale = def->op == EDGES_LAPLACIAN ? 1.0 / (def->sigma * def->sigma) : 1.0; /* of a second derivative's kernel */
        double split = edges_otsu(response), least = noise_floor * grey_range(in) * scale;
        high = MAX(split, least);
        low = def->op == EDGES_CANNY ? canny_low * high : high;
    }
    GreyImage *map = hysteresis(response, high, low);
    if (def->op == EDGES_CANNY)
        thin(map);
    grey_image_free(response);
    if (used) {
        used[0] = high;
        used[1] = low;
    }
    return map;
}
