/* A network as a file gives it, perhaps only in part, and its completion. Private to src/import. */
#ifndef IMPORT_DRAFT_H
#define IMPORT_DRAFT_H

#include "import/field.h"
#include "import/import.h"
#include "import/names.h"

/* Network.kind while the file does not say. */
enum { KIND_UNKNOWN = 255 };

typedef struct {
    const char *file; /* as messages call it; borrowed */
    Names names;
    /* In the file's order. Until draft_finish its edges join the numbers of names, not of nodes, and n_nodes and n_edges count up. */
    Network *net;
    uint32_t node_room, edge_room;
    uint32_t *name;      /* [n_nodes] number of the node's name */
    uint32_t *node_line; /* [n_nodes] */
    uint32_t *edge_line; /* [n_edges] */
    uint32_t given[FIELD_COUNT]; /* how many nodes, edges or graphs say it */
    bool undirected;     /* some edge has no direction */
    Vec2 base, tip;      /* as the file says, else as they are found */
} Draft;

void draft_init(Draft *d, const char *file);
void draft_clear(Draft *d);

/* What the file says of one node or edge. */
typedef struct {
    uint32_t line;
    uint32_t name;           /* of a node */
    uint32_t source, target; /* names of an edge's ends */
    bool directed;
    unsigned given;          /* FIELD_BIT of what it says */
    double value[FIELD_COUNT];
} Item;

/* FALSE, with an error, for a node that was there before, or an edge from a node to itself, or when there are too many. */
gboolean draft_add_node(Draft *d, const Item *item, GError **error);
gboolean draft_add_edge(Draft *d, const Item *item, GError **error);

/* Checks the whole, and makes what is missing. The network is the caller's; the draft is spent and must be cleared. */
Network *draft_finish(Draft *d, const WidthDef *widths, GError **error);

/* "FILE:LINE: …", or without the line when it is 0. Always FALSE. */
gboolean draft_fail(const Draft *d, uint32_t line, ImportErrorCode code, GError **error, const char *format, ...) G_GNUC_PRINTF(5, 6);

/* "node 'a'", "edge 'a' – 'b'". Free it. */
char *draft_node_text(const Draft *d, uint32_t node);
char *draft_edge_text(const Draft *d, uint32_t edge);

/* Edges of kind vein, one of them `edge`, that run in a circle through the nodes of `ring` (uint32_t), which it frees. Always FALSE. */
gboolean draft_fail_ring(const Draft *d, uint32_t edge, GArray *ring, GError **error);

/* The parts of draft_finish. By then edges join nodes. */

/* place.c: where the leaf base is, before edges are turned away from it. */
void draft_find_base(Draft *d);

/* orient.c: do edges lead away from the base as they stand? Else the network is opened. */
bool draft_as_given(const Draft *d);

/* orient.c: kinds and directions of edges; sorts nodes and edges where a vein leads to an earlier node. */
gboolean draft_orient(Draft *d, GError **error);

/* search.c: kinds and directions by a search from the leaf base (import.h). entry[n_nodes] receives the vein edge that leads to each node,
 * NONE for a first node; depth[n_nodes] how many lead there. */
gboolean draft_search(Draft *d, uint32_t *entry, uint32_t *depth, GError **error);

/* complete.c: births, widths, orders, ranks, veins. */
gboolean draft_complete(Draft *d, const WidthDef *widths, GError **error);

/* place.c: finds the tip, moves the base to 0,0, turns the tip up; refuses veins outside the margin. */
gboolean draft_place(Draft *d, GError **error);

#endif
