/* The scan's colours, and where there are none: the openings of the blade. */
#include "lib/ground_private.h"
#include "scan/fill.h"
#include "scan/openings.h"

/* Whatever the outline comes from: what lay behind the leaf shows in its openings. */
void ground_find_holes(Ground *g, const Params *p)
{
    Polygon *outline = ground_outline_in(g, g->scan, &g->to_scan);
    ThresholdDef def = settings_profile(p, g->scan->height).threshold;
    g->has_threshold = g->has_threshold || openings_threshold(g->scan, outline, &def, &g->threshold);
    if (g->has_threshold && params_choice(p, PARAM_SCAN_HOLES) == 1) {
        Vec2 x = ground_to_leaf(g, vec_add(g->base, vec2(1.0, 0.0))), y = ground_to_leaf(g, vec_add(g->base, vec2(0.0, 1.0)));
        Vec2 at = ground_to_leaf(g, vec2(0.0, 0.0));
        Affine map = {x.x, x.y, y.x, y.y, at.x, at.y};
        double tolerance = MIN(params_number(p, PARAM_SCAN_TOLERANCE), 0.5); /* small as they are, they show corners sooner */
        Holes *pixels = openings_trace(g->scan, outline, &g->threshold, openings_least(outline->area), tolerance);
        g->holes = pixels->n ? holes_mapped(pixels, &map) : NULL;
        holes_free(pixels);
    }
    polygon_free(outline);
}

/* What parts the leaf on its back from what is behind it; NULL where nothing does. */
static const Threshold *find_threshold(const Ground *g, const Params *p, Threshold *own)
{
    if (!g->back || !params_switch(p, PARAM_SCAN_TEXTURE))
        return NULL;
    Polygon *outline = ground_outline_in(g, g->back, &g->to_back);
    ThresholdDef def = settings_profile(p, g->back->height).threshold;
    bool found = openings_threshold(g->back, outline, &def, own);
    polygon_free(outline);
    return found ? own : NULL;
}

/* Carries the leaf's colours on. */
static void make_texture(const Ground *g, Scan *scan, const Affine *to_scan, const Threshold *known)
{
    enum { AROUND = 64 };
    Polygon *outline = ground_outline_in(g, scan, to_scan);
    scan_fill(scan, outline, known, scan_fill_inset(outline->area), AROUND);
    polygon_free(outline);
}

gboolean ground_make_textures(Ground *g, const Params *p, GroundScan *sheet, GError **error)
{
    Threshold own;
    const Threshold *known = find_threshold(g, p, &own); /* in all of the scan */
    if (sheet && !ground_part_scans(g, p, sheet, error))
        return FALSE;
    if (!g->scan || !params_switch(p, PARAM_SCAN_TEXTURE))
        return TRUE;
    make_texture(g, g->scan, &g->to_scan, g->has_threshold ? &g->threshold : NULL);
    if (g->back)
        make_texture(g, g->back, &g->to_back, known);
    return TRUE;
}
