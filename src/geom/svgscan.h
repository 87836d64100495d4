/* Numbers and separators of SVG's small languages (path data, transforms), with errors that name the character. */
#ifndef GEOM_SVGSCAN_H
#define GEOM_SVGSCAN_H

#include <glib.h>
#include <stdbool.h>

#include "geom/outline.h"

/* Nothing larger is a drawing; squares and products of such numbers still fit a double. */
#define SVG_LARGEST 1e60

typedef struct {
    const char *text, *at; /* the whole, and what is still to be read */
} SvgScan;

void svgscan_space(SvgScan *s);

/* Skips space with at most one comma in it; whether there was one. */
bool svgscan_comma(SvgScan *s);

/* Whether a number begins here. */
bool svgscan_at_number(const SvgScan *s);

/* Reads a number, or a flag: one character, 0 or 1. */
bool svgscan_number(SvgScan *s, double *value, GError **error);
bool svgscan_flag(SvgScan *s, double *value, GError **error);

/* Sets "at character 17: expected a number, found 'q'"; always false. */
bool svgscan_fail(const SvgScan *s, const char *expected, GError **error);

#endif
