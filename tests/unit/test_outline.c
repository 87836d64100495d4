/* Outlines: leaf coordinates, base and tip, mirroring, teeth, and what is refused. */
#include <glib.h>
#include <glib/gstdio.h>
#include <string.h>

#include "geom/outline.h"
#include "geom/random.h"
#include "real_scan.h"

#define CLOSE(a, b) g_assert_cmpfloat_with_epsilon(a, b, 1e-9)

static OutlineDef path_def(const char *path)
{
    OutlineDef def = outline_def_default();
    def.path = path;
    def.mirror = false;
    def.where = "leaf.ini, [outline] path";
    return def;
}

/* What every outline promises. */
static void check_promises(const Polygon *p)
{
    uint32_t i, j;
    g_assert_false(polygon_crossing(p, &i, &j));
    g_assert_cmpfloat(p->area, >, 0.0);
    double twice = 0.0;
    for (i = 0; i < p->n; i++) {
        twice += vec_cross(p->v[i], p->v[(i + 1) % p->n]);
        g_assert_cmpfloat(vec_dist(p->v[i], p->v[(i + 1) % p->n]), >, 0.0);
    }
    g_assert_cmpfloat(twice, >, 0.0);
}

static Polygon *make(const OutlineDef *def)
{
    GError *error = NULL;
    Polygon *p = outline_new(def, &error);
    g_assert_no_error(error);
    check_promises(p);
    return p;
}

static bool has_vertex(const Polygon *p, double x, double y)
{
    for (uint32_t i = 0; i < p->n; i++)
        if (p->v[i].x == x && p->v[i].y == y)
            return true;
    return false;
}

static bool starts_at_base(const Polygon *p) { return p->v[0].x == 0.0 && p->v[0].y == 0.0; }

static void test_default(void)
{
    OutlineDef def = outline_def_default();
    Polygon *p = make(&def);
    g_assert_true(starts_at_base(p));
    g_assert_true(has_vertex(p, 0.0, 1.0));
    CLOSE(p->box.x0, -p->box.x1);
    g_assert_cmpfloat(p->box.y0, ==, 0.0);
    g_assert_cmpfloat(p->box.y1, ==, 1.0);
    double width = p->box.x1 - p->box.x0;
    g_assert_cmpfloat(width, >, 0.5);
    g_assert_cmpfloat(width, <, 0.6);
    for (uint32_t i = 1; i < p->n; i++) /* its halves are mirror images to the bit */
        g_assert_true(has_vertex(p, -p->v[i].x + 0.0, p->v[i].y));
    polygon_free(p);
}

/* The same square, base at one corner and tip at the opposite one, drawn anywhere, of any size, either way round. */
static void test_similarity(void)
{
    const char *const squares[] = {
        "M0 0L1 1 0 2-1 1z",           "M0 0L-1 1 0 2 1 1z",          "M 5e7 5e7 h 1e3 v 1e3 h -1e3 z",
        "M 7 7 L 7 9 L 9 9 L 9 7 7 7", "M 1e-9 0 H 0 V -1e-9 H 1e-9", "M 3 -4 l 7 1 1 -7 -7 -1 z"};
    for (guint k = 0; k < G_N_ELEMENTS(squares); k++) {
        OutlineDef def = path_def(squares[k]);
        Polygon *p = make(&def);
        g_assert_cmpuint(p->n, ==, 4);
        const Vec2 expected[4] = {{0, 0}, {0.5, 0.5}, {0, 1}, {-0.5, 0.5}};
        for (int i = 0; i < 4; i++) {
            CLOSE(p->v[i].x, expected[i].x);
            CLOSE(p->v[i].y, expected[i].y);
        }
        g_assert_true(starts_at_base(p) && has_vertex(p, 0.0, 1.0));
        polygon_free(p);
    }
}

static void test_base_tip(void)
{
    const char *square = "M0 0H2V2H0z";
    OutlineDef def = path_def(square); /* on an edge: becomes the first vertex */
    def.has_base = def.has_tip = true;
    def.base = vec2(1, 0);
    def.tip = vec2(1, 2);
    Polygon *p = make(&def);
    g_assert_cmpuint(p->n, ==, 6);
    g_assert_true(starts_at_base(p) && has_vertex(p, 0.0, 1.0) && has_vertex(p, 0.5, 0.0));
    polygon_free(p);

    def.base = vec2(1, -1e-7); /* a hair outside: snapped */
    p = make(&def);
    g_assert_true(starts_at_base(p));
    g_assert_cmpfloat(p->v[0].y, ==, 0.0);
    polygon_free(p);

    def.base = vec2(1, 1); /* peltate; the tip by rule is the first corner farthest from it */
    def.has_tip = false;
    p = make(&def);
    g_assert_cmpuint(p->n, ==, 4);
    g_assert_true(polygon_contains(p, vec2(0, 0)) && has_vertex(p, 0.0, 1.0));
    g_assert_cmpfloat_with_epsilon(p->area, 2.0, 1e-12);
    polygon_free(p);

    /* A base on a curve, which the polygon cuts short of it. */
    def = path_def("M1 0A1 1 0 0 1-1 0A1 1 0 0 1 1 0z");
    def.has_base = def.has_tip = true;
    def.base = vec2(-0.6, -0.8);
    def.tip = vec2(0.6, 0.8);
    def.flatness = 1e-3;
    p = make(&def);
    g_assert_true(starts_at_base(p) && has_vertex(p, 0.0, 1.0));
    g_assert_cmpfloat_with_epsilon(p->area, G_PI / 4.0, 3e-3);
    polygon_free(p);

    def = path_def("M0 0 L1 3 2 1 5 1z"); /* the farthest vertex, not the highest */
    p = make(&def);
    CLOSE(p->v[0].x, 0.0);
    CLOSE(vec_dist(p->v[1], p->v[0]), sqrt(26.0) / sqrt(26.0));
    polygon_free(p);
}

static void test_mirror(void)
{
    OutlineDef def = path_def("M0 0L2 1 0 4"); /* a kite */
    def.mirror = true;
    Polygon *p = make(&def);
    g_assert_cmpuint(p->n, ==, 4);
    g_assert_true(has_vertex(p, 0.5, 0.25) && has_vertex(p, -0.5, 0.25) && has_vertex(p, 0.0, 1.0));
    polygon_free(p);

    def.path = "M0 0L2 1 0 4z"; /* closing along the axis changes nothing */
    p = make(&def);
    g_assert_cmpuint(p->n, ==, 4);
    polygon_free(p);

    def.path = "M7 7L8 5 11 7"; /* along x; the right half of a leaf that points that way lies at smaller y */
    p = make(&def);
    g_assert_true(starts_at_base(p) && has_vertex(p, 0.5, 0.25) && has_vertex(p, -0.5, 0.25));
    polygon_free(p);

    def.path = "M0 0L2 1 2 5 0 4"; /* notched: the tip is the last point, though others are farther */
    p = make(&def);
    g_assert_true(has_vertex(p, 0.5, 1.25) && has_vertex(p, -0.5, 1.25) && has_vertex(p, 0.0, 1.0));
    polygon_free(p);

    def.path = "M1 0L2 1 1 4"; /* ends off the given axis: joined straight across */
    def.has_base = def.has_tip = true;
    def.base = vec2(0, 0);
    def.tip = vec2(0, 4);
    p = make(&def);
    g_assert_true(has_vertex(p, 0.25, 0.0) && has_vertex(p, -0.25, 1.0) && starts_at_base(p));
    polygon_free(p);
}

/* --- teeth --- */

/* Local farthest points from the axis on one side of a straight-sided strip. */
static uint32_t count_peaks(const Polygon *p, double side, double *least, double *most)
{
    uint32_t peaks = 0;
    *least = HUGE_VAL;
    *most = -HUGE_VAL;
    for (uint32_t i = 0; i < p->n; i++) {
        double x = side * p->v[i].x, before = side * p->v[(i + p->n - 1) % p->n].x,
               after = side * p->v[(i + 1) % p->n].x;
        if (x > before && x > after && x > 0.0) {
            peaks++;
            *least = MIN(*least, x);
            *most = MAX(*most, x);
        }
    }
    return peaks;
}

/* A wedge-ended strip with straight sides at x = ±0.1, base and tip at its points. */
static const char strip[] = "M0 0L.1 .1V.9L0 1-.1 .9V.1z";

static void test_teeth(void)
{
    const double from = 0.3, to = 0.7;
    const OutlineWave wave = {0.01, 8};
    OutlineDef def = path_def(strip);
    def.waves = &wave;
    def.n_waves = 1;
    def.tooth_from = from;
    def.tooth_to = to;
    for (int k = 0; k < 3; k++) {
        def.tooth_skew = 0.25 + 0.25 * k;
        Polygon *p = make(&def);
        double side = 2.0 * sqrt(0.02) + 0.8, period = (to - from) * side / 8.0, first = from * side - sqrt(0.02) + 0.1;
        for (int hand = -1; hand <= 1; hand += 2) {
            double least, most;
            g_assert_cmpuint(count_peaks(p, hand, &least, &most), ==, 8);
            CLOSE(least, 0.11);
            CLOSE(most, 0.11);
        }
        g_assert_cmpuint(p->n, ==, 6 + 2 * (8 + 9)); /* each peak and valley, nothing else */
        for (int i = 0; i < 8; i++) {
            double peak = first + (i + def.tooth_skew) * period, valley = first + i * period;
            g_assert_true(polygon_contains(p, vec2(0.11 - 1e-9, peak)) &&
                          !polygon_contains(p, vec2(0.11 + 1e-9, peak)));
            g_assert_true(polygon_contains(p, vec2(-0.1 + 1e-9, valley)) &&
                          !polygon_contains(p, vec2(-0.1 - 1e-9, valley)));
        }
        CLOSE(p->area, 0.18 + 8 * period * 0.01);
        polygon_free(p);
    }
}

static void test_teeth_sum(void)
{
    const OutlineWave waves[] = {{0.02, 2}, {0.01, 8}, {0.5, 0.5}, {0.0, 700}}; /* the last two bear none */
    OutlineDef def = path_def(strip);
    def.waves = waves;
    def.n_waves = 4;
    def.tooth_from = 0.3;
    def.tooth_to = 0.7;
    Polygon *p = make(&def);
    double least, most, side = 2.0 * sqrt(0.02) + 0.8, period = 0.4 * side / 8.0, first = 0.5 - 0.2 * side;
    g_assert_cmpuint(count_peaks(p, 1.0, &least, &most), ==, 8);
    CLOSE(least, 0.1 + 0.02 * 0.25 + 0.01);
    CLOSE(most, 0.1 + 0.02 * 0.75 + 0.01);
    CLOSE(p->area, 0.18 + 8 * period * (0.02 + 0.01));
    for (int k = 0; k < 8; k++) { /* the small peaks ride on the slopes of the large ones */
        double at = (k + 0.5) / 4.0, phase = at - floor(at), large = phase < 0.5 ? 2.0 * phase : 2.0 - 2.0 * phase;
        Vec2 peak = vec2(0.1 + 0.02 * large + 0.01, first + (k + 0.5) * period);
        g_assert_true(polygon_contains(p, vec_sub(peak, vec2(1e-9, 0))) &&
                      !polygon_contains(p, vec_add(peak, vec2(1e-9, 0))));
    }
    polygon_free(p);
}

/* On a curved leaf: as many peaks as asked for on each side, each as far from the smooth margin as asked for. */
static void test_teeth_curved(void)
{
    const OutlineWave wave = {0.015, 25};
    OutlineDef def = outline_def_default();
    Polygon *smooth = make(&def);
    def.waves = &wave;
    def.n_waves = 1;
    def.tooth_skew = 0.8;
    Polygon *p = make(&def);
    uint32_t peaks[2] = {0, 0};
    for (uint32_t i = 0; i < p->n; i++) {
        double height = -polygon_depth(smooth, p->v[i]);
        g_assert_cmpfloat(height, <, 0.015 + 1e-4);
        double before = -polygon_depth(smooth, p->v[(i + p->n - 1) % p->n]),
               after = -polygon_depth(smooth, p->v[(i + 1) % p->n]);
        if (height > before && height > after) {
            g_assert_cmpfloat(height, >, 0.97 * 0.015);
            peaks[p->v[i].x < 0.0]++;
        }
    }
    g_assert_cmpuint(peaks[0], ==, 25);
    g_assert_cmpuint(peaks[1], ==, 25);
    g_assert_true(starts_at_base(p) && has_vertex(p, 0.0, 1.0));
    polygon_free(p);
    polygon_free(smooth);
}

static void test_teeth_peltate(void)
{
    const OutlineWave wave = {0.05, 12};
    OutlineDef def = path_def("M1 0A1 1 0 0 1-1 0A1 1 0 0 1 1 0z");
    def.has_base = def.has_tip = true;
    def.base = vec2(0, 0);
    def.tip = vec2(0, 1);
    def.waves = &wave;
    def.n_waves = 1;
    def.tooth_from = 0.0;
    def.tooth_to = 1.0;
    Polygon *p = make(&def);
    uint32_t peaks[2] = {0, 0};
    for (uint32_t i = 0; i < p->n; i++)
        if (sqrt(vec_norm2(p->v[i])) > 1.049)
            peaks[p->v[i].x < 0.0]++;
    g_assert_cmpuint(peaks[0], ==, 12);
    g_assert_cmpuint(peaks[1], ==, 12);
    polygon_free(p);
}

/* --- files --- */

static char *write_temporary(const char *text)
{
    char *name;
    GError *error = NULL;
    int file = g_file_open_tmp("venation-XXXXXX.svg", &name, &error);
    g_assert_no_error(error);
    g_close(file, NULL);
    g_file_set_contents(name, text, -1, &error);
    g_assert_no_error(error);
    return name;
}

static void test_file(void)
{
    /* Drawn y down: the base is at the bottom of the page, the right corner at larger x. */
    char *name = write_temporary(
        "<svg><g transform='rotate(180)'><path id='outline' transform='scale(-1 -1)' d='M10 50 L 40 30 10 10 z'/>"
        "</g><circle id='base' cx='10' cy='50'/><circle id='tip' cx='10' cy='10'/></svg>");
    OutlineDef def = path_def(NULL);
    def.file = name;
    Polygon *p = make(&def);
    g_assert_cmpuint(p->n, ==, 3);
    CLOSE(p->v[1].x, 0.75);
    CLOSE(p->v[1].y, 0.5);
    g_assert_true(starts_at_base(p) && has_vertex(p, 0.0, 1.0));
    polygon_free(p);

    def.has_base = def.has_tip = true; /* given by hand, in the file's units, they win over the marks */
    def.base = vec2(10, 10);
    def.tip = vec2(10, 50);
    p = make(&def);
    CLOSE(p->box.x0, -0.75);
    polygon_free(p);
    g_unlink(name);
    g_free(name);
}

/* --- refusals --- */

static void refuse(const OutlineDef *def, OutlineError code, const char *part)
{
    GError *error = NULL;
    Polygon *p = outline_new(def, &error);
    g_assert_null(p);
    g_assert_error(error, OUTLINE_ERROR, (int)code);
    if (!g_str_has_prefix(error->message, "leaf.ini, [outline] path: ") || !strstr(error->message, part))
        g_error("'%s' does not say '%s'", error->message, part);
    g_error_free(error);
}

static void test_refused_paths(void)
{
    const struct {
        const char *path;
        OutlineError code;
        const char *part;
    } cases[] = {
        {"M 0 0 L 10 10 L q", OUTLINE_ERROR_SYNTAX, "path: at character 17: expected a number, found 'q'"},
        {"", OUTLINE_ERROR_SHAPE, "empty"},
        {"M 5 5", OUTLINE_ERROR_SHAPE, "empty"},
        {"M 5 5 z", OUTLINE_ERROR_SHAPE, "empty"},
        {"M 5 5 L 5 5 5 5z", OUTLINE_ERROR_SHAPE, "base and tip are the same"},
        {"M 0 0 L 1 1 z", OUTLINE_ERROR_SHAPE, "no area"},
        {"M 0 0 L 1 1 2 2 3 3 z", OUTLINE_ERROR_SHAPE, "no area"},
        {"M 3 3 L 3 4 3 3 z", OUTLINE_ERROR_SHAPE, "no area"},
        {"M 0 0 L 1e-7 0.5 0 1 z", OUTLINE_ERROR_SHAPE, "a sliver, on average 5e-08 times as wide as long"},
        {"M 0 0 L 1e-3 0.5 0 1 z", OUTLINE_ERROR_SHAPE, "a sliver"},
        {"M 0 0 L 70 700 140 1400 140.1 1400 z", OUTLINE_ERROR_SHAPE, "a sliver"},
        {"M 0 0 L 1 1 1 0 0 1 z", OUTLINE_ERROR_SHAPE, "crosses or touches itself near 0.5,0.5"}, /* encloses 0, signed */
        {"M 0 0 L 1 1 1 0 0 1.5 z", OUTLINE_ERROR_SHAPE, "crosses or touches itself near 0.6,0.6"},
        {"M 0 0 L 10 0 10 8 2 8 2 -4 0 -4 z", OUTLINE_ERROR_SHAPE, "crosses or touches itself near 2,0"},
        {"M 0 0 C 3 0 3 4 0 4 C -3 4 -1 1 1.5 1 L 1.5 -1 z", OUTLINE_ERROR_SHAPE, "crosses or touches itself near 1.5,0."},
        {"M 0 0 L 1 0 1 1 2 1 1 1 0 1 z", OUTLINE_ERROR_SHAPE, "crosses or touches itself near 1,1"},
        {"M 0 0 L 4 0 4 3 2 0 1 3 z", OUTLINE_ERROR_SHAPE, "crosses or touches itself near 2,0"}, /* touches */
        {"M 0 0 L 4 0 4 2 3 0 1 0 0 2 z", OUTLINE_ERROR_SHAPE, "crosses or touches itself near"}, /* runs along itself */
        {"M 0 0 H 1 V 1 H 0 z M 3 3 h 1 v 1 z", OUTLINE_ERROR_SHAPE, "2 subpaths"},
        {"M nan 0 L 1 1", OUTLINE_ERROR_SYNTAX, "found 'n'"},
        {"M 0 0 L 1e999 1", OUTLINE_ERROR_SYNTAX, "too large"},
        {"M 1e50 1e50 l 1 0 0 1 z", OUTLINE_ERROR_SHAPE, "same"},
    };
    for (guint k = 0; k < G_N_ELEMENTS(cases); k++) {
        OutlineDef def = path_def(cases[k].path);
        refuse(&def, cases[k].code, cases[k].part);
    }
}

static void test_refused_settings(void)
{
    const OutlineDef good = path_def("M0 0H2V2H0z");
    OutlineDef def = good;
    def.path = NULL;
    refuse(&def, OUTLINE_ERROR_SHAPE, "exactly one");
    def.file = "/no/such/file.svg";
    refuse(&def, OUTLINE_ERROR_READ, "/no/such/file.svg");
    def.path = good.path;
    refuse(&def, OUTLINE_ERROR_SHAPE, "exactly one");

    def = good;
    def.has_base = def.has_tip = true;
    def.base = def.tip = vec2(1, 1);
    refuse(&def, OUTLINE_ERROR_SHAPE, "same point");
    def.base = vec2(1, -0.5);
    def.tip = vec2(1, 2);
    refuse(&def, OUTLINE_ERROR_SHAPE, "base 1,-0.5 lies outside the blade; the margin's nearest point is 1,0");
    def.base = vec2(NAN, 0);
    refuse(&def, OUTLINE_ERROR_SHAPE, "not numbers");
    def.base = vec2(0, INFINITY);
    refuse(&def, OUTLINE_ERROR_SHAPE, "not numbers");
    def.base = vec2(1, 0);
    def.tip = vec2(1, 0.001);
    refuse(&def, OUTLINE_ERROR_SHAPE, "as large as");

    def = good;
    def.flatness = NAN;
    refuse(&def, OUTLINE_ERROR_SHAPE, "flatness");
    def.flatness = 0.0;
    refuse(&def, OUTLINE_ERROR_SHAPE, "flatness");

    def = path_def(strip);
    const OutlineWave waves[] = {{-0.1, 3}, {NAN, 3}, {0.1, INFINITY}, {0.1, -1}, {0.1, 1e9}};
    def.n_waves = 1;
    for (guint k = 0; k < G_N_ELEMENTS(waves); k++) {
        def.waves = &waves[k];
        refuse(&def, OUTLINE_ERROR_SHAPE, k < 2 ? "amplitude" : "count");
    }
    const OutlineWave wave = {0.1, 5};
    def.waves = &wave;
    def.tooth_skew = 1.0;
    refuse(&def, OUTLINE_ERROR_SHAPE, "skew");
    def.tooth_skew = 0.5;
    def.tooth_from = 0.9;
    def.tooth_to = 0.2;
    refuse(&def, OUTLINE_ERROR_SHAPE, "begin before they end");

    const OutlineWave deep = {0.3, 40}; /* inside a narrow notch the teeth of its flanks run into each other */
    def = path_def("M0 0L1 0 1 1 .55 1 .5 .2 .45 1 0 1z");
    def.waves = &deep;
    def.n_waves = 1;
    refuse(&def, OUTLINE_ERROR_SHAPE, "the teeth run into each other or the blade near");
    g_assert_null(outline_new(&def, NULL)); /* no one need ask why */
}

/* Wherever two segments of a crossing outline meet, the message names that point. */
static void test_crossing_place(void)
{
    for (uint32_t k = 0; k < 300; k++) {
        double u[6];
        for (uint32_t i = 0; i < 6; i++)
            u[i] = (double)random_block(11, 0, k, i).w[0] * 0x1p-32;
        /* From (0,0) straight up by `high`; back across it at height y, slanting by `slope`, from right to left. */
        double high = 2 + 3 * u[0], y = high * (0.3 + 0.4 * u[1]), right = 0.5 + 3 * u[2], left = 0.5 + 3 * u[3], slope = 0.4 * u[4] - 0.2;
        double x = 500 * u[5];
        char *path = g_strdup_printf("M %.9f 0 V %.9f L %.9f %.9f L %.9f %.9f z", x, high, x + right, y + slope * right, x - left,
                                     y - slope * left);
        OutlineDef def = path_def(path);
        GError *error = NULL;
        g_assert_null(outline_new(&def, &error));
        g_assert_error(error, OUTLINE_ERROR, OUTLINE_ERROR_SHAPE);
        const char *near = strstr(error->message, "itself near ");
        g_assert_nonnull(near);
        char *end;
        g_assert_cmpfloat_with_epsilon(g_ascii_strtod(near + 12, &end), x, 1e-3);
        g_assert_cmpfloat_with_epsilon(g_ascii_strtod(end + 1, NULL), y, 1e-3);
        g_error_free(error);
        g_free(path);
    }
}

/* The narrowest leaves there are, needles and grasses, are leaves. */
static void test_narrow(void)
{
    OutlineDef def = path_def("M 0 0 L 0.0035 0.1 0.0035 0.9 0 1 -0.0035 0.9 -0.0035 0.1 z");
    polygon_free(make(&def));
    def.path = "M 0 0 L 0.002 0.5 0 1 z";
    def.mirror = true;
    polygon_free(make(&def));
}

/* Random path data; every fourth text has a random byte in it. */
static char *noise(uint32_t k)
{
    static const char commands[] = "LlHhVvCcSsQqTtAaZz", counts[] = "221111664444227700";
    GString *text = g_string_new("M0 0");
    uint32_t length = 1 + random_block(9, 1, k, 0).w[0] % 5;
    for (uint32_t i = 0; i < length; i++) {
        uint32_t c = random_block(9, 2, k, i).w[0] % (sizeof commands - 1);
        g_string_append_c(text, commands[c]);
        for (int a = 0; a < counts[c] - '0'; a++) {
            uint32_t r = random_block(9, 3, k, 16 * i + (uint32_t)a).w[0];
            g_string_append_printf(text, " %d", c >= 14 && (a == 3 || a == 4) ? (int)(r % 2) : (int)(r % 19) - 9);
        }
    }
    RandomBlock b = random_block(9, 4, k, 0);
    if (k % 4 == 0)
        text->str[b.w[0] % text->len] = (char)(1 + b.w[1] % 255);
    return g_string_free(text, FALSE);
}

/* Whatever is in the text, the answer is an outline that keeps its promises, or an error. */
static void test_noise(void)
{
    const OutlineWave wave = {0.02, 6};
    uint32_t made = 0, total = 10000;
    for (uint32_t k = 0; k < total; k++) {
        char *text = noise(k);
        OutlineDef def = path_def(text);
        def.mirror = k % 3 == 0;
        def.flatness = 0.01;
        def.waves = &wave;
        def.n_waves = k % 5 == 0;
        GError *error = NULL;
        Polygon *p = outline_new(&def, &error);
        g_assert_true(!p == !!error);
        if (p)
            check_promises(p);
        made += p != NULL;
        polygon_free(p);
        g_clear_error(&error);
        g_free(text);
    }
    g_test_message("%u outlines of %u", made, total);
    g_assert_cmpuint(made, >, total / 10);
}

/* --- tracings --- */

static Polygon *trace(const char *text, GError **error)
{
    char *dir = g_dir_make_tmp("venation-outline-XXXXXX", NULL), *path = g_build_filename(dir, "blade.txt", NULL);
    g_assert_true(g_file_set_contents(path, text, -1, NULL));
    OutlineDef def = path_def(NULL);
    def.file = path;
    Polygon *p = outline_new(&def, error);
    g_unlink(path);
    g_rmdir(dir);
    g_free(path);
    g_free(dir);
    return p;
}

/* Points of a text file, y down, are the path that they'd be with y up, however they are parted, and whether the first is there again or not. */
static void test_tracing(void)
{
    OutlineDef def = path_def("M 100 -900 L 500.5 -500 L 130 -20 L -2e2 -480 Z");
    Polygon *known = make(&def);
    static const char *const text[] = {
        "100 900\n500.5 500\n130 20\n-2e2 480\n",
        "100\t900\r\n500.5\t500\r\n130\t20\r\n-200\t480\r\n100\t900\r\n",
        "\xEF\xBB\xBF\n 100,900\n 500.5, 500 \n+130;20\n\t-200 480\n100 900\n\n \n",
    };
    for (guint k = 0; k < G_N_ELEMENTS(text); k++) {
        GError *error = NULL;
        Polygon *p = trace(text[k], &error);
        g_assert_no_error(error);
        check_promises(p);
        g_assert_cmpuint(p->n, ==, known->n);
        for (uint32_t i = 0; i < p->n; i++)
            g_assert_true(p->v[i].x == known->v[i].x && p->v[i].y == known->v[i].y);
        polygon_free(p);
    }
    polygon_free(known);
}

static void test_tracing_refused(void)
{
    static const struct {
        const char *text;
        int code;
        const char *part;
    } bad[] = {
        {"1 2\n3 4 5\n6 7\n", OUTLINE_ERROR_SYNTAX, "blade.txt:2: '3 4 5' is no point"},
        {"1 2\n3 4\n6\n", OUTLINE_ERROR_SYNTAX, "blade.txt:3: '6' is no point"},
        {"1 2\n3 y\n6 7\n", OUTLINE_ERROR_SYNTAX, "blade.txt:2: '3 y' is no point"},
        {"1 2\nnan 3\n6 7\n", OUTLINE_ERROR_SYNTAX, "blade.txt:2: 'nan 3' is no point"},
        {"1 2\n3 2000000\n6 7\n", OUTLINE_ERROR_SYNTAX, "-1000000 to 1000000"},
        {"0 0\n9 0\n9 9\n\n\n20 0\n29 0\n29 9\n20 9\n", OUTLINE_ERROR_SHAPE, "blade.txt:1: what is traced from here on, 40.5 px"},
        {"0 0\n9 0\n9 5\n\n\n20 0\n22 0\n22 9\n20 9\n", OUTLINE_ERROR_SHAPE, "blade.txt:6: what is traced from here on, 18 px"},
        {"1 2\n", OUTLINE_ERROR_SHAPE, "the path is empty"},
        {"1 2\n3 4\n5 6\n", OUTLINE_ERROR_SHAPE, "no area"},
        {"0 10\n10 0\n10 10\n0 0\n", OUTLINE_ERROR_SHAPE, "blade.txt:2: what is traced from here on, 25 px²"},
        {"0 0\n1 1\n2 2\n3 3\n", OUTLINE_ERROR_SHAPE, "blade.txt:1: the margin, from here on, encloses no area"},
        {"points\n1 2\n3 4\n9 4\n", OUTLINE_ERROR_SYNTAX, "not an SVG file"},
        {"", OUTLINE_ERROR_SYNTAX, "not an SVG file"},
    };
    for (guint k = 0; k < G_N_ELEMENTS(bad); k++) {
        GError *error = NULL;
        g_assert_null(trace(bad[k].text, &error));
        if (!error || error->domain != OUTLINE_ERROR || !strstr(error->message, bad[k].part))
            g_error("'%s' does not say '%s'", error ? error->message : "", bad[k].part);
        g_assert_error(error, OUTLINE_ERROR, bad[k].code);
        g_error_free(error);
    }
}

/* Lobes traced one by one, or over one another. */
static void test_tracing_lobes(void)
{
    static const char *const text[] = {
        "0 0\n40 0\n40 80\n0 80\n\n30 40\n90 40\n90 60\n30 60\n",
        "0 0\n0 80\n40 80\n40 60\n 90 60\n90 40\n 30 40\n 30 50\n40 50\n40 0\n",
    };
    for (guint k = 0; k < G_N_ELEMENTS(text); k++) {
        GError *error = NULL;
        Polygon *p = trace(text[k], &error);
        g_assert_no_error(error);
        check_promises(p);
        g_assert_true(starts_at_base(p));
        double length2 = 40.0 * 40.0 + 80.0 * 80.0;
        g_assert_cmpfloat_with_epsilon(p->area, (40.0 * 80.0 + 50.0 * 20.0) / (90.0 * 90.0 + 60.0 * 60.0), 1e-9);
        g_assert_cmpfloat(length2, <, 90.0 * 90.0 + 60.0 * 60.0); /* the lobe's end is the tip */
        polygon_free(p);
    }
    GError *error = NULL;
    Polygon *p = trace("20 40\n90 40\n90 60\n20 60\n\n0 0\n40 0\n40 80\n0 80\n", &error); /* the first point is covered */
    g_assert_no_error(error);
    g_assert_true(polygon_contains(p, vec2(0.0, 0.0)));
    g_assert_false(starts_at_base(p));
    polygon_free(p);
}

/* Botanists' own, with lobes that overlap; against what tests/unit/references.csv's tool measured of the scan, less the petiole. */
static void test_tracing_grapes(void)
{
    static const struct {
        const char *name;
        double area;
        Vec2 base;
    } grape[] = {{"grape_301_blade.txt", 1574874, {1708, 988}}, {"grape_303_blade.txt", 922952, {1688, 952}}};
    for (guint k = 0; k < G_N_ELEMENTS(grape); k++) {
        OutlineDef def = path_def(NULL);
        char *path = real_path(grape[k].name);
        if (!path) {
            g_test_skip("this tracing is not here; VENATION_SCANS can name its folder");
            return;
        }
        def.file = path;
        Vec2 base, tip;
        GError *error = NULL;
        Polygon *p = outline_new_from(&def, &base, &tip, &error);
        g_assert_no_error(error);
        check_promises(p);
        double area = p->area * vec_dist2(base, tip);
        g_test_message("%s: %.0f pixels² in %u corners", grape[k].name, area, p->n);
        g_assert_true(base.x == grape[k].base.x && base.y == -grape[k].base.y);
        g_assert_cmpfloat(area / grape[k].area, >, 0.98);
        g_assert_cmpfloat(area / grape[k].area, <, 1.0);
        polygon_free(p);
        g_free(path);
    }
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/outline/default", test_default);
    g_test_add_func("/outline/similarity", test_similarity);
    g_test_add_func("/outline/base-tip", test_base_tip);
    g_test_add_func("/outline/mirror", test_mirror);
    g_test_add_func("/outline/teeth/straight", test_teeth);
    g_test_add_func("/outline/teeth/sum", test_teeth_sum);
    g_test_add_func("/outline/teeth/curved", test_teeth_curved);
    g_test_add_func("/outline/teeth/peltate", test_teeth_peltate);
    g_test_add_func("/outline/file", test_file);
    g_test_add_func("/outline/refused/paths", test_refused_paths);
    g_test_add_func("/outline/refused/settings", test_refused_settings);
    g_test_add_func("/outline/refused/crossing-place", test_crossing_place);
    g_test_add_func("/outline/narrow", test_narrow);
    g_test_add_func("/outline/noise", test_noise);
    g_test_add_func("/outline/tracing", test_tracing);
    g_test_add_func("/outline/tracing_refused", test_tracing_refused);
    g_test_add_func("/outline/tracing_lobes", test_tracing_lobes);
    g_test_add_func("/outline/tracing_grapes", test_tracing_grapes);
    return g_test_run();
}
