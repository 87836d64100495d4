/* venation sweep: many leaves from one file. */
#include <string.h>

#include "cli/sweep_private.h"
#include "cli/sweep_trial.h"

enum { MOST_THREADS = 1024, MOST_SHARDS = 1000000, MOST_CELL = 2048 };

#define FIELD(name) (gpointer) offsetof(SweepArgs, name)
const GOptionEntry sweep_options[] = {
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
            status = !sweeping_read(&w, &error) ? run_report(error, TRUE) : args.dry_run ? sweep_trial(&w.def, args.quiet) : sweeping_run(&w);
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
    "--collect, with the same options, then writes manifest, sheet and page. Several runs on one folder at once do no harm: each leaves to the others what they have in hand; "
    "one with other parameters or options than those at work is refused, with status 3. "
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
    sweep_options,
    run_sweep,
};
