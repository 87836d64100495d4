#include "lib/fault.h"

#include <gio/gio.h>

/* A file that was to be read (an outline, sources) and that isn't there or is closed to us. */
static gboolean is_missing_file(const GError *error)
{
    static const GFileError file[] = {G_FILE_ERROR_NOENT, G_FILE_ERROR_ACCES,  G_FILE_ERROR_PERM,
                                      G_FILE_ERROR_ISDIR, G_FILE_ERROR_NOTDIR, G_FILE_ERROR_NAMETOOLONG,
                                      G_FILE_ERROR_LOOP};
    static const GIOErrorEnum io[] = {G_IO_ERROR_NOT_FOUND,         G_IO_ERROR_PERMISSION_DENIED,
                                      G_IO_ERROR_IS_DIRECTORY,      G_IO_ERROR_NOT_DIRECTORY,
                                      G_IO_ERROR_FILENAME_TOO_LONG, G_IO_ERROR_TOO_MANY_LINKS};
    for (gsize i = 0; i < G_N_ELEMENTS(file); i++)
        if (g_error_matches(error, G_FILE_ERROR, file[i]))
            return TRUE;
    for (gsize i = 0; i < G_N_ELEMENTS(io); i++)
        if (g_error_matches(error, G_IO_ERROR, io[i]))
            return TRUE;
    return FALSE;
}

gboolean fault_is_input(const GError *error, gboolean reading)
{
    gboolean system = error->domain == G_FILE_ERROR || error->domain == G_IO_ERROR;
    return !system || (reading && is_missing_file(error));
}
