/* SVG of a leaf for Inkscape and other drawing programs: a layer an order, a path a vein, cut off at the margin. */
#include <stdlib.h>
#include <string.h>

#include "export/export.h"
#include "export/sink.h"
#include "geom/dmath.h"

#define WIDTH_STEP                                                                                                     \
    1.03 /* a vein is one path as long as its widest and narrowest edges differ by less: not seen by eye */
#define ORDERS 256

/* Of an order with more than CROWD paths, BUNCH veinlets of one width share a path: drawing programs take a time that
 * grows faster than the number of paths. */
enum { CROWD = 4096, BUNCH = 64 };

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

/* To three digits or more, as the eye does not need: so equal widths are many. */
static double round_width(double width)
{
    double unit = 1000.0; /* a power of ten, which is exact up to 1e22 */
    while (width * unit < 100.0 && unit < 1e15)
        unit *= 10.0;
    return floor(width * unit + 0.5) / unit;
}

/* Edges that make one path. */
typedef struct {
    const uint32_t *e;
    uint32_t n;
    double width;
} Run;

/* The wider first, else in their order along the veins. */
static int by_width(const void *a, const void *b)
{
    const Run *r = a, *s = b;
    return r->width != s->width ? (r->width > s->width ? -1 : 1) : r->e < s->e ? -1 : r->e > s->e;
}

static Run *collect_runs(const Network *net, const uint32_t *e, uint32_t n, uint32_t *n_runs)
{
    Run *runs = g_new(Run, n);
    *n_runs = 0;
    for (uint32_t i = 0, k; i < n; i += k) {
        double width;
        k = run_length(net, e + i, n - i, &width);
        runs[(*n_runs)++] = (Run){e + i, k, round_width(width)};
    }
    return runs;
}

/* Veins of an order mostly are veinlets of one width; the group holds that width once for all of them. */
static double usual_width(const Run *runs, uint32_t n)
{
    Run *sorted = g_memdup2(runs, n * sizeof *runs);
    qsort(sorted, n, sizeof *sorted, by_width);
    double usual = sorted[0].width;
    for (uint32_t i = 0, k, most = 0; i < n; i += k) {
        for (k = 1; i + k < n && sorted[i + k].width == sorted[i].width;)
            k++;
        if (k >= most) {
            most = k;
            usual = sorted[i].width;
        }
    }
    g_free(sorted);
    return usual;
}

static void put_width(GString *s, double width)
{
    g_string_append(s, " stroke-width=\"");
    export_number(s, width);
    g_string_append_c(s, '"');
}

/* One path of n runs of equal width. */
static void put_path(const Network *net, const Run *run, uint32_t n, double usual, GString *s)
{
    g_string_append(s, "<path");
    if (run->width != usual)
        put_width(s, run->width);
    g_string_append(s, " d=\"");
    for (uint32_t k = 0; k < n; k++) {
        g_string_append_c(s, 'M');
        put_point(s, net->node[net->tail[run[k].e[0]]]);
        for (uint32_t i = 0; i < run[k].n; i++) {
            g_string_append_c(s, ' ');
            put_point(s, net->node[net->head[run[k].e[i]]]);
        }
    }
    g_string_append(s, "\"/>\n");
}

static void put_order(const Network *net, const PaintStyle *style, const Sorted *sorted, unsigned order, Sink *out)
{
    static const char *const name[] = {"", "primary", "secondary", "tertiary", "quaternary", "quinternary"};
    uint32_t n = sorted->start[order + 1] - sorted->start[order], n_runs;
    if (n == 0)
        return;
    Run *runs = collect_runs(net, sorted->edge + sorted->start[order], n, &n_runs);
    double rgb[3], usual = usual_width(runs, n_runs);
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
    if (n_runs > CROWD)
        qsort(runs, n_runs, sizeof *runs, by_width);
    for (uint32_t i = 0, k; i < n_runs; i += k) {
        for (k = 1; n_runs > CROWD && k < BUNCH && i + k < n_runs && runs[i + k].width == runs[i].width;)
            k++;
        put_path(net, runs + i, k, usual, out->text);
        sink_drain(out);
    }
    g_string_append(out->text, "</g>\n");
    g_free(runs);
}

static void put_blade(const Polygon *margin, const Holes *holes, const PaintStyle *style, Sink *out)
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
    g_string_append_c(out->text, 'Z');
    for (uint32_t k = 0; holes != NULL && k < holes->n; k++) { /* clockwise, so that they are holes by either rule of filling */
        for (uint32_t i = holes->start[k]; i < holes->start[k + 1]; i++) {
            g_string_append_c(out->text, i == holes->start[k] ? 'M' : ' ');
            put_point(out->text, holes->p[i]);
        }
        g_string_append_c(out->text, 'Z');
    }
    g_string_append(out->text, "\"/>\n</g>\n<clipPath id=\"inside\"><use href=\"#blade\"/></clipPath>\n");
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
    put_blade(net->margin, net->holes, style, out);
    /* veins end at the margin */
    g_string_append_printf(out->text, "<g id=\"veins\" inkscape:groupmode=\"layer\" inkscape:label=\"Veins\"%s>\n",
                           net->margin != NULL ? " clip-path=\"url(#inside)\"" : "");
    Sorted sorted = sort_edges(net);
    for (unsigned order = ORDERS; order-- > 0;) /* the primary veins lie on top */
        put_order(net, style, &sorted, order, out);
    g_free(sorted.edge);
    g_string_append(out->text, "</g>\n</svg>\n");
    return sink_close(out, error);
}
