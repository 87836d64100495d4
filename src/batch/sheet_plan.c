/* Where each variant lies on the sheet, and what tells its values: the place, or a caption. */
#include <string.h>

#include "batch/sheet_label.h"
#include "batch/sheet_private.h"
#include "geom/vec.h"
#include "sweep/private.h"

enum { MOST_COLUMNS = 24, MOST_LINES = 40, MOST_IN_ROW = 6, MOST_LETTERS = 26, LEVEL_DIGITS = 7, DRAWN_DIGITS = 4, MOST_COMPARED = 1000 };
static const double most_pixels = 160e6; /* of a sheet: 600 cells of the common size need half of it */

/* ---- items ---- */

static const SweepAxis *axis_at(const Sweep *s, uint32_t i) { return &g_array_index(s->axis, SweepAxis, i); }

/* What an axis tells: its names if the user gave some, else the keys that vary. */
static void add_items(const Sweep *s, uint32_t axis, GArray *items)
{
    if (axis_at(s, axis)->named) {
        g_array_append_val(items, ((SheetItem){NAME_ITEM, axis}));
        return;
    }
    for (uint32_t k = 0; k < sweep_keys(s); k++) {
        SweepKey key = sweep_key(s, k);
        if (key.axis == axis && key.varies && axis_at(s, axis)->kind != AXIS_EACH)
            g_array_append_val(items, ((SheetItem){k, axis}));
    }
}

static SheetAxis *axis_new(const SheetPlan *p, uint32_t axis)
{
    SheetAxis *a = g_new0(SheetAxis, 1);
    a->axis = axis;
    a->levels = axis_at(p->s, axis)->levels;
    a->item = g_array_new(FALSE, FALSE, sizeof(SheetItem));
    add_items(p->s, axis, a->item);
    sheet_choose(p, a->item);
    return a;
}

static void axis_free(gpointer axis)
{
    g_array_free(((SheetAxis *)axis)->item, TRUE);
    g_free(axis);
}

char *sheet_item_label(const SheetPlan *p, const SheetItem *item)
{
    return item->key == NAME_ITEM ? g_strdup("") : label_key(p->s, item->key);
}

static SheetFact make_fact(const SheetPlan *p, const SheetItem *item, const char *text)
{
    SweepKey key = sweep_key(p->s, item->key);
    char *own = !text && key.id >= 0 ? params_format(sweep_params(p->s), (ParamId)key.id) : NULL;
    SheetFact f = {sheet_item_label(p, item), label_value(p->s, &key, text, p->digits[item->key]), label_colour(&key, text ? text : own)};
    g_free(own);
    return f;
}

static SheetFact name_fact(const SheetPlan *p, const SheetItem *item, uint64_t level)
{
    return (SheetFact){g_strdup(""), g_strdup(axis_at(p->s, item->axis)->label[level]), -1};
}

SheetFact sheet_level_fact(const SheetPlan *p, const SheetItem *item, uint64_t level)
{
    if (item->key == NAME_ITEM)
        return name_fact(p, item, level);
    char *text = sweep_level(p->s, item->key, level);
    SheetFact f = make_fact(p, item, text);
    g_free(text);
    return f;
}

SheetFact sheet_variant_fact(const SheetPlan *p, const SheetItem *item, const SweepVariant *v)
{
    if (item->key != NAME_ITEM)
        return make_fact(p, item, v->value[item->key]);
    for (uint32_t k = 0; k < v->n; k++)
        if (sweep_key(p->s, k).axis == item->axis)
            return name_fact(p, item, v->level[k]);
    return name_fact(p, item, v->index); /* a list of names, which steps with the variants */
}

void sheet_fact_clear(SheetFact *f)
{
    g_free(f->label);
    g_free(f->value);
    *f = (SheetFact){0};
}

/* Digits that values of an axis need: those of lists are the user's; of a range as many as show steps within a fiftieth. */
static int choose_digits(const Sweep *s, uint32_t key)
{
    SweepKey k = sweep_key(s, key);
    const SweepAxis *axis = axis_at(s, k.axis);
    int digits = axis->kind >= AXIS_UNIFORM ? DRAWN_DIGITS : LEVEL_DIGITS;
    if (axis->kind == AXIS_LIST || axis->kind >= AXIS_UNIFORM || k.levels > MOST_COMPARED)
        return digits;
    for (digits = DRAWN_DIGITS; digits < LEVEL_DIGITS; digits++) {
        bool good = true;
        double last = 0.0;
        for (uint64_t l = 0; l < k.levels && good; l++) {
            char *text = sweep_level(s, key, l), *shown = sweep_number_text(g_ascii_strtod(text, NULL), digits, axis->whole);
            double value = g_ascii_strtod(text, NULL), off = fabs(g_ascii_strtod(shown, NULL) - value);
            good = l == 0 || off * 50.0 <= fabs(value - last);
            last = value;
            g_free(text);
            g_free(shown);
        }
        if (good)
            break;
    }
    return digits;
}

/* ---- the arrangement ---- */

static void plan_grid(SheetPlan *p)
{
    for (uint32_t i = 0; i < p->s->axis->len; i++) {
        const SweepAxis *axis = axis_at(p->s, i);
        if (axis->levels > 1 && !axis->drawn)
            g_ptr_array_add(p->axis, axis_new(p, i));
        else if (axis->drawn && sweep_axis_varies(axis))
            add_items(p->s, i, p->told);
    }
    sheet_choose(p, p->told);
    guint n = p->axis->len;
    const SheetAxis *last = n ? p->axis->pdata[n - 1] : NULL;
    p->matrix = n >= 2 && last->levels <= MOST_COLUMNS;
    p->group_cells = n ? last->levels : 1;
    if (p->matrix) {
        p->columns = (uint32_t)last->levels;
        p->group_cells *= ((const SheetAxis *)p->axis->pdata[n - 2])->levels;
        p->group_axes = n - 2;
    } else if (n) {
        g_array_prepend_vals(p->told, last->item->data, last->item->len);
        g_ptr_array_remove_index(p->axis, n - 1);
        p->group_axes = n - 1;
    }
}

static void plan_flow(SheetPlan *p)
{
    p->group_cells = sweep_count(p->s);
    p->numbered = p->s->mode == SWEEP_SAMPLE;
    for (uint32_t i = 0; i < p->s->axis->len; i++)
        if (sweep_axis_varies(axis_at(p->s, i)) || axis_at(p->s, i)->named)
            add_items(p->s, i, p->told);
    sheet_choose(p, p->told);
}

/* Columns for n cells: about three to two as a whole, preferring those that leave few places of the last line empty. */
static uint32_t choose_columns(uint64_t n, uint64_t most, double cell_width, double cell_height)
{
    if (n <= MOST_IN_ROW)
        return (uint32_t)MAX(n, 1);
    double shown = (double)MIN(n, most), best = 1e300;
    uint32_t chosen = 1;
    for (uint32_t c = 2; c <= 30; c++) {
        double lines = (double)(((uint64_t)shown + c - 1) / c), ratio = c * cell_width / (lines * cell_height) / 1.5;
        double off = ratio > 1.0 ? ratio - 1.0 : 1.0 / ratio - 1.0, empty = (lines * c - shown) / c;
        if (off + empty < best) {
            best = off + empty;
            chosen = c;
        }
    }
    return chosen;
}

/* The box that holds all pictures of the first sheet at this size, since leaves are narrow: its sides at most `cell`. */
static void measure_pictures(SheetPlan *p, uint32_t cell)
{
    p->picture_width = p->picture_height = 0;
    for (uint64_t i = 0; i < MIN(sweep_count(p->s), SHEET_MOST_CELLS); i++) {
        Row row;
        uint32_t w, h;
        row_read(p->s, p->out, i, &row);
        char *path = row.picture ? g_build_filename(p->out, row.picture, NULL) : NULL;
        if (path && sheet_picture_size(path, &w, &h)) {
            uint32_t most = MAX(w, h);
            p->picture_width = MAX(p->picture_width, (uint32_t)(((uint64_t)w * cell + most - 1) / most));
            p->picture_height = MAX(p->picture_height, (uint32_t)(((uint64_t)h * cell + most - 1) / most));
        }
        g_free(path);
        row_clear(&row);
    }
    /* Room for a caption, or for what is told in a cell without a picture. */
    p->picture_width = p->picture_width ? MAX(p->picture_width, cell / 2) : cell;
    p->picture_height = p->picture_height ? MAX(p->picture_height, cell / 3) : cell;
}

SheetPlan *sheet_plan_new(const Sweep *s, const char *out, const SheetDef *def)
{
    SheetPlan *p = g_new0(SheetPlan, 1);
    p->s = s;
    p->out = out;
    p->specimen = def->specimen;
    p->axis = g_ptr_array_new_with_free_func(axis_free);
    p->told = g_array_new(FALSE, FALSE, sizeof(SheetItem));
    p->digits = g_new(int, sweep_keys(s) + 1);
    for (uint32_t k = 0; k < sweep_keys(s); k++)
        p->digits[k] = choose_digits(s, k);
    measure_pictures(p, def->cell);
    if (s->mode == SWEEP_GRID)
        plan_grid(p);
    else
        plan_flow(p);
    uint64_t count = sweep_count(s);
    p->numbered |= !p->told->len && !p->axis->len && count > 1;
    p->groups = count / p->group_cells;
    p->lettered = !p->matrix && !p->numbered && p->groups == 1 && count > 1 && count <= MOST_LETTERS;
    double pixels = (p->picture_width + def->cell * 0.07) * (p->picture_height + def->cell * 0.3);
    uint64_t most = MIN(SHEET_MOST_CELLS, (uint64_t)MAX(most_pixels / pixels, 1.0));
    if (!p->columns)
        p->columns = choose_columns(p->group_cells, most, p->picture_width, p->picture_height + def->cell * 0.2);
    p->group_lines = (p->group_cells + p->columns - 1) / p->columns;
    p->lines = p->groups * p->group_lines;
    p->sheet_lines = CLAMP(most / p->columns, 1, MOST_LINES);
    p->sheets = (p->lines + p->sheet_lines - 1) / p->sheet_lines;
    return p;
}

void sheet_plan_free(SheetPlan *p)
{
    if (!p)
        return;
    g_ptr_array_free(p->axis, TRUE);
    g_array_free(p->told, TRUE);
    g_free(p->digits);
    g_free(p);
}

SheetLine sheet_plan_line(const SheetPlan *p, uint64_t line)
{
    uint64_t group = line / p->group_lines, within = line % p->group_lines, first = within * p->columns;
    return (SheetLine){group, group * p->group_cells + first, (uint32_t)MIN(p->columns, p->group_cells - first), within == 0};
}

uint64_t sheet_plan_level(const SheetPlan *p, uint32_t i, uint64_t index)
{
    const SheetAxis *axis = p->axis->pdata[i];
    return index / axis_at(p->s, axis->axis)->stride % axis->levels;
}
