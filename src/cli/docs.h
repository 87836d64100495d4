/* Texts made from the tables: help, the parameter reference in several formats, man page, completion. */
#ifndef CLI_DOCS_H
#define CLI_DOCS_H

#include "cli/cli.h"
#include "param/params.h"

/* Which parameters a text is about. */
typedef struct {
    bool has[PARAM_COUNT];
} Selection;

/* Columns to wrap at: the terminal's when stdout is one, else 100. */
int docs_width(void);

/* Appends `text` wrapped at `width` columns, the lines after the first indented by `indent`, ends the line. `at` is the
 * column that the first line begins in. `lead` begins each further line after the indent ("" or "# "). */
void docs_wrap(GString *s, const char *text, const char *lead, int at, int indent, int width);

/* All of these make text to be freed. */
char *docs_overview(int width);
char *docs_verb(const Verb *verb, int width);
char *docs_text(const Selection *sel, int width);
char *docs_json(const Selection *sel);
char *docs_ini(const Selection *sel);
char *docs_markdown(const Selection *sel);
char *docs_man(void);
char *docs_bash(void);
char *docs_zsh(void);
char *docs_fish(void);

/* The default as shown to people: a dash for nothing. */
const char *docs_default(const ParamInfo *info);

/* An option as it is typed: "-o, --output=DIR". Free it. */
char *docs_option(const GOptionEntry *option);

/* Synopsis of a verb: "venation grow PARAMS [OPTION]…". Free it. */
char *docs_synopsis(const Verb *verb);

/* Pairs of a name and what it means, NULL at the end: exit statuses, files written, environment, examples. */
typedef struct {
    const char *name, *meaning;
} DocsPair;

extern const DocsPair docs_statuses[], docs_files[], docs_environment[], docs_examples[];

#endif
