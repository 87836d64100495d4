/* Leaves of the models painted and captured again: the outline is that of the leaf, tips and teeth included. */
#include <glib.h>
#include <math.h>

#include "geom/dtrig.h"
#include "image/paint.h"
#include "lib/leaf.h"
#include "read_back.h"
#include "scan/profile.h"

typedef struct {
    const char *model;
    uint32_t pixels;
    double angle; /* degrees, anticlockwise */
    double most;  /* pixels between the outlines */
} Round;

/* The cherry's base is blunt, and its midvein, which is broad there, nearly as pale as the paper. Grapes are left out: their teeth have hooks of two pixels. */
static const Round rounds[] = {
    {"poplar", 500, 0.0, 1.0},        {"poplar", 900, 33.0, 1.0},         {"poplar", 1800, 71.0, 1.0}, {"toothed", 900, 0.0, 1.0},
    {"toothed", 900, 20.0, 1.0},      {"toothed", 1800, 45.0, 1.0},       {"cherry", 900, 7.0, 1.4},   {"sweetgum", 900, 0.0, 1.0},
    {"sweetgum", 1400, 11.0, 1.0},    {"alchemilla", 1400, 50.0, 1.0},    {"ginkgo", 900, 3.0, 1.0},   {"trillium", 900, 60.0, 1.0},
    {"orchid", 900, 25.0, 1.0},       {"reticulate", 900, 25.0, 1.0},     {"tertiary", 900, 14.0, 1.0}, {"slow-marginal", 900, 0.0, 1.0},
    {"slow-marginal", 900, 38.0, 1.0}, {"developmental", 900, 38.0, 1.0}, {"kill-distance", 900, 38.0, 1.0},
};

/* A few veins in its full-grown blade: it is the margin that counts. */
static VenLeaf *grown(const Round *r)
{
    GError *error = NULL;
    char *file = g_strconcat(r->model, ".ini", NULL), *path = g_test_build_filename(G_TEST_DIST, "..", "..", "params", file, NULL);
    VenParams *p = ven_params_load(path, &error);
    g_assert_no_error(error);
    static const char *const plain[][2] = {{"growth.kind", "none"},     {"growth.initial_length", "200"}, {"sources.placement", "darts"},
                                           {"sources.density", "0.001"}, {"sources.duration", "run"},      {"veins.pattern", "open"}};
    for (guint k = 0; k < G_N_ELEMENTS(plain); k++)
        ven_params_set(p, plain[k][0], plain[k][1], &error);
    g_assert_no_error(error);
    VenLeaf *leaf = ven_grow(p, 1, NULL, &error);
    g_assert_no_error(error);
    ven_params_free(p);
    g_free(file);
    g_free(path);
    return leaf;
}

static Vec2 *turned(const Vec2 *v, uint32_t n, double angle)
{
    double s, c;
    dtrig_sin_cos(angle * DTRIG_PI / 180.0, &s, &c);
    Vec2 *out = g_new(Vec2, n);
    for (uint32_t i = 0; i < n; i++)
        out[i] = vec2(c * v[i].x - s * v[i].y, s * v[i].x + c * v[i].y);
    return out;
}

/* The base colour on white, through a file. */
static Scan *painted(const Network *net, const Frame *frame)
{
    PaintStyle style = paint_style_default();
    style.padding = 4;
    Painter *painter = painter_new(net, frame, &style);
    Plane *colour = painter_paint(painter, MAP_BASE_COLOR), *opacity = painter_paint(painter, MAP_OPACITY);
    for (gsize i = 0; i < (gsize)colour->width * colour->height; i++)
        for (int c = 0; c < 3; c++)
            colour->px[3 * i + c] = colour->px[3 * i + c] * opacity->px[i] + (1.0f - opacity->px[i]);
    Scan *s = read_back(colour);
    plane_free(colour);
    plane_free(opacity);
    painter_free(painter);
    return s;
}

/* How far points of one outline, two a pixel, lie from the other. */
static double farthest(const Polygon *from, const Polygon *to, Vec2 *where)
{
    double far = 0.0;
    for (uint32_t i = 0; i < from->n; i++) {
        Vec2 a = from->v[i], b = from->v[i + 1 < from->n ? i + 1 : 0];
        uint32_t n = (uint32_t)(2.0 * vec_dist(a, b)) + 1;
        for (uint32_t k = 0; k < n; k++) {
            Vec2 q = vec_lerp(a, b, (double)k / n);
            double d = fabs(polygon_depth(to, q));
            if (d > far) {
                far = d;
                *where = q;
            }
        }
    }
    return far;
}

static void test_round(gconstpointer user)
{
    const Round *r = user;
    GError *error = NULL;
    VenLeaf *leaf = grown(r);
    Network net = *leaf->net;
    net.node = turned(net.node, net.n_nodes, r->angle);
    Vec2 *v = turned(net.margin->v, net.margin->n, r->angle);
    net.margin = polygon_new(v, leaf->net->margin->n);
    Frame frame = frame_fit(net.margin->box, r->pixels, true, 0.08);
    Scan *s = painted(&net, &frame);
    for (uint32_t i = 0; i < net.margin->n; i++)
        v[i] = vec2((v[i].x - frame.corner.x) * frame.scale, frame.height - (frame.corner.y - v[i].y) * frame.scale);
    Polygon *truth = polygon_new(v, net.margin->n);
    ProfileDef def = profile_def_default();
    def.tolerance = 0.3;
    GPtrArray *all = profile_capture(s, &def, NULL, &error);
    g_assert_no_error(error);
    const Profile *p = all->pdata[0];
    Vec2 a = {0}, b = {0};
    double there = farthest(p->outline, truth, &a), back = farthest(truth, p->outline, &b);
    g_test_message("%s, %u pixels, %g degrees: outline within %.2f of the margin (at %.1f,%.1f), margin within %.2f of it (at %.1f,%.1f)", r->model, r->pixels,
                   r->angle, there, a.x, s->height - a.y, back, b.x, s->height - b.y);
    uint32_t i, j;
    g_assert_false(polygon_crossing(p->outline, &i, &j));
    g_assert_cmpfloat(there, <, r->most);
    g_assert_cmpfloat(back, <, r->most);
    polygon_free(truth);
    polygon_free(net.margin);
    g_free(net.node);
    g_free(v);
    g_ptr_array_free(all, TRUE);
    scan_free(s);
    ven_leaf_free(leaf);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    for (guint i = 0; i < G_N_ELEMENTS(rounds); i++) {
        char *path = g_strdup_printf("/capture/round/%s-%u-%g", rounds[i].model, rounds[i].pixels, rounds[i].angle);
        g_test_add_data_func(path, &rounds[i], test_round);
        g_free(path);
    }
    return g_test_run();
}
