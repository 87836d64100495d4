/* Harris corners: the response against plain sums, and shapes whose corners are known. */
#include <glib.h>

#include "geom/polygon.h"
#include "geom/random.h"
#include "scan/corners.h"

#define CLOSE(a, b, e) g_assert_cmpfloat_with_epsilon((double)(a), (double)(b), e)

static double value(const GreyImage *g, int x, int y)
{
    return (double)g->px[(gsize)CLAMP(y, 0, (int)g->height - 1) * g->width + (gsize)CLAMP(x, 0, (int)g->width - 1)];
}

/* Part of each pixel that the polygon covers, by 8 × 8 samples. */
static GreyImage *draw(const Vec2 *v, uint32_t n, uint32_t size)
{
    Polygon *p = polygon_new(v, n);
    GreyImage *g = grey_image_new(size, size);
    for (uint32_t i = 0; i < size * size; i++)
        for (uint32_t k = 0; k < 64; k++)
            g->px[i] += polygon_contains(p, vec2(i % size + (k % 8 + 0.5) / 8.0, i / size + (k / 8 + 0.5) / 8.0)) ? 1.0f / 64.0f : 0.0f;
    polygon_free(p);
    return g;
}

/* The sides cut into pieces of `step` or less; the corners are among the points, at[k] the k-th. */
static GArray *sample(const Vec2 *v, uint32_t n, double step, uint32_t *at)
{
    GArray *points = g_array_new(FALSE, FALSE, sizeof(Vec2));
    for (uint32_t i = 0; i < n; i++) {
        Vec2 a = v[i], b = v[(i + 1) % n];
        int pieces = (int)ceil(vec_dist(a, b) / step);
        at[i] = points->len;
        for (int k = 0; k < pieces; k++) {
            Vec2 p = vec_lerp(a, b, (double)k / pieces);
            g_array_append_val(points, p);
        }
    }
    return points;
}

/* The boundary of the pixels that are at least half covered, a vertex at every pixel corner it passes, the disc's or star's inside on the
 * left in the sense of x towards y. The shape must be simple and not touch itself diagonally. */
static GArray *staircase(const GreyImage *g)
{
    int size = (int)g->width, x = 0, y = 0, dx = 1, dy = 0;
    while (value(g, x, y) < 0.5) {
        x = (x + 1) % size;
        y += x == 0;
    }
    const int x0 = x, y0 = y; /* upper left corner of the first pixel; set off along its upper side */
    GArray *points = g_array_new(FALSE, FALSE, sizeof(Vec2));
    do {
        Vec2 p = vec2(x, y);
        g_array_append_val(points, p);
        x += dx;
        y += dy;
        /* the pixels ahead on the left and on the right of the walk; the shape lies to its right (y down) */
        int lx = x + (dx + dy - 1) / 2, ly = y + (dy - dx - 1) / 2, rx = x + (dx - dy - 1) / 2, ry = y + (dy + dx - 1) / 2;
        bool left = value(g, lx, ly) >= 0.5, right = value(g, rx, ry) >= 0.5;
        int t = dx;
        if (left) { /* turn left */
            dx = dy;
            dy = -t;
        } else if (!right) { /* turn right */
            dx = -dy;
            dy = t;
        }
    } while (x != x0 || y != y0);
    return points;
}

static uint32_t nearest(const GArray *points, Vec2 q)
{
    uint32_t best = 0;
    for (uint32_t i = 1; i < points->len; i++)
        if (vec_dist2(g_array_index(points, Vec2, i), q) < vec_dist2(g_array_index(points, Vec2, best), q))
            best = i;
    return best;
}

static GArray *find(const GreyImage *g, const GArray *points, uint32_t base, uint32_t tip, const CornersDef *def)
{
    GError *error = NULL;
    GArray *found = corners_find(g, &g_array_index(points, Vec2, 0), points->len, base, tip, def, &error);
    g_assert_no_error(error);
    for (guint k = 1; k < found->len; k++)
        g_assert_cmpuint(g_array_index(found, Corner, k - 1).at, <, g_array_index(found, Corner, k).at);
    return found;
}

static bool has(const GArray *found, uint32_t at)
{
    for (guint k = 0; k < found->len; k++)
        if (g_array_index(found, Corner, k).at == at)
            return true;
    return false;
}

/* n corners about the middle of 128 × 128 pixels, radii r and s in turn; `turn` and the angles through libm, which is well enough here. */
static void star(Vec2 *v, uint32_t n, double r, double s, double turn)
{
    for (uint32_t i = 0; i < n; i++) {
        double a = turn + 2.0 * G_PI * i / n, radius = i % 2 ? s : r;
        v[i] = vec2(64.2 + radius * cos(a), 63.7 + radius * sin(a));
    }
}

/* --- response --- */

/* Sobel, products, window, all as plain sums over two dimensions. */
static void test_plain(void)
{
    enum { N = 24, R = 8 };
    GreyImage *g = grey_image_new(N, N), *unit = grey_image_new(N, N);
    double least = 1.0, most = 0.0;
    for (uint32_t i = 0; i < N * N; i++) {
        double u[2];
        random_pair(6, 1, 0, i, u);
        unit->px[i] = (float)u[0];
        least = MIN(least, (double)unit->px[i]);
        most = MAX(most, (double)unit->px[i]);
    }
    for (uint32_t i = 0; i < N * N; i++) {
        unit->px[i] = (float)(((double)unit->px[i] - least) / (most - least));
        g->px[i] = 40.0f + 200.0f * unit->px[i];
    }
    CornersDef def = {.smoothing = 0.0, .window = 2.0, .k = 0.06, .threshold = 0.1, .spacing = 3.0};
    GreyImage *r = corners_response(g, &def, NULL);
    for (int y = 0; y < N; y++)
        for (int x = 0; x < N; x++) {
            double a = 0.0, b = 0.0, c = 0.0, all = 0.0;
            for (int j = -R; j <= R; j++)
                for (int i = -R; i <= R; i++) {
                    int px = CLAMP(x + i, 0, N - 1), py = CLAMP(y + j, 0, N - 1);
                    double w = exp(-(i * i + j * j) / 8.0), gx = 0.0, gy = 0.0;
                    for (int k = -1; k <= 1; k++) {
                        gx += (2 - abs(k)) * (value(unit, px + 1, py + k) - value(unit, px - 1, py + k)) / 8.0;
                        gy += (2 - abs(k)) * (value(unit, px + k, py + 1) - value(unit, px + k, py - 1)) / 8.0;
                    }
                    a += w * gx * gx;
                    b += w * gx * gy;
                    c += w * gy * gy;
                    all += w;
                }
            CLOSE(r->px[y * N + x], (a * c - b * b - 0.06 * (a + c) * (a + c)) / (all * all), 1e-6);
        }
    grey_image_free(g);
    grey_image_free(unit);
    grey_image_free(r);
}

/* On a straight edge det M is 0 whatever its direction; on plain ground all is; at a corner the response is positive. */
static void test_signs(void)
{
    CornersDef def = corners_def_default();
    for (int k = 0; k < 8; k++) {
        Vec2 v[4];
        star(v, 4, 50.0, 50.0, 0.2 * k);
        GreyImage *g = draw(v, 4, 128), *r = corners_response(g, &def, NULL);
        Vec2 middle = vec_lerp(v[0], v[1], 0.5), corner = vec_lerp(v[0], v[2], 0.02);
        double edge = (double)r->px[(gsize)middle.y * 128 + (gsize)middle.x], top = (double)r->px[(gsize)corner.y * 128 + (gsize)corner.x];
        g_assert_cmpfloat(edge, <, 0.0);
        g_assert_cmpfloat(top, >, -0.2 * edge);
        g_assert_true(r->px[64 * 128 + 64] == 0.0f && r->px[0] == 0.0f);
        grey_image_free(g);
        grey_image_free(r);
    }
}

/* --- known corners --- */

/* Squares and stars at many angles: every corner, at its very vertex, and nothing else but base and tip. */
static void test_stars(void)
{
    CornersDef def = corners_def_default();
    const struct {
        uint32_t n;
        double r, s;
    } shapes[] = {{4, 45, 45}, {3, 50, 50}, {6, 55, 55}, {10, 58, 26}, {8, 58, 22}, {6, 58, 8}};
    for (uint32_t s = 0; s < G_N_ELEMENTS(shapes); s++)
        for (int k = 0; k < 7; k++) {
            Vec2 v[10];
            uint32_t n = shapes[s].n, at[10] = {0};
            star(v, n, shapes[s].r, shapes[s].s, 0.13 * k);
            GreyImage *g = draw(v, n, 128);
            GArray *points = sample(v, n, 0.5, at);
            GArray *found = find(g, points, at[0], at[n / 2], &def);
            for (uint32_t i = 0; i < n; i++)
                g_assert_true(has(found, at[i]));
            g_assert_cmpuint(found->len, ==, n);
            g_array_unref(found);
            uint32_t base = (at[0] + at[1]) / 2, tip = (at[1] + at[2]) / 2; /* on the sides: they come on top */
            found = find(g, points, base, tip, &def);
            g_assert_true(has(found, base) && has(found, tip));
            g_assert_cmpuint(found->len, ==, n + 2);
            for (uint32_t i = 0; i < n; i++)
                g_assert_true(has(found, at[i]));
            g_array_unref(found);
            g_array_unref(points);
            grey_image_free(g);
        }
}

/* The same along the boundary of pixels, which cuts sharp tips by two of them. */
static void test_staircase(void)
{
    CornersDef def = corners_def_default();
    for (int k = 0; k < 7; k++) {
        Vec2 v[10];
        star(v, 10, 58, 26, 0.1 + 0.13 * k);
        GreyImage *g = draw(v, 10, 128);
        GArray *points = staircase(g);
        GArray *found = find(g, points, nearest(points, v[0]), nearest(points, v[4]), &def);
        g_assert_cmpuint(found->len, ==, 10);
        for (guint i = 0; i < found->len; i++) {
            double least = HUGE_VAL;
            for (uint32_t j = 0; j < 10; j++)
                least = MIN(least, vec_dist(v[j], g_array_index(points, Vec2, g_array_index(found, Corner, i).at)));
            g_assert_cmpfloat(least, <, 2.5);
        }
        g_array_unref(found);
        g_array_unref(points);
        grey_image_free(g);
    }
}

/* No corner on circles wider than the bend that k and the window allow, drawn smoothly or as pixels. */
static void test_circle(void)
{
    CornersDef def = corners_def_default();
    for (double r = 13.0; r < 60.0; r += 9.3) {
        Vec2 v[400];
        star(v, 400, r, r, 0.3);
        GreyImage *g = draw(v, 400, 128);
        uint32_t at[400];
        GArray *fine = sample(v, 400, 0.5, at), *stairs = staircase(g);
        for (int k = 0; k < 2; k++) {
            GArray *points = k ? stairs : fine, *found = find(g, points, 3, points->len / 2, &def);
            g_assert_cmpuint(found->len, ==, 2);
            g_assert_true(has(found, 3) && has(found, points->len / 2));
            g_array_unref(found);
            g_array_unref(points);
        }
        grey_image_free(g);
    }
}

/* On noise: the points keep their distance, are strong enough, and whatever local maximum was left out had a neighbour too near. */
static void test_spacing(void)
{
    GreyImage *g = grey_image_new(128, 128);
    for (uint32_t i = 0; i < 128 * 128; i++) {
        double u[2];
        random_pair(6, 2, 0, i, u);
        g->px[i] = (float)u[0];
    }
    Vec2 v[300];
    uint32_t at[300];
    star(v, 300, 50, 50, 0.0);
    GArray *points = sample(v, 300, 0.25, at);
    double whole = 2.0 * G_PI * 50.0, step = whole / points->len;
    guint before = G_MAXUINT;
    for (double spacing = 0.0; spacing < 60.0; spacing = 2.0 * spacing + 3.0) {
        CornersDef def = {.smoothing = 1.0, .window = 1.0, .k = 0.04, .threshold = 0.1, .spacing = spacing};
        GArray *found = find(g, points, 17, 600, &def);
        g_assert_true(has(found, 17) && has(found, 600));
        g_assert_cmpuint(found->len, <, before);
        before = found->len;
        double most = 0.0;
        for (guint k = 0; k < found->len; k++) {
            const Corner *c = &g_array_index(found, Corner, k), *d = &g_array_index(found, Corner, (k + 1) % found->len);
            double gap = ((d->at + points->len - c->at) % points->len) * step;
            g_assert_cmpfloat(gap, >=, 0.999 * spacing);
            g_assert_cmpfloat(gap, <=, 2.0 * spacing + 40.0); /* noise has corners all over */
            most = MAX(most, c->response);
            if (c->at != 17 && c->at != 600)
                g_assert_cmpfloat(c->response, >, 0.0);
        }
        for (guint k = 0; k < found->len; k++) {
            const Corner *c = &g_array_index(found, Corner, k);
            g_assert_true(c->at == 17 || c->at == 600 || c->response >= 0.1 * most);
        }
        g_array_unref(found);
    }
    g_array_unref(points);
    grey_image_free(g);
}

/* The answer does not change with the scale of grey values, nor with black and white exchanged. */
static void test_grey_scale(void)
{
    CornersDef def = corners_def_default();
    Vec2 v[10];
    uint32_t at[10];
    star(v, 10, 58, 26, 0.4);
    GreyImage *a = draw(v, 10, 128), *b = grey_image_new(128, 128);
    for (uint32_t i = 0; i < 128 * 128; i++)
        b->px[i] = 220.0f - 150.0f * a->px[i];
    GArray *points = sample(v, 10, 0.5, at), *p = find(a, points, at[0], at[5], &def), *q = find(b, points, at[0], at[5], &def);
    g_assert_cmpuint(p->len, ==, q->len);
    for (guint k = 0; k < p->len; k++) {
        g_assert_cmpuint(g_array_index(p, Corner, k).at, ==, g_array_index(q, Corner, k).at);
        CLOSE(g_array_index(p, Corner, k).response, g_array_index(q, Corner, k).response, 1e-6);
    }
    g_array_unref(p);
    g_array_unref(q);
    g_array_unref(points);
    grey_image_free(a);
    grey_image_free(b);
}

/* Contours larger than `size` are looked at more coarsely, in proportion; smaller ones are not. So rounded tips count however finely they are scanned. */
static void test_size(void)
{
    enum { N = 128, TIPS = 6 };
    Vec2 v[N];
    uint32_t at[N], count[3];
    for (uint32_t i = 0; i < N; i++) { /* tips as blunt as discs of some 6 pixels' radius */
        double a = 2.0 * G_PI * i / N, r = 40.0 + 14.0 * cos(TIPS * a);
        v[i] = vec2(64.2 + r * cos(a), 63.7 + r * sin(a));
    }
    for (uint32_t zoom = 1; zoom <= 3; zoom++) {
        Vec2 big[N];
        for (uint32_t i = 0; i < N; i++)
            big[i] = vec_scale(v[i], zoom);
        GreyImage *g = draw(big, N, zoom * 128);
        GArray *points = sample(big, N, 0.5, at);
        Box2 box = box_empty();
        for (guint i = 0; i < points->len; i++)
            box = box_add(box, g_array_index(points, Vec2, i));
        CornersDef def = corners_def_default();
        def.size = vec_dist(vec2(box.x0, box.y0), vec2(box.x1, box.y1)) / zoom;
        GArray *found = find(g, points, at[0], at[N / 2], &def);
        count[zoom - 1] = found->len;
        def.smoothing *= zoom;
        def.window *= zoom;
        def.spacing *= zoom;
        for (double size = 0.0; size < 1e5; size += 9e4) { /* none, and one larger than the contour */
            def.size = size;
            GArray *same = find(g, points, at[0], at[N / 2], &def);
            g_assert_cmpuint(same->len, ==, found->len);
            for (guint k = 0; k < found->len; k++)
                g_assert_cmpuint(g_array_index(same, Corner, k).at, ==, g_array_index(found, Corner, k).at);
            g_array_unref(same);
        }
        g_array_unref(found);
        g_array_unref(points);
        grey_image_free(g);
    }
    g_assert_cmpuint(count[0], >=, TIPS);
    g_assert_cmpuint(count[1], ==, count[0]);
    g_assert_cmpuint(count[2], ==, count[0]);
}

/* --- refusals --- */

static void refuse(const GreyImage *g, const Vec2 *v, uint32_t n, uint32_t base, uint32_t tip, CornersDef def, GQuark domain, int code,
                   const char *part)
{
    GError *error = NULL;
    g_assert_null(corners_find(g, v, n, base, tip, &def, &error));
    g_assert_error(error, domain, code);
    if (!strstr(error->message, part))
        g_error("'%s' does not say '%s'", error->message, part);
    g_error_free(error);
}

static void test_refused(void)
{
    const CornersDef good = corners_def_default();
    GreyImage *g = grey_image_new(10, 10), *empty = grey_image_new(10, 0);
    Vec2 v[4] = {{1, 1}, {8, 1}, {8, 8}, {1, 8}};
    CornersDef def = good;
    GArray *found = corners_find(g, v, 4, 0, 2, &good, NULL); /* a blank image has no corners, but the leaf its ends */
    g_assert_cmpuint(found->len, ==, 2);
    g_array_unref(found);
    v[1] = vec2(-400, 1e6); /* outside the image is no error */
    found = corners_find(g, v, 4, 0, 2, &good, NULL);
    g_assert_cmpuint(found->len, ==, 2);
    g_array_unref(found);
    refuse(g, v, 2, 0, 1, def, CORNERS_ERROR, CORNERS_ERROR_CONTOUR, "2 points");
    refuse(g, v, 4, 0, 4, def, CORNERS_ERROR, CORNERS_ERROR_CONTOUR, "points 0 and 4");
    refuse(g, v, 4, 1, 1, def, CORNERS_ERROR, CORNERS_ERROR_CONTOUR, "points 1 and 1");
    refuse(empty, v, 4, 0, 1, def, EDGES_ERROR, EDGES_ERROR_IMAGE, "10 × 0");
    def.window = 0.0;
    refuse(g, v, 4, 0, 1, def, CORNERS_ERROR, CORNERS_ERROR_SETTINGS, "window is 0");
    def = good;
    def.smoothing = -1.0;
    refuse(g, v, 4, 0, 1, def, CORNERS_ERROR, CORNERS_ERROR_SETTINGS, "smoothing is -1");
    def = good;
    def.k = (double)NAN;
    refuse(g, v, 4, 0, 1, def, CORNERS_ERROR, CORNERS_ERROR_SETTINGS, "between 0 and 0.25");
    def = good;
    def.threshold = 1.5;
    refuse(g, v, 4, 0, 1, def, CORNERS_ERROR, CORNERS_ERROR_SETTINGS, "threshold");
    def = good;
    def.spacing = -3.0;
    refuse(g, v, 4, 0, 1, def, CORNERS_ERROR, CORNERS_ERROR_SETTINGS, "spacing");
    def = good;
    def.size = (double)NAN;
    refuse(g, v, 4, 0, 1, def, CORNERS_ERROR, CORNERS_ERROR_SETTINGS, "size");
    v[3].y = (double)NAN;
    refuse(g, v, 4, 0, 1, good, CORNERS_ERROR, CORNERS_ERROR_CONTOUR, "point 3");
    grey_image_free(g);
    grey_image_free(empty);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/corners/plain", test_plain);
    g_test_add_func("/corners/signs", test_signs);
    g_test_add_func("/corners/stars", test_stars);
    g_test_add_func("/corners/staircase", test_staircase);
    g_test_add_func("/corners/circle", test_circle);
    g_test_add_func("/corners/spacing", test_spacing);
    g_test_add_func("/corners/grey-scale", test_grey_scale);
    g_test_add_func("/corners/size", test_size);
    g_test_add_func("/corners/refused", test_refused);
    return g_test_run();
}
