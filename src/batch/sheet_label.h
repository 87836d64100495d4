/* Keys and values of a sweep as people read them: short, and fitted to a width. */
#ifndef BATCH_SHEET_LABEL_H
#define BATCH_SHEET_LABEL_H

#include "sweep/sweep.h"

/* "kill distance" of veins.kill_distance; "width minimum" where one word says too little, or another key of the sweep ends alike. Free it. */
char *label_key(const Sweep *s, uint32_t key);

/* "segments"; "" where there is nothing to tell. */
const char *label_unit(const SweepKey *key);

/* A value made short; `text` NULL: the parameter file's. Numbers with `digits` digits at most. Free it. */
char *label_value(const Sweep *s, const SweepKey *key, const char *text, int digits);

/* The colour a value stands for, 0xRRGGBB, or -1. */
int label_colour(const SweepKey *key, const char *text);

/* Width of a text in em: DejaVu Sans', which is as wide as fonts for text get, so that what fits fits in others, too. */
double label_width(const char *text);

/* The text, cut with an ellipsis where it is wider. Free it. */
char *label_fit(const char *text, double em);

/* The text in lines of a width, at most so many, the last one cut. Free it with g_strfreev. */
char **label_wrap(const char *text, double em, uint32_t most);

/* Adds text for XML: valid UTF-8 without the characters that XML 1.0 forbids. */
void label_xml(GString *s, const char *text);

#endif
