/* Neighbourhoods against plain searches written from the definitions, and the three indices against scans of all
 * points. */
#include <glib.h>
#include <stdlib.h>
#include <string.h>

#include "geom/neighbours.h"
#include "geom/random.h"
#include "geom/grid.h"
#include "plain_hood.h"

/* ---- point sets ---- */

/* Numbers in [0, 1), one after another. */
typedef struct {
    uint64_t seed, index;
} Dice;

static double roll(Dice *d)
{
    double u[2];
    random_pair(d->seed, 1000, 0, d->index++, u);
    return u[0];
}

static uint32_t pick(Dice *d, uint32_t n)
{
    return (uint32_t)(roll(d) * n);
}

typedef enum {
    SET_RANDOM,
    SET_CLUSTERS,
    SET_GRID,
    SET_HEXAGONS,
    SET_CIRCLE,
    SET_COINCIDENT,
    SET_ROW,
    SET_DIAGONAL,
    SET_NEARLY_GRID,
    SET_NEARLY_CIRCLE,
    SET_ONE_SIDE,
    SET_TREE_BORDERS,
    SET_WALK,
    SET_COUNT
} SetKind;

static const Box2 field_box = {-40, -38, 40, 41};

/* Lattice points at distance 65 from the origin, scaled to 13: as cocircular as points can be. */
static Vec2 on_circle(uint32_t i)
{
    static const int at[9][2] = {{65, 0},  {63, 16}, {60, 25}, {56, 33}, {52, 39},
                                 {39, 52}, {33, 56}, {25, 60}, {16, 63}};
    double x = at[i % 9][0] / 5.0, y = at[i % 9][1] / 5.0;
    return (i / 9) % 4 == 0   ? vec2(x, y)
           : (i / 9) % 4 == 1 ? vec2(-y, x)
           : (i / 9) % 4 == 2 ? vec2(-x, -y)
                              : vec2(y, -x);
}

/* A centre of a random square of the quadtree over field_box, by the tree's own arithmetic: the worst place for its
 * pruning. */
static Vec2 on_border(Dice *d)
{
    Quadtree t;
    quadtree_init(&t, field_box);
    Vec2 c = t.centre;
    double half = t.half;
    for (uint32_t k = pick(d, 5); k > 0; k--) {
        half *= 0.5;
        c = vec2(c.x + (roll(d) < 0.5 ? half : -half), c.y + (roll(d) < 0.5 ? half : -half));
    }
    quadtree_clear(&t);
    return c;
}

static Vec2 set_point(SetKind kind, uint32_t i, Vec2 last, Dice *d)
{
    double x = (roll(d) - 0.5) * 50, y = (roll(d) - 0.5) * 50, tiny = 1e-9 * (roll(d) - 0.5);
    switch (kind) {
    case SET_CLUSTERS:
        return vec2((i % 3) * 14.0 - 14 + x * 0.02, (i % 2) * 20.0 - 10 + y * 0.02);
    case SET_GRID:
        return vec2(pick(d, 15) - 7.0, pick(d, 15) - 7.0);
    case SET_HEXAGONS: {
        double row = pick(d, 15) - 7.0;
        return vec2(pick(d, 15) - 7.0 + (fmod(fabs(row), 2.0) == 1.0 ? 0.5 : 0.0), row * sqrt(0.75));
    }
    case SET_CIRCLE:
        return on_circle(pick(d, 36));
    case SET_COINCIDENT:
        return vec2(pick(d, 3) * 4.0, pick(d, 3) * 3.0);
    case SET_ROW:
        return vec2(pick(d, 40) - 20.0, 2);
    case SET_DIAGONAL:
        return vec2(pick(d, 40) - 20.0, pick(d, 2) ? 0.0 : 1.0);
    case SET_NEARLY_GRID:
        return vec2(pick(d, 12) - 6.0 + tiny, pick(d, 12) - 6.0 + 1e-9 * roll(d));
    case SET_NEARLY_CIRCLE:
        return vec_scale(on_circle(pick(d, 36)), 1.0 + tiny);
    case SET_ONE_SIDE:
        return vec2(10 + 0.3 * x, y * 0.3);
    case SET_TREE_BORDERS:
        return on_border(d);
    case SET_WALK: { /* like a vein: a chain of unit steps that turns a little */
        if (i % 40 == 0)
            return vec2(x * 0.6, y * 0.6);
        Vec2 p = vec2(last.x + 0.8, last.y + (i / 40 % 2 ? 0.6 : -0.6));
        return fabs(p.x) < 35 && fabs(p.y) < 35 ? p : vec2(x * 0.5, y * 0.5);
    }
    default:
        return vec2(x, y);
    }
}

/* Where a source is looked from: places that make ties, a node's own place, anywhere, far away. */
static Vec2 set_source(SetKind kind, uint32_t k, const Vec2 *pos, uint32_t n, Dice *d)
{
    switch (k % 5) {
    case 0:
        return kind == SET_CIRCLE || kind == SET_NEARLY_CIRCLE ? vec2(0, 0)
                                                               : vec2(pick(d, 12) - 6.0, pick(d, 12) - 6.0);
    case 1:
        return kind == SET_TREE_BORDERS ? on_border(d) : vec2(pick(d, 12) - 5.5, pick(d, 12) - 5.5);
    case 2:
        return pos[pick(d, n)];
    case 3:
        return vec2((roll(d) - 0.5) * 30, (roll(d) - 0.5) * 30);
    default:
        return vec2(-36 + roll(d), (roll(d) - 0.5) * 60);
    }
}

/* ---- what a source may see ---- */

typedef struct {
    int rule; /* 0 all, 1 a third of the nodes is hidden, 2 a half-plane, 3 nothing */
    const Vec2 *pos;
} Sight;

static bool seen(const void *user, uint32_t i)
{
    const Sight *s = user;
    return s->rule == 0 || (s->rule == 1 && i % 3 != 1) || (s->rule == 2 && s->pos[i].x + 0.3 * s->pos[i].y > 1.0);
}

/* ---- comparison ---- */

static const char *const set_name[SET_COUNT] = {
    "random",   "clusters",    "grid",          "hexagons", "circle",       "coincident", "row",
    "diagonal", "nearly grid", "nearly circle", "one side", "tree borders", "walk"};

static int by_index(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

static uint32_t members(const Hood *h, uint32_t out[HOOD_MAX])
{
    memcpy(out, h->m, sizeof *out * h->n);
    qsort(out, h->n, sizeof *out, by_index);
    return h->n;
}

typedef struct {
    SetKind kind;
    Vec2 *pos;
    uint32_t n;
    Sight sight;
    Quadtree tree;
    Boxtree fresh;
} Case;

static Field field_of(const Case *c)
{
    return (Field){c->pos, &c->tree, field_box, c->sight.rule ? seen : NULL, &c->sight};
}

static void fail_at(const Case *c, Vec2 s, const char *what)
{
    g_error("%s: %s, sight %d, %u nodes, source at %.17g,%.17g", what, set_name[c->kind], c->sight.rule, c->n, s.x, s.y);
}

static void check_relative(const Case *c, const Hood *h, Vec2 s, const char *what)
{
    uint32_t got[HOOD_MAX], *want = g_new(uint32_t, c->n + 1);
    uint32_t n = members(h, got), m = plain_relative(c->pos, c->n, s, seen, &c->sight, want);
    if (n != m || memcmp(got, want, sizeof *got * n) != 0)
        fail_at(c, s, what);
    g_free(want);
}

/* A source of an open pattern. */
typedef struct {
    uint32_t v;
    double d2;
} Nearest;

static void check_nearest(const Case *c, Vec2 s, Nearest got, const char *what)
{
    uint32_t want = plain_nearest(c->pos, c->n, s, seen, &c->sight);
    if (got.v != want || (want != NO_POINT && got.d2 != plain_dist2(c->pos[want], s)))
        fail_at(c, s, what);
}

static Nearest find_nearest(const Field *f, Vec2 s)
{
    Nearest n = {NO_POINT, HUGE_VAL};
    n.v = quadtree_nearest(f->tree, s, HUGE_VAL, f->sees, f->user, &n.d2);
    return n;
}

static void check_urquhart(const Case *c, const Hood *h, Vec2 s, const char *what, uint32_t *sure)
{
    uint32_t got[HOOD_MAX], n = members(h, got);
    Answer *want = g_new(Answer, c->n);
    plain_urquhart(c->pos, c->n, s, seen, &c->sight, want);
    for (uint32_t v = 0; v < c->n; v++) {
        bool in = bsearch(&v, got, n, sizeof *got, by_index) != NULL;
        *sure += want[v] == YES;
        if ((want[v] == YES && !in) || (want[v] == NO && in)) {
            g_printerr("# node %u at %.17g,%.17g: %s\n", v, c->pos[v].x, c->pos[v].y, in ? "one too many" : "missing");
            fail_at(c, s, what);
        }
    }
    g_free(want);
}

/* Shows a set to its sources in batches, comparing after each. */
static void check_set(SetKind kind, uint32_t n, uint32_t first, uint32_t batch, int rule, uint64_t seed, uint32_t *sure)
{
    enum { SOURCES = 10 };
    Dice d = {seed, 0};
    Case c = {.kind = kind, .pos = g_new(Vec2, n), .n = first};
    c.sight = (Sight){rule, c.pos};
    for (uint32_t i = 0; i < n; i++)
        c.pos[i] = set_point(kind, i, i ? c.pos[i - 1] : vec2(0, 0), &d);
    quadtree_init(&c.tree, field_box);
    for (uint32_t i = 0; i < first; i++)
        quadtree_add(&c.tree, c.pos[i], i);
    Nearest near[SOURCES];
    Vec2 place[SOURCES];
    Hood hood[SOURCES], urquhart[SOURCES];
    Cell cell[SOURCES] = {0}, scratch = {0};
    Field f = field_of(&c);
    for (uint32_t k = 0; k < SOURCES; k++) {
        Vec2 s = place[k] = set_source(kind, k, c.pos, n, &d);
        near[k] = find_nearest(&f, s);
        hood_find(&hood[k], &f, s);
        urquhart_find(&urquhart[k], &cell[k], &f, s);
    }
    for (uint32_t step = 0; c.n < n || step == 0; step++) {
        uint32_t from = c.n, to = step ? MIN(n, from + batch) : from;
        uint32_t *item = g_new(uint32_t, n);
        for (uint32_t i = from; i < to; i++) {
            quadtree_add(&c.tree, c.pos[i], i);
            item[i - from] = i;
        }
        c.n = to;
        f = field_of(&c);
        boxtree_build(&c.fresh, c.pos, item, to - from);
        g_free(item);
        bool look = step % 3 == 0 || to == n; /* the twins are slow */
        for (uint32_t k = 0; k < SOURCES; k++) {
            if (to > from) {
                uint32_t before[HOOD_MAX], after[HOOD_MAX], n0 = members(&hood[k], before);
                bool changed = hood_update(&hood[k], &f, place[k], &c.fresh);
                uint32_t n1 = members(&hood[k], after);
                bool differs = n0 != n1 || memcmp(before, after, sizeof *before * n0) != 0;
                if (differs && !changed)
                    fail_at(&c, place[k], "an unreported change");
                boxtree_nearest(&c.fresh, c.pos, place[k], f.sees, f.user, &near[k].v, &near[k].d2);
                urquhart_update(&urquhart[k], &cell[k], &f, place[k], &c.fresh);
            }
            if (!look)
                continue;
            Hood h;
            Vec2 s = place[k];
            check_nearest(&c, s, near[k], "boxtree_nearest");
            check_nearest(&c, s, find_nearest(&f, s), "quadtree_nearest");
            check_relative(&c, &hood[k], s, "hood_update");
            hood_find(&h, &f, s);
            check_relative(&c, &h, s, "hood_find");
            check_urquhart(&c, &urquhart[k], s, "urquhart_update", sure);
            urquhart_find(&h, &scratch, &f, s);
            check_urquhart(&c, &h, s, "urquhart_find", sure);
        }
    }
    for (uint32_t k = 0; k < SOURCES; k++)
        cell_clear(&cell[k]);
    cell_clear(&scratch);
    quadtree_clear(&c.tree);
    boxtree_clear(&c.fresh);
    g_free(c.pos);
}

static void test_sets(gconstpointer data)
{
    SetKind kind = (SetKind)GPOINTER_TO_UINT(data);
    static const uint32_t batch[] = {1, 4, 13, 60};
    uint32_t sure = 0;
    for (uint32_t k = 0; k < G_N_ELEMENTS(batch); k++)
        for (int rule = 0; rule < 3; rule++)
            check_set(kind, batch[k] == 1 ? 40 : 130, k == 1 ? 1 : 10, batch[k], rule,
                      100 * (uint64_t)kind + 10 * k + (uint64_t)rule, &sure);
    check_set(kind, 60, 5, 20, 3, 1, &sure);
    if (kind != SET_COINCIDENT)
        g_assert_cmpuint(sure, >, 500); /* most cases are no borderline */
}

/* Many small sets: borderline cases come in numbers. */
static void test_many(void)
{
    uint32_t sure = 0;
    for (uint64_t seed = 0; seed < 400; seed++)
        for (uint32_t kind = 0; kind < SET_COUNT; kind++)
            check_set((SetKind)kind, 14, 4, 1 + (uint32_t)(seed % 4), (int)(seed % 3), 5000 + seed * SET_COUNT + kind,
                      &sure);
}

/* What eq. 2 says of a few nodes, by hand. */
static void test_by_hand(void)
{
    static const struct {
        Vec2 node[4];
        uint32_t n, want; /* mask */
    } hand[] = {
        {{{1, 0}}, 1, 1},                            /* one node */
        {{{1, 0}, {2, 0}}, 2, 1},                    /* behind it another */
        {{{1, 0}, {-2, 0}}, 2, 3},                   /* opposite */
        {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}, 4, 15}, /* a cross */
        {{{2, 0}, {1.5, 1.5}}, 2, 1},                /* 45° apart */
        {{{3, 0}, {0.5, 3}}, 2, 3},                  /* more than 60° apart */
        {{{5, 5}, {4, 5}, {5, 4}}, 3, 2}, /* a tie: the first of the two nearest, and it shuts out the rest */
    };
    for (uint32_t k = 0; k < G_N_ELEMENTS(hand); k++) {
        Quadtree t;
        quadtree_init(&t, field_box);
        for (uint32_t i = 0; i < hand[k].n; i++)
            quadtree_add(&t, hand[k].node[i], i);
        Field f = {hand[k].node, &t, field_box, NULL, NULL};
        Hood h;
        Cell c = {0};
        hood_find(&h, &f, vec2(0, 0));
        uint32_t relative = 0, urquhart = 0;
        for (uint32_t i = 0; i < h.n; i++)
            relative |= 1u << h.m[i];
        urquhart_find(&h, &c, &f, vec2(0, 0));
        for (uint32_t i = 0; i < h.n; i++)
            urquhart |= 1u << h.m[i];
        g_assert_cmpuint(relative, ==, hand[k].want);
        g_assert_cmpuint(urquhart, ==, hand[k].want);
        cell_clear(&c);
        quadtree_clear(&t);
    }
}

/* No more than five neighbours, however many nodes lie around (a regular hexagon included). */
static void test_at_most_five(void)
{
    for (uint32_t turn = 0; turn < 4000; turn++) {
        Dice d = {77, turn * 8};
        double x = roll(&d) - 0.5, y = roll(&d) - 0.5, h = sqrt(0.75);
        Vec2 s = vec2(roll(&d) * (turn % 2), roll(&d) * (turn % 2)), pos[6];
        for (uint32_t i = 0; i < 6; i++) {
            pos[i] = vec_add(s, vec2(x, y));
            double rx = 0.5 * x - h * y, ry = h * x + 0.5 * y; /* by 60° */
            x = rx;
            y = ry;
        }
        Quadtree t;
        quadtree_init(&t, field_box);
        for (uint32_t i = 0; i < 6; i++)
            quadtree_add(&t, pos[i], i);
        Field f = {pos, &t, field_box, NULL, NULL};
        Hood hood;
        hood_find(&hood, &f, s);
        g_assert_cmpuint(hood.n, >=, 1);
        g_assert_cmpuint(hood.n, <=, 6); /* rounding may part all six by a hair more than 60° */
        Case c = {.kind = SET_HEXAGONS, .pos = pos, .n = 6, .sight = {0, pos}};
        check_relative(&c, &hood, s, "hexagon");
        quadtree_clear(&t);
    }
}

/* ---- zones of hoods ---- */

/* A node outside the zone changes nothing. */
static void test_zone_holds(void)
{
    uint32_t outside = 0;
    for (uint64_t round = 0; round < 300; round++) {
        Dice d = {900 + round, 0};
        SetKind kind = (SetKind)(round % SET_COUNT);
        uint32_t n = 8 + pick(&d, 60);
        Case c = {.kind = kind, .pos = g_new(Vec2, n + 1), .n = n + 1};
        c.sight = (Sight){(int)(round / SET_COUNT % 3), c.pos};
        quadtree_init(&c.tree, field_box);
        for (uint32_t i = 0; i < n; i++) {
            c.pos[i] = set_point(kind, i, i ? c.pos[i - 1] : vec2(0, 0), &d);
            quadtree_add(&c.tree, c.pos[i], i);
        }
        Field f = field_of(&c);
        Vec2 s = set_source(kind, (uint32_t)round, c.pos, n, &d);
        Hood hood, urquhart;
        Cell cell = {0};
        hood_find(&hood, &f, s);
        urquhart_find(&urquhart, &cell, &f, s);
        Box2 zone = hood_zone(&hood, &f, s), urquhart_box = urquhart_zone(&cell, &f, s);
        for (uint32_t k = 0; k < 60; k++) {
            double spread = k % 2 ? 70 : 25;
            Vec2 centre = k % 3 ? vec2(0, 0) : s;
            Vec2 p = vec2(centre.x + (roll(&d) - 0.5) * spread, centre.y + (roll(&d) - 0.5) * spread);
            if (!box_has(field_box, p))
                continue;
            c.pos[n] = p;
            uint32_t sure = 0;
            if (!box_has(zone, p))
                check_relative(&c, &hood, s, "zone of the relative hood");
            if (!box_has(urquhart_box, p))
                check_urquhart(&c, &urquhart, s, "zone of Urquhart's hood", &sure);
            outside += !box_has(zone, p);
        }
        cell_clear(&cell);
        quadtree_clear(&c.tree);
        g_free(c.pos);
    }
    g_assert_cmpuint(outside, >, 300 * 60 / 10); /* zones are no excuse: they leave much out */
}

/* Nodes outside the zone that the hood has by then need not be shown to it. A zone is no part of the one before: it may
 * grow. */
static void test_zone_skips(void)
{
    uint32_t skipped = 0;
    for (uint64_t round = 0; round < 1500; round++) {
        enum { N = 40 };
        Dice d = {20000 + round, 0};
        Vec2 pos[N], s = vec2((roll(&d) - 0.5) * 30, (roll(&d) - 0.5) * 30);
        Case c = {.kind = round % 2 ? SET_RANDOM : SET_WALK, .pos = pos, .sight = {0, pos}};
        Hood hood, urquhart;
        Cell cell = {0};
        quadtree_init(&c.tree, field_box);
        for (c.n = 1; c.n <= N; c.n++) {
            uint32_t v = c.n - 1;
            pos[v] = set_point(c.kind, v, v ? pos[v - 1] : vec2(0, 0), &d);
            quadtree_add(&c.tree, pos[v], v);
            boxtree_build(&c.fresh, pos, &v, 1);
            Field f = field_of(&c);
            if (v == 0) {
                hood_find(&hood, &f, s);
                urquhart_find(&urquhart, &cell, &f, s);
            } else {
                bool concerns = box_has(hood_zone(&hood, &f, s), pos[v]);
                skipped += !concerns;
                if (concerns)
                    hood_update(&hood, &f, s, &c.fresh);
                if (box_has(urquhart_zone(&cell, &f, s), pos[v]))
                    urquhart_update(&urquhart, &cell, &f, s, &c.fresh);
            }
            uint32_t sure = 0;
            check_relative(&c, &hood, s, "a zone that shut a node out");
            check_urquhart(&c, &urquhart, s, "an Urquhart zone that shut a node out", &sure);
        }
        cell_clear(&cell);
        quadtree_clear(&c.tree);
        boxtree_clear(&c.fresh);
    }
    g_assert_cmpuint(skipped, >, 1000);
}

/* ---- quadtree ---- */

static void test_quadtree(void)
{
    for (uint32_t kind = 0; kind < SET_COUNT; kind++) {
        enum { N = 500 };
        Dice d = {31 + kind, 0};
        Vec2 pos[N];
        Quadtree t;
        quadtree_init(&t, field_box);
        Sight sight = {(int)(kind % 3), pos};
        for (int round = 0; round < 2; round++, quadtree_reset(&t, field_box)) /* the second time in reused memory */
            for (uint32_t i = 0; i < N; i++) {
                pos[i] = set_point((SetKind)kind, i, i ? pos[i - 1] : vec2(0, 0), &d);
                quadtree_add(&t, pos[i], i);
                Vec2 p = set_source((SetKind)kind, i, pos, i + 1, &d);
                double bound = i % 4 ? roll(&d) * 100 : HUGE_VAL, r = roll(&d) * 5, d2 = -1.0;
                uint32_t want = plain_nearest(pos, i + 1, p, seen, &sight);
                if (want != NO_POINT && !(plain_dist2(pos[want], p) < bound))
                    want = NO_POINT;
                uint32_t got = quadtree_nearest(&t, p, bound, sight.rule ? seen : NULL, &sight, &d2);
                if (got != want)
                    g_error("quadtree_nearest: %s, %u nodes, from %.17g,%.17g: %u instead of %u", set_name[kind], i + 1,
                            p.x, p.y, got, want);
                g_assert_cmpfloat(d2, ==, want == NO_POINT ? -1.0 : plain_dist2(pos[want], p));
                bool within = false;
                for (uint32_t k = 0; k <= i; k++)
                    within |= plain_dist2(pos[k], p) < r * r;
                g_assert_cmpint(quadtree_any_within(&t, p, r), ==, within);
            }
        quadtree_clear(&t);
    }
    Quadtree empty;
    double d2;
    quadtree_init(&empty, field_box);
    g_assert_cmpuint(quadtree_nearest(&empty, vec2(1, 1), HUGE_VAL, NULL, NULL, &d2), ==, NO_POINT);
    g_assert_false(quadtree_any_within(&empty, vec2(1, 1), 10));
    quadtree_clear(&empty);
}

/* ---- box tree ---- */

enum { MOST = POINTS_MOST };

/* Points with room of their own. */
typedef struct {
    uint32_t v[MOST + 4];
    double x[MOST + 4], y[MOST + 4];
} Room;

static Points points_in(Room *r, const uint32_t *v, uint32_t n, const Vec2 *pos)
{
    Points p = {n, r->v, r->x, r->y};
    memcpy(r->v, v, sizeof *v * n);
    points_fill(&p, pos);
    return p;
}

static void check_places(const Points *p, const Vec2 *pos)
{
    for (uint32_t k = 0; k < p->n; k++) {
        g_assert_true(p->x[k] == pos[p->v[k]].x && p->y[k] == pos[p->v[k]].y);
        g_assert_true(k == 0 || p->v[k - 1] < p->v[k]);
    }
}

/* The one nearest to a place, and the only one that is nearest to places of the box. Returns whether there is such a one. */
static bool check_sole(const Points *p, const Vec2 *pos, Box2 b, double bound2)
{
    uint32_t sole = points_sole(p, b), beaten = 0, v;
    for (int i = 0; i <= 4; i++)
        for (int j = 0; j <= 4; j++) {
            Vec2 q = vec2(b.x0 + (b.x1 - b.x0) * i / 4, b.y0 + (b.y1 - b.y0) * j / 4);
            uint32_t best = UINT32_MAX, found = UINT32_MAX;
            double best2 = bound2, found2 = bound2;
            for (uint32_t k = 0; k < p->n; k++)
                if (plain_dist2(pos[p->v[k]], q) < best2) {
                    best = p->v[k];
                    best2 = plain_dist2(pos[best], q);
                }
            points_nearest(p, q, &found, &found2);
            g_assert_cmpuint(found, ==, best);
            g_assert_true(found2 == best2);
            for (uint32_t k = 0; k < p->n && sole != UINT32_MAX; k++)
                g_assert_true(p->v[k] == sole || plain_dist2(pos[sole], q) < plain_dist2(pos[p->v[k]], q));
        }
    /* the one nearest to a corner, if it is the nearest to all others by far */
    const Vec2 corner[4] = {{b.x0, b.y0}, {b.x1, b.y0}, {b.x0, b.y1}, {b.x1, b.y1}};
    double near2 = HUGE_VAL, margin = 1e-6 * (1.0 + plain_dist2(corner[0], corner[3]));
    points_nearest(p, corner[0], &v, &near2);
    for (uint32_t k = 0; k < p->n; k++) {
        bool all = true;
        for (int c = 0; c < 4; c++)
            all &= plain_dist2(pos[v], corner[c]) * (1.0 + 1e-6) + margin < plain_dist2(pos[p->v[k]], corner[c]);
        beaten += all;
    }
    if (p->n && beaten == p->n - 1)
        g_assert_cmpuint(sole, ==, v);
    return sole != UINT32_MAX;
}

/* Every point that is nearest to one of some places in the box must be among those found. Returns how many there are. */
static uint32_t check_nearest_to(const Boxtree *t, const Vec2 *pos, uint32_t n, Box2 b, double bound2, uint32_t *out)
{
    Room room, tight_room, all_room;
    uint32_t near[MOST], found = boxtree_near(t, pos, b, bound2, near, MOST), all_of[MOST];
    if (found > MOST)
        return found;
    if (found)
        g_assert_cmpuint(boxtree_near(t, pos, b, bound2, out, found - 1), ==, found);
    boxtree_sort(near, found);
    Points p = points_in(&room, near, found, pos), tight = {0, tight_room.v, tight_room.x, tight_room.y};
    g_assert_cmpuint(points_nearest_to(&p, b, bound2, &tight), ==, tight.n);
    g_assert_cmpuint(tight.n, <=, found);
    check_places(&tight, pos);
    for (int i = 0; i <= 4; i++)
        for (int j = 0; j <= 4; j++) {
            Vec2 q = vec2(b.x0 + (b.x1 - b.x0) * i / 4, b.y0 + (b.y1 - b.y0) * j / 4);
            uint32_t best = 1; /* points are the odd ones */
            for (uint32_t k = 0; k < n; k++) {
                uint32_t v = 2 * k + 1;
                if (plain_dist2(pos[v], q) < plain_dist2(pos[best], q))
                    best = v;
            }
            if (n && plain_dist2(pos[best], q) < bound2)
                g_assert_nonnull(bsearch(&best, tight.v, tight.n, sizeof *tight.v, by_index));
        }
    g_assert_cmpuint(points_nearest_to(&p, b, bound2, &p), ==, tight.n); /* in place */
    g_assert_cmpmem(p.v, (int)(sizeof *p.v * p.n), tight.v, (int)(sizeof *tight.v * tight.n));
    memcpy(out, tight.v, sizeof *out * tight.n);
    if (n <= MOST) { /* of all: none only where none is within the bound */
        for (uint32_t k = 0; k < n; k++)
            all_of[k] = 2 * k + 1;
        Points all = points_in(&all_room, all_of, n, pos);
        bool any = false, sole = check_sole(&all, pos, b, bound2);
        g_assert_true(tight.n != 1 || n != 1 || sole);
        g_assert_true(!sole || tight.n <= 1);
        for (uint32_t k = 0; k < n; k++)
            any |= box_dist2(b, pos[all_of[k]]) <= bound2;
        g_assert_cmpint(points_nearest_to(&all, b, bound2, &all) > 0, ==, any);
        for (uint32_t k = 0; k < tight.n; k++)
            g_assert_nonnull(bsearch(&tight.v[k], all.v, all.n, sizeof *all.v, by_index));
    }
    return tight.n;
}

/* Every point that the one nearest to some place in the box does not exclude there must be among the rivals, unless another point does and
 * may. */
static uint32_t check_rivals(const Boxtree *t, const Vec2 *pos, uint32_t n, Box2 b, const uint32_t *near, uint32_t n_near, bool alone)
{
    Room near_room, out_room, list_room;
    uint32_t *all = g_new(uint32_t, n);
    Points guard = points_in(&near_room, near, n_near, pos), out = {0, out_room.v, out_room.x, out_room.y};
    uint32_t found = boxtree_rivals(t, pos, b, &guard, alone, &out, n);
    g_assert_cmpuint(found, <=, n);
    g_assert_cmpuint(found, ==, out.n);
    check_places(&out, pos);
    for (uint32_t i = 0; i < n; i++)
        all[i] = 2 * i + 1;
    Points list = points_in(&list_room, all, n, pos);
    g_assert_cmpuint(points_rivals(&list, b, &guard, alone, &list, n), ==, found); /* of all, and in place */
    g_assert_cmpmem(list.v, (int)(sizeof *list.v * found), out.v, (int)(sizeof *out.v * found));
    list = points_in(&list_room, all, n, pos);
    if (found && alone)
        g_assert_cmpuint(points_rivals(&list, b, &guard, alone, &list, found - 1), >, found - 1);
    for (int i = 0; i <= 4; i++)
        for (int j = 0; j <= 4; j++) {
            Vec2 p = vec2(b.x0 + (b.x1 - b.x0) * i / 4, b.y0 + (b.y1 - b.y0) * j / 4);
            uint32_t best = 1;
            for (uint32_t u = 3; u < 2 * n; u += 2)
                best = plain_dist2(pos[u], p) < plain_dist2(pos[best], p) ? u : best;
            for (uint32_t v = 1; v < 2 * n; v += 2) {
                bool excluded = plain_dist2(pos[best], pos[v]) <= plain_dist2(pos[v], p);
                for (uint32_t u = 1; !alone && u < 2 * n && !excluded; u += 2)
                    excluded = plain_dist2(pos[u], p) <= plain_dist2(pos[v], p) && plain_dist2(pos[u], pos[v]) <= plain_dist2(pos[v], p);
                g_assert_true(excluded || bsearch(&v, out.v, found, sizeof *out.v, by_index));
            }
        }
    g_free(all);
    return found;
}

static void test_boxtree(void)
{
    Boxtree t = {0};
    uint32_t found = 0, points = 0;
    for (uint32_t round = 0; round < 60; round++) {
        Dice d = {500 + round, 0};
        uint32_t n = round < 12 ? round : 1 + pick(&d, 300), *item = g_new(uint32_t, n + 1);
        Vec2 *pos = g_new(Vec2, 2 * n + 1);
        for (uint32_t i = 0; i < 2 * n; i++)
            pos[i] = set_point((SetKind)(round % SET_COUNT), i, i ? pos[i - 1] : vec2(0, 0), &d);
        for (uint32_t i = 0; i < n; i++)
            item[i] = 2 * i + 1; /* a part of all points */
        boxtree_build(&t, pos, item, n);
        /* every item once, and boxes tight */
        uint32_t *got = g_memdup2(t.item, sizeof *item * n);
        if (n) {
            qsort(got, n, sizeof *got, by_index);
            g_assert_cmpmem(got, (int)(sizeof *got * n), item, (int)(sizeof *item * n));
        }
        g_free(got);
        uint32_t leaves = 0;
        for (uint32_t k = 0; k < t.n_nodes; k++) {
            Box2 b = box_empty();
            for (uint32_t i = t.node[k].first; i < t.node[k].first + t.node[k].count; i++)
                b = box_add(b, pos[t.item[i]]);
            g_assert_cmpmem(&b, sizeof b, &t.node[k].box, sizeof b);
            if (t.node[k].right == 0)
                leaves += t.node[k].count;
            else
                g_assert_cmpuint(t.node[k + 1].count + t.node[t.node[k].right].count, ==, t.node[k].count);
        }
        g_assert_cmpuint(leaves, ==, n);
        for (uint32_t k = 0; k < 200; k++) {
            double x = (roll(&d) - 0.5) * 60, y = (roll(&d) - 0.5) * 60, w = roll(&d) * 6, h = roll(&d) * 6;
            Box2 b = {x, y, x + w, y + h};
            if (k % 4 == 0)
                b = (Box2){floor(x), floor(y), ceil(x), ceil(y)}; /* edges through points */
            bool any = false;
            for (uint32_t i = 0; i < n; i++) {
                Vec2 p = pos[item[i]];
                any |= p.x >= b.x0 && p.x <= b.x1 && p.y >= b.y0 && p.y <= b.y1;
            }
            g_assert_cmpint(boxtree_any_in(&t, pos, b), ==, any);
            uint32_t near[MOST], n_near = check_nearest_to(&t, pos, n, b, k % 3 ? roll(&d) * 300 : HUGE_VAL, near);
            if (k % 3 || n == 0 || n_near > MOST || n > 40)
                continue;
            uint32_t some = check_rivals(&t, pos, n, b, near, n_near, false);
            g_assert_cmpuint(some, <=, check_rivals(&t, pos, n, b, near, n_near, true));
            found += some;
            points += n;
        }
        g_free(pos);
        g_free(item);
    }
    boxtree_clear(&t);
    g_assert_cmpuint(found, <, points / 4); /* most are no rivals */
}

/* ---- grid ---- */

static void test_grid(void)
{
    static const Box2 field[] = {{-40, -40, 40, 40}, {-40, -3, 40, 5}, {0, 0, 1, 900}, {1000, 2000, 1080, 2079}};
    static const double size[] = {0.01, 1, 7, 500};
    for (uint32_t round = 0; round < 64; round++) {
        Dice d = {7000 + round, 0};
        Box2 box = field[round % 4];
        double w = box.x1 - box.x0, h = box.y1 - box.y0;
        Grid g;
        grid_init(&g, box, size[round / 4 % 4]);
        for (int again = 0; again < 2; again++) {
            uint32_t n = pick(&d, 300);
            Vec2 *place = g_new(Vec2, n + 1);
            for (uint32_t i = 0; i < n; i++) {
                place[i] = vec2(box.x0 + roll(&d) * w, box.y0 + roll(&d) * h);
                grid_add(&g, place[i]);
                uint32_t cell = grid_cell(&g, place[i]);
                g_assert_cmpuint(cell, <, grid_cells(&g));
                g_assert_cmpfloat(fabs(place[i].x - (box.x0 + (cell % g.nx + 0.5) * g.cell)), <=, g.cell * 0.5000001);
                g_assert_cmpfloat(fabs(place[i].y - (box.y0 + (cell / g.nx + 0.5) * g.cell)), <=, g.cell * 0.5000001);
            }
            for (uint32_t k = 0; k < 200; k++) {
                Vec2 p = vec2(box.x0 + (roll(&d) * 1.2 - 0.1) * w, box.y0 + (roll(&d) * 1.2 - 0.1) * h);
                double r = roll(&d) * (k % 2 ? 3 : 30);
                bool any = false;
                for (uint32_t i = 0; i < n; i++)
                    any |= plain_dist2(place[i], p) < r * r;
                g_assert_cmpint(grid_any_within(&g, place, p, r), ==, any);
            }
            g_free(place);
            grid_reset(&g);
        }
        grid_clear(&g);
    }
    for (uint32_t k = 0; k < 1000; k++) { /* boxes in single precision hold the box, and not much more */
        Dice d = {7100 + k, 0};
        double size_of = pow(10, roll(&d) * 8 - 2), x = (roll(&d) - 0.5) * size_of, y = (roll(&d) - 0.5) * size_of;
        Box2 b = {x, y, x + roll(&d) * size_of, y + roll(&d)}, got = zone_as_box(zone_box(b));
        Box2 more = box_grow(b, 1e-6 * (fabs(b.x0) + fabs(b.y0) + fabs(b.x1) + fabs(b.y1)));
        g_assert_true(got.x0 <= b.x0 && got.y0 <= b.y0 && got.x1 >= b.x1 && got.y1 >= b.y1);
        g_assert_true(got.x0 >= more.x0 && got.y0 >= more.y0 && got.x1 <= more.x1 && got.y1 <= more.y1);
    }
}

int main(int argc, char **argv)
{
    g_test_init(&argc, &argv, NULL);
    g_test_add_func("/neighbours/by-hand", test_by_hand);
    g_test_add_func("/neighbours/at-most-five", test_at_most_five);
    for (uint32_t k = 0; k < SET_COUNT; k++) {
        char *name = g_strdup_printf("/neighbours/sets/%s", set_name[k]);
        g_strdelimit(name, " ", '-');
        g_test_add_data_func(name, GUINT_TO_POINTER(k), test_sets);
        g_free(name);
    }
    g_test_add_func("/neighbours/many", test_many);
    g_test_add_func("/neighbours/zone/holds", test_zone_holds);
    g_test_add_func("/neighbours/zone/skips", test_zone_skips);
    g_test_add_func("/neighbours/quadtree", test_quadtree);
    g_test_add_func("/neighbours/boxtree", test_boxtree);
    g_test_add_func("/neighbours/grid", test_grid);
    return g_test_run();
}
