/* L-systems, as parameter files: whatever the bytes, there are sound veins, or an error. */
#include "fuzz.h"
#include "geom/outline.h"
#include "lib/settings.h"
#include "sound.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    GError *error = NULL;
    Params *p = params_parse((const char *)data, size, "fuzz.ini", &error);
    fuzz_check_error(p != NULL, &error, PARAM_ERROR, 0);
    if (!p)
        return 0;
    OutlineDef outline = outline_def_default();
    LSystemDef def = settings_lsystem(p, params_choice(p, PARAM_LSYSTEM_PRESET) == 2, 1);
    Polygon *leaf = outline_new(&outline, NULL);
    def.max_symbols = 3000; /* that is enough to go wrong, and quick */
    Network *net = lsystem_network(&def, leaf, 40.0, NULL, &error);
    fuzz_check_error(net != NULL, &error, LSYSTEM_ERROR, 0);
    if (net)
        sound_network(net);
    network_free(net);
    polygon_free(leaf);
    settings_lsystem_clear(p, &def);
    params_free(p);
    return 0;
}
