#include "geom/svgpath.h"

#include "geom/svgscan.h"

#include <string.h>

typedef struct {
    SvgPath *path;
    Vec2 here, start; /* current point, start of the subpath */
    Vec2 control;     /* last control point, which S and T reflect */
    char last;        /* last command, in capitals */
    bool fresh;       /* the next curve begins a subpath */
} Pen;

/* Arguments of a command, by capital letter; -1: no command. */
static int argument_count(char command)
{
    switch (g_ascii_toupper(command)) {
    case 'Z':
        return 0;
    case 'H':
    case 'V':
        return 1;
    case 'M':
    case 'L':
    case 'T':
        return 2;
    case 'S':
    case 'Q':
        return 4;
    case 'C':
        return 6;
    case 'A':
        return 7;
    default:
        return -1;
    }
}

/* Opens a subpath when none is open. */
static void pen_down(Pen *pen)
{
    if (!pen->fresh)
        return;
    Subpath subpath = {pen->path->curves->len, false};
    g_array_append_val(pen->path->subpaths, subpath);
    pen->fresh = false;
}

static void pen_curve(Pen *pen, Curve curve)
{
    pen_down(pen);
    g_array_append_val(pen->path->curves, curve);
    pen->here = curve.p[3];
}

static void pen_line(Pen *pen, Vec2 to) { pen_curve(pen, curve_line(pen->here, to)); }

static void pen_cubic(Pen *pen, Vec2 c1, Vec2 c2, Vec2 to)
{
    pen_curve(pen, (Curve){{pen->here, c1, c2, to}, false});
    pen->control = c2;
}

static void pen_quadratic(Pen *pen, Vec2 control, Vec2 to)
{
    pen_curve(pen, curve_quadratic(pen->here, control, to));
    pen->control = control;
}

static void pen_arc(Pen *pen, const double a[7], Vec2 to)
{
    if (vec_dist2(pen->here, to) == 0.0)
        return;
    pen_down(pen);
    curve_arc(pen->path->curves, pen->here, to, a[0], a[1], a[2], a[3] != 0.0, a[4] != 0.0);
    pen->here = to;
}

static void pen_close(Pen *pen)
{
    if (!pen->fresh)
        g_array_index(pen->path->subpaths, Subpath, pen->path->subpaths->len - 1).closed = true;
    pen->here = pen->start;
    pen->fresh = true;
}

static void pen_move(Pen *pen, Vec2 to)
{
    pen->here = pen->start = to;
    pen->fresh = true;
}

/* The last control point reflected, if the last command was of the same kind. */
static Vec2 reflected(const Pen *pen, const char *kind)
{
    return pen->last && strchr(kind, pen->last) ? vec_sub(vec_scale(pen->here, 2.0), pen->control) : pen->here;
}

static void pen_do(Pen *pen, char command, const double a[7])
{
    char capital = g_ascii_toupper(command);
    Vec2 from = capital == command ? vec2(0.0, 0.0) : pen->here;
    Vec2 p[3] = {{from.x + a[0], from.y + a[1]}, {from.x + a[2], from.y + a[3]}, {from.x + a[4], from.y + a[5]}};
    switch (capital) {
    case 'M':
        pen_move(pen, p[0]);
        break;
    case 'L':
        pen_line(pen, p[0]);
        break;
    case 'H':
        pen_line(pen, vec2(p[0].x, pen->here.y));
        break;
    case 'V':
        pen_line(pen, vec2(pen->here.x, from.y + a[0]));
        break;
    case 'C':
        pen_cubic(pen, p[0], p[1], p[2]);
        break;
    case 'S':
        pen_cubic(pen, reflected(pen, "CS"), p[0], p[1]);
        break;
    case 'Q':
        pen_quadratic(pen, p[0], p[1]);
        break;
    case 'T':
        pen_quadratic(pen, reflected(pen, "QT"), p[0]);
        break;
    case 'A':
        pen_arc(pen, a, vec2(from.x + a[5], from.y + a[6]));
        break;
    default:
        pen_close(pen);
    }
    pen->last = capital;
}

static bool read_arguments(SvgScan *s, char command, double a[7], GError **error)
{
    bool arc = g_ascii_toupper(command) == 'A';
    for (int k = 0; k < argument_count(command); k++) {
        if (k > 0)
            svgscan_comma(s);
        if (!(arc && (k == 3 || k == 4) ? svgscan_flag(s, &a[k], error) : svgscan_number(s, &a[k], error)))
            return false;
    }
    return true;
}

/* One command with its arguments, however often they are repeated. */
static bool read_command(SvgScan *s, Pen *pen, GError **error)
{
    char command = *s->at;
    if (argument_count(command) < 0 || command == '\0')
        return svgscan_fail(s, "a path command", error);
    if (!pen->last && g_ascii_toupper(command) != 'M')
        return svgscan_fail(s, "M, which begins a path", error);
    s->at++;
    svgscan_space(s);
    bool more;
    do {
        double a[7] = {0.0};
        if (!read_arguments(s, command, a, error))
            return false;
        pen_do(pen, command, a);
        if (argument_count(command) == 0)
            return true;
        command = command == 'M' ? 'L' : command == 'm' ? 'l' : command;
        more = svgscan_comma(s) || svgscan_at_number(s);
    } while (more);
    return true;
}

static Pen pen_new(void)
{
    SvgPath *path = g_new0(SvgPath, 1);
    path->curves = g_array_new(FALSE, FALSE, sizeof(Curve));
    path->subpaths = g_array_new(FALSE, FALSE, sizeof(Subpath));
    return (Pen){.path = path, .fresh = true};
}

SvgPath *svgpath_parse(const char *data, GError **error)
{
    SvgScan scan = {data, data};
    Pen pen = pen_new();
    for (svgscan_space(&scan); *scan.at; svgscan_space(&scan)) {
        if (!read_command(&scan, &pen, error)) {
            svgpath_free(pen.path);
            return NULL;
        }
    }
    return pen.path;
}

/* --- other shapes --- */

static void pen_round(Pen *pen, double rx, double ry, Vec2 to) { pen_arc(pen, (double[7]){rx, ry, 0.0, 0.0, 1.0}, to); }

SvgPath *svgpath_ellipse(Vec2 centre, double rx, double ry)
{
    Pen pen = pen_new();
    if (rx > 0.0 && ry > 0.0) {
        Vec2 low = vec2(centre.x, centre.y + ry), high = vec2(centre.x, centre.y - ry);
        pen_move(&pen, low);
        pen_round(&pen, rx, ry, high);
        pen_round(&pen, rx, ry, low);
        pen_close(&pen);
    }
    return pen.path;
}

SvgPath *svgpath_rectangle(Vec2 corner, double width, double height, double rx, double ry)
{
    Pen pen = pen_new();
    if (!(width > 0.0 && height > 0.0))
        return pen.path;
    double x0 = corner.x, y0 = corner.y, x1 = x0 + width, y1 = y0 + height;
    bool rounded = rx > 0.0 && ry > 0.0;
    rx = !rounded ? 0.0 : rx < 0.5 * width ? rx : 0.5 * width;
    ry = !rounded ? 0.0 : ry < 0.5 * height ? ry : 0.5 * height;
    const Vec2 from[] = {{x0 + rx, y0}, {x1, y0 + ry}, {x1 - rx, y1}, {x0, y1 - ry}};
    const Vec2 to[] = {{x1 - rx, y0}, {x1, y1 - ry}, {x0 + rx, y1}, {x0, y0 + ry}};
    pen_move(&pen, from[0]);
    for (int side = 0; side < 4; side++) {
        if (vec_dist2(from[side], to[side]) > 0.0)
            pen_line(&pen, to[side]);
        if (rounded)
            pen_round(&pen, rx, ry, from[(side + 1) % 4]);
    }
    pen_close(&pen);
    return pen.path;
}

SvgPath *svgpath_points(const char *data, bool closed, GError **error)
{
    SvgScan scan = {data, data};
    Pen pen = pen_new();
    svgscan_space(&scan);
    for (bool first = true; *scan.at; first = false) {
        Vec2 p;
        if (!svgscan_number(&scan, &p.x, error) || (svgscan_comma(&scan), !svgscan_number(&scan, &p.y, error))) {
            svgpath_free(pen.path);
            return NULL;
        }
        if (first)
            pen_move(&pen, p);
        else
            pen_line(&pen, p);
        svgscan_comma(&scan);
    }
    if (closed)
        pen_close(&pen);
    return pen.path;
}

void svgpath_free(SvgPath *path)
{
    if (!path)
        return;
    g_array_unref(path->curves);
    g_array_unref(path->subpaths);
    g_free(path);
}

static guint subpath_first(const SvgPath *path, guint subpath)
{
    return subpath < path->subpaths->len ? g_array_index(path->subpaths, Subpath, subpath).first : path->curves->len;
}

Box2 svgpath_box(const SvgPath *path, guint subpath)
{
    Box2 box = box_empty();
    for (guint k = subpath_first(path, subpath); k < subpath_first(path, subpath + 1); k++)
        for (int i = 0; i < 4; i++)
            box = box_add(box, g_array_index(path->curves, Curve, k).p[i]);
    return box;
}

GArray *svgpath_flatten(const SvgPath *path, guint subpath, double flatness)
{
    GArray *points = g_array_new(FALSE, FALSE, sizeof(Vec2));
    guint first = subpath_first(path, subpath);
    for (guint k = first; k < subpath_first(path, subpath + 1); k++) {
        const Curve *curve = &g_array_index(path->curves, Curve, k);
        if (k == first)
            g_array_append_val(points, curve->p[0]);
        curve_flatten(curve, flatness, points);
    }
    return points;
}
