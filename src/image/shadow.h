/* The soft shadow of the blade. */
#ifndef IMAGE_SHADOW_H
#define IMAGE_SHADOW_H

#include "image/painter.h"

/* How much of the blade is near: its coverage, blurred. On a grid of its own, as fine as the blur asks for, so that it is small and the
 * same for all bands. */
typedef struct Shadow Shadow;

/* `sigma`: standard deviation of the blur, pixels, raised to what a grid of half pixels, and of 2048 cells, can show. */
Shadow *shadow_new(const Painter *p, double sigma);
void shadow_free(Shadow *s);

/* 0 … 1 at a place, image coordinates. */
double shadow_at(const Shadow *s, Vec2 at);

#endif
