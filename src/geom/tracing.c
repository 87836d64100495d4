#include "geom/tracing.h"

#include <stdio.h>
#include <string.h>

#include "geom/outline.h"
#include "geom/textfile.h"
#include "geom/winding.h"

enum { LARGEST_FILE = 16 << 20, SHOWN = 40, MOST_LINES = 1000 };

static const char *skip_gaps(const char *s)
{
    while (tracing_is_gap(*s))
        s++;
    return s;
}

bool tracing_is(const char *file)
{
    char head[64] = "";
    FILE *f = g_file_test(file, G_FILE_TEST_IS_REGULAR) ? fopen(file, "rb") : NULL;
    gsize n = f ? fread(head, 1, sizeof head - 1, f) : 0;
    if (f)
        fclose(f);
    head[n] = '\0';
    const char *s = g_str_has_prefix(head, "\xEF\xBB\xBF") ? head + 3 : head;
    while (g_ascii_isspace(*s))
        s++;
    if (*s == '-' || *s == '+')
        s++;
    return g_ascii_isdigit(*s) || (*s == '.' && g_ascii_isdigit(s[1]));
}

static bool read_number(const char **s, double *out)
{
    char *end;
    *out = g_ascii_strtod(*s, &end);
    if (end == *s || !(*end == '\0' || tracing_is_gap(*end)) || !(fabs(*out) <= TRACING_FARTHEST))
        return false;
    *s = skip_gaps(end);
    return true;
}

/* A line without its end. */
static bool read_point(const char *line, Vec2 *p)
{
    const char *s = skip_gaps(line);
    return read_number(&s, &p->x) && read_number(&s, &p->y) && *s == '\0';
}

/* What is being read. */
typedef struct {
    const char *file;
    GArray *points, *line; /* Vec2, y down; the line of the file where each is */
    GArray *start;         /* of each closed line, and the end of all */
    GError **error;
} Reading;

static bool bad_line(const Reading *r, guint number, const char *line)
{
    char *valid = g_utf8_make_valid(line, -1), *shown = g_utf8_substring(valid, 0, MIN(g_utf8_strlen(valid, -1), SHOWN));
    g_set_error(r->error, OUTLINE_ERROR, OUTLINE_ERROR_SYNTAX,
                "%s:%u: '%s' is no point: in a text file the margin is one line x y for each point, y down, numbers from -1000000 to 1000000; else it is an SVG file",
                r->file, number, g_strstrip(shown));
    g_free(shown);
    g_free(valid);
    return false;
}

static guint line_of(const Reading *r, guint point) { return g_array_index(r->line, guint, point); }

static bool bad_shape(const Reading *r, guint point, const char *format, ...) G_GNUC_PRINTF(3, 4);

static bool bad_shape(const Reading *r, guint point, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    char *what = g_strdup_vprintf(format, args);
    va_end(args);
    g_set_error(r->error, OUTLINE_ERROR, OUTLINE_ERROR_SHAPE, "%s:%u: %s", r->file, line_of(r, point), what);
    g_free(what);
    return false;
}

/* Each point once: a double click is one, and so is an end that is the beginning again. */
static void add_point(Reading *r, Vec2 p, guint number, guint first)
{
    const Vec2 *last = r->points->len > first ? &g_array_index(r->points, Vec2, r->points->len - 1) : NULL;
    if (last && last->x == p.x && last->y == p.y)
        return;
    g_array_append_val(r->points, p);
    g_array_append_val(r->line, number);
}

static bool end_line(Reading *r, guint first)
{
    guint n = r->points->len - first;
    Vec2 *p = &g_array_index(r->points, Vec2, first);
    if (n == 0)
        return true;
    if (n > 3 && p[0].x == p[n - 1].x && p[0].y == p[n - 1].y) {
        g_array_set_size(r->points, first + n - 1);
        g_array_set_size(r->line, first + n - 1);
    }
    g_array_append_val(r->start, r->points->len);
    if (r->start->len - 1 > MOST_LINES)
        return bad_shape(r, first, "there are over %d lines around the blade; a blank line parts them", MOST_LINES);
    return true;
}

static bool read_points(Reading *r, char *text)
{
    guint number = 1, first = 0;
    char *s = g_str_has_prefix(text, "\xEF\xBB\xBF") ? text + 3 : text;
    for (char *next; s; s = next, number++) {
        next = strchr(s, '\n');
        if (next)
            *next++ = '\0';
        Vec2 p;
        if (*skip_gaps(s) == '\0') {
            if (!end_line(r, first))
                return false;
            first = r->points->len;
        } else if (read_point(s, &p)) {
            add_point(r, p, number, first);
        } else {
            return bad_line(r, number, s);
        }
    }
    return end_line(r, first);
}

/* ---- the blade ---- */

/* As straight curves, y up, closed. */
static SvgPath *path_through(const Vec2 *p, guint n)
{
    SvgPath *path = g_new(SvgPath, 1);
    *path = (SvgPath){g_array_new(FALSE, FALSE, sizeof(Curve)), g_array_new(FALSE, FALSE, sizeof(Subpath))};
    for (guint i = 1; i < n; i++) {
        Curve c = curve_line(vec2(p[i - 1].x, -p[i - 1].y), vec2(p[i].x, -p[i].y));
        g_array_append_val(path->curves, c);
    }
    Subpath sub = {.first = 0, .closed = true};
    if (path->curves->len > 0)
        g_array_append_val(path->subpaths, sub);
    return path;
}

static bool refuse_margin(const Reading *r, const Winding *w)
{
    if (w->kind == WINDING_TANGLE)
        return bad_shape(r, 0, "the margin, from here on, is a tangle, with more crossings than a drawing has");
    if (w->kind == WINDING_EMPTY)
        return bad_shape(r, 0, "the margin, from here on, encloses no area");
    return bad_shape(r, w->part[1], "what is traced from here on, %.3g px², meets the rest, %.3g px² from line %u on, in no more than a point; a blade is one "
                     "area, in which lobes may overlap", w->area[1], w->area[0], line_of(r, w->part[0]));
}

/* What all lines wind around. */
static bool find_margin(const Reading *r, SvgShape *out)
{
    const Vec2 *p = &g_array_index(r->points, Vec2, 0);
    Winding w;
    winding_find(p, &g_array_index(r->start, guint, 0), r->start->len - 1, &w);
    bool good = w.kind == WINDING_SIMPLE || w.kind == WINDING_UNITED;
    if (good)
        *out = (SvgShape){.path = path_through(&g_array_index(w.margin, Vec2, 0), w.margin->len), .has_base = w.first_in, .base = vec2(p[0].x, -p[0].y)};
    else
        refuse_margin(r, &w);
    winding_clear(&w);
    return good;
}

/* A line that is too short is the outline's to refuse. */
static bool take_points(const Reading *r, bool half, SvgShape *out)
{
    if (half && r->start->len > 2)
        return bad_shape(r, g_array_index(r->start, guint, 1), "a second line begins; of a half that is mirrored there is one");
    if (!half && (r->start->len > 2 || r->points->len > 3))
        return find_margin(r, out);
    *out = (SvgShape){.path = path_through((const Vec2 *)(const void *)r->points->data, r->points->len)};
    return true;
}

bool tracing_read(const char *file, bool half, SvgShape *out, GError **error)
{
    char *text;
    gsize length;
    GError *cause = NULL;
    if (!textfile_read(file, LARGEST_FILE, &text, &length, &cause)) {
        g_set_error_literal(error, OUTLINE_ERROR, OUTLINE_ERROR_READ, cause->message);
        g_error_free(cause);
        return false;
    }
    Reading r = {file, g_array_new(FALSE, FALSE, sizeof(Vec2)), g_array_new(FALSE, FALSE, sizeof(guint)), g_array_new(FALSE, TRUE, sizeof(guint)), error};
    g_array_set_size(r.start, 1);
    bool good = strlen(text) == length ? read_points(&r, text) && take_points(&r, half, out) : bad_line(&r, 1, "a zero byte");
    g_array_unref(r.points);
    g_array_unref(r.line);
    g_array_unref(r.start);
    g_free(text);
    return good;
}
