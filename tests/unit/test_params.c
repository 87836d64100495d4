/* Parameter table, values, files, messages. */
#include <glib.h>
#include <glib/gstdio.h>
#include <string.h>

#include "geom/random.h"
#include "param/params.h"
#include "param/suggest.h"

static Params *parse(const char *text, GError **error)
{
    return params_parse(text, strlen(text), "params/poplar.ini", error);
}

static void check_error(GError *error, int code, const char *message)
{
    g_assert_nonnull(error);
    g_assert_cmpstr(error->message, ==, message);
    g_assert_error(error, PARAM_ERROR, code);
    g_error_free(error);
}

static void check_refused(const char *text, int code, const char *message)
{
    GError *error = NULL;
    g_assert_null(parse(text, &error));
    check_error(error, code, message);
}

static void check_override_refused(const char *assignment, int code, const char *message)
{
    GError *error = NULL;
    Params *p = params_new();
    char *before = params_to_file(p);
    g_assert_false(params_override(p, assignment, &error));
    char *after = params_to_file(p);
    g_assert_cmpstr(before, ==, after);
    check_error(error, code, message);
    g_free(before);
    g_free(after);
    params_free(p);
}

static void test_table(void)
{
    for (int i = 0; i < PARAM_COUNT; i++) {
        const ParamInfo *info = param_info((ParamId)i);
        char *dotted = g_strdup_printf("%s.%s", info->section, info->key);
        g_assert_cmpint(param_find(dotted), ==, i); /* also: no two alike */
        g_assert_true(*info->doc && !strchr(info->doc, '\n'));
        if (info->type == TYPE_NUMBER || info->type == TYPE_INTEGER)
            g_assert_cmpfloat(info->low, <, info->high);
        g_assert_true((info->type == TYPE_CHOICE) == (*info->choices != '\0'));
        char *allowed = param_allowed((ParamId)i);
        g_assert_true(*allowed);
        g_free(allowed);
        g_free(dotted);
    }
    g_assert_cmpint(param_find("veins"), ==, -1);
    g_assert_cmpint(param_find("vein.pattern"), ==, -1);
    g_assert_cmpint(param_find("veins."), ==, -1);
}

static void test_allowed(void)
{
    static const struct {
        ParamId id;
        const char *allowed;
    } cases[] = {
        {PARAM_VEINS_KILL_DISTANCE, "a number from 0 to 1e6 (segments)"},
        {PARAM_OUTLINE_FLATNESS, "a number from 1e-6 to 0.1 (leaf lengths)"},
        {PARAM_TEXTURE_SIZE, "a whole number from 16 to 16384 (pixels)"},
        {PARAM_GROWTH_STEPS, "a whole number from 0 to 1000000 (steps)"},
        {PARAM_VEINS_PATTERN, "open or closed"},
        {PARAM_SOURCES_PLACEMENT, "one of darts, margin or list"},
        {PARAM_OUTLINE_MIRROR, "yes or no"},
        {PARAM_TEXTURE_VEIN_COLOUR, "a colour #rrggbb"},
        {PARAM_OUTLINE_TEETH_AMPLITUDE, "numbers from 0 to 0.5 (leaf lengths), separated by ';'"},
    };
    for (gsize i = 0; i < G_N_ELEMENTS(cases); i++) {
        char *allowed = param_allowed(cases[i].id);
        g_assert_cmpstr(allowed, ==, cases[i].allowed);
        g_free(allowed);
    }
}

static void test_read(void)
{
    GError *error = NULL;
    Params *p = parse("\xEF\xBB\xBF# a comment\r\n\r\n; another = one\n[leaf]\ntitle =  Ahorn = \xC3\xA4 # ; \"x\"  \n"
                      "[ veins ]\n  kill_distance=2.5\nseeds = 0,0; -0.25 , 1e-1;\npattern = open\n"
                      "[outline]\nmirror = TRUE\nfile = outlines/a b.svg\nteeth_count = 3;40\n"
                      "[leaf]\nsource =\n[texture]\nsize = +512\nvein_colour = #FFa001",
                      &error);
    g_assert_no_error(error);
    g_assert_cmpstr(params_text(p, PARAM_LEAF_TITLE), ==, "Ahorn = \xC3\xA4 # ; \"x\"");
    g_assert_cmpstr(params_text(p, PARAM_LEAF_SOURCE), ==, "");
    g_assert_cmpfloat(params_number(p, PARAM_VEINS_KILL_DISTANCE), ==, 2.5);
    g_assert_cmpint(params_choice(p, PARAM_VEINS_PATTERN), ==, 0);
    g_assert_true(params_switch(p, PARAM_OUTLINE_MIRROR));
    g_assert_cmpint(params_integer(p, PARAM_TEXTURE_SIZE), ==, 512);
    g_assert_cmphex(params_colour(p, PARAM_TEXTURE_VEIN_COLOUR), ==, 0xFFA001);
    uint32_t n;
    const double *list = params_list(p, PARAM_VEINS_SEEDS, &n);
    g_assert_cmpuint(n, ==, 2);
    g_assert_cmpfloat(list[2], ==, -0.25);
    g_assert_cmpfloat(list[3], ==, 0.1);
    list = params_list(p, PARAM_OUTLINE_TEETH_COUNT, &n);
    g_assert_cmpuint(n, ==, 2);
    g_assert_cmpfloat(list[0] * list[1], ==, 120);
    params_list(p, PARAM_OUTLINE_TEETH_AMPLITUDE, &n);
    g_assert_cmpuint(n, ==, 0);
    g_assert_true(params_is_given(p, PARAM_LEAF_SOURCE));
    g_assert_cmpstr(params_origin(p, PARAM_LEAF_SOURCE), ==, "params/poplar.ini");
    g_assert_false(params_is_given(p, PARAM_WIDTH_EXPONENT));
    g_assert_cmpfloat(params_number(p, PARAM_WIDTH_EXPONENT), ==, 2);
    params_free(p);
}

/* FILE values start at the parameter file's folder, or the working folder for --set, and are written back as they were.
 */
static void test_files(void)
{
    Params *p = parse("[outline]\nfile = outlines/a.svg\n[sources]\nfile = /tmp/s.csv\n", NULL);
    g_assert_cmpstr(params_text(p, PARAM_OUTLINE_FILE), ==, "params/outlines/a.svg");
    g_assert_cmpstr(params_text(p, PARAM_SOURCES_FILE), ==, "/tmp/s.csv");
    char *written = params_format(p, PARAM_OUTLINE_FILE);
    g_assert_cmpstr(written, ==, "outlines/a.svg");
    g_free(written);
    Params *copy = params_copy(p);
    g_assert_true(params_override(p, "outline.file=b.svg", NULL));
    g_assert_cmpstr(params_text(p, PARAM_OUTLINE_FILE), ==, "b.svg");
    g_assert_cmpstr(params_origin(p, PARAM_OUTLINE_FILE), ==, "--set");
    g_assert_cmpstr(params_text(copy, PARAM_OUTLINE_FILE), ==, "params/outlines/a.svg");
    g_assert_cmpstr(params_origin(copy, PARAM_OUTLINE_FILE), ==, "params/poplar.ini");
    g_assert_true(params_override(p, "outline.file=", NULL));
    g_assert_cmpstr(params_text(p, PARAM_OUTLINE_FILE), ==, "");
    params_free(copy);
    params_free(p);
    p = params_parse("[outline]\nfile = a.svg\n", 23, "here.ini", NULL);
    g_assert_cmpstr(params_text(p, PARAM_OUTLINE_FILE), ==, "a.svg");
    params_free(p);
}

static void test_messages(void)
{
    check_refused("\n# x\n[veins]\n\nkill_distance = -3\n", PARAM_ERROR_VALUE,
                  "params/poplar.ini:5: [veins] kill_distance = -3: must be a number from 0 to 1e6 (segments)");
    check_refused("[veins]\nkil_distance = 3\n", PARAM_ERROR_UNKNOWN,
                  "params/poplar.ini:2: [veins] kil_distance: no such key; did you mean 'kill_distance'?");
    check_refused("[sources]\nkill_distance = 3\n", PARAM_ERROR_UNKNOWN,
                  "params/poplar.ini:2: [sources] kill_distance: no such key; it is in [veins]");
    check_refused(
        "[growth]\nkil-distance = 3\n", PARAM_ERROR_UNKNOWN,
        "params/poplar.ini:2: [growth] kil-distance: no such key; did you mean 'kill_distance', which is in [veins]?");
    check_refused("[width]\nzzzzzzzzzzzz = 3\n", PARAM_ERROR_UNKNOWN,
                  "params/poplar.ini:2: [width] zzzzzzzzzzzz: no such key; its keys are exponent, minimum, thickening, "
                  "rank_ratio");
    check_refused("[vein]\n", PARAM_ERROR_UNKNOWN,
                  "params/poplar.ini:1: [vein]: no such section; did you mean [veins]?");
    check_refused("[Veins]\n", PARAM_ERROR_UNKNOWN,
                  "params/poplar.ini:1: [Veins]: no such section; did you mean [veins]?");
    check_refused(
        "[]\n", PARAM_ERROR_UNKNOWN,
        "params/poplar.ini:1: []: no such section; sections are leaf, outline, scan, growth, sources, veins, lsystem, width, "
        "texture, specimen, mesh, pose, export");
    check_refused("[veins\n", PARAM_ERROR_FILE,
                  "params/poplar.ini:1: [veins: a section's name stands in brackets, as [veins]");
    check_refused("[\n", PARAM_ERROR_FILE, "params/poplar.ini:1: [: a section's name stands in brackets, as [veins]");
    check_refused("[veins]\npattern open\n", PARAM_ERROR_FILE,
                  "params/poplar.ini:2: 'pattern open': must be key = value, [section], or a comment after # or ;");
    check_refused("[veins]\n= 3\n", PARAM_ERROR_FILE,
                  "params/poplar.ini:2: '= 3': must be key = value, [section], or a comment after # or ;");
    check_refused("pattern = open\n", PARAM_ERROR_FILE,
                  "params/poplar.ini:1: pattern: a [section] must come before the first key");
    check_refused("[veins]\npattern = open\n[leaf]\n[veins]\npattern = open\n", PARAM_ERROR_FILE,
                  "params/poplar.ini:5: [veins] pattern: already given in line 2");
    check_refused("[veins]\npattern = opne\n", PARAM_ERROR_VALUE,
                  "params/poplar.ini:2: [veins] pattern = opne: must be open or closed; did you mean 'open'?");
    check_refused(
        "[veins]\nkill_distance = 3 # segments\n", PARAM_ERROR_VALUE,
        "params/poplar.ini:2: [veins] kill_distance = 3 # segments: must be a number from 0 to 1e6 (segments); "
        "a comment stands on a line of its own");
    check_refused("[veins]\nkill_distance =\n", PARAM_ERROR_VALUE,
                  "params/poplar.ini:2: [veins] kill_distance = : must be a number from 0 to 1e6 (segments)");
    check_refused("[leaf]\n\ntitle = \xff\n", PARAM_ERROR_FILE, "params/poplar.ini:3: not UTF-8 text");
    check_refused("[leaf]\ntitle = a\x1b[31m\n", PARAM_ERROR_VALUE,
                  "params/poplar.ini:2: [leaf] title = a\xEF\xBF\xBD[31m: must be text on one line");
    GError *error = NULL;
    g_assert_null(params_parse("[leaf]\0\n", 8, "x.ini", &error));
    check_error(error, PARAM_ERROR_FILE, "x.ini: not a text file");
}

static void test_override_messages(void)
{
    check_override_refused("veins.kill_distance=-3", PARAM_ERROR_VALUE,
                           "--set veins.kill_distance=-3: must be a number from 0 to 1e6 (segments)");
    check_override_refused("veins.kil_distance=3", PARAM_ERROR_UNKNOWN,
                           "--set veins.kil_distance=3: no such parameter; did you mean 'veins.kill_distance'?");
    check_override_refused("sources.kill_distance=3", PARAM_ERROR_UNKNOWN,
                           "--set sources.kill_distance=3: no such parameter; did you mean 'veins.kill_distance'?");
    check_override_refused("kill_distance=3", PARAM_ERROR_UNKNOWN,
                           "--set kill_distance=3: no such parameter; did you mean 'veins.kill_distance'?");
    check_override_refused("vains.pattern=open", PARAM_ERROR_UNKNOWN,
                           "--set vains.pattern=open: no such parameter; did you mean 'veins.pattern'?");
    check_override_refused("width.zzzzzzzzzzzzzzz=3", PARAM_ERROR_UNKNOWN,
                           "--set width.zzzzzzzzzzzzzzz=3: no such parameter; keys of [width] are exponent, minimum, "
                           "thickening, rank_ratio");
    check_override_refused("veins.pattern", PARAM_ERROR_VALUE, "--set veins.pattern: must be section.key=value");
    Params *p = params_new();
    g_assert_true(params_override(p, " leaf.title = a=b ", NULL));
    g_assert_cmpstr(params_text(p, PARAM_LEAF_TITLE), ==, "a=b");
    params_free(p);
}

/* Errors speak of what was typed. */
static void test_places(void)
{
    GError *error = NULL;
    Params *p = parse("[outline]\npath = M0 0\n", NULL);
    g_assert_false(params_set(p, PARAM_TEXTURE_SIZE, "0", "--size", &error));
    check_error(error, PARAM_ERROR_VALUE, "--size 0: must be a whole number from 16 to 16384 (pixels)");
    g_assert_true(params_set(p, PARAM_TEXTURE_MAPS, "hieght", "--maps", NULL));
    g_assert_true(params_override(p, "veins.seeds=0,0", NULL));
    const struct {
        ParamId id;
        const char *place;
    } cases[] = {{PARAM_OUTLINE_PATH, "params/poplar.ini: [outline] path"},
                 {PARAM_TEXTURE_MAPS, "--maps"},
                 {PARAM_VEINS_SEEDS, "--set veins.seeds"},
                 {PARAM_WIDTH_EXPONENT, "default: [width] exponent"}};
    for (gsize i = 0; i < G_N_ELEMENTS(cases); i++) {
        char *place = params_place(p, cases[i].id);
        g_assert_cmpstr(place, ==, cases[i].place);
        g_free(place);
    }
    params_free(p);
}

/* Parameters that exclude each other: `text`, then the overrides; then what they are. */
static void test_displacing(void)
{
    static const struct {
        const char *text, *override[2], *path, *file, *list;
        int placement;
    } cases[] = {
        {"[outline]\nfile = a.svg\n", {"outline.path=M0 0"}, "M0 0", "", "", 0},
        {"[outline]\npath = M1 1\n", {"outline.file=b.svg"}, "", "b.svg", "", 0},
        {"[outline]\nfile = a.svg\n", {"outline.path="}, "", "params/a.svg", "", 0},
        {"[outline]\nfile = a.svg\npath = M1 1\n", {NULL}, "M1 1", "params/a.svg", "", 0}, /* refused later */
        {"[outline]\nfile = a.svg\npath = M1 1\n", {"outline.path=M2 2"}, "M2 2", "", "", 0},
        {"", {"outline.file=b.svg", "outline.path=M2 2"}, "M2 2", "b.svg", "", 0}, /* refused later */
        {"[sources]\nfile = /s.csv\n", {NULL}, "", "", "/s.csv", 2},
        {"[sources]\nfile = /s.csv\nplacement = margin\n", {NULL}, "", "", "/s.csv", 1}, /* refused later */
        {"[sources]\nplacement = darts\nfile = /s.csv\n", {NULL}, "", "", "/s.csv", 0},  /* refused later */
        {"[sources]\nplacement = darts\n", {"sources.file=t.csv"}, "", "", "t.csv", 2},
        {"", {"sources.placement=darts", "sources.file=t.csv"}, "", "", "t.csv", 0}, /* refused later */
        {"[sources]\nfile = /s.csv\n", {"sources.placement=margin"}, "", "", "", 1},
        {"[sources]\nfile = /s.csv\nplacement = list\n", {"sources.placement=darts"}, "", "", "", 0},
        {"[sources]\nfile = /s.csv\nplacement = darts\n", {"sources.placement=list"}, "", "", "/s.csv", 2},
    };
    for (gsize i = 0; i < G_N_ELEMENTS(cases); i++) {
        Params *p = parse(cases[i].text, NULL);
        for (int k = 0; k < 2 && cases[i].override[k]; k++)
            g_assert_true(params_override(p, cases[i].override[k], NULL));
        Params *copy = params_copy(p);
        g_assert_cmpstr(params_text(copy, PARAM_OUTLINE_PATH), ==, cases[i].path);
        g_assert_cmpstr(params_text(copy, PARAM_OUTLINE_FILE), ==, cases[i].file);
        g_assert_cmpstr(params_text(copy, PARAM_SOURCES_FILE), ==, cases[i].list);
        g_assert_cmpint(params_choice(copy, PARAM_SOURCES_PLACEMENT), ==, cases[i].placement);
        char *text = params_to_file(copy);
        Params *again = params_parse(text, strlen(text), "again.ini", NULL);
        char *text_again = params_to_file(again);
        g_assert_cmpstr(text, ==, text_again);
        g_free(text_again);
        g_free(text);
        params_free(again);
        params_free(copy);
        params_free(p);
    }
    Params *p = params_new(); /* the number of the choice, which params.c knows too */
    g_assert_true(params_override(p, "sources.placement=list", NULL));
    g_assert_cmpint(params_choice(p, PARAM_SOURCES_PLACEMENT), ==, 2);
    params_free(p);
}

static void test_bad_values(void)
{
    static const struct {
        const char *key, *values[16];
    } cases[] = {
        {"veins.kill_distance",
         {"", "nan", "NaN", "inf", "-inf", "1e999", "0x10", "3x", "3 4", "1,5", "-1e-9", "1000000.0001", "1e", ".",
          "- 3"}},
        {"texture.size",
         {"", "512.0", "5e2", "0", "15", "16385", "0x200", "99999999999999999999", "-", "+", "5 12", "--512"}},
        {"outline.mirror", {"", "maybe", "2", "y"}},
        {"growth.kind", {"", "Marginal", "marginal|isogonic", "|", "uniform"}},
        {"texture.vein_colour", {"", "c3cf86", "#c3cf8", "#c3cf866", "#c3cf8g", "green", "#+12345"}},
        {"outline.teeth_amplitude", {"0.1;;0.2", ";", "0.1,0.2", "0.6", "0.1 0.2", "nan", "-0.1"}},
        {"veins.seeds", {"1", "1,2,3", "1,2 3,4", "1,2;;", "1,", ",", "nan,0", "0,inf"}},
        {"leaf.title", {"a\nb", "\x7f", "\xff", "\xC2\x85", "\xEF\xBF\xBF", "a\rb"}},
        {"outline.file", {"a\nb", "\xC3"}},
    };
    Params *p = params_new();
    char *before = params_to_file(p);
    for (gsize i = 0; i < G_N_ELEMENTS(cases); i++) {
        ParamId id = (ParamId)param_find(cases[i].key);
        for (gsize k = 0; k < G_N_ELEMENTS(cases[i].values) && cases[i].values[k]; k++) {
            GError *error = NULL;
            if (params_set(p, id, cases[i].values[k], "test", &error))
                g_test_message("%s=%s was taken", cases[i].key, cases[i].values[k]);
            g_assert_error(error, PARAM_ERROR, PARAM_ERROR_VALUE);
            g_assert_true(g_utf8_validate(error->message, -1, NULL));
            g_error_free(error);
        }
    }
    char *after = params_to_file(p);
    g_assert_cmpstr(before, ==, after);
    g_free(before);
    g_free(after);
    params_free(p);
}

static void test_format(void)
{
    static const char *const cases[][2] = {
        {"0.1", "0.1"},       {"1600", "1600"}, {"0.30000000000000004", "0.30000000000000004"},
        {"1e6", "1000000"},   {"-0", "0"},      {"3.0000000000000000001", "3"},
        {"1e-300", "1e-300"}, {".5", "0.5"},    {"0.1234567890123456", "0.1234567890123456"},
    };
    Params *p = params_new();
    for (gsize i = 0; i < G_N_ELEMENTS(cases); i++) {
        g_assert_true(params_set(p, PARAM_VEINS_KILL_DISTANCE, cases[i][0], NULL, NULL));
        char *text = params_format(p, PARAM_VEINS_KILL_DISTANCE);
        g_assert_cmpstr(text, ==, cases[i][1]);
        g_free(text);
    }
    params_free(p);
}

static void check_same(const Params *a, const Params *b)
{
    char *x = params_to_file(a), *y = params_to_file(b);
    g_assert_cmpstr(x, ==, y);
    g_assert_cmphex(params_hash(a), ==, params_hash(b));
    for (int i = 0; i < PARAM_COUNT; i++) {
        ParamId id = (ParamId)i;
        const ParamInfo *info = param_info(id);
        if (info->type == TYPE_NUMBER) {
            double u = params_number(a, id), v = params_number(b, id);
            g_assert_cmpmem(&u, sizeof u, &v, sizeof v);
        } else if (info->type == TYPE_NUMBERS || info->type == TYPE_POINTS) {
            uint32_t n, m, width = info->type == TYPE_POINTS ? 2 : 1;
            const double *u = params_list(a, id, &n), *v = params_list(b, id, &m);
            g_assert_cmpmem(u, (int)(n * width * sizeof *u), v, (int)(m * width * sizeof *v));
        }
    }
    g_free(x);
    g_free(y);
}

static void test_defaults(void)
{
    Params *p = params_new();
    char *text = params_to_file(p);
    Params *q = params_parse(text, strlen(text), "all.ini", NULL);
    g_assert_nonnull(q);
    check_same(p, q);
    Params *empty = params_parse("", 0, "empty.ini", NULL);
    check_same(p, empty);
    params_free(empty);
    params_free(q);
    params_free(p);
    g_free(text);
}

/* A value of the parameter made from random bits; written with %.17g, which is exact. */
static char *random_value(const ParamInfo *info, uint32_t step, uint64_t index)
{
    RandomBlock bits = random_block(7, 99, step, index);
    double u = bits.w[0] / 4294967295.0, v = ((double)bits.w[1] + bits.w[2] * 0x1p-32) * 0x1p-32;
    double number = info->low + (info->high - info->low) * v * (bits.w[3] & 1 ? 1 : u * u * u * u * 1e-3);
    char a[G_ASCII_DTOSTR_BUF_SIZE], b[G_ASCII_DTOSTR_BUF_SIZE];
    g_ascii_formatd(a, sizeof a, "%.17g", number);
    g_ascii_formatd(b, sizeof b, "%.17g", (v - 0.5) * (double)(1u << bits.w[3] % 30));
    char **words, *value = NULL;
    switch (info->type) {
    case TYPE_NUMBER:
        return g_strdup(a);
    case TYPE_INTEGER:
        return g_strdup_printf("%d", (int)(info->low + (info->high - info->low) * u));
    case TYPE_SWITCH:
        return g_strdup(bits.w[0] & 1 ? "on" : "off");
    case TYPE_CHOICE:
        words = g_strsplit(info->choices, "|", -1);
        value = g_strdup(words[bits.w[0] % g_strv_length(words)]);
        g_strfreev(words);
        return value;
    case TYPE_COLOUR:
        return g_strdup_printf("#%06X", bits.w[0] & 0xFFFFFF);
    case TYPE_NUMBERS:
        return bits.w[0] % 3 ? g_strdup_printf("%s;%s", a, a) : g_strdup("");
    case TYPE_POINTS:
        return bits.w[0] % 3 ? g_strdup_printf("%s,%s; 0 , %s", b, a, b) : g_strdup("");
    case TYPE_TEXT:
    case TYPE_FILE:
        return g_strdup_printf(" [%u];#\t=\"\xE2\x82\xAC' %s ", bits.w[1], a);
    }
    return value;
}

static void test_round_trip(void)
{
    for (uint32_t step = 0; step < 300; step++) {
        Params *p = params_new();
        for (int i = 0; i < PARAM_COUNT; i++) {
            GError *error = NULL;
            char *value = random_value(param_info((ParamId)i), step, (uint64_t)i);
            params_set(p, (ParamId)i, value, "test", &error);
            g_assert_no_error(error);
            if (param_info((ParamId)i)->type == TYPE_NUMBER)
                g_assert_cmpfloat(params_number(p, (ParamId)i), ==, g_ascii_strtod(value, NULL));
            g_free(value);
        }
        GError *error = NULL;
        char *text = params_to_file(p);
        Params *q = params_parse(text, strlen(text), "all.ini", &error);
        g_assert_no_error(error);
        check_same(p, q);
        Params *copy = params_copy(q);
        check_same(p, copy);
        params_free(copy);
        params_free(q);
        params_free(p);
        g_free(text);
    }
}

static void test_hash(void)
{
    Params *p = params_new();
    uint64_t plain = params_hash(p);
    g_assert_true(params_set(p, PARAM_VEINS_KILL_DISTANCE, "1.0000000000000002", NULL, NULL));
    g_assert_cmphex(params_hash(p), !=, plain);
    g_assert_true(params_set(p, PARAM_VEINS_KILL_DISTANCE, "1.0", NULL, NULL));
    g_assert_cmphex(params_hash(p), ==, plain);
    params_free(p);
    params_free(NULL);
}

static void test_load(void)
{
    char *dir = g_dir_make_tmp("venation-XXXXXX", NULL);
    char *path = g_build_filename(dir, "x.ini", NULL);
    GError *error = NULL;
    char *message = g_strdup_printf("%s: No such file or directory", path);
    g_assert_null(params_load(path, &error));
    check_error(error, PARAM_ERROR_FILE, message);
    g_free(message);

    error = NULL;
    message = g_strdup_printf("%s: Is a directory", dir);
    g_assert_null(params_load(dir, &error));
    check_error(error, PARAM_ERROR_FILE, message);
    g_free(message);

    char *large = g_strnfill((1 << 20) + 1, '\n');
    g_assert_true(g_file_set_contents(path, large, 1 << 20, NULL));
    Params *p = params_load(path, NULL);
    g_assert_nonnull(p);
    params_free(p);
    g_assert_true(g_file_set_contents(path, large, (1 << 20) + 1, NULL));
    error = NULL;
    message = g_strdup_printf("%s: larger than 1 MiB, which no parameter file is", path);
    g_assert_null(params_load(path, &error));
    check_error(error, PARAM_ERROR_FILE, message);
    g_free(message);
    g_free(large);

    g_assert_true(g_file_set_contents(path, "[outline]\nfile = a.svg\n", -1, NULL));
    p = params_load(path, NULL);
    char *expected = g_build_filename(dir, "a.svg", NULL);
    g_assert_cmpstr(params_text(p, PARAM_OUTLINE_FILE), ==, expected);
    g_free(expected);
    params_free(p);
    g_remove(path);
    g_rmdir(dir);
    g_free(path);
    g_free(dir);
}

static void test_suggest(void)
{
    static const char *const words[] = {"open", "closed", "kill_distance", "join_distance", "size"};
    g_assert_cmpstr(suggest_nearest("opne", words, 5), ==, "open");
    g_assert_cmpstr(suggest_nearest("CLOSED", words, 5), ==, "closed");
    g_assert_cmpstr(suggest_nearest("kill-distance", words, 5), ==, "kill_distance");
    g_assert_cmpstr(suggest_nearest("joindistance", words, 5), ==, "join_distance");
    g_assert_cmpstr(suggest_nearest("kill", words, 5), ==, "kill_distance");
    g_assert_cmpstr(suggest_nearest("zize", words, 5), ==, "size");
    g_assert_null(suggest_nearest("apple", words, 5));
    g_assert_null(suggest_nearest("", words, 5));
    g_assert_null(suggest_nearest("x", words, 5));
    char *long_word = g_strnfill(1 << 16, 'a');
    g_assert_null(suggest_nearest(long_word, words, 5));
    g_free(long_word);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/params/table", test_table);
    g_test_add_func("/params/allowed", test_allowed);
    g_test_add_func("/params/read", test_read);
    g_test_add_func("/params/files", test_files);
    g_test_add_func("/params/messages", test_messages);
    g_test_add_func("/params/override-messages", test_override_messages);
    g_test_add_func("/params/places", test_places);
    g_test_add_func("/params/displacing", test_displacing);
    g_test_add_func("/params/bad-values", test_bad_values);
    g_test_add_func("/params/format", test_format);
    g_test_add_func("/params/defaults", test_defaults);
    g_test_add_func("/params/round-trip", test_round_trip);
    g_test_add_func("/params/hash", test_hash);
    g_test_add_func("/params/load", test_load);
    g_test_add_func("/params/suggest", test_suggest);
    return g_test_run();
}
