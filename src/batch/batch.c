/* Leaves side by side: each worker takes the next variant of this part that is not there yet, grows it with its share of the processors and moves it to its
 * place. */
#include "batch/batch.h"

#include <errno.h>
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <string.h>

#include "batch/labels.h"
#include "batch/private.h"
#include "export/export.h"
#include "lib/fault.h"
#include "lib/picture.h"

enum { TICK = G_USEC_PER_SEC / 10 };

typedef struct {
    const BatchDef *def;
    Keys *keys;
    unsigned workers, leaf_threads;
    GMutex lock; /* over all below */
    GCond ended;
    uint64_t next;
    unsigned running;
    bool stop;
    GError *error; /* of the machine, the first */
    BatchState state;
} Batch;

typedef struct {
    Batch *batch;
    double part; /* of the leaf at hand that is done */
} Worker;

/* ---- files ---- */

static gboolean fail(GError **error, const char *what, const char *path)
{
    int code = errno;
    char *name = g_filename_display_name(path);
    g_set_error(error, G_FILE_ERROR, g_file_error_from_errno(code), "%s: %s: %s", name, what, g_strerror(code));
    g_free(name);
    return FALSE;
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

static gboolean make_parent(const char *path, GError **error)
{
    char *parent = g_path_get_dirname(path);
    gboolean ok = g_mkdir_with_parents(parent, 0777) == 0 || fail(error, "can't make the folder", parent);
    g_free(parent);
    return ok;
}

/* Gives the folder its name, at once. One that is there already is of other parameters and goes; unless another run has just finished the same variant, which is
 * as good as ours. */
static gboolean move_folder(const char *from, const char *to, GError **error)
{
    if (!make_parent(to, error))
        return FALSE;
    char *away = g_strconcat(from, ".old", NULL);
    gboolean ok = g_rename(from, to) == 0;
    if (!ok && (errno == ENOTEMPTY || errno == EEXIST) && g_rename(to, away) == 0) {
        ok = g_rename(from, to) == 0;
        batch_remove(away);
    }
    ok = ok || ((errno == ENOTEMPTY || errno == EEXIST) && g_file_test(to, G_FILE_TEST_IS_DIR)) || fail(error, "can't write", to);
    g_free(away);
    return ok;
}

static void measure(const char *folder, uint32_t *files, uint64_t *bytes)
{
    GDir *dir = g_dir_open(folder, 0, NULL);
    const char *name;
    while (dir && (name = g_dir_read_name(dir))) {
        char *path = g_build_filename(folder, name, NULL);
        GStatBuf info;
        if (g_stat(path, &info) == 0) {
            *files += 1;
            *bytes += (uint64_t)info.st_size;
        }
        g_free(path);
    }
    if (dir)
        g_dir_close(dir);
}

uint64_t batch_bytes(const BatchDef *def, uint64_t index)
{
    SweepVariant v;
    uint32_t files = 0;
    uint64_t bytes = 0;
    sweep_variant(def->sweep, index, &v);
    char *relative = row_folder(def->sweep, &v), *folder = g_build_filename(def->out, relative, NULL);
    measure(folder, &files, &bytes);
    g_free(relative);
    g_free(folder);
    sweep_variant_clear(&v);
    return bytes;
}

static gboolean write_row(const char *row, const char *folder, const char *name, GError **error)
{
    char *path = g_build_filename(folder, name, NULL), *line = g_strconcat(row, "\n", NULL);
    gboolean ok = export_text(line, strlen(line), path, error);
    g_free(line);
    g_free(path);
    return ok;
}

/* ---- one variant ---- */

typedef struct {
    const BatchDef *def;
    SweepVariant variant;
    Params *params;
    char *key;
    char *made; /* its folder while it is made */
    char *folder, *failed; /* where it goes */
} Task;

static bool task_begin(Task *t, Batch *b, uint64_t index, GError **error)
{
    *t = (Task){.def = b->def};
    sweep_variant(b->def->sweep, index, &t->variant);
    char *folder = row_folder(b->def->sweep, &t->variant), *failed = row_failed(&t->variant);
    t->folder = g_build_filename(b->def->out, folder, NULL);
    t->failed = g_build_filename(b->def->out, failed, NULL);
    t->made = b->def->staging ? g_build_filename(b->def->staging, t->variant.name, NULL) : NULL;
    t->params = batch_params(b->def, &t->variant, error);
    t->key = keys_of(b->keys, t->params ? t->params : b->def->params, t->variant.seed);
    g_free(folder);
    g_free(failed);
    return t->params != NULL;
}

static void task_clear(Task *t)
{
    sweep_variant_clear(&t->variant);
    params_free(t->params);
    g_free(t->key);
    g_free(t->made);
    g_free(t->folder);
    g_free(t->failed);
}

/* What became of it in an earlier run, if its parameters were the same. */
static RowOutcome outcome_so_far(const Task *t)
{
    Row row;
    row_read(t->def->sweep, t->def->out, t->variant.index, &row);
    char *key = row.outcome == ROW_MISSING ? NULL : row_key(&row);
    RowOutcome outcome = key && strcmp(key, t->key) == 0 ? row.outcome : ROW_MISSING;
    g_free(key);
    row_clear(&row);
    return outcome;
}

static gboolean shape(const VenLeaf *leaf, const Task *t, GError **error)
{
    VenShape *s = ven_shape(leaf, error);
    gboolean ok = s && ven_shape_write(s, t->made, t->variant.name, error);
    ven_shape_free(s);
    return ok;
}

static gboolean labels(const VenLeaf *leaf, const Task *t, GError **error)
{
    char *path = g_strdup_printf("%s/%s_labels.jsonl", t->made, t->variant.name);
    gboolean ok = labels_write(leaf, path, error);
    g_free(path);
    return ok;
}

static gboolean picture(const VenLeaf *leaf, const Task *t, GError **error)
{
    char *path = g_build_filename(t->made, "sweep.png", NULL);
    gboolean ok = leaf_picture(leaf, path, t->def->picture, t->def->specimen, error);
    g_free(path);
    return ok;
}

/* The row comes last, and then the folder moves. */
static gboolean finish(const VenLeaf *leaf, const Task *t, GError **error)
{
    uint32_t files = 0;
    uint64_t bytes = 0;
    measure(t->made, &files, &bytes);
    char *row = row_grown(t->def->sweep, &t->variant, t->key, leaf, files, bytes);
    gboolean ok = write_row(row, t->made, "sweep.json", error) && move_folder(t->made, t->folder, error);
    if (ok)
        g_unlink(t->failed); /* of other parameters, if there is one */
    g_free(row);
    return ok;
}

static gboolean write_leaf(const VenLeaf *leaf, const Task *t, GError **error)
{
    return ven_write(leaf, t->made, t->variant.name, error) && (!t->def->models || shape(leaf, t, error)) &&
           (!t->def->labels || labels(leaf, t, error)) && (!t->def->picture || picture(leaf, t, error)) && finish(leaf, t, error);
}

static gboolean on_step(const VenProgress *now, gpointer user)
{
    Worker *w = user;
    Batch *b = w->batch;
    g_mutex_lock(&b->lock);
    b->state.part += now->done - w->part;
    w->part = now->done;
    gboolean go_on = !b->stop;
    g_mutex_unlock(&b->lock);
    return go_on;
}

/* Grows and writes; FALSE with an error, and *reading tells whether it came while input was read. */
static gboolean grow(const Task *t, Worker *w, gboolean *reading, GError **error)
{
    VenParams params = {t->params};
    VenOptions how = {.threads = w->batch->leaf_threads, .progress = on_step, .user = w};
    *reading = TRUE;
    VenLeaf *leaf = ven_grow(&params, t->variant.seed, &how, error);
    if (!leaf)
        return FALSE;
    *reading = FALSE;
    gboolean ok = write_leaf(leaf, t, error);
    ven_leaf_free(leaf);
    return ok;
}

/* A variant that can't be: its row is kept apart, and a leaf of other parameters in its place goes. */
static gboolean keep_failure(const Task *t, const GError *failure, GError **error)
{
    char *row = row_failure(t->def->sweep, &t->variant, t->key, failure), *name = g_path_get_basename(t->failed), *dir = g_path_get_dirname(t->failed);
    gboolean ok = make_parent(t->failed, error) && write_row(row, dir, name, error);
    if (ok)
        batch_remove(t->folder);
    g_free(row);
    g_free(name);
    g_free(dir);
    return ok;
}

/* Errors name files in their places, not in the hidden folder. */
static void name_plainly(const Task *t, GError *error)
{
    char **parts = g_strsplit(error->message, t->made, -1);
    g_free(error->message);
    error->message = g_strjoinv(t->folder, parts);
    g_strfreev(parts);
}

/* Makes what is missing of one variant. TRUE unless the machine failed, or the run was stopped. */
static gboolean make(Worker *w, uint64_t index, RowOutcome *outcome, bool *found, GError **error)
{
    Task t;
    GError *failure = NULL;
    gboolean reading = TRUE, ok = TRUE, begun = task_begin(&t, w->batch, index, &failure);
    *outcome = outcome_so_far(&t);
    *found = *outcome != ROW_MISSING;
    if (*found) {
        g_clear_error(&failure);
    } else if (begun && grow(&t, w, &reading, &failure)) {
        *outcome = ROW_GROWN;
    } else {
        batch_remove(t.made);
        name_plainly(&t, failure);
        *outcome = ROW_FAILED;
        ok = fault_is_input(failure, reading) && keep_failure(&t, failure, error);
        if (!ok && !(error && *error))
            g_propagate_error(error, g_steal_pointer(&failure));
        g_clear_error(&failure);
    }
    task_clear(&t);
    return ok;
}

/* ---- all of them ---- */

static bool take_next(Batch *b, uint64_t *index)
{
    bool more = !b->stop && b->next < sweep_count(b->def->sweep);
    *index = b->next;
    if (more) {
        b->next += b->def->shards;
        b->state.growing++;
    }
    return more;
}

static void note(Batch *b, Worker *w, gboolean ok, RowOutcome outcome, bool found, GError *error)
{
    b->state.growing--;
    b->state.part -= w->part;
    w->part = 0.0;
    if (ok) {
        b->state.found += found && outcome == ROW_GROWN;
        b->state.grown += !found && outcome == ROW_GROWN;
        b->state.failed += outcome == ROW_FAILED;
        return;
    }
    b->stop = true;
    if (b->error)
        g_clear_error(&error);
    else
        b->error = error;
}

static gpointer work(gpointer user)
{
    Batch *b = user;
    Worker w = {.batch = b};
    uint64_t index;
    g_mutex_lock(&b->lock);
    while (take_next(b, &index)) {
        RowOutcome outcome;
        bool found;
        GError *error = NULL;
        g_mutex_unlock(&b->lock);
        gboolean ok = make(&w, index, &outcome, &found, &error);
        g_mutex_lock(&b->lock);
        note(b, &w, ok, outcome, found, error);
    }
    b->running--;
    g_cond_signal(&b->ended);
    g_mutex_unlock(&b->lock);
    return NULL;
}

/* Holds the lock but while it waits and tells. */
static void watch(Batch *b, gboolean (*tick)(const BatchState *state, gpointer user), gpointer user)
{
    while (b->running) {
        g_cond_wait_until(&b->ended, &b->lock, g_get_monotonic_time() + TICK);
        BatchState now = b->state;
        g_mutex_unlock(&b->lock);
        gboolean go_on = !tick || tick(&now, user);
        g_mutex_lock(&b->lock);
        b->stop |= !go_on;
    }
}

gboolean batch_run(const BatchDef *def, gboolean (*tick)(const BatchState *state, gpointer user), gpointer user, BatchState *end, GError **error)
{
    uint64_t count = sweep_count(def->sweep), mine = count > def->shard ? (count - def->shard - 1) / def->shards + 1 : 0;
    unsigned threads = def->threads ? def->threads : g_get_num_processors();
    Batch b = {.def = def, .keys = keys_new(def), .next = def->shard, .state.total = mine};
    b.workers = (unsigned)MIN((uint64_t)threads, MAX(mine, 1));
    b.leaf_threads = MAX(threads / b.workers, 1);
    b.running = b.workers;
    g_mutex_init(&b.lock);
    g_cond_init(&b.ended);
    GThread **thread = g_new(GThread *, b.workers);
    for (unsigned i = 0; i < b.workers; i++)
        thread[i] = g_thread_new("leaf", work, &b);
    g_mutex_lock(&b.lock);
    watch(&b, tick, user);
    g_mutex_unlock(&b.lock);
    for (unsigned i = 0; i < b.workers; i++)
        g_thread_join(thread[i]);
    g_free(thread);
    g_mutex_clear(&b.lock);
    g_cond_clear(&b.ended);
    keys_free(b.keys);
    *end = b.state;
    if (b.stop && !b.error)
        g_set_error(&b.error, G_IO_ERROR, G_IO_ERROR_CANCELLED, "stopped");
    if (b.error)
        g_propagate_error(error, b.error);
    return !b.stop;
}
