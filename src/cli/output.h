/* The output folder: a run writes into a hidden folder inside it, and its files move to their places when all is done.
 * So a run that fails or is interrupted leaves nothing, and what an earlier run left there stays whole. */
#ifndef CLI_OUTPUT_H
#define CLI_OUTPUT_H

#include <glib.h>

typedef struct Output Output;

/* Makes the folder, and those above it, where they are missing. */
Output *output_new(const char *dir, GError **error);

/* Removes what was not committed, and the folders that output_new made if nothing was. Accepts NULL. */
void output_free(Output *o);

/* The hidden folder to write into. */
const char *output_staging(const Output *o);

/* Moves the files to their places, the .json record last, after what was there has gone, its record first. All or nothing: when a move fails, or
 * something is in the way, the folder is as it was. Frames of an earlier run of that name make way, as the sequence would mix two runs; other
 * files of its stay (output_stale). */
gboolean output_commit(Output *o, const char *name, GError **error);

/* Files in the folder that begin like this run's, NAME_ or NAME., and that it did not write: an earlier run's, or another verb's. */
guint output_stale(const Output *o);

/* Of the committed files. */
guint output_files(const Output *o);
guint64 output_bytes(const Output *o);

/* Removes the staging folder and those made; for the thread that ends an interrupted run while another may still be
 * writing. */
void output_discard(Output *o);

/* Discards every output there is, for a process that ends at once: neither allocates nor locks, and may run in a signal handler. */
void output_discard_all(void);

#endif
