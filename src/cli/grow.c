/* venation grow: one leaf from one parameter file. */
#include <gio/gio.h>
#include <stdio.h>
#include <string.h>

#include "cli/cli.h"
#include "cli/interrupt.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "venation.h"

enum { MOST_THREADS = 1024 };

typedef struct {
    CommonArgs common;
    gboolean json, quiet;
    char *dir, *seed, *threads, *size, *every, *frames, *maps, *name;
    char **set;
} GrowArgs;

#define FIELD(name) (gpointer) offsetof(GrowArgs, name)
static const GOptionEntry options[] = {
    {"output", 'o', 0, G_OPTION_ARG_FILENAME, FIELD(dir), "Folder to write to (default: out/NAME)", "DIR"},
    {"seed", 0, 0, G_OPTION_ARG_FILENAME, FIELD(seed),
     "Seed of the chance in a run, decimal or 0x hexadecimal (default: 1)", "N"},
    {"set", 0, 0, G_OPTION_ARG_FILENAME_ARRAY, FIELD(set),
     "Set a parameter, over the file's value; may be given more than once", "section.key=value"},
    {"size", 0, 0, G_OPTION_ARG_FILENAME, FIELD(size), "Longer side of the maps in pixels, as --set texture.size=PX",
     "PX"},
    {"maps", 0, 0, G_OPTION_ARG_FILENAME, FIELD(maps),
     "Maps to paint: all, none, or names parted by commas, as --set texture.maps", "LIST"},
    {"every", 0, 0, G_OPTION_ARG_FILENAME, FIELD(every), "Write a frame of every K-th step into the folder frames",
     "K"},
    {"frames", 0, 0, G_OPTION_ARG_FILENAME, FIELD(frames), "What the frames are: drawings (the default) or maps",
     "svg|maps"},
    {"name", 0, 0, G_OPTION_ARG_FILENAME, FIELD(name),
     "What file names begin with (default: that of the parameter file)", "NAME"},
    {"threads", 0, 0, G_OPTION_ARG_FILENAME, FIELD(threads),
     "Threads to use (default: one a processor); the result is the same", "N"},
    {"json", 0, 0, G_OPTION_ARG_NONE, FIELD(json), "Print the run record to standard output", NULL},
    {"quiet", 'q', 0, G_OPTION_ARG_NONE, FIELD(quiet), "Say nothing but errors", NULL},
    {0},
};

/* One run, from reading to writing. */
typedef struct {
    const Verb *verb;
    const GrowArgs *args;
    const char *path; /* of the parameter file */
    char *name, *dir;
    guint64 seed, threads, every;
    gboolean frame_maps;
    VenParams *params;
    Output *output;
    Interrupt *interrupt;
    Progress *progress;
    VenLeaf *leaf;
    uint32_t steps;
    GError *frame_error;
} Run;

/* What a file name may begin with: no folder, nothing that a terminal or JSON would stumble over. */
static gboolean is_name(const char *name)
{
    if (!*name || *name == '.' || strchr(name, '/') || !g_utf8_validate(name, -1, NULL))
        return FALSE;
    for (const char *c = name; *c; c = g_utf8_next_char(c))
        if (g_unichar_iscntrl(g_utf8_get_char(c)))
            return FALSE;
    return TRUE;
}

static gboolean choose_name(Run *run)
{
    char *base = g_path_get_basename(run->path);
    if (g_str_has_suffix(base, ".ini"))
        base[strlen(base) - 4] = '\0';
    run->name = run->args->name ? g_strdup(run->args->name) : g_strdup(base);
    g_free(base);
    if (!is_name(run->name)) {
        cli_usage(run->verb, "%s: no name for files; give one with --name", run->name);
        return FALSE;
    }
    run->dir = run->args->dir ? g_strdup(run->args->dir) : g_build_filename("out", run->name, NULL);
    if (!*run->dir)
        cli_usage(run->verb, "--output: must be the path of a folder");
    return *run->dir != '\0';
}

/* What can be told from the command line alone; FALSE is a usage error, told. */
static gboolean read_args(Run *run)
{
    const GrowArgs *a = run->args;
    char **operands = a->common.operands;
    if (!operands || operands[1]) {
        cli_usage(run->verb, operands ? "grow: one parameter file at a time" : "grow: a parameter file is missing");
        return FALSE;
    }
    run->path = operands[0];
    run->seed = 1;
    for (char **s = a->set; s && *s; s++) {
        if (!strchr(*s, '=')) {
            cli_usage(run->verb, "--set %s: must be section.key=value", *s);
            return FALSE;
        }
    }
    if ((a->seed && !cli_count(run->verb, "--seed", a->seed, G_MAXUINT64, &run->seed)) ||
        (a->threads && !cli_count(run->verb, "--threads", a->threads, MOST_THREADS, &run->threads)) ||
        (a->every && !cli_count(run->verb, "--every", a->every, G_MAXUINT32, &run->every)))
        return FALSE;
    run->frame_maps = a->frames && strcmp(a->frames, "maps") == 0;
    if (a->frames && !run->frame_maps && strcmp(a->frames, "svg") != 0) {
        cli_usage(run->verb, "--frames %s: must be svg or maps", a->frames);
        return FALSE;
    }
    if (a->every && !run->every) {
        cli_usage(run->verb, "--every must be at least 1");
        return FALSE;
    }
    if (a->frames && !run->every) {
        cli_usage(run->verb, "--frames needs --every");
        return FALSE;
    }
    return choose_name(run);
}

/* "poplar" for params/poplar.ini is an easy slip. */
static char *nearby_file(const char *path)
{
    const char *suffix = g_str_has_suffix(path, ".ini") ? "" : ".ini";
    char *here = g_strconcat(path, suffix, NULL), *there = g_build_filename("params", here, NULL);
    char *found = *suffix && g_file_test(here, G_FILE_TEST_IS_REGULAR) ? g_strdup(here)
                  : g_file_test(there, G_FILE_TEST_IS_REGULAR)         ? g_strdup(there)
                                                                       : NULL;
    g_free(here);
    g_free(there);
    return found;
}

static gboolean set(Run *run, const char *key, const char *value, GError **error)
{
    return ven_params_set(run->params, key, value, error);
}

static gboolean read_params(Run *run, GError **error)
{
    run->params = ven_params_load(run->path, error);
    if (!run->params) {
        char *near = g_file_test(run->path, G_FILE_TEST_EXISTS) ? NULL : nearby_file(run->path);
        if (near && error && *error) {
            char *message = g_strdup_printf("%s; did you mean %s?", (*error)->message, near);
            g_free((*error)->message);
            (*error)->message = message;
        }
        g_free(near);
        return FALSE;
    }
    for (char **s = run->args->set; s && *s; s++) {
        const char *equals = strchr(*s, '=');
        char *key = g_strndup(*s, (gsize)(equals - *s));
        gboolean good = set(run, key, equals + 1, error);
        g_free(key);
        if (!good)
            return FALSE;
    }
    if (run->args->size && !set(run, "texture.size", run->args->size, error))
        return FALSE;
    if (!run->args->maps)
        return TRUE;
    char *maps = g_strdelimit(g_strdup(run->args->maps), ",", ' ');
    gboolean good = set(run, "texture.maps", maps, error);
    g_free(maps);
    return good;
}

/* Frames of maps when no map is wanted would be an empty folder. */
static gboolean frames_are_empty(const Run *run)
{
    char *maps = ven_params_get(run->params, "texture.maps");
    g_strstrip(maps);
    gboolean none = !*maps || g_str_equal(maps, "none");
    g_free(maps);
    return run->frame_maps && none;
}

/* Runs on the thread that waits for signals, when there is no time to wait for the run. */
static void abandon(gpointer user)
{
    Run *run = user;
    if (run->output)
        output_discard(run->output);
    if (run->progress)
        fputc('\n', stderr);
    if (!run->args->quiet)
        fputs("venation: stopped; nothing was written\n", stderr);
}

static gboolean on_step(const VenProgress *now, gpointer user)
{
    Run *run = user;
    run->steps = now->step;
    progress_update(run->progress, now);
    if (run->every && now->leaf &&
        !ven_write_frame(now->leaf, output_staging(run->output), run->name, run->frame_maps, &run->frame_error))
        return FALSE;
    return interrupt_signal(run->interrupt) == 0;
}

/* A file that ven_grow was told to read (an outline, sources) and that isn't there or is closed to us is bad input. */
static gboolean is_missing_file(const GError *error)
{
    static const GFileError file[] = {G_FILE_ERROR_NOENT, G_FILE_ERROR_ACCES,  G_FILE_ERROR_PERM,
                                      G_FILE_ERROR_ISDIR, G_FILE_ERROR_NOTDIR, G_FILE_ERROR_NAMETOOLONG,
                                      G_FILE_ERROR_LOOP};
    static const GIOErrorEnum io[] = {G_IO_ERROR_NOT_FOUND,         G_IO_ERROR_PERMISSION_DENIED,
                                      G_IO_ERROR_IS_DIRECTORY,      G_IO_ERROR_NOT_DIRECTORY,
                                      G_IO_ERROR_FILENAME_TOO_LONG, G_IO_ERROR_TOO_MANY_LINKS};
    for (gsize i = 0; i < G_N_ELEMENTS(file); i++)
        if (g_error_matches(error, G_FILE_ERROR, file[i]))
            return TRUE;
    for (gsize i = 0; i < G_N_ELEMENTS(io); i++)
        if (g_error_matches(error, G_IO_ERROR, io[i]))
            return TRUE;
    return FALSE;
}

/* Tells the error, takes it, and gives the exit status it stands for. */
static int report(GError *error, gboolean reading)
{
    gboolean system = error->domain == G_FILE_ERROR || error->domain == G_IO_ERROR;
    int status =
        cli_fail(system && !(reading && is_missing_file(error)) ? EXIT_FAILED : EXIT_BAD_INPUT, "%s", error->message);
    g_error_free(error);
    return status;
}

/* Names the output folder in an error's message, where writers saw the hidden one. */
static GError *with_plain_path(const Run *run, GError *error)
{
    char **parts = g_strsplit(error->message, output_staging(run->output), -1);
    g_free(error->message);
    error->message = g_strjoinv(run->dir, parts);
    g_strfreev(parts);
    return error;
}

static int grow(Run *run)
{
    GError *error = NULL;
    VenOptions how = {(unsigned)run->threads, (uint32_t)run->every, on_step, run};
    run->leaf = ven_grow(run->params, run->seed, &how, &error);
    if (run->leaf && !run->frame_error && !interrupt_signal(run->interrupt))
        return 0;
    int came = interrupt_signal(run->interrupt);
    interrupt_hold(run->interrupt);
    progress_clear(run->progress);
    if (run->frame_error) {
        g_clear_error(&error);
        return report(with_plain_path(run, g_steal_pointer(&run->frame_error)), FALSE);
    }
    if (error && !g_error_matches(error, G_IO_ERROR, G_IO_ERROR_CANCELLED))
        return report(error, TRUE);
    g_clear_error(&error);
    if (!run->args->quiet)
        cli_fail(0, "stopped at step %u; nothing was written", run->steps);
    return EXIT_SIGNAL + came;
}

static int write_leaf(Run *run)
{
    GError *error = NULL;
    progress_say(run->progress, ": writing");
    interrupt_urgent(run->interrupt);
    gboolean good = ven_write(run->leaf, output_staging(run->output), run->name, &error);
    interrupt_hold(run->interrupt);
    good = good && output_commit(run->output, &error);
    progress_clear(run->progress);
    return good ? 0 : report(with_plain_path(run, error), FALSE);
}

static void summarise(const Run *run, gint64 begun)
{
    char *title = ven_params_get(run->params, "leaf.title");
    char *dir = g_filename_display_name(run->dir);
    double seconds = (double)(g_get_monotonic_time() - begun) / G_USEC_PER_SEC;
    fprintf(stderr, "%s: %u nodes and %u edges in %u steps, seed %" G_GUINT64_FORMAT ", %.1f s\n",
            title && *title ? title : run->name, ven_leaf_nodes(run->leaf), ven_leaf_edges(run->leaf), run->steps,
            run->seed, seconds);
    fprintf(stderr, "%s: %u files, %.1f MB\n", dir, output_files(run->output),
            (double)output_bytes(run->output) * 1e-6);
    g_free(dir);
    g_free(title);
}

static int print_record(const Run *run)
{
    char *record = ven_leaf_record(run->leaf);
    char *text = g_strconcat(record, g_str_has_suffix(record, "\n") ? "" : "\n", NULL);
    int status = cli_print(text);
    g_free(text);
    g_free(record);
    return status;
}

static int carry_out(Run *run)
{
    GError *error = NULL;
    gint64 begun = g_get_monotonic_time();
    if (!read_params(run, &error))
        return report(error, TRUE);
    if (frames_are_empty(run)) {
        cli_usage(run->verb, "--frames maps needs a map: --maps is none");
        return EXIT_USAGE;
    }
    run->interrupt = interrupt_new(abandon, run);
    interrupt_hold(run->interrupt); /* until the folder is made */
    run->output = output_new(run->dir, &error);
    if (!run->output)
        return report(error, FALSE);
    run->progress = run->args->quiet ? NULL : progress_new(run->name);
    interrupt_polite(run->interrupt);
    int status = grow(run);
    if (status == 0)
        status = write_leaf(run);
    if (status == 0 && !run->args->quiet)
        summarise(run, begun);
    if (status == 0 && run->args->json)
        status = print_record(run);
    return status;
}

static void clear(Run *run)
{
    if (run->interrupt)
        interrupt_hold(run->interrupt);
    progress_free(run->progress);
    output_free(run->output);
    interrupt_free(run->interrupt);
    ven_leaf_free(run->leaf);
    ven_params_free(run->params);
    g_clear_error(&run->frame_error);
    g_free(run->name);
    g_free(run->dir);
}

static int run_grow(const Verb *verb, int argc, char **argv)
{
    GrowArgs args = {0};
    int status;
    if (cli_parse(verb, &args, argc, argv, &status)) {
        Run run = {.verb = verb, .args = &args};
        status = read_args(&run) ? carry_out(&run) : EXIT_USAGE;
        clear(&run);
    }
    cli_clear(verb, &args);
    return status;
}

const Verb grow_verb = {
    "grow",
    "PARAMS",
    "Grow a leaf and write its maps, drawing, network and record",
    "Grows the leaf that the parameter file PARAMS describes and writes it into a folder: texture maps, a drawing, the "
    "network, "
    "and the run record. Equal parameters and seed give equal files, whatever the number of threads.\n\n"
    "The files appear when all is done: a run that fails or is interrupted leaves nothing behind.",
    options,
    run_grow,
};
