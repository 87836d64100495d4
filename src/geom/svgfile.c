#include "geom/svgfile.h"

#include "geom/svgwalk.h"

#include <string.h>

/* How sure it is that a shape is the margin. A label is a name too, but another shape may have it as its id. */
typedef enum { RANK_NONE, RANK_SHAPE, RANK_PATH, RANK_LABEL, RANK_ID } Rank;

typedef struct {
    SvgShape shape;
    Rank rank;       /* of the shape's path */
    double area;     /* of the path, where that matters: up to RANK_PATH */
    GError *skipped; /* first fault of a path that may not matter */
} Reader;

/* A layer may be labelled as it likes. */
static const char *label_of(const SvgElement *e) { return svgelement_is_group(e) ? NULL : e->label; }

/* Whether the element is called so. */
static bool is_called(const SvgElement *e, const char *name) { return !g_strcmp0(e->id, name) || !g_strcmp0(label_of(e), name); }

/* Names an element in an error. */
static void name_element(const SvgElement *e, GError **error)
{
    static const char *const ours[] = {"outline", "base", "tip", NULL};
    const char *label = label_of(e);
    bool labelled = label && (!e->id || g_strv_contains(ours, label));
    g_prefix_error(error, "<%s %s=\"%s\">: ", e->name, labelled ? "inkscape:label" : "id", labelled ? label : e->id ? e->id : "");
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

/* RANK_NONE: no shape, or one that doesn't count. */
static Rank rank_of(const SvgElement *e)
{
    static const char *const paths[] = {"path", "polygon", "polyline", NULL};
    if (!svgelement_is_shape(e) || !strcmp(e->name, "line"))
        return RANK_NONE;
    if (is_called(e, "outline"))
        return !g_strcmp0(e->id, "outline") ? RANK_ID : RANK_LABEL;
    if (e->defined || e->hidden || is_called(e, "base") || is_called(e, "tip"))
        return RANK_NONE;
    return g_strv_contains(paths, e->name) ? RANK_PATH : RANK_SHAPE;
}

static void see_shape(Reader *r, const SvgElement *e, GError **error)
{
    Rank rank = rank_of(e);
    bool wanted = rank >= RANK_LABEL;
    if (rank == RANK_NONE || rank < r->rank || (wanted && rank == r->rank))
        return;
    GError **fault = wanted ? error : r->skipped ? NULL : &r->skipped;
    SvgPath *path = svgelement_path(e, fault);
    if (!path) {
        name_element(e, fault);
        return;
    }
    double area = wanted ? 0.0 : path_area(path);
    if (wanted || area > (rank > r->rank ? 0.0 : r->area)) {
        svgpath_free(r->shape.path);
        r->shape.path = path;
        r->rank = rank;
        r->area = area;
    } else {
        svgpath_free(path);
    }
}

/* A circle or ellipse that marks a point. */
static bool read_mark(const SvgElement *e, const char *which, Vec2 *out, GError **error)
{
    bool round = svgelement_is_round(e);
    if (!round)
        g_set_error(error, OUTLINE_ERROR, OUTLINE_ERROR_SYNTAX, "the %s must be marked by a circle or an ellipse", which);
    bool good = round && svgelement_centre(e, out, error);
    if (!good)
        name_element(e, error);
    return good;
}

static bool see_element(const SvgElement *e, void *user, GError **error)
{
    Reader *r = user;
    GError *fault = NULL;
    if (is_called(e, "base")) {
        r->shape.has_base = read_mark(e, "base", &r->shape.base, &fault);
    } else if (is_called(e, "tip")) {
        r->shape.has_tip = read_mark(e, "tip", &r->shape.tip, &fault);
    } else if (is_called(e, "outline") && rank_of(e) == RANK_NONE) {
        g_set_error(&fault, OUTLINE_ERROR, OUTLINE_ERROR_SYNTAX,
                    "the outline must be a path or a simple shape (in Inkscape: %sPath > Object to Path)",
                    strcmp(e->name, "g") ? "" : "Object > Ungroup, ");
        name_element(e, &fault);
    } else {
        see_shape(r, e, &fault);
    }
    if (fault)
        g_propagate_error(error, fault);
    return !fault;
}

/* What is wrong with a file that parsed but has no path to take. */
static void report_no_path(Reader *r, const char *file, GError **error)
{
    g_set_error(error, OUTLINE_ERROR, r->skipped ? OUTLINE_ERROR_SYNTAX : OUTLINE_ERROR_SHAPE, "%s: %s", file,
                r->skipped ? r->skipped->message
                           : "there is neither a path with id or label \"outline\" nor a closed path "
                             "(in Inkscape, Path > Object to Path makes one)");
}

bool svgfile_read(const char *file, SvgShape *out, GError **error)
{
    Reader r = {0};
    GError *cause = NULL;
    bool good = svgwalk_file(file, see_element, &r, &cause);
    if (good && !r.shape.path) {
        report_no_path(&r, file, error);
        good = false;
    }
    if (cause && cause->domain == OUTLINE_ERROR) {
        g_propagate_error(error, cause);
    } else if (cause) {
        g_set_error_literal(error, OUTLINE_ERROR, OUTLINE_ERROR_READ, cause->message);
        g_error_free(cause);
    }
    if (good)
        *out = r.shape;
    else
        svgshape_clear(&r.shape);
    g_clear_error(&r.skipped);
    return good;
}

void svgshape_clear(SvgShape *shape)
{
    svgpath_free(shape->path);
    *shape = (SvgShape){0};
}
