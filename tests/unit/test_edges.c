/* Edge operators against analytic images (ramps, steps, discs) and against plain two-dimensional sums. */
#include <glib.h>
#include <math.h>

#include "geom/random.h"
#include "scan/edges.h"

#define CLOSE(a, b, e) g_assert_cmpfloat_with_epsilon((double)(a), (double)(b), e)

static float *pixel(const GreyImage *g, int x, int y) { return &g->px[(gsize)y * g->width + (gsize)x]; }

static double held(const GreyImage *g, int x, int y)
{
    return (double)*pixel(g, CLAMP(x, 0, (int)g->width - 1), CLAMP(y, 0, (int)g->height - 1));
}

static GreyImage *noise(uint32_t width, uint32_t height, uint32_t stream)
{
    GreyImage *g = grey_image_new(width, height);
    for (uint32_t i = 0; i < width * height; i++) {
        double u[2];
        random_pair(5, stream, 0, i, u);
        g->px[i] = (float)u[0];
    }
    return g;
}

static GreyImage *ramp(uint32_t width, uint32_t height, double a, double b)
{
    GreyImage *g = grey_image_new(width, height);
    for (int y = 0; y < (int)height; y++)
        for (int x = 0; x < (int)width; x++)
            *pixel(g, x, y) = (float)(a * x + b * y + 3.0);
    return g;
}

/* Columns before `at` are 0, the others `high`. */
static GreyImage *step(uint32_t width, uint32_t height, uint32_t at, float high)
{
    GreyImage *g = grey_image_new(width, height);
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = at; x < width; x++)
            *pixel(g, (int)x, (int)y) = high;
    return g;
}

/* Part of each pixel that a disc covers, by 16 × 16 samples. */
static GreyImage *disc(uint32_t size, double cx, double cy, double r)
{
    GreyImage *g = grey_image_new(size, size);
    for (int y = 0; y < (int)size; y++)
        for (int x = 0; x < (int)size; x++) {
            int inside = 0;
            for (int k = 0; k < 256; k++) {
                double dx = x + (k % 16 + 0.5) / 16.0 - cx, dy = y + (k / 16 + 0.5) / 16.0 - cy;
                inside += dx * dx + dy * dy < r * r;
            }
            *pixel(g, x, y) = (float)inside / 256.0f;
        }
    return g;
}

static GreyImage *respond(const GreyImage *in, EdgesOperator op, double sigma)
{
    GError *error = NULL;
    GreyImage *out = edges_response(in, op, sigma, &error);
    g_assert_no_error(error);
    return out;
}

static GreyImage *map(const GreyImage *in, EdgesOperator op, double sigma, double used[2])
{
    EdgesDef def = {.op = op, .sigma = sigma, .automatic = true};
    GError *error = NULL;
    GreyImage *out = edges_map(in, &def, used, &error);
    g_assert_no_error(error);
    for (uint32_t i = 0; i < out->width * out->height; i++)
        g_assert_true(out->px[i] == 0.0f || out->px[i] == 1.0f);
    return out;
}

static uint32_t count(const GreyImage *g)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < g->width * g->height; i++)
        n += g->px[i] > 0.0f;
    return n;
}

/* --- analytic images --- */

/* Every difference kernel gives a ramp's slope; at the border, which is replicated, Roberts loses all of it and the others half. */
static void test_ramp(void)
{
    const EdgesOperator ops[] = {EDGES_ROBERTS, EDGES_SOBEL, EDGES_PREWITT};
    GreyImage *in = ramp(12, 9, 0.5, -0.25);
    for (int k = 0; k < 3; k++) {
        GreyImage *gx, *gy, *m = respond(in, ops[k], 0.0);
        edges_gradient(in, ops[k], &gx, &gy);
        for (int y = 1; y < 8; y++) {
            for (int x = 1; x < 11; x++) {
                CLOSE(*pixel(gx, x, y), 0.5, 1e-6);
                CLOSE(*pixel(gy, x, y), -0.25, 1e-6);
                CLOSE(*pixel(m, x, y), sqrt(0.3125), 1e-6);
            }
            CLOSE(*pixel(gx, 11, y), k == 0 ? 0.0 : 0.25, 1e-6);
            CLOSE(*pixel(gx, 0, y), k == 0 ? 0.5 : 0.25, 1e-6);
        }
        CLOSE(*pixel(gy, 5, 8), k == 0 ? 0.0 : -0.125, 1e-6);
        grey_image_free(gx);
        grey_image_free(gy);
        grey_image_free(m);
    }
    grey_image_free(in);
}

static void test_step(void)
{
    GreyImage *in = step(20, 7, 10, 0.8f);
    const struct {
        EdgesOperator op;
        double at[4]; /* columns 8 … 11 */
    } cases[] = {{EDGES_ROBERTS, {0, 0.8, 0, 0}},
                 {EDGES_SOBEL, {0, 0.4, 0.4, 0}},
                 {EDGES_PREWITT, {0, 0.4, 0.4, 0}},
                 {EDGES_CANNY, {0, 0.4, 0, 0}}};
    for (uint32_t k = 0; k < G_N_ELEMENTS(cases); k++) {
        GreyImage *out = respond(in, cases[k].op, 0.0);
        for (int y = 0; y < 7; y++)
            for (int x = 0; x < 20; x++)
                CLOSE(*pixel(out, x, y), x >= 8 && x < 12 ? cases[k].at[x - 8] : 0.0, 1e-6);
        grey_image_free(out);
    }
    grey_image_free(in);
}

/* The Laplacian of a smoothed step is the derivative of the Gaussian, -h x e^(-x²/2σ²) / (σ³ √2π), here half a pixel either side of 0;
 * sums over pixels in place of the integral are 1/8σ² more. */
static void test_laplacian_step(void)
{
    for (double sigma = 1.5; sigma < 6.0; sigma += 1.5) {
        GreyImage *in = step(80, 5, 40, 3.0f), *out = respond(in, EDGES_LAPLACIAN, sigma);
        double want = 3.0 * exp(-0.125 / (sigma * sigma)) / (sigma * sigma * sigma * sqrt(2.0 * G_PI));
        for (int y = 0; y < 5; y++)
            for (int x = 0; x < 80; x++) {
                if (x == 39)
                    CLOSE((double)*pixel(out, x, y) / want, 1.0 + 0.125 / (sigma * sigma), 0.01);
                else
                    g_assert_cmpfloat((double)*pixel(out, x, y), <, 1e-3 * want);
            }
        grey_image_free(in);
        grey_image_free(out);
    }
}

/* A dark line one pixel wide has crossings on both of its sides, as far off as the Laplacian's zero, sigma. */
static void test_laplacian_line(void)
{
    GreyImage *in = grey_image_new(61, 4);
    for (int y = 0; y < 4; y++)
        *pixel(in, 30, y) = 1.0f;
    double used[2];
    GreyImage *out = map(in, EDGES_LAPLACIAN, 4.0, used);
    for (int y = 0; y < 4; y++)
        for (int x = 0; x < 61; x++)
            g_assert_cmpint(*pixel(out, x, y) > 0.0f, ==, x == 26 || x == 34);
    grey_image_free(in);
    grey_image_free(out);
}

/* A step with a pixel half way up has its crossing on that pixel, where the Laplacian is 0: half the step of those beside it. */
static void test_laplacian_zero(void)
{
    GreyImage *in = grey_image_new(81, 3);
    for (int y = 0; y < 3; y++)
        for (int x = 0; x < 81; x++)
            *pixel(in, x, y) = (float)((x > 40) - (x < 40));
    GreyImage *out = respond(in, EDGES_LAPLACIAN, 3.0);
    double want = 0.0;
    for (double off = 0.5; off < 2.0; off += 1.0)
        want += off * exp(-off * off / 18.0) / (27.0 * sqrt(2.0 * G_PI));
    for (int y = 0; y < 3; y++)
        for (int x = 0; x < 81; x++)
            CLOSE((double)*pixel(out, x, y) / want, x == 40 ? 1.0 : 0.0, 0.03);
    grey_image_free(in);
    grey_image_free(out);
}

/* The Laplacian of a ramp is rounding noise, which is no edge; that of a step under a wide Gaussian is almost as small, but an edge. */
static void test_laplacian_faint(void)
{
    double used[2];
    GreyImage *slope = ramp(120, 20, 0.37, 0.0), *wide = step(600, 3, 300, 1.0f), *none = map(slope, EDGES_LAPLACIAN, 2.0, used),
              *edge = map(wide, EDGES_LAPLACIAN, 95.0, used);
    g_assert_cmpuint(count(none), ==, 0);
    g_assert_cmpuint(count(edge), ==, 3);
    g_assert_true(*pixel(edge, 299, 0) > 0.0f);
    grey_image_free(slope);
    grey_image_free(wide);
    grey_image_free(none);
    grey_image_free(edge);
}

/* A constant stays; an impulse becomes a bell of sum 1 and variance sigma² each way. */
static void test_smooth(void)
{
    GreyImage *flat = ramp(30, 20, 0.0, 0.0), *dot = grey_image_new(101, 101);
    *pixel(dot, 50, 50) = 1.0f;
    for (double sigma = 0.0; sigma < 9.0; sigma = 2.0 * sigma + 1.0) {
        GreyImage *a = edges_smooth(flat, sigma, NULL), *b = edges_smooth(dot, sigma, NULL);
        double sum = 0.0, xx = 0.0, yy = 0.0;
        for (uint32_t i = 0; i < 600; i++)
            CLOSE(a->px[i], 3.0, 1e-6);
        for (int y = 0; y < 101; y++)
            for (int x = 0; x < 101; x++) {
                double v = (double)*pixel(b, x, y);
                sum += v;
                xx += v * (x - 50) * (x - 50);
                yy += v * (y - 50) * (y - 50);
                CLOSE(v, *pixel(b, y, x), 1e-8);
                CLOSE(v, *pixel(b, 100 - x, y), 1e-8);
            }
        CLOSE(sum, 1.0, 1e-5);
        CLOSE(xx, sigma * sigma, 0.003 * sigma * sigma + 1e-6);
        CLOSE(yy, sigma * sigma, 0.003 * sigma * sigma + 1e-6);
        grey_image_free(a);
        grey_image_free(b);
    }
    grey_image_free(flat);
    grey_image_free(dot);
}

/* --- plain sums --- */

/* Textbook kernels, unscaled, over the border replicated. */
static double plain(const GreyImage *g, int x, int y, const int *kernel, int size)
{
    double sum = 0.0;
    int first = size == 3 ? -1 : 0;
    for (int j = 0; j < size; j++)
        for (int i = 0; i < size; i++)
            sum += kernel[j * size + i] * held(g, x + i + first, y + j + first);
    return sum;
}

static void test_plain_differences(void)
{
    static const int roberts[2][4] = {{1, 0, 0, -1}, {0, 1, -1, 0}};
    static const int sobel[2][9] = {{-1, 0, 1, -2, 0, 2, -1, 0, 1}, {-1, -2, -1, 0, 0, 0, 1, 2, 1}};
    static const int prewitt[2][9] = {{-1, 0, 1, -1, 0, 1, -1, 0, 1}, {-1, -1, -1, 0, 0, 0, 1, 1, 1}};
    const struct {
        EdgesOperator op;
        const int *x, *y;
        int size;
        double scale;
    } cases[] = {{EDGES_ROBERTS, roberts[0], roberts[1], 2, sqrt(0.5)},
                 {EDGES_SOBEL, sobel[0], sobel[1], 3, 0.125},
                 {EDGES_PREWITT, prewitt[0], prewitt[1], 3, 1.0 / 6.0}};
    const uint32_t sizes[][2] = {{1, 1}, {1, 9}, {9, 1}, {2, 2}, {17, 23}};
    for (uint32_t s = 0; s < G_N_ELEMENTS(sizes); s++) {
        GreyImage *in = noise(sizes[s][0], sizes[s][1], s);
        for (uint32_t k = 0; k < G_N_ELEMENTS(cases); k++) {
            GreyImage *out = respond(in, cases[k].op, 0.0);
            for (int y = 0; y < (int)in->height; y++)
                for (int x = 0; x < (int)in->width; x++) {
                    double a = plain(in, x, y, cases[k].x, cases[k].size), b = plain(in, x, y, cases[k].y, cases[k].size);
                    CLOSE(*pixel(out, x, y), cases[k].scale * sqrt(a * a + b * b), 1e-6);
                }
            grey_image_free(out);
        }
        grey_image_free(in);
    }
}

static double plain_gaussian(const GreyImage *g, int x, int y, double sigma)
{
    int r = (int)ceil(4.0 * sigma);
    double sum = 0.0, all = 0.0;
    for (int j = -r; j <= r; j++)
        for (int i = -r; i <= r; i++) {
            double w = exp(-(i * i + j * j) / (2.0 * sigma * sigma));
            sum += w * held(g, x + i, y + j);
            all += w;
        }
    return sum / all;
}

static void test_plain_gaussian(void)
{
    GreyImage *in = noise(31, 22, 8), *out = edges_smooth(in, 1.7, NULL);
    for (int y = 0; y < 22; y++)
        for (int x = 0; x < 31; x++)
            CLOSE(*pixel(out, x, y), plain_gaussian(in, x, y, 1.7), 1e-6);
    grey_image_free(in);
    grey_image_free(out);
}

/* The Laplacian as one kernel in two dimensions, (r²/σ² - 2)/σ² times the bell, where it has a crossing far above rounding. */
static void test_plain_laplacian(void)
{
    enum { W = 40, H = 33 };
    const double sigma = 2.0;
    GreyImage *rough = noise(W, H, 9), *in = edges_smooth(rough, 1.5, NULL), *out = respond(in, EDGES_LAPLACIAN, sigma);
    double l[H][W];
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) {
            l[y][x] = 0.0;
            for (int j = -12; j <= 12; j++)
                for (int i = -12; i <= 12; i++) {
                    double q = (i * i + j * j) / (sigma * sigma);
                    l[y][x] += (q - 2.0) * exp(-0.5 * q) / (2.0 * G_PI * sigma * sigma * sigma * sigma) *
                               (held(in, x + i, y + j) - held(in, x, y));
                }
        }
    uint32_t seen = 0;
    for (int y = 1; y < H - 1; y++)
        for (int x = 1; x < W - 1; x++) {
            const double v = l[y][x], near[4] = {l[y][x - 1], l[y][x + 1], l[y - 1][x], l[y + 1][x]};
            double want = 0.0, doubt = HUGE_VAL;
            for (int k = 0; k < 4; k++) {
                if (near[k] * v < 0.0 && fabs(v) < fabs(near[k]))
                    want = MAX(want, fabs(v - near[k]));
                doubt = MIN(doubt, MIN(fabs(near[k]), fabs(fabs(near[k]) - fabs(v))));
            }
            if (MIN(doubt, fabs(v)) < 2e-5)
                continue;
            CLOSE(*pixel(out, x, y), want, 2e-5);
            seen += want > 0.0;
        }
    g_assert_cmpuint(seen, >, 100);
    grey_image_free(rough);
    grey_image_free(in);
    grey_image_free(out);
}

/* Canny's ridges again from the definition: magnitudes between pixels by lines, one pixel along the axis that the gradient follows more.
 */
static void test_plain_ridges(void)
{
    GreyImage *rough = noise(50, 41, 10), *in = edges_smooth(rough, 1.0, NULL), *out = respond(in, EDGES_CANNY, 0.0), *gx, *gy;
    edges_gradient(in, EDGES_SOBEL, &gx, &gy);
    GreyImage *m = respond(in, EDGES_SOBEL, 0.0);
    uint32_t kept = 0;
    for (int y = 0; y < 41; y++)
        for (int x = 0; x < 50; x++) {
            double dx = (double)*pixel(gx, x, y), dy = (double)*pixel(gy, x, y), longer = MAX(fabs(dx), fabs(dy)), side[2];
            for (int k = 0; k < 2; k++) {
                double ux = (k ? -dx : dx) / longer, uy = (k ? -dy : dy) / longer; /* one of them is 1 or -1 */
                int x0 = x + (int)floor(ux), y0 = y + (int)floor(uy);
                double fx = ux - floor(ux), fy = uy - floor(uy);
                side[k] = held(m, x0, y0) * (1 - fx) * (1 - fy) + (fx > 0 ? held(m, x0 + 1, y0) * fx * (1 - fy) : 0) +
                          (fy > 0 ? held(m, x0, y0 + 1) * (1 - fx) * fy : 0);
            }
            double here = held(m, x, y);
            if (MIN(fabs(here - side[0]), fabs(here - side[1])) < 1e-6)
                continue;
            bool want = here > side[0] && here > side[1];
            CLOSE(*pixel(out, x, y), want ? here : 0.0, 1e-6);
            kept += want;
        }
    g_assert_cmpuint(kept, >, 100);
    grey_image_free(rough);
    grey_image_free(in);
    grey_image_free(out);
    grey_image_free(m);
    grey_image_free(gx);
    grey_image_free(gy);
}

/* --- thresholds --- */

static void test_otsu(void)
{
    GreyImage *two = grey_image_new(10, 10); /* 80 of 0.2, 20 of 1: anything between is best, and the middle taken */
    for (int i = 0; i < 100; i++)
        two->px[i] = i < 80 ? 0.2f : 1.0f;
    CLOSE(edges_otsu(two), 0.6, 0.005);
    for (int i = 0; i < 100; i++)
        two->px[i] = 0.0f;
    g_assert_cmpfloat(edges_otsu(two), ==, 0.0);
    grey_image_free(two);

    for (uint32_t k = 0; k < 20; k++) { /* by the definition, at every value that occurs */
        GreyImage *g = noise(16, 16, 20 + k);
        for (int i = 0; i < 256; i++)
            g->px[i] = floorf(g->px[i] * g->px[i] * (4.0f + (float)k)) / 256.0f + (i == 0 ? 1.0f : 0.0f);
        g->px[0] = 255.0f / 256.0f;
        double best = -1.0, chosen = edges_otsu(g), reached = -1.0;
        for (int t = 0; t < 256; t++) {
            double n[2] = {0, 0}, s[2] = {0, 0};
            for (int i = 0; i < 256; i++) {
                int c = (double)g->px[i] > t / 256.0;
                n[c]++;
                s[c] += (double)g->px[i];
            }
            double d = n[0] > 0 && n[1] > 0 ? s[1] / n[1] - s[0] / n[0] : 0.0, between = n[0] * n[1] * d * d;
            best = MAX(best, between);
            if (t == 255)
                break;
            if (chosen > t / 256.0 && chosen <= (t + 1) / 256.0)
                reached = between;
        }
        CLOSE(reached / best, 1.0, 1e-9);
        grey_image_free(g);
    }
}

/* Edges above the low threshold, grown from those above the high one, against growth in whole sweeps. */
static void test_hysteresis(void)
{
    GreyImage *rough = noise(60, 50, 11), *in = edges_smooth(rough, 1.0, NULL);
    EdgesDef def = {.op = EDGES_SOBEL, .high = 0.16, .low = 0.08};
    GError *error = NULL;
    double used[2];
    GreyImage *got = edges_map(in, &def, used, &error), *r = respond(in, EDGES_SOBEL, 0.0), *want = grey_image_new(60, 50);
    g_assert_no_error(error);
    g_assert_cmpfloat(used[0], ==, 0.16);
    g_assert_cmpfloat(used[1], ==, 0.08);
    for (bool more = true; more;) {
        more = false;
        for (int y = 0; y < 50; y++)
            for (int x = 0; x < 60; x++) {
                bool on = held(r, x, y) > 0.16;
                for (int k = 0; k < 9; k++)
                    on = on || (held(r, x, y) > 0.08 && held(want, x + k % 3 - 1, y + k / 3 - 1) > 0.0);
                if (on && *pixel(want, x, y) == 0.0f) {
                    *pixel(want, x, y) = 1.0f;
                    more = true;
                }
            }
    }
    for (int i = 0; i < 3000; i++)
        g_assert_true(got->px[i] == want->px[i]);
    def.low = def.high;
    GreyImage *few = edges_map(in, &def, NULL, &error);
    g_assert_no_error(error);
    g_assert_cmpuint(count(few), <, count(got));
    for (int i = 0; i < 3000; i++)
        g_assert_cmpint(few->px[i] > 0.0f, ==, (double)r->px[i] > 0.16);
    grey_image_free(rough);
    grey_image_free(in);
    grey_image_free(got);
    grey_image_free(r);
    grey_image_free(want);
    grey_image_free(few);
}

/* --- discs --- */

/* Pixels reached from (x, y) over pixels that are all on or all off, through 4 or 8 neighbours. */
static uint32_t flood(const GreyImage *g, int x, int y, bool eight, GreyImage *seen)
{
    GArray *open = g_array_new(FALSE, FALSE, 2 * sizeof(int));
    int here[2] = {x, y};
    bool on = *pixel(g, x, y) > 0.0f;
    uint32_t n = 0;
    g_array_append_val(open, here);
    *pixel(seen, x, y) = 1.0f;
    while (open->len) {
        int *last = (int *)(void *)open->data + 2 * (open->len - 1), px = last[0], py = last[1];
        g_array_set_size(open, open->len - 1);
        n++;
        for (int k = 0; k < 9; k++) {
            int q[2] = {px + k % 3 - 1, py + k / 3 - 1};
            if (q[0] < 0 || q[1] < 0 || q[0] >= (int)g->width || q[1] >= (int)g->height || (!eight && k % 2 == 0))
                continue;
            if ((*pixel(g, q[0], q[1]) > 0.0f) != on || *pixel(seen, q[0], q[1]) > 0.0f)
                continue;
            *pixel(seen, q[0], q[1]) = 1.0f;
            g_array_append_val(open, q);
        }
    }
    g_array_unref(open);
    return n;
}

/* Every operator's edges lie on the circle, all around it. */
static void test_disc(void)
{
    static const double off[] = {
        [EDGES_ROBERTS] = 1.2, [EDGES_SOBEL] = 1.5, [EDGES_PREWITT] = 1.5, [EDGES_LAPLACIAN] = 0.75, [EDGES_CANNY] = 0.75};
    for (int k = 0; k < 12; k++) {
        double r = 12.0 + 3.1 * k, cx = 64.0 + 0.31 * k, cy = 64.0 - 0.17 * k;
        GreyImage *in = disc(128, cx, cy, r);
        for (int op = EDGES_ROBERTS; op <= EDGES_CANNY; op++) {
            double used[2], middle = op == EDGES_ROBERTS ? 1.0 : 0.5;
            GreyImage *out = map(in, (EdgesOperator)op,
                                 op == EDGES_LAPLACIAN ? 2.0
                                 : op == EDGES_CANNY   ? 1.4
                                                       : 0.0,
                                 used),
                      *seen = grey_image_new(128, 128);
            bool around[36] = {false};
            for (int y = 0; y < 128; y++)
                for (int x = 0; x < 128; x++) {
                    if (*pixel(out, x, y) == 0.0f)
                        continue;
                    double dx = x + middle - cx, dy = y + middle - cy;
                    g_assert_cmpfloat(fabs(sqrt(dx * dx + dy * dy) - r), <, off[op]);
                    around[(int)floor((atan2(dy, dx) + G_PI) / (2.0 * G_PI) * 35.999)] = true;
                }
            for (int i = 0; i < 36; i++)
                g_assert_true(around[i]);
            /* the ring is closed: a flood from the centre stays inside */
            uint32_t inner = flood(out, (int)cx, (int)cy, false, seen);
            g_assert_cmpfloat(inner, <, G_PI * (r + 1.0) * (r + 1.0));
            if (op == EDGES_CANNY) {
                int first = 0;
                while (out->px[first] == 0.0f)
                    first++;
                g_assert_cmpuint(flood(out, first % 128, first / 128, true, seen), ==, count(out)); /* in one piece */
                for (int y = 1; y < 127; y++) /* one pixel wide: every pixel has just two neighbours */
                    for (int x = 1; x < 127; x++) {
                        int near = 0;
                        for (int j = 0; j < 9; j++)
                            near += *pixel(out, x + j % 3 - 1, y + j / 3 - 1) > 0.0f;
                        g_assert_true(*pixel(out, x, y) == 0.0f || near == 3);
                    }
                /* an 8-connected circle has 4 √2 r pixels */
                CLOSE(count(out) / (4.0 * sqrt(2.0) * r), 1.0, 0.05);
            }
            grey_image_free(out);
            grey_image_free(seen);
        }
        grey_image_free(in);
    }
}

/* The same from the disc's negative and from its mirror image (mirrored): nothing depends on sign or side but ties. */
static void test_negative(void)
{
    GreyImage *in = disc(64, 31.3, 33.8, 20.0), *negative = grey_image_new(64, 64);
    for (int i = 0; i < 4096; i++)
        negative->px[i] = 1.0f - in->px[i];
    for (int op = EDGES_ROBERTS; op <= EDGES_CANNY; op++) {
        GreyImage *a = respond(in, (EdgesOperator)op, 1.5), *b = respond(negative, (EdgesOperator)op, 1.5);
        for (int i = 0; i < 4096; i++)
            CLOSE(a->px[i], b->px[i], 2e-6);
        grey_image_free(a);
        grey_image_free(b);
    }
    grey_image_free(in);
    grey_image_free(negative);
}

/* --- refusals --- */

static void test_blank(void)
{
    for (int op = EDGES_ROBERTS; op <= EDGES_CANNY; op++) {
        GreyImage *in = ramp(23, 17, 0.0, 0.0);
        for (int i = 0; i < 23 * 17; i++)
            in->px[i] = 0.1f;
        double used[2];
        GreyImage *out = map(in, (EdgesOperator)op, op == EDGES_LAPLACIAN ? 3.0 : 0.7, used);
        g_assert_cmpuint(count(out), ==, 0);
        grey_image_free(in);
        grey_image_free(out);
    }
}

static void refuse(const GreyImage *in, EdgesDef def, EdgesError code, const char *part)
{
    GError *error = NULL;
    g_assert_null(edges_map(in, &def, NULL, &error));
    g_assert_error(error, EDGES_ERROR, (int)code);
    if (!strstr(error->message, part))
        g_error("'%s' does not say '%s'", error->message, part);
    g_error_free(error);
}

static void test_refused(void)
{
    GreyImage *in = noise(8, 6, 1), *empty = grey_image_new(0, 5);
    EdgesDef def = edges_def_default();
    refuse(empty, def, EDGES_ERROR_IMAGE, "0 × 5");
    def.sigma = -1.0;
    refuse(in, def, EDGES_ERROR_SETTINGS, "sigma is -1");
    def.sigma = (double)NAN;
    refuse(in, def, EDGES_ERROR_SETTINGS, "sigma");
    def.sigma = 101.0;
    refuse(in, def, EDGES_ERROR_SETTINGS, "between 0 and 100");
    def = (EdgesDef){.op = EDGES_LAPLACIAN, .automatic = true};
    refuse(in, def, EDGES_ERROR_SETTINGS, "between 0.5 and 100");
    def = (EdgesDef){.op = EDGES_SOBEL, .high = 0.1, .low = 0.2};
    refuse(in, def, EDGES_ERROR_SETTINGS, "low threshold is 0.2 and the high one 0.1");
    def = (EdgesDef){.op = EDGES_SOBEL, .high = (double)NAN, .low = 0.0};
    refuse(in, def, EDGES_ERROR_SETTINGS, "low threshold");
    def = (EdgesDef){.op = EDGES_SOBEL, .high = 1.0, .low = -1.0};
    refuse(in, def, EDGES_ERROR_SETTINGS, "low threshold");
    in->px[8 * 3 + 5] = NAN;
    refuse(in, edges_def_default(), EDGES_ERROR_IMAGE, "column 5, row 3");
    in->px[8 * 3 + 5] = INFINITY;
    refuse(in, edges_def_default(), EDGES_ERROR_IMAGE, "column 5, row 3");
    GError *error = NULL;
    g_assert_null(edges_smooth(in, 1.0, &error));
    g_assert_error(error, EDGES_ERROR, EDGES_ERROR_IMAGE);
    g_error_free(error);
    grey_image_free(in);
    grey_image_free(empty);
    grey_image_free(NULL);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/edges/ramp", test_ramp);
    g_test_add_func("/edges/step", test_step);
    g_test_add_func("/edges/laplacian/step", test_laplacian_step);
    g_test_add_func("/edges/laplacian/line", test_laplacian_line);
    g_test_add_func("/edges/laplacian/zero", test_laplacian_zero);
    g_test_add_func("/edges/laplacian/faint", test_laplacian_faint);
    g_test_add_func("/edges/smooth", test_smooth);
    g_test_add_func("/edges/plain/differences", test_plain_differences);
    g_test_add_func("/edges/plain/gaussian", test_plain_gaussian);
    g_test_add_func("/edges/plain/laplacian", test_plain_laplacian);
    g_test_add_func("/edges/plain/ridges", test_plain_ridges);
    g_test_add_func("/edges/otsu", test_otsu);
    g_test_add_func("/edges/hysteresis", test_hysteresis);
    g_test_add_func("/edges/disc", test_disc);
    g_test_add_func("/edges/negative", test_negative);
    g_test_add_func("/edges/blank", test_blank);
    g_test_add_func("/edges/refused", test_refused);
    return g_test_run();
}
