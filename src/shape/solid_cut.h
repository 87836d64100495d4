/* Vein solids end at the rims of holes. */
#ifndef SHAPE_SOLID_CUT_H
#define SHAPE_SOLID_CUT_H

#include "geom/holes.h"
#include "shape/solid.h"

/* The tubes without what of them lies in a hole of the flat blade (segments; NULL: none), by their axes; a tube that runs across one becomes two. The
 * petiole lies in none. By the flat leaf alone, so poses of one leaf still have the same tubes. `normal` is the blade's at each node. Takes
 * `tubes`; *n_tubes counts what is returned, which may be nothing. */
Tube *solid_cut(Tube *tubes, uint32_t *n_tubes, const Vec3 *normal, const Holes *holes);

#endif
