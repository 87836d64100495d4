/* From the values of the parameter table to the definitions that the rooms work from. */
#ifndef LIB_SETTINGS_H
#define LIB_SETTINGS_H

#include <glib.h>

#include "geom/outline.h"
#include "image/paint.h"
#include "image/specimen.h"
#include "param/params.h"
#include "scan/fang.h"
#include "scan/found.h"
#include "scan/profile.h"
#include "sim/lsystem.h"
#include "sim/simulation.h"
#include "sim/width.h"

typedef enum {
    SETTINGS_ERROR_CONFLICT, /* parameters that contradict each other */
    SETTINGS_ERROR_SOURCES,  /* a line of the source list that is no source */
} SettingsError;
#define SETTINGS_ERROR settings_error_quark()
GQuark settings_error_quark(void);

/* The outline that [outline] asks for, in leaf coordinates; *base and *tip receive where 0,0 and 0,1 were in the units of the path or file, y up,
 * or of the image that the file was placed on; `place` may be NULL. */
Polygon *settings_outline(const Params *p, const SvgPlace *place, Vec2 *base, Vec2 *tip, GError **error);

/* [scan] of an image `height` pixels high. */
ProfileDef settings_profile(const Params *p, uint32_t height);
/* False when something is given that the method does not use. */
bool settings_fang(const Params *p, uint32_t height, FangDef *out, GError **error);
FoundDef settings_found(const Params *p);

/* [lsystem], what is not given by the palmate or the pinnate leaf; free with settings_lsystem_clear. */
LSystemDef settings_lsystem(const Params *p, bool palmate, uint64_t seed);
bool settings_lsystem_is_own(const Params *p); /* axiom or productions are given */
void settings_lsystem_clear(const Params *p, LSystemDef *def);

/* The simulation that the parameters ask for, on outline `leaf`, which must outlive it. Free with settings_simulation_clear. */
gboolean settings_simulation(const Params *p, const Polygon *leaf, uint64_t seed, unsigned threads, SimulationDef *def, GError **error);
void settings_simulation_clear(SimulationDef *def);

WidthDef settings_widths(const Params *p);
PaintStyle settings_style(const Params *p, uint64_t seed, unsigned threads);

/* [specimen]; `seed` is that of the run. */
SpecimenDef settings_specimen(const Params *p, uint64_t seed);

/* Fills wanted[MAP_COUNT] from texture.maps; an unknown name is an error. */
gboolean settings_maps(const Params *p, gboolean *wanted, GError **error);

/* Auxin sources of a CSV file: x, y and an optional step a line, separated by commas, semicolons or blanks; '#' begins a comment; a
 * first line that begins with the words x and y is a heading. */
gboolean source_list_read(const char *path, ListedSource **list, uint32_t *n, GError **error);

#endif
