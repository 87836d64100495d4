#include "geom/outline.h"

#include "geom/segment.h"
#include "geom/svgfile.h"
#include "geom/svgpath.h"
#include "geom/svgscan.h"
#include "geom/teeth.h"
#include "geom/tracing.h"

/* Leaves are at most this many times as large as they are long from base to tip, their mean width is at least this part
 * of their size (a long pine needle's is 0.004), and they have at most this many vertices.
 */
static const double largest = 1000.0, thinnest = 0.001;
enum { MAX_VERTICES = 1000000, MAX_TEETH = 100000 };

G_DEFINE_QUARK(outline-error-quark, outline_error)

/* Ovate and acuminate, a little over half as wide as long. */
static const char ovate[] = "M 0 0 C 0.065 0.01 0.155 0.06 0.21 0.15 C 0.265 0.24 0.285 0.36 0.26 0.48 "
                            "C 0.235 0.6 0.145 0.72 0.08 0.83 C 0.049 0.8825 0.016 0.94 0 1";

OutlineDef outline_def_default(void)
{
    return (OutlineDef){.path = ovate,
                        .where = "the default outline",
                        .mirror = true,
                        .flatness = 2e-4,
                        .tooth_skew = 0.5,
                        .tooth_from = 0.05,
                        .tooth_to = 0.97};
}

/* What is being made. Once `margin` is in leaf coordinates, base and tip still are in the drawing's (y up). */
typedef struct {
    const OutlineDef *def;
    SvgShape shape;
    GArray *margin; /* Vec2 */
    Vec2 base, tip;
} Maker;

static bool fail_shape(GError **error, const char *format, ...) G_GNUC_PRINTF(2, 3);

static bool fail_shape(GError **error, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    GError *e = g_error_new_valist(OUTLINE_ERROR, OUTLINE_ERROR_SHAPE, format, args);
    va_end(args);
    g_propagate_error(error, e);
    return false;
}

static Vec2 *points(const Maker *m) { return &g_array_index(m->margin, Vec2, 0); }

/* A point in the user's own units, "12.5,30", for messages; free it. */
static char *user_text(const Maker *m, Vec2 leaf)
{
    Vec2 axis = vec_sub(m->tip, m->base);
    Vec2 p = vec_add(m->base, vec_add(vec_scale(axis, leaf.y), vec_scale(vec2(axis.y, -axis.x), leaf.x)));
    char x[G_ASCII_DTOSTR_BUF_SIZE], y[G_ASCII_DTOSTR_BUF_SIZE];
    if (m->def->file && m->def->place)
        p = affine_apply(&m->def->place->inverse, p);
    g_ascii_formatd(x, sizeof x, "%.6g", p.x);
    g_ascii_formatd(y, sizeof y, "%.6g", (m->def->file ? -p.y : p.y) + 0.0);
    return g_strdup_printf("%s,%s", x, y);
}

/* --- reading --- */

static bool is_sound(Vec2 p) { return fabs(p.x) <= SVG_LARGEST && fabs(p.y) <= SVG_LARGEST; }

static bool check_teeth(const OutlineDef *def, GError **error)
{
    double count = 0.0;
    for (uint32_t k = 0; k < def->n_waves; k++) {
        if (!(def->waves[k].amplitude >= 0.0 && def->waves[k].amplitude <= 1.0))
            return fail_shape(error, "the amplitude of teeth %u is not between 0 and 1", k + 1);
        if (!(def->waves[k].count >= 0.0 && def->waves[k].count <= MAX_TEETH))
            return fail_shape(error, "the count of teeth %u is not between 0 and %d", k + 1, MAX_TEETH);
        count += def->waves[k].count;
    }
    if (!def->n_waves)
        return true;
    if (!(count <= MAX_TEETH))
        return fail_shape(error, "there are more than %d teeth", MAX_TEETH);
    if (!(def->tooth_skew > 0.0 && def->tooth_skew < 1.0))
        return fail_shape(error, "the skew of the teeth is not between 0 and 1");
    if (!(def->tooth_from >= 0.0 && def->tooth_from < def->tooth_to && def->tooth_to <= 1.0))
        return fail_shape(error, "the teeth must begin before they end, between 0 and 1");
    return true;
}

static bool check_def(const OutlineDef *def, GError **error)
{
    if (!def->path == !def->file)
        return fail_shape(error, "exactly one of path and file must be given");
    if (!(def->flatness >= 1e-7 && def->flatness <= 0.1))
        return fail_shape(error, "the flatness is not between 1e-7 and 0.1");
    if ((def->has_base && !is_sound(def->base)) || (def->has_tip && !is_sound(def->tip)))
        return fail_shape(error, "the coordinates of base and tip are not numbers or too large");
    return check_teeth(def, error);
}

/* From the drawing's units to those of the image it was drawn over. */
static void lay_down(SvgShape *shape, const Affine *map)
{
    for (guint k = 0; k < 4 * shape->path->curves->len; k++) {
        Vec2 *p = &g_array_index(shape->path->curves, Curve, k / 4).p[k % 4];
        *p = affine_apply(map, *p);
    }
    shape->base = affine_apply(map, shape->base);
    shape->tip = affine_apply(map, shape->tip);
}

/* The shape as drawn, y up, with marks given by hand in place of those of the file. */
static bool read_shape(Maker *m, GError **error)
{
    const OutlineDef *def = m->def;
    bool traced = def->file && tracing_is(def->file);
    if (traced    ? !tracing_read(def->file, def->mirror, &m->shape, error)
        : def->file ? !svgfile_read(def->file, &m->shape, error)
                    : !(m->shape.path = svgpath_parse(def->path, error)))
        return false;
    double up = def->file ? -1.0 : 1.0;
    if (def->has_base)
        m->shape.base = vec2(def->base.x, up * def->base.y);
    if (def->has_tip)
        m->shape.tip = vec2(def->tip.x, up * def->tip.y);
    m->shape.has_base |= def->has_base;
    m->shape.has_tip |= def->has_tip;
    if (def->file && def->place)
        lay_down(&m->shape, &def->place->map);
    guint n = m->shape.path->subpaths->len;
    if (n == 0)
        return fail_shape(error, "the path is empty: it has no line and no curve");
    if (n > 1)
        return fail_shape(error, "the path has %u subpaths; a leaf has one margin", n);
    return true;
}

/* --- base, tip and leaf coordinates --- */

static void find_base_tip(Maker *m)
{
    const Vec2 *v = points(m);
    m->base = m->shape.has_base ? m->shape.base : v[0];
    m->tip = m->shape.has_tip ? m->shape.tip : v[m->margin->len - 1];
    if (m->shape.has_tip || m->def->mirror)
        return;
    double most = -1.0;
    for (guint i = 0; i < m->margin->len; i++) {
        double d = vec_dist2(v[i], m->base);
        if (d > most) {
            most = d;
            m->tip = v[i];
        }
    }
}

/* Flattens twice: coarsely to learn the leaf's length, of which the flatness is a part, then as asked. */
static bool flatten_margin(Maker *m, GError **error)
{
    Box2 box = svgpath_box(m->shape.path, 0);
    double size = box.x1 - box.x0 + box.y1 - box.y0;
    m->margin = svgpath_flatten(m->shape.path, 0, 1e-3 * size);
    find_base_tip(m);
    double length = vec_dist(m->base, m->tip);
    double far = fabs(m->base.x) + fabs(m->base.y);
    if (!(length > 1e-9 * size) || !(length > 1e-9 * far))
        return fail_shape(error, "base and tip are the same point");
    if (!(size <= largest * length))
        return fail_shape(error, "the shape is over %g times as large as the distance between base and tip", largest);
    g_array_unref(m->margin);
    m->margin = svgpath_flatten(m->shape.path, 0, m->def->flatness * length);
    find_base_tip(m);
    if (m->margin->len > MAX_VERTICES)
        return fail_shape(error, "the path has over %d vertices", MAX_VERTICES);
    return true;
}

/* The similarity that takes base to (0,0) and tip to (0,1), both exactly: components along and across the axis. */
static void to_leaf(Maker *m)
{
    Vec2 axis = vec_sub(m->tip, m->base), *v = points(m);
    double whole = vec_norm2(axis);
    for (guint i = 0; i < m->margin->len; i++) {
        Vec2 d = vec_sub(v[i], m->base);
        v[i] = vec2(vec_cross(d, axis) / whole + 0.0, vec_dot(d, axis) / whole + 0.0); /* + 0.0: no negative zeros */
    }
}

/* Appends the half reflected about x = 0, from its end back to its start; ends near the axis are put on it and not
 * doubled. */
static void mirror_margin(Maker *m)
{
    guint n = m->margin->len;
    Vec2 *v = points(m);
    bool start_on_axis = fabs(v[0].x) < 1e-6, end_on_axis = fabs(v[n - 1].x) < 1e-6;
    if (start_on_axis)
        v[0].x = 0.0;
    if (end_on_axis)
        v[n - 1].x = 0.0;
    for (guint i = end_on_axis ? n - 1 : n; i-- > (start_on_axis ? 1u : 0u);) {
        Vec2 p = vec2(-g_array_index(m->margin, Vec2, i).x, g_array_index(m->margin, Vec2, i).y);
        g_array_append_val(m->margin, p);
    }
}

/* --- tidying --- */

static bool same_place(Vec2 a, Vec2 b) { return vec_dist2(a, b) < 1e-18; }

/* Drops vertices that repeat the one before; of a run the first is kept. */
static void drop_repeats(GArray *margin)
{
    Vec2 *v = &g_array_index(margin, Vec2, 0);
    guint n = 1;
    for (guint i = 1; i < margin->len; i++)
        if (!same_place(v[i], v[n - 1]))
            v[n++] = v[i];
    while (n > 1 && same_place(v[n - 1], v[0]))
        n--;
    g_array_set_size(margin, n);
}

static double twice_area(const Maker *m)
{
    const Vec2 *v = points(m);
    double twice = 0.0;
    for (guint i = 1; i + 1 < m->margin->len; i++)
        twice += vec_cross(vec_sub(v[i], v[0]), vec_sub(v[i + 1], v[0]));
    return twice;
}

/* Turns the margin counter-clockwise; its first vertex stays. */
static void turn_margin(Maker *m)
{
    if (twice_area(m) >= 0.0)
        return;
    Vec2 *v = points(m);
    for (guint i = 1, j = m->margin->len - 1; i < j; i++, j--) {
        Vec2 t = v[i];
        v[i] = v[j];
        v[j] = t;
    }
}

/* Makes vertex k the first. */
static void rotate_margin(Maker *m, guint k)
{
    GArray *turned = g_array_sized_new(FALSE, FALSE, sizeof(Vec2), m->margin->len);
    g_array_append_vals(turned, points(m) + k, m->margin->len - k);
    if (k)
        g_array_append_vals(turned, points(m), k);
    g_array_unref(m->margin);
    m->margin = turned;
}

/* The edge nearest to q, the part of it at which, and how far. */
static guint nearest_edge(const Maker *m, Vec2 q, double *part, double *distance)
{
    const Vec2 *v = points(m);
    guint n = m->margin->len, best = 0;
    double least = HUGE_VAL;
    for (guint i = 0; i < n; i++) {
        double d = segment_dist2(v[i], v[(i + 1) % n], q);
        if (d < least) {
            least = d;
            best = i;
        }
    }
    *part = segment_nearest(v[best], v[(best + 1) % n], q);
    *distance = sqrt(least);
    return best;
}

/* Makes q, which lies within `near` of the margin, a vertex of it: moves a vertex as near as that, else adds one. */
static guint put_vertex(Maker *m, Vec2 q, guint edge, double near)
{
    guint n = m->margin->len, next = (edge + 1) % n;
    Vec2 *v = points(m);
    guint nearer = vec_dist2(v[edge], q) <= vec_dist2(v[next], q) ? edge : next;
    if (vec_dist(v[nearer], q) < near) {
        v[nearer] = q;
        return nearer;
    }
    g_array_insert_val(m->margin, edge + 1, q);
    return edge + 1;
}

/* Puts base and tip on the margin where they are nearly so. The base may be inside, but not outside. */
static bool place_base_tip(Maker *m, GError **error)
{
    double near = m->def->flatness > 1e-6 ? m->def->flatness : 1e-6, part, distance;
    guint edge = nearest_edge(m, vec2(0.0, 0.0), &part, &distance);
    if (distance < near) {
        rotate_margin(m, put_vertex(m, vec2(0.0, 0.0), edge, near));
    } else {
        Polygon *p = polygon_new(points(m), m->margin->len);
        bool inside = polygon_contains(p, vec2(0.0, 0.0));
        polygon_free(p);
        if (!inside) {
            char *base = user_text(m, vec2(0.0, 0.0));
            char *there = user_text(m, vec_lerp(points(m)[edge], points(m)[(edge + 1) % m->margin->len], part));
            fail_shape(error, "the base %s lies outside the blade; the margin's nearest point is %s", base, there);
            g_free(base);
            g_free(there);
            return false;
        }
    }
    edge = nearest_edge(m, vec2(0.0, 1.0), &part, &distance);
    if (distance < near)
        put_vertex(m, vec2(0.0, 1.0), edge, near);
    return true;
}

/* --- checks --- */

/* Whether all vertices lie on one line, to rounding. */
static bool is_flat(const Maker *m)
{
    const Vec2 *v = points(m);
    guint far = 0;
    for (guint i = 1; i < m->margin->len; i++)
        far = vec_dist2(v[i], v[0]) > vec_dist2(v[far], v[0]) ? i : far;
    Vec2 d = vec_sub(v[far], v[0]);
    for (guint i = 1; i < m->margin->len; i++)
        if (fabs(vec_cross(d, vec_sub(v[i], v[0]))) > 1e-9 * vec_norm2(d))
            return false;
    return true;
}

/* A point that the closed segments ab and cd, which meet, share. */
static Vec2 meeting_point(Vec2 a, Vec2 b, Vec2 c, Vec2 d)
{
    Vec2 ab = vec_sub(b, a), cd = vec_sub(d, c);
    double turn = vec_cross(ab, cd);
    if (fabs(turn) > 1e-12 * sqrt(vec_norm2(ab) * vec_norm2(cd))) {
        double t = vec_cross(vec_sub(c, a), cd) / turn;
        return t <= 0.0 ? a : t >= 1.0 ? b : vec_lerp(a, b, t);
    }
    /* On one line: an end of one that lies on the other, d before c, which may be b. */
    return segment_dist2(a, b, d) <= segment_dist2(c, d, a) ? d : a;
}

/* `toothed`: without teeth the margin was simple. */
static bool check_simple(const Maker *m, bool toothed, GError **error)
{
    if (m->margin->len < 3 || is_flat(m))
        return fail_shape(error, "the path encloses no area");
    Polygon *p = polygon_new(points(m), m->margin->len);
    uint32_t i, j;
    bool good = !polygon_crossing(p, &i, &j);
    double wide = p->box.x1 - p->box.x0, high = p->box.y1 - p->box.y0, size = sqrt(wide * wide + high * high);
    if (!good) {
        char *at = user_text(m, meeting_point(p->v[i], p->v[(i + 1) % p->n], p->v[j], p->v[(j + 1) % p->n]));
        fail_shape(error, toothed ? "the teeth run into each other or the blade near %s; teeth_amplitude or teeth_count must be lower"
                   : m->def->file ? "the margin crosses or touches itself near %s (lobes that overlap become one area by Inkscape's Path > Union)"
                                  : "the margin crosses or touches itself near %s", at);
        g_free(at);
    } else if (p->area < thinnest * size * size) {
        char width[G_ASCII_DTOSTR_BUF_SIZE];
        fail_shape(error, "the path is a sliver, on average %s times as wide as long; a blade is at least %g times as wide",
                   g_ascii_formatd(width, sizeof width, "%.2g", p->area / (size * size)), thinnest);
        good = false;
    }
    polygon_free(p);
    return good;
}

/* --- teeth --- */

/* Where the sides begin when the base is inside the blade: the margin straight behind it, seen from the tip. Makes that
 * point vertex 0. */
static void open_behind_base(Maker *m)
{
    const Vec2 *v = points(m);
    guint n = m->margin->len, best = 0;
    Vec2 at = vec2(0.0, -HUGE_VAL);
    for (guint i = 0; i < n; i++) {
        Vec2 a = v[i], b = v[(i + 1) % n];
        if ((a.x <= 0.0) == (b.x <= 0.0))
            continue;
        double y = a.y + (b.y - a.y) * (a.x / (a.x - b.x));
        if (y < 0.0 && y > at.y) {
            at.y = y;
            best = i;
        }
    }
    if (at.y > -HUGE_VAL)
        best = put_vertex(m, at, best, 1e-9);
    rotate_margin(m, best);
}

static guint nearest_vertex(const Maker *m, Vec2 q)
{
    guint best = 1;
    for (guint i = 2; i < m->margin->len; i++)
        if (vec_dist2(points(m)[i], q) < vec_dist2(points(m)[best], q))
            best = i;
    return best;
}

/* The margin runs from the base up the right side to the tip and down the left one. */
static void add_teeth(Maker *m)
{
    if (!same_place(points(m)[0], vec2(0.0, 0.0)))
        open_behind_base(m);
    guint n = m->margin->len, tip = nearest_vertex(m, vec2(0.0, 1.0));
    GArray *left = g_array_new(FALSE, FALSE, sizeof(Vec2));
    for (guint i = n; i >= tip; i--)
        g_array_append_val(left, points(m)[i % n]);
    GArray *right = teeth_apply(m->def, points(m), tip + 1, 1.0);
    GArray *back = teeth_apply(m->def, &g_array_index(left, Vec2, 0), left->len, -1.0);
    for (guint i = back->len - 1; i-- > 1;)
        g_array_append_val(right, g_array_index(back, Vec2, i));
    g_array_unref(left);
    g_array_unref(back);
    g_array_unref(m->margin);
    m->margin = right;
    drop_repeats(m->margin);
}

static bool make_margin(Maker *m, GError **error)
{
    if (!check_def(m->def, error) || !read_shape(m, error) || !flatten_margin(m, error))
        return false;
    to_leaf(m);
    drop_repeats(m->margin);
    if (m->def->mirror)
        mirror_margin(m);
    turn_margin(m);
    if (!check_simple(m, false, error) || !place_base_tip(m, error))
        return false;
    if (m->def->n_waves)
        add_teeth(m);
    return check_simple(m, m->def->n_waves > 0, error);
}

Polygon *outline_new(const OutlineDef *def, GError **error)
{
    Vec2 base, tip;
    return outline_new_from(def, &base, &tip, error);
}

Polygon *outline_new_from(const OutlineDef *def, Vec2 *base, Vec2 *tip, GError **error)
{
    Maker m = {.def = def};
    Polygon *p = NULL;
    if (make_margin(&m, error))
        p = polygon_new(points(&m), m.margin->len);
    else
        g_prefix_error(error, "%s: ", def->where ? def->where : "outline");
    *base = m.base;
    *tip = m.tip;
    svgshape_clear(&m.shape);
    if (m.margin)
        g_array_unref(m.margin);
    return p;
}
