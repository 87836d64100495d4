/* From places on a line to pixels. */
#ifndef IMAGE_PIXELS_H
#define IMAGE_PIXELS_H

#include "image/capsule.h"

/* floor(v) and ceil(v) within lo … hi; lo for what is no number. */
static inline uint32_t floor_within(double v, uint32_t lo, uint32_t hi)
{
    return !(v >= lo + 1.0) ? lo : v >= hi ? hi : (uint32_t)v;
}

static inline uint32_t ceil_within(double v, uint32_t lo, uint32_t hi)
{
    if (!(v > lo))
        return lo;
    return v > hi - 1.0 ? hi : (uint32_t)v + (v > (uint32_t)v);
}

/* Pixels [*first, *last) of lo … hi (pixel units, the pixel i covers i … i + 1) that lie in [x0, x1): those touched,
 * wholly inside, and those whose centres are inside. */
static inline void pixels_touched(Span s, uint32_t x0, uint32_t x1, uint32_t *first, uint32_t *last)
{
    *first = s.lo > s.hi ? x0 : floor_within(s.lo, x0, x1);
    *last = s.lo > s.hi ? x0 : ceil_within(s.hi, x0, x1);
    *last = *last < *first ? *first : *last;
}

static inline void pixels_inside(Span s, uint32_t x0, uint32_t x1, uint32_t *first, uint32_t *last)
{
    *first = s.lo > s.hi ? x0 : ceil_within(s.lo, x0, x1);
    *last = s.lo > s.hi ? x0 : floor_within(s.hi, x0, x1);
    *last = *last < *first ? *first : *last;
}

static inline void pixels_centred(Span s, uint32_t x0, uint32_t x1, uint32_t *first, uint32_t *last)
{
    s.lo += 0.5;
    s.hi += 0.5;
    /* a centre at i + 0.5 lies in lo … hi when i + 1 lies in lo + 0.5 … hi + 0.5 */
    *first = s.lo > s.hi ? x0 : ceil_within(s.lo, x0 + 1, x1 + 1) - 1;
    *last = s.lo > s.hi ? x0 : floor_within(s.hi, x0, x1);
    *last = *last < *first ? *first : *last;
}

/* Pixel rows of [y0, y1) that the stroke touches. */
static inline void pixel_rows(const Capsule *k, uint32_t y0, uint32_t y1, uint32_t *first, uint32_t *last)
{
    Box2 box = capsule_box(k);
    pixels_touched((Span){box.y0, box.y1}, y0, y1, first, last);
}

#endif
