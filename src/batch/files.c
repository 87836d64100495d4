/* Folders of variants: their sums, and how they come to their places. */
#include <errno.h>
#include <fcntl.h>
#include <glib/gstdio.h>
#include <string.h>
#include <unistd.h>

#include "batch/private.h"
#include "export/export.h"

gboolean batch_fail(GError **error, const char *what, const char *path)
{
    int code = errno;
    char *name = g_filename_display_name(path);
    g_set_error(error, G_FILE_ERROR, g_file_error_from_errno(code), "%s: %s: %s", name, what, g_strerror(code));
    g_free(name);
    return FALSE;
}

void batch_name_plainly(GError *error, const char *hidden, const char *folder)
{
    char **parts = g_strsplit(error->message, hidden, -1);
    g_free(error->message);
    error->message = g_strjoinv(folder, parts);
    g_strfreev(parts);
}

void batch_remove(const char *path)
{
    GDir *dir = g_dir_open(path, 0, NULL);
    const char *name;
    while (dir && (name = g_dir_read_name(dir))) {
        char *child = g_build_filename(path, name, NULL);
        if (g_unlink(child) != 0)
            batch_remove(child);
        g_free(child);
    }
    if (dir)
        g_dir_close(dir);
    g_rmdir(path);
}

gboolean batch_make_folder(const char *path, GError **error)
{
    return g_mkdir_with_parents(path, 0777) == 0 || batch_fail(error, "can't make the folder", path);
}

static gboolean make_parent(const char *path, GError **error)
{
    char *parent = g_path_get_dirname(path);
    gboolean ok = batch_make_folder(parent, error);
    g_free(parent);
    return ok;
}

/* A name beside it that no variant has, as theirs begin with no point. */
static char *aside(const char *path)
{
    char *folder = g_path_get_dirname(path), *name = g_path_get_basename(path), *away = g_strdup_printf("%s/.%s", folder, name);
    g_free(folder);
    g_free(name);
    return away;
}

gboolean batch_move_folder(const char *from, const char *to, GError **error)
{
    enum { TRIES = 20 }; /* others may be at it, too */
    if (!make_parent(to, error))
        return FALSE;
    char *away = aside(from);
    gboolean ok = g_rename(from, to) == 0;
    for (int i = 0; i < TRIES && !ok && (errno == ENOTEMPTY || errno == EEXIST); i++) {
        if (g_rename(to, away) == 0)
            batch_remove(away);
        ok = g_rename(from, to) == 0;
    }
    ok = ok || batch_fail(error, "can't write", to);
    g_free(away);
    return ok;
}

static gboolean sync_path(const char *path, int how, GError **error)
{
    int file = g_open(path, how | O_CLOEXEC, 0);
    if (file < 0)
        return batch_fail(error, "can't be read", path);
    gboolean ok = fsync(file) == 0 || errno == EINVAL || errno == ENOTSUP; /* some file systems have no such thing */
    ok = ok || batch_fail(error, "can't write", path);
    close(file);
    return ok;
}

/* File by file: syncfs would wait for what all other programs have in hand, too. */
gboolean batch_sync_folder(const char *folder, GError **error)
{
    GDir *dir = g_dir_open(folder, 0, error);
    const char *name;
    gboolean ok = dir != NULL;
    while (ok && (name = g_dir_read_name(dir))) {
        char *path = g_build_filename(folder, name, NULL);
        ok = sync_path(path, O_RDONLY, error);
        g_free(path);
    }
    if (dir)
        g_dir_close(dir);
    return ok && sync_path(folder, O_RDONLY | O_DIRECTORY, error);
}

gboolean batch_place_file(const char *staging, const char *out, const char *name, GError **error)
{
    char *from = g_build_filename(staging, name, NULL), *to = g_build_filename(out, name, NULL);
    gboolean ok = g_rename(from, to) == 0 || batch_fail(error, "can't write", to);
    g_free(from);
    g_free(to);
    return ok;
}

gboolean batch_write_row(const char *row, const char *path, GError **error)
{
    char *line = g_strconcat(row, "\n", NULL);
    GError *failure = NULL;
    gboolean ok = make_parent(path, error) && export_text(line, strlen(line), path, &failure);
    if (g_error_matches(failure, G_FILE_ERROR, G_FILE_ERROR_NOENT)) { /* another run removed the folder, which was empty */
        g_clear_error(&failure);
        ok = make_parent(path, error) && export_text(line, strlen(line), path, &failure);
    }
    if (failure)
        g_propagate_error(error, failure);
    g_free(line);
    return ok;
}

/* ---- sums ---- */

static gint by_text(gconstpointer a, gconstpointer b) { return strcmp(*(char *const *)a, *(char *const *)b); }

static GPtrArray *list_folder(const char *folder, GError **error)
{
    GDir *dir = g_dir_open(folder, 0, error);
    const char *name;
    if (!dir)
        return NULL;
    GPtrArray *names = g_ptr_array_new_with_free_func(g_free);
    while ((name = g_dir_read_name(dir)))
        g_ptr_array_add(names, g_strdup(name));
    g_dir_close(dir);
    g_ptr_array_sort(names, by_text);
    return names;
}

uint64_t batch_folder_bytes(const char *folder)
{
    GPtrArray *names = list_folder(folder, NULL);
    uint64_t bytes = 0;
    for (guint i = 0; names && i < names->len; i++) {
        char *path = g_build_filename(folder, names->pdata[i], NULL);
        GStatBuf info;
        bytes += g_stat(path, &info) == 0 ? (uint64_t)info.st_size : 0;
        g_free(path);
    }
    if (names)
        g_ptr_array_unref(names);
    return bytes;
}

/* The row tells of the others; hidden files, as a file manager leaves them, are none of ours. */
static bool is_summed(const char *name) { return *name != '.' && strcmp(name, "sweep.json") != 0; }

gboolean batch_measure_folder(const char *folder, FolderSum *out)
{
    GDir *dir = g_dir_open(folder, 0, NULL);
    const char *name;
    *out = (FolderSum){0};
    while (dir && (name = g_dir_read_name(dir))) {
        char *path = g_build_filename(folder, name, NULL);
        GStatBuf info;
        if (is_summed(name) && g_stat(path, &info) == 0) {
            out->files++;
            out->bytes += (uint64_t)info.st_size;
        }
        g_free(path);
    }
    if (dir)
        g_dir_close(dir);
    return dir != NULL;
}

/* Takes a file in, a piece at a time. */
static gboolean add_file(const char *path, GChecksum *sum, uint64_t *bytes, GError **error)
{
    enum { PIECE = 1 << 16 };
    int file = g_open(path, O_RDONLY | O_CLOEXEC, 0);
    if (file < 0)
        return batch_fail(error, "can't be read", path);
    guchar *piece = g_malloc(PIECE);
    ssize_t n;
    while ((n = read(file, piece, PIECE)) > 0 || (n < 0 && errno == EINTR)) {
        if (n < 0)
            continue;
        g_checksum_update(sum, piece, n);
        *bytes += (uint64_t)n;
    }
    gboolean ok = n == 0 || batch_fail(error, "can't be read", path);
    close(file);
    g_free(piece);
    return ok;
}

gboolean batch_sum_folder(const char *folder, FolderSum *out, GError **error)
{
    GPtrArray *names = list_folder(folder, error);
    if (!names)
        return FALSE;
    *out = (FolderSum){0};
    GChecksum *all = g_checksum_new(G_CHECKSUM_SHA256), *one = g_checksum_new(G_CHECKSUM_SHA256);
    gboolean ok = TRUE;
    for (guint i = 0; ok && i < names->len; i++) {
        if (!is_summed(names->pdata[i]))
            continue;
        char *path = g_build_filename(folder, names->pdata[i], NULL);
        out->files++;
        g_checksum_reset(one);
        ok = add_file(path, one, &out->bytes, error);
        char *line = g_strdup_printf("%s  %s\n", g_checksum_get_string(one), (char *)names->pdata[i]);
        g_checksum_update(all, (const guchar *)line, -1);
        g_free(line);
        g_free(path);
    }
    g_strlcpy(out->sha256, g_checksum_get_string(all), sizeof out->sha256);
    g_checksum_free(all);
    g_checksum_free(one);
    g_ptr_array_unref(names);
    return ok;
}
