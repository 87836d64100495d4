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

/* Carries the leaf's colours on; `known`: the threshold that parts it from what is behind it, else one is looked for. */
static void make_texture(const Ground *g, const Params *p, Scan *scan, const Affine *to_scan, const Threshold *known)
{
    enum { AROUND = 64 };
    Threshold own;
    Polygon *outline = ground_outline_in(g, scan, to_scan);
    ThresholdDef def = settings_profile(p, scan->height).threshold;
    if (!known && openings_threshold(scan, outline, &def, &own))
        known = &own;
    scan_fill(scan, outline, known, scan_fill_inset(outline->area), AROUND);
    polygon_free(outline);
}

void ground_make_textures(Ground *g, const Params *p)
{
    if (!g->scan || !params_switch(p, PARAM_SCAN_TEXTURE))
        return;
    make_texture(g, p, g->scan, &g->to_scan, g->has_threshold ? &g->threshold : NULL);
    if (g->back)
        make_texture(g, p, g->back, &g->to_back, NULL);
}
