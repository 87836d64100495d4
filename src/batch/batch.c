/* Leaves side by side: each worker takes the next variant of this part that is not there yet, grows it with its share of the processors and moves it to its
 * place. What another run has in hand comes last, if it still isn't there then: that run may have been killed, on a machine we can't see. */
#include "batch/batch.h"

#include <gio/gio.h>
#include <glib/gstdio.h>
#include <string.h>

#include "batch/labels.h"
#include "batch/private.h"
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
    GArray *postponed; /* uint64_t, in hand of another run when their turn came */
    guint resumed;     /* how many of them were taken up again */
    unsigned running;
    bool stop;
    GError *error; /* of the machine, the first */
    BatchState state;
} Batch;

typedef struct {
    Batch *batch;
    double part; /* of the leaf at hand that is done */
} Worker;

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

uint64_t batch_bytes(const BatchDef *def, uint64_t index)
{
    SweepVariant v;
    sweep_variant(def->sweep, index, &v);
    char *relative = row_folder(def->sweep, &v), *folder = g_build_filename(def->out, relative, NULL);
    uint64_t bytes = batch_folder_bytes(folder);
    if (bytes == 0 && def->staging) {
        char *made = g_build_filename(def->staging, v.name, NULL);
        bytes = batch_folder_bytes(made);
        g_free(made);
    }
    g_free(relative);
    g_free(folder);
    sweep_variant_clear(&v);
    return bytes;
}

/* What became of it in an earlier run, if its parameters were the same and its files are still what they were. A data set is read by programs that show
 * nobody an emptied mask, so its files are read, too. */
static RowOutcome outcome_so_far(const Task *t)
{
    Row row;
    row_read(t->def->sweep, t->def->out, t->variant.index, &row);
    char *key = row.outcome == ROW_MISSING ? NULL : row_key(&row);
    RowOutcome outcome = key && strcmp(key, t->key) == 0 ? row.outcome : ROW_MISSING;
    if (outcome == ROW_GROWN && !row_is_whole(t->def->out, &row, t->def->labels))
        outcome = ROW_MISSING;
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

/* The row comes last; when the disk has it all the folder moves. */
static gboolean finish(const VenLeaf *leaf, const Task *t, GError **error)
{
    FolderSum sum;
    if (!batch_sum_folder(t->made, &sum, error))
        return FALSE;
    char *row = row_grown(t->def->sweep, &t->variant, t->key, leaf, &sum), *path = g_build_filename(t->made, "sweep.json", NULL);
    gboolean ok = batch_write_row(row, path, error) && batch_sync_folder(t->made, error);
    if (ok && outcome_so_far(t) == ROW_GROWN) /* another run was faster, and its leaf is the same */
        batch_remove(t->made);
    else
        ok = ok && batch_move_folder(t->made, t->folder, error);
    if (ok)
        g_unlink(t->failed); /* of other parameters, if there is one */
    g_free(row);
    g_free(path);
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

/* Grows and writes; FALSE with an error, and *reading tells whether it came while input was read. The folder is there from the beginning, so that other
 * runs see what is in hand. */
static gboolean grow(const Task *t, Worker *w, gboolean *reading, GError **error)
{
    VenParams params = {t->params};
    VenOptions how = {.threads = w->batch->leaf_threads, .progress = on_step, .user = w};
    *reading = FALSE;
    if (!batch_make_folder(t->made, error))
        return FALSE;
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
    char *row = row_failure(t->def->sweep, &t->variant, t->key, failure);
    gboolean ok = batch_write_row(row, t->failed, error);
    if (ok)
        batch_remove(t->folder);
    g_free(row);
    return ok;
}

/* What became of a variant in this run. */
typedef struct {
    RowOutcome outcome;
    bool found;     /* it was there */
    bool postponed; /* another run has it in hand */
} Made;

/* Makes what is missing of one variant; `again`: even if another run has it in hand. TRUE unless the machine failed, or the run was stopped. */
static gboolean make(Worker *w, uint64_t index, bool again, Made *out, GError **error)
{
    Task t;
    GError *failure = NULL;
    gboolean reading = TRUE, ok = TRUE, begun = task_begin(&t, w->batch, index, &failure);
    *out = (Made){.outcome = outcome_so_far(&t)};
    out->found = out->outcome != ROW_MISSING;
    out->postponed = !out->found && !again && batch_in_hand(t.def, t.variant.name);
    if (out->found || out->postponed) {
        g_clear_error(&failure);
    } else if (begun && grow(&t, w, &reading, &failure)) {
        out->outcome = ROW_GROWN;
    } else {
        batch_remove(t.made);
        batch_name_plainly(failure, t.made, t.folder);
        out->outcome = ROW_FAILED;
        ok = fault_is_input(failure, reading) && keep_failure(&t, failure, error);
        if (!ok && !(error && *error))
            g_propagate_error(error, g_steal_pointer(&failure));
        g_clear_error(&failure);
    }
    task_clear(&t);
    return ok;
}

/* ---- all of them ---- */

static bool take_next(Batch *b, uint64_t *index, bool *again)
{
    bool first = b->next < sweep_count(b->def->sweep);
    *again = !first && b->resumed < b->postponed->len;
    if (b->stop || !(first || *again))
        return false;
    if (first) {
        *index = b->next;
        b->next += b->def->shards;
    } else {
        *index = g_array_index(b->postponed, uint64_t, b->resumed++);
    }
    b->state.growing++;
    return true;
}

static void note(Batch *b, Worker *w, gboolean ok, uint64_t index, const Made *made, GError *error)
{
    b->state.growing--;
    b->state.part -= w->part;
    w->part = 0.0;
    if (ok && made->postponed) {
        g_array_append_val(b->postponed, index);
        return;
    }
    if (ok) {
        b->state.found += made->found && made->outcome == ROW_GROWN;
        b->state.grown += !made->found && made->outcome == ROW_GROWN;
        b->state.failed += made->outcome == ROW_FAILED;
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
    bool again;
    g_mutex_lock(&b->lock);
    while (take_next(b, &index, &again)) {
        Made made;
        GError *error = NULL;
        g_mutex_unlock(&b->lock);
        gboolean ok = make(&w, index, again, &made, &error);
        g_mutex_lock(&b->lock);
        note(b, &w, ok, index, &made, error);
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
    Batch b = {.def = def, .keys = keys_new(def), .next = def->shard, .state.total = mine, .postponed = g_array_new(FALSE, FALSE, sizeof(uint64_t))};
    b.workers = (unsigned)MIN((uint64_t)threads, MAX(mine, 1));
    b.leaf_threads = MAX(threads / b.workers, 1);
    b.running = b.workers;
    g_mutex_init(&b.lock);
    g_cond_init(&b.ended);
    char *failures = g_build_filename(def->out, "failed", NULL);
    GThread **thread = g_new(GThread *, b.workers);
    for (unsigned i = 0; i < b.workers; i++)
        thread[i] = g_thread_new("leaf", work, &b);
    g_mutex_lock(&b.lock);
    watch(&b, tick, user);
    g_mutex_unlock(&b.lock);
    for (unsigned i = 0; i < b.workers; i++)
        g_thread_join(thread[i]);
    g_free(thread);
    g_rmdir(failures); /* if it is empty */
    g_free(failures);
    g_mutex_clear(&b.lock);
    g_cond_clear(&b.ended);
    keys_free(b.keys);
    g_array_free(b.postponed, TRUE);
    *end = b.state;
    if (b.stop && !b.error)
        g_set_error(&b.error, G_IO_ERROR, G_IO_ERROR_CANCELLED, "stopped");
    if (b.error)
        g_propagate_error(error, b.error);
    return !b.stop;
}
