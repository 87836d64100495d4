/* Options of verbs, read by GLib's parser from tables that hold offsets instead of addresses: so they are constant and
 * serve help, man page and completion too. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "cli/cli.h"
#include "cli/docs.h"
#include "lib/leaf.h"
#include "param/suggest.h"

static const GOptionEntry common[] = {
    {"help", 'h', 0, G_OPTION_ARG_NONE, (gpointer)offsetof(CommonArgs, help), "Show this help", NULL},
    {0},
};

static const GOptionEntry operands[] = {
    {G_OPTION_REMAINING, 0, 0, G_OPTION_ARG_FILENAME_ARRAY, (gpointer)offsetof(CommonArgs, operands), NULL, NULL},
    {0},
};

const GOptionEntry *cli_common_options(void)
{
    return common;
}

static void add(GArray *entries, const GOptionEntry *table, char *args)
{
    for (; table->long_name; table++) {
        GOptionEntry entry = *table;
        entry.arg_data = args + GPOINTER_TO_SIZE(table->arg_data);
        g_array_append_val(entries, entry);
    }
}

/* The name of the first option that no table has; NULL: none. */
static char *unknown_option(const GArray *entries, int argc, char **argv)
{
    for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++) {
        if (strncmp(argv[i], "--", 2) != 0)
            continue;
        char *name = g_strndup(argv[i] + 2, strcspn(argv[i] + 2, "="));
        gboolean known = FALSE;
        for (guint k = 0; k < entries->len && !known; k++)
            known = strcmp(name, g_array_index(entries, GOptionEntry, k).long_name) == 0;
        if (!known)
            return name;
        g_free(name);
    }
    return NULL;
}

static int refuse(const Verb *verb, const GArray *entries, int argc, char **argv, const GError *error)
{
    char *name = g_error_matches(error, G_OPTION_ERROR, G_OPTION_ERROR_UNKNOWN_OPTION)
                     ? unknown_option(entries, argc, argv)
                     : NULL;
    if (!name)
        return cli_usage(verb, "%s: %s", verb->name, error->message);
    const char *known[64];
    gsize n = 0;
    for (guint k = 0; k < entries->len && n < G_N_ELEMENTS(known); k++)
        if (*g_array_index(entries, GOptionEntry, k).long_name)
            known[n++] = g_array_index(entries, GOptionEntry, k).long_name;
    const char *near = suggest_nearest(name, known, n);
    int status = near ? cli_usage(verb, "%s: unknown option --%s; did you mean --%s?", verb->name, name, near)
                      : cli_usage(verb, "%s: unknown option --%s", verb->name, name);
    g_free(name);
    return status;
}

gboolean cli_parse(const Verb *verb, void *args, int argc, char **argv, int *status)
{
    GArray *entries = g_array_new(TRUE, TRUE, sizeof(GOptionEntry));
    add(entries, verb->options, args);
    add(entries, common, args);
    add(entries, operands, args);
    /* The parser shuffles the vector it is given. */
    char **given = g_memdup2(argv, sizeof *argv * ((gsize)argc + 1)),
         **vector = g_memdup2(argv, sizeof *argv * ((gsize)argc + 1));
    int n = argc;
    GOptionContext *context = g_option_context_new(NULL);
    g_option_context_set_help_enabled(context, FALSE);
    g_option_context_add_main_entries(context, (const GOptionEntry *)(void *)entries->data, NULL);
    GError *error = NULL;
    gboolean good = g_option_context_parse(context, &n, &vector, &error);
    if (!good) {
        *status = refuse(verb, entries, argc, given, error);
    } else if (((CommonArgs *)args)->help) {
        char *text = docs_verb(verb, docs_width());
        *status = cli_print(text);
        g_free(text);
        good = FALSE;
    }
    g_clear_error(&error);
    g_option_context_free(context);
    g_free(vector);
    g_free(given);
    g_array_unref(entries);
    return good;
}

void cli_clear(const Verb *verb, void *args)
{
    g_strfreev(((CommonArgs *)args)->operands);
    for (const GOptionEntry *e = verb->options; e->long_name; e++) {
        char *field = (char *)args + GPOINTER_TO_SIZE(e->arg_data);
        if (e->arg == G_OPTION_ARG_FILENAME)
            g_free(*(char **)(void *)field);
        else if (e->arg == G_OPTION_ARG_FILENAME_ARRAY)
            g_strfreev(*(char ***)(void *)field);
    }
}

gboolean cli_count_from(const Verb *verb, const char *option, const char *text, guint64 least, guint64 most, guint64 *out)
{
    gboolean hex = g_ascii_strncasecmp(text, "0x", 2) == 0;
    const char *digits = hex ? text + 2 : text;
    errno = 0;
    guint64 value = g_ascii_strtoull(digits, NULL, hex ? 16 : 10);
    if (!*digits || digits[strspn(digits, hex ? "0123456789abcdefABCDEF" : "0123456789")] || errno || value < least || value > most) {
        cli_usage(verb, "%s %s: must be a whole number from %" G_GUINT64_FORMAT " to %" G_GUINT64_FORMAT, option, text, least, most);
        return FALSE;
    }
    *out = value;
    return TRUE;
}

gboolean cli_count(const Verb *verb, const char *option, const char *text, guint64 most, guint64 *out)
{
    return cli_count_from(verb, option, text, 0, most, out);
}

gboolean cli_set(VenParams *params, const char *option, const char *key, const char *value, GError **error)
{
    int id = param_find(key);
    g_assert(id >= 0); /* the verbs' own keys */
    return params_set(params->values, (ParamId)id, value, option, error);
}

const char *cli_s(guint64 count) { return count == 1 ? "" : "s"; }

static void tell(const char *format, va_list args)
{
    char *text = g_strdup_vprintf(format, args);
    char *valid = g_utf8_make_valid(text, -1);
    GString *line = g_string_new("venation: ");
    for (const char *c = valid; *c; c = g_utf8_next_char(c)) {
        gunichar u = g_utf8_get_char(c);
        g_string_append_unichar(line, g_unichar_iscntrl(u) ? 0xFFFD : u); /* arguments may hold any bytes */
    }
    fprintf(stderr, "%s\n", line->str);
    g_string_free(line, TRUE);
    g_free(valid);
    g_free(text);
}

int cli_fail(int status, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    tell(format, args);
    va_end(args);
    return status;
}

int cli_usage(const Verb *verb, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    tell(format, args);
    va_end(args);
    fprintf(stderr, "Try 'venation%s%s --help'.\n", verb ? " " : "", verb ? verb->name : "");
    return EXIT_USAGE;
}

int cli_print(const char *text)
{
    if (fputs(text, stdout) == EOF || fflush(stdout) == EOF)
        return cli_fail(EXIT_FAILED, "can't write to standard output: %s", g_strerror(errno));
    return 0;
}
