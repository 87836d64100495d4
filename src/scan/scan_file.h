/* What the readers of the three file formats share. */
#ifndef SCAN_SCAN_FILE_H
#define SCAN_SCAN_FILE_H

#include <stdio.h>

#include "scan/scan.h"

/* A file being read, and what it says about its image beside the pixels. */
typedef struct {
    const char *path;
    FILE *file; /* at its beginning */
    uint64_t max_pixels;
    unsigned orientation;     /* 1 … 8 as in TIFF and Exif; 0: not said */
    double across_mm, down_mm; /* pixels a millimetre, as stored; 0: not said */
} ScanFile;

/* Each decodes the pixels as they are stored; orientation is the caller's. NULL with an error that names the file. */
Scan *scan_read_png(ScanFile *f, GError **error);
Scan *scan_read_jpeg(ScanFile *f, GError **error);
Scan *scan_read_tiff(ScanFile *f, GError **error);

/* Memory for an image as the file announces it, within the limit. */
Scan *scan_file_new(const ScanFile *f, uint64_t width, uint64_t height, uint32_t channels, uint32_t depth, GError **error);

/* Sets the error that memory is lacking, which is not the image's fault. Returns NULL. */
Scan *scan_file_no_memory(const ScanFile *f, GError **error);

/* Sets an error "path: …". Returns NULL. */
Scan *scan_file_error(const ScanFile *f, ScanError code, GError **error, const char *format, ...) G_GNUC_PRINTF(4, 5);

/* Orientation and resolution from an Exif block (a TIFF header and its first directory); anything odd in it is passed over. Keeps what f knows
 * already. */
void scan_file_exif(ScanFile *f, const uint8_t *data, size_t n);

/* Turns the stored image so that it stands as the tag says (1 … 8; others leave it). False when memory for it is lacking. */
bool scan_orient(Scan *s, unsigned orientation);

#endif
