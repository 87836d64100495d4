/* L-systems: known expansions, a plain twin, the turtle's figures, and the networks they make in leaves. */
#include <glib.h>
#include <string.h>

#include "geom/outline.h"
#include "geom/random.h"
#include "sim/lsystem.h"

#define CLOSE(a, b, e) g_assert_cmpfloat_with_epsilon(a, b, e)

/* Productions as one text, "A=AB B=A". */
typedef struct {
    LSystemDef def;
    char **production;
} System;

static System make(const char *axiom, const char *productions, uint32_t iterations)
{
    System s = {.def = lsystem_def_default(), .production = g_strsplit(productions, " ", -1)};
    s.def.axiom = axiom;
    s.def.production = (const char *const *)s.production;
    s.def.n_productions = g_strv_length(s.production);
    s.def.iterations = iterations;
    s.def.draws = NULL;
    s.def.angle = 90.0;
    s.def.step = 1.0;
    s.def.length_scale = 1.0;
    s.def.bend = 0.0;
    return s;
}

static void done(System *s) { g_strfreev(s->production); }

static LString *expand(const System *s)
{
    GError *error = NULL;
    LString *string = lsystem_expand(&s->def, &error);
    g_assert_no_error(error);
    g_assert_cmpuint(strlen(string->symbol), ==, string->n);
    return string;
}

static uint32_t count(const LString *s, char symbol)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < s->n; i++)
        n += s->symbol[i] == symbol;
    return n;
}

static Network *draw(const System *s, const Polygon *leaf, double length, uint32_t *margin)
{
    GError *error = NULL;
    Network *net = lsystem_network(&s->def, leaf, length, margin, &error);
    g_assert_no_error(error);
    return net;
}

/* --- strings --- */

static void test_algae(void)
{
    static const char *const want[] = {"A", "AB", "ABA", "ABAAB", "ABAABABA", "ABAABABAABAAB"};
    uint32_t a = 1, b = 1;
    for (uint32_t k = 0; k < 25; k++) {
        System s = make("A", "A=AB B=A", k);
        LString *string = expand(&s);
        if (k < G_N_ELEMENTS(want))
            g_assert_cmpstr(string->symbol, ==, want[k]);
        g_assert_cmpuint(string->n, ==, b);
        b += a;
        a = b - a;
        lstring_free(string);
        done(&s);
    }
}

static void test_known(void)
{
    System koch = make("F", "F=F+F-F-F+F", 1), plant = make("X", "X=F+[[X]-X]-F[-FX]+X F=FF", 1), cantor = make("A", "A=ABA B=BBB", 3);
    LString *string = expand(&koch);
    g_assert_cmpstr(string->symbol, ==, "F+F-F-F+F");
    lstring_free(string);
    koch.def.iterations = 6;
    string = expand(&koch);
    g_assert_cmpuint(count(string, 'F'), ==, 15625); /* 5^6 */
    g_assert_cmpuint(string->n, ==, 15625 + 15624);
    lstring_free(string);
    string = expand(&plant);
    g_assert_cmpstr(string->symbol, ==, "F+[[X]-X]-F[-FX]+X");
    lstring_free(string);
    uint32_t x = 1, f = 0;
    for (plant.def.iterations = 0; plant.def.iterations < 8; plant.def.iterations++, f = 2 * f + 3 * x, x *= 4) {
        string = expand(&plant);
        g_assert_cmpuint(count(string, 'X'), ==, x);
        g_assert_cmpuint(count(string, 'F'), ==, f);
        lstring_free(string);
    }
    string = expand(&cantor);
    g_assert_cmpstr(string->symbol, ==, "ABABBBABABBBBBBBBBABABBBABA");
    lstring_free(string);
    done(&koch);
    done(&plant);
    done(&cantor);
}

static void test_syntax(void)
{
    System s = make(" A [ + B ]\t", "A=B[+A] B:1= - = B", 1);
    s.def.production = (const char *const[]){" A = B [ + A ] ", "B :2e0= ", "+=-"};
    s.def.n_productions = 3;
    LString *string = expand(&s);
    g_assert_cmpstr(string->symbol, ==, "B[+A][-]"); /* B goes, + is replaced */
    const uint16_t born[] = {1, 1, 1, 1, 1, 0, 1, 0};
    for (uint32_t i = 0; i < string->n; i++)
        g_assert_cmpuint(string->born[i], ==, born[i]);
    lstring_free(string);
    done(&s);
}

static void append(char *text, char c)
{
    size_t n = strlen(text);
    text[n] = c;
    text[n + 1] = '\0';
}

/* A plain twin: strings glued together, with births, one choice after another from the same numbers. */
static void test_twin(void)
{
    static const char alphabet[] = "AABBFF+-";
    for (uint32_t k = 0; k < 200; k++) {
        char text[6][24];
        const char *production[6];
        uint32_t n = 1 + random_block(4, 1, k, 0).w[0] % 6;
        for (uint32_t i = 0; i < n; i++) {
            RandomBlock r = random_block(4, 2, k, i);
            g_snprintf(text[i], sizeof text[i], "%c:%u=", "ABF"[r.w[0] % 3], 1 + r.w[1] % 4);
            for (uint32_t j = r.w[2] % 4; j > 0; j--)
                append(text[i], alphabet[(r.w[3] >> 4 * j) % 8]);
            production[i] = text[i];
        }
        System s = make("ABF", "", 5);
        s.def.production = production;
        s.def.n_productions = n;
        s.def.seed = k;
        LString *got = expand(&s);

        GString *want = g_string_new("ABF"), *born = g_string_new_len("\0\0\0", 3);
        for (uint32_t it = 1; it <= 5; it++) {
            GString *next = g_string_new(NULL), *next_born = g_string_new(NULL);
            for (uint32_t i = 0; i < want->len; i++) {
                double total = 0.0, u[2];
                for (uint32_t p = 0; p < n; p++)
                    total += text[p][0] == want->str[i] ? text[p][2] - '0' : 0;
                random_pair(k, 80, it, i, u);
                double left = u[0] * total;
                const char *to = NULL;
                for (uint32_t p = 0; p < n && !to; p++)
                    if (text[p][0] == want->str[i] && (left -= text[p][2] - '0') < 0.0)
                        to = text[p] + 4;
                for (const char *c = to ? to : (const char[2]){want->str[i], '\0'}; *c; c++) {
                    g_string_append_c(next, *c);
                    g_string_append_c(next_born, to ? (char)it : born->str[i]);
                }
            }
            g_string_free(want, TRUE);
            g_string_free(born, TRUE);
            want = next;
            born = next_born;
        }
        g_assert_cmpstr(got->symbol, ==, want->str);
        for (uint32_t i = 0; i < got->n; i++)
            g_assert_cmpuint(got->born[i], ==, (guint)born->str[i]);
        g_string_free(want, TRUE);
        g_string_free(born, TRUE);
        lstring_free(got);
        done(&s);
    }
}

/* Weights 1 and 3 give a quarter and three quarters, another seed another string, the same seed the same. */
static void test_weights(void)
{
    System s = make("X", "X=XX X:1e-9=X", 14);
    LString *many = expand(&s), *a, *b;
    System w = make(many->symbol, "X=A X:3=B", 1);
    a = expand(&w);
    g_assert_cmpuint(a->n, ==, 1 << 14);
    CLOSE((double)count(a, 'A') / a->n, 0.25, 0.015); /* four sigmas */
    g_assert_cmpuint(count(a, 'A') + count(a, 'B'), ==, a->n);
    b = expand(&w);
    g_assert_cmpstr(a->symbol, ==, b->symbol);
    lstring_free(b);
    w.def.seed++;
    b = expand(&w);
    g_assert_cmpstr(a->symbol, !=, b->symbol);
    lstring_free(many);
    lstring_free(a);
    lstring_free(b);
    done(&s);
    done(&w);
}

/* --- the turtle --- */

static double total_length(const Network *net)
{
    double sum = 0.0;
    for (uint32_t e = 0; e < net->n_edges; e++)
        sum += vec_dist(net->node[net->tail[e]], net->node[net->head[e]]);
    return sum;
}

/* Koch's curve: 4^n steps of 3^-n, as high as √3/6, straight on from end to end. */
static void test_koch(void)
{
    System s = make("F", "F=F+F--F+F", 0);
    s.def.angle = 60.0;
    s.def.length_scale = 1.0 / 3.0;
    double want = 1.0;
    uint32_t steps = 1;
    for (; s.def.iterations < 7; s.def.iterations++, want *= 4.0 / 3.0, steps *= 4) {
        Network *net = draw(&s, NULL, 1.0, NULL);
        g_assert_cmpuint(net->n_edges, ==, steps);
        g_assert_cmpuint(net->n_veins, ==, 1);
        g_assert_null(net->margin);
        CLOSE(total_length(net), want, 1e-12 * steps);
        CLOSE(vec_dist(net->node[net->n_nodes - 1], vec2(0.0, 1.0)), 0.0, 1e-11);
        double widest = 0.0;
        for (uint32_t v = 0; v < net->n_nodes; v++)
            widest = MAX(widest, -net->node[v].x);
        CLOSE(widest, s.def.iterations ? sqrt(3.0) / 6.0 : 0.0, 1e-11);
        network_free(net);
    }
    done(&s);
}

/* Every symbol once: where the pieces run, what branches keep and what they forget. */
static void test_symbols(void)
{
    System s = make("F[+F!F][-@FX]|@FfF", "Y=Y", 0);
    s.def.draws = "X";
    s.def.murray = false;
    s.def.width = 8.0;
    s.def.width_scale = 0.5;
    s.def.length_scale = 0.25;
    Network *net = draw(&s, NULL, 1.0, NULL);
    const struct {
        Vec2 a, b;
        uint8_t order;
        uint32_t vein;
        double width;
    } want[] = {{{0, 0}, {0, 1}, 1, 0, 8},      {{0, 1}, {-1, 1}, 2, 1, 8},   {{-1, 1}, {-2, 1}, 2, 1, 4},   {{0, 1}, {0.25, 1}, 2, 2, 8},
                {{0.25, 1}, {0.5, 1}, 2, 2, 8}, {{0, 1}, {0, 0.75}, 1, 0, 8}, {{0, 0.5}, {0, 0.25}, 1, 3, 8}};
    g_assert_cmpuint(net->n_edges, ==, G_N_ELEMENTS(want));
    g_assert_cmpuint(net->n_nodes, ==, G_N_ELEMENTS(want) + 2); /* the gap makes a second first node */
    g_assert_cmpuint(net->n_veins, ==, 4);
    for (uint32_t e = 0; e < net->n_edges; e++) {
        CLOSE(vec_dist(net->node[net->tail[e]], want[e].a), 0.0, 1e-12);
        CLOSE(vec_dist(net->node[net->head[e]], want[e].b), 0.0, 1e-12);
        g_assert_cmpuint(net->order[e], ==, want[e].order);
        g_assert_cmpuint(net->vein[e], ==, want[e].vein);
        CLOSE(net->width[e], want[e].width, 1e-12);
    }
    network_free(net);
    done(&s);

    s = make("[+F][-F]", "X=X", 0); /* branches from the base share its node */
    net = draw(&s, NULL, 1.0, NULL);
    g_assert_cmpuint(net->n_nodes, ==, 3);
    g_assert_true(net->tail[0] == 0 && net->tail[1] == 0);
    network_free(net);
    done(&s);
}

/* Lengths and widths by the iteration that wrote a symbol: the midvein of F=F grows by ever shorter steps. */
static void test_scales(void)
{
    System s = make("V", "V=FV", 4);
    s.def.length_scale = 0.5;
    s.def.width_scale = 0.75;
    s.def.width = 2.0;
    s.def.murray = false;
    s.def.step = 2.0;
    Network *net = draw(&s, NULL, 1.0, NULL);
    g_assert_cmpuint(net->n_edges, ==, 4);
    g_assert_cmpuint(net->n_steps, ==, 4);
    double length = 2.0, width = 2.0;
    for (uint32_t e = 0; e < 4; e++) {
        CLOSE(vec_dist(net->node[net->tail[e]], net->node[net->head[e]]), length *= 0.5, 1e-12);
        CLOSE(net->width[e], width *= 0.75, 1e-12);
        g_assert_cmpuint(net->birth[e], ==, e + 1);
        g_assert_cmpuint(net->node_birth[e + 1], ==, e + 1);
    }
    network_free(net);
    done(&s);
}

/* A vein that bends by b degrees a length times the cosine to the axis tends to the axis: tan(φ/2) falls as e^(-b s). */
static void test_bend(void)
{
    System s = make("+F", "X=X", 0);
    s.def.bend = 90.0;
    s.def.step = 2.0;
    Network *net = draw(&s, NULL, 4000.0, NULL);
    g_assert_cmpuint(net->n_edges, ==, 8000);
    for (uint32_t e = 999; e < 8000; e += 1000) {
        Vec2 d = vec_sub(net->node[net->head[e]], net->node[net->tail[e]]);
        double angle = atan2(-d.x, d.y);
        CLOSE(tan(0.5 * angle), exp(-0.5 * G_PI * (e + 1) / 4000.0), 1e-3);
        g_assert_cmpfloat(d.x, <, 0.0);
    }
    network_free(net);
    done(&s);
}

/* --- in a blade --- */

static Polygon *path_leaf(const char *path, bool mirror)
{
    OutlineDef def = outline_def_default();
    def.path = path;
    def.mirror = mirror;
    def.has_tip = true;
    def.tip = vec2(0, 1);
    def.has_base = true;
    GError *error = NULL;
    Polygon *leaf = outline_new(&def, &error);
    g_assert_no_error(error);
    return leaf;
}

static Polygon *file_leaf(const char *name)
{
    OutlineDef def = outline_def_default();
    char *path = g_build_filename(g_test_get_dir(G_TEST_DIST), "..", "..", "params", "outlines", name, NULL);
    def.path = NULL;
    def.mirror = false;
    def.file = def.where = path;
    GError *error = NULL;
    Polygon *leaf = outline_new(&def, &error);
    g_assert_no_error(error);
    g_free(path);
    return leaf;
}

static void test_margin(void)
{
    Polygon *leaf = path_leaf("M0 0 L.5 0 .5 1 -.5 1 -.5 0z", false);
    System s = make("FFFF[+FFFFFFFFF[-F]F][-FFF]FFFFFFFFF", "X=X", 0);
    s.def.step = 0.1;
    uint32_t margin;
    Network *net = draw(&s, leaf, 50.0, &margin);
    g_assert_cmpuint(margin, ==, 2); /* the left branch and the midvein; what would follow in them is gone */
    g_assert_cmpuint(net->n_veins, ==, 3);
    CLOSE(total_length(net), 50.0 + 25.0 + 15.0, 1e-6);
    bool left = false, tip = false;
    for (uint32_t v = 0; v < net->n_nodes; v++) {
        left |= vec_dist(net->node[v], vec2(-25, 20)) < 1e-6;
        tip |= vec_dist(net->node[v], vec2(0, 50)) < 1e-6;
        g_assert_true(v == 0 || polygon_contains(net->margin, net->node[v]));
    }
    g_assert_true(left && tip);
    network_free(net);
    polygon_free(leaf);
    done(&s);

    /* A slit from the right, narrower than a piece of vein: it stops the vein even so. */
    leaf = path_leaf("M0 0 L.5 0 .5 .503 -.2 .503 -.2 .507 .5 .507 .5 1 -.5 1 -.5 0z", false);
    s = make("F", "X=X", 0);
    net = draw(&s, leaf, 50.0, &margin);
    CLOSE(total_length(net), 25.15, 1e-6);
    g_assert_cmpuint(margin, ==, 1);
    network_free(net);
    polygon_free(leaf);

    /* A vein that would leave the blade at once has no piece; if that is all, nothing is drawn. */
    leaf = path_leaf("M0 0 L.2 .5 0 1 -.2 .5z", false);
    GError *error = NULL;
    s.def.axiom = "[+F][-F]F";
    net = draw(&s, leaf, 50.0, &margin);
    g_assert_cmpuint(net->n_veins, ==, 1);
    g_assert_cmpuint(margin, ==, 1);
    network_free(net);
    s.def.axiom = "[+F][-F]|F";
    g_assert_null(lsystem_network(&s.def, leaf, 50.0, NULL, &error));
    g_assert_error(error, LSYSTEM_ERROR, LSYSTEM_ERROR_EMPTY);
    g_error_free(error);
    polygon_free(leaf);
    done(&s);
}

static double cross(Vec2 a, Vec2 b, Vec2 c) { return vec_cross(vec_sub(b, a), vec_sub(c, a)); }

/* Two edges that share no node and cross. */
static bool any_crossing(const Network *net)
{
    for (uint32_t e = 0; e < net->n_edges; e++)
        for (uint32_t f = e + 1; f < net->n_edges; f++) {
            Vec2 a = net->node[net->tail[e]], b = net->node[net->head[e]], c = net->node[net->tail[f]], d = net->node[net->head[f]];
            if (fabs(a.y - c.y) > 2.0 || fabs(a.x - c.x) > 2.0) /* edges are no longer than 1 */
                continue;
            if (net->tail[e] != net->tail[f] && net->head[e] != net->tail[f] && cross(a, b, c) * cross(a, b, d) < 0.0 &&
                cross(c, d, a) * cross(c, d, b) < 0.0)
                return true;
        }
    return false;
}

/* A tree in the blade from the base on, older before younger, orders by one more at each branch, veins of one order and in one piece. */
static void check_network(const Network *net, uint32_t depth)
{
    uint32_t *entry = g_new0(uint32_t, net->n_nodes), *first = g_new0(uint32_t, net->n_veins), *end = g_new0(uint32_t, net->n_veins);
    g_assert_cmpuint(net->n_nodes, ==, net->n_edges + 1);
    g_assert_true(net->node[0].x == 0.0 && net->node[0].y == 0.0);
    for (uint32_t e = 0; e < net->n_edges; e++) {
        uint32_t t = net->tail[e], h = net->head[e], in = entry[t], v = net->vein[e];
        g_assert_true(t < h && h < net->n_nodes && entry[h] == 0);
        entry[h] = e + 1;
        g_assert_true(t == 0 || in > 0);
        g_assert_cmpuint(net->kind[e], ==, EDGE_VEIN);
        g_assert_cmpuint(net->birth[e], ==, net->node_birth[h]);
        g_assert_cmpuint(net->birth[e], <=, net->n_steps);
        g_assert_cmpuint(net->node_birth[t], <=, net->node_birth[h]);
        g_assert_true(net->width[e] > 0.0 && net->flow[e] >= 1.0 && net->rank[e] >= 1);
        g_assert_true(net->order[e] >= 1 && net->order[e] <= depth);
        g_assert_cmpuint(v, <, net->n_veins);
        if (in > 0 && net->vein[in - 1] == v)
            g_assert_cmpuint(net->order[e], ==, net->order[in - 1]);
        else if (in > 0)
            g_assert_cmpuint(net->order[e], ==, net->order[in - 1] + 1);
        g_assert_true(first[v] == 0 || end[v] == t); /* in one piece */
        first[v] = 1;
        end[v] = h;
        g_assert_true(polygon_contains(net->margin, net->node[h]));
        for (int k = 1; k < 8; k++)
            g_assert_true(polygon_contains(net->margin, vec_lerp(net->node[t], net->node[h], k / 8.0)));
        double length = vec_dist(net->node[t], net->node[h]);
        g_assert_true(length > 0.0 && length <= 1.0 + 1e-9);
    }
    for (uint32_t v = 0; v < net->n_veins; v++)
        g_assert_cmpuint(first[v], ==, 1);
    g_free(entry);
    g_free(first);
    g_free(end);
}

/* Veins of the second order that end at the margin. */
static uint32_t laterals_at_margin(const Network *net)
{
    uint32_t *end = g_new0(uint32_t, net->n_veins), n = 0;
    for (uint32_t e = 0; e < net->n_edges; e++)
        if (net->order[e] == 2)
            end[net->vein[e]] = net->head[e];
    for (uint32_t v = 0; v < net->n_veins; v++)
        n += end[v] && polygon_depth(net->margin, net->node[end[v]]) < 1e-3;
    g_free(end);
    return n;
}

/* The default leaf in ovate blades: S laterals that meet the margin, the midvein to near the tip, five orders, no crossing, and the same
 * on both sides when the blade is. */
static void test_pinnate(void)
{
    static const char *const files[] = {NULL, "ovate.svg", "cherry.svg", "toothed.svg", "sweetgum.svg", "poplar.svg"};
    for (uint32_t i = 0; i < G_N_ELEMENTS(files); i++)
        for (uint32_t laterals = 8; laterals <= 26; laterals += 2) {
            Polygon *leaf = files[i] ? file_leaf(files[i]) : path_leaf(outline_def_default().path, true);
            LSystemDef def = lsystem_def_pinnate(laterals);
            g_assert_cmpuint(def.iterations, ==, (laterals - 2) / 2);
            CLOSE(def.angle * def.iterations, 180.0, 1e-9);
            GError *error = NULL;
            uint32_t margin;
            Network *net = lsystem_network(&def, leaf, 300.0, &margin, &error);
            g_assert_no_error(error);
            check_network(net, 5);
            g_assert_cmpuint(margin, >=, laterals_at_margin(net));
            double top = 0.0, lean = 0.0;
            for (uint32_t v = 0; v < net->n_nodes; v++) {
                top = net->node[v].x == 0.0 ? MAX(top, net->node[v].y) : top;
                lean += net->node[v].x;
            }
            CLOSE(top, 0.97 * 300.0, 1e-6);
            if (i == 0) /* as many pieces on both sides, the last ones differ by rounding */
                CLOSE(lean, 0.0, 1e-3);
            if (i < 2) { /* the ovate blade is so wide near its tip that the last pair may be short of the margin */
                g_assert_cmpuint(laterals_at_margin(net), <=, laterals);
                g_assert_cmpuint(laterals_at_margin(net), >=, i == 0 ? laterals : laterals - 2);
                g_assert_false(any_crossing(net));
            }
            network_free(net);
            polygon_free(leaf);
        }
}

/* Widths by Murray's law: flow is handed down, one from each end. */
static void test_murray(void)
{
    Polygon *leaf = file_leaf("ovate.svg");
    LSystemDef def = lsystem_def_default();
    def.widths.exponent = 3.0;
    def.widths.minimum = 0.7;
    Network *net = lsystem_network(&def, leaf, 200.0, NULL, NULL);
    double *sum = g_new0(double, net->n_nodes);
    for (uint32_t e = 0; e < net->n_edges; e++)
        sum[net->tail[e]] += net->width[e] * net->width[e] * net->width[e];
    for (uint32_t e = 0; e < net->n_edges; e++) {
        double cube = net->width[e] * net->width[e] * net->width[e], want = sum[net->head[e]];
        CLOSE(cube / (want > 0.0 ? want : 0.343), 1.0, 1e-9);
    }
    g_free(sum);
    network_free(net);
    polygon_free(leaf);
}

/* --- limits and refusals --- */

static void refuse(const System *s, LSystemError code, const char *part)
{
    GError *error = NULL;
    g_assert_null(lsystem_network(&s->def, NULL, 100.0, NULL, &error));
    g_assert_error(error, LSYSTEM_ERROR, (int)code);
    if (!strstr(error->message, part))
        g_error("'%s' does not say '%s'", error->message, part);
    g_error_free(error);
}

static void test_limits(void)
{
    System s = make("F", "F=FFFFFFFFFF", 1000); /* 10^1000 */
    s.def.step = 1e-9;
    refuse(&s, LSYSTEM_ERROR_LIMIT, "iteration 7 of the L-system would make 10000000 symbols; the limit is 1000000");
    s.def.iterations = 6;
    LString *string = expand(&s);
    g_assert_cmpuint(string->n, ==, 1000000);
    lstring_free(string);
    s.def.max_symbols = 999999;
    refuse(&s, LSYSTEM_ERROR_LIMIT, "iteration 6");
    s.def.iterations = 0;
    s.def.axiom = "FFFF";
    s.def.max_symbols = 3;
    refuse(&s, LSYSTEM_ERROR_LIMIT, "iteration 0 of the L-system would make 4");
    s.def.max_symbols = 1000;
    s.def.step = 2.51; /* 251 pieces each */
    refuse(&s, LSYSTEM_ERROR_LIMIT, "1004 pieces");
    s.def.step = 2.5;
    Network *net = draw(&s, NULL, 100.0, NULL);
    g_assert_cmpuint(net->n_edges, ==, 1000);
    network_free(net);
    s.def.axiom = "@@@@@@F";
    s.def.length_scale = 10.0;
    refuse(&s, LSYSTEM_ERROR_LIMIT, "pieces");
    done(&s);

    s = make("A", "A=BA", 1000); /* growth by addition is no trouble */
    string = expand(&s);
    g_assert_cmpuint(string->n, ==, 1001);
    g_assert_cmpuint(string->born[0], ==, 1);
    g_assert_cmpuint(string->born[1000], ==, 1000);
    lstring_free(string);
    s.def.iterations = 1001;
    refuse(&s, LSYSTEM_ERROR_SETTINGS, "iterations is 1001");
    done(&s);
    char *deep = g_strnfill(3000, '['), *back = g_strnfill(3000, ']'), *axiom = g_strconcat(deep, "F", back, NULL);
    s = make(axiom, "X=X", 0);
    net = draw(&s, NULL, 1.0, NULL);
    g_assert_cmpuint(net->order[0], ==, 250);
    network_free(net);
    done(&s);
    g_free(deep);
    g_free(back);
    g_free(axiom);
}

static void test_refused(void)
{
    const struct {
        const char *axiom, *production, *part;
    } cases[] = {
        {"F[", "F=F", "'F[' at character 2: no ] belongs to this ["},
        {"F]", "F=F", "'F]' at character 2: no [ belongs to this ]"},
        {"F", "F=F[+F]]", "'F=F[+F]]' at character 8: no ["},
        {"F", "F=[F][[F]", "at character 6: no ]"},
        {"F", "F", "at character 2: = must follow"},
        {"F", "FF=F", "at character 2: = must follow"},
        {"F", "=F", "at character 1: a production starts"},
        {"F", "", "at character 1: a production starts"},
        {"F", "[=F", "which is no bracket"},
        {"F", "F=F=F", "at character 4: symbols are letters, digits and +-[]|!@"},
        {"F*", "F=F", "'F*' at character 2: symbols"},
        {"F", "F=F\xc3\xa9", "at character 4: symbols"},
        {"F", "F:=F", "at character 3: a weight"},
        {"F", "F:0=F", "a weight is a number above 0"},
        {"F", "F:-1=F", "a weight"},
        {"F", "F:nan=F", "a weight"},
        {"F", "F:1e10=F", "a weight"},
        {"F", "F:1F", "at character 4: = must follow"},
    };
    for (uint32_t k = 0; k < G_N_ELEMENTS(cases); k++) {
        System s = make(cases[k].axiom, "F=F", 2);
        s.def.production = (const char *const[]){"G=G", cases[k].production};
        s.def.n_productions = 2;
        refuse(&s, LSYSTEM_ERROR_SYNTAX, cases[k].part);
        done(&s);
    }
    System s = make("", "X=X", 1);
    refuse(&s, LSYSTEM_ERROR_EMPTY, "draws nothing");
    s.def.axiom = "X[+f]f";
    refuse(&s, LSYSTEM_ERROR_EMPTY, "draws nothing");
    s.def.n_productions = 0; /* none is no error */
    refuse(&s, LSYSTEM_ERROR_EMPTY, "draws nothing");
    const double bad[][2] = {{(double)NAN, 361.0},   {0.0, (double)NAN},      {0.0, 11.0},
                             {-4000.0, (double)NAN}, {0.0, (double)INFINITY}, {0.0, 20.0}};
    static const char *const name[] = {"angle", "step", "length scale", "bend", "width", "width scale"};
    for (uint32_t k = 0; k < 12; k++) {
        LSystemDef good = s.def;
        double *field[] = {&s.def.angle, &s.def.step, &s.def.length_scale, &s.def.bend, &s.def.width, &s.def.width_scale};
        *field[k / 2] = bad[k / 2][k % 2];
        refuse(&s, LSYSTEM_ERROR_SETTINGS, name[k / 2]);
        s.def = good;
    }
    GError *error = NULL;
    g_assert_null(lsystem_network(&s.def, NULL, (double)NAN, NULL, &error));
    g_assert_error(error, LSYSTEM_ERROR, LSYSTEM_ERROR_SETTINGS);
    g_error_free(error);
    done(&s);
}

/* Random systems in a lobed blade: whatever they draw is a sound network, or an error says why not. */
static void test_noise(void)
{
    static const char alphabet[] = "FFFFXXYf+-+-+-[]|!@";
    Polygon *leaf = file_leaf("sweetgum.svg");
    uint32_t drawn = 0, total = 1500;
    for (uint32_t k = 0; k < total; k++) {
        char text[3][40] = {"", "X=", "F="};
        for (uint32_t p = 0; p < 3; p++) {
            uint32_t open = 0;
            for (uint32_t j = 2 + random_block(8, p, k, 99).w[0] % 20; j > 0; j--) {
                char c = alphabet[random_block(8, p, k, j).w[0] % (sizeof alphabet - 1)];
                open += c == '[';
                if (c == ']' && open-- == 0) {
                    open = 0;
                    continue;
                }
                append(text[p], c);
            }
            while (open-- > 0)
                append(text[p], ']');
        }
        System s = make(text[0], "X=X", k % 4);
        s.def.production = (const char *const[]){text[1], text[2]};
        s.def.n_productions = 2;
        s.def.angle = 1.0 + k % 97;
        s.def.step = 0.01 + 0.001 * (k % 211);
        s.def.length_scale = 0.9;
        s.def.bend = k % 3 ? 0.0 : 70.0;
        s.def.max_symbols = 20000;
        GError *error = NULL;
        Network *net = lsystem_network(&s.def, leaf, 60.0, NULL, &error);
        g_assert_true(!net == !!error);
        for (uint32_t e = 0; net && e < net->n_edges; e++) {
            g_assert_cmpuint(net->tail[e], <, net->head[e]);
            g_assert_true(polygon_contains(net->margin, net->node[net->head[e]]));
            g_assert_true(polygon_contains(net->margin, vec_lerp(net->node[net->tail[e]], net->node[net->head[e]], 0.5)));
            g_assert_true(net->width[e] > 0.0 && net->vein[e] < net->n_veins && net->order[e] >= 1);
        }
        drawn += net != NULL;
        network_free(net);
        g_clear_error(&error);
        done(&s);
    }
    g_test_message("%u drawn of %u", drawn, total);
    g_assert_cmpuint(drawn, >, total / 3);
    polygon_free(leaf);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/lsystem/algae", test_algae);
    g_test_add_func("/lsystem/known", test_known);
    g_test_add_func("/lsystem/syntax", test_syntax);
    g_test_add_func("/lsystem/twin", test_twin);
    g_test_add_func("/lsystem/weights", test_weights);
    g_test_add_func("/lsystem/turtle/koch", test_koch);
    g_test_add_func("/lsystem/turtle/symbols", test_symbols);
    g_test_add_func("/lsystem/turtle/scales", test_scales);
    g_test_add_func("/lsystem/turtle/bend", test_bend);
    g_test_add_func("/lsystem/blade/margin", test_margin);
    g_test_add_func("/lsystem/blade/pinnate", test_pinnate);
    g_test_add_func("/lsystem/blade/murray", test_murray);
    g_test_add_func("/lsystem/blade/noise", test_noise);
    g_test_add_func("/lsystem/limits", test_limits);
    g_test_add_func("/lsystem/refused", test_refused);
    return g_test_run();
}
