#include "sim/simulation.h"

#include <string.h>

#include "sim/state.h"

G_DEFINE_QUARK(simulation-error-quark, simulation_error)

SimulationDef simulation_def_default(void)
{
    static const Vec2 base = {0.0, 0.0};
    return (SimulationDef){.growth = growth_def_default(),
                           .density = 0.0006,
                           .birth_distance_sources = 10,
                           .birth_distance_veins = 10,
                           .pattern = PATTERN_CLOSED,
                           .kill_distance = 1,
                           .seeds = &base,
                           .n_seeds = 1,
                           .sinus_depth = 0.02,
                           .join_distance = 2.5,
                           .seed = 1};
}

const char *end_reason_text(EndReason r)
{
    static const char *const text[] = {"running", "every source was reached", "no vein can reach the sources left", "veins.max_steps",
                                       "no source ever found room", "read from a file",
                                       "drawn, not grown", "written by an L-system", "too many sources or vein nodes"};
    return text[r];
}

/* ---- one step ---- */

/* Moves a source with the blade. Tags stay with the nodes that keep in its neighbourhood. */
static void carry_source(Simulation *s, uint32_t k)
{
    Source *src = s->source ? &s->source[k] : NULL, old = {0};
    if (src) {
        source_set_apart(s, k);
        old = *src;
    }
    s->place[k] = blade_place(s->blade, s->material[k]);
    source_look(s, k);
    s->mark[k] &= (uint8_t)~MARK_IDLE;
    if (!src)
        return;
    src->tagged = src->spent = 0;
    for (uint32_t i = 0; i < src->hood.n; i++)
        for (uint32_t j = 0; j < old.hood.n; j++)
            if (src->hood.m[i] == old.hood.m[j])
                src->tagged |= (uint8_t)((old.tagged >> j & 1) << i);
    source_weigh(s, k);
}

static void carry_sources(uint32_t first, uint32_t last, void *user)
{
    Simulation *s = user;
    for (uint32_t k = first; k < last; k++)
        if (source_is_alive(s, k))
            carry_source(s, k);
}

/* Nonuniform growth carries nodes and sources along; distances change their ratios, so neighbourhoods are found anew. */
static void carry_along(Simulation *s)
{
    enum { GRAIN = 8 };
    Veins *v = &s->veins;
    Box2 field = s->blade->widest;
    for (uint32_t i = 0; i < v->n; i++) {
        v->pos[i] = blade_place(s->blade, v->material[i]);
        field = box_add(field, v->pos[i]); /* one born off the blade is carried farther off */
    }
    quadtree_reset(&v->tree, box_grow(field, 4.0));
    for (uint32_t i = 0; i < v->n; i++)
        quadtree_add(&v->tree, v->pos[i], i);
    s->counts.updates += sources_alive(s);
    pool_for(s->pool, s->n_sources, GRAIN, carry_sources, s);
    sources_sort(s);
}

static void grow_blade(Simulation *s)
{
    bool grows = s->blade->step < s->blade->last_step;
    blade_advance(s->blade);
    if (grows && s->blade->moving)
        carry_along(s);
}

/* Why the run ends after a step in which `live` sources pulled, or END_RUNNING. */
static EndReason judge(const Simulation *s, uint32_t live)
{
    if (s->def.max_steps && s->blade->step >= s->def.max_steps)
        return END_MAX_STEPS;
    if (s->blade->step < s->blade->last_step || sources_waiting(s))
        return END_RUNNING;
    if (sources_expected(s))
        return END_RUNNING;
    if (sources_alive(s) == 0)
        return s->counts.placed ? END_NO_SOURCES : END_BARE;
    return live || s->n_fresh ? END_RUNNING : END_UNREACHED;
}

bool simulation_step(Simulation *s)
{
    if (s->counts.end != END_RUNNING)
        return false;
    grow_blade(s);
    sources_place(s);
    if (s->n_sources >= MOST_SOURCES || s->veins.n >= MOST_NODES) {
        s->counts.end = END_CROWDED;
        return false;
    }
    s->counts.most_sources = MAX(s->counts.most_sources, sources_alive(s));
    uint32_t live = veins_develop(s);
    if (live || s->n_fresh || s->blade->step <= s->blade->last_step) {
        s->last_use = s->blade->step;
        s->last_darts = s->counts.darts;
    }
    sources_remove(s);
    s->counts.end = judge(s, live);
    return s->counts.end == END_RUNNING;
}

/* ---- set-up ---- */

/* A run that would throw darts for ever, or as good as. That one comes to an end at all is certain otherwise: once no source comes any more, each step
 * bears a node, of which so many have room (`crowding` in develop.c), or some source lets go of a node for good. */
static gboolean check_darts(const SimulationDef *d, const Blade *b, double area, GError **error)
{
    const double most = 1e11, longest = 1e6;
    double steps = d->max_steps ? MIN(d->max_steps, b->last_step) : b->last_step, darts = d->density * area * steps;
    if (darts > most) {
        g_set_error(error, SIMULATION_ERROR, SIMULATION_ERROR_SIZE,
                    "sources.density = %g asks for about %.2g darts in the %.0f steps of growth; at most %g are possible: it must be lower, or the blade "
                    "grow in fewer steps", d->density, darts, steps, most);
        return FALSE;
    }
    /* however small the distances, veins leave no more room than for one a segment apart (`crowding`, and how near a source is passed) */
    double apart = MAX(MAX(d->birth_distance_veins, d->kill_distance), 1.0), wait = 1.0 / (d->density * apart * apart);
    if (!d->max_steps && !d->only_while_growing && wait > longest && sources_are_many(d->density * area)) {
        g_set_error(error, SIMULATION_ERROR, SIMULATION_ERROR_SIZE,
                    "sources.density = %g throws a dart where there is room for one, %g segments apart from the veins, only every %.2g steps; at most %g are "
                    "possible: it must be higher, or sources.duration = growth", d->density, apart, wait, longest);
        return FALSE;
    }
    return TRUE;
}

static gboolean check(const SimulationDef *d, const Blade *b, GError **error)
{
    double first = d->leaf->area * d->growth.initial_length * d->growth.initial_length;
    double last = b->moving ? b->last_shape->area : d->leaf->area * b->last_length * b->last_length, area = MAX(first, last);
    if (d->placement == PLACEMENT_DARTS && d->density * area > 1e8) {
        g_set_error(error, SIMULATION_ERROR, SIMULATION_ERROR_SIZE,
                    "sources.density = %g asks for %.3g darts a step on a blade of %.3g square segments; at most 1e8 are possible",
                    d->density, d->density * area, area);
        return FALSE;
    }
    double room = d->birth_distance_sources > 0.0 ? 0.7 * area / (d->birth_distance_sources * d->birth_distance_sources) : HUGE_VAL; /* when jammed */
    if (d->placement != PLACEMENT_LIST && MIN(room, d->density * area) > MOST_SOURCES) {
        g_set_error(error, SIMULATION_ERROR, SIMULATION_ERROR_SIZE,
                    "sources.density = %g with sources.birth_distance_sources = %g makes %.3g sources at once on a blade of %.3g square segments; at "
                    "most %.3g can be kept", d->density, d->birth_distance_sources, MIN(room, d->density * area), area, (double)MOST_SOURCES);
        return FALSE;
    }
    if (d->placement == PLACEMENT_DARTS && !check_darts(d, b, area, error))
        return FALSE;
    if (d->placement == PLACEMENT_DARTS && !d->only_while_growing && MAX(d->birth_distance_veins, d->kill_distance) <= 0.0) {
        g_set_error(error, SIMULATION_ERROR, SIMULATION_ERROR_SOURCES,
                    "sources.birth_distance_veins and veins.kill_distance are both 0, so darts would find room for ever: one of them must "
                    "be above 0, or sources.duration = growth");
        return FALSE;
    }
    return TRUE;
}

/* About how far apart sources will lie, for the cell size of their index. */
static double source_spacing(const SimulationDef *d, const Blade *b)
{
    double length = b->last_length, apart = d->density > 1.0 ? sqrt(1.0 / d->density) : 1.0;
    if (d->placement == PLACEMENT_MARGIN)
        apart = sqrt(1.0 / MAX(d->density, 1e-12));
    if (d->placement == PLACEMENT_LIST)
        return sqrt(d->leaf->area / MAX(d->n_list, 1)) * length;
    return MAX(d->birth_distance_sources, apart);
}

static gboolean plant_seeds(Simulation *s, GError **error)
{
    if (s->def.n_seeds == 0 && s->given.n == 0) {
        g_set_error(error, SIMULATION_ERROR, SIMULATION_ERROR_SEEDS, "veins.seeds is empty: a leaf needs at least one first vein node");
        return FALSE;
    }
    double slack = 1e-6;
    for (uint32_t i = 0; i < s->def.n_seeds; i++) {
        Vec2 leaf = s->def.seeds[i];
        if (!polygon_contains(s->def.leaf, leaf) && polygon_depth(s->def.leaf, leaf) < -slack) {
            g_set_error(error, SIMULATION_ERROR, SIMULATION_ERROR_SEEDS,
                        "veins.seeds: the first vein node at %g,%g lies outside the blade (leaf lengths, base 0,0, tip 0,1)", leaf.x, leaf.y);
            return FALSE;
        }
        Vec2 material = vec_scale(leaf, s->def.growth.initial_length);
        uint32_t v = veins_add(&s->veins, blade_place(s->blade, material), NO_POINT, 0);
        if (s->blade->moving)
            s->veins.material[v] = material;
    }
    return TRUE;
}

Simulation *simulation_new(const SimulationDef *def, GError **error)
{
    Blade *blade = blade_new(def->leaf, &def->growth, error);
    if (!blade)
        return NULL;
    if (!check(def, blade, error)) {
        blade_free(blade);
        return NULL;
    }
    Simulation *s = g_new0(Simulation, 1);
    s->def = *def;
    s->blade = blade;
    s->pool = pool_new(def->threads);
    s->nodes = g_array_new(FALSE, FALSE, sizeof(uint32_t));
    s->unused_arrival = NO_POINT;
    s->reach = reach_new(def->leaf, def->sinus_depth);
    if (reach_is_trivial(s->reach)) {
        reach_free(s->reach);
        s->reach = NULL;
    }
    Box2 field = box_grow(blade->widest, 4.0 * blade->unit + 4.0);
    veins_init(&s->veins, field);
    if (blade->moving)
        s->veins.material = g_new(Vec2, 1); /* grows with the nodes */
    double least = source_spacing(def, blade);
    grid_init(&s->grid, field, (def->pattern == PATTERN_OPEN ? 8.0 : 2.0) * least);
    given_prepare(s);
    if (!sources_prepare(s, error) || !plant_seeds(s, error)) {
        simulation_free(s);
        return NULL;
    }
    given_appear(s, NULL);
    return s;
}

void simulation_free(Simulation *s)
{
    if (!s)
        return;
    for (uint32_t k = 0; s->cell && k < s->n_sources; k++)
        cell_clear(&s->cell[k]);
    pool_free(s->pool);
    reach_free(s->reach);
    veins_clear(&s->veins);
    given_clear(&s->given);
    grid_clear(&s->grid);
    crowds_clear(&s->crowds);
    blade_free(s->blade);
    g_free(s->place);
    g_free(s->birth);
    g_free(s->mark);
    g_free(s->material);
    g_free(s->near);
    g_free(s->near2);
    g_free(s->source);
    g_free(s->zone);
    g_free(s->cell);
    g_free(s->arrival);
    g_free(s->paths.bits);
    g_free(s->waiting);
    lanes_free(s);
    g_array_unref(s->nodes);
    g_free(s->pulled);
    g_free(s->fresh);
    quadtree_clear(&s->young);
    boxtree_clear(&s->fresh_tree);
    g_free(s->fresh_points.v);
    g_free(s->fresh_points.x);
    g_free(s->fresh_points.y);
    g_free(s);
}

/* ---- what it tells ---- */

SimulationCounts simulation_counts(const Simulation *s)
{
    SimulationCounts c = s->counts;
    c.step = s->blade->step;
    c.nodes = s->veins.n;
    c.joins = s->veins.n_joins;
    c.sources = sources_alive(s);
    c.given_up = c.end == END_UNREACHED ? c.sources : 0;
    return c;
}

const Blade *simulation_blade(const Simulation *s) { return s->blade; }

double simulation_done(const Simulation *s)
{
    /* a tip advances by one segment a step, so a run takes about as many steps as the leaf is long, and the growth before */
    double expected = MAX((double)s->blade->last_step, s->blade->last_length * 1.1);
    double part = (double)s->blade->step / expected;
    return s->counts.end != END_RUNNING ? 1.0 : part < 0.99 ? part : 0.99;
}

const uint32_t *simulation_given(const Simulation *s) { return s->given.n ? s->given.node : NULL; }

double simulation_final_length(const SimulationDef *def, GError **error)
{
    Blade *blade = blade_new(def->leaf, &def->growth, error);
    double length = blade ? blade->last_length : 0.0;
    blade_free(blade);
    return length;
}

Network *simulation_network(const Simulation *s)
{
    const Veins *v = &s->veins;
    uint32_t n_edges = v->n_joins;
    for (uint32_t i = 0; i < v->n; i++)
        n_edges += v->parent[i] != NO_POINT;
    Network *net = network_new(v->n, n_edges);
    net->n_steps = s->blade->step;
    double to_segments = s->blade->moving ? 1.0 : 1.0 / s->blade->unit;
    uint32_t e = 0;
    for (uint32_t i = 0; i < v->n; i++) {
        net->node[i] = vec_scale(v->pos[i], to_segments);
        net->node_birth[i] = v->birth[i];
        if (v->parent[i] == NO_POINT)
            continue;
        net->tail[e] = v->parent[i];
        net->head[e] = i;
        net->birth[e] = v->birth[i];
        net->kind[e++] = EDGE_VEIN;
    }
    for (uint32_t j = 0; j < v->n_joins; j++, e++) {
        net->tail[e] = v->join_tail[j];
        net->head[e] = v->join_head[j];
        net->birth[e] = v->join_birth[j];
        net->kind[e] = EDGE_ANASTOMOSIS;
    }
    Polygon *outline = blade_outline(s->blade);
    net->margin = polygon_scaled(outline, to_segments);
    polygon_free(outline);
    return net;
}
