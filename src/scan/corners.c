#include "scan/corners.h"

#define LARGEST 100.0 /* of a sigma */

G_DEFINE_QUARK(venation-corners-error-quark, corners_error)

CornersDef corners_def_default(void)
{
    return (CornersDef){.smoothing = 1.0, .window = 2.0, .k = 0.04, .threshold = 0.02, .spacing = 8.0, .size = 1200.0};
}

/* --- checks --- */

static bool fail(GError **error, CornersError code, const char *format, ...) G_GNUC_PRINTF(3, 4);

static bool fail(GError **error, CornersError code, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    GError *e = g_error_new_valist(CORNERS_ERROR, (int)code, format, args);
    va_end(args);
    g_propagate_error(error, e);
    return false;
}

static bool check_range(const char *name, double value, double least, double most, GError **error)
{
    return (value >= least && value <= most) ||
           fail(error, CORNERS_ERROR_SETTINGS, "the corners' %s is %g; it must lie between %g and %g", name, value, least, most);
}

bool corners_check(const CornersDef *def, GError **error)
{
    return check_range("smoothing", def->smoothing, 0.0, LARGEST, error) && check_range("window", def->window, 0.5, LARGEST, error) &&
           check_range("k", def->k, 0.0, 0.25, error) && check_range("threshold", def->threshold, 0.0, 1.0, error) &&
           check_range("spacing", def->spacing, 0.0, 1e9, error) && check_range("size", def->size, 0.0, 1e9, error);
}

static bool check_contour(const Vec2 *v, uint32_t n, uint32_t base, uint32_t tip, GError **error)
{
    if (n < 3)
        return fail(error, CORNERS_ERROR_CONTOUR, "the contour has %u points; it must have 3 or more", n);
    for (uint32_t i = 0; i < n; i++)
        if (!(fabs(v[i].x) <= 1e9 && fabs(v[i].y) <= 1e9))
            return fail(error, CORNERS_ERROR_CONTOUR, "point %u of the contour is no number between -1e9 and 1e9", i);
    if (base >= n || tip >= n || base == tip)
        return fail(error, CORNERS_ERROR_CONTOUR, "base and tip are points %u and %u; they must be two of the contour's %u", base, tip, n);
    return true;
}

/* --- response --- */

static void grey_range(const GreyImage *in, double *least, double *most)
{
    *least = *most = (double)in->px[0];
    for (gsize i = 1; i < (gsize)in->width * in->height; i++) {
        *least = MIN(*least, (double)in->px[i]);
        *most = MAX(*most, (double)in->px[i]);
    }
}

/* The image with that grey range from 0 to 1; 0 if it has none. */
static GreyImage *normalised(const GreyImage *in, double least, double most)
{
    GreyImage *out = grey_image_new(in->width, in->height);
    for (gsize i = 0; i < (gsize)in->width * in->height && most > least; i++)
        out->px[i] = (float)(((double)in->px[i] - least) / (most - least));
    return out;
}

/* Replaces *a by the windowed sum of a b. */
static GreyImage *windowed(const GreyImage *a, const GreyImage *b, double sigma)
{
    GreyImage *product = grey_image_new(a->width, a->height);
    for (gsize i = 0; i < (gsize)a->width * a->height; i++)
        product->px[i] = a->px[i] * b->px[i];
    GreyImage *out = edges_smooth(product, sigma, NULL);
    g_assert(out);
    grey_image_free(product);
    return out;
}

static GreyImage *respond(const GreyImage *in, double least, double most, const CornersDef *def)
{
    GreyImage *unit = normalised(in, least, most), *soft = edges_smooth(unit, def->smoothing, NULL), *gx, *gy;
    grey_image_free(unit);
    edges_gradient(soft, EDGES_SOBEL, &gx, &gy);
    grey_image_free(soft);
    GreyImage *xx = windowed(gx, gx, def->window), *xy = windowed(gx, gy, def->window), *yy = windowed(gy, gy, def->window);
    for (gsize i = 0; i < (gsize)in->width * in->height; i++) {
        double a = (double)xx->px[i], b = (double)xy->px[i], c = (double)yy->px[i];
        xx->px[i] = (float)(a * c - b * b - def->k * (a + c) * (a + c));
    }
    GreyImage *const spent[] = {gx, gy, xy, yy};
    for (uint32_t i = 0; i < G_N_ELEMENTS(spent); i++)
        grey_image_free(spent[i]);
    return xx;
}

GreyImage *corners_response_in(const GreyImage *part, double least, double most, const CornersDef *def, GError **error)
{
    if (!corners_check(def, error))
        return NULL;
    GreyImage *known = edges_smooth(part, 0.0, error), *out = known ? respond(part, least, most, def) : NULL; /* for its checks */
    grey_image_free(known);
    return out;
}

GreyImage *corners_response(const GreyImage *in, const CornersDef *def, GError **error)
{
    double least = 0.0, most = 0.0;
    if (in->width > 0 && in->height > 0)
        grey_range(in, &least, &most);
    return corners_response_in(in, least, most, def, error);
}

/* --- on the contour --- */

typedef struct {
    const Vec2 *v;
    uint32_t n;
    double *along;    /* [n + 1] way from vertex 0; the last is the whole */
    double *response; /* [n] */
} Contour;

static uint32_t next(const Contour *c, uint32_t i) { return i + 1 < c->n ? i + 1 : 0; }
static uint32_t before(const Contour *c, uint32_t i) { return i > 0 ? i - 1 : c->n - 1; }

/* Way along the contour from i to j, the shorter way round. */
static double way(const Contour *c, uint32_t i, uint32_t j)
{
    double d = fabs(c->along[i] - c->along[j]);
    return MIN(d, c->along[c->n] - d);
}

static double pixel(const CornersField *f, double x, double y)
{
    double i = CLAMP(x, 0.0, (double)(f->width - 1)), j = CLAMP(y, 0.0, (double)(f->height - 1));
    return (double)f->read(f->user, (uint32_t)i, (uint32_t)j);
}

/* Bilinear between the middles of pixels. */
static double read_between(const CornersField *g, Vec2 p)
{
    double x = floor(p.x - 0.5), y = floor(p.y - 0.5), fx = p.x - 0.5 - x, fy = p.y - 0.5 - y;
    double above = pixel(g, x, y) * (1.0 - fx) + pixel(g, x + 1.0, y) * fx;
    double below = pixel(g, x, y + 1.0) * (1.0 - fx) + pixel(g, x + 1.0, y + 1.0) * fx;
    return above * (1.0 - fy) + below * fy;
}

/* The stretch of vertices within `reach` of i either way, at most once round. */
static void stretch(const Contour *c, uint32_t i, double reach, uint32_t *from, uint32_t *to)
{
    *from = *to = i;
    while (next(c, *to) != i && way(c, i, next(c, *to)) <= reach)
        *to = next(c, *to);
    while (before(c, *from) != *to && way(c, i, before(c, *from)) <= reach)
        *from = before(c, *from);
}

/* Mean place of the vertices around i: rid of the steps of pixels, and at a corner shifted inwards, where its response is greatest. */
static Vec2 middle(const Contour *c, uint32_t i, double reach)
{
    uint32_t from, to, count = 1;
    stretch(c, i, reach, &from, &to);
    Vec2 sum = c->v[to];
    for (uint32_t j = from; j != to; j = next(c, j), count++)
        sum = vec_add(sum, c->v[j]);
    return vec_scale(sum, 1.0 / count);
}

static Contour contour_new(const Vec2 *v, uint32_t n, const CornersField *response, double reach)
{
    Contour c = {v, n, g_new(double, (gsize)n + 1), g_new(double, n)};
    c.along[0] = 0.0;
    for (uint32_t i = 0; i < n; i++)
        c.along[i + 1] = c.along[i] + vec_dist(v[i], v[next(&c, i)]);
    for (uint32_t i = 0; i < n; i++)
        c.response[i] = read_between(response, middle(&c, i, reach));
    return c;
}

static void contour_clear(Contour *c)
{
    g_free(c->along);
    g_free(c->response);
}

/* The vertex within `reach` of i that is farthest from the chord of that stretch; of equals the nearest to i, i itself before all. */
static uint32_t sharpest(const Contour *c, uint32_t i, double reach)
{
    uint32_t from, to, best = i;
    stretch(c, i, reach, &from, &to);
    Vec2 a = c->v[from], chord = vec_sub(c->v[to], a);
    double most = fabs(vec_cross(chord, vec_sub(c->v[i], a)));
    for (uint32_t j = from; j != to; j = next(c, j)) {
        double d = fabs(vec_cross(chord, vec_sub(c->v[j], a)));
        if (d > most || (d == most && way(c, i, j) < way(c, i, best))) {
            most = d;
            best = j;
        }
    }
    return best;
}

/* Local maxima; of a run of equal values the first. */
static GArray *candidates(const Contour *c, const CornersDef *def)
{
    GArray *found = g_array_new(FALSE, FALSE, sizeof(Corner));
    double most = 0.0;
    for (uint32_t i = 0; i < c->n; i++)
        most = MAX(most, c->response[i]);
    for (uint32_t i = 0; i < c->n; i++) {
        double r = c->response[i];
        if (!(r > 0.0 && r >= def->threshold * most && r > c->response[before(c, i)] && r >= c->response[next(c, i)]))
            continue;
        Corner corner = {sharpest(c, i, MIN(3.0 * (def->smoothing + def->window), def->spacing)), r};
        g_array_append_val(found, corner);
    }
    return found;
}

static int by_response(gconstpointer a, gconstpointer b, gpointer user)
{
    const Corner *p = a, *q = b;
    return p->response != q->response ? (p->response > q->response ? -1 : 1) : (p->at > q->at) - (p->at < q->at);
}

static int by_place(gconstpointer a, gconstpointer b)
{
    const Corner *p = a, *q = b;
    return (p->at > q->at) - (p->at < q->at);
}

/* Whether no kept point is nearer than `spacing`. */
static bool has_room(const Contour *c, const GArray *kept, uint32_t at, double spacing)
{
    for (guint k = 0; k < kept->len; k++) {
        uint32_t other = g_array_index(kept, Corner, k).at;
        if (other == at || way(c, other, at) < spacing)
            return false;
    }
    return true;
}

CornersDef corners_scaled(const CornersDef *def, const Vec2 *v, uint32_t n)
{
    Box2 box = box_empty();
    for (uint32_t i = 0; i < n; i++)
        box = box_add(box, v[i]);
    double extent = vec_dist(vec2(box.x0, box.y0), vec2(box.x1, box.y1)), by = def->size > 0.0 ? MAX(extent / def->size, 1.0) : 1.0;
    CornersDef out = *def;
    out.smoothing = MIN(by * def->smoothing, LARGEST);
    out.window = MIN(by * def->window, LARGEST);
    out.spacing = by * def->spacing;
    out.size = 0.0;
    return out;
}

GArray *corners_choose(const CornersField *response, const Vec2 *v, uint32_t n, uint32_t base, uint32_t tip, const CornersDef *def, GError **error)
{
    if (!check_contour(v, n, base, tip, error) || !corners_check(def, error))
        return NULL;
    Contour c = contour_new(v, n, response, def->window);
    GArray *found = candidates(&c, def), *kept = g_array_new(FALSE, FALSE, sizeof(Corner));
    g_array_sort_with_data(found, by_response, NULL);
    const Corner ends[2] = {{base, c.response[base]}, {tip, c.response[tip]}};
    g_array_append_vals(kept, ends, 2);
    for (guint k = 0; k < found->len; k++) {
        Corner corner = g_array_index(found, Corner, k);
        if (has_room(&c, kept, corner.at, def->spacing))
            g_array_append_val(kept, corner);
    }
    g_array_sort(kept, by_place);
    g_array_unref(found);
    contour_clear(&c);
    return kept;
}

static float read_image(const void *user, uint32_t x, uint32_t y)
{
    const GreyImage *g = user;
    return g->px[(gsize)y * g->width + x];
}

GArray *corners_find(const GreyImage *in, const Vec2 *v, uint32_t n, uint32_t base, uint32_t tip, const CornersDef *def, GError **error)
{
    if (!check_contour(v, n, base, tip, error) || !corners_check(def, error))
        return NULL;
    CornersDef used = corners_scaled(def, v, n);
    GreyImage *response = corners_response(in, &used, error);
    if (!response)
        return NULL;
    CornersField field = {in->width, in->height, read_image, response};
    GArray *kept = corners_choose(&field, v, n, base, tip, &used, error);
    grey_image_free(response);
    return kept;
}
