/* Completion for zsh: what each word may be, with its meaning beside it. */
#include <string.h>

#include "cli/docs.h"
#include "image/paint.h"

/* Text within single quotes; within brackets and between colons of an option's description too when `plain`. */
static void quoted(GString *s, const char *text, gboolean plain)
{
    for (; *text; text++) {
        if (*text == '\'')
            g_string_append(s, "'\\''");
        else if (plain && strchr("[]:\\", *text))
            g_string_append_printf(s, "\\%c", *text);
        else
            g_string_append_c(s, *text);
    }
}

#define IMAGES "png|jpg|jpeg|tif|tiff|PNG|JPG|JPEG|TIF|TIFF"

/* Appends zsh's action for an argument or operand, by its description. */
static void action(GString *s, const char *what)
{
    static const struct {
        const char *what, *action;
    } known[] = {
        {"DIR", "_files -/"},
        {"LIST", "_sequence compadd - $_venation_maps"},
        {"MODELS", "_sequence compadd - all none glb obj ply pov"},
        {"PARAMS", "_files -g \"*.ini(-.)\""},
        {"SWEEP", "_files -g \"*.ini(-.)\""},
        {"PARAMS|IMAGE", "_files -g \"*.(ini|" IMAGES ")(-.)\""},
        {"PARAMS|NETWORK|IMAGE", "_files -g \"*.(ini|graphml|" IMAGES ")(-.)\""},
        {"IMAGE", "_files -g \"*.(" IMAGES ")(-.)\""},
        {"DRAWING", "_files -g \"*.(svg|txt)(-.)\""},
        {"[KEY]", "compadd -- ${_venation_keys%%:*} ${(u)_venation_keys%%.*}"},
        {"[VERB]", "compadd -- ${_venation_verbs%%:*}"},
    };
    for (gsize i = 0; i < G_N_ELEMENTS(known); i++) {
        if (strcmp(what, known[i].what) == 0) {
            g_string_append(s, known[i].action);
            return;
        }
    }
    if (strchr(what, '=')) {
        g_string_append(s, "_venation_set");
    } else if (strchr(what, '|')) {
        char *words = g_strdelimit(g_strdup(what), "|", ' ');
        g_string_append_printf(s, "(%s)", words);
        g_free(words);
    } else {
        g_string_append_c(s, ' ');
    }
}

static void options(GString *s, const GOptionEntry *option)
{
    for (; option->long_name; option++) {
        gboolean takes = option->arg != G_OPTION_ARG_NONE, many = option->arg == G_OPTION_ARG_FILENAME_ARRAY;
        g_string_append(s, " \\\n            ");
        if (option->short_name)
            g_string_append_printf(s, "'(-%c --%s)'{-%c%s,--%s%s}'", option->short_name, option->long_name, option->short_name,
                                   takes ? "+" : "", option->long_name, takes ? "=" : "");
        else
            g_string_append_printf(s, "'%s--%s%s", many ? "*" : "", option->long_name, takes ? "=" : "");
        g_string_append_c(s, '[');
        quoted(s, option->description, TRUE);
        g_string_append_c(s, ']');
        if (takes) {
            g_string_append_c(s, ':');
            quoted(s, option->arg_description, TRUE);
            g_string_append_c(s, ':');
            action(s, option->arg_description);
        }
        g_string_append_c(s, '\'');
    }
}

static void tables(GString *s)
{
    g_string_append(s, "_venation_verbs=(\n");
    for (const Verb *const *v = cli_verbs(); *v; v++) {
        g_string_append_printf(s, "    '%s:", (*v)->name);
        quoted(s, (*v)->summary, FALSE);
        g_string_append(s, "'\n");
    }
    g_string_append(s, ")\n_venation_maps=(all none");
    for (int i = 0; i < MAP_COUNT; i++)
        g_string_append_printf(s, " %s", paint_map_info((MapId)i)->name);
    g_string_append(s, ")\n_venation_keys=(\n");
    for (int i = 0; i < PARAM_COUNT; i++) {
        g_string_append_printf(s, "    '%s.%s:", param_info((ParamId)i)->section, param_info((ParamId)i)->key);
        quoted(s, param_info((ParamId)i)->doc, FALSE);
        g_string_append(s, "'\n");
    }
    g_string_append(s, ")\n\n");
}

static void values(GString *s)
{
    g_string_append(s, "# key, or =value of the key before it\n_venation_set()\n{\n"
                       "    if ! compset -P 1 '*='; then\n"
                       "        _describe parameter _venation_keys -qS =\n"
                       "        return\n    fi\n    case ${${IPREFIX%=}##*=} in\n");
    for (int i = 0; i < PARAM_COUNT; i++) {
        const ParamInfo *info = param_info((ParamId)i);
        char *words = g_strdelimit(g_strdup(info->choices), "|", ' ');
        const char *command = info->type == TYPE_CHOICE   ? "compadd --"
                              : info->type == TYPE_SWITCH ? "compadd -- yes no"
                              : info->type == TYPE_FILE   ? "_files"
                              : i == PARAM_TEXTURE_MAPS   ? "_sequence compadd - $_venation_maps"
                                                          : "";
        if (*command)
            g_string_append_printf(s, "    %s.%s) %s%s%s ;;\n", info->section, info->key, command, *words ? " " : "", words);
        else if (*info->initial)
            g_string_append_printf(s, "    %s.%s) _message 'default: %s' ;;\n", info->section, info->key, info->initial);
        g_free(words);
    }
    g_string_append(s, "    esac\n}\n\n");
}

char *docs_zsh(void)
{
    GString *s = g_string_new("#compdef venation\n"
                              "# Completion of venation for zsh, made from its tables by 'venation params --format=zsh'.\n\n");
    tables(s);
    values(s);
    g_string_append(s, "_venation()\n{\n    local curcontext=$curcontext state line\n    typeset -A opt_args\n"
                       "    _arguments -C '(- *)--version[Show the version]' '(- *)--help[Show help]' '1: :->verb' '*:: :->rest'\n"
                       "    case $state in\n    verb) _describe verb _venation_verbs ;;\n    rest)\n        case $words[1] in\n");
    for (const Verb *const *v = cli_verbs(); *v; v++) {
        g_string_append_printf(s, "        %s)\n            _arguments", (*v)->name);
        options(s, (*v)->options);
        options(s, cli_common_options());
        g_string_append(s, " \\\n            '1:");
        quoted(s, (*v)->operands, TRUE);
        g_string_append_c(s, ':');
        action(s, (*v)->operands);
        g_string_append(s, "' ;;\n");
    }
    g_string_append(s, "        esac ;;\n    esac\n}\n\n"
                       "# Loaded as the function of that name, or read by source.\n"
                       "if [[ $funcstack[1] == _venation ]]; then _venation \"$@\"; else compdef _venation venation; fi\n");
    return g_string_free(s, FALSE);
}
