/* libvenation: grows leaf veins and turns them into leaves.
 *
 *     GError *error = NULL;
 *     VenParams *params = ven_params_load("params/poplar.ini", &error);
 *     VenLeaf *leaf = ven_grow(params, 1, NULL, &error);
 *     ven_write(leaf, "out/poplar", "poplar", &error);
 *
 * Result = f(parameters, seed): any thread count, compiler and machine gives the same bytes. There is no global state; handles may be
 * used from any thread, each by one thread at a time. Lengths are in vein segments (one segment is 1); the leaf base is the origin
 * and the tip lies along +y. Functions that can fail return NULL or FALSE and set a GError.
 * When memory runs out GLib ends the process, as it does in every program that uses it: by g_error, which a log handler can see before. */
#ifndef VENATION_H
#define VENATION_H

#include <glib.h>
#include <stdint.h>

G_BEGIN_DECLS

#ifndef VEN_API
#define VEN_API __attribute__((visibility("default")))
#endif

typedef struct VenParams VenParams; /* values of every parameter */
typedef struct VenLeaf VenLeaf;     /* a grown leaf: network, outline, record */

VEN_API const char *ven_version(void);

/* All defaults. */
VEN_API VenParams *ven_params_new(void);

/* Reads a parameter file over the defaults; the error names file, line, key, the value found and the values allowed. */
VEN_API VenParams *ven_params_load(const char *path, GError **error);

/* Sets one parameter, as --set does: key "section.key", value as in a file. */
VEN_API gboolean ven_params_set(VenParams *params, const char *key, const char *value, GError **error);

/* The value of a parameter as text; free it with g_free. NULL for an unknown key. */
VEN_API char *ven_params_get(const VenParams *params, const char *key);

/* The whole set as the text of a parameter file; free it with g_free. */
VEN_API char *ven_params_text(const VenParams *params);
VEN_API void ven_params_free(VenParams *params);

/* Takes the scan of a real leaf (PNG, JPEG, TIFF) as the leaf: sets scan.file, and what else is not given to what suits a real outline. */
VEN_API gboolean ven_params_use_scan(VenParams *params, const char *image, GError **error);

/* How many leaves the scan of the parameters holds (scan.leaf counts them); 0 with an error. */
VEN_API uint32_t ven_scan_leaves(const VenParams *params, GError **error);

/* A scan that several leaves are taken from: read and searched once for all of them. NULL with an error. */
typedef struct VenScan VenScan;
VEN_API VenScan *ven_scan_open(const VenParams *params, GError **error);
VEN_API uint32_t ven_scan_count(const VenScan *sheet);
VEN_API void ven_scan_close(VenScan *sheet);

/* How many nodes the outline of that scan has by side of the marching square and tolerance of simplification (Hong 2005, tables 5.1 and 5.2),
 * with area and perimeter; with scan.method fang, how well each edge operator finds it: text for people; free it with g_free. NULL with an
 * error. */
VEN_API char *ven_scan_table(const VenParams *params, GError **error);

/* What a run reports while it goes on, and how it is told to stop. */
typedef struct {
    uint32_t step, nodes, sources;
    double length;       /* current leaf length, segments */
    double done;         /* rough part of the run that is done, 0 … 1 */
    gboolean rehearsal;  /* the first of two growings (see snapshot_every), which has no snapshots */
    const VenLeaf *leaf; /* the state at this step when `snapshot_every` divides it and at the end, else NULL; valid during the call */
} VenProgress;

typedef struct {
    unsigned threads;        /* 0: all processors */
    uint32_t snapshot_every; /* 0: never; else the leaf is grown twice, the first time to learn the scale that its frames share */
    gboolean (*progress)(const VenProgress *progress, gpointer user); /* called at every step when not NULL, with snapshots before the first too (step 0); FALSE stops the run, which then fails with G_IO_ERROR_CANCELLED */
    gpointer user;
} VenOptions;

/* Grows a leaf. NULL with an error for parameters that contradict each other, or a cancelled run. `options` may be NULL. */
VEN_API VenLeaf *ven_grow(const VenParams *params, uint64_t seed, const VenOptions *options, GError **error);
VEN_API void ven_leaf_free(VenLeaf *leaf);

/* The same for one leaf of a sheet: `params` are those that the sheet was read by, with another scan.leaf. */
VEN_API VenLeaf *ven_scan_grow(VenScan *sheet, const VenParams *params, uint64_t seed, const VenOptions *options, GError **error);

/* Writes what the parameters ask for (maps, SVG, network) and the run record into the folder `dir`, as `<name>_<map>.png` and so on. */
VEN_API gboolean ven_write(const VenLeaf *leaf, const char *dir, const char *name, GError **error);

/* Writes one picture of a leaf that may still be growing: <dir>/frames/<name>_<step>.svg, or with `maps` the maps the parameters ask
 * for. The step has six digits or more. */
VEN_API gboolean ven_write_frame(const VenLeaf *leaf, const char *dir, const char *name, gboolean maps, GError **error);

/* Of a leaf from a scan, what a person goes on with: <dir>/<name>_drawing.svg with the scan, the outline and the veins as layers, a copy of
 * the scan, upright and as a PNG where other programs might show it otherwise, and <name>.ini, a parameter file that refers to both. */
VEN_API gboolean ven_write_capture(const VenLeaf *leaf, const char *dir, const char *name, GError **error);

/* The same of one leaf of a sheet: all share the copy <sheet>_scan, which comes with leaf 1. */
VEN_API gboolean ven_write_capture_of(const VenLeaf *leaf, const char *dir, const char *name, const char *sheet, GError **error);

/* A leaf from a network that was grown before or drawn: a GraphML file with node positions in segments and the margin, wherever it lies; see
 * the README. `params` give widths where the file has none, the maps, and what is shaped. */
VEN_API VenLeaf *ven_leaf_load(const VenParams *params, const char *path, uint64_t seed, GError **error);

/* The run record as JSON; free it with g_free. */
VEN_API char *ven_leaf_record(const VenLeaf *leaf);

/* Why the run ended, in words, and how many sources were given up because no vein could reach them (`given_up` may be NULL). */
VEN_API const char *ven_leaf_end(const VenLeaf *leaf, uint64_t *given_up);

/* Of a leaf from a scan: the part of its outline that runs along the edge of the image, where the leaf is cut off; 0 … 1. */
VEN_API double ven_leaf_cut_off(const VenLeaf *leaf);

/* What else a person should know of such a leaf, a line each; "" when there is nothing. It belongs to the leaf. */
VEN_API const char *ven_leaf_note(const VenLeaf *leaf);

/* The network. Arrays belong to the leaf. */
VEN_API uint32_t ven_leaf_nodes(const VenLeaf *leaf);
VEN_API uint32_t ven_leaf_veins(const VenLeaf *leaf, uint32_t order); /* of order 1, 2 …; 0: of all */
VEN_API uint32_t ven_leaf_edges(const VenLeaf *leaf);
VEN_API void ven_leaf_node(const VenLeaf *leaf, uint32_t node, double *x, double *y, uint32_t *birth);

typedef struct {
    uint32_t tail, head; /* nodes, the tail nearer the base */
    uint32_t birth;      /* step */
    uint32_t vein;       /* vein it is part of */
    uint8_t order;       /* 1 primary, 2 secondary, … by hierarchy (Hong 2005) */
    uint8_t rank;        /* the same by width (Hickey 1979) */
    gboolean anastomosis;
    double width;        /* segments */
} VenEdge;

VEN_API void ven_leaf_edge(const VenLeaf *leaf, uint32_t edge, VenEdge *out);

/* A bent leaf (Hong 2005): its larger veins are a skeleton that [pose] bends, the blade between them is interpolated. */
typedef struct VenShape VenShape;

/* Shapes a leaf as its parameters ask ([mesh], [pose], [export]). The leaf must outlive the shape. */
VEN_API VenShape *ven_shape(const VenLeaf *leaf, GError **error);
VEN_API void ven_shape_free(VenShape *shape);

/* Poses it anew by [pose] of `params`; skeleton, mesh and factor are kept. On error the old pose stays. */
VEN_API gboolean ven_shape_pose(VenShape *shape, const VenParams *params, uint64_t seed, GError **error);

/* Writes the models that export.models names, with the maps they refer to: <name>.glb, .obj and .mtl, .ply, .pov and .inc; with several
 * mesh.levels <name>_lod1.glb and so on; with a rig <name>_rigged.glb; with pose.keyframes <name>_animated.glb; and the record. */
VEN_API gboolean ven_shape_write(const VenShape *shape, const char *dir, const char *name, GError **error);

/* The run record with what was shaped; free it with g_free. */
VEN_API char *ven_shape_record(const VenShape *shape);

/* The bent blade: vein sequences of the skeleton; vertices in metres and their unit normals, +z the sunny side; triangles seen
 * counter-clockwise from there. `normal` may be NULL. */
VEN_API uint32_t ven_shape_veins(const VenShape *shape);
VEN_API uint32_t ven_shape_vertices(const VenShape *shape);
VEN_API uint32_t ven_shape_triangles(const VenShape *shape);
VEN_API void ven_shape_vertex(const VenShape *shape, uint32_t vertex, double place[3], double normal[3]);
VEN_API void ven_shape_triangle(const VenShape *shape, uint32_t triangle, uint32_t vertex[3]);

/* Levels of detail there are, the full leaf included: at most mesh.levels. */
VEN_API uint32_t ven_shape_levels(const VenShape *shape);

/* Part of the blade's harmonic weights that did not fit into the joints a vertex may have, at worst and in the mean, and the number of joints;
 * FALSE: the leaf has no rig. */
VEN_API gboolean ven_shape_rig(const VenShape *shape, uint32_t *joints, double *worst_loss, double *mean_loss);

G_END_DECLS

#endif
