/* Float images in memory: one to four channels, rows from the top, interleaved. */
#ifndef IMAGE_PLANE_H
#define IMAGE_PLANE_H

#include <glib.h>
#include <stdint.h>

typedef enum {
    PLANE_DATA,   /* linear values, written as they are */
    PLANE_COLOUR, /* linear light; written sRGB-encoded to PNG, linear to EXR */
    PLANE_LABEL,  /* whole numbers: never blended, never scaled */
} PlaneKind;

typedef struct {
    uint32_t width, height, channels;
    PlaneKind kind;
    double low, high; /* what black and white stand for in PNG (data planes); EXR holds the values themselves. Labels: high is the
                       * largest there can be */
    const char *unit; /* of low and high, for the metadata: "segments", "steps", "" */
    float *px;        /* [height][width][channels] */
} Plane;

Plane *plane_new(uint32_t width, uint32_t height, uint32_t channels, PlaneKind kind);
void plane_free(Plane *p);

/* Key-value texts that go into PNG text chunks and EXR string attributes. Both arrays hold n strings. */
typedef struct {
    uint32_t n;
    const char *const *key;
    const char *const *value;
} Metadata;

#endif
