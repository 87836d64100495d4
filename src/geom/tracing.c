#include "geom/tracing.h"

#include <stdio.h>
#include <string.h>

#include "geom/outline.h"
#include "geom/textfile.h"

enum { LARGEST_FILE = 16 << 20, SHOWN = 40 };

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

static bool bad_line(const char *file, guint number, const char *line, GError **error)
{
    char *valid = g_utf8_make_valid(line, -1), *shown = g_utf8_substring(valid, 0, MIN(g_utf8_strlen(valid, -1), SHOWN));
    g_set_error(error, OUTLINE_ERROR, OUTLINE_ERROR_SYNTAX,
                "%s:%u: '%s' is no point: in a text file the margin is one line x y for each point, y down, numbers from -1000000 to 1000000, without gaps; else "
                "it is an SVG file", file, number, g_strstrip(shown));
    g_free(shown);
    g_free(valid);
    return false;
}

static bool read_points(const char *file, char *text, GArray *points, GError **error)
{
    guint number = 1;
    bool ended = false;
    char *s = g_str_has_prefix(text, "\xEF\xBB\xBF") ? text + 3 : text;
    for (char *next; s; s = next, number++) {
        next = strchr(s, '\n');
        if (next)
            *next++ = '\0';
        Vec2 p;
        bool blank = *skip_gaps(s) == '\0';
        if (!blank && (ended || !read_point(s, &p)))
            return bad_line(file, ended ? number - 1 : number, ended ? "" : s, error);
        if (blank)
            ended = points->len > 0;
        else
            g_array_append_val(points, p);
    }
    return true;
}

/* As straight curves, y up, closed. */
static SvgPath *path_through(const GArray *points)
{
    SvgPath *path = g_new(SvgPath, 1);
    *path = (SvgPath){g_array_new(FALSE, FALSE, sizeof(Curve)), g_array_new(FALSE, FALSE, sizeof(Subpath))};
    for (guint i = 1; i < points->len; i++) {
        Vec2 a = g_array_index(points, Vec2, i - 1), b = g_array_index(points, Vec2, i);
        Curve c = curve_line(vec2(a.x, -a.y), vec2(b.x, -b.y));
        g_array_append_val(path->curves, c);
    }
    Subpath sub = {.first = 0, .closed = true};
    if (path->curves->len > 0)
        g_array_append_val(path->subpaths, sub);
    return path;
}

bool tracing_read(const char *file, SvgShape *out, GError **error)
{
    char *text;
    gsize length;
    GError *cause = NULL;
    if (!textfile_read(file, LARGEST_FILE, &text, &length, &cause)) {
        g_set_error_literal(error, OUTLINE_ERROR, OUTLINE_ERROR_READ, cause->message);
        g_error_free(cause);
        return false;
    }
    GArray *points = g_array_new(FALSE, FALSE, sizeof(Vec2));
    bool good = strlen(text) == length ? read_points(file, text, points, error) : bad_line(file, 1, "a zero byte", error);
    if (good)
        *out = (SvgShape){.path = path_through(points)};
    g_array_unref(points);
    g_free(text);
    return good;
}
