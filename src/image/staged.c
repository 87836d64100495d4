#include "image/staged.h"

#include <errno.h>
#include <fcntl.h>
#include <glib/gstdio.h>
#include <unistd.h>

void staged_error(const char *path, int code, GError **error)
{
    g_set_error(error, G_FILE_ERROR, (gint)g_file_error_from_errno(code), "can't write %s: %s", path, g_strerror(code));
}

static void staged_clear(Staged *s)
{
    g_free(s->path);
    g_free(s->temp);
    *s = (Staged){0};
}

gboolean staged_open(Staged *s, const char *path, GError **error)
{
    *s = (Staged){0};
    char *dir = g_path_get_dirname(path), *base = g_path_get_basename(path);
    s->path = g_strdup(path);
    s->temp = g_strdup_printf("%s/.%s.XXXXXX", dir, base);
    g_free(dir);
    g_free(base);
    int fd = g_mkstemp_full(s->temp, O_RDWR | O_CLOEXEC, 0666);
    if (fd < 0) {
        staged_error(path, errno, error);
        staged_clear(s);
        return FALSE;
    }
    s->file = fdopen(fd, "w+b");
    if (s->file == NULL) {
        staged_error(path, errno, error);
        close(fd);
        g_unlink(s->temp);
        staged_clear(s);
        return FALSE;
    }
    return TRUE;
}

gboolean staged_commit(Staged *s, GError **error)
{
    int code = fflush(s->file) != 0 ? errno : 0;
    if (fclose(s->file) != 0 && code == 0)
        code = errno;
    if (code == 0 && g_rename(s->temp, s->path) != 0)
        code = errno;
    if (code != 0) {
        staged_error(s->path, code, error);
        g_unlink(s->temp);
    }
    staged_clear(s);
    return code == 0;
}

void staged_abort(Staged *s)
{
    if (s->file != NULL) {
        fclose(s->file);
        g_unlink(s->temp);
    }
    staged_clear(s);
}
