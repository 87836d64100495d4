/* Help on the terminal, and the texts it shares with the man page. */
#include "cli/docs.h"

#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

const DocsPair docs_statuses[] = {
    {"0", "all was done"},
    {"1", "something failed: a file could not be written, for instance"},
    {"2", "usage: an unknown verb or option, an argument missing"},
    {"3", "bad input: a parameter file, value or outline that can't be used"},
    {"130, 143", "stopped by Ctrl-C (SIGINT) or SIGTERM; nothing was written"},
    {0},
};

const DocsPair docs_files[] = {
    {"NAME_MAP.png, NAME_MAP.exr", "the texture maps that texture.maps and texture.exr ask for"},
    {"NAME.svg", "the venation as a drawing, grouped by vein order"},
    {"NAME.graphml", "the network, as igraph and NetworkX read it; node and edge tables beside it"},
    {"NAME.json", "the run record: every parameter, the seed, the version and what was grown"},
    {"frames/NAME_STEP.svg", "with --every: the leaf as it grew"},
    {0},
};

const DocsPair docs_environment[] = {
    {"NO_COLOR", "when set and not empty, no colours on the terminal"},
    {"TERM", "'dumb': no colours"},
    {0},
};

const DocsPair docs_examples[] = {
    {"venation grow params/poplar.ini", "grow a poplar leaf into out/poplar"},
    {"venation grow params/poplar.ini --seed 7 --set veins.kill_distance=5 -o out/coarse",
     "another leaf of the same kind, with a coarser net"},
    {"venation grow params/poplar.ini --every 20 --frames svg", "keep a drawing of every 20th step"},
    {"venation params --format=ini > my-leaf.ini", "begin a parameter file of one's own"},
    {0},
};

int docs_width(void)
{
    struct winsize size;
    if (isatty(STDOUT_FILENO) && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col >= 40)
        return size.ws_col;
    return 100;
}

static void pad(GString *s, int columns)
{
    g_string_append_printf(s, "%*s", MAX(columns, 0), "");
}

void docs_wrap(GString *s, const char *text, const char *lead, int at, int indent, int width)
{
    char **words = g_strsplit(text, " ", -1);
    int start = indent + (int)strlen(lead);
    gboolean fresh = TRUE;
    for (int i = 0; words[i]; i++) {
        int length = (int)g_utf8_strlen(words[i], -1);
        if (!fresh && at + 1 + length > width) {
            g_string_append_c(s, '\n');
            pad(s, indent);
            g_string_append(s, lead);
            at = start;
            fresh = TRUE;
        }
        g_string_append_printf(s, "%s%s", fresh ? "" : " ", words[i]);
        at += length + !fresh;
        fresh = FALSE;
    }
    g_string_append_c(s, '\n');
    g_strfreev(words);
}

const char *docs_default(const ParamInfo *info)
{
    return *info->initial ? info->initial : "–";
}

char *docs_option(const GOptionEntry *option)
{
    GString *s = g_string_new(NULL);
    if (option->short_name)
        g_string_append_printf(s, "-%c, ", option->short_name);
    g_string_append_printf(s, "--%s", option->long_name);
    if (option->arg != G_OPTION_ARG_NONE)
        g_string_append_printf(s, "=%s", option->arg_description);
    return g_string_free(s, FALSE);
}

char *docs_synopsis(const Verb *verb)
{
    return g_strdup_printf("venation %s %s [OPTION]…", verb->name, verb->operands);
}

/* A name in a column of `column`, its meaning beside it, or below when the name is too long. */
static void row(GString *s, const char *name, const char *meaning, int column, int width)
{
    int at = 2 + (int)g_utf8_strlen(name, -1);
    g_string_append_printf(s, "  %s", name);
    if (at + 2 > column) {
        g_string_append_c(s, '\n');
        at = 0;
    }
    pad(s, column - at);
    docs_wrap(s, meaning, "", column, column, width);
}

static void rows(GString *s, const char *title, const DocsPair *pairs, int column, int width)
{
    g_string_append_printf(s, "\n%s:\n", title);
    for (; pairs->name; pairs++)
        row(s, pairs->name, pairs->meaning, column, width);
}

char *docs_overview(int width)
{
    GString *s = g_string_new("Usage: venation VERB …\n\nGrows leaf veins and turns them into leaves.\n\nVerbs:\n");
    for (const Verb *const *v = cli_verbs(); *v; v++) {
        char *name = g_strdup_printf("%s %s", (*v)->name, (*v)->operands);
        row(s, name, (*v)->summary, 20, width);
        g_free(name);
    }
    row(s, "--version", "Show the version", 20, width);
    rows(s, "Exit status", docs_statuses, 20, width);
    g_string_append(s, "\n'venation help VERB' tells more of a verb.\n");
    return g_string_free(s, FALSE);
}

static void option_rows(GString *s, const GOptionEntry *options, int width)
{
    for (; options->long_name; options++) {
        char *option = docs_option(options);
        char *aligned = g_strconcat(options->short_name ? "" : "    ", option, NULL);
        row(s, aligned, options->description, 32, width);
        g_free(aligned);
        g_free(option);
    }
}

char *docs_verb(const Verb *verb, int width)
{
    char *synopsis = docs_synopsis(verb);
    GString *s = g_string_new(NULL);
    g_string_append_printf(s, "Usage: %s\n", synopsis);
    char **paragraphs = g_strsplit(verb->description, "\n\n", -1);
    for (int i = 0; paragraphs[i]; i++) {
        g_string_append_c(s, '\n');
        docs_wrap(s, paragraphs[i], "", 0, 0, width);
    }
    g_strfreev(paragraphs);
    g_string_append(s, "\nOptions:\n");
    option_rows(s, verb->options, width);
    option_rows(s, cli_common_options(), width);
    if (verb == &grow_verb) {
        rows(s, "Files", docs_files, 32, width);
        rows(s, "Exit status", docs_statuses, 32, width);
        g_string_append(s, "\nExamples:\n");
        for (const DocsPair *e = docs_examples; e->name; e++)
            g_string_append_printf(s, "  %s\n      %s\n", e->name, e->meaning);
    }
    g_free(synopsis);
    return g_string_free(s, FALSE);
}
