/* One reader a format: a venation network read back, as `venation grow` wrote it or as a person drew it. */
#ifndef IMPORT_IMPORT_H
#define IMPORT_IMPORT_H

#include <glib.h>

#include "sim/network.h"
#include "sim/width.h"

#define IMPORT_ERROR import_error_quark()
GQuark import_error_quark(void);
typedef enum {
    IMPORT_ERROR_SYNTAX, /* not the format, or a value that is not what it must be */
    IMPORT_ERROR_GRAPH,  /* well-formed, but not a venation: an edge that leads nowhere, a vein that runs in a circle, … */
} ImportErrorCode;

/* Reads GraphML (graphml.graphdrawing.org). Lengths are in segments. What is returned has the leaf base at 0,0 and the tip at 0,length,
 * wherever the file has them: it is moved and turned, not scaled or mirrored (a drawing whose y points down becomes a mirrored leaf).
 * Attributes are found by attr.name, whatever their ids and order; defaults of keys count; others are passed over:
 *   nodes  x, y; birth
 *   edges  kind (vein, anastomosis), order, rank, vein, width, flow, birth
 *   graph  margin ("x,y x,y …", at least 3 points, either way round, not crossing itself), holes (such points, with ';' between holes), base, tip
 *          ("x,y"), steps
 * Only x and y are needed; what else is missing, on one node or edge or on all, is made:
 *   base   With a margin, a node: where edges are directed and have kinds one that no vein leads to, else any, and of these
 *          first by an end of the widest edge, if all have widths and not all the same; in the largest connected part (anastomoses do
 *          not connect); at the margin, if there are such widths; nearest to the margin's first point; first in the file.
 *          Without a margin 0,0.
 *   tip    With a margin: where the line from the base through the end of the midvein (on from the base in the widest edge, of several
 *          in the straightest) leaves the blade, or, if that is farther off, the farthest vertex of the margin within 10° of it; if no
 *          vein begins at the base, the farthest vertex of all. Without a margin there is none: the network is not turned, and
 *          Network.length is 0.
 *   kind   Where a kind is missing, or edges have no direction, the network is opened from the leaf base, and edges may be drawn either
 *          way round. Each connected part begins at its node nearest to the base (of several the first in the file) and is searched
 *          from there: along edges of kind vein first, then by the widest edge if all have widths, else by the shortest way from
 *          the beginning; ties go to the first in the file. Edges of the search are veins, the others anastomoses.
 *          Where all kinds are given on directed edges, edges lead away from the base as they stand.
 *   birth  Nodes' births are taken if all have one and no vein leads to an older node, else they are the nodes' depths, in edges. An
 *          edge without birth is born with the younger of its ends. Without steps the last birth ends the run.
 *   width  by network_assign_widths(net, widths), with flow.
 *   flow   from the widths, if they are given: (width / minimum)^exponent.
 *   order  by network_assign_widths, with vein and rank.
 *   vein   Where orders are given, a vein continues in the widest edge of its own order (ties: the first in the file).
 *   rank   by network_assign_widths.
 * Nodes and edges stay as they are in the file if every vein leads from an earlier node to a later one (a file of ours reads back as it
 * was, and writes the same bytes again); else nodes are sorted by depth, veins by their heads, anastomoses come last. Vein
 * numbers with gaps are closed up. Without a margin Network.margin is NULL: whoever needs one must ask for it.
 *
 * Refused is, besides what is no venation, a leaf shorter than 1e-3 segments, and a node that lies farther outside the margin than 2 % of the
 * leaf's length (or, in small leaves, 10 % up to a segment). Parts that are not connected are allowed. A single node
 * with a margin and no edges is a leaf without veins.
 *
 * Errors in G_FILE_ERROR (the file can't be read) or IMPORT_ERROR name file, line, what was found and what may be. The file is
 * streamed: memory goes with the network, about 50 bytes a node or edge, 70 where names are words and the network must be opened. O(n), or
 * O(n log n) where it must. */
Network *import_graphml(const char *path, const WidthDef *widths, GError **error);

/* The same of a text in memory; `name` stands for the file in messages. */
Network *import_graphml_text(const char *text, gsize length, const char *name, const WidthDef *widths, GError **error);

/* The last of these checks, for a margin that came from elsewhere: net->margin and net->length must be set. */
gboolean import_check_inside(const Network *net, const char *name, GError **error);

#endif
