/* Completion for bash. The tables become case statements; the rest of the script is below. */
#include <string.h>

#include "cli/docs.h"
#include "image/paint.h"

/* What may stand after an option, by its arg_description: a kind that the script knows, or the words themselves. */
static char *argument(const char *description)
{
    if (strchr(description, '|'))
        return g_strdelimit(g_strdup(description), "|", ' ');
    static const char *const kind[] = {"DIR", "LIST", "MODELS", "PARAMS", "IMAGE", "DRAWING", NULL};
    if (g_strv_contains(kind, description))
        return g_strdup_printf("@%s", description);
    return g_strdup(strchr(description, '=') ? "@SET" : "");
}

static void option_words(GString *s, const GOptionEntry *options)
{
    for (; options->long_name; options++) {
        if (options->short_name)
            g_string_append_printf(s, " -%c", options->short_name);
        g_string_append_printf(s, " --%s", options->long_name);
    }
}

static void verbs(GString *s)
{
    g_string_append(s, "_venation_verbs='");
    for (const Verb *const *v = cli_verbs(); *v; v++)
        g_string_append_printf(s, "%s%s", v == cli_verbs() ? "" : " ", (*v)->name);
    g_string_append(s, "'\n\n# Options of a verb.\n_venation_options()\n{\n    case $1 in\n");
    for (const Verb *const *v = cli_verbs(); *v; v++) {
        g_string_append_printf(s, "    %s) echo '", (*v)->name);
        option_words(s, (*v)->options);
        option_words(s, cli_common_options());
        g_string_append(s, "' ;;\n");
    }
    g_string_append(s, "    esac\n}\n\n# What kind of operand a verb takes.\n_venation_operand()\n{\n    case $1 in\n");
    for (const Verb *const *v = cli_verbs(); *v; v++) {
        char *kind = g_strdelimit(g_strdup((*v)->operands), "[]", ' ');
        g_string_append_printf(s, "    %s) echo '@%s' ;;\n", (*v)->name, g_strstrip(kind));
        g_free(kind);
    }
    g_string_append(s, "    esac\n}\n\n# What stands after an option of a verb; fails for one that takes nothing.\n"
                       "_venation_argument()\n{\n    case $1$2 in\n");
    for (const Verb *const *v = cli_verbs(); *v; v++) {
        for (const GOptionEntry *o = (*v)->options; o->long_name; o++) {
            if (o->arg == G_OPTION_ARG_NONE)
                continue;
            char *words = argument(o->arg_description);
            g_string_append_printf(s, "    %s--%s", (*v)->name, o->long_name);
            if (o->short_name)
                g_string_append_printf(s, " | %s-%c", (*v)->name, o->short_name);
            g_string_append_printf(s, ") echo '%s' ;;\n", words);
            g_free(words);
        }
    }
    g_string_append(s, "    *) return 1 ;;\n    esac\n}\n\n");
}

static void parameters(GString *s)
{
    g_string_append(s, "_venation_keys='");
    for (int i = 0; i < PARAM_COUNT; i++)
        g_string_append_printf(s, "%s%s.%s", i ? "\n" : "", param_info((ParamId)i)->section,
                               param_info((ParamId)i)->key);
    g_string_append(s, "'\n_venation_maps='all none");
    for (int i = 0; i < MAP_COUNT; i++)
        g_string_append_printf(s, " %s", paint_map_info((MapId)i)->name);
    g_string_append(s, "'\n\n# Values of a parameter.\n_venation_values()\n{\n    case $1 in\n");
    for (int i = 0; i < PARAM_COUNT; i++) {
        const ParamInfo *info = param_info((ParamId)i);
        char *words = g_strdelimit(g_strdup(info->choices), "|", ' ');
        const char *values = info->type == TYPE_CHOICE        ? words
                             : info->type == TYPE_SWITCH      ? "yes no"
                             : info->type == TYPE_FILE        ? "@FILE"
                             : i == PARAM_TEXTURE_MAPS        ? "@MAP"
                             : strpbrk(info->initial, "# ;,") ? ""
                                                              : info->initial;
        if (*values)
            g_string_append_printf(s, "    %s.%s) echo '%s' ;;\n", info->section, info->key, values);
        g_free(words);
    }
    g_string_append(s, "    esac\n}\n\n");
}

static const char script[] =
    "_venation_images='png jpg jpeg tif tiff PNG JPG JPEG TIF TIFF'\n\n"
    "# Folders, and files that end with one of the words after $1.\n"
    "_venation_files()\n"
    "{\n"
    "    local cur=$1 end\n"
    "    compopt -o filenames 2>/dev/null\n"
    "    mapfile -t COMPREPLY < <(compgen -d -- \"$cur\"; for end in \"${@:2}\"; do compgen -f -X \"!*.$end\" -- \"$cur\"; done)\n"
    "}\n\n"
    "# Puts into COMPREPLY what of kind $1 (see above; else plain words) begins with $2.\n"
    "_venation_reply()\n"
    "{\n"
    "    local words=$1 cur=$2\n"
    "    case $1 in\n"
    "    @DIR) compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -d -- \"$cur\"); return ;;\n"
    "    @FILE) compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -f -- \"$cur\"); return ;;\n"
    "    @PARAMS|@SWEEP) _venation_files \"$cur\" ini; return ;;\n"
    "    '@PARAMS|IMAGE') _venation_files \"$cur\" ini $_venation_images; return ;;\n"
    "    '@PARAMS|NETWORK|IMAGE') _venation_files \"$cur\" ini graphml $_venation_images; return ;;\n"
    "    @IMAGE) _venation_files \"$cur\" $_venation_images; return ;;\n"
    "    @DRAWING) _venation_files \"$cur\" svg txt; return ;;\n"
    "    @SET)\n"
    "        if [[ $cur == *=* ]]; then\n"
    "            _venation_reply \"$(_venation_values \"${cur%%=*}\")\" \"${cur#*=}\"\n"
    "            COMPREPLY=(\"${COMPREPLY[@]/#/${cur%%=*}=}\")\n"
    "        else\n"
    "            compopt -o nospace 2>/dev/null\n"
    "            mapfile -t COMPREPLY < <(compgen -S = -W \"$_venation_keys\" -- \"$cur\")\n"
    "        fi\n"
    "        return ;;\n"
    "    @LIST | @MODELS) # names parted by commas\n"
    "        local before= names=$_venation_maps\n"
    "        [[ $1 == @MODELS ]] && names='all none glb obj ply pov'\n"
    "        [[ $cur == *,* ]] && before=${cur%,*},\n"
    "        mapfile -t COMPREPLY < <(compgen -P \"$before\" -W \"$names\" -- \"${cur##*,}\")\n"
    "        return ;;\n"
    "    @KEY) words=\"$_venation_keys $(cut -d. -f1 <<<\"$_venation_keys\" | uniq)\" ;;\n"
    "    @VERB) words=$_venation_verbs ;;\n"
    "    @MAP) words=$_venation_maps ;;\n"
    "    esac\n"
    "    mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$cur\")\n"
    "}\n"
    "\n"
    "_venation()\n"
    "{\n"
    "    # Readline breaks words at = and : too; go by blanks, and give back only what stands after the last break.\n"
    "    local IFS=$' \\t\\n' line=${COMP_LINE:0:COMP_POINT} cur= prev= verb kind strip=\n"
    "    local -a words\n"
    "    read -ra words <<<\"$line\"\n"
    "    if [[ $line == *[[:blank:]] ]]; then words+=(''); fi\n"
    "    cur=${words[-1]}\n"
    "    COMPREPLY=()\n"
    "    if ((${#words[@]} <= 2)); then\n"
    "        _venation_reply \"$_venation_verbs --version --help\" \"$cur\"\n"
    "        return\n"
    "    fi\n"
    "    verb=${words[1]} prev=${words[-2]}\n"
    "    if kind=$(_venation_argument \"$verb\" \"$prev\"); then\n"
    "        _venation_reply \"$kind\" \"$cur\"\n"
    "    elif [[ $cur == --*=* ]]; then\n"
    "        kind=$(_venation_argument \"$verb\" \"${cur%%=*}\") || return\n"
    "        _venation_reply \"$kind\" \"${cur#*=}\"\n"
    "        COMPREPLY=(\"${COMPREPLY[@]/#/${cur%%=*}=}\")\n"
    "    elif [[ $cur == -* ]]; then\n"
    "        _venation_reply \"$(_venation_options \"$verb\")\" \"$cur\"\n"
    "    else\n"
    "        _venation_reply \"$(_venation_operand \"$verb\")\" \"$cur\"\n"
    "    fi\n"
    "    if [[ $COMP_WORDBREAKS == *=* && $cur == *[=:]* ]]; then\n"
    "        strip=${cur%\"${cur##*[=:]}\"}\n"
    "        COMPREPLY=(\"${COMPREPLY[@]#\"$strip\"}\")\n"
    "    fi\n"
    "}\n"
    "\n"
    "complete -F _venation venation\n";

char *docs_bash(void)
{
    GString *s =
        g_string_new("# Completion of venation for bash, made from its tables by 'venation params --format=bash'.\n\n");
    verbs(s);
    parameters(s);
    g_string_append(s, script);
    return g_string_free(s, FALSE);
}
