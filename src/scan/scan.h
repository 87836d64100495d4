/* A scanned or photographed image in memory, as the whole numbers of its file: bytes or 16-bit words, never floats. */
#ifndef SCAN_SCAN_H
#define SCAN_SCAN_H

#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

typedef enum {
    SCAN_ERROR_FORMAT,  /* not a PNG, JPEG or TIFF file */
    SCAN_ERROR_KIND,    /* an image of such a file that can't be read: floats, 12-bit JPEG, … */
    SCAN_ERROR_DAMAGED, /* the file ends too early or contradicts itself */
    SCAN_ERROR_SIZE,    /* more pixels than allowed or than there is memory for */
    SCAN_ERROR_NO_LEAF, /* nothing in the image stands out from its background */
    SCAN_ERROR_VALUE,   /* a setting that can't be used */
} ScanError;
#define SCAN_ERROR scan_error_quark()
GQuark scan_error_quark(void);

typedef struct {
    uint32_t width, height; /* as seen: the file's orientation has been applied */
    uint32_t channels;      /* 1 grey, 2 grey and alpha, 3 RGB, 4 RGB and alpha; colours are not multiplied by alpha */
    uint32_t depth;         /* bits a sample: 8 or 16 */
    double mm_per_pixel;    /* 0: the file doesn't say; of pixels that are not square the root of their area, so that areas are right */
    double aspect;          /* width of a pixel over its height, as the file says; 1 where the difference is below 1 %; 0: it doesn't say */
    void *px;               /* [height][width][channels], rows from the top: uint8_t or uint16_t */
    bool as_stored;         /* other programs show the file so, too: a PNG or JPEG that no orientation tag turns */
} Scan;

/* Pixels that scan_read allows when it is told no limit: 23 000 × 23 000. */
#define SCAN_MAX_PIXELS ((uint64_t)1 << 29)

/* Reads a PNG, JPEG or (first page of a) TIFF file, whatever its name. Palettes are expanded, 1, 2 and 4 bits widened to 8, CMYK and
 * YCbCr turned into RGB without regard to colour profiles, orientation tags (TIFF, Exif) applied. An image of more than max_pixels
 * (0: SCAN_MAX_PIXELS) is refused before anything is decoded; so is one that is only partly there. Besides the image at most one more
 * copy of it is held at any time, that only for files whose orientation swaps rows and columns. */
Scan *scan_read(const char *path, uint64_t max_pixels, GError **error);

/* An image of zeros; NULL when there is no memory for it. */
Scan *scan_new(uint32_t width, uint32_t height, uint32_t channels, uint32_t depth);
Scan *scan_copy(const Scan *s); /* NULL likewise */

/* The same where only columns x0 … x1 - 1 of rows y0 … y1 - 1 are copied, and the rest is 0 and takes no memory where the system hands out empty pages. */
Scan *scan_copy_part(const Scan *s, uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1);
void scan_free(Scan *s);

static inline uint32_t scan_sample(const Scan *s, uint32_t x, uint32_t y, uint32_t channel)
{
    gsize i = ((gsize)y * s->width + x) * s->channels + channel;
    return s->depth == 8 ? ((const uint8_t *)s->px)[i] : ((const uint16_t *)s->px)[i];
}

#endif
