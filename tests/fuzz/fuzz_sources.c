/* Source lists: whatever the bytes, there are sources that a small leaf grows toward for some steps, or an error. */
#include "fuzz.h"
#include "lib/settings.h"
#include "sound.h"

static void grow(const ListedSource *list, uint32_t n, bool open)
{
    enum { STEPS = 40 };
    GError *error = NULL;
    OutlineDef outline = outline_def_default();
    SimulationDef def = simulation_def_default();
    WidthDef widths = width_def_default();
    Polygon *leaf = outline_new(&outline, NULL);
    def.leaf = leaf;
    def.growth.kind = GROWTH_ISOGONIC;
    def.growth.initial_length = 20;
    def.growth.final_length = 30;
    def.growth.step = 1;
    def.placement = PLACEMENT_LIST;
    def.pattern = open ? PATTERN_OPEN : PATTERN_CLOSED;
    def.list = list;
    def.n_list = n;
    def.threads = 1;
    Simulation *sim = simulation_new(&def, &error);
    fuzz_check_error(sim != NULL, &error, SIMULATION_ERROR, 0);
    if (sim) {
        for (int i = 0; i < STEPS && simulation_step(sim); i++)
            ;
        Network *net = simulation_network(sim);
        network_assign_widths(net, &widths);
        sound_network(net);
        network_free(net);
    }
    simulation_free(sim);
    polygon_free(leaf);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    GError *error = NULL;
    ListedSource *list = NULL;
    uint32_t n = 0;
    bool ok = source_list_read(fuzz_file("sources.csv", data, size), &list, &n, &error);
    fuzz_check_error(ok, &error, SETTINGS_ERROR, 0);
    if (!ok)
        return 0;
    require(n > 0);
    for (uint32_t i = 0; i < n; i++)
        require(isfinite(list[i].pos.x) && isfinite(list[i].pos.y));
    if (n < 500) {
        grow(list, n, false);
        grow(list, n, true);
    }
    g_free(list);
    return 0;
}
