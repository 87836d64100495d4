/* Inside the mesher: GTS's objects with what we need to know of them, and the steps of mesh_new. All of it under the lock of mesh.c. */
#ifndef GEOM_MESH_GTS_H
#define GEOM_MESH_GTS_H

#include <gts.h>

#include "geom/mesh.h"

enum { MESH_NONE = UINT32_MAX, MESH_BUCKETS = 64 };
/* Use of the bits of GtsObject.flags that GTS leaves: seen in a search, bucket of the queue, visits while freeing. */
enum { MESH_SEEN_SHIFT = GTS_USER_FLAG, MESH_BUCKET_SHIFT = 8, MESH_VISITS_SHIFT = 16 };

typedef struct {
    GtsVertex gts;
    uint32_t index; /* in Mesher.vertex: the input points, then the others as they came; MESH_NONE for the corners of the hull */
    uint32_t input; /* the input segment that it splits; MESH_NONE for input points and those within the blade */
    double size;    /* no more than the distances between features of the input near by; set by mesh_conform */
} MeshVertex;

/* A piece of an input segment. Of a class derived from GtsConstraint, whose struct GTS keeps to itself (it is a GtsEdge, see
 * mesh_classes). Splitting clones it, so `input` is handed down. */
typedef struct {
    GtsEdge gts;
    uint32_t input; /* segment: those of the outline, then the veins */
    bool waiting;   /* to be split */
} MeshPiece;

/* Faces of one urgency. */
typedef struct {
    GtsFace **face;
    uint32_t end, cap, live; /* those in use, gaps included, and without */
} MeshBucket;

typedef struct {
    const Pslg *graph;
    const MeshDef *def;
    GtsSurface *surface;
    GtsObjectClass *vertex_class, *piece_class;
    GPtrArray *vertex;     /* MeshVertex */
    GtsVertex *hull[3];    /* of the triangle round all, while it is there */
    MeshPiece **piece;     /* [n_outline + n_segments], whole; of use until the first is split */
    uint32_t n_pieces, n_faces;
    uint32_t limit;        /* more faces than this are too many */
    uint32_t coin;         /* state of the coin that mesh_walk tosses */
    GPtrArray *encroached; /* MeshPiece, first come first served from `served` on */
    uint32_t served;
    GPtrArray *cavity;     /* GtsFace, for check_cavity */
    bool refining;         /* new faces are queued */
    bool *acute;           /* [n_points] whether two input segments meet there at less than a right angle */
    MeshBucket bucket[MESH_BUCKETS];
    uint32_t top; /* no bucket above it holds a face */
    double sine2;          /* square of the sine of the least angle */
    double side;           /* of a square of the greatest area; HUGE_VAL without one */
    double tiny2;          /* square of a length not worth splitting, for rounding */
} Mesher;

static inline Vec2 mesh_place(const void *vertex)
{
    const GtsPoint *p = vertex;
    return vec2(p->x, p->y);
}

static inline bool mesh_is_piece(const Mesher *m, const GtsEdge *e) { return e->segment.object.klass == m->piece_class; }

/* Corners of a face in order, and its edges: edge[k] runs from corner[k] to the next. */
static inline void mesh_corners(const GtsFace *f, GtsVertex *corner[3], GtsEdge *edge[3])
{
    edge[0] = f->triangle.e1;
    edge[1] = f->triangle.e2;
    edge[2] = f->triangle.e3;
    const GtsSegment *s = &edge[0]->segment, *t = &edge[1]->segment;
    bool forwards = s->v2 == t->v1 || s->v2 == t->v2;
    corner[0] = forwards ? s->v1 : s->v2;
    corner[1] = forwards ? s->v2 : s->v1;
    corner[2] = t->v1 == corner[1] ? t->v2 : t->v1;
}

static inline GtsVertex *mesh_opposite(const GtsFace *f, const GtsEdge *e)
{
    const GtsSegment *s = &(f->triangle.e1 == e ? f->triangle.e2 : f->triangle.e1)->segment;
    return s->v1 == e->segment.v1 || s->v1 == e->segment.v2 ? s->v2 : s->v1;
}

/* Frees an object and nothing that hangs on it. */
static inline void mesh_destroy(gpointer object) { gts_object_class()->destroy(object); }

/* The face on the other side of an edge; NULL on the margin. */
static inline GtsFace *mesh_neighbour(const GtsFace *f, const GtsEdge *e)
{
    for (GSList *t = e->triangles; t; t = t->next)
        if (t->data != f)
            return t->data;
    return NULL;
}

/* Of the two ends of an input segment, the k-th. */
static inline uint32_t mesh_input_end(const Pslg *g, uint32_t input, int k)
{
    if (input >= g->n_outline)
        return g->segment[input - g->n_outline][k];
    return k == 0 ? input : input + 1 < g->n_outline ? input + 1 : 0;
}

/* mesh_triangulate.c: the constrained Delaunay triangulation of the blade. FALSE when GTS can't hold all segments, which pslg_check is there to
 * prevent. */
bool mesh_triangulate(Mesher *m);
MeshVertex *mesh_vertex_new(Mesher *m, Vec2 p, uint32_t input);
/* Walks from a face to the one that holds p. With `wall` the walk stops at pieces: NULL then, and *wall the piece in its way. */
GtsFace *mesh_walk(Mesher *m, GtsFace *from, GtsVertex *p, MeshPiece **wall);

/* mesh_queue.c: faces that want to be refined, the worst first; of about equals the one that came last. */
void mesh_queue_add(Mesher *m, GtsFace *f);
void mesh_queue_remove(Mesher *m, GtsFace *f);
GtsFace *mesh_queue_take(Mesher *m);
void mesh_queue_clear(Mesher *m);

/* mesh_refine.c: splits pieces until no vertex lies within the circle over one, then adds circumcentres (Ruppert 1995). FALSE when
 * there would be too many triangles. */
bool mesh_conform(Mesher *m);
bool mesh_refine(Mesher *m);
/* How much a face wants to be refined: 0 not at all. */
uint32_t mesh_urgency(const Mesher *m, const GtsFace *f);

/* mesh_arrays.c: the result. */
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
