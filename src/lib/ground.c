#include "lib/ground_private.h"

#include "image/scan_file.h"

/* ---- coordinates ---- */

Vec2 ground_to_leaf(const Ground *g, Vec2 p)
{
    Vec2 axis = vec_sub(g->tip, g->base), q = vec_sub(p, g->base);
    double by = 1.0 / vec_norm2(axis);
    return vec2(vec_cross(q, axis) * by, vec_dot(q, axis) * by);
}

Affine ground_to_pixels(Vec2 base, Vec2 tip, uint32_t height)
{
    Vec2 axis = vec_sub(tip, base);
    return (Affine){.a = axis.y, .b = axis.x, .c = axis.x, .d = -axis.y, .e = base.x, .f = height - base.y};
}

Polygon *ground_outline_in(const Ground *g, const Scan *scan, const Affine *to_scan)
{
    Vec2 *v = g_new(Vec2, g->outline->n);
    for (uint32_t i = 0; i < g->outline->n; i++) {
        Vec2 q = affine_apply(to_scan, g->outline->v[i]);
        v[i] = vec2(q.x, scan->height - q.y);
    }
    Polygon *p = polygon_new(v, g->outline->n);
    g_free(v);
    return p;
}

/* ---- messages ---- */

/* The back is laid on by an affine map, which makes up for that. */
static void check_pixels(Ground *g, const Params *p)
{
    double aspect = g->scan->aspect;
    if (aspect > 0.0 && aspect != 1.0)
        g_string_append_printf(g->note, "%s: by its resolution its pixels are not square (width to height %.3f); they are taken as square, so the leaf is %.1f %% too %s. "
                               "Areas in mm² are right, lengths lie between; scale the image to square pixels to mend that\n",
                               params_text(p, PARAM_SCAN_FILE), aspect, 100.0 * (MAX(aspect, 1.0 / aspect) - 1.0), aspect > 1.0 ? "narrow" : "wide");
}

/* Of a file of several scans one is read. */
static void check_pages(Ground *g, const Params *p, ParamId id)
{
    uint32_t n = *params_text(p, id) ? image_pages(params_text(p, id)) : 1;
    if (n > 1)
        g_string_append_printf(g->note, "%s: has %u pages; the first is read. Save the others as files of their own to have them captured\n", params_text(p, id), n);
}

/* What parts the image best need not be the leaf's margin. */
static void check_channel(Ground *g, const Params *p)
{
    const Threshold *t = g->profile ? &g->threshold : g->fang ? &g->fang->threshold : NULL;
    if (t && t->green > 0.0 && params_integer(p, PARAM_SCAN_LEAF) == 1)
        g_string_append_printf(g->note, "%s: by %s %.0f %% of the image are leaf, by greenness, which parts it nearly as well, %.0f %%; if the outline is another thing's, "
                               "set scan.channel = greenness\n", params_text(p, PARAM_SCAN_FILE), channel_name(t->channel), 100.0 * t->leaf, 100.0 * t->green);
}

gboolean ground_blame(const Params *p, ParamId id, GError **error)
{
    g_prefix_error(error, "%s: ", params_text(p, id));
    return FALSE;
}

bool ground_place(const Ground *g, const Params *p, const char *file, SvgPlace *place)
{
    SvgUnder under = {params_text(p, PARAM_SCAN_FILE), g->scan->width, g->scan->height};
    return svgplace_find(file, &under, place, NULL);
}

char *ground_lies(const Ground *g, SvgPlace *place)
{
    if (place)
        return g_steal_pointer(&place->how);
    return g->scan ? g_strdup("its numbers, which are pixels of the scan") : NULL;
}

/* ---- all of it ---- */

static gboolean find(Ground *g, const Params *p, GroundScan *sheet, bool veins, GError **error)
{
    GPtrArray *back = NULL;
    gboolean ok = ground_read_scans(g, p, sheet, &back, error) && ground_find_outline(g, p, sheet, error);
    if (ok && g->scan) {
        g->to_scan = ground_to_pixels(g->base, g->tip, g->scan->height);
        check_pixels(g, p);
        check_pages(g, p, PARAM_SCAN_FILE);
        check_pages(g, p, PARAM_SCAN_BACK);
        check_channel(g, p);
    }
    ok = ok && (!g->back || ground_find_back(g, p, back, error));
    if (back)
        g_ptr_array_unref(back);
    if (ok && g->scan)
        ground_find_holes(g, p);
    return ok && (!veins || ground_find_veins(g, p, error));
}

static void clear(gpointer data)
{
    Ground *g = data;
    g_free(g->outline_lies);
    g_free(g->drawing_lies);
    g_string_free(g->note, TRUE);
    polygon_free(g->outline);
    drawing_free(g->drawing);
    scan_free(g->scan);
    scan_free(g->back);
    profile_free(g->profile);
    fang_profile_free(g->fang);
    holes_free(g->holes);
}

Ground *ground_new(const Params *p, bool veins, GError **error) { return ground_new_on(NULL, p, veins, error); }

Ground *ground_new_on(GroundScan *sheet, const Params *p, bool veins, GError **error)
{
    Ground *g = g_atomic_rc_box_new0(Ground);
    g->note = g_string_new(NULL);
    gboolean found = find(g, p, sheet, veins, error);
    if (found && ground_make_textures(g, p, sheet, error))
        return g;
    if (!found && sheet)
        ground_return_scans(g, sheet);
    ground_unref(g);
    return NULL;
}

Ground *ground_ref(Ground *g) { return g ? g_atomic_rc_box_acquire(g) : NULL; }

void ground_unref(Ground *g)
{
    if (g)
        g_atomic_rc_box_release_full(g, clear);
}
