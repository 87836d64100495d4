/* [scan], [lsystem] and drawn veins: from the parameter table to the definitions that src/scan and src/sim work from. */
#include "lib/settings.h"

#include <string.h>

/* A point of the image, rows from the top, to y-up pixels. */
static bool image_point(const Params *p, ParamId id, uint32_t height, Vec2 *at)
{
    uint32_t n;
    const double *v = params_list(p, id, &n);
    if (n > 0)
        *at = vec2(v[0], height - v[1]);
    return n > 0;
}

ProfileDef settings_profile(const Params *p, uint32_t height)
{
    ProfileDef d = profile_def_default();
    d.threshold = (ThresholdDef){(Channel)params_choice(p, PARAM_SCAN_CHANNEL), (LeafSide)params_choice(p, PARAM_SCAN_SIDE),
                                 params_number(p, PARAM_SCAN_THRESHOLD)};
    d.close = params_number(p, PARAM_SCAN_CLOSE);
    d.open = params_number(p, PARAM_SCAN_OPEN);
    d.least_area = params_number(p, PARAM_SCAN_LEAST_AREA);
    d.keep_stalk = params_choice(p, PARAM_SCAN_PETIOLE) == 1;
    d.square = (uint32_t)params_integer(p, PARAM_SCAN_SQUARE);
    d.subpixel = params_switch(p, PARAM_SCAN_SUBPIXEL);
    d.tolerance = params_number(p, PARAM_SCAN_TOLERANCE);
    d.has_base = image_point(p, PARAM_SCAN_BASE, height, &d.base);
    d.has_tip = image_point(p, PARAM_SCAN_TIP, height, &d.tip);
    return d;
}

/* What method fang has no use for: said, so that nobody waits for its effect. Defaults written out change nothing. */
static bool check_unused(const Params *p, GError **error)
{
    static const struct {
        ParamId id;
        const char *instead;
    } unused[] = {{PARAM_SCAN_SQUARE, "its contour follows edges; scan.sigma makes them smoother"},
                  {PARAM_SCAN_SUBPIXEL, "its contour is always drawn in between pixels"},
                  {PARAM_SCAN_TOLERANCE, "its outline is of curves, and scan.corners says how many"}};
    for (gsize i = 0; i < G_N_ELEMENTS(unused); i++) {
        char *value = params_format(p, unused[i].id);
        bool own = !g_str_equal(value, param_info(unused[i].id)->initial);
        if (own)
            g_set_error(error, SETTINGS_ERROR, SETTINGS_ERROR_CONFLICT,
                        "scan.%s is %s, but scan.method is fang, which does not use it: %s; leave it out, or set scan.method to contour",
                        param_info(unused[i].id)->key, value, unused[i].instead);
        g_free(value);
        if (own)
            return false;
    }
    return true;
}

bool settings_fang(const Params *p, uint32_t height, FangDef *out, GError **error)
{
    if (!check_unused(p, error))
        return false;
    FangDef d = fang_def_default();
    d.threshold = (ThresholdDef){(Channel)params_choice(p, PARAM_SCAN_CHANNEL), (LeafSide)params_choice(p, PARAM_SCAN_SIDE),
                                 params_number(p, PARAM_SCAN_THRESHOLD)};
    d.close = params_number(p, PARAM_SCAN_CLOSE);
    d.open = params_number(p, PARAM_SCAN_OPEN);
    d.least_area = params_number(p, PARAM_SCAN_LEAST_AREA);
    d.leaf = (uint32_t)params_integer(p, PARAM_SCAN_LEAF);
    d.edges.op = (EdgesOperator)params_choice(p, PARAM_SCAN_OPERATOR);
    d.edges.sigma = params_number(p, PARAM_SCAN_SIGMA);
    d.corners.threshold = params_number(p, PARAM_SCAN_CORNERS);
    if (params_choice(p, PARAM_SCAN_CURVES) == 0) {
        d.fit.rule = BEZIERFIT_CONTOUR;
        d.fit.tolerance = 1.5; /* pixels: what a traced border is sure of */
    }
    d.keep_stalk = params_choice(p, PARAM_SCAN_PETIOLE) == 1;
    d.has_base = image_point(p, PARAM_SCAN_BASE, height, &d.base);
    d.has_tip = image_point(p, PARAM_SCAN_TIP, height, &d.tip);
    *out = d;
    return true;
}

FoundDef settings_found(const Params *p)
{
    FoundDef d = found_def_default();
    d.orders = (unsigned)params_integer(p, PARAM_SCAN_VEIN_ORDERS);
    d.sensitivity = params_number(p, PARAM_SCAN_VEIN_SENSITIVITY);
    return d;
}

/* ---- L-systems ---- */

static char **productions(const char *text, uint32_t *n)
{
    char **all = g_strsplit_set(text, ";\n", -1);
    uint32_t kept = 0;
    for (char **one = all; *one; one++) {
        if (*g_strstrip(*one))
            all[kept++] = *one;
        else
            g_free(*one);
    }
    all[kept] = NULL;
    *n = kept;
    return all;
}

bool settings_lsystem_is_own(const Params *p)
{
    return params_is_given(p, PARAM_LSYSTEM_AXIOM) || params_is_given(p, PARAM_LSYSTEM_PRODUCTIONS) ||
           params_integer(p, PARAM_LSYSTEM_MARGIN_VEINS) == 0;
}

LSystemDef settings_lsystem(const Params *p, bool palmate, uint64_t seed)
{
    uint32_t margin_veins = (uint32_t)params_integer(p, PARAM_LSYSTEM_MARGIN_VEINS);
    LSystemDef d = palmate ? lsystem_def_palmate(margin_veins) : lsystem_def_pinnate(margin_veins);
    bool own = params_is_given(p, PARAM_LSYSTEM_AXIOM) || margin_veins == 0;
    if (own) {
        d.axiom = params_text(p, PARAM_LSYSTEM_AXIOM);
        d.draws = params_text(p, PARAM_LSYSTEM_DRAWS);
    }
    if (own || params_is_given(p, PARAM_LSYSTEM_PRODUCTIONS))
        d.production = (const char *const *)productions(params_text(p, PARAM_LSYSTEM_PRODUCTIONS), &d.n_productions);
    if (own || params_is_given(p, PARAM_LSYSTEM_ITERATIONS))
        d.iterations = (uint32_t)params_integer(p, PARAM_LSYSTEM_ITERATIONS);
    if (own || params_is_given(p, PARAM_LSYSTEM_ANGLE))
        d.angle = params_number(p, PARAM_LSYSTEM_ANGLE);
    if (own || params_is_given(p, PARAM_LSYSTEM_STEP))
        d.step = params_number(p, PARAM_LSYSTEM_STEP);
    if (own || params_is_given(p, PARAM_LSYSTEM_LENGTH_SCALE))
        d.length_scale = params_number(p, PARAM_LSYSTEM_LENGTH_SCALE);
    if (own || params_is_given(p, PARAM_LSYSTEM_BEND))
        d.bend = params_number(p, PARAM_LSYSTEM_BEND);
    d.murray = true;
    d.widths = settings_widths(p);
    d.seed = seed;
    return d;
}

void settings_lsystem_clear(const Params *p, LSystemDef *d)
{
    if (settings_lsystem_is_own(p))
        g_strfreev((char **)d->production);
    d->production = NULL;
}
