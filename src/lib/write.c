/* Writing a leaf: maps, drawing, network, record. */
#include <string.h>

#include "export/export.h"
#include "lib/settings.h"
#include "lib/writer.h"

/* Maps whose values are read as numbers: 255 levels would be too coarse for them. */
static gboolean measures(MapId id)
{
    return id == MAP_HEIGHT || id == MAP_THICKNESS || id == MAP_VEIN_WIDTH || id == MAP_DISTANCE || id == MAP_AGE;
}

static gboolean write_maps(const Writer *w, const Frame *frame, const gboolean *wanted, gboolean veins_image, GError **error)
{
    Painter *painter = writer_painter(w, frame);
    gboolean ok = TRUE;
    for (int i = 0; ok && i < MAP_COUNT; i++) {
        if (!wanted[i])
            continue;
        Plane *plane = painter_paint(painter, (MapId)i);
        ok = writer_map(w, plane, paint_map_info((MapId)i)->name, measures((MapId)i) ? 16 : w->depth, error);
        plane_free(plane);
    }
    if (ok && veins_image) {
        Plane *plane = painter_veins(painter);
        char *path = writer_path(w, "_veins.png");
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
    char *path = writer_path(w, ".svg");
    gboolean ok = export_svg(w->leaf->net, frame, &style, *title ? title : w->name, path, error);
    g_free(path);
    return ok;
}

static gboolean write_network(const Writer *w, GError **error)
{
    char *graphml = writer_path(w, ".graphml"), *nodes = writer_path(w, "_nodes.csv"), *edges = writer_path(w, "_edges.csv");
    gboolean ok = export_graphml(w->leaf->net, graphml, error) && export_nodes_csv(w->leaf->net, nodes, error) &&
                  export_edges_csv(w->leaf->net, edges, error);
    g_free(graphml);
    g_free(nodes);
    g_free(edges);
    return ok;
}

static gboolean write_record(const Writer *w, GError **error)
{
    char *record = ven_leaf_record(w->leaf), *path = writer_path(w, ".json");
    gboolean ok = export_text(record, strlen(record), path, error);
    g_free(path);
    g_free(record);
    return ok;
}

Frame leaf_frame(const VenLeaf *leaf, Box2 box)
{
    const Params *p = leaf->params;
    return frame_fit(box, (uint32_t)params_integer(p, PARAM_TEXTURE_SIZE), params_choice(p, PARAM_TEXTURE_FRAME) == 0,
                     params_number(p, PARAM_TEXTURE_MARGIN));
}

gboolean ven_write(const VenLeaf *leaf, const char *dir, const char *name, GError **error)
{
    const Params *p = leaf->params;
    gboolean wanted[MAP_COUNT], any = params_switch(p, PARAM_EXPORT_VEINS_IMAGE);
    if (!settings_maps(p, wanted, error))
        return FALSE;
    for (int i = 0; i < MAP_COUNT; i++)
        any |= wanted[i];
    Writer w;
    writer_init(&w, leaf, dir, name);
    Frame frame = leaf_frame(leaf, leaf->net->margin->box);
    gboolean ok = writer_make_dir(&w, error) &&
                  (!any || write_maps(&w, &frame, wanted, params_switch(p, PARAM_EXPORT_VEINS_IMAGE), error)) &&
                  (!params_switch(p, PARAM_EXPORT_SVG) || write_svg(&w, &frame, error)) &&
                  (!params_switch(p, PARAM_EXPORT_NETWORK) || write_network(&w, error)) && write_record(&w, error);
    writer_clear(&w);
    return ok;
}

gboolean ven_write_frame(const VenLeaf *leaf, const char *dir, const char *name, gboolean maps, GError **error)
{
    gboolean wanted[MAP_COUNT];
    char *folder = g_build_filename(dir, "frames", NULL);
    char *frame_name = g_strdup_printf("%s_%06u", name, leaf->counts.step);
    Writer w;
    writer_init(&w, leaf, folder, frame_name);
    Frame frame = leaf_frame(leaf, leaf->stage); /* one scale for all frames of a run */
    gboolean ok = settings_maps(leaf->params, wanted, error) && writer_make_dir(&w, error) &&
                  (maps ? write_maps(&w, &frame, wanted, FALSE, error) : write_svg(&w, &frame, error));
    writer_clear(&w);
    g_free(frame_name);
    g_free(folder);
    return ok;
}
