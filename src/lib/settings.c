#include "lib/settings.h"

#include <string.h>

#include "param/suggest.h"

G_DEFINE_QUARK(settings-error-quark, settings_error)

/* Sets an error that begins with the place where a parameter was given; always FALSE. */
static G_GNUC_PRINTF(4, 5) gboolean conflict(GError **error, const Params *p, ParamId id, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    char *place = params_place(p, id), *what = g_strdup_vprintf(format, args);
    va_end(args);
    g_set_error(error, SETTINGS_ERROR, SETTINGS_ERROR_CONFLICT, "%s%s", place, what);
    g_free(what);
    g_free(place);
    return FALSE;
}

/* ---- outline ---- */

static gboolean one_point(const Params *p, ParamId id, bool *has, Vec2 *at, GError **error)
{
    uint32_t n;
    const double *v = params_list(p, id, &n);
    *has = n == 1;
    if (n > 1)
        return conflict(error, p, id, " holds %u points; it must be one", n);
    if (n == 1)
        *at = vec2(v[0], v[1]);
    return TRUE;
}

static gboolean waves(const Params *p, OutlineDef *def, GError **error)
{
    uint32_t n_amplitude, n_count;
    const double *amplitude = params_list(p, PARAM_OUTLINE_TEETH_AMPLITUDE, &n_amplitude);
    const double *count = params_list(p, PARAM_OUTLINE_TEETH_COUNT, &n_count);
    if (n_amplitude != n_count)
        return conflict(error, p, PARAM_OUTLINE_TEETH_AMPLITUDE,
                        " has %u number%s and teeth_count has %u; there must be as many, one for each waveform", n_amplitude,
                        n_amplitude == 1 ? "" : "s", n_count);
    OutlineWave *wave = g_new(OutlineWave, n_count);
    for (uint32_t i = 0; i < n_count; i++)
        wave[i] = (OutlineWave){amplitude[i], count[i]};
    def->waves = wave;
    def->n_waves = n_count;
    return TRUE;
}

Polygon *settings_outline(const Params *p, const SvgPlace *place, Vec2 *base, Vec2 *tip, GError **error)
{
    OutlineDef def = outline_def_default();
    def.place = place;
    const char *path = params_text(p, PARAM_OUTLINE_PATH), *file = params_text(p, PARAM_OUTLINE_FILE);
    if (*path && *file) {
        conflict(error, p, PARAM_OUTLINE_FILE, " and path are both given; a leaf has one margin");
        return NULL;
    }
    char *where = NULL;
    if (*path || *file) {
        ParamId id = *path ? PARAM_OUTLINE_PATH : PARAM_OUTLINE_FILE;
        def.path = *path ? path : NULL;
        def.file = *file ? file : NULL;
        def.mirror = params_switch(p, PARAM_OUTLINE_MIRROR);
        def.where = where = params_place(p, id);
    }
    def.flatness = params_number(p, PARAM_OUTLINE_FLATNESS);
    def.tooth_skew = params_number(p, PARAM_OUTLINE_TEETH_SKEW);
    def.tooth_from = params_number(p, PARAM_OUTLINE_TEETH_FROM);
    def.tooth_to = params_number(p, PARAM_OUTLINE_TEETH_TO);
    Polygon *outline = NULL;
    if (one_point(p, PARAM_OUTLINE_BASE, &def.has_base, &def.base, error) &&
        one_point(p, PARAM_OUTLINE_TIP, &def.has_tip, &def.tip, error) && waves(p, &def, error))
        outline = outline_new_from(&def, base, tip, error);
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

static int compare_points(gconstpointer a, gconstpointer b, gpointer user)
{
    const Vec2 *p = a, *q = b;
    return p->x != q->x ? (p->x > q->x) - (p->x < q->x) : (p->y > q->y) - (p->y < q->y);
}

/* A node for itself that nothing leads to is what two first nodes at one place would give. */
static gboolean check_seeds(const Params *p, const SimulationDef *def, GError **error)
{
    uint32_t n_points, again = 1;
    params_list(p, PARAM_VEINS_SEEDS, &n_points);
    int64_t row = params_integer(p, PARAM_VEINS_SEED_ROW);
    if (row > 1 && n_points < 2)
        return conflict(error, p, PARAM_VEINS_SEED_ROW,
                        " = %" G_GINT64_FORMAT " needs a line through two points or more; veins.seeds has %u (0 switches the row off)", row,
                        n_points);
    if (def->n_seeds < 2)
        return TRUE;
    Vec2 *seed = g_memdup2(def->seeds, sizeof(Vec2) * def->n_seeds);
    g_qsort_with_data(seed, (gint)def->n_seeds, sizeof(Vec2), compare_points, NULL);
    while (again < def->n_seeds && compare_points(&seed[again], &seed[again - 1], NULL) != 0)
        again++;
    gboolean good = again == def->n_seeds;
    if (!good) {
        char x[G_ASCII_DTOSTR_BUF_SIZE], y[G_ASCII_DTOSTR_BUF_SIZE];
        conflict(error, p, PARAM_VEINS_SEEDS, ": two of the first nodes are at %s,%s; each must have a place of its own",
                 g_ascii_formatd(x, sizeof x, "%.6g", seed[again].x), g_ascii_formatd(y, sizeof y, "%.6g", seed[again].y));
    }
    g_free(seed);
    return good;
}

static gboolean read_sources(const Params *p, SimulationDef *def, GError **error)
{
    const char *file = params_text(p, PARAM_SOURCES_FILE);
    if (def->placement != PLACEMENT_LIST && *file)
        return conflict(error, p, PARAM_SOURCES_FILE, " is given, but placement is %s; it must be list, or be left out",
                        def->placement == PLACEMENT_DARTS ? "darts" : "margin");
    if (def->placement != PLACEMENT_LIST)
        return TRUE;
    if (!*file)
        return conflict(error, p, PARAM_SOURCES_PLACEMENT, " = list needs sources.file");
    ListedSource *list;
    if (!source_list_read(file, &list, &def->n_list, error))
        return FALSE;
    def->list = list;
    return TRUE;
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
    gboolean ok = check_seeds(p, def, error) && read_sources(p, def, error);
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
            ok = conflict(error, p, PARAM_TEXTURE_MAPS, ": no map is called '%s'; %s", *w, known);
            g_free(known);
        }
    }
    g_strfreev(word);
    return ok;
}
