/* One cell: its picture, or why there is none, and its caption. */
#include <stdio.h>
#include <string.h>

#include "batch/sheet_label.h"
#include "batch/sheet_private.h"
#include "geom/textfile.h"

enum { MOST_PICTURE = 32 << 20, PNG_HEAD = 24 };

static bool is_png(const char *data, gsize n)
{
    return n >= PNG_HEAD && memcmp(data, "\x89PNG\r\n\x1a\n", 8) == 0 && memcmp(data + 12, "IHDR", 4) == 0;
}

static uint32_t big_endian(const char *at)
{
    const uint8_t *b = (const uint8_t *)at;
    return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
}

bool sheet_picture_size(const char *path, uint32_t *width, uint32_t *height)
{
    char head[PNG_HEAD];
    FILE *f = fopen(path, "rb");
    gsize n = f ? fread(head, 1, PNG_HEAD, f) : 0;
    if (f)
        fclose(f);
    *width = *height = 0;
    if (is_png(head, n)) {
        *width = big_endian(head + 16);
        *height = big_endian(head + 20);
    }
    return *width > 0 && *height > 0 && *width <= 1u << 20 && *height <= 1u << 20;
}

void sheet_text(GString *svg, int x, int y, const char *style, SheetAnchor anchor, const char *text)
{
    static const char *const word[] = {"", " text-anchor=\"middle\"", " text-anchor=\"end\""};
    g_string_append_printf(svg, "<text x=\"%d\" y=\"%d\" class=\"%s\"%s>", x, y, style, word[anchor]);
    label_xml(svg, text);
    g_string_append(svg, "</text>\n");
}

/* A letter in bold, what it is called, grey, and the value; a colour as a patch before it. Both are cut to the room, the name first. */
void sheet_fact(GString *svg, const SheetSizes *size, int x, int y, int room, SheetAnchor anchor, const char *letter, const SheetFact *f)
{
    static const char *const word[] = {"start", "middle", "end"};
    double patch = f->colour >= 0 ? 1.2 * size->value : 0.0, between = *f->label ? 0.45 * size->label : 0.0,
           label = label_width(f->label) * size->label, value = label_width(f->value) * size->value, rest = room - patch - between - (letter ? 1.8 * size->value : 0.0);
    label = MIN(label, MAX(rest - value, 0.4 * rest));
    char *name = label_fit(f->label, label / size->label + 1e-9), *text = label_fit(f->value, (rest - label) / size->value);
    g_string_append_printf(svg, "<text x=\"%d\" y=\"%d\" text-anchor=\"%s\">", x, y, word[anchor]);
    int dx = 0;
    if (letter) {
        g_string_append_printf(svg, "<tspan class=\"b\">%s</tspan>", letter);
        dx = size->value * 3 / 4;
    }
    if (*f->label) {
        g_string_append_printf(svg, "<tspan class=\"l\" dx=\"%d\">", dx);
        label_xml(svg, name);
        g_string_append(svg, "</tspan>");
        dx = (int)(between + 0.5);
    }
    g_string_append_printf(svg, "<tspan class=\"v\" dx=\"%d\">", dx);
    if (f->colour >= 0)
        g_string_append_printf(svg, "<tspan fill=\"#%06x\" stroke=\"#999\" stroke-width=\"0.6\">■</tspan> ", (unsigned)f->colour);
    label_xml(svg, text);
    g_string_append(svg, "</tspan></text>\n");
    g_free(name);
    g_free(text);
}

/* ---- the picture ---- */

static bool put_picture(const Sheet *sheet, const Row *row, int x, GString *svg)
{
    char *path = row->picture ? g_build_filename(sheet->plan->out, row->picture, NULL) : NULL, *data = NULL;
    gsize n = 0;
    bool good = path && textfile_read(path, MOST_PICTURE, &data, &n, NULL) && is_png(data, n);
    if (good) {
        char *text = g_base64_encode((const guchar *)data, n);
        g_string_append_printf(svg, "<image x=\"%d\" y=\"0\" width=\"%u\" height=\"%u\" href=\"data:image/png;base64,", x, sheet->plan->picture_width,
                               sheet->plan->picture_height);
        g_string_append(svg, text);
        g_string_append(svg, "\"/>\n");
        g_free(text);
    }
    g_free(data);
    g_free(path);
    return good;
}

/* A plain box that says what became of the variant. */
static void put_box(const Sheet *sheet, const Row *row, int x, GString *svg)
{
    static const char *const word[] = {"no picture", "failed", "missing"};
    const SheetSizes *z = &sheet->size;
    int w = (int)sheet->plan->picture_width, h = (int)sheet->plan->picture_height, inset = z->label, step = z->note * 13 / 10;
    uint32_t most = (uint32_t)MAX((h - 4 * z->label) / step, 0);
    char **lines = label_wrap(row->outcome == ROW_FAILED && row->error ? row->error : "", (double)(w - 2 * inset) / z->note, MIN(most, 8));
    int n = (int)g_strv_length(lines), y = (h - n * step) / 2;
    g_string_append_printf(svg, "<rect x=\"%d.5\" y=\"0.5\" width=\"%d\" height=\"%d\" rx=\"2\" class=\"%s\"/>\n", x, w - 1, h - 1,
                           row->outcome == ROW_MISSING ? "none" : "box");
    char *said = label_fit(word[row->outcome], (w - 2.0) / z->label);
    if (h > z->label * 3 / 2)
        sheet_text(svg, x + w / 2, y + z->label / 3, "w", AT_MIDDLE, said);
    g_free(said);
    for (int i = 0; i < n; i++)
        sheet_text(svg, x + w / 2, y + z->label / 3 + (i + 1) * step + step / 4, "n", AT_MIDDLE, lines[i]);
    g_strfreev(lines);
}

/* ---- the caption ---- */

static void put_caption(const Sheet *sheet, const Row *row, int x, GString *svg)
{
    const SheetPlan *p = sheet->plan;
    const SheetSizes *z = &sheet->size;
    int middle = x + z->cell / 2, y = (int)p->picture_height + z->value * 3 / 2, room = z->cell + z->gap_x / 2;
    if (p->numbered) {
        char *number = g_strdup_printf("%" G_GUINT64_FORMAT, row->index);
        sheet_text(svg, middle, y, "b", AT_MIDDLE, number);
        g_free(number);
        y += z->value * 4 / 3;
    }
    char letter[2] = {(char)('a' + row->index % 26), '\0'};
    for (guint i = 0; i < p->told->len; i++) {
        SheetFact f = sheet_variant_fact(p, &g_array_index(p->told, SheetItem, i), &row->variant);
        if (z->plain)
            *f.label = '\0';
        sheet_fact(svg, z, middle, y, room, AT_MIDDLE, p->lettered && i == 0 ? letter : NULL, &f);
        sheet_fact_clear(&f);
        y += z->value * 4 / 3;
    }
}

void sheet_cell(const Sheet *sheet, const Row *row, int x, GString *svg)
{
    int inner = x + (sheet->size.cell - (int)sheet->plan->picture_width) / 2;
    if (!put_picture(sheet, row, inner, svg))
        put_box(sheet, row, inner, svg);
    put_caption(sheet, row, x, svg);
}
