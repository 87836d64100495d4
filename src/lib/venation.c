/* The public interface: parameters in, a grown leaf out. */
#include "venation.h"

#include <gio/gio.h>

#include "import/import.h"
#include "lib/leaf.h"
#include "lib/settings.h"

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

static VenLeaf *leaf_new(const Params *params, const SimulationDef *def, const Simulation *sim)
{
    const Blade *blade = simulation_blade(sim);
    WidthDef widths = settings_widths(params);
    VenLeaf *leaf = g_new0(VenLeaf, 1);
    leaf->params = params_copy(params);
    leaf->seed = def->seed;
    leaf->threads = def->threads;
    leaf->net = simulation_network(sim);
    network_assign_widths(leaf->net, &widths);
    leaf->counts = simulation_counts(sim);
    leaf->length = blade->length;
    leaf->growth_steps = blade->last_step;
    leaf->stage = blade->widest;
    return leaf;
}

void ven_leaf_free(VenLeaf *leaf)
{
    if (!leaf)
        return;
    network_free(leaf->net);
    params_free(leaf->params);
    g_free(leaf);
}

/* One growing of the leaf, of which a run has two when snapshots are asked for: the first one learns the scale. */
typedef struct {
    const Params *params;
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
        p.leaf = snapshot = leaf_new(pass->params, pass->def, sim);
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
    gboolean more = TRUE, stopped = FALSE;
    while (more && !stopped) {
        more = simulation_step(sim);
        stopped = !report(pass, sim);
    }
    VenLeaf *leaf = NULL;
    if (stopped)
        g_set_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED, "stopped at step %u", simulation_counts(sim).step);
    else
        leaf = leaf_new(pass->params, pass->def, sim);
    simulation_free(sim);
    return leaf;
}

static VenLeaf *run_all(const Params *params, const SimulationDef *def, const VenOptions *options, GError **error)
{
    Pass pass = {.params = params, .def = def, .options = options, .to = 1.0};
    if (!options || !options->snapshot_every || !options->progress)
        return run(&pass, error);
    pass.to = 0.3;
    VenLeaf *first = run(&pass, error), *leaf = NULL;
    if (first) {
        pass = (Pass){params, def, options, 0.3, 1.0, options->snapshot_every, first->net};
        leaf = run(&pass, error);
    }
    ven_leaf_free(first);
    return leaf;
}

VenLeaf *ven_grow(const VenParams *params, uint64_t seed, const VenOptions *options, GError **error)
{
    const Params *p = params->values;
    gboolean maps[MAP_COUNT];
    if (!settings_maps(p, maps, error)) /* before the work, not after it */
        return NULL;
    Polygon *outline = settings_outline(p, error);
    SimulationDef def;
    VenLeaf *leaf = NULL;
    if (outline && settings_simulation(p, outline, seed, options ? options->threads : 0, &def, error)) {
        leaf = run_all(p, &def, options, error);
        settings_simulation_clear(&def);
    }
    polygon_free(outline);
    return leaf;
}

/* ---- a network that is there already ---- */

/* The margin of a network that doesn't say it: the outline of the parameters at the final length. */
static Polygon *given_margin(const Params *p, const char *path, GError **error)
{
    if (!params_is_given(p, PARAM_OUTLINE_PATH) && !params_is_given(p, PARAM_OUTLINE_FILE)) {
        g_set_error(error, SETTINGS_ERROR, SETTINGS_ERROR_CONFLICT,
                    "%s: the graph has no attribute 'margin' (x,y x,y … in segments), nor do parameters give an [outline]", path);
        return NULL;
    }
    Polygon *leaf = settings_outline(p, error);
    if (!leaf)
        return NULL;
    Polygon *margin = polygon_scaled(leaf, params_number(p, PARAM_GROWTH_FINAL_LENGTH));
    polygon_free(leaf);
    return margin;
}

VenLeaf *ven_leaf_load(const VenParams *params, const char *path, uint64_t seed, GError **error)
{
    const Params *p = params->values;
    WidthDef widths = settings_widths(p);
    Network *net = import_graphml(path, &widths, error);
    if (net && !net->margin)
        net->margin = given_margin(p, path, error);
    if (!net || !net->margin) {
        network_free(net);
        return NULL;
    }
    VenLeaf *leaf = g_new0(VenLeaf, 1);
    leaf->params = params_copy(p);
    leaf->seed = seed;
    leaf->net = net;
    leaf->counts = (SimulationCounts){.step = net->n_steps, .nodes = net->n_nodes, .end = END_LOADED};
    for (uint32_t e = 0; e < net->n_edges; e++)
        leaf->counts.joins += net->kind[e] == EDGE_ANASTOMOSIS;
    leaf->length = net->margin->box.y1; /* the base is at the origin, the tip along +y */
    leaf->stage = net->margin->box;
    return leaf;
}

const char *ven_leaf_end(const VenLeaf *leaf, uint64_t *given_up)
{
    if (given_up)
        *given_up = leaf->counts.given_up;
    return end_reason_text(leaf->counts.end);
}

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
