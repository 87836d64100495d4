/* Veins drawn over a scan in Inkscape or the like. */
#include <string.h>

#include "geom/svgwalk.h"
#include "import/drawing_file.h"
#include "import/names.h"

typedef struct {
    GArray *points; /* Vec2 */
    char *name;
    double width;
    uint8_t said;   /* order that a name says; 0: none */
    uint8_t nested; /* 1 in "veins" itself, 2 in a group of it, …; 0: outside */
} Stroke;

typedef struct {
    const char *file;
    double flatness;
    const Affine *place; /* of the drawing; NULL: it stays as it is */
    GArray *strokes;
    bool has_veins;  /* there is a group of that name */
    guint drawn;     /* shapes, texts and images in it that can't be taken: closed, hidden or none of lines */
    GError *skipped; /* first fault of a path outside of it */
} Reader;

static void stroke_clear(gpointer stroke)
{
    Stroke *s = stroke;
    g_array_unref(s->points);
    g_free(s->name);
}

/* ---- what names say ---- */

static bool is_letter(char c) { return g_ascii_isalpha(c) || (guchar)c >= 0x80; }
static bool is_word(char c) { return is_letter(c) || g_ascii_isdigit(c); }

/* "secondary", and not as a part of a longer word. */
static bool begins_word(const char *text, const char *word)
{
    gsize n = strlen(word);
    return !g_ascii_strncasecmp(text, word, n) && !is_letter(text[n]);
}

/* A number from 1 to 250; 0 for others. *end is moved behind its digits. */
static uint8_t read_number(const char *text, const char **end)
{
    unsigned value = 0;
    for (; g_ascii_isdigit(*text); text++)
        value = MIN(10 * value + (unsigned)(*text - '0'), 1000);
    *end = text;
    return (uint8_t)(value <= 250 ? value : 0);
}

/* The order that begins a text: "secondary", "order-2", "2nd"; 0 when there is none. */
static uint8_t word_order(const char *text)
{
    static const struct {
        const char *one, *many;
        uint8_t order;
    } word[] = {{"primary", "primaries", 1},     {"midrib", "midvein", 1},          {"secondary", "secondaries", 2},
                {"tertiary", "tertiaries", 3}, {"quaternary", "quaternaries", 4}};
    for (gsize k = 0; k < G_N_ELEMENTS(word); k++)
        if (begins_word(text, word[k].one) || begins_word(text, word[k].many))
            return word[k].order;
    const char *end;
    if (begins_word(text, "order")) {
        const char *number = text + strlen("order");
        return read_number(number + strspn(number, " -_:"), &end);
    }
    uint8_t number = read_number(text, &end);
    static const char *const ending[] = {"st", "nd", "rd", "th"};
    for (gsize k = 0; k < G_N_ELEMENTS(ending) && end > text; k++)
        if (begins_word(end, ending[k]))
            return number;
    return 0;
}

static uint8_t name_order(const char *name)
{
    uint8_t order = 0;
    for (const char *c = name; c && *c && !order; c++)
        if (is_word(*c) && (c == name || !is_word(c[-1])))
            order = word_order(c);
    return order;
}

/* Of the element itself, else of the groups above it, the nearest first. */
static uint8_t said_order(const SvgElement *e)
{
    uint8_t order = 0;
    for (; e && !order; e = e->above) {
        order = name_order(e->label);
        order = order ? order : name_order(e->id);
    }
    return order;
}

static bool is_called(const SvgElement *e, const char *name)
{
    return (e->label && !g_ascii_strcasecmp(e->label, name)) || (e->id && !g_ascii_strcasecmp(e->id, name));
}

static bool is_veins(const SvgElement *e) { return svgelement_is_group(e) && is_called(e, "veins"); }

/* How deep in the group "veins"; 0 outside of it. */
static uint8_t nesting(const SvgElement *e)
{
    unsigned depth = 0;
    for (e = e->above; e; e = e->above) {
        depth += svgelement_is_group(e);
        if (is_veins(e))
            return (uint8_t)MIN(depth, 250);
    }
    return 0;
}

static bool is_outline(const SvgElement *e)
{
    for (; e; e = e->above)
        if (is_called(e, "outline"))
            return true;
    return false;
}

/* ---- paths ---- */

static char *path_name(const Reader *r, const SvgElement *e)
{
    if (!e->label && !e->id)
        return g_strdup_printf("%s %u", e->name, r->strokes->len + 1);
    char *quoted = names_quote(e->label ? e->label : e->id), *name = g_strdup_printf("%s %s", e->name, quoted);
    g_free(quoted);
    return name;
}

/* Ends that meet close a path, but not among veins, where someone may have drawn a ring. */
static bool is_closed(const SvgPath *path, guint k, const GArray *points, bool among_veins)
{
    const Vec2 *p = &g_array_index(points, Vec2, 0);
    Box2 box = svgpath_box(path, k);
    double size = box.x1 - box.x0 + box.y1 - box.y0;
    return g_array_index(path->subpaths, Subpath, k).closed || (!among_veins && vec_dist(p[0], p[points->len - 1]) <= 1e-9 * size);
}

/* To where the drawing was placed. */
static void lay_down(SvgPath *path, const Affine *place)
{
    for (guint k = 0; place && k < 4 * path->curves->len; k++) {
        Vec2 *p = &g_array_index(path->curves, Curve, k / 4).p[k % 4];
        *p = affine_apply(place, *p);
    }
}

/* In a drawing of any size a curve is a curve, but no more than that. */
static GArray *flatten(const SvgPath *path, guint k, double flatness)
{
    Box2 box = svgpath_box(path, k);
    return svgpath_flatten(path, k, MAX(flatness, 1e-5 * (box.x1 - box.x0 + box.y1 - box.y0)));
}

static double area_scale(const Affine *m) { return fabs(m->a * m->d - m->b * m->c); }

static void take_path(Reader *r, const SvgElement *e, const SvgPath *path)
{
    double scale = sqrt(area_scale(&e->map) * (r->place ? area_scale(r->place) : 1.0));
    guint before = r->strokes->len;
    for (guint k = 0; k < path->subpaths->len; k++) {
        Stroke s = {.points = flatten(path, k, r->flatness), .width = e->stroke * scale, .nested = nesting(e)};
        if (s.points->len < 2 || is_closed(path, k, s.points, s.nested > 0)) {
            g_array_unref(s.points);
            continue;
        }
        s.said = said_order(e);
        s.name = path_name(r, e);
        g_array_append_val(r->strokes, s);
    }
    r->drawn += nesting(e) > 0 && r->strokes->len == before && path->curves->len > 0;
}

/* What is no path, in the layer "veins". */
static bool see_other(Reader *r, const SvgElement *e, GError **error)
{
    if (nesting(e) == 0 || e->defined)
        return true;
    if (!strcmp(e->name, "use") && !e->hidden) {
        char *name = path_name(r, e);
        g_set_error(error, OUTLINE_ERROR, OUTLINE_ERROR_SYNTAX,
                    "%s among the veins is a clone, which is not read (in Inkscape, Edit > Clone > Unlink Clone makes it a path)", name);
        g_free(name);
        return false;
    }
    r->drawn += svgelement_is_shape(e) || !strcmp(e->name, "use") || !strcmp(e->name, "text") || !strcmp(e->name, "image");
    return true;
}

static bool see_element(const SvgElement *e, void *user, GError **error)
{
    static const char *const open[] = {"path", "polyline", "line", NULL};
    Reader *r = user;
    r->has_veins |= is_veins(e) && !e->defined;
    if (is_outline(e) || is_called(e, "base") || is_called(e, "tip"))
        return true;
    if (!g_strv_contains(open, e->name) || e->defined || e->hidden)
        return see_other(r, e, error);
    bool wanted = nesting(e) > 0;
    if (!wanted && r->has_veins)
        return true;
    GError *fault = NULL;
    SvgPath *path = svgelement_path(e, &fault);
    if (path) {
        lay_down(path, r->place);
        take_path(r, e, path);
        svgpath_free(path);
        return true;
    }
    char *name = path_name(r, e);
    g_prefix_error(&fault, "%s: ", name);
    g_free(name);
    if (wanted || !r->skipped)
        g_propagate_error(wanted ? error : &r->skipped, fault);
    else
        g_error_free(fault);
    return !wanted;
}

/* ---- the drawing ---- */

/* Groups in groups say orders when no name does. */
static bool nesting_counts(const Reader *r)
{
    bool nested = false;
    for (guint k = 0; k < r->strokes->len; k++) {
        const Stroke *s = &g_array_index(r->strokes, Stroke, k);
        if (s->nested > 0 && s->said > 0)
            return false;
        nested |= s->nested > 1;
    }
    return nested;
}

static Drawing *make_drawing(const Reader *r)
{
    Drawing *d = drawing_new();
    bool by_nesting = nesting_counts(r);
    for (guint k = 0; k < r->strokes->len; k++) {
        const Stroke *s = &g_array_index(r->strokes, Stroke, k);
        if (r->has_veins && s->nested == 0)
            continue;
        DrawnVein *v = drawing_add(d, &g_array_index(s->points, Vec2, 0), NULL, s->points->len, s->said, s->name);
        for (uint32_t i = 0; i < v->n; i++)
            v->width[i] = s->width;
        if (by_nesting && v->order == 0)
            v->order = s->nested;
    }
    return d;
}

/* The drawing, or what is wrong with it. */
static Drawing *finish(Reader *r, GError **error)
{
    if (!r->has_veins && r->skipped) {
        g_set_error(error, IMPORT_ERROR, IMPORT_ERROR_SYNTAX, "%s: %s", r->file, r->skipped->message);
        return NULL;
    }
    Drawing *d = make_drawing(r);
    if (d->n > 0 || (r->has_veins && r->drawn == 0))
        return d;
    drawing_free(d);
    if (r->has_veins)
        g_set_error(error, IMPORT_ERROR, IMPORT_ERROR_GRAPH,
                    "%s: no vein: nothing in the layer or group \"veins\" is an open path that shows (%u object%s there closed, hidden or no path)", r->file, r->drawn,
                    r->drawn == 1 ? " is" : "s are");
    else
        g_set_error(error, IMPORT_ERROR, IMPORT_ERROR_GRAPH,
                    "%s: no vein: there is neither a layer \"veins\" nor an open path that shows (closed and hidden ones don't count)", r->file);
    return NULL;
}

Drawing *drawing_read_svg(const char *path, double flatness, const Affine *place, GError **error)
{
    Reader r = {.file = path, .flatness = flatness, .place = place, .strokes = g_array_new(FALSE, FALSE, sizeof(Stroke))};
    g_array_set_clear_func(r.strokes, stroke_clear);
    GError *cause = NULL;
    bool good = svgwalk_file(path, see_element, &r, &cause);
    if (cause && cause->domain == G_FILE_ERROR) {
        g_propagate_error(error, cause);
    } else if (cause) {
        g_set_error_literal(error, IMPORT_ERROR, IMPORT_ERROR_SYNTAX, cause->message);
        g_error_free(cause);
    }
    Drawing *d = good ? finish(&r, error) : NULL;
    g_array_unref(r.strokes);
    g_clear_error(&r.skipped);
    return d;
}
