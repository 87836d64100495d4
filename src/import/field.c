#include "import/field.h"

#include <math.h>
#include <string.h>

#include "import/import.h"
#include "import/names.h"

/* Largest width, segments, and one over the smallest: whatever width.exponent and width.minimum, flows stay finite and above 0. */
#define WIDEST 1e24
/* GraphML's int has 32 bits. */
#define LARGEST_INT 2147483647.0

typedef enum { REAL, WHOLE, KIND, POINT, POINTS } Type;

static const struct {
    Domain domain;
    const char *name;
    Type type;
    double least, most;
    const char *allowed;
} fields[FIELD_COUNT] = {
    [FIELD_X] = {DOMAIN_NODE, "x", REAL, -FIELD_LARGEST, FIELD_LARGEST, "a number from -1e9 to 1e9, in segments"},
    [FIELD_Y] = {DOMAIN_NODE, "y", REAL, -FIELD_LARGEST, FIELD_LARGEST, "a number from -1e9 to 1e9, in segments"},
    [FIELD_NODE_BIRTH] = {DOMAIN_NODE, "birth", WHOLE, 0, LARGEST_INT, "a whole number from 0 to 2147483647"},
    [FIELD_KIND] = {DOMAIN_EDGE, "kind", KIND, 0, 0, "vein or anastomosis"},
    [FIELD_ORDER] = {DOMAIN_EDGE, "order", WHOLE, 1, 255, "a whole number from 1 to 255"},
    [FIELD_RANK] = {DOMAIN_EDGE, "rank", WHOLE, 1, 255, "a whole number from 1 to 255"},
    [FIELD_VEIN] = {DOMAIN_EDGE, "vein", WHOLE, 0, LARGEST_INT, "a whole number from 0 to 2147483647"},
    [FIELD_WIDTH] = {DOMAIN_EDGE, "width", REAL, 1.0 / WIDEST, WIDEST, "a number above 0, from 1e-24 to 1e24, in segments"},
    [FIELD_FLOW] = {DOMAIN_EDGE, "flow", REAL, 1e-305, 1e305, "a number above 0"},
    [FIELD_BIRTH] = {DOMAIN_EDGE, "birth", WHOLE, 0, LARGEST_INT, "a whole number from 0 to 2147483647"},
    [FIELD_MARGIN] = {DOMAIN_GRAPH, "margin", POINTS, -FIELD_LARGEST, FIELD_LARGEST, "points x,y x,y … of numbers from -1e9 to 1e9, in segments"},
    [FIELD_HOLES] = {DOMAIN_GRAPH, "holes", POINTS, -FIELD_LARGEST, FIELD_LARGEST, "points x,y x,y … of numbers from -1e9 to 1e9, in segments, with ';' between holes"},
    [FIELD_BASE] = {DOMAIN_GRAPH, "base", POINT, -FIELD_LARGEST, FIELD_LARGEST, "a point x,y of numbers from -1e9 to 1e9, in segments"},
    [FIELD_TIP] = {DOMAIN_GRAPH, "tip", POINT, -FIELD_LARGEST, FIELD_LARGEST, "a point x,y of numbers from -1e9 to 1e9, in segments"},
    [FIELD_STEPS] = {DOMAIN_GRAPH, "steps", WHOLE, 0, LARGEST_INT, "a whole number from 0 to 2147483647"},
};

Domain field_domain(FieldId field) { return fields[field].domain; }

const char *field_name(FieldId field) { return fields[field].name; }

FieldId field_find(Domain domain, const char *name)
{
    guint i = 0;
    while (i < FIELD_COUNT && (fields[i].domain != domain || strcmp(fields[i].name, name) != 0))
        i++;
    return (FieldId)i;
}

/* Plain decimals of up to 15 digits, as nearly all are: the digits and the power of ten are exact as doubles, so one division rounds
 * as strtod does. FALSE for any other text. */
static bool short_number(const char *at, const char *end, double *out)
{
    static const double power[] = {1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
    bool negative = at < end && *at == '-';
    const char *first = at + negative, *point = NULL;
    uint64_t digits = 0;
    if (end - first > 16 || first == end)
        return false;
    for (const char *c = first; c < end; c++) {
        if (*c == '.' && point == NULL)
            point = c;
        else if (g_ascii_isdigit(*c))
            digits = digits * 10 + (uint64_t)(*c - '0');
        else
            return false;
    }
    gsize n = (gsize)(end - first) - (point != NULL), decimals = point != NULL ? (gsize)(end - point) - 1 : 0;
    if (n == 0 || n > 15)
        return false;
    *out = (negative ? -(double)digits : (double)digits) / power[decimals];
    return true;
}

/* A finite number that is all of [at, end); what follows is the end of the text or no part of a number. */
static bool number(const char *at, const char *end, double *out)
{
    if (short_number(at, end, out))
        return true;
    for (const char *c = at; c < end; c++) /* strtod would take 0x10, inf, nan, and blanks before them */
        if (!g_ascii_isdigit(*c) && strchr("+-.eE", *c) == NULL)
            return false;
    char *stop;
    *out = g_ascii_strtod(at, &stop);
    return at < end && stop == end && isfinite(*out);
}

static bool parse(FieldId field, const char *at, const char *end, double *out)
{
    if (fields[field].type == KIND) {
        bool vein = end - at == 4 && memcmp(at, "vein", 4) == 0, join = end - at == 11 && memcmp(at, "anastomosis", 11) == 0;
        *out = join ? EDGE_ANASTOMOSIS : EDGE_VEIN;
        return vein || join;
    }
    return number(at, end, out) && *out >= fields[field].least && *out <= fields[field].most &&
           (fields[field].type != WHOLE || *out == floor(*out));
}

/* Without blanks on either side. */
static void strip(const char **at, const char **end)
{
    while (*at < *end && g_ascii_isspace(**at))
        (*at)++;
    while (*end > *at && g_ascii_isspace((*end)[-1]))
        (*end)--;
}

static gboolean fail_value(FieldId field, const char *at, const char *end, GError **error)
{
    char *bare = g_strndup(at, (gsize)(end - at)), *found = names_quote(bare);
    g_set_error(error, IMPORT_ERROR, IMPORT_ERROR_SYNTAX, "%s is %s; it must be %s", fields[field].name, found, fields[field].allowed);
    g_free(found);
    g_free(bare);
    return FALSE;
}

gboolean field_value(FieldId field, const char *text, gsize length, double *out, GError **error)
{
    const char *at = text, *end = text + length;
    strip(&at, &end);
    return parse(field, at, end, out) || fail_value(field, at, end, error);
}

static bool parse_point(const char *at, const char *end, Vec2 *out)
{
    const char *comma = memchr(at, ',', (gsize)(end - at));
    return comma != NULL && parse(FIELD_MARGIN, at, comma, &out->x) && parse(FIELD_MARGIN, comma + 1, end, &out->y);
}

gboolean field_point(FieldId field, const char *text, gsize length, Vec2 *out, GError **error)
{
    const char *at = text, *end = text + length;
    strip(&at, &end);
    return parse_point(at, end, out) || fail_value(field, at, end, error);
}

/* Would they be written as one point? (export.h: in millionths of a segment) */
static bool same(Vec2 a, Vec2 b) { return rint(a.x * 1e6) == rint(b.x * 1e6) && rint(a.y * 1e6) == rint(b.y * 1e6); }

/* All points of the text; NULL with an error for one that is none. */
static GArray *parse_points(FieldId field, const char *text, gsize length, GError **error)
{
    GArray *points = g_array_new(FALSE, FALSE, sizeof(Vec2));
    const char *end = text + length;
    for (const char *at = text; at < end;) {
        const char *stop = at;
        while (stop < end && !g_ascii_isspace(*stop))
            stop++;
        Vec2 p;
        if (stop > at && !parse_point(at, stop, &p)) {
            char *bare = g_strndup(at, (gsize)(stop - at)), *found = names_quote(bare);
            g_set_error(error, IMPORT_ERROR, IMPORT_ERROR_SYNTAX, "%s has the point %s; it must be %s", fields[field].name, found,
                        fields[field].allowed);
            g_free(found);
            g_free(bare);
            g_array_unref(points);
            return NULL;
        }
        if (stop > at)
            g_array_append_val(points, p);
        at = stop + 1;
    }
    return points;
}

static void leave_out_repeated(GArray *points)
{
    Vec2 *p = (Vec2 *)(gpointer)points->data;
    guint n = 0;
    for (guint i = 0; i < points->len; i++)
        if (n == 0 || !same(p[i], p[n - 1]))
            p[n++] = p[i];
    while (n > 1 && same(p[0], p[n - 1]))
        n--;
    g_array_set_size(points, n);
}

Polygon *field_outline(GArray *points, GError **error)
{
    Polygon *margin = NULL;
    uint32_t i, j;
    leave_out_repeated(points);
    if (points->len < 3)
        g_set_error(error, IMPORT_ERROR, IMPORT_ERROR_GRAPH, "margin has %u different point%s; an outline needs at least 3", points->len,
                    points->len == 1 ? "" : "s");
    else
        margin = polygon_new((const Vec2 *)(gpointer)points->data, points->len);
    g_array_unref(points);
    if (margin == NULL || !polygon_crossing(margin, &i, &j))
        return margin;
    Vec2 a = margin->v[i], b = margin->v[(i + 1) % margin->n], c = margin->v[j], d = margin->v[(j + 1) % margin->n];
    g_set_error(error, IMPORT_ERROR, IMPORT_ERROR_GRAPH,
                "margin meets itself: its edges %.7g,%.7g – %.7g,%.7g and %.7g,%.7g – %.7g,%.7g touch or cross; an outline must not", a.x,
                a.y, b.x, b.y, c.x, c.y, d.x, d.y);
    polygon_free(margin);
    return NULL;
}

Polygon *field_margin(const char *text, gsize length, GError **error)
{
    GArray *points = parse_points(FIELD_MARGIN, text, length, error);
    return points != NULL ? field_outline(points, error) : NULL;
}

/* One hole. FALSE when it has a point that is none, or fewer than three different ones. */
static gboolean add_hole(Holes *h, const char *text, gsize length, GError **error)
{
    GArray *points = parse_points(FIELD_HOLES, text, length, error);
    if (points == NULL)
        return FALSE;
    leave_out_repeated(points);
    gboolean ok = points->len >= 3;
    if (ok)
        holes_add(h, (const Vec2 *)(gpointer)points->data, points->len);
    else
        g_set_error(error, IMPORT_ERROR, IMPORT_ERROR_GRAPH, "hole %u of holes has %u different point%s; a hole needs at least 3", h->n + 1, points->len,
                    points->len == 1 ? "" : "s");
    g_array_unref(points);
    return ok;
}

Holes *field_holes(const char *text, gsize length, GError **error)
{
    Holes *h = holes_new();
    const char *end = text + length;
    for (const char *at = text; at < end;) {
        const char *stop = memchr(at, ';', (gsize)(end - at));
        stop = stop != NULL ? stop : end;
        if (!add_hole(h, at, (gsize)(stop - at), error)) {
            holes_free(h);
            return NULL;
        }
        at = stop + 1;
    }
    return h;
}
