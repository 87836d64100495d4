/* The venation command: its verbs, and what they share. */
#ifndef CLI_CLI_H
#define CLI_CLI_H

#include <glib.h>

#include "venation.h"

enum { EXIT_FAILED = 1, EXIT_USAGE = 2, EXIT_BAD_INPUT = 3, EXIT_SIGNAL = 128 /* plus the signal */ };

/* A verb's arguments begin with this. */
typedef struct {
    gboolean help;
    char **operands; /* NULL: none */
} CommonArgs;

/* One verb. Help, man page and completion are made from these; there is no other list. */
typedef struct Verb Verb;
struct Verb {
    const char *name;
    const char *operands;        /* PARAMS, [KEY], [VERB]: completion goes by them too */
    const char *summary;         /* one line */
    const char *description;     /* paragraphs, parted by empty lines */
    const GOptionEntry *options; /* arg_data: offset into the verb's arguments; completion goes by arg_description */
    int (*run)(const Verb *verb, int argc, char **argv);
};

extern const Verb grow_verb, shape_verb, capture_verb, sweep_verb, params_verb, help_verb;

/* All verbs, NULL at the end, and the options that each has (--help). */
const Verb *const *cli_verbs(void);
const GOptionEntry *cli_common_options(void);

/* Reads options and operands into `args`, the verb's struct, which begins with CommonArgs. FALSE when all is said
 * already, after
 * --help or a usage error: then `status` is the exit status. */
gboolean cli_parse(const Verb *verb, void *args, int argc, char **argv, int *status);

/* Frees what cli_parse put into `args`. */
void cli_clear(const Verb *verb, void *args);

/* A whole number for an option, decimal or after 0x hexadecimal; FALSE, and told, for anything else. cli_count takes 0 too. */
gboolean cli_count_from(const Verb *verb, const char *option, const char *text, guint64 least, guint64 most, guint64 *out);
gboolean cli_count(const Verb *verb, const char *option, const char *text, guint64 most, guint64 *out);

/* Sets the parameter that an option stands for: --size is texture.size. Errors, those found later too, name the option. */
gboolean cli_set(VenParams *params, const char *option, const char *key, const char *value, GError **error);

/* The ending of a word for so many things: "1 node", "2 nodes". */
const char *cli_s(guint64 count);

/* "venation: …" on stderr; returns `status`. cli_usage adds where to find help. */
int cli_fail(int status, const char *format, ...) G_GNUC_PRINTF(2, 3);
int cli_usage(const Verb *verb, const char *format, ...) G_GNUC_PRINTF(2, 3);

/* Data to stdout; returns the exit status, which tells of a full disk or closed pipe. */
int cli_print(const char *text);

#endif
