/* Responses, edges and corners of a scan tile by tile: to the bit what they are on the whole image at once. */
#include <glib.h>
#include <math.h>
#include <string.h>

#include "geom/random.h"
#include "scan/corners.h"
#include "scan/fang.h"
#include "scan/fang_map.h"

static double uniform(uint32_t stream, uint64_t index)
{
    double u[2];
    random_pair(29, stream, 0, index, u);
    return u[0];
}

/* Waves and noise in all channels: edges of every strength and direction, across every seam. */
static Scan *weave(uint32_t w, uint32_t h, uint32_t channels, uint32_t depth)
{
    Scan *s = scan_new(w, h, channels, depth);
    for (gsize i = 0; i < (gsize)w * h * channels; i++) {
        double x = (double)(i / channels % w), y = (double)(i / channels / w);
        double v = 0.5 + 0.3 * sin(x / 17.0 + y / 41.0) * sin(y / 23.0) + 0.2 * (uniform(1, i) - 0.5);
        if (depth == 8)
            ((uint8_t *)s->px)[i] = (uint8_t)(v * 255.0);
        else
            ((uint16_t *)s->px)[i] = (uint16_t)(v * 65535.0);
    }
    return s;
}

static GreyImage *whole(const FangGrey *g)
{
    GreyImage *out = grey_image_new(g->width, g->height);
    double scale = g->scan->depth == 8 ? 1.0 : 1.0 / 257.0;
    for (uint32_t y = 0; y < g->height; y++)
        for (uint32_t x = 0; x < g->width; x++)
            out->px[(gsize)y * g->width + x] = (float)(channel_value(g->scan, g->channel, g->box.x0 + x, g->box.y0 + y) * scale);
    return out;
}

static void want_all(FangSparse *s)
{
    for (uint32_t y = 0; y < s->height; y++)
        for (uint32_t x = 0; x < s->width; x++)
            fang_sparse_want(s, x, y);
}

static void check_same(const FangSparse *s, const GreyImage *want)
{
    for (uint32_t y = 0; y < s->height; y++)
        for (uint32_t x = 0; x < s->width; x++)
            if (fang_sparse_at(s, x, y) != want->px[(gsize)y * want->width + x])
                g_error("at %u,%u: %.9g instead of %.9g", x, y, (double)fang_sparse_at(s, x, y), (double)want->px[(gsize)y * want->width + x]);
}

/* --- tiles --- */

static void test_tiles(void)
{
    static const uint32_t size[][2] = {{1, 1}, {511, 3}, {512, 512}, {513, 1025}, {2100, 700}}, reach[] = {0, 2, 30, 200};
    for (uint32_t k = 0; k < G_N_ELEMENTS(size); k++)
        for (uint32_t r = 0; r < G_N_ELEMENTS(reach); r++) {
            Scan *s = scan_new(size[k][0] + 5, size[k][1] + 7, 1, 8);
            FangGrey g = fang_grey(s, CHANNEL_GREY, (MaskBox){3, 4, 2 + size[k][0], 3 + size[k][1]});
            uint8_t *times = g_new0(uint8_t, (gsize)g.width * g.height);
            for (uint32_t i = 0; i < fang_tile_count(&g, reach[r]); i++) {
                FangTile t = fang_tile(&g, reach[r], i);
                for (uint32_t y = t.core.y0; y <= t.core.y1; y++)
                    for (uint32_t x = t.core.x0; x <= t.core.x1; x++)
                        times[(gsize)y * g.width + x]++;
                g_assert_true(t.all.x0 == (t.core.x0 > reach[r] ? t.core.x0 - reach[r] : 0) && t.all.y0 == (t.core.y0 > reach[r] ? t.core.y0 - reach[r] : 0));
                g_assert_cmpuint(t.all.x1, ==, MIN(t.core.x1 + reach[r], g.width - 1));
                g_assert_cmpuint(t.all.y1, ==, MIN(t.core.y1 + reach[r], g.height - 1));
            }
            for (gsize i = 0; i < (gsize)g.width * g.height; i++)
                g_assert_cmpuint(times[i], ==, 1);
            g_free(times);
            scan_free(s);
        }
}

static void test_wanted(void)
{
    FangSparse *s = fang_sparse_new(100, 50);
    fang_sparse_want_around(s, 40.0, 20.0, 3.0);
    fang_sparse_want_around(s, -30.0, 90.0, 3.0); /* beyond: the nearest corner */
    for (uint32_t y = 17; y <= 23; y++)
        for (uint32_t x = 37; x <= 43; x++)
            g_assert_cmpfloat(fang_sparse_at(s, x, y), ==, 0.0f);
    uint32_t blocks = 0;
    for (uint32_t i = 0; i < 7 * 4; i++)
        blocks += s->block[i] != NULL;
    g_assert_cmpuint(blocks, ==, 2); /* columns 32 … 47 of rows 16 … 31, and the one in the lower left corner */
    fang_sparse_free(s);
    fang_sparse_free(NULL);
}

/* --- filters --- */

static const double SIGMA[] = {0.0, 1.0, 3.7};

static void test_responses(void)
{
    for (int op = EDGES_ROBERTS; op <= EDGES_CANNY; op++)
        for (uint32_t k = 0; k < G_N_ELEMENTS(SIGMA); k++) {
            double sigma = op == EDGES_LAPLACIAN ? MAX(SIGMA[k], 0.5) : SIGMA[k];
            Scan *s = weave(1060, 570, k == 1 ? 1 : 3, k == 2 ? 16 : 8);
            FangGrey g = fang_grey(s, k == 1 ? CHANNEL_GREY : CHANNEL_SATURATION, (MaskBox){7, 3, 1057, 566});
            GreyImage *in = whole(&g), *want = edges_response(in, (EdgesOperator)op, sigma, NULL);
            FangSparse *got = fang_sparse_new(g.width, g.height);
            want_all(got);
            fang_sparse_respond(got, &g, (EdgesOperator)op, sigma);
            check_same(got, want);
            fang_sparse_free(got);
            grey_image_free(in);
            grey_image_free(want);
            scan_free(s);
        }
}

/* Hysteresis that runs on through many tiles, and Canny's thinning. */
static void test_map(void)
{
    for (int op = EDGES_ROBERTS; op <= EDGES_CANNY; op++)
        for (uint32_t k = 0; k < 3; k++) {
            Scan *s = weave(1060, 570, 3, 8);
            FangGrey g = fang_grey(s, CHANNEL_GREEN, (MaskBox){7, 3, 1057, 566});
            GreyImage *in = whole(&g), *response = edges_response(in, (EdgesOperator)op, 1.5, NULL);
            double otsu = edges_otsu(response);
            EdgesDef def = {.op = (EdgesOperator)op, .sigma = 1.5, .high = k == 2 ? otsu : 2.2 * otsu, .low = k == 0 ? 0.3 * otsu : k == 1 ? 0.8 * otsu : otsu};
            GreyImage *want = edges_map(in, &def, NULL, NULL);
            Mask m = {g.width, g.height, g.width + 9, g_malloc((gsize)(g.width + 9) * g.height)};
            memset(m.px, MASK_LEAF, m.stride * m.height);
            fang_mark_edges(&g, &def, &m);
            gsize edges = 0, strong = 0;
            for (uint32_t y = 0; y < m.height; y++)
                for (uint32_t x = 0; x < m.width; x++) {
                    gsize i = (gsize)y * g.width + x;
                    g_assert_cmpuint(*mask_at(&m, x, y), ==, MASK_LEAF | (want->px[i] > 0.0f ? MASK_SEEN : 0));
                    edges += want->px[i] > 0.0f;
                    strong += (double)response->px[i] > def.high;
                }
            g_assert_cmpuint(edges, >, op == EDGES_CANNY || k == 2 ? 100 : strong);
            g_free(m.px);
            grey_image_free(in);
            grey_image_free(response);
            grey_image_free(want);
            scan_free(s);
        }
}

/* --- corners --- */

typedef struct {
    CornersDef def;
    double least, most;
} Harris;

static GreyImage *harris(const GreyImage *in, const void *user)
{
    const Harris *h = user;
    return corners_response_in(in, h->least, h->most, &h->def, NULL);
}

static float read_sparse(const void *user, uint32_t x, uint32_t y) { return fang_sparse_at(user, x, y); }

/* Along a wavy line around the middle, read from no more than is wanted near it. */
static void test_corners(void)
{
    enum { N = 2000 };
    Scan *s = weave(1060, 570, 3, 16);
    FangGrey g = fang_grey(s, CHANNEL_RED, (MaskBox){7, 3, 1057, 566});
    GreyImage *in = whole(&g);
    Vec2 v[N];
    for (uint32_t i = 0; i < N; i++) {
        double a = 2.0 * G_PI * i / N, r = 1.0 + 0.1 * sin(9.0 * a);
        v[i] = vec2(520.0 + 440.0 * r * cos(a), 280.0 + 230.0 * r * sin(a));
    }
    for (int k = 0; k < 2; k++) {
        CornersDef def = corners_def_default();
        def.size = k ? 300.0 : 0.0;
        Harris h = {.def = corners_scaled(&def, v, N)};
        fang_grey_range(&g, &h.least, &h.most);
        FangSparse *near = fang_sparse_new(g.width, g.height), *all = fang_sparse_new(g.width, g.height);
        uint32_t reach = (uint32_t)ceil(4.0 * (h.def.smoothing + h.def.window)) + 3;
        for (uint32_t i = 0; i < N; i++)
            fang_sparse_want_around(near, v[i].x, v[i].y, h.def.window + 2.0);
        want_all(all);
        fang_sparse_fill(near, &g, reach, harris, &h);
        fang_sparse_fill(all, &g, reach, harris, &h);
        GreyImage *response = corners_response(in, &h.def, NULL);
        check_same(all, response);
        CornersField field = {g.width, g.height, read_sparse, near};
        GArray *got = corners_choose(&field, v, N, 0, N / 2, &h.def, NULL), *want = corners_find(in, v, N, 0, N / 2, &def, NULL);
        g_assert_cmpuint(want->len, >, 10);
        g_assert_cmpuint(got->len, ==, want->len);
        for (guint i = 0; i < want->len; i++) {
            Corner a = g_array_index(got, Corner, i), b = g_array_index(want, Corner, i);
            g_assert_true(a.at == b.at && a.response == b.response);
        }
        g_array_unref(got);
        g_array_unref(want);
        grey_image_free(response);
        fang_sparse_free(near);
        fang_sparse_free(all);
    }
    grey_image_free(in);
    scan_free(s);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/fang_tiles/tiles", test_tiles);
    g_test_add_func("/fang_tiles/wanted", test_wanted);
    g_test_add_func("/fang_tiles/responses", test_responses);
    g_test_add_func("/fang_tiles/map", test_map);
    g_test_add_func("/fang_tiles/corners", test_corners);
    return g_test_run();
}
