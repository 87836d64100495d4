/* sweep --dry-run: what would be grown, how long it would take, and how much room. */
#ifndef CLI_SWEEP_TRIAL_H
#define CLI_SWEEP_TRIAL_H

#include "batch/batch.h"

/* Lists the variants of this part and, unless `quiet`, grows one of them in a hidden folder that goes again. On a terminal only the first are listed;
 * elsewhere the estimate comes first, as the list may be long. Returns the exit status. */
int sweep_trial(const BatchDef *def, gboolean quiet);

/* "40 s", "12 min", "3.5 h". Free it. */
char *sweep_duration(double seconds);

#endif
