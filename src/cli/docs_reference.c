/* The parameter reference: plain text, JSON, a parameter file, Markdown. */
#include <string.h>

#include "cli/docs.h"
#include "venation.h"

typedef void (*Section)(GString *s, const char *section, gboolean first);
typedef void (*Entry)(GString *s, ParamId id, int width);

static void walk(GString *s, const Selection *sel, Section begin, Entry entry, int width)
{
    const char *section = "";
    for (int i = 0; i < PARAM_COUNT; i++) {
        const ParamInfo *info = param_info((ParamId)i);
        if (!sel->has[i])
            continue;
        if (strcmp(section, info->section) != 0)
            begin(s, info->section, !*section);
        section = info->section;
        entry(s, (ParamId)i, width);
    }
}

static void text_section(GString *s, const char *section, gboolean first)
{
    g_string_append_printf(s, "%s[%s]\n", first ? "" : "\n", section);
}

static void text_entry(GString *s, ParamId id, int width)
{
    const ParamInfo *info = param_info(id);
    char *allowed = param_allowed(id);
    g_string_append_printf(s, "\n  %s.%s =%s%s\n      ", info->section, info->key, *info->initial ? " " : "",
                           info->initial);
    docs_wrap(s, allowed, "", 6, 6, width);
    g_string_append(s, "      ");
    docs_wrap(s, info->doc, "", 6, 6, width);
    g_free(allowed);
}

char *docs_text(const Selection *sel, int width)
{
    GString *s = g_string_new(NULL);
    walk(s, sel, text_section, text_entry, width);
    return g_string_free(s, FALSE);
}

static void ini_section(GString *s, const char *section, gboolean first)
{
    g_string_append_printf(s, "\n[%s]\n", section);
}

static void ini_entry(GString *s, ParamId id, int width)
{
    const ParamInfo *info = param_info(id);
    char *allowed = param_allowed(id);
    g_string_append(s, "\n# ");
    docs_wrap(s, info->doc, "# ", 2, 0, width);
    g_string_append(s, "# ");
    docs_wrap(s, allowed, "# ", 2, 0, width);
    g_string_append_printf(s, "%s =%s%s\n", info->key, *info->initial ? " " : "", info->initial);
    g_free(allowed);
}

char *docs_ini(const Selection *sel)
{
    GString *s = g_string_new(NULL);
    g_string_append_printf(s, "# Parameters of venation %s, each with its default. Lengths are in vein segments.\n",
                           ven_version());
    walk(s, sel, ini_section, ini_entry, 100);
    return g_string_free(s, FALSE);
}

static void append_json(GString *s, const char *text)
{
    g_string_append_c(s, '"');
    for (; *text; text++) {
        if (*text == '"' || *text == '\\')
            g_string_append_c(s, '\\');
        g_string_append_c(s, *text); /* the table holds no control characters */
    }
    g_string_append_c(s, '"');
}

static void json_pair(GString *s, const char *name, const char *text)
{
    g_string_append_printf(s, ",\n    \"%s\": ", name);
    append_json(s, text);
}

static void json_choices(GString *s, const char *choices)
{
    char **words = g_strsplit(choices, "|", -1);
    g_string_append(s, ",\n    \"choices\": [");
    for (int i = 0; words[i]; i++) {
        g_string_append(s, i ? ", " : "");
        append_json(s, words[i]);
    }
    g_string_append(s, "]");
    g_strfreev(words);
}

static void json_entry(GString *s, ParamId id)
{
    static const char *const types[] = {"number", "integer", "switch",  "choice", "text",
                                        "file",   "colour",  "numbers", "points"};
    const ParamInfo *info = param_info(id);
    char low[G_ASCII_DTOSTR_BUF_SIZE], high[G_ASCII_DTOSTR_BUF_SIZE];
    char *allowed = param_allowed(id);
    g_string_append_printf(s, "  {\n    \"key\": \"%s.%s\"", info->section, info->key);
    json_pair(s, "type", types[info->type]);
    json_pair(s, "default", info->initial);
    if (*info->unit)
        json_pair(s, "unit", info->unit);
    if (info->low < info->high)
        g_string_append_printf(s, ",\n    \"low\": %s,\n    \"high\": %s",
                               g_ascii_formatd(low, sizeof low, "%.15g", info->low),
                               g_ascii_formatd(high, sizeof high, "%.15g", info->high));
    if (*info->choices)
        json_choices(s, info->choices);
    json_pair(s, "allowed", allowed);
    json_pair(s, "doc", info->doc);
    g_string_append(s, "\n  }");
    g_free(allowed);
}

char *docs_json(const Selection *sel)
{
    GString *s = g_string_new("[");
    gboolean first = TRUE;
    for (int i = 0; i < PARAM_COUNT; i++) {
        if (!sel->has[i])
            continue;
        g_string_append(s, first ? "\n" : ",\n");
        json_entry(s, (ParamId)i);
        first = FALSE;
    }
    g_string_append(s, "\n]\n");
    return g_string_free(s, FALSE);
}

/* A cell of a Markdown table, where '|' would end it; code when `code`. */
static void cell(GString *s, const char *text, gboolean code)
{
    g_string_append(s, code ? " `" : " ");
    for (; *text; text++) {
        if (*text == '|' || (!code && strchr("<*_\\", *text)))
            g_string_append_c(s, '\\');
        g_string_append_c(s, *text);
    }
    g_string_append(s, code ? "` |" : " |");
}

static void markdown_section(GString *s, const char *section, gboolean first)
{
    g_string_append_printf(s, "\n## [%s]\n\n| key | default | allowed | meaning |\n| --- | --- | --- | --- |\n",
                           section);
}

static void markdown_entry(GString *s, ParamId id, int width)
{
    const ParamInfo *info = param_info(id);
    char *allowed = param_allowed(id);
    g_string_append_c(s, '|');
    cell(s, info->key, TRUE);
    cell(s, docs_default(info), *info->initial != '\0');
    cell(s, allowed, FALSE);
    cell(s, info->doc, FALSE);
    g_string_append_c(s, '\n');
    g_free(allowed);
}

char *docs_markdown(const Selection *sel)
{
    GString *s = g_string_new(NULL);
    g_string_append_printf(
        s, "# Parameters of venation %s\n\nLengths are in vein segments (one segment is 1) unless it says otherwise.\n",
        ven_version());
    walk(s, sel, markdown_section, markdown_entry, 0);
    return g_string_free(s, FALSE);
}
