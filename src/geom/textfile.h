/* Reading a whole text file, but no endless one (a device, a wrong path). */
#ifndef GEOM_TEXTFILE_H
#define GEOM_TEXTFILE_H

#include <glib.h>

/* As g_file_get_contents, with a G_FILE_ERROR for what holds more than `most` bytes. */
gboolean textfile_read(const char *path, gsize most, char **text, gsize *length, GError **error);

#endif
