/* Edges in the plane by place: what a vein that is to be laid must keep clear of. */
#ifndef SHAPE_SKELETON_FIELD_H
#define SHAPE_SKELETON_FIELD_H

#include <glib.h>

#include "geom/vec.h"

typedef struct {
    Vec2 at;
    bool margin;    /* on the outline */
} FieldNode;

typedef struct {
    uint32_t a, b;  /* nodes */
    uint32_t owner; /* the caller's: which sequence, or the margin */
} FieldEdge;

typedef struct {
    GArray *node, *edge;  /* FieldNode, FieldEdge */
    /* private: a grid over the box, a chain of entries a cell */
    Vec2 corner;
    double scale;         /* cells per segment */
    uint32_t nx, ny;
    uint32_t *head;       /* [nx · ny] */
    GArray *entry, *seen; /* Entry; uint32_t a edge: the query that met it last */
    GArray *found;        /* uint32_t, of the last query */
    uint32_t query;
} Field;

/* Edges outside the box are kept in its border cells. */
void field_init(Field *f, Box2 box);
void field_clear(Field *f);

static inline Vec2 field_at(const Field *f, uint32_t node) { return g_array_index(f->node, FieldNode, node).at; }
static inline FieldEdge field_edge(const Field *f, uint32_t edge) { return g_array_index(f->edge, FieldEdge, edge); }

uint32_t field_add_node(Field *f, Vec2 p, bool margin);
uint32_t field_add_edge(Field *f, uint32_t a, uint32_t b, uint32_t owner);

/* Cuts an edge at a node that lies on it: the edge keeps its first part; returns the second one. */
uint32_t field_split(Field *f, uint32_t edge, uint32_t node);

/* Takes back nodes and edges added last, down to so many; no edge may have been split since. */
void field_undo(Field *f, uint32_t n_nodes, uint32_t n_edges);

/* Edges that may come nearer than `reach` to the segment uv, and some more; valid until the next call. Each once. */
const uint32_t *field_near(Field *f, Vec2 u, Vec2 v, double reach, uint32_t *n);

/* Whether two segments cross, ends excepted. */
bool field_cross(Vec2 a, Vec2 b, Vec2 c, Vec2 d);

#endif
