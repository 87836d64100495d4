/* [specimen]: from the parameter table to the definition that src/image works from. */
#include "lib/settings.h"

SpecimenDef settings_specimen(const Params *p, uint64_t seed)
{
    SpecimenDef d = {.abaxial = params_choice(p, PARAM_SPECIMEN_SIDE) == 1,
                     .grain = params_number(p, PARAM_SPECIMEN_GRAIN),
                     .light = params_number(p, PARAM_SPECIMEN_LIGHT),
                     .light_angle = params_number(p, PARAM_SPECIMEN_LIGHT_ANGLE),
                     .backlight = params_number(p, PARAM_SPECIMEN_BACKLIGHT),
                     .sheen = params_number(p, PARAM_SPECIMEN_SHEEN),
                     .falloff = params_number(p, PARAM_SPECIMEN_FALLOFF),
                     .vignette = params_number(p, PARAM_SPECIMEN_VIGNETTE),
                     .shadow = params_number(p, PARAM_SPECIMEN_SHADOW),
                     .shadow_size = params_number(p, PARAM_SPECIMEN_SHADOW_SIZE),
                     .blur = params_number(p, PARAM_SPECIMEN_BLUR),
                     .exposure = params_number(p, PARAM_SPECIMEN_EXPOSURE),
                     .contrast = params_number(p, PARAM_SPECIMEN_CONTRAST),
                     .warmth = params_number(p, PARAM_SPECIMEN_WARMTH),
                     .noise = params_number(p, PARAM_SPECIMEN_NOISE),
                     .chroma_noise = params_number(p, PARAM_SPECIMEN_CHROMA_NOISE)};
    int64_t own = params_integer(p, PARAM_SPECIMEN_SEED);
    d.seed = own > 0 ? (uint64_t)own : seed;
    paint_colour(params_colour(p, PARAM_SPECIMEN_BACKGROUND), d.background);
    return d;
}
