/* SVG of a leaf for Inkscape and other drawing programs: a layer an order, a path a vein. */
#include <string.h>

#include "export/export.h"
#include "export/sink.h"
#include "geom/dmath.h"

#define WIDTH_STEP                                                                                                     \
    1.03 /* a vein is one path as long as its widest and narrowest edges differ by less: not seen by eye */
#define ORDERS 256

/* Edges order by order, vein by vein, and along each vein from its origin. */
typedef struct {
    uint32_t *edge;
    uint32_t start[ORDERS + 1]; /* of each order's edges */
} Sorted;

/* Linear light to the 8-bit sRGB code value (IEC 61966-2-1). */
static unsigned srgb_code(double c)
{
    double v = !(c > 0.0) ? 0.0 : c > 1.0 ? 1.0 : c;
    v = v <= 0.0031308 ? 12.92 * v : 1.055 * dmath_pow(v, 1.0 / 2.4) - 0.055;
    return (unsigned)(v * 255.0 + 0.5);
}

static void put_colour(GString *s, const double rgb[3])
{
    g_string_append_printf(s, "#%02x%02x%02x", srgb_code(rgb[0]), srgb_code(rgb[1]), srgb_code(rgb[2]));
}

/* Finer veins shade towards the blade, as they do on the leaf, but stay visible. */
static void order_colour(const PaintStyle *style, unsigned order, double rgb[3])
{
    double vein = 1.0;
    for (unsigned k = 1; k < order && vein > 0.35; k++)
        vein *= 0.8;
    for (int i = 0; i < 3; i++)
        rgb[i] = (double)style->lamina[i] + ((double)style->vein[i] - (double)style->lamina[i]) * vein;
}

/* Text for XML: valid UTF-8 without the control characters that XML 1.0 forbids. */
static void put_xml(GString *s, const char *text)
{
    char *valid = g_utf8_make_valid(text, -1);
    for (char *c = valid; *c != '\0'; c++)
        if ((unsigned char)*c < 0x20 || *c == 0x7f)
            *c = ' ';
    char *escaped = g_markup_escape_text(valid, -1);
    g_string_append(s, escaped);
    g_free(escaped);
    g_free(valid);
}

/* One stable pass of a radix sort by key[edge]. */
static void sort_pass(const uint32_t *from, uint32_t *to, uint32_t n, const uint32_t *key)
{
    uint32_t last = 0;
    for (uint32_t i = 0; i < n; i++)
        last = MAX(last, key[i]);
    uint32_t *at = g_new0(uint32_t, (gsize)last + 2);
    for (uint32_t i = 0; i < n; i++)
        at[(gsize)key[i] + 1]++;
    for (gsize k = 0; k <= last; k++)
        at[k + 1] += at[k];
    for (uint32_t i = 0; i < n; i++)
        to[at[key[from[i]]]++] = from[i];
    g_free(at);
}

/* Index order runs from base to extremities, so within a vein the tails put its edges in their order along it. */
static Sorted sort_edges(const Network *net)
{
    Sorted s = {.edge = g_new(uint32_t, (gsize)net->n_edges + 1)};
    uint32_t *spare = g_new(uint32_t, (gsize)net->n_edges + 1), at[ORDERS + 1] = {0};
    for (uint32_t e = 0; e < net->n_edges; e++) {
        spare[e] = e;
        at[net->order[e] + 1]++;
    }
    sort_pass(spare, s.edge, net->n_edges, net->tail);
    sort_pass(s.edge, spare, net->n_edges, net->vein);
    for (int k = 0; k < ORDERS; k++)
        at[k + 1] += at[k];
    memcpy(s.start, at, sizeof at);
    for (uint32_t i = 0; i < net->n_edges; i++)
        s.edge[at[net->order[spare[i]]]++] = spare[i];
    g_free(spare);
    return s;
}

static void put_point(GString *s, Vec2 p)
{
    sink_hundredths(s, sink_round_hundredths(p.x));
    g_string_append_c(s, ',');
    sink_hundredths(s, sink_round_hundredths(-p.y)); /* SVG's y runs down */
}

/* How many of the edges from e[0] on make one path: connected, of one vein, of about one width. */
static uint32_t run_length(const Network *net, const uint32_t *e, uint32_t n, double *width)
{
    double low = net->width[e[0]], high = low;
    uint32_t k = 1;
    for (; k < n && net->vein[e[k]] == net->vein[e[0]] && net->tail[e[k]] == net->head[e[k - 1]]; k++) {
        double w = net->width[e[k]], l = w < low ? w : low, h = w > high ? w : high;
        if (h > l * WIDTH_STEP)
            break;
        low = l;
        high = h;
    }
    *width = 0.5 * (low + high);
    return k;
}

static void put_width(GString *s, double width)
{
    g_string_append(s, " stroke-width=\"");
    export_number(s, width < 0.1 ? width : floor(width * 1000.0 + 0.5) / 1000.0);
    g_string_append_c(s, '"');
}

static void put_run(const Network *net, const uint32_t *e, uint32_t n, double width, double usual, GString *s)
{
    g_string_append(s, "<path");
    if (width != usual)
        put_width(s, width);
    g_string_append(s, " d=\"M");
    put_point(s, net->node[net->tail[e[0]]]);
    for (uint32_t i = 0; i < n; i++) {
        g_string_append_c(s, ' ');
        put_point(s, net->node[net->head[e[i]]]);
    }
    g_string_append(s, "\"/>\n");
}

/* Veins of an order mostly end as veinlets of its least width; the group holds that width once for all of them. */
static double usual_width(const Network *net, const uint32_t *e, uint32_t n)
{
    double w = net->width[e[0]];
    for (uint32_t i = 1; i < n; i++)
        w = net->width[e[i]] < w ? net->width[e[i]] : w;
    return w;
}

static void put_order(const Network *net, const PaintStyle *style, const Sorted *sorted, unsigned order, Sink *out)
{
    static const char *const name[] = {"", "primary", "secondary", "tertiary", "quaternary", "quinternary"};
    const uint32_t *e = sorted->edge + sorted->start[order];
    uint32_t n = sorted->start[order + 1] - sorted->start[order];
    if (n == 0)
        return;
    double rgb[3], usual = usual_width(net, e, n);
    order_colour(style, order, rgb);
    g_string_append_printf(out->text,
                           "<g id=\"order-%u\" data-order=\"%u\" inkscape:groupmode=\"layer\" "
                           "inkscape:label=\"Order %u%s%s\"\n fill=\"none\" stroke-linecap=\"round\" "
                           "stroke-linejoin=\"round\" stroke=\"",
                           order, order, order, order > 0 && order < G_N_ELEMENTS(name) ? ", " : "",
                           order < G_N_ELEMENTS(name) ? name[order] : "");
    put_colour(out->text, rgb);
    g_string_append_c(out->text, '"');
    put_width(out->text, usual);
    g_string_append(out->text, ">\n");
    for (uint32_t i = 0; i < n;) {
        double width;
        uint32_t k = run_length(net, e + i, n - i, &width);
        put_run(net, e + i, k, width, usual, out->text);
        sink_drain(out);
        i += k;
    }
    g_string_append(out->text, "</g>\n");
}

static void put_blade(const Polygon *margin, const PaintStyle *style, Sink *out)
{
    if (margin == NULL)
        return;
    double rgb[3] = {(double)style->lamina[0], (double)style->lamina[1], (double)style->lamina[2]};
    g_string_append(
        out->text,
        "<g id=\"lamina\" inkscape:groupmode=\"layer\" inkscape:label=\"Blade\">\n<path id=\"blade\" fill=\"");
    put_colour(out->text, rgb);
    g_string_append(out->text, "\" d=\"M");
    for (uint32_t i = 0; i < margin->n; i++) {
        if (i > 0)
            g_string_append_c(out->text, ' ');
        put_point(out->text, margin->v[i]);
        sink_drain(out);
    }
    g_string_append(out->text, "Z\"/>\n</g>\n");
}

static void put_head(const Network *net, const Frame *frame, const char *title, GString *s)
{
    g_string_append_printf(
        s,
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" "
        "version=\"1.1\"\n width=\"%u\" height=\"%u\" viewBox=\"",
        frame->width, frame->height);
    double box[4] = {frame->corner.x, -frame->corner.y, frame->width / frame->scale, frame->height / frame->scale};
    for (int i = 0; i < 4; i++) {
        if (i > 0)
            g_string_append_c(s, ' ');
        export_number(s, floor(box[i] * 1e4 + 0.5) / 1e4);
    }
    g_string_append(s, "\">\n<title>");
    put_xml(s, title != NULL && title[0] != '\0' ? title : "Leaf");
    g_string_append_printf(s,
                           "</title>\n<desc>Leaf venation: %u nodes, %u edges, %u veins. One unit is one vein segment; "
                           "the leaf base is the origin.</desc>\n",
                           net->n_nodes, net->n_edges, net->n_veins);
}

gboolean export_svg(const Network *net, const Frame *frame, const PaintStyle *style, const char *title,
                    const char *path, GError **error)
{
    Sink *out = sink_open(path, error);
    if (out == NULL)
        return FALSE;
    put_head(net, frame, title, out->text);
    put_blade(net->margin, style, out);
    Sorted sorted = sort_edges(net);
    for (unsigned order = ORDERS; order-- > 0;) /* the primary veins lie on top */
        put_order(net, style, &sorted, order, out);
    g_free(sorted.edge);
    g_string_append(out->text, "</svg>\n");
    return sink_close(out, error);
}
