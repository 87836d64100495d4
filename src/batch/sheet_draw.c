/* The sheet in bands from top to bottom: title and what varies, heads of columns, heads of groups, lines of cells, and what is missing. Sizes are in pixels
 * and go with the cell's. */
#include <string.h>

#include "batch/sheet_label.h"
#include "batch/sheet_private.h"
#include "geom/vec.h"

enum { MOST_MEASURED = 600, WIDEST_CAPTION = 13, WIDEST_HEAD = 560 };

static const SheetAxis *axis_from_end(const SheetPlan *p, guint i) { return p->axis->pdata[p->axis->len - i]; }

static const SheetItem *item_at(const GArray *items, guint i) { return &g_array_index(items, SheetItem, i); }

static double fact_width(const SheetSizes *z, const SheetFact *f, bool labelled)
{
    return label_width(f->value) * z->value + (labelled && *f->label ? (label_width(f->label) + 0.45) * z->label : 0.0) + (f->colour >= 0 ? 1.2 * z->value : 0.0);
}

/* How many there are and what they have in common. */
static char *describe(const SheetPlan *p)
{
    uint64_t count = sweep_count(p->s);
    char *file = g_path_get_basename(sweep_params_path(p->s));
    GString *s = g_string_new(NULL);
    g_string_append_printf(s, "%" G_GUINT64_FORMAT " variant%s of %s", count, count == 1 ? "" : "s", file);
    bool first = true;
    for (uint32_t k = 0; k < sweep_keys(p->s); k++) {
        SweepKey key = sweep_key(p->s, k);
        if (key.varies || key.levels != 1 || (key.id >= 0 && param_info((ParamId)key.id)->section == param_info(PARAM_LEAF_TITLE)->section))
            continue;
        char *name = label_key(p->s, k), *text = sweep_level(p->s, k, 0), *value = label_value(p->s, &key, text, 7);
        g_string_append_printf(s, "%s%s %s%s%s", first ? count == 1 ? ", with " : ", all with " : ", ", name, value, *label_unit(&key) ? " " : "", label_unit(&key));
        first = false;
        g_free(name);
        g_free(text);
        g_free(value);
    }
    g_free(file);
    return g_string_free(s, FALSE);
}

/* Room for the heads of rows, and for the name above them. */
static int measure_left(const SheetPlan *p, const SheetSizes *z, uint32_t cell)
{
    if (!p->matrix)
        return 0;
    const SheetAxis *rows = axis_from_end(p, 2);
    double widest = 4.0 * z->value;
    for (guint i = 0; i < rows->item->len; i++) {
        for (uint64_t level = 0; level < MIN(rows->levels, MOST_MEASURED); level++) {
            SheetFact f = sheet_level_fact(p, item_at(rows->item, i), level);
            widest = MAX(widest, fact_width(z, &f, rows->item->len > 1));
            sheet_fact_clear(&f);
        }
        char *name = sheet_item_label(p, item_at(rows->item, i));
        widest = MAX(widest, MIN(label_width(name) * z->axis * 1.12, MAX(0.6 * cell, 10.0 * z->axis)));
        g_free(name);
    }
    return (int)MIN(widest + 1.0, MAX(0.75 * cell, WIDEST_CAPTION * z->value)) + z->gap_x;
}

/* Room for captions and heads of columns, within reason. */
static int measure_cell(const SheetPlan *p, const SheetSizes *z)
{
    double widest = 0.0;
    for (uint64_t v = 0; v < MIN(sweep_count(p->s), MOST_MEASURED) && p->told->len; v++) {
        SweepVariant variant;
        sweep_variant(p->s, v, &variant);
        for (guint i = 0; i < p->told->len; i++) {
            SheetFact f = sheet_variant_fact(p, item_at(p->told, i), &variant);
            widest = MAX(widest, fact_width(z, &f, !z->plain) + (p->lettered ? 1.8 * z->value : 0.0));
            sheet_fact_clear(&f);
        }
        sweep_variant_clear(&variant);
    }
    const SheetAxis *columns = p->matrix ? axis_from_end(p, 1) : NULL;
    for (guint i = 0; columns && i < columns->item->len; i++) {
        for (uint64_t level = 0; level < columns->levels; level++) {
            SheetFact f = sheet_level_fact(p, item_at(columns->item, i), level);
            widest = MAX(widest, fact_width(z, &f, columns->item->len > 1));
            sheet_fact_clear(&f);
        }
    }
    return MAX((int)p->picture_width, (int)MIN(widest + 1.0, (double)WIDEST_CAPTION * z->value));
}

/* What the heads above the cells need not to be cut, within reason. */
static int measure_head(const Sheet *sheet)
{
    const SheetPlan *p = sheet->plan;
    const SheetSizes *z = &sheet->size;
    double widest = label_width(sheet->title) * z->title * 1.12 + (p->sheets > 1 ? 8.0 : 1.5) * z->axis; /* "10 of 12" beside it */
    for (guint i = 0; i < p->told->len; i++) {
        char *name = sheet_item_label(p, item_at(p->told, i));
        widest = MAX(widest, label_width(name) * z->axis * 1.12);
        g_free(name);
    }
    char *note = describe(p);
    widest = MAX(widest, label_width(note) * z->head);
    g_free(note);
    return (int)MIN(widest + 1.0, WIDEST_HEAD);
}

void sheet_sizes(Sheet *sheet)
{
    const SheetPlan *p = sheet->plan;
    uint32_t cell = MAX(p->picture_width, p->picture_height);
    double u = MAX(cell / 320.0, 0.6);
    SheetSizes *z = &sheet->size;
    *z = (SheetSizes){.margin = (int)(36 * u), .gap_x = (int)(22 * u), .gap_y = (int)(20 * u), .value = (int)(17 * u), .label = MAX((int)(14 * u), 9), .note = MAX((int)(13 * u), 9)};
    z->axis = z->value;
    z->plain = p->told->len == 1 && !p->numbered;
    z->left = measure_left(p, z, cell);
    z->cell = measure_cell(p, z);
    int columns = (int)p->columns, content = z->left + columns * z->cell + (columns - 1) * z->gap_x;
    z->title = (int)(26 * u);
    z->head = z->note;
    z->width = MAX(content, measure_head(sheet)) + 2 * z->margin;
    /* Of a large sheet, seen as a whole, the title is still read. */
    double large = MIN(MAX(sqrt(z->width / (1700.0 * u)), 1.0), 3.0);
    z->title = (int)(26 * u * large);
    z->axis = (int)(17 * u * sqrt(large));
    z->head = (int)(13 * u * sqrt(large));
    int lines = (int)p->told->len + p->numbered;
    z->caption = lines ? z->value * 3 / 2 + (lines - 1) * (z->value * 4 / 3) + z->value / 3 : 0;
}

int sheet_column_x(const Sheet *sheet, uint32_t column)
{
    const SheetSizes *z = &sheet->size;
    return z->margin + z->left + (int)column * (z->cell + z->gap_x);
}

void sheet_style(const Sheet *sheet, GString *svg)
{
    const SheetSizes *z = &sheet->size;
    g_string_append_printf(svg,
                           "<style>\n"
                           "text{font-family:Inter,'Source Sans 3','Helvetica Neue',Helvetica,Arial,'Liberation Sans','Noto Sans','DejaVu Sans',sans-serif;"
                           "font-feature-settings:'tnum';fill:#1b1b1b}\n"
                           ".t{font-size:%dpx;font-weight:bold}\n.a,.ab{font-size:%dpx}\n.ab,.b{font-weight:bold}\n.b,.v{font-size:%dpx}\n"
                           ".l{font-size:%dpx;fill:#6a6a6a}\n.n{font-size:%dpx;fill:#757575}\n.h{font-size:%dpx;fill:#757575}\n.u{fill:#6a6a6a}\n"
                           ".w{font-size:%dpx;fill:#5c5c5c}\n"
                           ".r{stroke:#c9c9c9;stroke-width:1}\n.box{fill:#f7f6f3;stroke:#e2e0da}\n.none{fill:none;stroke:#cfcfcf;stroke-dasharray:4 4}\n"
                           "</style>\n",
                           z->title, z->axis, z->value, z->label, z->note, z->head, z->label);
}

/* ---- the head ---- */

/* "kill distance, segments  veins.kill_distance": as much as fits. */
static void put_key(const Sheet *sheet, uint32_t key, int x, int y, int room, SheetAnchor anchor, GString *svg)
{
    static const char *const word[] = {"start", "middle", "end"};
    const SheetSizes *z = &sheet->size;
    SweepKey k = sweep_key(sheet->plan->s, key);
    char *name = label_key(sheet->plan->s, key), *unit = *label_unit(&k) ? g_strdup_printf("(%s)", label_unit(&k)) : g_strdup("");
    double name_width = label_width(name) * z->axis * 1.12, unit_width = (label_width(unit) + 0.4) * z->axis, key_width = (label_width(k.key) + 1.0) * z->head;
    char *shown = label_fit(name, room / (z->axis * 1.12));
    g_string_append_printf(svg, "<text x=\"%d\" y=\"%d\" class=\"a\" text-anchor=\"%s\"><tspan class=\"ab\">", x, y, word[anchor]);
    label_xml(svg, shown);
    g_string_append(svg, "</tspan>");
    if (*unit && name_width + unit_width <= room) {
        g_string_append_printf(svg, "<tspan class=\"u\" dx=\"%d\">", z->axis * 2 / 5);
        label_xml(svg, unit);
        g_string_append(svg, "</tspan>");
    }
    if (k.id >= 0 && name_width + unit_width + key_width <= room) {
        g_string_append_printf(svg, "<tspan class=\"h\" dx=\"%d\">", z->head);
        label_xml(svg, k.key);
        g_string_append(svg, "</tspan>");
    }
    g_string_append(svg, "</text>\n");
    g_free(shown);
    g_free(unit);
    g_free(name);
}

/* The names of all keys that vary, where captions can't tell them all. */
static char *list_varying(const SheetPlan *p)
{
    GString *s = g_string_new(NULL);
    for (uint32_t k = 0; k < sweep_keys(p->s); k++) {
        SweepKey key = sweep_key(p->s, k);
        if (!key.varies || (key.id < 0 && !key.levels))
            continue;
        char *name = label_key(p->s, k);
        g_string_append_printf(s, "%s%s", s->len ? ", " : "Varied: ", name);
        g_free(name);
    }
    return g_string_free(s, FALSE);
}

static uint32_t count_varying(const SheetPlan *p)
{
    uint32_t n = 0;
    for (uint32_t k = 0; k < sweep_keys(p->s); k++) {
        SweepKey key = sweep_key(p->s, k);
        n += key.varies && (key.id >= 0 || key.levels);
    }
    return n;
}

static void put_title(const Sheet *sheet, int y, GString *svg)
{
    const SheetSizes *z = &sheet->size;
    int room = z->width - 2 * z->margin;
    char *part = sheet->plan->sheets > 1
                     ? g_strdup_printf("%" G_GUINT64_FORMAT " of %" G_GUINT64_FORMAT, sheet->sheet + 1, sheet->plan->sheets)
                     : g_strdup("");
    char *title = label_fit(sheet->title, (room - (label_width(part) + 1.0) * z->axis) / (z->title * 1.12));
    sheet_text(svg, z->margin, y, "t", AT_START, title);
    if (*part)
        sheet_text(svg, z->width - z->margin, y, "a u", AT_END, part);
    g_free(title);
    g_free(part);
}

void sheet_draw_head(const Sheet *sheet, SheetBand *band)
{
    const SheetPlan *p = sheet->plan;
    const SheetSizes *z = &sheet->size;
    int y = z->margin * 3 / 4 + z->title, room = z->width - 2 * z->margin;
    put_title(sheet, y, band->svg);
    char *note = describe(p), *fitted = label_fit(note, (double)room / z->head);
    y += z->head + z->title / 3;
    sheet_text(band->svg, z->margin, y, "h", AT_START, fitted);
    g_free(note);
    g_free(fitted);
    if (p->numbered && count_varying(p) > p->told->len) {
        char *names = list_varying(p), **lines = label_wrap(names, (double)room / z->head, 3);
        for (char **l = lines; *l; l++)
            sheet_text(band->svg, z->margin, y += z->head * 3 / 2, "h", AT_START, *l);
        g_strfreev(lines);
        g_free(names);
    } else {
        y += z->axis / 4;
        for (guint i = 0; i < p->told->len; i++)
            if (item_at(p->told, i)->key != NAME_ITEM)
                put_key(sheet, item_at(p->told, i)->key, z->margin, y += z->axis * 3 / 2, room, AT_START, band->svg);
    }
    band->height = y + z->gap_y + z->head / 2;
}

/* ---- heads of columns, rows and groups ---- */

/* Values of an axis at one level, a line each. Returns how many. */
static int put_level(const Sheet *sheet, const SheetAxis *axis, uint64_t level, int x, int y, int room, SheetAnchor anchor, GString *svg)
{
    const SheetSizes *z = &sheet->size;
    for (guint i = 0; i < axis->item->len; i++) {
        SheetFact f = sheet_level_fact(sheet->plan, item_at(axis->item, i), level);
        if (axis->item->len == 1)
            *f.label = '\0';
        sheet_fact(svg, z, x, y + (int)i * (z->value * 4 / 3), room, anchor, NULL, &f);
        sheet_fact_clear(&f);
    }
    return (int)axis->item->len;
}

/* Names of the columns' keys over a rule across all of them, the columns' values below it; at the left the names of the rows' keys. */
void sheet_draw_columns(const Sheet *sheet, SheetBand *band)
{
    const SheetPlan *p = sheet->plan;
    const SheetSizes *z = &sheet->size;
    if (!p->matrix)
        return;
    const SheetAxis *columns = axis_from_end(p, 1), *rows = axis_from_end(p, 2);
    int left = sheet_column_x(sheet, 0), right = sheet_column_x(sheet, p->columns - 1) + z->cell, y = 0;
    for (guint i = 0; i < columns->item->len; i++)
        if (item_at(columns->item, i)->key != NAME_ITEM)
            put_key(sheet, item_at(columns->item, i)->key, (left + right) / 2, y += z->axis * 3 / 2, right - left, AT_MIDDLE, band->svg);
    y += z->axis * 2 / 3;
    int rule = y;
    g_string_append_printf(band->svg, "<path class=\"r\" d=\"M%d %d.5H%d\"/>\n", left, rule, right);
    y += z->value * 3 / 2;
    for (uint32_t c = 0; c < p->columns; c++)
        put_level(sheet, columns, c, sheet_column_x(sheet, c) + z->cell / 2, y, z->cell + z->gap_x / 2, AT_MIDDLE, band->svg);
    y += MAX((int)columns->item->len - 1, 0) * (z->value * 4 / 3);
    /* The names of rows, from the last line up: name, unit. */
    int up = y;
    for (guint i = rows->item->len; i-- > 0;) {
        if (item_at(rows->item, i)->key == NAME_ITEM)
            continue;
        SweepKey k = sweep_key(p->s, item_at(rows->item, i)->key);
        char *name = label_key(p->s, item_at(rows->item, i)->key), **lines = label_wrap(name, (z->left - z->gap_x) / (z->axis * 1.12), 3);
        if (*label_unit(&k) && rows->item->len == 1) {
            char *unit = g_strdup_printf("(%s)", label_unit(&k)), *fitted = label_fit(unit, (double)(z->left - z->gap_x) / z->label);
            sheet_text(band->svg, z->margin, up, "l", AT_START, fitted);
            up -= z->axis * 5 / 4;
            g_free(unit);
            g_free(fitted);
        }
        for (guint l = g_strv_length(lines); l-- > 0; up -= z->axis * 5 / 4)
            sheet_text(band->svg, z->margin, up, "ab", AT_START, lines[l]);
        g_strfreev(lines);
        g_free(name);
    }
    band->height = y + z->value * 4 / 5;
    int above = z->axis - up - z->axis * 5 / 4; /* what stands higher than the band */
    if (above > 0) {
        char *old = g_strndup(band->svg->str, band->svg->len);
        g_string_printf(band->svg, "<g transform=\"translate(0,%d)\">\n%s</g>\n", above, old);
        band->height += above;
        g_free(old);
    }
}

static void add_unit(const SheetPlan *p, const SheetItem *item, SheetFact *f)
{
    if (item->key == NAME_ITEM)
        return;
    SweepKey k = sweep_key(p->s, item->key);
    char *bare = f->value;
    f->value = g_strjoin(*label_unit(&k) ? " " : "", bare, label_unit(&k), NULL);
    g_free(bare);
}

void sheet_draw_group(const Sheet *sheet, uint64_t group, bool goes_on, SheetBand *band)
{
    const SheetPlan *p = sheet->plan;
    const SheetSizes *z = &sheet->size;
    int y = z->gap_y / 2, x = z->margin, end = z->width - z->margin;
    if (!p->group_axes)
        return;
    g_string_append_printf(band->svg, "<path class=\"r\" d=\"M%d %d.5H%d\"/>\n", x, y, end);
    y += z->value * 3 / 2;
    for (uint32_t a = 0; a < p->group_axes; a++) {
        const SheetAxis *axis = p->axis->pdata[a];
        for (guint i = 0; i < axis->item->len && end - x > 4 * z->value; i++) {
            SheetFact f = sheet_level_fact(p, item_at(axis->item, i), sheet_plan_level(p, a, group * p->group_cells));
            add_unit(p, item_at(axis->item, i), &f);
            sheet_fact(band->svg, z, x, y, end - x, AT_START, NULL, &f);
            x += (int)fact_width(z, &f, true) + 2 * z->value;
            sheet_fact_clear(&f);
        }
    }
    if (goes_on && end - x > 6 * z->label)
        sheet_text(band->svg, end, y, "l", AT_END, "continued");
    band->height = y + z->value * 2 / 3;
}

/* ---- cells ---- */

int sheet_line_height(const Sheet *sheet) { return (int)sheet->plan->picture_height + sheet->size.caption + sheet->size.gap_y; }

uint32_t sheet_line_parts(const Sheet *sheet, uint64_t line) { return 1 + sheet_plan_line(sheet->plan, line).cells; }

void sheet_draw_part(const Sheet *sheet, uint64_t line, uint32_t part, GString *svg)
{
    const SheetPlan *p = sheet->plan;
    const SheetSizes *z = &sheet->size;
    SheetLine at = sheet_plan_line(p, line);
    if (part > 0) {
        Row row;
        row_read(p->s, p->out, at.first + part - 1, &row);
        sheet_cell(sheet, &row, sheet_column_x(sheet, part - 1), svg);
        row_clear(&row);
    } else if (p->matrix) {
        const SheetAxis *rows = axis_from_end(p, 2);
        int lines = (int)rows->item->len, y = ((int)p->picture_height - (lines - 1) * (z->value * 4 / 3)) / 2 + z->value / 3;
        put_level(sheet, rows, sheet_plan_level(p, p->axis->len - 2, at.first), z->margin, y, z->left - z->gap_x, AT_START, svg);
    }
}

void sheet_draw_foot(const Sheet *sheet, uint32_t failed, uint32_t missing, SheetBand *band)
{
    const SheetSizes *z = &sheet->size;
    band->height = z->margin - z->gap_y / 2;
    if (failed + missing == 0)
        return;
    GString *text = g_string_new(NULL);
    if (failed)
        g_string_append_printf(text, "%u failed", failed);
    if (missing)
        g_string_append_printf(text, "%s%u missing", failed ? ", " : "", missing);
    sheet_text(band->svg, z->margin, z->note, "n", AT_START, text->str);
    g_string_free(text, TRUE);
    band->height += z->note;
}
