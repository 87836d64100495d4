/* Grows the variants of a sweep, leaves side by side. Each is made in a hidden folder and appears in its place at once, with its row (rows.h): so what is there is
 * whole, and a run that was stopped or killed goes on where it was, whoever made the rest. */
#ifndef BATCH_BATCH_H
#define BATCH_BATCH_H

#include "batch/watch.h"
#include "sweep/sweep.h"

typedef struct {
    const Sweep *sweep;
    const Params *params;     /* the sweep's, or a copy with what was set over it */
    const char *out;          /* folder, which is there */
    const char *staging;      /* hidden folder on the same file system; may be NULL to collect, but then a killed run leaves parts of files beside them */
    unsigned threads;         /* 0: all processors */
    uint32_t shard, shards;   /* grows variants whose index is `shard` (from 0) modulo `shards`; 0, 1: all of them */
    gboolean models;          /* shape the leaves, too */
    gboolean labels;          /* write the annotations that a dataset is made of (dataset.h) */
    uint32_t picture;         /* longer side of the picture for the sheet, pixels; 0: none */
    gboolean specimen;        /* the picture is of the leaf as a scanner sees it, not of its veins alone */
    Watch watch;              /* of collecting */
} BatchDef;

typedef struct {
    uint64_t total;            /* variants of this part */
    uint64_t found;            /* there already */
    uint64_t grown, failed;    /* now; `failed` counts old failures too */
    uint32_t growing;          /* at the moment */
    double part;               /* of those: how much is done, their sum */
} BatchState;

/* Does what is missing. `tick` is told the state ten times a second on the calling thread; FALSE stops the run. Returns FALSE with an error of the machine
 * (a full disk), after which the rest was left, or of G_IO_ERROR_CANCELLED; variants whose parameters don't go together are no such error: they are rows. */
gboolean batch_run(const BatchDef *def, gboolean (*tick)(const BatchState *state, gpointer user), gpointer user, BatchState *end, GError **error);

/* Before anything else, while `staging` is there: other runs on the folder must be of the same sweep, parameters and options. FALSE with the name of the hidden
 * folder of one that isn't in *other (free it), or with an error. */
gboolean batch_claim(const BatchDef *def, char **other, GError **error);

/* What the files of a variant take that is there, or of one at hand those written so far, bytes; 0 if there are none. */
uint64_t batch_bytes(const BatchDef *def, uint64_t index);

/* Makes an error name files in their places, not in the hidden folder. */
void batch_name_plainly(GError *error, const char *hidden, const char *folder);

/* Removes a folder with all in it. */
void batch_remove(const char *folder);

/* What is there of all variants: missing ones, and those from other parameters, which count as missing. */
typedef struct {
    uint64_t grown, failed, missing;
    uint64_t stale, damaged;             /* of the missing ones: leaves of other parameters or options, and those whose files are not what they were */
    uint64_t first_stale, first_damaged; /* index of one of them */
} BatchCount;

/* How leaves that are there are looked at: their rows alone, number and length of their files too, or all that is in them. */
typedef enum { BATCH_ROWS, BATCH_SIZES, BATCH_CONTENTS } BatchCheck;

/* Counts this part alone. FALSE with an error if it was stopped. */
gboolean batch_count(const BatchDef *def, BatchCheck check, BatchCount *count, GError **error);

/* The parameters of a leaf that is there whose values are not those that it would have now, by name; "" if none is known. Free it. */
char *batch_differing(const BatchDef *def, uint64_t index);

/* Writes <out>/manifest.jsonl and manifest.csv from all rows, in order, each in `staging`, and moved. Memory does not go with the number of variants.
 * Rows of other parameters are written as missing. */
gboolean manifest_write(const BatchDef *def, BatchCount *count, GError **error);

/* Leaves and rows of failure in the output folder that are of no variant: of a sweep file that was other, or larger. And the hidden folders of other
 * runs, which are at work or were killed. Clear them with batch_names_clear. */
enum { BATCH_TOLD = 3 };
typedef struct {
    uint64_t count;
    char *first[BATCH_TOLD]; /* relative to `out`, the first ones in order; NULL: there are no more */
} BatchNames;
void batch_unnamed(const BatchDef *def, BatchNames *out);
void batch_hidden(const BatchDef *def, BatchNames *out);
void batch_names_clear(BatchNames *n);

#endif
