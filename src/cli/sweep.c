/* venation sweep: many leaves from one file. */
#include <glib/gstdio.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "batch/batch.h"
#include "batch/dataset.h"
#include "batch/page.h"
#include "batch/sheet.h"
#include "cli/run.h"
#include "cli/sweep_trial.h"
#include "lib/leaf.h"

enum { MOST_THREADS = 1024, MOST_SHARDS = 1000000, MOST_CELL = 2048, MOST_TOLD = 3 };

typedef struct {
    CommonArgs common;
    gboolean quiet, dry_run, collect, dataset, replace;
    char *dir, *threads, *size, *maps, *write, *shard, *cell, *picture, *validation;
    char **set;
} SweepArgs;

#define FIELD(name) (gpointer) offsetof(SweepArgs, name)
static const GOptionEntry options[] = {
    {"output", 'o', 0, G_OPTION_ARG_FILENAME, FIELD(dir), "Folder to write to (default: out/NAME)", "DIR"},
    {"write", 0, 0, G_OPTION_ARG_FILENAME, FIELD(write),
     "What each leaf leaves: none, or out of maps svg network mesh, with commas or spaces between them (default: what the parameters ask for, no mesh)", "KINDS"},
    {"maps", 0, 0, G_OPTION_ARG_FILENAME, FIELD(maps), "Maps to paint, as --set texture.maps", "LIST"},
    {"size", 0, 0, G_OPTION_ARG_FILENAME, FIELD(size), "Longer side of the maps in pixels, as --set texture.size=PX", "PX"},
    {"set", 0, 0, G_OPTION_ARG_FILENAME_ARRAY, FIELD(set), "Set a parameter of all variants, over the parameter file's value", "section.key=value"},
    {"dataset", 0, 0, G_OPTION_ARG_NONE, FIELD(dataset),
     "Write training data: images as a scanner sees the leaves, masks of blade, veins, orders and areoles, and COCO annotations, in DIR/dataset", NULL},
    {"validation", 0, 0, G_OPTION_ARG_FILENAME, FIELD(validation), "Part of the data set that is for validation, chosen by seed (default: 0.2)", "PART"},
    {"shard", 0, 0, G_OPTION_ARG_FILENAME, FIELD(shard), "Grow the I-th of N parts only, I from 1; --collect ends the work", "I/N"},
    {"collect", 0, 0, G_OPTION_ARG_NONE, FIELD(collect), "Grow nothing: write manifest, sheet and page of what is there", NULL},
    {"replace", 0, 0, G_OPTION_ARG_NONE, FIELD(replace), "Grow leaves anew that are in DIR and of other parameters or options; without it such a folder is refused", NULL},
    {"dry-run", 0, 0, G_OPTION_ARG_NONE, FIELD(dry_run), "List the variants (on a terminal, the first), and estimate size and time by growing one of them for a trial", NULL},
    {"cell", 0, 0, G_OPTION_ARG_FILENAME, FIELD(cell), "Pixels of a leaf on the contact sheet (default: 320; 0: no pictures, sheet and page)", "PX"},
    {"picture", 0, 0, G_OPTION_ARG_FILENAME, FIELD(picture), "What sheet and page show: veins, black on white (the default), or specimen, the leaf in its colours (the default of a data set)",
     "veins|specimen"},
    {"threads", 0, 0, G_OPTION_ARG_FILENAME, FIELD(threads), "Threads to use (default: one a processor); the result is the same", "N"},
    {"quiet", 'q', 0, G_OPTION_ARG_NONE, FIELD(quiet), "Say nothing but errors", NULL},
    {0},
};

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

/* ---- arguments ---- */

static gboolean read_shard(Sweeping *w, const char *text)
{
    char **part = g_strsplit(text, "/", -1);
    gboolean good = g_strv_length(part) == 2 && cli_count_from(w->verb, "--shard", part[1], 1, MOST_SHARDS, &w->shards) &&
                    cli_count_from(w->verb, "--shard", part[0], 1, w->shards, &w->shard);
    if (g_strv_length(part) != 2)
        cli_usage(w->verb, "--shard %s: must be I/N, as 1/4 for the first of four parts", text);
    g_strfreev(part);
    return good;
}

static gboolean read_validation(Sweeping *w, const char *text)
{
    char *end;
    w->validation = g_ascii_strtod(text, &end);
    if (!*text || *end || !(w->validation >= 0.0 && w->validation <= 1.0)) {
        cli_usage(w->verb, "--validation %s: must be a number from 0 to 1", text);
        return FALSE;
    }
    return TRUE;
}

/* Options that say the same twice, or nothing. */
static gboolean check_choice(const Sweeping *w)
{
    const SweepArgs *a = w->args;
    const char *wrong = a->shard && a->collect                     ? "--collect comes after all shards; it goes without --shard"
                        : a->collect && a->dry_run                 ? "--collect grows nothing that --dry-run could tell of; it goes without"
                        : a->dataset && (a->write || a->maps)      ? "--dataset writes what a data set needs; it goes without --write and --maps"
                        : a->validation && !a->dataset             ? "--validation goes with --dataset"
                                                                   : NULL;
    if (wrong)
        cli_usage(w->verb, "%s", wrong);
    return !wrong;
}

static gboolean read_args(Sweeping *w, const Verb *verb, const SweepArgs *a)
{
    char **operands = a->common.operands;
    *w = (Sweeping){.verb = verb, .args = a, .shard = 1, .shards = 1, .cell = 320, .validation = 0.2, .begun = g_get_monotonic_time()};
    if (!operands || operands[1]) {
        cli_usage(verb, operands ? "%s: one file at a time" : "%s: a sweep file is missing", verb->name);
        return FALSE;
    }
    if (a->picture && strcmp(a->picture, "veins") != 0 && strcmp(a->picture, "specimen") != 0) {
        cli_usage(verb, "--picture %s: must be veins or specimen", a->picture);
        return FALSE;
    }
    if (!check_choice(w) || (a->validation && !read_validation(w, a->validation)) || (a->shard && !read_shard(w, a->shard)) || (a->threads && !cli_count(verb, "--threads", a->threads, MOST_THREADS, &w->threads)) ||
        (a->cell && !cli_count(verb, "--cell", a->cell, MOST_CELL, &w->cell)))
        return FALSE;
    if (w->cell && w->cell < 16) {
        cli_usage(verb, "--cell %s: must be 0, or 16 or more", a->cell);
        return FALSE;
    }
    char *base = g_path_get_basename(operands[0]), *dot = strrchr(base, '.');
    w->name = g_strndup(base, dot && dot != base ? (gsize)(dot - base) : strlen(base));
    w->dir = a->dir ? g_strdup(a->dir) : g_build_filename("out", w->name, NULL);
    g_free(base);
    return TRUE;
}

/* ---- what is grown ---- */

/* An option that the sweep would override says nothing. */
static gboolean check_free(const Sweeping *w, int id, const char *option, GError **error)
{
    for (uint32_t k = 0; k < sweep_keys(w->sweep); k++)
        if (sweep_key(w->sweep, k).id == id) {
            g_set_error(error, PARAM_ERROR, PARAM_ERROR_VALUE, "%s: %s gives %s its values", option, sweep_path(w->sweep), sweep_key(w->sweep, k).key);
            return FALSE;
        }
    return TRUE;
}

/* Size may vary from leaf to leaf of a data set; what is written may not. */
static gboolean put_dataset(Sweeping *w, GError **error)
{
    static const ParamId fixed[] = {PARAM_TEXTURE_MAPS, PARAM_TEXTURE_EXR, PARAM_TEXTURE_DEPTH, PARAM_EXPORT_SPECIMEN, PARAM_EXPORT_VEINS_IMAGE, PARAM_EXPORT_SVG,
                                    PARAM_EXPORT_NETWORK};
    for (gsize i = 0; i < G_N_ELEMENTS(fixed); i++)
        if (!check_free(w, fixed[i], "--dataset", error))
            return FALSE;
    return dataset_params(w->params, "--dataset", error) && dataset_check_place(w->dir, error);
}

static gboolean put(Sweeping *w, const char *option, const char *key, const char *value, GError **error)
{
    return check_free(w, param_find(key), option, error) && params_set(w->params, (ParamId)param_find(key), value, option, error);
}

/* --write: what is not in the list is off. */
static gboolean choose_writing(Sweeping *w, GError **error)
{
    static const char *const kind[] = {"maps", "svg", "network", "mesh", "none"};
    gboolean wanted[G_N_ELEMENTS(kind)] = {FALSE};
    char **word = g_strsplit_set(w->args->write, ", ", -1);
    const char *wrong = NULL;
    for (char **at = word; *at && !wrong; at++) {
        gsize k = 0;
        while (k < G_N_ELEMENTS(kind) && strcmp(kind[k], *at) != 0)
            k++;
        if (k < G_N_ELEMENTS(kind))
            wanted[k] = TRUE;
        else if (**at)
            wrong = *at;
    }
    gboolean ok = !wrong;
    if (wrong)
        g_set_error(error, PARAM_ERROR, PARAM_ERROR_VALUE, "--write %s: must be none, or names out of maps svg network mesh", wrong);
    g_strfreev(word);
    w->def.models = wanted[3];
    return ok && (wanted[0] || (put(w, "--write", "texture.maps", "none", error) && put(w, "--write", "export.veins_image", "no", error))) &&
           put(w, "--write", "export.svg", wanted[1] ? "yes" : "no", error) && put(w, "--write", "export.network", wanted[2] ? "yes" : "no", error);
}

/* What a sweep varies can't be one value for all. */
static gboolean check_set(const Sweeping *w, const char *assignment, GError **error)
{
    for (uint32_t k = 0; k < sweep_keys(w->sweep); k++) {
        SweepKey key = sweep_key(w->sweep, k);
        gsize n = strlen(key.key);
        const char *from = assignment + strspn(assignment, " \t");
        if (strncmp(from, key.key, n) == 0 && from[n + strspn(from + n, " \t")] == '=') {
            g_set_error(error, PARAM_ERROR, PARAM_ERROR_VALUE, "--set %s: %s gives %s its values", assignment, sweep_path(w->sweep), key.key);
            return FALSE;
        }
    }
    return TRUE;
}

static gboolean read_sweep(Sweeping *w, GError **error)
{
    const SweepArgs *a = w->args;
    w->sweep = sweep_load(a->common.operands[0], error);
    if (!w->sweep)
        return FALSE;
    w->params = params_copy(sweep_params(w->sweep));
    for (char **s = a->set; s && *s; s++)
        if (!check_set(w, *s, error) || !params_override(w->params, *s, error))
            return FALSE;
    if ((a->maps && !put(w, "--maps", "texture.maps", a->maps, error)) || (a->size && !put(w, "--size", "texture.size", a->size, error)) ||
        (a->write && !choose_writing(w, error)) || (a->dataset && !put_dataset(w, error)))
        return FALSE;
    w->def.labels = a->dataset;
    w->def.sweep = w->sweep;
    w->def.params = w->params;
    w->def.out = w->dir;
    w->def.threads = (unsigned)w->threads;
    w->def.shard = (uint32_t)(w->shard - 1);
    w->def.shards = (uint32_t)w->shards;
    w->def.picture = (uint32_t)w->cell;
    w->def.specimen = a->picture ? strcmp(a->picture, "specimen") == 0 : a->dataset;
    return TRUE;
}

/* ---- the run ---- */

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
    const PageDef page = {.title = w->name, .staging = w->def.staging, .watch = w->def.watch};
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

/* Why the first few failed; the rest is in the folder. */
static void tell_failures(const Sweeping *w)
{
    uint32_t told = 0;
    for (uint64_t i = w->def.shard; i < sweep_count(w->sweep) && told < MOST_TOLD; i += w->def.shards) {
        Row row;
        row_read(w->sweep, w->dir, i, &row);
        if (row.outcome == ROW_FAILED) {
            cli_fail(0, "%s: %s", row.variant.name, row.error);
            told++;
        }
        row_clear(&row);
    }
}

/* One line on what else is in the folder. */
static void tell_names(const Sweeping *w, BatchNames *n, const char *one, const char *more, const char *advice)
{
    if (n->count) {
        char *dir = g_filename_display_name(w->dir);
        GString *s = g_string_new(NULL);
        for (gsize i = 0; i < BATCH_TOLD && n->first[i]; i++)
            g_string_append_printf(s, "%s%s", i ? ", " : "", n->first[i]);
        fprintf(stderr, "%s: %" G_GUINT64_FORMAT " %s: %s%s%s\n", dir, n->count, n->count == 1 ? one : more, s->str, n->count > BATCH_TOLD ? " …" : "", advice);
        g_string_free(s, TRUE);
        g_free(dir);
    }
    batch_names_clear(n);
}

static void tell_others(const Sweeping *w)
{
    BatchNames names;
    batch_unnamed(&w->def, &names);
    tell_names(w, &names, "leaf is of no variant of this sweep, and kept", "leaves are of no variant of this sweep, and kept", "");
    batch_hidden(&w->def, &names);
    tell_names(w, &names, "hidden folder is of another run, at work or killed", "hidden folders are of other runs, at work or killed", "; remove what is of no run at work");
}

static void add_word(GString *s, const char *word)
{
    static const char plain[] = G_CSET_A_2_Z G_CSET_a_2_z G_CSET_DIGITS "_-+=./,:@%";
    char *quoted = *word && !word[strspn(word, plain)] ? g_strdup(word) : g_shell_quote(word);
    g_string_append_printf(s, " %s", quoted);
    g_free(quoted);
}

/* The command that ends the work of the shards: this one's options, but for those that leaves don't depend on. */
static char *collect_command(const Sweeping *w)
{
    GString *s = g_string_new("venation sweep");
    add_word(s, w->args->common.operands[0]);
    add_word(s, "-o");
    add_word(s, w->dir);
    for (const GOptionEntry *o = options; o->long_name; o++) {
        static const char *const left[] = {"output", "shard", "collect", "replace", "threads", "quiet", NULL};
        const void *at = (const char *)w->args + (gsize)o->arg_data;
        char *name = g_strconcat("--", o->long_name, NULL), *one[] = {NULL, NULL}, **values = one;
        if (o->arg == G_OPTION_ARG_FILENAME)
            one[0] = *(char *const *)at;
        else if (o->arg == G_OPTION_ARG_FILENAME_ARRAY)
            values = *(char **const *)at;
        gboolean wanted = !g_strv_contains(left, o->long_name);
        if (wanted && o->arg == G_OPTION_ARG_NONE && *(const gboolean *)at)
            add_word(s, name);
        for (; wanted && values && *values; values++) {
            add_word(s, name);
            add_word(s, *values);
        }
        g_free(name);
    }
    g_string_append(s, " --collect");
    return g_string_free(s, FALSE);
}

static void summarise(const Sweeping *w, const BatchState *end, uint64_t failed, uint64_t missing)
{
    GString *s = g_string_new(NULL);
    char *dir = g_filename_display_name(w->dir);
    if (failed)
        tell_failures(w);
    if (end)
        g_string_append_printf(s, "%" G_GUINT64_FORMAT " %s grown, %" G_GUINT64_FORMAT " were there", end->grown, end->grown == 1 ? "leaf" : "leaves", end->found);
    if (failed)
        g_string_append_printf(s, "%s%" G_GUINT64_FORMAT " failed (%s/failed)", s->len ? ", " : "", failed, dir);
    if (missing)
        g_string_append_printf(s, "%s%" G_GUINT64_FORMAT " missing", s->len ? ", " : "", missing);
    if (!w->args->quiet) {
        fprintf(stderr, "%s: %s%s%.1f s\n", w->name, s->str, s->len ? ", " : "", (double)(g_get_monotonic_time() - w->begun) / G_USEC_PER_SEC);
        char *command = collect_command(w);
        if (w->args->shard)
            fprintf(stderr, "%s: part %" G_GUINT64_FORMAT " of %" G_GUINT64_FORMAT "; after the last one: %s\n", dir, w->shard, w->shards, command);
        else
            fprintf(stderr, "%s: %s%smanifest.csv, manifest.jsonl, leaves\n", dir, w->args->dataset ? "dataset, " : "", w->cell ? "sheet.png, index.html, " : "");
        g_free(command);
        if (!w->args->shard)
            tell_others(w);
    }
    g_free(dir);
    g_string_free(s, TRUE);
}

/* Leaves that these parameters and options would not give. */
static int tell_stale(const Sweeping *w, const BatchCount *count, const char *advice)
{
    char *names = batch_differing(&w->def, count->first_stale);
    int status = cli_fail(EXIT_BAD_INPUT, "%s: %" G_GUINT64_FORMAT " of the leaves there are of other parameters or options (%s): %s", w->dir, count->stale,
                          *names ? names : "a file they name, --write, --cell, --picture, --dataset, or the version", advice);
    g_free(names);
    return status;
}

static int tell_damaged(const Sweeping *w, const BatchCount *count)
{
    Row row;
    row_read(w->sweep, w->dir, count->first_damaged, &row);
    int status = cli_fail(EXIT_BAD_INPUT, "%s: files of %" G_GUINT64_FORMAT " %s are not what they were when they were written, as those of %s: run the sweep again without --collect, "
                          "which grows what is damaged anew", w->dir, count->damaged, count->damaged == 1 ? "leaf" : "leaves", row.folder);
    row_clear(&row);
    return status;
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
        return tell_stale(w, &count, collects ? "collect with those they were grown with, or grow them anew (--replace)" : "choose another -o, or --replace to grow them anew");
    return collects && count.damaged ? tell_damaged(w, &count) : 0;
}

static int carry_out(Sweeping *w)
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
    int status = check_settings(w);
    if (status == 0 && !w->args->collect)
        status = grow_all(w, &end);
    if (status == 0 && !w->args->shard)
        status = collect(w, &count);
    progress_clear(w->progress);
    if (status != 0)
        return status;
    uint64_t failed = w->args->shard ? end.failed : count.failed;
    summarise(w, w->args->collect ? NULL : &end, failed, count.missing);
    return failed || count.missing ? EXIT_BAD_INPUT : 0;
}

static void clear(Sweeping *w)
{
    if (w->interrupt)
        interrupt_hold(w->interrupt);
    progress_free(w->progress);
    output_free(w->output);
    interrupt_free(w->interrupt);
    sweep_free(w->sweep);
    params_free(w->params);
    g_free(w->name);
    g_free(w->dir);
}

static int run_sweep(const Verb *verb, int argc, char **argv)
{
    SweepArgs args = {0};
    int status;
    if (cli_parse(verb, &args, argc, argv, &status)) {
        Sweeping w;
        GError *error = NULL;
        status = EXIT_USAGE;
        if (read_args(&w, verb, &args))
            status = !read_sweep(&w, &error) ? run_report(error, TRUE) : args.dry_run ? sweep_trial(&w.def, args.quiet) : carry_out(&w);
        clear(&w);
    }
    cli_clear(verb, &args);
    return status;
}

const Verb sweep_verb = {
    "sweep",
    "SWEEP",
    "Grow many leaves from one file, and show them on a sheet",
    "Grows every variant of a sweep file: a parameter file of which keys vary, by lists, ranges, chance or a table. Leaves are grown side by side on all processors. "
    "Each appears whole in its folder, DIR/leaves/NAME; those that can't be grown leave a word on why in DIR/failed. At the end there are manifest.csv and "
    "manifest.jsonl, with parameters, counts and hashes of all, sheet.png and sheet.svg, a picture of all leaves with what varies along its axes, and index.html, "
    "a page to browse them with. Captions of a sample tell three keys: those whose values differ most from leaf to leaf (numbers in relation to their size) and that the "
    "picture can show; in the order of the file.\n\n"
    "Stopped or killed at any time, the same command does what is missing. --shard I/N does one of N parts, on one machine or many that share the folder; "
    "--collect, with the same options, then writes manifest, sheet and page. Several runs on one folder at once do no harm: each leaves to the others what they have in hand. "
    "Leaves that are of no variant of the sweep file any more are kept, and told of. A folder with leaves of other parameters or options is refused, with status 3, "
    "unless --replace is given. A leaf whose files are not as many or as long as they were (with --dataset: not the same) is grown anew; --collect refuses it.\n\n"
    "'sha256' in the manifest is of a leaf's whole folder but sweep.json: ls | grep -vx sweep.json | LC_ALL=C sort | xargs sha256sum | sha256sum gives it there.\n\n"
    "The exit status is 0 when all leaves are there, 3 when some can't be grown or are missing (the others are there), 2 or 3 when the command or the file is wrong, 1 when the machine failed, "
    "as by a full disk, and 128 plus the signal when it was stopped.\n\n"
    "A sweep file has one section, [sweep]. 'params' is the parameter file that all variants begin with. 'mode' is grid (every combination, the last key changing fastest; "
    "the default), zip (the first values of all keys, then the second ones) or sample ('count' variants, drawn by chance). Every other line is a key of the parameter table "
    "as section.key, or 'seed', the run's ('each': another one for every variant), and its values:\n\n"
    "5; 10; 20: a list; with '|' where values may hold a ';'.\n\n"
    "from 1 to 10 by 3, from 1 to 2 in 5, from 1 to 16 in 5 log: ranges, by step or number, evenly spaced or each the same multiple of the one before.\n\n"
    "uniform(a, b), uniform(a, b, step), log-uniform(a, b), normal(mean, deviation), choice(a; b; c): by chance.\n\n"
    "'table' names a CSV file whose heading names keys; its rows are one more list. 'name' gives names of variants (mode zip, or a column). 'sample_seed' and 'sequence' "
    "(random, or halton: evenly spread) are for what is drawn. Paths are relative to the sweep file.\n\n"
    "With --dataset DIR/dataset holds images and label maps in folders train and val, and COCO annotations of lamina, areoles and veins. How images are taken is in section "
    "[specimen] of the parameters, which a sweep may vary.",
    options,
    run_sweep,
};
