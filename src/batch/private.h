/* What the files of this room share. */
#ifndef BATCH_PRIVATE_H
#define BATCH_PRIVATE_H

#include "batch/batch.h"
#include "batch/rows.h"
#include "lib/leaf.h"

enum { FOLDER_LEAVES = 1000, MOST_IN_ONE = 10000 }; /* variants of a folder; of a sweep whose leaves are all in one */

/* The files in a folder but for row and hidden ones. `sha256` is that of what sha256sum says of them, in order of their names (bytes):
 *     ls | grep -vx sweep.json | LC_ALL=C sort | xargs sha256sum | sha256sum */
typedef struct {
    uint32_t files;
    uint64_t bytes;
    char sha256[65];
} FolderSum;
gboolean batch_measure_folder(const char *folder, FolderSum *out); /* files and bytes alone */
gboolean batch_sum_folder(const char *folder, FolderSum *out, GError **error);
uint64_t batch_folder_bytes(const char *folder); /* with the row */

/* Has the disk take all files of a folder, so that after a power failure none with this name is emptied. */
gboolean batch_sync_folder(const char *folder, GError **error);

/* An error of errno, "PATH: WHAT: …". Returns FALSE. */
gboolean batch_fail(GError **error, const char *what, const char *path);
gboolean batch_make_folder(const char *path, GError **error);

/* Gives the folder its name, at once; one that is there already, an older one or another run's, makes way. */
gboolean batch_move_folder(const char *from, const char *to, GError **error);

/* Moves a file of this name, maybe one in a folder that is in both, to its place. */
gboolean batch_place_file(const char *staging, const char *out, const char *name, GError **error);

/* Writes a row, in a folder that need not be there. */
gboolean batch_write_row(const char *row, const char *path, GError **error);

/* The next hidden folder of another run; NULL: there is no more. `dir` is the output folder, or NULL. */
const char *batch_next_hidden(const BatchDef *def, GDir *dir);

/* Whether another run, on this machine or another, has begun with the variant and not ended; a run that was killed on another machine looks so, too. */
bool batch_in_hand(const BatchDef *def, const char *variant);

/* The variant's place, relative to the output folder: leaves/NAME or leaves/000/NAME; failed/NAME.json. Free it. */
char *row_folder(const Sweep *s, const SweepVariant *v);
char *row_failed(const SweepVariant *v);

/* The text of a row, one line without its end. `key` is what the variant depends on (batch_key). Free it. */
char *row_grown(const Sweep *s, const SweepVariant *v, const char *key, const VenLeaf *leaf, const FolderSum *sum);
char *row_failure(const Sweep *s, const SweepVariant *v, const char *key, const GError *error);
char *row_missing(const Sweep *s, const SweepVariant *v);

/* The counts of a row, by name and in order; NULL at the end. */
const char *const *row_counts(void);

/* The key in a row that was read, or NULL. Free it. */
char *row_key(const Row *row);

/* Whether the files beside the row of a grown leaf are as many and as long as it says; with `contents`, and the same. */
bool row_is_whole(const char *out, const Row *row, bool contents);

/* What a variant depends on: version, every parameter, the contents of the files they name, the seed, and what is written. Two runs with one key give one
 * result. Any number of threads. Free it. */
typedef struct Keys Keys;
Keys *keys_new(const BatchDef *def);
void keys_free(Keys *k);
char *keys_of(Keys *k, const Params *p, uint64_t seed);

/* Parameters of a variant; NULL with an error. */
Params *batch_params(const BatchDef *def, const SweepVariant *v, GError **error);

#endif
