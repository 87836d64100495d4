/* What the files of the browsing page share. */
#ifndef BATCH_PAGE_PRIVATE_H
#define BATCH_PAGE_PRIVATE_H

#include <stdbool.h>

#include "batch/page.h"

enum { PAGE_CHUNK = 1000 }; /* rows of one data file: what is held in memory */

/* Adds a text as a JavaScript string that may stand anywhere in a page: no '<', no end of line of any kind. NULL: null. */
void page_string(GString *s, const char *text);

/* The rows from `first` on as a call of venationRows, column by column. */
void page_rows(const Sweep *s, const char *out, uint64_t first, uint64_t n, GString *text);

#endif
