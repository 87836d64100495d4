/* The contact sheet of a sweep: a labelled grid picture of all variants, like fig. 9 of Runions et al. 2005. */
#ifndef BATCH_SHEET_H
#define BATCH_SHEET_H

#include "batch/rows.h"
#include "batch/watch.h"

enum { SHEET_MOST_CELLS = 600 }; /* of one sheet, fewer if they are large; larger sweeps have several */

typedef struct {
    uint32_t cell;     /* pixels of a cell's picture in the PNG, longer side; 0: 320. Less where a row of them would be too wide for a picture file */
    gboolean specimen; /* pictures are of leaves in their colours, not of veins alone: colours and light are worth telling */
    const char *title; /* NULL: the sweep file's name */
    const char *staging; /* where files are made; NULL: beside their places */
    Watch watch;
} SheetDef;

/* Writes <out>/sheet.svg and <out>/sheet.png (sheet-2.svg … where one does not hold all) from the variants' rows and pictures. Pictures are inside the
 * SVG; the PNG is the SVG as librsvg draws it. Memory goes neither with the sweep nor, below 320 pixels a cell, with the sheet. Each file appears whole. */
gboolean sheet_write(const Sweep *s, const char *out, const SheetDef *def, GError **error);

#endif
