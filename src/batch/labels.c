#include "batch/labels.h"

#include "export/export.h"
#include "export/sink.h"
#include "geom/simplify.h"
#include "lib/writer.h"

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

/* ---- pixels ---- */

/* The pixels of a label. The box leaves out its last column and row; of no pixel it is of no use. */
typedef struct {
    uint64_t area;
    uint32_t x0, y0, x1, y1;
} Region;

static void region_add(Region *r, uint32_t x, uint32_t y)
{
    if (r->area++ == 0)
        *r = (Region){1, x, y, x + 1, y + 1};
    r->x0 = MIN(r->x0, x);
    r->x1 = MAX(r->x1, x + 1);
    r->y1 = y + 1; /* rows come from the top */
}

/* By label, up to the map's largest; with `any` all labels are 1. */
static Region *regions_new(const Plane *map, bool any)
{
    Region *region = g_new0(Region, any ? 2 : (gsize)map->high + 1);
    for (uint32_t y = 0; y < map->height; y++)
        for (uint32_t x = 0; x < map->width; x++) {
            uint32_t label = (uint32_t)map->px[(gsize)y * map->width + x];
            if (label > 0)
                region_add(&region[any ? 1 : label], x, y);
        }
    return region;
}

static void put_run(GString *s, uint64_t n, bool first) { g_string_append_printf(s, first ? "%" G_GUINT64_FORMAT : ", %" G_GUINT64_FORMAT, n); }

/* Runs of pixels down the columns, outside first, as COCO has them; label 0: of any label. */
static void put_runs(GString *s, const Plane *map, const Region *r, uint32_t label)
{
    uint64_t begin = 0, end = 0, all = (uint64_t)map->width * map->height; /* of the run under way */
    for (uint32_t x = r->x0; x < r->x1; x++)
        for (uint32_t y = r->y0; y < r->y1; y++) {
            uint64_t at = (uint64_t)x * map->height + y;
            float value = map->px[(gsize)y * map->width + x];
            if (label > 0 ? value != (float)label : value <= 0.0f)
                continue;
            if (end == 0 || at > end) {
                if (end > 0)
                    put_run(s, end - begin, false);
                put_run(s, at - end, end == 0);
                begin = at;
            }
            end = at + 1;
        }
    put_run(s, end - begin, false);
    if (all > end)
        put_run(s, all - end, false);
}

static void put_region(GString *s, const Plane *map, const Region *r, uint32_t label, int category)
{
    g_string_append_printf(s, "{\"category_id\": %d, ", category);
    if (label > 0)
        g_string_append_printf(s, "\"label\": %u, ", label);
    g_string_append_printf(s, "\"segmentation\": {\"size\": [%u, %u], \"counts\": [", map->height, map->width);
    put_runs(s, map, r, label);
    g_string_append_printf(s, "]}, \"area\": %" G_GUINT64_FORMAT ", ", r->area);
    put_box(s, (Box2){r->x0, r->y0, r->x1, r->y1});
    g_string_append(s, ", \"iscrowd\": 0}\n");
}

static void put_areoles(Sink *out, Painter *painter)
{
    Plane *map = painter_paint(painter, MAP_AREOLE);
    Region *region = regions_new(map, false);
    for (uint32_t label = 1; label <= (uint32_t)map->high; label++)
        if (region[label].area >= LABEL_LEAST_AREOLE) {
            put_region(out->text, map, &region[label], label, LABEL_AREOLE);
            sink_drain(out);
        }
    g_free(region);
    plane_free(map);
}

/* Not by coverage, which loses veins thinner than a pixel: the map of orders draws each at least one pixel wide. */
static void put_veins(Sink *out, Painter *painter)
{
    Plane *map = painter_paint(painter, MAP_VEIN_ORDER);
    Region *region = regions_new(map, true);
    if (region[1].area > 0)
        put_region(out->text, map, &region[1], 0, LABEL_VEIN);
    g_free(region);
    plane_free(map);
}

/* A polygon has no holes in COCO, which takes several for their union: with holes the blade is its pixels, those that it covers by half or more. */
static void put_torn_lamina(Sink *out, Painter *painter)
{
    Plane *map = painter_paint(painter, MAP_OPACITY);
    for (gsize i = 0; i < (gsize)map->width * map->height; i++)
        map->px[i] = map->px[i] >= 0.5f;
    Region *region = regions_new(map, true);
    if (region[1].area > 0)
        put_region(out->text, map, &region[1], 0, LABEL_LAMINA);
    g_free(region);
    plane_free(map);
}

gboolean labels_write(const VenLeaf *leaf, const char *path, GError **error)
{
    Frame frame = leaf_frame(leaf, leaf->net->margin->box);
    Sink *out = sink_open(path, error);
    if (!out)
        return FALSE;
    gboolean torn = leaf->net->holes && leaf->net->holes->n > 0;
    Writer w;
    writer_init(&w, leaf, ".", "");
    Painter *painter = writer_painter(&w, &frame);
    gboolean wanted[MAP_COUNT] = {[MAP_OPACITY] = torn, [MAP_AREOLE] = TRUE, [MAP_VEIN_ORDER] = TRUE};
    painter_expect(painter, wanted);
    if (torn)
        put_torn_lamina(out, painter);
    else
        put_lamina(out->text, leaf->net->margin, &frame);
    sink_drain(out);
    put_areoles(out, painter);
    put_veins(out, painter);
    painter_free(painter);
    writer_clear(&w);
    return sink_close(out, error);
}
