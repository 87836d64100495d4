/* Scans as files, read once for all the leaves on them. */
#include "lib/ground_private.h"

/* NULL and no error where the parameter names none. */
static gboolean read_scan(const Params *p, ParamId id, Scan **scan, GError **error)
{
    const char *file = params_text(p, id);
    if (!*file)
        return TRUE;
    *scan = scan_read(file, 0, error);
    return *scan != NULL;
}

/* All leaves on the back: they need not lie in the order of the front. */
static gboolean read_back(const Params *p, Scan **back, GPtrArray **profiles, GError **error)
{
    if (!read_scan(p, PARAM_SCAN_BACK, back, error) || !*back)
        return *back || !*params_text(p, PARAM_SCAN_BACK);
    ProfileDef def = settings_profile(p, (*back)->height);
    def.has_base = def.has_tip = false;
    def.each = true;
    *profiles = profile_capture(*back, &def, NULL, error);
    return *profiles || ground_blame(p, PARAM_SCAN_BACK, error);
}

/* ---- sheets ---- */

static gboolean capture_sheet(GroundScan *sheet, const Params *p, GError **error)
{
    if (!*params_text(p, PARAM_SCAN_FILE)) {
        g_set_error(error, SETTINGS_ERROR, SETTINGS_ERROR_CONFLICT, "scan.file is not given, so there is no scan to look for leaves in");
        return FALSE;
    }
    if (!read_scan(p, PARAM_SCAN_FILE, &sheet->scan, error))
        return FALSE;
    sheet->size = (ScanSize){sheet->scan->width, sheet->scan->height};
    ProfileDef def = settings_profile(p, sheet->scan->height);
    def.each = true;
    def.has_base = def.has_tip = false;
    sheet->profile = profile_capture(sheet->scan, &def, &sheet->threshold, error);
    if (!sheet->profile)
        return ground_blame(p, PARAM_SCAN_FILE, error);
    if (!read_back(p, &sheet->back, &sheet->back_profile, error))
        return FALSE;
    if (sheet->back)
        sheet->back_size = (ScanSize){sheet->back->width, sheet->back->height};
    return TRUE;
}

GroundScan *ground_scan_new(const Params *p, GError **error)
{
    GroundScan *sheet = g_new0(GroundScan, 1);
    if (capture_sheet(sheet, p, error))
        return sheet;
    ground_scan_free(sheet);
    return NULL;
}

uint32_t ground_scan_leaves(const GroundScan *sheet) { return sheet->profile->len; }

void ground_scan_free(GroundScan *sheet)
{
    if (!sheet)
        return;
    if (sheet->profile)
        g_ptr_array_unref(sheet->profile); /* what was given away is NULL there */
    if (sheet->back_profile)
        g_ptr_array_unref(sheet->back_profile);
    scan_free(sheet->scan);
    scan_free(sheet->back);
    g_free(sheet);
}

/* ---- one leaf ---- */

/* What may be looked at around a leaf: of its longer side, and pixels. */
#define AROUND_SHARE 0.25
#define AROUND_LEAST 128.0
#define MOST 0.5 /* of a scan: beyond that a leaf keeps it as it is, and it is read anew for the next one */

/* Lends the sheet's scan, whole, to a leaf; `size` is what it measured when its leaves were found. */
static gboolean lend(const Params *p, ParamId id, const ScanSize *size, Scan **from, Scan **to, GError **error)
{
    if (!size->width)
        return TRUE;
    if (!*from && !read_scan(p, id, from, error))
        return FALSE;
    if ((*from)->width != size->width || (*from)->height != size->height) {
        g_set_error(error, SCAN_ERROR, SCAN_ERROR_VALUE, "%s: is %u × %u pixels now, and was %u × %u when its leaves were found", params_text(p, id),
                    (*from)->width, (*from)->height, size->width, size->height);
        return FALSE;
    }
    *to = g_steal_pointer(from);
    return TRUE;
}

gboolean ground_read_scans(Ground *g, const Params *p, GroundScan *sheet, GPtrArray **back_profiles, GError **error)
{
    if (!sheet)
        return read_scan(p, PARAM_SCAN_FILE, &g->scan, error) && read_back(p, &g->back, back_profiles, error);
    *back_profiles = sheet->back_profile ? g_ptr_array_ref(sheet->back_profile) : NULL;
    return lend(p, PARAM_SCAN_FILE, &sheet->size, &sheet->scan, &g->scan, error) &&
           lend(p, PARAM_SCAN_BACK, &sheet->back_size, &sheet->back, &g->back, error);
}

void ground_return_scans(Ground *g, GroundScan *sheet)
{
    if (g->scan)
        sheet->scan = g_steal_pointer(&g->scan);
    if (g->back)
        sheet->back = g_steal_pointer(&g->back);
}

/* Its own, as it becomes a texture: what lies around it. */
static gboolean part(const Ground *g, const Params *p, ParamId id, const Affine *to_scan, Scan **own, Scan **lent, GError **error)
{
    Polygon *outline = ground_outline_in(g, *own, to_scan);
    Box2 b = outline->box;
    double around = AROUND_SHARE * MAX(b.x1 - b.x0, b.y1 - b.y0) + AROUND_LEAST, w = (*own)->width, h = (*own)->height;
    double x0 = CLAMP(b.x0 - around, 0.0, w), x1 = CLAMP(b.x1 + around, 0.0, w), y0 = CLAMP(h - b.y1 - around, 0.0, h), y1 = CLAMP(h - b.y0 + around, 0.0, h);
    polygon_free(outline);
    if ((x1 - x0) * (y1 - y0) > MOST * w * h)
        return TRUE;
    *lent = *own;
    *own = scan_copy_part(*lent, (uint32_t)x0, (uint32_t)y0, (uint32_t)x1, (uint32_t)y1);
    if (!*own)
        g_set_error(error, SCAN_ERROR, SCAN_ERROR_SIZE, "%s: no memory for another copy of the image", params_text(p, id));
    return *own != NULL;
}

gboolean ground_part_scans(Ground *g, const Params *p, GroundScan *sheet, GError **error)
{
    return (!g->scan || part(g, p, PARAM_SCAN_FILE, &g->to_scan, &g->scan, &sheet->scan, error)) &&
           (!g->back || part(g, p, PARAM_SCAN_BACK, &g->to_back, &g->back, &sheet->back, error));
}
