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

/* Reads GraphML (graphml.graphdrawing.org). Lengths are in segments, the leaf base at 0,0, y towards the tip. Attributes are found by
 * attr.name, whatever their ids and order; defaults of keys count; others are passed over:
 *   nodes  x, y; birth
 *   edges  kind (vein, anastomosis), order, rank, vein, width, flow, birth
 *   graph  margin ("x,y x,y …", at least 3 points, either way round, not crossing itself), steps
 * Only x and y are needed; what else is missing, on one node or edge or on all, is made:
 *   kind   Where a kind is missing, or edges have no direction, the network is opened from the leaf base, and edges may be drawn either
 *          way round. Each connected part (anastomoses do not connect) begins at its node nearest to 0,0 (of several the first in
 *          the file) and is searched from there: along edges of kind vein first, then by the widest edge if all have widths, else
 *          by the shortest way from the beginning; ties go to the first in the file. Edges of the search are veins, the others
 *          anastomoses. Where all kinds are given on directed edges, edges lead away from the base as they stand.
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
 * Errors in G_FILE_ERROR (the file can't be read) or IMPORT_ERROR name file, line, what was found and what may be. The file is
 * streamed: memory goes with the network, about 50 bytes a node or edge, 70 where names are words and the network must be opened. O(n), or
 * O(n log n) where it must. */
Network *import_graphml(const char *path, const WidthDef *widths, GError **error);

/* The same of a text in memory; `name` stands for the file in messages. */
Network *import_graphml_text(const char *text, gsize length, const char *name, const WidthDef *widths, GError **error);

#endif
