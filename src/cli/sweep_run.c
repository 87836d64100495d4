/* The run of a sweep: leaves are grown, then collected. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "batch/dataset.h"
#include "batch/page.h"
#include "batch/sheet.h"
#include "cli/sweep_private.h"
#include "cli/sweep_trial.h"

static void abandon(gpointer user)
{
    Sweeping *w = user;
    if (w->output)
        output_discard(w->output);
    static const char text[] = "\nvenation: stopped; what is finished stays, and the same command goes on from there\n"; /* below the progress bar */
    const char *from = w->progress ? text : text + 1;
    if (!w->args->quiet && write(STDERR_FILENO, from, strlen(from)) < 0)
        return; /* there is nobody to tell */
}

static gboolean on_tick(const BatchState *now, gpointer user)
{
    Sweeping *w = user;
    uint64_t over = now->found + now->grown + now->failed;
    double work = (double)now->grown + now->part, left = (double)(now->total - over) - now->part;
    double seconds = (double)(g_get_monotonic_time() - w->begun) / G_USEC_PER_SEC;
    GString *facts = g_string_new(NULL);
    g_string_append_printf(facts, "  %" G_GUINT64_FORMAT " of %" G_GUINT64_FORMAT, over, now->total);
    if (now->failed)
        g_string_append_printf(facts, ", %" G_GUINT64_FORMAT " failed", now->failed);
    if (work > 0.1 && seconds > 2.0) {
        char *time = sweep_duration(seconds / work * left);
        g_string_append_printf(facts, ", about %s left", time);
        g_free(time);
    }
    progress_part(w->progress, ((double)over + now->part) / (double)now->total, facts->str);
    g_string_free(facts, TRUE);
    return interrupt_signal(w->interrupt) == 0;
}

static gboolean on_collect(double part, gpointer user)
{
    Sweeping *w = user;
    progress_part(w->progress, part, w->phase);
    return interrupt_signal(w->interrupt) == 0;
}

/* What ended the work too early: a signal, or the error, which is taken. Returns the exit status. */
static int tell_end(const Sweeping *w, GError *error, const char *state)
{
    progress_clear(w->progress);
    if (!interrupt_signal(w->interrupt))
        return run_report(error, FALSE);
    g_clear_error(&error);
    if (!w->args->quiet)
        cli_fail(0, "stopped; %s, and the same command goes on from there", state);
    return EXIT_SIGNAL + interrupt_signal(w->interrupt);
}

static int grow_all(Sweeping *w, BatchState *end)
{
    GError *error = NULL;
    interrupt_polite(w->interrupt);
    gboolean good = batch_run(&w->def, on_tick, w, end, &error);
    interrupt_hold(w->interrupt);
    if (good)
        return 0;
    char *state = g_strdup_printf("%" G_GUINT64_FORMAT " of %" G_GUINT64_FORMAT " are there", end->found + end->grown + end->failed, end->total);
    int status = tell_end(w, error, state);
    g_free(state);
    return status;
}

/* A signal stops it between two leaves; each file appears whole. */
static int collect(Sweeping *w, BatchCount *count)
{
    GError *error = NULL;
    const SheetDef sheet = {.cell = (uint32_t)w->cell, .specimen = w->def.specimen, .staging = w->def.staging, .watch = w->def.watch};
    const PageDef page = {.title = w->name, .specimen = w->def.specimen, .staging = w->def.staging, .watch = w->def.watch};
    w->phase = "  collecting: manifest";
    gboolean ok = manifest_write(&w->def, count, &error);
    w->phase = "  collecting: data set";
    ok = ok && (!w->args->dataset || dataset_write(&w->def, w->validation, &error));
    w->phase = "  collecting: sheet";
    ok = ok && (!w->cell || sheet_write(w->sweep, w->dir, &sheet, &error));
    w->phase = "  collecting: page";
    ok = ok && (!w->cell || page_write(w->sweep, w->params, w->dir, &page, &error));
    progress_clear(w->progress);
    if (ok)
        return 0;
    batch_name_plainly(error, w->def.staging, w->dir);
    return tell_end(w, error, "it was collecting");
}

/* Nothing is collected by other options than it was grown with, and no finished leaf is lost by them. */
static int check_settings(Sweeping *w)
{
    BatchCount count;
    GError *error = NULL;
    gboolean collects = w->args->collect;
    if (!collects && w->args->replace)
        return 0;
    w->phase = collects ? "  collecting: checking" : "  checking what is there";
    if (!batch_count(&w->def, !collects ? BATCH_ROWS : w->args->dataset ? BATCH_CONTENTS : BATCH_SIZES, &count, &error))
        return tell_end(w, error, collects ? "it was collecting" : "it was checking what is there");
    progress_clear(w->progress);
    if (count.stale)
        return sweeping_tell_stale(w, &count, collects ? "collect with those they were grown with, or grow them anew (--replace)" : "choose another -o, or --replace to grow them anew");
    return collects && count.damaged ? sweeping_tell_damaged(w, &count) : 0;
}

/* Nobody else is at work there who would take our leaves away, or we theirs. */
static int claim(Sweeping *w)
{
    char *other;
    GError *error = NULL;
    w->phase = "  waiting for another run";
    if (batch_claim(&w->def, &other, &error))
        return 0;
    if (!other)
        return tell_end(w, error, "nothing was grown");
    progress_clear(w->progress);
    int status = cli_fail(EXIT_BAD_INPUT, "%s: another run with other parameters, options or variants is at work there (%s): choose another -o, or wait; if it was killed on another "
                          "machine, remove that folder", w->dir, other);
    g_free(other);
    return status;
}

int sweeping_run(Sweeping *w)
{
    GError *error = NULL;
    BatchState end = {0};
    BatchCount count = {0};
    w->interrupt = interrupt_new(abandon, w);
    interrupt_hold(w->interrupt);
    w->output = output_new(w->dir, &error);
    if (!w->output)
        return run_report(error, FALSE);
    w->def.staging = output_staging(w->output);
    w->def.watch = (Watch){on_collect, w};
    w->progress = w->args->quiet ? NULL : progress_new(w->name);
    int status = w->args->collect ? 0 : claim(w);
    if (status == 0)
        status = check_settings(w);
    if (status == 0 && !w->args->collect)
        status = grow_all(w, &end);
    if (status == 0 && !w->args->shard)
        status = collect(w, &count);
    progress_clear(w->progress);
    if (status != 0)
        return status;
    uint64_t failed = w->args->shard ? end.failed : count.failed;
    sweeping_summarise(w, w->args->collect ? NULL : &end, failed, count.missing);
    return failed || count.missing ? EXIT_BAD_INPUT : 0;
}
