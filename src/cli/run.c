#include "cli/run.h"

#include <gio/gio.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "lib/fault.h"

enum { MOST_THREADS = 1024 };

/* ---- arguments ---- */

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
    char *dot = strrchr(base, '.');
    if (dot && dot != base)
        *dot = '\0';
    run->name = run->args->name ? g_strdup(run->args->name) : g_strdup(base);
    g_free(base);
    if (!is_name(run->name)) {
        if (run->args->name)
            cli_usage(run->verb, "--name %s: must be what file names can begin with: not empty, no '/', no '.' in front", run->name);
        else if (g_file_test(run->path, G_FILE_TEST_IS_DIR))
            cli_usage(run->verb, "%s: is a folder; %s takes one file at a time", run->path, run->verb->name);
        else
            cli_usage(run->verb, "%s: no name for files; give one with --name", run->name);
        return FALSE;
    }
    run->dir = run->args->dir ? g_strdup(run->args->dir) : g_build_filename("out", run->name, NULL);
    if (!*run->dir)
        cli_usage(run->verb, "--output: must be the path of a folder");
    return *run->dir != '\0';
}

gboolean run_read_args(Run *run, const Verb *verb, const RunArgs *a)
{
    char **operands = a->common.operands;
    *run = (Run){.verb = verb, .args = a, .seed = 1, .begun = g_get_monotonic_time()};
    if (!operands || operands[1]) {
        cli_usage(verb, operands ? "%s: one file at a time" : "%s: a file is missing", verb->name);
        return FALSE;
    }
    run->path = operands[0];
    for (char **s = a->set; s && *s; s++) {
        if (!strchr(*s, '=')) {
            cli_usage(verb, "--set %s: must be section.key=value", *s);
            return FALSE;
        }
    }
    return (!a->seed || cli_count(verb, "--seed", a->seed, G_MAXUINT64, &run->seed)) &&
           (!a->threads || cli_count(verb, "--threads", a->threads, MOST_THREADS, &run->threads)) && choose_name(run);
}

/* ---- parameters ---- */

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

gboolean run_set(Run *run, const char *key, const char *value, GError **error)
{
    return ven_params_set(run->params, key, value, error);
}

static gboolean load(Run *run, const char *path, GError **error)
{
    run->params = ven_params_load(path, error);
    if (run->params)
        return TRUE;
    char *near = g_file_test(path, G_FILE_TEST_EXISTS) ? NULL : nearby_file(path);
    if (near && error && *error) {
        char *message = g_strdup_printf("%s; did you mean %s?", (*error)->message, near);
        g_free((*error)->message);
        (*error)->message = message;
    }
    g_free(near);
    return FALSE;
}

gboolean run_is_image(const char *path)
{
    static const struct {
        gsize n;
        char bytes[5];
    } begin[] = {{4, "\x89PNG"}, {3, "\xFF\xD8\xFF"}, {4, "II*\0"}, {4, "MM\0*"}};
    char head[4] = {0};
    FILE *file = fopen(path, "rb");
    gsize n = file && g_file_test(path, G_FILE_TEST_IS_REGULAR) ? fread(head, 1, sizeof head, file) : 0;
    if (file)
        fclose(file);
    for (gsize i = 0; i < G_N_ELEMENTS(begin); i++)
        if (n >= begin[i].n && memcmp(head, begin[i].bytes, begin[i].n) == 0)
            return TRUE;
    return FALSE;
}

gboolean run_read_params(Run *run, const char *path, GError **error)
{
    gboolean image = run_is_image(run->path);
    if (!path || (image && path == run->path))
        run->params = ven_params_new();
    else if (!load(run, path, error))
        return FALSE;
    for (char **s = run->args->set; s && *s; s++) {
        const char *equals = strchr(*s, '=');
        char *key = g_strndup(*s, (gsize)(equals - *s));
        gboolean good = run_set(run, key, equals + 1, error);
        g_free(key);
        if (!good)
            return FALSE;
    }
    if (image && !ven_params_use_scan(run->params, run->path, error))
        return FALSE;
    return !run->args->size || cli_set(run->params, "--size", "texture.size", run->args->size, error);
}

/* ---- errors ---- */

int run_report(GError *error, gboolean reading)
{
    int status = cli_fail(fault_is_input(error, reading) ? EXIT_BAD_INPUT : EXIT_FAILED, "%s", error->message);
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

/* Runs on the thread that waits for signals, when there is no time to wait for the run. */
static void abandon(gpointer user)
{
    Run *run = user;
    if (run->output)
        output_discard(run->output);
    static const char text[] = "\nvenation: stopped; nothing was written\n"; /* below the progress bar */
    const char *from = run->progress ? text : text + 1;
    if (!run->args->quiet && write(STDERR_FILENO, from, strlen(from)) < 0)
        return; /* there is nobody to tell */
}

/* ---- the run ---- */

int run_begin(Run *run)
{
    GError *error = NULL;
    run->interrupt = interrupt_new(abandon, run);
    interrupt_hold(run->interrupt); /* until the folder is made */
    run->output = output_new(run->dir, &error);
    if (!run->output)
        return run_report(error, FALSE);
    run->progress = run->args->quiet ? NULL : progress_new(run->name);
    interrupt_polite(run->interrupt);
    return 0;
}

typedef struct {
    Run *run;
    gboolean (*progress)(const VenProgress *now, gpointer user);
    gpointer user;
} Step;

static gboolean on_step(const VenProgress *now, gpointer user)
{
    Step *step = user;
    step->run->steps = now->step;
    progress_update(step->run->progress, now);
    return (!step->progress || step->progress(now, step->user)) && interrupt_signal(step->run->interrupt) == 0;
}

int run_grow_leaf(Run *run, uint32_t every, gboolean (*progress)(const VenProgress *now, gpointer user), gpointer user, GError **failed)
{
    GError *error = NULL;
    Step step = {run, progress, user};
    VenOptions how = {(unsigned)run->threads, every, on_step, &step};
    run->leaf = ven_grow(run->params, run->seed, &how, &error);
    if (run->leaf && !(failed && *failed) && !interrupt_signal(run->interrupt))
        return 0;
    int came = interrupt_signal(run->interrupt);
    interrupt_hold(run->interrupt);
    progress_clear(run->progress);
    if (failed && *failed) {
        g_clear_error(&error);
        return run_report(with_plain_path(run, g_steal_pointer(failed)), FALSE);
    }
    if (error && !g_error_matches(error, G_IO_ERROR, G_IO_ERROR_CANCELLED))
        return run_report(error, TRUE);
    g_clear_error(&error);
    if (!run->args->quiet)
        cli_fail(0, "stopped at step %u; nothing was written", run->steps);
    return EXIT_SIGNAL + came;
}

int run_write(Run *run, gboolean (*write)(Run *run, const char *dir, gpointer user, GError **error), gpointer user)
{
    GError *error = NULL;
    progress_say(run->progress, ": writing");
    interrupt_urgent(run->interrupt);
    gboolean good = write(run, output_staging(run->output), user, &error);
    interrupt_hold(run->interrupt);
    good = good && output_commit(run->output, run->name, &error);
    progress_clear(run->progress);
    return good ? 0 : run_report(with_plain_path(run, error), FALSE);
}

void run_summarise(const Run *run, const char *what)
{
    if (run->args->quiet)
        return;
    char *title = ven_params_get(run->params, "leaf.title");
    char *dir = g_filename_display_name(run->dir);
    double seconds = (double)(g_get_monotonic_time() - run->begun) / G_USEC_PER_SEC;
    fprintf(stderr, "%s: %s, %.1f s\n", title && *title ? title : run->name, what, seconds);
    fprintf(stderr, "%s: %u file%s, %.1f MB\n", dir, output_files(run->output), cli_s(output_files(run->output)),
            (double)output_bytes(run->output) * 1e-6);
    if (run->leaf && ven_leaf_cut_off(run->leaf) > 0.002)
        fprintf(stderr, "the leaf touches the edge of the image: %.1f %% of its outline is that edge\n", 100.0 * ven_leaf_cut_off(run->leaf));
    if (run->leaf)
        fputs(ven_leaf_note(run->leaf), stderr);
    if (output_stale(run->output))
        fprintf(stderr, "%s: %u more files there begin with %s; this run did not write them, but may have read some\n", dir, output_stale(run->output), run->name);
    g_free(dir);
    g_free(title);
}

int run_print_record(char *record)
{
    char *text = g_strconcat(record, g_str_has_suffix(record, "\n") ? "" : "\n", NULL);
    int status = cli_print(text);
    g_free(text);
    g_free(record);
    return status;
}

void run_clear(Run *run)
{
    if (run->interrupt)
        interrupt_hold(run->interrupt);
    progress_free(run->progress);
    output_free(run->output);
    interrupt_free(run->interrupt);
    ven_leaf_free(run->leaf);
    ven_params_free(run->params);
    g_free(run->name);
    g_free(run->dir);
}
