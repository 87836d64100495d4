/* The ids of nodes, numbered as a file first names them. Private to src/import. */
#ifndef IMPORT_NAMES_H
#define IMPORT_NAMES_H

#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

enum { NONE = UINT32_MAX };

typedef struct {
    uint32_t n, room;
    uint32_t *node;      /* [n] the node of that name, NONE while only edges have spoken of it */
    const char **text;   /* [n] NULL for a name that is its own number in decimal, which need not be kept */
    GHashTable *numbers; /* text to number + 1, of the names that are kept */
    GStringChunk *store;
} Names;

void names_init(Names *names);
void names_clear(Names *names);

/* The number of a name, a new one (with no node) if it is new. */
uint32_t names_number(Names *names, const char *text);

/* The name as messages show it: in quotes, cut when long, no control characters. Free it. */
char *names_quoted(const Names *names, uint32_t number);
char *names_quote(const char *text);

#endif
