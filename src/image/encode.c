#include "image/encode.h"

#include <string.h>

#include "geom/dmath.h"

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

void encoder_init(Encoder *e, const Plane *p, int depth)
{
    *e = (Encoder){depth == 16 ? 16 : 8, p->channels, FALSE, NULL};
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
    }
}

void encoder_clear(Encoder *e)
{
    g_free(e->srgb);
    e->srgb = NULL;
}

static uint32_t to_level(double v, double top)
{
    if (!(v > 0.0))
        return 0;
    return v >= top ? (uint32_t)top : (uint32_t)(v + 0.5);
}

static void put_level(uint8_t **out, uint32_t v, int depth)
{
    if (depth == 16)
        *(*out)++ = (uint8_t)(v >> 8);
    *(*out)++ = (uint8_t)v;
}

static void pack_row(const float *in, uint32_t n, uint8_t *out)
{
    for (uint32_t i = 0; i < n; i++, out += 3) {
        uint32_t v = to_level((double)in[i], 16777215.0);
        out[0] = (uint8_t)(v >> 16);
        out[1] = (uint8_t)(v >> 8);
        out[2] = (uint8_t)v;
    }
}

void encoder_row(const Encoder *e, const Plane *p, uint32_t y, uint8_t *out)
{
    uint32_t n = p->width * p->channels;
    const float *in = p->px + (gsize)y * n;
    double top = e->depth == 16 ? 65535.0 : 255.0;
    double range = p->high - p->low, gain = range != 0.0 ? top / range : 0.0;
    if (e->packed) {
        pack_row(in, n, out);
        return;
    }
    for (uint32_t i = 0; i < n; i++) {
        double v = (double)in[i];
        /* a fourth channel is opacity, which has no gamma */
        if (p->kind == PLANE_COLOUR)
            v = (p->channels == 4 && i % 4 == 3 ? v : srgb_at(e->srgb, v)) * top;
        else if (p->kind == PLANE_DATA)
            v = (v - p->low) * gain;
        put_level(&out, to_level(v, top), e->depth);
    }
}

uint16_t encode_half(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    uint32_t sign = bits >> 16 & 0x8000u, mag = bits & 0x7FFFFFFFu;
    if (mag >= 0x7F800000u)
        return (uint16_t)(sign | (mag > 0x7F800000u ? 0x7E00u : 0x7C00u));
    if (mag >= 0x477FF000u) /* 65520 and above round to infinity */
        return (uint16_t)(sign | 0x7C00u);
    if (mag < 0x38800000u) { /* below 2^-14: a multiple of 2^-24, which adding 1/2 rounds to */
        float m;
        memcpy(&m, &mag, sizeof m);
        m += 0.5f;
        memcpy(&mag, &m, sizeof mag);
        return (uint16_t)(sign | (mag - 0x3F000000u));
    }
    mag += 0xFFFu + (mag >> 13 & 1u);
    return (uint16_t)(sign | (mag - 0x38000000u) >> 13);
}
