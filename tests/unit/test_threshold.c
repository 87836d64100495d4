/* What is taken for the leaf where two classes of Otsu's are not leaf and paper: sheets on tables, leaves that fill the image. Images are made here, with their truth. */
#include <glib.h>
#include <string.h>

#include "geom/dtrig.h"
#include "geom/random.h"
#include "scan/mask.h"
#include "scan/threshold.h"

enum { SIZE = 240, ALL = SIZE * SIZE };

typedef uint8_t Colour[3];

/* A lobed leaf with veins, on a sheet where it is wide, on a table. Pixels; angles in degrees. */
typedef struct {
    const char *name;
    Colour table, sheet, leaf, vein;
    double wide, high, x, y, turn; /* of the sheet, its centre in the image */
    double size, lx, ly;           /* of the leaf, its centre on the sheet */
    double grain, shade;           /* noise of the table, levels; light that is lost across the image */
    bool grid, grey;
    double least;                  /* of intersection over union */
    bool on_sheet, turned;         /* what is to be said of it */
} Case;

static double draw(uint32_t stream, uint64_t i)
{
    double u[2];
    random_pair(17, stream, 0, i, u);
    return u[0];
}

/* Whether a point that far from the leaf's middle, sizes, is of it, and of a vein. */
static bool in_leaf(double x, double y, bool *vein)
{
    double r2 = x * x + y * y, lobe = r2 > 0.0 ? x * (x * x - 3.0 * y * y) / (r2 * sqrt(r2)) : 0.0; /* cosine of three times the angle */
    *vein = r2 < 0.4 && (fabs(y) < 0.02 || fabs(fabs(y) - 0.7 * fabs(x)) < 0.015);
    return sqrt(r2) < 0.85 + 0.15 * lobe;
}

static Scan *paint(const Case *c, uint8_t *truth)
{
    Scan *s = scan_new(SIZE, SIZE, c->grey ? 1 : 3, 8);
    double co = dtrig_cos(c->turn * DTRIG_PI / 180.0), si = dtrig_sin(c->turn * DTRIG_PI / 180.0);
    for (uint32_t i = 0; i < ALL; i++) {
        double x = i % SIZE + 0.5 - c->x, y = i / SIZE + 0.5 - c->y, u = co * x + si * y, v = co * y - si * x;
        bool vein, leaf = in_leaf((u - c->lx) / c->size, (v - c->ly) / c->size, &vein), shadow_vein;
        bool sheet = fabs(u) < 0.5 * c->wide && fabs(v) < 0.5 * c->high;
        bool shadow = in_leaf((u - c->lx - 3.0) / c->size, (v - c->ly - 3.0) / c->size, &shadow_vein);
        bool line = c->grid && sheet && (fmod(u + 500.0, 12.0) < 1.0 || fmod(v + 500.0, 12.0) < 1.0);
        const uint8_t *colour = leaf ? vein ? c->vein : c->leaf : sheet ? c->sheet : c->table;
        double light = (1.0 - c->shade * (i % SIZE) / SIZE) * (!leaf && shadow ? 0.85 : 1.0) * (line ? 0.9 : 1.0);
        double off = (leaf || sheet ? 6.0 : 6.0 + c->grain) * (draw(1, i) - 0.5);
        double level[3];
        for (uint32_t k = 0; k < 3; k++)
            level[k] = colour[k] * light + off + 4.0 * (draw(2 + k, i) - 0.5);
        for (uint32_t k = 0; k < s->channels; k++)
            ((uint8_t *)s->px)[s->channels * i + k] = (uint8_t)CLAMP(c->grey ? (level[0] + level[1] + level[2]) / 3.0 : level[k], 0.0, 255.0);
        truth[i] = leaf;
    }
    return s;
}

/* Of the largest leaf, its holes filled. */
static double overlap(const Scan *s, const Threshold *t, const uint8_t *truth)
{
    Mask m = {SIZE, SIZE, SIZE, g_malloc0(ALL)};
    threshold_apply(s, t, m.px);
    GArray *parts = mask_components(&m, 0.05);
    g_assert_cmpuint(parts->len, >, 0);
    mask_take(&m, &g_array_index(parts, Component, 0));
    double both = 0.0, any = 0.0;
    for (uint32_t i = 0; i < ALL; i++) {
        bool leaf = (m.px[i] & MASK_THIS) != 0;
        both += leaf && truth[i];
        any += leaf || truth[i];
    }
    g_array_free(parts, TRUE);
    g_free(m.px);
    return both / any;
}

#define GREEN {70, 105, 55}, {150, 165, 120}
#define BROWN {95, 65, 40}, {150, 110, 85}
#define RED {140, 25, 45}, {175, 70, 95}
#define YELLOW {200, 180, 60}, {225, 215, 160}
#define PALE {205, 208, 200}, {235, 235, 235}
#define BLACK {8, 8, 8}
#define TABLE {28, 28, 32}
#define WOOD {135, 88, 50}
#define MAT {46, 107, 74}
#define GREY {125, 125, 122}
#define WHITE {242, 242, 238}
#define PINK {242, 221, 214}
#define OLD {226, 207, 160}
#define NONE 0, 0, 120, 120, 0
#define SHEET(a) 150, 180, 120, 120, a

static const Case cases[] = {
    /* no sheet: as ever */
    {"white, green", WHITE, WHITE, GREEN, NONE, 60, 0, 0, 0, 0, false, false, 0.95, false, false},
    {"white, brown", WHITE, WHITE, BROWN, NONE, 60, 0, 0, 0, 0, false, false, 0.95, false, false},
    {"yellowed, brown, uneven light", OLD, OLD, BROWN, NONE, 60, 0, 0, 0, 0.3, false, false, 0.95, false, false},
    {"green paper, red", {127, 174, 116}, WHITE, RED, NONE, 60, 0, 0, 0, 0, false, false, 0.95, false, false},
    {"green paper, white", MAT, WHITE, PALE, NONE, 60, 0, 0, 0, 0, false, false, 0.95, false, false},
    {"black, white", BLACK, WHITE, PALE, NONE, 60, 0, 0, 0, 0, false, false, 0.95, false, false},
    {"wood, green", WOOD, WHITE, GREEN, NONE, 60, 0, 0, 25, 0, false, false, 0.95, false, false},
    {"grey image, dark", WHITE, WHITE, BROWN, NONE, 60, 0, 0, 0, 0, false, true, 0.95, false, false},
    {"pink grid, green", PINK, PINK, GREEN, 1000, 1000, 120, 120, 0, 60, 0, 0, 0, 0, true, false, 0.95, false, false},
    {"white, cut off", WHITE, WHITE, GREEN, NONE, 90, 60, 50, 0, 0, false, false, 0.95, false, false},
    {"black, white, cut off", BLACK, WHITE, PALE, NONE, 90, 60, 50, 0, 0, false, false, 0.95, false, false},
    /* a sheet on a table */
    {"sheet on dark, green", TABLE, WHITE, GREEN, SHEET(12), 50, 0, 0, 10, 0, false, false, 0.93, true, false},
    {"sheet on black, green, grid", BLACK, PINK, GREEN, SHEET(35), 50, 0, 0, 0, 0, true, false, 0.93, true, false},
    {"sheet on dark, brown", TABLE, WHITE, BROWN, SHEET(-20), 50, 5, 10, 10, 0, false, false, 0.93, true, false},
    {"sheet on dark, yellow", TABLE, WHITE, YELLOW, SHEET(7), 50, 0, 0, 10, 0, false, false, 0.93, true, false},
    {"sheet on dark, red", TABLE, WHITE, RED, SHEET(45), 50, 0, 0, 10, 0, false, false, 0.93, true, false},
    {"sheet on wood, brown", WOOD, WHITE, BROWN, SHEET(0), 50, 0, 0, 25, 0, false, false, 0.93, true, false},
    {"yellowed sheet on wood, brown", WOOD, OLD, BROWN, SHEET(18), 50, 0, 0, 25, 0, false, false, 0.93, true, false},
    {"sheet on a green mat, green", MAT, WHITE, GREEN, SHEET(-9), 50, 0, 0, 10, 0, false, false, 0.93, true, false},
    {"black sheet on white, white", WHITE, BLACK, PALE, SHEET(10), 50, 0, 0, 0, 0, false, false, 0.93, true, false},
    {"sheet on dark, grey image", TABLE, WHITE, BROWN, SHEET(15), 50, 0, 0, 10, 0, false, true, 0.93, true, false},
    {"sheet on dark, uneven light", TABLE, WHITE, GREEN, SHEET(15), 50, 0, 0, 10, 0.3, false, false, 0.93, true, false},
    {"sheet cut off by the frame", TABLE, WHITE, GREEN, 300, 260, 60, 150, 6, 50, 40, -30, 10, 0, false, false, 0.93, true, false},
    {"a strip of table", WOOD, WHITE, BROWN, 400, 400, 5, 120, 4, 40, 100, 0, 25, 0, false, false, 0.93, true, false},
    {"leaf over the sheet's edge", TABLE, WHITE, BROWN, SHEET(8), 40, 0, -58, 10, 0, false, false, 0.80, true, false},
    /* a leaf that fills the image */
    {"full, green", PINK, PINK, GREEN, NONE, 165, 0, 0, 0, 0, false, false, 0.95, false, true},
    {"full, brown", WHITE, WHITE, BROWN, NONE, 165, 0, 0, 0, 0, false, false, 0.95, false, true},
    {"full, yellow", WHITE, WHITE, YELLOW, NONE, 165, 0, 0, 0, 0, false, false, 0.95, false, true},
    {"full, green on black", BLACK, WHITE, GREEN, NONE, 165, 0, 0, 0, 0, false, false, 0.95, false, true},
};

static void test_overlap(void)
{
    uint8_t *truth = g_malloc(ALL);
    for (gsize k = 0; k < G_N_ELEMENTS(cases); k++) {
        const Case *c = &cases[k];
        Scan *s = paint(c, truth);
        ThresholdDef def = {CHANNEL_BEST, LEAF_BY_FRAME, -1.0};
        Threshold t;
        g_assert_true(threshold_find(s, &def, &t, NULL));
        double share = overlap(s, &t, truth);
        g_test_message("%-32s %.3f %s %s, sheet %u%s", c->name, share, channel_name(t.channel), t.dark ? "dark" : "light", t.sheet.n, t.turned ? ", turned" : "");
        if (!(share >= c->least) || (t.sheet.n > 0) != c->on_sheet || t.turned != c->turned)
            g_error("%s: %.3f of %.2f by %s, %s, %u corners, frame %.2f, leaf %.2f%s", c->name, share, c->least, channel_name(t.channel), t.dark ? "dark" : "light",
                    t.sheet.n, t.frame, t.leaf, t.turned ? ", turned" : "");
        scan_free(s);
    }
    g_free(truth);
}

/* Who asks for a channel's level or a side gets it, of the whole image. */
static void test_asked(void)
{
    uint8_t *truth = g_malloc(ALL);
    Scan *sheet = NULL, *full = NULL;
    for (gsize k = 0; k < G_N_ELEMENTS(cases); k++) {
        if (!strcmp(cases[k].name, "sheet on dark, green"))
            sheet = paint(&cases[k], truth);
        if (!strcmp(cases[k].name, "full, green"))
            full = paint(&cases[k], truth);
    }
    Threshold t;
    ThresholdDef def = {CHANNEL_BEST, LEAF_LIGHT, -1.0};
    g_assert_true(threshold_find(sheet, &def, &t, NULL));
    g_assert_true(t.sheet.n == 0 && !t.dark && t.leaf > 0.35);
    g_assert_true(threshold_find(full, &def, &t, NULL));
    g_assert_true(!t.turned && !t.dark);
    def = (ThresholdDef){CHANNEL_BLUE, LEAF_BY_FRAME, -1.0};
    g_assert_true(threshold_find(sheet, &def, &t, NULL));
    g_assert_true(t.sheet.n == 0 && t.channel == CHANNEL_BLUE);
    def = (ThresholdDef){CHANNEL_BEST, LEAF_BY_FRAME, 140.0};
    g_assert_true(threshold_find(sheet, &def, &t, NULL));
    g_assert_true(t.sheet.n == 0 && t.level == 140.0);
    scan_free(sheet);
    scan_free(full);
    g_free(truth);
}

/* 16 bits and alpha tell the same. */
static void test_kinds(void)
{
    uint8_t *truth = g_malloc(ALL), *mask = g_malloc(2 * ALL);
    for (gsize k = 10; k < 27; k += 4) {
        Scan *s = paint(&cases[k], truth), *deep = scan_new(SIZE, SIZE, 4, 16);
        for (uint32_t i = 0; i < 4 * ALL; i++)
            ((uint16_t *)deep->px)[i] = i % 4 < 3 ? (uint16_t)(257 * scan_sample(s, i / 4 % SIZE, i / 4 / SIZE, s->channels == 1 ? 0 : i % 4)) : 65535;
        ThresholdDef def = {CHANNEL_BEST, LEAF_BY_FRAME, -1.0};
        Threshold a, b;
        g_assert_true(threshold_find(s, &def, &a, NULL) && threshold_find(deep, &def, &b, NULL));
        threshold_apply(s, &a, mask);
        threshold_apply(deep, &b, mask + ALL);
        uint32_t differ = 0;
        for (uint32_t i = 0; i < ALL; i++)
            differ += mask[i] != mask[ALL + i];
        g_assert_cmpuint(a.sheet.n, ==, b.sheet.n);
        g_assert_cmpuint(differ, <, ALL / 200);
        scan_free(s);
        scan_free(deep);
    }
    g_free(truth);
    g_free(mask);
}

/* ---- sheets ---- */

/* A convex polygon's pixels, the slow way. */
static void fill(const Vec2 *v, uint32_t n, uint8_t *px)
{
    for (uint32_t i = 0; i < ALL; i++) {
        Vec2 q = vec2(i % SIZE + 0.5, i / SIZE + 0.5);
        px[i] = MASK_CORE;
        for (uint32_t k = 0; k < n; k++)
            if (vec_cross(vec_sub(v[(k + 1) % n], v[k]), vec_sub(q, v[k])) < 0.0)
                px[i] = 0;
    }
}

/* Whether a pixel's centre lies on the line of a side, where it may be in or not. */
static bool on_side(const Paper *p, uint32_t x, uint32_t y)
{
    for (uint32_t k = 0; k < p->n; k++) {
        Vec2 d = vec_sub(p->corner[(k + 1) % p->n], p->corner[k]);
        if (fabs(vec_cross(d, vec_sub(vec2(x + 0.5, y + 0.5), p->corner[k]))) < 1e-6 * sqrt(vec_norm2(d)))
            return true;
    }
    return false;
}

static void test_fit(void)
{
    Mask m = {SIZE, SIZE, SIZE, g_malloc(ALL)};
    uint8_t *again = g_malloc(ALL);
    for (uint32_t k = 0; k < 40; k++) { /* quadrilaterals, some cut off by the frame */
        Vec2 v[4], at = vec2(120.0 + 90.0 * (draw(20, k) - 0.5), 120.0 + 90.0 * (draw(21, k) - 0.5));
        for (uint32_t i = 0; i < 4; i++) {
            double a = DTRIG_PI * (0.5 * i + 0.2 * draw(22, 4 * k + i) + draw(23, k)), r = 90.0 + 40.0 * draw(24, 4 * k + i);
            v[i] = vec2(at.x + r * dtrig_cos(a), at.y + r * dtrig_sin(a));
        }
        fill(v, 4, m.px);
        Paper p;
        g_assert_true(paper_fit(&m, MASK_CORE, &p));
        fill(p.corner, p.n, again);
        uint32_t differ = 0, area = 0;
        for (uint32_t y = 0; y < SIZE; y++) {
            uint32_t from = 0, to = 0;
            bool any = paper_span(&p, SIZE, y, &from, &to);
            for (uint32_t x = 0; x < SIZE; x++) {
                bool in = any && x >= from && x < to;
                if (again[y * SIZE + x] != (in ? MASK_CORE : 0) && !on_side(&p, x, y))
                    g_error("case %u: span %u … %u of row %u is wrong at %u", k, from, to, y, x);
                area += m.px[y * SIZE + x] != 0;
                differ += m.px[y * SIZE + x] != again[y * SIZE + x];
            }
        }
        g_assert_cmpuint(differ, <, area / 50);
        Paper in = paper_scaled(&p, SIZE, SIZE, 1.0, 3.0);
        g_assert_cmpfloat(paper_area(&in), <, paper_area(&p));
        g_assert_cmpfloat(paper_area(&in), >, 0.8 * paper_area(&p));
    }
    g_free(again);
    g_free(m.px);
}

/* What is no sheet: discs, leaves, rhombs with round sides, all of the image, nothing, a pixel. */
static void test_no_fit(void)
{
    Mask m = {SIZE, SIZE, SIZE, g_malloc(ALL)};
    for (uint32_t k = 0; k < 8; k++) {
        for (uint32_t i = 0; i < ALL; i++) {
            double x = (i % SIZE - 119.5) / 100.0, y = (i / SIZE - 119.5) / 100.0;
            bool vein, is = k == 0 ? x * x + y * y < 1.0 : k == 1 ? x * x + 4.0 * y * y < 1.0 : k == 2 ? in_leaf(x, y, &vein) :
                            k == 3 ? sqrt(fabs(x)) + sqrt(fabs(y)) < 1.0 : k == 4 ? fabs(x) + y * y < 0.9 : k == 5 ? true : k == 6 ? false : i == 5000;
            m.px[i] = is ? MASK_CORE : 0;
        }
        Paper p;
        if (paper_fit(&m, MASK_CORE, &p) && paper_area(&p) > 16.0)
            g_error("shape %u is taken for a sheet of %u corners", k, p.n);
    }
    g_free(m.px);
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/threshold/overlap", test_overlap);
    g_test_add_func("/threshold/asked", test_asked);
    g_test_add_func("/threshold/kinds", test_kinds);
    g_test_add_func("/paper/fit", test_fit);
    g_test_add_func("/paper/no_fit", test_no_fit);
    return g_test_run();
}
