#include "lib/writer.h"

#include <errno.h>
#include <glib/gstdio.h>

#include "lib/settings.h"

/* Where there is no scan of the shadow side, it is the sunny side's in the shadow side's shade. */
static void shadow_tint(const Params *p, float tint[3])
{
    PaintStyle style = settings_style(p, 0, 1);
    for (int i = 0; i < 3; i++)
        tint[i] = (float)CLAMP(sqrt((double)style.abaxial_lamina[i] / MAX((double)style.lamina[i], 1e-3)), 0.8, 1.5);
}

static void lay_photos(Writer *w)
{
    const Ground *g = w->leaf->ground;
    if (!g || !g->scan || !params_switch(w->leaf->params, PARAM_SCAN_TEXTURE))
        return;
    double by = 1.0 / w->leaf->length;
    Affine to_leaf = {.a = by, .d = by}, front = affine_multiply(&g->to_scan, &to_leaf), back = affine_multiply(&g->to_back, &to_leaf);
    float plain[3] = {1.0f, 1.0f, 1.0f}, shade[3];
    shadow_tint(w->leaf->params, shade);
    w->photo[0] = photo_new(g->scan, &front, plain);
    w->photo[1] = g->back ? photo_new(g->back, &back, plain) : photo_new(g->scan, &front, shade);
}

void writer_init(Writer *w, const VenLeaf *leaf, const char *dir, const char *name)
{
    static const char *const key[WRITER_META] = {"Software", "Title", "Source", "Seed", "Parameters"};
    *w = (Writer){.leaf = leaf, .dir = dir, .name = name};
    w->value[0] = g_strdup("Venation " VENATION_VERSION);
    w->value[1] = g_strdup(params_text(leaf->params, PARAM_LEAF_TITLE));
    w->value[2] = g_strdup(params_text(leaf->params, PARAM_LEAF_SOURCE));
    w->value[3] = g_strdup_printf("%" G_GUINT64_FORMAT, (guint64)leaf->seed);
    w->value[4] = params_to_file(leaf->params);
    w->meta = (Metadata){WRITER_META, key, (const char *const *)w->value};
    w->depth = params_choice(leaf->params, PARAM_TEXTURE_DEPTH) ? 16 : 8;
    w->exr = params_choice(leaf->params, PARAM_TEXTURE_EXR);
    lay_photos(w);
}

void writer_clear(Writer *w)
{
    for (int i = 0; i < WRITER_META; i++)
        g_free(w->value[i]);
    for (int i = 0; i < 2; i++)
        photo_free(w->photo[i]);
}

gboolean writer_make_dir(const Writer *w, GError **error)
{
    if (g_mkdir_with_parents(w->dir, 0777) == 0)
        return TRUE;
    int e = errno;
    g_set_error(error, G_FILE_ERROR, g_file_error_from_errno(e), "can't make the folder '%s': %s", w->dir, g_strerror(e));
    return FALSE;
}

char *writer_path(const Writer *w, const char *suffix)
{
    char *file = g_strdup_printf("%s%s", w->name, suffix), *path = g_build_filename(w->dir, file, NULL);
    g_free(file);
    return path;
}

Painter *writer_painter(const Writer *w, const Frame *frame)
{
    PaintStyle style = settings_style(w->leaf->params, w->leaf->seed, w->leaf->threads);
    style.reference = w->leaf->reference;
    for (int i = 0; i < 2; i++)
        style.photo[i] = w->photo[i];
    return painter_new(w->leaf->net, frame, &style);
}
