/* A painted plane as a scan: through a file, as any scan. */
#ifndef TESTS_READ_BACK_H
#define TESTS_READ_BACK_H

#include <glib.h>
#include <glib/gstdio.h>

#include "image/file.h"
#include "scan/scan.h"

static inline Scan *read_back(const Plane *plane)
{
    GError *error = NULL;
    char *dir = g_dir_make_tmp("venation-read-XXXXXX", &error), *path = g_build_filename(dir, "leaf.png", NULL);
    image_write_png(plane, path, 8, NULL, &error);
    g_assert_no_error(error);
    Scan *s = scan_read(path, 0, &error);
    g_assert_no_error(error);
    g_unlink(path);
    g_rmdir(dir);
    g_free(path);
    g_free(dir);
    return s;
}

#endif
