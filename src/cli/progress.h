/* One line on the terminal that tells how far a run has come. */
#ifndef CLI_PROGRESS_H
#define CLI_PROGRESS_H

#include "venation.h"

typedef struct Progress Progress;

/* NULL, which all of these accept, when stderr is no terminal. */
Progress *progress_new(const char *label);
void progress_free(Progress *p);

/* Redraws the line, at most ten times a second. */
void progress_update(Progress *p, const VenProgress *now);

/* The same for other work: how much is done, 0 … 1, and what is told of it. */
void progress_part(Progress *p, double done, const char *facts);

/* Says what goes on after the growth; redraws at once. */
void progress_say(Progress *p, const char *what);

/* Wipes the line away. */
void progress_clear(Progress *p);

#endif
