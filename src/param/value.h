/* One value of the parameter table: text to value and back. */
#ifndef PARAM_VALUE_H
#define PARAM_VALUE_H

#include "param/params.h"

typedef struct {
    char *text;      /* TEXT; FILE as it was written */
    double number;   /* NUMBER */
    int64_t integer; /* INTEGER; SWITCH 0 or 1; CHOICE its index; COLOUR 0xRRGGBB */
    double *list;    /* NUMBERS, POINTS */
    uint32_t n;      /* numbers, or points */
} Value;

/* Reads `text`, spaces around it aside. FALSE, and nothing in `out`, when the table doesn't allow it. */
bool value_parse(const ParamInfo *info, const char *text, Value *out);
void value_clear(Value *v);
Value value_copy(const ParamInfo *info, const Value *v);

/* The text that value_parse reads back to the same bits; free it. */
char *value_format(const ParamInfo *info, const Value *v);

/* What more to tell of a value that was refused: the nearest choice, a comment in the wrong place; or NULL. Free it. */
char *value_hint(const ParamInfo *info, const char *text);

#endif
