/* Veins that were drawn over the scan, or are looked for in it. */
#include "import/drawing_file.h"
#include "lib/ground_private.h"
#include "scan/found.h"

/* ---- drawn ---- */

static bool is_svg(const char *file) { return g_str_has_suffix(file, ".svg") || g_str_has_suffix(file, ".SVG"); }

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
    bool placed = svg && g->scan && ground_place(g, p, file, &place);
    g->drawing = svg ? drawing_read_svg(file, 1e-3 * vec_dist(g->base, g->tip), placed ? &place.map : NULL, error)
                     : drawing_read_tracing(file, height, error);
    g->drawing_lies = placed ? g_steal_pointer(&place.how) : g->scan ? g_strdup("its numbers, which are pixels of the scan") : NULL;
    svgplace_clear(&place);
    if (!g->drawing)
        return FALSE;
    Vec2 down = vec2(0.0, svg ? height : 0.0); /* an SVG's rows run down from its upper left corner, where its y is 0 */
    drawing_to_leaf(g->drawing, vec_sub(g->base, down), vec_sub(g->tip, down));
    return TRUE;
}

/* ---- found ---- */

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

static gboolean look_for_veins(Ground *g, const Params *p, GError **error)
{
    FoundDef def = settings_found(p);
    Polygon *outline = ground_outline_in(g, g->scan, &g->to_scan);
    if (is_speck(g, outline)) {
        polygon_free(outline);
        return TRUE;
    }
    g->drawing = found_veins(g->scan, outline, g->base, g->tip, &def, error);
    polygon_free(outline);
    if (!g->drawing)
        return ground_blame(p, PARAM_SCAN_FILE, error);
    g->found = true;
    if (g->drawing->n == 0)
        g_string_append_printf(g->note, "%s: no vein stands out from the blade; scan.vein_sensitivity above %g finds fainter ones, veins.drawing takes drawn ones\n",
                               params_text(p, PARAM_SCAN_FILE), def.sensitivity);
    drawing_to_leaf(g->drawing, g->base, g->tip);
    return TRUE;
}

gboolean ground_find_veins(Ground *g, const Params *p, GError **error)
{
    if (*params_text(p, PARAM_VEINS_DRAWING))
        return read_drawing(g, p, error);
    return !g->scan || params_choice(p, PARAM_SCAN_VEINS) != 0 || look_for_veins(g, p, error);
}
