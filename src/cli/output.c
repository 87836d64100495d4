#include "cli/output.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <glib/gstdio.h>
#include <signal.h>
#include <stdatomic.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct Output {
    char *dir, *staging;
    char *away;      /* room for the name under which the staging folder is removed */
    GPtrArray *made; /* folders that were not there before, outermost first */
    gboolean committed;
    guint files, stale;
    guint64 bytes;
};

/* Those open, for output_discard_all; what finds no room here is left to the next run if the process ends at once. */
static _Atomic(Output *) opened[64];

static void note(Output *from, Output *to)
{
    for (gsize i = 0; i < G_N_ELEMENTS(opened); i++) {
        Output *expected = from;
        if (atomic_compare_exchange_strong(&opened[i], &expected, to))
            return;
    }
}

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
    g_ptr_array_add(o->made, g_strdup(path)); /* before it is there: memory may run out here */
    if (g_mkdir(path, 0777) != 0) {
        int code = errno;
        g_ptr_array_set_size(o->made, (gint)o->made->len - 1);
        errno = code;
        if (code != EEXIST)
            return fail(error, "can't make the output folder", path);
    }
    if (g_file_test(path, G_FILE_TEST_IS_DIR)) /* made here, or by another run just now */
        return TRUE;
    errno = g_file_test(path, G_FILE_TEST_EXISTS) ? ENOTDIR : ENOENT; /* something else is there, or someone has just removed it */
    return fail(error, "can't make the output folder", path);
}

/* Removes a file, or a folder with all that is in it. Neither allocates nor locks: it runs in signal handlers and when memory has run out. */
static void remove_tree(int at, const char *path)
{
    if (unlinkat(at, path, 0) == 0)
        return;
    int folder = openat(at, path, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (folder < 0)
        return;
    _Alignas(struct dirent64) char entries[2048];
    gboolean found;
    do { /* until nothing is left, as removing may move entries that were not read yet */
        found = FALSE;
        lseek(folder, 0, SEEK_SET);
        for (ssize_t n; (n = getdents64(folder, entries, sizeof entries)) > 0;)
            for (ssize_t i = 0; i < n;) {
                const struct dirent64 *entry = (const struct dirent64 *)(const void *)(entries + i);
                i += entry->d_reclen;
                if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
                    continue;
                remove_tree(folder, entry->d_name);
                found |= faccessat(folder, entry->d_name, F_OK, AT_SYMLINK_NOFOLLOW) != 0;
            }
    } while (found);
    close(folder);
    unlinkat(at, path, AT_REMOVEDIR);
}

/* Names of what is in a folder. */
static GPtrArray *read_folder(const char *path, GError **error)
{
    GDir *dir = g_dir_open(path, 0, error);
    if (!dir)
        return NULL;
    GPtrArray *names = g_ptr_array_new_with_free_func(g_free);
    const char *name;
    while (errno = 0, (name = g_dir_read_name(dir)))
        g_ptr_array_add(names, g_strdup(name));
    int code = errno;
    g_dir_close(dir);
    if (code == 0)
        return names;
    g_ptr_array_unref(names);
    errno = code;
    fail(error, "can't be read", path);
    return NULL;
}

/* Removes what runs on this machine left that were killed. */
static void sweep_dead(const char *path)
{
    char *begin = g_strdup_printf(".venation-%s-", g_get_host_name());
    GPtrArray *names = read_folder(path, NULL);
    for (guint i = 0; names && i < names->len; i++) {
        const char *name = names->pdata[i];
        gint64 process = g_str_has_prefix(name, begin) ? g_ascii_strtoll(name + strlen(begin), NULL, 10) : 0;
        if (process <= 0 || kill((pid_t)process, 0) == 0 || errno != ESRCH)
            continue;
        char *child = g_build_filename(path, name, NULL);
        remove_tree(AT_FDCWD, child);
        g_free(child);
    }
    if (names)
        g_ptr_array_unref(names);
    g_free(begin);
}

Output *output_new(const char *dir, GError **error)
{
    Output *o = g_new0(Output, 1);
    o->made = g_ptr_array_new_with_free_func(g_free);
    note(NULL, o);
    o->dir = g_strdup(dir);
    /* "a/" would have "a" as its parent and be made twice */
    for (gsize n = strlen(o->dir); n > 1 && o->dir[n - 1] == '/'; n--)
        o->dir[n - 1] = '\0';
    if (make_folder(o, o->dir, error)) {
        sweep_dead(o->dir);
        char *name = staging_name();
        o->staging = g_build_filename(o->dir, name, NULL);
        o->away = g_malloc(strlen(o->staging) + 2);
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
    if (o->staging && o->away) {
        /* Under another name, so that a writer that is still at work can't add to it. */
        stpcpy(stpcpy(o->away, o->staging), "-");
        if (rename(o->staging, o->away) == 0)
            remove_tree(AT_FDCWD, o->away);
        remove_tree(AT_FDCWD, o->staging);
    }
    for (guint i = o->made->len; i-- > 0 && !o->committed;)
        rmdir(o->made->pdata[i]); /* fails, as it should, when others have put something there */
}

void output_discard_all(void)
{
    for (gsize i = 0; i < G_N_ELEMENTS(opened); i++) {
        Output *o = atomic_load(&opened[i]);
        if (o)
            output_discard(o);
    }
}

void output_free(Output *o)
{
    if (!o)
        return;
    output_discard(o);
    note(o, NULL);
    g_ptr_array_unref(o->made);
    g_free(o->away);
    g_free(o->staging);
    g_free(o->dir);
    g_free(o);
}

const char *output_staging(const Output *o)
{
    return o->staging;
}

/* Paths below `relative`, relative to the staging folder: files into `files`, folders into `folders`. */
static gboolean list_tree(const Output *o, const char *relative, GPtrArray *files, GPtrArray *folders, GError **error)
{
    char *path = g_build_filename(o->staging, relative, NULL);
    GPtrArray *names = read_folder(path, error);
    gboolean good = names != NULL;
    for (guint i = 0; good && i < names->len; i++) {
        char *child = *relative ? g_build_filename(relative, names->pdata[i], NULL) : g_strdup(names->pdata[i]);
        char *full = g_build_filename(path, names->pdata[i], NULL);
        gboolean folder = g_file_test(full, G_FILE_TEST_IS_DIR);
        g_ptr_array_add(folder ? folders : files, child);
        good = !folder || list_tree(o, child, files, folders, error);
        g_free(full);
    }
    if (names)
        g_ptr_array_unref(names);
    g_free(path);
    return good;
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

/* ---- the old files make way, the new ones come in; or all is as before ---- */

typedef struct {
    char *from, *to, *aside; /* `from` NULL: only what is there goes */
    guint64 bytes;
    gboolean record, gone, came;
} Move;

static void clear_move(gpointer data)
{
    Move *m = data;
    g_free(m->from);
    g_free(m->to);
    g_free(m->aside);
}

static void add_move(const Output *o, GArray *moves, const char *from, const char *to)
{
    Move m = {.record = from && g_str_has_suffix(to, ".json")};
    m.from = from ? g_build_filename(o->staging, from, NULL) : NULL;
    m.to = g_build_filename(o->dir, to, NULL);
    m.aside = g_strdup_printf("%s/.%u.old", o->staging, moves->len);
    GStatBuf info;
    if (m.from && g_stat(m.from, &info) == 0)
        m.bytes = (guint64)info.st_size;
    g_array_append_val(moves, m);
}

/* NAME_000120.svg, NAME_000120_opacity.png */
static gboolean is_frame(const char *rest)
{
    return *rest == '_' && strspn(rest + 1, "0123456789") >= 6;
}

/* Files in a folder of the output that begin with NAME_ or NAME. and are not among `written`: counted; frames among them go, if `moves` is given. */
static gboolean old_files(const Output *o, const char *folder, const char *name, GHashTable *written, GArray *moves, guint *count,
                          GError **error)
{
    char *path = g_build_filename(o->dir, folder, NULL);
    GPtrArray *names = read_folder(path, error);
    guint n = 0;
    for (guint i = 0; names && i < names->len; i++) {
        const char *entry = names->pdata[i], *rest = entry + strlen(name);
        if (!g_str_has_prefix(entry, name) || (*rest != '_' && *rest != '.'))
            continue;
        char *relative = *folder ? g_build_filename(folder, entry, NULL) : g_strdup(entry);
        if (!g_hash_table_contains(written, relative)) {
            n++;
            if (moves && is_frame(rest))
                add_move(o, moves, NULL, relative);
        }
        g_free(relative);
    }
    gboolean good = names != NULL;
    if (names)
        g_ptr_array_unref(names);
    g_free(path);
    *count = n;
    return good;
}

/* NULL with an error. */
static GArray *plan_moves(Output *o, const char *name, const GPtrArray *files, const GPtrArray *folders, GError **error)
{
    guint frames;
    gboolean good = TRUE;
    GArray *moves = g_array_new(FALSE, FALSE, sizeof(Move));
    g_array_set_clear_func(moves, clear_move);
    GHashTable *written = g_hash_table_new(g_str_hash, g_str_equal);
    for (guint i = 0; i < files->len; i++) {
        g_hash_table_add(written, files->pdata[i]);
        add_move(o, moves, files->pdata[i], files->pdata[i]);
    }
    for (guint i = 0; good && i < folders->len; i++)
        good = old_files(o, folders->pdata[i], name, written, moves, &frames, error);
    good = good && old_files(o, "", name, written, NULL, &o->stale, error);
    g_hash_table_destroy(written);
    if (good)
        return moves;
    g_array_unref(moves);
    return NULL;
}

static gboolean make_way(Move *m)
{
    m->gone = rename(m->to, m->aside) == 0;
    return m->gone || errno == ENOENT;
}

static gboolean come_in(Move *m)
{
    m->came = !m->from || rename(m->from, m->to) == 0;
    return m->came;
}

/* The old record goes first and the new one comes last: where there is a record, all it tells of is there, wherever a kill strikes. Nothing is
 * allocated on the way. Returns the move that failed, with errno, or NULL. */
static Move *carry_out(Move *move, guint n)
{
    for (guint i = 0; i < n; i++)
        if (move[i].record && !make_way(&move[i]))
            return &move[i];
    for (guint i = 0; i < n; i++)
        if (!move[i].record && !(make_way(&move[i]) && come_in(&move[i])))
            return &move[i];
    for (guint i = 0; i < n; i++)
        if (move[i].record && !come_in(&move[i]))
            return &move[i];
    return NULL;
}

static void take_back(Move *move, guint n)
{
    for (int records = 1; records >= 0; records--)
        for (guint i = 0; i < n; i++)
            if (move[i].record == records && move[i].came && move[i].from)
                g_rename(move[i].to, move[i].from);
    for (int records = 0; records < 2; records++)
        for (guint i = 0; i < n; i++)
            if (move[i].record == records && move[i].gone)
                g_rename(move[i].aside, move[i].to);
}

static gboolean move_all(Output *o, const char *name, const GPtrArray *files, const GPtrArray *folders, GError **error)
{
    for (guint i = 0; i < folders->len; i++) {
        char *path = g_build_filename(o->dir, folders->pdata[i], NULL);
        gboolean good = make_folder(o, path, error);
        g_free(path);
        if (!good)
            return FALSE;
    }
    GArray *moves = plan_moves(o, name, files, folders, error);
    if (!moves)
        return FALSE;
    Move *move = (Move *)(void *)moves->data, *failed = carry_out(move, moves->len);
    o->committed = !failed;
    if (failed) {
        int code = errno;
        take_back(move, moves->len);
        errno = code;
        fail(error, "can't write", failed->to);
    }
    for (guint i = 0; i < moves->len; i++)
        o->bytes += move[i].bytes;
    o->files = files->len;
    g_array_unref(moves);
    return o->committed;
}

gboolean output_commit(Output *o, const char *name, GError **error)
{
    GPtrArray *files = g_ptr_array_new_with_free_func(g_free), *folders = g_ptr_array_new_with_free_func(g_free);
    gboolean good = list_tree(o, "", files, folders, error) && check_way(o, files, FALSE, error) && check_way(o, folders, TRUE, error) &&
                    move_all(o, name, files, folders, error);
    g_ptr_array_unref(files);
    g_ptr_array_unref(folders);
    return good;
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
