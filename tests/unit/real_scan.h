/* Real scans for tests: params/scans/grape.jpg, which comes with the sources, and others where there are any, in the folder that VENATION_SCANS names, else
 * shared/scans beside the checkout. */
#ifndef TESTS_REAL_SCAN_H
#define TESTS_REAL_SCAN_H

#include <glib.h>

#include "scan/scan.h"

/* NULL where there is no such file. */
static inline char *real_path(const char *name)
{
    const char *folder = g_getenv("VENATION_SCANS");
    char *path = g_test_build_filename(G_TEST_DIST, "..", "..", "params", "scans", name, NULL);
    if (!g_file_test(path, G_FILE_TEST_EXISTS) && !g_str_equal(name, "grape.jpg")) {
        g_free(path);
        path = folder ? g_build_filename(folder, name, NULL) : g_test_build_filename(G_TEST_DIST, "..", "..", "..", "shared", "scans", name, NULL);
    }
    if (g_file_test(path, G_FILE_TEST_EXISTS) || g_str_equal(name, "grape.jpg"))
        return path;
    g_free(path);
    return NULL;
}

/* NULL, and the test counts as skipped, where it is not here. */
static inline Scan *real_scan(const char *name)
{
    char *path = real_path(name);
    if (!path) {
        g_test_skip("this scan is not here; VENATION_SCANS can name its folder");
        return NULL;
    }
    GError *error = NULL;
    Scan *s = scan_read(path, 0, &error);
    g_assert_no_error(error);
    g_free(path);
    return s;
}

#endif
