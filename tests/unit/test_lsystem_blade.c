/* L-systems that ask for the blade: lobes, how much they leave bare, both sides alike, and what they must not change. */
#include <glib.h>
#include <string.h>

#include "geom/outline.h"
#include "geom/random.h"
#include "lib/leaf.h"
#include "sim/bare.h"
#include "sim/lobes.h"
#include "sim/lsystem.h"

#define CLOSE(a, b, e) g_assert_cmpfloat_with_epsilon(a, b, e)

static const double unit = 300.0;

static char *in_params(const char *folder, const char *name)
{
    return g_build_filename(g_test_get_dir(G_TEST_DIST), "..", "..", "params", folder, name, NULL);
}

static Polygon *file_leaf(const char *name)
{
    OutlineDef def = outline_def_default();
    char *path = in_params("outlines", name);
    def.path = NULL;
    def.mirror = false;
    def.file = def.where = path;
    GError *error = NULL;
    Polygon *leaf = outline_new(&def, &error);
    g_assert_no_error(error);
    g_free(path);
    return leaf;
}

static Network *draw(const LSystemDef *def, const Polygon *leaf)
{
    GError *error = NULL;
    Network *net = lsystem_network(def, leaf, unit, NULL, &error);
    g_assert_no_error(error);
    return net;
}

static Network *draw_preset(bool palmate, const Polygon *leaf)
{
    LSystemDef def = palmate ? lsystem_def_palmate(16) : lsystem_def_pinnate(16);
    return draw(&def, leaf);
}

/* --- lobes --- */

static void test_lobes(void)
{
    static const struct {
        const char *file;
        uint32_t found;
    } want[] = {{"sweetgum.svg", 2}, {"ovate.svg", 0},  {"cherry.svg", 0}, {"poplar.svg", 0}, {"orchid.svg", 0}, {"reticulate.svg", 0},
                {"grass.svg", 0},    {"toothed.svg", 0}, {"slow.svg", 0},  {"ginkgo.svg", 0}, {"trillium.svg", 0}};
    for (uint32_t i = 0; i < G_N_ELEMENTS(want); i++) {
        Polygon *leaf = file_leaf(want[i].file);
        Lobes lobes;
        lobes_find(leaf, &lobes);
        if (lobes.found != want[i].found)
            g_error("%s has %u lobes a side", want[i].file, lobes.found);
        polygon_free(leaf);
    }
}

/* A star of n points whose way from (0, 0.05) to the margin is 0.35 + 0.6 |…|: tips, hub and sinuses are known. */
static Polygon *star(uint32_t points, double dent_from, double dent_to)
{
    GArray *v = g_array_new(FALSE, FALSE, sizeof(Vec2));
    Vec2 base = vec2(0.0, 0.0), hub = vec2(0.0, 0.05);
    g_array_append_val(v, base);
    for (int k = -1499; k <= 1499; k++) { /* tenths of a degree from the axis, left positive */
        double degrees = 0.1 * k, spread = 300.0 / points, off = fabs(remainder(degrees, spread)) / (0.5 * spread), sine, cosine;
        double way = (1.0 - 0.6 * off) * (k == 0 ? 0.95 : fabs(degrees) < 0.5 * spread ? 0.95 : 0.75);
        if (degrees > dent_from && degrees < dent_to)
            way = 0.05;
        sine = sin(degrees * G_PI / 180.0);
        cosine = cos(degrees * G_PI / 180.0);
        Vec2 at = vec2(hub.x - way * sine, hub.y + way * cosine);
        g_array_append_val(v, at);
    }
    Polygon *p = polygon_new((const Vec2 *)(gpointer)v->data, v->len);
    g_array_unref(v);
    return p;
}

static void test_star(void)
{
    Polygon *leaf = star(5, 0.0, 0.0);
    Lobes lobes;
    lobes_find(leaf, &lobes);
    g_assert_cmpuint(lobes.found, ==, 2);
    g_assert_cmpuint(lobes.n, ==, 5);
    g_assert_cmpuint(lobes.middle, ==, 2);
    g_assert_cmpfloat(lobes.hub.y, <=, 0.12);
    for (int i = 0; i < 5; i++) {
        double degrees = 60.0 * (2 - i), way = i == 2 ? 0.95 : 0.75;
        Vec2 tip = vec2(-way * sin(degrees * G_PI / 180.0), 0.05 + way * cos(degrees * G_PI / 180.0));
        CLOSE(vec_dist(lobes.lobe[i].tip, tip), 0.0, 0.02);
        g_assert_true(lobes.lobe[i].open_left == (i == 0) && lobes.lobe[i].open_right == (i == 4));
        if (i < 4) {
            double sinus = degrees - 30.0;
            Vec2 at = vec2(-0.3 * sin(sinus * G_PI / 180.0), 0.05 + 0.3 * cos(sinus * G_PI / 180.0)), way_there = vec_sub(at, lobes.hub);
            CLOSE(vec_cross(lobes.lobe[i].right, way_there) / sqrt(vec_norm2(way_there)), 0.0, 0.1);
        }
    }
    polygon_free(leaf);

    leaf = star(5, 29.0, 91.0); /* a lobe torn off: the others stay, and nothing is mirrored into the gap */
    lobes_find(leaf, &lobes);
    g_assert_cmpuint(lobes.middle, ==, 1);
    g_assert_cmpuint(lobes.n, ==, 4);
    polygon_free(leaf);
}

/* --- bare discs --- */

/* By trying every place of a fine grid. */
static double brute_disc(const Network *net)
{
    const Box2 *b = &net->margin->box;
    double best = 0.0, width = b->x1 - b->x0, pitch = width / 300.0;
    for (double y = b->y0; y < b->y1; y += pitch)
        for (double x = b->x0; x < b->x1; x += pitch) {
            double r = polygon_depth(net->margin, vec2(x, y));
            for (uint32_t i = 0; i < net->n_nodes && r > best; i++)
                r = MIN(r, vec_dist(net->node[i], vec2(x, y)));
            best = MAX(best, r);
        }
    return 2.0 * best / width;
}

static void test_bare(void)
{
    static const char *const file[] = {"sweetgum.svg", "poplar.svg", "grass.svg"};
    for (uint32_t k = 0; k < 30; k++) {
        Polygon *leaf = file_leaf(file[k % 3]);
        Network *net = network_new(1 + 3 * k, 0);
        net->margin = polygon_scaled(leaf, 100.0);
        const Box2 *b = &net->margin->box;
        for (uint32_t i = 0; i < net->n_nodes; i++) {
            double u[2];
            random_pair(5, 1, k, i, u);
            net->node[i] = vec2(b->x0 + u[0] * (b->x1 - b->x0), b->y0 + u[1] * (b->y1 - b->y0));
        }
        Vec2 centre;
        double got = bare_disc(net, &centre), want = brute_disc(net), r = 0.5 * got * (b->x1 - b->x0);
        g_assert_cmpfloat(got, >=, want - 0.0101);
        g_assert_cmpfloat(got, <=, want + 0.0101);
        CLOSE(polygon_depth(net->margin, centre) < r - 1e-9, 0, 0.1);
        for (uint32_t i = 0; i < net->n_nodes; i++)
            g_assert_cmpfloat(vec_dist(net->node[i], centre), >=, r - 1e-9);
        network_free(net);
        polygon_free(leaf);
    }
}

/* --- veins of the presets --- */

typedef struct {
    uint32_t primaries, laterals; /* of one side, but for the midvein */
    double angle;                 /* mean of its primaries' and the midvein's laterals' first directions, degrees from the axis */
} Half;

/* Veins of order 1 and 2 that begin left (or right) of the midvein's own, by where they end. The midvein is the primary that ends highest. */
static Half count_half(const Network *net, int side)
{
    Half half = {0};
    uint32_t *begin = g_new(uint32_t, net->n_veins), *end = g_new(uint32_t, net->n_veins), n = 0, midvein = 0;
    uint8_t *order = g_new0(uint8_t, net->n_veins);
    bool *on = g_new0(bool, net->n_nodes);
    double highest = -HUGE_VAL;
    for (uint32_t e = 0; e < net->n_edges; e++) {
        uint32_t v = net->vein[e];
        begin[v] = order[v] ? begin[v] : net->tail[e];
        end[v] = net->head[e];
        order[v] = net->order[e];
        if (net->order[e] == 1 && net->node[net->head[e]].y > highest) {
            highest = net->node[net->head[e]].y;
            midvein = v;
        }
    }
    for (uint32_t e = 0; e < net->n_edges; e++)
        if (net->vein[e] == midvein)
            on[net->tail[e]] = on[net->head[e]] = true;
    for (uint32_t v = 0; v < net->n_veins; v++) {
        Vec2 way = vec_sub(net->node[end[v]], net->node[begin[v]]);
        if (v == midvein || order[v] > 2 || side * net->node[end[v]].x >= -1e-6 || vec_norm2(way) < 1.0)
            continue;
        half.primaries += order[v] == 1;
        half.laterals += order[v] == 2;
        if (order[v] == 1 || on[begin[v]]) {
            half.angle += atan2(fabs(way.x), way.y) * 180.0 / G_PI;
            n++;
        }
    }
    half.angle /= MAX(n, 1);
    g_free(on);
    g_free(begin);
    g_free(end);
    g_free(order);
    return half;
}

static void check_halves(const char *name, const Network *net, uint32_t primaries, uint32_t laterals_apart, double degrees_apart)
{
    Half left = count_half(net, 1), right = count_half(net, -1);
    g_test_message("%s: bare %.3f; left %u primaries, %u laterals, %.1f°, right %u, %u, %.1f°", name, bare_disc(net, NULL), left.primaries,
                   left.laterals, left.angle, right.primaries, right.laterals, right.angle);
    g_assert_cmpuint(left.primaries, ==, primaries);
    g_assert_cmpuint(right.primaries, ==, primaries);
    g_assert_cmpuint(MAX(left.laterals, right.laterals) - MIN(left.laterals, right.laterals), <=, laterals_apart);
    CLOSE(left.angle, right.angle, degrees_apart);
}

static double cross(Vec2 a, Vec2 b, Vec2 c) { return vec_cross(vec_sub(b, a), vec_sub(c, a)); }

/* In the blade all along, and no two veins of order 1 and 2 cross. */
static void check_sound(const Network *net)
{
    for (uint32_t e = 0; e < net->n_edges; e++) {
        Vec2 a = net->node[net->tail[e]], b = net->node[net->head[e]];
        g_assert_true(isfinite(b.x) && isfinite(b.y) && net->tail[e] < net->head[e]);
        g_assert_true(polygon_contains(net->margin, b) && polygon_contains(net->margin, vec_lerp(a, b, 0.5)));
        g_assert_true(net->order[e] >= 1 && net->vein[e] < net->n_veins && net->width[e] > 0.0);
        for (uint32_t f = 0; f < e && net->order[e] <= 2; f++) {
            Vec2 c = net->node[net->tail[f]], d = net->node[net->head[f]];
            if (net->order[f] > 2 || vec_dist2(a, c) > 4.0 || net->tail[f] == net->tail[e] || net->head[f] == net->tail[e])
                continue;
            if (cross(a, b, c) * cross(a, b, d) < 0.0 && cross(c, d, a) * cross(c, d, b) < 0.0)
                g_error("veins %u (order %u) and %u (order %u) cross at %g, %g", net->vein[e], net->order[e], net->vein[f], net->order[f], a.x, a.y);
        }
    }
}

static void test_presets(void)
{
    static const struct {
        const char *file;
        bool palmate;
        uint32_t primaries, laterals_apart;
        double degrees_apart, bare;
    } want[] = {{"sweetgum.svg", true, 2, 4, 6.0, 0.15},   {"alchemilla.svg", true, 3, 2, 4.0, 0.15}, {"tertiary.svg", true, 3, 2, 4.0, 0.2},
                {"ovate.svg", false, 0, 0, 2.0, 0.2},      {"cherry.svg", false, 0, 0, 2.0, 0.25},    {"poplar.svg", false, 0, 0, 2.0, 0.2},
                {"reticulate.svg", false, 0, 0, 2.0, 0.2}, {"trillium.svg", false, 0, 0, 2.0, 0.2}};
    for (uint32_t i = 0; i < G_N_ELEMENTS(want); i++) {
        Polygon *leaf = file_leaf(want[i].file);
        Network *net = draw_preset(want[i].palmate, leaf);
        check_halves(want[i].file, net, want[i].primaries, want[i].laterals_apart, want[i].degrees_apart);
        check_sound(net);
        g_assert_cmpfloat(bare_disc(net, NULL), <, want[i].bare);
        network_free(net);
        polygon_free(leaf);
    }
}

/* Each primary ends near its lobe's tip. */
static void test_tips(void)
{
    Polygon *leaf = file_leaf("sweetgum.svg");
    Lobes lobes;
    lobes_find(leaf, &lobes);
    Network *net = draw_preset(true, leaf);
    for (uint32_t i = 0; i < lobes.n; i++) {
        Vec2 tip = vec_scale(lobes.lobe[i].tip, unit);
        double nearest = HUGE_VAL;
        for (uint32_t e = 0; e < net->n_edges; e++)
            if (net->order[e] == 1)
                nearest = MIN(nearest, vec_dist(net->node[net->head[e]], tip));
        g_assert_cmpfloat(nearest, <, 0.04 * vec_dist(tip, vec_scale(lobes.hub, unit)));
    }
    network_free(net);
    polygon_free(leaf);
}

/* --- dented bases --- */

/* An ovate blade whose left side begins higher: a bay in it is `deep` leaf lengths high beside a stump of petiole. */
static Polygon *dented(double deep)
{
    const Vec2 v[] = {{0, 0},           {0.008, 0.0},      {0.15, 0.02},  {0.3, 0.12},   {0.36, 0.3}, {0.3, 0.55},
                      {0.14, 0.82},     {0, 1},            {-0.14, 0.82}, {-0.3, 0.55},  {-0.36, 0.3}, {-0.3, 0.12},
                      {-0.15, 0.02 + deep}, {-0.008, deep}, {-0.008, 0.0}};
    return polygon_new(v, G_N_ELEMENTS(v));
}

/* The lowest pair does not go: as many laterals on the dented side, and they come to the margin. */
static void test_dented(void)
{
    for (uint32_t k = 0; k <= 5; k++) {
        Polygon *leaf = dented(0.02 * k);
        Network *net = draw_preset(false, leaf);
        char *name = g_strdup_printf("dented by %.2f", 0.02 * k);
        check_halves(name, net, 0, 0, 8.0);
        check_sound(net);
        g_assert_cmpuint(count_half(net, 1).laterals, ==, 8);
        g_assert_cmpfloat(bare_disc(net, NULL), <, 0.25);
        g_free(name);
        network_free(net);
        polygon_free(leaf);
    }
}

/* --- the scan --- */

static VenParams *scan_params(const char *preset)
{
    VenParams *p = ven_params_new();
    GError *error = NULL;
    char *scan = in_params("scans", "grape.jpg");
    const char *const set[][2] = {{"scan.file", scan},          {"scan.method", "fang"},     {"veins.origin", "lsystem"},
                                  {"growth.final_length", "300"}, {"lsystem.preset", preset}};
    for (uint32_t i = 0; i < G_N_ELEMENTS(set); i++)
        ven_params_set(p, set[i][0], set[i][1], &error);
    g_assert_no_error(error);
    g_free(scan);
    return p;
}

static VenLeaf *grow(const VenParams *p)
{
    GError *error = NULL;
    VenLeaf *leaf = ven_grow(p, 1, NULL, &error);
    g_assert_no_error(error);
    return leaf;
}

/* The midrib as the botanist traced it, the outline of all veins: how far off the midvein's nodes are in the mean and at most, leaf lengths. */
static void midrib_off(const VenLeaf *leaf, double *mean, double *most)
{
    char *path = in_params("scans", "grape_veins.txt"), *text = NULL;
    GArray *v = g_array_new(FALSE, FALSE, sizeof(Vec2));
    g_assert_true(g_file_get_contents(path, &text, NULL, NULL));
    for (char *at = text, *end = NULL;; at = end) {
        double x = g_ascii_strtod(at, &end);
        if (end == at)
            break;
        double y = g_ascii_strtod(end, &end);
        Vec2 p = vec2(x, y);
        g_array_append_val(v, p);
    }
    Polygon *traced = polygon_new((const Vec2 *)(gpointer)v->data, v->len);
    const Network *net = leaf->net;
    double pixels = vec_dist(leaf->ground->base, leaf->ground->tip);
    uint32_t n = 0;
    *mean = *most = 0.0;
    for (uint32_t e = 0; e < net->n_edges; e++) {
        Vec2 at = vec_scale(net->node[net->head[e]], 1.0 / leaf->length);
        if (net->order[e] != 1 || at.y < 0.2 || at.y > 0.9 || fabs(at.x) > 0.1)
            continue;
        double off = MAX(0.0, -polygon_depth(traced, affine_apply(&leaf->ground->to_scan, at)) / pixels);
        *mean += off;
        *most = MAX(*most, off);
        n++;
    }
    *mean /= MAX(n, 1);
    g_assert_cmpuint(n, >, 150);
    polygon_free(traced);
    g_array_unref(v);
    g_free(text);
    g_free(path);
}

static void test_grape(void)
{
    double mean, most;
    VenParams *p = scan_params("auto");
    VenLeaf *leaf = grow(p);
    check_halves("grape", leaf->net, 2, 4, 6.0);
    check_sound(leaf->net);
    double bare = bare_disc(leaf->net, NULL);
    g_assert_cmpfloat(bare, <, 0.12);
    midrib_off(leaf, &mean, &most);
    g_test_message("grape: midvein off the traced midrib by %.4f, at most %.4f", mean, most);
    g_assert_cmpfloat(mean, <, 0.002);
    g_assert_cmpfloat(most, <, 0.006);
    g_assert_null(strstr(ven_leaf_note(leaf), "bare"));
    ven_leaf_free(leaf);
    ven_params_free(p);

    p = scan_params("pinnate");
    ven_params_set(p, "scan.veins", "none", NULL); /* then its midrib isn't looked for either */
    leaf = grow(p);
    midrib_off(leaf, &mean, &most);
    g_assert_cmpfloat(mean, >, 0.002);
    g_assert_cmpfloat(bare_disc(leaf->net, NULL), >, 2.0 * bare); /* and yet too little to be told */
    ven_leaf_free(leaf);
    ven_params_set(p, "lsystem.step", "0.01", NULL);
    leaf = grow(p);
    g_assert_cmpfloat(bare_disc(leaf->net, NULL), >, 0.25);
    g_assert_nonnull(strstr(ven_leaf_note(leaf), "lsystem.preset pinnate) leave"));
    g_assert_nonnull(strstr(ven_leaf_note(leaf), "lsystem.preset = palmate, "));
    ven_leaf_free(leaf);
    ven_params_set(p, "lsystem.axiom", "FFFF", NULL); /* nobody's business how much of the blade that fills */
    leaf = grow(p);
    g_assert_null(strstr(ven_leaf_note(leaf), "bare"));
    ven_leaf_free(leaf);
    ven_params_free(p);
}

/* --- systems of one's own --- */

/* What systems without the blade's symbols drew before there were any. */
static void test_unchanged(void)
{
    static const struct {
        const char *axiom, *production[3], *draws, *leaf;
        uint32_t iterations;
        double angle, step, scale, bend;
        uint64_t hash;
    } own[] = {
        {"F", {"F=F+F--F+F", "X=X", "Y=Y"}, NULL, "ovate.svg", 4, 60.0, 1.0, 1.0 / 3.0, 0.0, 0xd8151ebdda885d52u},
        {"[+L][-R]V", {"V=F[+L][-R]V", "L=FL", "R=FR"}, "VLR", "ovate.svg", 7, 45.0, 0.15, 0.9, 30.0, 0xa51db6a2f2cf74ceu},
        {"X", {"X=F+[[X]-X]-F[-FX]+X", "F=FF", "Y=Y"}, NULL, "sweetgum.svg", 4, 25.0, 0.02, 1.0, 0.0, 0x3a19a9e6ed1d04c2u},
        {"[++@F!FfF]|[-f@FFF]X", {"X:1=F[+X]F", "X:2=F[-X]F", "F=F@F"}, "X", "tertiary.svg", 5, 33.0, 0.2, 0.8, -60.0, 0xc5c6789022344609u},
    };
    for (uint32_t i = 0; i < G_N_ELEMENTS(own); i++) {
        Polygon *leaf = file_leaf(own[i].leaf);
        LSystemDef def = lsystem_def_default();
        def.axiom = own[i].axiom;
        def.production = own[i].production;
        def.n_productions = 3;
        def.iterations = own[i].iterations;
        def.draws = own[i].draws;
        def.angle = own[i].angle;
        def.step = own[i].step;
        def.length_scale = own[i].scale;
        def.bend = own[i].bend;
        Network *net = draw(&def, leaf);
        g_test_message("%u: %u edges, hash 0x%016" G_GINT64_MODIFIER "x", i, net->n_edges, (guint64)leaf_hash(net));
        g_assert_cmphex(leaf_hash(net), ==, own[i].hash);
        network_free(net);
        polygon_free(leaf);
    }
}

/* Without a blade its symbols do nothing; in one, random systems of them draw sound veins, or an error says why not. */
static void test_noise(void)
{
    static const char alphabet[] = "FFFXX+-+-[]^<>~$~$<>";
    LSystemDef def = lsystem_def_default();
    def.axiom = "^F~[<+F$][>-F]$";
    def.n_productions = 0;
    def.iterations = 0;
    Network *net = draw(&def, NULL);
    g_assert_cmpuint(net->n_veins, ==, 3);
    network_free(net);
    static const char *const file[] = {"sweetgum.svg", "alchemilla.svg", "orchid.svg"};
    uint32_t drawn = 0, total = 300;
    for (uint32_t k = 0; k < total; k++) {
        Polygon *leaf = file_leaf(file[k % 3]);
        GString *text[2] = {g_string_new(""), g_string_new("X=")};
        for (uint32_t p = 0; p < 2; p++) {
            uint32_t open = 0;
            for (uint32_t j = 2 + random_block(9, p, k, 99).w[0] % 16; j > 0; j--) {
                char c = alphabet[random_block(9, p, k, j).w[0] % (sizeof alphabet - 1)];
                if (c == ']' && open == 0)
                    continue;
                open += c == '[';
                open -= c == ']';
                g_string_append_c(text[p], c);
            }
            while (open-- > 0)
                g_string_append_c(text[p], ']');
        }
        def = lsystem_def_default();
        def.axiom = text[0]->str;
        def.production = (const char *const[]){text[1]->str};
        def.n_productions = 1;
        def.iterations = 1 + k % 3;
        def.angle = 1.0 + k % 97;
        def.step = 0.05;
        def.bend = k % 3 ? 0.0 : 400.0;
        def.max_symbols = 5000;
        GError *error = NULL;
        net = lsystem_network(&def, leaf, 60.0, NULL, &error);
        g_assert_true(!net == !!error);
        for (uint32_t e = 0; net && e < net->n_edges; e++) {
            g_assert_cmpuint(net->tail[e], <, net->head[e]);
            g_assert_true(polygon_contains(net->margin, net->node[net->head[e]]));
            g_assert_true(net->order[e] >= 1 && net->width[e] > 0.0);
        }
        drawn += net != NULL;
        network_free(net);
        g_clear_error(&error);
        g_string_free(text[0], TRUE);
        g_string_free(text[1], TRUE);
        polygon_free(leaf);
    }
    g_test_message("%u drawn of %u", drawn, total);
    g_assert_cmpuint(drawn, >, total / 3);

    /* A drawing that only the blade makes too long is refused as well. */
    Polygon *leaf = file_leaf("sweetgum.svg");
    GError *error = NULL;
    def = lsystem_def_default();
    def.axiom = "[+$][-$]$";
    def.iterations = 0;
    def.max_symbols = 100;
    g_assert_null(lsystem_network(&def, leaf, 1000.0, NULL, &error));
    g_assert_error(error, LSYSTEM_ERROR, LSYSTEM_ERROR_LIMIT);
    g_assert_nonnull(strstr(error->message, "more than 100 pieces"));
    g_error_free(error);
    polygon_free(leaf);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/lsystem_blade/lobes", test_lobes);
    g_test_add_func("/lsystem_blade/star", test_star);
    g_test_add_func("/lsystem_blade/bare", test_bare);
    g_test_add_func("/lsystem_blade/presets", test_presets);
    g_test_add_func("/lsystem_blade/tips", test_tips);
    g_test_add_func("/lsystem_blade/dented", test_dented);
    g_test_add_func("/lsystem_blade/grape", test_grape);
    g_test_add_func("/lsystem_blade/unchanged", test_unchanged);
    g_test_add_func("/lsystem_blade/noise", test_noise);
    return g_test_run();
}
