/* The browsing page: its data files read back and compared with every variant; texts that would break a page; and, where Chromium is installed, what it shows. */
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <json-glib/json-glib.h>
#include <stdbool.h>
#include <string.h>

#include "batch/page.h"
#include "batch/page_private.h"
#include "batch/private.h"

#define EVIL "</script><script>alert(1)</script> & \"quoted\" 'single' \\u0041 <!-- ]]> \xe2\x80\xa8 \xe2\x80\xa9 \xc3\x9c"

typedef struct {
    char *dir;
    Sweep *s;
} Fixture;

static Fixture make_sweep(const char *text)
{
    GError *error = NULL;
    Fixture f = {.dir = g_dir_make_tmp("venation-page-XXXXXX", &error)};
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

static void put(const char *dir, const char *relative, const char *text)
{
    char *path = g_build_filename(dir, relative, NULL), *folder = g_path_get_dirname(path);
    g_assert_cmpint(g_mkdir_with_parents(folder, 0777), ==, 0);
    g_assert_true(g_file_set_contents(path, text, -1, NULL));
    g_free(folder);
    g_free(path);
}

/* Every seventh variant failed, every eleventh is missing, the rest is grown, every other one with a picture. */
static RowOutcome outcome_of(uint64_t i) { return i % 7 == 3 ? ROW_FAILED : i % 11 == 5 ? ROW_MISSING : ROW_GROWN; }

static void put_rows(const Fixture *f)
{
    GString *evil = g_string_new(NULL);
    page_string(evil, EVIL); /* JSON, too */
    for (uint64_t i = 0; i < sweep_count(f->s); i++) {
        SweepVariant v;
        sweep_variant(f->s, i, &v);
        char *folder = row_folder(f->s, &v), *row = g_build_filename(folder, "sweep.json", NULL), *picture = g_build_filename(folder, "sweep.png", NULL),
             *failed = row_failed(&v), *begin = g_strdup_printf("{\"index\": %" G_GUINT64_FORMAT ", \"variant\": \"%s\", \"outcome\": ", i, v.name), *json;
        if (outcome_of(i) == ROW_FAILED) {
            json = g_strdup_printf("%s\"failed\", \"error\": %s, \"folder\": null}\n", begin, evil->str);
            put(f->dir, failed, json);
            g_free(json);
        } else if (outcome_of(i) == ROW_GROWN) {
            json = g_strdup_printf("%s\"grown\", \"error\": null, \"folder\": \"%s\", \"nodes\": %" G_GUINT64_FORMAT
                                   ", \"vein_density\": 0.1, \"end\": %s, \"network_hash\": \"%016" G_GINT64_MODIFIER "x\", \"odd\": [1, 2], \"@own\": 7}\n",
                                   begin, folder, i * i, evil->str, i);
            put(f->dir, row, json);
            g_free(json);
            if (i % 2)
                put(f->dir, picture, "picture");
            char *drawing = g_strdup_printf("%s/%s.svg", folder, v.name), *hidden = g_strdup_printf("%s/.hidden", folder);
            put(f->dir, drawing, "drawing");
            put(f->dir, hidden, "hidden");
            g_free(drawing);
            g_free(hidden);
        }
        g_free(folder);
        g_free(row);
        g_free(picture);
        g_free(failed);
        g_free(begin);
        sweep_variant_clear(&v);
    }
    g_string_free(evil, TRUE);
}

static char *read_file(const Fixture *f, const char *name)
{
    char *path = g_build_filename(f->dir, name, NULL), *text = NULL;
    if (!g_file_get_contents(path, &text, NULL, NULL))
        text = NULL;
    g_free(path);
    return text;
}

static void write_page(const Fixture *f, const char *title)
{
    GError *error = NULL;
    g_assert_true(page_write(f->s, sweep_params(f->s), f->dir, &(PageDef){.title = title}, &error));
    g_assert_no_error(error);
}

/* ---- data files, read back ---- */

/* What stands between the outer brackets of a call is JSON, once its first numbers are off. */
static JsonNode *read_call(const Fixture *f, const char *file, const char *function, uint64_t number[2])
{
    char *text = read_file(f, file);
    g_assert_nonnull(text);
    g_assert_null(strchr(text, '<')); /* no tag can begin or end, no comment either */
    g_assert_null(strstr(text, "\xe2\x80\xa8"));
    g_assert_true(g_str_has_prefix(text, function));
    g_assert_true(g_str_has_suffix(text, "});\n"));
    const char *at = text + strlen(function);
    for (int i = 0; *at != '{'; i++) {
        char *end;
        g_assert_cmpint(i, <, 2);
        number[i] = g_ascii_strtoull(at, &end, 10);
        g_assert_cmpint(*end, ==, ',');
        at = end + 1;
    }
    text[strlen(text) - 3] = '\0';
    GError *error = NULL;
    JsonNode *node = json_from_string(at, &error);
    g_assert_no_error(error);
    g_free(text);
    return node;
}

/* A cell of a column as JSON text. */
static char *cell(JsonObject *columns, const char *name, uint64_t i)
{
    JsonNode *c = json_object_get_member(columns, name);
    if (!c)
        return g_strdup("null");
    if (JSON_NODE_HOLDS_ARRAY(c))
        return json_to_string(json_array_get_element(json_node_get_array(c), (guint)i), FALSE);
    JsonObject *o = json_node_get_object(c);
    if (json_object_has_member(o, "c"))
        return json_to_string(json_object_get_member(o, "c"), FALSE);
    gint64 at = json_array_get_int_element(json_object_get_array_member(o, "i"), (guint)i);
    return json_to_string(json_array_get_element(json_object_get_array_member(o, "d"), (guint)at), FALSE);
}

static void expect(JsonObject *columns, const char *name, uint64_t i, const char *json)
{
    char *found = cell(columns, name, i);
    g_assert_cmpstr(found, ==, json);
    g_free(found);
}

static char *json_text(const char *text)
{
    JsonNode *node = json_node_init_string(json_node_alloc(), text);
    char *json = json_to_string(node, FALSE);
    json_node_unref(node);
    return json;
}

static void expect_text(JsonObject *columns, const char *name, uint64_t i, const char *text)
{
    char *json = json_text(text);
    expect(columns, name, i, json);
    g_free(json);
}

static void check_row(const Fixture *f, JsonObject *columns, uint64_t at, uint64_t i)
{
    static const char *const outcome[] = {"0", "1", "2"};
    SweepVariant v;
    sweep_variant(f->s, i, &v);
    RowOutcome o = outcome_of(i);
    char *square = g_strdup_printf("%" G_GUINT64_FORMAT, i * i), *folder = row_folder(f->s, &v), *parent = g_path_get_dirname(folder);
    expect_text(columns, "@name", at, v.name);
    expect(columns, "@outcome", at, outcome[o]);
    expect(columns, "nodes", at, o == ROW_GROWN ? square : "null");
    expect(columns, "vein_density", at, o == ROW_GROWN ? "0.10000000000000001" : "null"); /* JSON-GLib's way to write 0.1 */
    if (o == ROW_GROWN) {
        expect_text(columns, "@folder", at, parent);
        expect(columns, "@own", at, "1");
        expect_text(columns, "@files", at, i % 2 ? "*.svg/sweep.json/sweep.png" : "*.svg/sweep.json");
        expect(columns, "@picture", at, i % 2 ? "\"sweep.png\"" : "null");
        expect_text(columns, "end", at, EVIL);
        expect_text(columns, "odd", at, "[1,2]");
    } else {
        expect(columns, "@folder", at, "null");
        expect(columns, "@picture", at, "null");
    }
    if (o == ROW_FAILED)
        expect_text(columns, "@error", at, EVIL);
    for (uint32_t k = 0; k < v.n; k++) {
        SweepKey key = sweep_key(f->s, k);
        char *found = cell(columns, key.key, at), *text = json_text(v.value[k] ? v.value[k] : "");
        bool number = key.id < 0 || param_info((ParamId)key.id)->type == TYPE_NUMBER;
        if (!v.value[k])
            g_assert_cmpstr(found, ==, "null");
        else if (number)
            g_assert_cmpfloat(g_ascii_strtod(found, NULL), ==, g_ascii_strtod(v.value[k], NULL));
        else
            g_assert_cmpstr(found, ==, text);
        g_assert_cmpint(number && v.value[k] ? *found != '"' : true, ==, true);
        g_free(found);
        g_free(text);
    }
    g_free(square);
    g_free(folder);
    g_free(parent);
    sweep_variant_clear(&v);
}

static void check_data(const Fixture *f, uint64_t chunks)
{
    uint64_t seen = 0, number[2] = {0, 0};
    for (uint64_t c = 0; c < chunks; c++) {
        char *name = g_strdup_printf("page/%" G_GUINT64_FORMAT ".js", c);
        JsonNode *node = read_call(f, name, "venationRows(", number);
        g_assert_cmpuint(number[0], ==, seen);
        for (uint64_t i = 0; i < number[1]; i++)
            check_row(f, json_node_get_object(node), i, seen + i);
        seen += number[1];
        json_node_unref(node);
        g_free(name);
    }
    g_assert_cmpuint(seen, ==, sweep_count(f->s));
}

/* ---- tests ---- */

static void test_data(void)
{
    Fixture f = make_sweep("mode = sample\ncount = 2345\nseed = each\nveins.kill_distance = uniform(1, 40)\ntexture.lamina_colour = choice(#35602b; #ffffff)\n"
                           "veins.pattern = choice(open; closed)\nwidth.minimum = 0.00001; 1\nleaf.title = choice(" EVIL " | b)\n");
    put_rows(&f);
    write_page(&f, NULL);
    check_data(&f, 3);
    uint64_t none[2];
    JsonNode *node = read_call(&f, "page/sweep.js", "venationSweep(", none);
    JsonObject *o = json_node_get_object(node);
    g_assert_cmpstr(json_object_get_string_member(o, "title"), ==, "some-sweep");
    g_assert_cmpint(json_object_get_int_member(o, "count"), ==, 2345);
    g_assert_cmpint(json_object_get_int_member(o, "chunks"), ==, 3);
    JsonArray *keys = json_object_get_array_member(o, "keys");
    g_assert_cmpuint(json_array_get_length(keys), ==, 6);
    JsonObject *key = json_array_get_object_element(keys, 1);
    g_assert_cmpstr(json_object_get_string_member(key, "key"), ==, "veins.kill_distance");
    g_assert_cmpstr(json_object_get_string_member(key, "label"), ==, "kill distance");
    g_assert_cmpstr(json_object_get_string_member(key, "unit"), ==, "segments");
    g_assert_cmpstr(json_object_get_string_member(key, "own"), ==, "3");
    json_node_unref(node);
    fixture_clear(&f);
}

/* Folders of large sweeps, and that parts of a former, larger one go. */
static void test_large(void)
{
    Fixture f = make_sweep("mode = sample\ncount = 10001\nveins.kill_distance = uniform(1, 40)\n"), less = make_sweep("veins.kill_distance = 1; 2; 3\n");
    write_page(&f, NULL);
    char *last = read_file(&f, "page/10.js"), *folder = g_strdup(f.dir);
    g_assert_nonnull(last);
    g_free(last);
    SweepVariant v;
    sweep_variant(f.s, 4321, &v);
    char *place = row_folder(f.s, &v), *row = g_build_filename(place, "sweep.json", NULL),
         *json = g_strdup_printf("{\"index\": 4321, \"variant\": \"%s\", \"outcome\": \"grown\"}", v.name);
    put(f.dir, row, json);
    write_page(&f, NULL);
    uint64_t number[2];
    JsonNode *node = read_call(&f, "page/4.js", "venationRows(", number);
    expect(json_node_get_object(node), "@folder", 321, "\"leaves/004\"");
    expect(json_node_get_object(node), "@outcome", 320, "2");
    json_node_unref(node);
    GError *error = NULL;
    g_assert_true(page_write(less.s, sweep_params(less.s), folder, &(PageDef){0}, &error));
    g_assert_no_error(error);
    char *first = read_file(&f, "page/0.js");
    g_assert_nonnull(first);
    for (int i = 1; i < 12; i++) {
        char *name = g_strdup_printf("page/%d.js", i), *text = read_file(&f, name);
        g_assert_null(text);
        g_free(name);
    }
    g_free(first);
    g_free(json);
    g_free(row);
    g_free(place);
    g_free(folder);
    sweep_variant_clear(&v);
    fixture_clear(&less);
    fixture_clear(&f);
}

static void test_page_text(void)
{
    Fixture f = make_sweep("veins.kill_distance = 1; 2; 3\n");
    put_rows(&f);
    write_page(&f, EVIL);
    char *page = read_file(&f, "index.html");
    g_assert_null(strstr(page, "@@"));
    g_assert_null(strstr(page, "alert(1)</script>"));
    g_assert_nonnull(strstr(page, "<title>&lt;/script&gt;&lt;script&gt;alert(1)"));
    g_assert_nonnull(strstr(page, "function venationRows("));
    g_assert_nonnull(strstr(page, ".histogram"));
    /* No network: the one address is a name space. */
    for (const char *c = page; (c = strstr(c, "://")) != NULL; c++)
        g_assert_true(g_str_has_prefix(c, "://www.w3.org/2000/svg\""));
    g_assert_null(strstr(page, "url("));
    g_assert_null(strstr(page, "innerHTML"));
    char *again;
    write_page(&f, EVIL);
    again = read_file(&f, "index.html");
    g_assert_cmpstr(page, ==, again);
    g_free(again);
    g_free(page);

    GError *error = NULL;
    put(f.dir, "taken", "a file");
    char *path = g_build_filename(f.dir, "taken", NULL);
    g_assert_false(page_write(f.s, sweep_params(f.s), path, &(PageDef){0}, &error));
    g_assert_nonnull(error);
    g_assert_cmpuint(error->domain, ==, G_FILE_ERROR);
    g_clear_error(&error);
    g_free(path);
    fixture_clear(&f);
}

/* The document as Chromium has it once all is loaded. */
static char *browse(const Fixture *f, const char *page, const char *hash)
{
    char *path = g_build_filename(f->dir, page, NULL), *profile = g_build_filename(f->dir, "profile", NULL), *own = g_strconcat("--user-data-dir=", profile, NULL),
         *uri = g_filename_to_uri(path, NULL, NULL), *address = g_strconcat(uri, hash, NULL), *text = NULL;
    const char *argv[] = {"chromium", "--headless", "--no-sandbox", "--disable-gpu", "--window-size=1300,900", "--virtual-time-budget=5000", own, "--dump-dom", address, NULL};
    int status = 0;
    GError *error = NULL;
    g_assert_true(g_spawn_sync(NULL, (char **)argv, NULL, G_SPAWN_SEARCH_PATH | G_SPAWN_STDERR_TO_DEV_NULL, NULL, NULL, &text, NULL, &status, &error));
    g_assert_no_error(error);
    g_free(path);
    g_free(profile);
    g_free(own);
    g_free(uri);
    g_free(address);
    return text;
}

static uint32_t count_of(const char *text, const char *what)
{
    uint32_t n = 0;
    for (const char *c = text; (c = strstr(c, what)) != NULL; c++)
        n++;
    return n;
}

/* Whether there is a browser that runs. ./run test installs one, so there it is no excuse that there is none. */
static bool has_browser(const char *shown)
{
    char *program = g_find_program_in_path("chromium");
    bool good = program && (!shown || strstr(shown, "id=\"count\""));
    const char *why = program ? "chromium doesn't run here" : "there is no chromium";
    if (!good && g_strcmp0(g_getenv("VENATION_REQUIRE"), "all") == 0)
        g_error("%s", why);
    if (!good)
        g_test_skip(why);
    g_free(program);
    return good;
}

#define BROWSED "veins.kill_distance = 10; 20; 30; 40\nveins.pattern = open; closed\nleaf.title = " EVIL " | b\nwidth.exponent = uniform(2, 3)\n"

static void test_browser(void)
{
    if (!has_browser(NULL))
        return;
    Fixture f = make_sweep(BROWSED);
    put_rows(&f);
    write_page(&f, EVIL);
    char *all = browse(&f, "index.html", ""), *some = NULL, *one = NULL, *none = NULL;
    if (has_browser(all)) {
        some = browse(&f, "index.html", "#sort=-nodes&f.veins.pattern==open&f.veins.kill_distance==20&f.veins.kill_distance==40");
        one = browse(&f, "index.html", "#v=4");
        none = browse(&f, "index.html", "#q=nothing+like+this");
        g_assert_nonnull(strstr(all, ">16 variants</p>"));
        g_assert_cmpuint(count_of(all, "class=\"leaf\""), ==, 16);
        g_assert_null(strstr(all, "<script>alert(1)</script>"));
        g_assert_nonnull(strstr(some, ">4 of 16</p>"));
        g_assert_cmpuint(count_of(some, "class=\"leaf\""), ==, 4);
        /* Of 4, 5, 12 and 13 those with pattern open, the most nodes first; 5 is missing and has none: last. */
        const char *first = strstr(some, "id=\"leaf-13\""), *second = strstr(some, "id=\"leaf-12\""), *third = strstr(some, "id=\"leaf-4\""), *last = strstr(some, "id=\"leaf-5\"");
        g_assert_true(first && second && third && last && first < second && second < third && third < last);
        g_assert_nonnull(strstr(one, "id=\"one-name\""));
        g_assert_nonnull(strstr(one, "venation grow leaf.ini"));
        g_assert_nonnull(strstr(one, "--set veins.kill_distance=20"));
        g_assert_nonnull(strstr(one, "--seed 1"));
        g_assert_nonnull(strstr(none, ">0 of 16</p>"));
        g_assert_cmpuint(count_of(none, "class=\"leaf\""), ==, 0);
    }
    g_free(all);
    g_free(some);
    g_free(one);
    g_free(none);
    fixture_clear(&f);
}

/* What a hand does in the column of filters, and after each step a line of what is shown then. A browser without a window, whose time runs as it likes, draws
 * next to no frames, so that what waits for one waits for the clock here. */
static const char DRIVER[] =
    "<pre id=\"driven\"></pre><script>\n"
    "window.requestAnimationFrame = f => setTimeout(f, 16);\n"
    "window.cancelAnimationFrame = clearTimeout;\n"
    "const wait = () => new Promise(done => setTimeout(done, 200));\n"
    "const box = label => [...document.querySelectorAll('fieldset')].find(b => b.querySelector('legend').firstChild.data === label);\n"
    "const tell = step => document.getElementById('driven').append(step + ': ' + [...document.querySelectorAll('.leaf')].map(l => l.id.slice(5)).sort((a, b) => a - b)\n"
    "  .join(' ') + ' | ' + document.getElementById('count').textContent + ' | ' + decodeURIComponent(location.hash) + '\\n');\n"
    "const slide = (input, value) => { input.value = value; input.dispatchEvent(new Event('input', { bubbles: true })); };\n"
    "const type = (input, value) => { input.value = value; input.dispatchEvent(new Event('change', { bubbles: true })); };\n"
    "(async () => {\n"
    "  while (!document.querySelector('.leaf')) await wait();\n"
    "  const open = [...box('veins pattern').querySelectorAll('label')].find(l => l.querySelector('.text').textContent === 'open').querySelector('input');\n"
    "  const [least, most] = box('width exponent').querySelectorAll('input[type=range]'), [low] = box('width exponent').querySelectorAll('input[type=number]');\n"
    "  open.click(); await wait(); tell('box');\n"
    "  slide(least, 400); await wait(); tell('both');\n"
    "  open.click(); await wait(); tell('range');\n"
    "  slide(most, 700); await wait(); tell('between');\n"
    "  type(low, '2.5'); await wait(); tell('typed');\n"
    "  box('width exponent').querySelector('.clear').click(); await wait(); tell('cleared');\n"
    "})();\n"
    "</script>\n</body>";

/* "STEP: 1 2 … | COUNT | ADDRESS" is of the leaves that the parameters say. */
static void check_driven(const Fixture *f, const char *shown, const char *step, bool open, double low, double high)
{
    GString *wanted = g_string_new(NULL);
    guint n = 0;
    g_string_append_printf(wanted, "%s:", step);
    for (uint64_t i = 0; i < sweep_count(f->s); i++) {
        SweepVariant v;
        sweep_variant(f->s, i, &v);
        double exponent = g_ascii_strtod(v.value[3], NULL);
        if ((!open || strcmp(v.value[1], "open") == 0) && exponent >= low && exponent <= high) {
            g_string_append_printf(wanted, " %" G_GUINT64_FORMAT, i);
            n++;
        }
        sweep_variant_clear(&v);
    }
    g_string_append_printf(wanted, n < 16 ? " | %u of 16 |" : " | %u variants |", n);
    if (!strstr(shown, wanted->str))
        g_error("no '%s' in\n%s", wanted->str, shown);
    g_string_free(wanted, TRUE);
}

/* A bound that the address has after a step. */
static double bound(const char *shown, const char *step, bool upper)
{
    char *line = g_strdup_printf("%s:", step);
    const char *at = strstr(shown, line);
    at = at ? strstr(at, "f.width.exponent=") : NULL;
    g_assert_nonnull(at);
    char *end;
    double low = g_ascii_strtod(at + strlen("f.width.exponent="), &end);
    g_assert_true(g_str_has_prefix(end, ".."));
    g_free(line);
    return upper ? g_ascii_strtod(end + 2, NULL) : low;
}

static void test_filters(void)
{
    if (!has_browser(NULL))
        return;
    Fixture f = make_sweep(BROWSED);
    put_rows(&f);
    write_page(&f, "filters");
    char *page = read_file(&f, "index.html"), **parts = g_strsplit(page, "</body>", 2), *driven = g_strjoinv(DRIVER, parts);
    put(f.dir, "driven.html", driven);
    char *document = browse(&f, "driven.html", ""), *shown = document ? strstr(document, "<pre id=\"driven\">") : NULL;
    if (has_browser(document)) {
        g_assert_nonnull(shown);
        double low = bound(shown, "range", false), high = bound(shown, "between", true);
        g_assert_true(low > 2.2 && low < 2.6 && high > low && high < 2.9); /* two fifths and seven tenths of what there is */
        check_driven(&f, shown, "box", true, 0.0, 9.0);
        check_driven(&f, shown, "both", true, low, 9.0);
        check_driven(&f, shown, "range", false, low, 9.0);
        check_driven(&f, shown, "between", false, low, high);
        check_driven(&f, shown, "typed", false, 2.5, high);
        check_driven(&f, shown, "cleared", false, 0.0, 9.0);
    }
    g_free(document);
    g_free(driven);
    g_strfreev(parts);
    g_free(page);
    fixture_clear(&f);
}

/* The captions tell what the sheet's do, and lists of points filter last. */
static void test_captions(void)
{
    Fixture f = make_sweep("mode = sample\ncount = 30\nveins.seeds = 0,0 | 0,0; 0.1,0.2\nwidth.minimum = uniform(0.9, 1)\nwidth.exponent = uniform(2, 2.1)\nveins.kill_distance = uniform(1, 40)\n"
                           "veins.pattern = choice(open; closed)\nseed = each\ntexture.lamina_colour = choice(#000000; #ffffff)\n");
    put_rows(&f);
    write_page(&f, NULL);
    uint64_t none[2];
    JsonNode *node = read_call(&f, "page/sweep.js", "venationSweep(", none);
    JsonArray *told = json_object_get_array_member(json_node_get_object(node), "told");
    static const char *const wanted[] = {"width.minimum", "veins.kill_distance", "veins.pattern"};
    g_assert_cmpuint(json_array_get_length(told), ==, 3);
    for (guint i = 0; i < 3; i++)
        g_assert_cmpstr(json_array_get_string_element(told, i), ==, wanted[i]);
    json_node_unref(node);
    char *all = has_browser(NULL) ? browse(&f, "index.html", "") : NULL;
    if (all && has_browser(all)) {
        g_assert_cmpuint(count_of(all, "<span class=\"label\">kill distance </span>"), >, 10);
        g_assert_cmpuint(count_of(all, "<span class=\"label\">veins seeds </span>"), ==, 0);
        const char *last = strstr(all, "filter of veins seeds\""), *before = strstr(all, "filter of lamina colour\"");
        g_assert_true(last && before && before < last);
    }
    g_free(all);
    fixture_clear(&f);
}

/* The same bytes whatever way the sweep file was named. */
static void test_paths(void)
{
    static const char text[] = "[sweep]\nparams = leaf.ini\nveins.kill_distance = 1; 2\n";
    GError *error = NULL;
    Fixture f = make_sweep("veins.kill_distance = 1; 2\n");
    char *here = g_get_current_dir(), *name = g_path_get_basename(f.dir), *wanted = NULL;
    g_assert_cmpint(g_chdir(f.dir), ==, 0);
    char *paths[] = {g_strdup("some-sweep.ini"), g_strdup("./some-sweep.ini"), g_build_filename(f.dir, "some-sweep.ini", NULL), g_strdup_printf("../%s/some-sweep.ini", name)};
    for (gsize i = 0; i < G_N_ELEMENTS(paths); i++) {
        Sweep *s = sweep_parse(text, strlen(text), paths[i], &error);
        g_assert_no_error(error);
        Params *p = params_copy(sweep_params(s));
        g_assert_true(params_override(p, "outline.file=../leaves/a b.svg", &error));
        g_assert_true(page_write(s, p, f.dir, &(PageDef){0}, &error));
        g_assert_no_error(error);
        char *found = read_file(&f, "page/sweep.js");
        g_assert_nonnull(strstr(found, "\"params\":\"leaf.ini\""));
        g_assert_nonnull(strstr(found, "\"outline.file=../leaves/a b.svg\""));
        if (wanted)
            g_assert_cmpstr(found, ==, wanted);
        else
            wanted = g_strdup(found);
        g_free(found);
        g_free(paths[i]);
        params_free(p);
        sweep_free(s);
    }
    g_assert_cmpint(g_chdir(here), ==, 0);
    g_free(wanted);
    g_free(name);
    g_free(here);
    fixture_clear(&f);
}

static void test_strings(void)
{
    GString *s = g_string_new(NULL);
    page_string(s, NULL);
    page_string(s, "a\"b\\c<\n\t\x7f\xff");
    g_assert_cmpstr(s->str, ==, "null\"a\\\"b\\\\c\\u003c\\u000a\\u0009\\u007f\xef\xbf\xbd\"");
    g_string_free(s, TRUE);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/page/strings", test_strings);
    g_test_add_func("/page/data", test_data);
    g_test_add_func("/page/large", test_large);
    g_test_add_func("/page/text", test_page_text);
    g_test_add_func("/page/paths", test_paths);
    g_test_add_func("/page/browser", test_browser);
    g_test_add_func("/page/filters", test_filters);
    g_test_add_func("/page/captions", test_captions);
    return g_test_run();
}
