/* What a person goes on with after a capture: a drawing over the scan to correct, and a parameter file that grows and shapes from it. */
#include <errno.h>
#include <gio/gio.h>
#include <string.h>

#include "export/drawing.h"
#include "export/export.h"
#include "geom/boxtree.h"
#include "image/scan_file.h"
#include "image/staged.h"
#include "lib/leaf.h"
#include "lib/shape.h"
#include "lib/writer.h"

/* What grows best in a real outline, with real primaries or without: everywhere alike, so that veins of all orders have time to come one after the other. */
static const struct {
    ParamId id;
    const char *value;
} preset[] = {
    {PARAM_GROWTH_KIND, "isogonic"},
    {PARAM_GROWTH_INITIAL_LENGTH, "80"},
    {PARAM_GROWTH_FINAL_LENGTH, "700"},
    {PARAM_GROWTH_STEP, "4"},
    {PARAM_SOURCES_DENSITY, "0.004"},
    {PARAM_SOURCES_BIRTH_DISTANCE_SOURCES, "7"},
    {PARAM_SOURCES_BIRTH_DISTANCE_VEINS, "6"},
    {PARAM_VEINS_KILL_DISTANCE, "2"},
    {PARAM_VEINS_JOIN_DISTANCE, "4"},
    {PARAM_WIDTH_EXPONENT, "2.6"},
};

gboolean ven_params_use_scan(VenParams *params, const char *image, GError **error)
{
    Params *p = params->values;
    gboolean ok = params_set(p, PARAM_SCAN_FILE, image, "the image", error);
    for (gsize i = 0; ok && i < G_N_ELEMENTS(preset); i++)
        ok = params_is_given(p, preset[i].id) || params_set(p, preset[i].id, preset[i].value, "the defaults for a scan", error);
    return ok;
}

uint32_t ven_scan_leaves(const VenParams *params, GError **error)
{
    VenScan *sheet = ven_scan_open(params, error);
    uint32_t n = sheet ? ven_scan_count(sheet) : 0;
    ven_scan_close(sheet);
    return n;
}

uint32_t ven_leaf_veins(const VenLeaf *leaf, uint32_t order)
{
    const Network *net = leaf->net;
    uint8_t *seen = g_new0(uint8_t, net->n_veins);
    uint32_t n = 0;
    for (uint32_t e = 0; e < net->n_edges; e++) {
        uint8_t *vein = &seen[net->vein[e]];
        bool counts = !*vein && (order == 0 || net->order[e] == order);
        *vein |= counts;
        n += counts;
    }
    g_free(seen);
    return n;
}

/* ---- the scan beside the drawing ---- */

/* An image that lies beside the drawing, so that the folder is complete in itself and can be moved. */
typedef struct {
    const char *from;
    char *name; /* SHEET_scan.jpg; NULL: there is none */
    bool as_is; /* the file's bytes; else upright, as PNG: browsers and Inkscape may not show TIFF, nor turn what a tag wants turned */
} Beside;

static Beside beside(const char *from, const char *sheet, const char *what, const Scan *scan)
{
    if (!scan)
        return (Beside){0};
    const char *dot = strrchr(from, '.');
    char *end = g_ascii_strdown(!scan->as_stored ? ".png" : dot && strlen(dot) <= 5 && !strchr(dot, '/') ? dot : "", -1);
    Beside b = {from, g_strdup_printf("%s_%s%s", sheet, what, end), scan->as_stored};
    g_free(end);
    return b;
}

static gboolean cannot_read(const char *path, GError **error)
{
    int code = errno ? errno : EIO;
    g_set_error(error, G_FILE_ERROR, (gint)g_file_error_from_errno(code), "can't read '%s': %s", path, g_strerror(code));
    return FALSE;
}

/* Copies what is left of `from`, which was opened as `image`. */
static gboolean pour(FILE *from, const char *image, Staged *to, GError **error)
{
    char part[1 << 14];
    gsize n;
    errno = 0;
    while ((n = fread(part, 1, sizeof part, from)) > 0)
        if (fwrite(part, 1, n, to->file) != n) {
            staged_error(to->path, errno ? errno : EIO, error);
            return FALSE;
        }
    return !ferror(from) || cannot_read(image, error);
}

static gboolean copy_file(const char *image, const char *path, GError **error)
{
    FILE *from = fopen(image, "rb");
    if (!from)
        return cannot_read(image, error);
    Staged to;
    gboolean ok = staged_open(&to, path, error);
    if (ok && !pour(from, image, &to, error)) {
        staged_abort(&to);
        ok = FALSE;
    }
    ok = ok && staged_commit(&to, error);
    fclose(from);
    return ok;
}

/* The leaf's own scan has become a texture by now. */
static gboolean copy_upright(const char *image, const char *path, GError **error)
{
    Scan *scan = scan_read(image, 0, error);
    gboolean ok = scan && image_write_scan(scan, path, error);
    scan_free(scan);
    return ok;
}

static gboolean copy(const Writer *w, const Beside *b, GError **error)
{
    if (!b->name)
        return TRUE;
    char *path = g_build_filename(w->dir, b->name, NULL);
    gboolean ok = b->as_is ? copy_file(b->from, path, error) : copy_upright(b->from, path, error);
    g_free(path);
    return ok;
}

/* ---- the drawing ---- */

/* The Bézier curves of method fang, whose path is in y-up pixels, as path data with y down. */
static char *curves_down(const BezierFit *fit, double height)
{
    GString *s = g_string_new(NULL);
    for (uint32_t i = 0; i < fit->n; i++) {
        const Vec2 *p = fit->piece[i].p;
        if (i == 0)
            g_string_append_printf(s, "M%.2f,%.2f", p[0].x, height - p[0].y);
        g_string_append_printf(s, " C%.2f,%.2f %.2f,%.2f %.2f,%.2f", p[1].x, height - p[1].y, p[2].x, height - p[2].y, p[3].x, height - p[3].y);
    }
    g_string_append(s, " Z");
    return g_string_free(s, FALSE);
}

/* The order that a drawn vein without one has in the network, along most of its length; 0 when it has none there. */
static uint8_t network_order(const DrawnVein *v, const Network *net, const Boxtree *tree, const Vec2 *middle)
{
    double votes[256] = {0.0}; /* length by order */
    unsigned best = 0;
    for (uint32_t i = 1; i < v->n; i++) {
        uint32_t edge = UINT32_MAX;
        double far2 = HUGE_VAL;
        boxtree_nearest(tree, middle, vec_scale(vec_lerp(v->point[i - 1], v->point[i], 0.5), net->length), NULL, NULL, &edge, &far2);
        votes[net->order[edge]] += vec_dist(v->point[i - 1], v->point[i]);
    }
    for (unsigned k = 1; k < G_N_ELEMENTS(votes); k++)
        best = votes[k] > votes[best] ? k : best;
    return (uint8_t)best;
}

/* Orders of the drawing's veins: their own, else those that the network gave them (a tracing says none); free it. */
static uint8_t *vein_orders(const Drawing *d, const Network *net)
{
    if (!d)
        return NULL;
    uint8_t *order = g_new0(uint8_t, d->n + 1);
    uint32_t *item = g_new(uint32_t, net->n_edges);
    Vec2 *middle = g_new(Vec2, net->n_edges);
    for (uint32_t e = 0; e < net->n_edges; e++) {
        item[e] = e;
        middle[e] = vec_lerp(net->node[net->tail[e]], net->node[net->head[e]], 0.5);
    }
    Boxtree tree = {0};
    if (net->n_edges)
        boxtree_build(&tree, middle, item, net->n_edges);
    for (uint32_t k = 0; k < d->n; k++)
        order[k] = d->vein[k].order || !net->n_edges ? d->vein[k].order : network_order(&d->vein[k], net, &tree, middle);
    boxtree_clear(&tree);
    g_free(middle);
    g_free(item);
    return order;
}

static gboolean write_drawing(const Writer *w, const char *image, const char *file, GError **error)
{
    const Ground *g = w->leaf->ground;
    const char *title = params_text(w->leaf->params, PARAM_LEAF_TITLE);
    DrawingSheet sheet = {.title = *title ? title : w->name,
                          .width = g->scan->width,
                          .height = g->scan->height,
                          .mm_per_pixel = g->scan->mm_per_pixel,
                          .image = image,
                          .outline = g->outline,
                          .curves = g->fang ? curves_down(g->fang->fit, g->scan->height) : NULL,
                          .holes = g->holes,
                          .veins = g->drawing,
                          .order = vein_orders(g->drawing, w->leaf->net),
                          .to_scan = g->to_scan};
    char *path = g_build_filename(w->dir, file, NULL);
    gboolean ok = export_drawing_svg(&sheet, path, error);
    g_free(path);
    g_free((gpointer)sheet.curves);
    g_free((gpointer)sheet.order);
    return ok;
}

/* ---- the parameter file ---- */

/* The drawing has no petiole, so the file tells of it. */
static gboolean keep_petiole(const VenLeaf *leaf, Params *p)
{
    double length, width;
    char text[2][32];
    if (!shape_real_petiole(leaf, &length, &width))
        return TRUE;
    g_ascii_formatd(text[0], sizeof text[0], "%.4f", MIN(length, 10.0));
    g_ascii_formatd(text[1], sizeof text[1], "%.4f", MIN(width, 1.0));
    return params_set(p, PARAM_MESH_PETIOLE_LENGTH, text[0], "", NULL) &&
           (params_is_given(p, PARAM_MESH_PETIOLE_WIDTH) || params_set(p, PARAM_MESH_PETIOLE_WIDTH, text[1], "", NULL));
}

/* The parameters that were given, and where the files are now. */
static char *parameter_text(const VenLeaf *leaf, const char *scan, const char *back, const char *drawing)
{
    Params *p = params_copy(leaf->params);
    gboolean lsystem = params_choice(p, PARAM_VEINS_ORIGIN) == ORIGIN_LSYSTEM;
    gboolean ok = params_set(p, PARAM_SCAN_FILE, scan, "", NULL) && params_set(p, PARAM_OUTLINE_FILE, drawing, "", NULL) &&
                  params_set(p, PARAM_VEINS_DRAWING, drawing, "", NULL) &&
                  (lsystem || params_set(p, PARAM_VEINS_ORIGIN, "grown", "", NULL)) &&
                  (!back || params_set(p, PARAM_SCAN_BACK, back, "", NULL));
    ok = ok && keep_petiole(leaf, p);
    g_assert(ok); /* names of files, numbers in their ranges, and a word of the table */
    GString *s = g_string_new("# Grow and shape this leaf: venation grow FILE, venation shape FILE. Correct outline and veins in the drawing,\n"
                              "# with Inkscape; with origin = drawn the veins are those of the drawing alone.\n");
    const char *section = NULL;
    for (int i = 0; i < PARAM_COUNT; i++) {
        const ParamInfo *info = param_info((ParamId)i);
        if (!params_is_given(p, (ParamId)i))
            continue;
        if (!section || !g_str_equal(section, info->section))
            g_string_append_printf(s, "\n[%s]\n", info->section);
        section = info->section;
        char *value = params_format(p, (ParamId)i);
        g_string_append_printf(s, "%s = %s\n", info->key, value);
        g_free(value);
    }
    params_free(p);
    return g_string_free(s, FALSE);
}

static gboolean write_parameters(const Writer *w, const char *scan, const char *back, const char *drawing, GError **error)
{
    char *text = parameter_text(w->leaf, scan, back, drawing), *path = writer_path(w, ".ini");
    gboolean ok = export_text(text, strlen(text), path, error);
    g_free(path);
    g_free(text);
    return ok;
}

/* ---- all of it ---- */

gboolean ven_write_capture(const VenLeaf *leaf, const char *dir, const char *name, GError **error)
{
    return ven_write_capture_of(leaf, dir, name, NULL, error);
}

gboolean ven_write_capture_of(const VenLeaf *leaf, const char *dir, const char *name, const char *sheet, GError **error)
{
    const Params *p = leaf->params;
    const Ground *g = leaf->ground;
    if (!g || !g->scan) {
        g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT, "the leaf does not come from a scan");
        return FALSE;
    }
    Writer w;
    writer_init(&w, leaf, dir, name);
    bool first = !sheet || params_integer(p, PARAM_SCAN_LEAF) == 1;
    Beside scan = beside(params_text(p, PARAM_SCAN_FILE), sheet ? sheet : name, "scan", g->scan);
    Beside back = beside(params_text(p, PARAM_SCAN_BACK), sheet ? sheet : name, "back", g->back);
    char *drawing = g_strconcat(name, "_drawing.svg", NULL);
    gboolean ok = writer_make_dir(&w, error) && (!first || (copy(&w, &scan, error) && copy(&w, &back, error))) &&
                  write_drawing(&w, scan.name, drawing, error) && write_parameters(&w, scan.name, back.name, drawing, error);
    g_free(scan.name);
    g_free(back.name);
    g_free(drawing);
    writer_clear(&w);
    return ok;
}
