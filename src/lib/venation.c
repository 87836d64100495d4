/* The public interface: parameters in, a grown leaf out. */
#include "venation.h"

#include <gio/gio.h>

#include "import/import.h"
#include "lib/leaf.h"
#include "lib/settings.h"
#include "sim/torn.h"

const char *ven_version(void) { return VENATION_VERSION; }

/* ---- parameters ---- */

static VenParams *wrap(Params *values)
{
    if (!values)
        return NULL;
    VenParams *p = g_new(VenParams, 1);
    p->values = values;
    return p;
}

VenParams *ven_params_new(void) { return wrap(params_new()); }

VenParams *ven_params_load(const char *path, GError **error) { return wrap(params_load(path, error)); }

gboolean ven_params_set(VenParams *params, const char *key, const char *value, GError **error)
{
    char *assignment = g_strdup_printf("%s=%s", key, value);
    gboolean ok = params_override(params->values, assignment, error);
    g_free(assignment);
    return ok;
}

char *ven_params_get(const VenParams *params, const char *key)
{
    int id = param_find(key);
    return id < 0 ? NULL : params_format(params->values, (ParamId)id);
}

char *ven_params_text(const VenParams *params) { return params_to_file(params->values); }

void ven_params_free(VenParams *params)
{
    if (!params)
        return;
    params_free(params->values);
    g_free(params);
}

/* ---- growing ---- */

/* Holes that the scan shows, and stay, are in the finished leaf alone: they were eaten into it. */
static void open_holes(VenLeaf *leaf)
{
    Affine to_segments = {.a = leaf->length, .d = leaf->length};
    if (!leaf->ground || !leaf->ground->holes)
        return;
    leaf->net = network_tear(leaf->net, holes_mapped(leaf->ground->holes, &to_segments));
    leaf->counts.nodes = leaf->net->n_nodes;
}

static VenLeaf *leaf_new(const Params *params, Ground *ground, const SimulationDef *def, const Simulation *sim)
{
    const Blade *blade = simulation_blade(sim);
    WidthDef widths = settings_widths(params);
    VenLeaf *leaf = g_new0(VenLeaf, 1);
    leaf->params = params_copy(params);
    leaf->ground = ground_ref(ground);
    leaf->seed = def->seed;
    leaf->threads = def->threads;
    leaf->net = simulation_network(sim);
    double shortest = params_number(params, PARAM_VEINS_SHORTEST);
    bool pruned = shortest > 0.0 && simulation_counts(sim).end != END_RUNNING && !def->given; /* drawn veins may be as short as they are */
    if (pruned)
        leaf->net = network_prune(leaf->net, shortest);
    network_assign_widths(leaf->net, &widths);
    if (def->given)
        network_keep_drawn(leaf->net, &widths, def->given, simulation_given(sim));
    leaf->counts = simulation_counts(sim);
    leaf->counts.nodes = leaf->net->n_nodes;
    leaf->length = leaf->net->length = blade->length;
    leaf->growth_steps = blade->last_step;
    leaf->stage = blade->widest;
    if (leaf->counts.end != END_RUNNING)
        open_holes(leaf);
    return leaf;
}

void ven_leaf_free(VenLeaf *leaf)
{
    if (!leaf)
        return;
    ground_unref(leaf->ground);
    network_free(leaf->net);
    params_free(leaf->params);
    g_free(leaf);
}

/* One growing of the leaf, of which a run has two when snapshots are asked for: the first one learns the scale. */
typedef struct {
    const Params *params;
    Ground *ground;
    const SimulationDef *def;
    const VenOptions *options;  /* may be NULL */
    double from, to;            /* the part of the run that it is, for the progress */
    uint32_t snapshot_every;    /* 0: never */
    const Network *reference;   /* for the snapshots */
} Pass;

/* Tells the caller where the run is; FALSE when it wants the run to stop. */
static gboolean report(const Pass *pass, const Simulation *sim)
{
    if (!pass->options || !pass->options->progress)
        return TRUE;
    SimulationCounts c = simulation_counts(sim);
    VenProgress p = {.step = c.step, .nodes = c.nodes, .sources = c.sources, .length = simulation_blade(sim)->length,
                     .done = pass->from + (pass->to - pass->from) * simulation_done(sim),
                     .rehearsal = pass->options->snapshot_every && !pass->snapshot_every};
    VenLeaf *snapshot = NULL;
    if (pass->snapshot_every && (c.step % pass->snapshot_every == 0 || c.end != END_RUNNING)) {
        p.leaf = snapshot = leaf_new(pass->params, pass->ground, pass->def, sim);
        snapshot->reference = pass->reference;
    }
    gboolean go_on = pass->options->progress(&p, pass->options->user);
    ven_leaf_free(snapshot);
    return go_on;
}

static VenLeaf *run(const Pass *pass, GError **error)
{
    Simulation *sim = simulation_new(pass->def, error);
    if (!sim)
        return NULL;
    gboolean more = TRUE, stopped = pass->snapshot_every && !report(pass, sim); /* a snapshot of the first nodes */
    while (more && !stopped) {
        more = simulation_step(sim);
        stopped = !report(pass, sim);
    }
    VenLeaf *leaf = NULL;
    SimulationCounts c = simulation_counts(sim);
    if (stopped)
        g_set_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED, "stopped at step %u", c.step);
    else if (c.end == END_CROWDED)
        g_set_error(error, SIMULATION_ERROR, SIMULATION_ERROR_SIZE,
                    "at step %u there are %u sources and %u vein nodes, more than can be kept; sources.density = %g must be lower, "
                    "sources.birth_distance_sources = %g or sources.birth_distance_veins = %g higher, or the leaf smaller", c.step, c.sources, c.nodes,
                    pass->def->density, pass->def->birth_distance_sources, pass->def->birth_distance_veins);
    else
        leaf = leaf_new(pass->params, pass->ground, pass->def, sim);
    simulation_free(sim);
    return leaf;
}

static VenLeaf *run_all(const Params *params, Ground *ground, const SimulationDef *def, const VenOptions *options, GError **error)
{
    Pass pass = {.params = params, .ground = ground, .def = def, .options = options, .to = 1.0};
    if (!options || !options->snapshot_every || !options->progress)
        return run(&pass, error);
    pass.to = 0.3;
    VenLeaf *first = run(&pass, error), *leaf = NULL;
    if (first) {
        pass = (Pass){params, ground, def, options, 0.3, 1.0, options->snapshot_every, first->net};
        leaf = run(&pass, error);
    }
    ven_leaf_free(first);
    return leaf;
}

/* ---- veins that do not grow ---- */

/* Of a network in segments that is the caller's no more, on a leaf of that length. */
static VenLeaf *leaf_of(const Params *p, Ground *ground, uint64_t seed, unsigned threads, Network *net, double length, EndReason end)
{
    VenLeaf *leaf = g_new0(VenLeaf, 1);
    leaf->params = params_copy(p);
    leaf->ground = ground_ref(ground);
    leaf->seed = seed;
    leaf->threads = threads;
    leaf->net = net;
    leaf->counts = (SimulationCounts){.step = net->n_steps, .nodes = net->n_nodes, .end = end};
    for (uint32_t e = 0; e < net->n_edges; e++)
        leaf->counts.joins += net->kind[e] == EDGE_ANASTOMOSIS;
    leaf->length = leaf->net->length = length;
    leaf->stage = net->margin->box;
    open_holes(leaf);
    return leaf;
}

/* A blade in which no vein was drawn or found. */
static Network *bare(const Polygon *outline, double length)
{
    Network *net = network_new(1, 0);
    net->margin = polygon_scaled(outline, length);
    return net;
}

static gboolean drawn_network(const Params *p, const Ground *g, double length, Network **net, GError **error)
{
    DrawingDef def = drawing_def_default();
    *net = NULL;
    if (!g->drawing || g->drawing->n == 0)
        return TRUE;
    def.length = length;
    def.widths = settings_widths(p);
    def.where = params_text(p, g->found ? PARAM_SCAN_FILE : PARAM_VEINS_DRAWING);
    GError *cause = NULL;
    *net = drawing_network(g->drawing, g->outline, &def, &cause);
    if (cause && g->drawing_lies && g_error_matches(cause, DRAWING_ERROR, DRAWING_ERROR_OUTSIDE))
        g_set_error(error, cause->domain, cause->code, "%s; the drawing was laid on the scan by %s", cause->message, g->drawing_lies);
    else if (cause)
        g_propagate_error(error, g_steal_pointer(&cause));
    g_clear_error(&cause);
    return *net != NULL;
}

/* ---- the way to a leaf ---- */

static VenLeaf *grow_in(const Params *p, Ground *ground, SimulationDef *def, const VenOptions *options, GError **error)
{
    double length = simulation_final_length(def, error);
    int origin = params_choice(p, PARAM_VEINS_ORIGIN);
    Network *net = NULL;
    if (length <= 0.0)
        return NULL;
    if (origin == ORIGIN_LSYSTEM) {
        net = ground_lsystem(ground, p, length, def->seed, error);
        return net ? leaf_of(p, ground, def->seed, def->threads, net, length, END_LSYSTEM) : NULL;
    }
    if (!drawn_network(p, ground, length, &net, error))
        return NULL;
    if (origin == ORIGIN_DRAWN)
        return leaf_of(p, ground, def->seed, def->threads, net ? net : bare(ground->outline, length), length, END_DRAWN);
    def->given = net;
    def->given_length = length;
    if (net && !params_is_given(p, PARAM_VEINS_SEEDS))
        def->n_seeds = 0; /* the drawn veins begin somewhere */
    VenLeaf *leaf = run_all(p, ground, def, options, error);
    network_free(net);
    return leaf;
}

struct VenScan {
    GroundScan *ground;
};

VenScan *ven_scan_open(const VenParams *params, GError **error)
{
    GroundScan *ground = ground_scan_new(params->values, error);
    VenScan *sheet = ground ? g_new(VenScan, 1) : NULL;
    if (sheet)
        sheet->ground = ground;
    return sheet;
}

uint32_t ven_scan_count(const VenScan *sheet) { return ground_scan_leaves(sheet->ground); }

void ven_scan_close(VenScan *sheet)
{
    if (!sheet)
        return;
    ground_scan_free(sheet->ground);
    g_free(sheet);
}

VenLeaf *ven_grow(const VenParams *params, uint64_t seed, const VenOptions *options, GError **error)
{
    return ven_scan_grow(NULL, params, seed, options, error);
}

VenLeaf *ven_scan_grow(VenScan *sheet, const VenParams *params, uint64_t seed, const VenOptions *options, GError **error)
{
    const Params *p = params->values;
    gboolean maps[MAP_COUNT];
    if (!settings_maps(p, maps, error)) /* before the work, not after it */
        return NULL;
    Ground *ground = ground_new_on(sheet ? sheet->ground : NULL, p, params_choice(p, PARAM_VEINS_ORIGIN) != ORIGIN_LSYSTEM, error);
    SimulationDef def;
    VenLeaf *leaf = NULL;
    if (ground && settings_simulation(p, ground->outline, seed, options ? options->threads : 0, &def, error)) {
        leaf = grow_in(p, ground, &def, options, error);
        settings_simulation_clear(&def);
    }
    ground_unref(ground);
    return leaf;
}

/* ---- a network that is there already ---- */

/* A network that doesn't say its margin gets the outline of the parameters, at its own length if it says that, else at the final one. */
static gboolean give_margin(Network *net, const Params *p, const char *path, GError **error)
{
    if (!params_is_given(p, PARAM_OUTLINE_PATH) && !params_is_given(p, PARAM_OUTLINE_FILE)) {
        g_set_error(error, SETTINGS_ERROR, SETTINGS_ERROR_CONFLICT,
                    "%s: the graph has no attribute 'margin' (x,y x,y … in segments), nor do parameters give an [outline]", path);
        return FALSE;
    }
    Vec2 base, tip;
    Polygon *leaf = settings_outline(p, NULL, &base, &tip, error);
    if (!leaf)
        return FALSE;
    if (net->length == 0.0)
        net->length = params_number(p, PARAM_GROWTH_FINAL_LENGTH);
    net->margin = polygon_scaled(leaf, net->length);
    polygon_free(leaf);
    return import_check_inside(net, path, error);
}

VenLeaf *ven_leaf_load(const VenParams *params, const char *path, uint64_t seed, GError **error)
{
    const Params *p = params->values;
    WidthDef widths = settings_widths(p);
    Network *net = import_graphml(path, &widths, error);
    if (!net || (!net->margin && !give_margin(net, p, path, error))) {
        network_free(net);
        return NULL;
    }
    Ground *ground = NULL;
    if (*params_text(p, PARAM_SCAN_FILE) && !(ground = ground_new(p, false, error))) { /* for its colours */
        network_free(net);
        return NULL;
    }
    if (net->holes)
        net = network_tear(net, g_steal_pointer(&net->holes));
    VenLeaf *leaf = leaf_of(p, ground, seed, 0, net, net->length, END_LOADED);
    ground_unref(ground);
    return leaf;
}

const char *ven_leaf_end(const VenLeaf *leaf, uint64_t *given_up)
{
    if (given_up)
        *given_up = leaf->counts.given_up;
    return end_reason_text(leaf->counts.end);
}

const char *ven_leaf_note(const VenLeaf *leaf) { return leaf->ground ? leaf->ground->note->str : ""; }

double ven_leaf_cut_off(const VenLeaf *leaf) { return leaf->ground ? leaf->ground->cut_off : 0.0; }

/* ---- the network ---- */

uint32_t ven_leaf_nodes(const VenLeaf *leaf) { return leaf->net->n_nodes; }

uint32_t ven_leaf_edges(const VenLeaf *leaf) { return leaf->net->n_edges; }

void ven_leaf_node(const VenLeaf *leaf, uint32_t node, double *x, double *y, uint32_t *birth)
{
    g_return_if_fail(node < leaf->net->n_nodes);
    if (x)
        *x = leaf->net->node[node].x;
    if (y)
        *y = leaf->net->node[node].y;
    if (birth)
        *birth = leaf->net->node_birth[node];
}

void ven_leaf_edge(const VenLeaf *leaf, uint32_t edge, VenEdge *out)
{
    const Network *n = leaf->net;
    g_return_if_fail(edge < n->n_edges);
    *out = (VenEdge){.tail = n->tail[edge], .head = n->head[edge], .birth = n->birth[edge], .vein = n->vein[edge],
                     .order = n->order[edge], .rank = n->rank[edge], .anastomosis = n->kind[edge] == EDGE_ANASTOMOSIS,
                     .width = n->width[edge]};
}
