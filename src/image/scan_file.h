/* A scan written as it is, for other programs to show. */
#ifndef IMAGE_SCAN_FILE_H
#define IMAGE_SCAN_FILE_H

#include "scan/scan.h"

/* PNG with the scan's own samples, 8 or 16 bits, and its resolution. Compressed for speed. */
gboolean image_write_scan(const Scan *s, const char *path, GError **error);

/* How many pages a TIFF file has, thumbnails not counted, up to 1000; 1 of any other file. */
uint32_t image_pages(const char *path);

#endif
