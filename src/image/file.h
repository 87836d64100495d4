/* PNG and OpenEXR files. A file is written beside its target and renamed, so a failed write leaves nothing. */
#ifndef IMAGE_FILE_H
#define IMAGE_FILE_H

#include "geom/parallel.h"
#include "image/plane.h"

/* An image file that is written band by band, from the top. */
typedef struct ImageFile ImageFile;

/* Begin files of `height` rows, otherwise like the plane `like`; its pixels don't matter. GError in G_FILE_ERROR. Same bytes from run
 * to run, whatever the bands.
 *
 * PNG of 8 or 16 bits a channel: colour planes are sRGB-encoded (and carry an sRGB chunk), data planes map low…high to black…white
 * (and carry low, high and unit as text), label planes are written as the whole numbers they are (16 bit when they may be above 255
 * even if 8 is asked for).
 * EXR of float or, where the range and kind allow it, half; one part, ZIP compression; channels named Y or R,G,B(,A). `pool`, which may be NULL,
 * compresses. */
ImageFile *image_png_begin(const char *path, const Plane *like, uint32_t height, int depth, const Metadata *meta, GError **error);
ImageFile *image_exr_begin(const char *path, const Plane *like, uint32_t height, gboolean half, const Metadata *meta, Pool *pool,
                           GError **error);

/* Bands but the last have a multiple of IMAGE_BAND rows. */
enum { IMAGE_BAND = 16 };
gboolean image_file_rows(ImageFile *file, const Plane *band, GError **error);

/* Gives the file its name; frees it either way. */
gboolean image_file_end(ImageFile *file, GError **error);

/* Gives it up; NULL is fine. */
void image_file_abort(ImageFile *file);

/* Whole planes. */
gboolean image_write_png(const Plane *p, const char *path, int depth, const Metadata *meta, GError **error);
gboolean image_write_exr(const Plane *p, const char *path, gboolean half, const Metadata *meta, GError **error);

/* A PNG in memory, for formats that embed images. */
GBytes *image_png_bytes(const Plane *p, int depth, const Metadata *meta);

/* What a format provides: each fails with an error, `end` frees the file also then. */
struct ImageFile {
    gboolean (*rows)(ImageFile *file, const Plane *band, GError **error);
    gboolean (*end)(ImageFile *file, GError **error);
    void (*abort)(ImageFile *file);
};

#endif
