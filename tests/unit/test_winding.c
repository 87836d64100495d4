/* What closed lines wind around, against a raster filled by the same rule, and against shapes whose answer is known. */
#include <glib.h>
#include <string.h>

#include "geom/polygon.h"
#include "geom/random.h"
#include "geom/turn.h"
#include "geom/winding.h"

/* Lines as text: "x y x y …" of one, a bar between them. */
typedef struct {
    GArray *p, *start;
} Lines;

static Lines lines_new(void)
{
    Lines l = {g_array_new(FALSE, FALSE, sizeof(Vec2)), g_array_new(FALSE, TRUE, sizeof(uint32_t))};
    g_array_set_size(l.start, 1);
    return l;
}

static void end_line(Lines *l) { g_array_append_val(l->start, l->p->len); }

static void lines_clear(Lines *l)
{
    g_array_unref(l->p);
    g_array_unref(l->start);
}

static Lines lines_of(const char *text)
{
    Lines l = lines_new();
    char **line = g_strsplit(text, "|", -1);
    for (guint i = 0; line[i]; i++) {
        char *s = line[i], *end;
        for (;;) {
            double x = g_ascii_strtod(s, &end);
            if (end == s)
                break;
            Vec2 v = vec2(x, g_ascii_strtod(end, &s));
            g_array_append_val(l.p, v);
        }
        end_line(&l);
    }
    g_strfreev(line);
    return l;
}

static const Vec2 *points(const Lines *l) { return (const Vec2 *)(const void *)l->p->data; }
static const uint32_t *starts(const Lines *l) { return (const uint32_t *)(const void *)l->start->data; }

static Polygon *polygon_of(const Winding *w) { return polygon_new((const Vec2 *)(const void *)w->margin->data, w->margin->len); }

static void find(const Lines *l, Winding *w)
{
    winding_find(points(l), starts(l), l->start->len - 1, w);
    bool good = w->kind == WINDING_SIMPLE || w->kind == WINDING_UNITED;
    g_assert_true(good == (w->margin->len >= 3));
    if (!good)
        return;
    double twice = 0.0;
    for (guint i = 0; w->kind == WINDING_UNITED && i < w->margin->len; i++)
        twice += vec_cross(g_array_index(w->margin, Vec2, i), g_array_index(w->margin, Vec2, (i + 1) % w->margin->len));
    g_assert_true(w->kind == WINDING_SIMPLE || twice > 0.0);
    Polygon *p = polygon_of(w);
    uint32_t i, j;
    g_assert_false(polygon_crossing(p, &i, &j));
    polygon_free(p);
}

/* ---- known ones ---- */

static void test_known(void)
{
    static const struct {
        const char *lines;
        WindingKind kind;
        double area;
        guint corners;
        bool first_in;
    } cases[] = {
        {"0 0 4 0 4 4 0 4", WINDING_SIMPLE, 16, 4, false},
        {"0 0 0 4 4 4 4 0", WINDING_SIMPLE, 16, 4, false}, /* clockwise */
        {"0 0 4 0 4 4 0 4 | 2 2 6 2 6 6 2 6", WINDING_UNITED, 28, 8, false},
        {"0 0 4 0 4 4 0 4 | 2 2 2 6 6 6 6 2", WINDING_UNITED, 28, 8, false}, /* the other way round */
        {"2 2 6 2 6 6 2 6 | 0 0 4 0 4 4 0 4", WINDING_UNITED, 28, 8, true},  /* the first point is covered */
        {"0 0 4 0 4 4 0 4 | 4 0 8 0 8 4 4 4", WINDING_UNITED, 32, 6, false}, /* side by side */
        {"0 0 4 0 4 4 0 4 | 4 1 8 1 8 3 4 3", WINDING_UNITED, 24, 8, false}, /* on a part of a side */
        {"0 0 4 0 4 4 0 4 | 0 0 4 0 4 4 0 4", WINDING_UNITED, 16, 4, false}, /* twice */
        {"0 0 8 0 8 8 0 8 | 2 2 4 2 4 4 2 4", WINDING_UNITED, 64, 4, false}, /* within */
        {"2 2 4 2 4 4 2 4 | 0 0 8 0 8 8 0 8", WINDING_UNITED, 64, 4, true},
        {"0 0 8 0 8 8 0 8 | 2 2 2 4 4 4 4 2", WINDING_UNITED, 64, 4, false}, /* no hole */
        {"0 0 4 0 4 4 0 4 | 4 4 8 4 8 8 4 8", WINDING_APART, 0, 0, false},   /* meet in a point */
        {"0 0 4 0 4 4 0 4 | 5 0 9 0 9 4 5 4", WINDING_APART, 0, 0, false},
        {"0 0 10 10 10 0 0 10", WINDING_APART, 0, 0, false},                 /* a bow tie */
        {"0 0 10 0 10 10 5 0 0 10", WINDING_APART, 0, 0, false},             /* touches itself */
        {"0 0 10 0 10 10 5 1 0 10", WINDING_SIMPLE, 55, 5, false},
        {"0 0 9 0 9 9 0 9 0 6 3 6 3 3 0 3", WINDING_SIMPLE, 72, 8, false},
        {"0 0 9 0 9 9 0 9 0 5 6 5 6 3 0 3 0 5 0 3", WINDING_UNITED, 69, 0, false}, /* a gap that a line to and fro doesn't close */
        {"0 0 9 0 9 9 12 12 9 9 0 9", WINDING_UNITED, 81, 0, false},         /* a spike */
        {"0 0 9 0 9 9 0 9 0 0 9 0 9 9 0 9", WINDING_UNITED, 81, 0, false},   /* round twice */
        {"0 0 1 0 0 0", WINDING_EMPTY, 0, 0, false},
        {"0 0 1 1 2 2 3 3", WINDING_EMPTY, 0, 0, false},
        {"5 5 5 5 5 5", WINDING_EMPTY, 0, 0, false},
        {"5 5", WINDING_EMPTY, 0, 0, false},
        {"5 5 6 6", WINDING_EMPTY, 0, 0, false},
        /* two lobes whose ends overlap around a gap, as a line and as a line of its own each */
        {"0 0 10 0 10 8 4 8 4 6 8 6 8 2 2 2 2 6 6 6 6 8 0 8", WINDING_UNITED, 80, 0, false},
        {"0 0 10 0 10 2 2 2 2 8 0 8 | 0 6 10 6 10 8 0 8 | 8 0 10 0 10 8 8 8", WINDING_UNITED, 80, 0, false},
        /* the tip of a tooth with its sides crossed hangs on at a point */
        {"0 0 100 0 100 100 51 100 49 104 51 104 49 100 0 100", WINDING_UNITED, 10002, 0, false},
    };
    for (guint k = 0; k < G_N_ELEMENTS(cases); k++) {
        Lines l = lines_of(cases[k].lines);
        Winding w;
        find(&l, &w);
        if (w.kind != cases[k].kind)
            g_error("%s: %d, not %d", cases[k].lines, (int)w.kind, (int)cases[k].kind);
        if (w.margin->len > 0) {
            Polygon *p = polygon_of(&w);
            if (fabs(p->area - cases[k].area) > 1e-4 || (cases[k].corners && p->n != cases[k].corners) || w.first_in != cases[k].first_in)
                g_error("%s: area %g, %u corners, first %s", cases[k].lines, p->area, p->n, w.first_in ? "within" : "on the margin");
            g_assert_true(w.first_in || (p->v[0].x == points(&l)->x && p->v[0].y == points(&l)->y));
            polygon_free(p);
        }
        winding_clear(&w);
        lines_clear(&l);
    }
}

/* Of parts that don't hang together both are told. */
static void test_apart(void)
{
    Lines l = lines_of("0 0 4 0 4 4 0 4 | 10 0 11 0 11 1 10 1 | 20 0 23 0 23 3 20 3");
    Winding w;
    find(&l, &w);
    g_assert_cmpint(w.kind, ==, WINDING_APART);
    g_assert_cmpfloat(w.area[0], ==, 16.0);
    g_assert_cmpfloat(w.area[1], ==, 9.0);
    g_assert_cmpuint(w.part[0], <, 4);
    g_assert_cmpuint(w.part[1], >=, 8);
    winding_clear(&w);
    lines_clear(&l);
}

/* ---- a raster ---- */

enum { SIDE = 200 };

static double signed_area(const Vec2 *p, uint32_t n)
{
    double twice = 0.0;
    for (uint32_t i = 0; i < n; i++)
        twice += vec_cross(p[i], p[(i + 1) % n]);
    return 0.5 * twice;
}

/* How often the lines wind around q, each turned to have a positive area. */
static int turns_around(const Lines *l, Vec2 q)
{
    int sum = 0;
    for (guint k = 0; k + 1 < l->start->len; k++) {
        const Vec2 *p = points(l) + starts(l)[k];
        uint32_t n = starts(l)[k + 1] - starts(l)[k];
        int one = 0;
        for (uint32_t i = 0; i < n; i++) {
            Vec2 a = p[i], b = p[(i + 1) % n];
            if (a.y <= q.y && b.y > q.y && turn_sign(a, b, q) > 0)
                one++;
            if (b.y <= q.y && a.y > q.y && turn_sign(a, b, q) < 0)
                one--;
        }
        sum += signed_area(p, n) >= 0.0 ? one : -one;
    }
    return sum;
}

static Vec2 middle(uint32_t i) { return vec2((i % SIDE + 0.5) * 10.0 / SIDE + 1e-4, (i / SIDE + 0.5) * 10.0 / SIDE + 2e-4); }

static bool near_line(const Lines *l, Vec2 q, double far)
{
    for (guint k = 0; k + 1 < l->start->len; k++)
        for (uint32_t i = starts(l)[k], n = starts(l)[k + 1]; i < n; i++) {
            Vec2 a = points(l)[i], b = points(l)[i + 1 < n ? i + 1 : starts(l)[k]], d = vec_sub(b, a);
            double t = vec_norm2(d) > 0.0 ? CLAMP(vec_dot(vec_sub(q, a), d) / vec_norm2(d), 0.0, 1.0) : 0.0;
            if (vec_dist(q, vec_lerp(a, b, t)) < far)
                return true;
        }
    return false;
}

enum { UNKNOWN, WITHIN, OUTSIDE };

/* Squares of a plane 10 wide: within, by how often the lines wind around their middles; outside, where they don't and a way leads there from the border
 * that touches no line; else in a gap, or so near to a line that it can't be told. */
static void fill_raster(const Lines *l, uint8_t *px)
{
    const double diagonal = 0.75 * 10.0 / SIDE;
    GArray *stack = g_array_new(FALSE, FALSE, sizeof(uint32_t));
    for (uint32_t i = 0; i < SIDE * SIDE; i++)
        px[i] = turns_around(l, middle(i)) != 0 ? WITHIN : UNKNOWN;
    uint32_t corner = 0;
    px[corner] = OUTSIDE;
    g_array_append_val(stack, corner);
    while (stack->len > 0) {
        uint32_t i = g_array_index(stack, uint32_t, stack->len - 1);
        g_array_set_size(stack, stack->len - 1);
        for (int k = 0; k < 4; k++) {
            int x = (int)(i % SIDE) + (k == 0) - (k == 1), y = (int)(i / SIDE) + (k == 2) - (k == 3);
            uint32_t next = (uint32_t)(y * SIDE + x);
            if (x < 0 || y < 0 || x >= SIDE || y >= SIDE || px[next] != UNKNOWN || near_line(l, middle(next), diagonal))
                continue;
            px[next] = OUTSIDE;
            g_array_append_val(stack, next);
        }
    }
    g_array_unref(stack);
}

/* No square outside is within the margin, and of those within few are without, as parts that hang on at a point are; the margin follows the lines. */
static void check_raster(const Lines *l, const Winding *w)
{
    static uint8_t px[SIDE * SIDE];
    fill_raster(l, px);
    Polygon *p = polygon_of(w);
    uint32_t filled = 0, beyond = 0;
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        bool in = polygon_contains(p, middle(i));
        filled += px[i] == WITHIN;
        beyond += px[i] == WITHIN && !in;
        g_assert_false(px[i] == OUTSIDE && in);
    }
    g_assert_cmpfloat(beyond, <=, 0.05 * filled);
    for (uint32_t i = 0; i < p->n; i++)
        g_assert_true(near_line(l, vec_lerp(p->v[i], p->v[(i + 1) % p->n], 0.5), 1e-6));
    polygon_free(p);
}

/* Around the corners of a square, not always onward and near enough to lie over one another; `whole`: of 25 points alone. */
static Lines random_lines(uint32_t k, bool whole)
{
    Lines l = lines_new();
    uint32_t n_lines = 1 + random_block(21, 0, k, 0).w[0] % 3, at = 0;
    for (uint32_t i = 0; i < n_lines; i++) {
        uint32_t n = 3 + random_block(21, 0, k, 1 + i).w[1] % 12;
        for (uint32_t j = 0; j < n; j++, at++) {
            double u[4];
            random_pair(21, 1, k, at, u);
            random_pair(21, 2, k, at, u + 2);
            double way = (j + 2.5 * u[0]) / n * 4.0, out = 2.0 + 2.5 * u[1];
            way -= 4.0 * floor(way / 4.0);
            double x = way < 1.0 ? 1.0 : way < 2.0 ? 3.0 - 2.0 * way : way < 3.0 ? -1.0 : 2.0 * way - 7.0;
            double y = way < 1.0 ? 2.0 * way - 1.0 : way < 2.0 ? 1.0 : way < 3.0 ? 5.0 - 2.0 * way : -1.0;
            Vec2 q = k % 4 < 2 ? vec2(5 + out * x, 5 + out * y) : vec2(0.5 + 9 * u[2], 0.5 + 9 * u[3]);
            if (whole)
                q = vec2(1 + 2 * floor(q.x / 2), 1 + 2 * floor(q.y / 2));
            g_array_append_val(l.p, q);
        }
        end_line(&l);
    }
    return l;
}

/* Lines by chance; of every other, all points are of 25, so that sides run over points and over one another. */
static void test_random(void)
{
    uint32_t count[WINDING_TANGLE + 1] = {0};
    for (uint32_t k = 0; k < 600; k++) {
        Lines l = random_lines(k, k % 2 == 1);
        Winding w;
        find(&l, &w);
        count[w.kind]++;
        if (w.kind == WINDING_UNITED || w.kind == WINDING_SIMPLE)
            check_raster(&l, &w);
        winding_clear(&w);
        lines_clear(&l);
    }
    g_test_message("%u simple, %u united, %u without area, %u apart", count[0], count[1], count[2], count[3]);
    g_assert_cmpuint(count[WINDING_UNITED], >, 150);
    g_assert_cmpuint(count[WINDING_APART], >, 20);
    g_assert_cmpuint(count[WINDING_TANGLE], ==, 0);
}

/* The area is the same whichever line comes first and wherever and whichever way round each begins; and far away, or large. */
static void test_turned(void)
{
    for (uint32_t k = 0; k < 300; k++) {
        Lines l = random_lines(k, k % 2 == 1), m = lines_new();
        for (guint i = l.start->len - 1; i-- > 0;) {
            uint32_t from = starts(&l)[i], n = starts(&l)[i + 1] - from;
            for (uint32_t j = 0; j < n; j++) {
                Vec2 q = points(&l)[from + (k % 3 == 0 ? n - 1 - j : (j + k) % n)];
                q = vec2(1024.0 * q.x - 30000.0, 1024.0 * q.y + 70000.0);
                g_array_append_val(m.p, q);
            }
            end_line(&m);
        }
        Winding a, b;
        find(&l, &a);
        find(&m, &b);
        bool sign = false; /* a line without area may be turned either way */
        for (guint i = 0; i + 1 < l.start->len; i++)
            sign |= fabs(signed_area(points(&l) + starts(&l)[i], starts(&l)[i + 1] - starts(&l)[i])) < 1e-9;
        if (!sign) {
            g_assert_cmpint(a.kind == WINDING_SIMPLE ? WINDING_UNITED : a.kind, ==, b.kind == WINDING_SIMPLE ? WINDING_UNITED : b.kind);
            if (a.margin->len > 0) {
                Polygon *p = polygon_of(&a), *q = polygon_of(&b);
                g_assert_cmpfloat(fabs(q->area / (1024.0 * 1024.0 * p->area) - 1.0), <, 1e-5);
                polygon_free(p);
                polygon_free(q);
            }
        }
        winding_clear(&a);
        winding_clear(&b);
        lines_clear(&l);
        lines_clear(&m);
    }
}

/* ---- many points ---- */

/* Sides all across one another are refused before they take long. */
static void test_tangle(void)
{
    Lines l = lines_new();
    for (uint32_t i = 0; i < 4000; i++) {
        double u[2];
        random_pair(22, 0, 0, i, u);
        Vec2 q = vec2(1000 * u[0], 1000 * u[1]);
        g_array_append_val(l.p, q);
    }
    end_line(&l);
    Winding w;
    gint64 begin = g_get_monotonic_time();
    find(&l, &w);
    g_assert_cmpint(w.kind, ==, WINDING_TANGLE);
    g_test_message("refused after %.3f s", (double)(g_get_monotonic_time() - begin) * 1e-6);
    winding_clear(&w);
    lines_clear(&l);
}

/* Two combs of a hundred thousand points whose teeth cross; the area of what they share is that of its small parallelograms. */
static void test_many(void)
{
    enum { TEETH = 25000 };
    Lines l = lines_new();
    for (int k = 0; k < 2; k++) {
        double shift = k ? 0.5 : 0.0;
        Vec2 corner[2] = {{0.0, k ? 3.0 : 0.0}, {TEETH + 1.0, k ? 3.0 : 0.0}};
        g_array_append_vals(l.p, corner, 2);
        for (int i = TEETH; i >= 0; i--) {
            Vec2 tooth[2] = {{i + 0.5 + shift * 0.5, k ? 1.0 : 2.0}, {i + shift * 0.5, k ? 2.0 : 1.0}};
            g_array_append_vals(l.p, tooth, 2);
        }
        end_line(&l);
    }
    Winding w;
    gint64 begin = g_get_monotonic_time();
    find(&l, &w);
    g_test_message("%u points: %.2f s", l.p->len, (double)(g_get_monotonic_time() - begin) * 1e-6);
    g_assert_cmpint(w.kind, ==, WINDING_UNITED);
    Polygon *p = polygon_of(&w);
    g_assert_cmpfloat(p->area, >, 2.7 * TEETH);
    g_assert_cmpfloat(p->area, <=, 3.0 * TEETH + 6.0);
    polygon_free(p);
    winding_clear(&w);
    lines_clear(&l);
}

/* A near miss is a touch; numbers near the smallest and largest that there are do no harm. */
static void test_extremes(void)
{
    static const double by[] = {1e-300, 1e-30, 1e-6, 1.0, 1e6, 1e60};
    for (guint k = 0; k < G_N_ELEMENTS(by); k++) {
        Lines l = lines_of("0 0 10 0 10 10 5 1e-10 0 10 | 0 0 3 1 4 9 1 7");
        for (guint i = 0; i < l.p->len; i++)
            g_array_index(l.p, Vec2, i) = vec_scale(g_array_index(l.p, Vec2, i), by[k]);
        Winding w;
        find(&l, &w);
        g_assert_cmpint(w.kind, ==, by[k] < 1e-20 ? WINDING_EMPTY : WINDING_APART);
        winding_clear(&w);
        lines_clear(&l);
    }
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/winding/known", test_known);
    g_test_add_func("/winding/apart", test_apart);
    g_test_add_func("/winding/random", test_random);
    g_test_add_func("/winding/turned", test_turned);
    g_test_add_func("/winding/tangle", test_tangle);
    g_test_add_func("/winding/many", test_many);
    g_test_add_func("/winding/extremes", test_extremes);
    return g_test_run();
}
