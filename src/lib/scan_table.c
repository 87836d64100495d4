/* Nodes of a captured outline by square size and tolerance (Hong 2005, tables 5.1 and 5.2). */
#include "lib/fang_table.h"
#include "lib/leaf.h"
#include "lib/settings.h"

static Profile *capture(const Scan *scan, ProfileDef def, uint32_t square, double tolerance, GError **error)
{
    def.each = false;
    def.square = square;
    def.tolerance = tolerance;
    GPtrArray *all = profile_capture(scan, &def, NULL, error);
    Profile *first = all ? g_ptr_array_steal_index(all, 0) : NULL;
    if (all)
        g_ptr_array_unref(all);
    return first;
}

static gboolean add_row(GString *s, const Scan *scan, const ProfileDef *def, uint32_t square, GError **error)
{
    static const double tolerance[] = {0, 0.5, 1, 2, 4, 8, 16};
    for (gsize i = 0; i < G_N_ELEMENTS(tolerance); i++) {
        Profile *f = capture(scan, *def, square, tolerance[i], error);
        if (!f)
            return FALSE;
        if (i == 0)
            g_string_append_printf(s, "%6u %12.0f %10.1f", square, f->area, f->perimeter);
        g_string_append_printf(s, " %8u", f->outline->n);
        profile_free(f);
    }
    g_string_append_c(s, '\n');
    return TRUE;
}

static char *node_table(const Params *p, const Scan *scan, GError **error)
{
    static const uint32_t square[] = {1, 2, 4, 8, 16};
    ProfileDef def = settings_profile(p, scan->height);
    GString *s = g_string_new("Nodes of the outline by side of the marching square and tolerance, pixels\n\n"
                              "square         area  perimeter    tol 0      0.5        1        2        4        8       16\n");
    gboolean ok = TRUE;
    for (gsize i = 0; ok && i < G_N_ELEMENTS(square); i++)
        ok = add_row(s, scan, &def, square[i], error);
    return g_string_free(s, !ok);
}

char *ven_scan_table(const VenParams *params, GError **error)
{
    const Params *p = params->values;
    const char *file = params_text(p, PARAM_SCAN_FILE);
    Scan *scan = scan_read(file, 0, error);
    if (!scan)
        return NULL;
    char *text = params_choice(p, PARAM_SCAN_METHOD) == 0 ? node_table(p, scan, error) : fang_table(p, scan, error);
    scan_free(scan);
    if (!text)
        g_prefix_error(error, "%s: ", file);
    return text;
}
