/* The scan's colours, and where there are none: the openings of the blade. */
#include <string.h>

#include "image/paint.h"
#include "lib/ground_private.h"
#include "scan/fill.h"
#include "scan/openings.h"

/* Of 1.0 + 0.05 over 0.05 + the darker (WCAG 2): veins that are less distinct are not seen as lines on a screen. */
static const double least_contrast = 1.35;

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

/* ---- two colours for a drawing ---- */

/* Samples of one colour, to 8 bits; their medians stand for it, as specks and shadows are few. */
typedef struct {
    uint32_t count[3][256], n;
} Sampled;

static void sample(const Ground *g, Vec2 leaf, Sampled *s)
{
    Vec2 q = affine_apply(&g->to_scan, leaf);
    if (!(q.x >= 0.0 && q.y >= 0.0 && q.x < g->scan->width && q.y < g->scan->height))
        return;
    for (uint32_t c = 0; c < 3; c++)
        s->count[c][scan_sample(g->scan, (uint32_t)q.x, (uint32_t)q.y, g->scan->channels >= 3 ? c : 0) >> (g->scan->depth - 8)]++;
    s->n++;
}

static void median_colour(const Sampled *s, float out[3])
{
    uint32_t code[3];
    for (int c = 0; c < 3; c++) {
        uint32_t sum = 0;
        for (code[c] = 0; 2 * (sum += s->count[c][code[c]]) < s->n;)
            code[c]++;
    }
    paint_colour(code[0] << 16 | code[1] << 8 | code[2], out);
}

static void sample_blade(const Ground *g, Sampled *s)
{
    enum { SIDE = 200 };
    const Box2 *b = &g->outline->box;
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        Vec2 p = vec2(b->x0 + (b->x1 - b->x0) * (i % SIDE + 0.5) / SIDE, b->y0 + (b->y1 - b->y0) * (i / SIDE + 0.5) / SIDE);
        if (polygon_contains(g->outline, p))
            sample(g, p, s);
    }
}

/* Along the middles of the veins of one order. */
static void sample_veins(const Ground *g, uint8_t order, Sampled *s)
{
    const double step = 0.002; /* leaf lengths */
    for (uint32_t i = 0; g->drawing && i < g->drawing->n; i++) {
        const DrawnVein *v = &g->drawing->vein[i];
        for (uint32_t k = 1; v->order == order && k < v->n; k++) {
            uint32_t n = 1 + (uint32_t)MIN(vec_dist(v->point[k - 1], v->point[k]) / step, 1e4);
            for (uint32_t j = 0; j < n; j++)
                sample(g, vec_lerp(v->point[k - 1], v->point[k], (double)j / n), s);
        }
    }
}

static double luminance(const float c[3]) { return 0.2126 * (double)c[0] + 0.7152 * (double)c[1] + 0.0722 * (double)c[2]; }

/* Takes a vein's colour as far away from the blade's as it takes to be seen, lighter or darker as it is. */
static void part_colours(const float lamina[3], float vein[3])
{
    double blade = luminance(lamina) + 0.05, line = luminance(vein) + 0.05;
    bool light = line >= blade;
    if ((light ? line / blade : blade / line) >= least_contrast)
        return;
    double want = light ? blade * least_contrast : blade / least_contrast, by = (want - 0.05) / MAX(line - 0.05, 1e-3);
    for (int c = 0; c < 3; c++)
        vein[c] = (float)CLAMP((double)vein[c] * by, 0.0, 1.0);
}

void ground_colours(const Ground *g, const Params *p, float lamina[3], float vein[3])
{
    if (!g || !g->scan || !params_switch(p, PARAM_SCAN_TEXTURE))
        return;
    Sampled blade = {.n = 0}, line = {.n = 0};
    float model[2][3];
    memcpy(model[0], lamina, sizeof model[0]);
    memcpy(model[1], vein, sizeof model[1]);
    sample_blade(g, &blade);
    sample_veins(g, 1, &line);
    if (!line.n) /* a tracing says no orders */
        sample_veins(g, 0, &line);
    if (blade.n && !params_is_given(p, PARAM_TEXTURE_LAMINA_COLOUR))
        median_colour(&blade, lamina);
    if (params_is_given(p, PARAM_TEXTURE_VEIN_COLOUR))
        return;
    for (int c = 0; c < 3; c++) /* veins that grew: as much lighter as the model's are */
        vein[c] = MIN(1.0f, lamina[c] * model[1][c] / MAX(model[0][c], 1e-3f));
    if (line.n)
        median_colour(&line, vein);
    part_colours(lamina, vein);
}
