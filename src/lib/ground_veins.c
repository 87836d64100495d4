/* Veins that were drawn over the scan, are looked for in it, or written by an L-system. */
#include <string.h>

#include "import/drawing_file.h"
#include "lib/ground_private.h"
#include "scan/found.h"
#include "sim/bare.h"
#include "sim/lobes.h"
#include "sim/lturtle_axis.h"

/* ---- drawn ---- */

static bool is_svg(const char *file) { return g_str_has_suffix(file, ".svg") || g_str_has_suffix(file, ".SVG"); }

static gboolean read_drawing(Ground *g, const Params *p, GError **error)
{
    const char *file = params_text(p, PARAM_VEINS_DRAWING);
    double height = g->scan ? g->scan->height : 0.0;
    bool svg = is_svg(file);
    SvgPlace place = {0};
    if (!svg && !g->scan) {
        char *given = params_place(p, PARAM_VEINS_DRAWING);
        g_set_error(error, SETTINGS_ERROR, SETTINGS_ERROR_CONFLICT,
                    "%s: a text file of lines is in pixels of a scan, so scan.file is needed, too", given);
        g_free(given);
        return FALSE;
    }
    bool placed = svg && g->scan && ground_place(g, p, file, &place);
    g->drawing = svg ? drawing_read_svg(file, 1e-3 * vec_dist(g->base, g->tip), placed ? &place.map : NULL, error)
                     : drawing_read_tracing(file, height, error);
    g->drawing_lies = ground_lies(g, placed ? &place : NULL);
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

/* ---- by an L-system ---- */

enum { PRESET_AUTO, PRESET_PINNATE, PRESET_PALMATE };

/* Discs of the blade without a vein, parts of its width. A person is told of one that is larger than the first, unless it is only so large because
 * the blade is narrow: smaller than the second, of its length. Above the third the other preset is tried, and taken if it makes the disc so much
 * smaller. */
static const double most_bare = 0.25, least_bare = 0.125, much_bare = 0.2, better_by = 0.75;

/* The midrib that the scan shows, so that the blade folds where the photo does; false where none is found or to be looked for. It is the first of the
 * veins found that goes from near the base to near the tip. */
static bool find_midrib(const Ground *g, const Params *p, LAxis *axis)
{
    if (!g->scan || params_choice(p, PARAM_SCAN_VEINS) != 0)
        return false;
    FoundDef def = settings_found(p);
    def.orders = 1;
    Polygon *outline = ground_outline_in(g, g->scan, &g->to_scan);
    const Box2 *b = &outline->box;
    bool speck = MAX(b->x1 - b->x0, b->y1 - b->y0) < FOUND_SHORTEST, found = false;
    Drawing *veins = speck ? NULL : found_veins(g->scan, outline, g->base, g->tip, &def, NULL);
    polygon_free(outline);
    if (veins)
        drawing_to_leaf(veins, g->base, g->tip);
    for (uint32_t i = 0; veins && i < veins->n && !found; i++)
        found = veins->vein[i].order == 1 && laxis_of_midrib(veins->vein[i].point, veins->vein[i].n, axis);
    drawing_free(veins);
    return found;
}

/* `axis`: the midrib; NULL: by the outline. */
static Network *draw_lsystem(const Ground *g, const Params *p, const LAxis *axis, bool palmate, double length, uint64_t seed, GError **error)
{
    LSystemDef def = settings_lsystem(p, palmate, seed);
    def.axis = axis;
    Network *net = lsystem_network(&def, g->outline, length, NULL, error);
    if (!net)
        g_prefix_error(error, "[lsystem]: ");
    settings_lsystem_clear(p, &def);
    return net;
}

static bool has_lobes(const Polygon *outline)
{
    Lobes lobes;
    lobes_find(outline, &lobes);
    return lobes.found > 0;
}

/* Whether the other preset leaves much less of the blade bare; then the network is its own. */
static bool draw_other(const Ground *g, const Params *p, const LAxis *axis, bool palmate, uint64_t seed, Network **net, double *bare, Vec2 *centre)
{
    Vec2 at;
    Network *other = draw_lsystem(g, p, axis, palmate, (*net)->length, seed, NULL);
    double share = other ? bare_disc(other, &at) : HUGE_VAL;
    bool better = share < better_by * *bare;
    if (better) {
        Network *old = *net;
        *net = other;
        other = old;
        *bare = share;
        *centre = at;
    }
    network_free(other);
    return better;
}

static const char *const preset_name[] = {"pinnate", "palmate"};

static void note_bare(Ground *g, const Params *p, double bare, Vec2 at, bool palmate)
{
    bool chosen = params_choice(p, PARAM_LSYSTEM_PRESET) == PRESET_AUTO;
    char *note = g_strdup_printf("the L-system's veins (lsystem.preset %s%s) leave a disc of %.0f %% of the blade's width bare, around %.2f, %.2f in leaf "
                                 "lengths from the base; %s%s, lsystem.axiom and lsystem.productions, or veins.origin = grown fill it\n",
                                 preset_name[palmate], chosen ? ", by itself" : "", 100.0 * bare, at.x, at.y,
                                 chosen ? "more lsystem.margin_veins" : "lsystem.preset = ", chosen ? "" : preset_name[!palmate]);
    if (!strstr(g->note->str, note)) /* the frames of a run share their ground */
        g_string_append(g->note, note);
    g_free(note);
}

Network *ground_lsystem(Ground *g, const Params *p, double length, uint64_t seed, GError **error)
{
    int preset = params_choice(p, PARAM_LSYSTEM_PRESET);
    bool own = settings_lsystem_is_own(p), palmate = preset == PRESET_PALMATE || (preset == PRESET_AUTO && !own && has_lobes(g->outline));
    LAxis midrib;
    const LAxis *axis = find_midrib(g, p, &midrib) ? &midrib : NULL;
    Network *net = draw_lsystem(g, p, axis, palmate, length, seed, error);
    Vec2 centre;
    if (!net || own)
        return net;
    net->length = length;
    double bare = bare_disc(net, &centre);
    if (bare > much_bare && preset == PRESET_AUTO && draw_other(g, p, axis, !palmate, seed, &net, &bare, &centre))
        palmate = !palmate;
    g->lsystem = preset_name[palmate];
    if (bare > most_bare && bare * (net->margin->box.x1 - net->margin->box.x0) > least_bare * length)
        note_bare(g, p, bare, vec_scale(centre, 1.0 / length), palmate);
    return net;
}
