/* One writer a format. Each writes beside its target and renames; each returns FALSE and sets a GError in G_FILE_ERROR on failure;
 * each gives equal bytes for equal input (numbers in a fixed format, no time, no path). */
#ifndef EXPORT_EXPORT_H
#define EXPORT_EXPORT_H

#include <glib.h>

#include "image/paint.h"
#include "sim/network.h"

/* SVG of blade and veins: one group an order (id order-1 …), each vein a path where width allows (in crowded orders veinlets
 * of one width share paths), cut off at the margin, round caps and joins, true
 * widths; user unit = segment, y down. `frame` gives the view box, so that frames of one run share a scale. */
gboolean export_svg(const Network *net, const Frame *frame, const PaintStyle *style, const char *title, const char *path, GError **error);

/* GraphML that igraph and NetworkX read as it is: node x, y, birth; edge kind, order, rank, width, flow, birth, vein, length;
 * graph margin ("x,y x,y …", counter-clockwise; only if there is one), holes (such points, clockwise, with ";" between holes; only if there are any), base and tip ("x,y"; only if the length is known) and steps. Nodes are numbered as in the tables. Lengths are rounded to
 * millionths of a segment, here and there. import/import.h reads it back: what was read writes the same bytes again. */
gboolean export_graphml(const Network *net, const char *path, GError **error);

/* CSV tables of nodes and edges. */
gboolean export_nodes_csv(const Network *net, const char *path, GError **error);
gboolean export_edges_csv(const Network *net, const char *path, GError **error);

/* Writes `text` to `path` atomically; the base of all of the above. */
gboolean export_text(const char *text, gsize length, const char *path, GError **error);

/* Buffered text for the writers: numbers formatted alike in every locale. %.17g is cut to the shortest form that reads back. */
void export_number(GString *s, double value);

/* JSON string with quotes and escapes. */
void export_json_string(GString *s, const char *text);

#endif
