/* How well each edge operator finds a leaf's margin, as text for people. */
#ifndef LIB_FANG_TABLE_H
#define LIB_FANG_TABLE_H

#include "param/params.h"
#include "scan/scan.h"

/* A row for each operator that Fang & Shen 2013 (section 3.2) compare, with all other settings as given. NULL with an error for settings
 * that can't be used; what a scan does not give is said in its row. Free with g_free. */
char *fang_table(const Params *p, const Scan *scan, GError **error);

#endif
