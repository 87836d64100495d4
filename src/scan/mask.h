/* Regions of pixels: a byte a pixel whose bits are the regions it belongs to, so that a huge image needs one byte more a pixel and no more. */
#ifndef SCAN_MASK_H
#define SCAN_MASK_H

#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

enum {
    MASK_LEAF = 1,   /* on the leaf side of the threshold */
    MASK_SEEN = 2,   /* counted among the components */
    MASK_THIS = 4,   /* of the leaf in hand, its holes included */
    MASK_HOLE = 8,   /* of its holes */
    MASK_OUT = 16,   /* around it */
    MASK_CORE = 32,  /* of it, without what is thin */
    MASK_STALK = 64, /* of its petiole */
    MASK_WORK = 128,
};

/* A rectangle of an image; rows from the top. */
typedef struct {
    uint32_t width, height;
    size_t stride; /* bytes from row to row */
    uint8_t *px;
} Mask;

/* Columns and rows, last ones included. */
typedef struct {
    uint32_t x0, y0, x1, y1;
} MaskBox;

static inline Mask mask_window(const Mask *m, MaskBox b)
{
    return (Mask){b.x1 - b.x0 + 1, b.y1 - b.y0 + 1, m->stride, m->px + (size_t)b.y0 * m->stride + b.x0};
}

static inline uint8_t *mask_at(const Mask *m, uint32_t x, uint32_t y) { return m->px + (size_t)y * m->stride + x; }

/* Which pixels a flood may take, px & test == want, and the bits it sets on them; these must be among those tested. Over corners too when
 * `corners`. */
typedef struct {
    uint8_t test, want, set;
    bool corners;
} Flood;

/* Floods from (x, y), which must be such a pixel. Returns how many were taken; *box (unless NULL) receives their extent. O(pixels taken). */
uint64_t mask_flood(const Mask *m, const Flood *flood, uint32_t x, uint32_t y, MaskBox *box);

/* A connected part of the leaf pixels; they hang together over corners. */
typedef struct {
    uint64_t area;
    uint32_t x, y; /* its first pixel */
    MaskBox box;
} Component;

/* All parts with at least `share` of the largest one's area, largest first, of equals the upper, then the left one. What only edges the
 * image, like a scanner's lid (on its border for more than half the shorter side's length, and on average less than 2 % of that side
 * deep), is passed over. Sets MASK_SEEN. The array is of Component. */
GArray *mask_components(const Mask *m, double share);

/* Sets MASK_THIS on a component and on what it encloses, there MASK_HOLE too, within its box. */
void mask_take(const Mask *m, const Component *c);

/* Clears bits. */
void mask_clear(const Mask *m, uint8_t bits);

/* Moves the border of the region of bit `from` inward or outward by r pixels (a pixel goes, or comes, when one on the other side is no farther
 * than r from centre to centre) and writes it to bit `to`, which may be the same. Beyond the mask there is nothing that could be near.
 * O(pixels) whatever r. */
void mask_erode(const Mask *m, uint8_t from, uint8_t to, double r);
void mask_dilate(const Mask *m, uint8_t from, uint8_t to, double r);

/* Radius of the largest disc within the region of a bit, to some percent. */
double mask_widest(const Mask *m, uint8_t bit);

#endif
