#include "batch/labels.h"

#include "export/export.h"
#include "export/sink.h"
#include "geom/simplify.h"
#include "lib/writer.h"
#include "sim/areole.h"

static const double tolerance = 0.25; /* pixels */

const char *label_category(int id)
{
    static const char *const name[] = {"", "lamina", "areole", "vein"};
    return name[id];
}

static void put(GString *s, double value) { sink_hundredths(s, sink_round_hundredths(value)); }

static void put_box(GString *s, Box2 box)
{
    g_string_append(s, "\"bbox\": [");
    put(s, box.x0);
    g_string_append(s, ", ");
    put(s, box.y0);
    g_string_append(s, ", ");
    put(s, box.x1 - box.x0);
    g_string_append(s, ", ");
    put(s, box.y1 - box.y0);
    g_string_append_c(s, ']');
}

/* Leaf coordinates to pixels. */
static Vec2 pixel(const Frame *f, Vec2 p) { return vec2((p.x - f->corner.x) * f->scale, (f->corner.y - p.y) * f->scale); }

/* A ring in pixels, closed by its first point, whose point farthest from it is kept so that it can't fall together. */
static void put_ring(GString *s, const Vec2 *closed, uint32_t n, double area, int category)
{
    uint32_t *keep = g_new(uint32_t, n + 1), far = 0;
    bool *must = g_new0(bool, n + 1);
    Box2 box = box_empty();
    for (uint32_t i = 0; i < n; i++) {
        far = vec_dist(closed[i], closed[0]) > vec_dist(closed[far], closed[0]) ? i : far;
        box = box_add(box, closed[i]);
    }
    must[far] = true;
    uint32_t kept = simplify_polyline(closed, n + 1, tolerance, must, keep) - 1; /* the last is the first */
    if (kept < 3)
        kept = n;
    g_string_append_printf(s, "{\"category_id\": %d, \"segmentation\": [[", category);
    for (uint32_t i = 0; i < kept; i++) {
        Vec2 p = closed[kept == n ? i : keep[i]];
        g_string_append(s, i ? ", " : "");
        put(s, p.x);
        g_string_append(s, ", ");
        put(s, p.y);
    }
    g_string_append(s, "]], \"area\": ");
    put(s, area);
    g_string_append(s, ", ");
    put_box(s, box);
    g_string_append(s, ", \"iscrowd\": 0}\n");
    g_free(keep);
    g_free(must);
}

static void put_lamina(GString *s, const Polygon *margin, const Frame *f)
{
    Vec2 *ring = g_new(Vec2, margin->n + 1);
    for (uint32_t i = 0; i <= margin->n; i++)
        ring[i] = pixel(f, margin->v[i % margin->n]);
    put_ring(s, ring, margin->n, margin->area * f->scale * f->scale, LABEL_LAMINA);
    g_free(ring);
}

static void put_areoles(Sink *out, const Network *net, const Frame *f)
{
    Areoles *a = network_areoles(net);
    GArray *ring = g_array_new(FALSE, FALSE, sizeof(Vec2));
    for (uint32_t i = 0; i < a->n; i++) {
        uint32_t outer = a->first[i], from = a->ring[outer], n = a->ring[outer + 1] - from;
        g_array_set_size(ring, n + 1);
        for (uint32_t k = 0; k <= n; k++)
            g_array_index(ring, Vec2, k) = pixel(f, a->place[a->node[from + k % n]]);
        put_ring(out->text, (const Vec2 *)(const void *)ring->data, n, a->area[i] * f->scale * f->scale, LABEL_AREOLE);
        sink_drain(out);
    }
    g_array_free(ring, TRUE);
    areoles_free(a);
}

/* Runs of pixels down the columns, outside first, as COCO has them. */
static void put_veins(GString *s, const Plane *mask)
{
    uint32_t w = mask->width, h = mask->height;
    uint64_t run = 0, area = 0;
    bool inside = false, first = true;
    Box2 box = box_empty();
    g_string_append_printf(s, "{\"category_id\": %d, \"segmentation\": {\"size\": [%u, %u], \"counts\": [", LABEL_VEIN, h, w);
    for (uint32_t x = 0; x < w; x++)
        for (uint32_t y = 0; y < h; y++) {
            bool vein = mask->px[(gsize)y * w + x] >= 0.5f;
            if (vein != inside) {
                g_string_append_printf(s, first ? "%" G_GUINT64_FORMAT : ", %" G_GUINT64_FORMAT, run);
                first = false;
                inside = vein;
                run = 0;
            }
            run++;
            if (vein) {
                area++;
                box = box_add(box_add(box, vec2(x, y)), vec2(x + 1.0, y + 1.0));
            }
        }
    g_string_append_printf(s, first ? "%" G_GUINT64_FORMAT "]}" : ", %" G_GUINT64_FORMAT "]}", run);
    g_string_append_printf(s, ", \"area\": %" G_GUINT64_FORMAT ", ", area);
    put_box(s, area ? box : (Box2){0.0, 0.0, 0.0, 0.0});
    g_string_append(s, ", \"iscrowd\": 1}\n");
}

gboolean labels_write(const VenLeaf *leaf, const char *path, GError **error)
{
    Frame frame = leaf_frame(leaf, leaf->net->margin->box);
    Sink *out = sink_open(path, error);
    if (!out)
        return FALSE;
    put_lamina(out->text, leaf->net->margin, &frame);
    put_areoles(out, leaf->net, &frame);
    Writer w;
    writer_init(&w, leaf, ".", "");
    Painter *painter = writer_painter(&w, &frame);
    Plane *mask = painter_paint(painter, MAP_VEIN_MASK);
    put_veins(out->text, mask);
    plane_free(mask);
    painter_free(painter);
    writer_clear(&w);
    return sink_close(out, error);
}
