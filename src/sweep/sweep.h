/* Sweep files: many variants of one parameter file, each made when it is asked for, so that 10⁹ of them take no more memory than ten.
 *
 *     [sweep]
 *     params = ../poplar.ini              the parameter file that all variants begin with
 *     mode = grid                         grid, zip or sample
 *     veins.kill_distance = 5; 10; 20     any key of the parameter table, as section.key
 *     seed = 1; 2; 3                      the run's seed
 *
 * mode      grid: every combination, the last key changing fastest. zip: the first values of all keys, then the second ones, and so on.
 *           sample: `count` variants, each with values drawn by chance.
 * count     of mode sample.
 * seed      seeds of the runs, given as values of any key; 1 if there are none. each: another for every variant, sample_seed + its index.
 * sample_seed  seed of what is drawn; as `seed` where that is one number, else 1.
 * sequence  of what is drawn. random: independent. halton: evenly spread (low discrepancy).
 * table     CSV file whose heading names keys (and seed, and name): its rows stay together and are one more list, in its place among the
 *           keys. An empty cell leaves the parameter file's value. A line that begins with '# ' is a comment.
 * name      names of variants, in mode zip or as a column of the table.
 *
 * Values of a key:
 *   5; 10; 20              a list, by ';' or '|'; by '|' alone for text, points and lists of numbers, whose values may hold a ';'. One value is
 *                          the same for all
 *   from 1 to 10 by 3      1, 4, 7, 10
 *   from 1 to 2 in 5       five values, evenly spaced: 1, 1.25, 1.5, 1.75, 2
 *   from 1 to 16 in 5 log  five values, each the same multiple of the one before: 1, 2, 4, 8, 16
 *   uniform(a, b)          by chance, any number from a to b alike; of whole numbers, any of them. uniform(a, b, step): a, a + step, …
 *   log-uniform(a, b)      by chance, any order of magnitude alike
 *   normal(m, s)           by chance, with mean m and standard deviation s; what is outside the key's range becomes the range's end
 *   choice(a; b; c)        by chance, each alike; one that stands there twice is twice as likely
 * In mode sample lists and ranges are drawn from by chance too. In the others what is drawn is drawn anew in every variant.
 *
 * FILE values are relative to the sweep file's folder, in tables too. Numbers have as many digits as tell them apart, 6 at least: their text
 * is the value, so that the variant grown alone with the same texts is the same leaf. */
#ifndef SWEEP_SWEEP_H
#define SWEEP_SWEEP_H

#include "param/params.h"

typedef struct Sweep Sweep;

typedef enum { SWEEP_GRID, SWEEP_ZIP, SWEEP_SAMPLE } SweepMode;

enum { SWEEP_MOST = 999999999 }; /* variants */

/* Reads a sweep file, its table and its parameter file. Errors are of the domain PARAM_ERROR; the message names file, line and key, what was
 * found and what is allowed. All values of lists, ranges and tables are checked, and the ends of distributions. */
Sweep *sweep_load(const char *path, GError **error);

/* The same from text; `path` names it, and FILEs start in its folder. */
Sweep *sweep_parse(const char *text, gsize length, const char *path, GError **error);
void sweep_free(Sweep *s);

SweepMode sweep_mode(const Sweep *s);
const char *sweep_path(const Sweep *s);

/* The parameter file: its path, openable, and what it holds. */
const char *sweep_params_path(const Sweep *s);
const Params *sweep_params(const Sweep *s);

/* 1 … SWEEP_MOST. */
uint64_t sweep_count(const Sweep *s);

/* A text that tells sweeps of other variants apart; comments and places of the files don't matter. Free it. */
char *sweep_checksum(const Sweep *s);

/* The keys of the sweep, in the file's order, those of a table in its columns'. */
typedef struct {
    const char *key; /* "veins.kill_distance"; "seed" for the run's */
    int id;          /* ParamId; -1 for the run's seed */
    bool varies;     /* else it has one value */
    bool drawn;      /* by chance */
    uint32_t axis;   /* keys of one table have the same one, and vary together */
    uint64_t levels; /* values of the axis; 0 where there is no list of them */
} SweepKey;
uint32_t sweep_keys(const Sweep *s);
SweepKey sweep_key(const Sweep *s, uint32_t key);

/* The text of a key at one of its axis's levels, to label a sheet; NULL: the parameter file's value. Free it. Levels there must be. */
char *sweep_level(const Sweep *s, uint32_t key, uint64_t level);

typedef struct {
    uint64_t index;
    char *name;      /* fit for a file name on any system, unlike all others' whatever the case of letters, the same in every run */
    uint64_t seed;   /* of the run */
    uint32_t n;      /* keys */
    char **value;    /* by key, as text to set; NULL: the parameter file's value holds */
    uint64_t *level; /* by key: which of the axis's levels; 0 where it has none */
} SweepVariant;

/* Variant `index`, below sweep_count; of index alone, whichever were asked for before. O(keys). May be called from any number of threads.
 * Clear it with sweep_variant_clear. */
void sweep_variant(const Sweep *s, uint64_t index, SweepVariant *out);
void sweep_variant_clear(SweepVariant *v);

/* Sets the variant's values over `p`, a copy of sweep_params or what the caller has set over it, as params_override does, but for FILE
 * values, which start in the sweep file's folder and are kept as they were written. */
gboolean sweep_apply(const Sweep *s, const SweepVariant *v, Params *p, GError **error);

#endif
