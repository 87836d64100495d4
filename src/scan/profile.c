#include "scan/profile.h"

#include <math.h>

#include "geom/march.h"
#include "geom/ring.h"
#include "scan/axis.h"
#include "scan/axis_base.h"
#include "scan/gather.h"
#include "scan/mask.h"
#include "scan/sharp.h"
#include "scan/stalk.h"
#include "scan/stalk_over.h"

#define NEAR 0.02          /* given points nearer to the outline than this share of the leaf's extent are meant to lie on it */
#define FAR 0.1            /* given points farther outside are a mistake */
/* A petiole does not show the base when it meets the blade far from either end of the line of best symmetry, as a share of that line, and on a
 * line that is less symmetric by so much: it is bent over the blade. */
#define ASIDE 0.25
#define LESS_SYMMETRIC 0.04
#define FAR_LESS_SYMMETRIC 0.1 /* the line to the farthest point, than that through the middle: the tip is not there */
#define VEINS_SAY 0.02 /* gather_compare beyond which veins tell base from tip, rather than the outline … */
#define VEINS_INSIST 0.12 /* … and beyond which they gainsay a short petiole, which may be the tip of a lobe, */
#define SHORT 0.15        /* one shorter than this share of the axis */
#define PALE 0.5          /* of the way from the threshold to the ground's level: what may still be a vein; */
#define MEND 1.25         /* radius of the disc that closes what pale veins leave open where the petiole meets the blade, and … */
#define MEND_REACH 6.0    /* … how far around, in widths of the petiole */

ProfileDef profile_def_default(void)
{
    return (ProfileDef){.threshold = {CHANNEL_BEST, LEAF_BY_FRAME, -1.0}, .least_area = 0.05, .square = 1, .subpixel = true, .tolerance = 1.0};
}

void profile_free(Profile *p)
{
    if (!p)
        return;
    polygon_free(p->outline);
    g_free(p);
}

static bool check(const Scan *s, const ProfileDef *d, GError **error)
{
    const char *name = NULL;
    double value = 0.0, least = 0.0, most = 65535.0;
#define RANGE(n, v, a, b)                                                                                                            \
    if (!name && !((v) >= (a) && (v) <= (b))) {                                                                                      \
        name = n;                                                                                                                    \
        value = (v);                                                                                                                 \
        least = (a);                                                                                                                 \
        most = (b);                                                                                                                  \
    }
    RANGE("square size", (double)d->square, 1.0, 65535.0)
    RANGE("tolerance", d->tolerance, 0.0, 65535.0)
    RANGE("closing radius", d->close, 0.0, 65535.0)
    RANGE("opening radius", d->open, 0.0, 65535.0)
    RANGE("least area", d->least_area, 0.0, 1.0)
#undef RANGE
    if (name) {
        g_set_error(error, SCAN_ERROR, SCAN_ERROR_VALUE, "%s %g: allowed are %g … %g", name, value, least, most);
        return false;
    }
    if (d->each && (d->has_base || d->has_tip)) {
        g_set_error(error, SCAN_ERROR, SCAN_ERROR_VALUE, "a base or tip can be given for one leaf, but not when each leaf is captured");
        return false;
    }
    return true;
}

/* What is at hand while one leaf of a scan is captured. */
typedef struct {
    const Scan *scan;
    const ProfileDef *def;
    const Threshold *threshold; /* NULL: the mask was made otherwise */
    const Mask *mask;
    MaskBox box;
    Stalk stalk;
    Profile *out;
} Capture;

static double level_of(const void *user, uint32_t x, uint32_t y)
{
    const Capture *c = user;
    return channel_value(c->scan, c->threshold->channel, x, y);
}

/* From columns and rows of the leaf's box to y-up pixel units. */
static Vec2 upright(const Capture *c, Vec2 p)
{
    return vec2(c->box.x0 + p.x + 0.5, c->mask->height - (c->box.y0 + p.y + 0.5));
}

/* Pixels that the leaf encloses. */
static double enclosed(const Capture *c, uint8_t stalk)
{
    uint64_t n = 0;
    Mask w = mask_window(c->mask, c->box);
    for (uint32_t y = 0; y < w.height; y++)
        for (uint32_t x = 0; x < w.width; x++)
            n += (*mask_at(&w, x, y) & (MASK_HOLE | stalk)) == MASK_HOLE;
    return (double)n;
}

static void measure(const Capture *c, const Polygon *outline)
{
    Profile *o = c->out;
    o->area = outline->area;
    o->perimeter = ring_length(outline);
    o->nodes = outline->n;
    o->beyond = enclosed(c, c->def->keep_stalk ? 0 : MASK_STALK);
}

/* The outline as traced, with or without the petiole; NULL when the square is too large to meet the leaf. */
static Polygon *trace(Capture *c, bool stalk)
{
    uint8_t test = MASK_THIS | (stalk ? 0 : MASK_STALK);
    MarchField f = {.px = c->mask->px, .width = c->mask->width, .height = c->mask->height, .test = test, .want = MASK_THIS,
                    .x0 = c->box.x0, .y0 = c->box.y0, .x1 = c->box.x1, .y1 = c->box.y1,
                    .level = c->def->subpixel && c->threshold ? level_of : NULL, .user = c,
                    .threshold = c->threshold ? c->threshold->level : 0.0};
    MarchLoops *l = march_loops(&f, c->def->square);
    uint32_t k = march_largest(l);
    Polygon *p = NULL;
    if (k < l->n) {
        p = polygon_new(l->p + l->start[k], l->start[k + 1] - l->start[k]);
        Polygon *whole = f.level && c->def->square == 1 && !(c->def->open > 0.0) ? sharp_ends(p, c->scan, c->threshold, c->mask, stalk ? 0 : MASK_STALK, NULL) : NULL;
        if (whole) {
            polygon_free(p);
            p = whole;
        }
        if (stalk == c->def->keep_stalk)
            measure(c, p);
    }
    march_loops_free(l);
    return p;
}

static double extent(const Polygon *p) { return vec_dist(vec2(p->box.x0, p->box.y0), vec2(p->box.x1, p->box.y1)); }

/* A point given by hand: moved onto the outline when near to it. */
static bool take_given(const Polygon *p, uint32_t height, const char *name, Vec2 given, Vec2 *out, GError **error)
{
    *out = polygon_nearest(p, given, NULL);
    double far = vec_dist(*out, given), size = extent(p);
    if (far <= NEAR * size)
        return true;
    if (!(far <= FAR * size) && !polygon_contains(p, given)) {
        g_set_error(error, SCAN_ERROR, SCAN_ERROR_VALUE,
                    "scan.%s %g,%g lies %.0f pixels outside the leaf, which spans x %.0f … %.0f, y %.0f … %.0f (pixels from the upper left corner)", name,
                    given.x, height - given.y, far, p->box.x0, p->box.x1, height - p->box.y1, height - p->box.y0);
        return false;
    }
    *out = given;
    return true;
}

static Vec2 farthest(const Polygon *p, Vec2 from)
{
    Vec2 best = p->v[0];
    for (uint32_t i = 1; i < p->n; i++)
        if (vec_dist2(p->v[i], from) > vec_dist2(best, from))
            best = p->v[i];
    return best;
}

/* Farthest from the base; but lobes beside a notch at the tip reach farther than it, and so do corners: then where symmetry says. */
static Vec2 find_tip(const Axis *axis, Vec2 base)
{
    Vec2 far = farthest(axis->outline, base), opposite = axis_opposite(axis, base);
    bool better = axis_symmetry(axis, base, far) < axis_symmetry(axis, base, opposite) - FAR_LESS_SYMMETRIC;
    return better ? opposite : far;
}

/* Base by petiole, if that lies about where a leaf can have it, else the end of the line of symmetry that the veins say, or the outline where they
 * don't show. */
static void find_base(Capture *c, const Axis *axis)
{
    Profile *o = c->out;
    Vec2 tip, stalk = upright(c, c->stalk.base);
    double best = axis_find(axis, &o->base, &tip), near = ASIDE * vec_dist(o->base, tip);
    o->base_from = BASE_AXIS;
    bool shown = o->has_stalk && (vec_dist(stalk, o->base) <= near || vec_dist(stalk, tip) <= near ||
                                  axis_symmetry(axis, stalk, axis->middle) >= best - LESS_SYMMETRIC);
    if (shown && c->stalk.length < SHORT * vec_dist(o->base, tip))
        shown = gather_compare(c->scan, axis->outline, stalk, axis_opposite(axis, stalk)) > -VEINS_INSIST;
    if (!shown) {
        if (gather_compare(c->scan, axis->outline, o->base, tip) < -VEINS_SAY)
            o->base = tip;
        o->base = axis_base(axis, c->scan, o->base, c->def->has_tip ? c->def->tip : find_tip(axis, o->base));
        return;
    }
    o->base = c->def->keep_stalk ? stalk : polygon_nearest(axis->outline, stalk, NULL);
    o->base_from = BASE_STALK;
}

/* `whole` is the outline that is wanted, `blade` the one without petiole. */
static bool find_ends(Capture *c, const Polygon *whole, const Polygon *blade, GError **error)
{
    Profile *o = c->out;
    Axis axis;
    axis_init(&axis, blade);
    bool ok = true;
    if (c->def->has_base) {
        o->base_from = BASE_GIVEN;
        ok = take_given(whole, c->mask->height, "base", c->def->base, &o->base, error);
    } else {
        find_base(c, &axis);
    }
    if (ok && c->def->has_tip)
        ok = take_given(whole, c->mask->height, "tip", c->def->tip, &o->tip, error);
    else
        o->tip = find_tip(&axis, o->base);
    if (ok && !(vec_dist2(o->base, o->tip) > 0.0)) {
        g_set_error(error, SCAN_ERROR, SCAN_ERROR_VALUE, "base and tip are the same point, %g,%g from the upper left corner", o->base.x,
                    c->mask->height - o->base.y);
        ok = false;
    }
    o->symmetry = axis_symmetry(&axis, o->base, o->tip);
    axis_clear(&axis);
    return ok;
}

/* The polygon with its boundary point nearest to q as vertex 0; put in where no vertex is near. */
static Polygon *start_at(const Polygon *p, Vec2 q)
{
    const double near2 = 0.05 * 0.05;
    uint32_t edge = 0, n = p->n;
    Vec2 at = polygon_nearest(p, q, &edge), *v = g_new(Vec2, (gsize)n + 1);
    uint32_t next = edge + 1 < n ? edge + 1 : 0, first = vec_dist2(p->v[edge], at) <= near2 ? edge : next, m = 0;
    if (vec_dist2(p->v[first], at) > near2)
        v[m++] = at;
    for (uint32_t i = 0; i < n; i++)
        v[m++] = p->v[(first + i) % n];
    Polygon *out = polygon_new(v, m);
    g_free(v);
    return out;
}

static uint32_t nearest_vertex(const Polygon *p, Vec2 q)
{
    uint32_t best = 0;
    for (uint32_t i = 1; i < p->n; i++)
        if (vec_dist2(p->v[i], q) < vec_dist2(p->v[best], q))
            best = i;
    return best;
}

static Polygon *finish(const Capture *c, const Polygon *traced)
{
    const Profile *o = c->out;
    bool by_stalk = c->def->keep_stalk && o->has_stalk && o->base_from == BASE_STALK;
    Polygon *tipped = start_at(traced, o->tip), *based = start_at(tipped, by_stalk ? o->stalk_end : o->base);
    bool *must = g_new0(bool, based->n);
    must[nearest_vertex(based, o->tip)] = true;
    Polygon *p = ring_simplify(based, c->def->tolerance, must);
    g_free(must);
    polygon_free(tipped);
    polygon_free(based);
    return p;
}

/* Mean level of what lies around the leaf in its box; the threshold's where nothing does. */
static double ground_level(const Capture *c)
{
    double sum = 0.0, n = 0.0;
    for (uint32_t y = c->box.y0; y <= c->box.y1; y++)
        for (uint32_t x = c->box.x0; x <= c->box.x1; x++)
            if (!(*mask_at(c->mask, x, y) & (MASK_LEAF | MASK_THIS))) {
                sum += level_of(c, x, y);
                n += 1.0;
            }
    return n > 0.0 ? sum / n : c->threshold->level;
}

typedef struct {
    const Capture *capture;
    double most; /* off the threshold's level: still clearly no ground */
} Pale;

static bool is_plant(const void *user, uint32_t x, uint32_t y)
{
    const Pale *p = user;
    const Threshold *t = p->capture->threshold;
    double off = level_of(p->capture, p->capture->box.x0 + x, p->capture->box.y0 + y) - t->level;
    return (t->dark ? off : -off) <= p->most;
}

/* Veins run together where the petiole meets the blade, and may be paler there than the threshold, though not as pale as the ground: slits and bites
 * that they leave in the blade are closed. */
static void mend_base(const Capture *c, const Mask *w, const Stalk *s)
{
    const double most = PALE * fabs(ground_level(c) - c->threshold->level);
    const double r = MEND * s->width, reach = MEND_REACH * s->width, around = reach + 2.0 * r + 2.0;
    const uint8_t blade = MASK_THIS | MASK_STALK;
    MaskBox b = {(uint32_t)MAX(0.0, s->base.x - around), (uint32_t)MAX(0.0, s->base.y - around), (uint32_t)MIN(w->width - 1.0, s->base.x + around),
                 (uint32_t)MIN(w->height - 1.0, s->base.y + around)};
    Mask m = mask_window(w, b);
    for (uint32_t y = 0; y < m.height; y++)
        for (uint32_t x = 0; x < m.width; x++) {
            uint8_t *px = mask_at(&m, x, y);
            *px = (uint8_t)((*px & ~MASK_WORK) | ((*px & blade) == MASK_THIS ? MASK_WORK : 0));
        }
    mask_dilate(&m, MASK_WORK, MASK_WORK, r);
    mask_erode(&m, MASK_WORK, MASK_WORK, r);
    for (uint32_t y = 0; y < m.height; y++)
        for (uint32_t x = 0; x < m.width; x++) {
            uint8_t *px = mask_at(&m, x, y);
            double level = level_of(c, c->box.x0 + b.x0 + x, c->box.y0 + b.y0 + y);
            if ((*px & (MASK_WORK | MASK_THIS)) == MASK_WORK && fabs(level - c->threshold->level) <= most &&
                vec_dist(vec2(b.x0 + x, b.y0 + y), s->base) <= reach)
                *px |= MASK_THIS;
        }
    mask_clear(&m, MASK_WORK);
}

/* A petiole that is bent over the blade, which was traced with a slit where it is as pale as the ground: true when that is mended. */
static bool uncover(Capture *c, const Mask *w, const Polygon *blade)
{
    Profile *o = c->out;
    bool as_usual = o->has_stalk && o->base_from == BASE_STALK;
    StalkOver *over = as_usual || c->def->keep_stalk ? NULL : stalk_over_find(c->scan, blade, c->threshold, o->base);
    if (!over)
        return false;
    stalk_over_mend(over, w, upright(c, vec2(0.0, 0.0)));
    o->has_stalk = true;
    o->stalk_end = over->point[0].p;
    o->stalk_width = over->width;
    o->stalk_length = over->length;
    stalk_over_free(over);
    return true;
}

static bool capture_leaf(Capture *c, GError **error)
{
    Profile *o = c->out;
    Mask window = mask_window(c->mask, c->box);
    o->mm_per_pixel = c->scan->mm_per_pixel;
    o->has_stalk = stalk_find(&window, &c->stalk);
    if (o->has_stalk) {
        if (c->threshold) {
            Pale pale = {c, PALE * fabs(ground_level(c) - c->threshold->level)};
            mend_base(c, &window, &c->stalk);
            c->stalk.base = stalk_middle(&window, &c->stalk, is_plant, &pale);
        }
        o->stalk_end = upright(c, c->stalk.end);
        o->stalk_width = c->stalk.width;
        o->stalk_length = c->stalk.length;
    }
    Polygon *blade = trace(c, false), *whole = c->def->keep_stalk ? trace(c, true) : blade;
    if (!blade) {
        g_set_error(error, SCAN_ERROR, SCAN_ERROR_NO_LEAF, "no leaf: squares of %u pixels step over the largest part, %u × %u pixels",
                    c->def->square, window.width, window.height);
        if (whole != blade)
            polygon_free(whole);
        return false;
    }
    bool ok = find_ends(c, whole, blade, error);
    if (ok && uncover(c, &window, blade)) {
        polygon_free(blade);
        whole = blade = trace(c, false);
        ok = find_ends(c, whole, blade, error);
    }
    if (ok)
        o->outline = finish(c, whole);
    polygon_free(blade);
    if (whole != blade)
        polygon_free(whole);
    return ok;
}

/* One leaf or each of them; small ones among several that the square steps over are left out. */
static bool capture_all(Capture *c, const GArray *parts, GPtrArray *out, GError **error)
{
    bool ok = true;
    for (guint i = 0; ok && i < (c->def->each ? parts->len : 1); i++) {
        const Component *part = &g_array_index(parts, Component, i);
        c->box = part->box;
        c->out = g_new0(Profile, 1);
        g_ptr_array_add(out, c->out);
        mask_take(c->mask, part);
        ok = capture_leaf(c, i == 0 ? error : NULL);
        if (!ok && i > 0) { /* nothing else can fail where no ends are given */
            g_ptr_array_remove_index(out, out->len - 1);
            ok = true;
        }
        Mask window = mask_window(c->mask, c->box);
        mask_clear(&window, (uint8_t)~(MASK_LEAF | MASK_SEEN));
    }
    return ok;
}

/* `t` is NULL where the mask was made otherwise. */
static GPtrArray *capture_mask(const Scan *s, const Mask *m, const Threshold *t, const ProfileDef *def, GError **error)
{
    if (def->close > 0.0) {
        mask_dilate(m, MASK_LEAF, MASK_LEAF, def->close);
        mask_erode(m, MASK_LEAF, MASK_LEAF, def->close);
    }
    if (def->open > 0.0) {
        mask_erode(m, MASK_LEAF, MASK_LEAF, def->open);
        mask_dilate(m, MASK_LEAF, MASK_LEAF, def->open);
    }
    GArray *parts = mask_components(m, def->least_area);
    GPtrArray *out = g_ptr_array_new_with_free_func((GDestroyNotify)profile_free);
    Capture c = {.scan = s, .def = def, .threshold = t, .mask = m};
    bool ok = parts->len > 0;
    if (!ok && t)
        g_set_error(error, SCAN_ERROR, SCAN_ERROR_NO_LEAF, "no leaf: nothing is %s than %g in the %s channel but the edge of the image",
                    t->dark ? "darker" : "lighter", t->level, channel_name(t->channel));
    else if (!ok)
        g_set_error_literal(error, SCAN_ERROR, SCAN_ERROR_NO_LEAF, "no leaf: nothing is marked but the edge of the image");
    ok = ok && capture_all(&c, parts, out, error);
    g_array_free(parts, TRUE);
    if (!ok) {
        g_ptr_array_free(out, TRUE);
        return NULL;
    }
    return out;
}

GPtrArray *profile_capture(const Scan *s, const ProfileDef *def, Threshold *used, GError **error)
{
    Threshold t;
    if (!check(s, def, error) || !threshold_find(s, &def->threshold, &t, error))
        return NULL;
    if (used)
        *used = t;
    Mask m = {s->width, s->height, s->width, g_try_malloc((gsize)s->width * s->height)};
    if (!m.px) {
        g_set_error(error, SCAN_ERROR, SCAN_ERROR_SIZE, "no memory to mark %u × %u pixels", s->width, s->height);
        return NULL;
    }
    threshold_apply(s, &t, m.px);
    GPtrArray *out = capture_mask(s, &m, &t, def, error);
    g_free(m.px);
    return out;
}

GPtrArray *profile_capture_mask(const Scan *s, const Mask *m, const ProfileDef *def, GError **error)
{
    g_assert(m->width == s->width && m->height == s->height && m->stride == s->width);
    return check(s, def, error) ? capture_mask(s, m, NULL, def, error) : NULL;
}
