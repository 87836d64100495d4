/* Plane values as the whole numbers a PNG file holds, and as half floats. */
#ifndef IMAGE_ENCODE_H
#define IMAGE_ENCODE_H

#include "image/plane.h"

/* How a plane is laid out in a PNG file. */
typedef struct {
    int depth;         /* bits a channel: 8 or 16 */
    uint32_t channels; /* of the file */
    gboolean packed;   /* labels above 65535: value = R * 65536 + G * 256 + B */
    double *srgb;      /* curve for colour planes, else NULL */
    uint16_t *quick;   /* levels of 8 bits at its steps, where they don't change up to the next one; NULL: of 16 bits they do */
} Encoder;

/* Chooses the layout for a plane when `depth` bits are asked for. */
void encoder_init(Encoder *e, const Plane *p, int depth);
void encoder_clear(Encoder *e);

/* Row y of the plane as bytes of a PNG row (16 bits big-endian): width * channels * depth / 8 of them. */
void encoder_row(const Encoder *e, const Plane *p, uint32_t y, uint8_t *out);

/* IEEE binary16, rounded to nearest even; overflow gives infinity. */
uint16_t encode_half(float value);

/* The same of n values. */
void encode_halves(const float *in, uint32_t n, uint16_t *out);

#endif
