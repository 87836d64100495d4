/* The venation command. */
#include <errno.h>
#include <locale.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/uio.h>
#include <unistd.h>

#include "cli/cli.h"
#include "cli/docs.h"
#include "cli/interrupt.h"
#include "cli/output.h"
#include "param/suggest.h"
#include "venation.h"

const Verb *const *cli_verbs(void)
{
    static const Verb *const verbs[] = {&grow_verb, &shape_verb, &capture_verb, &sweep_verb, &params_verb, &help_verb, NULL};
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

/* ---- the end that GLib makes when memory runs out ---- */

/* Nothing from here on allocates. */
static void say(const char *why, const char *detail)
{
    const char *text[] = {isatty(STDERR_FILENO) ? "\n" : "" /* below the progress bar */, "venation: ", why, detail, "\n"};
    struct iovec part[G_N_ELEMENTS(text)];
    for (gsize i = 0; i < G_N_ELEMENTS(text); i++)
        part[i] = (struct iovec){(void *)text[i], strlen(text[i])};
    if (writev(STDERR_FILENO, part, G_N_ELEMENTS(part)) < 0)
        return; /* there is nobody to tell */
}

/* Discards what is being written and ends the process. Any thread. */
static G_GNUC_NORETURN void end(const char *why, const char *detail)
{
    interrupt_freeze();
    output_discard_all();
    say(why, detail);
    _exit(EXIT_FAILED);
}

/* g_malloc reports by g_error, which would abort. */
static void on_log(const char *domain, GLogLevelFlags level, const char *message, gpointer user)
{
    if (!(level & G_LOG_LEVEL_ERROR)) {
        g_log_default_handler(domain, level, message, user);
        return;
    }
    static const char lead[] = "failed to allocate ";
    const char *bytes = message ? strstr(message, lead) : NULL;
    if (bytes)
        end("out of memory: no room for ", bytes + strlen(lead));
    end(message && !strstr(message, "overflow allocating") ? message : "out of memory", "");
}

#define SEEN __attribute__((visibility("default")))

/* GLib makes g_error's message with this, and when it gets no memory for that (2.74) logs by g_error that it didn't, and so on without end. So it is
 * defined anew here: without memory it does not return. The second name is what it is called where GLib was compiled with checks. */
SEEN int vasprintf(char **text, const char *format, va_list args)
{
    va_list again;
    va_copy(again, args);
    char little[256];
    int length = vsnprintf(little, sizeof little, format, args);
    *text = length < 0 ? NULL : malloc((gsize)length + 1);
    if (length >= 0 && !*text)
        end("out of memory", "");
    if (length >= 0 && (gsize)length < sizeof little)
        memcpy(*text, little, (gsize)length + 1);
    else if (length >= 0)
        vsnprintf(*text, (gsize)length + 1, format, again);
    va_end(again);
    return length;
}

SEEN int __vasprintf_chk(char **text, int flag, const char *format, va_list args);

SEEN int __vasprintf_chk(char **text, int flag, const char *format, va_list args) { return vasprintf(text, format, args); }

/* Parts of GLib abort without a word to the log when they get no memory. Anything else is a bug, of which the core tells. */
static void on_abort(int number)
{
    if (errno == ENOMEM)
        end("out of memory", "");
    output_discard_all();
    signal(number, SIG_DFL); /* abort comes again, and ends the process */
}

static void mind_the_end(void)
{
    struct sigaction action = {.sa_handler = on_abort};
    sigaction(SIGABRT, &action, NULL);
    g_log_set_default_handler(on_log, NULL);
}

int main(int argc, char **argv)
{
    mind_the_end();
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
