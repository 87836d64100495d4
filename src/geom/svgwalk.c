#include "geom/svgwalk.h"

#include "geom/svgentity.h"
#include "geom/svgscan.h"
#include "geom/svgstyle.h"
#include "geom/textfile.h"

#include <string.h>

static bool is_one_of(const char *word, const char *const *words) { return g_strv_contains(words, word); }

static const char *attribute(const char **names, const char **values, const char *name)
{
    for (; *names; names++, values++)
        if (!strcmp(*names, name))
            return *values;
    return NULL;
}

/* ---- shapes ---- */

bool svgelement_is_group(const SvgElement *e) { return is_one_of(e->name, (const char *const[]){"g", "svg", NULL}); }
bool svgelement_is_round(const SvgElement *e) { return is_one_of(e->name, (const char *const[]){"circle", "ellipse", NULL}); }

bool svgelement_is_shape(const SvgElement *e)
{
    return svgelement_is_round(e) || is_one_of(e->name, (const char *const[]){"path", "polygon", "polyline", "line", "rect", NULL});
}

/* A length in user units, which may say so with "px"; a missing one is 0. */
static bool read_length(const SvgElement *e, const char *name, double *value, GError **error)
{
    const char *text = attribute(e->names, e->values, name);
    *value = 0.0;
    if (!text)
        return true;
    SvgScan s = {text, text};
    svgscan_space(&s);
    bool good = svgscan_number(&s, value, error);
    if (good && g_str_has_prefix(s.at, "px"))
        s.at += 2;
    svgscan_space(&s);
    good = good && (!*s.at || svgscan_fail(&s, "a number in user units", error));
    if (!good)
        g_prefix_error(error, "%s: ", name);
    return good;
}

static bool read_lengths(const SvgElement *e, guint n, const char *const *name, double *value, GError **error)
{
    for (guint i = 0; i < n; i++)
        if (!read_length(e, name[i], &value[i], error))
            return false;
    return true;
}

static SvgPath *read_rectangle(const SvgElement *e, GError **error)
{
    static const char *const name[] = {"x", "y", "width", "height", "rx", "ry"};
    double v[6];
    if (!read_lengths(e, 6, name, v, error))
        return NULL;
    bool has_rx = attribute(e->names, e->values, "rx"), has_ry = attribute(e->names, e->values, "ry");
    return svgpath_rectangle(vec2(v[0], v[1]), v[2], v[3], has_rx ? v[4] : v[5], has_ry ? v[5] : v[4]);
}

static SvgPath *read_ellipse(const SvgElement *e, GError **error)
{
    static const char *const of_circle[] = {"cx", "cy", "r", "r"}, *const of_ellipse[] = {"cx", "cy", "rx", "ry"};
    double v[4];
    if (!read_lengths(e, 4, strcmp(e->name, "circle") ? of_ellipse : of_circle, v, error))
        return NULL;
    return svgpath_ellipse(vec2(v[0], v[1]), v[2], v[3]);
}

static SvgPath *read_line(const SvgElement *e, GError **error)
{
    static const char *const name[] = {"x1", "y1", "x2", "y2"};
    double v[4];
    if (!read_lengths(e, 4, name, v, error))
        return NULL;
    SvgPath *path = svgpath_points("", false, NULL);
    Curve curve = curve_line(vec2(v[0], v[1]), vec2(v[2], v[3]));
    Subpath subpath = {0, false};
    g_array_append_val(path->curves, curve);
    g_array_append_val(path->subpaths, subpath);
    return path;
}

static SvgPath *read_shape(const SvgElement *e, GError **error)
{
    bool is_path = !strcmp(e->name, "path");
    const char *data = attribute(e->names, e->values, is_path ? "d" : "points");
    if (!strcmp(e->name, "rect"))
        return read_rectangle(e, error);
    if (!strcmp(e->name, "line"))
        return read_line(e, error);
    if (svgelement_is_round(e))
        return read_ellipse(e, error);
    return is_path ? svgpath_parse(data ? data : "", error) : svgpath_points(data ? data : "", !strcmp(e->name, "polygon"), error);
}

static bool transform_point(const Affine *m, Vec2 *p, GError **error)
{
    *p = affine_apply(m, *p);
    if (fabs(p->x) <= SVG_LARGEST && fabs(p->y) <= SVG_LARGEST)
        return true;
    g_set_error(error, OUTLINE_ERROR, OUTLINE_ERROR_SYNTAX, "its coordinates are too large");
    return false;
}

SvgPath *svgelement_path(const SvgElement *e, GError **error)
{
    SvgPath *path = read_shape(e, error);
    for (guint k = 0; path && k < 4 * path->curves->len; k++)
        if (!transform_point(&e->map, &g_array_index(path->curves, Curve, k / 4).p[k % 4], error)) {
            svgpath_free(path);
            path = NULL;
        }
    return path;
}

bool svgelement_centre(const SvgElement *e, Vec2 *centre, GError **error)
{
    return read_length(e, "cx", &centre->x, error) && read_length(e, "cy", &centre->y, error) && transform_point(&e->map, centre, error);
}

/* ---- styles ---- */

bool svgwalk_length(const char *text, double whole, double *length)
{
    static const struct {
        const char *name;
        double size; /* user units: CSS pixels, 96 an inch */
    } unit[] = {{"", 1.0}, {"px", 1.0}, {"pt", 96.0 / 72.0}, {"pc", 16.0}, {"mm", 96.0 / 25.4}, {"cm", 960.0 / 25.4}, {"in", 96.0}};
    if (!text)
        return false;
    SvgScan s = {text, text};
    double value;
    svgscan_space(&s);
    if (!svgscan_number(&s, &value, NULL))
        return false;
    const char *end = s.at + strcspn(s.at, " \t\r\n");
    gsize n = (gsize)(end - s.at);
    if (end[strspn(end, " \t\r\n")] != '\0')
        return false;
    if (n == 1 && *s.at == '%' && whole > 0.0) {
        *length = 0.01 * value * whole;
        return true;
    }
    for (gsize k = 0; k < G_N_ELEMENTS(unit); k++)
        if (strlen(unit[k].name) == n && !strncmp(s.at, unit[k].name, n)) {
            *length = value * unit[k].size;
            return true;
        }
    return false;
}

/* What style sheet, style attribute and attribute say of a property; free it. NULL: nothing. */
static char *property(const SvgStyle *sheet, const SvgElement *e, const char *name)
{
    return svgstyle_property(sheet, e->name, e->id, attribute(e->names, e->values, "class"), attribute(e->names, e->values, "style"),
                             attribute(e->names, e->values, name), name);
}

static void read_style(const SvgStyle *sheet, SvgElement *e)
{
    char *display = property(sheet, e, "display"), *visibility = property(sheet, e, "visibility"), *stroke = property(sheet, e, "stroke-width");
    double width;
    e->gone |= display && !strcmp(display, "none");
    if (visibility && (!strcmp(visibility, "visible") || !strcmp(visibility, "hidden") || !strcmp(visibility, "collapse")))
        e->unseen = strcmp(visibility, "visible") != 0; /* else it is inherited */
    e->hidden = e->gone || e->unseen;
    if (svgwalk_length(stroke, 0.0, &width) && width >= 0.0)
        e->stroke = width; /* else it is inherited */
    g_free(display);
    g_free(visibility);
    g_free(stroke);
}

/* ---- places ---- */

const char *svgelement_attribute(const SvgElement *e, const char *name) { return attribute(e->names, e->values, name); }

bool svgwalk_box(const char *text, double box[4])
{
    SvgScan s = {text ? text : "", text ? text : ""};
    for (int k = 0; k < 4; k++) {
        svgscan_comma(&s);
        if (!svgscan_number(&s, &box[k], NULL))
            return false;
    }
    svgscan_space(&s);
    return *s.at == '\0' && box[2] > 0.0 && box[3] > 0.0;
}

/* xMin, xMid, xMax and their like: the part of the room left over that lies before the picture. */
static double align(const char *word, const char *axis)
{
    const char *at = strstr(word, axis);
    return at && g_str_has_prefix(at + 1, "Min") ? 0.0 : at && g_str_has_prefix(at + 1, "Max") ? 1.0 : 0.5;
}

Affine svgwalk_viewport(const double port[4], const double box[4], const char *ratio)
{
    double sx = port[2] / box[2], sy = port[3] / box[3], dx = 0.0, dy = 0.0;
    const char *how = ratio ? ratio : "";
    if (!strstr(how, "none")) {
        sx = sy = strstr(how, "slice") ? MAX(sx, sy) : MIN(sx, sy);
        dx = align(how, "x") * (port[2] - sx * box[2]);
        dy = align(how, "Y") * (port[3] - sy * box[3]);
    }
    return (Affine){.a = sx, .d = sy, .e = port[0] + dx - sx * box[0], .f = port[1] + dy - sy * box[1]};
}

/* A drawing within the drawing has a place and a scale of its own. */
static void enter_inner(SvgElement *e)
{
    double port[4] = {0.0, 0.0, 0.0, 0.0}, box[4];
    static const char *const name[] = {"x", "y", "width", "height"};
    for (int k = 0; k < 4; k++)
        svgwalk_length(svgelement_attribute(e, name[k]), 0.0, &port[k]);
    if (!svgwalk_box(svgelement_attribute(e, "viewBox"), box)) {
        box[0] = box[1] = 0.0;
        box[2] = port[2] = 1.0;
        box[3] = port[3] = 1.0;
    }
    if (!(port[2] > 0.0 && port[3] > 0.0)) /* as large as what it is in, which is not known */
        return;
    Affine own = svgwalk_viewport(port, box, svgelement_attribute(e, "preserveAspectRatio"));
    e->map = affine_multiply(&e->map, &own);
}

/* ---- the walk ---- */

/* Elements that are open, from the first; they own their strings. */
typedef struct {
    GPtrArray *open; /* SvgElement */
    SvgStyle *sheet;
    SvgSeen see;
    void *user;
} Walk;

static void element_free(gpointer element)
{
    SvgElement *e = element;
    g_free((char *)e->name);
    g_free((char *)e->id);
    g_free((char *)e->label);
    g_free(e);
}

/* The name without the prefix that files with an explicit SVG namespace use; "" for other namespaces. */
static const char *local_name(const char *name)
{
    if (g_str_has_prefix(name, "svg:"))
        return name + 4;
    return strchr(name, ':') ? "" : name;
}

static bool only_defines(const char *name)
{
    return is_one_of(name, (const char *const[]){"defs", "clipPath", "mask", "symbol", "marker", "pattern", NULL});
}

static SvgElement *open_element(Walk *w, const char *name, const char **names, const char **values)
{
    SvgElement *e = g_new0(SvgElement, 1);
    if (w->open->len > 0) {
        *e = *(const SvgElement *)g_ptr_array_index(w->open, w->open->len - 1);
        e->above = g_ptr_array_index(w->open, w->open->len - 1);
    } else {
        e->map = (Affine){1.0, 0.0, 0.0, -1.0, 0.0, 0.0}; /* y up */
    }
    e->name = g_strdup(name);
    e->id = g_strdup(attribute(names, values, "id"));
    e->label = g_strdup(attribute(names, values, "inkscape:label"));
    e->names = names;
    e->values = values;
    e->defined |= only_defines(name);
    g_ptr_array_add(w->open, e);
    return e;
}

static void start_element(GMarkupParseContext *context, const char *element, const char **names, const char **values,
                          gpointer user, GError **error)
{
    Walk *w = user;
    const char *name = local_name(element), *transform = attribute(names, values, "transform");
    if (w->open->len == 0 && strcmp(name, "svg")) {
        g_set_error(error, OUTLINE_ERROR, OUTLINE_ERROR_SYNTAX, "not an SVG file: it begins with <%s>", element);
        return;
    }
    SvgElement *e = open_element(w, name, names, values);
    if (!*name)
        return;
    if (transform) {
        Affine own;
        if (!affine_parse(transform, &own, error)) {
            g_prefix_error(error, "<%s>, transform: ", element);
            return;
        }
        e->map = affine_multiply(&e->map, &own);
    }
    read_style(w->sheet, e);
    if (e->above && !strcmp(name, "svg"))
        enter_inner(e);
    w->see(e, w->user, error);
}

static void end_element(GMarkupParseContext *context, const char *element, gpointer user, GError **error)
{
    Walk *w = user;
    g_ptr_array_set_size(w->open, (gint)w->open->len - 1);
}

/* Names file and line, and makes GLib's complaints, which may quote any bytes, ours. */
static void name_place(GError **error, const char *file, int line)
{
    GError *cause = *error;
    char *what = g_utf8_make_valid(cause->message, -1);
    if (cause->domain == OUTLINE_ERROR)
        *error = g_error_new(OUTLINE_ERROR, cause->code, "%s, line %d: %s", file, line, what);
    else
        *error = g_error_new(OUTLINE_ERROR, OUTLINE_ERROR_SYNTAX, "%s: not an SVG file: %s", file, what);
    g_free(what);
    g_error_free(cause);
}

/* Style sheets count for what is drawn before them, too, so they are read first, as far as the file is sound. */
static void take_sheet(GMarkupParseContext *context, const char *text, gsize length, gpointer user, GError **error)
{
    const char *element = g_markup_parse_context_get_element(context);
    if (!element || strcmp(local_name(element), "style"))
        return;
    char *rules = g_strndup(text, length);
    svgstyle_add(user, rules);
    g_free(rules);
}

static SvgStyle *read_sheets(const char *text, gsize length)
{
    static const GMarkupParser parser = {.text = take_sheet};
    SvgStyle *sheet = svgstyle_new();
    if (!g_strstr_len(text, (gssize)length, "<style") && !g_strstr_len(text, (gssize)length, ":style"))
        return sheet;
    GMarkupParseContext *context = g_markup_parse_context_new(&parser, G_MARKUP_TREAT_CDATA_AS_TEXT, sheet, NULL);
    g_markup_parse_context_parse(context, text, (gssize)length, NULL);
    g_markup_parse_context_free(context);
    return sheet;
}

static bool parse_markup(Walk *w, const char *file, const char *text, gsize length, GError **error)
{
    static const GMarkupParser parser = {.start_element = start_element, .end_element = end_element};
    GMarkupParseContext *context = g_markup_parse_context_new(&parser, 0, w, NULL);
    GError *cause = NULL;
    bool good = g_markup_parse_context_parse(context, text, (gssize)length, &cause) &&
                g_markup_parse_context_end_parse(context, &cause);
    if (!good) {
        int line = 0;
        g_markup_parse_context_get_position(context, &line, NULL);
        name_place(&cause, file, line);
        g_propagate_error(error, cause);
    }
    g_markup_parse_context_free(context);
    return good;
}

bool svgwalk_file(const char *file, SvgSeen see, void *user, GError **error)
{
    enum { LARGEST_FILE = 64 << 20 }; /* bytes */
    char *text;
    gsize length;
    if (!textfile_read(file, LARGEST_FILE, &text, &length, error))
        return false;
    char *expanded = svgentity_expand(text, &length, LARGEST_FILE);
    if (expanded) {
        g_free(text);
        text = expanded;
    }
    gsize mark = length >= 3 && !memcmp(text, "\xEF\xBB\xBF", 3) ? 3 : 0; /* byte order mark */
    Walk w = {g_ptr_array_new_with_free_func(element_free), read_sheets(text + mark, length - mark), see, user};
    bool good = parse_markup(&w, file, text + mark, length - mark, error);
    g_ptr_array_unref(w.open);
    svgstyle_free(w.sheet);
    g_free(text);
    return good;
}
