/* Whose fault an error is: the input's, or the machine's. */
#ifndef LIB_FAULT_H
#define LIB_FAULT_H

#include <glib.h>

/* TRUE for what a run was given; FALSE for a full disk and its like. `reading`: a file that isn't there or is closed to us was given wrongly. */
gboolean fault_is_input(const GError *error, gboolean reading);

#endif
