/* Auxin source placement (Runions 2005, section 3.3). */
#include <string.h>

#include "geom/random.h"
#include "sim/state.h"

/* No source is placed nearer to a vein than b_v, nor within the kill distance: it would be removed in the same step without ever having
 * been out of reach, but pull a stub of vein out of its neighbour before. */
static double vein_clearance(const Simulation *s)
{
    return MAX(s->def.birth_distance_veins, s->def.kill_distance) * s->blade->unit;
}

/* ---- placement ---- */

/* Squares of a quarter of the clearance, which the veins pass through: most darts are settled by the squares around them. */
static void paths_prepare(Simulation *s)
{
    const double most = 1 << 27;
    Paths *t = &s->paths;
    Box2 b = field_box(s);
    double side = 0.25 * MAX(s->def.birth_distance_veins, s->def.kill_distance); /* the unit shrinks, to 1 */
    double nx = (b.x1 - b.x0) / side + 1.0, ny = (b.y1 - b.y0) / side + 1.0;
    if (s->blade->moving || !(nx * ny < most))
        return;
    *t = (Paths){vec2(b.x0, b.y0), 1.0 / side, (uint32_t)nx, (uint32_t)ny, NULL, 0, 0.0, 0, {0}};
    t->bits = g_new0(uint8_t, (gsize)(nx * ny) / 8 + (gsize)nx + 8);
}

static void paths_update(Simulation *s)
{
    Paths *t = &s->paths;
    for (; t->bits && t->n < s->veins.n; t->n++) {
        Vec2 p = s->veins.pos[t->n];
        gsize i = (gsize)((p.y - t->corner.y) * t->scale) * t->nx + (gsize)((p.x - t->corner.x) * t->scale);
        t->bits[i / 8] |= (uint8_t)(1u << i % 8);
    }
    t->radius = vein_clearance(s) * t->scale;
    double sure = MIN(t->radius, PATHS_WIDEST) * (1.0 - 1e-9); /* squares wholly within this of all of the middle one */
    for (t->rows = 0; t->rows + 2 <= sure; t->rows++)
        t->reach[t->rows] = (int)sqrt(sure * sure - (t->rows + 1.0) * (t->rows + 1.0)) - 1;
}

/* Whether a vein passes through one of the squares from x0 to x1 of row y, as far as they are squares; at most 25. */
static bool row_is_passed(const Paths *t, int64_t x0, int64_t x1, int64_t y)
{
    x0 = MAX(x0, 0);
    x1 = MIN(x1, (int64_t)t->nx - 1);
    if (y < 0 || y >= t->ny || x0 > x1)
        return false;
    gsize i = (gsize)y * t->nx + (gsize)x0;
    const uint8_t *b = t->bits + i / 8;
    uint32_t bits = ((uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24) >> i % 8;
    return bits & ((1u << (x1 - x0 + 1)) - 1);
}

/* Whether a vein node lies nearer to p than the clearance: TRUE, FALSE, or unsure. */
typedef enum { NEAR_NONE, NEAR_SOME, NEAR_UNSURE } PathsSay;

static PathsSay paths_ask(const Simulation *s, Vec2 p)
{
    const Paths *t = &s->paths;
    if (!t->bits)
        return NEAR_UNSURE;
    int64_t x = (int64_t)((p.x - t->corner.x) * t->scale), y = (int64_t)((p.y - t->corner.y) * t->scale);
    for (int j = 0; j < t->rows; j++)
        if (row_is_passed(t, x - t->reach[j], x + t->reach[j], y + j) || row_is_passed(t, x - t->reach[j], x + t->reach[j], y - j))
            return NEAR_SOME;
    if (t->radius + 1e-6 >= PATHS_WIDEST)
        return NEAR_UNSURE;
    int r = (int)(t->radius + 1e-6) + 1;
    for (int j = -r; j <= r; j++)
        if (row_is_passed(t, x - r, x + r, y + j))
            return NEAR_UNSURE;
    return NEAR_NONE;
}

static bool clear_of_sources(const Simulation *s, Vec2 p)
{
    return !(s->def.birth_distance_sources > 0.0) || !grid_any_within(&s->grid, s->place, p, s->def.birth_distance_sources * s->blade->unit);
}

static bool vacant(const Simulation *s, Vec2 p)
{
    PathsSay say = paths_ask(s, p);
    if (say == NEAR_SOME || !clear_of_sources(s, p))
        return false;
    return say == NEAR_NONE || !quadtree_any_within(&s->veins.tree, p, vein_clearance(s));
}

/* A point uniform in the blade, by rejection from its box; FALSE in the (practically impossible) case of a long run of misses. */
static bool dart(const Simulation *s, uint64_t index, Vec2 *p)
{
    enum { TRIES = 256 };
    Box2 b = s->blade->box;
    for (uint64_t k = 0; k < TRIES; k++) {
        double u[2];
        random_pair(s->def.seed, RANDOM_DART, s->blade->step, index * TRIES + k, u);
        *p = vec2(b.x0 + u[0] * (b.x1 - b.x0), b.y0 + u[1] * (b.y1 - b.y0));
        if (blade_contains(s->blade, *p))
            return true;
    }
    return false;
}

/* Darts that are thrown at the same time, at the sources there were before. */
typedef struct {
    const Simulation *s;
    uint64_t first;
    Vec2 *place;
    bool *sticks;
} Volley;

static void throw_some(uint32_t first, uint32_t last, void *user)
{
    const Volley *v = user;
    for (uint32_t i = first; i < last; i++)
        v->sticks[i] = dart(v->s, v->first + i, &v->place[i]) && vacant(v->s, v->place[i]);
}

static void throw_volley(Simulation *s, uint64_t first, uint32_t n)
{
    enum { GRAIN = 64 };
    Volley v = {s, first, g_new(Vec2, n), g_new(bool, n)};
    pool_for(s->pool, n, GRAIN, throw_some, &v);
    uint32_t before = s->n_sources;
    for (uint32_t i = 0; i < n; i++) {
        s->misses++;
        if (!v.sticks[i] || (s->n_sources > before && !clear_of_sources(s, v.place[i]))) /* one of the same volley may be too near */
            continue;
        source_add(s, v.place[i]);
        s->misses = 0;
    }
    g_free(v.place);
    g_free(v.sticks);
}

static void throw_darts(Simulation *s)
{
    enum { VOLLEY = 1 << 14 };
    if (s->def.only_while_growing && s->blade->step > MAX(s->blade->last_step, 1))
        return;
    s->dart_carry += s->def.density * s->blade->area;
    uint64_t n = (uint64_t)s->dart_carry; /* the fraction is carried over, so that the mean is rho exactly */
    s->dart_carry -= (double)n;
    s->counts.darts += n;
    paths_update(s);
    for (uint64_t i = 0; i < n && s->n_sources < MOST_SOURCES; i += VOLLEY)
        throw_volley(s, i, (uint32_t)MIN(n - i, VOLLEY));
}

bool sources_are_many(double darts)
{
    const double patience = 10000.0, enough = 20.0; /* steps, darts */
    return darts * patience > enough;
}

/* Where few darts are thrown a step, a blade without a source need not be full: only when some darts in a row have found no room. But where
 * sources keep no distance, there is always room for one that no vein can reach: nor may many darts in a row be in vain. */
bool sources_expected(const Simulation *s)
{
    enum { ENOUGH = 20, VAIN_DARTS = 100, VAIN_STEPS = 100 };
    bool vain = s->counts.darts - s->last_darts >= VAIN_DARTS && s->blade->step - s->last_use >= VAIN_STEPS;
    return s->def.placement == PLACEMENT_DARTS && !s->def.only_while_growing && s->misses < ENOUGH && !vain &&
           sources_are_many(s->def.density * s->blade->area);
}

/* Waiting sources whose time has come. The precomputed set keeps b_s already; a listed source is placed as the user wants it. */
static void place_waiting(Simulation *s)
{
    bool listed = s->def.placement == PLACEMENT_LIST;
    uint32_t keep = s->next_waiting, i = keep;
    for (; i < s->n_waiting && s->waiting[i].step <= s->blade->step; i++) {
        Vec2 p = listed && !s->blade->moving ? vec_scale(s->waiting[i].pos, s->blade->unit) : s->waiting[i].pos;
        if (!blade_contains(s->blade, p) && s->blade->step < s->blade->last_step) {
            s->waiting[keep++] = s->waiting[i]; /* the margin has not passed it yet */
            continue;
        }
        if (listed || !quadtree_any_within(&s->veins.tree, p, vein_clearance(s)))
            source_add(s, p);
    }
    /* those that still wait move up to the end of the part just read */
    uint32_t kept = keep - s->next_waiting;
    memmove(s->waiting + i - kept, s->waiting + s->next_waiting, sizeof *s->waiting * kept);
    s->next_waiting = i - kept;
}

bool sources_waiting(const Simulation *s) { return s->next_waiting < s->n_waiting; }

/* Sources from slot `first` on, which are new. */
typedef struct {
    Simulation *s;
    uint32_t first;
} Newcomers;

static void look_around(uint32_t first, uint32_t last, void *user)
{
    const Newcomers *n = user;
    for (uint32_t i = first; i < last; i++)
        source_look(n->s, n->first + i);
}

void sources_place(Simulation *s)
{
    enum { GRAIN = 4 };
    Newcomers n = {s, s->n_sources};
    if (s->def.placement == PLACEMENT_DARTS)
        throw_darts(s);
    else
        place_waiting(s);
    pool_for(s->pool, s->n_sources - n.first, GRAIN, look_around, &n);
    s->counts.updates += s->n_sources - n.first;
    crowds_add(s);
}

/* ---- sources known beforehand ---- */

static gint by_step(gconstpointer a, gconstpointer b, gpointer unused)
{
    const ListedSource *p = a, *q = b;
    return p->step < q->step ? -1 : p->step > q->step;
}

/* Points scattered over a box, in squares not smaller than the distance that they keep. */
typedef struct {
    Box2 box;
    double cell;
    uint32_t nx, ny, n, cap;
    uint32_t *head; /* [nx * ny] */
    uint32_t *next; /* [cap] */
    ListedSource *item;
} Scatter;

static void scatter_init(Scatter *g, Box2 box, double distance)
{
    const double most = 1 << 20; /* squares */
    double w = box.x1 - box.x0, h = box.y1 - box.y0;
    *g = (Scatter){.box = box, .cell = MAX(distance, sqrt(w * h / most))};
    g->nx = (uint32_t)(w / g->cell) + 1;
    g->ny = (uint32_t)(h / g->cell) + 1;
    g->head = g_new(uint32_t, (gsize)g->nx * g->ny);
    memset(g->head, 0xff, sizeof *g->head * g->nx * g->ny); /* NO_POINT */
}

static uint32_t scatter_column(const Scatter *g, double x) { return (uint32_t)(CLAMP((x - g->box.x0) / g->cell, 0.0, g->nx - 1.0)); }
static uint32_t scatter_row(const Scatter *g, double y) { return (uint32_t)(CLAMP((y - g->box.y0) / g->cell, 0.0, g->ny - 1.0)); }

static bool scatter_any_within(const Scatter *g, Vec2 p, double r)
{
    uint32_t x1 = scatter_column(g, p.x + r), y1 = scatter_row(g, p.y + r);
    for (uint32_t y = scatter_row(g, p.y - r); y <= y1; y++)
        for (uint32_t x = scatter_column(g, p.x - r); x <= x1; x++)
            for (uint32_t i = g->head[(gsize)y * g->nx + x]; i != NO_POINT; i = g->next[i])
                if (vec_dist2(g->item[i].pos, p) < r * r)
                    return true;
    return false;
}

static void scatter_add(Scatter *g, ListedSource it)
{
    if (g->n == g->cap) {
        g->cap = MAX(g->cap * 2, 256);
        g->next = g_renew(uint32_t, g->next, g->cap);
        g->item = g_renew(ListedSource, g->item, g->cap);
    }
    uint32_t *head = &g->head[(gsize)scatter_row(g, it.pos.y) * g->nx + scatter_column(g, it.pos.x)];
    g->next[g->n] = *head;
    g->item[g->n] = it;
    *head = g->n++;
}

static gboolean prepare_margin(Simulation *s, GError **error)
{
    Box2 box = s->blade->widest;
    double scale = 1.0 / s->blade->last_length;
    double count = s->def.density * (box.x1 - box.x0) * (box.y1 - box.y0);
    if (s->def.growth.kind != GROWTH_MARGINAL && s->def.growth.kind != GROWTH_NONE) {
        g_set_error(error, SIMULATION_ERROR, SIMULATION_ERROR_SOURCES,
                    "sources.placement = margin needs growth.kind = marginal or none: in diffuse growth sources appear all over the blade");
        return FALSE;
    }
    if (count > 1e8) {
        g_set_error(error, SIMULATION_ERROR, SIMULATION_ERROR_SIZE,
                    "sources.density = %g asks for %.3g darts at once; at most 1e8 are possible", s->def.density, count);
        return FALSE;
    }
    Scatter set;
    scatter_init(&set, box, s->def.birth_distance_sources);
    s->counts.darts = (uint64_t)count;
    for (uint64_t i = 0; i < s->counts.darts && set.n < MOST_SOURCES; i++) {
        double u[2];
        random_pair(s->def.seed, RANDOM_MARGIN, 0, i, u);
        Vec2 p = vec2(box.x0 + u[0] * (box.x1 - box.x0), box.y0 + u[1] * (box.y1 - box.y0));
        if (polygon_contains(s->def.leaf, vec_scale(p, scale)) && !scatter_any_within(&set, p, s->def.birth_distance_sources))
            scatter_add(&set, (ListedSource){p, blade_step_passed(s->blade, p)});
    }
    g_free(set.head);
    g_free(set.next);
    s->waiting = set.item;
    s->n_waiting = set.n;
    if (set.n >= MOST_SOURCES)
        g_set_error(error, SIMULATION_ERROR, SIMULATION_ERROR_SIZE,
                    "sources.density = %g makes more than the %d sources that can be kept; it must be lower, or sources.birth_distance_sources = %g higher",
                    s->def.density, MOST_SOURCES, s->def.birth_distance_sources);
    return set.n < MOST_SOURCES;
}

/* Whether a listed source lies in the blade in the end; one right on the margin may be off it by rounding, or by the flatness of a curve,
 * and a vein may reach a segment beyond. */
static bool in_reach(const Simulation *s, Vec2 p)
{
    if (s->blade->moving)
        return polygon_contains(s->blade->last_shape, p) || polygon_depth(s->blade->last_shape, p) >= -1.0;
    double scale = s->blade->last_length;
    Vec2 leaf = vec_scale(p, 1.0 / scale);
    return polygon_contains(s->def.leaf, leaf) || polygon_depth(s->def.leaf, leaf) * scale >= -1.0;
}

static gboolean prepare_list(Simulation *s, GError **error)
{
    s->n_waiting = s->def.n_list;
    if (s->n_waiting >= MOST_SOURCES) {
        g_set_error(error, SIMULATION_ERROR, SIMULATION_ERROR_SIZE, "sources.file holds %u sources; fewer than %d can be kept", s->n_waiting, MOST_SOURCES);
        s->n_waiting = 0;
        return FALSE;
    }
    s->waiting = g_memdup2(s->def.list, sizeof(ListedSource) * s->def.n_list);
    for (uint32_t i = 0; i < s->n_waiting; i++) {
        if (in_reach(s, s->waiting[i].pos))
            continue;
        g_set_error(error, SIMULATION_ERROR, SIMULATION_ERROR_SOURCES,
                    "sources.file: source %u at %g,%g lies outside the blade, which is %g segments long in the end", i + 1,
                    s->waiting[i].pos.x, s->waiting[i].pos.y, s->blade->last_length);
        return FALSE;
    }
    return TRUE;
}

gboolean sources_prepare(Simulation *s, GError **error)
{
    if (s->def.placement == PLACEMENT_DARTS)
        paths_prepare(s);
    gboolean ok = s->def.placement == PLACEMENT_MARGIN ? prepare_margin(s, error)
                  : s->def.placement == PLACEMENT_LIST ? prepare_list(s, error)
                                                       : TRUE;
    if (ok && s->n_waiting > 1) /* stable: glib's is a merge sort */
        g_qsort_with_data(s->waiting, (gint)s->n_waiting, sizeof *s->waiting, by_step, NULL);
    return ok;
}
