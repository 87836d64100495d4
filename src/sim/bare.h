/* How large a part of a blade has no vein. */
#ifndef SIM_BARE_H
#define SIM_BARE_H

#include "sim/network.h"

/* Diameter of the largest disc within the margin that no vein touches, as part of the blade's width (from left to right), to 1 %; *centre, unless
 * NULL, receives its place in segments. Veins are taken by their nodes, a segment apart. The network has a margin. */
double bare_disc(const Network *net, Vec2 *centre);

#endif
