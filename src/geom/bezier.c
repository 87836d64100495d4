#include "geom/bezier.h"

/* Halvings of one curve: a million chords, beyond any flatness that is allowed. */
enum { MAX_DEPTH = 20 };

static Vec2 mid(Vec2 a, Vec2 b) { return vec2(0.5 * (a.x + b.x), 0.5 * (a.y + b.y)); }

Curve curve_line(Vec2 a, Vec2 b)
{
    return (Curve){{a, vec_lerp(a, b, 1.0 / 3.0), vec_lerp(a, b, 2.0 / 3.0), b}, true};
}

Curve curve_quadratic(Vec2 a, Vec2 control, Vec2 b)
{
    return (Curve){{a, vec_lerp(a, control, 2.0 / 3.0), vec_lerp(b, control, 2.0 / 3.0), b}, false};
}

/* A curve lies within |(u, v)| / 4 of its chord, u and v the larger offsets of its control points, times 3, from the
 * chord's thirds (R. Willcocks' bound). */
static bool is_flat(const Vec2 p[4], double flatness)
{
    Vec2 a = vec_sub(vec_sub(vec_scale(p[1], 3.0), vec_scale(p[0], 2.0)), p[3]);
    Vec2 b = vec_sub(vec_sub(vec_scale(p[2], 3.0), vec_scale(p[3], 2.0)), p[0]);
    double u = a.x * a.x > b.x * b.x ? a.x * a.x : b.x * b.x;
    double v = a.y * a.y > b.y * b.y ? a.y * a.y : b.y * b.y;
    return u + v <= 16.0 * flatness * flatness;
}

static void flatten(const Vec2 p[4], double flatness, int depth, GArray *points)
{
    if (depth == MAX_DEPTH || is_flat(p, flatness)) {
        g_array_append_val(points, p[3]);
        return;
    }
    Vec2 ab = mid(p[0], p[1]), bc = mid(p[1], p[2]), cd = mid(p[2], p[3]);
    Vec2 abc = mid(ab, bc), bcd = mid(bc, cd), m = mid(abc, bcd);
    flatten((Vec2[4]){p[0], ab, abc, m}, flatness, depth + 1, points);
    flatten((Vec2[4]){m, bcd, cd, p[3]}, flatness, depth + 1, points);
}

void curve_flatten(const Curve *curve, double flatness, GArray *points)
{
    if (curve->line)
        g_array_append_val(points, curve->p[3]);
    else
        flatten(curve->p, flatness, 0, points);
}

void degrees_sincos(double degrees, double *sine, double *cosine)
{
    static const double pi = 3.14159265358979323846;
    if (!(fabs(degrees) <= 1e12))
        degrees = 0.0;
    double r = degrees - 360.0 * floor(degrees / 360.0);
    int quarter = (int)floor(r / 90.0 + 0.5);
    double x = (r - 90.0 * quarter) * pi / 180.0, x2 = x * x, s = 1.0, c = 1.0;
    for (int k = 18; k >= 2; k -= 2) { /* |x| <= pi/4: Taylor series, the rest below 1e-19 */
        s = 1.0 - s * x2 / (double)(k * (k + 1));
        c = 1.0 - c * x2 / (double)(k * (k - 1));
    }
    s *= x;
    const double turned[4][2] = {{s, c}, {c, -s}, {-s, -c}, {-c, s}};
    *sine = turned[quarter & 3][0];
    *cosine = turned[quarter & 3][1];
}

/* The ellipse of an arc: the unit circle about `centre`, scaled by the radii, turned, and moved to `middle`. */
typedef struct {
    Vec2 middle, centre;
    double rx, ry, sine, cosine;
    double way; /* 1 from x towards y, else -1 */
} Ellipse;

static Vec2 ellipse_point(const Ellipse *e, Vec2 u)
{
    double x = e->rx * (u.x + e->centre.x), y = e->ry * (u.y + e->centre.y);
    return vec2(e->middle.x + e->cosine * x - e->sine * y, e->middle.y + e->sine * x + e->cosine * y);
}

static Vec2 quarter_turn(Vec2 u) { return vec2(-u.y, u.x); }
static Vec2 unit(Vec2 u) { return vec_scale(u, 1.0 / sqrt(vec_norm2(u))); }

/* The unit vector half way from u to v: across their chord, or along their sum where the chord is short. */
static Vec2 arc_middle(Vec2 u, Vec2 v, double way, bool large)
{
    if (vec_dot(u, v) < 0.0)
        return unit(vec_scale(quarter_turn(vec_sub(u, v)), way));
    return unit(vec_scale(vec_add(u, v), large ? -1.0 : 1.0));
}

/* Control points stand off the ends by 4/3 tan(angle/4), found from the cosine by half-angle formulas. */
static void arc_emit(const Ellipse *e, Vec2 u, Vec2 v, GArray *curves)
{
    double c = vec_dot(u, v), s = fabs(vec_cross(u, v));
    double half_cosine = sqrt(0.5 * (1.0 + c)), half_sine = 0.5 * s / half_cosine;
    double k = e->way * (4.0 / 3.0) * half_sine / (1.0 + half_cosine);
    Curve curve = {{ellipse_point(e, u), ellipse_point(e, vec_add(u, vec_scale(quarter_turn(u), k))),
                    ellipse_point(e, vec_sub(v, vec_scale(quarter_turn(v), k))), ellipse_point(e, v)},
                   false};
    g_array_append_val(curves, curve);
}

static void arc_split(const Ellipse *e, Vec2 u, Vec2 v, bool large, GArray *curves)
{
    if (!large && !(vec_dot(u, v) < 0.92)) {
        arc_emit(e, u, v, curves);
        return;
    }
    Vec2 m = arc_middle(u, v, e->way, large);
    arc_split(e, u, m, false, curves);
    arc_split(e, m, v, false, curves);
}

/* SVG 1.1, F.6.5, in coordinates where the ellipse is the unit circle and the middle of the chord the origin. */
void curve_arc(GArray *curves, Vec2 a, Vec2 b, double rx, double ry, double degrees, bool large, bool sweep)
{
    Ellipse e = {.middle = mid(a, b), .rx = fabs(rx), .ry = fabs(ry), .way = sweep ? 1.0 : -1.0};
    degrees_sincos(degrees, &e.sine, &e.cosine);
    Vec2 h = vec_scale(vec_sub(a, b), 0.5);
    Vec2 p = vec2((e.cosine * h.x + e.sine * h.y) / e.rx, (e.cosine * h.y - e.sine * h.x) / e.ry);
    double d2 = vec_norm2(p);
    if (!(e.rx > 1e-60 && e.ry > 1e-60 && d2 > 1e-60)) {
        Curve line = curve_line(a, b);
        g_array_append_val(curves, line);
        return;
    }
    if (d2 >= 1.0) {
        double d = sqrt(d2);
        e.rx *= d;
        e.ry *= d;
        p = vec_scale(p, 1.0 / d);
    } else {
        double k = sqrt((1.0 - d2) / d2);
        e.centre = vec_scale(quarter_turn(p), large == sweep ? k : -k);
    }
    guint first = curves->len;
    arc_split(&e, unit(vec_sub(p, e.centre)), unit(vec_sub(vec_scale(p, -1.0), e.centre)), large && d2 < 1.0, curves);
    g_array_index(curves, Curve, first).p[0] = a;
    g_array_index(curves, Curve, curves->len - 1).p[3] = b;
}
