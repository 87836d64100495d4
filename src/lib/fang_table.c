#include "lib/fang_table.h"

#include "lib/settings.h"

/* "roberts", …, from the parameter's own choices. */
static char *operator_name(EdgesOperator op)
{
    char **all = g_strsplit(param_info(PARAM_SCAN_OPERATOR)->choices, "|", -1), *name = g_strdup(all[op]);
    g_strfreev(all);
    return name;
}

static void add_found(GString *s, const FangProfile *f, uint32_t height)
{
    const FangMatch *r = &f->region;
    Vec2 base = f->contour->v[f->base], tip = f->contour->v[f->tip];
    char *at = g_strdup_printf("%.0f,%.0f", base.x, height - base.y), *to = g_strdup_printf("%.0f,%.0f", tip.x, height - tip.y);
    g_string_append_printf(s, " %5.1f %10.0f %+9.2f %7.1f %5.0f %11s %11s %7u %7u %7.2f %7.1f", f->used.sigma, f->contour->area,
                           100.0 * (r->area / r->rough - 1.0), 100.0 * r->continuity, r->gap, at, to, f->corners->len, f->fit->n, f->fit->mean,
                           f->fit->largest);
    g_free(at);
    g_free(to);
}

/* What one operator finds, or why it finds nothing, which *none keeps, too; false with an error that has nothing to do with the operator. */
static gboolean add_row(GString *s, const Scan *scan, const FangDef *def, guint *found, GError **none, GError **error)
{
    GError *why = NULL;
    char *name = operator_name(def->edges.op);
    gint64 began = g_get_monotonic_time();
    FangProfile *f = fang_capture(scan, def, &why);
    double seconds = (double)(g_get_monotonic_time() - began) / 1e6;
    g_string_append_printf(s, "%-9s", name);
    g_free(name);
    if (f) {
        add_found(s, f, scan->height);
        g_string_append_printf(s, " %6.2f\n", seconds);
        ++*found;
    } else if (g_error_matches(why, SCAN_ERROR, SCAN_ERROR_NO_LEAF) || why->domain == EDGES_ERROR) {
        g_string_append_printf(s, " %s\n", why->message);
        g_clear_error(none);
        *none = why;
    } else {
        g_propagate_error(error, why);
        return FALSE;
    }
    fang_profile_free(f);
    return TRUE;
}

char *fang_table(const Params *p, const Scan *scan, GError **error)
{
    FangDef def;
    if (!settings_fang(p, scan->height, &def, error))
        return NULL;
    GString *s = g_string_new(
        "Edge operators compared (Fang and Shen 2013, section 3.2). off: pixels enclosed against the leaf by its level, percent. edges: share of\n"
        "the margin that has an edge, percent, and gap: the longest stretch without, pixels; where that is not 0, the operator alone gives no closed\n"
        "contour, and the strongest response bridges it. points: characteristic points. mean, most: what the Bézier curves are off the contour,\n"
        "pixels. s: seconds.\n\n"
        "operator  sigma       area       off   edges   gap        base         tip  points  curves    mean    most      s\n");
    gboolean ok = TRUE;
    guint found = 0;
    GError *none = NULL;
    for (EdgesOperator op = EDGES_ROBERTS; ok && op <= EDGES_CANNY; op++) {
        def.edges.op = op;
        ok = add_row(s, scan, &def, &found, &none, error);
    }
    if (ok && found == 0) { /* a table of nothing is no table */
        g_propagate_error(error, g_steal_pointer(&none));
        ok = FALSE;
    }
    g_clear_error(&none);
    return g_string_free(s, !ok);
}
