#include "export/drawing.h"

#include "export/export.h"
#include "export/sink.h"

enum { ORDERS = 256 };

static void put_point(GString *s, Vec2 p)
{
    sink_hundredths(s, sink_round_hundredths(p.x));
    g_string_append_c(s, ',');
    sink_hundredths(s, sink_round_hundredths(p.y));
}

static void put_line(GString *s, const Affine *m, const Vec2 *v, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++) {
        g_string_append(s, i == 0 ? "M" : i == 1 ? " L" : " ");
        put_point(s, affine_apply(m, v[i]));
    }
}

static void put_text(GString *s, const char *text)
{
    char *escaped = g_markup_escape_text(text, -1);
    g_string_append(s, escaped);
    g_free(escaped);
}

static void open_layer(GString *s, const char *name, const char *more)
{
    g_string_append_printf(s, "<g inkscape:groupmode=\"layer\" id=\"%s\" inkscape:label=\"%s\"%s>\n", name, name, more);
}

static void put_scan(GString *s, const DrawingSheet *d)
{
    open_layer(s, "scan", " sodipodi:insensitive=\"true\"");
    g_string_append_printf(s, "<image width=\"%u\" height=\"%u\" preserveAspectRatio=\"none\" xlink:href=\"", d->width, d->height);
    put_text(s, d->image);
    g_string_append(s, "\"/>\n</g>\n");
}

/* Lines that show on a leaf of any size. */
static double pen(const DrawingSheet *d)
{
    return MAX(0.0015 * sqrt(d->to_scan.a * d->to_scan.a + d->to_scan.b * d->to_scan.b), 1.0);
}

static void put_outline(GString *s, const DrawingSheet *d)
{
    open_layer(s, "outline-layer", "");
    g_string_append(s, "<path id=\"outline\" style=\"fill:none;stroke:#e8590c;stroke-width:");
    sink_size(s, pen(d));
    g_string_append(s, ";stroke-linejoin:round\" d=\"");
    if (d->curves)
        g_string_append(s, d->curves);
    else
        put_line(s, &d->to_scan, d->outline->v, d->outline->n);
    g_string_append(s, d->curves ? "\"/>\n</g>\n" : " Z\"/>\n</g>\n");
}

static void put_holes(GString *s, const DrawingSheet *d)
{
    if (!d->holes || d->holes->n == 0)
        return;
    open_layer(s, "holes", " sodipodi:insensitive=\"true\"");
    for (uint32_t k = 0; k < d->holes->n; k++) {
        g_string_append_printf(s, "<path id=\"hole-%u\" style=\"fill:none;stroke:#e8590c;stroke-width:", k + 1);
        sink_size(s, pen(d));
        g_string_append(s, ";stroke-linejoin:round\" d=\"");
        put_line(s, &d->to_scan, d->holes->p + d->holes->start[k], d->holes->start[k + 1] - d->holes->start[k]);
        g_string_append(s, " Z\"/>\n");
    }
    g_string_append(s, "</g>\n");
}

static void put_mark(GString *s, const DrawingSheet *d, const char *id, Vec2 leaf)
{
    Vec2 p = affine_apply(&d->to_scan, leaf);
    g_string_append_printf(s, "<circle id=\"%s\" style=\"fill:none;stroke:#1971c2;stroke-width:", id);
    sink_size(s, pen(d));
    g_string_append(s, "\" cx=\"");
    sink_size(s, p.x);
    g_string_append(s, "\" cy=\"");
    sink_size(s, p.y);
    g_string_append(s, "\" r=\"");
    sink_size(s, 6.0 * pen(d));
    g_string_append(s, "\"/>\n");
}

static double mean_width(const DrawnVein *v)
{
    double sum = 0.0, length = 0.0;
    for (uint32_t i = 1; i < v->n; i++) {
        double piece = vec_dist(v->point[i - 1], v->point[i]);
        sum += piece * 0.5 * (v->width[i - 1] + v->width[i]);
        length += piece;
    }
    return length > 0.0 ? sum / length : 0.0;
}

static void put_order(Sink *sink, const DrawingSheet *d, uint32_t order)
{
    static const char *const name[] = {"unordered", "primary", "secondary", "tertiary", "quaternary"};
    static const char *const colour[] = {"#fab005", "#c2255c", "#7048e8", "#1c7ed6", "#0ca678"};
    GString *s = sink->text;
    double scale = sqrt(d->to_scan.a * d->to_scan.a + d->to_scan.b * d->to_scan.b);
    bool any = false;
    for (uint32_t k = 0; k < d->veins->n; k++) {
        const DrawnVein *v = &d->veins->vein[k];
        if ((d->order ? d->order[k] : v->order) != order)
            continue;
        if (!any && order < G_N_ELEMENTS(name))
            g_string_append_printf(s, "<g id=\"%s\" inkscape:label=\"%s\"", name[order], name[order]);
        else if (!any)
            g_string_append_printf(s, "<g id=\"order-%u\" inkscape:label=\"order-%u\"", order, order);
        if (!any)
            g_string_append_printf(s, " style=\"fill:none;stroke:%s;stroke-opacity:0.75;stroke-linecap:round;stroke-linejoin:round\">\n",
                                   colour[MIN(order, G_N_ELEMENTS(colour) - 1)]);
        any = true;
        double width = mean_width(v) * scale;
        g_string_append_printf(s, "<path id=\"vein-%u\" style=\"stroke-width:", k + 1);
        sink_size(s, width > 0.0 ? width : pen(d));
        g_string_append(s, "\" d=\"");
        put_line(s, &d->to_scan, v->point, v->n);
        g_string_append(s, "\"/>\n");
        sink_drain(sink);
    }
    if (any)
        g_string_append(s, "</g>\n");
}

static void put_head(GString *s, const DrawingSheet *d)
{
    g_string_append(s, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
                       "xmlns:xlink=\"http://www.w3.org/1999/xlink\" xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" "
                       "xmlns:sodipodi=\"http://sodipodi.sourceforge.net/DTD/sodipodi-0.dtd\" version=\"1.1\" ");
    if (d->mm_per_pixel > 0.0) {
        g_string_append(s, "width=\"");
        sink_size(s, d->width * d->mm_per_pixel);
        g_string_append(s, "mm\" height=\"");
        sink_size(s, d->height * d->mm_per_pixel);
        g_string_append(s, "mm\" ");
    } else {
        g_string_append_printf(s, "width=\"%u\" height=\"%u\" ", d->width, d->height);
    }
    g_string_append_printf(s, "viewBox=\"0 0 %u %u\">\n<title>", d->width, d->height);
    put_text(s, d->title);
    g_string_append(s, "</title>\n");
}

gboolean export_drawing_svg(const DrawingSheet *d, const char *path, GError **error)
{
    Sink *sink = sink_open(path, error);
    if (!sink)
        return FALSE;
    GString *s = sink->text;
    put_head(s, d);
    put_scan(s, d);
    put_outline(s, d);
    put_holes(s, d);
    open_layer(s, "marks", "");
    put_mark(s, d, "base", vec2(0.0, 0.0));
    put_mark(s, d, "tip", vec2(0.0, 1.0));
    g_string_append(s, "</g>\n");
    open_layer(s, "veins", "");
    for (uint32_t order = 0; d->veins && order < ORDERS; order++)
        put_order(sink, d, order);
    g_string_append(s, "</g>\n</svg>\n");
    return sink_close(sink, error);
}
