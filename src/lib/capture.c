/* What a person goes on with after a capture: a drawing over the scan to correct, and a parameter file that grows and shapes from it. */
#include <gio/gio.h>
#include <string.h>

#include "export/drawing.h"
#include "export/export.h"
#include "lib/leaf.h"
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

uint32_t ven_scan_leaves(const VenParams *params, GError **error) { return ground_count_leaves(params->values, error); }

/* ---- the scan beside the drawing ---- */

/* NAME_scan.jpg: the image is copied, so that the folder is complete in itself and can be moved. */
static char *copy_name(const Writer *w, const char *image, const char *what)
{
    const char *dot = strrchr(image, '.');
    char *end = g_ascii_strdown(dot && strlen(dot) <= 5 && !strchr(dot, '/') ? dot : "", -1);
    char *name = g_strdup_printf("%s_%s%s", w->name, what, end);
    g_free(end);
    return name;
}

static gboolean copy(const Writer *w, const char *image, const char *name, GError **error)
{
    char *path = g_build_filename(w->dir, name, NULL);
    GFile *from = g_file_new_for_path(image), *to = g_file_new_for_path(path);
    gboolean ok = g_file_copy(from, to, G_FILE_COPY_OVERWRITE | G_FILE_COPY_TARGET_DEFAULT_PERMS, NULL, NULL, NULL, error);
    g_object_unref(from);
    g_object_unref(to);
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
                          .veins = g->drawing,
                          .to_scan = g->to_scan};
    char *path = g_build_filename(w->dir, file, NULL);
    gboolean ok = export_drawing_svg(&sheet, path, error);
    g_free(path);
    g_free((gpointer)sheet.curves);
    return ok;
}

/* ---- the parameter file ---- */

/* The parameters that were given, and where the files are now. */
static char *parameter_text(const VenLeaf *leaf, const char *scan, const char *back, const char *drawing)
{
    Params *p = params_copy(leaf->params);
    gboolean ok = params_set(p, PARAM_SCAN_FILE, scan, "", NULL) && params_set(p, PARAM_OUTLINE_FILE, drawing, "", NULL) &&
                  params_set(p, PARAM_VEINS_DRAWING, drawing, "", NULL) && params_set(p, PARAM_VEINS_ORIGIN, "grown", "", NULL) &&
                  (!back || params_set(p, PARAM_SCAN_BACK, back, "", NULL));
    g_assert(ok); /* names of files, and a word of the table */
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
    const Params *p = leaf->params;
    if (!leaf->ground || !leaf->ground->scan) {
        g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT, "the leaf does not come from a scan");
        return FALSE;
    }
    Writer w;
    writer_init(&w, leaf, dir, name);
    const char *image = params_text(p, PARAM_SCAN_FILE), *other = params_text(p, PARAM_SCAN_BACK);
    char *scan = copy_name(&w, image, "scan"), *back = *other ? copy_name(&w, other, "back") : NULL;
    char *drawing = g_strconcat(name, "_drawing.svg", NULL);
    gboolean ok = writer_make_dir(&w, error) && copy(&w, image, scan, error) && (!back || copy(&w, other, back, error)) &&
                  write_drawing(&w, scan, drawing, error) && write_parameters(&w, scan, back, drawing, error);
    g_free(scan);
    g_free(back);
    g_free(drawing);
    writer_clear(&w);
    return ok;
}
