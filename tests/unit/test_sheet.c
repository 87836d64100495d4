/* Contact sheets: what lies where, checked on the drawing and on the pixels; no text over another, measured with a font and not by the code's own table;
 * the PNG against the whole drawing as librsvg draws it. */
#include <glib/gstdio.h>
#include <gmodule.h>
#include <librsvg/rsvg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "batch/private.h"
#include "batch/sheet.h"
#include "batch/sheet_label.h"
#include "batch/sheet_private.h"

/* For leak checkers: fonts are kept by Fontconfig and librsvg until the process ends. */
G_MODULE_EXPORT const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void) { return "leak:libfontconfig\nleak:libpango\nleak:librsvg\n"; }

/* ---- a sweep's folder ---- */

typedef struct {
    char *dir;
    Sweep *s;
} Fixture;

static Fixture make_sweep(const char *text)
{
    GError *error = NULL;
    Fixture f = {.dir = g_dir_make_tmp("venation-sheet-XXXXXX", &error)};
    g_assert_no_error(error);
    char *params = g_build_filename(f.dir, "leaf.ini", NULL), *path = g_build_filename(f.dir, "some-sweep.ini", NULL),
         *whole = g_strdup_printf("[sweep]\nparams = leaf.ini\n%s", text);
    g_assert_true(g_file_set_contents(params, "[veins]\nkill_distance = 3\n", -1, NULL));
    f.s = sweep_parse(whole, strlen(whole), path, &error);
    g_assert_no_error(error);
    g_free(params);
    g_free(path);
    g_free(whole);
    return f;
}

static void remove_all(const char *path)
{
    GDir *dir = g_dir_open(path, 0, NULL);
    const char *name;
    while (dir && (name = g_dir_read_name(dir))) {
        char *child = g_build_filename(path, name, NULL);
        remove_all(child);
        g_free(child);
    }
    if (dir)
        g_dir_close(dir);
    g_remove(path);
}

static void fixture_clear(Fixture *f)
{
    remove_all(f->dir);
    sweep_free(f->s);
    g_free(f->dir);
}

static char *put(const char *dir, const char *relative, const char *text, gssize n)
{
    char *path = g_build_filename(dir, relative, NULL), *folder = g_path_get_dirname(path);
    g_assert_cmpint(g_mkdir_with_parents(folder, 0777), ==, 0);
    g_assert_true(g_file_set_contents(path, text, n, NULL));
    g_free(folder);
    return path;
}

/* The colour of a variant's picture. */
static unsigned colour_of(uint64_t i) { return (unsigned)((i * 2654435761u) & 0xffffff) | 0x101010; }

static void put_picture(const char *path, unsigned colour, int w, int h)
{
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, w, h);
    cairo_t *cr = cairo_create(surface);
    cairo_set_source_rgb(cr, (colour >> 16) / 255.0, (colour >> 8 & 255) / 255.0, (colour & 255) / 255.0);
    cairo_paint(cr);
    cairo_destroy(cr);
    g_assert_cmpint(cairo_surface_write_to_png(surface, path), ==, CAIRO_STATUS_SUCCESS);
    cairo_surface_destroy(surface);
}

static void put_grown(const Fixture *f, uint64_t i, int w, int h)
{
    SweepVariant v;
    sweep_variant(f->s, i, &v);
    char *folder = row_folder(f->s, &v), *row = g_build_filename(folder, "sweep.json", NULL), *picture = g_build_filename(f->dir, folder, "sweep.png", NULL),
         *json = g_strdup_printf("{\"index\": %" G_GUINT64_FORMAT ", \"variant\": \"%s\", \"outcome\": \"grown\", \"error\": null, \"folder\": \"%s\"}\n", i, v.name,
                                 folder);
    g_free(put(f->dir, row, json, -1));
    if (w)
        put_picture(picture, colour_of(i), w, h);
    g_free(json);
    g_free(picture);
    g_free(row);
    g_free(folder);
    sweep_variant_clear(&v);
}

static void put_failed(const Fixture *f, uint64_t i, const char *error)
{
    SweepVariant v;
    sweep_variant(f->s, i, &v);
    char *path = row_failed(&v), *json = g_strdup_printf("{\"index\": %" G_GUINT64_FORMAT ", \"variant\": \"%s\", \"outcome\": \"failed\", \"error\": \"%s\"}\n", i,
                                                         v.name, error);
    g_free(put(f->dir, path, json, -1));
    g_free(json);
    g_free(path);
    sweep_variant_clear(&v);
}

/* ---- a drawing, read back ---- */

typedef struct {
    double x, y, w, h;
    char *text; /* or a picture's data */
    bool is_picture;
} Item;

typedef struct {
    GArray *item;
    double width, height, shift; /* of the group we are in */
    GHashTable *size;            /* class → letters' size */
    GString *style;
    bool in_style, in_text, bold_text;
    double text_x, text_y, advance, text_size;
    int anchor;
    double span_size;
    bool span_bold;
    GString *said;
    cairo_t *cr;
} Picture;

static double attribute(const char **names, const char **values, const char *name)
{
    for (int i = 0; names[i]; i++)
        if (strcmp(names[i], name) == 0)
            return g_ascii_strtod(values[i], NULL);
    return 0.0;
}

static const char *word(const char **names, const char **values, const char *name)
{
    for (int i = 0; names[i]; i++)
        if (strcmp(names[i], name) == 0)
            return values[i];
    return "";
}

static double class_size(Picture *d, const char *class, double otherwise)
{
    char **part = g_strsplit(class, " ", -1);
    for (int i = 0; part[i]; i++) {
        gpointer found = g_hash_table_lookup(d->size, part[i]);
        otherwise = found ? GPOINTER_TO_INT(found) : otherwise;
    }
    g_strfreev(part);
    return otherwise;
}

static bool is_bold(const char *class) { return strcmp(class, "t") == 0 || strcmp(class, "ab") == 0 || strcmp(class, "b") == 0; }

static void on_start(GMarkupParseContext *c, const char *element, const char **names, const char **values, gpointer user, GError **error)
{
    Picture *d = user;
    if (strcmp(element, "svg") == 0) {
        d->width = attribute(names, values, "width");
        d->height = attribute(names, values, "height");
    } else if (strcmp(element, "style") == 0) {
        d->in_style = true;
    } else if (strcmp(element, "g") == 0) {
        const char *transform = word(names, values, "transform");
        g_assert_true(g_str_has_prefix(transform, "translate(0,"));
        d->shift += g_ascii_strtod(transform + strlen("translate(0,"), NULL);
    } else if (strcmp(element, "image") == 0) {
        Item i = {attribute(names, values, "x"), attribute(names, values, "y") + d->shift, attribute(names, values, "width"), attribute(names, values, "height"),
                  g_strdup(word(names, values, "href")), true};
        g_array_append_val(d->item, i);
    } else if (strcmp(element, "rect") == 0 && *word(names, values, "class")) {
        Item i = {attribute(names, values, "x"), attribute(names, values, "y") + d->shift, attribute(names, values, "width"), attribute(names, values, "height"),
                  g_strdup("box"), true};
        g_array_append_val(d->item, i);
    } else if (strcmp(element, "text") == 0) {
        const char *anchor = word(names, values, "text-anchor");
        d->in_text = true;
        d->text_x = attribute(names, values, "x");
        d->text_y = attribute(names, values, "y") + d->shift;
        d->anchor = strcmp(anchor, "middle") == 0 ? 1 : strcmp(anchor, "end") == 0 ? 2 : 0;
        d->text_size = d->span_size = class_size(d, word(names, values, "class"), 0.0);
        d->span_bold = is_bold(word(names, values, "class"));
        d->advance = 0.0;
        g_string_truncate(d->said, 0);
    } else if (strcmp(element, "tspan") == 0) {
        d->span_size = class_size(d, word(names, values, "class"), d->span_size);
        d->text_size = MAX(d->text_size, d->span_size);
        d->span_bold = is_bold(word(names, values, "class"));
        d->advance += attribute(names, values, "dx");
    }
}

static void on_text(GMarkupParseContext *c, const char *text, gsize n, gpointer user, GError **error)
{
    Picture *d = user;
    if (d->in_style)
        g_string_append_len(d->style, text, (gssize)n);
    if (!d->in_text)
        return;
    if (n == 0)
        return;
    g_assert_cmpfloat(d->span_size, >=, 6.0); /* all text has a size, and one that can be read */
    char *own = g_strndup(text, n);
    cairo_text_extents_t e;
    cairo_select_font_face(d->cr, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, d->span_bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(d->cr, d->span_size);
    cairo_text_extents(d->cr, own, &e);
    d->advance += e.x_advance;
    g_string_append(d->said, own);
    g_free(own);
}

static void on_end(GMarkupParseContext *c, const char *element, gpointer user, GError **error)
{
    Picture *d = user;
    if (strcmp(element, "style") == 0) {
        d->in_style = false;
        for (const char *at = d->style->str; (at = strstr(at, "font-size:")) != NULL; at++) {
            const char *line = at;
            while (line > d->style->str && line[-1] != '\n')
                line--;
            char *names = g_strndup(line, strcspn(line, "{")), **part = g_strsplit(names, ",", -1);
            for (int i = 0; part[i]; i++)
                g_hash_table_insert(d->size, g_strdup(part[i] + 1), GINT_TO_POINTER(atoi(at + strlen("font-size:"))));
            g_strfreev(part);
            g_free(names);
        }
    } else if (strcmp(element, "g") == 0) {
        d->shift = 0.0;
    } else if (strcmp(element, "text") == 0) {
        d->in_text = false;
        Item i = {d->text_x - d->advance * d->anchor / 2.0, d->text_y - 0.74 * d->text_size, d->advance, 0.9 * d->text_size, g_strdup(d->said->str), false};
        g_array_append_val(d->item, i);
    }
}

static void item_clear(gpointer item) { g_free(((Item *)item)->text); }

static Picture read_drawing(const char *dir, const char *name)
{
    static const GMarkupParser parser = {on_start, on_end, on_text, NULL, NULL};
    Picture d = {.item = g_array_new(FALSE, FALSE, sizeof(Item)), .size = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL), .style = g_string_new(NULL),
                 .said = g_string_new(NULL)};
    g_array_set_clear_func(d.item, item_clear);
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_A8, 4, 4);
    d.cr = cairo_create(surface);
    cairo_font_options_t *plain = cairo_font_options_create();
    cairo_font_options_set_hint_metrics(plain, CAIRO_HINT_METRICS_OFF);
    cairo_set_font_options(d.cr, plain);
    cairo_font_options_destroy(plain);
    char *path = g_build_filename(dir, name, NULL), *text;
    gsize n;
    GError *error = NULL;
    g_assert_true(g_file_get_contents(path, &text, &n, NULL));
    GMarkupParseContext *c = g_markup_parse_context_new(&parser, 0, &d, NULL);
    g_assert_true(g_markup_parse_context_parse(c, text, (gssize)n, &error));
    g_assert_true(g_markup_parse_context_end_parse(c, &error));
    g_markup_parse_context_free(c);
    cairo_destroy(d.cr);
    cairo_surface_destroy(surface);
    g_free(text);
    g_free(path);
    return d;
}

static void drawing_clear(Picture *d)
{
    g_array_free(d->item, TRUE);
    g_hash_table_destroy(d->size);
    g_string_free(d->style, TRUE);
    g_string_free(d->said, TRUE);
}

static const Item *item(const Picture *d, guint i) { return &g_array_index(d->item, Item, i); }

static bool has_text(const Picture *d, const char *text)
{
    for (guint i = 0; i < d->item->len; i++)
        if (!item(d, i)->is_picture && strstr(item(d, i)->text, text))
            return true;
    return false;
}

static bool overlap(const Item *a, const Item *b) { return a->x < b->x + b->w - 0.5 && b->x < a->x + a->w - 0.5 && a->y < b->y + b->h - 0.5 && b->y < a->y + a->h - 0.5; }

/* Nothing leaves the sheet; no text lies over another, nor over a picture, but those that a box holds. */
static void check_room(const Picture *d, const char *what)
{
    for (guint i = 0; i < d->item->len; i++) {
        const Item *a = item(d, i);
        if (a->x < 0.0 || a->y < 0.0 || a->x + a->w > d->width || a->y + a->h > d->height)
            g_error("%s: '%.60s' leaves the sheet: %g %g %g %g of %g %g", what, a->text, a->x, a->y, a->w, a->h, d->width, d->height);
        for (guint j = i + 1; j < d->item->len; j++) {
            const Item *b = item(d, j);
            if (!overlap(a, b))
                continue;
            const Item *box = a->is_picture ? a : b, *text = a->is_picture ? b : a;
            bool inside = box->is_picture && strcmp(box->text, "box") == 0 && !text->is_picture && text->x >= box->x && text->x + text->w <= box->x + box->w &&
                          text->y >= box->y && text->y + text->h <= box->y + box->h;
            if (!inside)
                g_error("%s: '%.60s' lies over '%.60s'", what, a->text, b->text);
        }
    }
}

static void write_sheet(const Fixture *f, uint32_t cell)
{
    GError *error = NULL;
    g_assert_true(sheet_write(f->s, f->dir, &(SheetDef){.cell = cell}, &error));
    g_assert_no_error(error);
}

/* ---- tests ---- */

#define LONG_TEXT "A name that goes on and on, <b>&amp; never \\\"ends\\\" ; for all that it was cut long ago, Ünïcödé 葉脈 and more of it"

/* Mixed outcomes in all arrangements and sizes. */
static void test_no_overlap(void)
{
    static const char *const sweep[] = {
        "veins.kill_distance = 40\n",
        "veins.kill_distance = 40; 5\n",
        "mode = zip\nveins.kill_distance = 40; 20; 10; 5; 1\nwidth.minimum = 2; 1.1; 0.6; 0.45; 0.35\n",
        "sources.density = from 0.00001 to 0.01 in 12 log\n",
        "seed = from 1 to 40 by 1\n",
        "veins.kill_distance = 40; 20; 10\nsources.birth_distance_sources = from 1 to 7 in 7\n",
        "veins.pattern = open; closed\ntexture.lamina_colour = #ffffff; #123456\nveins.kill_distance = 20; 10; 5\nsources.density = 0.0003; 0.006\n",
        "sources.density = 0.0003; 0.006\nveins.kill_distance = from 1 to 40 in 30\n",
        "veins.kill_distance = from 1 to 40 in 50\nsources.density = 0.0003; 0.006\nwidth.minimum = normal(1, 0.2)\n",
        "leaf.title = " LONG_TEXT " | Short | x\nleaf.source = one | " LONG_TEXT "\n",
        "leaf.title = one | " LONG_TEXT "\nleaf.source = " LONG_TEXT " | two\ntexture.lamina_colour = #ffffff; #123456\nseed = 1; 2\n",
        "leaf.title = " LONG_TEXT "\ngrowth.kind = isogonic\nseed = 3\n",
        "mode = sample\ncount = 31\nseed = each\nveins.kill_distance = log-uniform(0.001, 1000)\ntexture.lamina_colour = choice(#35602b; #ffffff)\n"
        "leaf.title = choice(" LONG_TEXT "| b)\nwidth.exponent = uniform(2, 3)\ngrowth.final_length = normal(900, 100)\nsources.birth_distance_sources = uniform(2, 3)\n",
        "mode = zip\nname = first; second; a-rather-long-name-for-a-leaf-that-has-to-be-cut-in-a-small-cell\nveins.kill_distance = 1; 2; 3\n",
    };
    static const uint32_t cell[] = {32, 96, 240};
    for (gsize k = 0; k < G_N_ELEMENTS(sweep); k++) {
        Fixture f = make_sweep(sweep[k]);
        for (uint64_t i = 0; i < sweep_count(f.s); i++) {
            if (i % 7 == 3)
                put_failed(&f, i, i % 2 ? "leaf.ini: [growth] final_length = 12: " LONG_TEXT " " LONG_TEXT : "short");
            else if (i % 7 != 5)
                put_grown(&f, i, i % 5 == 4 ? 0 : 24, 32);
        }
        for (gsize c = 0; c < G_N_ELEMENTS(cell); c++) {
            write_sheet(&f, cell[c]);
            Picture d = read_drawing(f.dir, "sheet.svg");
            char *what = g_strdup_printf("sweep %zu, cells of %u", k, cell[c]);
            check_room(&d, what);
            g_assert_true(has_text(&d, "some-sweep"));
            g_free(what);
            drawing_clear(&d);
        }
        fixture_clear(&f);
    }
}

static unsigned pixel(cairo_surface_t *s, double x, double y)
{
    const uint8_t *data = cairo_image_surface_get_data(s);
    return ((const uint32_t *)(const void *)(data + (gsize)y * (gsize)cairo_image_surface_get_stride(s)))[(gsize)x] & 0xffffff;
}

static cairo_surface_t *read_png(const char *dir, const char *name)
{
    char *path = g_build_filename(dir, name, NULL);
    cairo_surface_t *s = cairo_image_surface_create_from_png(path);
    g_assert_cmpint(cairo_surface_status(s), ==, CAIRO_STATUS_SUCCESS);
    g_free(path);
    return s;
}

/* All pictures of a sheet are there in order, their bytes in the drawing, their pixels at the same place of the PNG. */
static void check_pictures(const Fixture *f, const char *svg, const char *png, uint64_t first, uint64_t n)
{
    Picture d = read_drawing(f->dir, svg);
    cairo_surface_t *pixels = read_png(f->dir, png);
    g_assert_cmpfloat(d.width, ==, cairo_image_surface_get_width(pixels));
    g_assert_cmpfloat(d.height, ==, cairo_image_surface_get_height(pixels));
    uint64_t at = first;
    for (guint i = 0; i < d.item->len; i++) {
        const Item *p = item(&d, i);
        if (!p->is_picture)
            continue;
        Row row;
        row_read(f->s, f->dir, at, &row);
        char *path = g_build_filename(f->dir, row.picture, NULL), *data;
        gsize length;
        g_assert_true(g_file_get_contents(path, &data, &length, NULL));
        char *text = g_base64_encode((const guchar *)data, length);
        g_assert_true(g_str_has_prefix(p->text, "data:image/png;base64,"));
        g_assert_cmpstr(p->text + strlen("data:image/png;base64,"), ==, text);
        g_assert_cmphex(pixel(pixels, p->x + p->w / 2, p->y + p->h / 2), ==, colour_of(at));
        g_free(text);
        g_free(data);
        g_free(path);
        row_clear(&row);
        at++;
    }
    g_assert_cmpuint(at, ==, first + n);
    cairo_surface_destroy(pixels);
    drawing_clear(&d);
}

static void test_figure(void)
{
    Fixture f = make_sweep("mode = zip\nveins.kill_distance = 40; 20; 10; 5; 1\nwidth.minimum = 2; 1.1; 0.6; 0.45; 0.35\ngrowth.final_length = 500\n");
    for (uint64_t i = 0; i < 5; i++)
        put_grown(&f, i, 40, 64);
    write_sheet(&f, 320);
    check_pictures(&f, "sheet.svg", "sheet.png", 0, 5);
    Picture d = read_drawing(f.dir, "sheet.svg");
    double y = -1.0, x = -1.0;
    for (guint i = 0; i < d.item->len; i++) {
        const Item *p = item(&d, i);
        if (!p->is_picture)
            continue;
        g_assert_true(y < 0.0 || p->y == y); /* one row, like fig. 9 of the paper */
        g_assert_cmpfloat(p->x, >, x);
        g_assert_cmpfloat(p->w, ==, 200.0); /* cells as narrow as the pictures */
        g_assert_cmpfloat(p->h, ==, 320.0);
        y = p->y;
        x = p->x;
    }
    g_assert_true(has_text(&d, "akill distance40"));
    g_assert_true(has_text(&d, "ekill distance1"));
    g_assert_true(has_text(&d, "width minimum0.35"));
    g_assert_true(has_text(&d, "kill distance(segments)veins.kill_distance"));
    g_assert_true(has_text(&d, "5 variants of leaf.ini, all with final length 500 segments"));
    drawing_clear(&d);
    fixture_clear(&f);
}

/* Place i of the matrix: its x goes with the last axis alone, its y with the others; heads stand at their lines. */
static void test_matrix(void)
{
    Fixture f = make_sweep("veins.pattern = open; closed\nveins.kill_distance = 40; 20; 10\nwidth.exponent = 2; 2.5; 3; 4\n");
    for (uint64_t i = 0; i < 24; i++)
        put_grown(&f, i, 32, 32);
    write_sheet(&f, 100);
    check_pictures(&f, "sheet.svg", "sheet.png", 0, 24);
    Picture d = read_drawing(f.dir, "sheet.svg");
    double column[4] = {0}, line[6] = {0};
    uint64_t at = 0;
    for (guint i = 0; i < d.item->len; i++) {
        if (!item(&d, i)->is_picture)
            continue;
        const Item *p = item(&d, i);
        if (at < 4)
            column[at] = p->x;
        if (at % 4 == 0)
            line[at / 4] = p->y;
        g_assert_cmpfloat(p->x, ==, column[at % 4]);
        g_assert_cmpfloat(p->y, ==, line[at / 4]);
        g_assert_true(at < 4 || line[at / 4] >= line[at / 4 - 1]);
        at++;
    }
    static const char *const rows[] = {"40", "20", "10"}, *const columns[] = {"2", "2.5", "3", "4"};
    int found = 0;
    for (guint i = 0; i < d.item->len; i++) {
        const Item *t = item(&d, i);
        for (int r = 0; r < 6 && !t->is_picture; r++)
            found += strcmp(t->text, rows[r % 3]) == 0 && t->x < column[0] && t->y > line[r] && t->y < line[r] + 100.0;
        for (int c = 0; c < 4 && !t->is_picture; c++)
            found += strcmp(t->text, columns[c]) == 0 && fabs(t->x + t->w / 2 - column[c] - 50.0) < 2.0 && t->y < line[0];
    }
    g_assert_cmpint(found, ==, 10);
    g_assert_true(has_text(&d, "veins patternopen") && has_text(&d, "veins patternclosed"));
    g_assert_true(has_text(&d, "width exponent") && has_text(&d, "kill distance") && has_text(&d, "(segments)"));
    drawing_clear(&d);
    fixture_clear(&f);
}

/* Small cells on no wider a page than they, or the heads above them, need. */
static void test_narrow(void)
{
    static const uint32_t cell[] = {40, 60, 110, 200, 320};
    Fixture f = make_sweep("veins.kill_distance = 40; 20; 10\nwidth.exponent = 2; 2.5; 3\n");
    for (uint64_t i = 0; i < 9; i++)
        put_grown(&f, i, 200, 320);
    for (gsize c = 0; c < G_N_ELEMENTS(cell); c++) {
        write_sheet(&f, cell[c]);
        check_pictures(&f, "sheet.svg", "sheet.png", 0, 9);
        Picture d = read_drawing(f.dir, "sheet.svg");
        double left = d.width, right = 0.0;
        for (guint i = 0; i < d.item->len; i++) {
            left = MIN(left, item(&d, i)->x);
            right = MAX(right, item(&d, i)->x + item(&d, i)->w);
        }
        g_assert_cmpfloat(d.width - right, <, 1.6 * left + 8.0);
        drawing_clear(&d);
    }
    fixture_clear(&f);
}

/* Two rows of 24 cells that would be 40 000 pixels wide: smaller cells, no wider file than viewers read. */
static void test_wide(void)
{
    Fixture f = make_sweep("veins.kill_distance = 1; 2\nwidth.exponent = from 1 to 5 in 24\n");
    put_grown(&f, 0, 40, 40);
    write_sheet(&f, 2048);
    cairo_surface_t *png = read_png(f.dir, "sheet.png");
    g_assert_cmpint(cairo_image_surface_get_width(png), >, 15000);
    g_assert_cmpint(cairo_image_surface_get_width(png), <=, 20000);
    cairo_surface_destroy(png);
    fixture_clear(&f);
}

static char *captions(const char *sweep, gboolean specimen)
{
    Fixture f = make_sweep(sweep);
    SheetDef def = {.cell = 64, .specimen = specimen};
    SheetPlan *p = sheet_plan_new(f.s, f.dir, &def);
    GString *s = g_string_new(NULL);
    for (guint i = 0; i < p->told->len; i++)
        g_string_append_printf(s, "%s%s", i ? " " : "", sweep_key(f.s, g_array_index(p->told, SheetItem, i).key).key);
    sheet_plan_free(p);
    fixture_clear(&f);
    return g_string_free(s, FALSE);
}

/* Captions of many keys: those that differ most, in the file's order. */
static void test_told(void)
{
#define NARROW "growth.final_length = uniform(500, 505)\nwidth.exponent = uniform(2, 2.01)\n"
    static const struct {
        const char *sweep, *told;
        gboolean specimen;
    } c[] = {
        {NARROW "veins.kill_distance = uniform(1, 30)\n", "growth.final_length width.exponent veins.kill_distance", FALSE},
        {NARROW "veins.kill_distance = uniform(1, 30)\nsources.density = log-uniform(0.0001, 0.01)\nwidth.minimum = uniform(1, 3)\n",
         "veins.kill_distance sources.density width.minimum", FALSE},
        /* A word that differs; a length of one value alone does not. */
        {NARROW "width.minimum = uniform(1, 1.1)\nveins.pattern = choice(open; closed)\nveins.kill_distance = choice(3; 3)\n",
         "growth.final_length width.minimum veins.pattern", FALSE},
        /* What the picture doesn't show comes last, points after it. */
        {"texture.lamina_colour = choice(#000000; #ffffff)\nveins.seeds = choice(0,0 | 0,0; 0.1,0)\n" NARROW "veins.pattern = open; closed\n",
         "growth.final_length width.exponent veins.pattern", FALSE},
        {"texture.lamina_colour = choice(#000000; #ffffff)\nveins.seeds = choice(0,0 | 0,0; 0.1,0)\n" NARROW "veins.pattern = open; closed\n",
         "texture.lamina_colour growth.final_length veins.pattern", TRUE},
        {"texture.lamina_colour = choice(#000000; #ffffff)\nveins.seeds = choice(0,0 | 0,0; 0.1,0)\nspecimen.light = uniform(0, 1)\nveins.pattern = open; closed\n",
         "texture.lamina_colour specimen.light veins.pattern", FALSE},
        {"seed = each\n" NARROW "width.minimum = uniform(1, 3)\nveins.kill_distance = uniform(1, 3)\n", "growth.final_length width.minimum veins.kill_distance", FALSE},
    };
    for (gsize i = 0; i < G_N_ELEMENTS(c); i++) {
        char *sweep = g_strconcat("mode = sample\ncount = 200\n", c[i].sweep, NULL), *told = captions(sweep, c[i].specimen);
        g_assert_cmpstr(told, ==, c[i].told);
        g_free(told);
        g_free(sweep);
    }
    /* Ties, and what goes with another as the columns of a table do, but for those that go with nothing. */
    char *told = captions("mode = zip\nveins.kill_distance = 1; 1; 2; 2\nwidth.minimum = 1; 1; 2; 2\nwidth.exponent = 1; 2; 1; 2\nwidth.thickening = 3; 3; 3; 4\n", FALSE);
    g_assert_cmpstr(told, ==, "veins.kill_distance width.exponent width.thickening");
    g_free(told);
    told = captions("mode = zip\nveins.kill_distance = 1; 2\nwidth.minimum = 1; 2\nwidth.exponent = 1; 2\ngrowth.final_length = 500; 1000\n", FALSE);
    g_assert_cmpstr(told, ==, "veins.kill_distance width.minimum width.exponent");
    g_free(told);
}

static bool exists(const Fixture *f, const char *name)
{
    char *path = g_build_filename(f->dir, name, NULL);
    bool there = g_file_test(path, G_FILE_TEST_EXISTS);
    g_free(path);
    return there;
}

/* 1300 cells: three sheets, and the last two go when there is less to show. */
static void test_many(void)
{
    Fixture f = make_sweep("mode = sample\ncount = 1300\nveins.kill_distance = uniform(1, 40)\n");
    for (uint64_t i = 0; i < 1300; i++)
        put_grown(&f, i, 4, 4);
    write_sheet(&f, 32);
    check_pictures(&f, "sheet.svg", "sheet.png", 0, 600);
    check_pictures(&f, "sheet-2.svg", "sheet-2.png", 600, 600);
    check_pictures(&f, "sheet-3.svg", "sheet-3.png", 1200, 100);
    g_assert_false(exists(&f, "sheet-4.svg"));
    Picture d = read_drawing(f.dir, "sheet-3.svg");
    g_assert_true(has_text(&d, "3 of 3") && has_text(&d, "1299"));
    drawing_clear(&d);
    Fixture less = make_sweep("mode = sample\ncount = 7\nveins.kill_distance = uniform(1, 40)\n");
    GError *error = NULL;
    g_assert_true(sheet_write(less.s, f.dir, &(SheetDef){.cell = 32}, &error));
    g_assert_no_error(error);
    g_assert_true(exists(&f, "sheet.svg") && exists(&f, "sheet.png"));
    g_assert_false(exists(&f, "sheet-2.svg") || exists(&f, "sheet-2.png") || exists(&f, "sheet-3.svg") || exists(&f, "sheet-3.png"));
    fixture_clear(&less);
    fixture_clear(&f);
}

/* The bands of the PNG are the drawing as a whole. */
static void test_png_is_svg(void)
{
    Fixture f = make_sweep("veins.pattern = open; closed\nveins.kill_distance = 40; 20; 10\nwidth.exponent = 2; 2.5\n");
    for (uint64_t i = 0; i < 12; i++)
        if (i % 5 == 2)
            put_failed(&f, i, "leaf.ini: [growth] final_length: no");
        else if (i != 10)
            put_grown(&f, i, 37, 51);
    write_sheet(&f, 111);
    cairo_surface_t *png = read_png(f.dir, "sheet.png");
    int w = cairo_image_surface_get_width(png), h = cairo_image_surface_get_height(png);
    char *path = g_build_filename(f.dir, "sheet.svg", NULL);
    GError *error = NULL;
    RsvgHandle *handle = rsvg_handle_new_from_file(path, &error);
    g_assert_no_error(error);
    cairo_surface_t *whole = cairo_image_surface_create(CAIRO_FORMAT_RGB24, w, h);
    cairo_t *cr = cairo_create(whole);
    g_assert_true(rsvg_handle_render_document(handle, cr, &(RsvgRectangle){0.0, 0.0, w, h}, &error));
    cairo_destroy(cr);
    cairo_surface_flush(whole);
    uint64_t different = 0, ink = 0;
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++) {
            different += pixel(png, x, y) != pixel(whole, x, y);
            ink += pixel(png, x, y) != 0xffffff;
        }
    g_assert_cmpuint(different, ==, 0);
    g_assert_cmpuint(ink, >, 10 * 111 * 60);
    g_object_unref(handle);
    g_free(path);
    cairo_surface_destroy(whole);
    cairo_surface_destroy(png);
    fixture_clear(&f);
}

/* Pictures that are none, or broken off; and what can't be written. */
static void test_bad(void)
{
    Fixture f = make_sweep("veins.kill_distance = 1; 2; 3; 4\n");
    GError *error = NULL;
    for (uint64_t i = 0; i < 4; i++)
        put_grown(&f, i, 20, 20);
    Row row;
    row_read(f.s, f.dir, 1, &row);
    g_free(put(f.dir, row.picture, "no picture", -1));
    row_clear(&row);
    row_read(f.s, f.dir, 2, &row);
    char *path = g_build_filename(f.dir, row.picture, NULL), *data, *again;
    gsize n, m;
    g_assert_true(g_file_get_contents(path, &data, &n, NULL));
    g_free(put(f.dir, row.picture, data, 40));
    g_free(data);
    g_free(path);
    row_clear(&row);
    write_sheet(&f, 64);
    Picture d = read_drawing(f.dir, "sheet.svg");
    g_assert_true(has_text(&d, "no picture") || has_text(&d, "no pict"));
    drawing_clear(&d);

    /* Twice the same. */
    path = g_build_filename(f.dir, "sheet.svg", NULL);
    g_assert_true(g_file_get_contents(path, &data, &n, NULL));
    write_sheet(&f, 64);
    g_assert_true(g_file_get_contents(path, &again, &m, NULL));
    g_assert_true(n == m && memcmp(data, again, n) == 0);
    g_free(again);
    g_free(data);
    g_free(path);

    path = g_build_filename(f.dir, "none", NULL);
    g_assert_false(sheet_write(f.s, path, &(SheetDef){.cell = 64}, &error));
    g_assert_error(error, G_FILE_ERROR, G_FILE_ERROR_NOENT);
    g_clear_error(&error);
    g_free(path);

    /* The PNG's place is taken: neither file changes, nothing else is left. */
    path = g_build_filename(f.dir, "sheet.png", NULL);
    g_remove(path);
    g_assert_cmpint(g_mkdir_with_parents(path, 0777), ==, 0);
    g_assert_false(sheet_write(f.s, f.dir, &(SheetDef){.cell = 64}, &error));
    g_assert_nonnull(error);
    g_clear_error(&error);
    GDir *dir = g_dir_open(f.dir, 0, NULL);
    const char *name;
    while ((name = g_dir_read_name(dir)))
        g_assert_false(g_str_has_prefix(name, ".sheet"));
    g_dir_close(dir);
    g_free(path);
    fixture_clear(&f);
}

static void test_labels(void)
{
    Fixture f = make_sweep("veins.kill_distance = 1; 2\nwidth.minimum = 1; 2\nmesh.min_length = 0.1; 0.2\noutline.file = a/b/ovate.leaf.svg\ntexture.lamina_colour = #102030\n"
                           "leaf.title = One\nseed = 4\n");
    static const char *const label[] = {"kill distance", "width minimum", "min length", "outline file", "lamina colour", "leaf title", "seed"};
    static const struct {
        uint32_t key;
        const char *text, *shown;
        int digits;
    } value[] = {{0, "40", "40", 4},        {0, "6e-05", "0.00006", 7}, {0, "1.5e-09", "1.5 × 10⁻⁹", 7}, {0, "1e+21", "1 × 10²¹", 7},  {0, "-3.25", "−3.25", 7},
                 {0, "3.14159265", "3.142", 4}, {0, "123456", "123456", 4},  {0, "0.000123456", "0.0001235", 4}, {0, NULL, "3", 4},       {3, "a/b/ovate.leaf.svg", "ovate.leaf", 4},
                 {5, "", "none", 4},         {5, "12.34567", "12.34567", 4}, {4, "#102030", "#102030", 4},     {6, "9007199254740992", "9007199254740992", 4}};
    for (uint32_t k = 0; k < G_N_ELEMENTS(label); k++) {
        char *text = label_key(f.s, k);
        g_assert_cmpstr(text, ==, label[k]);
        g_free(text);
    }
    for (gsize i = 0; i < G_N_ELEMENTS(value); i++) {
        SweepKey key = sweep_key(f.s, value[i].key);
        char *text = label_value(f.s, &key, value[i].text, value[i].digits);
        g_assert_cmpstr(text, ==, value[i].shown);
        g_free(text);
    }
    SweepKey colour = sweep_key(f.s, 4), length = sweep_key(f.s, 0);
    g_assert_cmpint(label_colour(&colour, "#102030"), ==, 0x102030);
    g_assert_cmpint(label_colour(&length, "#102030"), ==, -1);
    g_assert_cmpstr(label_unit(&colour), ==, "");
    g_assert_cmpstr(label_unit(&length), ==, "segments");
    fixture_clear(&f);

    for (double em = 1.5; em < 30.0; em += 0.7) {
        static const char text[] = "leaf.ini: [growth] final_length = 12: must be at-least/Ünïcödé 葉脈";
        char *cut = label_fit(text, em), **lines = label_wrap(text, em, 4), *whole = g_strjoinv("", lines);
        g_assert_true(g_utf8_validate(cut, -1, NULL) && label_width(cut) <= em + 0.01);
        g_assert_true(label_width(text) > em || strcmp(cut, text) == 0);
        for (char **l = lines; *l; l++)
            g_assert_true(g_utf8_validate(*l, -1, NULL) && label_width(*l) <= em + 0.01);
        g_assert_cmpuint(g_strv_length(lines), <=, 4);
        if (!strstr(whole, "…")) { /* all of it, but for spaces at the breaks */
            char **a = g_strsplit(whole, " ", -1), **b = g_strsplit(text, " ", -1), *c = g_strjoinv("", a), *e = g_strjoinv("", b);
            g_assert_cmpstr(c, ==, e);
            g_strfreev(a);
            g_strfreev(b);
            g_free(c);
            g_free(e);
        }
        g_free(whole);
        g_free(cut);
        g_strfreev(lines);
    }
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/sheet/no-overlap", test_no_overlap);
    g_test_add_func("/sheet/figure", test_figure);
    g_test_add_func("/sheet/matrix", test_matrix);
    g_test_add_func("/sheet/narrow", test_narrow);
    g_test_add_func("/sheet/wide", test_wide);
    g_test_add_func("/sheet/told", test_told);
    g_test_add_func("/sheet/many", test_many);
    g_test_add_func("/sheet/png-is-svg", test_png_is_svg);
    g_test_add_func("/sheet/bad", test_bad);
    g_test_add_func("/sheet/labels", test_labels);
    return g_test_run();
}
