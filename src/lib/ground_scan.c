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
    ProfileDef def = settings_profile(p, sheet->scan->height);
    def.each = true;
    def.has_base = def.has_tip = false;
    sheet->profile = profile_capture(sheet->scan, &def, &sheet->threshold, error);
    return (sheet->profile || ground_blame(p, PARAM_SCAN_FILE, error)) && read_back(p, &sheet->back, &sheet->back_profile, error);
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

/* Its own, as it becomes a texture; of a leaf that was found already only what lies around it. */
static gboolean copy_scan(const Params *p, ParamId id, const Scan *from, const Profile *leaf, Scan **to, GError **error)
{
    if (from && leaf) {
        Box2 b = leaf->outline->box;
        double around = AROUND_SHARE * MAX(b.x1 - b.x0, b.y1 - b.y0) + AROUND_LEAST, top = from->height - b.y1 - around;
        *to = scan_copy_part(from, (uint32_t)MAX(0.0, b.x0 - around), (uint32_t)MAX(0.0, top), (uint32_t)MAX(0.0, b.x1 + around),
                             (uint32_t)MAX(0.0, from->height - b.y0 + around));
    } else {
        *to = from ? scan_copy(from) : NULL;
    }
    if (from && !*to)
        g_set_error(error, SCAN_ERROR, SCAN_ERROR_SIZE, "%s: no memory for another copy of the image", params_text(p, id));
    return !from || *to;
}

gboolean ground_read_scans(Ground *g, const Params *p, const GroundScan *sheet, GPtrArray **back_profiles, GError **error)
{
    if (!sheet)
        return read_scan(p, PARAM_SCAN_FILE, &g->scan, error) && read_back(p, &g->back, back_profiles, error);
    *back_profiles = sheet->back_profile ? g_ptr_array_ref(sheet->back_profile) : NULL;
    gint64 which = params_integer(p, PARAM_SCAN_LEAF);
    uint32_t base, tip;
    params_list(p, PARAM_SCAN_BASE, &base);
    params_list(p, PARAM_SCAN_TIP, &tip);
    bool own = base || tip || params_choice(p, PARAM_SCAN_METHOD) != 0 || *params_text(p, PARAM_OUTLINE_FILE) || *params_text(p, PARAM_OUTLINE_PATH) ||
               which > sheet->profile->len;
    const Profile *leaf = own ? NULL : sheet->profile->pdata[which - 1]; /* what it isn't when it was given away */
    return copy_scan(p, PARAM_SCAN_FILE, sheet->scan, leaf, &g->scan, error) &&
           copy_scan(p, PARAM_SCAN_BACK, sheet->back, NULL, &g->back, error);
}
