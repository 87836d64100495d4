/* The venation command. */
#include <locale.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

#include "cli/cli.h"
#include "cli/docs.h"
#include "param/suggest.h"
#include "venation.h"

const Verb *const *cli_verbs(void)
{
    static const Verb *const verbs[] = {&grow_verb, &shape_verb, &capture_verb, &params_verb, &help_verb, NULL};
    return verbs;
}

static const Verb *find_verb(const char *name)
{
    for (const Verb *const *v = cli_verbs(); *v; v++)
        if (strcmp((*v)->name, name) == 0)
            return *v;
    return NULL;
}

static int refuse_verb(const char *name)
{
    const char *names[16];
    gsize n = 0;
    for (const Verb *const *v = cli_verbs(); *v && n < G_N_ELEMENTS(names); v++)
        names[n++] = (*v)->name;
    const char *near = suggest_nearest(name, names, n);
    const char *what = *name == '-' ? "option" : "verb";
    return near ? cli_usage(NULL, "%s: no such %s; did you mean '%s'?", name, what, near)
                : cli_usage(NULL, "%s: no such %s", name, what);
}

static int print_overview(void)
{
    char *text = docs_overview(docs_width());
    int status = cli_print(text);
    g_free(text);
    return status;
}

static int print_verb(const char *name)
{
    const Verb *verb = find_verb(name);
    if (!verb)
        return refuse_verb(name);
    char *text = docs_verb(verb, docs_width());
    int status = cli_print(text);
    g_free(text);
    return status;
}

static int run_help(const Verb *verb, int argc, char **argv)
{
    CommonArgs args = {0};
    int status;
    if (cli_parse(verb, &args, argc, argv, &status)) {
        if (args.operands && args.operands[1])
            status = cli_usage(verb, "help: one verb at a time");
        else
            status = args.operands ? print_verb(args.operands[0]) : print_overview();
    }
    cli_clear(verb, &args);
    return status;
}

static const GOptionEntry no_options[] = {{0}};

const Verb help_verb = {
    "help",     "[VERB]", "Help on a verb", "Tells what a verb does, or without one which verbs there are.",
    no_options, run_help,
};

static int print_version(void)
{
    char *text = g_strdup_printf("venation %s\n", ven_version());
    int status = cli_print(text);
    g_free(text);
    return status;
}

int main(int argc, char **argv)
{
    setlocale(LC_CTYPE, "");  /* tells whether the terminal shows UTF-8; numbers stay as they are */
    signal(SIGXFSZ, SIG_IGN); /* a file that may not grow is an error like a full disk, not the end of the process */
    if (argc < 2) {
        char *text = docs_overview(100);
        fputs(text, stderr);
        g_free(text);
        return EXIT_USAGE;
    }
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0)
        return print_overview();
    if (strcmp(argv[1], "--version") == 0)
        return print_version();
    const Verb *verb = find_verb(argv[1]);
    return verb ? verb->run(verb, argc - 1, argv + 1) : refuse_verb(argv[1]);
}
