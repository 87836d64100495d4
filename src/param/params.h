/* Values of the parameter table (table.def): defaults, parameter files, overrides. */
#ifndef PARAM_PARAMS_H
#define PARAM_PARAMS_H

#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

#define P(id, ...) PARAM_##id,
typedef enum {
#include "param/table.def"
    PARAM_COUNT
} ParamId;
#undef P

typedef enum { TYPE_NUMBER, TYPE_INTEGER, TYPE_SWITCH, TYPE_CHOICE, TYPE_TEXT, TYPE_FILE, TYPE_COLOUR, TYPE_NUMBERS, TYPE_POINTS } ParamType;

/* One line of the table. */
typedef struct {
    const char *section, *key;
    ParamType type;
    const char *unit, *initial;
    double low, high;
    const char *choices, *doc;
} ParamInfo;

const ParamInfo *param_info(ParamId id);

/* Id of "section.key", or -1. */
int param_find(const char *dotted);

/* What the table allows, in words: "a number from 0 to 1e6 (segments)". Free it. */
char *param_allowed(ParamId id);

typedef enum {
    PARAM_ERROR_FILE,    /* the file can't be read or is no key file */
    PARAM_ERROR_UNKNOWN, /* no such section or key */
    PARAM_ERROR_VALUE,   /* not of the type, or out of range */
} ParamErrorCode;
#define PARAM_ERROR param_error_quark()
GQuark param_error_quark(void);

typedef struct Params Params;

Params *params_new(void); /* all defaults */
Params *params_copy(const Params *p);
void params_free(Params *p);

/* Reads a key file over the defaults. On error returns NULL; the message names file, line, section and key, the value
 * found and the values allowed, and for an unknown name the nearest known one. */
Params *params_load(const char *path, GError **error);

/* The same from `length` bytes of text; `path` names them in messages and its folder is where FILE values start. */
Params *params_parse(const char *text, gsize length, const char *path, GError **error);

/* Sets one parameter from "section.key=value"; FILE values given so are relative to the working folder. An override of
 * outline.path or outline.file displaces the other one if that is a file's, and so do sources.file and a sources.placement
 * other than list. */
gboolean params_override(Params *p, const char *assignment, GError **error);

/* The same with key and value apart; `origin` names the place for messages: "--set", or the option that was typed instead
 * ("--size"). */
gboolean params_set(Params *p, ParamId id, const char *value, const char *origin, GError **error);

/* Values. The type must be the table's. */
double params_number(const Params *p, ParamId id);
int64_t params_integer(const Params *p, ParamId id);
bool params_switch(const Params *p, ParamId id);
int params_choice(const Params *p, ParamId id);          /* index into choices */
const char *params_text(const Params *p, ParamId id);    /* TEXT, and FILE as an openable path; "" when empty */
uint32_t params_colour(const Params *p, ParamId id);     /* 0xRRGGBB */
const double *params_list(const Params *p, ParamId id, uint32_t *n); /* NUMBERS: n numbers; POINTS: n pairs */

/* Whether the value was given by a file or an override, and by which ("params/poplar.ini", "--set"). */
bool params_is_given(const Params *p, ParamId id);
const char *params_origin(const Params *p, ParamId id);

/* Where the value was given, for messages: "params/poplar.ini: [outline] file", "--set outline.file", "--maps". Free it. */
char *params_place(const Params *p, ParamId id);

/* The value as text that reads back to the same bits (numbers in the shortest such form); free it. FILE values as they were written. */
char *params_format(const Params *p, ParamId id);

/* The whole set as a key file, sections and keys in table order; reads back to equal params. Free it. */
char *params_to_file(const Params *p);

/* 64-bit hash of all values (FNV-1a over params_to_file). */
uint64_t params_hash(const Params *p);

#endif
