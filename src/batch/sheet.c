#include "batch/sheet.h"

#include <errno.h>
#include <glib/gstdio.h>
#include <string.h>

#include "batch/private.h"
#include "batch/sheet_label.h"
#include "batch/sheet_private.h"
#include "image/staged.h"

enum { DEFAULT_CELL = 320, LEAST_CELL = 32, MOST_CELL = 2048, MOST_WIDTH = 20000 }; /* pixels; wider ones, as of many columns, have smaller cells */

/* "sheet.svg", "sheet-2.svg" …, in a folder or by itself. */
static char *file_name(const char *out, uint64_t sheet, const char *ending)
{
    char *base = sheet ? g_strdup_printf("sheet-%" G_GUINT64_FORMAT ".%s", sheet + 1, ending) : g_strdup_printf("sheet.%s", ending);
    char *path = out ? g_build_filename(out, base, NULL) : g_strdup(base);
    g_free(base);
    return path;
}

/* A sheet's files while they are written. First the height of all is summed up, without them. */
typedef struct {
    const Sheet *sheet;
    uint32_t failed, missing;
    SheetPng *png; /* NULL: only to measure */
    Staged svg;
    GString *style;
    SheetBand band;
    int y;
} Writer;

static gboolean put_text(Writer *w, const GString *text, GError **error)
{
    if (fwrite(text->str, 1, text->len, w->svg.file) == text->len)
        return TRUE;
    staged_error(w->svg.path, errno, error);
    return FALSE;
}

/* One part of a band: drawn onto the stripe that begins at `top`, written with the first stripe. */
static gboolean put_part(Writer *w, int top, GError **error)
{
    return w->band.svg->len == 0 || (sheet_png_draw(w->png, w->style->str, w->band.svg, w->band.height, top, error) && (top > 0 || put_text(w, w->band.svg, error)));
}

/* A band, stripe by stripe: what is drawn already, or a line of cells part by part, anew for each stripe. */
static gboolean put_stripes(Writer *w, const uint64_t *line, GError **error)
{
    uint32_t parts = line ? sheet_line_parts(w->sheet, *line) : 1;
    int height = w->band.height, most = sheet_png_stripe(w->png, height);
    gboolean ok = TRUE;
    for (int top = 0; ok && top < height; top += most) {
        ok = sheet_png_begin_stripe(w->png, MIN(most, height - top), error);
        for (uint32_t i = 0; ok && i < parts; i++) {
            if (line) {
                g_string_truncate(w->band.svg, 0);
                sheet_draw_part(w->sheet, *line, i, w->band.svg);
            }
            ok = put_part(w, top, error);
        }
        ok = ok && sheet_png_end_stripe(w->png, error);
    }
    return ok;
}

/* `line`: of cells; NULL: what is drawn already. */
static gboolean put_band(Writer *w, const uint64_t *line, GError **error)
{
    gboolean ok = TRUE;
    if (w->png && w->band.height) {
        ok = fprintf(w->svg.file, "<g transform=\"translate(0,%d)\">\n", w->y) >= 0 && put_stripes(w, line, error);
        ok = ok && fputs("</g>\n", w->svg.file) >= 0;
        if (!ok && !(error && *error))
            staged_error(w->svg.path, errno, error);
    }
    w->y += w->band.height;
    g_string_truncate(w->band.svg, 0);
    w->band.height = 0;
    return ok;
}

/* Bands from top to bottom. */
static gboolean put_bands(Writer *w, GError **error)
{
    const Sheet *sheet = w->sheet;
    const SheetPlan *p = sheet->plan;
    uint64_t from = sheet->sheet * p->sheet_lines, to = MIN(from + p->sheet_lines, p->lines);
    w->y = 0;
    sheet_draw_head(sheet, &w->band);
    gboolean ok = put_band(w, NULL, error);
    sheet_draw_columns(sheet, &w->band);
    ok = ok && put_band(w, NULL, error);
    for (uint64_t line = from; ok && line < to; line++) {
        SheetLine at = sheet_plan_line(p, line);
        if (at.opens || line == from)
            sheet_draw_group(sheet, at.group, !at.opens, &w->band);
        ok = put_band(w, NULL, error);
        w->band.height = sheet_line_height(sheet);
        ok = ok && put_band(w, &line, error) && (!w->png || watch_tick(&sheet->watch, (double)(line + 1) / (double)p->lines, error));
    }
    sheet_draw_foot(sheet, w->failed, w->missing, &w->band);
    return ok && put_band(w, NULL, error);
}

static void count_outcomes(Writer *w)
{
    const SheetPlan *p = w->sheet->plan;
    uint64_t from = w->sheet->sheet * p->sheet_lines, to = MIN(from + p->sheet_lines, p->lines);
    SheetLine first = sheet_plan_line(p, from), last = sheet_plan_line(p, to - 1);
    for (uint64_t i = first.first; i < last.first + last.cells; i++) {
        Row row;
        row_read(p->s, p->out, i, &row);
        w->failed += row.outcome == ROW_FAILED;
        w->missing += row.outcome == ROW_MISSING;
        row_clear(&row);
    }
}

static gboolean put_svg_head(Writer *w, int height, GError **error)
{
    int width = w->sheet->size.width;
    GString *s = g_string_new("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\"");
    g_string_append_printf(s, " width=\"%d\" height=\"%d\" viewBox=\"0 0 %d %d\">\n<title>", width, height, width, height);
    label_xml(s, w->sheet->title);
    g_string_append_printf(s, "</title>\n%s<rect width=\"%d\" height=\"%d\" fill=\"#fff\"/>\n", w->style->str, width, height);
    gboolean ok = put_text(w, s, error);
    g_string_free(s, TRUE);
    return ok;
}

static gboolean put_svg_end(Writer *w, GError **error)
{
    g_string_assign(w->band.svg, "</svg>\n");
    return put_text(w, w->band.svg, error);
}

static gboolean write_files(Writer *w, const char *svg, const char *png, GError **error)
{
    count_outcomes(w);
    put_bands(w, NULL); /* measures */
    int height = w->y;
    if (!staged_open(&w->svg, svg, error))
        return FALSE;
    w->png = sheet_png_begin(png, w->sheet->size.width, height, error);
    if (!w->png || !put_svg_head(w, height, error) || !put_bands(w, error) || !put_svg_end(w, error) || !staged_commit(&w->svg, error)) {
        staged_abort(&w->svg);
        sheet_png_abort(w->png);
        return FALSE;
    }
    return sheet_png_end(w->png, error);
}

static gboolean move_sheet(const Sheet *sheet, GError **error)
{
    char *svg = file_name(NULL, sheet->sheet, "svg"), *png = file_name(NULL, sheet->sheet, "png");
    gboolean ok = batch_place_file(sheet->staging, sheet->plan->out, svg, error) && batch_place_file(sheet->staging, sheet->plan->out, png, error);
    g_free(svg);
    g_free(png);
    return ok;
}

static gboolean write_sheet(const Sheet *sheet, GError **error)
{
    Writer w = {.sheet = sheet, .style = g_string_new(NULL), .band.svg = g_string_new(NULL)};
    const char *in = sheet->staging ? sheet->staging : sheet->plan->out;
    char *svg = file_name(in, sheet->sheet, "svg"), *png = file_name(in, sheet->sheet, "png");
    sheet_style(sheet, w.style);
    gboolean ok = write_files(&w, svg, png, error) && (!sheet->staging || move_sheet(sheet, error));
    g_string_free(w.style, TRUE);
    g_string_free(w.band.svg, TRUE);
    g_free(svg);
    g_free(png);
    return ok;
}

/* Sheets of a former, larger sweep. */
static void remove_rest(const char *out, uint64_t sheets)
{
    for (bool found = true; found; sheets++) {
        char *svg = file_name(out, sheets, "svg"), *png = file_name(out, sheets, "png");
        found = g_unlink(svg) == 0;
        found |= g_unlink(png) == 0;
        g_free(svg);
        g_free(png);
    }
}

gboolean sheet_write(const Sweep *s, const char *out, const SheetDef *def, GError **error)
{
    char *own = g_path_get_basename(sweep_path(s));
    if (g_str_has_suffix(own, ".ini"))
        own[strlen(own) - 4] = '\0';
    Sheet sheet = {.title = def->title ? def->title : own, .staging = def->staging, .watch = def->watch};
    SheetDef fitted = *def;
    for (fitted.cell = def->cell ? CLAMP(def->cell, LEAST_CELL, MOST_CELL) : DEFAULT_CELL;; fitted.cell = MAX(fitted.cell * MOST_WIDTH / (uint32_t)sheet.size.width, LEAST_CELL)) {
        sheet.plan = sheet_plan_new(s, out, &fitted);
        sheet_sizes(&sheet);
        if (sheet.size.width <= MOST_WIDTH || fitted.cell == LEAST_CELL)
            break;
        sheet_plan_free((SheetPlan *)sheet.plan);
    }
    gboolean ok = TRUE;
    for (; ok && sheet.sheet < sheet.plan->sheets; sheet.sheet++)
        ok = write_sheet(&sheet, error);
    if (ok)
        remove_rest(out, sheet.plan->sheets);
    sheet_plan_free((SheetPlan *)sheet.plan);
    g_free(own);
    return ok;
}
