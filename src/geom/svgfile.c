#include "geom/svgfile.h"

#include "geom/affine.h"
#include "geom/svgscan.h"
#include "geom/textfile.h"

#include <string.h>

typedef struct {
    GArray *transforms; /* Affine of each open element, from its units to the drawing's, y up */
    guint hidden;       /* open elements at and below the first that only defines things; 0: shown */
    SvgShape shape;
    bool has_outline;   /* the path is the one with id "outline" */
    double area;        /* of the path otherwise */
    GError *skipped;    /* first fault of a path that may not matter */
} Reader;

/* The name without the prefix that files with an explicit SVG namespace use; "" for other namespaces. */
static const char *local_name(const char *name)
{
    if (g_str_has_prefix(name, "svg:"))
        return name + 4;
    return strchr(name, ':') ? "" : name;
}

static const char *attribute(const char **names, const char **values, const char *name)
{
    for (; *names; names++, values++)
        if (!strcmp(*names, name))
            return *values;
    return NULL;
}

static bool only_defines(const char *name)
{
    static const char *const definitions[] = {"defs", "clipPath", "mask", "symbol", "marker", "pattern", NULL};
    return g_strv_contains(definitions, name);
}

static bool vec_is_sound(Vec2 p) { return fabs(p.x) <= SVG_LARGEST && fabs(p.y) <= SVG_LARGEST; }

static bool transform_path(SvgPath *path, const Affine *m, GError **error)
{
    for (guint k = 0; k < path->curves->len; k++) {
        Curve *curve = &g_array_index(path->curves, Curve, k);
        for (int i = 0; i < 4; i++) {
            curve->p[i] = affine_apply(m, curve->p[i]);
            if (!vec_is_sound(curve->p[i])) {
                g_set_error(error, OUTLINE_ERROR, OUTLINE_ERROR_SYNTAX, "its coordinates are too large");
                return false;
            }
        }
    }
    return true;
}

static double subpath_area(const SvgPath *path, guint k)
{
    Box2 box = svgpath_box(path, k);
    GArray *points = svgpath_flatten(path, k, 1e-3 * (box.x1 - box.x0 + box.y1 - box.y0));
    const Vec2 *v = &g_array_index(points, Vec2, 0);
    double twice = 0.0;
    for (guint i = 1; i + 1 < points->len; i++)
        twice += vec_cross(vec_sub(v[i], v[0]), vec_sub(v[i + 1], v[0]));
    bool meets = points->len > 2 && vec_dist2(v[0], v[points->len - 1]) <= 1e-18 * fabs(twice);
    g_array_unref(points);
    return g_array_index(path->subpaths, Subpath, k).closed || meets ? 0.5 * fabs(twice) : 0.0;
}

/* The area of the largest closed subpath, 0 when none is closed. */
static double path_area(const SvgPath *path)
{
    double largest = 0.0;
    for (guint k = 0; k < path->subpaths->len; k++) {
        double area = subpath_area(path, k);
        largest = area > largest ? area : largest;
    }
    return largest;
}

static SvgPath *read_path(const char *data, const char *id, const Affine *m, GError **error)
{
    SvgPath *path = svgpath_parse(data ? data : "", error);
    if (path && !transform_path(path, m, error)) {
        svgpath_free(path);
        path = NULL;
    }
    if (!path)
        g_prefix_error(error, "<path id=\"%s\">: ", id ? id : "");
    return path;
}

static void take_path(Reader *r, SvgPath *path, double area)
{
    svgpath_free(r->shape.path);
    r->shape.path = path;
    r->area = area;
}

static void see_path(Reader *r, const char *data, const char *id, const Affine *m, GError **error)
{
    bool wanted = id && !strcmp(id, "outline");
    if (r->has_outline || (r->hidden && !wanted))
        return;
    GError **fault = wanted ? error : r->skipped ? NULL : &r->skipped;
    SvgPath *path = read_path(data, id, m, fault);
    if (!path)
        return;
    double area = wanted ? 0.0 : path_area(path);
    r->has_outline = wanted;
    if (wanted || area > r->area)
        take_path(r, path, area);
    else
        svgpath_free(path);
}

/* A length in user units, which may say so with "px"; a missing one is 0. */
static bool read_length(const char *text, double *value, GError **error)
{
    *value = 0.0;
    if (!text)
        return true;
    SvgScan s = {text, text};
    svgscan_space(&s);
    if (!svgscan_number(&s, value, error))
        return false;
    if (g_str_has_prefix(s.at, "px"))
        s.at += 2;
    svgscan_space(&s);
    return !*s.at || svgscan_fail(&s, "a number in user units", error);
}

/* A circle or ellipse that marks a point. */
static bool read_mark(const char *name, const char *id, const char **names, const char **values, const Affine *m,
                      Vec2 *out, GError **error)
{
    if (strcmp(name, "circle") && strcmp(name, "ellipse")) {
        g_set_error(error, OUTLINE_ERROR, OUTLINE_ERROR_SYNTAX,
                    "<%s id=\"%s\">: the %s must be marked by a circle or an ellipse", name, id, id);
        return false;
    }
    Vec2 p;
    if (!read_length(attribute(names, values, "cx"), &p.x, error) ||
        !read_length(attribute(names, values, "cy"), &p.y, error)) {
        g_prefix_error(error, "<%s id=\"%s\">, cx and cy: ", name, id);
        return false;
    }
    *out = affine_apply(m, p);
    if (!vec_is_sound(*out)) {
        g_set_error(error, OUTLINE_ERROR, OUTLINE_ERROR_SYNTAX, "<%s id=\"%s\">: its coordinates are too large", name,
                    id);
        return false;
    }
    return true;
}

static void see_element(Reader *r, const char *name, const char **names, const char **values, GError **error)
{
    const Affine *m = &g_array_index(r->transforms, Affine, r->transforms->len - 1);
    const char *id = attribute(names, values, "id");
    if (!strcmp(name, "path"))
        see_path(r, attribute(names, values, "d"), id, m, error);
    else if (id && !strcmp(id, "outline"))
        g_set_error(error, OUTLINE_ERROR, OUTLINE_ERROR_SYNTAX,
                    "<%s id=\"outline\">: the outline must be a path (Inkscape: Path, Object to Path)", name);
    else if (id && !strcmp(id, "base"))
        r->shape.has_base = read_mark(name, id, names, values, m, &r->shape.base, error);
    else if (id && !strcmp(id, "tip"))
        r->shape.has_tip = read_mark(name, id, names, values, m, &r->shape.tip, error);
}

static void start_element(GMarkupParseContext *context, const char *element, const char **names, const char **values,
                          gpointer user, GError **error)
{
    Reader *r = user;
    const char *name = local_name(element), *transform = attribute(names, values, "transform");
    if (r->transforms->len == 1 && strcmp(name, "svg")) {
        g_set_error(error, OUTLINE_ERROR, OUTLINE_ERROR_SYNTAX, "not an SVG file: it begins with <%s>", element);
        return;
    }
    Affine m = g_array_index(r->transforms, Affine, r->transforms->len - 1), own;
    if (transform && *name) {
        if (!affine_parse(transform, &own, error)) {
            g_prefix_error(error, "<%s>, transform: ", element);
            return;
        }
        m = affine_multiply(&m, &own);
    }
    g_array_append_val(r->transforms, m);
    if (r->hidden || only_defines(name))
        r->hidden++;
    if (*name)
        see_element(r, name, names, values, error);
}

static void end_element(GMarkupParseContext *context, const char *element, gpointer user, GError **error)
{
    Reader *r = user;
    g_array_set_size(r->transforms, r->transforms->len - 1);
    if (r->hidden)
        r->hidden--;
}

/* Names file and line, and makes GLib's complaints ours. */
static void name_place(GError **error, const char *file, int line)
{
    GError *cause = *error;
    if (cause->domain == OUTLINE_ERROR)
        *error = g_error_new(OUTLINE_ERROR, cause->code, "%s, line %d: %s", file, line, cause->message);
    else
        *error = g_error_new(OUTLINE_ERROR, OUTLINE_ERROR_SYNTAX, "%s: not an SVG file: %s", file, cause->message);
    g_error_free(cause);
}

static bool parse_markup(Reader *r, const char *file, const char *text, gsize length, GError **error)
{
    static const GMarkupParser parser = {.start_element = start_element, .end_element = end_element};
    GMarkupParseContext *context = g_markup_parse_context_new(&parser, 0, r, NULL);
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

/* What is wrong with a file that parsed but has no path to take. */
static void report_no_path(Reader *r, const char *file, GError **error)
{
    g_set_error(error, OUTLINE_ERROR, r->skipped ? OUTLINE_ERROR_SYNTAX : OUTLINE_ERROR_SHAPE, "%s: %s", file,
                r->skipped ? r->skipped->message : "there is neither a path with id \"outline\" nor a closed path");
}

enum { LARGEST_FILE = 64 << 20 }; /* bytes */

bool svgfile_read(const char *file, SvgShape *out, GError **error)
{
    char *text;
    gsize length;
    GError *cause = NULL;
    if (!textfile_read(file, LARGEST_FILE, &text, &length, &cause)) {
        g_set_error_literal(error, OUTLINE_ERROR, OUTLINE_ERROR_READ, cause->message);
        g_error_free(cause);
        return false;
    }
    Reader r = {.transforms = g_array_new(FALSE, FALSE, sizeof(Affine))};
    Affine y_up = {1.0, 0.0, 0.0, -1.0, 0.0, 0.0};
    g_array_append_val(r.transforms, y_up);
    gsize mark = length >= 3 && !memcmp(text, "\xEF\xBB\xBF", 3) ? 3 : 0; /* byte order mark */
    bool good = parse_markup(&r, file, text + mark, length - mark, error);
    if (good && !r.shape.path) {
        report_no_path(&r, file, error);
        good = false;
    }
    if (good)
        *out = r.shape;
    else
        svgshape_clear(&r.shape);
    g_clear_error(&r.skipped);
    g_array_unref(r.transforms);
    g_free(text);
    return good;
}

void svgshape_clear(SvgShape *shape)
{
    svgpath_free(shape->path);
    *shape = (SvgShape){0};
}
