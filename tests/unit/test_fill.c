/* Openings of scanned leaves, and colours carried on over them, on pictures of which all is known. */
#include <glib.h>
#include <math.h>
#include <string.h>

#include "geom/dtrig.h"
#include "geom/random.h"
#include "scan/fill.h"
#include "scan/openings.h"

enum { SIZE = 400 };

static const double CENTRE = 0.5 * SIZE, RADIUS = 150.0;

static double uniform(uint64_t i)
{
    double v[2];
    random_pair(5, 0, 0, i, v);
    return v[0];
}

/* Colours of the picture: background, and what the leaf is at a pixel. */
typedef struct {
    uint32_t channels, depth;
    double hole_x, hole_r; /* of a round hole on the middle row; radius 0: none */
    double shadow;         /* width of a brown rim around leaf and hole, pixels */
    double noise;          /* half width of even noise, levels of 255 */
    bool ramp;             /* colours go from left to right */
} Picture;

static double leaf_level(const Picture *p, double x, double y, uint32_t c)
{
    static const double plain[4] = {70.0, 110.0, 40.0, 255.0};
    double v = plain[c];
    if (p->ramp)
        v += 0.12 * (x - CENTRE) + 0.06 * (y - CENTRE);
    return v;
}

/* Edges are a pixel wide, as scanners make them. */
static Scan *paint(const Picture *p)
{
    static const double paper[4] = {250.0, 240.0, 235.0, 255.0}, brown[4] = {110.0, 60.0, 70.0, 255.0};
    Scan *s = scan_new(SIZE, SIZE, p->channels, p->depth);
    for (uint32_t y = 0; y < SIZE; y++)
        for (uint32_t x = 0; x < SIZE; x++) {
            Vec2 at = vec2(x + 0.5, y + 0.5);
            double depth = RADIUS - vec_dist(at, vec2(CENTRE, CENTRE));
            if (p->hole_r > 0.0)
                depth = MIN(depth, vec_dist(at, vec2(p->hole_x, CENTRE)) - p->hole_r);
            double cover = CLAMP(depth + 0.5, 0.0, 1.0);
            for (uint32_t c = 0; c < p->channels; c++) {
                gsize i = ((gsize)y * SIZE + x) * p->channels + c;
                double leaf = depth < p->shadow ? brown[c] : leaf_level(p, at.x, at.y, c) + (c < 3 ? p->noise * (2.0 * uniform(i) - 1.0) : 0.0);
                double v = p->channels % 2 == 0 && c + 1 == p->channels ? 255.0 : cover * leaf + (1.0 - cover) * paper[c]; /* opaque */
                if (p->depth == 8)
                    ((uint8_t *)s->px)[i] = (uint8_t)(v + 0.5);
                else
                    ((uint16_t *)s->px)[i] = (uint16_t)(257.0 * v + 0.5);
            }
        }
    return s;
}

static Polygon *disc(double x, double y, double r)
{
    Vec2 v[180];
    for (int i = 0; i < 180; i++) {
        double s, c;
        dtrig_sin_cos(2.0 * G_PI * i / 180.0, &s, &c);
        v[i] = vec2(x + r * c, y + r * s);
    }
    return polygon_new(v, 180);
}

static Threshold red(const Scan *s)
{
    Threshold t;
    GError *error = NULL;
    threshold_find(s, &(ThresholdDef){CHANNEL_RED, LEAF_DARK, -1.0}, &t, &error);
    g_assert_no_error(error);
    return t;
}

static double level(const Scan *s, uint32_t x, uint32_t y, uint32_t c) { return scan_sample(s, x, y, c) / (s->depth == 8 ? 1.0 : 257.0); }

/* ---- openings ---- */

static void test_trace(void)
{
    for (int k = 0; k < 12; k++) {
        Picture p = {.channels = 3, .depth = k % 2 ? 16 : 8, .hole_x = 150.0 + 7.3 * k, .hole_r = 4.0 + 3.7 * k};
        Scan *s = paint(&p);
        Polygon *outline = disc(CENTRE, CENTRE, RADIUS);
        Threshold t = red(s);
        Holes *h = openings_trace(s, outline, &t, openings_least(outline->area), 0.0);
        g_assert_cmpuint(h->n, ==, 1);
        double area = G_PI * p.hole_r * p.hole_r, twice = 0.0;
        g_assert_cmpfloat(fabs(h->area - area), <, 2.0 * G_PI * p.hole_r * 0.1);
        for (uint32_t i = 0; i < h->start[1]; i++) {
            Vec2 a = h->p[i], b = h->p[i + 1 < h->start[1] ? i + 1 : 0];
            twice += vec_cross(a, b);
            g_assert_cmpfloat(fabs(vec_dist(a, vec2(p.hole_x, CENTRE)) - p.hole_r), <, 0.3); /* y up is y down here */
        }
        g_assert_cmpfloat(fabs(0.5 * twice + h->area), <, 1e-6); /* clockwise */
        holes_free(h);
        polygon_free(outline);
        scan_free(s);
    }
}

/* Which bit the pixel at the middle of the picture's hole gets. */
static uint8_t mark_at(const Scan *s, const Polygon *outline, uint32_t x, uint32_t y)
{
    MaskBox box;
    g_assert_true(openings_box(s, outline, 3.0, &box));
    Mask m = {box.x1 - box.x0 + 1, box.y1 - box.y0 + 1, box.x1 - box.x0 + 1, NULL};
    m.px = g_malloc0((gsize)m.width * m.height);
    Threshold t = red(s);
    openings_mark(s, outline, &t, openings_least(outline->area), &m, box);
    uint8_t bits = *mask_at(&m, x - box.x0, y - box.y0);
    for (gsize i = 0; i < (gsize)m.width * m.height; i++) { /* every pixel is one thing */
        int in = !!(m.px[i] & MASK_THIS), parts = !!(m.px[i] & MASK_LEAF) + !!(m.px[i] & MASK_HOLE) + !!(m.px[i] & MASK_OUT);
        g_assert_cmpint(parts, ==, in);
        g_assert_cmpint(m.px[i] & ~(MASK_THIS | MASK_LEAF | MASK_HOLE | MASK_OUT), ==, 0);
    }
    g_free(m.px);
    return bits & (MASK_LEAF | MASK_HOLE | MASK_OUT);
}

static void test_mark(void)
{
    Picture inner = {.channels = 3, .depth = 8, .hole_x = 160.0, .hole_r = 20.0}, notch = inner, none = inner;
    notch.hole_x = 345.0;
    none.hole_r = 0.0;
    Scan *s = paint(&inner), *n = paint(&notch), *pale = paint(&none), *line = paint(&none);
    for (uint32_t y = 0; y < SIZE; y++)
        for (uint32_t x = 0; x < SIZE; x++) {
            uint8_t *p = (uint8_t *)pale->px + 3 * ((gsize)y * SIZE + x), *q = (uint8_t *)line->px + 3 * ((gsize)y * SIZE + x);
            if (vec_dist(vec2(x, y), vec2(160, 200)) < 15.0)
                p[0] = 180; /* lighter than the threshold of 160, but no paper */
            if (y == 200 && x > 100 && x < 300)
                memset(q, 250, 3);
        }
    Polygon *outline = disc(CENTRE, CENTRE, RADIUS);
    g_assert_cmpuint(mark_at(s, outline, 160, 200), ==, MASK_HOLE);
    g_assert_cmpuint(mark_at(s, outline, 200, 200), ==, MASK_LEAF);
    g_assert_cmpuint(mark_at(s, outline, 51, 51), ==, 0);
    g_assert_cmpuint(mark_at(n, outline, 340, 200), ==, MASK_OUT);
    g_assert_cmpuint(mark_at(pale, outline, 160, 200), ==, MASK_LEAF);
    g_assert_cmpuint(mark_at(line, outline, 160, 200), ==, MASK_LEAF);
    polygon_free(outline);
    scan_free(s);
    scan_free(n);
    scan_free(pale);
    scan_free(line);
}

/* The outline says which side is leaf, and whether the threshold is good for anything. */
static void test_threshold(void)
{
    Picture p = {.channels = 3, .depth = 8};
    Scan *s = paint(&p);
    ThresholdDef frame = {CHANNEL_BEST, LEAF_BY_FRAME, -1.0}, light = {CHANNEL_BEST, LEAF_LIGHT, -1.0};
    Threshold t;
    Polygon *leaf = disc(CENTRE, CENTRE, RADIUS), *half = disc(CENTRE + RADIUS, CENTRE, RADIUS * 0.9), *off = disc(5000.0, 0.0, 10.0), *ground = disc(40.0, 40.0, 30.0);
    g_assert_true(openings_threshold(s, leaf, &frame, &t));
    g_assert_true(t.dark);
    g_assert_false(openings_threshold(s, leaf, &light, &t));
    g_assert_false(openings_threshold(s, half, &frame, &t));
    g_assert_false(openings_threshold(s, off, &frame, &t));
    g_assert_true(openings_threshold(s, ground, &frame, &t)); /* the light side, if the outline is around that */
    g_assert_false(t.dark);
    memset(s->px, 99, 3 * SIZE * SIZE);
    g_assert_false(openings_threshold(s, leaf, &frame, &t)); /* all of one shade */
    polygon_free(leaf);
    polygon_free(half);
    polygon_free(off);
    polygon_free(ground);
    scan_free(s);
}

/* ---- filling ---- */

/* Largest difference from what the leaf would be there, of pixels in the outline. */
static double worst(const Picture *p, const Scan *s, const Polygon *outline)
{
    double most = 0.0;
    for (uint32_t y = 0; y < SIZE; y++)
        for (uint32_t x = 0; x < SIZE; x++)
            for (uint32_t c = 0; c < p->channels; c++)
                if (polygon_contains(outline, vec2(x + 0.5, SIZE - (y + 0.5))))
                    most = MAX(most, fabs(level(s, x, y, c) - leaf_level(p, x + 0.5, y + 0.5, c)));
    return most;
}

/* Colours that change evenly go on so over the hole and to the margin: a plane is harmonic. Every kind of image. */
static void test_ramp(void)
{
    static const uint32_t channels[] = {1, 2, 3, 4};
    for (int k = 0; k < 8; k++) {
        Picture p = {.channels = channels[k / 2], .depth = k % 2 ? 16 : 8, .hole_x = 180.0, .hole_r = 35.0, .shadow = 4.0, .ramp = true};
        Scan *s = paint(&p);
        Polygon *outline = disc(CENTRE, CENTRE, RADIUS);
        Threshold t = {.channel = p.channels < 3 ? CHANNEL_GREY : CHANNEL_RED, .dark = true, .level = k % 2 ? 160.0 * 257.0 : 160.0};
        if (p.channels % 2 == 0) /* alpha is no colour */
            p.channels--;
        g_assert_cmpfloat(worst(&p, s, outline), >, 100.0);
        scan_fill(s, outline, &t, 6.0, 20);
        double most = worst(&p, s, outline);
        g_test_message("%u channels, %u bits: off by %.1f of 255 at most", s->channels, s->depth, most);
        g_assert_cmpfloat(most, <, 3.0);
        polygon_free(outline);
        scan_free(s);
    }
}

/* What is surely leaf stays as it was, bit for bit; and without a threshold so does the hole but for its own colours. */
static void test_untouched(void)
{
    Picture p = {.channels = 3, .depth = 8, .hole_x = 180.0, .hole_r = 30.0, .noise = 10.0, .ramp = true};
    Scan *s = paint(&p), *filled = paint(&p), *blind = paint(&p);
    Polygon *outline = disc(CENTRE, CENTRE, RADIUS);
    Threshold t = red(s);
    scan_fill(filled, outline, &t, 5.0, 20);
    scan_fill(blind, outline, NULL, 5.0, 20);
    for (uint32_t y = 0; y < SIZE; y++)
        for (uint32_t x = 0; x < SIZE; x++) {
            Vec2 at = vec2(x + 0.5, y + 0.5);
            double rim = RADIUS - vec_dist(at, vec2(CENTRE, CENTRE)), hole = vec_dist(at, vec2(p.hole_x, CENTRE)) - p.hole_r;
            const uint8_t *a = (uint8_t *)s->px + 3 * ((gsize)y * SIZE + x), *b = (uint8_t *)filled->px + 3 * ((gsize)y * SIZE + x),
                          *c = (uint8_t *)blind->px + 3 * ((gsize)y * SIZE + x);
            if ((rim > 7.0 && hole > 7.0) || rim < -23.0)
                g_assert_cmpmem(a, 3, b, 3);
            if (rim > 7.0 || rim < -23.0)
                g_assert_cmpmem(a, 3, c, 3);
            if (rim > 0.0)
                g_assert_cmpint(b[0], <, 120); /* no paper */
        }
    polygon_free(outline);
    scan_free(s);
    scan_free(filled);
    scan_free(blind);
}

/* The hole gets grain like the leaf's, neither smooth nor wild, and not the same tile again and again. */
static void test_grain(void)
{
    Picture p = {.channels = 3, .depth = 8, .hole_x = 190.0, .hole_r = 40.0, .noise = 12.0};
    Scan *s = paint(&p), *again = paint(&p);
    Polygon *outline = disc(CENTRE, CENTRE, RADIUS);
    Threshold t = red(s);
    scan_fill(s, outline, &t, 4.0, 10);
    scan_fill(again, outline, &t, 4.0, 10);
    g_assert_cmpmem(s->px, 3 * SIZE * SIZE, again->px, 3 * SIZE * SIZE);
    double sum = 0.0, square = 0.0, same = 0.0;
    uint32_t n = 0;
    for (uint32_t y = 165; y < 235; y++)
        for (uint32_t x = 155; x < 225; x++) {
            if (vec_dist(vec2(x, y), vec2(p.hole_x, CENTRE)) > 32.0)
                continue;
            double v = level(s, x, y, 1) - 110.0;
            sum += v;
            square += v * v;
            same += v * (level(s, x + 16, y, 1) - 110.0);
            n++;
        }
    double variance = square / n, leaf = 12.0 * 12.0 / 3.0;
    g_test_message("variance %.1f, of the leaf %.1f; mean %.2f; repeats itself by %.2f", variance, leaf, sum / n, same / n / variance);
    g_assert_cmpfloat(variance, >, 0.5 * leaf);
    g_assert_cmpfloat(variance, <, 1.5 * leaf);
    g_assert_cmpfloat(fabs(sum / n), <, 2.0);
    g_assert_cmpfloat(same / n / variance, <, 0.5);
    polygon_free(outline);
    scan_free(s);
    scan_free(again);
}

/* A brown shadow at the rims, as wide as the inset, is gone. */
static void test_shadow(void)
{
    Picture p = {.channels = 3, .depth = 8, .hole_x = 180.0, .hole_r = 30.0, .shadow = 5.0};
    Scan *s = paint(&p);
    Polygon *outline = disc(CENTRE, CENTRE, RADIUS);
    Threshold t = red(s);
    scan_fill(s, outline, &t, 6.5, 10);
    g_assert_cmpfloat(worst(&p, s, outline), <, 2.0);
    polygon_free(outline);
    scan_free(s);
}

/* What is thinner than the inset throughout keeps its middle when it is long, like a petiole, and all of it when all is thin. */
static void test_thin(void)
{
    enum { W = 300, H = 120 };
    Scan *s = scan_new(W, H, 3, 8);
    uint8_t *px = s->px;
    for (uint32_t y = 0; y < H; y++)
        for (uint32_t x = 0; x < W; x++) {
            bool blade = x >= 150 && x < 280 && y >= 10 && y < 110, stalk = x >= 20 && x < 150 && y >= 55 && y < 65;
            uint8_t *p = px + 3 * (y * W + x);
            memset(p, 250, 3);
            if (blade)
                p[0] = 60, p[1] = 120, p[2] = 40;
            else if (stalk)
                p[0] = 120, p[1] = 70, p[2] = 90;
        }
    Vec2 whole[8] = {{20, 55}, {150, 55}, {150, 10}, {280, 10}, {280, 110}, {150, 110}, {150, 65}, {20, 65}}, strip[4] = {{20, 55}, {140, 55}, {140, 65}, {20, 65}};
    Polygon *leaf = polygon_new(whole, 8), *needle = polygon_new(strip, 4);
    scan_fill(s, leaf, NULL, 6.0, 8);
    for (uint32_t x = 30; x < 130; x++)
        for (uint32_t y = 56; y < 64; y++) {
            g_assert_cmpint(abs(px[3 * (y * W + x)] - 120), <, 12);
            g_assert_cmpint(abs(px[3 * (y * W + x) + 1] - 70), <, 12);
        }
    scan_fill(s, needle, NULL, 50.0, 8);
    g_assert_cmpint(abs(px[3 * (60 * W + 80)] - 120), <, 12);
    polygon_free(leaf);
    polygon_free(needle);
    scan_free(s);
}

/* Outlines off the image, partly off it, smaller than a pixel, images of one pixel: nothing is written where it should not be, nothing fails. */
static void test_odd(void)
{
    for (int k = 0; k < 40; k++) {
        uint32_t w = k % 5 == 0 ? 1 : 3 + (uint32_t)(60.0 * uniform(1000 + k)), h = k % 7 == 0 ? 1 : 3 + (uint32_t)(60.0 * uniform(2000 + k));
        Scan *s = scan_new(w, h, 1 + k % 4, k % 2 ? 16 : 8);
        for (gsize i = 0; i < (gsize)w * h * s->channels * s->depth / 8; i++)
            ((uint8_t *)s->px)[i] = (uint8_t)(256.0 * uniform(5000 * k + i));
        Polygon *p = disc(70.0 * uniform(3000 + k) - 5.0, 70.0 * uniform(4000 + k) - 5.0, k % 3 ? 30.0 * uniform(6000 + k) : 0.4);
        Threshold t = {.channel = CHANNEL_GREY, .dark = k & 1, .level = s->depth == 8 ? 128.0 : 32768.0};
        scan_fill(s, p, k % 4 == 3 ? NULL : &t, 0.5 + 9.0 * uniform(7000 + k), (uint32_t)k % 50);
        Holes *holes = openings_trace(s, p, &t, 1.0, 0.5);
        holes_free(holes);
        polygon_free(p);
        scan_free(s);
    }
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/fill/trace", test_trace);
    g_test_add_func("/fill/mark", test_mark);
    g_test_add_func("/fill/threshold", test_threshold);
    g_test_add_func("/fill/ramp", test_ramp);
    g_test_add_func("/fill/untouched", test_untouched);
    g_test_add_func("/fill/grain", test_grain);
    g_test_add_func("/fill/shadow", test_shadow);
    g_test_add_func("/fill/thin", test_thin);
    g_test_add_func("/fill/odd", test_odd);
    return g_test_run();
}
