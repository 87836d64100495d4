/* The outline: captured from the scan by threshold or by edges, drawn over it, or given. */
#include "geom/ring.h"
#include "geom/simplify.h"
#include "lib/ground_private.h"

static Polygon *leaf_outline(const Ground *g, const Polygon *outline)
{
    Vec2 *v = g_new(Vec2, outline->n);
    for (uint32_t i = 0; i < outline->n; i++)
        v[i] = ground_to_leaf(g, outline->v[i]);
    Polygon *p = polygon_new(v, outline->n);
    g_free(v);
    return p;
}

/* ---- captured ---- */

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

static gboolean capture_profile(Ground *g, const Params *p, GError **error)
{
    ProfileDef def = settings_profile(p, g->scan->height);
    uint32_t which = (uint32_t)params_integer(p, PARAM_SCAN_LEAF);
    def.each = which > 1;
    GPtrArray *all = profile_capture(g->scan, &def, &g->threshold, error);
    if (!all)
        return ground_blame(p, PARAM_SCAN_FILE, error);
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
        return ground_blame(p, PARAM_SCAN_FILE, error);
    g->base = g->fang->contour->v[g->fang->base];
    g->tip = g->fang->contour->v[g->fang->tip];
    g->outline = leaf_outline(g, g->fang->outline);
    return TRUE;
}

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

/* What was taken for the leaf otherwise than by separability and frame, and what to set where that is wrong. */
static void note_sides(Ground *g, const Params *p, const Threshold *t)
{
    const char *file = params_text(p, PARAM_SCAN_FILE), *other = t->dark ? "light" : "dark";
    if (t->sheet.n > 0) {
        Box2 b = box_empty();
        for (uint32_t i = 0; i < t->sheet.n; i++)
            b = box_add(b, t->sheet.corner[i]);
        g_string_append_printf(g->note, "%s: the leaf was looked for on a sheet of paper that spans x %.0f … %.0f, y %.0f … %.0f (pixels from the upper left corner); "
                               "with scan.side = dark or light all of the image counts\n", file, MAX(b.x0, 0.0), MIN(b.x1, g->scan->width), MAX(b.y0, 0.0),
                               MIN(b.y1, g->scan->height));
    }
    if (t->turned)
        g_string_append_printf(g->note, "%s: what most of the image's frame shows is taken for leaf, as by its colours the rest is its background; if it isn't, set "
                               "scan.side = %s\n", file, other);
    if (t->pale)
        g_string_append_printf(g->note, "%s: what is taken for leaf is pale and grey, and what is around it is greener; if that is a leaf that fills the image, set "
                               "scan.side = %s\n", file, other);
}

/* Length of the outline against what is left of it without all that is finer than a fiftieth of the leaf. */
static double raggedness(const Polygon *p)
{
    uint32_t *keep = g_new(uint32_t, p->n), n = simplify_polyline(p->v, p->n, 0.02 * vec_dist(vec2(p->box.x0, p->box.y0), vec2(p->box.x1, p->box.y1)), NULL, keep);
    double coarse = 0.0;
    for (uint32_t i = 0; i < n; i++)
        coarse += vec_dist(p->v[keep[i]], p->v[keep[(i + 1) % n]]);
    g_free(keep);
    return ring_length(p) / coarse;
}

/* Where leaf and ground are noisy and nearly of a shade the threshold leaves fringes all around. Of leaves it is 1.3 times as long at most, teeth included. */
static void note_ragged(Ground *g, const Params *p)
{
    const double most = 1.8, clear = 0.85; /* a fern is no fringe: it parts clearly */
    double times = g->threshold.separability < clear ? raggedness(g->profile->outline) : 1.0;
    if (times > most)
        g_string_append_printf(g->note, "%s: the outline is ragged, %.1f times as long as without what is finer than a fiftieth of the leaf: leaf and ground differ little (%.2f "
                               "of 1) in the channel %s. scan.open = 2 takes the fringes away; scan.channel, scan.threshold or scan.method = fang may part the leaf better\n",
                               params_text(p, PARAM_SCAN_FILE), times, g->threshold.separability, channel_name(g->threshold.channel));
}

/* ---- drawn ---- */

static Polygon *drawn_outline(Ground *g, const Params *p, GError **error)
{
    const char *file = params_text(p, PARAM_OUTLINE_FILE);
    SvgPlace place = {0};
    bool placed = g->scan && *file && ground_place(g, p, file, &place);
    Polygon *outline = settings_outline(p, placed ? &place : NULL, &g->base, &g->tip, error);
    g->outline_lies = *file ? ground_lies(g, placed ? &place : NULL) : NULL;
    svgplace_clear(&place);
    return outline;
}

gboolean ground_find_outline(Ground *g, const Params *p, GroundScan *sheet, GError **error)
{
    bool given = *params_text(p, PARAM_OUTLINE_PATH) || *params_text(p, PARAM_OUTLINE_FILE);
    if (g->scan && !given) {
        if (!(params_choice(p, PARAM_SCAN_METHOD) == 0 ? find_profile(g, p, sheet, error) : find_fang(g, p, error)))
            return FALSE;
        note_sides(g, p, g->profile ? &g->threshold : &g->fang->threshold);
        if (g->profile)
            note_ragged(g, p);
        g->cut_off = along_edge(g->profile ? g->profile->outline : g->fang->outline, g->scan);
        return TRUE;
    }
    g->outline = drawn_outline(g, p, error);
    if (g->outline && g->scan) { /* drawn over the scan, whose rows run down from its top */
        g->base.y += g->scan->height;
        g->tip.y += g->scan->height;
    }
    return g->outline != NULL;
}
