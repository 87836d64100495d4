/* What the files of this room share. */
#ifndef SWEEP_PRIVATE_H
#define SWEEP_PRIVATE_H

#include "sweep/sweep.h"

/* What a value is for: a line of the parameter table, the run's seed, or the variant's name. */
typedef struct {
    int id; /* ParamId, FIELD_SEED or FIELD_NAME */
    const ParamInfo *info;
    char *key;         /* "veins.kill_distance" */
    const char *label; /* in names: the key alone where that is clear */
    bool varies;
} SweepField;
enum { FIELD_SEED = -1, FIELD_NAME = -2 };
#define MOST_SEED 9007199254740992u /* 2^53: every tool that reads a manifest holds it exactly */

typedef enum {
    AXIS_LIST,  /* cell[] */
    AXIS_STEPS, /* low + k step */
    AXIS_EVEN,  /* low … high */
    AXIS_LOG,
    AXIS_UNIFORM, /* from here on: no levels */
    AXIS_LOG_UNIFORM,
    AXIS_NORMAL, /* low is the mean, high the standard deviation */
    AXIS_EACH,   /* seeds that follow each other */
} SweepAxisKind;

/* What varies as one: a key, or the columns of a table. */
typedef struct {
    SweepAxisKind kind;
    SweepField *field;
    uint32_t fields;
    uint64_t levels, stride; /* stride: variants of a grid for which the level stays */
    char **cell;             /* of AXIS_LIST: [level * fields + field], NULL: not given */
    char **label;            /* of AXIS_LIST: by level, fit for a name */
    bool table, named;       /* named: the labels are the user's */
    bool drawn;              /* by chance, whatever the mode */
    bool whole;
    bool alike;      /* some labels are equal */
    uint32_t longest; /* label, bytes */
    double low, high, step;
    int digits;
    uint32_t key, base; /* of the chance: random's by the key's name, Halton's prime */
    uint16_t *digit;    /* of Halton's sequence: what a digit becomes, [place * base + digit] */
    uint32_t places;
    unsigned line;
} SweepAxis;

struct Sweep {
    char *path, *folder, *params_path;
    Params *params;
    SweepMode mode;
    GArray *axis; /* SweepAxis */
    uint64_t count, sample_seed;
    bool halton;
    bool by_index, by_label; /* what names are made of */
};

/* Where something was found, for messages. */
typedef struct {
    const char *path;
    unsigned line; /* 0: the whole file */
    bool table;    /* a CSV file */
} Spot;

/* "FILE:LINE: [sweep] KEY …" with the rest by `format`; `key` may be NULL. Returns FALSE. */
gboolean sweep_fail(const Spot *spot, const char *key, ParamErrorCode code, GError **error, const char *format, ...) G_GNUC_PRINTF(5, 6);

/* Refuses the value found: "KEY = FOUND: must be …". Returns FALSE. */
gboolean sweep_refuse(const Spot *spot, const SweepField *f, const char *found, GError **error);

/* The field that `key` names, with a message as to why there is none. `out->key` is the caller's to free. */
gboolean sweep_field(const Spot *spot, const char *key, SweepField *out, GError **error);
char *sweep_unknown(const char *key); /* hint */

/* Checks a value and gives the one text that stands for it; NULL with an error. Free it. */
char *sweep_value(const Spot *spot, const SweepField *f, const char *text, GError **error);

/* Reads the values of a key into `axis`, whose one field is set. */
gboolean sweep_axis_read(SweepAxis *axis, const char *text, const Spot *spot, GError **error);
gboolean sweep_axis_read_range(SweepAxis *axis, const char *text, const Spot *spot, GError **error);
gboolean sweep_axis_read_table(SweepAxis *axis, const char *path, GError **error);
gboolean sweep_axis_read_distribution(SweepAxis *axis, const char *text, bool *is_one, const Spot *spot, GError **error);
void sweep_axis_clear(SweepAxis *axis);
bool sweep_axis_varies(const SweepAxis *axis);

bool sweep_field_is_number(const SweepField *f); /* so that ranges and distributions of numbers suit it */
bool sweep_field_is_whole(const SweepField *f);
bool sweep_field_allows(const SweepField *f, double value);
char *sweep_field_allowed(const SweepField *f);

/* Reads a finite number. */
bool sweep_number(const char *text, double *out);

/* Digits that tell numbers up to `largest` apart which are `gap` apart, with some to spare; 0: there are too few. */
int sweep_digits(double largest, double gap, int least);

/* A number rounded to so many digits, as the parameter table writes it; whole ones are rounded to whole. Free it. */
char *sweep_number_text(double value, int digits, bool whole);

/* The text of a level of an axis with one field, or of a draw with u in [0, 1). Free it. */
char *sweep_axis_level_text(const SweepAxis *axis, uint64_t level);
char *sweep_axis_draw_text(const SweepAxis *axis, double u);

/* Chance: in [0, 1), for an axis and a variant. */
double sweep_chance(const Sweep *s, const SweepAxis *axis, uint64_t index);
void sweep_seat_digits(const Sweep *s, SweepAxis *axis); /* once, for Halton's sequence */

/* The number below which a normal variable stays with probability u. */
double sweep_normal(double u);

/* Names. */
char *sweep_label(const SweepField *f, const char *text); /* part of a name; no '_' in it */
void sweep_axis_label(SweepAxis *axis);                   /* of AXIS_LIST and ranges */
gboolean sweep_check_name(const Spot *spot, const char *name, GError **error);
void sweep_plan_names(Sweep *s);
char *sweep_name(const Sweep *s, const SweepVariant *v);

#endif
