/* The turtle of sim/lsystem.h from inside: what lturtle.c, which draws, and lturtle_blade.c, which asks the blade, share. */
#ifndef SIM_LTURTLE_H
#define SIM_LTURTLE_H

#include "sim/lobes.h"
#include "sim/lsystem.h"
#include "sim/lturtle_axis.h"

enum { NONE = UINT32_MAX, MAX_ORDER = 250 };

/* A place where drawing may start: the base, or the end of an f. Its node is made when something is drawn there. */
typedef struct {
    Vec2 at;
    uint32_t node;
} Spot;

typedef struct {
    Vec2 at;
    double heading;       /* degrees from the x axis, in the middle lobe of a curved blade as if its middle line were straight */
    double length, width; /* factors of @ and ! */
    int lobe;             /* 0 the middle one, left of it below 0 */
    double tilt;          /* degrees from the leaf's axis to the lobe's, left positive */
    double scale;         /* of the lobe: its length in leaf lengths */
    uint32_t first;       /* depth of brackets of the lobe's primary vein */
    double wary;          /* ~: for so long it turns aside where there's no room; segments */
    double swerve;        /* by how much now, degrees */
    int side;             /* ~: of the lobe's axis that its branches keep to, left 1; 0: any */
    uint32_t node, spot;  /* where it is: a node, or NONE and a spot */
    uint32_t vein;        /* that it draws; NONE before its first piece */
    bool stopped;         /* at the margin */
    Vec2 centre;          /* all points nearer than `radius` to the centre are inside the margin */
    double radius;
} Turtle;

typedef struct {
    uint32_t tail, head, vein;
    uint16_t born;
    uint8_t order;
    double width;
} Piece;

typedef struct {
    const LSystemDef *def;
    double unit;            /* segments in a leaf length */
    Polygon *margin;        /* segments; NULL: none */
    double *length, *width; /* [iterations + 1] of a step, segments, by the iteration that wrote it */
    GArray *node;           /* Vec2 */
    GArray *birth;          /* uint32_t, of nodes */
    GArray *piece;          /* Piece */
    GArray *spot;           /* Spot */
    uint32_t n_veins, n_margin;
    Lobes lobes;  /* leaf lengths; looked for when a symbol asks for them */
    bool looked, overflow;
    LAxis axis; /* of the blade; curved: what is drawn in the middle lobe turns with it */
} Drawing;

/* --- lturtle.c --- */

/* A straight piece from where the turtle is, if it has a length. */
void lturtle_draw(Drawing *d, Turtle *t, Vec2 to, uint16_t born, uint32_t depth);

/* `length` straight on in n pieces: veins turn towards the lobe's tip a little before each of them, and with the blade's middle line. */
void lturtle_go(Drawing *d, Turtle *t, double length, uint32_t n, uint16_t born, uint32_t depth, bool draws);

static inline uint32_t lturtle_pieces(double length) { return length > 1.0 ? (uint32_t)ceil(MIN(length, 4e9) - 1e-9) : 1; }

/* --- lturtle_blade.c --- */

/* The direction of `degrees` where the turtle is, a unit vector; in a curved blade turned as the middle line is at that height, half of `ahead`
 * farther on. */
Vec2 lturtle_direction(const Drawing *d, const Turtle *t, double degrees, double ahead);

/* Where a straight piece from the turtle to `to` ends: there, or just inside the margin, and then the turtle is stopped. FALSE when it has
 * no length. */
bool lturtle_clip(const Drawing *d, Turtle *t, Vec2 *to);

/* Whether a point lies in the turtle's lobe, off the lines that part it from its neighbours, and on its side of the lobe's vein if it keeps to
 * one. */
bool lturtle_in_field(const Drawing *d, const Turtle *t, Vec2 at);

/* How much a wary vein turns from its heading towards the lobe's axis, degrees: where there is no room ahead, half way between the axis
 * and the nearest direction that has some; then back by and by. `length`: of the piece that it is about to draw. */
double lturtle_swerve(const Drawing *d, Turtle *t, double length);

/* ^ < > ~ $ in a blade. */
void lturtle_obey_blade(Drawing *d, Turtle *t, char symbol, uint16_t born, uint32_t depth);

#endif
