#include "geom/textfile.h"

#include <errno.h>
#include <stdio.h>

static gboolean fail(const char *path, int code, GError **error)
{
    char *name = g_filename_display_name(path);
    g_set_error(error, G_FILE_ERROR, (gint)g_file_error_from_errno(code), "can't read '%s': %s", name, g_strerror(code));
    g_free(name);
    return FALSE;
}

gboolean textfile_read(const char *path, gsize most, char **text, gsize *length, GError **error)
{
    enum { CHUNK = 1 << 16 };
    FILE *file = fopen(path, "rb");
    if (!file)
        return fail(path, errno, error);
    GString *s = g_string_new(NULL);
    char *chunk = g_malloc(CHUNK);
    gsize got = 0;
    errno = 0;
    while (s->len <= most && (got = fread(chunk, 1, CHUNK, file)) > 0)
        g_string_append_len(s, chunk, (gssize)got);
    int code = ferror(file) ? (errno ? errno : EIO) : 0;
    fclose(file);
    g_free(chunk);
    if (code == 0 && s->len <= most) {
        *length = s->len;
        *text = g_string_free(s, FALSE);
        return TRUE;
    }
    g_string_free(s, TRUE);
    return fail(path, code ? code : EFBIG, error);
}
