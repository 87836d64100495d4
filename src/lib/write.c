/* Writing a leaf: maps, drawing, network, record. */
#include <errno.h>
#include <glib/gstdio.h>
#include <string.h>

#include "export/export.h"
#include "geom/parallel.h"
#include "image/file.h"
#include "image/paint.h"
#include "lib/leaf.h"
#include "lib/settings.h"

typedef struct {
    const VenLeaf *leaf;
    const char *dir, *name;
    Metadata meta;
    int depth;
    int exr; /* 0 none, 1 half, 2 float */
} Writer;

static char *file_path(const Writer *w, const char *suffix)
{
    char *file = g_strdup_printf("%s%s", w->name, suffix), *path = g_build_filename(w->dir, file, NULL);
    g_free(file);
    return path;
}

/* One map in up to two formats, which are independent and so written side by side. */
typedef struct {
    const Writer *writer;
    const Plane *plane;
    const char *name;
    int depth;
    GError *error[2];
} MapJob;

static void write_map_format(uint32_t first, uint32_t last, void *user)
{
    MapJob *job = user;
    for (uint32_t i = first; i < last; i++) {
        if (i == 1 && !job->writer->exr)
            continue;
        char *suffix = g_strdup_printf("_%s.%s", job->name, i == 0 ? "png" : "exr"), *path = file_path(job->writer, suffix);
        if (i == 0)
            image_write_png(job->plane, path, job->depth, &job->writer->meta, &job->error[i]);
        else
            image_write_exr(job->plane, path, job->writer->exr == 1, &job->writer->meta, &job->error[i]);
        g_free(path);
        g_free(suffix);
    }
}

static gboolean write_map(const Writer *w, const Plane *plane, const char *name, int depth, GError **error)
{
    MapJob job = {.writer = w, .plane = plane, .name = name, .depth = depth};
    parallel_for(w->leaf->threads, 2, 1, write_map_format, &job);
    if (job.error[0] && job.error[1])
        g_clear_error(&job.error[1]);
    GError *failed = job.error[0] ? job.error[0] : job.error[1];
    if (failed)
        g_propagate_error(error, failed);
    return failed == NULL;
}

static gboolean write_maps(const Writer *w, const Frame *frame, const gboolean *wanted, gboolean veins_image, GError **error)
{
    PaintStyle style = settings_style(w->leaf->params, w->leaf->seed, w->leaf->threads);
    style.reference = w->leaf->reference;
    Painter *painter = painter_new(w->leaf->net, frame, &style);
    gboolean ok = TRUE;
    for (int i = 0; ok && i < MAP_COUNT; i++) {
        if (!wanted[i])
            continue;
        Plane *plane = painter_paint(painter, (MapId)i);
        ok = write_map(w, plane, paint_map_info((MapId)i)->name, i == MAP_HEIGHT ? 16 : w->depth, error);
        plane_free(plane);
    }
    if (ok && veins_image) {
        Plane *plane = painter_veins(painter);
        char *path = file_path(w, "_veins.png");
        ok = image_write_png(plane, path, 8, &w->meta, error);
        g_free(path);
        plane_free(plane);
    }
    painter_free(painter);
    return ok;
}

static gboolean write_svg(const Writer *w, const Frame *frame, GError **error)
{
    PaintStyle style = settings_style(w->leaf->params, w->leaf->seed, w->leaf->threads);
    const char *title = params_text(w->leaf->params, PARAM_LEAF_TITLE);
    char *path = file_path(w, ".svg");
    gboolean ok = export_svg(w->leaf->net, frame, &style, *title ? title : w->name, path, error);
    g_free(path);
    return ok;
}

static gboolean write_network(const Writer *w, GError **error)
{
    char *graphml = file_path(w, ".graphml"), *nodes = file_path(w, "_nodes.csv"), *edges = file_path(w, "_edges.csv");
    gboolean ok = export_graphml(w->leaf->net, graphml, error) && export_nodes_csv(w->leaf->net, nodes, error) &&
                  export_edges_csv(w->leaf->net, edges, error);
    g_free(graphml);
    g_free(nodes);
    g_free(edges);
    return ok;
}

static gboolean write_record(const Writer *w, GError **error)
{
    char *record = ven_leaf_record(w->leaf), *path = file_path(w, ".json");
    gboolean ok = export_text(record, strlen(record), path, error);
    g_free(path);
    g_free(record);
    return ok;
}

static gboolean make_dir(const char *dir, GError **error)
{
    if (g_mkdir_with_parents(dir, 0777) == 0)
        return TRUE;
    int e = errno;
    g_set_error(error, G_FILE_ERROR, g_file_error_from_errno(e), "can't make the folder '%s': %s", dir, g_strerror(e));
    return FALSE;
}

enum { META = 5 };

static void writer_init(Writer *w, const VenLeaf *leaf, const char *dir, const char *name, char *value[META])
{
    static const char *const key[META] = {"Software", "Title", "Source", "Seed", "Parameters"};
    value[0] = g_strdup("Venation " VENATION_VERSION);
    value[1] = g_strdup(params_text(leaf->params, PARAM_LEAF_TITLE));
    value[2] = g_strdup(params_text(leaf->params, PARAM_LEAF_SOURCE));
    value[3] = g_strdup_printf("%" G_GUINT64_FORMAT, (guint64)leaf->seed);
    value[4] = params_to_file(leaf->params);
    *w = (Writer){leaf, dir, name, {META, key, (const char *const *)value}, params_choice(leaf->params, PARAM_TEXTURE_DEPTH) ? 16 : 8,
                  params_choice(leaf->params, PARAM_TEXTURE_EXR)};
}

static Frame frame_of(const VenLeaf *leaf, Box2 box)
{
    const Params *p = leaf->params;
    return frame_fit(box, (uint32_t)params_integer(p, PARAM_TEXTURE_SIZE), params_choice(p, PARAM_TEXTURE_FRAME) == 0,
                     params_number(p, PARAM_TEXTURE_MARGIN));
}

gboolean ven_write(const VenLeaf *leaf, const char *dir, const char *name, GError **error)
{
    const Params *p = leaf->params;
    gboolean wanted[MAP_COUNT], any = params_switch(p, PARAM_EXPORT_VEINS_IMAGE);
    if (!settings_maps(p, wanted, error) || !make_dir(dir, error))
        return FALSE;
    for (int i = 0; i < MAP_COUNT; i++)
        any |= wanted[i];
    Writer w;
    char *value[META];
    writer_init(&w, leaf, dir, name, value);
    Frame frame = frame_of(leaf, leaf->net->margin->box);
    gboolean ok = (!any || write_maps(&w, &frame, wanted, params_switch(p, PARAM_EXPORT_VEINS_IMAGE), error)) &&
                  (!params_switch(p, PARAM_EXPORT_SVG) || write_svg(&w, &frame, error)) &&
                  (!params_switch(p, PARAM_EXPORT_NETWORK) || write_network(&w, error)) && write_record(&w, error);
    for (int i = 0; i < META; i++)
        g_free(value[i]);
    return ok;
}

gboolean ven_write_frame(const VenLeaf *leaf, const char *dir, const char *name, gboolean maps, GError **error)
{
    gboolean wanted[MAP_COUNT];
    char *folder = g_build_filename(dir, "frames", NULL);
    char *frame_name = g_strdup_printf("%s_%06u", name, leaf->counts.step);
    gboolean ok = settings_maps(leaf->params, wanted, error) && make_dir(folder, error);
    if (ok) {
        Writer w;
        char *value[META];
        writer_init(&w, leaf, folder, frame_name, value);
        Frame frame = frame_of(leaf, leaf->stage); /* one scale for all frames of a run */
        ok = maps ? write_maps(&w, &frame, wanted, FALSE, error) : write_svg(&w, &frame, error);
        for (int i = 0; i < META; i++)
            g_free(value[i]);
    }
    g_free(frame_name);
    g_free(folder);
    return ok;
}
