#include "image/camera.h"

#include <math.h>
#include <string.h>

#include "geom/dmath.h"
#include "geom/random.h"

/* Of random numbers; those of stream RANDOM_TEXTURE that noise.h does not take. */
enum { SENSOR = 64 };

static void choose_blur(Camera *c, double sigma)
{
    static const double log2_e = 1.4426950408889634;
    if (!(sigma > 0.0))
        return;
    c->reach = (uint32_t)ceil(3.5 * sigma);
    c->weight = g_new(double, 2 * c->reach + 1);
    double sum = 0.0;
    for (uint32_t i = 0; i <= 2 * c->reach; i++) {
        double d = ((double)i - c->reach) / sigma;
        sum += c->weight[i] = dmath_exp2(-0.5 * log2_e * d * d);
    }
    for (uint32_t i = 0; i <= 2 * c->reach; i++)
        c->weight[i] /= sum;
}

void camera_init(Camera *c, const SpecimenDef *def)
{
    static const double warm = 0.3; /* stops that red and blue are off by at most */
    *c = (Camera){.contrast = def->contrast, .noise = def->noise, .chroma_noise = def->chroma_noise, .seed = def->seed};
    choose_blur(c, def->blur);
    for (int i = 0; i < 3; i++)
        c->gain[i] = dmath_exp2(def->exposure + warm * def->warmth * (1 - i));
}

void camera_clear(Camera *c)
{
    g_free(c->weight);
}

static void blur_down(const Camera *c, const Plane *scene, uint32_t row, float *out)
{
    uint32_t n = scene->width * 3, last = scene->height - 1;
    for (uint32_t x = 0; x < n; x++) {
        double sum = 0.0;
        for (uint32_t i = 0; i <= 2 * c->reach; i++) {
            uint32_t y = row + i < c->reach ? 0 : MIN(row + i - c->reach, last);
            sum += c->weight[i] * (double)scene->px[(gsize)y * n + x];
        }
        out[x] = (float)sum;
    }
}

static void blur_along(const Camera *c, uint32_t width, const float *in, float *out)
{
    for (uint32_t x = 0; x < width; x++) {
        double sum[3] = {0.0};
        for (uint32_t i = 0; i <= 2 * c->reach; i++) {
            const float *px = in + 3 * (gsize)(x + i < c->reach ? 0 : MIN(x + i - c->reach, width - 1));
            for (int k = 0; k < 3; k++)
                sum[k] += c->weight[i] * (double)px[k];
        }
        for (int k = 0; k < 3; k++)
            out[3 * (gsize)x + k] = (float)sum[k];
    }
}

/* A curve through black, a quarter of the light (the middle grey of the eye) and white, steep or flat in the middle. */
static double tone(const Camera *c, double light)
{
    if (c->contrast == 0.0)
        return light;
    double u = sqrt(CLAMP(light, 0.0, 1.0));
    u += c->contrast * u * (1.0 - u) * (2.0 * u - 1.0);
    return u * u;
}

/* Sum of `n` of a block's eight half words, 0 on average, of standard deviation 1. */
static double draw(const RandomBlock *b, int from, int n)
{
    double sum = 0.0;
    for (int i = from; i < from + n; i++)
        sum += (b->w[i / 2] >> (16 * (i % 2)) & 0xFFFFu) * 0x1p-16 + 0x1p-17 - 0.5;
    return sum * sqrt(12.0 / n);
}

static void add_noise(const Camera *c, uint64_t pixel, float *px)
{
    static const double srgb_slope = 1.055 / 2.4; /* of the sRGB curve at white */
    RandomBlock b = random_block(c->seed, RANDOM_TEXTURE, SENSOR, pixel);
    double grey = c->noise * draw(&b, 0, 4), warm = c->chroma_noise * draw(&b, 4, 2), green = c->chroma_noise * draw(&b, 6, 2);
    double by[3] = {grey + warm - 0.5 * green, grey + green, grey - warm - 0.5 * green};
    for (int k = 0; k < 3; k++) /* of n photons the square root is noise, and a little is there without any */
        px[k] += (float)(by[k] / srgb_slope * sqrt(CLAMP((double)px[k], 0.0, 1.0) + 0.002));
}

void camera_row(const Camera *c, const Plane *scene, uint32_t top, uint32_t y, float *scratch, float *out)
{
    uint32_t width = scene->width;
    if (c->weight) {
        blur_down(c, scene, y - top, scratch);
        blur_along(c, width, scratch, out);
    } else {
        memcpy(out, scene->px + 3 * (gsize)width * (y - top), 3 * (gsize)width * sizeof *out);
    }
    for (uint32_t x = 0; x < width; x++) {
        float *px = out + 3 * (gsize)x;
        for (int k = 0; k < 3; k++)
            px[k] = (float)tone(c, c->gain[k] * (double)px[k]);
        if (c->noise > 0.0 || c->chroma_noise > 0.0)
            add_noise(c, (uint64_t)y * width + x, px);
    }
}
