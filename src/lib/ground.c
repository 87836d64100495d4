#include "lib/ground.h"

#include "import/drawing_file.h"
#include "lib/ground_back.h"
#include "lib/settings.h"
#include "scan/fill.h"
#include "scan/found.h"
#include "scan/openings.h"

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

/* The back is laid on by an affine map, which makes up for that. */
static void check_pixels(Ground *g, const Params *p)
{
    double aspect = g->scan->aspect;
    if (aspect > 0.0 && aspect != 1.0)
        g_string_append_printf(g->note, "%s: by its resolution its pixels are not square (width to height %.3f); they are taken as square, so the leaf is %.1f %% too %s. "
                               "Areas in mm² are right, lengths lie between; scale the image to square pixels to mend that\n",
                               params_text(p, PARAM_SCAN_FILE), aspect, 100.0 * (MAX(aspect, 1.0 / aspect) - 1.0), aspect > 1.0 ? "narrow" : "wide");
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
    g->has_threshold = true;
    g->base = g->profile->base;
    g->tip = g->profile->tip;
    g->outline = leaf_outline(g, g->profile->outline);
    return TRUE;
}

static gboolean find_fang(Ground *g, const Params *p, GError **error)
{
    FangDef def;
    if (!settings_fang(p, g->scan->height, &def, error))
        return FALSE;
    g->fang = fang_capture(g->scan, &def, error);
    if (!g->fang)
        return blame(p, PARAM_SCAN_FILE, error);
    g->base = g->fang->contour->v[g->fang->base];
    g->tip = g->fang->contour->v[g->fang->tip];
    g->outline = leaf_outline(g, g->fang->outline);
    return TRUE;
}

/* ---- the other side ---- */

static gboolean lay_back(Ground *g, const Params *p, const GPtrArray *all, GError **error)
{
    const char *front = params_text(p, PARAM_SCAN_FILE), *back = params_text(p, PARAM_SCAN_BACK);
    BackLaid laid = ground_lay_back(g->outline, all);
    g->back_off = laid.off;
    if (!(laid.off <= BACK_WRONG)) {
        g_set_error(error, SCAN_ERROR, SCAN_ERROR_VALUE,
                    "%s is no back of %s: laid onto each other as well as they go, their outlines lie %.1f %% of the leaf's length apart on average; "
                    "%g %% are allowed", back, front, 100.0 * laid.off, 100.0 * BACK_WRONG);
        return FALSE;
    }
    Affine pixels = to_pixels(laid.base, laid.tip, g->back->height);
    g->to_back = affine_multiply(&pixels, &laid.map);
    if (laid.off > BACK_ODD && laid.same_side)
        g_string_append_printf(g->note, "%s: its leaf lies the same way round as that of %s; does it show the same side?\n", back, front);
    else if (laid.off > BACK_ODD)
        g_string_append_printf(g->note, "%s: its outline lies %.1f %% of the leaf's length off that of %s on average; is it the same leaf, turned over?\n", back,
                               100.0 * laid.off, front);
    return TRUE;
}

static gboolean read_back(Ground *g, const Params *p, GError **error)
{
    if (!read_scan(p, PARAM_SCAN_BACK, &g->back, error) || !g->back)
        return g->back || !*params_text(p, PARAM_SCAN_BACK);
    ProfileDef def = settings_profile(p, g->back->height);
    def.has_base = def.has_tip = false;
    def.each = true;
    GPtrArray *all = profile_capture(g->back, &def, NULL, error);
    if (!all)
        return blame(p, PARAM_SCAN_BACK, error);
    gboolean ok = lay_back(g, p, all, error);
    g_ptr_array_unref(all);
    return ok;
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

/* Whatever the outline comes from: what lay behind the leaf shows in its openings. */
static void find_holes(Ground *g, const Params *p)
{
    Polygon *outline = outline_in(g, g->scan, &g->to_scan);
    ThresholdDef def = settings_profile(p, g->scan->height).threshold;
    g->has_threshold = g->has_threshold || openings_threshold(g->scan, outline, &def, &g->threshold);
    if (g->has_threshold && params_choice(p, PARAM_SCAN_HOLES) == 1) {
        Vec2 x = to_leaf(g, vec_add(g->base, vec2(1.0, 0.0))), y = to_leaf(g, vec_add(g->base, vec2(0.0, 1.0))), at = to_leaf(g, vec2(0.0, 0.0));
        Affine map = {x.x, x.y, y.x, y.y, at.x, at.y};
        double tolerance = MIN(params_number(p, PARAM_SCAN_TOLERANCE), 0.5); /* small as they are, they show corners sooner */
        Holes *pixels = openings_trace(g->scan, outline, &g->threshold, openings_least(outline->area), tolerance);
        g->holes = holes_mapped(pixels, &map);
        holes_free(pixels);
    }
    polygon_free(outline);
}

/* Carries the leaf's colours on; `known`: the threshold that parts it from what is behind it, else one is looked for. */
static void make_texture(const Ground *g, const Params *p, Scan *scan, const Affine *to_scan, const Threshold *known)
{
    enum { AROUND = 64 };
    Threshold own;
    Polygon *outline = outline_in(g, scan, to_scan);
    ThresholdDef def = settings_profile(p, scan->height).threshold;
    if (!known && openings_threshold(scan, outline, &def, &own))
        known = &own;
    scan_fill(scan, outline, known, scan_fill_inset(outline->area), AROUND);
    polygon_free(outline);
}

/* The scans are looked at no more: from here on they are textures. */
static void make_textures(Ground *g, const Params *p)
{
    if (!g->scan || !params_switch(p, PARAM_SCAN_TEXTURE))
        return;
    make_texture(g, p, g->scan, &g->to_scan, g->has_threshold ? &g->threshold : NULL);
    if (g->back)
        make_texture(g, p, g->back, &g->to_back, NULL);
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
    if (g->scan) {
        g->to_scan = to_pixels(g->base, g->tip, g->scan->height);
        check_pixels(g, p);
    }
    if (g->profile || g->fang)
        g->cut_off = along_edge(g->profile ? g->profile->outline : g->fang->outline, g->scan);
    if (!read_back(g, p, error))
        return FALSE;
    if (g->scan)
        find_holes(g, p);
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
    holes_free(g->holes);
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
