/* A run of a verb that makes one leaf: grow and shape. What they share, from arguments to the files in their places. */
#ifndef CLI_RUN_H
#define CLI_RUN_H

#include "cli/cli.h"
#include "cli/interrupt.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "venation.h"

/* Arguments of such a verb begin with this. */
typedef struct {
    CommonArgs common;
    gboolean json, quiet;
    char *dir, *seed, *threads, *size, *name;
    char **set;
} RunArgs;

/* Their options, for a verb's table; */
#define RUN_OPTIONS                                                                                                                      \
    {"output", 'o', 0, G_OPTION_ARG_FILENAME, (gpointer)offsetof(RunArgs, dir), "Folder to write to (default: out/NAME)", "DIR"},        \
    {"seed", 0, 0, G_OPTION_ARG_FILENAME, (gpointer)offsetof(RunArgs, seed),                                                            \
     "Seed of the chance in a run, decimal or 0x hexadecimal (default: 1)", "N"},                                                       \
    {"set", 0, 0, G_OPTION_ARG_FILENAME_ARRAY, (gpointer)offsetof(RunArgs, set),                                                        \
     "Set a parameter, over the file's value; may be given more than once", "section.key=value"},                                       \
    {"size", 0, 0, G_OPTION_ARG_FILENAME, (gpointer)offsetof(RunArgs, size),                                                            \
     "Longer side of the maps in pixels, as --set texture.size=PX", "PX"},                                                              \
    {"name", 0, 0, G_OPTION_ARG_FILENAME, (gpointer)offsetof(RunArgs, name),                                                            \
     "What file names begin with (default: that of the file given)", "NAME"},                                                           \
    {"threads", 0, 0, G_OPTION_ARG_FILENAME, (gpointer)offsetof(RunArgs, threads),                                                      \
     "Threads to use (default: one a processor); the result is the same", "N"},                                                         \
    {"json", 0, 0, G_OPTION_ARG_NONE, (gpointer)offsetof(RunArgs, json), "Print the run record to standard output", NULL},              \
    {"quiet", 'q', 0, G_OPTION_ARG_NONE, (gpointer)offsetof(RunArgs, quiet), "Say nothing but errors", NULL}

/* One run. */
typedef struct {
    const Verb *verb;
    const RunArgs *args;
    const char *path; /* of the file given */
    char *name, *dir;
    guint64 seed, threads;
    VenParams *params;
    Output *output;
    Interrupt *interrupt;
    Progress *progress;
    VenLeaf *leaf;
    uint32_t steps;
    gint64 begun;
} Run;

/* What can be told from the command line alone; FALSE is a usage error, told. */
gboolean run_read_args(Run *run, const Verb *verb, const RunArgs *args);

/* Whether a file begins as a PNG, JPEG or TIFF image does. */
gboolean run_is_image(const char *path);

/* Parameters from `path` (NULL, or the image given: defaults) with --set and --size over them; when the file given is an image it is the
 * scan. FALSE with an error. */
gboolean run_read_params(Run *run, const char *path, GError **error);

/* Sets one parameter over them. */
gboolean run_set(Run *run, const char *key, const char *value, GError **error);

/* Makes the output folder and minds signals from here on. Returns 0 or the exit status. */
int run_begin(Run *run);

/* Grows the leaf; `every` as VenOptions.snapshot_every, `progress` is called at every step after the run's own affairs. Returns 0 or the exit
 * status, told. `failed` (may be NULL) points at an error of `progress`, which is reported and taken. */
int run_grow_leaf(Run *run, uint32_t every, gboolean (*progress)(const VenProgress *now, gpointer user), gpointer user, GError **failed);

/* Writes by `write` into the hidden folder and moves all to its place. Returns 0 or the exit status, told. */
int run_write(Run *run, gboolean (*write)(Run *run, const char *dir, gpointer user, GError **error), gpointer user);

/* Tells an error, takes it, and gives the exit status it stands for; `reading`: a file that isn't there is bad input. */
int run_report(GError *error, gboolean reading);

/* Two lines on what was written; `what` is said of the leaf. */
void run_summarise(const Run *run, const char *what);

/* Prints a record, taken. */
int run_print_record(char *record);

void run_clear(Run *run);

#endif
