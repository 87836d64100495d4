/* What became of each variant of a sweep: rows, kept as one small JSON file in each variant's folder, so that the folders are all there is to
 * know and shards share nothing else.
 *
 *     OUT/leaves/NAME/             one variant: what was asked for, as `grow` writes it; or OUT/leaves/000/NAME/ in sweeps of more than 10 000,
 *                  sweep.json      its row
 *                  sweep.png       its picture, for sheet and page
 *     OUT/failed/NAME.json         the row of a variant that can't be grown
 *
 * A row is one JSON object of plain members, on one line: "index", "variant", "outcome" ("grown", "failed" or "missing"), "error" (text, if failed),
 * "folder" (relative to OUT), then a member for each key of the sweep by its name ("veins.kill_distance", "seed"), numbers as numbers, null where the
 * parameter file's value holds, then counts and hashes: "network_hash" of the network, "sha256" of the variant's "files" but for the row itself (private.h:
 * FolderSum), and "key", which tells what it was grown from. */
#ifndef BATCH_ROWS_H
#define BATCH_ROWS_H

#include "sweep/sweep.h"

typedef enum { ROW_GROWN, ROW_FAILED, ROW_MISSING } RowOutcome;

typedef struct {
    uint64_t index;
    RowOutcome outcome;
    SweepVariant variant;
    char *folder;  /* relative to OUT, with '/' */
    char *picture; /* sweep.png relative to OUT; NULL: there is none */
    char *error;   /* why it failed, or NULL */
    char *json;    /* the row, one line without its end */
} Row;

/* Reads the row of variant `index` in folder `out`; a variant without one is missing, one whose row can't be read, or is of other parameters, too.
 * Clear it with row_clear. Any number of threads. */
void row_read(const Sweep *s, const char *out, uint64_t index, Row *row);
void row_clear(Row *row);

#endif
