#include "sim/growth.h"

#include "geom/dmath.h"

G_DEFINE_QUARK(growth-error-quark, growth_error)

/* Nonuniform growth: material heights y0 sampled evenly, with (1+g)^t at each and the integral of eq. 4 up to it. */
enum { SAMPLES = 2049 };
struct GrowthTable {
    double y0, h; /* first sample, spacing; initial segments */
    double gx[SAMPLES], gy[SAMPLES];
    double px[SAMPLES], py[SAMPLES]; /* stretch across and along by now */
    double y[SAMPLES];               /* current height of each sample */
};

GrowthDef growth_def_default(void)
{
    static const double still[] = {0.0, 0.0, 1.0, 0.0};
    return (GrowthDef){.kind = GROWTH_MARGINAL, .initial_length = 270, .final_length = 1600, .step = 8, .steps = 100,
                       .rate_x = still, .n_rate_x = 2, .rate_y = still, .n_rate_y = 2};
}

static double rate_at(const double *rate, uint32_t n, double y)
{
    if (y <= rate[0])
        return rate[1];
    for (uint32_t i = 1; i < n; i++) {
        const double *a = rate + 2 * (i - 1), *b = rate + 2 * i;
        if (y < b[0])
            return a[1] + (b[1] - a[1]) * ((y - a[0]) / (b[0] - a[0]));
    }
    return rate[2 * n - 1];
}

static gboolean check_rates(const double *rate, uint32_t n, const char *name, GError **error)
{
    if (n == 0) {
        g_set_error(error, GROWTH_ERROR, GROWTH_ERROR_VALUE, "growth.%s is empty: needs at least one y,g pair", name);
        return FALSE;
    }
    for (uint32_t i = 0; i < n; i++) {
        if (i && !(rate[2 * i] > rate[2 * i - 2])) {
            g_set_error(error, GROWTH_ERROR, GROWTH_ERROR_VALUE, "growth.%s: pair %u has y = %g, which must be above the %g before it",
                        name, i + 1, rate[2 * i], rate[2 * i - 2]);
            return FALSE;
        }
        if (!(rate[2 * i + 1] > -1.0 && rate[2 * i + 1] <= 10.0)) {
            g_set_error(error, GROWTH_ERROR, GROWTH_ERROR_VALUE, "growth.%s: pair %u has the rate %g, which must be above -1 and at most 10",
                        name, i + 1, rate[2 * i + 1]);
            return FALSE;
        }
    }
    return TRUE;
}

static gboolean check(const GrowthDef *d, GError **error)
{
    bool longer = d->kind == GROWTH_MARGINAL || d->kind == GROWTH_ISOGONIC;
    if (longer && d->final_length < d->initial_length) {
        g_set_error(error, GROWTH_ERROR, GROWTH_ERROR_VALUE, "growth.final_length = %g must not be below growth.initial_length = %g",
                    d->final_length, d->initial_length);
        return FALSE;
    }
    if (longer && (d->final_length - d->initial_length) / d->step > 1e7) {
        g_set_error(error, GROWTH_ERROR, GROWTH_ERROR_VALUE, "growth.step = %g is too small: more than ten million steps to grow", d->step);
        return FALSE;
    }
    if (d->kind != GROWTH_NONUNIFORM)
        return TRUE;
    return check_rates(d->rate_x, d->n_rate_x, "rate_x", error) && check_rates(d->rate_y, d->n_rate_y, "rate_y", error);
}

/* Sample index and part of an interval for a material height. */
static uint32_t sample_of(const struct GrowthTable *t, double y0, double *f)
{
    double u = (y0 - t->y0) / t->h;
    uint32_t i = u <= 0.0 ? 0 : u >= SAMPLES - 2 ? SAMPLES - 2 : (uint32_t)u;
    *f = u - (double)i;
    return i;
}

/* Height now of material height y0: the integral of the straight-line stretch within its interval. */
static double height_of(const struct GrowthTable *t, double y0)
{
    double f;
    uint32_t i = sample_of(t, y0, &f);
    return t->y[i] + t->h * f * (t->py[i] + (t->py[i + 1] - t->py[i]) * f * 0.5);
}

static void table_update(struct GrowthTable *t, uint32_t step)
{
    for (uint32_t i = 0; i < SAMPLES; i++) {
        t->px[i] = dmath_pow(1.0 + t->gx[i], (double)step);
        t->py[i] = dmath_pow(1.0 + t->gy[i], (double)step);
    }
    t->y[0] = 0.0;
    for (uint32_t i = 1; i < SAMPLES; i++)
        t->y[i] = t->y[i - 1] + t->h * (t->py[i - 1] + t->py[i]) * 0.5;
    double base = height_of(t, 0.0); /* the base stays at the origin */
    for (uint32_t i = 0; i < SAMPLES; i++)
        t->y[i] -= base;
}

static struct GrowthTable *table_new(const Blade *b)
{
    struct GrowthTable *t = g_new0(struct GrowthTable, 1);
    double l = b->def.initial_length, pad = 0.01;
    t->y0 = (b->leaf->box.y0 - pad) * l;
    t->h = (b->leaf->box.y1 - b->leaf->box.y0 + 2.0 * pad) * l / (SAMPLES - 1);
    for (uint32_t i = 0; i < SAMPLES; i++) {
        double y = (t->y0 + t->h * i) / l;
        t->gx[i] = rate_at(b->def.rate_x, b->def.n_rate_x, y);
        t->gy[i] = rate_at(b->def.rate_y, b->def.n_rate_y, y);
    }
    table_update(t, 0);
    return t;
}

Vec2 blade_place(const Blade *b, Vec2 m)
{
    if (!b->moving)
        return b->def.kind == GROWTH_ISOGONIC ? vec_scale(m, b->def.final_length / b->def.initial_length) : m;
    double f;
    uint32_t i = sample_of(b->table, m.y, &f);
    return vec2(m.x * (b->table->px[i] + (b->table->px[i + 1] - b->table->px[i]) * f), height_of(b->table, m.y));
}

Vec2 blade_material(const Blade *b, Vec2 p)
{
    if (!b->moving)
        return b->def.kind == GROWTH_ISOGONIC ? vec_scale(p, b->def.initial_length / b->def.final_length) : p;
    const struct GrowthTable *t = b->table;
    uint32_t lo = 0, hi = SAMPLES - 1;
    while (hi - lo > 1) {
        uint32_t mid = (lo + hi) / 2;
        if (p.y < t->y[mid])
            hi = mid;
        else
            lo = mid;
    }
    /* h (a f + (b - a) f² / 2) = p.y - y[lo], solved for f without cancellation */
    double a = t->py[lo], d = t->py[lo + 1] - a, c = (p.y - t->y[lo]) / t->h;
    double root = a * a + 2.0 * d * c;
    double f = 2.0 * c / (a + sqrt(root > 0.0 ? root : 0.0));
    double y0 = t->y0 + t->h * ((double)lo + f);
    double stretch = t->px[lo] + (t->px[lo + 1] - t->px[lo]) * f;
    return vec2(p.x / stretch, y0);
}

double blade_length_at(const Blade *b, uint32_t step)
{
    if (b->def.kind == GROWTH_NONE)
        return b->def.initial_length;
    if (b->def.kind == GROWTH_NONUNIFORM)
        return b->length;
    double l = b->def.initial_length + b->def.step * (double)step;
    return l < b->def.final_length ? l : b->def.final_length;
}

double blade_scale_at(const Blade *b, uint32_t step)
{
    return b->def.kind == GROWTH_ISOGONIC ? b->def.final_length : blade_length_at(b, step);
}

Polygon *blade_outline(const Blade *b)
{
    Vec2 *v = g_new(Vec2, b->leaf->n);
    for (uint32_t i = 0; i < b->leaf->n; i++)
        v[i] = b->moving ? blade_place(b, vec_scale(b->leaf->v[i], b->def.initial_length)) : vec_scale(b->leaf->v[i], b->scale);
    Polygon *p = polygon_new(v, b->leaf->n);
    g_free(v);
    return p;
}

static void refresh(Blade *b)
{
    if (b->moving) {
        table_update(b->table, b->step < b->last_step ? b->step : b->last_step);
        polygon_free(b->shape);
        b->shape = blade_outline(b);
        b->box = b->shape->box;
        b->area = b->shape->area;
        b->length = height_of(b->table, b->def.initial_length);
        b->scale = b->length;
        b->unit = 1.0;
        return;
    }
    b->length = blade_length_at(b, b->step);
    b->scale = blade_scale_at(b, b->step);
    b->unit = b->def.kind == GROWTH_ISOGONIC ? b->def.final_length / b->length : 1.0;
    b->area = b->leaf->area * b->length * b->length;
    Box2 u = b->leaf->box;
    b->box = (Box2){u.x0 * b->scale, u.y0 * b->scale, u.x1 * b->scale, u.y1 * b->scale};
}

/* The outline with points at least every `longest`. */
static Polygon *cut_edges(const Polygon *p, double longest)
{
    GArray *v = g_array_new(FALSE, FALSE, sizeof(Vec2));
    for (uint32_t i = 0; i < p->n; i++) {
        Vec2 a = p->v[i], b = p->v[i + 1 < p->n ? i + 1 : 0];
        uint32_t parts = MAX(1, (uint32_t)ceil(vec_dist(a, b) / longest));
        for (uint32_t k = 0; k < parts; k++) {
            Vec2 q = vec_lerp(a, b, (double)k / (double)parts);
            g_array_append_val(v, q);
        }
    }
    Polygon *fine = polygon_new((Vec2 *)v->data, v->len);
    g_array_free(v, TRUE);
    return fine;
}

static void find_back(Blade *b);

/* Rates compound over the steps: what they make of the blade must still be one. Stretches only rise or only fall, so the end tells of the way
 * there. */
static gboolean check_stretch(const Blade *b, GError **error)
{
    const double least = 1e-4, most = 1e4;
    struct GrowthTable *t = b->table;
    table_update(t, b->last_step);
    for (uint32_t i = 0; i < 2 * SAMPLES; i++) {
        uint32_t k = i / 2;
        double stretch = i % 2 ? t->py[k] : t->px[k];
        if (stretch >= least && stretch <= most)
            continue;
        g_set_error(error, GROWTH_ERROR, GROWTH_ERROR_VALUE,
                    "growth.%s: at height y = %.3g a rate of %.3g makes the blade more than %g times as %s in growth.steps = %u; that is no leaf any more",
                    i % 2 ? "rate_y" : "rate_x", (t->y0 + t->h * k) / b->def.initial_length, i % 2 ? t->gy[k] : t->gx[k], most,
                    stretch > most ? i % 2 ? "long" : "wide" : i % 2 ? "short" : "narrow", b->last_step);
        return FALSE;
    }
    return TRUE;
}

static gboolean check_shape(const Blade *b, GError **error)
{
    const double longest = 1e6; /* segments */
    double size = MAX(b->box.x1 - b->box.x0, b->box.y1 - b->box.y0);
    if (!(b->length >= 1.0 && size <= longest)) {
        g_set_error(error, GROWTH_ERROR, GROWTH_ERROR_VALUE,
                    "growth.rate_x and rate_y over growth.steps = %u would make a leaf of %.3g segments, %.3g base to tip; it must be 1 base to tip at "
                    "least and %g in all at most", b->last_step, size, b->length, longest);
        return FALSE;
    }
    uint32_t i, j;
    if (polygon_crossing(b->shape, &i, &j)) {
        g_set_error(error, GROWTH_ERROR, GROWTH_ERROR_VALUE,
                    "growth.rate_x and rate_y over growth.steps = %u would make the margin cross or touch itself near %g,%g", b->last_step,
                    b->shape->v[i].x, b->shape->v[i].y);
        return FALSE;
    }
    return TRUE;
}

Blade *blade_new(const Polygon *leaf, const GrowthDef *def, GError **error)
{
    if (!check(def, error))
        return NULL;
    Blade *b = g_new0(Blade, 1);
    b->leaf = leaf;
    b->def = *def;
    b->moving = def->kind == GROWTH_NONUNIFORM;
    if (def->kind == GROWTH_NONUNIFORM) {
        b->def.rate_x = g_memdup2(def->rate_x, sizeof(double) * 2 * def->n_rate_x);
        b->def.rate_y = g_memdup2(def->rate_y, sizeof(double) * 2 * def->n_rate_y);
        b->last_step = def->steps;
        b->leaf = b->fine = cut_edges(leaf, 0.005);
        b->table = table_new(b);
    } else {
        b->def.rate_x = b->def.rate_y = NULL;
        if (def->kind != GROWTH_NONE)
            b->last_step = (uint32_t)ceil((def->final_length - def->initial_length) / def->step);
    }
    b->step = b->last_step; /* look at the end, then start */
    if (b->moving && !check_stretch(b, error)) {
        blade_free(b);
        return NULL;
    }
    refresh(b);
    if (b->moving && !check_shape(b, error)) {
        blade_free(b);
        return NULL;
    }
    b->widest = b->box;
    b->last_length = b->length;
    if (b->moving)
        b->last_shape = blade_outline(b);
    if (def->kind == GROWTH_MARGINAL)
        find_back(b);
    b->step = 0;
    refresh(b);
    b->widest = box_union(b->widest, b->box);
    return b;
}

void blade_free(Blade *b)
{
    if (!b)
        return;
    polygon_free(b->shape);
    polygon_free(b->last_shape);
    g_free((gpointer)b->def.rate_x);
    g_free((gpointer)b->def.rate_y);
    g_free(b->table);
    g_free(b->back);
    polygon_free(b->fine);
    g_free(b);
}

void blade_advance(Blade *b)
{
    if (b->step++ < b->last_step)
        refresh(b);
}

/* ---- what is in the blade ---- */

/* Edges of the outline that turn their back on the base: on a ray from there the blade begins anew behind them. */
static void find_back(Blade *b)
{
    const Polygon *p = b->leaf;
    b->back = g_malloc_n(p->n, sizeof *b->back);
    for (uint32_t i = 0; i < p->n; i++) {
        Vec2 from = p->v[i], to = p->v[i + 1 < p->n ? i + 1 : 0];
        if (vec_cross(from, to) < 0.0) {
            b->back[b->n_back][0] = from;
            b->back[b->n_back++][1] = to;
        }
    }
}

/* Whether none of those edges sweeps over point u of the outline (leaf coordinates) while the margin moves on and u, seen from it, falls back
 * towards the base to `part` of its distance. */
static bool stays(const Blade *b, Vec2 u, double part)
{
    for (uint32_t i = 0; i < b->n_back; i++) {
        Vec2 from = b->back[i][0], to = b->back[i][1];
        double f = vec_cross(from, u), t = vec_cross(to, u);
        if ((f > 0.0) == (t > 0.0))
            continue;
        double hit = vec_dot(vec_lerp(from, to, f / (f - t)), u) / vec_norm2(u);
        if (hit > part && hit <= 1.0)
            return false;
    }
    return true;
}

static bool contains_at(const Blade *b, Vec2 p, double scale)
{
    Vec2 u = vec_scale(p, 1.0 / scale);
    return polygon_contains(b->leaf, u) && (b->n_back == 0 || stays(b, u, scale / b->last_length));
}

bool blade_contains(const Blade *b, Vec2 p) { return b->moving ? polygon_contains(b->shape, p) : contains_at(b, p, b->scale); }

bool blade_admits(const Blade *b, Vec2 p)
{
    /* a segment at the end of growth: in the isogonic frame that is 1; nonuniform growth would carry off what is outside */
    const double by = 1.0;
    if (blade_contains(b, p))
        return true;
    if (box_dist2(b->box, p) > by * by || (b->moving && b->step < b->last_step))
        return false;
    double scale = b->moving ? 1.0 : b->scale;
    Vec2 u = vec_scale(p, 1.0 / scale);
    uint32_t edge;
    Vec2 rim = polygon_nearest(b->moving ? b->shape : b->leaf, u, &edge);
    if (vec_dist2(rim, u) * scale * scale > by * by)
        return false;
    if (b->n_back == 0 || b->scale >= b->last_length)
        return true;
    Vec2 from = b->leaf->v[edge], to = b->leaf->v[edge + 1 < b->leaf->n ? edge + 1 : 0];
    return vec_cross(from, to) >= 0.0 && stays(b, rim, b->scale / b->last_length);
}

uint32_t blade_step_passed(const Blade *b, Vec2 p)
{
    uint32_t lo = 0, hi = b->last_step;
    while (lo < hi) {
        uint32_t mid = lo + (hi - lo) / 2;
        if (contains_at(b, p, blade_scale_at(b, mid)))
            hi = mid;
        else
            lo = mid + 1;
    }
    return lo;
}
