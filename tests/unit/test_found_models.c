/* Veins found again in pictures of grown leaves whose veins are known: models of the paper at reduced size, as specimens, turned. With -m slow all of them,
 * with --verbose the table of params/scans/README.md. */
#include <glib.h>
#include <math.h>

#include "geom/dtrig.h"
#include "image/specimen.h"
#include "lib/leaf.h"
#include "lib/settings.h"
#include "lib/writer.h"
#include "read_back.h"
#include "scan/found.h"
#include "scan/profile.h"

enum { PIXELS = 1200 };
static const double angle = 37.0;  /* degrees */
static const double near = 0.006;  /* of the leaf's length: lines that agree */
static const double visible = 1.5; /* pixels: veins as wide as that can be seen */

typedef struct {
    const char *name, *length; /* growth.final_length, or initial_length where that is not grown from; NULL: as it is */
    bool initial, slow;
    double precision, recall, seen; /* a bit under what is measured; seen: the recall of what is visible */
    double base;                    /* how far off, leaf lengths */
    uint32_t primaries, most;       /* how many there must be */
} Model;

static const Model models[] = {
    {"kill-distance", "900", false, true, 0.59, 0.67, 0.84, 0.03, 1, 6},
    {"dart-density", "900", false, true, 0.59, 0.70, 0.88, 0.03, 1, 6},
    {"slow-marginal", "1600", false, true, 0.85, 0.89, 0.93, 0.03, 1, 1},
    {"ginkgo", "1800", false, false, 0.68, 0.90, 0.94, 0.03, 5, 15},
    {"alchemilla", "3600", false, true, 0.89, 0.77, 0.92, 0.05, 7, 25},
    {"sweetgum", "1400", false, false, 0.90, 0.86, 0.95, 0.03, 5, 5},
    {"toothed", "1000", false, true, 0.74, 0.70, 0.92, 0.03, 1, 8},
    {"tertiary", "800", false, true, 0.80, 0.58, 0.90, 0.03, 1, 12},
    {"orchid", "2600", true, false, 0.91, 0.77, 0.92, 0.03, 5, 15},
    {"reticulate", "1800", false, true, 0.70, 0.70, 0.94, 0.03, 1, 3},
    {"cherry", "1000", false, false, 0.88, 0.94, 0.94, 0.03, 1, 1},
    {"grass", "5200", true, false, 0.95, 0.78, 0.82, 0.03, 7, 15},
    {"poplar", "1500", false, false, 0.71, 0.68, 0.93, 0.05, 1, 4},
    {"developmental", NULL, false, true, 0.60, 0.85, 0.90, 0.03, 1, 2},
    {"trillium", "1800", true, true, 0.80, 0.70, 0.90, 0.03, 1, 7},
};

static VenLeaf *grown(const Model *m)
{
    GError *error = NULL;
    char *file = g_strconcat(m->name, ".ini", NULL), *path = g_test_build_filename(G_TEST_DIST, "..", "..", "params", file, NULL);
    VenParams *p = ven_params_load(path, &error);
    g_assert_no_error(error);
    if (m->length)
        ven_params_set(p, m->initial ? "growth.initial_length" : "growth.final_length", m->length, &error);
    if (g_str_equal(m->name, "grass"))
        ven_params_set(p, "veins.seed_row", "11", &error);
    g_assert_no_error(error);
    VenLeaf *leaf = ven_grow(p, 1, NULL, &error);
    g_assert_no_error(error);
    ven_params_free(p);
    g_free(file);
    g_free(path);
    return leaf;
}

/* As a scanner sees it, through a file as any scan. */
static Scan *picture(const VenLeaf *leaf, const Frame *frame)
{
    Writer w;
    writer_init(&w, leaf, ".", "");
    SpecimenDef def = settings_specimen(leaf->params, leaf->seed);
    Painter *painter = writer_painter(&w, frame);
    Specimen *specimen = specimen_new(painter, &def);
    Plane *plane = specimen_paint(specimen);
    Scan *s = read_back(plane);
    plane_free(plane);
    specimen_free(specimen);
    painter_free(painter);
    writer_clear(&w);
    return s;
}

/* Turned about the middle, clockwise as seen; corners go on as the border is. */
static Scan *turned(const Scan *in, double s, double c)
{
    Scan *out = scan_new(in->width, in->height, in->channels, 8);
    for (uint32_t y = 0; y < out->height; y++)
        for (uint32_t x = 0; x < out->width; x++) {
            double dx = x + 0.5 - 0.5 * out->width, dy = y + 0.5 - 0.5 * out->height;
            double u = CLAMP(0.5 * in->width + c * dx + s * dy - 0.5, 0.0, in->width - 1.001);
            double v = CLAMP(0.5 * in->height - s * dx + c * dy - 0.5, 0.0, in->height - 1.001), fu = u - floor(u), fv = v - floor(v);
            for (uint32_t k = 0; k < in->channels; k++) {
                uint32_t i = (uint32_t)u, j = (uint32_t)v;
                double above = scan_sample(in, i, j, k) * (1.0 - fu) + scan_sample(in, i + 1, j, k) * fu;
                double below = scan_sample(in, i, j + 1, k) * (1.0 - fu) + scan_sample(in, i + 1, j + 1, k) * fu;
                ((uint8_t *)out->px)[((gsize)y * out->width + x) * in->channels + k] = (uint8_t)(above * (1.0 - fv) + below * fv + 0.5);
            }
        }
    return out;
}

/* Where a point of the leaf lies in the turned picture; y up. */
static Vec2 place(const Frame *f, const Scan *s, Vec2 q, double sine, double cosine)
{
    double dx = (q.x - f->corner.x) * f->scale - 0.5 * s->width, dy = (f->corner.y - q.y) * f->scale - 0.5 * s->height;
    return vec2(0.5 * s->width + cosine * dx - sine * dy, 0.5 * s->height - sine * dx - cosine * dy);
}

static void check_model(gconstpointer data)
{
    const Model *m = data;
    if (m->slow && !g_test_slow()) {
        g_test_skip("slow");
        return;
    }
    GError *error = NULL;
    double sine, cosine;
    dtrig_sin_cos(angle * DTRIG_PI / 180.0, &sine, &cosine);
    VenLeaf *leaf = grown(m);
    const Network *net = leaf->net;
    Frame frame = frame_fit(net->margin->box, PIXELS, true, 0.25);
    Scan *straight = picture(leaf, &frame), *s = turned(straight, sine, cosine);
    ProfileDef def = profile_def_default();
    GPtrArray *all = profile_capture(s, &def, NULL, &error);
    g_assert_no_error(error);
    const Profile *p = all->pdata[0];
    double length = leaf->length * frame.scale, whole = 0.0, seen = 0.0;
    Drawing *truth = drawing_new(), *wide = drawing_new(), *any = drawing_new();
    for (uint32_t e = 0; e < net->n_edges; e++) {
        Vec2 q[2] = {place(&frame, s, net->node[net->tail[e]], sine, cosine), place(&frame, s, net->node[net->head[e]], sine, cosine)};
        bool shows = net->width[e] * frame.scale >= visible;
        drawing_add(any, q, NULL, 2, 1, NULL);
        if (net->order[e] > 2)
            continue;
        drawing_add(truth, q, NULL, 2, 1, NULL);
        whole += vec_dist(q[0], q[1]);
        seen += shows ? vec_dist(q[0], q[1]) : 0.0;
        if (shows)
            drawing_add(wide, q, NULL, 2, 1, NULL);
    }
    FoundDef how = found_def_default();
    Drawing *d = found_veins(s, p->outline, p->base, p->tip, &how, &error);
    g_assert_no_error(error);
    uint32_t primaries = 0;
    for (uint32_t k = 0; k < d->n; k++)
        primaries += d->vein[k].order == 1;
    FoundScore score = found_score(d, truth, near * length);
    double recall = found_score(d, wide, near * length).recall, on_any = found_score(d, any, near * length).precision;
    double base = vec_dist(p->base, place(&frame, s, vec2(0, 0), sine, cosine)) / length;
    double tip = vec_dist(p->tip, place(&frame, s, vec2(0, leaf->length), sine, cosine)) / length;
    g_test_message("| %s | %u + %u | %.2f | %.2f | %.2f | %.0f %% | %.2f | %.3f |", m->name, primaries, d->n - primaries, score.precision, on_any, score.recall,
                   100.0 * seen / whole, recall, base);
    g_assert_cmpfloat(base, <, m->base);
    g_assert_cmpfloat(tip, <, 0.06);
    g_assert_cmpfloat(score.precision, >, m->precision);
    g_assert_cmpfloat(on_any, >, 0.9);
    g_assert_cmpfloat(score.recall, >, m->recall);
    g_assert_cmpfloat(recall, >, m->seen);
    g_assert_cmpuint(primaries, >=, m->primaries);
    g_assert_cmpuint(primaries, <=, m->most);
    drawing_free(d);
    drawing_free(any);
    drawing_free(truth);
    drawing_free(wide);
    g_ptr_array_free(all, TRUE);
    scan_free(s);
    scan_free(straight);
    ven_leaf_free(leaf);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    for (uint32_t k = 0; k < G_N_ELEMENTS(models); k++) {
        char *path = g_strconcat("/found/models/", models[k].name, NULL);
        g_test_add_data_func(path, &models[k], check_model);
        g_free(path);
    }
    return g_test_run();
}
