/* The line that an L-system's midvein follows: bent blades whose middle is known, midribs, and what straight blades must keep. */
#include <glib.h>
#include <string.h>

#include "geom/random.h"
#include "sim/bare.h"
#include "sim/lsystem.h"
#include "sim/lturtle_axis.h"

#define CLOSE(a, b, e) g_assert_cmpfloat_with_epsilon(a, b, e)

static const double unit = 300.0;
static const LAxis straight = {.curved = false};

/* --- blades with a known middle --- */

/* x = y (1 - y) (4 bow + s (y - 1/2)): off by `bow` half way up. */
typedef struct {
    double bow, s;
} Curve;

static double curve_x(Curve c, double y) { return y * (1.0 - y) * (4.0 * c.bow + c.s * (y - 0.5)); }

static double curve_slope(Curve c, double y)
{
    return (1.0 - 2.0 * y) * (4.0 * c.bow + c.s * (y - 0.5)) + y * (1.0 - y) * c.s;
}

/* Widest, `wide` on each side, below the middle; teeth that lean to the tip are part of it, no two alike. */
static double half_width(double y, double wide, double teeth, int side)
{
    double random[2], tooth = 24.0 * y - floor(24.0 * y);
    random_pair(3, side > 0, (uint32_t)(24.0 * y), 0, random);
    return wide * 2.6 * sqrt(y) * (1.0 - y) * (1.0 - teeth * random[0] * (1.0 - tooth));
}

/* A straight blade laid along the curve, square to it. */
static Polygon *bent(Curve c, double wide, double teeth)
{
    enum { HALF = 480 };
    Vec2 v[2 * HALF];
    for (int i = 0; i < 2 * HALF; i++) {
        int side = i <= HALF ? 1 : -1;
        double y = (double)(i <= HALF ? i : 2 * HALF - i) / HALF, slope = curve_slope(c, y), norm = sqrt(1.0 + slope * slope);
        double w = side * half_width(MIN(y, 1.0 - 1e-12), wide, teeth, side);
        v[i] = i == HALF ? vec2(0.0, 1.0) : vec2(curve_x(c, y) + w / norm, y - w * slope / norm);
    }
    return polygon_new(v, G_N_ELEMENTS(v));
}

static double off(const LAxis *a, Curve c)
{
    double most = 0.0;
    for (int i = 0; i <= 500; i++)
        most = MAX(most, fabs(laxis_x(a, i / 500.0) - curve_x(c, i / 500.0)));
    return most;
}

static const Curve curve[] = {{0.03, 0.0}, {-0.03, 0.0}, {0.06, 0.0}, {-0.1, 0.0}, {0.15, 0.0}, {0.0, 0.5}, {0.05, -0.4}, {-0.08, 0.3}};

static void test_middle(void)
{
    for (uint32_t i = 0; i < G_N_ELEMENTS(curve); i++)
        for (int k = 0; k < 3; k++) {
            LAxis a;
            Polygon *leaf = bent(curve[i], k == 2 ? 0.1 : 0.2, k == 1 ? 0.25 : 0.0);
            laxis_of_blade(leaf, &a);
            g_assert_true(a.curved);
            g_test_message("bow %g, %g, %s: off by %.5f", curve[i].bow, curve[i].s, k == 2 ? "narrow" : k ? "toothed" : "smooth", off(&a, curve[i]));
            g_assert_cmpfloat(off(&a, curve[i]), <, k == 1 ? 0.006 : 0.003);
            polygon_free(leaf);
        }
}

/* The line between samples is as smooth as it says, straight beyond its ends, and as long as it is. */
static void test_line(void)
{
    LAxis a;
    Polygon *leaf = bent((Curve){0.1, 0.3}, 0.15, 0.0);
    laxis_of_blade(leaf, &a);
    double length = 0.0;
    for (int i = 0; i < 2000; i++) {
        double y = -0.25 + 1.5 * i / 2000, h = 1e-5;
        double slope = (laxis_x(&a, y + h) - laxis_x(&a, y - h)) / (2.0 * h);
        Vec2 way = laxis_way(&a, y);
        CLOSE(way.x / way.y, slope, 2e-4);
        CLOSE(vec_norm2(way), 1.0, 1e-12);
    }
    for (int i = 0; i < 10000; i++)
        length += vec_dist(vec2(laxis_x(&a, i / 10000.0), i / 10000.0), vec2(laxis_x(&a, (i + 1) / 10000.0), (i + 1) / 10000.0));
    CLOSE(a.length, length, 1e-4);
    CLOSE(laxis_x(&a, -0.5), -0.5 * a.slope[0], 1e-12);
    CLOSE(laxis_x(&a, 1.5), a.x[LAXIS_PARTS] + 0.5 * a.slope[LAXIS_PARTS], 1e-12);
    polygon_free(leaf);
    g_assert_true(laxis_x(&straight, 0.3) == 0.0 && laxis_way(&straight, 0.3).x == 0.0 && laxis_way(&straight, 0.3).y == 1.0);
}

/* Little enough, nothing bends; nor where no line is a middle. */
static void test_straight(void)
{
    static const Curve little[] = {{0.0, 0.0}, {0.006, 0.0}, {-0.006, 0.01}};
    for (uint32_t i = 0; i < G_N_ELEMENTS(little); i++) {
        LAxis a;
        Polygon *leaf = bent(little[i], 0.2, 0.0);
        laxis_of_blade(leaf, &a);
        g_assert_false(a.curved);
        polygon_free(leaf);
    }
    const Vec2 odd[][4] = {{{0, 0}, {1e-9, 0.5}, {0, 1}, {-1e-9, 0.5}}, {{0, 0}, {5, 0.001}, {0, 1}, {5, 0.002}}, {{0, 0}, {1, -3}, {0, 1}, {-3, 4}}};
    for (uint32_t i = 0; i < G_N_ELEMENTS(odd); i++) {
        LAxis a;
        Polygon *leaf = polygon_new(odd[i], 4);
        laxis_of_blade(leaf, &a);
        for (int k = -10; k <= 20; k++)
            g_assert_true(isfinite(laxis_x(&a, 0.1 * k)));
        polygon_free(leaf);
    }
}

/* --- midribs --- */

static void test_midrib(void)
{
    enum { N = 150 };
    const Curve c = {0.06, 0.2};
    Vec2 p[N], turned[N];
    LAxis a, b;
    for (uint32_t i = 0; i < N; i++) { /* found ones go from pixel to pixel, and end before the tip */
        double y = 0.02 + 0.9 * i / (N - 1), u[2];
        random_pair(4, 0, i, 0, u);
        p[i] = turned[N - 1 - i] = vec2(curve_x(c, y) + 0.002 * (u[0] - 0.5), y);
    }
    g_assert_true(laxis_of_midrib(p, N, &a) && laxis_of_midrib(turned, N, &b));
    g_assert_true(a.curved && memcmp(a.x, b.x, sizeof a.x) == 0);
    double most = 0.0;
    for (double y = 0.0; y < 0.9; y += 0.003)
        most = MAX(most, fabs(laxis_x(&a, y) - curve_x(c, y)));
    g_test_message("midrib off by %.5f", most);
    g_assert_cmpfloat(most, <, 0.003);
    CLOSE(laxis_x(&a, 1.0), 0.0, 1e-12);

    g_assert_false(laxis_of_midrib(p, 0, &b));
    g_assert_false(laxis_of_midrib(p, 1, &b));
    g_assert_false(laxis_of_midrib(p, N / 2, &b));         /* ends half way up */
    g_assert_false(laxis_of_midrib(p + N / 3, N / 2, &b)); /* begins a third of the way up */
    const Vec2 back[] = {{0, 0}, {0.1, 0.6}, {0.1, 0.4}, {0, 0.9}}, flat[] = {{0, 0}, {0, 0.4}, {0.3, 0.41}, {0.3, 0.8}, {0, 0.81}, {0, 1}};
    g_assert_false(laxis_of_midrib(back, G_N_ELEMENTS(back), &b));
    g_assert_false(laxis_of_midrib(flat, G_N_ELEMENTS(flat), &b));
}

/* --- drawn in bent blades --- */

static Network *draw(const LSystemDef *def, const Polygon *leaf)
{
    GError *error = NULL;
    Network *net = lsystem_network(def, leaf, unit, NULL, &error);
    g_assert_no_error(error);
    return net;
}

/* The midvein, and its laterals on either side: how many reach the margin, and by how much they leave it. */
typedef struct {
    double off;    /* the midvein's farthest from the middle, leaf lengths */
    double top;    /* its end */
    uint32_t n[2]; /* left, right */
    double least[2], most[2], mean[2]; /* degrees between the midvein upwards and a lateral, at its beginning */
} Drawn;

static double degrees_between(Vec2 a, Vec2 b) { return fabs(atan2(vec_cross(a, b), vec_dot(a, b))) * 180.0 / G_PI; }

static Drawn look(const Network *net, Curve c)
{
    Drawn d = {.least = {180.0, 180.0}};
    bool *on = g_new0(bool, net->n_nodes);
    Vec2 *up = g_new0(Vec2, net->n_nodes);
    bool *seen = g_new0(bool, net->n_veins);
    for (uint32_t e = 0; e < net->n_edges; e++)
        if (net->order[e] == 1) {
            Vec2 a = net->node[net->tail[e]], b = net->node[net->head[e]];
            on[net->tail[e]] = on[net->head[e]] = true;
            up[net->tail[e]] = vec_sub(b, a);
            d.off = MAX(d.off, fabs(b.x / unit - curve_x(c, b.y / unit)));
            d.top = MAX(d.top, b.y / unit);
        }
    for (uint32_t e = 0; e < net->n_edges; e++) {
        Vec2 way = vec_sub(net->node[net->head[e]], net->node[net->tail[e]]), along = up[net->tail[e]];
        if (net->order[e] != 2 || !on[net->tail[e]] || seen[net->vein[e]] || net->tail[e] == 0)
            continue;
        seen[net->vein[e]] = true;
        int side = vec_cross(along, way) < 0.0;
        double angle = degrees_between(along, way);
        d.n[side]++;
        d.least[side] = MIN(d.least[side], angle);
        d.most[side] = MAX(d.most[side], angle);
        d.mean[side] += angle;
    }
    for (int side = 0; side < 2; side++)
        d.mean[side] /= MAX(d.n[side], 1);
    g_free(on);
    g_free(up);
    g_free(seen);
    return d;
}

/* Every lateral ends within a segment of the margin. */
static void check_reach(const Network *net)
{
    uint32_t *end = g_new(uint32_t, net->n_veins);
    uint8_t *order = g_new0(uint8_t, net->n_veins);
    for (uint32_t e = 0; e < net->n_edges; e++) {
        g_assert_true(polygon_contains(net->margin, net->node[net->head[e]]));
        end[net->vein[e]] = net->head[e];
        order[net->vein[e]] = net->order[e];
    }
    for (uint32_t v = 0; v < net->n_veins; v++)
        if (order[v] == 2)
            g_assert_cmpfloat(polygon_depth(net->margin, net->node[end[v]]), <, 1.0);
    g_free(end);
    g_free(order);
}

static double cross(Vec2 a, Vec2 b, Vec2 c) { return vec_cross(vec_sub(b, a), vec_sub(c, a)); }

static void check_apart(const Network *net)
{
    for (uint32_t e = 0; e < net->n_edges; e++)
        for (uint32_t f = 0; f < e && net->order[e] <= 2; f++) {
            Vec2 a = net->node[net->tail[e]], b = net->node[net->head[e]], p = net->node[net->tail[f]], q = net->node[net->head[f]];
            if (net->order[f] > 2 || vec_dist2(a, p) > 4.0 || net->tail[f] == net->tail[e] || net->head[f] == net->tail[e])
                continue;
            g_assert_false(cross(a, b, p) * cross(a, b, q) < 0.0 && cross(p, q, a) * cross(p, q, b) < 0.0);
        }
}

static void test_drawn(void)
{
    LSystemDef def = lsystem_def_default();
    Polygon *even = bent((Curve){0.0, 0.0}, 0.2, 0.0);
    Network *first = draw(&def, even);
    Drawn want = look(first, (Curve){0.0, 0.0});
    double bare = bare_disc(first, NULL);
    g_test_message("straight: %u and %u laterals, %.2f and %.2f°, bare %.3f", want.n[0], want.n[1], want.mean[0], want.mean[1], bare);
    for (uint32_t i = 0; i < G_N_ELEMENTS(curve); i++) {
        Polygon *leaf = bent(curve[i], 0.2, 0.0);
        Network *net = draw(&def, leaf);
        Drawn got = look(net, curve[i]);
        g_test_message("bow %g, %g: midvein off by %.5f, ends at %.3f; %u and %u laterals, %.2f and %.2f°, bare %.3f", curve[i].bow, curve[i].s, got.off, got.top,
                       got.n[0], got.n[1], got.mean[0], got.mean[1], bare_disc(net, NULL));
        g_assert_cmpfloat(got.off, <, 0.004);
        g_assert_cmpfloat(got.top, >, 0.93);
        for (int side = 0; side < 2; side++) {
            g_assert_cmpuint(got.n[side], ==, want.n[side]);
            CLOSE(got.mean[side], want.mean[side], 1.0);
            g_assert_cmpfloat(got.least[side], >, want.least[side] - 2.0);
            g_assert_cmpfloat(got.most[side], <, want.most[side] + 2.0);
        }
        check_reach(net);
        check_apart(net);
        g_assert_cmpfloat(bare_disc(net, NULL), <, 1.35 * bare);
        network_free(net);
        polygon_free(leaf);
    }
    network_free(first);
    polygon_free(even);
}

/* Mirrored blades have mirrored veins. */
static void test_mirrored(void)
{
    LSystemDef def = lsystem_def_default();
    for (uint32_t i = 0; i < G_N_ELEMENTS(curve); i++) {
        const Curve other = {-curve[i].bow, -curve[i].s};
        Polygon *leaf = bent(curve[i], 0.15, 0.0), *mirror = bent(other, 0.15, 0.0);
        Network *a = draw(&def, leaf), *b = draw(&def, mirror);
        Drawn left = look(a, curve[i]), right = look(b, other);
        for (int side = 0; side < 2; side++) {
            g_assert_cmpuint(left.n[side], ==, right.n[!side]);
            CLOSE(left.mean[side], right.mean[!side], 1e-3);
        }
        CLOSE(left.off, right.off, 1e-6);
        CLOSE(bare_disc(a, NULL), bare_disc(b, NULL), 0.011);
        network_free(a);
        network_free(b);
        polygon_free(leaf);
        polygon_free(mirror);
    }
}

static bool same(const Network *a, const Network *b)
{
    return a->n_nodes == b->n_nodes && a->n_edges == b->n_edges && memcmp(a->node, b->node, a->n_nodes * sizeof *a->node) == 0 &&
           memcmp(a->tail, b->tail, a->n_edges * sizeof *a->tail) == 0 && memcmp(a->width, b->width, a->n_edges * sizeof *a->width) == 0;
}

/* Bit for bit what is drawn where nothing bends; and a given midrib goes before the middle. */
static void test_given(void)
{
    for (int k = 0; k < 2; k++) {
        LSystemDef def = k ? lsystem_def_palmate(16) : lsystem_def_default();
        Polygon *leaf = bent((Curve){0.004, 0.0}, 0.25, 0.1);
        Network *own = draw(&def, leaf);
        def.axis = &straight;
        Network *told = draw(&def, leaf);
        g_assert_true(same(own, told));
        network_free(own);
        network_free(told);

        const Curve c = {0.04, 0.0};
        LAxis a;
        Polygon *bow = bent(c, 0.2, 0.0);
        laxis_of_blade(bow, &a);
        polygon_free(bow);
        def.axis = &a;
        Network *led = draw(&def, leaf);
        double most = 0.0, highest = 0.0;
        uint32_t midvein = 0;
        for (uint32_t e = 0; e < led->n_edges; e++)
            if (led->order[e] == 1 && led->node[led->head[e]].y > highest) {
                highest = led->node[led->head[e]].y;
                midvein = led->vein[e];
            }
        for (uint32_t e = 0; e < led->n_edges; e++)
            if (led->vein[e] == midvein)
                most = MAX(most, fabs(led->node[led->head[e]].x / unit - curve_x(c, led->node[led->head[e]].y / unit)));
        g_test_message("%s: off the given midrib by %.5f", k ? "palmate" : "pinnate", most);
        g_assert_cmpfloat(most, <, 0.004);
        check_apart(led);
        network_free(led);
        polygon_free(leaf);
    }
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/lsystem_axis/middle", test_middle);
    g_test_add_func("/lsystem_axis/line", test_line);
    g_test_add_func("/lsystem_axis/straight", test_straight);
    g_test_add_func("/lsystem_axis/midrib", test_midrib);
    g_test_add_func("/lsystem_axis/drawn", test_drawn);
    g_test_add_func("/lsystem_axis/mirrored", test_mirrored);
    g_test_add_func("/lsystem_axis/given", test_given);
    return g_test_run();
}
