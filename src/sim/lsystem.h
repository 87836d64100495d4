/* Veins by a bracketed L-system (Lindenmayer 1968; Prusinkiewicz & Lindenmayer 1990) drawn by a turtle inside a leaf's outline, as Fang &
 * Shen 2013, section 4.2, reconstruct the veins of a citrus leaf. */
#ifndef SIM_LSYSTEM_H
#define SIM_LSYSTEM_H

#include <glib.h>

#include "sim/network.h"
#include "sim/width.h"

/* Symbols are letters, digits and + - [ ] | ! @ ^ < > ~ $; blanks are skipped. To the turtle, which starts at the base and looks at the tip,
 *
 *   F, and each symbol of `draws`   a step forwards that leaves a vein
 *   f                               a step without one; what is drawn next begins a vein of its own, with a first node
 *   + -                             turns by `angle` to the left, to the right
 *   |                               turns round, 180°
 *   [ ]                             a branch: remembers where the turtle is and how it draws, and goes back there
 *   ! @                             from here to the end of the branch widths are multiplied by `width_scale`, lengths by `length_scale`
 *
 * Some ask for the blade, and do nothing where there is none:
 *
 *   ^               draws straight on to the hub, where the blade's lobes part (sim/lobes.h); steps are then parts of the way from there to
 *                   the tip
 *   < >             turn to the tip of the next lobe on the left, on the right. From here to the end of the branch steps and the bend are
 *                   parts of the way to that tip, the bend is towards it, veins end where the lobe's field does, and orders begin at 1.
 *                   Where there is no further lobe the rest of the branch is not drawn
 *   ~               the vein minds at its beginning: as long as there is no room ahead it turns towards the lobe's own vein, and bears
 *                   nothing; its branches stay on its side of the lobe's vein
 *   $               draws on to the margin or the end of the field
 *
 * and all others mean nothing. The step of a symbol that the k-th iteration wrote is step · length_scale^k long, its width
 * width · width_scale^k.
 *
 * In a curved blade all this is as if its middle line (sim/lturtle_axis.h), or the midrib that is given, were straight: at any height the turtle's
 * directions are turned as the line is there. So what goes straight on from the base follows the line, and what leaves it at an angle leaves it
 * at that angle, and bends as the line does. Steps are parts of the line's length. It concerns the middle lobe; other lobes' veins head for
 * their tips as they are. Where the line is straight, nothing is turned, and where there is no blade there is none. */
typedef struct {
    const char *axiom;
    const char *const *production; /* [n_productions] "F=FF[+F]": one symbol, no bracket, and what replaces it, maybe nothing. Several for
                                    * one symbol are chosen from at random, by weights: "F:0.3=FF"; without it the weight is 1 */
    uint32_t n_productions;
    uint32_t iterations;  /* 0 … 1000 */
    uint64_t seed;        /* of those choices */
    uint32_t max_symbols; /* no string may grow longer, nor a drawing have more pieces; 1 … 2^28 */
    const char *draws;    /* symbols that draw like F; NULL: none */
    double angle;         /* degrees, -360 … 360 */
    double step;          /* leaf lengths, 1e-9 … 1000 */
    double length_scale;  /* 0.001 … 10 */
    double bend;          /* degrees by which a vein at right angles to the axis turns towards the tip in a leaf length, -3600 … 3600 */
    bool murray;          /* widths by Murray's law from `widths`, else by width and its scale */
    WidthDef widths;
    double width;       /* segments, 1e-9 … 1e6 */
    double width_scale; /* 0.001 … 10 */
    const struct LAxis *axis; /* the midrib that the drawing follows (sim/lturtle_axis.h); NULL: the blade's middle line */
} LSystemDef;

/* A pinnate leaf in which `margin_veins` S laterals meet the margin, by the numbers of section 4.2: N = (S - 2) / 2 iterations and an
 * angle of 180/N degrees. Of axiom and productions the paper says that [+L]V[-R] is the axiom and that the midvein V and the laterals L
 * and R on its left and right have one production each, but not which. Here an iteration adds to the midvein an internode with a pair of
 * laterals and to each lateral four steps with veins of the third order. The axiom is [+L][-R]V, for after a midvein that grows the right
 * one would sit at the tip; and a lateral leaves by as many + or - (1 to 4) as bring it nearest to 50°, which one angle of 180/N is only
 * for N near 4. Steps shrink towards the tip by 0.9 an iteration; laterals turn towards it and go on to the margin. The lowest pair gives way
 * where the base is narrow or dented, and has veins on its outer side that run to the margin. S is held within 8 … 34; the default is 16. */
LSystemDef lsystem_def_pinnate(uint32_t margin_veins);

/* A palmate leaf: the same midvein in each lobe of the blade, all from the hub; the lowest laterals of each have branches on both sides, which
 * fill what lies below the outermost lobes. `margin_veins` counts as for the pinnate leaf, and so for each lobe. */
LSystemDef lsystem_def_palmate(uint32_t margin_veins);
LSystemDef lsystem_def_default(void);

typedef enum {
    LSYSTEM_ERROR_SYNTAX,   /* axiom or productions are not as they should be */
    LSYSTEM_ERROR_SETTINGS, /* a number out of its range */
    LSYSTEM_ERROR_LIMIT,    /* a string or a drawing would be too long */
    LSYSTEM_ERROR_EMPTY,    /* nothing is drawn */
} LSystemError;
#define LSYSTEM_ERROR lsystem_error_quark()
GQuark lsystem_error_quark(void);

/* The last string. */
typedef struct {
    uint32_t n;
    char *symbol;   /* [n], and a 0 */
    uint16_t *born; /* [n] iteration that wrote it; 0 for the axiom's */
} LString;

/* Rewrites the axiom. The length of each string is known before memory is taken for it. O(symbols). */
LString *lsystem_expand(const LSystemDef *def, GError **error);
void lstring_free(LString *s);

/* The veins drawn in a leaf (leaf coordinates: base 0,0, tip 0,1) of `length` segments, as a network in segments; or without a leaf (NULL)
 * and a margin. Steps are cut into pieces no longer than a segment, each an edge. A vein that comes to the margin ends there, just
 * inside, and with it the rest of its branch; veins may cross one another if the productions make them. Nodes are numbered as they are
 * drawn, so that tails are older than heads; births are the iterations, and never before the parent's. Orders are the depth of
 * brackets, from 1 (in a lobe, from its own vein); a vein is what one branch draws without those that leave it. Flow and rank are network_assign_widths'. *margin_veins,
 * unless NULL, receives how many veins came to the margin. O(pieces + pieces near the margin · vertices); for
 * the middle line 2700 · vertices more, and where lobes are asked for, 1900. */
Network *lsystem_network(const LSystemDef *def, const Polygon *leaf, double length, uint32_t *margin_veins, GError **error);

/* Whether the numbers of the definition are in their ranges; lsystem_network asks it too. */
bool lsystem_check(const LSystemDef *def, GError **error);

#endif
