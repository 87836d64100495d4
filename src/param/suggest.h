/* "Did you mean …?": the known word nearest to one that is not known. */
#ifndef PARAM_SUGGEST_H
#define PARAM_SUGGEST_H

#include <glib.h>

/* The known word nearest to `word` by edit distance (insert, delete, replace, swap neighbours; case, '-' and '_'
 * alike), if it is near enough to be meant: at most a third of the letters differ. Else the one known word that begins
 * with `word`. Else NULL. Ties go to the first. */
const char *suggest_nearest(const char *word, const char *const *known, gsize n);

/* A hint for an unknown `key` of a known section of a parameter file: the nearest key there, the section it is really
 * in, or the section's keys. Free it. */
char *suggest_key(const char *section, const char *key);

/* A hint for an unknown section of a parameter file: the nearest section, or all. Free it. */
char *suggest_section(const char *section);

/* A hint for an unknown "section.key". Free it. */
char *suggest_dotted(const char *dotted);

#endif
