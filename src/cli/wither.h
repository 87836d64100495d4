/* The colours of a withered leaf. */
#ifndef CLI_WITHER_H
#define CLI_WITHER_H

#include "cli/run.h"

/* Makes the leaf's own colours those of its age (pose.age): yellowed, brown, dull and uneven; what --set gave stays. A scan's colours are the scan's. */
gboolean wither_colours(Run *run, GError **error);

#endif
