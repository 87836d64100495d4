/* What else is in the output folder: other runs at work, and leaves of former sweep files. */
#include <stdio.h>
#include <string.h>

#include "batch/private.h"

/* What runs write into until it is whole (cli/output.h). */
#define HIDDEN ".venation-"

static GDir *open_in(const BatchDef *def, const char *relative)
{
    char *path = g_build_filename(def->out, relative, NULL);
    GDir *dir = g_dir_open(path, 0, NULL);
    g_free(path);
    return dir;
}

/* The next hidden folder that isn't this run's own. */
static const char *next_hidden(const BatchDef *def, GDir *dir)
{
    const char *name, *own = def->staging ? strrchr(def->staging, '/') : NULL;
    while (dir && (name = g_dir_read_name(dir)))
        if (g_str_has_prefix(name, HIDDEN) && !(own && strcmp(own + 1, name) == 0))
            return name;
    return NULL;
}

bool batch_in_hand(const BatchDef *def, const char *variant)
{
    GDir *dir = g_dir_open(def->out, 0, NULL);
    const char *name;
    bool found = false;
    while (!found && (name = next_hidden(def, dir))) {
        char *path = g_build_filename(def->out, name, variant, NULL);
        found = g_file_test(path, G_FILE_TEST_IS_DIR);
        g_free(path);
    }
    if (dir)
        g_dir_close(dir);
    return found;
}

/* ---- leaves of no variant ---- */

static void add(BatchNames *n, char *path)
{
    n->count++;
    for (gsize i = 0; i < BATCH_TOLD; i++)
        if (!n->first[i] || strcmp(path, n->first[i]) < 0) {
            char *later = n->first[i];
            n->first[i] = path;
            path = later;
            if (!path)
                return;
        }
    g_free(path);
}

/* Whether the row in this file is of a variant of the sweep whose place this is: rows begin with their index. */
static bool is_named(const BatchDef *def, const char *relative, const char *row)
{
    char *path = g_build_filename(def->out, row, NULL), head[64];
    FILE *file = fopen(path, "re");
    unsigned long long index = 0;
    bool named = file && fgets(head, sizeof head, file) && sscanf(head, "{\"index\": %18llu,", &index) == 1 && index < sweep_count(def->sweep);
    if (named) {
        SweepVariant v;
        sweep_variant(def->sweep, index, &v);
        char *folder = row_folder(def->sweep, &v), *failed = row_failed(&v);
        named = strcmp(relative, folder) == 0 || strcmp(relative, failed) == 0;
        g_free(folder);
        g_free(failed);
        sweep_variant_clear(&v);
    }
    if (file)
        fclose(file);
    g_free(path);
    return named;
}

/* Folders that have a row, in this one and those below it; of a thousand leaves each in large sweeps. */
static void find_leaves(const BatchDef *def, const char *relative, int depth, BatchNames *n)
{
    GDir *dir = open_in(def, relative);
    const char *name;
    while (dir && (name = g_dir_read_name(dir))) {
        char *folder = g_strconcat(relative, "/", name, NULL), *row = g_strconcat(folder, "/sweep.json", NULL), *path = g_build_filename(def->out, row, NULL);
        bool leaf = g_file_test(path, G_FILE_TEST_IS_REGULAR);
        if (leaf && !is_named(def, folder, row))
            add(n, g_strdup(folder));
        else if (!leaf && depth > 0)
            find_leaves(def, folder, depth - 1, n);
        g_free(path);
        g_free(row);
        g_free(folder);
    }
    if (dir)
        g_dir_close(dir);
}

void batch_unnamed(const BatchDef *def, BatchNames *out)
{
    *out = (BatchNames){0};
    find_leaves(def, "leaves", 1, out);
    GDir *dir = open_in(def, "failed");
    const char *name;
    while (dir && (name = g_dir_read_name(dir))) {
        char *row = g_strconcat("failed/", name, NULL);
        if (g_str_has_suffix(name, ".json") && !is_named(def, row, row))
            add(out, g_strdup(row));
        g_free(row);
    }
    if (dir)
        g_dir_close(dir);
}

void batch_hidden(const BatchDef *def, BatchNames *out)
{
    *out = (BatchNames){0};
    GDir *dir = g_dir_open(def->out, 0, NULL);
    const char *name;
    while ((name = next_hidden(def, dir)))
        add(out, g_strdup(name));
    if (dir)
        g_dir_close(dir);
}

void batch_names_clear(BatchNames *n)
{
    for (gsize i = 0; i < BATCH_TOLD; i++)
        g_free(n->first[i]);
    *n = (BatchNames){0};
}
