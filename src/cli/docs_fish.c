/* Completion for fish: one line an option, its meaning beside it. */
#include <string.h>

#include "cli/docs.h"
#include "image/paint.h"

/* Text in single quotes. */
static void quoted(GString *s, const char *text)
{
    g_string_append_c(s, '\'');
    for (; *text; text++)
        g_string_append_printf(s, strchr("'\\", *text) ? "\\%c" : "%c", *text);
    g_string_append_c(s, '\'');
}

#define IMAGES "__fish_complete_suffix .png; __fish_complete_suffix .jpg; __fish_complete_suffix .tif"

/* What may stand there, by its description: fish's words or command, in single quotes. */
static char *candidates(const char *what)
{
    static const struct {
        const char *what, *words;
    } known[] = {
        {"DIR", "(__fish_complete_directories)"},
        {"LIST", "(__venation_list $__venation_maps)"},
        {"MODELS", "(__venation_list all none glb obj ply pov)"},
        {"PARAMS", "(__fish_complete_suffix .ini)"},
        {"SWEEP", "(__fish_complete_suffix .ini)"},
        {"PARAMS|IMAGE", "(__fish_complete_suffix .ini; " IMAGES ")"},
        {"PARAMS|NETWORK|IMAGE", "(__fish_complete_suffix .ini; __fish_complete_suffix .graphml; " IMAGES ")"},
        {"IMAGE", "(" IMAGES ")"},
        {"DRAWING", "(__fish_complete_suffix .svg; __fish_complete_suffix .txt)"},
        {"[KEY]", "(string replace -r \"=\" \"\" -- $__venation_keys; string match -r \"^[a-z]+\" -- $__venation_keys | sort -u)"},
    };
    for (gsize i = 0; i < G_N_ELEMENTS(known); i++)
        if (strcmp(what, known[i].what) == 0)
            return g_strdup(known[i].words);
    if (strchr(what, '='))
        return g_strdup("(__venation_set)");
    if (strchr(what, '|'))
        return g_strdelimit(g_strdup(what), "|", ' ');
    GString *s = g_string_new(NULL);
    for (const Verb *const *v = cli_verbs(); *v && strcmp(what, "[VERB]") == 0; v++)
        g_string_append_printf(s, "%s%s", s->len ? " " : "", (*v)->name);
    return g_string_free(s, FALSE);
}

static void options(GString *s, const Verb *verb, const GOptionEntry *option)
{
    for (; option->long_name; option++) {
        g_string_append_printf(s, "complete -c venation -n '__fish_seen_subcommand_from %s'", verb->name);
        if (option->short_name)
            g_string_append_printf(s, " -s %c", option->short_name);
        g_string_append_printf(s, " -l %s", option->long_name);
        if (option->arg != G_OPTION_ARG_NONE) {
            char *words = candidates(option->arg_description);
            g_string_append_printf(s, " -x -%s ", strcmp(words, "(__venation_set)") == 0 ? "k -a" : "a");
            quoted(s, words);
            g_free(words);
        }
        g_string_append(s, " -d ");
        quoted(s, option->description);
        g_string_append_c(s, '\n');
    }
}

static void tables(GString *s)
{
    g_string_append(s, "set -g __venation_maps all none");
    for (int i = 0; i < MAP_COUNT; i++)
        g_string_append_printf(s, " %s", paint_map_info((MapId)i)->name);
    g_string_append(s, "\nset -g __venation_keys");
    for (int i = 0; i < PARAM_COUNT; i++) {
        g_string_append_printf(s, " \\\n    %s.%s=\\t", param_info((ParamId)i)->section, param_info((ParamId)i)->key);
        quoted(s, param_info((ParamId)i)->doc);
    }
    g_string_append(s, "\n\n");
}

static void values(GString *s)
{
    g_string_append(s, "# section.key= with its meaning, or all of section.key=value.\nfunction __venation_set\n"
                       "    set -l token (string replace -r '^--set=' '' -- (commandline -ct))\n"
                       "    if not string match -q '*=*' -- $token\n"
                       "        printf '%s\\n' $__venation_keys\n        return\n    end\n"
                       "    set -l parts (string split -m 1 = -- $token)\n    set -l words\n    switch $parts[1]\n");
    for (int i = 0; i < PARAM_COUNT; i++) {
        const ParamInfo *info = param_info((ParamId)i);
        char *words = g_strdelimit(g_strdup(info->choices), "|", ' ');
        const char *found = info->type == TYPE_CHOICE   ? words
                            : info->type == TYPE_SWITCH ? "yes no"
                            : info->type == TYPE_FILE   ? "(__fish_complete_path \"$parts[2]\")"
                            : i == PARAM_TEXTURE_MAPS   ? "$__venation_maps"
                                                        : "";
        if (*found)
            g_string_append_printf(s, "        case %s.%s\n            set words %s\n", info->section, info->key, found);
        g_free(words);
    }
    g_string_append(s, "    end\n    printf \"$parts[1]=%s\\n\" $words\nend\n\n"
                       "# Names parted by commas.\nfunction __venation_list\n"
                       "    set -l before (string match -r '^(?:--[a-z]+=)?(.*,)' -- (commandline -ct))[2]\n"
                       "    printf \"$before%s\\n\" $argv\nend\n\n");
}

char *docs_fish(void)
{
    GString *s = g_string_new("# Completion of venation for fish, made from its tables by 'venation params --format=fish'.\n\n");
    tables(s);
    values(s);
    g_string_append(s, "complete -c venation -f\ncomplete -c venation -n __fish_use_subcommand -l version -d 'Show the version'\n"
                       "complete -c venation -n __fish_use_subcommand -l help -d 'Show help'\n");
    for (const Verb *const *v = cli_verbs(); *v; v++) {
        g_string_append_printf(s, "complete -c venation -n __fish_use_subcommand -a %s -d ", (*v)->name);
        quoted(s, (*v)->summary);
        g_string_append_c(s, '\n');
        options(s, *v, (*v)->options);
        options(s, *v, cli_common_options());
        char *words = candidates((*v)->operands);
        g_string_append_printf(s, "complete -c venation -n '__fish_seen_subcommand_from %s' -a ", (*v)->name);
        quoted(s, words);
        g_string_append_c(s, '\n');
        g_free(words);
    }
    return g_string_free(s, FALSE);
}
