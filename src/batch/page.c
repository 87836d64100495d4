/* index.html, which holds style and program, and beside it in page/ what it loads: sweep.js, the keys, and 0.js, 1.js …, the rows. Scripts, since a page that
 * was opened from a disk may load nothing else. */
#include "batch/page.h"

#include <errno.h>
#include <glib/gstdio.h>
#include <string.h>

#include "batch/page_private.h"
#include "batch/private.h"
#include "batch/sheet_label.h"
#include "batch/sheet_private.h"
#include "image/staged.h"
#include "page-resources.h"

void page_string(GString *s, const char *text)
{
    if (!text) {
        g_string_append(s, "null");
        return;
    }
    char *valid = g_utf8_make_valid(text, -1);
    g_string_append_c(s, '"');
    for (const char *c = valid; *c; c = g_utf8_next_char(c)) {
        gunichar u = g_utf8_get_char(c);
        if (u == '"' || u == '\\')
            g_string_append_printf(s, "\\%c", (char)u);
        else if (u < 0x20 || u == '<' || u == '>' || u == '&' || u == 0x7f || u == 0x2028 || u == 0x2029)
            g_string_append_printf(s, "\\u%04x", (unsigned)u);
        else
            g_string_append_unichar(s, u);
    }
    g_string_append_c(s, '"');
    g_free(valid);
}

static void member(GString *s, const char *name, const char *text)
{
    g_string_append_printf(s, "%s\"%s\":", s->str[s->len - 1] == '{' ? "" : ",", name);
    page_string(s, text);
}

static void put_key(const Sweep *s, uint32_t k, GString *text)
{
    static const char *const type[] = {"number", "integer", "switch", "choice", "text", "file", "colour", "numbers", "points"};
    SweepKey key = sweep_key(s, k);
    const ParamInfo *info = key.id < 0 ? NULL : param_info((ParamId)key.id);
    char *label = label_key(s, k);
    g_string_append(text, k ? ",\n{" : "\n{");
    member(text, "key", key.key);
    member(text, "label", label);
    member(text, "unit", label_unit(&key));
    member(text, "doc", info ? info->doc : "Seed of the chance in the run");
    member(text, "type", info ? type[info->type] : "integer");
    char *own = info ? params_format(sweep_params(s), (ParamId)key.id) : g_strdup("1");
    member(text, "own", own); /* the parameter file's, which null stands for */
    g_string_append_printf(text, ",\"varies\":%s,\"levels\":%" G_GUINT64_FORMAT "}", key.varies ? "true" : "false", key.levels);
    g_free(own);
    g_free(label);
}

/* What captions tell: as on the sheet. */
static void put_told(const Sweep *s, bool specimen, GString *text)
{
    GArray *items = g_array_new(FALSE, FALSE, sizeof(SheetItem));
    const SheetPlan plan = {.s = s, .specimen = specimen};
    for (uint32_t k = 0; k < sweep_keys(s); k++) {
        SweepKey key = sweep_key(s, k);
        SheetItem item = {k, key.axis};
        if (key.varies && (key.id >= 0 || key.levels > 0)) /* seeds that differ everywhere tell nothing */
            g_array_append_val(items, item);
    }
    sheet_choose(&plan, items);
    g_string_append(text, ",\"told\":[");
    for (guint i = 0; i < items->len; i++) {
        g_string_append(text, i ? "," : "");
        page_string(text, sweep_key(s, g_array_index(items, SheetItem, i).key).key);
    }
    g_string_append_c(text, ']');
    g_array_free(items, TRUE);
}

/* A file's path as it is from the sweep file's folder, so that it is the same wherever the sweep was started. Free it. */
static char *from_folder(const char *folder, const char *path)
{
    if (g_path_is_absolute(path) || !*path)
        return g_strdup(path);
    char *from = g_canonicalize_filename(folder, NULL), *to = g_canonicalize_filename(path, NULL);
    char **down = g_strsplit(from + 1, "/", -1), **part = g_strsplit(to + 1, "/", -1);
    gsize same = 0;
    while (down[same] && part[same] && *down[same] && strcmp(down[same], part[same]) == 0)
        same++;
    GString *s = g_string_new(NULL);
    for (gsize i = same; down[i] && *down[i]; i++)
        g_string_append(s, "../");
    for (gsize i = same; part[i]; i++)
        g_string_append_printf(s, "%s%s", part[i], part[i + 1] ? "/" : "");
    g_strfreev(down);
    g_strfreev(part);
    g_free(from);
    g_free(to);
    return g_string_free(s, FALSE);
}

/* The parameter file as the sweep file names it. */
static const char *named_params(const Sweep *s, const char *folder)
{
    const char *path = sweep_params_path(s);
    gsize n = strlen(folder);
    return g_str_has_prefix(path, folder) && path[n] == '/' ? path + n + 1 : path;
}

/* What all variants were grown with over the parameter file's values, as arguments of --set. */
static void put_settings(const Sweep *s, const Params *params, const char *folder, GString *text)
{
    bool any = false;
    g_string_append(text, ",\"set\":[");
    for (int i = 0; i < PARAM_COUNT; i++) {
        char *now = params_format(params, (ParamId)i), *before = params_format(sweep_params(s), (ParamId)i);
        if (strcmp(now, before) != 0) {
            const ParamInfo *info = param_info((ParamId)i);
            char *value = info->type == TYPE_FILE ? from_folder(folder, now) : g_strdup(now);
            char *assignment = g_strdup_printf("%s.%s=%s", info->section, info->key, value);
            g_string_append(text, any ? "," : "");
            page_string(text, assignment);
            g_free(assignment);
            g_free(value);
            any = true;
        }
        g_free(now);
        g_free(before);
    }
    g_string_append_c(text, ']');
}

static void put_sweep(const Sweep *s, const Params *params, const char *title, bool specimen, uint64_t chunks, GString *text)
{
    static const char *const mode[] = {"grid", "zip", "sample"};
    char *folder = g_path_get_dirname(sweep_path(s)), *file = g_path_get_basename(sweep_path(s));
    g_string_append(text, "venationSweep({");
    member(text, "title", title);
    member(text, "file", file);
    member(text, "mode", mode[sweep_mode(s)]);
    member(text, "params", named_params(s, folder)); /* it and all FILE values start in the sweep file's folder */
    put_settings(s, params, folder, text);
    put_told(s, specimen, text);
    g_string_append_printf(text, ",\"count\":%" G_GUINT64_FORMAT ",\"chunks\":%" G_GUINT64_FORMAT ",\"keys\":[", sweep_count(s), chunks);
    for (uint32_t k = 0; k < sweep_keys(s); k++)
        put_key(s, k, text);
    g_string_append(text, "\n]});\n");
    g_free(file);
    g_free(folder);
}

/* ---- files ---- */

static gboolean write_text(const char *out, const PageDef *def, const char *name, const GString *text, GError **error)
{
    char *path = g_build_filename(def->staging ? def->staging : out, name, NULL);
    Staged file;
    gboolean ok = staged_open(&file, path, error);
    if (ok && fwrite(text->str, 1, text->len, file.file) != text->len) {
        staged_error(path, errno, error);
        staged_abort(&file);
        ok = FALSE;
    }
    ok = ok && staged_commit(&file, error) && (!def->staging || batch_place_file(def->staging, out, name, error));
    g_free(path);
    return ok;
}

static gboolean write_chunks(const Sweep *s, const char *out, uint64_t chunks, const PageDef *def, GError **error)
{
    GString *text = g_string_new(NULL);
    gboolean ok = TRUE;
    for (uint64_t c = 0; ok && c < chunks; c++) {
        char *name = g_strdup_printf("page/%" G_GUINT64_FORMAT ".js", c);
        g_string_truncate(text, 0);
        page_rows(s, out, c * PAGE_CHUNK, MIN(PAGE_CHUNK, sweep_count(s) - c * PAGE_CHUNK), text);
        ok = write_text(out, def, name, text, error) && watch_tick(&def->watch, (double)(c + 1) / (double)chunks, error);
        g_free(name);
    }
    g_string_free(text, TRUE);
    return ok;
}

/* Those of a former, larger sweep. */
static void remove_rest(const char *out, uint64_t chunks)
{
    for (bool found = true; found; chunks++) {
        char *name = g_strdup_printf("%s/page/%" G_GUINT64_FORMAT ".js", out, chunks);
        found = g_unlink(name) == 0;
        g_free(name);
    }
}

/* Adds a file that was built in; its marks are replaced by the others. */
static void add_resource(GString *text, const char *name, const char *title)
{
    char *path = g_strconcat("/venation/page/", name, NULL);
    GBytes *bytes = g_resource_lookup_data(page_get_resource(), path, G_RESOURCE_LOOKUP_FLAGS_NONE, NULL);
    g_assert(bytes); /* built in */
    gsize n;
    const char *at = g_bytes_get_data(bytes, &n), *end = at + n, *mark;
    while ((mark = g_strstr_len(at, end - at, "@@")) != NULL) {
        const char *stop = g_strstr_len(mark + 2, end - mark - 2, "@@");
        g_assert(stop); /* marks are pairs */
        char *what = g_strndup(mark + 2, (gsize)(stop - mark - 2));
        g_string_append_len(text, at, mark - at);
        if (strcmp(what, "title") == 0)
            label_xml(text, title);
        else
            add_resource(text, what, title);
        g_free(what);
        at = stop + 2;
    }
    g_string_append_len(text, at, end - at);
    g_bytes_unref(bytes);
    g_free(path);
}

/* For the rows. */
static gboolean make_folder(const char *in, GError **error)
{
    char *folder = g_build_filename(in, "page", NULL);
    gboolean ok = batch_make_folder(folder, error);
    g_free(folder);
    return ok;
}

gboolean page_write(const Sweep *s, const Params *params, const char *out, const PageDef *def, GError **error)
{
    uint64_t chunks = (sweep_count(s) + PAGE_CHUNK - 1) / PAGE_CHUNK;
    char *own = g_path_get_basename(sweep_path(s));
    GString *text = g_string_new(NULL);
    if (g_str_has_suffix(own, ".ini"))
        own[strlen(own) - 4] = '\0';
    const char *title = def->title ? def->title : own;
    gboolean ok = make_folder(out, error) && (!def->staging || make_folder(def->staging, error));
    ok = ok && write_chunks(s, out, chunks, def, error);
    put_sweep(s, params, title, def->specimen, chunks, text);
    ok = ok && write_text(out, def, "page/sweep.js", text, error);
    g_string_truncate(text, 0);
    add_resource(text, "page.html", title);
    ok = ok && write_text(out, def, "index.html", text, error);
    if (ok)
        remove_rest(out, chunks);
    g_string_free(text, TRUE);
    g_free(own);
    return ok;
}
