/* Sweep files: values, order, names, chance, refusals. */
#include <glib.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#include "geom/random.h"
#include "sweep/private.h"
#include "sweep/sweep.h"

static char *folder; /* with base.ini and tables */

static void put(const char *file, const char *text)
{
    char *path = g_build_filename(folder, file, NULL);
    g_assert_true(g_file_set_contents(path, text, -1, NULL));
    g_free(path);
}

static void check_near(double a, double b, double most)
{
    g_assert_cmpfloat(fabs(a - b), <=, most);
}

static Sweep *parse(const char *body, GError **error)
{
    char *text = g_strconcat("[sweep]\nparams = base.ini\n", body, NULL), *path = g_build_filename(folder, "s.ini", NULL);
    Sweep *s = sweep_parse(text, strlen(text), path, error);
    g_free(path);
    g_free(text);
    return s;
}

static Sweep *read_sweep(const char *body)
{
    GError *error = NULL;
    Sweep *s = parse(body, &error);
    g_assert_no_error(error);
    g_assert_nonnull(s);
    return s;
}

/* The message after the folder's name, for which '@' stands. */
static void check_refused(const char *body, const char *message)
{
    GError *error = NULL;
    g_assert_null(parse(body, &error));
    g_assert_nonnull(error);
    g_assert_true(error->domain == PARAM_ERROR);
    char **parts = g_strsplit(error->message, folder, -1), *plain = g_strjoinv("@", parts);
    g_assert_cmpstr(plain, ==, message);
    g_free(plain);
    g_strfreev(parts);
    g_error_free(error);
}

/* "name|seed|value value …" */
static char *tell(const Sweep *s, uint64_t index)
{
    SweepVariant v;
    sweep_variant(s, index, &v);
    GString *t = g_string_new(NULL);
    g_string_append_printf(t, "%s|%" G_GUINT64_FORMAT "|", v.name, v.seed);
    for (uint32_t i = 0; i < v.n; i++)
        g_string_append_printf(t, "%s%s", i ? " " : "", v.value[i] ? v.value[i] : "~");
    sweep_variant_clear(&v);
    return g_string_free(t, FALSE);
}

static void check(const Sweep *s, uint64_t index, const char *expected)
{
    char *told = tell(s, index);
    g_assert_cmpstr(told, ==, expected);
    g_free(told);
}

static void check_all(const char *body, const char *const *expected, guint n)
{
    Sweep *s = read_sweep(body);
    g_assert_cmpuint(sweep_count(s), ==, n);
    for (guint i = n; i-- > 0;) /* in no particular order */
        check(s, i, expected[i]);
    sweep_free(s);
}
#define ALL(body, ...)                                                                                                                   \
    check_all(body, (const char *const[]){__VA_ARGS__}, G_N_ELEMENTS(((const char *const[]){__VA_ARGS__})))

/* All names differ, whatever the case, and are fit for files; every value is one the table allows and reads back to itself; set one by one
 * they are the same parameters. */
static void check_sound(const Sweep *s)
{
    GHashTable *seen = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
    for (uint64_t i = 0; i < sweep_count(s); i++) {
        SweepVariant v;
        GError *error = NULL;
        sweep_variant(s, i, &v);
        g_assert_true(g_hash_table_add(seen, g_ascii_strdown(v.name, -1)));
        gsize plain = strspn(v.name, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.+-");
        g_assert_cmpuint(plain, ==, strlen(v.name));
        g_assert_true(*v.name && *v.name != '.' && *v.name != '-' && v.name[plain - 1] != '.' && plain <= 130);
        Params *p = params_copy(sweep_params(s)), *alone = params_copy(p);
        g_assert_true(sweep_apply(s, &v, p, &error));
        g_assert_no_error(error);
        for (uint32_t k = 0; k < v.n; k++) {
            SweepKey key = sweep_key(s, k);
            if (key.id < 0 || !v.value[k])
                continue;
            g_assert_true(params_set(alone, (ParamId)key.id, v.value[k], "--set", NULL));
            char *back = params_format(p, (ParamId)key.id);
            g_assert_cmpstr(back, ==, v.value[k]);
            g_free(back);
            if (key.levels) {
                char *level = sweep_level(s, k, v.level[k]);
                g_assert_cmpstr(level, ==, v.value[k]);
                g_free(level);
            }
        }
        g_assert_cmphex(params_hash(p), ==, params_hash(alone)); /* as by --set */
        params_free(p);
        params_free(alone);
        sweep_variant_clear(&v);
    }
    g_hash_table_destroy(seen);
}

static void test_grid(void)
{
    ALL("veins.kill_distance = 5; 10; 2e1;\nveins.pattern = open; closed\nseed = 7\n", "kill_distance-5_pattern-open|7|5 open 7",
        "kill_distance-5_pattern-closed|7|5 closed 7", "kill_distance-10_pattern-open|7|10 open 7",
        "kill_distance-10_pattern-closed|7|10 closed 7", "kill_distance-20_pattern-open|7|20 open 7",
        "kill_distance-20_pattern-closed|7|20 closed 7");
    ALL("seed = 1; 2\npose.seed = 3;4\n", "seed-1_pose.seed-3|1|1 3", "seed-1_pose.seed-4|1|1 4", "seed-2_pose.seed-3|2|2 3",
        "seed-2_pose.seed-4|2|2 4");
    ALL("", "000000|1|");
    ALL("texture.maps = base_color; height\nveins.kill_distance=4\n", "000000|1|base_color; height 4");
    /* A repetition each, with its own seed. */
    ALL("mode = grid\nseed = each\nsample_seed = 10\nwidth.exponent = 2; 3\n", "exponent-2|10|10 2", "exponent-3|11|11 3");
}

static void test_zip(void)
{
    ALL("mode = zip\nname = cone; auxin; com; null.con\nseed = 1; 2; 3; 4", "cone|1|1", "auxin|2|2", "com|3|3", "null.con|4|4"); /* no devices */
    ALL("mode = zip\nveins.kill_distance = 40; 20\nwidth.minimum = 1; 1\ntexture.size = 64\n", "kill_distance-40_minimum-1|1|40 1 64",
        "kill_distance-20_minimum-1|1|20 1 64");
    ALL("mode = zip\nveins.kill_distance = 4; 4\nwidth.minimum = 1; 1\nseed = each\n", "000000_kill_distance-4_minimum-1|1|4 1 1",
        "000001_kill_distance-4_minimum-1|2|4 1 2");
    ALL("mode = zip\nname = 9a; 9b\nveins.kill_distance = 40; 20\nseed=from 5 to 6 by 1", "9a|5|40 5", "9b|6|20 6");
}

static void test_ranges(void)
{
    ALL("width.minimum = from 0.1 to 0.45 by 0.1\n", "minimum-0.1|1|0.1", "minimum-0.2|1|0.2", "minimum-0.3|1|0.3", "minimum-0.4|1|0.4");
    ALL("width.minimum = from 3 to 1 by 1", "minimum-3|1|3", "minimum-2|1|2", "minimum-1|1|1");
    ALL("width.minimum = from 1 to 2 in 4\n", "minimum-1|1|1", "minimum-1.33333|1|1.33333", "minimum-1.66667|1|1.66667", "minimum-2|1|2");
    ALL("width.minimum = from 1 to 16 in 5 log\n", "minimum-1|1|1", "minimum-2|1|2", "minimum-4|1|4", "minimum-8|1|8", "minimum-16|1|16");
    ALL("texture.size = from 64 to 1024 in 3 log\n", "size-64|1|64", "size-256|1|256", "size-1024|1|1024");
    ALL("outline.teeth_count = from 10 to 30 by 10\n", "teeth_count-10|1|10", "teeth_count-20|1|20", "teeth_count-30|1|30");
    ALL("pose.strength = from -1 to 1 by 1\n", "strength--1|1|-1", "strength-0|1|0", "strength-1|1|1");
    ALL("seed = from 9007199254740989 to 9007199254740992 by 1\n", "seed-9007199254740989|9007199254740989|9007199254740989",
        "seed-9007199254740990|9007199254740990|9007199254740990", "seed-9007199254740991|9007199254740991|9007199254740991",
        "seed-9007199254740992|9007199254740992|9007199254740992");
    ALL("seed = each\nsample_seed = 9007199254740991\nveins.kill_distance = 1; 2\n", "kill_distance-1|9007199254740991|9007199254740991 1",
        "kill_distance-2|9007199254740992|9007199254740992 2");
    Sweep *s = read_sweep("width.minimum = from 9 to 9.00001 in 2000\nwidth.exponent = from 1 to 1.1 in 7 log\n"); /* enough digits */
    check_sound(s);
    g_assert_cmpuint(sweep_count(s), ==, 14000);
    sweep_free(s);
}

/* Values that hold a ';', files, texts that make no names. */
static void test_texts(void)
{
    ALL("veins.seeds = 0,0 | 0,0; 0.1,0.2\noutline.teeth_count = | 20; 3", "seeds-0-0_teeth_count-none|1|0,0 ",
        "seeds-0-0_teeth_count-20-3|1|0,0 20; 3", "seeds-0-0-0.1-0.2_teeth_count-none|1|0,0; 0.1,0.2 ",
        "seeds-0-0-0.1-0.2_teeth_count-20-3|1|0,0; 0.1,0.2 20; 3");
    ALL("outline.file = ../../a/one.svg; two.svg", "file-one|1|../../a/one.svg", "file-two|1|two.svg");
    ALL("outline.file = a/x.svg; b/X.svg", "file-1|1|a/x.svg", "file-2|1|b/X.svg"); /* one name but for the folder and case */
    ALL("pose.preset = curled_tip; flat", "preset-curled-tip|1|curled_tip", "preset-flat|1|flat");
    ALL("leaf.title = ../../etc | ä", "title-etc|1|../../etc", "title-none|1|ä");
    Sweep *s = read_sweep("outline.file = sub/one.svg");
    SweepVariant v;
    Params *p = params_copy(sweep_params(s));
    sweep_variant(s, 0, &v);
    g_assert_true(sweep_apply(s, &v, p, NULL));
    char *written = params_format(p, PARAM_OUTLINE_FILE), *openable = g_build_filename(folder, "sub/one.svg", NULL);
    g_assert_cmpstr(written, ==, "sub/one.svg");
    g_assert_cmpstr(params_text(p, PARAM_OUTLINE_FILE), ==, openable);
    g_assert_cmpstr(params_text(p, PARAM_OUTLINE_PATH), ==, ""); /* base.ini's gives way */
    g_free(written);
    g_free(openable);
    params_free(p);
    sweep_variant_clear(&v);
    sweep_free(s);
}

static void test_table(void)
{
    put("t.csv", "\xEF\xBB\xBFveins.kill_distance, seed ,veins.seeds\r\n# a comment\n5,1,\"0,0; 0.1,0\"\n\n10,,\n10,3,\"0,0\"");
    ALL("mode = zip\ntable = t.csv\n", "kill_distance-5_seed-1_seeds-0-0-0.1-0|1|5 1 0,0; 0.1,0", "kill_distance-10_seed-none_seeds-none|1|10 ~ ~",
        "kill_distance-10_seed-3_seeds-0-0|3|10 3 0,0");
    put("n.csv", "name,veins.kill_distance,leaf.title\nbig,9,\"say \"\"a, b\"\"\"\nsmall,2,\n");
    ALL("table = n.csv\nwidth.minimum = 1; 2", "big_minimum-1|1|9 say \"a, b\" 1", "big_minimum-2|1|9 say \"a, b\" 2",
        "small_minimum-1|1|2 ~ 1", "small_minimum-2|1|2 ~ 2");
    ALL("mode = zip\ntable = n.csv\nwidth.minimum = 1; 2", "big|1|9 say \"a, b\" 1", "small|1|2 ~ 2");
    put("same.csv", "leaf.title,veins.kill_distance\na/b,1\na b,1\n");
    ALL("table = same.csv", "row-1|1|a/b 1", "row-2|1|a b 1");
    Sweep *s = read_sweep("mode = sample\ncount = 200\ntable = n.csv\nveins.join_distance = uniform(1, 2)");
    check_sound(s);
    g_assert_cmpuint(sweep_key(s, 0).axis, ==, sweep_key(s, 1).axis);
    g_assert_true(sweep_key(s, 0).drawn && sweep_key(s, 0).varies);
    uint64_t big = 0;
    for (uint64_t i = 0; i < 200; i++) {
        SweepVariant v;
        sweep_variant(s, i, &v);
        g_assert_true((strcmp(v.value[0], "9") == 0) == (v.value[1] != NULL)); /* rows stay together */
        big += v.value[1] != NULL;
        sweep_variant_clear(&v);
    }
    g_assert_cmpuint(big, >, 70);
    g_assert_cmpuint(big, <, 130);
    sweep_free(s);
}

static void draw(const char *key, const char *how, const char *more, double *out, guint n)
{
    char *body = g_strdup_printf("mode = sample\ncount = %u\n%s = %s\n%s", n, key, how, more);
    Sweep *s = read_sweep(body);
    for (guint i = 0; i < n; i++) {
        SweepVariant v;
        sweep_variant(s, i, &v);
        out[i] = g_ascii_strtod(v.value[0], NULL);
        sweep_variant_clear(&v);
    }
    sweep_free(s);
    g_free(body);
}

static void moments(const double *x, guint n, double *mean, double *deviation)
{
    double sum = 0, square = 0;
    for (guint i = 0; i < n; i++)
        sum += x[i];
    *mean = sum / n;
    for (guint i = 0; i < n; i++)
        square += (x[i] - *mean) * (x[i] - *mean);
    *deviation = sqrt(square / n);
}

enum { DRAWS = 20000 };

static void test_distributions(void)
{
    static const char *const more[] = {"sample_seed = 5\n", "sequence = halton\n"};
    double *x = g_new(double, DRAWS), mean, deviation;
    for (int m = 0; m < 2; m++) {
        draw("veins.join_distance", "uniform(2, 5)", more[m], x, DRAWS);
        moments(x, DRAWS, &mean, &deviation);
        check_near(mean, 3.5, 0.03);
        check_near(deviation, 3 / sqrt(12), 0.02);
        for (guint i = 0; i < DRAWS; i++)
            g_assert_true(x[i] >= 2 && x[i] <= 5);
        draw("veins.join_distance", "log-uniform(0.01, 100)", more[m], x, DRAWS);
        for (guint i = 0; i < DRAWS; i++) {
            g_assert_true(x[i] >= 0.01 && x[i] <= 100);
            x[i] = log(x[i]);
        }
        moments(x, DRAWS, &mean, &deviation);
        check_near(mean, 0, 0.08);
        check_near(deviation, log(1e4) / sqrt(12), 0.05);
        draw("pose.strength", "normal(1, 0.5)", more[m], x, DRAWS);
        moments(x, DRAWS, &mean, &deviation);
        check_near(mean, 1, 0.015);
        check_near(deviation, 0.5, 0.015);
        guint below = 0, clamped = 0;
        for (guint i = 0; i < DRAWS; i++)
            below += x[i] < 0.5;
        check_near(below / (double)DRAWS, 0.158655, 0.01);
        draw("texture.gloss", "normal(0.5, 1)", more[m], x, DRAWS);
        for (guint i = 0; i < DRAWS; i++) {
            g_assert_true(x[i] >= 0 && x[i] <= 1);
            clamped += x[i] == 0;
        }
        check_near(clamped / (double)DRAWS, 0.308538, 0.015);
        draw("mesh.levels", "uniform(1, 8)", more[m], x, DRAWS); /* whole numbers, all alike */
        guint times[9] = {0};
        for (guint i = 0; i < DRAWS; i++)
            times[(int)x[i]] += x[i] == floor(x[i]);
        for (int k = 1; k <= 8; k++)
            check_near(times[k] / (double)DRAWS, 0.125, 0.01);
        draw("veins.join_distance", "choice(3; 3; 4)", more[m], x, DRAWS);
        moments(x, DRAWS, &mean, &deviation);
        check_near(mean, 10.0 / 3, 0.01);
        draw("outline.teeth_count", "uniform(10, 20, 5)", more[m], x, 1000);
        for (guint i = 0; i < 1000; i++)
            g_assert_true(x[i] == 10 || x[i] == 15 || x[i] == 20);
        draw("veins.join_distance", "uniform(1000, 1000.0001)", more[m], x, 1000); /* enough digits */
        moments(x, 1000, &mean, &deviation);
        check_near(deviation * 1e4, 1 / sqrt(12), 0.02);
        draw("texture.size", "log-uniform(16, 16384)", more[m], x, 1000);
        for (guint i = 0; i < 1000; i++)
            g_assert_true(x[i] == floor(x[i]) && x[i] >= 16 && x[i] <= 16384);
    }
    g_free(x);
}

/* The inverse against the C library's error function, far out too. */
static void test_normal(void)
{
    for (int e = -40; e < 0; e++)
        for (int m = 4; m < 8; m++) {
            double u = ldexp(m / 8.0, e), x = sweep_normal(u);
            check_near(erfc(-x / sqrt(2)) / 2 / u, 1, 1e-12);
            check_near(u > 1e-6 ? sweep_normal(1 - u) + x : 0, 0, 1e-8);
        }
    g_assert_cmpfloat(sweep_normal(0.5), ==, 0);
    g_assert_true(isfinite(sweep_normal(0)) && sweep_normal(0) < -8);
}

/* Every b^k points in a row lie one in each b^k-th of the interval, and the first two bases' together in each of the boxes; chance's don't. */
static void test_halton(void)
{
    Sweep *s = read_sweep("mode = sample\ncount = 100000\nsequence = halton\nsample_seed = 3\nveins.join_distance = uniform(0, 1)\n"
                          "texture.gloss = uniform(0, 1)\ntexture.variation = uniform(0, 1)\n");
    static const uint32_t base[] = {2, 3, 5}, power[] = {1024, 729, 625};
    for (int d = 0; d < 3; d++) {
        const SweepAxis *axis = &g_array_index(s->axis, SweepAxis, d);
        g_assert_cmpuint(axis->base, ==, base[d]);
        for (uint64_t from = 0; from < 5 * power[d]; from += power[d]) {
            uint8_t *box = g_new0(uint8_t, power[d]);
            for (uint64_t i = from; i < from + power[d]; i++)
                box[(uint32_t)(sweep_chance(s, axis, i) * power[d])]++;
            for (uint32_t i = 0; i < power[d]; i++)
                g_assert_cmpuint(box[i], ==, 1);
            g_free(box);
        }
    }
    uint8_t box[32][27] = {{0}};
    for (uint64_t i = 864; i < 2 * 864; i++)
        box[(int)(sweep_chance(s, &g_array_index(s->axis, SweepAxis, 0), i) * 32)][(int)(sweep_chance(s, &g_array_index(s->axis, SweepAxis, 1), i) * 27)]++;
    for (int i = 0; i < 32; i++)
        for (int k = 0; k < 27; k++)
            g_assert_cmpuint(box[i][k], ==, 1);
    sweep_free(s);
}

enum { SEATS = 30, MOST_POINTS = 1000 };

static Sweep *read_seats(unsigned seed, const char *sequence)
{
    GString *body = g_string_new(NULL);
    g_string_append_printf(body, "mode = sample\ncount = %d\nsequence = %s\nsample_seed = %u\n", MOST_POINTS, sequence, seed);
    for (int i = 0, n = 0; i < PARAM_COUNT && n < SEATS; i++) {
        const ParamInfo *info = param_info((ParamId)i);
        if (info->type == TYPE_NUMBER && ++n)
            g_string_append_printf(body, "%s.%s = uniform(%.17g, %.17g)\n", info->section, info->key, info->low, info->high);
    }
    Sweep *s = read_sweep(body->str);
    g_assert_cmpuint(s->axis->len, ==, SEATS);
    g_string_free(body, TRUE);
    return s;
}

static int by_value(gconstpointer a, gconstpointer b, gpointer user)
{
    const double *x = user;
    guint i = *(const guint *)a, k = *(const guint *)b;
    return x[i] < x[k] ? -1 : x[i] > x[k];
}

/* Ranks of n values, and the largest gap between their distribution and the even one (the star discrepancy in one dimension). */
static double rank_values(const double *x, guint n, double *rank)
{
    guint *order = g_new(guint, n);
    double most = 0;
    for (guint i = 0; i < n; i++)
        order[i] = i;
    g_qsort_with_data(order, (gint)n, sizeof *order, by_value, (gpointer)x);
    for (guint i = 0; i < n; i++) {
        rank[order[i]] = i;
        most = MAX(most, MAX((i + 1.0) / n - x[order[i]], x[order[i]] - (double)i / n));
    }
    g_free(order);
    return most;
}

static double rank_correlation(const double *a, const double *b, guint n)
{
    double xy = 0, xx = 0, middle = (n - 1) / 2.0;
    for (guint i = 0; i < n; i++) {
        xy += (a[i] - middle) * (b[i] - middle);
        xx += (a[i] - middle) * (a[i] - middle);
    }
    return fabs(xy / xx);
}

/* Thirty bases, 2 to 113, of which the high ones run up together if their digits are left as they are or are sent through straight lines: no two
 * columns are alike, for any seed, in samples of less than a round of the highest base and of many; and each by itself is far more even than chance. */
static void test_halton_columns(void)
{
    static const guint size[] = {60, 100, MOST_POINTS};
    /* Discrepancy × √n of the worst base, and of all in the mean; of chance it is 0.87 in the mean, and 1.4 or so for the worst of thirty. */
    static const double worst[] = {1.2, 0.8, 0.3}, middling[] = {0.4, 0.4, 0.15};
    double *x = g_new(double, MOST_POINTS), (*rank)[MOST_POINTS] = g_malloc(SEATS * sizeof *rank);
    for (unsigned seed = 1; seed <= 8; seed++) {
        Sweep *s = read_seats(seed, "halton");
        for (guint z = 0; z < G_N_ELEMENTS(size); z++) {
            double alike = 0, uneven = 0, mean = 0, root = sqrt(size[z]);
            for (guint d = 0; d < SEATS; d++) {
                for (guint i = 0; i < size[z]; i++)
                    x[i] = sweep_chance(s, &g_array_index(s->axis, SweepAxis, d), i);
                double gap = rank_values(x, size[z], rank[d]) * root;
                uneven = MAX(uneven, gap);
                mean += gap / SEATS;
                for (guint e = 0; e < d; e++)
                    alike = MAX(alike, rank_correlation(rank[d], rank[e], size[z]) * root);
            }
            g_test_message("seed %u, %u points: correlation %.2f, discrepancy %.2f, mean %.2f, all by √n", seed, size[z], alike, uneven, mean);
            g_assert_cmpfloat(alike, <, 5.0);
            g_assert_cmpfloat(uneven, <, worst[z]);
            g_assert_cmpfloat(mean, <, middling[z]);
        }
        if (seed == 1)
            check_sound(s);
        sweep_free(s);
    }
    g_free(rank);
    g_free(x);
}

/* A key's draws depend on its name, the seed and the variant, on nothing else. */
static void test_determinism(void)
{
    const char *body = "mode = sample\ncount = 1000\nsample_seed = 9\nveins.join_distance = uniform(0, 10)\ntexture.gloss = normal(0.5, 0.1)\n";
    Sweep *a = read_sweep(body), *b = read_sweep(body);
    Sweep *more = read_sweep("mode = sample\ncount = 2000\nwidth.minimum = log-uniform(0.1, 9)\ntexture.gloss = normal(0.5, 0.1)\n"
                             "sample_seed = 9\nveins.join_distance = uniform(0, 10)\n");
    Sweep *other = read_sweep("mode = sample\ncount = 1000\nseed = 10\nveins.join_distance = uniform(0, 10)\n");
    guint same = 0;
    for (uint64_t i = 1000; i-- > 0;) {
        SweepVariant v, w, u;
        sweep_variant(a, i, &v);
        sweep_variant(more, i, &w);
        sweep_variant(other, i, &u);
        char *told = tell(a, 999 - i);
        check(b, 999 - i, told);
        g_assert_cmpstr(v.value[0], ==, w.value[2]);
        g_assert_cmpstr(v.value[1], ==, w.value[1]);
        same += strcmp(v.value[0], u.value[1]) == 0;
        g_free(told);
        sweep_variant_clear(&v);
        sweep_variant_clear(&w);
        sweep_variant_clear(&u);
    }
    g_assert_cmpuint(same, <, 5);
    check(a, 0, "000000_join_distance-9.60104_gloss-0.637763|1|9.60104 0.637763");
    sweep_free(a);
    sweep_free(b);
    sweep_free(more);
    sweep_free(other);
}

/* Keys are drawn apart from each other, lists and ranges too. */
static void test_independence(void)
{
    static const char *const sequence[] = {"random", "halton"};
    for (int m = 0; m < 2; m++) {
        char *body = g_strdup_printf("mode = sample\ncount = 9000\nsequence = %s\nmesh.levels = 1; 2; 3\nseed = from 0 to 2 by 1\n", sequence[m]);
        Sweep *s = read_sweep(body);
        guint times[3][3] = {{0}}, again = 0, before = 0;
        for (uint64_t i = 0; i < 9000; i++) {
            SweepVariant v;
            sweep_variant(s, i, &v);
            times[v.level[0]][v.level[1]]++;
            again += v.level[0] == before;
            before = (guint)v.level[0];
            sweep_variant_clear(&v);
        }
        for (int i = 0; i < 9; i++)
            check_near(times[i / 3][i % 3], 1000, 120);
        if (m == 0)
            check_near(again, 3000, 200);
        sweep_free(s);
        g_free(body);
    }
}

/* No two keys of the table share their chance. */
static void test_keys_of_chance(void)
{
    GString *all = g_string_new("mode = sample\ncount = 3\nseed = uniform(1, 5)\n");
    guint n = 1;
    for (int i = 0; i < PARAM_COUNT; i++) {
        const ParamInfo *info = param_info((ParamId)i);
        if (info->type == TYPE_NUMBER || info->type == TYPE_INTEGER)
            g_string_append_printf(all, "%s.%s = uniform(%.17g, %.17g)\n", info->section, info->key, info->low, info->high), n++;
    }
    Sweep *s = read_sweep(all->str);
    GHashTable *seen = g_hash_table_new(NULL, NULL);
    for (guint i = 0; i < s->axis->len; i++)
        g_hash_table_add(seen, GUINT_TO_POINTER(g_array_index(s->axis, SweepAxis, i).key));
    g_assert_cmpuint(g_hash_table_size(seen), ==, n);
    check_sound(s);
    g_hash_table_destroy(seen);
    sweep_free(s);
    g_string_free(all, TRUE);
}

static gsize resident(void)
{
    char *text = NULL;
    gsize kib = 0;
    if (g_file_get_contents("/proc/self/statm", &text, NULL, NULL))
        sscanf(text, "%*s %" G_GSIZE_FORMAT, &kib);
    g_free(text);
    return kib * 4;
}

static void test_large(void)
{
    gsize before = resident();
    gint64 begun = g_get_monotonic_time();
    Sweep *s = read_sweep("veins.kill_distance = from 1 to 999 by 1\nseed = from 1 to 1001001 by 1\n"); /* 999 999 999 */
    g_assert_cmpuint(sweep_count(s), ==, SWEEP_MOST);
    check(s, SWEEP_MOST - 1, "kill_distance-999_seed-1001001|1001001|999 1001001");
    check(s, 1001001, "kill_distance-2_seed-1|1|2 1");
    sweep_free(s);
    s = read_sweep("mode = sample\nsequence = halton\ncount = 999999999\nseed = each\nveins.kill_distance = from 1 to 2 in 1000000\n");
    for (uint64_t i = 0; i < 1000; i++) {
        char *told = tell(s, SWEEP_MOST - 1 - i * 997);
        g_free(told);
    }
    sweep_free(s);
    s = read_sweep("mode = zip\nseed = from 1 to 999999999 by 1");
    check(s, 5, "seed-6|6|6");
    sweep_free(s);
    g_assert_cmpint(g_get_monotonic_time() - begun, <, 5 * G_USEC_PER_SEC);
    g_assert_cmpuint(resident(), <, before + 8192);
}

static void test_refused(void)
{
    check_refused("veins.kil_distance = 1", "@/s.ini:3: [sweep] veins.kil_distance: no such key; did you mean 'veins.kill_distance'?");
    check_refused("kill_distance = 1", "@/s.ini:3: [sweep] kill_distance: no such key; did you mean 'veins.kill_distance'?");
    check_refused("cuont = 1", "@/s.ini:3: [sweep] cuont: no such key; did you mean 'count'?");
    check_refused("zzzz = 1", "@/s.ini:3: [sweep] zzzz: no such key; keys are params, mode, count, seed, sample_seed, sequence, table, name, and "
                              "those of parameters, as veins.kill_distance");
    check_refused("veins.kill_distance =", "@/s.ini:3: [sweep] veins.kill_distance: an empty list; give one value or more");
    check_refused("veins.kill_distance = ;", "@/s.ini:3: [sweep] veins.kill_distance: an empty list; give one value or more");
    check_refused("veins.seeds =", "@/s.ini:3: [sweep] veins.seeds: an empty list; give one value or more");
    check_refused("veins.kill_distance = choice()", "@/s.ini:3: [sweep] veins.kill_distance: an empty list; give one value or more");
    check_refused("veins.kill_distance = 1;;2", "@/s.ini:3: [sweep] veins.kill_distance: an empty value between two ';'");
    check_refused("veins.kill_distance = 1; -2",
                  "@/s.ini:3: [sweep] veins.kill_distance = -2: must be a number from 0 to 1e6 (segments)");
    check_refused("veins.pattern = opne; closed", "@/s.ini:3: [sweep] veins.pattern = opne: must be open or closed; did you mean 'open'?");
    check_refused("veins.kill_distance = from 1 to 2e6 by 1",
                  "@/s.ini:3: [sweep] veins.kill_distance = from 1 to 2e6 by 1: both ends must be a number from 0 to 1e6 (segments)");
    check_refused("veins.kill_distance = from 1 to 2 by 0", "@/s.ini:3: [sweep] veins.kill_distance = from 1 to 2 by 0: the step must be above 0");
    check_refused("texture.size = from 16 to 20 by 0.5",
                  "@/s.ini:3: [sweep] texture.size = from 16 to 20 by 0.5: the step must be a whole number above 0");
    check_refused("veins.kill_distance = from 1 to 2", "@/s.ini:3: [sweep] veins.kill_distance = from 1 to 2: a range is 'from A to B by "
                                                       "STEP', 'from A to B in N' or 'from A to B in N log'");
    check_refused("veins.kill_distance = from 0 to 2 in 5 log",
                  "@/s.ini:3: [sweep] veins.kill_distance = from 0 to 2 in 5 log: both ends must be above 0");
    check_refused("veins.kill_distance = from 2 to 2 in 5", "@/s.ini:3: [sweep] veins.kill_distance = from 2 to 2 in 5: both ends are the same");
    check_refused("texture.size = from 16 to 20 in 6", "@/s.ini:3: [sweep] texture.size = from 16 to 20 in 6: too many values to tell apart");
    check_refused("texture.size = from 16 to 64 in 40 log",
                  "@/s.ini:3: [sweep] texture.size = from 16 to 64 in 40 log: too many values to tell apart");
    check_refused("mode = sample\ncount=5\nveins.kill_distance = unifrom(1, 2)",
                  "@/s.ini:5: [sweep] veins.kill_distance = unifrom(1, 2): did you mean uniform(…)?");
    check_refused("veins.kill_distance = uniform(1)",
                  "@/s.ini:3: [sweep] veins.kill_distance = uniform(1): must be uniform(a, b) or uniform(a, b, step)");
    check_refused("veins.kill_distance = uniform(-1, 2)",
                  "@/s.ini:3: [sweep] veins.kill_distance = uniform(-1, 2): both ends must be a number from 0 to 1e6 (segments)");
    check_refused("veins.kill_distance = uniform(2, 1)",
                  "@/s.ini:3: [sweep] veins.kill_distance = uniform(2, 1): the first number must be below the second");
    check_refused("veins.kill_distance = log-uniform(0, 1)",
                  "@/s.ini:3: [sweep] veins.kill_distance = log-uniform(0, 1): both ends must be above 0");
    check_refused("veins.kill_distance = normal(1, 0)",
                  "@/s.ini:3: [sweep] veins.kill_distance = normal(1, 0): the standard deviation must be above 0");
    check_refused("veins.kill_distance = normal(-1, 1)",
                  "@/s.ini:3: [sweep] veins.kill_distance = normal(-1, 1): the mean must be a number from 0 to 1e6 (segments)");
    check_refused("veins.pattern = uniform(1, 2)",
                  "@/s.ini:3: [sweep] veins.pattern = uniform(1, 2): no number; of values like these choice(…) draws");
    check_refused("seed = -1", "@/s.ini:3: [sweep] seed = -1: must be a whole number from 0 to 2^53, or each");
    check_refused("mode = gird", "@/s.ini:3: [sweep] mode = gird: must be one of grid, zip or sample; did you mean 'grid'?");
    check_refused("sequence = sobol", "@/s.ini:3: [sweep] sequence = sobol: must be random or halton");
    check_refused("count = 0", "@/s.ini:3: [sweep] count = 0: must be a whole number from 1 to 999999999");
    check_refused("mode = sample\ncount = 1000000000", "@/s.ini:4: [sweep] count = 1000000000: must be a whole number from 1 to 999999999");
    check_refused("mode = sample", "@/s.ini:3: [sweep] count: missing; mode sample needs the number of variants, 1 to 999999999");
    check_refused("count = 5\nseed = 1; 2", "@/s.ini:3: [sweep] count: is of mode sample; in the others the lists give the number");
    check_refused("mode = grid\nveins.kill_distance = uniform(1, 2)", "@/s.ini:3: [sweep] mode: nothing to combine, all that varies is drawn "
                                                                      "by chance; that is mode = sample, with a count");
    check_refused("mode = grid\nveins.kill_distance = from 1 to 1000 by 1\nseed = from 1 to 1000000 by 1",
                  "@/s.ini:5: [sweep] seed: has 1000000 values, and 1000000000 variants are too many; there may be up to 999999999");
    check_refused("mode = zip\nseed = from 1 to 1000000000 by 1",
                  "@/s.ini:4: [sweep] seed: has 1000000000 values, and 1000000000 variants are too many; there may be up to 999999999");
    check_refused("seed = 1; 9007199254740993", "@/s.ini:3: [sweep] seed = 9007199254740993: must be a whole number from 0 to 2^53, or each");
    check_refused("mode = sample\ncount = 3\nsample_seed = 9007199254740991\nseed = each",
                  "@/s.ini:6: [sweep] seed = each: the last would be beyond 2^53; sample_seed may be up to 9007199254740990");
    static const char *const device[] = {"con", "AUX", "nul.a", "Prn", "com1", "LPT9.x.y"};
    for (gsize i = 0; i < G_N_ELEMENTS(device); i++) {
        char *body = g_strdup_printf("mode = zip\nname = a; %s\nseed = 1; 2", device[i]);
        char *message = g_strdup_printf("@/s.ini:4: [sweep] name = %s: is a device on Windows, which has no files called so", device[i]);
        check_refused(body, message);
        g_free(message);
        g_free(body);
    }
    check_refused("mode = zip\nseed = 1; 2; 3\nveins.kill_distance = 1; 2",
                  "@/s.ini:5: [sweep] veins.kill_distance: has 2 values, and seed of line 4 has 3; in mode zip there must be as many (or one for all)");
    check_refused("seed = 1; 2; 01", "@/s.ini:3: [sweep] seed: two values are the same");
    check_refused("seed = 1\nseed = 2", "@/s.ini:4: [sweep] seed: already given in line 3 of the sweep file");
    check_refused("mode = zip\nname = a; ../b\nseed = 1; 2",
                  "@/s.ini:4: [sweep] name = ../b: would leave the folder or hide; a name holds no / and \\ and begins with no point");
    check_refused("mode = zip\nname = a/b; b\nseed = 1; 2",
                  "@/s.ini:4: [sweep] name = a/b: would leave the folder or hide; a name holds no / and \\ and begins with no point");
    check_refused("mode = zip\nname = a b; b\nseed = 1; 2", "@/s.ini:4: [sweep] name = a b: must be of the letters A to Z, digits, and _ . + -, "
                                                           "begin with no - and end with no point");
    check_refused("mode = zip\nname = a; A\nseed = 1; 2", "@/s.ini:4: [sweep] name: two variants of the same name (upper and lower case are one)");
    check_refused("mode = zip\nname = a\nseed = 1; 2",
                  "@/s.ini:5: [sweep] seed: has 2 values, and name of line 4 has 1; in mode zip there must be as many (or one for all)");
    check_refused("name = a; b\nseed = 1; 2", "@/s.ini:3: [sweep] name: names are a list of mode zip, or a column of the table");
    check_refused("[veins]", "@/s.ini:3: [veins]: a sweep file has one section, [sweep]; keys stand there as veins.kill_distance");
    check_refused("what", "@/s.ini:3: [sweep] 'what': must be key = value, [sweep], or a comment after # or ;");
    check_refused("params = x", "@/s.ini:3: [sweep] params: already given in line 2 of the sweep file");
}

static void test_refused_tables(void)
{
    put("b.csv", "veins.kill_distance,veins.seds\n");
    check_refused("table = b.csv", "@/b.csv:1: veins.seds: no such key; did you mean 'veins.seeds'?");
    put("b.csv", "veins.kill_distance,seed\n1,2\n3\n");
    check_refused("table = b.csv", "@/b.csv:3: 1 cell, and the heading has 2");
    put("b.csv", "veins.kill_distance,seed\n1,2\n-3,x\n");
    check_refused("table = b.csv", "@/b.csv:3: veins.kill_distance = -3: must be a number from 0 to 1e6 (segments)");
    put("b.csv", "veins.kill_distance,seed\n");
    check_refused("table = b.csv", "@/b.csv: no rows; a heading of keys comes first, then a row for each variant");
    put("b.csv", "");
    check_refused("table = b.csv", "@/b.csv: no rows; a heading of keys comes first, then a row for each variant");
    put("b.csv", "name,seed\na,1\n../../a,2\n");
    check_refused("table = b.csv", "@/b.csv:3: name = ../../a: would leave the folder or hide; a name holds no / and \\ and begins with no point");
    put("b.csv", "name,seed\na,1\nA,2\n");
    check_refused("table = b.csv", "@/b.csv: name = A: there are two of this name (upper and lower case are one)");
    put("b.csv", "name\na\n");
    check_refused("table = b.csv", "@/b.csv:1: no column is a key");
    put("b.csv", "seed,seed\n1,2\n");
    check_refused("table = b.csv", "@/b.csv:1: seed: two columns are called so");
    put("b.csv", "seed,leaf.title\n1,\"a\n");
    check_refused("table = b.csv", "@/b.csv:2: quotes that do not close, or text after them");
    put("b.csv", "seed\n1\n2\n");
    check_refused("seed = 1\ntable = b.csv", "@/b.csv: seed: already given in line 3 of the sweep file");
    check_refused("mode = zip\ntable = b.csv\nveins.kill_distance = 1;2;3",
                  "@/s.ini:5: [sweep] veins.kill_distance: has 3 values, and the table of line 4 has 2; in mode zip there must be as many (or one for all)");
    check_refused("table = none.csv", "@/s.ini:3: [sweep] table: @/none.csv: can't read '@/none.csv': No such file or directory");
    GError *error = NULL;
    g_assert_null(sweep_parse("seed = 1", 8, "x.ini", &error));
    g_assert_cmpstr(error->message, ==, "x.ini:1: [sweep] seed: [sweep] must come before the first key");
    g_clear_error(&error);
    g_assert_null(sweep_parse("[sweep]", 7, "x.ini", &error));
    g_assert_cmpstr(error->message, ==, "x.ini: [sweep] params: missing; it names the parameter file that all variants begin with");
    g_clear_error(&error);
    g_assert_null(sweep_parse("[sweep]\nparams=no/no.ini", 24, "x.ini", &error));
    g_assert_cmpstr(error->message, ==, "x.ini:2: [sweep] params: no/no.ini: No such file or directory");
    g_clear_error(&error);
    g_assert_null(sweep_load("no/such.ini", &error));
    g_assert_nonnull(strstr(error->message, "no/such.ini: "));
    g_clear_error(&error);
}

/* Any bytes are read or refused with a message. */
static void test_noise(void)
{
    static const char *const pieces[] = {"from ", "1", " to ", " by ", " in ", " log", "uniform(", "normal(", "choice(", ")", ",", ";", "|", "=",
                                         "\n", "seed", "veins.kill_distance", "veins.seeds", "mode", "zip", "sample", "count", "table", "t.csv",
                                         "n.csv", "name", "each", " ", "1e9", "-", "0.5", "a", "\"", "ä", "[sweep]", "log-uniform(", "2", "30"};
    for (uint32_t i = 0; i < 30000; i++) {
        GString *body = g_string_new("");
        for (uint32_t k = 0; k < 14; k++) {
            g_string_append(body, pieces[random_block(1, 1, i, k).w[0] % G_N_ELEMENTS(pieces)]);
            if (k == 0)
                g_string_append(body, " = ");
        }
        GError *error = NULL;
        Sweep *s = parse(body->str, &error);
        g_assert_true((s == NULL) == (error != NULL));
        if (s)
            for (int k = 0; k < 3; k++)
                g_free(tell(s, (uint64_t)k * (sweep_count(s) - 1) / 2));
        sweep_free(s);
        g_clear_error(&error);
        g_string_free(body, TRUE);
    }
}

/* The sweeps that come along. */
static void test_shipped(void)
{
    static const struct {
        const char *file;
        uint64_t count;
        const char *first;
    } cases[] = {{"kill-distance.ini", 5, "kill_distance-40_minimum-2"}, {"dart-density.ini", 3, "density-6e-05"}, {"species.ini", 1000, "000000"}};
    for (gsize i = 0; i < G_N_ELEMENTS(cases); i++) {
        char *path = g_test_build_filename(G_TEST_DIST, "..", "..", "params", "sweeps", cases[i].file, NULL);
        GError *error = NULL;
        Sweep *s = sweep_load(path, &error);
        g_assert_no_error(error);
        g_assert_cmpuint(sweep_count(s), ==, cases[i].count);
        SweepVariant v;
        sweep_variant(s, 0, &v);
        g_assert_cmpstr(v.name, ==, cases[i].first);
        sweep_variant_clear(&v);
        check_sound(s);
        sweep_free(s);
        g_free(path);
    }
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    folder = g_dir_make_tmp("sweep-XXXXXX", NULL);
    put("base.ini", "[outline]\npath = M 0,0 C 3,3 3,6 0,10 C -3,6 -3,3 0,0 Z\n");
    g_test_add_func("/sweep/grid", test_grid);
    g_test_add_func("/sweep/zip", test_zip);
    g_test_add_func("/sweep/ranges", test_ranges);
    g_test_add_func("/sweep/texts", test_texts);
    g_test_add_func("/sweep/table", test_table);
    g_test_add_func("/sweep/distributions", test_distributions);
    g_test_add_func("/sweep/normal", test_normal);
    g_test_add_func("/sweep/halton", test_halton);
    g_test_add_func("/sweep/halton-columns", test_halton_columns);
    g_test_add_func("/sweep/determinism", test_determinism);
    g_test_add_func("/sweep/independence", test_independence);
    g_test_add_func("/sweep/keys-of-chance", test_keys_of_chance);
    g_test_add_func("/sweep/large", test_large);
    g_test_add_func("/sweep/refused", test_refused);
    g_test_add_func("/sweep/refused-tables", test_refused_tables);
    g_test_add_func("/sweep/noise", test_noise);
    g_test_add_func("/sweep/shipped", test_shipped);
    int status = g_test_run();
    static const char *const files[] = {"base.ini", "t.csv", "n.csv", "same.csv", "b.csv"};
    for (gsize i = 0; i < G_N_ELEMENTS(files); i++) {
        char *path = g_build_filename(folder, files[i], NULL);
        g_unlink(path);
        g_free(path);
    }
    g_rmdir(folder);
    g_free(folder);
    return status;
}
