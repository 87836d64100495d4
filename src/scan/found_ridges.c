/* How much of a ridge each pixel is: lines of several widths against the noise of their own width. */
#include <math.h>

#include "geom/dtrig.h"
#include "scan/convolve.h"
#include "scan/found_parts.h"

static const double thinnest = 0.0018, thickest = 0.018; /* widths looked for, of the leaf's length */
static const double least_half = 0.9;        /* working pixels */
static const double noise_quantile = 0.85;   /* of lines of the other polarity */
static const double least_noise = 0.25 / 255;  /* of the whole scale: what rounding to 8 bits leaves in a flat image */
static const double even_odds = 2.2;         /* contrast over noise at strength 0.5 */
static const double reach_length = 0.007, reach_widths = 2.0; /* sigma along the line: of the leaf's length, and half widths */

static const double rim = 0.005, rim_fade = 2.0; /* sigma of the outline's softness, of the length; how much a line along it is faded */
static const int8_t step_x[FOUND_MOVES] = {1, 2, 1, 1, 0, -1, -1, -2}, step_y[FOUND_MOVES] = {0, -1, -1, -2, -1, -2, -1, -1};

static inline float strength_of(double z)
{
    return (float)(z * z / (z * z + even_odds * even_odds));
}

/* Takes the lines of one width into the result where they stand out more, or for the width where they are of more contrast. */
static void take(const FoundLeaf *l, FoundRidges *r, FoundLines *f, double half, GreyImage *contrast, double *noise)
{
    *noise = found_quantile(l, f->other, noise_quantile);
    *noise = MAX(*noise, least_noise);
    float sine[FOUND_DIRECTIONS], cosine[FOUND_DIRECTIONS];
    for (uint32_t d = 0; d < FOUND_DIRECTIONS; d++) {
        double s, c;
        dtrig_sin_cos(2.0 * d * DTRIG_PI / FOUND_DIRECTIONS, &s, &c);
        sine[d] = (float)s;
        cosine[d] = (float)c;
    }
    for (gsize i = 0; i < (gsize)l->width * l->height; i++) {
        if (!l->deep[i] || !(f->best->px[i] > 0.0f))
            continue;
        float s = strength_of((double)f->best->px[i] / *noise);
        if (s > r->strength->px[i]) {
            r->strength->px[i] = s;
            r->cosine->px[i] = cosine[f->direction[i]];
            r->sine->px[i] = sine[f->direction[i]];
        }
        if (f->best->px[i] > contrast->px[i]) {
            contrast->px[i] = f->best->px[i];
            r->width->px[i] = (float)(2.0 * half * l->step);
        }
        for (uint32_t m = 0; m < FOUND_MOVES; m++)
            if (f->along[m]->px[i] > 0.0f) {
                float a = strength_of((double)f->along[m]->px[i] / *noise);
                r->along[m]->px[i] = MAX(r->along[m]->px[i], a);
            }
    }
}

/* Lines along the outline and near to it are its rim, not veins. */
static void fade_rim(const FoundLeaf *l, FoundRidges *r)
{
    GreyImage *in = grey_image_new(l->width, l->height);
    for (gsize i = 0; i < (gsize)l->width * l->height; i++)
        in->px[i] = l->inside[i];
    double sigma = MAX(rim * l->length, 1.0);
    Kernel k = kernel_gaussian(sigma, 3.0);
    GreyImage *soft = convolve(in, k, k);
    for (uint32_t y = 1; y + 1 < l->height; y++)
        for (uint32_t x = 1; x + 1 < l->width; x++) {
            gsize i = (gsize)y * l->width + x;
            if (!l->deep[i])
                continue;
            double gx = (double)soft->px[i + 1] - (double)soft->px[i - 1], gy = (double)soft->px[i + l->width] - (double)soft->px[i - l->width];
            for (uint32_t m = 0; m < FOUND_MOVES; m++) {
                double dx = step_x[m], dy = step_y[m], across = fabs(gx * dy - gy * dx) / sqrt(dx * dx + dy * dy);
                r->along[m]->px[i] *= (float)MAX(0.0, 1.0 - rim_fade * sigma * across);
            }
        }
    kernel_clear(&k);
    grey_image_free(soft);
    grey_image_free(in);
}

FoundRidges *found_ridges_of(const FoundLeaf *l, const FoundDef *def)
{
    FoundRidges *r = g_new0(FoundRidges, 1);
    GreyImage **all[] = {&r->strength, &r->cosine, &r->sine, &r->width}, *contrast = grey_image_new(l->width, l->height);
    for (uint32_t k = 0; k < G_N_ELEMENTS(all); k++)
        *all[k] = grey_image_new(l->width, l->height);
    for (uint32_t m = 0; m < FOUND_MOVES; m++)
        r->along[m] = grey_image_new(l->width, l->height);
    r->corner = vec2(l->x0, l->scan->height - l->y0);
    r->step = l->step;
    r->light = found_mix(l, &r->bright);
    double least = def->least_width > 0.0 ? def->least_width / l->step : thinnest * l->length;
    double most = def->most_width > 0.0 ? def->most_width / l->step : thickest * l->length, noise;
    double half = MAX(0.5 * least, least_half);
    bool first = true;
    do {
        FoundLines f;
        found_lines(l, r->light, half, reach_length * l->length + reach_widths * half, true, &f);
        take(l, r, &f, half, contrast, &noise);
        if (first)
            r->noise = noise;
        first = false;
        found_lines_clear(&f);
        half *= 1.5;
    } while (half <= 0.5 * most);
    grey_image_free(contrast);
    fade_rim(l, r);
    return r;
}

bool found_def_check(const FoundDef *def, GError **error)
{
    if (!(def->least_width >= 0.0) || !(def->most_width >= 0.0) || (def->most_width > 0.0 && def->most_width < def->least_width))
        g_set_error(error, SCAN_ERROR, SCAN_ERROR_VALUE, "widths of veins from %g to %g pixels; they must be 0 (by the leaf's size) or more, the greater not below the lesser",
                    def->least_width, def->most_width);
    else if (!(def->sensitivity >= 0.0 && def->sensitivity <= 1.0))
        g_set_error(error, SCAN_ERROR, SCAN_ERROR_VALUE, "sensitivity is %g; it must lie between 0 and 1", def->sensitivity);
    else if (def->orders < 1 || def->orders > 5)
        g_set_error(error, SCAN_ERROR, SCAN_ERROR_VALUE, "veins of %u orders are asked for; it must be 1 to 5", def->orders);
    else
        return true;
    return false;
}

FoundRidges *found_ridges(const Scan *s, const Polygon *outline, const FoundDef *def, GError **error)
{
    FoundLeaf l;
    if (!found_def_check(def, error) || !found_leaf_init(&l, s, outline, NULL, FOUND_SIDE, error))
        return NULL;
    FoundRidges *r = found_ridges_of(&l, def);
    found_leaf_clear(&l);
    return r;
}

void found_ridges_free(FoundRidges *r)
{
    if (!r)
        return;
    grey_image_free(r->light);
    grey_image_free(r->strength);
    grey_image_free(r->cosine);
    grey_image_free(r->sine);
    grey_image_free(r->width);
    for (uint32_t m = 0; m < FOUND_MOVES; m++)
        grey_image_free(r->along[m]);
    g_free(r);
}
