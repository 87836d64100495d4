/* What the files of the verb sweep share. */
#ifndef CLI_SWEEP_PRIVATE_H
#define CLI_SWEEP_PRIVATE_H

#include "batch/batch.h"
#include "cli/run.h"
#include "sweep/sweep.h"

typedef struct {
    CommonArgs common;
    gboolean quiet, dry_run, collect, dataset, replace;
    char *dir, *threads, *size, *maps, *write, *shard, *cell, *picture, *validation;
    char **set;
} SweepArgs;

typedef struct {
    const Verb *verb;
    const SweepArgs *args;
    char *name, *dir;
    guint64 shard, shards, threads, cell;
    double validation;
    Sweep *sweep;
    Params *params;
    Output *output;
    Interrupt *interrupt;
    Progress *progress;
    BatchDef def;
    const char *phase; /* of collecting, as it is told */
    gint64 begun;
} Sweeping;

extern const GOptionEntry sweep_options[]; /* arg_data: offset into SweepArgs */

/* Reads the sweep file and what the options set over it (sweep_setup.c). */
gboolean sweeping_read(Sweeping *w, GError **error);

/* Grows what is missing and collects it (sweep_run.c); what it tells of that (sweep_tell.c). Each returns the exit status, but for the summary. */
int sweeping_run(Sweeping *w);
int sweeping_tell_stale(const Sweeping *w, const BatchCount *count, const char *advice);
int sweeping_tell_damaged(const Sweeping *w, const BatchCount *count);

/* `end`: of what was grown now; NULL: nothing. */
void sweeping_summarise(const Sweeping *w, const BatchState *end, uint64_t failed, uint64_t missing);

#endif
