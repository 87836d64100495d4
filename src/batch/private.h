/* What the files of this room share. */
#ifndef BATCH_PRIVATE_H
#define BATCH_PRIVATE_H

#include "batch/batch.h"
#include "batch/rows.h"
#include "lib/leaf.h"

enum { FOLDER_LEAVES = 1000, MOST_IN_ONE = 10000 }; /* variants of a folder; of a sweep whose leaves are all in one */

/* The variant's place, relative to the output folder: leaves/NAME or leaves/000/NAME; failed/NAME.json. Free it. */
char *row_folder(const Sweep *s, const SweepVariant *v);
char *row_failed(const SweepVariant *v);

/* The text of a row, one line without its end. `key` is what the variant depends on (batch_key). Free it. */
char *row_grown(const Sweep *s, const SweepVariant *v, const char *key, const VenLeaf *leaf, uint32_t files, uint64_t bytes);
char *row_failure(const Sweep *s, const SweepVariant *v, const char *key, const GError *error);
char *row_missing(const Sweep *s, const SweepVariant *v);

/* The counts of a row, by name and in order; NULL at the end. */
const char *const *row_counts(void);

/* The key in a row that was read, or NULL. Free it. */
char *row_key(const Row *row);

/* What a variant depends on: version, every parameter, the contents of the files they name, the seed, and what is written. Two runs with one key give one
 * result. Any number of threads. Free it. */
typedef struct Keys Keys;
Keys *keys_new(const BatchDef *def);
void keys_free(Keys *k);
char *keys_of(Keys *k, const Params *p, uint64_t seed);

/* Parameters of a variant; NULL with an error. */
Params *batch_params(const BatchDef *def, const SweepVariant *v, GError **error);

#endif
