#include "geom/bezierfit.h"

#include <string.h>

#include "geom/bezier.h"
#include "geom/cubicfit.h"

G_DEFINE_QUARK(venation-bezierfit-error-quark, bezierfit_error)

enum { MAX_VERTICES = 10000000 };

BezierFitDef bezierfit_def_default(void) { return (BezierFitDef){.rule = BEZIERFIT_CHORDS, .tension = 1.0, .cusp_angle = 30.0}; }

/* A point where pieces meet. */
typedef struct {
    uint32_t at;
    bool cusp;
    Vec2 in, out; /* unit tangents of the piece that ends here and of the one that starts here */
} Joint;

/* The contour turned so that the base is vertex 0 and repeated as vertex n. */
typedef struct {
    BezierFitDef def;
    Vec2 *v;       /* [n + 1] */
    double *along; /* [n + 1] way from the base */
    uint32_t n, base, tip;
    double cusp_cosine;
    GArray *joint; /* Joint, from the base (vertex 0) to the base (vertex n) */
    GArray *piece; /* BezierPiece, one fewer, with from and to as in v */
} Fitter;

static Joint *joint(const Fitter *f, guint k) { return &g_array_index(f->joint, Joint, k); }
static BezierPiece *piece(const Fitter *f, guint k) { return &g_array_index(f->piece, BezierPiece, k); }

static Vec2 unit(Vec2 d)
{
    double size = sqrt(vec_norm2(d));
    return size > 0.0 ? vec_scale(d, 1.0 / size) : vec2(0.0, 0.0);
}

/* --- checks --- */

static bool fail(GError **error, BezierFitError code, const char *format, ...) G_GNUC_PRINTF(3, 4);

static bool fail(GError **error, BezierFitError code, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    GError *e = g_error_new_valist(BEZIERFIT_ERROR, (int)code, format, args);
    va_end(args);
    g_propagate_error(error, e);
    return false;
}

static bool check_def(const BezierFitDef *def, GError **error)
{
    if (!(def->tension > 0.0 && def->tension <= 3.0))
        return fail(error, BEZIERFIT_ERROR_SETTINGS, "the tension is %g; it must be above 0 and no more than 3", def->tension);
    if (!(def->cusp_angle >= 0.0 && def->cusp_angle <= 180.0))
        return fail(error, BEZIERFIT_ERROR_SETTINGS, "the cusp angle is %g; it must lie between 0 and 180 degrees", def->cusp_angle);
    const double length[3] = {def->reach, def->tolerance, def->shortest};
    static const char *const name[3] = {"reach", "tolerance", "shortest piece"};
    for (int i = 0; i < 3; i++)
        if (!(length[i] >= 0.0 && length[i] <= 1e12))
            return fail(error, BEZIERFIT_ERROR_SETTINGS, "the %s is %g; it must lie between 0 and 1e12", name[i], length[i]);
    return true;
}

static bool check_contour(const Vec2 *v, uint32_t n, const uint32_t *at, uint32_t n_at, uint32_t base, uint32_t tip, GError **error)
{
    if (n < 3 || n > MAX_VERTICES)
        return fail(error, BEZIERFIT_ERROR_CONTOUR, "the contour has %u points; it must have 3 to %d", n, MAX_VERTICES);
    for (uint32_t i = 0; i < n; i++)
        if (!(fabs(v[i].x) <= 1e9 && fabs(v[i].y) <= 1e9))
            return fail(error, BEZIERFIT_ERROR_CONTOUR, "point %u of the contour is no number between -1e9 and 1e9", i);
    if (base >= n || tip >= n || base == tip)
        return fail(error, BEZIERFIT_ERROR_CONTOUR, "base and tip are points %u and %u; they must be two of the contour's %u", base, tip,
                    n);
    for (uint32_t i = 0; i < n_at; i++)
        if (at[i] >= n)
            return fail(error, BEZIERFIT_ERROR_CONTOUR, "a characteristic point is point %u of the contour, which has %u", at[i], n);
    return true;
}

/* --- the contour --- */

static void fitter_init(Fitter *f, const Vec2 *v, uint32_t n, uint32_t base, uint32_t tip, const BezierFitDef *def)
{
    *f = (Fitter){.def = *def, .n = n, .base = base, .tip = tip > base ? tip - base : tip + n - base};
    f->v = g_new(Vec2, (gsize)n + 1);
    f->along = g_new0(double, (gsize)n + 1);
    memcpy(f->v, v + base, (n - base) * sizeof *v);
    memcpy(f->v + (n - base), v, ((gsize)base + 1) * sizeof *v);
    for (uint32_t i = 0; i < n; i++)
        f->along[i + 1] = f->along[i] + vec_dist(f->v[i], f->v[i + 1]);
    if (f->def.reach == 0.0)
        f->def.reach = 8.0 * f->along[n] / n;
    if (f->def.shortest == 0.0)
        f->def.shortest = 2.0 * f->def.reach;
    double sine;
    degrees_sincos(def->cusp_angle, &sine, &f->cusp_cosine);
    f->joint = g_array_new(FALSE, TRUE, sizeof(Joint));
    f->piece = g_array_new(FALSE, TRUE, sizeof(BezierPiece));
}

static void fitter_clear(Fitter *f)
{
    g_free(f->v);
    g_free(f->along);
    g_array_unref(f->joint);
    g_array_unref(f->piece);
}

/* The last vertex no farther than s from the base along the contour. */
static uint32_t vertex_at(const Fitter *f, double s)
{
    uint32_t lo = 0, hi = f->n;
    while (lo < hi) {
        uint32_t mid = lo + (hi - lo + 1) / 2;
        if (f->along[mid] <= s)
            lo = mid;
        else
            hi = mid - 1;
    }
    return lo;
}

static Vec2 point_at(const Fitter *f, double s)
{
    uint32_t i = vertex_at(f, s);
    if (i == f->n)
        return f->v[f->n];
    double edge = f->along[i + 1] - f->along[i];
    return vec_lerp(f->v[i], f->v[i + 1], edge > 0.0 ? (s - f->along[i]) / edge : 0.0);
}

/* Direction of the contour from s to t along it: from the middle of its first half to that of the second, so that single points, the ends
 * above all, have little say. */
static Vec2 direction(const Fitter *f, double s, double t)
{
    Vec2 sum = vec2(0.0, 0.0);
    for (int k = 0; k < 8; k++) {
        Vec2 p = point_at(f, s + (t - s) * (k + 0.5) / 8.0);
        sum = k < 4 ? vec_sub(sum, p) : vec_add(sum, p);
    }
    return unit(sum);
}

/* Directions of the contour before and after vertex i over `reach` or less, within the stretch lo … hi. */
static void directions(const Fitter *f, uint32_t i, uint32_t lo, uint32_t hi, Vec2 *in, Vec2 *out)
{
    double s = f->along[i];
    *in = direction(f, MAX(s - f->def.reach, f->along[lo]), s);
    *out = direction(f, s, MIN(s + f->def.reach, f->along[hi]));
}

static bool is_cusp(const Fitter *f, uint32_t i, uint32_t lo, uint32_t hi)
{
    Vec2 in, out;
    directions(f, i, lo, hi, &in, &out);
    return i == 0 || i == f->n || i == f->tip || vec_dot(in, out) < f->cusp_cosine;
}

/* --- tangents --- */

/* A tangent mirrored in a chord. */
static Vec2 mirrored(Vec2 tangent, Vec2 chord)
{
    Vec2 u = unit(chord);
    return vec_sub(vec_scale(u, 2.0 * vec_dot(u, tangent)), tangent);
}

/* The paper's tangents. With d the chords and h their lengths, the circle through three points has the direction d_i / h_i² + d_{i+1} /
 * h_{i+1}². */
static void chord_tangents(Fitter *f)
{
    guint last = f->joint->len - 1;
    for (guint k = 1; k < last; k++) {
        Vec2 a = vec_sub(f->v[joint(f, k)->at], f->v[joint(f, k - 1)->at]), b = vec_sub(f->v[joint(f, k + 1)->at], f->v[joint(f, k)->at]);
        double aa = vec_norm2(a), bb = vec_norm2(b);
        Vec2 t = unit(vec_add(vec_scale(a, bb), vec_scale(b, aa)));
        joint(f, k)->in = joint(f, k)->out = t;
    }
    for (guint k = 0; k < last; k++) {
        Joint *p = joint(f, k), *q = joint(f, k + 1);
        Vec2 chord = vec_sub(f->v[q->at], f->v[p->at]);
        Vec2 at_p = p->out, at_q = q->in;
        if (p->cusp)
            p->out = q->cusp ? unit(chord) : mirrored(at_q, chord);
        if (q->cusp)
            q->in = p->cusp ? unit(chord) : mirrored(at_p, chord);
    }
}

/* A fitted tangent, unless it is more than 60° off the contour's own direction: then the points were too few or no cubic's. */
static Vec2 sane(Vec2 tangent, Vec2 contour) { return vec_dot(tangent, contour) >= 0.5 ? tangent : contour; }

/* Tangents of the cubics of least squares. */
static void contour_tangents(Fitter *f)
{
    guint last = f->joint->len - 1;
    double *misfit = g_new(double, last);
    for (guint k = 0; k < last; k++) {
        Joint *p = joint(f, k), *q = joint(f, k + 1);
        uint32_t n = q->at - p->at + 1;
        Vec2 skip;
        directions(f, p->at, p->at, q->at, &skip, &p->out);
        directions(f, q->at, p->at, q->at, &q->in, &skip);
        double length = f->along[q->at] - f->along[p->at];
        misfit[k] = 1e-3 * length * length; /* of little weight, if there are too few points for a fit */
        if (n < 6)
            continue;
        Vec2 c[4] = {f->v[p->at], vec_add(f->v[p->at], vec_scale(p->out, length / 3.0)),
                     vec_sub(f->v[q->at], vec_scale(q->in, length / 3.0)), f->v[q->at]};
        misfit[k] = cubic_fit(c, f->v + p->at, n, false) + 1e-12 * length * length;
        p->out = sane(unit(vec_sub(c[1], c[0])), p->out);
        q->in = sane(unit(vec_sub(c[3], c[2])), q->in);
    }
    for (guint k = 1; k < last; k++) {
        Joint *j = joint(f, k);
        if (j->cusp)
            continue;
        if (vec_dot(j->in, j->out) < f->cusp_cosine) /* the fits are no good yet, as the contour is smooth here */
            directions(f, j->at, joint(f, k - 1)->at, joint(f, k + 1)->at, &j->in, &j->out);
        j->in = j->out = unit(vec_add(vec_scale(j->in, misfit[k]), vec_scale(j->out, misfit[k - 1])));
    }
    g_free(misfit);
}

/* --- pieces --- */

static BezierPiece fit_piece(const Fitter *f, const Joint *p, const Joint *q)
{
    Vec2 a = f->v[p->at], b = f->v[q->at];
    uint32_t n = q->at - p->at + 1;
    bool chords = f->def.rule == BEZIERFIT_CHORDS;
    double handle = chords ? vec_dist(a, b) * f->def.tension / 3.0 : (f->along[q->at] - f->along[p->at]) / 3.0;
    BezierPiece c = {
        {a, vec_add(a, vec_scale(p->out, handle)), vec_sub(b, vec_scale(q->in, handle)), b}, p->at, q->at, p->cusp, 0.0, 0.0, 0};
    if (!chords)
        cubic_fit(c.p, f->v + p->at, n, true);
    CubicDeviation d = cubic_deviation(c.p, f->v + p->at, n);
    c.largest = d.largest;
    c.mean = d.mean;
    c.farthest = p->at + d.farthest;
    return c;
}

static void fit_pieces(Fitter *f)
{
    if (f->def.rule == BEZIERFIT_CHORDS)
        chord_tangents(f);
    else
        contour_tangents(f);
    g_array_set_size(f->piece, 0);
    for (guint k = 0; k + 1 < f->joint->len; k++) {
        BezierPiece c = fit_piece(f, joint(f, k), joint(f, k + 1));
        g_array_append_val(f->piece, c);
    }
}

/* --- joints --- */

/* Where a piece is parted: at its farthest vertex, or as near to that as its ends allow; 0 when it is too short. */
static uint32_t parting(const Fitter *f, const BezierPiece *c)
{
    double lo = f->along[c->from] + f->def.shortest, hi = f->along[c->to] - f->def.shortest, aim = f->along[c->farthest];
    uint32_t best = 0;
    for (uint32_t i = c->from + 1; i < c->to; i++)
        if (f->along[i] >= lo && f->along[i] <= hi && (!best || fabs(f->along[i] - aim) < fabs(f->along[best] - aim)))
            best = i;
    return best;
}

/* Parts every piece that is too far from the contour; FALSE when none could be. */
static bool part_pieces(Fitter *f)
{
    guint before = f->joint->len;
    for (guint k = f->piece->len; k-- > 0;) {
        const BezierPiece *c = piece(f, k);
        uint32_t i = c->largest > f->def.tolerance ? parting(f, c) : 0;
        if (!i)
            continue;
        Joint j = {.at = i, .cusp = is_cusp(f, i, c->from, c->to)};
        g_array_insert_val(f->joint, k + 1, j);
    }
    return f->joint->len > before;
}

static int by_place(gconstpointer a, gconstpointer b)
{
    const Joint *p = a, *q = b;
    return (p->at > q->at) - (p->at < q->at);
}

static void first_joints(Fitter *f, const uint32_t *at, uint32_t n_at)
{
    const Joint ends[3] = {{.at = 0}, {.at = f->tip}, {.at = f->n}};
    g_array_append_vals(f->joint, ends, 3);
    for (uint32_t i = 0; i < n_at; i++) {
        Joint j = {.at = at[i] >= f->base ? at[i] - f->base : at[i] + f->n - f->base};
        g_array_append_val(f->joint, j);
    }
    g_array_sort(f->joint, by_place);
    guint n = 1;
    for (guint k = 1; k < f->joint->len; k++)
        if (joint(f, k)->at != joint(f, n - 1)->at)
            *joint(f, n++) = *joint(f, k);
    g_array_set_size(f->joint, n);
    for (guint k = 0; k < n; k++)
        joint(f, k)->cusp = is_cusp(f, joint(f, k)->at, k ? joint(f, k - 1)->at : 0, k + 1 < n ? joint(f, k + 1)->at : f->n);
}

/* --- the fit --- */

static BezierFit *take_fit(Fitter *f)
{
    BezierFit *fit = g_new0(BezierFit, 1);
    fit->n = f->piece->len;
    for (guint k = 0; k < fit->n; k++) {
        BezierPiece *c = piece(f, k);
        fit->largest = MAX(fit->largest, c->largest);
        fit->mean += c->mean * (f->along[c->to] - f->along[c->from]) / f->along[f->n];
        fit->n_right += c->to <= f->tip;
        c->from = (f->base + c->from) % f->n;
        c->to = (f->base + c->to) % f->n;
        c->farthest = (f->base + c->farthest) % f->n;
    }
    fit->piece = (BezierPiece *)(void *)g_array_free(f->piece, FALSE);
    f->piece = g_array_new(FALSE, FALSE, sizeof(BezierPiece));
    return fit;
}

BezierFit *bezierfit_new(const Vec2 *v, uint32_t n, const uint32_t *at, uint32_t n_at, uint32_t base, uint32_t tip,
                         const BezierFitDef *def, GError **error)
{
    if (!check_def(def, error) || !check_contour(v, n, at, n_at, base, tip, error))
        return NULL;
    Fitter f;
    fitter_init(&f, v, n, base, tip, def);
    BezierFit *fit = NULL;
    if (f.along[n] > 0.0) {
        first_joints(&f, at, n_at);
        do
            fit_pieces(&f);
        while (def->tolerance > 0.0 && part_pieces(&f));
        fit = take_fit(&f);
    } else {
        fail(error, BEZIERFIT_ERROR_CONTOUR, "the contour is a single point");
    }
    fitter_clear(&f);
    return fit;
}

void bezierfit_free(BezierFit *fit)
{
    if (!fit)
        return;
    g_free(fit->piece);
    g_free(fit);
}

/* --- path data --- */

static void put_number(GString *text, double value, int decimals)
{
    char format[8], number[400]; /* 1e9 with 15 decimals and much to spare */
    g_snprintf(format, sizeof format, "%%.%df", decimals);
    g_ascii_formatd(number, sizeof number, format, value);
    if (decimals > 0) {
        char *end = number + strlen(number);
        while (end[-1] == '0')
            *--end = '\0';
        if (end[-1] == '.')
            *--end = '\0';
    }
    g_string_append(text, strcmp(number, "-0") == 0 ? "0" : number);
}

static void put_point(GString *text, char before, Vec2 p, int decimals)
{
    g_string_append_c(text, before);
    put_number(text, p.x, decimals);
    g_string_append_c(text, ',');
    put_number(text, p.y, decimals);
}

char *bezierfit_path(const BezierFit *fit, int decimals)
{
    int places = CLAMP(decimals, 0, 15);
    GString *text = g_string_new(NULL);
    put_point(text, 'M', fit->piece[0].p[0], places);
    for (uint32_t k = 0; k < fit->n; k++) {
        put_point(text, 'C', fit->piece[k].p[1], places);
        put_point(text, ' ', fit->piece[k].p[2], places);
        put_point(text, ' ', fit->piece[k].p[3], places);
    }
    g_string_append_c(text, 'Z');
    return g_string_free(text, FALSE);
}
