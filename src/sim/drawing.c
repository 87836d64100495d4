#include "sim/drawing_private.h"

G_DEFINE_QUARK(venation-drawing-error-quark, drawing_error)

Drawing *drawing_new(void) { return g_new0(Drawing, 1); }

void drawing_free(Drawing *d)
{
    if (!d)
        return;
    for (uint32_t k = 0; k < d->n; k++) {
        g_free(d->vein[k].point);
        g_free(d->vein[k].width);
        g_free(d->vein[k].name);
    }
    g_free(d->vein);
    g_free(d);
}

DrawnVein *drawing_add(Drawing *d, const Vec2 *point, const double *width, uint32_t n, uint8_t order, const char *name)
{
    if ((d->n & (d->n - 1)) == 0) /* room grows at powers of two */
        d->vein = g_renew(DrawnVein, d->vein, d->n ? 2 * (gsize)d->n : 1);
    DrawnVein *v = &d->vein[d->n++];
    *v = (DrawnVein){.point = g_new(Vec2, n), .width = g_new0(double, n), .n = n, .order = order, .name = g_strdup(name)};
    for (uint32_t i = 0; i < n; i++) {
        v->point[i] = point[i];
        v->width[i] = width ? width[i] : 0.0;
    }
    return v;
}

void drawing_to_leaf(Drawing *d, Vec2 base, Vec2 tip)
{
    Vec2 up = vec_sub(tip, base);
    double length2 = vec_norm2(up), length = sqrt(length2);
    g_return_if_fail(length > 0.0);
    for (uint32_t k = 0; k < d->n; k++)
        for (uint32_t i = 0; i < d->vein[k].n; i++) {
            Vec2 p = vec_sub(d->vein[k].point[i], base);
            d->vein[k].point[i] = vec2(vec_cross(p, up) / length2, vec_dot(p, up) / length2);
            d->vein[k].width[i] /= length;
        }
}

DrawingDef drawing_def_default(void)
{
    return (DrawingDef){.length = 100.0, .snap = 0.015, .gap = 0.05, .where = "drawing", .widths = width_def_default()};
}

char *drawing_vein_text(const Drawing *d, uint32_t vein)
{
    const char *name = d->vein[vein].name;
    return name ? g_strdup(name) : g_strdup_printf("vein %u", vein + 1);
}

static bool check_def(const DrawingDef *def, GError **error)
{
    const struct {
        const char *name;
        double value, least, most;
    } is[] = {{"length", def->length, 1e-6, 1e9}, {"snap", def->snap, 0.0, 1e6}, {"gap", def->gap, 0.0, 1e6}};
    for (gsize k = 0; k < G_N_ELEMENTS(is); k++)
        if (!(is[k].value >= is[k].least && is[k].value <= is[k].most)) {
            g_set_error(error, DRAWING_ERROR, DRAWING_ERROR_VALUE, "%s: %s is %g; it must be from %g to %g", def->where, is[k].name,
                        is[k].value, is[k].least, is[k].most);
            return false;
        }
    return true;
}

static void sketch_init(Sketch *s, const Drawing *d, const DrawingDef *def, const Polygon *blade)
{
    *s = (Sketch){.drawing = d, .def = def, .blade = blade, .snap = def->snap * def->length, .gap = def->gap * def->length};
    s->line = g_array_new(FALSE, FALSE, sizeof(Line));
    s->cut = g_array_new(FALSE, FALSE, sizeof(Cut));
    s->node = g_array_new(FALSE, FALSE, sizeof(Vec2));
    s->edge = g_array_new(FALSE, FALSE, sizeof(SketchEdge));
}

static void sketch_clear(Sketch *s)
{
    g_free(s->spot);
    g_free(s->line_of);
    g_array_unref(s->line);
    g_array_unref(s->cut);
    g_array_unref(s->node);
    g_array_unref(s->edge);
}

static Network *open_sketch(const Sketch *s, Polygon *blade)
{
    uint32_t *line;
    double *width;
    Network *net = sketch_open(s, &line, &width);
    net->margin = blade;
    sketch_complete(s, net, line, width);
    g_free(line);
    g_free(width);
    return net;
}

Network *drawing_network(const Drawing *d, const Polygon *leaf, const DrawingDef *def, GError **error)
{
    if (!check_def(def, error))
        return NULL;
    Polygon *blade = polygon_scaled(leaf, def->length);
    Network *net = NULL;
    Sketch s;
    sketch_init(&s, d, def, blade);
    bool good = sketch_take(&s, error);
    if (good) {
        sketch_absorb(&s);
        sketch_join(&s);
        sketch_divide(&s);
        sketch_bridge(&s);
        good = s.edge->len > 0;
        if (!good)
            g_set_error(error, DRAWING_ERROR, DRAWING_ERROR_EMPTY, "%s: all veins are too short; one must be longer than %g segments",
                        def->where, drawing_least);
    }
    if (good)
        net = open_sketch(&s, g_steal_pointer(&blade));
    sketch_clear(&s);
    polygon_free(blade);
    return net;
}
