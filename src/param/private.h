/* What params.c shares with params_file.c. */
#ifndef PARAM_PRIVATE_H
#define PARAM_PRIVATE_H

#include "param/params.h"

/* Where a value stands. */
typedef struct {
    const char *origin; /* parameter file, "--set", or NULL */
    unsigned line;      /* of the file; 0: none */
    const char *folder; /* FILE values start here; NULL: the working folder */
} Place;

gboolean params_assign(Params *p, ParamId id, const char *value, const Place *place, GError **error);

/* `text` fit for a message: valid UTF-8, without control characters, not long. Free it. */
char *param_quote(const char *text);

#endif
