/* One grey image of three colours, in which veins stand out most and are bright. */
#include <math.h>

#include "scan/found_parts.h"

enum { SHRINK = 2, MOST_MIXES = 8 };
static const double vein_share = 0.04;     /* of the blade: pixels that larger veins cover, about */
static const double ground_share = 0.7;    /* of the blade, by contrast: surely none */
static const double vein_half = 0.002;     /* half the width looked for, of the leaf's length */
static const double vein_reach = 0.012;    /* sigma along, of the length */
static const double noise_quantile = 0.85; /* of lines of the other polarity */
static const double least_noise = 0.5 / 255;   /* of the whole scale: of a mix in which colours nearly cancel rounding is left */

/* Means of blocks. */
static GreyImage *shrunk(const GreyImage *g, uint32_t w, uint32_t h)
{
    GreyImage *o = grey_image_new(w, h);
    for (uint32_t y = 0; y < h * SHRINK; y++)
        for (uint32_t x = 0; x < w * SHRINK; x++)
            o->px[(gsize)(y / SHRINK) * w + x / SHRINK] += g->px[(gsize)y * g->width + x] / (float)(SHRINK * SHRINK);
    return o;
}

static FoundLeaf small_leaf(const FoundLeaf *l)
{
    FoundLeaf s = {.width = l->width / SHRINK, .height = l->height / SHRINK, .length = l->length / SHRINK, .n_planes = l->n_planes};
    for (uint32_t c = 0; c < l->n_planes; c++)
        s.plane[c] = shrunk(l->plane[c], s.width, s.height);
    s.deep = g_new0(uint8_t, (gsize)s.width * s.height);
    for (uint32_t y = 0; y < s.height; y++)
        for (uint32_t x = 0; x < s.width; x++)
            s.deep[(gsize)y * s.width + x] = l->deep[(gsize)y * SHRINK * l->width + x * SHRINK];
    return s;
}

static GreyImage *mixed(const FoundLeaf *l, const double mix[3])
{
    GreyImage *g = grey_image_new(l->width, l->height);
    for (gsize i = 0; i < (gsize)l->width * l->height; i++) {
        double v = 0.0;
        for (uint32_t c = 0; c < l->n_planes; c++)
            v += mix[c] * (double)l->plane[c]->px[i];
        g->px[i] = (float)v;
    }
    return g;
}

/* Mean of the greatest contrasts over the noise: what `f` shows of veins of its polarity. */
static double clearness(const FoundLeaf *l, const GreyImage *best, const GreyImage *other)
{
    double from = found_quantile(l, best, 1.0 - vein_share), noise = found_quantile(l, other, noise_quantile), sum = 0.0, count = 0.0;
    noise = MAX(noise, least_noise);
    for (gsize i = 0; i < (gsize)l->width * l->height; i++)
        if (l->deep[i] && (double)best->px[i] > from) {
            sum += (double)best->px[i];
            count += 1.0;
        }
    return count > 0.0 ? sum / count / noise : 0.0;
}

/* Solves the symmetric positive a x = b by elimination. */
static void solve3(double a[3][3], double b[3], uint32_t n)
{
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = i + 1; j < n; j++) {
            double t = a[i][i] > 0.0 ? a[j][i] / a[i][i] : 0.0;
            for (uint32_t k = i; k < n; k++)
                a[j][k] -= t * a[i][k];
            b[j] -= t * b[i];
        }
    for (uint32_t i = n; i-- > 0;) {
        for (uint32_t k = i + 1; k < n; k++)
            b[i] -= a[i][k] * b[k];
        b[i] = a[i][i] > 0.0 ? b[i] / a[i][i] : 0.0;
    }
}

/* Fisher's (1936) mix that parts pixels of clear lines from those of none. */
static void discriminant(const FoundLeaf *l, const GreyImage *best, double mix[3])
{
    double from = found_quantile(l, best, 1.0 - vein_share), to = found_quantile(l, best, ground_share);
    double mean[2][3] = {{0}}, count[2] = {0}, cov[3][3] = {{0}}, trace = 0.0;
    for (int pass = 0; pass < 2; pass++) {
        for (gsize i = 0; i < (gsize)l->width * l->height; i++) {
            double r = (double)best->px[i], d[3];
            if (!l->deep[i] || (r <= from && r > to))
                continue;
            int class = r > from;
            for (uint32_t c = 0; c < l->n_planes; c++)
                d[c] = (double)l->plane[c]->px[i] - (pass ? mean[class][c] : 0.0);
            count[class] += pass ? 0.0 : 1.0;
            for (uint32_t c = 0; c < l->n_planes; c++) {
                mean[class][c] += pass ? 0.0 : d[c];
                for (uint32_t k = 0; pass && k < l->n_planes; k++)
                    cov[c][k] += d[c] * d[k];
            }
        }
        for (int class = 0; !pass && class < 2; class++)
            for (uint32_t c = 0; c < l->n_planes; c++)
                mean[class][c] /= MAX(count[class], 1.0);
    }
    for (uint32_t c = 0; c < l->n_planes; c++)
        trace += cov[c][c];
    for (uint32_t c = 0; c < l->n_planes; c++) {
        cov[c][c] += 0.01 * trace; /* no mix of near opposites that cancel but for noise */
        mix[c] = mean[1][c] - mean[0][c];
    }
    solve3(cov, mix, l->n_planes);
}

/* To unit length, so that mixes compare. */
static void normalise(double mix[3], uint32_t n)
{
    double sum = 0.0;
    for (uint32_t c = 0; c < n; c++)
        sum += mix[c] * mix[c];
    for (uint32_t c = 0; c < n && sum > 0.0; c++)
        mix[c] /= sqrt(sum);
}

typedef struct {
    double mix[3], clear;
} Mix;

static Mix tried(const FoundLeaf *l, const double mix[3], GreyImage **best)
{
    Mix m = {{mix[0], mix[1], mix[2]}, 0.0};
    GreyImage *g = mixed(l, mix);
    FoundLines f;
    found_lines(l, g, MAX(vein_half * l->length, 0.8), vein_reach * l->length, false, &f);
    double up = clearness(l, f.best, f.other), down = clearness(l, f.other, f.best);
    m.clear = MAX(up, down);
    for (uint32_t c = 0; c < 3 && down > up; c++)
        m.mix[c] = -m.mix[c];
    *best = down > up ? f.other : f.best;
    *(down > up ? &f.other : &f.best) = NULL;
    found_lines_clear(&f);
    grey_image_free(g);
    return m;
}

GreyImage *found_mix(const FoundLeaf *l, bool *bright)
{
    static const double simple[][3] = {{0.299, 0.587, 0.114}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, -1, 0}, {0, 1, -1}};
    FoundLeaf s = small_leaf(l);
    uint32_t n = l->n_planes == 1 ? 1 : G_N_ELEMENTS(simple);
    Mix best = {{0}, -1.0};
    GreyImage *lines = NULL, *g;
    for (uint32_t k = 0; k < n + 2; k++) {
        double mix[3] = {0};
        for (uint32_t c = 0; c < 3 && k < n; c++)
            mix[c] = l->n_planes == 1 ? c == 0 : simple[k][c];
        if (k >= n && l->n_planes == 1)
            break;
        if (k >= n)
            discriminant(&s, lines, mix);
        normalise(mix, l->n_planes);
        Mix m = tried(&s, mix, &g);
        GreyImage *worse = m.clear > best.clear ? lines : g;
        if (m.clear > best.clear) {
            best = m;
            lines = g;
        }
        grey_image_free(worse);
    }
    double weight = 0.0, from = found_quantile(&s, lines, 1.0 - vein_share);
    GreyImage *grey = mixed(&s, l->n_planes == 1 ? (const double[3]){1, 0, 0} : simple[0]);
    for (gsize i = 0; i < (gsize)s.width * s.height; i++)
        weight += s.deep[i] && (double)lines->px[i] > from ? (double)grey->px[i] : 0.0;
    *bright = weight > 0.0;
    grey_image_free(grey);
    grey_image_free(lines);
    for (uint32_t c = 0; c < 3; c++)
        grey_image_free(s.plane[c]);
    g_free(s.deep);
    return mixed(l, best.mix);
}
