/* venation params: the reference of every parameter, and the texts that the build installs. */
#include <string.h>

#include "cli/cli.h"
#include "cli/docs.h"
#include "param/suggest.h"

typedef struct {
    CommonArgs common;
    gboolean json;
    char *format;
} ParamsArgs;

static const GOptionEntry options[] = {
    {"json", 0, 0, G_OPTION_ARG_NONE, (gpointer)offsetof(ParamsArgs, json), "The same as --format=json", NULL},
    {"format", 0, 0, G_OPTION_ARG_FILENAME, (gpointer)offsetof(ParamsArgs, format),
     "Plain text (the default), JSON, a parameter file of all defaults, a Markdown page, the man page, or completion "
     "for bash, zsh or fish", "text|json|ini|markdown|man|bash|zsh|fish"},
    {0},
};

static char *make_text(const Selection *sel)
{
    return docs_text(sel, docs_width());
}

static char *make_man(const Selection *sel)
{
    return docs_man();
}

static char *make_bash(const Selection *sel)
{
    return docs_bash();
}

static char *make_zsh(const Selection *sel)
{
    return docs_zsh();
}

static char *make_fish(const Selection *sel)
{
    return docs_fish();
}

static const struct {
    const char *name;
    gboolean whole; /* about the whole command, not of some parameters */
    char *(*make)(const Selection *sel);
} formats[] = {
    {"text", FALSE, make_text},         {"json", FALSE, docs_json}, {"ini", FALSE, docs_ini},
    {"markdown", FALSE, docs_markdown}, {"man", TRUE, make_man},    {"bash", TRUE, make_bash},
    {"zsh", TRUE, make_zsh},            {"fish", TRUE, make_fish},
};

static gboolean is_section(const char *word)
{
    gboolean found = FALSE;
    for (int i = 0; i < PARAM_COUNT && !found; i++)
        found = strcmp(param_info((ParamId)i)->section, word) == 0;
    return found;
}

/* Selects "section.key", a whole section, or else a key in whatever sections have it. */
static gboolean select_params(const char *word, Selection *sel)
{
    int id = param_find(word);
    gboolean any = FALSE, section = is_section(word);
    for (int i = 0; i < PARAM_COUNT; i++) {
        const ParamInfo *info = param_info((ParamId)i);
        sel->has[i] = !word[0] || i == id || strcmp(section ? info->section : info->key, word) == 0;
        any |= sel->has[i];
    }
    return any;
}

static int refuse_key(const Verb *verb, const char *word)
{
    char *hint = suggest_dotted(word);
    int status = cli_usage(verb, "%s: no such parameter or section; %s", word, hint);
    g_free(hint);
    return status;
}

static int print(const Verb *verb, const ParamsArgs *args)
{
    const char *format = args->format ? args->format : args->json ? "json" : "text";
    const char *word = args->common.operands ? args->common.operands[0] : "";
    Selection sel;
    if (args->format && args->json && strcmp(args->format, "json") != 0)
        return cli_usage(verb, "--json contradicts --format=%s", args->format);
    if (args->common.operands && args->common.operands[1])
        return cli_usage(verb, "params: one key or section at a time");
    if (!select_params(word, &sel))
        return refuse_key(verb, word);
    const char *names[G_N_ELEMENTS(formats)];
    for (gsize i = 0; i < G_N_ELEMENTS(formats); i++) {
        names[i] = formats[i].name;
        if (strcmp(formats[i].name, format) != 0)
            continue;
        if (formats[i].whole && *word)
            return cli_usage(verb, "--format=%s is of all parameters", format);
        char *text = formats[i].make(&sel);
        int status = cli_print(text);
        g_free(text);
        return status;
    }
    const char *near = suggest_nearest(format, names, G_N_ELEMENTS(names));
    return cli_usage(verb, "--format %s: must be one of text, json, ini, markdown, man, bash, zsh or fish%s%s%s", format,
                     near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
}

static int run(const Verb *verb, int argc, char **argv)
{
    ParamsArgs args = {0};
    int status;
    if (cli_parse(verb, &args, argc, argv, &status))
        status = print(verb, &args);
    cli_clear(verb, &args);
    return status;
}

const Verb params_verb = {
    "params",
    "[KEY]",
    "The reference of every parameter",
    "Prints what each parameter means, its default and what is allowed: all of them, those of a section (veins), or "
    "one "
    "(veins.kill_distance).",
    options,
    run,
};
