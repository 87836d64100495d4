#include "curve.h"

#include "sim/state.h"

static double now(void) { return (double)g_get_monotonic_time() * 1e-6; }

static double throw_darts(Simulation *s, uint32_t n)
{
    s->def.placement = PLACEMENT_DARTS;
    s->def.only_while_growing = false;
    s->def.birth_distance_sources = 1.5;
    s->def.birth_distance_veins = 1.0;
    s->def.density = (double)n / s->blade->area;
    sources_sort(s); /* their grid was not needed */
    uint64_t before = s->counts.darts;
    blade_advance(s->blade);
    double start = now();
    sources_place(s);
    return (now() - start) / (double)MAX(s->counts.darts - before, 1);
}

Costs curve_costs(const SimulationDef *def)
{
    Costs c = {0};
    GError *error = NULL;
    Simulation *s = simulation_new(def, &error);
    if (!s)
        g_error("%s", error->message);
    double births = 0.0, start = now(), rest = 0.0;
    for (bool on = true; on;) { /* simulation_step, of a blade that doesn't grow */
        blade_advance(s->blade);
        double t0 = now();
        sources_place(s);
        double t1 = now();
        uint32_t live = veins_develop(s);
        double t2 = now();
        sources_remove(s);
        double t3 = now();
        rest += t1 - t0;
        births += t2 - t1;
        on = sources_alive(s) && (live || s->n_fresh);
        c.update += t3 - t2;
    }
    c.seconds = now() - start;
    c.counts = simulation_counts(s);
    c.update = (c.update + rest) / (double)MAX(c.counts.updates, 1);
    c.node = births / (double)c.counts.nodes;
    c.dart = throw_darts(s, def->n_list);
    simulation_free(s);
    return c;
}
