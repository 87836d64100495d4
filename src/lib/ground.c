#include "lib/ground.h"

#include "import/drawing_file.h"
#include "lib/settings.h"
#include "scan/fill.h"
#include "scan/found.h"

/* ---- coordinates ---- */

/* Source units, y up, to leaf coordinates: base to 0,0, tip to 0,1. */
static Vec2 to_leaf(const Ground *g, Vec2 p)
{
    Vec2 axis = vec_sub(g->tip, g->base), q = vec_sub(p, g->base);
    double by = 1.0 / vec_norm2(axis);
    return vec2(vec_cross(q, axis) * by, vec_dot(q, axis) * by);
}

/* Leaf coordinates to columns and rows of an image of that height whose y-up pixels the ends are in. */
static Affine to_pixels(Vec2 base, Vec2 tip, uint32_t height)
{
    Vec2 axis = vec_sub(tip, base);
    return (Affine){.a = axis.y, .b = axis.x, .c = axis.x, .d = -axis.y, .e = base.x, .f = height - base.y};
}

static Polygon *leaf_outline(const Ground *g, const Polygon *outline)
{
    Vec2 *v = g_new(Vec2, outline->n);
    for (uint32_t i = 0; i < outline->n; i++)
        v[i] = to_leaf(g, outline->v[i]);
    Polygon *p = polygon_new(v, outline->n);
    g_free(v);
    return p;
}

/* ---- the scan ---- */

static gboolean read_scan(const Params *p, ParamId id, Scan **scan, GError **error)
{
    const char *file = params_text(p, id);
    if (!*file)
        return TRUE;
    *scan = scan_read(file, 0, error);
    return *scan != NULL;
}

/* Names the image in what went wrong with it. */
static gboolean blame(const Params *p, ParamId id, GError **error)
{
    g_prefix_error(error, "%s: ", params_text(p, id));
    return FALSE;
}

/* ---- sheets ---- */

struct GroundScan {
    Scan *scan;
    GPtrArray *profile; /* Profile; NULL for those that were given away */
    Threshold threshold;
};

GroundScan *ground_scan_new(const Params *p, GError **error)
{
    GroundScan *sheet = g_new0(GroundScan, 1);
    if (read_scan(p, PARAM_SCAN_FILE, &sheet->scan, error) && sheet->scan) {
        ProfileDef def = settings_profile(p, sheet->scan->height);
        def.each = true;
        def.has_base = def.has_tip = false;
        sheet->profile = profile_capture(sheet->scan, &def, &sheet->threshold, error);
        if (sheet->profile)
            return sheet;
        blame(p, PARAM_SCAN_FILE, error);
    } else if (!*params_text(p, PARAM_SCAN_FILE)) {
        g_set_error(error, SETTINGS_ERROR, SETTINGS_ERROR_CONFLICT, "scan.file is not given, so there is no scan to look for leaves in");
    }
    ground_scan_free(sheet);
    return NULL;
}

uint32_t ground_scan_leaves(const GroundScan *sheet) { return sheet->profile->len; }

void ground_scan_free(GroundScan *sheet)
{
    if (!sheet)
        return;
    if (sheet->profile)
        g_ptr_array_unref(sheet->profile); /* what was given away is NULL there */
    scan_free(sheet->scan);
    g_free(sheet);
}

/* The leaf of the parameters, if the sheet still has it as they want it. */
static bool take_profile(Ground *g, const Params *p, GroundScan *sheet)
{
    gint64 which = params_integer(p, PARAM_SCAN_LEAF);
    uint32_t base, tip;
    params_list(p, PARAM_SCAN_BASE, &base);
    params_list(p, PARAM_SCAN_TIP, &tip);
    if (!sheet || base || tip || which > sheet->profile->len || !sheet->profile->pdata[which - 1])
        return false;
    g->profile = g_steal_pointer(&sheet->profile->pdata[which - 1]);
    g->threshold = sheet->threshold;
    return true;
}

/* ---- the outline in the scan ---- */

static gboolean capture_profile(Ground *g, const Params *p, GError **error)
{
    ProfileDef def = settings_profile(p, g->scan->height);
    uint32_t which = (uint32_t)params_integer(p, PARAM_SCAN_LEAF);
    def.each = which > 1;
    GPtrArray *all = profile_capture(g->scan, &def, &g->threshold, error);
    if (!all)
        return blame(p, PARAM_SCAN_FILE, error);
    if (which <= all->len)
        g->profile = g_ptr_array_steal_index(all, which - 1);
    else
        g_set_error(error, SETTINGS_ERROR, SETTINGS_ERROR_CONFLICT, "%s: scan.leaf is %u, but there %s %u in the image",
                    params_text(p, PARAM_SCAN_FILE), which, all->len == 1 ? "is" : "are", all->len);
    g_ptr_array_unref(all);
    return g->profile != NULL;
}

static gboolean find_profile(Ground *g, const Params *p, GroundScan *sheet, GError **error)
{
    if (!take_profile(g, p, sheet) && !capture_profile(g, p, error))
        return FALSE;
    g->base = g->profile->base;
    g->tip = g->profile->tip;
    g->outline = leaf_outline(g, g->profile->outline);
    return TRUE;
}

static gboolean find_fang(Ground *g, const Params *p, GError **error)
{
    FangDef def = settings_fang(p, g->scan->height);
    g->fang = fang_capture(g->scan, &def, error);
    if (!g->fang)
        return blame(p, PARAM_SCAN_FILE, error);
    g->base = g->fang->contour->v[g->fang->base];
    g->tip = g->fang->contour->v[g->fang->tip];
    g->outline = leaf_outline(g, g->fang->outline);
    return TRUE;
}

/* ---- the other side ---- */

/* The affine map that takes points `from` to points `to` best, by least squares. */
static Affine fit_affine(const Vec2 *from, const Vec2 *to, uint32_t n)
{
    Vec2 f0 = vec2(0, 0), t0 = vec2(0, 0);
    for (uint32_t i = 0; i < n; i++) {
        f0 = vec_add(f0, vec_scale(from[i], 1.0 / n));
        t0 = vec_add(t0, vec_scale(to[i], 1.0 / n));
    }
    double xx = 0, xy = 0, yy = 0, xu = 0, xv = 0, yu = 0, yv = 0;
    for (uint32_t i = 0; i < n; i++) {
        Vec2 f = vec_sub(from[i], f0), t = vec_sub(to[i], t0);
        xx += f.x * f.x, xy += f.x * f.y, yy += f.y * f.y;
        xu += f.x * t.x, yu += f.y * t.x, xv += f.x * t.y, yv += f.y * t.y;
    }
    double det = xx * yy - xy * xy;
    Affine m = {.a = (yy * xu - xy * yu) / det, .c = (xx * yu - xy * xu) / det, .b = (yy * xv - xy * yv) / det, .d = (xx * yv - xy * xv) / det};
    m.e = t0.x - m.a * f0.x - m.c * f0.y;
    m.f = t0.y - m.b * f0.x - m.d * f0.y;
    return m;
}

/* n points evenly along the margin. */
static void sample_margin(const Polygon *p, Vec2 *out, uint32_t n)
{
    double whole = 0.0, gone = 0.0;
    for (uint32_t k = 0; k < p->n; k++)
        whole += vec_dist(p->v[k], p->v[(k + 1) % p->n]);
    for (uint32_t i = 0, k = 0; i < n; i++) {
        double want = whole * i / n, length;
        while (gone + (length = vec_dist(p->v[k], p->v[(k + 1) % p->n])) < want && k + 1 < p->n) {
            gone += length;
            k++;
        }
        out[i] = vec_lerp(p->v[k], p->v[(k + 1) % p->n], length > 0.0 ? CLAMP((want - gone) / length, 0.0, 1.0) : 0.0);
    }
}

Affine ground_align_back(const Polygon *outline, const Profile *back, uint32_t height)
{
    enum { ROUNDS = 40, SAMPLES = 720 };
    Ground other = {.base = back->base, .tip = back->tip};
    Polygon *seen = leaf_outline(&other, back->outline);
    Affine m = {.a = -1.0, .d = 1.0}; /* leaf coordinates to the back's: mirrored */
    Vec2 *from = g_new(Vec2, SAMPLES), *to = g_new(Vec2, SAMPLES);
    sample_margin(outline, from, SAMPLES);
    for (int round = 0; round < ROUNDS; round++) {
        for (uint32_t i = 0; i < SAMPLES; i++)
            to[i] = polygon_nearest(seen, affine_apply(&m, from[i]), NULL);
        m = fit_affine(from, to, SAMPLES);
    }
    g_free(from);
    g_free(to);
    polygon_free(seen);
    Affine pixels = to_pixels(back->base, back->tip, height);
    return affine_multiply(&pixels, &m);
}

static gboolean read_back(Ground *g, const Params *p, GError **error)
{
    if (!read_scan(p, PARAM_SCAN_BACK, &g->back, error) || !g->back)
        return g->back || !*params_text(p, PARAM_SCAN_BACK);
    ProfileDef def = settings_profile(p, g->back->height);
    def.has_base = def.has_tip = false;
    GPtrArray *all = profile_capture(g->back, &def, NULL, error);
    if (!all)
        return blame(p, PARAM_SCAN_BACK, error);
    g->to_back = ground_align_back(g->outline, all->pdata[0], g->back->height);
    g_ptr_array_unref(all);
    return TRUE;
}

/* ---- drawings ---- */

static bool is_svg(const char *file) { return g_str_has_suffix(file, ".svg") || g_str_has_suffix(file, ".SVG"); }

/* What is wrong with a file that can't be placed, its reader will say. */
static bool place_on_scan(const Ground *g, const Params *p, const char *file, SvgPlace *place)
{
    SvgUnder under = {params_text(p, PARAM_SCAN_FILE), g->scan->width, g->scan->height};
    return svgplace_find(file, &under, place, NULL);
}

static Polygon *drawn_outline(Ground *g, const Params *p, GError **error)
{
    const char *file = params_text(p, PARAM_OUTLINE_FILE);
    SvgPlace place = {0};
    bool placed = g->scan && *file && place_on_scan(g, p, file, &place);
    Polygon *outline = settings_outline(p, placed ? &place : NULL, &g->base, &g->tip, error);
    svgplace_clear(&place);
    return outline;
}

/* ---- veins ---- */

static gboolean read_drawing(Ground *g, const Params *p, GError **error)
{
    const char *file = params_text(p, PARAM_VEINS_DRAWING);
    double height = g->scan ? g->scan->height : 0.0;
    bool svg = is_svg(file);
    SvgPlace place = {0};
    if (!svg && !g->scan) {
        g_set_error(error, SETTINGS_ERROR, SETTINGS_ERROR_CONFLICT,
                    "%s: a text file of lines is in pixels of a scan, so [veins] drawing needs scan.file too", params_origin(p, PARAM_VEINS_DRAWING));
        return FALSE;
    }
    bool placed = svg && g->scan && place_on_scan(g, p, file, &place);
    g->drawing = svg ? drawing_read_svg(file, 1e-3 * vec_dist(g->base, g->tip), placed ? &place.map : NULL, error)
                     : drawing_read_tracing(file, height, error);
    g->drawing_lies = g_steal_pointer(&place.how);
    svgplace_clear(&place);
    if (!g->drawing)
        return FALSE;
    Vec2 down = vec2(0.0, svg ? height : 0.0); /* an SVG's rows run down from its upper left corner, where its y is 0 */
    drawing_to_leaf(g->drawing, vec_sub(g->base, down), vec_sub(g->tip, down));
    return TRUE;
}

/* The outline as it lies in a scan, y-up pixels. */
static Polygon *outline_in(const Ground *g, const Scan *scan, const Affine *to_scan)
{
    Vec2 *v = g_new(Vec2, g->outline->n);
    for (uint32_t i = 0; i < g->outline->n; i++) {
        Vec2 q = affine_apply(to_scan, g->outline->v[i]);
        v[i] = vec2(q.x, scan->height - q.y);
    }
    Polygon *p = polygon_new(v, g->outline->n);
    g_free(v);
    return p;
}

/* A leaf of a few pixels is an outline, and most often a mistake. */
static bool is_speck(Ground *g, const Polygon *outline)
{
    const Box2 *b = &outline->box;
    double across = b->x1 - b->x0, down = b->y1 - b->y0;
    if (MAX(across, down) >= FOUND_SHORTEST)
        return false;
    g_string_append_printf(g->note, "the leaf is only %.3g × %.3g pixels: no veins were looked for", across, down);
    if (g->profile)
        g_string_append_printf(g->note, " (the largest part that is %s than %g in the %s channel measures %.0f px²; see scan.threshold and scan.channel)",
                               g->threshold.dark ? "darker" : "lighter", g->threshold.level / (g->scan->depth == 16 ? 257.0 : 1.0),
                               channel_name(g->threshold.channel), MAX(g->profile->area, 1.0));
    g_string_append_c(g->note, '\n');
    return true;
}

static gboolean find_veins(Ground *g, const Params *p, GError **error)
{
    FoundDef def = settings_found(p);
    Polygon *outline = outline_in(g, g->scan, &g->to_scan);
    if (is_speck(g, outline)) {
        polygon_free(outline);
        return TRUE;
    }
    g->drawing = found_veins(g->scan, outline, g->base, g->tip, &def, error);
    polygon_free(outline);
    if (!g->drawing)
        return blame(p, PARAM_SCAN_FILE, error);
    g->found = true;
    drawing_to_leaf(g->drawing, g->base, g->tip);
    return TRUE;
}

/* ---- all of it ---- */

/* How much of an outline in pixels lies on the edge of the image. */
static double along_edge(const Polygon *p, const Scan *scan)
{
    const double near = 1.0;
    Box2 inner = {near, near, scan->width - near, scan->height - near};
    double whole = 0.0, edge = 0.0;
    for (uint32_t i = 0; i < p->n; i++) {
        Vec2 a = p->v[i], b = p->v[(i + 1) % p->n];
        bool out = (MAX(a.x, b.x) <= inner.x0 || MIN(a.x, b.x) >= inner.x1 || MAX(a.y, b.y) <= inner.y0 || MIN(a.y, b.y) >= inner.y1);
        whole += vec_dist(a, b);
        edge += out ? vec_dist(a, b) : 0.0;
    }
    return edge / whole;
}

static gboolean find_outline(Ground *g, const Params *p, GroundScan *sheet, GError **error)
{
    bool given = *params_text(p, PARAM_OUTLINE_PATH) || *params_text(p, PARAM_OUTLINE_FILE);
    if (g->scan && !given)
        return params_choice(p, PARAM_SCAN_METHOD) == 0 ? find_profile(g, p, sheet, error) : find_fang(g, p, error);
    g->outline = drawn_outline(g, p, error);
    if (g->outline && g->scan) { /* drawn over the scan, whose rows run down from its top */
        g->base.y += g->scan->height;
        g->tip.y += g->scan->height;
    }
    return g->outline != NULL;
}

/* The scans are looked at no more: from here on they are textures. */
static void make_textures(Ground *g, const Params *p)
{
    const double inset = 3.0; /* pixels: what scanners blur */
    enum { AROUND = 64 };
    if (!g->scan || !params_switch(p, PARAM_SCAN_TEXTURE))
        return;
    Polygon *front = outline_in(g, g->scan, &g->to_scan), *back = g->back ? outline_in(g, g->back, &g->to_back) : NULL;
    scan_fill(g->scan, front, g->profile ? &g->threshold : NULL, inset, AROUND);
    if (back)
        scan_fill(g->back, back, NULL, inset, AROUND);
    polygon_free(front);
    polygon_free(back);
}

static gboolean get_scan(Ground *g, const Params *p, const GroundScan *sheet, GError **error)
{
    if (!sheet)
        return read_scan(p, PARAM_SCAN_FILE, &g->scan, error);
    g->scan = scan_copy(sheet->scan);
    if (!g->scan)
        g_set_error(error, SCAN_ERROR, SCAN_ERROR_SIZE, "%s: no memory for another copy of the image", params_text(p, PARAM_SCAN_FILE));
    return g->scan != NULL;
}

static gboolean find(Ground *g, const Params *p, GroundScan *sheet, bool veins, GError **error)
{
    if (!get_scan(g, p, sheet, error) || !find_outline(g, p, sheet, error))
        return FALSE;
    if (g->scan)
        g->to_scan = to_pixels(g->base, g->tip, g->scan->height);
    if (g->profile || g->fang)
        g->cut_off = along_edge(g->profile ? g->profile->outline : g->fang->outline, g->scan);
    if (!read_back(g, p, error))
        return FALSE;
    if (!veins)
        return TRUE;
    if (*params_text(p, PARAM_VEINS_DRAWING))
        return read_drawing(g, p, error);
    return !g->scan || params_choice(p, PARAM_SCAN_VEINS) != 0 || find_veins(g, p, error);
}

static void clear(gpointer data)
{
    Ground *g = data;
    g_free(g->drawing_lies);
    g_string_free(g->note, TRUE);
    polygon_free(g->outline);
    drawing_free(g->drawing);
    scan_free(g->scan);
    scan_free(g->back);
    profile_free(g->profile);
    fang_profile_free(g->fang);
}

Ground *ground_new(const Params *p, bool veins, GError **error) { return ground_new_on(NULL, p, veins, error); }

Ground *ground_new_on(GroundScan *sheet, const Params *p, bool veins, GError **error)
{
    Ground *g = g_atomic_rc_box_new0(Ground);
    g->note = g_string_new(NULL);
    if (find(g, p, sheet, veins, error)) {
        make_textures(g, p);
        return g;
    }
    ground_unref(g);
    return NULL;
}

Ground *ground_ref(Ground *g) { return g ? g_atomic_rc_box_acquire(g) : NULL; }

void ground_unref(Ground *g)
{
    if (g)
        g_atomic_rc_box_release_full(g, clear);
}
