#include "lib/settings.h"

#include <string.h>

#include "param/suggest.h"

G_DEFINE_QUARK(settings-error-quark, settings_error)

/* ---- outline ---- */

static gboolean one_point(const Params *p, ParamId id, bool *has, Vec2 *at, GError **error)
{
    uint32_t n;
    const double *v = params_list(p, id, &n);
    *has = n == 1;
    if (n > 1) {
        g_set_error(error, SETTINGS_ERROR, SETTINGS_ERROR_CONFLICT, "%s: [%s] %s holds %u points; it must be one", params_origin(p, id),
                    param_info(id)->section, param_info(id)->key, n);
        return FALSE;
    }
    if (n == 1)
        *at = vec2(v[0], v[1]);
    return TRUE;
}

static gboolean waves(const Params *p, OutlineDef *def, GError **error)
{
    uint32_t n_amplitude, n_count;
    const double *amplitude = params_list(p, PARAM_OUTLINE_TEETH_AMPLITUDE, &n_amplitude);
    const double *count = params_list(p, PARAM_OUTLINE_TEETH_COUNT, &n_count);
    if (n_amplitude != n_count) {
        g_set_error(error, SETTINGS_ERROR, SETTINGS_ERROR_CONFLICT,
                    "%s: [outline] teeth_amplitude has %u numbers and teeth_count has %u; there must be as many, one for each waveform",
                    params_origin(p, PARAM_OUTLINE_TEETH_AMPLITUDE), n_amplitude, n_count);
        return FALSE;
    }
    OutlineWave *wave = g_new(OutlineWave, n_count);
    for (uint32_t i = 0; i < n_count; i++)
        wave[i] = (OutlineWave){amplitude[i], count[i]};
    def->waves = wave;
    def->n_waves = n_count;
    return TRUE;
}

Polygon *settings_outline(const Params *p, GError **error)
{
    OutlineDef def = outline_def_default();
    const char *path = params_text(p, PARAM_OUTLINE_PATH), *file = params_text(p, PARAM_OUTLINE_FILE);
    if (*path && *file) {
        g_set_error(error, SETTINGS_ERROR, SETTINGS_ERROR_CONFLICT, "%s: [outline] path and file are both given; a leaf has one margin",
                    params_origin(p, PARAM_OUTLINE_FILE));
        return NULL;
    }
    char *where = NULL;
    if (*path || *file) {
        ParamId id = *path ? PARAM_OUTLINE_PATH : PARAM_OUTLINE_FILE;
        def.path = *path ? path : NULL;
        def.file = *file ? file : NULL;
        def.mirror = params_switch(p, PARAM_OUTLINE_MIRROR);
        where = g_strdup_printf("%s: [outline] %s", params_origin(p, id), param_info(id)->key);
        def.where = where;
    }
    def.flatness = params_number(p, PARAM_OUTLINE_FLATNESS);
    def.tooth_skew = params_number(p, PARAM_OUTLINE_TEETH_SKEW);
    def.tooth_from = params_number(p, PARAM_OUTLINE_TEETH_FROM);
    def.tooth_to = params_number(p, PARAM_OUTLINE_TEETH_TO);
    Polygon *outline = NULL;
    if (one_point(p, PARAM_OUTLINE_BASE, &def.has_base, &def.base, error) &&
        one_point(p, PARAM_OUTLINE_TIP, &def.has_tip, &def.tip, error) && waves(p, &def, error))
        outline = outline_new(&def, error);
    g_free((gpointer)def.waves);
    g_free(where);
    return outline;
}

/* ---- simulation ---- */

/* The first vein nodes: the points themselves, or a row spaced evenly along the line through them. */
static Vec2 *seed_nodes(const Params *p, uint32_t *n)
{
    uint32_t n_points;
    const Vec2 *point = (const Vec2 *)params_list(p, PARAM_VEINS_SEEDS, &n_points);
    uint32_t row = (uint32_t)params_integer(p, PARAM_VEINS_SEED_ROW);
    if (row <= 1 || n_points < 2) {
        *n = n_points;
        return g_memdup2(point, sizeof(Vec2) * n_points);
    }
    double length = 0.0;
    for (uint32_t i = 1; i < n_points; i++)
        length += vec_dist(point[i - 1], point[i]);
    Vec2 *seed = g_new(Vec2, row);
    double at = 0.0; /* length of the line before point k */
    for (uint32_t i = 0, k = 1; i < row; i++) {
        double want = length * i / (row - 1), piece = vec_dist(point[k - 1], point[k]);
        while (k + 1 < n_points && want > at + piece) {
            at += piece;
            k++;
            piece = vec_dist(point[k - 1], point[k]);
        }
        double t = piece > 0.0 ? (want - at) / piece : 0.0;
        seed[i] = vec_lerp(point[k - 1], point[k], t < 1.0 ? t : 1.0);
    }
    *n = row;
    return seed;
}

static GrowthDef growth(const Params *p)
{
    GrowthDef g = {.kind = (GrowthKind)params_choice(p, PARAM_GROWTH_KIND),
                   .initial_length = params_number(p, PARAM_GROWTH_INITIAL_LENGTH),
                   .final_length = params_number(p, PARAM_GROWTH_FINAL_LENGTH),
                   .step = params_number(p, PARAM_GROWTH_STEP),
                   .steps = (uint32_t)params_integer(p, PARAM_GROWTH_STEPS)};
    g.rate_x = params_list(p, PARAM_GROWTH_RATE_X, &g.n_rate_x);
    g.rate_y = params_list(p, PARAM_GROWTH_RATE_Y, &g.n_rate_y);
    return g;
}

gboolean settings_simulation(const Params *p, const Polygon *leaf, uint64_t seed, unsigned threads, SimulationDef *def, GError **error)
{
    *def = simulation_def_default();
    def->leaf = leaf;
    def->growth = growth(p);
    def->placement = (Placement)params_choice(p, PARAM_SOURCES_PLACEMENT);
    def->density = params_number(p, PARAM_SOURCES_DENSITY);
    def->only_while_growing = params_choice(p, PARAM_SOURCES_DURATION) == 1;
    def->birth_distance_sources = params_number(p, PARAM_SOURCES_BIRTH_DISTANCE_SOURCES);
    def->birth_distance_veins = params_number(p, PARAM_SOURCES_BIRTH_DISTANCE_VEINS);
    def->pattern = (Pattern)params_choice(p, PARAM_VEINS_PATTERN);
    def->neighbourhood = (Neighbourhood)params_choice(p, PARAM_VEINS_NEIGHBOURHOOD);
    def->kill_distance = params_number(p, PARAM_VEINS_KILL_DISTANCE);
    def->sinus_depth = params_number(p, PARAM_VEINS_SINUS_DEPTH);
    def->join_distance = params_number(p, PARAM_VEINS_JOIN_DISTANCE);
    def->max_steps = (uint32_t)params_integer(p, PARAM_VEINS_MAX_STEPS);
    def->seed = seed;
    def->threads = threads;
    def->seeds = seed_nodes(p, &def->n_seeds);
    const char *file = params_text(p, PARAM_SOURCES_FILE);
    gboolean ok = TRUE;
    if (def->placement == PLACEMENT_LIST && !*file) {
        g_set_error(error, SETTINGS_ERROR, SETTINGS_ERROR_CONFLICT, "%s: [sources] placement = list needs sources.file",
                    params_origin(p, PARAM_SOURCES_PLACEMENT));
        ok = FALSE;
    } else if (def->placement == PLACEMENT_LIST) {
        ListedSource *list;
        ok = source_list_read(file, &list, &def->n_list, error);
        def->list = ok ? list : NULL;
    }
    if (!ok)
        settings_simulation_clear(def);
    return ok;
}

void settings_simulation_clear(SimulationDef *def)
{
    g_free((gpointer)def->seeds);
    g_free((gpointer)def->list);
    def->seeds = NULL;
    def->list = NULL;
}

WidthDef settings_widths(const Params *p)
{
    return (WidthDef){.exponent = params_number(p, PARAM_WIDTH_EXPONENT),
                      .minimum = params_number(p, PARAM_WIDTH_MINIMUM),
                      .thickening = params_number(p, PARAM_WIDTH_THICKENING),
                      .rank_ratio = params_number(p, PARAM_WIDTH_RANK_RATIO)};
}

/* ---- texture ---- */

PaintStyle settings_style(const Params *p, uint64_t seed, unsigned threads)
{
    PaintStyle s = paint_style_default();
    paint_colour(params_colour(p, PARAM_TEXTURE_LAMINA_COLOUR), s.lamina);
    paint_colour(params_colour(p, PARAM_TEXTURE_VEIN_COLOUR), s.vein);
    paint_colour(params_colour(p, PARAM_TEXTURE_ABAXIAL_LAMINA_COLOUR), s.abaxial_lamina);
    paint_colour(params_colour(p, PARAM_TEXTURE_ABAXIAL_VEIN_COLOUR), s.abaxial_vein);
    paint_colour(params_colour(p, PARAM_TEXTURE_MARGIN_COLOUR), s.margin);
    s.variation = params_number(p, PARAM_TEXTURE_VARIATION);
    s.relief = params_number(p, PARAM_TEXTURE_RELIEF);
    s.gloss = params_number(p, PARAM_TEXTURE_GLOSS);
    s.thickness = params_number(p, PARAM_TEXTURE_THICKNESS);
    s.padding = (uint32_t)params_integer(p, PARAM_TEXTURE_PADDING);
    s.seed = seed;
    s.threads = threads;
    return s;
}

/* What there is instead of a map that there isn't. */
static char *known_maps(const char *word)
{
    const char *known[MAP_COUNT + 2] = {"all", "none"};
    GString *s = g_string_new("all, none");
    for (int i = 0; i < MAP_COUNT; i++) {
        known[i + 2] = paint_map_info((MapId)i)->name;
        g_string_append_printf(s, ", %s", known[i + 2]);
    }
    const char *near = suggest_nearest(word, known, G_N_ELEMENTS(known));
    if (near) {
        char *first = g_strdup_printf("did you mean '%s'? There are ", near);
        g_string_prepend(s, first);
        g_free(first);
    } else {
        g_string_prepend(s, "there are ");
    }
    return g_string_free(s, FALSE);
}

gboolean settings_maps(const Params *p, gboolean *wanted, GError **error)
{
    memset(wanted, 0, sizeof *wanted * MAP_COUNT);
    char **word = g_strsplit_set(params_text(p, PARAM_TEXTURE_MAPS), " ,;\t", -1);
    gboolean ok = TRUE;
    for (char **w = word; ok && *w; w++) {
        int id = paint_map_find(*w);
        if (!**w || g_str_equal(*w, "none"))
            continue;
        if (g_str_equal(*w, "all")) {
            for (int i = 0; i < MAP_COUNT; i++)
                wanted[i] = TRUE;
        } else if (id >= 0) {
            wanted[id] = TRUE;
        } else {
            char *known = known_maps(*w);
            g_set_error(error, SETTINGS_ERROR, SETTINGS_ERROR_CONFLICT, "%s: [texture] maps: no map is called '%s'; %s",
                        params_origin(p, PARAM_TEXTURE_MAPS), *w, known);
            g_free(known);
            ok = FALSE;
        }
    }
    g_strfreev(word);
    return ok;
}
