#include "image/encode.h"

#include <stdbool.h>
#include <string.h>

#include "geom/dmath.h"
#include "geom/wide.h"

/* The sRGB curve (IEC 61966-2-1) at CURVE + 1 even steps; straight lines between them err by less than 2e-6. */
enum { CURVE = 16384 };

static double srgb_encode(double x)
{
    return x <= 0.0031308 ? 12.92 * x : 1.055 * dmath_pow(x, 1.0 / 2.4) - 0.055;
}

static double srgb_at(const double *curve, double x)
{
    if (!(x > 0.0))
        return 0.0;
    if (x >= 1.0)
        return 1.0;
    uint32_t i = (uint32_t)(x * CURVE);
    return curve[i] + (curve[i + 1] - curve[i]) * (x * CURVE - i);
}

/* 0 for what is not a number. */
static inline int32_t to_level(double v, double top)
{
    v = v > 0.0 ? v : 0.0;
    v = v < top ? v : top;
    return (int32_t)(v + 0.5);
}

enum { UNSURE = 0xFFFF };

static void list_quick(Encoder *e)
{
    e->quick = g_new(uint16_t, CURVE);
    for (int i = 0; i < CURVE; i++) {
        int32_t level = to_level(e->srgb[i] * 255.0, 255.0), next = to_level(e->srgb[i + 1] * 255.0, 255.0);
        e->quick[i] = level == next ? (uint16_t)level : UNSURE;
    }
}

void encoder_init(Encoder *e, const Plane *p, int depth)
{
    *e = (Encoder){depth == 16 ? 16 : 8, p->channels, FALSE, NULL, NULL};
    if (p->kind == PLANE_LABEL) {
        e->packed = p->high > 65535.0 && p->channels == 1;
        if (e->packed) {
            e->channels = 3;
            e->depth = 8;
        } else if (p->high > 255.0) {
            e->depth = 16;
        }
    }
    if (p->kind == PLANE_COLOUR) {
        e->srgb = g_new(double, CURVE + 1);
        for (int i = 0; i <= CURVE; i++)
            e->srgb[i] = srgb_encode((double)i / CURVE);
        if (e->depth == 8 && e->channels < 4)
            list_quick(e);
    }
}

void encoder_clear(Encoder *e)
{
    g_clear_pointer(&e->srgb, g_free);
    g_clear_pointer(&e->quick, g_free);
}

enum { BLOCK = 128 }; /* values worked on together, in loops that vector instructions take in */

/* Do n values all have the bits of the first? What surrounds the blade does. */
static inline bool all_same(const float *in, uint32_t n)
{
    uint32_t first, differ = 0;
    memcpy(&first, in, sizeof first);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t bits;
        memcpy(&bits, in + i, sizeof bits);
        differ |= bits ^ first;
    }
    return differ == 0;
}

static inline uint8_t *put_levels(const int32_t *restrict level, uint32_t n, int depth, uint8_t *restrict out)
{
    if (depth == 8) {
        for (uint32_t i = 0; i < n; i++)
            out[i] = (uint8_t)level[i];
        return out + n;
    }
    for (uint32_t i = 0; i < n; i++) {
        uint16_t v = GUINT16_TO_BE((uint16_t)level[i]);
        memcpy(out + 2 * i, &v, sizeof v);
    }
    return out + 2 * n;
}

static void pack_row(const float *in, uint32_t n, uint8_t *out)
{
    for (uint32_t i = 0; i < n; i++, out += 3) {
        uint32_t v = (uint32_t)to_level((double)in[i], 16777215.0);
        out[0] = (uint8_t)(v >> 16);
        out[1] = (uint8_t)(v >> 8);
        out[2] = (uint8_t)v;
    }
}

/* A value equal to that of the pixel before has its level. */
static void colour_row(const Encoder *e, const float *in, uint32_t n, double top, uint8_t *out)
{
    enum { PIXELS = BLOCK / 12 * 12 }; /* values of whole pixels of 1, 2, 3 or 4 channels */
    uint32_t c = e->channels;
    int32_t level[BLOCK], last[4] = {0};
    float known[4] = {0.0f};
    for (uint32_t first = 0; first < n; first += PIXELS) {
        uint32_t count = MIN(n - first, (uint32_t)PIXELS);
        for (uint32_t i = 0, k = 0; i < count; i++, k = k + 1 < c ? k + 1 : 0) {
            float v = in[first + i];
            if (!(v == known[k])) { /* a fourth channel is opacity, which has no gamma */
                known[k] = v;
                last[k] = to_level((c == 4 && k == 3 ? (double)v : srgb_at(e->srgb, (double)v)) * top, top);
            }
            level[i] = last[k];
        }
        out = put_levels(level, count, e->depth, out);
    }
}

/* The same for 8 bits without opacity. */
static void quick_row(const Encoder *e, const float *in, uint32_t n, uint8_t *out)
{
    for (uint32_t i = 0; i < n; i++) {
        float v = in[i] > 0.0f ? in[i] : 0.0f;
        uint32_t level = v < 1.0f ? e->quick[(uint32_t)(v * CURVE)] : 255;
        out[i] = (uint8_t)(level != UNSURE ? level : (uint32_t)to_level(srgb_at(e->srgb, (double)v) * 255.0, 255.0));
    }
}

WIDE static void data_row(const Encoder *e, const float *in, uint32_t n, double low, double gain, double top, uint8_t *out)
{
    int32_t level[BLOCK];
    for (uint32_t first = 0; first < n; first += BLOCK, in += BLOCK) {
        uint32_t count = MIN(n - first, (uint32_t)BLOCK), known = all_same(in, count) ? 1 : count;
        for (uint32_t i = 0; i < known; i++)
            level[i] = to_level(((double)in[i] - low) * gain, top);
        for (uint32_t i = known; i < count; i++)
            level[i] = level[0];
        out = put_levels(level, count, e->depth, out);
    }
}

void encoder_row(const Encoder *e, const Plane *p, uint32_t y, uint8_t *out)
{
    uint32_t n = p->width * p->channels;
    const float *in = p->px + (gsize)y * n;
    double top = e->depth == 16 ? 65535.0 : 255.0, range = p->high - p->low;
    if (e->packed)
        pack_row(in, n, out);
    else if (e->quick)
        quick_row(e, in, n, out);
    else if (p->kind == PLANE_COLOUR)
        colour_row(e, in, n, top, out);
    else if (p->kind == PLANE_DATA)
        data_row(e, in, n, p->low, range != 0.0 ? top / range : 0.0, top, out);
    else
        data_row(e, in, n, 0.0, 1.0, top, out);
}

/* a where the condition holds, else b: a mask, as compilers make branches of what else they might take for one. */
static inline uint32_t choose(bool condition, uint32_t a, uint32_t b)
{
    uint32_t mask = -(uint32_t)condition;
    return (a & mask) | (b & ~mask);
}

/* Below 2^-14 a half is a multiple of 2^-24, which adding 1/2 rounds to; 65520 and above round to infinity. */
static inline uint16_t to_half(float value)
{
    uint32_t bits, small;
    memcpy(&bits, &value, sizeof bits);
    int32_t mag = (int32_t)(bits & 0x7FFFFFFFu);
    uint32_t usual = (uint32_t)(mag + 0xFFF + (mag >> 13 & 1) - 0x38000000) >> 13;
    float m;
    memcpy(&m, &mag, sizeof m);
    m += 0.5f;
    memcpy(&small, &m, sizeof small);
    uint32_t h = choose(mag < 0x38800000, small - 0x3F000000u, usual);
    h = choose(mag < 0x477FF000, h, choose(mag <= 0x7F800000, 0x7C00u, 0x7E00u));
    return (uint16_t)(h | (bits >> 16 & 0x8000u));
}

uint16_t encode_half(float value)
{
    return to_half(value);
}

WIDE void encode_halves(const float *restrict in, uint32_t n, uint16_t *restrict out)
{
    for (uint32_t first = 0; first < n; first += BLOCK, in += BLOCK, out += BLOCK) {
        uint32_t count = MIN(n - first, (uint32_t)BLOCK), known = all_same(in, count) ? 1 : count;
        for (uint32_t i = 0; i < known; i++)
            out[i] = to_half(in[i]);
        for (uint32_t i = known; i < count; i++)
            out[i] = out[0];
    }
}
