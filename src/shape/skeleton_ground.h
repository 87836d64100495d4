/* Where veins are laid: the outline and the veins that lie already, and the rules by which the next one must keep clear of them. */
#ifndef SHAPE_SKELETON_GROUND_H
#define SHAPE_SKELETON_GROUND_H

#include "geom/polygon.h"
#include "shape/skeleton_field.h"

#define NONE UINT32_MAX
#define MARGIN (UINT32_MAX - 1) /* owner of the outline's edges */

/* The lengths that veins are cleared by, segments. */
typedef struct {
    double clear; /* between veins, and between veins and the margin */
    double least; /* between any two things */
    double slope; /* sine of the least angle: how fast what parts at a node must part */
} Limits;

/* An end that is tied to what lies already: to a node, or to a place on an edge, which is cut there, or to nothing. */
typedef struct {
    Vec2 at;
    uint32_t node, edge; /* NONE, NONE: free */
} Anchor;

typedef enum { HIT_NOTHING = 0, HIT_MARGIN = 1, HIT_VEIN = 2 } Hit;

typedef struct {
    Field field;
    Limits limits;
    const Polygon *outline; /* borrowed */
    /* the vein that is being laid */
    uint32_t owner;
    Anchor start;
    GArray *node;     /* uint32_t: its nodes so far */
    GArray *way;      /* double, of each: way from the first along the vein, segments */
    uint32_t n_nodes, n_edges; /* of the field when it was begun */
} Ground;

/* The outline alone: its vertices become nodes 0 … n - 1. */
void ground_init(Ground *g, const Polygon *outline, Limits limits);
void ground_clear(Ground *g);

static inline Vec2 ground_at(const Ground *g, uint32_t node) { return field_at(&g->field, node); }
static inline bool ground_on_margin(const Ground *g, uint32_t node) { return g_array_index(g->field.node, FieldNode, node).margin; }

/* Begins a vein; what was not committed is taken back. The owner must own nothing yet. */
void ground_begin(Ground *g, uint32_t owner, Anchor start);

/* What an edge from the vein's last node to v would come too near to, veins before the margin. tip: v is the end and tied to the margin there; else
 * NULL. Near to the start and to a tied tip things may be nearer than `clear`: by the slope, down to `least`. */
Hit ground_clash(Ground *g, Vec2 v, const Anchor *tip);

/* Whether nothing but the vein that is being laid lies nearer to p than `reach`. */
bool ground_free(Ground *g, Vec2 p, double reach);

/* Lays the edge; no checks. */
void ground_lay(Ground *g, Vec2 v, const Anchor *tip);

/* Takes the last edge back. */
void ground_take_back(Ground *g);

static inline double ground_length(const Ground *g) { return g_array_index(g->way, double, g->way->len - 1); }
static inline Vec2 ground_end(const Ground *g) { return ground_at(g, g_array_index(g->node, uint32_t, g->node->len - 1)); }

/* Makes the vein stay, and cuts the edges that it is tied to. */
void ground_commit(Ground *g, const Anchor *tip);

#endif
