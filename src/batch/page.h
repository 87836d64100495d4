/* The page to browse a sweep with: plain files, no server, no network. */
#ifndef BATCH_PAGE_H
#define BATCH_PAGE_H

#include "batch/rows.h"
#include "batch/watch.h"

typedef struct {
    const char *title;   /* NULL: the sweep file's name */
    gboolean specimen;   /* as SheetDef's: what captions tell */
    const char *staging; /* where files are made; NULL: beside their places */
    Watch watch;
} PageDef;

/* Writes <out>/index.html and the data it loads, from the variants' rows. `params` are the sweep's, or a copy with what was set over
 * it, for the command that grows a leaf alone. Memory does not go with the number of variants. */
gboolean page_write(const Sweep *s, const Params *params, const char *out, const PageDef *def, GError **error);

#endif
