#include "cli/output.h"

#include <errno.h>
#include <glib/gstdio.h>
#include <signal.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct Output {
    char *dir, *staging;
    GPtrArray *made; /* folders that were not there before, outermost first */
    gboolean committed;
    guint files, stale;
    guint64 bytes;
};

/* Staging folders are called .venation-HOST-PROCESS-XXXXXX, so that what a killed run left can be told from what a run is writing now, maybe
 * on another machine. */
static char *staging_name(void)
{
    return g_strdup_printf(".venation-%s-%ld-XXXXXX", g_get_host_name(), (long)getpid());
}

static gboolean fail(GError **error, const char *what, const char *path)
{
    int code = errno;
    char *name = g_filename_display_name(path);
    g_set_error(error, G_FILE_ERROR, g_file_error_from_errno(code), "%s: %s: %s", name, what, g_strerror(code));
    g_free(name);
    return FALSE;
}

static gboolean make_folder(Output *o, const char *path, GError **error)
{
    if (g_file_test(path, G_FILE_TEST_IS_DIR))
        return TRUE;
    char *parent = g_path_get_dirname(path);
    gboolean good = strcmp(parent, path) == 0 || make_folder(o, parent, error);
    g_free(parent);
    if (!good)
        return FALSE;
    if (g_mkdir(path, 0777) == 0)
        g_ptr_array_add(o->made, g_strdup(path));
    else if (errno != EEXIST)
        return fail(error, "can't make the output folder", path);
    if (g_file_test(path, G_FILE_TEST_IS_DIR)) /* made here, or by another run just now */
        return TRUE;
    errno = ENOTDIR;
    return fail(error, "can't make the output folder", path);
}

static void remove_tree(const char *path)
{
    GDir *dir = g_dir_open(path, 0, NULL);
    const char *name;
    while (dir && (name = g_dir_read_name(dir))) {
        char *child = g_build_filename(path, name, NULL);
        if (g_unlink(child) != 0)
            remove_tree(child);
        g_free(child);
    }
    if (dir)
        g_dir_close(dir);
    g_rmdir(path);
}

/* Removes what runs on this machine left that were killed. */
static void sweep_dead(const char *path)
{
    char *begin = g_strdup_printf(".venation-%s-", g_get_host_name());
    GDir *dir = g_dir_open(path, 0, NULL);
    const char *name;
    while (dir && (name = g_dir_read_name(dir))) {
        gint64 process = g_str_has_prefix(name, begin) ? g_ascii_strtoll(name + strlen(begin), NULL, 10) : 0;
        if (process <= 0 || kill((pid_t)process, 0) == 0 || errno != ESRCH)
            continue;
        char *child = g_build_filename(path, name, NULL);
        remove_tree(child);
        g_free(child);
    }
    if (dir)
        g_dir_close(dir);
    g_free(begin);
}

Output *output_new(const char *dir, GError **error)
{
    Output *o = g_new0(Output, 1);
    o->made = g_ptr_array_new_with_free_func(g_free);
    o->dir = g_strdup(dir);
    /* "a/" would have "a" as its parent and be made twice */
    for (gsize n = strlen(o->dir); n > 1 && o->dir[n - 1] == '/'; n--)
        o->dir[n - 1] = '\0';
    if (make_folder(o, o->dir, error)) {
        sweep_dead(o->dir);
        char *name = staging_name();
        o->staging = g_build_filename(o->dir, name, NULL);
        g_free(name);
        if (g_mkdtemp(o->staging))
            return o;
        fail(error, "can't write to the output folder", o->dir);
        g_clear_pointer(&o->staging, g_free);
    }
    output_free(o);
    return NULL;
}

void output_discard(Output *o)
{
    if (o->staging) {
        /* Under another name, so that a writer that is still at work can't add to it. */
        char *away = g_strconcat(o->staging, "-", NULL);
        if (g_rename(o->staging, away) == 0)
            remove_tree(away);
        remove_tree(o->staging);
        g_free(away);
    }
    for (guint i = o->made->len; i-- > 0 && !o->committed;)
        g_rmdir(o->made->pdata[i]); /* fails, as it should, when others have put something there */
}

void output_free(Output *o)
{
    if (!o)
        return;
    output_discard(o);
    g_ptr_array_unref(o->made);
    g_free(o->staging);
    g_free(o->dir);
    g_free(o);
}

const char *output_staging(const Output *o)
{
    return o->staging;
}

/* Paths below `path`, relative to the staging folder: files into `files`, folders into `folders`. */
static void list_tree(const Output *o, const char *relative, GPtrArray *files, GPtrArray *folders)
{
    char *path = g_build_filename(o->staging, relative, NULL);
    GDir *dir = g_dir_open(path, 0, NULL);
    const char *name;
    while (dir && (name = g_dir_read_name(dir))) {
        char *child = *relative ? g_build_filename(relative, name, NULL) : g_strdup(name);
        char *full = g_build_filename(o->staging, child, NULL);
        gboolean folder = g_file_test(full, G_FILE_TEST_IS_DIR);
        g_ptr_array_add(folder ? folders : files, child);
        if (folder)
            list_tree(o, child, files, folders);
        g_free(full);
    }
    if (dir)
        g_dir_close(dir);
    g_free(path);
}

/* Something of the wrong kind in the way of a file or folder. */
static gboolean check_way(const Output *o, const GPtrArray *paths, gboolean folder, GError **error)
{
    for (guint i = 0; i < paths->len; i++) {
        char *target = g_build_filename(o->dir, paths->pdata[i], NULL);
        gboolean blocked = g_file_test(target, G_FILE_TEST_EXISTS) && g_file_test(target, G_FILE_TEST_IS_DIR) != folder;
        if (blocked) {
            errno = folder ? ENOTDIR : EISDIR;
            fail(error, "in the way of what was grown", target);
        }
        g_free(target);
        if (blocked)
            return FALSE;
    }
    return TRUE;
}

static gboolean move(Output *o, const char *relative, GError **error)
{
    char *from = g_build_filename(o->staging, relative, NULL), *to = g_build_filename(o->dir, relative, NULL);
    GStatBuf info;
    gboolean good = g_stat(from, &info) == 0 && g_rename(from, to) == 0;
    if (good) {
        o->files++;
        o->bytes += (guint64)info.st_size;
    } else {
        fail(error, "can't write", to);
    }
    g_free(from);
    g_free(to);
    return good;
}

static gboolean move_all(Output *o, const GPtrArray *files, const GPtrArray *folders, GError **error)
{
    for (guint i = 0; i < folders->len; i++) {
        char *path = g_build_filename(o->dir, folders->pdata[i], NULL);
        gboolean good = make_folder(o, path, error);
        g_free(path);
        if (!good)
            return FALSE;
    }
    for (int records = 0; records < 2; records++)
        for (guint i = 0; i < files->len; i++)
            if (g_str_has_suffix(files->pdata[i], ".json") == records && !move(o, files->pdata[i], error))
                return FALSE;
    return TRUE;
}

/* NAME_000120.svg, NAME_000120_opacity.png */
static gboolean is_frame(const char *rest)
{
    return *rest == '_' && strspn(rest + 1, "0123456789") >= 6;
}

/* Files in a folder of the output that begin with NAME_ or NAME. and are not among `written`: counted; frames among them removed on demand. */
static guint old_files(const Output *o, const char *folder, const char *name, GHashTable *written, gboolean remove_frames)
{
    char *path = g_build_filename(o->dir, folder, NULL);
    GDir *dir = g_dir_open(path, 0, NULL);
    const char *entry;
    guint n = 0;
    while (dir && (entry = g_dir_read_name(dir))) {
        const char *rest = entry + strlen(name);
        if (!g_str_has_prefix(entry, name) || (*rest != '_' && *rest != '.'))
            continue;
        char *relative = *folder ? g_build_filename(folder, entry, NULL) : g_strdup(entry);
        if (!g_hash_table_contains(written, relative)) {
            n++;
            char *file = g_build_filename(path, entry, NULL);
            if (remove_frames && is_frame(rest))
                g_unlink(file);
            g_free(file);
        }
        g_free(relative);
    }
    if (dir)
        g_dir_close(dir);
    g_free(path);
    return n;
}

/* After all is in place. */
static void look_after_old(Output *o, const char *name, const GPtrArray *files, const GPtrArray *folders)
{
    GHashTable *written = g_hash_table_new(g_str_hash, g_str_equal);
    for (guint i = 0; i < files->len; i++)
        g_hash_table_add(written, files->pdata[i]);
    for (guint i = 0; i < folders->len; i++)
        old_files(o, folders->pdata[i], name, written, TRUE);
    o->stale = old_files(o, "", name, written, FALSE);
    g_hash_table_destroy(written);
}

gboolean output_commit(Output *o, const char *name, GError **error)
{
    GPtrArray *files = g_ptr_array_new_with_free_func(g_free), *folders = g_ptr_array_new_with_free_func(g_free);
    list_tree(o, "", files, folders);
    o->committed =
        check_way(o, files, FALSE, error) && check_way(o, folders, TRUE, error) && move_all(o, files, folders, error);
    if (o->committed)
        look_after_old(o, name, files, folders);
    g_ptr_array_unref(files);
    g_ptr_array_unref(folders);
    return o->committed;
}

guint output_stale(const Output *o)
{
    return o->stale;
}

guint output_files(const Output *o)
{
    return o->files;
}

guint64 output_bytes(const Output *o)
{
    return o->bytes;
}
