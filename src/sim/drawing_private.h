/* From drawn lines to a network, step by step (drawing.h). Private to src/sim/drawing*.c. Lengths in segments. */
#ifndef SIM_DRAWING_PRIVATE_H
#define SIM_DRAWING_PRIVATE_H

#include "geom/boxtree.h"
#include "sim/drawing.h"

enum { NONE = UINT32_MAX };

/* Nodes of one vein are no nearer to one another, along it, than this: what meets it there meets at one node. */
static const double drawing_least = 0.1;

typedef struct {
    Vec2 p;
    double width; /* 0 where unknown */
    double along; /* from the beginning of the drawn vein */
} Spot;

/* A drawn vein, or a part of one. Finer lines come later. */
typedef struct {
    uint32_t first, last; /* spots, at most a segment apart; first < last */
    uint32_t vein;        /* of the drawing */
    uint8_t order;        /* as drawn; 0: not said */
    double end[2];        /* what counts of it, in `along`; an end that must reach another line is extended … */
    double extra[2];      /* … by a straight piece of this length at the beginning, the end … */
    Vec2 to[2];           /* … to there */
    bool joined[2];       /* meets another line with its beginning, its end */
} Line;

/* A node on a line. */
typedef struct {
    uint32_t line, node;
    uint32_t other; /* line that meets it here */
    double along;
} Cut;

typedef struct {
    const Drawing *drawing;
    const DrawingDef *def;
    const Polygon *blade;
    double snap, gap;
    Spot *spot;
    uint32_t n_spots;
    uint32_t *line_of; /* [n_spots] line of the piece from this spot to the next; NONE: of none */
    GArray *line;      /* Line */
    GArray *cut;       /* Cut */
    GArray *node;      /* Vec2 */
    GArray *edge;      /* SketchEdge */
} Sketch;

/* Edges of one line follow one another in the array, b of one being a of the next, except where it is interrupted. */
typedef struct {
    uint32_t a, b, line;
    double width; /* 0 where unknown */
} SketchEdge;

#define LINE(s, k) (&g_array_index((s)->line, Line, k))
#define EDGE(s, k) (&g_array_index((s)->edge, SketchEdge, k))
#define NODE(s, k) (g_array_index((s)->node, Vec2, k))

/* "path 'midrib'", or "vein 3"; free it. */
char *drawing_vein_text(const Drawing *d, uint32_t vein);

/* drawing_take.c: the lines of the drawing inside the blade, by rank: order, width, length. */
bool sketch_take(Sketch *s, GError **error);

/* drawing_near.c: a place on a line or its extensions; the pieces of all lines, by their middles. */
Spot line_spot(const Sketch *s, const Line *line, double along);

typedef struct {
    Boxtree tree;
    Vec2 *middle; /* [n_spots] */
} PieceIndex;

typedef void (*PieceSeen)(void *user, uint32_t spot);
void pieces_init(PieceIndex *x, const Sketch *s);
void pieces_clear(PieceIndex *x);
/* Calls `see` for pieces that come nearer than r to some place in the box, and for some others. */
void pieces_visit(const PieceIndex *x, Box2 box, double r, PieceSeen see, void *user);

typedef struct {
    uint32_t line;
    double along;
    Vec2 p;
    double dist2;
} Hit;
/* The nearest place, no farther than r from p, on lines before `below` that are not `except`; false when there is none. */
bool pieces_nearest(const PieceIndex *x, const Sketch *s, Vec2 p, double r, uint32_t below, uint32_t except, Hit *hit);

/* drawing_absorb.c: what is drawn twice goes. */
void sketch_absorb(Sketch *s);

/* drawing_join.c: lines get their cuts. */
void sketch_join(Sketch *s);

/* drawing_edges.c: nodes and edges no longer than a segment. */
void sketch_divide(Sketch *s);

/* drawing_bridge.c: joins parts over gaps. part[n_nodes] receives a node of each node's part. */
void sketch_bridge(Sketch *s);
uint32_t *sketch_parts(const Sketch *s);
uint32_t part_of(uint32_t *part, uint32_t v);

/* drawing_open.c: the network, its veins leading away from the base, without widths. line[n_edges] receives each edge's line, width[n_edges] what
 * is drawn, 0 where nothing is. */
Network *sketch_open(const Sketch *s, uint32_t **line, double **width);

/* drawing_complete.c: orders, widths, veins, ranks and births. */
void sketch_complete(const Sketch *s, Network *net, const uint32_t *line, const double *width);

#endif
