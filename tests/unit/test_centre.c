/* Thinning against brute force; centre lines of strokes whose middle and width are known; tracings as text; and real ones where there are any: in the
 * folder that VENATION_SCANS names, else shared/scans beside the checkout. */
#include <glib.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#include "geom/random.h"
#include "import/drawing_file.h"
#include "scan/centre_private.h"
#include "scan/scan.h"

static double uniform(uint32_t stream, uint64_t index)
{
    double u[2];
    random_pair(29, stream, 0, index, u);
    return u[0];
}

static Mask mask_new(uint32_t width, uint32_t height) { return (Mask){width, height, width, g_new0(uint8_t, (size_t)width * height)}; }

/* ---- thinning ---- */

enum { W = 45, H = 38 };

static bool has(const Mask *m, int x, int y, uint8_t bit)
{
    return x >= 0 && y >= 0 && x < (int)m->width && y < (int)m->height && (*mask_at(m, (uint32_t)x, (uint32_t)y) & bit);
}

/* Connected parts of pixels with the bit (over corners), or of those without, the surroundings among them (over edges only). */
static uint32_t count_parts(const Mask *m, uint8_t bit, bool set)
{
    int w = (int)m->width + 2, h = (int)m->height + 2;
    bool *seen = g_new0(bool, w * h);
    int *stack = g_new(int, 9 * w * h);
    uint32_t parts = 0;
    for (int i = 0; i < w * h; i++) {
        int n = 0;
        if (seen[i] || has(m, i % w - 1, i / w - 1, bit) != set)
            continue;
        parts++;
        stack[n++] = i;
        while (n > 0) {
            int at = stack[--n];
            if (seen[at])
                continue;
            seen[at] = true;
            for (int k = 0; k < 9; k++) {
                int x = at % w + k % 3 - 1, y = at / w + k / 3 - 1;
                if (x >= 0 && y >= 0 && x < w && y < h && (set || k % 2 == 1) && !seen[y * w + x] && has(m, x - 1, y - 1, bit) == set)
                    stack[n++] = y * w + x;
            }
        }
    }
    g_free(seen);
    g_free(stack);
    return parts;
}

/* Whether taking the pixel away would change how what is around it hangs together, by counting in its neighbourhood. */
static bool is_simple(const Mask *m, int x, int y, uint8_t bit, uint32_t *neighbours)
{
    uint8_t px[9] = {0};
    Mask around = {3, 3, 3, px};
    *neighbours = 0;
    for (int k = 0; k < 9; k++)
        if (k != 4 && has(m, x + k % 3 - 1, y + k / 3 - 1, bit)) {
            px[k] = 1;
            ++*neighbours;
        }
    bool border = !px[1] || !px[3] || !px[5] || !px[7];
    return border && count_parts(&around, 1, true) == 1;
}

static void assert_thinned(const Mask *m, uint8_t from, uint8_t to)
{
    g_assert_cmpuint(count_parts(m, to, true), ==, count_parts(m, from, true));
    g_assert_cmpuint(count_parts(m, to, false), ==, count_parts(m, from, false));
    for (int y = 0; y < (int)m->height; y++)
        for (int x = 0; x < (int)m->width; x++) {
            uint32_t neighbours;
            if (!has(m, x, y, to))
                continue;
            g_assert_true(has(m, x, y, from));
            g_assert_true(!is_simple(m, x, y, to, &neighbours) || neighbours == 1); /* nothing more can go */
        }
}

/* Random pixels, and random discs, which are thick and have holes. */
static void random_region(const Mask *m, uint32_t stream)
{
    memset(m->px, 0, (size_t)m->width * m->height);
    if (stream % 2)
        for (uint32_t i = 0; i < m->width * m->height; i++)
            m->px[i] = uniform(stream, i) < 0.3 + 0.6 * uniform(stream, 100000) ? 1 : 0;
    else
        for (uint32_t k = 0; k < 30; k++) {
            double cx = uniform(stream, 3 * k) * m->width, cy = uniform(stream, 3 * k + 1) * m->height, r = 1.0 + 5.0 * uniform(stream, 3 * k + 2);
            for (uint32_t i = 0; i < m->width * m->height; i++)
                if (hypot(i % m->width + 0.5 - cx, i / m->width + 0.5 - cy) <= r)
                    m->px[i] = 1;
        }
}

static void test_topology(void)
{
    Mask m = mask_new(W, H);
    for (uint32_t k = 0; k < 600; k++) {
        random_region(&m, 100 + k);
        for (uint32_t i = 0; i < W * H; i++)
            m.px[i] |= (uint8_t)(i % 3 ? 2 | 8 : 8); /* rubbish in the target, and a bit of somebody else's */
        centre_thin(&m, 1, 2);
        assert_thinned(&m, 1, 2);
        uint8_t *once = g_memdup2(m.px, W * H);
        centre_thin(&m, 2, 4);
        for (uint32_t i = 0; i < W * H; i++)
            g_assert_cmpuint(m.px[i], ==, once[i] | (once[i] & 2) << 1); /* lines stay as they are; bit 8 too */
        memcpy(m.px, once, W * H);
        centre_thin(&m, 1, 1); /* in place */
        for (uint32_t i = 0; i < W * H; i++)
            g_assert_cmpuint(m.px[i] & 1, ==, once[i] >> 1 & 1);
        g_free(once);
    }
    g_free(m.px);
}

/* All masks of 4 × 4 pixels. */
static void test_topology_small(void)
{
    uint8_t px[16];
    Mask m = {4, 4, 4, px};
    for (uint32_t set = 0; set < 1 << 16; set++) {
        for (uint32_t i = 0; i < 16; i++)
            px[i] = set >> i & 1;
        centre_thin(&m, 1, 2);
        if (set % 7 == 0) /* the whole of it takes long */
            assert_thinned(&m, 1, 2);
        else
            g_assert_cmpuint(count_parts(&m, 2, true), ==, count_parts(&m, 1, true));
    }
}

static void test_distances(void)
{
    Mask m = mask_new(W, H);
    for (uint32_t k = 0; k < 60; k++) {
        random_region(&m, 1000 + k);
        if (k == 0)
            memset(m.px, 1, W * H);
        Thinned t;
        if (!thinned_init(&t, &m, 1, 0.0))
            continue;
        g_assert_cmpuint(t.n, >, 0);
        for (uint32_t i = 0; i < t.n; i++) {
            Vec2 p = thinned_place(&t, t.at[i]);
            double x = p.x + t.box.x0, y = p.y + t.box.y0, least = HUGE_VAL;
            for (int v = -1; v <= H; v++)
                for (int u = -1; u <= W; u++)
                    if (!has(&m, u, v, 1))
                        least = fmin(least, hypot(u - x, v - y));
            g_assert_cmpfloat(fabs(t.radius[i] - (least - 0.5)), <=, 1e-9);
        }
        thinned_clear(&t);
    }
    g_free(m.px);
}

/* ---- shapes ---- */

/* Pixels within reach of a segment whose half width goes from ra to rb; y up. */
static void sweep(const Mask *m, Vec2 a, Vec2 b, double ra, double rb)
{
    Vec2 d = vec_sub(b, a);
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++) {
            Vec2 p = vec2(x + 0.5, m->height - y - 0.5);
            double t = vec_norm2(d) > 0.0 ? fmin(fmax(vec_dot(vec_sub(p, a), d) / vec_norm2(d), 0.0), 1.0) : 0.0;
            if (vec_dist(p, vec_lerp(a, b, t)) <= ra + (rb - ra) * t)
                *mask_at(m, x, y) |= 1;
        }
}

static double segment_distance(Vec2 p, Vec2 a, Vec2 b)
{
    Vec2 d = vec_sub(b, a);
    double t = vec_norm2(d) > 0.0 ? fmin(fmax(vec_dot(vec_sub(p, a), d) / vec_norm2(d), 0.0), 1.0) : 0.0;
    return vec_dist(p, vec_lerp(a, b, t));
}

static double drawing_distance(const Drawing *d, Vec2 p)
{
    double least = HUGE_VAL;
    for (uint32_t i = 0; i < d->n; i++)
        for (uint32_t k = 1; k < d->vein[i].n; k++)
            least = fmin(least, segment_distance(p, d->vein[i].point[k - 1], d->vein[i].point[k]));
    return least;
}

static double vein_length(const DrawnVein *v)
{
    double length = 0.0;
    for (uint32_t k = 1; k < v->n; k++)
        length += vec_dist(v->point[k - 1], v->point[k]);
    return length;
}

static double drawing_length(const Drawing *d)
{
    double length = 0.0;
    for (uint32_t i = 0; i < d->n; i++)
        length += vein_length(&d->vein[i]);
    return length;
}

static Drawing *lines_of(const Mask *m)
{
    CentreDef def = centre_def_default();
    uint8_t *before = g_memdup2(m->px, (size_t)m->width * m->height);
    Drawing *d = centre_lines(m, 1, &def);
    g_assert_true(memcmp(before, m->px, (size_t)m->width * m->height) == 0);
    g_free(before);
    for (uint32_t i = 0; i < d->n; i++) {
        g_assert_cmpuint(d->vein[i].n, >=, 2);
        for (uint32_t k = 0; k < d->vein[i].n; k++) {
            Vec2 p = d->vein[i].point[k];
            g_assert_true(p.x >= 0.0 && p.y >= 0.0 && p.x <= m->width && p.y <= m->height && d->vein[i].width[k] > 0.0);
        }
    }
    return d;
}

static void assert_near(Vec2 p, Vec2 q, double within)
{
    if (!(vec_dist(p, q) <= within))
        g_error("%.2f,%.2f is %.2f from %.2f,%.2f, not %.2f", p.x, p.y, vec_dist(p, q), q.x, q.y, within);
}

static bool starts_at(const DrawnVein *v, Vec2 p, double within)
{
    return vec_dist(v->point[0], p) <= within || vec_dist(v->point[v->n - 1], p) <= within;
}

/* Directions whose sines and cosines are rational. */
static Vec2 direction(double t) { return vec2((1.0 - t * t) / (1.0 + t * t), 2.0 * t / (1.0 + t * t)); }

static void test_stroke(void)
{
    double worst = 0.0, worst_width = 0.0, worst_end = 0.0, bias = 0.0;
    uint32_t n = 0;
    for (uint32_t k = 0; k < 120; k++) {
        Mask m = mask_new(180, 180);
        double r = 1.0 + 9.0 * (k % 12) / 12.0 + 0.3 * uniform(2000, 3 * k);
        Vec2 u = direction(-1.0 + 2.0 * k / 120.0), c = vec2(90.0 + uniform(2000, 3 * k + 1), 90.0 + uniform(2000, 3 * k + 2));
        Vec2 a = vec_sub(c, vec_scale(u, 55.0)), b = vec_add(c, vec_scale(u, 55.0));
        sweep(&m, a, b, r, r);
        Drawing *d = lines_of(&m);
        g_assert_cmpuint(d->n, ==, 1);
        DrawnVein *v = &d->vein[0];
        g_assert_cmpuint(v->n, <=, 8);
        for (uint32_t i = 0; i < v->n; i++) {
            worst = fmax(worst, fabs(vec_cross(vec_sub(v->point[i], a), u)));
            worst_width = fmax(worst_width, fabs(v->width[i] - 2.0 * r));
            bias += v->width[i] - 2.0 * r;
            n++;
        }
        Vec2 tip_a = vec_sub(a, vec_scale(u, r)), tip_b = vec_add(b, vec_scale(u, r));
        bool turned = vec_dist(v->point[0], tip_a) > vec_dist(v->point[0], tip_b);
        worst_end = fmax(worst_end, fmax(vec_dist(v->point[turned ? v->n - 1 : 0], tip_a), vec_dist(v->point[turned ? 0 : v->n - 1], tip_b)));
        drawing_free(d);
        g_free(m.px);
    }
    g_test_message("strokes: at most %.2f beside the middle, widths off by %.2f at most and %+.3f in the mean, ends by %.2f", worst, worst_width, bias / n, worst_end);
    g_assert_cmpfloat(worst, <=, 0.75);
    g_assert_cmpfloat(worst_width, <=, 1.0);
    g_assert_cmpfloat(fabs(bias / n), <=, 0.15);
    g_assert_cmpfloat(worst_end, <=, 1.6);
}

static void test_taper(void)
{
    Mask m = mask_new(320, 80);
    sweep(&m, vec2(20.0, 40.3), vec2(300.0, 33.0), 14.0, 1.0);
    Drawing *d = lines_of(&m);
    g_assert_cmpuint(d->n, ==, 1);
    for (uint32_t i = 0; i < d->vein[0].n; i++) {
        Vec2 p = d->vein[0].point[i];
        double t = fmin(fmax((p.x - 20.0) / 280.0, 0.0), 1.0);
        g_assert_cmpfloat(fabs(p.y - (40.3 - 7.3 * t)), <=, 1.2);
        if (p.x > 40.0)
            g_assert_cmpfloat(fabs(d->vein[0].width[i] - 2.0 * (14.0 - 13.0 * t)), <=, 1.5);
    }
    g_assert_true(starts_at(&d->vein[0], vec2(301.0, 33.0), 1.6));
    g_assert_true(starts_at(&d->vein[0], vec2(6.0, 40.6), 2.0));
    drawing_free(d);
    g_free(m.px);
}

/* Two arms that nearly go on, and one that leaves them. */
static void test_y(void)
{
    for (uint32_t k = 0; k < 24; k++) {
        Mask m = mask_new(200, 200);
        double r = 2.0 + 0.25 * k;
        Vec2 u = direction(-1.0 + k / 12.0), across = vec2(-u.y, u.x), c = vec2(100.2, 99.7);
        Vec2 end[3] = {vec_sub(c, vec_scale(u, 70.0)), vec_add(c, vec_add(vec_scale(u, 65.0), vec_scale(across, 10.0))),
                       vec_add(c, vec_add(vec_scale(u, 42.0), vec_scale(across, -56.0)))};
        for (uint32_t i = 0; i < 3; i++)
            sweep(&m, c, end[i], i == 2 ? 0.7 * r : r, i == 2 ? 0.7 * r : r);
        Drawing *d = lines_of(&m);
        g_assert_cmpuint(d->n, ==, 2);
        uint32_t side = starts_at(&d->vein[0], end[2], 0.7 * r + 2.0) ? 0 : 1;
        const DrawnVein *s = &d->vein[side], *through = &d->vein[1 - side];
        g_assert_true(starts_at(s, end[2], 0.7 * r + 2.0) && starts_at(s, c, 0.6 * r + 2.0));
        g_assert_true(starts_at(through, end[0], r + 2.0) && starts_at(through, end[1], r + 2.0));
        Vec2 foot = vec_dist(s->point[0], c) < vec_dist(s->point[s->n - 1], c) ? s->point[0] : s->point[s->n - 1];
        bool shared = false;
        for (uint32_t i = 1; i + 1 < through->n; i++)
            shared |= through->point[i].x == foot.x && through->point[i].y == foot.y;
        g_assert_true(shared);
        for (uint32_t i = 0; i < through->n; i++) {
            g_assert_cmpfloat(fmin(segment_distance(through->point[i], c, end[0]), segment_distance(through->point[i], c, end[1])), <=, r + 1.6);
            g_assert_cmpfloat(fabs(through->width[i] - 2.0 * r), <=, 1.2); /* at the junction too */
        }
        for (uint32_t i = 0; i < s->n; i++)
            g_assert_cmpfloat(fabs(s->width[i] - 1.4 * r), <=, 1.2);
        drawing_free(d);
        g_free(m.px);
    }
}

/* Lines that cross are two veins, also when thinning has two junctions. */
static void test_cross(void)
{
    static const double across[] = {1.0, 0.8, 0.7, 0.6}; /* tangents of half the angle between them: 90° … 62° */
    for (uint32_t k = 0; k < 16; k++) {
        Mask m = mask_new(240, 240);
        double r = 2.5 + k % 5 * 1.5;
        Vec2 c = vec2(119.6 + 0.1 * k, 120.2), turn = direction(-0.3 + 0.05 * k), u = vec2(1.0, across[k % 4]), w = vec2(1.0, -across[k % 4]);
        u = vec2(u.x * turn.x - u.y * turn.y, u.x * turn.y + u.y * turn.x);
        w = vec2(w.x * turn.x - w.y * turn.y, w.x * turn.y + w.y * turn.x);
        sweep(&m, vec_sub(c, vec_scale(u, 70.0)), vec_add(c, vec_scale(u, 70.0)), r, r);
        sweep(&m, vec_sub(c, vec_scale(w, 70.0)), vec_add(c, vec_scale(w, 70.0)), r, r);
        Drawing *d = lines_of(&m);
        g_assert_cmpuint(d->n, ==, 2);
        bool shared = false;
        for (uint32_t i = 0; i < d->vein[0].n; i++)
            for (uint32_t j = 0; j < d->vein[1].n; j++)
                if (d->vein[0].point[i].x == d->vein[1].point[j].x && d->vein[0].point[i].y == d->vein[1].point[j].y) {
                    assert_near(d->vein[0].point[i], c, 1.5);
                    shared = true;
                }
        g_assert_true(shared);
        for (uint32_t i = 0; i < 2; i++)
            for (uint32_t j = 0; j < d->vein[i].n; j++) {
                Vec2 p = vec_sub(d->vein[i].point[j], c);
                g_assert_cmpfloat(fmin(fabs(vec_cross(p, u)) / sqrt(vec_norm2(u)), fabs(vec_cross(p, w)) / sqrt(vec_norm2(w))), <=, 1.2);
                g_assert_cmpfloat(fabs(d->vein[i].width[j] - 2.0 * r), <=, 1.2);
            }
        drawing_free(d);
        g_free(m.px);
    }
}

static void ring(const Mask *m, Vec2 c, double radius, double r)
{
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++)
            if (fabs(vec_dist(vec2(x + 0.5, m->height - y - 0.5), c) - radius) <= r)
                *mask_at(m, x, y) |= 1;
}

static void test_ring(void)
{
    Mask m = mask_new(160, 150);
    Vec2 c = vec2(80.3, 75.1);
    ring(&m, c, 50.0, 4.0);
    Drawing *d = lines_of(&m);
    g_assert_cmpuint(d->n, ==, 1);
    const DrawnVein *v = &d->vein[0];
    g_assert_true(v->point[0].x == v->point[v->n - 1].x && v->point[0].y == v->point[v->n - 1].y);
    for (uint32_t i = 0; i < v->n; i++) {
        g_assert_cmpfloat(fabs(vec_dist(v->point[i], c) - 50.0), <=, 0.8);
        g_assert_cmpfloat(fabs(v->width[i] - 8.0), <=, 0.8);
    }
    g_assert_cmpfloat(fabs(vein_length(v) / 314.16 - 1.0), <=, 0.02);
    drawing_free(d);
    sweep(&m, vec_add(c, vec2(50.0, 0.0)), vec_add(c, vec2(70.0, 0.0)), 3.0, 3.0); /* with a stem */
    d = lines_of(&m);
    g_assert_cmpuint(d->n, ==, 2);
    drawing_free(d);
    g_free(m.px);
}

static void comb(const Mask *m, uint32_t teeth)
{
    sweep(m, vec2(20.0, 30.4), vec2(280.0, 30.4), 6.0, 6.0);
    for (uint32_t k = 0; k < teeth; k++)
        sweep(m, vec2(40.0 + 24.3 * k, 30.4), vec2(48.0 + 24.3 * k, 100.0), 2.6, 2.6);
}

static void test_comb(void)
{
    Mask m = mask_new(300, 120);
    comb(&m, 10);
    Drawing *d = lines_of(&m);
    g_assert_cmpuint(d->n, ==, 11);
    uint32_t spines = 0;
    for (uint32_t i = 0; i < d->n; i++) {
        const DrawnVein *v = &d->vein[i];
        if (vein_length(v) < 200.0) {
            bool shared = false;
            for (uint32_t j = 0; j < d->n; j++)
                for (uint32_t k = 0; j != i && k < d->vein[j].n; k++)
                    shared |= (v->point[0].x == d->vein[j].point[k].x && v->point[0].y == d->vein[j].point[k].y) ||
                              (v->point[v->n - 1].x == d->vein[j].point[k].x && v->point[v->n - 1].y == d->vein[j].point[k].y);
            g_assert_true(shared);
            for (uint32_t k = 0; k < v->n; k++)
                g_assert_cmpfloat(fabs(v->width[k] - 5.2), <=, 1.0);
            g_assert_cmpfloat(fabs(vein_length(v) - 72.6), <=, 4.0);
            continue;
        }
        spines++;
        for (uint32_t k = 0; k < v->n; k++) {
            g_assert_cmpfloat(fabs(v->point[k].y - 30.4), <=, 0.8);
            g_assert_cmpfloat(fabs(v->width[k] - 12.0), <=, 1.0);
        }
        g_assert_true(starts_at(v, vec2(14.0, 30.4), 1.5) && starts_at(v, vec2(286.0, 30.4), 1.5));
    }
    g_assert_cmpuint(spines, ==, 1);
    drawing_free(d);
    g_free(m.px);
}

/* Neither the corners of blunt ends nor a rough border make veins. */
static void test_no_hairs(void)
{
    for (uint32_t k = 0; k < 40; k++) {
        Mask m = mask_new(220, 220);
        Vec2 u = direction(-1.0 + k / 20.0), c = vec2(110.0, 110.0);
        double half = 3.0 + 0.25 * k;
        for (uint32_t y = 0; y < 220; y++)
            for (uint32_t x = 0; x < 220; x++) {
                Vec2 p = vec_sub(vec2(x + 0.5, y + 0.5), c);
                double rough = k % 2 ? 1.5 * uniform(3000 + k, y * 220 + x) : 0.0;
                if (fabs(vec_dot(p, u)) <= 80.0 && fabs(vec_cross(p, u)) <= half + rough)
                    *mask_at(&m, x, y) = 1;
            }
        Drawing *d = lines_of(&m);
        g_assert_cmpuint(d->n, ==, 1);
        g_assert_cmpfloat(fabs(vein_length(&d->vein[0]) - 160.0), <=, 4.0);
        drawing_free(d);
        g_free(m.px);
    }
}

/* A quarter turn of the picture turns the lines, but for single pixels. */
static void test_turned(void)
{
    enum { S = 300 };
    Mask m = mask_new(S, S), n = mask_new(S, S);
    comb(&m, 9);
    sweep(&m, vec2(60.0, 200.0), vec2(250.0, 290.0), 5.0, 2.0);
    sweep(&m, vec2(120.0, 280.0), vec2(240.0, 180.0), 2.5, 4.0);
    ring(&m, vec2(60.0, 240.0), 35.0, 2.5);
    Drawing *d = lines_of(&m);
    for (uint32_t quarter = 1; quarter < 4; quarter++) {
        for (uint32_t y = 0; y < S; y++)
            for (uint32_t x = 0; x < S; x++)
                *mask_at(&n, x, y) = *mask_at(&m, quarter == 1 ? y : quarter == 2 ? S - 1 - x : S - 1 - y, quarter == 1 ? S - 1 - x : quarter == 2 ? S - 1 - y : x);
        Drawing *e = lines_of(&n);
        g_assert_cmpuint(e->n, ==, d->n);
        g_assert_cmpfloat(fabs(drawing_length(e) / drawing_length(d) - 1.0), <=, 0.01);
        double worst = 0.0;
        for (uint32_t i = 0; i < d->n; i++)
            for (uint32_t k = 0; k < d->vein[i].n; k++) {
                Vec2 p = d->vein[i].point[k];
                p = quarter == 1 ? vec2(S - p.y, p.x) : quarter == 2 ? vec2(S - p.x, S - p.y) : vec2(p.y, S - p.x);
                p = quarter == 2 ? p : vec2(S - p.x, S - p.y); /* the picture's y runs down */
                worst = fmax(worst, drawing_distance(e, p));
            }
        g_test_message("turned by %u quarters: lines at most %.2f apart", quarter, worst);
        g_assert_cmpfloat(worst, <=, 2.0);
        drawing_free(e);
    }
    drawing_free(d);
    g_free(m.px);
    g_free(n.px);
}

static void test_degenerate(void)
{
    CentreDef def = centre_def_default();
    for (uint32_t w = 1; w < 30; w += 7)
        for (uint32_t h = 1; h < 30; h += 7) {
            Mask m = mask_new(w, h);
            Drawing *d = lines_of(&m);
            g_assert_cmpuint(d->n, ==, 0);
            drawing_free(d);
            centre_thin(&m, 1, 2);
            memset(m.px, 1, w * h);
            d = lines_of(&m);
            g_assert_cmpuint(d->n, <=, 2);
            g_assert_cmpuint(d->n, >=, MAX(w, h) > 7 && MAX(w, h) > 3 * MIN(w, h));
            drawing_free(d);
            centre_thin(&m, 1, 2);
            assert_thinned(&m, 1, 2);
            m.px[0] = 0;
            drawing_free(lines_of(&m));
            g_free(m.px);
        }
    Mask m = mask_new(60, 40);
    sweep(&m, vec2(8.0, 8.0), vec2(12.0, 8.0), 0.8, 0.8); /* a speck */
    sweep(&m, vec2(45.0, 20.0), vec2(45.0, 20.0), 9.0, 9.0); /* a disc */
    Drawing *d = lines_of(&m);
    for (uint32_t i = 0; i < d->n; i++)
        assert_near(d->vein[i].point[0], vec2(45.0, 20.0), 11.0);
    g_assert_cmpuint(d->n, <=, 1);
    drawing_free(d);
    def.least = 1e9;
    d = centre_lines(&m, 1, &def);
    g_assert_cmpuint(d->n, ==, 0);
    drawing_free(d);
    def = (CentreDef){.hole = 0.0, .spur = 0.0, .tolerance = 0.0, .least = 0.0};
    for (uint32_t k = 0; k < 100; k++) { /* nothing but whatever there is */
        Mask n = mask_new(W, H);
        random_region(&n, 4000 + k);
        drawing_free(centre_lines(&n, 1, &def));
        def.spur = 0.1 * k;
        drawing_free(centre_lines(&n, 1, &def));
        drawing_free(lines_of(&n));
        g_free(n.px);
    }
    g_free(m.px);
}

/* ---- tracings ---- */

static char *folder;

static Drawing *read_tracing(const char *text, gssize length, double height, GError **error)
{
    char *path = g_build_filename(folder, "tracing.txt", NULL);
    g_assert_true(g_file_set_contents(path, text, length, NULL));
    Drawing *d = drawing_read_tracing(path, height, error);
    g_free(path);
    return d;
}

static void test_polylines(void)
{
    GError *error = NULL;
    Drawing *d = read_tracing("\xEF\xBB\xBFmidrib\r\n10 20\r\n10,30\r\n10\t30\r\n 1e1 , 42.5 \r\n\r\n\r\n5 5\n6 5\n7 9\n# a 2nd one\n1 1\n2 2", -1, 100.0, &error);
    g_assert_no_error(error);
    g_assert_cmpuint(d->n, ==, 3);
    g_assert_cmpuint(d->vein[0].n, ==, 3); /* a point given twice is one */
    assert_near(d->vein[0].point[0], vec2(10.0, 80.0), 0.0);
    assert_near(d->vein[0].point[2], vec2(10.0, 57.5), 0.0);
    g_assert_cmpfloat(d->vein[0].width[1], ==, 0.0);
    g_assert_cmpuint(d->vein[0].order, ==, 0);
    g_assert_nonnull(strstr(d->vein[0].name, "midrib"));
    g_assert_nonnull(strstr(d->vein[1].name, "line 8"));
    g_assert_cmpuint(d->vein[1].n, ==, 3);
    g_assert_nonnull(strstr(d->vein[2].name, "a 2nd one"));
    drawing_free(d);
    /* One vein, arched as far as a half circle, is a vein and no outline. */
    GString *s = g_string_new(NULL);
    for (int i = -20; i <= 20; i++) {
        Vec2 u = direction(0.05 * i);
        g_string_append_printf(s, "%.3f %.3f\n", 100.0 * u.x, 100.0 * u.y);
    }
    d = read_tracing(s->str, -1, 100.0, &error);
    g_assert_no_error(error);
    g_assert_cmpuint(d->n, ==, 1);
    g_assert_cmpuint(d->vein[0].n, ==, 41);
    drawing_free(d);
    g_string_free(s, TRUE);
}

static void test_bad_tracings(void)
{
    static const struct {
        const char *text, *says;
        int code;
    } bad[] = {
        {"", "no vein", IMPORT_ERROR_GRAPH},
        {"\n \n", "no vein", IMPORT_ERROR_GRAPH},
        {"words\nmore words\n", "no vein", IMPORT_ERROR_GRAPH},
        {"1 2\n", "txt:1: is a vein of one point", IMPORT_ERROR_GRAPH},
        {"1 2\n3 4\n\n5 6\n5 6\n", "txt:4: is a vein of one point", IMPORT_ERROR_GRAPH},
        {"1 2\n3\n", "txt:2: '3' is no point", IMPORT_ERROR_SYNTAX},
        {"1 2\n3 4 5\n", "txt:2: '3 4 5' is no point", IMPORT_ERROR_SYNTAX},
        {"1 2\n3 x\n", "txt:2: '3 x' is no point", IMPORT_ERROR_SYNTAX},
        {"1 2\n3 4 x\n", "is no point", IMPORT_ERROR_SYNTAX},
        {"1 2\nnan 4\n", "txt:2: 'nan 4'", IMPORT_ERROR_SYNTAX},
        {"1 2\n1 inf\n", "txt:2: '1 inf'", IMPORT_ERROR_SYNTAX},
        {"1 2\n1 -1e7\n", "-1000000 to 1000000", IMPORT_ERROR_SYNTAX},
        {"1 2\n1 1e999\n", "-1000000 to 1000000", IMPORT_ERROR_SYNTAX},
        {"1 2\n\xff\xfe 4\n", "is no point", IMPORT_ERROR_SYNTAX},
        {"0 0\n100 0\n100 100\n0 100\n0 0\n", "like a blade", IMPORT_ERROR_GRAPH},
    };
    for (guint i = 0; i < G_N_ELEMENTS(bad); i++) {
        GError *error = NULL;
        g_assert_null(read_tracing(bad[i].text, -1, 100.0, &error));
        g_assert_error(error, IMPORT_ERROR, bad[i].code);
        if (!strstr(error->message, bad[i].says) || !strstr(error->message, "tracing.txt"))
            g_error("'%s' doesn't say '%s'", error->message, bad[i].says);
        g_clear_error(&error);
        g_assert_null(read_tracing(bad[i].text, -1, 100.0, NULL));
    }
    GError *error = NULL;
    g_assert_null(read_tracing("1 2\n3 4\n\0 5 6\n", 15, 100.0, &error));
    g_assert_error(error, IMPORT_ERROR, IMPORT_ERROR_SYNTAX);
    g_clear_error(&error);
    g_assert_null(drawing_read_tracing("/no/such/file", 1.0, &error));
    g_assert_error(error, G_FILE_ERROR, G_FILE_ERROR_NOENT);
    g_clear_error(&error);
    g_assert_null(drawing_read_tracing("/dev/zero", 1.0, &error)); /* never ends */
    g_assert_cmpint((int)error->domain, ==, (int)G_FILE_ERROR);
    g_clear_error(&error);
    for (uint32_t k = 0; k < 300; k++) { /* whatever there is */
        static const char letters[] = "0123456789 .,-\n\n\ne\tx\r";
        char text[80];
        for (uint32_t i = 0; i < sizeof text; i++)
            text[i] = letters[(size_t)(uniform(5000 + k, i) * (sizeof letters - 1))];
        drawing_free(read_tracing(text, sizeof text, 10.0, NULL));
    }
}

/* A tapered stem, its base left open, with a branch that begins at it; the tips are points. Units from large to small. */
static void test_outline(void)
{
    static const Vec2 corner[] = {{96, 400}, {97, 250}, {20, 160}, {98, 243}, {100, 20}, {104, 400}};
    for (uint32_t k = 0; k < 6; k++) {
        double scale = (const double[]){1.0, 1.0, 5.0, 0.01, 100.0, 1.0}[k];
        GString *s = g_string_new(NULL);
        for (guint i = 0; i < G_N_ELEMENTS(corner); i++) {
            Vec2 p = corner[k % 2 && k < 5 ? G_N_ELEMENTS(corner) - 1 - i : i]; /* either way round */
            g_string_append_printf(s, "%.6f %.6f\n", scale * p.x, scale * p.y);
        }
        if (k == 5)
            g_string_append(s, "104 400\n96 400\n96 399\n97 250\n20 160\n98 243\n100 20\n104 400\n"); /* twice around, and a loop */
        GError *error = NULL;
        double h = 420.0 * scale;
        Drawing *d = read_tracing(s->str, -1, h, &error);
        g_assert_no_error(error);
        g_assert_cmpuint(d->n, ==, 2);
        g_test_message("scale %g: %u and %u points, lengths %.1f and %.1f", scale, d->vein[0].n, d->vein[1].n, vein_length(&d->vein[0]) / scale, vein_length(&d->vein[1]) / scale);
        uint32_t branch = starts_at(&d->vein[0], vec2(20.0 * scale, h - 160.0 * scale), 2.0 * scale) ? 0 : 1;
        g_assert_true(starts_at(&d->vein[branch], vec2(20.0 * scale, h - 160.0 * scale), 1.5 * scale));
        const DrawnVein *stem = &d->vein[1 - branch];
        g_assert_true(starts_at(stem, vec2(100.0 * scale, h - 20.0 * scale), 1.5 * scale) && starts_at(stem, vec2(100.0 * scale, h - 400.0 * scale), 1.5 * scale));
        for (uint32_t i = 0; i < stem->n; i++) {
            double y = (h - stem->point[i].y) / scale, width = y > 250.0 ? 5.2 + 2.8 * (y - 250.0) / 150.0 : (y - 20.0) * 0.0208;
            g_assert_cmpfloat(fabs(stem->point[i].x / scale - 100.0), <=, 1.0);
            if (y < 225.0 || y > 265.0)
                g_assert_cmpfloat(fabs(stem->width[i] / scale - width), <=, 0.8);
        }
        drawing_free(d);
        g_string_free(s, TRUE);
    }
}

/* ---- real ones ---- */

static char *real_file(const char *name)
{
    const char *scans = g_getenv("VENATION_SCANS");
    char *path = scans ? g_build_filename(scans, name, NULL) : g_test_build_filename(G_TEST_DIST, "..", "..", "..", "shared", "scans", name, NULL);
    if (!g_file_test(path, G_FILE_TEST_EXISTS)) {
        g_test_skip("no real scans here; VENATION_SCANS can name their folder");
        g_clear_pointer(&path, g_free);
    }
    return path;
}

static void test_grapes(void)
{
    static const struct {
        const char *name;
        uint32_t tips; /* counted on the picture */
        double length;
        Vec2 midrib; /* its tip, y down */
    } grape[] = {{"grape_301_veins.txt", 23, 11771, {1796, 2212}}, {"grape_303_veins.txt", 23, 9737, {0, 0}}};
    for (guint k = 0; k < G_N_ELEMENTS(grape); k++) {
        char *path = real_file(grape[k].name);
        if (!path)
            return;
        GError *error = NULL;
        gint64 start = g_get_monotonic_time();
        Drawing *d = drawing_read_tracing(path, 2504.0, &error);
        g_assert_no_error(error);
        g_test_message("%s: %u veins, %.0f pixels long, %.2f s", grape[k].name, d->n, drawing_length(d), (double)(g_get_monotonic_time() - start) * 1e-6);
        g_assert_cmpuint(d->n, ==, grape[k].tips - 1); /* a tree without a stem: two of its tips are of one vein */
        g_assert_cmpfloat(fabs(drawing_length(d) / grape[k].length - 1.0), <=, 0.01);
        bool midrib = grape[k].midrib.x == 0.0;
        for (uint32_t i = 0; i < d->n; i++)
            midrib |= vein_length(&d->vein[i]) > 1100.0 && starts_at(&d->vein[i], vec2(grape[k].midrib.x, 2504.0 - grape[k].midrib.y), 8.0);
        g_assert_true(midrib);
        drawing_free(d);
        g_free(path);
    }
}

static void test_zelkova(void)
{
    char *path = real_file("zelkova_vein_mask.png");
    if (!path)
        return;
    GError *error = NULL;
    Scan *s = scan_read(path, 0, &error);
    g_assert_no_error(error);
    Mask m = mask_new(s->width, s->height);
    for (uint32_t y = 0; y < s->height; y++)
        for (uint32_t x = 0; x < s->width; x++)
            *mask_at(&m, x, y) = scan_sample(s, x, y, 0) > 127;
    gint64 start = g_get_monotonic_time();
    centre_thin(&m, 1, 2);
    gint64 middle = g_get_monotonic_time();
    g_assert_cmpuint(count_parts(&m, 2, true), ==, count_parts(&m, 1, true));
    g_assert_cmpuint(count_parts(&m, 2, false), ==, count_parts(&m, 1, false));
    gint64 second = g_get_monotonic_time();
    Drawing *d = lines_of(&m);
    g_test_message("zelkova: %u veins, %.0f pixels long; thinned in %.2f s, lines in %.2f s", d->n, drawing_length(d), (double)(middle - start) * 1e-6,
                   (double)(g_get_monotonic_time() - second) * 1e-6);
    g_assert_cmpuint(d->n, >, 3000);
    double longest = 0.0;
    for (uint32_t i = 0; i < d->n; i++)
        longest = fmax(longest, vein_length(&d->vein[i]));
    g_assert_cmpfloat(longest, >, 1200.0); /* most of the midrib in one piece */
    drawing_free(d);
    scan_free(s);
    g_free(m.px);
    g_free(path);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    folder = g_dir_make_tmp("venation-centre-XXXXXX", NULL);
    g_test_add_func("/centre/topology", test_topology);
    g_test_add_func("/centre/topology-small", test_topology_small);
    g_test_add_func("/centre/distances", test_distances);
    g_test_add_func("/centre/stroke", test_stroke);
    g_test_add_func("/centre/taper", test_taper);
    g_test_add_func("/centre/y", test_y);
    g_test_add_func("/centre/cross", test_cross);
    g_test_add_func("/centre/ring", test_ring);
    g_test_add_func("/centre/comb", test_comb);
    g_test_add_func("/centre/no-hairs", test_no_hairs);
    g_test_add_func("/centre/turned", test_turned);
    g_test_add_func("/centre/degenerate", test_degenerate);
    g_test_add_func("/tracing/polylines", test_polylines);
    g_test_add_func("/tracing/bad", test_bad_tracings);
    g_test_add_func("/tracing/outline", test_outline);
    g_test_add_func("/centre/grapes", test_grapes);
    g_test_add_func("/centre/zelkova", test_zelkova);
    int failed = g_test_run();
    char *path = g_build_filename(folder, "tracing.txt", NULL);
    g_remove(path);
    g_rmdir(folder);
    g_free(path);
    g_free(folder);
    return failed;
}
