/* The steps from a region to its centre lines: thinned pixels, then a graph of them, then veins. */
#ifndef SCAN_CENTRE_PRIVATE_H
#define SCAN_CENTRE_PRIVATE_H

#include "geom/vec.h"
#include "scan/centre.h"

#define CENTRE_NONE UINT32_MAX

enum {
    THIN_IN = 1,   /* of the region */
    THIN_LINE = 2, /* of its lines */
};

/* A region thinned, in its box. Positions are those of pixel centres, from the first pixel of the box, y down. */
typedef struct {
    MaskBox box;
    uint32_t stride;  /* of px: the box's width and two */
    uint8_t *px;      /* of the box, with a rim of background around it */
    uint32_t n;       /* pixels of lines */
    uint32_t *at;     /* [n] where in px, ascending */
    double *radius;   /* [n] from a pixel's centre to the region's border */
} Thinned;

/* The region without its holes of fewer pixels than `hole`. False when it is empty. Holds a byte a pixel of the
 * box and eight a pixel of the region. */
bool thinned_init(Thinned *t, const Mask *m, uint8_t bit, double hole);
void thinned_clear(Thinned *t);

static inline Vec2 thinned_place(const Thinned *t, uint32_t at) { return vec2((double)(at % t->stride) - 1.0, (double)(at / t->stride) - 1.0); }

/* Whether a point lies in a pixel of the region. */
static inline bool thinned_has(const Thinned *t, Vec2 p)
{
    double x = floor(p.x + 1.5), y = floor(p.y + 1.5);
    if (!(x >= 0.0 && y >= 0.0 && x < (double)t->stride && y < (double)(t->box.y1 - t->box.y0 + 3)))
        return false;
    return t->px[(size_t)y * t->stride + (size_t)x] & THIN_IN;
}

typedef struct {
    Vec2 p;
    double r; /* to the border */
} CentrePoint;

/* An end, a cluster of pixels that lines meet in, or, on a ring, its first pixel. */
typedef struct {
    Vec2 p;
    double r;        /* the greatest of its pixels */
    uint32_t degree; /* edges' ends there; both of a loop count. 0: pruned */
} CentreNode;

typedef struct {
    uint32_t node[2];
    uint32_t first, n; /* its points, without those of the nodes: maybe none */
    double length;     /* from node to node */
    bool gone;
} CentreEdge;

typedef struct {
    GArray *node, *edge, *point; /* CentreNode, CentreEdge, CentrePoint */
} CentreGraph;

void centre_graph_init(CentreGraph *g, const Thinned *t);
void centre_graph_clear(CentreGraph *g);

/* Takes away spurs, makes one of junctions that lie within one another's discs, and takes away specks. */
void centre_graph_prune(CentreGraph *g, const CentreDef *def);

static inline CentreNode *centre_node(const CentreGraph *g, uint32_t i) { return &g_array_index(g->node, CentreNode, i); }
static inline CentreEdge *centre_edge(const CentreGraph *g, uint32_t i) { return &g_array_index(g->edge, CentreEdge, i); }
static inline CentrePoint *centre_point(const CentreGraph *g, uint32_t i) { return &g_array_index(g->point, CentrePoint, i); }

/* An edge seen from one of its ends is 2 · edge + end. */
static inline uint32_t centre_half_node(const CentreGraph *g, uint32_t half) { return centre_edge(g, half / 2)->node[half & 1]; }

/* Point k of an edge counted from that end. */
static inline const CentrePoint *centre_half_point(const CentreGraph *g, uint32_t half, uint32_t k)
{
    const CentreEdge *e = centre_edge(g, half / 2);
    return centre_point(g, e->first + (half & 1 ? e->n - 1 - k : k));
}

/* The half that each half goes on in beyond its node, or CENTRE_NONE: at a junction the two that go on straightest are joined, then of the others,
 * and so on; at what is none any two. To be freed. */
uint32_t *centre_join(const CentreGraph *g);

#endif
