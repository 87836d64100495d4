/* Painting: coverage, distances, labels and surfaces against independent truth. */
#include <glib.h>
#include <math.h>
#include <string.h>

#include "geom/random.h"
#include "image/paint.h"
#include "image/painter.h"
#include "sim/network.h"

static double uniform(uint64_t *counter)
{
    double v[2];
    random_pair(99, 0, 0, (*counter)++, v);
    return v[0];
}

/* ---- networks ---- */

static Network *net_new(uint32_t nodes, uint32_t edges, const Vec2 *margin, uint32_t n_margin)
{
    Network *net = network_new(nodes, edges);
    net->n_steps = 100;
    net->margin = polygon_new(margin, n_margin);
    for (uint32_t e = 0; e < edges; e++) {
        net->order[e] = 1;
        net->flow[e] = 1.0;
    }
    return net;
}

static const Vec2 square[4] = {{-20.0, 0.0}, {20.0, 0.0}, {20.0, 40.0}, {-20.0, 40.0}};

/* Straight veins of one edge each. */
static Network *net_straws(uint32_t n, double width, uint64_t seed)
{
    Network *net = net_new(2 * n, n, square, 4);
    uint64_t c = seed * 1000;
    for (uint32_t i = 0; i < 2 * n; i++)
        net->node[i] = vec2(uniform(&c) * 36.0 - 18.0, uniform(&c) * 36.0 + 2.0);
    for (uint32_t e = 0; e < n; e++) {
        net->tail[e] = 2 * e;
        net->head[e] = 2 * e + 1;
        net->vein[e] = e;
        net->birth[e] = e;
        net->order[e] = (uint8_t)(1 + e % 5);
        net->width[e] = width * (0.2 + 2.0 * uniform(&c));
    }
    net->n_veins = n;
    return net;
}

/* A tree of winding, tapering veins: n of `length` segments each, every one but the first leaving an earlier one. */
static Network *net_tree(uint32_t n, uint32_t length, double width, uint64_t seed)
{
    uint32_t edges = n * length;
    Network *net = net_new(edges + 1, edges, square, 4);
    uint64_t c = seed * 1000000;
    net->node[0] = vec2(0.0, 0.5);
    for (uint32_t v = 0, e = 0; v < n; v++) {
        uint32_t at = v == 0 ? 0 : (uint32_t)(uniform(&c) * e);
        double w = v == 0 ? width : MIN(width, at > 0 ? net->width[at - 1] : width) * (0.3 + 0.5 * uniform(&c));
        Vec2 d = v == 0 ? vec2(0.0, 1.0) : vec2(uniform(&c) - 0.5, uniform(&c) - 0.4);
        for (uint32_t i = 0; i < length; i++, e++) {
            d = vec_add(d, vec2(0.4 * (uniform(&c) - 0.5), 0.4 * (uniform(&c) - 0.5)));
            d = vec_scale(d, 1.0 / sqrt(vec_norm2(d)));
            net->node[e + 1] = vec_add(net->node[at], d);
            net->tail[e] = at;
            net->head[e] = at = e + 1;
            net->vein[e] = v;
            net->birth[e] = (v + i) % 100;
            net->order[e] = (uint8_t)(v == 0 ? 1 : 2 + v % 4);
            net->width[e] = w * (1.0 - 0.6 * i / length);
        }
    }
    net->n_veins = n;
    return net;
}

static Painter *painter_at(const Network *net, const Frame *frame, unsigned threads)
{
    PaintStyle style = paint_style_default();
    style.threads = threads;
    style.seed = 5;
    return painter_new(net, frame, &style);
}

static double total(const float *px, gsize n)
{
    double sum = 0.0;
    for (gsize i = 0; i < n; i++)
        sum += (double)px[i];
    return sum;
}

/* ---- strokes ---- */

/* The distance is the least over the axis of |p - c(t)| - r(t), which is convex in t. */
static double slow_distance(const Capsule *k, Vec2 p)
{
    double lo = 0.0, hi = 1.0;
    for (int i = 0; i < 100; i++) {
        double a = lo + (hi - lo) / 3.0, b = hi - (hi - lo) / 3.0;
        double fa = vec_dist(p, vec_lerp(k->a, k->b, a)) - capsule_radius(k, a);
        double fb = vec_dist(p, vec_lerp(k->a, k->b, b)) - capsule_radius(k, b);
        if (fa < fb)
            hi = b;
        else
            lo = a;
    }
    return vec_dist(p, vec_lerp(k->a, k->b, lo)) - capsule_radius(k, lo);
}

static void test_capsule(void)
{
    uint64_t c = 0;
    for (int i = 0; i < 3000; i++) {
        Capsule k =
            capsule_new(vec2(uniform(&c), uniform(&c)), uniform(&c), vec2(3.0 * uniform(&c), uniform(&c)), uniform(&c));
        Vec2 p = vec2(4.0 * uniform(&c) - 0.5, 2.0 * uniform(&c) - 0.5);
        double t, d = capsule_distance(&k, p, &t);
        g_assert_cmpfloat(fabs(d - slow_distance(&k, p)), <, 1e-9);
        Span s = capsule_chord(&k, p.y);
        if (d < -1e-9)
            g_assert_true(s.lo <= p.x && p.x <= s.hi);
        if (d > 1e-9)
            g_assert_true(p.x < s.lo || p.x > s.hi);
    }
}

/* Coverage by veins within the blade of the pixel at x, y by brute force. */
static double sampled(const Painter *p, uint32_t x, uint32_t y, int n)
{
    const Strokes *s = p->strokes;
    int hit = 0;
    double t;
    const Stroke *near[64];
    uint32_t m = 0;
    for (uint32_t i = 0; i < s->n && m < 64; i++)
        if (capsule_distance(&s->v[i].shape, vec2(x + 0.5, y + 0.5), &t) < 0.75)
            near[m++] = &s->v[i];
    for (int j = 0; j < n && m > 0; j++)
        for (int i = 0; i < n; i++) {
            bool in = false;
            for (uint32_t k = 0; k < m && !in; k++)
                in = capsule_distance(&near[k]->shape, vec2(x + (i + 0.5) / n, y + (j + 0.5) / n), &t) <= 0.0;
            Vec2 leaf = vec2(p->frame.corner.x + (x + (i + 0.5) / n) / p->frame.scale,
                             p->frame.corner.y - (y + (j + 0.5) / n) / p->frame.scale);
            hit += in && polygon_contains(p->net->margin, leaf);
        }
    return (double)hit / (n * n);
}

static void check_coverage(Network *net, double scale)
{
    Frame f = {40, 40, scale, vec2(-20.0 / scale, 20.0 + 20.0 / scale)};
    Painter *p = painter_at(net, &f, 2);
    const float *cover = painter_cover(p);
    double sum = 0.0;
    for (uint32_t y = 0; y < 40; y++)
        for (uint32_t x = 0; x < 40; x++) {
            /* 64 x 64 samples err by 1/128 along a straight edge that lies along the grid, and two may do so */
            double error = (double)cover[y * 40 + x] - sampled(p, x, y, 64);
            g_assert_cmpfloat(fabs(error), <, 0.016);
            sum += error;
        }
    g_assert_cmpfloat(fabs(sum / 1600.0), <, 1e-4);
    painter_free(p);
    network_free(net);
}

static void test_coverage(void)
{
    for (uint64_t seed = 0; seed < 3; seed++) {
        check_coverage(net_straws(60, 1.0, seed), 1.0);   /* crossings, about a pixel wide */
        check_coverage(net_straws(200, 0.2, seed), 1.0);  /* many in a pixel, sub-pixel widths */
        check_coverage(net_straws(20, 5.0, seed), 3.0);   /* wide */
        check_coverage(net_tree(30, 20, 0.8, seed), 1.0); /* joints, tapers, branches */
        check_coverage(net_tree(20, 25, 3.0, seed), 2.0); /* wider than its segments are long */
        check_coverage(net_tree(6, 30, 0.5, seed), 12.0); /* smoothed */
        check_coverage(net_tree(60, 20, 0.4, seed), 0.25);
    }
}

/* Veins of one edge each, as wide as each other, between a few nodes: they hold each other's ends, some lie on one another. */
static Network *net_knot(uint32_t n, uint32_t nodes, double width, uint64_t seed)
{
    Network *net = net_straws(n, width, seed);
    uint64_t c = seed * 7777;
    for (uint32_t e = 0; e < n; e++) {
        net->tail[e] = (uint32_t)(uniform(&c) * nodes);
        net->head[e] = (uint32_t)(uniform(&c) * nodes);
        net->width[e] = width;
    }
    return net;
}

static void test_knots(void)
{
    for (uint64_t seed = 0; seed < 4; seed++)
        for (uint32_t nodes = 2; nodes < 7; nodes++) {
            check_coverage(net_knot(nodes, nodes, 0.7, seed), 1.0);
            check_coverage(net_knot(12, nodes, 4.0, seed), 1.0);
            check_coverage(net_knot(9, nodes, 0.2, seed), 1.0);
        }
}

/* A vein that turns by all angles, back onto itself, too, as a part of the disc in its joint shows. */
static void test_bend(void)
{
    for (int i = 0; i <= 36; i++)
        for (int k = 0; k < 3; k++) {
            static const double width[] = {0.4, 3.0, 9.0}, length[] = {12.0, 12.0, 3.0};
            double a = acos(-1.0) * i / 18.0 + 0.001 * (k == 1);
            Network *net = net_new(3, 2, square, 4);
            net->node[0] = vec2(-length[k], 20.3);
            net->node[1] = vec2(0.2, 20.3);
            net->node[2] = vec2(0.2 + 0.9 * length[k] * cos(a), 20.3 + 0.9 * length[k] * sin(a));
            for (uint32_t e = 0; e < 2; e++) {
                net->tail[e] = e;
                net->head[e] = e + 1;
                net->width[e] = width[k] * (e == 0 ? 1.0 : 0.8);
            }
            net->n_veins = 1;
            check_coverage(net, 1.0);
        }
}

/* A star whose points are narrower than a pixel at some sizes. */
static Polygon *star_margin(void)
{
    Vec2 star[14];
    for (int i = 0; i < 14; i++) {
        double r = i % 2 == 0 ? 19.0 : 5.3, a = i * acos(-1.0) / 7.0 + 0.1;
        star[i] = vec2(r * cos(a), 20.0 + r * sin(a));
    }
    return polygon_new(star, 14);
}

/* Veins that run out of the blade end at the margin, exactly, wherever it runs through a pixel. */
static void test_clip(void)
{
    for (uint64_t seed = 0; seed < 3; seed++)
        for (int k = 0; k < 3; k++) {
            static const double scale[] = {0.9, 0.3, 4.0};
            Network *net = k == 1 ? net_straws(40, 3.0, seed) : net_tree(30, 20, 2.0, seed);
            polygon_free(net->margin);
            net->margin = star_margin();
            check_coverage(net, scale[k]);
        }
}

/* What stands on the margin at the base: the vein's round end does not show, in no map. */
static void test_base(void)
{
    Network *net = net_new(2, 1, square, 4);
    net->node[0] = vec2(0.0, 0.0);
    net->node[1] = vec2(0.0, 30.0);
    net->head[0] = 1;
    net->width[0] = 10.0;
    net->n_veins = 1;
    Frame f = {120, 120, 2.0, {-30.0, 50.0}}; /* the base lies along the bottom of row 99 */
    Painter *p = painter_at(net, &f, 2);
    static const MapId id[] = {MAP_VEIN_MASK, MAP_VEIN_ORDER, MAP_VEIN_ID, MAP_VEIN_WIDTH, MAP_AGE};
    for (int i = 0; i < 5; i++) {
        Plane *map = painter_paint(p, id[i]);
        for (uint32_t x = 0; x < 120; x++) {
            if (id[i] != MAP_AGE) /* as wide on the margin as above it */
                g_assert_true((map->px[99 * 120 + x] > 0.0f) == (x >= 50 && x < 70));
            g_assert_cmpfloat(map->px[100 * 120 + x], ==, 0.0f);
        }
        plane_free(map);
    }
    Plane *veins = painter_veins(p);
    for (uint32_t y = 100; y < 120; y++)
        for (uint32_t x = 0; x < 120; x++)
            g_assert_cmpfloat(veins->px[y * 120 + x], ==, 1.0f);
    g_assert_cmpfloat(veins->px[99 * 120 + 60], ==, 0.0f);
    g_assert_cmpfloat(veins->px[99 * 120 + 30], <, 0.8f); /* the margin's line */
    g_assert_cmpfloat(veins->px[96 * 120 + 30], ==, 1.0f);
    plane_free(veins);
    painter_free(p);
    network_free(net);
}

/* A vein that many others leave at its first node is not a bulb there: it tapers. */
static void test_bulb(void)
{
    Network *net = net_new(31, 30, square, 4);
    for (uint32_t i = 0; i <= 30; i++)
        net->node[i] = vec2(0.0, i);
    for (uint32_t e = 0; e < 30; e++) {
        net->tail[e] = e;
        net->head[e] = e + 1;
        net->width[e] = e < 1 ? 8.0 : 3.0;
    }
    net->n_veins = 1;
    Frame f = {400, 400, 10.0, {-20.0, 40.0}};
    Strokes *s = strokes_new(net, &f, (StrokeTolerance){0.02, 0.0});
    g_assert_cmpfloat(s->v[0].shape.ra, <, 26.0); /* pixels; 40 is what the first edge has */
    g_assert_cmpfloat(fabs(s->v[s->n - 1].shape.rb - 15.0), <, 1e-9);
    for (uint32_t i = 0; i < s->n; i++)
        g_assert_cmpfloat((s->v[i].shape.ra - s->v[i].shape.rb) / MAX(s->v[i].shape.length, 1e-9), <, 0.3);
    strokes_free(s);
    network_free(net);
}

/* One straight vein of many edges: area and width at every size, from far below a pixel. */
static void test_capsule_area(void)
{
    Network *net = net_new(31, 30, square, 4);
    for (uint32_t i = 0; i <= 30; i++)
        net->node[i] = vec2(-12.0 + 0.7 * i, 5.0 + 0.6 * i);
    for (uint32_t e = 0; e < 30; e++) {
        net->tail[e] = e;
        net->head[e] = e + 1;
        net->width[e] = 1.5;
    }
    net->n_veins = 1;
    double length = 30.0 * sqrt(0.49 + 0.36), want = 1.5 * length + acos(-1.0) * 1.5 * 1.5 / 4.0;
    static const uint32_t size[] = {8, 16, 64, 256, 4096};
    for (int i = 0; i < 5; i++) {
        Frame f = frame_fit(net->margin->box, size[i], true, 0.02);
        Painter *p = painter_at(net, &f, 0);
        double area = total(painter_cover(p), (gsize)f.width * f.height) / (f.scale * f.scale);
        g_assert_cmpfloat(fabs(area / want - 1.0), <, 1e-4);
        painter_free(p);
    }
    network_free(net);
}

/* A vein of a tenth of a pixel darkens each column by a tenth. */
static void test_thin_vein(void)
{
    Network *net = net_new(2, 1, square, 4);
    net->node[0] = vec2(-19.0, 10.3);
    net->node[1] = vec2(19.0, 14.1);
    net->head[0] = 1;
    net->width[0] = 0.1;
    net->n_veins = 1;
    Frame f = {40, 40, 1.0, {-20.0, 40.0}};
    Painter *p = painter_at(net, &f, 1);
    const float *cover = painter_cover(p);
    double slant = sqrt(1.0 + 0.01);
    for (uint32_t x = 2; x < 38; x++) {
        double sum = 0.0;
        for (uint32_t y = 0; y < 40; y++)
            sum += (double)cover[y * 40 + x];
        g_assert_cmpfloat(fabs(sum - 0.1 * slant), <, 1e-5);
    }
    painter_free(p);
    network_free(net);
}

static void test_area_over_sizes(void)
{
    Network *net = net_tree(120, 18, 1.2, 4);
    double area[2];
    for (int i = 0; i < 2; i++) {
        Frame f = frame_fit((Box2){-22.0, -2.0, 22.0, 42.0}, i == 0 ? 256 : 2048, true, 0.0);
        Painter *p = painter_at(net, &f, 0);
        area[i] = total(painter_cover(p), (gsize)f.width * f.height) / (f.scale * f.scale);
        painter_free(p);
    }
    g_assert_cmpfloat(fabs(area[0] / area[1] - 1.0), <, 1e-3);
    network_free(net);
}

/* Between two nodes the curve stays near the chord and passes through the nodes. */
static void test_strokes(void)
{
    Network *net = net_tree(10, 30, 0.5, 8);
    Frame f = {2000, 2000, 50.0, {-20.0, 40.0}};
    Strokes *s = strokes_new(net, &f, (StrokeTolerance){0.02, 0.0});
    for (uint32_t i = 0; i < net->n_nodes; i++) {
        Vec2 q = vec2((net->node[i].x + 20.0) * 50.0, (40.0 - net->node[i].y) * 50.0);
        double least = 1e9;
        for (uint32_t k = 0; k < s->n; k++) {
            Capsule axis = capsule_new(s->v[k].shape.a, 0.0, s->v[k].shape.b, 0.0);
            double t;
            least = MIN(least, capsule_distance(&axis, q, &t));
        }
        g_assert_cmpfloat(least, <, 0.03);
    }
    for (uint32_t k = 0; k < s->n; k++) { /* no corners: pieces of one vein turn little */
        if (k > 0 && s->v[k].vein == s->v[k - 1].vein)
            g_assert_cmpfloat(vec_dot(s->v[k].shape.d, s->v[k - 1].shape.d), >, 0.97);
    }
    strokes_free(s);
    network_free(net);
}

/* ---- blade ---- */

static void test_opacity(void)
{
    Vec2 star[10];
    for (int i = 0; i < 10; i++) {
        double r = i % 2 == 0 ? 18.0 : 7.3, a = i * acos(-1.0) / 5.0 + 0.1;
        star[i] = vec2(r * cos(a), 20.0 + r * sin(a));
    }
    Network *net = net_new(1, 0, star, 10);
    static const uint32_t size[] = {17, 100, 1000};
    for (int i = 0; i < 3; i++) {
        Frame f = frame_fit(net->margin->box, size[i], i == 1, 0.05);
        Painter *p = painter_at(net, &f, 3);
        Plane *o = painter_paint(p, MAP_OPACITY);
        double area = total(o->px, (gsize)o->width * o->height) / (f.scale * f.scale);
        g_assert_cmpfloat(fabs(area / net->margin->area - 1.0), <, 1e-6);
        plane_free(o);
        painter_free(p);
    }
    /* part of the star, against samples */
    Frame f = {30, 30, 1.3, {-3.0, 30.0}};
    Painter *p = painter_at(net, &f, 3);
    Plane *o = painter_paint(p, MAP_OPACITY);
    for (uint32_t y = 0; y < 30; y++)
        for (uint32_t x = 0; x < 30; x++) {
            int hit = 0;
            for (int k = 0; k < 64 * 64; k++) {
                double sx = x + (k % 64 + 0.5) / 64.0, sy = y + (k / 64 + 0.5) / 64.0;
                hit += polygon_contains(net->margin, vec2(-3.0 + sx / 1.3, 30.0 - sy / 1.3));
            }
            g_assert_cmpfloat(fabs((double)o->px[y * 30 + x] - hit / 4096.0), <, 0.012);
        }
    plane_free(o);
    painter_free(p);
    network_free(net);
}

/* A network without veins, whose blade and scale are those of `net`. */
static Network *net_bare(const Network *net)
{
    return net_new(1, 0, net->margin->v, net->margin->n);
}

/* Beyond the margin lies what a blade without veins would have there, as far as the padding goes, whatever veins end at the margin. */
static void test_padding(void)
{
    static const MapId id[] = {MAP_BASE_COLOR, MAP_ABAXIAL_BASE_COLOR, MAP_ROUGHNESS, MAP_TRANSLUCENCY, MAP_HEIGHT, MAP_THICKNESS};
    Network *net = net_straws(60, 3.0, 2), *bare = net_bare(net);
    for (uint32_t i = 0; i < 30; i++) /* veins that cross the margin */
        net->node[2 * i] = vec2(30.0 * (i % 2 != 0 ? 1.0 : -1.0), 1.3 * i);
    Frame f = {90, 70, 1.2, {-30.0, 45.0}};
    PaintStyle style = paint_style_default();
    style.padding = 6 * 2048 / 90;
    style.reference = net;
    Painter *p = painter_new(net, &f, &style), *q = painter_new(bare, &f, &style);
    const float *blade = painter_blade(p);
    for (int k = 0; k < 6; k++) {
        Plane *c = painter_paint(p, id[k]), *d = painter_paint(q, id[k]);
        uint32_t nc = c->channels;
        for (int y = 0; y < 70; y++)
            for (int x = 0; x < 90; x++) {
                gsize at = (gsize)(y * 90 + x);
                if (blade[at] > 0.0f)
                    continue;
                const float *px = c->px + nc * at;
                Vec2 leaf = vec2(-30.0 + (x + 0.5) / 1.2, 45.0 - (y + 0.5) / 1.2);
                Vec2 foot = vec2(CLAMP(leaf.x, -20.0, 20.0), CLAMP(leaf.y, 0.0, 40.0));
                bool padded = vec_dist(leaf, foot) * 1.2 <= style.padding * 90.0 / 2048.0;
                g_assert_true(memcmp(px, d->px + nc * at, nc * sizeof(float)) == 0);
                g_assert_true((px[0] != 0.0f) == padded);
            }
        plane_free(c);
        plane_free(d);
    }
    painter_free(p);
    painter_free(q);
    network_free(net);
    network_free(bare);
}

/* It goes on from the blade's edge without a step. */
static void test_padding_step(void)
{
    Network *net = net_new(1, 0, square, 4);
    Frame f = {900, 100, 20.0, {-22.5, 30.0}};
    Painter *p = painter_at(net, &f, 2);
    Plane *c = painter_paint(p, MAP_BASE_COLOR);
    for (uint32_t y = 0; y < 100; y++) { /* the left margin is at x = 50 */
        const float *px = c->px + 3 * (900 * y + 49);
        g_assert_true(painter_blade(p)[900 * y + 49] == 0.0f && painter_blade(p)[900 * y + 50] > 0.0f);
        for (int i = 0; i < 3; i++) {
            g_assert_cmpfloat(px[i], >, 0.0f);
            g_assert_cmpfloat(fabs((double)(px[i + 3] - px[i])), <, 0.02);
        }
    }
    plane_free(c);
    painter_free(p);
    network_free(net);
}

/* Larger maps have more padding: as much of the leaf. */
static void test_padding_scale(void)
{
    Network *net = net_new(1, 0, square, 4);
    for (uint32_t size = 256; size <= 1024; size *= 2) {
        Frame f = {size, 1, size / 80.0, {-40.0, 20.0}};
        PaintStyle style = paint_style_default();
        style.padding = 128;
        Painter *p = painter_new(net, &f, &style);
        Plane *c = painter_paint(p, MAP_BASE_COLOR);
        uint32_t n = 0;
        for (uint32_t x = 0; x < size / 4; x++)
            n += c->px[3 * x + 1] > 0.0f;
        g_assert_cmpuint(n, ==, size / 16);
        plane_free(c);
        painter_free(p);
    }
    network_free(net);
}

/* ---- data ---- */

static void test_distance(void)
{
    for (uint64_t seed = 0; seed < 2; seed++) {
        Network *net = net_straws(seed == 0 ? 12 : 300, 0.5, seed);
        Frame f = frame_fit(net->margin->box, 150, true, 0.1);
        Painter *p = painter_at(net, &f, 2);
        Plane *d = painter_paint(p, MAP_DISTANCE);
        for (uint32_t y = 0; y < f.height; y++)
            for (uint32_t x = 0; x < f.width; x++) {
                Vec2 q = vec2(f.corner.x + (x + 0.5) / f.scale, f.corner.y - (y + 0.5) / f.scale);
                double least = 1e9;
                for (uint32_t e = 0; e < net->n_edges; e++) {
                    Vec2 a = net->node[net->tail[e]], b = net->node[net->head[e]], ab = vec_sub(b, a);
                    double t = CLAMP(vec_dot(vec_sub(q, a), ab) / vec_norm2(ab), 0.0, 1.0);
                    least = MIN(least, vec_dist(q, vec_lerp(a, b, t)) - 0.5 * net->width[e]);
                }
                double want = painter_blade(p)[y * f.width + x] > 0.0f ? MAX(least, 0.0) : 0.0;
                g_assert_cmpfloat(fabs((double)d->px[y * f.width + x] - want), <, 1e-5);
            }
        plane_free(d);
        painter_free(p);
        network_free(net);
    }
}

/* A vein far thinner than a pixel is an unbroken line of labels; widths and ages are those of the network. */
static void test_thin_labels(void)
{
    Network *net = net_new(61, 60, square, 4);
    for (uint32_t i = 0; i <= 60; i++)
        net->node[i] = vec2(-18.0 + 0.6 * i, 10.0 + 0.25 * i + 0.002 * i * i);
    for (uint32_t e = 0; e < 60; e++) {
        net->tail[e] = e;
        net->head[e] = e + 1;
        net->width[e] = 0.02;
        net->birth[e] = e;
        net->vein[e] = 70000;
        net->order[e] = 3;
    }
    net->n_veins = 70001;
    static const uint32_t size[] = {40, 333, 1000};
    for (int k = 0; k < 3; k++) {
        Frame f = frame_fit(net->margin->box, size[k], true, 0.0);
        Painter *p = painter_at(net, &f, 2);
        Plane *id = painter_paint(p, MAP_VEIN_ID), *order = painter_paint(p, MAP_VEIN_ORDER);
        Plane *width = painter_paint(p, MAP_VEIN_WIDTH), *age = painter_paint(p, MAP_AGE);
        int last_lo = -1, last_hi = -1;
        uint32_t first = (uint32_t)(2.5 * f.scale), end = (uint32_t)(37.5 * f.scale);
        for (uint32_t x = first; x < end; x++) {
            int lo = -1, hi = -1;
            for (int y = 0; y < (int)f.height; y++) {
                gsize at = (gsize)y * f.width + x;
                g_assert_true(id->px[at] == 0.0f || id->px[at] == 70001.0f);
                g_assert_true((id->px[at] != 0.0f) == (order->px[at] == 3.0f));
                if (id->px[at] == 0.0f)
                    continue;
                lo = lo < 0 ? y : lo;
                hi = y;
                g_assert_cmpfloat(fabs((double)width->px[at] - 0.02), <, 1e-6);
                double edge =
                    ((x + 0.5) / f.scale - 2.0) / 0.6; /* pixels lie up to one beside their place along the vein */
                g_assert_cmpfloat(fabs((double)age->px[at] - edge), <, 1.7 + 1.0 / f.scale);
            }
            g_assert_cmpint(lo, >=, 0);
            if (last_lo >= 0) /* touches the last column's run, corners included */
                g_assert_true(lo <= last_hi + 1 && hi >= last_lo - 1);
            last_lo = lo;
            last_hi = hi;
        }
        plane_free(id);
        plane_free(order);
        plane_free(width);
        plane_free(age);
        painter_free(p);
    }
    network_free(net);
}

/* Where veins cross the lower order wins; wide veins keep to their own pixels. */
static void test_label_priority(void)
{
    Network *net = net_new(4, 2, square, 4);
    net->node[0] = vec2(-15.0, 20.0);
    net->node[1] = vec2(15.0, 20.0);
    net->node[2] = vec2(0.0, 5.0);
    net->node[3] = vec2(0.0, 35.0);
    net->tail[1] = 2;
    net->head[0] = 1;
    net->head[1] = 3;
    net->width[0] = 6.0;
    net->width[1] = 4.0;
    net->order[0] = 2;
    net->order[1] = 1;
    net->vein[1] = 1;
    net->n_veins = 2;
    Frame f = {400, 400, 10.0, {-20.0, 40.0}};
    Painter *p = painter_at(net, &f, 2);
    Plane *order = painter_paint(p, MAP_VEIN_ORDER);
    const float *cover = painter_cover(p);
    g_assert_cmpfloat(order->px[200 * 400 + 200], ==, 1.0f);
    g_assert_cmpfloat(order->px[200 * 400 + 100], ==, 2.0f);
    for (gsize i = 0; i < 400 * 400; i++) {
        if (cover[i] > 0.51f)
            g_assert_cmpfloat(order->px[i], >, 0.0f);
        if (cover[i] < 0.49f)
            g_assert_cmpfloat(order->px[i], ==, 0.0f);
    }
    plane_free(order);
    painter_free(p);
    network_free(net);
}

/* ---- surface ---- */

/* Over a wide straight vein the surface is the arch relief * r * (1 - 0.625 u²), whose slope across is -1.25 relief u.
 */
static void test_normals(void)
{
    static const Vec2 strip[4] = {{-50.0, 0.0}, {50.0, 0.0}, {50.0, 40.0}, {-50.0, 40.0}};
    Network *net = net_new(2, 1, strip, 4);
    net->node[0] = vec2(-45.0, 20.0);
    net->node[1] = vec2(45.0, 20.0);
    net->head[0] = 1;
    net->width[0] = 20.0;
    net->n_veins = 1;
    Frame f = {500, 200, 5.0, {-50.0, 40.0}};
    Painter *p = painter_at(net, &f, 2);
    Plane *n = painter_paint(p, MAP_NORMAL_GL), *h = painter_paint(p, MAP_HEIGHT);
    for (uint32_t y = 90; y < 110; y++) {
        double up = 20.0 - (y + 0.5) / 5.0, u = fabs(up) / 10.0, slope = 1.25 * 0.6 * u * (up > 0.0 ? -1.0 : 1.0);
        double k = 1.0 / sqrt(1.0 + slope * slope);
        const float *px = n->px + 3 * (y * 500 + 250);
        g_assert_cmpfloat(fabs((double)px[0] - 0.5), <, 1e-3);
        g_assert_cmpfloat(fabs((double)px[1] - (0.5 - 0.5 * slope * k)), <, 4e-3);
        g_assert_cmpfloat(fabs((double)px[2] - (0.5 + 0.5 * k)), <, 4e-3);
        g_assert_cmpfloat(fabs((double)h->px[y * 500 + 250] - 6.0 * (1.0 - 0.625 * u * u)), <, 0.02);
    }
    g_assert_true(h->px[10 * 500 + 250] < 0.0f); /* the blade beside it is sunk */
    g_assert_cmpfloat(h->low, <, (double)h->px[10 * 500 + 250]);
    g_assert_cmpfloat(h->high, >=, 6.0);
    plane_free(n);
    plane_free(h);
    painter_free(p);
    network_free(net);
}

/* Normals are those of the height map: differences over two pixels, over one where the blade ends; the image's last pixel is its own neighbour. */
static void test_normals_of_heights(void)
{
    Network *net = net_tree(60, 15, 2.0, 8);
    Frame f = {131, 170, 5.0, {-15.0, 36.0}}; /* cuts through the blade */
    Frame around = {210, 230, 5.0, {-21.0, 43.0}};
    for (int k = 0; k < 2; k++) {
        Painter *p = painter_at(net, k == 0 ? &f : &around, 2);
        Plane *h = painter_paint(p, MAP_HEIGHT), *n = painter_paint(p, MAP_NORMAL_GL), *o = painter_paint(p, MAP_OPACITY);
        int32_t w = (int32_t)h->width, rows = (int32_t)h->height;
        for (int32_t i = 0; i < w * rows; i++) {
            const int32_t x = i % w, y = i / w, step[2] = {1, -w}, at[2] = {x, rows - 1 - y}, last[2] = {w - 1, rows - 1};
            double d[2] = {0.0, 0.0};
            for (int a = 0; a < 2 && o->px[i] > 0.0f; a++) {
                int32_t from = at[a] > 0 ? i - step[a] : i, to = at[a] < last[a] ? i + step[a] : i;
                bool has_from = o->px[from] > 0.0f, has_to = o->px[to] > 0.0f;
                d[a] = 5.0 * (double)(h->px[has_to ? to : i] - h->px[has_from ? from : i]) / (has_from && has_to ? 2.0 : 1.0);
            }
            double length = sqrt(1.0 + d[0] * d[0] + d[1] * d[1]);
            g_assert_cmpfloat(fabs((double)n->px[3 * i] - 0.5 * (1.0 - d[0] / length)), <, 1e-4);
            g_assert_cmpfloat(fabs((double)n->px[3 * i + 1] - 0.5 * (1.0 - d[1] / length)), <, 1e-4);
            g_assert_cmpfloat(fabs((double)n->px[3 * i + 2] - 0.5 * (1.0 + 1.0 / length)), <, 1e-4);
        }
        plane_free(h);
        plane_free(n);
        plane_free(o);
        painter_free(p);
    }
    network_free(net);
}

/* Where two equal veins cross they merge in a rounded rise, higher than either and level on top; a veinlet that joins a
 * vein leaves it as it is. */
static void test_merge(void)
{
    Network *net = net_new(6, 3, square, 4);
    net->node[0] = vec2(-15.0, 20.0);
    net->node[1] = vec2(15.0, 20.0);
    net->node[2] = vec2(0.0, 5.0);
    net->node[3] = vec2(0.0, 35.0);
    net->node[4] = vec2(-8.0, 5.0);
    net->node[5] = vec2(-8.0, 20.0);
    static const double width[] = {4.0, 4.0, 0.4};
    for (uint32_t e = 0; e < 3; e++) {
        net->tail[e] = 2 * e;
        net->head[e] = 2 * e + 1;
        net->vein[e] = e;
        net->width[e] = width[e];
    }
    net->n_veins = 3;
    Frame f = {401, 401, 10.0, {-20.05, 40.05}}; /* 0,20 is the middle of pixel 200,200 */
    Painter *p = painter_at(net, &f, 2);
    Plane *height = painter_paint(p, MAP_HEIGHT), *normal = painter_paint(p, MAP_NORMAL_GL);
    double single = (double)height->px[200 * 401 + 300];
    g_assert_cmpfloat(fabs(single - 1.2), <, 0.03); /* the blade is sunk a little */
    g_assert_cmpfloat(fabs((double)height->px[200 * 401 + 200] - 1.3 * single), <, 0.04);
    g_assert_cmpfloat((double)height->px[200 * 401 + 200], <=, height->high);
    g_assert_cmpfloat(fabs((double)height->px[200 * 401 + 120] - single), <, 0.02);
    g_assert_cmpfloat(fabs((double)normal->px[3 * (200 * 401 + 200)] - 0.5), <, 1e-3);
    for (uint32_t d = 15; d < 25; d++) { /* no crease along the diagonal: the slope turns slowly there */
        const float *a = normal->px + 3 * ((200 - d) * 401 + 198 + d), *b = normal->px + 3 * ((198 - d) * 401 + 200 + d);
        g_assert_cmpfloat(fabs((double)(a[0] - b[0])), <, 0.12);
    }
    plane_free(height);
    plane_free(normal);
    painter_free(p);
    network_free(net);
}

/* Veins of each size show on the sunny side and by the dark beside them, the smaller the fainter, down to those that are as the net. */
static void test_small_relief(void)
{
    static const double width[] = {2.0, 0.4, 0.1, 0.003};
    Network *net = net_new(8, 4, square, 4);
    for (uint32_t e = 0; e < 4; e++) {
        net->tail[e] = 2 * e;
        net->head[e] = 2 * e + 1;
        net->node[2 * e] = vec2(-12.0 + 8.0 * e, 1.0);
        net->node[2 * e + 1] = vec2(-12.0 + 8.0 * e, 39.0);
        net->vein[e] = e;
        net->width[e] = width[e];
    }
    net->n_veins = 4;
    Frame f = {1600, 1, 40.0, {-20.0, 20.0}};
    Painter *p = painter_at(net, &f, 2);
    Plane *ao = painter_paint(p, MAP_AO), *normal = painter_paint(p, MAP_ADAXIAL_NORMAL_GL);
    double dark[4], tilt[4];
    for (int e = 0; e < 4; e++) {
        dark[e] = tilt[e] = 0.0;
        for (int x = 320 * e + 160; x < 320 * e + 480; x++) {
            dark[e] = MAX(dark[e], 1.0 - (double)ao->px[x]);
            if (abs(x - 320 * e - 320) < 20)
                tilt[e] = MAX(tilt[e], fabs((double)normal->px[3 * x] - 0.5));
        }
        g_assert_cmpfloat(ao->px[320 * e + 320], >, 0.99f); /* not on the vein */
    }
    g_assert_true(dark[0] > 0.2 && dark[1] > 0.1 && dark[2] > 0.04 && dark[0] > dark[1] && dark[1] > dark[2]);
    g_assert_cmpfloat(dark[3], <, 0.01);
    g_assert_true(tilt[1] > tilt[3] + 0.03 && tilt[2] > tilt[3] + 0.02); /* the net's own arch is everywhere */
    plane_free(ao);
    plane_free(normal);
    painter_free(p);
    network_free(net);
}

/* ---- looks ---- */

/* Pixels that the margin cuts have the colour of what the blade is there, a vein's when it is a vein. */
static void test_edge_colour(void)
{
    Network *net = net_new(2, 1, square, 4);
    net->node[1] = vec2(0.0, 30.0);
    net->head[0] = 1;
    net->width[0] = 10.0;
    net->n_veins = 1;
    Frame f = {120, 120, 2.0, {-30.0, 49.9}}; /* the blade covers four fifths of row 99 */
    PaintStyle style = paint_style_default();
    style.variation = 0.0;
    Painter *p = painter_new(net, &f, &style);
    Plane *c = painter_paint(p, MAP_BASE_COLOR);
    g_assert_cmpfloat(fabs((double)painter_blade(p)[99 * 120 + 60] - 0.8), <, 1e-5);
    for (int i = 0; i < 3; i++)
        g_assert_cmpfloat(fabs((double)c->px[3 * (99 * 120 + 60) + i] / (double)c->px[3 * (90 * 120 + 60) + i] - 1.0), <, 0.03);
    plane_free(c);
    painter_free(p);
    network_free(net);
}

/* A single short segment that bears all the flow of the base does not pale the veins of the rest. */
static void test_stout(void)
{
    float vein[2][3];
    for (int k = 0; k < 2; k++) {
        Network *net = net_new(41, 40, square, 4);
        for (uint32_t i = 0; i <= 40; i++)
            net->node[i] = vec2(0.0, 0.9 * i);
        for (uint32_t e = 0; e < 40; e++) {
            net->tail[e] = e;
            net->head[e] = e + 1;
            net->width[e] = k == 1 && e == 0 ? 20.0 : 2.0;
            net->order[e] = 4;
        }
        net->n_veins = 1;
        Frame f = {120, 120, 3.0, {-20.0, 40.0}};
        Painter *p = painter_at(net, &f, 2);
        Plane *c = painter_paint(p, MAP_BASE_COLOR);
        memcpy(vein[k], c->px + 3 * (30 * 120 + 60), sizeof vein[k]);
        plane_free(c);
        painter_free(p);
        network_free(net);
    }
    for (int i = 0; i < 3; i++)
        g_assert_cmpfloat(fabs((double)(vein[0][i] - vein[1][i])), <, 0.02);
}

/* A vein's colour goes by its width and as smoothly as that; a change of order does not show. */
static void test_strength(void)
{
    Network *net = net_new(81, 80, square, 4);
    for (uint32_t i = 0; i <= 80; i++)
        net->node[i] = vec2(0.0, 0.45 * i + 1.0);
    for (uint32_t e = 0; e < 80; e++) {
        net->tail[e] = e;
        net->head[e] = e + 1;
        net->width[e] = 2.5 - 0.025 * e;
        net->order[e] = (uint8_t)(1 + e / 20);
        net->vein[e] = e / 20;
    }
    net->n_veins = 4;
    Frame f = {400, 400, 10.0, {-20.0, 40.0}};
    PaintStyle style = paint_style_default();
    style.variation = 0.0;
    Painter *p = painter_new(net, &f, &style);
    Plane *c = painter_paint(p, MAP_BASE_COLOR);
    const float *px = c->px + 3 * 200;
    for (uint32_t y = 45; y < 380; y++) /* down the vein, which tapers */
        g_assert_cmpfloat(fabs((double)(px[1200 * y] - px[1200 * (y + 1)])), <, 0.012);
    g_assert_cmpfloat((double)px[1200 * 370], >, 1.3 * (double)px[1200 * 50]);
    plane_free(c);
    painter_free(p);
    network_free(net);
}

static double spread(const Plane *c, const float *blade, uint32_t channel)
{
    double low = 1.0, high = 0.0;
    for (gsize i = 0; i < (gsize)c->width * c->height; i++)
        if (blade[i] == 1.0f) {
            low = MIN(low, (double)c->px[3 * i + channel]);
            high = MAX(high, (double)c->px[3 * i + channel]);
        }
    return high - low;
}

/* Colours differ by no more than vein, blade and margin do: a blade of one colour is even, whatever that colour; in a
 * pale one the veins are darker and nothing is lighter than the blade. */
static void test_colours(void)
{
    Network *net = net_tree(120, 18, 1.2, 4);
    Frame f = frame_fit(net->margin->box, 256, true, 0.02);
    static const uint32_t colour[] = {0xfffdf8, 0x808080, 0x1f3f10, 0xc02010};
    for (int k = 0; k < 4; k++)
        for (int same = 0; same < 2; same++) {
            PaintStyle style = paint_style_default();
            style.variation = 0.0;
            paint_colour(colour[k], style.lamina);
            paint_colour(same ? colour[k] : 0xa0b078, style.vein);
            paint_colour(colour[k], style.margin);
            Painter *p = painter_new(net, &f, &style);
            Plane *c = painter_paint(p, MAP_BASE_COLOR);
            for (uint32_t i = 0; i < 3; i++) {
                double lamina = (double)style.lamina[i], vein = (double)style.vein[i], contrast = fabs(lamina - vein);
                g_assert_cmpfloat(spread(c, painter_blade(p), i), <=, 1.2 * contrast + 0.16 * MIN(vein, 1.0 - vein) + 1e-3);
                if (same == 0)
                    g_assert_cmpfloat(spread(c, painter_blade(p), i), >=, 0.7 * contrast - 0.02);
                for (gsize j = 0; j < 256 * 256 && k == 0; j++)
                    if (painter_blade(p)[j] == 1.0f)
                        g_assert_cmpfloat((double)c->px[3 * j + i], <=, MIN(lamina + 0.06 * contrast, 1.0) + 2e-3);
            }
            plane_free(c);
            painter_free(p);
        }
    network_free(net);
}

/* Part of the blade, across its middle, that the margin's colour reaches. */
static double band_share(double width, double height)
{
    Vec2 margin[4] = {{-0.5 * width, 0.0}, {0.5 * width, 0.0}, {0.5 * width, height}, {-0.5 * width, height}};
    Network *net = net_new(1, 0, margin, 4);
    Frame f = {2000, 1, 2000.0 / width, {-0.5 * width, 0.5 * height}};
    PaintStyle style = paint_style_default();
    style.variation = 0.0;
    paint_colour(0x000000, style.lamina);
    paint_colour(0x000000, style.vein);
    paint_colour(0xff0000, style.margin);
    Painter *p = painter_new(net, &f, &style);
    Plane *c = painter_paint(p, MAP_BASE_COLOR);
    int reached = 0;
    for (int x = 0; x < 2000; x++)
        reached += c->px[3 * x] > 0.01f;
    plane_free(c);
    painter_free(p);
    network_free(net);
    return reached / 2000.0;
}

/* The band along the margin is narrow on blades of grass too. */
static void test_band(void)
{
    g_assert_cmpfloat(band_share(100.0, 100.0), <, 0.015);
    g_assert_cmpfloat(band_share(10.0, 100.0), <, 0.06);
    g_assert_cmpfloat(band_share(1.0, 100.0), <, 0.06);
    g_assert_cmpfloat(band_share(1.0, 100.0), >, 0.01);
}

/* ---- the whole ---- */

static void test_threads(void)
{
    Network *net = net_tree(150, 15, 1.0, 3);
    Frame f = frame_fit(net->margin->box, 300, true, 0.02);
    static const unsigned threads[] = {1, 2, 7};
    Plane *first[MAP_COUNT + 1];
    for (int k = 0; k < 3; k++) {
        Painter *p = painter_at(net, &f, threads[k]);
        for (int i = 0; i <= MAP_COUNT; i++) {
            MapId id = (MapId)(k == 1 ? MAP_COUNT - i : i); /* nor does the order of the maps matter */
            Plane *plane = id == MAP_COUNT ? painter_veins(p) : painter_paint(p, id);
            gsize n = (gsize)plane->width * plane->height * plane->channels * sizeof(float);
            for (gsize j = 0; j < n / sizeof(float); j++)
                g_assert_true(isfinite(plane->px[j]));
            if (k == 0) {
                first[id] = plane;
                continue;
            }
            g_assert_true(memcmp(plane->px, first[id]->px, n) == 0);
            g_assert_true(plane->low == first[id]->low && plane->high == first[id]->high);
            plane_free(plane);
        }
        painter_free(p);
    }
    for (int i = 0; i <= MAP_COUNT; i++)
        plane_free(first[i]);
    network_free(net);
}

/* What is left in a plane that is given back must not come to light again. */
static void give_back_spoilt(Painter *p, Plane *plane)
{
    for (gsize i = 0; i < (gsize)plane->width * plane->height * plane->channels; i++)
        plane->px[i] = NAN;
    painter_give_back(p, plane);
}

/* Bands of any height, in any order, hold the pixels that the whole has. */
static void test_bands(void)
{
    Network *net = net_tree(150, 15, 1.0, 3), *sparse = net_tree(3, 15, 1.0, 3);
    Frame f = frame_fit(net->margin->box, 300, true, 0.1);
    for (int k = 0; k < 2; k++) {
        static const uint32_t heights[] = {1, 7, 32, 100, 299};
        Painter *whole = painter_at(k == 0 ? net : sparse, &f, 1);
        Plane *want[MAP_COUNT + 1];
        for (int i = 0; i <= MAP_COUNT; i++)
            want[i] = i == MAP_COUNT ? painter_veins(whole) : painter_paint(whole, (MapId)i);
        for (int h = 0; h < 5; h++) {
            Painter *p = painter_at(k == 0 ? net : sparse, &f, h % 2 != 0 ? 3 : 1);
            uint32_t n = (f.height - 1) / heights[h] + 1;
            gboolean expected[MAP_COUNT];
            for (int i = 0; i < MAP_COUNT; i++) /* none, all, every other one */
                expected[i] = h % 3 == 1 || (h % 3 == 2 && i % 2 == 0);
            painter_expect(p, expected);
            for (uint32_t b = 0; b < n; b++) {
                uint32_t y0 = (h == 3 ? n - 1 - b : b) * heights[h], y1 = MIN(y0 + heights[h], f.height);
                painter_band(p, y0, y1);
                for (int i = (int)(b % 3); i <= MAP_COUNT; i++) { /* not every map in every band */
                    Plane *plane = i == MAP_COUNT ? painter_veins(p) : painter_paint(p, (MapId)i);
                    gsize row = (gsize)f.width * plane->channels;
                    g_assert_cmpuint(plane->height, ==, y1 - y0);
                    g_assert_true(plane->low == want[i]->low && plane->high == want[i]->high);
                    g_assert_true(memcmp(plane->px, want[i]->px + row * y0, row * (y1 - y0) * sizeof(float)) == 0);
                    give_back_spoilt(p, plane);
                }
            }
            painter_free(p);
        }
        for (int i = 0; i <= MAP_COUNT; i++)
            plane_free(want[i]);
        painter_free(whole);
    }
    network_free(net);
    network_free(sparse);
}

/* Rows of noise are the noise at their points, on lattices of all sizes, within the region and a little beyond. */
static void test_noise_rows(void)
{
    static const double wave[] = {0.3, 1.0, 7.7, 400.0};
    Box2 region = {-30.0, -10.0, 31.0, 42.0};
    float out[700];
    for (int k = 0; k < 4; k++)
        for (int m = 0; m < 3; m++) {
            double step = m == 0 ? 0.1 : m == 1 ? 0.09 : 1.0 / 256.0, sum = 0.0; /* 1/256: cells begin at pixels */
            Noise n;
            noise_init(&n, 11, (uint32_t)k, wave[k], region, 100.0);
            for (double y = -10.0; y <= 42.0; y += 1.3) {
                Vec2 start = vec2(-30.0 - step, y);
                for (uint32_t i = 0; i < 700; i++)
                    out[i] = -7.0f;
                noise_row(&n, start, step, 3, 640, out);
                for (uint32_t i = 3; i < 640; i++) {
                    double want = noise_at(&n, vec2(start.x + i * step, y));
                    g_assert_cmpfloat(fabs((double)out[i] - want), <, 1e-6 * (1.0 + fabs(want)));
                    sum += fabs(want);
                }
                g_assert_true(out[2] == -7.0f && out[640] == -7.0f);
            }
            g_assert_cmpfloat(sum, >, 100.0);
            noise_clear(&n);
        }
}

static const Capsule *any_stroke(uint32_t i, const void *user) { return &((const Capsule *)user)[i]; }
static Capsule any_area(uint32_t i, const void *user) { return ((const Capsule *)user)[i]; }

/* Distances to strokes near and far, few and many, with a limit and without, and which stroke it is. */
static void test_nearest(void)
{
    static const uint32_t count[] = {0, 1, 3, 500};
    static const double limit[] = {1e6, 20.0};
    const uint32_t w = 210, h = 170;
    Pool *pool = pool_new(2);
    float *distance = g_new(float, w * h);
    uint32_t *which = g_new(uint32_t, w * h);
    uint64_t c = 77;
    for (int k = 0; k < 8; k++) {
        uint32_t n = count[k / 2];
        Capsule *stroke = g_new(Capsule, n + 1);
        for (uint32_t i = 0; i < n; i++) {
            Vec2 a = vec2(uniform(&c) * w, uniform(&c) * h), b = vec2(a.x + 40.0 * (uniform(&c) - 0.5), a.y + 40.0 * (uniform(&c) - 0.5));
            stroke[i] = capsule_new(a, 3.0 * uniform(&c), b, uniform(&c));
        }
        Bins bins;
        bins_init(&bins, w, h, n, any_area, stroke);
        Nearest *q = nearest_new(&bins, n, any_stroke, stroke, limit[k % 2]);
        nearest_fill(q, pool, 0, h, NULL, distance, which);
        for (uint32_t i = 0; i < w * h; i++) {
            Vec2 at = vec2(i % w + 0.5, i / w + 0.5);
            double least = limit[k % 2], t;
            for (uint32_t s = 0; s < n; s++)
                least = MIN(least, capsule_distance(&stroke[s], at, &t));
            g_assert_cmpfloat(fabs((double)distance[i] - least), <, 1e-4);
            g_assert_true((which[i] == 0xFFFFFFFFu) == ((double)distance[i] >= limit[k % 2]));
            if (which[i] != 0xFFFFFFFFu)
                g_assert_cmpfloat(fabs(capsule_distance(&stroke[which[i]], at, &t) - least), <, 1e-4);
        }
        nearest_free(q);
        bins_clear(&bins);
        g_free(stroke);
    }
    g_free(distance);
    g_free(which);
    pool_free(pool);
}

/* Pixels that are not asked for have no distance, whatever was there. */
static void test_nearest_where(void)
{
    enum { W = 75, H = 70 };
    Capsule stroke = capsule_new(vec2(20, 30), 2.0, vec2(50, 40), 1.0);
    Bins bins;
    bins_init(&bins, W, H, 1, any_area, &stroke);
    Pool *pool = pool_new(1);
    Nearest *q = nearest_new(&bins, 1, any_stroke, &stroke, 1e6);
    float *all = g_new(float, W * H), *some = g_new(float, W * H), *where = g_new0(float, W * H);
    for (int i = 0; i < W * H; i++) {
        some[i] = NAN;
        where[i] = i % W < 40 && i % 3 == 0 ? 0.5f : 0.0f;
    }
    nearest_fill(q, pool, 0, H, NULL, all, NULL);
    nearest_fill(q, pool, 0, H, where, some, NULL);
    for (int i = 0; i < W * H; i++)
        g_assert_cmpfloat((double)some[i], ==, where[i] > 0.0f ? (double)all[i] : 0.0);
    nearest_free(q);
    pool_free(pool);
    bins_clear(&bins);
    g_free(all);
    g_free(some);
    g_free(where);
}

/* Strokes that are made along with others are those that are made alone. */
static void test_strokes_together(void)
{
    static const StrokeTolerance tol[] = {{0.04, 0.0}, {0.1, 0.03}, {0.5, 0.0}};
    Network *net = net_tree(150, 15, 1.0, 3);
    Frame f = frame_fit(net->margin->box, 700, true, 0.02);
    Strokes *together[3];
    strokes_make(net, &f, 3, tol, together);
    for (int i = 0; i < 3; i++) {
        Strokes *alone = strokes_new(net, &f, tol[i]);
        g_assert_cmpuint(together[i]->n, ==, alone->n);
        g_assert_cmpuint(alone->n, >, 15);
        for (uint32_t k = 0; k < alone->n; k++) {
            const Stroke *s = &alone->v[k], *t = &together[i]->v[k];
            g_assert_true(memcmp(&s->shape, &t->shape, sizeof s->shape) == 0);
            g_assert_true(s->vein == t->vein && s->birth0 == t->birth0 && s->birth1 == t->birth1 && s->order == t->order && s->cut == t->cut);
        }
        strokes_free(alone);
        strokes_free(together[i]);
    }
    network_free(net);
}

/* No veins, no blade, images of one pixel: nothing breaks. */
static void test_degenerate(void)
{
    for (int k = 0; k < 4; k++) {
        Network *net = k < 2 ? net_new(1, 0, square, 4) : net_straws(5, 1.0, 1);
        if (k >= 2)
            net->head[0] = net->tail[0] = 0; /* an edge without length */
        if (k % 2 != 0) {
            polygon_free(net->margin);
            net->margin = NULL;
        }
        Box2 box = {-20.0, 0.0, 20.0, 40.0};
        Frame f = frame_fit(box, k == 2 ? 1 : 33, k == 0, 0.02);
        Painter *p = painter_at(net, &f, 2);
        for (int i = 0; i < MAP_COUNT; i++) {
            Plane *plane = painter_paint(p, (MapId)i);
            for (gsize j = 0; j < (gsize)plane->width * plane->height * plane->channels; j++)
                g_assert_true(isfinite(plane->px[j]));
            g_assert_cmpfloat(plane->high, >, plane->low);
            plane_free(plane);
        }
        painter_free(p);
        network_free(net);
    }
}

static void test_frame(void)
{
    Box2 box = {-30.0, 0.0, 10.0, 100.0};
    Frame s = frame_fit(box, 500, true, 0.02), b = frame_fit(box, 500, false, 0.02);
    g_assert_cmpuint(s.width, ==, 500);
    g_assert_cmpuint(s.height, ==, 500);
    g_assert_cmpuint(b.width, ==, 212);
    g_assert_cmpuint(b.height, ==, 500);
    g_assert_cmpfloat(fabs(s.scale - 4.8), <, 1e-12);
    g_assert_cmpfloat(fabs(s.corner.x + 250.0 / 4.8 + 10.0), <, 1e-9);
    g_assert_cmpfloat(fabs((s.corner.y - 100.0) * s.scale - 10.0), <, 1e-9);
    g_assert_cmpfloat(fabs((box.x0 - b.corner.x) * b.scale - 10.0), <, 1e-9);
    Frame none = frame_fit(box_empty(), 16, false, 0.0);
    g_assert_cmpuint(none.width, ==, 16);
}

static void test_infos(void)
{
    for (int i = 0; i < MAP_COUNT; i++) {
        const MapInfo *info = paint_map_info((MapId)i);
        g_assert_cmpint(paint_map_find(info->name), ==, i);
        g_assert_nonnull(info->doc);
    }
    g_assert_cmpint(paint_map_find("basecolor"), ==, -1);
    float c[3];
    paint_colour(0xff8000, c);
    g_assert_cmpfloat(c[0], ==, 1.0f);
    g_assert_cmpfloat(fabs((double)c[1] - 0.21586050011389926), <, 1e-7);
    g_assert_cmpfloat(c[2], ==, 0.0f);
}

/* ---- cutting ---- */

/* Convex polygons, cut again and again: what union_cut and ring_cut_known leave is what ring_clip leaves, to the last bit, also where the line
 * runs along a side or through a corner. */
static void test_cut(void)
{
    uint64_t c = 7;
    Rings a = {0}, b = {0}, spare = {0};
    Circle *circle = circle_new();
    Union u;
    union_init(&u, circle);
    for (int polygon = 0; polygon < 20000; polygon++) {
        static const Vec2 pixel[4] = {{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}};
        rings_reset(u.ping);
        rings_copy(u.ping, pixel, 4);
        rings_reset(&a);
        rings_copy(&a, pixel, 4);
        for (int cut = 0; cut < 40 && a.n > 0; cut++) {
            Vec2 normal = circle->dir[(uint32_t)(uniform(&c) * CIRCLE)];
            double bound = vec_dot(vec2(uniform(&c), uniform(&c)), normal) + 0.4 * uniform(&c);
            if (cut % 5 == 4) { /* through a corner, but for rounding */
                bound = vec_dot(a.v[(uint32_t)(uniform(&c) * a.n_v)], normal);
            } else if (cut % 5 == 3) { /* along a side, but for rounding */
                Vec2 side = vec_sub(a.v[1], a.v[0]);
                normal = vec2(side.y, -side.x);
                bound = vec_dot(a.v[0], normal) + 1e-10 * (uniform(&c) - 0.5);
            }
            rings_reset(&b);
            ring_clip(a.v, a.n_v, normal, bound, &b);
            spare = a;
            a = b;
            b = spare;
            g_assert_true(union_cut(&u, normal, bound) == (a.n > 0));
            g_assert_cmpuint(u.ping->n_v, ==, a.n_v);
            g_assert_true(memcmp(u.ping->v, a.v, a.n_v * sizeof *a.v) == 0);
        }
    }
    rings_clear(&a);
    rings_clear(&b);
    union_clear(&u);
    g_free(circle);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/paint/capsule", test_capsule);
    g_test_add_func("/paint/strokes", test_strokes);
    g_test_add_func("/paint/strokes-together", test_strokes_together);
    g_test_add_func("/paint/coverage/samples", test_coverage);
    g_test_add_func("/paint/coverage/knots", test_knots);
    g_test_add_func("/paint/coverage/bend", test_bend);
    g_test_add_func("/paint/coverage/clip", test_clip);
    g_test_add_func("/paint/coverage/cut", test_cut);
    g_test_add_func("/paint/base", test_base);
    g_test_add_func("/paint/bulb", test_bulb);
    g_test_add_func("/paint/coverage/capsule", test_capsule_area);
    g_test_add_func("/paint/coverage/thin", test_thin_vein);
    g_test_add_func("/paint/coverage/sizes", test_area_over_sizes);
    g_test_add_func("/paint/opacity", test_opacity);
    g_test_add_func("/paint/padding", test_padding);
    g_test_add_func("/paint/padding/step", test_padding_step);
    g_test_add_func("/paint/padding/scale", test_padding_scale);
    g_test_add_func("/paint/nearest", test_nearest);
    g_test_add_func("/paint/nearest-where", test_nearest_where);
    g_test_add_func("/paint/distance", test_distance);
    g_test_add_func("/paint/labels/thin", test_thin_labels);
    g_test_add_func("/paint/labels/priority", test_label_priority);
    g_test_add_func("/paint/normals", test_normals);
    g_test_add_func("/paint/normals/heights", test_normals_of_heights);
    g_test_add_func("/paint/merge", test_merge);
    g_test_add_func("/paint/edge-colour", test_edge_colour);
    g_test_add_func("/paint/small-relief", test_small_relief);
    g_test_add_func("/paint/stout", test_stout);
    g_test_add_func("/paint/strength", test_strength);
    g_test_add_func("/paint/colours", test_colours);
    g_test_add_func("/paint/band", test_band);
    g_test_add_func("/paint/threads", test_threads);
    g_test_add_func("/paint/bands", test_bands);
    g_test_add_func("/paint/noise-rows", test_noise_rows);
    g_test_add_func("/paint/degenerate", test_degenerate);
    g_test_add_func("/paint/frame", test_frame);
    g_test_add_func("/paint/infos", test_infos);
    return g_test_run();
}
