/* Runs of different parameters or options keep out of one folder, even if they begin at once. Each marks its hidden folder with what it would do, then looks at
 * those of the others, then marks it as settled: so of two at least one sees the other, and while neither is settled the one whose folder's name comes first
 * goes on. Runs of one kind, as the parts of an array, don't mind each other. On network file systems that show new folders late, two may miss each other. */
#include <glib/gstdio.h>
#include <string.h>

#include "batch/private.h"

#define CLAIM ".claim-" /* stays beside the other, so that whoever lists the folder sees one at least */
#define SETTLED ".settled-"

enum { PAUSE = 10000, MOST_PAUSES = 1000 }; /* µs; a run that was killed between its marks looks undecided for ever */

typedef enum { OTHER_NONE, OTHER_CLAIMS, OTHER_SETTLED } Other;

static char *claim_key(const BatchDef *def)
{
    Keys *keys = keys_new(def);
    char *key = keys_of(keys, def->params, 0), *sweep = sweep_checksum(def->sweep), *both = g_strconcat(key, sweep, NULL);
    char *sum = g_compute_checksum_for_string(G_CHECKSUM_SHA256, both, -1);
    sum[32] = '\0';
    g_free(key);
    g_free(sweep);
    g_free(both);
    keys_free(keys);
    return sum;
}

static gboolean mark(const BatchDef *def, const char *kind, const char *key, GError **error)
{
    char *name = g_strconcat(kind, key, NULL), *path = g_build_filename(def->staging, name, NULL);
    gboolean ok = batch_make_folder(path, error);
    g_free(name);
    g_free(path);
    return ok;
}

/* What a hidden folder says, if it is of another kind of run. */
static Other look(const BatchDef *def, const char *hidden, const char *key)
{
    char *path = g_build_filename(def->out, hidden, NULL);
    GDir *dir = g_dir_open(path, 0, NULL);
    const char *name;
    Other found = OTHER_NONE;
    while (dir && (name = g_dir_read_name(dir))) {
        if (g_str_has_prefix(name, SETTLED) && strcmp(name + strlen(SETTLED), key) != 0)
            found = OTHER_SETTLED;
        else if (g_str_has_prefix(name, CLAIM) && strcmp(name + strlen(CLAIM), key) != 0)
            found = MAX(found, OTHER_CLAIMS);
    }
    if (dir)
        g_dir_close(dir);
    g_free(path);
    return found;
}

/* The strongest of the others: one that is settled, or the first of those that claim. */
static Other look_around(const BatchDef *def, const char *key, char **first)
{
    GDir *dir = g_dir_open(def->out, 0, NULL);
    const char *name;
    Other most = OTHER_NONE;
    *first = NULL;
    while ((name = batch_next_hidden(def, dir))) {
        Other found = look(def, name, key);
        if (found > most || (found && found == most && strcmp(name, *first) < 0)) {
            g_free(*first);
            *first = g_strdup(name);
            most = found;
        }
    }
    if (dir)
        g_dir_close(dir);
    return most;
}

gboolean batch_claim(const BatchDef *def, char **other, GError **error)
{
    char *key = claim_key(def), *first = NULL;
    const char *slash = strrchr(def->staging, '/'), *own = slash ? slash + 1 : def->staging;
    gboolean ok = mark(def, CLAIM, key, error), refused = FALSE;
    Other found;
    *other = NULL;
    for (int i = 0; ok && !refused && (found = look_around(def, key, &first)) != OTHER_NONE; i++) {
        refused = found == OTHER_SETTLED || strcmp(first, own) < 0 || i == MOST_PAUSES;
        if (refused) {
            *other = first;
        } else {
            g_free(first);
            g_usleep(PAUSE);
            ok = watch_tick(&def->watch, 0.0, error);
        }
    }
    ok = ok && !refused && mark(def, SETTLED, key, error);
    g_free(key);
    return ok;
}
