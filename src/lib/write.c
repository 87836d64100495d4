/* Writing a leaf: maps, drawing, network, record. */
#include <string.h>

#include "export/export.h"
#include "lib/settings.h"
#include "lib/writer.h"

/* Maps whose values are read as numbers: 255 levels would be too coarse for them. */
static gboolean measures(MapId id)
{
    return id == MAP_HEIGHT || id == MAP_THICKNESS || id == MAP_VEIN_WIDTH || id == MAP_DISTANCE || id == MAP_AGE || id == MAP_AREOLE;
}

/* Maps are painted and written band by band, each band's files side by side. */
enum { MAX_FILES = 2 * MAP_COUNT + 2, BAND_PIXELS = 1 << 19, BAND_STEP = 32 };

/* Pages that are no maps: the plain picture of the veins, and the picture of the leaf. */
enum { PAGE_VEINS = MAP_COUNT, PAGE_SPECIMEN, PAGE_COUNT };

/* A map or picture that is painted. */
typedef struct {
    int id; /* MapId or one of the above */
    const char *name;
    Plane *plane; /* the band at hand */
} Page;

typedef struct {
    const Page *page;
    ImageFile *file; /* NULL: not open */
    gboolean exr;
    GError *error;
} Sheet;

typedef struct {
    const Writer *writer;
    Painter *painter;
    Specimen *specimen; /* NULL: not wanted */
    Pool *pool;
    uint32_t height; /* of the image, pixels */
    Page page[PAGE_COUNT];
    Sheet sheet[MAX_FILES];
    uint32_t n_pages, n_sheets;
} Atlas;

static void add_sheet(Atlas *a, const Page *page, gboolean exr)
{
    a->sheet[a->n_sheets++] = (Sheet){.page = page, .exr = exr};
}

/* Files that take longest come first, so that none is left when all others are done. */
static void lay_out(Atlas *a, const gboolean *wanted, gboolean veins_image)
{
    for (int i = 0; i < MAP_COUNT; i++)
        if (wanted[i])
            a->page[a->n_pages++] = (Page){i, paint_map_info((MapId)i)->name, NULL};
    if (veins_image)
        a->page[a->n_pages++] = (Page){PAGE_VEINS, "veins", NULL};
    if (a->specimen)
        a->page[a->n_pages++] = (Page){PAGE_SPECIMEN, "specimen", NULL};
    for (int weight = 3; weight > 0; weight--)
        for (uint32_t i = 0; i < a->n_pages; i++) {
            const Page *p = &a->page[i];
            int channels = p->id < MAP_COUNT ? (int)paint_map_info((MapId)p->id)->channels : p->id == PAGE_SPECIMEN ? 3 : 1;
            if (a->writer->exr && p->id < MAP_COUNT && (channels > 1 ? 3 : 2) == weight)
                add_sheet(a, p, TRUE);
            if ((channels > 1 ? 2 : 1) == weight)
                add_sheet(a, p, FALSE);
        }
}

static gboolean open_sheet(const Atlas *a, Sheet *s)
{
    const Writer *w = a->writer;
    int id = s->page->id, depth = id >= MAP_COUNT ? 8 : measures((MapId)id) ? 16 : w->depth;
    char *suffix = g_strdup_printf("_%s.%s", s->page->name, s->exr ? "exr" : "png"), *path = writer_path(w, suffix);
    s->file = s->exr ? image_exr_begin(path, s->page->plane, a->height, w->exr == 1, &w->meta, NULL, &s->error)
                     : image_png_begin(path, s->page->plane, a->height, depth, &w->meta, &s->error);
    g_free(path);
    g_free(suffix);
    return s->file != NULL;
}

static void fill_sheets(uint32_t first, uint32_t last, void *user)
{
    Atlas *a = user;
    for (uint32_t i = first; i < last; i++) {
        Sheet *s = &a->sheet[i];
        if (s->file != NULL || open_sheet(a, s))
            image_file_rows(s->file, s->page->plane, &s->error);
    }
}

/* TRUE unless a sheet failed, whose error is passed on. */
static gboolean sheets_fine(Atlas *a, GError **error)
{
    for (uint32_t i = 0; i < a->n_sheets; i++)
        if (a->sheet[i].error != NULL) {
            g_propagate_error(error, g_steal_pointer(&a->sheet[i].error));
            return FALSE;
        }
    return TRUE;
}

static Plane *paint_page(Atlas *a, int id)
{
    if (id == PAGE_SPECIMEN)
        return specimen_paint(a->specimen);
    return id == PAGE_VEINS ? painter_veins(a->painter) : painter_paint(a->painter, (MapId)id);
}

static gboolean write_band(Atlas *a, uint32_t y0, uint32_t y1, GError **error)
{
    painter_band(a->painter, y0, y1);
    for (uint32_t i = 0; i < a->n_pages; i++)
        a->page[i].plane = paint_page(a, a->page[i].id);
    pool_for(a->pool, a->n_sheets, 1, fill_sheets, a);
    for (uint32_t i = 0; i < a->n_pages; i++)
        painter_give_back(a->painter, a->page[i].plane);
    return sheets_fine(a, error);
}

static gboolean finish(Atlas *a, gboolean ok, GError **error)
{
    for (uint32_t i = 0; i < a->n_sheets; i++) {
        Sheet *s = &a->sheet[i];
        if (ok)
            ok = image_file_end(s->file, error);
        else
            image_file_abort(s->file);
        g_clear_error(&s->error);
    }
    return ok;
}

static gboolean write_maps(const Writer *w, const Frame *frame, const gboolean *wanted, gboolean veins_image, gboolean specimen,
                           GError **error)
{
    Atlas *a = g_new0(Atlas, 1);
    a->writer = w;
    a->painter = writer_painter(w, frame);
    painter_expect(a->painter, wanted);
    a->pool = pool_new(w->leaf->threads);
    a->height = frame->height;
    SpecimenDef def = settings_specimen(w->leaf->params, w->leaf->seed);
    a->specimen = specimen ? specimen_new(a->painter, &def) : NULL;
    lay_out(a, wanted, veins_image);
    uint32_t rows = MAX(BAND_PIXELS / frame->width / BAND_STEP * BAND_STEP, (uint32_t)BAND_STEP);
    gboolean ok = TRUE;
    for (uint32_t y = 0; ok && y < frame->height; y += rows)
        ok = write_band(a, y, MIN(y + rows, frame->height), error);
    ok = finish(a, ok, error);
    specimen_free(a->specimen);
    painter_free(a->painter);
    pool_free(a->pool);
    g_free(a);
    return ok;
}

static gboolean write_svg(const Writer *w, const Frame *frame, GError **error)
{
    PaintStyle style = settings_style(w->leaf->params, w->leaf->seed, w->leaf->threads);
    const char *title = params_text(w->leaf->params, PARAM_LEAF_TITLE);
    ground_colours(w->leaf->ground, w->leaf->params, style.lamina, style.vein);
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
    gboolean wanted[MAP_COUNT], veins = params_switch(p, PARAM_EXPORT_VEINS_IMAGE), specimen = params_switch(p, PARAM_EXPORT_SPECIMEN);
    gboolean any = veins || specimen;
    if (!settings_maps(p, wanted, error))
        return FALSE;
    for (int i = 0; i < MAP_COUNT; i++)
        any |= wanted[i];
    Writer w;
    writer_init(&w, leaf, dir, name);
    Frame frame = leaf_frame(leaf, leaf->net->margin->box);
    gboolean ok = writer_make_dir(&w, error) &&
                  (!any || write_maps(&w, &frame, wanted, veins, specimen, error)) &&
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
                  (maps ? write_maps(&w, &frame, wanted, FALSE, FALSE, error) : write_svg(&w, &frame, error));
    writer_clear(&w);
    g_free(frame_name);
    g_free(folder);
    return ok;
}
