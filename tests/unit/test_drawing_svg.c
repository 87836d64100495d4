/* Veins drawn in Inkscape, read back from small files such as it writes; and from broken ones. */
#include <glib.h>
#include <glib/gstdio.h>
#include <string.h>

#include "geom/random.h"
#include "geom/svgfile.h"
#include "import/drawing_file.h"

#define HEAD \
    "<?xml version=\"1.0\" encoding=\"UTF-8\" standalone=\"no\"?>\n<!DOCTYPE svg [ <!ENTITY ns \"http://ns\"> ]>\n" \
    "<svg xmlns:x=\"&ns;\" width=\"210mm\" height=\"297mm\" viewBox=\"0 0 210 297\" xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" xmlns=\"http://www.w3.org/2000/svg\">\n" \
    "<sodipodi:namedview id=\"namedview7\" inkscape:current-layer=\"layer2\"/>\n<defs id=\"defs2\"><path id=\"arrow\" d=\"M 0,0 5,5\"/></defs>\n"

static Drawing *read_bytes(const char *text, gsize length, GError **error)
{
    char *name;
    GError *trouble = NULL;
    int file = g_file_open_tmp("venation-XXXXXX.svg", &name, &trouble);
    g_assert_no_error(trouble);
    g_close(file, NULL);
    g_file_set_contents_full(name, text, (gssize)length, G_FILE_SET_CONTENTS_NONE, 0600, &trouble);
    g_assert_no_error(trouble);
    Drawing *d = drawing_read_svg(name, 0.01, NULL, error);
    if (!d) /* every complaint names the file */
        g_assert_nonnull(strstr((*error)->message, name));
    g_unlink(name);
    g_free(name);
    return d;
}

static Drawing *read_text(const char *text)
{
    GError *error = NULL;
    Drawing *d = read_bytes(text, strlen(text), &error);
    g_assert_no_error(error);
    return d;
}

#define NEAR(a, b) g_assert_cmpfloat(fabs((a) - (b)), <, 1e-9)

static void check_ends(const DrawnVein *v, double x0, double y0, double x1, double y1)
{
    NEAR(v->point[0].x, x0);
    NEAR(v->point[0].y, y0);
    NEAR(v->point[v->n - 1].x, x1);
    NEAR(v->point[v->n - 1].y, y1);
}

static void check_vein(const DrawnVein *v, const char *name, uint8_t order, double width)
{
    g_assert_cmpstr(v->name, ==, name);
    g_assert_cmpuint(v->order, ==, order);
    for (uint32_t i = 0; i < v->n; i++)
        NEAR(v->width[i], width);
}

/* As one draws it: a scan, an outline, a layer of veins with groups an order in it. */
static const char inkscape[] = HEAD
    "<g inkscape:groupmode=\"layer\" id=\"layer1\" inkscape:label=\"scan\"><image width=\"210\" height=\"297\" xlink:href=\"leaf.jpg\"/>\n"
    "<path style=\"fill:none\" d=\"M 1,1 9,9\" id=\"scratch\"/></g>\n"
    "<g inkscape:groupmode=\"layer\" id=\"layer2\" inkscape:label=\"Veins\" transform=\"translate(10,20)\"\n"
    "   style=\"display:inline;fill:none;stroke:#000000;stroke-width:0.5\">\n"
    "  <path style=\"fill:none;stroke:#000;stroke-width:2.5px;stroke-opacity:1\" d=\"m 0,100 c 0,-30 5,-60 0,-90\" id=\"path10\" inkscape:label=\"midrib\"/>\n"
    "  <g id=\"g20\" inkscape:label=\"Secondary veins\" transform=\"scale(2)\">\n"
    "    <path d=\"M 0,40 10,35\" id=\"path21\"/>\n"
    "    <g id=\"g22\" style=\"stroke-width:1\"><polyline points=\"0,30 10,25 12,20\" id=\"path22\"/></g>\n"
    "    <line x1=\"0\" y1=\"20\" x2=\"-10\" y2=\"15\" id=\"tertiary-4\" stroke-width=\"3\"/>\n"
    "    <path d=\"M 1,2 3,4\" id=\"gone\" style=\"display:none\"/>\n"
    "  </g>\n"
    "  <g id=\"g30\" inkscape:label=\"order 4\" transform=\"matrix(0,1,-1,0,0,0)\"><path d=\"M 1,2 3,4 M 5,6 7,8 9,9\" id=\"double\"/></g>\n"
    "  <g style=\"display:none\"><g><path d=\"M 1,2 3,4\" style=\"display:inline\"/></g></g>\n"
    "  <path d=\"M 5,5 6,6 7,5 Z\" id=\"ring\"/><circle cx=\"3\" cy=\"3\" r=\"2\" id=\"dot\"/>\n"
    "</g>\n"
    "<g inkscape:label=\"outline\" id=\"layer3\"><path id=\"outline\" d=\"M 0,0 100,0 100,200 0,200\"/></g>\n"
    "<circle id=\"base\" cx=\"10\" cy=\"120\" r=\"1\"/></svg>\n";

static void test_inkscape(void)
{
    Drawing *d = read_text(inkscape);
    g_assert_cmpuint(d->n, ==, 6);
    check_vein(&d->vein[0], "path 'midrib'", 1, 2.5);
    check_ends(&d->vein[0], 10, -120, 10, -30);
    g_assert_cmpuint(d->vein[0].n, >, 4);
    check_vein(&d->vein[1], "path 'path21'", 2, 1.0); /* inherited, times the group's scale */
    check_ends(&d->vein[1], 10, -100, 30, -90);
    check_vein(&d->vein[2], "polyline 'path22'", 2, 2.0);
    g_assert_cmpuint(d->vein[2].n, ==, 3);
    check_vein(&d->vein[3], "line 'tertiary-4'", 3, 6.0);
    check_ends(&d->vein[3], 10, -60, -10, -50);
    check_vein(&d->vein[4], "path 'double'", 4, 0.5);
    check_ends(&d->vein[4], 8, -21, 6, -23); /* a quarter turn */
    check_vein(&d->vein[5], "path 'double'", 4, 0.5);
    g_assert_cmpuint(d->vein[5].n, ==, 3);
    drawing_free(d);
}

/* Curves stay within the flatness. */
static void test_flatness(void)
{
    Drawing *d = read_text("<svg><path d='M0 0 C 0 50 100 50 100 0' transform='scale(3)'/></svg>");
    const DrawnVein *v = &d->vein[0];
    g_assert_cmpuint(v->n, >, 20);
    g_assert_cmpuint(v->n, <, 200);
    for (int k = 0; k <= 1000; k++) {
        double t = k / 1000.0, u = 1 - t, least = HUGE_VAL;
        Vec2 p = vec2(3 * (300 * u * t * t + 100 * t * t * t), -3 * (150 * u * u * t + 150 * u * t * t));
        for (uint32_t i = 1; i < v->n; i++) {
            Vec2 a = v->point[i - 1], ab = vec_sub(v->point[i], a);
            double along = CLAMP(vec_dot(vec_sub(p, a), ab) / vec_norm2(ab), 0, 1);
            least = MIN(least, vec_dist(p, vec_add(a, vec_scale(ab, along))));
        }
        g_assert_cmpfloat(least, <=, 0.01);
    }
    drawing_free(d);
}

static void check_order(const char *name, uint8_t order)
{
    for (int where = 0; where < 3; where++) {
        char *text = g_strdup_printf(where == 0   ? "<svg><g><path %s='%s' d='M0 0 1 1'/></g></svg>"
                                     : where == 1 ? "<svg><g %s='%s'><g><path d='M0 0 1 1'/></g></g></svg>"
                                                  : "<svg><g id='order-9'><g id='x' %s='%s'><path id='y' d='M0 0 1 1'/></g></g></svg>",
                                     where ? "inkscape:label" : "id", name);
        Drawing *d = read_text(text);
        g_assert_cmpuint(d->vein[0].order, ==, where == 2 && order == 0 ? 9 : order);
        drawing_free(d);
        g_free(text);
    }
}

static void test_orders(void)
{
    const struct {
        const char *name;
        uint8_t order;
    } is[] = {{"primary", 1}, {"Primaries", 1}, {"secondary-7", 2}, {"SECONDARIES", 2}, {"left secondary 12", 2}, {"secondary_1", 2},
              {"tertiary2", 3}, {"tertiaries", 3}, {"quaternary", 4}, {"quaternaries", 4}, {"order-2", 2}, {"order 5", 5}, {"Order3", 3},
              {"order_6", 6}, {"vein order: 7", 7}, {"2nd", 2}, {"1st order", 1}, {"3rd", 3}, {"4TH", 4}, {"order-250", 250},
              {"midrib", 1}, {"layer2", 0}, {"path2nd", 0}, {"2ndary", 0}, {"secondaryish", 0}, {"presecondary", 0}, {"order", 0},
              {"order-0", 0}, {"order-251", 0}, {"order-99999999999999", 0}, {"border-2", 0}, {"0th", 0}, {"12", 0}, {"nd", 0},
              {"önd 2", 0}, {"ésecondary", 0}, {"secondaryé", 0}};
    for (gsize k = 0; k < G_N_ELEMENTS(is); k++)
        check_order(is[k].name, is[k].order);
}

static void check_all(const char *text, guint n, const uint8_t *order, const double *width)
{
    Drawing *d = read_text(text);
    g_assert_cmpuint(d->n, ==, n);
    for (guint k = 0; k < n; k++) {
        g_assert_cmpuint(d->vein[k].order, ==, order ? order[k] : 0);
        NEAR(d->vein[k].width[0], width ? width[k] : 0.0);
    }
    drawing_free(d);
}

#define ALL(text, n, ...) check_all(text, n, (const uint8_t[]){__VA_ARGS__}, NULL)
#define WIDE(text, n, ...) check_all(text, n, NULL, (const double[]){__VA_ARGS__})
#define P "<path d='M0 0 1 1'/>"

static void test_nesting(void)
{
    ALL("<svg><g id='veins'>" P "<g>" P "<g>" P "</g></g>" P "</g></svg>", 4, 1, 2, 3, 1);
    ALL("<svg><g id='layer'><g inkscape:label='veins'><g><g>" P "</g></g></g></g></svg>", 1, 3);
    ALL("<svg><g id='veins'>" P P "</g></svg>", 2, 0, 0);                                     /* no nesting */
    ALL("<svg><g>" P "<g>" P "</g></g></svg>", 2, 0, 0);                                      /* not in "veins" */
    ALL("<svg><g id='veins'>" P "<g id='secondary'>" P "</g><g>" P "</g></g></svg>", 3, 0, 2, 0); /* names say it */
    ALL("<svg><g id='2nd'><g id='veins'>" P "</g></g></svg>", 1, 2);
}

static void test_which(void)
{
    ALL("<svg>" P "<g id='other'>" P "</g><g id='veins'>" P "</g>" P "</svg>", 1, 0);
    ALL("<svg><g id='veins'>" P "</g><g inkscape:label='VEINS'>" P "</g></svg>", 2, 0, 0);
    ALL("<svg><path id='veins' d='M0 0 1 1'/>" P "</svg>", 2, 0, 0);          /* no group */
    ALL("<svg><defs><g id='veins'>" P "</g></defs>" P "</svg>", 1, 0);       /* defined only */
    ALL("<svg><symbol>" P "</symbol><path id='outline' d='M0 0 1 1'/><path inkscape:label='outline' d='M0 0 1 1'/>" P "</svg>", 1, 0);
    ALL("<svg><path d='M0 0 4 0 4 4 0 0'/><path d='M0 0 4 0 4 4z'/>" P "</svg>", 1, 0); /* closed */
    ALL("<svg><g id='veins'><path d='M0 0 4 0 4 4 0 0'/></g></svg>", 1, 0);            /* a ring among veins */
    ALL("<svg><path d='M1 1'/><path d=''/><path/><polyline/>" P "</svg>", 1, 0);
    ALL("<svg><path d='M0 0 1 0 1 1z m 3 3 1 1'/></svg>", 1, 0); /* its open part */
    ALL("<svg><path d='?'/><g id='veins'>" P "</g></svg>", 1, 0); /* a fault elsewhere */
    ALL("<svg><g id='veins'>" P "</g><path d='?'/></svg>", 1, 0);
    ALL("<svg><path display='none' d='M0 0 1 1'/><g style='fill:red ; display : none !important'>" P "</g><g display='none' style='display:inline'>" P
        "</g></svg>", 1, 0);
    ALL("<svg:svg xmlns:svg='x'><svg:path d='M0 0 1 1'/><other:path d='M0 0 1 1'/></svg:svg>", 1, 0);
}

static void test_widths(void)
{
    WIDE("<svg>" P "</svg>", 1, 0);
    WIDE("<svg><path d='M0 0 1 1' stroke-width='3'/><path d='M0 0 1 1' stroke-width='3' style='stroke-width:4'/></svg>", 2, 3, 4);
    WIDE("<svg style='stroke-width:7'>" P "<g stroke-width='2'>" P "<g><path d='M0 0 1 1' style='stroke:#000'/></g></g>" P "</svg>", 4, 7, 2, 2, 7);
    WIDE("<svg><path d='M0 0 1 1' style='stroke-width:1;stroke-width: 5px ;'/></svg>", 1, 5);
    WIDE("<svg><path d='M0 0 1 1' stroke-width='1mm'/><path d='M0 0 1 1' stroke-width='1in'/><path d='M0 0 1 1' stroke-width='3pt'/></svg>", 3,
         96 / 25.4, 96, 4);
    WIDE("<svg stroke-width='2'><path d='M0 0 1 1' stroke-width='1%'/><path d='M0 0 1 1' stroke-width='-1'/><path d='M0 0 1 1' "
         "style='stroke-width:inherit'/><path d='M0 0 1 1' style='stroke-width'/></svg>", 4, 2, 2, 2, 2);
    WIDE("<svg><g transform='scale(4,1)'><path transform='rotate(30) scale(-2)' stroke-width='3' d='M0 0 1 1'/></g></svg>", 1, 12);
    WIDE("<svg><path transform='scale(0,1)' stroke-width='3' d='M0 0 1 1'/></svg>", 1, 0);
}

static void check_error(const char *text, ImportErrorCode code, const char *says);

/* As Illustrator and Inkscape write styles of several elements at once. */
static void test_sheets(void)
{
    WIDE("<svg><style>.a{stroke-width:3} .b { stroke-width : 4px ; fill:none }</style><path class='a' d='M0 0 1 1'/><path class='x b' d='M0 0 1 1'/>"
         "<path class='ab' d='M0 0 1 1'/></svg>", 3, 3, 4, 0);
    WIDE("<svg><path class='a' d='M0 0 1 1'/><defs><style type='text/css'><![CDATA[ .a{stroke-width:3;} ]]></style></defs></svg>", 1, 3);
    WIDE("<svg><style>/* .p{stroke-width:9} */ @import url(x); @media print { path { stroke-width: 8 } } .st0,\n.st1{stroke-width:2}</style>"
         "<g class='st1'>" P "</g><g stroke-width='1'><path class='st0' d='M0 0 1 1'/></g></svg>", 2, 2, 2);
    /* ids before classes before names; style attributes before all, attributes after all; the last of equals; !important */
    WIDE("<svg><style>#q{stroke-width:5} path.a{stroke-width:4} .a{stroke-width:3} path{stroke-width:2} *{stroke-width:1} .a.b{stroke-width:6}</style>"
         "<path id='q' class='a' d='M0 0 1 1' stroke-width='9'/><path class='a' d='M0 0 1 1'/>" P "<line x2='1'/><path class='b a' d='M0 0 1 1'/>"
         "<path class='a' style='stroke-width:7' d='M0 0 1 1'/></svg>", 6, 5, 4, 2, 1, 6, 7);
    WIDE("<svg><style>.a{stroke-width:3 !important} .a{stroke-width:4}.c{stroke-width:1}.c{stroke-width:2}</style>"
         "<path class='a' style='stroke-width:7' d='M0 0 1 1'/><path class='a' style='stroke-width:7!important' d='M0 0 1 1'/><path class='c' d='M0 0 1 1'/></svg>",
         3, 3, 7, 2);
    WIDE("<svg><style>g > path, path:hover, path[id], g path {stroke-width:3} } { ; .a</style><g>" P "</g></svg>", 1, 0); /* not read */
    WIDE("<svg><style>.a{stroke-width:3</style><path class='a' d='M0 0 1 1'/></svg>", 1, 3);
    ALL("<svg><style>.off{display:none}</style><g class='off'>" P "</g><path class='off' d='M0 0 1 1'/>" P "</svg>", 1, 0);
    /* visibility is inherited, and may be taken back; display is not */
    ALL("<svg><g visibility='hidden'>" P "<path style='visibility:visible' d='M0 0 1 1'/></g></svg>", 1, 0);
    ALL("<svg><style>.h{visibility:collapse}</style><g style='visibility:hidden'><g style='visibility:inherit'>" P "</g></g><path class='h' d='M0 0 1 1'/>" P
        "</svg>", 1, 0);
    ALL("<svg><g display='none'><path style='visibility:visible;display:inline' d='M0 0 1 1'/></g>" P "</svg>", 1, 0);
}

/* A layer in which nothing is drawn says that there are no veins. */
static void test_empty(void)
{
    ALL("<svg><g id='veins'/></svg>", 0, 0);
    ALL("<svg>" P "<g inkscape:label='Veins'><g id='primary'><title>none</title></g></g></svg>", 0, 0);
    ALL("<svg><g id='veins'><path d=''/></g></svg>", 0, 0);
}

/* Illustrator declares its namespaces as entities. */
static void test_entities(void)
{
#define DOCTYPE "<!DOCTYPE svg PUBLIC \"-//W3C//DTD SVG 1.1//EN\" \"svg11.dtd\" [\n <!ENTITY ns_ai \"http://ns.adobe.com/ai/\">\n" \
    "<!ENTITY w '3'><!ENTITY w '4'> <!ENTITY loop \"&loop;\"><!ENTITY many \"&w;&w;\"> <!ENTITY % p \"x\"> ]>\n"
    WIDE(DOCTYPE "<svg xmlns:i='&ns_ai;'><path d='M0 0 1 1' stroke-width='&w;' id='a&amp;b'/></svg>", 1, 3);
    WIDE("<!DOCTYPE svg>\n<svg><path d='M0 0 1 1' id='[x]' stroke-width='2'/></svg>", 1, 2);
    check_error(DOCTYPE "<svg id='&loop;'/>", IMPORT_ERROR_SYNTAX, "loop");
    check_error(DOCTYPE "<svg id='&many;'/>", IMPORT_ERROR_SYNTAX, "many");
    check_error(DOCTYPE "<svg>\n<g id='veins'><path d='M0 0 &w; q'/></g></svg>", IMPORT_ERROR_SYNTAX, "line 5");
    check_error("<!DOCTYPE svg [ <!ENTITY w '3'>", IMPORT_ERROR_SYNTAX, "not an SVG file");
    check_error("<!DOCTYPE svg [ <!ENTITY w ", IMPORT_ERROR_SYNTAX, "not an SVG file");
}

static Vec2 origin_of(const char *inner)
{
    char *text = g_strdup_printf("<svg><g transform='translate(7,3)'>%s</g></svg>", inner);
    Drawing *d = read_text(text);
    g_assert_cmpuint(d->n, ==, 1);
    Vec2 p = d->vein[0].point[0];
    drawing_free(d);
    g_free(text);
    return p;
}

/* A drawing in the drawing has a place and a scale of its own. */
static void test_inner(void)
{
    Vec2 a = origin_of("<svg x='10' y='20' width='40' height='30' viewBox='5 5 10 10'><path d='M5 5 6 6'/></svg>"); /* meet: 30 × 30 in the middle */
    NEAR(a.x, 7 + 15);
    NEAR(a.y, -23);
    a = origin_of("<svg x='10' y='20' width='40' height='30' viewBox='5 5 10 10' preserveAspectRatio='none'><path d='M6 6 7 7'/></svg>");
    NEAR(a.x, 17 + 4);
    NEAR(a.y, -26);
    a = origin_of("<svg x='10' y='20'><path d='M5 5 6 6'/></svg>");
    NEAR(a.x, 22);
    NEAR(a.y, -28);
    a = origin_of("<svg viewBox='5 5 10 10'><path d='M5 5 6 6'/></svg>"); /* as large as what it is in, which is not known */
    NEAR(a.x, 12);
    NEAR(a.y, -8);
}

/* Fits the outline of the same file. */
static void test_outline(void)
{
    char *name;
    int file = g_file_open_tmp("venation-XXXXXX.svg", &name, NULL);
    g_close(file, NULL);
    g_file_set_contents(name, inkscape, -1, NULL);
    SvgShape shape;
    g_assert_true(svgfile_read(name, &shape, NULL));
    g_assert_true(shape.has_base && shape.base.x == 10 && shape.base.y == -120);
    Drawing *d = drawing_read_svg(name, 0.01, NULL, NULL);
    NEAR(vec_dist(d->vein[0].point[0], shape.base), 0.0);
    drawing_free(d);
    svgshape_clear(&shape);
    g_unlink(name);
    g_free(name);
}

static void check_error(const char *text, ImportErrorCode code, const char *says)
{
    GError *error = NULL;
    g_assert_null(read_bytes(text, strlen(text), &error));
    g_assert_error(error, IMPORT_ERROR, (int)code);
    if (!strstr(error->message, says))
        g_error("'%s' does not say '%s'", error->message, says);
    g_error_free(error);
}

static void test_errors(void)
{
    check_error("<svg></svg>", IMPORT_ERROR_GRAPH, "neither a layer \"veins\" nor an open path that shows");
    check_error("<svg>" P "<g id='veins'><path d='M0 0 1 0 1 1z'/></g></svg>", IMPORT_ERROR_GRAPH, "(1 object is there");
    check_error("<svg><g id='veins' style='display:none'>" P "</g></svg>", IMPORT_ERROR_GRAPH, "hidden");
    check_error("<svg>\n<g id='veins'>\n<path inkscape:label='lat' d='M0 0 q'/></g></svg>", IMPORT_ERROR_SYNTAX, "line 3: path 'lat': at character 7");
    check_error("<svg><g id='veins'><rect width='3' height='3'/><text>x</text></g></svg>", IMPORT_ERROR_GRAPH, "(2 objects are there");
    check_error("<svg><g id='veins'>" P "<use id='u7' xlink:href='#x'/></g></svg>", IMPORT_ERROR_SYNTAX, "use 'u7' among the veins is a clone");
    check_error("<svg><path id='p1' d='M0 0 1 x'/></svg>", IMPORT_ERROR_SYNTAX, "path 'p1'");
    check_error("<svg>" P "<polyline points='1,2 3'/></svg>", IMPORT_ERROR_SYNTAX, "polyline 2");
    check_error("<svg><g transform='turn(3)'>" P "</g></svg>", IMPORT_ERROR_SYNTAX, "transform");
    check_error("<svg><line x1='0' y1='0' x2='1em' y2='1'/></svg>", IMPORT_ERROR_SYNTAX, "x2");
    check_error("<svg><path d='M0 0 1 1' transform='scale(1e59)'/><path d='M0 0 99 1' transform='scale(1e59)'/></svg>", IMPORT_ERROR_SYNTAX, "too large");
    check_error("<html/>", IMPORT_ERROR_SYNTAX, "not an SVG file");
    check_error("<svg>", IMPORT_ERROR_SYNTAX, "not an SVG file");
    check_error("", IMPORT_ERROR_SYNTAX, "not an SVG file");
    check_error("\x89PNG", IMPORT_ERROR_SYNTAX, "not an SVG file");
    GError *error = NULL;
    g_assert_null(drawing_read_svg("/no/such/file.svg", 0.01, NULL, &error));
    g_assert_error(error, G_FILE_ERROR, G_FILE_ERROR_NOENT);
    g_error_free(error);
}

/* ---- broken files ---- */

static uint32_t dice(uint32_t i, uint32_t k, uint32_t sides) { return random_block(3, i, 0, k).w[0] % sides; }

static GString *mutated(const char *text, gsize length, uint32_t i)
{
    static const char *const piece[] = {"<g>", "</g>", "\"", "<", "/>", "e99", "-", "z", "M", "nan", "transform=\"scale(0)\"", "style=\"stroke-width:1e50\"",
                                        "id=\"veins\"", "\xff", "&#10;", "A 1 1 0 0 0", "1e-60", "C", ";", ":", "!",
                                        "<style>.a{stroke-width:3}", "</style>", "class=\"a\"", "visibility=\"hidden\"", "<svg viewBox=\"0 0 3 4\" width=\"1\" height=\"9\">"};
    GString *s = g_string_new_len(text, (gssize)length);
    for (uint32_t k = 0, n = 1 + dice(i, 0, 5); k < n && s->len > 0; k++) {
        gsize at = dice(i, 4 * k + 1, (uint32_t)s->len), run = MIN(1 + dice(i, 4 * k + 2, 40), s->len - at);
        switch (dice(i, 4 * k + 3, 5)) {
        case 0:
            g_string_erase(s, (gssize)at, (gssize)run);
            break;
        case 1: {
            char *copy = g_strndup(s->str + at, run);
            g_string_insert(s, dice(i, 4 * k + 4, (uint32_t)s->len), copy);
            g_free(copy);
            break;
        }
        case 2:
            g_string_insert(s, (gssize)at, piece[dice(i, 4 * k + 4, G_N_ELEMENTS(piece))]);
            break;
        default: /* mostly digits, which leaves a file that can be read */
            while (at < s->len && !g_ascii_isdigit(s->str[at]))
                at++;
            if (at < s->len)
                s->str[at] = (char)('0' + dice(i, 4 * k + 4, 10));
        }
    }
    return s;
}

/* What was read becomes a network in some blade, or an error. */
static bool use(Drawing *d, uint32_t i)
{
    const Vec2 corner[] = {{-1, -0.1}, {1, -0.1}, {1, 1.1}, {0, 0.9}, {-1, 1.1}};
    Polygon *leaf = polygon_new(corner, G_N_ELEMENTS(corner));
    DrawingDef def = drawing_def_default();
    GError *error = NULL;
    def.length = i % 3 ? 30.0 : 3.0;
    drawing_to_leaf(d, vec2(10, -130), vec2(10, 10));
    Network *n = drawing_network(d, leaf, &def, &error);
    bool good = n != NULL;
    g_assert_true(good != (error != NULL));
    for (uint32_t e = 0; n && e < n->n_edges; e++) {
        g_assert_true(n->tail[e] < n->head[e] && n->head[e] < n->n_nodes && n->vein[e] < n->n_veins && n->order[e] > 0);
        g_assert_cmpfloat(vec_dist(n->node[n->tail[e]], n->node[n->head[e]]), <=, 1.0 + 1e-8);
    }
    if (error)
        g_assert_true(error->domain == DRAWING_ERROR && g_utf8_validate(error->message, -1, NULL));
    g_clear_error(&error);
    network_free(n);
    polygon_free(leaf);
    return good;
}

static void test_broken(void)
{
    uint32_t read = 0, made = 0;
    for (uint32_t i = 0; i < 3000; i++) {
        GString *s = mutated(inkscape, strlen(inkscape), i);
        GError *error = NULL;
        Drawing *d = read_bytes(s->str, s->len, &error);
        g_assert_true((d == NULL) == (error != NULL));
        if (error)
            g_assert_true(error->domain == IMPORT_ERROR && g_utf8_validate(error->message, -1, NULL));
        g_clear_error(&error);
        read += d != NULL;
        for (uint32_t k = 0; d && k < d->n; k++)
            g_assert_true(d->vein[k].n >= 2 && d->vein[k].name && isfinite(d->vein[k].width[0]));
        made += d && use(d, i);
        drawing_free(d);
        g_string_free(s, TRUE);
    }
    g_assert_cmpuint(read, >, 600);
    g_assert_cmpuint(made, >, 300);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/drawing-svg/inkscape", test_inkscape);
    g_test_add_func("/drawing-svg/flatness", test_flatness);
    g_test_add_func("/drawing-svg/orders", test_orders);
    g_test_add_func("/drawing-svg/nesting", test_nesting);
    g_test_add_func("/drawing-svg/which", test_which);
    g_test_add_func("/drawing-svg/widths", test_widths);
    g_test_add_func("/drawing-svg/sheets", test_sheets);
    g_test_add_func("/drawing-svg/empty", test_empty);
    g_test_add_func("/drawing-svg/inner", test_inner);
    g_test_add_func("/drawing-svg/entities", test_entities);
    g_test_add_func("/drawing-svg/outline", test_outline);
    g_test_add_func("/drawing-svg/errors", test_errors);
    g_test_add_func("/drawing-svg/broken", test_broken);
    return g_test_run();
}
