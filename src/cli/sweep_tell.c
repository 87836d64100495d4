/* What a sweep tells when it is over, and what else is in the folder. */
#include <stdio.h>
#include <string.h>

#include "batch/rows.h"
#include "cli/sweep_private.h"

enum { MOST_TOLD = 3 };

/* Why the first few failed; the rest is in the folder. */
static void tell_failures(const Sweeping *w)
{
    uint32_t told = 0;
    for (uint64_t i = w->def.shard; i < sweep_count(w->sweep) && told < MOST_TOLD; i += w->def.shards) {
        Row row;
        row_read(w->sweep, w->dir, i, &row);
        if (row.outcome == ROW_FAILED) {
            cli_fail(0, "%s: %s", row.variant.name, row.error);
            told++;
        }
        row_clear(&row);
    }
}

/* One line on what else is in the folder. */
static void tell_names(const Sweeping *w, BatchNames *n, const char *one, const char *more, const char *advice)
{
    if (n->count) {
        char *dir = g_filename_display_name(w->dir);
        GString *s = g_string_new(NULL);
        for (gsize i = 0; i < BATCH_TOLD && n->first[i]; i++)
            g_string_append_printf(s, "%s%s", i ? ", " : "", n->first[i]);
        fprintf(stderr, "%s: %" G_GUINT64_FORMAT " %s: %s%s%s\n", dir, n->count, n->count == 1 ? one : more, s->str, n->count > BATCH_TOLD ? " …" : "", advice);
        g_string_free(s, TRUE);
        g_free(dir);
    }
    batch_names_clear(n);
}

static void tell_others(const Sweeping *w)
{
    BatchNames names;
    batch_unnamed(&w->def, &names);
    tell_names(w, &names, "leaf is of no variant of this sweep, and kept", "leaves are of no variant of this sweep, and kept", "");
    batch_hidden(&w->def, &names);
    tell_names(w, &names, "hidden folder is of another run, at work or killed", "hidden folders are of other runs, at work or killed", "; remove what is of no run at work");
}

static void add_word(GString *s, const char *word)
{
    static const char plain[] = G_CSET_A_2_Z G_CSET_a_2_z G_CSET_DIGITS "_-+=./,:@%";
    char *quoted = *word && !word[strspn(word, plain)] ? g_strdup(word) : g_shell_quote(word);
    g_string_append_printf(s, " %s", quoted);
    g_free(quoted);
}

/* The command that ends the work of the shards: this one's options, but for those that leaves don't depend on. */
static char *collect_command(const Sweeping *w)
{
    GString *s = g_string_new("venation sweep");
    add_word(s, w->args->common.operands[0]);
    add_word(s, "-o");
    add_word(s, w->dir);
    for (const GOptionEntry *o = sweep_options; o->long_name; o++) {
        static const char *const left[] = {"output", "shard", "collect", "replace", "threads", "quiet", NULL};
        const void *at = (const char *)w->args + (gsize)o->arg_data;
        char *name = g_strconcat("--", o->long_name, NULL), *one[] = {NULL, NULL}, **values = one;
        if (o->arg == G_OPTION_ARG_FILENAME)
            one[0] = *(char *const *)at;
        else if (o->arg == G_OPTION_ARG_FILENAME_ARRAY)
            values = *(char **const *)at;
        gboolean wanted = !g_strv_contains(left, o->long_name);
        if (wanted && o->arg == G_OPTION_ARG_NONE && *(const gboolean *)at)
            add_word(s, name);
        for (; wanted && values && *values; values++) {
            add_word(s, name);
            add_word(s, *values);
        }
        g_free(name);
    }
    g_string_append(s, " --collect");
    return g_string_free(s, FALSE);
}

/* "sheet.png, " or, where one does not hold all, "sheet.png … sheet-3.png, ". */
static char *sheet_names(const Sweeping *w)
{
    guint last = 1;
    for (bool found = true; found; last += found) {
        char *path = g_strdup_printf("%s/sheet-%u.png", w->dir, last + 1);
        found = g_file_test(path, G_FILE_TEST_EXISTS);
        g_free(path);
    }
    return last > 1 ? g_strdup_printf("sheet.png … sheet-%u.png, ", last) : g_strdup("sheet.png, ");
}

/* What is in the folder beside the leaves. */
static void tell_written(const Sweeping *w, const char *dir)
{
    char *sheets = w->cell ? sheet_names(w) : g_strdup("");
    fprintf(stderr, "%s: %s%s%smanifest.csv, manifest.jsonl, leaves\n", dir, w->args->dataset ? "dataset, " : "", sheets, w->cell ? "index.html, " : "");
    g_free(sheets);
}

void sweeping_summarise(const Sweeping *w, const BatchState *end, uint64_t failed, uint64_t missing)
{
    GString *s = g_string_new(NULL);
    char *dir = g_filename_display_name(w->dir);
    if (failed)
        tell_failures(w);
    if (end)
        g_string_append_printf(s, "%" G_GUINT64_FORMAT " %s grown, %" G_GUINT64_FORMAT " were there", end->grown, end->grown == 1 ? "leaf" : "leaves", end->found);
    if (failed)
        g_string_append_printf(s, "%s%" G_GUINT64_FORMAT " failed (%s/failed)", s->len ? ", " : "", failed, dir);
    if (missing)
        g_string_append_printf(s, "%s%" G_GUINT64_FORMAT " missing", s->len ? ", " : "", missing);
    if (!w->args->quiet) {
        fprintf(stderr, "%s: %s%s%.1f s\n", w->name, s->str, s->len ? ", " : "", (double)(g_get_monotonic_time() - w->begun) / G_USEC_PER_SEC);
        char *command = collect_command(w);
        if (w->args->shard)
            fprintf(stderr, "%s: part %" G_GUINT64_FORMAT " of %" G_GUINT64_FORMAT "; after the last one: %s\n", dir, w->shard, w->shards, command);
        else
            tell_written(w, dir);
        g_free(command);
        if (!w->args->shard)
            tell_others(w);
    }
    g_free(dir);
    g_string_free(s, TRUE);
}

/* Leaves that these parameters and options would not give. */
int sweeping_tell_stale(const Sweeping *w, const BatchCount *count, const char *advice)
{
    char *names = batch_differing(&w->def, count->first_stale);
    int status = cli_fail(EXIT_BAD_INPUT, "%s: %" G_GUINT64_FORMAT " of the leaves there are of other parameters or options (%s): %s", w->dir, count->stale,
                          *names ? names : "a file they name, --write, --cell, --picture, --dataset, or the version", advice);
    g_free(names);
    return status;
}

int sweeping_tell_damaged(const Sweeping *w, const BatchCount *count)
{
    Row row;
    row_read(w->sweep, w->dir, count->first_damaged, &row);
    int status = cli_fail(EXIT_BAD_INPUT, "%s: files of %" G_GUINT64_FORMAT " %s are not what they were when they were written, as those of %s: run the sweep again without --collect, "
                          "which grows what is damaged anew", w->dir, count->damaged, count->damaged == 1 ? "leaf" : "leaves", row.folder);
    row_clear(&row);
    return status;
}
