/* A file that appears under its name only when it is whole: written beside the target, then renamed. */
#ifndef IMAGE_STAGED_H
#define IMAGE_STAGED_H

#include <glib.h>
#include <stdio.h>

typedef struct {
    char *path, *temp;
    FILE *file;
} Staged;

/* Opens a temporary file in the folder of `path`. */
gboolean staged_open(Staged *s, const char *path, GError **error);

/* Closes the file and gives it its name; on failure it is removed. Either way `s` is cleared. */
gboolean staged_commit(Staged *s, GError **error);

/* Removes the file. */
void staged_abort(Staged *s);

/* GError in G_FILE_ERROR from errno code `code`: "can't write PATH: reason". */
void staged_error(const char *path, int code, GError **error);

#endif
