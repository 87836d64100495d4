/* The man page, in man(7) macros. */
#include <string.h>

#include "cli/docs.h"
#include "image/paint.h"
#include "venation.h"

/* Text as roff shows it literally, in ASCII so that every device and locale can. */
static void roff(GString *s, const char *text)
{
    static const struct {
        gunichar c;
        const char *roff;
    } escapes[] = {
        {'\\', "\\e"},  {'-', "\\-"},    {'\'', "\\(aq"}, {'`', "\\(ga"},    {'^', "\\(ha"},
        {'~', "\\(ti"}, {0x2026, "..."}, {0xB2, "\\(S2"}, {0x2013, "\\(en"}, {0xD7, "\\(mu"},
    };
    for (; *text; text = g_utf8_next_char(text)) {
        gunichar c = g_utf8_get_char(text);
        const char *escape = NULL;
        for (gsize i = 0; i < G_N_ELEMENTS(escapes); i++)
            if (escapes[i].c == c)
                escape = escapes[i].roff;
        if (escape)
            g_string_append(s, escape);
        else if (c < 128)
            g_string_append_c(s, (char)c);
        else
            g_string_append_printf(s, "\\[u%04X]", c);
    }
}

/* A line of text; one that begins with a point or quote would be a request. */
static void line(GString *s, const char *text)
{
    g_string_append(s, "\\&");
    roff(s, text);
    g_string_append_c(s, '\n');
}

static void tagged(GString *s, const char *tag, const char *text)
{
    g_string_append(s, ".TP\n\\fB");
    roff(s, tag);
    g_string_append(s, "\\fR\n");
    line(s, text);
}

static void pairs(GString *s, const char *title, const DocsPair *pair)
{
    g_string_append_printf(s, ".SH %s\n", title);
    for (; pair->name; pair++)
        tagged(s, pair->name, pair->meaning);
}

static void options(GString *s, const GOptionEntry *option)
{
    for (; option->long_name; option++) {
        char *name = docs_option(option);
        tagged(s, name, option->description);
        g_free(name);
    }
}

static void synopsis(GString *s)
{
    g_string_append(s, ".SH SYNOPSIS\n");
    for (const Verb *const *v = cli_verbs(); *v; v++) {
        char *text = docs_synopsis(*v);
        g_string_append(s, v == cli_verbs() ? "\\fB" : ".br\n\\fB");
        roff(s, text);
        g_string_append(s, "\\fR\n");
        g_free(text);
    }
    g_string_append(s, ".br\n\\fBvenation \\-\\-version\\fR\n");
}

static void verb(GString *s, const Verb *v)
{
    g_string_append_printf(s, ".SS %s\n", v->name);
    char **paragraphs = g_strsplit(v->description, "\n\n", -1);
    for (int i = 0; paragraphs[i]; i++) {
        g_string_append(s, i ? ".PP\n" : "");
        line(s, paragraphs[i]);
    }
    g_strfreev(paragraphs);
    options(s, v->options);
    options(s, cli_common_options());
}

static void parameters(GString *s)
{
    g_string_append(s, ".SH PARAMETERS\nParameter files hold sections in brackets, lines \"key = value\", and comments "
                       "on lines of their own after # or ;. Lengths are in vein segments (one segment is 1) unless it says otherwise.\n");
    const char *section = "";
    for (int i = 0; i < PARAM_COUNT; i++) {
        const ParamInfo *info = param_info((ParamId)i);
        if (strcmp(section, info->section) != 0)
            g_string_append_printf(s, ".SS [%s]\n", info->section);
        section = info->section;
        char *allowed = param_allowed((ParamId)i);
        g_string_append_printf(s, ".TP\n\\fB%s.%s\\fR = ", info->section, info->key);
        roff(s, docs_default(info));
        g_string_append_c(s, '\n');
        line(s, info->doc);
        g_string_append(s, ".br\n");
        line(s, allowed);
        g_free(allowed);
    }
}

static void maps(GString *s)
{
    g_string_append(s, ".SH MAPS\n");
    for (int i = 0; i < MAP_COUNT; i++) {
        const MapInfo *map = paint_map_info((MapId)i);
        tagged(s, map->name, map->doc);
    }
}

char *docs_man(void)
{
    GString *s = g_string_new(NULL);
    g_string_append_printf(s, ".TH VENATION 1 \"\" \"venation %s\" \"User Commands\"\n", ven_version());
    g_string_append(s, ".nh\n.ad l\n.SH NAME\nvenation \\- grow leaf veins and turn them into leaves\n");
    synopsis(s);
    g_string_append(s,
                    ".SH DESCRIPTION\nGrows the veins of leaves by the method of Runions et al. (2005): auxin sources "
                    "appear in a growing "
                    "blade, veins grow towards them, and sources that are reached are removed. The result depends on "
                    "the parameters and the seed alone.\n.SH VERBS\n");
    for (const Verb *const *v = cli_verbs(); *v; v++)
        verb(s, *v);
    pairs(s, "FILES", docs_files);
    maps(s);
    parameters(s);
    pairs(s, "EXIT STATUS", docs_statuses);
    pairs(s, "ENVIRONMENT", docs_environment);
    pairs(s, "EXAMPLES", docs_examples);
    return g_string_free(s, FALSE);
}
