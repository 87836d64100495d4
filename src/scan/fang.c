#include "scan/fang.h"

#include <math.h>

#include "scan/fang_draw.h"
#include "scan/fang_edges.h"
#include "scan/fang_outline.h"
#include "scan/fang_region.h"
#include "scan/fang_rough.h"
#include "scan/profile.h"
#include "scan/sharp.h"

#define MARGIN 8.0 /* around the leaf's box, pixels, besides the reach of smoothing */
#define GROUND 64.0 /* around it, pixels: enough to tell what the ground's noise is */
#define ENOUGH 0.5 /* of the margin must have edges, or it is not they that the contour follows */
/* How much more or less than the rough region the edges may enclose: of its area, and of its margin, pixels (small leaves). */
#define OFF_AREA 0.015
#define OFF_MARGIN 0.5

FangDef fang_def_default(void)
{
    return (FangDef){.threshold = {CHANNEL_BEST, LEAF_BY_FRAME, -1.0}, .least_area = 0.05, .leaf = 1, .edges = edges_def_default(), .corners = corners_def_default(), .fit = bezierfit_def_default()};
}

void fang_profile_free(FangProfile *p)
{
    if (!p)
        return;
    polygon_free(p->border);
    polygon_free(p->contour);
    if (p->corners)
        g_array_unref(p->corners);
    bezierfit_free(p->fit);
    polygon_free(p->outline);
    g_free(p);
}

/* The pixels around a polygon and some more. */
static MaskBox around(const Scan *s, Box2 b, double margin)
{
    double w = s->width - 1.0, h = s->height - 1.0;
    return (MaskBox){(uint32_t)CLAMP(floor(b.x0 - margin), 0.0, w), (uint32_t)CLAMP(floor(s->height - b.y1 - margin), 0.0, h),
                     (uint32_t)CLAMP(ceil(b.x1 + margin), 0.0, w), (uint32_t)CLAMP(ceil(s->height - b.y0 + margin), 0.0, h)};
}

/* Whether the edges can be the leaf's margin. */
static bool check_region(const FangProfile *p, MaskBox box, GError **error)
{
    const FangMatch *r = &p->region;
    double around = 2.0 * ((box.x1 - box.x0 + 1.0) + (box.y1 - box.y0 + 1.0));
    const char *channel = channel_name(p->threshold.channel);
    if (!(r->continuity >= ENOUGH))
        g_set_error(error, SCAN_ERROR, SCAN_ERROR_NO_LEAF,
                    "no leaf: the edges in the %s channel follow %.0f %% of its margin, half is needed; try another operator, smoothing or thresholds",
                    channel, 100.0 * r->continuity);
    else if (!(fabs(r->area - r->rough) <= OFF_AREA * r->rough + OFF_MARGIN * around))
        g_set_error(error, SCAN_ERROR, SCAN_ERROR_NO_LEAF,
                    "no leaf: the edges in the %s channel enclose %.0f pixels where %.0f are leaf, which is %+.1f %%; about 2 %% are allowed; try another "
                    "operator or less smoothing, or another scan.channel or scan.threshold",
                    channel, r->area, r->rough, 100.0 * (r->area / r->rough - 1.0));
    else
        return true;
    return false;
}

/* Edges, and the region that they enclose. */
static bool find_region(const Scan *s, const Mask *m, MaskBox leaf, FangProfile *out, GError **error)
{
    double sigma = isfinite(out->used.sigma) ? CLAMP(out->used.sigma, 0.0, 100.0) : 0.0;
    MaskBox box = around(s, (Box2){leaf.x0, s->height - 1.0 - leaf.y1, leaf.x1 + 1.0, s->height - (double)leaf.y0}, GROUND + fang_band(sigma) + 5.0 * sigma);
    FangGrey grey = fang_grey(s, out->threshold.channel, box);
    Mask w = mask_window(m, box);
    double level = s->depth == 8 ? out->threshold.level : out->threshold.level / 257.0;
    if (!fang_choose_edges(&grey, level, &w, &out->used, error) || !edges_check(&out->used, error))
        return false;
    out->region = fang_region(&grey, &out->used, &w);
    return check_region(out, leaf, error);
}

/* The border of the largest region enclosed, without the petiole, starting at the base. */
static bool find_border(const Scan *s, const Mask *m, const FangDef *def, FangProfile *out, GError **error)
{
    ProfileDef how = profile_def_default();
    how.subpixel = false;
    how.tolerance = 0.0;
    how.keep_stalk = def->keep_stalk;
    how.has_base = def->has_base;
    how.has_tip = def->has_tip;
    how.base = def->base;
    how.tip = def->tip;
    GError *why = NULL;
    GPtrArray *leaf = profile_capture_mask(s, m, &how, &why);
    if (!leaf) {
        if (!g_error_matches(why, SCAN_ERROR, SCAN_ERROR_NO_LEAF)) {
            g_propagate_error(error, why);
            return false;
        }
        g_set_error(error, SCAN_ERROR, SCAN_ERROR_NO_LEAF, "no leaf: the edges in the %s channel enclose nothing", channel_name(out->threshold.channel));
        g_error_free(why);
        return false;
    }
    const Profile *p = leaf->pdata[0];
    out->border = polygon_new(p->outline->v, p->outline->n);
    out->mm_per_pixel = p->mm_per_pixel;
    out->base = 0;
    for (uint32_t i = 1; i < out->border->n; i++)
        if (!out->tip || vec_dist2(out->border->v[i], p->tip) < vec_dist2(out->border->v[out->tip], p->tip))
            out->tip = i;
    g_ptr_array_free(leaf, TRUE);
    return true;
}

/* Marks what lies within the border, and what is leaf beyond it: the petiole. */
static void mark_border(const Scan *s, const Mask *m, const Polygon *border)
{
    MaskBox b = around(s, border->box, GROUND);
    for (uint32_t y = b.y0; y <= b.y1; y++)
        for (uint32_t x = b.x0; x <= b.x1; x++) {
            uint8_t *px = mask_at(m, x, y);
            bool in = polygon_contains(border, vec2(x + 0.5, s->height - (y + 0.5)));
            *px = (uint8_t)((*px & MASK_LEAF) | (in ? MASK_THIS : *px & MASK_LEAF ? MASK_STALK : 0));
        }
}

/* The contour's tips go on as those of any outline. */
static void sharpen(const Scan *s, const Mask *m, FangProfile *out)
{
    uint32_t *at = g_new(uint32_t, out->contour->n);
    mark_border(s, m, out->border);
    Polygon *sharp = sharp_ends(out->contour, s, &out->threshold, m, MASK_STALK, at);
    if (sharp) {
        out->tip = at[out->tip];
        polygon_free(out->contour);
        out->contour = sharp;
    }
    g_free(at);
}

static void find_contour(const Scan *s, FangProfile *out)
{
    EdgesOperator op = fang_broad(out->used.op);
    MaskBox box = around(s, out->border->box, MARGIN + 5.0 * out->used.sigma);
    FangGrey grey = fang_grey(s, out->threshold.channel, box);
    FangSparse *response = fang_sparse_new(grey.width, grey.height);
    for (uint32_t i = 0; i < out->border->n; i++)
        fang_sparse_want_around(response, out->border->v[i].x - box.x0, s->height - out->border->v[i].y - box.y0, FANG_DRAW_REACH);
    fang_sparse_respond(response, &grey, op, out->used.sigma);
    Strength strength = {response, op, vec2(box.x0, box.y0), s->width, s->height};
    out->contour = fang_draw(out->border, &strength);
    fang_sparse_free(response);
}

/* Corners of a part of a scan whose grey range is known. */
typedef struct {
    const CornersDef *def;
    double least, most;
} Harris;

static GreyImage *harris(const GreyImage *in, const void *user)
{
    const Harris *h = user;
    GreyImage *out = corners_response_in(in, h->least, h->most, h->def, NULL);
    g_assert(out);
    return out;
}

static float read_sparse(const void *user, uint32_t x, uint32_t y) { return fang_sparse_at(user, x, y); }

static GArray *corners_near(const FangGrey *grey, const Vec2 *v, uint32_t n, const FangProfile *p, const CornersDef *given, GError **error)
{
    CornersDef used = corners_scaled(given, v, n), *def = &used;
    FangSparse *response = fang_sparse_new(grey->width, grey->height);
    for (uint32_t i = 0; i < n; i++)
        fang_sparse_want_around(response, v[i].x, v[i].y, def->window + 2.0);
    Harris h = {.def = def};
    fang_grey_range(grey, &h.least, &h.most);
    fang_sparse_fill(response, grey, (uint32_t)ceil(4.0 * (def->smoothing + def->window)) + 3, harris, &h);
    CornersField field = {grey->width, grey->height, read_sparse, response};
    GArray *found = corners_choose(&field, v, n, p->base, p->tip, def, error);
    fang_sparse_free(response);
    return found;
}

static bool find_corners(const Scan *s, const FangDef *def, FangProfile *out, GError **error)
{
    if (!corners_check(&def->corners, error))
        return false;
    MaskBox box = around(s, out->contour->box, MARGIN + 4.0 * (def->corners.smoothing + def->corners.window));
    FangGrey grey = fang_grey(s, out->threshold.channel, box);
    uint32_t n = out->contour->n;
    Vec2 *down = g_new(Vec2, n);
    for (uint32_t i = 0; i < n; i++)
        down[i] = vec2(out->contour->v[i].x - box.x0, s->height - out->contour->v[i].y - box.y0);
    out->corners = corners_near(&grey, down, n, out, &def->corners, error);
    g_free(down);
    return out->corners != NULL;
}

static bool find_fit(const FangDef *def, FangProfile *out, GError **error)
{
    GArray *at = g_array_new(FALSE, FALSE, sizeof(uint32_t));
    for (guint k = 0; k < out->corners->len; k++)
        g_array_append_val(at, g_array_index(out->corners, Corner, k).at);
    out->fit = fang_fit(out->contour, at, out->base, out->tip, &def->fit, &out->outline, error);
    g_array_unref(at);
    return out->fit != NULL;
}

static bool capture(const Scan *s, const Mask *m, const FangDef *def, FangProfile *out, GError **error)
{
    MaskBox leaf;
    if (!fang_rough(s, &out->threshold, def, m, &leaf, error) || !find_region(s, m, leaf, out, error) || !find_border(s, m, def, out, error))
        return false;
    find_contour(s, out);
    if (!(def->open > 0.0))
        sharpen(s, m, out);
    return find_corners(s, def, out, error) && find_fit(def, out, error);
}

FangProfile *fang_capture(const Scan *s, const FangDef *def, GError **error)
{
    Threshold t;
    if (!threshold_find(s, &def->threshold, &t, error))
        return NULL;
    Mask m = {s->width, s->height, s->width, g_try_malloc((gsize)s->width * s->height)};
    if (!m.px) {
        g_set_error(error, SCAN_ERROR, SCAN_ERROR_SIZE, "no memory to mark %u × %u pixels", s->width, s->height);
        return NULL;
    }
    FangProfile *out = g_new0(FangProfile, 1);
    out->threshold = t;
    out->used = def->edges;
    bool ok = capture(s, &m, def, out, error);
    g_free(m.px);
    if (ok)
        return out;
    fang_profile_free(out);
    return NULL;
}
