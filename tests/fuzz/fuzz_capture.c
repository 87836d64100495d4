/* Captures: a small image is drawn by the bytes, and what is a leaf in it captured both ways, its veins looked for, its background filled. Whatever
 * the bytes, outlines are simple and points finite, or there is an error.
 *
 * Byte 0, 1: width and height - 8; 2: channels, depth; 3 … 9: settings; then shapes of 6 bytes: kind and channel, x, y, width, height, level. */
#include "fuzz.h"
#include "geom/polygon.h"
#include "scan/fang.h"
#include "scan/fill.h"
#include "scan/found.h"
#include "scan/profile.h"
#include "sound.h"

enum { HEADER = 10, SHAPE = 6, MOST_SHAPES = 60 };

static void put(Scan *s, uint32_t x, uint32_t y, uint32_t channel, uint8_t level)
{
    size_t at = ((size_t)y * s->width + x) * s->channels;
    for (uint32_t c = 0; c < s->channels; c++) {
        if (channel && (channel - 1) % s->channels != c)
            continue;
        if (s->depth == 8)
            ((uint8_t *)s->px)[at + c] = level;
        else
            ((uint16_t *)s->px)[at + c] = (uint16_t)(level * 257u);
    }
}

/* A rectangle, an ellipse, a line, or noise. */
static void shape(Scan *s, const uint8_t *b, uint64_t index)
{
    double cx = b[1] / 255.0 * s->width, cy = b[2] / 255.0 * s->height, w = b[3] / 255.0 * s->width, h = b[4] / 255.0 * s->height;
    for (uint32_t y = 0; y < s->height; y++)
        for (uint32_t x = 0; x < s->width; x++) {
            double dx = (x + 0.5 - cx) / MAX(w, 0.5), dy = (y + 0.5 - cy) / MAX(h, 0.5);
            bool in = (b[0] & 3) == 1   ? dx * dx + dy * dy <= 1.0
                      : (b[0] & 3) == 2 ? fabs(dx - dy) * MIN(w, h) <= 0.8 && fabs(dx) <= 1.0
                                        : fabs(dx) <= 1.0 && fabs(dy) <= 1.0;
            uint32_t noise = (uint32_t)((index * 0x9E3779B97F4A7C15u + y * 0xC2B2AE3Du + x * 0x27D4EB2Fu) * 0x165667B1u >> 24);
            if (in)
                put(s, x, y, b[0] >> 2 & 7, (b[0] & 3) == 3 ? (uint8_t)(noise ^ b[5]) : b[5]);
        }
}

static Scan *paint(const uint8_t *b, size_t size)
{
    Scan *s = scan_new(8u + b[0] % 41, 8u + b[1] % 41, 1 + b[2] % 4, b[2] & 4 ? 16 : 8);
    for (uint32_t y = 0; y < s->height; y++)
        for (uint32_t x = 0; x < s->width; x++)
            put(s, x, y, 0, 255);
    for (size_t i = HEADER, k = 0; i + SHAPE <= size && k < MOST_SHAPES; i += SHAPE, k++)
        shape(s, b + i, k);
    return s;
}

static bool is_finite(Vec2 p) { return isfinite(p.x) && isfinite(p.y); }

static void find_veins(const Scan *s, const Polygon *outline, Vec2 base, Vec2 tip, const uint8_t *b)
{
    GError *error = NULL;
    FoundDef def = found_def_default();
    def.orders = 1u + b[7] % 4;
    def.sensitivity = b[8] / 255.0;
    Drawing *d = found_veins(s, outline, base, tip, &def, &error);
    fuzz_check_error(d != NULL, &error, SCAN_ERROR, 0);
    for (uint32_t k = 0; d && k < d->n; k++)
        for (uint32_t i = 0; i < d->vein[k].n; i++)
            require(is_finite(d->vein[k].point[i]) && isfinite(d->vein[k].width[i]));
    drawing_free(d);
}

static void by_threshold(Scan *s, const uint8_t *b)
{
    GError *error = NULL;
    ProfileDef def = profile_def_default();
    Threshold used;
    def.threshold = (ThresholdDef){(Channel)(b[3] % CHANNEL_COUNT), (LeafSide)(b[3] / CHANNEL_COUNT % 3), b[4] & 1 ? b[4] : -1.0};
    def.close = b[5] & 1 ? (b[5] >> 3) : 0.0;
    def.open = b[5] & 2 ? (b[5] >> 3) : 0.0;
    def.each = b[5] & 4;
    def.keep_stalk = b[6] & 2;
    def.subpixel = b[6] & 4;
    def.square = b[6] & 8 ? 1u + (b[6] >> 4) : 1u;
    def.tolerance = b[7] / 64.0;
    def.least_area = b[8] / 255.0;
    def.has_base = !def.each && (b[9] & 1);
    def.has_tip = !def.each && (b[9] & 2);
    def.base = vec2(b[8], b[7]);
    def.tip = vec2(b[7], b[9]);
    GPtrArray *all = profile_capture(s, &def, &used, &error);
    fuzz_check_error(all != NULL, &error, SCAN_ERROR, 0);
    for (uint32_t i = 0; all && i < all->len; i++) {
        const Profile *p = all->pdata[i];
        sound_polygon(p->outline);
        require(is_finite(p->base) && is_finite(p->tip) && vec_dist2(p->base, p->tip) > 0.0 && isfinite(p->symmetry) && isfinite(p->area) &&
                isfinite(p->perimeter));
        require(!p->has_stalk || (is_finite(p->stalk_end) && isfinite(p->stalk_width) && isfinite(p->stalk_length)));
    }
    if (all && all->len) {
        const Profile *p = all->pdata[0];
        find_veins(s, p->outline, p->base, p->tip, b);
        scan_fill(s, p->outline, &used, 3.0, 64);
    }
    if (all)
        g_ptr_array_unref(all);
}

static void by_edges(const Scan *s, const uint8_t *b)
{
    GError *error = NULL;
    FangDef def = fang_def_default();
    def.threshold.channel = (Channel)(b[3] % CHANNEL_COUNT);
    def.leaf = 1u + b[4] / 128u;
    def.edges.op = (EdgesOperator)(b[4] % 5);
    def.edges.sigma = b[5] / 64.0;
    def.corners.threshold = b[6] / 255.0;
    if (b[7] & 1) {
        def.fit.rule = BEZIERFIT_CONTOUR;
        def.fit.tolerance = 1.5;
    }
    def.keep_stalk = b[7] & 2;
    FangProfile *p = fang_capture(s, &def, &error);
    fuzz_check_error(p != NULL, &error, SCAN_ERROR, EDGES_ERROR, CORNERS_ERROR, BEZIERFIT_ERROR, 0);
    if (p) {
        sound_polygon(p->outline);
        require(p->base < p->contour->n && p->tip < p->contour->n);
    }
    fang_profile_free(p);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size < HEADER)
        return 0;
    Scan *s = paint(data, size);
    if (data[2] & 8)
        by_edges(s, data);
    else
        by_threshold(s, data);
    scan_free(s);
    return 0;
}
