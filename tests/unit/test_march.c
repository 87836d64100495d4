/* Marching squares against exhaustive counting, against fields whose contour is known, and against shapes of known area. */
#include <glib.h>
#include <string.h>

#include "geom/march.h"
#include "geom/polygon.h"
#include "geom/random.h"
#include "geom/ring.h"

static double uniform(uint32_t stream, uint64_t index)
{
    double u[2];
    random_pair(5, stream, 0, index, u);
    return u[0];
}

static MarchField field_of(const uint8_t *px, uint32_t w, uint32_t h)
{
    return (MarchField){.px = px, .width = w, .height = h, .test = 1, .want = 1, .x1 = w - 1, .y1 = h - 1};
}

static bool pixel(const uint8_t *px, int w, int h, int x, int y) { return x >= 0 && y >= 0 && x < w && y < h && px[y * w + x]; }

/* Connected parts of leaf (over corners) or of background (over edges, without the part that meets the outside), by repeated relabelling. */
static uint32_t count_parts(const uint8_t *px, int w, int h, bool leaf)
{
    int label[32 * 32], n = (w + 2) * (h + 2);
    for (int i = 0; i < n; i++)
        label[i] = pixel(px, w, h, i % (w + 2) - 1, i / (w + 2) - 1) == leaf ? i : -1;
    for (bool changed = true; changed;) {
        changed = false;
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++) {
                int dx = abs(i % (w + 2) - j % (w + 2)), dy = abs(i / (w + 2) - j / (w + 2));
                if (label[i] >= 0 && label[j] > label[i] && dx <= 1 && dy <= 1 && (leaf || dx + dy <= 1)) {
                    label[j] = label[i];
                    changed = true;
                }
            }
    }
    uint32_t parts = 0;
    for (int i = 0; i < n; i++)
        parts += label[i] == i;
    return leaf ? parts : parts - 1;
}

/* Signed crossings of the ray to the right of q by all the loops. */
static int winding(const MarchLoops *l, Vec2 q)
{
    int n = 0;
    for (uint32_t k = 0; k < l->n; k++)
        for (uint32_t i = l->start[k]; i < l->start[k + 1]; i++) {
            Vec2 a = l->p[i], b = l->p[i + 1 < l->start[k + 1] ? i + 1 : l->start[k]];
            double left = (b.x - a.x) * (q.y - a.y) - (q.x - a.x) * (b.y - a.y);
            n += a.y <= q.y && b.y > q.y && left > 0.0;
            n -= a.y > q.y && b.y <= q.y && left < 0.0;
        }
    return n;
}

static void assert_simple(const MarchLoops *l)
{
    for (uint32_t k = 0; k < l->n; k++) {
        uint32_t i, j, n = l->start[k + 1] - l->start[k];
        g_assert_cmpuint(n, >=, 4);
        Polygon *p = polygon_new(l->p + l->start[k], n);
        g_assert_cmpfloat(fabs(p->area - fabs(l->area[k])), <=, 1e-9 * (1.0 + p->area));
        g_assert_false(polygon_crossing(p, &i, &j));
        polygon_free(p);
    }
}

/* Area that each pattern cuts off its square, by hand from fig. 5.3: a corner 1/8, half a square, all but a corner. */
static double area_of_squares(const uint8_t *px, int w, int h)
{
    double sum = 0.0;
    for (int y = -1; y < h; y++)
        for (int x = -1; x < w; x++) {
            bool a = pixel(px, w, h, x, y), b = pixel(px, w, h, x + 1, y), c = pixel(px, w, h, x, y + 1), d = pixel(px, w, h, x + 1, y + 1);
            int n = a + b + c + d;
            sum += n == 1 ? 0.125 : n == 2 ? (a == d ? 0.75 : 0.5) : n == 3 ? 0.875 : n == 4;
        }
    return sum;
}

static uint32_t count_steps(const uint8_t *px, int w, int h)
{
    uint32_t n = 0;
    for (int y = -1; y <= h; y++)
        for (int x = -1; x <= w; x++)
            n += (pixel(px, w, h, x, y) != pixel(px, w, h, x + 1, y)) + (pixel(px, w, h, x, y) != pixel(px, w, h, x, y + 1));
    return n;
}

static void check_binary(const uint8_t *px, uint32_t w, uint32_t h, bool thorough)
{
    MarchField f = field_of(px, w, h);
    MarchLoops *l = march_loops(&f, 1);
    double area = 0.0;
    uint32_t outer = 0;
    for (uint32_t k = 0; k < l->n; k++) {
        area += l->area[k];
        outer += l->area[k] > 0.0;
    }
    g_assert_cmpfloat(area, ==, area_of_squares(px, (int)w, (int)h));
    g_assert_cmpuint(l->start[l->n], ==, count_steps(px, (int)w, (int)h));
    g_assert_cmpuint(outer, ==, count_parts(px, (int)w, (int)h, true));
    g_assert_cmpuint(l->n - outer, ==, count_parts(px, (int)w, (int)h, false));
    for (uint32_t i = 0; i < w * h; i++)
        g_assert_cmpint(winding(l, vec2(i % w + 0.5, h - (i / w + 0.5))), ==, px[i]);
    if (thorough)
        assert_simple(l);
    march_loops_free(l);
}

/* Every image of 4 × 4 pixels: all patterns in all neighbourhoods. */
static void test_every_pattern(void)
{
    uint8_t px[16];
    for (uint32_t bits = 0; bits < 65536; bits++) {
        for (int i = 0; i < 16; i++)
            px[i] = bits >> i & 1;
        check_binary(px, 4, 4, bits % 16 == 9);
    }
}

static void test_noise(void)
{
    uint8_t px[20 * 13];
    for (uint32_t k = 0; k < 30; k++) {
        for (uint32_t i = 0; i < sizeof px; i++)
            px[i] = uniform(1, k * sizeof px + i) < 0.1 + 0.03 * k;
        check_binary(px, 20, 13, true);
        check_binary(px, 13, 20, true);
    }
}

/* The sixteen patterns as the thesis draws them: which edges of a lone square are joined. */
static void test_line_table(void)
{
    static const int line_table[16][4] = {{0, 0, 0, 0}, {1, 2, 0, 0}, {1, 3, 0, 0}, {2, 3, 0, 0}, {2, 4, 0, 0}, {1, 4, 0, 0},
                                          {1, 2, 3, 4}, {3, 4, 0, 0}, {3, 4, 0, 0}, {1, 3, 2, 4}, {1, 4, 0, 0}, {2, 4, 0, 0},
                                          {2, 3, 0, 0}, {1, 3, 0, 0}, {1, 2, 0, 0}, {0, 0, 0, 0}};
    const Vec2 middle[5] = {{0, 0}, {0.5, 1.0}, {1.0, 1.5}, {1.0, 0.5}, {1.5, 1.0}}; /* of edges 1 … 4, y up */
    for (int k = 0; k < 16; k++) {
        const uint8_t px[4] = {k & 1, k >> 2 & 1, k >> 1 & 1, k >> 3 & 1};
        MarchField f = field_of(px, 2, 2);
        MarchLoops *l = march_loops(&f, 1);
        for (int s = 0; s < 4; s += 2) {
            bool found = false;
            Vec2 a = middle[line_table[k][s]], b = middle[line_table[k][s + 1]];
            for (uint32_t m = 0; m < l->n; m++)
                for (uint32_t i = l->start[m]; i < l->start[m + 1]; i++) {
                    Vec2 p = l->p[i], q = l->p[i + 1 < l->start[m + 1] ? i + 1 : l->start[m]];
                    found |= (vec_dist2(p, a) == 0.0 && vec_dist2(q, b) == 0.0) || (vec_dist2(p, b) == 0.0 && vec_dist2(q, a) == 0.0);
                }
            g_assert_cmpint(found, ==, line_table[k][s] != 0);
        }
        march_loops_free(l);
    }
}

/* Larger squares see every n-th pixel and draw what that image would give, n times as large; except at the image's own border. */
static void test_squares(void)
{
    enum { W = 61, H = 47 };
    uint8_t px[W * H], coarse[W * H];
    for (uint32_t s = 1; s <= 9; s++) {
        for (uint32_t i = 0; i < W * H; i++)
            px[i] = uniform(2 + s, i) < 0.5 && i % W > 9 && i % W < W - 10 && i / W > 9 && i / W < H - 10;
        uint32_t w = (W - 1) / s + 1, h = (H - 1) / s + 1;
        for (uint32_t y = 0; y < h; y++)
            for (uint32_t x = 0; x < w; x++)
                coarse[y * w + x] = px[y * s * W + x * s];
        MarchField f = field_of(px, W, H), g = field_of(coarse, w, h);
        MarchLoops *a = march_loops(&f, s), *b = march_loops(&g, 1);
        g_assert_cmpuint(a->n, ==, b->n);
        g_assert_cmpuint(a->start[a->n], ==, b->start[b->n]);
        for (uint32_t i = 0; i < a->start[a->n]; i++) {
            g_assert_cmpfloat(a->p[i].x, ==, s * (b->p[i].x - 0.5) + 0.5);
            g_assert_cmpfloat(H - a->p[i].y, ==, s * (h - b->p[i].y - 0.5) + 0.5);
        }
        march_loops_free(a);
        march_loops_free(b);
    }
}

/* An image that is all leaf: its frame with the corners cut, for every square, closed within the image. */
static void test_frame(void)
{
    enum { W = 37, H = 23 };
    uint8_t px[W * H];
    memset(px, 1, sizeof px);
    MarchField f = field_of(px, W, H);
    for (uint32_t s = 1; s <= 40; s++) {
        MarchLoops *l = march_loops(&f, s);
        g_assert_cmpuint(l->n, ==, 1);
        assert_simple(l);
        Box2 b = box_empty();
        for (uint32_t i = 0; i < l->start[1]; i++)
            b = box_add(b, l->p[i]);
        g_assert_true(b.x0 == 0.0 && b.y1 == H);
        g_assert_true(b.x1 <= W && b.y0 >= 0.0 && b.x1 + s > W && b.y0 < s);
        if (s == 1)
            g_assert_cmpfloat(l->area[0], ==, W * H - 0.5);
        march_loops_free(l);
    }
}

static void test_box(void)
{
    enum { W = 30, H = 30 };
    uint8_t px[W * H] = {0};
    for (uint32_t y = 11; y < 19; y++)
        memset(px + y * W + 13, 1, 9);
    for (uint32_t s = 1; s <= 8; s++) {
        MarchField f = field_of(px, W, H), g = f;
        g.x0 = 13, g.x1 = 21, g.y0 = 11, g.y1 = 18;
        MarchLoops *a = march_loops(&f, s), *b = march_loops(&g, s);
        g_assert_cmpuint(a->start[a->n], ==, b->start[b->n]);
        g_assert_cmpint(memcmp(a->p, b->p, a->start[a->n] * sizeof(Vec2)), ==, 0);
        march_loops_free(a);
        march_loops_free(b);
    }
}

static void test_empty(void)
{
    const uint8_t px[6] = {0};
    MarchField f = field_of(px, 3, 2);
    MarchLoops *l = march_loops(&f, 1);
    g_assert_cmpuint(l->n, ==, 0);
    g_assert_cmpuint(march_largest(l), ==, l->n);
    march_loops_free(l);
    march_loops_free(NULL);
}

/* Levels that rise evenly, so that their contour is a straight line: points lie on it whatever the square. */
static double plane_level(const void *user, uint32_t x, uint32_t y)
{
    const double *k = user;
    return k[0] * x + k[1] * y + k[2];
}

static void test_levels_line(void)
{
    enum { W = 64, H = 64 };
    uint8_t px[W * H];
    for (uint32_t k = 0; k < 40; k++) {
        double coefficient[3] = {uniform(20, 3 * k) - 0.5, uniform(20, 3 * k + 1) - 0.5, 0.0};
        coefficient[2] = -32.0 * (coefficient[0] + coefficient[1]) + 0.1;
        for (uint32_t i = 0; i < W * H; i++)
            px[i] = plane_level(coefficient, i % W, i / W) < 0.0;
        MarchField f = field_of(px, W, H);
        f.level = plane_level;
        f.user = coefficient;
        for (uint32_t s = 1; s <= 16; s += 3) {
            MarchLoops *l = march_loops(&f, s);
            g_assert_cmpuint(l->n, ==, 1);
            assert_simple(l);
            uint32_t on_line = 0;
            for (uint32_t i = 0; i < l->start[1]; i++) {
                Vec2 p = vec2(l->p[i].x - 0.5, H - l->p[i].y - 0.5);
                bool inner = p.x > 0.0 && p.y > 0.0 && p.x < W - 1 && p.y < H - 1;
                double off = coefficient[0] * p.x + coefficient[1] * p.y + coefficient[2];
                double scale = fmax(fabs(coefficient[0]), fabs(coefficient[1]));
                g_assert_true(!inner || fabs(off) <= scale / 1024 + 1e-12);
                on_line += inner;
            }
            g_assert_cmpuint(on_line, >, 48 / s);
            march_loops_free(l);
        }
    }
}

/* Levels that touch the threshold exactly, in all ways: still closed and simple. */
static double listed_level(const void *user, uint32_t x, uint32_t y) { return ((const uint8_t *)user)[y * 9 + x]; }

static void test_levels_at_threshold(void)
{
    uint8_t level[81], px[81];
    for (uint32_t k = 0; k < 4000; k++) {
        for (uint32_t i = 0; i < 81; i++) {
            level[i] = (uint8_t)(3.0 * uniform(21, k * 81 + i));
            px[i] = level[i] < 1 + k % 2;
        }
        MarchField f = field_of(px, 9, 9);
        f.level = listed_level;
        f.user = level;
        f.threshold = k % 3 ? 1.0 + k % 2 : 0.5 + k % 2;
        MarchLoops *l = march_loops(&f, 1 + k % 3);
        assert_simple(l);
        march_loops_free(l);
    }
}

/* Shapes of known area and perimeter, drawn with soft edges as a scanner would. */
typedef struct {
    const char *name;
    double area, length;             /* of the shape of size 1 */
    double (*depth)(double x, double y); /* about the distance to its edge, positive inside */
} Shape;

static double disc_depth(double x, double y) { return 1.0 - sqrt(x * x + y * y); }

static double ellipse_depth(double x, double y)
{
    double f = x * x + 4.0 * y * y - 1.0, gx = 2.0 * x, gy = 8.0 * y; /* half axes 1 and 1/2 */
    return -f / fmax(sqrt(gx * gx + gy * gy), 0.5);
}

/* A square standing on a corner, its half diagonal 1. */
static double diamond_depth(double x, double y) { return (1.0 - fabs(x) - fabs(y)) * 0.70710678118654752; }

/* Star of four points at distance 1, with angles of 37°, and notches at (±1/4, ±1/4). */
static double star_depth(double x, double y)
{
    double u = fmax(fabs(x), fabs(y)), v = fmin(fabs(x), fabs(y));
    return (0.25 - 0.25 * u - 0.75 * v) / 0.79056941504209483;
}

static const Shape SHAPES[] = {
    {"disc", 3.14159265358979, 6.28318530717959, disc_depth},
    {"ellipse", 1.57079632679490, 4.84422411027384, ellipse_depth},
    {"diamond", 2.0, 5.65685424949238, diamond_depth},
    {"star", 1.0, 6.32455532033676, star_depth},
};

typedef struct {
    uint32_t n;
    double *level;
} Picture;

static double picture_level(const void *user, uint32_t x, uint32_t y)
{
    const Picture *p = user;
    return p->level[(size_t)y * p->n + x];
}

/* Errors of area and perimeter, relative, of the shape at some size in pixels; mean over several places of the shape on the grid. */
static void measure(const Shape *shape, uint32_t n, bool levels, double *area, double *length)
{
    enum { PLACES = 6 };
    *area = *length = 0.0;
    uint8_t *px = g_new(uint8_t, (gsize)n * n);
    Picture pic = {n, g_new(double, (gsize)n * n)};
    double r = 0.43 * n;
    for (uint32_t k = 0; k < PLACES; k++) {
        double cx = 0.5 * n + uniform(30, 2 * k), cy = 0.5 * n + uniform(30, 2 * k + 1);
        for (size_t i = 0; i < (size_t)n * n; i++) {
            double d = r * shape->depth(((double)(i % n) + 0.5 - cx) / r, ((double)(i / n) + 0.5 - cy) / r);
            pic.level[i] = floor(255.0 * fmin(fmax(d + 0.5, 0.0), 1.0) + 0.5);
            px[i] = pic.level[i] >= 127.5;
        }
        MarchField f = field_of(px, n, n);
        if (levels) {
            f.level = picture_level;
            f.user = &pic;
            f.threshold = 127.5;
        }
        MarchLoops *l = march_loops(&f, 1);
        uint32_t best = march_largest(l);
        Polygon *p = polygon_new(l->p + l->start[best], l->start[best + 1] - l->start[best]);
        *area += fabs(p->area / (shape->area * r * r) - 1.0) / PLACES;
        *length += fabs(ring_length(p) / (shape->length * r) - 1.0) / PLACES;
        polygon_free(p);
        march_loops_free(l);
    }
    g_free(px);
    g_free(pic.level);
}

/* Binary outlines converge with the resolution at first order or better in area, but stay some percent too long; those by levels are nearer to both. */
static void test_convergence(void)
{
    for (uint32_t s = 0; s < G_N_ELEMENTS(SHAPES); s++) {
        double first[2] = {0}, last[2] = {0}, binary_length = 0.0, level_length = 0.0;
        for (uint32_t n = 32; n <= 512; n *= 2) {
            double area[2], length[2];
            measure(&SHAPES[s], n, false, &area[0], &length[0]);
            measure(&SHAPES[s], n, true, &area[1], &length[1]);
            g_test_message("%-8s %4u px: area off by %.2e (binary) %.2e (levels), length %.2e %.2e", SHAPES[s].name, n, area[0], area[1], length[0], length[1]);
            g_assert_cmpfloat(area[0], <=, 2.0 / n);
            for (int k = 0; k < 2; k++) {
                first[k] = n == 32 ? area[k] : first[k];
                last[k] = area[k];
            }
            binary_length = length[0];
            level_length = length[1];
        }
        g_assert_cmpfloat(last[0], <=, first[0] / 8.0);
        g_assert_cmpfloat(last[1], <=, last[0]);
        g_assert_cmpfloat(last[1], <=, 2e-4);
        g_assert_cmpfloat(level_length, <=, 0.006); /* what is left is from 255 levels of soft edge, which are not those of a plane */
        g_assert_true(level_length <= 0.25 * binary_length || binary_length <= 0.005);
    }
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/march/every_pattern", test_every_pattern);
    g_test_add_func("/march/noise", test_noise);
    g_test_add_func("/march/line_table", test_line_table);
    g_test_add_func("/march/squares", test_squares);
    g_test_add_func("/march/frame", test_frame);
    g_test_add_func("/march/box", test_box);
    g_test_add_func("/march/empty", test_empty);
    g_test_add_func("/march/levels_line", test_levels_line);
    g_test_add_func("/march/levels_at_threshold", test_levels_at_threshold);
    g_test_add_func("/march/convergence", test_convergence);
    return g_test_run();
}
