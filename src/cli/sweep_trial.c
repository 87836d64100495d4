#include "cli/sweep_trial.h"

#include <math.h>
#include <stdio.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "batch/rows.h"
#include "cli/cli.h"
#include "cli/interrupt.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/run.h"

enum { TRIAL_SECONDS = 20, MOST_SHOWN = 20 };

char *sweep_duration(double seconds)
{
    if (seconds < 99.5)
        return g_strdup_printf("%.0f s", MAX(seconds, 1.0));
    return seconds < 5970.0 ? g_strdup_printf("%.0f min", seconds / 60.0) : g_strdup_printf("%.1f h", seconds / 3600.0);
}

static uint64_t variants(const BatchDef *def)
{
    uint64_t count = sweep_count(def->sweep);
    return def->shard < count ? (count - def->shard - 1) / def->shards + 1 : 0;
}

/* ---- the list ---- */

/* Cuts a line of more than `room` characters; 0: none. */
static void cut_line(GString *s, glong room)
{
    if (room <= 0 || g_utf8_strlen(s->str, -1) <= room)
        return;
    g_string_truncate(s, (gsize)(g_utf8_offset_to_pointer(s->str, room - 1) - s->str));
    g_string_append(s, "…");
}

/* Columns of the terminal that the list goes to; 0: it is none, or doesn't say. */
static glong columns(void)
{
    struct winsize size;
    return isatty(STDOUT_FILENO) && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col >= 20 ? size.ws_col : 0;
}

static gboolean list_one(const Sweep *s, uint64_t index, int digits, glong room)
{
    SweepVariant v;
    sweep_variant(s, index, &v);
    GString *text = g_string_new(NULL);
    g_string_append_printf(text, "%*" G_GUINT64_FORMAT "  %s ", digits, index, v.name);
    for (uint32_t k = 0; k < v.n; k++)
        if (sweep_key(s, k).varies)
            g_string_append_printf(text, " %s=%s", sweep_key(s, k).key, v.value[k] ? v.value[k] : "(parameter file's)");
    cut_line(text, room);
    g_string_append_c(text, '\n');
    gboolean ok = cli_print(text->str) == 0;
    g_string_free(text, TRUE);
    sweep_variant_clear(&v);
    return ok;
}

static gboolean list(const BatchDef *def, uint64_t most)
{
    uint64_t mine = variants(def);
    glong room = columns();
    int digits = 1;
    for (uint64_t n = sweep_count(def->sweep) - 1; n >= 10; n /= 10)
        digits++;
    for (uint64_t i = 0; i < MIN(mine, most); i++)
        if (!list_one(def->sweep, def->shard + i * def->shards, digits, room))
            return FALSE;
    if (mine <= most)
        return TRUE;
    char *rest = g_strdup_printf("… and %" G_GUINT64_FORMAT " more; in a pipe or file all are listed, in full\n", mine - most);
    gboolean ok = cli_print(rest) == 0;
    g_free(rest);
    return ok;
}

/* ---- the estimate ---- */

typedef struct {
    Output *output; /* whose hidden folder all is in */
    Interrupt *interrupt;
    Progress *progress;
    const BatchDef *def; /* of the trial */
    gint64 limit;        /* monotonic time, µs */
    double part;         /* of its growth that was done */
    uint64_t bytes;      /* written */
    char *facts;
} Trial;

static void abandon(gpointer user)
{
    Trial *t = user;
    if (t->output)
        output_discard(t->output);
}

static gboolean on_tick(const BatchState *now, gpointer user)
{
    Trial *t = user;
    progress_part(t->progress, now->part, t->facts);
    uint64_t bytes = batch_bytes(t->def, t->def->shard);
    t->part = MAX(t->part, now->part); /* both fall when it is stopped */
    t->bytes = MAX(t->bytes, bytes);
    return interrupt_signal(t->interrupt) == 0 && g_get_monotonic_time() < t->limit;
}

static unsigned workers_of(const BatchDef *def) { return (unsigned)MIN(variants(def), def->threads ? def->threads : g_get_num_processors()); }

static void tell(const BatchDef *def, uint64_t chosen, double seconds, uint64_t bytes)
{
    uint64_t mine = variants(def);
    unsigned workers = workers_of(def);
    char *size = g_format_size(bytes), *all = g_format_size(bytes * mine), *each = sweep_duration(seconds), *whole = sweep_duration(seconds * (double)mine / workers);
    fprintf(stderr, "%" G_GUINT64_FORMAT " variant%s of about %s and %s each (as number %" G_GUINT64_FORMAT ", grown for a trial): %s, %s on %u thread%s\n", mine, cli_s(mine),
            size, each, chosen, all, whole, workers, cli_s(workers));
    g_free(each);
    g_free(whole);
    g_free(size);
    g_free(all);
}

/* What is known of a leaf that is not done when time is up: that all take more than it has taken. */
static void tell_least(const BatchDef *def, const Trial *t, uint64_t chosen)
{
    uint64_t mine = variants(def);
    unsigned workers = workers_of(def);
    char *whole = sweep_duration((double)TRIAL_SECONDS * (double)mine / workers), *size = g_format_size(t->bytes * mine);
    char *state = t->part < 1.0 ? g_strdup_printf("%.0f %% of it grown by then", floor(100.0 * t->part)) : g_strdup("grown by then, not yet written");
    fprintf(stderr, "%" G_GUINT64_FORMAT " variant%s; number %" G_GUINT64_FORMAT ", grown for a trial, takes longer than %d s (%s): more than %s%s%s on %u thread%s\n", mine,
            cli_s(mine), chosen, TRIAL_SECONDS, state, t->bytes ? size : "", t->bytes ? " and " : "", whole, workers, cli_s(workers));
    g_free(state);
    g_free(whole);
    g_free(size);
}

/* As the run would tell it. */
static int tell_failure(const BatchDef *def, const char *out, uint64_t index)
{
    uint64_t mine = variants(def);
    Row row;
    row_read(def->sweep, out, index, &row);
    fprintf(stderr, "%" G_GUINT64_FORMAT " variant%s; number %" G_GUINT64_FORMAT ", grown for a trial, failed\n", mine, cli_s(mine), index);
    int status = cli_fail(EXIT_BAD_INPUT, "%s: %s", row.variant.name, row.error ? row.error : "");
    row_clear(&row);
    return status;
}

/* Grows the variant in the middle. */
static int try_one(const BatchDef *def, Trial *t)
{
    GError *error = NULL;
    uint64_t mine = variants(def), middle = def->shard + mine / 2 * def->shards;
    t->output = output_new(g_get_tmp_dir(), &error);
    if (!t->output)
        return run_report(error, FALSE);
    t->facts = g_strdup_printf("  growing number %" G_GUINT64_FORMAT " for a trial", middle);
    char *out = g_build_filename(output_staging(t->output), "out", NULL), *staging = g_build_filename(output_staging(t->output), "new", NULL);
    BatchDef one = *def;
    one.out = out;
    one.staging = staging;
    one.threads = 1;
    one.shard = (uint32_t)middle;
    one.shards = (uint32_t)sweep_count(def->sweep);
    BatchState end;
    gint64 begun = g_get_monotonic_time();
    t->limit = begun + TRIAL_SECONDS * G_USEC_PER_SEC;
    t->def = &one;
    interrupt_polite(t->interrupt);
    gboolean good = batch_run(&one, on_tick, t, &end, &error);
    double seconds = (double)(g_get_monotonic_time() - begun) / G_USEC_PER_SEC;
    interrupt_hold(t->interrupt);
    progress_clear(t->progress);
    int came = interrupt_signal(t->interrupt), status = 0;
    if (came)
        status = EXIT_SIGNAL + came;
    else if (good && end.grown)
        tell(def, middle, seconds, batch_bytes(&one, middle));
    else if (good)
        status = tell_failure(def, out, middle);
    else if (g_error_matches(error, G_IO_ERROR, G_IO_ERROR_CANCELLED))
        tell_least(def, t, middle);
    else
        status = run_report(g_steal_pointer(&error), FALSE);
    g_clear_error(&error);
    g_free(out);
    g_free(staging);
    return status;
}

static int estimate(const BatchDef *def)
{
    if (!variants(def)) {
        fputs("no variant is in this part\n", stderr);
        return 0;
    }
    Trial t = {0};
    t.interrupt = interrupt_new(abandon, &t);
    interrupt_hold(t.interrupt);
    t.progress = progress_new("dry run");
    int status = try_one(def, &t);
    output_free(t.output);
    progress_free(t.progress);
    interrupt_free(t.interrupt);
    g_free(t.facts);
    return status;
}

int sweep_trial(const BatchDef *def, gboolean quiet)
{
    gboolean shown = isatty(STDOUT_FILENO);
    int status = shown || quiet ? 0 : estimate(def);
    if ((status == 0 || status == EXIT_BAD_INPUT) && !list(def, shown ? MOST_SHOWN : G_MAXUINT64))
        status = EXIT_FAILED;
    return status == 0 && shown && !quiet ? estimate(def) : status;
}
