/* Inside the mesher: GTS's vertices, edges and triangles with what we need to know of them, and the steps of mesh_new.
 *
 * GTS gives the objects, their links and its exact predicates (Shewchuk's). Its Delaunay functions are not used: they take assertions for
 * answers (adding a constraint whose end lies on the line of another edge, refining where a circumcentre leaves the blade), and insertion
 * calls itself once for each face that it replaces, looking through all edges of the new vertex each time. */
#ifndef GEOM_MESH_GTS_H
#define GEOM_MESH_GTS_H

#include <gts.h>

#include "geom/mesh.h"

enum { MESH_NONE = UINT32_MAX, MESH_BUCKETS = 64, MESH_ROUNDS = 32 };

/* Use of the bits of GtsObject.flags that GTS leaves: a mark for searches, the bucket of the queue, visits while freeing. */
enum { MESH_MARK = 1 << GTS_USER_FLAG, MESH_BUCKET_SHIFT = 8, MESH_VISITS_SHIFT = 16 };

typedef struct {
    GtsVertex gts;
    uint32_t index; /* in Mesher.vertex: the input points, then the others as they came; MESH_NONE for the corners of the hull */
    uint32_t input; /* the input segment that it splits; MESH_NONE for input points and those within the blade */
    double size;    /* no more than the distances between features of the input near by; set by mesh_conform */
} MeshVertex;

/* A piece of an input segment. Of a class derived from GtsConstraint, whose struct GTS keeps to itself (it is a GtsEdge; checked when the
 * class is made). Splitting clones it, so `input` is handed down. */
typedef struct {
    GtsEdge gts;
    uint32_t input; /* segment: those of the outline, then the veins */
    bool waiting;   /* to be split */
} MeshPiece;

/* Faces of one urgency. */
typedef struct {
    GtsTriangle **face;
    uint32_t end, cap, live; /* those in use, gaps included, and without */
} MeshBucket;

typedef struct {
    const Pslg *graph;
    const MeshDef *def;
    uint32_t limit;      /* more faces than this are too many */
    double sine2;        /* square of the sine of the least angle */
    double side;         /* of a square of the greatest area; HUGE_VAL without one */
    double tiny2;        /* square of a length not worth splitting, for rounding */
    GtsObjectClass *vertex_class, *piece_class;
    GPtrArray *vertex;   /* MeshVertex */
    GtsVertex *hull[3];  /* of the triangle round all, while it is there */
    MeshPiece **piece;   /* [n_pieces] the input segments whole; of use until the first is split */
    uint32_t n_pieces, n_faces;
    uint32_t coin;       /* state of the coin that mesh_walk tosses */
    GPtrArray *cavity, *dead, *touched; /* faces, edges, vertices: room for mesh_find_cavity and mesh_remove_faces */
    /* refining */
    bool *acute;           /* [n_points] whether two input segments meet there at less than a right angle */
    GPtrArray *encroached; /* MeshPiece, first come first served from `served` on */
    uint32_t served;
    bool refining;         /* new faces are queued */
    MeshBucket bucket[MESH_BUCKETS];
    uint32_t top;          /* no bucket above it holds a face */
} Mesher;

static inline Vec2 mesh_place(const void *vertex)
{
    const GtsPoint *p = vertex;
    return vec2(p->x, p->y);
}

static inline bool mesh_is_piece(const Mesher *m, const GtsEdge *e) { return e->segment.object.klass == m->piece_class; }

/* Corners of a face, counter-clockwise, and its edges: edge[k] runs from corner[k] to the next. */
static inline void mesh_corners(const GtsTriangle *f, GtsVertex *corner[3], GtsEdge *edge[3])
{
    edge[0] = f->e1;
    edge[1] = f->e2;
    edge[2] = f->e3;
    const GtsSegment *s = &edge[0]->segment, *t = &edge[1]->segment;
    bool forwards = s->v2 == t->v1 || s->v2 == t->v2;
    corner[0] = forwards ? s->v1 : s->v2;
    corner[1] = forwards ? s->v2 : s->v1;
    corner[2] = t->v1 == corner[1] ? t->v2 : t->v1;
}

static inline GtsVertex *mesh_opposite(const GtsTriangle *f, const GtsEdge *e)
{
    const GtsSegment *s = &(f->e1 == e ? f->e2 : f->e1)->segment;
    return s->v1 == e->segment.v1 || s->v1 == e->segment.v2 ? s->v2 : s->v1;
}

/* The face on the other side of an edge; NULL on the margin. */
static inline GtsTriangle *mesh_neighbour(const GtsTriangle *f, const GtsEdge *e)
{
    for (GSList *t = e->triangles; t; t = t->next)
        if (t->data != f)
            return t->data;
    return NULL;
}

static inline GtsVertex *mesh_other_end(const GtsSegment *s, const GtsVertex *v) { return s->v1 == v ? s->v2 : s->v1; }

/* Frees an object and nothing that hangs on it. */
static inline void mesh_destroy(gpointer object) { gts_object_class()->destroy(object); }

/* Of the two ends of an input segment, the k-th. */
static inline uint32_t mesh_input_end(const Pslg *g, uint32_t input, int k)
{
    if (input >= g->n_outline)
        return g->segment[input - g->n_outline][k];
    return k == 0 ? input : input + 1 < g->n_outline ? input + 1 : 0;
}

/* mesh_triangulate.c: the constrained Delaunay triangulation of the blade. FALSE when a segment can't be put in, which pslg_check is there
 * to prevent. */
bool mesh_triangulate(Mesher *m);

/* Steps of it that refinement takes too. */
MeshVertex *mesh_vertex_new(Mesher *m, Vec2 p, uint32_t input);
/* Walks from a face to the one that holds p. With `wall` the walk stops at pieces: NULL then, and *wall the piece in its way. */
GtsTriangle *mesh_walk(Mesher *m, GtsTriangle *from, GtsVertex *p, MeshPiece **wall);
/* Lists in m->cavity the faces that p, in face `at` or on a piece that it splits, would replace; the other is NULL. */
void mesh_find_cavity(Mesher *m, GtsTriangle *at, const MeshPiece *on, GtsVertex *p);
/* Puts v into the cavity found for it; the piece that it splits goes. */
void mesh_fill_cavity(Mesher *m, GtsVertex *v, const MeshPiece *on);
void mesh_add_face(Mesher *m, GtsEdge *e1, GtsEdge *e2, GtsEdge *e3);
/* Removes faces and the edges that are left without any. */
void mesh_remove_faces(Mesher *m, const GPtrArray *face);

/* mesh_refine.c: splits pieces until no vertex lies within the circle over one, then adds circumcentres (Ruppert 1995). FALSE when
 * there would be too many triangles. */
bool mesh_conform(Mesher *m);
bool mesh_refine(Mesher *m);
/* How much a face wants to be refined: 0 not at all. */
uint32_t mesh_urgency(const Mesher *m, const GtsTriangle *f);

/* mesh_queue.c: faces that want to be refined, the worst first; of about equals the one that came last. */
void mesh_queue_add(Mesher *m, GtsTriangle *f);
void mesh_queue_remove(Mesher *m, GtsTriangle *f);
GtsTriangle *mesh_queue_take(Mesher *m);
void mesh_queue_clear(Mesher *m);

/* mesh_arrays.c: what goes in, and the result.
 *
 * Points go in in rounds of doubling size, each sorted along Hilbert's curve (biased randomised insertion order; Amenta, Choi and Rote
 * 2003): random enough to keep faces few at any vertex, orderly enough to find each face by a short walk. */
typedef struct {
    uint32_t n_rounds, *point, *segment; /* point[point_start[r]] … are those of round r; segments follow the points of a round */
    uint32_t point_start[MESH_ROUNDS + 1], segment_start[MESH_ROUNDS + 1];
} MeshOrder;
void mesh_order_init(MeshOrder *o, const Pslg *g);
void mesh_order_clear(MeshOrder *o);

typedef struct {
    uint32_t input, edge[2];
    double along2; /* squared distance of its start from the input segment's */
} MeshPart; /* a piece */
/* Copies vertices and triangles out of GTS as they came, and the pieces into an array of MeshPart. */
Mesh *mesh_copy(const Mesher *m, GArray *pieces);
void mesh_free_gts(Mesher *m);
/* Puts all in order, so that it owes nothing to GTS's. */
void mesh_arrange(Mesh *mesh, const Pslg *g, GArray *pieces);

#endif
