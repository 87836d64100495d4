/* What the files of the contact sheet share. */
#ifndef BATCH_SHEET_PRIVATE_H
#define BATCH_SHEET_PRIVATE_H

#include <stdbool.h>

#include "batch/sheet.h"

/* ---- what is told where (sheet_plan.c) ---- */

enum { NAME_ITEM = UINT32_MAX };

/* What varies and is told: a key, or the names that a table or list gives. */
typedef struct {
    uint32_t key;  /* of the sweep, or NAME_ITEM */
    uint32_t axis; /* of the sweep */
} SheetItem;

/* The items of an axis, told together. */
typedef struct {
    uint32_t axis;
    uint64_t levels;
    GArray *item; /* SheetItem */
} SheetAxis;

/* Cells lie in lines of `columns`, lines in groups. In a matrix a line is one level of the axis before the last, and a column one of the last. */
typedef struct {
    const Sweep *s;
    const char *out;
    GPtrArray *axis; /* SheetAxis: those that the place of a cell tells, outermost first; one that flows is not among them */
    GArray *told;    /* SheetItem: by captions */
    int *digits;     /* by key of the sweep: of numbers that are shown */
    bool matrix;
    bool specimen;   /* the pictures show colours */
    bool numbered;   /* captions tell the variant's number */
    bool lettered;   /* a, b, c … */
    uint32_t columns;
    uint32_t group_axes; /* of `axis`, told by the head of a group */
    uint64_t group_cells, groups, group_lines;
    uint64_t lines, sheet_lines, sheets;
    uint32_t picture_width, picture_height; /* of a cell, pixels */
} SheetPlan;

SheetPlan *sheet_plan_new(const Sweep *s, const char *out, const SheetDef *def);
void sheet_plan_free(SheetPlan *p);

/* Keeps, of items that are more than so many, those whose values differ most between leaves, in their order (sheet_choose.c): the mean difference of two
 * leaves, of numbers as part of the largest, of words whether they differ. Ties: the first; and none that follows from another. */
enum { SHEET_MOST_TOLD = 3 };
void sheet_choose(const SheetPlan *p, GArray *items);

/* A line's group, its first variant and how many it has. */
typedef struct {
    uint64_t group, first;
    uint32_t cells;
    bool opens; /* the group */
} SheetLine;
SheetLine sheet_plan_line(const SheetPlan *p, uint64_t line);

/* The level of placed axis `i` for a variant. */
uint64_t sheet_plan_level(const SheetPlan *p, uint32_t i, uint64_t index);

/* What an item is called, and its value at a level of its axis or in a variant. */
typedef struct {
    char *label, *value; /* label "": the value speaks for itself */
    int colour;          /* 0xRRGGBB, -1: none */
} SheetFact;
char *sheet_item_label(const SheetPlan *p, const SheetItem *item);
SheetFact sheet_level_fact(const SheetPlan *p, const SheetItem *item, uint64_t level);
SheetFact sheet_variant_fact(const SheetPlan *p, const SheetItem *item, const SweepVariant *v);
void sheet_fact_clear(SheetFact *f);

/* ---- drawing: bands of the sheet's width, each from its own top (sheet_draw.c, sheet_cell.c) ---- */

typedef struct {
    int margin, gap_x, gap_y, left, cell, width; /* left: of row heads; cell: a picture's width, or more where its caption needs it */
    int title, head, axis, value, label, note; /* letters' sizes; head: what stands below the title */
    int caption;                           /* height */
    bool plain;                            /* one item is told: no label at each cell */
} SheetSizes;

typedef struct {
    const SheetPlan *plan;
    SheetSizes size;
    const char *title, *staging;
    Watch watch;
    uint64_t sheet; /* from 0 */
} Sheet;

/* One horizontal part. */
typedef struct {
    GString *svg;
    int height;
} SheetBand;

void sheet_sizes(Sheet *sheet);
void sheet_style(const Sheet *sheet, GString *svg);
int sheet_column_x(const Sheet *sheet, uint32_t column);

/* Title, what varies, what doesn't; column heads. */
void sheet_draw_head(const Sheet *sheet, SheetBand *band);
void sheet_draw_columns(const Sheet *sheet, SheetBand *band);
void sheet_draw_group(const Sheet *sheet, uint64_t group, bool goes_on, SheetBand *band);
/* A line in parts: the row's head, then its cells. */
uint32_t sheet_line_parts(const Sheet *sheet, uint64_t line);
void sheet_draw_part(const Sheet *sheet, uint64_t line, uint32_t part, GString *svg);
void sheet_draw_foot(const Sheet *sheet, uint32_t failed, uint32_t missing, SheetBand *band);
int sheet_line_height(const Sheet *sheet);

typedef enum { AT_START, AT_MIDDLE, AT_END } SheetAnchor;
void sheet_text(GString *svg, int x, int y, const char *style, SheetAnchor anchor, const char *text);
void sheet_fact(GString *svg, const SheetSizes *size, int x, int y, int room, SheetAnchor anchor, const char *letter, const SheetFact *f);
void sheet_cell(const Sheet *sheet, const Row *row, int x, GString *svg);

/* Size of a PNG file; FALSE if it is none. */
bool sheet_picture_size(const char *path, uint32_t *width, uint32_t *height);

/* ---- the PNG, stripe by stripe (sheet_png.c) ---- */

typedef struct SheetPng SheetPng;
SheetPng *sheet_png_begin(const char *path, int width, int height, GError **error);
int sheet_png_stripe(const SheetPng *png, int height); /* rows that a stripe of such a band has at the most */
gboolean sheet_png_begin_stripe(SheetPng *png, int rows, GError **error);
/* Draws a part of a band as high as `height`; the stripe begins at the band's row `top`. */
gboolean sheet_png_draw(SheetPng *png, const char *style, const GString *svg, int height, int top, GError **error);
gboolean sheet_png_end_stripe(SheetPng *png, GError **error);
gboolean sheet_png_end(SheetPng *png, GError **error);
void sheet_png_abort(SheetPng *png);

#endif
