/* Curves, path data, transforms and SVG files. libm is used here alone, as an independent judge. */
#include <glib.h>
#include <glib/gstdio.h>
#include <string.h>

#include "geom/affine.h"
#include "geom/outline.h"
#include "geom/random.h"
#include "geom/svgfile.h"

#define CLOSE(a, b) g_assert_cmpfloat_with_epsilon(a, b, 1e-9)

static SvgPath *parse(const char *data)
{
    GError *error = NULL;
    SvgPath *path = svgpath_parse(data, &error);
    g_assert_no_error(error);
    return path;
}

static double area_of(const GArray *points)
{
    const Vec2 *v = &g_array_index(points, Vec2, 0);
    double twice = 0.0;
    for (guint i = 0; i < points->len; i++)
        twice += vec_cross(v[i], v[(i + 1) % points->len]);
    return 0.5 * twice;
}

static void test_sincos(void)
{
    for (int k = -4000; k <= 4000; k++) {
        double degrees = 0.37 * k, s, c;
        degrees_sincos(degrees, &s, &c);
        g_assert_cmpfloat_with_epsilon(s, sin(degrees * G_PI / 180.0), 3e-14);
        g_assert_cmpfloat_with_epsilon(c, cos(degrees * G_PI / 180.0), 3e-14);
    }
    const int exact[4][2] = {{0, 1}, {1, 0}, {0, -1}, {-1, 0}};
    for (int k = -8; k <= 8; k++) {
        double s, c;
        degrees_sincos(90.0 * k, &s, &c);
        g_assert_cmpfloat(s, ==, exact[k & 3][0]);
        g_assert_cmpfloat(c, ==, exact[k & 3][1]);
    }
    double s, c;
    degrees_sincos(INFINITY, &s, &c);
    g_assert_cmpfloat(c, ==, 1.0);
}

/* Every point of a fine sampling of the true curve is within the flatness of the chain. */
static void test_flatness(void)
{
    const Curve curves[] = {{{{0, 0}, {0, 1}, {1, 1}, {1, 0}}, false},
                            {{{0, 0}, {3, 1}, {-2, 1}, {1, 0}}, false},
                            {{{0, 0}, {1, 1}, {0, 1}, {1, 0}}, false}};
    const double flatness[] = {0.1, 1e-3, 1e-5};
    for (guint k = 0; k < G_N_ELEMENTS(curves) * G_N_ELEMENTS(flatness); k++) {
        const Curve *curve = &curves[k / 3];
        double allowed = flatness[k % 3];
        GArray *points = g_array_new(FALSE, FALSE, sizeof(Vec2));
        g_array_append_val(points, curve->p[0]);
        curve_flatten(curve, allowed, points);
        for (int i = 0; i <= 1000; i++) {
            double t = i / 1000.0, u = 1.0 - t;
            Vec2 q = vec_add(vec_add(vec_scale(curve->p[0], u * u * u), vec_scale(curve->p[1], 3 * u * u * t)),
                             vec_add(vec_scale(curve->p[2], 3 * u * t * t), vec_scale(curve->p[3], t * t * t)));
            double least = HUGE_VAL;
            for (guint j = 0; j + 1 < points->len; j++) {
                Vec2 a = g_array_index(points, Vec2, j), d = vec_sub(g_array_index(points, Vec2, j + 1), a);
                double along = CLAMP(vec_dot(vec_sub(q, a), d) / vec_norm2(d), 0.0, 1.0);
                least = MIN(least, vec_dist(q, vec_add(a, vec_scale(d, along))));
            }
            g_assert_cmpfloat(least, <=, allowed);
        }
        g_assert_cmpfloat(points->len, <, 3.0 + 4.0 / sqrt(allowed)); /* nor wastefully many */
        g_array_unref(points);
    }
}

static void test_circles(void)
{
    const char *const circles[] = {"M1 0A1 1 0 0 1-1 0A1 1 0 0 1 1 0z", "M1 0A1 1 0 1 1 .999999 -.001414213 z",
                                   "M 1 0 A 1 1 33 0 1 0 1 1 1 0 1 1 1 0",
                                   "M1 0C1 .5522847 .5522847 1 0 1S-1 .5522847-1 0-.5522847-1 0-1 1-.5522847 1 0z"};
    const double allowed[] = {2e-6, 2e-4, 2e-6, 3e-3};
    for (guint k = 0; k < G_N_ELEMENTS(circles); k++) {
        SvgPath *path = parse(circles[k]);
        GArray *points = svgpath_flatten(path, 0, 1e-7);
        g_assert_cmpfloat_with_epsilon(area_of(points), G_PI, allowed[k]);
        for (guint i = 0; k != 3 && i < points->len; i++)
            g_assert_cmpfloat_with_epsilon(sqrt(vec_norm2(g_array_index(points, Vec2, i))), 1.0, 3e-7);
        g_array_unref(points);
        svgpath_free(path);
    }
}

/* Arcs of ellipses with known centre and angles, for all flags: each flattened point satisfies the ellipse's equation
 * and lies on the right part of it. */
static void test_arcs(void)
{
    for (int k = 0; k < 400; k++) {
        double u[2], w[2], phi = 360.0 * k / 400.0, s, c;
        random_pair(4, 1, 0, k, u);
        random_pair(4, 1, 1, k, w);
        double rx = 0.2 + u[0], ry = 0.2 + u[1], from = 2 * G_PI * w[0], span = (0.02 + 1.96 * w[1]) * G_PI;
        bool sweep = k % 2, large = span > G_PI;
        double to = sweep ? from + span : from - span;
        s = sin(phi * G_PI / 180.0), c = cos(phi * G_PI / 180.0);
        Vec2 a = vec2(rx * cos(from), ry * sin(from)), b = vec2(rx * cos(to), ry * sin(to));
        Vec2 from_p = vec2(c * a.x - s * a.y + 3, s * a.x + c * a.y - 2),
             to_p = vec2(c * b.x - s * b.y + 3, s * b.x + c * b.y - 2);
        GArray *curves = g_array_new(FALSE, FALSE, sizeof(Curve)), *points = g_array_new(FALSE, FALSE, sizeof(Vec2));
        curve_arc(curves, from_p, to_p, rx, ry, phi, large, sweep);
        double turned = 0.0, last = from;
        for (guint i = 0; i < curves->len; i++)
            curve_flatten(&g_array_index(curves, Curve, i), 1e-4, points);
        for (guint i = 0; i < points->len; i++) {
            Vec2 q = vec_sub(g_array_index(points, Vec2, i), vec2(3, -2));
            double x = (c * q.x + s * q.y) / rx, y = (c * q.y - s * q.x) / ry, angle = atan2(y, x);
            g_assert_cmpfloat_with_epsilon(x * x + y * y, 1.0, 3e-6);
            turned += remainder(angle - last, 2 * G_PI);
            last = angle;
        }
        g_assert_cmpfloat_with_epsilon(turned, to - from, 1e-5);
        g_assert_cmpfloat(vec_dist(g_array_index(points, Vec2, points->len - 1), to_p), ==, 0.0);
        g_array_unref(curves);
        g_array_unref(points);
    }
}

/* Each spelling gives the corners that follow it. */
static void test_grammar(void)
{
    const struct {
        const char *data;
        guint n;
        Vec2 corner[7];
    } cases[] = {
        {"M1 2L3 4", 2, {{1, 2}, {3, 4}}},
        {" m 1,2 , 3 , 4\n5-6 ", 3, {{1, 2}, {4, 6}, {9, 0}}},
        {"M1 2 3 4 5 6z", 3, {{1, 2}, {3, 4}, {5, 6}}},
        {"M.5.5l-1-1+2+2", 3, {{0.5, 0.5}, {-0.5, -0.5}, {1.5, 1.5}}},
        {"M1e1-1E-1L1.e0,0", 2, {{10, -0.1}, {1, 0}}},
        {"M1 1H5V7h-1v-2h1 2", 7, {{1, 1}, {5, 1}, {5, 7}, {4, 7}, {4, 5}, {5, 5}, {7, 5}}},
        {"M0 0C0 0 1 1 1 1c0 0 1 1 1 1", 3, {{0, 0}, {1, 1}, {2, 2}}},
        {"M0 0Q0 0 1 1q0 0 1 1", 3, {{0, 0}, {1, 1}, {2, 2}}},
        {"M0 0A1 1 0 01 0 0 0 1 0 0 1 2 0L5 5", 3, {{0, 0}, {2, 0}, {5, 5}}}, /* no length, then a radius of 0: lines */
        {"M0 0a1,0,0,1,1,2,0", 2, {{0, 0}, {2, 0}}},
        {"M0 0a1 0 0 112 0", 2, {{0, 0}, {2, 0}}}, /* flags need no space */
        {"M9 9M0 0L1 0M5 5", 2, {{0, 0}, {1, 0}}}, /* lone moves are nothing */
    };
    for (guint k = 0; k < G_N_ELEMENTS(cases); k++) {
        SvgPath *path = parse(cases[k].data);
        g_assert_cmpuint(path->subpaths->len, ==, 1);
        GArray *points = svgpath_flatten(path, 0, 100.0);
        g_assert_cmpuint(points->len, ==, cases[k].n);
        for (guint i = 0; i < points->len; i++) {
            CLOSE(g_array_index(points, Vec2, i).x, cases[k].corner[i].x);
            CLOSE(g_array_index(points, Vec2, i).y, cases[k].corner[i].y);
        }
        g_array_unref(points);
        svgpath_free(path);
    }
}

static void check_controls(const char *data, Vec2 c1, Vec2 c2)
{
    SvgPath *path = parse(data);
    const Curve *last = &g_array_index(path->curves, Curve, path->curves->len - 1);
    CLOSE(last->p[1].x, c1.x);
    CLOSE(last->p[1].y, c1.y);
    CLOSE(last->p[2].x, c2.x);
    CLOSE(last->p[2].y, c2.y);
    svgpath_free(path);
}

static void test_smooth(void)
{
    check_controls("M0 0C0 1 1 1 1 0S3 4 2 0", vec2(1, -1), vec2(3, 4));
    check_controls("M0 0C0 1 1 1 1 0s2 4 1 0", vec2(1, -1), vec2(3, 4));
    check_controls("M0 0L1 0S3 4 2 0", vec2(1, 0), vec2(3, 4));
    check_controls("M0 0Q1 1 1 0S3 4 2 0", vec2(1, 0), vec2(3, 4)); /* of another kind: nothing to reflect */
    /* Q .5 1, reflected 1.5 -1; a cubic's controls are two thirds of the way there. */
    check_controls("M0 0Q.5 1 1 0T2 0", vec2(1 + 1 / 3.0, -2 / 3.0), vec2(2 - 1 / 3.0, -2 / 3.0));
    check_controls("M0 0Q.5 1 1 0t1 0 1 0", vec2(2 + 1 / 3.0, 2 / 3.0), vec2(3 - 1 / 3.0, 2 / 3.0));
    check_controls("M0 0C0 1 1 1 1 0T2 0", vec2(1, 0), vec2(1 + 1 / 3.0, 0));
}

static void test_subpaths(void)
{
    SvgPath *path = parse("M0 0L1 0 1 1zL2 2m1 1l1 1z m3 3");
    g_assert_cmpuint(path->subpaths->len, ==, 3);
    g_assert_true(g_array_index(path->subpaths, Subpath, 0).closed);
    g_assert_false(g_array_index(path->subpaths, Subpath, 1).closed);
    g_assert_true(g_array_index(path->subpaths, Subpath, 2).closed);
    const Curve *after = &g_array_index(path->curves, Curve, 2); /* begins where the closed one began */
    CLOSE(after->p[0].x, 0.0);
    CLOSE(after->p[3].x, 2.0);
    CLOSE(g_array_index(path->curves, Curve, 3).p[3].x, 4.0);
    svgpath_free(path);
    path = parse(" \n");
    g_assert_cmpuint(path->curves->len, ==, 0);
    svgpath_free(path);
}

static void test_path_errors(void)
{
    const char *const cases[][2] = {
        {"M 0 0 L 10 10 L q", "at character 17: expected a number, found 'q'"},
        {"L 1 1", "at character 1: expected M, which begins a path, found 'L'"},
        {"M 0 0 X 1", "at character 7: expected a path command, found 'X'"},
        {"M 0 0 L 1", "at character 10: expected a number, found the end"},
        {"M 0 0 L 1 1,", "at character 13: expected a number, found the end"},
        {"M 0,,0", "at character 5: expected a number, found ','"},
        {"M 0 0 z 1 1", "at character 9: expected a path command, found '1'"},
        {"M 0 0 A 1 1 0 2 0 1 1", "at character 15: expected a flag (0 or 1), found '2'"},
        {"M nan 0", "at character 3: expected a number, found 'n'"},
        {"M 0 inf", "at character 5: expected a number, found 'i'"},
        {"M 0x10 0", "at character 4: expected a number, found 'x'"},
        {"M 1e999 0", "at character 3: the number 1e999 is too large"},
        {"M 0 -1e61", "at character 5: the number -1e61 is too large"},
        {"M 0 . L", "at character 5: expected a number, found '.'"},
        {"M 0 \xC3\xA9 1", "at character 5: expected a number, found '\xC3\xA9'"},
        {"M \xC3\xA9\xC3\xA9", "at character 3: expected a number, found '\xC3\xA9'"},
        {"M \xFF", "at character 3: expected a number, found byte 0xff"},
        {"M 0 0\x01", "at character 6: expected a path command, found byte 0x01"},
        {"M 0 0 L 1 1 # 2", "at character 13: expected a path command, found '#'"},
    };
    for (guint k = 0; k < G_N_ELEMENTS(cases); k++) {
        GError *error = NULL;
        g_assert_null(svgpath_parse(cases[k][0], &error));
        g_assert_error(error, OUTLINE_ERROR, OUTLINE_ERROR_SYNTAX);
        g_assert_cmpstr(error->message, ==, cases[k][1]);
        g_error_free(error);
    }
}

static void test_transforms(void)
{
    const struct {
        const char *text;
        Vec2 image; /* of (2, 1) */
    } cases[] = {
        {"", {2, 1}},
        {"translate(10)", {12, 1}},
        {" translate ( 10 , -3 ) ", {12, -2}},
        {"scale(2)", {4, 2}},
        {"scale(2,-1)", {4, -1}},
        {"rotate(90)", {-1, 2}},
        {"rotate(90 1 1)", {1, 2}},
        {"rotate(-450)", {1, -2}},
        {"matrix(1 2 3 4 5 6)", {10, 14}},
        {"skewX(45)", {3, 1}},
        {"skewY(45)", {2, 3}},
        {"translate(10,0)scale(2)", {14, 2}},
        {"scale(2), translate(10,0)", {24, 2}},
    };
    for (guint k = 0; k < G_N_ELEMENTS(cases); k++) {
        Affine m;
        GError *error = NULL;
        g_assert_true(affine_parse(cases[k].text, &m, &error));
        Vec2 q = affine_apply(&m, vec2(2, 1));
        CLOSE(q.x, cases[k].image.x);
        CLOSE(q.y, cases[k].image.y);
    }
    const char *const bad[] = {"turn(3)", "scale 2", "scale(2", "scale()", "scale(1,2,3)", "matrix(1 2 3 4 5)",
                               "matrix(1 2 3 4 5 6 7)", "rotate(1 2)", "translate(q)", "scale(2))"};
    for (guint k = 0; k < G_N_ELEMENTS(bad); k++) {
        Affine m;
        GError *error = NULL;
        g_assert_false(affine_parse(bad[k], &m, &error));
        g_assert_error(error, OUTLINE_ERROR, OUTLINE_ERROR_SYNTAX);
        g_error_free(error);
    }
}

/* --- files --- */

#define INKSCAPE                                                                                                       \
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- a drawing -->\n<!DOCTYPE svg PUBLIC \"-//W3C//DTD SVG "          \
    "1.1//EN\" "                                                                                                       \
    "\"http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd\">\n<svg xmlns=\"http://www.w3.org/2000/svg\" "                \
    "xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" xmlns:sodipodi=\"http://sodipodi.sf.net/d.dtd\" "  \
    "viewBox=\"0 0 50 50\" width=\"100mm\">\n"

static bool read_text(const char *text, SvgShape *shape, GError **error)
{
    char *name;
    GError *trouble = NULL;
    int file = g_file_open_tmp("venation-XXXXXX.svg", &name, &trouble);
    g_assert_no_error(trouble);
    g_close(file, NULL);
    g_file_set_contents(name, text, -1, &trouble);
    g_assert_no_error(trouble);
    bool good = svgfile_read(name, shape, error);
    if (!good) /* every complaint names the file */
        g_assert_nonnull(strstr((*error)->message, name));
    g_unlink(name);
    g_free(name);
    return good;
}

static void check_file(const char *text, Vec2 first, Vec2 second)
{
    SvgShape shape = {0};
    GError *error = NULL;
    read_text(text, &shape, &error);
    g_assert_no_error(error);
    const Curve *curve = &g_array_index(shape.path->curves, Curve, 0);
    CLOSE(curve->p[0].x, first.x);
    CLOSE(curve->p[0].y, first.y);
    CLOSE(curve->p[3].x, second.x);
    CLOSE(curve->p[3].y, second.y);
    svgshape_clear(&shape);
}

static void test_files(void)
{
    check_file("<svg><path id='outline' d='M1 2 3 4'/></svg>", vec2(1, -2), vec2(3, -4));
    check_file("\xEF\xBB\xBF<svg><path id='outline' d='M1 2 3 4'/></svg>", vec2(1, -2), vec2(3, -4));
    check_file("<svg:svg xmlns:svg='x'><svg:g><svg:path id='outline' d='M1 2 3 4'/></svg:g></svg:svg>", vec2(1, -2),
               vec2(3, -4));
    /* Namespaced attributes and elements are none of ours. */
    check_file(INKSCAPE
               "<sodipodi:namedview id='base' transform='?'/><inkscape:path id='outline' d='?'/>"
               "<g inkscape:transform='?' transform='translate(10,20)'><path id='outline' inkscape:original-d='?' "
               "transform='scale(2)' d='M1 2 3 4'/></g></svg>",
               vec2(12, -24), vec2(16, -28));
    /* The transform of a closed group is forgotten. */
    check_file("<svg><g transform='scale(9)'><g transform='rotate(45)'/></g><path id='outline' d='M1 2 3 4'/></svg>",
               vec2(1, -2), vec2(3, -4));
    /* No outline: the largest closed path as drawn, whatever it is called; open, defined-only and broken ones don't
     * count. */
    check_file("<svg><path d='M0 0 1 0 1 1z'/><path d='M7 8 9 8 9 10z'/><path d='M0 0 100 0 100 100'/><path d='q'/>"
               "<defs><path d='M0 0 100 0 100 100z'/></defs><path d='M0 0 1 0 0 1z'/></svg>",
               vec2(7, -8), vec2(9, -8));
    check_file("<svg><path d='M0 0 4 0 4 4z'/><path transform='scale(10)' d='M7 8 8 8 8 9z'/></svg>", vec2(70, -80),
               vec2(80, -80));
    check_file("<svg><path d='M0 0 4 0 4 4 0 0'/><path d='M0 0 1 0 1 1z'/></svg>", vec2(0, 0), vec2(4, 0));
}

/* The margin of a file with one shape in it, its points in the order they are drawn; y up. */
static void check_corners(const char *body, guint n, const Vec2 *corner)
{
    char *text = g_strdup_printf("<svg>%s</svg>", body);
    SvgShape shape = {0};
    GError *error = NULL;
    read_text(text, &shape, &error);
    g_assert_no_error(error);
    GArray *points = svgpath_flatten(shape.path, 0, 100.0);
    g_assert_cmpuint(points->len, ==, n);
    for (guint i = 0; i < n; i++) {
        CLOSE(g_array_index(points, Vec2, i).x, corner[i].x);
        CLOSE(g_array_index(points, Vec2, i).y, corner[i].y);
    }
    g_array_unref(points);
    svgshape_clear(&shape);
    g_free(text);
}

static void check_area(const char *body, double area, Vec2 first)
{
    char *text = g_strdup_printf("<svg>%s</svg>", body);
    SvgShape shape = {0};
    GError *error = NULL;
    read_text(text, &shape, &error);
    g_assert_no_error(error);
    g_assert_true(g_array_index(shape.path->subpaths, Subpath, 0).closed);
    GArray *points = svgpath_flatten(shape.path, 0, 1e-6);
    g_assert_cmpfloat_with_epsilon(fabs(area_of(points)), area, 1e-4 * area);
    CLOSE(g_array_index(points, Vec2, 0).x, first.x);
    CLOSE(g_array_index(points, Vec2, 0).y, first.y);
    g_array_unref(points);
    svgshape_clear(&shape);
    g_free(text);
}

static void test_shapes(void)
{
    check_corners("<polygon points='1,2 3,4 5-6'/>", 3, (Vec2[]){{1, -2}, {3, -4}, {5, 6}});
    check_corners("<polyline id='outline' points=' 1 2, 3 4\n5 6 '/>", 3, (Vec2[]){{1, -2}, {3, -4}, {5, -6}});
    check_corners("<rect x='1' y='2' width='3' height='4px' transform='translate(10)'/>", 5,
                  (Vec2[]){{11, -2}, {14, -2}, {14, -6}, {11, -6}, {11, -2}});
    check_area("<rect x='1' y='2' width='3' height='4' rx='0.5'/>", 12 - (4 - G_PI) * 0.25, vec2(1.5, -2));
    check_area("<rect x='1' y='2' width='3' height='4' rx='0.5' ry='1'/>", 12 - (4 - G_PI) * 0.5, vec2(1.5, -2));
    check_area("<rect width='2' height='4' rx='9' ry='9'/>", G_PI * 2, vec2(1, 0)); /* held to half the sides: an ellipse */
    check_area("<circle cx='3' cy='4' r='2'/>", G_PI * 4, vec2(3, -6));
    check_area("<ellipse id='outline' cx='3' cy='4' rx='1' ry='5' transform='scale(2)'/>", G_PI * 20, vec2(6, -18));
}

/* Which of several shapes is the margin: an id, a label, the largest path or polygon, the largest of the rest. */
static void test_names(void)
{
    const char *page = "<rect x='7' width='100' height='100'/>", *labelled = "<path inkscape:label='outline' id='p1' d='M1 2 3 4'/>",
               *named = "<polygon id='outline' points='5 6 7 8 9 0'/>", *large = "<path d='M8 8 9 8 9 9z'/>",
               *layer = "<g id='layer1' inkscape:groupmode='layer' inkscape:label='outline'><g inkscape:label='base'/></g>",
               *mark = "<circle inkscape:label='base' cx='1' cy='2' r='900'/>";
    const struct {
        const char *body[4];
        double first_x;
    } cases[] = {
        {{page, large, labelled, named}, 5},  {{named, labelled, large, page}, 5}, {{large, labelled, page, layer}, 1},
        {{labelled, large, layer, page}, 1},  {{page, large, layer, mark}, 8},     {{large, page, layer, mark}, 8},
        {{layer, page, mark, "<circle cx='9' cy='9' r='1'/>"}, 7},
    };
    for (guint k = 0; k < G_N_ELEMENTS(cases); k++) {
        const char *const *b = cases[k].body;
        char *text = g_strconcat(INKSCAPE, b[0], b[1], b[2], b[3], "</svg>", NULL);
        SvgShape shape = {0};
        GError *error = NULL;
        read_text(text, &shape, &error);
        g_assert_no_error(error);
        CLOSE(g_array_index(shape.path->curves, Curve, 0).p[0].x, cases[k].first_x);
        g_assert_true(shape.has_base == (strstr(text, "r='900'") != NULL));
        if (shape.has_base)
            CLOSE(shape.base.y, -2.0);
        svgshape_clear(&shape);
        g_free(text);
    }
}

static void test_marks(void)
{
    SvgShape shape = {0};
    GError *error = NULL;
    read_text(INKSCAPE
              "<circle id='base' cx='1' cy='2px' r='3'/><g transform='translate(5 5)'><ellipse id='tip' cx='1'/></g>"
              "<path id='outline' d='M1 2 3 4'/></svg>",
              &shape, &error);
    g_assert_no_error(error);
    g_assert_true(shape.has_base && shape.has_tip);
    CLOSE(shape.base.x, 1.0);
    CLOSE(shape.base.y, -2.0);
    CLOSE(shape.tip.x, 6.0);
    CLOSE(shape.tip.y, -5.0);
    svgshape_clear(&shape);
}

static void test_file_errors(void)
{
    const struct {
        const char *text, *part;
        OutlineError code;
    } cases[] = {
        {"", "not an SVG file", OUTLINE_ERROR_SYNTAX},
        {"leaf", "not an SVG file", OUTLINE_ERROR_SYNTAX},
        {"<html/>", "it begins with <html>", OUTLINE_ERROR_SYNTAX},
        {"<svg><path></svg>", "not an SVG file", OUTLINE_ERROR_SYNTAX},
        {"<svg/>", "neither a path with id", OUTLINE_ERROR_SHAPE},
        {"<svg><path d='M0 0 1 1 2 0'/></svg>", "neither a path with id", OUTLINE_ERROR_SHAPE},
        {"<svg>\n<path id='outline' d='M0 q'/></svg>", "line 2: <path id=\"outline\">: at character 4",
         OUTLINE_ERROR_SYNTAX},
        {"<svg><path id='p7' d='M0 q'/></svg>", "<path id=\"p7\">: at character 4", OUTLINE_ERROR_SYNTAX},
        {"<svg><g id='outline'/></svg>", "Object > Ungroup, Path > Object to Path", OUTLINE_ERROR_SYNTAX},
        {"<svg><text id='t' inkscape:label='outline'/></svg>",
         "<text inkscape:label=\"outline\">: the outline must be a path or a simple shape (in Inkscape: Path > Object to Path)",
         OUTLINE_ERROR_SYNTAX},
        {"<svg><text>leaf</text></svg>", "Path > Object to Path", OUTLINE_ERROR_SHAPE},
        {"<svg><path id='p2' inkscape:label='tip' d='M0 0 1 1'/></svg>", "<path inkscape:label=\"tip\">: the tip must be marked",
         OUTLINE_ERROR_SYNTAX},
        {"<svg><polygon id='outline' points='1 2 3'/></svg>", "at character 6: expected a number, found the end", OUTLINE_ERROR_SYNTAX},
        {"<svg><rect id='outline' width='50%'/></svg>", "<rect id=\"outline\">: width: at character 3", OUTLINE_ERROR_SYNTAX},
        {"<svg><rect id='base'/></svg>", "the base must be marked by a circle", OUTLINE_ERROR_SYNTAX},
        {"<svg><circle id='tip' cx='1mm'/></svg>", "a number in user units, found 'm'", OUTLINE_ERROR_SYNTAX},
        {"<svg><g transform='turn(1)'/></svg>", "<g>, transform: at character 1", OUTLINE_ERROR_SYNTAX},
        {"<svg><path id='outline' transform='scale(1e40)' d='M0 0 1e40 0'/></svg>", "too large", OUTLINE_ERROR_SYNTAX},
        {"<svg><path id='outline' transform='skewX(90)' d='M0 0 1 1'/></svg>", "too large", OUTLINE_ERROR_SYNTAX},
        {"<svg><path d='\xFF'/></svg>", "not an SVG file", OUTLINE_ERROR_SYNTAX},
    };
    for (guint k = 0; k < G_N_ELEMENTS(cases); k++) {
        SvgShape shape = {0};
        GError *error = NULL;
        g_assert_false(read_text(cases[k].text, &shape, &error));
        g_assert_error(error, OUTLINE_ERROR, (int)cases[k].code);
        if (!strstr(error->message, cases[k].part))
            g_error("'%s' does not say '%s'", error->message, cases[k].part);
        g_error_free(error);
    }
    SvgShape shape;
    GError *error = NULL;
    g_assert_false(svgfile_read("/no/such/file.svg", &shape, &error));
    g_assert_error(error, OUTLINE_ERROR, OUTLINE_ERROR_READ);
    g_assert_nonnull(strstr(error->message, "/no/such/file.svg"));
    g_clear_error(&error);
    g_assert_false(svgfile_read("/", &shape, &error));
    g_assert_error(error, OUTLINE_ERROR, OUTLINE_ERROR_READ);
    g_error_free(error);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/svg/sincos", test_sincos);
    g_test_add_func("/svg/flatness", test_flatness);
    g_test_add_func("/svg/circles", test_circles);
    g_test_add_func("/svg/arcs", test_arcs);
    g_test_add_func("/svg/path/grammar", test_grammar);
    g_test_add_func("/svg/path/smooth", test_smooth);
    g_test_add_func("/svg/path/subpaths", test_subpaths);
    g_test_add_func("/svg/path/errors", test_path_errors);
    g_test_add_func("/svg/transforms", test_transforms);
    g_test_add_func("/svg/files", test_files);
    g_test_add_func("/svg/shapes", test_shapes);
    g_test_add_func("/svg/names", test_names);
    g_test_add_func("/svg/marks", test_marks);
    g_test_add_func("/svg/file-errors", test_file_errors);
    return g_test_run();
}
