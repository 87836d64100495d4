/* PNG and OpenEXR files. A file is written beside its target and renamed, so a failed write leaves nothing. */
#ifndef IMAGE_FILE_H
#define IMAGE_FILE_H

#include "image/plane.h"

/* Writes 8 or 16 bits a channel. Colour planes are sRGB-encoded (and carry an sRGB chunk), data planes map low…high to black…
 * white (and carry low, high and unit as text), label planes are written as the whole numbers they are (16 bit when
 * above 255 even if 8 is asked for). GError in G_FILE_ERROR. Same bytes from run to run. */
gboolean image_write_png(const Plane *p, const char *path, int depth, const Metadata *meta, GError **error);

/* The same PNG in memory, for formats that embed images. */
GBytes *image_png_bytes(const Plane *p, int depth, const Metadata *meta);

/* Writes half or float, one part, ZIP compression; channels named Y or R,G,B(,A). */
gboolean image_write_exr(const Plane *p, const char *path, gboolean half, const Metadata *meta, GError **error);

#endif
